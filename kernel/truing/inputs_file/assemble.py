"""From checked values to a Setup: what depends on several entries is checked here, against the nominals."""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from truing.declare.correlations import Correlated, in_force
from truing.declare.fields import Given, InputField, make
from truing.declare.model import Model, Study
from truing.declare.sources import Effect, Unknown
from truing.declare.spreads import ByChoice, Drawn, Off, Spread, Target
from truing.errors import Fault, TruingError
from truing.inputs_file.document import InputsDocument
from truing.inputs_file.study_options import diagnose_options
from truing.inputs_file.values import InputsRead, StatedValues, plain
from truing.kernel import Offer
from truing.setup import DEFAULT_SEED, InputsSource, Setup, SheetOptions, SwitchedOn
from truing.units import split_quantity, unit_text
from truing.units.names import PURE


def nominals_of(model: Model[Any, Any], values: StatedValues) -> dict[str, Any]:
    """Return every input and condition in SI: as stated, else as declared; files without a default are left out."""
    nominals: dict[str, Any] = {name: condition.zero for name, condition in model.conditions.items()}
    for name, field in model.input_fields.items():
        if hasattr(field.spec, "initial"):
            nominals[name] = field.spec.initial()
        elif getattr(field.spec, "default", dataclasses.MISSING) is not dataclasses.MISSING:
            nominals[name] = field.spec.default
    for (section, name, *_), value in ((path, value) for path, value in values.items() if len(path) == 2):
        if section in {"inputs", "conditions"}:
            nominals[name] = value
    return nominals


def renamed(model: Model[Any, Any]) -> Mapping[str, str]:
    """Return old input names that keep answering: ``RENAMED = {"k_wear": "rate"}`` beside the model's function."""
    old_names = getattr(sys.modules.get(model.function.__module__), "RENAMED", {})
    return old_names if isinstance(old_names, dict) else {}


def take_old_names(offer: Offer, reading: InputsRead) -> Iterator[tuple[tuple[str, ...], str]]:
    """Move values under old names to the new ones; a name that is given both ways is a fault."""
    for old, new in renamed(offer.model).items():
        if ("inputs", old) not in reading.values or old in offer.model.input_fields:
            continue
        value = reading.values.pop(("inputs", old))
        if ("inputs", new) in reading.values:
            yield ("inputs", old), f"'{old}' is the old name of '{new}', which is given too; leave '{old}' out"
        reading.values.setdefault(("inputs", new), value)
        plugin, major = offer.origin.name, offer.origin.version.split(".")[0]
        until = f"{plugin} {int(major) + 1}.0" if major.isdigit() else f"the next major release of {plugin}"
        reading.values["warnings", old] = f"'{old}' is now called '{new}'; the old name goes with {until}"


def unexplained(model: Model[Any, Any], document: InputsDocument) -> Iterator[tuple[tuple[str, ...], str]]:
    """Say which inputs are stated without the one that tells what they mean."""
    section = document.data.get("inputs")
    stated = section if isinstance(section, dict) else {}
    for name, field in model.input_fields.items():
        other = field.spec.stated_with
        if name in stated and other and other not in stated:
            choices = model.input_fields[other].choices
            meant = f" ({', '.join(choices)})" if choices else ""
            yield ("inputs", name), f"{name} means nothing without {other}; state {other}{meant} beside it"


def spread_faults(model: Model[Any, Any], document: InputsDocument, values: StatedValues) -> Iterator[Fault]:
    """Resolve every tolerance against the nominals, so that a wrong unit or grade is known by its line."""
    nominals, spreads = nominals_of(model, values), spreads_of(model, values)
    for tolerance in model.tolerances.values():
        stated, spread = ("tolerances", tolerance.name) in values, spreads[tolerance.name]
        for name in tolerance.on:
            try:
                sentence = _unresolved(spread, name, model, nominals, stated=stated)
            except (TruingError, ValueError, KeyError) as error:
                sentence = str(error)
            if sentence:
                key = ("tolerances", tolerance.name) if stated else ("inputs", name)
                own = "" if sentence.startswith("'" + name) else f"{tolerance.name}: "
                yield document.fault(key, own + sentence if stated else f"tolerance '{tolerance.name}': {sentence}")
                break


