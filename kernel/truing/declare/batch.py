"""Words for the body of a calculation: what must hold, optional inputs, values that meet an axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Float
from truing.errors import InfeasibleError, TruingError


class FailedRows:
    """Rows of one batch that broke a condition, each with the first sentence it broke.

    ``of`` holds, by result, the rows that have no answer to that one and may have others. ``is_single`` says that
    a condition of the whole row ends the calculation.
    """

    def __init__(self, rows: int, *, is_single: bool = False) -> None:
        self.codes: NDArray[np.int32] = np.zeros(rows, dtype=np.int32)
        self.sentences: list[str] = []
        self.of: dict[str, FailedRows] = {}
        self.is_single = is_single

    def add(self, failed: Any, sentence: str) -> None:
        """Note ``sentence`` for every failed row that has none yet.

        ``failed`` is one bool for all rows, (rows,), (rows, k), or (k,) along an axis that no column reaches.
        """
        if failed.ndim > 1:
            failed = failed.any(axis=tuple(range(1, failed.ndim)))
        elif failed.ndim and len(failed) != len(self.codes):
            failed = failed.any(keepdims=True)
        fresh = np.broadcast_to(failed, self.codes.shape) & (self.codes == 0)
        if fresh.any():
            self.sentences.append(sentence)
            self.codes[fresh] = len(self.sentences)

    def take(self, other: FailedRows, prefix: str = "") -> None:
        """Note what failed in another log of the same rows, whose results have a prefix here."""
        for number, sentence in enumerate(other.sentences, start=1):
            self.add(other.codes == number, sentence)
        for name, lacking in other.of.items():
            self.of.setdefault(prefix + name, FailedRows(len(self.codes))).take(lacking)

    def reasons(self, rows: int) -> dict[int, str]:
        """Return why rows failed, by row; what holds for a batch of one answer holds for all its ``rows``."""
        codes = np.broadcast_to(self.codes, (rows,))
        return {int(row): self.sentences[codes[row] - 1] for row in np.flatnonzero(codes)}


_WATCH: ContextVar[FailedRows | None] = ContextVar("truing_failed_rows", default=None)


@contextmanager
def watching(rows: int, *, is_single: bool = False) -> Iterator[FailedRows]:
    """Collect what ``feasible`` finds in a batch of ``rows``; ``is_single``: what ends the calculation still does."""
    failed = FailedRows(rows, is_single=is_single)
    token = _WATCH.set(failed)
    try:
        yield failed
    finally:
        _WATCH.reset(token)


@contextmanager
def reasons_of_part(prefix: str) -> Iterator[FailedRows | None]:
    """Collect what ``feasible`` finds in one calculation of several, whose results have a prefix in the whole.

    Give what it is collected in, None where nobody watches.
    """
    failed = _WATCH.get()
    if failed is None:
        yield None
        return
    own = FailedRows(len(failed.codes), is_single=failed.is_single)
    token = _WATCH.set(own)
    try:
        yield own
    finally:
        _WATCH.reset(token)
        failed.take(own, prefix)


def feasible(
    holds: Any, sentence: str, *, only: Sequence[str] = (), error: type[TruingError] = InfeasibleError
) -> None:
    """State what must hold; NaN does not hold.

    A single calculation ends with ``InfeasibleError`` and the sentence; in a batch the row keeps its reason and
    the others go on. ``holds`` is a bool or an array (n,) or (n, k): a row fails if any of its values does.

    ``only`` names results (flat names): where it does not hold these alone have no answer, with the sentence as the
    reason, and all others stand. The function returns any number for them, which nobody sees. ``error`` is raised in
    place of InfeasibleError: ConvergenceError where an iteration did not arrive.
    """
    values = np.asarray(holds, dtype=bool)
    if values.all():
        return
    failed = _WATCH.get()
    if failed is not None and only:
        for name in only:
            failed.of.setdefault(name, FailedRows(len(failed.codes))).add(np.logical_not(values), sentence)
    elif failed is not None and not failed.is_single:
        failed.add(np.logical_not(values), sentence)
    elif not only:
        raise error(sentence)


def either(value: Float, otherwise: Float) -> Float:
    """Return ``value`` where it is given (not NaN), else ``otherwise``."""
    if isinstance(value, (int, float)):
        return otherwise if value != value else value
    return np.where(np.isnan(value), otherwise, value)


def column(value: Float) -> Float:
    """Make one value per row meet an axis: (n,) becomes (n, 1); a number stays a number."""
    return value[..., np.newaxis] if isinstance(value, np.ndarray) and value.ndim else value
