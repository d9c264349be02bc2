"""The checks of an inputs file, one per kind of entry: raw TOML value in, SI out, ValueError with one sentence."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from truing.declare.fields import InputField
from truing.declare.model import Model, Study
from truing.declare.near_miss import near_miss
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.declare.spreads import read_spread
from truing.errors import UnitError
from truing.inputs_file.study_options import options_of, read_option
from truing.inputs_file.values import InputsRead, SentenceError, ValueCheck, plain, read_input, read_number
from truing.units import demand_dimension, difference_unit, from_si, to_si, unit_factor
from truing.units.grammar import shown
from truing.units.names import PURE


def stored(path: str | tuple[str, ...], read: Callable[[Any], Any]) -> ValueCheck:
    """Make a check that keeps what ``read`` returns under ``path``."""
    key = (path,) if isinstance(path, str) else path

    def check(raw: Any, reading: InputsRead) -> Any:
        try:
            value = read(raw)
        except SentenceError as error:
            raise SentenceError(f"{key[-1]}: {error}") from None
        reading.values[key] = value
        return value

    return check


def text(raw: Any) -> str:
    """Take a text."""
    if not isinstance(raw, str):
        raise SentenceError("a text in quotation marks is expected")
    return raw


def head_text(raw: Any) -> str:
    """Take what stands in the head of the sheet: a text, a number or a date."""
    if isinstance(raw, (bool, list, dict)):
        raise SentenceError("a text in quotation marks is expected")
    return text(str(raw))


def seed(raw: Any) -> int:
    """Take a seed; zero is one."""
    if isinstance(raw, bool) or not isinstance(raw, int) or not 0 <= raw < 2**63:
        raise SentenceError("a whole number from 0 upwards is expected")
    return raw


def one_of(choices: Sequence[str]) -> Callable[[Any], str]:
    """Make a reader of one word out of several."""

    def read(raw: Any) -> str:
        if raw not in choices:
            meant = near_miss(raw[:80], choices) if isinstance(raw, str) else ""
            raise SentenceError(f"choose {', '.join(choices[:-1])} or {choices[-1]}.{meant}")
        return str(raw)

    return read


def of_input(key: tuple[str, str], field: InputField, raw: Any, reading: InputsRead) -> None:
    """Check an input, and keep its value under a key."""
    reading.values[key] = read_input(field, raw, reading)


def renamed(model: Model[Any, Any]) -> Mapping[str, str]:
    """Return old input names that keep answering: ``RENAMED = {"k_wear": "rate"}`` beside the model's function."""
    old_names = getattr(sys.modules.get(model.function.__module__), "RENAMED", {})
    return old_names if isinstance(old_names, dict) else {}


def of_tolerance(tolerance: Tolerance, raw: Any, reading: InputsRead) -> None:
    """Check and keep a tolerance; what it resolves to is checked when the nominals are known."""
    if not isinstance(raw, (str, dict)):
        raise SentenceError(f"{tolerance.name}: a tolerance is a text such as '±0.05 mm', 'sd 3 %', 'IT6' or 'off'")
    try:
        spread = read_spread(raw, tolerance.spread)
    except UnitError as error:
        raise SentenceError(f"{tolerance.name}: {error}") from None
    reading.values["tolerances", tolerance.name] = spread


def of_condition(condition: Condition, raw: Any, reading: InputsRead) -> None:
    """Check and keep a condition."""
    reading.values["conditions", condition.name] = read_number(condition.name, raw, condition.unit)


def of_unknown(effect: Effect[Any, Any], unknown: Unknown, raw: Any, reading: InputsRead) -> None:
    """Check and keep an unknown: "5 um" or {value = "5 um", sd = "0.3 um"}; its bounds must hold."""
    table = raw if isinstance(raw, dict) else {"value": raw}
    if "value" not in table or set(table) - {"value", "sd"}:
        raise SentenceError(f'{unknown.name} is written "value unit" or {{ value = "...", sd = "..." }}')
    value = read_number(unknown.name, table["value"], unknown.unit)
    _keep_within(unknown, value)
    key = ("effects", effect.name, unknown.name)
    reading.values[key] = value
    if "sd" in table:
        reading.values[(*key, "sd")] = _sd(unknown, table["sd"])


def _keep_within(unknown: Unknown, value: float) -> None:
    low, high = to_si(unknown.low, unknown.unit), to_si(unknown.high, unknown.unit)
    slack = 1e-9 * (high - low)
    if not low - slack <= value <= high + slack:
        unit = "" if unknown.unit in PURE else f" {unknown.unit}"
        here = f"{from_si(value, unknown.unit):.12g}{unit}"
        raise SentenceError(
            f"{unknown.name} is {here}; it must lie from {plain(unknown.low)} to {plain(unknown.high)}{unit}"
        )
    number = from_si(value, unknown.unit)
    if unknown.whole and abs(number - round(number)) > 1e-9 * max(1.0, abs(number)):
        raise SentenceError(f"{unknown.name} is {number:.12g}; it must be a whole number")


