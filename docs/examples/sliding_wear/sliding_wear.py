"""How deep does a metal wear while it slides under a load?"""

from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    results,
)


@inputs
class Specimen:
    """A specimen on the wear bench; what Archard leaves out is neutral as declared."""

    load: Float = given(50.0, "gf", symbol="F", note="normal load", above=0)
    cycles: Float = given(100.0, "", symbol="n", note="strokes so far", above=0)
    rate: Float = given(3e-3, "um/gf", symbol="k", note="wear per load and cycle, at load F_0 and after n_0", above=0)
    usual_load: Float = given(50.0, "gf", symbol="F_0", note="load at which k was estimated", above=0)
    usual_cycles: Float = given(100.0, "", symbol="n_0", note="cycles after which k was estimated", above=0)
    slowed: Float = given(0.0, "", symbol="s", note="by how much the exponent of the cycles is below 1")
    shared: Float = given(0.0, "", symbol="q", note="by how much the exponent of the load is below 1")
    widened: Float = given(0.0, "", symbol="p", note="by how much a reading of the scar grows slower than its volume")
    idle_load: Float = given(0.0, "gf", symbol="F_1", note="load below which nothing wears")
    smoothed: Float = given(0.0, "um", symbol="h_1", note="depth that fresh asperities lose")
    smooth_after: Float = given(20.0, "", symbol="n_1", note="cycles after which they have lost two thirds", above=0)
    choking: Float = given(0.0, "1/um", symbol="g", note="inverse of the depth at which debris stops the wear")


@results
class Wear:
    """What is gone."""

    wear: Float = found(
        "um", symbol="h", note="what the bench reads",
        formula="smoothed * (1 - exp(-cycles / smooth_after)) + 1 / (choking + 1 / (rate * usual_load * usual_cycles"
        " * (((load - idle_load) / (usual_load - idle_load))**(1 - shared)"
        " * (cycles / usual_cycles)**(1 - slowed))**(1 - widened)))",
    )  # fmt: skip
    log_wear: Float = found("", symbol="L", note="logarithm of it, in um", numeric=True, formula="log10(wear)")


def sliding_wear(specimen: Specimen) -> Wear:
    """Archard's law, linear in load and cycles, until an effect says otherwise. Shapes (n,) or numbers."""
    lowest = np.minimum(specimen.load, specimen.usual_load)
    feasible(lowest > specimen.idle_load, "nothing wears: the load is below the one that wears")
    pressed = (specimen.load - specimen.idle_load) / (specimen.usual_load - specimen.idle_load)
    lasted = specimen.cycles / specimen.usual_cycles
    harshness = pressed ** (1 - specimen.shared) * lasted ** (1 - specimen.slowed)
    steady = specimen.rate * specimen.usual_load * specimen.usual_cycles * harshness ** (1 - specimen.widened)
    smoothed = specimen.smoothed * (1 - np.exp(-specimen.cycles / specimen.smooth_after))
    wear = smoothed + 1 / (specimen.choking + 1 / steady)
    return Wear(wear=wear, log_wear=np.log10(wear / 1e-6))


def slowing_rate(specimen: Specimen, *, exponent: Float) -> Specimen:
    """The surface hardens and conforms: wear grows as a power of the cycles below 1."""
    return replace(specimen, slowed=specimen.slowed + exponent)


def load_sharing(specimen: Specimen, *, exponent: Float) -> Specimen:
    """More load spreads over more contact: wear grows as a power of the load below 1."""
    return replace(specimen, shared=specimen.shared + exponent)


def scar_geometry(specimen: Specimen, *, exponent: Float) -> Specimen:
    """The bench reads a width, and Archard's law speaks of a volume: a power of it below 1."""
    return replace(specimen, widened=specimen.widened + exponent)


def idle_load(specimen: Specimen, *, load: Float) -> Specimen:
    """Oxide carries a part of the load without wear."""
    return replace(specimen, idle_load=specimen.idle_load + load)


def smoothing(specimen: Specimen, *, depth: Float, after: Float) -> Specimen:
    """Fresh asperities go first: a depth that is lost early, whatever the load."""
    at = np.where(np.equal(depth, 0), specimen.smooth_after, after)
    return replace(specimen, smoothed=specimen.smoothed + depth, smooth_after=at)


def debris(specimen: Specimen, *, choking: Float) -> Specimen:
    """Wear debris fills the scar and stops it at some depth."""
    return replace(specimen, choking=specimen.choking + choking)


SLIDING_WEAR = Model(
    name="sliding_wear",
    title="Sliding wear of a metal",
    function=sliding_wear,
    cites=["J. F. Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981"],
    errors=[
        Tolerance("rate", lognormal(sd="50 %"), why="wear rates of one pair differ by such a factor between benches"),
        Effect(
            "slowing_rate",
            on_inputs=slowing_rate,
            looks_like="steep at first, flatter and flatter, never level",
            unknowns=[Unknown("exponent", 0, 0.95)],
        ),
        Effect(
            "load_sharing",
            on_inputs=load_sharing,
            looks_like="heavy loads wear less than in proportion",
            unknowns=[Unknown("exponent", 0, 0.95)],
        ),
        Effect(
            "scar_geometry",
            on_inputs=scar_geometry,
            looks_like="load and cycles enter with one power, below 1",
            unknowns=[Unknown("exponent", 0, 0.95, "", note="a half to two thirds for the width of a groove")],
        ),
        Effect(
            "idle_load",
            on_inputs=idle_load,
            looks_like="light loads wear less than in proportion",
            unknowns=[Unknown("load", 0, 9.5, "gf")],
        ),
        Effect(
            "smoothing",
            on_inputs=smoothing,
            looks_like="an early loss, complete after a few of its lengths",
            unknowns=[
                Unknown("depth", 0, 30, "um"),
                Unknown("after", 1, 300, "", note="cycles after which two thirds of it are gone"),
            ],
        ),
        Effect(
            "debris",
            on_inputs=debris,
            looks_like="levels off at one depth, whatever the load",
            unknowns=[Unknown("choking", 0, 1, "1/um")],
        ),
    ],
    sheet=[Section("Wear", "wear", "log_wear")],
)


@hookimpl
def truing_models() -> list[Model[Specimen, Wear]]:
    """Offer one calculation: sliding_wear."""
    return [SLIDING_WEAR]
