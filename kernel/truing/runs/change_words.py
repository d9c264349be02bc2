"""Changes between two runs, or two diagnoses, in words: kind, name, before, after, and by how much."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from truing.numbers import format_number
from truing.runs.comparison import Change, differing, number_in
from truing.studies.checks import SHORT
from truing.texts import one_line
from truing.units import difference_unit, unit_text
from truing.units.names import LEVELS

LONGEST = 60
ABSENT = "-"
MANY_TIMES = 10.0
"""From here on a growth is said as a factor."""
LEAST = 1e-9
"""A smaller share is more than rounding, and no more than that is said of it."""


def words_of(change: Change) -> tuple[str, str, str, str, str]:
    """Say what changed: kind, name, before, after, and by how much."""
    before, after = map(_value, pieces_of(change))
    if change.kind == "studies":
        before, after = (
            "" if _is_study(change) else ABSENT if piece is None else "there" for piece in pieces_of(change)
        )
    return change.kind, one_line(change.name), before, after, amount_of(change)


def pieces_of(change: Change) -> tuple[Any, Any]:
    """Return what stood before and after."""
    return change.before, change.after


def amount_of(change: Change) -> str:
    """Say by how much something changed: +12.5 %, x 40, now FAILS, new, gone; nothing where there is no number."""
    if change.before is None:
        return "new"
    if change.after is None:
        return "gone"
    if _is_study(change):
        count = differing(change.before, change.after)
        return f"{count} {'value differs' if count == 1 else 'values differ'} (see results.json)"
    parts = [_flip(change), _moved(change), _series(change), _limit(change), _scatter(change), _interval(change)]
    return ", ".join(part for part in parts if part)


def _is_study(change: Change) -> bool:
    return change.kind == "studies" and change.before is not None and change.after is not None


def _flip(change: Change) -> str:
    return f"now {'passes' if change.after['passed'] else SHORT[change.after['state']]}" if change.flipped else ""


def _moved(change: Change) -> str:
    before, after, share = number_in(change.before), number_in(change.after), change.relative
    if before is None or after is None or before == after:
        return ""
    unit = str(change.before.get("unit") or "")
    if share is None or unit in LEVELS or _is_count(change):
        return _difference(before, after, unit) if unit == (change.after.get("unit") or "") else "in another unit"
    return growth(share)


def _is_count(change: Change) -> bool:
    return all(isinstance(piece.get("value"), int) for piece in (change.before, change.after))


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


def _difference(before: float, after: float, unit: str) -> str:
    step = format_number(after - before, 3)
    return f"{'+' if after > before else ''}{step} {unit_text(difference_unit(unit))}".strip()


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
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        return _short(", ".join(value) or ABSENT)
    if isinstance(value, dict) and "spread" in value:
        return one_line(value["spread"])
    if isinstance(value, dict) and "value" in value:
        number = value["value"]
        is_number = isinstance(number, (int, float)) and not isinstance(number, bool)
        said = f"{format_number(number, 8) if is_number else number} {value.get('unit') or ''}".strip()
        return _short(_with_state(said, value.get("state", "passes")))
    if isinstance(value, dict) and {"name", "version", "model"} <= value.keys():
        return _short(f"{value['model']} {value['version']}")
    if isinstance(value, dict) and all(isinstance(item, dict) for item in value.values()):
        return _short(", ".join(f"{name} = {_value(item)}" for name, item in value.items()), 2 * LONGEST)
    return _short(str(value))


def _with_state(said: str, state: str) -> str:
    words = {"proposed": "not as stated", "undecided": "undecided", "fails": "fails"}
    return f"{said} ({words[state]})" if state in words else said


def _short(text: str, longest: int = LONGEST) -> str:
    plain = one_line(text)
    return plain if len(plain) <= longest else "(see results.json)"
