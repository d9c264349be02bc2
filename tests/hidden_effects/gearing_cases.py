"""First stages with something wrong, or nothing: how they were measured, with what noise, and what a user has."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from hidden_effects.gearing_machine import Hidden, Rows, shown
from hidden_effects.gearing_stage import Array, Stage
from hidden_effects.noises import Kind, held_out, noise_of, title_of

Design: TypeAlias = Literal["rig", "sweep", "one_way"]
Strange: TypeAlias = Callable[[Rows], dict[str, Array]]
SUN_ROOT, PLANET_ROOT, CONTACT = "root_stress_sun", "root_stress_planet", "contact_stress"
ERROR, PLAY, LOSS, WARMTH = "transmission_error", "backlash", "efficiency", "flank_temperature"
UNIT = {SUN_ROOT: "MPa", PLANET_ROOT: "MPa", CONTACT: "MPa", ERROR: "um", PLAY: "um", LOSS: "1", WARMTH: "degC"}
NOISE = {SUN_ROOT: 2.0, PLANET_ROOT: 2.0, CONTACT: 8.0, ERROR: 0.5, PLAY: 1.0, LOSS: 0.004, WARMTH: 1.5}
HELD_OUT = 300
TURN_OF_OUTPUT = 39960.0  # deg of the sun


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What a case is to be like: hidden unknowns in the units of the registry, and what nobody registered."""

    seed: int
    results: tuple[str, ...]
    hidden: Hidden = field(default_factory=dict)
    design: Design = "rig"
    kind: Kind = "gaussian"
    count: int = 100
    strange: Strange | None = None
    """Added to the results it names, in the units of this module."""

    @property
    def title(self) -> str:
        """What the case is called in the list of tests."""
        return title_of(self.hidden, self.strange, self.design, self.kind, "+".join(self.results))


@dataclass(frozen=True, kw_only=True)
class Case:
    """A record with its readings, rows held out with theirs, and what is true of both."""

    wish: Wish
    rows: Rows
    held: Rows
    stage: Stage
    readings: Mapping[str, Array]
    held_readings: Mapping[str, Array]

    def true_readings(self, rows: Rows) -> dict[str, Array]:
        """What the gauges would show without noise."""
        return _true(self.wish, rows, self.stage)


def make_case(wish: Wish) -> Case:
    """Draw a machine within its tolerances, measure it, and put the noise on."""
    rng = np.random.default_rng([wish.seed, 75])
    every = measured(wish.design, wish.count + HELD_OUT, rng)
    rows, held = (every.taken(places) for places in held_out(len(every), HELD_OUT, rng))
    stage = built(rng)
    parts = []
    for part in (rows, held):
        true = _true(wish, part, stage)
        spread = 0.4 + 1.6 * np.abs(part.load_torque) / 1300
        noise = {name: noise_of(wish.kind, spread, NOISE[name], rng) for name in wish.results}
        parts.append({name: true[name] + noise[name] for name in wish.results})
    return Case(wish=wish, rows=rows, held=held, stage=stage, readings=parts[0], held_readings=parts[1])


def built(rng: np.random.Generator) -> Stage:
    """Draw a machine within its tolerances."""
    width, sun, planet, bearing = rng.standard_normal(4) * (0.033, 0.01, 0.01, 0.001)
    return Stage(12.0 + width, sun, planet, 0.99 + bearing)


def _true(wish: Wish, rows: Rows, stage: Stage) -> dict[str, Array]:
    read = shown(rows, stage, wish.hidden)
    for name, more in (wish.strange(rows) if wish.strange else {}).items():
        read[name] = read[name] + more
    return read


def measured(design: Design, count: int, rng: np.random.Generator) -> Rows:
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
