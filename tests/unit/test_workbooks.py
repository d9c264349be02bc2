"""Workbooks: the cells of a sheet as rows, their faults with file, sheet and cell; nothing in them runs."""

from __future__ import annotations

import math
import sys
import zipfile
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime, time, timedelta
from operator import attrgetter
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sample_models import PIN_OFFER

from truing import Kernel
from truing.errors import InputError, UsageError
from truing.example_file import example_book, example_of
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Offer
from truing.measurements import DataTable, read_table
from truing.runs.inputs_written import complete_inputs
from truing.setup import Setup
from truing.workbooks import reading, writing
from truing.workbooks.writing import Printed, SheetTable, workbook_bytes

openpyxl = pytest.importorskip("openpyxl")

KNOWN = {"time": "h", "depth": "um", "share": "%", "rate": ""}
HEAD = ["time [h]", "depth [um]"]


def book(
    path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]], finish: Callable[[Any], None] | None = None
) -> Path:
    """Write cells as Excel would."""
    made = openpyxl.Workbook()
    made.remove(made.active)
    for title, rows in sheets.items():
        sheet = made.create_sheet(title)
        for row in rows:
            sheet.append(list(row))
    if finish is not None:
        finish(made)
    made.save(path)
    return path


def read(path: Path | str, *, is_measured: bool = True) -> DataTable:
    """Read a table that has no faults."""
    table, found = read_table(Path(path), KNOWN, is_measured=is_measured)
    found.raise_any()
    return table


def faults(path: Path | str) -> list[str]:
    """Return what is wrong, from the name of the file on."""
    with pytest.raises(InputError) as caught:
        read(path)
    return [str(fault).removeprefix(str(Path(path).parent)).lstrip("/\\") for fault in caught.value.faults]


def column(table: DataTable, name: str) -> list[Any]:
    values = table.columns[name]
    return list(values) if isinstance(values, tuple) else values.tolist()


def test_a_sheet_reads_as_the_same_rows_in_csv(tmp_path: Path) -> None:
    rows = [[*HEAD, "run"], [1, 2.5, "a"], [0.1234567890123, None, "b"], [None, None, None], [3e-7, -12, "a"]]
    found = read(book(tmp_path / "b.xlsx", {"Sheet1": rows}))
    lines = [",".join("" if cell is None else str(cell) for cell in row) for row in rows]
    (tmp_path / "b.csv").write_text("\n".join("" if line == ",," else line for line in lines), encoding="utf-8")
    expected = read(tmp_path / "b.csv")
    for name in ("time", "depth", "run"):
        assert str(column(found, name)) == str(column(expected, name))
    assert found.lines == (2, 3, 5)
    assert found.count.in_file == found.count.used == 3


@pytest.mark.parametrize(
    "place", ["#rows", "#ROWS", "#rows!A3:B5", "#'rows'!$A$3:$B$5", "#rows!A:B", "#measured", "#two words!B2:C4"]
)
def test_a_place_is_a_sheet_a_range_or_a_name(tmp_path: Path, place: str) -> None:
    def named(made: Any) -> None:
        made.defined_names["measured"] = openpyxl.workbook.defined_name.DefinedName(
            "measured", attr_text="rows!$A$3:$B$5"
        )

    data = [HEAD, [1, 2], [3, 4]]
    inside = [[None, *row, "aside"] for row in [["", ""], *data]]
    above = [["# drawn up by hand"], []]
    path = book(tmp_path / "b.xlsx", {"rows": [*above, *data], "two words": inside}, named)
    assert column(read(f"{path}{place}"), "depth") == pytest.approx([2e-6, 4e-6])


def test_a_place_that_is_not_there_is_one_sentence(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"one": [HEAD, [1, 2]], "two": [HEAD]})
    assert faults(path) == ["b.xlsx: holds the sheets 'one', 'two'; name one: b.xlsx#one"]
    assert faults(f"{path}#three") == ["b.xlsx: has no sheet 'three'; it holds the sheets 'one', 'two'"]
    assert faults(f"{path}#one!B") == ["b.xlsx: 'B' is no range of cells; write it like b.xlsx#one!A3:F60"]
    hidden = book(tmp_path / "h.xlsx", {"rows": [HEAD, [1, 2]], "lists": []}, lambda made: hide(made["lists"]))
    assert len(read(hidden)) == 1


def hide(sheet: Any) -> None:
    sheet.sheet_state = "hidden"


