"""Reducers with something wrong, or nothing: how they were measured, with what noise, and what a user would have."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from hidden_effects.noises import Kind, held_out, noise_of, title_of
from hidden_effects.rv_machine import LIFE, RATED, ROUGHNESS_SCATTER, SPEED, ZONES, Array, Hidden, Rows, shown

Design: TypeAlias = Literal["endurance", "fleet"]
Strange: TypeAlias = Callable[[Rows], Array]
BACKLASH, WEAR = "backlash", "max_wear"
UNIT = {BACKLASH: "arcmin", WEAR: "um"}
NOISE = {BACKLASH: 0.01, WEAR: 0.1}
HELD_OUT = 300


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What a case is to be like: hidden unknowns in the units of the registry, and what nobody registered."""

    seed: int
    hidden: Hidden = field(default_factory=dict)
    design: Design = "endurance"
    kind: Kind = "gaussian"
    results: tuple[str, ...] = (BACKLASH,)
    count: int = 100
    strange: Strange | None = None
    """Added to the backlash, arcmin."""

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
    off: Mapping[str, float]
    readings: Mapping[str, Array]
    held_readings: Mapping[str, Array]

    def true_readings(self, rows: Rows) -> dict[str, Array]:
        """What the gauges would show without noise."""
        return _true(self.wish, rows, self.off)


def make_case(wish: Wish) -> Case:
    """Draw a machine within its zones, measure it, and put the noise on."""
    rng = np.random.default_rng([wish.seed, 74])
    every = measured(wish.design, wish.count + HELD_OUT, rng)
    rows, held = (every.taken(places) for places in held_out(len(every), HELD_OUT, rng))
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in ZONES.items()}
    off["roughness"] = float(ROUGHNESS_SCATTER * rng.standard_normal())
    parts = []
    for part in (rows, held):
        true = _true(wish, part, off)
        spread = 0.4 + 1.6 * part.working_time / LIFE
        noise = {name: noise_of(wish.kind, spread, NOISE[name], rng) for name in wish.results}
        parts.append({name: true[name] + noise[name] for name in wish.results})
    return Case(wish=wish, rows=rows, held=held, off=off, readings=parts[0], held_readings=parts[1])


def _true(wish: Wish, rows: Rows, off: Mapping[str, float]) -> dict[str, Array]:
    read = shown(rows, off, wish.hidden)
    if wish.strange is not None:
        read[BACKLASH] = read[BACKLASH] + wish.strange(rows)
    return read


def measured(design: Design, count: int, rng: np.random.Generator) -> Rows:
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
