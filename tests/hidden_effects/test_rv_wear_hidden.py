"""A reducer with something wrong, hidden by physics of its own: does the diagnosis name it, size it and gain by it?

A few clear cases of every verdict, on every kind of noise, with the backlash alone and with the wear measured too. Most
of what changes the wear is nearly one curve on the backlash; there the diagnosis must say so and ask for the wear.
"""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from hidden_effects.plugin_asking import Answer, demand_named
from hidden_effects.rv_asking import REDUCER, diagnosed
from hidden_effects.rv_cases import BACKLASH, WEAR, Case, Wish, make_case, measured
from hidden_effects.rv_machine import RATED, ROUGHNESS, Array, Rows, Wearing, shown, wear_after
from truing.diagnosis.result import APART

BOTH = (BACKLASH, WEAR)
ONE_CURVE = {"pin_rolling", "lost_motion_share", "duty_share", "pin_wear", "bearing_wear", "sensor_gain"}
LESS_SLIDING = {"pin_rolling", "duty_share"}


def seventh_order(rows: Rows) -> Array:
    """A wave that nobody registered."""
    return 0.03 * np.sin(7 * np.radians(rows.output_angle) + 0.4)


def warm_seal(rows: Rows) -> Array:
    """A seal that grips when it is warm and turned hard."""
    return 1.2e-5 * (rows.housing_temperature - 20) * rows.measuring_torque


NOTHING = [
    Wish(seed=1),
    Wish(seed=2, kind="heavy", results=BOTH, count=80),
    Wish(seed=100, design="fleet", kind="autocorrelated", count=60),
    Wish(seed=4, kind="growing", results=BOTH, count=80),
]
NAMED = [
    Wish(seed=5, hidden={"thermal_clearance": {"expansion": 11.5}}, kind="heavy"),
    Wish(seed=6, hidden={"running_in": {"depth": 0.8, "run_in_time": 300}}, count=120),
    Wish(seed=27, hidden={"wear_temperature": {"softening": 0.004}}, design="fleet", count=60),
    Wish(seed=8, hidden={"film_lubrication": {"film_factor": 110}}, design="fleet", results=BOTH, count=60),
    Wish(seed=10, hidden={"pin_wear": {"ratio": 0.6}}, kind="growing"),
    Wish(seed=11, hidden={"lost_motion_share": {"loss": 0.5}}, results=BOTH, count=80),
    Wish(seed=12, hidden={"bearing_wear": {"wear": 0.5}}, design="fleet", count=60),
    Wish(seed=13, hidden={"wind_up": {"compliance": 1.02}}),
    Wish(seed=14, hidden={"stiffening": {"twist": 0.2, "torque_scale": 120}}, kind="heavy"),
    Wish(seed=15, hidden={"runout": {"offset": 1.2, "direction": 310}}, kind="autocorrelated"),
    Wish(seed=16, hidden={"pin_pass_ripple": {"disc_cosine": 0.03, "disc_sine": -0.02}}),
    Wish(seed=17, hidden={"friction_hysteresis": {"lag": 0.02}}, kind="growing"),
    Wish(seed=18, hidden={"lubricant_ageing": {"rate": 0.25}}),
    Wish(seed=19, hidden={"load_exponent": {"exponent": 0.4}}, design="fleet", count=60),
]
MAY_HOLD_MORE = [wish for wish in NAMED if "pin_wear" in wish.hidden]
SLOWER = [
    Wish(seed=9, hidden={"pin_rolling": {"rolling": 0.4}}, results=BOTH, count=80),
    Wish(seed=20, hidden={"duty_share": {"idle": 0.4}}, results=BOTH, count=80),
]
UNKNOWN = [
    (Wish(seed=21, strange=seventh_order), {"output_angle"}),
    (Wish(seed=22, strange=warm_seal, kind="heavy"), {"housing_temperature", "measuring_torque"}),
]


