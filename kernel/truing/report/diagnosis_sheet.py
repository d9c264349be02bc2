"""The sheet of a diagnosis: what is wrong, why, the extended model, its worth, what to measure next, the data."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.result import (
    APART,
    Alternative,
    Amount,
    DiagnosisResult,
    Experiment,
    FittedUnknown,
    NoiseSummary,
    explanations_of,
    stated_remedy,
)
from truing.numbers import ABSENT, STATED_DIGITS, format_number, pretty
from truing.report import diagnosis_figures as figures
from truing.report.chapters import Figures, numbered
from truing.report.diagnosis_words import (
    amount_text,
    cause_text,
    certainty,
    experiment_text,
    explanation,
    fitted_text,
    headline,
    is_result_first,
    listed,
    number_texts,
    p_text,
    pair_text,
    percent,
    prose,
    readable,
    reasons,
    remedy_of,
    score_text,
    settings_text,
    shared_words,
    spoken,
    tie_text,
    verdict_word,
)
from truing.report.document import Banner, BlockView, Chapter, Document, Items, Paragraph, TableView, table_of
from truing.report.sheet import end_chapters, head_faults, head_of
from truing.runs.diagnosis_document import file_labels
from truing.runs.folder import data_digests
from truing.runs.provenance import Provenance, provenance_of

DIAGNOSIS = "Diagnosis"
DOUBT = "Whether this is the cause is open: settle that before anything is changed on the machine."


def diagnosis_sheet_of(diagnosis: DiagnosisResult, started: float) -> Document:
    """Return what a diagnosis says, with where its numbers and its data come from."""
    provenance = provenance_of(diagnosis.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    provenance = replace(provenance, files={**provenance.files, **data_digests(diagnosis)})
    return make_diagnosis_sheet(diagnosis, provenance=provenance)


def make_diagnosis_sheet(diagnosis: DiagnosisResult, *, provenance: Provenance) -> Document:
    """Say everything that stands on the sheet of a diagnosis."""
    drawn = Figures()
    front = tuple(_page_one(diagnosis, drawn))
    chapters = list(diagnosis_chapters(diagnosis, drawn))
    warnings = (*head_faults(diagnosis.setup), *drawn.failures)
    head = head_of(diagnosis.setup, provenance)
    named = "found" if diagnosis.remainder is None else "open"
    mood = {"none": "calm", "named": named}.get(diagnosis.verdict, "open")
    return Document(
        kind=DIAGNOSIS,
        title=f"{DIAGNOSIS}: {head.title}",
        head=replace(head, footer=" · ".join(part for part in (DIAGNOSIS, head.footer) if part)),
        detail=diagnosis.setup.sheet.detail,
        summary=data_words(diagnosis),
        banner=Banner(mood, verdict_word(diagnosis), tuple(headline(diagnosis))),
        alarms=tuple(unit_error.text for unit_error in diagnosis.records.unit_errors),
        front=front,
        paper=diagnosis.setup.sheet.paper,
        chapters=numbered([*chapters, *end_chapters(warnings, provenance)]),
        warnings=warnings,
        provenance=provenance,
    )


def _page_one(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[Chapter]:
    """Give the picture of the result that gains most, over what tells most, and what to do about each cause."""
    shown = figures.shown_curves(diagnosis)
    gained = {gain.result: gain.rmse_before.value - gain.rmse_after.value for gain in diagnosis.gain}
    curves = max(shown, key=lambda each: gained.get(each.result, 0.0), default=None)
    covariate = None if curves is None else figures.telling_covariate(diagnosis, curves)
    if curves is not None and covariate is not None:
        title = f"{spoken(curves.result).capitalize()} over {spoken(covariate.name)}"
        caption = f"{title}. Below: what the model misses.{figures.thinning_words(diagnosis, curves)}"
        view = drawn.view(title, partial(figures.convincing, diagnosis, curves, covariate), caption)
        yield Chapter(title, (view,), "key-figure")
    if diagnosis.causes:
        labels, texts = zip(*((spoken(each.effect), remedy_of(diagnosis, each.effect)) for each in diagnosis.causes),
                            strict=True)  # fmt: skip
        doubt = () if diagnosis.verdict == "named" else (Paragraph(DOUBT),)
        yield Chapter("What to do", (*doubt, Items("findings", texts, labels)), "what-to-do")


def questions(diagnosis: DiagnosisResult) -> dict[str, tuple[str, ...]]:
    """Return what a diagnosis says to each of its questions, line by line."""
    chapters = diagnosis_chapters(diagnosis, Figures(skipped=True))
    return {
        chapter.title.removesuffix(" measurement"): chapter.lines for chapter in chapters if chapter.ident != "data"
    }


def data_line(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, how long it took, and which model it was held against."""
    time = next((covariate for covariate in diagnosis.records.covariates.values() if covariate.role == "time"), None)
    lasting = ""
    if time is not None:
        hours = Amount(float(np.nanmax(time.values) - np.nanmin(time.values)), time.unit)
        lasting = f", {amount_text(hours)}"
    model = diagnosis.setup.model
    return (
        f"{data_words(diagnosis)}{lasting}; {model.name}: {model.title}, {len(diagnosis.calibrated)} inputs calibrated"
    )


