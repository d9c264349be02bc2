"""The calculations that the manual ships as examples are typed and in style, like any plugin."""

import sys

import pytest

from shared import ROOT, process

PLUGINS = sorted(str(file) for file in (ROOT / "docs" / "examples").rglob("*.py"))


@pytest.mark.parametrize("tool", [["mypy", "--strict"], ["ruff", "check"], ["ruff", "format", "--check"]], ids=" ".join)
def test_examples_are_typed_and_in_style(tool: list[str]) -> None:
    answer = process([sys.executable, "-m", *tool, *PLUGINS], ROOT)
    assert answer.code == 0, answer.out + answer.err
