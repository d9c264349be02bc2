"""The Python API: what the command line does, as calls; the same numbers, the same sentences."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pint
import pytest
from matplotlib.figure import Figure
from measured import calc_here, read_document
from shown_in_docs import Desk

import truing
from shared import ROOT, TESTS, Calc, process
from truing.studies.sweep import Swept

PIN = TESTS / "data" / "pin_wear.py"
EXAMPLES = TESTS.parent / "docs" / "examples"
PRESS = EXAMPLES / "press_off_by_40_um"
LOSS = 2.5e-4
"""What the page hides in the record of the spring: the loss of shear modulus in 1/K."""


@pytest.fixture(scope="module")
def pin() -> truing.LoadedModel:
    return truing.load(PIN)


@pytest.fixture(scope="module")
def press() -> truing.LoadedModel:
    return truing.load("press_linkage")


def test_the_first_lines_that_a_user_writes(listing_done: Desk) -> None:
    """The listing by which the API was designed is run as its page shows it; here its numbers are looked at."""
    run, table, found, better = (listing_done.namespace[name] for name in ("run", "table", "found", "better"))
    assert str(run["stress"].units) == "megapascal"
    assert run.si["stress"] == pytest.approx(714.6022644e6)  # K 8 F D / (pi d^3) by hand, K = 34 / 29
    assert [check.passed for check in run.checks] == [False, True]
    assert (run.passed, run.verdict) == (False, "fails")
    assert "stress" in run.frame()["name"].tolist()
    assert (listing_done.folder / "spring.html").is_file()
    assert (listing_done.folder / "runs" / "spring" / "results.json").is_file()
    assert table["force [N]"].tolist() == pytest.approx([2.493286 * travel for travel in table["compression [mm]"]])
    assert {"inputs", "effects"} <= set(better.run().compare(run).frame()["what"])
    assert "softening" in found._repr_html_()


def test_a_run_has_the_numbers_of_the_command_line(pin: truing.LoadedModel, calc: Calc, tmp_path: Path) -> None:
    saved = pin.run(load="84 N", seed=1).save(tmp_path / "here")
    written = pin.run(load="84 N", seed=1, output=tmp_path / "at once", excel=True)
    assert calc("run", PIN, "--set", "load=84 N", "--set", "seed=1", "-o", tmp_path / "there", "-q").code == 0
    assert sorted(file.name for file in saved.iterdir()) == sorted(file.name for file in (tmp_path / "there").iterdir())
    for name in ("results.json", "inputs.toml", "sheet.md"):
        assert (saved / name).read_bytes() == (tmp_path / "there" / name).read_bytes(), name
        assert (tmp_path / "at once" / name).read_bytes() == (saved / name).read_bytes(), name
    assert written.document == json.loads((saved / "results.json").read_text("utf-8"))
    assert (tmp_path / "at once" / "results.csv").is_file()


@pytest.mark.parametrize(
    "load", ["84 N", "0.084 kN", 84, np.float64(84), pint.get_application_registry().Quantity(84.0, "newton")], ids=str
)
def test_a_value_is_a_text_a_number_or_a_quantity(pin: truing.LoadedModel, load: Any) -> None:
    assert pin.run(load=load).si["pressure"] == pytest.approx(84 / 28e-6)


TAKEN = """
from truing import Float, Model, found, given, hookimpl, inputs, results

@inputs
class Given:
    draws: Float = given(1.0, "mm")
    workers: Float = given(1.0, "mm")

@results
class Answer:
    sum: Float = found("mm", formula="draws + workers")

def add(item: Given) -> Answer:
    return Answer(sum=item.draws + item.workers)

@hookimpl
def truing_models():
    return [Model(name="taken", title="Names that are taken", function=add)]
