"""A dask scheduler and its workers as processes of their own: the same bytes as here, also when a worker is killed."""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from gated import BATCHES, FREE, Gated, run_of, wait_until

from shared import Answer, Calc
from truing.errors import LostWorkersError, UsageError
from truing.executors import cluster as on_cluster
from truing.executors import in_order, open_executor
from warm import Running

distributed = pytest.importorskip("distributed", reason="the extra [cluster] is not installed")

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
MOST_ENDED = 2
"""So many workers a batch may end; four, where nobody says otherwise."""
SETTINGS = {
    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": str(MOST_ENDED - 1),
    "DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD": "forkserver",
}


@dataclass
class Cluster:
    """A scheduler and workers on 127.0.0.1, all of them processes that end with the tests of this file."""

    folder: Path
    address: str = ""
    scheduler: Running | None = None
    workers: list[Running] = field(default_factory=list)

    def with_workers(self, count: int, *, nanny: bool = False) -> Cluster:
        """Let so many workers be there, and a scheduler; what a test has ended is started anew."""
        if self.scheduler is None or self.scheduler.poll() is not None:
            self.end()
            self._start_scheduler()
        self.workers = [worker for worker in self.workers if worker.poll() is None]
        for spare in self.workers[count:]:
            _ended(spare)
        del self.workers[count:]
        options = ("--nthreads", "1", "--nanny" if nanny else "--no-nanny", "--local-directory", str(self.folder))
        while len(self.workers) < count:
            self.workers.append(self._start("dask_worker", self.address, *options))
        with distributed.Client(self.address, set_as_default=False) as client:
            wait_until(lambda: len(client.nthreads()) == count, f"{count} workers are there")
        return self

    def _start_scheduler(self) -> None:
        file = self.folder / "scheduler.json"
        file.unlink(missing_ok=True)
        self.scheduler = started = self._start("dask_scheduler", "--port", "0", "--scheduler-file", str(file))

        def is_written() -> bool:
            assert started.poll() is None, started.said
            try:
                self.address = json.loads(file.read_text(encoding="utf-8"))["address"]
            except (OSError, ValueError):  # not there, or not yet whole
                return False
            return True

        wait_until(is_written, "the scheduler has an address")

    def _start(self, program: str, *arguments: str) -> Running:
        begin = f"import dask; dask.config.refresh(); from distributed.cli.{program} import main; main()"
        place = ("--no-dashboard", "--host", "127.0.0.1")
        return Running(["-c", begin, *arguments, *place], self.folder, SETTINGS, together=True)

    def end(self) -> None:
        for process in [*self.workers, *([self.scheduler] if self.scheduler else [])]:
            _ended(process)
        self.workers.clear()


def _ended(process: Running) -> None:
    if process.poll() is None:
        process.signal(signal.SIGKILL)
    process.ended()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """One for all tests: starting a part of it takes longer than most of them."""
    made = Cluster(tmp_path_factory.mktemp("cluster"))
    yield made
    made.end()


@contextmanager
def beside(action: Callable[[], None]) -> Iterator[None]:
    """Do something in another thread meanwhile."""
    with ThreadPoolExecutor(1) as thread:
        done = thread.submit(action)
        yield
        done.result()


def test_a_cluster_answers_as_one_process(cluster: Cluster, calc: Calc, tmp_path: Path) -> None:
    """With cases; that a single run does, the test of a worker that is killed shows."""
    address = cluster.with_workers(2).address
    words = ("--cases", "cases.csv")
    (tmp_path / "cases.csv").write_text("load [N]\n140\n2200\n500000\n2230\n180\n")
    there = calc("run", PIN, *words, "-q", "-o", "run", "--cluster", address)
    (tmp_path / "run").rename(tmp_path / "there")
    here = calc("run", PIN, *words, "-q", "-o", "run")
    assert (there.code, there.out, there.err) == (here.code, here.out, here.err)
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (tmp_path / "run" / name).read_bytes() == (tmp_path / "there" / name).read_bytes()
    assert run_of(tmp_path / "there")["workers"] == {"count": 2, "lost": 0, "where": address}
    assert run_of(tmp_path / "run")["workers"] == {"count": 1, "lost": 0, "where": "serial"}


