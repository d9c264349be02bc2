"""An expression as data: read once, then computed, proven in its dimensions, and printed with symbols or numbers.

What is printed comes from the same tree that is computed, so a sheet cannot show another formula than the one that
was tested against the function.
"""

from truing.formulas.dimensions import evaluate_quantities
from truing.formulas.evaluation import evaluate
from truing.formulas.parsing import parse
from truing.formulas.printing import latex, mathml, substituted_latex, substituted_mathml
from truing.formulas.symbols import symbol_text
from truing.formulas.tree import Formula, Node
from truing.formulas.write_latex import number_latex, symbol_latex
from truing.formulas.write_mathml import block_mathml, number_mathml, symbol_mathml

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
