"""The check of numerical steps: halving one, or doubling a count, changes no result by more than it is declared to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from truing.declare.fields import InputField, with_values
from truing.declare.specs import Given
from truing.errors import InfeasibleError
from truing.evaluate import evaluate
from truing.setup import Setup
from truing.testing.subject import Subject, fail
from truing.units import read_quantity

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
