"""What the paper leaves out of the reducer: pins off centre by exact geometry, both flanks, and thin films.

What each effect does is compared with a machine of its own in ``test_effects_of_machines.py``.
"""

from functools import partial
from math import pi
from typing import Any

import numpy as np
import pytest
from switched import change, shown

from hidden_effects.rv_play import Mesh, ends_of_play
from rv_wear.model import RV_WEAR
from rv_wear.play import ideal_parts, play_of

MINUTE = pi / 10800
UM, HOUR = 1e-6, 3600.0
ARM = 2.2e-3 * 39
NEW = Mesh(circle=114.5, pin=4.998 - 0.00425, ground_circle=114.47, ground_pin=4.974, ground_throw=2.2, throw=2.2)
CRANKS = np.radians(np.arange(0.0, 360.0, 5.0))
with_effect: Any = partial(shown, RV_WEAR)


def reducer(**settings: Any) -> Any:
    return RV_WEAR.inputs(**settings)


def taken(cranks: Any, pins: Any = (0.0, 0.0), **other: Any) -> Any:
    """What these parts take from the play, arcmin: every pin against the profile of every disc."""
    return (ends_of_play(NEW, cranks, pins, **other) - ends_of_play(NEW, cranks)).sum(axis=0) / MINUTE


def across(micrometres: float, towards: float) -> Any:
    """An offset (x, y), mm."""
    return micrometres * 1e-3 * np.array([np.cos(np.radians(towards)), np.sin(np.radians(towards))])


@pytest.mark.parametrize("micrometres", [0.3, 3.0, 8.0])
@pytest.mark.parametrize("towards", [200.0, 275.0])
def test_pins_off_centre_take_play_from_two_opposite_discs_twice_per_crank_turn(
    micrometres: float, towards: float
) -> None:
    """Reference: every pin against the profile of every disc. What is left over is of second order.

    The shift of 30 um goes 23 um along a path of at least 9 mm radius: 0.03 um, 0.0012 arcmin at each end; with the
    offset beside it, in the same direction at the worst, its square.
    """
    exact = taken(CRANKS, across(micrometres, towards))
    off = {"offset": micrometres * UM, "direction": float(np.radians(towards)), "crank_angle": CRANKS}
    found = change(RV_WEAR, "backlash", "runout", **off) / MINUTE
    assert found == pytest.approx(exact, abs=2 * 0.0012 * (1 + micrometres / 30) ** 2)
    assert np.max(exact) < 0
    assert np.min(exact) == pytest.approx(-0.0801 * micrometres, rel=2e-3)
    waves = np.abs(np.fft.rfft(found)) / len(found)
    assert np.argmax(waves[1:]) + 1 == 2
    assert np.max(waves[1::2]) < 1e-6


def test_a_toothing_off_its_bores_turns_with_the_output() -> None:
    """As pins off centre, but against the disc: over a turn of the output the dips come 80 times, and not 78."""
    cranks = np.linspace(0, 2 * pi * 39, 39 * 40, endpoint=False)
    exact = taken(cranks, toothing=np.stack([across(2.0, 250.0)] * 2))
    found = change(
        RV_WEAR, "backlash", "toothing_runout", offset=2 * UM, direction=float(np.radians(250)),
        crank_angle=cranks % (2 * pi), output_angle=-cranks / 39 % (2 * pi),
    ) / MINUTE  # fmt: skip
    assert found == pytest.approx(exact, abs=2 * 0.0012)
    assert np.argmax(np.abs(np.fft.rfft(exact))[1:]) + 1 == 80


@pytest.mark.parametrize(("minutes", "lost"), [(-3.0, 3 / 39), (6.0, 6 / 39)])
def test_a_crank_out_of_phase_takes_a_constant_and_makes_the_dips_unlike(minutes: float, lost: float) -> None:
    phase = minutes * MINUTE
    alone = change(RV_WEAR, "backlash", "disc_phase", phase=phase, crank_angle=CRANKS) / MINUTE
    assert alone == pytest.approx(-lost, abs=1e-9)
    stands = reducer(pin_circle_x="0.4 um", pin_circle_y="-2.5 um")
    both = with_effect("disc_phase", stands, phase=phase, crank_angle=CRANKS)["backlash"]
    found = (both - with_effect("", stands)["backlash"]) / MINUTE
    pins = (0.4e-3, -2.5e-3)
    assert found == pytest.approx(taken(CRANKS, pins, ahead=phase) - taken(CRANKS, pins), abs=4 * 0.0012)


