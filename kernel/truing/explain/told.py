"""Everything there is to say of one name, as plain data: the terminal and ``--json`` are both written from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.explain import told_result, told_sources
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


# Which thing of a model a name means: a result, an input, an effect, a tolerance, a condition or a study


Topic: TypeAlias = Literal["result", "input", "effect", "tolerance", "condition", "study"]


SECTIONS: Mapping[str, Topic] = {
    "results": "result", "inputs": "input", "effects": "effect", "tolerances": "tolerance", "conditions": "condition",
    "studies": "study",
}  # fmt: skip
"""Words in front of a name that say which thing is meant, where one name has several."""


def known_names(model: Model[Any, Any]) -> Mapping[str, Topic]:
    """Return every name that can be explained and what it means; of two meanings the first in this order."""
    found: dict[str, Topic] = {}
    for kind, names in _by_kind(model).items():
        for name in names:
            found.setdefault(name, kind)
    return found


def _by_kind(model: Model[Any, Any]) -> dict[Topic, list[str]]:
    return {
        "result": list(model.result_fields),
        "input": list(model.input_fields),
        "effect": list(model.known_effects),
        "tolerance": list(model.tolerances),
        "condition": list(model.known_conditions),
        "study": [study.name for study in model.studies],
    }


def kind_of(model: Model[Any, Any], name: str) -> Topic:
    """Return what a name means, also behind the word of a section (``tolerances.load``).

    Raises UsageError, with what was probably meant, where nothing has it.
    """
    section, _, last = name.rpartition(".")
    if section in SECTIONS and last in _by_kind(model)[SECTIONS[section]]:
        return SECTIONS[section]
    known = known_names(model)
    if name in known:
        return known[name]
    if section in SECTIONS:
        name, known = last, dict.fromkeys(_by_kind(model)[SECTIONS[section]], SECTIONS[section])
    plain = name.strip().lower().replace(" ", "_").replace("-", "_")
    if plain in known:
        meant: str | None = plain
    else:
        words = near_miss(plain[:80], known)
        meant = words.split("'")[1] if words else None
    hint = f" Did you mean '{meant}' ({_described(model, meant, known[meant])})?" if meant else ""
    listed = "" if meant else f" `calc describe {model.name}` lists what there is."
    what = SECTIONS.get(section, "result, input, effect or tolerance")
    raise UsageError(f"{model.name} has no {what} '{name[:80]}'.{hint}{listed}")


def _described(model: Model[Any, Any], name: str, kind: Topic) -> str:
    item: Any = model.result_fields.get(name) or model.input_fields.get(name)
    note = item.spec.note if kind in {"result", "input"} and item is not None else ""
    return ", ".join(part for part in (kind, note) if part)
