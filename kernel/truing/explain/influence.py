"""What has to do with what: how a source moves a result, what an effect changes, what is made from what."""

from __future__ import annotations

import ast
import itertools
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from truing.declare.fields import Found
from truing.declare.model import Model, formula_scope
from truing.declare.sources import Condition, Effect, Unknown
from truing.errors import InfeasibleError, TruingError
from truing.evaluate import acting_inputs, evaluate
from truing.formulas import parse
from truing.formulas.tree import walk
from truing.setup import Setup, SwitchedOn
from truing.studies.bench import Progress, silent
from truing.studies.first_order import exact_slopes, nominal_of, slopes
from truing.studies.sampling import Scatter, scatter_of
from truing.units import difference_unit, to_si, unit_factor
from truing.units.names import LEVELS

PATIENCE = 20.0
"""So many seconds derivatives may take; what is not reached then is said."""
NOTHING = 1e-10
"""A source that moves a result by less than this share of it, when it changes by its own size, does not move it."""


@dataclass(frozen=True)
class Influence:
    """What one source does to one result; along an axis every number is a root mean square.

    ``step`` is the change of the result (SI) as the source grows by one per cent (a level of temperature by one kelvin;
    None for a source that is 0), ``relative`` the same as a share of the result (None where that is 0), ``share`` the
    part of the first-order variance of the result that is due to the scatter of the source.
    """

    source: str
    step: float | None
    relative: float | None
    share: float
    moves: bool


def differentiable(setup: Setup) -> list[str]:
    """Return the inputs and conditions that a result can be differentiated by: numbers that are given."""
    numbers = [name for name, field in setup.model.input_fields.items() if field.kind == "float"]
    return [name for name in (*numbers, *setup.conditions) if (value := nominal_of(setup, name)) == value]


def influences(
    setup: Setup, answers: Mapping[str, Any], sources: Sequence[str], *, progress: Progress = silent
) -> tuple[dict[str, list[Influence]], dict[str, float], list[str]]:
    """Differentiate results of the function (by name, with their values) by sources and by all that scatters.

    Returns what moves each result, the standard deviation (SI) of all that scatters by result, and what to know.
    """
    scatter = scatter_of(setup)
    columns = tuple(dict.fromkeys([*scatter.columns, *sources]))
    slopes_of, remarks = _slopes(setup, tuple(answers), columns, scatter=scatter, progress=progress)
    exact = exact_slopes(setup)
    of: dict[str, list[Influence]] = {}
    sd: dict[str, float] = {}
    for result, answer in answers.items():
        by_source = {**slopes_of[result], **{key: v for key, v in exact.get(result, {}).items() if key in columns}}
        variance = {name: _mean(value) for name, value in scatter.variances(by_source).items()}
        whole = sum(variance.values())
        size = _size(answer)
        sd[result] = max(whole, 0.0) ** 0.5
        share = {name: part / whole if whole > 0 else 0.0 for name, part in variance.items()}
        of[result] = [
            _influence(setup, scatter, name, by_source[name], size=size, share=share.get(name, 0.0)) for name in columns
        ]
    return of, sd, remarks