"""


def test_an_input_may_be_called_like_an_argument(tmp_path: Path) -> None:
    (tmp_path / "taken.py").write_text(TAKEN, encoding="utf-8")
    taken = truing.load(tmp_path / "taken.py")
    assert taken.run(set={"draws": "3 mm", "workers": "4 mm"}).si["sum"] == pytest.approx(7e-3)
    assert taken.run(draws="3 mm").si["sum"] == pytest.approx(4e-3)
    swept = taken.sweep("workers", (1, 3), points=3)
    assert swept.frame()["sum [mm]"].tolist() == pytest.approx([2, 3, 4])


def test_a_budget_of_ones_own_leaves_a_sheet_and_its_options_stand_in_a_file(tmp_path: Path) -> None:
    spring = ROOT / "docs" / "examples" / "coil_spring.py"
    asked = truing.Uncertainty(of="stress", degrees={"wire_diameter": 9.0}, draws=0)
    budget = truing.load(spring).study(asked, output=tmp_path / "budget")
    assert isinstance(budget.outcome, truing.Budgets)
    page = (tmp_path / "budget" / "sheet.md").read_text(encoding="utf-8")
    assert page.count(budget.outcome.sentence("stress")) == 2  # above and below the table
    assert "JCGM 100:2008" in page
    assert "**Uncertainty budget of the stress**" in page
    assert not (tmp_path / "budget" / "points.csv").exists()
    declares = "from dataclasses import replace\n" + spring.read_text(encoding="utf-8").replace(
        "return [COIL_SPRING]", "return [replace(COIL_SPRING, studies=[Uncertainty()], sheet=[])]"
    ).replace("    Unknown,", "    Uncertainty,\n    Unknown,")
    (tmp_path / "declares.py").write_text(declares, encoding="utf-8")
    options = {"of": "stress", "degrees": "{ wire_diameter = 9 }", "draws": "0"}
    run = truing.load(tmp_path / "declares.py").run(
        output=tmp_path / "run", set={f"studies.uncertainty.{name}": text for name, text in options.items()}
    )
    assert run.document["studies"]["uncertainty"] == budget.document["studies"]["uncertainty"]
    again = truing.load(tmp_path / "declares.py").run(tmp_path / "run" / "inputs.toml")
    assert again.document == run.document


def test_an_inputs_file_and_values_in_its_place(pin: truing.LoadedModel, tmp_path: Path) -> None:
    file = tmp_path / "pin.toml"
    file.write_text('[inputs]\nload = "70 N"\narea = "14 mm^2"\n', encoding="utf-8")
    assert pin.run(file).si["pressure"] == pytest.approx(5e6)
    assert pin.run(file, load="84 N").si["pressure"] == pytest.approx(6e6)
    assert pin.given(load="84 N").run(file).si["pressure"] == pytest.approx(6e6)
    rows = pin.evaluate(pd.DataFrame({"load [N]": [84.0]}), file)
    assert rows["pressure [MPa]"].tolist() == pytest.approx([6])


def test_a_sweep_and_a_study_of_ones_own(pin: truing.LoadedModel) -> None:
    swept = pin.sweep("load", ("56 N", "0.084 kN"), points=3)
    frame = swept.frame()
    assert frame["load [N]"].tolist() == pytest.approx([56, 70, 84])
    assert frame["pressure [MPa]"].tolist() == pytest.approx([2, 2.5, 3])
    assert isinstance(swept.outcome, Swept)
    assert swept.outcome.results["pressure"] == pytest.approx([2e6, 2.5e6, 3e6])
    axes = swept.plot("pressure").axes
    assert [label.get_ylabel() for label in axes] == ["pressure, MPa"]
    assert pin.study(truing.Sensitivity(name="mine")).title.endswith("mine")
    with pytest.raises(truing.TruingError, match=r"'presure' is no result along 'load'. Did you mean 'pressure'"):
        swept.plot("presure")
    studies = pin.run(draws=4096).studies
    assert list(studies) == ["sensitivity", "reliability"]
    assert studies["reliability"].frame()["limit kept"].tolist() == ["pressure"]
    assert isinstance(studies["sensitivity"].plot(), Figure)
    with pytest.raises(truing.TruingError, match="this study has no table 'nothing'; it has"):
        studies["reliability"].frame("nothing")


def test_every_row_is_a_case(pin: truing.LoadedModel, calc: Calc, tmp_path: Path) -> None:
    frame = pd.DataFrame({"name": ["light", "heavy", "flat"], "load [N]": [56.0, 84.0, 84_000.0]})
    file = tmp_path / "cases.csv"
    frame.to_csv(file, index=False)
    run = pin.run(cases=file, output=tmp_path / "here")
    assert calc("run", PIN, "--cases", file, "-o", tmp_path / "there", "-q").code == 1
    there = (tmp_path / "there" / "results.json").read_bytes()
    assert (tmp_path / "here" / "results.json").read_bytes() == there
    assert (run.verdict, run.passed) == ("fails", False)
    rows = pin.run(cases=frame).case_frame()
    assert rows["case"].tolist() == ["light", "heavy", "flat"]
    assert rows["pressure [MPa]"].tolist()[:2] == pytest.approx([2, 3])
    assert np.isnan(rows["pressure [MPa]"].tolist()[2])
    assert rows["fault"].tolist()[2].startswith("the contact flows")
    assert rows["verdict"].tolist() == ["passes", "passes", "fails"]
    with pytest.raises(truing.TruingError, match="this run has no cases"):
        pin.run().case_frame()


def test_what_differs_is_told_from_the_one_that_is_named(pin: truing.LoadedModel, calc: Calc, tmp_path: Path) -> None:
    light, heavy = pin.run(load="56 N"), pin.run(load="84 N")
    assert not heavy.compare(heavy)
    frame = heavy.compare(light).frame()
    (load,) = frame[(frame["what"] == "inputs") & (frame["name"] == "load")].to_dict("records")
    assert (load["before"], load["after"], load["change"]) == ("56 N", "84 N", "+50 %")
    light.save(tmp_path / "light")
    heavy.save(tmp_path / "heavy")
    shown = calc("compare", tmp_path / "light", tmp_path / "heavy").out.splitlines()
    assert len(shown) == 1 + len(heavy.compare(light).changes)


def test_what_a_verb_says_is_one_call(pin: truing.LoadedModel, calc: Calc) -> None:
    assert pin.describe() == json.loads(calc("describe", PIN, "--json").out)
    assert pin.example() == calc("init", PIN).out
    assert len(pin.verify()) == len(json.loads(calc("verify", PIN, "--json").out)["rows"])


def interrupting(at: str) -> Callable[[str, int, int], None]:
    """A progress that interrupts a task when half of it is done, and the sheet at once."""

    def interrupt(task: str, done: int, total: int) -> None:
        if task == at and (2 * done >= total or task == "sheet"):
            raise KeyboardInterrupt

    return interrupt


def test_an_interrupt_of_the_work_or_the_writing_leaves_what_there_was(pin: truing.LoadedModel, tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        pin.run(output=tmp_path / "deep" / "run", progress=interrupting("reliability"), draws=100_000)
    assert list(tmp_path.iterdir()) == []
    pin.run(output=tmp_path / "run", load="56 N")
    before = (tmp_path / "run" / "results.json").read_bytes()
    with pytest.raises(KeyboardInterrupt):
        pin.run(output=tmp_path / "run", load="84 N", progress=interrupting("sheet"))
    assert [file.name for file in tmp_path.iterdir()] == ["run"]
    assert (tmp_path / "run" / "results.json").read_bytes() == before


def test_an_interrupted_run_is_taken_up(pin: truing.LoadedModel, tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        pin.run(output=tmp_path / "run", resume=True, progress=interrupting("reliability"), draws=100_000)
    assert [file.name for file in tmp_path.iterdir()] == ["run.partial"]
    taken_up = pin.run(output=tmp_path / "run", resume=True, draws=100_000)
    assert taken_up.computed["resumed"] > 0
    assert [file.name for file in tmp_path.iterdir()] == ["run"]
    assert taken_up.document == pin.run(draws=100_000).document


SCRIPT = """
from truing.executors import open_executor

