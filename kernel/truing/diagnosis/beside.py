"""A second cause that shows what it is only beside the first, because the first changes its curve.

The search adds curves that were each made with the model as it is. Friction that holds back the load of a joint with
play shifts the torque at which the play jumps: with the play on, its curve is another one. And two causes that draw one
line alone may draw two beside a third. Where the answer is a pair, or leaves something unregistered, all curves are
made anew with a registered cause on; the best pairs are fitted with the exact model; and the contest is held again with
the curves of these pairs as they are where they were fitted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import Candidate, Term, variants_of
from truing.diagnosis.chords import REACH, chord, may_bend
from truing.diagnosis.contest import Contest, contest
from truing.diagnosis.fit import Fit, Fitter, fit, input_values, is_off
from truing.diagnosis.hypotheses import pairs
from truing.diagnosis.machine import Machine, machine_of, predict
from truing.diagnosis.problem import Problem, problem_of, with_pairs, without_pieces
from truing.diagnosis.search import evidence_of, moved_to, residuals_of, search
from truing.diagnosis.second_look import BETTER, MOST_ROWS, noise_after, worth
from truing.diagnosis.twins import Twin
from truing.setup import SwitchedOn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ADDED = 1.0
"""Sum of squares, in units of the noise, from which two causes are more than their sum."""
MOST_FIRST = 2
MOST_FITTED = 3
NEARLY = 16.0
"""Pairs whose exact fit is worse by less than this, in log-likelihood, compete as they are where they were fitted."""


@dataclass(frozen=True)
class Placed:
    """A cause where a fit has put it: the place of its candidate, amplitudes and shapes in SI."""

    owner: int
    candidate: Candidate
    amplitudes: Mapping[str, float]
    shape: Mapping[str, float]

    def switched_on(self, machine: Machine) -> Machine:
        """Return a machine whose model has this cause on; amplitudes that this record does not excite are 0."""
        idle = {unknown.name: 0.0 for unknown in self.candidate.amplitudes}
        on = SwitchedOn(self.candidate.effect, {**idle, **self.shape, **self.amplitudes})
        start = machine.start.with_effects([on])
        return replace(machine, start=start, base=predict(start, machine.records))

    def term(self, machine: Machine, scales: Mapping[str, float]) -> Term | None:
        """Return what the cause does to a machine about this size: its chord where it may bend, else its slopes."""
        if len(self.amplitudes) == 1 and may_bend(self.candidate):
            (size,) = self.amplitudes.values()
            point = size, self.shape
            made = chord(self.owner, self.candidate, machine, scales, point, reach=REACH) if size else []
        else:
            made = variants_of(self.owner, self.candidate, machine, self.shape, scales)
        return next((term for term in made if self._is_within(term)), None)

    def _is_within(self, term: Term) -> bool:
        """Whether the columns of a term stand for the sizes that the amplitudes have."""
        sizes = [self.amplitudes.get(name, 0.0) / per for name, per in zip(term.unknowns, term.per, strict=True)]
        rounding = 1e-9
        return all(
            low - rounding * abs(low) <= size <= high + rounding * abs(high)
            for low, size, high in zip(term.low, sizes, term.high, strict=True)
        )


@dataclass(frozen=True)
class Tried:
    """A pair fitted with the exact model, the contest in which it stands alone, and the twins of all causes there."""

    contest: Contest
    found: Fit
    twins: Mapping[int, tuple[Twin, ...]]

    @property
    def worth(self) -> float:
        """Log-likelihood of the readings as they are, parameters paid for."""
        return worth(self.contest, self.found)


def second_beside_first(full: Contest, winner: int, best: Fit, rows: NDArray[np.bool_]) -> Contest | None:
    """Return the contest with pairs that are better than the answer when they are fitted; None where there are none."""
    is_split = any(file >= 0 for term in full.problem.terms for file in term.files)
    if full.evidence.rows > MOST_ROWS or is_split:
        return None
    if full.found.hypotheses[winner].kind == "two" and not _has_twins(full, best) and _is_sum(full, best):
        return None
    plain = replace(full, noise=replace(full.noise, residuals=residuals_of(full.problem.machine)))
    tried = [pair for first in _firsts(plain, winner) for pair in _fitted_beside(plain, first, rows)]
    top = max(tried, key=lambda pair: pair.worth, default=None)
    if top is None or top.worth < worth(plain, best) + BETTER:
        return None
    noise = noise_after(top.contest, 0, top.found, full.noise)
    problem = full.problem
    if is_off(top.contest, top.found):
        problem = _about(problem, input_values(top.contest, top.found))
        noise = moved_to(noise, full.problem.machine, problem.machine)
    for pair in tried:
        if pair.worth > top.worth - NEARLY:
            causes = placed(pair.contest, pair.found)
            owner = causes[1].owner
            twins = {**problem.twins, owner: pair.twins.get(owner, ())}
            problem = replace(_competing(problem, causes), twins=twins)
    return contest(problem, noise, rows, rounds=1)


def _has_twins(full: Contest, best: Fit) -> bool:
    """Whether a cause of a fit is the same curve as another one, alone at least."""
    return any(full.problem.twins.get(piece.owner) for piece in best.hypothesis.pieces)


def _is_sum(full: Contest, best: Fit) -> bool:
    """Whether a fitted pair does no more than the sum of what its two causes do, as far as the noise lets see."""
    import numpy as np

    fitter = Fitter(full, best.hypothesis)
    made = []
    for kept in ((0, 1), (0,), (1,), ()):
        off = [item.piece not in kept and not item.is_shape for item in best.parameters]
        made.append(fitter.predicted(np.where(off, 0.0, best.values), best.directions))
    both, first, second, none = made
    left = 0.0
    for channel in full.evidence.channels:
        name = channel.name
        more = (both[name] - first[name] - second[name] + none[name])[channel.rows] / channel.scale
        left += float(more @ more)
    return left < ADDED


def _about(problem: Problem, inputs: Mapping[str, tuple[float, float]]) -> Problem:
    """Lay the search out anew about a machine that is calibrated, where the inputs have moved too far to be linear."""
    design = problem.machine.design
    values = {name: value for name, (value, _) in inputs.items()}
    design = replace(design, calibrated={**design.calibrated, **values})
    return problem_of(machine_of(design, problem.machine.records), problem.scales)


def _firsts(plain: Contest, winner: int) -> Iterator[Placed]:
    """Give causes as fitted alone, beside which the others are looked at: those of the answer, or else the best ones.

    Only what acts on the inputs changes the curves of others.
    """
    found, candidates = plain.found, plain.problem.candidates
    chosen = found.hypotheses[winner]
    if chosen.kind not in {"two", "mixed", "shape"}:
        return
    own = {piece.owner for piece in chosen.pieces if piece.kind == "term"}
    owners = ((place, found.hypotheses[place].pieces[0].owner) for place in found.ranked("one"))
    first = (place for place, owner in owners if owner in own or not own if candidates[owner].effect.place == "inputs")
    for place in islice(first, MOST_FIRST):
        yield placed(plain, fit(plain, place))[0]


def placed(there: Contest, found: Fit) -> list[Placed]:
    """Return the causes of a fit where it has put them."""
    made = []
    for number, piece in enumerate(found.hypothesis.pieces):
        shape = dict(there.problem.terms[piece.place].shape)
        amplitudes: dict[str, float] = {}
        for place, item in enumerate(found.parameters):
            if item.piece == number:
                (shape if item.is_shape else amplitudes)[item.name] = found.si_value(place)
        made.append(Placed(piece.owner, there.problem.candidates[piece.owner], amplitudes, shape))
    return made


def _fitted_beside(plain: Contest, first: Placed, rows: NDArray[np.bool_]) -> Iterator[Tried]:
    """Look at all causes with the first one on, and fit the best pairs with the exact model.

    Twice: the curves are made anew where the first fit has put the pair, and the noise filter is chosen there.
    """
    problem = plain.problem
    own = first.term(problem.machine, problem.scales)
    if own is None:
        return
    there = problem_of(first.switched_on(problem.machine), problem.scales)
    names = [_name(candidate) for candidate in problem.candidates]
    at = {place: names.index(_name(candidate)) for place, candidate in enumerate(there.candidates)}
    terms = [replace(term, candidate=at[term.candidate]) for term in there.terms]
    twins = {
        at[place]: tuple(replace(twin, place=at[twin.place]) for twin in each) for place, each in there.twins.items()
    }
    bare = without_pieces(problem)
    wide = _only_pairs(plain, with_pairs(bare, [(own, term) for term in terms if term.candidate != first.owner]), rows)
    if wide is None:
        return
    for place in islice(wide.found.ranked(), MOST_FITTED):
        near = _only_pairs(plain, _competing(bare, placed(wide, fit(wide, place))), rows)
        if near is not None:
            near, found = _fitted(near)
            yield Tried(near, found, twins)


def _only_pairs(plain: Contest, problem: Problem, rows: NDArray[np.bool_]) -> Contest | None:
    """Hold the contest of the pairs that belong together, and of no others; None where there are none."""
    if not problem.beside:
        return None
    evidence = evidence_of(problem, plain.noise, rows)
    found = search(evidence, pairs((), problem.beside), plain.settings)
    return Contest(problem, plain.noise, evidence, found, plain.settings)


def _fitted(near: Contest) -> tuple[Contest, Fit]:
    """Fit the one pair of a contest; again where another noise filter goes better with what the exact fit leaves."""
    found = fit(near, 0)
    best = max(near.settings, key=lambda setting: worth(near, replace(found, setting=setting)))
    if best != found.setting:
        near = replace(near, found=replace(near.found, setting=(best,)))
        found = fit(near, 0)
    return near, found


def _name(candidate: Candidate) -> tuple[str, ...]:
    return candidate.name, *(unknown.name for unknown in candidate.amplitudes)


def _competing(problem: Problem, causes: Sequence[Placed]) -> Problem:
    """Return the problem with the curves of a pair where it was fitted, that of the second beside the first."""
    first, second = causes
    one = first.term(problem.machine, problem.scales)
    two = second.term(first.switched_on(problem.machine), problem.scales)
    return problem if one is None or two is None else with_pairs(problem, [(one, two)])
