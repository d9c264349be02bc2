"""A beam that gives way under a load, as a model that is hard to ask: slow, failing, rough.

What it does is known from the formulas that make the records, in kN, mm, degC and um.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Array, Asked, names_in

from truing import Effect, Float, Model, Tolerance, Unknown, feasible, found, given, inputs, normal, results
from truing.diagnosis import engine, extended
from truing.diagnosis.engine import diagnose
from truing.diagnosis.extended import CallBudget, Extended, budget_of, step_of
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.result import DiagnosisResult
from truing.runs.diagnosis_document import diagnosis_document
from truing.setup import DiagnoseOptions

ROWS, NOISE = 100, 5.0
UNITS = {"load": "kN", "place": "mm", "warmth": "degC", "bend": "um"}


@inputs
class Beam:
    """A beam under a load."""

    load: Float = given(0.0, "kN")
    place: Float = given(0.0, "mm")
    warmth: Float = given(20.0, "degC")
    stiffness: Float = given(10.0, "kN/mm")
    slant: Float = given(0.0, "um", note="what it leans over 300 mm")
    growth: Float = given(0.0, "um/K")
    play: Float = given(0.0, "um")
    ripple: Float = given(0.0, "um")


@results
class Bend:
    """How far it gives way."""

    bend: Float = found("um")


class Shop:
    """Where beams are calculated: how long a call takes by a clock of its own, and how rough what it says is."""

    def __init__(self, seconds: float = 0.0, rough: Callable[[Array], Array] = lambda bend: bend) -> None:
        self.seconds, self.rough = seconds, rough
        self.calls = self.time = 0.0

    def clock(self) -> float:
        """Return the time that its calls have taken."""
        return self.time

    def function(self, rows: int) -> Callable[[Beam], Bend]:
        """Return the model, which takes its time for every so many rows."""

        def beam(it: Beam) -> Bend:
            """Hooke's law."""
            self.calls += np.size(it.load) / rows
            self.time += self.seconds * np.size(it.load) / rows
            lean = it.slant * it.place / 0.3 + it.play * np.sign(it.load) + it.ripple
            bend = it.load / it.stiffness + lean + it.growth * (it.warmth - 293.15)
            return Bend(bend=self.rough(np.asarray(bend)))

        return beam


def leans(it: Beam, *, slant: Float) -> Beam:
    return replace(it, slant=it.slant + slant)


def grows(it: Beam, *, growth: Float) -> Beam:
    return replace(it, growth=it.growth + growth)


def plays(it: Beam, *, play: Float) -> Beam:
    return replace(it, play=it.play + play)


def softens(it: Beam, *, loss: Float) -> Beam:
    return replace(it, stiffness=it.stiffness * (1 - loss))


def hardens(it: Beam, *, gain: Float, knee: Float) -> Beam:
    return replace(it, stiffness=it.stiffness * (1 + gain * np.maximum(np.abs(it.load) / knee - 1, 0)))


EFFECTS = (
    Effect("leans", on_inputs=leans, unknowns=[Unknown("slant", -200, 200, "um")]),
    Effect("grows", on_inputs=grows, unknowns=[Unknown("growth", -10, 10, "um/K")]),
    Effect("plays", on_inputs=plays, unknowns=[Unknown("play", 0, 200, "um")]),
    Effect("softens", on_inputs=softens, unknowns=[Unknown("loss", -0.5, 0.5)]),
    Effect("hardens", on_inputs=hardens, unknowns=[Unknown("gain", 0, 5), Unknown("knee", 1, 20, "kN")]),
)  # fmt: skip


def asked(shop: Shop, effects: Sequence[Effect[Any, Any]] = EFFECTS, rows: int = ROWS, calls: int = 0) -> Asked:
    spreads = [Tolerance("stiffness", normal(sd="2 %"))]
    model = Model(name="beam", title="Beam", function=shop.function(rows), errors=[*spreads, *effects])
    return Asked(model, units=UNITS, diagnose=DiagnoseOptions(budget=calls))


def record(error: Callable[[Mapping[str, Array]], Any], rows: int = ROWS, *without: str) -> dict[str, Array]:
    """Readings of a beam of 10 kN/mm with an error of its own, in um; some columns may be left out."""
    rng = np.random.default_rng(0)
    made = {
        "load": rng.uniform(-20, 20, rows), "place": rng.uniform(0, 300, rows), "warmth": rng.uniform(15, 45, rows),
    }  # fmt: skip
    made["bend"] = made["load"] * 100 + error(made) + rng.normal(0, NOISE, rows)
    return {name: column for name, column in made.items() if name not in without}


def leaning(at: Mapping[str, Array]) -> Array:
    return 40 * at["place"] / 300


def leaning_with_play(at: Mapping[str, Array]) -> Array:
    return leaning(at) + 30 * np.sign(at["load"])


