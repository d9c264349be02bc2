"""What a unit text means: its size in SI, its dimension, its angle exponent; and the one pint registry behind it.

What the units of our symbols are stands in ``sizes``. pint is asked for other single full names only ("furlong"), never
for a user's text.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from hashlib import sha256
from threading import Lock
from typing import Any

from platformdirs import user_cache_path

from truing.errors import UnitError
from truing.heavy import pint
from truing.units import grammar, names
from truing.units.grammar import shown
from truing.units.sizes import SIZES

_BUILDING = Lock()
Dimension = tuple[tuple[str, Fraction], ...]
"""Base units of pint with their exponents, in order: (("meter", 1), ("second", -2))."""


@dataclass(frozen=True)
class Meaning:
    """SI = value * factor + offset; where *divisor* is not 0, dividing by it is more exact than the factor."""

    factor: float
    divisor: float
    offset: float
    dimension: Dimension
    angle: Fraction
    level: bool = False

    def same_kind(self, other: Meaning) -> bool:
        """Say whether both have the same dimension and the same angle exponent."""
        return self.dimension == other.dimension and self.angle == other.angle


def registry() -> pint.UnitRegistry[Any]:
    """Give the one pint registry; built at the first call, with the currencies as dimensions of their own."""
    with _BUILDING:
        return _registry()


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[Any]:
    built: pint.UnitRegistry[Any]
    home = sha256(pint.__file__.encode()).hexdigest()[:16]  # a cache holds paths of the pint that wrote it
    try:
        built = pint.UnitRegistry(cache_folder=user_cache_path("truing") / "pint" / home)
    except Exception:  # a cache that cannot be written, or was torn by another process, must not stop a calculation
        built = pint.UnitRegistry()
    for currency in names.CURRENCIES:
        built.define(f"{currency} = [currency_{currency}]")
    return built


@lru_cache(maxsize=2048)
def meaning(text: str) -> Meaning:
    """Look up a unit text. Raises UnitError with one sentence for a text that is no unit or holds an unknown one."""
    product = grammar.parse(text)
    scales = {name for name, _ in product.factors if name in names.LEVELS}
    if scales and len(product.factors) == 1 and product.factors[0][1] == 1:
        return _level(text, product)
    logarithm, factor, angle = float(product.power), 10.0**product.power, Fraction(0)
    dimension: dict[str, Fraction] = {}
    for name, exponent in product.factors:
        part = _named(name)
        logarithm += float(exponent) * math.log10(part.factor)
        if abs(logarithm) > 200:
            raise UnitError(f"the unit {shown(text)} is too large or too small for a number")
        factor *= part.factor ** (int(exponent) if exponent.denominator == 1 else float(exponent))
        angle += exponent * part.angle
        for base, own in part.dimension:
            dimension[base] = dimension.get(base, Fraction(0)) + exponent * own
    left = tuple(sorted((base, own) for base, own in dimension.items() if own))
    if scales and left == _KELVIN and not angle:
        raise UnitError(f"{shown(text)} may be a temperature level or a difference; write {scales.pop()} alone, or K")
    return _made(factor, left, angle)


_KELVIN: Dimension = (("kelvin", Fraction(1)),)


def _made(factor: float, dimension: Dimension, angle: Fraction) -> Meaning:
    """Free a factor of its rounding errors; divide where the factor is the inverse of a whole number (0.36 mm)."""
    short = float(f"{factor:.12g}")
    exact = short if abs(short - factor) <= 4e-15 * factor else factor
    inverse = float(f"{1 / exact:.12g}")
    if exact < 1 and inverse.is_integer() and abs(inverse * exact - 1) < 4e-15:
        return Meaning(1 / inverse, inverse, 0.0, dimension, angle)
    return Meaning(exact, 0.0, 0.0, dimension, angle)


def _level(text: str, product: grammar.Product) -> Meaning:
    if product.power:
        raise UnitError(f"{shown(text)} is a temperature level and carries no power of ten")
    factor, offset = names.LEVELS[product.factors[0][0]]
    return Meaning(factor, 0.0, offset, _KELVIN, Fraction(0), level=True)


@lru_cache(maxsize=1024)
def _named(name: str) -> Meaning:
    """Look up one name without its exponent; a scale of temperature is a step here."""
    step = names.DIFFERENCES.get(name) or (names.LEVELS[name][0] if name in names.LEVELS else 0.0)
    if step:
        return Meaning(step, 0.0, 0.0, _KELVIN, Fraction(0))
    prefix, bare = split_prefix(name)
    if bare in names.SYMBOLS:
        definition = names.SYMBOLS[bare][0]
        own = meaning(definition) if not definition.isidentifier() else _of_size(*SIZES[definition])
        power = names.PREFIXES[prefix] if prefix else 0
        factor = own.factor * 10.0**power if power >= 0 else own.factor / 10.0**-power
        return _made(factor, own.dimension, own.angle)
    if _full_name(name):
        return _from_pint(name)
    raise UnitError(f"unknown unit {shown(name)}{_near(name)}")


def split_prefix(name: str) -> tuple[str, str]:
    """Take the prefix off a known symbol: "um" is ("u", "m"), "min" is ("", "min")."""
    if name in names.SYMBOLS:
        return "", name
    for prefix in names.PREFIXES:
        bare = name.removeprefix(prefix)
        if bare != name and bare in names.SYMBOLS and prefix in names.SYMBOLS[bare][1].split():
            return prefix, bare
    return "", name


def without_prefix(name: str) -> str:
    """Give the symbol behind the prefix: "kWh" is "Wh"."""
    return split_prefix(name)[1]


def _full_name(name: str) -> bool:
    """Say whether pint knows *name* as the full name of a unit: "furlong", "millimeters", but not "kph".

    What is a pure number or an amount of data there (decade, decibel, byte, alpha) is none here.
    """
    if len(name) < 4 or not name.isalpha() or not name.islower():
        return False
    units = registry()
    try:
        readings = [parts for parts in units.parse_unit_name(name) if "".join(parts) == name]
        known = [unit for _, unit, _ in readings if unit not in names.NOT_FROM_PINT]
        return any(units._units[unit].is_multiplicative and _is_quantity(unit) for unit in known)
    except Exception:  # whatever pint says of a strange name, it is no unit of ours
        return False


def _is_quantity(name: str) -> bool:
    bases = dict(registry().get_base_units(name)[1]._units)
    return "bit" not in bases and bool(set(bases) - {"count"})


@lru_cache(maxsize=1024)
def _from_pint(name: str) -> Meaning:
    size, base = registry().get_base_units(name)
    factor: Any = size
    bases = (f"{unit}^{Fraction(str(exponent)).limit_denominator(12)}" for unit, exponent in dict(base._units).items())
    return _of_size(float(factor), " ".join(bases))


def _of_size(factor: float, bases: str) -> Meaning:
    """Make a meaning of a size in SI and of base units with their exponents ("kilogram meter second^-2")."""
    exponents = {unit: Fraction(exponent or 1) for unit, _, exponent in (base.partition("^") for base in bases.split())}
    angle = exponents.pop("radian", Fraction(0))
    exponents.pop("count", None)
    return _made(factor, tuple(sorted(exponents.items())), angle)


def _near(name: str) -> str:
    """Find the known unit that a misspelt name is nearest to; wrong case first."""
    for variant in case_variants(name):
        return f"; did you mean {shown(variant)}?"
    for prefix, power in names.PREFIXES.items():
        bare = name.removeprefix(prefix)
        if bare != name and len(bare) > 1 and (bare in names.SYMBOLS or bare in names.SPELLINGS):
            return f"; {shown(bare)} takes no prefix {shown(prefix)}: write {shown(f'10^{power} {bare}')}"
    scored = [
        (difflib.SequenceMatcher(None, name, known).ratio() - 0.001 * abs(len(known) - len(name)), -index, known)
        for index, known in enumerate(_suggestions())
    ]
    ratio, _, known = max(scored)
    return f"; did you mean {shown(known)}?" if ratio > 0.6 else ""


def case_variants(name: str) -> Iterator[str]:
    """Give the known units that differ from a name in upper and lower case only, the common ones first."""
    return (known for known in _suggestions() if known.lower() == name.lower() and known != name)


@lru_cache(maxsize=1)
def _suggestions() -> tuple[str, ...]:
    """List every name with its prefixes, the common ones first."""
    prefixed = [
        (rank, index, prefix + symbol)
        for index, (symbol, (_, prefixes)) in enumerate(names.SYMBOLS.items())
        for rank, prefix in enumerate(["", *prefixes.split()])
    ]
    common = ["mm", "kN", "MPa", "GPa", "Nm", "Nmm", "kNm", "kg", "um", "kW", "degC", "rpm"]
    ordinary = [name for _, _, name in sorted(prefixed)]
    others = [*names.LEVELS, *names.DIFFERENCES, *(name for name in names.SPELLINGS if name.isascii())]
    return tuple(dict.fromkeys([*common, *ordinary, *others]))
