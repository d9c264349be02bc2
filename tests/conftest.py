"""What tests share beside the fixtures of ``truing.testing``: the size of torture tests, the strangers' plugins."""

import gc
import os
import sys
import zipfile
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest
from xdist.scheduler import WorkStealingScheduling

from one_browser import browser, chromium, firefox, player  # noqa: F401
from shared import GUESTS, ROOT, TESTS, build_wheels, copied_guest, made_once
from truing.cli import MOST_NEW
from truing.executors import WorkerPool, open_executor
from workbench_browser import workbench  # noqa: F401

collect_ignore = ["third_party", "data"]
sys.path.append(str(TESTS / "data"))
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # the commands that tests run compile the kernel once, not each
sys.dont_write_bytecode = False  # and pytest rewrites the assertions of a test file once, not in every process
gc.set_threshold(MOST_NEW)  # as the program does; at 700 a worker spends a tenth of its time looking for rings
os.environ.setdefault("MYPY_CACHE_DIR", str(ROOT / ".mypy_cache"))  # one check of types reads what another has
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # the workers of the suite share the cores; a test of threads sets its own


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the size of torture tests and of long pages: ``python -m pytest --torture=full``."""
    parser.addoption(
        "--torture", choices=["modest", "full"], default="modest", help="size of the tests that can be large"
    )


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> WorkStealingScheduling:
    """Give every worker tests that stand one after another, so that what these share is made once."""
    return WorkStealingScheduling(config, log)


FIRST = ("torture", "test_tutorial")
"""Tests that fork, while this process is small: the larger it is, the longer a fork takes; then the longest ones, so
that no worker is left alone with them."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put first what is to come first; mark what needs a browser."""
    for item in items:
        if {"browser", "firefox"} & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.browser)
    order = {name: place for place, name in enumerate(FIRST)}
    items.sort(key=lambda item: min(order.get(name, len(FIRST)) for name in (item.path.stem, *item.path.parts)))


def pytest_collection_finish() -> None:
    """Take what ten thousand collected tests hold out of every later collection of garbage."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def full_torture(request: pytest.FixtureRequest) -> bool:
    """Return whether the torture tests run at full size; the suite runs them at a modest one."""
    return bool(request.config.getoption("--torture") == "full")


@pytest.fixture(scope="session")
def two_processes() -> Iterator[WorkerPool]:
    """Two worker processes, for all tests that end none of them: starting them takes seconds."""
    with open_executor("processes:2") as executor:
        yield executor


@pytest.fixture
def kit_shares_processes(two_processes: WorkerPool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the kit compute in these processes what it wants computed elsewhere; strangers' own tests start theirs."""
    monkeypatch.setattr("truing.testing.running.open_executor", lambda _: nullcontext(two_processes))


@pytest.fixture(scope="session")
def guest_wheels(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Return the wheels of the strangers' plugins, as they build them."""

    def built(folder: Path) -> None:
        build_wheels(folder, [copied_guest(name, folder / "sources") for name in GUESTS])

    return sorted(made_once(tmp_path_factory, "guests", built).glob("*.whl"))


@pytest.fixture(scope="session")
def strangers(guest_wheels: list[Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the strangers' plugins, unpacked as pip installs them, beside this environment."""
    folder = tmp_path_factory.mktemp("strangers")
    for wheel in guest_wheels:
        zipfile.ZipFile(wheel).extractall(folder)
    return folder
