"""Backlash of the RV reducer: equation 21 a second time, its derivatives, its machines, their price, its studies.

Sixteen factors with their coefficients in the backlash, in arc minutes per millimetre, worked out by hand from the
geometry: q = sqrt(1 - K_1^2), K_1 = e z_p / r_p, and the arms r_1 i_H (involute), e z_c (cycloid), a (crank bearings).
"""

from dataclasses import replace
from math import pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from rv_wear_by_hand import PRICE_OF, price_by_hand

from rv_wear.calculation import rv_wear
from rv_wear.discs import DiscValidity, Modifications
from rv_wear.machines import FACTORS
from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer
from truing import Sweep
from truing.calculation import Calculation, calculate
from truing.declare.spreads import Off, with_width
from truing.errors import TruingError
from truing.setup import Setup, default_setup
from truing.studies.reliability import Reliability
from truing.studies.sensitivity import Sensitivity

ARCMIN, MM = pi / 180 / 60, 1e-3
E, PINS, CIRCLE, SUN, RATIO, CENTRES, ALPHA = 2.2, 40, 114.5, 18.0, 101.0, 63.0, 20 * pi / 180
K1 = E * PINS / CIRCLE
Q = sqrt(1 - K1**2)

# Factor: (numerator, arm in mm) of the sixteen lines of Table 2.
LINES: dict[int, tuple[float, float]] = {
    1: (-1, SUN * RATIO), 2: (2 * sin(ALPHA), SUN * RATIO), 3: (2 * sin(ALPHA), SUN * RATIO),
    4: (2, E * 39), 5: (-2 * Q, E * 39), 6: (2 * Q, E * 39), 7: (-2, E * 39), 8: (1, E * 39), 9: (0.5, E * 39),
    10: (2 * K1, E * 39), 11: (-K1, E * 39), 12: (2, E * 39), 13: (-2 * Q, E * 39), 14: (1.6e-4 * 2 * Q, E * 39),
    15: (2, E * 39), 16: (1, CENTRES),
}  # fmt: skip
COEFFICIENTS = {number: numerator / arm / ARCMIN for number, (numerator, arm) in LINES.items()}  # arcmin per mm

# Middle and width of every zone, mm.
ZONES = {
    1: (-0.015, 0.010), 2: (0.005, 0.010), 3: (0.0, 0.020), 6: (0.0, 0.0012), 7: (-0.002, 0.001), 8: (0.0085, 0.0016),
    9: (0.003275, 0.00655), 10: (0.0006, 0.0012), 11: (0.0, 0.002), 12: (0.0, 0.0012), 13: (0.0, 0.0012),
    14: (0.0, 0.004), 16: (0.0111, 0.0012),
}  # fmt: skip
MODIFICATIONS = {4: -0.026, 5: -0.030}


def mean_backlash(wear: float) -> float:
    """Equation 21 with every factor in the middle of its zone, arcmin; wear in mm."""
    values = {**{number: middle for number, (middle, _) in ZONES.items()}, **MODIFICATIONS, 15: wear}
    return sum(COEFFICIENTS[number] * value for number, value in values.items())


def variance_of_zones() -> float:
    """Square of the standard deviation of the backlash without the scatter of wear, arcmin^2."""
    return sum((COEFFICIENTS[number] * width / 6) ** 2 for number, (_, width) in ZONES.items())


def run(setup: Setup, *studies: Any) -> Calculation:
    return calculate(replace(setup, studies=studies))


def study(name: str) -> Any:
    return next(each for each in RV_WEAR.studies if each.name == name)


@pytest.fixture(scope="module")
def new() -> Calculation:
    """The reducer before it has worked, with 100 000 machines."""
    setup = default_setup(RV_WEAR, working_time="0 h")
    drawn = replace(study("reliability"), draws=100_000, over="", at="")
    return run(setup, Sensitivity(of="backlash", gives=study("sensitivity").gives), drawn)


