"""A dask scheduler and its workers as processes of their own: the same bytes as here, also when a worker is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from gated import BATCHES, FREE, PATIENCE, Gated, run_of, wait_until
from test_interrupt import hearing_interrupts

from shared import Answer, Calc
from truing.errors import LostWorkersError, UsageError

distributed = pytest.importorskip("distributed", reason="the extra [cluster] is not installed")

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


@dataclass
class Cluster:
    """A scheduler and workers on 127.0.0.1, all of them processes that end with the test."""

    folder: Path
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)
    address: str = ""

    def start_scheduler(self) -> subprocess.Popen[bytes]:
        file = self.folder / "scheduler.json"
        started = self._start("dask_scheduler", "--port", "0", "--scheduler-file", str(file))

        def is_written() -> bool:
            assert started.poll() is None, self.log_of(started)
            try:
                self.address = json.loads(file.read_text(encoding="utf-8"))["address"]
            except (OSError, ValueError):  # not there, or not yet whole
                return False
            return True

        wait_until(is_written, "the scheduler has an address")
        return started

    def start_workers(self, count: int, *, nanny: bool = False) -> list[subprocess.Popen[bytes]]:
        options = ("--nthreads", "1", "--nanny" if nanny else "--no-nanny", "--local-directory", str(self.folder))
        started = [self._start("dask_worker", self.address, *options) for _ in range(count)]
        with distributed.Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=PATIENCE)
        return started

    def _start(self, program: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--no-dashboard"]
        with open(self.folder / f"{len(self.processes)}.log", "wb") as log:
            process = subprocess.Popen(
                [*command, "--host", "127.0.0.1"], cwd=self.folder, stdout=log, stderr=subprocess.STDOUT
            )
        self.processes.append(process)
        return process

    def log_of(self, process: subprocess.Popen[bytes]) -> str:
        return (self.folder / f"{self.processes.index(process)}.log").read_text(encoding="utf-8", errors="replace")


@contextmanager
def new_cluster(folder: Path) -> Iterator[Cluster]:
    made = Cluster(folder)
    try:
        made.start_scheduler()
        yield made
    finally:
        for process in reversed(made.processes):
            process.kill()  # the worker of a nanny ends with it
            process.wait()


@pytest.fixture
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster without workers, for a test that ends a part of it."""
    with new_cluster(tmp_path_factory.mktemp("cluster")) as made:
        yield made


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster of two workers, for all tests that leave it as it is."""
    with new_cluster(tmp_path_factory.mktemp("pair")) as made:
        made.start_workers(2)
        yield made


def test_a_cluster_answers_as_one_process(pair: Cluster, calc: Calc, tmp_path: Path) -> None:
    """With cases; that a single run does, the test of a worker that is killed shows."""
    words = ("--cases", "cases.csv")
    (tmp_path / "cases.csv").write_text("load [N]\n140\n2200\n500000\n2230\n180\n")
    there = calc("run", PIN, *words, "-q", "-o", "run", "--cluster", pair.address)
    (tmp_path / "run").rename(tmp_path / "there")
    here = calc("run", PIN, *words, "-q", "-o", "run")
    assert (there.code, there.out, there.err) == (here.code, here.out, here.err)
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (tmp_path / "run" / name).read_bytes() == (tmp_path / "there" / name).read_bytes()
    assert run_of(tmp_path / "there")["workers"] == {"count": 2, "lost": 0, "where": pair.address}
    assert run_of(tmp_path / "run")["workers"] == {"count": 1, "lost": 0, "where": "serial"}


def test_a_worker_that_is_killed_changes_nothing_but_the_warning(cluster: Cluster, calc: Calc, tmp_path: Path) -> None:
    workers = {worker.pid: worker for worker in cluster.start_workers(2)}
    pin = Gated.in_folder(tmp_path)
    process = pin.start("-o", "run", "--cluster", cluster.address)
    pin.at_the_gate(process, FREE + 1)  # the scheduler may leave the next batch to the same worker
    workers[pin.callers[-1]].kill()
    pin.open()
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    fate = "what was under way there was computed again, the results are the same"
    lost = f"1 worker was lost at {cluster.address}; {fate}"
    run = run_of(tmp_path / "run")
    assert run["workers"] == {"count": 2, "lost": 1, "where": cluster.address}
    assert run["warnings"] == [lost]
    assert f"warning: {lost}\n" in err
    assert pin.calls > BATCHES  # what the killed one held was computed again
    assert calc(*pin.words, "-q", "-o", "serial").code == 0
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (tmp_path / "run" / name).read_bytes() == (tmp_path / "serial" / name).read_bytes()


def test_finished_batches_outlive_a_lost_scheduler(
    cluster: Cluster, calc: Calc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The run ends with one sentence; the same command without the cluster goes on, and answers as if undisturbed."""
    from truing.executors import cluster as on_cluster

    monkeypatch.setattr(on_cluster, "CONNECT_SECONDS", 2)
    cluster.start_workers(1)
    pin = Gated.in_folder(tmp_path)

    def lose_the_scheduler() -> None:
        wait_until(lambda: pin.kept("run") == FREE, "six batches are kept")
        cluster.processes[0].kill()

    with ThreadPoolExecutor(1) as beside:
        beside.submit(lose_the_scheduler)
        cut_off = calc(*pin.words, "-q", "-o", "run", "--cluster", cluster.address, "--resume")
    nobody = f"no scheduler answers at {cluster.address} within 2 s; is dask scheduler running there?"
    assert cut_off == Answer(2, "", f"calc: the cluster was lost: {nobody}\n")
    assert not (tmp_path / "run").exists()
    pin.open()
    for folder, more in (("run", ["--resume"]), ("whole", [])):
        assert calc(*pin.words, "-q", "-o", folder, *more).code == 0
    assert run_of(tmp_path / "run")["resumed"] == FREE
    assert (tmp_path / "run" / "results.json").read_bytes() == (tmp_path / "whole" / "results.json").read_bytes()


