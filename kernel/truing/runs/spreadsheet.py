"""The numbers of a run as tables: CSV, for a spreadsheet with decimal commas too, and workbooks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Any

from truing.declare.model import Model
from truing.formulas.symbols import printable, symbol_text
from truing.measurements import INERT, TableStyle, table_text
from truing.numbers import RESULT_DIGITS, STATED_DIGITS, format_number
from truing.recordings.parquet import parquet_bytes
from truing.studies.checks import SHORT
from truing.workbooks.writing import Printed, SheetTable, workbook_bytes

HEADERS = ("part", "name", "symbol", "place", "value", "unit", "limit", "margin", "verdict", "note")
STATED = {"input", "tolerance", "condition", "run"}
"""Parts whose numbers are printed as they were stated."""
SpreadsheetRow = dict[str, Any]


def run_tables(document: Mapping[str, Any], model: Model[Any, Any], form: TableStyle = INERT) -> dict[str, str]:
    """Return results.csv, every number of results.json with its unit, and cases.csv where there are cases."""
    files = {"results.csv": rows_text([*_single(document, model), *_spread_out(document, model)], form)}
    if "cases" in document:
        columns = _cases(document["cases"])
        files["cases.csv"] = table_text(list(columns), list(columns.values()), form=form)
    return files


def cases_parquet(document: Mapping[str, Any]) -> bytes:
    """Return the cases as a parquet file, which goes out where a parquet file of cases came in."""
    return parquet_bytes(_cases(document["cases"]))


def rows_text(rows: Sequence[SpreadsheetRow], form: TableStyle) -> str:
    """Return rows as the text of results.csv."""
    return table_text(HEADERS, [[row.get(name) for row in rows] for name in HEADERS], form=form)


def run_workbook(document: Mapping[str, Any], model: Model[Any, Any]) -> bytes:
    """Return the same tables as the sheets of a workbook, numbers with the digits that the sheet prints."""
    single = [*_single(document, model), *_spread_out(document, model)]
    rows = [[_printed(row, name, model) for name in HEADERS] for row in single]
    sheets = [SheetTable("results", HEADERS, rows)]
    if "cases" in document:
        sheets.append(column_sheet("cases", _cases(document["cases"]), model))
    return workbook_bytes(sheets)


def _printed(row: SpreadsheetRow, name: str, model: Model[Any, Any]) -> Any:
    value = row.get(name)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value
    is_stated = row["part"] in STATED or name == "limit"
    return Printed(value, format_number(value, STATED_DIGITS if is_stated else digits_of(row["name"], model)))


def digits_of(name: str, model: Model[Any, Any]) -> int:
    """Return how many digits of a result or input are printed."""
    if name in model.result_fields:
        return model.result_fields[name].digits
    return STATED_DIGITS if name in model.input_fields else RESULT_DIGITS


def column_sheet(title: str, columns: Mapping[str, Iterable[Any]], model: Model[Any, Any]) -> SheetTable:
    """Return columns by header ("depth [um]") as a sheet, its numbers with the digits that are printed."""
    shown = []
    for header, values in columns.items():
        digits = digits_of(header.partition("[")[0].strip(), model)
        plain = values.tolist() if hasattr(values, "tolist") else values
        shown.append([Printed(one, format_number(one, digits)) if isinstance(one, float) else one for one in plain])
    return SheetTable(title, list(columns), list(zip(*shown, strict=True)))


def _single(document: Mapping[str, Any], model: Model[Any, Any]) -> Iterator[SpreadsheetRow]:
    """Give what is one number, or one word: results, checks, inputs, and what acts on them."""
    yield from _named("result", document["results"], model)
    for check in document["checks"]:
        said = {name: check[name] for name in ("name", "value", "unit", "limit", "margin")}
        said |= {"symbol": symbol_of(check["name"], model), "verdict": SHORT[check["state"]]}
        yield {"part": "check", **said, "note": check["compared"]}
    yield from _named("input", document["inputs"], model)
    for name, tolerance in document["tolerances"].items():
        for target, distribution in tolerance["on"].items():
            for part in ("mean", "sd"):
                said = {"name": target, "place": part, "value": distribution[part], "unit": distribution["unit"]}
                said["symbol"] = symbol_of(target, model)
                yield {"part": "tolerance", **said, "note": f"{name}: {tolerance['spread']}"}
    yield from _named("correlation", document["correlations"], model)
    yield from _named("condition", document["conditions"], model)
    for name, unknowns in document["effects"].items():
        for unknown, estimate in unknowns.items():
            said = {"part": "effect", "name": f"{name}.{unknown}", "unit": estimate["unit"]}
            yield {**said, "value": estimate["value"]}
            if "sd" in estimate:
                yield {**said, "place": "sd", "value": estimate["sd"]}
    yield {"part": "run", "name": "seed", "value": document["seed"]}


def _named(part: str, items: Mapping[str, Any], model: Model[Any, Any]) -> Iterator[SpreadsheetRow]:
    for name, quantity in items.items():
        if not isinstance(quantity["value"], (list, dict)):
            note = f"in arrays.npz: {quantity['array']}" if "array" in quantity else note_of(name, model)
            said = {"symbol": symbol_of(name, model), "value": quantity["value"], "unit": quantity["unit"]}
            yield {"part": part, "name": name, **said, "note": note}


def symbol_of(name: str, model: Model[Any, Any]) -> str:
    """Return the symbol of an input or a result in plain characters; nothing where there is none."""
    declared = model.result_fields.get(name) or model.input_fields.get(name)
    return symbol_text(declared.symbol) if declared is not None and declared.symbol else ""


def note_of(name: str, model: Model[Any, Any]) -> str:
    """Return what a result or input is called in words; nothing where neither is declared."""
    declared = model.result_fields.get(name) or model.input_fields.get(name)
    return printable(declared.spec.note) if declared is not None else ""


def _spread_out(document: Mapping[str, Any], model: Model[Any, Any]) -> Iterator[SpreadsheetRow]:
    """Give what has many numbers, one a row: results and inputs along an axis, and what the studies say."""
    for part in ("result", "input"):
        for name, quantity in document[f"{part}s"].items():
            if isinstance(quantity["value"], (list, dict)):
                said = {"part": part, "name": name, "symbol": symbol_of(name, model), "unit": quantity["unit"]}
                for path, value in _leaves(quantity["value"]):
                    yield {**said, "place": path, "value": value}
    for name, outcome in document["studies"].items():
        for path, value in _leaves(outcome):
            yield {"part": "study", "name": name, "place": path, "value": value}


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Give every number, word and truth in a document with the way to it; places in a list begin with 1."""
    if isinstance(value, Mapping):
        for key, one in value.items():
            yield from _leaves(one, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list):
        for number, one in enumerate(value, start=1):
            yield from _leaves(one, f"{path}[{number}]")
    else:
        yield path, value


def _cases(cases: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Return the cases, one a row: what they change and what they answer, units in the header; words have none."""
    columns: dict[str, list[Any]] = {"case": [], "row": []}
    for index, case in enumerate(cases):
        cells: dict[str, Any] = {"case": case["name"], "row": case["row"]}
        for name, quantity in (*case["values"].items(), *case["results"].items()):
            is_word = isinstance(quantity["value"], (str, bool))
            cells[name if is_word else f"{name} [{quantity['unit'] or '1'}]"] = quantity["value"]
        margins = [check["margin"] for check in case["checks"] if check["state"] != "undecided"]
        if margins:
            cells["margin [1]"] = min(margins, key=lambda margin: -inf if margin is None else margin)
        verdict = SHORT[case["verdict"]] + (", governing" if case["governing"] else "")
        cells["verdict"] = f"failed: {case['failed']}" if case["failed"] else verdict
        for header in {**columns, **cells}:
            columns.setdefault(header, [None] * index).append(cells.get(header))
    return columns
