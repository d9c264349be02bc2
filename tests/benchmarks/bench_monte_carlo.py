"""What does the whole Monte Carlo cost beside drawing its random numbers, on one core, on two, and in memory?

Run it on a quiet machine: ``python -m pytest tests/benchmarks/bench_monte_carlo.py -s``. The baseline draws as many
standard normal numbers with one generator of the same kind (SFC64, the fastest that numpy has), 16,384 of them
at a time, always into the same memory, and does nothing else. Both are measured alternately in one process and the
least time of each counts. Numpy's default generator, PCG64, is slower: against it the ratio would look better, so it is
printed beside the other and decides nothing.

Two processes are to be 1.7 times as fast as one, a cluster of two workers 1.5 times. Workers have started and loaded
the plugin before the clock runs. Memory is that of a fresh process which draws all by itself.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import distributed
import numpy as np
import pytest
from timed import least, said_by_a_fresh_process

from press_linkage.errors import SOURCES
from truing import Reliability, normal
from truing.calculation import calculate
from truing.executors import SerialExecutor, open_executor
from truing.kernel import Kernel
from truing.setup import Setup, default_setup
from truing.studies.sampling import scatter_of

ARRAY = 2**14
DRAWS = 1_000_000


def all_sources() -> Setup:
    """The press linkage with every one of its 29 error sources in force, in the complete reading."""
    offer = Kernel.installed(strict=True).offer("press_linkage")
    setup = default_setup(offer.model, offer.origin, reading="complete")
    setup = replace(setup, spreads={**setup.spreads, "crank_angle": normal(sd="0.05 mrad")})
    assert set(scatter_of(setup).columns) == set(SOURCES)
    return setup


def backlash() -> Setup:
    """The reducer as it is shipped."""
    offer = Kernel.installed(strict=True).offer("rv_wear")
    return default_setup(offer.model, offer.origin)


def draw_only(draws: int, sources: int, kind: type[np.random.BitGenerator] = np.random.SFC64) -> None:
    """The baseline: the random numbers alone."""
    rng, store = np.random.Generator(kind(0)), np.empty(ARRAY)
    for _ in range(-(-draws // ARRAY) * sources):
        rng.standard_normal(out=store)


def monte_carlo(setup: Setup, draws: int, executor: Executor | None = None) -> object:
    """The whole study as ``calc run`` does it, the first-order answer included."""
    study = Reliability(draws=draws, method=("first_order", "monte_carlo"))
    return calculate(replace(setup, studies=(study,)), executor=executor).outcomes["reliability"]


def peak_mebibytes(draws: int, place: str = "serial") -> float:
    """Most memory that a fresh process needs for so many draws, spread over workers or not."""
    code = (
        "import bench_monte_carlo as b, timed; from truing.executors import open_executor\n"
        "if __name__ == '__main__':\n"
        "    with open_executor(sys.argv[1]) as place: b.monte_carlo(b.all_sources(), int(sys.argv[2]), place)\n"
        "    print(timed.peak_of_this_process())"
    )
    return float(said_by_a_fresh_process(code, place, str(draws)))


@pytest.mark.parametrize(("made", "draws"), [(all_sources, DRAWS), (backlash, 10 * DRAWS)])
def test_monte_carlo_costs_at_most_1_9_times_its_random_numbers(made: Callable[[], Setup], draws: int) -> None:
    setup = made()
    sources = len(scatter_of(setup).columns)
    monte_carlo(setup, 100_000)
    drawing, whole, default = least(
        lambda: draw_only(draws, sources),
        lambda: monte_carlo(setup, draws),
        lambda: draw_only(draws, sources, np.random.PCG64),
        rounds=5,
    )
    print(f"\nthe whole study over drawing alone: {whole / drawing:.3f} (at most 1.9), by PCG64 {whole / default:.3f}")
    assert whole / drawing <= 1.9


# Processes and a cluster


def _start(program: str, *arguments: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--host", "127.0.0.1", "--no-dashboard"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@contextmanager
def two_workers() -> Iterator[str]:
    """A scheduler and two workers of one thread each; gives their address."""
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
    setup = all_sources()
    with two_workers() as address, ExitStack() as stack:
        places: dict[str, Executor] = {"serial": SerialExecutor()}
        for name in ("processes:2", f"dask:{address}"):
            places[name.partition(":")[0]] = stack.enter_context(open_executor(name))
        for place in places.values():
            monte_carlo(setup, 1_000_000, place)
        times: dict[str, list[float]] = {name: [] for name in places}
        for name, place in [*places.items()] * 3:
            start = time.perf_counter()
            monte_carlo(setup, draws, place)
            times[name].append(time.perf_counter() - start)
    quickest = {name: min(found) for name, found in times.items()}
    print(f"\n{draws} machines: " + ", ".join(f"{name} {seconds:.2f} s" for name, seconds in quickest.items()))
    return {name: quickest["serial"] / seconds for name, seconds in quickest.items()}


def test_two_cores_are_used() -> None:
    found = ratios(20 * DRAWS)
    processes, cluster = found["processes"], found["dask"]
    print(f"two processes are {processes:.2f} times as fast (at least 1.7), the cluster is {cluster:.2f} times (1.5)")
    assert processes >= 1.7
    assert cluster >= 1.5


@pytest.mark.parametrize("place", ["serial", "processes:2"])
def test_memory_is_flat_from_1e5_to_1e7_machines(place: str) -> None:
    """Of the process that draws all by itself, and of the one that hands out and sums up: it keeps no batch."""
    few, many = (peak_mebibytes(machines, place) for machines in (100_000, 10_000_000))
    print(f"\npeak memory, {place}: {few:.1f} MiB at 1e5, {many:.1f} MiB at 1e7 machines (at most 1.05 times)")
    assert many < 1.05 * few
