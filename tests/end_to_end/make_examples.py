"""The measured machines of the manual, made again byte for byte: presses, a reducer, a roller screw.

``python tests/end_to_end/make_examples.py`` writes the measured files of docs/examples/press_off_by_40_um,
press_warm_links, reducer_wears_slowly and roller_screw_rubs. The machines are those of tests/hidden_effects, which
share nothing with the plugins. Parts are drawn from their tolerances, what was set is rounded to what a log would hold
before it is used, and what the gauges show is rounded to their last digit.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))

from hidden_effects import press_machine, rv_machine, screw_machine  # noqa: E402
from hidden_effects.designs import Noise  # noqa: E402
from hidden_effects.press_machine import POSITION, TILT  # noqa: E402

EXAMPLES = TESTS.parent / "docs" / "examples"
Array = NDArray[np.float64]
Columns = dict[str, tuple[Array, int]]
"""Values as set, and the decimals with which they are written."""
Cells = dict[str, list[str]]


def rounded(columns: Columns) -> dict[str, Array]:
    """What was set as it is written."""
    return {name: np.round(values, decimals) + 0.0 for name, (values, decimals) in columns.items()}


def cells_of(columns: Columns) -> Cells:
    """The same as text."""
    return {name: [f"{value:.{columns[name][1]}f}" for value in values] for name, values in rounded(columns).items()}


def table(cells: Cells) -> str:
    """Columns as text, with their names and units on top."""
    return "\n".join([",".join(cells), *(",".join(row) for row in zip(*cells.values(), strict=True))]) + "\n"


# Presses


PRESS_NOISE = Noise("autocorrelated", {POSITION: 1.5e-6, TILT: 3e-6}, 0.4)


@dataclass(frozen=True)
class Day:
    """One file of measured rows: where it stands, how it was measured, and what was measured."""

    file: str
    settings: Callable[[np.random.Generator], Columns]
    results: tuple[str, ...]


@dataclass(frozen=True)
class Press:
    """One machine with something wrong: its seed, what is wrong in SI, and the days on which it was measured."""

    seed: int
    hidden: press_machine.Hidden
    days: tuple[Day, ...]


def a_day(rng: np.random.Generator) -> Columns:
    """Eight hours with a break: angles, loads, speeds and both ways in any order; sometimes the slider hangs."""
    count = 120
    hours = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 8.0, count - 1))])
    force = np.where(rng.random(count) < 0.2, -rng.uniform(40, 180, count), rng.uniform(50, 1000, count))
    return press_columns(hours, warmth(hours, rng), force, rng.uniform(-60, 60, count), rng)


def a_cautious_day(rng: np.random.Generator) -> Columns:
    """The same for 80 rows, near the bottom dead centre only."""
    count = 80
    hours = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 8.0, count - 1))])
    force = np.where(rng.random(count) < 0.2, -rng.uniform(40, 180, count), rng.uniform(50, 1000, count))
    return press_columns(hours, warmth(hours, rng), force, rng.uniform(-40, 40, count), rng)


def the_next_points(rng: np.random.Generator) -> Columns:
    """Twelve rows: cold and as warm as it gets, far from the dead centre and at it."""
    angle = np.array([-60.0, 0.0, 60.0] * 4)
    warm = np.repeat([18.0, 50.0, 50.0, 18.0], 3)
    return press_columns(np.arange(12) * 0.5, warm, np.full(12, -150.0), angle, rng)


def press_columns(hours: Array, warm: Array, force: Array, angle: Array, rng: np.random.Generator) -> Columns:
    """What was set and logged, in the units and with the decimals of the file."""
    count = len(hours)
    pace = rng.choice([0.0, 300.0, 900.0, 1500.0], 9)  # strokes per hour, another pace every hour
    return {
        "crank_angle [deg]": (angle, 1),
        "forming_force [kN]": (force, 0),
        "link_temperature [degC]": (warm, 1),
        "time [h]": (hours, 3),
        "strokes [1]": (np.interp(hours, np.arange(10), np.concatenate([[0.0], np.cumsum(pace)])), 0),
        "speed [rpm]": (rng.choice([12.0, 20.0, 30.0, 40.0], count), 0),
        "direction [1]": (rng.choice([-1.0, 1.0], count), 0),
    }


def warmth(hours: Array, rng: np.random.Generator) -> Array:
    """Links that warm up by 19 K, cool down in a break from 4 h to 5.5 h, and warm up again."""
    first = 19 * -np.expm1(-hours / 1.5)
    cooling = 19 * -np.expm1(-4 / 1.5) * np.exp(-(hours - 4) / 1.2)
    left = 19 * -np.expm1(-4 / 1.5) * np.exp(-1.5 / 1.2)
    again = 19 + (left - 19) * np.exp(-(hours - 5.5) / 1.5)
    rise = np.where(hours < 4, first, np.where(hours < 5.5, cooling, again))
    return np.asarray(20 + rise + rng.normal(0.0, 0.3, len(hours)))


def rows_of(written: Mapping[str, Array]) -> press_machine.Rows:
    """The rows as the press sees them, SI."""
    return press_machine.Rows(
        crank_angle=np.radians(written["crank_angle [deg]"]),
        forming_force=written["forming_force [kN]"] * 1e3,
        link_temperature=written["link_temperature [degC]"],
        time=written["time [h]"] * 3600,
        strokes=written["strokes [1]"],
        speed=written["speed [rpm]"] / 60,
        direction=written["direction [1]"],
    )


def measured(day: Day, press: Press, off: Mapping[str, float], rng: np.random.Generator) -> str:
    """One file: what was set, and what the gauges showed."""
    settings = day.settings(rng)
    rows = rows_of(rounded(settings))
    true = press_machine.shown(rows, off, press.hidden)
    read = {name: true[name] + PRESS_NOISE.drawn(rows, name, rng) for name in (POSITION, TILT)}
    cells = cells_of(settings)
    cells["slider_position [mm]"] = [f"{value * 1e3:.4f}" for value in read[POSITION]]
    if TILT in day.results:
        cells["slider_tilt [urad]"] = [f"{value * 1e6:.1f}" for value in read[TILT]]
    return table(cells)


def press_files(press: Press) -> dict[str, str]:
    """The text of every file of a press; its parts are drawn once."""
    rng = np.random.default_rng(press.seed)
    off = {name: float(sd * rng.standard_normal()) for name, sd in press_machine.SCATTER.items()}
    return {day.file: measured(day, press, off, rng) for day in press.days}


PRESSES = (
    Press(
        seed=11,
        hidden={"joint_clearance": {"clearance": 6e-6}},
        days=(Day("press_off_by_40_um/measured.csv", a_day, (POSITION, TILT)),),
    ),
    Press(
        seed=2,
        hidden={"link_heating": {"expansion": 0.5e-6}},
        days=(
            Day("press_warm_links/monday.csv", a_cautious_day, (POSITION,)),
            Day("press_warm_links/tuesday.csv", the_next_points, (POSITION,)),
        ),
    ),
)


# A reducer: an endurance run


REDUCER_HIDDEN = {"pin_rolling": {"rolling": 0.3}}
REDUCER_NOISE = {"backlash": 0.008, "max_wear": 0.08}  # arcmin, um
REDUCER_READINGS = 80
OPENED = range(4, REDUCER_READINGS, 5)
"""Readings after which the housing was opened and a flank measured, every 380 h."""


def endurance(rng: np.random.Generator) -> Columns:
    """An endurance run at the rating, 6000 h, read every 76 h: warm and cold, anywhere, from both sides."""
    count = REDUCER_READINGS
    hours = np.linspace(0.0, 6000.0, count)
    housing = rng.uniform(20, 45, count)
    return {
        "working_time [h]": (hours, 0),
        "time [h]": (hours, 0),
        "housing_temperature [degC]": (housing, 1),
        "disc_temperature [degC]": (housing + rng.uniform(-2, 8, count), 1),
        "oil_temperature [degC]": (40 + 2 * np.sin(hours / 900), 1),
        "output_angle [deg]": (rng.uniform(0, 360, count), 0),
        "crank_angle [deg]": (np.random.default_rng(count).uniform(0, 360, count), 0),
        "measuring_torque [N*m]": (rng.uniform(0, 200, count), 0),
        "direction [1]": (rng.choice([-1.0, 1.0], count), 0),
    }


def reducer_files() -> dict[str, str]:
    """The text of both files: the backlash alone, and with the wear of the flank where it was measured."""
    rng = np.random.default_rng(5)
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in rv_machine.ZONES.items()}
    off["roughness"] = float(rv_machine.ROUGHNESS_SCATTER * rng.standard_normal())
    settings, count = endurance(rng), REDUCER_READINGS
    rated = {"output_torque": np.full(count, 3136.0), "output_speed": np.full(count, 15.0)}
    rows = rv_machine.Rows(**{name.split(" ")[0]: values for name, values in rounded(settings).items()}, **rated)
    true = rv_machine.shown(rows, off, REDUCER_HIDDEN)
    read = {name: values + REDUCER_NOISE[name] * rng.standard_normal(count) for name, values in true.items()}
    cells = cells_of(settings)
    cells["backlash [arcmin]"] = [f"{value:.3f}" for value in read["backlash"]]
    backlash = table(cells)
    cells["max_wear [um]"] = [f"{value:.2f}" if place in OPENED else "" for place, value in enumerate(read["max_wear"])]
    return {"reducer_wears_slowly/backlash.csv": backlash, "reducer_wears_slowly/opened.csv": table(cells)}


# A roller screw: a day on the bench


def on_the_bench(rng: np.random.Generator, *, both_ways: bool) -> Columns:
    """One load and one way at about 600 r/min, or any load to 20 kN, any speed, to and fro."""
    count = 60
    load = rng.uniform(2, 20, count) if both_ways else np.full(count, 10.0)
    speed = rng.uniform(60, 2000, count) if both_ways else rng.uniform(590, 610, count)
    warmth = rng.uniform(20, 60, count) if both_ways else rng.uniform(29.5, 30.5, count)
    angle = rng.uniform(0, 14400, count)
    return {
        "time [h]": (np.linspace(0, 6, count), 2),
        "axial_load [kN]": (load, 1),
        "screw_speed [r/min]": (speed * rng.choice([-1.0, 1.0], count) if both_ways else speed, 0),
        "temperature [degC]": (warmth, 1),
        "screw_angle [deg]": (angle, 0),
    }


def screw_file(rng: np.random.Generator, off: dict[str, float], *, both_ways: bool) -> str:
    """The text of one record."""
    settings = on_the_bench(rng, both_ways=both_ways)
    written = {name.split(" ")[0]: values for name, values in rounded(settings).items()}
    rows = screw_machine.Rows(**written, cycles=np.zeros(60))
    true = screw_machine.shown(rows, off, {"mesh_friction": {"factor": 1.6}})["friction_torque"]
    read = true + 1.5e-3 * rng.standard_normal(60)  # N m
    return table({**cells_of(settings), "friction_torque [N*m]": [f"{value:.4f}" for value in read]})


def screw_files() -> dict[str, str]:
    """The text of both files: one screw, measured one way, and then to and fro."""
    rng = np.random.default_rng(4)
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in screw_machine.WIDTHS.items()}
    return {
        f"roller_screw_rubs/{name}.csv": screw_file(rng, off, both_ways=both_ways)
        for name, both_ways in (("one_way", False), ("measured", True))
    }


def files() -> dict[str, str]:
    """The text of every file, by its place among the examples."""
    made = [press_files(press) for press in PRESSES] + [reducer_files(), screw_files()]
    return {name: text for each in made for name, text in each.items()}


if __name__ == "__main__":
    for name, text in files().items():
        (EXAMPLES / name).write_text(text, encoding="utf-8", newline="\n")
        print(EXAMPLES / name)
