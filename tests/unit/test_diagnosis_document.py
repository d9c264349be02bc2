"""diagnosis.json, extended.toml and new_effect.py: what the contract says, in units; names never become code."""

from __future__ import annotations

import csv
import json
import math
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from html import unescape
from math import pi
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from diagnosis_samples import (
    CALIBRATED,
    DRIFTING,
    HEATING,
    REMAINDER,
    SAMPLES,
    SLIDE,
    SLIDE_OFFER,
    TIE,
    ambiguous,
    gain_of,
    named,
    none_found,
    unknown,
    warmed,
)
from test_report_sheet import Page

from truing.cli.diagnose import lines_of as report
from truing.declare.fields import Float, axis, found, part, results
from truing.declare.goals import Require
from truing.declare.model import Model
from truing.diagnosis.noise import SETTINGS
from truing.diagnosis.records import Covariate, file_labels
from truing.diagnosis.result import (
    Alternative,
    Amount,
    Cause,
    Contradiction,
    DiagnosisResult,
    FittedUnknown,
    Gain,
    Remainder,
    ResidualFinding,
    ShapeTerm,
    VisibleSize,
    doubts,
    readable_unit,
    shared_of,
)
from truing.errors import OutputError
from truing.evaluate import evaluate
from truing.inputs_file import setup_from_text
from truing.kernel import Origin
from truing.kernel.loading import load_file
from truing.report.chapters import Figures
from truing.report.diagnosis_chapters import diagnosis_chapters
from truing.report.diagnosis_figures import main_covariates, said_by, telling_covariate, thinned
from truing.report.diagnosis_remedy import then_table
from truing.report.diagnosis_sheet import make_diagnosis_sheet
from truing.report.diagnosis_sizes import amount_text, fitted_text, number_texts, p_text, percent, readable, score_text
from truing.report.diagnosis_words import (
    NO_REMEDY,
    certainty,
    explanation,
    headline,
    listed,
    prose,
    spoken,
    together,
    verdict_word,
)
from truing.report.document import BlockView, Document, FigureView, Fold, Items, Paragraph, TableView, plain_text
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.runs import diagnosis_files as beside
from truing.runs.diagnosis_document import diagnosis_document
from truing.runs.diagnosis_files import diagnosis_files, diagnosis_tables
from truing.runs.extension import extended_setup, extended_text
from truing.runs.folder import demand_place, is_ours, json_text, write_folder, write_outcome
from truing.runs.index import _of_diagnosis
from truing.runs.new_effect import new_effect_source, safe_expression
from truing.runs.provenance import provenance_of
from truing.setup import Setup, default_setup


def written(made: DiagnosisResult) -> Any:
    """The document as a reader of the file gets it."""
    return json.loads(json_text(diagnosis_document(made)))


def test_numbers_are_in_the_unit_that_stands_beside_them() -> None:
    """11.8e-6 1/K are 11.8 um/(m*K); 323.15 K are 50 degC; 4.1e-9 m/s are 14.76 um/h; 0.5 rad are 28.6479 deg."""
    document = written(ambiguous())
    expansion = document["causes"][0]["unknowns"]["expansion"]
    assert expansion == {"value": pytest.approx(11.8), "unit": "um/(m*K)", "interval95": pytest.approx([11.42, 12.18])}
    slope = document["alternatives"][0]["unknowns"]["sensor_drift"]["slope"]
    assert slope == {"value": pytest.approx(14.76), "unit": "um/h", "interval95": [pytest.approx(13.68), None]}
    settings = document["next"][0]["settings"]
    assert settings["rod_temperature"] == {"value": pytest.approx(50.0), "unit": "degC"}
    assert settings["crank_angle"] == {"value": pytest.approx(28.64788975), "unit": "deg"}
    assert document["wrong"]["slide_position"]["rmse"] == {"value": pytest.approx(41.0), "unit": "um"}
    assert document["calibrated"]["radius"] == {"value": pytest.approx(80.012), "unit": "mm", "of_its_sd": 0.6}
    assert document["smallest_visible"]["sensor_offset"]["value"] == pytest.approx(150.0)
    assert document["gain"]["slide_tilt"]["rmse_after"] == {"value": pytest.approx(2.03), "unit": "urad"}
    assert document["gain"]["stability"] == 0.8


def test_what_was_not_seen_is_listed_by_reason() -> None:
    document = written(named())
    assert document["not_excited"] == ["joint_play"]
    assert document["hidden_in_tolerances"] == ["sensor_offset", "input:radius"]
    assert document["not_measured"] == {"speed_swing": ["speed"]}
    assert written(replace(named(), seen=(VisibleSize("x", None, "not excited"),)))["smallest_visible"] == {}


def test_files_rows_runs_and_slips_are_counted() -> None:
    document = written(ambiguous())
    assert (document["rows"], document["runs"], document["held_out"]) == (160, 3, 0)
    assert document["files"] == [
        {
            "file": "press_record.csv",
            "in_file": 82,
            "used": 80,
            "left_out": [{"reason": "repeats an earlier row in every cell", "lines": [82, 83]}],
            "runs": 1,
        },
        {"file": "second day.csv", "in_file": 80, "used": 80, "left_out": [], "runs": 2},
    ]
    assert document["unit_slips"][0]["factor"] == 1000
    assert document["wrong"]["slide_position"]["noise"]["outliers"] == [{"file": "second day.csv", "line": 17}]


def test_no_number_that_is_none_is_written() -> None:
    floor = Amount(math.nan, "um")
    gain = Gain("slide_position", floor, floor, floor, math.nan, math.inf, math.nan, math.nan, (math.nan, 1e-6))
    text = json_text(diagnosis_document(replace(none_found(), gain=(gain,), stability=math.nan, p_any=math.nan)))
    assert "NaN" not in text
    assert "Infinity" not in text
    document = json.loads(text)
    assert document["gain"]["slide_position"]["held_out"]["rmse_after"] == {"value": pytest.approx(1.0), "unit": "um"}
    assert document["gain"]["slide_position"]["log_score_gain"] is None


