"""Ways through the workbench that few take, in a browser: a program that changes, two versions of a text, files of
every kind as one record, a suspicion of one's own, and a cause that is accepted and run.

All go over one folder and one page, over the pin that wears (tests/data/pin_wear.py) as a program of the folder.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from recording_files import Recorded, write_tdms
from shared import ROOT
from truing.measurements import table_text
from truing.workbooks.writing import SheetTable, workbook_bytes
from workbench_browser import Workbench, axe, serving, sideways

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PIN = ROOT / "tests" / "data" / "pin_wear.py"
INPUTS = """\
plugin = "pin_wear"  # a program of this folder

[inputs]
load = "120 N"

[studies]
run = ["reliability"]
"""
PROBE = 'probe_C = { name = "probe_temperature", unit = "degC" }'
"""What [columns] says of the probe of the workbook."""
COLD = 60_000
"""Milliseconds that an answer may take on a machine that does more."""
SLOPE = 0.8
"""Micrometres by which the probe of the bench reads deeper for every kelvin above 20 degC."""


def depth(load: Any, hours: Any) -> Any:
    """The worn depth of the pin as Archard has it, in um: k p s / H, with the sizes of the declaration."""
    return 3e-8 * (load / 28e-6) * (0.5 * 3600 * hours) / 2.1e9 * 1e6


def measured(seed: int) -> Mapping[str, Recorded]:
    """Readings of a bench whose probe is warm, which is all that is wrong."""
    draw = np.random.default_rng(seed)
    hours, load, warmth = (draw.uniform(low, high, 30) for low, high in ((20, 400), (60, 200), (15, 60)))
    read = depth(load, hours) + SLOPE * (warmth - 20) + draw.normal(0, 0.1, 30)
    columns = {"time": (hours, "h"), "load": (load, "N"), "probe_temperature": (warmth, "degC"), "depth": (read, "um")}
    return {name: Recorded(np.round(values, 3), unit) for name, (values, unit) in columns.items()}


def columns_of(channels: Mapping[str, Recorded], **names: str) -> tuple[list[str], list[Any]]:
    """Return headers and columns; ``names`` are headers that stand in place of a name with its unit."""
    heads = [names.get(name, f"{name} [{each.unit}]") for name, each in channels.items()]
    return heads, [each.values for each in channels.values()]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    """A folder with a program and an inputs file that names it."""
    folder = tmp_path_factory.mktemp("pins")
    shutil.copy(PIN, folder)
    (folder / "pin.toml").write_text(INPUTS, encoding="utf-8")
    with serving(folder) as served:
        yield served


@pytest.fixture(scope="module")
def page(served: Workbench, browser: Browser) -> Iterator[Any]:
    """One page for all tests, which ends without having complained or asked for anything outside."""
    page = served.page(browser)
    page.set_default_timeout(COLD)
    yield page
    said = [text for text in page.said if "409 (Conflict)" not in text]
    assert (said, page.outside) == ([], [])
    page.context.close()


@pytest.fixture
def confirmed(page: Any) -> None:
    """Let the program run; the first test does so in its dialog, and need not be the first that this process does."""
    page.evaluate("async () => (await import('/static/workbench.js')).call('/api/confirm', { file: 'pin_wear.py' })")


def test_a_program_is_confirmed_edited_run_and_changed_while_its_page_is_open(served: Workbench, page: Any) -> None:
    program = served.folder / "pin_wear.py"
    page.get_by_role("link", name="pin.toml").click()
    page.get_by_role("dialog").get_by_role("button", name="Run it").click()
    page.wait_for_url("**/edit?file=pin.toml**")
    numbers, results = page.locator("#see-numbers"), page.locator("#see-sections")
    numbers.get_by_text("Undecided.").wait_for()
    page.locator("[id='inputs/load']").fill("100 N")
    results.get_by_text(f"{depth(100, 200):.5g}").first.wait_for(state="attached")
    page.get_by_role("button", name="Run", exact=True).click()
    numbers.get_by_text("The last run, of these inputs, has decided it.").wait_for()
    assert numbers.locator(".verdict").inner_text().startswith("✓ Passes.")
    assert 'load = "100 N"' in (served.folder / "pin.toml").read_text(encoding="utf-8")
    assert axe(page) == []
    changed = program.read_text(encoding="utf-8").replace("+ pin.rate * pressure", "+ 3 * pin.rate * pressure")
    program.write_text(changed, encoding="utf-8")
    page.locator("[id='inputs/load']").fill("110 N")
    results.get_by_text(f"{3 * depth(110, 200):.5g}").first.wait_for(state="attached")
    page.locator("[id='inputs/load']").fill("100 N")
    numbers.get_by_text("Undecided.").wait_for()  # what ran was another program
    page.locator("#see-differences", has_text="pin_wear.py has changed since").wait_for()
    shutil.copy(PIN, program)


def two_versions(served: Workbench, page: Any, mine: str, theirs: str) -> Any:
    """Type a line at the end of the text while another hand writes one to the file; return what is shown of both."""
    file, text = served.folder / "pin.toml", page.locator("#text")
    text.fill(text.input_value() + mine)
    file.write_text(file.read_text(encoding="utf-8") + theirs, encoding="utf-8")
    shown = page.locator("#conflict")
    shown.get_by_text("pin.toml has changed on disk, and what you changed here is not saved").wait_for()
    assert [cell.strip() for cell in shown.locator("tbody td pre").all_inner_texts()] == [mine.strip(), theirs.strip()]
    return shown


@pytest.mark.usefixtures("confirmed")
def test_of_two_versions_of_a_text_either_may_be_kept_and_neither_is_lost(served: Workbench, page: Any) -> None:
    file, text = served.folder / "pin.toml", page.locator("#text")
    page.goto(served.address + "edit?file=pin.toml")
    page.locator("#saved", has_text=re.compile("^saved")).wait_for()
    shown = two_versions(served, page, "# mine\n", "# theirs\n")
    assert axe(page) == []
    page.set_viewport_size({"width": 390, "height": 844})
    assert sideways(page) == []
    page.set_viewport_size({"width": 1280, "height": 900})
    shown.get_by_role("button", name="Keep mine").click()
    page.get_by_role("button", name="Save", exact=True).click()
    page.locator("#saved", has_text=re.compile("^saved")).wait_for()
    kept = file.read_text(encoding="utf-8")
    assert kept.endswith("# mine\n")
    assert "# theirs" not in kept
    page.get_by_role("button", name="Undo").click()
    assert text.input_value().endswith("# theirs\n")
    page.get_by_role("button", name="Redo").click()
    shown = two_versions(served, page, "# mine again\n", "# theirs again\n")
    shown.get_by_role("button", name="Take the file's").click()
    assert text.input_value() == file.read_text(encoding="utf-8") == kept + "# theirs again\n"
    page.get_by_role("button", name="Undo").click()
    assert text.input_value() == kept + "# mine again\n"
    page.get_by_role("button", name="Redo").click()
    page.locator("#saved", has_text=re.compile("^saved")).wait_for()


@pytest.mark.usefixtures("confirmed")
def test_a_file_of_the_same_name_replaces_the_other_one_only_on_request(
    served: Workbench, page: Any, tmp_path: Path
) -> None:
    sent, there = tmp_path / "bench.csv", served.folder / "data" / "bench.csv"
    page.goto(served.address + "measure?file=pin.toml")
    page.get_by_text("No file is chosen yet.").wait_for()
    for seed, answer in ((1, ""), (2, "Keep it as it is"), (3, "Replace it")):
        before = there.read_text(encoding="utf-8") if seed > 1 else ""
        sent.write_text(table_text(*columns_of(measured(seed))), encoding="utf-8")
        page.set_input_files("#upload", sent)
        if answer:
            page.get_by_role("dialog", name="data/bench.csv is there already").get_by_role(
                "button", name=answer
            ).click()
        page.locator("#told", has_text="data/bench.csv is there" if answer != "Keep it as it is" else "").wait_for()
        page.get_by_label("depth [um] is to the model").wait_for()
        expected = before if answer == "Keep it as it is" else sent.read_text(encoding="utf-8")
        assert there.read_text(encoding="utf-8") == expected
    page.get_by_role("checkbox", name="data/bench.csv").uncheck()
    page.get_by_text("No file is chosen yet.").wait_for()


def write_two_days(folder: Path) -> None:
    """Write a workbook and a recording of one machine; the workbook calls the probe otherwise."""
    heads, columns = columns_of(measured(1), probe_temperature="probe_C")
    rows = [list(map(float, row)) for row in zip(*columns, strict=True)]
    (folder / "monday.xlsx").write_bytes(workbook_bytes([SheetTable("bench", heads, rows)]))
    write_tdms(folder / "tuesday.tdms", measured(2))


@pytest.mark.usefixtures("confirmed")
def test_a_workbook_and_a_recording_are_one_record_and_their_columns_reach_a_text_that_changed(
    served: Workbench, page: Any, tmp_path: Path
) -> None:
    write_two_days(tmp_path)
    page.goto(served.address + "measure?file=pin.toml")
    page.set_input_files("#upload", [tmp_path / "monday.xlsx", tmp_path / "tuesday.tdms"])
    for name in ("data/monday.xlsx", "data/tuesday.tdms"):
        shown = page.get_by_role("region", name=name, exact=True)
        shown.get_by_text("30 rows").wait_for()
        assert shown.locator("svg").count() == 1
    page.get_by_role("button", name="Confirm that probe_C is probe_temperature, degC").click()
    page.locator("#kept", has_text="not kept yet").wait_for()
    file = served.folder / "pin.toml"
    file.write_text("# by another hand\n" + file.read_text(encoding="utf-8"), encoding="utf-8")
    page.get_by_role("button", name="Keep the columns").click()
    page.locator("#kept", has_text="kept in pin.toml").wait_for()
    kept = file.read_text(encoding="utf-8")
    assert kept.startswith("# by another hand\n")
    assert PROBE in kept
    page.set_viewport_size({"width": 390, "height": 844})
    assert [*axe(page), *sideways(page)] == []
    scrolled = "[...document.querySelectorAll('.scroll:has(.stacked)')].map(box => box.scrollWidth - box.clientWidth)"
    assert set(page.evaluate(scrolled)) == {0}
    page.set_viewport_size({"width": 1280, "height": 900})


@pytest.mark.usefixtures("confirmed")
def test_a_suspicion_is_tried_alone_and_a_cause_is_accepted_and_run(served: Workbench, page: Any) -> None:
    (served.folder / "data").mkdir(exist_ok=True)
    write_two_days(served.folder / "data")
    (served.folder / "pin.toml").write_text(f"{INPUTS}\n[columns]\n{PROBE}\n", encoding="utf-8")
    page.goto(served.address + "measure?file=pin.toml&data=data/monday.xlsx&data=data/tuesday.tdms")
    page.get_by_text("Switch candidates off").click()
    page.locator("#candidate-list").get_by_label("running in").uncheck()
    page.get_by_role("button", name="Diagnose", exact=True).click()
    page.wait_for_url(re.compile(r"/measure/diagnosis\?folder=runs%2Fmonday_some_causes"))
    assert "thermal drift or warm probe" in page.locator("section", has=page.locator("#verdict-title")).inner_text()
    stated = (served.folder / "runs" / "monday_some_causes" / "inputs.toml").read_text(encoding="utf-8")
    assert '"warm_probe"' in stated
    assert '"running_in"' not in stated
    page.get_by_role("link", name="Back to the measured files").click()
    page.get_by_label("What if it were this?").select_option(label="warm probe")
    page.get_by_role("button", name="Try it alone").first.click()
    page.wait_for_url(re.compile(r"/measure/diagnosis\?folder=runs%2Fmonday_only_warm_probe"))
    size = re.search(r"slope ([\d.]+) ", page.locator("#causes p").first.inner_text())
    assert size
    assert float(size[1]) == pytest.approx(SLOPE, rel=0.02)
    assert axe(page) == []
    page.get_by_label("Accept this cause as the inputs file").fill("warm.toml")
    page.get_by_role("button", name="Accept this cause").click()
    page.get_by_role("button", name="Write and open it").click()
    page.wait_for_url("**/edit?file=warm.toml")
    assert "[effects.warm_probe]" in (served.folder / "warm.toml").read_text(encoding="utf-8")
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator("#see-numbers").get_by_text("The last run, of these inputs, has decided it.").wait_for()
    assert (served.folder / "runs" / "warm" / "results.json").is_file()
