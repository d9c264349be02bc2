"""Columns of many rows, block by block: single precision where they are kept, double where they are added up."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

MANY = 200_000
"""More rows than this are stored in single precision."""
BLOCK = 8192


def in_blocks(rows: int) -> Iterator[slice]:
    """Give the rows in blocks, one after another."""
    for begin in range(0, rows, BLOCK):
        yield slice(begin, min(begin + BLOCK, rows))


def times(matrix: Matrix, vector: Matrix) -> Matrix:
    """Return a matrix of many rows times a vector, in double precision, block by block."""
    if len(matrix) <= BLOCK:
        return np.asarray(matrix @ vector)
    made = np.empty(len(matrix))
    for rows in in_blocks(len(matrix)):
        made[rows] = matrix[rows] @ vector
    return made
