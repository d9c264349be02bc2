"""What tests of the command line share: refusals that leave nothing behind, rows of results, one diagnosis."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path

import pytest
from measured import Diagnosed, diagnose_heated, read_document
from refusals import listing, sentences
from shown_in_docs import EXAMPLES, ROOT, Desk, check_page, desk_in

import truing
from shared import Answer, Calc, made_once
from truing.executors import WorkerPool, open_executor

PRESS = EXAMPLES / "press_off_by_40_um"


@pytest.fixture(scope="session")
def page_done(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], Path]:
    """Do what a page of the manual shows, once for all tests; return the folder with ``faults.json`` and ``work``."""

    def done(page: Path) -> Path:
        def do(folder: Path) -> None:
            faults = check_page(page, desk_in(folder))
            (folder / "faults.json").write_text(json.dumps(faults), encoding="utf-8")

        return made_once(tmp_path_factory, "-".join(page.relative_to(ROOT).parts), do)

    return done


@pytest.fixture(scope="session")
def shown_runs(page_done: Callable[[Path], Path]) -> Callable[[str], Path]:
    """Give the ``runs`` that the page of an example leaves in its folder; to be read, not changed."""
    return lambda example: page_done(EXAMPLES / example / "README.md") / "work" / example / "runs"


@pytest.fixture(scope="session")
def play(page_done: Callable[[Path], Path]) -> Path:
    """The press with play, diagnosed from the command line as the tutorial says."""
    page = ROOT / "docs" / "tutorial" / "my_press_is_off_by_40_um.md"
    return page_done(page) / "work" / PRESS.name / "runs" / "measured"


@pytest.fixture(scope="session")
def heated(tmp_path_factory: pytest.TempPathFactory) -> Diagnosed:
    """A press whose links are hotter than the model knows, diagnosed; beside ``runs`` lie inputs and records."""
    desk = made_once(tmp_path_factory, "heated", diagnose_heated)
    answer = Answer(*json.loads((desk / "answer.json").read_text(encoding="utf-8")))
    assert (answer.code, answer.err) == (0, "")
    return Diagnosed(answer, read_document(desk / "runs" / "measured"), desk / "runs" / "measured")


@contextmanager
def sharing(processes: WorkerPool) -> Iterator[None]:
    """Let a run with two workers have these; that a run starts and ends its own is tested elsewhere."""

    def opened(place: str) -> AbstractContextManager[WorkerPool]:
        return nullcontext(processes) if place == "processes:2" else open_executor(place)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("truing.api.run.open_executor", opened)
        yield


@pytest.fixture
def runs_share_processes(two_processes: WorkerPool) -> Iterator[None]:
    """Let runs with two workers have those of all tests."""
    with sharing(two_processes):
        yield


@pytest.fixture(scope="session")
def listing_done(tmp_path_factory: pytest.TempPathFactory, two_processes: WorkerPool) -> Desk:
    """The desk of the page by which the API was designed, with what its listing has made."""
    desk = desk_in(tmp_path_factory.mktemp("listing"))
    with sharing(two_processes):
        assert check_page(ROOT / "docs" / "reference" / "python.md", desk) == []
    return desk


@pytest.fixture(scope="session")
def diagnosis(listing_done: Desk) -> truing.Diagnosis:
    """The spring of this page that softens as it gets warm, diagnosed by a call."""
    found = listing_done.namespace["found"]
    assert isinstance(found, truing.Diagnosis)
    return found


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
