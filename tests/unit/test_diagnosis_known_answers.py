"""Known answers of the algebra of a diagnosis: likelihood, angles, separation, updates, profiles.

Expected numbers were worked out by hand or come from an independent calculation beside them.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    STROKE,
    UM,
    Array,
    Asked,
    cause_of,
    chosen_as,
    drive_model,
    fit_of,
    gauge,
    of_size_one,
    plain_competition,
    size_of,
    twist_model,
    warming,
    wide,
)
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.linalg import subspace_angles
from scipy.stats import multivariate_normal, norm

from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import conditional_on
from truing.diagnosis.fitted import Fit
from truing.diagnosis.noise import Autocorrelation, whiten
from truing.diagnosis.visibility import inseparable, needed, separation


def one_run(n: int) -> NDArray[np.bool_]:
    starts = np.zeros(n, dtype=bool)
    starts[0] = True
    return starts


def seen_angle(made: Competition, first: str, second: str) -> float:
    """The angle in degrees between two curves as the search sees them: without what is tolerated, nearly at zero."""
    beside = conditional_on(made.null, made.extended)
    drawn = []
    for name in (first, second):
        bundle = made.curves.of(cause_of(made, name), made.null)
        smallest = int(np.argmin(np.linalg.norm(bundle.curves, axis=-1)[:, 0]))
        drawn.append(beside.beyond(beside.drawn(bundle.curves[smallest : smallest + 1]))[0, 0])
    one, other = (each / np.linalg.norm(each) for each in drawn)
    return float(np.degrees(np.arccos(abs(one @ other))))


def believed(made: Competition, name: str, *numbers: float) -> Fit:
    """An explanation with numbers of its own (SI), as if it had been found."""
    cause, values, still = cause_of(made, name), np.array(numbers), np.zeros_like(made.null.inputs)
    (predicted,) = made.extended.at((cause,), [([values], np.zeros(len(made.extended.machine.inputs)))])
    left = made.sample.left(predicted)
    return Fit((cause,), (values,), still, predicted, left, made.sample.cost(left, still), made.sample)


def test_the_exact_likelihood_of_six_values_of_an_autoregression() -> None:
    values = np.array([0.3, -0.1, 0.4, 1.2, 0.7, -0.5])
    ours = norm.logpdf(whiten(values, one_run(6), Autocorrelation(0.6)), scale=0.8).sum() + np.log(1 - 0.6**2) / 2
    lag = np.abs(np.subtract.outer(np.arange(6), np.arange(6)))
    dense = multivariate_normal(cov=0.8**2 / (1 - 0.6**2) * 0.6**lag).logpdf(values)
    assert_allclose(ours, dense, rtol=0, atol=1e-9)
    assert_allclose(ours, -6.0510384427, rtol=0, atol=1e-10)


def test_two_unit_vectors_at_thirty_degrees(tmp_path: Path) -> None:
    """Ten rows beside them hold noise of mean square one over all twelve, so that a curve of 8 leaves 8 sin 30."""
    half = np.radians(30)
    first, second, noise = np.zeros(12), np.zeros(12), np.zeros(12)
    first[0], second[:2] = 1.0, (np.cos(half), np.sin(half))
    noise[2:] = np.sqrt(1.2) * np.resize([1, -1], 10)
    columns = {"first": first, "second": second, "reading": 8 * first + noise}
    asked = Asked(twist_model(), units=dict.fromkeys(columns, "-"))
    made = plain_competition(asked, asked.records(tmp_path, columns), 1.0)
    assert_allclose(seen_angle(made, "along_first", "along_second"), 30, rtol=1e-9)
    true, rival = fit_of(made, "along_first"), fit_of(made, "along_second")
    assert_allclose(size_of(true, "one"), 8, rtol=1e-6)
    assert_allclose(separation(true, rival, made.extended), 16, rtol=1e-6)
    assert_allclose(separation(true, true, made.extended), 0, rtol=0, atol=1e-9)


def test_a_rival_refits_within_its_bounds(tmp_path: Path) -> None:
    """It would need 10.4 of a curve at 30 degrees and has 9: what it leaves of 12 is 6 across and 1.39 along."""
    first, second, noise = np.zeros(12), np.zeros(12), np.zeros(12)
    first[0], second[:2] = 1.5, (np.sqrt(0.75), 0.5)
    noise[2:] = np.sqrt(1.2) * np.resize([1, -1], 10)
    columns = {"first": first, "second": second, "reading": 8 * first + noise}
    asked = Asked(twist_model(), units=dict.fromkeys(columns, "-"))
    made = plain_competition(asked, asked.records(tmp_path, columns), 1.0)
    true, rival = fit_of(made, "along_first"), fit_of(made, "along_second")
    assert_allclose(separation(true, rival, made.extended), 36 + (12 * np.sqrt(0.75) - 9) ** 2, rtol=1e-6)


@pytest.mark.parametrize(("tolerances", "angle"), [({}, 13.75), ({"zero": "1 m"}, 22.65)])
def test_a_warm_up_and_a_drift_are_fourteen_degrees_apart(
    tmp_path: Path, tolerances: dict[str, str], angle: float
) -> None:
    bench = warming()
    asked = Asked(drive_model(tolerances=tolerances))
    noise = of_size_one(np.random.default_rng(41), len(bench))
    made = plain_competition(asked, asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel) + noise)), UM)
    ours = seen_angle(made, "thermal_growth", "sensor_drift")
    free = np.column_stack([bench.temperature - 20, bench.time])
    free = free - free.mean(axis=0) if tolerances else free
    assert_allclose(ours, np.degrees(subspace_angles(free[:, :1], free[:, 1:])[0]), rtol=1e-6)
    assert_allclose(ours, angle, rtol=0, atol=0.005)


def test_growth_in_a_warm_up_is_visible_but_not_separable_from_a_drift(tmp_path: Path) -> None:
    bench = warming()
    asked = Asked(drive_model(tolerances={}))
    curve = 0.05 * (bench.temperature - 20)
    noise = of_size_one(np.random.default_rng(42), len(bench))
    columns = bench.columns(gauge(bench.load, bench.travel) + curve + noise)
    made = plain_competition(asked, asked.records(tmp_path, columns), UM)
    true = believed(made, "thermal_growth", 0.05 * UM)

    def left(*columns: Array) -> float:
        design = np.column_stack(columns)
        return float(np.sum((curve - design @ np.linalg.lstsq(design, curve)[0]) ** 2))

    cases = [
        (made.null, float(curve @ curve), 133.7),
        (fit_of(made, "sensor_drift"), left(bench.time), 7.55),
        (fit_of(made, "sensor_drift", "sensor_offset"), left(bench.time, bench.time**0), 2.35),
    ]
    found = [separation(true, rival, made.extended) for rival, _, _ in cases]
    for ours, (_, dense, known) in zip(found, cases, strict=True):
        assert_allclose(ours, dense, rtol=1e-5)
        assert_allclose(ours, known, rtol=0, atol=0.05 if known > 100 else 0.005)
    assert found[0] > 25 > 10 > found[1] > found[2]


def test_a_gain_and_a_loss_of_stiffness_are_three_degrees_apart(tmp_path: Path) -> None:
    load, travel = (each.ravel() for each in np.meshgrid(np.arange(-20.0, 21), np.arange(0.0, 301, 50)))
    bench = replace(wide(len(load)), load=load, travel=travel)
    asked = Asked(drive_model(tolerances={}))
    noise = of_size_one(np.random.default_rng(43), len(bench))
    made = plain_competition(asked, asked.records(tmp_path, bench.columns(gauge(load, travel) + noise)), UM)
    contact = np.sign(load) * np.abs(load) ** (2 / 3)
    linear = 0.5 * load * travel / STROKE
    dense = np.degrees(subspace_angles((3 * contact + linear)[:, None], (2 * contact + linear)[:, None])[0])
    ours = seen_angle(made, "sensor_gain", "stiffness_loss")
    assert_allclose(ours, dense, rtol=1e-3)
    assert_allclose(dense, 3.32, rtol=0, atol=0.005)
    said = [
        text for text in inseparable(chosen_as(made, made.null)) if {"sensor_gain", "stiffness_loss"} <= {*text.split()}
    ]
    assert len(said) == 1
    assert "(angle 3.3 degrees)" in said[0]


@pytest.mark.parametrize(("explanations", "limit"), [(12, 17.5), (78, 22.0), (200, 24.5)])
def test_how_visible_an_effect_must_be_after_a_search(explanations: int, limit: float) -> None:
    assert_allclose(needed(explanations), limit, rtol=0, atol=0.5)