def _sd(unknown: Unknown, raw: Any) -> float:
    """Return a standard deviation in SI; that of a temperature level is a difference."""
    unit = difference_unit(unknown.unit)
    value = read_number(f"sd of {unknown.name}", raw, unit)
    if value < 0:
        raise SentenceError(f"sd of {unknown.name} is negative; a standard deviation is 0 or more")
    return value


def of_covariance(effect: Effect[Any, Any], raw: Any, reading: InputsRead) -> None:
    """Check and keep a covariance: a symmetric matrix over the unknowns that are given, in their declared units."""
    given = reading.stated.get(effect.name, frozenset()) if effect.parts else None
    unknowns = [unknown for unknown in effect.unknowns if given is None or unknown.name in given]
    size = len(unknowns)
    names = ", ".join(f"{unknown.name} [{unknown.unit or '1'}]" for unknown in unknowns)
    like = f"covariance is a list of {size} rows of {size} numbers, over {names}"
    if not isinstance(raw, list) or len(raw) != size or any(not _is_row(row, size) for row in raw):
        raise SentenceError(like)
    _keep_possible(raw)
    factors = [unit_factor(unknown.unit) for unknown in unknowns]
    rows = tuple(tuple(float(one) * factors[i] * factors[j] for j, one in enumerate(row)) for i, row in enumerate(raw))
    reading.values["effects", effect.name, "covariance"] = rows


def _is_row(row: Any, size: int) -> bool:
    return isinstance(row, list) and len(row) == size and all(_is_finite(one) for one in row)


def _is_finite(one: Any) -> bool:
    if isinstance(one, bool) or not isinstance(one, (int, float)):
        return False
    return abs(one) < 1e300 and math.isfinite(one)


def _keep_possible(rows: list[list[float]]) -> None:
    """Raise unless a matrix is symmetric and no combination of the unknowns has a negative variance."""
    matrix = np.array(rows, dtype=float)
    if (np.diag(matrix) < 0).any():
        raise SentenceError("covariance holds a negative variance on its diagonal")
    scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
    if (np.abs(matrix - matrix.T) > 1e-9 * scale).any():
        raise SentenceError("covariance is not symmetric")
    if (np.abs(matrix) > scale * (1 + 1e-9)).any():
        raise SentenceError("covariance holds a correlation beyond 1")
    scale[scale == 0] = 1.0
    if np.linalg.eigvalsh(matrix / scale).min() < -1e-8:
        raise SentenceError("covariance gives some combination of the unknowns a negative variance")


def of_run(names: Sequence[str], raw: Any, reading: InputsRead) -> None:
    """Check and keep the list of studies."""
    if not isinstance(raw, list) or not all(isinstance(name, str) for name in raw):
        raise SentenceError(f'run is a list of studies; write run = ["{names[0] if names else ""}"]')
    offered = f"studies of this model: {', '.join(names) or 'none'}"
    for index, name in enumerate(raw):
        if name not in names:
            raise SentenceError(f"run names {shown(name)}, which is no study.{near_miss(name[:80], names)} ({offered})")
        if name in raw[:index]:
            raise SentenceError(f"run names '{name}' twice")
    reading.values["studies", "run"] = tuple(raw)


def of_study(study: Study, raw: Any, reading: InputsRead) -> None:
    """Check and keep the options of a study; all that are wrong are said in one answer."""
    if not isinstance(raw, dict):
        raise SentenceError(f"[studies.{study.name}] is a section; write its options below it")
    options = options_of(study)
    for name, value in raw.items():
        key = ("studies", study.name, name)
        try:
            if name not in options:
                known = f" (options: {', '.join(options) or 'none'})"
                meant = near_miss(name[:80], options)
                raise SentenceError(f"study '{study.name}' has no option {shown(name)}.{meant}{known}")
            reading.values[key] = read_option(study, name, options[name], value)
        except ValueError as error:
            reading.faults.append((key, str(error)))


def of_unit(name: str, declared: str, raw: Any, reading: InputsRead) -> None:
    """Check and keep a unit in which something is printed."""
    try:
        demand_dimension(text(raw), declared)
    except (UnitError, SentenceError) as error:
        raise SentenceError(f"{name}: {error}") from None
    reading.values["units", name] = raw
