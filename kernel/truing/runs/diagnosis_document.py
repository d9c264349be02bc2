"""diagnosis.json: what a diagnosis found, as data. It names no date and no machine, so that equal ones are equal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from truing.diagnosis.records import file_labels
from truing.diagnosis.result import (
    Amount,
    Cause,
    DiagnosisResult,
    Experiment,
    FittedUnknown,
    Gain,
    Wrong,
    doubts,
    explanations_of,
    shared_of,
    stated_remedy,
)
from truing.experiments.planning import Planned
from truing.runs.documents import clean
from truing.runs.provenance import provenance_of
from truing.units import difference_unit, from_si

SCHEMA, PLAN_SCHEMA = "truing.diagnosis/1", "truing.plan/1"


def diagnosis_document(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Return diagnosis.json as data: the same inputs, records, seed and versions give the same document.

    Numbers are in the unit that stands beside them; one that is not finite, and an open end of an interval, is null.
    Coefficients of a remainder's terms are SI, as their expressions are.
    """
    provenance, records = provenance_of(diagnosis.setup), diagnosis.records
    labels = dict(zip(records.files, file_labels(records.files), strict=True))
    return {
        "schema": SCHEMA,
        "plugin": {
            "name": provenance.plugin,
            "version": provenance.plugin_version,
            "model": diagnosis.setup.model.name,
        },
        "kernel": provenance.kernel,
        "input_hash": provenance.input_hash,
        "seed": provenance.seed,
        **_record(diagnosis),
        "wrong": {wrong.result: _wrong(wrong, labels) for wrong in diagnosis.wrong},
        "verdict": diagnosis.verdict,
        "explanations": _plain(explanations_of(diagnosis)),
        "shared": list(shared_of(diagnosis)),
        "undecided": list(doubts(diagnosis)) if diagnosis.verdict == "undecided" else [],
        **_named(diagnosis, "p_any", "p_second"),
        "causes": [_cause(diagnosis, cause, labels) for cause in diagnosis.causes],
        **_compared(diagnosis),
        **_named(diagnosis, "inseparable", "remainder"),
        "alike": [{**_named(each, "one", "other"), "angle": _value(each.angle, "deg")} for each in diagnosis.alike],
        **_seen(diagnosis),
        **_use(diagnosis),
        **_named(diagnosis, "contradictions", "thinned", "trades"),
        "notes": list(records.notes),
        "unit_slips": _plain(records.unit_errors),
        "warnings": list(diagnosis.warnings),
    }


