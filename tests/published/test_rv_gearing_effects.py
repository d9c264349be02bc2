"""What the rating leaves out of the first stage: orders of waves, ends of play and load, and crowned teeth.

What each effect does is compared with a machine of its own in ``test_effects_of_machines.py``. Numbers marked as
reference follow by hand for 20/55 teeth, 40 pins, module 1.25 mm at 2.26 kW: ratio 111, 518.5 N per mesh.
"""

from functools import cache
from math import cos, pi, sin, tanh
from typing import Any

import numpy as np
import pytest

from rv_gearing.effects import EFFECTS
from rv_gearing.model import RV_GEARING
from rv_gearing.quantities import Gearing
from rv_gearing.rating import rv_gearing
from truing import Effect

UM = 1e-6
BY_NAME: dict[str, Effect[Any, Any]] = {effect.name: effect for effect in EFFECTS}
STATED = "sun_teeth=20;planet_teeth=55"


@cache
def shown(name: str = "", settings: str = "", **values: float) -> dict[str, float]:
    """The measured results in SI with one effect on (unknowns and conditions in SI); settings as in an inputs file."""
    stage = stage_of(settings)
    if not name:
        return _numbers(rv_gearing(stage))
    effect = BY_NAME[name]
    if effect.place == "inputs":
        return _numbers(rv_gearing(effect.function(stage, **values)))
    return _numbers(effect.function(stage, rv_gearing(stage), **values))


def stage_of(settings: str) -> Gearing:
    changed = dict(item.split("=") for item in f"{STATED};{settings}".split(";") if item)
    stage: Gearing = RV_GEARING.inputs(**{key: text.strip() for key, text in changed.items()})
    return stage


def _numbers(results: Any) -> dict[str, float]:
    names = ("contact_stress", "transmission_error", "efficiency", "flank_temperature", "backlash")
    found = {name: float(getattr(results, name)) for name in names}
    return found | {f"root_stress_{gear}": float(getattr(results, gear).root_stress) for gear in ("sun", "planet")}


def change(name: str, settings: str = "", result: str = "transmission_error", **values: float) -> float:
    """What one effect adds to a result, SI."""
    return shown(name, settings, **values)[result] - shown("", settings)[result]


@pytest.mark.parametrize("name", ["transmission_error", "backlash"])
def test_without_effects_nothing_is_off_and_the_flanks_are_as_warm_as_the_oil(name: str) -> None:
    for settings in ("", "load_torque=-300 N*m;input_speed=900 rpm;oil_temperature=70 degC"):
        assert shown("", settings)[name] == 0
    assert shown("", "oil_temperature=70 degC")["flank_temperature"] == pytest.approx(343.15, abs=1e-12)


# Waves over the angle


ORDERS = [  # effect, cosine, sine, turns per turn of the sun
    ("sun_runout", "cosine", "sine", 110 / 111),
    ("planet_runout", "cosine", "sine", 110 / 111 * 20 / 55),
    ("mesh_ripple", "cosine", "sine", 20 * 110 / 111),
    ("mesh_ripple", "second_cosine", "second_sine", 40 * 110 / 111),
    ("output_eccentricity", "cosine", "sine", 1 / 111),
    ("output_eccentricity", "tooth_cosine", "tooth_sine", 39 / 111),
]


@pytest.mark.parametrize(("name", "cosine", "sine", "order"), ORDERS)
def test_every_wave_has_its_order(name: str, cosine: str, sine: str, order: float) -> None:
    off: dict[str, Any] = {unknown.name: 0.0 for unknown in BY_NAME[name].unknowns}
    for angle in (0.0, 0.7, 40.0, -3.3, 900.0):
        found = change(name, **(off | {cosine: 3 * UM, sine: -4 * UM}), input_angle=angle)
        expected = 5 * UM * cos(order * angle + np.arctan2(4, 3))
        assert found == pytest.approx(expected, abs=1e-15)


def test_another_drive_has_other_orders() -> None:
    """16/48 with 30 pins: ratio 91, planet 1/3 of the sun, 29 teeth of a disc."""
    settings = "sun_teeth=16;planet_teeth=48;pin_teeth=30"
    for name, order in (("sun_runout", 90 / 91), ("planet_runout", 30 / 91), ("output_eccentricity", 1 / 91)):
        off: dict[str, Any] = {unknown.name: 0.0 for unknown in BY_NAME[name].unknowns}
        found = change(name, settings, **(off | {"sine": UM}), input_angle=2.0)
        assert found == pytest.approx(UM * sin(2 * order), abs=1e-15)


def test_a_miscount_adds_up() -> None:
    """Reference: one turn of the output, 111 of the sun, counted 1e-5 too long: 81.9 um on the base circle."""
    found = change("ratio_drift", miscount=1e-5, input_angle=111 * 2 * pi)
    assert found == pytest.approx(81.92 * UM, rel=1e-3)
    assert change("ratio_drift", miscount=1e-5, input_angle=0.0) == 0


# Ends: play that is taken up, a sun that idles, planets of which one carries all, teeth that touch in full


@pytest.mark.parametrize("torque", [-500.0, -20.0, 0.0, 20.0, 60.0, 500.0])
def test_torque_takes_up_the_play(torque: float) -> None:
    settings = f"load_torque={torque} N*m"
    values: dict[str, Any] = {"play": 24 * UM, "torque_scale": 30.0}
    assert change("lost_motion", settings, **values) == pytest.approx(12 * UM * tanh(torque / 30), rel=1e-9, abs=1e-18)
    assert change("lost_motion", settings, "backlash", **values) == pytest.approx(24 * UM, rel=1e-12)


def test_an_idle_sun_loses_all_that_it_is_driven_with() -> None:
    found = shown("speed_dependent_loss", "load_torque=0 N*m", constant=0.1, viscous=0.0)
    assert found["efficiency"] == 0


def strength_of(name: str, settings: str = "", **values: float) -> Any:
    """All results with an effect on the inputs on."""
    return rv_gearing(BY_NAME[name].function(stage_of(settings), **values))


def test_one_planet_of_two_carries_at_most_all() -> None:
    """Twice its half, in place of 1.1."""
    found = strength_of("planet_load_sharing", "load_torque=1285.75 N*m", lead=50 * UM)
    assert found.planets.planet_factor == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize(("torque", "share"), [(1285.75, 0.5), (-160.71875, 0.25), (12e3, 1.0)])
def test_crowned_teeth_carry_over_a_part_of_their_width(torque: float, share: float) -> None:
    found = strength_of("crowned_contact", f"load_torque={torque} N*m", full_line_load=8 * 518.52 / 12e-3)
    assert found.duty.carrying_width == pytest.approx(share * 12e-3, rel=1e-4)
