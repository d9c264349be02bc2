"""Models that are hard to ask: slow, failing, rough."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Array, names_in
from hard_models import (
    EFFECTS,
    NOISE,
    ROWS,
    Beam,
    Shop,
    asked,
    hardened,
    leaning,
    leaning_with_play,
    of_causes,
    record,
)

from truing import Effect, Float, Unknown, feasible
from truing.diagnosis import extended
from truing.diagnosis.engine import diagnose
from truing.diagnosis.extended import CallBudget, Extended, budget_of, step_of
from truing.diagnosis.machine import calibration_of
from truing.runs.diagnosis_document import diagnosis_document

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")

# A model that takes long


@pytest.mark.parametrize(
    ("seconds", "effects", "calls", "takes"),
    [
        (0.001, 5, np.inf, 0.0),
        (0.029, 5, np.inf, 0.0),
        (0.05, 5, 3000, 0.1),
        (0.9, 5, 300, 1.0),
        (1.2, 5, 300, 1.0),  # another machine, the same search
        (1.2, 40, 1600, 1.0),
        (9.0, 5, 200, 10.0),
    ],
)
def test_how_long_a_call_takes_says_how_many_there_are(
    monkeypatch: pytest.MonkeyPatch, seconds: float, effects: int, calls: float, takes: float
) -> None:
    """Five minutes by the nearest power of ten, and forty calls for every effect at least."""
    shop = Shop(seconds)
    monkeypatch.setattr(extended, "perf_counter", shop.clock)
    given_ = budget_of(0, effects, lambda: shop.function(1)(Beam()))
    assert (given_.calls, given_.takes) == (calls, takes)
    assert budget_of(77, effects, lambda: pytest.fail("it is not timed")).calls == 77


def test_a_budget_counts_what_it_leaves_out(tmp_path: Path) -> None:
    few = asked(Shop(), rows=20)
    extended = Extended(calibration_of(few.setup, few.records(tmp_path, record(leaning, rows=20))))
    extended.budget, allowed = CallBudget(100, 1.0, share=0.5), []
    for extended.calls in (0, 49, 50, 51):
        allowed.append(extended.allows("pairs"))
    assert allowed == [True, True, False, False]
    assert extended.budget.told() == (
        "the search ended after 100 calls of the model, of which one takes about 1 s, and left out: pairs (2); another "
        "explanation may lie there; look further with [studies.diagnose] budget = 400",
    )
    assert CallBudget(100).told() == ()


def test_a_model_of_a_second_a_call_is_diagnosed_in_minutes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two causes that mask one another would take three quarters of an hour; what was left out is said."""
    shop = Shop(1.0)
    monkeypatch.setattr(extended, "perf_counter", shop.clock)
    records = asked(shop).records(tmp_path, record(leaning_with_play))
    shop.time = 0.0
    answer = diagnose(asked(shop).setup, records)
    assert shop.time < 15 * 60
    assert {"leans", "plays"} <= names_in(answer)
    assert not answer.unique
    (said,) = answer.hindrances
    assert said.startswith(
        "the search ended after 300 calls of the model, of which one takes about 1 s, and left out: "
    )
    assert said in answer.warnings
    assert said in diagnosis_document(answer)["warnings"]