def hardened(at: Mapping[str, Array]) -> Array:
    """From 8 kN on a beam that is stiffer by 0.8 for every 8 kN more."""
    return at["load"] * 100 * (1 / (1 + 0.8 * np.maximum(np.abs(at["load"]) / 8 - 1, 0)) - 1)


def of_causes(answer: DiagnosisResult) -> dict[str, float]:
    """The fitted unknowns of all causes, SI, by effect and name."""
    return {f"{cause.effect}.{each.name}": each.value for cause in answer.causes for each in cause.unknowns}


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
    monkeypatch.setattr(extended, "processor_seconds", shop.clock)
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
    """Two causes that mask one another would take three quarters of an hour; what was left out is said.

    What follows the search (sizes, folds, the next measurement) takes a few hundred calls at most.
    """
    shop = Shop(1.0)
    monkeypatch.setattr(extended, "processor_seconds", shop.clock)
    records = asked(shop).records(tmp_path, record(leaning_with_play))
    shop.time = shop.calls = 0.0
    answer = diagnose(asked(shop).setup, records)
    assert shop.time < 15 * 60
    assert 0.5 * 300 < shop.calls < 300 + 400
    assert {"leans", "plays"} <= names_in(answer)
    assert not answer.unique
    (said,) = answer.hindrances
    assert said.startswith(
        "the search ended after 300 calls of the model, of which one takes about 1 s, and left out: "
    )
    assert said in answer.warnings
    assert said in diagnosis_document(answer)["warnings"]


def test_a_stated_budget_gives_one_answer_however_slow_the_machine_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = []
    for seconds in (0.0, 30.0):
        shop = Shop(seconds)
        monkeypatch.setattr(extended, "processor_seconds", shop.clock)
        answers.append(diagnosis_document(asked(shop, EFFECTS[:2], calls=60).diagnosed(tmp_path, record(leaning))))
    assert answers[0] == answers[1]
    assert "the search ended after 60 calls of the model and left out: " in " ".join(answers[0]["warnings"])


@pytest.mark.parametrize(("calls", "error"), [(24, leaning), (20, lambda at: 0.0)], ids=["leaning", "nothing"])
def test_what_is_not_looked_at_is_named_and_not_called_idle_and_nothing_is_not_said(
    tmp_path: Path, calls: int, error: Callable[[Mapping[str, Array]], Any]
) -> None:
    answer = asked(Shop(), calls=calls).diagnosed(tmp_path, record(error))
    (said,) = answer.hindrances
    assert "left out: any look at " in said
    assert "plays, softens, hardens, " in said
    document = diagnosis_document(answer)
    assert answer.verdict == "undecided"
    assert said in document["undecided"]
    assert not {"plays", "softens", "hardens"} & set(document["not_excited"])


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
    """Of 200 um and 1, 0.3, 0.1 ... 0.001 of it, seven sizes, the first two are beyond 50 um; one always fails."""
    answer = asked(Shop(), [EFFECTS[2], failing(function), failing(is_wrong)]).diagnosed(tmp_path, record(error))
    name = function.__name__ if error is leaning else "plays"
    assert [cause.effect for cause in answer.causes] == [name]
    assert answer.verdict == "named"
    notes = " ".join(answer.records.notes)
    assert f"the model fails with {function.__name__} at 29 % of the points tried (2 of 7)" in notes
    assert "the model fails with is_wrong at 100 %" in notes
    why = diagnosis_document(answer)["not_fitted"]["is_wrong"]
    assert why.startswith("the model fails with it: ")
    assert why.endswith("ZeroDivisionError: whatever the slant")


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


def test_a_model_with_noise_of_its_own_has_the_cause_that_is_there(tmp_path: Path) -> None:
    """Up to a fifth of that of the readings; the size within four standard errors of a slope over all rows."""
    answer = asked(scattering(1e-6), EFFECTS[:1], 60).diagnosed(tmp_path, record(leaning, 60, "warmth"))
    assert of_causes(answer) == {"leans.slant": pytest.approx(40e-6, abs=8e-6)}
    assert any("by itself by up to" in note for note in answer.records.notes)


def test_a_bending_cause_is_fitted_in_a_model_with_steps(tmp_path: Path) -> None:
    """As large as the noise of the readings."""
    sizes = of_causes(
        asked(rounded(5e-6), EFFECTS[4:], 60).diagnosed(tmp_path, record(hardened, 60, "warmth", "place"))
    )
    assert sizes["hardens.gain"] == pytest.approx(0.8, rel=0.03)
    assert sizes["hardens.knee"] == pytest.approx(8e3, rel=0.03)


