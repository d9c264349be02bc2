"""How much does the exact kinematics of the press linkage cost beside drawing its 29 random numbers?

Run it: ``python -m pytest tests/benchmarks --benchmark-enable -s``, or as a script with a number of draws. It prints
the ratio of drawing (with numpy's default generator) and solving to drawing alone, both measured in this run,
alternately, and the peak of the memory used.
"""

import sys
import time
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from press_linkage.errors import ARM, KINDS, SOURCES, source
from press_linkage.kinematics import demands, solve
from press_linkage.quantities import Press, PressSide

BATCH = 2**14
SD = np.full((len(SOURCES), 1), 20e-6)
PRESS = Press()
CRANK_ANGLE = 0.1


def keep_freed_memory() -> None:
    """Let glibc keep freed arrays for the next ones instead of handing every batch back to the system.

    Freeing one large array (never touched, so it costs nothing) raises glibc's mmap and trim thresholds. Without it
    the page faults of the temporaries cost four times the arithmetic. Other C libraries do not care.
    """
    np.empty(31 * 2**20, dtype=np.uint8)


def draw(rng: np.random.Generator, store: np.ndarray) -> np.ndarray:
    """One batch of all sources, into the same memory every time."""
    return rng.standard_normal(out=store)


def scatter(drawn: np.ndarray) -> tuple[float, float, bool]:
    """Sums of position and tilt over one batch, and whether every machine of it closes."""
    errors = drawn * SD
    off = dict(zip(SOURCES, errors, strict=True))
    sides = [PressSide(**{f"{kind}_deviation": off[source(kind, side)] for kind in KINDS}) for side in (1, 2)]
    press = replace(PRESS, side_1=sides[0], side_2=sides[1], platform_arm_deviation=off[ARM], crank_angle=CRANK_ANGLE)
    position = solve(press)
    closes = all(np.all(demand.holds) for demand in demands(press, position))
    return float(np.sum(position.slider_position)), float(np.sum(position.slider_tilt)), closes


def measure(draws: int) -> tuple[float, float]:
    """Seconds for drawing alone and for solving alone, over all batches."""
    rng, store = np.random.default_rng(0), np.empty((len(SOURCES), BATCH))
    scatter(draw(rng, store))
    drawing = solving = 0.0
    for _ in range(-(-draws // BATCH)):
        start = time.perf_counter()
        drawn = draw(rng, store)
        middle = time.perf_counter()
        *_, closes = scatter(drawn)
        drawing, solving = drawing + middle - start, solving + time.perf_counter() - middle
        assert closes
    return drawing, solving


def peak_memory(draws: int) -> int:
    """Most bytes in use at a time."""
    tracemalloc.start()
    measure(draws)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


BATCHES = pytest.mark.benchmark(
    group="one batch of 2^14 machines; in brackets the ratio to the faster of drawing and solving"
)


@BATCHES
def test_drawing_a_batch(benchmark: BenchmarkFixture) -> None:
    benchmark(draw, np.random.default_rng(0), np.empty((len(SOURCES), BATCH)))


@BATCHES
def test_solving_a_batch(benchmark: BenchmarkFixture) -> None:
    keep_freed_memory()
    benchmark(scatter, np.random.default_rng(0).standard_normal((len(SOURCES), BATCH)))


def test_kinematics_cost_less_than_their_random_numbers() -> None:
    keep_freed_memory()
    drawing, solving = measure(1_000_000)
    print(f"\ndrawing and solving over drawing: {(drawing + solving) / drawing:.3f} (at most 2.0)")
    assert (drawing + solving) / drawing <= 2.0


def test_memory_is_flat() -> None:
    assert peak_memory(1_000_000) < 1.05 * peak_memory(100_000)


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    keep_freed_memory()
    seconds_drawing, seconds_solving = measure(number)
    print(f"{number} machines: drawing {seconds_drawing:.3f} s, solving {seconds_solving:.3f} s")
    print(f"ratio {(seconds_drawing + seconds_solving) / seconds_drawing:.3f} (at most 2.0)")
    print(f"peak memory {peak_memory(number) / 2**20:.1f} MiB")