@cache
def _answered(place: str, number: int) -> tuple[Case, Answer]:
    unknown = [wish for wish, _ in UNKNOWN]
    places = {
        "nothing": NOTHING,
        "named": NAMED,
        "unknown": unknown,
        "alone": ALONE,
        "slower": SLOWER,
        "unfelt": UNFELT,
    }
    wish = places[place][number]
    case = make_case(wish)
    return case, diagnosed(case)


def each(place: str, wishes: list[Wish]) -> pytest.MarkDecorator:
    """One test per case; every case is asked once."""
    return pytest.mark.parametrize(
        "asked", [(place, number) for number in range(len(wishes))], ids=[wish.title for wish in wishes]
    )


def causes_of(answer: Answer) -> list[str]:
    return [cause["effect"] for cause in answer.document["causes"]]


@each("nothing", NOTHING)
def test_nothing_is_found_where_nothing_is_wrong(asked: tuple[str, int]) -> None:
    document = _answered(*asked)[1].document
    assert (document["explanations"], document["causes"], document["remainder"]) == ([], [], None)
    for name in _answered(*asked)[0].wish.results:
        gain = document["gain"][name]
        assert not (gain["p_value"] < 0.05 and gain["log_score_gain"] > 0)


@each("named", NAMED)
def test_the_cause_is_named(asked: tuple[str, int]) -> None:
    case, answer = _answered(*asked)
    demand_named(answer.document, [{*case.wish.hidden}], may_hold_more=case.wish in MAY_HOLD_MORE)
    assert answer.document["remainder"] is None
    assert causes_of(answer) == list(case.wish.hidden)


@each("named", NAMED)
def test_intervals_hold_the_truth(asked: tuple[str, int]) -> None:
    case, answer = _answered(*asked)
    for cause in answer.document["causes"]:
        for name, true in case.wish.hidden[cause["effect"]].items():
            low, high = cause["unknowns"][name]["interval95"]
            assert low <= true <= high, name


@each("named", NAMED)
def test_rows_held_out_are_predicted_as_well_as_can_be(asked: tuple[str, int]) -> None:
    """Nearly as well as by the truth, which leaves the noise; most of what was wrong is gone, and that is no chance."""
    case, answer = _answered(*asked)
    true = case.true_readings(case.held)
    for name in case.wish.results:
        left = rms(case.held_readings[name] - answer.predicted[name])
        assert left < 1.07 * rms(case.held_readings[name] - true[name])
    gains = [answer.document["gain"][name] for name in case.wish.results]
    assert any(gain["p_value"] < 0.05 for gain in gains)
    assert all(gain["reducible_removed"] > 0.9 for gain in gains if gain["p_value"] < 0.05)


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


@each("unknown", [wish for wish, _ in UNKNOWN])
def test_what_nobody_registered_is_called_unknown(asked: tuple[str, int]) -> None:
    document = _answered(*asked)[1].document
    assert (document["verdict"], document["causes"]) == ("unknown", [])
    assert set(document["remainder"]["depends_on"]) >= UNKNOWN[asked[1]][1]


# One curve on the backlash alone

ALONE = [
    Wish(seed=9, hidden={"pin_rolling": {"rolling": 0.4}}),
    Wish(seed=20, hidden={"duty_share": {"idle": 0.4}}),
]


UNFELT = [Wish(seed=11, hidden={"lost_motion_share": {"loss": 0.5}})]


@each("alone", ALONE)
def test_on_the_backlash_alone_slower_wear_has_several_names(asked: tuple[str, int]) -> None:
    case, answer = _answered(*asked)
    document = answer.document
    (cause,) = document["causes"]
    names = {cause["effect"], *cause["same_as"]}
    others = {name for other in document["alternatives"] for name in other["causes"]}
    assert {"pin_rolling", "duty_share"} <= names
    assert set(case.wish.hidden) <= names
    assert len((names | others) & ONE_CURVE) > 1


