"""A worker process: it does one task after another, and says progress, answers and faults through a pipe.

Whatever a model does to its process must not reach the server: it leads a group of processes of its own, what it prints
goes nowhere, how much memory it may take is limited where the system can, and answers are bounded JSON.
"""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from truing.errors import InputError, TruingError
from truing.heavy import Later
from truing.texts import one_line
from truing.workbench.tasks import HOME, MODULES, task

resource: Any = Later("resource")
FAILURES = (Exception, SystemExit, KeyboardInterrupt)
LARGEST_ANSWER = 8_000_000
"""Bytes of an answer as JSON: more than a page can show."""
LONGEST_SENTENCE = 2000
"""Characters of a fault, whatever a model says of itself."""
SOON = {"models", "form"}
"""Modules of tasks that the first pages ask."""
PROGRESS_EVERY = 0.05
"""Seconds between two words of progress: a page shows no more."""


class Ended(BaseException):
    """The server wants this process to end: what is being written is taken back on the way."""


def work(pipe: Connection, memory: int, root: str, home: str = HOME) -> None:
    """Answer requests ``(number, name, arguments)`` until the pipe closes.

    ``memory`` are the bytes that data may take; ``root`` is the folder in which every task begins, and
    ``home`` the package of tasks.
    """
    process = os.getpid()
    _lead_a_group(process)
    _limit(memory)
    _close_streams()
    sys.path[:] = [path for path in sys.path if path and Path(path).resolve() != Path(root)]
    with suppress(EOFError, OSError, Ended):
        _warm_up(pipe, home)
        while True:
            number, name, arguments = pipe.recv()
            pipe.send_bytes(json.dumps([number, "begun", None]).encode())
            _begin_anew(root)
            said = _answer((name, home), arguments, _progress(pipe, number))
            if os.getpid() != process:  # a model has forked, and this is the copy
                os._exit(0)
            pipe.send_bytes(_as_json(number, *said))


def _lead_a_group(process: int) -> None:
    """End with the server, whatever became of it; what a model starts ends with this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which ends its workers
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
        if hasattr(os, "killpg") and os.getpid() == process:
            os.killpg(process, signal.SIGKILL)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _limit(memory: int) -> None:
    with suppress(ImportError, AttributeError, ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # a crash leaves no image of itself in the folder
        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
    with suppress(OSError):  # where memory is short all the same, this process ends before the server
        Path("/proc/self/oom_score_adj").write_text("500", encoding="ascii")


def _close_streams() -> None:
    """Send what is printed, by Python or by a library, nowhere; nothing is read."""
    nothing = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nothing, descriptor)
    sys.stdout = sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  # as long as the process


def _warm_up(pipe: Connection, home: str) -> None:
    """Import what tasks need, as long as nothing is asked."""
    for module in sorted(MODULES, key=lambda module: module not in SOON):
        if pipe.poll():
            return
        with suppress(ImportError):
            importlib.import_module(f"{home}.{module}")


def _begin_anew(root: str) -> None:
    """Put back what the model before may have changed."""

    def end(number: int, frame: object) -> None:
        raise Ended

    signal.signal(signal.SIGTERM, end)
    os.chdir(root)


def _progress(pipe: Connection, number: int) -> Callable[[str, int, int], None]:
    last = ("", 0.0)

    def progress(stage: str, done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        if (stage == last[0] and now - last[1] < PROGRESS_EVERY and done < total) or number < 0:
            return
        last = stage, now
        with suppress(OSError):
            pipe.send_bytes(json.dumps([number, "progress", [one_line(stage[:200]), int(done), int(total)]]).encode())

    return progress


def _answer(
    called: tuple[str, str], arguments: Mapping[str, Any], progress: Callable[[str, int, int], None]
) -> tuple[str, Any]:
    """Do a task and return ("answer", what it returns) or ("faults", what is wrong)."""
    try:
        function = task(*called)
        with_progress = {"progress": progress} if "progress" in function.__code__.co_varnames else {}
        return "answer", function(**arguments, **with_progress)
    except InputError as error:
        return "faults", [asdict(fault) for fault in error.faults]
    except TruingError as error:
        return "faults", [_said(str(error))]
    except MemoryError:
        return "faults", [_said("the calculation asked for more memory than it may have; see calc serve --memory")]
    except SystemExit as error:
        return "faults", [_said(f"the calculation ended itself (exit code {one_line(str(error.code)[:80])})")]
    except FAILURES as error:
        return "faults", [_said(f"{type(error).__name__}: {one_line(str(error)[: 2 * LONGEST_SENTENCE])}")]


def _said(sentence: str) -> dict[str, Any]:
    shown = sentence if len(sentence) <= LONGEST_SENTENCE else f"{sentence[:LONGEST_SENTENCE]} …"
    return {"message": shown, "file": "", "line": None, "cell": ""}


def _as_json(number: int, kind: str, said: Any) -> bytes:
    """Return what is sent: never more than the server takes, never a number that JSON has not (it becomes null)."""
    try:
        try:
            text = json.dumps([number, kind, said], allow_nan=False, default=_plain)
        except ValueError:
            text = json.dumps([number, kind, _finite(said)], allow_nan=False, default=_plain)
        if len(text) <= LARGEST_ANSWER:
            return text.encode()
        fault = f"the answer is larger than {LARGEST_ANSWER / 1e6:g} MB"
    except (TypeError, ValueError, RecursionError, MemoryError) as error:
        fault = f"the answer cannot be shown: {type(error).__name__}: {one_line(str(error))}"
    return json.dumps([number, "faults", [_said(fault)]]).encode()


def _plain(value: Any) -> Any:
    """Return a number or an array of numpy as Python's. Raises TypeError for anything else."""
    if hasattr(value, "tolist"):
        plain = value.tolist()
        return _finite(plain)
    raise TypeError(f"a {type(value).__name__} is no JSON")


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if value - value == 0 else None
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    return [_finite(each) for each in value] if isinstance(value, (list, tuple)) else value
