"""The proof of dimensions: a formula evaluated with pint quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, NoReturn

import numpy as np
import pint

from truing.errors import UnitError
from truing.formulas.evaluation import evaluate, value_of
from truing.formulas.tree import Binary, Call, Comparison, Formula, Logic, Name, Negative, Node, NumberNode, source
from truing.units import human_dimension
from truing.units import registry as shared_registry

KEEPS_DIMENSION = frozenset({"abs", "sum", "mean"})
OF_LIKES = frozenset({"min", "max", "hypot", "either"})
OF_ANGLE = frozenset({"sin", "cos", "tan", "cot", "inv"})

FormulaDimension = tuple[tuple[str, Fraction], ...]
"""Base units and their exponents, sorted, without radians and counts; None where a literal zero fits any dimension."""


def evaluate_quantities(formula: Formula, values: Mapping[str, pint.Quantity[Any]]) -> pint.Quantity[Any]:
    """Evaluate a formula with units and prove its dimensions; the quantity comes back in base units.

    Angles count as pure numbers (a radian is one). A literal 0 fits every dimension: ``max(x, 0)``, ``x > 0``. A power
    of a dimensional base needs one exponent for all points. Numbers without units are taken as pure numbers.
    An equation gives left minus right, after both sides were found to agree.

    Raises:
        UnitError: unlike dimensions are added, compared or offered as alternatives, or a function that needs a pure
            number got something else; the sentence names the part of the formula.
        DeclarationError: a name of the formula has no value.
    """
    registry = _registry_of(values)
    magnitudes: dict[str, Any] = {}
    dimensions: dict[str, FormulaDimension] = {}
    for name in formula.names & values.keys():
        quantity = registry.Quantity(values[name]).to_base_units()
        magnitudes[name] = np.asarray(quantity.magnitude, dtype=float)
        dimensions[name] = _dimension_of(quantity, registry)
    magnitude = evaluate(formula, magnitudes)
    proof = _Proof(formula, dimensions, magnitudes)
    dimension = proof.of(formula.right)
    if formula.left is not None:
        dimension = proof.alike((formula.left, formula.right), "the two sides of the equation")
    units = registry.UnitsContainer({unit: _plain(exponent) for unit, exponent in dimension or ()})
    result: pint.Quantity[Any] = registry.Quantity(magnitude, registry.Unit(units))
    return result


def _registry_of(values: Mapping[str, Any]) -> Any:
    for value in values.values():
        if (registry := getattr(value, "_REGISTRY", None)) is not None:
            return registry
    return shared_registry()


def _dimension_of(quantity: Any, registry: Any) -> FormulaDimension:
    items = [(unit, _exact(exponent)) for unit, exponent in quantity.unit_items()]
    return _sorted({unit: exponent for unit, exponent in items if not registry.Unit(unit).dimensionless})


def _exact(exponent: Any) -> Fraction:
    return Fraction(exponent).limit_denominator(10**6)


def _plain(exponent: Fraction) -> int | float:
    return int(exponent) if exponent.denominator == 1 else float(exponent)


def _sorted(units: Mapping[str, Fraction]) -> FormulaDimension:
    return tuple(sorted((unit, exponent) for unit, exponent in units.items() if exponent))


def _product(first: FormulaDimension, second: FormulaDimension, *, sign: int = 1) -> FormulaDimension:
    total = dict(first)
    for unit, exponent in second:
        total[unit] = total.get(unit, Fraction(0)) + sign * exponent
    return _sorted(total)


def _power(base: FormulaDimension, exponent: Fraction) -> FormulaDimension:
    return _sorted({unit: old * exponent for unit, old in base})


_SHORT = {"meter": "m", "kilogram": "kg", "second": "s", "ampere": "A", "kelvin": "K", "mole": "mol", "candela": "cd"}


def _spoken(dimension: FormulaDimension | None) -> str:
    """Say a dimension in the engineer's words: "a force", "a pure number"."""
    if not dimension:
        return "a pure number"
    unit = "*".join(f"{_SHORT.get(unit, unit)}^{_written(exponent)}" for unit, exponent in dimension)
    try:
        return human_dimension(unit)
    except UnitError:
        return unit


