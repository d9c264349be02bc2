"""The roller screw as a calculation: stresses by hand and as beams, objectives, neutral inputs, loads, batches."""

from dataclasses import fields

import numpy as np
import pytest
from traced_gears import ALPHA, Flanks, line_of_action_meets, swept_root

from gear_geometry.roots import Cutter, cut_ring_arm, cut_ring_root, form_factor, stress_correction
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.objectives import objectives_of
from roller_screw_shift.quantities import Meshing, Pair
from roller_screw_shift.strength import load_of
from shared import ROUNDING
from truing.formulas import evaluate, parse

# Neutral input, a value, what it makes of the root stress of the roller and of the ring
SOCKETS = [
    ("face_load_factor", 1.3, 1.3, 1.3),
    ("dynamic_factor", 1.1, 1.1, 1.1),
    ("sharing_factor", 1.25, 1.25, 1.25),
    ("carrying_share", 0.8, 1.25, 1.25),
    ("rim_factor", 1.6, 1.0, 1.6),
]
ZERO = ("transmission_error", "wear_depth", "axial_shift", "friction_torque", "backlash")
CONDITION = 10.0
"""Of the root stress, by the angles that decide the tooth form."""
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
        if text := getattr(item.spec, "formula", ""):
            missed = evaluate(parse(text), values)
            wanted = 0.0 if parse(text).left is not None else float(values[name])
            assert missed == pytest.approx(wanted, rel=1e-9, abs=1e-12), name


def test_with_a_cutter_the_difference_of_the_stresses_reaches_0() -> None:
    """The printed range of the second objective begins at 0, which the substitute rack cannot give."""
    shifts = np.linspace(-0.05, 0.25, 301)
    rack = np.asarray(objectives_of(pair_of(roller_shift=shifts)).stress_difference)
    cut = np.asarray(objectives_of(pair_of(roller_shift=shifts, cutter_teeth=25.0)).stress_difference)
    assert rack.min() > 27e6
    assert cut.min() < 0.02e6
    assert shifts[np.argmin(cut)] == pytest.approx(0.077, abs=1e-3)  # as the page of the model says


def test_some_rings_of_a_batch_are_cut() -> None:
    answer = answer_of(pair_of(cutter_teeth=np.array([np.nan, 25.0, np.nan])))
    stress, chord = np.asarray(answer.root_stress_ring), np.asarray(answer.cut_chord_ring)
    alone = [float(answer_of(pair_of(cutter_teeth=teeth)).root_stress_ring) for teeth in (np.nan, 25.0, np.nan)]
    assert stress == pytest.approx(alone, rel=CONDITION * ROUNDING)
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
        assert getattr(objectives_of(pair), each) == getattr(base, each)


def test_what_effects_act_on_is_0() -> None:
    answer = answer_of(pair_of())
    assert [float(getattr(answer, name)) for name in ZERO] == [0.0] * 5


def test_no_load_gives_no_stress_and_all_else_as_before() -> None:
    loaded, idle = answer_of(pair_of()), answer_of(pair_of(axial_load=0.0))
    stresses = {each.name for each in fields(loaded) if "stress_r" in each.name or each.name == "nominal_stress_ring"}
    stresses |= {"nominal_stress_roller", "stress_difference", "tangential_force"}
    for each in fields(loaded):
        changes = each.name in stresses and "correction" not in each.name
        assert float(getattr(idle, each.name)) == (0.0 if changes else float(getattr(loaded, each.name)))


def test_a_load_the_other_way_stresses_alike() -> None:
    pair = pair_of(axial_load=np.array([-10e3, 0.0, 10e3]))
    answer, load = answer_of(pair), load_of(pair)
    assert list(np.asarray(load.direction)) == [-1.0, 1.0, 1.0]
    assert np.asarray(load.tangential_force) == pytest.approx([51.943, 0.0, 51.943])
    stress = np.asarray(answer.root_stress_roller)
    assert stress[0] == stress[2] > stress[1] == 0.0


def test_objectives_are_those_of_the_answer_in_one_call_and_one_by_one() -> None:
    shifts = np.linspace(-0.05, 0.25, 7)
    many = objectives_of(pair_of(roller_shift=shifts))
    for place, shift in enumerate(shifts):
        answer = answer_of(pair_of(roller_shift=float(shift)))
        for name in DESIGN:
            assert np.asarray(getattr(many, name))[place] == pytest.approx(float(getattr(answer, name)), rel=1e-13)
