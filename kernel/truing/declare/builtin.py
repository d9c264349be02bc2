"""The kernel's own effects on every model: what any gauge may do wrong, whatever it looks at.

All act on the reading, so a diagnosis finds them and no machine fails by them. Each has one part per result of the
function, so that every gauge is looked at alone; the unknown of a result carries the result's name. On a result along
an axis the same value acts everywhere. A model's own effect of the same name takes the place of the kernel's.

- ``sensor_offset``: reading + RESULT
- ``sensor_gain``: reading * (1 + RESULT), about the zero of the unit in which the result is declared
- ``sensor_drift``: reading + RESULT * time (of a condition: since its reference)
- ``thermal_drift``: reading + RESULT * (temperature - its reference)
- ``periodic_order``: reading + RESULT_sine * sin(RESULT_order * angle) + RESULT_cosine * cos(RESULT_order * angle)
- ``step``: reading + RESULT where time is at least RESULT_after

Time, temperature and angle are what the model has of the kind, else conditions of the kernel. Of several temperatures
or angles the first has the plain name, the others are ``thermal_drift_of_NAME`` and ``periodic_order_of_NAME``. An
input that is an angle and over which no study runs may turn or not (a helix angle does not): its wave is looked for
only in records that turn it round. So it is with an input in K, which may be a temperature or a socket for a rise: a
record that varies it says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from truing.declare.batch import column
from truing.declare.fields import Axis, Float, Given, ResultField, read, with_values
from truing.declare.sources import SINCE_START, Condition, Effect, Tolerance, Unknown
from truing.units import difference_unit, same_dimension, to_si
from truing.units.names import LEVELS, PURE

WIDE = 1e6
LONGEST = 1e6
"""Hours: how late a step may come."""
HIGHEST_ORDER = 3


@dataclass(frozen=True)
class _Kind:
    """One sort of effect: its unknowns of a result by role, and what they and what is seen add to a reading.

    In names and notes of ``unknowns`` {} is the result; units that begin with "difference" are its own. With
    ``is_from_zero`` what is seen counts from where its effects vanish. Nothing is seen but the reading itself where the
    effect is made for no time, temperature or angle.
    """

    name: str
    unknowns: Mapping[str, Unknown]
    added: Callable[[Mapping[str, Float], Float], Float]
    looks_like: str
    remedy: str
    why: str
    source: str
    is_from_zero: bool = False


@dataclass(frozen=True)
class BuiltinReading:
    """The function of an effect of the kernel: changes the results of which an unknown is stated, and no others.

    ``roles`` holds, for each result, what its unknowns are called; unknowns that are not stated are 0.
    """

    kind: _Kind
    roles: tuple[tuple[ResultField, Mapping[str, str]], ...]
    seen: Observed | None

    def __call__(self, inputs: Any, results: Any, **stated: Any) -> Any:
        """Return what the gauge reads, from SI numbers or arrays (n,)."""
        changed = {}
        for result, names in self.roles:
            own = {role: _met(stated[name], result) for role, name in names.items() if name in stated}
            if own:
                value = read(results, result.path)
                changed[result.path] = value + self.kind.added(
                    own, self._sight(value, result, (inputs, results, stated))
                )
        return with_values(results, changed)

    def _sight(self, value: Float, result: ResultField, held: tuple[Any, Any, Mapping[str, Float]]) -> Float:
        """Return what the effect looks at, SI: time, temperature or angle, else the reading from its zero."""
        if self.seen is None:
            zero = to_si(0.0, result.unit)  # 273.15 K for degC, 0 for all that are no levels
            return value - zero if zero else value
        observed = self.seen.of(*held, result)
        return observed - self.seen.zero if self.kind.is_from_zero and self.seen.zero else observed


def builtin_effects(model: Any) -> dict[str, Effect[Any, Any]]:
    """Return the kernel's effects on the readings of a ``Model``, by name, without those whose name it has taken."""
    results = [model.own_result_fields[name] for name in model.measurable]
    effects = [
        *_made(_OFFSET, results, [None]),
        *_made(_GAIN, results, [None]),
        *_made(_DRIFT, results, time_of(model)),
        *_made(_THERMAL, results, temperatures(model)),
        *_made(_ORDER, results, angles(model)),
        *_made(_STEP, results, time_of(model)),
    ]
    return {effect.name: effect for effect in effects if effect.name not in model.effects}


def may_stand(effect: Effect[Any, Any]) -> bool:
    """Whether an effect follows an input of which only a record can tell that it turns, or is a temperature."""
    reading = effect.function
    return isinstance(reading, BuiltinReading) and reading.seen is not None and reading.seen.may_stand


