"""Where batches are computed: here, in worker processes, or on a cluster. The answer never depends on which."""

from __future__ import annotations

from truing.errors import UsageError
from truing.executors.cluster import ClusterExecutor
from truing.executors.kept import BatchLog, keepable
from truing.executors.places import SerialExecutor, WorkerPool, in_order, stays_here
from truing.executors.processes import ProcessExecutor

__all__ = [
    "BatchLog",
    "ProcessExecutor",
    "SerialExecutor",
    "WorkerPool",
    "in_order",
    "keepable",
    "open_executor",
    "stays_here",
]


def open_executor(address: str) -> WorkerPool:
    """Open "serial", "processes:N" or "dask:tcp://HOST:PORT"; a ``with`` block closes it.

    Raises UsageError for any other address, and where no cluster answers.
    """
    kind, _, rest = address.partition(":")
    if address == "serial":
        return SerialExecutor()
    if kind == "processes" and rest.isascii() and rest.isdigit() and int(rest) > 0:
        return ProcessExecutor(int(rest))
    if kind == "dask" and "://" in rest:
        return ClusterExecutor(rest)
    raise UsageError(f"'{address}' is no place to compute; write serial, processes:4 or dask:tcp://host:8786")
