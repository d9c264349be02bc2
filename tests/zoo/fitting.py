"""A calculation of the zoo fitted to a record by a plain least-squares search: no part of the diagnosis is asked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from truing import Unknown
from truing.diagnosis.records import Records
from truing.gauge import read_by_gauge
from truing.setup import Setup, SwitchedOn
from truing.testing import recorded
from truing.testing.hiding import MEASURED, csv_of, records_of
from truing.units import to_si
from zoo.zoo import Array, Measured, model_of

STARTS = 12
"""Searches for one fit at the most; they start all over the bounds of the unknowns."""
GOOD = 0.5
"""Root mean square of what is left, in standard deviations of the noise, at which no further search is begun."""


@dataclass(frozen=True)
class Place:
    """Where an unknown of an effect may lie, in SI."""

    effect: str
    unknown: Unknown

    def value(self, share: float) -> float:
        """The value at a share of the way from bound to bound; a shape goes by ratios, a whole one by ones."""
        low, high = (to_si(bound, self.unknown.unit) for bound in (self.unknown.low, self.unknown.high))
        if self.unknown.whole:
            return float(np.round(low + (high - low) * share))
        if low > 0:
            return float(low * (high / low) ** share)
        return low + (high - low) * share


@dataclass(frozen=True)
class Fitted:
    """The root mean square of what a fit leaves and the most that its effects move, in standard deviations of noise."""

    error: float
    moved: float


@dataclass(frozen=True)
class Fitting:
    """A record read by the calculation of its family with some effects on.

    ``noise`` is in SI, ``spreads`` holds the standard deviations of the tolerated inputs, SI.
    """

    setup: Setup
    records: Records
    result: str
    noise: float
    spreads: dict[str, float]
    places: tuple[Place, ...]

    def shown(self, moved: Array, shares: Array, *, with_effects: bool = True) -> Array:
        """What the gauge would show, in standard deviations of the noise.

        ``moved`` are the tolerated inputs in standard deviations, ``shares`` where the unknowns lie in their bounds.
        """
        spreads = zip(self.spreads.items(), moved.tolist(), strict=True)
        inputs = {name: self.setup.nominal(name) + sd * away for (name, sd), away in spreads}
        values: dict[str, dict[str, float]] = {}
        for place, share in zip(self.places, shares.tolist(), strict=True):
            values.setdefault(place.effect, {})[place.unknown.name] = place.value(share)
        known = self.setup.model.known_effects
        on = tuple(SwitchedOn(known[name], unknowns) for name, unknowns in values.items()) if with_effects else ()
        machine = replace(self.setup.changed(inputs), effects=on)
        return np.asarray(read_by_gauge(machine, self.records.rows, {self.result}).results[self.result] / self.noise)

    def best(self) -> Fitted:
        """The best fit: inputs held by their tolerances, unknowns within their bounds."""
        fits: list[Fitted] = []
        for start in self._starts():
            fits.append(self._fitted(start))
            if fits[-1].error < GOOD:
                break
        return min(fits, key=lambda one: one.error)

    def _starts(self) -> Iterator[Array]:
        """Where the unknowns start: the middle, then places of a fixed draw; every whole number is a start."""
        drawn = np.random.default_rng(1).uniform(0.02, 0.98, (STARTS - 1, len(self.places)))
        starts = [np.full(len(self.places), 0.5), *(drawn if self.places else ())]
        for column, place in enumerate(self.places):
            if place.unknown.whole:
                count = round(place.unknown.high - place.unknown.low) + 1
                starts = [
                    np.where(np.arange(len(one)) == column, share, one)
                    for share in np.linspace(0, 1, count)
                    for one in starts[:2]
                ]
        yield from starts

    def _fitted(self, start: Array) -> Fitted:
        """A search from one start; whole numbers stay where they start."""
        count, free = len(self.spreads), np.array([not place.unknown.whole for place in self.places], dtype=bool)
        read = self.records.measured[self.result] / self.noise

        def parted(numbers: Array) -> tuple[Array, Array]:
            shares = start.copy()
            shares[free] = numbers[count:]
            return numbers[:count], shares

        def cost(numbers: Array) -> Array:
            return np.concatenate([read - self.shown(*parted(numbers)), numbers[:count]])

        best = np.concatenate([np.zeros(count), start[free]])
        edges = (np.repeat([-6.0, 0.0], [count, free.sum()]), np.repeat([6.0, 1.0], [count, free.sum()]))
        if len(best):
            steps = np.full(len(best), 1e-4)
            best = least_squares(cost, best, bounds=edges, diff_step=steps, x_scale="jac", max_nfev=60).x
        shown, without = self.shown(*parted(best)), self.shown(*parted(best), with_effects=False)
        return Fitted(error=float(np.sqrt(np.mean((read - shown) ** 2))), moved=float(np.max(np.abs(shown - without))))


def fitting(family: str, measured: Measured, effects: Sequence[str] = ()) -> Fitting:
    """Read a record without noise by the calculation of its family, with these effects on."""
    model = model_of(family)
    setup = recorded(model, inputs=f'plugin = "{family}"\n', measured="").setup
    result = measured.result.split(" [")[0]
    unit = model.result_fields[result].unit
    inner = [item for spread in setup.distributions().values() for item in spread.items()]
    return Fitting(
        setup=setup,
        records=records_of(setup, csv_of(measured.columns), MEASURED, with_unit_errors=False),
        result=result,
        noise=to_si(measured.noise, unit) - to_si(0.0, unit),
        spreads={name: one.sd for name, one in inner if name in model.input_fields},
        places=tuple(Place(name, one) for name in effects for one in _looked_for(family, name, result)),
    )


def _looked_for(family: str, effect: str, result: str) -> tuple[Unknown, ...]:
    """The unknowns of an effect; of one of the kernel's, which has a part for each gauge, those of the result."""
    model = model_of(family)
    unknowns = model.known_effects[effect].unknowns
    return unknowns if effect in model.effects else tuple(one for one in unknowns if one.name.startswith(result))
