"""diagnosis.json as it is promised: every field of the contract, its type, its unit, and what must agree with what."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import jsonschema

from truing.units import same_dimension

Document = Mapping[str, Any]
TEXT = {"type": "string", "minLength": 1}
NAMES = {"type": "array", "items": TEXT}
NUMBER, COUNT = {"type": "number"}, {"type": "integer", "minimum": 0}
SHARE = {"type": "number", "minimum": 0, "maximum": 1}
MAYBE = {"anyOf": [SHARE, {"type": "null"}]}
END = {"type": ["number", "null"]}


def _object(**fields: Any) -> dict[str, Any]:
    """All of these fields; more may stand beside them."""
    return {"type": "object", "properties": fields, "required": list(fields)}


def _by_name(item: Any) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": item}


AMOUNT = _object(value=NUMBER, unit={"type": "string"})
UNKNOWN = _object(
    value=NUMBER, unit={"type": "string"}, interval95={"type": "array", "items": END, "minItems": 2, "maxItems": 2}
)
KINDS = ["bias", "trend", "order", "step", "spread", "autocorrelation", "outlier"]
WRONG = _object(
    rmse=AMOUNT,
    noise_floor=AMOUNT,
    reducible_share=SHARE,
    noise=_object(autocorrelation={"type": "number", "minimum": -1, "maximum": 1}, tails=TEXT, spread=TEXT),
    findings={
        "type": "array",
        "items": _object(kind={"enum": KINDS}, covariate={"type": "string"}, p_value=MAYBE, text=TEXT),
    },
)
GAIN = _object(
    rmse_before=AMOUNT, rmse_after=AMOUNT, noise_floor=AMOUNT, reducible_removed=NUMBER, log_score_gain=NUMBER,
    p_value=SHARE, coverage90=SHARE,
)  # fmt: skip
SCHEMA = _object(
    schema={"const": "truing.diagnosis/1"},
    plugin=_object(name=TEXT, version={"type": "string"}),
    kernel=TEXT,
    input_hash={"type": "string", "pattern": "^[0-9a-f]{64}$"},
    seed=COUNT,
    measured={**NAMES, "minItems": 1},
    rows=COUNT,
    runs=COUNT,
    wrong=_by_name(WRONG),
    verdict={"enum": ["none", "undecided", "named", "one_of", "unknown"]},
    causes={"type": "array", "items": _object(effect=TEXT, unknowns=_by_name(UNKNOWN), same_as=NAMES)},
    unique={"type": "boolean"},
    alternatives={"type": "array", "items": _object(causes=NAMES, behind={"type": "number", "minimum": 0})},
    remainder={"anyOf": [_object(depends_on=NAMES, shape=TEXT), {"type": "null"}]},
    not_excited=NAMES,
    not_measured=_by_name({**NAMES, "minItems": 1}),
    smallest_visible=_by_name(
        _object(value={"type": "number", "exclusiveMinimum": 0}, unit={"type": "string"})  # a size is no zero
    ),
    calibrated=_by_name(_object(value=NUMBER, unit={"type": "string"}, of_its_sd=NUMBER)),
    gain={**_object(stability=SHARE), "additionalProperties": GAIN},
    next={
        "type": "array",
        "items": _object(settings=_by_name(AMOUNT), separates={**NAMES, "minItems": 2, "maxItems": 2}, why=TEXT),
    },
)


def demand_contract(document: Document, described: Document) -> None:
    """Fail unless a document keeps the contract for the model that ``calc describe --json`` describes.

    Another unit of the same kind than the declared one is as good.
    """
    jsonschema.validate(document, SCHEMA)
    _demand_agreement(document)
    units = {item["name"]: item["unit"] for item in described["results"]}
    known = [*described["effects"], *described["built_in"]["effects"], *described["built_in"]["where_measured"]]
    effects = {item["name"]: {one["name"]: one["unit"] for one in item["unknowns"]} for item in known}
    assert set(document["wrong"]) == set(document["measured"]) == set(document["gain"]) - {"stability"}
    assert set(document["measured"]) <= set(units)
    for name in document["measured"]:
        _demand_result(name, document, units[name])
    for cause in document["causes"]:
        _demand_unknowns(cause, effects)
    blind = {name.partition(".")[0] for name in document["not_excited"]}
    assert blind | set(document["not_measured"]) <= set(effects)
    for name, item in document["smallest_visible"].items():
        effect, _, unknown = name.partition(".")
        if effect in effects:
            kinds = [effects[effect][unknown]] if unknown else effects[effect].values()
            assert any(_is_same_kind(item["unit"], kind) for kind in kinds), name


def _demand_result(name: str, document: Document, unit: str) -> None:
    """Errors of a result are in a unit of its kind, and findings are over covariates."""
    wrong, gain = document["wrong"][name], document["gain"][name]
    for amount in (wrong["rmse"], wrong["noise_floor"], *(gain[key] for key in ("rmse_before", "rmse_after"))):
        assert amount["value"] >= 0
        assert _is_same_kind(amount["unit"], unit)
    known = ["", *document["covariates"]]
    pairs = {f"{one} and {other}" for one in known for other in known}
    assert {one["covariate"] for one in wrong["findings"]} <= {*known, *pairs}


def _demand_agreement(document: Document) -> None:
    """What is said in one place follows from another."""
    has_cause, has_remainder = bool(document["causes"]), document["remainder"] is not None
    is_found, count = has_cause or has_remainder, len(document["explanations"])
    assert document["verdict"] in ({"named", "one_of", "unknown"} if is_found else {"none", "undecided"})
    assert is_found is (count > 0)
    assert has_cause or document["verdict"] != "named"
    assert document["verdict"] not in {"named", "one_of"} or (document["verdict"] == "named") is (count == 1)
    assert document["unique"] is (count == 1 or document["verdict"] == "none")
    assert document["p_any"] >= 0.2 or document["verdict"] != "none"
    if has_remainder:
        assert set(document["remainder"]["depends_on"]) <= set(document["covariates"])
    named = [cause["effect"] for cause in document["causes"]]
    assert len(set(named)) == len(named)
    assert not set(named) & {other for cause in document["causes"] for other in cause["same_as"]}


def _demand_unknowns(cause: Mapping[str, Any], effects: Mapping[str, Mapping[str, str]]) -> None:
    """A named effect is one of the model's, in its units, inside its interval."""
    assert set(cause["same_as"]) <= set(effects)
    assert cause["unknowns"]
    for name, unknown in cause["unknowns"].items():
        if not cause["effect"].startswith("input:"):
            assert _is_same_kind(unknown["unit"], effects[cause["effect"]][name])
        low, high = unknown["interval95"]
        assert low is None or low <= unknown["value"]
        assert high is None or unknown["value"] <= high


def _is_same_kind(unit: str, other: str) -> bool:
    return same_dimension(unit, other)
