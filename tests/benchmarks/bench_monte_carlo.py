"""How much does the whole Monte Carlo cost beside drawing its random numbers?

Run it: ``python -m pytest tests/benchmarks/bench_monte_carlo.py -s``. The baseline draws as many standard normal
numbers with one generator of the same kind (SFC64, the fastest that numpy has), array by array as long as a batch,
always into the same memory, and does nothing else. Both are measured alternately in one process and the least time of
each counts. Numpy's default generator, PCG64, is slower: against it the ratio would look better, so it is printed
beside the other and decides nothing.
"""

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np
import pytest
from timed import least, said_by_a_fresh_process

from press_linkage.errors import SOURCES
from truing import Reliability, normal
from truing.calculation import calculate
from truing.kernel import Kernel
from truing.setup import Setup, default_setup
from truing.studies.sampling import scatter_of

BATCH = 2**14
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
    rng, store = np.random.Generator(kind(0)), np.empty(BATCH)
    for _ in range(-(-draws // BATCH) * sources):
        rng.standard_normal(out=store)


def monte_carlo(setup: Setup, draws: int, executor: Executor | None = None) -> object:
    """The whole study as ``calc run`` does it, the first-order answer included."""
    study = Reliability(draws=draws, batch=BATCH, method=("first_order", "monte_carlo"))
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
def test_monte_carlo_costs_at_most_twice_its_random_numbers(made: Callable[[], Setup], draws: int) -> None:
    setup = made()
    sources = len(scatter_of(setup).columns)
    monte_carlo(setup, 100_000)
    drawing, whole, default = least(
        lambda: draw_only(draws, sources),
        lambda: monte_carlo(setup, draws),
        lambda: draw_only(draws, sources, np.random.PCG64),
        rounds=5,
    )
    print(f"\nthe whole study over drawing alone: {whole / drawing:.3f} (at most 2.0), by PCG64 {whole / default:.3f}")
    assert whole / drawing <= 2.0
