"""The numbers on the theory page of the gearing and in its findings are those that the calculation gives."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rv_gearing.geometry import load_of
from rv_gearing.groups import (
    RATIOS,
    catalogue_table,
    centre_distance_window,
    efficiency_of,
    mesh_efficiency,
    output_torque,
    ratio_of,
    search,
)
from rv_gearing.material import steel_of
from rv_gearing.model import RV_GEARING
from rv_gearing.published import FINDINGS
from rv_gearing.quantities import Gearing
from rv_gearing.rating import rv_gearing

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
    groups = search(RV_GEARING.inputs(**inputs))
    count, *more = row(start)[-1].split(", of which ")
    assert count == str(len(groups))
    for text in more:
        assert text == f"{sum(groups.ratio == 111)} with just 111"


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
    load = load_of(PAPER).duty
    assert f"$n_1 = {60 * load.sun_speed:.0f}$ r/min" in WORDS
    assert f"$T_1 = {load.sun_torque:.2f}$ N·m" in WORDS
    assert f"$F_t = {load.tangential_force:.1f}$ N" in WORDS
    order = 1.0 - 1.0 / load.ratio
    assert f"has the order {order:.3f} of the input shaft" in WORDS


FOUND = rv_gearing(PAPER)


def named(results: Any, name: str) -> float:
    """The result of this name, wherever it stands among the parts."""
    known = vars(results)
    if name in known:
        return float(known[name])
    parts = [part for part in known.values() if hasattr(part, "__dataclass_fields__")]
    return next((value for value in (named(part, name) for part in parts) if not np.isnan(value)), np.nan)


@pytest.mark.parametrize(
    ("symbols", "name", "digits"),
    [
        ("v", "pitch_line_velocity", 3), (r"\varepsilon_\alpha", "contact_ratio", 4), ("N", "resonance_ratio", 4),
        ("K_V", "dynamic_factor", 4), (r"K_{H\beta}", "face_factor", 4), (r"K_{F\beta}", "face_factor_bending", 4),
        (r"K_{H\alpha} = K_{F\alpha}", "transverse_factor", 4), (r"K_{H\alpha} = K_{F\alpha}",
        "transverse_factor_bending", 4), ("K_{Fp}", "planet_factor_bending", 2),
    ],
)  # fmt: skip
def test_the_factors_of_the_example(symbols: str, name: str, digits: int) -> None:
    assert f"${symbols} = {named(FOUND, name):.{digits}f}$" in WORDS


@pytest.mark.parametrize("gear", ["sun 20", "planet 55"])
def test_the_stresses_of_the_example(gear: str) -> None:
    found = getattr(FOUND, gear.split()[0])
    values = [found.root_stress, found.permitted_root_stress, found.contact_stress, found.permitted_contact_stress]
    factors = [f"{found.root.form_factor:.4f}", f"{found.root.stress_correction:.4f}"]
    assert row(gear) == [*factors, *(f"{1e-6 * value:.1f}" for value in values)]


def test_what_is_said_of_the_example_and_of_group_5() -> None:
    sun = FOUND.sun
    assert "half a percent to spare" in WORDS
    assert 1.0 - sun.contact_stress / sun.permitted_contact_stress == pytest.approx(0.005, abs=6e-4)
    assert 2.7 < sun.permitted_root_stress / sun.root_stress < 3.2
    fifth = rv_gearing(RV_GEARING.inputs(group=5))
    roots = [f"{1e-6 * gear.root_stress:.1f}" for gear in (fifth.sun, fifth.planet)]
    flanks = [f"{1e-6 * gear.contact_stress:.1f}" for gear in (fifth.sun, fifth.planet)]
    assert f"{roots[0]} and {roots[1]} MPa at the roots, {flanks[0]} and {flanks[1]} MPa at the flanks" in WORDS


def flank_margin(**inputs: Any) -> str:
    """Margin of the flank of the sun, in percent as the page prints it."""
    sun = rv_gearing(RV_GEARING.inputs(**inputs)).sun
    return f"{100 * float(1 - sun.contact_stress / sun.permitted_contact_stress):.1f} %".replace("-", "−")


def test_what_is_left_by_other_readings() -> None:
    assert f"as the paper has it, {flank_margin(single_contact=False)} are left" in WORDS
    assert f"instead of the calculated one {flank_margin(stated_face_factor=1.2)}." in WORDS


@pytest.mark.parametrize("pair", ["25/50", "20/55", "18/57", "15/60", "14/61"])
def test_the_strength_of_the_catalogue_ratios(pair: str) -> None:
    sun, planet = (float(text) for text in pair.split("/"))
    shift, margin = row(f"{pair} |")
    size = float(shift.strip("±"))
    teeth = {"sun_teeth": sun, "planet_teeth": planet, "shift_sun": size, "shift_planet": -size}
    assert margin == flank_margin(**teeth)
    undercut = 1 - sun / 2 * np.sin(np.radians(20)) ** 2  # of a rack whose straight flank is one module high
    assert size >= undercut


def test_the_outer_point_of_single_contact() -> None:
    diameter = FOUND.sun.root.outer_diameter / PAPER.module
    assert f"{diameter:.4f} modules for the sun of 20 teeth, where the tip is at 22" in WORDS


@pytest.mark.parametrize(("material", "place"), [("case_hardened", 0), ("through_hardened", 1), ("nitrided", 2)])
def test_the_constants_of_the_materials(material: str, place: int) -> None:
    steel = steel_of(RV_GEARING.inputs(material=material))
    assert row(r"$Z_{NT}$ at most")[place] == f"{steel.contact_life_most:g}"
    knee = {5e7: r"5\cdot10^7", 2e6: r"2\cdot10^6"}[float(steel.contact_life_knee)]
    assert row(r"$Z_{NT}$ limited")[place] == f"$({knee}/N)^{{{steel.contact_life_slope:g}}}$"
    assert row(r"$Z_{NT}$ beyond")[place] == f"$({knee}/N)^{{{steel.contact_life_tail:g}}}$"
    assert row(r"$Y_{NT}$ at most")[place] == f"{steel.bending_life_most:g}"
    assert row(r"$Y_{NT}$ to")[place] == f"{steel.bending_life_slope:g}"
    size = f"${steel.size_constant:g} - {steel.size_slope:g}m_n \\ge {steel.size_least:g}$"
    assert row("$Y_X$, at most 1")[place] == size
    assert row("$Y_{RrelT}$ below")[place] == f"{steel.surface_smooth:g}"


# Findings


def test_the_catalogue_stands_on_the_sheet_with_one_centre_distance() -> None:
    table = catalogue_table(Gearing())
    assert [row[0] for row in table.rows] == [ratio for ratio, *_ in RATIOS] == [81.0, 111.0, 127.7, 161.0, 175.2]
    assert {row[6] for row in table.rows} == {46.875}
    assert all(abs(float(row[5] or 0)) < 0.05 for row in table.rows)


def said(title: str) -> str:
    return next(finding.text for finding in FINDINGS if finding.title.startswith(title))


def test_the_numbers_in_the_findings_are_ours() -> None:
    first, last = (rv_gearing(RV_GEARING.inputs(group=number)) for number in (1, 25))
    ends = f"{float(first.sun.contact_stress) / 1e6:.0f} to {float(last.sun.contact_stress) / 1e6:.0f} MPa"
    assert ends in said("The first group")
    grown = float(last.mesh.centre_distance) / float(first.mesh.centre_distance) - 1
    assert f"grows by {100 * grown:.0f} %" in said("The first group")
    plain = rv_gearing(RV_GEARING.inputs(single_contact=False))
    left = [1 - float(one.sun.contact_stress) / float(one.sun.permitted_contact_stress) for one in (first, plain)]
    assert f"with it {100 * left[0]:.1f} %" in said("Contact stress at the pitch point")
    assert f"without it {100 * left[1]:.1f} %" in said("Contact stress at the pitch point")
    assert f"{100 * (float(first.contact.single_contact_factor_sun) - 1):.1f} % more" in said("Contact stress")
    told = said("Small gears")
    assert f"factor is {float(first.face.face_factor):.2f}" in told
    assert f"under {float(first.duty.line_load) / 1e3:.0f} N/mm" in told
    aligned = rv_gearing(RV_GEARING.inputs(stated_face_factor=1.2))
    lower = 1 - float(aligned.sun.contact_stress) / float(first.sun.contact_stress)
    assert f"takes {100 * lower:.0f} % off" in told
    factors = (
        first.sun.root.form_factor, first.sun.root.stress_correction, first.sun.root.form_factor_outer,
        first.sun.root.stress_correction_outer,
    )  # fmt: skip
    words = [f"{float(factor):.2f}" for factor in factors]
    assert f"{words[0]} and {words[1]} by one, {words[2]} and {words[3]} by the other" in said("Two conventions")
    assert f"{float(first.duty.sun_torque):.2f} instead of {float(first.duty.output_torque):.1f} N m" in said(
        "The torque"
    )
