"""The command ``calc`` and the table of its verbs: what each takes, and the module that is loaded when it is called.

A verb is declared here with its arguments and its help; a function of the same name in another module does the work. So
help, names and completion load nothing else.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, ParamSpec, TypeAlias

import typer

from truing.cli import candidates
from truing.cli.candidates import names, names_inside, runs
from truing.cli.console import out, settings_of, verb
from truing.heavy import Later

P = ParamSpec("P")

app = typer.Typer(
    name="calc",
    help="Engineering calculations as plugins: checked units, studies, and a sheet to sign.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        out(f"truing {Later('importlib.metadata').version('truing')}")
        raise typer.Exit


@app.callback()
def _common(
    version: bool = typer.Option(False, "--version", callback=_version, is_eager=True, help="Print the version."),
    verbose: bool = typer.Option(False, "--verbose", "-v", help="Say more (may stand anywhere)."),
    quiet: bool = typer.Option(False, "--quiet", "-q", help="Say only errors and results (may stand anywhere)."),
    traceback: bool = typer.Option(False, "--traceback", help="Show where an error comes from (may stand anywhere)."),
) -> None:
    """Engineering calculations as plugins: checked units, studies, and a sheet to sign."""


def _loaded(module: str) -> Callable[[Callable[P, None]], Callable[P, None]]:
    """Make a verb of a declaration: the function of its name in a module does the work.

    It takes the settings that hold for every verb, and what was asked for by the names of the declaration.
    """

    def made(declared: Callable[P, None]) -> Callable[P, None]:
        @functools.wraps(declared)
        def call(*args: P.args, **kwargs: P.kwargs) -> int:
            asked = SimpleNamespace(**kwargs)
            said = [f"sheet.{name}={kwargs[name]}" for name in ("units", "language") if kwargs.get(name)]
            if said and "changed" in kwargs:
                asked.changed = [*(asked.changed or ()), *said]
            return int(getattr(Later(f"truing.cli.{module}"), declared.__name__)(settings_of(asked.context), asked))

        return app.command(declared.__name__)(verb(call))

    return made


@app.command("plugins")
@verb
def plugins(
    context: typer.Context,
    names: Annotated[bool, typer.Option("--names", help="Names only, from metadata; nothing is loaded.")] = False,
    as_json: AsJson = False,
    strict: Annotated[bool, typer.Option("--strict", help="End at the first broken plugin.")] = False,
) -> int:
    """List what is installed, from where, which version, and what broke while loading."""
    if not names:
        return int(Later("truing.cli.models").plugins(settings_of(context), as_json=as_json, strict=strict))
    for name in Later("truing.entry_points").plugin_names():
        out(name)
    return 0


@_loaded("models")
def describe(
    context: typer.Context,
    plugin: Plugin,
    as_json: AsJson = False,
    as_schema: Annotated[
        bool, typer.Option("--json-schema", help="The JSON Schema of the inputs file, for editors.")
    ] = False,
) -> None:
    """Show inputs, results, error sources and objectives: symbols, units, bounds, sources."""


@_loaded("models")
def init(
    context: typer.Context,
    plugin: Plugin,
    output: OutputFile = None,
    excel: Annotated[
        bool, typer.Option("--excel", "--xlsx", help="Write a workbook to fill in, as where FILE ends in .xlsx.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
    no_schema: Annotated[bool, typer.Option("--no-schema", help="Write no schema for editors beside it.")] = False,
) -> None:
    """Write a commented inputs file that holds the shipped example."""


@_loaded("explain")
def explain(
    context: typer.Context,
    what: Annotated[
        str,
        typer.Argument(help="PLUGIN.NAME; or a plugin or Python file, and the name behind it.", autocompletion=names),
    ],
    name: Annotated[
        str, typer.Argument(help="The name, where it does not stand in WHAT.", autocompletion=names_inside)
    ] = "",
    inputs: Inputs = None,
    changed: Changed = None,
    as_json: AsJson = False,
) -> None:
    """Explain a result: formula, what it is made from, what moves it; or an input, an effect, a tolerance."""


@_loaded("run")
def run(
    context: typer.Context,
    plugin: Plugin,
    inputs: Inputs = None,
    changed: Changed = None,
    units: Units = None,
    language: Language = "",
    cases: Cases = None,
    output: RunFolder = None,
    workers: Annotated[int | None, typer.Option("--workers", min=1, help="Processes that share the work.")] = None,
    cluster: Annotated[
        str, typer.Option("--cluster", metavar="ADDRESS", help="A dask scheduler, tcp://HOST:PORT, that shares it out.")
    ] = "",
    resume: Annotated[
        bool, typer.Option("--resume", help="Keep finished batches, and take up those of an interrupted run.")
    ] = False,
    pdf: Pdf = False,
    docx: Docx = False,
    excel: Excel = False,
    xlsx: Xlsx = False,
    as_json: AsJson = False,
) -> None:
    """Run the calculation and its studies and write the calculation sheet."""


@_loaded("sweep")
def sweep(
    context: typer.Context,
    plugin: Plugin,
    input: Annotated[str, typer.Argument(help="The input or condition.", autocompletion=candidates.varied)],
    range: Annotated[str, typer.Argument(help="Its range, LOW..HIGH, or values joined by commas.")],
    unit: Annotated[str, typer.Argument(help="The unit, where it does not stand in RANGE.")] = "",
    over: Annotated[
        tuple[str, str] | None,
        typer.Option("--over", metavar="INPUT RANGE", help="A second input: a line for each of its values."),
    ] = None,
    results: Annotated[
        str, typer.Option("--results", metavar="A,B", help="What is shown; without it all results that change.")
    ] = "",
    steps: Annotated[int, typer.Option("--steps", help="How many points a range has.")] = 181,
    inputs: Inputs = None,
    changed: Changed = None,
    units: Units = None,
    language: Language = "",
    output: Annotated[Path | None, typer.Option("-o", "--output", help="The folder (default runs/STEM_sweep).")] = None,
    as_json: AsJson = False,
) -> None:
    """Draw how results run along an input, with their limits; the model need not declare it."""


@_loaded("watch")
def watch(
    context: typer.Context,
    plugin: Plugin,
    inputs: Annotated[Path, typer.Option("--inputs", "-i", help="The inputs file that is being edited.")],
    data: Data = None,
    changed: Changed = None,
    units: Units = None,
    language: Language = "",
    cases: Cases = None,
    output: RunFolder = None,
    excel: Excel = False,
    xlsx: Xlsx = False,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes that share the work.")] = 1,
    every: Annotated[float, typer.Option("--every", min=0.02, help="Seconds without a change before it runs.")] = 0.5,
) -> None:
    """Run, or with --data diagnose, again whenever inputs, data files or the plugin's code change; Ctrl-C ends it."""


