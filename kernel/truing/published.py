"""What the paper prints, beside what the calculation gives under the same settings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from truing.declare.published import Published
from truing.errors import DeclarationError
from truing.studies.bench import Progress, silent

if TYPE_CHECKING:
    from truing.calculation import Calculation
    from truing.declare.model import Model
    from truing.kernel import Offer
    from truing.setup import Setup

TOLERANCES = "tolerances."


@dataclass(frozen=True)
class ComparedRow:
    """One printed number and ours in its unit; ``ratio`` is ours over the paper's, None where there is none.

    ``matches``: the relative difference is at most ``published.agrees_to`` (the difference itself, where the paper
    prints 0). ``as_stated``: that is also what the plugin states of it.
    """

    published: Published
    value: float
    ratio: float | None
    matches: bool
    as_stated: bool


def compare(
    calculation_for: Callable[[Mapping[str, str]], Calculation], published: Iterable[Published]
) -> list[ComparedRow]:
    """Compare every printed number with ours; each distinct set of settings is calculated once."""
    done: dict[frozenset[tuple[str, str]], Calculation] = {}
    rows = []
    for item in published:
        key = frozenset(item.settings.items())
        if key not in done:
            done[key] = calculation_for(item.settings)
        rows.append(compare_one(item, done[key]))
    return rows


def compare_published(offer: Offer, *, progress: Progress = silent) -> list[ComparedRow]:
    """Compare the printed numbers of a model with its own, starting from its defaults."""
    from truing.calculation import calculate

    def calculation_for(settings: Mapping[str, str]) -> Calculation:
        setup = setup_with(offer.model, settings)
        return calculate(replace(setup, origin=offer.origin, added=offer.added), progress=progress)

    return compare(calculation_for, offer.model.published)


def compare_one(item: Published, calculation: Calculation) -> ComparedRow:
    """Compare one printed number with a calculation that was made under its settings."""
    from truing.units import from_si

    fields = calculation.setup.model.result_fields
    if item.result not in fields:
        raise DeclarationError(f"the published number '{item.name}' names '{item.result}', which is no result")
    answer = calculation.answers.get(item.result, float("nan"))
    if getattr(answer, "ndim", 0):
        raise DeclarationError(f"the published number '{item.name}' names '{item.result}', which is no single number")
    value = float(from_si(float(answer), item.unit))
    distance = abs(value - item.value)
    matches = distance <= item.agrees_to * (abs(item.value) or 1.0)
    ratio = value / item.value if item.value and math.isfinite(value) else None
    return ComparedRow(item, value, ratio, matches, matches == (item.verdict == "matches"))


def setup_with(model: Model[Any, Any], settings: Mapping[str, str]) -> Setup:
    """Return the model at its defaults with the settings of a printed number: inputs and ``tolerances.NAME``."""
    from truing.declare.spreads import read_spread
    from truing.setup import default_setup

    values = {name: text for name, text in settings.items() if not name.startswith(TOLERANCES)}
    setup = default_setup(model, **{name: _plain(model, name, text) for name, text in values.items()})
    spreads = dict(setup.spreads)
    for name, text in settings.items():
        if name.startswith(TOLERANCES):
            own = name.removeprefix(TOLERANCES)
            if own not in spreads:
                raise DeclarationError(f"published settings name the tolerance '{own}', which {model.name} does not have")
            spreads[own] = read_spread(text, spreads[own])
    return replace(setup, spreads=spreads)


def _plain(model: Model[Any, Any], name: str, text: str) -> Any:
    """Read what is no quantity: a switch or a whole number. Quantities keep their text, with its unit."""
    kind = model.input_fields[name].kind if name in model.input_fields else ""
    if kind == "switch":
        return str(text).lower() in {"true", "yes", "on", "1"}
    return int(text) if kind == "integer" else text


def holds_for(setup: Setup, item: Published) -> bool:
    """Tell whether a run has just the settings that a printed number holds for, so that ours is its own result."""
    wanted = setup_with(setup.model, item.settings)
    if setup.effects or setup.conditions != wanted.conditions:
        return False
    ours, theirs = setup.model.read_inputs(setup.inputs), setup.model.read_inputs(wanted.inputs)
    return all(_same(ours[name], theirs[name]) for name in theirs) and _same_scatter(setup, wanted)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, (int, float)):
        return math.isclose(one, other, rel_tol=1e-12) or (one != one and other != other)
    if getattr(one, "ndim", 0) or getattr(other, "ndim", 0):
        import numpy as np

        return bool(np.array_equal(one, other, equal_nan=True))
    return bool(one == other)


def _same_scatter(setup: Setup, wanted: Setup) -> bool:
    ours, theirs = setup.distributions(), wanted.distributions()
    if ours.keys() != theirs.keys():
        return False
    return all(
        ours[name].keys() == theirs[name].keys()
        and all(_close(ours[name][key].sd, theirs[name][key].sd) for key in theirs[name])
        for name in theirs
    )


def _close(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9)


def in_order(setup: Setup, rows: Sequence[ComparedRow]) -> tuple[list[ComparedRow], list[ComparedRow]]:
    """Part the rows into those that this run reproduces and those that hold for other settings."""
    own = [row for row in rows if holds_for(setup, row.published)]
    return own, [row for row in rows if row not in own]
