"""Where batches are computed: here, or in worker processes. The answer never depends on which."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
from typing import Any, TypeVar

from truing.errors import TruingError, UsageError

J = TypeVar("J")
A = TypeVar("A")
MOST_LOSSES = 3


class SerialExecutor(Executor):
    """Computes every call at once, in this process."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call now and return the finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class ProcessExecutor(Executor):
    """Worker processes that start afresh (spawn); when one is lost, all are replaced and ``losses`` counts it."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self.losses = 0
        self._pool = self._new_pool()

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand a call to a worker."""
        return self._pool.submit(function, *args, **kwargs)

    def renew(self) -> None:
        """Replace the workers after one was lost. Raises TruingError when it happens again and again."""
        self.losses += 1
        self._pool.shutdown(wait=False, cancel_futures=True)
        if self.losses > MOST_LOSSES:
            raise TruingError(f"worker processes ended {self.losses} times without an answer; try without --workers")
        self._pool = self._new_pool()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers."""
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)

    def _new_pool(self) -> ProcessPoolExecutor:
        import multiprocessing

        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self.workers, mp_context=context, initializer=_leave_interrupts_to_the_parent)


def _leave_interrupts_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def open_executor(address: str) -> Executor:
    """Open "serial" or "processes:N"; a ``with`` block closes it. Raises UsageError for any other address."""
    if address == "serial":
        return SerialExecutor()
    kind, _, count = address.partition(":")
    if kind == "processes" and count.isascii() and count.isdigit() and int(count) > 0:
        return ProcessExecutor(int(count))
    raise UsageError(f"'{address}' is no place to compute; write serial or processes:4")


def in_order(executor: Executor, function: Callable[[J], A], jobs: Iterable[J], *, window: int = 16) -> Iterator[A]:
    """Yield ``function(job)`` in the order of the jobs, with about ``window`` of them under way.

    Jobs that were under way when a worker was lost are handed out again.
    """
    pending: deque[tuple[J, Future[A]]] = deque()
    window = 1 if isinstance(executor, SerialExecutor) else max(window, 4 * getattr(executor, "workers", 1))
    try:
        for job in jobs:
            pending.append((job, _submitted(executor, function, job, pending)))
            if len(pending) >= window:
                yield _first(executor, function, pending)
        while pending:
            yield _first(executor, function, pending)
    finally:
        for _, future in pending:
            future.cancel()


def _first(executor: Executor, function: Callable[[J], A], pending: deque[tuple[J, Future[A]]]) -> A:
    """Take the oldest answer, replacing lost workers as often as is sensible."""
    while True:
        try:
            answer = pending[0][1].result()
        except BrokenProcessPool:
            _hand_out_again(executor, function, pending)
            continue
        pending.popleft()
        return answer


def _submitted(
    executor: Executor, function: Callable[[J], A], job: J, pending: deque[tuple[J, Future[A]]]
) -> Future[A]:
    while True:
        try:
            return executor.submit(function, job)
        except BrokenProcessPool:
            _hand_out_again(executor, function, pending)


def _hand_out_again(executor: Executor, function: Callable[[J], A], pending: deque[tuple[J, Future[A]]]) -> None:
    """Replace the workers and submit every unanswered job once more, in the same order."""
    if not isinstance(executor, ProcessExecutor):
        raise TruingError("the worker processes ended without an answer; try without --workers")
    while True:
        executor.renew()
        try:
            fresh = [(job, future if _answered(future) else executor.submit(function, job)) for job, future in pending]
        except BrokenProcessPool:
            continue
        pending.clear()
        pending.extend(fresh)
        return


def _answered(future: Future[Any]) -> bool:
    return future.done() and not future.cancelled() and future.exception() is None
