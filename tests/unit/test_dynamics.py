"""The words of a model that moves: what is refused, what drives it, what a batch of machines gives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from kettle import HEATING, KETTLE, Heated, Kettle, Water, heated, heating

from truing import Dynamics, Float, Model, Motion, given, state, states
from truing.errors import ConvergenceError, DeclarationError, InfeasibleError
from truing.evaluate import evaluate, evaluate_rows
from truing.setup import default_setup


def warm_after(t: float, power: float, loss: float = 10.0, start: float = 293.15) -> float:
    """The temperature in K after a time under constant power: a lag of C / k."""
    end = 293.15 + power / loss
    return float(end + (start - end) * np.exp(-loss * t / 4000))


def test_a_motion_follows_its_law_and_says_when_events_happen() -> None:
    answer = evaluate(default_setup(KETTLE))
    assert answer.warm == pytest.approx([warm_after(60.0 * row, 1000) for row in range(11)], rel=1e-8)
    assert warm_after(answer.hot_at, 1000) == pytest.approx(333.15, rel=1e-9)


@pytest.mark.parametrize("between", ["hold", "linear"])
def test_a_drive_is_held_or_runs_straight_between_its_points(between: str) -> None:
    """After the heater is switched off at 300 s; straight, it goes out over the minute before."""
    power = np.array([1000.0] * 5 + [0.0] * 6)
    setup = default_setup(KETTLE, power=power)
    field = KETTLE.input_fields["power"]
    law = replace(HEATING)
    law.input_fields["power"] = replace(field, spec=replace(field.spec, between=between))
    warm = evaluate(replace(setup, model=replace(KETTLE, function=law))).warm
    before, off = warm_after(240.0, 1000), 300.0
    if between == "hold":
        end = warm_after(60.0, 1000, start=before)
    else:  # C T' = 1000 (1 - t / 60) - k (T - room): the particular solution falls straight, too
        slope, lag = -1000 / 60 / 10.0, 400.0
        begin = 293.15 + 100.0 - slope * lag
        end = begin + slope * 60 + (before - begin) * np.exp(-60 / lag)
    assert warm[5] == pytest.approx(end, rel=1e-9)
    assert warm[10] == pytest.approx(warm_after(600 - off, 0.0, start=end), rel=1e-9)


def test_a_batch_is_one_call_of_machines() -> None:
    losses = np.array([0.0, 5.0, 10.0, 100.0])
    rows = evaluate_rows(default_setup(KETTLE), {"loss": losses}, 4)
    expected = [[warm_after(60.0 * row, 1000, loss or 1e-9) for row in range(11)] for loss in losses]
    assert rows.results["warm"] == pytest.approx(np.array(expected), rel=1e-6)
    assert rows.absent["hot_at"] == {3: "the water never passes 60 degC"}


@states
class Filtered:
    """A value behind a filter."""

    value: Float = state("degC", start="start", rate="0.5 * (value + room)")


def filtering(filtered: Filtered, kettle: Kettle, time: Float) -> Filtered:
    """Half of what it was, half of the room."""
    return Filtered(value=0.5 * (filtered.value + kettle.room))


def filtered(kettle: Kettle, motion: Motion[Filtered]) -> Heated:
    """The record of the filter."""
    return Heated(time=motion.time, warm=motion.states.value, hot_at=0.0)


def test_a_law_in_steps_goes_from_one_time_to_the_next() -> None:
    model = Model(name="filter", title="A filter", function=Dynamics(step=filtering, gives=filtered))
    warm = evaluate(default_setup(model, start=84.15 + 273.15 - 64.15)).warm
    assert warm - 293.15 == pytest.approx((warm[0] - 293.15) * 0.5 ** np.arange(11))


def runaway(water: Water, kettle: Kettle, time: Float) -> Water:
    """More heat the warmer it is, without any bound; slower in a kettle that loses much."""
    return Water(temperature=water.temperature**2 / 1e4 / kettle.loss)


def test_a_machine_that_cannot_be_followed_fails_alone_with_its_time() -> None:
    """y' = y^2 / a from y0 ends at a / y0."""
    law = Dynamics(rate=runaway, gives=heated, events=HEATING.events)
    model = Model(name="runaway", title="A runaway", function=law)
    with pytest.raises(
        InfeasibleError, match=r"not be followed beyond t = 34\.1\d* s: a state grows beyond all bounds"
    ):
        evaluate(default_setup(model, loss=1.0))
    losses = np.array([1.0, 100.0, 2.0])
    rows = evaluate_rows(default_setup(model), {"loss": losses}, 3)
    assert rows.failed.tolist() == [True, False, True]
    alone = [evaluate_rows(default_setup(model), {"loss": losses[[row]]}, 1).reasons[0] for row in (0, 2)]
    assert [rows.reasons[0], rows.reasons[2]] == alone
    assert "t = 34.1" in alone[0]
    assert "t = 68.2" in alone[1]


