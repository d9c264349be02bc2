"""Reducers with something wrong, or nothing: how they were measured, with what noise, and what a user would have."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from hidden_effects.rigs import Bench, Rig, Wish
from hidden_effects.rv_machine import LIFE, RATED, ROUGHNESS_SCATTER, SPEED, ZONES, Array, Rows, shown

BACKLASH, WEAR = "backlash", "max_wear"
UNIT = {BACKLASH: "arcmin", WEAR: "um"}


def machine(rng: np.random.Generator) -> Mapping[str, float]:
    """Draw a reducer within its zones."""
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in ZONES.items()}
    return {**off, "roughness": float(ROUGHNESS_SCATTER * rng.standard_normal())}


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock. Endurance: one set of discs at the rating; fleet: four sets, each at its own."""
    sets = {"endurance": 1, "fleet": 4}[design]
    set_of = np.sort(np.arange(count) % sets)
    hours = LIFE * np.concatenate([np.sort(rng.random(int(np.sum(set_of == one))) ** 1.5) for one in range(sets)])
    hours[0] = 0.0

    def by_set(low: float, high: float, rated: float) -> Array:
        values = np.linspace(low, high, sets)[rng.permutation(sets)] if sets > 1 else np.array([rated])
        return np.asarray(values[set_of])

    warm = rng.uniform(20, 45, count)
    return Rows(
        time=hours + LIFE * set_of * 1.02,
        working_time=hours,
        output_torque=by_set(2000, 4200, RATED),
        output_speed=by_set(8, 20, SPEED),
        oil_temperature=by_set(35, 60, 47.0),
        housing_temperature=warm,
        disc_temperature=warm + rng.uniform(-2, 8, count),
        output_angle=rng.uniform(0, 360, count),
        crank_angle=np.random.default_rng(count).uniform(0, 360, count),
        measuring_torque=rng.uniform(0, 300, count),
        direction=rng.choice([-1.0, 1.0], count),
    )


REDUCER = Rig(
    plugin="rv_wear",
    inputs='plugin = "rv_wear"\n',
    written={
        "time": "h", "working_time": "h", "output_torque": "N*m", "output_speed": "r/min",
        "housing_temperature": "degC", "disc_temperature": "degC", "oil_temperature": "degC", "output_angle": "deg",
        "crank_angle": "deg", "measuring_torque": "N*m", "direction": "1",
    },
    measured=UNIT,
    make=Bench(
        stream=74, held=300, measured=measured, machine=machine, shown=shown,
        spread=lambda rows: 0.4 + 1.6 * rows.working_time / LIFE, noise={BACKLASH: 0.01, WEAR: 0.1},
    ),
)  # fmt: skip
reducer = partial(Wish, rig=REDUCER, design="endurance", results=(BACKLASH,), count=100)
"""What a reducer is to be like."""
