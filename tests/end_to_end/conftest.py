"""What tests of the command line share: refusals that leave nothing behind, rows of results, one diagnosis."""

from __future__ import annotations

import csv
import io
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from measured import Diagnosed, calc_here, read_document
from refusals import listing, sentences
from shown_in_docs import EXAMPLES

import truing
from shared import Calc

PRESS = EXAMPLES / "press_off_by_40_um"


@pytest.fixture(scope="session")
def play(tmp_path_factory: pytest.TempPathFactory) -> Diagnosed:
    """The press with play, diagnosed from the command line as its README says."""
    desk = tmp_path_factory.mktemp("play") / "desk"
    shutil.copytree(PRESS, desk)
    answer = calc_here(desk, "diagnose", "press_linkage", "--inputs", "inputs.toml", "--data", "measured.csv")
    assert (answer.code, answer.err) == (0, "")
    return Diagnosed(answer, read_document(desk / "runs" / "measured"), desk / "runs" / "measured")


@pytest.fixture(scope="session")
def diagnosis() -> truing.Diagnosis:
    """The same, diagnosed by a call."""
    press = truing.load("press_linkage")
    return press.diagnose(truing.read(PRESS / "measured.csv", press), PRESS / "inputs.toml")


@pytest.fixture
def refused(calc: Calc, tmp_path: Path) -> Callable[..., list[str]]:
    """Run ``calc``, which must end with exit code 2, leave the folder as it was and print no result."""

    def run(*arguments: str | Path) -> list[str]:
        before = listing(tmp_path)
        answer = calc(*arguments)
        assert listing(tmp_path) == before
        return sentences(answer)

    return run


@pytest.fixture
def refused_inputs(refused: Callable[..., list[str]], tmp_path: Path) -> Callable[..., list[str]]:
    """Run a plugin, which must refuse these lines under [inputs]; the first of them is line 3 of ``inputs.toml``."""

    def run(plugin: str, *lines: str, studies: str = "run = []") -> list[str]:
        text = "\n".join([f'plugin = "{plugin}"', "[inputs]", *lines, "[studies]", studies, ""])
        (tmp_path / "inputs.toml").write_text(text, encoding="utf-8")
        return refused("run", plugin, "--inputs", "inputs.toml")

    return run


@pytest.fixture
def tabled(calc: Calc, tmp_path: Path) -> Callable[..., list[dict[str, float]]]:
    """Print results of a plugin row by row for a CSV, with settings on the command line; far quicker than a sheet.

    A cell that holds no number is left out.
    """

    def run(plugin: str, rows: str, *settings: str) -> list[dict[str, float]]:
        (tmp_path / "inputs.toml").write_text(f'plugin = "{plugin}"\n', encoding="utf-8")
        (tmp_path / "rows.csv").write_text(rows, encoding="utf-8")
        words = [word for setting in settings for word in ("--set", setting)]
        answer = calc("table", plugin, "--inputs", "inputs.toml", "--rows", "rows.csv", *words)
        assert answer.code == 0, answer.err
        head, *found = csv.reader(io.StringIO(answer.out))
        names = [name.split(" [")[0] for name in head]
        return [
            {name: float(cell) for name, cell in zip(names, row, strict=True) if cell and cell[0] in "-.0123456789"}
            for row in found
        ]

    return run
