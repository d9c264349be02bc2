"""How uncertain is a result, and by what? An uncertainty budget after the Guide (GUM, JCGM 100:2008), first order."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import ndtri, stdtrit

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.numbers import format_number, pretty, with_unit
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome
from truing.studies.checks import as_number
from truing.studies.drawings import bars
from truing.studies.first_order import exact_slopes, slopes, unknown_columns
from truing.studies.reading import per, printed, printed_step, spoken
from truing.studies.sampling import Scatter, ScatterSource, scatter_of
from truing.studies.sensitivity import asked_results
from truing.units import difference_unit, from_si, unit_factor, unit_text

GUIDE = "JCGM 100:2008, Evaluation of measurement data – Guide to the expression of uncertainty in measurement (GUM)."
SHAPES = {"normal": "normal", "uniform": "rectangular", "lognormal": "lognormal"}
APART = 0.03
"""Share by which drawn machines may scatter otherwise than to first order before it is a warning."""


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Say what each source adds to the uncertainty of a result, and state the result with its expanded uncertainty.

    ``of`` names results; empty: those named in a Require, Minimise or Maximise, else all that are one number. ``level``
    is the coverage probability. ``degrees`` holds degrees of freedom by source, infinite where it names none;
    ``type_a`` names sources that come from observations, as diagnosed effects do. ``draws`` machines of the model
    itself show what the first order leaves out; 0: none.
    """

    of: str | tuple[str, ...] = ()
    level: float = 0.95
    degrees: Mapping[str, float] = field(default_factory=dict)
    type_a: tuple[str, ...] = ()
    draws: int = 10_000
    name: str = "uncertainty"
    gives: Callable[[Budgets], Any] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.level < 1:
            raise UsageError(f"level = {self.level:g}, but a coverage probability lies between 0 and 1")
        if self.draws < 0:
            raise UsageError(f"draws = {self.draws}, but no fewer than 0 machines can be drawn")
        for name, value in self.degrees.items():
            if not value > 0:
                raise UsageError(f"degrees of freedom lie above 0; those of '{name}' are {value:g}")

    def run(self, bench: Bench) -> Budgets:
        """Differentiate in one batch of the model, add up after the Guide, and draw machines to compare."""
        setup, scatter = bench.setup, scatter_of(bench.setup)
        asked = asked_results(setup, self.of, self.name)
        results = tuple(name for name in asked if name not in bench.absent)
        derivatives = slopes(setup, results, scatter.columns, scatter)
        exact = exact_slopes(setup)
        machines = self.draws if scatter.causes else 0
        drawn = bench.rows(scatter.draw(setup.seed, 0, machines), machines, *results) if machines else {}
        self._demand_known(scatter)
        budgets = {}
        for result in results:
            slope = {**derivatives.of[result], **{name: float(of) for name, of in exact.get(result, {}).items()}}
            sources = tuple(self._sources(scatter, slope))
            shift = sum(slope[column] * moved for column, moved in scatter.shifts().items())
            answers = np.array([]) if result not in drawn else drawn[result][np.isfinite(drawn[result])]
            value = float(derivatives.nominal[result]) + shift
            sd = float(answers.std()) if len(answers) > 1 else math.nan
            shared = tuple(_shared(scatter, slope))
            budgets[result] = Budget(value, sources, self.level, shared=shared, drawn=sd, answered=len(answers))
        missing = [f"'{name}' has no uncertainty: {bench.absent[name]}" for name in asked if name in bench.absent]
        return Budgets(
            name=self.name,
            budgets=budgets,
            units={name: setup.print_unit(name) for name in results} | dict(_units(setup, scatter)),
            draws=self.draws,
            remarks=(*missing, *derivatives.warnings, *self._doubtful_degrees(scatter)),
        )

    def _doubtful_degrees(self, scatter: Scatter) -> Iterator[str]:
        """Say which correlated sources have degrees of freedom, which are added up as if they were independent."""
        coupled = {column for pair in scatter.pairs for column in (pair.first, pair.second)}
        owners = {column: cause.name for cause in scatter.causes for column in cause.columns if column in coupled}
        names = [name for column, owner in owners.items() for name in (column, owner) if name in self.degrees]
        if names:
            yield (
                f"the effective degrees of freedom hold for independent sources (Welch and Satterthwaite), and "
                f"{' and '.join(repr(name) for name in dict.fromkeys(names))} is correlated with another"
            )

    def _demand_known(self, scatter: Scatter) -> None:
        known = [name for cause in scatter.causes for name in (cause.name, *_names(cause))]
        for name in (*self.degrees, *self.type_a):
            if name not in known:
                near = near_miss(name, known) or f" (sources: {', '.join(dict.fromkeys(known)) or 'none'})"
                raise UsageError(f"study '{self.name}': '{name}' is no source that scatters.{near}")

    def _sources(self, scatter: Scatter, slope: Mapping[str, float]) -> Iterator[BudgetSource]:
        """Give one source for each input that a cause moves by itself, and one for all that it moves together."""
        for cause in scatter.causes:
            note, shape = _about(scatter.setup, cause)
            gradient = np.array([slope[column] for column in cause.columns], dtype=float)
            covariance = cause.covariance()
            parts = [np.arange(len(gradient))] if cause.mixing is not None else list(np.arange(len(gradient))[:, None])
            for name, part in zip(_names(cause), parts, strict=True):
                own = gradient[part]
                alone = int(part[0]) if len(part) == 1 else None
                is_observed = cause.name.startswith("effects.") or {name, cause.name} & {*self.type_a}
                yield BudgetSource(
                    name=name,
                    column="" if alone is None else cause.columns[alone],
                    note=note,
                    type="A" if is_observed else "B",
                    shape=shape or SHAPES[cause.distributions[part[0]].shape],
                    u=math.nan if alone is None else float(np.sqrt(covariance[alone, alone])),
                    sensitivity=math.nan if alone is None else float(own[0]),
                    contribution=float(np.sqrt(np.maximum(own @ covariance[np.ix_(part, part)] @ own, 0.0))),
                    degrees=float(self.degrees.get(name, self.degrees.get(cause.name, math.inf))),
                )


