"""The workbook of the tutorial that starts from a spreadsheet: its cells, their values, what is hidden in it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from measured import read_document
from shown_in_docs import EXAMPLES, ROOT

openpyxl = pytest.importorskip("openpyxl")
make_bracket = pytest.importorskip("make_bracket")  # it needs openpyxl

BOOK = EXAMPLES / "bracket" / "bracket.xlsx"
PAGE = ROOT / "docs" / "tutorial" / "from_your_spreadsheet.md"


def cells(book: Any) -> dict[str, list[tuple[Any, ...]]]:
    return {sheet.title: list(sheet.values) for sheet in book.worksheets}


def test_the_shipped_workbook_has_the_cells_that_the_script_writes() -> None:
    made = cells(make_bracket.workbook())
    assert cells(openpyxl.load_workbook(BOOK)) == made
    assert sum(str(cell).startswith("=") for rows in made.values() for row in rows for cell in row) == 17


def test_every_formula_has_a_stored_value_and_those_of_the_bracket_are_right() -> None:
    formulas, stored = openpyxl.load_workbook(BOOK), openpyxl.load_workbook(BOOK, data_only=True)
    for sheet in formulas:
        for row in sheet.iter_rows():
            for cell in row:
                assert (cell.value is None) == (stored[sheet.title][cell.coordinate].value is None), cell.coordinate
    section, inertia = 30 * 6**2 / 6, 30 * 6**3 / 12
    by_hand = [section, inertia, 450 * 0.12, 450 * 120 / section, 450 * 120**3 / (3 * 210e3 * inertia)]
    found = [stored["Bracket"][f"C{row}"].value for row in range(13, 18)]
    assert found == pytest.approx(by_hand, rel=1e-12)


def test_the_page_shows_the_cells_of_the_workbook() -> None:
    """Tables of the page: rows by their number, cells as Excel shows them, the formulas of column C."""
    formulas, stored = (openpyxl.load_workbook(BOOK, data_only=values)["Bracket"] for values in (False, True))
    rows = re.findall(r"^\| (\d+) \| (.+) \|$", PAGE.read_text(encoding="utf-8").split("## 2.")[0], re.MULTILINE)
    assert len(rows) == 14
    for number, text in rows:
        *shown, formula = [part.strip() for part in text.split(" |")]
        for column, cell in zip("ABCDE", shown, strict=True):
            value = stored[f"{column}{number}"].value
            if isinstance(value, (int, float)):
                assert float(cell.strip("| ")) == pytest.approx(value, abs=5e-3)
            else:
                assert cell.strip("| ") == (value or "")
        typed = str(formulas[f"C{number}"].value)
        assert formula.strip("|` ") == (typed if typed.startswith("=") else "")


def test_the_diagnosis_of_the_rig_finds_what_the_readme_says(page_done: Callable[[Path], Path]) -> None:
    readme = (BOOK.parent / "README.md").read_text(encoding="utf-8")
    (told,) = re.findall(r"\*\*(\d+) µrad/\(N·m\)\*\*", readme)
    assert float(told) * 1e-6 == pytest.approx(make_bracket.HIDDEN)
    document = read_document(page_done(PAGE) / "work" / "bracket" / "runs" / "rig")
    (cause,) = document["causes"]
    assert (document["verdict"], cause["effect"]) == ("named", "soft_clamp")
    low, high = cause["unknowns"]["turn"]["interval95"]
    scale = {"rad/(N*m)": 1.0, "urad/(N*m)": 1e-6}[cause["unknowns"]["turn"]["unit"]]
    assert low * scale < make_bracket.HIDDEN < high * scale
    assert document["calibrated"]["thickness"]["value"] == pytest.approx(make_bracket.TRUE_THICKNESS * 1e3, abs=0.1)
    assert math.isclose(make_bracket.SEED, float(re.findall(r"seed (\d+)", readme)[0]))
