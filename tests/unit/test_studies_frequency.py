"""Poles, gain and phase, frequencies over speed: against closed forms and scipy's linear systems."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kettle import Kettle
from oscillator import OSCILLATOR
from scipy import signal

from shared import ROOT, TESTS, Calc
from truing import (
    Dynamics,
    Float,
    Frequency,
    FrequencyAnswer,
    Model,
    Motion,
    axis,
    found,
    given,
    inputs,
    load,
    results,
    state,
    states,
)
from truing.calculation import calculate
from truing.errors import ConvergenceError, UsageError
from truing.setup import default_setup


def answer_of(model: Model[Any, Any], study: Frequency, **values: Any) -> FrequencyAnswer:
    outcome = calculate(replace(default_setup(model, **values), studies=(study,))).outcomes[study.name]
    assert isinstance(outcome, FrequencyAnswer)
    return outcome


@inputs
class Rotor:
    """Two inertias on a shaft, or a disc that whirls."""

    times: Float = given((0.0, 1.0), "s", along="time")
    torque: Float = given((0.0,), "N*m", along="time")
    motor: Float = given(0.4, "kg*m^2")
    load: Float = given(0.1, "kg*m^2")
    stiffness: Float = given(2000.0, "N*m/rad")
    damping: Float = given(0.5, "N*m*s/rad")
    speed: Float = given(0.0, "rpm")


@results
class Turned:
    """The record."""

    time: Float = axis("s", follows="times")
    twist: Float = found("deg", along="time")
    shaft: Float = found("N*m", along="time", note="torque of the shaft")


@states
class Torsion:
    """Two inertias."""

    first: Float = state("rad", start=0)
    second: Float = state("rad", start=0)
    first_speed: Float = state("rad/s", start=0)
    second_speed: Float = state("rad/s", start=0)


def twisting(torsion: Torsion, rotor: Rotor, time: Float) -> Torsion:
    """A shaft between two inertias."""
    shaft = rotor.stiffness * (torsion.first - torsion.second)
    shaft = shaft + rotor.damping * (torsion.first_speed - torsion.second_speed)
    return Torsion(
        first=torsion.first_speed, second=torsion.second_speed,
        first_speed=(rotor.torque - shaft) / rotor.motor, second_speed=shaft / rotor.load,
    )  # fmt: skip


def twisted(rotor: Rotor, motion: Motion[Torsion]) -> Turned:
    """The record as it is read."""
    twist = np.asarray(motion.states.first) - motion.states.second
    return Turned(time=motion.time, twist=twist, shaft=rotor.stiffness * twist)


TORSION = Model(name="torsion", title="Two inertias", function=Dynamics(rate=twisting, gives=twisted))


@states
class Whirl:
    """A disc at the end of a shaft, whose axis tilts to two sides."""

    over: Float = state("rad", start=0)
    aside: Float = state("rad", start=0)
    over_speed: Float = state("rad/s", start=0)
    aside_speed: Float = state("rad/s", start=0)


def whirling(whirl: Whirl, rotor: Rotor, time: Float) -> Whirl:
    """A gyroscope on an elastic shaft: polar inertia ``motor``, across ``load``."""
    spin = 2 * np.pi * rotor.speed * rotor.motor
    return Whirl(
        over=whirl.over_speed, aside=whirl.aside_speed,
        over_speed=(-rotor.stiffness * whirl.over - spin * whirl.aside_speed) / rotor.load,
        aside_speed=(-rotor.stiffness * whirl.aside + spin * whirl.over_speed) / rotor.load,
    )  # fmt: skip


def whirled(rotor: Rotor, motion: Motion[Whirl]) -> Turned:
    """The record as it is read."""
    return Turned(time=motion.time, twist=motion.states.over, shaft=motion.states.aside)


WHIRL = Model(name="whirl", title="A disc", function=Dynamics(rate=whirling, gives=whirled))


def test_an_oscillator_has_the_poles_and_the_response_of_the_closed_form() -> None:
    """w0 = sqrt(c / m), D = d / (2 sqrt(c m)); G = 1 / (c - m w^2 + i d w). States of events have no pole."""
    answer = answer_of(OSCILLATOR, Frequency(input="force", output="position", frequencies="0.01..10 Hz"))
    expected = -0.6 + 1j * np.sqrt(9 - 0.36)
    assert answer.system.poles == pytest.approx([expected, expected.conjugate()], rel=1e-10)
    assert answer.system.at[0] == pytest.approx(1 / 9, rel=1e-10)
    w = 2 * np.pi * answer.frequencies
    assert answer.response == pytest.approx(1 / (9 - w**2 + 1.2j * w), rel=1e-9)
    assert answer.gain_unit == "m/N"
    assert answer.phase[[0, -1]] == pytest.approx([0, -180], abs=2)


def test_a_pendulum_is_linearised_where_it_hangs_or_where_one_says() -> None:
    """w^2 = m g l / J below; standing on its head w^2 is negative: one pole grows."""
    pendulum = load(ROOT / "docs" / "examples" / "geared_pendulum" / "geared_pendulum.py").offer.model
    weight, inertia = 1.2 * 9.80665 * 0.5, 0.02 + 1.2 * 0.25
    hanging = answer_of(pendulum, Frequency())
    assert hanging.system.at[0] == pytest.approx(0, abs=1e-9)
    assert hanging.poles.imag == pytest.approx([np.sqrt(weight / inertia)], rel=1e-9)
    standing = answer_of(pendulum, Frequency(point={"angle": "180 deg", "speed": "0 rad/s"}))
    assert sorted(standing.poles.real) == pytest.approx([-np.sqrt(weight / inertia), np.sqrt(weight / inertia)])
    assert "does not come back" in standing.blocks()[0].text  # type: ignore[union-attr]


def test_two_inertias_have_one_torsional_frequency_and_turn_freely() -> None:
    """w^2 = k (1/J1 + 1/J2); from torque to the shaft's, as scipy.signal has it."""
    answer = answer_of(TORSION, Frequency(input="torque", output="shaft", frequencies="1..100 Hz"))
    sizes = np.abs(answer.system.poles)
    assert sizes[-1] == pytest.approx(np.sqrt(2000 * (1 / 0.4 + 1 / 0.1)), rel=1e-9)
    assert sizes[:2] == pytest.approx([0, 0], abs=1e-4)
    system = ([2000 / 0.4], [1, 0.5 * 12.5, 2000 * 12.5])
    _, expected = signal.freqresp(system, 2 * np.pi * answer.frequencies)
    assert answer.response == pytest.approx(expected, rel=1e-7)


