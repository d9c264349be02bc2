"""What pytest gets of Truing: two fixtures, at no cost to whoever only happens to have it installed."""

import sys
from pathlib import Path

from truing.testing import Answer, Calc
from truing.testing.fixtures import process

LIGHT = """
import sys

import pytest


def test_nothing_heavy_is_loaded():
    heavy = {"numpy", "pint", "scipy", "typer", "truing.kernel", "truing.declare", "truing.cli", "truing.testing.kit"}
    assert "truing.testing.fixtures" in sys.modules
    assert not heavy & set(sys.modules)


@pytest.fixture
def calc():
    return 3


def test_a_fixture_of_ones_own_comes_first(calc):
    assert calc == 3
"""
WITHOUT = """
import sys


def test_it_is_not_there():
    assert "truing" not in sys.modules


def test_calc(calc):
    pass
"""


def test_calc_runs_the_command_line_in_an_empty_folder(calc: Calc, tmp_path: Path) -> None:
    assert not list(tmp_path.iterdir())
    answer = calc("init", "press_linkage", "-o", "press.toml")
    assert answer == Answer(0, "", answer.err)
    assert (tmp_path / "press.toml").exists()
    (tmp_path / "other").mkdir()
    refused = calc("run", "press_linkage", "--inputs", "press.toml", cwd=tmp_path / "other")
    assert (refused.code, refused.out) == (2, "")
    assert "press.toml" in refused.err


def pytest_on(folder: Path, text: str, *words: str) -> Answer:
    """Run pytest, every warning an error, as somebody else would."""
    (folder / "test_theirs.py").write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider", "-p", "no:benchmark"]
    return process([*command, *words], folder)


def test_nothing_heavy_is_loaded_when_pytest_starts(tmp_path: Path) -> None:
    answer = pytest_on(tmp_path, LIGHT)
    assert answer.code == 0, answer.out
    assert answer.out.splitlines()[-1].startswith("2 passed")


def test_it_can_be_left_out(tmp_path: Path) -> None:
    answer = pytest_on(tmp_path, WITHOUT, "-p", "no:truing")
    assert "fixture 'calc' not found" in answer.out
    assert "1 passed, 1 error" in answer.out.splitlines()[-1]
