"""calc compare: what changed between two runs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from truing.cli.console import columns, one_line, out, out_json, verb
from truing.cli.words import AsJson

LONGEST = 60


@verb
def compare(
    context: typer.Context,
    first: Annotated[Path, typer.Argument(help="A run folder.")],
    second: Annotated[Path, typer.Argument(help="Another run folder.")],
    as_json: AsJson = False,
) -> int:
    """Show inputs, results and checks that changed: exit 0 when equal, 1 when different."""
    from truing.runs.comparison import changes
    from truing.runs.folder import load_run

    found = changes(load_run(first), load_run(second))
    if as_json:
        out_json({"equal": not found, "changes": [asdict(change) for change in found]})
    elif not found:
        out("equal")
    else:
        rows = [("what", "name", str(first), str(second))]
        out(columns([*rows, *((c.kind, c.name, _words(c.before), _words(c.after)) for c in found)]))
    return 1 if found else 0


def _words(value: Any) -> str:
    from truing.numbers import format_number

    if value is None:
        return "-"
    if isinstance(value, dict) and "value" in value:
        number = value["value"]
        text = (
            format_number(number, 8)
            if isinstance(number, (int, float)) and not isinstance(number, bool)
            else str(number)
        )
        said = f"{text} {value.get('unit') or ''}".strip()
        return said if value.get("passed", True) else said + " (fails)"
    text = one_line(value)
    return text if len(text) <= LONGEST else "(see results.json)"
