"""The search for tooth numbers: its table, every reading of the lost flow chart, and the duty it is made for.

Equations 1 to 8 of the paper, written a second time as a plain loop over far wider bounds than those of the search.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rv_gearing.groups import ToothNumbers, candidates, chosen_teeth, mesh_efficiency, output_torque, search
from rv_gearing.model import RV_GEARING
from rv_gearing.quantities import Gearing
from truing.declare.batch import watching
from truing.errors import InfeasibleError

# No., sun, planet, ratio, centre distance in mm: all groups with 40 pins within 1 % of 111.
TABLE = [
    (1, 20, 55, 111.0000, 46.875), (2, 21, 58, 111.4762, 49.375), (3, 22, 60, 110.0909, 51.250),
    (4, 22, 61, 111.9091, 51.875), (5, 23, 63, 110.5652, 53.750), (6, 24, 66, 111.0000, 56.250),
    (7, 25, 69, 111.4000, 58.750), (8, 26, 71, 110.2308, 60.625), (9, 26, 72, 111.7692, 61.250),
    (10, 27, 74, 110.6296, 63.125), (11, 28, 77, 111.0000, 65.625), (12, 29, 79, 109.9655, 67.500),
    (13, 29, 80, 111.3448, 68.125), (14, 30, 82, 110.3333, 70.000), (15, 30, 83, 111.6667, 70.625),
    (16, 31, 85, 110.6774, 72.500), (17, 31, 86, 111.9677, 73.125), (18, 32, 88, 111.0000, 75.000),
    (19, 33, 90, 110.0909, 76.875), (20, 33, 91, 111.3030, 77.500), (21, 34, 93, 110.4118, 79.375),
    (22, 34, 94, 111.5882, 80.000), (23, 35, 96, 110.7143, 81.875), (24, 35, 97, 111.8571, 82.500),
    (25, 36, 99, 111.0000, 84.375),
]  # fmt: skip
READINGS: list[tuple[dict[str, Any], int, int]] = [  # read otherwise, groups, groups with just the wanted ratio
    ({}, 25, 5), ({"ratio_tolerance": 0.04}, 102, 5), ({"fewest_pins": 30, "most_pins": 60}, 422, 32),
    ({"fewest_pins": 20, "most_pins": 80}, 687, 56), ({"window": "one_pin_circle"}, 5, 1),
]  # fmt: skip
CATALOGUE = [81.0, 111.0, 127.7, 161.0, 175.2]


def plain(wanted: dict[str, Any], most_sun: int = 150) -> list[tuple[int, int, int]]:
    """The five conditions as printed, in millimetres and newtons, over bounds that are wide enough for anything."""
    read = {"ratio_tolerance": 0.01, "fewest_pins": 40, "most_pins": 40, "window": "whole", "ratio": 111.0}
    read |= {"fewest_sun_teeth": 17, "tooth_ratio": 1.5, "module": 1.25, **wanted}
    high = 0.85 if read["window"] == "one_pin_circle" else 1.3
    groups = []
    for pins in range(read["fewest_pins"], read["most_pins"] + 1, 2):
        for sun in range(read["fewest_sun_teeth"], most_sun):
            for planet in range(sun, 12 * sun):
                ratio = 1 + planet / sun * pins
                if abs(ratio - read["ratio"]) / read["ratio"] > read["ratio_tolerance"] + 1e-12:
                    continue
                size = (9_550_000 * 2.26 / 15 * loss(sun, planet, pins) * 0.99**3) ** (1 / 3)
                centre = read["module"] / 2 * (sun + planet)
                if planet / sun >= read["tooth_ratio"] and 0.5 * 0.85 * size <= centre <= 0.6 * high * size:
                    groups.append((sun, planet, pins))
    return groups


def loss(sun: int, planet: int, pins: int) -> float:
    """Equation 8 as the ratio of a lossy train over that of one without losses."""
    k, u = pins / (pins - 1), planet / sun
    lossless = (k - 1 + u * k) / (k - 1)
    return (k - 0.998 + u * k * 0.992) / (k - 0.998) / lossless


def named(groups: Any) -> list[tuple[int, int, int]]:
    return [(int(s), int(p), int(z)) for s, p, z in zip(groups.sun, groups.planet, groups.pins, strict=True)]


def test_the_default_table() -> None:
    groups, (numbers, sun, planet, ratio, centre) = search(Gearing()), np.array(TABLE).T
    assert named(groups) == [(int(one), int(other), 40) for one, other in zip(sun, planet, strict=True)]
    assert groups.ratio == pytest.approx(ratio, abs=6e-5)
    assert groups.deviation == pytest.approx(ratio / 111 - 1, abs=1e-6)
    assert groups.centre_distance == pytest.approx(1e-3 * centre, rel=1e-12)
    assert groups.torque == pytest.approx(np.full(len(numbers), 1285.755), abs=0.015)


@pytest.mark.parametrize(("reading", "count", "exact"), READINGS)
def test_every_reading_has_its_count_and_finds_what_a_plain_loop_finds(
    reading: dict[str, Any], count: int, exact: int
) -> None:
    groups = search(RV_GEARING.inputs(**reading))
    assert len(groups) == count
    assert int(np.sum(groups.ratio == 111.0)) == exact
    assert sorted(named(groups)) == sorted(plain(reading))
    keys = list(zip(groups.pins, groups.sun, groups.planet, strict=True))
    assert keys == sorted(keys)


# Which groups are better


def partners(one: int, other: int) -> int:
    """How many teeth of the other gear a tooth meets, both turning tooth by tooth until they stand as before."""
    met, tooth = set(), 0
    while tooth not in met:
        met.add(tooth)
        tooth = (tooth + one) % other
    return len(met)


def placed(sun: int, planet: int, planets: int) -> tuple[int, int]:
    """Phases of the meshes and kinds of planets, from the angles of teeth around a sun with a tooth at angle 0.

    A planet is turned until its gap stands where the sun has a tooth: its angle on the crank, within a pitch.
    """
    phases, kinds = set(), set()
    for number in range(planets):
        towards = 2 * math.pi * number / planets
        tooth = round(towards / (2 * math.pi / sun)) * 2 * math.pi / sun  # of the sun, next to this planet
        beside = (tooth - towards) * sun / (2 * math.pi)  # in pitches, ahead of the line of centres
        phases.add(round(beside % 1, 6) % 1)
        gap = towards + math.pi - beside * 2 * math.pi / planet  # rolls the other way; there the planet has its gap
        kinds.add(round((gap * planet / (2 * math.pi)) % 1, 6) % 1)
    return len(phases), len(kinds)


@pytest.mark.parametrize("planets", [1, 2, 3])
def test_teeth_that_meet_and_planets_that_share(planets: int) -> None:
    groups = search(RV_GEARING.inputs(planets=planets, fewest_pins=30, most_pins=60))
    assert len(groups) == 422
    for at, (sun, planet, pins) in enumerate(named(groups)):
        assert partners(sun, planet) == planet / groups.common_first[at]
        assert partners(pins - 1, pins) == pins / groups.common_second[at]
        assert (groups.mesh_phases[at], groups.planet_kinds[at]) == placed(sun, planet, planets)
    hunts = (groups.common_first == 1) & (groups.common_second == 1)
    in_phase = groups.mesh_phases == 1
    assert groups.preference.tolist() == (4 - 2 * hunts - in_phase).tolist()
    if planets > 1:
        assert not np.any(hunts & in_phase & (groups.planet_kinds == 1)), "no group has everything"


@pytest.mark.parametrize(("planets", "shift", "touches"), [(3, 0.0, False), (4, 0.0, True), (3, 9.7, True)])
def test_planets_that_would_touch_have_no_preference(planets: int, shift: float, touches: bool) -> None:
    """36/99: centres 116.9, 95.5 modules apart, tips of 101; with 9.7 of shift 120.4."""
    stage = replace(Gearing(planets=planets), planet=replace(Gearing().planet, shift=shift))
    assert bool(np.isnan(search(stage).preference[-1])) is touches


@pytest.mark.parametrize(
    "other",
    [
        {"fewest_sun_teeth": 12}, {"fewest_sun_teeth": 30}, {"tooth_ratio": 2.74}, {"tooth_ratio": 4.0},
        {"ratio": 81.0}, {"ratio": 161.0, "ratio_tolerance": 0.02}, {"module": 2.0}, {"module": 0.8},
        {"ratio": 31.0, "ratio_tolerance": 0.2, "fewest_pins": 4, "most_pins": 24},
    ],
)  # fmt: skip
def test_no_group_is_lost_with_other_wishes(other: dict[str, Any]) -> None:
    spelt = {"ratio": "target_ratio", "tooth_ratio": "least_tooth_ratio"}
    settings = {spelt.get(name, name): value for name, value in other.items()}
    settings |= {"module": f"{other['module']} mm"} if "module" in other else {}
    assert sorted(named(search(RV_GEARING.inputs(**settings)))) == sorted(plain(other, most_sun=200))


def test_pin_circle_window_of_a_group_is_what_both_rules_admit() -> None:
    """Of every group: the larger lower end and the smaller upper end, and never empty within the window."""
    groups = search(Gearing())
    size = np.cbrt(groups.torque * 1e3)  # of N mm, so that radii are millimetres
    centre = groups.centre_distance * 1e3
    assert groups.circle_low * 1e3 == pytest.approx(np.maximum(centre / 0.6, 0.85 * size), rel=1e-12)
    assert groups.circle_high * 1e3 == pytest.approx(np.minimum(centre / 0.5, 1.3 * size), rel=1e-12)
    assert np.all(groups.circle_low <= groups.circle_high)


# ---- duty ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("sun", "planet", "pins"), [(20, 55, 40), (14, 61, 40), (36, 99, 40), (17, 30, 62)])
def test_meshes_without_losses_lose_nothing(sun: int, planet: int, pins: int) -> None:
    stage = replace(Gearing(), involute_efficiency=1.0, cycloid_efficiency=1.0)
    assert mesh_efficiency(stage, planet / sun, pins) == pytest.approx(1.0, abs=1e-14)
    lossy = mesh_efficiency(Gearing(), planet / sun, pins)
    assert lossy == pytest.approx(loss(sun, planet, pins), rel=1e-12)
    assert 0.0 < lossy < 1.0


def test_power_is_torque_times_speed_but_for_the_rounded_constant() -> None:
    stage = replace(Gearing(), bearing_efficiency=1.0)
    assert output_torque(stage, 1.0) == pytest.approx(2260 / (2 * math.pi * 15 / 60), rel=8e-5)


def test_no_other_sum_of_teeth_gives_all_catalogue_ratios() -> None:
    """Of all sums up to 100, 75 (and no other) has a pair within 0.1 of each printed ratio with 40 pins."""
    fits = [
        total for total in range(30, 101)
        if all(any(abs(1 + 40 * (total - sun) / sun - ratio) < 0.1 for sun in range(6, total)) for ratio in CATALOGUE)
    ]  # fmt: skip
    assert fits == [75]


# ---- the teeth that are rated ---------------------------------------------------------------------------------------


def test_a_group_is_chosen_by_its_number() -> None:
    assert chosen_teeth(RV_GEARING.inputs(group=5)) == ToothNumbers(sun=23.0, planet=63.0, pins=40.0)
    assert chosen_teeth(Gearing()) == ToothNumbers(sun=20.0, planet=55.0, pins=40.0)


def test_stated_teeth_are_taken_whatever_the_search_finds() -> None:
    nothing: dict[str, Any] = {"target_ratio": 5000.0, "group": 7}
    stated = RV_GEARING.inputs(sun_teeth=14, planet_teeth=61, **nothing)
    assert chosen_teeth(stated) == ToothNumbers(sun=14.0, planet=61.0, pins=40.0)
    assert chosen_teeth(replace(stated, pin_teeth=52.0)) == ToothNumbers(sun=14.0, planet=61.0, pins=52.0)


def test_in_a_batch_every_row_searches_with_its_own_duty() -> None:
    """Rows of one call, against one call each; some state their teeth, one finds nothing."""
    power = np.array([2.26e3, 1.1e3, 4.0e3, 2.26e3, 2.26e3, 1.0])
    sun = np.array([np.nan, np.nan, np.nan, 14.0, np.nan, np.nan])
    target = np.array([111.0, 111.0, 81.0, 111.0, 161.0, 111.0])
    stage = replace(Gearing(), power=power, sun_teeth=sun, planet_teeth=sun + 47.0, target_ratio=target, group=3)
    with watching(6) as failed:
        found = chosen_teeth(stage)
    for row in range(5):
        one = replace(
            stage, power=float(power[row]), sun_teeth=float(sun[row]), planet_teeth=float(sun[row] + 47.0),
            target_ratio=float(target[row]),
        )  # fmt: skip
        alone = chosen_teeth(one)
        values = (np.asarray(found.sun)[row], np.asarray(found.planet)[row], np.asarray(found.pins)[row])
        assert values == (alone.sun, alone.planet, alone.pins)
    assert [*failed.reasons(6)] == [5]


def test_many_rows_are_searched_in_parts() -> None:
    """More rows than one array holds give what single rows give."""
    power = np.linspace(1500.0, 3000.0, 30_000)
    found = chosen_teeth(replace(Gearing(), power=power, group=2))
    for row in (0, 9_999, 20_000, 29_999):
        alone = chosen_teeth(replace(Gearing(), power=float(power[row]), group=2))
        assert (np.asarray(found.sun)[row], np.asarray(found.planet)[row]) == (alone.sun, alone.planet)


# ---- what cannot be ---------------------------------------------------------------------------------------------


def test_a_search_without_bounds_is_refused() -> None:
    """What else cannot be searched is refused in ``end_to_end/test_plugins_refuse.py``."""
    with pytest.raises(InfeasibleError, match="sets of tooth numbers"):
        chosen_teeth(RV_GEARING.inputs(power=1e9, module=1e-5, ratio_tolerance=0.2))


def test_an_empty_list_is_an_answer() -> None:
    assert len(search(RV_GEARING.inputs(target_ratio=5000.0))) == 0
    assert len(search(RV_GEARING.inputs(power="1 W"))) == 0
    assert np.size(candidates(RV_GEARING.inputs(least_tooth_ratio=9.0)).sun) == 0
