"""The root of a ring that a pinion cutter makes, against the envelope of the cutter swept step by step."""

import numpy as np
import pytest
from numpy.typing import NDArray

from gear_geometry.roots import Cutter, cut_ring_arm, cut_ring_root

ALPHA = np.radians(20.0)
CASES = [
    (Cutter(teeth=25.0, shift=0.1, addendum=1.1, fillet=0.15), 100.0, -0.16),
    (Cutter(teeth=18.0, shift=0.2, addendum=1.25, fillet=0.2), 60.0, 0.4),
    (Cutter(teeth=40.0, shift=-0.1, addendum=1.25, fillet=0.25), 160.0, 0.0),
    # a large shift of the ring: the centre of the rounding lies within the working pitch circle of the cutter
    (Cutter(teeth=32.0, shift=-0.23, addendum=1.27, fillet=0.2456), 53.0, 0.387),
    (Cutter(teeth=40.0, shift=-0.2, addendum=1.25, fillet=0.25), 80.0, 2.5),
]


def involute(angle: float) -> float:
    return float(np.tan(angle) - angle)


def bisected(value: float) -> float:
    """The angle whose involute is the value, by halving."""
    low, high = 0.0, 1.5
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if involute(middle) < value else (low, middle)
    return 0.5 * (low + high)


def rounding(cutter: Cutter) -> tuple[float, float]:
    """Radius and angle of the centre of the tip rounding: found where a circle of its radius touches the flank.

    The flank is traced point by point; its centre lies along the normal of the flank, at the height of the rounding.
    """
    teeth, base = float(cutter.teeth), 0.5 * float(cutter.teeth) * np.cos(ALPHA)
    radius = 0.5 * teeth + float(cutter.shift) + float(cutter.addendum) - float(cutter.fillet)
    half = (0.5 * np.pi + 2.0 * float(cutter.shift) * np.tan(ALPHA)) / teeth + involute(ALPHA)
    roll = np.linspace(0.0, 1.2, 400_001)  # tan of the pressure angle
    angle = half - (roll - np.arctan(roll))  # polar angle of the flank from the axis of the tooth
    flank = base * np.sqrt(1.0 + roll**2) * np.array([np.cos(angle), np.sin(angle)])
    tangent = np.gradient(flank, axis=1)
    tangent /= np.hypot(*tangent)
    inward = np.array([tangent[1], -tangent[0]]) * np.sign(tangent[0])  # into the tooth: towards its axis
    centre = flank + float(cutter.fillet) * inward
    place = int(np.argmin(np.abs(np.hypot(*centre) - radius)[roll > 0.1])) + int(np.sum(roll <= 0.1))
    return radius, float(np.arctan2(centre[1, place], centre[0, place]))


def swept(cutter: Cutter, teeth: float, shift: float) -> tuple[float, float, float]:
    """Chord, radius of curvature and depth where the tangent of the swept rounding makes 60 degrees with the tooth."""
    radius, half = rounding(cutter)
    own = float(cutter.teeth)
    working = bisected(involute(ALPHA) + 2.0 * np.tan(ALPHA) * (shift - float(cutter.shift)) / (teeth - own))
    distance = 0.5 * (teeth - own) * np.cos(ALPHA) / np.cos(working)
    turned = np.linspace(-0.05, 0.05, 200_001)  # the cutter around the ring
    own_turn = half - turned * (teeth - own) / own
    path = distance * direction(turned) + radius * direction(own_turn)
    tangent = np.gradient(path, axis=1)
    normal = np.array([-tangent[1], tangent[0]]) / np.hypot(*tangent)
    normal *= np.sign((normal * path).sum(axis=0))
    fillet = path + float(cutter.fillet) * normal
    tooth = np.pi / teeth
    leaning = np.arctan2(normal[1], normal[0]) - tooth - np.pi / 6.0
    places = np.flatnonzero(leaning[:-1] * leaning[1:] < 0)
    place = int(places[np.argmax(np.hypot(*fillet[:, places]))])  # the deepest of them is the envelope
    point = fillet[:, place] - leaning[place] * np.diff(fillet[:, place : place + 2])[:, 0] / np.diff(leaning)[place]
    steps = np.gradient(fillet, axis=1)
    curvature = np.hypot(*steps)[place] / abs(np.gradient(leaning)[place])
    across = point @ np.array([-np.sin(tooth), np.cos(tooth)])
    return -2.0 * float(across), float(curvature), float(point @ direction(np.array(tooth)))


def direction(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize(("cutter", "teeth", "shift"), CASES)
def test_section_and_arm_are_those_of_the_swept_cutter(cutter: Cutter, teeth: float, shift: float) -> None:
    """The force at the tip meets the axis of the tooth where its line does, tangent to the base circle."""
    root = cut_ring_root(cutter, teeth, shift, ALPHA)
    chord, curvature, depth = swept(cutter, teeth, shift)
    assert float(root.chord) == pytest.approx(chord, rel=1e-5)
    assert float(root.fillet) == pytest.approx(curvature, rel=1e-3)
    assert float(root.depth) == pytest.approx(depth, rel=1e-6)
    tip, base = 0.5 * teeth - 1.0 + shift, 0.5 * teeth * np.cos(ALPHA)
    contact = np.arccos(base / tip)
    half = (0.5 * np.pi - 2.0 * shift * np.tan(ALPHA)) / teeth + involute(contact) - involute(ALPHA)
    point = tip * direction(np.array(half))  # the tooth stands along the first axis
    along = direction(np.array(half + contact + 0.5 * np.pi))
    assert abs(point[0] * along[1] - point[1] * along[0]) == pytest.approx(base, rel=1e-12)
    meets = point[0] - point[1] * along[0] / along[1]
    arm = cut_ring_arm(root, teeth, shift, tip, ALPHA)
    assert float(arm.height) == pytest.approx(float(root.depth) - meets, rel=1e-9)


def test_a_cutter_whose_tip_is_pointed_before_it_is_round_makes_nothing() -> None:
    root = cut_ring_root(Cutter(teeth=25.0, shift=0.0, addendum=1.25, fillet=0.5), 100.0, 0.0, ALPHA)
    assert np.isnan(root.chord)


def test_all_rings_of_a_wide_range_have_a_section_of_their_size_or_none() -> None:
    rng = np.random.default_rng(7)
    teeth = rng.integers(8, 80, 4000).astype(float)
    cutter = Cutter(teeth=teeth, shift=rng.uniform(-1.0, 1.0, 4000), addendum=1.1, fillet=rng.uniform(0.01, 0.4, 4000))
    with np.errstate(invalid="ignore"):
        root = cut_ring_root(cutter, teeth + rng.integers(8, 120, 4000), rng.uniform(-0.5, 3.0, 4000), ALPHA)
    chord, fillet = np.asarray(root.chord), np.asarray(root.fillet)
    made = np.isfinite(chord)
    assert 0.5 < made.mean() < 1.0
    assert chord[made].min() > 1.5
    assert chord[made].max() < 4.0
    assert fillet[made].min() > 0.0
