"""Which quantity a name in a formula means: that of its own part first."""

from __future__ import annotations

from collections.abc import Mapping

from truing.declare.declared import Declared
from truing.declare.fields import InputField, ResultField


def formula_scope(model: Declared, item: ResultField) -> Mapping[str, InputField | ResultField]:
    """Return what each name means in the formula of ``item``: own part first, then the flat names.

    The function's results know each other; what a study gives knows the results of all studies besides.
    """
    own_result = item.name in model.own_result_fields
    known: dict[str, InputField | ResultField] = {
        **model.input_fields, **(model.own_result_fields if own_result else model.result_fields),
    }  # fmt: skip
    if not item.scope:
        return known
    ending = "_" + item.scope
    own = {name.removesuffix(ending): field for name, field in known.items() if name.endswith(ending)}
    return {**known, **own}