@pytest.mark.skipif(sys.platform == "win32", reason="a console signal there stops the test too")
def test_an_interrupted_run_leaves_the_cluster_at_once(pair: Cluster, tmp_path: Path) -> None:
    pin = Gated.in_folder(tmp_path)
    process = pin.start("-o", "run", "-q", "--cluster", pair.address, launcher=hearing_interrupts)
    pin.at_the_gate(process, FREE + 1)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (130, "calc: interrupted; nothing was written\n")
    pin.open()
    with distributed.Client(pair.address, set_as_default=False) as client:
        wait_until(lambda: not any(client.processing().values()), "the workers have nothing to do")
    assert pin.calls <= FREE + 2  # what the two workers held, and nothing that waited behind it
    assert not (tmp_path / "run").exists()


def test_a_plugin_in_one_file_reaches_the_cluster_and_another_one_there_is_refused(
    pair: Cluster, calc: Calc, calc_process: Calc, tmp_path: Path
) -> None:
    file = tmp_path / "own_wear.py"
    file.write_text(PIN.read_text(encoding="utf-8"), encoding="utf-8")
    words = ("run", file, "-q", "--set", "studies.reliability.draws=40000")
    there = calc(*words, "-o", "there", "--cluster", pair.address)
    assert there.code == 0, there.err
    assert run_of(tmp_path / "there")["warnings"] == []
    with file.open("a", encoding="utf-8") as more:
        more.write("\n# the workers have loaded the file without this line\n")
    changed = calc_process(*words, "-o", "there", "--cluster", pair.address)
    assert changed.code == 3
    assert changed.err.endswith(f"a worker has another {file}; bring the same file there and start it again\n")


def test_a_batch_that_ends_every_worker_ends_the_run(cluster: Cluster) -> None:
    """A nanny starts the worker again, dask hands it the batch again: four times, then there is one sentence."""
    from truing.executors import in_order, open_executor

    cluster.start_workers(1, nanny=True)
    with open_executor(f"dask:{cluster.address}") as place:
        assert list(in_order(place, abs, range(-40, 0))) == list(range(40, 0, -1))
        with pytest.raises(LostWorkersError, match=r"4 workers of tcp://.* ended over the same batch"):
            list(in_order(place, os._exit, [1]))
        assert place.losses == 4
        assert place.remarks()[-1].startswith("4 workers were lost at tcp://")


def test_a_cluster_without_workers_is_told(cluster: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    from truing.executors import cluster as on_cluster
    from truing.executors import in_order, open_executor

    monkeypatch.setattr(on_cluster, "WORKER_SECONDS", 0.2)
    with pytest.raises(UsageError, match=r"has had no worker for 0.2 s; start one: dask worker tcp://"):
        open_executor(f"dask:{cluster.address}")
    (only,) = cluster.start_workers(1)
    monkeypatch.setattr(on_cluster, "EMPTY_SECONDS", 0.2)
    monkeypatch.setattr(on_cluster.ClusterExecutor, "patience", 0.1)
    with open_executor(f"dask:{cluster.address}") as place:
        answers = in_order(place, time.sleep, [0.0] * 16 + [60.0] * 20)
        next(answers)
        only.kill()
        with pytest.raises(LostWorkersError, match=r"no worker has been left at tcp://.* for 0.2 s"):
            list(answers)


def test_no_scheduler_answers(calc: Calc, monkeypatch: pytest.MonkeyPatch) -> None:
    import socket

    from truing.executors import cluster as on_cluster

    monkeypatch.setattr(on_cluster, "CONNECT_SECONDS", 1)
    with socket.socket() as nobody:  # a port that nobody else gets, and where nobody listens
        nobody.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{nobody.getsockname()[1]}"
        answer = calc("run", PIN, "-q", "--cluster", address)
    assert answer == Answer(
        2, "", f"calc: no scheduler answers at {address} within 1 s; is dask scheduler running there?\n"
    )


@pytest.mark.parametrize("address", ["10.0.0.5:8786", "tcp://", "carrier://pigeon:1", "tcp://host:port"])
def test_what_is_no_address(calc: Calc, monkeypatch: pytest.MonkeyPatch, address: str) -> None:
    from truing.executors import cluster as on_cluster

    monkeypatch.setattr(on_cluster, "CONNECT_SECONDS", 1)
    answer = calc("run", PIN, "-q", "--cluster", address)
    assert answer.code == 2
    assert answer.out == ""
    assert answer.err.count("\n") == 1
    assert address in answer.err
