"""The Python API: what the command line does, as calls; the same numbers, the same sentences."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pint
import pytest
from matplotlib.figure import Figure

import truing
from shared import TESTS, Calc

PIN = TESTS / "data" / "pin_wear.py"
PRESS = TESTS.parent / "docs" / "examples" / "press_off_by_40_um"


@pytest.fixture(scope="module")
def pin() -> truing.LoadedModel:
    return truing.load(PIN)


@pytest.fixture(scope="module")
def press() -> truing.LoadedModel:
    return truing.load("press_linkage")


@pytest.fixture(scope="module")
def diagnosis(press: truing.LoadedModel) -> truing.Diagnosis:
    return press.diagnose(truing.read(PRESS / "measured.csv", press), PRESS / "inputs.toml")


def test_a_run_has_the_numbers_of_the_command_line(pin: truing.LoadedModel, calc: Calc, tmp_path: Path) -> None:
    saved = pin.run(load="84 N", seed=1).save(tmp_path / "here")
    assert calc("run", PIN, "--set", "load=84 N", "--set", "seed=1", "-o", tmp_path / "there", "-q").code == 0
    assert sorted(file.name for file in saved.iterdir()) == sorted(file.name for file in (tmp_path / "there").iterdir())
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (saved / name).read_bytes() == (tmp_path / "there" / name).read_bytes(), name


def test_results_are_quantities_in_the_unit_that_is_printed(pin: truing.LoadedModel) -> None:
    run = pin.run(load="84 N")
    pressure = run["pressure"]
    assert str(pressure.units) == "megapascal"
    assert pressure.magnitude == pytest.approx(84 / 28)  # N/mm2
    assert run.si["pressure"] == pytest.approx(84 / 28e-6)
    assert str(run["tolerance_price"].units) == "EUR"
    assert (run.verdict, run.passed) == ("passes", True)
    assert [check.passed for check in run.checks] == [True]


@pytest.mark.parametrize(
    "load", ["84 N", "0.084 kN", 84, np.float64(84), pint.get_application_registry().Quantity(84.0, "newton")], ids=str
)
def test_a_value_is_a_text_a_number_or_a_quantity(pin: truing.LoadedModel, load: Any) -> None:
    assert pin.run(load=load).si["pressure"] == pytest.approx(84 / 28e-6)


def test_draws_are_those_of_the_studies_that_draw(pin: truing.LoadedModel) -> None:
    studies = pin.setup(draws=4096).studies
    assert [study.draws for study in studies if hasattr(study, "draws")] == [4096]


def test_an_inputs_file_and_values_in_its_place(pin: truing.LoadedModel, tmp_path: Path) -> None:
    file = tmp_path / "pin.toml"
    file.write_text('[inputs]\nload = "70 N"\narea = "14 mm^2"\n', encoding="utf-8")
    assert pin.run(file).si["pressure"] == pytest.approx(5e6)
    assert pin.run(file, load="84 N").si["pressure"] == pytest.approx(6e6)
    assert pin.given(load="84 N").run(file).si["pressure"] == pytest.approx(6e6)


def test_a_table_of_results(pin: truing.LoadedModel) -> None:
    frame = pin.run(load="84 N").frame().set_index("name")
    assert frame.loc["pressure", ["symbol", "unit", "note"]].tolist() == ["p", "MPa", "contact pressure"]
    assert frame.loc["pressure", "value"] == pytest.approx(3)


def test_a_sweep_and_a_study_of_ones_own(pin: truing.LoadedModel) -> None:
    swept = pin.sweep("load", "56 N", "84 N", 3)
    assert swept.axis.tolist() == pytest.approx([56, 70, 84])
    assert swept.results["pressure"] == pytest.approx([2e6, 2.5e6, 3e6])
    odds = pin.study(truing.Sensitivity(name="mine"))
    assert odds.name == "mine"


def test_rows_of_a_dataframe_come_back_with_their_results(pin: truing.LoadedModel) -> None:
    rows = pd.DataFrame({"load [N]": [56.0, 84.0, 84_000.0], "who": ["a", "b", "c"]}, index=[7, 8, 8])
    made = pin.evaluate(rows)
    assert list(made.index) == [7, 8, 8]
    assert made["pressure [MPa]"].tolist()[:2] == pytest.approx([2, 3])
    assert made["who"].tolist() == ["a", "b", "c"]
    assert made["fault"].tolist()[:2] == ["", ""]
    assert np.isnan(made["pressure [MPa]"].tolist()[2])
    assert made["fault"].tolist()[2].startswith("the contact flows")
    assert pin.evaluate(rows.rename(columns={"load [N]": "load"}), units={"load": "N"})["pressure [MPa]"].tolist()[
        :2
    ] == pytest.approx([2, 3])


REFUSED: list[tuple[Callable[[truing.LoadedModel], Any], str]] = [
    (lambda pin: pin.run(lod=3), "lod=3: pin_wear has no input 'lod'. Did you mean 'load'"),
    (lambda pin: pin.run(load="3 kg"), "load=3 kg: load: '3 kg' is a mass (kg), expected a force (N)"),
    (lambda pin: pin.run(load=pint.get_application_registry()("3 kg")), "load: 3 kilogram cannot be written in N"),
    (lambda pin: pin.run(load=None), "load: None is no text, number or quantity"),
    (lambda pin: pin.run(load=float("nan")), "load=nan N: load: 'nan N' is not a finite number"),
    (lambda pin: pin.run("absent.toml"), "absent.toml"),
    (lambda pin: pin.run()["lod"], "pin_wear has no result 'lod'"),
    (lambda pin: pin.sweep("load", "1 N", "2 kN"), "a sweep from '1 N' to '2 kN': write both ends in one unit"),
    (lambda pin: pin.evaluate(pd.DataFrame({"load": [1.0]})), "dataframe:1: column 'load' has no unit"),
    (
        lambda pin: pin.evaluate(pd.DataFrame({"load [kg]": [1.0]})),
        "dataframe:1: column 'load [kg]': 'kg' is a mass (kg), expected a force (N)",
    ),
    (lambda pin: pin.evaluate(pd.DataFrame({"load [N]": [1.0, float("nan")]})), "dataframe:3: load: 'nan'"),
    (lambda pin: pin.evaluate(pd.DataFrame({"load [N]": [1.0, None]}, dtype=object)), "row 2 of the dataframe holds"),
    (lambda pin: pin.evaluate(pd.DataFrame({"load [N]": []})), "the dataframe holds no rows"),
    (lambda pin: pin.evaluate(pd.DataFrame({"load [N]": [1.0, "x"]})), "dataframe:3: load: 'x' is no number"),
    (lambda pin: pin.evaluate(pd.DataFrame({"load": [1.0]}), units={"lod": "N"}), "units names 'lod', which is no"),
    (lambda pin: pin.evaluate({"load": [1.0]}), "dict is no dataframe of pandas, polars, pyarrow"),
    (lambda pin: truing.load("nobody"), "no plugin offers 'nobody'"),
    (lambda pin: truing.load("nobody.py"), "nobody.py: no such file"),
    (lambda pin: truing.record(pd.DataFrame({"load [N]": [1.0]}), pin), "measured"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_a_file_refuses_is_refused_in_the_same_words(
    pin: truing.LoadedModel, call: Callable[[truing.LoadedModel], Any], words: str
) -> None:
    with pytest.raises(truing.TruingError) as caught:
        call(pin)
    assert words in str(caught.value)


def test_a_diagnosis_names_the_cause_with_its_size(diagnosis: truing.Diagnosis) -> None:
    (cause,) = diagnosis.causes
    low, high = cause.unknowns["clearance"].interval95
    assert (diagnosis.verdict, cause.effect) == ("named", "joint_clearance")
    assert low is not None
    assert high is not None
    assert low <= 6.0 <= high  # um: what the page says was hidden
    assert str(cause.unknowns["clearance"].quantity.units) == "micrometer"
    assert diagnosis.ranking.frame()["explanation"].tolist()[0] == "joint clearance"
    assert isinstance(diagnosis.residuals.plot(), Figure)
    assert isinstance(diagnosis.ranking.plot(), Figure)


def test_a_diagnosis_is_that_of_the_command_line(diagnosis: truing.Diagnosis, calc: Calc, tmp_path: Path) -> None:
    there = tmp_path / "there"
    asked = ("diagnose", "press_linkage", "-i", PRESS / "inputs.toml", "-d", PRESS / "measured.csv", "-o", there, "-q")
    assert calc(*asked).code == 0
    saved = diagnosis.save(tmp_path / "here")
    assert json.loads((saved / "diagnosis.json").read_text("utf-8")) == json.loads(
        (there / "diagnosis.json").read_text("utf-8")
    )
    assert (saved / "extended.toml").read_text("utf-8") == (there / "extended.toml").read_text("utf-8")


def test_a_dataframe_is_a_record_too(diagnosis: truing.Diagnosis, press: truing.LoadedModel) -> None:
    rows = pd.read_csv(PRESS / "measured.csv")
    bare = rows.rename(columns=lambda name: name.partition(" ")[0])
    units = {name.partition(" ")[0]: name.partition("[")[2].rstrip("]") for name in rows.columns}
    record = truing.record(bare, press, units=units)
    found = press.diagnose(record, PRESS / "inputs.toml", budget=0)
    assert found.document["causes"] == diagnosis.document["causes"]
    assert len(record.frame()) == len(rows)


def test_the_extended_model_is_a_model_again(diagnosis: truing.Diagnosis) -> None:
    better = diagnosis.extended.setup()
    assert [on.effect.name for on in better.effects] == ["joint_clearance"]
    assert better.effects[0].values["clearance"] == pytest.approx(
        diagnosis.result.causes[0].unknowns[0].value, rel=1e-5
    )


def test_what_a_notebook_shows_is_small_inert_and_escaped(diagnosis: truing.Diagnosis, pin: truing.LoadedModel) -> None:
    for shown in (pin.run(load="84 N"), diagnosis):
        html = shown._repr_html_()
        assert len(html) < 100_000
        assert not any(word in html.lower() for word in ("<script", "http", "src=", "onload"))
    hostile = truing.load(TESTS / "data" / "hostile_pin.py").run(TESTS / "data" / "hostile_pin.toml")
    assert "<script" not in hostile._repr_html_().lower()


def test_sheets_are_written_on_request(diagnosis: truing.Diagnosis, pin: truing.LoadedModel, tmp_path: Path) -> None:
    for shown in (pin.run(load="84 N"), diagnosis):
        assert shown.sheet(tmp_path / "a.html").read_text("utf-8").startswith("<!DOCTYPE html>")
        assert shown.sheet(tmp_path / "a.md").read_text("utf-8").startswith("# ")


def test_one_model_of_several_is_named_with_its_plugin() -> None:
    assert truing.load("harmonic_fractal.made_flank").name == "harmonic_fractal.made_flank"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert truing.load("press_linkage.press_linkage").name == "press_linkage"
