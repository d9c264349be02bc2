"""Studies take the results of a motion like any other: a mass on a spring, whose peak and settling are closed forms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oscillator import BAND, OSCILLATOR
from scipy.optimize import brentq
from scipy.stats import norm

from truing import Allocation, Optimise, Price, Reliability, Sensitivity, Sweep, Tolerance, normal
from truing.calculation import calculate
from truing.setup import default_setup

MASS, STIFFNESS, DAMPING, SPREAD, LIMIT = 1.0, 9.0, 1.2, 0.12, 0.6


def ratio_of(damping: Any) -> Any:
    return damping / (2 * np.sqrt(MASS * STIFFNESS))


def overshoot_of(damping: Any) -> Any:
    """exp(-pi D / sqrt(1 - D^2))."""
    ratio = ratio_of(damping)
    return np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2))


def settling_of(damping: float) -> float:
    """The last time at which the closed form of the step response comes into the band."""
    ratio, natural = ratio_of(damping), np.sqrt(STIFFNESS / MASS)
    swing = natural * np.sqrt(1 - ratio**2)

    def off(t: Any) -> Any:
        wave = np.cos(swing * t) + ratio / np.sqrt(1 - ratio**2) * np.sin(swing * t)
        return np.abs(np.exp(-ratio * natural * t) * wave) - BAND

    times = np.linspace(0, 30, 30_001)
    last = np.flatnonzero(off(times) > 0)[-1]
    return float(brentq(off, times[last], times[last + 1]))


def failing(limit: float = LIMIT) -> float:
    """The chance of a larger overshoot: it falls with the damping, which is normal."""
    log = -np.log(limit)
    ratio = log / np.sqrt(np.pi**2 + log**2)
    return float(norm.cdf((2 * np.sqrt(MASS * STIFFNESS) * ratio - DAMPING) / SPREAD))


def outcome_of(study: Any, **changes: Any) -> Any:
    model, times = replace(OSCILLATOR, **changes), np.linspace(0, 12, 13)
    return calculate(replace(default_setup(model, times=times), studies=(study,))).outcomes[study.name]


def test_derivatives_of_a_peak_and_of_settling_are_those_of_the_closed_forms() -> None:
    found = outcome_of(Sensitivity(of=("overshoot", "settling"))).derivatives
    step = 1e-4
    for name, closed in (("overshoot", overshoot_of), ("settling", settling_of)):
        expected = (closed(DAMPING + step) - closed(DAMPING - step)) / (2 * step)
        assert found[name]["damping"] == pytest.approx(expected, rel=1e-5)


def test_a_sweep_draws_peak_and_settling() -> None:
    swept = outcome_of(Sweep(over="damping", at="0.8, 1.2, 3 N*s/m"))
    assert swept.results["overshoot"] == pytest.approx(overshoot_of(swept.axis), rel=1e-6)
    assert swept.results["settling"] == pytest.approx([settling_of(each) for each in swept.axis], rel=1e-6)
    assert swept.failed == ()


def test_the_chance_of_a_peak_is_that_of_the_closed_form() -> None:
    """FORM is exact, for the limit is one value of a normal damping; a count lies within four standard errors."""
    methods = ("first_order", "monte_carlo", "form")
    odds = outcome_of(Reliability(draws=2048, method=methods))
    assert odds.failed == 0
    assert odds.form["overshoot"].probability == pytest.approx(1 - failing(), abs=1e-6)
    assert odds.probability["overshoot"] == pytest.approx(1 - failing(), abs=4 * odds.standard_error["overshoot"])


def test_tolerances_and_designs_are_chosen_by_what_moves() -> None:
    """Bought is the widest band that keeps 90 %, to first order; a front holds what the closed forms say of designs."""
    tolerance = Tolerance("damping", normal(sd="0.24 N*s/m"), price=Price("1 / width", width="N*s/m", unit="EUR"))
    allotted = outcome_of(Allocation(draws=1024), errors=[tolerance])
    slope = (overshoot_of(DAMPING + 1e-5) - overshoot_of(DAMPING - 1e-5)) / 2e-5
    sd = (overshoot_of(DAMPING) - LIMIT) / slope / norm.ppf(0.9)
    assert float(allotted.tolerances["damping"].split()[1]) == pytest.approx(sd, rel=1e-5)
    front = outcome_of(Optimise(population=8, generations=2, draws=32, verify=128), errors=[tolerance]).front
    assert len(front) > 1
    for design in front:
        damping = design.inputs["damping"]
        frequency = np.sqrt(STIFFNESS / MASS * (1 - ratio_of(damping) ** 2)) / (2 * np.pi)
        assert design.objectives["settling"] == pytest.approx(settling_of(damping), rel=1e-6)
        assert design.objectives["frequency"] == pytest.approx(frequency, rel=1e-6)
