"""calc compare: what changed between two runs, or two diagnoses."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import typer

from truing.cli.changes import styles_of
from truing.cli.coloured import out_table
from truing.cli.console import out, out_json
from truing.runs.change_words import words_of
from truing.runs.comparison import Change, compared, in_order
from truing.runs.folder import load_either
from truing.texts import one_line


def compare(
    context: typer.Context,
    *,
    first: Path,
    second: Path,
    as_json: bool,
) -> int:
    """Show inputs, results and checks that changed: exit 0 when equal, 1 when different."""
    found = compared(load_either(first), load_either(second))
    if as_json:
        out_json({"equal": not found, "changes": [asdict(change) for change in found]})
    elif not found:
        out("equal")
    else:
        _print(found, (str(first), str(second)))
    return 1 if found else 0


def _print(found: list[Change], titles: tuple[str, str]) -> None:
    """Print a row for each change, checks that flipped above all others; where there is colour it repeats the words."""
    ordered = in_order(found)
    rows = [("what", "name", *map(one_line, titles), "change"), *map(words_of, ordered)]
    out_table(rows, [("",) * 5, *map(styles_of, ordered)])
