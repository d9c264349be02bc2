"""What the shell may offer where a word is begun: plugins, models, inputs, results, run folders.

Names of plugins come from metadata; only what lies inside a plugin loads that one. A shell that asks is answered or
not, but never told of an error.
"""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout, suppress
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import Any, ParamSpec

import typer

from truing.heavy import Later
from truing.texts import one_line

P = ParamSpec("P")
OfferedWord = tuple[str, str]
"""A word to offer, and what it is."""

SPECIAL = set(" \t\"'`$\\;&|<>(){}*?!#~")
"""A name with one of these is more than one word to a shell."""
LONGEST_HELP = 90
_door: Any = Later("truing.entry_points")
_inside: Any = Later("truing.cli.inside")
"""What lies inside a plugin: loaded when a shell asks for it."""


def silent(function: Callable[P, Iterator[OfferedWord]]) -> Callable[P, list[OfferedWord]]:
    """Turn what gives names into what a shell may ask: nothing is printed, and of what fails nothing is said."""

    @functools.wraps(function)
    def asked(*args: P.args, **kwargs: P.kwargs) -> list[OfferedWord]:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            try:
                words = [(name, _one_line(help_text)) for name, help_text in function(*args, **kwargs)]
                return [(name, text) for name, text in words if name.isprintable() and not SPECIAL & set(name)]
            except (Exception, SystemExit):
                return []

    return asked


def _one_line(words: str) -> str:
    """Return a help text as one line that no shell and no markup takes for an order."""
    plain = one_line(words).replace("[", "(").replace("]", ")")
    return plain if len(plain) <= LONGEST_HELP else plain[: LONGEST_HELP - 1] + "…"


@silent
def plugins(incomplete: str) -> Iterator[OfferedWord]:
    """Offer installed plugins; behind the whole name of one, or its point, the models it offers."""
    if _is_file(incomplete):
        return
    entries = {entry.name: entry for entry in _door.entry_points()}
    plugin = incomplete.partition(".")[0]
    if plugin in entries:
        yield from ((offer.name, offer.model.title) for offer in _inside.offers(plugin))
    else:
        yield from ((name, _from(entry.dist)) for name, entry in entries.items())


@silent
def names(incomplete: str) -> Iterator[OfferedWord]:
    """Offer PLUGIN.NAME: plugins first, then what the one that is named answers, takes, and could have wrong."""
    if _is_file(incomplete):
        return
    if "." not in incomplete:
        yield from ((f"{entry.name}.", _from(entry.dist)) for entry in _door.entry_points())
        return
    yield from _inside.names_of(incomplete)


@silent
def names_inside(context: typer.Context, incomplete: str) -> Iterator[OfferedWord]:
    """Offer what the calculation that is typed already answers, takes, and could have wrong."""
    yield from _inside.names_inside(context)


@silent
def varied(context: typer.Context, incomplete: str) -> Iterator[OfferedWord]:
    """Offer the numbers among the inputs, and the conditions, of the calculation that is typed already."""
    yield from _inside.varied(context)


@silent
def changes(context: typer.Context, incomplete: str) -> Iterator[OfferedWord]:
    """Offer what ``--set`` takes for the plugin that is typed already: NAME=, section by section, and choices."""
    yield from _inside.changes(context, incomplete)


@silent
def runs(incomplete: str) -> Iterator[OfferedWord]:
    """Offer folders of runs and diagnoses, and the folders on the way to them."""
    above = incomplete.rpartition("/")[0]
    searched = Path(f"{above}/" if above or incomplete.startswith("/") else ".")
    folders = sorted(entry for entry in searched.iterdir() if entry.is_dir() and not entry.name.startswith("."))
    for folder in folders:
        name = f"{incomplete[: len(incomplete) - len(incomplete.rpartition('/')[2])]}{folder.name}"
        kinds = {"results.json": "a run", "diagnosis.json": "a diagnosis"}
        kind = next((kind for file, kind in kinds.items() if (folder / file).is_file()), "")
        yield (name, kind) if kind else (f"{name}/", "a folder")


@silent
def languages(incomplete: str) -> Iterator[OfferedWord]:
    """Offer the languages that a sheet can be in."""
    yield from ((name, "") for name in Later("truing.templating").languages() if name.startswith(incomplete))


def _is_file(incomplete: str) -> bool:
    """Tell whether a word is on the way to a file, which the shell completes itself."""
    return incomplete.startswith((".", "~")) or "/" in incomplete or "\\" in incomplete or incomplete.endswith(".py")


def _from(distribution: Any) -> str:
    return f"{distribution.name} {distribution.version}" if distribution is not None else ""


# The answer when a shell asks what it may complete


LINE = "_TYPER_COMPLETE_ARGS"
"""The environment variable in which a shell hands over what was typed."""
_FLAGS = re.compile(r"(?<=\s)(?:-q|-v|--quiet|--verbose|--traceback)(?=\s)")


def answer_the_shell(app: Callable[..., object]) -> int:
    """Answer a shell that asks, through the protocol of typer; whatever goes wrong, nothing is said."""
    os.environ["COLUMNS"] = os.environ["TERMINAL_WIDTH"] = "1000"  # a help text broken into lines would be names
    line = os.environ.get(LINE)
    if line is not None:
        os.environ[LINE] = _FLAGS.sub("", line)
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stderr(nowhere), suppress(SystemExit, Exception):
        import_module("typer.completion").completion_init()
        app(args=[], prog_name="calc")
    return 0
