"""Checks of the function: batches, inputs left alone, finite answers, seeds, processes, derivatives, bounds."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from truing.declare.fields import InputField, with_values
from truing.declare.specs import Given
from truing.errors import InfeasibleError, TruingError
from truing.evaluate import Rows, evaluate, evaluate_rows
from truing.executors import in_order, open_executor
from truing.inputs_file import setup_from_settings
from truing.packed import Packed, pack, unpack
from truing.setup import Setup
from truing.studies.scatter import scatter_of
from truing.testing.batches import together
from truing.testing.subject import Subject, fail
from truing.units import read_quantity, to_si, unit_factor

SLOPE = 1e-6


def finite_at_defaults(subject: Subject) -> None:
    """The defaults give finite results."""
    if subject.obstacle:
        fail(f"{subject.model.name}: the defaults cannot be calculated: {subject.obstacle}")


def inputs_untouched(subject: Subject) -> None:
    """A call leaves the arrays it was given as they were."""
    batch = together(subject)
    columns = batch.columns
    before = {name: values.copy() for name, values in columns.items()}
    own = subject.model.read_inputs(subject.setup.inputs)
    series = {name: np.copy(value) for name, value in own.items() if isinstance(value, np.ndarray)}
    evaluate_rows(subject.setup, columns, batch.rows)
    after = {**own, **columns}
    for name, values in {**before, **series}.items():
        if not np.array_equal(values, after[name], equal_nan=True):
            fail(f"{subject.model.name}: the function writes to the input '{name}'; take a copy before changing it")


def seeds_decide(subject: Subject) -> None:
    """The same inputs give the same results, the same seed the same draws, and a tolerance leaves the others alone."""
    name = subject.model.name
    one, two = (subject.model.read_results(evaluate(subject.setup)) for _ in range(2))
    for result, value in one.items():
        if not np.array_equal(value, two[result], equal_nan=True):
            fail(f"{name}: '{result}' differs between two calls with the same inputs; randomness is handed in")
    first, again, other = (scatter_of(subject.setup).draw(seed, 0, 64) for seed in (0, 0, 1))
    for column, values in first.items():
        if not np.array_equal(values, again[column]):
            fail(f"{name}: '{column}' is drawn differently with the same seed; draw from the generator that is given")
        if np.array_equal(values, other[column]) and np.ptp(values):
            fail(f"{name}: '{column}' is drawn alike with another seed; draw from the generator that is given")


def serial_equals_parallel(subject: Subject) -> None:
    """A worker process computes the same numbers, bit for bit. Skipped where no process could find the model."""
    assert subject.home is not None
    setup = replace(subject.setup, origin=subject.home)
    jobs = [(pack(setup), batch) for batch in range(2)]
    with open_executor("processes:1") as executor:
        far = list(in_order(executor, _drawn_rows, jobs))
    for here, there in zip(map(_drawn_rows, jobs), far, strict=True):
        for name, values in here.results.items():
            if not np.array_equal(values, there.results[name], equal_nan=True):
                fail(f"{subject.model.name}: '{name}' is different in another process; avoid globals and set order")


def _drawn_rows(job: tuple[Packed, int]) -> Rows:
    packed, batch = job
    setup = unpack(packed)
    return evaluate_rows(setup, scatter_of(setup).draw(setup.seed, batch, 32), 32)


def derivatives_are_exact(subject: Subject) -> None:
    """Derivatives that the model states equal central differences of the function, to 1e-6."""
    if subject.model.derivatives is None:
        return
    for point in ({}, *subject.points(1)):
        setup = subject.at(point)
        for result, by_input in subject.model.derivatives(setup.inputs).items():
            for name, stated in by_input.items():
                _compare_slope(subject, setup, (result, name), float(stated))


def _compare_slope(subject: Subject, setup: Setup, pair: tuple[str, str], stated: float) -> None:
    result, name = pair
    if result not in subject.model.own_result_fields or name not in subject.scattering:
        fail(f"{subject.model.name}: derivatives() names '{result}' by '{name}', which is no result by an input")
    usual = float(subject.setup.nominal(name))  # an input that is 0 by default is no scale of itself where it is drawn
    reach = 0.1 * abs(usual) or unit_factor(subject.model.input_fields[name].unit)
    found = [_difference(setup, pair, reach * share) for share in (1.0, 0.1, 1e-2, 1e-3)]
    known = [slope for slope in found if slope is not None]
    if len(known) < 2:
        return
    nearest = min(known, key=lambda slope: abs(slope - stated))
    height = abs(float(subject.model.read_results(evaluate(setup))[result]))
    unsure = max(min(abs(one - other) for one, other in pairwise(known)), sys.float_info.epsilon * height / reach)
    if abs(nearest - stated) > SLOPE * abs(stated) + 3 * unsure:
        fail(
            f"{subject.model.name}: the derivative of '{result}' by '{name}' is stated as {stated:.9g}; "
            f"differences of the function give {nearest:.9g} (SI)"
        )


def _difference(setup: Setup, pair: tuple[str, str], step: float) -> float | None:
    """Return the central difference of fourth order, or None where a step is impossible."""
    result, name = pair
    values = float(setup.nominal(name)) + step * np.array([-2.0, -1.0, 1.0, 2.0])
    rows = evaluate_rows(setup, {name: values}, 4, wanted={result})
    if rows.failed.any():
        return None
    far_low, low, high, far_high = rows.results[result]
    return float((8 * (high - low) - (far_high - far_low)) / (12 * step))


def bounds_are_answered(subject: Subject) -> None:
    """What lies outside a bound is refused by name; what lies on an inclusive bound is calculated or told why not."""
    for name, item in subject.scattering.items():
        spec = item.spec
        assert isinstance(spec, Given)
        bounds: Mapping[str, float | None] = {
            "above": spec.above, "at least": spec.at_least, "below": spec.below, "at most": spec.at_most,
        }  # fmt: skip
        for word, bound in bounds.items():
            if bound is None:
                continue
            _refused(subject, name, word, _beyond(bound, word))
            if word in {"at least", "at most"}:
                _answered(subject, name, bound)


def _beyond(bound: float, word: str) -> float:
    """Return a value just outside; an exclusive bound is outside itself."""
    if word in {"above", "below"}:
        return bound
    step = max(abs(bound), 1.0) * 1e-3
    return bound - step if word == "at least" else bound + step


def _refused(subject: Subject, name: str, word: str, value: float) -> None:
    unit = subject.model.input_fields[name].unit
    try:
        setup_from_settings(subject.offer, {name: f"{value!r} {unit}".strip()})
    except TruingError as error:
        if name not in str(error) or not (word in str(error) or "absolute zero" in str(error)):
            fail(f"{subject.model.name}: {name} = {value:g} {unit} is refused with other words: {error}")
        return
    fail(f"{subject.model.name}: {name} = {value:g} {unit} is accepted, but it must be {word} its bound")


def _answered(subject: Subject, name: str, bound: float) -> None:
    unit = subject.model.input_fields[name].unit
    try:
        evaluate(subject.at({name: to_si(bound, unit)}))
    except InfeasibleError as error:
        if "is not finite" in str(error):
            fail(
                f"{subject.model.name}: with {name} = {bound:g} {unit}, which its bounds allow, {error}; "
                "exclude the bound (above, below) or state what must hold"
            )


# The check of numerical steps: halving one, or doubling a count, changes no result by more than it is declared to


POINTS = 2
ROUNDING = 1e-9


def steps_may_be_halved(subject: Subject) -> None:
    """Halving a numerical step, or doubling a count, changes no result by more than the sheet says of it."""
    for item in numerical(subject):
        for point in ({}, *subject.points(POINTS)):
            setup = subject.at(point)
            try:
                finer = halved(setup, item)
            except InfeasibleError as error:
                fail(f"{subject.model.name}: '{item.name}' is finer by a half, and the model refuses it: {error}")
            for sentence in moved(setup, finer, item):
                fail(f"{subject.model.name}: {sentence}; refuse what is too coarse (feasible), or say what it changes")


def numerical(subject: Subject) -> list[InputField]:
    """Return the inputs that are declared as numerical steps, tolerances or grids."""
    fields = subject.model.input_fields.values()
    return [item for item in fields if isinstance(item.spec, Given) and item.spec.halving is not None]


def halved(setup: Setup, item: InputField) -> Any:
    """Return the results with a numerical input made finer; raises InfeasibleError where the model refuses it."""
    value = setup.model.read_inputs(setup.inputs)[item.name]
    finer = value * 2 if item.is_count else value / 2
    return evaluate(replace(setup, inputs=with_values(setup.inputs, {item.path: finer})))


def moved(setup: Setup, finer: Any, item: InputField) -> Iterator[str]:
    """Say of every result that a finer step moves further than declared by how much it does."""
    spec, model = item.spec, setup.model
    assert isinstance(spec, Given)
    assert spec.halving is not None
    before, after = model.read_results(evaluate(setup)), model.read_results(finer)
    for name, value in before.items():
        there, here = np.asarray(value, dtype=float), np.asarray(after[name], dtype=float)
        size = np.max(np.abs(here), initial=0.0)
        most = spec.halving_but.get(name)
        limit = read_quantity(most, model.own_result_fields[name].unit) if most else spec.halving * size
        if there.shape != here.shape or np.any(np.abs(here - there) > limit + ROUNDING * size):
            numbers = "" if there.ndim or here.ndim else f" from {there:.6g} to {here:.6g} (SI)"
            yield f"a finer '{item.name}' moves '{name}'{numbers}: more than {most or f'{100 * spec.halving:g} %'}"
