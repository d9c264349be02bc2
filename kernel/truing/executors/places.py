"""A place to compute, as the ordered reduction and run.json see it; and the simplest one, this process."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

J = TypeVar("J")
A = TypeVar("A")


@dataclass(frozen=True)
class Timed(Generic[A]):
    """Answers to the first jobs of several, and the seconds that they took."""

    answers: Sequence[A]
    seconds: float


def answer_all(function: Callable[[J], A], jobs: Sequence[J]) -> Timed[A]:
    """Answer jobs one after the other, up to one that fails; where that is the first, its error is raised."""
    answers: list[A] = []
    start = time.perf_counter()
    for job in jobs:
        try:
            answers.append(function(job))
        except Exception:
            if not answers:
                raise
            break
    return Timed(answers, time.perf_counter() - start)


def answered(future: Future[Any]) -> bool:
    """Tell whether a future holds an answer, and not an error."""
    return future.done() and not future.cancelled() and future.exception() is None


class WorkerPool(Executor):
    """An executor that knows how many workers it has, how many were lost, and what to do then."""

    where: str = "serial"
    """What run.json calls it."""
    workers: int = 1
    """How many workers share the work."""
    losses: int = 0
    """How many times a worker was lost."""
    slots: int = 1
    """How many jobs are computed at once."""
    patience: float | None = None
    """How many seconds an answer is waited for before ``look_after`` is asked."""

    moment: float = 0.0
    """How many seconds of work travel together, because each journey costs."""

    def known(self, function: Callable[[J], A], job: J) -> Future[Timed[A]] | None:
        """Return the answer of a job that need not be computed, or None."""
        return None

    def submit_together(self, function: Callable[[J], A], jobs: Sequence[J]) -> Future[Timed[A]]:
        """Hand out several jobs at once."""
        return self.submit(answer_all, function, jobs)

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether an error says that a worker was lost, and not that the job failed."""
        return False

    def renew(self, error: BaseException) -> None:
        """Make the place fit for handing out again what was lost. Raises LostWorkersError where that is hopeless."""

    def look_after(self) -> Exception | None:
        """See after a long wait whether an answer can still come; return the loss where one is found.

        Raises LostWorkersError where no answer can come any more.
        """
        return None

    def compare(self, code: tuple[str, ...]) -> None:
        """Compare versions, and the code of these packages or files, with those of the workers."""

    def settle(self) -> None:
        """Look at the workers once more when the work is done."""

    def remarks(self) -> list[str]:
        """Say what befell the workers: one sentence each, for stderr and run.json."""
        return []


class SerialExecutor(WorkerPool):
    """Computes every call at once, in this process."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call now and return the finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future
