"""The press linkage through the command line: the paper's figures, another mechanism, a warm press."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from measured import calc_here

from shared import Answer, Calc, process

DEVIATIONS = (
    "crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length", "slider_half_width",
    "slider_joint_angle", "crank_pivot_radius", "crank_pivot_angle", "platform_half_width", "platform_joint_angle",
    "ground_pivot_radius", "ground_pivot_angle", "crank_angle",
)  # fmt: skip
SOURCES = [f"{name}_deviation_{side}" for name in DEVIATIONS for side in (1, 2)] + ["platform_arm_deviation"]
ANOTHER = {
    "crank_radius": "0.40 m",
    "rod_length": "1450 mm",
    "platform_arm": "0.55 m",
    "knee_drive_length": "0.9 m",
    "upper_knee_length": "1.62 m",
    "lower_knee_length": "1.75 m",
    "slider_half_width": "1.5 m",
    "crank_pivot_radius": "1.25 m",
    "platform_half_width": "0.35 m",
    "ground_pivot_radius": "1.42 m",
    "ground_pivot_angle": "0.33 rad",
}
Found = tuple[Answer, dict[str, Any]]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Found]:
    """Run the press with settings, each combination once, and return the answer and results.json.

    As it is shipped it runs as a process of its own, with settings in this one.
    """
    done: dict[tuple[str, ...], Found] = {}

    def run(*settings: str) -> Found:
        if settings not in done:
            folder = tmp_path_factory.mktemp("press")
            words = [word for text in settings for word in ("--set", text)]
            command = ("run", "press_linkage", "--json", *words)
            typed = [sys.executable, "-m", "truing", *command]
            answer = calc_here(folder, *command) if settings else process(typed, folder)
            assert answer.code in {0, 1}, answer.err
            done[settings] = answer, json.loads(answer.out)
        return done[settings]

    return run


def values(found: Mapping[str, Any]) -> dict[str, float]:
    """Return the results that are numbers, in the unit they are printed in."""
    return {name: item["value"] for name, item in found["results"].items()}


def table(text: str) -> dict[str, list[float]]:
    """Return a table by name, in the units of its header."""
    head, *rows = csv.reader(io.StringIO(text))
    return {name.partition(" [")[0]: [float(row[place]) for row in rows] for place, name in enumerate(head)}


def test_the_shipped_example_repeats_the_paper(run: Callable[..., Found]) -> None:
    """Text after Table 6, Table 4 and Figs. 2 and 3; three digits are printed of most."""
    answer, found = run()
    assert answer.code == 0
    assert found["inputs"]["reading"]["value"] == "printed"
    ours = values(found)
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


def test_the_complete_reading_does_not_reach_the_goals(run: Callable[..., Found]) -> None:
    answer, found = run("reading=complete")
    assert answer.code == 1
    ours = values(found)
    assert ours["position_reliability"] == pytest.approx(0.492, abs=5e-4)
    assert ours["position_reliability_final"] == pytest.approx(0.669, abs=5e-4)
    assert ours["tilt_reliability"] == pytest.approx(0.776, abs=5e-4)
    assert ours["tilt_reliability_final"] == pytest.approx(0.928, abs=5e-4)
    assert ours["adjustments"] == 12
    assert ours["permitted_tilt"] == pytest.approx(0.0013)
    assert {check["state"] for check in found["checks"]} == {"fails"}
    assert "every tolerance is at IT5" in " ".join(found["warnings"])
    assert "not reachable" in answer.err
    steps = found["studies"]["allocation"]["steps"]
    assert [step["to"] for step in steps] == ["IT6"] * 6 + ["IT5"] * 6


def test_the_chance_is_counted_on_the_exact_kinematics(run: Callable[..., Found]) -> None:
    """The count of drawn machines and the first-order figure agree within four standard errors of the count."""
    for settings in ((), ("reading=complete",)):
        for item in run(*settings)[1]["studies"]["reliability"].values():
            assert item["draws"] >= 100_000
            assert abs(item["probability"] - item["first_order"]) < 4 * item["standard_error"]
            low, high = item["interval95"]
            assert low < item["probability"] < high


def test_the_slider_at_the_crank_angles_of_the_reference_table(calc: Calc, tmp_path: Path) -> None:
    """z2 at -40, -10, 0, 10, 40, 90 and 150 degree from the bottom dead centre, m."""
    expected = {-40: 3.53002, -10: 3.55649, 0: 3.55760, 10: 3.55656, 40: 3.53760, 90: 3.40544, 150: 2.99361}
    (tmp_path / "press.toml").write_text("[inputs]\n")
    (tmp_path / "rows.csv").write_text("crank_angle [deg]\n" + "".join(f"{angle}\n" for angle in expected))
    metres = ("--set", "units.slider_position=m")
    answer = calc("table", "press_linkage", "--inputs", "press.toml", "--rows", "rows.csv", *metres)
    assert answer.code == 0, answer.err
    assert table(answer.out)["slider_position"] == pytest.approx(list(expected.values()), abs=6e-6)
    for angle in (-40, 40):
        quick = ("--set", "studies.run=[]", "--set", f"crank_angle={angle} deg", "--json")
        found = json.loads(calc("run", "press_linkage", *quick).out)
        assert found["results"]["slider_position"] == {
            "value": pytest.approx(1000 * expected[angle], abs=6e-3),
            "unit": "mm",
        }


@pytest.mark.parametrize("crank_angle", ["0 deg", "-25 deg", "100 deg"])
def test_another_mechanism_has_the_sensitivities_of_its_exact_kinematics(
    calc: Calc, tmp_path: Path, crank_angle: str
) -> None:
    """Central differences of ``calc table`` over two steps, in m/m, m/rad and rad/m; nothing of it differentiates."""
    mechanism = {**ANOTHER, "crank_angle": crank_angle}
    settings = [word for name, value in mechanism.items() for word in ("--set", f"{name}={value}")]
    answer = calc("run", "press_linkage", "--json", *settings, "--set", 'studies.run=["sensitivity"]')
    assert answer.code in {0, 1}, answer.err
    stated = json.loads(answer.out)["studies"]["sensitivity"]
    (tmp_path / "empty.toml").write_text("[inputs]\n")
    (tmp_path / "steps.csv").write_text(steps_table())
    answer = calc("table", "press_linkage", "--inputs", "empty.toml", "--rows", "steps.csv", *settings)
    assert answer.code == 0, answer.err
    found = table(answer.out)
    scale = {"slider_position": 1.0, "slider_tilt": 1e-3}  # mm per mm or mrad; urad per mm or mrad
    largest = 0.0
    for result, factor in scale.items():
        for place, source in enumerate(SOURCES):
            far_low, low, high, far_high = found[result][4 * place : 4 * place + 4]
            difference = factor * (8 * (high - low) - (far_high - far_low)) / (12 * STEP)
            assert factor * stated[result][source]["derivative"] == pytest.approx(difference, abs=1e-8), source
            largest = max(largest, abs(difference))
    assert largest > 0.3


STEP = 0.5  # mm and mrad


def steps_table() -> str:
    """Return four rows for each of the 29 sources: two steps down, one down, one up, two up."""
    unit = {name: "mrad" if "angle" in name else "mm" for name in SOURCES}
    lines = [",".join(f"{name} [{unit[name]}]" for name in SOURCES)]
    steps = [(source, step) for source in SOURCES for step in (-2 * STEP, -STEP, STEP, 2 * STEP)]
    lines += [",".join(repr(step) if name == source else "0" for name in SOURCES) for source, step in steps]
    return "\n".join(lines) + "\n"


WARM = (
    "link_temperature=35 degC",
    "effects.link_heating.expansion=11.5 um/(m*K)",
)


def test_a_warm_press_changes_every_study(run: Callable[..., Found]) -> None:
    _, cold = run()
    _, warm = run(*WARM)
    assert warm["effects"]["link_heating"]["expansion"]["value"] == pytest.approx(11.5)
    assert warm["conditions"]["link_temperature"] == {"value": pytest.approx(35.0), "unit": "degC"}
    for study in ("sweep", "sensitivity", "reliability", "allocation"):
        assert warm["studies"][study] != cold["studies"][study], study
    chances = [found["studies"]["reliability"]["slider_position"]["probability"] for found in (cold, warm)]
    assert chances[1] < chances[0]


def test_heat_is_the_growth_of_every_link(run: Callable[..., Found]) -> None:
    """15 K at 11.5 um/(m K) make each link longer by 0.1725 mm per metre; the frame stays."""
    lengths = {"crank_radius": 0.36, "rod_length": 1.304, "knee_drive_length": 0.868, "upper_knee_length": 1.7,
               "lower_knee_length": 1.6}  # fmt: skip
    strain = 15 * 11.5e-3  # mm per m
    grown = [f"{name}_deviation_{side}={strain * length!r} mm" for name, length in lengths.items() for side in (1, 2)]
    _, warm = run("studies.run=[]", *WARM)
    _, built = run("studies.run=[]", f"platform_arm_deviation={strain * 0.6!r} mm", *grown)
    _, cold = run("studies.run=[]")
    place = "slider_position"
    assert values(warm)[place] == pytest.approx(values(built)[place], rel=1e-14)
    assert values(warm)[place] - values(cold)[place] > 0.3  # mm: the slider sinks
    assert values(warm)["slider_tilt"] == pytest.approx(0, abs=1e-6)


def test_an_effect_that_does_nothing_is_a_warning(run: Callable[..., Found]) -> None:
    answer, found = run("studies.run=[]", WARM[1])
    (warning,) = found["warnings"]
    assert "'link_heating'" in warning
    assert "stays at its reference" in warning
    assert f"warning: {warning}" in answer.err


def test_verify_shows_every_row_and_both_misprints(calc: Calc) -> None:
    answer = calc("verify", "press_linkage", "--json")
    assert (answer.code, answer.err) == (0, "")
    found = json.loads(answer.out)
    assert all(row["as_stated"] for row in found["rows"])
    rows = {row["name"]: row for row in found["rows"]}
    paper = {
        "salience of the 12 key errors, position": 0.8766,
        "salience of the 10 key errors, tilt": 0.9006,
        "order of adjustment, l_h": 1.0,
        "order of adjustment, l_m": 1.040,
        "order of adjustment, l_g": 1.426,
        "order of adjustment, k_R": 4.281,
        "order of adjustment, a": 4.876,
        "order of adjustment, k": 5.389,
        "position reliability, start": 0.5674,
        "position reliability, final": 0.887,
        "tilt reliability, start": 0.857,
        "tilt reliability, final": 0.9973,
        "number of adjustments": 9,
    }
    for name, printed in paper.items():
        row = rows[name]
        assert row["paper"] == printed
        assert row["verdict"] == ("differs" if name == "tilt reliability, final" else "matches")
        assert row["ratio"] == pytest.approx(1, abs=2e-3)
        assert row["settings"] == {"reading": "printed"}
    assert any(row["verdict"] == "differs" and row["why"] for row in found["rows"])
    titles = [finding["title"] for finding in found["findings"]]
    assert "Misprint: the ground pivot angle" in titles
    assert "Misprint: the unit of the tilt limit" in titles


def test_verify_prints_settings_ratio_verdict_and_reasons(calc: Calc) -> None:
    answer = calc("verify", "press_linkage")
    assert answer.code == 0
    lines = answer.out.split("\n")
    assert lines[0].split() == [
        "quantity",
        "where",
        "unit",
        "paper",
        "ours",
        "ratio",
        "verdict",
        "obtained",
        "kind",
        "why",
    ]
    assert "with reading = printed" in lines
    assert "with reading = complete" in lines
    (row,) = [line for line in lines if line.startswith("order of adjustment, l_g  ")]
    assert row.split()[-7:-1] == ["1.426", "1.4263", "1.0002", "matches", "calibrated", "calibrated"]
    number = row.split()[-1]
    assert any(line.startswith(f"{number} with the ground pivot angle 0.367 rad") for line in lines)
    assert sum(line.startswith("Finding: Misprint") for line in lines) >= 2
    assert lines[-2].endswith("every verdict is as stated")
