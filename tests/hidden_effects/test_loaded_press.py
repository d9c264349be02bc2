"""A press under load with something wrong: each effect against the energy of a press of its own, and is it named?

The press of ``loaded_press`` hides it: exact lengths and angles, and the place where its energy is least. Here a
diagnosis is asked about a press that was measured when it was new; about presses that scatter it is asked in
``tests/torture/test_loaded_press_named.py``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from hidden_effects.loaded_press import LoadedMachine, shown
from hidden_effects.rigs import demand_first, model_of
from hidden_effects.rows import Array
from truing.evaluate import evaluate
from truing.setup import SwitchedOn, default_setup
from truing.testing import recorded
from truing.testing.hiding import csv_of

LOADED = "press_linkage.loaded"
START, END, TURNS_PER_SECOND = np.radians(-60.0), np.radians(12.0), 1e-3
RESULTS = ("deflection", "slider_tilt", "platform_tilt", "ground_rise_1", "ground_rise_2")
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


def stroke(count: int, start: float = START) -> tuple[Array, Array, Array]:
    """Times, crank angles and forces of a slow working stroke, or of one that begins farther up."""
    angle = np.linspace(start, END, count)
    force = np.interp(np.degrees(angle), [-45, -30, 0, 3], [0.0, 1e6, 2e6, 0.0])
    return (angle - start) / (2 * np.pi * TURNS_PER_SECOND), angle, force


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


# Is it named from a record?

SLIDER = ("deflection", "slider_tilt")
"""What gauges between slider and bolster show."""
GAUGES = {
    "deflection": ("um", 3e-6), "slider_tilt": ("urad", 2e-6), "platform_tilt": ("urad", 2e-6),
    "ground_rise_1": ("um", 1e-6), "ground_rise_2": ("um", 1e-6),
}  # fmt: skip
"""Unit and noise of each gauge, SI."""
PARTS = ("crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length", "platform_arm",
         "slider_half_width", "slider_joint_angle", "crank_pivot_radius", "crank_pivot_angle", "platform_half_width",
         "platform_joint_angle", "ground_pivot_radius", "ground_pivot_angle")  # fmt: skip
EVERY = (*PARTS, "joint_play", "guide_clearance", "guide_inclination", "joint_stiffness", "frame_stiffness",
         "load_offset")  # fmt: skip
UNITS = {"shift": 1e3, "play": 1e6, "wear": 1e6, "loss": 1e2, "rise": 1.0, "inclination": 1e3}
"""Of the registry, over SI."""


def record(machine: LoadedMachine, gauges: Sequence[str], *, seed: int, start: float = START, count: int = 16) -> str:
    """A measured stroke as CSV, with noise."""
    times, angle, force = stroke(count, start)
    truth, noise = shown(machine, angle, force), np.random.default_rng(seed)
    columns = {
        "time [s]": times,
        "start_angle [rad]": np.full(count, start),
        "speed [rpm]": np.full(count, 60 * TURNS_PER_SECOND),
        "forming_force [kN]": force / 1e3,
    }
    for name in gauges:
        unit, deviation = GAUGES[name]
        columns[f"{name} [{unit}]"] = 1e6 * (truth[name] + deviation * noise.standard_normal(count))
    return csv_of(columns)


def diagnosed(measured: str, known: Sequence[str]) -> Mapping[str, Any]:
    """What a diagnosis says to a record of a press of which so much is known and does not scatter."""
    inputs = f'plugin = "{LOADED}"\n\n[tolerances]\n' + "".join(f'{tolerance} = "off"\n' for tolerance in known)
    return recorded(model_of(LOADED), inputs=inputs, measured=measured).answered.document


def holds_the_truth(document: Mapping[str, Any], effect: str, *, within: float) -> bool:
    """Ask that the unknown of the only cause is so near to the true one; whether its interval holds that."""
    ((unknown, true),) = HIDDEN[effect][1].items()
    (cause,) = document["causes"]
    assert cause["unknowns"][unknown]["value"] == pytest.approx(UNITS[unknown] * true, rel=within)
    low, high = cause["unknowns"][unknown]["interval95"]
    return bool(low <= UNITS[unknown] * true <= high)


@pytest.mark.parametrize(
    ("effect", "gauges"),
    [("loose_joints", SLIDER), ("soft_frame", (*SLIDER, "ground_rise_1", "ground_rise_2"))],
    ids=["play", "frame"],
)
def test_what_is_wrong_with_a_press_that_was_measured_is_named_with_its_size(effect: str, gauges: Any) -> None:
    document = diagnosed(record(with_hidden(LoadedMachine(), effect), gauges, seed=3, count=10), EVERY)
    assert demand_first(document, effect)
    assert holds_the_truth(document, effect, within=0.03)


def test_noise_of_a_press_is_called_noise() -> None:
    document = diagnosed(record(LoadedMachine(), tuple(GAUGES), seed=4, count=10), EVERY)
    assert (document["verdict"], document["causes"], document["remainder"]) == ("none", [], None)