def _unresolved(spread: Spread, name: str, model: Model[Any, Any], nominals: Mapping[str, Any], *, stated: bool) -> str:
    """Return why a spread does not resolve for one of its inputs, or nothing."""
    if name not in nominals:
        return ""
    nominal = float(nominals[name])
    if math.isnan(nominal):
        if not stated or isinstance(spread, Off):
            return ""
        taken = getattr(model.input_fields[name].spec, "taken", None) if name in model.input_fields else None
        if taken is not None:
            return f"'{name}' is taken from {taken.model} and scatters as that does; write \"off\" or leave it out"
        return f"'{name}' is not given, so it has no tolerance; state it or write \"off\""
    field = model.input_fields.get(name)
    unit = field.unit if field is not None else model.conditions[name].unit
    resolved = spread.resolve(Target(name, nominal, unit, nominals.__getitem__))
    if resolved is not None and not (math.isfinite(resolved.mean) and math.isfinite(resolved.sd)):
        return f"the tolerance of '{name}' is not finite"
    return ""


def spreads_of(model: Model[Any, Any], values: StatedValues) -> dict[str, Spread]:
    """Return the tolerances in force; one on inputs that are not given is off."""
    nominals = nominals_of(model, values)
    spreads: dict[str, Spread] = {}
    for tolerance in model.tolerances.values():
        stated = values.get(("tolerances", tolerance.name))
        values_on = [nominals.get(name) for name in tolerance.on]
        absent = all(isinstance(value, float) and math.isnan(value) for value in values_on)
        spreads[tolerance.name] = Off() if absent and stated is None else stated or tolerance.spread
    return spreads


def stated_correlations(values: StatedValues) -> list[Correlated]:
    """Return the correlations that a file states, pair by pair."""
    return [pair for path, pairs in values.items() if path[0] == "correlations" for pair in pairs]


def studies_of(
    model: Model[Any, Any], values: StatedValues, document: InputsDocument, faults: list[tuple[tuple[str, ...], str]]
) -> tuple[Study, ...]:
    """Return the studies that run, in order, with the options the file sets."""
    studies: dict[str, Study] = {}
    for study in model.studies:
        told = {**document.places, **values}  # in the order of the file, then what stands in one line
        paths = (path for path in told if path[:2] == ("studies", study.name) and path in values)
        options = {path[2]: values[path] for path in paths}
        studies[study.name], wrong = _with_options(study, options)
        named = f"study '{study.name}': "  # once, whether the study says it too or not
        for name, words in wrong.items():
            faults.append((("studies", study.name, name), named + words.removeprefix(named)))
    chosen = values.get(("studies", "run"))
    return tuple(studies.values()) if chosen is None else tuple(studies[name] for name in chosen if name in studies)


def _with_options(study: Study, options: Mapping[str, Any]) -> tuple[Study, dict[str, str]]:
    """Return the study with its options, and what it says against any of them, one by one and then together."""
    wrong: dict[str, str] = {}
    changed: Any = study
    for trial in [*({name: value} for name, value in options.items()), dict(options)]:
        try:
            changed = dataclasses.replace(study, **trial) if trial else study  # type: ignore[type-var]
        except (TruingError, ValueError, TypeError) as error:
            if len(trial) == 1 or not wrong:
                wrong[next(iter(trial))] = str(error)
    return (study if wrong else changed), wrong


OF_THE_SHEET = ("detail", "paper", "units", "language")
"""What [sheet] says besides the texts of its head."""


