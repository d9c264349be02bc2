"""Roller screws with something wrong, or nothing: how they were measured, and with what noise."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from hidden_effects.rigs import Bench, Rig, Wish
from hidden_effects.screw_machine import WIDTHS, Rows, shown

ROLLER, RING, ERROR = "root_stress_roller", "root_stress_ring", "transmission_error"
WEAR, AXIAL, TORQUE, BACKLASH = "wear_depth", "axial_shift", "friction_torque", "backlash"
STRESSES = (ROLLER, RING)
UNIT = {ROLLER: "MPa", RING: "MPa", ERROR: "um", WEAR: "um", AXIAL: "um", TORQUE: "N*m", BACKLASH: "um"}
NOISE = {ROLLER: 1.5, RING: 2.0, ERROR: 0.5, WEAR: 0.1, AXIAL: 2.0, TORQUE: 5e-4, BACKLASH: 0.4}
LOADS: Mapping[str, tuple[float, float]] = {"bench": (2.0, 20.0), "loaded": (12.0, 20.0), "endurance": (5.0, 20.0)}


def machine(rng: np.random.Generator) -> Mapping[str, float]:
    """Draw a screw within its tolerances."""
    return {name: float(width / 6 * rng.standard_normal()) for name, width in WIDTHS.items()}


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock.

    Bench: any load from 2 to 20 kN, few cycles. Loaded: the same from 12 kN on. Endurance: four sets of rollers, each
    at its own load, to three million cycles.
    """
    low, high = LOADS[design]
    time = np.sort(rng.uniform(0, 40, count))
    load, cycles = rng.uniform(low, high, count), 400 * time
    if design == "endurance":
        set_of = np.arange(count) * 4 // count
        load = np.linspace(low, high, 4)[rng.permutation(4)][set_of]
        cycles = np.concatenate([np.sort(rng.uniform(0, 3e6, int(np.sum(set_of == one)))) for one in range(4)])
        time = cycles / 6000 + 520 * set_of
    return Rows(
        time=time,
        axial_load=load,
        screw_speed=rng.uniform(60, 3000, count) * rng.choice([-1.0, 1.0], count),
        temperature=rng.uniform(20, 60, count),
        screw_angle=rng.uniform(0, 40 * 360, count),
        cycles=cycles,
    )


SCREW = Rig(
    plugin="roller_screw_shift",
    inputs='plugin = "roller_screw_shift"\n\n[studies.diagnose]\nbox = { axial_load = "1..25 kN" }\n',
    written={
        "time": "h", "axial_load": "kN", "screw_speed": "r/min", "temperature": "degC", "screw_angle": "deg",
        "cycles": "1",
    },
    measured=UNIT,
    make=Bench(
        stream=58, held=200, measured=measured, machine=machine, shown=shown,
        spread=lambda rows: 0.4 + rows.axial_load / 12, noise=NOISE,
    ),
)  # fmt: skip
screw = partial(Wish, rig=SCREW, design="bench", results=STRESSES, count=80)
"""What a roller screw is to be like."""
