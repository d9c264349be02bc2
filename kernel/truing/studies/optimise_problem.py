"""Many designs answered at once: objectives, margins and chances; here, or by a worker that makes the problem again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from math import ceil, floor, isnan
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from truing.declare.fields import InputField, in_si
from truing.declare.goals import Maximise, Minimise, Require, Vary
from truing.declare.model import TOTAL_PRICE
from truing.declare.near_miss import near_miss
from truing.declare.sources import Tolerance
from truing.declare.spreads import (
    SIGMAS_IN_BAND,
    Band,
    Distribution,
    DistributionShape,
    Grade,
    Spread,
    Target,
    Zone,
    shift_per_width,
)
from truing.errors import TruingError, UnitError, UsageError
from truing.evaluate import evaluate_rows
from truing.executors import SerialExecutor, in_order, keepable
from truing.fits import GRADES
from truing.formulas import Formula, evaluate, parse
from truing.inputs_file.values import broken_bound
from truing.packed import Packed, pack, unpack
from truing.prices import price_of, prices_at
from truing.setup import Setup
from truing.studies.checks import check_name, requirements, sockets_of
from truing.studies.demands import beside, normal_chance
from truing.studies.differences import nominal_of
from truing.studies.grades import with_grades, with_widths
from truing.studies.sampling import Scatter, ScatterSource, generator, scatter_of
from truing.units import read_quantity, to_si

ROWS = 2**16  # of one call of the model, so that memory stays flat


@runtime_checkable
class ModelSubstitute(Protocol):
    """What may answer in place of the model: the outcome of a surrogate study."""

    @property
    def of(self) -> tuple[str, ...]:
        """The results it knows."""

    def predict(self, columns: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return these results (n,) in SI from columns (n,) or numbers in SI."""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is chosen, what for, and the machines by which every design is judged."""

    space: Space
    brief: Brief
    aims: tuple[Aim, ...]
    bounds: tuple[Bound, ...]
    scatter: Scatter
    cloud: Cloud | None
    stand_in: ModelSubstitute | None = None

    @property
    def setup(self) -> Setup:
        """The setup of the design that the inputs file states."""
        return self.space.setup

    @property
    def by_chance(self) -> tuple[Bound, ...]:
        """The limits with a probability; they are the last ones."""
        return tuple(bound for bound in self.bounds if bound.by_chance)

    def answer(self, columns: Mapping[str, Any], rows: int, wanted: Sequence[str]) -> dict[str, Any]:
        """Run a batch: the surrogate for what it knows, the model for the rest; NaN where a row failed."""
        own = [name for name in self.setup.model.own_result_fields if name in wanted]
        covered = [name for name in own if self.stand_in is not None and name in self.stand_in.of]
        values: dict[str, Any] = {}
        if self.stand_in is not None and covered:
            predicted = self.stand_in.predict(columns)
            values = {name: _of_rows(predicted[name], rows) for name in covered}
        rest = [name for name in own if name not in covered]
        if rest or not own:
            values.update(evaluate_rows(self.setup, columns, rows, wanted=rest).results)
        return {name: values[name] for name in own}


def _of_rows(values: Any, rows: int) -> NDArray[np.float64]:
    return np.broadcast_to(np.asarray(values, dtype=float), (rows,))


@keepable
@dataclass(frozen=True)
class Answers:
    """What m designs are worth: objectives (m, a) in SI, margins of every limit (m, b), chances (m, c) and their goals.

    ``failed`` designs have no answer: NaN everywhere.
    """

    objectives: NDArray[np.float64]
    margins: NDArray[np.float64]
    chances: NDArray[np.float64]
    goals: NDArray[np.float64]
    failed: NDArray[np.bool_]

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Whether a design has an answer and keeps every limit."""
        return ~self.failed & (self.margins >= 0).all(axis=1)

    def __getitem__(self, rows: Any) -> Answers:
        """Return some of the designs."""
        return Answers(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})


def joined(parts: Sequence[Answers]) -> Answers:
    """Put the answers of several batches together, in their order."""
    return Answers(
        **{field.name: np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Answers)}
    )


def make_problem(setup: Setup, brief: Brief) -> Problem:
    """Collect variables, objectives and limits, and draw the machines. Raises UsageError where one is missing."""
    aims, space, bounds = aims_of(setup, brief.study), open_space(setup, brief), bounds_of(setup)
    scatter = scatter_of(setup)
    drawn = brief.chance == "draws" and any(bound.by_chance for bound in bounds)
    cloud = cloud_of(scatter, setup.seed, brief.study, brief.draws) if drawn else None
    return Problem(space, brief, aims, bounds, scatter, cloud)


