"""Results beside the form, in a browser: they follow keys and sliders, curves are drawn, runs go on behind them.

The pin's numbers are closed forms: 120 N on 28 mm^2 are 4.2857 MPa, and 80 MPa are met at 2240 N.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from workbench_browser import Workbench, axe, sideways

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
LONG, SHORT = 20_000_000, 1000
"""Draws of a run that takes until it is cancelled, and of one that is over at once."""
TEXT = f"""\
plugin = "pin_wear"  # of the folder

[inputs]
load = "120 N"

[studies]
run = ["sensitivity", "reliability"]

[studies.reliability]
draws = {LONG}
"""
CRASHES = """    print("a line that nobody asked for")
    if np.any(pin.load == 500.0):
        import os

        os._exit(3)
    while np.any((pin.load == 601.0) | (pin.load == 602.0)):
        pass
    pressure = pin.load / pin.area
"""


@pytest.fixture(scope="module")
def pins(workbench: Workbench) -> Workbench:
    """A workbench over a pin that prints, ends its process at 500 N, and hangs at 601 N and 602 N."""
    source = PIN.read_text(encoding="utf-8").replace("    pressure = pin.load / pin.area\n", CRASHES)
    (workbench.folder / "own_pin.py").write_text(source, encoding="utf-8")
    (workbench.folder / "pin.toml").write_text(TEXT, encoding="utf-8")
    return workbench


@pytest.fixture(scope="module")
def window(browser: Browser, pins: Workbench) -> Iterator[Any]:
    """One page for all tests of this file, one after another."""
    page = pins.page(browser, "runs")
    page.evaluate("async () => (await import('/static/workbench.js')).call('/api/confirm', { file: 'own_pin.py' })")
    page.goto(f"{pins.address}edit?file=pin.toml&plugin=own_pin.py")
    page.locator(".see-slider").first.wait_for()
    yield page
    page.context.close()


def holds(page: Any, part: str, words: str) -> None:
    """Wait until a part of the page contains these words."""
    from playwright.sync_api import expect

    expect(page.locator(part)).to_contain_text(words, timeout=30_000)


def stands(slider: Any, value: str) -> None:
    """Wait until a slider stands at a value: it follows the text about a second after it was moved itself."""
    from playwright.sync_api import expect

    expect(slider).to_have_value(value, timeout=30_000)


def type_load(page: Any, load: str) -> None:
    page.locator(".field[data-path*='\"load\"'] input").first.fill(load)


def test_numbers_follow_a_keystroke_and_a_slider_changes_the_text_as_typing_does(window: Any) -> None:
    holds(window, "#see-sections", "4.2857")
    slider = window.locator("#see-slider-load")
    assert "its scatter moves pressure by 0.16 %" in window.locator("#see-slider-load-why").inner_text()
    type_load(window, "0.24 kN")
    holds(window, "#see-sections", f"{240 / 28:.5g}")
    stands(slider, "0.24")
    slider.focus()
    window.keyboard.press("ArrowLeft")
    holds(window, "#see-sections", f"{1000 * float(slider.input_value()) / 28:.5g}")
    assert f'load = "{slider.input_value()} kN"' in window.locator("#text").input_value()
    type_load(window, "120 N")
    holds(window, "#see-sections", "4.2857")
    stands(slider, "120")
    slider.focus()
    window.keyboard.press("ArrowRight")
    window.keyboard.press("ArrowRight")
    holds(window, "#see-sections", f"{120.2 / 28:.5g}")  # 200 places or more between 50 N and 200 N are 0.1 N apart
    assert f'load = "{slider.input_value()} N"' in window.locator("#text").input_value()
    type_load(window, "120 N")
    holds(window, "#see-sections", "4.2857")
    stands(slider, "120")


@pytest.mark.parametrize(
    ("load", "sentence"),
    [
        ("120 mm", "Line 4: load: '120 mm' is a length"),
        ("60 kN", "Line 4: the contact flows: load exceeds hardness times area"),
        ("500 N", "the calculation ended without an answer (exit code 3)"),
    ],
)
def test_what_cannot_be_calculated_is_said_and_the_last_numbers_stay_and_are_marked(
    window: Any, load: str, sentence: str
) -> None:
    type_load(window, load)
    holds(window, "#see-said", sentence)
    assert window.locator("#see-mark").inner_text() == "of the earlier text"
    holds(window, "#see-sections", "4.2857")
    type_load(window, "120 N")
    window.locator("#see-mark").wait_for(state="hidden")
    holds(window, "#see-said", "Undecided.")


def test_texts_that_hang_one_after_another_do_not_hold_up_the_next(window: Any) -> None:
    for load in ("601 N", "602 N"):
        type_load(window, load)
        holds(window, "#see-said", "Calculating")
        window.wait_for_timeout(1600)  # so long until one more question is asked beside one that hangs
    began = time.monotonic()
    type_load(window, "140 N")
    holds(window, "#see-sections", "pressure5MPa")
    assert time.monotonic() - began < 10  # and not the 20 s after which the first would have been given up
    type_load(window, "120 N")
    holds(window, "#see-sections", "4.2857")


def test_curves_along_an_input_have_their_limit_and_follow_ends_that_are_typed_or_dragged(window: Any) -> None:
    window.locator("#see-along > summary").click()
    window.locator("#see-over").select_option("load")
    window.locator("#see-high").fill("4 kN")
    holds(window, "#see-met", "pressure ≤ 80 MPa: met at 2240 N, kept below it")
    assert window.locator("#see-curves svg").count() == 1
    window.locator("#see-high-drag").focus()
    window.keyboard.press("ArrowLeft")
    assert window.locator("#see-high").input_value() == "199.9 N"  # the model varies it up to 200 N
    holds(window, "#see-met", "pressure ≤ 80 MPa: kept everywhere")
    window.locator("#see-low").fill("300 N")
    holds(window, "#see-swept", "runs backwards")
    window.locator("#see-along > summary").click()


def test_a_run_shows_how_far_it_is_is_cancelled_and_is_marked_when_it_is_older_than_the_inputs(
    window: Any, pins: Workbench
) -> None:
    holds(window, "#see-last", "No run of this file yet")
    window.locator("#run").click()
    holds(window, "#see-stage", "reliability")
    window.locator("#see-progress[value]").wait_for()
    window.locator("#see-cancel").click()
    holds(window, "#see-last", "The run was cancelled. Nothing was written.")
    assert not (pins.folder / "runs" / "pin").exists()
    window.locator("#text").fill(TEXT.replace(str(LONG), str(SHORT)))
    window.locator("#run").click()
    window.locator("#see-chapters details").first.wait_for()
    assert (pins.folder / "pin.toml").read_text(encoding="utf-8") == TEXT.replace(str(LONG), str(SHORT))  # it was saved
    assert window.locator("#see-older").is_hidden()
    window.locator("#see-chapters summary", has_text="Study: reliability").click()
    frame = window.frame_locator("#see-chapters iframe")
    assert "reliability" in frame.locator("h2").inner_text()
    type_load(window, "130 N")
    window.locator("#see-older").wait_for()
    holds(window, "#see-differences", "load: 120 N → 130 N")
    holds(window, "#see-sections", f"{130 / 28:.5g}")


def test_results_that_differ_from_a_saved_run_are_marked_with_their_values_before(window: Any) -> None:
    window.locator("#see-beside").select_option("runs/pin")
    holds(window, "#see-said", "results differ from runs/pin")
    window.locator("#see-sections summary", has_text="Contact").click()
    row = window.locator("#see-sections tr.changed", has_text="contact pressure")
    assert f"was {120 / 28:.5g} (+8.33 %)" in row.inner_text()
    type_load(window, "120 N")
    holds(window, "#see-said", "No results differ from runs/pin")
    window.locator("#see-older").wait_for(state="hidden")


def test_the_page_is_read_by_everybody_with_everything_open(window: Any) -> None:
    window.locator("#see-whole > summary").click()
    assert "Sliding wear of a pin" in window.frame_locator("#see-whole iframe").locator("h1").inner_text()
    window.evaluate("() => scrollTo(0, 0)")
    assert axe(window) == []
    window.emulate_media(color_scheme="dark")
    window.set_viewport_size({"width": 390, "height": 844})
    window.get_by_role("tab", name="Results").click()
    assert window.locator("#see-numbers").is_visible()
    assert [*axe(window), *sideways(window)] == []
    assert window.outside == []
    assert [said for said in window.said if "409" not in said] == []  # 409: a newer question took the place
