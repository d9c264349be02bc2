"""An open wet clutch turns in oil: how much torque does it drag along? Every gap is full of oil."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, feasible, found, given, inputs, normal, results
from zoo.zoo import acting

TWO_PI = 6.283185307179586
SPEED, WARM, FEED = 1000.0 / 60, 333.15, 5e-3 / 60
"""Where the demand for oil is stated: 1000 rpm in 1/s, 60 °C in K, 5 l/min in m³/s."""


@inputs
class Clutch:
    """The plates, the oil, and how the clutch is run."""

    speed: Float = given(1000.0, "rpm", symbol="n", note="speed of the inner plates; the outer ones stand", at_least=0)
    oil_temperature: Float = given(60.0, "degC", symbol="theta", note="temperature of the oil that is fed")
    feed: Float = given(5.0, "l/min", symbol="Q", note="oil that is fed", above=0)
    gap: Float = given(0.25, "mm", symbol="h", note="mean gap between two plates", above=0)
    gaps: Float = given(10.0, "", symbol="z", note="number of gaps", above=0)
    inner_radius: Float = given(60.0, "mm", symbol="r_i", note="of the lining", above=0)
    outer_radius: Float = given(80.0, "mm", symbol="r_o", note="of the lining", above=0)
    viscosity_40: Float = given(30.0, "mm^2/s", symbol="nu_40", note="at 40 °C", source="data sheet", above=0)
    viscosity_100: Float = given(6.0, "mm^2/s", symbol="nu_100", note="at 100 °C", source="data sheet", above=0)
    density: Float = given(840.0, "kg/m^3", symbol="rho", note="density of the oil", above=0)
    film_rise: Float = given(0.0, "K", symbol="d_theta", note="by how much the film is warmer than the oil fed")
    demand: Float = given(0.0, "", symbol="D", note="oil needed over oil fed at 1000 rpm, 60 °C, 5 l/min", at_least=0)
    contact: Float = given(0.0, "N*m", symbol="T_c", note="torque of plates that touch")
    churned: Float = given(0.0, "N*m", symbol="T_w", note="torque of oil that is stirred")
    thinning: Float = given(0.0, "us", symbol="lambda", note="time constant of thinning by shear", at_least=0)
    swelling: Float = given(0.0, "1/K", symbol="w", note="share of the gap that swollen linings take per kelvin")


@results
class Drag:
    """What the torque meter shows."""

    viscosity: Float = found("mPa*s", symbol="eta", note="viscosity of the film", method="Walther, ASTM D341")
    shear_rate: Float = found("1/s", symbol="gamma", note="at the mean radius", method="speed over gap")
    drag_torque: Float = found("N*m", symbol="T", note="drag torque", method="integral of the shear over the lining")


def kinematic_viscosity(clutch: Clutch, temperature: Float) -> Float:
    """Walther's straight line through the two points of the data sheet, in m²/s; temperature in K."""
    ends = [np.log10(np.log10(1e6 * value + 0.7)) for value in (clutch.viscosity_40, clutch.viscosity_100)]
    cold, hot = np.log10(313.15), np.log10(373.15)
    height = ends[0] + (ends[1] - ends[0]) * (np.log10(temperature) - cold) / (hot - cold)
    return np.asarray(1e-6 * (10 ** (10**height) - 0.7)) if np.ndim(height) else 1e-6 * float(10 ** (10**height) - 0.7)


def clutch_drag(clutch: Clutch) -> Drag:
    """Laminar shear of parallel plates, radius by radius; where oil is short the film covers a share of the circle."""
    film = clutch.oil_temperature + clutch.film_rise
    feasible((film > 250) & (film < 450), "the oil is colder than -23 °C or hotter than 177 °C")
    gap = clutch.gap * (1 - clutch.swelling * (clutch.oil_temperature - WARM))
    feasible(gap > 0, "the linings swell until no gap is left")
    feasible(clutch.outer_radius > clutch.inner_radius, "the lining has no width")
    turning = TWO_PI * clutch.speed
    shear_rate = turning * (clutch.inner_radius + clutch.outer_radius) / 2 / gap
    viscosity = clutch.density * kinematic_viscosity(clutch, film) / (1 + clutch.thinning * shear_rate)
    at_reference = clutch.density * kinematic_viscosity(clutch, WARM)
    outer, inner = clutch.outer_radius, clutch.inner_radius
    need = clutch.demand * (clutch.speed / SPEED) ** 2 * at_reference / viscosity * FEED / clutch.feed
    edge = np.clip(outer / np.sqrt(np.maximum(need, 1e-6)), inner, outer)
    covered = (edge**4 - inner**4) / 4 + outer**2 / np.maximum(need, 1e-6) * (outer**2 - edge**2) / 2
    sheared = clutch.gaps * TWO_PI * viscosity * turning / gap * covered
    return Drag(viscosity=viscosity, shear_rate=shear_rate, drag_torque=sheared + clutch.contact + clutch.churned)


TIME = Condition("time", "s", derived="since_start", note="since the test began")


def film_rupture(clutch: Clutch, *, demand: Float) -> Clutch:
    """Centrifugal force throws out more oil than is fed: from some speed on the film breaks up, from outside."""
    return replace(clutch, demand=clutch.demand + demand)


def gap_warming(clutch: Clutch, *, rise: Float, time_constant: Float, time: Float) -> Clutch:
    """Plates and housing warm up: the film becomes warmer than the oil that is fed."""
    return replace(clutch, film_rise=clutch.film_rise + rise * (1 - np.exp(-time / time_constant)))


def plate_contact(clutch: Clutch, *, torque: Float, fading: Float) -> Clutch:
    """Plates that are not flat touch while they turn slowly; the film parts them with speed."""
    return replace(clutch, contact=clutch.contact + torque * np.exp(-clutch.speed / fading))


def churning(clutch: Clutch, *, torque: Float) -> Clutch:
    """The hub stirs oil that does not run off, as the square of speed; the unknown is that at 1000 rpm."""
    return replace(clutch, churned=clutch.churned + torque * (clutch.speed / SPEED) ** 2)


def shear_thinning(clutch: Clutch, *, time_constant: Float) -> Clutch:
    """The additives that thicken the oil lie down in the shear."""
    return replace(clutch, thinning=clutch.thinning + time_constant)


def lining_swell(clutch: Clutch, *, swelling: Float) -> Clutch:
    """Paper linings swell in hot oil, so the gap becomes smaller."""
    return replace(clutch, swelling=clutch.swelling + swelling)


CLUTCH_DRAG = Model(
    name="clutch_drag",
    title="Drag of an open wet clutch",
    function=clutch_drag,
    errors=[
        Tolerance("gap", normal(sd="3 %"), why="stack of plates, measured with feelers"),
        Tolerance("viscosity_40", normal(sd="2 %"), why="batch of oil"),
        acting(film_rupture, Unknown("demand", 0, 5, "", note="oil needed over oil fed at 1000 rpm, 60 °C, 5 l/min")),
        acting(gap_warming, Unknown("rise", -10, 60, "K"), Unknown("time_constant", 60, 3600, "s"), needs=[TIME]),
        acting(plate_contact, Unknown("torque", 0, 5, "N*m"), Unknown("fading", 20, 1000, "rpm")),
        acting(churning, Unknown("torque", 0, 2, "N*m", note="at 1000 rpm")),
        acting(shear_thinning, Unknown("time_constant", 0, 50, "us")),
        acting(lining_swell, Unknown("swelling", -0.01, 0.01, "1/K")),
    ],
)
