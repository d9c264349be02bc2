"""The roller screw as a calculation: stresses by hand and as beams, objectives and their weights, limits, loads."""

from dataclasses import fields
from math import pi, sin

import numpy as np
import pytest
from numpy.typing import NDArray
from traced_gears import ALPHA, Flanks, line_of_action_meets, swept_root

from gear_geometry.roots import Cutter, cut_ring_arm, cut_ring_root, form_factor, stress_correction
from roller_screw_shift import objectives
from roller_screw_shift.calculation import MARGINS, OF_THREADS, meshing_of, undercut_limit
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.objectives import normalised
from roller_screw_shift.quantities import Meshing, Pair
from truing import TruingError
from truing.errors import InfeasibleError
from truing.evaluate import evaluate_rows
from truing.formulas import evaluate, parse
from truing.setup import default_setup

# Neutral input, a value, what it makes of the root stress of the roller and of the ring
SOCKETS = [
    ("face_load_factor", 1.3, 1.3, 1.3), ("dynamic_factor", 1.1, 1.1, 1.1), ("sharing_factor", 1.25, 1.25, 1.25),
    ("carrying_share", 0.8, 1.25, 1.25), ("rim_factor", 1.6, 1.0, 1.6),
]  # fmt: skip
DESIGN = ("shift_sum", "stress_difference", "sliding_difference")


def pair_of(**changed: object) -> Pair:
    """A pair with the defaults but for these inputs."""
    made: Pair = ROLLER_SCREW_SHIFT.inputs(**changed)
    return made


def answer_of(pair: Pair) -> Meshing:
    """What the calculation answers for one pair."""
    answer: Meshing = ROLLER_SCREW_SHIFT.function(pair)
    return answer


def test_stresses_by_hand() -> None:
    """51.943 N over 4 mm of 0.5 mm modules, times factors that an independent program printed to six digits."""
    answer = answer_of(pair_of())
    unit = 51.943 / (4.0 * 0.5)
    assert float(answer.tangential_force) == pytest.approx(51.943, rel=1e-12)
    assert float(answer.root_stress_roller) / 1e6 == pytest.approx(unit * 2.12002 * 1.86315, rel=5e-6)
    assert float(answer.root_stress_ring) / 1e6 == pytest.approx(unit * 1.83107 * 2.84399, rel=5e-6)
    assert answer.root_stress_roller == answer.nominal_stress_roller
    assert answer.root_stress_ring == answer.nominal_stress_ring


@pytest.mark.parametrize("shift", [-0.2, 0.0, 0.21, 0.5])
def test_the_nominal_stress_of_the_roller_is_that_of_a_beam(shift: float) -> None:
    """A force along the line of action at the tip bends the tooth, as traced, about the section at its root."""
    pair, flanks = pair_of(roller_shift=shift, centre_distance=0.02), Flanks(20.0, shift)
    answer, tip = answer_of(pair), 10.0 + 0.8 + shift
    chord, _, depth = swept_root(1.1, 0.3, flanks)
    meets = line_of_action_meets(flanks, tip, 1.0)
    across = flanks.base / meets  # cosine of the angle between the force and the normal of the axis
    force = 51.943 / np.cos(ALPHA)
    bending = force * across * (meets - depth) * 0.5e-3 / (4e-3 * (chord * 0.5e-3) ** 2 / 6.0)
    nominal = float(answer.nominal_stress_roller / answer.stress_correction_roller)
    assert nominal == pytest.approx(bending, rel=1e-6)


@pytest.mark.parametrize(("teeth", "shift", "addendum"), [(25.0, 0.0, None), (20.0, 0.2, 1.15)])
def test_a_ring_that_a_cutter_makes(teeth: float, shift: float, addendum: float | None) -> None:
    """Section and arm are those of the swept cutter (tested with gear geometry), and every printed formula holds."""
    pair = pair_of(
        cutter_teeth=teeth, cutter_shift=shift, **({} if addendum is None else {"cutter_addendum": addendum})
    )
    answer = answer_of(pair)
    cutter = Cutter(teeth=teeth, shift=shift, addendum=addendum or 0.8 + 0.3, fillet=0.15)
    root = cut_ring_root(cutter, 100.0, answer.ring_shift, ALPHA)
    arm = cut_ring_arm(root, 100.0, answer.ring_shift, answer.tip_radius_ring / 0.5e-3, ALPHA)
    expected = 51.943 / 2.0 * form_factor(root, arm, ALPHA) * stress_correction(root, arm)
    assert float(answer.root_stress_ring) / 1e6 == pytest.approx(float(expected), rel=1e-12)
    values = {**ROLLER_SCREW_SHIFT.read_inputs(pair), **ROLLER_SCREW_SHIFT.read_results(answer)}
    for name, item in ROLLER_SCREW_SHIFT.own_result_fields.items():
        if (text := getattr(item.spec, "formula", "")) and not item.spec.numeric:
            missed = evaluate(parse(text), values)
            wanted = 0.0 if parse(text).left is not None else float(values[name])
            assert missed == pytest.approx(wanted, rel=1e-9, abs=1e-12), name


