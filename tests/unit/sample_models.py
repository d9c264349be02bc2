"""Small calculations that the tests of files share: pins that wear, and a stage of two gears on a measured surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from truing.declare.batch import feasible
from truing.declare.fields import Float, axis, found, given, inputs, loaded, part, results
from truing.declare.goals import Require
from truing.declare.model import Model
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.declare.spreads import by_choice, grade, lognormal, normal, plus_minus, zone
from truing.kernel import Offer, Origin


@inputs
class Pin:
    """What must be known before the calculation starts."""

    load: Float = given(120.0, "N", symbol="F", note="normal load on the pin", above=0)
    area: Float = given(28.0, "mm^2", symbol="A", note="contact area", above=0)
    speed: Float = given(0.5, "m/s", symbol="v", note="sliding speed")
    time: Float = given(200.0, "h", symbol="t", note="running time")
    hardness: Float = given(2.1, "GPa", symbol="H", note="softer body", above=0)
    rate: Float = given(3e-8, "", symbol="k", note="wear coefficient", source="test 14")
    early_depth: Float = given(0.0, "um", symbol="h_0", note="depth lost before the law holds")


@results
class Wear:
    """What the calculation answers."""

    pressure: Float = found("MPa", symbol="p", formula="load / area", note="contact pressure")
    distance: Float = found("km", symbol="s", formula="speed * time", note="sliding distance")
    depth: Float = found("um", symbol="h", note="worn depth")


def wear(pin: Pin) -> Wear:
    """Archard's law."""
    feasible(pin.load < pin.hardness * pin.area, "the contact flows: load exceeds hardness times area")
    pressure = pin.load / pin.area
    distance = pin.speed * pin.time
    depth = pin.early_depth + pin.rate * pressure * distance / pin.hardness
    return Wear(pressure=pressure, distance=distance, depth=depth)


def running_in(pin: Pin, *, extra: Float, length: Float) -> Pin:
    """Fresh asperities go first."""
    return replace(pin, early_depth=pin.early_depth + extra * (1 - np.exp(-pin.speed * pin.time / length)))


def warm_probe(pin: Pin, base: Wear, *, slope: Float, probe_temperature: Float) -> Wear:
    """The displacement probe reads deeper when warm."""
    return replace(base, depth=base.depth + slope * (probe_temperature - PROBE.zero))


@dataclass(frozen=True)
class Census:
    """A study that only has options."""

    draws: int = 1000
    share: float = 0.5
    method: Literal["plain", "quasi"] = "plain"
    of: tuple[str, ...] = ("depth",)
    name: str = "census"
    gives: None = None

    def __post_init__(self) -> None:
        if self.draws < 1:
            raise ValueError("draws is at least 1")
        if "nothing" in self.of:
            raise ValueError("of names no result")
        if self.method == "quasi" and self.draws % 2:
            raise ValueError("quasi takes an even number of draws")

    def run(self, bench: object) -> None:
        """Do nothing."""


PROBE = Condition("probe_temperature", "degC", reference=20)
RENAMED = {"k_wear": "rate"}
PIN_WEAR = Model(
    name="pin_wear",
    title="Sliding wear of a pin",
    function=wear,
    errors=[
        Tolerance("load", normal(sd="3 %"), why="friction in the guide of the dead weight"),
        Tolerance("hardness", lognormal(sd="6 %"), why="batch scatter on the certificate"),
        Effect(
            "running_in",
            on_inputs=running_in,
            looks_like="early surplus, then parallel",
            unknowns=[Unknown("extra", 0, 50, "um"), Unknown("length", 10, 5e3, "m")],
        ),
        Effect(
            "warm_probe",
            on_reading=warm_probe,
            needs=[PROBE],
            looks_like="follows the probe, not the wear",
            unknowns=[Unknown("slope", -2, 2, "um/K")],
        ),
    ],
    objectives=[Require("pressure", at_most="80 MPa")],
    studies=[Census(), Census(name="second")],
)


@dataclass(frozen=True)
class Surface:
    """Heights read from a file."""

    heights: tuple[float, ...]
    spacing: str


def read_surface(path: Path, *, spacing: str, height_unit: str = "um") -> Surface:
    """Read one height per line."""
    return Surface(tuple(float(line) for line in path.read_text().split()), spacing)


@inputs
class Gear:
    """One gear."""

    teeth: Float = given(20, "", symbol="z", note="number of teeth", at_least=5, at_most=500, whole=True)
    bore: Float = given(30.0, "mm", symbol="d", note="bore", above=0)


@inputs
class Stage:
    """Two gears, a choice, a count, an optional factor, a series and a measured surface."""

    sun: Gear = part(Gear, index="1", teeth=20)
    planet: Gear = part(Gear, index="2", teeth=31)
    reading: Literal["printed", "complete"] = given("complete", note="which reading of the paper")
    planets: int = given(3, note="number of planets", at_least=2)
    is_hardened: bool = given(True, note="case-hardened flanks")
    face_factor: Float = given(None, "", symbol="K_H", note="face load factor", at_least=1)
    oil: Float = given(60.0, "degC", symbol="T", note="oil temperature")
    profile: Float = given((0.0, 1.0, 0.5), "um", note="flank profile", along="lag")
    orders: tuple[int, ...] = given((1, 2), note="orders looked at")
    surface: Surface = loaded(read_surface, note="measured flank")


@results
class Ratio:
    """The one answer, and the axis of the profile."""

    ratio: Float = found("", symbol="i", note="ratio")
    lag: Float = axis("mm", note="place along the flank")


def ratio_of(stage: Stage) -> Ratio:
    """Return the ratio of two numbers of teeth."""
    return Ratio(ratio=stage.planet.teeth / stage.sun.teeth, lag=np.arange(3) * 1e-3)


STAGE = Model(
    name="stage",
    title="A gear stage",
    function=ratio_of,
    errors=[
        Tolerance("bores", grade("IT7"), on=["bore_sun", "bore_planet"]),
        Tolerance("oil", by_choice("reading", printed=plus_minus("2 K"), complete=plus_minus("5 K"))),
        Tolerance("face_factor", zone("0", "0.2")),
    ],
)

PIN_OFFER = Offer("pin_wear", PIN_WEAR, Origin("pin_wear", "1.2.0", "pins", "pins.py", "entry:pin_wear"))
STAGE_OFFER = Offer("gears.stage", STAGE, Origin("gears", "0.1", "gears", "gears.py", "entry:gears"))
