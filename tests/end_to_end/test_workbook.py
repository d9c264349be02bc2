"""Workbooks on the command line and in Python: rows, cases and inputs go in, results come out with real numbers."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import truing
from shared import Calc
from truing.workbooks.writing import SheetTable, workbook_bytes

openpyxl = pytest.importorskip("openpyxl")

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
SPRING = Path(__file__).parents[2] / "docs" / "examples" / "coil_spring.py"
QUICK = ("--set", "studies.reliability.draws=2000", "-q")
CASES = [
    ["case", "load [N]", "note"],
    ["light", 60, "=1+1"],
    ["=2+2", 84.5, "-3"],
    ["@heavy", 130, "#N/A"],
]


def write(path: Path, **sheets: list[list[Any]]) -> Path:
    path.write_bytes(workbook_bytes([SheetTable(title, rows[0], rows[1:]) for title, rows in sheets.items()]))
    return path


def csv_of(path: Path, rows: list[list[Any]]) -> Path:
    path.write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n", encoding="utf-8")
    return path


def cells(path: Path, sheet: str) -> list[list[Any]]:
    return [list(row) for row in openpyxl.load_workbook(path)[sheet].values]


def results(folder: Path) -> Any:
    return json.loads((folder / "results.json").read_text(encoding="utf-8"))


def test_cases_in_a_workbook_are_those_in_csv(calc: Calc, tmp_path: Path) -> None:
    write(tmp_path / "job.xlsx", cases=CASES, rest=[["x"], [1]])
    csv_of(tmp_path / "job.csv", CASES)
    assert calc("run", PIN, "--cases", "job.xlsx#cases", *QUICK, "-o", "a").code == 0
    assert calc("run", PIN, "--cases", "job.csv", *QUICK, "-o", "b").code == 0
    found, plain = results(tmp_path / "a"), results(tmp_path / "b")
    assert found.pop("rows")["file"] == "job.xlsx#cases"
    assert plain.pop("rows")["file"] == "job.csv"
    assert found == plain
    run = truing.load(PIN).run(cases=tmp_path / "job.xlsx#cases", draws=2000, progress=False)
    assert run.document["cases"] == found["cases"]


def test_what_init_writes_runs_to_the_same_numbers(calc: Calc, tmp_path: Path) -> None:
    assert calc("init", PIN, "--excel", "-q").code == 0
    assert calc("init", PIN, "-o", "wear.toml", "-q").code == 0
    assert calc("run", PIN, "--inputs", "pin_wear.xlsx", *QUICK).code == 0
    assert calc("run", PIN, "--inputs", "wear.toml", *QUICK).code == 0
    assert results(tmp_path / "runs" / "pin_wear") == results(tmp_path / "runs" / "wear")
    again = calc("init", PIN, "-o", "pin_wear.xlsx")
    assert (again.code, again.err) == (
        2, "calc: pin_wear.xlsx exists already; choose another name or say --force\n",
    )  # fmt: skip
    odd = calc("init", PIN, "--excel", "-o", "wear.toml")
    assert (odd.code, odd.err) == (2, "calc: --excel writes a workbook; name it like wear.xlsx\n")


def test_a_run_writes_its_numbers_as_numbers(calc: Calc, tmp_path: Path) -> None:
    write(tmp_path / "job.xlsx", cases=CASES)
    said = calc("run", PIN, "--cases", "job.xlsx", "--xlsx", *QUICK[:2])
    assert said.code == 0
    assert f"for a spreadsheet: {Path('runs') / 'pin_wear' / 'results.xlsx'}" in said.err
    folder, document = tmp_path / "runs" / "pin_wear", results(tmp_path / "runs" / "pin_wear")
    head, *rows = cells(folder / "results.xlsx", "results")
    by_name = {row[head.index("name")]: row for row in rows if row[0] == "result"}
    for name, quantity in document["results"].items():
        assert by_name[name][head.index("value")] == pytest.approx(quantity["value"], rel=1e-14), name
        assert (by_name[name][head.index("unit")] or "") == quantity["unit"]
    head, *rows = cells(folder / "results.xlsx", "cases")
    assert "load [N]" in head
    assert [row[0] for row in rows] == ["light", "=2+2", "@heavy"]
    sheet = openpyxl.load_workbook(folder / "results.xlsx")["cases"]
    assert sheet.freeze_panes == "A2"
    assert [sheet.cell(row, 1).data_type for row in (2, 3, 4)] == ["s"] * 3
    assert sheet.cell(3, 1).quotePrefix
    depth = sheet.cell(2, [*head].index("depth [um]") + 1)
    assert isinstance(depth.value, float)
    printed = truing.load(PIN).run(load="60 N", draws=2000, progress=False)
    text = next(row["text"] for row in printed._rows() if row["name"] == "depth").split(" ")[0]
    assert f"{depth.value:.{len(depth.number_format.partition('.')[2])}f}" == text


def test_a_table_goes_in_and_out_by_the_ending_of_its_name(calc: Calc, tmp_path: Path) -> None:
    rows = [["load [N]", "run", "note"], [60, "a", "=1+1"], [84.5, "b", None]]
    write(tmp_path / "rows.xlsx", rows=rows)
    (tmp_path / "rows.csv").write_text("load [N],run,note\n60,a,=1+1\n84.5,b,\n")
    (tmp_path / "wear.toml").write_text("[inputs]\n")
    table = ("table", PIN, "--inputs", "wear.toml", "-q", "--rows")
    assert calc(*table, "rows.xlsx", "-o", "out.xlsx").code == 0
    assert calc(*table, "rows.xlsx", "-o", "a.csv").code == 0
    assert calc(*table, "rows.csv", "-o", "b.csv").code == 0
    assert (tmp_path / "a.csv").read_text() == (tmp_path / "b.csv").read_text()
    head, *values = cells(tmp_path / "out.xlsx", "rows")
    lines = [line.split(",") for line in (tmp_path / "b.csv").read_text().splitlines()]
    assert head == lines[0]
    for row, line in zip(values, lines[1:], strict=True):
        for cell, text in zip(row, line, strict=True):
            assert (
                cell == pytest.approx(float(text), rel=1e-14) if isinstance(cell, float | int) else (cell or "") == text
            )
    overwritten = calc(*table, "rows.xlsx#rows", "-o", "rows.xlsx")
    assert (overwritten.code, overwritten.err) == (
        2, "calc: rows.xlsx is read by this command; name another file for the output\n",
    )  # fmt: skip


def test_a_diagnosis_of_a_workbook_is_that_of_the_rows(calc: Calc, tmp_path: Path) -> None:
    rows: list[list[Any]] = [["load [N]", "time [h]", "depth [um]"]]
    model = truing.load(PIN)
    for load in (60, 80, 100, 120):
        for hours in (50, 100, 150, 200):
            depth = model.run(load=load, time=f"{hours} h", set={"studies.run": []}, progress=False)["depth"].m
            rows.append([load, hours, round(depth + 12 + 0.1 * ((load * hours) % 7), 2)])
    write(tmp_path / "measured.xlsx", measured=rows)
    csv_of(tmp_path / "measured.csv", rows)
    said = calc("diagnose", PIN, "measured.xlsx", "--xlsx")
    assert said.code == 0
    assert calc("diagnose", PIN, "measured.csv", "-q", "-o", "csv").code == 0
    books, plain = (
        json.loads((tmp_path / folder / "diagnosis.json").read_text(encoding="utf-8").replace(".xlsx", ".csv"))
        for folder in (Path("runs", "measured"), Path("csv"))
    )
    assert books == plain
    book = tmp_path / "runs" / "measured" / "diagnosis.xlsx"
    head, *found = cells(book, "rows")
    depths = [row[head.index("depth [um]")] for row in found]
    assert depths == pytest.approx([rows[row[head.index("line")] - 1][2] for row in found], rel=1e-12)
    assert {"depth_before [um]", "depth_after [um]", "line"} <= {*head}
    assert len(cells(book, "ranking")) == len(plain["ranking"]) + 1
    table = list(csv.DictReader((book.parent / "rows.csv").read_text(encoding="utf-8").splitlines()))
    for name in ("depth [um]", "depth_before [um]", "depth_after [um]"):
        of_book = [row[head.index(name)] for row in found]
        assert [float(row[name]) for row in table] == pytest.approx(of_book, rel=1e-14)
    for row in csv.DictReader((tmp_path / "csv" / "results.csv").read_text(encoding="utf-8").splitlines()):
        if row["part"] == "error":
            gain = plain["gain"][row["name"]][row["place"]]
            assert (float(row["value"]), row["unit"], row["symbol"]) == (gain["value"], gain["unit"], "h")
        if row["part"] == "calibrated" and not row["place"]:
            assert float(row["value"]) == plain["calibrated"][row["name"]]["value"]
    assert openpyxl.load_workbook(book).sheetnames == ["causes", "ranking", "errors", "rows"]
    assert truing.read(tmp_path / "measured.xlsx", model).rows == 16


def test_faults_of_a_workbook_name_their_cells_and_nothing_is_written(calc: Calc, tmp_path: Path) -> None:
    bad = [["case", "load"], ["a", "much"], ["b", -3]]
    write(tmp_path / "job.xlsx", cases=[["case", "load [N]", "laod [N]"], ["a", "much", 1], ["b", -3, 1]])
    said = calc("run", PIN, "--cases", "job.xlsx", *QUICK)
    assert said.code == 2
    places = [line.partition(": ")[0] for line in said.err.splitlines()]
    assert places == ["job.xlsx, cases!C1", "job.xlsx, cases!B2", "job.xlsx, cases!B3"]
    write(tmp_path / "inputs.xlsx", inputs=[["name", "value", "unit"], ["load", 3, "m"], ["speed", "fast", "m/s"]])
    said = calc("run", PIN, "--inputs", "inputs.xlsx", *QUICK)
    assert said.code == 2
    places = [line.partition(": ")[0] for line in said.err.splitlines()]
    assert places == ["inputs.xlsx, inputs!B2", "inputs.xlsx, inputs!B3"]
    write(tmp_path / "measured.xlsx", measured=[["load [N]", "depth [um]"], *bad[1:]])
    said = calc("diagnose", PIN, "--data", "measured.xlsx")
    assert said.code == 2
    assert "measured.xlsx, measured!A2: load: 'a' is no number" in said.err
    assert not (tmp_path / "runs").exists()


def test_without_the_library_nothing_is_calculated_first(
    calc: Calc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    for words in (("run", PIN, "--xlsx"), ("init", PIN, "-o", "a.xlsx")):
        said = calc(*words, "-q")
        sentence = "calc: a workbook needs openpyxl, which is not installed: pip install 'truing[excel]'\n"
        assert (said.code, said.err) == (2, sentence)
    assert list(tmp_path.iterdir()) == []


def test_a_planned_experiment_is_a_workbook_to_fill_in(tmp_path: Path) -> None:
    box = {"studies.diagnose.box": '{ compression = "1..10 mm", spring_temperature = "20..120 degC" }'}
    causes, noise = ["softening", "thermal_drift"], {"force": "0.02 N"}
    plan = truing.load(SPRING).plan(causes, noise=noise, set=box, progress=False)
    head, *rows = cells(plan.save(tmp_path / "readings.xlsx"), "readings")
    assert len(rows) == plan.document["experiment"]["readings"]
    assert {row[head.index("force [N]")] for row in rows} == {None}


def by_libreoffice(book: Path, *, to: str, into: Path) -> None:
    """Let LibreOffice open a workbook and save it as something else."""
    office = shutil.which("soffice") or shutil.which("libreoffice")
    if office is None:
        pytest.skip("LibreOffice is not installed")
    profile = f"-env:UserInstallation={(book.parent / 'profile').as_uri()}"
    words = [office, profile, "--headless", "--convert-to", to, "--outdir", str(into), str(book)]
    subprocess.run(words, check=True, timeout=300)


def test_libreoffice_opens_what_is_written(calc: Calc, tmp_path: Path) -> None:
    write(tmp_path / "job.xlsx", cases=CASES)
    assert calc("run", PIN, "--cases", "job.xlsx", "--xlsx", *QUICK).code == 0
    second_sheet = "csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,true,false,false,false,2"
    by_libreoffice(tmp_path / "runs" / "pin_wear" / "results.xlsx", to=second_sheet, into=tmp_path)
    text = next(tmp_path.glob("results*.csv")).read_text(encoding="utf-8")
    assert text.splitlines()[0].startswith("case,row,load [N]")
    assert [line.split(",")[0] for line in text.splitlines()[1:]] == ["light", "=2+2", "@heavy"]


def test_what_libreoffice_saves_reads_as_it_was(calc: Calc, tmp_path: Path) -> None:
    assert calc("init", PIN, "--excel", "-q").code == 0
    write(tmp_path / "job.xlsx", cases=CASES)
    (tmp_path / "saved").mkdir()
    for name in ("pin_wear.xlsx", "job.xlsx"):
        by_libreoffice(tmp_path / name, to="xlsx", into=tmp_path / "saved")
    for folder in (".", "saved"):
        files = ("--inputs", f"{folder}/pin_wear.xlsx", "--cases", f"{folder}/job.xlsx")
        assert calc("run", PIN, *files, *QUICK, "-o", f"{folder}/run").code == 0
    assert results(tmp_path / "run") == results(tmp_path / "saved" / "run")
