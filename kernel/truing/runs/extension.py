"""extended.toml: the model that is now true, as an inputs file that every verb accepts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from truing.diagnosis.records import file_labels
from truing.diagnosis.result import Cause, DiagnosisResult, FittedUnknown, explanations_of
from truing.numbers import format_number
from truing.runs.inputs_written import comment_lines, complete_inputs
from truing.setup import Setup
from truing.units import from_si


def extended_setup(diagnosis: DiagnosisResult) -> Setup | None:
    """Return the setup that the diagnosis leaves: causes on, inputs calibrated; None where neither is."""
    if diagnosis.extended is not None or not diagnosis.calibrated:
        return diagnosis.extended
    fitted = {calibrated.name: calibrated.value for calibrated in diagnosis.calibrated}
    return replace(diagnosis.setup, calibrated={**diagnosis.setup.calibrated, **fitted})


def extended_text(diagnosis: DiagnosisResult, folder: Path | None = None) -> str:
    """Write the extended model as an inputs file; nothing where nothing was named or calibrated.

    ``folder`` is where the text will stand: data files are named as seen from there.
    """
    setup = extended_setup(diagnosis)
    if setup is None:
        return ""
    lines = _comment(_head(diagnosis))
    for line in complete_inputs(setup, folder).splitlines():
        if line.startswith("["):
            lines += _comment(_of_section(line.strip("[]"), diagnosis))
        lines.append(line)
    return "\n".join(lines) + "\n"


def _comment(sentences: Iterator[str]) -> list[str]:
    return [line for sentence in sentences for line in comment_lines(sentence)]


def _head(diagnosis: DiagnosisResult) -> Iterator[str]:
    model = diagnosis.setup.model.name
    files = ", ".join(file_labels(diagnosis.records.files))
    yield f"{model} as measured: what calc diagnose made of {files} ({len(diagnosis.records)} rows)."
    if diagnosis.causes:
        names = " and ".join(cause.effect for cause in diagnosis.causes)
        count = len(explanations_of(diagnosis))
        others = f", one of {count} explanations; the record cannot say which" if count > 1 else ""
        yield f"Named: {names}{others}."
        for cause in diagnosis.causes:
            if cause.same_as:
                yield f"The same curve as {cause.effect} on this data: {' and '.join(cause.same_as)}."
    for alternative in diagnosis.alternatives[:4]:
        yield f"Not excluded: {' and '.join(alternative.causes)}, {alternative.behind:.1f} score units behind."
    if diagnosis.remainder is not None:
        where = ", ".join(diagnosis.remainder.depends_on)
        yield f"Not in this file: an unregistered remainder over {where}; new_effect.py holds its shape."
    yield "Standard deviations stand beside the values; a covariance is over the unknowns in their declared order."
    yield f"Run it: calc run {model} --inputs THIS_FILE"


def _of_section(name: str, diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say of a section what the diagnosis put there."""
    if name == "calibrated":
        yield (
            "Inputs as fitted to this one machine, within their tolerances. table and diagnose use them; run and its "
            "studies draw machines from the tolerances and do not."
        )
        for moved in diagnosis.calibrated:
            yield f"{moved.name}: moved by {moved.of_its_sd:+.2f} of its standard deviation."
    if name == "conditions":
        yield "Conditions as they were measured; what is drawn or changed is your choice."
    for cause in diagnosis.causes:
        if name == f"effects.{cause.effect}":
            yield from _of_cause(cause, diagnosis)


def _of_cause(cause: Cause, diagnosis: DiagnosisResult) -> Iterator[str]:
    effect = diagnosis.setup.model.known_effects.get(cause.effect)
    about = "" if effect is None else effect.why or effect.looks_like
    yield f"Found by diagnosis{': ' + about if about else ''}."
    labels = dict(zip(diagnosis.records.files, file_labels(diagnosis.records.files), strict=True))
    for unknown in cause.unknowns:
        if not unknown.per_file:
            yield f"{unknown.name}: {_interval(unknown.low, unknown.high, unknown)}."
            continue
        yield f"{unknown.name}: fitted for each file alone; their mean stands here, write that of the file you mean."
        for file, (value, low, high) in unknown.per_file.items():
            fitted = format_number(from_si(value, unknown.unit))
            yield f"{labels.get(file, file)}: {fitted}, {_interval(low, high, unknown)}."
    if cause.same_as:
        yield f"The same curve on this data: {', '.join(cause.same_as)}."


def _interval(low: float | None, high: float | None, unknown: FittedUnknown) -> str:
    ends = ("open" if end is None else format_number(from_si(end, unknown.unit)) for end in (low, high))
    return f"95 % interval from {' to '.join(ends)} {unknown.unit}".rstrip()
