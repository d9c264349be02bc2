"""The kinds of arrays that studies and the diagnosis work with, and linear algebra on one thread."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

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


# Linear algebra on one thread: its sums then have one order, so that results do not depend on the machine's cores


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep the linear algebra of numpy and scipy on one thread, both loaded first: a later one would not be held."""
    with _thread_pools(len(sys.modules)).limit(limits=1):
        yield


@lru_cache(maxsize=1)
def _thread_pools(modules: int) -> ThreadpoolController:
    """Find the libraries that have threads, which takes 10 ms, anew where so many modules are loaded by now."""
    return ThreadpoolController()
