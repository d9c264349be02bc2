"""Choosing a group by several criteria at once: which groups no other beats, and which lies nearest to the best of all.

A criterion is a column of the list, (groups,). Nothing is weighed: a group is on the front where no other one is at
least as good in every criterion and better in one (Pareto). The compromise is what is left to taste; here it is the
distance to the best of all criteria at once, each scaled to 0 (best of the front) to 1 (worst of it).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from truing import Array

LARGE_IS_BETTER = ("efficiency", "reserve")  # and every safety; of all else little is better
STEPS = {"deviation": 1e-3, "reserve": 0.05, "centre_distance": 1e-3, "efficiency": 1e-3}
"""What counts as a difference at all, SI: 0.1 % of the ratio, 0.05 of a safety, 1 mm, 0.1 % of the efficiency."""


def costs(name: str, values: Array) -> Array:
    """Return a column as something that should be small, in whole steps, NaN as the worst there is.

    A deviation counts by its size.
    """
    cost = np.abs(values) if name == "deviation" else values
    cost = -cost if name in LARGE_IS_BETTER or name.endswith(("safety_sun", "safety_planet")) else cost
    step = STEPS.get(name, 0.05 if "safety" in name else 0.0)
    return np.where(np.isnan(cost), np.inf, np.rint(cost / step) * step if step else cost)


def unbeaten(criteria: Sequence[Array]) -> NDArray[np.bool_]:
    """Say of every group whether no other is as good in all criteria and better in one; (groups,) of costs each."""
    table = np.stack([np.asarray(each, dtype=float) for each in criteria], axis=-1)
    front = np.ones(len(table), dtype=bool)
    for place, own in enumerate(table):
        others = table[front]
        front[place] = not np.any((others <= own).all(axis=1) & (others < own).any(axis=1))
    return front


def distance_to_best(criteria: Sequence[Array], front: NDArray[np.bool_]) -> Array:
    """Return how far each group of the front lies from the best of all criteria at once; NaN off the front.

    Each criterion counts 0 at its best on the front and 1 at its worst there; one that is the same for all counts 0.
    """
    squares = np.zeros(len(front))
    for cost in criteria:
        held = cost[front & np.isfinite(cost)]
        low, high = (float(np.min(held)), float(np.max(held))) if len(held) else (0.0, 0.0)
        scaled = (cost - low) / (high - low) if high > low else np.zeros(len(front))
        squares = squares + np.square(np.where(np.isfinite(scaled), scaled, 1.0))
    return np.where(front, np.sqrt(squares), np.nan)
