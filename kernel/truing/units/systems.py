"""Systems of units: which unit stands for which on a sheet in SI, or in inches and pounds.

One table of whole units and one of names decide. A whole unit is looked up by what it means, so ``N/mm²`` is found as
``MPa``; what is not in that table is taken apart and brought over name by name (``um/K`` to ``uin/delta_degF``). A unit
without a counterpart stays as it is: angles, pure numbers, times, speeds of rotation, electric units, money.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from typing import Literal, TypeAlias

from truing.units import grammar
from truing.units.meaning import Meaning, meaning

UnitSystem: TypeAlias = Literal["", "SI", "inch"]
"""Millimetre and newton, or inch and pound (US customary); "" leaves every unit as it is declared."""
UNIT_SYSTEMS: tuple[UnitSystem, ...] = ("SI", "inch")

WHOLE: Mapping[str, Mapping[str, str]] = {
    "inch": {
        "MPa": "ksi", "GPa": "Mpsi", "kPa": "psi", "Pa": "psi", "hPa": "psi", "bar": "psi", "mbar": "psi",
        "MPa*m^0.5": "ksi*in^0.5",
        "Pa*s": "Pa*s", "mPa*s": "mPa*s", "mm^2/s": "cSt",
        "km/h": "mph", "g/cm^3": "lb/in^3",
        "N/m": "lbf/in", "kN/m": "lbf/in", "N/mm": "lbf/in", "N/um": "lbf/in", "kN/mm": "lbf/in", "m/N": "in/lbf",
        "W/(m*K)": "BTU/(h*ft*delta_degF)", "W/(m^2*K)": "BTU/(h*ft^2*delta_degF)", "W/m^2": "BTU/(h*ft^2)",
        "W/K": "BTU/(h*delta_degF)", "K/W": "h*delta_degF/BTU",
        "J/(kg*K)": "BTU/(lb*delta_degF)", "kJ/(kg*K)": "BTU/(lb*delta_degF)", "J/kg": "BTU/lb", "kJ/kg": "BTU/lb",
        "J/K": "BTU/delta_degF", "kJ/K": "BTU/delta_degF",
    },
    "SI": {
        "lbf/in": "N/mm", "lbf/ft": "N/m", "lb/in^3": "kg/m^3", "lb/ft^3": "kg/m^3", "ksi*in^0.5": "MPa*m^0.5",
        "psi*s": "Pa*s", "in/lbf": "mm/N",
        "BTU/(h*ft*delta_degF)": "W/(m*K)", "BTU/(h*ft^2*delta_degF)": "W/(m^2*K)", "BTU/(h*ft^2)": "W/m^2",
        "BTU/(h*delta_degF)": "W/K", "h*delta_degF/BTU": "K/W", "BTU/h": "W",
        "BTU/(lb*delta_degF)": "kJ/(kg*K)", "BTU/lb": "kJ/kg", "BTU/delta_degF": "kJ/K",
    },
}  # fmt: skip
"""Units that are more than the product of their parts. Stress goes to ksi, pressures to psi, moduli to Mpsi; stiffness
and line load to lbf/in, whatever length they were per. Viscosities keep the units in which lubricants are sold."""

NAMES: Mapping[str, Mapping[str, str]] = {
    "inch": {
        "mm": "in", "cm": "in", "dm": "in", "m": "ft", "km": "mi", "um": "uin", "micron": "uin", "nm": "uin",
        "pm": "uin",
        "N": "lbf", "kN": "lbf", "MN": "kip", "GN": "kip", "mN": "lbf", "uN": "lbf", "nN": "lbf", "daN": "lbf",
        "kgf": "lbf", "gf": "lbf",
        "Pa": "psi", "kPa": "psi", "hPa": "psi", "bar": "psi", "mbar": "psi", "MPa": "ksi", "GPa": "Mpsi",
        "kg": "lb", "g": "oz", "mg": "oz", "t": "lb",
        "K": "delta_degF", "mK": "delta_degF", "delta_degC": "delta_degF", "degC": "delta_degF",
        "J": "ft*lbf", "mJ": "ft*lbf", "kJ": "BTU", "MJ": "BTU",
        "W": "hp", "mW": "hp", "kW": "hp", "MW": "hp", "PS": "hp",
        "l": "gal", "L": "gal", "ml": "in^3", "mL": "in^3", "ha": "ft^2",
    },
    "SI": {
        "in": "mm", "inch": "mm", "uin": "um", "uinch": "um", "minch": "mm", "thou": "um", "mil": "um", "ft": "m",
        "yd": "m", "mi": "km",
        "lbf": "N", "klbf": "kN", "kip": "kN", "kgf": "N", "gf": "N", "dyn": "N",
        "psi": "kPa", "kpsi": "MPa", "ksi": "MPa", "Mpsi": "GPa",
        "lb": "kg", "lbm": "kg", "oz": "g", "slug": "kg",
        "delta_degF": "K", "degF": "K",
        "hp": "kW", "PS": "kW", "BTU": "kJ", "gal": "l", "mph": "km/h",
    },
}  # fmt: skip
"""One name for another, exponents kept; a degree inside a compound unit is a step."""

LEVELS: Mapping[str, Mapping[str, str]] = {"inch": {"degC": "degF"}, "SI": {"degF": "degC"}}
FORCES = frozenset({"N", "kN", "MN", "GN", "mN", "uN", "nN", "daN", "kgf", "gf"})
ARMS: Mapping[str, str] = {"m": "ft", "km": "ft", "dm": "in", "cm": "in", "mm": "in", "um": "in"}
SMALL_FORCES = frozenset({"mN", "uN", "nN", "gf"})
"""A torque of one of these is small: mN·m becomes lbf·in, as N·mm does; N·m and kN·m become lbf·ft."""
TORQUES_IN_POUNDS = frozenset({("lbf", "ft"), ("lbf", "in"), ("ft", "lbf"), ("in", "lbf")})
Factors: TypeAlias = tuple[tuple[str, Fraction], ...]


@lru_cache(maxsize=2048)
def in_system(unit: str, system: UnitSystem) -> str:
    """Return the unit in which a quantity of *unit* stands on a sheet of this system; itself without a counterpart.

    The unit that comes back has the same dimension and the same angle. Raises UnitError for what is no unit.
    """
    known = meaning(unit)
    if not system:
        return unit
    product = grammar.parse(unit)
    if known.level:
        return LEVELS[system].get(product.factors[0][0], unit)
    whole = _whole(system).get(_key(known))
    if whole is not None:
        return whole
    left, torque = _torque(product.factors, system)
    factors = [*torque, *_brought_over(left, system)]
    return unit if tuple(factors) == product.factors else _written(product.power, factors)


def _key(known: Meaning) -> tuple[object, ...]:
    """Return what a unit means, to rounding."""
    return (known.dimension, known.angle, f"{known.factor:.10g}")


@lru_cache(maxsize=4)
def _whole(system: str) -> Mapping[tuple[object, ...], str]:
    return {_key(meaning(unit)): other for unit, other in WHOLE[system].items()}


def _torque(factors: Factors, system: str) -> tuple[Factors, Factors]:
    """Take a force times a length out of a product, above the line or below it, and return the rest and its pair."""
    for exponent in (Fraction(1), Fraction(-1)):
        names = [name for name, own in factors if own == exponent]
        if system == "inch":
            force = next((name for name in names if name in FORCES), "")
            arm = next((name for name in names if name in ARMS), "")
            pair = ("lbf", "in" if force in SMALL_FORCES else ARMS.get(arm, ""))
        else:
            force, arm = next((pair for pair in TORQUES_IN_POUNDS if {*pair} <= {*names}), ("", ""))
            pair = ("N", "m")
        if force and arm:
            rest = tuple(each for each in factors if each not in {(force, exponent), (arm, exponent)})
            return rest, tuple((name, exponent) for name in pair)
    return factors, ()


def _brought_over(factors: Factors, system: str) -> list[tuple[str, Fraction]]:
    return [
        (name, exponent * own)
        for old, exponent in factors
        for name, own in grammar.parse(NAMES[system].get(old, old)).factors
    ]


def _written(power: int, factors: list[tuple[str, Fraction]]) -> str:
    """Write factors as a unit text that is read back as the same product; of one name the exponents are added up."""
    exponents: dict[str, Fraction] = {}
    for name, exponent in factors:
        exponents[name] = exponents.get(name, Fraction(0)) + exponent
    above = [_raised(name, exponent) for name, exponent in exponents.items() if exponent > 0]
    below = [_raised(name, -exponent) for name, exponent in exponents.items() if exponent < 0]
    head = "*".join([*([f"10^{power}"] if power else []), *above]) or "1"
    return f"{head}/({'*'.join(below)})" if len(below) > 1 else f"{head}/{below[0]}" if below else head


def _raised(name: str, exponent: Fraction) -> str:
    if exponent == 1:
        return name
    return f"{name}^{exponent}" if exponent.denominator == 1 else f"{name}^({exponent})"
