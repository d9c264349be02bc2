"""diagnosis.json, extended.toml and new_effect.py: what the contract says, in units; names never become code."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from diagnosis_samples import (
    CALIBRATED,
    REMAINDER,
    SAMPLES,
    SLIDE,
    SLIDE_OFFER,
    ambiguous,
    named,
    none_found,
    unknown,
)

from truing.declare.fields import Float, axis, found, part, results
from truing.declare.model import Model
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import (
    Amount,
    Cause,
    DiagnosisResult,
    FittedUnknown,
    Gain,
    Remainder,
    ShapeTerm,
    VisibleSize,
)
from truing.errors import OutputError
from truing.evaluate import evaluate
from truing.inputs_file import setup_from_text
from truing.kernel import Origin
from truing.kernel.loading import load_file
from truing.runs.diagnosis_document import diagnosis_document, file_labels
from truing.runs.extension import extended_setup, extended_text
from truing.runs.folder import demand_place, is_ours, json_text, write_diagnosis, write_folder
from truing.runs.new_effect import code_name, new_effect_source, safe_expression
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


def test_the_extended_inputs_are_read_back_as_they_were_meant() -> None:
    setup = read_back(extended_text(named()))
    (on,) = setup.effects
    assert on.effect.name == "rod_heating"
    assert on.values == {"expansion": pytest.approx(11.8e-6, rel=1e-12)}
    assert on.sds == {"expansion": pytest.approx(1.9e-7, rel=1e-12)}
    assert on.covariance == ((pytest.approx(3.7e-14, rel=1e-12),),)
    assert setup.calibrated == {item.name: pytest.approx(item.value, rel=1e-12) for item in CALIBRATED}
    assert setup.conditions["rod_temperature"] == pytest.approx(305.2, rel=1e-12)


def test_the_extended_inputs_run_as_the_extended_model() -> None:
    """A rod of 320 mm that is 12.05 K warmer at 11.8 um/(m*K) is 45.5008 um longer; runs use no calibration."""
    cold, warm = (evaluate(setup).slide_position for setup in (default_setup(SLIDE), read_back(extended_text(named()))))
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


def test_hostile_names_stay_in_the_comments_of_the_extended_inputs() -> None:
    made = named()
    hostile = 'x\n[effects.joint_play]\nclearance = "9 um"\r\u2028#.csv'
    records = replace(made.records, files=(hostile, "b.csv"))
    text = extended_text(replace(made, records=records, remainder=replace(REMAINDER, depends_on=(hostile,))))
    assert [on.effect.name for on in read_back(text).effects] == ["rod_heating"]


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


HOSTILE = '"); import os; os.system("touch owned"); ("'


@pytest.mark.parametrize("name", [HOSTILE, "np", "import", "__class__", 'x"""', "a\nimport os\n", "é", "7 days", ""])
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
        ("np.cos", None),
        ("__import__('os')", None),
        ("phi.__class__", None),
        ("(lambda: 1)()", None),
        ("[phi for phi in time]", None),
        ("'text'", None),
        ("True", None),
        ("phi; time", None),
        ("phi ** time", None),
        ("9 ** 9 ** 9", None),
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


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("crank_angle", "crank_angle"), ("a b", "a_b"), ("class", "column_class"), ("np", "column_np"),
        ("7 days", "column_7_days"), ("é", "column"), ("__class__", "column_class__"), ("factor", "column_factor"),
    ],
)  # fmt: skip
def test_names_in_code_can_stand_there(name: str, expected: str) -> None:
    assert code_name(name).startswith(expected.rstrip("_"))
    assert code_name(name).isidentifier()


# The folder


def write(folder: Path, made: DiagnosisResult) -> dict[str, Any]:
    sheets: dict[str, str | bytes] = {"sheet.html": "<p>sheet</p>", "sheet.md": "# sheet\n"}
    return write_diagnosis(
        folder, made, provenance=provenance_of(made.setup), run_info={"date": "2026-11-21"}, sheets=sheets
    )  # fmt: skip


ALWAYS = {"arrays.npz", "diagnosis.json", "inputs.toml", "run.json", "sheet.html", "sheet.md"}


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


# The manual