def test_the_new_reducer_has_the_backlash_of_equation_21_in_the_middle_of_all_zones(new: Calculation) -> None:
    assert new.answers["backlash"] / ARCMIN == pytest.approx(mean_backlash(0.0), rel=1e-12)
    assert new.answers["backlash"] / ARCMIN == pytest.approx(0.698, abs=5e-4)


def test_the_worn_reducer_has_the_deepest_wear_on_both_flanks_more() -> None:
    worn = rv_wear(Reducer())
    wear = float(worn.max_wear) / MM
    assert float(worn.backlash) / ARCMIN == pytest.approx(mean_backlash(wear), rel=1e-12)
    assert float(worn.backlash) / ARCMIN == pytest.approx(0.949, abs=5e-4)
    assert 2 * wear / (E * 39) / ARCMIN == pytest.approx(80.13 * wear, rel=1e-4)


@pytest.mark.parametrize("number", [number for number in LINES if number not in (4, 5, 15)])
def test_each_error_of_a_part_moves_the_backlash_by_its_coefficient(number: int) -> None:
    """Central differences of the whole calculation, 0.1 um to either side; no part error moves the wear."""
    name, step = FACTORS[number], 0.1e-6
    middle = getattr(Reducer(), name)
    up, down = (rv_wear(replace(Reducer(), **{name: middle + by})) for by in (step, -step))
    slope = (float(up.backlash) - float(down.backlash)) / (2 * step) / ARCMIN * MM
    assert slope == pytest.approx(COEFFICIENTS[number], rel=1e-8, abs=1e-8)
    assert float(up.max_wear) == float(down.max_wear)


def test_machines_that_are_drawn_have_the_mean_and_spread_of_the_sum(new: Calculation) -> None:
    """Within four standard errors; of a standard deviation it is sd / sqrt(2 n)."""
    mean, sd, draws = mean_backlash(0.0), sqrt(variance_of_zones()), 100_000
    assert new.answers["sampled_mean"] / ARCMIN == pytest.approx(mean, abs=4 * sd / sqrt(draws))
    assert new.answers["sampled_sd"] / ARCMIN == pytest.approx(sd, abs=4 * sd / sqrt(2 * draws))
    assert new.answers["backlash_mean"] / ARCMIN == pytest.approx(mean, rel=1e-9)
    assert new.answers["backlash_sd"] / ARCMIN == pytest.approx(sd, rel=1e-6)
    assert new.answers["accuracy_reliability"] == 1.0


@pytest.mark.parametrize(("limit", "chance"), [("0.9485 arcmin", 0.0), ("0.9495 arcmin", 1.0)])
def test_zones_without_width_leave_a_reliability_of_0_or_1(limit: str, chance: float) -> None:
    """0.949 arcmin lies between both limits."""
    setup = default_setup(RV_WEAR, permitted_backlash=limit)
    setup = replace(setup, spreads={name: Off() for name in setup.spreads})
    found = run(setup, Reliability(draws=100, method=("first_order", "monte_carlo"), gives=study("reliability").gives))
    assert (found.answers["accuracy_reliability"], found.answers["normal_reliability"]) == (chance, chance)


# ---- cost ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", ["power", "exponential", "process"])
def test_the_cost_is_the_sum_of_six_functions_in_each_form(form: str) -> None:
    found = run(default_setup(RV_WEAR, cost_form=form), study("costs"))
    bill = found.outcomes["costs"].as_json()["tolerances"]
    expected = {name: price_by_hand(kind, ZONES[number][1], form) for name, (kind, number) in PRICE_OF.items()}
    assert {name: line["prices"][form] for name, line in bill.items()} == pytest.approx(expected, rel=1e-9)
    assert {name: line["width"]["value"] for name, line in bill.items()} == pytest.approx(
        {name: 1000 * ZONES[number][1] for name, (_, number) in PRICE_OF.items()}, rel=1e-9
    )
    assert found.answers["manufacturing_cost"] == pytest.approx(sum(expected.values()), rel=1e-9)
    assert found.answers["tolerance_price"] == found.answers["manufacturing_cost"]