def test_a_plugin_in_one_file_reaches_the_cluster_and_another_one_there_is_refused(
    cluster: Cluster, calc: Calc, tmp_path: Path
) -> None:
    address = cluster.with_workers(2).address
    file = tmp_path / "own_wear.py"
    file.write_text(PIN.read_text(encoding="utf-8"), encoding="utf-8")
    words = ("run", file, "-q", "--set", "studies.reliability.draws=140000")
    there = calc(*words, "-o", "there", "--cluster", address)
    assert there.code == 0, there.err
    assert run_of(tmp_path / "there")["warnings"] == []
    with file.open("a", encoding="utf-8") as more:
        more.write("\n# the workers have loaded the file without this line\n")
    changed = Running(["-m", "truing", *words, "-o", "there", "--cluster", address], tmp_path).ended()
    assert changed.code == 3
    assert changed.err.endswith(f"a worker has another {file}; bring the same file there and start it again\n")


@pytest.mark.skipif(sys.platform == "win32", reason="a console signal there stops the test too")
def test_an_interrupted_run_leaves_the_cluster_at_once(cluster: Cluster, tmp_path: Path) -> None:
    address = cluster.with_workers(2).address
    pin = Gated.in_folder(tmp_path)
    process = pin.start("-o", "run", "-q", "--cluster", address)
    pin.at_the_gate(process, FREE + 1)
    process.signal(signal.SIGINT)
    assert process.ended() == Answer(130, "", "calc: interrupted; nothing was written\n")
    pin.open()
    with distributed.Client(address, set_as_default=False) as client:
        wait_until(lambda: not any(client.processing().values()), "the workers have nothing to do")
    assert pin.calls <= FREE + 2  # what the two workers held, and nothing that waited behind it
    assert not (tmp_path / "run").exists()


def test_a_worker_that_is_killed_changes_nothing_but_the_warning(
    cluster: Cluster, calc: Calc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, "pin_wear", raising=False)  # that of another test is another file
    monkeypatch.syspath_prepend(tmp_path)
    address = cluster.with_workers(2).address
    pin = Gated.in_folder(tmp_path)

    def kill_one_at_the_gate() -> None:
        try:
            wait_until(lambda: pin.calls > FREE, "a batch waits")  # the next one may be left to the same worker
            os.kill(pin.callers[-1], signal.SIGKILL)
        finally:
            pin.open()

    with beside(kill_one_at_the_gate):
        answer = calc(*pin.words, "-o", "run", "--cluster", address)
    assert answer.code == 0, answer.err
    fate = "what was under way there was computed again, the results are the same"
    lost = f"1 worker was lost at {address}; {fate}"
    run = run_of(tmp_path / "run")
    assert run["workers"] == {"count": 2, "lost": 1, "where": address}
    assert run["warnings"] == [lost]
    assert f"warning: {lost}\n" in answer.err
    assert pin.calls > BATCHES  # what the killed one held was computed again
    assert calc(*pin.words, "-q", "-o", "serial").code == 0
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (tmp_path / "run" / name).read_bytes() == (tmp_path / "serial" / name).read_bytes()


