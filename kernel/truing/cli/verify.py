"""calc verify: the paper's printed numbers beside ours."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import typer

from truing.cli.console import columns, one_line, out, out_json, progress_bar, settings_of, verb
from truing.cli.load import find_offer


@verb
def verify(
    context: typer.Context,
    plugin: str = typer.Argument(..., help="An installed plugin's name, or a Python file."),
    as_json: bool = typer.Option(False, "--json", help="One JSON document on stdout."),
) -> int:
    """Print every number of the paper beside ours; exit 0 if every row matches its stated verdict."""
    from truing.published import compare_published

    settings = settings_of(context)
    offer = find_offer(plugin, settings)
    with progress_bar(settings) as progress:
        rows = compare_published(offer, progress=progress)
    if as_json:
        out_json({"rows": [_plain(row) for row in rows], "findings": [asdict(item) for item in offer.model.findings]})
    else:
        _print(offer.model, rows)
    return 0 if all(row.as_stated for row in rows) else 1


def _plain(row: Any) -> dict[str, Any]:
    printed = row.published
    return {
        "name": printed.name,
        "where": printed.where,
        "settings": dict(printed.settings),
        "unit": printed.unit,
        "paper": printed.value,
        "ours": row.value,
        "ratio": row.ratio,
        "verdict": "matches" if row.matches else "differs",
        "as_stated": row.as_stated,
        "obtained": printed.obtained,
        "why": printed.why,
    }


def _print(model: Any, rows: Any) -> None:
    from truing.numbers import format_number

    if not rows:
        out(f"{model.name} states no published numbers")
    lines = [("quantity", "where", "unit", "paper", "ours", "ratio", "verdict", "obtained", "settings")]
    for row in rows:
        said = _plain(row)
        verdict = said["verdict"] if row.as_stated else f"{said['verdict']}, NOT AS STATED"
        ratio = "-" if said["ratio"] is None else f"{said['ratio']:.4f}"
        settings = ", ".join(f"{name} = {value}" for name, value in said["settings"].items())
        numbers = (format_number(said["paper"], 5), format_number(said["ours"], 5), ratio)
        lines.append((said["name"], said["where"], said["unit"], *numbers, verdict, said["obtained"], settings))
    if rows:
        out(columns([tuple(one_line(cell) for cell in line) for line in lines], right=(3, 4, 5)))
    for row in rows:
        if row.published.why:
            out(f"\n{row.published.name}: {one_line(row.published.why)}")
    for finding in model.findings:
        out(f"\nFinding: {one_line(finding.title)}\n  {one_line(finding.text)}")