def test_a_disc_whirls_forward_and_backward_and_meets_the_orders_of_its_speed() -> None:
    """It w^2 -+ Ip W w - k = 0: forward and backward; backward meets 1x at W^2 = k / (It + Ip), forward never here."""
    study = Frequency(over="speed", at="0..3000 rpm", steps=61, orders=(1.0, 2.0))
    answer = answer_of(WHIRL, study)
    campbell = answer.campbell
    assert campbell is not None
    half = 0.5 * 4 * 2 * np.pi * campbell.axis
    expected = np.sort([np.sqrt(half**2 + 2e4) - half, np.sqrt(half**2 + 2e4) + half], axis=0).T / (2 * np.pi)
    assert np.sort(campbell.frequencies, axis=1) == pytest.approx(expected, rel=1e-8)
    crossings = {order: at for order, at, _ in campbell.crossings()}
    backward = {order: np.sqrt(2000 / (order**2 * 0.1 + order * 0.4)) / (2 * np.pi) for order in (1.0, 2.0)}
    assert crossings == pytest.approx(backward, rel=2e-3)
    drawn = [block for block in answer.blocks() if hasattr(block, "draw")]
    assert len(drawn[0].draw().axes[0].lines) == 2 + 2 + 2


@states
class Filtered:
    """A value behind a filter."""

    value: Float = state("degC", start="start")


def filtering(filtered: Filtered, kettle: Kettle, time: Float) -> Filtered:
    """0.8 of what it was, 0.2 of the room."""
    return Filtered(value=0.8 * filtered.value + 0.2 * kettle.room)


@results
class Smoothed:
    """The record."""

    time: Float = axis("s", follows="times")
    value: Float = found("degC", along="time")


def smoothed(kettle: Kettle, motion: Motion[Filtered]) -> Smoothed:
    """The record as it is read."""
    return Smoothed(time=motion.time, value=motion.states.value)


def test_a_law_in_steps_has_the_pole_that_it_samples() -> None:
    """z = 0.8 each 60 s is a lag of -60 s / ln 0.8; G = 0.2 / (z - 0.8) up to half the sampling frequency."""
    model = Model(name="filter", title="A filter", function=Dynamics(step=filtering, gives=smoothed))
    answer = answer_of(model, Frequency(input="room", output="value"), start=323.15)
    assert answer.poles == pytest.approx([np.log(0.8) / 60], rel=1e-9)
    assert answer.system.at == pytest.approx([293.15], rel=1e-9)
    assert answer.frequencies[-1] == pytest.approx(0.5 / 60)
    _, expected = signal.dfreqresp(([0.2], [1, -0.8], 60.0), 2 * np.pi * answer.frequencies * 60.0)
    assert answer.response == pytest.approx(expected, rel=1e-8)


