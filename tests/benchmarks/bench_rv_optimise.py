"""Is the Pareto optimisation of the reducer faster in full physics, or with a surrogate that must first be made?

Run it: ``python -m pytest tests/benchmarks/bench_rv_optimise.py --benchmark-enable -s``, or as a script. Both ways
evaluate the same number of designs by the same search under the same chances. The surrogate's way pays for its 150
designed calculations, for fitting, and for every prediction; what it does not know (the backlash of a machine) the
model answers in both. Alternately in one process, in time of the processor, the least of each counts.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import pytest

from rv_wear.model import BOX, RV_WEAR
from rv_wear.wear import history_of_group, history_of_one, unworn_of_group, unworn_of_one
from truing import Optimise, Surrogate
from truing.calculation import calculate
from truing.setup import Setup, default_setup

ROUNDS = 3
TRAINED = Surrogate(
    of="max_wear", over=BOX, logarithmic=("output_torque", "output_speed", "working_time"), log_result=True,
    held_out=10, compare=0,
)  # fmt: skip


def setups(generations: int) -> dict[str, Setup]:
    """The same optimisation in both ways."""
    plain = Optimise(chance="first_order", generations=generations, verify=1000)
    setup = default_setup(RV_WEAR)
    return {
        "full physics": replace(setup, studies=(plain,)),
        "surrogate": replace(setup, studies=(TRAINED, replace(plain, surrogate=True))),
    }


def seconds(setup: Setup) -> float:
    """Processor time of the studies of a setup, nothing being remembered from before."""
    for kept in (history_of_group, history_of_one, unworn_of_group, unworn_of_one):
        kept.cache_clear()
    start = time.process_time()
    calculate(setup)
    return time.process_time() - start


def measured(generations: int = 100, rounds: int = ROUNDS) -> dict[str, float]:
    """The least time of each way."""
    ways = setups(generations)
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(rounds):
        for name, setup in ways.items():
            times[name].append(seconds(setup))
    return {name: min(found) for name, found in times.items()}


def told(found: dict[str, float]) -> str:
    """The two times and which way was faster."""
    full, learnt = found["full physics"], found["surrogate"]
    return f"full physics {full:.2f} s, with a surrogate {learnt:.2f} s: {learnt / full:.2f} times as long"


@pytest.mark.benchmark(group="optimisation of the reducer")
def test_full_physics_against_a_surrogate() -> None:
    """Full physics is the default because it loses nothing; it must not be the slower way either."""
    found = measured()
    sys.stdout.write(told(found) + "\n")
    assert found["full physics"] < found["surrogate"]


if __name__ == "__main__":
    sys.stdout.write(told(measured()) + "\n")
