"""A press with something hidden in it, from a measured file to the extended model, and on through every verb."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_contract import demand_contract
from measured import (
    CONTRACT,
    HEATED,
    HEATED_SEED,
    HEIGHT,
    Columns,
    Diagnosed,
    calc_here,
    columns_of,
    diagnose_here,
    documented,
    names,
    read_document,
    taken,
    text_of,
)

import truing
from hidden_effects.asking import INPUTS, write_case
from hidden_effects.cases import Case
from hidden_effects.making import Wish, make_case
from hidden_effects.press_machine import POSITION, Rows, shown

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")
NOTHING_WRONG = Wish("none", "wide", "gaussian", (POSITION,), 120)
ODDS = {"studies.run": ["reliability"], "studies.reliability.draws": 20000}


@pytest.fixture(scope="session")
def case() -> Case:
    """A press whose links grow with their temperature otherwise than its frame."""
    return make_case(HEATED_SEED, HEATED)


@pytest.fixture(scope="session")
def desk(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with its inputs, its record, and a second record to judge with."""
    folder = tmp_path_factory.mktemp("workflow")
    write_case(case, folder)
    return folder


@pytest.fixture(scope="session")
def found(heated: Diagnosed) -> Diagnosed:
    """The diagnosis, in the folder that nobody named."""
    return heated


def test_what_was_hidden_is_named_with_its_size(case: Case, found: Diagnosed) -> None:
    (cause,) = found.document["causes"]
    assert cause["effect"] == "link_heating"
    assert cause["same_as"] == ["side_heating"]
    hidden = case.hidden["link_heating"]["expansion"] * 1e6
    unknown = cause["unknowns"]["expansion"]
    assert unknown["unit"] == "um/(m*K)"
    assert unknown["interval95"][0] < hidden < unknown["interval95"][1]
    assert (found.document["verdict"], found.document["unique"]) == ("one_of", False)
    assert found.document["wrong"][POSITION]["noise_floor"]["value"] == pytest.approx(
        case.record.noise.sd[POSITION] * 1e6, rel=3 / np.sqrt(2 * 90)
    )


def test_the_answer_on_the_terminal(found: Diagnosed) -> None:
    for words in (
        "One of 2 causes; this record cannot say which.",
        "link heating",
        "1 What is wrong",
        "2 Cause",
        "3 Extended model",
        "4 Gain",
        "5 Next",
    ):
        assert words in found.answer.out
    assert f"extended model: {Path('runs', 'measured', 'extended.toml')}" in found.answer.out


def test_every_file_of_the_contract_is_written(desk: Path, found: Diagnosed) -> None:
    assert {path.name for path in found.folder.iterdir()} == CONTRACT | {"extended.toml"}
    demand_contract(found.document, json.loads(calc_here(desk, "describe", "press_linkage", "--json").out))
    assert (found.document["rows"], found.document["runs"], found.document["measured"]) == (90, 1, [POSITION])
    run = json.loads((found.folder / "run.json").read_text(encoding="utf-8"))
    assert list(run["data"]) == ["measured.csv"]
    html = (found.folder / "sheet.html").read_text(encoding="utf-8")
    assert "link heating" in html
    assert "<svg" in html
    assert "link heating" in (found.folder / "sheet.md").read_text(encoding="utf-8")


