"""diagnosis.json: what a diagnosis found, as data. It names no date and no machine, so that equal ones are equal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import PurePath
from typing import Any

from truing.diagnosis.result import (
    Alternative,
    Amount,
    Cause,
    DiagnosisResult,
    FittedUnknown,
    Gain,
    NextPoint,
    Tie,
    Wrong,
    doubts,
    explanations_of,
    shared_of,
)
from truing.runs.documents import clean
from truing.runs.provenance import provenance_of
from truing.units import from_si

SCHEMA = "truing.diagnosis/1"


def diagnosis_document(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Return diagnosis.json as data: the same inputs, records, seed and versions give the same document.

    Numbers are in the unit that stands beside them; one that is not finite, and an open end of an interval, is null.
    Coefficients of a remainder's terms are SI, as their expressions are.
    """
    provenance, model = provenance_of(diagnosis.setup), diagnosis.setup.model.name
    return {
        "schema": SCHEMA,
        "plugin": {"name": provenance.plugin, "version": provenance.plugin_version, "model": model},
        "kernel": provenance.kernel,
        "input_hash": provenance.input_hash,
        "seed": provenance.seed,
        **_data(diagnosis),
        "wrong": {wrong.result: _wrong(wrong, _labels(diagnosis)) for wrong in diagnosis.wrong},
        "verdict": diagnosis.verdict,
        "explanations": [list(names) for names in explanations_of(diagnosis)],
        "shared": list(shared_of(diagnosis)),
        "undecided": list(doubts(diagnosis)) if diagnosis.verdict == "undecided" else [],
        "p_any": clean(diagnosis.p_any),
        "p_second": clean(diagnosis.p_second),
        "causes": [_cause(cause, _labels(diagnosis)) for cause in diagnosis.causes],
        "unique": bool(diagnosis.unique),
        "alternatives": [_alternative(alternative) for alternative in diagnosis.alternatives],
        "ranking": [_alternative(alternative) for alternative in diagnosis.ranking],
        "inseparable": list(diagnosis.inseparable),
        "remainder": None if diagnosis.remainder is None else clean(asdict(diagnosis.remainder)),
        **_sight(diagnosis),
        "calibrated": _calibrated(diagnosis),
        "gain": {**{gain.result: _gain(gain) for gain in diagnosis.gain}, "stability": clean(diagnosis.stability)},
        "next": [_next(point) for point in diagnosis.next],
        "ties": [_tie(tie) for tie in diagnosis.ties],
        **_alarming(diagnosis),
        "notes": list(diagnosis.records.notes),
        "unit_slips": [clean(asdict(unit_error)) for unit_error in diagnosis.records.unit_errors],
        "warnings": list(diagnosis.warnings),
    }


