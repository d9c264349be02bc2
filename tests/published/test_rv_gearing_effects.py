"""What the rating leaves out of the first stage: orders of waves, ends of play and load, and crowned teeth.

What each effect does is compared with a machine of its own in ``test_effects_of_machines.py``. Numbers marked as
reference follow by hand for 20/55 teeth, 40 pins, module 1.25 mm at 2.26 kW: ratio 111, 518.5 N per mesh.
"""

from functools import partial
from math import sin
from typing import Any

import pytest
from switched import change, shown

from rv_gearing.model import RV_GEARING

UM = 1e-6
with_effect: Any = partial(shown, RV_GEARING)


def stage_of(sun: int = 20, planet: int = 55, **settings: Any) -> Any:
    return RV_GEARING.inputs(sun_teeth=sun, planet_teeth=planet, **settings)


@pytest.mark.parametrize("name", ["transmission_error", "backlash"])
def test_without_effects_nothing_is_off_and_the_flanks_are_as_warm_as_the_oil(name: str) -> None:
    for settings in ({}, {"load_torque": -300.0, "input_speed": 15.0, "oil_temperature": 343.15}):
        assert with_effect("", stage_of(**settings))[name] == 0
    warm = with_effect("", stage_of(oil_temperature=343.15))
    assert warm["flank_temperature"] == pytest.approx(343.15, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "sine", "order"),
    [
        ("sun_runout", "sine", 90 / 91), ("planet_runout", "sine", 30 / 91), ("output_eccentricity", "sine", 1 / 91),
        ("output_eccentricity", "tooth_sine", 29 / 91), ("mesh_ripple", "sine", 16 * 90 / 91),
        ("mesh_ripple", "second_sine", 32 * 90 / 91),
    ],
)  # fmt: skip
def test_another_drive_has_other_orders(name: str, sine: str, order: float) -> None:
    """16/48 with 30 pins: ratio 91, planet 1/3 of the sun, 29 teeth of a disc."""
    stage = stage_of(16, 48, pin_teeth=30)
    values = {unknown.name: UM if unknown.name == sine else 0.0 for unknown in RV_GEARING.effects[name].unknowns}
    for angle in (2.0, -3.3, 900.0):
        found = change(RV_GEARING, "transmission_error", name, stage, **values, input_angle=angle)
        assert found == pytest.approx(UM * sin(order * angle), abs=1e-15)


# Ends: a sun that idles, planets of which one carries all, teeth that touch in full


def test_an_idle_sun_loses_all_that_it_is_driven_with() -> None:
    assert with_effect("speed_dependent_loss", stage_of(load_torque=0.0), constant=0.1, viscous=0.0)["efficiency"] == 0


def test_one_planet_of_two_carries_at_most_all() -> None:
    """Twice its half, in place of 1.1."""
    found = with_effect("planet_load_sharing", stage_of(load_torque=1285.75), lead=50 * UM)
    assert found["planet_factor"] == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize(("torque", "share"), [(1285.75, 0.5), (-160.71875, 0.25), (12e3, 1.0)])
def test_crowned_teeth_carry_over_a_part_of_their_width(torque: float, share: float) -> None:
    found = with_effect("crowned_contact", stage_of(load_torque=torque), full_line_load=8 * 518.52 / 12e-3)
    assert found["carrying_width"] == pytest.approx(share * 12e-3, rel=1e-4)
