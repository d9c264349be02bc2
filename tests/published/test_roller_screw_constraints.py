"""Limits of the pair: margins against traced circles and textbook limits, where they end, and what is refused."""

from dataclasses import fields

import numpy as np
import pytest
from numpy.typing import NDArray

from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.objectives import Margins, margins_of, objectives_of, undercut_limit
from roller_screw_shift.quantities import Meshing, Pair
from truing.errors import InfeasibleError
from truing.evaluate import evaluate_rows
from truing.setup import default_setup

NAMES = tuple(each.name for each in fields(Margins))

# Inputs that no pair can have, and words of the sentence; lengths in m
REFUSED = [
    ({"roller_teeth": 93.0}, "ring_teeth at least 8 above roller_teeth"),
    ({"centre_distance": 0.0187}, "base circles are farther apart than the centres: centre_distance must exceed"),
    ({"centre_distance_deviation": -1e-3, "centre_distance": 0.0195}, "centre_distance + centre_distance_deviation"),
    ({"roller_shift": -1.5}, "tip circle of the roller lies inside"),
    ({"roller_shift": -1.0, "addendum": 2.0}, "tip circle of the ring lies inside"),
    ({"addendum": 1.0, "roller_shift": -0.2}, "involute interference: the tip of the ring"),
    ({"clearance": 1.0, "addendum": 0.9}, "rack of the roller is pointed before it is round: reduce roller_fillet"),
    ({"ring_fillet": 0.6}, "rack of the ring is pointed before it is round: reduce ring_fillet"),
    ({"roller_shift": 2.2, "roller_teeth": 9.0, "ring_teeth": 89.0}, "no tangent of 30 degrees: reduce roller_shift"),
    ({"ring_fillet": 0.0}, "the root of the ring has no radius: ring_fillet must be greater than 0"),
    ({"cutter_teeth": 93.0}, "cutter_teeth must be at least 8 below ring_teeth"),
    ({"cutter_teeth": 25.0, "cutter_fillet": 0.6}, "the cutter makes no such ring: its tip is pointed"),
    ({"addendum": 0.02, "clearance": 0.0, "roller_fillet": 0.2}, "has no arm about its root: enlarge addendum"),
]


def pair_of(**changed: object) -> Pair:
    """A pair with the defaults but for these inputs."""
    made: Pair = ROLLER_SCREW_SHIFT.inputs(**changed)
    return made


def kept(pair: Pair, count: int) -> NDArray[np.bool_]:
    """Where every margin is at least 0; NaN is not."""
    margins = np.array([np.broadcast_to(each, count) for each in vars(margins_of(pair)).values()])
    with np.errstate(invalid="ignore"):
        return np.asarray((margins >= 0.0).all(axis=0))


@pytest.mark.parametrize("name", NAMES)
def test_margins_are_those_of_the_answer_in_one_call_and_one_by_one(name: str) -> None:
    shifts = np.linspace(-0.05, 0.25, 5)
    many = np.broadcast_to(getattr(margins_of(pair_of(roller_shift=shifts)), name), 5)
    for place, shift in enumerate(shifts):
        answer: Meshing = ROLLER_SCREW_SHIFT.function(pair_of(roller_shift=float(shift)))
        assert many[place] == pytest.approx(float(getattr(answer, name)), rel=1e-12)


@pytest.mark.parametrize("deviation", [0.0, 30e-6])
def test_clearances_are_those_of_circles(deviation: float) -> None:
    """Points on the circles of the roller, in the frame of the ring; 0.1 modules must be left."""
    pair = pair_of(centre_distance_deviation=deviation)
    geometry, margins = geometry_of(pair), margins_of(pair)
    around = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 3601))
    tip = np.abs(geometry.mounted_distance + geometry.roller.tip_radius * around)
    root = np.abs(geometry.mounted_distance + geometry.roller.root_radius * around)
    opposite = geometry.ring.tip_radius + geometry.mounted_distance + geometry.roller.tip_radius * around.real.min()
    assert margins.margin_roller_root + 0.1 == pytest.approx((geometry.ring.tip_radius - root.max()) / 0.5e-3, rel=1e-9)
    assert margins.margin_ring_root + 0.1 == pytest.approx((geometry.ring.root_radius - tip.max()) / 0.5e-3, rel=1e-9)
    assert margins.margin_opposite_tips + 0.1 == pytest.approx(opposite / 0.5e-3, rel=1e-9)