def test_unknowns_of_each_file_stand_by_its_name() -> None:
    files = named().records.files
    fitted = FittedUnknown("expansion", 1e-6, None, None, "um/(m*K)", {files[1]: (2e-6, 1e-6, 3e-6)})
    made = replace(named(), causes=(Cause("rod_heating", (fitted,)),))
    per_file = written(made)["causes"][0]["unknowns"]["expansion"]["per_file"]
    assert per_file == {
        "second day.csv": {"value": pytest.approx(2), "unit": "um/(m*K)", "interval95": pytest.approx([1, 3])}
    }


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        (["a/x.csv", "b/y.csv"], ["x.csv", "y.csv"]),
        (["a/x.csv", "b/x.csv"], ["a/x.csv", "b/x.csv"]),
        ([r"C:\data\x.csv"], ["x.csv"]),
    ],
)
def test_files_are_named_shortly_where_that_tells_them_apart(files: list[str], expected: list[str]) -> None:
    assert file_labels(files) == expected


# The extended model


def read_back(text: str) -> Setup:
    return setup_from_text(text, SLIDE_OFFER, file="extended.toml", folder=Path())


HOSTILE_FILE = 'x\n[effects.joint_play]\nclearance = "9 um"\r\u2028#.csv'


@pytest.mark.parametrize("file", ["a.csv", HOSTILE_FILE])
def test_the_extended_inputs_are_read_back_as_they_were_meant_and_run(file: str) -> None:
    """A rod of 320 mm that is 12.05 K warmer at 11.8 um/(m*K) is 45.5008 um longer; runs use no calibration."""
    made = replace(named(), records=replace(named().records, files=(file, "b.csv")))
    setup = read_back(extended_text(replace(made, remainder=replace(REMAINDER, depends_on=(file,)))))
    (on,) = setup.effects
    assert on.effect.name == "rod_heating"
    assert on.values == {"expansion": pytest.approx(11.8e-6, rel=1e-12)}
    assert on.sds == {"expansion": pytest.approx(1.9e-7, rel=1e-12)}
    assert on.covariance == ((pytest.approx(3.7e-14, rel=1e-12),),)
    assert setup.calibrated == {item.name: pytest.approx(item.value, rel=1e-12) for item in CALIBRATED}
    assert setup.conditions["rod_temperature"] == pytest.approx(305.2, rel=1e-12)
    cold, warm = (evaluate(each).slide_position for each in (default_setup(SLIDE), setup))
    assert warm - cold == pytest.approx(0.32 * 11.8e-6 * 12.05, rel=1e-9)


def test_the_extended_inputs_say_where_they_come_from() -> None:
    text = extended_text(ambiguous())
    assert text.startswith(
        "# slide as measured: what calc diagnose made of press_record.csv, second day.csv (160 rows)."
    )
    for words in (
        "# Named: rod_heating, one of 3 explanations; the record cannot say which.",
        "# The same curve as rod_heating on this data: warm_up.",
        "# Not excluded: sensor_drift, 2.1 score units behind.",
        "# expansion: 95 % interval from 11.42 to 12.18 um/(m*K).",
        "# radius: moved by +0.60 of its standard deviation.",
    ):
        assert words in text


def test_what_was_only_calibrated_is_an_extended_model_too() -> None:
    """Nothing named, nothing calibrated: no file. Calibrated alone: a file that holds just that."""
    assert extended_setup(none_found()) is None
    assert extended_text(none_found()) == ""
    setup = read_back(extended_text(unknown()))
    assert setup.effects == ()
    assert set(setup.calibrated) == {"radius", "rod"}


# The stub of an effect


def loaded(source: str, folder: Path, name: str = "new_effect") -> ModuleType:
    """The stub as Python loads it, under a name of its own."""
    path = folder / f"{name}_{abs(hash((source, str(folder))))}.py"
    path.write_text(source, encoding="utf-8")
    return load_file(path)


def test_a_condition_of_the_model_is_shared_and_an_unknown_column_becomes_one(tmp_path: Path) -> None:
    """load is the model's own; "a b" is a column nobody declared: it gets a name that can stand in code."""
    records = replace(
        unknown().records,
        covariates={**unknown().records.covariates, "a b": Covariate("a b", np.arange(160.0), "kN", "other")},
    )
    terms = {"slide_position": (ShapeTerm("load * a b", 1e-12), ShapeTerm("1.0", 2e-6))}
    remainder = replace(REMAINDER, depends_on=("load", "a b"), terms=terms)
    module = loaded(new_effect_source(replace(unknown(), records=records, remainder=remainder)), tmp_path)
    effect = module.REMAINDER
    assert effect.needs[0] == SLIDE.conditions["load"]
    assert (effect.needs[1].name, effect.needs[1].unit) == ("a_b", "kN")
    base = SLIDE.function(SLIDE.inputs())
    changed = effect.function(SLIDE.inputs(), base, factor=2.0, load=3e3, a_b=5e3)
    assert changed.slide_position - base.slide_position == pytest.approx(2 * (3e3 * 5e3 * 1e-12 + 2e-6), rel=1e-9)


@results
class Inner:
    """A part of results."""

    height: Float = found("um", note="height", along="lag")
    lag: Float = axis("mm", note="place")


@results
class Outer:
    """Results with a part."""

    flank: Inner = part(Inner)


def course(crank: Any) -> Any:
    """Return a course along an axis for every row."""
    lag = np.linspace(0, 1e-3, 5)
    return Outer(flank=Inner(height=crank.radius[..., None] * lag, lag=lag))


def test_a_shape_along_an_axis_is_added_row_by_row(tmp_path: Path) -> None:
    """Over the axis and an input: 3e-3 * radius * lag, where radius has one value a row and lag one a column."""
    course.__annotations__ = {"crank": SLIDE.input_type, "return": Outer}
    model: Model[Any, Any] = Model(name="course", title="A course", function=course)
    setup = default_setup(model, Origin("course", "1", "", "", "entry:course"))
    names = list(model.own_result_fields)
    terms = {names[0]: (ShapeTerm(f"radius * {names[1]}", 3e-3),)}
    remainder = Remainder(("radius", names[1]), "a product", (names[0],), 0.01, terms)
    module = loaded(new_effect_source(replace(unknown(), setup=setup, remainder=remainder)), tmp_path)
    radius = np.array([0.08, 0.1])
    inputs = SLIDE.inputs(radius=radius)
    changed = module.REMAINDER.function(inputs, course(inputs), factor=1.0)
    expected = radius[:, None] * np.linspace(0, 1e-3, 5) * 1.003
    assert changed.flank.height == pytest.approx(expected, rel=1e-12)


