"""Surrogates: the textbook's formulas, honest bands, boxes with formulas, times that stay out of results.json."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator
from study_models import CHAIN, ROOT, WEAR, Sum, Three, setup_of
from test_studies_allocation import GROWING, allotted
from threadpoolctl import threadpool_info, threadpool_limits

from truing import Emulated, Model, Surrogate, Table
from truing.calculation import calculate
from truing.errors import UsageError
from truing.executors import SerialExecutor, WorkerPool
from truing.inputs_file.study_options import study_section
from truing.inputs_file.values import FileEntry, InputsRead
from truing.setup import Setup, SwitchedOn
from truing.studies.surrogate import Speed, designed, open_box


def hill(three: Three) -> Sum:
    """A smooth function of two numbers, bent differently in each; the third does nothing."""
    return Sum(total=np.exp(-three.x1) * np.sin(3.0 * three.x2) + 2.0 * three.x2)


HILL = Model(name="hill", title="Hill", function=hill)
BOX = {"x1": "0..2", "x2": "-1..1"}
STUDY = Surrogate(of="total", over=BOX, design=60, held_out=200, compare=0)
QUICK = replace(STUDY, design=20, held_out=10)


def emulated(model: Model[Any, Any], study: Surrogate, **changes: Any) -> Emulated:
    found = calculate(replace(setup_of(model), studies=(study,), **changes)).outcomes[study.name]
    assert isinstance(found, Emulated)
    return found


@pytest.fixture(scope="module")
def found() -> Emulated:
    return emulated(HILL, STUDY)


def exact(x1: Any, x2: Any) -> Any:
    return np.exp(-x1) * np.sin(3.0 * x2) + 2.0 * x2


def learnt(setup: Setup) -> tuple[Any, Any]:
    """The designed points as places between 0 and 1, and the function there."""
    columns = designed(setup, open_box(setup, BOX, (), "surrogate"), 0, STUDY.design, "surrogate")
    places = np.column_stack([columns["x1"] / 2.0, (columns["x2"] + 1.0) / 2.0])
    return places, exact(columns["x1"], columns["x2"])


def test_mean_and_band_are_those_of_the_textbook(found: Emulated) -> None:
    """The joint normal of Rasmussen and Williams, equations 2.25 and 2.26, written out here."""
    places, values = learnt(setup_of(HILL))
    process = found.stand_in.processes["total"]
    amplitude = process.kernel_.k1.k1.constant_value
    lengths, noise = process.kernel_.k1.k2.length_scale, process.kernel_.k2.noise_level
    centre, scale = values.mean(), values.std()

    def covariance(one: Any, other: Any) -> Any:
        apart = (one[:, None, :] - other[None, :, :]) / lengths
        return amplitude * np.exp(-0.5 * (apart**2).sum(axis=2))

    asked = np.array([[0.13, 0.77], [0.5, 0.5], [0.95, 0.02], [1.2, 0.5]])
    whole = covariance(places, places) + (noise + 1e-12) * np.eye(len(places))
    between = covariance(asked, places)
    mean = centre + scale * between @ np.linalg.solve(whole, (values - centre) / scale)
    variance = amplitude + noise - np.einsum("ij,ji->i", between, np.linalg.solve(whole, between.T))
    half = 1.959963984540054 * scale * np.sqrt(variance)
    columns = {"x1": 2.0 * asked[:, 0], "x2": 2.0 * asked[:, 1] - 1.0}
    assert found.predict(columns)["total"] == pytest.approx(mean, rel=1e-6, abs=1e-7)
    low, high = found.predict_band(columns)["total"]
    assert (high - low) / 2 == pytest.approx(half, rel=0.02, abs=1e-6)


def test_a_known_function_is_reproduced(found: Emulated) -> None:
    """Better all over the box than another program, scipy's cubic splines through the same points."""
    x1, x2 = (axis.ravel() for axis in np.meshgrid(np.linspace(0.0, 2.0, 25), np.linspace(-1.0, 1.0, 25)))
    splines = RBFInterpolator(*learnt(setup_of(HILL)), kernel="cubic")
    reached = np.abs(splines(np.column_stack([x1 / 2.0, (x2 + 1.0) / 2.0])) - exact(x1, x2))
    off = np.abs(found.predict({"x1": x1, "x2": x2})["total"] - exact(x1, x2))
    assert off.max() < 0.5 * reached.max()
    assert np.median(off) < 0.1 * np.median(reached)


