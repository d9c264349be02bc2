"""Which sources of error matter? Derivatives, shares of the variance, and Sobol indices of the exact model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import ndtri

from truing.arrays import Matrix
from truing.declare.blocks import Block, Drawing, Table
from truing.declare.goals import Vary
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.evaluate import acting_inputs
from truing.heavy import stats
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome, StepProgress
from truing.studies.drawings import MOST_BARS, bars
from truing.studies.first_order import exact_slopes, nominal_of, slopes, unknown_columns
from truing.studies.reading import per, printed_step, scalar_results, single_numbers, spoken
from truing.studies.sampling import Scatter, scatter_of, standard_rows
from truing.units import difference_unit, unit_factor, unit_text

AGREES_TO = 1e-6


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """Differentiate results by every source of error, and say whose share of the variance is largest.

    ``of`` names results; empty: those named in a Require, Minimise or Maximise, else all that are one number.
    ``at_inputs`` names the sources; empty: every input that a tolerance is on, also where its spread is off, and the
    unknowns of effects that are on. ``sobol`` is the number of base samples for Sobol indices, a power of two; 0: none.
    """

    of: str | tuple[str, ...] = ()
    at_inputs: tuple[str, ...] = ()
    sobol: int = 0
    name: str = "sensitivity"
    gives: Callable[[Sensitivities], Any] | None = None

    def __post_init__(self) -> None:
        if self.sobol < 0 or self.sobol & (self.sobol - 1):
            near = 1 << max(self.sobol, 1).bit_length()
            raise UsageError(f"sobol = {self.sobol} is no power of two; write 0 or {near}")

    def run(self, bench: Bench) -> Sensitivities:
        """Differentiate in one batch of the model; then Sobol's samples where asked."""
        setup = bench.setup
        asked = asked_results(setup, self.of, self.name)
        results = tuple(name for name in asked if name not in bench.absent)
        missing = [f"'{name}' has no derivatives: {bench.absent[name]}" for name in asked if name in bench.absent]
        scatter = scatter_of(setup)
        sources = _sources(setup, self.at_inputs, self.name)
        derivatives = slopes(setup, results, tuple(dict.fromkeys([*sources, *scatter.columns])), scatter)
        numeric = {result: dict(derivatives.of[result]) for result in results}
        exact = exact_slopes(setup)
        best = {result: {**numeric[result], **_plain(exact.get(result, {}), numeric[result])} for result in results}
        share, sd = _shares(best, scatter)
        first, total, remarks = self._indices(bench, scatter, results)
        return Sensitivities(
            name=self.name,
            derivatives={result: {source: best[result][source] for source in sources} for result in results},
            share={result: {source: share[result].get(source, 0.0) for source in sources} for result in results},
            sd=sd,
            sobol_first=first,
            sobol_total=total,
            agreement=_agreement(numeric, exact),
            units={name: setup.print_unit(name) for name in results} | {name: _unit(setup, name) for name in sources},
            remarks=(*missing, *derivatives.warnings, *remarks),
            inputs=acting_inputs(setup),
            still=frozenset(source for source in sources if not scatter.sd_of(source)),
            coupled=frozenset(name for pair in scatter.pairs for name in (pair.first, pair.second)),
        )

    def _indices(self, bench: Bench, scatter: Scatter, results: Sequence[str]) -> tuple[_Indices, _Indices, list[str]]:
        if not self.sobol or not scatter.causes:
            return {}, {}, []
        return sobol_indices(scatter, results, self.sobol, bench.part(self.name, 0.0, 1.0))


def asked_results(setup: Setup, of: str | tuple[str, ...], study: str) -> tuple[str, ...]:
    """Return the results that are named; else those that an objective is on, else all that are one number."""
    if of:
        return single_numbers(setup, of, study)
    scalar = scalar_results(setup)
    goals = [objective.result for objective in setup.model.objectives if not isinstance(objective, Vary)]
    return tuple(dict.fromkeys(name for name in goals if name in scalar)) or scalar