def test_the_clearances_do_not_follow_the_shift() -> None:
    """The ring follows the roller, so that the fifth and sixth constraint of the paper never choose a shift."""
    margins = margins_of(pair_of(roller_shift=np.linspace(-0.5, 0.5, 5)))
    for name in ("margin_opposite_tips", "margin_roller_root", "margin_ring_root"):
        assert np.ptp(np.asarray(getattr(margins, name))) < 1e-9
    assert margins.margin_roller_root == pytest.approx(margins.margin_ring_root, abs=1e-9)


def test_undercut_begins_at_17_teeth() -> None:
    """Straight flank to one module below the reference line: 2/sin^2(20 deg) = 17.097 teeth; any textbook."""
    least = 2.0 / np.sin(np.radians(20.0)) ** 2
    assert least == pytest.approx(17.097, abs=5e-4)
    fillet = 0.25 / (1.0 - np.sin(np.radians(20.0)))
    for teeth in (10.0, 14.0, 17.0, 25.0):
        pair = pair_of(roller_teeth=teeth, addendum=1.0, clearance=0.25, roller_fillet=fillet)
        assert undercut_limit(pair) == pytest.approx((least - teeth) / least, abs=1e-12)


def test_margins_and_objectives_answer_where_the_calculation_refuses(recwarn: pytest.WarningsRecorder) -> None:
    pair = pair_of(roller_shift=np.array([-3.0, -1.0, -0.3, 0.21]))
    margins, objectives = margins_of(pair), objectives_of(pair)
    involute = np.asarray(margins.margin_involute)
    sliding, difference = np.asarray(margins.margin_sliding), np.asarray(objectives.sliding_difference)
    assert np.isnan(involute[0])  # no tip angle inside the base circle
    assert np.asarray(margins.margin_ring_base)[0] < 0.0
    assert (involute[1:] > 0.0).tolist() == [False, False, True]
    assert np.isnan(sliding).tolist() == np.isnan(difference).tolist() == [True, True, True, False]
    assert not np.isnan(np.asarray(objectives.shift_sum)).any()
    assert not kept(pair, 4)[:3].any()
    assert not recwarn.list


def test_every_refused_shift_has_a_margin_below_0_or_none() -> None:
    shifts = np.linspace(-2.0, 3.0, 1001)
    setup = default_setup(ROLLER_SCREW_SHIFT)
    rows = evaluate_rows(setup, {"roller_shift": shifts}, len(shifts))
    assert rows.failed.any()
    assert not (rows.failed & kept(pair_of(roller_shift=shifts), len(shifts))).any()


@pytest.mark.parametrize(("changed", "words"), REFUSED)
def test_what_no_pair_can_have_is_refused_by_name(changed: dict[str, float], words: str) -> None:
    with pytest.raises(InfeasibleError) as refusal:
        ROLLER_SCREW_SHIFT.function(pair_of(**changed))
    assert words in str(refusal.value)
    assert str(refusal.value).count(".") == str(refusal.value).count(" 30.")  # one sentence


def test_random_pairs_are_answered_with_numbers_or_refused_with_a_reason() -> None:
    rng, count = np.random.default_rng(3), 4000
    roller = rng.integers(8, 60, count).astype(float)
    difference = rng.integers(4, 150, count).astype(float)
    columns = {
        "roller_teeth": roller,
        "ring_teeth": roller + difference,
        "pressure_angle": np.radians(rng.uniform(10.01, 29.99, count)),
        "addendum": rng.uniform(0.05, 2.0, count),
        "clearance": rng.uniform(0.0, 1.0, count),
        "roller_fillet": rng.uniform(0.0, 0.6, count),
        "ring_fillet": rng.uniform(0.0, 0.5, count),
        "centre_distance": 0.25e-3 * difference * rng.uniform(0.93, 1.2, count),
        "roller_shift": rng.uniform(-2.0, 3.0, count),
    }
    rows = evaluate_rows(default_setup(ROLLER_SCREW_SHIFT), columns, count)
    assert 0.1 < rows.failed.mean() < 0.9
    assert not any("not finite" in reason for reason in rows.reasons.values())
    assert all(np.isfinite(values[~rows.failed]).all() for values in rows.results.values())
