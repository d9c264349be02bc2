"""At the ends of what the reducer's laws hold for: where it still answers, and what it says outside of them."""

from __future__ import annotations

import pytest

from truing import Kernel
from truing.calculation import Calculation, calculate
from truing.inputs_file import setup_from_settings
from truing.report.html_printer import html_of
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of


def found_with(*settings: str) -> Calculation:
    """Calculate the reducer with settings as of ``--set``, and only the study of what its laws hold for."""
    offer = Kernel.installed().offers["rv_wear"]
    pairs = dict(text.split("=", 1) for text in settings)
    return calculate(setup_from_settings(offer, {**pairs, "studies.run": '["validity"]'}))


@pytest.mark.parametrize("radius", ["8.97 mm", "5 mm"])
def test_pins_that_just_do_not_overlap(radius: str) -> None:
    assert found_with(f"pin_radius={radius}").answers["max_wear"] > 0


def test_what_is_said_stands_on_the_sheet() -> None:
    found = found_with("pressure_viscosity=4e-9 1/Pa", "working_time=0 h")
    said = "study 'validity': pressure_viscosity is 4e-09 1/Pa, outside of 5e-9 to 5e-8 1/Pa"
    html = html_of(make_sheet(found, provenance=provenance_of(found.setup)))
    assert said.replace("'", "&#39;") in html


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ("pressure_viscosity=4e-9 1/Pa", "pressure_viscosity is 4e-09 1/Pa, outside of 5e-9 to 5e-8 1/Pa"),
        ("pressure_viscosity=6e-8 1/Pa", "pressure_viscosity is 6e-08 1/Pa, outside of 5e-9 to 5e-8 1/Pa"),
        ("composite_roughness=0.04 um", "composite_roughness is 0.04 um, outside of 0.05 to 5 um"),
        ("composite_roughness=6 um", "composite_roughness is 6 um, outside of 0.05 to 5 um"),
        (
            "equidistant_modification=-54 um; shift_modification=-58 um",
            "equidistant_modification is -54 um, below the -53.75 um of equation 17",
        ),
        ("pressure_viscosity=5e-8 1/Pa", ""),  # nothing is said at the ends
        ("composite_roughness=0.05 um", ""),
        ("equidistant_modification=-26 um", ""),
    ],
)
def test_oil_surfaces_and_modifications_outside_of_what_holds(settings: str, words: str) -> None:
    warnings = found_with(*settings.split("; "), "working_time=0 h").warnings
    assert [words in warning for warning in warnings] == [True] * bool(words)


def test_a_torque_that_only_one_pin_carries() -> None:
    found = found_with(
        "output_torque=0.1 N*m", "phases=200", "shift_modification=-126 um", "equidistant_modification=-26 um"
    )
    assert found.answers["loaded_pins"] < 2
    assert any("output_torque is too small" in warning for warning in found.warnings)


def test_a_pressure_above_the_permitted_one_fails_a_check() -> None:
    found = found_with("output_torque=20000 N*m", "working_time=0 h")
    (check,) = [check for check in found.checks if check.name == "max_pressure"]
    assert check.value > 2000
    assert not check.passed
