"""The sheet as a browser shows it: on a screen, on a phone, in the dark, on paper."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

A4_TEXT = int((210 - 36) * 96 / 25.4)
"""The width that text has between the margins (20 mm and 16 mm) of the narrower paper, in pixels."""

BEYOND = """(limit) => [...document.querySelectorAll('body *')]
    .filter(node => !node.closest('svg') && node.getClientRects().length)
    .filter(node => node.getBoundingClientRect().right > limit + 1)
    .map(node => node.outerHTML.slice(0, 160))"""

BOXES = """(known) => {
    const pen = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const drawn = (font, text) => {
        pen.clearRect(0, 0, 48, 48);
        pen.font = font;
        pen.fillText(text, 8, 32);
        return new Uint32Array(pen.getImageData(0, 0, 48, 48).data.buffer);
    };
    const alike = (one, other) => one.every((pixel, place) => pixel === other[place]);
    const used = {};
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const style = getComputedStyle(walker.currentNode.parentElement);
        const font = `${style.fontStyle} ${style.fontWeight} 24px ${style.fontFamily}`;
        used[font] ??= new Set();
        for (const letter of walker.currentNode.textContent) used[font].add(letter);
    }
    return Object.entries(used).map(([font, letters]) => {
        const box = drawn(font, String.fromCodePoint(0xF0000));
        const seen = [...letters].filter(letter => /[^\\p{C}\\p{Z}\\p{M}\\p{scx=Han}]/u.test(letter));
        const fresh = seen.filter(letter => !(known[font] ?? '').includes(letter));
        return [font, fresh.join(''), fresh.filter(letter => alike(drawn(font, letter), box)).join('')];
    });
}"""

LEVEL = """() => [...document.querySelectorAll('msub > :first-child, msubsup > :first-child')]
    .filter(base => base.nodeName === 'mi' && /^[A-Zacemnrsuvwxz]$/.test(base.textContent))
    .filter(base => !(base.nextElementSibling.getBoundingClientRect().bottom > base.getBoundingClientRect().bottom + 1))
    .map(base => base.parentElement.textContent)"""

CONTRASTS = """() => {
    const parts = colour => (colour.match(/[\\d.]+/g) || []).map(Number);
    const light = ([r, g, b]) => [r, g, b].map(v => v / 255)
        .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
    const grounds = new Map();
    const behind = node => {
        if (!node) return [255, 255, 255];
        if (!grounds.has(node)) {
            const colour = parts(getComputedStyle(node).backgroundColor);
            grounds.set(node, colour.length === 3 || colour[3] > 0.99 ? colour : behind(node.parentElement));
        }
        return grounds.get(node);
    };
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const node = walker.currentNode.parentElement;
        if (!walker.currentNode.textContent.trim() || node.closest('svg, .hidden')) continue;
        const pair = [light(parts(getComputedStyle(node).color)), light(behind(node))].sort((a, b) => b - a);
        found.push([(pair[0] + 0.05) / (pair[1] + 0.05), walker.currentNode.textContent.trim().slice(0, 60)]);
    }
    return found;
}"""


@contextmanager
def styled(page: Any, style: str) -> Iterator[None]:
    """Add a style sheet to a page and take it away again."""
    tag = page.add_style_tag(content=style)
    yield
    tag.evaluate("node => node.remove()")


def test_the_sheet_asks_for_nothing_and_says_nothing(page: Any, sheet: Path) -> None:
    page.wait_for_timeout(100)
    assert page.requested == [sheet.as_uri()]
    assert page.said == []


def test_nothing_on_the_sheet_can_run(page: Any) -> None:
    assert page.evaluate("document.scripts.length") == 0
    handlers = (
        "[...document.querySelectorAll('*')].filter(n => [...n.attributes].some(a => /^on/i.test(a.name))).length"
    )
    assert page.evaluate(handlers) == 0
    assert page.evaluate("document.querySelectorAll('iframe, object, embed, form, link, base').length") == 0


@pytest.mark.parametrize("sheet", ["hostile"], indirect=True)
def test_the_policy_stops_what_a_later_hand_adds(own_page: Any) -> None:
    """A script or picture put into the file by somebody else is refused by the page itself."""
    own_page.evaluate("""() => {
        const script = document.createElement('script');
        script.textContent = 'document.title = "run"';
        document.body.append(script);
        const picture = document.createElement('img');
        picture.src = 'https://evil.example/x.png';
        document.body.append(picture);
    }""")
    own_page.wait_for_timeout(200)
    assert own_page.title() != "run"
    assert own_page.failed == [("https://evil.example/x.png", "csp")]
    assert len([text for text in own_page.said if "Content Security Policy" in text]) >= 2


def test_fractions_are_taller_than_a_line(page: Any) -> None:
    """A fraction flattened to a/b would be one line high."""
    heights = page.evaluate("""() => [...document.querySelectorAll('mfrac')].map(node => [
        node.getBoundingClientRect().height,
        parseFloat(getComputedStyle(node).fontSize) / (node.parentElement.closest('mfrac, msup, msub, msqrt') ? 2 : 1),
    ])""")
    assert len(heights) >= 5
    assert [pair for pair in heights if not pair[0] > 1.5 * pair[1]] == []


def test_every_formula_is_drawn(page: Any) -> None:
    sizes = page.evaluate("""() => [...document.querySelectorAll('math')].map(node => {
        const box = node.getBoundingClientRect();
        return [node.getAttribute('display'), box.width, box.height];
    })""")
    assert any(display == "block" for display, _, _ in sizes)
    assert [size for size in sizes if size[1] < 4 or size[2] < 6] == []


@pytest.mark.parametrize("width", [390, 768, 1200])
def test_the_page_is_no_wider_than_the_screen(page: Any, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_what_is_wide_scrolls_in_its_own_box_on_a_phone(page: Any) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    boxes = page.evaluate("""() => [...document.querySelectorAll('.scroll, .formula, .drawing')].map(node => [
        node.scrollWidth > node.clientWidth + 1, getComputedStyle(node).overflowX,
        node.getBoundingClientRect().right])""")
    assert any(is_wide for is_wide, _, _ in boxes)
    assert [box for box in boxes if box[0] and box[1] != "auto"] == []
    assert max(right for _, _, right in boxes) <= 390


def test_nothing_is_cut_off_on_paper(page: Any, fonts: dict[str, str]) -> None:
    """In print nothing scrolls, so every element must end within the text width, also in the widest font."""
    page.emulate_media(media="print")
    page.set_viewport_size({"width": A4_TEXT, "height": 1000})
    beyond = {}
    for name in ("the machine's", "wide"):
        with styled(page, fonts[name]):
            beyond[name] = page.evaluate(BEYOND, A4_TEXT)
    assert {key: nodes for key, nodes in beyond.items() if nodes} == {}


def test_every_character_is_drawn(page: Any, fonts: dict[str, str], known: dict[str, str]) -> None:
    """No letter is an empty box, and every index of a formula stands below the line.

    The italic letters of mathematics, which few fonts have, are not asked for. Titles in Chinese need their own font.
    """
    transformed = (
        "[...document.querySelectorAll('mi')].filter(n => getComputedStyle(n).textTransform !== 'none').length"
    )
    assert page.evaluate(transformed) == 0
    boxes = {}
    for name, style in fonts.items():
        with styled(page, style):
            assert page.evaluate(LEVEL) == [], name
            for font, letters, missing in page.evaluate(BOXES, known):
                boxes[font] = missing
                known[font] = known.get(font, "") + letters
    assert {font: missing for font, missing in boxes.items() if missing} == {}


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_from_its_ground(page: Any, scheme: str) -> None:
    """WCAG 2.2, success criterion 1.4.3: at least 4.5 to 1."""
    page.emulate_media(color_scheme=scheme)
    contrasts = page.evaluate(CONTRASTS)
    assert len(contrasts) > 100
    assert [pair for pair in contrasts if pair[0] < 4.5] == []


def test_the_dark_sheet_is_dark_and_the_printed_one_never(page: Any) -> None:
    ground = "getComputedStyle(document.body).backgroundColor"
    page.emulate_media(color_scheme="dark")
    assert page.evaluate(ground) == "rgb(20, 24, 28)"
    page.emulate_media(color_scheme="dark", media="print")
    assert page.evaluate(ground) == "rgb(255, 255, 255)"


def test_every_figure_has_a_title_for_those_who_cannot_see_it(page: Any) -> None:
    """What is folded is opened to be measured, and folded again."""
    figures = page.evaluate("""() => {
        const folded = [...document.querySelectorAll('details:not([open])')];
        folded.forEach(node => node.open = true);
        const found = [...document.querySelectorAll('.drawing > svg')].map(node => [
            node.getAttribute('role'), document.getElementById(node.getAttribute('aria-labelledby'))?.textContent || '',
            node.getBoundingClientRect().width, node.getBoundingClientRect().height]);
        folded.forEach(node => node.open = false);
        return found;
    }""")
    assert figures
    assert [figure for figure in figures if figure[0] != "img" or not figure[1].strip()] == []
    assert [figure for figure in figures if figure[2] < 200 or figure[3] < 60] == []


def test_the_contents_lead_to_their_chapters(page: Any) -> None:
    links = page.evaluate("""() => [...document.querySelectorAll('nav a')].map(node => [
        node.textContent.trim(),
        document.querySelector(node.getAttribute('href'))?.querySelector('h2').textContent.trim()])""")
    assert len(links) > 7
    assert [pair for pair in links if pair[0] != pair[1]] == []


def test_the_keyboard_reaches_every_table(page: Any) -> None:
    regions = page.evaluate("""() => [...document.querySelectorAll('.scroll')].map(node =>
        [node.tabIndex, node.getAttribute('role'), (node.getAttribute('aria-label') || '').trim().length > 0])""")
    assert regions
    assert {tuple(region) for region in regions} == {(0, "region", True)}