print("begun")
with open_executor("processes:1") as worker:
    print(worker.submit(abs, -3).result())
"""


def test_a_script_with_workers_runs_once(tmp_path: Path) -> None:
    """Without ``if __name__ == "__main__"``."""
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    answer = process([sys.executable, "script.py"], tmp_path)
    assert (answer.code, answer.out.split()) == (0, ["begun", "3"]), answer.err


REFUSED = [
    (lambda pin: pin.run(lod=3), "lod=3: pin_wear has no input 'lod'. Did you mean 'load'"),
    (lambda pin: pin.run(load=84_000), "load=84000 N: the contact flows"),
    (lambda pin: pin.run(load="3 kg"), "load=3 kg: load: '3 kg' is a mass (kg), expected a force (N)"),
    (lambda pin: pin.run(load=pint.get_application_registry()("3 kg")), "load: 3 kilogram cannot be written in N"),
    (lambda pin: pin.run(load=None), "load: None is no text, number or quantity"),
    (lambda pin: pin.run(load=float("nan")), "load=nan N: load: 'nan N' is not a finite number"),
    (lambda pin: pin.run("absent.toml"), "absent.toml: no such file"),
    (lambda pin: pin.run()["presure"], "pin_wear has no result 'presure'. Did you mean 'pressure'"),
    (lambda pin: pin.sweep("load", "1 N..2 kg"), "the range '1 N..2 kg'"),
    (lambda pin: pin.sweep("lod", (1, 2)), "'lod' is no input of pin_wear. Did you mean 'load'"),
    (lambda pin: pin.run(resume=True), "resume needs output, the folder that is written"),
    (lambda pin: pin.run(workers=2, cluster="tcp://here:1"), "cluster and workers exclude each other"),
    (lambda pin: pin.run(workers=0), "'processes:0' is no place to compute"),
    (lambda pin: pin.run(output=TESTS), "is an existing folder but no run of ours"),
    (lambda pin: pin.run().sheet("sheet.odt"), "sheet.odt: a sheet ends in .html, .md, .pdf or .docx"),
    (lambda pin: pin.diagnose(truing.read("absent.csv", pin)), "absent.csv: no such file"),
    (lambda pin: truing.read([], pin), "no file is named"),
    (lambda pin: pin.diagnose("measured.csv"), "a str is no record; make one with truing.read(files, model)"),
    (lambda pin: pin.run({"load": "3 N"}), "inputs names an inputs file; a dict of values is stated with set="),
    (lambda pin: pin.study("reliability"), "'reliability' is no study; hand in one, such as truing.Sensitivity()"),
    (lambda pin: truing.load("nobody"), "no plugin offers 'nobody'"),
    (lambda pin: truing.load("nobody.py"), "nobody.py: no such file"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_a_file_refuses_is_refused_in_the_same_words(pin: truing.LoadedModel, call: Any, words: str) -> None:
    with pytest.raises(truing.TruingError) as caught:
        call(pin)
    assert words in str(caught.value)


def test_a_diagnosis_names_the_cause_with_its_size(diagnosis: truing.Diagnosis) -> None:
    (cause,) = diagnosis.causes
    low, high = cause.unknowns["loss"].interval95
    assert (diagnosis.verdict, cause.effect) == ("named", "softening")
    assert low is not None
    assert high is not None
    assert low < LOSS < high
    assert str(cause.unknowns["loss"].quantity.units) == "1 / kelvin"
    assert diagnosis.ranking.frame()["explanation"].tolist()[0] == "softening"
    assert isinstance(diagnosis.plot(), Figure)
    assert isinstance(diagnosis.ranking.plot(), Figure)
    over = diagnosis.residuals.plot("spring_temperature", "force")
    assert over.axes[0].get_xlabel().startswith("spring temperature")
    with pytest.raises(truing.TruingError, match="'spring' is no column of the record"):
        diagnosis.residuals.plot("spring")


def test_a_diagnosis_is_that_of_the_command_line(diagnosis: truing.Diagnosis, listing_done: Desk) -> None:
    desk, saved = listing_done.folder, diagnosis.save(listing_done.folder / "here")
    options = ("hold_out=judged = yes", 'per_file=["active_coils"]')
    settings = [word for option in options for word in ("--set", f"studies.diagnose.{option}")]
    assert calc_here(desk, "diagnose", "coil_spring.py", "--data", "measured.csv", "-o", "there", *settings).code == 0
    assert read_document(saved) == read_document(desk / "there")
    assert (saved / "extended.toml").read_text("utf-8") == (desk / "there" / "extended.toml").read_text("utf-8")
    assert not diagnosis.compare(diagnosis)


def test_a_dataframe_is_a_record_too(press: truing.LoadedModel) -> None:
    rows = pd.read_csv(PRESS / "measured.csv")
    bare = rows.rename(columns=lambda name: name.partition(" ")[0])
    units = {name.partition(" ")[0]: name.partition("[")[2].rstrip("]") for name in rows.columns}
    record, read = truing.record(bare, press, units=units), truing.read(PRESS / "measured.csv", press)
    pd.testing.assert_frame_equal(record.frame().astype(float), read.frame().astype(float))
    assert record.columns == read.columns
    assert record.rows == read.rows == len(rows)
    (columns,) = record.columns
    parts = {column.name: column.part for column in columns}
    assert (parts["crank_angle"], parts["slider_position"], parts["speed"]) == ("input", "measured", "condition")


def test_sheets_are_written_on_request(diagnosis: truing.Diagnosis, pin: truing.LoadedModel, tmp_path: Path) -> None:
    for shown in (pin.run(load="84 N"), diagnosis):
        assert shown.sheet(tmp_path / "a.html").read_text("utf-8").startswith("<!DOCTYPE html>")
        assert shown.sheet(tmp_path / "a.md").read_text("utf-8").startswith("# ")


def test_one_model_of_several_is_named_with_its_plugin() -> None:
    assert truing.load("harmonic_fractal.made_flank").name == "harmonic_fractal.made_flank"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert truing.load("press_linkage.press_linkage").name == "press_linkage"
