"""What scatters, and how it is drawn: every tolerance in force, conditions with one, effects with their uncertainty.

Readings never scatter a machine: an effect on the reading is left out. Each cause draws from a generator of its own,
made from the seed, the number of the batch and its name, so that a further tolerance reshuffles no other.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.spreads import FIXED_DRAWS, Distribution, Drawn
from truing.errors import UsageError
from truing.setup import Setup, SwitchedOn, effect_column


@dataclass(frozen=True, eq=False)
class ScatterSource:
    """Columns of a batch that are drawn together: independent, or mixed from standard normals by ``mixing`` (k, k).

    ``function(rng, rows)`` draws deviations itself; ``mixing`` is then its normal stand-in.
    """

    name: str
    columns: tuple[str, ...]
    nominals: tuple[float, ...]
    distributions: tuple[Distribution, ...]
    mixing: NDArray[np.float64] | None = None
    function: Callable[[Any, int], Mapping[str, Any]] | None = None

    def draw(self, rng: np.random.Generator, rows: int) -> Iterator[tuple[str, float, NDArray[np.float64]]]:
        """Yield column, nominal value and ``rows`` values, in the order of the columns."""
        if self.function is not None:
            deviations = self.function(rng, rows)
            for column, nominal in zip(self.columns, self.nominals, strict=True):
                yield column, nominal, nominal + deviations[column]
            return
        if self.mixing is not None:
            yield from self.from_standard(rng.standard_normal((len(self.columns), rows)))
            return
        for column, nominal, distribution in zip(self.columns, self.nominals, self.distributions, strict=True):
            yield column, nominal, distribution.draw(rng, rows)

    def from_standard(self, standard: NDArray[np.float64]) -> Iterator[tuple[str, float, NDArray[np.float64]]]:
        """Map independent standard normal values (k, n) to the columns."""
        mixed = None if self.mixing is None else self.mixing @ standard
        for index, distribution in enumerate(self.distributions):
            values = distribution.from_standard(standard[index]) if mixed is None else distribution.mean + mixed[index]
            yield self.columns[index], self.nominals[index], values

    def covariance(self) -> NDArray[np.float64]:
        """Return the covariance of the columns (k, k), SI."""
        if self.mixing is not None:
            return np.asarray(self.mixing @ self.mixing.T)
        return np.diag([distribution.sd**2 for distribution in self.distributions])


@dataclass(frozen=True, eq=False)
class Scatter:
    """All causes of scatter of one setup."""

    causes: tuple[ScatterSource, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Every column that scatters, once."""
        return tuple(dict.fromkeys(column for cause in self.causes for column in cause.columns))

    @property
    def dimension(self) -> int:
        """How many independent standard normal values make one machine."""
        return sum(len(cause.columns) for cause in self.causes)

    def draw(self, seed: int, batch: int, rows: int) -> dict[str, NDArray[np.float64]]:
        """Draw the machines of one batch: SI values (rows,) by column."""
        columns: dict[str, NDArray[np.float64]] = {}
        for cause in self.causes:
            _gather(columns, cause.draw(generator(seed, batch, cause.name), rows))
        return columns

    def from_standard(self, standard: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Map independent standard normal values (dimension, n) to columns; joint draws by their normal stand-in."""
        columns: dict[str, NDArray[np.float64]] = {}
        start = 0
        for cause in self.causes:
            end = start + len(cause.columns)
            _gather(columns, cause.from_standard(standard[start:end]))
            start = end
        return columns

    def shifts(self) -> dict[str, float]:
        """Return by column how far the mean lies from the nominal, where it does."""
        found: dict[str, float] = {}
        for cause in self.causes:
            for column, nominal, distribution in zip(cause.columns, cause.nominals, cause.distributions, strict=True):
                if distribution.mean != nominal:
                    found[column] = found.get(column, 0.0) + distribution.mean - nominal
        return found

    def variances(self, slopes: Mapping[str, Any]) -> dict[str, Any]:
        """Return the first-order variance by column from derivatives (numbers or arrays along an axis)."""
        found: dict[str, Any] = {}
        for cause in self.causes:
            gradient = np.array([np.asarray(slopes[column], dtype=float) for column in cause.columns])
            parts = gradient * np.tensordot(cause.covariance(), gradient, axes=1)
            for column, part in zip(cause.columns, parts, strict=True):
                found[column] = found[column] + part if column in found else part
        return found

    def sd_of(self, column: str) -> float:
        """Return the standard deviation of one column, 0 where it does not scatter."""
        variance = 0.0
        for cause in self.causes:
            if column in cause.columns:
                place = cause.columns.index(column)
                variance += float(cause.covariance()[place, place])
        return math.sqrt(variance)


def _gather(columns: dict[str, NDArray[np.float64]], drawn: Iterator[tuple[str, float, NDArray[np.float64]]]) -> None:
    """Put what was drawn into the batch; two tolerances on one input add their deviations."""
    for column, nominal, values in drawn:
        columns[column] = columns[column] + (values - nominal) if column in columns else values


def generator(seed: int, batch: int, name: str) -> np.random.Generator:
    """Make the random generator of one batch and one cause; 0 is a seed like any other.

    SFC64 is the fastest of numpy's generators and passes the same batteries of tests as its default.
    """
    sequence = np.random.SeedSequence(seed, spawn_key=(batch, *_words(name)))
    return np.random.Generator(np.random.SFC64(sequence))


@lru_cache(maxsize=1024)
def _words(name: str) -> tuple[int, ...]:
    digest = hashlib.sha256(name.encode()).digest()
    return tuple(int.from_bytes(digest[start : start + 4], "little") for start in range(0, 32, 4))


def scatter_of(setup: Setup) -> Scatter:
    """Collect what scatters in this setup. Raises UsageError for a tolerance on an input that is not given."""
    causes = [_of_tolerance(setup, name, inner) for name, inner in setup.distributions().items()]
    causes += [cause for item in setup.effects if (cause := _of_effect(item)) is not None]
    return Scatter(tuple(causes))


def _of_tolerance(setup: Setup, name: str, inner: Mapping[str, Distribution]) -> ScatterSource:
    columns = tuple(inner)
    nominals = tuple(float(setup.nominal(column)) for column in columns)
    missing = [column for column, nominal in zip(columns, nominals, strict=True) if nominal != nominal]
    if missing:
        raise UsageError(
            f"tolerance '{name}' scatters '{missing[0]}', which is not given; give it, or write {name} = \"off\""
        )
    spread = setup.spread_of(name)
    if not isinstance(spread, Drawn):
        return ScatterSource(name, columns, nominals, tuple(inner.values()))
    return ScatterSource(name, columns, nominals, tuple(inner.values()), _stand_in(spread, columns), spread.function)


def _stand_in(spread: Drawn, columns: tuple[str, ...]) -> NDArray[np.float64]:
    """Return the mixing matrix of the normal stand-in of a joint draw, from the fixed draws of its distributions."""
    deviations = spread.function(np.random.default_rng(0), FIXED_DRAWS)
    joint = np.array([np.asarray(deviations[column], dtype=float) for column in columns])
    return root_of(np.atleast_2d(np.cov(joint)))


def _of_effect(item: SwitchedOn) -> ScatterSource | None:
    """Return the uncertainty with which an effect was diagnosed, or None where it is known exactly or only read."""
    if item.effect.place == "reading":
        return None
    names = [unknown.name for unknown in item.unknowns]
    sds = [float(item.sds.get(name, 0.0)) for name in names]
    covariance = np.array(item.covariance, dtype=float) if item.covariance else np.diag(np.square(sds))
    if not covariance.any():
        return None
    values = tuple(float(item.values[name]) for name in names)
    columns = tuple(effect_column(item.effect.name, name) for name in names)
    spread = np.sqrt(np.diag(covariance))
    distributions = tuple(Distribution(value, float(sd)) for value, sd in zip(values, spread, strict=True))
    mixing = root_of(covariance) if item.covariance else None
    return ScatterSource(f"effects.{item.effect.name}", columns, values, distributions, mixing)


def root_of(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a matrix whose product with its transpose is the covariance, also where that is singular."""
    scale = np.sqrt(np.diag(covariance))
    safe = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(safe, safe))
    return np.asarray(safe[:, None] * vectors * np.sqrt(np.clip(values, 0.0, None)))
