"""A plate heat exchanger on a bench, marched cell by cell along the plates from two guesses of its cold outlet.

The films are better where the water is warm, the heat capacity depends on the temperature, and a slipped gasket is an
orifice beside the plates: how much it takes follows from equal losses of pressure.
"""

from dataclasses import dataclass, replace

import numpy as np

from zoo.zoo import Array, Measured, drawn_size, hideable, sized

HIDDEN = hideable(bypass="gasket_bypass", exponent="hot_flow_exponent")
NOISE = 0.12
"""Standard deviation of the thermometer, K."""
MOST = 15.0
"""What an exponent can do at most, in standard deviations of the noise: below 0.05 there is no such film."""
CELLS, ROUNDS = 50, 8
RATED, WALL = 2.0, 180e3
"""Flow of the data sheet, kg/s, and conductance of the plates, W/K."""
WARMER = 0.005
"""Growth of a film per kelvin: the water is thinner and conducts better."""
PLATE_LOSS = 1.75
"""Exponent of the loss of pressure of plates over their flow; that of an orifice is 2."""


@dataclass(frozen=True)
class Plates:
    """Films at 2 kg/s in W/K, exponent of the hot one, and how easily the gasket lets water by (flow at equal loss)."""

    hot_film: float
    cold_film: float
    exponent: float
    gasket: float


@dataclass(frozen=True)
class Points:
    """Operating points: flows in kg/s, temperatures of the inlets in °C; each of shape (rows,)."""

    hot_flow: Array
    cold_flow: Array
    hot_inlet: Array
    cold_inlet: Array


def heat_capacity(celsius: Array) -> Array:
    """Heat capacity of water in J/(kg K), to 0.1 % from 10 °C to 90 °C (a parabola through the steam table)."""
    return np.asarray(4178 + 0.009 * (celsius - 36) ** 2)


def through_plates(flow: Array, gasket: float) -> Array:
    """The part of the hot flow that the plates take, kg/s: bisected until plates and gasket lose as much pressure."""
    low, high = np.zeros(len(flow)), flow.copy()
    for _ in range(60):
        middle = (low + high) / 2
        orifice = gasket * RATED * np.sqrt((middle / RATED) ** PLATE_LOSS)
        too_much = middle + orifice > flow
        low, high = np.where(too_much, low, middle), np.where(too_much, middle, high)
    return np.asarray((low + high) / 2)


def marched(cells: tuple[Array, Array], points: Points, cold_outlet: Array) -> Array:
    """March from where the hot side enters: temperatures of both sides at the edges of all cells, (2, CELLS + 1, rows).

    ``cells`` (CELLS, rows) say by how much a cell cools the hot side, and warms the cold one, per kelvin between them.
    """
    both = np.empty((2, CELLS + 1, len(cold_outlet)))
    both[:, 0] = points.hot_inlet, cold_outlet
    for place, (cooling, warming) in enumerate(zip(*cells, strict=True)):
        between = (both[0, place] - both[1, place]) / (1 + (cooling - warming) / 2)  # in the middle of the cell
        both[:, place + 1] = both[:, place] - np.stack([cooling, warming]) * between
    return both


def conducting(plates: Plates, points: Points, hot_flow: Array, both: Array) -> tuple[Array, Array]:
    """What each cell cools and warms per kelvin, with the water as it is at these temperatures."""
    hot, cold = (both[:, :-1] + both[:, 1:]) / 2
    hot_film = plates.hot_film * (hot_flow / RATED) ** plates.exponent * (1 + WARMER * (hot - 60))
    cold_film = plates.cold_film * (points.cold_flow / RATED) ** 0.7 * (1 + WARMER * (cold - 35))
    cell = 1 / (1 / hot_film + 1 / cold_film + 1 / WALL) / CELLS
    return cell / (hot_flow * heat_capacity(hot)), cell / (points.cold_flow * heat_capacity(cold))


def outlet(plates: Plates, points: Points) -> Array:
    """Temperature of the hot side where it leaves, °C: two shots are mixed until they meet the cold inlet."""
    hot_flow = through_plates(points.hot_flow, plates.gasket)
    both = np.stack([np.full((CELLS + 1, len(hot_flow)), level) for level in (60.0, 35.0)])
    for _ in range(ROUNDS):
        cells = conducting(plates, points, hot_flow, both)
        low, high = (marched(cells, points, shot) for shot in (points.cold_inlet, points.hot_inlet))
        share = (points.cold_inlet - low[1, -1]) / (high[1, -1] - low[1, -1])
        both = low + share * (high - low)
    past = 1 - hot_flow / points.hot_flow
    return np.asarray(past * points.hot_inlet + (1 - past) * both[0, -1])


def programme(generator: np.random.Generator, rows: int) -> Points:
    """A table of operating points in no order: five hot flows against any cold flow, inlets as the boiler held them."""
    hot_flow = generator.choice([0.8, 1.3, 2.0, 3.0, 4.5], rows) * generator.normal(1, 0.02, rows)
    cold_flow = generator.uniform(0.8, 4.0, rows)
    return Points(hot_flow, cold_flow, generator.normal(75, 1.5, rows), generator.normal(20, 1.5, rows))


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Measured:
    """A table of operating points in the steady state: what the thermometer would show without noise."""
    hot_film, cold_film = (np.array([60e3, 50e3]) * generator.normal(1, 0.04, 2)).tolist()
    points = programme(generator, rows)
    sound = Plates(hot_film, cold_film, 0.7, 0.0)
    plain = outlet(sound, points)
    gasket, exponent = 0.0, 0.7
    if hidden in ("bypass", "bypass_and_exponent"):
        size = drawn_size(generator) * NOISE
        gasket = sized(lambda open_: outlet(replace(sound, gasket=open_), points), plain, size, 0.8, rtol=1e-2)
    if hidden in ("exponent", "bypass_and_exponent"):
        size = min(drawn_size(generator), MOST) * NOISE

        def bent(to: float) -> Array:
            return outlet(replace(sound, exponent=to), points)

        exponent = sized(bent, plain, size, 0.7, low=0.05, rtol=1e-2)
    columns = {
        "hot_flow [kg/s]": points.hot_flow,
        "cold_flow [kg/s]": points.cold_flow,
        "hot_inlet [degC]": points.hot_inlet,
        "cold_inlet [degC]": points.cold_inlet,
        "hot_outlet [degC]": outlet(Plates(hot_film, cold_film, exponent, gasket), points),
    }
    return Measured(columns, "hot_outlet [degC]", NOISE, ordered=False)
