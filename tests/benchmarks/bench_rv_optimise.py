"""Is the Pareto optimisation of the reducer faster in full physics, or with a surrogate that must first be made?

Run it: ``python -m pytest tests/benchmarks/bench_rv_optimise.py -s``. Both ways evaluate the same number of designs by
the same search under the same chances. The surrogate's way pays for its 150 designed calculations, for fitting, and for
every prediction; what it does not know (the backlash of a machine) the model answers in both. Alternately in one
process, in time of the processor, the least of each counts.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from timed import least

from rv_wear.model import BOX, RV_WEAR
from rv_wear.wear import history_of_group, unworn_of_group
from truing import Optimise, Surrogate
from truing.calculation import calculate
from truing.setup import Setup, default_setup

TRAINED = Surrogate(
    of="max_wear", over=BOX, logarithmic=("output_torque", "output_speed", "working_time"), log_result=True,
    held_out=10, compare=0,
)  # fmt: skip


def setups(generations: int) -> tuple[Setup, Setup]:
    """The same optimisation in full physics, and with a surrogate."""
    plain = Optimise(chance="first_order", generations=generations, verify=1000)
    setup = default_setup(RV_WEAR)
    learnt = replace(setup, studies=(TRAINED, replace(plain, surrogate=True)))
    return replace(setup, studies=(plain,)), learnt


def calculated_anew(setup: Setup) -> None:
    """The studies of a setup, nothing being remembered from before."""
    for kept in (history_of_group, unworn_of_group):
        kept.cache_clear()
    calculate(setup)


def test_full_physics_against_a_surrogate() -> None:
    """Full physics is the default because it loses nothing; it must not be the slower way either."""
    full, learnt = least(*(partial(calculated_anew, setup) for setup in setups(100)))
    print(f"\nfull physics {full:.2f} s, with a surrogate {learnt:.2f} s: {learnt / full:.2f} times as long")
    assert full < learnt
