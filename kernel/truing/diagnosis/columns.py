"""Columns of the search: few values stored, the rest made when a block of rows asks for it.

A million rows of five hundred columns are 4 GB. Columns that follow from covariates are made anew for every block;
the curves of effects are stored, as single precision where there are many rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]
    Rows: TypeAlias = slice | NDArray[np.intp] | NDArray[np.bool_]

MANY = 200_000
"""More rows than this are stored in single precision."""
FEW = 20_000
"""Up to so many rows a column that could be made anew is kept."""
HELD = 4_000_000
"""Columns of fewer values than this are made once and kept."""
BLOCK = 8192


class Made:
    """Values of a column, shape (n,), that are computed for the rows that are asked for."""

    def __init__(self, of: Callable[[Rows], Matrix], size: int) -> None:
        self.of, self.size = of, size

    def __len__(self) -> int:
        return self.size

    def __getitem__(self, rows: Rows) -> Matrix:
        return self.of(rows)

    def __mul__(self, factor: float) -> Matrix:
        return self.of(slice(None)) * factor

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        """Return all values, for numpy."""
        import numpy as np

        return np.asarray(self.of(slice(None)), dtype=dtype)


Values: TypeAlias = "Matrix | Made"


def when_asked(of: Callable[[Rows], Matrix], size: int) -> Values:
    """Return values that follow from others: at once where they are few, else when a block of rows asks for them."""
    return of(slice(None)) if size <= FEW else Made(of, size)


@dataclass(frozen=True)
class Column:
    """One column of the search: parts by measured result, shape (n,) over the rows of all records, SI."""

    parts: Mapping[str, Values]
    per: float = 1.0


def stored(values: Matrix) -> Values:
    """Return values as they are kept: missing ones as 0; of many rows, a switch as bits, all else in single precision.

    Numbers of single precision are exact to 6e-8, far below what a model or a gauge is.
    """
    import numpy as np

    if not np.any(values):
        return np.broadcast_to(0.0, np.shape(values))
    if not np.isfinite(values).all():
        values = np.nan_to_num(values)
    if len(values) <= MANY:
        return values
    if bool(((values == 0) | (values == 1)).all()):
        return Made(partial(_switched, np.packbits(values.astype(bool)), len(values)), len(values))
    single: Any = values.astype(np.float32)
    return np.asarray(single)


def _switched(bits: NDArray[np.uint8], size: int, rows: Rows) -> Matrix:
    """Return some of the values of a switch, 0 or 1."""
    import numpy as np

    if isinstance(rows, slice):
        rows = np.arange(*rows.indices(size), dtype=np.intp)
    elif rows.dtype == bool:
        rows = np.flatnonzero(rows)
    return np.asarray((bits[rows >> 3] >> (7 - (rows & 7))) & 1, dtype=np.float64)


def acting(curve: Mapping[str, Values]) -> dict[str, Values]:
    """Return the parts of a curve that are not zero everywhere, without missing values."""
    import numpy as np

    found: dict[str, Values] = {}
    for name, values in curve.items():
        if isinstance(values, Made):
            found[name] = values
        elif np.any(values):
            found[name] = values if np.isfinite(values).all() else np.nan_to_num(values)
    return found


def in_blocks(rows: int) -> Iterator[slice]:
    """Give the rows in blocks, one after another."""
    for begin in range(0, rows, BLOCK):
        yield slice(begin, min(begin + BLOCK, rows))


def times(matrix: Matrix, vector: Matrix) -> Matrix:
    """Return a matrix of many rows times a vector, in double precision, block by block."""
    import numpy as np

    if len(matrix) <= BLOCK:
        return np.asarray(matrix @ vector)
    made = np.empty(len(matrix))
    for rows in in_blocks(len(matrix)):
        made[rows] = matrix[rows] @ vector
    return made


@dataclass(frozen=True)
class Design:
    """All columns of one measured result, SI times ``per``, by blocks of rows; ``rows`` counts those of the records.

    ``known`` keeps inner products of all columns that were needed last.
    """

    name: str
    columns: Sequence[Column]
    rows: int
    known: dict[bytes, Matrix] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def active(self) -> NDArray[np.intp]:
        """Places of the columns that act on this result."""
        import numpy as np

        return np.array([place for place, item in enumerate(self.columns) if self.name in item.parts], dtype=np.intp)

    @cached_property
    def whole(self) -> Matrix | None:
        """All rows of all columns, (active, n), where they are few enough to keep."""
        return self._made(slice(None), self.rows) if self.rows * len(self.active) <= HELD else None

    def block(self, rows: NDArray[np.intp]) -> Matrix:
        """Return the active columns at some rows of the records, shape (active, rows)."""
        import numpy as np

        if self.whole is not None:
            return np.asarray(self.whole[:, rows])
        span = slice(int(rows[0]), int(rows[-1]) + 1)
        if span.stop - span.start == len(rows):
            return self._made(span, len(rows))
        return self._made(rows, len(rows))

    def _made(self, rows: Rows, count: int) -> Matrix:
        import numpy as np

        made = np.empty((len(self.active), count))
        for place, column in enumerate(self.active):
            item = self.columns[column]
            np.multiply(item.parts[self.name][rows], item.per, out=made[place])
        return made
