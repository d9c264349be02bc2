"""What does a million machines cost, from drawing their 29 errors to the reliability on the sheet?

Run it: ``python tests/benchmarks/bench_press_monte_carlo.py [draws]``. The whole Monte Carlo study (drawing, exact
kinematics, closing conditions, limits, moments) is measured beside drawing the same random numbers alone, alternately
and in one run, so the ratio does not depend on the machine.
"""

import sys
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from statistics import median

import numpy as np

from press_linkage.model import PRESS_LINKAGE
from truing.declare.spreads import normal
from truing.evaluate import evaluate
from truing.executors import open_executor
from truing.setup import Setup, default_setup
from truing.studies.bench import Bench
from truing.studies.reliability import Reliability
from truing.studies.scatter import scatter_of

BATCH = 2**14
SOURCES = 29


def every_source_scatters() -> Setup:
    """The press with a tolerance on the crank angles too, which the paper leaves out."""
    setup = default_setup(PRESS_LINKAGE)
    setup = replace(setup, spreads={**setup.spreads, "crank_angle": normal(sd="0.1 mrad")})
    assert scatter_of(setup).dimension == SOURCES
    return setup


def monte_carlo(setup: Setup, draws: int) -> None:
    """The study as a run performs it, on one core."""
    results = evaluate(setup)
    with open_executor("serial") as executor:
        bench = Bench(setup, results, executor, setup.model.read_results(results))
        odds = Reliability(draws=draws, batch=BATCH, method=("monte_carlo",)).run(bench)
    assert odds.draws == draws
    assert odds.failed == 0


def drawing(draws: int) -> None:
    """The random numbers alone, into the same memory every time."""
    rng, store = np.random.default_rng(0), np.empty((SOURCES, BATCH))
    for _ in range(-(-draws // BATCH)):
        rng.standard_normal(out=store)


def seconds(task: Callable[[], None]) -> float:
    start = time.perf_counter()
    task()
    return time.perf_counter() - start


def ratios(draws: int, repeats: int = 5) -> list[float]:
    """The time of the study over that of its random numbers, alternately."""
    setup = every_source_scatters()
    monte_carlo(setup, BATCH)
    return [seconds(lambda: monte_carlo(setup, draws)) / seconds(lambda: drawing(draws)) for _ in range(repeats)]


def peak_memory(draws: int) -> int:
    """Most bytes in use at a time."""
    setup = every_source_scatters()
    monte_carlo(setup, BATCH)
    tracemalloc.start()
    monte_carlo(setup, draws)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


def test_the_whole_study_costs_at_most_twice_its_random_numbers() -> None:
    assert median(ratios(1_000_000)) <= 2.0


def test_memory_is_flat() -> None:
    assert peak_memory(10_000_000) < 1.1 * peak_memory(100_000)


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    found = ratios(number)
    print(f"{number} machines with {SOURCES} errors: {median(found):.2f} times their random numbers (at most 2.0),")
    print(f"from {min(found):.2f} to {max(found):.2f} in {len(found)} repeats")
    for count in (100_000, 10_000_000):
        print(f"peak memory for {count} machines: {peak_memory(count) / 2**20:.1f} MiB")
