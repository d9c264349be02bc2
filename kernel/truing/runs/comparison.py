"""Two runs, or two diagnoses, side by side: what changed, by how much, and which checks flipped."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from truing.errors import UsageError
from truing.numbers import counted, format_number
from truing.studies.checks import EXIT_CODES, SHORT
from truing.texts import one_line
from truing.units import difference_unit, unit_text
from truing.units.names import LEVELS

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


def in_order(unordered: Sequence[Change]) -> list[Change]:
    """Return the changes as they are read: checks of another state, the worst first, then the rest as it was."""
    order = list(EXIT_CODES)
    flips = sorted((one for one in unordered if one.flipped), key=lambda one: -order.index(_state(one.after)))
    return [*flips, *(one for one in unordered if not one.flipped)]


def compared(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Change]:
    """Return what differs between two documents of one kind, settings first; raises UsageError for two of two kinds.

    Numbers that agree to ``ROUNDING`` are equal: another order of summation is no change.
    """
    kinds = ["diagnosis" if _is_diagnosis(document) else "run" for document in (before, after)]
    if kinds[0] != kinds[1]:
        raise UsageError(f"the first is a {kinds[0]} and the second a {kinds[1]}; compare two of one kind")
    changes = [
        Change("settings", name, before.get(name), after.get(name))
        for name in ("plugin", "kernel", "seed")
        if before.get(name) != after.get(name)
    ]
    one, other = pieces_of(before), pieces_of(after)
    for kind, here in one.items():
        there = other[kind]
        names = [name for name in dict.fromkeys([*here, *there]) if not same(here.get(name), there.get(name))]
        changes += [Change(kind, name, here.get(name), there.get(name)) for name in names]
    return changes


def _is_diagnosis(document: Mapping[str, Any]) -> bool:
    return str(document.get("schema")).startswith("truing.diagnosis")


def pieces_of(document: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return what a run or a diagnosis says that is compared, by kind and name."""
    return _of_diagnosis(document) if _is_diagnosis(document) else _of_run(document)


