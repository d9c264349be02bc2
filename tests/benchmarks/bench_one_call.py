"""How much faster are 100 000 cases in one call of a calculation than case by case?

Run it: ``python -m pytest tests/benchmarks/bench_one_call.py -s``. The baseline calls the calculation itself once for
each case, with plain numbers and the inputs ready made, on a sample of the cases, and is scaled to all of them. Both
are measured alternately in one process, in time of the processor, and the least of each counts.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from timed import least

from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from rv_gearing.model import RV_GEARING
from truing import Model

CASES, ALONE = 100_000, 200
"""All cases, and how many of them one by one; their time hardly varies."""
RNG = np.random.default_rng(1)
STAGES = {
    "sun_teeth": RNG.integers(18, 36, CASES) * 1.0,
    "planet_teeth": RNG.integers(45, 99, CASES) * 1.0,
    "face_width": RNG.uniform(8e-3, 20e-3, CASES),
    "helix_angle": RNG.uniform(0.0, 0.3, CASES),
    "load_torque": RNG.uniform(100.0, 1500.0, CASES),
    "input_speed": RNG.uniform(5.0, 40.0, CASES),
}
"""Sizes, teeth and load of very different first stages, spur to helical."""
SHIFTS = {"roller_shift": np.linspace(-0.2, 1.0, CASES)}
"""Profile shifts at which every number of a roller screw exists."""


@pytest.mark.parametrize(("model", "columns"), [(RV_GEARING, STAGES), (ROLLER_SCREW_SHIFT, SHIFTS)])
def test_one_call_says_the_same_fifty_times_faster(model: Model[Any, Any], columns: Mapping[str, Any]) -> None:
    one = model.inputs()
    together, rows = replace(one, **columns), range(0, CASES, CASES // ALONE)
    alone = [replace(one, **{name: np.float64(values[row]) for name, values in columns.items()}) for row in rows]
    found = model.read_results(model.function(together))
    for row, case in zip(rows, alone, strict=True):
        for name, value in model.read_results(model.function(case)).items():
            assert np.broadcast_to(found[name], CASES)[row] == pytest.approx(value, rel=1e-12, nan_ok=True)
    loop, call = least(lambda: [model.function(case) for case in alone], lambda: model.function(together), rounds=5)
    single, share = 1e6 * loop / ALONE, 1e6 * call / CASES
    print(f"\n{model.name}: single calls {single:.0f} us a case, one call {share:.2f} us: {single / share:.0f} times")
    assert single >= 50.0 * share
