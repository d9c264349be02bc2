"""A Gaussian process as a stand-in for the model: what it learnt at some points, it says of all between them.

Squared exponential with a length of its own in every direction, and white noise (C. E. Rasmussen, C. K. I. Williams,
Gaussian Processes for Machine Learning, MIT Press 2006, chapters 2 and 5); scikit-learn does the work.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from truing.arrays import Matrix, one_thread
from truing.declare.near_miss import near_miss
from truing.errors import DeclarationError, UnitError, UsageError
from truing.evaluate import Rows
from truing.formulas import Formula, evaluate, evaluate_quantities, parse
from truing.heavy import gaussian_kernels, gaussian_process, learning_exceptions
from truing.setup import Setup
from truing.studies.demands import Z95, wilson
from truing.studies.reading import read_range
from truing.units import pint_quantity, split_quantity, unit_factor

LENGTHS = (1e-2, 1e3)
AMPLITUDES = (1e-3, 1e3)
NOISES = (1e-9, 1.0)  # of the variance learnt: 1e-12 of the largest amplitude, well above rounding
JITTER = 1e-12
ROWS = 2**13


@dataclass(frozen=True, eq=False)
class Emulator:
    """What was learnt of one result: a fitted process over places (n, d) between 0 and 1, of the result's logarithm."""

    process: Any
    logarithmic: bool

    def mean(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the expected result (SI), of a logarithm its median; NaN where a place is NaN."""
        return self._result(_in_parts(lambda part: self.process.predict(part)[None], places)[0])

    def band(self, places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the expected result and the two ends of its 95 % band, noise included."""
        mean, sd = _in_parts(lambda part: np.array(self.process.predict(part, return_std=True)), places, 2)
        return self._result(mean), self._result(mean - Z95 * sd), self._result(mean + Z95 * sd)

    def _result(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.exp(values) if self.logarithmic else values

    @property
    def lengths(self) -> tuple[float, ...]:
        """The length of every direction over the side of the box."""
        return tuple(float(one) for one in np.atleast_1d(self.process.kernel_.k1.k2.length_scale))

    @property
    def noise(self) -> float:
        """The standard deviation of the noise over that of the results learnt."""
        return math.sqrt(self.process.kernel_.k2.noise_level)


def _in_parts(predict: Any, places: NDArray[np.float64], answers: int = 1) -> NDArray[np.float64]:
    """Predict a part at a time, so that memory stays flat; rows that are not finite stay NaN."""
    found = np.full((answers, len(places)), np.nan)
    usable = np.flatnonzero(np.isfinite(places).all(axis=1))
    with one_thread():
        for start in range(0, len(usable), ROWS):
            rows = usable[start : start + ROWS]
            found[:, rows] = predict(places[rows])
    return found


def fitted(
    places: NDArray[np.float64],
    values: NDArray[np.float64],
    *,
    logarithmic: bool,
    restarts: int,
    seed: int,
    done: Callable[[], None] = lambda: None,
) -> Emulator:
    """Learn a result (n,) at places (n, d): the lengths, amplitude and noise that make the sample most likely.

    ``done`` hears of every search for them that ends: the first, and each of the restarts.
    """
    shape = gaussian_kernels.RBF(np.ones(places.shape[1]), LENGTHS)
    kernel = gaussian_kernels.ConstantKernel(10.0, AMPLITUDES) * shape + gaussian_kernels.WhiteKernel(1e-6, NOISES)

    def searched(likelihood: Any, start: Any, bounds: Any) -> tuple[Any, float]:
        found: Any = minimize(likelihood, start, method="L-BFGS-B", jac=True, bounds=bounds)  # as scikit-learn does
        done()
        return found.x, found.fun

    process = gaussian_process.GaussianProcessRegressor(
        kernel, alpha=JITTER, normalize_y=True, n_restarts_optimizer=restarts, random_state=seed % 2**32,
        optimizer=searched,
    )  # fmt: skip
    with one_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore", learning_exceptions.ConvergenceWarning)
        process.fit(places, np.log(values) if logarithmic else values)
    process.set_params(optimizer=None)  # it is fitted, and travels to workers
    return Emulator(process, logarithmic)


def usable(rows: Rows, names: tuple[str, ...], *, logarithmic: bool) -> NDArray[np.bool_]:
    """Say which rows have every result, and above zero where the logarithm is learnt."""
    kept = ~rows.failed
    for name in names:
        values = rows.results[name]
        kept &= np.isfinite(values) & ((values > 0) if logarithmic else True)
    return kept


def taken(columns: Mapping[str, Any], kept: NDArray[np.bool_]) -> dict[str, Any]:
    """Return the rows of a batch that are kept."""
    return {name: values[kept] for name, values in columns.items()}


# The box of a surrogate: over what it was made, how it is sampled, and what lies outside


STEPS = 3
STRAIGHT_TO = 1e-9


@dataclass(frozen=True)
class Feature:
    """One direction of the box: a formula (often a single name), its range in SI, and the input that is set for it."""

    name: str
    formula: Formula
    sets: str
    low: float
    high: float
    unit: str
    step: float
    logarithmic: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the feature is an input or a condition itself."""
        return self.name == self.sets

    def value(self, shares: Any) -> Any:
        """Return values (SI) from places between 0 and 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** shares
        return self.low + (self.high - self.low) * shares

    def place(self, values: Any) -> Any:
        """Return places, 0 to 1 inside the range; NaN where a logarithm does not exist."""
        if not self.logarithmic:
            return (values - self.low) / (self.high - self.low)
        with np.errstate(all="ignore"):
            return np.where(values > 0, np.log(values / self.low) / np.log(self.high / self.low), np.nan)


@dataclass(frozen=True)
class Box:
    """The features, and the value (SI) that every number has in the run by name of input or condition."""

    features: tuple[Feature, ...]
    held: Mapping[str, float]

    def sampled(self, shares: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Return the columns (n,) of a batch from places (n, d), 0 to 1. Raises UsageError for a bent formula."""
        columns: dict[str, Any] = {}
        for place, feature in sorted(enumerate(self.features), key=lambda item: not item[1].is_plain):
            columns[feature.sets] = self._solved(feature, feature.value(shares[:, place]), columns)
        return columns

    def places(self, columns: Mapping[str, Any]) -> NDArray[np.float64]:
        """Return the places (n, d) of calculations; what no column holds is as in the run.

        Columns are numbers or arrays (n,) in SI. Raises UsageError for one that the surrogate does not follow.
        """
        rows = max((np.size(values) for values in columns.values()), default=1)
        self._demand_known(columns)
        values = {**self.held, **columns}
        places = [feature.place(evaluate(feature.formula, values)) for feature in self.features]
        return np.column_stack([np.broadcast_to(place, (rows,)) for place in places])

    def outside(self, columns: Mapping[str, Any]) -> NDArray[np.bool_]:
        """Say per calculation (n,) whether it lies outside the box, where nothing was learnt."""
        places = self.places(columns)
        within = (places >= -STRAIGHT_TO) & (places <= 1 + STRAIGHT_TO)
        return np.asarray(~within.all(axis=1))

    def passed(self) -> tuple[str, ...]:
        """Name the features in which the run itself lies outside the box."""
        places = self.places({})[0]
        inside = (places >= -STRAIGHT_TO) & (places <= 1 + STRAIGHT_TO)
        return tuple(item.name for item, is_inside in zip(self.features, inside, strict=True) if not is_inside)

    def _demand_known(self, columns: Mapping[str, Any]) -> None:
        followed = {name for feature in self.features for name in feature.formula.names}
        for name, values in columns.items():
            if name in followed:
                continue
            if name not in self.held:
                raise UsageError(f"the surrogate knows no '{name}'.{near_miss(name, self.held)}")
            if not np.allclose(values, self.held[name], rtol=1e-12, atol=0.0, equal_nan=True):
                raise UsageError(f"the surrogate was made for one value of '{name}'; name it in over to vary it")

    def _solved(self, feature: Feature, wanted: Any, columns: Mapping[str, Any]) -> Any:
        """Return the values of the input with which a formula takes the values that are wanted."""
        if feature.is_plain:
            return wanted
        values: dict[str, Any] = {**self.held, **columns}
        found = np.full(np.shape(wanted), self.held[feature.sets])

        def missing(tried: Any) -> Any:
            return wanted - evaluate(feature.formula, {**values, feature.sets: tried})

        for _ in range(STEPS):
            short = missing(found)
            slope = (short - missing(found + feature.step)) / feature.step
            with np.errstate(all="ignore"):
                found = found + short / slope
        if not np.all(np.abs(missing(found)) <= STRAIGHT_TO * (feature.high - feature.low)):
            raise UsageError(f"the formula '{feature.name}' is not straight in '{feature.sets}', which follows from it")
        return found


def open_box(setup: Setup, over: Mapping[str, str], logarithmic: Sequence[str], study: str) -> Box:
    """Read the ranges of the features. Raises UsageError with one sentence for a name or range that cannot be."""
    for name in logarithmic:
        if name not in over:
            raise UsageError(f"study '{study}': '{name}' is logarithmic but not in over.{near_miss(name, over)}")
    held = _held(setup)
    read = {text: _parsed(text, held, setup, study) for text in over}
    plain = {text for text, formula in read.items() if formula.names == {text}}
    features = []
    taken = set(plain)
    for text, formula in read.items():
        sets = text if text in plain else _free(formula, taken, study)
        taken.add(sets)
        low, high, unit = _range(setup, formula, over[text], study)
        if text in logarithmic and low <= 0:
            raise UsageError(f"study '{study}': '{text}' is logarithmic, so its range {over[text]} must lie above 0")
        step = abs(held[sets]) or setup_step(setup, sets)
        features.append(Feature(text, formula, sets, low, high, unit, step, text in logarithmic))
    return Box(tuple(features), held)


def setup_step(setup: Setup, name: str) -> float:
    """Return one unit of an input or condition in SI, where its value says nothing about its size."""
    return unit_factor(setup.unit_of(name))


def _held(setup: Setup) -> dict[str, float]:
    """Return the value of every number that may vary in a batch; one left open is NaN."""
    names = [name for name, item in setup.model.input_fields.items() if item.varies]
    values = {name: setup.nominal(name) for name in (*names, *setup.conditions)}
    return {name: float("nan") if value is None else float(value) for name, value in values.items()}


def _parsed(text: str, held: Mapping[str, float], setup: Setup, study: str) -> Formula:
    try:
        formula = parse(text)
    except DeclarationError as error:
        raise UsageError(f"study '{study}': {error}") from error
    if not formula.names or formula.left is not None:
        raise UsageError(f"study '{study}': '{text}' is neither an input, a condition nor a formula in them")
    for name in sorted(formula.names):
        if name not in held:
            raise UsageError(
                f"study '{study}': '{name}' is no number among the inputs of {setup.model.name}.{near_miss(name, held)}"
            )
        item = setup.model.input_fields.get(name)
        if item is not None and item.kind == "whole":
            raise UsageError(f"study '{study}': '{name}' takes whole numbers; a surrogate needs what lies between them")
    return formula


def _free(formula: Formula, taken: set[str], study: str) -> str:
    """Return the one input of a formula that is sampled in no other way."""
    free = sorted(formula.names - taken)
    if len(free) != 1:
        named = " and ".join(free) or "none"
        raise UsageError(
            f"study '{study}': of the formula '{formula.text}' one input must be left to follow, but here it is "
            f"{named}; give the others a range of their own"
        )
    return free[0]


def _range(setup: Setup, formula: Formula, text: str, study: str) -> tuple[float, float, str]:
    """Read "low..high unit"; a formula is printed in the unit of its range."""
    if text.count("..") != 1:
        raise UsageError(f"study '{study}': '{text}' is no range; write \"1000..4500 N*m\"")
    unit = setup.unit_of(formula.text) if formula.names == {formula.text} else _unit_of(setup, formula, text, study)
    low, high = read_range(text, unit, 2)
    if not low < high:
        raise UsageError(f"study '{study}': the range {text} of '{formula.text}' must rise")
    return float(low), float(high), unit


def _unit_of(setup: Setup, formula: Formula, text: str, study: str) -> str:
    """Return the unit in which the range of a formula is written, proven to be one of its own."""
    try:
        unit = split_quantity(text.rpartition("..")[2]).unit
        quantities = {name: pint_quantity(1.0, setup.unit_of(name)) for name in formula.names}
        own = evaluate_quantities(formula, quantities)
        if own.dimensionality != pint_quantity(1.0, unit).dimensionality:
            raise UnitError(f"the range {text} has another dimension than '{formula.text}'")
    except UnitError as error:
        raise UsageError(f"study '{study}': {error}") from error
    return unit


# A surrogate that answers, and what was found of it: at points it never saw, and along one input


@dataclass(frozen=True, eq=False)
class StandIn:
    """The box and what was learnt in it, by result. Columns are numbers or arrays (n,) in SI, by input."""

    box: Box
    emulators: Mapping[str, Emulator]

    def predict(self, columns: Mapping[str, Any]) -> dict[str, Matrix]:
        """Return the expected results (n,), SI."""
        places = self.box.places(columns)
        return {name: emulator.mean(places) for name, emulator in self.emulators.items()}

    def bands(self, columns: Mapping[str, Any]) -> dict[str, tuple[Matrix, Matrix, Matrix]]:
        """Return the expected results (n,) and both ends of their 95 % bands, SI."""
        places = self.box.places(columns)
        return {name: emulator.band(places) for name, emulator in self.emulators.items()}


@dataclass(frozen=True, eq=False)
class HeldOutComparison:
    """A result at points that were held out: the model's value and the surrogate's with its band, (n,) in SI.

    ``is_share`` says that errors are shares of the value; otherwise they are shares of the range of the values.
    """

    simulated: Matrix
    predicted: Matrix
    low: Matrix
    high: Matrix
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
    def errors(self) -> Matrix:
        """How far the surrogate is off, without sign, SI."""
        return abs(self.predicted - self.simulated)

    @property
    def whole(self) -> Any:
        """What errors are shares of: the values (n,), or their range."""
        size = abs(self.simulated)
        return size if self.is_share else np.ptp(self.simulated) or size.max() or 1.0

    @property
    def shares(self) -> Matrix:
        """The same as shares of the value, or of the range of all values."""
        return np.asarray(self.errors / self.whole)


@dataclass(frozen=True, eq=False)
class Course:
    """Results along one input, all else as in the run, SI: the surrogate on a fine axis, the model on a coarse one."""

    over: str
    axis: Matrix
    coarse: Matrix
    simulated: Mapping[str, Matrix]
    bands: Mapping[str, tuple[Matrix, Matrix, Matrix]]
    every: int

    def inside(self, name: str) -> tuple[int, int]:
        """Return how many of the model's points lie in the band, and how many there are."""
        simulated = self.simulated[name]
        low, high = (end[:: self.every] for end in self.bands[name][1:])
        return int(((low <= simulated) & (simulated <= high)).sum()), int(np.isfinite(simulated).sum())
