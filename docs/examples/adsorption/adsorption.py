"""How much gas does a powder take up at a pressure?"""

from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    results,
)


@inputs
class Powder:
    """A powder in a gas; what Henry's law leaves out is neutral as declared."""

    pressure: Float = given(400.0, "", symbol="p", note="pressure, in units of the source", at_least=0)
    uptake: Float = given(0.13, "", symbol="k", note="volume per pressure at low pressure", above=0)
    equal: Float = given(0.0, "", symbol="b_A", note="rate at which equal places run out, per pressure", at_least=0)
    unequal: Float = given(0.0, "", symbol="b_B", note="the same of places that differ a little", at_least=0)
    sites: Float = given(
        0.0, "", symbol="b_D", note="inverse pressure at which half of the places are taken", at_least=0
    )
    wide: Float = given(0.0, "", symbol="b_C", note="rate of places that differ widely, per pressure", at_least=0)
    layers: Float = given(0.0, "", symbol="b_L", note="further layers, per pressure", at_least=0)


@results
class Uptake:
    """What the powder holds."""

    volume: Float = found(
        "", symbol="V", note="volume of gas, in units of the source",
        method="k p, times what is left of the places on average",
        source="NIST StRD, Misra1a to Misra1d",
    )  # fmt: skip


def adsorption(powder: Powder) -> Uptake:
    """Henry's law, volume in proportion to pressure, until an effect says otherwise. Shapes (n,) or numbers.

    With b the rate at which places run out and z = b p the volume is k p times

    - equal places: (1 - exp(-z)) / z;
    - places whose rates have a gamma distribution of shape 2, 1 and 1/2, and the mean b: (1 - (1 + z/2)^-2) / z,
      1 / (1 + z), which is Langmuir's law, and (1 - (1 + 2z)^-1/2) / z, each written so that z may be 0.
    """
    half = powder.unequal * powder.pressure / 2
    root = np.sqrt(1 + 2 * powder.wide * powder.pressure)
    left = filled_evenly(powder.equal * powder.pressure) * (1 + half / 2) / (1 + half) ** 2
    left = left / (1 + powder.sites * powder.pressure) * 2 / (root * (root + 1))
    volume = powder.uptake * powder.pressure * left * (1 + powder.layers * powder.pressure)
    return Uptake(volume=volume)


def filled_evenly(z: Float) -> Float:
    """Return (1 - exp(-z)) / z, and 1 at z = 0."""
    safe = np.where(np.equal(z, 0), 1.0, z)
    return np.where(np.equal(z, 0), 1.0, -np.expm1(-safe) / safe)


def equal_places(powder: Powder, *, rate: Float) -> Powder:
    """Each place takes one molecule, all at the same rate: an exponential."""
    return replace(powder, equal=powder.equal + rate)


def unequal_places(powder: Powder, *, rate: Float) -> Powder:
    """Each place takes one molecule; some are taken sooner than others."""
    return replace(powder, unequal=powder.unequal + rate)


def langmuir(powder: Powder, *, rate: Float) -> Powder:
    """Each place takes one molecule; coming and going are in balance (Langmuir)."""
    return replace(powder, sites=powder.sites + rate)


def widely_unequal_places(powder: Powder, *, rate: Float) -> Powder:
    """Each place takes one molecule; a few are taken at once, some hardly ever."""
    return replace(powder, wide=powder.wide + rate)


def further_layers(powder: Powder, *, rate: Float) -> Powder:
    """Molecules settle on molecules: more is taken up at high pressure."""
    return replace(powder, layers=powder.layers + rate)


ADSORPTION = Model(
    name="adsorption",
    title="Adsorption of a gas",
    function=adsorption,
    cites=["I. Langmuir, The adsorption of gases on plane surfaces, J. Am. Chem. Soc. 40 (1918) 1361"],
    errors=[
        Tolerance("uptake", lognormal(sd="30 %"), why="from batch to batch of the powder"),
        Effect(
            "equal_places",
            on_inputs=equal_places,
            looks_like="bends, and is full soon",
            unknowns=[Unknown("rate", 0, 5e-3, "", note="per pressure")],
        ),
        Effect(
            "unequal_places",
            on_inputs=unequal_places,
            looks_like="bends, and is full later",
            unknowns=[Unknown("rate", 0, 5e-3, "", note="per pressure")],
        ),
        Effect(
            "langmuir",
            on_inputs=langmuir,
            looks_like="bends, and is full late",
            unknowns=[Unknown("rate", 0, 5e-3, "", note="per pressure")],
        ),
        Effect(
            "widely_unequal_places",
            on_inputs=widely_unequal_places,
            looks_like="bends, and is hardly ever full",
            unknowns=[Unknown("rate", 0, 5e-3, "", note="per pressure")],
        ),
        Effect(
            "further_layers",
            on_inputs=further_layers,
            looks_like="bends upward",
            unknowns=[Unknown("rate", 0, 5e-3, "", note="per pressure")],
        ),
    ],
    sheet=[Section("Uptake", "volume")],
)


@hookimpl
def truing_models() -> list[Model[Powder, Uptake]]:
    """Offer one calculation: adsorption."""
    return [ADSORPTION]
