"""diagnosis.json as it is promised: what its schema says of every field, and what must agree with what."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import jsonschema

from shared import ROOT
from truing.units import same_dimension

Document = Mapping[str, Any]
FORMAT = ROOT / "docs" / "reference" / "files" / "diagnosis.schema.json"


def demand_contract(document: Document, described: Document) -> None:
    """Fail unless a document keeps the contract for the model that ``calc describe --json`` describes.

    Another unit of the same kind than the declared one is as good.
    """
    jsonschema.validate(document, json.loads(FORMAT.read_text(encoding="utf-8")))
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
            assert any(same_dimension(item["unit"], kind) for kind in kinds), name


def _demand_result(name: str, document: Document, unit: str) -> None:
    """Errors of a result are in a unit of its kind, and findings are over covariates."""
    wrong, gain = document["wrong"][name], document["gain"][name]
    for amount in (wrong["rmse"], wrong["noise_floor"], *(gain[key] for key in ("rmse_before", "rmse_after"))):
        assert amount["value"] >= 0
        assert same_dimension(amount["unit"], unit)
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
            assert same_dimension(unknown["unit"], effects[cause["effect"]][name])
        low, high = unknown["interval95"]
        assert low is None or low <= unknown["value"]
        assert high is None or unknown["value"] <= high
