"""Shifts that make each group narrowest: every answer rated again by itself, and every bound looked for by hand."""

from dataclasses import replace
from math import pi, radians, sin
from typing import Any

import numpy as np
import pytest

from gear_geometry.roots import Rack
from rv_gearing.geometry import undercut
from rv_gearing.model import RV_GEARING
from rv_gearing.rating import SAFETIES, rv_gearing
from rv_gearing.shaping import ShapedGroups, Shifts
from truing import TruingError
from truing.calculation import calculate
from truing.setup import default_setup

RACK = Rack(dedendum=1.25, fillet=0.38, pressure_angle=radians(20.0))
ASKED = (1.25, 1.25, 1.1, 1.1)


def shaped(study: Shifts, **inputs: Any) -> ShapedGroups:
    outcome = calculate(replace(default_setup(RV_GEARING, **inputs), studies=[study])).outcomes["shifts"]
    assert isinstance(outcome, ShapedGroups)
    return outcome


def reserve(**stated: Any) -> float:
    answers = RV_GEARING.read_results(rv_gearing(RV_GEARING.inputs(**stated)))
    return min(float(answers[name]) / least for name, least in zip(SAFETIES, ASKED, strict=True))


@pytest.fixture(scope="module")
def kept() -> ShapedGroups:
    return shaped(Shifts(points=13))


@pytest.mark.parametrize("number", [0, 8, 24])
def test_at_its_width_a_group_just_lasts_and_no_other_shift_is_narrower(kept: ShapedGroups, number: int) -> None:
    entry = kept.as_json()["groups"][number]
    pair = {"sun_teeth": entry["sun"], "planet_teeth": entry["planet"]}
    width, own = kept.width[number, kept.best[number]], kept.grid[kept.best[number]]
    assert entry["face_width"]["value"] == pytest.approx(1e3 * width, abs=0.006)
    for shifts, least in zip(kept.grid, kept.width[number], strict=True):
        if np.isnan(least):
            continue
        assert least >= width * (1 - 1e-6)
        assert shifts.sum() == pytest.approx(own.sum(), abs=1e-12)
        stated = pair | {"shift_sun": float(shifts[0]), "shift_planet": float(shifts[1])}
        assert reserve(**stated, face_width=least) >= 1.0
        assert reserve(**stated, face_width=least * 0.999) < 1.0


def test_what_is_left_out_is_undercut_sharp_or_short_of_contact(kept: ShapedGroups) -> None:
    """Undercut by the rack, sharpness by the arc between two involutes, interference by the end of the other's tip."""
    for number in range(0, 25, 6):
        teeth = kept.groups.sun[number], kept.groups.planet[number]
        for place, shifts in enumerate(kept.grid):
            cut = any(undercut(RACK, z, x) for z, x in zip(teeth, shifts, strict=True))
            thin = any(tip_in_modules(z, x) < 0.3 for z, x in zip(teeth, shifts, strict=True))
            short = kept.shape["contact_ratio"][number, place] < 1.2
            allowed = not np.isnan(kept.width[number, place])
            assert not (allowed and (cut or thin or short))
            if not (cut or thin or short or allowed):
                assert below_the_involute(kept, number, place)


def tip_in_modules(z: float, x: float) -> float:
    """ISO 21771, with the rack's tooth of pi/2 modules; the profile angle at the tip by Pythagoras."""
    base, tip = z * np.cos(radians(20)) / 2, z / 2 + 1 + x
    involute = lambda angle: np.tan(angle) - angle  # noqa: E731
    half = (pi / 2 + 2 * x * np.tan(radians(20))) / z + involute(radians(20)) - involute(np.arccos(base / tip))
    return float(tip * 2 * half / 1)


def below_the_involute(kept: ShapedGroups, number: int, place: int) -> bool:
    for gear, z, x in zip(("sun", "planet"), (kept.groups.sun[number], kept.groups.planet[number]), kept.grid[place],
                          strict=True):  # fmt: skip
        begin = z / 2 * sin(radians(20)) - (1.25 - 0.38 * (1 - sin(radians(20))) - x) / sin(radians(20))
        if kept.shape[f"start_curvature_{gear}"][number, place] < begin * 1.25e-3:
            return True
    return False


def test_free_shifts_are_never_wider_and_suns_of_fourteen_teeth_get_the_shift_they_need() -> None:
    both = shaped(Shifts(points=5, free_centre=True))
    one = shaped(Shifts(points=5))
    for number in range(len(one.groups)):
        assert both.width[number, both.best[number]] <= one.width[number, one.best[number]] * (1 + 1e-9)
    small = shaped(Shifts(points=13), target_ratio=175.2, fewest_sun_teeth=14, ratio_tolerance=0.001)
    of_fourteen = np.flatnonzero(small.groups.sun == 14)
    assert len(of_fourteen)
    assert np.isnan(small.width[of_fourteen, 0]).all()  # without shift they are undercut
    assert (small.grid[small.best[of_fourteen], 0] >= 17 / 17 - 14 / 17).all()  # the rule (17 - z)/17


def test_nothing_to_shape_and_wrong_bounds_are_said() -> None:
    none = shaped(Shifts(points=3), target_ratio=5000.0, sun_teeth=20, planet_teeth=55)
    assert none.as_json()["groups"] == []
    tight = shaped(Shifts(points=3, least_contact_ratio=1.95))
    assert set(tight.best.tolist()) == {-1}
    assert tight.as_json()["groups"][0]["shift_sun"] is None
    with pytest.raises(TruingError, match="low < high"):
        Shifts(low=0.5, high=0.2)
