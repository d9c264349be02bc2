"""Sliding wear of a pin on a disc: how deep is the scar after a given time?"""

from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Effect,
    Float,
    Maximise,
    Minimise,
    Model,
    Odds,
    Price,
    Reliability,
    Require,
    Section,
    Sensitivity,
    Tolerance,
    Unknown,
    Vary,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    normal,
    results,
)


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
    """What the calculation answers, with the formula printed on the sheet."""

    pressure: Float = found("MPa", symbol="p", formula="load / area", note="contact pressure")
    distance: Float = found("km", symbol="s", formula="speed * time", note="sliding distance")
    depth: Float = found(
        "um", symbol="h", note="worn depth", formula="early_depth + rate * pressure * distance / hardness"
    )


@results
class Chance:
    """What the studies add to the answer."""

    safe_share: Float = found("%", symbol="R", note="share of pins below the permitted pressure")


def wear(pin: Pin) -> Wear:
    """Archard's law, mild dry wear only; every field is a number or an array (n,)."""
    feasible(pin.load < pin.hardness * pin.area, "the contact flows: load exceeds hardness times area")
    pressure = pin.load / pin.area
    distance = pin.speed * pin.time
    depth = pin.early_depth + pin.rate * pressure * distance / pin.hardness
    return Wear(pressure=pressure, distance=distance, depth=depth)


def running_in(pin: Pin, *, extra: Float, length: Float) -> Pin:
    """Fresh asperities go first: extra depth, complete after a few lengths."""
    return replace(pin, early_depth=pin.early_depth + extra * (1 - np.exp(-pin.speed * pin.time / length)))


def warm_probe(pin: Pin, base: Wear, *, slope: Float, probe_temperature: Float) -> Wear:
    """The displacement probe reads deeper when warm; the pin does not care."""
    return replace(base, depth=base.depth + slope * (probe_temperature - PROBE.zero))


def chance(odds: Odds) -> Chance:
    """The one number of the reliability study that the paper prints."""
    return Chance(safe_share=odds.at_least["pressure"])


PROBE = Condition("probe_temperature", "degC", reference=20)
PIN_WEAR = Model(
    name="pin_wear",
    title="Sliding wear of a pin",
    function=wear,
    cites=["Archard1953"],
    errors=[
        Tolerance(
            "load",
            normal(sd="3 %"),
            why="friction in the guide of the dead weight",
            price=Price("40 * width**-0.5", width="N", unit="EUR"),
        ),
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
    objectives=[
        Vary("load", "50 N", "200 N"),
        Minimise("depth"),
        Maximise("load"),
        Require("pressure", at_most="80 MPa", reliability=0.99),
    ],
    studies=[Sensitivity(of="depth"), Reliability(gives=chance)],
    sheet=[Section("Contact", "pressure", "safe_share"), Section("Wear", "distance", "depth")],
)


@hookimpl
def truing_models() -> list[Model[Pin, Wear]]:
    """Offer one calculation: pin_wear."""
    return [PIN_WEAR]
