"""The strangers' projects, and what the kit calls the command line: what tests import from one another."""

import os
import shutil
import sys
import time
from collections.abc import Callable, Sequence
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
__all__ = [
    "GUESTS",
    "ROOT",
    "ROUNDING",
    "TESTS",
    "Answer",
    "Calc",
    "build_wheels",
    "copied_guest",
    "made_once",
    "missed",
    "process",
]


def copied_guest(name: str, folder: Path) -> Path:
    """Copy a stranger's project, so that building it leaves nothing behind."""
    target = folder / name
    shutil.copytree(TESTS / "third_party" / name, target, ignore=shutil.ignore_patterns("__pycache__"))
    return target


WHEELS = """
import os, sys
from hatchling.build import build_wheel
for source in sys.argv[2:]:
    os.chdir(source)
    print(build_wheel(sys.argv[1]))
"""


def build_wheels(folder: Path, sources: Sequence[Path]) -> list[Path]:
    """Build a wheel of each project into a folder."""
    done = process([sys.executable, "-c", WHEELS, str(folder), *map(str, sources)], folder)
    assert done.code == 0, done.err
    return [folder / name for name in done.out.split()]


def missed(words: str) -> NoReturn:
    """Skip a test that needs what this machine has not; fail where CI=true says that everything is there."""
    if os.environ.get("CI", "").lower() == "true":
        pytest.fail(words)
    pytest.skip(words)


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], None]) -> Path:
    """Return a folder that is filled once: of several processes that test, the first makes it and the others wait.

    What is wrong with it fails whoever asks for it.
    """
    alone = "PYTEST_XDIST_WORKER" not in os.environ
    place = (factory.getbasetemp() if alone else factory.getbasetemp().parent) / "once"
    place.mkdir(exist_ok=True)
    folder, said = place / name, place / f"{name}.said"
    try:
        folder.mkdir()
    except FileExistsError:
        end = time.monotonic() + 900
        while not said.exists() and time.monotonic() < end:
            time.sleep(0.2)
    else:
        words = place / f"{name}.words"
        try:
            make(folder)
            words.write_text("", encoding="utf-8")
        except BaseException as error:
            words.write_text(f"{type(error).__name__}: {error}", encoding="utf-8")
            raise
        finally:
            words.rename(said)
    fault = said.read_text(encoding="utf-8")
    assert not fault, fault
    return folder