_Indices = dict[str, dict[str, float]]


def _sources(setup: Setup, named: tuple[str, ...], study: str) -> tuple[str, ...]:
    """Return what is varied: the names asked for, or whatever may be in error, or every number there is."""
    fields = setup.model.input_fields
    unknowns = [column for column, (active, _) in unknown_columns(setup).items() if active.effect.place != "reading"]
    numbers = [name for name, field in fields.items() if field.kind == "float"]
    known = [*numbers, *setup.conditions, *unknowns]
    for name in named:
        if name not in known:
            raise UsageError(f"study '{study}': '{name}' is no input that can vary.{near_miss(name, known)}")
    scattered = [name for tolerance in setup.model.tolerances.values() for name in tolerance.on]
    chosen = named or tuple(dict.fromkeys([*scattered, *unknowns])) or tuple(numbers)
    return tuple(name for name in chosen if (value := nominal_of(setup, name)) == value)


def _unit(setup: Setup, source: str) -> str:
    unknowns = unknown_columns(setup)
    return unknowns[source][1].unit if source in unknowns else setup.print_unit(source)


def _plain(exact: Mapping[str, Any], numeric: Mapping[str, Any]) -> dict[str, float]:
    return {source: float(value) for source, value in exact.items() if source in numeric}


def _shares(of: Mapping[str, Mapping[str, float]], scatter: Scatter) -> tuple[_Indices, dict[str, float]]:
    """Return the share of each source in the first-order variance, and the standard deviation, by result."""
    share: _Indices = {}
    sd: dict[str, float] = {}
    for result, by_source in of.items():
        variances = {source: float(value) for source, value in scatter.variances(by_source).items()}
        whole = sum(variances.values())
        share[result] = {source: value / whole for source, value in variances.items()} if whole > 0 else {}
        sd[result] = max(whole, 0.0) ** 0.5
    return share, sd


