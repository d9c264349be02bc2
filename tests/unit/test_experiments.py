"""The experiment that tells explanations apart: what the machine can do, which run is best, and how surely."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Asked, chosen_as, drive_model, fit_of, wide
from numpy.testing import assert_allclose

from truing.diagnosis.choice import Chosen
from truing.diagnosis.result import Experiment
from truing.experiments.design import BUDGET, ENOUGH, MOST_READINGS
from truing.experiments.proposal import next_experiment
from truing.setup import DiagnoseOptions


def one_sign(folder: Path, box: dict[str, tuple[float, float]], noise: float, *, is_named: bool = False) -> Chosen:
    """A clearance of 3 um under a load of one sign: the offset is the same curve. The noise is square to both.

    ``is_named``: as another name for the winner; else as a rival.
    """
    bench = wide(40, seed=36)
    bench = replace(bench, load=np.abs(bench.load) + 1)
    asked = Asked(drive_model(("clearance",), {}), diagnose=DiagnoseOptions(box=box))
    columns = bench.shown(3 + noise * np.resize([1, -1], 40))
    made = asked.competing(folder, columns)
    best = fit_of(made, "sensor_offset")
    if is_named:
        return chosen_as(made, best, same={best.causes[0].tag: ("clearance",)})
    return chosen_as(made, best, fit_of(made, "clearance"))


def found(chosen: Chosen) -> Experiment:
    experiment, *_ = next_experiment(chosen)
    assert experiment is not None
    return experiment


@pytest.mark.parametrize("is_named", [True, False])
def test_the_separation_that_is_promised_is_that_of_a_refit_with_the_readings_added(
    tmp_path: Path, is_named: bool
) -> None:
    """40 readings of one sign of the load and some of the other: clearance turns round, an offset does not."""
    chosen = one_sign(tmp_path, {"load": (-10e3, 20e3)}, 1.0, is_named=is_named)
    experiment, points, tied = next_experiment(chosen)
    assert experiment is not None
    assert tied == []
    assert len(points) == experiment.readings <= BUDGET
    for count, point in enumerate(points, start=1):
        assert set(point.separates) == {"sensor_offset", "clearance"}
        assert -10e3 <= point.settings["load"].value < 0
        signs = np.array([1.0] * 40 + [-1.0] * count)
        offset = np.full(40 + count, 3.0)
        left = offset - signs * (signs @ offset) / (signs @ signs)
        assert_allclose(point.separation, left @ left, rtol=1e-4)
    assert_allclose(experiment.separation, points[-1].separation)


@pytest.mark.parametrize("is_named", [True, False])
def test_where_no_setting_separates_two_causes_none_is_proposed(tmp_path: Path, is_named: bool) -> None:
    chosen = one_sign(tmp_path, {"load": (1e3, 20e3)}, 1.0, is_named=is_named)
    assert next_experiment(chosen) == (None, [], [("sensor_offset", "clearance")])


def test_rivals_are_separated_inside_the_box(tmp_path: Path) -> None:
    bench = wide(80, seed=37)
    narrow = replace(bench, travel=140 + bench.travel / 15)
    asked = Asked(drive_model(("lead_error",), {}), diagnose=DiagnoseOptions(box={"travel": (0.0, 0.3)}))
    error = 0.01 * narrow.travel + np.random.default_rng(37).normal(0, 0.5, 80)
    made = asked.competing(tmp_path, narrow.shown(error))
    experiment = found(chosen_as(made, fit_of(made, "lead_error"), fit_of(made, "sensor_offset")))
    travel = experiment.settings["travel"]
    assert ((travel >= -1e-12) & (travel <= 0.3 + 1e-12)).all()
    assert ((travel < 0.14) | (travel > 0.16)).any()


@pytest.mark.parametrize("size", [3.0, 0.8, 0.3, 0.05])
def test_it_is_said_how_many_readings_would_be_needed(tmp_path: Path, size: float) -> None:
    """After 40 rows of one sign c rows of the other leave 4 * 40 c / (40 + c) of an offset as large as the noise."""
    experiment, points, tied = next_experiment(one_sign(tmp_path, {"load": (-10e3, 20e3)}, noise=3.0 / size))
    enough = [c for c in range(4, MOST_READINGS + 1) if 4 * size**2 * 40 * c / (40 + c) >= ENOUGH]
    if not enough:
        assert (experiment, points) == (None, [])
        assert tied
        return
    assert experiment is not None
    assert experiment.needed == enough[0]
    assert experiment.readings == min(enough[0], BUDGET)
    is_said = "readings like these would be needed" in points[-1].why
    assert is_said is (enough[0] > BUDGET)
