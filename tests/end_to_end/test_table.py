"""calc table: what the gauge would show, row by row; numbers that read back exactly."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from shared import Answer, Calc

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
Table = Callable[..., Answer]


@pytest.fixture
def table(calc: Calc, tmp_path: Path) -> Table:
    """Write inputs and rows and run ``calc table`` on them."""

    def run(rows: str, inputs: str = "[inputs]\n", *more: str | Path, plugin: str | Path = PIN) -> Answer:
        (tmp_path / "given.toml").write_text(inputs, encoding="utf-8")
        (tmp_path / "rows.csv").write_text(rows, encoding="utf-8")
        return calc("table", plugin, "--inputs", "given.toml", "--rows", "rows.csv", *more)

    return run


def columns(text: str) -> dict[str, list[str]]:
    """Return a table by its header."""
    head, *rows = csv.reader(io.StringIO(text))
    return {name: [row[place] for row in rows] for place, name in enumerate(head)}


def test_numbers_read_back_exactly(table: Table, tmp_path: Path) -> None:
    """0.1 N and its neighbours differ in the seventeenth digit; every one of them comes through."""
    loads = [0.1, math.nextafter(0.1, 1), 1 / 3, 2 / 3 * 1e-7, 123456.78901234567]
    rows = "load [N]\n" + "".join(f"{value!r}\n" for value in loads)
    text = '[inputs]\narea = "1 m^2"\n[units]\npressure = "Pa"\n'
    answer = table(rows, text, "-o", "out.csv")
    assert (answer.code, answer.out) == (0, "")
    found = columns((tmp_path / "out.csv").read_text(encoding="utf-8"))
    assert [float(cell) for cell in found["pressure [Pa]"]] == loads  # on one square metre
    again = table((tmp_path / "out.csv").read_text(encoding="utf-8"), text)
    assert columns(again.out) == found  # results that stand in the file are calculated again


PROBED = "probe_temperature [degC],load [N]\n20,120\n30,120\n30,240\n"
PRESSED = "time [h],crank_angle [deg]\n7,0\n7.5,0\n9,0\n"


@pytest.mark.parametrize(
    ("rows", "effect", "result", "added"),
    [
        # a reading acts, and its condition is a column
        (PROBED, 'warm_probe]\nslope = "1.5 um/K"', "depth [um]", [0, 15, 15]),
        # running-in adds its whole depth after many lengths: 360 km against 100 m
        ("load [N]\n120\n", 'running_in]\nextra = "7 um"\nlength = "100 m"', "depth [um]", [7]),
        # time counts from the first row of the file
        (PRESSED, 'sensor_drift]\nslider_position = "4 um/h"', "slider_position [mm]", [0, 2e-3, 8e-3]),
    ],
)
def test_effects_are_seen_by_the_gauge(table: Table, rows: str, effect: str, result: str, added: list[float]) -> None:
    plugin = "press_linkage" if rows == PRESSED else PIN
    plain, off = (
        columns(table(rows, text, plugin=plugin).out)[result] for text in ("[inputs]\n", f"[effects.{effect}\n")
    )
    assert [float(one) - float(other) for one, other in zip(off, plain, strict=True)] == pytest.approx(added, abs=1e-9)


def test_a_plugin_that_declares_nothing_of_the_kind_has_a_gauge_that_may_be_off(calc: Calc, tmp_path: Path) -> None:
    """30 um of the kernel's own offset: seen by the gauge, and no part of what is calculated."""
    offset = '[effects.sensor_offset]\ndepth = "30 um"\n'
    depths = {}
    for name, text in (("plain", "[inputs]\n"), ("off", offset)):
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
        (tmp_path / "rows.csv").write_text("load [N]\n120\n240\n", encoding="utf-8")
        shown = columns(calc("table", PIN, "--inputs", f"{name}.toml", "--rows", "rows.csv").out)
        assert calc("run", PIN, "--inputs", f"{name}.toml", "-q").code == 0
        found = json.loads((tmp_path / "runs" / name / "results.json").read_text(encoding="utf-8"))
        depths[name] = ([float(cell) for cell in shown["depth [um]"]], found["results"], found["effects"])
    added = [one - other for one, other in zip(depths["off"][0], depths["plain"][0], strict=True)]
    assert added == pytest.approx([30, 30], abs=1e-9)
    assert depths["off"][1] == depths["plain"][1]
    assert depths["plain"][2] == {}
    assert depths["off"][2]["sensor_offset"]["depth"]["value"] == pytest.approx(30)
    assert "sensor offset" in (tmp_path / "runs" / "off" / "sheet.html").read_text(encoding="utf-8")


def test_the_calibrated_machine_is_shown(table: Table) -> None:
    text = '[calibrated]\nload = "140 N"\n'
    assert float(columns(table("time [h]\n1\n", text).out)["pressure [MPa]"][0]) == pytest.approx(5.0)


def test_a_row_that_is_impossible_is_empty_and_said_with_its_line(table: Table) -> None:
    answer = table("load [kN]\n0.14\n\n500\n0.28\n")
    assert answer.code == 0
    assert answer.err == "rows.csv:4: the contact flows: load exceeds hardness times area\n"
    assert columns(answer.out)["depth [um]"][1] == ""
    assert columns(answer.out)["load [kN]"] == ["0.14", "500", "0.28"]


def test_units_and_set_hold_for_the_table(table: Table) -> None:
    answer = table("load [N]\n140\n", '[units]\npressure = "bar"\n', "--set", "area=14 mm^2")
    assert float(columns(answer.out)["pressure [bar]"][0]) == pytest.approx(100.0)


def test_words_and_empty_cells(table: Table) -> None:
    """The reading decides a limit; an empty cell leaves what the inputs file says."""
    rows = "reading,crank_angle [deg]\nprinted,0\n,0\ncomplete,0\n"
    answer = table(rows, '[inputs]\nreading = "printed"\n', plugin="press_linkage")
    limits = [float(cell) for cell in columns(answer.out)["permitted_tilt [deg]"]]
    assert limits == pytest.approx([0.001324, 0.001324, 0.0013])
    answer = table("reading\nprintd\n", plugin="press_linkage")
    assert answer.code == 2
    assert answer.err.startswith("rows.csv:2: reading = 'printd' is not offered; choose 'complete' or 'printed'.")


def test_decimal_commas_come_back_as_points(table: Table, tmp_path: Path) -> None:
    """What is written is separated by commas, so it must read back: 100,5 N over 28 mm^2."""
    first = table("load [N];batch\n100,5;A\n1e2;B\n")
    found = columns(first.out)
    assert found["load [N]"] == ["100.5", "1e2"]
    assert found["batch"] == ["A", "B"]
    assert [float(cell) for cell in found["pressure [MPa]"]] == pytest.approx([100.5 / 28, 100 / 28], rel=1e-15)
    kept = [",".join(row[:2]) for row in csv.reader(io.StringIO(first.out))]
    assert columns(table("\n".join(kept)).out) == found
