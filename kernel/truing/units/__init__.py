"""Units at the edges: texts become SI numbers when they are read, and SI numbers become texts when they are printed.

SI means coherent base units (m, kg, s, K, A, mol, cd; N, Pa, J, W are coherent) and radian for angles. Two things that
pint lets through are held apart here:

- *Angles.* For pint a radian is the number 1. Here every unit keeps its angle exponent, and what is given must have the
  one that was declared: ``rad/s`` is not ``rpm``. ``rev``, ``turn`` and ``cycle`` are counts: rpm is 1/60 1/s.
- *Temperatures.* A declared ``degC`` or ``degF`` is a level, inside in kelvin; a declared ``K`` or ``delta_degC`` is
  a difference. Inside a compound unit (``um/degC``) a degree is a step.

Every fault of a text is one UnitError with one sentence; pint sees single full names only, never a user's text.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from truing.errors import UnitError
from truing.units import grammar, names
from truing.units.grammar import Quantity, shown
from truing.units.grammar import split as split_quantity
from truing.units.meaning import Dimension, Meaning, case_variants, meaning, registry, split_prefix, without_prefix

__all__ = [
    "Quantity", "check_unit", "demand_dimension", "difference_unit", "from_si", "human_dimension", "pint_quantity",
    "quantity", "read_quantity", "registry", "same_dimension", "si_fault", "split_quantity", "to_si", "unit_factor",
    "unit_text",
]  # fmt: skip

_DIMENSIONS = {
    "meter": "[length]", "kilogram": "[mass]", "second": "[time]", "ampere": "[current]", "kelvin": "[temperature]",
    "mole": "[substance]", "candela": "[luminosity]",
}  # fmt: skip
ROUNDING_OF_ZERO = 1e-9
"""Kelvin below absolute zero that are rounding: -459.67 degF is 0 K."""
_PER_SECOND = (("second", Fraction(-1)),)


def read_quantity(text: str, unit: str) -> float:
    """Read a text as a quantity of the dimension of *unit* and give it in SI (levels of temperature in kelvin).

    Raises UnitError with one sentence: no number, no unit, an unknown unit, another dimension, another kind of angle.
    """
    declared = meaning(unit)
    if not text.strip():
        raise UnitError(f"the text is empty; expected {_example(1.0, unit)}")
    quantity = split_quantity(text)
    if quantity.unit:
        _demand(text, quantity.unit, unit, quantity.value)
        is_bare_power = not grammar.parse(quantity.unit).factors and grammar.parse(quantity.unit).power
        if is_bare_power and not grammar.parse(unit).power:
            raise UnitError(f"{shown(text)} is two numbers; write one")
    elif declared.dimension or declared.angle or declared.factor != 1:
        raise UnitError(f"{shown(text)} has no unit; expected {_example(quantity.value, unit)}")
    value = to_si(quantity.value, quantity.unit)
    if declared.level and -ROUNDING_OF_ZERO <= value < 0:
        return 0.0
    fault = si_fault(quantity.value, value, unit)
    if fault:
        raise UnitError(f"{shown(text)} {fault}")
    return value


def si_fault(written: float, value: float, unit: str) -> str:
    """Return what is wrong with a number brought from *written* to SI where *unit* is declared, or nothing.

    One rule for texts and for cells of a table: not beyond what a number can hold, no level below absolute zero.
    """
    is_level = meaning(unit).level
    if not math.isfinite(value):
        return "is too large for a number in SI units"
    if value == 0 and written != 0 and not is_level:
        return "is too small for a number in SI units"
    return "lies below absolute zero" if is_level and value < -ROUNDING_OF_ZERO else ""


def demand_dimension(given: str, unit: str) -> None:
    """Check that numbers in the unit *given* (the header of a column) can be read where *unit* is declared.

    Raises UnitError for an unknown unit, another dimension, another kind of angle, a level for a difference.
    """
    _demand(given, given, unit, None)


def check_unit(unit: str) -> None:
    """Raise UnitError, with a near miss if there is one, unless the text is a unit that Truing knows."""
    meaning(unit)


def same_dimension(unit_a: str, unit_b: str) -> bool:
    """Say whether two units measure the same thing: dimension and angle; a level and a difference count as the same."""
    return meaning(unit_a).same_kind(meaning(unit_b))


def difference_unit(unit: str) -> str:
    """Return the unit of a difference: K for a level in degC, delta_degF for one in degF, else the unit itself."""
    known = meaning(unit)
    return unit if not known.level else "K" if known.factor == 1 else "delta_degF"


@overload
def to_si(value: float, unit: str) -> float: ...
@overload
def to_si(value: NDArray[Any], unit: str) -> NDArray[np.float64]: ...
def to_si(value: float | NDArray[Any], unit: str) -> float | NDArray[np.float64]:
    """Bring a number or an array from *unit* to SI; temperature levels (degC, degF) to kelvin."""
    known = meaning(unit)
    plain = float(value) if isinstance(value, (int, float)) else value
    scaled = plain / known.divisor if known.divisor else plain * known.factor
    return scaled + known.offset if known.offset else scaled


@overload
def from_si(value: float, unit: str) -> float: ...
@overload
def from_si(value: NDArray[Any], unit: str) -> NDArray[np.float64]: ...
def from_si(value: float | NDArray[Any], unit: str) -> float | NDArray[np.float64]:
    """Bring a number or an array from SI to *unit*; kelvin to degC or degF where these are levels."""
    known = meaning(unit)
    plain = float(value) if isinstance(value, (int, float)) else value
    if known.offset:
        plain = plain - known.offset
    return plain * known.divisor if known.divisor else plain / known.factor


def unit_factor(unit: str) -> float:
    """Give the size of one step of *unit* in SI: 0.001 for mm, 1.0 for degC."""
    return meaning(unit).factor


def pint_quantity(value_si: Any, unit: str) -> Any:
    """Make a pint quantity in base units of the dimension of *unit*, for proving the dimensions of formulas.

    Radian is left out: for pint it is the number 1.
    """
    dimension = meaning(unit).dimension
    base = {name: int(power) if power.denominator == 1 else float(power) for name, power in dimension}
    units = registry()
    return units.Quantity(value_si, units.UnitsContainer(base))


@lru_cache(maxsize=1024)
def human_dimension(unit: str) -> str:
    """Say what a unit measures in an engineer's words: "a length"; "[length]**2/[time]" where there is no word."""
    known = meaning(unit)
    if known.level:
        return "a temperature level"
    used = {name for name, _ in grammar.parse(unit).factors}
    kind = _kinds().get((known.dimension, known.angle))
    if kind == "a torque" and any(without_prefix(name) in names.ENERGY_NAMES for name in used):
        return "an energy or work"
    if kind == "a frequency or rotational speed" and used:
        if used & names.ROTATION_NAMES:
            return "a rotational speed"
        return "a frequency" if any(without_prefix(name) == "Hz" for name in used) else kind
    return kind or _formal(known)