def test_it_asks_for_the_wear_where_the_wear_can_tell() -> None:
    """Play that is not felt leaves the flank as deep as it is; less sliding does not."""
    document = _answered("unfelt", 0)[1].document
    explanations = {name for names in document["explanations"] for name in names}
    assert (document["verdict"], explanations) == ("one_of", {"lost_motion_share", *LESS_SLIDING})
    point = document["next"][0]
    assert (point["settings"], point["measure"]) == ({}, [WEAR])
    assert "lost_motion_share" in point["separates"]
    assert set(point["separates"]) <= explanations
    assert point["why"].startswith("measure max_wear, too: ")
    assert point["separation"] > APART


def test_no_result_is_asked_for_where_none_can_tell() -> None:
    """Here only less sliding is left: its two names agree in every result, the place of the deepest wear included."""
    document = _answered("alone", 0)[1].document
    (cause,) = document["causes"]
    assert ({cause["effect"], *cause["same_as"]}, document["alternatives"]) == (LESS_SLIDING, [])
    assert not [point for point in document["next"] if point["measure"]]


def test_the_wear_then_tells_them_apart() -> None:
    """The same machines with the wear measured: play that is not felt leaves the flank as it is."""
    hidden = [next(iter(wish.hidden)) for wish in NAMED]
    (cause,) = _answered("named", hidden.index("lost_motion_share"))[1].document["causes"]
    assert not {*cause["same_as"]} & ONE_CURVE


@each("slower", SLOWER)
def test_less_sliding_of_each_flank_keeps_two_names(asked: tuple[str, int]) -> None:
    """Pins that roll and a load that reverses evenly are one thing to flank and backlash: only a fact parts them."""
    case, answer = _answered(*asked)
    (cause,) = answer.document["causes"]
    assert {cause["effect"], *cause["same_as"]} & ONE_CURVE == LESS_SLIDING
    ((true,),) = (unknowns.values() for unknowns in case.wish.hidden.values())
    low, high = next(iter(cause["unknowns"].values()))["interval95"]
    assert low <= true <= high


def test_a_stated_duty_leaves_one_name() -> None:
    """The log says that the load reverses evenly; then pins that roll are the only name that is left."""
    case, _ = _answered("slower", 1)
    rig = replace(REDUCER, inputs='plugin = "rv_wear"\n[inputs]\nreversing = 1\n')
    document = rig.diagnosed(case).document
    assert not {name for cause in document["causes"] for name in (cause["effect"], *cause["same_as"])} & {"duty_share"}


# The generator


def test_the_generator_wears_as_the_paper_prints() -> None:
    """3.127 um after 6000 h and, with every factor at the middle of its zone, 0.698' new and 0.949' then."""
    depth = wear_after(Wearing(RATED, ROUGHNESS), np.array([0.0, 5.4e6]))
    assert depth[0] == 0
    assert depth[1] * 1e3 == pytest.approx(3.127, rel=5e-3)
    rows = measured("endurance", 2, np.random.default_rng(0))
    ends = Rows(**{**vars(rows), "working_time": np.array([0.0, 6000.0])})
    assert shown(ends, {}, {})[BACKLASH] == pytest.approx([0.698, 0.949], abs=1.5e-3)


SIZES: dict[str, Any] = {name: unknowns for wish in (*NAMED, *SLOWER) for name, unknowns in wish.hidden.items()}


@pytest.mark.parametrize("name", SIZES)
def test_what_is_hidden_is_hidden_and_zero_hides_nothing(name: str) -> None:
    rows = measured("fleet", 40, np.random.default_rng(2))
    plain, changed = shown(rows, {}, {}), shown(rows, {}, {name: SIZES[name]})
    assert rms(changed[BACKLASH] - plain[BACKLASH]) > 0.008
    shapes = {"run_in_time", "torque_scale", "direction"}
    nothing = {key: value if key in shapes else 0.0 for key, value in SIZES[name].items()}
    none = shown(rows, {}, {name: nothing})
    assert all(np.array_equal(none[result], plain[result]) for result in plain)
