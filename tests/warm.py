"""Python as a process of its own that need not import first: it is forked from one that has imported Truing."""

from __future__ import annotations

import gc
import multiprocessing
import os
import runpy
import signal
import sys
from collections.abc import Mapping, Sequence
from itertools import count
from multiprocessing import forkserver
from pathlib import Path

import pytest

from truing.testing import Answer
from truing.workbench.tasks import MODULES

TESTS = Path(__file__).parent
IMPORTED = ["truing.cli.run", "truing.cli.diagnose", "truing.cli.table", "truing.cli.watch", "truing.testing", "pytest"]
IMPORTED += ["truing.workbench.listening", *(f"truing.workbench.tasks.{module}" for module in MODULES)]
"""What the process has imported that all of them are forked from."""
LONGEST = 120.0
"""Seconds for what takes one or two on a quiet machine."""
FORKED_WORKERS = "FORKED_WORKERS"
"""With this in its environment a command forks its workers, in place of starting them afresh."""
WARM_WORKERS = "WARM_WORKERS"
"""With this in its environment a command that has threads has its workers forked from where it was forked itself."""
PATHS = [place for place in sys.path if not Path(place).is_relative_to(TESTS)]
"""Where modules are looked for before any test: one that loads a program of its own leaves its folder among them."""
_numbers = count()


class Running:
    """A command of Python (``-m``, ``-c`` or a file, with its arguments) in a folder, while it runs.

    It leads a group of processes, hears interrupts, and writes what it says into two files, or ``together`` into one.
    """

    def __init__(
        self,
        words: Sequence[str | Path],
        folder: Path,
        more: Mapping[str, str] | None = None,
        *,
        together: bool = False,
    ) -> None:
        if sys.platform == "win32":
            pytest.skip("Windows forks no processes")
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(IMPORTED)
        beside = folder.parent / f".{folder.name} {os.getpid()} {next(_numbers)}"
        self.out, self.err = (Path(f"{beside}.{name}") for name in ("out", "out" if together else "err"))
        dropped = ("PYTHONPATH", "COLUMNS", "PYTEST", "COV")
        kept = {name: value for name, value in os.environ.items() if not name.startswith(dropped)}
        arguments = ([str(word) for word in words], folder, {**kept, **(more or {})}, (self.out, self.err), PATHS)
        self._process = context.Process(target=_become, args=arguments)
        self._process.start()
        self.pid = self._process.pid or 0

    def poll(self) -> int | None:
        """Return the exit code, or nothing while it runs."""
        return self._process.exitcode

    def ended(self) -> Answer:
        """Wait until it has ended, and return what it answered."""
        self._process.join(LONGEST)
        code = self.poll()
        if code is None:
            self.signal(signal.SIGKILL)
        assert code is not None, f"not within {LONGEST} s: {self.said}"
        return Answer(code, *self.said)

    @property
    def said(self) -> tuple[str, str]:
        """What it has said so far: results (stdout), and everything else (stderr)."""
        out, err = (file.read_text(encoding="utf-8") if file.exists() else "" for file in (self.out, self.err))
        return out, "" if self.err == self.out else err

    def signal(self, number: int) -> None:
        """Signal to it and to all that it has started, as a terminal does."""
        os.killpg(self.pid, number)


def _become(
    words: list[str], folder: Path, environment: Mapping[str, str], said: tuple[Path, Path], paths: list[str]
) -> None:
    """Be this command, in a process that was just forked."""
    gc.freeze()  # else it looks through all that was imported, and copies every page of it
    os.setsid()
    for number, file in enumerate(said, start=1):
        opened = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(opened, number)
        os.close(opened)
    sys.stdout, sys.stderr = (os.fdopen(number, "w", 1, encoding="utf-8") for number in (1, 2))
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.dont_write_bytecode = "PYTHONDONTWRITEBYTECODE" in environment
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if FORKED_WORKERS in environment:
        context = multiprocessing.get_context("fork")
        multiprocessing.get_context = lambda method=None: context  # type: ignore[assignment]
    if WARM_WORKERS in environment:
        forkserver._forkserver.ensure_running = lambda: None  # type: ignore[attr-defined]  # it runs: this is its child
        context = multiprocessing.get_context("forkserver")
        multiprocessing.get_context = lambda method=None: context  # type: ignore[assignment]
    first = str(Path(words[0]).resolve().parent) if words[0] not in {"-m", "-c"} else str(folder)
    sys.path[:] = [first, *filter(None, environment.get("PYTHONPATH", "").split(os.pathsep)), *paths]
    sys.argv = [words[0], *words[2:]] if words[0] in {"-m", "-c"} else words
    if words[0] == "-m":
        runpy.run_module(words[1], run_name="__main__", alter_sys=True)
    elif words[0] == "-c":
        exec(compile(words[1], "<string>", "exec"), {"__name__": "__main__"})
    else:
        runpy.run_path(words[0], run_name="__main__")
