"""Three objectives made one: each brought to 0 to 1 over its range, weighed, and added.

The objectives are, in this order, the sum of the shifts (to be large), the difference of the root stresses in MPa and
that of the specific sliding (both to be small). Sources: the paper, its equation 5; Sun Jingmin, Mechanical Optimum
Design, for the curve, of which the paper prints y = x/2 pi - sin x, where a factor 1/(2 pi) is missing.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from truing import Float, TruingError

Range = tuple[float, float]
Three = tuple[float, float, float]
Ranges = tuple[Range, Range, Range]

PRINTED_RANGES: Ranges = ((2.68, 5.38), (0.0, 33.2), (0.0, 3.08))
PRINTED_WEIGHTS: Three = (0.35, 0.01, 0.81)
SENSES: Three = (-1.0, 1.0, 1.0)  # the first is to be large


def normalised(value: Float, reach: Range) -> Float:
    """Return f_r: 0 at the lower end of ``reach``, 1 at the upper, level at both, and clipped beyond.

    f_r = (X - sin X)/(2 pi) with X = 2 pi (value - low)/(high - low). Raises TruingError where the range has no width.
    """
    low, high = reach
    if not (low < high and np.isfinite(high - low)):
        raise TruingError(f"an objective from {low:g} to {high:g} cannot be brought to 0 to 1: its range has no width")
    turn = 2.0 * np.pi * np.clip((value - low) / (high - low), 0.0, 1.0)
    curve: Float = (turn - np.sin(turn)) / (2.0 * np.pi)
    return curve


def weight(reach: Range) -> float:
    """Return the paper's weight of an objective: one over the square of half its range.

    It has a unit, one over that of the objective squared: stresses in other units would weigh otherwise.
    """
    low, high = reach
    if not (low < high and np.isfinite(high - low)):
        raise TruingError(f"an objective from {low:g} to {high:g} has no weight: its range has no width")
    return (0.5 * (high - low)) ** -2


def rule_weights(ranges: Ranges) -> Three:
    """Return the weights of the three objectives by the paper's rule."""
    first, second, third = (weight(reach) for reach in ranges)
    return first, second, third


def lower_limit(given: float, high: float) -> float:
    """Return from which lower limit a weight would follow by the rule, with this upper one."""
    return high - 2.0 / sqrt(given)


def total(objectives: NDArray[np.float64], ranges: Ranges, weights: Three) -> NDArray[np.float64]:
    """Return what is minimised: -w1 fr1 + w2 fr2 + w3 fr3 of objectives (3, n) in the units of the paper.

    An objective of weight 0 is left out, and may be without a range.
    """
    added = np.zeros(objectives.shape[1:])
    for value, reach, share, sense in zip(objectives, ranges, weights, SENSES, strict=True):
        if share:
            added = added + sense * share * normalised(value, reach)
    return added


def weights_of(reading: str, ranges: Ranges) -> Three:
    """Return the weights in one of the readings of the input ``weights``; 0 where an objective has no range.

    Such an objective is the same for every shift: it has nothing to say.
    """
    if reading == "own_ranges":
        found = [weight(reach) if reach[1] > reach[0] else 0.0 for reach in ranges]
    else:
        stated = PRINTED_WEIGHTS if reading == "printed" else rule_weights(PRINTED_RANGES)
        found = [share if high > low else 0.0 for share, (low, high) in zip(stated, ranges, strict=True)]
    return found[0], found[1], found[2]
