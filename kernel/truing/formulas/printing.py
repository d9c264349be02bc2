"""The doors for printing a formula: in symbols or in numbers, as MathML or as LaTeX."""

from __future__ import annotations

from collections.abc import Mapping

from truing.formulas.layout import substituted, symbolic
from truing.formulas.tree import Formula
from truing.formulas.write_latex import LatexWriter
from truing.formulas.write_mathml import MathMLWriter


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
