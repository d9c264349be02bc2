"""The strangers' projects, and what the kit calls the command line: what tests import from one another."""

import os
import shutil
from pathlib import Path
from typing import NoReturn

import pytest

from truing.testing import Answer, Calc
from truing.testing.fixtures import process

TESTS = Path(__file__).parent
ROOT = TESTS.parent
ROUNDING = 8 * 2.0**-52
"""How far apart, relatively, one formula may come out in other instructions: alone or in a row of a batch, at another
place of an array, on another processor. numpy keeps its functions within 4 units in the last place on every processor,
so two ways agree to 8; what follows multiplies that by its condition."""
GUESTS = ("screw_joint", "broken_guest")
__all__ = ["GUESTS", "ROOT", "ROUNDING", "TESTS", "Answer", "Calc", "copied_guest", "missed", "process"]


def copied_guest(name: str, folder: Path) -> Path:
    """Copy a stranger's project, so that building it leaves nothing behind."""
    target = folder / name
    shutil.copytree(TESTS / "third_party" / name, target, ignore=shutil.ignore_patterns("__pycache__"))
    return target


def missed(words: str) -> NoReturn:
    """Skip a test that needs what this machine has not; fail where CI=true says that everything is there."""
    if os.environ.get("CI", "").lower() == "true":
        pytest.fail(words)
    pytest.skip(words)
