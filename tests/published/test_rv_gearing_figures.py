"""Studies and figures of the gearing: what they list and draw is what holds.

Teeth are compared with the tangent of 30 degrees found on their own outline, the mesh with the contact ratio, and lists
with single calculations.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.path import Path as Outline
from scipy.stats import hypergeom

from drawn import words
from gear_geometry.roots import Rack, external_root
from rv_gearing import sheet
from rv_gearing.figures import front_figure, groups_figure, heat_figure, meshing_of, notched_of, stresses_figure
from rv_gearing.geometry import half_space, tooth, trochoid, undercut
from rv_gearing.groups import CHOICE, MEETING, SIZES, STRENGTH, FoundGroups, GroupColumn, GroupSearch, listed
from rv_gearing.model import RV_GEARING
from rv_gearing.rating import SAFETIES, Capacity, Reserve, Safeties, rating, rv_gearing
from truing import Swept, Table, TruingError
from truing.calculation import Calculation, calculate
from truing.setup import default_setup

RACK = Rack(dedendum=1.25, fillet=0.38, pressure_angle=np.radians(20.0))


def run(*studies: Any, **inputs: Any) -> Calculation:
    return calculate(replace(default_setup(RV_GEARING, **inputs), studies=studies))


def found(calculation: Calculation) -> FoundGroups:
    outcome = calculation.outcomes["search"]
    assert isinstance(outcome, FoundGroups)
    return outcome


# ---- the list of groups -------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def whole() -> Calculation:
    """All studies of the list and of the safeties, with their defaults."""
    wanted = {"search", "capacity", "load", "face_width"}
    return run(*(study for study in RV_GEARING.studies if study.name in wanted))


@pytest.mark.parametrize("number", [1, 5, 13, 25])
def test_strength_in_the_list_is_that_of_a_calculation_of_its_own(whole: Calculation, number: int) -> None:
    alone = RV_GEARING.read_results(rv_gearing(RV_GEARING.inputs(group=number)))
    for name in STRENGTH:
        assert found(whole).strength[name][number - 1] == pytest.approx(float(alone[name]), rel=1e-12)


def test_the_list_is_a_result_of_the_run(whole: Calculation) -> None:
    assert (whole.answers["group_count"], whole.answers["exact_count"]) == (25, 5)
    assert whole.answers["group_number"].tolist() == list(range(1, 26))
    assert whole.answers["group_sun_teeth"][4] == 23
    assert whole.answers["group_planet_teeth"][4] == 63
    for name in (*SIZES[2:], *MEETING, *STRENGTH, *CHOICE):
        np.testing.assert_array_equal(whole.answers[f"group_{name}"], found(whole).column(name))


@pytest.mark.parametrize("column", ["group", *SIZES, *MEETING, *STRENGTH])
@pytest.mark.parametrize("descending", [False, True])
def test_the_list_is_sorted_by_any_column(whole: Calculation, column: GroupColumn, descending: bool) -> None:
    told = replace(found(whole), sort_by=column, descending=descending).sorted()
    key = np.abs(told.column(column)) if column == "deviation" else told.column(column)
    assert np.all(np.diff(-key if descending else key) >= 0)
    assert sorted(told.numbers) == list(range(1, 26))
    at = told.numbers.tolist().index(7.0)
    assert (told.groups.sun[at], told.groups.planet[at]) == (25, 69)


def test_the_better_groups_come_first_where_the_list_is_sorted_so() -> None:
    calculation = run(GroupSearch(sort_by="preference"))
    told = found(calculation)
    assert told.numbers[:4].tolist() == [4, 8, 15, 21]
    entry = told.as_json()
    assert entry["groups"]["preference"]["values"][:5] == [1, 1, 1, 1, 2]
    is_better = [text.startswith("better: hunting teeth; planets in phase") for text in entry["reasons"]]
    assert is_better == [True] * 4 + [False] * 21
    tables = [block for block in sheet.search(calculation.record) if isinstance(block, Table)]
    rows = {row[0]: row for table in tables if "better" in table.title for row in table.rows}
    assert list(rows)[:4] == [4, 8, 15, 21]
    assert [row[-1] for row in rows.values()] == entry["reasons"]
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "choose_teeth.md").read_text(encoding="utf-8")
    for number in (4, 5, 1):
        _, sun, planet, *_, reason = rows[number]
        assert f"| {number} | {sun:.0f}/{planet:.0f} | {reason} |" in page


def test_no_group_of_the_front_is_beaten_and_every_other_one_is() -> None:
    """Pair by pair in whole steps: 0.1 % of the ratio, 0.05 of a safety, 1 mm, 0.1 % of the efficiency."""
    calculation = run(GroupSearch(), fewest_pins=30, most_pins=60)
    told = found(calculation)
    columns = {name: told.column(name) for name in ("deviation", "reserve", "centre_distance", "efficiency")}
    marks = [
        (round(abs(dev) / 1e-3), -round(res / 0.05), round(size / 1e-3), -round(eta / 1e-3), common)
        for dev, res, size, eta, common in zip(*columns.values(), told.groups.common_first, strict=True)
    ]
    beaten = [
        any(all(a <= b for a, b in zip(other, own, strict=True)) and other != own for other in marks) for own in marks
    ]
    assert len(marks) == 422
    assert np.isnan(told.column("from_best")).tolist() == beaten
    table = next(block for block in sheet.search(calculation.record) if getattr(block, "title", "").endswith("beats"))
    assert isinstance(table, Table)
    assert len(table.rows) == sheet.MOST_SHOWN
    assert table.rows[0][-1] == round(np.nanmin(told.column("from_best")), 3)
    assert f"{beaten.count(False)} of 422 groups" in table.note
    default = found(run(GroupSearch()))
    first = int(np.nanargmin(default.column("from_best")))
    count, name = int(np.sum(np.isfinite(default.column("from_best")))), default.numbers[first]
    page = " ".join((Path(__file__).parents[2] / "docs/explanation/rv_gearing.md").read_text(encoding="utf-8").split())
    assert f"{count} of the 25 groups are on the front" in page
    assert f"{beaten.count(False)} of 422" in page
    assert f"no. {name:.0f}, {default.groups.sun[first]:.0f}/{default.groups.planet[first]:.0f}" in page


def test_the_front_is_drawn_filled_and_the_others_hollow(whole: Calculation) -> None:
    told = found(whole)
    panel = front_figure(told).axes[0]
    filled = np.concatenate([np.asarray(marks.get_offsets()) for marks in panel.collections])
    on_front = np.isfinite(told.column("from_best"))
    assert len(filled) == on_front.sum() == 18
    hollow = panel.lines[0].get_xydata()
    assert sorted(hollow[:, 0]) == pytest.approx(sorted(1e3 * told.groups.centre_distance[~on_front]))
    ring = panel.lines[1].get_xydata()[0]
    assert ring == pytest.approx([68.125, told.column("reserve")[12]])


def test_the_heat_is_drawn_with_its_hottest_point_and_none_at_the_pitch_point() -> None:
    stage = RV_GEARING.inputs()
    answers = RV_GEARING.read_results(rv_gearing(stage))
    drawn = heat_figure(stage).axes[0].lines[0].get_xydata()
    assert drawn[:, 1].max() == pytest.approx(float(answers["flash_temperature"]))
    assert drawn[np.abs(drawn[:, 0]) < 1e-9, 1] == pytest.approx([0.0], abs=1e-6)
    assert np.ptp(drawn[:, 0]) == pytest.approx(1e3 * float(answers["contact_ratio"] * answers["base_pitch"]))


def test_one_criterion_alone_leaves_its_best_groups() -> None:
    told = found(run(GroupSearch(criteria=("deviation",))))
    assert told.numbers[~np.isnan(told.column("from_best"))].tolist() == [1, 6, 11, 18, 25]  # just the wanted ratio
    assert set(told.column("from_best")[[0, 5, 10, 17, 24]]) == {0.0}
    with pytest.raises(TruingError, match="criteria are columns of the groups, but 'price'"):
        GroupSearch(criteria=("price",))  # type: ignore[arg-type]


def test_how_often_the_papers_better_groups_hunt_is_what_chance_gives_in_a_seventh_of_all_draws() -> None:
    """Nine of the first 22 by the numbers of this list; the finding prints both counts and the chance."""
    hunting = found(run(GroupSearch())).groups.common_first[:22] == 1
    better = np.array([3, 7, 10, 12, 13, 15, 20, 21, 22]) - 1
    assert (int(hunting.sum()), int(hunting[better].sum())) == (13, 7)
    assert hypergeom.sf(6, 22, 13, 9) == pytest.approx(0.149, abs=5e-4)


def test_groups_with_just_the_wanted_ratio_keep_their_numbers() -> None:
    told = found(run(GroupSearch(exact_only=True)))
    assert (told.count, told.exact) == (25, 5)
    assert told.numbers.tolist() == [1, 6, 11, 18, 25]
    assert np.all(told.groups.ratio == 111.0)


def test_the_rated_group_is_told() -> None:
    assert found(run(GroupSearch(), group=5)).rated == 5
    assert found(run(GroupSearch(), sun_teeth=28, planet_teeth=77)).rated == 11
    stated = run(GroupSearch(), sun_teeth=14, planet_teeth=61, shift_sun=0.3)
    assert found(stated).rated is None
    assert any("stated teeth are none of the 25 groups" in words for words in found(stated).warnings())


@pytest.mark.parametrize(
    ("power", "group", "stable"), [("2.26 kW", 1, True), ("2.345 kW", 1, False), ("2.2 kW", 9, True)]
)
def test_a_number_that_hangs_on_the_scatter_of_the_efficiency_is_said(power: str, group: int, stable: bool) -> None:
    """20/55 needs 46.875 mm; the window begins there at 1341.7 N m, which 2.345 kW give with 0.992 of a bearing."""
    told = found(run(GroupSearch(), power=power, group=group))
    assert bool(told.warnings()) is not stable
    assert found(run(GroupSearch(), power=power, sun_teeth=20, planet_teeth=55)).warnings() == ()


def test_an_empty_list_is_said_and_the_stated_teeth_are_rated() -> None:
    calculation = run(GroupSearch(gives=listed), target_ratio=5000.0, sun_teeth=20, planet_teeth=55)
    assert calculation.answers["group_count"] == 0
    assert calculation.answers["group_ratio"].shape == (0,)
    assert "no group of tooth numbers meets" in " ".join(found(calculation).warnings())
    assert words(sheet.search(calculation.record)).startswith("No group of tooth numbers")
    assert sheet.comparison(calculation.record) == []
    assert not any(isinstance(block, Table) for block in sheet.search(run(GroupSearch(), **PAIRS[3]).record))
    assert float(calculation.answers["root_stress_sun"]) > 0
    assert json.loads(json.dumps(found(calculation).as_json()))["count"] == 0


def test_a_group_that_cannot_be_rated_stays_in_the_list() -> None:
    """With this shift the smallest suns have pointed teeth; their strength is empty, not an error."""
    calculation = run(GroupSearch(), sun_teeth=36, planet_teeth=99, shift_sun=1.3, shift_planet=-1.3)
    told = found(calculation)
    empty = np.isnan(told.strength["root_stress_sun"])
    assert np.flatnonzero(empty).tolist() == [0, 1]
    assert None in told.as_json()["groups"]["root_stress_sun"]["values"]
    json.dumps(told.as_json(), allow_nan=False)
    assert any(isinstance(block, Table) for block in sheet.comparison(calculation.record))


def test_a_column_that_is_none_is_refused() -> None:
    with pytest.raises(TruingError, match="the groups have no column 'price'"):
        GroupSearch(sort_by="price")  # type: ignore[arg-type]


# ---- capacity and courses -----------------------------------------------------------------------------------------


def reserve_of(calculation: Calculation) -> Reserve:
    reserve = calculation.outcomes["capacity"]
    assert isinstance(reserve, Reserve)
    return reserve


@pytest.mark.parametrize("place", range(4))
def test_at_its_torque_a_safety_is_just_what_is_asked(whole: Calculation, place: int) -> None:
    at = rv_gearing(RV_GEARING.inputs(load_torque=float(reserve_of(whole).torque[place])))
    safety = float(RV_GEARING.read_results(at)[SAFETIES[place]])
    assert safety == pytest.approx(1.25 if place < 2 else 1.1, rel=1e-9)


def test_at_its_torque_the_contact_is_just_as_hot_as_it_may_be(whole: Calculation) -> None:
    """A lubricant that scuffs early makes that torque the least of all."""
    at = rv_gearing(RV_GEARING.inputs(load_torque=float(reserve_of(whole).torque[4])))
    assert float(at.flank.contact_rise) == pytest.approx(float(at.flank.permitted_contact_rise), rel=1e-9)
    early = {"scuffing_stage": 7, "input_speed": "10000 rpm", "oil_temperature": "90 degC", "face_width": "25 mm"}
    reserve = reserve_of(run(Capacity(), **early))
    assert reserve.governing == "scuffing"
    held = rv_gearing(RV_GEARING.inputs(load_torque=float(rating(reserve).torque_capacity), **early))
    assert float(held.flank.contact_rise) == pytest.approx(float(held.flank.permitted_contact_rise), rel=1e-9)
    assert reserve.as_json()["limits"]["contact_rise"]["working_life"]["value"] is None


def test_the_flank_of_the_sun_governs_and_its_life_ends_first(whole: Calculation) -> None:
    reserve = reserve_of(whole)
    assert reserve.governing == "pitting of the sun"
    worn = rv_gearing(RV_GEARING.inputs(working_life=float(reserve.life[2])))
    assert float(worn.sun.contact_safety) == pytest.approx(1.1, rel=1e-9)
    assert np.isinf(reserve.life[:2]).all()
    assert reserve.as_json()["limits"]["root_safety_sun"]["working_life"]["value"] is None
    given = rating(reserve)
    assert given.torque_capacity == min(reserve.torque)
    more = float(given.torque_capacity) / float(whole.answers["output_torque"])
    assert float(given.power_capacity) == pytest.approx(2260 * more, rel=1e-3)


def test_a_stated_torque_of_the_sun_is_what_is_raised(whole: Calculation) -> None:
    """The same load, stated at the sun instead of by the power."""
    stated = run(Capacity(), stated_sun_torque=float(rv_gearing(RV_GEARING.inputs()).duty.sun_torque))
    assert reserve_of(stated).torque == pytest.approx(reserve_of(whole).torque, rel=1e-9)


def test_a_stage_that_is_too_weak_at_any_load_says_so() -> None:
    reserve = reserve_of(run(Capacity(), bending_limit_sun="0.001 MPa"))
    assert reserve.torque[0] == 0
    table = reserve.blocks()[0]
    assert isinstance(table, Table)
    assert "always below" in table.rows[0]


def swept_of(calculation: Calculation, name: str) -> Swept:
    swept = calculation.outcomes[name]
    assert isinstance(swept, Swept)
    return swept


def test_courses_hold_the_four_safeties_and_fall_with_the_load(whole: Calculation) -> None:
    for name, sign in (("load", -1.0), ("face_width", 1.0)):
        results = swept_of(whole, name).results
        assert set(results) == set(SAFETIES)
        assert all(np.all(sign * np.diff(values) > 0) for values in results.values())
    swept = swept_of(whole, "load")
    torque = float(whole.answers["output_torque"])
    assert (swept.axis[0], swept.axis[-1]) == (pytest.approx(0.1 * torque), pytest.approx(2 * torque))
    with pytest.raises(TruingError, match="the range of helix_angle"):
        run(Safeties(over="helix_angle"))
    alone = rv_gearing(RV_GEARING.inputs(load_torque=float(swept.axis[10])))
    assert swept.results["contact_safety_sun"][10] == pytest.approx(float(alone.sun.contact_safety), rel=1e-12)


def test_a_course_over_the_load_goes_over_the_torque_of_the_sun_where_that_is_stated() -> None:
    course = Safeties(over="load_torque", at="100..2500 N*m", points=5, name="load")
    swept = swept_of(run(course, stated_sun_torque=20.0), "load")
    assert swept.over == "stated_sun_torque"
    assert swept.axis == pytest.approx([2.0, 11.5, 21.0, 30.5, 40.0])
    assert np.all(np.diff(swept.results["contact_safety_sun"]) < 0)


# ---- teeth and mesh as they are drawn -------------------------------------------------------------------------------


@pytest.mark.parametrize(("teeth", "shift"), [(20, 0.0), (55, 0.0), (17, 0.3), (99, -0.4), (14, 0.4), (12, 0.1)])
def test_the_outline_has_the_chord_of_the_standard(teeth: int, shift: float) -> None:
    """The point of the trochoid whose tangent stands at 30 degrees to the axis of the tooth, found on the outline."""
    radius, space = trochoid(RACK, teeth, shift, points=20_001)
    across = radius * np.sin(np.pi / teeth - space)
    up = radius * np.cos(np.pi / teeth - space)
    slope = np.degrees(np.arctan2(-np.diff(across), np.diff(up)))  # of the tangent to the axis
    middle = 0.5 * (across[1:] + across[:-1])
    place = int(np.argmin(np.abs(slope - 30.0)))
    root = external_root(RACK, float(teeth), shift)
    assert 2.0 * middle[place] == pytest.approx(float(root.chord), rel=2e-4)
    assert up[place] == pytest.approx(float(root.depth), rel=2e-4)


@pytest.mark.parametrize(("teeth", "shift"), [(20, 0.0), (55, 0.2), (17, 0.3), (8, 0.0)])
def test_the_outline_has_root_tip_and_thickness(teeth: int, shift: float) -> None:
    """Thickness at the reference circle: pi/2 + 2 x tan alpha modules."""
    outline = tooth(RACK, teeth, shift, 0.5 * teeth + 1.0 + shift)
    radii = np.hypot(*outline)
    assert (radii.min(), radii.max()) == (
        pytest.approx(0.5 * teeth - 1.25 + shift),
        pytest.approx(0.5 * teeth + 1 + shift),
    )
    space = half_space(RACK, teeth, shift, np.array([0.5 * teeth]))[0]
    assert teeth * (np.pi / teeth - space) == pytest.approx(np.pi / 2 + 2 * shift * np.tan(np.radians(20)), rel=1e-12)


@pytest.mark.parametrize(
    ("teeth", "shift", "cut"), [(18, 0.0, False), (17, 0.0, True), (9, 0.0, True), (9, 0.5, False)]
)
def test_undercut_is_known_and_joins_without_a_step(teeth: int, shift: float, cut: bool) -> None:
    """A rack that is straight down to one module undercuts below 2/sin^2(20) = 17.1 teeth, less with shift."""
    assert undercut(RACK, teeth, shift) is cut
    radii = np.linspace(0.5 * teeth - 1.25 + shift + 1e-6, 0.5 * teeth + 1.0 + shift, 4001)
    space = half_space(RACK, teeth, shift, radii)
    steps = np.abs(np.diff(radii[50:] * space[50:]))
    assert steps.max() < 0.02


PAIRS: list[dict[str, Any]] = [
    {},
    {"group": 25, "planets": 3},
    {"sun_teeth": 14, "planet_teeth": 61, "shift_sun": 0.3, "shift_planet": -0.1},
    {"sun_teeth": 17, "planet_teeth": 103, "module": "8 mm", "helix_angle": "15.8 deg", "shift_sun": 0.145},
]


@pytest.mark.parametrize("inputs", PAIRS)
def test_flanks_touch_along_a_path_as_long_as_the_contact_ratio_says(inputs: dict[str, Any]) -> None:
    """Distances of the drawn outlines around the pitch point; a hundredth of a module is the step of the outline."""
    calculation = run(**inputs)
    meshing = meshing_of(calculation.record, calculation.record.inputs)
    planet = meshing.planet.teeth + np.array([[0.0], [meshing.distance]])
    close = np.abs(meshing.sun.teeth - np.array([[0.0], [meshing.sun.pitch]])).max(axis=0) < 3 * meshing.module
    own = meshing.sun.teeth[:, close]
    away = np.array([np.hypot(*(planet - point[:, None])).min() for point in own.T])
    assert away.min() < 0.03 * meshing.module
    inside = Outline(planet.T).contains_points(own.T)
    assert not np.any(inside) or away[inside].max() < 0.02 * meshing.module
    path = meshing.path()
    ratio = float(calculation.answers["contact_ratio"])
    assert (path["E"] - path["A"]) / meshing.base_pitch == pytest.approx(ratio, rel=1e-12)
    assert path["A"] < path["B"] < path["D"] < path["E"]
    for name, centre, wheel in (("E", 0.0, meshing.sun), ("A", meshing.distance, meshing.planet)):
        across, up = meshing.place(path[name])
        assert np.hypot(across, up - centre) == pytest.approx(wheel.tip, rel=1e-12)


def test_the_drawn_forces_have_the_arms_of_the_calculation() -> None:
    calculation = run()
    for one in notched_of(calculation.record, calculation.record.inputs):
        assert one.single is not None
        for kind, (_, arm) in (("tip", one.tip), ("outer", one.single)):
            assert float(arm.height) == pytest.approx(float(calculation.answers[f"{kind}_arm_{one.name}"]), rel=1e-12)
    diameter = notched_of(calculation.record, calculation.record.inputs)[0].single
    assert diameter is not None
    assert diameter[0] == pytest.approx(20.2414, abs=5e-5)  # modules


# ---- figures -------------------------------------------------------------------------------------------------------


def test_the_figure_of_the_groups_shows_each_and_rings_the_rated_one(whole: Calculation) -> None:
    panel = groups_figure(found(whole)).axes[0]
    shown = np.asarray(panel.collections[-1].get_offsets())
    assert shown[:, 1] == pytest.approx(1e3 * found(whole).groups.centre_distance)
    assert shown[:, 0] == pytest.approx(100 * (found(whole).groups.ratio / 111 - 1))
    ring = next(line for line in panel.get_lines() if line.get_fillstyle() == "none")
    assert list(ring.get_xydata()[0]) == [pytest.approx(0.0, abs=1e-9), pytest.approx(46.875)]
    texts = [text.get_text() for text in panel.texts]
    assert {str(number) for number in range(1, 26)} <= set(texts)
    assert "46.21 to 84.82 mm" in panel.get_title(loc="left")


def test_the_figure_of_stresses_has_every_group_below_its_limit(whole: Calculation) -> None:
    for panel, kind in zip(stresses_figure(found(whole)).axes, ("root", "contact"), strict=True):
        lines = {line.get_label(): np.asarray(line.get_ydata(), dtype=float) for line in panel.get_lines()}
        for gear in ("sun", "planet"):
            assert lines[gear] == pytest.approx(found(whole).strength[f"{kind}_stress_{gear}"] / 1e6)
            assert np.all(lines[gear] < lines[f"{gear}, permissible"])