def _record(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say what was measured: results, files with their rows and runs, rows that only judge."""
    records = diagnosis.records
    files = []
    for index, label in enumerate(file_labels(records.files)):
        runs = len(set(records.run_of[records.file_of == index].tolist()))
        files.append({"file": label, **records.counts[index].as_json(), "runs": runs})
    return {
        "measured": list(diagnosis.measured),
        "rows": len(records),
        "runs": len(set(records.run_of.tolist())),
        "files": files,
        "held_out": int(records.held_out.sum()),
        "covariates": {
            covariate.name: {**_named(covariate, "unit", "role"), "constant": covariate.is_constant}
            for covariate in records.covariates.values()
        },
    }


def _wrong(wrong: Wrong, labels: Mapping[str, str]) -> dict[str, Any]:
    outliers = [{"file": labels.get(file, file), "line": int(line)} for file, line in wrong.noise.outliers]
    noise = _named(wrong.noise, "sd", "autocorrelation", "ar_coefficient", "tails", "spread")
    return {
        **_named(wrong, "rows", "rmse", "noise_floor"),
        "stated_noise": _plain(wrong.stated),
        **_named(wrong, "reducible_share"),
        "noise": {**noise, "outliers": outliers},
        "findings": [_named(finding, "kind", "covariate", "p_value", "text") for finding in wrong.findings],
    }


def _compared(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say which other explanations there are: those that are not excluded, and all that were compared."""
    said: dict[str, Any] = {"unique": bool(diagnosis.unique)}
    for name in ("alternatives", "ranking"):
        said[name] = [
            {
                **_named(alternative, "causes", "behind", "separation", "depends_on"),
                "unknowns": {effect: _unknowns(unknowns, {}) for effect, unknowns in alternative.unknowns.items()},
                **_named(alternative, "same_as"),
            }
            for alternative in getattr(diagnosis, name)
        ]
    return said


def _unknowns(unknowns: Sequence[FittedUnknown], labels: Mapping[str, str]) -> dict[str, Any]:
    """Return fitted unknowns by name, each with its interval; of one for each file alone these by the file's label."""
    said = {}
    for unknown in unknowns:
        said[unknown.name] = _fitted((unknown.value, unknown.low, unknown.high), unknown.unit)
        if unknown.per_file:
            said[unknown.name]["per_file"] = {
                labels.get(file, file): _fitted(fitted, unknown.unit) for file, fitted in unknown.per_file.items()
            }
    return said


def _fitted(fitted: tuple[float, float | None, float | None], unit: str) -> dict[str, Any]:
    value, low, high = fitted
    return {**_value(value, unit), "interval95": [_value(end, unit)["value"] for end in (low, high)]}


def _seen(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say what this data could show, and what it could not."""
    seen = diagnosis.seen
    return {
        "not_excited": [effect.name for effect in seen if effect.sight == "not excited"],
        "not_fitted": {effect.name: effect.text for effect in seen if effect.sight == "cannot be fitted"},
        "not_measured": _plain(diagnosis.not_measured),
        "hidden_in_tolerances": [effect.name for effect in seen if effect.sight == "hidden in the tolerances"],
        "smallest_visible": {
            effect.name: {**_plain(effect.smallest), "sight": effect.sight}
            for effect in seen
            if effect.smallest is not None
        },
    }


def _use(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Say what the extension is worth, and what to measure or to know for more."""
    facts = ("explanation", "quantity", "note")
    return {
        "calibrated": {
            calibrated.name: {**_value(calibrated.value, calibrated.unit), **_named(calibrated, "of_its_sd")}
            for calibrated in diagnosis.calibrated
        },
        "gain": {**{gain.result: _gain(gain) for gain in diagnosis.gain}, **_named(diagnosis, "stability")},
        "next": [
            _named(point, "settings", "measure", "separates", "why", "separation", "needed") for point in diagnosis.next
        ],
        "experiment": None if diagnosis.experiment is None else experiment_document(diagnosis.experiment),
        "ties": [
            {
                "explanations": list(tie.explanations),
                "facts": [
                    {**_named(fact, *facts), **_plain(fact.value), "accuracy": _plain(fact.accuracy)["value"]}
                    for fact in tie.facts
                ],
            }
            for tie in diagnosis.ties
        ],
    }


def experiment_document(experiment: Experiment) -> dict[str, Any]:
    """Return an experiment as data: courses and readings in the units that stand beside them."""
    units = experiment.units
    return {
        **_named(experiment, "tells", "apart"),
        "courses": {
            course.name: {
                "way": course.way,
                "from": _value(course.start, units[course.name]),
                "to": _value(course.end, units[course.name]),
            }
            for course in experiment.courses
        },
        **_named(experiment, "results", "readings", "takes", "separation", "needed", "chance", "sizes"),
        "settings": {
            name: {"values": [_value(value, units[name])["value"] for value in values.tolist()], "unit": units[name]}
            for name, values in experiment.settings.items()
        },
    }


def plan_document(plan: Planned) -> dict[str, Any]:
    """Return a planned experiment as data: the same inputs, causes, budget and seed give the same document."""
    provenance = provenance_of(plan.setup)
    units = {name: difference_unit(plan.setup.print_unit(name)) for name in plan.noise}
    return {
        "schema": PLAN_SCHEMA,
        "plugin": {"name": provenance.plugin, "version": provenance.plugin_version, "model": plan.setup.model.name},
        "kernel": provenance.kernel,
        "input_hash": provenance.input_hash,
        "seed": provenance.seed,
        **_named(plan, "causes", "budget"),
        "noise": {name: _value(sd, units[name]) for name, sd in plan.noise.items()},
        "experiment": None if plan.experiment is None else experiment_document(plan.experiment),
    }


def _gain(gain: Gain) -> dict[str, Any]:
    sizes = ("rmse_before", "rmse_after", "noise_floor")
    said = _named(gain, *sizes, "reducible_removed", "log_score_gain", "p_value", "coverage90")
    if gain.held_out is not None:
        held_out = zip(sizes, gain.held_out, strict=False)
        said["held_out"] = {name: _value(value, gain.rmse_before.unit) for name, value in held_out}
    return said


# Pieces of a diagnosis as data


def _cause(diagnosis: DiagnosisResult, cause: Cause, labels: Mapping[str, str]) -> dict[str, Any]:
    return {
        "effect": cause.effect, "unknowns": _unknowns(cause.unknowns, labels), **_named(cause, "same_as", "share"),
        "remedy": stated_remedy(diagnosis, cause.effect),
    }  # fmt: skip


def _named(piece: Any, *names: str) -> dict[str, Any]:
    return {name: _plain(getattr(piece, name)) for name in names}


def _plain(piece: Any) -> Any:
    """Return a piece as JSON has it: an amount in its unit, other dataclasses field by field."""
    if isinstance(piece, Amount):
        return _value(piece.value, piece.unit)
    if is_dataclass(piece):
        return _named(piece, *(field.name for field in fields(piece)))
    if isinstance(piece, Mapping):
        return {str(key): _plain(one) for key, one in piece.items()}
    return [_plain(one) for one in piece] if isinstance(piece, (tuple, list)) else clean(piece)


def _value(value: float | None, unit: str) -> dict[str, Any]:
    """Return an SI number in a unit; what is no finite number is None."""
    return {"value": None if value is None else clean(float(from_si(float(value), unit))), "unit": unit}
