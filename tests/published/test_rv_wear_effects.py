"""What the paper leaves out of the reducer: each effect against its own arithmetic, and identities of the wear.

Numbers marked as reference follow by hand from equation 21: 2 q / (e z_c) is 51.27 arcmin per mm of the pin circle,
2 / (e z_c) is 80.13 arcmin per mm of wear, 1 / a is 54.57 arcmin per mm of bearing clearance.
"""

from collections.abc import Callable
from dataclasses import fields
from functools import cache
from math import exp, pi, sqrt
from typing import Any

import numpy as np
import pytest

from hidden_effects.rv_play import Mesh, ends_of_play
from rv_wear.calculation import rv_wear
from rv_wear.effects import EFFECTS, runout
from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer
from truing import Effect

MINUTE = pi / 10800
UM, HOUR = 1e-6, 3600.0
ROOM = 293.15
ARM = 2.2e-3 * 39
ROOT = sqrt(1 - (2.2 * 40 / 114.5) ** 2)
BY_NAME: dict[str, Effect[Any, Any]] = {effect.name: effect for effect in EFFECTS}


@cache
def shown(name: str = "", settings: str = "", **values: float) -> dict[str, float]:
    """The results in SI with one effect on (unknowns and conditions in SI); settings as in an inputs file."""
    changed = dict(item.split("=") for item in settings.split(";") if item)
    reducer: Reducer = RV_WEAR.inputs(**{key: text.strip() for key, text in changed.items()})
    if not name:
        return _numbers(rv_wear(reducer))
    effect = BY_NAME[name]
    if effect.place == "inputs":
        return _numbers(rv_wear(effect.function(reducer, **values)))
    return _numbers(effect.function(reducer, rv_wear(reducer), **values))


def _numbers(results: Any) -> dict[str, float]:
    return {item.name: float(getattr(results, item.name)) for item in fields(results)}


def change(name: str, settings: str = "", result: str = "backlash", **values: float) -> float:
    """What one effect adds to a result, SI."""
    return shown(name, settings, **values)[result] - shown("", settings)[result]


# Clearance


NEW = {"circle": 114.5, "pin": 4.998 - 0.00425, "ground_circle": 114.47, "ground_pin": 4.974, "ground_throw": 2.2}
PAPER = Reducer()
CRANKS = np.radians(np.arange(0.0, 360.0, 2.5))


def play(offset: tuple[float, float] = (0.0, 0.0), discs: int = 2, warm: float = 1.0, hot: float = 1.0) -> Any:
    """Both ends of the play (2, n) in arcmin, by exact geometry; the housing grew to ``warm``, the discs to ``hot``."""
    outer = {name: NEW[name] * warm for name in ("circle", "pin")}
    inner = {name: NEW[name] * hot for name in ("ground_circle", "ground_pin", "ground_throw")}
    return ends_of_play(Mesh(**outer, **inner, throw=2.2 * hot), CRANKS, offset, discs) / MINUTE


