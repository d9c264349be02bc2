"""The colours that repeat what changed between two runs."""

from __future__ import annotations

from collections.abc import Mapping

from truing.cli.coloured import BAD, GOOD, NEW, OLD
from truing.runs.comparison import Change
from truing.studies.checks import EXIT_CODES


def styles_of(change: Change) -> tuple[str, str, str, str, str]:
    """Name the colours of one row: what a check gained or lost, and what is new."""
    if change.kind != "checks":
        return "", "", OLD, NEW, ""
    better = _is_better(change)
    colour = {True: GOOD, False: BAD, None: ""}[better]
    flip = f"bold {colour}" if change.flipped else colour
    return flip if change.flipped else "", flip if change.flipped else "", OLD, NEW, flip


def _is_better(change: Change) -> bool | None:
    """Tell whether a check has more left than before; None where that cannot be said."""
    if change.flipped:
        states = list(EXIT_CODES)
        return states.index(change.after["state"]) < states.index(change.before["state"])
    if not isinstance(change.before, Mapping) or not isinstance(change.after, Mapping):
        return None
    before, after = change.before.get("margin"), change.after.get("margin")
    return None if before is None or after is None or before == after else bool(after > before)
