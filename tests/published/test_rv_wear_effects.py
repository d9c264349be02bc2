"""What the paper leaves out of the reducer: pins off centre by exact geometry, both flanks, and thick films.

What each effect does is compared with a machine of its own in ``test_effects_of_machines.py``.
"""

from dataclasses import fields
from functools import cache
from math import pi
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
ARM = 2.2e-3 * 39
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


def play(offset: tuple[float, float] = (0.0, 0.0), discs: int = 2) -> Any:
    """Both ends of the play (2, n) in arcmin, by exact geometry."""
    return ends_of_play(Mesh(**NEW, throw=2.2), CRANKS, offset, discs) / MINUTE


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


# Wear


def test_pins_that_roll_altogether_wear_nothing() -> None:
    assert shown("pin_rolling", rolling=1.0)["max_wear"] == 0


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
