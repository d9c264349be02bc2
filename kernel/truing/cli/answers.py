"""The answer when a shell asks what it may complete."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import redirect_stderr, suppress
from importlib import import_module

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
