"""calc init: a commented inputs file that holds the paper's example."""

from __future__ import annotations

from typing import Annotated

import typer

from truing.cli.console import out, settings_of, verb
from truing.cli.load import find_offer
from truing.cli.words import OutputFile, Plugin
from truing.errors import OutputError


@verb
def init(
    context: typer.Context,
    plugin: Plugin,
    output: OutputFile = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
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
    settings.say(f"wrote {output}; now: calc run {plugin} --inputs {output}")
    return 0
