"""A second look before the verdict, with the exact model and the readings as they are.

The search is linear and robust. Where a few rows alone tell a shape (the peak of a resonance), rows that fit the first
guess badly are clipped as outliers, so that the guess stays; and what chords leave of a cause that bends strongly looks
like something unregistered. An exact fit shows whether the noise is then smaller and more normal; if so, the noise is
learnt anew from it, and the contest is held once more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from math import log
from typing import TYPE_CHECKING

from truing.diagnosis.chords import may_bend
from truing.diagnosis.contest import Contest, contest
from truing.diagnosis.fit import Fit, Fitter, fit
from truing.diagnosis.grids import is_smooth
from truing.diagnosis.hypotheses import Hypothesis, Piece
from truing.diagnosis.noise import likelihood_of
from truing.diagnosis.problem import Problem, at_shapes, bent, of_their_own, with_chords
from truing.diagnosis.residual import white_residuals
from truing.diagnosis.search import NoiseModel, learned, residuals_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOST_ROWS = 20_000
MOST_TRIED = 3
BETTER = 4.0
"""Log-likelihood, its parameters paid for, by which the exact fit must be better."""


def second_look(full: Contest, place: int, best: Fit, rows: NDArray[np.bool_]) -> Contest | None:
    """Return the contest with the noise learnt anew from an exact fit that is better; None where there is none."""
    if full.evidence.rows > MOST_ROWS:
        return None
    plain = replace(full, noise=replace(full.noise, residuals=residuals_of(full.problem.machine)))
    tried = [(each, other, fit(each, other)) for each, other in _worth_it(full, plain, place, rows)]
    worths = [worth(each, found) for each, _, found in tried]
    if not tried or max(worths) < worth(plain, best) + BETTER:
        return None
    return _held_again(tried[worths.index(max(worths))], full.noise, rows)


def _worth_it(full: Contest, plain: Contest, winner: int, rows: NDArray[np.bool_]) -> Iterator[tuple[Contest, int]]:
    """Give the winner if rows were clipped that may tell its shape; the best causes that bend if it holds a shape."""
    chosen = full.found.hypotheses[winner]
    is_clipped = any(tail.clipped > 0 for tail in full.noise.tails.values())
    if is_clipped and _owns(full.problem, chosen, "shapes"):
        yield plain, winner
    if chosen.kind in {"shape", "mixed"}:
        wider = contest(with_chords(full.problem), plain.noise, rows, rounds=1, settings=full.settings)
        ranked = wider.found.ranked("one")
        bending = (place for place in ranked if _owns(wider.problem, wider.found.hypotheses[place], "chords"))
        yield from ((wider, place) for place in islice(bending, MOST_TRIED))


def _owns(problem: Problem, hypothesis: Hypothesis, what: str) -> bool:
    owners = [problem.candidates[piece.owner] for piece in hypothesis.pieces if piece.kind == "term"]
    if what == "chords":
        return any(may_bend(owner) for owner in owners)
    return any(is_smooth(shape) for owner in owners for shape in owner.shapes)


def worth(plain: Contest, found: Fit) -> float:
    """Return the log-likelihood of the readings as they are at the parameters of a fit, these paid for."""
    import numpy as np

    fitter = Fitter(plain, found.hypothesis)
    (left,) = white_residuals(plain, fitter, found.setting, [(found.values, found.directions)])
    ends = np.cumsum([len(channel) for channel in plain.evidence.channels])[:-1]
    price = 0.5 * found.hypothesis.size * log(plain.evidence.rows)
    return sum(likelihood_of(part) for part in np.split(left, ends)) - price


def noise_after(plain: Contest, place: int, found: Fit, before: NoiseModel) -> NoiseModel:
    """Return the noise as an exact fit of one of the hypotheses of a contest says it is."""
    machine, evidence = plain.problem.machine, plain.evidence
    fitted = tuple(
        (found.predicted[channel.name] - machine.base[channel.name] - machine.shifts[channel.name])[channel.rows]
        / channel.scale
        for channel in evidence.channels
    )
    solution = replace(plain.solution(place), fitted=fitted)
    return learned(plain.problem, evidence, solution, plain.noise.residuals, before)


def _held_again(better: tuple[Contest, int, Fit], before: NoiseModel, rows: NDArray[np.bool_]) -> Contest:
    """Hold the contest again with what an exact fit says of the noise, and with its sizes and shapes on the grid."""
    plain, place, found = better
    problem = at_shapes(plain.problem, found.hypothesis.pieces, _shapes(found))
    problem = bent(of_their_own(problem, found.hypothesis.pieces), _sizes(found))
    return contest(problem, noise_after(plain, place, found, before), rows, rounds=1)


def _shapes(found: Fit) -> dict[int, dict[str, float]]:
    """Return the fitted shapes by the place of their piece, SI."""
    made: dict[int, dict[str, float]] = {}
    for number, item in enumerate(found.parameters):
        if item.is_shape:
            made.setdefault(item.piece, {})[item.name] = found.si_value(number)
    return made


def _sizes(found: Fit) -> list[tuple[Piece, float]]:
    """Return the pieces of one column with their coefficients."""
    pieces = found.hypothesis.pieces
    return [
        (pieces[item.piece], float(value))
        for item, value in zip(found.parameters, found.values, strict=True)
        if not item.is_shape and len(pieces[item.piece].columns) == 1
    ]
