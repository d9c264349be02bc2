"""The workbench in a browser: pick, begin, confirm a program, keep runs, compare two, make a calculation and run it."""

from __future__ import annotations

import sys
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from shared import ROOT
from workbench_browser import Workbench, axe, serving_warm, sideways

sys.path.append(str(ROOT / "tests" / "unit"))

from made_runs import check, run

if TYPE_CHECKING:
    from playwright.sync_api import Browser

COLD = 30_000
"""Milliseconds that the first answer of a worker may take: it imports everything, on a machine that does more."""
DRIVES = """
import os
from pathlib import Path
from truing import Float, Model, found, given, hookimpl, inputs, results
Path(os.environ.get("RAN", __file__ + ".ran")).write_text("ran")
@inputs
class Belt:
    force: Float = given(120.0, "N", note="pull")
@results
class Answer:
    double: Float = found("N", formula="2 * force", note="twice the pull")
def pull(belt: Belt) -> Answer:
    return Answer(double=2 * belt.force)
@hookimpl
def truing_models() -> list[Model[Belt, Answer]]:
    return [Model(name="belt", title="A belt that pulls", function=pull)]
"""


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    """A folder with a program, a broken file, rows, and runs of which two are of one file."""
    folder = tmp_path_factory.mktemp("drives")
    (folder / "belt.py").write_text(DRIVES, encoding="utf-8")
    (folder / "broken.toml").write_text('plugin = "rv_wear\n', encoding="utf-8")
    (folder / "wrong.toml").write_text('plugin = "rv_wear"\n[inputs]\nloda = "3 N"\n', encoding="utf-8")
    (folder / "press.toml").write_text('plugin = "rv_wear"\n', encoding="utf-8")
    (folder / "rows.csv").write_text("load [N],depth [um]\n1,2\n", encoding="utf-8")
    force = {"value": 50.0, "unit": "N"}
    run(
        folder / "runs" / "press", check("tilt", 9.0, 10.0, 0.1), date="2026-11-02T08:00:00+0000",
        inputs={"force": force},
    )  # fmt: skip
    run(
        folder / "runs" / "press-2", check("tilt", 12.0, 10.0, -0.2), date="2026-11-03T08:00:00+0000",
        inputs={"force": {**force, "value": 60.0}},
    )  # fmt: skip
    run(folder / "runs" / "beam", check("sag", 5.0, 10.0, 0.5), date="2026-11-01T08:00:00+0000")
    with serving_warm(folder) as served:
        yield served


@pytest.fixture(scope="module")
def page(served: Workbench, browser: Browser) -> Iterator[Any]:
    """One page for all tests, which ends without having complained or asked for anything outside."""
    page = served.page(browser)
    page.set_default_timeout(COLD)
    yield page
    said = [text for text in page.said if "409 (Conflict)" not in text and "422 (Unprocessable" not in text]
    assert (said, page.outside) == ([], [])
    page.context.close()


def test_the_folder_is_picked_from(served: Workbench, page: Any) -> None:
    row = page.locator("#inputs tr", has_text="press.toml")
    row.locator(".last .badge").wait_for()
    assert row.locator(".last").inner_text() == "fails tilt"
    assert "2026-11-03" in row.locator(".date").inner_text()
    assert "is no TOML" in page.locator("#inputs tr", has_text="broken.toml").inner_text()
    page.locator("#inputs tr", has_text="wrong.toml").get_by_text("line 3: rv_wear has no input 'loda'").wait_for()
    card = page.locator("#installed > li").first
    card.locator("img").wait_for()
    assert card.locator("img").get_attribute("alt") == (
        "Harmonic drive: contact stiffness and clearance of rough flanks: Stiffness and clearance over the load"
    )
    assert card.locator("img").evaluate("image => image.naturalWidth") > 100
    card.get_by_text("Show the example").click()
    card.locator("pre", has_text='plugin = "harmonic_fractal"').wait_for()