def test_what_is_said_of_errors_and_bands_holds_at_points_held_out(found: Emulated) -> None:
    columns = designed(setup_of(HILL), open_box(setup_of(HILL), BOX, (), "surrogate"), 1, 200, "surrogate")
    wanted = exact(columns["x1"], columns["x2"])
    off = np.abs(found.predict(columns)["total"] - wanted)
    said = found.as_json()["results"]["total"]
    assert said["median_error"] == pytest.approx(np.median(off), rel=1e-6)
    assert said["largest_error"] == pytest.approx(off.max(), rel=1e-6)
    assert said["largest_share"] == pytest.approx(off.max() / np.ptp(wanted), rel=1e-6)
    low, high = found.predict_band(columns)["total"]
    assert said["coverage95"] == found.judged["total"].coverage == ((low <= wanted) & (wanted <= high)).mean()
    assert found.judged["total"].points == 200
    assert 0.85 <= said["coverage95"] <= 1.0
    assert not found.warnings()


def test_outside_its_box_and_for_other_values_it_does_not_stand(found: Emulated) -> None:
    assert found.passed == ()
    outside = emulated(HILL, replace(QUICK, over={"x1": "1..2", "x2": "-1..1"}))
    assert outside.passed == ("x1",)
    assert "outside the box of the surrogate in 'x1'" in outside.warnings()[0]
    assert outside.as_json()["extrapolated"] == ["x1"]
    assert list(found.extrapolated({"x1": np.array([-0.1, 0.0, 2.0, 2.1]), "x2": 0.5})) == [True, False, False, True]
    low, high = found.predict_band({"x1": np.array([1.0, 2.5, 3.0, 4.0, 6.0]), "x2": 0.0})["total"]
    assert (np.diff(high - low) > 0).all()
    assert (high - low)[1] > 3 * (high - low)[0]
    assert found.predict({"x3": 0.0})["total"] == pytest.approx([0.0], abs=1e-3)
    with pytest.raises(UsageError, match="made for one value of 'x3'"):
        found.predict({"x3": 1.0})
    with pytest.raises(UsageError, match="knows no 'x4'"):
        found.predict({"x4": 1.0})


def test_a_power_law_is_straight_in_its_logarithms() -> None:
    """Depth is 2 * rate * time: with logarithms two planes, so hardly anything is left to learn."""
    over = {"rate": "0.5..8 um/h", "working_time": "1..100 h"}
    study = Surrogate(of="depth", over=over, logarithmic=tuple(over), log_result=True, design=30, compare=0)
    found = emulated(WEAR, study)
    rate, hours = np.array([0.7, 2.0, 7.0]), np.array([90.0, 10.0, 1.5])
    said = found.predict({"rate": rate * 1e-6 / 3600, "working_time": hours * 3600})["depth"]
    assert 1e6 * said == pytest.approx(2 * rate * hours, rel=1e-4)
    time = {"working_time": np.array([0.0, 3600.0])}  # 0 has no logarithm
    assert list(found.extrapolated(time)) == list(np.isnan(found.predict(time)["depth"])) == [True, False]
    assert found.judged["depth"].is_share
    document = found.as_json()
    assert document["results"]["depth"]["at_inputs"]["model"] == pytest.approx(40)
    assert document["results"]["depth"]["at_inputs"]["predicted"] == pytest.approx(40, rel=1e-4)
    assert document["box"]["rate"] == {
        "low": pytest.approx(0.5), "high": pytest.approx(8), "unit": "um/h", "logarithmic": True, "sets": "rate"
    }  # fmt: skip


def test_the_difference_of_two_inputs_is_a_direction() -> None:
    """first 20 to 40 mm, first - third -2 to 3 mm: third follows, and only the difference reaches the gap."""
    over = {"first": "20..40 mm", "first - third": "-2..3 mm"}
    setup = setup_of(CHAIN)
    columns = designed(setup, open_box(setup, over, (), "s"), 0, 500, "s")
    assert set(columns) == {"first", "third"}
    apart = 1e3 * (columns["first"] - columns["third"])
    assert -2 <= apart.min() < -1.98
    assert 2.98 < apart.max() <= 3
    assert abs(np.corrcoef(apart, columns["first"])[0, 1]) < 0.1
    assert np.histogram(apart, bins=500, range=(-2, 3))[0].max() == 1  # one point in every layer
    found = emulated(CHAIN, Surrogate(of="gap", over=over, design=30, compare=0))
    said = found.predict({"first": 0.03, "third": np.array([0.0275, 0.031])})["gap"]
    assert 1e3 * said == pytest.approx([22.5, 19.0], abs=1e-3)
    assert list(found.extrapolated({"first": 0.03, "third": np.array([0.0269, 0.0271, 0.0319, 0.0321])})) == [
        True, False, False, True
    ]  # fmt: skip
    assert found.as_json()["box"]["first - third"]["sets"] == "third"


