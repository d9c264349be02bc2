"""calc describe: what a model takes, what it answers, what could make it wrong."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer

from truing.cli.console import columns, one_line, out, out_json, settings_of
from truing.cli.load import find_offer
from truing.describe import description
from truing.formulas import symbol_text
from truing.inputs_file import json_schema
from truing.units import unit_text

WHERE_MEASURED = (
    ("thermal_drift_of_INPUT", "", "", "where a record varies an input in K"),
    ("periodic_order_of_INPUT", "", "", "where a record turns an input round that is an angle"),
)


def describe(
    context: typer.Context,
    *,
    plugin: str,
    as_json: bool,
    as_schema: bool,
) -> int:
    """Show inputs, results, error sources and objectives: symbols, units, bounds, sources."""
    offer = find_offer(plugin, settings_of(context))
    if as_schema:
        out_json(json_schema(offer))
    elif as_json:
        out_json(description(offer))
    else:
        out("\n".join(_lines(description(offer))))
    return 0


def _lines(said: dict[str, Any]) -> Iterator[str]:
    yield f"{said['name']} ({said['plugin']['version'] or 'a file'}): {one_line(said['title'])}"
    if said["summary"]:
        yield one_line(said["summary"])
    sections = {
        "Inputs": [_input_row(item) for item in said["inputs"]],
        "Results": [_row(item["name"], _symbol(item), _unit(item["unit"]), item["note"]) for item in said["results"]],
        "Tolerances": [
            _row(item["name"], item["spread"], "on " + ", ".join(item["on"]), item["why"])
            for item in said["tolerances"]
        ],
        "Effects": [_effect_row(item) for item in said["effects"]],
        "Conditions": [_condition_row(item) for item in said["conditions"]],
        "Built-in effects, on the reading of each RESULT": [
            *(_built_in_row(item, [one["name"] for one in said["results"]]) for item in said["built_in"]["effects"]),
            *(_row(*row) for row in WHERE_MEASURED if _is_among(row[0], said["built_in"]["where_measured"])),
        ],
        "Built-in conditions": [_condition_row(item) for item in said["built_in"]["conditions"]],
        "Objectives": [_row(*_objective_words(item), "", "") for item in said["objectives"]],
    }
    for title, rows in sections.items():
        if rows:
            yield ""
            yield title
            yield columns(rows)
    if said["studies"]:
        yield ""
        yield "Studies: " + ", ".join(said["studies"])
    for item in said["added"]:
        yield f"'{item['what']}' was added by {item['plugin']} {item['version']}"


def _row(*cells: object) -> tuple[str, ...]:
    return ("  " + one_line(cells[0]), *(one_line(cell) for cell in cells[1:]))


def _symbol(item: dict[str, Any]) -> str:
    return symbol_text(item["symbol"]) if item["symbol"] else ""


def _unit(unit: str) -> str:
    return unit_text(unit) or "-"


def _input_row(item: dict[str, Any]) -> tuple[str, ...]:
    default = "optional" if item["default"] is None and item["optional"] else item["default"]
    unit = " | ".join(item["choices"]) or ("a file" if item["kind"] == "file" else _unit(item["unit"]))
    options = f"options: {', '.join(item['options'])}" if item["options"] else ""
    note = "; ".join(text for text in (item["note"], item["bounds"], options, item["source"]) if text)
    return _row(item["name"], _symbol(item), "" if default is None else default, unit, note)


def _condition_row(item: dict[str, Any]) -> tuple[str, ...]:
    made = f"made: {item['derived']}" if item["derived"] else ""
    words = "; ".join(text for text in (item["note"], made) if text)
    return _row(item["name"], f"reference {item['reference']:g}", _unit(item["unit"]), words)


def _built_in_row(item: dict[str, Any], results: list[str]) -> tuple[str, ...]:
    """Name the unknowns of any result by those of the first."""
    first = item["parts"][0]
    own = max((name for name in results if all(one.startswith(name) for one in first)), key=len)
    unknowns = ", ".join("RESULT" + name.removeprefix(own) for name in first)
    needs = "needs " + ", ".join(item["needs"]) if item["needs"] else ""
    return _row(item["name"], unknowns, needs, item["looks_like"])


def _is_among(name: str, effects: list[dict[str, Any]]) -> bool:
    """Whether one of the effects is of the kind of this name."""
    return any(item["name"].startswith(name.removesuffix("_of_INPUT")) for item in effects)


def _effect_row(item: dict[str, Any]) -> tuple[str, ...]:
    unknowns = ", ".join(
        f"{one['name']} {one['low']:g}..{one['high']:g} {_unit(one['unit'])}" for one in item["unknowns"]
    )
    needs = "needs " + ", ".join(item["needs"]) if item["needs"] else ""
    return _row(item["name"], f"on {item['acts_on']}", unknowns, needs, item["looks_like"])


def _objective_words(item: dict[str, Any]) -> tuple[str, str]:
    if item["kind"] == "vary":
        return f"vary {item['input']}", item["by"] or f"{item['low']} .. {item['high']}"
    if item["kind"] == "require":
        goal = f" with reliability {item['reliability']}" if item["reliability"] is not None else ""
        return f"require {item['result']}", f"{item['limit_kind'].replace('_', ' ')} {item['limit']}{goal}"
    return f"{item['kind']} {item['result']}", ""
