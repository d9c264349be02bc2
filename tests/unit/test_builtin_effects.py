"""The kernel's own effects: which a model gets, what each adds to a reading, and that no machine fails by them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pin_wear import PIN_WEAR

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Require,
    Sweep,
    Tolerance,
    Unknown,
    axis,
    column,
    found,
    given,
    inputs,
    part,
    plus_minus,
    results,
    rows,
)
from truing.calculation import calculate
from truing.declare.builtin import may_stand
from truing.diagnosis.causes import effects_of
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.reading import read_records
from truing.errors import InputError, UsageError
from truing.evaluate import evaluate, evaluate_rows
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.runs.inputs_written import complete_inputs, input_hash
from truing.setup import Setup, SwitchedOn, default_setup, effect_column


@inputs
class Shaft:
    """A shaft that turns in warm oil."""

    eccentricity: Float = given(2.0, "um", symbol="e")
    phase: Float = given(0.0, "mrad", symbol="psi")
    turn: Float = given(0.0, "deg", symbol="phi")
    pitch: Float = given(10.0, "deg", symbol="beta")
    skew: Float = given(None, "deg", symbol="gamma")
    oil: Float = given(60.0, "degC", symbol="T")


@results
class Side:
    """One end of the shaft."""

    height: Float = found("um", symbol="y")


@results
class Runout:
    """What three gauges show."""

    left: Side = part(Side, index="1")
    right: Side = part(Side, index="2")
    warmth: Float = found("degC", symbol="T_1")


def runout(shaft: Shaft) -> Runout:
    """An eccentric circle."""
    height = shaft.eccentricity * np.cos(shaft.turn + shaft.phase)
    return Runout(left=Side(height=height), right=Side(height=2 * height), warmth=shaft.oil + 10 + 0 * height)


SHAFT = Model(
    name="shaft",
    title="Eccentric shaft",
    function=runout,
    errors=[Tolerance("phase", plus_minus("1 mrad"))],
    objectives=[Require("height_left", at_most="3 um")],
    studies=[Sweep(over="turn", at="-180..180 deg", points=5)],
)
OFFER = Offer("shaft", SHAFT, Origin("shaft", "1.0", "", "", f"module:{__name__}"))


def shown(model: Model[Any, Any], effects: Mapping[str, Mapping[str, float]], **values: Any) -> dict[str, Any]:
    """What the gauges show at the defaults, with these effects on (SI) and inputs as stated."""
    conditions = {name: value for name, value in values.items() if name in model.known_conditions}
    stated = {name: value for name, value in values.items() if name not in conditions}
    on = tuple(SwitchedOn(model.known_effects[name], unknowns) for name, unknowns in effects.items())
    setup = replace(default_setup(model, **stated), effects=on)
    setup = replace(setup, conditions={**setup.conditions, **conditions})
    return model.read_results(evaluate(setup, reading=True))


def read_text(text: str, offer: Offer = OFFER, **more: Any) -> Setup:
    return setup_from_text(text, offer, file="shaft.toml", folder=Path(), **more)


def faults(text: str) -> list[str]:
    with pytest.raises(InputError) as error:
        read_text(text)
    return str(error.value).splitlines()


# Which effects a model gets


def test_every_model_gets_the_six_over_each_of_its_results() -> None:
    effects = SHAFT.known_effects
    assert list(effects) == [
        "sensor_offset", "sensor_gain", "sensor_drift", "thermal_drift", "periodic_order", "periodic_order_of_pitch",
        "step",
    ]  # fmt: skip
    assert all(effect.place == "reading" for effect in effects.values())
    assert all(effect.looks_like and effect.remedy and effect.why and effect.source for effect in effects.values())
    names = ("height_left", "height_right", "warmth")
    for plain in ("sensor_offset", "sensor_gain", "sensor_drift", "thermal_drift"):
        assert effects[plain].parts == tuple((name,) for name in names)
    assert effects["periodic_order"].parts == tuple((f"{n}_sine", f"{n}_cosine", f"{n}_order") for n in names)
    assert effects["step"].parts == tuple((n, f"{n}_after") for n in names)
    assert SHAFT.effects == {}
    # what is swept is the first angle; those that scatter or may be left open are none
    assert (effects["periodic_order"].reads, effects["periodic_order_of_pitch"].reads) == (("turn",), ("pitch",))


def test_unknowns_have_the_unit_of_a_difference_of_their_result() -> None:
    unknowns = {
        (name, unknown.name): unknown for name, effect in SHAFT.known_effects.items() for unknown in effect.unknowns
    }
    units = {key: unknown.unit for key, unknown in unknowns.items()}
    assert units["sensor_offset", "warmth"] == "K"
    assert units["sensor_offset", "height_left"] == "um"
    assert units["sensor_gain", "warmth"] == ""
    assert units["sensor_drift", "height_left"] == "um/h"
    assert units["thermal_drift", "warmth"] == "K/K"
    assert units["periodic_order", "height_right_sine"] == units["periodic_order", "height_right_cosine"] == "um"
    assert units["step", "warmth"] == "K"
    assert units["step", "warmth_after"] == "h"
    order, after = unknowns["periodic_order", "warmth_order"], unknowns["step", "warmth_after"]
    assert (order.low, order.high, order.whole, order.is_amplitude) == (1, 3, True, False)
    assert (after.along, after.is_amplitude) == ("time", False)


def _lifted_with(shaft: Shaft, *, lift: Float, it: Float) -> Shaft:
    return replace(shaft, eccentricity=shaft.eccentricity + lift * it)


@pytest.mark.parametrize(
    ("condition", "name", "others"),
    [
        (Condition("it", "rad"), "periodic_order", ["turn", "pitch"]),
        (Condition("it", "degC", reference=30), "thermal_drift", ["oil"]),
    ],
)
def test_angles_and_temperatures_are_conditions_first_and_then_inputs(
    condition: Condition, name: str, others: list[str]
) -> None:
    """Without a sweep no input is the angle before another one."""
    own = Effect("own", on_inputs=_lifted_with, unknowns=[Unknown("lift", -1, 1, "um")], needs=[condition])
    model = replace(SHAFT, studies=[], errors=[*SHAFT.errors, own])
    effects = [effect for effect in model.known_effects if effect.startswith(name)]
    assert effects == [name, *(f"{name}_of_{other}" for other in others)]
    assert model.known_effects[name].needs == (condition,)
    assert "temperature" not in model.known_conditions or condition.unit == "rad"


@inputs
class Warm(Shaft):
    """The same shaft with a socket for a rise of temperature."""

    rise: Float = given(0.0, "K")


def test_a_rise_is_the_temperature_of_nothing_unless_a_record_varies_it() -> None:
    model = replace(SHAFT, function=_warm)
    drifts = {name: may_stand(effect) for name, effect in model.known_effects.items() if name.startswith("thermal")}
    assert drifts == {"thermal_drift": False, "thermal_drift_of_rise": True}
    assert model.known_effects["thermal_drift"].reads == ("oil",)


def _warm(shaft: Warm) -> Runout:
    return runout(shaft)


@pytest.mark.parametrize(
    ("pitch", "offered"),
    [("10 20 30 40 50 60", False), ("0 60 120 180 240 300", True), ("-40 300 -40 300 -40 300", True), (None, False)],
)
def test_the_wave_of_an_input_is_looked_for_where_a_record_turns_it_round(
    tmp_path: Path, pitch: str | None, offered: bool
) -> None:
    """A pitch that differs from gear to gear is an angle, and turns nothing."""
    cells = pitch.split() if pitch else ["7"] * 6
    lines = ["turn [deg],pitch [deg],height_left [um]", *(f"{30 * at},{cell},{at}" for at, cell in enumerate(cells))]
    file = tmp_path / "record.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    setup = default_setup(SHAFT, OFFER.origin)
    records = read_records([file], OFFER, setup)
    names = {candidate.name for candidate in effects_of(calibration_of(setup, records))}
    assert "periodic_order" in names
    assert ("periodic_order_of_pitch" in names) is offered
    assert records.covariates["turn"].is_angle
    assert records.covariates["pitch"].is_angle is offered


@inputs
class Bar:
    """A bar that knows no angle, no temperature and no time."""

    load: Float = given(10.0, "N", symbol="F")


@results
class Pull:
    """One number."""

    force: Float = found("N", symbol="F_1")


def pull(bar: Bar) -> Pull:
    """The same."""
    return Pull(force=bar.load)


BAR = Model(name="bar", title="Bar", function=pull)


def test_without_any_of_its_own_a_model_gets_the_conditions_of_the_kernel() -> None:
    assert list(BAR.known_effects) == [
        "sensor_offset", "sensor_gain", "sensor_drift", "thermal_drift", "periodic_order", "step",
    ]  # fmt: skip
    known = BAR.known_conditions
    assert {name: (item.unit, item.reference, item.derived) for name, item in known.items()} == {
        "time": ("h", 0, "since_start"), "temperature": ("degC", 20, ""), "angle": ("deg", 0, ""),
    }  # fmt: skip
    assert BAR.conditions == {}


def test_a_model_of_its_own_effect_keeps_it() -> None:
    own = Effect("sensor_offset", on_reading=_own_offset, unknowns=[Unknown("zero", -1, 1, "N")])
    model = replace(BAR, errors=[own])
    assert model.known_effects["sensor_offset"] is own
    assert next(iter(model.known_effects)) == "sensor_offset"


def _own_offset(bar: Bar, base: Pull, *, zero: Float) -> Pull:
    return replace(base, force=base.force + zero)


# What they add to a reading, by hand


TOP = {"height_left": 2e-6, "height_right": 4e-6, "warmth": 343.15}
WAVES = [(1, 0, 2.0), (1, 90, 1.0), (2, 45, 1.0), (2, 90, -2.0), (3, 30, 1.0), (3, 60, -2.0)]
STEP = {"step": {"force": 3.0, "force_after": 2 * 3600.0}}
WARMER = {"thermal_drift": {"force": 0.2}}


@pytest.mark.parametrize(
    ("model", "effects", "values", "read"),
    [
        # 2 um and 4 um at the top; 70 degC. A gain of a level counts from 0 degC: 1 % of 70 degC is 0.7 K
        (SHAFT, {}, {}, TOP),
        (SHAFT, {"sensor_offset": {"height_right": 3e-6, "warmth": -2.0}}, {},
         {**TOP, "height_right": 7e-6, "warmth": 341.15}),
        (SHAFT, {"sensor_gain": {"height_left": 0.5, "warmth": 0.01}}, {},
         {**TOP, "height_left": 3e-6, "warmth": 343.85}),
        # 10 N + 0.5 N/h over 4 h; (10 N + 2 N) * 1.1: the offset comes before the gain
        (BAR, {"sensor_drift": {"force": 0.5 / 3600}}, {"time": 4 * 3600.0}, {"force": 12.0}),
        (BAR, {"sensor_gain": {"force": 0.1}, "sensor_offset": {"force": 2.0}}, {}, {"force": 13.2}),
        # 0.2 N/K: 5 K above 20 degC are 1 N. 3 um/K: the oil 2 K below its default of 60 degC takes 6 um off
        (BAR, WARMER, {}, {"force": 10.0}),
        (BAR, WARMER, {"temperature": 298.15}, {"force": 11.0}),
        (SHAFT, {"thermal_drift": {"height_left": 3e-6}}, {"oil": "58 degC"},
         {**TOP, "height_left": -4e-6, "warmth": 341.15}),
        # 1 N of sine and 2 N of cosine, at a quarter of the wave and at its half
        *((BAR, {"periodic_order": {"force_sine": 1.0, "force_cosine": 2.0, "force_order": order}},
           {"angle": math.radians(degrees)}, {"force": 10 + added}) for order, degrees, added in WAVES),
        # a step stays
        *((BAR, STEP, {"time": hours * 3600}, {"force": force}) for hours, force in ((1.9, 10), (2.0, 13), (7.0, 13))),
    ],
)  # fmt: skip
def test_what_an_effect_adds_to_a_reading(
    model: Model[Any, Any], effects: dict[str, dict[str, float]], values: dict[str, Any], read: dict[str, float]
) -> None:
    found_ = shown(model, effects, **values)
    assert {name: found_[name] for name in read} == pytest.approx(read)


def test_rows_have_their_own_unknowns_conditions_and_inputs() -> None:
    on = SwitchedOn(BAR.known_effects["sensor_drift"], {"force": 0.0})
    setup = replace(default_setup(BAR), effects=(on,))
    columns = {
        "time": np.array([0.0, 10.0, 20.0]),
        "load": np.array([1.0, 2.0, 3.0]),
        effect_column("sensor_drift", "force"): np.array([5.0, 5.0, 0.1]),
    }
    found_ = evaluate_rows(setup, columns, 3, reading=True)
    np.testing.assert_allclose(found_.results["force"], [1.0, 52.0, 5.0])
    np.testing.assert_allclose(evaluate_rows(setup, columns, 3).results["force"], [1.0, 2.0, 3.0])


def test_a_missing_time_spoils_only_what_drifts() -> None:
    on = SwitchedOn(SHAFT.known_effects["sensor_drift"], {"height_left": 1.0})
    found_ = evaluate_rows(replace(default_setup(SHAFT), effects=(on,)), {"time": np.array([1.0, math.nan])}, 2,
                           reading=True, wanted=["height_right"])  # fmt: skip
    np.testing.assert_allclose(found_.results["height_right"], [4e-6, 4e-6])


def test_zero_is_the_base_whatever_the_shapes() -> None:
    base = shown(SHAFT, {}, turn="33 deg", oil="71 degC")
    for name, effect in SHAFT.known_effects.items():
        for share in (0.0, 1.0):
            values = {
                item.name: 0.0 if item.is_amplitude else item.low + share * (item.high - item.low)
                for item in effect.unknowns
            }
            assert shown(SHAFT, {name: values}, turn="33 deg", oil="71 degC", time=5e4) == base


# A time of the model's own; results along an axis


def test_a_time_that_is_an_input_is_read_from_the_inputs() -> None:
    """The pin runs 200 h: 0.1 um/h are 20 um; the step after 150 h is there, that after 250 h is not."""
    assert "time" not in PIN_WEAR.known_conditions
    assert PIN_WEAR.known_effects["sensor_drift"].reads == ("time",)
    base = shown(PIN_WEAR, {})["depth"]
    drifted = shown(PIN_WEAR, {"sensor_drift": {"depth": 0.1e-6 / 3600}})["depth"]
    assert drifted - base == pytest.approx(20e-6)
    for after, added in ((150, 1e-6), (250, 0.0)):
        step = {"step": {"depth": 1e-6, "depth_after": after * 3600.0}}
        assert shown(PIN_WEAR, step)["depth"] - base == pytest.approx(added, abs=1e-15)


@inputs
class Record:
    """Loads over a record."""

    load: Float = given((1.0, 2.0, 3.0), "N", along="moment")
    scale: Float = given(1.0, "")


@results
class Course:
    """A curve over time, its largest value, a table."""

    moment: Float = axis("s")
    force: Float = found("N", along="moment")
    largest: Float = found("N")
    line: Float = rows("lines of a table")
    entry: Float = found("N", along="line")


def course(record: Record) -> Course:
    """Scaled loads at whole seconds."""
    force = record.load * column(record.scale)
    largest = np.max(force, axis=-1)
    return Course(moment=np.arange(3.0), force=force, largest=largest, line=np.arange(2.0), entry=np.zeros(2))


COURSE = Model(name="course", title="Course", function=course)


def test_along_an_axis_the_same_acts_everywhere_and_tables_are_left_alone() -> None:
    assert [part[0] for part in COURSE.known_effects["sensor_offset"].parts] == ["force", "largest"]
    moved = shown(COURSE, {"sensor_offset": {"force": 10.0}, "sensor_drift": {"force": 2.0}}, time=5.0)
    np.testing.assert_allclose(moved["force"], [21, 22, 23])
    assert moved["largest"] == 3.0
    on = SwitchedOn(COURSE.known_effects["sensor_drift"], {"force": 2.0, "largest": 1.0})
    columns = {"time": np.array([0.0, 5.0]), "scale": np.array([1.0, 10.0])}
    found_ = evaluate_rows(
        replace(default_setup(COURSE), effects=(on,)), columns, 2, reading=True, wanted=["force", "largest"]
    )
    np.testing.assert_allclose(found_.results["force"], [[1, 2, 3], [20, 30, 40]])
    np.testing.assert_allclose(found_.results["largest"], [3, 35])


@inputs
class Clocked:
    """Loads at stated moments."""

    time: Float = given((0.0, 1.0, 4.0), "s", along="time")
    load: Float = given((1.0, 1.0, 1.0), "N", along="time")


@results
class Moments:
    """A curve over a series of the inputs, and one number."""

    force: Float = found("N", along="time")
    largest: Float = found("N")


def moments(clocked: Clocked) -> Moments:
    """Pass the loads on."""
    return Moments(force=clocked.load * 1.0, largest=np.max(clocked.load, axis=-1))


def test_a_time_that_is_a_series_is_met_by_the_results_along_it() -> None:
    model = Model(name="moments", title="Moments", function=moments)
    drift = model.known_effects["sensor_drift"]
    assert (drift.parts, drift.reads) == ((("force",),), ("time",))
    np.testing.assert_allclose(shown(model, {"sensor_drift": {"force": 2.0}})["force"], [1, 3, 9])


@results
class Cooling:
    """A curve over an axis that is called time."""

    time: Float = axis("h")
    warmth: Float = found("K", along="time")
    last: Float = found("K")


def cooling(bar: Bar) -> Cooling:
    """A constant over two hours."""
    time = np.array([0.0, 1.0, 2.0]) * 3600
    return Cooling(time=time, warmth=column(bar.load) + 0 * time, last=bar.load)


def test_a_time_that_is_an_axis_of_the_results_is_used() -> None:
    model = Model(name="cooling", title="Cooling", function=cooling)
    assert model.known_effects["sensor_drift"].parts == (("warmth",),)
    assert model.known_effects["sensor_offset"].parts == (("warmth",), ("last",))
    np.testing.assert_allclose(shown(model, {"sensor_drift": {"warmth": 1 / 3600}})["warmth"], [10, 11, 12])


@results
class Duration:
    """A result that is called time."""

    time: Float = found("h")


def lasting(bar: Bar) -> Duration:
    """An hour per newton."""
    return Duration(time=bar.load * 3600)


def test_where_the_name_is_taken_by_a_result_what_needs_it_is_left_out() -> None:
    model = Model(name="lasting", title="Lasting", function=lasting)
    assert list(model.known_effects) == ["sensor_offset", "sensor_gain", "thermal_drift", "periodic_order"]
    assert shown(model, {"sensor_gain": {"time": 0.5}})["time"] == pytest.approx(15 * 3600)


@results
class Twice:
    """Two results, one of which is called like the moment of a step of the other."""

    depth: Float = found("um")
    depth_after: Float = found("um")


def twice(bar: Bar) -> Twice:
    """Nothing."""
    return Twice(depth=0 * bar.load, depth_after=0 * bar.load)


def test_names_that_are_taken_make_no_part() -> None:
    model = Model(name="twice", title="Twice", function=twice)
    assert model.known_effects["step"].parts == (("depth", "depth_after"),)
    assert model.known_effects["sensor_offset"].parts == (("depth",), ("depth_after",))


# Inputs files


def test_a_file_and_the_command_line_switch_parts_on() -> None:
    setup = read_text(
        '[effects.periodic_order]\nwarmth_order = 2\nwarmth_cosine = "1 K"\n'
        '[effects.sensor_drift]\nheight_right = { value = "4 um/h", sd = "1 um/h" }\n',
        overrides=["time=2 h"],
    )
    assert [item.effect.name for item in setup.effects] == ["sensor_drift", "periodic_order"]
    drift, wave = setup.effects
    assert dict(wave.values) == {"warmth_cosine": 1.0, "warmth_order": 2.0}
    assert dict(drift.sds) == {"height_right": pytest.approx(1e-6 / 3600)}
    assert dict(setup.conditions) == {"time": 7200.0}
    answer = SHAFT.read_results(evaluate(setup, reading=True))
    assert answer["height_right"] == pytest.approx(12e-6)
    assert answer["warmth"] == pytest.approx(344.15)


def test_a_covariance_is_over_what_is_given_in_the_order_declared() -> None:
    """In um^2, um K and K^2."""
    text = '[effects.sensor_offset]\nwarmth = "1 K"\nheight_left = "2 um"\ncovariance = [[4, 1], [1, 9]]\n'
    (on,) = read_text(text).effects
    assert [unknown.name for unknown in on.unknowns] == ["height_left", "warmth"]
    np.testing.assert_allclose(on.covariance, [[4e-12, 1e-6], [1e-6, 9.0]])
    assert dict(on.sds) == {"height_left": pytest.approx(2e-6), "warmth": pytest.approx(3.0)}
    assert faults(text.replace("[[4, 1], [1, 9]]", "[[4]]")) == [
        "shaft.toml:4: covariance is a list of 2 rows of 2 numbers, over height_left [um], warmth [K]"
    ]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[effects.sensor_offset]", "1: effect 'sensor_offset' is on, but none of its unknowns is given: height_left, "
                                    "height_right, warmth"),
        ('[effects.step]\nwarmth = "1 K"', "2: effect 'step': 'warmth' is given, so 'warmth_after' must be given too "
                                           "(from 0 to 1e+06 h)"),
        ('[effects.step]\nwarmth_after = "1 h"', "2: effect 'step': 'warmth_after' is given, but without 'warmth' "
                                                 "nothing happens; give it, or leave both out"),
        ('[effects.periodic_order]\nwarmth_sine = "1 K"', "2: effect 'periodic_order': 'warmth_sine' is given, so "
                                                          "'warmth_order' must be given too (from 1 to 3)"),
        ('[effects.periodic_order]\nwarmth_sine = "1 K"\nwarmth_order = 1.5', "3: warmth_order is 1.5; it must be a "
                                                                              "whole number"),
        ('[effects.periodic_order]\nwarmth_sine = "1 K"\nwarmth_order = 4', "3: warmth_order is 4; it must lie from "
                                                                            "1 to 3"),
        ('[effects.sensr_offset]\nwarmth = "1 K"', "1: shaft has no effect 'sensr_offset'. Did you mean "
                                                   "'sensor_offset'?"),
        ('[effects.sensor_offset]\nwarmht = "1 K"', "2: effect 'sensor_offset' has no unknown 'warmht'. Did you mean "
                                                    "'warmth' (T_1, degC)? (unknowns: height_left, height_right, "
                                                    "warmth)"),
        ('[conditions]\ntme = "1 h"', "2: shaft has no condition 'tme'. Did you mean 'time'?"),
        ('[inputs]\ntime = "1 h"', "2: 'time' is a condition; write it under [conditions]"),
        ('[conditions]\nangle = "1 deg"', "2: shaft has no condition 'angle'. (there are: time)"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_sentence(text: str, sentence: str) -> None:
    assert faults(text) == ["shaft.toml:" + sentence]


def test_the_inputs_of_a_run_name_only_what_is_on() -> None:
    text = '[effects.sensor_drift]\nwarmth = { value = "2 K/h", sd = "0.5 K/h" }\nheight_left = "1 um/h"\n'
    setup = read_text(text + "covariance = [[4, 0.1], [0.1, 0.25]]\n")
    written = complete_inputs(setup)
    assert "height_right" not in written
    assert '[conditions]\ntime = "0 h"\n' in written
    again = read_text(written)
    assert dict(again.effects[0].values) == dict(setup.effects[0].values)
    assert dict(again.effects[0].sds) == pytest.approx(dict(setup.effects[0].sds))
    np.testing.assert_allclose(again.effects[0].covariance, setup.effects[0].covariance, rtol=1e-15)
    assert complete_inputs(again).partition("[effects")[2] == written.partition("[effects")[2]
    assert input_hash(again) == input_hash(setup)


# Runs


def test_no_machine_fails_by_a_gauge() -> None:
    """The limit is 3 um; 10 um of offset change what is read and nothing that is calculated."""
    plain = calculate(read_text(""))
    moved = calculate(read_text('[effects.sensor_offset]\nheight_left = "10 um"\n'))
    assert moved.verdict == plain.verdict == "passes"
    assert moved.answers["height_left"] == plain.answers["height_left"] == pytest.approx(2e-6)
    assert moved.warnings == plain.warnings
    assert evaluate(moved.setup, reading=True).left.height == pytest.approx(12e-6)


def test_an_effect_of_a_plugin_that_has_parts_may_be_on_by_one_of_them() -> None:
    pair = Effect(
        "pair", on_results=_lifted, unknowns=[Unknown("lift", -9, 9, "N"), Unknown("turn", -1, 1, "N")],
        parts=[["lift"], ["turn"]],
    )  # fmt: skip
    model = replace(BAR, errors=[pair])
    offer = Offer("bar", model, Origin("bar", "", "", "", "module:bar"))
    (on,) = read_text('[effects.pair]\nlift = "2 N"\n', offer).effects
    assert evaluate(replace(default_setup(model), effects=(on,))).force == pytest.approx(12.0)


def _lifted(bar: Bar, base: Pull, *, lift: Float, turn: Float) -> Pull:
    return replace(base, force=base.force + lift + 100 * turn)


def test_an_effect_without_parts_needs_every_unknown() -> None:
    own = Effect("own", on_reading=_any, unknowns=[Unknown("zero", -1, 1, "N"), Unknown("other", -1, 1, "N")])
    with pytest.raises(UsageError, match="effect 'own' is on, so its unknown 'other' must be given"):
        evaluate(replace(default_setup(replace(BAR, errors=[own])), effects=(SwitchedOn(own, {"zero": 0.1}),)))


def _any(bar: Bar, base: Pull, **unknowns: Float) -> Pull:
    return base
