"""A diagnosis in lines: its five questions with a few lines each, for a terminal and a notebook."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from truing.diagnosis.result import Alternative, Amount, DiagnosisResult, VisibleSize, Wrong, explanations_of
from truing.numbers import format_number, pretty
from truing.report.diagnosis_sheet import data_words
from truing.report.diagnosis_words import (
    amount_text,
    cause_text,
    certainty,
    explanation,
    fitted_text,
    listed,
    p_text,
    pair_text,
    percent,
    prose,
    readable,
    reasons,
    score_text,
    settings_text,
    shared_words,
    spoken,
    tie_text,
)

MOST_PLACES = 5
MOST_MOVED = 4
MOST_SEEN = 8
WEAK = 10.0


def questions(diagnosis: DiagnosisResult) -> dict[str, list[str]]:
    """Return what a diagnosis says to each of its five questions, line by line; a line that is indented belongs to
    the one above.
    """
    return {
        "What is wrong": list(_wrong(diagnosis)),
        "Cause": list(_cause(diagnosis)),
        "Extended model": list(_model(diagnosis)),
        "Gain": list(_gain(diagnosis)),
        "Next": list(_next(diagnosis)),
    }


def data_line(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, how long it took, and which model it was held against."""
    time = next((item for item in diagnosis.records.covariates.values() if item.role == "time"), None)
    lasting = ""
    if time is not None:
        hours = Amount(float(np.nanmax(time.values) - np.nanmin(time.values)), time.unit)
        lasting = f", {amount_text(hours)}"
    model = diagnosis.setup.model
    return (
        f"{data_words(diagnosis)}{lasting}; {model.name}: {model.title}, {len(diagnosis.calibrated)} inputs calibrated"
    )


def _wrong(diagnosis: DiagnosisResult) -> Iterator[str]:
    for item in diagnosis.wrong:
        yield (
            f"{spoken(item.result)}: RMS error {amount_text(item.rmse)} against a noise floor of "
            f"{amount_text(item.noise_floor)}: {percent(item.reducible_share)} of the mean square error is reducible"
        )
        for finding in item.findings:
            sure = f" – {certainty(finding.p_value)}" if finding.p_value is not None else ""
            yield f"  {finding.kind}: {prose(finding.text)}{sure}"
        yield f"  noise: {_noise(item)}"


def _noise(item: Wrong) -> str:
    noise = item.noise
    said = (
        f"autocorrelation {pretty(format_number(noise.autocorrelation, 2))}, tails {noise.tails}, spread {noise.spread}"
    )
    if not noise.outliers:
        return said
    places = ", ".join(f"{Path(file).name}:{line}" for file, line in noise.outliers[:MOST_PLACES])
    more = ", …" if len(noise.outliers) > MOST_PLACES else ""
    count = len(noise.outliers)
    return f"{said}; {count} suspected outlier{'s' if count > 1 else ''} ({places}{more})"


def _cause(diagnosis: DiagnosisResult) -> Iterator[str]:
    yield _named(diagnosis)
    if len(diagnosis.causes) > 1:
        shares = [f"{spoken(cause.effect)} {percent(cause.share)}" for cause in diagnosis.causes]
        yield f"shares of the correction: {', '.join(shares)}"
    for cause in diagnosis.causes:
        if cause.same_as:
            names = listed([spoken(name) for name in cause.same_as])
            yield f"the same curve as {spoken(cause.effect)} on this data: {names}"
    for item in diagnosis.alternatives:
        yield f"not excluded: {explanation(item)}{_distance(item)}"
    rivals = _rivals(diagnosis)
    if rivals and explanations_of(diagnosis):
        yield f"next best: {explanation(rivals[0])}{_distance(rivals[0])}"
    yield from map(prose, diagnosis.inseparable)
    yield from _sight(diagnosis)


def _rivals(diagnosis: DiagnosisResult) -> list[Alternative]:
    """Return the explanations behind those that are not excluded, without those that only add to the named one."""
    named = {cause.effect for cause in diagnosis.causes}
    said = [item.causes for item in diagnosis.alternatives]
    rivals = [item for item in diagnosis.ranking if item.causes and item.behind > 0 and item.causes not in said]
    return [item for item in rivals if item.separation >= WEAK and not (named and named <= set(item.causes))]


