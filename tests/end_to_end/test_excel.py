"""Tables beside every run; with --excel a spreadsheet with a decimal comma opens them, and we read them back."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example
from hypothesis import given as drawn
from hypothesis import settings as drawing
from hypothesis import strategies as st

from shared import Calc
from truing.atomic import write_files
from truing.measurements import EXCEL, read_table, table_text
from truing.units import from_si

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
QUICK = ("--set", "studies.reliability.draws=2000", "-q")


def as_a_spreadsheet_reads(path: Path) -> list[list[str]]:
    """The cells of a file as the spreadsheet takes them: after the mark, at semicolons, lines ended by CR LF."""
    raw = path.read_bytes()
    assert raw.startswith(b"\xef\xbb\xbf")
    assert raw.count(b"\n") == raw.count(b"\r\n")
    return list(csv.reader(raw.decode("utf-8-sig").splitlines(), delimiter=";"))


def number(cell: str) -> float:
    """A cell as a number where the decimal mark is a comma."""
    assert "." not in cell
    return float(cell.replace(",", "."))


def leaves(document: Any) -> Iterator[float]:
    """Every number in a document."""
    if isinstance(document, dict):
        document = list(document.values())
    if isinstance(document, list):
        for one in document:
            yield from leaves(one)
    elif isinstance(document, (int, float)) and not isinstance(document, bool):
        yield document


def test_a_table_for_a_spreadsheet_holds_the_same_numbers(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "wear.toml").write_text("[inputs]\n")
    (tmp_path / "rows.csv").write_text(
        "load [N],batch,note\n0.1,=1+1,2.5\n123.5,@home,\n1e2,-3,ä;b\n", encoding="utf-8"
    )
    table = ("table", PIN, "--inputs", "wear.toml", "--rows", "rows.csv", "-q")
    assert calc(*table, "-o", "plain.csv").code == 0
    assert calc(*table, "--excel", "-o", "sheet.csv").code == 0
    head, *rows = as_a_spreadsheet_reads(tmp_path / "sheet.csv")
    plain_head, *plain = csv.reader((tmp_path / "plain.csv").read_text(encoding="utf-8").splitlines())
    assert head == plain_head == ["load [N]", "batch", "note", "pressure [MPa]", "distance [km]", "depth [um]"]
    assert [row[0] for row in rows] == ["0,1", "123,5", "1e2"]
    assert [row[1] for row in rows] == ["'=1+1", "'@home", "-3"]
    assert [row[2] for row in rows] == ["2.5", "", "ä;b"]
    assert [list(map(number, row[3:])) for row in rows] == [list(map(float, row[3:])) for row in plain]
    assert calc(*table[:5], "sheet.csv", "-q").out == (tmp_path / "plain.csv").read_text(encoding="utf-8")


def test_without_a_file_there_is_nothing_to_open(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "wear.toml").write_text("[inputs]\n")
    (tmp_path / "rows.csv").write_text("load [N]\n1\n")
    answer = calc("table", PIN, "--inputs", "wear.toml", "--rows", "rows.csv", "--excel")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "calc: --excel writes a file for a spreadsheet; name it with -o\n"


WORDS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=9)
FORMULAS = st.builds(str.__add__, st.sampled_from(["=", "＝", "'=", "''+", "-", " @", "'", "#", '"', "=\n"]), WORDS)


@drawing(max_examples=60, deadline=None)
@example([("pin", 1.875)])  # no other number says that its comma parts no thousands
@example([("pin", math.nan)])  # a column of nothing is one of numbers where it is known as one
@drawn(st.lists(st.tuples(FORMULAS, st.floats(allow_infinity=False)), min_size=1))
def test_anything_reads_back_as_it_was(tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[str, float]]) -> None:
    path = tmp_path_factory.getbasetemp() / "sheet.csv"
    words, numbers = (list(column) for column in zip(*rows, strict=True))
    write_files({path: table_text(["run", "x [mm]"], [words, numbers], form=EXCEL)})
    found, _ = read_table(path, {"x": "mm"})
    assert found.columns["run"] == tuple(re.sub(r"[\r\n]+", " ", word).strip() for word in words)
    read = from_si(found.columns["x"], "mm")
    assert [float(one) for one in read] == pytest.approx(numbers, rel=1e-15, nan_ok=True)
    cells = [row[0] for row in csv.reader(path.open(encoding="utf-8-sig", newline=""), delimiter=";")]
    for cell in cells:
        if cell.lstrip().startswith(("=", "+", "-", "@")) and len(cell.strip()) > 1:
            assert math.isfinite(float(cell.replace(",", ".", 1)))  # a number with its sign, no formula


def test_every_number_of_a_run_stands_in_its_table(calc: Calc, tmp_path: Path) -> None:
    assert calc("run", PIN, "--excel", *QUICK).code == 0
    folder = tmp_path / "runs" / "pin_wear"
    head, *rows = as_a_spreadsheet_reads(folder / "results.csv")
    document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    found = sorted(number(row[head.index("value")]) for row in rows if _is_number(row[head.index("value")]))
    limits = [number(row[place]) for row in rows for place in (head.index("limit"), head.index("margin")) if row[place]]
    assert sorted([*found, *limits]) == sorted(leaves(document))
    said = {
        (row[0], row[1], row[head.index("place")]): (row[head.index("value")], row[head.index("unit")]) for row in rows
    }
    load = document["inputs"]["load"]
    assert (number(said["input", "load", ""][0]), said["input", "load", ""][1]) == (load["value"], "N")
    assert read_table(folder / "results.csv", {})[0].columns["part"] == tuple(row[0] for row in rows)


def _is_number(cell: str) -> bool:
    try:
        number(cell)
    except (AssertionError, ValueError):
        return False
    return True


def test_cases_come_with_a_table_of_their_own(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("case,load [kN]\n=light,0.14\nheavy,2.296\nbroken,500\n")
    said = calc("run", PIN, "--cases", "cases.csv", "--excel", *QUICK[:2])
    assert said.code == 1
    folder = tmp_path / "runs" / "pin_wear"
    head, *rows = as_a_spreadsheet_reads(folder / "cases.csv")
    assert head[:3] == ["case", "row", "load [N]"]
    assert head[-2:] == ["margin [1]", "verdict"]
    assert [row[0] for row in rows] == ["'=light", "heavy", "broken"]
    document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    pressures = [number(row[head.index("pressure [MPa]")]) for row in rows[:2]]
    assert pressures == [case["results"]["pressure"]["value"] for case in document["cases"][:2]]
    assert rows[1][-1] == "FAILS, governing"
    assert rows[2][-1] == "failed: the contact flows: load exceeds hardness times area"
    assert rows[2][head.index("pressure [MPa]")] == ""
    assert f"for a spreadsheet: {folder.relative_to(tmp_path) / 'results.csv'} and " in said.err
    for sheet in ("sheet.html", "sheet.md"):
        assert all(row[0].strip("'") in (folder / sheet).read_text(encoding="utf-8") for row in rows)


def plain(path: Path) -> list[dict[str, str]]:
    """The rows of a table as any program reads CSV."""
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def test_every_run_leaves_tables_that_any_program_reads(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("case,load [kN]\n=light,0.14\n@heavy,0.28\n-3,0.2\n")
    assert calc("run", PIN, "--cases", "cases.csv", *QUICK).code == 0
    folder = tmp_path / "runs" / "pin_wear"
    document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    rows = {(row["part"], row["name"], row["place"]): row for row in plain(folder / "results.csv")}
    for part in ("result", "input"):
        for name, quantity in document[f"{part}s"].items():
            row = rows[part, name, ""]
            assert (float(row["value"]), row["unit"]) == (quantity["value"], quantity["unit"]), name
    assert (rows["result", "depth", ""]["symbol"], rows["result", "depth", ""]["note"]) == ("h", "worn depth")
    (check, *_) = document["checks"]
    row = rows["check", check["name"], ""]
    assert [float(row[name]) for name in ("value", "limit", "margin")] == [
        check[name] for name in ("value", "limit", "margin")
    ]
    assert (row["unit"], row["verdict"]) == (check["unit"], "pass")
    cases = plain(folder / "cases.csv")
    assert [case["case"] for case in cases] == ["'=light", "'@heavy", "-3"]
    assert [float(case["pressure [MPa]"]) for case in cases] == [
        case["results"]["pressure"]["value"] for case in document["cases"]
    ]


def test_a_sweep_leaves_tables_too(calc: Calc, tmp_path: Path) -> None:
    assert calc("sweep", PIN, "load", "80..120 N", "--steps", "3", "-q", "-o", "swept").code == 0
    assert [float(row["load [N]"]) for row in plain(tmp_path / "swept" / "points.csv")] == [80, 100, 120]
    assert "study" in {row["part"] for row in plain(tmp_path / "swept" / "results.csv")}