@_loaded("table")
def table(
    context: typer.Context,
    plugin: Plugin,
    inputs: Annotated[Path, typer.Option("--inputs", "-i", help="The inputs file.")],
    rows: Annotated[
        Path, typer.Option("--rows", help="CSV, .xlsx or a recording; columns replace inputs or conditions row by row.")
    ],
    output: OutputFile = None,
    changed: Changed = None,
    excel: Excel = False,
) -> None:
    """Print what the gauge would show at every row: the file's columns, then the results, units in the header."""


@_loaded("diagnose")
def diagnose(
    context: typer.Context,
    plugin: Plugin,
    files: Annotated[list[Path] | None, typer.Argument(help="Further files of measured rows.")] = None,
    inputs: Inputs = None,
    data: Data = None,
    changed: Changed = None,
    units: Units = None,
    language: Language = "",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The folder (default runs/STEM of the first data file).")
    ] = None,
    pdf: Pdf = False,
    docx: Docx = False,
    xlsx: Xlsx = False,
    as_json: AsJson = False,
) -> None:
    """Find what the simulation gets wrong, name the cause, extend the model and measure the gain."""


@_loaded("plan")
def plan(
    context: typer.Context,
    plugin: Plugin,
    causes: Annotated[
        str, typer.Option("--causes", metavar="A,B", help="Effects to tell apart, or input:NAME; joined by commas.")
    ],
    inputs: Inputs = None,
    noise: Annotated[
        list[str] | None,
        typer.Option("--noise", metavar="RESULT=SD", help="Standard deviation of one reading; one for each gauge."),
    ] = None,
    budget: Annotated[int, typer.Option("--budget", help="How many readings there may be.")] = 12,
    changed: Changed = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Write the readings to take as CSV, to be filled in.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Design an experiment that tells causes apart, before any data exist; exit 1 where none does."""


@_loaded("models")
def verify(context: typer.Context, plugin: Plugin, as_json: AsJson = False) -> None:
    """Print every number that the source prints beside ours; exit 0 if every row matches its stated verdict."""


@_loaded("folders")
def compare(
    context: typer.Context,
    first: Annotated[
        Path, typer.Argument(help="A run folder, that of a diagnosis, or an inputs file.", autocompletion=runs)
    ],
    second: Annotated[Path, typer.Argument(help="Another one of the same kind.", autocompletion=runs)],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Write both side by side, with figures: .html, .md, .pdf or .docx."),
    ] = None,
    language: Language = "",
    plugin: Annotated[
        str,
        typer.Option("--plugin", help="What runs inputs files that name none.", autocompletion=candidates.plugins),
    ] = "",
    as_json: AsJson = False,
) -> None:
    """Show inputs, results and checks that changed: exit 0 when equal, 1 when different."""


@_loaded("folders")
def index(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(help="The folder that holds runs and diagnoses, however deep.")] = Path(
        "runs"
    ),
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The page to write (index.html in the folder without it).")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write one page that lists the runs and diagnoses of a folder, to sort and to filter, offline."""


@_loaded("serve")
def serve(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(help="The folder with inputs files and measured data.")] = Path("."),
    host: Annotated[str, typer.Option("--host", help="The address that is listened to.")] = "127.0.0.1",
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="The port; 0 is any that is free.")] = 0,
    memory: Annotated[float, typer.Option("--memory", min=0.5, help="GB that one calculation may take.")] = 4.0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Open no browser; print the address only.")] = False,
) -> None:
    """Open the workbench: a page on this machine to edit, run, measure, diagnose and keep; Ctrl-C ends it."""


