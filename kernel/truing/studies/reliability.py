"""How often is a limit missed? First order, Monte Carlo on the exact model, and FORM beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.blocks import Block, Drawing, Table, Words
from truing.errors import InfeasibleError, UsageError
from truing.evaluate import acting_inputs, answered
from truing.setup import Setup
from truing.studies.bench import Bench
from truing.studies.checks import Z95, Check, Demand, as_number, demands, requirements, worst
from truing.studies.drawings import labelled, lines
from truing.studies.first_order import FormResult, chance, form, straightened
from truing.studies.reading import printed, printed_step, read_range, scattering_name, spoken
from truing.studies.sampling import BATCH, Design, Moments, Tally, goal_checks, sample_along, scatter_of
from truing.units import difference_unit, from_si, unit_text

METHODS = ("first_order", "monte_carlo", "form")
USUAL_GOAL = 0.95
"""Of a limit without a goal, which is checked for the machine as stated, a smaller share of machines is a warning."""


@dataclass(frozen=True, kw_only=True)
class Reliability:
    """Ask with what probability each Require is met by machines of this design.

    For every Require with a reliability, or for all of them where none has one. Monte Carlo draws all tolerances in
    force, conditions with a tolerance, and the unknowns of effects as uncertain as they were diagnosed; the exact model
    answers. ``over`` names an input or condition and ``at`` its range ("0..6000 h"): then there is a curve too.
    """

    draws: int = 100_000
    method: tuple[str, ...] = METHODS
    batch: int = BATCH
    over: str = ""
    at: str = ""
    points: int = 21
    name: str = "reliability"
    gives: Callable[[Odds], Any] | None = None

    def __post_init__(self) -> None:
        unknown = [method for method in self.method if method not in METHODS]
        if unknown or not self.method:
            raise UsageError(f"method takes {', '.join(METHODS)}; not {', '.join(unknown) or 'nothing'}")
        if "form" in self.method and "monte_carlo" not in self.method:
            raise UsageError("form is printed only beside a sampling; add monte_carlo to method")
        if self.draws < 1 or self.batch < 1:
            raise UsageError("draws and batch are at least 1")
        if not 2 <= self.points <= 1000:
            raise UsageError(f"points = {self.points}, but a curve has 2 to 1000 points")

    def run(self, bench: Bench) -> Odds:
        """Answer at the stated inputs, then along ``over`` where asked. Raises UsageError where nothing is required."""
        if bool(self.over) != bool(self.at):  # here and not when it is made: a file may set one and a plugin the other
            example = 'over = "working_time", at = "0..6000 h"'
            raise UsageError(f"study '{self.name}': over and at go together: {example}")
        design = _design(bench.setup, bench.answers)
        if not any(require.result in bench.setup.model.own_result_fields for require in requirements(bench.setup)):
            raise UsageError(
                f"study '{self.name}': {bench.setup.model.name} requires nothing; add Require(result, ...) to it"
            )
        stages = 1 + (self.points if self.over else 0)
        (tally,) = self._drawn(bench, [design], 0.0, 1 / stages)
        odds = self._answer(bench, design, tally)
        return replace(odds, curve=self._curve(bench, 1 / stages) if self.over else None)

    def _drawn(self, bench: Bench, designs: Sequence[Design], begin: float, end: float) -> Sequence[Tally | None]:
        """Draw machines of these designs, where the method asks for it, from one share of the work to another."""
        if "monte_carlo" not in self.method or not designs:
            return [None for _ in designs]
        done = bench.part(self.name, begin, end)
        return sample_along(designs, draws=self.draws, batch=self.batch, executor=bench.executor, done=done)

    def _answer(self, bench: Bench, design: Design, tally: Tally | None) -> Odds:
        scatter, wanted, setup = design.scatter, design.wanted, design.scatter.setup
        straight, derivatives = straightened(scatter, wanted)
        still = () if scatter.causes else ("nothing scatters: every tolerance is off, so each probability is 0 or 1",)
        return Odds(
            name=self.name,
            demands=wanted,
            units={demand.result: setup.print_unit(demand.result) for demand in wanted},
            analytic={demand.name: chance(demand, straight[demand.name]) for demand in wanted},
            first_mean={demand.name: straight[demand.name].mean for demand in wanted},
            first_sd={demand.name: straight[demand.name].sd for demand in wanted},
            form={demand.name: form(scatter, demand) for demand in wanted} if "form" in self.method else {},
            tally=tally,
            remarks=(*_lacking(bench), *derivatives.warnings, *still, *_few_draws(self, wanted)),
            inputs=acting_inputs(setup),
            nominal={demand.result: design.answers[demand.result] for demand in wanted},
        )

    def _curve(self, bench: Bench, begin: float) -> Curve:
        """Answer at every point of the range, with the same random numbers."""
        over = scattering_name(bench.setup, self.over, self.name)
        axis = read_range(self.at, bench.setup.unit_of(over), self.points)
        quick = replace(self, method=tuple(method for method in self.method if method != "form"), points=len(axis))
        designs = [_design_at(bench, over, float(value)) for value in axis]
        possible = [design for design in designs if isinstance(design, Design)]
        tallies = iter(quick._drawn(bench, possible, begin, 1.0))
        answers = [
            design if isinstance(design, str) else quick._answer(bench, design, next(tallies)) for design in designs
        ]
        along = {of: _along(answers, of) for of in ("probability", "at_least", "analytic")}
        failed = tuple((row, odds) for row, odds in enumerate(answers) if isinstance(odds, str))
        return Curve(over=over, unit=bench.setup.print_unit(over), axis=axis, failed=failed, **along)


def _design(setup: Setup, answers: Mapping[str, Any]) -> Design:
    return Design(scatter_of(setup), tuple(demands(setup, answers)), answers)


def _design_at(bench: Bench, over: str, value: float) -> Design | str:
    """Return the machines at one point of a curve, or say why there is no answer."""
    setup = bench.setup
    input_field = setup.model.input_fields.get(over)
    setup = setup.changed({over: int(value) if input_field is not None and input_field.kind == "integer" else value})
    try:
        answers = answered(setup)
    except InfeasibleError as error:
        return str(error)
    wanted = [name for demand in demands(bench.setup, bench.answers) for name in demand.wanted]
    lacking = [answers.absent[name] for name in wanted if name in answers.absent]
    return lacking[0] if lacking else _design(setup, setup.model.read_results(answers.results))


def _lacking(bench: Bench) -> list[str]:
    """Say which limits have no probability because their result does not exist."""
    limited = dict.fromkeys(require.result for require in requirements(bench.setup) if require.result in bench.absent)
    return [f"'{name}' has no probability: {bench.absent[name]}" for name in limited]


def _few_draws(study: Reliability, wanted: Sequence[Demand]) -> Iterator[str]:
    """Say where so few machines are drawn that a goal would be met only if not one of them misses it."""
    goals = {demand.name: demand.goal for demand in wanted if demand.goal is not None}
    for name, goal in goals.items() if "monte_carlo" in study.method else ():
        if goal >= 1:
            yield (
                f"no number of draws shows a reliability of 1 of '{name}'; it counts as reached when none of "
                f"{study.draws} machines misses"
            )
        elif study.draws < (needed := ceil(round(1 / (1 - goal), 6))):
            yield (
                f"draws = {study.draws} cannot show a reliability of {goal:g} of '{name}'; ask for {needed} or "
                "more, better a hundred times as many"
            )


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Probabilities along an input: ``axis`` (n,) in SI, the others (n, ...) by check; NaN where there is no answer."""

    over: str
    unit: str
    axis: Matrix
    probability: Mapping[str, Matrix]
    at_least: Mapping[str, Matrix]
    analytic: Mapping[str, Matrix]
    failed: tuple[tuple[int, str], ...] = ()


