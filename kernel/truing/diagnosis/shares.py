"""How much of what the model missed each named cause accounts for."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest
from truing.diagnosis.fit import Fit, Fitter
from truing.diagnosis.result import Cause

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def by_share(full: Contest, best: Fit, causes: tuple[Cause, ...]) -> tuple[Cause, ...]:
    """Return the causes with their shares, the largest first.

    What a cause adds is the extended model less the same without it, at every row, in units of the noise. Its share is
    that of its mean square in the sum of the mean squares of all.
    """
    import numpy as np

    if len(causes) < 2:
        return causes
    fitter = Fitter(full, best.hypothesis)
    squares = np.array([np.sum(np.square(_part(fitter, best, cause))) for cause in causes])
    if not squares.sum() > 0:
        return causes
    shares = squares / squares.sum()
    weighed = [replace(cause, share=float(share)) for cause, share in zip(causes, shares, strict=True)]
    return tuple(sorted(weighed, key=lambda cause: -cause.share))


def _part(fitter: Fitter, best: Fit, cause: Cause) -> NDArray[np.float64]:
    """Return what a cause adds to all results, one below the other, in units of their noise."""
    import numpy as np

    off = best.values.copy()
    for place, item in enumerate(best.parameters):
        if not item.is_shape and _owner(fitter.contest, best, item.piece) == cause.effect:
            off[place] = 0.0
    without = fitter.predicted(off, best.directions)
    channels = fitter.contest.evidence.channels
    return np.concatenate(
        [(best.predicted[item.name] - without[item.name])[item.rows] / item.scale for item in channels]
    )


def _owner(full: Contest, best: Fit, place: int) -> str:
    """Return the name of the cause that a piece of the explanation belongs to; nothing for a shape."""
    piece = best.hypothesis.pieces[place]
    if piece.kind == "term":
        return full.problem.candidates[piece.owner].name
    return f"input:{full.problem.machine.inputs[piece.owner].name}" if piece.kind == "input" else ""
