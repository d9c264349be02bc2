"""Arguments and options that several verbs share."""

from __future__ import annotations

from enum import StrEnum
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
Inputs: TypeAlias = Annotated[
    Path | None, typer.Option("--inputs", "-i", help="The inputs file; without it the shipped example.")
]
Cases: TypeAlias = Annotated[Path | None, typer.Option("--cases", help="A CSV file: every row is a case.")]
RunFolder: TypeAlias = Annotated[
    Path | None, typer.Option("--output", "-o", help="The run folder (default runs/STEM).")
]
Pdf: TypeAlias = Annotated[bool, typer.Option("--pdf", help="Print the sheet to PDF with an installed browser.")]


class Shell(StrEnum):
    """A shell that can complete."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"
    powershell = "powershell"
