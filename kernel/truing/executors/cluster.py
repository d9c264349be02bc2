"""A cluster: everything is left to dask.distributed, but for sentences, and a count of the workers that were lost."""

from __future__ import annotations

import logging
import platform
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from functools import lru_cache
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

from truing.errors import LostWorkersError, UsageError
from truing.executors.places import WorkerPool
from truing.kernel.loading import code_hash

CONNECT_SECONDS = 15
WORKER_SECONDS = 30
EMPTY_SECONDS = 60
ANSWER_SECONDS = 10
PATIENCE = 5.0
MOST_RENEWALS = 3


class ClusterExecutor(WorkerPool):
    """The workers of a dask scheduler; dask hands out again what a lost worker had, ``losses`` counts such workers.

    Raises UsageError where dask.distributed is missing, where no scheduler answers in 15 s, or no worker is there in
    30 s; LostWorkersError later, where the scheduler is lost, where no worker is left for 60 s, or where one batch has
    ended several workers.
    """

    patience = PATIENCE
    moment = 0.25

    def __init__(self, address: str) -> None:
        self.where = address
        self._dask = _dask()
        self._lock = threading.Lock()
        self._seen: set[str] = set()
        self._gone: list[str] = []
        self._retired: set[str] = set()
        self._warnings: dict[str, None] = {}
        self._code: tuple[str, ...] = ()
        self._renewals = 0
        self._empty_since: float | None = None
        self._grown = False
        self._levels = _silenced()
        try:
            self._open()
        except BaseException:
            self._unsilence()
            raise

    def _open(self) -> None:
        self._client = _connected(self._dask, self.where)
        try:
            _demand_worker(self._client, self.where)
            self._client.subscribe_topic("all", self._heard)
            self._executor = self._client.get_executor(pure=False)
            self._present()
        except BaseException:
            self._client.close()
            raise

    @property
    def losses(self) -> int:  # type: ignore[override]
        """How many workers were lost: those that the scheduler says are gone and did not take their leave."""
        with self._lock:
            return len(self._gone)

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand a call to the scheduler."""
        if self._grown:
            with suppress(Exception):
                self._present()
        answer: Future[Any] = self._executor.submit(function, *args, **kwargs)
        return answer

    def compare(self, code: tuple[str, ...]) -> None:
        """Compare versions, and the code of these packages or files, with those of all workers; note what differs."""
        self._code = code
        said = self._client.run(versions_here, code, on_error="return")
        without = sorted(address for address, versions in said.items() if isinstance(versions, ModuleNotFoundError))
        if without:
            raise UsageError(f"worker {without[0]} of {self.where} has no truing; install it where the worker runs")
        workers = {address: versions for address, versions in said.items() if isinstance(versions, dict)}
        for sentence in differences(versions_here(code), workers):
            self._warnings.setdefault(sentence)

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether the cluster, and not the job, failed."""
        lost = (CancelledError, self._dask.KilledWorker, self._dask.comm.core.CommClosedError)
        return isinstance(error, lost) or self._client.status == "closed"

    def renew(self, error: BaseException) -> None:
        """Connect again, for work that was cancelled with the connection. Raises LostWorkersError where that fails."""
        if isinstance(error, self._dask.KilledWorker):
            times = error.allowed_failures + 1
            raise LostWorkersError(
                f"{times} workers of {self.where} ended over the same batch; their logs say why (memory, most often)"
            )
        self._renewals += 1
        if self._renewals > MOST_RENEWALS:
            raise LostWorkersError(
                f"the work was cancelled {self._renewals} times at {self.where}; is it restarted again?"
            )
        with suppress(Exception):
            self._client.close(timeout=1)
        try:
            self._open()
        except UsageError as lost:
            raise LostWorkersError(f"the cluster was lost: {lost}") from None

    def look_after(self) -> Exception | None:
        """See whether there is still a worker, and a scheduler.

        Raises LostWorkersError where there has been no worker for a minute.
        """
        if self._client.status == "closed":  # it was connecting again, and has given up
            return CancelledError()
        with suppress(Exception):  # a lost connection cancels what is under way, which is seen to there
            if self._present():
                self._empty_since = None
                return None
            self._empty_since = self._empty_since or time.monotonic()
        if self._empty_since is not None and time.monotonic() - self._empty_since > EMPTY_SECONDS:
            raise LostWorkersError(
                f"no worker has been left at {self.where} for {EMPTY_SECONDS} s; start one and run again"
            )
        return None

    def remarks(self) -> list[str]:
        """Say how many workers were lost, and whose versions are others."""
        words = list(self._warnings)
        lost = self.losses
        if lost:
            were = "1 worker was" if lost == 1 else f"{lost} workers were"
            words.append(
                f"{were} lost at {self.where}; what was under way there was computed again, the results are the same"
            )
        return words

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Count once more, and take leave of the cluster; what is still under way there is cancelled."""
        with suppress(Exception):
            self._count_absent()
        with suppress(Exception):
            self._client.close(timeout=5)
        self._unsilence()

    def settle(self) -> None:
        """At the end of the work: compare the workers that joined later too, and count those that are not there."""
        with suppress(Exception):
            self._count_absent()
            self.compare(self._code)

    def _present(self) -> dict[str, int]:
        """Ask who is there now, and how much they do at once."""
        self._grown = False
        threads = self._threads()
        with self._lock:
            self._seen |= set(threads)
        self.workers = max(self.workers, len(threads))
        self.slots = max(1, sum(threads.values()))
        return threads

    def _threads(self) -> dict[str, int]:
        """Return how many threads each worker has. Raises an exception where no answer comes."""
        if self._client.status == "closed":  # its event loop has ended too: nobody would answer
            raise CancelledError
        client = self._client
        threads: dict[str, int] = client.sync(client.scheduler.ncores, workers=None, callback_timeout=ANSWER_SECONDS)
        return threads

    def _heard(self, event: tuple[float, Any]) -> None:
        """Hear what the scheduler says of its workers."""
        message = event[1]
        if not isinstance(message, dict):
            return
        with self._lock:
            if message.get("action") == "remove-worker":
                address = str(message.get("worker", ""))
                (self._retired.add if message.get("expected") else self._gone.append)(address)
            elif message.get("action") == "add-worker":
                self._seen.add(str(message.get("worker", "")))
                self._grown = True

    def _unsilence(self) -> None:
        for name, level in self._levels.items():
            logging.getLogger(name).setLevel(level)

    def _count_absent(self) -> None:
        """Count workers that have gone without a word of the scheduler."""
        present = set(self._threads())
        with self._lock:
            self._gone += sorted(self._seen - present - self._retired - set(self._gone))


def _dask() -> Any:
    """Import dask.distributed, which takes a second."""
    try:
        return import_module("distributed")
    except ImportError:
        raise UsageError('a cluster needs dask.distributed; install it with: pip install "truing[cluster]"') from None


def _silenced() -> dict[str, int]:
    """Silence the library: what it has to say of losses is said in our words. Return the levels there were.

    Its event loop stays silent for good: callbacks that an interrupt cancelled complain after everything is closed.
    """
    logging.getLogger("tornado.application").setLevel(logging.CRITICAL + 1)
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    levels = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    return levels


def _connected(dask: Any, address: str) -> Any:
    try:
        return dask.Client(address, timeout=CONNECT_SECONDS, set_as_default=False, name="truing")
    except (OSError, TimeoutError):
        raise UsageError(
            f"no scheduler answers at {address} within {CONNECT_SECONDS} s; is dask scheduler running there?"
        ) from None
    except ValueError as error:
        raise UsageError(f"'{address}' is no address of a scheduler, like tcp://host:8786: {error}") from None
    except Exception as error:  # what another version of dask has to say
        words = f"{type(error).__name__}: {error}"
        raise UsageError(
            f"the scheduler at {address} does not understand dask {dask.__version__} of this machine ({words}); "
            "install the same version there"
        ) from None


def _demand_worker(client: Any, address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=WORKER_SECONDS)
    except TimeoutError:
        raise UsageError(
            f"the scheduler at {address} has had no worker for {WORKER_SECONDS} s; start one: dask worker {address}"
        ) from None


# What a process computes with: versions, and the code of Truing and of the plugin as they were loaded


PACKAGES = ("truing", "numpy", "scipy")


@lru_cache(maxsize=8)
def versions_here(code: tuple[str, ...] = ()) -> dict[str, str]:
    """Return the versions of Python and of what computes, and for each place in ``code`` a hash of its source.

    A place is the name of a package or module, or the path of a Python file. The answer is that of the first call: what
    a process has loaded does not change when a file does.
    """
    versions = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            versions[name] = ""
    return {**versions, **{f"the code of {Path(source).name}": code_hash(source) for source in code}}


def differences(here: Mapping[str, str], workers: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Say of every version that some worker has otherwise than this process, which it is."""
    words = []
    for name, own in here.items():
        others = {address: said.get(name, "") for address, said in workers.items() if said.get(name, "") != own}
        if not others:
            continue
        address, other = min(others.items())
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        if name.startswith("the code of"):
            words.append(f"{name} is not the same on worker {address}{more} as here: {_MAY_DIFFER}")
        else:
            words.append(f"worker {address}{more} has {name} {other or 'missing'}, here it is {own}: {_MAY_DIFFER}")
    return words


_MAY_DIFFER = "the results may differ from those of this machine"
