"""A surrogate that answers, and what was found of it: at points it never saw, and along one input."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from truing.studies.demands import wilson
from truing.studies.surrogate_box import Box
from truing.studies.surrogate_fit import Emulator

Values: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StandIn:
    """The box and what was learnt in it, by result. Columns are numbers or arrays (n,) in SI, by input."""

    box: Box
    emulators: Mapping[str, Emulator]

    def predict(self, columns: Mapping[str, Any]) -> dict[str, Values]:
        """Return the expected results (n,), SI."""
        places = self.box.places(columns)
        return {name: emulator.mean(places) for name, emulator in self.emulators.items()}

    def bands(self, columns: Mapping[str, Any]) -> dict[str, tuple[Values, Values, Values]]:
        """Return the expected results (n,) and both ends of their 95 % bands, SI."""
        places = self.box.places(columns)
        return {name: emulator.band(places) for name, emulator in self.emulators.items()}


@dataclass(frozen=True, eq=False)
class Judged:
    """A result at points that were held out: the model's value and the surrogate's with its band, (n,) in SI.

    ``is_share`` says that errors are shares of the value; otherwise they are shares of the range of the values.
    """

    simulated: Values
    predicted: Values
    low: Values
    high: Values
    is_share: bool

    @property
    def points(self) -> int:
        """How many points were held out and have an answer."""
        return len(self.simulated)

    @property
    def inside(self) -> int:
        """How many of them lie in their band."""
        return int(((self.low <= self.simulated) & (self.simulated <= self.high)).sum())

    @property
    def coverage(self) -> float:
        """The share of points in their band."""
        return self.inside / self.points

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of that share."""
        low, high = wilson(self.inside, self.points)
        return low, high

    @property
    def errors(self) -> Values:
        """How far the surrogate is off, without sign, SI."""
        return abs(self.predicted - self.simulated)

    @property
    def whole(self) -> Any:
        """What errors are shares of: the values (n,), or their range."""
        size = abs(self.simulated)
        return size if self.is_share else np.ptp(self.simulated) or size.max() or 1.0

    @property
    def shares(self) -> Values:
        """The same as shares of the value, or of the range of all values."""
        return np.asarray(self.errors / self.whole)


@dataclass(frozen=True, eq=False)
class Course:
    """Results along one input, all else as in the run, SI: the surrogate on a fine axis, the model on a coarse one."""

    over: str
    axis: Values
    coarse: Values
    simulated: Mapping[str, Values]
    bands: Mapping[str, tuple[Values, Values, Values]]
    every: int

    def inside(self, name: str) -> tuple[int, int]:
        """Return how many of the model's points lie in the band, and how many there are."""
        simulated = self.simulated[name]
        low, high = (end[:: self.every] for end in self.bands[name][1:])
        return int(((low <= simulated) & (simulated <= high)).sum()), int(np.isfinite(simulated).sum())
