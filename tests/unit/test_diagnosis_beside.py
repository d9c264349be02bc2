"""A second cause that shows what it is only beside the first: play in a joint, and friction that shifts its jump."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Array, Asked, ends

from truing import Condition, Effect, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from truing.diagnosis.causes import effects_of
from truing.diagnosis.engine import diagnose
from truing.diagnosis.exact import EXACTLY, alone, fitting
from truing.diagnosis.extended import Extended
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.sample import sample_of
from truing.setup import SwitchedOn


@inputs
class Joint:
    """A shaft under torque; ``kept`` is what friction keeps from it."""

    torque: Float = given(0.0, "N*m")
    rigidity: Float = given(400.0, "N*m/rad", above=0)
    kept: Float = given(0.0, "N*m")
    play: Float = given(0.0, "mrad")
    width: Float = given(1.0, "N*m", above=0)


@results
class Twist:
    """How far it turns."""

    angle: Float = found("mrad")


def shaft(joint: Joint) -> Twist:
    """A spring, and a joint that jumps where its load changes sign."""
    load = joint.torque - joint.kept
    return Twist(angle=load / joint.rigidity + joint.play / 2 * np.tanh(load / joint.width))


def lost_motion(joint: Joint, *, play: Float, width: Float) -> Joint:
    return replace(joint, play=joint.play + play, width=width)


def friction(joint: Joint, *, torque: Float, direction: Float) -> Joint:
    return replace(joint, kept=joint.kept + torque * direction)


def softening(joint: Joint, *, share: Float) -> Joint:
    return replace(joint, rigidity=joint.rigidity / (1 + share))


def waves(joint: Joint, base: Twist, *, slow: Float, fast: Float) -> Twist:
    """Go round with the torque, in two parts that are found one by one."""
    turns = joint.torque / 10
    return replace(base, angle=base.angle + slow * np.cos(2 * turns) + fast * np.cos(7 * turns))


EFFECTS = [
        Effect("lost_motion", on_inputs=lost_motion,
               unknowns=[Unknown("play", 0, 200, "mrad"), Unknown("width", 0.3, 10, "N*m")]),
        Effect("friction", on_inputs=friction, unknowns=[Unknown("torque", 0, 10, "N*m")],
               needs=[Condition("direction", "", reference=0)]),
        Effect("softening", on_inputs=softening, unknowns=[Unknown("share", -0.5, 2, "")]),
        Effect("waves", on_results=waves, unknowns=[Unknown("slow", -9, 9, "mrad"), Unknown("fast", -9, 9, "mrad")],
               parts=[["slow"], ["fast"]]),
]  # fmt: skip


def shaft_of(*effects: Effect[Any, Any], sd: str = "2 %") -> Asked:
    """A shaft with these effects whose rigidity has this standard deviation."""
    errors = [Tolerance("rigidity", normal(sd=sd)), *effects]
    model: Model[Any, Any] = Model(name="shaft", title="A shaft", function=shaft, errors=errors)
    return Asked(model, units={"torque": "N*m", "direction": "", "angle": "mrad"})


def two_sided(joint: Joint, base: Twist, *, left: Float, right: Float) -> Twist:
    """Give way by another share on each side."""
    return replace(base, angle=base.angle * (1 + np.where(joint.torque < 0, left, right)))


SIDES = Effect("two_sided", on_results=two_sided, unknowns=[Unknown("left", -1, 1, ""), Unknown("right", -1, 1, "")])


def loops(noise: float, *, play: float, held: float, rigidity: float = 405.0, wave: float = 0.0) -> dict[str, Array]:
    """Four loops of torque between -20 and 20 N m, read with noise (mrad); written out without the model's code."""
    phase = np.linspace(0, 8 * np.pi, 320)
    torque, direction = 20 * np.sin(phase), np.sign(np.cos(phase))
    load = torque - held * direction
    angle = 1e3 * load / rigidity + play / 2 * np.tanh(load / 1.5)
    angle += wave * (np.cos(torque / 5) + 0.5 * np.cos(0.7 * torque))
    read = angle + noise * np.random.default_rng(5).standard_normal(320)
    return {"torque": torque, "direction": direction, "angle": read}


