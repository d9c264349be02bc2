"""A bar of copper grows with temperature: by a constant coefficient, as drawings assume, or as the metal does."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Published,
    Require,
    Section,
    Tolerance,
    Unknown,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    normal,
    results,
)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)


@inputs
class Bar:
    """What is on the drawing, and what a constant coefficient leaves out (neutral as declared)."""

    temperature: Float = given(293.15, "K", symbol="T", note="temperature of the bar", above=0, at_most=1300)
    room: Float = given(293.15, "K", symbol="T_0", note="room temperature", at_least=200, at_most=400)
    length: Float = given(1.0, "m", symbol="L", note="length at room temperature", above=0)
    coefficient: Float = given(
        16.5, "um/(m*K)", symbol="alpha_0", note="coefficient at room temperature", source="handbook", above=0
    )
    permitted_growth: Float = given(5.0, "mm", symbol="d_p", note="growth that the seat of the bar allows", above=0)
    frozen_share: Float = given(0.0, "", symbol="s", note="share of the lattice whose vibrations freeze as Debye says")
    debye_temperature: Float = given(343.0, "K", symbol="theta", note="Debye temperature", above=0)
    one_note_share: Float = given(0.0, "", symbol="r", note="share that freezes as if it had one frequency")
    einstein_temperature: Float = given(240.0, "K", symbol="theta_E", note="of that frequency", above=0)
    softening: Float = given(0.0, "1/K", symbol="k", note="how the bonds give as the lattice warms")
    electrons: Float = given(0.0, "1/K", symbol="g", note="heat capacity of the electrons per kelvin, in parts of 3R")
    temperature_error: Float = given(0.0, "K", symbol="e", note="by how much the bar is warmer than was read")


@results
class Growth:
    """How much the bar grows, and how fast."""

    energy: Float = found("K", symbol="E", note="heat in the metal over 3R", method="Debye, Einstein, electrons; exact")
    capacity: Float = found("", symbol="C", note="heat capacity over 3R, 1 after Dulong and Petit", method="dE/dT")
    expansion_coefficient: Float = found(
        "um/(m*K)", symbol="alpha", note="coefficient of expansion at this temperature",
        method="Grueneisen: as the heat capacity, over (1 - kE) squared",
    )  # fmt: skip
    growth: Float = found("mm", symbol="d", note="growth since room temperature", method="its integral, exact")


def copper_expansion(bar: Bar) -> Growth:
    """Grueneisen's theory of a solid; with nothing on it is a constant coefficient. 10 K to 1300 K."""
    warm = bar.temperature + bar.temperature_error
    feasible(warm > 0, "the bar would be below absolute zero")
    energy, capacity = heat(bar, warm)
    energy_then, capacity_then = heat(bar, bar.room)
    feasible(np.maximum(energy, energy_then) * bar.softening < 1, "the lattice comes apart: k times E reaches 1")
    scale = bar.coefficient * (1 - bar.softening * energy_then) ** 2 / capacity_then
    stretch = energy / (1 - bar.softening * energy) - energy_then / (1 - bar.softening * energy_then)
    return Growth(
        energy=energy,
        capacity=capacity,
        expansion_coefficient=scale * capacity / (1 - bar.softening * energy) ** 2,
        growth=bar.length * scale * stretch,
    )


def heat(bar: Bar, temperature: Float) -> tuple[Float, Float]:
    """Return the heat in the metal (K) and its derivative, both in parts of 3R."""
    debye_energy, debye_capacity = debye(bar.debye_temperature / temperature)
    einstein_energy, einstein_capacity = einstein(bar.einstein_temperature / temperature)
    free = 1 - bar.frozen_share - bar.one_note_share
    energy = temperature * (free + bar.frozen_share * debye_energy + bar.one_note_share * einstein_energy)
    capacity = free + bar.frozen_share * debye_capacity + bar.one_note_share * einstein_capacity
    electrons = bar.electrons * temperature
    return energy + electrons * temperature / 2, capacity + electrons


def debye(u: Float) -> tuple[Float, Float]:
    """Return energy over 3RT and heat capacity over 3R of a Debye solid at T = theta/u, to 1e-9.

    P. Debye, Ann. Phys. 344 (1912) 789: D(u) = 3/u^3 * integral from 0 to u of x^3/(e^x - 1).
    """
    far = np.minimum(u, 60.0)  # beyond it the integrand is below 1e-20
    few, row = np.unique(far, return_inverse=True)  # a batch holds the same temperatures many times
    x = np.expand_dims(few, -1) * (NODES + 1) / 2
    integral = far * np.sum(x**3 / np.expm1(x) * WEIGHTS, axis=-1)[row].reshape(np.shape(far)) / 2
    energy = 3 * integral / u**3
    return energy, 4 * energy - 3 * far / np.expm1(far)


def einstein(u: Float) -> tuple[Float, Float]:
    """Return energy over 3RT and heat capacity over 3R of oscillators of one frequency."""
    near = np.minimum(u, 300.0)
    return near / np.expm1(near), near**2 * np.exp(-near) / np.expm1(-near) ** 2


