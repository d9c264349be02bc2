"""Columns of the kernel's own effects, from what the gauge shows already: the model is not called for them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from truing.declare.builtin import Reading, zero_of
from truing.declare.sources import Effect, Unknown
from truing.diagnosis.machine import Machine

if TYPE_CHECKING:
    from truing.diagnosis.candidates import Candidate, Curve


def reading_of(effect: Effect[Any, Any]) -> Reading | None:
    """Return the reading of a built-in effect; None for other effects."""
    return effect.function if isinstance(effect.function, Reading) else None


def gauged(candidate: Candidate, measured: Iterable[str]) -> str:
    """Return the measured result whose reading a part of a built-in effect changes, or nothing."""
    reading = reading_of(candidate.effect)
    names = {unknown.name for unknown in (*candidate.amplitudes, *candidate.shapes)}
    for item, roles in reading.roles if reading is not None else ():
        if item.name in set(measured) and names == set(roles.values()):
            return item.name
    return ""


def followed_by(candidate: Candidate) -> str:
    """Return the name of the input, condition or axis that a built-in effect follows; nothing for an offset or gain."""
    reading = reading_of(candidate.effect)
    return reading.seen.name if reading is not None and reading.seen is not None else ""


def reading_curve(machine: Machine, candidate: Candidate, unknown: Unknown, shape: Mapping[str, float]) -> Curve | None:
    """Return the derivative of every measured result by an amplitude of a built-in effect, or None for other effects.

    Built-in effects act last and are linear in their amplitudes, so this is what evaluating them would give.
    """
    import numpy as np

    reading = reading_of(candidate.effect)
    if reading is None:
        return None
    result = gauged(candidate, machine.records.measured)
    item, roles = next(entry for entry in reading.roles if entry[0].name == result)
    own = {role: 1.0 if name == unknown.name else shape.get(name, 0.0) for role, name in roles.items()}
    sight = machine.base[result] - zero_of(item) if reading.seen is None else _seen(machine, reading)
    curve = {name: np.zeros(len(machine.records)) for name in machine.records.measured}
    curve[result] = np.broadcast_to(np.asarray(reading.kind.added(own, sight), dtype=float), (len(machine.records),))
    return curve


def _seen(machine: Machine, reading: Reading) -> Any:
    """Return what a built-in effect follows, one value per row in SI, from where its effects vanish."""
    import numpy as np

    seen = reading.seen
    if seen is None:
        return np.zeros(len(machine.records))
    measured = machine.records.rows.placed(seen.name)
    held = machine.start.nominal(seen.name) if measured is None else measured
    values = np.broadcast_to(np.asarray(held, dtype=float), (len(machine.records),))
    return values - seen.zero if reading.kind.is_from_zero else values
