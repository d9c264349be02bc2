"""Linear algebra on one thread: its sums then have one order, so that results do not depend on the machine's cores."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep the linear algebra of numpy and scipy on one thread, both loaded first: a later one would not be held."""
    with threadpool_limits(limits=1):
        yield
