"""The chance that an experiment names the right explanation: simulated, with every explanation as the truth in turn.

A draw takes an explanation, moves its numbers and the inputs within what the record leaves of them, and reads the new
values with the noise that the record shows. All explanations are then fitted again, to the record and the new readings
together, and judged by the rule of a diagnosis: another one is excluded that lies ``CLOSE`` score units behind and more
than the rows contradict. Right is a draw in which all others are excluded that the experiment is to tell from the true
one.

This is the deciding part of a diagnosis. Its search among all that might compete is not repeated: what was excluded
before, and that something unregistered could turn up, is no part of the chance. Where calls of the model are dear the
fits go by the derivatives: with noise of known size the cost of an explanation rises by z' (I + R V R')^-1 z, z what it
gets wrong in the new readings, R its derivatives there, V its covariance from the record.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, log
from typing import Any

import numpy as np

from truing.arrays import Mask, Matrix
from truing.diagnosis.choice import CLOSE, SURE, unsure
from truing.diagnosis.competition import Competition
from truing.diagnosis.exact import ROUGHLY, fitting, together, unit_of
from truing.diagnosis.extended import Extended, elsewhere, parts_of
from truing.diagnosis.fitted import Fit, moved_by
from truing.diagnosis.intervals import numbers_of
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.noise import colour
from truing.diagnosis.records import Records
from truing.diagnosis.result import Chance
from truing.diagnosis.sample import NoiseModel, Sample, sample_of
from truing.experiments.duels import Explained, reached_by, there
from truing.measurements import RowsFile
from truing.studies.checks import wilson

DRAWS = 100
"""So many experiments are simulated: a chance of 95 % has a standard error of 2 %."""
AT_ONCE = 20_000
"""Rows of one call of the model: so many fits go together as they allow."""
FEW = 10
"""So many draws are judged at one time where a few that are wrong end a simulation."""
Judge = Callable[[int, Sequence[int], Mapping[str, Matrix]], tuple[Matrix, Matrix]]
"""How far other explanations are behind the true one (draws, others), and how unsure that is, from readings."""
LONG = 2500
"""A record of more rows is not fitted again a hundred times."""
RANGE = 50.0
"""Of a logarithm: what lies farther is beyond any bound."""
EXACTLY = "all explanations fitted again to everything, with the model itself"
ROUGH = "all explanations fitted again to everything, by their derivatives"


@dataclass(frozen=True)
class Simulation:
    """One experiment to be simulated: the explanations on the record, and the machine at its readings.

    ``apart`` holds the pairs (as places among ``several``) that it is to tell apart. Without a record the numbers are
    the truth, and only the inputs scatter.
    """

    competition: Competition
    several: Sequence[Explained]
    apart: frozenset[frozenset[int]]
    machine: Calibration
    has_record: bool

    def chance(self, seed: int, draws: int = DRAWS) -> Chance:
        """Return how often the right one is named, of so many draws."""
        right = sum(int(named.sum()) for named in self._named(seed, draws, draws))
        return Chance(right / draws, *wilson(right, draws), draws, ROUGH if self._is_dear else EXACTLY)

    def reaches(self, least: float, seed: int, draws: int = DRAWS) -> bool:
        """Whether the chance is at least so much: it ends with the draw from which on it cannot be."""
        wrong = 0
        for named in self._named(seed, draws, FEW):
            wrong += int((~named).sum())
            if (draws - wrong) / draws < least:
                return False
        return True

    @property
    def _is_dear(self) -> bool:
        return self.competition.extended.budget.is_dear or len(self.competition.sample.machine.records) > LONG

    def _named(self, seed: int, draws: int, size: int) -> Iterator[Mask]:
        """Give in which draws the right one is named, at most so many at a time."""
        generator = np.random.Generator(np.random.SFC64(seed))
        tried = elsewhere(self.competition.extended, self.machine)
        judge = self._by_slopes(tried) if self._is_dear else self._exactly()
        truths = sorted({place for pair in self.apart for place in pair})
        for index, truth in enumerate(truths):
            count = draws // len(truths) + (index < draws % len(truths))
            drawn = self.readings_of(tried, truth, count, generator)
            others = [place for place in range(len(self.several)) if frozenset((truth, place)) in self.apart]
            is_more = [self.several[truth].fit.key < self.several[other].fit.key for other in others]
            for begin in range(0, count, size):
                some = {name: values[begin : begin + size] for name, values in drawn.items()}
                behind, doubt = judge(truth, others, some)
                least = np.where(is_more, 0.0, np.maximum(CLOSE, SURE * doubt))
                yield np.asarray((behind >= least).all(axis=1))

    def readings_of(self, tried: Extended, truth: int, count: int, generator: np.random.Generator) -> dict[str, Matrix]:
        """Return what the gauges read in so many experiments in which an explanation is true, by result (count, n)."""
        of = self.several[truth]
        moves = generator.standard_normal((count, len(of.inverse))) @ _root(of).T
        free = int(of.free.sum())
        if not self.has_record:
            moves[:, :free] = 0.0
        points = [(parts_of(of.fit.causes, _moved(of, own[:free])), of.fit.moved + moved_by(of.fit.sample, own[free:]))
                  for own in moves]  # fmt: skip
        shown = tried.at(of.fit.causes, points)
        squares, made = self._squares(), {}
        for channel in self.competition.sample.channels:
            values = np.array([each[channel.name] for each in shown])
            white = _noise(channel.freedom, values.T.shape, generator)
            starts = np.arange(len(values.T)) == 0
            weight = float(np.median(channel.weights)) if len(channel) else 1.0
            noise = colour(white, starts, channel.memory).T * channel.scale * squares[channel.name] ** 0.5 / weight
            made[channel.name] = values * np.exp(noise / channel.typical) if channel.typical else values + noise
        return made

    def _squares(self) -> dict[str, float]:
        """Return by result the square of the noise in units of its scale, as the best explanation leaves it."""
        sample = self.competition.sample
        if not self.has_record:
            return {channel.name: 1.0 for channel in sample.channels}
        squares = sample.squares(self.several[0].fit.left)
        return {channel.name: square for channel, square in zip(sample.channels, squares, strict=True)}

    # ---- judged by exact fits

    def _exactly(self) -> Judge:
        sample = joined(self.competition.sample, self.machine, has_record=self.has_record)
        extended = elsewhere(self.competition.extended, sample.machine)
        price = replace(self.competition, sample=sample, paid={}, owned={}, known={}).price
        at_once = max(1, AT_ONCE // len(sample.machine.records))

        def fitted(of: Explained, samples: Sequence[Sample]) -> Iterator[Fit | None]:
            near = replace(of.fit, slopes={}, moves={})
            for begin in range(0, len(samples), at_once):
                some = samples[begin : begin + at_once]
                asking = [fitting(each, extended, near.causes, near.values, near, until=ROUGHLY) for each in some]
                yield from together(extended, asking)

        def judged(truth: int, others: Sequence[int], drawn: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
            count = len(next(iter(drawn.values())))
            every = [{name: each[draw] for name, each in drawn.items()} for draw in range(count)]
            samples = [_with_readings(sample, readings) for readings in every]
            own, *fits = (list(fitted(self.several[place], samples)) for place in (truth, *others))
            true, *scores = ([inf if fit is None else fit.cost + price(fit) for fit in each] for each in (own, *fits))
            doubts = [[_doubt(*pair) for pair in zip(own, each, strict=True)] for each in fits]
            return (np.array(scores) - true).T, np.array(doubts).T

        return judged

    # ---- judged by derivatives

    def _by_slopes(self, tried: Extended) -> Judge:
        sample, squares = self.competition.sample, self._squares()
        spreads = np.array([each.scale * squares[each.name] ** 0.5 for each in sample.channels])
        ready = []
        for of in self.several:
            said = there(of, tried)
            rows = (said.slopes / spreads[:, None, None]).reshape(-1, said.slopes.shape[-1])
            (reached,) = reached_by(rows[None], of.root)
            ready.append((said.shown, np.eye(len(rows)) - reached @ reached.T))
        prices = [of.fit.cost + self.competition.price(of.fit) for of in self.several]

        def judged(truth: int, others: Sequence[int], drawn: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
            values = np.stack([drawn[channel.name] for channel in sample.channels], axis=1)
            scores = []
            for price, (shown, weight) in zip(prices, ready, strict=True):
                off = ((values - shown) / spreads[:, None]).reshape(len(values), -1)
                scores.append(price + np.einsum("di,ij,dj->d", off, weight, off))
            return np.array([scores[other] - scores[truth] for other in others]).T, np.zeros((len(values), len(others)))

        return judged


def _doubt(own: Fit | None, other: Fit | None) -> float:
    return 0.0 if own is None or other is None else unsure(own, other)


def _root(of: Explained) -> Matrix:
    """Return a square root of the covariance of an explanation; combinations that the record leaves open have none.

    Open is what may be off by more than a quarter of the range of its numbers: drawn there, and cut at the bounds, it
    would no longer say of the record what was read.
    """
    numbers, units = numbers_of(of.fit), unit_of(of.fit)
    ends = [
        (log(n.low), log(n.high)) if n.is_log else (n.low / unit, n.high / unit)
        for n, unit in zip(numbers, units, strict=True)
    ]
    ranges = np.array([(high - low) / 4 if high - low < inf else 1.0 for low, high in ends])
    scale = np.append(ranges[of.free], np.ones(len(of.fit.inputs)))
    values, vectors = np.linalg.eigh(of.inverse / np.outer(scale, scale))
    kept = np.where(values <= 1 + 1e-9, np.maximum(values, 0.0), 0.0)
    return np.asarray(scale[:, None] * vectors * np.sqrt(kept))


def _moved(of: Explained, moves: Matrix) -> Matrix:
    """Return the numbers of an explanation, moved as the fit sees them, SI and within their bounds."""
    flat = np.concatenate(of.fit.values)
    every = np.zeros(len(flat))
    every[of.free] = moves
    numbers = numbers_of(of.fit)
    is_log = np.array([number.is_log for number in numbers], dtype=bool)
    grown = flat * np.exp(np.clip(np.where(is_log, every, 0.0), -RANGE, RANGE))
    moved = np.where(is_log, grown, flat + every * unit_of(of.fit))
    return np.clip(moved, [number.low for number in numbers], [number.high for number in numbers])


def _noise(freedom: float, shape: tuple[int, ...], generator: np.random.Generator) -> Matrix:
    return generator.standard_normal(shape) if freedom == inf else generator.standard_t(freedom, shape)


def _with_readings(sample: Sample, readings: Mapping[str, Matrix]) -> Sample:
    """Return a sample with other values in its last rows."""
    channels = []
    for channel in sample.channels:
        new = readings[channel.name]
        values = np.concatenate([channel.values[: len(channel) - len(new)], new])
        channels.append(replace(channel, values=values))
    return replace(sample, channels=tuple(channels))


def joined(sample: Sample, machine: Calibration, *, has_record: bool) -> Sample:
    """Return the rows of a sample with those of a machine elsewhere behind them, in the same noise."""
    new = calibration_of(sample.machine.design, machine.records)
    new = replace(new, inputs=sample.machine.inputs)
    if has_record:
        old = sample.machine
        new = replace(
            old,
            records=_records(old.records, new.records),
            base={name: np.concatenate([base, new.base[name]]) for name, base in old.base.items()},
            slopes={name: np.concatenate([slopes, new.slopes[name]]) for name, slopes in old.slopes.items()},
        )
    count = len(new.records) - (len(sample.mask) if has_record else 0)
    noise = {name: _longer(own, new.base[name][-count:], has_record=has_record) for name, own in sample.noise.items()}
    measured = {
        name: np.where(_added(values, count), new.base[name], values) for name, values in new.records.measured.items()
    }
    new = replace(new, records=replace(new.records, measured=measured))
    mask = np.append(sample.mask if has_record else np.zeros(0, dtype=bool), np.ones(count, dtype=bool))
    return sample_of(new, noise, mask, sample.directions)


def _added(values: Matrix, count: int) -> Mask:
    return np.arange(len(values)) >= len(values) - count


def _longer(noise: NoiseModel, base: Matrix, *, has_record: bool) -> NoiseModel:
    """Return the noise on further rows, which have the usual weight."""
    kept = slice(None) if has_record else slice(0)
    given, weights = (
        np.append(each[kept], np.full(len(base), float(np.nanmedian(each)))) for each in (noise.given, noise.weights)
    )
    return replace(
        noise, given=given, weights=weights, at=None if noise.at is None else np.append(noise.at[kept], base)
    )


def _behind(old: Any, new: Any) -> Any:
    return [*old, *new] if isinstance(old, list) else np.concatenate([old, new])


def _records(old: Records, new: Records) -> Records:
    """Return the rows of a record and further ones behind them, as a run of their own."""
    columns = {name: _behind(old.rows.columns[name], values) for name, values in new.rows.columns.items()}
    run_of = np.append(old.run_of, new.run_of + old.run_of.max(initial=-1) + 1)
    rows = RowsFile("", columns, {}, {}, tuple(range(len(run_of))), runs=tuple(map(str, run_of.tolist())))
    sides = {name: np.append(each, np.zeros(len(new), dtype=each.dtype)) for name, each in old.sides.items()}
    covariates = {
        name: replace(each, values=np.append(each.values, new.covariates[name].values))
        for name, each in old.covariates.items()
        if name in new.covariates
    }
    measured = {name: np.append(values, new.measured[name]) for name, values in old.measured.items()}
    return replace(
        old,
        rows=rows,
        file_of=np.append(old.file_of, new.file_of),
        run_of=run_of,
        lines=np.append(old.lines, new.lines),
        measured=measured,
        sigma={},
        covariates=covariates,
        held_out=np.append(old.held_out, new.held_out),
        sides=sides,
    )