def _along(answers: Sequence[Odds | str], of: str) -> dict[str, Matrix]:
    """Put one kind of probability at all points together, by check."""
    given = [None if isinstance(odds, str) else getattr(odds, of) for odds in answers]
    known = [chances for chances in given if chances is not None]
    names = [name for name in known[0] if all(name in chances for chances in known)] if known else []
    gaps = {name: np.full(np.shape(known[0][name]), np.nan) for name in names}
    return {name: np.array([gaps[name] if one is None else one[name] for one in given]) for name in names}


@dataclass(frozen=True, kw_only=True)
class Odds:
    """Probabilities by check: a number each, or an array where the result runs along an axis.

    ``probability`` is that of the Monte Carlo (first order where none was drawn); ``at_least`` the lower end of its
    95 % interval; ``analytic`` first order; ``form`` the tangent planes; ``mean`` and ``sd`` of each result in SI;
    ``inputs`` those of the run, as effects leave them, ``nominal`` the results without scatter in SI.
    """

    name: str = "reliability"
    demands: tuple[Demand, ...]
    units: Mapping[str, str]
    analytic: Mapping[str, Any]
    first_sd: Mapping[str, Any]
    first_mean: Mapping[str, Any] = field(default_factory=dict)
    form: Mapping[str, FormResult] = field(default_factory=dict)
    tally: Tally | None = None
    curve: Curve | None = None
    remarks: tuple[str, ...] = ()
    inputs: Any = None
    nominal: Mapping[str, Any] = field(default_factory=dict)

    def printed_in(self, unit_of: Callable[[str, str], str]) -> Odds:
        """Return the same, printed in other units."""
        curve = self.curve and replace(self.curve, unit=unit_of(self.curve.over, self.curve.unit))
        return replace(self, curve=curve, units={name: unit_of(name, unit) for name, unit in self.units.items()})

    @property
    def draws(self) -> int:
        """How many machines were drawn."""
        return self.tally.draws if self.tally else 0

    @property
    def failed(self) -> int:
        """How many of them had no answer; they count as missed."""
        return self.tally.failed if self.tally else 0

    @property
    def probability(self) -> dict[str, Any]:
        """The share of machines that meets each limit, or first order where none was drawn."""
        return dict(self.analytic) if self.tally is None else self.tally.shares

    @property
    def interval(self) -> dict[str, tuple[Any, Any]]:
        """Wilson's 95 % interval of each probability; of no width where none was drawn."""
        if self.tally is None:
            return {name: (value, value) for name, value in self.analytic.items()}
        return self.tally.intervals

    @property
    def at_least(self) -> dict[str, Any]:
        """The lower end of each interval."""
        return {name: low for name, (low, _) in self.interval.items()}

    @property
    def standard_error(self) -> dict[str, Any]:
        """The standard error of each sampled probability."""
        draws = max(self.draws, 1)
        return {
            name: (value * (1 - value) / draws) ** 0.5 * bool(self.draws) for name, value in self.probability.items()
        }

    @property
    def moments(self) -> Mapping[str, Moments]:
        """Count, mean, spread and extremes of each result over the machines that have an answer, SI."""
        return self.tally.moments if self.tally else {}

    @property
    def mean(self) -> dict[str, Any]:
        """The mean of each result, SI."""
        return {name: moments.mean for name, moments in self.moments.items()}

    @property
    def sd(self) -> dict[str, Any]:
        """The standard deviation of each result, SI."""
        return {name: moments.sd for name, moments in self.moments.items()}

    @property
    def sampled(self) -> bool:
        """Whether machines were drawn."""
        return self.tally is not None

    def as_json(self) -> dict[str, Any]:
        """Return the probabilities by check, and the curve under its input's name."""
        entries = {demand.name: _entry(self, demand) for demand in self.demands}
        if self.curve is not None:
            for name, entry in entries.items():
                entry["curve"] = _curve(self.curve, name)
        return entries

    def blocks(self) -> Sequence[Block]:
        """Return a table of probabilities, one of means and spreads, and the curve."""
        blocks: list[Block] = [_chances(self)]
        if self.sampled:
            blocks.append(_spreads(self))
        for name, form_result in self.form.items():
            if form_result.probability is None:
                blocks.append(Words(f"FORM of the {spoken(name)}: {form_result.status}."))
        if self.curve is not None and self.curve.probability:
            blocks.append(_drawn(self, self.curve))
        return blocks

    def checks(self) -> Sequence[Check]:
        """Compare each probability with its goal; along an axis the worst one."""
        return goal_checks(self.demands, self.probability, self.tally)

    def warnings(self) -> Sequence[str]:
        """Say what failed, and where the sampling is too small to decide."""
        words = list(self.remarks)
        if self.tally is not None and self.tally.failed:
            words.append(self.tally.lost)
        chances, errors = self.probability, self.standard_error
        for demand in self.demands:
            if demand.goal is None and (chance := worst(chances[demand.name])) < USUAL_GOAL:
                words.append(
                    f"'{demand.name}' is checked for the values as stated only; of the machines that scatter "
                    f"{100 * chance:.3g} % keep it"
                )
            if demand.goal is None or not self.sampled:
                continue
            apart, noise = abs(worst(chances[demand.name]) - demand.goal), Z95 * float(np.max(errors[demand.name]))
            if apart < noise:
                words.append(
                    f"whether '{demand.name}' reaches {demand.goal:g} lies within the sampling error of {noise:.2g}; "
                    "ask for more draws"
                )
        if self.curve and self.curve.failed:
            reason = self.curve.failed[0][1]
            words.append(f"{len(self.curve.failed)} points along '{self.curve.over}' have no answer ({reason})")
        return [f"study '{self.name}': {text}" for text in words]


