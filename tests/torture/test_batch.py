"""A batch is what single calls give: every input, condition and effect argument alone and in random company."""

import zlib
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from truing import Kernel, Model
from truing.errors import InfeasibleError
from truing.evaluate import evaluate
from truing.kernel import kernel_for
from truing.setup import Setup, SwitchedOn, effect_column
from truing.testing.running import Batch, compare, condition_values, input_values, is_row_by_row
from truing.testing.sources import amplitude, off_reference, shape
from truing.testing.subject import Subject
from truing.units import to_si

ROWS = 5
REACHES = (0.5, 0.2, 0.05, 0.01)  # of a value, by which a random point lies away from the defaults
MODEST, FULL = 1, 100  # random batches of a model
TESTS = Path(__file__).parents[1]


def models() -> dict[str, Model[Any, Any]]:
    """Return every model that is installed, and those of strangers."""
    offers = dict(Kernel.installed().offers)
    for file in (TESTS / "data" / "pin_wear.py", TESTS / "data" / "gear_record" / "gear_record.py"):
        offers |= kernel_for(f"file:{file}").offers
    with pytest.MonkeyPatch.context() as patched:
        patched.syspath_prepend(str(TESTS / "third_party" / "screw_joint"))
        offers |= Kernel([import_module("screw_joint")]).offers
    return {name: offer.model for name, offer in offers.items()}


MODELS = models()


def point(subject: Subject, rng: np.random.Generator) -> Setup:
    """Return the model with random inputs that it can answer."""
    for reach in REACHES:
        for _ in range(8):
            setup = subject.at({name: subject.near(item, reach, rng) for name, item in subject.scattering.items()})
            try:
                evaluate(setup)
            except InfeasibleError:
                continue
            return setup
    return subject.setup


def with_effects(setup: Setup, rng: np.random.Generator, most: int) -> Setup:
    """Switch on some effects, of any size that has an answer."""
    effects = list(setup.model.effects.values())
    for place in rng.permutation(len(effects))[: int(rng.integers(most + 1))]:
        size = 10 ** rng.uniform(-4, -0.3)
        values = {
            item.name: size * amplitude(item, 1.0) if item.is_amplitude else shape(item, float(rng.random()))
            for item in effects[place].unknowns
        }
        more = replace(setup, effects=(*setup.effects, SwitchedOn(effects[place], values)))
        try:
            evaluate(more, reading=True)
        except InfeasibleError:
            continue
        setup = more
    return setup


def drawn(subject: Subject, setup: Setup, rng: np.random.Generator) -> dict[str, list[Any]]:
    """Return a column of each input, and of each condition and unknown of the effects that are on."""
    columns: dict[str, list[Any]] = {}
    for name, item in subject.model.input_fields.items():
        values = input_values(subject, name)
        if item.varies and setup.nominal(name) == setup.nominal(name):
            columns[name] = [subject.near(item, float(rng.choice(REACHES)), rng) for _ in range(ROWS)]
        elif len(values) > 1:
            columns[name] = [values[place] for place in rng.integers(len(values), size=ROWS)]
    for on in setup.effects:
        for unknown in on.effect.unknowns:
            low, high = (float(to_si(bound, unknown.unit)) for bound in (unknown.low, unknown.high))
            if unknown.is_amplitude:
                low, high = sorted((0.0, on.values[unknown.name]))
            columns[effect_column(on.effect.name, unknown.name)] = list(rng.uniform(low, high, ROWS))
        for need in on.effect.needs:
            low, high = sorted(condition_values(setup, need)[1:])
            columns[need.name] = list(rng.uniform(low, high, ROWS))
    return columns


def batches(subject: Subject, rng: np.random.Generator, count: int, *, alone: bool) -> Iterator[Batch]:
    """Random batches: some columns in company; with ``alone`` every column by itself at a random point, too."""
    for _ in range(count):
        setup = with_effects(off_reference(point(subject, rng)), rng, most=4)
        columns = drawn(subject, setup, rng)
        share = rng.random()
        some = {name: values for name, values in columns.items() if rng.random() < share} or columns
        yield Batch(setup, some, f"{', '.join(some)} vary")
        if alone:
            name = list(columns)[int(rng.integers(len(columns)))]
            yield Batch(setup, {name: columns[name]}, f"only '{name}' varies")


@pytest.mark.parametrize("name", MODELS)
def test_every_row_of_a_batch_is_its_own_calculation(name: str, full_torture: bool) -> None:
    subject = Subject(MODELS[name])
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    count = FULL if full_torture else MODEST
    if is_row_by_row(subject):  # the kernel calls such a function once per row anyway
        count //= 50
    for batch in batches(subject, rng, count, alone=full_torture):
        compare(name, batch)
