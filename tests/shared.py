"""The strangers' projects, and what the kit calls the command line: what tests import from one another."""

import shutil
from pathlib import Path

from truing.testing import Answer, Calc
from truing.testing.fixtures import process

TESTS = Path(__file__).parent
ROOT = TESTS.parent
GUESTS = ("screw_joint", "broken_guest")
__all__ = ["GUESTS", "ROOT", "TESTS", "Answer", "Calc", "copied_guest", "process"]


def copied_guest(name: str, folder: Path) -> Path:
    """Copy a stranger's project, so that building it leaves nothing behind."""
    target = folder / name
    shutil.copytree(TESTS / "third_party" / name, target, ignore=shutil.ignore_patterns("__pycache__"))
    return target
