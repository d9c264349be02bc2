"""Everything there is to say of one name, as plain data: the terminal and ``--json`` are both written from it."""

from __future__ import annotations

from typing import Any

from truing.explain import told_result, told_sources
from truing.explain.names import kind_of
from truing.kernel import Offer
from truing.setup import Setup
from truing.studies.bench import Progress, silent


def told(setup: Setup, offer: Offer, name: str, *, progress: Progress = silent) -> dict[str, Any]:
    """Explain a result, an input, an effect, a tolerance, a condition or a study of a model, under one setup.

    Numbers are in the unit that stands beside them. Raises UsageError for a name that the model does not have, and
    what a run raises where the calculation is impossible.
    """
    model = setup.model
    kind = kind_of(model, name)
    name = name.rpartition(".")[2]
    head = {"model": offer.name, "title": model.title, "name": name, "kind": kind}
    if kind == "result":
        return {**head, **told_result.of_result(setup, offer, name, progress)}
    if kind == "study":
        return {**head, **told_sources.of_study(setup, name)}
    tell = {
        "input": told_sources.of_input,
        "effect": told_sources.of_effect,
        "tolerance": told_sources.of_tolerance,
        "condition": told_sources.of_condition,
    }[kind]
    return {**head, **tell(setup, name)}
