"""Two gears under a record of loads, with a measured surface: one input and one result of every kind."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    axis,
    column,
    either,
    feasible,
    found,
    given,
    grade,
    hookimpl,
    inputs,
    loaded,
    part,
    results,
)


@dataclass(frozen=True)
class Surface:
    """Heights in metres."""

    heights: tuple[float, ...]


def read_surface(path: Path, *, height_unit: str = "um") -> Surface:
    """Read one height per line; lines that begin with # are words."""
    scale = {"um": 1e-6, "nm": 1e-9}[height_unit]
    lines = path.read_text(encoding="utf-8").splitlines()
    return Surface(tuple(float(line) * scale for line in lines if not line.startswith("#")))


@inputs
class Gear:
    """One gear."""

    teeth: Float = given(30, "", symbol="z", whole=True, at_least=5)
    bore: Float = given(20.0, "mm", symbol="d_B", above=0)


@inputs
class Record:
    """What was set and what was recorded."""

    surface: Surface = loaded(read_surface)
    sun: Gear = part(Gear, index="1", teeth=20)
    planet: Gear = part(Gear, index="2", bore="15 mm")
    load: Float = given((1.0, 2.0), "kN", symbol="F", along="moment")
    stiffness: Float = given(50.0, "N/um", symbol="c", above=0)
    loss: Float = given(0.0, "um", symbol="s_0")
    measured_factor: Float = given(None, "", symbol="k")
    oil: Float = given(60.0, "degC", symbol="T")
    planets: int = given(3)
    reading: Literal["printed", "complete"] = given("complete")


@results
class Wheel:
    """What is asked of each gear."""

    share: Float = found("mm", symbol="u", formula="bore / teeth")


@results
class Answer:
    """Along the record, for each gear, and in one number."""

    moment: Float = axis("s")
    travel: Float = found("um", along="moment", formula="load / stiffness - loss")
    highest: Float = found("um", symbol="s_max", formula="max(travel)")
    sun: Wheel = part(Wheel, index="1")
    planet: Wheel = part(Wheel, index="2")
    factor: Float = found("", symbol="k")
    warmth: Float = found("K", formula="oil / planets")
    roughness: Float = found("um", note="highest point of the surface")


def gear_record(given: Record) -> Answer:
    """One body for a number and for a batch."""
    travel = given.load / column(given.stiffness) - column(given.loss)
    feasible(travel > -1, "the gears part")
    half = 0.5 if given.reading == "printed" else 1.0
    return Answer(
        moment=np.arange(np.shape(travel)[-1], dtype=np.float64),
        travel=travel,
        highest=np.max(travel, axis=-1),
        sun=Wheel(share=given.sun.bore / given.sun.teeth),
        planet=Wheel(share=given.planet.bore / given.planet.teeth),
        factor=either(given.measured_factor, half * np.where(given.oil > 330, 1.0, 2.0)),
        warmth=given.oil / given.planets,
        roughness=max(given.surface.heights),
    )


def wearing(given: Record, *, depth: Float) -> Record:
    """All flanks wear alike."""
    return replace(given, loss=given.loss + depth)


GEAR_RECORD = Model(
    name="gear_record",
    title="Two gears under a record of loads",
    function=gear_record,
    errors=[
        Tolerance("bores", grade("IT7"), on=["bore_sun", "bore_planet"]),
        Effect("wearing", on_inputs=wearing, unknowns=[Unknown("depth", 0, 100, "um")]),
    ],
    sheet=[Section("Record", "highest", "share_sun", "share_planet", "factor")],
    example=Path(__file__).with_name("example.toml"),
)


@hookimpl
def truing_models() -> list[Model[Record, Answer]]:
    """Offer one calculation: gear_record."""
    return [GEAR_RECORD]
