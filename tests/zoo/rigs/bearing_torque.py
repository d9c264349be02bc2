"""A roller bearing on a torque bench: load shared among the rollers by iteration, film refilled between two passages.

The viscosity of the oil follows Ubbelohde and Walther from two points of its data sheet (DIN 51563). Each roller rolls
under its own load; each drags the film that the one before it has left.
"""

import numpy as np
from scipy.optimize import brentq

from zoo.zoo import Array, Measured, drawn_size, hideable

HIDDEN = hideable(load_law="bent_load_law", starvation="starvation")
NOISE = 0.02
"""Standard deviation of the torque flange, N m."""
ROLLERS, CONTACT = 16, 10 / 9
"""Rollers, and the exponent of their contact (force over approach)."""
HEAVIEST, FASTEST, THICKEST = 30.0, 3000.0, 150.0
"""Highest load, kN, and speed, rpm; viscosity of the coldest oil at which it is run, mm²/s."""


def viscosity(celsius: Array) -> Array:
    """Kinematic viscosity, mm²/s, of an oil of 100 at 40 °C and 11.1 at 100 °C."""

    def doubled(value: float) -> float:
        return float(np.log10(np.log10(value + 0.8)))

    near, far = np.log10(313.15), np.log10(373.15)
    slope = (doubled(100.0) - doubled(11.1)) / (far - near)
    return np.asarray(10 ** (10 ** (doubled(100.0) - slope * (np.log10(celsius + 273.15) - near))) - 0.8)


def roller_loads(load: float) -> Array:
    """Loads of the rollers, kN, that balance a radial load: no clearance, one roller in the middle of the load zone."""
    angles = 2 * np.pi * np.arange(ROLLERS) / ROLLERS
    pressed = np.maximum(np.cos(angles), 0.0)

    def missing(approach: float) -> float:
        return float(np.sum((approach * pressed) ** CONTACT * np.cos(angles)) - load)

    return np.asarray((brentq(missing, 0.0, 10 * load) * pressed) ** CONTACT)


def film(mobility: float, left: float) -> float:
    """Share of the full film that a roller meets, in the steady state: passages until nothing changes.

    A roller leaves a share ``left`` of the film. The groove g = 1 - film then closes as dg/dt = -g²/tau; ``mobility``
    is the time between two passages over tau.
    """
    thick, before = 1.0, 0.0
    while abs(thick - before) > 1e-10:
        before, groove = thick, 1 - left * thick
        thick = 1 - groove / (1 + groove * mobility)
    return thick


def torque(speed: float, load: float, oil: float, bearing: dict[str, float]) -> float:
    """Torque, N m: every roller against its load, and all of them against the oil."""
    loads, even = roller_loads(load), roller_loads(10.0)
    rolling = np.sum(loads * (np.sum(loads) / np.sum(even)) ** bearing["exponent"]) / np.sum(even)
    dragged = (oil * speed) ** (2 / 3) * 1e-4 * bearing["drag"]
    if bearing["loss"] > 0:
        dragged *= film(1 / (bearing["loss"] * oil * speed), bearing["left"])
    return float(bearing["rolling"] * rolling + dragged)


def bearing_with(hidden: str | None, generator: np.random.Generator) -> dict[str, float]:
    """A bearing: torques in N m at 10 kN, pure numbers; sizes are those at the highest load, or in the thickest oil."""
    bearing = {
        "rolling": 0.0004 * 1e4 * 0.1 * (1 + 0.08 * generator.standard_normal()),
        "drag": 2.0 * (1 + 0.08 * generator.standard_normal()),
        "exponent": 0.0,
        "loss": 0.0,
        "left": generator.uniform(0.0, 0.1),
    }
    if hidden in ("load_law", "load_law_and_starvation"):
        more = drawn_size(generator) * NOISE / (bearing["rolling"] * HEAVIEST / 10)
        bearing["exponent"] = float(np.log(1 + more) / np.log(HEAVIEST / 10))
    if hidden in ("starvation", "load_law_and_starvation"):
        most = (THICKEST * FASTEST) ** (2 / 3) * 1e-4 * bearing["drag"]
        missing = min(drawn_size(generator) * NOISE / most, 0.6)
        bearing["loss"] = missing / (1 - missing) / (THICKEST * FASTEST)
    return bearing


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Measured:
    """A table of operating points, run in no order."""
    bearing = bearing_with(hidden, generator)
    speed = generator.choice([300.0, 750.0, 1500.0, 2200.0, FASTEST], rows) * generator.uniform(0.99, 1.01, rows)
    load = generator.choice([2.0, 5.0, 10.0, 20.0, HEAVIEST], rows) * generator.uniform(0.98, 1.02, rows)
    celsius = generator.uniform(32, 80, rows)
    oil = viscosity(celsius)
    points = zip(speed.tolist(), load.tolist(), oil.tolist(), strict=True)
    columns = {
        "speed [rpm]": speed,
        "load [kN]": load,
        "viscosity [mm^2/s]": oil,
        "oil_temperature [degC]": celsius,
        "torque [N*m]": np.array([torque(*point, bearing) for point in points]),
    }
    return Measured(columns, "torque [N*m]", NOISE, ordered=False)