def test_a_zone_that_grows_up_keeps_its_lower_end_at_nothing() -> None:
    """Runout and pin position start at 0: doubled, their mean is what their width was."""
    setup = default_setup(RV_WEAR)
    for name, (middle, width) in {"disc_runout": ZONES[9], "pin_position_error": ZONES[10]}.items():
        target = setup.target(name)
        wide = with_width(RV_WEAR.tolerances[name].spread, target, 2 * width * MM).resolve(target)
        assert wide is not None
        assert wide.mean == pytest.approx(2 * middle * MM, rel=1e-9)
        assert wide.sd == pytest.approx(2 * width * MM / 6, rel=1e-9)


# ---- zones, studies and what may be chosen --------------------------------------------------------------------------


def test_every_factor_scatters_normally_in_its_zone_six_standard_deviations_wide() -> None:
    groups = default_setup(RV_WEAR).distributions().values()
    scattering = {name: item for inner in groups for name, item in inner.items()}
    for number, (middle, width) in ZONES.items():
        name = FACTORS[number]
        assert scattering[name].mean == pytest.approx(MM * middle, abs=1e-15)
        assert scattering[name].sd == pytest.approx(MM * width / 6, rel=1e-9)
        assert scattering[name].shape == "normal"
        assert getattr(Reducer(), name) == pytest.approx(MM * middle, abs=1e-15)
    assert set(scattering) == {*(FACTORS[number] for number in ZONES), "composite_roughness"}
    assert scattering["composite_roughness"].sd == pytest.approx(0.0126 * 0.694e-6, rel=1e-9)


def test_the_least_cost_lies_within_the_widths_and_reaches_its_goal() -> None:
    at = {"equidistant_modification": "-27 um", "shift_modification": "-31 um"}
    found = run(default_setup(RV_WEAR, **at), replace(study("allocation"), draws=20_000))
    plan = found.outcomes["allocation"].least_cost
    setup = default_setup(RV_WEAR)
    for name, width in plan.widths.items():
        now = next(iter(setup.distributions()[name].values())).width
        assert now * (1 - 1e-9) <= width <= 2 * now * (1 + 1e-9), name
    assert plan.reached
    assert found.answers["least_cost"] == pytest.approx(1336, rel=2e-3)


def test_without_a_design_that_reaches_the_goal_there_is_no_least_cost() -> None:
    assert np.isnan(run(default_setup(RV_WEAR), study("allocation")).answers["least_cost"])


def test_a_sweep_over_something_else_leaves_the_histories_empty() -> None:
    swept = Sweep(over="output_torque", at="1000..4500 N*m", points=5, gives=study("sweep").gives)
    found = run(default_setup(RV_WEAR), swept)
    for name in ("history_time", "wear_history", "backlash_history"):
        assert len(found.answers[name]) == 0
    assert found.answers["wear_depth"].max() == pytest.approx(found.answers["max_wear"], rel=1e-9)


@pytest.mark.parametrize("options", [{"points": 1}, {"points": 101}, {"hours": 0.0}])
def test_impossible_options_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(TruingError, match="study 'modifications'"):
        Modifications(**options)


def test_both_readings_of_the_lower_bound_are_shown() -> None:
    valid = run(default_setup(RV_WEAR), DiscValidity()).outcomes["validity"]
    assert valid.lowest * 1e6 == pytest.approx(-53.75, abs=5e-3)
    assert valid.highest * 1e6 == pytest.approx(11.104, abs=1e-3)
    assert -53 < valid.lowest_by_approach * 1e6 < -30
    assert valid.warnings() == []
    assert "twice the radial" in str(valid.blocks()[0])