def _of_run(document: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return what a run found, by kind and name."""
    checks = {check["name"]: {**check} for check in document.get("checks") or []}
    for check in checks.values():
        del check["name"]
    kinds = ("inputs", "tolerances", "correlations", "conditions", "effects", "results", "checks", "studies")
    parts = {kind: checks if kind == "checks" else document.get(kind) or {} for kind in kinds}
    return parts | {kind: _without_stated(parts[kind]) for kind in ("inputs", "conditions")}


def _without_stated(values: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out in which unit a value is stated: the same length in mm and in inches is one length."""
    return {name: {key: each for key, each in value.items() if key != "stated"} for name, value in values.items()}


def _of_diagnosis(document: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return what a diagnosis found as single values, by kind and name."""
    causes: dict[str, Any] = {}
    for cause in document.get("causes") or []:
        causes[cause["effect"]] = {"value": "named", "unit": ""}
        causes |= {f"{cause['effect']}.{name}": value for name, value in cause["unknowns"].items()}
    gain = {name: numbers for name, numbers in (document.get("gain") or {}).items() if isinstance(numbers, Mapping)}
    remainder = document.get("remainder") or {}
    return {
        "data": {name: document.get(name) for name in ("input_hash", "measured", "rows", "runs", "held_out", "files")},
        "verdict": {
            "verdict": document.get("verdict"),
            "unique": document.get("unique"),
            "not excluded": sorted(
                " + ".join(alternative["causes"]) for alternative in document.get("alternatives") or []
            ),
            "remainder over": remainder.get("depends_on"),
        },
        "causes": causes,
        "wrong": _parts(document.get("wrong") or {}, ("rmse", "noise_floor")),
        "gain": _parts(gain, ("rmse_after",)),
        "calibrated": dict(document.get("calibrated") or {}),
    }


def _parts(of_results: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    return {f"{result}.{name}": numbers.get(name) for result, numbers in of_results.items() for name in names}


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


# Changes between two runs, or two diagnoses, in words: kind, name, before, after, and by how much


LONGEST = 60
ABSENT = "-"
MANY_TIMES = 10.0
"""From here on a growth is said as a factor."""
STATES = {"proposed": "not as stated", "undecided": "undecided", "fails": "fails"}
LEAST = 1e-9
"""A smaller share is more than rounding, and no more than that is said of it."""


def words_of(change: Change) -> tuple[str, str, str, str, str]:
    """Say what changed: kind, name, before, after, and by how much."""
    pieces = (change.before, change.after)
    before, after = map(_value, pieces)
    if change.kind == "studies":
        before, after = ("" if None not in pieces else ABSENT if piece is None else "there" for piece in pieces)
    return change.kind, one_line(change.name), before, after, amount_of(change)


def amount_of(change: Change) -> str:
    """Say by how much something changed: +12.5 %, x 40, now FAILS, new, gone; nothing where there is no number."""
    return ", ".join(amounts_of(change))


def amounts_of(change: Change) -> tuple[str, ...]:
    """Say by how much something changed, part by part."""
    if change.before is None:
        return ("new",)
    if change.after is None:
        return ("gone",)
    if change.kind == "studies":
        count = differing(change.before, change.after)
        return (f"{counted(count, 'value differs', 'values differ')} (see results.json)",)
    flip = f"now {'passes' if change.after['passed'] else SHORT[change.after['state']]}" if change.flipped else ""
    parts = [flip, _moved(change), _series(change), _limit(change), _scatter(change), _interval(change)]
    return tuple(filter(None, parts))


def _moved(change: Change) -> str:
    before, after, share = number_in(change.before), number_in(change.after), change.relative
    if before is None or after is None or before == after:
        return ""
    unit = str(change.before.get("unit") or "")
    is_count = all(isinstance(piece["value"], int) for piece in (change.before, change.after))
    if share is not None and unit not in LEVELS and not is_count:
        return growth(share)
    if unit != (change.after.get("unit") or ""):
        return "in another unit"
    step = f"{format_number(after - before, 3)} {unit_text(difference_unit(unit))}".strip()
    return f"+{step}" if after > before else step


def _series(change: Change) -> str:
    """Count the values of a series that differ."""
    pieces = (change.before, change.after)
    before, after = (piece.get("value") if isinstance(piece, Mapping) else None for piece in pieces)
    if not isinstance(before, list) or not isinstance(after, list):
        return ""
    if len(before) != len(after):
        return f"{len(before)} values -> {len(after)}"
    return f"{differing(before, after)} of {len(after)} values differ"


def growth(share: float) -> str:
    """Write a relative change: +12.5 %, -3 %, beyond tenfold as a factor."""
    if abs(share) < LEAST:
        return f"below {LEAST:.0e} of it"
    if share >= MANY_TIMES - 1:
        return f"x {format_number(share + 1, 3)}"
    return f"{'+' if share > 0 else ''}{format_number(100 * share, 3)} %"


def _limit(change: Change) -> str:
    """Say that a limit moved, which the value of a check does not show."""
    if change.kind != "checks" or change.before.get("limit") == change.after.get("limit"):
        return ""
    limits = (format_number(piece.get("limit"), 8) for piece in (change.before, change.after))
    return f"limit {' -> '.join(limits)}"


def _scatter(change: Change) -> str:
    """Say how the standard deviation moved where a tolerance is written as it was."""
    if change.kind != "tolerances" or change.before.get("spread") != change.after.get("spread"):
        return ""
    shown: dict[str, None] = {}
    for name, piece in change.before.get("on", {}).items():
        other = change.after.get("on", {}).get(name, {})
        one = Change("tolerances", name, {"value": piece.get("sd")}, {"value": other.get("sd")}).relative
        if one:
            shown[f"sd {growth(one)}"] = None
    return ", ".join(shown) or "about another nominal"


def _interval(change: Change) -> str:
    """Say of a fitted number whether its move is within the interval it had."""
    interval, after = change.before.get("interval95") if isinstance(change.before, Mapping) else None, change.after
    number = number_in(after)
    if not interval or number is None or None in interval:
        return ""
    return "within its interval" if interval[0] <= number <= interval[1] else "outside of its interval"


def _value(value: Any) -> str:
    if value is None:
        return ABSENT
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list) and all(isinstance(member, str) for member in value):
        return _short(", ".join(value) or ABSENT)
    if isinstance(value, dict) and "spread" in value:
        return one_line(value["spread"])
    if isinstance(value, dict) and "value" in value:
        number = value["value"]
        is_number = isinstance(number, (int, float)) and not isinstance(number, bool)
        said = f"{format_number(number, 8) if is_number else number} {value.get('unit') or ''}".strip()
        state = STATES.get(value.get("state", ""))
        return _short(f"{said} ({state})" if state else said)
    if isinstance(value, dict) and {"name", "version", "model"} <= value.keys():
        return _short(f"{value['model']} {value['version']}")
    if isinstance(value, dict) and all(isinstance(member, dict) for member in value.values()):
        return _short(", ".join(f"{name} = {_value(member)}" for name, member in value.items()), 2 * LONGEST)
    return _short(str(value))


def _short(text: str, longest: int = LONGEST) -> str:
    plain = one_line(text)
    return plain if len(plain) <= longest else "(see results.json)"