HOSTILE_NAME = '"); import os; os.system("touch owned"); ("'


@pytest.mark.parametrize(
    "name", [HOSTILE_NAME, "np", "import", "factor", "__class__", 'x"""', "a\nimport os\n", "é", "7 days", ""]
)
def test_hostile_names_never_become_code(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Loaded and applied the file does arithmetic on that column, or leaves the term out; it runs nothing else."""
    monkeypatch.chdir(tmp_path)
    covariates = {**unknown().records.covariates, name: Covariate(name, np.ones(160), "", "other")}
    terms = {"slide_position": (ShapeTerm(f"1.0 + 0 * {name}", 1e-6), ShapeTerm(name, math.nan))}
    remainder = Remainder((name, "load"), name, ("slide_position", name), 0.01, terms)
    records = replace(unknown().records, covariates=covariates, files=(f"{name}.csv", "b.csv"))
    source = new_effect_source(replace(unknown(), records=records, remainder=remainder))
    module = loaded(source, tmp_path)
    keys = {need.name: 1.0 for need in module.REMAINDER.needs}
    base = SLIDE.function(SLIDE.inputs())
    changed = module.REMAINDER.function(SLIDE.inputs(), base, factor=1.0, **keys)
    assert changed.slide_position - base.slide_position == pytest.approx(1e-6) or changed == base
    assert not (tmp_path / "owned").exists()
    assert all(key.isidentifier() for key in keys)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("np.cos(7 * phi)", "np.cos(7 * phi)"),
        ("np.where(time > 3600.0, 1.0, 0.0)", "np.where(time > 3600.0, 1.0, 0.0)"),
        ("(phi - 0.1) ** 2 * time", "(phi - 0.1) ** 2 * time"),
        ("time ** -2", "time ** (-2)"),
        ("a b * 2", "a_b * 2"),
        ("np.load('x')", None),
        ("__import__('os')", None),
        ("phi.__class__", None),
        ("(lambda: 1)()", None),
        ("[phi for phi in time]", None),
        ("'text'", None),
        ("True", None),
        ("phi; time", None),
        ("other + 1", None),
        ("np.cos(phi, out=time)", None),
        ("", None),
        ("(" * 5000, None),
    ],
)
def test_expressions_are_arithmetic_on_covariates_or_nothing(text: str, expected: str | None) -> None:
    written_as = safe_expression(text, {"phi": "phi", "time": "time", "a b": "a_b"})
    assert (written_as or "").replace("(-2)", "-2") == (expected or "").replace("(-2)", "-2")
    assert (written_as is None) == (expected is None)


# The folder


def write(folder: Path, made: DiagnosisResult) -> dict[str, Any]:
    document, provenance = diagnosis_document(made), provenance_of(made.setup)
    files = diagnosis_files(made, {"sheet.html": "<p>sheet</p>", "sheet.md": "# sheet\n"}, folder)
    info = {"date": "2026-11-21"}
    write_outcome(folder, "diagnosis", made.setup, document, provenance=provenance, run_info=info, files=files)
    return document


ALWAYS = {
    "arrays.npz",
    "diagnosis.json",
    "inputs.toml",
    "results.csv",
    "rows.csv",
    "run.json",
    "sheet.html",
    "sheet.md",
}


@pytest.mark.parametrize(
    ("sample", "more"),
    [
        ("none", set()), ("undecided", set()), ("named", {"extended.toml"}), ("ambiguous", {"extended.toml"}),
        ("unknown", {"extended.toml", "new_effect.py"}), ("remainder", {"extended.toml", "new_effect.py"}),
    ],
)  # fmt: skip
def test_the_folder_holds_what_the_verdict_gives(sample: str, more: set[str], tmp_path: Path) -> None:
    document = write(tmp_path / "runs" / "x", SAMPLES[sample]())
    assert {path.name for path in (tmp_path / "runs" / "x").iterdir()} == ALWAYS | more
    text = (tmp_path / "runs" / "x" / "diagnosis.json").read_text(encoding="utf-8")
    assert json.loads(text) == json.loads(json_text(document))
    assert is_ours(tmp_path / "runs" / "x", "diagnosis")
    assert not is_ours(tmp_path / "runs" / "x", "run")


def test_the_tables_hold_causes_and_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    made = named()
    tables = diagnosis_tables(made)
    rows = list(csv.DictReader(tables["results.csv"].splitlines()))
    assert (rows[0]["name"], rows[0]["value"]) == ("verdict", "named")
    for cause in diagnosis_document(made)["causes"]:
        for name, fitted in cause["unknowns"].items():
            said = [row for row in rows if row["name"] == cause["effect"] and row["place"].startswith(name)]
            assert [float(row["value"]) for row in said] == [fitted["value"], *fitted["interval95"]]
            assert {row["unit"] for row in said} == {fitted["unit"]}
    measured = list(csv.DictReader(tables["rows.csv"].splitlines()))
    assert [int(row["line"]) for row in measured] == list(made.records.lines)
    monkeypatch.setattr(beside, "MOST_ROWS", len(measured) - 1)
    tables = diagnosis_tables(made)
    assert list(tables) == ["results.csv"]
    assert tables["results.csv"].splitlines()[-1] == f"diagnosis,rows,,,{len(measured)},,,,,in arrays.npz"


def test_the_arrays_hold_the_curves_in_printed_units(tmp_path: Path) -> None:
    made = named()
    write(tmp_path / "x", made)
    with np.load(tmp_path / "x" / "arrays.npz") as arrays:
        assert arrays["slide_position.measured"] == pytest.approx(made.records.measured["slide_position"] * 1e3)
        assert arrays["slide_tilt.after"] == pytest.approx(made.curves[1].after * 1e6)
        assert arrays["line"].tolist() == list(made.records.lines)


def test_a_diagnosis_is_replaced_by_a_diagnosis_and_by_nothing_else(tmp_path: Path) -> None:
    folder = tmp_path / "x"
    write(folder, named())
    write(folder, none_found())
    assert {path.name for path in folder.iterdir()} == ALWAYS
    with pytest.raises(OutputError, match="an existing diagnosis of ours but no run, so it is left alone"):
        demand_place(folder)
    write_folder(tmp_path / "run", {"results.json": '{"schema": "truing.results/1"}', "run.json": "{}"})
    with pytest.raises(OutputError, match="an existing run of ours but no diagnosis, so it is left alone"):
        write(tmp_path / "run", named())
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    with pytest.raises(OutputError, match="an existing folder but no diagnosis of ours"):
        write(tmp_path / "mine", named())
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["letter.txt"]


# The sheet of a diagnosis and its report on a terminal: what every verdict says, whatever its texts try to be.


def sheet_of(made: DiagnosisResult) -> Document:
    return make_diagnosis_sheet(made, provenance=provenance_of(made.setup, date="2026-11-21"))


@cache
def page_of(name: str) -> tuple[Document, str]:
    """The sheet of a sample, and its page with all figures drawn: made once for all tests."""
    sheet = sheet_of(SAMPLES[name]())
    return sheet, html_of(sheet)


@pytest.fixture(params=list(SAMPLES))
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def texts_of(sheet: Document) -> Iterator[str]:
    """Every text that stands on the sheet, as it was said."""
    yield from (sheet.head.title, sheet.banner.headline, sheet.summary, *sheet.alarms, *sheet.warnings)
    yield from map(str, sheet.banner.sentences)
    for chapter in sheet.chapters:
        yield chapter.title
        for block in unfolded(chapter.blocks):
            yield from words_of(block)


def unfolded(blocks: Iterable[BlockView]) -> Iterator[BlockView]:
    """Every block, also those that are folded away."""
    for block in blocks:
        yield from unfolded(block.blocks) if isinstance(block, Fold) else (block,)


def words_of(block: BlockView) -> Iterator[str]:
    """The texts of a block."""
    match block:
        case TableView(title, columns, rows, note):
            yield from (title, *(column.title for column in columns), str(note))
            yield from (str(cell) for row in rows for cell in row)
        case FigureView():
            yield block.caption
        case Paragraph(text):
            yield plain_text(text)
        case Items():
            yield from block.labels


def plain(text: str) -> str:
    """A text without what markup needs: entities, backslashes, true minus signs and narrow spaces stay as they are."""
    return re.sub(r"\s+", " ", text.replace("\u00a0", " ")).strip()


@pytest.mark.parametrize("name", ["none", "ambiguous", "remainder"])
def test_html_and_markdown_say_the_same_with_all_figures_drawn(name: str) -> None:
    sheet, page = page_of(name)
    chapters = [*sheet.front, *sheet.chapters]
    views = [block for chapter in chapters for block in unfolded(chapter.blocks) if isinstance(block, FigureView)]
    assert len(views) >= 4
    assert [view.number for view in views] == list(range(1, len(views) + 1))
    assert not [text for text in sheet.warnings if "figure" in text]
    titles = [chapter.title for chapter in sheet.chapters]
    assert titles[:6] == ["The record", "What is wrong", "Cause", "What is left", "Extended model", "Gain"]
    assert titles[-1] == "Provenance"
    html = plain(Page(page).text)
    markdown = plain(re.sub(r"\\(.)", r"\1", unescape(markdown_of(sheet))))
    said = [plain(text) for text in texts_of(sheet) if text]
    assert len(said) > 80
    assert [text for text in said if text not in html and text.replace("-", "−") not in html] == []
    assert [text for text in said if text not in markdown and text.replace("-", "−") not in markdown] == []
    assert [text for text in headline(SAMPLES[name]()) if text not in html] == []


def test_a_unit_slip_stands_before_everything_else() -> None:
    text = page_of("ambiguous")[1]
    assert 0 < text.index("Suspected unit slip.") < text.index("<h2")
    assert "Suspected unit slip" not in page_of("remainder")[1]


# Words


def fitted(value: float, low: float | None, high: float | None, unit: str = "um") -> FittedUnknown:
    return FittedUnknown("size", value, low, high, unit)


@pytest.mark.parametrize(
    ("unknown", "expected"),
    [
        (fitted(11.8e-6, 11.42e-6, 12.18e-6), ("11.80", "11.42", "12.18", "µm")),
        (fitted(118.2e-6, 101e-6, 135e-6), ("118", "101", "135", "µm")),
        (fitted(-0.66e-6, -0.71e-6, -0.61e-6), ("−0.660", "−0.710", "−0.610", "µm")),
        (fitted(41e-6, None, 52e-6), ("41", "open", "52", "µm")),
        (fitted(51.3e-6, 47.2e-6, 55.4e-6, "mm/K"), ("51.3", "47.2", "55.4", "µm/K")),
        (fitted(41e-6, None, None), ("41", "open", "open", "µm")),
        (fitted(0.0, -1e-6, 1e-6), ("0", "−1.0", "1.0", "µm")),
        (fitted(7.0, 7.0, 7.0, ""), ("7", "7", "7", "")),
        (fitted(298.15, 297.15, 299.15, "degC"), ("25.0", "24.0", "26.0", "°C")),
    ],
)
def test_the_width_of_the_interval_decides_the_digits(unknown: FittedUnknown, expected: tuple[str, ...]) -> None:
    assert number_texts(unknown, (unknown.value, unknown.low, unknown.high)) == expected


def test_small_pieces_of_words() -> None:
    assert fitted_text(fitted(41e-6, None, None)) == "size 41 µm (its interval is open)"
    assert fitted_text(fitted(41e-6, 38e-6, 44e-6)) == "size 41.0 µm (95 %: 38.0 … 44.0)"
    sure = [certainty(p_value) for p_value in (0.0004, 0.0033, 0.02, 0.4, None)]
    assert sure == [*["practically certain"] * 2, "likely", "may be chance", "noticed"]
    assert (p_text(0.0004), p_text(0.0033)) == ("p < 0.001", "p 0.0033")
    assert [listed(words) for words in ("", "a", "ab", "abac")] == ["", "a", "a and b", "a, b and c"]
    sizes = [Amount(1.15e-6 / 3600, "mm/h"), Amount(72.3e-6, "mrad"), Amount(2.8e-12, "1/GN"), Amount(2e-4, "deg")]
    assert [amount_text(readable(size)) for size in sizes] == ["1.15 µm/h", "72.3 µrad", "0.0028 1/GN", "0.688′"]
    assert prose("rises with link_heating, by 12 um or 3 urad/h; 5 umbrellas") == (
        "rises with link heating, by 12 µm or 3 µrad/h; 5 umbrellas"
    )
    assert [score_text(x) for x in (4.8e-16, 6.3, 51.04, 210.4, math.nan)] == ["0", "6.3", "51", "210", "–"]
    assert p_text(None) == "not tested"
    assert percent(0.9991) == "99.9 %"
    assert percent(math.nan) == "–"
    assert amount_text(Amount(2.3e-6, "um")) == "2.3 µm"
    assert amount_text(None) == "–"
    assert spoken("input:rod") == "rod outside of its tolerance"
    assert explanation(Alternative((), 1.0, 1.0)) == "nothing but scatter"
    assert explanation(Alternative(("a_b", "unknown"), 1.0, 1.0, ("x",))) == "a b + something unregistered over x"


SAID = {
    "none": ["meets the measurement: slide position to 6.1 µm (its readings scatter by 6 µm)", "nothing of joint play"],
    "named": ["slide position: rod heating, expansion 11.80 µm/(m·K) (95 %: 11.42 … 12.18).",
              "falls from 41.2 µm to 6.12 µm (its readings scatter by 6 µm).",
              "Chance alone would give differences like these in fewer than 1 of 300 records",
              "No other explanation comes near"],
    "undecided": ["No cause is named, but that nothing is wrong cannot be said either",
                  "chance alone would give the best explanation, sensor drift, in about 1 of 16 records",
                  "12 waves over the range of crank angle"],
    "ambiguous": ["in slide position is drawn alike by rod heating, warm up or sensor drift.",
                  "Taken as the first of them: rod heating, expansion 11.80 µm/(m·K)",
                  "Hold rod temperature 50 °C, crank angle 28.65°; load −50 kN and 50 kN in turn: 2 readings in 1.5 h "
                  "tell rod heating or warm up and sensor drift apart with a chance of 96 % (95 %: 90 … 98).",
                  "No setting tells rod heating and warm up apart; a measurement of another quantity does: "
                  "rod heating, expansion (of the rod) to ±5.7 µm/(m·K) (11.8 µm/(m·K) if it is rod heating) or "
                  "warm up, size to ±1.2 µm (3.1 µm if it is warm up)"],
    "unknown": ["Something that no registered cause explains is in slide position, over crank angle: order 7"],
    "remainder": ["rod heating, expansion 11.80", "Beside it something that no registered cause explains"],
}  # fmt: skip
WORDS = {
    "none": "Nothing found", "undecided": "Undecided", "named": "Cause named",
    "ambiguous": "One of 3 causes; this record cannot say which",
    "unknown": "Cause unknown",
    "remainder": "Cause named, a remainder left",
}  # fmt: skip


def test_the_sentence_for_a_colleague_holds_cause_size_gain_and_what_is_next(name: str) -> None:
    made = SAMPLES[name]()
    said = " ".join(headline(made))
    assert [words for words in SAID[name] if words not in said] == []
    assert verdict_word(made) == WORDS[name]
    assert made.verdict == {"ambiguous": "one_of", "remainder": "named"}.get(name, name)
    assert_one_thing_is_said(made)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"p_value": 0.3}, "On rows that were not fitted there is no gain that could not be chance."),
        ({"p_value": 0.125}, "On rows that were not fitted the error of slide position falls from 41.2 µm to 6.12 µm; "
         "in so few independent blocks that may be chance."),
        ({"held_out": (40e-6, 7e-6)}, "On the rows held out the error of slide position falls from 40 µm to 7 µm."),
        ({"held_out": (40e-6, 55e-6)}, "On the rows held out the error of slide position grows from 40 µm to 55 µm: "
         "the extension does not carry over to them; look at what is different there."),
    ],
)  # fmt: skip
def test_a_gain_is_told_with_what_speaks_against_it(change: Mapping[str, Any], words: str) -> None:
    made = replace(named(), gain=tuple(replace(item, **change) for item in named().gain))
    assert words in headline(made)
    assert sum("On rows that were not fitted" in sentence for sentence in headline(made)) == 1


# What residuals are drawn over


@pytest.mark.parametrize(
    ("sample", "expected"),
    [
        ("none", ["crank_angle"]), ("named", ["rod_temperature"]), ("unknown", ["crank_angle"]),
        ("remainder", ["rod_temperature", "crank_angle"]),
    ],
)  # fmt: skip
def test_residuals_are_drawn_over_what_is_guilty(sample: str, expected: list[str]) -> None:
    assert [item.name for item in main_covariates(SAMPLES[sample]())] == expected


@pytest.mark.parametrize(("sample", "over"), [("named", "rod_temperature"), ("unknown", "rod_temperature")])
def test_page_one_shows_what_the_model_misses_over_what_tells_most(sample: str, over: str) -> None:
    made = SAMPLES[sample]()
    curves = made.curves[0]
    covariate = telling_covariate(made, curves)
    assert covariate is not None
    assert covariate.name == over
    sheet = page_of(sample)[0]
    assert sheet.front[0].title == f"{spoken(curves.result).capitalize()} over {spoken(over)}"


def test_the_say_of_a_covariate_is_what_the_analysis_of_variance_gives() -> None:
    """Eight groups of five: sums of squares by hand; all of it where the groups explain everything, none of noise."""
    places, rng = np.repeat(np.arange(8.0), 5), np.random.default_rng(1_600_400)
    noise = rng.normal(0, 1, 40)
    values = 0.5 * places + noise
    within = sum(float(np.sum((group - group.mean()) ** 2)) for group in values.reshape(8, 5))
    assert said_by(places, values) == pytest.approx(1 - within / 32 / np.var(values, ddof=1), rel=1e-12)
    assert said_by(places, np.sin(places)) == pytest.approx(1.0)
    assert said_by(places, noise) < 0.3
    assert said_by(places, np.ones(40)) == 0.0


def test_what_to_do_about_a_cause_is_said_on_page_one_on_the_terminal_and_in_the_file() -> None:
    made = named()
    effect = made.setup.model.known_effects[made.causes[0].effect]
    told = replace(effect, remedy="Let the press run warm for an hour; the slider then stands where it should.")
    errors = [told if each.name == effect.name else each for each in made.setup.model.errors]
    told_about = replace(made, setup=replace(made.setup, model=replace(made.setup.model, errors=errors)))
    sheet = sheet_of(told_about)
    items = next(chapter.blocks[0] for chapter in sheet.front if chapter.ident == "what-to-do")
    assert isinstance(items, Items)
    (text,) = map(plain_text, items.texts)
    assert text == told.remedy
    assert any(told.remedy in line for line in report(told_about, Path("runs/x")))
    assert written(told_about)["causes"][0]["remedy"] == told.remedy
    silent = next(chapter.blocks[0] for chapter in page_of("named")[0].front if chapter.ident == "what-to-do")
    assert isinstance(silent, Items)
    assert plain_text(silent.texts[0]) == NO_REMEDY
    assert written(made)["causes"][0]["remedy"] == ""


def test_page_one_says_what_a_cause_is_where_it_is_named_first() -> None:
    """In its author's words: of the named one, of a rival, and of an input; nothing where nobody wrote anything."""
    told = list(map(plain_text, page_of("named")[0].banner.sentences))
    assert told[0].startswith("What the model misses in slide position: rod heating, expansion 11.80")
    assert told[1] == "Rod heating means: the rod grows where the motor warms it."
    (drift,) = (each for each in named().setup.model.known_effects.values() if each.name == "sensor_drift")
    open_told = list(map(plain_text, page_of("ambiguous")[0].banner.sentences))
    assert "is drawn alike by rod heating, warm up or sensor drift" in open_told[0]
    assert open_told[1] == f"{told[1]} Sensor drift means: {drift.why or drift.looks_like}."
    joint = replace(HEATING, effect="joint_play")
    play = sheet_of(replace(named(), causes=(joint,)))
    assert not any("Joint play means" in plain_text(text) for text in play.banner.sentences)
    rod = replace(HEATING, effect="input:rod", unknowns=())
    meant = [plain_text(text) for text in sheet_of(replace(named(), causes=(rod,))).banner.sentences]
    assert "Rod outside of its tolerance means: length of the rod." in meant


def test_page_one_says_what_the_machine_would_do_without_the_cause() -> None:
    """A rod of 320 mm that is 12.05 K warmer at 11.8 um/(m*K) is 45.5 um longer; the tilt knows nothing of it."""
    limit = Require("slide_position", at_most="410 mm")
    setup = replace(named().setup, model=replace(SLIDE, objectives=[limit]))
    mended = named().extended
    assert mended is not None
    made = replace(named(), setup=setup, extended=replace(mended, model=setup.model))
    table = then_table(made)
    assert table is not None
    (check, change) = table.rows
    assert [plain_text(cell) for cell in check[3:]] == ["≤ 410 mm", "✓ pass"]
    assert [plain_text(cell) for cell in change[-2:]] == ["–", "changes by −45.5 µm"]
    assert then_table(none_found()) is None


def test_a_condition_with_few_values_shows_no_course() -> None:
    """The play follows the load, which has two values here: the angle is looked at instead."""
    play = Cause("joint_play", (FittedUnknown("clearance", 9e-6, 5e-6, 13e-6, "um"),))
    assert [item.name for item in main_covariates(replace(named(), causes=(play,)))] == ["crank_angle"]


@pytest.mark.parametrize(("rows", "step"), [(160, 1), (1500, 1), (1501, 2), (100_000, 67)])
def test_figures_of_long_records_are_thinned(rows: int, step: int) -> None:
    assert thinned(rows).step == step


# The terminal


def test_the_report_answers_the_five_questions(name: str) -> None:
    text = "\n".join(report(SAMPLES[name](), Path("runs/x")))
    titles = re.findall(r"^(\d [A-Z][a-z ]+?)  ", text, re.MULTILINE)
    assert titles == ["1 What is wrong", "2 Cause", "3 Extended model", "4 Gain", "5 Next"]
    assert text.startswith("DIAGNOSIS  press_record.csv, second day.csv: 160 of 162 rows, 3 runs, 4 h; slide: ")
    assert [words for words in SAID[name] if words not in text] == []
    assert ("extended model: " in text) == (name in {"named", "ambiguous", "remainder"})
    assert ("new_effect.py" in text) == (name in {"unknown", "remainder"})


def test_a_narrow_terminal_breaks_behind_the_titles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    lines = "\n".join(report(ambiguous(), Path("runs/x"))).splitlines()
    assert max(map(len, lines)) <= 80
    start = lines.index(next(line for line in lines if line.startswith("1 What is wrong")))
    end = lines.index(next(line for line in lines if line.startswith("sheet: ")))
    assert [line for line in lines[start : end - 1] if line[1:2] != " " and line[:1].strip()] == []


# Several causes


def test_of_several_causes_the_sheet_and_the_terminal_say_the_shares() -> None:
    one = replace(named().causes[0], share=0.75)
    made = replace(named(), causes=(one, replace(one, effect="sensor_offset", share=0.25)))
    (table,) = (block for chapter in diagnosis_chapters(made, NoFigures()) for block in chapter.blocks
                if isinstance(block, TableView) and block.title == "Named")  # fmt: skip
    assert [row[-1] for row in table.rows] == ["75 %", "25 %"]
    said = "\n".join(report(made, Path("folder")))
    assert f"Of what the causes add to the model: {spoken(one.effect)} 75 %, sensor offset 25 %." in said
    assert "the causes add" not in "\n".join(report(named(), Path("folder")))


# Units in which numbers of a diagnosis read well: another size of the same kind of unit, never another kind.

MINUTE = pi / 10_800


@pytest.mark.parametrize(
    ("unit", "size", "expected"),
    [
        ("mm", 0.5e-3, "mm"),
        ("mm", 2.3e-6, "um"),
        ("m", 2.3e-6, "um"),
        ("urad", 5e-3, "mrad"),
        ("arcmin", 0.5 * MINUTE, "arcmin"),
        ("arcmin", 0.01 * MINUTE, "arcsec"),
        ("deg", 3 * MINUTE, "arcmin"),
        ("mm", 0.0, "mm"),
        ("degC", 1e-3, "K"),
        ("inch", 1e-6, "um"),
    ],
)
def test_a_unit_keeps_its_kind(unit: str, size: float, expected: str) -> None:
    """Arc minutes become arc seconds and not radians; a unit of no family becomes one that engineers read."""
    assert readable_unit(unit, size) == expected


# One rule gives the verdict: over made states of a diagnosis, nothing that is printed contradicts what was found.

FINDINGS = {
    "allowed": ResidualFinding("bias", "", None, "on average 3 um off the nominal model", is_allowed=True),
    "bias": ResidualFinding("bias", "", None, "on average 30 um off the nominal model, more than the tolerances allow"),
    "wave": ResidualFinding(
        "wave", "crank_angle", 1e-4, "12 waves over the range of crank_angle, with 31 % of what is left"
    ),
    "trend": ResidualFinding("trend", "load", 0.03, "rises with load, by 3 um over the record"),
    "spread": ResidualFinding("spread", "load", 0.001, "the scatter grows with load"),
    "alike": ResidualFinding("autocorrelation", "", None, "neighbouring readings are alike"),
    "far": ResidualFinding("outlier", "", None, "1 reading lies far outside of the scatter: measured.csv:36"),
}
PLAY = Cause("joint_play", (replace(HEATING.unknowns[0], name="clearance", unit="um"),))
STEP = Alternative(("joint_play", "step"), 2.0, 1.0)
APART = Contradiction("rod_heating", "expansion", Amount(8e-6, "um/(m*K)"), Amount(15e-6, "um/(m*K)"))


class NoFigures(Figures):
    """Draws nothing: this is about words."""

    def view(self, title: str, what: Any, caption: str) -> Paragraph:
        return Paragraph(caption)


def sheet_text(made: DiagnosisResult) -> str:
    """What the sheet says above its chapters and in them, without their figures."""
    said = [*headline(made)]
    for chapter in diagnosis_chapters(made, NoFigures()):
        said += [words for block in unfolded(chapter.blocks) for words in words_of(block)]
    return "\n".join(said)


def assert_one_thing_is_said(made: DiagnosisResult) -> None:
    """Headline, terminal, sheet and JSON never contradict what was found, or one another."""
    document, verdict = diagnosis_document(made), made.verdict
    said = f"{verdict_word(made)}. {' '.join(headline(made))}"
    terminal = re.sub(r"\s+", " ", "\n".join(report(made, Path("runs/x"))))
    everything = "\n".join([said, terminal, sheet_text(made), _of_diagnosis(document, "x").verdict]).lower()
    assert document["verdict"] == verdict
    assert said in terminal
    assert document["unique"] is (verdict == "none" or (len(document["explanations"]) == 1 and verdict != "undecided"))
    assert bool(document["undecided"]) is (verdict == "undecided")
    assert all(prose(warning).lower() in said.lower() for warning in document["warnings"])
    assert ("nothing found" in everything) is (verdict == "none")
    assert ("what is left is scatter" in everything) is (verdict == "none")
    sure = ("no other explanation", "nothing left to separate", "no other registered cause", "cause named")
    assert verdict == "named" or not [words for words in sure if words in everything]
    if verdict == "one_of":  # every explanation is named, and their number
        count = len(document["explanations"])
        assert re.match(rf"One of {count} (causes|explanations); this record cannot say which\.", said)
        is_further = re.search(r"[Ww]hether .+ is there as well, this record cannot say\.", said)
        assert is_further or not [names for names in document["explanations"] if together(names) not in said]
    _demand_shared(document, said, terminal, sheet_text(made))
    _demand_true_proposals(made, said, everything)


def _demand_shared(document: Mapping[str, Any], *texts: str) -> None:
    """What all of several explanations hold is said everywhere, and nothing else is said to be in them all."""
    several = [set(names) for names in document["explanations"]]
    over = ",".join((document["remainder"] or {"depends_on": ()})["depends_on"])
    several = [{"unknown" if name == f"unknown:{over}" else name for name in names} for names in several]
    shared = set.intersection(*several) if len(several) > 1 else set()
    assert set(document["shared"]) == shared
    for text in texts:
        said = re.findall(r"([\w ,]+?) (?:is|are) in (?:both|all) of them", text)
        assert len(said) >= (bool(shared) and not re.search("[Ww]hether .+ is there as well", text))
        for names in said:
            parts = re.split(r", | and ", names.strip().lower())
            assert {part.strip() for part in parts} == {spoken(name).lower() for name in shared}


def _demand_true_proposals(made: DiagnosisResult, said: str, everything: str) -> None:
    """An experiment is said with its chance, and with the readings it would need where the budget is too small."""
    experiment = made.experiment
    assert ("with a chance of" in said) is (experiment is not None)
    assert ("would be needed for 95 %" in said) is (experiment is not None and experiment.needed > experiment.readings)
    if experiment is not None:
        assert all(together([name]) in said for name in experiment.tells)
        assert f"{experiment.readings} readings" in everything
    if made.ties:
        assert "for this machine they stay one" in said or "a measurement of another quantity does" in said
        assert "No setting can be proposed" not in said


@pytest.mark.parametrize("needed", [0, 2, 40])
@pytest.mark.parametrize("rivals", [(DRIFTING,), (Alternative(("unknown",), 3.0, 2.0, ("time",)), STEP)])
@pytest.mark.parametrize("beside", [None, REMAINDER])
def test_of_several_explanations_one_thing_is_said(
    needed: int, rivals: Sequence[Alternative], beside: Remainder | None
) -> None:
    """With an experiment that separates them, or would if it were longer, and a fact that does."""
    pair = ("rod_heating", rivals[0].causes[0])
    point = replace(ambiguous().next[0], separates=pair, needed=needed)
    points = (point, point) if needed else ()
    experiment = replace(warmed(), tells=pair, apart=(pair,), needed=needed) if needed else None
    changed = {"alternatives": tuple(rivals), "next": points, "ties": (TIE,), "experiment": experiment}
    made = replace(named(), remainder=beside, **changed)
    assert_one_thing_is_said(made)


FEW = {name: np.where(np.arange(160) < 3, values, np.nan) for name, values in named().records.measured.items()}


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        ({}, "none"), ({"p_any": 0.2}, "none"), ({"p_any": 0.19}, "undecided"), ({"p_any": None}, "undecided"),
        ({"findings": ("allowed", "spread", "alike", "far")}, "none"), ({"findings": ("bias",)}, "undecided"),
        ({"findings": ("wave",)}, "undecided"), ({"findings": ("far", "trend")}, "undecided"),
        ({"calibrated": (replace(CALIBRATED[0], of_its_sd=-2.9),)}, "none"),
        ({"calibrated": (replace(CALIBRATED[0], of_its_sd=3.1),)}, "undecided"),
        ({"ar_coefficient": 0.87}, "none"), ({"ar_coefficient": 0.92}, "undecided"),
        ({"records": replace(named().records, measured=FEW)}, "undecided"),
    ],
)  # fmt: skip
def test_nothing_is_found_only_where_nothing_speaks_against_it(change: Mapping[str, Any], verdict: str) -> None:
    made = none_found()
    findings = tuple(FINDINGS[name] for name in change.get("findings", ()))
    noise = replace(made.wrong[0].noise, ar_coefficient=change.get("ar_coefficient", 0.0))
    other = {name: value for name, value in change.items() if name not in {"findings", "ar_coefficient"}}
    made = replace(made, wrong=(replace(made.wrong[0], findings=findings, noise=noise), made.wrong[1]), **other)
    assert made.verdict == verdict
    assert bool(list(doubts(made))) is (verdict == "undecided")
    assert_one_thing_is_said(made)


