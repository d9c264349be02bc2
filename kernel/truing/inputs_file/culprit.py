"""Which line is to blame when inputs that are well formed describe something impossible?"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from math import isclose
from typing import Any

from truing.errors import Fault, InfeasibleError, InputError
from truing.setup import Setup


@contextmanager
def told_by_line(setup: Setup) -> Iterator[None]:
    """Turn InfeasibleError into InputError that begins with the place of the input most likely to blame."""
    try:
        yield
    except InfeasibleError as error:
        raise InputError([located(setup, str(error))]) from error


def located(setup: Setup, sentence: str) -> Fault:
    """Return what is impossible as a fault at the place of the likeliest input.

    Likely is what is not at its default, then what the sentence names, then what came last: with ``--set``, or farther
    down in the file. Where nothing of this is stated it is the place where the inputs begin.
    """
    names = set(re.findall(r"\w+", sentence))
    changed = _changed(setup)
    stated = [name for name in setup.source.places if name]
    ranked = sorted(enumerate(stated), key=lambda item: (item[1] in changed, item[1] in names, item[0]))
    likeliest = ranked[-1][1] if ranked and (ranked[-1][1] in changed or ranked[-1][1] in names) else ""
    return Fault(sentence, *setup.source.places.get(likeliest, ("", None)))


def _changed(setup: Setup) -> set[str]:
    """Return the inputs, conditions and effects that are not as the model has them."""
    fields = setup.model.input_fields
    values = setup.model.read_inputs(setup.inputs)
    changed = {f"effects.{item.effect.name}" for item in setup.effects}
    known = setup.model.known_conditions
    changed |= {name for name, value in setup.conditions.items() if name in known and value != known[name].zero}
    for name in setup.source.places:
        if name in fields and not _is_default(fields[name].spec, values[name]):
            changed.add(name)
    return changed


def _is_default(spec: Any, value: Any) -> bool:
    default = spec.initial() if hasattr(spec, "initial") else None
    if isinstance(value, float) and isinstance(default, (int, float)):
        return isclose(value, default, rel_tol=1e-12) or (value != value and default != default)
    return getattr(value, "ndim", 0) == 0 and bool(value == default)
