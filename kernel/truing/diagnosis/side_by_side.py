"""Work that needs the model again and again, side by side: what all of it asks for at one time is one call.

Each task has a thread, of which one runs at a time, in turn, so that the order of everything is always the same. A task
may have tasks of its own. What asks must hold no lock meanwhile: a cached property has one that all instances share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextvars import ContextVar, copy_context
from dataclasses import dataclass, field
from threading import Semaphore, Thread
from typing import Any, Generic, TypeVar

Q = TypeVar("Q")
T = TypeVar("T")


class _LeftOffError(BaseException):
    """Ends a task that waits when another one has failed."""


@dataclass(eq=False)
class _Task(Generic[T]):
    """One task: what it does, what it waits to be answered, what it was answered, how it ended."""

    work: Callable[[], T]
    turn: Semaphore = field(default_factory=lambda: Semaphore(0))
    is_back: Semaphore = field(default_factory=lambda: Semaphore(0))
    asked: Any = None
    answer: Any = None
    made: list[T] = field(default_factory=list)
    error: BaseException | None = None
    is_ended: bool = False

    def ask(self, asked: Any) -> Any:
        """Wait, in the thread of the task, for the answer to what is asked."""
        self.asked = asked
        self.is_back.release()
        self.turn.acquire()
        if isinstance(self.answer, BaseException):
            raise self.answer
        return self.answer

    def run(self) -> None:
        """Do the work, in the thread of the task."""
        self.turn.acquire()
        _TASK.set(self)
        try:
            if self.answer is None:  # else it is left off before it has begun
                self.made.append(self.work())
        except BaseException as error:  # it is raised again by the one who waits
            self.error = error
        self.is_ended, self.asked = True, None
        self.is_back.release()

    def go_on(self, answer: Any) -> None:
        """Let the task run until it asks something or has ended."""
        self.answer = answer
        self.turn.release()
        self.is_back.acquire()


_TASK: ContextVar[_Task[Any] | None] = ContextVar("truing_task_beside_others", default=None)


def asked_beside(asked: Q, answer: Callable[[Q], T]) -> T:
    """Return the answer to what is asked; in a task, by way of the one who waits for it."""
    task = _TASK.get()
    made: T = answer(asked) if task is None else task.ask(asked)
    return made


def side_by_side(several: Sequence[Callable[[], T]], answer: Callable[[list[Any]], list[Any]]) -> list[T]:
    """Return what several tasks make; ``answer`` answers all that they ask at one time.

    Raises what a task raises; the others then end as well.
    """
    tasks = [_Task(work) for work in several]
    for task in tasks:
        Thread(target=copy_context().run, args=(task.run,), daemon=True).start()
    try:
        for task in tasks:
            _advance(task, None)
        while waiting := [task for task in tasks if not task.is_ended]:
            for task, each in zip(waiting, answer([task.asked for task in waiting]), strict=True):
                _advance(task, each)
    finally:
        for task in tasks:
            if not task.is_ended:
                task.go_on(_LeftOffError())
    return [made for task in tasks for made in task.made]


def _advance(task: _Task[Any], answer: Any) -> None:
    task.go_on(answer)
    if task.error is not None:
        raise task.error
