"""calc diagnose, run and table with files as data acquisition writes them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest

from recording_files import KINDS, WRITERS, Recorded, write_csv, write_parquet, write_tdms
from shared import Calc

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
SPRING = '''
"""A spring that is pressed: how far does it give way?"""

from dataclasses import replace

from truing import Condition, Effect, Float, Model, Unknown, found, given, hookimpl, inputs, results


@inputs
class Spring:
    """What is known."""

    load: Float = given(100.0, "N", note="load")
    rate: Float = given(10.0, "N/mm", note="rate of the spring", above=0)


@results
class Deflection:
    """What is measured."""

    deflection: Float = found("mm", formula="load / rate", note="how far it gives way")


def spring(given: Spring) -> Deflection:
    """Hooke's law."""
    return Deflection(deflection=given.load / given.rate)


def soft(given: Spring, *, loss: Float) -> Spring:
    """Give way as under a larger load."""
    return replace(given, load=given.load * (1 + loss))


MODEL = Model(
    name="spring", title="A spring", function=spring,
    errors=[Effect("soft", on_inputs=soft, unknowns=[Unknown("loss", -0.5, 0.5)])],
)


@hookimpl
def truing_models():
    """Offer one calculation."""
    return [MODEL]
'''
COLUMNS = """
[columns]
"Untitled/Kraft_1" = "load"
Kraft_1 = { name = "load", unit = "N" }
Weg_1 = { name = "deflection", unit = "mm" }
time = { name = "time", unit = "s" }

[studies.diagnose]
budget = 30
"""


def measured() -> dict[str, Recorded]:
    """A spring that is a tenth softer than drawn, read to a hundredth of a millimetre, at 100 Hz."""
    draw = np.random.default_rng(1)
    times, load = 0.01 * np.arange(24), draw.uniform(50, 200, 24)
    return {
        "Kraft_1": Recorded(load, "N", times),
        "Weg_1": Recorded(1.1 * load / 10 + draw.normal(0, 0.01, 24), "mm", times),
    }


@pytest.fixture
def spring(calc: Calc, tmp_path: Path) -> Calc:
    (tmp_path / "spring.py").write_text(SPRING, encoding="utf-8")
    (tmp_path / "inputs.toml").write_text('plugin = "spring"\n' + COLUMNS, encoding="utf-8")
    return calc


def diagnosed(calc: Calc, folder: Path, file: str) -> Any:
    """Return diagnosis.json of a file, without the name and the hash of the file."""
    answer = calc("diagnose", "./spring.py", "--inputs", "inputs.toml", "--data", file, "-o", f"of_{file}", "-q")
    assert answer.code == 0, answer.err
    text = (folder / f"of_{file}" / "diagnosis.json").read_text(encoding="utf-8").replace(file, "FILE")
    return json.loads(text)


def test_the_same_diagnosis_from_every_kind_of_file(spring: Calc, tmp_path: Path) -> None:
    of_csv = diagnosed(spring, tmp_path, write_csv(tmp_path / "m.csv", measured()).name)
    assert of_csv["causes"]
    for kind in KINDS:
        of_kind = diagnosed(spring, tmp_path, WRITERS[kind](tmp_path / f"m.{kind}", measured()).name)
        assert of_kind == of_csv, kind


def test_what_was_done_to_a_recording_is_said(spring: Calc, tmp_path: Path) -> None:
    channels = measured()
    slow = Recorded(channels["Kraft_1"].values[::2], "N", channels["Kraft_1"].times[::2])
    write_tdms(tmp_path / "m.tdms", {**channels, "Kraft_1": slow})
    answer = spring("diagnose", "./spring.py", "--inputs", "inputs.toml", "--data", "m.tdms", "-o", "d")
    assert answer.code == 0
    said = "note: channel 'Kraft_1': from 12 values to 24 rows at the times of 'Weg_1', linear interpolation; "
    assert f"{said}1 row lies outside its record\n" in answer.err
    assert "m.tdms: 24 rows, 23 used; 1 left out: line 25 (outside the time in which" in answer.err
    again = 'columns]\n"Untitled/Kraft_1" = "load"'
    assert again in (tmp_path / "d/inputs.toml").read_text(encoding="utf-8")


def test_cases_come_and_go_as_parquet(calc: Calc, tmp_path: Path) -> None:
    cases = {"case": Recorded(["light", "heavy"]), "load": Recorded([0.12, 0.14], "kN")}
    write_parquet(tmp_path / "cases.parquet", cases)
    (tmp_path / "cases.csv").write_text("case,load [kN]\nlight,0.12\nheavy,0.14\n", encoding="utf-8")
    for file in ("cases.parquet", "cases.csv"):
        answer = calc("run", PIN, "--cases", file, "-q", "-o", file.replace(".", "_"), "--set", "studies.run=[]")
        assert answer.code in {0, 1}, answer.err
    documents = [json.loads((tmp_path / f"cases_{end}/results.json").read_text()) for end in ("parquet", "csv")]
    assert documents[0]["cases"] == documents[1]["cases"]
    table = pyarrow.parquet.read_table(tmp_path / "cases_parquet/cases.parquet").to_pydict()
    assert table["case"] == ["light", "heavy"]
    assert table["depth [um]"] == [case["results"]["depth"]["value"] for case in documents[0]["cases"]]
    assert not (tmp_path / "cases_csv/cases.parquet").exists()


def test_a_table_is_written_as_parquet(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "i.toml").write_text("[inputs]\n", encoding="utf-8")
    write_tdms(tmp_path / "rows.tdms", {"load": Recorded([120.0, 130.0], "N"), "who": Recorded(["A", "B"])})
    for file in ("out.csv", "out.parquet"):
        assert calc("table", PIN, "--inputs", "i.toml", "--rows", "rows.tdms", "-o", file).code == 0
    lines = (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()
    table = pyarrow.parquet.read_table(tmp_path / "out.parquet")
    assert table.column_names == lines[0].split(",")
    assert [",".join(map(str, row.values())) for row in table.to_pylist()] == lines[1:]
    assert table.schema.field("load [N]").metadata == {b"unit": b"N"}
