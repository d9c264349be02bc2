"""Whether a batch is what single calls give: every input, condition and unknown varied alone, and all of them."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from truing.declare.fields import Axis, InputField
from truing.declare.sources import Condition, Unknown
from truing.declare.specs import Given
from truing.errors import PluginError
from truing.evaluate import Rows, evaluate_rows
from truing.setup import Setup, effect_column
from truing.testing.sources import off_reference, shape, switched
from truing.testing.subject import Subject, fail
from truing.units import to_si, unit_factor

ROUNDING = 2**12 * sys.float_info.epsilon
"""How far two ways of calculating one number may lie apart, in parts of it: 9.1e-13.

The vector path of a function of numpy differs from its scalar path by up to 4 units in the last place, and by another
one from processor to processor. A result is a chain of some hundred of them, on numbers of a condition of up to ten:
4 * 100 * 10, rounded up to a power of two. Where they lie farther apart it is measured what rounding does.
"""
ROWS = 7
FEW = 2
"""Of a model that the kernel calls row by row anyway."""
ALONE = 3
OPTIONAL = (1.0, 1e3, 1e6, 1e9)
"""Tried for an input that is not given, in its unit, where its bounds do not say what lies between them."""


@dataclass(frozen=True)
class Batch:
    """One batch: the setup, the columns that vary (one value per row each), and what is to be said of it.

    ``first`` is what the first row answers alone, where that is known.
    """

    setup: Setup
    columns: Mapping[str, Any]
    what: str
    first: Rows | None = None

    @property
    def rows(self) -> int:
        """How many rows it has."""
        return max(map(len, self.columns.values()), default=1)

    def alone(self, row: int) -> Rows:
        """Return what a row answers by itself."""
        if row == 0 and self.first is not None:
            return self.first
        return single(self.setup, {name: values[row] for name, values in self.columns.items()})


def single(setup: Setup, values: Mapping[str, Any]) -> Rows:
    """Return what one calculation answers, all its numbers being numbers."""
    return evaluate_rows(setup, values, 1, reading=True)


def batch_equals_loop(subject: Subject) -> None:
    """A batch is what single calls give, to rounding: each input, condition and unknown varied alone, then together."""
    batches = [together(subject)]
    if not is_row_by_row(subject):
        batches += [*_inputs_alone(subject), *_effects_alone(subject)]
    for batch in batches:
        compare(subject.model.name, batch)


def is_row_by_row(subject: Subject) -> bool:
    """Whether the kernel calls the function once per row anyway, because a table is made of unlike length."""
    specs = [item.spec for item in subject.model.own_result_fields.values()]
    return any(isinstance(spec, Axis) and spec.is_table for spec in specs)


def compare(name: str, batch: Batch) -> None:
    """Fail where a row of a batch is another one than the same row alone, or breaks another condition."""
    try:
        together = evaluate_rows(batch.setup, batch.columns, batch.rows, reading=True)
    except PluginError as error:
        fail(f"{name}: a batch in which {batch.what} fails as a whole: {error}")
    for row in range(batch.rows):
        alone = batch.alone(row)
        here, there = reason(together, row), reason(alone, 0)
        if here != there:
            fail(
                f"{name}: where {batch.what}, row {row} {f'fails in a batch ({here})' if here else 'is answered'} and "
                f"{f'fails alone ({there})' if there else 'is answered alone'}"
            )
        for result, values in together.results.items():
            inner = alone.results[result][0]
            outer = values[row][: len(inner)] if np.ndim(inner) else values[row]
            if _differs(outer, inner, values) and _differs(outer, inner, values, rounding(batch, row, result)):
                fail(
                    f"{name}: where {batch.what}, '{result}' of row {row} is {_short(outer)} in a batch and "
                    f"{_short(inner)} alone; write np.where, not if, on anything that may vary"
                )


def reason(rows: Rows, row: int) -> str:
    """Say why a row failed, or lacks results."""
    lacking = {name: why[row] for name, why in sorted(rows.absent.items()) if row in why}
    return rows.reasons.get(row) or "; ".join(f"no '{name}': {why}" for name, why in lacking.items())


def rounding(batch: Batch, row: int, result: str) -> Any:
    """Return how far rounding alone moves a result of a row: by the last digit of each of its numbers, in turn.

    So all that is calculated of it is rounded anew, by half a unit in the last place; the vector path of a function may
    be off by up to eight times that.
    """
    own = {name: values[row] for name, values in batch.columns.items()}
    fields = batch.setup.model.input_fields
    numbers = {name: batch.setup.nominal(name) for name, item in fields.items() if item.varies} | own
    before = batch.alone(row).results[result][0]
    total = np.zeros(np.shape(before))
    for name, value in numbers.items():
        if isinstance(value, float) and np.isfinite(value):
            after = single(batch.setup, {**own, name: float(np.nextafter(value, np.inf))}).results[result][0]
            total += np.nan_to_num(np.abs(after - before)) if np.shape(after) == np.shape(before) else 0.0
    return 8 * total


def _differs(here: Any, there: Any, values: np.ndarray[Any, Any], most: Any = 0.0) -> bool:
    """Tell whether numbers lie apart by more than rounding, and by more than ``most`` beyond that."""
    finite = np.abs(values[np.isfinite(values)])
    scale = np.maximum(np.abs(there), finite.max(initial=0.0))
    near = np.abs(here - there) <= ROUNDING * scale + most
    return not np.all(near | (np.isnan(here) & np.isnan(there)))


def _short(value: Any) -> str:
    return f"{float(value):.15g}" if not value.ndim else str(value)


def together(subject: Subject) -> Batch:
    """All Float inputs in one batch, at points that have an answer."""
    points = subject.points(FEW if is_row_by_row(subject) else ROWS)
    columns = {name: np.array([point[name] for point in points]) for name in subject.scattering}
    return Batch(subject.setup, columns, "all Float inputs vary")


def _inputs_alone(subject: Subject) -> Iterator[Batch]:
    first = single(subject.setup, {})
    for name in subject.model.input_fields:
        values = input_values(subject, name)
        if len(values) > 1:
            yield Batch(subject.setup, {name: values}, f"only '{name}' varies", first)


def input_values(subject: Subject, name: str) -> list[Any]:
    """Return values of an input, SI, its own first; one alone where no other can be thought of (a file, a series)."""
    item = subject.model.input_fields[name]
    own = subject.model.read_inputs(subject.setup.inputs)[name]
    if item.kind == "switch":
        return [own, not own]
    if item.kind == "choice" and isinstance(own, str):
        return [own, *(word for word in item.choices if word != own)][:ALONE]
    if item.kind == "integer":
        return [own, *(value for value in (own + 1, own - 1) if _is_within(item, value))]
    if not item.varies:
        return [own]
    others = [point[name] for point in subject.points(ROWS)][: ALONE - 1]
    return [own, *(others if own == own else optional_values(item))]


def _is_within(item: InputField, value: float) -> bool:
    spec = item.spec
    assert isinstance(spec, Given)
    return (spec.at_least is None or value >= spec.at_least) and (spec.at_most is None or value <= spec.at_most)


def optional_values(item: InputField) -> list[float]:
    """Return values of an input that is not given, SI: between its bounds where it has both, else of its unit."""
    spec = item.spec
    assert isinstance(spec, Given)
    low = spec.above if spec.above is not None else spec.at_least
    high = spec.below if spec.below is not None else spec.at_most
    if low is None or high is None:
        tried = [value for value in OPTIONAL if (low is None or value > low) and (high is None or value < high)]
        return [float(to_si(value, item.unit)) for value in tried]
    return [float(to_si(low + share * (high - low), item.unit)) for share in (1e-3, 0.5)]


def _effects_alone(subject: Subject) -> Iterator[Batch]:
    """Each effect on: its unknowns and conditions one by one, then these and all Float inputs together."""
    for effect in subject.model.effects.values():
        setup = switched(off_reference(subject.setup), effect)
        if setup is None:
            continue
        alone: dict[str, list[float]] = {
            effect_column(effect.name, unknown.name): unknown_values(setup, unknown) for unknown in effect.unknowns
        } | {need.name: condition_values(setup, need) for need in effect.needs}
        first = single(setup, {})
        for name, values in alone.items():
            yield Batch(setup, {name: values}, f"effect '{effect.name}' is on and only '{name}' varies", first)
        points = subject.points(ROWS)[:ALONE]
        inputs = {name: np.array([point[name] for point in points]) for name in subject.scattering}
        yield Batch(setup, {**inputs, **alone}, f"effect '{effect.name}' is on and all it knows varies")


def unknown_values(setup: Setup, unknown: Unknown) -> list[float]:
    """Return values of an unknown of the one effect that is on, SI, its own first: smaller ones, or other shapes."""
    own = setup.effects[0].values[unknown.name]
    return [own, *(share * own if unknown.is_amplitude else shape(unknown, share) for share in (0.0, 0.3))]


def condition_values(setup: Setup, need: Condition) -> list[float]:
    """Return values of a condition, SI, its own first, then its reference and one more within its range."""
    if need.low is None or need.high is None:
        other = need.zero - 3 * unit_factor(need.unit)
    else:
        other = float(to_si(need.low + 0.8 * (need.high - need.low), need.unit))
    return [float(setup.nominal(need.name)), need.zero, other]
