"""What a diagnosis said to one case, held against the truth: every fact that the table of metrics needs, as JSON."""

from collections.abc import Mapping, Sequence
from itertools import permutations
from typing import Any

import numpy as np

from hidden_effects.candidates import Candidate, stacked
from hidden_effects.cases import Case
from hidden_effects.oracle import calibrated, judged, oracle, rms, scale
from hidden_effects.press_machine import SCATTER, Array, shown
from hidden_effects.record import Lens, beside_groups, over_results
from hidden_effects.shapes import family_of, groups
from truing.testing.hiding import Answered
from truing.units import to_si

Document = Mapping[str, Any]
FIRST = 4
DOUBTS = 12


def outcome(case: Case, answer: Answered) -> dict[str, Any]:
    """Everything about one case and its answer; numbers and texts only."""
    document = answer.document
    predicted = judged(case, stacked(answer.predicted, case.results))
    exact = is_exact(case, document)
    return {
        **about(case),
        "seconds": answer.seconds,
        **essentials(document),
        "exact": exact,
        "in_set": is_in_set(case, document),
        "extra": has_extra(case, document),
        "wrong_name": has_wrong_name(case, document),
        "to_truth": None if exact or not document["explanations"] else to_truth(case, document),
        "covered": covered(case, document) if exact else {},
        "held_out": held_out(case, predicted),
        "gain": gains(case, document, predicted),
    }


def about(case: Case) -> dict[str, Any]:
    """The case and what it says of itself."""
    rival = case.nearest_rival
    return {
        "seed": case.seed, "stratum": case.stratum, "design": case.design, "noise": case.kind,
        "rows": len(case.record.rows), "results": list(case.results), "truth": list(case.truth),
        "hidden": {effect: dict(unknowns) for effect, unknowns in case.hidden.items()},
        "shape": case.shape.text if case.shape else None,
        "depends_on": list(case.shape.depends_on) if case.shape else [],
        "lambda_det": case.lambda_det, "lambda_sep": case.lambda_sep, "rival": list(rival.names),
        "halves": list(case.halves), "visible": case.is_visible, "separable": case.is_separable,
    }  # fmt: skip


def essentials(document: Document) -> dict[str, Any]:
    """What the table and whoever looks into a case need of the document."""
    kept = ("causes", "p_any", "p_second")
    remainder = document["remainder"] or {}
    in_doubt = document["verdict"] == "undecided" and bool(document["explanations"])
    return {
        **{name: document.get(name) for name in kept},
        "verdict": "in doubt" if in_doubt else document["verdict"],
        "unique": not (document["alternatives"] or in_doubt),  # names of one curve are one explanation here
        "alternatives": [
            {name: other.get(name) for name in ("causes", "depends_on", "behind", "separation")}
            for other in document["alternatives"][:8]
        ],
        "alternative_count": len(document["alternatives"]),
        "remainder": {name: remainder[name] for name in ("depends_on", "shape", "results")} if remainder else None,
    }


def is_named(candidate: Candidate, cause: Mapping[str, Any]) -> bool:
    """Whether a cause names this candidate, of an effect with parts the right part, or lists it as the same curve."""
    if cause["effect"] != candidate.effect:
        return candidate.effect in cause["same_as"]
    mine = {*candidate.amplitudes, *(candidate.shapes or {})}
    return not candidate.part or bool(mine & set(cause["unknowns"]))


def are_named(candidates: Sequence[Candidate], causes: Sequence[Mapping[str, Any]]) -> bool:
    """Whether causes and candidates are one and the same, each by one cause."""
    return len(candidates) == len(causes) and any(
        all(map(is_named, candidates, order)) for order in permutations(causes)
    )


def is_exact(case: Case, document: Document) -> bool:
    """Whether the verdict is the truth, no more and no less."""
    causes, remainder = document["causes"], document["remainder"]
    if case.stratum == "none":
        return not document["explanations"]
    if case.shape is None:
        return bool(causes) and remainder is None and are_named(case.causes, causes)
    own = [cause for cause in causes if cause["effect"] != case.shape.also]
    has_shape = remainder is not None and set(case.shape.depends_on) <= set(remainder["depends_on"])
    has_other_name = len(own) < len(causes) and remainder is None
    return (has_shape or has_other_name) and are_named(case.causes, own)


def is_in_set(case: Case, document: Document) -> bool:
    """Whether the truth is the verdict or among its first alternatives."""
    return is_exact(case, document) or any(is_alternative(case, other) for other in document["alternatives"][:FIRST])


def is_alternative(case: Case, other: Mapping[str, Any]) -> bool:
    """Whether an alternative is the truth; alternatives name effects without their parts."""
    named = [name for name in other["causes"] if name != "unknown"]
    depends_on = set(other.get("depends_on") or ())
    if case.shape is not None:
        has_shape = "unknown" in other["causes"] and set(case.shape.depends_on) <= depends_on
        if not has_shape and case.shape.also not in named:
            return False
        named = [name for name in named if has_shape or name != case.shape.also]
    elif "unknown" in other["causes"]:
        return False
    wanted = [case.record.effects_of(name) for name in case.truth]
    return len(named) == len(wanted) and all(any(name in names for name in named) for names in wanted)