def test_a_cluster_without_workers_is_told(cluster: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    (only,) = cluster.with_workers(1).workers
    with monkeypatch.context() as hasty:
        hasty.setattr(on_cluster, "EMPTY_SECONDS", 0.2)
        hasty.setattr(on_cluster.ClusterExecutor, "patience", 0.1)
        with open_executor(f"dask:{cluster.address}") as place:
            answers = in_order(place, time.sleep, [0.0] * 16 + [60.0] * 20)
            next(answers)
            only.signal(signal.SIGKILL)
            with pytest.raises(LostWorkersError, match=r"no worker has been left at tcp://.* for 0.2 s"):
                list(answers)
    monkeypatch.setattr(on_cluster, "WORKER_SECONDS", 0.2)
    with pytest.raises(UsageError, match=r"has had no worker for 0.2 s; start one: dask worker tcp://"):
        open_executor(f"dask:{cluster.with_workers(0).address}")


def test_a_batch_that_ends_every_worker_ends_the_run(cluster: Cluster) -> None:
    """A nanny starts the worker again, dask hands it the batch again: as often as it is told, then one sentence."""
    address = cluster.with_workers(0).with_workers(1, nanny=True).address
    with open_executor(f"dask:{address}") as place:
        assert list(in_order(place, abs, range(-40, 0))) == list(range(40, 0, -1))
        with pytest.raises(LostWorkersError, match=rf"{MOST_ENDED} workers of tcp://.* ended over the same batch"):
            list(in_order(place, os._exit, [1]))
        assert place.losses == MOST_ENDED
        assert place.remarks()[-1].startswith(f"{MOST_ENDED} workers were lost at tcp://")


def test_finished_batches_outlive_a_lost_scheduler(
    cluster: Cluster, calc: Calc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The run ends with one sentence; the same command without the cluster goes on, and answers as if undisturbed."""
    monkeypatch.setattr(on_cluster, "CONNECT_SECONDS", 2)
    address = cluster.with_workers(1).address
    pin = Gated.in_folder(tmp_path)

    def lose_the_scheduler() -> None:
        assert cluster.scheduler is not None
        try:
            wait_until(lambda: pin.kept("run") == FREE, "six batches are kept")
        finally:
            cluster.scheduler.signal(signal.SIGKILL)

    with beside(lose_the_scheduler):
        cut_off = calc(*pin.words, "-q", "-o", "run", "--cluster", address, "--resume")
    nobody = f"no scheduler answers at {address} within 2 s; is dask scheduler running there?"
    assert cut_off == Answer(2, "", f"calc: the cluster was lost: {nobody}\n")
    assert not (tmp_path / "run").exists()
    pin.open()
    for folder, more in (("run", ["--resume"]), ("whole", [])):
        assert calc(*pin.words, "-q", "-o", folder, *more).code == 0
    assert run_of(tmp_path / "run")["resumed"] == FREE
    assert (tmp_path / "run" / "results.json").read_bytes() == (tmp_path / "whole" / "results.json").read_bytes()


REFUSED = [
    (["NOBODY"], "no scheduler answers at NOBODY within 1 s; is dask scheduler running there?"),
    (["10.0.0.5:8786"], "10.0.0.5:8786"),
    (["tcp://"], "tcp://"),
    (["carrier://pigeon:1"], "carrier://pigeon:1"),
    (["tcp://host:port"], "tcp://host:port"),
    (["NOBODY", "--workers", "2"], "--cluster and --workers exclude each other: a cluster has its own workers"),
]


@pytest.mark.parametrize(("words", "said"), REFUSED)
def test_no_cluster_is_there(calc: Calc, monkeypatch: pytest.MonkeyPatch, words: list[str], said: str) -> None:
    monkeypatch.setattr(on_cluster, "CONNECT_SECONDS", 1)
    with socket.socket() as nobody:  # a port that nobody else gets, and where nobody listens
        nobody.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{nobody.getsockname()[1]}"
        answer = calc("run", PIN, "-q", "--cluster", *(word.replace("NOBODY", address) for word in words))
    assert (answer.code, answer.out, answer.err.count("\n")) == (2, "", 1)
    assert said.replace("NOBODY", address) in answer.err


def test_without_the_extra_it_is_named(calc: Calc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    answer = calc("run", PIN, "-q", "--cluster", "tcp://127.0.0.1:1")
    sentence = 'a cluster needs dask.distributed; install it with: pip install "truing[cluster]"'
    assert (answer.code, answer.err) == (2, f"calc: {sentence}\n")
