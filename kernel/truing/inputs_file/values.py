"""One value of an inputs file to SI: quantities, switches, choices, series, data files; and the bounds they keep."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from truing.declare.fields import Given, InputField, Loaded
from truing.declare.near_miss import near_miss
from truing.errors import TruingError, UnitError
from truing.inputs_file.files import digest_of
from truing.units import from_si, human_dimension, read_quantity, to_si
from truing.units.grammar import shown
from truing.units.names import PURE

SIGMA = "sigma_"
"""A column of this and the name of a result holds the standard deviation of its readings."""


class SentenceError(ValueError):
    """A whole sentence about a value, its name included."""


StatedValues = Mapping[tuple[str, ...], Any]
"""What an inputs file states, SI, by section and name."""


@dataclass
class InputsRead:
    """What was read so far: values in SI by section and name, data files with their hashes and their folder.

    ``stated`` holds the names that stand under each [effects.NAME].
    """

    folder: Path
    values: dict[tuple[str, ...], Any] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    tables: dict[str, dict[str, Any]] = field(default_factory=dict)
    stated: dict[str, frozenset[str]] = field(default_factory=dict)


@dataclass(frozen=True)
class FileEntry:
    """One name of a section: what reads its value, or raises ValueError with one sentence, and its JSON Schema."""

    read: Callable[[Any, InputsRead], Any]
    schema: Mapping[str, Any]
    is_required: bool = False


@dataclass(frozen=True)
class FileSection:
    """A table of an inputs file: what it holds, in words and by name; ``title`` names it in the JSON Schema.

    One whose names are not known beforehand has ``any_name``, which gives the entry of a name.
    """

    title: str
    words: str
    entries: Mapping[str, FileEntry | FileSection]
    any_name: Callable[[str], FileEntry] | None = None

    @property
    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the table."""
        properties = {name: entry.schema for name, entry in self.entries.items()}
        table = {"type": "object", "properties": properties, "additionalProperties": self.further}
        return {**table, "description": self.words}

    @property
    def further(self) -> Mapping[str, Any] | bool:
        """The JSON Schema of what stands under other names; False where nothing may."""
        return False if self.any_name is None else self.any_name("").schema


def read_input(input_field: InputField, raw: Any, reading: InputsRead) -> Any:
    """Return an input as the function sees it. Raises ValueError with one sentence."""
    if input_field.kind in {"float", "whole"}:
        value = read_number(input_field.name, raw, input_field.unit)
        keep_bounds(input_field, value)
        return value
    readers: dict[str, Callable[[InputField, Any], Any]] = {
        "switch": _switch, "integer": _integer, "choice": _choice, "text": _text, "series": _series,
    }  # fmt: skip
    if input_field.kind == "file":
        return _loaded(input_field, raw, reading)
    return readers[input_field.kind](input_field, raw)


def read_number(name: str, raw: Any, unit: str) -> float:
    """Return a quantity in SI; a bare number is one only where no unit is needed."""
    if isinstance(raw, str):
        try:
            return read_quantity(raw, unit)
        except UnitError as error:
            raise SentenceError(f"{name}: {error}") from None
    if isinstance(raw, bool) or not isinstance(raw, (int, float)):
        raise SentenceError(
            f"{name} = {written(raw)} is no {'number' if unit in PURE else 'quantity'}; write {_like(name, unit)}"
        )
    if isinstance(raw, int) and abs(raw) > 10**300:
        raise SentenceError(f"{name} is too large for a number")
    if not math.isfinite(raw):
        raise SentenceError(f"{name} is {raw}, which is not a finite number")
    if unit not in PURE:
        like = _like(name, unit, raw)
        raise SentenceError(f"{name} = {written(raw)} has no unit; it is {human_dimension(unit)}: write {like}")
    return float(raw)


def _like(name: str, unit: str, value: float = 1.0) -> str:
    return f"{name} = {plain(value)}" if unit in PURE else f'{name} = "{plain(value)} {unit}"'


def written(raw: Any) -> str:
    """Return a TOML value as the file shows it, shortened."""
    if isinstance(raw, bool):
        return str(raw).lower()
    if isinstance(raw, int):
        return str(raw) if abs(raw) < 10**30 else "a number of many digits"
    if isinstance(raw, (str, float)):
        return shown(raw) if isinstance(raw, str) else repr(raw)
    if isinstance(raw, (list, dict)):
        return "a list" if isinstance(raw, list) else "a table"
    return shown(str(raw))


