"""The form of an inputs file in a browser: typing, answers, undo, conflicts, two tabs, two servers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from workbench_browser import Workbench, axe, serving_warm, sideways

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser

TEXT = """\
# A press of our own.
plugin = "press_linkage"

[inputs]
reading = "complete"  # every tolerance
crank_radius = "0.36 m"         # a, crank from A to B
# slider_mass = "20 t"            # with what hangs on it

# [tolerances]
# crank_radius = "IT7"

[studies]
run = []
"""
RADIUS = '[id="inputs/crank_radius"]'
ANSWER = '[id="answer.inputs/crank_radius"]'


@pytest.fixture
def file(workbench: Workbench) -> Path:
    """An inputs file as it is before each test."""
    path = workbench.folder / "press.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def window(browser: Browser, workbench: Workbench) -> Iterator[Any]:
    """One window for all tests; each opens the file in it anew."""
    opened = workbench.page(browser, "runs")
    yield opened
    opened.context.close()


@pytest.fixture
def page(window: Any, workbench: Workbench, file: Path) -> Iterator[Any]:
    """The page of that file."""
    for seen in (window.said, window.outside):
        seen.clear()
    edited(window, workbench)
    yield window
    assert window.said == []
    assert window.outside == []


def edited(page: Any, workbench: Workbench) -> None:
    """Open the file, wait for its first answer, and open every group."""
    page.goto(workbench.address + "edit?file=press.toml")
    page.wait_for_selector("summary .stated:not(:empty)")
    page.evaluate("document.querySelectorAll('#form details').forEach(part => { part.open = true; })")


def text(page: Any) -> str:
    """What the page would save."""
    return str(page.input_value("#text"))


def until(page: Any, holds: str, words: Any) -> None:
    """Wait until a function of the page holds of some words.

    It is asked 20 times a second; at every frame, as is usual, it has the page drawn 60 times.
    """
    page.wait_for_function(holds, arg=words, polling=50)


def valued(page: Any, typed: str) -> None:
    """Wait until the field of the crank radius holds this."""
    until(page, "typed => document.getElementById('inputs/crank_radius').value === typed", typed)


def written(page: Any, whole: str) -> None:
    """Wait until the text is this."""
    until(page, "whole => document.getElementById('text').value === whole", whole)


def told(page: Any, selector: str, words: str) -> None:
    """Wait until an element says this."""
    until(
        page, "([selector, words]) => document.querySelector(selector).textContent.includes(words)", [selector, words]
    )


def test_a_file_is_edited_by_keyboard_alone_and_every_other_line_stays(page: Any, file: Path) -> None:
    page.keyboard.press("Tab")
    for _ in range(60):
        if page.evaluate("document.activeElement.id") == "inputs/crank_radius":
            break
        page.keyboard.press("Tab")
    page.keyboard.press("Control+A")
    page.keyboard.type("400 mmm")
    told(page, ANSWER, "crank_radius: unknown unit 'mmm'; did you mean 'mm'?")
    assert page.get_attribute(RADIUS, "aria-invalid") == "true"
    told(page, "#faults", "line 6")
    told(page, "details[open] .faulty:not(:empty)", "1 fault")
    page.keyboard.press("Backspace")
    told(page, ANSWER, "= 0.4 m")
    assert page.evaluate("[document.activeElement.id, document.activeElement.selectionStart]") == [
        "inputs/crank_radius",
        6,
    ]
    page.keyboard.press("Control+S")
    told(page, "#saved", "saved")
    page.wait_for_selector("#save:disabled")
    assert file.read_text() == TEXT.replace('"0.36 m"', '"400 mm"')


def test_undo_and_redo_go_over_visits_of_fields(page: Any) -> None:
    page.fill(RADIUS, "0.4 m")
    told(page, ANSWER, "= 0.4 m")
    page.locator('[data-key="inputs/crank_radius"] select').select_option("mm")
    valued(page, "400 mm")
    page.fill('[id="tolerances/crank_radius"]', "±0.05 mm")
    told(page, '[id="answer.tolerances/crank_radius"]', "sd 0.01667 mm")
    changed = text(page)
    assert changed == TEXT.replace('"0.36 m"', '"400 mm"').replace("# [tol", "[tol").replace(
        '# crank_radius = "IT7"\n', '# crank_radius = "IT7"\ncrank_radius = "±0.05 mm"\n'
    )
    page.focus("#undo")
    page.keyboard.press("Control+z")
    page.wait_for_selector('[data-key="tolerances/crank_radius"]:not(.is-stated)')
    page.click("#undo")
    valued(page, "0.4 m")
    page.click("#undo")
    written(page, TEXT)
    assert page.is_disabled("#undo")
    page.keyboard.press("Control+Shift+z")
    for _ in range(2):
        page.focus("#redo")
        page.keyboard.press("Control+Shift+z")
    written(page, changed)
    told(page, '[id="answer.tolerances/crank_radius"]', "sd 0.01667 mm")


def test_switches_choices_resets_and_the_search(page: Any) -> None:
    page.locator('[data-key="effects/warm_up"] .switch').check()
    told(page, '[id="answer.effects/warm_up/time_constant"]', "=")
    page.locator('[data-key="effects/warm_up"] .switch').uncheck()
    written(page, TEXT)
    page.locator('[data-key="inputs/reading"] .reset').click()
    page.wait_for_function("() => document.getElementById('text').value.includes('# reading = \"complete\"  # every')")
    assert page.input_value('[id="inputs/reading"]') == ""
    page.locator('[data-key="studies/run"] input[value="sensitivity"]').check()
    page.wait_for_function("() => document.getElementById('text').value.includes('run = [\"sensitivity\"]')")
    page.fill("#search", "COUNTERbalance lifts")
    told(page, "#hits", "1 field")
    assert page.is_visible('[id="inputs/counterbalance"]')
    assert not page.is_visible(RADIUS)


def test_a_fault_of_the_text_leads_to_its_field_or_its_line(page: Any) -> None:
    page.fill("#text", TEXT.replace('"0.36 m"', '"36 N"').replace("run = []", "run = [\n\nx = 3"))
    told(page, "#faults", "crank_radius: '36 N' is a force (N), expected a length (m)")
    page.locator("#faults button", has_text="36 N").first.click()
    assert page.evaluate("document.activeElement.id") == "inputs/crank_radius"
    page.locator("#faults .line").first.click()
    assert page.evaluate(
        "getSelection().toString() || text.value.slice(text.selectionStart, text.selectionEnd)"
    ).startswith("crank_radius")


def test_what_others_write_is_shown_and_in_a_conflict_nothing_is_lost(page: Any, file: Path) -> None:
    file.write_text(TEXT.replace("0.36 m", "0.35 m"), encoding="utf-8")
    valued(page, "0.35 m")
    page.fill(RADIUS, "0.34 m")
    told(page, ANSWER, "= 0.34 m")
    theirs = TEXT.replace("0.36 m", "0.33 m").replace("our own", "theirs")
    file.write_text(theirs, encoding="utf-8")
    page.wait_for_selector("#conflict:not([hidden])")
    told(page, "#conflict", 'crank_radius = "0.33 m"')
    mine = text(page)
    page.keyboard.press("Control+s")  # a conflict is not written over
    page.wait_for_timeout(300)
    assert file.read_text() == theirs
    page.click("#take")
    written(page, theirs)
    page.click("#undo")
    written(page, mine)
    page.click("#save")
    page.wait_for_selector("#save:disabled")
    assert file.read_text() == mine


def test_two_tabs_and_two_servers_lose_nothing(page: Any, file: Path, workbench: Workbench, browser: Browser) -> None:
    tab = page.context.new_page()
    tab.goto(page.url)
    tab.wait_for_selector("summary .stated:not(:empty)")
    with serving_warm(workbench.folder) as other:
        elsewhere = other.page(browser, "runs")
        edited(elsewhere, other)
        page.fill(RADIUS, "0.31 m")
        elsewhere.fill(RADIUS, "0.32 m")
        for each, answer in ((page, "0.31"), (elsewhere, "0.32")):
            told(each, ANSWER, f"= {answer} m")
        page.click("#save")
        page.wait_for_selector("#save:disabled")
        valued(tab, "0.31 m")
        elsewhere.wait_for_selector("#conflict:not([hidden])")
        elsewhere.click("#keep")
        elsewhere.click("#save")
        elsewhere.wait_for_selector("#save:disabled")
        valued(page, "0.32 m")
        page.click("#undo")
        valued(page, "0.31 m")
        elsewhere.context.close()
    tab.close()
    assert file.read_text() == TEXT.replace("0.36 m", "0.32 m")


def test_a_file_that_is_gone_is_written_again_and_leaving_warns(page: Any, file: Path) -> None:
    file.unlink()
    told(page, "#said", "press.toml is gone from the folder; Save writes it again.")
    asked: list[str] = []

    def stay(dialog: Any) -> None:
        asked.append(dialog.type)
        dialog.accept()

    page.on("dialog", stay)
    page.click("#save")
    page.wait_for_selector("#save:disabled")
    assert file.read_text() == TEXT
    page.fill(RADIUS, "0.3 m")
    told(page, ANSWER, "= 0.3 m")
    page.reload()
    assert asked == ["beforeunload"]


def test_the_open_form_is_for_everybody_on_a_phone(page: Any) -> None:
    page.set_viewport_size({"width": 390, "height": 900})
    page.emulate_media(color_scheme="dark")
    page.fill(RADIUS, "36 N")
    told(page, ANSWER, "expected a length")
    assert sideways(page) == []
    assert axe(page) == []
