"""The pytest plugin: the command line in a test, here (``calc``) or as a process of its own (``calc_process``).

pytest loads it wherever Truing is installed, so it imports nothing but pytest until a fixture is used;
``-p no:truing`` leaves it out.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import pytest

from truing.heavy import Later

LONGEST = 900
"""Seconds that a process may take."""


@dataclass(frozen=True)
class Answer:
    """What a command answered: exit code, results (stdout), and everything else that was said (stderr)."""

    code: int
    out: str
    err: str


class Calc(Protocol):
    """The command line in a test: ``calc("run", "bolt", "--inputs", "bolt.toml")``."""

    def __call__(self, *arguments: str | Path, cwd: Path | None = None) -> Answer:
        """Run ``calc`` with these arguments, in the empty folder of the test unless ``cwd`` names another."""


class CalcProcess(Protocol):
    """The command line as a process of its own."""

    def __call__(self, *arguments: str | Path, cwd: Path | None = None, path: Path | None = None) -> Answer:
        """Run ``calc``; ``path`` is a folder where it finds further packages."""


@pytest.fixture
def calc(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Calc]:
    """Run ``calc`` in this process, in an empty folder (that of ``tmp_path``) unless ``cwd`` names another.

    What was loaded from that folder is forgotten when the test ends.
    """
    monkeypatch.setattr(sys, "path", list(sys.path))

    def run(*arguments: str | Path, cwd: Path | None = None) -> Answer:
        monkeypatch.chdir(tmp_path if cwd is None else cwd)
        capsys.readouterr()
        code = Later("truing.cli").main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return Answer(code, said.out, said.err)

    yield run
    for name, module in list(sys.modules.items()):
        if str(getattr(module, "__file__", None) or "").startswith(str(tmp_path)):
            del sys.modules[name]


@pytest.fixture
def calc_process(tmp_path: Path) -> CalcProcess:
    """Run ``calc`` as a process of its own, in an empty folder unless ``cwd`` names another."""

    def run(*arguments: str | Path, cwd: Path | None = None, path: Path | None = None) -> Answer:
        more = {"PYTHONPATH": str(path)} if path is not None else {}
        command = [sys.executable, "-m", "truing", *map(str, arguments)]
        return process(command, tmp_path if cwd is None else cwd, more)

    return run


def process(command: Sequence[str], cwd: Path, more: Mapping[str, str] | None = None) -> Answer:
    """Run a command that speaks UTF-8 in a folder; neither PYTHONPATH nor the width of a terminal is handed on."""
    environment = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "COLUMNS"}}
    done = subprocess.run(
        command,
        cwd=cwd,
        env={**environment, "PYTHONUTF8": "1", **(more or {})},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=LONGEST,
        check=False,
    )
    return Answer(done.returncode, done.stdout, done.stderr)
