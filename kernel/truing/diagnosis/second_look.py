"""A second look at rows that were taken for outliers: do they fit the named cause, with other shapes?

Clipping keeps what fits badly from pulling. Where a few rows alone tell a shape (the peak of a resonance), rows that
fit the first guess badly are clipped, so that the guess stays. An exact fit to the readings as they are shows whether
the noise is then smaller and more normal; if so the noise is learnt anew from it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest, contest
from truing.diagnosis.fit import Fit, Fitter, fit, white_residual
from truing.diagnosis.grids import is_smooth
from truing.diagnosis.hypotheses import Hypothesis
from truing.diagnosis.noise import likelihood_of
from truing.diagnosis.problem import Problem, at_shapes
from truing.diagnosis.search import learned, residuals_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOST_ROWS = 20_000
BETTER = 4.0
"""Log-likelihood by which the fit to the readings as they are must be better."""


def second_look(full: Contest, place: int, best: Fit, rows: NDArray[np.bool_]) -> Contest | None:
    """Return the contest with the noise learnt anew where rows were clipped that fit; None where none were."""
    problem, hypothesis = full.problem, best.hypothesis
    is_clipped = any(tail.clipped > 0 for tail in full.noise.tails.values())
    if not is_clipped or not _has_smooth_shapes(problem, hypothesis) or full.evidence.rows > MOST_ROWS:
        return None
    raw = residuals_of(problem.machine)
    plain = replace(full, noise=replace(full.noise, residuals=raw))
    again = fit(plain, place)
    if _likelihood(plain, again) < _likelihood(plain, best) + BETTER:
        return None
    machine = problem.machine
    fitted = tuple(
        (again.predicted[channel.name] - machine.base[channel.name] - machine.shifts[channel.name])[channel.rows]
        / channel.scale
        for channel in full.evidence.channels
    )
    solution = replace(full.solution(place), fitted=fitted)
    noise = learned(problem, full.evidence, solution, raw, full.noise)
    return contest(at_shapes(problem, hypothesis.pieces, _shapes(again)), noise, rows, rounds=1)


def _has_smooth_shapes(problem: Problem, hypothesis: Hypothesis) -> bool:
    owners = [problem.candidates[piece.owner] for piece in hypothesis.pieces if piece.kind == "term"]
    return any(is_smooth(shape) for owner in owners for shape in owner.shapes)


def _likelihood(plain: Contest, found: Fit) -> float:
    """Return the log-likelihood of the readings as they are at the parameters of a fit."""
    import numpy as np

    fitter = Fitter(plain, found.hypothesis)
    left = white_residual(plain, fitter, found.setting, found.values, found.directions)
    ends = np.cumsum([len(channel) for channel in plain.evidence.channels])[:-1]
    return sum(likelihood_of(part) for part in np.split(left, ends))


def _shapes(found: Fit) -> dict[int, dict[str, float]]:
    """Return the fitted shapes by the place of their piece."""
    made: dict[int, dict[str, float]] = {}
    for number, item in enumerate(found.parameters):
        if item.is_shape:
            made.setdefault(item.piece, {})[item.name] = found.si_value(number)
    return made