def make_setup(offer: Offer, reading: InputsRead, studies: tuple[Study, ...], document: InputsDocument) -> Setup:
    """Put the checked values together."""
    model, values = offer.model, reading.values
    fields: Mapping[str, InputField] = model.input_fields
    stated = {path: value for path, value in values.items() if len(path) == 2}
    inputs = {fields[name].path: value for (section, name), value in stated.items() if section == "inputs"}
    effects = effects_of(model, values)

    def of(section: str) -> dict[str, Any]:
        return {path[1]: value for path, value in stated.items() if path[0] == section}

    head = {key: value for key, value in of("sheet").items() if value}
    names = [path[1] if path[0] != "tolerances" else ".".join(path) for path in stated if path[0] in _STATED]
    return Setup(
        model=model,
        origin=offer.origin,
        inputs=make(model.input_type, inputs),
        spreads=spreads_of(model, values),
        correlations=in_force(model.correlations, stated_correlations(values)),
        conditions=_conditions_in_force(model, values, effects),
        effects=effects,
        calibrated=of("calibrated"),
        studies=studies,
        seed=values.get(("studies", "seed"), DEFAULT_SEED),
        diagnose=diagnose_options(model, values),
        units=of("units"),
        columns=of("columns"),
        sheet=SheetOptions(**{name: head.pop(name) for name in OF_THE_SHEET if name in head}, head=head),
        source=InputsSource(
            stated=frozenset(names),
            file=document.file,
            files=dict(reading.files),
            tables=dict(reading.tables),
            added=offer.added,
            warnings=tuple(of("warnings").values()),
            places=places_of(model, document),
            units=stated_units(model, document),
        ),
    )


def stated_units(model: Model[Any, Any], document: InputsDocument) -> dict[str, str]:
    """Return the unit of each input and condition that is stated in another one than is declared.

    A series whose values have several units has none.
    """
    old = renamed(model)
    declared = {name: field.unit for name, field in model.input_fields.items() if _has_unit(field)}
    declared |= {name: condition.unit for name, condition in model.known_conditions.items() if name not in declared}
    units: dict[str, str] = {}
    for section in ("inputs", "conditions"):
        entries = document.data.get(section)
        for key, raw in entries.items() if isinstance(entries, dict) else ():
            name = old.get(key, key)
            unit = _unit_of(raw) if name in declared else ""
            if unit and unit_text(unit) != unit_text(declared[name]):
                units[name] = unit
    return units


def _has_unit(field: InputField) -> bool:
    return isinstance(field.spec, Given) and field.spec.unit is not None and field.kind in {"float", "whole", "series"}


def _unit_of(raw: Any) -> str:
    """Return the unit of a quantity of the file, or the one that all of a list have."""
    if isinstance(raw, dict):
        return raw["unit"] if isinstance(raw.get("unit"), str) else ""
    if isinstance(raw, list):
        units = {_unit_of(each) for each in raw}
        return units.pop() if len(units) == 1 else ""
    return split_quantity(raw).unit if isinstance(raw, str) and raw.strip() else ""


def _conditions_in_force(
    model: Model[Any, Any], values: StatedValues, effects: Sequence[SwitchedOn]
) -> dict[str, float]:
    """Return the model's own conditions in SI, and of the kernel's those that are stated or that an effect needs."""
    zeros = {name: condition.zero for name, condition in model.conditions.items()}
    zeros |= {need.name: need.zero for active in effects for need in active.effect.needs if need.name not in zeros}
    stated = {path[1]: float(value) for path, value in values.items() if len(path) == 2 and path[0] == "conditions"}
    return {**zeros, **stated}


def places_of(model: Model[Any, Any], document: InputsDocument) -> dict[str, tuple[str, int | None]]:
    """Return where each input, condition, effect and option of a diagnosis is stated; "" is the section of inputs."""
    old = renamed(model)
    places = {"": document.places.get(("inputs",)) or document.places.get((), (document.file, None))}
    for path, source_line in document.places.items():
        if len(path) == 2 and path[0] in {"inputs", "conditions", "effects", "calibrated"}:
            places[f"effects.{path[1]}" if path[0] == "effects" else old.get(path[1], path[1])] = source_line
        elif len(path) == 3 and path[:2] == ("studies", "diagnose"):
            places[".".join(path)] = source_line
    return places


_STATED = {"inputs", "conditions", "tolerances"}


# Declared values as an inputs file writes them


def default_of(field: InputField) -> Any:
    """Return the default of an input as a TOML value ("120 N", true, "a word"), or None where it has none."""
    default: Any = field.spec.default
    if not isinstance(field.spec, Given):
        return None
    return None if default is None else _stated(default, field)


def _stated(value: Any, field: InputField) -> Any:
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, (int, float)):
        if field.kind == "choice":
            return str(value)
        return value if field.unit in PURE else f"{plain(value)} {field.unit}"
    return [_stated(one.item() if hasattr(one, "item") else one, field) for one in value]


