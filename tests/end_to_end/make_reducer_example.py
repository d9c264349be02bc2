"""The measured reducer of the manual, made again byte for byte.

``python tests/end_to_end/make_reducer_example.py`` writes ``backlash.csv`` and ``opened.csv`` of
docs/examples/reducer_wears_slowly. The reducer is that of tests/hidden_effects: a mesh and a wear that share nothing
with the plugin. Parts are drawn from their zones, what was set is rounded to what a log would hold before it is used,
and what the gauges show is rounded to their last digit.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))

from hidden_effects.rv_machine import ROUGHNESS_SCATTER, ZONES, Array, Rows, shown  # noqa: E402

EXAMPLE = TESTS.parent / "docs" / "examples" / "reducer_wears_slowly"
SEED = 5
HIDDEN = {"pin_rolling": {"rolling": 0.3}}
READINGS = 80
NOISE = {"backlash": 0.008, "max_wear": 0.08}  # arcmin, um
OPENED = range(4, READINGS, 5)  # readings after which the housing was opened and a flank measured, every 380 h
DECIMALS = {
    "working_time [h]": 0, "time [h]": 0, "housing_temperature [degC]": 1, "disc_temperature [degC]": 1,
    "oil_temperature [degC]": 1, "output_angle [deg]": 0, "crank_angle [deg]": 0, "measuring_torque [N*m]": 0,
    "direction [1]": 0,
}  # fmt: skip


def settings(rng: np.random.Generator) -> dict[str, Array]:
    """An endurance run at the rating, 6000 h, read every 76 h: warm and cold, anywhere, from both sides."""
    hours = np.linspace(0.0, 6000.0, READINGS)
    housing = rng.uniform(20, 45, READINGS)
    columns = {
        "working_time [h]": hours,
        "time [h]": hours,
        "housing_temperature [degC]": housing,
        "disc_temperature [degC]": housing + rng.uniform(-2, 8, READINGS),
        "oil_temperature [degC]": 40 + 2 * np.sin(hours / 900),
        "output_angle [deg]": rng.uniform(0, 360, READINGS),
        "crank_angle [deg]": np.random.default_rng(READINGS).uniform(0, 360, READINGS),
        "measuring_torque [N*m]": rng.uniform(0, 200, READINGS),
        "direction [1]": rng.choice([-1.0, 1.0], READINGS),
    }
    return {name: np.round(values, DECIMALS[name]) + 0.0 for name, values in columns.items()}


def files() -> dict[str, str]:
    """The text of both files: the backlash alone, and with the wear of the flank where it was measured."""
    rng = np.random.default_rng(SEED)
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in ZONES.items()}
    off["roughness"] = float(ROUGHNESS_SCATTER * rng.standard_normal())
    written = settings(rng)
    rated = {"output_torque": np.full(READINGS, 3136.0), "output_speed": np.full(READINGS, 15.0)}
    rows = Rows(**{name.split(" ")[0]: values for name, values in written.items()}, **rated)
    read = {
        name: values + NOISE[name] * rng.standard_normal(READINGS) for name, values in shown(rows, off, HIDDEN).items()
    }
    cells = {name: [f"{value:.{DECIMALS[name]}f}" for value in values] for name, values in written.items()}
    cells["backlash [arcmin]"] = [f"{value:.3f}" for value in read["backlash"]]
    backlash = table(cells)
    cells["max_wear [um]"] = [f"{value:.2f}" if place in OPENED else "" for place, value in enumerate(read["max_wear"])]
    return {"backlash.csv": backlash, "opened.csv": table(cells)}


def table(cells: dict[str, list[str]]) -> str:
    """Columns as text, with their names and units on top."""
    return "\n".join([",".join(cells), *(",".join(row) for row in zip(*cells.values(), strict=True))]) + "\n"


if __name__ == "__main__":
    for name, text in files().items():
        (EXAMPLE / name).write_text(text, encoding="utf-8", newline="\n")
        print(EXAMPLE / name)
