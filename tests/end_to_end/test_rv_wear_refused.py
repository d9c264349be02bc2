"""What the reducer calculation refuses on the command line: exit 2, one sentence that names the input."""

from pathlib import Path

import pytest

from shared import Calc

POSITIVE = {
    "pin_circle_radius": "mm", "pin_radius": "mm", "eccentricity": "mm", "disc_width": "mm",
    "composite_roughness": "um", "reconstruction_depth": "um", "young_modulus": "MPa", "output_torque": "N*m",
    "output_speed": "r/min", "pressure_viscosity": "1/Pa",
}  # fmt: skip


@pytest.fixture
def inputs(tmp_path: Path) -> Path:
    file = tmp_path / "reducer.toml"
    file.write_text('plugin = "rv_wear"\n[studies]\nrun = []\n', encoding="utf-8")
    return file


def settings(*texts: str) -> list[str]:
    return [word for text in texts for word in ("--set", text)]


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_what_must_be_positive_is_refused_by_name(calc: Calc, inputs: Path, value: str) -> None:
    wrong = settings(*(f"{name}={value} {unit}" for name, unit in POSITIVE.items()))
    answer = calc("run", "rv_wear", "--inputs", inputs, *wrong)
    assert answer.code == 2
    for name in POSITIVE:
        assert any(name in line for line in answer.err.splitlines()), name


def test_what_lies_outside_its_bounds_is_refused_by_name(calc: Calc, inputs: Path) -> None:
    wrong = ("working_time=-1 h", "pin_count=3", "poisson_ratio=0.5", "load_sharing=parabolic", "phases=0")
    answer = calc("run", "rv_wear", "--inputs", inputs, *settings(*wrong))
    assert answer.code == 2
    for text in wrong:
        assert any(text.split("=")[0] in line for line in answer.err.splitlines()), text
    halves = calc("run", "rv_wear", "--inputs", inputs, *settings("pin_count=40.5", "poisson_ratio=-0.1"))
    assert halves.code == 2
    assert "pin_count" in halves.err
    assert "poisson_ratio" in halves.err


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["eccentricity=2.9 mm"], ["short-width coefficient", "eccentricity * pin_count < pin_circle_radius"]),
        (["pin_radius=9.06 mm"], ["undercut", "reduce pin_radius"]),
        (["pin_radius=8.99 mm"], ["overlap", "reduce pin_radius or pin_count"]),
        (["shift_modification=-25 um"], ["radial clearance is negative", "shift_modification"]),
        (
            ["equidistant_modification=11.2 um", "shift_modification=7.2 um"],
            ["interfere", "reduce equidistant_modification"],
        ),
    ],
)
def test_impossible_geometry_is_refused_by_name(calc: Calc, inputs: Path, changes: list[str], words: list[str]) -> None:
    answer = calc("run", "rv_wear", "--inputs", inputs, *settings(*changes))
    assert answer.code == 2
    for word in words:
        assert word in answer.err
