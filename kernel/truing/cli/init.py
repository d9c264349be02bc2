"""calc init: a commented inputs file that holds the paper's example."""

from __future__ import annotations

from pathlib import Path

import typer

from truing.cli.console import out, say, settings_of, verb
from truing.cli.load import find_offer
from truing.errors import OutputError


@verb
def init(
    context: typer.Context,
    plugin: str = typer.Argument(..., help="An installed plugin's name, or a Python file."),
    output: Path | None = typer.Option(None, "-o", "--output", help="The file to write (stdout without it)."),
    force: bool = typer.Option(False, "--force", help="Replace an existing file."),
) -> int:
    """Write a commented inputs file that holds the paper's example."""
    from truing.example_file import example_text

    settings = settings_of(context)
    text = example_text(find_offer(plugin, settings))
    if output is None:
        out(text.rstrip("\n"))
        return 0
    if output.exists() and not force:
        raise OutputError(f"{output} exists already; choose another name or say --force")
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{output} cannot be written: {error.strerror}") from None
    if not settings.quiet:
        say(f"wrote {output}; now: calc run {plugin} --inputs {output}")
    return 0
