"""The measured presses of the manual: made again byte for byte, and diagnosed to what their READMEs say."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import make_press_example
import pytest
from measured import Diagnosed, calc_here, names, read_document
from shown_in_docs import EXAMPLES, ROOT

from truing.diagnosis import chance, choice, steps
from truing.diagnosis.noise import SETTINGS

PLAY = EXAMPLES / "press_off_by_40_um"
WARM = EXAMPLES / "press_warm_links"
REFERENCE = ROOT / "docs" / "reference" / "verbs" / "diagnose.md"
METHOD = ROOT / "docs" / "explanation" / "diagnosis.md"


def stated(example: Path, unit: str) -> float:
    """The hidden size that the README of an example prints in bold."""
    (number,) = re.findall(rf"\*\*([\d.]+) {re.escape(unit)}\*\*", (example / "README.md").read_text(encoding="utf-8"))
    return float(number)


def diagnosed(example: Path, desk: Path, *files: str) -> Diagnosed:
    """Diagnose files of an example in a folder of our own, as its README says."""
    shutil.copytree(example, desk, dirs_exist_ok=True)
    data = [word for file in files for word in ("--data", file)]
    answer = calc_here(desk, "diagnose", "press_linkage", "--inputs", "inputs.toml", *data)
    assert (answer.code, answer.err) == (0, "")
    folder = desk / "runs" / Path(files[0]).stem
    return Diagnosed(answer, read_document(folder), folder)


@pytest.fixture(scope="module")
def play(tmp_path_factory: pytest.TempPathFactory) -> Diagnosed:
    return diagnosed(PLAY, tmp_path_factory.mktemp("play"), "measured.csv")


@pytest.mark.parametrize("press", make_press_example.PRESSES, ids=lambda press: str(press.seed))
def test_the_shipped_rows_are_those_that_the_script_makes(press: make_press_example.Press) -> None:
    for name, text in make_press_example.files(press).items():
        assert (EXAMPLES / name).read_bytes() == text.encode()


def test_the_readmes_state_what_was_hidden() -> None:
    play, warm = make_press_example.PRESSES
    assert play.hidden == {"joint_clearance": {"clearance": pytest.approx(stated(PLAY, "µm") * 1e-6)}}
    assert warm.hidden == {"link_heating": {"expansion": pytest.approx(stated(WARM, "µm/(m·K)") * 1e-6)}}


def test_the_cause_is_named_with_its_size(play: Diagnosed) -> None:
    (cause,) = play.document["causes"]
    assert (play.document["verdict"], play.document["unique"], cause["effect"]) == ("named", True, "joint_clearance")
    clearance = cause["unknowns"]["clearance"]
    assert clearance["unit"] == "um"
    assert clearance["interval95"][0] < stated(PLAY, "µm") < clearance["interval95"][1]
    assert clearance["interval95"][1] - clearance["interval95"][0] < 0.3


def test_the_error_falls_to_the_scatter_of_the_gauge(play: Diagnosed) -> None:
    gained = play.document["gain"]["slider_position"]
    assert gained["rmse_before"]["value"] > 20
    assert gained["rmse_after"]["value"] == pytest.approx(make_press_example.NOISE.sd["slider_position"] * 1e6, rel=0.2)


def test_the_extended_model_runs_and_its_reliability_is_that_of_presses_with_play(play: Diagnosed) -> None:
    """Under load the slider of every press stands too high by 2c on each link: some 35 um, against limits of 20 um."""
    desk = play.folder.parents[1]
    chances = {}
    for inputs in ("inputs.toml", "runs/measured/extended.toml"):
        words = ("--set", 'studies.run=["reliability"]', "--set", "forming_force=600 kN", "-o", "run")
        answer = calc_here(desk, "run", "press_linkage", "--inputs", inputs, *words)
        assert answer.code in {0, 1}, answer.err
        results = json.loads((desk / "run" / "results.json").read_text(encoding="utf-8"))["results"]
        chances[inputs] = results["position_reliability"]["value"]
    drawn, with_play = chances.values()
    assert 0.1 < with_play < 0.7 * drawn


def test_under_load_of_one_sign_the_play_hides_in_the_tolerances(play: Diagnosed) -> None:
    desk = play.folder.parents[1]
    header, *rows = (desk / "measured.csv").read_text(encoding="utf-8").splitlines()
    kept = [row for row in rows if float(row.split(",")[1]) > 0]
    (desk / "loaded.csv").write_text("\n".join([header, *kept]) + "\n", encoding="utf-8")
    assert calc_here(desk, "diagnose", "press_linkage", "--inputs", "inputs.toml", "--data", "loaded.csv").code == 0
    document = read_document(desk / "runs" / "loaded")
    assert document["explanations"] == []
    assert "joint_clearance" in document["hidden_in_tolerances"]
    assert any("forming_force never changed its sign" in sentence for sentence in document["inseparable"])


def test_what_ties_on_monday_is_told_apart_by_twelve_rows_of_tuesday(tmp_path: Path) -> None:
    monday = diagnosed(WARM, tmp_path / "monday", "monday.csv").document
    assert not monday["unique"]
    tied = {*names(monday), *(name for item in monday["alternatives"] for name in item["causes"])}
    assert {"link_heating", "thermal_drift"} <= tied
    assert monday["next"][-1]["separation"] > 10
    both = diagnosed(WARM, tmp_path / "both", "monday.csv", "tuesday.csv").document
    assert names(both) == ["link_heating"]
    assert both["alternatives"] == []
    assert [set(tie["explanations"]) for tie in both["ties"]] == [{"link_heating", "side_heating"}]
    low, high = both["causes"][0]["unknowns"]["expansion"]["interval95"]
    assert low < stated(WARM, "µm/(m·K)") < high


def keys(document: Any, own: set[str]) -> Iterator[str]:
    """The names of the fields, without those that name things of this press."""
    if isinstance(document, dict):
        for name, value in document.items():
            if name not in own:
                yield name
            yield from keys(value, own)
    elif isinstance(document, list):
        for value in document:
            yield from keys(value, own)


def test_every_field_of_diagnosis_json_is_explained(play: Diagnosed) -> None:
    document = play.document
    own = {*document["measured"], *document["covariates"], *document["calibrated"], *document["not_measured"]}
    own |= {*document["smallest_visible"]} | {"name", "version", "model", "line", "file", "clearance"}
    own |= {name for item in document["ranking"] for name in item["causes"]}
    own |= {name for item in document["ranking"] for unknowns in item["unknowns"].values() for name in unknowns}
    text = REFERENCE.read_text(encoding="utf-8")
    missing = {name for name in keys(document, own) if not re.search(rf"`(?:{name}|[^`]*\.{name})`", text)}
    assert not missing


@pytest.mark.parametrize("verdict", ["none", "undecided", "named", "one_of", "unknown"])
def test_every_verdict_is_explained(verdict: str) -> None:
    assert f'| `"{verdict}"` |' in REFERENCE.read_text(encoding="utf-8")


def test_the_explanation_states_the_levels_in_force() -> None:
    text = " ".join(METHOD.read_text(encoding="utf-8").split())
    words = {13: "Thirteen"}
    for said in (
        f"Something is there if it is at most {steps.ANY_LEVEL}",
        f"with what is believed so far as what is true, at {steps.FURTHER_LEVEL}",
        f"{chance.DRAWS} records are simulated",
        f"whose score is within {choice.CLOSE:g} (",
        f"{words[len(SETTINGS)]} such filters are tried",
    ):
        assert said in text
