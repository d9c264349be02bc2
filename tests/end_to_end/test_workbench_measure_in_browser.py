"""From a measured file to a named cause in a browser: taken in, columns confirmed, diagnosed, accepted, planned."""

from __future__ import annotations

import csv
import io
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shared import ROOT
from workbench_browser import Workbench, axe, sideways

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SCREW = ROOT / "docs" / "examples" / "roller_screw_rubs"
"""A roller screw whose meshes rub 1.6 times as much as the model says; see its README."""


def measured(workbench: Workbench, browser: Browser) -> Any:
    """A page over the shipped inputs file of the screw."""
    if not (workbench.folder / "inputs.toml").exists():
        shutil.copy(SCREW / "inputs.toml", workbench.folder)
    return workbench.page(browser, "measure?file=inputs.toml")


def test_from_a_file_with_names_of_its_own_to_an_accepted_cause(
    workbench: Workbench, browser: Browser, tmp_path: Path
) -> None:
    lines = (SCREW / "measured.csv").read_text(encoding="utf-8").replace("friction_torque [N*m]", "torque_Nm")
    (tmp_path / "bench 7.csv").write_text(lines, encoding="utf-8")
    page = measured(workbench, browser)
    page.set_input_files("#upload", tmp_path / "bench 7.csv")
    page.get_by_role("button", name="Confirm that torque_Nm is friction_torque, N*m").click()
    page.get_by_label("torque_Nm is to the model").and_(
        page.locator(":has(option:checked[value=friction_torque])")
    ).wait_for()
    assert axe(page) == []
    page.get_by_role("button", name="Diagnose").click()
    page.wait_for_url("**/measure/diagnosis?**", timeout=60_000)
    kept = (workbench.folder / "inputs.toml").read_text(encoding="utf-8")
    assert kept.startswith((SCREW / "inputs.toml").read_text(encoding="utf-8"))
    assert 'torque_Nm = { name = "friction_torque", unit = "N*m" }' in kept
    assert "cause named" in page.get_by_role("heading", name="Verdict").text_content()
    assert "mesh friction" in page.locator("#causes h3").text_content()
    assert page.frame_locator("iframe.sheet").get_by_text("mesh friction").count()
    assert axe(page) == []
    page.set_viewport_size({"width": 390, "height": 844})
    assert sideways(page) == []
    page.get_by_label("Accept this cause as the inputs file").fill("rubbing.toml")
    page.get_by_role("button", name="Accept this cause").click()
    page.get_by_role("button", name="Write and open it").click()
    page.wait_for_url("**/edit?file=rubbing.toml")
    accepted = (workbench.folder / "rubbing.toml").read_text(encoding="utf-8")
    assert accepted == (workbench.folder / "runs" / "bench 7" / "extended.toml").read_text(encoding="utf-8")
    assert "[effects.mesh_friction]" in accepted
    assert (page.said, page.outside) == ([], [])
    page.context.close()


def test_rows_that_are_wrong_are_red_with_the_reason_and_an_experiment_is_planned(
    workbench: Workbench, browser: Browser, tmp_path: Path
) -> None:
    lines = (SCREW / "measured.csv").read_text(encoding="utf-8").splitlines()
    lines[6] = lines[6].replace(lines[6].split(",")[2], "12rpm")
    (tmp_path / "bad.csv").write_text("\n".join(lines), encoding="utf-8")
    page = measured(workbench, browser)
    page.set_input_files("#upload", tmp_path / "bad.csv")
    row = page.locator("tr.wrong")
    assert "'12rpm' holds more than a number" in row.locator(".reason").text_content()
    assert (row.locator("th").text_content(), row.locator("td.bad:not(.reason)").text_content()) == ("7", "12rpm")
    page.get_by_role("button", name="Diagnose").click()
    assert "bad.csv:7" in page.locator("#said p").text_content()
    page.get_by_role("group", name="Switch").or_(page.get_by_text("Plan an experiment before")).click()
    for cause in ("mesh friction", "sensor offset"):
        page.locator("#plan-causes").get_by_label(cause, exact=True).check()
    page.get_by_label("Standard deviation of one reading of friction_torque").fill("0.01 N*m")
    page.get_by_role("button", name="Plan the experiment").click()
    with page.expect_download(timeout=60_000) as taken:
        page.get_by_role("link", name="Download as CSV").click(timeout=60_000)
    rows = list(csv.reader(io.StringIO(Path(taken.value.path()).read_text(encoding="utf-8"))))
    assert rows[0][-1] == "friction_torque [N*m]"
    assert 2 <= len(rows) - 1 == page.locator("#plan tbody tr").count() <= 12
    assert page.outside == []
    page.context.close()
