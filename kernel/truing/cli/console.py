"""Where words go: results to stdout, everything else to stderr, one sentence per error; and how a command ends."""

from __future__ import annotations

import _thread
import functools
import json
import os
import re
import shutil
import signal
import sys
import textwrap
import threading
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ParamSpec, TextIO

import typer

from truing.errors import InputError, OutputError, TruingError
from truing.heavy import Later
from truing.texts import one_line

P = ParamSpec("P")
NARROWEST = 60
GAP = "  "
_ORDERS = re.compile("[\\x00-\\x08\\x0b-\\x1f\\x7f-\\x9f\\u202a-\\u202e\\u2066-\\u2069]")
_PLACE = re.compile(r"[^\n]+?:\d+: ")


@dataclass(frozen=True)
class Settings:
    """What holds for every verb: how much is said, and whether an error shows its traceback."""

    traceback: bool = False
    verbose: bool = False
    quiet: bool = False

    def say(self, text: str) -> None:
        """Say something that is neither a result nor an error, unless all is to be quiet."""
        if not self.quiet:
            say(text)

    def detail(self, text: str) -> None:
        """Say something that only those want to know who ask for more."""
        if self.verbose and not self.quiet:
            say(text)


_atomic: Any = Later("truing.atomic")
_lost: list[str] = []
"""Why the output took no more, since the present command began."""


def ready_streams() -> None:
    """Speak UTF-8 whatever the terminal's code page says; what is written to a closed stream goes nowhere."""
    _lost.clear()
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115  # as long as the process
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(encoding="utf-8", errors="replace")


def out(text: str) -> bool:
    """Print a result, without what a terminal would obey; see ``put``."""
    return put(f"{harmless(text)}\n")


def put(text: str) -> bool:
    """Write to the output as it stands, and tell whether somebody reads.

    Nothing is raised: a calculation is not undone by an output that takes nothing. Where nobody reads any more nothing
    is said of it; where it cannot be written (a full disk) the verb says so at its end, and does not end with 0.
    """
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except (OSError, ValueError) as error:
        lose_output(error)
        return False
    return True


def lose_output(error: Exception) -> None:
    """Take note that the output takes no more, and why; a reader who has gone is no fault."""
    close_stream(sys.stdout)
    if not isinstance(error, BrokenPipeError):
        _lost.append(getattr(error, "strerror", None) or str(error))


def out_json(document: Any) -> None:
    """Print one JSON document."""
    out(json_text(document))


def json_text(document: Any, *, indent: int | None = 1) -> str:
    """Return a document as JSON; what a terminal would obey is written as an escape, so that it reads back alike."""
    text = json.dumps(document, ensure_ascii=False, indent=indent, allow_nan=False)
    return _ORDERS.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def say(text: str) -> None:
    """Say something that is no result; where that cannot be written, nothing more is said."""
    try:
        sys.stderr.write(f"{harmless(text)}\n")
        sys.stderr.flush()
    except (OSError, ValueError):
        close_stream(sys.stderr)


def harmless(text: str) -> str:
    """Return a text without the characters that a terminal obeys: escapes, bells, turned writing; lines stay."""
    return _ORDERS.sub("?", text)


def settings_of(context: Any) -> Settings:
    """Return the settings of this call."""
    said = getattr(context, "obj", None)
    return said if isinstance(said, Settings) else Settings()


def verb(function: Callable[P, int]) -> Callable[P, None]:
    """Turn a function that returns an exit code into a verb: every error becomes one sentence and a code."""

    @functools.wraps(function)
    def guarded(*args: P.args, **kwargs: P.kwargs) -> None:
        settings = settings_of(kwargs.get("context"))
        before = _atomic.writings()
        try:
            code = function(*args, **kwargs)
        except KeyboardInterrupt as end:
            say(str(end) or interrupted(before))
            code = exit_code_of(end)
        except Exception as error:
            if settings.traceback:
                say(traceback.format_exc().rstrip())
            say(sentence_of(error))
            code = exit_code_of(error)
        raise typer.Exit(code)

    return guarded


