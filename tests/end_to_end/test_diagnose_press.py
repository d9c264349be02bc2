"""A press with something hidden in it, from a measured file to the extended model, and on through every verb."""

from __future__ import annotations

import json
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
    taken,
    text_of,
)

import truing
from hidden_effects.asking import write_case
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


def test_what_was_hidden_is_named_with_its_size(case: Case, desk: Path, heated: Diagnosed) -> None:
    """On the terminal, on both sheets and in diagnosis.json, which keeps its contract."""
    document = heated.document
    (cause,) = document["causes"]
    assert (cause["effect"], cause["same_as"]) == ("link_heating", ["side_heating"])
    hidden = case.hidden["link_heating"]["expansion"] * 1e6
    unknown = cause["unknowns"]["expansion"]
    assert unknown["unit"] == "um/(m*K)"
    assert unknown["interval95"][0] < hidden < unknown["interval95"][1]
    assert (document["verdict"], document["unique"]) == ("one_of", False)
    assert (document["rows"], document["runs"], document["measured"]) == (90, 1, [POSITION])
    assert document["wrong"][POSITION]["noise_floor"]["value"] == pytest.approx(
        case.record.noise.sd[POSITION] * 1e6, rel=3 / np.sqrt(2 * 90)
    )
    demand_contract(document, json.loads(calc_here(desk, "describe", "press_linkage", "--json").out))
    chapters = ("1 What is wrong", "2 Cause", "3 Extended model", "4 Gain", "5 Next")
    written = f"extended model: {Path('runs', 'measured', 'extended.toml')}"
    for words in ("One of 2 causes; this record cannot say which.", "link heating", *chapters, written):
        assert words in heated.answer.out
    assert {path.name for path in heated.folder.iterdir()} == CONTRACT | {"extended.toml"}
    assert list(json.loads((heated.folder / "run.json").read_text(encoding="utf-8"))["data"]) == ["measured.csv"]
    for sheet, words in (("sheet.html", ("link heating", "<svg")), ("sheet.md", ("link heating",))):
        assert all(word in (heated.folder / sheet).read_text(encoding="utf-8") for word in words)


def test_the_extended_model_runs(desk: Path, heated: Diagnosed) -> None:
    """Heights of the slider at the bottom, cold and as warm as it was measured, by exact geometry."""
    results = {}
    for name in ("inputs.toml", str(heated.folder / "extended.toml")):
        answer = calc_here(desk, "run", "press_linkage", "--inputs", name, "-o", "run", "--set", "studies.run=[]")
        assert answer.code == 1, answer.err  # its limits on chances stay undecided
        assert "warning" not in answer.err
        results[name] = json.loads((desk / "run" / "results.json").read_text(encoding="utf-8"))
    cold, warm = results.values()
    assert cold["effects"] == {}
    expansion = heated.document["causes"][0]["unknowns"]["expansion"]["value"]
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


def test_rows_held_out_are_predicted_to_about_the_noise(case: Case, desk: Path, heated: Diagnosed) -> None:
    extended = heated.folder / "extended.toml"
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


def test_one_offset_for_two_files_is_something_else(sound: tuple[Path, Columns]) -> None:
    """Without being told, no offset of one gauge explains both files: it is not named alone as if it did."""
    folder, columns = sound
    halves = [moved(taken(columns, range(60)), 5), moved(taken(columns, range(60, 120)), -3)]
    for name, half in zip(("first", "second"), halves, strict=True):
        (folder / f"{name}.csv").write_text(text_of(half), encoding="utf-8")
    document = documented(folder, "press_linkage", "first.csv", "second.csv")
    assert names(document) != ["sensor_offset"] or document["remainder"] is not None
    assert document["explanations"]
