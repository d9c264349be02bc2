"""An expression as data: read once, then computed, proven in its dimensions, and printed with symbols or numbers.

What is printed comes from the same tree that is computed, so a sheet cannot show another formula than the one that
was tested against the function.
"""

from __future__ import annotations

from collections.abc import Mapping

from truing.formulas.dimensions import evaluate_quantities
from truing.formulas.evaluation import evaluate
from truing.formulas.layout import substituted, symbolic
from truing.formulas.parsing import parse
from truing.formulas.symbols import symbol_text
from truing.formulas.tree import Formula, Node
from truing.formulas.write_latex import LatexWriter, number_latex, symbol_latex
from truing.formulas.write_mathml import MathMLWriter, block_mathml, number_mathml, symbol_mathml

__all__ = [
    "Formula",
    "Node",
    "block_mathml",
    "evaluate",
    "evaluate_quantities",
    "latex",
    "mathml",
    "number_latex",
    "number_mathml",
    "parse",
    "substituted_latex",
    "substituted_mathml",
    "symbol_latex",
    "symbol_mathml",
    "symbol_text",
]


# The doors for printing a formula: in symbols or in numbers, as MathML or as LaTeX


def mathml(formula: Formula, symbols: Mapping[str, str]) -> str:
    """Write a formula in symbols as MathML Core, without the ``<math>`` around it.

    ``symbols`` maps names to declared symbols; a name without one is printed as an upright word.
    """
    return symbolic(MathMLWriter(), formula, symbols)


def latex(formula: Formula, symbols: Mapping[str, str]) -> str:
    """Write a formula in symbols as LaTeX, without dollar signs."""
    return symbolic(LatexWriter(), formula, symbols)


def substituted_mathml(formula: Formula, numbers: Mapping[str, tuple[str, str]]) -> str:
    """Write a formula with numbers and units in place of the symbols, as MathML Core.

    ``numbers`` maps names to the formatted number and the unit for print, which may be empty. A number text that is
    no number ("–") counts as not given: ``either`` then prints its second argument alone, otherwise its first.
    """
    return substituted(MathMLWriter(), formula, numbers)


def substituted_latex(formula: Formula, numbers: Mapping[str, tuple[str, str]]) -> str:
    """Write a formula with numbers and units in place of the symbols, as LaTeX, without dollar signs."""
    return substituted(LatexWriter(), formula, numbers)
