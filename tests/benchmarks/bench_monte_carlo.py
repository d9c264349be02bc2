"""How much does the whole Monte Carlo cost beside drawing its random numbers, and does its memory stay flat?

Run it: ``python -m pytest tests/benchmarks --benchmark-enable -s``, or as a script, which prints the figures. The
baseline draws as many standard normal numbers with one generator of the same kind (SFC64, the fastest that numpy has),
array by array as long as a batch, always into the same memory, and does nothing else. Both are measured alternately in
one process and the least time of each counts. Numpy's default generator, PCG64, is slower: against it the ratio would
look better, so it is printed beside the other and decides nothing.
"""

import subprocess
import sys
import time
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from press_linkage.errors import SOURCES
from truing import Reliability, normal
from truing.calculation import calculate
from truing.executors import SerialExecutor, open_executor
from truing.kernel import Kernel
from truing.setup import Setup, default_setup
from truing.studies.sampling import scatter_of

BATCH = 2**14
ROUNDS = 5


def all_sources() -> Setup:
    """The press linkage with every one of its 29 error sources in force, in the complete reading."""
    offer = Kernel.installed(strict=True).offer("press_linkage")
    setup = default_setup(offer.model, offer.origin, reading="complete")
    setup = replace(setup, spreads={**setup.spreads, "crank_angle": normal(sd="0.05 mrad")})
    assert set(scatter_of(setup).columns) == set(SOURCES)
    return setup


def draw_only(draws: int, kind: type[np.random.BitGenerator] = np.random.SFC64) -> None:
    """The baseline: the random numbers alone."""
    rng, store = np.random.Generator(kind(0)), np.empty(BATCH)
    for _ in range(-(-draws // BATCH) * len(SOURCES)):
        rng.standard_normal(out=store)


def monte_carlo(setup: Setup, draws: int, executor: Executor | None = None) -> object:
    """The whole study as ``calc run`` does it, the first-order answer included."""
    study = Reliability(draws=draws, batch=BATCH, method=("first_order", "monte_carlo"))
    return calculate(replace(setup, studies=(study,)), executor=executor).outcomes["reliability"]


def seconds(work: object, *arguments: object) -> float:
    start = time.perf_counter()
    work(*arguments)  # type: ignore[operator]
    return time.perf_counter() - start


def ratio(draws: int) -> tuple[float, float]:
    """Least seconds of the baseline and of the whole study."""
    setup = all_sources()
    pairs = [(seconds(draw_only, draws), seconds(monte_carlo, setup, draws)) for _ in range(ROUNDS)]
    return min(first for first, _ in pairs), min(second for _, second in pairs)


def peak_mebibytes(draws: int) -> float:
    """Most memory that a fresh process needs for so many draws."""
    code = f"import sys; sys.path[:0] = {sys.path!r}; import bench_monte_carlo as b; b.report_peak({draws})"
    return float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)


def report_peak(draws: int) -> None:
    """Print the peak of this process in MiB after so many draws."""
    monte_carlo(all_sources(), draws)
    print(peak_of_this_process())


def peak_of_this_process() -> float:
    """Return the peak in MiB; that of ``getrusage`` would begin with the parent's (Linux only)."""
    status = Path("/proc/self/status").read_text()
    return next(int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmHWM"))


MILLION = pytest.mark.benchmark(group="a million machines of 29 sources; in brackets the ratio to drawing alone")


@MILLION
def test_drawing_alone(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(draw_only, args=(1_000_000,), rounds=ROUNDS, warmup_rounds=1)


@MILLION
def test_drawing_alone_with_the_default_generator(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(draw_only, args=(1_000_000, np.random.PCG64), rounds=ROUNDS, warmup_rounds=1)


@MILLION
def test_whole_study(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(monte_carlo, args=(all_sources(), 1_000_000), rounds=ROUNDS, warmup_rounds=1)


def test_monte_carlo_costs_at_most_twice_its_random_numbers() -> None:
    drawing, whole = ratio(1_000_000)
    print(f"\nthe whole study over drawing alone: {whole / drawing:.3f} (at most 2.0)")
    assert whole / drawing <= 2.0


def test_memory_is_flat_from_1e5_to_1e7_draws() -> None:
    few, many = peak_mebibytes(100_000), peak_mebibytes(10_000_000)
    print(f"\npeak memory: {few:.1f} MiB at 1e5, {many:.1f} MiB at 1e7 machines (at most 1.05 times)")
    assert many < 1.05 * few


def test_two_processes_are_faster_than_one_where_there_is_work() -> None:
    setup, draws = all_sources(), 20_000_000
    with open_executor("processes:2") as executor:
        monte_carlo(setup, 100_000, executor)  # the workers have started and loaded the plugin
        spread = seconds(monte_carlo, setup, draws, executor)
    alone = seconds(monte_carlo, setup, draws, SerialExecutor())
    print(f"\ntwo processes over one: {spread / alone:.3f} (below 1)")
    assert spread < alone


def profile_parts(draws: int) -> None:
    """Print where the time goes."""
    scatter = scatter_of(all_sources())

    def draw_all() -> None:
        for batch in range(draws // BATCH):
            scatter.draw(1, batch, BATCH)

    drawing = min(seconds(draw_all) for _ in range(ROUNDS))
    print(f"drawing with seeds and spreads {drawing:.3f} s")


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    baseline, study = ratio(number)
    print(f"{number} machines, {len(SOURCES)} sources: drawing {baseline:.3f} s, the whole study {study:.3f} s")
    print(f"ratio {study / baseline:.3f} (at most 2.0)")
    default = min(seconds(draw_only, number, np.random.PCG64) for _ in range(ROUNDS))
    print(f"with numpy's default generator PCG64 drawing would take {default:.3f} s, ratio {study / default:.3f}")
    profile_parts(number)
    for count in (100_000, 1_000_000, 10_000_000):
        print(f"peak memory at {count} draws: {peak_mebibytes(count):.1f} MiB")
