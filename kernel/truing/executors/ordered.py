"""Jobs handed out, answers taken in the order of the jobs, and what was lost handed out again."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future
from typing import Any, TypeVar

from truing.executors.places import Place

J = TypeVar("J")
A = TypeVar("A")


def in_order(executor: Executor, function: Callable[[J], A], jobs: Iterable[J], *, window: int = 16) -> Iterator[A]:
    """Yield ``function(job)`` in the order of the jobs, with about ``window`` of them under way.

    Jobs that were under way when a worker was lost are handed out again. For a place that is not this process
    (``SerialExecutor``) function and jobs must be picklable.
    """
    place = executor if isinstance(executor, Place) else _Foreign(executor)
    pending: deque[tuple[J, Future[A]]] = deque()
    most = 1 if place.where == "serial" else window
    try:
        for job in jobs:
            pending.append((job, _submitted(place, function, job, pending)))
            if len(pending) >= max(most, 4 * (place.slots - 1)):
                yield _first(place, function, pending)
        while pending:
            yield _first(place, function, pending)
    finally:
        for _, future in pending:
            future.cancel()


class _Foreign(Place):
    """Any other executor, which is left to itself."""

    where = "foreign"

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        return self._executor.submit(function, *args, **kwargs)


def _first(place: Place, function: Callable[[J], A], pending: deque[tuple[J, Future[A]]]) -> A:
    """Take the oldest answer, handing out again what was lost as often as is sensible."""
    while True:
        future = pending[0][1]
        try:
            answer = future.result(timeout=place.patience)
        except Exception as error:
            if isinstance(error, TimeoutError) and not future.done():
                place.look_after()
            elif place.is_loss(error):
                _hand_out_again(place, function, pending, error)
            else:
                raise
            continue
        pending.popleft()
        return answer


def _submitted(place: Place, function: Callable[[J], A], job: J, pending: deque[tuple[J, Future[A]]]) -> Future[A]:
    while True:
        try:
            return place.submit(function, job)
        except Exception as error:
            if not place.is_loss(error):
                raise
            _hand_out_again(place, function, pending, error)


def _hand_out_again(
    place: Place, function: Callable[[J], A], pending: deque[tuple[J, Future[A]]], error: Exception
) -> None:
    """Renew the place and submit every unanswered job once more, in the same order."""
    while True:
        place.renew(error)
        try:
            fresh = [(job, future if _answered(future) else place.submit(function, job)) for job, future in pending]
        except Exception as again:
            if not place.is_loss(again):
                raise
            error = again
            continue
        pending.clear()
        pending.extend(fresh)
        return


def _answered(future: Future[Any]) -> bool:
    return future.done() and not future.cancelled() and future.exception() is None