def has_extra(case: Case, document: Document) -> bool:
    """Whether a single effect was named, and something beside it."""
    causes = document["causes"]
    found = case.stratum == "single" and any(is_named(case.causes[0], cause) for cause in causes)
    return found and (len(causes) > 1 or document["remainder"] is not None)


def has_wrong_name(case: Case, document: Document) -> bool:
    """Whether a cause is named that is not there, under any name of its curve."""
    true = case.causes
    also = case.shape.also if case.shape else ""
    return any(
        cause["effect"] != also and not any(is_named(candidate, cause) for candidate in true)
        for cause in document["causes"]
    )


def to_truth(case: Case, document: Document) -> float:
    """Separation of what was hidden from what was said instead: below 10 this data hardly tells them apart."""
    if case.stratum == "none":
        return 0.0
    record = case.record
    free = [record.tolerances[:, list(SCATTER).index(name)][:, None] for name in _inputs(document)]
    names = [candidate.name for cause in document["causes"] for candidate in _meant(case, cause)]
    if case.shape is not None and case.shape.also in {cause["effect"] for cause in document["causes"]}:
        free.append(over_results(family_of(case.shape, record.rows), record))  # the name may draw all of the family
    if document["remainder"] is None:
        return Lens(record, np.hstack(free) if free else None).separation(case.change, names)
    depends_on = set(document["remainder"]["depends_on"])
    families = [(covariates, family) for covariates, family in groups(record.rows) if covariates <= depends_on]
    if case.shape is not None and set(case.shape.depends_on) <= depends_on:
        families.append((frozenset(case.shape.depends_on), family_of(case.shape, record.rows)))
    if not names and not free:
        return beside_groups(case.lens, case.change, families).separation
    least = case.lambda_det
    for _, family in families:
        lens = Lens(record, np.hstack([over_results(family, record), *free]))
        least = min(least, lens.separation(case.change, names) if names else lens.visibility(case.change))
    return least


def _inputs(document: Document) -> list[str]:
    """Inputs that were named as off their band."""
    named = [cause["effect"].removeprefix("input:") for cause in document["causes"] if "input:" in cause["effect"]]
    return [name for name in named if name in SCATTER]


def _meant(case: Case, cause: Mapping[str, Any]) -> list[Candidate]:
    """The candidates of a cause: of an effect with parts every part that it has unknowns of; none for an input."""
    fits = [candidate for candidate in case.record.candidates if candidate.effect == cause["effect"]]
    return [candidate for candidate in fits if is_named(candidate, cause)] or fits[:1]


def covered(case: Case, document: Document) -> dict[str, bool]:
    """Whether the 95 % interval of every unknown of a rightly named effect holds the true value."""
    found = {}
    for candidate in case.causes:
        for cause in document["causes"]:
            if cause["effect"] != candidate.effect or not is_named(candidate, cause):
                continue
            for name, fitted in cause["unknowns"].items():
                low, high = fitted["interval95"]
                if name not in case.hidden[candidate.effect] or name.endswith("_order") or low is high is None:
                    continue
                low = -np.inf if low is None else float(to_si(low, fitted["unit"]))
                high = np.inf if high is None else float(to_si(high, fitted["unit"]))
                found[f"{candidate.effect}.{name}"] = bool(low <= case.hidden[candidate.effect][name] <= high)
    return found


def held_out(case: Case, predicted: Array) -> dict[str, float]:
    """Errors at the rows held out, over the noise: of measurements (noise included) and of the truth (without)."""
    sd = scale(case)
    measured = judged(case, stacked(case.held_readings, case.results))
    truth = judged(case, case.true_readings(case.held))
    best, base = oracle(case), judged(case, stacked(shown(case.held, calibrated(case), {}), case.results))
    return {
        "rmse": rms((measured - predicted) / sd), "oracle": rms((measured - best) / sd),
        "base": rms((measured - base) / sd), "mse": rms((truth - predicted) / sd) ** 2,
        "mse_oracle": rms((truth - best) / sd) ** 2, "mse_base": rms((truth - base) / sd) ** 2,
    }  # fmt: skip


def gains(case: Case, document: Document, predicted: Array) -> dict[str, dict[str, float | None]]:
    """By result: the gain as cross-validated, and as it is at the rows held out, both against the calibrated base."""
    base = calibrated(case, DOUBTS)
    measured = judged(case, stacked(case.held_readings, case.results))
    residuals = {
        "held_before": measured - judged(case, stacked(shown(case.held, base, {}), case.results)),
        "held_after": measured - predicted,
    }
    found = {}
    for at, result in enumerate(case.results):
        said = document["gain"].get(result)
        if said is None:
            continue
        found[result] = {
            "nested_before": said["rmse_before"]["value"], "nested_after": said["rmse_after"]["value"],
            **{name: rms(np.split(values, len(case.results))[at]) for name, values in residuals.items()},
            "p_value": said["p_value"], "removed": said["reducible_removed"], "log_score": said["log_score_gain"],
            "coverage90": said["coverage90"],
        }  # fmt: skip
    return found
