"""A press in motion with something wrong: each effect against a press of its own, and found in a record of torque.

The press of ``moving_press`` hides it: other geometry, all bodies in one linear system, pins rubbing inside it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pytest

from hidden_effects.moving_press import MovingMachine, needed
from hidden_effects.rigs import demand_named, model_of
from hidden_effects.rows import Array
from truing.evaluate import evaluate
from truing.setup import SwitchedOn, default_setup
from truing.testing import recorded
from truing.testing.hiding import Answered, csv_of

MOTION, TORQUE = "press_linkage.motion", "crank_torque"
START, NOISE = -2.6, 150.0  # rad; N m
PERIOD, SWELL = 6.0, 0.4  # s of a turn; share by which the speed swells and shrinks
MEASURED = MovingMachine(slider=20100.0, lift=194e3, rotor=215.0)
"""What is weighed and read a little wrong, within its tolerance."""


@dataclass(frozen=True)
class Stroke:
    """A turn at a speed that swells, under a force that rises towards the bottom dead centre, SI."""

    time: Array

    @cached_property
    def angle(self) -> Array:
        """Crank angle as the encoder shows it."""
        whole = 2 * np.pi / PERIOD
        return np.asarray(START + whole * self.time + SWELL * (1 - np.cos(whole * self.time)))

    @cached_property
    def speed(self) -> Array:
        """Angular speed of the cranks."""
        whole = 2 * np.pi / PERIOD
        return np.asarray(whole * (1 + SWELL * np.sin(whole * self.time)))

    @cached_property
    def acceleration(self) -> Array:
        """Its derivative."""
        whole = 2 * np.pi / PERIOD
        return np.asarray(whole**2 * SWELL * np.cos(whole * self.time))

    @cached_property
    def force(self) -> Array:
        """Force on the slider."""
        return np.asarray(np.interp(np.degrees(self.angle), [-40, -30, 0, 3], [0, 1e6, 2e6, 0]))


HIDDEN: Mapping[str, tuple[dict[str, float], dict[str, float]]] = {
    "guide_friction": ({"guide": 30e3}, {"friction": 30e3}),
    "bearing_friction": ({"pins": 5e-3}, {"friction_radius": 5e-3}),
    "drive_drag": ({"drag": 1500.0}, {"drag": 1500.0}),
    "counterbalance_loss": ({"lift": 0.8}, {"loss": 0.2}),
    "heavier_slider": ({"slider": 3e3}, {"mass": 3e3}),
    "crank_phase": ({}, {"phase": 0.02}),
}
"""What the press has in place of each effect (a share of the lift, more of the slider), and its unknown, SI."""


def with_hidden(machine: MovingMachine, effect: str) -> MovingMachine:
    """The press with something wrong."""
    changes = dict(HIDDEN[effect][0]) if effect in HIDDEN else {}
    if "lift" in changes:
        changes["lift"] *= machine.lift
    if "slider" in changes:
        changes["slider"] += machine.slider
    return replace(machine, **changes)


def true_torque(machine: MovingMachine, effect: str, stroke: Stroke) -> Array:
    """Torque of one crank of this press with something wrong."""
    ahead = HIDDEN[effect][1].get("phase", 0.0) if effect in HIDDEN else 0.0
    moved = (stroke.angle + ahead, stroke.speed, stroke.acceleration, stroke.force)
    return needed(with_hidden(machine, effect), *moved).torque


@pytest.mark.parametrize("effect", HIDDEN)
def test_each_effect_is_that_of_a_press_of_its_own(effect: str) -> None:
    """At constant speed, where the law of the drive is no question, to 1e-8 of what the effect changes."""
    times = np.linspace(0.1, 4.8, 60)
    angle, still = START + 2 * np.pi * 0.2 * (times - times[0]), np.zeros(60)
    stroke = Stroke(times)
    for name, values in (("angle", angle), ("speed", still + 2 * np.pi * 0.2), ("acceleration", still)):
        stroke.__dict__[name] = values
    model = model_of(MOTION)
    setup = default_setup(model, times=times, start_angle=START, forming_force=stroke.force)
    plain = np.asarray(evaluate(setup).crank_torque)
    on = replace(setup, effects=(SwitchedOn(model.effects[effect], HIDDEN[effect][1]),))
    change = np.asarray(evaluate(on).crank_torque) - plain
    true = true_torque(MovingMachine(), effect, stroke) - true_torque(MovingMachine(), "", stroke)
    assert np.max(np.abs(true)) > 500
    assert change == pytest.approx(true, abs=1e-8 * np.max(np.abs(true)) + 1e-6)


def record(effect: str, *, seed: int, count: int = 60, strange: Any = None) -> str:
    """A measured turn as CSV: time, what the drive logs, and the torque with noise."""
    stroke = Stroke(PERIOD / count * (np.arange(count) + (seed % 2) / 2))
    torque = true_torque(MEASURED, effect, stroke) + (0.0 if strange is None else strange(stroke))
    columns = {
        "time [s]": stroke.time,
        "start_angle [rad]": np.full(count, stroke.angle[0]),
        "crank_speed [rpm]": stroke.speed * 30 / np.pi,
        "forming_force [kN]": stroke.force / 1e3,
        "crank_torque [kN*m]": (torque + NOISE * np.random.default_rng(seed).standard_normal(count)) / 1e3,
    }
    return csv_of(columns)


def answered(effect: str, strange: Any = None) -> Answered:
    """What a diagnosis says to such a record; another turn is held out."""
    rows = [record(effect, seed=seed, strange=strange) for seed in (2, 5)]
    inputs = f'plugin = "{MOTION}"\n'
    return recorded(model_of(MOTION), inputs=inputs, measured=rows[0], held_out=rows[1]).answered


def test_nothing_is_found_where_nothing_is_wrong() -> None:
    answer = answered("")
    assert (answer.document["verdict"], answer.document["causes"]) == ("none", [])
    assert answer.error_of(TORQUE) < 1.2 * NOISE


@pytest.mark.parametrize("effect", ["counterbalance_loss", "bearing_friction"])
def test_what_is_wrong_is_named_with_its_size(effect: str) -> None:
    answer = answered(effect)
    demand_named(answer.document, [{effect}])
    ((name, true),) = HIDDEN[effect][1].items()
    (cause,) = answer.document["causes"]
    unit = {"loss": 100.0, "friction_radius": 1e3}[name]
    low, high = cause["unknowns"][name]["interval95"]
    assert low <= unit * true <= high
    assert answer.document["remainder"] is None
    assert answer.error_of(TORQUE) < 1.2 * NOISE