def test_a_file_whose_name_holds_the_mark_is_that_file(tmp_path: Path) -> None:
    path = book(tmp_path / "a.xlsx", {"s": [HEAD, [1, 2]]})
    odd = path.rename(tmp_path / "a.xlsx#b.xlsx")
    assert len(read(odd)) == 1


@pytest.mark.parametrize("units", [["h", "um", None], ["[h]", "[µm]", "-"], [" h ", "um", None]])
def test_units_stand_in_a_row_of_their_own(tmp_path: Path, units: list[str | None]) -> None:
    rows = [["time", "depth", "run"], units, [1, 2, "a"], [2, 3, "b"]]
    table = read(book(tmp_path / "b.xlsx", {"s": rows}))
    assert column(table, "time") == [3600, 7200]
    assert column(table, "depth") == pytest.approx([2e-6, 3e-6])
    assert table.lines == (3, 4)


def test_a_row_of_words_that_are_units_too_is_a_row(tmp_path: Path) -> None:
    table = read(book(tmp_path / "b.xlsx", {"s": [["case", "grade"], ["A", "m"], ["B", "s"]]}), is_measured=False)
    assert table.lines == (2, 3)


def test_titles_and_group_heads_that_are_merged_stand_above_the_header(tmp_path: Path) -> None:
    def merge(made: Any) -> None:
        for cells in ("A1:C1", "B2:C2", "A2:A3"):
            made["s"].merge_cells(cells)

    rows = [["Test 4"], ["time", "wear"], [None, "depth", "share"], ["h", "um", "%"], [1, 2, 3], [2, 3, 4]]
    table = read(book(tmp_path / "b.xlsx", {"s": rows}, merge))
    assert list(table.columns) == ["time", "depth", "share"]
    assert column(table, "share") == [0.03, 0.04]
    assert table.header_line == 3


def test_a_head_cell_merged_over_empty_columns_is_one_column(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [["time [h]", None, "depth [um]"], [1, None, 2]]})
    assert column(read(path), "depth") == pytest.approx([2e-6])
    path = book(tmp_path / "c.xlsx", {"s": [["time [h]", None, "depth [um]"], [1, 7, 2], [1, 8, 2]]})
    assert faults(path) == [
        "c.xlsx, s!B2: stands in a column whose header is empty; name the column, or the range of the table"
    ]


def test_dates_and_durations_are_times_where_the_unit_is_one_of_time(tmp_path: Path) -> None:
    start = datetime(2026, 3, 4, 8, 0, 0)
    rows = [
        ["time [h]", "day", "rate"],
        [start, start, 1],
        [start + timedelta(minutes=90), start, 2],
    ]
    table = read(book(tmp_path / "b.xlsx", {"s": rows}))
    assert column(table, "time") == [0, 5400]
    assert column(table, "day") == ["2026-03-04 08:00:00"] * 2
    table = read(book(tmp_path / "c.xlsx", {"s": [["time [h]"], [timedelta(hours=30)], [time(1, 30)]]}))
    assert column(table, "time") == pytest.approx([108000, 5400])


def test_a_date_where_a_number_belongs_is_said_to_be_one(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [HEAD, [1, datetime(2026, 4, 3)]]})
    assert faults(path) == [
        "b.xlsx, s!B2: depth: '2026-04-03' is a date and no number; a spreadsheet makes dates of numbers: "
        "format the column as numbers"
    ]


def test_a_share_that_is_shown_in_per_cent_is_what_is_shown(tmp_path: Path) -> None:
    def shown(made: Any) -> None:
        made["s"]["A2"].number_format = "0.0%"
        made["s"]["A4"].number_format = '0.0"%"'

    path = book(tmp_path / "b.xlsx", {"s": [["share [%]"], [0.07], [7], [7]]}, shown)
    assert column(read(path), "share") == [0.07, 0.07, 0.07]


