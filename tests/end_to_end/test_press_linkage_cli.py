"""The press linkage through the command line: the example, and the paper's printed numbers.

What it calculates is tested in tests/published, on the model.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from measured import calc_here

from shared import Calc


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped example, run once in this process."""
    folder = tmp_path_factory.mktemp("press") / "run"
    answer = calc_here(folder.parent, "run", "press_linkage", "-q", "-o", "run")
    assert answer.code == 0, answer.err
    return folder


def test_the_shipped_example_repeats_the_paper(example: Path) -> None:
    """Text after Table 6, Table 4 and Figs. 2 and 3; three digits are printed of most."""
    found = json.loads((example / "results.json").read_text("utf-8"))
    assert found["inputs"]["reading"]["value"] == "printed"
    ours = {name: item["value"] for name, item in found["results"].items()}
    assert ours["position_reliability"] == pytest.approx(0.5674, abs=5e-5)
    assert ours["position_reliability_final"] == pytest.approx(0.887, abs=5e-4)
    assert ours["tilt_reliability"] == pytest.approx(0.856, abs=5e-4)  # the paper: 0.857
    assert ours["tilt_reliability_final"] == pytest.approx(0.997, abs=5e-4)
    assert ours["adjustments"] == 9
    assert ours["salience_position_key"] == pytest.approx(0.877, abs=5e-4)  # the paper: 0.8766
    assert ours["salience_tilt_key"] == pytest.approx(0.902, abs=5e-4)  # the paper: 0.9006
    order = [ours[f"coefficient_{name}"] for name in (
        "lower_knee_length", "upper_knee_length", "knee_drive_length", "rod_length", "crank_radius", "platform_arm"
    )]  # fmt: skip
    assert order == pytest.approx([1, 1.040, 1.426, 4.281, 4.876, 5.389], rel=6e-4)
    assert ours["bdc_position"] == pytest.approx(3557.60, abs=5e-3)
    assert found["verdict"] == "proposed"
    assert [(check["state"], check["passed"]) for check in found["checks"]] == [("proposed", False)] * 2
    assert [check["value"] for check in found["checks"]] == pytest.approx([0.5674, 0.8570], abs=5e-3)
    assert [check["proposed"] for check in found["checks"]] == pytest.approx([0.8870, 0.9973], abs=5e-3)
    changes = {change["name"]: (change["from"], change["to"]) for change in found["proposal"]["changes"]}
    assert changes["crank_radius"] == ("IT7", "IT6")


def test_an_effect_that_does_nothing_is_a_warning(calc: Calc) -> None:
    cold = ("--set", "studies.run=[]", "--set", "effects.link_heating.expansion=11.5 um/(m*K)")
    answer = calc("run", "press_linkage", "--json", *cold)
    (warning,) = json.loads(answer.out)["warnings"]
    assert "'link_heating'" in warning
    assert "stays at its reference" in warning
    assert f"warning: {warning}" in answer.err


def test_verify_prints_settings_ratio_verdict_and_reasons(calc: Calc) -> None:
    answer = calc("verify", "press_linkage")
    assert answer.code == 0
    lines = answer.out.split("\n")
    assert " ".join(lines[0].split()) == "quantity where unit paper ours ratio verdict obtained kind why"
    assert "with reading = printed" in lines
    assert "with reading = complete" in lines
    (row,) = [line for line in lines if line.startswith("order of adjustment, l_g  ")]
    assert row.split()[-7:-1] == ["1.426", "1.4263", "1.0002", "matches", "calibrated", "calibrated"]
    number = row.split()[-1]
    assert any(line.startswith(f"{number} with the ground pivot angle 0.367 rad") for line in lines)
    assert sum(line.startswith("Finding: Misprint") for line in lines) >= 2
    assert lines[-2].endswith("every verdict is as stated")