def test_every_name_of_a_curve_is_an_explanation() -> None:
    """Two names of the first cause and two of a rival, each with what else it holds, named once."""
    warm = replace(HEATING, same_as=("warm_up",))
    rivals = (replace(STEP, same_as={"step": ("wear",)}), Alternative(("unknown",), 3.0, 2.0, ("time",)), STEP)
    made = replace(named(), causes=(warm, PLAY), alternatives=rivals)
    assert diagnosis_document(made)["explanations"] == [
        ["rod_heating", "joint_play"], ["warm_up", "joint_play"], ["joint_play", "step"], ["joint_play", "wear"],
        ["unknown:time"],
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("causes", "rivals", "shared", "words"),
    [
        ((HEATING, PLAY), (STEP,), ("joint_play",), "Joint play is in both of them."),
        ((replace(HEATING, same_as=("warm_up",)), PLAY), (STEP,), ("joint_play",), "Joint play is in all of them."),
        ((PLAY,), (STEP,), ("joint_play",), "Whether step is there as well, this record cannot say."),
        ((HEATING, PLAY), (replace(STEP, causes=("rod_heating", "joint_play", "step")),), ("rod_heating", "joint_play"),
         "Whether step is there as well, this record cannot say."),
        ((HEATING, PLAY), (STEP, DRIFTING), (), ""),
        ((HEATING, replace(PLAY, same_as=("gap",))), (STEP,), (), ""),
        ((HEATING, PLAY), (), (), ""),
        ((), (), (), ""),
    ],
)  # fmt: skip
def test_what_several_explanations_share_is_said(
    causes: Sequence[Cause], rivals: Sequence[Alternative], shared: Sequence[str], words: str
) -> None:
    """A name stands in every one of several explanations, under no other name of its curve."""
    made = replace(named(), causes=tuple(causes), alternatives=tuple(rivals))
    assert shared_of(made) == shared
    assert diagnosis_document(made)["shared"] == list(shared)
    said = [sentence for sentence in headline(made) if re.search("in (both|all) of them|is there as well", sentence)]
    assert said == ([words] if words else [])
    assert_one_thing_is_said(made)


