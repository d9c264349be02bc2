"""What do two processes, or a cluster of two workers, gain on two cores, and does memory stay flat to 10^8 machines?

Run it as a script on a quiet machine, which prints the figures: ``python tests/benchmarks/bench_scale.py [DRAWS]``; or
``python -m pytest tests/benchmarks/bench_scale.py -s``, which judges the ratios (processes at least 1.7 times as fast
as one process, the cluster 1.5 times) and leaves out the memory of 10^8. Workers have started and loaded the plugin
before the clock runs; each place is measured in turn, and the least time of each counts. Memory is that of a fresh
process which draws all by itself.
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
        for _ in range(ROUNDS):
            for name, place in places.items():
                times[name].append(monte_carlo.seconds(monte_carlo.monte_carlo, setup, draws, place))
    least = {name: min(found) for name, found in times.items()}
    print(f"\n{draws} machines: " + ", ".join(f"{name} {seconds:.2f} s" for name, seconds in least.items()))
    return {name: least["serial"] / seconds for name, seconds in least.items()}


def test_two_cores_are_used() -> None:
    found = ratios(DRAWS)
    processes, cluster = found["processes"], found["dask"]
    print(f"two processes are {processes:.2f} times as fast (at least 1.7), the cluster is {cluster:.2f} times (1.5)")
    assert processes >= 1.7
    assert cluster >= 1.5


def test_memory_is_flat_from_1e6_to_1e7_machines() -> None:
    few, many = monte_carlo.peak_mebibytes(1_000_000), monte_carlo.peak_mebibytes(10_000_000)
    print(f"\npeak memory: {few:.1f} MiB at 1e6, {many:.1f} MiB at 1e7 machines (at most 1.05 times)")
    assert many < 1.05 * few


@pytest.mark.parametrize("address", ["processes:2"])
def test_memory_is_flat_with_workers(address: str) -> None:
    """The process that hands out and sums up keeps no batch."""
    code = (
        f"import sys; sys.path[:0] = {sys.path!r}; import bench_monte_carlo as b; from truing.executors import *\n"
        "if __name__ == '__main__':\n"
        f"    with open_executor({address!r}) as place: b.monte_carlo(b.all_sources(), int(sys.argv[1]), place)\n"
        "    print(b.peak_of_this_process())"
    )
    few, many = (
        float(subprocess.run([sys.executable, "-c", code, draws], check=True, capture_output=True, text=True).stdout)
        for draws in ("1000000", "10000000")
    )
    print(f"\npeak memory beside {address}: {few:.1f} MiB at 1e6, {many:.1f} MiB at 1e7 machines (at most 1.05 times)")
    assert many < 1.05 * few


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else DRAWS
    for place, ratio in ratios(number).items():
        print(f"{place}: {ratio:.2f} times as fast as one process")
    for count in (1_000_000, 10_000_000, 100_000_000):
        print(f"peak memory at {count} machines: {monte_carlo.peak_mebibytes(count):.1f} MiB")
