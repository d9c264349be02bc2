"""First stages with something wrong, or nothing: how they were measured, with what noise, and what a user has."""

from functools import partial

import numpy as np

from hidden_effects.gearing_machine import Rows, shown
from hidden_effects.gearing_stage import Stage
from hidden_effects.rigs import Bench, Rig, Wish

SUN_ROOT, PLANET_ROOT, CONTACT = "root_stress_sun", "root_stress_planet", "contact_stress"
ERROR, PLAY, LOSS, WARMTH = "transmission_error", "backlash", "efficiency", "flank_temperature"
UNIT = {SUN_ROOT: "MPa", PLANET_ROOT: "MPa", CONTACT: "MPa", ERROR: "um", PLAY: "um", LOSS: "1", WARMTH: "degC"}
NOISE = {SUN_ROOT: 2.0, PLANET_ROOT: 2.0, CONTACT: 8.0, ERROR: 0.5, PLAY: 1.0, LOSS: 0.004, WARMTH: 1.5}
TURN_OF_OUTPUT = 39960.0  # deg of the sun


def built(rng: np.random.Generator) -> Stage:
    """Draw a machine within its tolerances."""
    width, sun, planet, bearing = rng.standard_normal(4) * (0.033, 0.01, 0.01, 0.001)
    return Stage(12.0 + width, sun, planet, 0.99 + bearing)


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock. Rig: loads of either sign; sweep: small, through zero; one way: large."""
    load = {
        "rig": rng.choice([-1.0, 1.0], count) * rng.uniform(120, 1300, count),
        "sweep": rng.uniform(-400, 400, count),
        "one_way": rng.uniform(600, 1300, count),
    }[design]
    return Rows(
        time=2000 * np.sort(rng.random(count)),
        load_torque=load,
        input_speed=rng.uniform(300, 2500, count),
        oil_temperature=rng.uniform(25, 80, count),
        input_angle=rng.uniform(0, 1.3 * TURN_OF_OUTPUT, count),
    )


STAGE = Rig(
    plugin="rv_gearing",
    inputs='plugin = "rv_gearing"\n[inputs]\nsun_teeth = 20\nplanet_teeth = 55\n',
    written={
        "time": "h", "load_torque": "N*m", "input_speed": "rpm", "oil_temperature": "degC", "input_angle": "deg",
    },
    measured=UNIT,
    make=Bench(
        stream=75, held=300, measured=measured, machine=built, shown=shown,
        spread=lambda rows: 0.4 + 1.6 * np.abs(rows.load_torque) / 1300, noise=NOISE,
    ),
)  # fmt: skip
stage = partial(Wish, rig=STAGE, design="rig", count=100)
"""What a first stage is to be like."""
