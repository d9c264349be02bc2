"""The statistics of a diagnosis, exact: what stands folded away behind the sentences."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from truing.diagnosis.records import file_labels
from truing.diagnosis.result import APART, Alternative, Amount, DiagnosisResult, Experiment, NoiseSummary
from truing.diagnosis.sentences import say
from truing.numbers import format_number, pretty
from truing.report import diagnosis_figures as figures
from truing.report.chapters import Figures
from truing.report.diagnosis_sizes import amount_text, p_text, percent, score_text
from truing.report.diagnosis_words import explanation, prose, settings_text, spoken, together
from truing.report.document import BlockView, Paragraph, TableView, table_of

MOST_OUTLIERS = 12


def of_errors(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Give errors and noise floors, significances of what was noticed, and what the noise is like."""
    errors, findings, noises = [], [], []
    for wrong in diagnosis.wrong:
        name, noise = spoken(wrong.result), wrong.noise
        share = percent(wrong.reducible_share)
        errors.append((name, str(wrong.rows), amount_text(wrong.rmse), amount_text(wrong.noise_floor), share))
        findings += [(name, each.kind, prose(each.text), p_text(each.p_value)) for each in wrong.findings]
        numbers = (pretty(format_number(each, 2)) for each in (noise.autocorrelation, noise.ar_coefficient))
        noises.append((name, amount_text(noise.sd), *numbers, noise.tails, prose(noise.spread), _outliers(noise)))
    heads = ("Result", "Rows", "RMS error", "Noise floor", "Reducible")
    note = (
        "The error is that of the model calibrated within its tolerances. Reducible is the share of the mean square "
        "error that lies above the noise floor."
    )
    yield table_of("Error of the model as it is", heads, errors, (1, 2, 3, 4), note)
    if findings:
        kinds = ("Result", "Kind", "What the residuals show", "Significance, the search paid for")
        yield table_of("Structure in the residuals", kinds, findings, (3,))
    about = ("Result", "Standard deviation", "Autocorrelation", "AR coefficient", "Tails", "Spread", "Far readings")
    note = "Far readings are beyond four standard deviations."
    yield table_of("The noise, once everything found is taken out", about, noises, (1, 2, 3), note)


def _outliers(noise: NoiseSummary) -> str:
    """Name the rows of suspected outliers."""
    names = list(dict.fromkeys(file for file, _ in noise.outliers))
    labels = dict(zip(names, file_labels(names), strict=True))
    places = [f"{labels[file]}:{line}" for file, line in noise.outliers]
    more = f" and {len(places) - MOST_OUTLIERS} more" if len(places) > MOST_OUTLIERS else ""
    return ", ".join(places[:MOST_OUTLIERS]) + more or "none"


