"""What do two processes, or a cluster of two workers, gain on two cores, and does memory stay flat?

Run it on a quiet machine: ``python -m pytest tests/benchmarks/bench_scale.py -s``. It judges the ratios: processes at
least 1.7 times as fast as one process, the cluster 1.5 times. Workers have started and loaded the plugin before the
clock runs; each place is measured in turn, and the least time of each counts. Memory is that of a fresh process which
draws all by itself.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bench_monte_carlo as monte_carlo
import pytest

from truing.executors import SerialExecutor, open_executor

DRAWS = 20_000_000
ROUNDS = 3


def _start(program: str, *arguments: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--host", "127.0.0.1", "--no-dashboard"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@contextmanager
def two_workers() -> Iterator[str]:
    """A scheduler and two workers of one thread each; gives their address."""
    import json

    import distributed

    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file = Path(folder) / "scheduler.json"
        scheduler = _start("dask_scheduler", "--port", "0", "--scheduler-file", str(file))
        stack.callback(scheduler.terminate)
        while not file.exists() or not file.read_text():
            time.sleep(0.05)
        address = json.loads(file.read_text())["address"]
        for _ in range(2):
            worker = _start("dask_worker", address, "--no-nanny", "--nthreads", "1", "--local-directory", folder)
            stack.callback(worker.wait)
            stack.callback(worker.terminate)
        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address


def ratios(draws: int) -> dict[str, float]:
    """How many times as fast as one process each place is."""
    setup = monte_carlo.all_sources()
    with two_workers() as address, ExitStack() as stack:
        places: dict[str, Executor] = {"serial": SerialExecutor()}
        for name in ("processes:2", f"dask:{address}"):
            places[name.partition(":")[0]] = stack.enter_context(open_executor(name))
        for place in places.values():
            monte_carlo.monte_carlo(setup, 1_000_000, place)
        times: dict[str, list[float]] = {name: [] for name in places}
        for name, place in [*places.items()] * ROUNDS:
            start = time.perf_counter()
            monte_carlo.monte_carlo(setup, draws, place)
            times[name].append(time.perf_counter() - start)
    least = {name: min(found) for name, found in times.items()}
    print(f"\n{draws} machines: " + ", ".join(f"{name} {seconds:.2f} s" for name, seconds in least.items()))
    return {name: least["serial"] / seconds for name, seconds in least.items()}


def test_two_cores_are_used() -> None:
    found = ratios(DRAWS)
    processes, cluster = found["processes"], found["dask"]
    print(f"two processes are {processes:.2f} times as fast (at least 1.7), the cluster is {cluster:.2f} times (1.5)")
    assert processes >= 1.7
    assert cluster >= 1.5


@pytest.mark.parametrize("place", ["serial", "processes:2"])
def test_memory_is_flat_from_1e5_to_1e7_machines(place: str) -> None:
    """Of the process that draws all by itself, and of the one that hands out and sums up: it keeps no batch."""
    few, many = (monte_carlo.peak_mebibytes(machines, place) for machines in (100_000, 10_000_000))
    print(f"\npeak memory, {place}: {few:.1f} MiB at 1e5, {many:.1f} MiB at 1e7 machines (at most 1.05 times)")
    assert many < 1.05 * few
