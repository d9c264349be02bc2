"""Formulas as print has them, by the writers of MathML and LaTeX: in symbols, or with numbers in their place."""

from __future__ import annotations

from functools import partial

from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_latex import LatexWriter
from truing.formulas.write_mathml import MathMLWriter

mathml, latex = partial(symbolic, MathMLWriter()), partial(symbolic, LatexWriter())
substituted_mathml, substituted_latex = partial(substituted, MathMLWriter()), partial(substituted, LatexWriter())
symbol_latex = LatexWriter().symbol


def block_mathml(*inner: str) -> str:
    """Join "symbol", "expression", "numbers", "result" by equals signs into one displayed formula."""
    return f'<math display="block"><mrow>{"<mo>=</mo>".join(inner)}</mrow></math>'
