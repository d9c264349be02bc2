"""What tests of studies share: two worker processes, which take seconds to start."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from truing.executors import WorkerPool, open_executor


@pytest.fixture(scope="session")
def two_processes() -> Iterator[WorkerPool]:
    """Two worker processes, for all tests that end none of them."""
    with open_executor("processes:2") as executor:
        yield executor
