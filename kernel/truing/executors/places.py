"""A place to compute, as the ordered reduction and run.json see it; and the simplest one, this process."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any


class Place(Executor):
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

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether an error says that a worker was lost, and not that the job failed."""
        return False

    def renew(self, error: BaseException) -> None:
        """Make the place fit for handing out again what was lost. Raises TruingError where that is hopeless."""

    def look_after(self) -> None:
        """See after a long wait whether an answer can still come. Raises TruingError where it cannot."""

    def compare(self, code: tuple[str, ...]) -> None:
        """Compare versions, and the code of these packages or files, with those of the workers."""

    def settle(self) -> None:
        """Look at the workers once more when the work is done."""

    def remarks(self) -> list[str]:
        """Say what befell the workers: one sentence each, for stderr and run.json."""
        return []


class SerialExecutor(Place):
    """Computes every call at once, in this process."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call now and return the finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future
