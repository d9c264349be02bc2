"""The pin with one mistake per marked line: each must be caught by the type checker before anything runs."""

from dataclasses import replace

from pin_wear import Pin, Wear, running_in, wear

from truing import Effect, Float, Model, Unknown, found, given, inputs, results


@inputs
class Disc:
    """Inputs of another calculation."""

    radius: Float = given(0.1, "m")


@results
class Turn:
    """Results of another calculation."""

    arc: Float = found("m")


def turn(disc: Disc) -> Turn:
    """Half a turn."""
    return Turn(arc=3.14159 * disc.radius)


def wobble(disc: Disc, *, extra: Float) -> Disc:
    """An effect on the disc."""
    return replace(disc, radius=disc.radius + extra)


def drifting(disc: Disc, base: Turn, *, extra: Float) -> Turn:
    """A gauge on the disc."""
    return replace(base, arc=base.arc + extra)


def misspelt(pin: Pin) -> Wear:
    """A misspelt input, a misspelt result, a forgotten result, a text."""
    pressure = pin.laod / pin.area  # WRONG: no such input
    Wear(pressure=pressure, distance=1.0, dept=1.0)  # WRONG: no such result
    Wear(pressure=pressure, distance=1.0)  # WRONG: depth is forgotten
    return Wear(pressure=pressure, distance=1.0, depth="3 um")  # WRONG: a text where a number belongs


def frozen(pin: Pin) -> None:
    """Inputs are not written to, and take no text."""
    pin.load = 3.0  # WRONG: frozen
    Pin(load="3 kN")  # WRONG: a text where a number belongs
    Pin(3.0)  # WRONG: by keyword only
    Pin(lod=3.0)  # WRONG: no such input


AMPLITUDE = [Unknown("extra", 0, 1, "mm")]
Unknown("extra", "0", 1)  # WRONG: a text where a number belongs

of_disc: Model[Disc, Turn] = Model(
    name="disc",
    title="",
    function=turn,
    errors=[
        Effect("running_in", on_inputs=running_in, unknowns=AMPLITUDE),  # WRONG: an effect of another model
    ],
)
of_pin = Model(
    name="pin",
    title="",
    function=wear,  # WRONG: beside an effect of another model
    errors=[
        Effect("wobble", on_inputs=wobble, unknowns=AMPLITUDE),
    ],
)
of_pin_again = Model(
    name="pin",
    title="",
    function=wear,  # WRONG: beside a reading of another model
    errors=[
        Effect("drifting", on_reading=drifting, unknowns=AMPLITUDE),
    ],
)
swapped: Model[Pin, Turn] = Model(name="pin", title="", function=wear)  # WRONG: results of another model