def test_the_step_limit_is_an_error_of_convergence() -> None:
    model = Model(name="short", title="Few steps", function=replace(HEATING, most_steps=2))
    with pytest.raises(ConvergenceError, match="the step limit is reached"):
        evaluate(default_setup(model))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"times": np.array([0.0, 60.0, 60.0])}, "times: the times of a record rise; two are equal or fall"),
        ({"times": np.array([0.0])}, "times: a motion needs two times or more"),
        ({"power": np.ones(4)}, "power has 4 values at 11 times"),
        ({"power": np.array([1.0, np.nan, *[1.0] * 9])}, "power is missing at some of the times"),
    ],
)
def test_a_record_that_cannot_be_followed_is_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InfeasibleError, match=sentence):
        evaluate(default_setup(KETTLE, **changes))
    with pytest.raises(InfeasibleError, match=sentence):
        evaluate_rows(default_setup(KETTLE, **changes), {"loss": np.array([1.0, 2.0])}, 2)


def kettle_of(**changes: Any) -> Model[Any, Any]:
    return Model(name="kettle", title="A kettle", function=replace(HEATING, **changes))


@states
class Nowhere:
    """A state that starts at nothing that is known."""

    temperature: Float = state("degC", start="strat", rate="powr / capacity")


def nowhere(nowhere: Nowhere, kettle: Kettle, time: Float) -> Nowhere:
    """Nothing changes."""
    return nowhere


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"times": "tims"}, "the times of the motion are 'tims', which is no input series.* Did you mean 'times'"),
        ({"rate": None}, "dynamics need one of rate"),
        ({"step": heating}, "dynamics need one of rate"),
        ({"rate": None, "step": heating}, "dynamics in steps have no events"),
        ({"tolerance": 0.5}, "the tolerance of dynamics is 0.5; it lies between"),
        ({"events": [*HEATING.events, *HEATING.events]}, "two events are called 'hot'"),
        ({"rate": nowhere}, "state 'temperature' starts at 'strat', which is no input and no quantity.* mean 'start'"),
        ({"rate": nowhere}, "the rate of state 'temperature' names 'powr'"),
        ({"rate": heated}, "heated must say which @states class it takes and returns"),
        ({"gives": heating}, r"heating takes an annotated class of inputs and Motion\[...\]"),
    ],
)
def test_a_wrong_declaration_is_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError, match=sentence):
        kettle_of(**changes)


def test_a_field_that_is_no_state_is_refused() -> None:
    with pytest.raises(DeclarationError, match="'warmth' is no state: write state"):

        @states
        class Odd:
            warmth: Float = given(1.0, "K")


def without_events(law: Dynamics[Water, Kettle, Heated]) -> Dynamics[Water, Kettle, Heated]:
    return replace(law, events=(), gives=warmed)


def warmed(kettle: Kettle, motion: Motion[Water]) -> Heated:
    """The record alone."""
    return Heated(time=motion.time, warm=motion.states.temperature, hot_at=0.0)


@pytest.mark.parametrize("power", [[1000.0] * 11, [1000.0] * 5 + [0.0] * 6])
@pytest.mark.parametrize("loss", [10.0, 1e7])
def test_one_that_is_driven_is_followed_as_many_are(power: list[float], loss: float) -> None:
    """All stamps at once or one after another, where nothing changes and where it is stiff: a lag of 0.4 ms."""
    setup = default_setup(replace(KETTLE, function=without_events(HEATING)), power=np.array(power))
    alone = evaluate_rows(setup, {"loss": np.array([loss])}, 1).results["warm"][0]
    losses = np.full(100, loss)
    many = evaluate_rows(setup, {"loss": losses}, 100).results["warm"]
    assert alone == pytest.approx(many[0], rel=1e-8)
    expected, warm = [293.15], 293.15
    for each in power[:-1]:
        end = 293.15 + each / loss
        warm = end + (warm - end) * np.exp(-loss * 60 / 4000)
        expected.append(warm)
    assert alone == pytest.approx(expected, rel=1e-7)
