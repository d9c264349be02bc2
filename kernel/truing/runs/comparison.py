"""Two runs, or two diagnoses, side by side: what changed, by how much, and which checks flipped."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from truing.errors import UsageError
from truing.studies.checks import EXIT_CODES

ROUNDING = 1e-12


@dataclass(frozen=True)
class Change:
    """One thing that differs between two runs; None where a run does not have it."""

    kind: str
    name: str
    before: Any
    after: Any

    @property
    def flipped(self) -> bool:
        """Whether this is a check of another state than before."""
        before, after = _state(self.before), _state(self.after)
        return before is not None and after is not None and before != after

    @property
    def relative(self) -> float | None:
        """How far a number moved, as a share of what it was; None for what is no number, or was 0, or in another unit.

        Positive is away from zero, so that -2 mm after -1 mm is a growth by 100 %.
        """
        before, after = number_in(self.before), number_in(self.after)
        if before is None or after is None or not before or self.before.get("unit") != self.after.get("unit"):
            return None
        return (after - before) / before


def _state(piece: Any) -> Any:
    return piece.get("state") if isinstance(piece, Mapping) else None


def number_in(piece: Any) -> float | None:
    """Return the single number of a piece of results.json, or None."""
    value = piece.get("value") if isinstance(piece, Mapping) else None
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def in_order(found: Sequence[Change]) -> list[Change]:
    """Return the changes as they are read: checks of another state, the worst first, then the rest as it was."""
    order = list(EXIT_CODES)
    flips = sorted((one for one in found if one.flipped), key=lambda one: -order.index(_state(one.after)))
    return [*flips, *(one for one in found if not one.flipped)]


def compared(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    """Return what differs between two documents of one kind; raises UsageError for a run beside a diagnosis."""
    schemas = [str(document.get("schema")) for document in (before, after)]
    kinds = ["diagnosis" if schema.startswith("truing.diagnosis") else "run" for schema in schemas]
    if kinds[0] != kinds[1]:
        raise UsageError(f"the first is a {kinds[0]} and the second a {kinds[1]}; compare two of one kind")
    return changes_of_diagnoses(before, after) if kinds[0] == "diagnosis" else changes(before, after)


def changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    """Return what differs between two results.json documents, settings first.

    Numbers that agree to ``ROUNDING`` are equal: another order of summation is no change.
    """
    found = [*_versions(before, after)]
    for kind in ("inputs", "tolerances", "conditions", "effects", "results"):
        found += _of_mapping(kind, before.get(kind) or {}, after.get(kind) or {})
    found += _of_mapping("checks", _by_name(before.get("checks")), _by_name(after.get("checks")))
    return [*found, *_of_mapping("studies", before.get("studies") or {}, after.get("studies") or {})]


def changes_of_diagnoses(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    """Return what differs between two diagnosis.json documents: settings, data, verdict, causes, errors, gain."""
    found = [*_versions(before, after)]
    one, other = _flat(before), _flat(after)
    for kind in one:
        found += _of_mapping(kind, one[kind], other[kind])
    return found


def _flat(document: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return what a diagnosis found as single values, by kind and name."""
    causes: dict[str, Any] = {}
    for cause in document.get("causes") or []:
        causes[cause["effect"]] = {"value": "named", "unit": ""}
        causes |= {f"{cause['effect']}.{name}": value for name, value in cause["unknowns"].items()}
    gain = {name: item for name, item in (document.get("gain") or {}).items() if isinstance(item, Mapping)}
    remainder = document.get("remainder") or {}
    return {
        "data": {name: document.get(name) for name in ("input_hash", "measured", "rows", "runs", "held_out", "files")},
        "verdict": {
            "verdict": document.get("verdict"),
            "unique": document.get("unique"),
            "not excluded": sorted(" + ".join(item["causes"]) for item in document.get("alternatives") or []),
            "remainder over": remainder.get("depends_on"),
        },
        "causes": causes,
        "wrong": _parts(document.get("wrong") or {}, ("rmse", "noise_floor")),
        "gain": _parts(gain, ("rmse_after",)),
        "calibrated": dict(document.get("calibrated") or {}),
    }


def _parts(of_results: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    return {f"{result}.{name}": item.get(name) for result, item in of_results.items() for name in names}


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