# How the outcome of a reliability study is written: results.json and the sheet


def _entry(odds: Odds, demand: Demand) -> dict[str, Any]:
    name, unit = demand.name, odds.units[demand.result]
    interval = [as_number(end) for end in odds.interval[name]] if odds.sampled else None
    entry: dict[str, Any] = {
        "probability": as_number(odds.probability[name]),
        "interval95": interval,
        "standard_error": as_number(odds.standard_error[name]) if odds.sampled else None,
        "draws": odds.draws,
        "method": "monte_carlo" if odds.sampled else "first_order",
        "goal": demand.goal,
        "first_order": as_number(odds.analytic[name]),
        "first_order_sd": printed_step(odds.first_sd[name], unit),
        "result": demand.result,
        "unit": unit,
    }
    if name in odds.form:
        entry["form"] = odds.form[name].as_json()
    if odds.tally is not None:
        moments = odds.moments[demand.result]
        entry["failed"] = odds.tally.failed
        entry["mean"] = printed(moments.mean, unit)
        entry["sd"] = printed_step(moments.sd, unit)
        entry["smallest"], entry["largest"] = printed(moments.smallest, unit), printed(moments.largest, unit)
    return entry


def _curve(curve: Curve, name: str) -> dict[str, Any]:
    return {
        "over": curve.over,
        "unit": curve.unit,
        "at": printed(curve.axis, curve.unit),
        "probability": as_number(curve.probability[name]) if name in curve.probability else None,
        "at_least": as_number(curve.at_least[name]) if name in curve.at_least else None,
        "first_order": as_number(curve.analytic[name]) if name in curve.analytic else None,
        "failed": [{"row": row, "reason": reason} for row, reason in curve.failed],
    }


