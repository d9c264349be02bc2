"""A press under load with something wrong: each effect against the energy of a press of its own.

The press of ``loaded_press`` hides it: exact lengths and angles, and the place where its energy is least. Whether a
diagnosis finds it in a record takes long: ``tests/torture/test_loaded_press_named.py``.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from hidden_effects.loaded_press import LoadedMachine, shown
from hidden_effects.rigs import model_of
from hidden_effects.rows import Array
from truing.evaluate import evaluate
from truing.setup import SwitchedOn, default_setup

LOADED = "press_linkage.loaded"
START, END, TURNS_PER_SECOND = np.radians(-60.0), np.radians(12.0), 1e-3
RESULTS = ("deflection", "slider_tilt")
HIDDEN: Mapping[str, tuple[dict[str, Any], dict[str, float]]] = {
    "off_centre": ({"offset": 0.15}, {"shift": 0.15}),
    "loose_joints": ({"play": 25e-6}, {"play": 25e-6}),
    "worn_guides": ({"clearance": 200e-6}, {"wear": 200e-6}),
    "worn_platform_guides": ({"platform_clearance": 200e-6}, {"wear": 200e-6}),
    "soft_frame": ({"ground": (0.6, 0.6)}, {"loss": 0.4}),
    "warm_links": ({"warm": 11.5e-6 * 6}, {"rise": 6.0}),
    "warm_frame": ({"frame": 11.5e-6 * 4}, {"rise": 4.0}),
    "inclined_guides": ({"lean": 2e-4}, {"inclination": 2e-4}),
}
"""What the press has more of by each effect (shares of the frame), and its unknown, SI."""


def with_hidden(machine: LoadedMachine, effect: str) -> LoadedMachine:
    """The press with something wrong."""
    more = dict(HIDDEN[effect][0]) if effect else {}
    if "ground" in more:
        more["ground"] = tuple(share * whole for share, whole in zip(more["ground"], machine.ground, strict=True))
    else:
        more = {name: getattr(machine, name) + value for name, value in more.items()}
    return replace(machine, **more)


def stroke(count: int) -> tuple[Array, Array, Array]:
    """Times, crank angles and forces of a slow working stroke."""
    angle = np.linspace(START, END, count)
    force = np.interp(np.degrees(angle), [-45, -30, 0, 3], [0.0, 1e6, 2e6, 0.0])
    return (angle - START) / (2 * np.pi * TURNS_PER_SECOND), angle, force


@cache
def right(count: int) -> dict[str, Array]:
    """What the gauges show where nothing is wrong."""
    return shown(LoadedMachine(), *stroke(count)[1:])


@pytest.mark.parametrize("effect", HIDDEN)
def test_each_effect_is_that_of_a_press_of_its_own(effect: str) -> None:
    """To what the first order of the displacements leaves out, their square over a metre."""
    times, angle, force = stroke(4)
    model = model_of(LOADED)
    setup = default_setup(model, times=times, start_angle=START, speed=TURNS_PER_SECOND, forming_force=force)
    plain = evaluate(setup)
    on = evaluate(replace(setup, effects=(SwitchedOn(model.effects[effect], HIDDEN[effect][1]),)))
    true = shown(with_hidden(LoadedMachine(), effect), angle, force)
    for result in RESULTS:
        change = np.asarray(getattr(on, result)) - np.asarray(getattr(plain, result))
        assert change == pytest.approx(true[result] - right(4)[result], abs=3e-6)
    assert max(np.max(np.abs(true[result] - right(4)[result])) for result in RESULTS) > 30e-6