def test_points_without_an_answer_are_left_out_and_counted() -> None:
    """A quarter of -1 to 3 m^2 has no root: 20 of 80 layers of the Latin hypercube."""
    found = emulated(ROOT, Surrogate(of="side", over={"square": "-1..3 m^2"}, design=80, held_out=40, compare=0))
    assert (found.sample.points, found.sample.left_out) == (80, 20)
    assert (found.judges.points, found.judges.left_out) == (40, 10)
    assert found.judged["side"].points == 30
    assert "20 of 80 designed points were left out (no square has a negative area)" in found.warnings()[0]
    with pytest.raises(UsageError, match=r"only \d of 20 points have an answer .*negative area"):
        emulated(ROOT, Surrogate(of="side", over={"square": "-9..1 m^2"}, design=20, compare=0))


def test_a_band_that_holds_too_little_is_a_warning(found: Emulated) -> None:
    """170 of 200 are 0.850 with an interval up to 0.893; 186 of 200 are 0.930 and up to 0.958."""
    judged = found.judged["total"]
    for inside, warned in ((170, True), (186, False)):
        high = np.where(np.arange(200) < inside, np.inf, judged.simulated - 1.0)
        low = np.full(200, -np.inf)
        words = replace(found, judged={"total": replace(judged, low=low, high=high)}).warnings()
        assert any(f"only {inside} of 200" in text for text in words) == warned


def test_the_same_seed_gives_the_same_numbers_wherever_it_is_computed(two_processes: WorkerPool) -> None:
    over = {"rate": "0.5..8 um/h", "working_time": "1..100 h"}
    study = Surrogate(of="depth", over=over, design=40, batch=16, compare=0)
    setup = replace(setup_of(WEAR), studies=(study,))
    one, same, other = (
        json.dumps(calculate(asked, executor=place).outcomes["surrogate"].as_json())
        for asked, place in (
            (setup, SerialExecutor()), (setup, two_processes), (replace(setup, seed=1), SerialExecutor()),
        )
    )  # fmt: skip
    assert one == same != other


def test_the_number_of_threads_changes_nothing() -> None:
    """Linear algebra of a surrogate and of widths that are bought, to the last digit."""
    said = []
    for threads in (1, 2):
        with threadpool_limits(threads, user_api="blas"):
            assert {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"} == {threads}
            said.append(json.dumps([emulated(HILL, QUICK).as_json(), allotted(GROWING, draws=10).as_json()]))
    assert said[0] == said[1]
    assert json.loads(said[0])[1]["reached"]


def test_times_are_on_the_sheet_and_in_no_results() -> None:
    found = emulated(HILL, replace(QUICK, compare=3000))
    speed = found.speed
    assert speed is not None
    assert speed.rows == speed.measured == 3000
    assert min(speed.sample, speed.fit, speed.predictions, speed.model) > 0
    assert found.as_json() == replace(found, speed=None).as_json()
    assert list(found.warnings()) == list(replace(found, speed=None).warnings())
    tables = [block for block in found.blocks() if isinstance(block, Table)]
    clock = next(table for table in tables if table.title.startswith("Surrogate or model"))
    assert [row[1] for row in clock.rows] == [speed.sample, speed.fit, speed.predictions, speed.model]


def test_break_even_is_where_both_take_equally_long() -> None:
    """Making 3 s; 1000 answers: per answer the surrogate saves 8 ms, 3 ms or nothing."""
    for model, break_even, pays in ((10.0, 375.0, True), (5.0, 1000.0, False), (2.0, float("inf"), False)):
        speed = Speed(rows=1000, sample=1.0, fit=2.0, predictions=2.0, model=model, measured=1000)
        assert (speed.break_even, speed.pays) == (pytest.approx(break_even), pays)


def test_several_results_and_a_figure_along_one_input() -> None:
    over = {"first": "20..40 mm", "third": "30..50 mm"}
    found = emulated(CHAIN, Surrogate(of=("gap", "twice"), over=over, design=30, along="third", compare=100))
    assert found.of == ("gap", "twice")
    course = found.as_json()["course"]
    assert course["over"] == "third"
    assert course["results"]["gap"]["model"] == pytest.approx([50.0 - third for third in course["at"]], abs=1e-9)
    assert course["results"]["twice"]["predicted"] == pytest.approx(
        [2 * (50.0 - third) for third in course["at"]], abs=1e-2
    )
    drawings = [block.draw() for block in found.blocks() if hasattr(block, "draw")]
    assert [len(figure.axes) for figure in drawings] == [4, 2]
    json.dumps(found.as_json(), allow_nan=False)


def test_a_condition_is_a_direction_and_effects_act() -> None:
    """Lengths of 30 + 20 - 40 mm grow by 1e-3 per kelvin, so the gap of 10 mm does."""
    on = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-3})
    study = Surrogate(of="gap", over={"warmth": "0..60 degC"}, design=15, compare=0)
    found = emulated(CHAIN, study, effects=(on,))
    kelvin = 273.15 + np.array([10.0, 20.0, 50.0])
    assert 1e3 * found.predict({"warmth": kelvin})["gap"] == pytest.approx([9.9, 10.0, 10.3], rel=1e-5)
    assert found.as_json()["box"]["warmth"]["low"] == pytest.approx(0.0)
    assert found.as_json()["course"]["at"][-1] == pytest.approx(60.0)


