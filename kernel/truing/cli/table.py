"""calc table: what the gauge would show at every row of a file."""

from __future__ import annotations

from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from truing.cli.console import Settings, out, say, settings_of, verb
from truing.cli.load import find_offer
from truing.cli.words import Changed, OutputFile, Plugin
from truing.errors import OutputError

if TYPE_CHECKING:
    from truing.measurements import RowsFile
    from truing.setup import Setup


@verb
def table(
    context: typer.Context,
    plugin: Plugin,
    inputs: Annotated[Path, typer.Option("--inputs", "-i", help="The inputs file.")],
    rows: Annotated[Path, typer.Option("--rows", help="A CSV file; columns replace inputs and conditions row by row.")],
    output: OutputFile = None,
    changed: Changed = None,
) -> int:
    """Print what the gauge would show at every row: the file's columns, then the results, units in the header."""
    from truing.gauge import shown_by_gauge
    from truing.inputs_file import read_setup
    from truing.inputs_file.culprit import told_by_line
    from truing.measurements import read_rows, write_table

    settings = settings_of(context)
    _demand_new(output, inputs, rows)
    offer = find_offer(plugin, settings)
    setup = read_setup(inputs, offer, overrides=changed or ())
    read = read_rows(rows, offer, setup)
    _say_unused(read, setup, settings)
    with told_by_line(setup):
        shown = shown_by_gauge(setup, read)
    kept = {text: cells for text, cells in read.cells.items() if text.partition("[")[0].strip() not in shown.values}
    headers = [*kept, *(f"{name} [{shown.units[name] or '1'}]" for name in shown.values)]
    text = StringIO()
    write_table(output or text, headers, [*kept.values(), *shown.values.values()])
    if output is None:
        out(text.getvalue().removesuffix("\n"))
    for row, reason in shown.reasons.items():
        say(f"{rows}:{read.lines[row]}: {reason}")
    if output is not None:
        settings.say(f"wrote {output}: {len(read)} rows, {len(shown.reasons)} of them failed")
    return 0


def _demand_new(output: Path | None, *read: Path) -> None:
    """Raise OutputError where the output would replace a file that is read."""
    for path in read:
        if output is not None and output.exists() and path.exists() and output.samefile(path):
            raise OutputError(f"{output} is read by this command; name another file for the output")


def _say_unused(read: RowsFile, setup: Setup, settings: Settings) -> None:
    """Say which columns change nothing, and which of them may be misspelt."""
    from truing.declare.near_miss import near_miss
    from truing.measurements.overriding import NAMES, REMARKS

    known = [*setup.model.input_fields, *setup.conditions]
    for name in read.others:
        if name in setup.model.result_fields:
            settings.say(f"column '{name}' is a result: it is calculated here")
        elif name not in {*NAMES, *REMARKS}:
            settings.say(f"column '{name}' changes nothing and is kept as it stands.{near_miss(name[:80], known)}")