@pytest.mark.parametrize(("housing", "disc"), [(20.0, 25.0), (50.0, 50.0), (20.0, 15.0), (60.0, 20.0)])
def test_heat_closes_the_clearance_by_the_difference_of_the_temperatures(housing: float, disc: float) -> None:
    """Reference: every pin against the profile of every disc, all of the housing and all of the disc larger.

    By hand 2 (q r_p - r_rp) / (e z_c) * 11.5e-6 / K = 0.0629 arcmin per kelvin; the circle alone would give 0.0675.
    """
    found = change(
        "thermal_clearance", expansion=11.5e-6, housing_temperature=273.15 + housing, disc_temperature=273.15 + disc
    )
    grown = play(warm=1 + 11.5e-6 * (housing - 20), hot=1 + 11.5e-6 * (disc - 20)) - play()
    assert found / MINUTE == pytest.approx(np.mean(grown.sum(axis=0)), rel=5e-3, abs=1e-4)
    assert found / MINUTE == pytest.approx(0.0629 * (housing - disc), rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("micrometres", [0.3, 1.0, 3.0, 8.0])
@pytest.mark.parametrize("towards", [200.0, 275.0])
def test_pins_off_centre_take_play_from_two_opposite_discs_twice_per_crank_turn(
    micrometres: float, towards: float
) -> None:
    """Reference: every pin against the profile of every disc. What is left over is that pins are not everywhere.

    The nearest one is up to half a pitch beside the longest arm, where the normal leans by 0.07 towards the crank: two
    ends, 0.040 arcmin per micrometre each. There the gap is wider by 0.08 um: 0.0063 arcmin at both ends, with the
    offset and without.
    """
    x, y = (micrometres * 1e-3 * part(np.radians(towards)) for part in (np.cos, np.sin))
    exact = (play((x, y)) - play()).sum(axis=0)
    off = runout(PAPER, offset=micrometres * UM, direction=float(np.radians(towards)), crank_angle=CRANKS)
    found = rv_wear(off).backlash - rv_wear(PAPER).backlash
    assert found / MINUTE == pytest.approx(exact, abs=min(0.0056 * micrometres, 0.0126))
    assert np.max(exact) < 0
    assert np.min(exact) == pytest.approx(-0.0801 * micrometres, rel=2e-3)
    waves = np.abs(np.fft.rfft(found)) / len(found) / MINUTE
    assert np.argmax(waves[1:]) + 1 == 2
    assert np.max(waves[1::2]) < 1e-6


def test_one_disc_off_centre_moves_the_position_and_hardly_the_play() -> None:
    """Once per crank turn: 0.040 arcmin per micrometre of position, 1 / (e z_c), and at most 0.006 of play."""
    forward, back = play((0.001, 0.0), discs=1) - play(discs=1)
    position = np.fft.rfft((forward - back) / 2) / len(CRANKS) * 2
    assert abs(position[1]) == pytest.approx(1e-3 / 85.8 / MINUTE, rel=1e-3)
    assert np.max(np.abs(np.delete(position, 1))) < 1e-3
    assert np.max(np.abs(forward + back)) < 0.006


@pytest.mark.parametrize(
    ("settings", "micrometres"),
    [
        ("", 5.4),
        ("output_torque=1568 N*m", 2.7),
        ("output_speed=30 r/min;working_time=3000 h", 5.4),
        ("working_time=0 h", 0),
    ],
)
def test_bearings_gain_with_load_and_turns(settings: str, micrometres: float) -> None:
    """One micrometre per million output turns at 3136 N m; 15 r/min make 5.4 million in 6000 h; 0.0546' per um."""
    assert change("bearing_wear", settings, wear=UM) / MINUTE == pytest.approx(micrometres * 0.054567, rel=1e-4)
    assert change("bearing_wear", settings, "max_wear", wear=UM) == 0


# Wear


@pytest.mark.parametrize(("hours", "share"), [(0.0, 0.0), (300.0, 1 - exp(-1)), (6000.0, 1 - exp(-20))])
def test_running_in_is_a_depth_that_is_complete_after_a_while(hours: float, share: float) -> None:
    settings = f"working_time={hours} h"
    depth = change("running_in", settings, "max_wear", depth=0.8 * UM, run_in_time=300 * HOUR)
    assert depth == pytest.approx(0.8 * UM * share, rel=1e-9, abs=1e-18)
    felt = change("running_in", settings, depth=0.8 * UM, run_in_time=300 * HOUR)
    assert felt == pytest.approx(2 * depth / ARM, rel=1e-9, abs=1e-16)


def hours_that_wear_as(name: str, hours: float, **values: float) -> float:
    """Working time after which the reducer without the effect is worn as deep as with it after ``hours``."""
    depth = shown(name, f"working_time={hours} h", **values)["max_wear"]
    low, high = 0.0, 10 * hours
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if shown("", f"working_time={middle} h")["max_wear"] < depth else (low, middle)
    return low


FASTER: list[tuple[str, dict[str, float], Callable[[float], float]]] = [  # effect, unknowns and conditions, hours
    ("wear_temperature", {"softening": 0.006, "oil_temperature": 323.15}, lambda at: at * exp(7.377 * 0.06)),
    ("wear_temperature", {"softening": 0.006, "oil_temperature": 313.15}, lambda at: at),
    ("wear_temperature", {"softening": 0.004, "oil_temperature": 293.15}, lambda at: at * exp(-7.377 * 0.08)),
    ("pin_rolling", {"rolling": 0.4}, lambda at: 0.6 * at),
    ("lubricant_ageing", {"rate": 2e-4 / HOUR}, lambda at: at + 2e-4 * at**2 / 2),
]


@pytest.mark.parametrize(("name", "values", "hours"), FASTER)
@pytest.mark.parametrize("at", [1500.0, 6000.0])
def test_what_changes_the_rate_of_wear_changes_the_hours(
    name: str, values: dict[str, float], hours: Callable[[float], float], at: float
) -> None:
    """Sliding and coefficient multiply the growth at every contact alike: the same history at another speed."""
    assert hours_that_wear_as(name, at, **values) == pytest.approx(hours(at), rel=1e-9)


def test_pins_that_roll_altogether_wear_nothing() -> None:
    assert shown("pin_rolling", rolling=1.0)["max_wear"] == 0


@pytest.mark.parametrize(
    ("name", "values", "factor"),
    [
        ("pin_wear", {"ratio": 0.5}, 1.5),
        ("lost_motion_share", {"loss": 0.87}, 0.13),
        ("lost_motion_share", {"loss": 0.0}, 1.0),
    ],
)
def test_what_is_felt_of_the_wear_leaves_the_flank_as_it_is(name: str, values: dict[str, float], factor: float) -> None:
    base = shown()
    assert change(name, result="max_wear", **values) == 0
    found = shown(name, **values)
    assert found["backlash_of_wear"] == pytest.approx(factor * 2 * base["max_wear"] / ARM, rel=1e-12)
    assert found["backlash"] - base["backlash"] == pytest.approx((factor - 1) * base["backlash_of_wear"], rel=1e-9)


@pytest.mark.parametrize(("reversing", "minutes"), [(0.0, 0.1254), (0.5, None), (1.0, 0.1557)])
def test_each_flank_wears_for_its_own_hours(reversing: float, minutes: float | None) -> None:
    """h(T (1 - r/2)) + h(T r/2): one flank for all hours, or both for half of them; the deeper flank is the result."""
    found = shown("", f"reversing={reversing}")
    longer, other = (
        shown("", f"working_time={6000 * share} h")["max_wear"] for share in (1 - reversing / 2, reversing / 2)
    )
    assert found["max_wear"] == pytest.approx(longer, rel=1e-12)
    assert found["backlash_of_wear"] == pytest.approx((longer + other) / ARM, rel=1e-12)
    if minutes:
        assert found["backlash_of_wear"] / MINUTE == pytest.approx(minutes, abs=1e-4)


def test_a_flank_that_never_bears_does_not_run_in() -> None:
    found = shown("running_in", "reversing=0", depth=0.8 * UM, run_in_time=300 * HOUR)
    assert found["backlash_of_wear"] == pytest.approx(found["max_wear"] / ARM, rel=1e-12)


@pytest.mark.parametrize("idle", [0.0, 0.25, 0.5])
def test_a_flank_that_is_idle_wears_as_with_less_sliding(idle: float) -> None:
    """At 0.5 the hours are shared evenly, as the input says; a stated duty leaves nothing to the effect."""
    found = shown("duty_share", idle=idle)
    assert found == shown("pin_rolling", rolling=idle)
    assert shown("duty_share", "reversing=0.3", idle=idle) == shown("", "reversing=0.3")
    if idle == 0.5:
        assert found == pytest.approx(shown("", "reversing=1"), rel=1e-12)


def test_oil_ages_by_the_clock_and_not_by_the_hours_of_a_flank() -> None:
    """A flank is loaded in half of every hour, so it sees the oil as it is at all times."""
    ageing = {"rate": 2e-4 / HOUR}
    even, rolling = (
        shown("lubricant_ageing", "reversing=1", **ageing),
        shown("lubricant_ageing", "sliding_factor=0.5", **ageing),
    )
    assert even["max_wear"] == pytest.approx(rolling["max_wear"], rel=1e-12)


@pytest.mark.parametrize(("torque", "exponent"), [(3136.0, 0.7), (1568.0, 0.5), (4000.0, -0.4)])
def test_another_power_of_the_load_turns_about_the_rated_torque(torque: float, exponent: float) -> None:
    settings = f"output_torque={torque} N*m"
    found = shown("load_exponent", settings, exponent=exponent)["max_wear"] / shown("", settings)["max_wear"]
    assert found == pytest.approx((torque / 3136) ** exponent, rel=1e-12)


@pytest.mark.parametrize("factor", [0.0, 0.1])
def test_a_film_as_thin_as_calculated_is_not_felt(factor: float) -> None:
    """With pins that stand still disc and pin move against one another: the film is a fiftieth of the roughness."""
    assert change("film_lubrication", result="max_wear", film_factor=factor, oil_temperature=313.15) == 0


def test_a_thick_film_spares_the_flank_but_not_where_it_moves_against_the_pin() -> None:
    base = shown()["max_wear"]
    thick = [
        shown("film_lubrication", film_factor=factor, oil_temperature=313.15)["max_wear"]
        for factor in (25.0, 75.0, 150.0)
    ]
    assert base > thick[0] > thick[1] > thick[2] > 0.75 * base
    cold = shown("film_lubrication", film_factor=75.0, oil_temperature=293.15)["max_wear"]
    hot = shown("film_lubrication", film_factor=75.0, oil_temperature=353.15)["max_wear"]
    assert cold < thick[1] < hot < base
    slow, fast = (
        shown("film_lubrication", f"output_speed={speed} r/min;working_time={90000 / speed} h", film_factor=75.0,
              oil_temperature=313.15)["max_wear"]
        for speed in (5, 20)
    )  # fmt: skip
    assert fast < slow


# Reading


def test_every_tooth_and_every_pin_has_its_wave() -> None:
    values = {"disc_cosine": 3e-6, "disc_sine": 0.0, "pin_cosine": 0.0, "pin_sine": -2e-6}
    angles = np.radians(np.arange(360.0))
    base = shown()["backlash"]
    read = (
        np.array([shown("pin_pass_ripple", output_angle=float(angle), **values)["backlash"] for angle in angles]) - base
    )
    orders = np.fft.rfft(read) / 180
    assert orders[39] == pytest.approx(3e-6, abs=1e-15)
    assert orders[40] == pytest.approx(2e-6j, abs=1e-15)
    assert np.max(np.abs(np.delete(orders, [39, 40]))) < 1e-15


def test_wind_up_is_twice_the_torque_over_the_stiffness() -> None:
    """Reference: 0.19 arcmin under 94 N m to either side at 980 N m per arcmin; 6.4 arcmin under 3136 N m."""
    stiffness = 980 / MINUTE
    for torque, minutes in [(94.08, 0.192), (-94.08, 0.192), (3136.0, 6.4), (0.0, 0.0)]:
        found = change("wind_up", compliance=1 / stiffness, measuring_torque=torque)
        assert found / MINUTE == pytest.approx(minutes, abs=1e-9)


@pytest.mark.parametrize(("torque", "share"), [(0.0, 0.0), (120.0, 1 - exp(-1)), (-120.0, 1 - exp(-1)), (3136.0, 1.0)])
def test_stiffening_ends(torque: float, share: float) -> None:
    found = change("stiffening", twist=0.2 * MINUTE, torque_scale=120.0, measuring_torque=torque)
    assert found / MINUTE == pytest.approx(0.2 * share, abs=1e-9)


@pytest.mark.parametrize("direction", [-1.0, 0.0, 1.0])
def test_friction_lags_behind(direction: float) -> None:
    found = change("friction_hysteresis", lag=0.05 * MINUTE, direction=direction)
    assert found / MINUTE == pytest.approx(0.05 * direction, abs=1e-12)


# All
