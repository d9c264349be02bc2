"""How the workbench looks and is reached: for screen readers, by keyboard, on a phone, in the dark, without a network.

axe-core looks at every page light and wide, and dark and narrow; a page that asks anything of another server fails.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest
from shown_in_docs import EXAMPLES

import truing
from workbench_browser import Workbench, axe, sideways

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PRESS = EXAMPLES / "press_off_by_40_um"
PAGES = {
    "folder": "",
    "edit": "edit?file=inputs.toml",
    "measure": "measure?data=measured.csv",
    "runs": "runs",
    "compare": "compare?before=runs/as_drawn&after=runs/turned",
    "new": "new",
    "fault": "edit?file=nothing.toml",
}
INPUTS = """\
plugin = "press_linkage"

[inputs]
reading = "complete"  # sides 1 and 2 moved together

[studies]
run = []
"""
SLIDER = re.compile(r"3557\.[56]")
"""What the page shows of the slider's height at the bottom dead centre: in mm, to one digit or more."""
MOST_STEPS = 150
"""So many presses of Tab lead to any control of any page that the way by keyboard uses."""
FOCUSED = """() => {
    const node = document.activeElement, box = node.getBoundingClientRect(), style = getComputedStyle(node);
    const shown = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    return {
        control: node.matches('a, button, input, select, summary, textarea'),
        name: (node.getAttribute('aria-label') || node.labels?.[0]?.innerText || node.innerText || '').trim(),
        ring: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2,
        covered: !!shown && !node.contains(shown) && !shown.contains(node), body: node === document.body,
    };
}"""


@pytest.fixture(scope="module")
def filled(workbench: Workbench) -> Workbench:
    """A workbench over a press with a record and two runs."""
    shutil.copy(PRESS / "measured.csv", workbench.folder)
    press, inputs = truing.load("press_linkage"), workbench.folder / "inputs.toml"
    inputs.write_text(INPUTS, encoding="utf-8")
    for name, angle in {"as_drawn": "0 deg", "turned": "30 deg"}.items():
        press.run(inputs, output=workbench.folder / "runs" / name, progress=False, crank_angle=angle)
    return workbench


@pytest.fixture(scope="module")
def window(browser: Browser, filled: Workbench) -> Iterator[Any]:
    """One page for all tests that only look."""
    page = filled.page(browser, "runs")
    yield page
    page.context.close()


def seen(page: Any, address: str) -> int:
    """Open a page, wait until what its scripts ask for has come, and return its status."""
    page.said.clear()
    page.outside.clear()
    status: int = page.goto(address).status
    if "/edit" in address and status == 200:
        page.get_by_text(SLIDER).first.wait_for(state="attached")
    if "/measure" in address and status == 200:
        page.get_by_role("heading", name="measured.csv").wait_for()
    return status


@pytest.mark.parametrize("name", PAGES)
def test_a_page_can_be_read_by_everybody_and_asks_nothing_of_others(window: Any, filled: Workbench, name: str) -> None:
    window.emulate_media(color_scheme="light")
    window.set_viewport_size({"width": 1280, "height": 900})
    assert seen(window, filled.address + PAGES[name]) == (422 if name == "fault" else 200)
    assert [*axe(window), *sideways(window)] == []
    window.emulate_media(color_scheme="dark")
    window.set_viewport_size({"width": 390, "height": 844})
    assert [*axe(window), *sideways(window)] == []
    assert window.outside == []
    assert [said for said in window.said if name != "fault" or "422" not in said] == []


def test_what_a_page_says_can_be_read_by_everybody(window: Any, filled: Workbench) -> None:
    """A fault, news, a job that runs and a question stand where nobody misses them, in both colours."""
    seen(window, filled.address + "runs")
    window.evaluate("""async () => {
        const { ask, say, tell } = await import('/static/workbench.js');
        say('inputs.toml:4: press_linkage has no input laod'); tell('saved');
        window.answered = ask('own.py is a program. Run it?', 'Run it').then(yes => yes ? 'ran' : 'left');
    }""")
    for colours in ("light", "dark"):
        window.emulate_media(color_scheme=colours)
        assert axe(window) == []
    assert window.locator("dialog").evaluate("node => node.matches(':modal')")
    assert window.locator("[role=alert]", has_text="laod").is_visible()
    window.keyboard.press("Escape")
    assert window.evaluate("window.answered") == "left"
    window.keyboard.press("Escape")
    assert window.locator("[role=alert]", has_text="laod").count() == 0


