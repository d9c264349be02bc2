"""A batch is what single calls give: every input, condition and effect argument alone and in random company."""

import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from truing import Kernel, Model
from truing.errors import InfeasibleError
from truing.evaluate import effect_column, evaluate
from truing.kernel import kernel_for
from truing.setup import Setup, SwitchedOn
from truing.testing.batches import Batch, compare, condition_values, input_values, is_row_by_row
from truing.testing.sources import amplitude, off_reference, shape
from truing.testing.subject import Subject
from truing.units import to_si

ROWS = 5
REACHES = (0.5, 0.2, 0.05, 0.01)  # of a value, by which a random point lies away from the defaults
MODEST, FULL = 60, 400  # random batches of a model
GUESTS = Path(__file__).parents[1] / "data"
FILES = [GUESTS / "pin_wear.py", GUESTS / "gear_record" / "__init__.py"]


def models() -> dict[str, Model[Any, Any]]:
    installed = {name: offer.model for name, offer in Kernel.installed().offers.items()}
    files = [offer.model for file in FILES for offer in kernel_for(f"file:{file}").offers.values()]
    return installed | {model.name: model for model in files}


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


def columns(subject: Subject, setup: Setup, rng: np.random.Generator) -> dict[str, Callable[[], list[Any]]]:
    """Return how each input, condition and unknown is drawn for a batch."""

    def number(name: str) -> list[Any]:
        item = subject.model.input_fields[name]
        if setup.nominal(name) != setup.nominal(name):
            return list(rng.choice(input_values(subject, name), ROWS))
        return [subject.near(item, float(rng.choice(REACHES)), rng) for _ in range(ROWS)]

    def choice(values: list[Any]) -> list[Any]:
        return [values[place] for place in rng.integers(len(values), size=ROWS)]

    found: dict[str, Callable[[], list[Any]]] = {}
    for name, item in subject.model.input_fields.items():
        if item.varies:
            found[name] = lambda name=name: number(name)
        elif len(values := input_values(subject, name)) > 1:
            found[name] = lambda values=values: choice(values)
    for on in setup.effects:
        for unknown in on.effect.unknowns:
            low, high = (to_si(bound, unknown.unit) for bound in (unknown.low, unknown.high))
            own = on.values[unknown.name]
            if unknown.is_amplitude:
                low, high = sorted((0.0, own))
            found[effect_column(on.effect.name, unknown.name)] = lambda low=low, high=high: list(
                rng.uniform(low, high, ROWS)
            )
        for need in on.effect.needs:
            found[need.name] = lambda need=need: list(
                rng.uniform(*sorted(condition_values(setup, need)[1:]), size=ROWS)
            )
    return found


def batches(subject: Subject, rng: np.random.Generator, count: int, *, alone: bool) -> Iterator[Batch]:
    """Random batches: some columns in company; with ``alone`` every column by itself at a random point, too."""
    for _ in range(count):
        setup = with_effects(off_reference(point(subject, rng)), rng, most=4)
        drawn = columns(subject, setup, rng)
        share = rng.random()
        some = [name for name in drawn if rng.random() < share] or list(drawn)[:1]
        yield Batch(setup, {name: drawn[name]() for name in some}, f"{', '.join(some)} vary")
        if alone:
            name = list(drawn)[int(rng.integers(len(drawn)))]
            yield Batch(setup, {name: drawn[name]()}, f"only '{name}' varies")


@pytest.mark.parametrize("name", MODELS)
def test_every_row_of_a_batch_is_its_own_calculation(name: str, full_torture: bool) -> None:
    subject = Subject(MODELS[name])
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    count = FULL if full_torture else MODEST
    if is_row_by_row(subject):
        count = count // 50 or 1  # the kernel calls such a function once per row anyway
    for batch in batches(subject, rng, count, alone=full_torture):
        compare(name, batch)
