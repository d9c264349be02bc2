"""What a tolerance costs: the paper's three cost functions, each in three readings of its lost equations.

The paper's text names the coefficients of equations 25 to 27; the equations are lost. The number of coefficients fits
the families of Z. Dong, W. Hu, D. Xue, New production cost-tolerance models for tolerance synthesis, J. Eng. for
Industry 116 (1994) 199. Every formula is in the width of the zone in mm and gives yuan. Only the power form gives the
printed total of 1402 yuan.
"""

from typing import Literal

from truing import Price

Kind = Literal["size", "place", "runout"]
FORMS = ("power", "exponential", "process")

# Equations 25 (size), 26 (place) and 27 (runout) with the coefficients of the paper.
FORMULAS: dict[str, dict[Kind, str]] = {
    "power": {
        "size": "16.140 * width**-0.324 + 0.217 * exp(-0.013 * width) + 2.845",
        "place": "4.862 * width**-0.483 + 0.877 * exp(-1.020 * width)",
        "runout": "23.729 * width**-0.682",
    },
    "exponential": {
        "size": "16.140 * exp(-0.324 * width) + 0.217 * exp(-0.013 * width) + 2.845",
        "place": "4.862 * exp(-0.483 * width) + 0.877 * exp(-1.020 * width)",
        "runout": "23.729 * exp(-0.682 * width)",
    },
    "process": {
        "size": "16.140 * exp(-0.324 * width) + width / (0.217 * width + 0.013) + 2.845",
        "place": "4.862 * exp(-0.483 * width) + width / (0.877 * width + 1.020)",
        "runout": "23.729 * exp(-0.682 * width)",
    },
}


def price(kind: Kind, form: str) -> Price:
    """Return the price of a tolerance of this kind in one form."""
    return Price(FORMULAS[form][kind], width="mm", unit="yuan")