@_loaded("new")
def new(
    context: typer.Context,
    name: Annotated[str, typer.Argument(help="The plugin's name: lower-case words joined by _.")],
    title: Annotated[str | None, typer.Option("--title", help="The title of its sheet (the name without it).")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The folder (or single file) to write (NAME without it).")
    ] = None,
    single: Annotated[bool, typer.Option("--single-file", help="One Python file instead of a project.")] = False,
    workbook: Annotated[
        Path | None, typer.Option("--from", help="Draft a single file from a sheet: book.xlsx#Sheet.")
    ] = None,
) -> None:
    """Write a plugin of your own: package, tests, entry point, CI; it works as written."""


@_loaded("completion")
def completion(
    context: typer.Context,
    shell: Annotated[Shell | None, typer.Argument(help="The shell (default: the one you are in).")] = None,
    install: Annotated[bool, typer.Option("--install", help="Put the script where your shell finds it.")] = False,
) -> None:
    """Print the script by which your shell completes plugins, inputs and results, or install it."""


# Arguments and options that several verbs share


class UnitsWord(StrEnum):
    """A system of units: millimetre and newton, or inch and pound."""

    SI = "SI"
    inch = "inch"


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
Units: TypeAlias = Annotated[UnitsWord | None, typer.Option("--units", help="The units of all that people read.")]
AsJson: TypeAlias = Annotated[bool, typer.Option("--json", help="One JSON document on stdout.")]
OutputFile: TypeAlias = Annotated[
    Path | None, typer.Option("-o", "--output", help="The file to write (stdout without it).")
]
Excel: TypeAlias = Annotated[
    bool, typer.Option("--excel", help="Write CSV that a spreadsheet with a decimal comma opens.")
]
Xlsx: TypeAlias = Annotated[bool, typer.Option("--xlsx", help="Add a workbook with the tables to the folder.")]
Inputs: TypeAlias = Annotated[
    Path | None, typer.Option("--inputs", "-i", help="The inputs file; without it the shipped example.")
]
Cases: TypeAlias = Annotated[Path | None, typer.Option("--cases", help="CSV, .xlsx or .parquet: every row is a case.")]
Data: TypeAlias = Annotated[
    list[Path] | None,
    typer.Option("--data", "-d", help="Measured rows: CSV, .xlsx or a recording; may be repeated."),
]
RunFolder: TypeAlias = Annotated[
    Path | None, typer.Option("--output", "-o", help="The run folder (default runs/STEM).")
]
Language: TypeAlias = Annotated[
    str,
    typer.Option(
        "--language", metavar="LANGUAGE", help="The language of the sheet: en, de.", autocompletion=candidates.languages
    ),
]
Pdf: TypeAlias = Annotated[bool, typer.Option("--pdf", help="Print the sheet to PDF with an installed browser.")]
Docx: TypeAlias = Annotated[bool, typer.Option("--docx", help="Add the sheet as a Word document.")]


class Shell(StrEnum):
    """A shell that can complete."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"
    powershell = "powershell"
