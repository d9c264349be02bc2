"""The press linkage at its dead centre and over a turn, its key errors, and what cannot close or is singular.

The paper: error analysis and accuracy synthesis of a parallel-driven multi-link servo press (Shanghai Jiao Tong
University). Where a number is not printed there, it was solved independently from the loop equations, to the digits
shown. Positions and derivatives are compared with a press of their own in ``test_press_linkage_by_hand.py``.
"""

from dataclasses import replace
from math import factorial
from typing import Any

import numpy as np
import pytest

from press_linkage import errors, kinematics
from press_linkage.effects import shares_of_load
from press_linkage.errors import KINDS, source
from press_linkage.kinematics import Half, Position
from press_linkage.quantities import Press, PressSide
from truing import Float

PAPER = Press()
OTHER = Press(
    crank_radius=0.25, rod_length=1.1, platform_arm=0.45, knee_drive_length=0.95, upper_knee_length=1.5,
    lower_knee_length=1.35, slider_half_width=1.25, crank_pivot_radius=0.8, platform_half_width=0.35,
    ground_pivot_radius=1.2, ground_pivot_angle=0.3,
)  # fmt: skip
MECHANISMS = pytest.mark.parametrize("geometry", [PAPER, OTHER], ids=["paper", "other"])
AROUND = np.radians([-140.3, -90.0, -40.0, -10.0, 0.0, 10.0, 40.0, 90.0, 150.0])


def off_by(**kinds: Float) -> PressSide:
    """One side that is off by these deviations, named without ``_deviation``."""
    return PressSide(**{f"{kind}_deviation": value for kind, value in kinds.items()})


def solve(press: Press, angle: Float, **off: Any) -> Position:
    """The exact position of a mechanism with these deviations."""
    return kinematics.solve(replace(press, **off), angle)


def test_bottom_dead_centre() -> None:
    side = solve(PAPER, 0.0).side_1
    angles = [side.parts.crank.angle, side.rod.angle, side.drive.angle, side.lower.angle, side.upper.angle]
    assert np.degrees(angles) == pytest.approx([122.743, 122.743, 9.367, 62.307, 105.133], abs=5.001e-4)
    assert list(side.knee) == pytest.approx([0.85643, 2.14088], abs=5.001e-6)
    assert [side.parts.ground.y, side.parts.ground.z] == pytest.approx([1.30024, 0.49983], abs=5.001e-6)
    assert side.face == pytest.approx(3.55760, abs=5.001e-6)


@MECHANISMS
def test_stroke_is_what_a_full_turn_covers(geometry: Press) -> None:
    path = np.asarray(solve(geometry, np.linspace(-np.pi, np.pi, 200_001)).slider_position)
    ends = [float(solve(geometry, at).slider_position) for at in (0.0, kinematics.top_crank_angle(geometry))]
    assert ends == pytest.approx([path.max(), path.min()], abs=1e-8)


def test_range_of_the_links_over_a_turn() -> None:
    side = solve(PAPER, np.linspace(-np.pi, np.pi, 7201)).side_1
    for angle, low, high in (
        (side.lower.angle, 24.1, 62.3), (side.upper.angle - side.drive.angle, 52.3, 95.8),
        (side.rod.angle, 114.5, 165.1),
    ):  # fmt: skip
        assert np.degrees([np.min(angle), np.max(angle)]) == pytest.approx([low, high], abs=0.0501)
    assert [np.min(side.knee.y), np.max(side.knee.y)] == pytest.approx([0.139, 0.856], abs=5.001e-4)


def test_the_printed_ground_pivot_angle_is_another_mechanism() -> None:
    """With 0.117 rad, as printed, the knee drive is level before the crank is down: lowest twice per turn."""
    printed = replace(PAPER, ground_pivot_angle=0.117)
    path = solve(printed, np.linspace(-np.pi, np.pi, 20_001))
    height = np.asarray(path.slider_position)
    lowest = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] > height[2:])) + 1
    assert len(lowest) == 2
    assert np.asarray(path.platform_height)[lowest] == pytest.approx([1.183, 1.183], abs=1e-3)
    paper = np.asarray(solve(PAPER, np.linspace(-np.pi, np.pi, 20_001)).slider_position)
    assert np.count_nonzero((paper[1:-1] > paper[:-2]) & (paper[1:-1] > paper[2:])) == 1