def test_an_inputs_file_begins_from_the_example_and_replaces_none(served: Workbench, page: Any) -> None:
    page.goto(served.address)
    card = page.locator("#installed > li", has_text="wear of the cycloid disc")
    card.locator("input").fill("press.toml")
    card.get_by_role("button", name="Begin from the example").click()
    card.locator(".answer", has_text="press.toml is there already").wait_for()
    assert (served.folder / "press.toml").read_text() == 'plugin = "rv_wear"\n'
    card.locator("input").fill("../outside.toml")
    card.get_by_role("button", name="Begin from the example").click()
    card.locator(".answer", has_text="lies outside").wait_for()
    card.locator("input").fill("wear")
    card.get_by_role("button", name="Begin from the example").click()
    page.wait_for_url("**/edit?file=wear.toml")
    assert 'plugin = "rv_wear"' in (served.folder / "wear.toml").read_text()


def test_a_program_runs_only_once_it_is_confirmed(served: Workbench, page: Any) -> None:
    ran = served.folder / "belt.py.ran"
    page.goto(served.address)
    page.get_by_role("button", name="Open belt.py").press("Enter")  # figures that come in move it away from a mouse
    page.get_by_role("dialog").get_by_role("button", name="Cancel").click()
    page.locator("#said", has_text="confirm it before it runs").wait_for()
    assert not ran.exists()
    page.goto(served.address + "edit?file=press.toml&plugin=belt.py")
    page.get_by_role("heading", name="Run belt.py?").wait_for()
    page.get_by_role("button", name="Run it").wait_for()
    assert not ran.exists()
    page.goto(served.address)
    page.get_by_role("button", name="Open belt.py").press("Enter")  # figures that come in move it away from a mouse
    page.get_by_role("dialog").get_by_role("button", name="Run it").click()
    card = page.locator(".model[data-program='belt.py']", has_text="A belt that pulls")
    card.wait_for()
    assert ran.exists()
    card.get_by_role("button", name="Begin from the example").click()
    page.wait_for_url("**/edit?file=belt.toml&plugin=belt.py")
    page.get_by_text("twice the pull").first.wait_for()
    page.goto(served.address)
    page.locator(".model[data-program='belt.py']", has_text="A belt that pulls").wait_for()


def until(page: Any, holds: Callable[[], bool]) -> None:
    """Wait until something holds; the page goes on meanwhile, which asks this process for every address."""
    end = time.monotonic() + COLD / 1000
    while not holds():
        assert time.monotonic() < end
        page.wait_for_timeout(50)


def names(page: Any) -> list[str]:
    """The runs that are shown, in their order."""
    shown: list[str] = page.evaluate(
        "[...document.querySelectorAll('#runs tbody tr')].filter(row => row.getClientRects().length)"
        ".map(row => row.dataset.name)"
    )
    return shown


def test_runs_are_sorted_filtered_and_say_what_changed(served: Workbench, page: Any) -> None:
    page.goto(served.address + "runs")
    assert names(page) == ["runs/press-2", "runs/press", "runs/beam"]
    page.get_by_role("button", name="Least margin").click()
    assert names(page) == ["runs/press-2", "runs/press", "runs/beam"]
    page.get_by_role("button", name="Least margin").click()
    assert names(page) == ["runs/beam", "runs/press", "runs/press-2"]
    assert page.locator("th[aria-sort]").inner_text() == "Least margin"
    changed = page.locator("tr[data-name='runs/press-2'] .changed a")
    changed.wait_for()
    assert changed.inner_text() == "force 50 N → 60 N; tilt now FAILS"
    page.get_by_label("Show rows with").fill("passes runs/press")
    assert names(page) == ["runs/press"]
    assert page.locator("#count").inner_text() == "1 of 3"
    assert axe(page) == []


def test_two_runs_are_compared(served: Workbench, page: Any) -> None:
    page.goto(served.address + "runs")
    assert page.locator("#compare").get_attribute("href") is None
    page.get_by_label("Compare runs/press-2").check()
    page.get_by_label("Compare runs/press", exact=True).check()
    page.get_by_role("link", name="Compare the two chosen").click()
    page.wait_for_url("**/compare?before=runs%2Fpress&after=runs%2Fpress-2")
    frame = page.frame_locator("iframe.sheet")
    frame.get_by_text("force", exact=True).first.wait_for()
    assert "The verdict went from Passes to Fails." in frame.locator("body").inner_text()