def _shared(scatter: Scatter, slope: Mapping[str, float]) -> Iterator[SharedTerm]:
    """Give what each two correlated inputs add together to the variance of a result."""
    for pair in scatter.pairs:
        amount = 2 * slope[pair.first] * slope[pair.second] * pair.covariance
        yield SharedTerm(pair.first, pair.second, pair.of_values, float(amount))


def _names(cause: ScatterSource) -> tuple[str, ...]:
    """Name the sources of a cause: itself where it moves one input, or several together, else these inputs."""
    if cause.mixing is not None or (len(cause.columns) == 1 and not cause.name.startswith("effects.")):
        return (cause.name,)
    return cause.columns


def _about(setup: Setup, cause: ScatterSource) -> tuple[str, str]:
    """Return what is noted of a cause, and its distribution where the columns do not say it."""
    if cause.name.startswith("effects."):
        active = unknown_columns(setup)[cause.columns[0]][0]
        return active.effect.why or active.effect.looks_like or "diagnosed", "normal"
    tolerance = setup.model.tolerances[cause.name]
    words = [tolerance.why, setup.spread_of(cause.name).text]
    return ", ".join(filter(None, words)), "drawn together" if cause.function is not None else ""


def _units(setup: Setup, scatter: Scatter) -> Iterator[tuple[str, str]]:
    unknowns = unknown_columns(setup)
    for column in scatter.columns:
        yield column, unknowns[column][1].unit if column in unknowns else setup.print_unit(column)


@dataclass(frozen=True, kw_only=True)
class BudgetSource:
    """One source in SI: standard uncertainty ``u``, ``sensitivity``, ``contribution`` to that of the result.

    ``column`` is the input or unknown it moves. Of one that moves several together it is empty, and ``u`` and
    ``sensitivity`` are NaN.
    """

    name: str
    column: str
    note: str
    type: str
    shape: str
    u: float
    sensitivity: float
    contribution: float
    degrees: float


@dataclass(frozen=True)
class SharedTerm:
    """What two correlated inputs add together to the variance of a result, SI: 2 c_i c_j u(x_i) u(x_j) r (GUM 5.2.2).

    ``correlation`` is that of their values.
    """

    first: str
    second: str
    correlation: float
    variance: float