def _chances(odds: Odds) -> Table:
    rows: list[list[Any]] = []
    for demand in odds.demands:
        name = demand.name
        form_result = odds.form.get(name)
        interval = [100 * worst(end) for end in odds.interval[name]] if odds.sampled else [None, None]
        sampled = 100 * worst(odds.probability[name]) if odds.sampled else None
        tangent = None if form_result is None or form_result.probability is None else 100 * form_result.probability
        goal = None if demand.goal is None else 100 * demand.goal
        rows.append([name, goal, sampled, *interval, 100 * worst(odds.analytic[name]), tangent])
    columns = ("limit kept", "goal", "Monte Carlo", "95 % from", "to", "first order", "FORM")
    return Table("Probability", columns, rows, ("", *("%" for _ in columns[1:])), _note(odds))


def _note(odds: Odds) -> str:
    if not odds.sampled:
        return "First order: the model as a straight line about its nominal point."
    words = f"{odds.draws} machines drawn on the exact model; the checks take the Monte Carlo unless a later "
    words += "study, as an allocation, decides them with other tolerances."
    if odds.failed:
        words += f" {odds.failed} of them have no answer and count as missed."
    if any(getattr(value, "ndim", 0) for value in odds.probability.values()):
        words += " Where a result runs along an axis, the worst place is shown."
    return words


def _spreads(odds: Odds) -> Table:
    """Show mean and spread of every required result that is one number, each in its own unit.

    Mean and extremes are told from the result without scatter, where their digits matter.
    """
    rows: list[list[Any]] = []
    for result, unit in odds.units.items():
        moments = odds.moments[result]
        if getattr(moments.mean, "ndim", 0) or not moments.count:
            continue
        first = next(odds.first_sd[demand.name] for demand in odds.demands if demand.result == result)
        mean, *ends = (
            printed_step(value - odds.nominal[result], unit)
            for value in (moments.mean, moments.smallest, moments.largest)
        )
        spread = [printed_step(moments.sd, unit), printed_step(first, unit)]
        rows.append([result, unit_text(difference_unit(unit)), mean, *spread, *ends])
    columns = ("result", "unit", "mean", "standard deviation", "first order", "smallest", "largest")
    note = "Mean, smallest and largest are differences from the result without scatter."
    return Table("Scatter of the results", columns, rows, note=note)


def _drawn(odds: Odds, curve: Curve) -> Drawing:
    x = [float(value) for value in from_si(curve.axis, curve.unit)]
    series = {
        name: [float(value) for value in np.reshape(values, (len(x), -1)).min(axis=1)]
        for name, values in curve.probability.items()
    }
    goals = {demand.name: demand.goal for demand in odds.demands if demand.goal is not None}
    labels = (labelled(curve.over, unit_text(curve.unit)), "probability")
    return Drawing(f"Probability along the {spoken(curve.over)}", lines(x, series, labels, goals))
