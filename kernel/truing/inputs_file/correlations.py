"""Inputs that scatter together, as a file states them: ``"a, b" = 0.7``, or a matrix over several names."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import combinations
from math import isnan
from typing import Any

import numpy as np

from truing.declare.correlations import Correlated, contradictions, in_force, pair_fault, scatter_fault
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.declare.spreads import ByChoice, Drawn, Off, Spread
from truing.errors import Fault
from truing.inputs_file.assemble import nominals_of, spreads_of
from truing.inputs_file.document import InputsDocument
from truing.inputs_file.values import FileEntry, InputsRead, SentenceError, StatedValues, is_number, written
from truing.units.grammar import shown

LIKE = '"first, second" = 0.7'
MOST = 1e9
"""A number beyond this is no slip in a correlation."""
SYMMETRIC = 1e-9
"""The two halves of a matrix may differ by this."""


def entry_of_pair(model: Model[Any, Any], name: str) -> FileEntry:
    """Return the entry of two or more names with a comma between them: a number for each pair, or a matrix."""
    number = {"type": "number", "exclusiveMinimum": -1, "exclusiveMaximum": 1}
    matrix = {"type": "array", "items": {"type": "array", "items": {"type": "number"}}}
    words = "By names with commas between them: the correlation of each two of them, or the matrix of all."
    return FileEntry(partial(_read, model, name), {"anyOf": [number, matrix], "description": words})


def _read(model: Model[Any, Any], key: str, raw: Any, _: InputsRead) -> tuple[Correlated, ...]:
    """Return the pairs that an entry states."""
    names = [name.strip() for name in key.split(",")]
    if len(names) < 2 or not all(names):
        raise SentenceError(f"{shown(key)}: a correlation is that of two inputs; write {LIKE}")
    faults = [fault for name in dict.fromkeys(names) if (fault := _unknown(model, name))]
    faults += [f"'{name}' is correlated with itself" for name in dict.fromkeys(names) if names.count(name) > 1]
    if faults:
        raise SentenceError("; ".join(faults))
    if isinstance(raw, list):
        return _of_matrix(names, raw)
    if not _is_plain(raw):
        raise SentenceError(f"{shown(key)} = {written(raw)} is no correlation; write a number such as {LIKE}")
    return _possible([(*pair, float(raw)) for pair in combinations(names, 2)])


def _is_plain(value: Any) -> bool:
    return is_number(value) and not abs(value) > MOST


def _unknown(model: Model[Any, Any], name: str) -> str:
    """Return why a name is none of an input that may scatter, or nothing."""
    scattering = {on for tolerance in model.tolerances.values() for on in tolerance.on}
    if name in scattering:
        return ""
    if name in model.tolerances:
        return f"'{name}' is a tolerance; name the inputs it is on: {', '.join(model.tolerances[name].on)}"
    field = model.input_fields.get(name)
    if field is not None and field.kind == "series":
        return f"'{name}' is a series; no tolerance is on its values, so they cannot be correlated"
    if field is not None or name in model.known_conditions:
        return f"'{name}' has no tolerance, so it does not scatter"
    return f"{model.name} has no input {shown(name)}.{near_miss(name[:80], sorted(scattering))}"


def _of_matrix(names: Sequence[str], raw: list[Any]) -> tuple[Correlated, ...]:
    size = len(names)
    rows = raw if len(raw) == size and all(isinstance(row, list) and len(row) == size for row in raw) else []
    if not rows or not all(_is_plain(one) for row in rows for one in row):
        raise SentenceError(f"the matrix of {', '.join(names)} is a list of {size} rows of {size} numbers")
    matrix = np.array(rows, dtype=float)
    for place, name in enumerate(names):
        if matrix[place, place] != 1:
            raise SentenceError(f"the matrix of {', '.join(names)} has {matrix[place, place]:g} for '{name}' with "
                                "itself; its diagonal is 1")  # fmt: skip
    for one, other in combinations(range(size), 2):
        if not abs(matrix[one, other] - matrix[other, one]) <= SYMMETRIC:
            raise SentenceError(
                f"the matrix is not symmetric: '{names[one]}' and '{names[other]}' have {matrix[one, other]:g} and "
                f"{matrix[other, one]:g}"
            )
    places = combinations(range(size), 2)
    return _possible([(names[one], names[other], float(matrix[one, other])) for one, other in places])


def _possible(pairs: Sequence[tuple[str, str, float]]) -> tuple[Correlated, ...]:
    """Return the pairs, or raise for those whose number is none of a correlation."""
    faults = [fault for pair in pairs if (fault := pair_fault(*pair))]
    if faults:
        raise SentenceError("; ".join(faults))
    return tuple(Correlated(*pair) for pair in pairs)


def correlation_faults(model: Model[Any, Any], document: InputsDocument, values: StatedValues) -> Iterator[Fault]:
    """Say which pairs are stated twice, which inputs do not scatter, and what cannot all be true."""
    by_pair: dict[frozenset[str], tuple[str, ...]] = {}
    stated: list[Correlated] = []
    for path, pairs in values.items():
        if path[0] != "correlations":
            continue
        for pair in pairs:
            if pair.pair in by_pair:
                yield document.fault(path, _twice(pair, by_pair[pair.pair], document))
                continue
            by_pair[pair.pair] = path
            stated.append(pair)
    if not stated:
        return
    still = _still(model, values)
    for pair in stated:
        faults = [still(name) for name in (pair.first, pair.second)] if pair.coefficient else []
        if any(faults):
            yield document.fault(by_pair[pair.pair], "; ".join(filter(None, faults)))
    known = [pair for pair in in_force(model.correlations, stated) if not any(map(still, pair.pair))]
    ordered = sorted(known, key=lambda pair: pair.pair in by_pair)  # what a file states comes last: it can be changed
    for contradiction in contradictions(ordered):
        path = by_pair.get(contradiction.blamed.pair, ("correlations",))
        yield document.fault(path, contradiction.text)


def _twice(pair: Correlated, first: tuple[str, ...], document: InputsDocument) -> str:
    place, line = document.place(first)
    where = f"line {line}" if line is not None else place
    return f"the correlation of '{pair.first}' and '{pair.second}' is stated twice (first in {where}); state it once"


def _branch(spread: Spread, nominals: Mapping[str, Any]) -> Spread:
    """Return a spread itself, or of one that follows a choice the branch that is chosen; off where there is none."""
    while isinstance(spread, ByChoice):
        spread = spread.spreads.get(str(nominals.get(spread.chooser)), Off())
    return spread


def _still(model: Model[Any, Any], values: StatedValues) -> Callable[[str], str]:
    """Return what says why an input does not scatter together with another, or nothing."""
    spreads, nominals = spreads_of(model, values), nominals_of(model, values)
    in_use = {name: _branch(spread, nominals) for name, spread in spreads.items()}

    def fault(name: str) -> str:
        nominal = nominals.get(name)
        if isinstance(nominal, float) and isnan(nominal):
            return f"'{name}' is not given, so it does not scatter"
        on = [each.name for each in model.tolerances.values() if name in each.on]
        return scatter_fault(
            name,
            [tolerance for tolerance in on if not isinstance(in_use[tolerance], Off)],
            lambda tolerance: isinstance(in_use[tolerance], Drawn),
        )

    return fault