def _made(
    kind: _Kind, results: Sequence[ResultField], seen_by: Sequence[Observed | None]
) -> Iterator[Effect[Any, Any]]:
    """Make an effect for each quantity that is seen, over the results that can be set against it."""
    fitting = [(seen, [result for result in results if seen is None or seen.by(result)]) for seen in seen_by]
    for index, (seen, items) in enumerate((seen, items) for seen, items in fitting if items):
        unknowns = list(_named_apart(kind, items, seen))
        roles = tuple((result, {role: unknown.name for role, unknown in own.items()}) for result, own in unknowns)
        needs = [seen.condition] if seen is not None and seen.condition is not None else []
        yield Effect(
            f"{kind.name}_of_{seen.name}" if index and seen is not None else kind.name,
            on_reading=BuiltinReading(kind, roles, seen),
            unknowns=[unknown for _, own in unknowns for unknown in own.values()],
            parts=[[unknown.name for unknown in own.values()] for _, own in unknowns],
            needs=needs,
            reads=[seen.name] if seen is not None and not needs else [],
            looks_like=kind.looks_like.format(seen=seen.name if seen is not None else ""),
            remedy=kind.remedy,
            why=kind.why,
            source=kind.source,
        )


def _named_apart(
    kind: _Kind, items: Sequence[ResultField], seen: Observed | None
) -> Iterator[tuple[ResultField, dict[str, Unknown]]]:
    """Give the unknowns of each result, by role; a result whose unknowns have names that are taken has none.

    So it is with the step of a result ``depth_after`` beside that of ``depth``.
    """
    taken = {seen.name} if seen is not None else set()
    for result in items:
        own = {role: _of_result(unknown, result) for role, unknown in kind.unknowns.items()}
        names = {unknown.name for unknown in own.values()}
        if not names & taken:
            yield result, own
        taken |= names


def _met(value: Float, result: ResultField) -> Float:
    return column(value) if result.along else value


def _of_result(unknown: Unknown, result: ResultField) -> Unknown:
    """Return an unknown of a kind as it is called, and in which unit, for this result."""
    unit = unknown.unit
    if unit.startswith("difference"):
        own, per = difference_unit(result.unit), unit.removeprefix("difference")
        unit = f"1{per}" if per and own in PURE else f"{own}{per}"
    return replace(unknown, name=unknown.name.format(result.name), unit=unit, note=unknown.note.format(result.name))


def _constant(own: Mapping[str, Float], observed: Float) -> Float:
    return own["size"]


def _in_proportion(own: Mapping[str, Float], observed: Float) -> Float:
    return own["size"] * observed


def _wave(own: Mapping[str, Float], observed: Float) -> Float:
    turned = own["order"] * observed
    return own.get("sine", 0.0) * np.sin(turned) + own.get("cosine", 0.0) * np.cos(turned)


def _jump(own: Mapping[str, Float], observed: Float) -> Float:
    return own.get("size", 0.0) * np.where(observed >= own["after"], 1.0, 0.0)


def _size(unit: str, note: str, name: str = "{}") -> Unknown:
    return Unknown(name, -WIDE, WIDE, unit, note=note)


_SENSOR = "linear model of a gauge: gain, offset and drift"
_OFFSET = _Kind(
    "sensor_offset", {"size": _size("difference", "zero of the gauge of {}")}, _constant,
    "the same everywhere",
    "Set the zero of the gauge against a known reference; the constant error is gone then.",
    "the zero of the gauge is off", _SENSOR,
)  # fmt: skip
_GAIN = _Kind(
    "sensor_gain", {"size": Unknown("{}", -1, 1, note="of what the gauge of {} shows, too much")}, _in_proportion,
    "in proportion to what is measured",
    "Calibrate the gauge at several known values and correct its scale; the error in proportion is gone then.",
    "the gauge is scaled wrongly", _SENSOR,
)  # fmt: skip
_DRIFT = _Kind(
    "sensor_drift", {"size": _size("difference/h", "drift of the gauge of {}")}, _in_proportion,
    "grows steadily with {seen}",
    "Let the gauge settle, and set its zero again during the record; readings of one state then agree at any time.",
    "the zero of the gauge moves with time", _SENSOR, is_from_zero=True,
)  # fmt: skip
_THERMAL = _Kind(
    "thermal_drift", {"size": _size("difference/K", "drift of the gauge of {} with temperature")}, _in_proportion,
    "follows {seen}",
    "Keep gauge and holder at one temperature, or correct the reading; it then no longer follows the temperature.",
    "the gauge, or what holds it, moves with temperature",
    "temperature coefficient of a zero, linear", is_from_zero=True,
)  # fmt: skip
_ORDER = _Kind(
    "periodic_order",
    {
        "sine": _size("difference", "sine part of the wave on {}", "{}_sine"),
        "cosine": _size("difference", "cosine part of the wave on {}", "{}_cosine"),
        "order": Unknown("{}_order", 1, HIGHEST_ORDER, note="waves per turn", whole=True),
    },
    _wave, "a wave over {seen}, one to three times a turn",
    "Centre, straighten or replace what turns, in machine or gauge; the wave over the angle is gone then.",
    "something that turns is off its centre, bent or out of round", "Fourier orders of a rotation",
)  # fmt: skip
_STEP = _Kind(
    "step",
    {
        "size": _size("difference", "height of the step of {}"),
        "after": Unknown("{}_after", 0, LONGEST, "h", note="when the step comes", along="time"),
    },
    _jump, "a jump at one moment of {seen}, steady before and after",
    "Find and fasten what slipped or was touched, and set the zero again; readings before and after then agree.",
    "something slipped or was touched",
    "a step in the mean of a record",
)  # fmt: skip


