"""How much of what the model missed each named cause accounts for."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.chosen import Chosen
from truing.diagnosis.result import Cause

if TYPE_CHECKING:
    from numpy.typing import NDArray


def by_share(chosen: Chosen, causes: tuple[Cause, ...]) -> tuple[Cause, ...]:
    """Return the causes with their shares, the largest first.

    What a cause adds is the extended model less the same without it, at every row, in units of the noise. Its share is
    that of its mean square in the sum of the mean squares of all.
    """
    if len(causes) < 2:
        return causes
    best = chosen.best
    points = [(_without(chosen, name), best.moved) for name in ("", *(cause.effect for cause in causes))]
    whole, *rest = chosen.competition.extended.at(best.causes, points)
    squares = np.array(
        [
            sum(
                np.nansum(((whole[each.name] - less[each.name])[each.rows] * each.factors / each.weights) ** 2)
                for each in best.sample.channels
            )
            for less in rest
        ]
    )
    if not squares.sum() > 0:
        return causes
    weighed = [replace(cause, share=float(share)) for cause, share in zip(causes, squares / squares.sum(), strict=True)]
    return tuple(sorted(weighed, key=lambda cause: -cause.share))


def _without(chosen: Chosen, name: str) -> list[NDArray[np.float64]]:
    """Return the numbers of the explanation with the amplitudes of one name at zero."""
    made = []
    for cause, values in zip(chosen.best.causes, chosen.best.values, strict=True):
        made.append(values.copy())
        if cause.name == name:
            made[-1][cause.amplitudes] = 0.0
    return made