def test_the_extended_model_runs(desk: Path, found: Diagnosed) -> None:
    """Heights of the slider at the bottom, cold and as warm as it was measured, by exact geometry."""
    results = {}
    for name in ("inputs.toml", str(found.folder / "extended.toml")):
        answer = calc_here(desk, "run", "press_linkage", "--inputs", name, "-o", "run", "--set", "studies.run=[]")
        assert answer.code == 1, answer.err  # its limits on chances stay undecided
        assert "warning" not in answer.err
        results[name] = json.loads((desk / "run" / "results.json").read_text(encoding="utf-8"))
    cold, warm = results.values()
    assert cold["effects"] == {}
    expansion = found.document["causes"][0]["unknowns"]["expansion"]["value"]
    assert warm["effects"]["link_heating"]["expansion"]["value"] == pytest.approx(expansion, rel=1e-12)
    measured = np.array(
        columns_of((desk / "measured.csv").read_text(encoding="utf-8"))["link_temperature [degC]"], float
    )
    temperature = warm["conditions"]["link_temperature"]["value"]
    assert temperature == pytest.approx(measured.mean(), rel=1e-12)
    still = dict.fromkeys(("time", "crank_angle", "forming_force", "strokes", "speed"), 0.0)
    given = {**still, "link_temperature": temperature, "direction": 1.0}
    row = Rows(**{name: np.array([value]) for name, value in given.items()})
    for run, hidden in ((cold, {}), (warm, {"link_heating": {"expansion": expansion * 1e-6}})):
        height = run["results"]["slider_position"]
        assert height["unit"] == "mm"
        assert height["value"] == pytest.approx(shown(row, {}, hidden)[POSITION][0] * 1e3, abs=1e-6)


def test_the_extended_model_with_all_its_studies_ends_as_the_model_does(desk: Path, found: Diagnosed) -> None:
    """Exit 1, as its checks fail with or without the effect; nothing that breaks."""
    few = ("--set", "studies.reliability.draws=5000", "-q")
    answer = calc_here(desk, "run", "press_linkage", "--inputs", found.folder / "extended.toml", "-o", "run", *few)
    assert answer.code == 1, answer.err


def test_rows_held_out_are_predicted_to_about_the_noise(case: Case, desk: Path, found: Diagnosed) -> None:
    extended = found.folder / "extended.toml"
    answer = calc_here(
        desk, "table", "press_linkage", "--inputs", extended, "--rows", "held_out.csv", "-o", "shown.csv"
    )
    assert answer.code == 0, answer.err
    predicted, measured = (
        np.array(columns_of((desk / name).read_text(encoding="utf-8"))[HEIGHT], float)
        for name in ("shown.csv", "held_out.csv")
    )
    errors = (predicted - measured)[1:] * 1e3  # the first row is that of the record
    noise = case.record.noise.sd[POSITION] * 1e6
    assert np.sqrt(np.mean(errors**2)) < 1.1 * noise


# A gauge that is off


def moved(columns: Columns, millimetres: float) -> Columns:
    """A gauge that was set to zero elsewhere."""
    return {**columns, HEIGHT: [repr(float(cell) + millimetres) for cell in columns[HEIGHT]]}


