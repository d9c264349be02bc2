"""The workbook of the tutorial for people who come from a spreadsheet, made as an engineer would type it.

``python tests/end_to_end/make_bracket.py`` writes docs/examples/bracket/bracket.xlsx. openpyxl writes texts, numbers
and formulas; LibreOffice, which must be installed, calculates the formulas and stores their values. So no value in the
workbook is ours. The measured rows of the sheet Rig are made with a fixed seed by the closed form of a clamped bar
whose clamp turns; they share nothing with docs/examples/bracket/bracket.py.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from openpyxl import Workbook
from openpyxl.styles import Alignment, Border, Font, PatternFill, Side
from openpyxl.worksheet.worksheet import Worksheet

BOOK = Path(__file__).parents[2] / "docs" / "examples" / "bracket" / "bracket.xlsx"
Row = list[Any]

SEED = 8
HIDDEN = 40e-6
"""What is wrong on the rig: the clamp turns by so much, in rad per N m of bending moment."""
TRUE_THICKNESS = 6.04e-3
"""m, of the bar on the rig."""
GAUGE_NOISE = 8e-6
"""m, standard deviation of one reading, before it is rounded to the last digit of the gauge, 0.01 mm."""

BRACKET: list[Row] = [
    ["Bracket LG-0815"],
    ["Flat bar, clamped at one end, force at the other. Blue: type in. Black: calculated."],
    [],
    ["Quantity", "Symbol", "Value", "Unit", "Remark"],
    ["Force at the end", "F", 450, "N", "largest force of the actuator"],
    ["From the clamp to the force", "l", 120, "mm", "drawing LG-0815"],
    ["Width", "b", 30, "mm", "flat bar 30 x 6"],
    ["Thickness", "t", 6, "mm", "flat bar 30 x 6"],
    ["Modulus of elasticity", "E", 210, "GPa", "steel"],
    ["Permitted stress", "σp", 320, "MPa", "works standard 12"],
    ["Permitted deflection", "wp", 2.5, "mm", "clearance to the gate"],
    [],
    ["Section modulus", "W", "=C7*C8^2/6", "mm³"],
    ["Second moment of area", "I", "=C7*C8^3/12", "mm⁴"],
    ["Bending moment", "M", "=C5*C6/1000", "N·m"],
    ["Bending stress", "σ", "=C15*1000/C13", "MPa"],
    ["Deflection at the force", "w", "=C5*C6^3/(3*C9*1000*C14)", "mm"],
    [],
    ["Stress", None, '=IF(C16<=C10,"ok","too high")'],
    ["Deflection", None, '=IF(C17<=C11,"ok","too far")'],
]
VARIANTS: list[Row] = [
    ["Load cases of the bracket"],
    ["case", "force", "length", "thickness"],
    [None, "N", "mm", "mm"],
    ["as drawn", "=Bracket!C5", "=Bracket!C6", "=Bracket!C8"],
    ["thin", "=Bracket!C5", "=Bracket!C6", 5.5],
    ["heavy", "=1.35*Bracket!C5", "=Bracket!C6", "=Bracket!C8"],
    ["heavy and short", "=1.35*Bracket!C5", 90, "=Bracket!C8"],
]


def rig() -> list[Row]:
    """The sheet Rig: three lengths, eight forces each, up and down, as a dial gauge shows them."""
    rng = np.random.default_rng(SEED)
    rows: list[Row] = [["Bar on the rig, weights hung on, dial gauge at the force"], ["force", "length", "deflection"]]
    rows[1].append("remark")
    rows.append(["N", "mm", "mm"])
    inertia = 30e-3 * TRUE_THICKNESS**3 / 12
    for length in (120, 90, 60):
        for force in [*range(50, 450, 50), *range(400, 0, -50)]:
            arm = length / 1000
            bent = force * arm**3 / (3 * 210e9 * inertia) + HIDDEN * force * arm * arm
            shown = bent + GAUGE_NOISE * rng.standard_normal()
            rows.append([force, length, round(shown * 1e3, 2)])
        rows[-16].append(f"clamped anew at {length} mm, gauge set to zero")
    return rows


BLUE, HEAD = Font(name="Calibri", size=11, color="0000FF"), PatternFill("solid", fgColor="DDE6F0")
LINE = Border(bottom=Side("thin"))


def write(sheet: Worksheet, rows: list[Row], header: int, columns: str) -> None:
    """Write rows with a title that is merged over all columns, and a header that is coloured."""
    for number, row in enumerate(rows, start=1):
        for column, value in zip(columns, row, strict=False):
            sheet[f"{column}{number}"] = value
            if isinstance(value, (int, float)):
                sheet[f"{column}{number}"].font = BLUE
    sheet.merge_cells(f"A1:{columns[-1]}1")
    sheet["A1"].font = Font(name="Calibri", bold=True, size=14)
    for column in columns:
        cell = sheet[f"{column}{header}"]
        cell.font, cell.fill, cell.border = Font(name="Calibri", size=11, bold=True), HEAD, LINE
        sheet.column_dimensions[column].width = 11
        cell.alignment = Alignment(horizontal="left" if column == "A" else "center")
    sheet.column_dimensions["A"].width = 28


def workbook() -> Workbook:
    """The workbook without the values of its formulas."""
    book = Workbook()
    bracket = book.active
    assert isinstance(bracket, Worksheet)
    bracket.title = "Bracket"
    write(bracket, BRACKET, 4, "ABCDE")
    bracket.merge_cells("A2:E2")
    bracket["A2"].font = Font(name="Calibri", size=11, italic=True)
    bracket.column_dimensions["E"].width = 28
    for row in range(13, 18):
        bracket[f"C{row}"].number_format = "0.00" if row == 17 else "0.0"
    for row in range(5, 21):
        bracket[f"C{row}"].alignment = Alignment(horizontal="right")
        bracket[f"D{row}"].alignment = Alignment(horizontal="center")
    variants = book.create_sheet("Variants")
    write(variants, VARIANTS, 2, "ABCD")
    measured = book.create_sheet("Rig")
    write(measured, rig(), 2, "ABCD")
    measured.column_dimensions["A"].width = 14
    measured.column_dimensions["D"].width = 40
    measured.freeze_panes = "A4"
    for column in "ABCD":
        for sheet in (variants, measured):
            sheet[f"{column}3"].alignment = Alignment(horizontal="center")
    for number in range(4, measured.max_row + 1):
        measured[f"C{number}"].number_format = "0.00"
    return book


def calculated(book: Path, into: Path) -> None:
    """Let LibreOffice calculate a workbook and save it into another folder."""
    office = shutil.which("soffice") or shutil.which("libreoffice")
    assert office, "LibreOffice calculates the formulas; install it"
    profile = f"-env:UserInstallation={(book.parent / 'profile').as_uri()}"
    words = [
        office,
        profile,
        "--headless",
        "--convert-to",
        "xlsx:Calc MS Excel 2007 XML",
        "--outdir",
        str(into),
        str(book),
    ]
    subprocess.run(words, check=True, timeout=300)


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        workbook().save(Path(folder) / BOOK.name)
        calculated(Path(folder) / BOOK.name, BOOK.parent)
    print(BOOK)
