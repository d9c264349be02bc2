"""The command and its verbs, put together."""

from __future__ import annotations

from importlib.metadata import version

import typer

from truing.cli import (
    compare,
    completion,
    describe,
    diagnose,
    explain,
    index,
    init,
    new,
    plugins,
    run,
    table,
    verify,
    watch,
)
from truing.cli.console import out

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
        out(f"truing {version('truing')}")
        raise typer.Exit


@app.callback()
def _common(
    version: bool = typer.Option(False, "--version", callback=_version, is_eager=True, help="Print the version."),
    verbose: bool = typer.Option(False, "--verbose", "-v", help="Say more (may stand anywhere)."),
    quiet: bool = typer.Option(False, "--quiet", "-q", help="Say only errors and results (may stand anywhere)."),
    traceback: bool = typer.Option(False, "--traceback", help="Show where an error comes from (may stand anywhere)."),
) -> None:
    """Engineering calculations as plugins: checked units, studies, and a sheet to sign."""


app.command("plugins")(plugins.plugins)
app.command("describe")(describe.describe)
app.command("init")(init.init)
app.command("explain")(explain.explain)
app.command("run")(run.run)
app.command("watch")(watch.watch)
app.command("table")(table.table)
app.command("diagnose")(diagnose.diagnose)
app.command("verify")(verify.verify)
app.command("compare")(compare.compare)
app.command("index")(index.index)
app.command("new")(new.new)
app.command("completion")(completion.completion)