def data_words(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, in a line."""
    records = diagnosis.records
    runs = len(set(records.run_of.tolist()))
    in_files = sum(count.in_file for count in records.counts)
    of_all = f" of {in_files}" if in_files > len(records) else ""
    counted = f"{len(records)}{of_all} rows, {runs} run{'' if runs == 1 else 's'}"
    return f"{', '.join(file_labels(records.files))}: {counted}"


# The chapters of a diagnosis: what is wrong, why, the extended model, its worth, what to measure next, the data


MOST_OUTLIERS = 12
FITTED_DIGITS = 7
EVERYTHING = "extended.toml"
MOST_SEEN, MOST_MOVED, FEW_OUTLIERS = 8, 4, 5
"""So many effects, inputs and outliers a terminal names at most."""
WEAK = 10.0
"""A rival that loses less fit than this is not worth a line of its own."""
ChapterParts: TypeAlias = Iterator[BlockView | str]
"""What a chapter says: blocks for the sheet, and the lines that a terminal and a notebook print instead."""
HEADS = ("Cause", "Unknown", "Value", "95 % interval", "Unit")


def diagnosis_chapters(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[Chapter]:
    """Write the chapters in the order in which they are asked for."""
    chapters: dict[str, tuple[str, ChapterParts]] = {
        "wrong": ("What is wrong", _wrong(diagnosis, drawn)),
        "cause": ("Cause", _cause(diagnosis, drawn)),
        "model": ("Extended model", _model(diagnosis)),
        "gain": ("Gain", _gain(diagnosis, drawn)),
        "next": ("Next measurement", _next(diagnosis)),
        "data": ("Data", _data(diagnosis)),
    }
    for ident, (title, parts) in chapters.items():
        said = list(parts)
        lines = tuple(part for part in said if isinstance(part, str))
        yield Chapter(title, tuple(part for part in said if not isinstance(part, str)), ident, lines=lines)


def _both(line: str) -> ChapterParts:
    """Say a line on the terminal, and on the sheet as a sentence."""
    sentence = line.strip().rstrip(".")
    yield line
    yield Paragraph(f"{sentence[:1].upper()}{sentence[1:]}.")


# What is wrong


def _wrong(diagnosis: DiagnosisResult, drawn: Figures) -> ChapterParts:
    errors, findings, noises = [], [], []
    for wrong in diagnosis.wrong:
        name, noise = spoken(wrong.result), wrong.noise
        rmse, floor, share = amount_text(wrong.rmse), amount_text(wrong.noise_floor), percent(wrong.reducible_share)
        errors.append((name, str(wrong.rows), rmse, floor, share))
        against = f"RMS error {rmse} against a noise floor of {floor}"
        yield f"{name}: {against}: {share} of the mean square error is reducible"
        for finding in wrong.findings:
            text, sure = prose(finding.text), certainty(finding.p_value)
            findings.append((name, finding.kind, text, sure))
            yield f"  {finding.kind}: {text}" + (f" – {sure}" if finding.p_value is not None else "")
        correlation = pretty(format_number(noise.autocorrelation, 2))
        far = _outliers(noise, MOST_OUTLIERS) or "none"
        noises.append((name, amount_text(noise.sd), correlation, noise.tails, noise.spread, far))
        count = len(noise.outliers)
        few = f"; {count} suspected outlier{'s' * (count > 1)} ({_outliers(noise, FEW_OUTLIERS)})" if count else ""
        yield f"  noise: autocorrelation {correlation}, tails {noise.tails}, spread {noise.spread}{few}"
    heads = ("Result", "Rows", "RMS error", "Noise floor", "Reducible")
    note = (
        "The error is that of the model calibrated within its tolerances. Reducible is the share of the mean square "
        "error that lies above the noise floor."
    )
    yield table_of("Error of the model as it is", heads, errors, (1, 2, 3, 4), note)
    if findings:
        kinds = ("Result", "Kind", "What the residuals show", "How sure, the search paid for")
        yield table_of("Structure in the residuals", kinds, findings)
    else:
        yield Paragraph("At the level of 5 % the residuals show no bias, trend, order, step, wave or spread.")
    about = ("Result", "Standard deviation", "Autocorrelation", "Tails", "Spread", "Suspected outliers")
    yield table_of("The noise, once everything found is taken out", about, noises, (1, 2))
    yield from _measured(diagnosis, drawn)


def _outliers(noise: NoiseSummary, most: int) -> str:
    """Name the rows of suspected outliers, so many at most."""
    names = list(dict.fromkeys(file for file, _ in noise.outliers))
    labels = dict(zip(names, file_labels(names), strict=True))
    places = [f"{labels[file]}:{line}" for file, line in noise.outliers]
    more = f" and {len(places) - most} more" if len(places) > most else ""
    return ", ".join(places[:most]) + more


def _measured(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    for curves in figures.shown_curves(diagnosis):
        title = f"Measured {spoken(curves.result)} against simulated"
        colours = " Red circles before, blue points after." if figures.has_changed(curves) else ""
        caption = f"{title}: as it is on the left, the difference on the right.{colours}"
        caption += figures.thinning_words(diagnosis, curves)
        yield drawn.view(title, partial(figures.against_simulated, diagnosis, curves), caption)


# Cause


def _cause(diagnosis: DiagnosisResult, drawn: Figures) -> ChapterParts:
    verdict = _verdict_line(diagnosis)
    yield verdict
    yield Paragraph(f"Verdict: {verdict}. Its p-value pays for every explanation that was tried.")
    if diagnosis.causes:
        yield from _named(diagnosis)
    yield from _near(diagnosis)
    if diagnosis.ranking:
        yield ranking_table(diagnosis)
        title = "Ranking of the explanations"
        caption = f"{title}; blue is what this data does not exclude."
        yield drawn.view(title, partial(figures.ranking_bars, diagnosis), caption)
    for covariate in figures.main_covariates(diagnosis):
        for curves in figures.shown_curves(diagnosis):
            when = ", before and after" if figures.has_changed(curves) else ""
            title = f"Residuals of {spoken(curves.result)} over {spoken(covariate.name)}{when}"
            caption = f"{title}. The grey band is the noise floor.{figures.thinning_words(diagnosis, curves)}"
            yield drawn.view(title, partial(figures.over_covariate, diagnosis, curves, covariate), caption)
    for sentence in diagnosis.inseparable:
        yield from _both(prose(sentence))
    yield from _sight(diagnosis)


def _verdict_line(diagnosis: DiagnosisResult) -> str:
    if not explanations_of(diagnosis):
        said = "none" if diagnosis.verdict == "none" else f"undecided: {reasons(diagnosis)}"
        return f"{said} ({p_text(diagnosis.p_any)})"
    parts = [spoken(cause.effect) for cause in diagnosis.causes]
    if diagnosis.remainder is not None:
        parts.append(f"unregistered: {prose(diagnosis.remainder.shape)}")
    second = f", of a second cause {p_text(diagnosis.p_second)}" if diagnosis.p_second is not None else ""
    one_of = "; ".join(["", f"one of {len(explanations_of(diagnosis))}", *shared_words(diagnosis)])
    open_ones = {"named": "; unique", "undecided": "; in doubt", "one_of": one_of}
    return f"{' + '.join(parts)} ({p_text(diagnosis.p_any)}{second}{open_ones.get(diagnosis.verdict, '')})"


def _named(diagnosis: DiagnosisResult) -> ChapterParts:
    """Say what the named causes are, what draws the same curve, and of several the shares."""
    rows = []
    for cause in diagnosis.causes:
        effect = diagnosis.setup.model.known_effects.get(cause.effect)
        about = "an input that must lie outside of its tolerance" if cause.effect.startswith("input:") else ""
        about = about or ("" if effect is None else effect.why or effect.looks_like)
        alike = listed([spoken(name) for name in cause.same_as])
        rows.append((spoken(cause.effect), about or ABSENT, alike or "none", percent(cause.share)))
    heads = ("Cause", "What it is", "The same curve on this data", "Share")
    if len(rows) > 1:
        yield f"shares of the correction: {', '.join(f'{name} {share}' for name, *_, share in rows)}"
    for cause, (name, _, alike, _) in zip(diagnosis.causes, rows, strict=True):
        if cause.same_as:
            yield f"the same curve as {name} on this data: {alike}"
    for cause in diagnosis.causes:
        remedy = stated_remedy(diagnosis, cause.effect)
        if remedy:
            yield f"what to do about {spoken(cause.effect)}: {remedy}"
    shown = slice(None) if len(rows) > 1 else slice(-1)
    note = "Share: of the mean squares of what the named causes add to the model, over all rows in units of the noise."
    yield table_of("Named", heads[shown], [row[shown] for row in rows], (3,), note if len(rows) > 1 else "")


def _near(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say which explanations are not excluded, and which is the next behind them: none that adds to the named one."""
    named = {cause.effect for cause in diagnosis.causes}
    said = [alternative.causes for alternative in diagnosis.alternatives]
    behind = [
        alternative
        for alternative in diagnosis.ranking
        if alternative.causes and alternative.behind > 0 and alternative.causes not in said
        if alternative.separation >= WEAK and not (named and named <= set(alternative.causes))
    ]
    rivals = [("not excluded", alternative) for alternative in diagnosis.alternatives]
    if explanations_of(diagnosis):
        rivals += [("next best", alternative) for alternative in behind[:1]]
    for word, rival in rivals:
        distance = f"{rival.behind:.1f} score units behind, λ {score_text(rival.separation)}"
        yield f"{word}: {explanation(rival)}, {distance}"


def ranking_table(diagnosis: DiagnosisResult) -> TableView:
    """Say the explanations that were compared, and what this data makes of each."""
    rows = [
        (explanation(each), pretty(f"{each.behind:.1f}"), score_text(each.separation), _judged(each, diagnosis))
        for each in figures.shown_ranking(diagnosis)
    ]
    note = (
        "Behind is the distance in score units (6 is a Bayes factor of about 20). λ is the loss of fit to expect if "
        f"the best explanation is true and this one is fitted: from {APART:.0f} on the two can be told apart."
    )
    return table_of("Explanations, best first", ("Explanation", "Behind", "λ", "On this data"), rows, (1, 2), note)


def _judged(alternative: Alternative, diagnosis: DiagnosisResult) -> str:
    """Say what this data makes of an explanation beside the best one."""
    best = diagnosis.ranking[0]
    if alternative == best:
        return "best"
    if figures.is_open(alternative, diagnosis):
        return "not excluded"
    if best.causes and set(best.causes) < set(alternative.causes):
        return "adds nothing"
    return "excluded" if alternative.behind >= figures.NEAR else "needs more for the same"


def _sight(diagnosis: DiagnosisResult) -> ChapterParts:
    """Say what this data could show: how small each effect may be, what is hidden, what was not excited or measured."""
    lacking = [(spoken(effect), listed(list(needs))) for effect, needs in diagnosis.not_measured.items()]
    named = {cause.effect for cause in diagnosis.causes}
    blind: dict[str, list[str]] = {"not excited": [], "cannot be fitted": [], "hidden in the tolerances": []}
    visible: dict[str, str] = {}
    rows = []
    for size in diagnosis.seen:
        name, smallest, effect = spoken(size.name), amount_text(readable(size.smallest)), size.name.partition(".")[0]
        rows.append((name, smallest, str(size.sight), size.text))
        if effect in named:
            continue
        if size.sight in blind:
            is_hidden = size.sight == "hidden in the tolerances" and size.smallest is not None
            remark = size.text or (f"visible from {smallest}" if is_hidden else "")
            blind[size.sight].append(f"{name} ({remark})" if remark else name)
        elif size.smallest is not None:
            visible.setdefault(effect, f"{name} {smallest}")
    yield from (f"{sight}: {_some(names)}" for sight, names in blind.items() if names)
    if lacking:
        yield f"not measured: {'; '.join(f'{effect} ({needs})' for effect, needs in lacking)}"
    if visible:
        yield f"would have been seen from: {_some(list(visible.values()))}"
    rows += [(effect, ABSENT, "not measured", f"no column gives {needs}") for effect, needs in lacking]
    if rows:
        note = "Smallest visible: with a chance of 90 % this size is found, every explanation that is tried paid for."
        yield table_of("What this data can show", ("Effect", "Smallest visible", "Sight", "Remark"), rows, (1,), note)


def _some(texts: Sequence[str]) -> str:
    return "; ".join(texts[:MOST_SEEN]) + ("; the sheet lists all" if len(texts) > MOST_SEEN else "")


# Extended model


def _model(diagnosis: DiagnosisResult) -> ChapterParts:
    yield from _sizes(diagnosis)
    fitted = fitted_table(diagnosis)
    if fitted.rows:
        yield fitted
    if diagnosis.calibrated:
        note = "Within its tolerance an input may move freely; what matters is how far, in standard deviations."
        yield table_of(
            "Inputs as fitted to this machine", ("Input", "Nominal", "Fitted", "Moved, in its sd"),
            list(_calibrated(diagnosis)), (1, 2, 3), note,
        )  # fmt: skip
    if diagnosis.causes or diagnosis.calibrated:
        name = diagnosis.setup.model.name
        yield Paragraph(f"{EVERYTHING} holds all of it; every verb accepts it: calc run {name} --inputs {EVERYTHING}.")
    remainder = diagnosis.remainder
    if remainder is not None:
        yield Paragraph(
            f"The remainder ({prose(remainder.shape)}) is in no inputs file. new_effect.py holds its fitted shape as "
            "an effect, ready to be made physical. It must not be extrapolated beyond the measured range."
        )


def _sizes(diagnosis: DiagnosisResult) -> ChapterParts:
    if not diagnosis.causes:
        yield from _both("nothing was named: the model stands as it is")
    for cause in diagnosis.causes:
        yield cause_text(cause)
    for alternative in diagnosis.alternatives:
        sizes = [fitted_text(unknown) for unknowns in alternative.unknowns.values() for unknown in unknowns]
        if sizes:
            yield from _both(f"or {explanation(alternative)}, {'; '.join(sizes)}")
    moved = lowest_first(diagnosis.calibrated, lambda calibrated: -abs(calibrated.of_its_sd))[:MOST_MOVED]
    if moved:
        shifts = ", ".join(f"{spoken(calibrated.name)} by {score_text(calibrated.of_its_sd)}" for calibrated in moved)
        yield f"moved most within their tolerances (in standard deviations): {shifts}"


def fitted_table(diagnosis: DiagnosisResult) -> TableView:
    """Say the size of every cause that is named, with its interval."""
    fitted = [(spoken(cause.effect), unknown) for cause in diagnosis.causes for unknown in cause.unknowns]
    rows = [row for name, unknown in fitted for row in _fitted(name, unknown)]
    return table_of("Unknowns as fitted", HEADS, rows, (2, 3), "Intervals hold if the named cause is the true one.")


def _fitted(cause: str, unknown: FittedUnknown) -> Iterator[tuple[str, ...]]:
    """Write an unknown as rows: one, or one for each file where every file has its own."""
    labels = dict(zip(unknown.per_file, file_labels(list(unknown.per_file)), strict=True))
    fits = {f", {labels[file]}": fit for file, fit in unknown.per_file.items()}
    for suffix, fit in (fits or {"": (unknown.value, unknown.low, unknown.high)}).items():
        value, low, high, unit = number_texts(unknown, fit)
        yield cause, unknown.name.replace("_", " ") + suffix, value, f"{low} … {high}", unit or ABSENT


def _calibrated(diagnosis: DiagnosisResult) -> Iterator[tuple[str, ...]]:
    for calibrated in diagnosis.calibrated:
        nominal, size = float(diagnosis.setup.nominal(calibrated.name)), Amount(calibrated.value, calibrated.unit)
        fitted = amount_text(size, FITTED_DIGITS) if nominal else amount_text(readable(size))
        stated = amount_text(Amount(nominal, calibrated.unit), STATED_DIGITS)
        yield spoken(calibrated.name), stated, fitted, score_text(calibrated.of_its_sd)


# Gain


def _gain(diagnosis: DiagnosisResult, drawn: Figures) -> ChapterParts:
    if not diagnosis.gain:
        yield Paragraph("No gain was estimated.")
        return
    rows, held = [], []
    for gain in diagnosis.gain:
        name, floor, removed = spoken(gain.result), amount_text(gain.noise_floor), percent(gain.reducible_removed)
        before, after = amount_text(gain.rmse_before), amount_text(gain.rmse_after)
        score, covered = score_text(gain.log_score_gain), percent(gain.coverage90)
        p_value = pretty(format_number(gain.p_value, 2))
        rows.append((name, before, after, floor, removed, score, p_value, covered))
        yield (
            f"{name}: RMS error {before} → {after} (noise floor {floor}) on rows not fitted; {removed} of the "
            f"reducible error removed; log score {score} per row, {p_text(gain.p_value)}; "
            f"90 % intervals cover {covered}"
        )
        if gain.held_out is not None:
            before, after = (amount_text(replace(gain.rmse_before, value=value)) for value in gain.held_out)
            held.append((name, before, after))
            yield f"{name}: RMS error {before} → {after} on the rows held out on request"
    heads = ("Result", "Before", "After", "Noise floor", "Removed", "Log score per row", "p", "Coverage")
    note = (
        "RMS errors on rows that were not fitted: the whole diagnosis is repeated in every fold of a blocked "
        "cross-validation and compared with the model calibrated in the same fold. Removed is the share of the "
        "reducible error. Coverage is that of the 90 % prediction intervals."
    )
    yield table_of("What the extension is worth", heads, rows, tuple(range(1, 8)), note)
    if diagnosis.causes:
        yield from _both(f"the same causes in {percent(diagnosis.stability)} of the folds")
    if held:
        yield table_of("On the rows that were held out on request", ("Result", "Before", "After"), held, (1, 2))
    title = "Error before and after, and the noise floor"
    yield drawn.view(title, partial(figures.gain_bars, diagnosis), f"{title}, on rows that were not fitted.")


# Next measurement


def _next(diagnosis: DiagnosisResult) -> ChapterParts:
    """Write the chapter on the next measurement."""
    if diagnosis.next:
        yield from _points(diagnosis)
    for tie in diagnosis.ties:
        yield from _both(tie_text(tie).rstrip("."))
    if not diagnosis.next and not diagnosis.ties:
        yield from _both("nothing to separate" if diagnosis.unique else "no setting is proposed")


def _points(diagnosis: DiagnosisResult) -> ChapterParts:
    """Write the further results and the experiment, with its readings as a table to be taken to the machine."""
    ways = [_results, _experiment]
    for way in ways if is_result_first(diagnosis) else reversed(ways):
        yield from way(diagnosis)


def _results(diagnosis: DiagnosisResult) -> ChapterParts:
    for point in (point for point in diagnosis.next if point.measure):
        then = f"(λ then {score_text(point.separation)})"
        yield from _both(f"measure {settings_text(point)}: {pair_text(point)} {then}")
        yield from _both(f"   {point.why}")


def _experiment(diagnosis: DiagnosisResult) -> ChapterParts:
    experiment, readings = diagnosis.experiment, [point for point in diagnosis.next if not point.measure]
    if experiment is None or not readings:
        return
    yield from _both(experiment_text(experiment))
    yield from _both(f"   {max(readings, key=lambda point: len(point.why)).why}")
    yield readings_table(experiment, [point.separation for point in readings])


def readings_table(experiment: Experiment, separations: Sequence[float] = ()) -> TableView:
    """Write the readings of an experiment, with the separation to expect after each, and what its chance means."""
    names = list(experiment.settings)
    units = experiment.units
    rows = [
        (
            str(index + 1),
            *(amount_text(Amount(float(experiment.settings[name][index]), units[name]), 4) for name in names),
            *(score_text(each) for each in separations[index : index + 1]),
        )
        for index in range(experiment.readings)
    ]
    chance = experiment.chance
    note = f"The chance is that of {chance.draws} simulated experiments, each explanation true in turn: {chance.by}."
    if separations:
        note += f" λ then is the separation to expect after a reading; from {APART:.0f} on all are told apart."
    heads = ("Reading", *(spoken(name).capitalize() for name in names), *(["λ then"] if separations else []))
    return table_of("Readings to take", heads, rows, (*range(1, len(heads)),), note)


# Data


def _data(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    records = diagnosis.records
    rows = []
    for index, label in enumerate(file_labels(records.files)):
        of_file = records.file_of == index
        count, runs = records.counts[index], len(set(records.run_of[of_file].tolist()))
        rows.append((label, str(count.in_file), str(count.used), str(count.unused), str(runs)))
    held = int(records.held_out.sum())
    note = f"{held} rows were held out: they judge and were not fitted." if held else ""
    yield table_of("Files", ("File", "Rows in the file", "Used", "Left out", "Runs"), rows, (1, 2, 3, 4), note)
    for label, count in zip(file_labels(records.files), records.counts, strict=True):
        if count.unused:
            yield Paragraph(f"{label}: {count.sentence()}.")
    covariates = []
    for covariate in records.covariates.values():
        finite = covariate.values[np.isfinite(covariate.values)]
        ends = (float(finite.min()), float(finite.max())) if finite.size else ()
        low, high = (amount_text(Amount(end, covariate.unit), 4) for end in ends) if ends else (ABSENT, ABSENT)
        missing = len(covariate.values) - finite.size
        remarks = ["never changes"] * covariate.is_constant + [f"{missing} missing"] * (missing > 0)
        covariates.append((spoken(covariate.name), low, high, covariate.role, ", ".join(remarks) or ABSENT))
    yield table_of("Covariates", ("Name", "From", "To", "Role", "Remark"), covariates, (1, 2))
    for sentence in records.notes:
        yield Paragraph(sentence.rstrip(".") + ".")
