"""What the kernel's own effects look at: time, temperatures and angles of a model, or conditions of the kernel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from truing.declare.batch import column
from truing.declare.declared import Declared
from truing.declare.fields import InputField, ResultField, read
from truing.declare.sources import SINCE_START, Condition, Tolerance
from truing.declare.specs import Axis, Float
from truing.units import same_dimension
from truing.units.names import LEVELS, PURE

TIME = Condition("time", "h", note="since the first row of the file", derived=SINCE_START)
TEMPERATURE = Condition("temperature", "degC", reference=20, note="where the gauge is")
ANGLE = Condition("angle", "deg", note="of what turns")


@dataclass(frozen=True)
class Seen:
    """A quantity that an effect of the kernel looks at: a condition, an input, a series or an axis of the results.

    ``zero`` is where effects vanish, SI. A series or an axis is seen by results along one of ``axes`` alone. One
    ``may_stand`` where only a record can tell that it turns or warms: a helix angle or a socket for a rise does not.
    """

    name: str
    place: Literal["condition", "input", "series", "axis"]
    path: tuple[str, ...] = ()
    zero: float = 0.0
    condition: Condition | None = None
    axes: frozenset[str] = frozenset()
    may_stand: bool = False

    def by(self, item: ResultField) -> bool:
        """Whether a result can be set against it, value by value."""
        return self.place in {"condition", "input"} or bool(self.axes & _axes_of(item))

    def of(self, inputs: Any, results: Any, conditions: Mapping[str, Float], item: ResultField) -> Float:
        """Return its values, SI, in a shape that meets this result."""
        if self.place in {"condition", "input"}:
            value = conditions[self.name] if self.place == "condition" else read(inputs, self.path)
            return column(value) if item.along else value
        return np.asarray(read(inputs if self.place == "series" else results, self.path), dtype=float)


def _axes_of(item: ResultField) -> set[str]:
    return {item.along, f"{item.along}_{item.scope}"} - {""}


def time_of(model: Declared) -> list[Seen]:
    """Return the time: what the model calls so (condition, input or axis), else the kernel's condition.

    Nothing where the model calls something else by that name.
    """
    counted = [replace(seen, zero=0.0) for seen in _inputs(model, "h")]
    named = [*_conditions(model, "h"), *counted, *_result_axes(model, "h")]
    return [seen for seen in named if seen.name == TIME.name] or _own(model, TIME)


def temperatures(model: Declared) -> list[Seen]:
    """Return the temperatures: conditions first, then inputs (about their default), else the kernel's condition.

    Of an input in a unit of differences (K: a temperature, or a rise) only a record can say that it is one.
    """
    numbers = [seen for seen in _inputs(model, "K") if seen.place == "input"]
    levels = [seen for seen in numbers if model.input_fields[seen.name].unit in LEVELS]
    known = [*_conditions(model, "K"), *levels] or _own(model, TEMPERATURE)
    return [*known, *(replace(seen, may_stand=True) for seen in numbers if seen not in levels)]


def angles(model: Declared) -> list[Seen]:
    """Return the angles, the likeliest to turn first.

    That is what a study of the model runs over, then conditions, then series and axes of results; the kernel's
    condition where there is none. Of other inputs, on which no tolerance acts, only a record can say that they turn.
    """
    swept = [getattr(study, "over", "") for study in model.studies]
    held = {name for source in model.errors if isinstance(source, Tolerance) for name in source.on}
    inputs = list(_inputs(model, "deg"))
    conditions = list(_conditions(model, "deg"))
    first = [seen for name in swept for seen in (*inputs, *conditions) if seen.name == name]
    series = [seen for seen in inputs if seen.place == "series" and seen.name not in held]
    turning = [*first, *conditions, *series, *_result_axes(model, "deg")] or _own(model, ANGLE)
    known = {seen.name for seen in turning}
    free = [seen for seen in inputs if seen.place == "input" and seen.name not in {*held, *known}]
    return [*{seen.name: seen for seen in turning}.values(), *(replace(seen, may_stand=True) for seen in free)]


def _own(model: Declared, condition: Condition) -> list[Seen]:
    """Return a condition of the kernel, unless the model uses its name for something else."""
    if condition.name in {*model.conditions, *model.input_fields, *model.result_fields}:
        return []
    return [_condition(condition)]


def _condition(condition: Condition) -> Seen:
    return Seen(condition.name, "condition", zero=condition.zero, condition=condition)


def _conditions(model: Declared, unit: str) -> Iterator[Seen]:
    return (_condition(item) for item in model.conditions.values() if _is_like(item.unit, unit))


def _inputs(model: Declared, unit: str) -> Iterator[Seen]:
    """Give the inputs of a dimension that are always given: numbers, and series along an axis."""
    for name, item in model.input_fields.items():
        if item.is_optional or not _is_like(item.unit, unit):
            continue
        if item.varies:
            yield Seen(name, "input", item.path, zero=float(_default(item)))
        elif item.kind == "series":
            yield Seen(name, "series", item.path, axes=frozenset({name, item.spec.along} - {""}))


def _default(item: InputField) -> Any:
    initial = getattr(item.spec, "initial", None)
    return initial() if initial is not None else 0.0


def _result_axes(model: Declared, unit: str) -> Iterator[Seen]:
    for name, item in model.own_result_fields.items():
        if isinstance(item.spec, Axis) and not item.spec.is_table and _is_like(item.unit, unit):
            yield Seen(name, "axis", item.path, axes=frozenset({name}))


def _is_like(unit: str, wanted: str) -> bool:
    return unit not in PURE and same_dimension(unit, wanted)