def test_all_three_together_are_one_machine() -> None:
    """They act one after another, and what they take together is no sum: it is that of the whole geometry."""
    cranks = np.linspace(0, 2 * pi * 39, 300)
    on = {
        "runout": {"offset": 2 * UM, "direction": 5.2}, "disc_phase": {"phase": 3 * MINUTE},
        "toothing_runout": {"offset": 1.5 * UM, "direction": 0.9},
    }  # fmt: skip
    at = {"crank_angle": cranks % (2 * pi), "output_angle": -cranks / 39 % (2 * pi)}
    moved = reducer()
    for name in (name for name in RV_WEAR.effects if name in on):
        effect = RV_WEAR.effects[name]
        moved = effect.on_inputs(moved, **on[name], **{need.name: at[need.name] for need in effect.needs})
    pins, bores = (across(size, float(np.degrees(way))) for size, way in ((2.0, 5.2), (1.5, 0.9)))
    exact = taken(cranks, pins, toothing=np.stack([bores] * 2), ahead=3 * MINUTE)
    assert -np.asarray(moved.runout_gap) / ARM / MINUTE == pytest.approx(exact, abs=2 * 0.0012 * (1 + 3.5 / 30) ** 2)


OFF = {"offset": np.hypot(2, 1) * UM, "direction": -np.arctan2(1, 2)}  # 2 um along x and -1 um along y
REACHES = [  # the effect, its unknowns, the inputs that say the same, and the parts of the machine
    ("runout", OFF, {"pin_circle_x": "2 um", "pin_circle_y": "-1 um"}, {"pins": (2e-3, -1e-3)}),
    ("toothing_runout", OFF, {"toothing_x": "2 um", "toothing_y": "-1 um"},
     {"toothing": np.array([[2e-3, -1e-3], [2e-3, -1e-3]])}),
    ("disc_phase", {"phase": 3 * MINUTE}, {"disc_phase_error": "3 arcmin"}, {"ahead": 3 * MINUTE}),
]  # fmt: skip


@pytest.mark.parametrize(("effect", "unknowns", "inputs", "parts"), REACHES, ids=[case[0] for case in REACHES])
def test_an_effect_reaches_the_exact_play_at_every_angle(effect: str, unknowns: Any, inputs: Any, parts: Any) -> None:
    declared = RV_WEAR.effects[effect]
    moved = declared.on_inputs(reducer(), **unknowns, **{need.name: 0.7 for need in declared.needs})
    cranks = np.linspace(0, 2 * pi * 39, 60)
    neutral, ours, stated = (
        play_of(ideal_parts(each), cranks)[:, 0] / MINUTE for each in (reducer(), moved, reducer(**inputs))
    )
    assert ours == pytest.approx(stated, abs=1e-9)
    assert ours - neutral == pytest.approx(taken(cranks, **parts), abs=1e-4)


@pytest.mark.parametrize(("reversing", "minutes"), [(0.0, 0.1254), (0.5, None), (1.0, 0.1557)])
def test_each_flank_wears_for_its_own_hours(reversing: float, minutes: float | None) -> None:
    """h(T (1 - r/2)) + h(T r/2): one flank for all hours, or both for half of them; the deeper flank is the result."""
    found = with_effect("", reducer(reversing=reversing))
    longer, other = (
        with_effect("", reducer(working_time=6000 * HOUR * share))["max_wear"]
        for share in (1 - reversing / 2, reversing / 2)
    )
    assert found["max_wear"] == pytest.approx(longer, rel=1e-12)
    assert found["backlash_of_wear"] == pytest.approx((longer + other) / ARM, rel=1e-12)
    if minutes:
        assert found["backlash_of_wear"] / MINUTE == pytest.approx(minutes, abs=1e-4)


def test_a_flank_that_never_bears_does_not_run_in() -> None:
    found = with_effect("running_in", reducer(reversing=0.0), depth=0.8 * UM, run_in_time=300 * HOUR)
    assert found["backlash_of_wear"] == pytest.approx(found["max_wear"] / ARM, rel=1e-12)


def test_a_flank_that_is_idle_wears_as_with_less_sliding() -> None:
    """At 0.5 the hours are shared evenly, as the input says; a stated duty leaves nothing to the effect."""
    found = with_effect("duty_share", idle=0.5)
    assert found == with_effect("pin_rolling", rolling=0.5)
    assert found == pytest.approx(with_effect("", reducer(reversing=1.0)), rel=1e-12)
    stated = reducer(reversing=0.3)
    assert with_effect("duty_share", stated, idle=0.25) == with_effect("", stated)
    assert with_effect("pin_rolling", rolling=1.0)["max_wear"] == 0


def test_oil_ages_by_the_clock_and_not_by_the_hours_of_a_flank() -> None:
    """A flank is loaded in half of every hour, so it sees the oil as it is at all times."""
    even, rolling = (
        with_effect("lubricant_ageing", reducer(**settings), rate=2e-4 / HOUR)["max_wear"]
        for settings in ({"reversing": 1.0}, {"sliding_factor": 0.5})
    )
    assert even == pytest.approx(rolling, rel=1e-12)


@pytest.mark.parametrize("factor", [0.0, 0.1])
def test_a_film_as_thin_as_calculated_is_not_felt(factor: float) -> None:
    """With pins that stand still disc and pin move against one another: the film is a fiftieth of the roughness."""
    assert change(RV_WEAR, "max_wear", "film_lubrication", film_factor=factor, oil_temperature=313.15) == 0
