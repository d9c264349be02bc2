"""Make the pictures of the workbench: ``python docs/images/workbench.py``.

It serves a copy of the example of the press that is off by 40 µm, changes, runs and diagnoses it in a browser, and
photographs the pages on the way. Needs a Chromium and the project's test extra.
"""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

import truing
from truing.report.pdf import find_browser, sandbox_arguments

EXAMPLE = Path(__file__).parents[1] / "examples" / "press_off_by_40_um"
COLOURS = 128
PATIENCE = 180_000
"""Milliseconds that a run or a diagnosis may take."""


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a folder; give the address that lets a browser in."""
    command = [sys.executable, "-m", "truing", "serve", str(folder), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield process.stdout.readline().split(": ", 1)[1].strip()
        process.send_signal(signal.SIGINT)


def photographed(page: Any, name: str, height: int) -> None:
    """Write the upper part of what the window shows, in few colours, beside this file."""
    page.wait_for_timeout(1500)
    shot = page.screenshot(clip={"x": 0, "y": 0, "width": page.viewport_size["width"], "height": height})
    picture = Image.open(BytesIO(shot)).convert("RGB")
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(Path(__file__).with_name(name), optimize=True)


def ended(page: Any) -> None:
    """Wait until a job is done; close its line."""
    page.locator(".job", has_text="done").last.wait_for(timeout=PATIENCE)
    page.get_by_role("button", name="Close").last.click()


def edited(page: Any, base: str) -> None:
    """Turn the cranks of the press, and run it."""
    page.goto(f"{base}edit?file=inputs.toml")
    page.get_by_text("3557").first.wait_for()
    page.get_by_label("Search the fields").fill("crank")
    page.locator("[id='inputs/crank_angle']").fill("30 deg")
    page.get_by_text("3547").first.wait_for()
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_role("button", name="Run", exact=True).click()
    ended(page)
    page.get_by_text("Sliders", exact=True).click()
    photographed(page, "workbench.png", 860)


def measured(page: Any, base: str) -> None:
    """Open the record, and diagnose it."""
    page.goto(f"{base}measure?data=measured.csv")
    page.get_by_role("heading", name="measured.csv").wait_for()
    page.get_by_role("heading", name="measured.csv").evaluate("node => scrollTo(0, node.offsetTop - 60)")
    photographed(page, "workbench_measure.png", 760)
    page.get_by_role("button", name="Diagnose", exact=True).click()
    page.wait_for_url("**/measure/diagnosis?*", timeout=PATIENCE)
    photographed(page, "workbench_diagnosis.png", 700)


def listed(page: Any, base: str) -> None:
    """Show the runs and the diagnosis."""
    page.goto(f"{base}runs")
    photographed(page, "workbench_runs.png", 300)


def on_a_phone(browser: Any, opening: str, base: str) -> None:
    """Show the results of the press on a phone, in the dark."""
    page = browser.new_page(viewport={"width": 390, "height": 760}, color_scheme="dark")
    page.goto(opening)
    page.goto(f"{base}edit?file=inputs.toml")
    page.get_by_role("tab", name="Results").click()
    page.get_by_text("3547").first.wait_for()
    photographed(page, "workbench_phone.png", 700)


def main() -> None:
    """Write every picture."""
    with tempfile.TemporaryDirectory() as desk, sync_playwright() as player:
        folder = Path(desk) / "my_press"
        folder.mkdir()
        for name in ("inputs.toml", "measured.csv"):
            shutil.copy(EXAMPLE / name, folder)
        as_drawn = folder / "runs" / "as_drawn"
        truing.load("press_linkage").run(folder / "inputs.toml", output=as_drawn, progress=False)
        with served(folder) as opening:
            browser = player.chromium.launch(executable_path=str(find_browser()), args=sandbox_arguments())
            base = opening.partition("?")[0]
            page = browser.new_page(viewport={"width": 1280, "height": 860}, color_scheme="light")
            page.goto(opening)
            edited(page, base)
            measured(page, base)
            listed(page, base)
            on_a_phone(browser, opening, base)
            browser.close()


if __name__ == "__main__":
    main()
