"""The command line as a process, its answer, and the strangers' projects: what tests import from one another."""

import os
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).parent
ROOT = TESTS.parent
GUESTS = ("screw_joint", "broken_guest")


@dataclass(frozen=True)
class Answer:
    """What a command answered: exit code, results, and everything else that was said."""

    code: int
    out: str
    err: str


Calc = Callable[..., Answer]


def process(command: list[str], cwd: Path, more: Mapping[str, str] | None = None) -> Answer:
    """Run a command, speaking UTF-8, outside of the project's folder."""
    environment = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "COLUMNS"}}
    done = subprocess.run(
        command,
        cwd=cwd,
        env={**environment, "PYTHONUTF8": "1", **(more or {})},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=900,
        check=False,
    )
    return Answer(done.returncode, done.stdout, done.stderr)


def copied_guest(name: str, folder: Path) -> Path:
    """Copy a stranger's project, so that building it leaves nothing behind."""
    target = folder / name
    shutil.copytree(TESTS / "third_party" / name, target, ignore=shutil.ignore_patterns("__pycache__"))
    return target
