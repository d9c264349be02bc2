"""A spindle on a test stand: a rod of twelve cells with heat at its bearings, in a housing of eight cells.

Heat flows along both, from the bearings into the housing, and off into the air, step by step. The probe stands on the
housing. The air takes a little more heat from what is hotter (natural convection).
"""

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable

HIDDEN = hideable(housing="housing_growth", churning="churning")
NOISE = 0.5
"""Standard deviation of the probe, um."""
CELLS, HOUSING_CELLS, STEP = 12, 8, 2.0
"""Cells of spindle and housing; step of the calculation, s."""
ALONG = 0.02
"""Heat that flows between neighbouring cells, over what a cell holds, 1/s."""
LENGTH, EXPANSION, FASTEST = 0.3, 11.5e-6, 6000.0
"""Length of the spindle, m, its expansion, 1/K, and its highest speed, rpm."""


def along(cells: Array) -> Array:
    """Rise of every cell by what flows along the rod, K/s."""
    flow = ALONG * np.diff(cells)
    return np.asarray(np.append(flow, 0.0) - np.append(0.0, flow))


def warmed(heating: Array, spindle: dict[str, float]) -> tuple[Array, Array]:
    """Mean rise of spindle and housing, K, at every step: heat in K/s of the mean, at both bearings."""
    rod, housing = np.zeros(CELLS), np.zeros(HOUSING_CELLS)
    share = np.zeros(CELLS)
    share[[2, 3, 8]] = CELLS / 3
    rises, lags = np.empty(len(heating)), np.empty(len(heating))
    for place, heat in enumerate(heating.tolist()):
        rises[place], lags[place] = np.mean(rod), np.mean(housing)
        lost = rod / spindle["constant"] * (1 + 0.0002 * np.abs(rod))
        rod = rod + STEP * (along(rod) + heat * share - lost)
        into = (np.mean(rod[2:9]) - housing) / spindle["housing_constant"]
        housing = housing + STEP * (along(housing) + into)
    return rises, lags


def programme(generator: np.random.Generator, rows: int) -> tuple[Array, Array, Array]:
    """Times in min, speeds in rpm that hold until the next, rise of the hall in K: stages of twenty minutes or so."""
    times = 2.0 * np.arange(rows, dtype=np.float64)
    stages = generator.choice([0.0, 1500.0, 3000.0, 4500.0, FASTEST], rows // 10 + 1)
    stages[:2] = (3000.0, FASTEST)
    hall = 2 * np.sin(2 * np.pi * times / 400 + generator.uniform(0, 6))
    return times, np.repeat(stages, 10)[:rows], np.asarray(hall - hall[0])


def grown(times: Array, speeds: Array, spindle: dict[str, float]) -> tuple[Array, Array]:
    """Growth of the spindle and of the housing at every reading, um."""
    steps = np.arange(0.0, 60 * times[-1] + STEP, STEP)
    held = speeds[np.minimum((steps / 60 / (times[1] - times[0])).astype(int), len(speeds) - 1)]
    heating = spindle["rise"] * (held / 3000) ** spindle["exponent"] / spindle["constant"]
    rises, lags = warmed(heating, spindle)
    per_kelvin = 1e6 * LENGTH * EXPANSION
    at = 60 * times
    return np.interp(at, steps, rises) * per_kelvin, np.interp(at, steps, lags) * per_kelvin


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """Five hours on the stand, a reading every two minutes; sizes are those at the largest place of the record."""
    spindle = {
        "rise": 18.0 * (1 + 0.08 * generator.standard_normal()),
        "constant": 60 * 25.0 * (1 + 0.06 * generator.standard_normal()),
        "housing_constant": 60 * generator.uniform(60.0, 150.0),
        "exponent": 1.0,
    }
    times, speeds, hall = programme(generator, rows)
    if hidden in ("churning", "housing_and_churning"):
        most = np.max(grown(times, speeds, spindle)[0])
        more = drawn_size(generator) * NOISE / most
        spindle["exponent"] = 1 + float(np.log(1 + more) / np.log(FASTEST / 3000))
    growth, housing = grown(times, speeds, spindle)
    if hidden in ("housing", "housing_and_churning"):
        growth = growth - drawn_size(generator) * NOISE * housing / np.max(housing)
    return {"time [min]": times, "speeds [rpm]": speeds, "hall_rise [K]": hall, "growth [um]": growth}
