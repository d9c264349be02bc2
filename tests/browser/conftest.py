"""The sheets that the browser looks at."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from built_site import site  # noqa: F401
from shared import missed
from truing.calculation import calculate
from truing.inputs_file import read_setup
from truing.kernel import Kernel
from truing.published import compare_published
from truing.report.html_printer import html_of
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of
from truing.setup import SheetOptions

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, ViewportSize

DATA = Path(__file__).parents[1] / "data"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark every test of this folder."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.browser)


FONTS = {
    "DejaVu": {
        "text": "DejaVu Sans", "mono": "DejaVu Sans Mono", "math": "DejaVu Sans Mono", "signs": "DejaVu Serif",
        "italic": "DejaVu Serif",
    },
    "Liberation": {
        "text": "Liberation Sans", "mono": "Liberation Mono", "math": "Liberation Mono", "signs": "Liberation Serif",
        "italic": "Liberation Serif",
    },
    "wide": dict.fromkeys(("text", "mono", "math", "signs", "italic"), "DejaVu Sans Mono"),
}  # fmt: skip
"""Fonts in which a sheet is looked at, so that those of the machine do not decide: all that many Linux machines have,
those with the widths of Arial and Times, and a wide one."""

IS_THERE = """(family) => {
    const pen = document.createElement('canvas').getContext('2d');
    const width = fonts => { pen.font = `40px ${fonts}`; return pen.measureText('Wm ili 0').width; };
    return ['monospace', 'serif', 'sans-serif'].some(other => width(`"${family}", ${other}`) !== width(other));
}"""


@pytest.fixture(scope="session")
def fonts(browser: Browser) -> dict[str, str]:
    """The sets of fonts as style sheets; where one is missing the tests are skipped, but never where CI=true."""
    page = browser.new_page()
    families = {family for families in FONTS.values() for family in families.values()}
    missing = sorted(family for family in families if not page.evaluate(IS_THERE, family))
    page.close()
    if missing:
        missed(f"the fonts {', '.join(missing)} are not on this machine (Debian: fonts-dejavu-core, fonts-liberation)")
    rules = {name: [f'--{use}: "{family}";' for use, family in families.items()] for name, families in FONTS.items()}
    return {"the machine's": ":root { }", **{name: f":root {{ {' '.join(lines)} }}" for name, lines in rules.items()}}


SCREEN: ViewportSize = {"width": 1200, "height": 900}
SHIPPED = ("press", "reducer", "flank")
"""Sheets of the gallery, with the budgets of its quick build: between them they have every kind of table and figure."""


@pytest.fixture(scope="session", params=["hostile", *SHIPPED])
def sheet(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sheet on disk: one whose every text is hostile, in full detail, and those of what is shipped."""
    file = tmp_path_factory.mktemp("Größe ü") / f"{request.param} sheet.html"
    if request.param in SHIPPED:
        shutil.copy(request.getfixturevalue("site") / "gallery" / request.param / "sheet.html", file)
        return file
    kernel = Kernel()
    kernel.add_file(DATA / "hostile_pin.py")
    offer = kernel.offer("hostile_pin")
    setup = replace(read_setup(DATA / "hostile_pin.toml", offer), sheet=SheetOptions(detail="full"))
    calculation = calculate(setup)
    rows = compare_published(offer, known=calculation)
    text = html_of(make_sheet(calculation, provenance=provenance_of(setup, date="2026-11-21"), verified=rows))
    file.write_text(text, encoding="utf-8")
    return file


def opened(browser: Browser, sheet: Path) -> Page:
    """Return the sheet in a context of its own; what it asks for and complains of is written down."""
    page: Any = browser.new_context().new_page()
    page.requested, page.failed, page.said = [], [], []
    page.on("request", lambda request: page.requested.append(request.url))
    page.on("requestfailed", lambda request: page.failed.append((request.url, request.failure)))
    page.on("console", lambda message: page.said.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: page.said.append(f"error: {error}"))
    page.set_viewport_size(SCREEN)
    page.goto(sheet.as_uri())
    return page  # type: ignore[no-any-return]


@pytest.fixture(scope="session")
def shown() -> dict[Path, Page]:
    """The page that is open, by its sheet."""
    return {}


@pytest.fixture
def page(browser: Browser, shown: dict[Path, Page], sheet: Path) -> Page:
    """The sheet on a wide screen, one page for all tests that leave it as it is."""
    if sheet not in shown:
        for other in shown.values():
            other.context.close()
        shown.clear()
        shown[sheet] = opened(browser, sheet)
    shown[sheet].set_viewport_size(SCREEN)
    shown[sheet].emulate_media(media="screen", color_scheme="light")
    return shown[sheet]


@pytest.fixture
def printed(page: Page, sheet: Path) -> Path:
    """The sheet as the browser that shows it prints it, once for all tests."""
    pdf = sheet.with_suffix(".pdf")
    if not pdf.exists():
        page.emulate_media(media="print")
        page.pdf(path=pdf, format="A4", prefer_css_page_size=True)
    return pdf


@pytest.fixture(scope="session")
def known() -> dict[str, str]:
    """The letters that were looked at already, on whatever sheet, by their font."""
    return {}


@pytest.fixture
def own_page(browser: Browser, sheet: Path) -> Iterator[Page]:
    """The sheet on a wide screen, for a test that changes the page."""
    made = opened(browser, sheet)
    yield made
    made.context.close()
