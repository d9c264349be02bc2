"""Mechanisms that cannot close, singular positions: what is refused, and which loop, side and inequality is named."""

from dataclasses import replace

import numpy as np
import pytest
from press_linkage_cases import AROUND, MECHANISMS, PAPER, off_by, solve

from press_linkage import kinematics
from press_linkage.quantities import Press


def broken(geometry: Press, angle: float = 0.0, **off: object) -> list[kinematics.TiltDemand]:
    """The demands that do not hold."""
    position = solve(geometry, angle, **off)
    return [demand for demand in kinematics.demands(geometry, position) if not np.all(demand.holds)]


@MECHANISMS
def test_nothing_is_wrong_over_the_whole_turn(geometry: Press) -> None:
    assert [demand.name for demand in kinematics.cycle_demands(geometry) if not demand.holds] == []


# What is wrong, where, what is said first
IMPOSSIBLE = [
    ({"crank_pivot_radius": 0.2}, 0.0, {}, "branch", "crank_pivot_radius > platform_half_width"),
    ({"crank_pivot_radius": 2.5}, 0.0, {}, "stretched", "rod_length"),
    ({"rod_length": 1.0}, -130.0, {}, "loop I", "loop I, side 1 does not close"),
    ({}, -122.0, {"side_2": off_by(rod_length=-0.3)}, "loop VI", "loop VI, side 2 does not close"),
    ({"upper_knee_length": 0.5}, 0.0, {}, "loop II", "|l_m - l_g| < |M - B_5| < l_m + l_g"),
    ({"upper_knee_length": 3.5}, 0.0, {}, "loop II", "loop II, side 1 does not close"),
    ({}, 0.0, {"side_2": off_by(knee_drive_length=-0.7)}, "loop V", "loop V, side 2 does not close"),
    ({"lower_knee_length": 0.7}, 0.0, {}, "loop III", "loop III, side 1 does not close"),
    ({}, 0.0, {"side_2": off_by(lower_knee_length=-0.9)}, "loop IV", "|l - y_G| < l_h"),
    ({}, 0.0, {"side_1": off_by(crank_radius=-0.4)}, "sizes 1", "side 1"),
    ({}, 0.0, {"side_2": off_by(slider_half_width=-1.7)}, "sizes 2", "side 2"),
    ({}, 0.0, {"platform_arm": -0.7}, "platform arm", "platform arm"),
]


@pytest.mark.parametrize(("sizes", "degrees", "off", "name", "words"), IMPOSSIBLE, ids=[row[3] for row in IMPOSSIBLE])
def test_impossible_mechanisms_are_named(
    sizes: dict[str, float], degrees: float, off: dict[str, object], name: str, words: str
) -> None:
    first = broken(replace(PAPER, **sizes), np.radians(degrees), **off)[0]
    assert first.name == name
    assert words in first.sentence


def test_nan_does_not_pass() -> None:
    names = {demand.name for demand in broken(PAPER, side_1=off_by(rod_length=np.nan))}
    assert {"sizes 1", "loop I", "loop II", "loop III"} <= names


def singular(kind: str, short: float) -> tuple[Press, float]:
    """A mechanism whose named link is longer by *short* than the position in which it stands in line."""
    nominal = solve(PAPER, 0.0)
    if kind == "lower_knee_length":
        return replace(PAPER, lower_knee_length=1.6 - nominal.side_1.knee.y + short), 0.0
    if kind == "upper_knee_length":
        return replace(PAPER, upper_knee_length=np.sqrt(nominal.side_1.knee_span) - 0.868 + short), 0.0
    level = replace(PAPER, rod_length=1.2 + 0.36 - 0.3 + short, lower_knee_length=3.0)
    return level, -np.arccos(-0.9 / (0.36 + 1.26 + short))


SINGULAR = [
    ("lower_knee_length", "singular III", "(|sin(theta_18)| < 1e-6)"),
    ("upper_knee_length", "singular II", "(|sin(theta_19 - theta_17)| < 1e-6)"),
    ("rod_length", "singular I", "(|sin(theta_21)| < 1e-6)"),
]


@pytest.mark.parametrize(("kind", "name", "words"), SINGULAR)
def test_singular_positions_are_refused(kind: str, name: str, words: str) -> None:
    at_once = broken(*singular(kind, 1e-13))
    assert [demand.name for demand in at_once][:1] == [name]
    assert words in at_once[0].sentence
    assert broken(*singular(kind, 1e-9)) == []
    assert broken(*singular(kind, -1e-9))[0].name == name.replace("singular", "loop")


@pytest.mark.parametrize("kind", [row[0] for row in SINGULAR])
def test_smallest_sine_warns_before_a_singular_position(kind: str) -> None:
    geometry, angle = singular(kind, 1e-4)
    position = solve(geometry, angle)
    angles = [position.side_1.rod.angle, position.side_1.lower.angle]
    angles.append(position.side_1.upper.angle - position.side_1.drive.angle)
    assert kinematics.smallest_sine(position) == pytest.approx(np.min(np.abs(np.sin(angles))), abs=1e-9)
    assert (
        kinematics.smallest_sine(position)
        < kinematics.NEARLY_SINGULAR
        < kinematics.smallest_sine(solve(PAPER, AROUND)).min()
    )


def test_full_rotation_is_a_demand_of_the_cycle_only() -> None:
    short = replace(PAPER, rod_length=1.25)
    assert broken(short) == []
    assert not kinematics.rotation_demand(short).holds
    assert np.isnan(kinematics.stroke(short))
    assert not next(iter(kinematics.cycle_demands(short))).holds


def test_a_failed_row_keeps_its_neighbours() -> None:
    off = off_by(lower_knee_length=np.array([0.0, -1.0, 1e-4]))
    position = solve(PAPER, 0.0, side_1=off)
    assert np.isfinite(position.slider_position).tolist() == [True, False, True]
    holds = {demand.name: demand.holds for demand in kinematics.demands(PAPER, position)}
    assert np.asarray(holds["loop III"]).tolist() == [True, False, True]
    assert np.all(holds["loop IV"])
