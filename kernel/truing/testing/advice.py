"""What to change where a hidden effect was not found."""

from __future__ import annotations

from typing import Any

from truing.declare.sources import Effect
from truing.diagnosis.result import Diagnosis, Seen
from truing.report.diagnosis_words import settings_text
from truing.testing.hidden import Hidden
from truing.units import difference_unit, from_si, unit_factor


def advice_on(hidden: Hidden) -> str:
    """Say what to change so that the effect is found."""
    name, diagnosis = hidden.effect or "", hidden.answered.diagnosis
    missing = diagnosis.not_measured.get(name)
    if missing:
        return f"not measured: add {', '.join(missing)} to over"
    seen = _seen(hidden)
    if seen is not None and seen.smallest is None:
        return f"not excited: {_vary(hidden)}"
    if diagnosis.remainder is not None and not diagnosis.causes:
        return f"what was hidden is not the curve of '{name}': look for a sign, a unit, the place where it acts"
    rivals = [item for item in diagnosis.alternatives if name in item.causes]
    if rivals and diagnosis.causes:
        return f"cannot be told apart from '{diagnosis.causes[0].effect}': {_next(diagnosis)}"
    if seen is not None:
        return _too_small(hidden, seen, _size(hidden) / (seen.smallest.value if seen.smallest else 1.0))
    return f"too small for this noise, or what was hidden is not its curve: hide more, or {_vary(hidden)}"


def _seen(hidden: Hidden) -> Seen | None:
    """Return what the diagnosis says of how small the effect may be."""
    known = {item.name: item for item in hidden.answered.diagnosis.seen}
    names = [hidden.effect, *(f"{hidden.effect}.{unknown}" for unknown in hidden.truth)]
    return next((known[name] for name in names if name in known), None)


def _too_small(hidden: Hidden, seen: Seen, factor: float) -> str:
    """Compare what was hidden with what can be seen; ``factor`` is how often it is that."""
    assert seen.smallest is not None
    smallest = quantity_text(seen.smallest.value, seen.smallest.unit)
    if seen.sight == "hidden in the tolerances":
        return (
            f"hidden in the tolerances: what is left of it beside them is seen from {smallest} on; hide more, measure "
            "a result that they do not move, or vary more (over)"
        )
    if factor < 1:
        return f"too small: it is seen from {smallest} on; hide more, measure more rows, or with less noise"
    return (
        f"to be seen from {smallest} on: try another seed; if it is never found, the curve that was hidden is not that "
        f"of '{hidden.effect}' (a sign, a unit), or {_vary(hidden)}"
    )


def _size(hidden: Hidden) -> float:
    """Return the first amplitude that was hidden."""
    amplitudes = [one.name for one in _effect(hidden).unknowns if one.is_amplitude]
    return next((abs(hidden.truth[name]) for name in amplitudes if hidden.truth.get(name)), 0.0)


def _effect(hidden: Hidden) -> Effect[Any, Any]:
    return hidden.setup.model.known_effects[hidden.effect or ""]


def _vary(hidden: Hidden) -> str:
    """Say what to vary: the conditions of the effect, else the inputs."""
    effect = _effect(hidden)
    names = [*(need.made_from or need.name for need in effect.needs), *effect.reads]
    records = hidden.answered.diagnosis.records.covariates
    steady = [name for name in names if name not in records or records[name].is_constant]
    if steady:
        return f"vary {', '.join(steady)} (over)"
    return f"vary {', '.join(names)} further, or an input that brings it out (over)" if names else (
        "vary an input that brings it out (over), or measure a result that it changes (measure)"
    )  # fmt: skip


def _next(diagnosis: Diagnosis) -> str:
    """Say what the diagnosis asks for to tell two causes apart."""
    if not diagnosis.next:
        return "nothing that can be measured here tells them apart; measure another result"
    point = diagnosis.next[0]
    return f"measure {settings_text(point)}" if point.measure else f"measure at {settings_text(point)}"


def hidden_words(hidden: Hidden) -> str:
    """Say what was hidden, with its size."""
    if hidden.effect is None:
        return "something unregistered"
    units = {one.name: one.unit for one in _effect(hidden).unknowns}
    sizes = ", ".join(f"{name} {quantity_text(value, units[name])}" for name, value in hidden.truth.items())
    return f"'{hidden.effect}' ({sizes})"


def quantity_text(value: float, unit: str) -> str:
    """Write an SI number in its unit."""
    return f"{float(from_si(value, unit)):.4g} {unit}".strip()


def difference_text(value: float, unit: str) -> str:
    """Write a difference (an error, a noise), which is SI, in the unit of its result."""
    own = difference_unit(unit)
    return f"{value / unit_factor(own):.3g} {own}".strip()
