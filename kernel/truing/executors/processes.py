"""Worker processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from multiprocessing.connection import wait
from types import TracebackType
from typing import Any

from truing.errors import LostWorkersError
from truing.executors.places import SerialExecutor, WorkerPool

MOST_LOSSES = 3
PATIENCE = 5.0  # where an interrupt does not end a wait (Windows), it is heard after this many seconds


class ProcessExecutor(WorkerPool):
    """Worker processes that start afresh (spawn); when one is lost, all are replaced and ``losses`` counts it."""

    where = "processes"
    patience = PATIENCE
    moment = 0.2

    def __init__(self, workers: int) -> None:
        self.workers = self.slots = workers
        self._pool = self._new_pool()

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand a call to a worker, which may start for it; a function of the user's script is called here."""
        if any(getattr(each, "__module__", "") == "__main__" for each in (function, *args)):
            return SerialExecutor().submit(function, *args, **kwargs)
        answer: Future[Any] = Future()
        with _interrupts_held_back(), _main_left_alone():
            self._pool.submit(function, *args, **kwargs).add_done_callback(partial(_hand_on, answer))
        return answer

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether a worker ended without an answer."""
        return isinstance(error, BrokenProcessPool)

    def renew(self, error: BaseException) -> None:
        """Replace the workers after one was lost. Raises LostWorkersError when it happens again and again."""
        self.losses += 1
        self._pool.shutdown(wait=False, cancel_futures=True)
        if self.losses > MOST_LOSSES:
            raise LostWorkersError(
                f"worker processes ended {self.losses} times without an answer; try without --workers"
            )
        self._pool = self._new_pool()

    def remarks(self) -> list[str]:
        """Say how often workers were lost."""
        if not self.losses:
            return []
        often = "once" if self.losses == 1 else f"{self.losses} times"
        return [
            f"a worker process ended without an answer {often}; its batches were computed again, "
            "the results are the same"
        ]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the workers; where this process has failed or is interrupted, nobody waits for what they compute."""
        if error is not None:
            for process in list((self._pool._processes or {}).values()):
                process.terminate()
        self.shutdown(cancel_futures=error is None)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers."""
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)

    def _new_pool(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self.workers, mp_context=context, initializer=_depend_on_the_parent)


def _hand_on(answer: Future[Any], own: Future[Any]) -> None:
    """Give what the pool has answered to whoever waits, unless nobody does.

    The pool's own futures are never cancelled one by one: it fails where workers end while some are.
    """
    if not answer.set_running_or_notify_cancel():
        return
    error = CancelledError() if own.cancelled() else own.exception()
    if error is not None:
        answer.set_exception(error)
    else:
        answer.set_result(own.result())


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Hear an interrupt after the block; a worker that starts in it hears none in all its life.

    An interrupt from a terminal goes to all processes, and a worker that starts has not yet said that it leaves it to
    its parent.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _main_left_alone() -> Iterator[None]:
    """Let a worker that starts in the block not execute the user's script again.

    What workers compute they import by the name of its module. So a script needs no ``if __name__ == "__main__"``
    around a run; functions of the script itself are called in its own process.
    """
    script = vars(sys.modules["__main__"])
    hidden: dict[str, Any] = {name: script[name] for name in ("__file__", "__spec__") if name in script}
    script.pop("__file__", None)
    script["__spec__"] = None
    try:
        yield
    finally:
        script.update(hidden)


def _depend_on_the_parent() -> None:
    """Leave interrupts to the parent, and end when it ends, however that happens."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
