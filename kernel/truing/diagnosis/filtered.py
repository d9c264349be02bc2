"""Inner products under many noise filters at once.

A filter W makes noise white; what the search needs of columns a and b is a' W'W b. That of every AR(1) filter is made
of three: of the rows, of their differences inside the run, and of the ends of the run. None is negative, so nothing is
lost by rounding, and eight filters cost as much as three. Values stand as (c, n), rows contiguous.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.noise import Setting, carried_over, whiten

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]
    Marks = NDArray[np.bool_]


def mixture(settings: Sequence[Setting]) -> Matrix:
    """Return what every filter takes of every part of ``parts_of`` and ``grams_of``, shape (filters, parts).

    Rows, differences and ends count ``(1 - rho)^2``, ``rho`` and ``rho (1 - rho)``.
    """
    slow = [setting for setting in settings if setting.theta]
    found = np.zeros((len(settings), 3 + len(slow)))
    for place, setting in enumerate(settings):
        if setting.theta:
            found[place, 3 + slow.index(setting)] = 1.0
        else:
            found[place, :3] = (1 - setting.rho) ** 2, setting.rho, setting.rho * (1 - setting.rho)
    return found


def parts_of(values: Matrix, starts: Marks, settings: Sequence[Setting]) -> Iterator[Matrix]:
    """Give the parts of W'W applied to values (c, n), mixed by ``mixture``."""
    steps = (values[:, 1:] - values[:, :-1]) * ~starts[1:]
    bent = np.zeros_like(values)
    bent[:, 1:] = steps
    bent[:, :-1] -= steps
    yield values
    yield bent
    yield values * _ends(starts)
    for setting in settings:
        if setting.theta:
            yield _back(_white(values, starts, setting), starts, setting)


def grams_of(values: Matrix, starts: Marks, settings: Sequence[Setting]) -> Iterator[Matrix]:
    """Give the parts of the inner products of values (c, n) with themselves, (c, c) each, mixed by ``mixture``."""
    steps = (values[:, 1:] - values[:, :-1]) * ~starts[1:]
    weight = _ends(starts)
    outer = values[:, weight > 0] * np.sqrt(weight[weight > 0])
    yield values @ values.T
    yield steps @ steps.T
    yield outer @ outer.T
    for setting in settings:
        if setting.theta:
            white = _white(values, starts, setting)
            yield white @ white.T


def _ends(starts: Marks) -> Matrix:
    """Return 1 at the first and last row of a run, 2 where it has only one, else 0."""
    found = starts.astype(float)
    found += np.append(starts[1:], True)
    return found


def _white(values: Matrix, starts: Marks, setting: Setting) -> Matrix:
    """Turn noise into innovations for values (c, n)."""
    return whiten(values.T, starts, setting).T


def _back(white: Matrix, starts: Marks, setting: Setting) -> Matrix:
    """Apply the transpose of ``_white``."""
    ratio = setting.variance_ratio
    first = white[:, starts] / np.sqrt(ratio)
    driven = np.array(white)
    driven[:, starts] = 0.0
    driven = carried_over(driven.T, starts, setting.theta, backwards=True).T
    made = np.array(driven)
    made[:, starts] /= ratio
    made[:, :-1] -= setting.rho * driven[:, 1:] * ~starts[1:]
    made[:, starts] += first
    return made
