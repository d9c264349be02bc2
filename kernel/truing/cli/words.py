"""Arguments and options that several verbs share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from truing.cli import candidates

Plugin: TypeAlias = Annotated[
    str, typer.Argument(help="An installed plugin's name, or a Python file.", autocompletion=candidates.plugins)
]
Changed: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="Replace one value of the inputs file.",
        autocompletion=candidates.changes,
    ),
]
AsJson: TypeAlias = Annotated[bool, typer.Option("--json", help="One JSON document on stdout.")]
OutputFile: TypeAlias = Annotated[
    Path | None, typer.Option("-o", "--output", help="The file to write (stdout without it).")
]
Excel: TypeAlias = Annotated[
    bool, typer.Option("--excel", help="Write CSV that a spreadsheet with a decimal comma opens.")
]