@dataclass(frozen=True)
class Budget:
    """The sources of one result's uncertainty in SI, and what correlated ones add together (``shared``).

    ``drawn`` is the standard deviation of drawn machines, of which ``answered`` have an answer; NaN where none has.
    """

    value: float
    sources: tuple[BudgetSource, ...]
    level: float
    shared: tuple[SharedTerm, ...] = ()
    drawn: float = math.nan
    answered: int = 0

    @property
    def combined(self) -> float:
        """The combined standard uncertainty: the root of the sum of squares, and of what correlated sources share."""
        alone = math.hypot(*(source.contribution for source in self.sources))
        if not self.shared:
            return alone
        return math.sqrt(max(alone**2 + sum(term.variance for term in self.shared), 0.0))

    @property
    def degrees(self) -> float:
        """The effective degrees of freedom after Welch and Satterthwaite."""
        whole = sum(source.contribution**4 / source.degrees for source in self.sources)
        return self.combined**4 / whole if whole > 0 else math.inf

    @property
    def factor(self) -> float:
        """The coverage factor: Student's t of the level, with the degrees of freedom cut to a whole number."""
        share = (1 + self.level) / 2
        whole = max(1.0, math.floor(self.degrees)) if math.isfinite(self.degrees) else math.inf
        return float(stdtrit(whole, share) if math.isfinite(whole) else ndtri(share))

    @property
    def expanded(self) -> float:
        """The expanded uncertainty U."""
        return self.factor * self.combined

    def share(self, source: BudgetSource) -> float:
        """Return the part of a source in the combined variance."""
        return (source.contribution / self.combined) ** 2 if self.combined else 0.0

    def ranked(self) -> list[BudgetSource]:
        """Return the sources, the largest contribution first."""
        return sorted(self.sources, key=lambda source: -source.contribution)


def _shared_json(term: SharedTerm, budget: Budget) -> dict[str, Any]:
    share = term.variance / budget.combined**2 if budget.combined else 0.0
    return {"inputs": [term.first, term.second], "correlation": term.correlation, "share": as_number(share)}


def _shared_table(result: str, budget: Budget) -> Table:
    """Say what each two correlated inputs add together."""
    rows: list[list[Any]] = [[term.first, term.second, term.correlation, 100 * term.variance / budget.combined**2]
            for term in budget.shared]  # fmt: skip
    note = (
        "Each adds 2 c(x) c(y) u(x) u(y) r to the combined variance; below 0 the two take from it. With the shares of "
        "the sources these make 100 %. r is the correlation of the values."
    )
    columns = ("source x", "source y", "r", "share")
    return Table(f"Correlated sources of the {spoken(result)}", columns, rows, ("", "", "", "%"), note)


def _no_budget(result: str, budget: Budget) -> Words:
    """Say why a result has no budget: nothing moves it, or it has no derivative by some source."""
    lacking = [source.name for source in budget.sources if math.isnan(source.contribution)]
    if not lacking:
        return Words(f"Nothing that scatters moves the {spoken(result)}: it has no uncertainty here.")
    return Words(f"The {spoken(result)} has no budget: there is no derivative by {', '.join(lacking)}.", "warning")


