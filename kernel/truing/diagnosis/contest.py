"""One contest of all explanations over chosen rows: search, learn the noise from the best, search again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING

from truing.diagnosis.alarms import OUTSIDE
from truing.diagnosis.hypotheses import NOTHING, Hypothesis, Piece, mixed, off_inputs, pairs, shapes, singles
from truing.diagnosis.problem import Problem, bent, near, sharpened, terms_for_pairs
from truing.diagnosis.search import (
    Evidence,
    Found,
    NoiseModel,
    Solution,
    base_solution,
    evidence_of,
    learned,
    likely_settings,
    search,
    solve,
)
from truing.diagnosis.verdict import UNKNOWN
from truing.studies.bench import Done, unheard

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ROUNDS = 3
FAVOURITES = 8
REFINED = 4
SHARPENED = 3
SURELY = 3.0


@dataclass(frozen=True)
class Contest:
    """How the explanations stand on some rows: noise as learnt, every hypothesis scored, the filters tried."""

    problem: Problem
    noise: NoiseModel
    evidence: Evidence
    found: Found
    settings: tuple[tuple[int, ...], ...]

    def base(self) -> Solution:
        """Calibrate the model as it is, with no cause."""
        return base_solution(self.evidence, self.found.setting[0])

    def solution(self, place: int) -> Solution:
        """Solve one of the hypotheses at its best noise filter."""
        return solve(self.evidence, self.found.hypotheses[place], self.found.setting[place])


def contest(
    problem: Problem,
    noise: NoiseModel,
    rows: NDArray[np.bool_],
    *,
    rounds: int = ROUNDS,
    settings: Sequence[tuple[int, ...]] = (),
    sharpen: bool = True,
    done: Done = unheard,
) -> Contest:
    """Search and learn the noise in turn, ``rounds`` times; ``settings`` are the noise filters to try, if known.

    With ``sharpen`` the grids of shapes become finer about the best explanations from round to round. ``done`` hears of
    the rounds.
    """
    raw = dict(noise.residuals)
    for left in range(rounds - 1, -1, -1):
        done(rounds - 1 - left, rounds)
        evidence = evidence_of(problem, noise, rows)
        found, tried = _all_scored(problem, evidence, settings)
        if left:
            best = found.best()
            if sharpen:
                tops = [found.hypotheses[place] for place in islice(found.ranked(), SHARPENED)]
                pieces = [piece for hypothesis in tops for piece in hypothesis.pieces]
                problem = bent(problem, _fitted(evidence, found))
                problem = sharpened(problem, [*pieces, *best_terms(found, SHARPENED)])
            noise = learned(problem, evidence, solve(evidence, found.hypotheses[best], found.setting[best]), raw, noise)
    evidence.known.clear()  # few of the filters are asked for again
    return Contest(problem, noise, evidence, found, tuple(tried))


def _fitted(evidence: Evidence, found: Found) -> list[tuple[Piece, float]]:
    """Return the pieces of one column of the best explanations, and of the best single causes, as fitted."""
    tops = (*islice(found.ranked(), SHARPENED), *islice(found.ranked("one"), SHARPENED))
    made: list[tuple[Piece, float]] = []
    for place in dict.fromkeys(tops):
        solution = solve(evidence, found.hypotheses[place], found.setting[place])
        values = iter(solution.coefficients.tolist())
        for piece in found.hypotheses[place].pieces:
            own = [next(values) for _ in piece.columns]
            made += [(piece, own[0])] if len(own) == 1 else []
    return made


def _all_scored(
    problem: Problem, evidence: Evidence, known: Sequence[tuple[int, ...]]
) -> tuple[Found, Sequence[tuple[int, ...]]]:
    """Score nothing, single causes, shapes and inputs; then pairs; then causes beside shapes."""
    simple = [NOTHING, *singles(problem.term_pieces), *shapes(problem.shape_pieces)]
    settings = known or likely_settings(evidence, simple)
    first = search(evidence, simple, settings)
    favourites = best_terms(first)
    terms = terms_for_pairs(problem, frozenset(piece.place for piece in favourites))
    two = [
        search(evidence, pairs(terms, problem.beside), settings),
        search(evidence, mixed(favourites, problem.shape_pieces, problem.like), settings),
    ]
    finer = [hypothesis for each in two for hypothesis in _finer(problem, each)]
    found = [
        first,
        *two,
        *([search(evidence, finer, settings)] if finer else []),
        _outside(evidence, search(evidence, off_inputs(problem.input_pieces), settings)),
    ]
    return _together(found), settings


def best_terms(found: Found, count: int = FAVOURITES) -> list[Piece]:
    """Return the best variant of each of the best single causes."""
    return [found.hypotheses[place].pieces[0] for place in islice(found.ranked("one"), count)]


def _finer(problem: Problem, found: Found) -> list[Hypothesis]:
    """Return the best explanations again with the values of a fine grid that were passed over."""
    made: list[Hypothesis] = []
    for place in islice(found.ranked(), REFINED):
        hypothesis = found.hypotheses[place]
        for number, piece in enumerate(hypothesis.pieces):
            others = hypothesis.pieces[:number], hypothesis.pieces[number + 1 :]
            if piece.kind == "term":
                made += [replace(hypothesis, pieces=(*others[0], each, *others[1])) for each in near(problem, piece)]
    return made


def _outside(evidence: Evidence, found: Found) -> Found:
    """Strike out every input that may well lie inside its band: it is calibrated, not named."""
    import numpy as np

    score = found.score.copy()
    for place, hypothesis in enumerate(found.hypotheses):
        if not np.isfinite(score[place]):
            continue
        case = evidence.case(found.setting[place])
        column = hypothesis.columns[0]
        curvature = float(case.total_h[column, column])
        off = abs(float(case.total_g[column, 0]) / curvature) if curvature > 0 else 0.0
        if curvature <= 0 or off - OUTSIDE < SURELY / np.sqrt(curvature):
            score[place] = -np.inf
    return replace(found, score=score)


def _together(found: Sequence[Found]) -> Found:
    """Put lists of scored hypotheses one after the other."""
    import numpy as np

    return Found(
        tuple(hypothesis for each in found for hypothesis in each.hypotheses),
        np.concatenate([each.score for each in found]),
        np.concatenate([each.likelihood for each in found]),
        tuple(setting for each in found for setting in each.setting),
    )


def names_of(problem: Problem, hypothesis: Hypothesis) -> tuple[str, ...]:
    """Return the names of what a hypothesis is made of; a shape is called unknown."""
    return tuple(dict.fromkeys(_name(problem, piece) for piece in hypothesis.pieces))


def _name(problem: Problem, piece: Piece) -> str:
    if piece.kind == "term":
        return problem.candidates[piece.owner].name
    if piece.kind == "input":
        return f"input:{problem.machine.inputs[piece.owner].name}"
    return UNKNOWN


def curve_space(contest: Contest, hypothesis: Hypothesis) -> Mapping[str, NDArray[np.float64]]:
    """Return the columns of a hypothesis by result on the rows of its channel, shape (n, k), in units of the noise."""
    import numpy as np

    found = {}
    for channel in contest.evidence.channels:
        made = np.zeros((len(channel), len(hypothesis.columns)))
        for place, column in enumerate(hypothesis.columns):
            item = contest.problem.columns[column]
            if channel.name in item.parts:
                made[:, place] = item.parts[channel.name][channel.rows] * (item.per / channel.scale)
        found[channel.name] = made
    return found
