"""An expression as data: read once, then computed, proven in its dimensions, and printed with symbols or numbers.

What is printed comes from the same tree that is computed, so a sheet cannot show another formula than the one that
was tested against the function.
"""

from truing.formulas.evaluation import evaluate, evaluate_quantities
from truing.formulas.parsing import parse
from truing.formulas.symbols import symbol_text
from truing.formulas.tree import Formula, Node
from truing.formulas.write_mathml import symbol_mathml

__all__ = ["Formula", "Node", "evaluate", "evaluate_quantities", "parse", "symbol_mathml", "symbol_text"]