def test_every_fault_of_a_sheet_is_told_at_once_with_its_cell(tmp_path: Path) -> None:
    rows = [
        ["time", "depth [N]", "my share [%]", "rate", "depth [um]"],
        [1, 1, "", "#N/A", 1],
        ["two", 1, "", "=1/0", 1],
        [3, 1, "", "x" * 40_000, 1],
    ]

    def errors(made: Any) -> None:
        made["my sheet"]["D2"].data_type = "e"

    path = book(tmp_path / "b.xlsx", {"my sheet": rows}, errors)
    said = [
        "'my sheet'!A1: column 'time' has no unit; it is",
        "'my sheet'!B1: column 'depth [N]': ",
        "'my sheet'!E1: the column 'depth' occurs twice",
        "'my sheet'!D2: rate: holds the error #N/A; mend it, or empty the cell where there is no value",
        "'my sheet'!A3: time: 'two' is no number",
        "'my sheet'!D3: rate: holds a formula whose value was never stored; open the workbook in Excel or LibreOffice",
        "'my sheet'!D4: rate: 'xxx",
    ]
    found = faults(path)
    for sentence in said:
        assert any(fault.startswith(f"b.xlsx, {sentence}") for fault in found), (sentence, found)
    assert len(found) == len(said)


def stored(path: Path, cells: Mapping[str, str]) -> Path:
    """Put stored values into a workbook that was written without, as Excel does when it saves."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    sheet = parts["xl/worksheets/sheet1.xml"].decode().replace("<v></v>", "<v />")  # the first as lxml writes it
    for before, after in cells.items():
        assert before in sheet
        sheet = sheet.replace(before, after)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in {**parts, "xl/worksheets/sheet1.xml": sheet.encode()}.items():
            archive.writestr(name, content)
    return path


def test_formulas_count_by_their_stored_values(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [["rate", "depth [um]"], ["=1+1", 3], ['=""', 4], ["=1/0", 5]]})
    both = {
        "<f>1+1</f><v />": "<f>1+1</f><v>2</v>",
        '<c r="A3"><f>""</f><v />': '<c r="A3" t="str"><f>""</f><v></v>',
        '<c r="A4"><f>1/0</f><v />': '<c r="A4" t="e"><f>1/0</f><v>#DIV/0!</v>',
    }
    assert faults(stored(path, both)) == [
        "b.xlsx, s!A4: rate: holds the error #DIV/0!; mend it, or empty the cell where there is no value"
    ]
    path = book(tmp_path / "c.xlsx", {"s": [["rate", "depth [um]"], ["=1+1", 3], ['=""', 4]]})
    rate = column(read(stored(path, dict(list(both.items())[:2]))), "rate")
    assert rate[0] == 2
    assert math.isnan(rate[1])


def test_a_table_of_nothing_but_formulas_that_were_never_calculated(tmp_path: Path) -> None:
    found = faults(book(tmp_path / "b.xlsx", {"s": [["rate"], ["=1+1"], ["=2+1"]]}))
    assert [fault.partition(":")[0] for fault in found] == ["b.xlsx, s!A2", "b.xlsx, s!A3"]


def test_text_that_would_be_a_formula_is_text(tmp_path: Path) -> None:
    def as_text(made: Any) -> None:
        for row in made["s"].iter_rows(min_row=2, max_col=1):
            row[0].data_type = "s"

    words = ["=1+1", "+cmd|' /C calc'!A0", "@SUM(1)", "-2+3", "a\nb", "_x0007_bell"]
    path = book(tmp_path / "b.xlsx", {"s": [["run", "rate"], *([word, 1] for word in words)]}, as_text)
    assert column(read(path), "run") == [*words[:4], "a b", "_x0007_bell"]


def test_a_huge_text_is_not_passed_on() -> None:
    with pytest.raises(ValueError, match="holds 32768 characters; at most 32767 are read"):
        reading.cell_text(SimpleNamespace(value="x" * 32_768, data_type="s"))


def test_macros_and_links_are_not_looked_at(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [HEAD, [1, 2]]})
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("xl/vbaProject.bin", b"Sub Auto_Open()")
        archive.writestr("xl/externalLinks/externalLink1.xml", b"no XML at all")
    assert len(read(path.rename(tmp_path / "b.xlsm"))) == 1


def test_what_is_no_workbook_or_too_large_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "text.xlsx").write_text("time [h],depth [um]\n1,2\n")
    assert faults(tmp_path / "text.xlsx") == ["text.xlsx: is no workbook; save the workbook anew as .xlsx"]
    (tmp_path / "old.xlsx").write_bytes(b"\xd0\xcf\x11\xe0" + b"\0" * 100)
    assert faults(tmp_path / "old.xlsx")[0].startswith("old.xlsx: is protected by a password")
    (tmp_path / "cut.xlsx").write_bytes(book(tmp_path / "b.xlsx", {"s": [HEAD, [1, 2]]}).read_bytes()[:2000])
    assert faults(tmp_path / "cut.xlsx")[0].startswith("cut.xlsx: cannot be read as a workbook (BadZipFile")
    assert faults(tmp_path / "bb.xlsx") == ["bb.xlsx: no such file. Did you mean 'b.xlsx'?"]
    with zipfile.ZipFile(tmp_path / "b.xlsx", "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/media/zeros.bin", b"\0" * 20_000_000)
    assert len(read(tmp_path / "b.xlsx")) == 1
    monkeypatch.setattr(reading, "LARGEST_UNPACKED", 10_000_000)
    assert faults(tmp_path / "b.xlsx") == [
        "b.xlsx: unpacks to 20 MB, at most 10 MB are read; save the table alone in a new workbook"
    ]


def test_a_document_type_in_a_workbook_is_refused(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [HEAD, [1, 2]]})
    stored(path, {"<worksheet": '<!DOCTYPE w [<!ENTITY a "b">]><worksheet'})
    assert faults(path) == ["b.xlsx: 'xl/worksheets/sheet1.xml' in it declares a document type; save it anew"]


def test_a_row_far_away_and_rows_of_nothing_cost_nothing(tmp_path: Path) -> None:
    def far(made: Any) -> None:
        made["s"]["A1048576"] = 2

    assert read(book(tmp_path / "b.xlsx", {"s": [["rate"], [1]]}, far)).lines == (2, 1_048_576)
    assert faults(book(tmp_path / "c.xlsx", {"s": [HEAD]})) == ["c.xlsx, s!A1: holds a header but no rows"]
    assert faults(book(tmp_path / "d.xlsx", {"s": []}))[0].startswith("d.xlsx, s!A1: is empty; the first line")


def test_without_the_library_one_sentence_names_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [HEAD, [1, 2]]})
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    assert faults(path) == [
        "b.xlsx: a workbook needs openpyxl, which is not installed: pip install 'truing[excel]'; "
        "or save it as CSV UTF-8"
    ]


# Inputs


def stated(path: Path | str, *overrides: str) -> Setup:
    return read_setup(Path(path), PIN_OFFER, overrides=overrides)


def input_faults(path: Path | str) -> list[str]:
    with pytest.raises(InputError) as caught:
        stated(path)
    return [str(fault).removeprefix(str(Path(path).parent)).lstrip("/\\") for fault in caught.value.faults]


NAMES = ["name", "value", "unit", "symbol", "note"]


def test_inputs_in_a_workbook_are_those_in_toml(tmp_path: Path) -> None:
    rows = [
        ["Wear of the pin, filled in by hand"],
        ["Value", "NAME", "unit", "note"],
        [0.08, "load", "kN", "as weighed"],
        [None, "speed", "m/s", "left as it is"],
        ["28 mm^2", "area", None, None],
        [3e-8, "rate", "-", None],
        ["sd 5 %", "tolerances.load", None, None],
        [4, "studies.seed", None, None],
        [7, "sheet.revision", None, None],
        ["not read", "# a remark", None, None],
    ]
    (tmp_path / "wear.toml").write_text(
        '[inputs]\nload = "0.08 kN"\narea = "28 mm^2"\nrate = 3e-8\n[tolerances]\nload = "sd 5 %"\n'
        '[studies]\nseed = 4\n[sheet]\nrevision = "7"\n'
    )
    found = stated(book(tmp_path / "wear.xlsx", {"inputs": rows, "Sheet2": []}))
    expected = stated(tmp_path / "wear.toml")
    assert complete_inputs(found, tmp_path) == complete_inputs(expected, tmp_path)
    assert found.source.stated == expected.source.stated
    assert stated(tmp_path / "wear.xlsx", "load=90 N").inputs.load == 90


def test_every_fault_of_inputs_in_a_workbook_has_its_cell(tmp_path: Path) -> None:
    rows = [
        NAMES,
        ["load", 80, None],
        ["laod", 80, "N"],
        ["speed", "=1/2", "m/s"],
        ["area", "=A1", "mm^2"],
        ["time", "2,5", "h"],
        [None, 3, "h"],
        ["rate", 1e-8, None],
        ["rate", 2e-8, None],
        ["hardness", datetime(2026, 2, 1), "GPa"],
    ]

    def errors(made: Any) -> None:
        made["inputs"]["B5"] = "#REF!"

    found = input_faults(book(tmp_path / "b.xlsx", {"inputs": rows}, errors))
    expected = {
        "B2": "load = 80 has no unit",
        "B3": "pin_wear has no input 'laod'. Did you mean 'load'",
        "B4": "holds a formula whose value was never stored; open the workbook in Excel or LibreOffice, let it calc",
        "B5": "area: holds the error #REF!; mend it, or empty the cell",
        "B6": "time",
        "B7": "'3' has no name; write it in the column 'name'",
        "A9": "'rate' is given twice (first in B8); write it once",
        "B10": "hardness",
    }
    for cell, sentence in expected.items():
        assert any(fault.startswith(f"b.xlsx, inputs!{cell}: {sentence}") for fault in found), (cell, found)
    assert len(found) == len(expected)


def test_a_workbook_without_the_columns_of_inputs_is_one_sentence(tmp_path: Path) -> None:
    path = book(tmp_path / "b.xlsx", {"s": [HEAD, [1, 2]]})
    assert input_faults(path) == [
        "b.xlsx, s!A1: no row holds the columns 'name' and 'value'; "
        "`calc init pin_wear -o inputs.xlsx` writes such a workbook"
    ]


@pytest.mark.parametrize("offer", [PIN_OFFER, *Kernel.installed().offers.values()], ids=attrgetter("name"))
def test_the_workbook_to_fill_in_says_what_the_example_says(tmp_path: Path, offer: Offer) -> None:
    text, file, folder = example_of(offer)
    expected = setup_from_text(text, offer, file=file, folder=folder)
    path = tmp_path / "inputs.xlsx"
    path.write_bytes(example_book(offer))
    found = read_setup(path, offer)
    assert complete_inputs(found, tmp_path) == complete_inputs(expected, tmp_path)
    assert found.source.stated == expected.source.stated
    assert path.read_bytes() == example_book(offer)


def test_the_workbook_to_fill_in_offers_choices(tmp_path: Path) -> None:
    offer = Kernel.installed().offers["rv_wear"]
    path = tmp_path / "inputs.xlsx"
    path.write_bytes(example_book(offer))
    made = openpyxl.load_workbook(path)
    sheet, lists = made["inputs"], made["choices"]
    assert [cell.value for cell in sheet[1]] == ["name", "value", "unit", "symbol", "note", "source"]
    assert sheet.freeze_panes == "A2"
    assert lists.sheet_state == "hidden"
    rows = {row[0].value: row[0].row for row in sheet.iter_rows()}
    offered = {str(rule.sqref): rule.formula1 for rule in sheet.data_validations.dataValidation}
    column = offered[f"B{rows['load_sharing']}"].split("$")[1]
    assert [cell.value for cell in lists[column] if cell.value] == list(
        offer.model.input_fields["load_sharing"].choices
    )


# Writing


def test_a_written_workbook_holds_numbers_as_numbers_and_text_as_text(tmp_path: Path) -> None:
    words = ["=1+1", "+2", "-3", "@SUM(A1)", "#N/A", "#DIV/0!", "plain", "bell\x07", "x" * 40_000]
    numbers = [Printed(2 / 3, "0.66667"), Printed(1.25e-7, "1.25e-07"), Printed(3137.0, "3137"), np.float64(0.5)]
    others = [True, None, math.nan, math.inf, 7]
    rows = [[cell] for cell in (*words, *numbers, *others)]
    path = tmp_path / "b.xlsx"
    path.write_bytes(workbook_bytes([SheetTable("s", ["=head"], rows)]))
    sheet = openpyxl.load_workbook(path)["s"]
    cells = [row[0] for row in sheet.iter_rows()]
    assert [(cell.value, cell.data_type) for cell in cells[:8]] == [
        ("=head", "s"), *((word, "s") for word in words[:7]),
    ]  # fmt: skip
    assert all(cell.quotePrefix for cell in cells[:7])
    assert cells[8].value == "bell\N{REPLACEMENT CHARACTER}"
    assert len(cells[9].value) == 32_767
    assert [cell.value for cell in cells[10:]] == [
        pytest.approx(2 / 3, rel=1e-15), 1.25e-7, 3137, 0.5, True, None, None, "inf", 7,
    ]  # fmt: skip
    assert [cell.number_format for cell in cells[10:14]] == ["0.00000", "0.00E+00", "0", "General"]
    assert sheet.freeze_panes == "A2"
    assert cells[0].font.b


def test_a_sheet_that_is_too_long_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writing, "MOST_ROWS", 2)
    with pytest.raises(UsageError, match="3 rows are more than a sheet of a workbook has"):
        workbook_bytes([SheetTable("s", ["a"], [[1], [2], [3]])])
