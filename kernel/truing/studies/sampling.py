"""Monte Carlo on the exact model: batches of machines, counted and summed in the order of the batches.

One batch is one array call of the model, for machines of one block or of several. Only counts and moments leave it, so
memory stays flat however many machines are drawn, and the sums are made in the order of the batches, so the answer does
not depend on who computed which.
"""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Matrix
from truing.declare.correlations import contradictions, matrix_of, pearson, scatter_fault
from truing.declare.spreads import FIXED_DRAWS, Distribution, Drawn, Grade, Spread, Stream, with_width
from truing.errors import UsageError
from truing.evaluate import Rows, evaluate_rows, put_together
from truing.executors import in_order, keepable, stays_here
from truing.packed import Packed, pack, unpack
from truing.setup import Setup, SwitchedOn, effect_column
from truing.studies.checks import Check, Demand, chance_check, results_needed, wilson, worst

KEPT_REASONS = 8
BATCH = 2**16
"""Machines per call of the model: few calls, and arrays that still lie in the processor's cache."""
BLOCK = 2**14
"""Machines that share one random generator for each cause.

Where a batch is made of whole blocks, a machine has the same numbers whatever the batch; any other is a block itself.
"""
AT_ONCE = 2**12
"""So many machines are calculated for all designs along a curve, one design after another, before the next machines."""
NORMALS_REMEMBERED = 64
"""So many arrays of at most ``BATCH`` values, half a megabyte each."""
WORDS = 8
"""A name is mixed into a seed by so many words of 32 bits, its SHA-256."""


@keepable
@dataclass(frozen=True)
class Moments:
    """Count, mean, sum of squared deviations, smallest and largest; numbers or arrays along the result's axis."""

    count: int
    mean: Any
    squares: Any
    smallest: Any
    largest: Any

    @property
    def sd(self) -> Any:
        """Standard deviation (n - 1)."""
        return np.sqrt(self.squares / (self.count - 1)) if self.count > 1 else self.squares * float("nan")


@keepable
@dataclass(frozen=True)
class Tally:
    """What some batches found: hits by demand, moments by result, failed rows and the first reasons for them."""

    draws: int
    hits: Mapping[str, Any]
    moments: Mapping[str, Moments]
    failed: int
    reasons: Mapping[str, int]

    @property
    def shares(self) -> dict[str, Any]:
        """The share of machines that meets each demand, along an axis at every place."""
        shares = {name: hits / self.draws for name, hits in self.hits.items()}
        return {name: share if np.ndim(share) else float(share) for name, share in shares.items()}

    @property
    def intervals(self) -> dict[str, tuple[Any, Any]]:
        """Wilson's 95 % interval of each share."""
        return {name: wilson(hits, self.draws) for name, hits in self.hits.items()}

    @property
    def lost(self) -> str:
        """How many machines have no answer, in words, with the first reason."""
        reason = next(iter(self.reasons), "no reason was given")
        return f"{self.failed} of {self.draws} machines have no answer and count as missed ({reason})"


def goal_checks(wanted: Sequence[Demand], chances: Mapping[str, Any], tally: Tally | None) -> list[Check]:
    """Compare each probability, of drawn machines or to first order, with its goal; along an axis the worst one."""
    method = "first order" if tally is None else f"Monte Carlo, {tally.draws} machines"
    return [
        chance_check(demand.name, worst(chances[demand.name]), demand.goal, method=method)
        for demand in wanted
        if demand.goal is not None
    ]


def sample(
    scatter: Scatter,
    wanted: Sequence[Demand],
    answers: Mapping[str, Any],
    *,
    draws: int,
    batch: int,
    executor: Executor,
    done: Callable[[int, int], None],
) -> Tally:
    """Draw machines in batches and count which of them meet each demand; ``answers`` are the nominal results in SI."""
    design = Design(scatter, tuple(wanted), answers)
    (tally,) = sample_along([design], draws=draws, batch=batch, executor=executor, done=done)
    return tally


@dataclass(frozen=True)
class Design:
    """Machines to draw: what scatters, the demands on them, and the nominal results in SI."""

    scatter: Scatter
    wanted: tuple[Demand, ...]
    answers: Mapping[str, Any]

    def carried(self, executor: Executor) -> _Carried:
        """Return it as it goes to where the batches are calculated."""
        centres = {name: self.answers[name] for name in results_needed(self.scatter.setup, self.wanted)}
        return self.scatter if stays_here(executor) else pack(self.scatter.setup), self.wanted, centres