def lattice_freezing(bar: Bar, *, share: Float, debye: Float) -> Bar:
    """Vibrations freeze below the Debye temperature, and with them the expansion."""
    at = np.where(np.equal(share, 0), bar.debye_temperature, debye)
    return replace(bar, frozen_share=bar.frozen_share + share, debye_temperature=at)


def one_frequency(bar: Bar, *, share: Float, einstein: Float) -> Bar:
    """All atoms vibrate at one frequency: freezes too, but faster at the bottom."""
    at = np.where(np.equal(share, 0), bar.einstein_temperature, einstein)
    return replace(bar, one_note_share=bar.one_note_share + share, einstein_temperature=at)


def anharmonic_rise(bar: Bar, *, softening: Float) -> Bar:
    """Bonds that are stretched give more easily: the coefficient rises on and on."""
    return replace(bar, softening=bar.softening + softening)


def free_electrons(bar: Bar, *, capacity: Float) -> Bar:
    """The electrons take up heat in proportion to temperature, and push."""
    return replace(bar, electrons=bar.electrons + capacity)


def thermocouple_offset(bar: Bar, *, offset: Float) -> Bar:
    """The bar is warmer than its thermocouple by the same amount everywhere."""
    return replace(bar, temperature_error=bar.temperature_error + offset)


def thermocouple_gain(bar: Bar, *, gain: Float) -> Bar:
    """The bar is off room temperature by more than its thermocouple says, in proportion."""
    return replace(bar, temperature_error=bar.temperature_error + gain * (bar.temperature - bar.room))


def effect(function: Callable[..., Bar], *unknowns: Unknown, looks_like: str, source: str = "") -> Effect[Bar, Growth]:
    """Declare an effect on the inputs under the name of its function."""
    return Effect(
        function.__name__, on_inputs=function, unknowns=list(unknowns), looks_like=looks_like, source=source,
        why=str(function.__doc__).splitlines()[0].rstrip("."),
    )  # fmt: skip


AS_FOUND = {
    "coefficient": "16.6 um/(m*K)",
    "frozen_share": "1",
    "debye_temperature": "322.5 K",
    "softening": "1.46e-4 1/K",
}
"""The model as the coefficients measured by Hahn make it; the table below was measured on other bars."""

TABLE = [(4.0, -3.24), (40.0, -3.22), (77.0, -3.02), (100.0, -2.82), (150.0, -2.21), (200.0, -1.48), (250.0, -0.70)]

BESIDE = 77.0
CONTRACTION = [
    Published(
        name=f"contraction from room temperature to {temperature:g} K",
        result="growth",
        value=growth,
        unit="mm",
        where="Ekin, appendix A6.4",
        settings={**AS_FOUND, "temperature": f"{temperature:g} K"},
        obtained="calibrated",
        verdict="differs" if temperature == BESIDE else "matches",
        why="three numbers are fitted to seven, so it differs" if temperature == BESIDE else "",
    )
    for temperature, growth in TABLE
]

COPPER_EXPANSION = Model(
    name="copper_expansion",
    title="Thermal growth of a copper bar",
    function=copper_expansion,
    published=CONTRACTION,
    cites=[
        "E. Grueneisen, Theorie des festen Zustandes einatomiger Elemente, Ann. Phys. 344 (1912) 257",
        "F. C. Nix, D. MacNair, The thermal expansion of pure metals: copper, gold, aluminum, nickel, and iron, "
        "Phys. Rev. 60 (1941) 597",
        "J. W. Ekin, Experimental Techniques for Low-Temperature Measurements, Oxford University Press 2006",
        "T. A. Hahn, Thermal expansion of copper from 20 to 800 K, J. Appl. Phys. 41 (1970) 5096",
    ],
    errors=[
        Tolerance("coefficient", normal(sd="1 %"), why="handbooks print 16.5 to 16.8 um/(m*K)"),
        effect(
            lattice_freezing,
            Unknown("share", 0, 2, "", note="1: the whole expansion freezes"),
            Unknown("debye", 100, 1000, "K", note="Debye temperature; copper about 315 to 343 K"),
            looks_like="falls to zero towards the cold, as T cubed at the bottom",
        ),
        effect(
            one_frequency,
            Unknown("share", 0, 2),
            Unknown("einstein", 50, 800, "K", note="temperature of the frequency"),
            looks_like="falls to zero towards the cold, exponentially at the bottom",
        ),
        effect(
            anharmonic_rise, Unknown("softening", 0, 5e-4, "1/K"), looks_like="rises steadily, up to the hottest row"
        ),
        effect(
            free_electrons,
            Unknown("capacity", 0, 1e-3, "1/K", note="copper 2.8e-5 1/K"),
            looks_like="rises in proportion to temperature from absolute zero",
        ),
        effect(thermocouple_offset, Unknown("offset", -20, 20, "K"), looks_like="the whole curve lies to one side"),
        effect(
            thermocouple_gain, Unknown("gain", -0.1, 0.1), looks_like="the curve is stretched about room temperature"
        ),
    ],
    objectives=[Require("growth", at_most="permitted_growth")],
    sheet=[Section("Heat", "energy", "capacity"), Section("Growth", "expansion_coefficient", "growth")],
)


@hookimpl
def truing_models() -> list[Model[Bar, Growth]]:
    """Offer one calculation: copper_expansion."""
    return [COPPER_EXPANSION]
