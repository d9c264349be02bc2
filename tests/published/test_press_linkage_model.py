"""The press linkage as a calculation: what its paper prints, its two readings, its effect, its sheet, bad input.

Numbers of the paper are those it prints; Reference numbers were computed once by an independent program that shares no
code with this one, from the reconstructed equations.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

import press_linkage
from press_linkage import errors
from press_linkage.effects import LINK_TEMPERATURE
from press_linkage.model import PRESS_LINKAGE
from shared import ROUNDING
from truing import Kernel
from truing.calculation import Calculation, calculate
from truing.errors import InfeasibleError, InputError
from truing.inputs_file import setup_from_text
from truing.setup import SwitchedOn, default_setup

OFFER = Kernel([press_linkage], strict=True).offers["press_linkage"]
EXAMPLE = PRESS_LINKAGE.example
STEEL = 11.5e-6  # 1/K


@cache
def ran(**inputs: Any) -> Calculation:
    return calculate(default_setup(PRESS_LINKAGE, **inputs))


def heated(by: float, expansion: float = STEEL, **inputs: Any) -> Calculation:
    """The press with its links warmer by so many kelvin."""
    setup = default_setup(PRESS_LINKAGE, **inputs)
    effect = SwitchedOn(PRESS_LINKAGE.effects["link_heating"], {"expansion": expansion})
    warm = {"link_temperature": LINK_TEMPERATURE.zero + by}
    return calculate(replace(setup, effects=(effect,), conditions=warm))


def test_printed_reaches_its_goals_and_complete_does_not() -> None:
    assert ran(reading="printed").verdict == "proposed"
    assert PRESS_LINKAGE.inputs().reading == "complete"
    complete = ran()
    assert {check.name: check.state for check in complete.checks} == dict.fromkeys(
        ("slider_position", "slider_tilt"), "fails"
    )
    assert not complete.outcomes["allocation"].reached
    assert set(complete.outcomes["allocation"].tolerances.values()) == {"IT5"}
    assert any("not reachable" in warning for warning in complete.warnings)


VARIANCES = [  # um^2 of the slider position at the start, both sides: reference numbers
    ("lower_knee_length", 276.8), ("upper_knee_length", 256.4), ("knee_drive_length", 67.0),
    ("slider_half_width", 38.3), ("rod_length", 4.8), ("platform_arm", 2.1), ("ground_pivot_radius", 1.2),
    ("crank_radius", 1.0), ("crank_pivot_radius", 3.6), ("platform_half_width", 0.9), ("slider_joint_angle", 138.9),
    ("ground_pivot_angle", 112.8), ("crank_pivot_angle", 8.8), ("platform_joint_angle", 2.2),
]  # fmt: skip


@pytest.mark.parametrize(("name", "variance"), VARIANCES)
def test_variance_of_each_kind_of_error(name: str, variance: float) -> None:
    found = ran(reading="complete").outcomes["sensitivity"]
    tolerance = PRESS_LINKAGE.tolerances[name]
    share = sum(found.share["slider_position"][source] for source in tolerance.on)
    assert share * found.sd["slider_position"] ** 2 * 1e12 == pytest.approx(variance, abs=0.06)


def test_groups_of_variance_add_up() -> None:
    answers = ran(reading="printed").answers
    # the part that tightening links does not change, from the printed pair of reliabilities: 41.3 +- 0.2 um^2
    assert answers["variance_joints_along"] * 1e12 == pytest.approx(41.3, abs=0.2)
    assert answers["variance_joints_across"] == answers["variance_other"] == 0.0
    assert answers["position_sd"] == pytest.approx(25.48e-6, abs=6e-9)
    assert answers["tilt_sd"] == pytest.approx(15.81e-6, abs=6e-9)


def test_dead_centres_do_not_depend_on_where_one_looks() -> None:
    here, there = ran(reading="printed").answers, ran(reading="printed", crank_angle="70 deg").answers
    assert there["slider_position"] != here["slider_position"]
    for name in ("bdc_position", "tdc_position", "stroke", "tdc_crank_angle", "bdc_direction", "smallest_sine"):
        assert there[name] == here[name]


def test_all_29_sources_are_inputs_with_a_tolerance() -> None:
    scattering = [name for tolerance in PRESS_LINKAGE.tolerances.values() for name in tolerance.on]
    assert sorted(scattering) == sorted(errors.SOURCES)
    assert len(set(scattering)) == 29
    assert set(errors.SOURCES) <= set(PRESS_LINKAGE.input_fields)


def test_monte_carlo_agrees_with_first_order() -> None:
    for reading in ("printed", "complete"):
        odds = ran(reading=reading).outcomes["reliability"]
        for check, (low, high) in odds.interval.items():
            middle, half = (high + low) / 2, (high - low) / 2
            assert abs(odds.analytic[check] - middle) < 2 * half  # 4 standard errors
        assert odds.mean["slider_position"] - 3.5575988 == pytest.approx(0.0, abs=0.5e-6)
    assert odds.sd["slider_position"] == pytest.approx(30.2e-6, rel=0.01)  # reference, first order
    assert odds.sd["slider_tilt"] == pytest.approx(18.7e-6, rel=0.01)


def test_link_heating_changes_every_study() -> None:
    cold, warm = ran(reading="printed"), heated(40.0, reading="printed")
    for name in ("bdc_position", "stroke", "slider_shift", "salience_position_key", "salience_tilt_key"):
        assert warm.answers[name] != cold.answers[name], name
    assert warm.answers["slider_shift"] * 1e6 == pytest.approx(40 * 49.9, rel=2e-3)
    assert warm.answers["bdc_position"] == pytest.approx(warm.answers["slider_position"], rel=ROUNDING)
    for name in ("position_reliability", "tilt_reliability", "position_reliability_final", "coefficient_rod_length"):
        assert warm.answers[name] != cold.answers[name], name
    assert (warm.outcomes["sweep"].results["slider_position"] > cold.outcomes["sweep"].results["slider_position"]).all()
    first, second = (run.outcomes["reliability"].mean["slider_position"] for run in (cold, warm))
    assert (second - first) * 1e6 == pytest.approx(40 * 49.9, rel=2e-3)


def test_heat_moves_the_press_out_of_the_middle_of_its_limits() -> None:
    """0.3 K of 49.9 um/K; the chance that the paper's 25.48 um of scatter stays within 20 um of the cold press."""
    warm = heated(0.3, reading="printed").answers
    assert warm["position_offset"] * 1e6 == pytest.approx(0.3 * 49.9, abs=0.02)
    assert warm["tilt_offset"] == pytest.approx(0.0, abs=1e-15)
    normal = NormalDist(0.3 * 49.9, 25.48)
    assert warm["position_reliability"] == pytest.approx(normal.cdf(20) - normal.cdf(-20), abs=5e-4)
    assert ran(reading="printed").answers["position_offset"] == 0.0