def test_friction_that_shifts_the_jump_of_a_joint_is_found_beside_its_play(tmp_path: Path) -> None:
    held = 5.0
    found = shaft_of(*EFFECTS).diagnosed(tmp_path, loops(1.0, play=90.0, held=held))
    assert {cause.effect for cause in found.causes} == {"lost_motion", "friction"}
    assert found.remainder is None
    truth = {"play": 0.090, "width": 1.5, "torque": held}
    for cause in found.causes:
        for unknown in cause.unknowns:
            low, high = ends(unknown)
            assert low <= truth[unknown.name] <= high
    (gain,) = found.gain
    assert gain.rmse_after.value == pytest.approx(1e-3, rel=0.15)


def test_play_alone_is_named_alone(tmp_path: Path) -> None:
    found = shaft_of(*EFFECTS).diagnosed(tmp_path, loops(1.0, play=90.0, held=0.0))
    assert [cause.effect for cause in found.causes] == ["lost_motion"]
    assert found.unique


def test_both_are_found_where_an_input_has_moved_far(tmp_path: Path) -> None:
    """A shaft half as stiff again: what it adds is not linear in the stiffness so far from the nominal one."""
    found = shaft_of(*EFFECTS, sd="40 %").diagnosed(tmp_path, loops(1.0, play=90.0, held=3.0, rigidity=620.0))
    assert {cause.effect for cause in found.causes} == {"lost_motion", "friction"}
    assert found.remainder is None
    (stiff,) = found.calibrated
    assert stiff.value == pytest.approx(620, rel=0.02)
    assert stiff.of_its_sd == pytest.approx((stiff.value - 400) / 160, rel=1e-9)  # sd is 40 % of the nominal 400


def test_parts_of_an_effect_that_is_on_are_looked_for_and_join_it(tmp_path: Path) -> None:
    asked = shaft_of(*EFFECTS)
    setup = asked.setup.with_effects([SwitchedOn(asked.model.effects["waves"], {"slow": 6e-3})])
    found = diagnose(setup, asked.records(tmp_path, loops(0.5, play=0.0, held=0.0, wave=6.0)))
    (cause,) = found.causes
    assert cause.effect == "waves"
    (fast,) = cause.unknowns
    assert fast.name == "fast"
    assert fast.value == pytest.approx(3e-3, rel=0.1)
    assert found.extended is not None
    (joined,) = found.extended.effects
    assert joined.values == {"slow": pytest.approx(6e-3), "fast": fast.value}


def test_an_amplitude_that_the_record_does_not_excite_is_zero_beside_the_others(tmp_path: Path) -> None:
    """Torque of one sign says nothing of the other side, and the cause is switched on all the same."""
    asked, torque = shaft_of(SIDES), np.linspace(1, 20, 40)
    machine = calibration_of(asked.setup, asked.records(tmp_path, {"torque": torque, "angle": 2.6 * torque}))
    cause = next(each for each in effects_of(machine) if each.name == "two_sided")
    assert [number.name for number in cause.numbers] == ["left", "right"]
    extended = Extended(machine)
    (there,) = extended.at([cause], [([np.array([0.3, 0.04])], np.zeros(len(machine.inputs)))])
    np.testing.assert_allclose(there["angle"], 1.04 * machine.base["angle"], rtol=1e-12)
    sample = sample_of(machine, first_noise(machine), np.ones(40, dtype=bool))
    found = alone(extended, fitting(sample, extended, [cause], [np.array([0.0, 0.01])]))
    assert found is not None
    (left, right), reach = found.of(cause), 0.02 * EXACTLY**0.5  # of the rigidity, within what a fit takes as exact
    assert left == 0.0
    assert right == pytest.approx(0.04, abs=2 * reach)  # 2.6 mrad are 4 % more than 1e3/400