(UNKNOWN,) = HEATING.unknowns
AT_END = replace(HEATING, unknowns=(replace(UNKNOWN, value=19.95e-6, low=18e-6, high=20e-6),))
FIRST, OTHER = named().wrong
ALARMS = {
    "expansion of rod_heating was fitted at the bound declared for it (19.9 um/(m*K)): a wrong": {"causes": (AT_END,)},
    "radius had to move 4.0 times as far as its tolerance makes usual to meet the measurement": {
        "calibrated": (replace(CALIBRATED[0], of_its_sd=-4.0),),
    },
    "on rows that were not fitted the error of slide_position grows from 6 um to 6.2 um": {
        "gain": gain_of(6.0e-6, 6.2e-6, 0.8),
    },
    "expansion of rod_heating is 8 um/(m*K) in one half of the rows and 15 um/(m*K) in the other": {
        "contradictions": (APART,),
    },
}
"""The others sound in ``test_diagnosis_alarms``."""


@pytest.mark.parametrize("words", ALARMS)
def test_an_alarm_takes_the_name_and_is_said_everywhere(words: str) -> None:
    """The expansion may be 20 um/(m*K) at the most; all else is stated in the change itself."""
    assert named().warnings == ()
    made = replace(named(), **ALARMS[words])
    (warning,) = made.warnings
    document = diagnosis_document(made)
    assert warning.startswith(words)
    assert (made.verdict, made.unique, document["undecided"]) == ("undecided", False, [warning])
    assert document["causes"]
    assert "Cause in doubt" in verdict_word(made)
    assert "drawn best by rod heating" in " ".join(headline(made))
    assert prose(warning).lower() in sheet_text(made).lower()
    assert_one_thing_is_said(made)
    assert _of_diagnosis(document, "x").verdict.endswith("rod_heating in doubt")


