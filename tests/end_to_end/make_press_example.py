"""The measured presses of the manual, made again byte for byte.

``python tests/end_to_end/make_press_example.py`` writes ``measured.csv`` of docs/examples/press_off_by_40_um, and
``monday.csv`` and ``tuesday.csv`` of docs/examples/press_warm_links. The presses are those of tests/hidden_effects:
exact geometry that shares nothing with the plugin. Parts are drawn from their tolerances, what was set is rounded to
what a log would hold before the press is moved, and what the gauges show is rounded to their last digit.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))

from hidden_effects.designs import Noise  # noqa: E402
from hidden_effects.press_machine import (  # noqa: E402
    POSITION,
    SCATTER,
    TILT,
    Array,
    Hidden,
    Rows,
    shown,
)

EXAMPLES = TESTS.parent / "docs" / "examples"
NOISE = Noise("autocorrelated", {POSITION: 1.5e-6, TILT: 3e-6}, 0.4)
Columns = dict[str, tuple[Array, int]]  # values as written, decimals


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
    hidden: Hidden
    days: tuple[Day, ...]


def a_day(rng: np.random.Generator) -> Columns:
    """Eight hours with a break: angles, loads, speeds and both ways in any order; sometimes the slider hangs."""
    count = 120
    hours = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 8.0, count - 1))])
    force = np.where(rng.random(count) < 0.2, -rng.uniform(40, 180, count), rng.uniform(50, 1000, count))
    return columns(hours, warmth(hours, rng), force, rng.uniform(-60, 60, count), rng)


def a_cautious_day(rng: np.random.Generator) -> Columns:
    """The same for 80 rows, near the bottom dead centre only."""
    count = 80
    hours = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 8.0, count - 1))])
    force = np.where(rng.random(count) < 0.2, -rng.uniform(40, 180, count), rng.uniform(50, 1000, count))
    return columns(hours, warmth(hours, rng), force, rng.uniform(-40, 40, count), rng)


def the_next_points(rng: np.random.Generator) -> Columns:
    """Twelve rows: cold and as warm as it gets, far from the dead centre and at it."""
    angle = np.array([-60.0, 0.0, 60.0] * 4)
    warm = np.repeat([18.0, 50.0, 50.0, 18.0], 3)
    return columns(np.arange(12) * 0.5, warm, np.full(12, -150.0), angle, rng)


def columns(hours: Array, warm: Array, force: Array, angle: Array, rng: np.random.Generator) -> Columns:
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


def rows_of(written: Mapping[str, Array]) -> Rows:
    """The rows as the press sees them, SI."""
    return Rows(
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
    written = {name: np.round(values, decimals) + 0.0 for name, (values, decimals) in settings.items()}
    rows = rows_of(written)
    true = shown(rows, off, press.hidden)
    read = {name: true[name] + NOISE.drawn(rows, name, rng) for name in (POSITION, TILT)}
    cells = {name: [f"{value:.{settings[name][1]}f}" for value in values] for name, values in written.items()}
    cells["slider_position [mm]"] = [f"{value * 1e3:.4f}" for value in read[POSITION]]
    if TILT in day.results:
        cells["slider_tilt [urad]"] = [f"{value * 1e6:.1f}" for value in read[TILT]]
    return "\n".join([",".join(cells), *(",".join(row) for row in zip(*cells.values(), strict=True))]) + "\n"


def files(press: Press) -> dict[str, str]:
    """The text of every file of a press; its parts are drawn once."""
    rng = np.random.default_rng(press.seed)
    off = {name: float(sd * rng.standard_normal()) for name, sd in SCATTER.items()}
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


if __name__ == "__main__":
    for each in PRESSES:
        for name, text in files(each).items():
            (EXAMPLES / name).write_text(text, encoding="utf-8", newline="\n")
            print(EXAMPLES / name)
