"""A plugin drafted from a column of a workbook: what each cell becomes, and the comparison with the stored values."""

from __future__ import annotations

import math
import re
import zipfile
from pathlib import Path
from typing import Any

import pytest

from shared import Calc
from truing import Kernel
from truing.drafted import draft_of, drafted_file
from truing.errors import InputError
from truing.formulas.evaluation import evaluate
from truing.formulas.parsing import parse
from truing.kernel.loading import load_file
from truing.new_project import NewPlugin
from truing.published import compare_published
from truing.workbooks.cell_formulas import translated

openpyxl = pytest.importorskip("openpyxl")

Rows = list[tuple[Any, ...]]
SLIDE: Rows = [
    ("Slide", None, None, None),
    ("Force:", 2.5, "kN", "data sheet"),
    ("Slope [deg]", 30, None, None),
    ("Efficiency", 0.8, "-", "guess"),
    ("Power", "=B7*B8/1000", "W", None, 800),
    ("Lost power", "=B5*(1-B4)", "W", None, 160),
    ("Force down the slope", "=B2*1000*SIN(B3*PI()/180)", "N", None, 1250),
    ("Speed", "=VLOOKUP(B3,Other!A1:B9,2)", "mm/s", None, 640),
    ("Class", 7, "pcs", None),
    ("Time", "=60*B8/B7", "s", None, 12),
    ("Enough?", '=IF(B5>500,"yes","no")', None, None, "yes"),
]
"""Label, what was typed, unit, remark, and for a formula the value that is stored; worked out by hand, one is wrong."""


def book(path: Path, rows: Rows) -> Path:
    """Write a workbook with formulas and their stored values, as Excel leaves them."""
    made = openpyxl.Workbook()
    for row in rows:
        made.active.append(row[:4])
    made.save(path)
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    sheet = parts["xl/worksheets/sheet1.xml"].decode()
    for number, row in enumerate(rows, start=1):
        if len(row) > 4:
            kind = ' t="str"' if isinstance(row[4], str) else ""
            cell = rf'<c r="B{number}"[^>]*>(<f>.*?</f>)<v(?: ?/>|></v>)'
            sheet, count = re.subn(cell, rf'<c r="B{number}"{kind}>\1<v>{row[4]}</v>', sheet)
            assert count == 1
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in parts.items():
            archive.writestr(name, sheet if name == "xl/worksheets/sheet1.xml" else content)
    return path


@pytest.mark.parametrize(
    ("typed", "value"),
    [
        ("=-B1^2", 9.0),  # a minus binds tighter than a power
        ("=2^B1^2", 64.0),  # and powers go from left to right
        ("=10-B1-2", 5.0),
        ("=12/B1/2", 2.0),
        ("=2^-1+B1*50%", 2.0),
        ("=(1+$B$1)*-(2-Sheet!B1)", 4.0),
        ("=MAX(B1, 4,5)/MIN(B1,2)", 2.5),
        ("=SQRT(ABS(-B1-1))", 2.0),
        ("=LN(EXP(B1))+LOG10(100)", 5.0),
        ("=COS(PI()/B1)+SIN(RADIANS(0))+TAN(0)", 0.5),
    ],
)
def test_a_formula_has_the_value_that_a_spreadsheet_gives_it(typed: str, value: float) -> None:
    names = {"B1": "width", "Sheet!B1": "width"}
    assert evaluate(parse(translated(typed, names.__getitem__)), {"width": 3.0}) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("typed", "why"),
    [
        ('=IF(B1>2,"a","b")', "IF cannot"), ("=B1&B1", "& cannot"), ("=B1<2", "< cannot"), ("=(B1", "ends too early"),
        ("=SQRT(B1,B1)", "SQRT of 2 arguments"), ("=" + "(" * 2000 + "B1" + ")" * 2000, "cannot be read"),
        ("=SUM(B1)", "SUM cannot"), ("=TRUE", "TRUE cannot"), ("=B1)", "cannot be read"),
    ],
)  # fmt: skip
def test_what_cannot_be_translated_is_said(typed: str, why: str) -> None:
    with pytest.raises(ValueError, match=re.escape(why)):
        translated(typed, str.lower)