def interrupted(before: int) -> str:
    """Say what was written when it was interrupted, of all that followed the first ``before`` writings."""
    complete = _atomic.written(before)
    if not complete:
        return "calc: interrupted; nothing was written"
    return f"calc: interrupted; {' and '.join(map(str, complete))} {'is' if len(complete) == 1 else 'are'} complete"


def after_output(code: int) -> int:
    """Return the exit code of what ended with ``code``; say it where results could not be written, which is not 0."""
    if not _lost:
        return code
    say(f"calc: the results cannot be written to the output: {_lost[0]}")
    return code or OutputError.exit_code


def exit_code_of(error: BaseException) -> int:
    """Return the exit code of an error; one of the system, as of a disk, is no fault of the program."""
    if isinstance(error, KeyboardInterrupt):
        return 143 if isinstance(error, Terminated) else 130
    if isinstance(error, OSError):
        return OutputError.exit_code
    return error.exit_code if isinstance(error, TruingError) else 3


def sentence_of(error: Exception) -> str:
    """Return what is said of an error: with the place it names, or in the name of the program."""
    if isinstance(error, OSError):
        return f"calc: {one_line(error.filename or 'the system')}: {one_line(error.strerror or error)}"
    if not isinstance(error, TruingError):
        words = one_line(f"{type(error).__name__}: {error}")
        return f"calc: {words} (this is a fault of the program; --traceback shows where)"
    has_place = isinstance(error, InputError) or _PLACE.match(str(error))
    return str(error) if has_place else f"calc: {error}"


def close_stream(stream: TextIO) -> None:
    """Write nothing more to a stream that takes nothing, so that nothing is said of it at the end."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def aligned(rows: Sequence[Sequence[str]], *, right: Sequence[int] = (), width: int = 0) -> list[str]:
    """Return each row of text with its columns aligned; those at the indices ``right`` are flush right.

    The last column is broken to fit into ``width``; without one into a terminal's, and elsewhere every row is one line.
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    indent = sum(widths[:-1]) + len(GAP) * (len(widths) - 1)
    lines = []
    for row in rows:
        sized = zip(row, widths, strict=True)
        cells = [cell.rjust(size) if index in right else cell.ljust(size) for index, (cell, size) in enumerate(sized)]
        lines.append("\n".join(broken(GAP.join(cells).rstrip(), indent, width)))
    return lines


def broken(line: str, indent: int, width: int = 0) -> list[str]:
    """Break a line that is wider than ``width``, or the terminal, behind its indent; without either leave it whole."""
    width = width or (shutil.get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize)
    if len(line) <= width or width - indent < NARROWEST // 3 or width < NARROWEST:
        return [line]
    parts = textwrap.wrap(line[indent:], width - indent, break_on_hyphens=False) or [""]
    return [line[:indent] + parts[0], *(" " * indent + part for part in parts[1:])]


# How a command is ended from outside: by Ctrl-C and by the system, and by neither in vain


AFTER_FINALIZER = 0.05
"""So many seconds after a finalizer that an interrupt was dropped in it is raised again."""


class Terminated(KeyboardInterrupt):  # as the interrupt it is
    """The system has asked this process to end (SIGTERM): what Ctrl-C does, with another exit code."""


def hear_endings() -> None:
    """End as after an interrupt when the system asks for it, so that nothing is left behind.

    Python drops an exception in a finalizer. An interrupt that comes just then is raised once more, after it.
    """

    def terminate(number: int, frame: object) -> None:
        raise Terminated

    def raise_again(dropped: sys.UnraisableHookArgs) -> None:
        if not isinstance(dropped.exc_value, KeyboardInterrupt):
            sys.__unraisablehook__(dropped)
            return
        number = signal.SIGTERM if isinstance(dropped.exc_value, Terminated) else signal.SIGINT
        later = threading.Timer(AFTER_FINALIZER, _signal_main, [number])
        later.daemon = True
        later.start()

    signal.signal(signal.SIGTERM, terminate)
    sys.unraisablehook = raise_again


def _signal_main(number: signal.Signals) -> None:
    """Send a signal to the main thread, wherever it waits."""
    main = threading.main_thread().ident
    if sys.platform == "win32" or main is None:
        _thread.interrupt_main(number)
    else:
        signal.pthread_kill(main, number)
