"""What each cause adds to the model, and how much of what the model missed each named one accounts for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from truing.diagnosis.arrays import Matrix
from truing.diagnosis.chosen import Chosen
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.result import Cause


def by_share(chosen: Chosen, causes: tuple[Cause, ...]) -> tuple[Cause, ...]:
    """Return the causes with their shares, the largest first.

    What a cause adds is the extended model less the same without it, at every row, in units of the noise. Its share is
    that of its mean square in the sum of the mean squares of all.
    """
    if len(causes) < 2:
        return causes
    best = chosen.best
    added = added_by(best, chosen.competition.extended)
    squares = np.array(
        [
            sum(
                np.sum((added[cause.effect][each.name][each.rows] * each.factors / each.weights) ** 2)
                for each in best.sample.channels
            )
            for cause in causes
        ]
    )
    if not squares.sum() > 0:
        return causes
    weighed = [replace(cause, share=float(share)) for cause, share in zip(causes, squares / squares.sum(), strict=True)]
    return tuple(sorted(weighed, key=lambda cause: -cause.share))


def added_by(found: Fit, extended: Extended) -> dict[str, dict[str, Matrix]]:
    """Return by name of a cause what all that it names adds to each result of an explanation, SI on all rows."""
    names = list(dict.fromkeys(cause.name for cause in found.causes))
    whole, *without = extended.at(found.causes, [(_without(found, name), found.moved) for name in ("", *names)])
    return {
        name: {result: np.nan_to_num(whole[result] - values) for result, values in less.items()}
        for name, less in zip(names, without, strict=True)
    }


def _without(found: Fit, name: str) -> list[Matrix]:
    """Return the numbers of an explanation with the amplitudes of one name at zero."""
    made = []
    for cause, values in zip(found.causes, found.values, strict=True):
        made.append(values.copy())
        if cause.name == name:
            made[-1][cause.amplitudes] = 0.0
    return made
