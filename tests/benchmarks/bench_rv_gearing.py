"""How much faster is the strength of many first stages in one array call than stage by stage?

Run it: ``python -m pytest tests/benchmarks/bench_rv_gearing.py -s``. The baseline calls the calculation itself once for
each stage, with plain numbers and the inputs ready made, on a sample of the stages, and is scaled to all of them. Both
are measured alternately in one process, in time of the processor, and the least of each counts.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from timed import least

from rv_gearing.model import RV_GEARING
from rv_gearing.quantities import Gearing
from rv_gearing.rating import rv_gearing

STAGES = 100_000
ALONE = 200  # of them one by one; their time hardly varies
RESULTS = ("root_stress_sun", "root_stress_planet", "contact_stress", "contact_safety", "root_safety_outer")


def columns() -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Sizes, teeth, shifts and load of very different stages, spur to helical."""
    rng = np.random.default_rng(1)
    return {
        "sun_teeth": rng.integers(18, 36, STAGES) * 1.0,
        "planet_teeth": rng.integers(45, 99, STAGES) * 1.0,
        "face_width": rng.uniform(8e-3, 20e-3, STAGES),
        "helix_angle": rng.uniform(0.0, 0.3, STAGES),
        "load_torque": rng.uniform(100.0, 1500.0, STAGES),
        "input_speed": rng.uniform(5.0, 40.0, STAGES),
    }


def stages() -> tuple[Gearing, list[Gearing]]:
    """All of them as one, and some of them alone."""
    drawn = columns()
    one = RV_GEARING.inputs()
    spread = range(0, STAGES, STAGES // ALONE)
    alone = [replace(one, **{name: np.float64(values[row]) for name, values in drawn.items()}) for row in spread]
    return replace(one, **drawn), alone


def one_by_one(alone: list[Gearing]) -> None:
    for stage in alone:
        rv_gearing(stage)


def test_both_find_the_same_strength() -> None:
    together, alone = stages()
    found = RV_GEARING.read_results(rv_gearing(together))
    for place, stage in enumerate(alone):
        own = RV_GEARING.read_results(rv_gearing(stage))
        for name in RESULTS:
            there = found[name][place * (STAGES // ALONE)]
            assert abs(there - own[name]) <= 1e-12 * abs(own[name])


def test_one_call_is_fifty_times_faster_than_the_loop_over_single_calls() -> None:
    together, alone = stages()
    rv_gearing(together)
    loop, call = least(lambda: one_by_one(alone), lambda: rv_gearing(together), rounds=5)
    single, share = loop / len(alone), call / STAGES
    print(
        f"\nstrength per stage: single calls {single * 1e6:.0f} us, one call for {STAGES} {share * 1e6:.2f} us: ",
        end="",
    )
    print(f"{single / share:.0f} times (at least 50)")
    assert single / share >= 50.0
