"""calc table: what the gauge would show at every row of a file."""

from __future__ import annotations

import sys
from pathlib import Path

import typer

from truing.cli.console import say, settings_of, verb
from truing.cli.load import find_offer


@verb
def table(
    context: typer.Context,
    plugin: str = typer.Argument(..., help="An installed plugin's name, or a Python file."),
    inputs: Path = typer.Option(..., "--inputs", "-i", help="The inputs file."),
    rows: Path = typer.Option(..., "--rows", help="A CSV file; columns replace inputs and conditions row by row."),
    output: Path | None = typer.Option(None, "-o", "--output", help="The file to write (stdout without it)."),
    changed: list[str] = typer.Option([], "--set", metavar="NAME=VALUE", help="Replace one value of the inputs file."),
) -> int:
    """Print what the gauge would show at every row: the file's columns, then the results, units in the header."""
    from truing.gauge import shown_by_gauge
    from truing.inputs_file import read_setup
    from truing.measurements import read_rows, write_table

    offer = find_offer(plugin, settings_of(context))
    setup = read_setup(inputs, offer, overrides=changed)
    read = read_rows(rows, offer, setup)
    shown = shown_by_gauge(setup, read.columns, len(read))
    headers = [*read.headers, *(f"{name} [{shown.units[name] or '1'}]" for name in shown.values)]
    write_table(output or sys.stdout, headers, [*read.cells.values(), *shown.values.values()])
    for row, reason in shown.reasons.items():
        say(f"{rows}:{read.lines[row]}: {reason}")
    return 0