def answers_of(problem: Problem, designs: NDArray[np.float64], *, as_stated: bool = False) -> Answers:
    """Answer designs (m, v) in one go; ``as_stated`` leaves inputs that follow as the inputs file states them."""
    count = len(designs)
    world, spreads = _world(problem, designs, as_stated=as_stated)
    objectives = np.column_stack([np.broadcast_to(world.value(aim.name), (count,)) for aim in problem.aims])
    plain = [margins(bound, world, count) for bound in problem.bounds if not bound.by_chance]
    chances = _chances(problem, Designs(world, spreads, count))
    goals = np.array([np.broadcast_to(world.goal(bound), (count,)) for bound in problem.by_chance]).reshape(-1, count).T
    kept = (
        np.column_stack([*plain, (chances - goals) / np.where(goals > 0, goals, 1.0)])
        if problem.bounds
        else np.zeros((count, 0))
    )
    failed = ~(np.isfinite(objectives).all(axis=1) & np.isfinite(kept).all(axis=1))
    failed |= _without_spread(spreads, count)
    for values in world.results.values():
        failed |= ~np.isfinite(values.reshape(count, -1)).all(axis=1)
    objectives, kept, chances = (np.where(failed[:, None], np.nan, part) for part in (objectives, kept, chances))
    return Answers(objectives, kept, chances, np.array(goals, dtype=float), failed)


def _without_spread(spreads: Mapping[str, Any], count: int) -> NDArray[np.bool_]:
    """Return the designs in which some tolerance has no width, as a grade that does not exist for their size."""
    missing = np.zeros(count, dtype=bool)
    for inner in spreads.values():
        for distribution in inner.values():
            missing |= ~np.isfinite(distribution.sd)
    return missing


def _world(
    problem: Problem, designs: NDArray[np.float64], *, as_stated: bool
) -> tuple[World, dict[str, dict[str, Any]]]:
    """Run the designs without scatter, and once more without effects where ``within`` is measured from there."""
    count, setup = len(designs), problem.setup
    columns = problem.space.columns(designs, as_stated=as_stated)
    spreads = scattered(problem.space, designs, columns)
    priced = TOTAL_PRICE in setup.model.result_fields
    prices = total_prices(setup, spreads, count) if priced else None
    wanted = results_needed(setup, problem.aims, problem.bounds)
    results = problem.answer(columns, count, wanted)
    own = _own_results(problem, columns, count)
    return World(setup, columns, results, own, prices, dict(problem.brief.known)), spreads


def _own_results(problem: Problem, columns: Mapping[str, Any], count: int) -> dict[str, NDArray[np.float64]]:
    """Return the results from which ``within`` is measured, where they are not the nominal ones: see ``of_design``."""
    setup = problem.setup
    wanted = [bound.result for bound in problem.bounds if bound.require.kind == "within"]
    sockets = sockets_of(setup)
    acts = any(active.effect.place != "reading" for active in setup.effects)
    deviates = any(name in columns or setup.nominal(name) != 0 for name in sockets)
    if not wanted or not (acts or deviates):
        return {}
    neutral = {**columns, **{name: np.zeros(count) for name in sockets}}
    design = replace(setup, effects=())
    return dict(evaluate_rows(design, neutral, count, wanted=[name for name in wanted if name != TOTAL_PRICE]).results)


def _chances(problem: Problem, designs: Designs) -> NDArray[np.float64]:
    bounds = problem.by_chance
    if not bounds:
        return np.zeros((designs.rows, 0))
    if problem.cloud is None:
        return by_first_order(problem.scatter, designs, bounds, problem.answer)
    return by_draws(problem.cloud, designs, bounds, problem.answer)


# Jobs


@dataclass(frozen=True)
class DesignBatch:
    """Some designs, as they go to a worker: plain data, except in this process."""

    problem: Problem | tuple[Packed, Brief]
    designs: NDArray[np.float64]


def run_job(job: DesignBatch) -> Answers:
    """Answer the designs of one job."""
    problem = job.problem if isinstance(job.problem, Problem) else _unpacked(*job.problem)
    return answers_of(problem, job.designs)


@lru_cache(maxsize=4)
def _unpacked(packed: Packed, brief: Brief) -> Problem:
    return make_problem(unpack(packed), brief)


def answered(problem: Problem, designs: NDArray[np.float64], executor: Executor) -> Answers:
    """Answer designs (m, v), cut into jobs in a way that does not depend on who computes them."""
    if isinstance(executor, SerialExecutor) or problem.stand_in is not None:
        jobs = (DesignBatch(problem, part) for part in _parts(problem, designs))
        return joined([run_job(job) for job in jobs])
    carried = (pack(problem.setup), problem.brief)
    return joined(list(in_order(executor, run_job, (DesignBatch(carried, part) for part in _parts(problem, designs)))))