def sample_along(
    designs: Sequence[Design], *, draws: int, batch: int, executor: Executor, done: Callable[[int, int], None]
) -> list[Tally]:
    """Draw machines of several designs that are much alike, as those along a curve, and count as in ``sample``.

    The first machines of all designs are calculated, then the next ones, so that a model which remembers what it
    calculated for a machine is asked for the same one again. Of several designs a batch is one block.
    """
    block = block_of(batch)
    size = block if len(designs) > 1 else batch
    run = partial(run_batch, tuple(design.carried(executor) for design in designs), block)
    total: list[Tally] = []
    batches = ((start, min(size, draws - start)) for start in range(0, draws, size))
    for tallies in in_order(executor, run, batches):
        total = list(map(merged, total, tallies)) if total else list(tallies)
        done(total[0].draws, draws)
    return total


@lru_cache(maxsize=4)
def _unpacked(packed: Packed) -> Scatter:
    return scatter_of(unpack(packed))


@lru_cache(maxsize=1)
def _keep_freed_memory() -> None:
    """Let the C library keep freed arrays for the next batch instead of handing them back to the system.

    Freeing one large array, never touched, raises glibc's thresholds for doing so. Without it the page faults of the
    temporaries cost as much as the arithmetic of the model. Other C libraries do not care.
    """
    np.empty(31 * 2**20, dtype=np.uint8)


def block_of(batch: int) -> int:
    """Return how many machines share their random generators where so many are one batch."""
    return batch if batch % BLOCK else BLOCK


_Carried: TypeAlias = "tuple[Scatter | Packed, tuple[Demand, ...], Mapping[str, Any]]"
"""What scatters, the demands, and the centres of moments (SI)."""