def plain(value: float) -> str:
    """Write a number so that reading it again gives the same: 28, 0.36, 3e-08."""
    if isinstance(value, int):
        return str(value)
    value = float(value)
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def keep_bounds(input_field: InputField, value: float) -> None:
    """Raise with a sentence where a value in SI breaks a declared bound; NaN (not given) breaks none."""
    sentence = broken_bound(input_field, value)
    if sentence:
        raise SentenceError(sentence)


def broken_bound(input_field: InputField, value: float) -> str:
    """Return what to say of a value in SI that breaks a declared bound, or nothing."""
    demand, unit = broken_demand(input_field, value), input_field.unit
    return f"{input_field.name} is {_quantity(from_si(value, unit), unit)}; it {demand}" if demand else ""


def broken_demand(input_field: InputField, value: float) -> str:
    """Return what a value in SI must be and is not ("must be above 0 N"), or nothing."""
    spec = input_field.spec
    if not isinstance(spec, Given) or value != value:
        return ""
    unit = input_field.unit
    for words, bound, sign in (
        ("above", spec.above, 1),
        ("below", spec.below, -1),
        ("at least", spec.at_least, 1),
        ("at most", spec.at_most, -1),
    ):
        if bound is not None and _breaks(value, to_si(bound, unit), sign, strict=words in {"above", "below"}):
            return f"must be {words} {_quantity(bound, unit)}"
    number = from_si(value, unit)
    is_whole = not spec.whole or abs(number - round(number)) <= 1e-9 * max(1.0, abs(number))
    return "" if is_whole else "must be a whole number"


def _breaks(value: float, limit: float, sign: int, *, strict: bool) -> bool:
    """Whether a value lies on the wrong side of a limit; the limit itself may be missed by rounding only."""
    if strict:
        return sign * (value - limit) <= 0
    return sign * (value - limit) < 0 and not math.isclose(value, limit, rel_tol=1e-12)


def _quantity(value: float, unit: str) -> str:
    short = f"{value:.12g}"
    return short if unit in PURE else f"{short} {unit}"


def bounds_in_words(input_field: InputField, *, with_unit: bool = True) -> str:
    """Return the bounds of an input as a phrase, such as "above 0 m, at most 2 m"; nothing where there are none.

    Of a numerical step it says behind them what halving it changes.
    """
    spec = input_field.spec
    if not isinstance(spec, Given):
        return ""
    named = (("above", spec.above), ("below", spec.below), ("at least", spec.at_least), ("at most", spec.at_most))
    unit = input_field.unit if with_unit else ""
    words = [f"{word} {_quantity(bound, unit)}" for word, bound in named if bound is not None]
    bounds = ", ".join([*words, "whole number"] if spec.whole else words)
    return "; ".join(part for part in (bounds, halving_in_words(input_field)) if part)


def halving_in_words(input_field: InputField) -> str:
    """Say of a numerical step how much halving it (a count: doubling it) changes; nothing of any other input."""
    spec = input_field.spec
    if not isinstance(spec, Given) or spec.halving is None:
        return ""
    but = "".join(f"; {name} by at most {most}" for name, most in spec.halving_but.items())
    step = "doubling" if input_field.is_count else "halving"
    return f"numerical: {step} it changes no result by more than {100 * spec.halving:g} %{but}"


def _switch(input_field: InputField, raw: Any) -> bool:
    if not isinstance(raw, bool):
        raise SentenceError(
            f"{input_field.name} = {written(raw)} is no switch; "
            f"write {input_field.name} = true or {input_field.name} = false"
        )
    return raw


def _integer(input_field: InputField, raw: Any) -> int:
    whole = int(raw) if isinstance(raw, float) and raw.is_integer() else raw
    if isinstance(whole, bool) or not isinstance(whole, int):
        raise SentenceError(f"{input_field.name} = {written(raw)} is no whole number; write {input_field.name} = 3")
    if abs(whole) > 2**53:
        raise SentenceError(f"{input_field.name} is too large for a whole number")
    keep_bounds(input_field, whole)
    return whole


def _choice(input_field: InputField, raw: Any) -> Any:
    text = written(raw) if isinstance(raw, (bool, int)) else raw
    if not isinstance(text, str) or text not in input_field.choices:
        offered = " or ".join(f"'{choice}'" for choice in input_field.choices)
        meant = near_miss(text[:80], input_field.choices) if isinstance(text, str) else ""
        raise SentenceError(f"{input_field.name} = {written(raw)} is not offered; choose {offered}.{meant}")
    default = getattr(input_field.spec, "default", None)
    return int(text) if isinstance(default, int) and not isinstance(default, bool) else text