@pytest.fixture(scope="session")
def sound(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Columns]:
    """A press with nothing wrong but its parts, within their tolerances."""
    folder = tmp_path_factory.mktemp("sound press")
    write_case(make_case(1, NOTHING_WRONG), folder)
    return folder, columns_of((folder / "measured.csv").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def off(sound: tuple[Path, Columns]) -> Diagnosed:
    """Its gauge reads 5 mm too much."""
    return diagnose_here(sound[0], "off", text_of(moved(sound[1], 5)))


def reliability(inputs: Path) -> Any:
    results = truing.load("press_linkage").run(inputs, set=ODDS, progress=False).document
    return results["studies"]["reliability"], results["checks"], results["results"]


def test_a_gauge_that_is_off_fails_no_machine(sound: tuple[Path, Columns], off: Diagnosed) -> None:
    (cause,) = off.document["causes"]
    assert cause["effect"] == "sensor_offset"
    low, high = cause["unknowns"]["slider_position"]["interval95"]
    assert low < 5 < high
    assert high - low < 0.3
    assert reliability(off.folder / "extended.toml") == reliability(sound[0] / "inputs.toml")


# Several files, rows held out


def test_a_gauge_that_was_set_anew_for_each_file(sound: tuple[Path, Columns]) -> None:
    folder, columns = sound
    (folder / "each.toml").write_text(INPUTS + 'per_file = ["sensor_offset"]\n', encoding="utf-8")
    parts = {"monday": (range(60), 5.0), "friday": (range(60, 120), -3.0)}
    for name, (rows, offset) in parts.items():
        (folder / f"{name}.csv").write_text(text_of(moved(taken(columns, rows), offset)), encoding="utf-8")
    command = ("diagnose", "press_linkage", "--inputs", "each.toml", "--data", "monday.csv", "--data", "friday.csv")
    answer = calc_here(folder, *command)
    assert (answer.code, answer.err) == (0, "")
    document = read_document(folder / "runs" / "monday")
    assert [(item["file"], item["used"]) for item in document["files"]] == [("monday.csv", 60), ("friday.csv", 60)]
    assert document["runs"] == 2
    (cause,) = document["causes"]
    assert cause["effect"] == "sensor_offset"
    by_file = cause["unknowns"]["slider_position"]["per_file"]
    extended = (folder / "runs" / "monday" / "extended.toml").read_text(encoding="utf-8")
    for name, (_, offset) in parts.items():
        low, high = by_file[f"{name}.csv"]["interval95"]
        assert low < offset < high
        (written,) = re.findall(rf"^# {name}\.csv: (\S+), 95 % interval from ", extended, re.MULTILINE)
        assert float(written) == pytest.approx(by_file[f"{name}.csv"]["value"], rel=1e-3)
    assert reliability(folder / "runs" / "monday" / "extended.toml")


def test_one_offset_for_two_files_is_something_else(sound: tuple[Path, Columns]) -> None:
    """Without being told, no offset of one gauge explains both files: it is not named alone as if it did."""
    folder, columns = sound
    halves = [moved(taken(columns, range(60)), 5), moved(taken(columns, range(60, 120)), -3)]
    for name, half in zip(("first", "second"), halves, strict=True):
        (folder / f"{name}.csv").write_text(text_of(half), encoding="utf-8")
    document = documented(folder, "press_linkage", "first.csv", "second.csv")
    assert names(document) != ["sensor_offset"] or document["remainder"] is not None
    assert document["explanations"]


def test_rows_that_only_judge_change_nothing_that_is_learnt(desk: Path, found: Diagnosed, tmp_path: Path) -> None:
    (tmp_path / "inputs.toml").write_text(INPUTS + 'hold_out = "record = validation"\n', encoding="utf-8")
    columns = columns_of((desk / "measured.csv").read_text(encoding="utf-8"))
    columns["record"] = ["validation" if row % 4 == 3 else "fit" for row in range(90)]
    shifted = {
        row: float(cell) + 0.5 * (columns["record"][row] == "validation") for row, cell in enumerate(columns[HEIGHT])
    }
    diagnosed = diagnose_here(tmp_path, "measured", text_of(columns))
    answer, as_it_was = diagnosed.answer, diagnosed.document
    spoilt_columns = {**columns, HEIGHT: [repr(cell) for cell in shifted.values()]}
    (tmp_path / "spoilt.csv").write_text(text_of(spoilt_columns), encoding="utf-8")
    spoilt = documented(tmp_path, "press_linkage", "spoilt.csv")
    assert answer.err == "note: 22 rows only judge: record = validation\n"
    assert names(as_it_was) == ["link_heating"]
    for name in ("causes", "calibrated", "wrong", "alternatives", "remainder", "smallest_visible"):
        assert spoilt[name] == as_it_was[name]
    held = [document["gain"][POSITION]["held_out"] for document in (as_it_was, spoilt)]
    after = [item["rmse_after"]["value"] for item in held]
    noise = found.document["wrong"][POSITION]["noise_floor"]["value"]
    assert after[0] < 1.4 * noise < held[0]["rmse_before"]["value"]
    assert after[1] == pytest.approx(500, rel=0.02)
