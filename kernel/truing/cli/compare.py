"""calc compare: what changed between two runs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from truing.cli.console import columns, one_line, out, out_json, verb
from truing.cli.words import AsJson

if TYPE_CHECKING:
    from truing.runs.comparison import Change

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
        out(columns([*rows, *((change.kind, change.name, *_both(change)) for change in found)]))
    return 1 if found else 0


def _both(change: Change) -> tuple[str, str]:
    """Say what stood before and after; of a study that both have, how much of it differs."""
    from truing.runs.comparison import differing

    if change.kind == "studies" and change.before is not None and change.after is not None:
        count = differing(change.before, change.after)
        return "", f"{count} {'value differs' if count == 1 else 'values differ'} (see results.json)"
    return _words(change.before), _words(change.after)


def _words(value: Any) -> str:
    from truing.numbers import format_number

    if value is None:
        return "-"
    if isinstance(value, dict) and "spread" in value:
        return one_line(value["spread"])
    if isinstance(value, dict) and "value" in value:
        number = value["value"]
        is_number = isinstance(number, (int, float)) and not isinstance(number, bool)
        said = f"{format_number(number, 8) if is_number else number} {value.get('unit') or ''}".strip()
        return said if value.get("passed", True) else said + " (fails)"
    if isinstance(value, dict) and all(isinstance(item, dict) for item in value.values()):
        return ", ".join(f"{one_line(name)} = {_words(item)}" for name, item in value.items())
    text = one_line(value)
    return text if len(text) <= LONGEST else "(see results.json)"
