"""What the press linkage leaves out: signs, and what holds for every effect.

What each effect does is compared with a machine of its own in ``test_effects_of_machines.py``.
"""

from dataclasses import replace
from math import radians
from typing import Any

import numpy as np
import pytest
from switched import change

from press_linkage.effects import EFFECTS
from press_linkage.model import PRESS_LINKAGE
from press_linkage.quantities import Press
from truing import Effect, Float
from truing.calculation import calculate
from truing.errors import InfeasibleError
from truing.evaluate import evaluate
from truing.setup import SwitchedOn, default_setup

SOFT = 1e-9  # 1/N, a bar of 48 cm² of steel
TURNED = np.radians([-720.0, -360.0, -180.0, -140.3, -90.0, -1.0, 0.0, 1.0, 45.0, 179.0, 180.0, 350.0, 360.0, 725.0])
BY_NAME = {effect.name: effect for effect in EFFECTS}
EVERY = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)


def press_at(crank_angle: Float = 0.0) -> Press:
    """The paper's press at a crank angle in radians."""
    return replace(PRESS_LINKAGE.inputs(), crank_angle=crank_angle)


def moved(effect: Effect[Any, Any], crank_angle: Float) -> tuple[Float, Float]:
    """What one effect does to position (m) and tilt (rad) under the conditions below."""
    known: dict[str, Float] = {**SIZES, **CONDITIONS}
    values = {each.name: known[each.name] for each in (*effect.unknowns, *effect.needs)}
    position, tilt = (
        change(PRESS_LINKAGE, result, effect.name, press_at(crank_angle), **values)
        for result in ("slider_position", "slider_tilt")
    )
    return position, tilt


# Signs


@pytest.mark.parametrize(
    ("tonnes", "lift", "force", "is_up"),
    [
        (20.0, 0.0, 0.0, False), (20.0, 0.0, 195e3, False), (20.0, 0.0, 197e3, True), (20.0, 196.133e3, 0.0, True),
        (20.0, 196.133e3, -1.0, False), (20.0, 250e3, -50e3, True), (20.0, 250e3, -60e3, False), (0.0, 0.0, 0.0, True),
    ],
)  # fmt: skip
def test_a_slider_hangs_in_its_joints_until_the_load_lifts_it(
    tonnes: float, lift: float, force: float, is_up: bool
) -> None:
    """Reference: 20 t are 196.133 kN; a lower knee link that is pressed is shorter by twice the clearance."""
    press = replace(press_at(-0.4), slider_mass=1e3 * tonnes, counterbalance=lift)
    loose = BY_NAME["joint_clearance"].function(press, clearance=2e-5, forming_force=force)
    assert loose.side_1.lower_knee_length_deviation == (-4e-5 if is_up else 4e-5)


def test_backlash_is_odd_in_the_direction_and_nothing_at_the_dead_centre() -> None:
    press, play = press_at(TURNED), {"play_before": 0.004, "play_after": 0.009}
    down, up, rest = (BY_NAME["drive_backlash"].function(press, **play, direction=d) for d in (1.0, -1.0, 0.0))
    assert np.array_equal(down.side_1.crank_angle_deviation, -up.side_1.crank_angle_deviation)
    assert np.array_equal(down.side_2.crank_angle_deviation, down.side_1.crank_angle_deviation)
    assert not np.any(rest.side_1.crank_angle_deviation)
    centre = np.isin(np.round(np.degrees(TURNED)), [-720, -360, 0, 360])
    assert np.array_equal(down.side_1.crank_angle_deviation == 0, centre)


# What holds for every effect


CONDITIONS = {
    "forming_force": 4e5, "link_temperature": 305.15, "time": 9e3, "strokes": 3e5, "speed": 0.4, "direction": 1.0,
}  # fmt: skip
SIZES = {"time_constant": 5e3, "wear": 1e-4, "clearance": 2e-5, "compliance": SOFT, "mass_compliance": 5e-6}
SIZES |= dict.fromkeys(("expansion", "expansion_1", "rise", "inclination", "height"), 1e-5)
SIZES |= dict.fromkeys(("expansion_2", "phase", "sine", "cosine", "play_before", "play_after"), 2e-3)
SIZES |= {"expansion_2": 5e-6, "cosine": -1e-3, "play_after": 3e-3}


@EVERY
@pytest.mark.parametrize(("degrees", "turned"), [(-10, 350), (5, 725), (5, -355), (180, -180), (-140, 580)])
def test_a_crank_angle_means_the_same_in_every_turn(effect: Effect[Any, Any], degrees: float, turned: float) -> None:
    here, there = (moved(effect, radians(at)) for at in (degrees, turned))
    assert here == pytest.approx(there, abs=2e-14)
    assert abs(float(here[0])) > 1e-9


@EVERY
def test_a_loop_that_does_not_close_is_still_told_by_name(effect: Effect[Any, Any]) -> None:
    setup = default_setup(PRESS_LINKAGE, knee_drive_length="0.3 m", crank_angle="-140 deg")
    values = {item.name: SIZES[item.name] for item in effect.unknowns}
    on = replace(setup, effects=(SwitchedOn(effect, values),), conditions=CONDITIONS)
    with pytest.raises(InfeasibleError, match="loop II, side 1 does not close: the knee drive is open"):
        evaluate(on)


def test_a_press_without_load_has_its_clearance_taken_up_and_no_deflection() -> None:
    setup = replace(default_setup(PRESS_LINKAGE), studies=())
    loose = SwitchedOn(BY_NAME["joint_clearance"], {"clearance": 2e-5})
    assert calculate(replace(setup, effects=(loose,))).warnings == ()
    idle = SwitchedOn(BY_NAME["elastic_deflection"], {"compliance": SOFT})
    (warning,) = calculate(replace(setup, effects=(loose, idle))).warnings
    assert warning == "effect 'elastic_deflection' is on, but 'forming_force' stays at its reference: it does nothing"