def test_some_rings_of_a_batch_are_cut() -> None:
    chord = np.asarray(answer_of(pair_of(cutter_teeth=np.array([np.nan, 25.0, np.nan]))).cut_chord_ring)
    assert chord[0] == chord[2] == 0.0 < chord[1]


def test_neither_teeth_nor_shift_of_the_ring_matter_to_its_stress() -> None:
    one, other = pair_of(), pair_of(roller_shift=0.3, ring_teeth=90.0, centre_distance=0.0175)
    assert answer_of(one).form_factor_ring == answer_of(other).form_factor_ring
    assert answer_of(one).root_stress_ring == answer_of(other).root_stress_ring


@pytest.mark.parametrize(("name", "value", "roller", "ring"), SOCKETS)
def test_neutral_inputs_act_on_the_stresses_and_not_on_the_choice_of_the_shift(
    name: str, value: float, roller: float, ring: float
) -> None:
    base, pair = answer_of(pair_of()), pair_of(**{name: value})
    answer = answer_of(pair)
    assert answer.root_stress_roller / base.root_stress_roller == pytest.approx(roller, rel=1e-14)
    assert answer.root_stress_ring / base.root_stress_ring == pytest.approx(ring, rel=1e-14)
    for each in DESIGN:
        assert getattr(answer, each) == getattr(base, each)


def test_no_load_gives_no_stress_and_all_else_as_before() -> None:
    loaded, idle = answer_of(pair_of()), answer_of(pair_of(axial_load=0.0))
    stresses = {each.name for each in fields(loaded) if "stress_r" in each.name or each.name == "nominal_stress_ring"}
    stresses |= {"nominal_stress_roller", "stress_difference", "tangential_force"}
    stresses |= {"mean_thread_force", "thread_deflection"}
    least = {name for name in OF_THREADS if "thread_" in name or "life" in name} - stresses  # of 1 mN
    least |= {"margin_pressure", "axial_stiffness", "acting_load"}
    for each in fields(loaded):
        if each.name in least:
            assert np.isfinite(getattr(idle, each.name))
            continue
        changes = each.name in stresses and "correction" not in each.name
        assert float(getattr(idle, each.name)) == (0.0 if changes else float(getattr(loaded, each.name)))


# Limits

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


def kept(pair: Pair, count: int) -> NDArray[np.bool_]:
    """Where every margin is at least 0; NaN is not."""
    margins = np.array([np.broadcast_to(each, count) for each in (getattr(meshing_of(pair), name) for name in MARGINS)])
    with np.errstate(invalid="ignore"):
        return np.asarray((margins >= 0.0).all(axis=0))


@pytest.mark.parametrize("deviation", [0.0, 30e-6])
def test_clearances_are_those_of_circles(deviation: float) -> None:
    """Points on the circles of the roller, in the frame of the ring; 0.1 modules must be left."""
    pair = pair_of(centre_distance_deviation=deviation)
    geometry, margins = geometry_of(pair), meshing_of(pair)
    around = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 3601))
    tip = np.abs(geometry.mounted_distance + geometry.roller.tip_radius * around)
    root = np.abs(geometry.mounted_distance + geometry.roller.root_radius * around)
    opposite = geometry.ring.tip_radius + geometry.mounted_distance + geometry.roller.tip_radius * around.real.min()
    assert margins.margin_roller_root + 0.1 == pytest.approx((geometry.ring.tip_radius - root.max()) / 0.5e-3, rel=1e-9)
    assert margins.margin_ring_root + 0.1 == pytest.approx((geometry.ring.root_radius - tip.max()) / 0.5e-3, rel=1e-9)
    assert margins.margin_opposite_tips + 0.1 == pytest.approx(opposite / 0.5e-3, rel=1e-9)


