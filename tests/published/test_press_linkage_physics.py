"""Positions and sensitivities of the press linkage: dead centres, mirror image, rigid motions, small-angle series.

The paper: error analysis and accuracy synthesis of a parallel-driven multi-link servo press (Shanghai Jiao Tong
University). Where a number is not printed there, it was solved independently from the loop equations, to the digits
shown; everything else is an identity that no linkage of this kind can escape.
"""

from dataclasses import replace
from math import factorial

import numpy as np
import pytest
from press_linkage_cases import AROUND, MECHANISMS, PAPER, SIZES, mirrored, off_by, scattered, sensitivities, solve

from press_linkage import errors, kinematics
from press_linkage.errors import DRIVEN, KINDS, POLAR_ANGLES, source
from press_linkage.quantities import Press


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
    assert kinematics.stroke(geometry) == pytest.approx(path.max() - path.min(), abs=1e-8)


def test_range_of_the_links_over_a_turn() -> None:
    side = solve(PAPER, np.linspace(-np.pi, np.pi, 7201)).side_1
    for angle, low, high in [
        (side.lower.angle, 24.1, 62.3),
        (side.upper.angle - side.drive.angle, 52.3, 95.8),
        (side.rod.angle, 114.5, 165.1),
    ]:
        assert np.degrees([np.min(angle), np.max(angle)]) == pytest.approx([low, high], abs=0.0501)
    assert [np.min(side.knee.y), np.max(side.knee.y)] == pytest.approx([0.139, 0.856], abs=5.001e-4)


@MECHANISMS
def test_platform_takes_the_mean_height_and_slider_the_mean_face(geometry: Press) -> None:
    one, two = scattered(2e-3, 3), scattered(2e-3, 4)
    both = solve(geometry, AROUND, side_1=one, side_2=two)
    alone = [solve(geometry, AROUND, side_1=one), solve(geometry, AROUND, side_2=two)]
    nominal = solve(geometry, AROUND).platform_height
    assert both.platform_height == pytest.approx(sum(p.platform_height for p in alone) - nominal, abs=1e-14)
    assert both.slider_position == pytest.approx((both.side_1.face + both.side_2.face) / 2, abs=1e-15)
    assert both.slider_tilt == pytest.approx(
        (both.side_1.face - both.side_2.face) / (2 * geometry.slider_half_width), abs=1e-15
    )


@MECHANISMS
def test_crank_deviation_is_a_crank_angle(geometry: Press) -> None:
    both = off_by(crank_angle=0.01)
    assert solve(geometry, AROUND, side_1=both, side_2=both).slider_position == pytest.approx(
        solve(geometry, AROUND + 0.01).slider_position, abs=1e-14
    )


def test_deviations_do_not_move_the_zero_of_the_crank_angle() -> None:
    crank = solve(PAPER, 0.0, side_1=scattered(1e-2, 5)).side_2.parts.crank
    assert crank == solve(PAPER, 0.0).side_2.parts.crank


@MECHANISMS
@pytest.mark.parametrize("seed", [11, 12, 13])
def test_mirror_image(geometry: Press, seed: int) -> None:
    one, two = scattered(3e-3, seed), scattered(3e-3, seed + 50)
    there = solve(geometry, AROUND, side_1=one, side_2=two, platform_arm=1e-3)
    back = solve(geometry, AROUND, side_1=mirrored(two), side_2=mirrored(one), platform_arm=1e-3)
    assert back.slider_position == pytest.approx(there.slider_position, abs=1e-14)
    assert back.slider_tilt == pytest.approx(-there.slider_tilt, abs=1e-14)
    even = solve(geometry, AROUND, side_1=one, side_2=mirrored(one))
    assert even.slider_tilt == pytest.approx(np.zeros_like(AROUND), abs=1e-15)


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


def test_series_stay_below_rounding() -> None:
    limit = kinematics.SERIES_LIMIT
    assert limit**8 / factorial(8) < 1e-17
    assert limit**9 / factorial(9) < 1e-17
    x = np.linspace(-limit, limit, 100_001)
    cosine, sine = kinematics.cosine_and_sine(x)
    assert np.abs(cosine - np.cos(x.astype(np.longdouble))).max() < 1.2e-16
    assert np.abs(sine - np.sin(x.astype(np.longdouble))).max() < 1e-17


@pytest.mark.parametrize("outlier", [0.0251, -0.0251, 3.0, np.nan])
def test_larger_angles_leave_the_series(outlier: float) -> None:
    x = np.array([1e-4, outlier, -2e-4])
    for ours, numpys in zip(kinematics.cosine_and_sine(x), (np.cos(x), np.sin(x)), strict=True):
        np.testing.assert_array_equal(ours, numpys)


