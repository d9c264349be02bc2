"""The index of a folder of runs in a browser: it sorts and filters, by mouse and keyboard, and asks for nothing."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

sys.path.append(str(Path(__file__).parents[1] / "unit"))

from made_runs import made_runs
from test_sheet import (  # noqa: F401
    test_every_character_is_drawn,
    test_every_text_stands_out_from_its_ground,
    test_nothing_is_cut_off_on_paper,
    test_the_dark_sheet_is_dark_and_the_printed_one_never,
    test_the_keyboard_reaches_every_table,
    test_the_page_is_no_wider_than_the_screen,
    test_the_policy_stops_what_a_later_hand_adds,
    test_the_sheet_asks_for_nothing_and_says_nothing,
)

from truing.report.index_page import write_index
from truing.runs.index import list_folder

if TYPE_CHECKING:
    from playwright.sync_api import Browser

BY_DATE = ["later/deep", "found", "first", "no_limits"]
"""Newest first, without the row that says no date and without that of another zone, which stands on top."""


@pytest.fixture(scope="session")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page, in a folder whose name is no plain one."""
    folder = made_runs(tmp_path_factory.mktemp("Größe ü #1"))
    write_index(folder / "index.html", list_folder(folder))
    return folder / "index.html"


def names(page: Any) -> list[str]:
    """The names of the rows that are shown, in their order; a hostile one is short."""
    shown: list[str] = page.evaluate(
        "[...document.querySelectorAll('tbody tr')].filter(row => row.getClientRects().length)"
        ".map(row => row.cells[0].textContent.trim())"
    )
    return ["hostile" if name.startswith("<img") else name for name in shown]


def sorted_by(page: Any) -> dict[str, str]:
    """Which column says that it is sorted, and how."""
    found: dict[str, str] = page.evaluate(
        "Object.fromEntries([...document.querySelectorAll('thead th[aria-sort]')]"
        ".map(head => [head.textContent, head.getAttribute('aria-sort')]))"
    )
    return found


def press(page: Any, title: str) -> None:
    """Click a heading."""
    page.get_by_role("button", name=title, exact=True).click(timeout=3000)


def test_dates_sort_as_moments_and_none_comes_last(own_page: Any) -> None:
    assert names(own_page) == ["calm", *BY_DATE, "hostile"]
    assert sorted_by(own_page) == {"Date": "descending"}
    press(own_page, "Date")
    assert sorted_by(own_page) == {"Date": "ascending"}
    assert names(own_page) == [*reversed(BY_DATE), "calm", "hostile"]


def test_numbers_sort_as_numbers_and_none_comes_last(own_page: Any) -> None:
    """As texts −20 % would stand behind 5 %, and 50 % before 5 %."""
    press(own_page, "Least margin")
    assert names(own_page)[:3] == ["later/deep", "first", "hostile"]
    press(own_page, "Least margin")
    assert names(own_page)[:3] == ["hostile", "first", "later/deep"]
    assert sorted_by(own_page) == {"Least margin": "descending"}
    assert sorted(names(own_page)[3:]) == ["calm", "found", "no_limits"]
    press(own_page, "Warnings")
    assert names(own_page)[:2] == ["later/deep", "calm"]


def test_the_keyboard_sorts_and_shows_where_it_is(own_page: Any) -> None:
    own_page.get_by_role("button", name="Name", exact=True).focus(timeout=3000)
    own_page.keyboard.press("Enter")
    assert sorted_by(own_page) == {"Name": "ascending"}
    assert names(own_page)[1:] == ["calm", "first", "found", "later/deep", "no_limits"]
    own_page.keyboard.press("Space")
    assert sorted_by(own_page) == {"Name": "descending"}
    own_page.keyboard.press("Tab")
    assert own_page.evaluate("document.activeElement.textContent") == "Date"
    assert own_page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_the_filter_takes_words_and_says_how_many(own_page: Any) -> None:
    box = own_page.get_by_role("searchbox")
    box.fill("DIAGNOSIS")
    assert names(own_page) == ["calm", "found"]
    assert own_page.get_by_role("status").text_content() == "2 of 6"
    box.fill("diagnosis joint")
    assert names(own_page) == ["found"]
    box.fill("nothing has this")
    assert names(own_page) == []
    box.fill("")
    assert len(names(own_page)) == 6
    assert own_page.get_by_role("status").text_content() == ""
    box.fill("run")
    press(own_page, "Name")
    assert names(own_page)[1:] == ["first", "later/deep", "no_limits"]


def test_a_link_leads_to_its_sheet(own_page: Any, sheet: Path) -> None:
    own_page.get_by_role("link", name="later/deep").click()
    assert own_page.url == (sheet.parent / "later" / "deep" / "sheet.html").as_uri()
    assert own_page.title() == "a sheet"


def test_it_can_be_read_without_a_script(browser: Browser, sheet: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    try:
        page = context.new_page()
        page.goto(sheet.as_uri())
        assert page.get_by_role("row").count() == 7
        assert page.get_by_role("button").count() == 0
        assert page.get_by_role("searchbox").count() == 0
        assert page.get_by_role("columnheader", name="Date").get_attribute("aria-sort") == "descending"
    finally:
        context.close()


def test_on_a_phone_every_row_is_a_card_with_named_values(own_page: Any) -> None:
    own_page.set_viewport_size({"width": 390, "height": 844})
    cells = own_page.evaluate("""() => [...document.querySelector('tbody tr').cells]
        .filter(cell => cell.getClientRects().length)
        .map(cell => [cell.getBoundingClientRect().left, getComputedStyle(cell, '::before').content])""")
    assert len({left for left, _ in cells}) == 1
    assert all(label not in {"none", '""'} for _, label in cells[1:])
    press(own_page, "Name")
    assert sorted_by(own_page) == {"Name": "ascending"}