def run_batch(designs: Sequence[_Carried], block: int, batch: tuple[int, int]) -> tuple[Tally, ...]:
    """Draw a batch (its first machine and rows) of each design, and run the model on it; return counts and moments.

    ``block`` machines share their random generators.
    """
    _keep_freed_memory()
    start, count = batch
    scatters = [_unpacked(carried) if isinstance(carried, Packed) else carried for carried, _, _ in designs]
    columns = [scatter.draw(scatter.setup.seed, start // block, count, block=block) for scatter in scatters]
    size = count if len(designs) == 1 else AT_ONCE
    parts: list[list[Rows]] = [[] for _ in designs]
    order = np.split(np.arange(count), range(size, count, size))
    for index in order:
        few = slice(index[0], index[-1] + 1)
        for scatter, (_, _, centres), drawn, answers in zip(scatters, designs, columns, parts, strict=True):
            own = {name: values[few] for name, values in drawn.items()}
            answers.append(evaluate_rows(scatter.setup, own, len(index), wanted=tuple(centres)))
    return tuple(
        _tally(_whole(answers, order, tuple(centres), count).complete(), wanted, centres, drawn)
        for answers, (_, wanted, centres), drawn in zip(parts, designs, columns, strict=True)
    )


def _whole(parts: Sequence[Rows], order: Sequence[NDArray[np.intp]], names: Sequence[str], rows: int) -> Rows:
    return parts[0] if len(parts) == 1 else put_together(parts, order, names, rows)


def _tally(rows: Rows, wanted: Sequence[Demand], centres: Mapping[str, Any], columns: Mapping[str, Any]) -> Tally:
    count = len(rows)
    return Tally(
        draws=count,
        hits={demand.name: _hits(demand, rows, columns) for demand in wanted},
        moments={name: _moments(rows, name, centre) for name, centre in centres.items()},
        failed=int(rows.failed.sum()),
        reasons=dict(Counter(rows.reasons.values())),
    )


def _hits(demand: Demand, rows: Rows, columns: Mapping[str, Any]) -> Any:
    """Count the rows within the limits; NaN, as in failed rows, lies in none."""
    response = demand.response(rows.results, columns)
    inside = response <= demand.high
    if np.any(demand.low > -np.inf):
        inside &= response >= demand.low
    return inside.sum(axis=0)


def _moments(rows: Rows, name: str, centre: Any) -> Moments:
    values = rows.results[name]
    if rows.failed.any():
        values = values[~rows.failed]
    count = len(values)
    if not count:
        nothing = np.zeros(values.shape[1:])
        return Moments(0, nothing, nothing, nothing + np.inf, nothing - np.inf)
    deviations = values - centre
    mean = deviations.mean(axis=0)
    smallest, largest = deviations.min(axis=0), deviations.max(axis=0)
    deviations -= mean
    deviations *= deviations
    return Moments(count, centre + mean, deviations.sum(axis=0), centre + smallest, centre + largest)


def merged(first: Tally, second: Tally) -> Tally:
    """Join what two runs of batches found."""
    reasons = dict(first.reasons)
    for reason, count in second.reasons.items():
        if reason in reasons or len(reasons) < KEPT_REASONS:
            reasons[reason] = reasons.get(reason, 0) + count
    return Tally(
        draws=first.draws + second.draws,
        hits={name: hits + second.hits[name] for name, hits in first.hits.items()},
        moments={name: joined(moments, second.moments[name]) for name, moments in first.moments.items()},
        failed=first.failed + second.failed,
        reasons=reasons,
    )


def joined(first: Moments, second: Moments) -> Moments:
    """Join moments (T. F. Chan, G. H. Golub, R. J. LeVeque, Am. Stat. 37 (1983) 242)."""
    if not first.count or not second.count:
        return first if first.count else second
    count = first.count + second.count
    apart = second.mean - first.mean
    mean = first.mean + apart * (second.count / count)
    squares = first.squares + second.squares + apart * apart * (first.count * second.count / count)
    smallest = np.minimum(first.smallest, second.smallest)
    return Moments(count, mean, squares, smallest, np.maximum(first.largest, second.largest))


def standard_rows(scatter: Scatter, standard: Matrix, wanted: Sequence[str]) -> tuple[Rows, dict[str, Any]]:
    """Run machines given by standard normal values (dimension, n); return rows and their columns."""
    columns: dict[str, Any] = dict(scatter.from_standard(standard))
    return evaluate_rows(scatter.setup, columns, standard.shape[1], wanted=wanted).complete(), columns


# What scatters, and how it is drawn: every tolerance in force, conditions with one, effects with their uncertainty


@dataclass(frozen=True, eq=False)
class ScatterSource:
    """Columns of a batch that are drawn together: independent, or mixed from standard normals by ``mixing`` (k, k).

    ``function(rng, rows)`` draws deviations itself; ``mixing`` is then its normal stand-in.
    """

    name: str
    columns: tuple[str, ...]
    nominals: tuple[Any, ...]
    distributions: tuple[Distribution, ...]
    mixing: Matrix | None = None
    function: Callable[[Any, int], Mapping[str, Any]] | None = None

    @property
    def is_one_normal(self) -> bool:
        """Whether one standard normal value for each machine tells all."""
        plain = self.function is None and self.mixing is None and len(self.columns) == 1
        return plain and self.distributions[0].shape != "uniform"

    def draw(self, stream: Stream) -> Iterator[tuple[str, float, Matrix]]:
        """Yield column, nominal value and the values of all machines, in the order of the columns."""
        if self.function is not None:
            yield from self.deviating(stream.of_function(self.function))
            return
        if self.mixing is not None:
            yield from self.from_standard(stream.standard_normal(len(self.columns)))
            return
        for column, nominal, distribution in zip(self.columns, self.nominals, self.distributions, strict=True):
            yield column, nominal, distribution.draw(stream)

    def deviating(self, deviations: Mapping[str, Any]) -> Iterator[tuple[str, float, Matrix]]:
        """Yield column, nominal value, and values that deviate from it so."""
        for column, nominal in zip(self.columns, self.nominals, strict=True):
            yield column, nominal, nominal + np.asarray(deviations[column], dtype=float)

    def from_standard(self, standard: Matrix) -> Iterator[tuple[str, float, Matrix]]:
        """Map independent standard normal values (k, n) to the columns."""
        mixed = None if self.mixing is None else self.mixing @ standard
        for index, distribution in enumerate(self.distributions):
            values = distribution.from_standard(standard[index]) if mixed is None else distribution.mean + mixed[index]
            yield self.columns[index], self.nominals[index], values

    def covariance(self) -> Matrix:
        """Return the covariance of the columns (k, k), SI."""
        if self.mixing is not None:
            return np.asarray(self.mixing @ self.mixing.T)
        return np.diag([distribution.sd**2 for distribution in self.distributions])


@dataclass(frozen=True, eq=False)
class Copula:
    """What couples the causes of a scatter: the correlation of some of the standard normal values behind them.

    ``places`` (k,) hold of each of these the name of its cause and the number of its column in it; ``matrix`` (k, k)
    holds their correlations. The lower triangular ``root`` leaves the first one the value that was drawn for it.
    """

    places: tuple[tuple[str, int], ...]
    matrix: Matrix

    @cached_property
    def root(self) -> Matrix:
        """The Cholesky factor of the matrix (k, k)."""
        return np.asarray(np.linalg.cholesky(self.matrix), dtype=np.float64)

    def mixed(self, drawn: Mapping[str, Any]) -> dict[str, Any]:
        """Return independent standard normal values (columns, ...) by cause, now correlated; others as they are."""
        values = np.array([drawn[name][index] for name, index in self.places])
        mixed = {name: np.array(drawn[name]) for name in dict.fromkeys(name for name, _ in self.places)}
        for (name, index), row in zip(self.places, np.tensordot(self.root, values, axes=1), strict=True):
            mixed[name][index] = row
        return {**drawn, **mixed}


@dataclass(frozen=True, eq=False)
class Scatter:
    """A setup with all its causes of scatter: the machines of one design. ``copula`` couples some causes."""

    setup: Setup
    causes: tuple[ScatterSource, ...]
    copula: Copula | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        """Every column that scatters, once."""
        return tuple(dict.fromkeys(column for cause in self.causes for column in cause.columns))

    @property
    def dimension(self) -> int:
        """How many independent standard normal values make one machine."""
        return sum(len(cause.columns) for cause in self.causes)

    def draw(self, seed: int, first: int, rows: int, *, block: int = 0) -> dict[str, Matrix]:
        """Draw machines from the first of a block on: SI values (rows,) by column.

        So many machines as ``block`` share their random generators, all of them by default.
        """
        coupled = {} if self.copula is None else dict(self.copula.places)
        streams = {cause.name: stream_of(seed, first, cause.name, rows, block or rows) for cause in self.causes}
        standard = {cause.name: streams[cause.name].standard_normal(len(cause.columns))
                    for cause in self.causes if cause.name in coupled}  # fmt: skip
        mixed = standard if self.copula is None else self.copula.mixed(standard)
        columns: dict[str, Matrix] = {}
        for cause in self.causes:
            if cause.name in mixed:
                gather(columns, cause.from_standard(mixed[cause.name]))
            elif cause.is_one_normal and rows <= BATCH:
                gather(columns, cause.from_standard(_normals(seed, first, cause.name, rows, block or rows)))
            else:
                gather(columns, cause.draw(streams[cause.name]))
        return columns

    def from_standard(self, standard: Matrix) -> dict[str, Matrix]:
        """Map independent standard normal values (dimension, n) to columns; joint draws by their normal stand-in."""
        ends = np.cumsum([len(cause.columns) for cause in self.causes])[:-1]
        parts = np.split(standard, ends) if self.causes else []
        apart = {cause.name: part for cause, part in zip(self.causes, parts, strict=True)}
        mixed = apart if self.copula is None else self.copula.mixed(apart)
        columns: dict[str, Matrix] = {}
        for cause in self.causes:
            gather(columns, cause.from_standard(mixed[cause.name]))
        return columns

    def shifts(self) -> dict[str, float]:
        """Return by column how far the mean lies from the nominal, where it does."""
        shifts: dict[str, float] = {}
        for cause in self.causes:
            for column, nominal, distribution in zip(cause.columns, cause.nominals, cause.distributions, strict=True):
                if distribution.mean != nominal:
                    shifts[column] = shifts.get(column, 0.0) + distribution.mean - nominal
        return shifts

    def variances(self, slopes: Mapping[str, Any]) -> dict[str, Any]:
        """Return the first-order variance by column from derivatives (numbers or arrays along an axis)."""
        variances: dict[str, Any] = {}
        for cause in self.causes:
            gradient = np.array([np.asarray(slopes[column], dtype=float) for column in cause.columns])
            parts = gradient * np.tensordot(cause.covariance(), gradient, axes=1)
            for column, part in zip(cause.columns, parts, strict=True):
                variances[column] = variances[column] + part if column in variances else part
        for pair in self.pairs:
            product = np.asarray(slopes[pair.first], dtype=float) * np.asarray(slopes[pair.second], dtype=float)
            for column in (pair.first, pair.second):  # half of what the two add together
                variances[column] = variances[column] + product * pair.covariance
        return variances

    @cached_property
    def pairs(self) -> tuple[CorrelatedPair, ...]:
        """The columns of which each two scatter together."""
        return () if self.copula is None else tuple(self._pairs(self.copula))

    def _pairs(self, copula: Copula) -> Iterator[CorrelatedPair]:
        causes = {cause.name: cause for cause in self.causes}
        for (one, other), coefficient in np.ndenumerate(copula.matrix):
            if one < other and coefficient:  # of each pair once
                (first, own), (second, their) = (
                    (causes[name].columns[index], causes[name].distributions[index])
                    for name, index in (copula.places[one], copula.places[other])
                )
                of_values = float(pearson(own, their, coefficient))
                yield CorrelatedPair(first, second, float(coefficient), of_values, of_values * float(own.sd * their.sd))

    def alike(self, columns: Sequence[str]) -> Matrix:
        """Return the correlations of the values of these columns (k, k), 0 of those that do not scatter together."""
        alike = np.eye(len(columns))
        place = {column: index for index, column in enumerate(columns)}
        for cause in self.causes:
            covariance = cause.covariance() if cause.mixing is not None else np.zeros((0, 0))
            for (one, other), value in np.ndenumerate(covariance):
                first, second = cause.columns[one], cause.columns[other]
                if one != other and {first, second} <= place.keys():
                    alike[place[first], place[second]] = value / (self.sd_of(first) * self.sd_of(second))
        for pair in self.pairs:
            if {pair.first, pair.second} <= place.keys():
                one, other = place[pair.first], place[pair.second]
                alike[one, other] = alike[other, one] = pair.of_values
        return alike

    def sd_of(self, column: str) -> float:
        """Return the standard deviation of one column, 0 where it does not scatter."""
        variance = 0.0
        for cause in self.causes:
            if column in cause.columns:
                index = cause.columns.index(column)
                variance += float(cause.covariance()[index, index])
        return math.sqrt(variance)


@dataclass(frozen=True)
class CorrelatedPair:
    """Two columns that scatter together: the correlation of their normal scores, that of their values, and in SI."""

    first: str
    second: str
    coefficient: float
    of_values: float
    covariance: float


def gather(columns: dict[str, Matrix], drawn: Iterator[tuple[str, float, Matrix]]) -> None:
    """Put what was drawn into the batch; two tolerances on one input add their deviations."""
    for column, nominal, values in drawn:
        columns[column] = columns[column] + (values - nominal) if column in columns else values


def stream_of(seed: int, first: int, name: str, rows: int, block: int) -> Stream:
    """Make the generators of one cause for so many machines from the first of a block on."""
    parts = [slice(start, min(start + block, rows)) for start in range(0, rows, block)]
    return Stream(rows, [(generator(seed, first + number, name), part) for number, part in enumerate(parts)])


@lru_cache(maxsize=NORMALS_REMEMBERED)
def _normals(seed: int, first: int, name: str, rows: int, block: int) -> Matrix:
    """Standard normal values (1, rows) of one cause: a curve, a plan and the knee of a front ask for the same ones."""
    values = stream_of(seed, first, name, rows, block).standard_normal()[None]
    values.flags.writeable = False
    return values


def generator(seed: int, block: int, name: str) -> np.random.Generator:
    """Make the random generator of one block and one cause; 0 is a seed like any other.

    SFC64 is the fastest of numpy's generators and passes the same batteries of tests as its default.
    """
    entropy = _entropy(seed, name).copy()
    entropy[-1 - WORDS] = block
    return np.random.Generator(np.random.SFC64(np.random.SeedSequence(entropy)))


@lru_cache(maxsize=1024)
def _entropy(seed: int, name: str) -> NDArray[np.uint32]:
    """Return the words of a seed, a place for the number of the block, and the words of the name.

    They are what ``SeedSequence(seed, spawn_key=(block, *words))`` puts together word by word, in six times the time.
    """
    seed_words = np.frombuffer(seed.to_bytes(4 * max(4, -(-seed.bit_length() // 32)), "little"), dtype="<u4")
    name_words = np.frombuffer(hashlib.sha256(name.encode()).digest(), dtype="<u4")
    return np.concatenate([seed_words, [0], name_words]).astype(np.uint32)


def scatter_of(setup: Setup) -> Scatter:
    """Collect what scatters in this setup. Raises UsageError for a tolerance on an input that is not given."""
    causes = [_of_tolerance(setup, name, inner) for name, inner in setup.distributions().items()]
    causes += [cause for active in setup.effects if (cause := _of_effect(active)) is not None]
    return Scatter(setup, tuple(causes), _copula(setup, causes))


def _copula(setup: Setup, causes: Sequence[ScatterSource]) -> Copula | None:
    """Return how the inputs scatter together, or None. Raises UsageError where they cannot."""
    stated = [each for each in setup.scattering_together() if each.coefficient]
    if not stated:
        return None
    for name in dict.fromkeys(name for each in stated for name in (each.first, each.second)):
        by = [cause.name for cause in causes if name in cause.columns]
        fault = scatter_fault(name, by, lambda tolerance: isinstance(setup.spread_of(tolerance), Drawn))
        if fault:
            raise UsageError(fault)
    for contradiction in contradictions(stated):
        raise UsageError(contradiction.text)
    coupled = {name for each in stated for name in each.pair}
    places = {column: (cause.name, index) for cause in causes for index, column in enumerate(cause.columns)
              if column in coupled}  # fmt: skip
    return Copula(tuple(places.values()), matrix_of(list(places), stated))


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


def _stand_in(spread: Drawn, columns: tuple[str, ...]) -> Matrix:
    """Return the mixing matrix of the normal stand-in of a joint draw, from the fixed draws of its distributions."""
    deviations = spread.function(np.random.default_rng(0), FIXED_DRAWS)
    joint = np.array([np.asarray(deviations[column], dtype=float) for column in columns])
    return root_of(np.atleast_2d(np.cov(joint)))


def _of_effect(active: SwitchedOn) -> ScatterSource | None:
    """Return the uncertainty with which an effect was diagnosed, or None where it is known exactly or only read."""
    if active.effect.place == "reading":
        return None
    names = [unknown.name for unknown in active.unknowns]
    sds = [float(active.sds.get(name, 0.0)) for name in names]
    covariance = np.array(active.covariance, dtype=float) if active.covariance else np.diag(np.square(sds))
    if not covariance.any():
        return None
    values = tuple(float(active.values[name]) for name in names)
    columns = tuple(effect_column(active.effect.name, name) for name in names)
    spread = np.sqrt(np.diag(covariance))
    distributions = tuple(Distribution(value, float(sd)) for value, sd in zip(values, spread, strict=True))
    mixing = root_of(covariance) if active.covariance else None
    return ScatterSource(f"effects.{active.effect.name}", columns, values, distributions, mixing)


def with_tolerances(setup: Setup, chosen: Mapping[str, str | float]) -> Setup:
    """Return the setup with these tolerances at these grades or full widths (SI), each that of its first input."""
    changed: dict[str, Spread] = {}
    for name, choice in chosen.items():
        spread = setup.spread_of(name)
        if isinstance(choice, str):
            assert isinstance(spread, Grade)  # others have no grade to choose
            changed[name] = replace(spread, grade=choice)
        else:
            changed[name] = with_width(spread, setup.target(next(iter(setup.distributions()[name]))), choice)
    return replace(setup, spreads={**setup.spreads, **changed})


def root_of(covariance: Matrix) -> Matrix:
    """Return a matrix whose product with its transpose is the covariance, also where that is singular."""
    scale = np.sqrt(np.diag(covariance))
    safe = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(safe, safe))
    return np.asarray(safe[:, None] * vectors * np.sqrt(np.clip(values, 0.0, None)))
