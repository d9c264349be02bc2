"""Where batches are computed: here, or in worker processes. The answer never depends on which."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future
from typing import Any, TypeVar

from truing.errors import UsageError

J = TypeVar("J")
A = TypeVar("A")


class SerialExecutor(Executor):
    """Computes every call at once, in this process."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call now and return the finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except BaseException as error:
            if not isinstance(error, Exception):
                raise
            future.set_exception(error)
        return future


def open_executor(address: str) -> Executor:
    """Open "serial" or "processes:N"; a ``with`` block closes it. Raises UsageError for any other address."""
    if address == "serial":
        return SerialExecutor()
    kind, _, count = address.partition(":")
    if kind == "processes" and count.isdigit() and int(count) > 0:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        return ProcessPoolExecutor(int(count), mp_context=multiprocessing.get_context("spawn"))
    raise UsageError(f"'{address}' is no place to compute; write serial or processes:4")


def in_order(executor: Executor, function: Callable[[J], A], jobs: Iterable[J], *, window: int = 16) -> Iterator[A]:
    """Yield ``function(job)`` in the order of the jobs, with at most ``window`` of them under way."""
    pending: deque[Future[A]] = deque()
    try:
        for job in jobs:
            pending.append(executor.submit(function, job))
            if len(pending) >= window or isinstance(executor, SerialExecutor):
                yield pending.popleft().result()
        while pending:
            yield pending.popleft().result()
    finally:
        for future in pending:
            future.cancel()
