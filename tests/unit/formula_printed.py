"""Formulas as print has them, by the writers of MathML and LaTeX: in symbols, or with numbers in their place."""

from __future__ import annotations

from functools import partial

from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_latex import LATEX, symbol_latex
from truing.formulas.write_mathml import MATHML

__all__ = ["latex", "mathml", "substituted_latex", "substituted_mathml", "symbol_latex"]
mathml, latex = partial(symbolic, MATHML), partial(symbolic, LATEX)
substituted_mathml, substituted_latex = partial(substituted, MATHML), partial(substituted, LATEX)
