"""The measured roller screw of the manual: made again byte for byte, and diagnosed to what its README says."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import make_roller_screw_example
import pytest
from measured import documented, names
from shown_in_docs import EXAMPLES

EXAMPLE = EXAMPLES / "roller_screw_rubs"


def diagnosed(file: str, folder: Path) -> dict[str, Any]:
    """What is said of one of the records."""
    desk = folder / "desk"
    shutil.copytree(EXAMPLE, desk)
    return documented(desk, "roller_screw_shift", file)


def test_the_shipped_rows_are_those_that_the_script_makes() -> None:
    for name, text in make_roller_screw_example.files().items():
        assert (EXAMPLE / name).read_bytes() == text.encode()


def test_one_way_at_one_load_friction_is_a_gauge_that_is_off(tmp_path: Path) -> None:
    found = diagnosed("one_way.csv", tmp_path)
    (cause,) = found["causes"]
    assert {cause["effect"], *cause["same_as"]} == {"sensor_offset", "mesh_friction"}
    asked = found["next"][0]
    assert set(asked["separates"]) == {"sensor_offset", "mesh_friction"}
    assert asked["settings"]["axial_load"]["value"] == pytest.approx(20.0)
    assert asked["settings"]["screw_speed"]["value"] < 0


def test_to_and_fro_under_any_load_it_is_friction(tmp_path: Path) -> None:
    (stated,) = re.findall(r"\*\*([\d.]+)\*\*", (EXAMPLE / "README.md").read_text(encoding="utf-8"))
    found = diagnosed("measured.csv", tmp_path)
    assert (found["verdict"], found["unique"]) == ("named", True)
    assert names(found) == ["mesh_friction"]
    low, high = found["causes"][0]["unknowns"]["factor"]["interval95"]
    assert low < float(stated) < high