def _agreement(numeric: Mapping[str, Mapping[str, float]], exact: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """Return by result the largest difference of stated and numeric derivatives, over the largest derivative."""
    disagreement: dict[str, float] = {}
    for result, by_source in numeric.items():
        stated = _plain(exact.get(result, {}), by_source)
        if stated:
            largest = max(abs(value) for value in [*stated.values(), *by_source.values()])
            apart = max(abs(value - by_source[source]) for source, value in stated.items())
            disagreement[result] = apart / largest if largest else 0.0
    return disagreement


@dataclass(frozen=True, kw_only=True)
class Sensitivities(Outcome):
    """Derivatives in SI, shares of the first-order variance (0 where a spread is off), and Sobol indices where asked.

    ``derivatives[result][source]``, ``share[result][source]``, ``sd[result]``, ``sobol_first[result][source]``,
    ``sobol_total[result][source]``. ``agreement[result]``, where the model states derivatives: the largest difference
    from the numeric ones, over the largest derivative of that result. ``inputs`` are those of the run, as
    effects leave them. Sources that scatter together may have a negative share; those in ``still`` do not scatter,
    and those in ``coupled`` are correlated: each has half of what two of them add together.
    """

    name: str = "sensitivity"
    derivatives: Mapping[str, Mapping[str, float]]
    share: Mapping[str, Mapping[str, float]]
    sd: Mapping[str, float]
    sobol_first: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    sobol_total: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    agreement: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    inputs: Any = None
    still: frozenset[str] = frozenset()
    coupled: frozenset[str] = frozenset()

    def as_json(self) -> dict[str, Any]:
        """Return derivative, unit and share by result and source; what has no derivative is left out."""
        return {
            result: {source: entry for source in by_source if (entry := self._entry(result, source)) is not None}
            for result, by_source in self.derivatives.items()
        }

    def _entry(self, result: str, source: str) -> dict[str, Any] | None:
        unit, source_unit = self.units.get(result, ""), self.units.get(source, "")
        derivative = printed_step(self.derivatives[result][source], unit)
        if derivative is None:
            return None
        derivative *= unit_factor(difference_unit(source_unit))
        entry = {"derivative": derivative, "unit": per(unit, source_unit), "share": self.share[result][source]}
        if source in self.sobol_first.get(result, {}):
            entry["sobol_first"] = self.sobol_first[result][source]
            entry["sobol_total"] = self.sobol_total[result][source]
        return entry

    def blocks(self) -> Sequence[Block]:
        """Return, for every result, the sources ranked and a bar for each."""
        blocks: list[Block] = []
        for result in self.derivatives:
            ranked = self._ranked(result)
            if not ranked:
                continue
            blocks.append(self._table(result, ranked))
            sizes, label = self._sizes(result, ranked)
            if any(sizes.values()):
                caption = f"The {MOST_BARS} largest of {len(sizes)}." if len(sizes) > MOST_BARS else ""
                blocks.append(Drawing(f"What moves the {spoken(result)}", bars("", sizes, label), caption))
        return blocks

    def _ranked(self, result: str) -> list[str]:
        """Name the sources, the largest share of the variance first, then the largest derivative."""
        derivative, share = self.derivatives[result], self.share[result]
        finite = [source for source in derivative if derivative[source] == derivative[source]]
        return sorted(finite, key=lambda source: (-share[source], -abs(derivative[source])))

    def _sizes(self, result: str, ranked: Sequence[str]) -> tuple[dict[str, float], str]:
        """Return the length of each bar: what one standard deviation does, or where nothing scatters the derivative."""
        unit = difference_unit(self.units.get(result, ""))
        if self.sd[result] > 0:
            whole = self.sd[result] / unit_factor(unit)
            signed = {name: (1.0 if self.derivatives[result][name] >= 0 else -1.0) for name in ranked}
            sizes = {name: signed[name] * whole * max(self.share[result][name], 0.0) ** 0.5 for name in ranked}
            return sizes, f"change by one standard deviation, {unit_text(unit)}".rstrip(", ")
        entries = {name: self._entry(result, name) for name in ranked}
        return {name: entry["derivative"] for name, entry in entries.items() if entry}, "derivative, in printed units"

    def _table(self, result: str, ranked: Sequence[str]) -> Table:
        with_indices = result in self.sobol_first
        rows: list[list[Any]] = []
        for source in ranked:
            entry = self._entry(result, source)
            if entry is None:
                continue
            share = None if source in self.still else 100 * entry["share"]
            row = [source, entry["derivative"], unit_text(entry["unit"]), share]
            if with_indices:
                row += [entry.get("sobol_first"), entry.get("sobol_total")]
            rows.append(row)
        columns = ["source", "derivative", "unit", "share of variance"]
        extra = ["Sobol index, alone", "Sobol index, total"] if with_indices else []
        note = self._note(result)
        return Table(
            f"Sensitivity of the {spoken(result)}", columns + extra, rows, ("", "", "", "%", *("" for _ in extra)), note
        )

    def _note(self, result: str) -> str:
        unit = difference_unit(self.units.get(result, ""))
        words = []
        if self.sd[result] > 0:
            size = f"{self.sd[result] / unit_factor(unit):.4g} {unit_text(unit)}".strip()
            words.append(f"First-order standard deviation of all sources together: {size}.")
            if self.still & set(self.derivatives[result]):
                words.append("No share: the tolerance is off, the source does not scatter.")
        if self.coupled & set(self.derivatives[result]):
            words.append("Of what two correlated sources add to the variance together, each has half in its share.")
        if any(share < 0.0 for share in self.share[result].values()):
            words.append("A share below 0: the source scatters together with another, and takes away from its share.")
        if result in self.agreement:
            words.append(
                f"Stated and numeric derivatives differ by at most {self.agreement[result]:.1e} of the largest."
            )
        return " ".join(words)

    def warnings(self) -> Sequence[str]:
        """Say where stated and numeric derivatives disagree, and where there is no derivative."""
        disagree = [
            f"the stated derivatives of '{result}' differ from the numeric ones by {apart:.1e} of the largest; "
            "one of them is wrong"
            for result, apart in self.agreement.items()
            if not apart <= AGREES_TO
        ]
        return [f"study '{self.name}': {text}" for text in (*disagree, *self.remarks)]


# Sobol indices of the exact model under the real distributions: how much of the variance each source explains


ROWS = 2**14


class _Standard:
    """The standard normal distribution, as far as scipy asks for it."""

    def ppf(self, share: Any) -> Any:
        """Return the quantile; the outermost points of a Sobol sequence stay finite."""
        tiny = 2.0**-54
        return ndtri(np.clip(share, tiny, 1 - 2.0**-53))


def sobol_indices(
    scatter: Scatter, results: Sequence[str], samples: int, progress: StepProgress
) -> tuple[_Indices, _Indices, list[str]]:
    """Return first-order and total indices by result and source, and what is to be said of them.

    There are none, and a sentence says so, where sources scatter together or machines fail.
    """
    joint = _joint(scatter)
    if joint:
        return {}, {}, [f"no Sobol indices: they need independent sources, and {joint}"]
    sources = [column for cause in scatter.causes for column in cause.columns]
    dimensions = max(len(sources), 2)  # scipy wants two; one that nothing depends on does no harm
    reasons: dict[int, str] = {}
    run = 0

    def model(standard: Matrix) -> Matrix:
        """Run the machines in batches, and remember those that failed."""
        nonlocal run
        answers = np.empty((len(results), standard.shape[1]))
        for start in range(0, standard.shape[1], ROWS):
            part = np.ascontiguousarray(standard[: scatter.dimension, start : start + ROWS])
            rows, _ = standard_rows(scatter, part, results)
            answers[:, start : start + ROWS] = [rows.results[result] for result in results]
            reasons.update({run + row: text for row, text in rows.reasons.items()})
            run += part.shape[1]
            progress(run, samples * (dimensions + 2))
        return answers

    rng = np.random.default_rng(np.random.SeedSequence(scatter.setup.seed, spawn_key=(0x50B01,)))
    dists = [_Standard()] * dimensions
    indices = stats.sobol_indices(func=model, n=samples, dists=dists, rng=rng)
    if reasons:
        first_reason = next(iter(reasons.values()))
        return {}, {}, [f"no Sobol indices: {len(reasons)} machines failed, the first because {first_reason}"]
    first, total = (np.reshape(of, (len(results), dimensions)) for of in (indices.first_order, indices.total_order))
    return _by_name(results, sources, first), _by_name(results, sources, total), []


def _joint(scatter: Scatter) -> str:
    """Say which sources scatter together, or nothing."""
    joint = [cause.name for cause in scatter.causes if cause.mixing is not None]
    if joint:
        return f"those of {' and '.join(joint)} are not"
    if not scatter.pairs:
        return ""
    pair = scatter.pairs[0]
    more = f" (with {len(scatter.pairs) - 1} more of such pairs)" if len(scatter.pairs) > 1 else ""
    return f"'{pair.first}' and '{pair.second}' are correlated{more}; the shares of the variance count that in"


def _by_name(results: Sequence[str], sources: Sequence[str], values: Matrix) -> dict[str, dict[str, float]]:
    """Return indices by result and source; an input with two tolerances has the sum of both."""
    by_result: dict[str, dict[str, float]] = {}
    for index, result in enumerate(results):
        by_result[result] = {}
        for column, source in enumerate(sources):
            by_result[result][source] = by_result[result].get(source, 0.0) + float(values[index, column])
    return by_result