def test_with_calls_enough_the_same_model_is_named_plainly(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shop = Shop(1.0)
    monkeypatch.setattr(extended, "perf_counter", shop.clock)
    few = asked(shop).diagnosed(tmp_path, record(leaning))
    assert (few.verdict, [cause.effect for cause in few.causes]) == ("undecided", ["leans"])
    many = asked(shop, calls=20_000).diagnosed(tmp_path, record(leaning))
    assert (many.verdict, many.hindrances) == ("named", ())
    assert of_causes(many)["leans.slant"] == pytest.approx(40e-6, abs=5 * NOISE * 1e-6 * np.sqrt(12 / ROWS))


def test_a_stated_budget_gives_one_answer_however_slow_the_machine_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = []
    for seconds in (0.0, 30.0):
        shop = Shop(seconds)
        monkeypatch.setattr(extended, "perf_counter", shop.clock)
        answers.append(diagnosis_document(asked(shop, calls=250).diagnosed(tmp_path, record(leaning))))
    assert answers[0] == answers[1]
    assert "the search ended after 250 calls of the model and left out: " in " ".join(answers[0]["warnings"])


def test_what_is_not_looked_at_is_named_and_not_called_idle(tmp_path: Path) -> None:
    answer = asked(Shop(), calls=24).diagnosed(tmp_path, record(leaning))
    (said,) = answer.hindrances
    assert "left out: any look at plays, softens, hardens, " in said
    assert answer.verdict == "undecided"
    assert not {"plays", "softens", "hardens"} & set(diagnosis_document(answer)["not_excited"])


def test_nothing_wrong_is_not_said_after_a_search_that_ended_early(tmp_path: Path) -> None:
    nothing = record(lambda at: 0.0)
    assert asked(Shop()).diagnosed(tmp_path, nothing).verdict == "none"
    answer = asked(Shop(), calls=20).diagnosed(tmp_path, nothing)
    assert answer.verdict == "undecided"
    assert answer.hindrances[0] in diagnosis_document(answer)["undecided"]


def test_the_calls_that_are_counted_are_those_of_the_model(tmp_path: Path) -> None:
    """What follows the search (sizes, folds, the next measurement) takes a few hundred at most."""
    calls = 400
    shop = Shop()
    records = asked(shop).records(tmp_path, record(leaning_with_play))
    shop.calls = 0
    diagnose(asked(shop, calls=calls).setup, records)
    assert 0.5 * calls < shop.calls < calls + 400


# A model that fails at some points


def snaps(it: Beam, *, slant: Float) -> Beam:
    """No number beyond 50 um."""
    return replace(it, slant=it.slant + np.where(np.asarray(slant) > 50e-6, np.nan, slant))


def refuses(it: Beam, *, slant: Float) -> Beam:
    feasible(np.asarray(slant) <= 50e-6, "the beam slides off")
    return replace(it, slant=it.slant + slant)


def breaks(it: Beam, *, slant: Float) -> Beam:
    if np.any(np.asarray(slant) > 50e-6):
        raise ValueError("no such beam")
    return replace(it, slant=it.slant + slant)


def is_wrong(it: Beam, *, slant: Float) -> Beam:
    raise ZeroDivisionError("whatever the slant")


def failing(function: Any) -> Effect[Any, Any]:
    return Effect(function.__name__, on_inputs=function, unknowns=[Unknown("slant", 0, 200, "um")])


@pytest.mark.parametrize(
    ("function", "error"), [(snaps, leaning), (refuses, lambda at: 30 * np.sign(at["load"])), (breaks, leaning)]
)
def test_points_at_which_the_model_fails_are_lost_by_name_and_share(
    tmp_path: Path, function: Any, error: Callable[[Mapping[str, Array]], Array]
) -> None:
    """Of 200 um and 1, 0.3, 0.1 ... 0.001 of it, seven sizes, the first two are beyond 50 um."""
    answer = asked(Shop(), [*EFFECTS[1:3], failing(function)]).diagnosed(tmp_path, record(error))
    name = function.__name__ if error is leaning else "plays"
    assert [cause.effect for cause in answer.causes] == [name]
    assert answer.verdict == "named"
    (said,) = [note for note in answer.records.notes if note.startswith("the model fails with")]
    assert said.startswith(f"the model fails with {function.__name__} at 29 % of the points tried (2 of 7)")


def test_an_effect_whose_code_always_breaks_is_left_out_with_its_reason(tmp_path: Path) -> None:
    answer = asked(Shop(), [*EFFECTS[:2], failing(is_wrong)]).diagnosed(tmp_path, record(leaning))
    assert [cause.effect for cause in answer.causes] == ["leans"]
    why = diagnosis_document(answer)["not_fitted"]["is_wrong"]
    assert why.startswith("the model fails with it: ")
    assert why.endswith("ZeroDivisionError: whatever the slant")
    assert any("fails with is_wrong at 100 %" in note for note in answer.records.notes)


# A model that is rough


def test_the_step_of_rounded_numbers() -> None:
    values = np.random.default_rng(0).normal(size=50)
    assert step_of(np.round(values / 0.03) * 0.03) == pytest.approx(0.03, rel=1e-9)
    assert step_of(values) == 0.0
    assert step_of(np.array([1.0, 2.0, 3.0])) == 0.0  # too few to tell


def rounded(step: float) -> Shop:
    return Shop(rough=lambda bend: np.round(bend / step) * step)


def scattering(sd: float) -> Shop:
    rng = np.random.default_rng(3)
    return Shop(rough=lambda bend: bend + rng.normal(0, sd, np.shape(bend)))


def test_a_model_with_noise_of_its_own_has_the_causes_that_are_there(tmp_path: Path) -> None:
    """Up to a fifth of that of the readings; sizes within five standard errors of a rows-wide mean."""
    answer = asked(scattering(1e-6)).diagnosed(tmp_path, record(leaning_with_play))
    sizes = of_causes(answer)
    assert {"leans.slant", "plays.play"} <= set(sizes)
    assert sizes["plays.play"] == pytest.approx(30e-6, abs=5e-6)
    assert sizes["leans.slant"] == pytest.approx(40e-6, abs=8e-6)
    assert any("by itself by up to" in note for note in answer.records.notes)


def test_rounding_makes_no_model_rough(tmp_path: Path) -> None:
    """Two calls of one model may differ in their last digits; a search that took that for noise would go other ways."""
    answer = asked(scattering(1e-18)).diagnosed(tmp_path, record(leaning_with_play))
    assert not any("by itself by up to" in note for note in answer.records.notes)


def test_a_bending_cause_is_fitted_in_a_model_with_steps(tmp_path: Path) -> None:
    """As large as the noise of the readings."""
    sizes = of_causes(asked(rounded(5e-6)).diagnosed(tmp_path, record(hardened)))
    assert sizes["hardens.gain"] == pytest.approx(0.8, rel=0.03)
    assert sizes["hardens.knee"] == pytest.approx(8e3, rel=0.03)


@pytest.mark.parametrize("shop", [rounded(5e-6), scattering(1e-6)])
def test_a_rough_model_is_no_error(tmp_path: Path, shop: Shop) -> None:
    assert not asked(shop).diagnosed(tmp_path, record(lambda at: 0.0)).causes


@pytest.mark.parametrize("error", [leaning, lambda at: 0.0])
def test_a_model_rougher_than_the_readings_names_nothing_plainly(
    tmp_path: Path, error: Callable[[Mapping[str, Array]], Array]
) -> None:
    """Steps of 50 um in readings with a noise of 5 um: the steps are what is wrong."""
    answer = asked(rounded(50e-6)).diagnosed(tmp_path, record(error))
    assert not answer.unique
    (said,) = answer.hindrances
    assert said.startswith("the model's bend jumps or scatters by up to 50 um by itself, which is most of")


def test_a_smooth_model_is_not_called_rough(tmp_path: Path) -> None:
    """Loads in steps of 5 kN give way in steps of 0.5 mm, the model has none."""
    columns = record(lambda at: 0.0)
    load = np.round(columns["load"] / 5) * 5
    answer = asked(Shop()).diagnosed(
        tmp_path, {**columns, "bend": columns["bend"] + 100 * (load - columns["load"]), "load": load}
    )
    assert not [note for note in answer.records.notes if "by itself" in note]
