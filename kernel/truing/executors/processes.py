"""Worker processes of this machine."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
from typing import Any

from truing.errors import LostWorkersError
from truing.executors.places import Place

MOST_LOSSES = 3
PATIENCE = 5.0  # where an interrupt does not end a wait (Windows), it is heard after this many seconds


class ProcessExecutor(Place):
    """Worker processes that start afresh (spawn); when one is lost, all are replaced and ``losses`` counts it."""

    where = "processes"
    patience = PATIENCE
    moment = 0.2

    def __init__(self, workers: int) -> None:
        self.workers = self.slots = workers
        self._pool = self._new_pool()

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand a call to a worker."""
        return self._pool.submit(function, *args, **kwargs)

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

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers."""
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)

    def _new_pool(self) -> ProcessPoolExecutor:
        import multiprocessing

        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self.workers, mp_context=context, initializer=_depend_on_the_parent)


def _depend_on_the_parent() -> None:
    """Leave interrupts to the parent, and end when it ends, however that happens."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    import multiprocessing
    from multiprocessing.connection import wait

    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