def spread_text(spread: Spread, choose: Mapping[str, Any] | None = None) -> str:
    """Return a spread as a file writes it; of one that follows a choice the chosen branch; nothing for a function."""
    if isinstance(spread, Drawn):
        return ""
    if isinstance(spread, ByChoice):
        branch = (choose or {}).get(spread.chooser)
        return spread_text(spread.chosen(str(branch))) if branch is not None else ""
    return spread.text


def toml_value(value: Any) -> str:
    """Write a value as TOML: texts quoted, numbers so that they read back the same."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{toml_key(key)} = {toml_value(one)}" for key, one in value.items()) + " }"
    return "[" + ", ".join(toml_value(one) for one in value) + "]"


def toml_key(name: str) -> str:
    """Write a name as a TOML key, quoted where it must be."""
    plain_key = bool(name) and all(
        character.isascii() and (character.isalnum() or character in "_-") for character in name
    )
    return name if plain_key else _quoted(name)


def _quoted(text: str) -> str:
    escapes = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    return '"' + "".join(escapes.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in text) + '"'


# Which effects an inputs file switches on, with all unknowns or, of an effect with parts, with some


MOST_NAMED = 4


def names_stated(data: Mapping[str, Any]) -> dict[str, frozenset[str]]:
    """Return what stands under each [effects.NAME], readable or not."""
    effects = data.get("effects")
    tables = effects if isinstance(effects, dict) else {}
    return {name: frozenset(table) for name, table in tables.items() if isinstance(table, dict)}


def part_faults(model: Model[Any, Any], stated: Mapping[str, frozenset[str]]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Say which effects with parts are on without any of them, and which parts are not stated whole."""
    for name, names in stated.items():
        effect = model.known_effects.get(name)
        if effect is None or not effect.parts:
            continue
        if not names - {"covariance"}:
            yield ("effects", name), f"effect '{name}' is on, but none of its unknowns is given: {_some(effect)}"
        for part in effect.groups():
            sentence = _unfinished(part, names)
            if sentence:
                first = next(unknown.name for unknown in part if unknown.name in names)
                yield ("effects", name, first), f"effect '{name}': {sentence}"


def _some(effect: Effect[Any, Any]) -> str:
    names = [unknown.name for unknown in effect.unknowns]
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return ", ".join(names[:MOST_NAMED]) + more


def _unfinished(part: Sequence[Unknown], names: Collection[str]) -> str:
    """Return what a part still needs that is stated at all: its shapes, and one amplitude; or nothing."""
    given = [unknown for unknown in part if unknown.name in names]
    missing = [unknown for unknown in part if unknown.name not in names and not unknown.is_amplitude]
    if not given:
        return ""
    if missing:
        bounds = f"from {missing[0].low:g} to {missing[0].high:g} {missing[0].unit}".strip()
        return f"'{given[0].name}' is given, so '{missing[0].name}' must be given too ({bounds})"
    if not any(unknown.is_amplitude for unknown in given):
        sizes = " or ".join(f"'{unknown.name}'" for unknown in part if unknown.is_amplitude)
        return f"'{given[0].name}' is given, but without {sizes} nothing happens; give it, or leave both out"
    return ""


def effects_of(model: Model[Any, Any], values: StatedValues) -> tuple[SwitchedOn, ...]:
    """Return the effects that are on, in the order in which they act."""
    on = []
    for name, effect in model.known_effects.items():
        keys = {unknown.name: ("effects", name, unknown.name) for unknown in effect.unknowns}
        read = {unknown: values[key] for unknown, key in keys.items() if key in values}
        stated = {unknown: value for unknown, (value, _) in read.items()}
        if not stated or (len(stated) < len(keys) and not effect.parts):
            continue
        covariance = values.get(("effects", name, "covariance"), ()) if "covariance" not in keys else ()
        sds = {unknown: sd for unknown, (_, sd) in read.items() if sd is not None}
        if covariance:
            sds = {unknown: math.sqrt(covariance[index][index]) for index, unknown in enumerate(stated)} | sds
        on.append(SwitchedOn(effect, stated, sds, covariance))
    return tuple(on)
