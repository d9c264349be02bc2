"""A pin that wears, whose every text tries to be more than a text: for tests of the sheet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Effect,
    Finding,
    Float,
    Model,
    Published,
    Record,
    Require,
    Section,
    Table,
    Tolerance,
    Unknown,
    Words,
    axis,
    column,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    normal,
    plus_minus,
    results,
)

HOSTILE = "<script>alert(1)</script> {{7*7}} $x$ | # `code` [link](https://evil.example) **bold** & \"'\n# next"
"""What a user may write into any field of a sheet, and what must come out of it as it is, on one line."""


@inputs
class Pin:
    """What must be known before the calculation starts."""

    load: Float = given(120.0, "N", symbol="F", note="normal load on the pin", above=0)
    area: Float = given(28.0, "mm^2", symbol="A", note=HOSTILE, above=0)
    speed: Float = given(0.5, "m/s", symbol="v", note="sliding speed", source=HOSTILE)
    time: Float = given(200.0, "h", symbol="t", note="running time")
    hardness: Float = given(2.1, "GPa", symbol="H", note="softer body", above=0)
    rate: Float = given(3e-8, "", symbol="k", note="wear coefficient", source="test 14")
    early_depth: Float = given(0.0, "um", symbol="h_0", note="depth lost before the law holds")
    cover: Float = given(None, "mm", symbol="c_<b>", note="cover, if there is one")
    room: Float = given(20.0, "degC", symbol="theta_R", note="room temperature")


@results
class Wear:
    """What the calculation answers."""

    pressure: Float = found("MPa", symbol="p", formula="load / area", note="contact pressure")
    distance: Float = found("km", symbol="s", formula="speed * time", note="sliding distance")
    depth: Float = found(
        "um", symbol="h", note="worn depth", formula="early_depth + rate * pressure * distance / hardness"
    )
    both: Float = found(
        "um",
        note=HOSTILE,
        formula="early_depth + rate * load * speed * time / (area * hardness) + rate * pressure * distance / hardness"
        " + sqrt(early_depth**2 + (rate * pressure * distance / hardness)**2)",
    )
    moment: Float = axis("h", symbol="t_i", note="moment")
    course: Float = found(
        "um",
        symbol="h_i",
        note="depth so far",
        along="moment",
        formula="early_depth + rate * pressure * speed * moment / hardness",
    )
    root: Float = found("", symbol="x_2'", note="a root", method=HOSTILE, source=HOSTILE)


def wear(pin: Pin) -> Wear:
    """Archard's law."""
    pressure = pin.load / pin.area
    distance = pin.speed * pin.time
    depth = pin.early_depth + pin.rate * pressure * distance / pin.hardness
    moment = np.linspace(0.0, 200.0 * 3600, 1201)
    slope = pin.rate * pressure * pin.speed / pin.hardness
    lost = depth - pin.early_depth
    return Wear(
        pressure=pressure,
        distance=distance,
        depth=depth,
        both=depth + lost + np.hypot(pin.early_depth, lost),
        moment=moment,
        course=column(pin.early_depth) + column(slope) * moment,
        root=0.7381 + 0 * pressure,
    )


def running_in(pin: Pin, *, extra: Float, length: Float) -> Pin:
    """Fresh asperities go first."""
    return replace(pin, early_depth=pin.early_depth + extra * (1 - np.exp(-pin.speed * pin.time / length)))


def warm_frame(pin: Pin, base: Wear, *, slope: Float, frame: Float) -> Wear:
    """The frame grows."""
    return replace(base, depth=base.depth + slope * (frame - FRAME.zero))


def curve(record: Record[Pin, Wear]) -> object:
    """Draw the depth over time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 2.6))
    axes = figure.subplots()
    axes.plot(record.answers["moment"] / 3600, record.answers["course"] * 1e6, label="<b>&</b> $h_i$")
    axes.set_xlabel("time, h")
    axes.set_ylabel("depth, µm")
    axes.legend()
    return figure


def materials(record: Record[Pin, Wear]) -> list[Words | Table]:
    """Say what is known of the materials."""
    rows = [["steel <i>on</i> bronze", 3e-8, True], [HOSTILE, -1.2e-5, False], ["x", None, True]]
    return [
        Words(HOSTILE),
        Words("- no list\n# no heading", kind="finding"),
        Table(HOSTILE, ["pair | pair", "k", "ok"], rows, ["", "1/MPa", ""], note=HOSTILE),
    ]


FRAME = Condition("frame", "degC", reference=20, note="frame temperature")
PIN = Model(
    name="hostile_pin",
    title="Sliding wear of a pin",
    summary="How deep is the scar?",
    function=wear,
    cites=["Archard, J. F.: Contact and rubbing of flat surfaces. J. Appl. Phys. 24 (1953) 981", HOSTILE],
    errors=[
        Tolerance("load", normal(sd="3 %"), why="friction in the guide of the dead weight"),
        Tolerance("hardness", lognormal(sd="6 %"), why=HOSTILE),
        Tolerance("room", plus_minus("3 K"), why="day and night"),
        Effect(
            "running_in",
            on_inputs=running_in,
            looks_like="early surplus, then parallel",
            unknowns=[Unknown("extra", 0, 50, "um"), Unknown("length", 10, 5e3, "m")],
        ),
        Effect("warm_frame", on_results=warm_frame, needs=[FRAME], unknowns=[Unknown("slope", -2, 2, "um/K")]),
    ],
    objectives=[
        Require("pressure", at_most="80 MPa"),
        Require("depth", at_most="5 um"),
        Require("distance", at_least="300 km"),
    ],
    sheet=[
        Section("Contact | pressure", "pressure", text=HOSTILE),
        Section("Wear", "distance", "depth", "both", "course", figure=curve, caption=HOSTILE),
        Section("Materials", blocks=materials),
        Section("Only in full", "root", level="full"),
    ],
    published=[
        Published(name="pressure", result="pressure", value=4.286, unit="MPa", where="Table 1"),
        Published(
            name="depth at double load", result="depth", value=40.0, unit="um", where=HOSTILE,
            settings={"load": "240 N"}, verdict="differs", why=HOSTILE,
        ),
    ],
    findings=[Finding(title="A printed exponent", text=HOSTILE)],
)  # fmt: skip


@hookimpl
def truing_models() -> list[Model[Pin, Wear]]:
    """Offer one calculation."""
    return [PIN]