def test_each_cell_becomes_what_it_is(tmp_path: Path) -> None:
    draft = draft_of(book(tmp_path / "slide.xlsx", SLIDE))
    assert [(one.name, one.stored, one.unit, one.source) for one in draft.inputs] == [
        ("force", 2.5, "kN", "data sheet"),
        ("slope", 30, "deg", ""),
        ("efficiency", 0.8, "", "guess"),
        ("class_value", 7, "", ""),
        ("speed", 640, "mm/s", ""),
    ]
    assert {one.name: one.formula for one in draft.results} == {
        "force_down_the_slope": "force * sin(slope)",
        "power": "force_down_the_slope * speed",
        "lost_power": "power * (1 - efficiency)",
        "time": "60 * speed / force_down_the_slope",
    }
    assert [(cell.cell, cell.note) for cell in draft.left_out] == [("B11", "Enough?")]
    wrong = next(sentence for sentence in draft.said if sentence.startswith("time (B10"))
    ratio = 60 * 0.64 / 1250 / 12
    assert f"gives {ratio:.6g} times the 12 s of the workbook" in wrong
    assert "class_value (B9): 'pcs' is no unit" in draft.said[-1]
    assert len(draft.said) == 4


def test_the_drafted_file_calculates_what_the_workbook_stored(tmp_path: Path) -> None:
    rows = [row for row in SLIDE if row[0] not in {"Class", "Time"}]
    rows[-1] = (*rows[-1][:4], "yes\nand no")
    path = book(tmp_path / "sl'ide.xlsx", [*rows, ("Least", "=MIN(B2*1000,B7,2*B7)", "N", None, 1250)])
    file = tmp_path / "slide.py"
    file.write_text(drafted_file(NewPlugin("slide", 'The "slide"'), draft_of(path), path.name), encoding="utf-8")
    kernel = Kernel()
    kernel.add_file(file)
    compared = compare_published(kernel.offer("slide"))
    assert {row.published.result for row in compared} == {"force_down_the_slope", "power", "lost_power", "least"}
    assert all(row.matches and math.isclose(row.ratio or 0, 1, rel_tol=1e-9) for row in compared)
    source = file.read_text(encoding="utf-8")
    assert "# B8: =VLOOKUP(B3,Other!A1:B9,2) is not translated, VLOOKUP cannot be translated" in source
    load_file(file).test_what_every_calculation_must_keep()


def test_formulas_in_a_circle_begin_with_a_stored_value(tmp_path: Path) -> None:
    rows: Rows = [("a", 1, "m"), ("b", "=B3+B1", "m", None, 3), ("c", "=B2-B1", "m", None, 2)]
    draft = draft_of(book(tmp_path / "circle.xlsx", rows))
    assert ([one.name for one in draft.inputs], [one.name for one in draft.results]) == (["a", "b"], ["c"])


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        ([("a", 1, "m"), ("b", "=2*B1", "m")], "values were never stored"),
        ([("a", 1, "m"), ("b", 2, "m")], "holds no formula of numbers"),
        ([("a", None, "m")], "holds no numbers and no formulas"),
        ([("a", 1, "m")] * 301, "holds 301 numbers and formulas in one column"),
    ],
)
def test_what_is_no_calculation_is_refused_in_one_sentence(
    tmp_path: Path, calc: Calc, rows: Rows, sentence: str
) -> None:
    path = book(tmp_path / "book.xlsx", rows)
    with pytest.raises(InputError, match=sentence):
        draft_of(path)
    answer = calc("new", "my_slide", "--from", path)
    assert (answer.code, answer.err.count("\n")) == (2, 1)
    assert sentence in answer.err
    assert [file.name for file in tmp_path.iterdir()] == ["book.xlsx"]