@pytest.mark.parametrize("limit", [kinematics.SERIES_LIMIT, kinematics.FEW_TERMS])
def test_series_stay_below_rounding(limit: float) -> None:
    assert kinematics.SERIES_LIMIT**8 / factorial(8) < 1e-17
    assert kinematics.SERIES_LIMIT**9 / factorial(9) < 1e-17
    x = np.linspace(-limit, limit, 100_002)
    cosine, sine = kinematics.cosine_and_sine(x)
    exact = x.astype(np.longdouble)
    assert np.abs(cosine - np.cos(exact)).max() < 1.2e-16
    assert np.abs(sine - np.sin(exact)).max() < 1e-17
    assert np.abs(sine / np.sin(exact) - 1).max() < 3e-16  # of itself, not of 1


@pytest.mark.parametrize("outlier", [0.0251, -0.0251, 3.0, np.nan])
def test_larger_angles_leave_the_series(outlier: float) -> None:
    x = np.array([1e-4, outlier, -2e-4])
    for ours, numpys in zip(kinematics.cosine_and_sine(x), (np.cos(x), np.sin(x)), strict=True):
        np.testing.assert_array_equal(ours, numpys)


# The paper's key sources: H and M positions and the knee links on both sides; the sums it prints, and ours
JOINTS = ("slider_joint_angle", "ground_pivot_angle", "lower_knee_length", "upper_knee_length", "knee_drive_length")
KEY = [("position", (*JOINTS, "slider_half_width"), 0.8766, 0.8771), ("tilt", JOINTS, 0.9006, 0.9016)]


@pytest.mark.parametrize(("result", "kinds", "printed", "ours"), KEY, ids=["position", "tilt"])
def test_salience_of_the_key_sources(result: str, kinds: tuple[str, ...], printed: float, ours: float) -> None:
    derivative = getattr(errors.derivatives(PAPER, solve(PAPER, 0.0)), result)
    shares = errors.salience(derivative)
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-14)
    key = sum(shares[source(kind, side)] for kind in kinds for side in (1, 2))
    assert key == pytest.approx(ours, abs=5.001e-5)
    assert key == pytest.approx(printed, rel=0.0012)
    assert set(sorted(shares, key=shares.get)[-2 * len(kinds) :]) == {source(k, s) for k in kinds for s in (1, 2)}
    assert errors.salience({name: 7.0 * value for name, value in derivative.items()}) == pytest.approx(shares)


# Statics: every joint is in equilibrium


def along(half: Half, link: str) -> tuple[Float, Float]:
    direction = getattr(half, link)
    return direction.cosine, direction.sine


@MECHANISMS
@pytest.mark.parametrize("size", [0.0, 2e-3])
def test_link_forces_are_in_equilibrium(geometry: Press, size: float) -> None:
    """Slider joint, knee and platform, under half of a newton on each side that pushes the slider up."""
    rng = np.random.default_rng(31)
    off = off_by(**{kind: size * rng.standard_normal() for kind in KINDS})
    position = solve(geometry, AROUND, side_1=off, side_2=off)
    platform = 0.0
    for half, force in zip((position.side_1, position.side_2), shares_of_load(position), strict=True):
        drive, upper, lower, rod = (along(half, name) for name in ("drive", "upper", "lower", "rod"))
        assert force["lower_knee_length"] * lower[1] == pytest.approx(np.full(AROUND.shape, 0.5), abs=1e-14)
        for part in (0, 1):  # links that are pressed push the knee away from their other ends
            knee = force["knee_drive_length"] * drive[part] + force["upper_knee_length"] * upper[part]
            assert knee == pytest.approx(force["lower_knee_length"] * lower[part], abs=1e-13)
        platform = platform + force["rod_length"] * rod[1] - force["knee_drive_length"] * drive[1]
    assert platform == pytest.approx(np.zeros_like(AROUND), abs=1e-14)


# What cannot close, or is singular: what is refused, and which loop, side and inequality is named


def broken(geometry: Press, angle: float = 0.0, **off: Any) -> list[str]:
    """The sentences of what does not hold."""
    return [text for holds, text in kinematics.demands(geometry, solve(geometry, angle, **off)) if not np.all(holds)]


@MECHANISMS
def test_nothing_is_wrong_over_the_whole_turn(geometry: Press) -> None:
    assert all(holds for holds, _ in kinematics.cycle_demands(geometry))