def _parts(problem: Problem, designs: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    rows = problem.brief.draws if problem.cloud is not None else 1
    if problem.cloud is None and problem.by_chance:
        rows = 1 + 2 * len(problem.scatter.columns)
    size = max(1, min(ROWS // rows, -(-len(designs) // problem.brief.parts)))
    for start in range(0, len(designs), size):
        yield designs[start : start + size]


# What an optimisation is for: objectives and limits of many designs at once


@dataclass(frozen=True)
class Aim:
    """A number that should be small or large: a result of the function, an input, or the sum of the prices."""

    name: str
    maximise: bool
    unit: str

    @property
    def sign(self) -> float:
        """What turns it into something that should be small."""
        return -1.0 if self.maximise else 1.0

    @property
    def sense(self) -> str:
        """The word for it."""
        return "maximise" if self.maximise else "minimise"


@dataclass(frozen=True)
class Bound:
    """A limit that a design must keep: itself, or with a probability (``goal``, or the input that holds it)."""

    name: str
    require: Require
    by_chance: bool
    unit: str

    @property
    def result(self) -> str:
        """The result it limits."""
        return self.require.result


@dataclass(frozen=True)
class World:
    """Designs (m,) without scatter: nominal inputs that differ, results, prices; ``own`` results without effects."""

    setup: Setup
    columns: Mapping[str, Any]
    results: Mapping[str, NDArray[np.float64]]
    own: Mapping[str, NDArray[np.float64]]
    prices: NDArray[np.float64] | None
    known: Mapping[str, float] = field(default_factory=dict)

    def value(self, name: str) -> Any:
        """Return a result, an input or the sum of the prices: a number for all designs or an array (m, ...)."""
        if name in self.results:
            return self.results[name]
        if name == TOTAL_PRICE and self.prices is not None:
            return self.prices
        if name in self.columns:
            return self.columns[name]
        return self.known[name] if name in self.known else float(self.setup.nominal(name))

    def goal(self, bound: Bound) -> Any:
        """Return the probability that a limit asks for."""
        goal = bound.require.reliability
        return self.value(goal) if isinstance(goal, str) else goal

    def limit(self, bound: Bound) -> Any:
        """Return the stated limit in SI."""
        stated = bound.require.limit
        setup = self.setup
        if (
            stated in setup.model.input_fields
            or stated in self.results
            or stated in self.known
            or stated == TOTAL_PRICE
        ):
            return self.value(stated)
        return in_si(stated, setup.model.result_fields[bound.result].unit)

    def ends(self, bound: Bound) -> tuple[Any, Any]:
        """Return the lower and the upper limit of the result."""
        amount, infinity = self.limit(bound), float("inf")
        if bound.require.kind == "at_most":
            return -infinity, amount
        if bound.require.kind == "at_least":
            return amount, infinity
        centre = self.own.get(bound.result, self.results.get(bound.result, self.prices))
        return centre - beside(amount, centre), centre + beside(amount, centre)


def aims_of(setup: Setup, study: str) -> tuple[Aim, ...]:
    """Return the objectives. Raises UsageError where there is none, or one that is no single number."""
    own = setup.model.own_result_fields
    aims = []
    for objective in setup.model.objectives:
        if not isinstance(objective, (Minimise, Maximise)) or (name := objective.result) in given_by_studies(setup):
            continue
        if name in own and own[name].along:
            raise UsageError(f"study '{study}': the objective '{name}' runs along an axis; it must be one number")
        aims.append(Aim(name, isinstance(objective, Maximise), setup.print_unit(name)))
    if not aims:
        raise UsageError(
            f"study '{study}': {setup.model.name} says of no result of its function and of no price that it should be "
            "small or large; add Minimise(result) or Maximise(result) to its objectives"
        )
    return tuple(aims)


def given_by_studies(setup: Setup) -> set[str]:
    """Return the results that only studies give: no design has them while it is searched."""
    return {name for fields in setup.model.study_result_fields.values() for name in fields}


def bounds_of(setup: Setup) -> tuple[Bound, ...]:
    """Return the limits on results of the function and on the sum of the prices, those by chance last."""
    requires = requirements(setup)
    known = {*setup.model.own_result_fields, TOTAL_PRICE}
    bounds: list[Bound] = []
    for require in sorted(
        (require for require in requires if require.result in known),
        key=lambda require: require.reliability is not None,
    ):
        name, by_chance = check_name(require, requires), require.reliability is not None
        taken = any(bound.name == name for bound in bounds)
        name = f"{name} by chance" if taken and by_chance else name
        bounds.append(Bound(name, require, by_chance, setup.print_unit(require.result)))
    return tuple(bounds)


def left_out(setup: Setup) -> tuple[str, ...]:
    """Say which objectives and limits the search cannot see."""
    theirs = given_by_studies(setup)
    goals = [objective for objective in setup.model.objectives if isinstance(objective, (Minimise, Maximise))]
    named = [require.result for require in (*goals, *requirements(setup))]
    return tuple(
        f"'{name}' is given by a study once per run, so the search does not follow it"
        for name in dict.fromkeys(named)
        if name in theirs
    )


def constants(setup: Setup, answers: Mapping[str, Any]) -> tuple[tuple[str, float], ...]:
    """Return the limits that are results of earlier studies: they stay what they are."""
    limits = {require.limit for require in requirements(setup)}
    theirs = limits & given_by_studies(setup) & set(answers)
    return tuple((name, float(answers[name])) for name in sorted(theirs) if np.ndim(answers[name]) == 0)


def margins(bound: Bound, world: World, rows: int) -> NDArray[np.float64]:
    """Return how far every design (m,) keeps a limit on itself; along an axis the smallest margin."""
    values = np.asarray(world.value(bound.result), dtype=float)
    low, high = world.ends(bound)
    if bound.require.kind == "within":
        half = (high - low) / 2
        above, scale = half - np.abs(values - (low + high) / 2), half
    elif bound.require.kind == "at_least":
        scale = beside(low, values)
        above = values - scale
    else:
        scale = beside(high, values)
        above = scale - values
    size = np.broadcast_to(np.abs(np.asarray(scale, dtype=float)), values.shape)
    margin = np.where(size > 0, above / np.where(size > 0, size, 1.0), above)
    return np.broadcast_to(margin.min(axis=tuple(range(1, margin.ndim))) if margin.ndim > 1 else margin, (rows,))


def results_needed(setup: Setup, aims: Sequence[Aim], bounds: Sequence[Bound]) -> tuple[str, ...]:
    """Return the results of the function that objectives and limits name, in the order of declaration."""
    named = {aim.name for aim in aims} | {name for bound in bounds for name in (bound.result, bound.require.limit)}
    return tuple(name for name in setup.model.own_result_fields if name in named)


# What an optimisation may choose: inputs between bounds, inputs that follow a formula, the widths of what is priced


VariableKind = Literal["number", "whole", "width", "grade"]
SLACK = 1e-9


@dataclass(frozen=True)
class Brief:
    """What is asked of the search beside the model's objectives; plain values, so that a worker can have them."""

    study: str
    vary: tuple[str, ...] = ()
    tightest: float = 1.0
    widest: float = 2.0
    finest: str = "IT5"
    chance: Literal["draws", "first_order"] = "draws"
    draws: int = 4096
    parts: int = 1
    known: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Variable:
    """One thing that may be chosen, between ``low`` and ``high`` (SI, or places of grades), and where it starts."""

    name: str
    kind: VariableKind
    low: float
    high: float
    unit: str
    start: float

    @property
    def discrete(self) -> bool:
        """Whether it takes whole numbers only."""
        return self.kind in {"whole", "grade"}

    @property
    def is_input(self) -> bool:
        """Whether it is an input; else it is a tolerance."""
        return self.kind in {"number", "whole"}

    @property
    def key(self) -> str:
        """Its name beside all others: that of the input, or ``tolerances.NAME``."""
        return self.name if self.is_input else f"tolerances.{self.name}"


@dataclass(frozen=True)
class Follower:
    """An input that a formula makes follow, in SI."""

    name: str
    formula: Formula
    unit: str


@dataclass(frozen=True, eq=False)
class Space:
    """All variables of one setup, and the inputs that follow, each behind what it follows."""

    setup: Setup
    variables: tuple[Variable, ...]
    followers: tuple[Follower, ...]

    @cached_property
    def scatter(self) -> dict[str, dict[str, Distribution]]:
        """What scatters in the design that the inputs file states, by tolerance and input."""
        return self.setup.distributions()

    @property
    def moved(self) -> frozenset[str]:
        """The inputs that differ between designs."""
        return frozenset(variable.name for variable in self.variables if variable.is_input) | {
            follower.name for follower in self.followers
        }

    @property
    def start(self) -> NDArray[np.float64]:
        """The design that the inputs file states, as a row."""
        return np.array([variable.start for variable in self.variables])

    def designs(self, units: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return designs (m, v) from places in the unit cube; whole variables are at their steps."""
        low, high, discrete = self._ends()
        values = low + units * (high - low)
        return np.where(discrete, np.rint(values), np.clip(values, low, high))

    def units(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places of designs in the unit cube, where they lie outside of it those nearest to them."""
        low, high, _ = self._ends()
        return np.clip((designs - low) / (high - low), 0.0, 1.0)

    def _ends(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        low = np.array([variable.low for variable in self.variables])
        high = np.array([variable.high for variable in self.variables])
        return low, high, np.array([variable.discrete for variable in self.variables])

    def columns(self, designs: NDArray[np.float64], *, as_stated: bool = False) -> dict[str, Any]:
        """Return the nominal inputs (m,) that differ; ``as_stated`` leaves followers as the file states them."""
        fields = self.setup.model.input_fields
        columns: dict[str, Any] = {
            variable.name: designs[:, index] for index, variable in enumerate(self.variables) if variable.is_input
        }
        for follower in self.followers:
            held = {name: self.setup.nominal(name) for name in follower.formula.names}
            stated = self.setup.nominal(follower.name)
            value = stated if as_stated else evaluate(follower.formula, {**held, **columns})
            columns[follower.name] = np.broadcast_to(np.asarray(value, dtype=float), (len(designs),))
        return {
            name: np.rint(values).astype(np.int64) if fields[name].kind == "integer" else values
            for name, values in columns.items()
        }

    def choices(self, designs: NDArray[np.float64]) -> dict[str, tuple[Variable, NDArray[np.float64]]]:
        """Return the tolerances that differ, by name: the variable and its values (m,)."""
        return {
            variable.name: (variable, designs[:, index])
            for index, variable in enumerate(self.variables)
            if not variable.is_input
        }

    def setup_of(self, design: NDArray[np.float64]) -> Setup:
        """Return the setup of one design, as an inputs file would state it."""
        columns = {name: values[0].item() for name, values in self.columns(design[None, :]).items()}
        chosen = [(variable, float(values[0])) for variable, values in self.choices(design[None, :]).values()]
        grades = {variable.name: GRADES[round(value)] for variable, value in chosen if variable.kind == "grade"}
        widths = {variable.name: value for variable, value in chosen if variable.kind == "width"}
        return with_widths(with_grades(self.setup.changed(columns), grades), widths)


def open_space(setup: Setup, brief: Brief) -> Space:
    """Collect what may be chosen. Raises UsageError where there is nothing, or a name or range makes no sense."""
    stated = [objective for objective in setup.model.objectives if isinstance(objective, Vary)]
    inputs = [vary for vary in stated if not vary.by]
    tolerances = [tolerance for tolerance in setup.model.tolerances.values() if price_of(setup, tolerance) is not None]
    _demand_known(setup, brief, {*(vary.input for vary in inputs), *(tolerance.name for tolerance in tolerances)})

    def kept(name: str) -> bool:
        return not brief.vary or name in brief.vary

    variables = [_of_input(setup, vary, brief) for vary in inputs if kept(vary.input)]
    widths = (_of_tolerance(setup, tolerance, brief) for tolerance in tolerances if kept(tolerance.name))
    variables += [variable for variable in widths if variable is not None]
    if not variables:
        raise UsageError(
            f"study '{brief.study}': {setup.model.name} has nothing to choose; add Vary(input, low, high) to its "
            "objectives or a price to a tolerance that is not off"
        )
    return Space(setup, tuple(variables), tuple(_followers(setup, stated, brief)))


def _demand_known(setup: Setup, brief: Brief, known: set[str]) -> None:
    for name in brief.vary:
        if name not in known:
            raise UsageError(
                f"study '{brief.study}': vary names '{name}', which {setup.model.name} may not choose."
                f"{near_miss(name, sorted(known))}"
            )


def _of_input(setup: Setup, vary: Vary, brief: Brief) -> Variable:
    input_field = setup.model.input_fields[vary.input]
    what = f"study '{brief.study}': Vary('{vary.input}')"
    low, high = (_end(input_field, text, what) for text in (vary.low, vary.high))
    whole = input_field.kind in {"whole", "integer"}
    if whole:
        low, high = float(ceil(low)), float(floor(high))
    if not low < high:
        raise UsageError(f"{what} runs from {vary.low} to {vary.high}, which leaves nothing to choose")
    start = float(setup.nominal(vary.input))
    if isnan(start):
        raise UsageError(f"{what} has no value to start from; give '{vary.input}' in the inputs")
    return Variable(vary.input, "whole" if whole else "number", low, high, setup.print_unit(vary.input), start)


def _end(input_field: InputField, text: str, what: str) -> float:
    """Read one end of a range in SI. Raises UsageError for a text that is none, or beyond the bounds of the input."""
    try:
        value = read_quantity(text, input_field.unit)
    except UnitError as error:
        raise UsageError(f"{what}: {error}") from None
    broken = "" if input_field.kind == "whole" else broken_bound(input_field, value)
    if broken:
        raise UsageError(f"{what}: {broken}")
    return value


def _of_tolerance(setup: Setup, tolerance: Tolerance, brief: Brief) -> Variable | None:
    """Return a tolerance as a variable; None where it is off, drawn by a function, or has a single grade to take."""
    spread, price = setup.spread_of(tolerance.name), price_of(setup, tolerance)
    scattering = setup.distributions().get(tolerance.name, {})
    assert price is not None  # open_space has chosen these
    if not scattering or not isinstance(spread, (Band, Grade, Zone)):
        return None
    width = next(iter(scattering.values())).width
    if isinstance(spread, Grade):
        return _of_grade(setup, tolerance, spread, brief, width)
    return Variable(tolerance.name, "width", brief.tightest * width, brief.widest * width, price.width, width)


def _of_grade(setup: Setup, tolerance: Tolerance, spread: Grade, brief: Brief, width: float) -> Variable | None:
    """Return a tolerance whose grade is chosen: from the finest allowed to the coarsest that is not too wide."""
    target, start = setup.target(tolerance.on[0]), GRADES.index(spread.grade)
    places = []
    for index, name in enumerate(GRADES):
        try:
            size = replace(spread, grade=name).width(target)
        except TruingError:  # ISO 286 has no such grade for the size
            continue
        if index == start or (index >= GRADES.index(brief.finest) and size <= brief.widest * width * (1 + SLACK)):
            places.append(index)
    if len(places) < 2:
        return None
    return Variable(tolerance.name, "grade", float(min(places)), float(max(places)), "", float(start))


def _followers(setup: Setup, stated: list[Vary], brief: Brief) -> Iterator[Follower]:
    """Yield the inputs that follow, each behind those it follows itself. Raises UsageError for a circle."""
    formulas = {vary.input: parse(vary.by) for vary in stated if vary.by}
    done: set[str] = set()
    while len(done) < len(formulas):
        ready = [
            name
            for name, formula in formulas.items()
            if name not in done and not (set(formula.names) & set(formulas)) - done
        ]
        if not ready:
            circle = " and ".join(f"'{name}'" for name in formulas if name not in done)
            raise UsageError(f"study '{brief.study}': {circle} follow each other by their formulas in a circle")
        for name in ready:
            done.add(name)
            yield Follower(name, formulas[name], setup.print_unit(name))


# How much every input scatters in every design: means and standard deviations of many designs at once


@dataclass(frozen=True)
class Scattered:
    """The scatter of one input in m designs, SI: mean (m,), standard deviation (m,), shape; NaN where there is none."""

    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    shape: DistributionShape

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
    scatter: dict[str, dict[str, Scattered]] = {}
    for name, inner in space.scatter.items():
        tolerance = space.setup.model.tolerances[name]
        variable, values = choices.get(name, (None, None))
        spread = space.setup.spread_of(name)
        grades = values if variable is not None and variable.kind == "grade" else None
        by_column = {
            column: _resolved(space, spread, column, (base, columns, grades, len(designs)))
            for column, base in inner.items()
        }
        scatter[name] = _widened(tolerance, spread, by_column, values) if _is_width(variable) else by_column
    return scatter


def _is_width(variable: Variable | None) -> bool:
    return variable is not None and variable.kind == "width"


def _widened(
    tolerance: Tolerance, spread: Spread, by_column: Mapping[str, Scattered], widths: Any
) -> dict[str, Scattered]:
    """Bring a band to its chosen width (that of its first input); a zone grows where it says."""
    first = next(iter(by_column.values())).width
    with np.errstate(all="ignore"):
        factor = widths / first
    shift = shift_per_width(spread)
    return {
        column: replace(
            distribution,
            mean=distribution.mean + shift * (factor - 1) * distribution.width,
            sd=distribution.sd * factor,
        )
        for column, distribution in by_column.items()
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
    resolved = [
        _of_design(space.setup, spread, column, dict(zip(reads, key[1:], strict=True)), key[0]) for key in unique
    ]
    shift, sd = (np.array(part)[where.reshape(-1)] for part in zip(*resolved, strict=True))
    return Scattered(nominal + shift, sd, base.shape)


def _of_design(
    setup: Setup, spread: Spread, column: str, values: Mapping[str, float], grade_index: float
) -> tuple[float, float]:
    """Return how far the mean lies from the nominal, and the standard deviation; NaN for no such grade."""

    def value_of(name: str) -> Any:
        return values.get(name, setup.nominal(name))

    if grade_index >= 0 and isinstance(spread, Grade):
        spread = replace(spread, grade=GRADES[round(grade_index)])
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


# With what probability do machines of many designs keep a limit? The same standard normal draws for every design


STEP = 0.1  # of a standard deviation, for central differences


class Answering(Protocol):
    """Runs the model, or what stands in for it, on a batch and returns the wanted results, NaN where a row failed."""

    def __call__(self, columns: Mapping[str, Any], rows: int, wanted: Sequence[str]) -> Mapping[str, Any]:
        """Return results by name, (rows,) or (rows, k)."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """The causes of scatter, and by name standard normal values (k, n), or deviations where a function draws them."""

    causes: tuple[ScatterSource, ...]
    standard: Mapping[str, NDArray[np.float64]]
    draws: int


@dataclass(frozen=True)
class Designs:
    """Designs (m,) with how their inputs scatter."""

    world: World
    spreads: Mapping[str, Mapping[str, Scattered]]
    rows: int

    def nominal(self, column: str) -> Any:
        """Return the nominal values (m,) of a column."""
        own = self.world.columns.get(column)
        return np.full(self.rows, nominal_of(self.world.setup, column)) if own is None else own


def cloud_of(scatter: Scatter, seed: int, study: str, draws: int) -> Cloud:
    """Draw the machines once, for all designs; other random numbers than those of any verification."""
    standard: dict[str, NDArray[np.float64]] = {}
    for cause in scatter.causes:
        rng = generator(seed, 0, f"{study}: {cause.name}")
        if cause.function is not None:
            deviations = cause.function(rng, draws)
            standard[cause.name] = np.array([np.asarray(deviations[column], dtype=float) for column in cause.columns])
        else:
            standard[cause.name] = np.array([_stratified(rng, draws) for _ in cause.columns])
    return Cloud(scatter.causes, standard, draws)


def _stratified(rng: np.random.Generator, draws: int) -> NDArray[np.float64]:
    return np.asarray(ndtri((rng.permutation(draws) + rng.random(draws)) / draws))


def by_draws(cloud: Cloud, designs: Designs, bounds: Sequence[Bound], answer: Answering) -> NDArray[np.float64]:
    """Return the share of machines (m, bounds) that keep each limit; a machine without an answer keeps none."""
    shape = (designs.rows, cloud.draws)
    columns = _machines(cloud, designs)
    flat = {name: np.ascontiguousarray(values).reshape(-1) for name, values in columns.items()}
    results = answer(flat, designs.rows * cloud.draws, _wanted(bounds))
    each = {name: np.asarray(values).reshape(*shape, *np.shape(values)[1:]) for name, values in results.items()}
    probabilities = np.empty((designs.rows, len(bounds)))
    for index, bound in enumerate(bounds):
        low, high = _ends(designs.world, bound)
        response = each[bound.result]
        if _moves(designs.world, bound):
            limit = each.get(bound.require.limit, columns.get(bound.require.limit))
            limit = _per_design(designs.world.value(bound.require.limit), response) if limit is None else limit
            response = response - beside(limit, response)
        with np.errstate(invalid="ignore"):
            inside = (response <= _per_design(high, response)) & (response >= _per_design(low, response))
        probabilities[:, index] = _worst(inside.mean(axis=1))
    return probabilities


def _per_design(limit: Any, values: Any) -> Any:
    """Bring a limit, a number or (m, ...), beside values (m, n, ...)."""
    if np.ndim(limit) == 0:
        return limit
    return beside(np.expand_dims(np.asarray(limit), 1), values)


def _worst(chances: Any) -> Any:
    """Return the smallest chance of every design where a result runs along an axis."""
    return chances.min(axis=tuple(range(1, chances.ndim))) if chances.ndim > 1 else chances


def _wanted(bounds: Sequence[Bound]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for bound in bounds for name in (bound.result, bound.require.limit)))


def _moves(world: World, bound: Bound) -> bool:
    """Whether a one-sided limit is another result or an input, which is then that of the same machine."""
    model, named = world.setup.model, bound.require.limit
    return bound.require.kind != "within" and (named in model.own_result_fields or named in model.input_fields)


def _ends(world: World, bound: Bound) -> tuple[Any, Any]:
    if not _moves(world, bound):
        return world.ends(bound)
    infinity = float("inf")
    return (0.0, infinity) if bound.require.kind == "at_least" else (-infinity, 0.0)


def _machines(cloud: Cloud, designs: Designs) -> dict[str, Any]:
    """Return the columns of all machines of all designs (m, n); two tolerances on one input add their deviations."""
    shape = (designs.rows, cloud.draws)
    columns: dict[str, Any] = {}
    for cause in cloud.causes:
        for column, values in _of_cause(cause, cloud.standard[cause.name], designs):
            if column in columns:
                values = columns[column] + (values - designs.nominal(column)[:, None])
            columns[column] = np.broadcast_to(values, shape)
    for column, nominal in designs.world.columns.items():
        if column not in columns:
            columns[column] = np.broadcast_to(nominal[:, None], shape)
    return columns


def _of_cause(cause: ScatterSource, standard: NDArray[np.float64], designs: Designs) -> list[tuple[str, Any]]:
    if cause.function is not None:
        return [(name, designs.nominal(name)[:, None] + standard[i]) for i, name in enumerate(cause.columns)]
    if cause.mixing is not None or cause.name not in designs.spreads:
        return [(column, values[None, :]) for column, _, values in cause.from_standard(standard)]
    own = designs.spreads[cause.name]
    return [(column, own[column].values(standard[index])) for index, column in enumerate(cause.columns)]


def by_first_order(
    scatter: Scatter, designs: Designs, bounds: Sequence[Bound], answer: Answering
) -> NDArray[np.float64]:
    """Return the normal probability (m, bounds) of the model made straight at every design; 0 where there is none."""
    columns = scatter.columns
    steps, variances, shifts = _moments(scatter, designs)
    values = _beside_the_designs(designs, columns, steps, _wanted(bounds), answer)
    probabilities = np.empty((designs.rows, len(bounds)))
    for index, bound in enumerate(bounds):
        centre, slopes = _line(designs, bound, values, (columns, steps))
        low, high = _ends(designs.world, bound)
        variance, mean = variances(slopes), centre
        for column, shift in shifts.items():
            mean = mean + slopes[column] * beside(shift, slopes[column])
        sd = np.sqrt(np.maximum(variance, 0.0))
        chance = _worst(np.asarray(normal_chance(mean, sd, beside(low, mean), beside(high, mean))))
        probabilities[:, index] = np.where(np.isfinite(chance), chance, 0.0)
    return probabilities


def _moments(scatter: Scatter, designs: Designs) -> tuple[dict[str, Any], Any, dict[str, Any]]:
    """Return by column the step (m,), then how variances follow from slopes, and how far means lie from nominals."""
    squares: dict[str, Any] = {}
    shifts: dict[str, Any] = {}
    for cause in scatter.causes:
        own = designs.spreads.get(cause.name) if cause.mixing is None else None
        for index, column in enumerate(cause.columns):
            stated = cause.distributions[index]
            sd = np.full(designs.rows, stated.sd) if own is None else own[column].sd
            shift = stated.mean - cause.nominals[index] if own is None else own[column].mean - designs.nominal(column)
            squares[column] = squares.get(column, 0.0) + sd**2
            shifts[column] = shifts.get(column, 0.0) + shift * np.ones(designs.rows)
    steps = {column: STEP * np.sqrt(square) for column, square in squares.items()}

    def variances(slopes: Mapping[str, Any]) -> Any:
        total: Any = 0.0
        for cause in scatter.causes:
            own = designs.spreads.get(cause.name) if cause.mixing is None else None
            if own is not None:
                for column in cause.columns:
                    total = total + (slopes[column] * beside(own[column].sd, slopes[column])) ** 2
                continue
            matrix = cause.covariance()
            for i, one in enumerate(cause.columns):
                for j, other in enumerate(cause.columns):
                    total = total + slopes[one] * slopes[other] * matrix[i, j]
        return total

    return steps, variances, {column: shift for column, shift in shifts.items() if np.any(shift != 0)}


def _beside_the_designs(
    designs: Designs, columns: Sequence[str], steps: Mapping[str, Any], wanted: Sequence[str], answer: Answering
) -> dict[str, Any]:
    """Run every design, and every design with one column a step up and a step down: results (m, 1 + 2 k, ...)."""
    width = 1 + 2 * len(columns)
    batch: dict[str, Any] = {}
    for name in dict.fromkeys([*designs.world.columns, *columns]):
        values = np.repeat(designs.nominal(name)[:, None], width, axis=1)
        if name in steps:
            column = 1 + 2 * list(columns).index(name)
            values[:, column] += steps[name]
            values[:, column + 1] -= steps[name]
        batch[name] = values.reshape(-1)
    results = answer(batch, designs.rows * width, wanted)
    inputs = {name: values.reshape(designs.rows, width) for name, values in batch.items()}
    shaped = {
        name: np.asarray(values).reshape(designs.rows, width, *np.shape(values)[1:]) for name, values in results.items()
    }
    return {**inputs, **shaped}


def _line(
    designs: Designs, bound: Bound, values: Mapping[str, Any], steps: tuple[Sequence[str], Mapping[str, Any]]
) -> tuple[Any, dict[str, Any]]:
    """Return the response at every design and its slopes by column; from one side where the other has no answer."""
    response = values[bound.result]
    if _moves(designs.world, bound):
        limit = values.get(bound.require.limit)
        limit = _per_design(designs.world.value(bound.require.limit), response) if limit is None else limit
        response = response - beside(limit, response)
    centre = response[:, 0]
    slopes: dict[str, Any] = {}
    for index, column in enumerate(steps[0]):
        step = beside(steps[1][column], centre)
        up, down = response[:, 1 + 2 * index], response[:, 2 + 2 * index]
        with np.errstate(all="ignore"):
            slope = (up - down) / (2 * step)
            slope = np.where(np.isfinite(slope), slope, np.where(np.isfinite(up), up - centre, centre - down) / step)
        slopes[column] = np.where(step > 0, slope, 0.0)
    return centre, slopes