def _written(exponent: Fraction) -> str:
    return str(exponent) if exponent.denominator == 1 else f"({exponent})"


class _Proof:
    """Walks a formula and finds the dimension of each part, or the sentence why there is none."""

    def __init__(
        self, formula: Formula, dimensions: Mapping[str, FormulaDimension], magnitudes: Mapping[str, Any]
    ) -> None:
        self.formula = formula
        self.dimensions = dimensions
        self.magnitudes = magnitudes

    def of(self, node: Node) -> FormulaDimension | None:
        match node:
            case NumberNode(_, 0.0):
                return None
            case Name(name):
                return self.dimensions[name]
            case Negative(operand):
                return self.of(operand)
            case Binary(("+" | "-") as operator, left, right):
                verb = "added" if operator == "+" else "subtracted"
                return self.alike((left, right), f"'{source(node)}': what is {verb}")
            case Binary("**", base, exponent):
                return self.power(node, base, exponent)
            case Binary(operator, left, right):
                above, below = self.of(left), self.of(right)
                if above is None:
                    return None
                return _product(above, below or (), sign=1 if operator == "*" else -1)
            case Call(function, arguments):
                return self.call(node, function, arguments)
            case Comparison(_, operands):
                self.alike(operands, f"'{source(node)}': what is compared")
            case Logic(_, operands):
                for operand in operands:
                    self.of(operand)
        return ()

    def call(self, node: Node, function: str, arguments: tuple[Node, ...]) -> FormulaDimension | None:
        where = f"'{source(node)}'"
        if function == "cases":
            for condition in arguments[1::2]:
                self.of(condition)
            return self.alike((*arguments[:-1:2], arguments[-1]), f"{where}: what is chosen from")
        if function in OF_LIKES:
            return self.alike(arguments, f"{where}: what {function} takes")
        if function == "atan2":
            self.alike(arguments, f"{where}: what atan2 takes")
            return ()
        if function in KEEPS_DIMENSION:
            return self.of(arguments[0])
        if function in ("sqrt", "cbrt"):
            base = self.of(arguments[0])
            return base and _power(base, Fraction(1, 2 if function == "sqrt" else 3))
        if function != "sign":
            wanted = "an angle or a pure number" if function in OF_ANGLE else "a pure number"
            self.pure(arguments[0], f"{where}: {function} needs {wanted}")
        else:
            self.of(arguments[0])
        return ()

    def pure(self, node: Node, sentence: str) -> None:
        if found := self.of(node):
            self.fail(f"{sentence}, not {_spoken(found)} ('{source(node)}')")

    def power(self, node: Node, base: Node, exponent: Node) -> FormulaDimension | None:
        self.pure(exponent, f"'{source(node)}': an exponent must be a pure number")
        dimension = self.of(base)
        if not dimension:
            return dimension
        with np.errstate(all="ignore"):
            value = np.unique(np.asarray(value_of(exponent, self.magnitudes)))
        if value.size != 1 or not np.isfinite(value[0]):
            self.fail(f"'{source(node)}': {_spoken(dimension)} is raised to a power that is not one finite number")
        return _power(dimension, _exact(float(value[0])))

    def alike(self, nodes: Sequence[Node], sentence: str) -> FormulaDimension | None:
        """Return the dimension all nodes share; a literal zero shares any."""
        first: tuple[Node, FormulaDimension] | None = None
        for node in nodes:
            found = self.of(node)
            if found is None:
                continue
            if first is None:
                first = (node, found)
            elif found != first[1]:
                self.fail(
                    f"{sentence} must have one dimension, but '{source(first[0])}' is {_spoken(first[1])} "
                    f"and '{source(node)}' is {_spoken(found)}"
                )
        return None if first is None else first[1]

    def fail(self, sentence: str) -> NoReturn:
        raise UnitError(f"formula {self.formula.text!r}: {sentence}")
