"""The kernel's own effects, which act on the reading of one result each: which result, and what they follow."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from truing.declare.builtin import Reading
from truing.declare.sources import Effect

if TYPE_CHECKING:
    from truing.diagnosis.causes import Cause


def reading_of(effect: Effect[Any, Any]) -> Reading | None:
    """Return the reading of a built-in effect; None for other effects."""
    return effect.function if isinstance(effect.function, Reading) else None


def gauged(cause: Cause, measured: Iterable[str]) -> str:
    """Return the measured result whose reading a part of a built-in effect changes, or nothing."""
    reading = None if cause.effect is None else reading_of(cause.effect)
    names = {number.name for number in cause.numbers}
    for item, roles in reading.roles if reading is not None else ():
        if item.name in set(measured) and names == set(roles.values()):
            return item.name
    return ""


def followed_by(cause: Cause) -> str:
    """Return the name of the input, condition or axis that a built-in effect follows; nothing for an offset or gain."""
    reading = None if cause.effect is None else reading_of(cause.effect)
    return reading.seen.name if reading is not None and reading.seen is not None else ""
