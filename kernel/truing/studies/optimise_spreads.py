"""How much every input scatters in every design: means and standard deviations of many designs at once.

Where neither the nominal nor the width of a spread differs between designs it is resolved once, as in any other study.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from truing.declare.checks import TOTAL_PRICE
from truing.declare.sources import Tolerance
from truing.declare.spreads import SIGMAS_IN_BAND, Band, Distribution, Grade, Shape, Spread, Target
from truing.declare.widths import shift_per_width
from truing.errors import TruingError
from truing.fits import GRADES
from truing.prices import price_of, prices_at
from truing.setup import Setup
from truing.studies.optimise_space import Space, Variable
from truing.units import to_si


@dataclass(frozen=True)
class Scattered:
    """The scatter of one input in m designs, SI: mean (m,), standard deviation (m,), shape; NaN where there is none."""

    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    shape: Shape

    @property
    def width(self) -> NDArray[np.float64]:
        """The full band (m,)."""
        return self.sd * (12**0.5 if self.shape == "uniform" else SIGMAS_IN_BAND)

    def values(self, standard: NDArray[np.float64]) -> NDArray[np.float64]:
        """Map standard normal values (n,) to every design (m, n), as ``Distribution.from_standard`` does for one."""
        mean, sd = self.mean[:, None], self.sd[:, None]
        if self.shape == "lognormal":
            log_variance = np.log1p((sd / mean) ** 2)
            return np.asarray(np.exp(np.log(mean) - log_variance / 2 + np.sqrt(log_variance) * standard))
        if self.shape == "uniform":
            return np.asarray(mean + self.width[:, None] * (ndtr(standard) - 0.5))
        return np.asarray(standard * sd + mean)


def scattered(
    space: Space, designs: NDArray[np.float64], columns: Mapping[str, Any]
) -> dict[str, dict[str, Scattered]]:
    """Return by tolerance and input how much it scatters in every design; ``columns`` are the nominal inputs there."""
    choices = space.choices(designs)
    found: dict[str, dict[str, Scattered]] = {}
    for name, inner in space.scatter.items():
        tolerance = space.setup.model.tolerances[name]
        variable, values = choices.get(name, (None, None))
        spread = space.setup.spread_of(name)
        grades = values if variable is not None and variable.kind == "grade" else None
        each = {
            column: _resolved(space, spread, column, (base, columns, grades, len(designs)))
            for column, base in inner.items()
        }
        found[name] = _widened(tolerance, spread, each, values) if _is_width(variable) else each
    return found


def _is_width(variable: Variable | None) -> bool:
    return variable is not None and variable.kind == "width"


def _widened(tolerance: Tolerance, spread: Spread, each: Mapping[str, Scattered], widths: Any) -> dict[str, Scattered]:
    """Bring a band to its chosen width (that of its first input); a zone grows where it says."""
    first = next(iter(each.values())).width
    with np.errstate(all="ignore"):
        factor = widths / first
    shift = shift_per_width(spread)
    return {
        column: replace(item, mean=item.mean + shift * (factor - 1) * item.width, sd=item.sd * factor)
        for column, item in each.items()
    }


def _resolved(
    space: Space,
    spread: Spread,
    column: str,
    given: tuple[Distribution, Mapping[str, Any], NDArray[np.float64] | None, int],
) -> Scattered:
    """Resolve one spread in every design, once for all of them where nothing it reads differs."""
    base, columns, grades, rows = given
    reads = sorted(_reads(spread, column) & space.moved)
    if not reads and grades is None:
        mean = np.full(rows, base.mean)
        if column in columns:
            mean = columns[column] + (base.mean - float(space.setup.nominal(column)))
        return Scattered(mean, np.full(rows, base.sd), base.shape)
    places = np.full(rows, -1.0) if grades is None else grades
    nominal = columns.get(column, np.full(rows, float(space.setup.nominal(column))))
    keys = np.column_stack([places, *(columns[name] for name in reads)])
    unique, where = np.unique(keys, axis=0, return_inverse=True)
    found = [_of_design(space.setup, spread, column, dict(zip(reads, key[1:], strict=True)), key[0]) for key in unique]
    shift, sd = (np.array(part)[where.reshape(-1)] for part in zip(*found, strict=True))
    return Scattered(nominal + shift, sd, base.shape)


def _of_design(
    setup: Setup, spread: Spread, column: str, values: Mapping[str, float], place: float
) -> tuple[float, float]:
    """Return how far the mean lies from the nominal, and the standard deviation; NaN for no such grade."""

    def value_of(name: str) -> Any:
        return values.get(name, setup.nominal(name))

    if place >= 0 and isinstance(spread, Grade):
        spread = replace(spread, grade=GRADES[round(place)])
    target = Target(column, float(value_of(column)), setup.unit_of(column), value_of)
    try:
        distribution = spread.resolve(target)
    except TruingError:
        distribution = None
    if distribution is None:
        return float("nan"), float("nan")
    return distribution.mean - target.nominal, distribution.sd


def _reads(spread: Spread, column: str) -> frozenset[str]:
    """Return the inputs on which the width of a spread depends."""
    if isinstance(spread, Grade):
        return frozenset({spread.size or column})
    if isinstance(spread, Band):
        if spread.at_radius:
            return frozenset({spread.at_radius})
        return (
            frozenset({column}) if spread.amount.rstrip().endswith("%") or spread.shape == "lognormal" else frozenset()
        )
    return frozenset()


def total_prices(setup: Setup, spreads: Mapping[str, Mapping[str, Scattered]], rows: int) -> NDArray[np.float64]:
    """Return what the tolerances of every design cost together (m,), in SI of the currency."""
    total = np.zeros(rows)
    for name, inner in spreads.items():
        price = price_of(setup, setup.model.tolerances[name])
        if price is not None:
            total = total + prices_at(price, next(iter(inner.values())).width)
    return np.asarray(to_si(total, setup.model.result_fields[TOTAL_PRICE].unit))
