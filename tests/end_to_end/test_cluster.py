"""A dask scheduler and its workers as processes of their own: the same bytes as here, also when a worker is killed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from shared import Answer, Calc
from truing.errors import TruingError, UsageError

distributed = pytest.importorskip("distributed", reason="the extra [cluster] is not installed")

PATIENCE = 120.0  # seconds for what takes one or two on a quiet machine
PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
PRESS = (
    "run", "press_linkage", "-q", "--set", 'reading="printed"', "--set", 'studies.run=["reliability"]',
    "--set", "studies.reliability.draws=8000000",
)  # fmt: skip


def wait_until(holds: Callable[[], Any], what: str) -> None:
    """Poll until something holds."""
    until = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < until, f"not within {PATIENCE:.0f} s: {what}"
        time.sleep(0.02)


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


@pytest.fixture
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    made = Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        made.start_scheduler()
        yield made
    finally:
        for process in reversed(made.processes):
            process.kill()  # the worker of a nanny ends with it
            process.wait()


def run_of(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return found


def test_a_cluster_answers_as_one_process_also_when_a_worker_is_killed(
    cluster: Cluster, calc_process: Calc, tmp_path: Path
) -> None:
    first, _ = cluster.start_workers(2)
    log = tmp_path / "killed.partial" / "batches.log"
    command = [sys.executable, "-m", "truing", *PRESS, "-o", "killed", "--cluster", cluster.address, "--resume"]
    killed = subprocess.Popen(
        [word for word in command if word != "-q"], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        text=True, encoding="utf-8",
    )  # fmt: skip
    wait_until(lambda: killed.poll() is not None or (log.exists() and log.stat().st_size), "a batch is finished")
    assert killed.poll() is None, killed.communicate()
    first.kill()
    _, err = killed.communicate(timeout=PATIENCE)
    assert killed.returncode == 1, err  # the printed reading misses its goals
    run = run_of(tmp_path / "killed")
    fate = "what was under way there was computed again, the results are the same"
    lost = f"1 worker was lost at {cluster.address}; {fate}"
    assert run["workers"] == {"count": 2, "lost": 1, "where": cluster.address}
    assert run["warnings"] == [lost]
    assert f"warning: {lost}\n" in err
    assert calc_process(*PRESS, "-o", "serial").code == 1
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (tmp_path / "killed" / name).read_bytes() == (tmp_path / "serial" / name).read_bytes()
    assert run_of(tmp_path / "serial")["workers"] == {"count": 1, "lost": 0, "where": "serial"}
    assert not log.parent.exists()


def test_finished_batches_outlive_a_lost_scheduler(
    cluster: Cluster, calc: Calc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The run ends with one sentence; the same command without the cluster goes on, and answers as if undisturbed."""
    from truing.executors import cluster as on_cluster

    monkeypatch.setattr(on_cluster, "CONNECT_SECONDS", 2)
    cluster.start_workers(1)
    log = tmp_path / "run.partial" / "batches.log"

    def lose_the_scheduler() -> None:
        wait_until(lambda: log.exists() and log.stat().st_size, "a batch is finished")
        cluster.processes[0].kill()

    with ThreadPoolExecutor(1) as beside:
        beside.submit(lose_the_scheduler)
        cut_off = calc(*PRESS, "-o", "run", "--cluster", cluster.address, "--resume")
    assert cut_off == Answer(
        1,
        "",
        f"calc: the cluster was lost: no scheduler answers at {cluster.address} within 2 s; "
        "is dask scheduler running there?\n",
    )
    assert not (tmp_path / "run").exists()
    for folder, more in (("run", ["--resume"]), ("whole", [])):
        assert calc(*PRESS, "-o", folder, *more).code == 1
    assert run_of(tmp_path / "run")["resumed"] > 0
    assert (tmp_path / "run" / "results.json").read_bytes() == (tmp_path / "whole" / "results.json").read_bytes()


def test_a_plugin_in_one_file_reaches_the_cluster_and_another_one_there_is_refused(
    cluster: Cluster, calc_process: Calc, tmp_path: Path
) -> None:
    cluster.start_workers(1)
    file = tmp_path / "own_wear.py"
    file.write_text(PIN.read_text(encoding="utf-8"), encoding="utf-8")
    words = ("run", file, "-q", "--set", "studies.reliability.draws=40000")
    here = calc_process(*words, "-o", "here")
    there = calc_process(*words, "-o", "there", "--cluster", cluster.address)
    assert (here.code, there.code) == (0, 0), there.err
    assert (tmp_path / "here/results.json").read_bytes() == (tmp_path / "there/results.json").read_bytes()
    assert run_of(tmp_path / "there")["warnings"] == []
    with file.open("a", encoding="utf-8") as more:
        more.write("\n# the worker has loaded the file without this line\n")
    changed = calc_process(*words, "-o", "there", "--cluster", cluster.address)
    assert changed.code == 3
    assert changed.err.endswith(f"a worker has another {file}; bring the same file there and start it again\n")


def test_a_batch_that_ends_every_worker_ends_the_run(cluster: Cluster) -> None:
    """A nanny starts the worker again, dask hands it the batch again: four times, then there is one sentence."""
    from truing.executors import in_order, open_executor

    cluster.start_workers(1, nanny=True)
    with open_executor(f"dask:{cluster.address}") as place:
        assert list(in_order(place, abs, range(-40, 0))) == list(range(40, 0, -1))
        with pytest.raises(TruingError, match=r"4 workers of tcp://.* ended over the same batch"):
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
        with pytest.raises(TruingError, match=r"no worker has been left at tcp://.* for 0.2 s"):
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
