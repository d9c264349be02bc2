"""The browser, and the sheets it looks at."""

from __future__ import annotations

import os
import shutil
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from built_site import site  # noqa: F401
from shared import ROOT
from truing.calculation import calculate
from truing.inputs_file import read_setup
from truing.kernel import Kernel
from truing.published import compare_published
from truing.report.pdf import find_browser, sandbox_arguments
from truing.report.render import html_of
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

DATA = Path(__file__).parents[1] / "data"
QUIET = [
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark every test of this folder."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.browser)


@pytest.fixture(scope="session")
def chromium() -> Path:
    """The browser of this machine; without one the tests are skipped, but never where CI=true says it must be there."""
    found = find_browser()
    if found is None:
        words = "no Chromium, Chrome or Edge on this machine (CHROME_PATH names one): the sheet was not looked at"
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(words)
        pytest.skip(words)
    return found


@pytest.fixture(scope="session")
def browser(chromium: Path) -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        running = play.chromium.launch(executable_path=chromium, args=[*QUIET, *sandbox_arguments()])
        yield running
        running.close()


GALLERY = tomllib.loads((ROOT / "docs" / "gallery" / "sheets.toml").read_text(encoding="utf-8"))
SHIPPED = [name for name, item in GALLERY.items() if "data" not in item]
"""Sheets of shipped examples: those of the gallery, with the budgets of its quick build."""


@pytest.fixture(scope="session", params=["hostile", "hostile-full", *SHIPPED])
def sheet(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sheet on disk: one whose every text is hostile, at two levels of detail, and those of what is shipped."""
    file = tmp_path_factory.mktemp("Größe ü") / f"{request.param} sheet.html"
    if request.param in SHIPPED:
        shutil.copy(request.getfixturevalue("site") / "gallery" / request.param / "sheet.html", file)
        return file
    kernel = Kernel()
    kernel.add_file(DATA / "hostile_pin.py")
    offer = kernel.offer("hostile_pin")
    setup = read_setup(DATA / "hostile_pin.toml", offer)
    setup = replace(setup, detail="full") if request.param == "hostile-full" else setup
    calculation = calculate(setup)
    rows = compare_published(offer, known=calculation)
    text = html_of(make_sheet(calculation, provenance=provenance_of(setup, date="2026-11-21"), verified=rows))
    file.write_text(text, encoding="utf-8")
    return file


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    made = browser.new_context()
    yield made
    made.close()


@pytest.fixture
def page(context: BrowserContext, sheet: Path) -> Page:
    """The sheet, opened on a wide screen; what it asks for and complains of is written down."""
    opened: Any = context.new_page()
    opened.requested, opened.failed, opened.said = [], [], []
    opened.on("request", lambda request: opened.requested.append(request.url))
    opened.on("requestfailed", lambda request: opened.failed.append((request.url, request.failure)))
    opened.on("console", lambda message: opened.said.append(f"{message.type}: {message.text}"))
    opened.on("pageerror", lambda error: opened.said.append(f"error: {error}"))
    opened.set_viewport_size({"width": 1200, "height": 900})
    opened.goto(sheet.as_uri())
    return opened  # type: ignore[no-any-return]
