"""What a model declares of several parts alike, such as sun and planet, said in one row."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from truing.declare.fields import InputField, ResultField
from truing.declare.model import Model, formula_scope
from truing.formulas import parse

_OWN = {"name", "symbol", "default", "note"}
"""What members of a family may have for themselves; all else that is said of them is the same."""


@dataclass(frozen=True)
class Family:
    """Inputs or results that differ by their part alone, as ``description`` says them; most have one member."""

    members: tuple[Mapping[str, Any], ...]
    note: str

    @property
    def first(self) -> Mapping[str, Any]:
        """The member that stands for all."""
        return self.members[0]

    @property
    def size(self) -> int:
        """How many members there are."""
        return len(self.members)

    def each(self, key: str) -> list[Any]:
        """Return what the members have under a key, each value once."""
        values: list[Any] = []
        for member in self.members:
            if member[key] not in values:
                values.append(member[key])
        return values


def families(model: Model[Any, Any], described: Iterable[Mapping[str, Any]]) -> list[Family]:
    """Put descriptions of inputs or results in families, each where its first member stands."""
    fields: dict[str, InputField | ResultField] = {**model.input_fields, **model.result_fields}
    known: dict[Any, list[Mapping[str, Any]]] = {}
    for item in described:
        field = fields[item["name"]]
        key = (field.path[-1], _note(field, item), _own_names(model, field)) if _part(field) else item["name"]
        known.setdefault((key, repr({name: item[name] for name in item if name not in _OWN})), []).append(item)
    return [
        Family(tuple(members), _note(fields[members[0]["name"]], members[0]) if members[1:] else members[0]["note"])
        for members in known.values()
    ]


def _part(field: InputField | ResultField) -> str:
    """Return the suffix of a field's part, without the line before it; nothing for a field of no part."""
    return field.name.removeprefix(field.path[-1]).removeprefix("_")


def _note(field: InputField | ResultField, item: Mapping[str, Any]) -> str:
    """Return a note without the name of the part, which stands behind it where several parts have the same."""
    note: str = item["note"]
    return note.removesuffix(f", {_part(field).replace('_', ' ')}") if _part(field) else note


def _own_names(model: Model[Any, Any], field: InputField | ResultField) -> frozenset[str]:
    """Return what the formula of a result takes from its own part: others differ from it by their index alone."""
    text = getattr(field.spec, "formula", "")
    if not text or isinstance(field, InputField):
        return frozenset()
    scope = formula_scope(model, field)
    return frozenset(name for name in parse(text).names if name in scope and scope[name].name != name)