@pytest.mark.parametrize(
    ("place", "rows", "is_alarm"),
    [(-1, 10_000, True), (-2, 10_000, False), (-2, 160, True), (-4, 160, False)],
    ids=["largest", "smaller", "few rows", "far off"],
)
def test_the_largest_memory_that_is_tried_is_nearly_a_random_walk(place: int, rows: int, is_alarm: bool) -> None:
    """And so is what so few rows do not tell from it, by two standard errors sqrt((1 - rho^2) / n)."""
    rho = sorted({setting.rho for setting in SETTINGS})[place]
    noise = replace(FIRST.noise, ar_coefficient=rho)
    made = replace(named(), wrong=(replace(FIRST, rows=rows, noise=noise), OTHER))
    assert bool(made.warnings) is is_alarm
    assert made.verdict == ("undecided" if is_alarm else "named")


@pytest.mark.parametrize(
    ("made", "verdict"),
    [(ambiguous(), "one_of"), (replace(named(), causes=(PLAY,), alternatives=(STEP,)), "undecided")],
)
def test_an_alarm_takes_the_name_that_all_explanations_hold_and_no_other(made: DiagnosisResult, verdict: str) -> None:
    """What may be there as well is a second explanation, and still the first one is what an alarm speaks against."""
    assert replace(made, stability=0.2).verdict == verdict
    assert len(replace(made, stability=0.2).warnings) == 1
