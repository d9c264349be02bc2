"""The numbers on the theory page of the gearing and in its findings are those that the calculation gives."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from switched import shown

from pages import Page, number
from rv_gearing import groups as searched
from rv_gearing.geometry import load_of
from rv_gearing.groups import RATIOS, catalogue_table, search
from rv_gearing.material import steel_of
from rv_gearing.model import RV_GEARING
from rv_gearing.published import FINDINGS
from rv_gearing.quantities import Gearing
from rv_gearing.rating import rv_gearing
from rv_gearing.shaping import Shifts
from truing.calculation import calculate
from truing.setup import default_setup
from truing.units import from_si

PAGE = Page("rv_gearing")
PAPER = RV_GEARING.inputs()


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
    count, *more = PAGE.row(start)[-1].split(", of which ")
    assert count == str(len(groups))
    for text in more:
        assert text == f"{sum(groups.ratio == 111)} with just 111"


def test_the_list_of_groups() -> None:
    """Two groups to a row: the first thirteen on the left, the others on the right."""
    groups = search(PAPER)
    assert len(groups) == 25
    for place, (sun, planet, ratio, centre) in enumerate(
        zip(groups.sun, groups.planet, groups.ratio, groups.centre_distance, strict=True)
    ):
        row = " | ".join(PAGE.row(f"{place % 13 + 1} | ", after="| no. | $Z_1/Z_2$"))
        assert f"{sun:.0f}/{planet:.0f} | {ratio:.4f} | {1e3 * centre:.3f}" in row
        assert place < 13 or f"| {place + 1} |" in row


def test_the_ratios_of_the_catalogue() -> None:
    pairs = [tuple(float(text) for text in cell.split("/")) for cell in PAGE.row("$Z_1/Z_2$ | 25/50")]
    assert {sum(pair) for pair in pairs} == {75}
    assert PAGE.row("$i$ | 81") == [f"{searched.ratio_of(sun, planet, 40.0):.4f}" for sun, planet in pairs]
    groups = search(PAPER)
    low, _ = searched.centre_distance_window(PAPER, groups.torque[0])
    assert groups.centre_distance[0] == min(groups.centre_distance)
    PAGE.says(f"centre distance {1e3 * groups.centre_distance[0]:.3f} mm", f"which begins at {1e3 * low:.2f} mm")


def test_efficiency_torque_and_load_of_the_example() -> None:
    mesh = searched.mesh_efficiency(PAPER, 55.0 / 20.0, 40.0)
    whole = searched.efficiency_of(PAPER, 20.0, 55.0, 40.0)
    torque = searched.output_torque(PAPER, whole)
    sizes = [factor * (1078e3 ** (1 / 3)) for factor in (0.85, 1.3)]
    load = load_of(PAPER).duty
    PAGE.says(
        rf"it is {mesh:.4f}, so $\eta = {whole:.4f}$ and $T = {torque:.1f}$ N·m",
        f"is an efficiency of {1078.0 / (torque / whole):.3f}; equation 6 gives {whole:.3f}",
        f"1078 N·m gives {sizes[0]:.0f} to {sizes[1]:.0f} mm",
        f"$n_1 = {60 * load.sun_speed:.0f}$ r/min",
        f"$T_1 = {load.sun_torque:.2f}$ N·m",
        f"$F_t = {load.tangential_force:.1f}$ N",
        f"has the order {1.0 - 1.0 / load.ratio:.3f} of the input shaft",
    )


FOUND = rv_gearing(PAPER)
NAMED = RV_GEARING.read_results(FOUND)


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
    PAGE.says(f"${symbols} = {float(NAMED[name]):.{digits}f}$")


@pytest.mark.parametrize("gear", ["sun 20", "planet 55"])
def test_the_stresses_of_the_example(gear: str) -> None:
    found = getattr(FOUND, gear.split()[0])
    values = [found.root_stress, found.permitted_root_stress, found.contact_stress, found.permitted_contact_stress]
    factors = [f"{found.root.form_factor:.4f}", f"{found.root.stress_correction:.4f}"]
    assert PAGE.row(gear) == [*factors, *(f"{1e-6 * value:.1f}" for value in values)]


def flank_margin(**inputs: Any) -> str:
    """Margin of the flank of the sun, in percent as the page prints it."""
    sun = rv_gearing(RV_GEARING.inputs(**inputs)).sun
    return f"{number(100 * float(1 - sun.contact_stress / sun.permitted_contact_stress), 1)} %"


def test_what_is_said_of_the_example_of_group_5_and_of_other_readings() -> None:
    sun = FOUND.sun
    assert 1.0 - sun.contact_stress / sun.permitted_contact_stress == pytest.approx(0.005, abs=6e-4)
    assert 2.7 < sun.permitted_root_stress / sun.root_stress < 3.2
    fifth = rv_gearing(RV_GEARING.inputs(group=5))
    roots = [f"{1e-6 * gear.root_stress:.1f}" for gear in (fifth.sun, fifth.planet)]
    flanks = [f"{1e-6 * gear.contact_stress:.1f}" for gear in (fifth.sun, fifth.planet)]
    PAGE.says(
        "half a percent to spare",
        f"{roots[0]} and {roots[1]} MPa at the roots, {flanks[0]} and {flanks[1]} MPa at the flanks",
        f"as the paper has it, {flank_margin(single_contact=False)} are left",
        f"instead of the calculated one {flank_margin(stated_face_factor=1.2)}.",
        f"{sun.root.outer_diameter / PAPER.module:.4f} modules for the sun of 20 teeth, where the tip is at 22",
    )


@pytest.mark.parametrize("pair", ["25/50", "20/55", "18/57", "15/60", "14/61"])
def test_the_strength_of_the_catalogue_ratios(pair: str) -> None:
    sun, planet = (float(text) for text in pair.split("/"))
    shift, margin = PAGE.row(f"{pair} |")
    size = float(shift.strip("±"))
    teeth = {"sun_teeth": sun, "planet_teeth": planet, "shift_sun": size, "shift_planet": -size}
    assert margin == flank_margin(**teeth)
    undercut = 1 - sun / 2 * np.sin(np.radians(20)) ** 2  # of a rack whose straight flank is one module high
    assert size >= undercut


@pytest.mark.parametrize(("material", "place"), [("case_hardened", 0), ("through_hardened", 1), ("nitrided", 2)])
def test_the_constants_of_the_materials(material: str, place: int) -> None:
    steel = steel_of(RV_GEARING.inputs(material=material))
    assert PAGE.row(r"$Z_{NT}$ at most")[place] == f"{steel.contact_life_most:g}"
    knee = {5e7: r"5\cdot10^7", 2e6: r"2\cdot10^6"}[float(steel.contact_life_knee)]
    assert PAGE.row(r"$Z_{NT}$ limited")[place] == f"$({knee}/N)^{{{steel.contact_life_slope:g}}}$"
    assert PAGE.row(r"$Z_{NT}$ beyond")[place] == f"$({knee}/N)^{{{steel.contact_life_tail:g}}}$"
    assert PAGE.row(r"$Y_{NT}$ at most")[place] == f"{steel.bending_life_most:g}"
    assert PAGE.row(r"$Y_{NT}$ to")[place] == f"{steel.bending_life_slope:g}"
    size = f"${steel.size_constant:g} - {steel.size_slope:g}m_n \\ge {steel.size_least:g}$"
    assert PAGE.row("$Y_X$, at most 1")[place] == size
    assert PAGE.row("$Y_{RrelT}$ below")[place] == f"{steel.surface_smooth:g}"


# Findings


def test_the_catalogue_stands_on_the_sheet_with_one_centre_distance() -> None:
    table = catalogue_table(Gearing())
    assert [row[0] for row in table.rows] == [ratio for ratio, *_ in RATIOS] == [81.0, 111.0, 127.7, 161.0, 175.2]
    assert {row[6] for row in table.rows} == {46.875}
    assert all(abs(float(row[5] or 0)) < 0.05 for row in table.rows)


def test_the_numbers_in_the_findings_are_ours() -> None:
    told = " ".join(finding.text for finding in FINDINGS)
    first, last = (rv_gearing(RV_GEARING.inputs(group=group)) for group in (1, 25))
    plain, aligned = (
        rv_gearing(RV_GEARING.inputs(**each)) for each in ({"single_contact": False}, {"stated_face_factor": 1.2})
    )
    stress = [1e-6 * float(each.sun.contact_stress) for each in (first, last, aligned)]
    left = [1 - float(each.sun.contact_stress) / float(each.sun.permitted_contact_stress) for each in (first, plain)]
    root = first.sun.root
    factors = (root.form_factor, root.stress_correction, root.form_factor_outer, root.stress_correction_outer)
    numbers = [
        f"{stress[0]:.0f} to {stress[1]:.0f} MPa",
        f"grows by {100 * (float(last.mesh.centre_distance) / float(first.mesh.centre_distance) - 1):.0f} %",
        f"with it {100 * left[0]:.1f} %",
        f"without it {100 * left[1]:.1f} %",
        f"{100 * (float(first.contact.single_contact_factor_sun) - 1):.1f} % more",
        f"factor is {float(first.face.face_factor):.2f}",
        f"under {float(first.duty.line_load) / 1e3:.0f} N/mm",
        f"takes {100 * (1 - stress[2] / stress[0]):.0f} % off",
        "{:.2f} and {:.2f} by one, {:.2f} and {:.2f} by the other".format(*(float(factor) for factor in factors)),
        f"{float(first.duty.sun_torque):.2f} instead of {float(first.duty.output_torque):.1f} N m",
    ]
    assert [each for each in numbers if each not in told] == []


def test_heat_second_stage_and_shifts_of_the_example() -> None:
    """Numbers of the page that no table holds, as the example gives them."""
    fields = RV_GEARING.own_result_fields
    answers = RV_GEARING.read_results(rv_gearing(RV_GEARING.inputs(group=1)))
    told = {name: float(np.asarray(from_si(answers[name], fields[name].unit))) for name in fields if name in answers}
    dragging = shown(RV_GEARING, "pin_drag", RV_GEARING.inputs(group=1), friction=0.02, film_speed=1e6)
    dragged = told["efficiency"] - dragging["efficiency"]
    page = " ".join(PAGE.text.split())
    for words in (
        f"contact {told['contact_rise']:.1f} K above the oil, where {told['permitted_contact_rise']:.0f} K are "
        "permitted",
        f"$\\mu = 0.02$ takes {dragged:.3f} of the efficiency {told['efficiency']:.3f} of the example",
        f"it is {told['integral_rise']:.1f} K of {told['scuffing_integral_rise']:.0f} K",
        f"with 1 the example's contact would be {told['contact_rise'] - told['bulk_rise'] / 3:.1f} K above the oil "
        f"instead of {told['contact_rise']:.1f}", f"film is {told['film_ratio']:.3f} of the roughness",
        f"{100 * (1 - 0.06 * told['normal_curvature']**0.25 / 0.099):.0f} % less on the small teeth of the example",
        f"with 0.05 it is {told['pin_loss_efficiency']:.4f}",
        f"has {told['crank_load'] / 1e3:.1f} kN at most and $P$ = {told['equivalent_load'] / 1e3:.2f} kN at "
        f"{told['crank_speed']:.0f} r/min: 6000 h need $C$ = {told['needed_rating']:.1f} kN",
    ):  # fmt: skip
        assert words in page, words
    widths = []
    for study in (Shifts(), Shifts(free_centre=True)):
        setup = replace(default_setup(RV_GEARING, ratio_tolerance=1e-4), studies=[study])
        widths.append(dict(calculate(setup).outcomes["shifts"].as_json())["groups"][0])
    one, free = widths
    stated, kept = one["face_width_as_stated"]["value"], one["face_width"]["value"]
    saved = 100 * (1 - kept / stated)
    assert f"{stated:.2f} mm without shift and {kept:.2f} mm with ±{one['shift_sun']:g}, {saved:.0f} % less" in page
    assert f"{free['face_width']['value']:.2f} mm at {free['shift_sun']:g} and {free['shift_planet']:g}" in page
