"""calc table: what the gauge would show at every row of a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from truing.api.tables import name_in
from truing.atomic import write_files
from truing.cli.console import Settings, out, say
from truing.cli.load import find_offer
from truing.declare.near_miss import near_miss
from truing.errors import OutputError, UsageError
from truing.gauge import shown_by_gauge
from truing.inputs_file import read_setup
from truing.inputs_file.sentences import told_by_line
from truing.measurements import EXCEL, PLAIN, RowsFile, read_rows, table_text
from truing.measurements.csv_text import read_cell, with_comma
from truing.measurements.overriding import NAMES, REMARKS
from truing.measurements.table import RUN
from truing.recordings.parquet import parquet_bytes
from truing.runs.spreadsheet import column_sheet
from truing.setup import Setup
from truing.texts import one_line
from truing.workbooks.reading import file_of
from truing.workbooks.writing import Printed, workbook_bytes

MOST_SAID = 10
"""What is so of more rows is said once."""


def table(settings: Settings, asked: SimpleNamespace) -> int:
    """Print what the gauge would show at every row: the file's columns, then the results, units in the header."""
    inputs, rows, output, excel = asked.inputs, asked.rows, asked.output, asked.excel
    if excel and output is None:
        raise UsageError("--excel writes a file for a spreadsheet; name it with -o")
    for path in map(file_of, (inputs, rows)):
        if output is not None and output.exists() and path.exists() and output.samefile(path):
            raise OutputError(f"{output} is read by this command; name another file for the output")
    offer = find_offer(asked.plugin, settings)
    setup = read_setup(inputs, offer, overrides=asked.changed or ())
    read = read_rows(rows, offer, setup)
    _say_unused(read, setup, settings)
    with told_by_line(setup):
        shown = shown_by_gauge(setup, read)
    kept = {text: cells for text, cells in read.cells.items() if name_in(text) not in shown.values}
    results = {f"{name} [{shown.units[name] or '1'}]": values for name, values in shown.values.items()}
    ending = "" if output is None else output.suffix.lower()
    if output is not None and ending in {".xlsx", ".parquet"}:
        write_files({output: _numbers_in(ending, kept, results, setup)})
    else:
        cells = [_with_commas(text, column, setup) if excel else column for text, column in kept.items()]
        text = table_text([*kept, *results], [*cells, *results.values()], form=EXCEL if excel else PLAIN)
        if output is None:
            out(text.removesuffix("\n"))
        else:
            write_files({output: text})
    for row, reason in _reasons(shown.reasons, read).items():
        say(f"{rows}:{read.lines[row]}: {reason}")
    for note in read.notes:
        settings.say(f"note: {one_line(note)}")
    if read.count.unused:
        settings.say(f"{one_line(rows)}: {one_line(read.count.sentence())}")
    if output is not None:
        settings.say(f"wrote {output}: {len(read)} rows, {len(shown.reasons)} of them failed")
    return 0


def _numbers_in(ending: str, kept: Mapping[str, Sequence[str]], results: Mapping[str, Any], setup: Setup) -> bytes:
    """Return the columns as a workbook or a parquet file, numbers as such."""
    columns = {text: _as_numbers(text, column, setup) for text, column in kept.items()}
    if ending == ".xlsx":
        return workbook_bytes([column_sheet("rows", {**columns, **results}, setup.model)])
    plain = {text: [getattr(cell, "value", cell) for cell in column] for text, column in columns.items()}
    return parquet_bytes({**plain, **results})


def _reasons(reasons: Mapping[int, str], read: RowsFile) -> dict[int, str]:
    """Return why rows failed, by row; what is so of many rows, as of all those of a record, at the first of them."""
    rows_of: dict[str, list[int]] = {}
    for row, reason in reasons.items():
        rows_of.setdefault(reason, []).append(row)
    said: dict[int, str] = {}
    for reason, rows in rows_of.items():
        if len(rows) > MOST_SAID:
            more = f"so it is in {len(rows) - 1} rows more, the last in line {read.lines[rows[-1]]}"
            said[rows[0]] = f"{reason} ({more})"
        else:
            said |= dict.fromkeys(rows, reason)
    return dict(sorted(said.items()))


def _with_commas(header: str, cells: Sequence[str], setup: Setup) -> Sequence[str]:
    """Return a column as written, its numbers with decimal commas."""
    return cells if _is_word(header, setup) else with_comma(cells)


def _is_word(header: str, setup: Setup) -> bool:
    """Whether a column holds words, also where they look like numbers: those of an input, names of runs and cases."""
    field = setup.model.input_fields.get(name_in(header))
    return field.kind in {"choice", "text"} if field is not None else name_in(header) in {RUN, *NAMES, *REMARKS}


def _as_numbers(header: str, cells: Sequence[str], setup: Setup) -> Sequence[Any]:
    """Return a column of numbers as such, shown with the digits that were written; empty cells and words stay."""
    if _is_word(header, setup):
        return cells
    try:
        values = [read_cell(cell, decimal_comma=False, may_be_missing_word=True) for cell in cells]
    except ValueError:
        return cells
    return [Printed(value, cell.strip()) for value, cell in zip(values, cells, strict=True)]


def _say_unused(read: RowsFile, setup: Setup, settings: Settings) -> None:
    """Say which columns change nothing, and which of them may be misspelt."""
    known = [*setup.model.input_fields, *setup.conditions]
    for name in read.others:
        if name in setup.model.result_fields:
            settings.say(f"column '{name}' is a result: it is calculated here")
        elif name not in {*NAMES, *REMARKS} and not (name == RUN and (read.series or setup.model.dynamics)):
            settings.say(f"column '{name}' changes nothing and is kept as it stands.{near_miss(name[:80], known)}")
