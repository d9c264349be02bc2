"""Small calculations that the tests of files share: pins that wear, and a stage of two gears on a measured surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import pin_wear
import pytest

from truing.declare.fields import Float, axis, found, given, inputs, loaded, part, results
from truing.declare.goals import Require
from truing.declare.model import Model
from truing.declare.sources import Tolerance
from truing.declare.spreads import by_choice, grade, normal, plus_minus, zone
from truing.errors import InputError
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.setup import Setup


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


RENAMED = {"k_wear": "rate"}
"""Old names of inputs, which the kernel looks for in the module of the model's function."""


def wear(pin: pin_wear.Pin) -> pin_wear.Wear:
    """Archard's law, in the module that renames an input."""
    return pin_wear.wear(pin)


PIN_WEAR = replace(
    pin_wear.PIN_WEAR,
    function=wear,
    cites=[],
    errors=[
        Tolerance("load", normal(sd="3 %"), why="friction in the guide of the dead weight"),
        *pin_wear.PIN_WEAR.errors[1:],
    ],
    objectives=[Require("pressure", at_most="80 MPa")],
    studies=[Census(), Census(name="second")],
    sheet=[],
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


def pin(text: str, *overrides: str, file: str = "wear.toml") -> Setup:
    """Read the text of an inputs file of the pin."""
    return setup_from_text(text, PIN_OFFER, file=file, folder=Path(), overrides=overrides)


def faults(text: str) -> list[str]:
    """Return what is said of such a text, which must be refused: a sentence each."""
    with pytest.raises(InputError) as caught:
        pin(text)
    return str(caught.value).splitlines()
