"""Where words go: results to stdout, everything else to stderr, one sentence per error."""

from __future__ import annotations

import functools
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ParamSpec

import typer

from truing.errors import InputError, TruingError

if TYPE_CHECKING:
    from truing.studies.bench import Progress

P = ParamSpec("P")


@dataclass(frozen=True)
class Settings:
    """What holds for every verb: how much is said, and whether an error shows its traceback."""

    traceback: bool = False
    verbose: bool = False
    quiet: bool = False


def utf8_streams() -> None:
    """Speak UTF-8 whatever the terminal's code page says."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(encoding="utf-8", errors="replace")


def out(text: str) -> None:
    """Print a result."""
    print(text)  # noqa: T201  # this is where printing is done


def out_json(document: Any) -> None:
    """Print one JSON document."""
    out(json.dumps(document, ensure_ascii=False, indent=1, allow_nan=False))


def say(text: str) -> None:
    """Say something that is no result."""
    print(text, file=sys.stderr)  # noqa: T201


def settings_of(context: typer.Context) -> Settings:
    """Return the settings of this call."""
    return context.obj if isinstance(context.obj, Settings) else Settings()


def verb(function: Callable[P, int]) -> Callable[P, None]:
    """Turn a function that returns an exit code into a verb: every error becomes one sentence and a code."""

    @functools.wraps(function)
    def guarded(*args: P.args, **kwargs: P.kwargs) -> None:
        context = kwargs.get("context")
        settings = settings_of(context) if isinstance(context, typer.Context) else Settings()
        try:
            code = function(*args, **kwargs)
        except KeyboardInterrupt:
            say("calc: interrupted; nothing was written")
            code = 130
        except TruingError as error:
            if settings.traceback:
                raise
            say(str(error) if isinstance(error, InputError) or ":" in str(error).split(" ")[0] else f"calc: {error}")
            code = error.exit_code
        except BrokenPipeError:
            code = 0
        except Exception as error:
            if settings.traceback:
                raise
            say(f"calc: {type(error).__name__}: {error} (this is a fault of the program; --traceback shows where)")
            code = 3
        raise typer.Exit(code)

    return guarded


@contextmanager
def progress_bar(settings: Settings) -> Iterator[Progress]:
    """Show a progress bar on a terminal and nothing elsewhere."""
    if settings.quiet or not sys.stderr.isatty():
        yield lambda task, done, total: None
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    with Bar(console=Console(stderr=True), transient=True) as bar:
        tasks: dict[str, Any] = {}

        def show(task: str, done: int, total: int) -> None:
            if task not in tasks:
                tasks[task] = bar.add_task(task, total=total)
            bar.update(tasks[task], completed=done, total=total)

        yield show


def columns(rows: Sequence[Sequence[str]], *, right: Sequence[int] = (), gap: str = "  ") -> str:
    """Return rows of text in aligned columns; those at the places ``right`` are flush right."""
    widths = [max(len(row[place]) for row in rows) for place in range(len(rows[0]))] if rows else []
    lines = []
    for row in rows:
        cells = [cell.rjust(w) if k in right else cell.ljust(w) for k, (cell, w) in enumerate(zip(row, widths, strict=True))]
        lines.append(gap.join(cells).rstrip())
    return "\n".join(lines)


def one_line(text: object) -> str:
    """Return a text as one printable line."""
    return " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
