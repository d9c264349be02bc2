"""Places to compute, the simplest of them this process, and jobs handed out there with answers taken in their order."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from truing.arrays import one_thread
from truing.executors.kept import BatchLog, key_of

J = TypeVar("J")
A = TypeVar("A")


@dataclass(frozen=True)
class Timed(Generic[A]):
    """Answers to the first jobs of several, and the seconds that they took."""

    answers: Sequence[A]
    seconds: float


@one_thread()
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
    log: BatchLog | None = None
    """Where answers are kept, and looked for before they are computed."""

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


def stays_here(executor: Executor) -> bool:
    """Tell whether work stays in this process and is not kept, so that nothing has to travel as plain data."""
    return isinstance(executor, SerialExecutor) and executor.log is None


# Jobs handed out, answers taken in the order of the jobs, and what was lost handed out again


MOST_TOGETHER = 256


def in_order(executor: Executor, function: Callable[[J], A], jobs: Iterable[J], *, window: int = 16) -> Iterator[A]:
    """Yield ``function(job)`` in the order of the jobs, with about ``window`` of them under way.

    Short jobs travel together, as many as are computed in a moment. Jobs that were under way when a worker was lost are
    handed out again. For a place that is not this process (``SerialExecutor``) function and jobs must be picklable.
    """
    pool = executor if isinstance(executor, WorkerPool) else _Foreign(executor)
    work = _Work(pool, function, 1 if pool.where == "serial" else window)
    try:
        for job in jobs:
            yield from work.after(job)
        yield from work.rest()
    finally:
        work.cancel()


class _Foreign(WorkerPool):
    """Any other executor, which is left to itself."""

    where = "foreign"

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        return self._executor.submit(function, *args, **kwargs)


@dataclass
class _Part(Generic[J, A]):
    """Jobs that travel together, and their answers to come."""

    jobs: list[J]
    future: Future[Timed[A]] | None = None
    """None until they are handed out."""


class _Work(Generic[J, A]):
    """The jobs under way, oldest first, and those that wait until enough of them can travel together."""

    def __init__(self, pool: WorkerPool, function: Callable[[J], A], window: int) -> None:
        self._place = pool
        self._function = function
        self._window = window
        self._pending: deque[_Part[J, A]] = deque()
        self._waiting: list[J] = []
        self._together = 1

    def after(self, job: J) -> Iterator[A]:
        """Take one more job, and yield the answers that must come before further ones are taken."""
        log = self._place.log
        kept = [] if log is None else log.kept(key_of(self._function, job))
        if kept:
            self._hand_out()
            done: Future[Timed[A]] = Future()
            done.set_result(Timed(kept, 0.0))
            self._pending.append(_Part([job], done))
        else:
            self._waiting.append(job)
            if len(self._waiting) >= self._together:
                self._hand_out()
        while len(self._pending) >= max(self._window, 4 * (self._place.slots - 1)):
            yield from self._first()

    def rest(self) -> Iterator[A]:
        """Yield all answers that are still to come."""
        self._hand_out()
        while self._pending:
            yield from self._first()

    def cancel(self) -> None:
        """Give up what is under way."""
        for part in self._pending:
            if part.future is not None:
                part.future.cancel()

    def _hand_out(self) -> None:
        if self._waiting:
            self._pending.append(_Part(self._waiting))
            self._waiting = []
            self._submit()

    def _first(self) -> Iterator[A]:
        """Yield the oldest answers. Jobs behind one that failed have none yet and are handed out again."""
        timed = self._awaited()
        part = self._pending.popleft()
        left = part.jobs[len(timed.answers) :]
        if left:
            self._pending.appendleft(_Part(left))
            self._submit()
        if timed.seconds > 0:
            fitting = int(self._place.moment * len(timed.answers) / timed.seconds)
            self._together = max(1, min(fitting, 2 * self._together, MOST_TOGETHER))
        yield from timed.answers

    def _awaited(self) -> Timed[A]:
        """Wait for the oldest answers, handing out again what was lost as often as is sensible."""
        while True:
            future = self._pending[0].future
            assert future is not None  # all parts are handed out
            try:
                return future.result(timeout=self._place.patience)
            except Exception as error:
                waited = isinstance(error, TimeoutError) and not future.done()
                if not waited and not self._place.is_loss(error):
                    raise
                loss = self._place.look_after() if waited else error
                if loss is not None:
                    self._submit(loss)

    def _submit(self, loss: Exception | None = None) -> None:
        """Hand out the parts that are not; after a loss renew the place first, then every unanswered part again."""
        while True:
            if loss is not None:
                self._place.renew(loss)
            try:
                for part in self._pending:
                    if part.future is None or (loss is not None and not answered(part.future)):
                        part.future = self._place.submit(answer_all, self._function, part.jobs)
                        self._keep(part)
                return
            except Exception as error:
                if not self._place.is_loss(error):
                    raise
                loss = error

    def _keep(self, part: _Part[J, A]) -> None:
        """Keep each answer of a part as soon as it is there."""
        log = self._place.log
        if log is None or part.future is None:
            return
        keys = [key_of(self._function, job) for job in part.jobs]

        def put(future: Future[Timed[A]]) -> None:
            if answered(future):
                for key, answer in zip(keys, future.result().answers, strict=False):
                    log.put(key, answer)

        part.future.add_done_callback(put)
