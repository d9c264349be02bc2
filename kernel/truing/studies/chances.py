"""First-order chances: the model linearised at its nominal point, every scatter by its mean and standard deviation.

Range of validity: scatter small enough for the model to be straight over it, and so many sources of comparable weight
that their sum is nearly normal (exact for linear models of normal sources). The shift of a mean, as of a one-sided
zone, is included. Source: E. B. Haugen, Probabilistic Mechanical Design, Wiley 1980.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from truing.studies.demands import Demand, normal_chance, results_needed
from truing.studies.differences import Slopes, slopes
from truing.studies.sampling import Machines


@dataclass(frozen=True)
class Straight:
    """A response as a straight line: nominal value, mean, derivatives and variance by column, SI."""

    nominal: Any
    mean: Any
    slopes: Mapping[str, Any]
    variances: Mapping[str, Any]

    @property
    def variance(self) -> Any:
        """The whole first-order variance."""
        return sum(self.variances.values(), 0.0)

    @property
    def sd(self) -> Any:
        """The first-order standard deviation."""
        return np.sqrt(np.maximum(self.variance, 0.0))


def straightened(
    machines: Machines, wanted: Sequence[Demand], nominal: Mapping[str, float]
) -> tuple[dict[str, Straight], Slopes]:
    """Linearise the responses of these demands; one batch of the model."""
    columns = machines.scatter.columns
    needed = results_needed(machines.setup, wanted)
    found = slopes(machines.setup, needed, columns, machines.scatter)
    return {demand.name: _straight(demand, found, machines, nominal) for demand in wanted}, found


def _straight(demand: Demand, found: Slopes, machines: Machines, nominal: Mapping[str, float]) -> Straight:
    columns = machines.scatter.columns
    slope = demand.slopes(found.of, columns)
    value = demand.response(found.nominal, {}, nominal)
    mean = value + sum((slope[column] * shift for column, shift in machines.scatter.shifts().items()), 0.0)
    return Straight(value, mean, slope, machines.scatter.variances(slope))


def chance(demand: Demand, straight: Straight) -> Any:
    """Return the first-order probability that the demand is met."""
    return normal_chance(straight.mean, straight.sd, demand.low, demand.high)
