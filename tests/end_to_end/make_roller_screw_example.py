"""The measured roller screw of the manual, made again byte for byte.

``python tests/end_to_end/make_roller_screw_example.py`` writes ``one_way.csv`` and ``measured.csv`` of
docs/examples/roller_screw_rubs. The screw is that of tests/hidden_effects, whose equations share nothing with
the plugin. What was set is rounded to what a log would hold before it is used, and what the gauge shows to its last
digit.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))

from hidden_effects.screw_machine import WIDTHS, Array, Rows, shown  # noqa: E402

EXAMPLE = TESTS.parent / "docs" / "examples" / "roller_screw_rubs"
SEED = 4
HIDDEN = {"mesh_friction": {"factor": 1.6}}
READINGS = 60
NOISE = 1.5e-3  # N m
DECIMALS = {
    "time [h]": 2, "axial_load [kN]": 1, "screw_speed [r/min]": 0, "temperature [degC]": 1, "screw_angle [deg]": 0,
}  # fmt: skip


def settings(rng: np.random.Generator, *, both_ways: bool) -> dict[str, Array]:
    """A day on the bench: one load and one way at about 600 r/min, or any load to 20 kN, any speed, to and fro."""
    time = np.linspace(0, 6, READINGS)
    columns = {
        "time [h]": time,
        "axial_load [kN]": rng.uniform(2, 20, READINGS) if both_ways else np.full(READINGS, 10.0),
        "screw_speed [r/min]": rng.uniform(60, 2000, READINGS) if both_ways else rng.uniform(590, 610, READINGS),
        "temperature [degC]": rng.uniform(20, 60, READINGS) if both_ways else rng.uniform(29.5, 30.5, READINGS),
        "screw_angle [deg]": rng.uniform(0, 14400, READINGS),
    }
    if both_ways:
        columns["screw_speed [r/min]"] *= rng.choice([-1.0, 1.0], READINGS)
    return {name: np.round(values, DECIMALS[name]) + 0.0 for name, values in columns.items()}


def file(rng: np.random.Generator, off: dict[str, float], *, both_ways: bool) -> str:
    """The text of one record."""
    written = settings(rng, both_ways=both_ways)
    rows = Rows(**{name.split(" ")[0]: values for name, values in written.items()}, cycles=np.zeros(READINGS))
    read = shown(rows, off, HIDDEN)["friction_torque"] + NOISE * rng.standard_normal(READINGS)
    cells = {name: [f"{value:.{DECIMALS[name]}f}" for value in values] for name, values in written.items()}
    cells["friction_torque [N*m]"] = [f"{value:.4f}" for value in read]
    return "\n".join([",".join(cells), *(",".join(row) for row in zip(*cells.values(), strict=True))]) + "\n"


def files() -> dict[str, str]:
    """The text of both files: one screw, measured one way, and then to and fro."""
    rng = np.random.default_rng(SEED)
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in WIDTHS.items()}
    return {"one_way.csv": file(rng, off, both_ways=False), "measured.csv": file(rng, off, both_ways=True)}


if __name__ == "__main__":
    for name, text in files().items():
        (EXAMPLE / name).write_text(text, encoding="utf-8", newline="\n")
        print(EXAMPLE / name)
