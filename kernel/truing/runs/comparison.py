"""Two runs side by side: inputs, results and checks that changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Change:
    """One thing that differs between two runs; None where a run does not have it."""

    kind: str
    name: str
    before: Any
    after: Any


def changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    """Return what differs between two results.json documents, settings first."""
    found = [*_versions(before, after)]
    for kind in ("inputs", "tolerances", "conditions", "effects", "results"):
        found += _of_mapping(kind, before.get(kind) or {}, after.get(kind) or {})
    found += _of_mapping("checks", _by_name(before.get("checks")), _by_name(after.get("checks")))
    return [*found, *_of_mapping("studies", before.get("studies") or {}, after.get("studies") or {})]


def _versions(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[Change]:
    for name in ("plugin", "kernel", "seed"):
        if before.get(name) != after.get(name):
            yield Change("settings", name, before.get(name), after.get(name))


def _by_name(checks: Any) -> dict[str, Any]:
    return {check["name"]: {key: value for key, value in check.items() if key != "name"} for check in checks or []}


def _of_mapping(kind: str, before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[Change]:
    for name in dict.fromkeys([*before, *after]):
        if before.get(name) != after.get(name):
            yield Change(kind, name, before.get(name), after.get(name))
