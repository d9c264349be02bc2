"""The numbers on the theory page of the gearing are those that the calculation gives."""

import re
from pathlib import Path
from typing import Any

import pytest

from rv_gearing.duty import centre_distance_window, efficiency_of, mesh_efficiency, output_torque, ratio_of
from rv_gearing.groups import search
from rv_gearing.loads import load_of
from rv_gearing.model import RV_GEARING

PAGE = (Path(__file__).parents[2] / "docs" / "explanation" / "rv_gearing.md").read_text(encoding="utf-8")
WORDS = " ".join(PAGE.split())
PAPER = RV_GEARING.inputs()


def row(start: str) -> list[str]:
    """The cells of the row of a table that starts so, without its first cell."""
    line = next(text for text in PAGE.splitlines() if text.startswith(f"| {start}"))
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


@pytest.mark.parametrize(
    ("start", "inputs"),
    [
        ("40 | 0.01 | `whole`", {}),
        ("40 | 0.04", {"ratio_tolerance": 0.04}),
        ("even 30 to 60", {"fewest_pins": 30, "most_pins": 60}),
        ("even 20 to 80", {"fewest_pins": 20, "most_pins": 80}),
        ("40 | 0.01 | `one_pin_circle`", {"window": "one_pin_circle"}),
    ],
)
def test_the_counts_of_the_readings(start: str, inputs: dict[str, Any]) -> None:
    assert row(start)[-1] == str(len(search(RV_GEARING.inputs(**inputs))))


def test_the_list_of_groups() -> None:
    shown = {}
    for line in PAGE.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if re.match(r"\| \d+ \| \d+/\d+ \|", line):
            for place in (0, 4):
                if cells[place]:
                    shown[int(cells[place])] = cells[place + 1 : place + 4]
    groups = search(PAPER)
    assert len(shown) == len(groups) == 25
    for place, (number, cells) in enumerate(sorted(shown.items())):
        assert number == place + 1
        sun, planet, centre = groups.sun[place], groups.planet[place], groups.centre_distance[place]
        assert cells == [f"{sun:.0f}/{planet:.0f}", f"{groups.ratio[place]:.4f}", f"{1e3 * centre:.3f}"]


def test_the_ratios_of_the_catalogue() -> None:
    pairs = [tuple(float(text) for text in cell.split("/")) for cell in row("$Z_1/Z_2$ | 25/50")]
    assert {sum(pair) for pair in pairs} == {75}
    assert row("$i$ | 81") == [f"{ratio_of(sun, planet, 40.0):.4f}" for sun, planet in pairs]
    groups = search(PAPER)
    assert f"centre distance {1e3 * groups.centre_distance[0]:.3f} mm" in WORDS
    low, _ = centre_distance_window(PAPER, groups.torque[0])
    assert groups.centre_distance[0] == min(groups.centre_distance)
    assert f"which begins at {1e3 * low:.2f} mm" in WORDS


def test_efficiency_and_torque() -> None:
    mesh = mesh_efficiency(PAPER, 55.0 / 20.0, 40.0)
    whole = efficiency_of(PAPER, 20.0, 55.0, 40.0)
    torque = output_torque(PAPER, whole)
    assert rf"it is {mesh:.4f}, so $\eta = {whole:.4f}$ and $T = {torque:.1f}$ N·m" in WORDS
    catalogue = 1078.0 / (torque / whole)
    assert f"is an efficiency of {catalogue:.3f}; equation 6 gives {whole:.3f}" in WORDS
    sizes = [factor * (1078e3 ** (1 / 3)) for factor in (0.85, 1.3)]
    assert f"1078 N·m gives {sizes[0]:.0f} to {sizes[1]:.0f} mm" in WORDS


def test_the_load_of_the_example() -> None:
    load = load_of(PAPER)
    assert f"$n_1 = {60 * load.input_speed:.0f}$ r/min" in WORDS
    assert f"$T_1 = {load.sun_torque:.2f}$ N·m" in WORDS
    assert f"$F_t = {load.tangential_force:.1f}$ N" in WORDS
    order = 1.0 - 1.0 / load.ratio
    assert f"has the order {order:.3f} of the input shaft" in WORDS


def test_every_effect_has_its_row() -> None:
    named = set(re.findall(r"^\| `(\w+)` \| [^|]+ \| [^|]+ \| [^|]+ \|$", PAGE, re.MULTILINE))
    assert set(RV_GEARING.effects) <= named
