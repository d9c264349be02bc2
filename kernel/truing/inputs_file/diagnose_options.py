"""``[studies.diagnose]``: what is asked of a diagnosis, checked when the file is read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import UnitError
from truing.inputs_file.values import Reading, SentenceError, broken_bound, read_number, written
from truing.setup import DiagnoseOptions
from truing.units.grammar import shown

NAME = "diagnose"
Values = Mapping[tuple[str, ...], Any]


def of_diagnose(model: Model[Any, Any]) -> Callable[[Any, Reading], Any]:
    """Make the check of the section; all that is wrong is said in one answer."""
    readers = {"per_file": _per_file, "hold_out": _hold_out, "box": _box, "budget": _budget}

    def check(raw: Any, reading: Reading) -> Any:
        if not isinstance(raw, dict):
            raise SentenceError(f"[studies.{NAME}] is a section; write its options below it")
        for name, value in raw.items():
            key = ("studies", NAME, name)
            try:
                if name not in readers:
                    meant = near_miss(name[:80], readers)
                    known = f" (options: {', '.join(readers)})"
                    raise SentenceError(f"study '{NAME}' has no option {shown(name)}.{meant}{known}")
                reading.values[key] = readers[name](value, model)
            except ValueError as error:
                reading.faults.append((key, str(error)))
        return raw

    return check


def diagnose_options(model: Model[Any, Any], values: Values) -> DiagnoseOptions:
    """Return the options that were read, the others as they are by default; a study of that name has its own."""
    if any(study.name == NAME for study in model.studies):
        return DiagnoseOptions()
    return DiagnoseOptions(**{path[2]: value for path, value in values.items() if path[:2] == ("studies", NAME)})


def diagnose_schema(model: Model[Any, Any]) -> dict[str, Any]:
    """Return the schema of the section."""
    effects = list(model.known_effects)
    per_file = "Effects, single unknowns (effect.unknown) and inputs that every file has for itself."
    box = "Where an input or condition can be set, for the next measurement."
    budget = "How many calls of the model on all rows the search may make; 0 leaves it to how long one takes."
    words = "Rows that only judge, by a column of the data and the word it holds there."
    ranges = {
        name: {"type": "string", "examples": [f"0..10 {_unit(name, model)}".strip()]} for name in _settable(model)
    }
    hold_out = {"type": "string", "default": "", "examples": ["record = validation"], "description": words}
    names = {"type": "array", "items": {"type": "string"}, "default": [], "examples": [effects[:1]]}
    spans = {"type": "object", "properties": ranges, "additionalProperties": False}
    properties = {
        "per_file": {**names, "description": per_file},
        "hold_out": hold_out,
        "box": {**spans, "description": box},
        "budget": {"type": "integer", "minimum": 0, "default": 0, "examples": [1000], "description": budget},
    }
    about = "What is asked of a diagnosis."
    return {"type": "object", "properties": properties, "additionalProperties": False, "description": about}


def _settable(model: Model[Any, Any]) -> Iterator[str]:
    yield from (name for name, item in model.input_fields.items() if item.varies)
    yield from model.known_conditions


def _unit(name: str, model: Model[Any, Any]) -> str:
    item = model.input_fields.get(name)
    return item.unit if item is not None else model.known_conditions[name].unit


def _per_file(raw: Any, model: Model[Any, Any]) -> tuple[str, ...]:
    """Take names of effects, of single unknowns and of inputs."""
    if not isinstance(raw, list) or not all(isinstance(name, str) for name in raw):
        raise SentenceError(f"study '{NAME}': per_file = {written(raw)} is no list of names; write [\"sensor_offset\"]")
    effects = model.known_effects
    unknowns = [f"{name}.{unknown.name}" for name, effect in effects.items() for unknown in effect.unknowns]
    known = [*effects, *unknowns, *(name for name, item in model.input_fields.items() if item.varies)]
    for place, name in enumerate(raw):
        if name not in known:
            near = near_miss(name[:80], known)
            hint = near or f" (effects: {', '.join(effects) or 'none'})"
            raise SentenceError(
                f"study '{NAME}': per_file names {shown(name)}, which is no effect, unknown or number among the "
                f"inputs of {model.name}.{hint}"
            )
        if name in raw[:place]:
            raise SentenceError(f"study '{NAME}': per_file names '{name}' twice")
    return tuple(raw)


def _hold_out(raw: Any, _: Model[Any, Any]) -> str:
    """Take "column = word"; nothing holds no row out."""
    if not isinstance(raw, str):
        raise SentenceError(f"study '{NAME}': hold_out = {written(raw)} is no text; write \"record = validation\"")
    if raw.strip() and not all(DiagnoseOptions(hold_out=raw).held_out):
        raise SentenceError(
            f"study '{NAME}': hold_out = {shown(raw)} names no rows; write a column and the word it holds, "
            'such as "record = validation"'
        )
    return raw.strip()


def _budget(raw: Any, _: Model[Any, Any]) -> int:
    """Take a number of calls."""
    if not isinstance(raw, int) or isinstance(raw, bool) or raw < 0:
        raise SentenceError(f"study '{NAME}': budget = {written(raw)} is no number of calls; write budget = 1000")
    return raw


def _box(raw: Any, model: Model[Any, Any]) -> dict[str, tuple[float, float]]:
    """Take ranges of inputs and conditions, in SI."""
    if not isinstance(raw, dict):
        raise SentenceError(f"study '{NAME}': box = {written(raw)} is no table; write box = {{ NAME = \"0..10 kN\" }}")
    known = list(_settable(model))
    for name in raw:
        if name not in known:
            raise SentenceError(
                f"study '{NAME}': box names {shown(name)}, which is no condition and no number among the inputs of "
                f"{model.name}.{near_miss(name[:80], known)}"
            )
    return {name: _range(name, text, model) for name, text in raw.items()}


def _range(name: str, raw: Any, model: Model[Any, Any]) -> tuple[float, float]:
    """Return "low..high unit" in SI; the unit of the upper end holds for a lower one without."""
    from truing.units import split_quantity

    item = model.input_fields.get(name)
    unit = _unit(name, model)
    like = f'"0..10 {unit}"'.replace(' "', '"')
    ends = [end.strip() for end in raw.split("..")] if isinstance(raw, str) else []
    if len(ends) != 2 or not all(ends):
        raise SentenceError(f"study '{NAME}': box: {name} = {written(raw)} is no range; write {name} = {like}")
    try:
        common = split_quantity(ends[1]).unit
        ends = [end if split_quantity(end).unit else f"{end} {common}".strip() for end in ends]
        low, high = (read_number(name, end, unit) for end in ends)
    except (UnitError, SentenceError) as error:
        raise SentenceError(f"study '{NAME}': box: {error}") from None
    sentence = "" if item is None else broken_bound(item, low) or broken_bound(item, high)
    if sentence:
        raise SentenceError(f"study '{NAME}': box: {sentence}")
    if low >= high:
        raise SentenceError(f"study '{NAME}': box: {name} = {written(raw)} goes from its higher end; lower first")
    return low, high