def test_what_depends_on_nothing_is_learnt_as_a_constant() -> None:
    found = emulated(CHAIN, Surrogate(of="gap", over={"gap_limit": "0.1..1 mm"}, design=10, compare=0))
    assert 1e3 * found.predict({"gap_limit": 5e-4})["gap"] == pytest.approx([10.0], rel=1e-9)
    assert found.as_json()["results"]["gap"]["largest_share"] == pytest.approx(0.0, abs=1e-9)
    assert all(block.draw() for block in found.blocks() if hasattr(block, "draw"))


def test_ranges_can_stand_in_a_file() -> None:
    entry = study_section(STUDY).entries["over"]
    assert isinstance(entry, FileEntry)
    assert entry.read({"x1": "0..1"}, InputsRead(Path())) == {"x1": "0..1"}
    with pytest.raises(ValueError, match="over = 3"):
        entry.read(3, InputsRead(Path()))


RATE = {"rate": "1..2 um/h"}


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"of": ()}, "results to learn"),
        ({"over": {}}, "ranges to learn"),
        ({"design": 3}, "design = 3 is too few for 1 directions"),
        ({"design": 3001}, "more than 3000 points takes too long"),
        ({"held_out": 3}, "at least 10 points"),
        ({"restarts": -1}, "not negative"),
        ({"batch": 0}, "at least 1"),
        ({"of": "detph"}, "Did you mean 'depth'"),
        ({"of": "course"}, "runs along an axis"),
        ({"along": "load"}, "no input in over"),
        ({"logarithmic": ("load",)}, "not in over"),
        ({"over": {"rate": "0..2 um/h"}, "logarithmic": ("rate",)}, "must lie above 0"),
        ({"over": {"stages": "1..5"}}, "'stages' is no number among the inputs"),
        ({"over": {"raet": "1..2 um/h"}}, "Did you mean 'rate'"),
        *(({"over": {"rate": at}}, "is no range") for at in ("1 um/h", "1..2..3 um/h")),
        ({"over": {"rate": "2..1 um/h"}}, "must rise"),
        ({"over": {"rate": "1..2 kg"}}, "speed"),
        ({"over": {**RATE, "load - working_time": "1..2 N"}}, "one input must be left to follow"),
        ({"over": {**RATE, "rate * 2": "1..2 um/h"}}, "it is none"),
        ({"over": {**RATE, "rate * load": "1..2 kg"}}, "another dimension"),
        ({"over": {**RATE, "rate + load": "1..2 um/h"}}, "does not go with"),
        ({"over": {**RATE, "rate * load * load": "1..900 um/h*N^2"}}, "is not straight in 'load'"),
        ({"over": {"1 + ": "1..2 mm"}}, "formula"),
    ],
)
def test_what_cannot_be_learnt_is_one_sentence(options: dict[str, Any], sentence: str) -> None:
    words: dict[str, Any] = {"of": "depth", "over": RATE, "compare": 0, **options}
    with pytest.raises(UsageError, match=sentence) as caught:
        emulated(WEAR, Surrogate(**words))
    assert "\n" not in str(caught.value)