def of_explanations(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    """Give significances, the ranking in numbers and as bars, and what the warnings rest on."""
    steps = [f"first step {p_text(diagnosis.p_any)}"]
    steps += [f"last further cause {p_text(diagnosis.p_second)}"] * (diagnosis.p_second is not None)
    yield Paragraph(f"Significance, every explanation that was tried paid for: {'; '.join(steps)}.")
    if diagnosis.ranking:
        yield ranking_table(diagnosis)
        title = "Ranking of the explanations"
        caption = f"{title}; blue is what this data does not exclude."
        yield drawn.view(title, partial(figures.ranking_bars, diagnosis), caption)
    shares = [(spoken(cause.effect), percent(cause.share)) for cause in diagnosis.causes]
    if len(shares) > 1:
        note = "Of the mean squares of what the named causes add, over all rows in units of the noise."
        yield table_of("Shares of the correction", ("Cause", "Share"), shares, (1,), note)
    angles = [
        (spoken(each.one), spoken(each.other), amount_text(Amount(each.angle, "deg"))) for each in diagnosis.alike
    ]
    if angles:
        yield table_of("Curves that are nearly alike on this data", ("One", "Other", "Angle"), angles, (2,))
    yield from _doubtful(diagnosis)


def _doubtful(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Give the numbers behind the warnings."""
    rows = [(f"{spoken(each.effect)}, {spoken(each.unknown)}", f"{amount_text(each.first)} and "
             f"{amount_text(each.second)} in two halves") for each in diagnosis.contradictions]  # fmt: skip
    rows += [(together(half.causes), f"ahead by {half.ahead:.1f} score units on {half.rows}")
             for half in diagnosis.thinned]  # fmt: skip
    rows += [(f"{spoken(two.effect)}, {spoken(two.unknown)}", f"correlation {two.correlation:.3f} with "
              f"{spoken(two.input)}, λ {score_text(two.separation)}") for two in diagnosis.trades]  # fmt: skip
    if rows:
        yield table_of("Behind the warnings", ("What", "Numbers"), rows)


def ranking_table(diagnosis: DiagnosisResult) -> TableView:
    """Say the explanations that were compared, and what this data makes of each, in numbers."""
    rows = [
        (explanation(each), pretty(f"{each.behind:.1f}"), score_text(each.separation), judged(each, diagnosis))
        for each in figures.shown_ranking(diagnosis)
    ]
    note = (
        "Behind is the distance in score units (6 is a Bayes factor of about 20). λ is the loss of fit to expect if "
        f"the best explanation is true and this one is fitted: from {APART:.0f} on the two can be told apart. Where "
        "parts of the record contradict one another, an explanation stays open nevertheless."
    )
    return table_of("Explanations, best first", ("Explanation", "Behind", "λ", "On this data"), rows, (1, 2), note)


def judged(alternative: Alternative, diagnosis: DiagnosisResult) -> str:
    """Say what this data makes of an explanation beside the best one."""
    best = diagnosis.ranking[0]
    if alternative == best:
        return say("best")
    if figures.is_open(alternative, diagnosis):
        return say("is open")
    if best.causes and set(best.causes) < set(alternative.causes):
        return say("adds nothing")
    return say("ruled out") if alternative.behind >= figures.NEAR else say("needs more")


def of_gain(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Give the gain in numbers: errors, log score, significance, coverage, folds."""
    rows = []
    for gain in diagnosis.gain:
        errors = (amount_text(each) for each in (gain.rmse_before, gain.rmse_after, gain.noise_floor))
        removed, covered = percent(gain.reducible_removed), percent(gain.coverage90)
        score, p_value = score_text(gain.log_score_gain), pretty(format_number(gain.p_value, 2))
        rows.append((spoken(gain.result), *errors, removed, score, p_value, covered))
    heads = ("Result", "Before", "After", "Noise floor", "Removed", "Log score per row", "p", "Coverage")
    note = (
        "RMS errors on rows that were not fitted: the whole diagnosis is repeated in every fold of a blocked "
        "cross-validation and compared with the model calibrated in the same fold. Removed is the share of the "
        "reducible error. Coverage is that of the 90 % prediction intervals. The same causes were named in "
        f"{percent(diagnosis.stability)} of the folds."
    )
    yield table_of("What the extension is worth, in numbers", heads, rows, tuple(range(1, 8)), note)


def of_proposal(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Give the separation to expect after each proposed reading, and how the chance was found."""
    rows = []
    for index, point in enumerate(diagnosis.next, start=1):
        what = settings_text(point) if point.measure else f"reading {index}"
        one, other = (together([name]) for name in point.separates)
        rows.append((what, one, other, score_text(point.separation)))
    note = f"λ is the separation to expect once all up to it are measured; from {APART:.0f} on two are told apart."
    heads = ("Then", "One", "Other", "λ")
    yield table_of("Separation to expect", heads, rows, (3,), note)
    if diagnosis.experiment is not None:
        yield Paragraph(_chance_note(diagnosis.experiment))


def _chance_note(experiment: Experiment) -> str:
    chance = experiment.chance
    return f"The chance is that of {chance.draws} simulated experiments, each explanation true in turn: {chance.by}."


def readings_table(experiment: Experiment) -> TableView:
    """Write the readings of an experiment, to be taken to the machine, and how its chance was found."""
    note = _chance_note(experiment)
    names = list(experiment.settings)
    units = experiment.units
    rows = [
        (
            str(index + 1),
            *(amount_text(Amount(float(experiment.settings[name][index]), units[name]), 4) for name in names),
        )
        for index in range(experiment.readings)
    ]
    heads = ("Reading", *(spoken(name).capitalize() for name in names))
    return table_of("Readings to take", heads, rows, (*range(1, len(heads)),), note)