def _alarming(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say where parts of the record contradict one another, and which causes trade against inputs."""
    return {
        "contradictions": [
            {"effect": one.effect, "unknown": one.unknown, "first": _amount(one.first), "second": _amount(one.second)}
            for one in diagnosis.contradictions
        ],
        "thinned": [clean(asdict(half)) for half in diagnosis.thinned],
        "trades": [clean(asdict(trade)) for trade in diagnosis.trades],
    }


def _calibrated(diagnosis: DiagnosisResult) -> dict[str, Any]:
    return {
        calibrated.name: {**_value(calibrated.value, calibrated.unit), "of_its_sd": clean(calibrated.of_its_sd)}
        for calibrated in diagnosis.calibrated
    }


def file_labels(files: Sequence[str]) -> list[str]:
    """Return how data files are named: without their folders where that tells them apart."""
    names = [PurePath(file.replace("\\", "/")).name for file in files]
    return names if len(set(names)) == len(names) else list(files)


def _labels(diagnosis: DiagnosisResult) -> Mapping[str, str]:
    return dict(zip(diagnosis.records.files, file_labels(diagnosis.records.files), strict=True))


def _data(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say what was measured: results, files with their rows and runs, rows that only judge."""
    records = diagnosis.records
    files = []
    for index, label in enumerate(file_labels(records.files)):
        of_file = records.file_of == index
        runs = len(set(records.run_of[of_file].tolist()))
        files.append({"file": label, **records.counts[index].as_json(), "runs": runs})
    return {
        "measured": list(diagnosis.measured),
        "rows": len(records),
        "runs": len(set(records.run_of.tolist())),
        "files": files,
        "held_out": int(records.held_out.sum()),
        "covariates": {
            covariate.name: {"unit": covariate.unit, "role": covariate.role, "constant": covariate.is_constant}
            for covariate in records.covariates.values()
        },
    }


def _value(value: float | None, unit: str) -> dict[str, Any]:
    return {"value": _in(value, unit), "unit": unit}


def _in(value: float | None, unit: str) -> float | None:
    """Bring an SI number to a unit; what is no finite number is None."""
    number: float | None = None if value is None else clean(float(from_si(float(value), unit)))
    return number


def _amount(amount: Amount) -> dict[str, Any]:
    return _value(amount.value, amount.unit)


def _wrong(wrong: Wrong, labels: Mapping[str, str]) -> dict[str, Any]:
    noise = wrong.noise
    return {
        "rows": wrong.rows,
        "rmse": _amount(wrong.rmse),
        "noise_floor": _amount(wrong.noise_floor),
        "stated_noise": None if wrong.stated is None else _amount(wrong.stated),
        "reducible_share": clean(wrong.reducible_share),
        "noise": {
            "sd": _amount(noise.sd),
            "autocorrelation": clean(noise.autocorrelation),
            "ar_coefficient": clean(noise.ar_coefficient),
            "tails": noise.tails,
            "spread": noise.spread,
            "outliers": [{"file": labels.get(file, file), "line": int(line)} for file, line in noise.outliers],
        },
        "findings": [
            {
                "kind": finding.kind,
                "covariate": finding.covariate,
                "p_value": clean(finding.p_value),
                "text": finding.text,
            }
            for finding in wrong.findings
        ],
    }


def _cause(cause: Cause, labels: Mapping[str, str]) -> dict[str, Any]:
    return {
        "effect": cause.effect,
        "unknowns": {unknown.name: _unknown(unknown, labels) for unknown in cause.unknowns},
        "same_as": list(cause.same_as),
        "share": clean(cause.share),
    }


def _unknown(unknown: FittedUnknown, labels: Mapping[str, str] | None = None) -> dict[str, Any]:
    said = _fitted((unknown.value, unknown.low, unknown.high), unknown.unit)
    if unknown.per_file:
        names = labels or {}
        said["per_file"] = {
            names.get(file, file): _fitted(fitted, unknown.unit) for file, fitted in unknown.per_file.items()
        }
    return said


def _fitted(fitted: tuple[float, float | None, float | None], unit: str) -> dict[str, Any]:
    value, low, high = fitted
    return {**_value(value, unit), "interval95": [_in(low, unit), _in(high, unit)]}


def _alternative(alternative: Alternative) -> dict[str, Any]:
    return {
        "causes": list(alternative.causes),
        "behind": clean(alternative.behind),
        "separation": clean(alternative.separation),
        "depends_on": list(alternative.depends_on),
        "unknowns": {
            effect: {unknown.name: _unknown(unknown) for unknown in unknowns}
            for effect, unknowns in alternative.unknowns.items()
        },
        "same_as": {effect: list(names) for effect, names in alternative.same_as.items()},
    }


def _sight(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say what this data could show, and what it could not."""
    seen = diagnosis.seen
    return {
        "not_excited": [seen_effect.name for seen_effect in seen if seen_effect.sight == "not excited"],
        "not_fitted": {
            seen_effect.name: seen_effect.text for seen_effect in seen if seen_effect.sight == "cannot be fitted"
        },
        "not_measured": {effect: list(conditions) for effect, conditions in diagnosis.not_measured.items()},
        "hidden_in_tolerances": [
            seen_effect.name for seen_effect in seen if seen_effect.sight == "hidden in the tolerances"
        ],
        "smallest_visible": {
            seen_effect.name: {**_amount(seen_effect.smallest), "sight": seen_effect.sight}
            for seen_effect in seen
            if seen_effect.smallest is not None
        },
    }


def _gain(gain: Gain) -> dict[str, Any]:
    said = {
        "rmse_before": _amount(gain.rmse_before),
        "rmse_after": _amount(gain.rmse_after),
        "noise_floor": _amount(gain.noise_floor),
        "reducible_removed": clean(gain.reducible_removed),
        "log_score_gain": clean(gain.log_score_gain),
        "p_value": clean(gain.p_value),
        "coverage90": clean(gain.coverage90),
    }
    if gain.held_out is not None:
        before, after = gain.held_out
        unit = gain.rmse_before.unit
        said["held_out"] = {"rmse_before": _value(before, unit), "rmse_after": _value(after, unit)}
    return said


def _next(point: NextPoint) -> dict[str, Any]:
    return {
        "settings": {name: _amount(amount) for name, amount in point.settings.items()},
        "measure": list(point.measure),
        "separates": list(point.separates),
        "why": point.why,
        "separation": clean(point.separation),
        "needed": point.needed,
    }


def _tie(tie: Tie) -> dict[str, Any]:
    facts = [
        {"explanation": fact.explanation, "quantity": fact.quantity, "note": fact.note, **_amount(fact.value)}
        for fact in tie.facts
    ]
    return {"explanations": list(tie.explanations), "facts": facts}
