"""What numbers and inputs draw about a fit: the derivatives of what the model shows."""

from __future__ import annotations

import numpy as np

from truing.diagnosis.arrays import Matrix
from truing.diagnosis.exact import Fitting
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit, size_of


def slopes_at(found: Fit, extended: Extended) -> tuple[Matrix, Matrix]:
    """Return the derivatives of what a fit predicts, by its numbers and by the directions, in units of the noise.

    Shapes (rows, numbers) per unit of the number as the fit sees it, 0 for what keeps its start, and (rows, K); those
    of the inputs are taken where the fit has put them.
    """
    state = Fitting(found.sample, extended, found.causes, found, held=())
    state.begin(np.concatenate(found.values) if found.causes else np.zeros(0))
    state.derivatives()
    return -state.slope, state.slopes_of_inputs()


def slopes_left(found: Fit, extended: Extended) -> tuple[Matrix, Matrix]:
    """Return the derivatives as the fit left them, without a call of the model; else as ``slopes_at`` does."""
    sample = found.sample
    if not found.moves or (found.causes and not found.slopes):
        return slopes_at(found, extended)
    own = sample.curve(found.slopes, found.predicted) if found.slopes else np.zeros((sample.rows, 0))
    return own, sample.curve(found.moves, found.predicted)


def unit_of(found: Fit) -> Matrix:
    """Return what one unit of every number, as the fit sees it, is in SI at the fitted value."""
    scales = {channel.name: channel.scale for channel in found.sample.channels}
    numbers = [number for cause in found.causes for number in cause.numbers]
    flat = np.concatenate(found.values) if found.causes else np.zeros(0)
    return np.array(
        [value if number.is_log else size_of(number, scales) for number, value in zip(numbers, flat, strict=True)]
    )