def _named(diagnosis: DiagnosisResult) -> str:
    if not explanations_of(diagnosis):
        said = "none" if diagnosis.verdict == "none" else f"undecided: {listed(list(reasons(diagnosis)))}"
        return f"{said} ({p_text(diagnosis.p_any)})"
    parts = [spoken(cause.effect) for cause in diagnosis.causes]
    if diagnosis.remainder is not None:
        parts.append(f"unregistered: {prose(diagnosis.remainder.shape)}")
    second = f", of a second cause {p_text(diagnosis.p_second)}" if diagnosis.p_second is not None else ""
    one_of = "; ".join(["", f"one of {len(explanations_of(diagnosis))}", *shared_words(diagnosis)])
    open_ones = {"named": "; unique", "undecided": "; in doubt", "one_of": one_of}
    return f"{' + '.join(parts)} ({p_text(diagnosis.p_any)}{second}{open_ones.get(diagnosis.verdict, '')})"


def _distance(item: Alternative) -> str:
    return f", {item.behind:.1f} score units behind, λ {score_text(item.separation)}"


def _sight(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say what this data could not show, and the smallest size of what it could."""
    named = {cause.effect for cause in diagnosis.causes}
    others = [item for item in diagnosis.seen if item.name.partition(".")[0] not in named]
    for sight in ("not excited", "cannot be fitted", "hidden in the tolerances"):
        found = [_blind(item) for item in others if item.sight == sight]
        if found:
            more = "; the sheet lists all" if len(found) > MOST_SEEN else ""
            yield f"{sight}: {'; '.join(found[:MOST_SEEN])}{more}"
    lacking = [f"{spoken(effect)} ({listed(list(needs))})" for effect, needs in diagnosis.not_measured.items()]
    if lacking:
        yield f"not measured: {'; '.join(lacking)}"
    visible: dict[str, str] = {}
    for item in others:
        if item.sight == "visible" and item.smallest is not None:
            visible.setdefault(
                item.name.partition(".")[0], f"{spoken(item.name)} {amount_text(readable(item.smallest))}"
            )
    if visible:
        more = "; the sheet lists all" if len(visible) > MOST_SEEN else ""
        yield f"would have been seen from: {'; '.join(list(visible.values())[:MOST_SEEN])}{more}"


def _blind(item: VisibleSize) -> str:
    """Say what could not be seen, and from what size it would be."""
    visible = f"visible from {amount_text(readable(item.smallest))}" if item.smallest is not None else ""
    remark = item.text or (visible if item.sight == "hidden in the tolerances" else "")
    return f"{spoken(item.name)} ({remark})" if remark else spoken(item.name)


def _model(diagnosis: DiagnosisResult) -> Iterator[str]:
    if not diagnosis.causes:
        yield "nothing was named: the model stands as it is"
    for cause in diagnosis.causes:
        yield cause_text(cause)
    for item in diagnosis.alternatives:
        sizes = [fitted_text(unknown) for unknowns in item.unknowns.values() for unknown in unknowns]
        if sizes:
            yield f"or {explanation(item)}, {'; '.join(sizes)}"
    moved = sorted(diagnosis.calibrated, key=lambda item: -abs(item.of_its_sd))[:MOST_MOVED]
    if moved:
        shifts = ", ".join(f"{spoken(item.name)} by {score_text(item.of_its_sd)}" for item in moved)
        yield f"moved most within their tolerances (in standard deviations): {shifts}"


def _gain(diagnosis: DiagnosisResult) -> Iterator[str]:
    for item in diagnosis.gain:
        yield (
            f"{spoken(item.result)}: RMS error {amount_text(item.rmse_before)} → {amount_text(item.rmse_after)} (noise "
            f"floor {amount_text(item.noise_floor)}) on rows not fitted; {percent(item.reducible_removed)} of the "
            f"reducible error removed; log score {score_text(item.log_score_gain)} per row, "
            f"{p_text(item.p_value)}; 90 % intervals cover {percent(item.coverage90)}"
        )
        if item.held_out is not None:
            before, after = (amount_text(replace(item.rmse_before, value=one)) for one in item.held_out)
            yield f"{spoken(item.result)}: RMS error {before} → {after} on the rows held out on request"
    if diagnosis.causes:
        yield f"the same causes in {percent(diagnosis.stability)} of the folds"


def _next(diagnosis: DiagnosisResult) -> Iterator[str]:
    for index, point in enumerate(diagnosis.next, start=1):
        yield f"{index}. {settings_text(point)}: {pair_text(point)} (λ then {score_text(point.separation)})"
    for reason in dict.fromkeys(point.why for point in diagnosis.next if point.why):
        yield f"   {reason}"
    yield from (tie_text(tie).rstrip(".") for tie in diagnosis.ties)
    if not diagnosis.next and not diagnosis.ties:
        yield "nothing to separate" if diagnosis.unique else "no setting is proposed"