def test_a_run_is_shown_and_its_files_are_kept(served: Workbench, page: Any, tmp_path: Path) -> None:
    page.goto(served.address + "run?folder=runs/press")
    assert "a sheet" in page.frames[1].title()
    page.get_by_text("Download", exact=True).click()
    with page.expect_download() as results:
        page.get_by_role("link", name="Results, JSON").click()
    results.value.save_as(tmp_path / "results.json")
    assert (tmp_path / "results.json").read_bytes() == (served.folder / "runs/press/results.json").read_bytes()
    with page.expect_download() as packed:
        page.get_by_role("link", name="Share: whole folder as .zip").click()
    assert packed.value.suggested_filename == "press.zip"
    packed.value.save_as(tmp_path / "press.zip")
    with zipfile.ZipFile(tmp_path / "press.zip") as archive:
        assert sorted(archive.namelist()) == ["press/results.json", "press/run.json", "press/sheet.html"]
    page.get_by_role("link", name="Results, workbook").click()
    page.locator("#said", has_text="no plugin offers 'press'").wait_for()
    page.get_by_role("button", name="Keep a copy").click()
    page.wait_for_url("**/run?folder=runs%2Fpress-1")


def test_a_calculation_is_made_and_opens(served: Workbench, page: Any) -> None:
    page.goto(served.address + "new")
    page.get_by_label("Name", exact=True).fill("belt")
    page.locator("#fault-name", has_text="belt.py is in the folder already").wait_for()
    page.get_by_label("Name", exact=True).fill("pin")
    typed = {
        "Name of input 1": "load", "Default of input 1": "120", "Unit of input 1": "Nn", "Name of input 2": "area",
        "Default of input 2": "28", "Unit of input 2": "mm^2", "At least of input 2": "0",
        "Name of result 1": "pressure", "Formula of result 1": "laod / area", "Unit of result 1": "MPa",
    }  # fmt: skip
    for label, text in typed.items():
        page.get_by_label(label).fill(text)
    page.get_by_role("button", name="Make the calculation").press("Enter")  # answers move it under a mouse
    page.locator(".answer", has_text="there is no input and no result 'laod'. Did you mean 'load'?").wait_for()
    page.locator(".answer", has_text="unknown unit 'Nn'").wait_for()
    until(page, lambda: page.evaluate("document.activeElement.dataset.key") == "unit")
    assert not (served.folder / "pin.py").exists()
    page.get_by_label("Unit of input 1").fill("N")
    page.get_by_label("Formula of result 1").fill("load / area")
    page.locator(".answer", has_text="pressure is not finite at this bound; write > to leave it out").wait_for()
    page.get_by_label("At least of input 2").fill("> 0")
    page.locator("output", has_text="4.2857 MPa").wait_for()
    assert axe(page) == []
    page.get_by_role("button", name="Make the calculation").click()
    page.get_by_role("button", name="Begin pin.toml and open it").click()
    page.wait_for_url("**/edit?file=pin.toml&plugin=pin.py")
    page.locator("#see-numbers", has_text="4.2857").wait_for()
    page.get_by_role("button", name="Run", exact=True).click()
    until(page, (served.folder / "runs" / "pin" / "sheet.html").is_file)
    page.goto(served.address + "runs")
    assert "no limits" in page.locator("tr[data-name='runs/pin']").inner_text()
    page.get_by_role("link", name="runs/pin").click()
    page.get_by_text("Download", exact=True).click()
    page.get_by_role("button", name="Make the sheet, Word").click()
    with page.expect_download() as word:
        page.get_by_role("link", name="Sheet, Word").click()
    assert Path(word.value.path()).read_bytes()[:2] == b"PK"


def test_pages_on_a_phone_in_the_dark_are_no_wider_and_legible(served: Workbench, browser: Browser) -> None:
    page = served.page(browser, "new", width=390, colours="dark")
    for path in ("", "runs", "run?folder=runs/press", "compare?before=runs/press&after=runs/press-2", "new"):
        page.goto(served.address + path)
        assert (path, sideways(page), axe(page)) == (path, [], [])
    page.context.close()
