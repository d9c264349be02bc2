"""The measured machines of the manual: made again byte for byte, and diagnosed to what their READMEs say."""

from __future__ import annotations

import re
from pathlib import Path

import make_examples
import pytest
from measured import Document, documented, names, read_document
from shown_in_docs import EXAMPLES, ROOT

from truing.diagnosis import choice
from truing.diagnosis.noise import SETTINGS

PLAY = EXAMPLES / "press_off_by_40_um"
WARM = EXAMPLES / "press_warm_links"
SCREW = EXAMPLES / "roller_screw_rubs"
REDUCER_PAGE = ROOT / "docs" / "how-to" / "true_a_reducer.md"
REFERENCE = ROOT / "docs" / "reference" / "verbs" / "diagnose.md"
METHOD = ROOT / "docs" / "explanation" / "diagnosis.md"


@pytest.fixture(scope="module")
def document(play: Path) -> Document:
    return read_document(play)


def stated(example: Path, unit: str) -> float:
    """The hidden size that the README of an example prints in bold."""
    (number,) = re.findall(rf"\*\*([\d.]+) {re.escape(unit)}\*\*", (example / "README.md").read_text(encoding="utf-8"))
    return float(number)


@pytest.mark.parametrize(("name", "text"), make_examples.files().items(), ids=make_examples.files())
def test_the_shipped_rows_are_those_that_the_script_makes(name: str, text: str) -> None:
    assert (EXAMPLES / name).read_bytes() == text.encode()


def test_the_readmes_state_what_was_hidden() -> None:
    play, warm = make_examples.PRESSES
    assert play.hidden == {"joint_clearance": {"clearance": pytest.approx(stated(PLAY, "µm") * 1e-6)}}
    assert warm.hidden == {"link_heating": {"expansion": pytest.approx(stated(WARM, "µm/(m·K)") * 1e-6)}}


def test_the_cause_is_named_with_its_size(document: Document) -> None:
    (cause,) = document["causes"]
    assert (document["verdict"], document["unique"], cause["effect"]) == ("named", True, "joint_clearance")
    clearance = cause["unknowns"]["clearance"]
    assert clearance["unit"] == "um"
    assert clearance["interval95"][0] < stated(PLAY, "µm") < clearance["interval95"][1]
    assert clearance["interval95"][1] - clearance["interval95"][0] < 0.3


def test_the_error_falls_to_the_scatter_of_the_gauge(document: Document) -> None:
    gained = document["gain"]["slider_position"]
    assert gained["rmse_before"]["value"] > 20
    assert gained["rmse_after"]["value"] == pytest.approx(
        make_examples.PRESS_NOISE.sd["slider_position"] * 1e6, rel=0.2
    )


def interval_shown(page: str, words: str, unit: str) -> tuple[float, float]:
    """The interval of the last diagnosis of a page, which is run elsewhere."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    low, high = re.findall(rf"{words} [\d.]+ {re.escape(unit)} \(95 %: ([\d.]+) … ([\d.]+)\)\.", text)[-1]
    return float(low), float(high)


def test_the_page_shows_what_tuesday_tells_apart_with_its_hidden_size() -> None:
    page = "how-to/measure_to_tell_causes_apart.md"
    low, high = interval_shown(page, "link heating, expansion", "µm/(m·K)")
    assert low < stated(WARM, "µm/(m·K)") < high


@pytest.mark.parametrize("verdict", ["none", "undecided", "named", "one_of", "unknown"])
def test_every_verdict_is_explained(verdict: str) -> None:
    assert f'| `"{verdict}"` |' in REFERENCE.read_text(encoding="utf-8")


def test_the_explanation_states_the_levels_in_force() -> None:
    text = " ".join(METHOD.read_text(encoding="utf-8").split())
    words = {13: "Thirteen"}
    for said in (
        f"Something is there if it is at most {choice.ANY_LEVEL}",
        f"with what is believed so far as what is true, at {choice.FURTHER_LEVEL}",
        f"{choice.DRAWS} records are simulated",
        f"whose score is within {choice.CLOSE:g} (",
        f"{words[len(SETTINGS)]} such filters are tried",
    ):
        assert said in text


# The reducer and the roller screw


def stated_factor(example: Path) -> float:
    """The hidden factor that the README of an example prints in bold."""
    (number,) = re.findall(r"\*\*([\d.]+)\*\*", (example / "README.md").read_text(encoding="utf-8"))
    return float(number)


def test_the_page_shows_two_names_of_one_curve_with_the_hidden_size() -> None:
    """The page is run elsewhere; here what it prints is compared with what was hidden."""
    alone, opened = REDUCER_PAGE.read_text(encoding="utf-8").split("## With the wear of a flank")
    assert "One of 5 causes; this record cannot say which." in alone
    assert "One of 2 causes; this record cannot say which." in opened
    assert "is drawn alike by pin rolling or duty share." in opened
    ((low, high),) = re.findall(r"pin rolling, rolling \S+ \(95 %: ([\d.]+) … ([\d.]+)\)", opened)
    assert float(low) < stated_factor(EXAMPLES / "reducer_wears_slowly") < float(high)


def test_one_way_at_one_load_friction_is_a_gauge_that_is_off() -> None:
    found = documented(SCREW, "roller_screw_shift", "one_way.csv")
    (cause,) = found["causes"]
    assert {cause["effect"], *cause["same_as"]} == {"sensor_offset", "mesh_friction"}
    asked = found["next"][0]
    assert set(asked["separates"]) == {"sensor_offset", "mesh_friction"}
    assert asked["settings"]["axial_load"]["value"] == pytest.approx(20.0)
    assert asked["settings"]["screw_speed"]["value"] < 0


def test_to_and_fro_under_any_load_it_is_friction() -> None:
    found = documented(SCREW, "roller_screw_shift", "measured.csv")
    assert (found["verdict"], found["unique"]) == ("named", True)
    assert names(found) == ["mesh_friction"]
    low, high = found["causes"][0]["unknowns"]["factor"]["interval95"]
    assert low < stated_factor(SCREW) < high