@dataclass(frozen=True, kw_only=True)
class Budgets(Outcome):
    """An uncertainty budget for each result, in SI; ``units`` are those in which results and sources are printed."""

    name: str
    budgets: Mapping[str, Budget]
    units: Mapping[str, str]
    draws: int
    remarks: tuple[str, ...] = ()
    cites: tuple[str, ...] = (GUIDE,)

    def as_json(self) -> dict[str, Any]:
        """Return each budget in printed units; degrees of freedom that are infinite are null."""
        return {result: self._budget_json(result, budget) for result, budget in self.budgets.items()}

    def _budget_json(self, result: str, budget: Budget) -> dict[str, Any]:
        unit = self.units[result]
        return {
            "value": printed(budget.value, unit),
            "unit": unit,
            "standard_uncertainty": printed_step(budget.combined, unit),
            "degrees_of_freedom": budget.degrees if math.isfinite(budget.degrees) else None,
            "level": budget.level,
            "coverage_factor": budget.factor,
            "expanded_uncertainty": printed_step(budget.expanded, unit),
            "drawn_standard_deviation": printed_step(budget.drawn, unit),
            "sources": [self._source_json(source, budget, unit) for source in budget.ranked()],
            "correlations": [_shared_json(term, budget) for term in budget.shared],
        }

    def _source_json(self, source: BudgetSource, budget: Budget, unit: str) -> dict[str, Any]:
        u, u_unit, sensitivity, of_unit = self._amounts(source, unit)
        return {
            "name": source.name,
            "type": source.type,
            "distribution": source.shape,
            "standard_uncertainty": u,
            "unit": u_unit,
            "sensitivity": as_number(sensitivity),
            "sensitivity_unit": of_unit,
            "contribution": printed_step(source.contribution, unit),
            "share": as_number(budget.share(source)),
            "degrees_of_freedom": source.degrees if math.isfinite(source.degrees) else None,
        }

    def _amounts(self, source: BudgetSource, unit: str) -> tuple[float | None, str, float | None, str]:
        """Return standard uncertainty and sensitivity of a source, each with its unit; None of several inputs."""
        if not source.column:
            return None, "", None, ""
        own = self.units[source.column]
        slope = source.sensitivity * unit_factor(difference_unit(own)) / unit_factor(difference_unit(unit))
        return printed_step(source.u, own), difference_unit(own), slope, per(unit, own)

    def blocks(self) -> Sequence[Block]:
        """Return for each result its budget, the sentence that states it with U, and a bar for each source."""
        blocks: list[Block] = []
        for result, budget in self.budgets.items():
            if not budget.combined > 0:
                blocks.append(_no_budget(result, budget))
                continue
            unit = difference_unit(self.units[result])
            sizes = {source.name: source.contribution / unit_factor(unit) for source in budget.sources}
            label = f"contribution, {unit_text(unit)}".rstrip(", ")
            blocks.append(self._table(result, budget))
            if budget.shared:
                blocks.append(_shared_table(result, budget))
            blocks.append(Words(self.sentence(result), "finding"))
            blocks.append(Drawing(f"What makes the {spoken(result)} uncertain", bars("", sizes, label)))
        return blocks

    def sentence(self, result: str) -> str:
        """State a result as the Guide asks: value and expanded uncertainty to two digits, k and level.

        Raises UsageError where it has no uncertainty.
        """
        budget, unit = self.budgets[result], self.units[result]
        if not budget.combined > 0:
            raise UsageError(_no_budget(result, budget).text)
        expanded = budget.expanded / unit_factor(difference_unit(unit))
        decimals = 1 - math.floor(math.log10(expanded))
        value, half = (
            pretty(f"{round(number, decimals):.{max(decimals, 0)}f}")
            for number in (float(from_si(budget.value, unit)), expanded)
        )
        said = f"{spoken(result)} = {with_unit(f'({value} ± {half})', unit_text(unit))}"
        return f"{said}, k = {budget.factor:.2f}, coverage {format_number(100 * budget.level, 4)} %."

    def _table(self, result: str, budget: Budget) -> Table:
        unit = difference_unit(self.units[result])
        rows: list[list[Any]] = []
        for source in budget.ranked():
            u, u_unit, slope, slope_unit = self._amounts(source, self.units[result])
            degrees = format_number(source.degrees) if math.isfinite(source.degrees) else "∞"
            rows.append([
                source.name, source.note, source.type, source.shape, u, unit_text(u_unit), slope, unit_text(slope_unit),
                source.contribution / unit_factor(unit), 100 * budget.share(source), degrees,
            ])  # fmt: skip
        columns = (
            "source", "note", "type", "distribution", "u(x)", "unit of u", "c", "unit of c", "|c| u(x)", "share",
            "degrees of freedom",
        )  # fmt: skip
        units = ("",) * 8 + (unit, "%", "")
        return Table(f"Uncertainty budget of the {spoken(result)}", columns, rows, units, self._note(result))

    def _note(self, result: str) -> str:
        """Say what the sources make together, and what drawn machines say of it."""
        budget, unit = self.budgets[result], difference_unit(self.units[result])

        def said(amount: float) -> str:
            return with_unit(pretty(format_number(amount / unit_factor(unit))), unit_text(unit))

        degrees = f"{budget.degrees:.1f}" if math.isfinite(budget.degrees) else "infinite"
        level = format_number(100 * budget.level, 4)
        words = [
            f"Combined standard uncertainty u = {said(budget.combined)}, effective degrees of freedom {degrees}, "
            f"coverage factor k = {budget.factor:.3f} for {level} %, expanded uncertainty U = {said(budget.expanded)}.",
            "First order: what the result bends is left out.",
        ]
        if math.isfinite(budget.drawn):
            without = self.draws - budget.answered
            left_out = f"; {without} more have no answer" if without else ""
            drawn = f"{budget.answered} machines drawn from the model itself have u = {said(budget.drawn)}"
            words.append(f"{drawn}{left_out}.")
        return " ".join(words)

    def warnings(self) -> Sequence[str]:
        """Say where drawn machines scatter otherwise than to first order, and where there is no derivative."""
        bent = []
        for result, budget in self.budgets.items():
            chance = 3 / math.sqrt(2 * budget.answered) if budget.answered else 0.0
            apart = budget.drawn / budget.combined - 1 if budget.combined else 0.0
            if abs(apart) > max(APART, chance):
                words = (
                    "the expanded uncertainty is too small" if apart > 0 else "the expanded uncertainty is too large"
                )
                bent.append(f"drawn machines scatter in '{result}' by {100 * apart:+.0f} % of its first order: {words}")
        return [f"study '{self.name}': {text}" for text in (*bent, *self.remarks)]
