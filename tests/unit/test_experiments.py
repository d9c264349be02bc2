"""The experiment that tells explanations apart: what the machine can do, which run is best, and how surely."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Asked, Deflection, Drive, chosen_as, drive, drive_model, fit_of, wide
from diagnosis_samples import records_of
from numpy.testing import assert_allclose
from scipy.stats import binomtest
from scipy.stats import t as student_t

from truing import Condition, Effect, Float, Model, Unknown
from truing.diagnosis.choice import Chosen
from truing.diagnosis.machine import Calibration
from truing.diagnosis.records import Covariate, Records
from truing.diagnosis.result import Experiment
from truing.errors import DeclarationError, UsageError
from truing.experiments import BUDGET
from truing.experiments.chances import Simulation
from truing.experiments.design import ENOUGH, MOST_READINGS
from truing.experiments.facts import tie_of
from truing.experiments.planning import planned
from truing.experiments.proposal import among, designed_for, next_experiment, rival_fits
from truing.experiments.reach import Reach, ended_at, reach_of
from truing.measurements import RowsFile
from truing.setup import DiagnoseOptions, Setup, default_setup


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


@pytest.mark.parametrize("noise", [1.0, 4.0, 12.0])
def test_what_is_to_be_measured_instead_is_said_with_the_accuracy_that_decides(tmp_path: Path, noise: float) -> None:
    """3 um are known to t s / n^0.5 from n = 40 rows: what is left of them, to either side, is the accuracy needed.

    Where nothing is left no measurement decides, and none is proposed.
    """
    chosen = one_sign(tmp_path, {"load": (1e3, 20e3)}, noise)
    tie = tie_of(("sensor_offset", "clearance"), rival_fits(chosen), chosen.competition)
    known = float(student_t.ppf(0.975, 39)) * noise * np.sqrt(40 / 39) / np.sqrt(40)
    if known > 3:
        assert tie.facts == ()
        return
    assert [(fact.explanation, fact.quantity) for fact in tie.facts] == [
        ("sensor_offset", "sensor_offset.deflection"), ("clearance", "clearance.gap"),
    ]  # fmt: skip
    assert_allclose([fact.value.value for fact in tie.facts], 3e-6, rtol=1e-6)
    assert_allclose([fact.accuracy.value for fact in tie.facts], (3 - known) / 2 * 1e-6, rtol=0.02)


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
    least = [c for c in range(4, MOST_READINGS) if 4 * size**2 * 40 * c / (40 + c) >= ENOUGH]
    if not least:
        assert (experiment, points) == (None, [])
        assert tied
        return
    assert experiment is not None
    assert experiment.needed >= least[0]
    assert experiment.readings == min(experiment.needed, BUDGET)
    assert experiment.chance.value > (0.9 if experiment.needed <= BUDGET else 0.3)


# What a machine can do from where it stands


PRESS: dict[str, Any] = {
    "strokes": Condition("strokes", "", derived="since_start", low=0, high=1e5, rate="speed"),
    "hours": Condition("hours", "h", role="goes_on", low=0, high=50),
    "warmth": Condition("warmth", "degC", reference=20, low=10, high=60, role="follows"),
    "angle": Condition("angle", "deg"),
    "speed": Condition("speed", "rpm", low=5, high=60),
    "way": Condition("way", "", derived="direction of angle"),
}


def at_work() -> Reach:
    """What a record of four hours allows: it stands at 4 h, 2400 strokes and 30 hours, and has warmed up to 40 degC."""
    effects = [
        Effect(f"of_{name}", on_results=partial(more, name), needs=[need], unknowns=[Unknown("size", -1, 1)])
        for name, need in PRESS.items()
    ]
    model = Model(name="drive", title="", function=drive, errors=effects)
    hour = np.linspace(0, 4, 41)
    columns = {
        "time": 3600 * hour, "strokes": 600 * hour, "hours": 3600 * (26 + hour), "angle": 0.4 * np.sin(9 * hour),
        "warmth": 293.15 + 20 * (1 - np.exp(-hour)), "speed": np.full(41, 10 / 60) + 0.01 * hour,
        "way": np.sign(np.cos(9 * hour)), "load": 1e3 * np.cos(hour),
    }  # fmt: skip
    setup = default_setup(model)
    units = {"time": "h", "load": "kN"}
    covariates = {
        name: Covariate(name, values, units.get(name, ""), "time" if name == "time" else "condition")
        for name, values in columns.items()
    }
    zeros = np.zeros(41, dtype=np.intp)
    rows = RowsFile("", columns, {}, {}, tuple(range(41)))
    records = Records(
        files=("a",), rows=rows, file_of=zeros, run_of=zeros, lines=zeros, measured={}, sigma={},
        covariates=covariates, held_out=zeros.astype(bool),
    )  # fmt: skip
    return reach_of(Calibration(setup, setup, records, {}, (), {}))


def more(name: str, screw: Drive, base: Deflection, *, size: Float, **seen: Float) -> Deflection:
    return replace(base, deflection=base.deflection + size * seen[name])


def test_histories_go_on_and_sums_agree() -> None:
    """Whatever course every quantity takes: time and hours together, strokes as the speed times the time."""
    reach = at_work()
    rng = np.random.default_rng(3)
    choices = {quantity.name: quantity.courses(12) for quantity in reach.quantities}
    for _ in range(40):
        drawn = {name: courses[int(rng.integers(len(courses)))] for name, courses in choices.items()}
        made = reach.columns([drawn], 12)
        assert (np.diff(made["time"]) > 0).all()
        assert made["time"][0] > 4 * 3600
        assert_allclose(made["hours"], 30 * 3600 + made["time"] - 4 * 3600)
        turned = 2400 + np.cumsum([0, *np.diff(made["time"]) * (made["speed"][1:] + made["speed"][:-1]) / 2])
        assert_allclose(made["strokes"], turned + made["speed"][0] * (made["time"][0] - 4 * 3600))
        assert np.ptp(made["angle"]) <= 2 * np.pi + 1e-9
        assert 283.15 - 1e-9 <= made["warmth"].min() <= made["warmth"].max() <= 333.15 + 1e-9
        pace = 20 * (1 - np.exp(-1)) / 3600  # K/s, in the first hour, the fastest quarter of the record
        assert np.abs(np.diff(made["warmth"]) / np.diff(made["time"])).max() <= 1.01 * pace
        assert set(np.unique(made["way"])) <= {-1.0, 0.0, 1.0}
        moved = np.diff(made["angle"])
        assert_allclose(made["way"][1:][moved != 0], np.sign(moved[moved != 0]))


def test_what_follows_begins_where_the_record_ended_or_at_an_end_of_its_range() -> None:
    """After 4 h the warmth is 20 + 20 (1 - e^-4) = 39.634 degC: it is held there, or goes up or down."""
    warmth = next(each for each in at_work().quantities if each.name == "warmth")
    courses = warmth.courses(12)
    ended = 273.15 + 39.634
    assert (courses[0].way, courses[0].start) == ("held", pytest.approx(ended, abs=1e-3))
    assert {round(course.start, 2) for course in courses} == {283.15, round(ended, 2), 333.15}
    from_there = [course.end for course in courses if course.way == "ramp" and abs(course.start - ended) < 1e-3]
    assert sorted(np.sign(np.subtract(from_there, ended))) == [-1, 1]


def test_a_quantity_ended_where_its_last_run_did() -> None:
    """After 2 h of the last of three runs it is 20 + 25 (1 - e^-1.44) degC, in whatever order the rows stand."""
    records = records_of()
    ended = 293.15 + 25 * (1 - np.exp(-7200 / 5000))
    assert ended < records.covariates["rod_temperature"].values.max() - 4
    shuffled = records.part(np.append(np.arange(120), 120 + np.random.default_rng(1).permutation(40)))
    assert [ended_at(each, "rod_temperature") for each in (records, shuffled)] == pytest.approx([ended, ended])


def test_what_is_at_its_end_goes_no_farther() -> None:
    """Hours may go to 50 and stand at 30, so that no record takes more than 20 h."""
    longest = max(course.end for course in at_work().quantities[0].courses(12))
    assert at_work().quantities[0].name == "time"
    assert longest <= (4 + 20) * 3600


@pytest.mark.parametrize(
    ("stated", "sentence"),
    [
        ({"role": "sets"}, "has the role 'sets'; the roles are set, goes_on, follows. Did you mean 'set'?"),
        ({"role": "set", "derived": "since_start"}, "is derived by 'since_start', so it cannot be set"),
        ({"role": "follows", "rate": "speed"}, "has the rate 'speed', but it does not go on"),
    ],
)  # fmt: skip
def test_a_role_that_cannot_be_is_refused(stated: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError, match=re.escape(sentence)):
        Condition("wear", "", **stated)


def test_a_rate_and_the_role_of_an_input_are_checked_when_the_model_is_made() -> None:
    effect = Effect(
        "wear", on_results=partial(more, "wear"), unknowns=[Unknown("size", -1, 1)],
        needs=[Condition("wear", "", rate="lod")],
    )  # fmt: skip
    with pytest.raises(DeclarationError, match=r"rate 'lod', which is no input or condition. Did you mean 'load'\?"):
        Model(name="drive", title="", function=drive, errors=[effect])


# The chance that is claimed, held against experiments simulated by plain least squares


def test_the_claimed_chance_holds_on_fresh_simulations(tmp_path: Path) -> None:
    """A clearance and an offset at noise 1.2 times as large as they are: 200 experiments made and judged by hand."""
    chosen = one_sign(tmp_path, {"load": (-10e3, 20e3)}, noise=1.2 * 3)
    experiment = found(chosen)
    rng, count, right = np.random.default_rng(9), experiment.readings, 0
    signs = np.append(np.ones(40), np.sign(experiment.settings["load"]))
    old = 3 + 1.2 * 3 * np.resize([1, -1], 40)
    for draw in range(200):
        true, rival = (np.ones(40 + count), signs) if draw % 2 else (signs, np.ones(40 + count))
        size = rng.normal(3, 3.6 / np.sqrt(40))
        readings = np.append(old, true[40:] * size + rng.normal(0, 3.6, count))
        losses = []
        for curve in (true, rival):
            left = readings - curve * max((curve @ readings) / (curve @ curve), 0.0 if curve is signs else -np.inf)
            losses.append(left**2 / np.mean(left**2) + np.log(np.mean(left**2)))
        apart = losses[1] - losses[0]
        right += np.sum(apart) >= max(6.0, np.sqrt(6) / 2 * np.sqrt(40 + count) * np.std(apart))
    low, high = binomtest(right, 200).proportion_ci(0.95, method="wilson")
    assert experiment.chance.value > 0.3
    assert low <= experiment.chance.high
    assert high >= experiment.chance.low


@pytest.mark.parametrize("is_long", [False, True], ids=["by fits", "by derivatives"])
def test_whether_a_chance_is_reached_is_decided_as_by_all_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_long: bool
) -> None:
    if is_long:
        monkeypatch.setattr("truing.experiments.chances.LONG", 0)
    chosen = one_sign(tmp_path, {"load": (-10e3, 20e3)}, noise=1.2 * 3)
    stand, best = designed_for(chosen)
    assert stand is not None
    assert best is not None
    machine = stand.machine_of([best.courses], best.readings)
    apart = among(stand, {frozenset(pair) for pair in best.pairs})
    simulation = Simulation(chosen.competition, stand.several, apart, machine, has_record=True)
    value = simulation.chance(1).value
    assert 0 < value < 1
    decided = [simulation.reaches(value + more, 1) for more in (-0.5, -0.005, 0.0, 0.005, 0.5)]
    assert decided == [True, True, True, False, False]


# An experiment before any data


def planning(noise: float, **options: Any) -> Setup:
    conditions = ("thermal_growth", "lead_error", "clearance", "wear")
    box = {"load": (-10e3, 10e3), "travel": (0.0, 0.3), "time": (0.0, 36e3), **options}
    asked = DiagnoseOptions(box=box, noise={"deflection": noise} if noise else {})
    return replace(default_setup(drive_model(conditions)), diagnose=asked)


def test_a_plan_varies_what_tells_the_causes_apart() -> None:
    plan = planned(planning(1e-6), ["clearance", "sensor_offset"])
    assert plan.experiment is not None
    load = plan.experiment.settings["load"]
    assert load.min() < 0 < load.max()  # a clearance turns round with the load, an offset does not
    assert plan.experiment.chance.value > 0.9
    assert 8 <= plan.experiment.readings <= 12
    assert_allclose(plan.experiment.sizes["clearance.gap"].value, 5e-6, rtol=0.3)  # five standard deviations


def test_causes_of_one_curve_are_not_told_apart() -> None:
    one_way = {"load": (1e3, 10e3)}
    assert planned(planning(1e-6, **one_way), ["clearance", "sensor_offset"]).experiment is None


@pytest.mark.parametrize(
    ("causes", "noise", "budget", "sentence"),
    [
        (["clearence", "wear"], 1e-6, 12, "has no effect 'clearence', and no tolerance of it as input:NAME. Did you"),
        (["clearance"], 1e-6, 12, "an experiment tells two causes or more apart"),
        (["clearance", "wear"], 1e-6, 1, "a budget of 1 readings tells nothing apart; allow 2"),
        (["clearance", "wear"], 0.0, 12, "no noise is known: state the standard deviation of one reading"),
        (["clearance", "wear"], 1.0, 12, "'clearance' cannot be seen in deflection: at its bounds it moves no reading"),
        (["warm_up", "wear"], 1e-6, 12, "drive has no effect 'warm_up'"),
        (["sensor_offset", "periodic_order"], 1e-6, 12, "nothing says where 'angle' can be measured"),
    ],
)  # fmt: skip
def test_what_cannot_be_planned_is_said_in_a_sentence(
    causes: list[str], noise: float, budget: int, sentence: str
) -> None:
    with pytest.raises(UsageError, match=re.escape(sentence)):
        planned(planning(noise), causes, budget=budget)
