"""The browser, and the sheets it looks at."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

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


SHIPPED: dict[str, tuple[str, list[str]]] = {
    "press": ("press_linkage", []),
    "reducer": (
        "rv_wear",
        [
            "reliability.draws=2000", "reliability.points=4", "new_machines.draws=200", "surrogate.design=30",
            "surrogate.held_out=10", "surrogate.restarts=0", "surrogate.compare=100", "least_costs.goals=[]",
            "optimise.population=12", "optimise.generations=4", "optimise.draws=256", "optimise.verify=1000",
        ],
    ),
    "gearing": ("rv_gearing", ["reliability.draws=2000", "load.points=9", "face_width.points=9"]),
    "screw": ("roller_screw_shift", ["shift.points=2001", "optimise.population=16", "optimise.generations=4"]),
    "flank": ("harmonic_fractal", ["reliability.draws=2000"]),
}  # fmt: skip
"""Sheets of shipped examples, with budgets that leave all figures and tables there and take a few seconds."""
MEASURED = {"flank": DATA.parents[1] / "docs" / "examples" / "harmonic_matrix_y" / "inputs.toml"}
"""Inputs files to look at instead of the plugin's example: this one has a measured surface."""


@pytest.fixture(scope="session", params=["hostile", "hostile-full", *SHIPPED])
def sheet(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sheet on disk: one whose every text is hostile, at two levels of detail, and those of what is shipped."""
    kernel = Kernel.installed()
    kernel.add_file(DATA / "hostile_pin.py")
    if request.param in SHIPPED:
        plugin, options = SHIPPED[request.param]
        offer = kernel.offer(plugin)
        inputs = MEASURED.get(request.param) or offer.model.example
        assert inputs is not None
        setup = read_setup(inputs, offer, overrides=[f"studies.{option}" for option in options])
    else:
        offer = kernel.offer("hostile_pin")
        setup = read_setup(DATA / "hostile_pin.toml", offer)
    setup = replace(setup, detail="full") if request.param == "hostile-full" else setup
    calculation = calculate(setup)
    rows = compare_published(offer, known=calculation)
    text = html_of(make_sheet(calculation, provenance=provenance_of(setup, date="2026-11-21"), verified=rows))
    file = tmp_path_factory.mktemp("Größe ü") / f"{request.param} sheet.html"
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
