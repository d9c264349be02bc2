"""What a diagnosis says without being asked: only sentences of a registered kind, and no statistics among them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_samples import HEATING, SAMPLES, SLIDE, named

from truing.declare.sources import Effect, Unknown
from truing.diagnosis.result import (
    Amount,
    Cause,
    Contradiction,
    Course,
    DiagnosisResult,
    Fact,
    FittedUnknown,
    Thinned,
    Tie,
    Trade,
    VisibleSize,
)
from truing.diagnosis.sentences import CHAPTERS, SENTENCES, kind_of, records_words, say, sentence
from truing.report.chapters import Figures
from truing.report.diagnosis_chapters import diagnosis_chapters
from truing.report.diagnosis_sizes import as_waves
from truing.report.diagnosis_words import cause_text, headline, tie_text
from truing.report.document import BlockView, Fold, Items, Paragraph, TableView, plain_text

STATISTICS = re.compile(
    r"score|λ|lambda|\bp [<0-9]|p-value|_|\b(co)?sine\b|autocorrelation|\bAR\b|degrees of freedom|\bfolds?\b|"
    r"noise floor|coverage|log score|reducible|\bsd\b|significan|likelihood|residual"
)
"""Words that stand folded away."""


def torn() -> DiagnosisResult:
    """A named cause with everything that can speak against it."""
    gain = tuple(replace(each, rmse_after=Amount(each.rmse_before.value * 2, each.rmse_before.unit),
                         held_out=(40e-6, 55e-6)) for each in named().gain)  # fmt: skip
    wrong = tuple(replace(each, stated=Amount(1e-3, "um"), noise=replace(each.noise, ar_coefficient=0.97))
                  for each in named().wrong)  # fmt: skip
    unknown = replace(HEATING.unknowns[0], value=20e-6, low=None)
    return replace(
        named(), causes=(replace(HEATING, unknowns=(unknown,), same_as=("warm_up",)),), gain=gain, wrong=wrong,
        stability=0.25, calibrated=tuple(replace(each, of_its_sd=4.0) for each in named().calibrated),
        contradictions=(
            Contradiction("rod_heating", "expansion", Amount(8e-6, "um/(m*K)"), Amount(15e-6, "um/(m*K)")),
        ),
        thinned=(Thinned("every second row, from the first", ("sensor_drift",), 9.0),),
        trades=(Trade("rod_heating", "expansion", "rod", 0.999, 12.0),),
    )  # fmt: skip


STATES = {**SAMPLES, "torn": torn}


def sentences_of(blocks: Iterable[BlockView]) -> Iterator[str]:
    """The sentences of a chapter that are not folded away."""
    for block in blocks:
        match block:
            case Paragraph(text):
                yield plain_text(text)
            case Items(_, texts, _):
                yield from (re.sub(r"^(Practically certain|Likely|May be chance): ", "", plain_text(text))
                            for text in texts)  # fmt: skip


def texts_of(blocks: Iterable[BlockView]) -> Iterator[str]:
    """Everything that can be read without unfolding anything."""
    yield from sentences_of(blocks)
    for block in blocks:
        if isinstance(block, TableView):
            yield from (block.title, plain_text(block.note), *(column.title for column in block.columns))
            yield from (plain_text(cell) for row in block.rows for cell in row)


def chapters_of(made: DiagnosisResult) -> Iterator[tuple[str, tuple[BlockView, ...]]]:
    """The chapters by their names; the record speaks in the words of the files."""
    for chapter in diagnosis_chapters(made, Figures(skipped=True)):
        yield chapter.ident, chapter.blocks


@pytest.mark.parametrize("state", list(STATES))
def test_every_sentence_is_of_a_registered_kind(state: str) -> None:
    made = STATES[state]()
    said = [text for ident, blocks in chapters_of(made) if ident != "record" for text in sentences_of(blocks)]
    own = {
        "Time and rod temperature rise together in every run: their effects cannot be separated here.",
        "Warm at once: heat follows the temperature, a drift follows the clock.",
        "Rises with rod temperature: 3.8 µm per K.",
        "12 waves over the range of crank angle, with 31 % of what is left.",
    }  # written by hand in the samples
    assert [text for text in [*headline(made), *said] if not kind_of(text) and text not in own] == []
    assert len(said) > 5


@pytest.mark.parametrize("state", list(STATES))
def test_no_statistics_are_said_unasked(state: str) -> None:
    made = STATES[state]()
    said = [*headline(made), *(text for ident, blocks in chapters_of(made) if ident != "record"
                               for text in texts_of(blocks))]  # fmt: skip
    assert [text for text in said if STATISTICS.search(re.sub(r"extended\.toml|new_effect\.py", "", text))] == []


def test_the_statistics_are_there_behind_the_words() -> None:
    folds = [block for _, blocks in chapters_of(named()) for block in blocks if isinstance(block, Fold)]
    text = "\n".join(word for fold in folds for word in texts_of(fold.blocks))
    for words in ("p 0.0033", "λ", "Autocorrelation", "Noise floor", "Log score per row", "Coverage", "99.9 %"):
        assert words in text


def test_every_kind_is_said_or_known_by_its_own_sentence() -> None:
    """A kind is recognised by its words alone: no other kind takes its sentence."""
    assert len(SENTENCES) == sum(map(len, CHAPTERS.values()))
    taken = {}
    for name, kind in SENTENCES.items():
        gaps = {gap: f"⟨{gap}⟩" for gap in re.findall(r"{(\w+)}", kind.text)}
        if kind_of(sentence(say(name, **gaps))) != name:
            taken[name] = kind_of(say(name, **gaps))
        assert kind.meaning.endswith("."), name
        assert not STATISTICS.search(kind.text.replace("new_effect.py", "")), name
    assert taken == {}


@pytest.mark.parametrize(
    ("p_value", "words"),
    [
        (0.0003, "fewer than 1 of 1,000 records"), (1 / 301, "fewer than 1 of 300 records"),
        (0.0099, "fewer than 1 of 100 records"), (0.034, "about 1 of 29 records"), (0.31, "about 3 of 10 records"),
        (0.8, "most records"),
    ],
)  # fmt: skip
def test_chance_is_said_in_records(p_value: float, words: str) -> None:
    assert records_words(p_value) == words


# A wave by its amplitude and phase


def wave(sine: float, cosine: float, half: float) -> tuple[FittedUnknown, ...]:
    """The two parts of a wave, um, both as sure."""
    return tuple(FittedUnknown(name, value, value - half, value + half, "um")
                 for name, value in (("sine", sine), ("cosine", cosine)))  # fmt: skip


def test_a_wave_is_said_by_amplitude_and_phase() -> None:
    """3 sin + 4 cos = 5 cos(x - 36.87 deg); as sure in both parts, so the amplitude is known to as much."""
    amplitude, phase = as_waves(wave(3e-6, 4e-6, 0.5e-6), ((1e-14, 0.0), (0.0, 1e-14)))
    assert (amplitude.name, phase.name, phase.unit) == ("amplitude", "phase", "deg")
    assert amplitude.value == pytest.approx(5e-6)
    assert amplitude.low == pytest.approx(4.5e-6)
    assert phase.value == pytest.approx(math.atan2(3, 4))
    assert phase.high is not None
    assert phase.high - phase.value == pytest.approx(0.1)


def test_the_interval_of_a_wave_agrees_with_draws() -> None:
    """Correlated parts, drawn from a normal law; first order is good to 3 % where the wave is well known."""
    sds, correlation = np.array([0.1e-6, 0.2e-6]), 0.6
    covariance = np.outer(sds, sds) * np.array([[1, correlation], [correlation, 1]])
    parts = tuple(FittedUnknown(name, value, value - 1.96 * sd, value + 1.96 * sd, "um")
                  for name, value, sd in (("tooth_sine", 3e-6, sds[0]), ("tooth_cosine", -4e-6, sds[1])))  # fmt: skip
    amplitude, phase = as_waves(parts, covariance.tolist())
    drawn = np.random.default_rng(1_610_000).multivariate_normal([3e-6, -4e-6], covariance, 40_000)
    sizes, angles = np.hypot(*drawn.T), np.arctan2(*drawn.T)
    assert amplitude.name == "tooth_amplitude"
    assert amplitude.high is not None
    assert phase.high is not None
    assert (amplitude.high - amplitude.value) / 1.96 == pytest.approx(sizes.std(), rel=0.03)
    assert (phase.high - phase.value) / 1.96 == pytest.approx(angles.std(), rel=0.03)


def test_without_a_covariance_the_size_of_a_wave_has_no_interval() -> None:
    amplitude, phase = as_waves(wave(3e-6, 4e-6, 0.5e-6))
    assert (amplitude.low, phase.low) == (None, None)
    alone = FittedUnknown("sine", 1e-6, None, None, "um")
    assert as_waves((alone,)) == [alone]


def test_nobody_reads_sine_and_cosine() -> None:
    """Sizes, what was visible, facts, and a warning about one part of a wave."""
    eccentric = Cause("eccentricity", wave(3e-6, 4e-6, 0.5e-6), ((1e-14, 0.0), (0.0, 1e-14)))
    effect = Effect("eccentricity", on_results=lambda crank, base, *, sine, cosine: base,
                    unknowns=[Unknown("sine", -9, 9, "um"), Unknown("cosine", -9, 9, "um")])  # fmt: skip
    made = replace(
        named(), causes=(eccentric,),
        setup=replace(named().setup, model=replace(SLIDE, errors=[*SLIDE.errors, effect])),
        seen=(VisibleSize("runout.sine", Amount(2e-6, "um"), "visible"),
              VisibleSize("runout.cosine", Amount(3e-6, "um"), "hidden in the tolerances")),
        contradictions=(Contradiction("eccentricity", "sine", Amount(1e-6, "um"), Amount(5e-6, "um")),),
    )  # fmt: skip
    assert cause_text(eccentric).startswith("eccentricity, amplitude 5.00 µm (95 %: 4.50 … 5.50); phase 36.9° (")
    said = [*headline(made), *(text for _, blocks in chapters_of(made) for text in texts_of(blocks))]
    assert [text for text in said if re.search(r"\b(co)?sine\b", text)] == []
    assert "A part of the wave of eccentricity is 1 µm in one half of the rows" in " ".join(said)
    assert any("runout (noticed above 3 µm)" in text for text in said)
    sizes = {"sine": Amount(3e-6, "um"), "cosine": Amount(4e-6, "um")}
    facts = tuple(Fact("eccentricity", f"eccentricity.{part}", size, "", replace(size, value=size.value / 2))
                  for part, size in sizes.items())  # fmt: skip
    tie = Tie(("eccentricity", "runout"), facts)
    assert tie_text(tie).endswith(": eccentricity, amplitude to ±2.5 µm (5 µm if it is eccentricity)")


@pytest.mark.parametrize(("start", "said"), [(50.0, "18 K above"), (31.0, ""), (18.0, "14 K below")])
def test_an_experiment_that_begins_elsewhere_says_how_far(start: float, said: str) -> None:
    """The record ended at 32 °C, after a range of 22 K; what can be set at will is not brought anywhere."""
    made = SAMPLES["ambiguous"]()
    assert made.experiment is not None
    assert not any(kind_of(text) == "bring first" for text in headline(made))
    courses = (Course("rod_temperature", "ramp", 273.15 + start, 333.15), *made.experiment.courses[1:])
    lengths, heating, *others = SLIDE.errors
    assert isinstance(heating, Effect)
    slow = replace(heating, needs=[replace(need, role="follows") for need in heating.needs])
    temperature = made.records.covariates["rod_temperature"]
    ended = replace(temperature, values=np.append(temperature.values[:-1], 273.15 + 32.0))
    follows = replace(
        made, experiment=replace(made.experiment, courses=courses),
        setup=replace(made.setup, model=replace(SLIDE, errors=[lengths, slow, *others])),
        records=replace(made.records, covariates={**made.records.covariates, "rod_temperature": ended}),
    )  # fmt: skip
    brought = [text for text in headline(follows) if kind_of(text) == "bring first"]
    assert [re.findall(r"\((.*) where the record ended\)", text) for text in brought] == ([[said]] if said else [])


def test_the_manual_explains_every_kind_once() -> None:
    page = (Path(__file__).parents[2] / "docs" / "reference" / "sentences.md").read_text(encoding="utf-8")
    for kind in SENTENCES.values():
        text = re.sub(r"{(\w+)}", r"*\1*", kind.text)
        assert page.count(f"\n| {text} | {kind.meaning} |") == 1, kind.text
    assert [title for title in CHAPTERS if f"\n## {title}\n" not in page] == []
