"""How much ozone is in the air when a monitor shows some number?"""

from dataclasses import replace

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Section,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    results,
)


@inputs
class Monitor:
    """A monitor beside a reference photometer; what a perfect one does not have is neutral as declared."""

    reading: Float = given(500.0, "", symbol="x", note="what the monitor shows, in units of the source", at_least=0)
    span: Float = given(0.0, "", symbol="g", note="share by which it shows too little")
    zero: Float = given(0.0, "", symbol="z", note="by how much it shows too little at any level")
    bend: Float = given(0.0, "", symbol="c", note="share by which it shows too little at a reading of 1000")
    lamp: Float = given(0.0, "", symbol="l", note="share of stray light in its lamp")


@results
class Ozone:
    """What the reference photometer measures."""

    ozone: Float = found(
        "", symbol="y", note="ozone, in units of the source",
        formula="zero + reading * (1 + span + bend * reading / 1000) / (1 - lamp * (reading / 1000)**2)",
    )  # fmt: skip


def ozone_monitor(monitor: Monitor) -> Ozone:
    """A perfect monitor shows what is there. Shapes (n,) or numbers."""
    level = monitor.reading / 1000
    shown = monitor.reading * (1 + monitor.span + monitor.bend * level)
    return Ozone(ozone=monitor.zero + shown / (1 - monitor.lamp * level**2))


NUMBER = Condition("number", "", role="goes_on", note="number of the comparison, in the order of the table")


def wrong_span(monitor: Monitor, *, share: Float) -> Monitor:
    """Path length or absorption coefficient is off: everything by the same share."""
    return replace(monitor, span=monitor.span + share)


def wrong_zero(monitor: Monitor, *, level: Float) -> Monitor:
    """Something else than ozone absorbs, or the scrubber is spent: the same at any level."""
    return replace(monitor, zero=monitor.zero + level)


def long_path(monitor: Monitor, *, share: Float) -> Monitor:
    """The electronics take no logarithm of the absorption: what is missing grows as the square."""
    return replace(monitor, bend=monitor.bend + share)


def stray_light(monitor: Monitor, *, share: Float) -> Monitor:
    """Light of another colour reaches the detector: high levels are shown far too low."""
    return replace(monitor, lamp=monitor.lamp + share)


def span_drift(monitor: Monitor, *, per_row: Float, number: Float) -> Monitor:
    """The span wanders in the course of the calibration: by the same share from row to row."""
    return replace(monitor, span=monitor.span + per_row * number)


def zero_drift(monitor: Monitor, *, per_row: Float, number: Float) -> Monitor:
    """The zero wanders in the course of the calibration."""
    return replace(monitor, zero=monitor.zero + per_row * number)


OZONE_MONITOR = Model(
    name="ozone_monitor",
    title="Calibration of an ozone monitor",
    function=ozone_monitor,
    errors=[
        Effect(
            "wrong_span",
            on_inputs=wrong_span,
            looks_like="a line through zero",
            unknowns=[Unknown("share", -0.1, 0.1)],
        ),
        Effect(
            "wrong_zero",
            on_inputs=wrong_zero,
            looks_like="the same at every level",
            unknowns=[Unknown("level", -10, 10)],
        ),
        Effect(
            "long_path",
            on_inputs=long_path,
            looks_like="a parabola",
            unknowns=[Unknown("share", 0, 0.1, "", note="at a reading of 1000")],
        ),
        Effect(
            "stray_light",
            on_inputs=stray_light,
            looks_like="nothing at low levels, steep at high ones",
            unknowns=[Unknown("share", 0, 0.1, "", note="at a reading of 1000")],
        ),
        Effect(
            "span_drift",
            on_inputs=span_drift,
            needs=[NUMBER],
            looks_like="a line through zero that turns in the course of the table",
            unknowns=[Unknown("per_row", -0.001, 0.001)],
        ),
        Effect(
            "zero_drift",
            on_inputs=zero_drift,
            needs=[NUMBER],
            looks_like="the same at every level, growing in the course of the table",
            unknowns=[Unknown("per_row", -0.2, 0.2)],
        ),
    ],
    sheet=[Section("Ozone", "ozone")],
)


@hookimpl
def truing_models() -> list[Model[Monitor, Ozone]]:
    """Offer one calculation: ozone_monitor."""
    return [OZONE_MONITOR]
