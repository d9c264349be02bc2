"""The site of the manual in a browser that has no network: opened from disk, on a wide screen and on a phone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from test_sheet import BEYOND, CONTRASTS

KINDS = {
    "front page": "index.html",
    "tutorial": "tutorial/first_calculation.html",
    "how-to": "how-to/many_machines.html",
    "reference": "reference/declaring.html",
    "format": "reference/files/diagnosis.html",
    "verb": "reference/verbs/run.html",
    "hook": "reference/hooks/truing_models.html",
    "models": "reference/models/index.html",
    "model": "reference/models/press_linkage.html",
    "largest model": "reference/models/rv_gearing.html",
    "effects": "reference/effects.html",
    "theory": "explanation/gear_geometry.html",
    "example": "examples/press_off_by_40_um/index.html",
    "gallery": "gallery/index.html",
    "project": "project/overview.html",
}


UNFOLD = "for (const part of document.querySelectorAll('details')) part.open = true"
SCREENS = 14
"""So many screens of 900 px a page of a model has at the most on a wide screen, what is long folded."""


@pytest.fixture(scope="module")
def window(browser: Any, site: Path) -> Iterator[Any]:
    """A page without network; what it asks for and complains of is written down."""
    context = browser.new_context(offline=True)
    opened = context.new_page()
    opened.requested, opened.said = [], []
    opened.on("request", lambda request: opened.requested.append(request.url))
    opened.on("console", lambda message: opened.said.append(f"{message.type}: {message.text}"))
    opened.on("pageerror", lambda error: opened.said.append(f"error: {error}"))
    opened.on("requestfailed", lambda request: opened.said.append(f"failed: {request.url}"))
    yield opened
    context.close()


def visit(window: Any, file: Path, width: int) -> None:
    window.requested.clear()
    window.said.clear()
    window.set_viewport_size({"width": width, "height": 900})
    window.goto(file.as_uri())


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_asks_for_nothing_outside_and_fits_a_phone(window: Any, site: Path, kind: str) -> None:
    visit(window, site / KINDS[kind], 390)
    assert window.said == []
    assert [url for url in window.requested if not url.startswith((site.as_uri() + "/", "data:"))] == []
    assert window.evaluate("document.documentElement.scrollWidth") <= 390
    loose = "[...document.querySelectorAll('article table')].filter(one => !one.closest('.scroll')).length"
    assert window.evaluate(loose) == 0
    window.set_viewport_size({"width": 1100, "height": 900})
    assert window.evaluate("document.documentElement.scrollWidth") <= 1100
    outside = window.evaluate(
        BEYOND.replace("!node.closest('svg')", "!node.closest('svg, .scroll, .formula, pre')"), 1100
    )
    assert outside == []


@pytest.mark.parametrize("width", [1280, 1200, 390])
@pytest.mark.parametrize("kind", ["models", "model", "largest model", "effects"])
def test_what_a_row_says_is_not_squeezed(window: Any, site: Path, kind: str, width: int) -> None:
    """The last cell of a row has the words: a column of its own, and on a phone the whole width."""
    visit(window, site / KINDS[kind], width)
    window.evaluate(UNFOLD)
    last = "[...document.querySelectorAll('table.fields:not(.formulas) tbody td:last-child')]"
    widths = window.evaluate(f"{last}.filter(cell => cell.innerText).map(cell => cell.getBoundingClientRect().width)")
    assert len(widths) > 5
    assert min(widths) > 300
    assert window.evaluate("document.documentElement.scrollWidth") <= width
    if width > 1000:  # a phone scrolls a formula that is wider than itself
        wide = "[...document.querySelectorAll('.scroll')].filter(one => one.scrollWidth > one.clientWidth).length"
        assert window.evaluate(wide) == 0


def test_no_page_of_a_model_is_longer_than_a_dozen_screens(window: Any, site: Path) -> None:
    pages = sorted((site / "reference" / "models").glob("*.html"))
    assert len(pages) > 5
    for page in pages:
        visit(window, page, 1200)
        assert window.evaluate("document.documentElement.scrollHeight") < SCREENS * 900, page.name


def test_what_is_folded_opens_for_a_link_and_in_print(window: Any, site: Path) -> None:
    page = site / KINDS["largest model"]
    visit(window, page, 1200)
    assert not window.is_visible("#result-dynamic_factor")
    window.emulate_media(media="print")
    assert window.locator("#result-dynamic_factor").bounding_box()["height"] > 10
    window.emulate_media(media="screen")
    window.goto("about:blank")
    window.goto(f"{page.as_uri()}#result-dynamic_factor")
    window.wait_for_selector("#result-dynamic_factor", state="visible")
    assert 0 < window.locator("#result-dynamic_factor").bounding_box()["y"] < 900
    assert not window.is_visible("#result-rack_factor")
    window.click(".contents a[href='#stiffness-of-the-mesh']")
    window.wait_for_selector("#result-rack_factor", state="visible")
    window.click(".unfold")
    assert window.evaluate("[...document.querySelectorAll('article details')].filter(part => !part.open).length") == 0


@pytest.mark.parametrize("kind", ["theory", "model"])
def test_formulas_are_drawn(window: Any, site: Path, kind: str) -> None:
    visit(window, site / KINDS[kind], 1100)
    window.evaluate(UNFOLD)
    sizes = window.evaluate("""() => [...document.querySelectorAll('math')].map(node => {
        const box = node.getBoundingClientRect();
        return [box.width, box.height, Boolean(node.querySelector('mfrac')), node.textContent];
    })""")
    assert len(sizes) > 40
    assert [size for size in sizes if size[0] < 3 or size[1] < 6] == []
    assert [size for size in sizes if size[2] and size[1] < 16] == []
    assert "\\" not in window.evaluate("document.querySelector('article').innerText")


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("kind", ["tutorial", "model"])
def test_every_text_stands_out_from_its_ground(window: Any, site: Path, kind: str, theme: str) -> None:
    visit(window, site / KINDS[kind], 1100)
    window.evaluate(f"document.documentElement.dataset.theme = '{theme}'")
    seen = window.evaluate(CONTRASTS)
    assert len(seen) > 50
    assert [pair for pair in seen if pair[0] < 4.5] == []


def test_the_button_turns_the_page_dark_and_light(window: Any, site: Path) -> None:
    visit(window, site / "index.html", 1100)
    ground = "getComputedStyle(document.body).backgroundColor"
    before = window.evaluate(ground)
    window.click("button.theme")
    dark = window.evaluate(ground)
    window.click("button.theme")
    assert window.evaluate(ground) == before != dark


def test_search_works_from_disk(window: Any, site: Path) -> None:
    visit(window, site / KINDS["verb"], 1100)
    window.fill("#search", "stroke joint_clearance")
    window.wait_for_selector(".found a")
    shown = window.locator(".found a").all_inner_texts()
    assert all("clearance" in text.lower() or "stroke" in text.lower() for text in shown)
    window.fill("#search", "exit codes")
    window.wait_for_function("document.querySelector('.found a')?.innerText.includes('Errors')")
    window.press("#search", "Enter")
    window.wait_for_url("**/reference/errors.html*")
    assert window.said == []
    window.fill("#search", "zzzz no such word")
    window.wait_for_selector(".found .none")


def test_the_menu_of_a_phone_opens(window: Any, site: Path) -> None:
    visit(window, site / KINDS["how-to"], 390)
    assert not window.is_visible("#sidebar")
    window.click("button.menu")
    window.click("#sidebar a[aria-current]")
    assert window.url.endswith("many_machines.html")


def test_a_page_prints_without_what_is_for_the_screen(window: Any, site: Path) -> None:
    visit(window, site / KINDS["model"], 700)
    window.emulate_media(media="print")
    try:
        for part in (".bar", "#sidebar", "main > footer"):
            assert not window.is_visible(part)
        assert window.evaluate("document.querySelector('article').getBoundingClientRect().width") > 600
    finally:
        window.emulate_media(media="screen")
