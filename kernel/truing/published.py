"""What the paper prints, beside what the calculation gives under the same settings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from truing.calculation import Calculation, calculate
from truing.declare.published import Published
from truing.errors import DeclarationError
from truing.inputs_file import setup_from_settings
from truing.kernel import Offer
from truing.setup import Setup
from truing.studies.bench import FINE, Progress, silent, within
from truing.units import from_si

TASK = "published numbers"
"""What the comparison is called while it is made."""


@dataclass(frozen=True)
class ComparedRow:
    """One printed number and ours in its unit; ``ratio`` is ours over the paper's, None where there is none.

    ``matches``: by the rule of its kind (``Published.agrees``). ``as_stated``: that is also what the plugin states.
    """

    published: Published
    value: float
    ratio: float | None
    matches: bool
    as_stated: bool


def compare_published(
    offer: Offer, *, progress: Progress = silent, known: Calculation | None = None
) -> list[ComparedRow]:
    """Compare the printed numbers of a model with its own, starting from its defaults.

    ``known`` is a calculation that was made already; it serves for the settings that it has, and for those that ask
    for a part of its studies. A model is compared once in a process: nothing that a user states changes the rows.
    """
    rows: list[ComparedRow] | None = offer.model.known.get("published")
    if rows is None:
        rows = offer.model.known["published"] = _compared(offer, progress, known)
    return rows


def _compared(offer: Offer, progress: Progress, known: Calculation | None) -> list[ComparedRow]:
    asked = {frozenset(printed.settings.items()): printed.settings for printed in offer.model.published}
    wanted = {key: setup_from_settings(offer, settings) for key, settings in asked.items()}
    done: dict[frozenset[tuple[str, str]], Calculation] = {}
    for key, setup in wanted.items():
        if known is not None and _covers(known.setup, setup) and same_run(known.setup, setup):
            done[key] = known
    missing = [key for key in wanted if key not in done]
    for count, key in enumerate(missing):
        names = [study.name for study in wanted[key].studies]
        begin, end = count / len(missing), (count + 1) / len(missing)
        progress(TASK, round(FINE * begin), FINE)
        done[key] = calculate(wanted[key], progress=within(progress, TASK, begin, end, names))
    return [compare_one(printed, done[frozenset(printed.settings.items())]) for printed in offer.model.published]


def _covers(known: Setup, wanted: Setup) -> bool:
    """Tell whether a run asked every study that is wanted, with the same options, in this order."""
    asked = [study for study in known.studies if study in wanted.studies]
    return asked == list(wanted.studies)


def compare_one(number: Published, calculation: Calculation) -> ComparedRow:
    """Compare one printed number with a calculation that was made under its settings."""
    fields = calculation.setup.model.result_fields
    if number.result not in fields:
        raise DeclarationError(f"the published number '{number.name}' names '{number.result}', which is no result")
    answer = calculation.answers.get(number.result, float("nan"))
    if getattr(answer, "ndim", 0):
        raise DeclarationError(
            f"the published number '{number.name}' names '{number.result}', which is no single number"
        )
    value = float(from_si(float(answer), number.unit))
    matches = number.agrees(value)
    ratio = value / number.value if number.value and math.isfinite(value) else None
    return ComparedRow(number, value, ratio, matches, matches == (number.verdict == "matches"))


def holds_for(setup: Setup, number: Published) -> bool:
    """Tell whether a run has just the settings that a printed number holds for, so that ours is its own result."""
    wanted = setup_from_settings(
        Offer(setup.model.name, setup.model, setup.origin, setup.source.added), number.settings
    )
    return same_run(setup, wanted)


def same_run(setup: Setup, wanted: Setup) -> bool:
    """Tell whether two setups describe the same machines: inputs, scatter, conditions; no effect that is on."""
    if setup.effects or wanted.effects or setup.conditions != wanted.conditions or setup.seed != wanted.seed:
        return False
    ours, theirs = setup.model.read_inputs(setup.inputs), setup.model.read_inputs(wanted.inputs)
    return all(_same(ours[name], theirs[name]) for name in theirs) and _same_scatter(setup, wanted)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, (int, float)):
        return math.isclose(one, other, rel_tol=1e-12) or (one != one and other != other)
    if getattr(one, "ndim", 0) or getattr(other, "ndim", 0):
        return bool(np.array_equal(one, other, equal_nan=True))
    return bool(one == other)


def _same_scatter(setup: Setup, wanted: Setup) -> bool:
    ours, theirs = setup.distributions(), wanted.distributions()
    if ours.keys() != theirs.keys() or _coupled(setup) != _coupled(wanted):
        return False
    return all(
        ours[name].keys() == theirs[name].keys()
        and all(math.isclose(ours[name][key].sd, theirs[name][key].sd, rel_tol=1e-9) for key in theirs[name])
        for name in theirs
    )


def _coupled(setup: Setup) -> dict[frozenset[str], float]:
    return {each.pair: each.coefficient for each in setup.scattering_together() if each.coefficient}


def parted(setup: Setup, rows: Sequence[ComparedRow]) -> tuple[list[ComparedRow], list[ComparedRow]]:
    """Part the rows into those that this run reproduces and those that hold for other settings."""
    settings = {frozenset(row.published.settings.items()): row.published for row in rows}
    own = {key for key, number in settings.items() if holds_for(setup, number)}
    parts: tuple[list[ComparedRow], list[ComparedRow]] = [], []
    for row in rows:
        parts[frozenset(row.published.settings.items()) not in own].append(row)
    return parts
