"""What stands beside diagnosis.json: arrays, tables for a spreadsheet, workbooks, the extended model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from truing.diagnosis.records import file_labels
from truing.diagnosis.result import DiagnosisResult
from truing.measurements import INERT, table_text
from truing.runs.diagnosis_document import diagnosis_document
from truing.runs.extension import extended_text
from truing.runs.folder import npz_bytes
from truing.runs.new_effect import new_effect_source
from truing.runs.spreadsheet import SpreadsheetRow, column_sheet, note_of, rows_text, symbol_of
from truing.units import from_si
from truing.workbooks.writing import workbook_bytes

CAUSE_HEADERS = ("cause", "unknown", "value", "low 95 %", "high 95 %", "unit", "share")
SIZES = ("rmse_before", "rmse_after", "noise_floor")
"""What is said of the error of a result, on rows that were not fitted."""
MOST_ROWS = 100_000
"""So many measured rows are written as CSV too: that takes two seconds and 14 MB."""


def diagnosis_files(
    diagnosis: DiagnosisResult, sheets: Mapping[str, str | bytes], folder: Path, *, xlsx: bool = False
) -> dict[str, str | bytes]:
    """Return the files of a diagnosis by name: its sheets, tables and curves, the extension where there is one.

    Tables are CSV; ``xlsx`` adds a workbook.
    """
    extension = {"extended.toml": extended_text(diagnosis, folder), "new_effect.py": new_effect_source(diagnosis)}
    curves = npz_bytes(curve_arrays(diagnosis))
    book = {"diagnosis.xlsx": diagnosis_workbook(diagnosis)} if xlsx else {}
    extension = {name: text for name, text in extension.items() if text}
    return {"arrays.npz": curves, **sheets, **diagnosis_tables(diagnosis), **extension, **book}


def data_digests(diagnosis: DiagnosisResult) -> dict[str, str]:
    """Return the SHA-256 of every data file by the name it is given on the sheet."""
    records = diagnosis.records
    labels = zip(file_labels(records.files), records.files, strict=True)
    return {label: records.digests.get(file, "") for label, file in labels}


def curve_arrays(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Return what arrays.npz holds: per result measured, before and after in its printed unit; file, line and run."""
    records = diagnosis.records
    arrays: dict[str, Any] = {"file": records.file_of, "line": records.lines, "run": records.run_of}
    for curves in diagnosis.curves:
        unit = diagnosis.setup.print_unit(curves.result)
        for name in ("measured", "before", "after"):
            arrays[f"{curves.result}.{name}"] = from_si(getattr(curves, name), unit)
    return arrays


# Tables and workbooks


def diagnosis_tables(diagnosis: DiagnosisResult) -> dict[str, str]:
    """Return results.csv, what the diagnosis found number by number, and rows.csv, every row before and after.

    More rows than ``MOST_ROWS`` stand in arrays.npz alone, which results.csv says.
    """
    rows, count = list(_found(diagnosis)), len(diagnosis.records.lines)
    if count > MOST_ROWS:
        rows.append({"part": "diagnosis", "name": "rows", "value": count, "note": "in arrays.npz"})
        return {"results.csv": rows_text(rows, INERT)}
    columns = _measured_rows(diagnosis)
    written = table_text(list(columns), list(columns.values()), form=INERT)
    return {"results.csv": rows_text(rows, INERT), "rows.csv": written}


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
            said = {"place": size, "symbol": symbol_of(name, model), "note": note_of(name, model)}
            yield {"part": "error", "name": name, **said, **gain[size]}
    for name, fitted in document["calibrated"].items():
        said = {"part": "calibrated", "name": name, "symbol": symbol_of(name, model), "note": note_of(name, model)}
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