def _text(input_field: InputField, raw: Any) -> str:
    if not isinstance(raw, str):
        raise SentenceError(f'{input_field.name} = {written(raw)} is no text; write {input_field.name} = "..."')
    return raw


def _series(input_field: InputField, raw: Any) -> Any:
    """Read a list of quantities, or {values = [1, 2], unit = "um"}; an array along an axis, else a tuple."""
    unit = input_field.unit if input_field.spec.unit is not None else None
    given = raw
    if isinstance(raw, dict) and set(raw) == {"values", "unit"} and isinstance(raw["values"], list):
        given = [f"{plain(v)} {raw['unit']}" if is_number(v) else v for v in raw["values"]]
    if not isinstance(given, list) or not given:
        like = f'["1 {unit}", ...]' if unit else "[...]"
        raise SentenceError(f"{input_field.name} is a series; write {input_field.name} = {like}")
    if unit is None:
        return _plain_series(input_field, given)
    values = [read_number(f"{input_field.name}[{index}]", one, unit) for index, one in enumerate(given, start=1)]
    for value in values:
        keep_bounds(input_field, value)
    if not input_field.spec.along:
        return tuple(values)
    return np.array(values, dtype=float)


def is_number(value: Any) -> bool:
    """Whether a value of a file is a number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _plain_series(input_field: InputField, given: list[Any]) -> tuple[Any, ...]:
    """Read a list without units: every item of the kind that the default's items have."""
    default = getattr(input_field.spec, "default", None)
    kind = type(default[0]) if isinstance(default, (tuple, list)) and default else type(given[0])
    if kind is float and all(is_number(value) for value in given):
        return tuple(
            read_number(f"{input_field.name}[{index}]", value, "") for index, value in enumerate(given, start=1)
        )
    for index, value in enumerate(given, start=1):
        if type(value) is not kind:
            word = {int: "whole number", float: "number", str: "text", bool: "switch"}.get(kind, "value of its kind")
            raise SentenceError(f"{input_field.name}[{index}] = {written(value)} is no {word}")
    return tuple(given)


def _loaded(input_field: InputField, raw: Any, reading: InputsRead) -> Any:
    """Read a data file once, through the reader the input declares; remember its hash."""
    spec = input_field.spec
    assert isinstance(spec, Loaded)
    table: Mapping[str, Any] = {"file": raw} if isinstance(raw, str) else raw
    if not isinstance(table, dict) or not isinstance(table.get("file"), str) or not table["file"]:
        raise SentenceError(
            f'{input_field.name} is read from a data file; write {input_field.name} = {{ file = "data.txt" }}'
        )
    options = {key: value for key, value in table.items() if key != "file"}
    _check_options(input_field, spec.reader, options)
    path = reading.folder / table["file"]
    try:
        if not path.is_file():
            raise SentenceError(
                f"{input_field.name}: there is no file {shown(table['file'])} beside the inputs file ({path})"
            )
        reading.files[input_field.name] = digest_of(path)
        reading.tables[input_field.name] = {"file": str(path.absolute()), **options}
        return spec.reader(path, **options)
    except SentenceError:
        raise
    except (Exception, SystemExit) as error:  # whatever a reader says of a file is the user's to mend
        kind = "" if isinstance(error, (TruingError, ValueError, OSError)) else f"{type(error).__name__}: "
        words = getattr(error, "strerror", None) or str(error) or type(error).__name__
        raise SentenceError(f"{input_field.name}: {shown(table['file'])} cannot be read: {kind}{words}") from error


def _check_options(input_field: InputField, reader: Callable[..., Any], options: Mapping[str, Any]) -> None:
    parameters = list(inspect.signature(reader).parameters.values())[1:]
    named = [p for p in parameters if p.kind not in {p.VAR_KEYWORD, p.VAR_POSITIONAL}]
    known = ", ".join(parameter.name for parameter in named) or "none"
    strange = [name for name in options if name not in {parameter.name for parameter in named}]
    if strange and not any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        meant = near_miss(strange[0][:80], [parameter.name for parameter in named])
        raise SentenceError(
            f"{input_field.name}: the reader takes no {shown(strange[0])}; beside file it takes: {known}.{meant}"
        )
    missing = [p.name for p in named if p.default is p.empty and p.name not in options]
    if missing:
        like = f'{input_field.name} = {{ file = "...", {missing[0]} = ... }}'
        raise SentenceError(f"{input_field.name}: the reader needs {', '.join(missing)} too; write {like}")
