"""How soon does the workbench show its first page after the command, and a folder with a hundred runs?

Run it: ``python -m pytest tests/benchmarks/bench_workbench_pages.py -s``. The clock begins before the process of
``calc serve``; pages are fetched as a browser fetches them. The runs are one of the press, each with other inputs.
Of the rounds the quickest counts, divided by how many times longer than its processor time a loop takes meanwhile.
"""

import http.cookiejar
import json
import shutil
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from truing.api.model import LoadedModel
from truing.kernel import offer_of
from workbench_browser import Workbench, serving

RUNS, ROUNDS = 100, 5
FIRST_PAGE = 1.5
"""Seconds from the command to the first page, on a machine that does nothing else."""
LISTED = 0.2
"""Seconds for the page with all runs."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("many")
    LoadedModel(offer_of("press_linkage", lambda _: None)).run(output=made / "run", progress=False)
    document = json.loads((made / "run" / "results.json").read_text(encoding="utf-8"))
    info = json.loads((made / "run" / "run.json").read_text(encoding="utf-8"))
    for number in range(RUNS):
        target = made / "runs" / f"press-{number}"
        shutil.copytree(made / "run", target)
        document["inputs"]["crank_radius"]["value"] = 0.3 + number / 1000
        day = f"2026-11-{1 + number // 24:02d}T{number % 24:02d}:00:00+0000"
        (target / "results.json").write_text(json.dumps(document), encoding="utf-8")
        (target / "run.json").write_text(json.dumps({**info, "date": day}), encoding="utf-8")
    shutil.rmtree(made / "run")
    return made


def busy() -> float:
    """Return how many times longer than its processor time a loop takes: 1 on a machine that does nothing else."""
    started, used = time.perf_counter(), time.process_time()
    sum(range(20_000_000))
    return (time.perf_counter() - started) / (time.process_time() - used)


def let_in(served: Workbench) -> Callable[[str], str]:
    """Return what fetches a page of a workbench."""
    opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar()))
    opener.open(served.opening).read()
    return lambda path: opener.open(served.address + path).read().decode()


def test_first_page(folder: Path) -> None:
    taken, load = [], []
    for _ in range(ROUNDS):
        load.append(busy())
        started = time.perf_counter()
        with serving(folder) as served:
            assert "press_linkage" in let_in(served)("")
            taken.append(time.perf_counter() - started)
    said = f"{min(taken):.2f} to {max(taken):.2f} s after the command, on a machine {min(load):.1f} times as busy"
    print(f"\nfirst page, {RUNS} runs in the folder: {said}")
    assert min(taken) / min(load) < FIRST_PAGE


@pytest.fixture(scope="module")
def fetch(folder: Path) -> Iterator[Callable[[str], str]]:
    with serving(folder) as served:
        yield let_in(served)


def test_hundred_runs(fetch: Callable[[str], str], folder: Path) -> None:
    fetch("runs")  # the worker has imported what it needs
    again, changed, load = [], [], []
    for number in range(ROUNDS):
        load.append(busy())
        again.append(timed(fetch))
        for file in folder.glob("runs/*/run.json"):  # as if every run were another: nothing is remembered
            file.write_text(file.read_text(encoding="utf-8") + " " * (number + 1), encoding="utf-8")
        changed.append(timed(fetch))
    said = f"{1000 * min(again):.0f} ms, {1000 * min(changed):.0f} ms where every one is read anew"
    print(f"\n{RUNS} runs listed in {said}, on a machine {min(load):.1f} times as busy")
    assert max(min(again), min(changed)) / min(load) < LISTED


def timed(fetch: Callable[[str], str]) -> float:
    """Return the seconds that the list of runs takes."""
    started = time.perf_counter()
    assert fetch("runs").count("<tr data-name=") == RUNS
    return time.perf_counter() - started
