"""The command ``calc``: one file per verb, nothing but arguments and printing."""

from __future__ import annotations

import gc
import os
import re
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache

import typer.main

from truing.cli.app import app
from truing.cli.candidates import answer_the_shell
from truing.cli.console import Settings, after_output, close_stream, hear_endings, lose_output, ready_streams

FLAGS = {"--traceback": "traceback", "-v": "verbose", "--verbose": "verbose", "-q": "quiet", "--quiet": "quiet"}
MOST_NEW = 50_000
"""So many new objects are made before Python looks for rings of them that nobody uses.

At its own 700 a run of five seconds spends 0.38 s of them on it, at 10,000 0.16 s and at 50,000 0.10 s.
"""
NEGATIVE = re.compile(r"-\.?\d")
"""How a number below 0 begins, such as that of a range: behind a blank it is not taken for an option."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``calc`` with these arguments (the command line's by default) and return the exit code.

    0 done, and every check passed; 1 done, but a check fails; 2 usage or input, or results that could not be written;
    3 the plugin failed; 4 no convergence; 130 interrupted; 143 terminated.
    """
    is_program = arguments is None
    if is_program:
        gc.set_threshold(MOST_NEW)
    try:
        return _run(list(sys.argv[1:] if arguments is None else arguments), is_program=is_program)
    except KeyboardInterrupt:
        with suppress(OSError, ValueError, AttributeError):
            print("calc: interrupted; nothing was written", file=sys.stderr)  # noqa: T201
        return 130
    finally:
        if is_program:  # what still ends now is not worth a second word
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            exec(
                ""
            )  # CPython forgets that an interrupt ended such a text (a dataclass being made), and exits with our code


def _run(words: list[str], *, is_program: bool) -> int:
    ready_streams()
    if is_program:
        hear_endings()
    if "_CALC_COMPLETE" in os.environ:
        return answer_the_shell(app)
    end = words.index("--") if "--" in words else len(words)
    said = {FLAGS[word] for word in words[:end] if word in FLAGS}
    kept = [f" {word}" if NEGATIVE.match(word) else word for word in words[:end] if word not in FLAGS] + words[end:]
    code: object = 0
    try:
        _command()(args=kept, prog_name="calc", obj=Settings(**dict.fromkeys(said, True)))
    except SystemExit as end_:
        if isinstance(getattr(end_.__context__, "__cause__", None), KeyboardInterrupt):  # before the verb had begun
            raise KeyboardInterrupt from end_
        code = 0 if end_.code is None else end_.code
    except OSError as error:  # of the help or of a usage error: a verb raises none
        close_stream(sys.stderr)
        lose_output(error)
        code = 2
    return after_output(code if isinstance(code, int) else 2)


@cache
def _command() -> Callable[..., object]:
    """Return what reads the words of a verb, which is made of the declarations once per process."""
    return typer.main.get_command(app)