@lru_cache(maxsize=1024)
def unit_text(unit: str) -> str:
    """Write a unit for people: "N*m" as N·m, "um" as µm, "m/s^2" as m/s², "degC" as °C, a pure number as nothing."""
    meaning(unit)
    product = grammar.parse(unit)
    ten = [f"10{_superscript(Fraction(product.power))}"] if product.power else []
    above = [*ten, *(_raised(name, exponent) for name, exponent in product.factors if exponent > 0)]
    below = [_raised(name, -exponent) for name, exponent in product.factors if exponent < 0]
    if not below:
        return "·".join(above)
    return f"{'·'.join(above) or '1'}/{below[0] if len(below) == 1 else '(' + '·'.join(below) + ')'}"


def _raised(name: str, exponent: Fraction) -> str:
    raised = _superscript(exponent) if exponent != 1 else ""
    if name in names.PRINTED:
        return names.PRINTED[name] + raised
    prefix, bare = split_prefix(name)
    return prefix.replace("u", "µ") + names.PRINTED.get(bare, bare) + raised


def _superscript(exponent: Fraction) -> str:
    if exponent.denominator != 1:
        return f"^{_decimal(exponent)}"
    return str(exponent.numerator).translate(str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"))


def _decimal(exponent: Fraction) -> str:
    short = f"{float(exponent):.6g}"
    return short if Fraction(short) == exponent else f"({exponent})"


quantity = read_quantity
"""What readers of data files call it, who read as an inputs file is read: ``quantity("0.4 um", "m")`` is 4e-7."""


def _example(value: float, unit: str) -> str:
    return f"{human_dimension(unit)} such as {shown(f'{_shortest(value)} {unit}')}"


def _shortest(value: float) -> str:
    return repr(int(value)) if value.is_integer() and abs(value) < 1e6 else f"{value:.6g}"


@lru_cache(maxsize=1)
def _kinds() -> dict[tuple[Dimension, Fraction], str]:
    kinds: dict[tuple[Dimension, Fraction], str] = {}
    for text, words in names.KINDS:
        known = meaning(text)
        kinds.setdefault((known.dimension, known.angle), words)
    return kinds


def _formal(known: Meaning) -> str:
    parts = [(_DIMENSIONS.get(name, f"[{name}]"), exponent) for name, exponent in known.dimension]
    parts += [("[angle]", known.angle)] if known.angle else []

    def one(name: str, exponent: Fraction) -> str:
        return name if exponent == 1 else f"{name}**{_decimal(exponent)}"

    above = "*".join(one(name, exponent) for name, exponent in parts if exponent > 0)
    return "/".join([above or "1", *(one(name, -exponent) for name, exponent in parts if exponent < 0)])


def _demand(text: str, given_unit: str, unit: str, value: float | None) -> None:
    """Refuse another kind of quantity; *value* makes the advice concrete where there is one number."""
    declared, given = meaning(unit), meaning(given_unit)
    if not given.same_kind(declared):
        raise UnitError(f"{shown(text)} {_mismatch(given_unit, unit, value)}")
    number = "in" if value is None else _shortest(value)
    if given.level and not declared.level:
        step = "K" if given.factor == 1 else "delta_degF"
        raise UnitError(f"{shown(text)} is a temperature level; a difference is written {number} {step}")
    if declared.level and not given.level and not _is_kelvin(given_unit):
        raise UnitError(f"{shown(text)} is a temperature difference; a level is written {number} {unit}")


def _is_kelvin(unit: str) -> bool:
    """Tell whether a unit of temperature is the kelvin alone, in which levels are written too."""
    (name, exponent), *others = grammar.parse(unit).factors
    return exponent == 1 and not others and without_prefix(name) == "K"


def _mismatch(given_unit: str, unit: str, value: float | None) -> str:
    declared, given = meaning(unit), meaning(given_unit)
    sentence = f"is {_described(given_unit)}, expected {_described(unit)}"
    if given.dimension != declared.dimension:
        return sentence + _instead(given_unit, declared)
    if given.dimension == _PER_SECOND and {given.angle, declared.angle} == {Fraction(0), Fraction(1)}:
        divide = given.angle == 1
        si = None if value is None else to_si(value, given_unit)
        there = "" if si is None else f": {_turned(si, divide)}"
        return f"{sentence}; {'divide' if divide else 'multiply'} by 2 pi{there}"
    return f"{sentence}; the two differ by an angle" if given.dimension else sentence


def _turned(si: float, divide: bool) -> str:
    return f"{si / (2 * math.pi):.7g} 1/s" if divide else f"{si * 2 * math.pi:.7g} rad/s"


def _described(unit: str) -> str:
    printed = unit_text(unit)
    return f"{human_dimension(unit)} ({printed})" if printed else human_dimension(unit)


def _instead(given: str, declared: Meaning) -> str:
    """Suggest a unit that is written nearly the same and has the right dimension: Nm for nm, degC for C."""
    for name in (*({"C": ["degC"], "F": ["degF"]}.get(given, [])), *case_variants(given)):
        if meaning(name).same_kind(declared):
            return f"; did you mean {shown(name)}?"
    return ""
