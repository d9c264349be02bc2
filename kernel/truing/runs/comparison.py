"""Two runs side by side: inputs, results and checks that changed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

ROUNDING = 1e-12


@dataclass(frozen=True)
class Change:
    """One thing that differs between two runs; None where a run does not have it."""

    kind: str
    name: str
    before: Any
    after: Any


def changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    """Return what differs between two results.json documents, settings first.

    Numbers that agree to ``ROUNDING`` are equal: another order of summation is no change.
    """
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
        if not same(before.get(name), after.get(name)):
            yield Change(kind, name, before.get(name), after.get(name))


def same(one: Any, other: Any) -> bool:
    """Tell whether two pieces of results.json are equal but for rounding."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(one[name], other[name]) for name in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(same(a, b) for a, b in zip(one, other, strict=True))
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=ROUNDING)
    return bool(one == other)


def differing(one: Any, other: Any) -> int:
    """Count the single values in which two pieces of results.json differ."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return sum(differing(one.get(name), other.get(name)) for name in {*one, *other})
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return sum(differing(a, b) for a, b in zip(one, other, strict=True))
    return int(not same(one, other))
