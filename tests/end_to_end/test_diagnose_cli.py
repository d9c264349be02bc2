"""calc diagnose from a measured file to a folder, and on from what it leaves: every verb takes the extended model."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from shared import Calc

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """A pin whose probe reads 0.5 um/K deeper when warm; the depth after Archard by hand, 0.2 um of noise.

    120 N on 28 mm^2, 3e-8 and 2.1 GPa at 0.5 m/s wear 0.11020 um an hour.
    """
    rng = np.random.default_rng(11)
    hours = np.linspace(10, 250, 90)
    temperature = 26 + 6 * np.sin(np.arange(90) * 0.7) + rng.normal(0, 1, 90)
    rate = 3e-8 * (120 / 28e-6) / 2.1e9 * 0.5 * 3600 * 1e6
    depth = rate * hours + 0.5 * (temperature - 20) + rng.normal(0, 0.2, 90)
    lines = [f"{a!r},{b!r},{c!r}" for a, b, c in zip(hours.tolist(), temperature.tolist(), depth.tolist(), strict=True)]
    file = tmp_path / "warm probe.csv"
    file.write_text("\n".join(["time [h],probe_temperature [degC],depth [um]", *lines]) + "\n", encoding="utf-8")
    return file


def test_a_warm_probe_is_found_and_the_extended_model_is_taken_by_every_verb(
    calc: Calc, record: Path, tmp_path: Path
) -> None:
    (tmp_path / "pin.toml").write_text("[studies]\nrun = []\n", encoding="utf-8")
    answer = calc("diagnose", PIN, "--inputs", "pin.toml", "--data", record)
    assert answer.code == 0, answer.err
    folder = tmp_path / "runs" / "warm probe"
    document = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    assert document["verdict"] in {"named", "one_of"}
    (cause,) = document["causes"]
    assert "warm_probe" in (cause["effect"], *cause["same_as"])
    (slope,) = (item for item in cause["unknowns"].values())
    low, high = slope["interval95"]
    assert slope["unit"] == "um/K"
    assert low < 0.5 < high
    assert high - low < 0.1
    assert "warm probe" in answer.out or "thermal drift" in answer.out
    extended = folder / "extended.toml"
    assert calc("run", PIN, "--inputs", extended, "-o", "extended").code in {0, 1}
    assert calc("table", PIN, "--inputs", extended, "--rows", record, "-o", "shown.csv").code == 0
    measured, shown = (
        np.genfromtxt(file, delimiter=",", skip_header=1, usecols=column)
        for file, column in ((record, 2), (tmp_path / "shown.csv", -1))
    )
    assert np.sqrt(np.mean((measured - shown) ** 2)) < 0.25


def test_a_diagnosed_machine_can_be_diagnosed_again(calc: Calc, record: Path, tmp_path: Path) -> None:
    """With the cause on nothing is left; the nominals of the design stand as they were."""
    (tmp_path / "pin.toml").write_text("[studies]\nrun = []\n", encoding="utf-8")
    assert calc("diagnose", PIN, "--inputs", "pin.toml", "--data", record, "-o", "first").code == 0
    answer = calc("diagnose", PIN, "--inputs", "first/extended.toml", "--data", record, "--json", "-o", "second")
    assert answer.code == 0, answer.err
    assert json.loads(answer.out)["explanations"] == []
    again = (tmp_path / "second" / "inputs.toml").read_text(encoding="utf-8")
    assert 'load = "120 N"' in again