# What the kernel's own effects look at: time, temperatures and angles of a model, or conditions of the kernel


TIME = Condition("time", "h", note="since the first row of the file", derived=SINCE_START)
TEMPERATURE = Condition("temperature", "degC", reference=20, note="where the gauge is", role="follows")
ANGLE = Condition("angle", "deg", note="of what turns")


@dataclass(frozen=True)
class Observed:
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

    def by(self, result: ResultField) -> bool:
        """Whether a result can be set against it, value by value."""
        return self.place in {"condition", "input"} or bool(self.axes & _axes_of(result))

    def of(self, inputs: Any, results: Any, conditions: Mapping[str, Float], result: ResultField) -> Float:
        """Return its values, SI, in a shape that meets this result."""
        if self.place in {"condition", "input"}:
            value = conditions[self.name] if self.place == "condition" else read(inputs, self.path)
            return column(value) if result.along else value
        return np.asarray(read(inputs if self.place == "series" else results, self.path), dtype=float)


def _axes_of(result: ResultField) -> set[str]:
    return {result.along, f"{result.along}_{result.scope}"} - {""}


def time_of(model: Any) -> list[Observed]:
    """Return the time: what the model calls so (condition, input or axis), else the kernel's condition.

    Nothing where the model calls something else by that name.
    """
    counted = [replace(seen, zero=0.0) for seen in _inputs(model, "h")]
    named = [*_conditions(model, "h"), *counted, *_result_axes(model, "h")]
    return [seen for seen in named if seen.name == TIME.name] or _own(model, TIME)


def temperatures(model: Any) -> list[Observed]:
    """Return the temperatures: conditions first, then inputs (about their default), else the kernel's condition.

    Of an input in a unit of differences (K: a temperature, or a rise) only a record can say that it is one.
    """
    numbers = [seen for seen in _inputs(model, "K") if seen.place == "input"]
    levels = [seen for seen in numbers if model.input_fields[seen.name].unit in LEVELS]
    known = [*_conditions(model, "K"), *levels] or _own(model, TEMPERATURE)
    return [*known, *(replace(seen, may_stand=True) for seen in numbers if seen not in levels)]


def angles(model: Any) -> list[Observed]:
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


def _own(model: Any, condition: Condition) -> list[Observed]:
    """Return a condition of the kernel, unless the model uses its name for something else."""
    if condition.name in {*model.conditions, *model.input_fields, *model.result_fields}:
        return []
    return [_condition(condition)]


def _condition(condition: Condition) -> Observed:
    return Observed(condition.name, "condition", zero=condition.zero, condition=condition)


def _conditions(model: Any, unit: str) -> Iterator[Observed]:
    return (_condition(condition) for condition in model.conditions.values() if _is_like(condition.unit, unit))


def _inputs(model: Any, unit: str) -> Iterator[Observed]:
    """Give the inputs of a dimension that are always given: numbers, and series along an axis."""
    for name, field in model.input_fields.items():
        if field.is_optional or not _is_like(field.unit, unit):
            continue
        if field.varies and isinstance(field.spec, Given):
            yield Observed(name, "input", field.path, zero=float(field.spec.initial()))
        elif field.kind == "series":
            yield Observed(name, "series", field.path, axes=frozenset({name, field.spec.along} - {""}))


def _result_axes(model: Any, unit: str) -> Iterator[Observed]:
    for name, result in model.own_result_fields.items():
        if isinstance(result.spec, Axis) and not result.spec.is_table and _is_like(result.unit, unit):
            yield Observed(name, "axis", result.path, axes=frozenset({name}))


def _is_like(unit: str, wanted: str) -> bool:
    return unit not in PURE and same_dimension(unit, wanted)