def _slopes(
    setup: Setup, results: Sequence[str], columns: Sequence[str], *, scatter: Scatter, progress: Progress
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Differentiate by one column after the other, as long as there is patience; NaN stands for what was not found."""
    of: dict[str, dict[str, Any]] = {result: dict.fromkeys(columns, math.nan) for result in results}
    remarks: list[str] = []
    ends = time.monotonic() + PATIENCE
    for index, column in enumerate(columns):
        progress("differentiating", index, len(columns))
        if time.monotonic() > ends:
            left = ", ".join(columns[index:])
            remarks.append(f"one calculation takes so long that these were not differentiated by: {left}")
            break
        try:
            derivatives = slopes(setup, results, [column], scatter)
        except TruingError as error:
            remarks.append(f"no derivative by '{column}': {error}")
            continue
        remarks += derivatives.warnings
        for result in results:
            of[result][column] = derivatives.of[result][column]
    return of, remarks


def _influence(setup: Setup, scatter: Scatter, name: str, slope: Any, *, size: float, share: float) -> Influence:
    value = nominal_of(setup, name)
    is_known = name in setup.model.input_fields or name in setup.model.known_conditions
    unit = setup.unit_of(name) if is_known else ""
    steepness = _size(slope) * (-1.0 if getattr(slope, "ndim", 0) == 0 and slope < 0 else 1.0)
    own = 1.0 if unit in LEVELS else 0.01 * abs(value)
    step = steepness * own if own and steepness == steepness else None
    relative = step / size if step is not None and size else None
    widest = max(abs(value), scatter.sd_of(name), 0.0 if value else unit_factor(difference_unit(unit)))
    moves = steepness == steepness and abs(steepness) * widest > NOTHING * size
    return Influence(name, step, relative, share, moves)


def _size(value: Any) -> float:
    """Return the size of a number, or the root mean square of an array, NaN where any part is none."""
    return math.sqrt(_mean(value * value))


def _mean(value: Any) -> float:
    if not getattr(value, "ndim", 0):
        return float(value)
    return float(value.mean()) if value.size else math.nan


# What an effect changes: the model is run with it, at a size it may have, beside the model without


SIZES = (0.5, 0.05, 0.005)
"""Shares of an amplitude's bound that are tried, until the calculation is possible."""
STEP = 10.0
"""How far from its reference a condition without a range is tried, in its unit."""
ROUNDING = 1e-12


@dataclass(frozen=True)
class Touched:
    """What changes when an effect is on: results by name with the relative change, and inputs before and after (SI).

    The change of a result that is 0 without the effect is infinite; along an axis it is the largest change over the
    largest value. ``at`` holds the unknowns and conditions of the trial, SI. None could be tried where it is empty.
    """

    at: Mapping[str, float]
    results: Mapping[str, float]
    inputs: Mapping[str, tuple[float, float]]


def touched(setup: Setup, effect: Effect[Any, Any]) -> Touched:
    """Try one effect alone, as it is where it is on, else at sizes within its bounds, its conditions off reference."""
    conditions = {need.name: _off_reference(setup, need) for need in effect.needs}
    bare = replace(setup, effects=(), conditions={**setup.conditions, **conditions})
    held = (dict(active.values) for active in setup.effects if active.effect.name == effect.name)
    tried = ({unknown.name: _tried(setup, unknown, size) for unknown in effect.unknowns} for size in SIZES)
    for values in itertools.chain(held, tried):
        acting = replace(bare, effects=(SwitchedOn(effect, values),))
        try:
            without, with_it = evaluate(bare, reading=True), evaluate(acting, reading=True)
        except InfeasibleError:
            continue
        read = setup.model.read_results
        changed = dict(_changed(read(without), read(with_it)))
        inputs = dict(_moved(bare, acting)) if effect.place == "inputs" else {}
        return Touched({**values, **conditions}, changed, inputs)
    return Touched({}, {}, {})


def _tried(setup: Setup, unknown: Unknown, size: float) -> float:
    """Return a value of an unknown: an amplitude at a share of its bound, a shape amid its bounds."""
    if unknown.is_amplitude:
        return float(to_si(size * (unknown.high or unknown.low), unknown.unit))
    if unknown.whole:
        return float(to_si(unknown.low, unknown.unit))
    if unknown.low > 0:
        return float(to_si((unknown.low * unknown.high) ** 0.5, unknown.unit))
    return float(to_si((unknown.low + unknown.high) / 2, unknown.unit))


def _off_reference(setup: Setup, need: Condition) -> float:
    """Return a value of a condition that is not its reference."""
    value = setup.conditions.get(need.name, need.zero)
    if value != need.zero:
        return float(value)
    for tried in (need.high, need.low):
        if tried is not None and tried != need.reference:
            return float(to_si(tried, need.unit))
    return float(to_si(need.reference + STEP, need.unit))


def _changed(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    for name, value in before.items():
        one, other = np.atleast_1d(np.asarray(value, dtype=float)), np.atleast_1d(np.asarray(after[name], dtype=float))
        if one.shape != other.shape:
            yield name, float("inf")
            continue
        difference = other - one
        step = float(difference[np.argmax(np.abs(difference))]) if one.size else 0.0
        size = float(np.abs(one).max()) if one.size else 0.0
        if abs(step) > ROUNDING * size:
            yield name, step / size if size else float("inf")


def _moved(bare: Setup, acting: Setup) -> Iterator[tuple[str, tuple[float, float]]]:
    model = bare.model
    before, after = model.read_inputs(bare.inputs), model.read_inputs(acting_inputs(acting))
    for name, field in model.input_fields.items():
        if field.varies and before[name] == before[name] and before[name] != after[name]:
            yield name, (float(before[name]), float(after[name]))


# Which result is made from what, as the declared formulas say, and which results follow from a name


def made_from(model: Model[Any, Any]) -> Mapping[str, tuple[str, ...]]:
    """Return, for every result with a formula, the inputs and results that it names, in the order of its text."""
    links: dict[str, tuple[str, ...]] = {}
    for name, field in model.result_fields.items():
        if not isinstance(field.spec, Found) or not field.spec.formula:
            continue
        formula = parse(field.spec.formula)
        scope = formula_scope(model, field)
        sides = [side for side in (formula.left, formula.right) if side is not None]
        written = [node.id for side in sides for node in walk(side) if isinstance(node, ast.Name)]
        names = dict.fromkeys(scope[word].name for word in written if word in scope)
        links[name] = tuple(other for other in names if other != name)
    return links


def following(links: Mapping[str, tuple[str, ...]], name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the results whose formulas name this one, and those that follow further down."""
    direct = [result for result, sources in links.items() if name in sources]
    found = list(direct)
    for last in found:  # which grows
        found += [result for result, sources in links.items() if last in sources and result not in {name, *found}]
    return tuple(direct), tuple(found[len(direct) :])


def chain(links: Mapping[str, tuple[str, ...]], name: str) -> Iterator[tuple[int, str, bool]]:
    """Yield what a result is made from, depth first down to the inputs: depth, name, whether it stood above already."""
    seen: set[str] = set()

    def below(result: str, depth: int) -> Iterator[tuple[int, str, bool]]:
        for source in links.get(result, ()):
            again = source in seen and source in links
            seen.add(source)
            yield depth, source, again
            if not again:
                yield from below(source, depth + 1)

    yield from below(name, 1)
