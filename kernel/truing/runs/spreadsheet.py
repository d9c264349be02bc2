"""The numbers of a run or a diagnosis as tables: CSV, for a spreadsheet with decimal commas too, and workbooks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Any

import numpy as np

from truing.declare.model import Model
from truing.diagnosis.records import file_labels
from truing.diagnosis.result import DiagnosisResult
from truing.formulas.symbols import printable, symbol_text
from truing.measurements import INERT, TableStyle, table_text
from truing.numbers import RESULT_DIGITS, STATED_DIGITS, format_number
from truing.recordings.parquet import parquet_bytes
from truing.runs.diagnosis_document import diagnosis_document
from truing.studies.checks import SHORT
from truing.units import from_si
from truing.workbooks.writing import Printed, SheetTable, workbook_bytes

HEADERS = ("part", "name", "symbol", "place", "value", "unit", "limit", "margin", "verdict", "note")
CAUSE_HEADERS = ("cause", "unknown", "value", "low 95 %", "high 95 %", "unit", "share")
SIZES = ("rmse_before", "rmse_after", "noise_floor")
"""What is said of the error of a result, on rows that were not fitted."""
MOST_ROWS = 100_000
"""So many measured rows are written as CSV too: that takes two seconds and 14 MB."""
STATED = {"input", "tolerance", "condition", "run"}
"""Parts whose numbers are printed as they were stated."""
SpreadsheetRow = dict[str, Any]


def run_tables(document: Mapping[str, Any], model: Model[Any, Any], form: TableStyle = INERT) -> dict[str, str]:
    """Return results.csv, every number of results.json with its unit, and cases.csv where there are cases."""
    files = {"results.csv": _rows_text([*_single(document, model), *_spread_out(document, model)], form)}
    if "cases" in document:
        columns = _cases(document["cases"])
        files["cases.csv"] = table_text(list(columns), list(columns.values()), form=form)
    return files


def cases_parquet(document: Mapping[str, Any]) -> bytes:
    """Return the cases as a parquet file, which goes out where a parquet file of cases came in."""
    return parquet_bytes(_cases(document["cases"]))


def _rows_text(rows: Sequence[SpreadsheetRow], form: TableStyle) -> str:
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
        said |= {"symbol": _symbol(check["name"], model), "verdict": SHORT[check["state"]]}
        yield {"part": "check", **said, "note": check["compared"]}
    yield from _named("input", document["inputs"], model)
    for name, tolerance in document["tolerances"].items():
        for target, distribution in tolerance["on"].items():
            for part in ("mean", "sd"):
                said = {"name": target, "place": part, "value": distribution[part], "unit": distribution["unit"]}
                said["symbol"] = _symbol(target, model)
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
            note = f"in arrays.npz: {quantity['array']}" if "array" in quantity else _note(name, model)
            said = {"symbol": _symbol(name, model), "value": quantity["value"], "unit": quantity["unit"]}
            yield {"part": part, "name": name, **said, "note": note}


def _symbol(name: str, model: Model[Any, Any]) -> str:
    """Return the symbol of an input or a result in plain characters; nothing where there is none."""
    declared = model.result_fields.get(name) or model.input_fields.get(name)
    return symbol_text(declared.symbol) if declared is not None and declared.symbol else ""


def _note(name: str, model: Model[Any, Any]) -> str:
    declared = model.result_fields.get(name) or model.input_fields.get(name)
    return printable(declared.spec.note) if declared is not None else ""


def _spread_out(document: Mapping[str, Any], model: Model[Any, Any]) -> Iterator[SpreadsheetRow]:
    """Give what has many numbers, one a row: results and inputs along an axis, and what the studies say."""
    for part in ("result", "input"):
        for name, quantity in document[f"{part}s"].items():
            if isinstance(quantity["value"], (list, dict)):
                said = {"part": part, "name": name, "symbol": _symbol(name, model), "unit": quantity["unit"]}
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


# What a diagnosis found


def diagnosis_tables(diagnosis: DiagnosisResult) -> dict[str, str]:
    """Return results.csv, what the diagnosis found number by number, and rows.csv, every row before and after.

    More rows than ``MOST_ROWS`` stand in arrays.npz alone, which results.csv says.
    """
    rows, count = list(_found(diagnosis)), len(diagnosis.records.lines)
    if count > MOST_ROWS:
        rows.append({"part": "diagnosis", "name": "rows", "value": count, "note": "in arrays.npz"})
        return {"results.csv": _rows_text(rows, INERT)}
    columns = _measured_rows(diagnosis)
    written = table_text(list(columns), list(columns.values()), form=INERT)
    return {"results.csv": _rows_text(rows, INERT), "rows.csv": written}


def _found(diagnosis: DiagnosisResult) -> Iterator[SpreadsheetRow]:
    """Give the verdict, causes, errors on rows that were not fitted, calibrated inputs, and explanations by rank."""
    document, model = diagnosis_document(diagnosis), diagnosis.setup.model
    yield {"part": "diagnosis", "name": "verdict", "value": document["verdict"]}
    for cause in document["causes"]:
        for unknown, fitted in cause["unknowns"].items():
            files = {f"{unknown} of {file}": value for file, value in (fitted.get("per_file") or {}).items()}
            for place, amount in {unknown: fitted, **files}.items():
                ends = zip((f"{place}, low 95 %", f"{place}, high 95 %"), amount["interval95"], strict=True)
                for which, value in ((place, amount["value"]), *ends):
                    said = {"place": which, "value": value, "unit": amount["unit"]}
                    yield {"part": "cause", "name": cause["effect"], **said}
        yield {"part": "cause", "name": cause["effect"], "place": "share", "value": cause["share"]}
    for name, gain in document["gain"].items():
        for size in (size for size in SIZES if isinstance(gain, dict)):
            said = {"place": size, "symbol": _symbol(name, model), "note": _note(name, model)}
            yield {"part": "error", "name": name, **said, **gain[size]}
    for name, fitted in document["calibrated"].items():
        said = {"part": "calibrated", "name": name, "symbol": _symbol(name, model), "note": _note(name, model)}
        yield {**said, "value": fitted["value"], "unit": fitted["unit"]}
        yield {**said, "place": "of_its_sd", "value": fitted["of_its_sd"]}
    for ranked in document["ranking"]:
        for place in ("behind", "separation"):
            yield {
                "part": "explanation",
                "name": " and ".join(ranked["causes"]),
                "place": place,
                "value": ranked[place],
            }


def diagnosis_workbook(diagnosis: DiagnosisResult) -> bytes:
    """Return the tables of a diagnosis as the sheets of a workbook: causes, ranking, errors, and every row."""
    document, model = diagnosis_document(diagnosis), diagnosis.setup.model
    causes: dict[str, list[Any]] = {name: [] for name in CAUSE_HEADERS}
    for cause in document["causes"]:
        for unknown, fitted in cause["unknowns"].items():
            cells = (cause["effect"], unknown, fitted["value"], *fitted["interval95"], fitted["unit"], cause["share"])
            _append(causes, cells)
    ranking: dict[str, list[Any]] = {name: [] for name in ("explanation", "behind", "separation")}
    for ranked in document["ranking"]:
        _append(ranking, (" and ".join(ranked["causes"]), ranked["behind"], ranked["separation"]))
    errors: dict[str, list[Any]] = {name: [] for name in ("result", *SIZES, "unit")}
    for result, gain in document["gain"].items():
        if isinstance(gain, dict) and "rmse_before" in gain:
            _append(errors, (result, *(gain[size]["value"] for size in SIZES), gain["rmse_before"]["unit"]))
    tables = {"causes": causes, "ranking": ranking, "errors": errors, "rows": _measured_rows(diagnosis)}
    return workbook_bytes([column_sheet(title, columns, model) for title, columns in tables.items()])


def _append(columns: dict[str, list[Any]], cells: Sequence[Any]) -> None:
    for column, cell in zip(columns.values(), cells, strict=True):
        column.append(cell)


def _measured_rows(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Return every row with its file and line, what it depends on, and each result measured, before and after."""
    records, labels = diagnosis.records, file_labels(diagnosis.records.files)
    columns: dict[str, Any] = {
        "file": [labels[index] for index in records.file_of.tolist()],
        "line": records.lines.tolist(),
        "run": records.rows.runs or records.run_of.tolist(),
    }
    for covariate in records.covariates.values():
        unit = covariate.unit or "1"
        columns.setdefault(f"{covariate.name} [{unit}]", np.asarray(from_si(covariate.values, covariate.unit)))
    for curves in diagnosis.curves:
        unit = diagnosis.setup.print_unit(curves.result)
        for name, values in {"": curves.measured, "_before": curves.before, "_after": curves.after}.items():
            columns[f"{curves.result}{name} [{unit or '1'}]"] = np.asarray(from_si(values, unit))
    return columns