def focus(page: Any, name: str) -> None:
    """Press Tab until what has this name has the focus; everything on the way shows a ring and is not covered."""
    for _ in range(MOST_STEPS):
        page.keyboard.press("Tab")
        now = page.evaluate(FOCUSED)
        if now["name"] and not now["body"]:
            assert now["ring"], f"{now['name']} does not show that it has the focus"
            assert not now["covered"], f"{now['name']} is covered while it has the focus"
        if name in now["name"] and now["control"]:
            return
    pytest.fail(f"{MOST_STEPS} presses of Tab did not lead to {name}")


def test_the_whole_way_by_keyboard(browser: Browser, filled: Workbench) -> None:
    """From the list of the folder to a value that is changed, saved and run, and to the sheet of the run."""
    page = filled.page(browser)
    focus(page, "Skip to the content")
    page.keyboard.press("Enter")
    focus(page, "inputs.toml")
    page.keyboard.press("Enter")
    page.wait_for_url("**/edit?*")
    page.get_by_text(SLIDER).first.wait_for(state="attached")
    focus(page, "Search the fields")
    page.keyboard.type("crank_angle")
    focus(page, "crank from the bottom dead centre")
    page.keyboard.type("30 deg")
    page.wait_for_function("() => document.getElementById('text').value.includes('30 deg')")
    page.keyboard.press("Shift+Tab")
    page.evaluate("document.getElementById('main').focus()")
    focus(page, "Save")
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.getElementById('save').disabled")
    assert "30 deg" in (filled.folder / "inputs.toml").read_text(encoding="utf-8")
    page.evaluate("document.getElementById('main').focus()")
    focus(page, "Run")
    page.keyboard.press("Enter")
    page.locator(".job", has_text="done").wait_for(timeout=60_000)
    page.keyboard.press("Control+Home")
    page.evaluate("document.activeElement.blur()")
    focus(page, "Open it")
    page.keyboard.press("Enter")
    page.wait_for_url("**/run?*")
    title = page.frame_locator("iframe").locator("h1")
    assert title.inner_text() == "Parallel-driven multi-link servo press: slider accuracy"
    assert page.outside == []
    page.context.close()


def test_the_whole_way_in_firefox(firefox: Browser, filled: Workbench) -> None:
    """From the list of the folder to a changed value, its answer, the saved file; each page fits a phone."""
    (filled.folder / "inputs.toml").write_text(INPUTS, encoding="utf-8")
    page = filled.page(firefox)
    page.get_by_role("link", name="inputs.toml").click()
    page.get_by_text(SLIDER).first.wait_for()
    page.get_by_label("Search the fields").fill("crank_angle")
    page.locator("[id='inputs/crank_angle']").fill("20 deg")
    page.get_by_text(SLIDER).first.wait_for(state="detached")
    page.get_by_role("button", name="Save").click()
    page.wait_for_function("() => document.getElementById('save').disabled")
    assert "20 deg" in (filled.folder / "inputs.toml").read_text(encoding="utf-8")
    for address in PAGES.values():
        page.goto(filled.address + address)
        page.set_viewport_size({"width": 390, "height": 844})
        assert sideways(page) == []
    assert axe(page) == []
    assert page.outside == []
    page.context.close()


def test_a_page_says_that_the_server_has_stopped_and_keeps_what_was_typed(browser: Browser, filled: Workbench) -> None:
    """The server of this file ends here, so this test stands last."""
    (filled.folder / "inputs.toml").write_text(INPUTS, encoding="utf-8")
    page = filled.page(browser, "runs")
    seen(page, filled.address + PAGES["edit"])
    page.locator("#text").press_sequentially("# mine")
    filled.stop()
    page.locator("#gone", has_text="The server has stopped").wait_for()
    saving = "async () => (await import('/static/workbench.js')).call('/api/save', {}).catch(error => error.message)"
    assert page.evaluate(saving).startswith("The server has stopped. Start calc serve again")
    assert "# mine" in page.locator("#text").input_value()
    page.context.close()
