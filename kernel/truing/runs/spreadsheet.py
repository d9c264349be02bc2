"""The numbers of a run or a diagnosis for a spreadsheet: CSV with decimal commas, and workbooks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Any

import numpy as np

from truing.declare.model import Model
from truing.diagnosis.records import file_labels
from truing.diagnosis.result import DiagnosisResult
from truing.formulas.symbols import printable
from truing.measurements import EXCEL, table_text
from truing.numbers import RESULT_DIGITS, STATED_DIGITS, format_number
from truing.recordings.parquet import parquet_bytes
from truing.runs.diagnosis_document import diagnosis_document
from truing.studies.checks import SHORT
from truing.units import from_si
from truing.workbooks.writing import Printed, SheetTable, workbook_bytes

HEADERS = ("part", "name", "place", "value", "unit", "limit", "margin", "verdict", "note")
CAUSE_HEADERS = ("cause", "unknown", "value", "low 95 %", "high 95 %", "unit", "share")
STATED = {"input", "tolerance", "condition", "run"}
"""Parts whose numbers are printed as they were stated."""
SpreadsheetRow = dict[str, Any]


def spreadsheets(document: Mapping[str, Any], model: Model[Any, Any]) -> dict[str, str]:
    """Return results.csv, every number of results.json with its unit, and cases.csv where there are cases."""
    rows = [*_single(document, model), *_spread_out(document)]
    files = {"results.csv": table_text(HEADERS, [[row.get(name) for row in rows] for name in HEADERS], form=EXCEL)}
    if "cases" in document:
        columns = _cases(document["cases"])
        files["cases.csv"] = table_text(list(columns), list(columns.values()), form=EXCEL)
    return files


def cases_parquet(document: Mapping[str, Any]) -> bytes:
    """Return the cases as a parquet file, which goes out where a parquet file of cases came in."""
    return parquet_bytes(_cases(document["cases"]))


def run_workbook(document: Mapping[str, Any], model: Model[Any, Any]) -> bytes:
    """Return the same tables as the sheets of a workbook, numbers with the digits that the sheet prints."""
    rows = [
        [_printed(row, name, model) for name in HEADERS] for row in (*_single(document, model), *_spread_out(document))
    ]
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
    fields = model.input_fields | model.result_fields
    notes = {name: printable(field.spec.note) for name, field in fields.items()}
    yield from _named("result", document["results"], notes)
    for check in document["checks"]:
        said = {name: check[name] for name in ("name", "value", "unit", "limit", "margin")}
        yield {"part": "check", **said, "verdict": SHORT[check["state"]], "note": check["compared"]}
    yield from _named("input", document["inputs"], notes)
    for name, tolerance in document["tolerances"].items():
        for target, distribution in tolerance["on"].items():
            for part in ("mean", "sd"):
                said = {"name": target, "place": part, "value": distribution[part], "unit": distribution["unit"]}
                yield {"part": "tolerance", **said, "note": f"{name}: {tolerance['spread']}"}
    yield from _named("correlation", document["correlations"], {})
    yield from _named("condition", document["conditions"], {})
    for name, unknowns in document["effects"].items():
        for unknown, estimate in unknowns.items():
            said = {"part": "effect", "name": f"{name}.{unknown}", "unit": estimate["unit"]}
            yield {**said, "value": estimate["value"]}
            if "sd" in estimate:
                yield {**said, "place": "sd", "value": estimate["sd"]}
    yield {"part": "run", "name": "seed", "value": document["seed"]}


def _named(part: str, items: Mapping[str, Any], notes: Mapping[str, str]) -> Iterator[SpreadsheetRow]:
    for name, quantity in items.items():
        if not isinstance(quantity["value"], (list, dict)):
            note = f"in arrays.npz: {quantity['array']}" if "array" in quantity else notes.get(name, "")
            yield {"part": part, "name": name, "value": quantity["value"], "unit": quantity["unit"], "note": note}


def _spread_out(document: Mapping[str, Any]) -> Iterator[SpreadsheetRow]:
    """Give what has many numbers, one a row: results and inputs along an axis, and what the studies say."""
    for part in ("result", "input"):
        for name, quantity in document[f"{part}s"].items():
            if isinstance(quantity["value"], (list, dict)):
                for path, value in _leaves(quantity["value"]):
                    yield {"part": part, "name": name, "place": path, "value": value, "unit": quantity["unit"]}
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
    sizes = ("rmse_before", "rmse_after", "noise_floor")
    errors: dict[str, list[Any]] = {name: [] for name in ("result", *sizes, "unit")}
    for result, gain in document["gain"].items():
        if isinstance(gain, dict) and "rmse_before" in gain:
            _append(errors, (result, *(gain[size]["value"] for size in sizes), gain["rmse_before"]["unit"]))
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
