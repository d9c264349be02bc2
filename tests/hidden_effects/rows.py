"""What every machine of the generators shares: rows as they were measured, and unknowns of what is hidden."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Hidden: TypeAlias = Mapping[str, Mapping[str, float]]
"""Unknown by effect, in the units of the registry; those of the press in SI."""


@dataclass(frozen=True, kw_only=True)
class MeasuredRows:
    """What was set and measured beside the results, an array (n,) for each, in the order of the clock."""

    time: Array

    def __len__(self) -> int:
        return len(self.time)

    def taken(self, places: NDArray[np.intp] | slice) -> Self:
        """Some of the rows."""
        return type(self)(**{name: values[places] for name, values in vars(self).items()})


def of(hidden: Hidden, effect: str, unknown: str, otherwise: float = 0.0) -> float:
    """An unknown of an effect, in the unit of the registry; what it is otherwise where the effect is not hidden."""
    return float(hidden.get(effect, {}).get(unknown, otherwise))


def halved(is_more: Callable[[Array], Array], low: Array, high: Array, rounds: int = 60) -> Array:
    """Where something begins to be too much, between ``low`` and ``high``: intervals halved, nothing in closed form."""
    for _ in range(rounds):
        middle = (low + high) / 2
        above = is_more(middle)
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.asarray(high)
