"""What a shape looks like, in words with numbers and units: where it bends, jumps or turns, how long, how high."""

from __future__ import annotations

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, followed_by
from truing.diagnosis.machine import Calibration
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import readable_unit
from truing.numbers import format_number
from truing.units import from_si

SHOWN_DIGITS, PLACE_DIGITS = 2, 3
"""Significant digits of a size, and of where something is on an axis."""
ONE_WAY = 0.9
"""Share of its range between the ends of a trend from which on it rises or falls; else it is curved."""


def in_unit(value: float, unit: str, digits: int = SHOWN_DIGITS) -> str:
    """Write an SI number with its unit."""
    return f"{format_number(float(from_si(value, unit)), digits)} {unit}".strip()


def drawn_by(cause: Candidate) -> tuple[str, ...]:
    """Return the kind of curve that a shape, or an effect of the kernel, draws, and the covariates that it follows."""
    if cause.shape is not None:
        return cause.shape.kind, *cause.shape.depends_on
    kind = {"periodic_order": "order", "step": "step"}.get(cause.name.partition("_of_")[0], "")
    return (kind, followed_by(cause.effect)) if kind and cause.is_kernel else ()


def shape_in_words(machine: Calibration, cause: Candidate, values: Matrix, added: Matrix, unit: str) -> str:
    """Describe a fitted curve by its numbers (SI) and what it adds to a result, SI, (n,): see ``drawn_by``."""
    kind, *names = drawn_by(cause)
    covariate, spanned = machine.records.covariates[names[0]], float(np.ptp(added))
    size, amplitude, change = in_unit(spanned, unit), in_unit(spanned / 2, unit), _change(covariate, added, unit)
    number = float(values[cause.shapes[0]]) if cause.shapes else 0.0
    if kind == "order":
        return f"order {number:g} of {covariate.name}, amplitude {amplitude}"
    if kind == "step":
        return f"step of {in_unit(float(added[np.argmax(np.abs(added))]), unit)} at {_place(covariate, number)}"
    if kind == "wave":
        return f"one wave per {_length(covariate, 1 / number)}, amplitude {amplitude}"
    if kind == "settling":
        return f"settles with a time constant of {_length(covariate, number)}, by {change}"
    if kind == "jump":
        return f"jumps by {change} where {covariate.name} changes its sign"
    if kind == "kink":
        return f"has a kink where {covariate.name} changes its sign, range {size}"
    if kind == "dead zone":
        return f"a dead zone of +-{_length(covariate, number)}, range {size}"
    if kind == "product":
        return f"depends on {' and '.join(names)} together, range {size}"
    return _trend(covariate, added, unit)


def _change(covariate: Covariate, added: Matrix, unit: str) -> str:
    """Write by how much a curve differs between the smallest and the largest value of a covariate."""
    return in_unit(float(added[np.nanargmax(covariate.values)] - added[np.nanargmin(covariate.values)]), unit)


def _place(covariate: Covariate, at: float) -> str:
    return f"{covariate.name} = {in_unit(at, covariate.unit, PLACE_DIGITS)}"


def _length(covariate: Covariate, value: float) -> str:
    """Write a distance along a covariate."""
    length = in_unit(value, readable_unit(covariate.unit, value), PLACE_DIGITS)
    return f"{length} of {covariate.name}" if covariate.role != "time" else length


def _trend(covariate: Covariate, added: Matrix, unit: str) -> str:
    """Describe a trend: rising or falling, or curved with its turning point."""
    order = np.argsort(covariate.values)[: int(np.isfinite(covariate.values).sum())]
    curve, at = added[order], covariate.values[order]
    low, high = int(np.argmin(curve)), int(np.argmax(curve))
    size = in_unit(float(np.ptp(curve)), unit)
    ends = abs(curve[-1] - curve[0]) / max(float(np.ptp(curve)), 1e-300)
    if ends > ONE_WAY:
        way = "rises" if curve[-1] > curve[0] else "falls"
        return f"{way} with {covariate.name}, by {size} over the record"
    turning = low if 0 < low < len(curve) - 1 and abs(curve[low] - curve[0]) >= abs(curve[high] - curve[0]) else high
    kind = "lowest" if turning == low else "highest"
    return f"curved over {covariate.name}, {kind} at {_place(covariate, float(at[turning]))}, range {size}"
