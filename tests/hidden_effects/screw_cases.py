"""Roller screws with something wrong, or nothing: how they were measured, and with what noise."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from hidden_effects.noises import Kind, held_out, noise_of, title_of
from hidden_effects.screw_machine import WIDTHS, Array, Hidden, Rows, shown

Design: TypeAlias = Literal["bench", "loaded", "endurance"]
Strange: TypeAlias = Callable[[Rows], Array]
ROLLER, RING, ERROR = "root_stress_roller", "root_stress_ring", "transmission_error"
WEAR, AXIAL, TORQUE, BACKLASH = "wear_depth", "axial_shift", "friction_torque", "backlash"
STRESSES = (ROLLER, RING)
UNIT = {ROLLER: "MPa", RING: "MPa", ERROR: "um", WEAR: "um", AXIAL: "um", TORQUE: "N*m", BACKLASH: "um"}
NOISE = {ROLLER: 1.5, RING: 2.0, ERROR: 0.5, WEAR: 0.1, AXIAL: 2.0, TORQUE: 5e-4, BACKLASH: 0.4}
LOADS: Mapping[Design, tuple[float, float]] = {"bench": (2.0, 20.0), "loaded": (12.0, 20.0), "endurance": (5.0, 20.0)}
HELD_OUT = 200


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What a case is to be like: hidden unknowns in the units of the registry, and what nobody registered."""

    seed: int
    hidden: Hidden = field(default_factory=dict)
    design: Design = "bench"
    kind: Kind = "gaussian"
    results: tuple[str, ...] = STRESSES
    count: int = 80
    strange: Strange | None = None
    """Added to the first result, in its unit."""

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
    """Draw a screw within its tolerances, measure it, and put the noise on."""
    rng = np.random.default_rng([wish.seed, 58])
    every = measured(wish.design, wish.count + HELD_OUT, rng)
    rows, held = (every.taken(places) for places in held_out(len(every), HELD_OUT, rng))
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in WIDTHS.items()}
    parts = []
    for part in (rows, held):
        true = _true(wish, part, off)
        spread = 0.4 + part.axial_load / 12
        noise = {name: noise_of(wish.kind, spread, NOISE[name], rng) for name in wish.results}
        parts.append({name: true[name] + noise[name] for name in wish.results})
    return Case(wish=wish, rows=rows, held=held, off=off, readings=parts[0], held_readings=parts[1])


def _true(wish: Wish, rows: Rows, off: Mapping[str, float]) -> dict[str, Array]:
    read = shown(rows, off, wish.hidden)
    if wish.strange is not None:
        first = wish.results[0]
        read[first] = read[first] + wish.strange(rows)
    return read


def measured(design: Design, count: int, rng: np.random.Generator) -> Rows:
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
