"""The numbers of a run as tables that a spreadsheet with a decimal comma opens by a double click."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf
from typing import Any

from truing.declare.model import Model
from truing.formulas.symbols import printable
from truing.measurements import EXCEL, table_text
from truing.studies.checks import SHORT

HEADERS = ("part", "name", "place", "value", "unit", "limit", "margin", "verdict", "note")
SpreadsheetRow = dict[str, Any]


def spreadsheets(document: Mapping[str, Any], model: Model[Any, Any]) -> dict[str, str]:
    """Return results.csv, every number of results.json with its unit, and cases.csv where there are cases."""
    rows = [*_single(document, model), *_spread_out(document)]
    files = {"results.csv": table_text(HEADERS, [[row.get(name) for row in rows] for name in HEADERS], form=EXCEL)}
    if "cases" in document:
        files["cases.csv"] = _cases(document["cases"])
    return files


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


def _cases(cases: Sequence[Mapping[str, Any]]) -> str:
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
    return table_text(list(columns), list(columns.values()), form=EXCEL)
