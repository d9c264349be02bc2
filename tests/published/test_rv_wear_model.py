"""The declaration of the reducer: zones, prices, what may be chosen, and what the studies give."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rv_wear.discs import DiscValidity, Modifications
from rv_wear.model import RV_WEAR
from truing import Sweep
from truing.calculation import Calculation, calculate
from truing.errors import TruingError
from truing.setup import default_setup

# Lower and upper end of every zone, um.
ZONES = {
    "base_tangent_error": (-20, -10), "gear_runout": (0, 10), "centre_distance_error": (-10, 10),
    "pin_circle_error": (-0.6, 0.6), "pin_radius_error": (-2.5, -1.5), "pin_fit_clearance": (7.7, 9.3),
    "disc_runout": (0, 6.55), "pin_position_error": (0, 1.2), "disc_pitch_error": (-1, 1),
    "equidistant_error": (-0.6, 0.6), "shift_error": (-0.6, 0.6), "eccentricity_error": (-2, 2),
    "bearing_clearance": (10.5, 11.7),
}  # fmt: skip


def run(*studies: Any, **values: str) -> Calculation:
    return calculate(replace(default_setup(RV_WEAR, **values), studies=studies))


def study(name: str) -> Any:
    return next(each for each in RV_WEAR.studies if each.name == name)


def test_every_factor_scatters_normally_in_its_zone_six_standard_deviations_wide() -> None:
    scattering = {
        name: item for inner in default_setup(RV_WEAR).distributions().values() for name, item in inner.items()
    }
    for name, (low, high) in ZONES.items():
        assert scattering[name].mean == pytest.approx(1e-6 * (low + high) / 2, abs=1e-15)
        assert scattering[name].sd == pytest.approx(1e-6 * (high - low) / 6, rel=1e-9)
        assert scattering[name].shape == "normal"
    assert set(scattering) == {*ZONES, "composite_roughness"}
    assert scattering["composite_roughness"].sd == pytest.approx(0.0126 * 0.694e-6, rel=1e-9)


def test_every_input_stands_in_the_middle_of_its_zone() -> None:
    reducer = RV_WEAR.inputs()
    for name, (low, high) in ZONES.items():
        assert getattr(reducer, name) == pytest.approx(1e-6 * (low + high) / 2, abs=1e-15)


def test_the_least_cost_lies_within_the_widths_and_reaches_its_goal() -> None:
    at = {"equidistant_modification": "-27 um", "shift_modification": "-31 um"}
    found = run(replace(study("allocation"), draws=20_000), **at)
    plan = found.outcomes["allocation"].least_cost
    setup = default_setup(RV_WEAR)
    for name, width in plan.widths.items():
        now = next(iter(setup.distributions()[name].values())).width
        assert now * (1 - 1e-9) <= width <= 2 * now * (1 + 1e-9), name
    assert plan.reached
    assert found.answers["least_cost"] == pytest.approx(1336, rel=2e-3)


def test_without_a_design_that_reaches_the_goal_there_is_no_least_cost() -> None:
    assert np.isnan(run(study("allocation")).answers["least_cost"])


def test_a_sweep_over_something_else_leaves_the_histories_empty() -> None:
    swept = Sweep(over="output_torque", at="1000..4500 N*m", points=5, gives=study("sweep").gives)
    found = run(swept)
    for name in ("history_time", "wear_history", "backlash_history"):
        assert len(found.answers[name]) == 0
    assert found.answers["wear_depth"].max() == pytest.approx(found.answers["max_wear"], rel=1e-9)


def test_the_deepest_wear_lies_in_the_middle_of_the_contact() -> None:
    """58 degree in a contact from about 9 to about 100 degree."""
    found = run(study("sweep"))
    assert 0.4 < found.answers["wear_place"] < 0.6
    assert np.degrees(found.answers["wear_angle"]) == pytest.approx(58, abs=1.0)


@pytest.mark.parametrize("options", [{"points": 1}, {"points": 101}, {"hours": 0.0}])
def test_impossible_options_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(TruingError, match="study 'modifications'"):
        Modifications(**options)


def test_both_readings_of_the_lower_bound_are_shown() -> None:
    valid = run(DiscValidity()).outcomes["validity"]
    assert valid.lowest * 1e6 == pytest.approx(-53.75, abs=5e-3)
    assert valid.highest * 1e6 == pytest.approx(11.104, abs=1e-3)
    assert -53 < valid.lowest_by_approach * 1e6 < -30
    assert valid.warnings() == []
    assert "twice the radial" in str(valid.blocks()[0])


def test_the_example_file_states_every_input_or_names_it_as_neutral() -> None:
    assert RV_WEAR.example is not None
    text = RV_WEAR.example.read_text(encoding="utf-8")
    for name in [*RV_WEAR.input_fields, *RV_WEAR.tolerances, *RV_WEAR.effects, *RV_WEAR.conditions]:
        assert name in text, name
