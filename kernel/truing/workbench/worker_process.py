"""A worker process: it does one task after another, and says progress, answers and faults through a pipe.

What a model prints goes to a file and not to the terminal; how much memory it may take is limited where the system can.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from multiprocessing.connection import Connection
from typing import Any

from truing.errors import InputError, TruingError
from truing.heavy import Later
from truing.texts import one_line
from truing.workbench.tasks import task

resource: Any = Later("resource")
EXCEPTIONS = (Exception, SystemExit, KeyboardInterrupt)


def work(pipe: Connection, memory: int) -> None:
    """Answer requests ``(name, arguments)`` until the pipe closes; ``memory`` are the bytes that data may take."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends its workers
    _limit_memory(memory)
    printed = _redirect_output()
    with suppress(EOFError, OSError):
        while True:
            name, arguments = pipe.recv()
            printed.seek(0)
            printed.truncate()
            pipe.send(_answer(pipe, name, arguments))


def _answer(pipe: Connection, name: str, arguments: Mapping[str, Any]) -> tuple[str, Any]:
    def progress(stage: str, done: int, total: int) -> None:
        with suppress(OSError):
            pipe.send(("progress", (stage, done, total)))

    function = task(name)
    with_progress = {"progress": progress} if "progress" in function.__code__.co_varnames else {}
    try:
        return "answer", function(**arguments, **with_progress)
    except InputError as error:
        return "faults", [asdict(fault) for fault in error.faults]
    except TruingError as error:
        return "faults", [{"message": str(error), "file": "", "line": None, "cell": ""}]
    except MemoryError:
        return "faults", [_said("the calculation asked for more memory than it may have; see calc serve --memory")]
    except EXCEPTIONS as error:
        return "faults", [_said(f"{type(error).__name__}: {one_line(str(error))}")]


def _said(sentence: str) -> dict[str, Any]:
    return {"message": sentence, "file": "", "line": None, "cell": ""}


def _limit_memory(most: int) -> None:
    with suppress(ImportError, AttributeError, ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def _redirect_output() -> Any:
    """Send what is printed, by Python or by a library, to a file that nobody keeps."""
    printed = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115  # as long as the process
    for descriptor in (1, 2):
        os.dup2(printed.fileno(), descriptor)
    with open(os.devnull) as nothing:
        os.dup2(nothing.fileno(), 0)
    sys.stdout = sys.stderr = printed
    return printed
