"""Exact positions of the press linkage: loops, dead centres, mirror image, small-angle series.

The paper: error analysis and accuracy synthesis of a parallel-driven multi-link servo press (Shanghai Jiao Tong
University). Where a number is not printed there, it was solved independently from the loop equations, to the digits
shown; everything else is an identity that no linkage of this kind can escape.
"""

from dataclasses import replace
from math import factorial

import numpy as np
import pytest
from numpy.typing import NDArray
from press_linkage_cases import AROUND, MECHANISMS, PAPER, SIZES, mirrored, off_by, scattered, solve

from press_linkage import kinematics
from press_linkage.errors import KINDS
from press_linkage.kinematics import Half, Position
from press_linkage.quantities import Press, PressSide


def test_bottom_dead_centre() -> None:
    side = solve(PAPER, 0.0).side_1
    angles = [side.parts.crank.angle, side.rod.angle, side.drive.angle, side.lower.angle, side.upper.angle]
    assert np.degrees(angles) == pytest.approx([122.743, 122.743, 9.367, 62.307, 105.133], abs=5.001e-4)
    assert list(side.knee) == pytest.approx([0.85643, 2.14088], abs=5.001e-6)
    assert [side.parts.ground.y, side.parts.ground.z] == pytest.approx([1.30024, 0.49983], abs=5.001e-6)
    assert side.face == pytest.approx(3.55760, abs=5.001e-6)


def test_top_dead_centre_and_stroke() -> None:
    top = kinematics.top_crank_angle(PAPER)
    assert np.degrees(top) == pytest.approx(-140.30, abs=5.001e-3)
    assert solve(PAPER, top).slider_position == pytest.approx(2.39436, abs=5.001e-6)
    assert kinematics.stroke(PAPER) == pytest.approx(1.16324, abs=5.001e-6)


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


def loops(geometry: Press, position: Position, side: int, off: PressSide, arm: float) -> list[NDArray]:
    """What is left of the three loops of one side, in the frame, from angles and complex exponentials alone."""
    half: Half = position.side_1 if side == 1 else position.side_2
    own = {name: getattr(geometry, name) for name in SIZES}
    size = {kind: own[kind] + getattr(off, f"{kind}_deviation") for kind in own if kind != "platform_arm"}

    def turn(angle: object) -> NDArray[np.complex128]:
        return np.exp(1j * np.asarray(angle))

    def in_frame(angle: object) -> object:
        return angle if side == 1 else np.pi - np.asarray(angle)

    ground = size["ground_pivot_radius"] * turn(in_frame(own["ground_pivot_angle"]) + off.ground_pivot_angle_deviation)
    pivot = size["crank_pivot_radius"] * turn(in_frame(0.0) + off.crank_pivot_angle_deviation)
    platform = size["platform_half_width"] * turn(in_frame(0.0) + off.platform_joint_angle_deviation)
    slider = size["slider_half_width"] * turn(in_frame(0.0) + off.slider_joint_angle_deviation)
    crank = size["crank_radius"] * turn(in_frame(half.parts.crank.angle))
    rod = size["rod_length"] * turn(in_frame(half.rod.angle))
    drive = size["knee_drive_length"] * turn(in_frame(half.drive.angle))
    upper = size["upper_knee_length"] * turn(in_frame(half.upper.angle))
    lower = size["lower_knee_length"] * turn(in_frame(half.lower.angle))
    own_height = (pivot + crank + rod - platform).imag
    return [
        1j * own_height + platform - pivot - crank - rod,
        1j * (position.platform_height + geometry.platform_arm + arm) + drive - ground - upper,
        1j * half.face + slider - ground - upper - lower,
    ]


@MECHANISMS
@pytest.mark.parametrize("side", [1, 2])
@pytest.mark.parametrize("size", [0.0, 2e-3])
def test_loops_close(geometry: Press, side: int, size: float) -> None:
    angles = np.linspace(-np.pi, np.pi, 50, endpoint=False)
    one, two = scattered(size, 1), scattered(size, 2)
    position = solve(geometry, angles, side_1=one, side_2=two, platform_arm=size)
    for rest in loops(geometry, position, side, one if side == 1 else two, size):
        assert np.abs(rest).max() < 1e-12


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


@pytest.mark.parametrize("side", [1, 2])
def test_signs_of_a_raised_joint(side: int) -> None:
    """A positive polar angle lowers a joint at y > 0 and raises it at y < 0; a lower slider joint raises the face."""
    by = 1e-4
    lower = -1.0 if side == 1 else 1.0
    off = {f"side_{side}": off_by(slider_joint_angle=by)}
    assert solve(PAPER, 0.0, **off).slider_position - solve(PAPER, 0.0).slider_position == pytest.approx(
        0.5 * lower * 1.6 * by, rel=1e-3
    )
    off = {f"side_{side}": off_by(ground_pivot_angle=by)}
    assert solve(PAPER, 0.0, **off).slider_position - solve(PAPER, 0.0).slider_position == pytest.approx(
        -0.5 * lower * 1.255145 * by, rel=1e-3
    )


def test_height_at_bdc_to_eight_digits() -> None:
    assert solve(PAPER, 0.0).slider_position == pytest.approx(3.5575988, abs=5.001e-8)


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


@MECHANISMS
@pytest.mark.parametrize("size", [1e-4, 8e-3, 3e-2])
def test_batch_equals_loop(geometry: Press, size: float) -> None:
    one, two = scattered(size, 21, (25,)), scattered(size, 22, (25,))
    batch = solve(geometry, 0.3, side_1=one, side_2=two, platform_arm=size)
    for row in range(25):
        first, second = (
            off_by(**{kind: getattr(off, f"{kind}_deviation")[row] for kind in KINDS}) for off in (one, two)
        )
        single = solve(geometry, 0.3, side_1=first, side_2=second, platform_arm=size)
        assert single.slider_position == pytest.approx(batch.slider_position[row], abs=1e-14)
        assert single.slider_tilt == pytest.approx(batch.slider_tilt[row], abs=1e-14)


def test_sizes_may_vary_too() -> None:
    lengths = np.linspace(1.55, 1.65, 7)
    batch = solve(replace(PAPER, lower_knee_length=lengths, ground_pivot_angle=lengths - 1.2), AROUND[:7])
    for row, length in enumerate(lengths):
        single = solve(replace(PAPER, lower_knee_length=length, ground_pivot_angle=length - 1.2), AROUND[row])
        assert single.slider_position == pytest.approx(batch.slider_position[row], abs=1e-14)