# Sensitivities


def polar_errors(across: float, down: float, *, radius: float, angle: float) -> tuple[float, float]:
    """Installation errors of a joint along y and z as errors of its polar radius (m) and polar angle (rad).

    First order; *angle* is the polar angle in the frame, so pi minus that of side 1 on side 2.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return across * cosine + down * sine, (down * cosine - across * sine) / radius


def test_driven_chain_tilts_only_a_press_that_is_already_uneven() -> None:
    even = errors.derivatives(PAPER, solve(PAPER, AROUND)).tilt
    assert all(np.all(even[source(kind, side)] == 0.0) for kind in DRIVEN for side in (1, 2))
    uneven = errors.derivatives(PAPER, solve(PAPER, 0.5, side_1=off_by(lower_knee_length=1e-3))).tilt
    assert 0.0 < abs(uneven["rod_length_deviation_1"]) < 1e-3


@MECHANISMS
def test_height_is_of_degree_one_in_the_lengths(geometry: Press) -> None:
    """Euler: the sum of sensitivity times length is the height itself, at every crank angle."""
    xi = sensitivities(geometry, AROUND)
    lengths = [name for name in SIZES if name != "ground_pivot_angle"]
    total = sum(xi[kind] * getattr(geometry, kind) for kind in lengths)
    assert total == pytest.approx(np.asarray(solve(geometry, AROUND).slider_position), abs=1e-12)
    double = replace(geometry, **{kind: 2 * getattr(geometry, kind) for kind in lengths})
    assert solve(double, AROUND).slider_position == pytest.approx(
        2 * np.asarray(solve(geometry, AROUND).slider_position), abs=1e-13
    )


@MECHANISMS
def test_lowering_the_whole_frame_lowers_the_slider(geometry: Press) -> None:
    """A rigid motion: crank pivots and ground joints of both sides down by the same amount, in polar errors."""
    found = errors.derivatives(geometry, solve(geometry, AROUND))
    position, tilt = np.zeros_like(AROUND), np.zeros_like(AROUND)
    for side in (1, 2):
        for place, radius, angle in [
            ("crank_pivot", geometry.crank_pivot_radius, 0.0),
            ("ground_pivot", geometry.ground_pivot_radius, geometry.ground_pivot_angle),
        ]:
            polar = polar_errors(0.0, 1.0, radius=radius, angle=angle if side == 1 else np.pi - angle)
            for suffix, error in zip(("radius", "angle"), polar, strict=True):
                position += error * found.position[source(f"{place}_{suffix}", side)]
                tilt += error * found.tilt[source(f"{place}_{suffix}", side)]
    assert position == pytest.approx(np.ones_like(AROUND), abs=1e-12)
    assert tilt == pytest.approx(np.zeros_like(AROUND), abs=1e-12)


@MECHANISMS
def test_frame_height_is_shared_by_upper_link_and_platform(geometry: Press) -> None:
    xi = sensitivities(geometry, AROUND)
    upper = solve(geometry, AROUND).side_1.upper
    assert xi["upper_knee_length"] * upper.sine + xi["platform_arm"] == pytest.approx(np.ones_like(AROUND), abs=1e-12)


@MECHANISMS
@pytest.mark.parametrize("kind", KINDS)
def test_equal_errors_do_not_tilt_and_opposite_ones_do_not_lower(geometry: Press, kind: str) -> None:
    found = errors.derivatives(geometry, solve(geometry, AROUND))
    sign = -1.0 if kind in POLAR_ANGLES else 1.0
    first, second = (found.position[source(kind, side)] for side in (1, 2))
    assert first == pytest.approx(sign * second, abs=1e-15)
    first, second = (found.tilt[source(kind, side)] for side in (1, 2))
    assert first == pytest.approx(-sign * second, abs=1e-15)


@MECHANISMS
@pytest.mark.parametrize("dead_centre", ["bottom", "top"])
def test_dead_centres(geometry: Press, dead_centre: str) -> None:
    angle = 0.0 if dead_centre == "bottom" else kinematics.top_crank_angle(geometry)
    xi = sensitivities(geometry, angle)
    sign = 1.0 if dead_centre == "bottom" else -1.0
    assert xi["crank_angle"] == pytest.approx(0.0, abs=1e-14)
    assert xi["crank_radius"] == pytest.approx(sign * xi["rod_length"], abs=1e-13)
    rod = solve(geometry, angle).side_1.rod
    assert xi["rod_length"] == pytest.approx(xi["platform_arm"] / rod.sine, abs=1e-13)


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