# What is wrong, where, what is said first
IMPOSSIBLE: list[tuple[dict[str, float], float, dict[str, Any], str]] = [
    ({"crank_pivot_radius": 0.2}, 0.0, {}, "crank_pivot_radius > platform_half_width"),
    ({"crank_pivot_radius": 2.5}, 0.0, {}, "loop I has no bottom dead centre"),
    ({"rod_length": 1.0}, -130.0, {}, "loop I, side 1 does not close"),
    ({}, -122.0, {"side_2": off_by(rod_length=-0.3)}, "loop VI, side 2 does not close"),
    ({"upper_knee_length": 0.5}, 0.0, {}, "|l_m - l_g| < |M - B_5| < l_m + l_g"),
    ({"upper_knee_length": 3.5}, 0.0, {}, "loop II, side 1 does not close"),
    ({}, 0.0, {"side_2": off_by(knee_drive_length=-0.7)}, "loop V, side 2 does not close"),
    ({"lower_knee_length": 0.7}, 0.0, {}, "loop III, side 1 does not close"),
    ({}, 0.0, {"side_2": off_by(lower_knee_length=-0.9)}, "|l - y_G| < l_h"),
    ({}, 0.0, {"side_1": off_by(crank_radius=-0.4)}, "side 1: every length with its deviation"),
    ({}, 0.0, {"side_2": off_by(slider_half_width=-1.7)}, "side 2: every length with its deviation"),
    ({}, 0.0, {"platform_arm_deviation": -0.7}, "the platform arm with its deviation"),
]


@pytest.mark.parametrize(("sizes", "degrees", "off", "words"), IMPOSSIBLE, ids=[row[3] for row in IMPOSSIBLE])
def test_impossible_mechanisms_are_named(
    sizes: dict[str, float], degrees: float, off: dict[str, Any], words: str
) -> None:
    assert words in broken(replace(PAPER, **sizes), np.radians(degrees), **off)[0]


def test_nan_does_not_pass() -> None:
    said = " ".join(broken(PAPER, side_1=off_by(rod_length=np.nan)))
    for words in ("side 1: every length", "loop I, side 1 does", "loop II, side 1 does", "loop III, side 1 does"):
        assert words in said


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
    ("lower_knee_length", "loop III, side 1", "(|sin(theta_18)| < 1e-6)"),
    ("upper_knee_length", "loop II, side 1", "(|sin(theta_19 - theta_17)| < 1e-6)"),
    ("rod_length", "loop I, side 1", "(|sin(theta_21)| < 1e-6)"),
]


@pytest.mark.parametrize(("kind", "loop", "words"), SINGULAR)
def test_singular_positions_are_refused_and_the_smallest_sine_warns(kind: str, loop: str, words: str) -> None:
    at_once = broken(*singular(kind, 1e-13))[0]
    assert at_once.startswith(f"{loop} is singular: ")
    assert words in at_once
    assert broken(*singular(kind, 1e-9)) == []
    assert broken(*singular(kind, -1e-9))[0].startswith(f"{loop} does not close: ")
    geometry, angle = singular(kind, 1e-4)
    position = solve(geometry, angle)
    angles = [position.side_1.rod.angle, position.side_1.lower.angle]
    angles.append(position.side_1.upper.angle - position.side_1.drive.angle)
    assert kinematics.smallest_sine(position) == pytest.approx(np.min(np.abs(np.sin(angles))), abs=1e-9)
    assert kinematics.smallest_sine(position) < 0.05 < kinematics.smallest_sine(solve(PAPER, AROUND)).min()


def test_full_rotation_is_a_demand_of_the_cycle_only() -> None:
    short = replace(PAPER, rod_length=1.25)
    assert broken(short) == []
    assert not kinematics.rotation_demand(short)[0]
    assert np.isnan(kinematics.top_crank_angle(short))
    assert not next(iter(kinematics.cycle_demands(short)))[0]


def test_a_failed_row_keeps_its_neighbours() -> None:
    off = off_by(lower_knee_length=np.array([0.0, -1.0, 1e-4]))
    position = solve(PAPER, 0.0, side_1=off)
    assert np.isfinite(position.slider_position).tolist() == [True, False, True]
    third = [holds for holds, text in kinematics.demands(PAPER, position) if text.startswith("loop III, side 1 does")]
    assert np.asarray(third[0]).tolist() == [True, False, True]