def test_the_clearances_do_not_follow_the_shift() -> None:
    """The ring follows the roller, so that the fifth and sixth constraint of the paper never choose a shift."""
    margins = meshing_of(pair_of(roller_shift=np.linspace(-0.5, 0.5, 5)))
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
    found = meshing_of(pair)
    involute = np.asarray(found.margin_involute)
    sliding, difference = np.asarray(found.margin_sliding), np.asarray(found.sliding_difference)
    assert np.isnan(involute[0])  # no tip angle inside the base circle
    assert np.asarray(found.margin_ring_base)[0] < 0.0
    assert (involute[1:] > 0.0).tolist() == [False, False, True]
    assert np.isnan(sliding).tolist() == np.isnan(difference).tolist() == [True, True, True, False]
    assert not np.isnan(np.asarray(found.shift_sum)).any()
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
    rng, count = np.random.default_rng(3), 2000
    roller = rng.integers(8, 60, count).astype(float)
    difference = rng.integers(4, 150, count).astype(float)
    ranges = {
        "addendum": (0.05, 2.0), "clearance": (0.0, 1.0), "roller_fillet": (0.0, 0.6), "ring_fillet": (0.0, 0.5),
        "roller_shift": (-2.0, 3.0), "pressure_angle": (np.radians(10.01), np.radians(29.99)),
    }  # fmt: skip
    columns = {name: rng.uniform(*ends, count) for name, ends in ranges.items()}
    columns |= {"roller_teeth": roller, "ring_teeth": roller + difference}
    columns |= {"centre_distance": 0.25e-3 * difference * rng.uniform(0.93, 1.2, count)}
    rows = evaluate_rows(default_setup(ROLLER_SCREW_SHIFT), columns, count)
    assert 0.1 < rows.failed.mean() < 0.9
    assert not any("not finite" in reason for reason in rows.reasons.values())
    assert all(np.isfinite(values[~rows.failed]).all() for values in rows.results.values())


# How three objectives become one


def test_curve_rises_is_level_at_both_ends_and_clipped_beyond() -> None:
    """X/(2 pi) - sin(X)/(2 pi): at quarters of a turn sin is 1, 0 and -1."""
    quarters = [0.0, 0.25 - 1 / (2 * pi), 0.5, 0.75 + 1 / (2 * pi), 1.0]
    assert normalised(np.linspace(2.0, 5.0, 5), (2.0, 5.0)) == pytest.approx(quarters, abs=1e-15)
    values = np.asarray(normalised(np.linspace(-1.0, 2.0, 3001), (0.0, 1.0)))
    assert (np.diff(values) >= 0.0).all()
    assert (values[:1001] == 0.0).all()
    assert (values[2000:] == 1.0).all()
    step = 1e-4  # level: the third power of the distance is all that is left
    assert normalised(step, (0.0, 1.0)) == pytest.approx((2 * pi * step) ** 3 / 6 / (2 * pi), rel=1e-4)


@pytest.mark.parametrize(("place", "limit"), [(0, 2.00), (1, 13.2), (2, 0.86)])
def test_lower_limits_from_which_the_printed_weights_would_follow(place: int, limit: float) -> None:
    given, high = objectives.PRINTED_WEIGHTS[place], objectives.PRINTED_RANGES[place][1]
    found = objectives.lower_limit(given, high)
    assert found == pytest.approx(limit, abs=5e-3)
    assert objectives.weight((found, high)) == pytest.approx(given, rel=1e-12)


def test_total_objective_by_hand() -> None:
    ranges = ((0.0, 1.0), (10.0, 30.0), (0.0, 2.0))
    weights = objectives.rule_weights(ranges)
    assert weights == pytest.approx((4.0, 0.01, 1.0))
    found = objectives.total(np.array([[0.25, 0.5], [30.0, 20.0], [1.5, 2.0]]), ranges, weights)
    quarter = 0.25 - sin(pi / 2) / (2 * pi)
    assert found == pytest.approx([-4 * quarter + 0.01 + (1 - quarter), -2.0 + 0.005 + 1.0], abs=1e-14)


@pytest.mark.parametrize("reach", [(1.0, 1.0), (2.0, 1.0), (0.0, float("inf")), (float("nan"), 1.0)])
def test_a_range_without_width_is_refused(reach: tuple[float, float]) -> None:
    with pytest.raises(TruingError, match="no width"):
        objectives.weight(reach)
    with pytest.raises(TruingError, match="no width"):
        normalised(0.5, reach)
