"""A record of 100,000 rows in the workbench: how long until a browser shows it, and for how long it is stuck meanwhile.

Run it: ``python -m pytest tests/benchmarks/bench_workbench_records.py -s``. Times are those of the wall, from the
choice of the file to its table and its figure: first with a worker that has loaded nothing yet, then again.
"""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from shared import ROOT
from workbench_browser import Workbench

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SCREW = ROOT / "docs" / "examples" / "roller_screw_rubs"
ROWS = 100_000
HEADER = "time [h],axial_load [kN],screw_speed [r/min],temperature [degC],screw_angle [deg],friction_torque [N*m]"
WITHIN = 2.0
"""Seconds in which the preview is to be there on a machine that does nothing else."""
STUCK = """() => { let last = performance.now(); window.stuck = 0;
    const beat = now => { window.stuck = Math.max(window.stuck, now - last); last = now; requestAnimationFrame(beat); };
    requestAnimationFrame(beat); }"""


def shown(page: Any, box: str) -> float:
    """Choose a file; return the seconds until its columns and its figure are there."""
    start = time.perf_counter()
    page.locator(f"input[value='{box}']").check()
    page.locator(".file-columns").wait_for(timeout=60_000)
    page.locator(".figure svg").wait_for(timeout=60_000)
    return time.perf_counter() - start


def test_a_long_record_is_previewed(workbench: Workbench, browser: Browser) -> None:
    draw = np.random.default_rng(8)
    columns = [np.arange(ROWS) / 3600, *draw.uniform(1, 20, (5, ROWS))]
    rows = "\n".join(",".join(f"{cell:.5g}" for cell in row) for row in np.array(columns).T.tolist())
    shutil.copy(SCREW / "inputs.toml", workbench.folder)
    for name in ("first.csv", "second.csv"):
        (workbench.folder / name).write_text(f"{HEADER}\n{rows}\n", encoding="utf-8")
    page = workbench.page(browser)
    page.goto(f"{workbench.address}measure?file=inputs.toml")
    page.evaluate(STUCK)
    first = shown(page, "first.csv")
    page.locator("input[value='first.csv']").uncheck()
    page.locator(".file-columns").wait_for(state="detached")
    second = shown(page, "second.csv")
    stuck = page.evaluate("window.stuck")
    points = page.locator(".figure path.line").get_attribute("d").count("L") + 1
    print(f"\n{ROWS} rows: shown {first:.2f} s after a start, {second:.2f} s afterwards; ", end="")
    print(f"{points} points drawn, the page was stuck for {stuck:.0f} ms at most; wanted: {WITHIN:g} s")
    assert points < ROWS / 50