def test_a_model_rougher_than_the_readings_names_nothing_plainly(tmp_path: Path) -> None:
    """Steps of 50 um in readings with a noise of 5 um: the steps are what is wrong."""
    answer = asked(rounded(50e-6), EFFECTS[:1], 60).diagnosed(tmp_path, record(leaning, 60, "warmth"))
    assert not answer.unique
    (said,) = answer.hindrances
    assert said.startswith("the model's bend jumps or scatters by up to 50 um by itself, which is most of")


def test_a_rough_model_is_no_error(tmp_path: Path) -> None:
    assert not asked(rounded(5e-6), EFFECTS[:3]).diagnosed(tmp_path, record(lambda at: 0.0, ROWS, "warmth")).causes


def test_a_smooth_model_is_not_called_rough(tmp_path: Path) -> None:
    """Loads in steps of 5 kN give way in steps of 0.5 mm, the model has none but that of its last digits."""
    columns = record(lambda at: 0.0)
    load = np.round(columns["load"] / 5) * 5
    bend = columns["bend"] + 100 * (load - columns["load"])
    answer = asked(scattering(1e-18), EFFECTS[:2]).diagnosed(tmp_path, {**columns, "bend": bend, "load": load})
    assert not [note for note in answer.records.notes if "by itself" in note]


# Many effects, many inputs, and records of odd sizes: what is there is found, and no row is lost unsaid.


def ripples(order: int) -> Effect[Any, Any]:
    def rippling(it: Beam, *, size: Float) -> Beam:
        return replace(it, ripple=it.ripple + size * np.cos(np.pi * order * it.place / 0.3))

    return Effect(f"ripple_{order}", on_inputs=rippling, unknowns=[Unknown("size", -200, 200, "um")])


def test_one_of_forty_effects_is_named(tmp_path: Path) -> None:
    effects = [*EFFECTS, *(ripples(order) for order in range(1, 36))]
    error = record(lambda at: 20 * np.cos(17 * np.pi * at["place"] / 300))
    answer = asked(Shop(), effects).diagnosed(tmp_path, error)
    assert (answer.verdict, [cause.effect for cause in answer.causes]) == ("named", ["ripple_17"])
    assert of_causes(answer)["ripple_17.size"] == pytest.approx(20e-6, abs=5 * NOISE * 1e-6 * np.sqrt(2 / ROWS))


# Records of odd sizes


def test_two_equal_columns_are_told_as_one(tmp_path: Path) -> None:
    """A shape over either is the same: neither of the two is called the one."""
    columns = record(lambda at: 30 * np.sin(2 * np.pi * at["warmth"] / 12))
    twin = replace(asked(Shop(), EFFECTS[:1]), units={**UNITS, "air": "K"})
    answer = twin.diagnosed(tmp_path, {**columns, "air": columns["warmth"] + 273.15})
    assert any({"warmth", "air"} <= set(said.replace(" and ", " ").split()) for said in answer.inseparable)
    assert answer.verdict in {"unknown", "one_of"}


def test_a_long_record_runs_to_the_end_and_counts_every_row(
    tmp_path: Path, full_torture: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A million rows at full size; a modest record is long where 200 rows are searched."""
    rows = 1_000_000 if full_torture else 600
    if not full_torture:
        monkeypatch.setattr(engine, "LONG", 200)
    answer = asked(Shop(), EFFECTS[:1], rows).diagnosed(tmp_path, record(leaning, rows, "warmth"))
    assert [cause.effect for cause in answer.causes] == ["leans"]
    assert sum(count.in_file for count in answer.records.counts) == rows == len(answer.records)
    error = NOISE * 1e-6 * np.sqrt(12 / rows)
    assert of_causes(answer)["leans.slant"] == pytest.approx(40e-6, abs=5 * error)


def test_of_a_long_record_the_rows_searched_say_what_would_be_visible(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As much as all rows say, up to what a quarter of them is not like the whole."""
    answers = []
    for rows_searched in (600, 150):
        monkeypatch.setattr(engine, "LONG", rows_searched)
        answers.append(asked(Shop(), EFFECTS[:3:2], 600).diagnosed(tmp_path, record(leaning, 600, "warmth")))
    whole, few = answers
    sizes = [{seen.name: seen.smallest.value for seen in answer.seen if seen.smallest} for answer in answers]
    assert sizes[0].keys() == sizes[1].keys() > {"leans", "plays"}
    assert [sizes[1][name] for name in sizes[0]] == pytest.approx(list(sizes[0].values()), rel=0.1)
    apart = [{rival.causes: rival.separation for rival in answer.ranking} for answer in answers]
    both = apart[0].keys() & apart[1].keys()
    assert len(both) > 1
    assert [apart[1][names] for names in both] == pytest.approx([apart[0][names] for names in both], rel=0.2)
    assert [cause.effect for cause in whole.causes] == [cause.effect for cause in few.causes] == ["leans"]