@pytest.mark.parametrize("text", ["rod_length_deviation_1 = '10.1 mm'", "crank_angle_deviation_2 = '-11 mrad'"])
def test_a_deviation_that_is_no_deviation_is_refused(text: str) -> None:
    """Ten millimetres or milliradians off is another part, or a unit mistaken by a thousand."""
    with pytest.raises(InputError, match=text.partition(" ")[0]):
        setup_from_text(f"[inputs]\n{text}", OFFER, file="press.toml", folder=Path())
    half = text.replace("10.1", "5").replace("11", "5")
    assert setup_from_text(f"[inputs]\n{half}", OFFER, file="press.toml", folder=Path())


def test_crank_that_only_swings_is_calculated_without_the_sweep() -> None:
    setup = default_setup(PRESS_LINKAGE, rod_length="1.2 m")
    with pytest.raises(InfeasibleError, match="leave the sweep out"):
        calculate(setup)
    found = calculate(replace(setup, studies=tuple(study for study in setup.studies if study.name != "sweep")))
    assert np.isfinite(found.answers["position_reliability"])


def test_example_repeats_the_paper() -> None:
    assert EXAMPLE is not None
    setup = setup_from_text(EXAMPLE.read_text(encoding="utf-8"), OFFER, file=str(EXAMPLE), folder=EXAMPLE.parent)
    assert setup.inputs.reading == "printed"
    found = calculate(setup)
    assert found.verdict == "proposed"
    assert dict(found.answers) == dict(ran(reading="printed").answers)


def test_both_readings_stand_on_the_sheet() -> None:
    table = ran(reading="printed").outcomes["readings"].table()
    printed, complete = table.rows
    assert printed[0] == "printed"
    assert printed[1:6] == pytest.approx([56.74, 88.69, 85.62, 99.71, 9], abs=0.006)
    assert complete[1:6] == pytest.approx([49.16, 66.91, 77.60, 92.84, 12], abs=0.006)
    assert (printed[6], complete[6]) == (True, False)


def test_the_knee_closes_its_triangle() -> None:
    """Knee drive and upper link reach the knee from both ends of the line between their joints."""
    press, answers = PRESS_LINKAGE.inputs(), ran(reading="printed").answers
    along, across, distance = (answers[name] for name in ("knee_along", "knee_across", "ground_distance"))
    assert np.hypot(along, across) * distance == pytest.approx(press.knee_drive_length, rel=1e-12)
    assert np.hypot(1 - along, across) * distance == pytest.approx(press.upper_knee_length, rel=1e-12)


def test_a_stated_deviation_counts_against_the_limits() -> None:
    """A lower knee link 0.1 mm long on one side tilts the slider by 1.1294 * 0.1 mm / 3.2 m, the limit is 23 urad."""
    bent = ran(reading="printed", lower_knee_length_deviation_1="0.1 mm")
    tilt = 1.129368 * 0.1e-3 / 3.2
    assert bent.answers["tilt_offset"] == pytest.approx(tilt, rel=1e-4)
    assert bent.answers["position_offset"] == pytest.approx(1.129368 * 0.1e-3 / 2, rel=1e-4)
    law = NormalDist(tilt, ran(reading="printed").answers["tilt_sd"])
    limit = bent.answers["permitted_tilt"]
    assert bent.answers["tilt_reliability"] == pytest.approx(law.cdf(limit) - law.cdf(-limit), abs=1e-4)
    assert bent.verdict == "fails"
