"""The kinds of arrays that studies and the diagnosis work with."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
Indices = NDArray[np.intp]
Sides = NDArray[np.int8]
"""By row: 1 where the true value lies above the reading, -1 where it lies below, 0 where it was read."""


def first_alike(columns: Sequence[NDArray[Any]]) -> Indices:
    """Return for each row of columns (n,) the place of the first one that is equal in all; what is missing is equal."""
    cells = np.column_stack(columns)
    cells = np.where(np.isnan(cells), np.nan, cells + 0.0)  # one NaN, one zero: rows are compared by their bytes
    rows = np.ascontiguousarray(cells).view(np.dtype((np.void, cells.itemsize * cells.shape[1])))[:, 0]
    _, first, group = np.unique(rows, return_index=True, return_inverse=True)
    return np.asarray(first[group])