def rubbing(torsion: Torsion, rotor: Rotor, time: Float) -> Torsion:
    """Dry friction bends at rest."""
    return Torsion(
        first=torsion.first_speed, second=torsion.second_speed,
        first_speed=-np.abs(torsion.first_speed) - torsion.first, second_speed=-torsion.second_speed,
    )  # fmt: skip


def driving(torsion: Torsion, rotor: Rotor, time: Float) -> Torsion:
    """It turns ever faster."""
    return Torsion(first=torsion.first_speed, second=torsion.second_speed, first_speed=1.0, second_speed=1.0)


def test_a_law_that_bends_is_warned_of() -> None:
    model = Model(name="rub", title="Rub", function=Dynamics(rate=rubbing, gives=twisted))
    (said,) = answer_of(model, Frequency()).warnings()
    assert "the law bends at this value of 'first_speed'" in said


@pytest.mark.parametrize(
    ("law", "options", "error", "sentence"),
    [
        (driving, {}, ConvergenceError, "no equilibrium was found from the start: first_speed and second_speed still"),
        (twisting, {"output": "twst"}, UsageError, "'twst' is no state and no result along time.*mean 'twist'"),
        (twisting, {"input": "torqe"}, UsageError, "'torqe' is no number.* mean 'torque'"),
        (twisting, {"input": "times"}, UsageError, "'times' is no number"),
        (twisting, {"point": {"fist": "1 rad"}}, UsageError, "no state 'fist'.* mean 'first'"),
        (twisting, {"point": {"first": "1 kg"}}, UsageError, "point: first: '1 kg' is a mass"),
        (twisting, {"frequencies": "0..10 Hz"}, UsageError, "begin above 0"),
    ],
)
def test_what_cannot_be_answered_is_refused(law: Any, options: Any, error: Any, sentence: str) -> None:
    model = Model(name="torsion", title="Two inertias", function=Dynamics(rate=law, gives=twisted))
    with pytest.raises(error, match=sentence):
        answer_of(model, Frequency(**options))


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"points": 1}, "points = 1"),
        ({"point": "middle"}, 'neither "equilibrium" nor "start"'),
        ({"over": "speed"}, "over and at go together"),
    ],
)
def test_wrong_options_are_refused(options: Any, sentence: str) -> None:
    with pytest.raises(UsageError, match=sentence):
        Frequency(**options)


def test_a_model_that_stands_still_has_no_frequencies() -> None:
    with pytest.raises(UsageError, match="does not move, so it has no frequencies"):
        load("rv_gearing").study(Frequency(), progress=False)


def test_command_line_and_python_ask_for_the_same(calc: Calc, tmp_path: Path) -> None:
    """At resonance of a light damping the gain is 1 / (d w), the poles those of the closed form."""
    (tmp_path / "oscillator.py").write_bytes((TESTS / "data" / "oscillator.py").read_bytes())
    (tmp_path / "inputs.toml").write_text(
        '[inputs]\ndamping = "0.06 N*s/m"\n[studies.frequency]\nfrequencies = "0.47746482927 Hz"\n', encoding="utf-8"
    )
    assert calc("run", "oscillator.py", "-i", "inputs.toml", "-o", "out").code == 1  # a limit that no study decides
    found = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["studies"]["frequency"]
    assert found["response"]["gain"] == pytest.approx([1 / (0.06 * 3)], rel=1e-6)
    assert found["poles"][0]["damping_ratio"] == pytest.approx(0.01, rel=1e-9)
    assert found["at"]["position"] == {"value": pytest.approx(1 / 9), "unit": "m"}
    sheet = (tmp_path / "out" / "sheet.md").read_text(encoding="utf-8")
    assert "Gain and phase: position over force" in sheet
    shown = load(tmp_path / "oscillator.py").frequency("force", "speed", damping=0.06, over="stiffness", at="4, 9 N/m")
    campbell = shown.outcome.campbell  # type: ignore[attr-defined]
    assert campbell.frequencies[:, 0] * 2 * np.pi == pytest.approx(np.sqrt(np.array([4, 9]) - 0.03**2), rel=1e-9)
    assert shown.frame("Poles").shape == (1, 4)
