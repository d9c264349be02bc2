"""What lies inside a plugin, for a shell that asks: models, results, inputs, effects, tolerances, options."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer

from truing.cli.candidates import OfferedWord
from truing.declare.fields import Loaded
from truing.declare.model import Model
from truing.inputs_file.entries import sections
from truing.kernel import Kernel, Offer


def names_of(incomplete: str) -> Iterator[OfferedWord]:
    """Give PLUGIN.NAME for what the plugin that is named answers, takes, and could have wrong."""
    for offer in offers(incomplete):
        if incomplete.startswith(f"{offer.name}."):
            yield from ((f"{offer.name}.{name}", words) for name, words in _declared(offer.model))
        else:
            yield f"{offer.name}.", offer.model.title


def names_inside(context: typer.Context) -> Iterator[OfferedWord]:
    """Offer what the calculation that is typed already answers, takes, and could have wrong."""
    return _declared(_typed_model(context))


def varied(context: typer.Context) -> Iterator[OfferedWord]:
    """Offer the numbers among the inputs, and the conditions, of the calculation that is typed already."""
    model = _typed_model(context)
    numbers = (name for name, field in model.input_fields.items() if field.varies or field.kind == "integer")
    notes = dict(_declared(model))
    yield from ((name, notes.get(name, "a condition")) for name in (*numbers, *model.conditions))


def changes(context: typer.Context, incomplete: str) -> Iterator[OfferedWord]:
    """Offer what ``--set`` takes for the plugin that is typed already: NAME=, section by section, and choices."""
    model = _typed_model(context)
    known = {name: section.schema["properties"] for name, section in sections(model).items()}
    direct: Mapping[str, Any] = {**known["inputs"], **known["conditions"], "seed": known["studies"]["seed"]}
    name, equals, _ = incomplete.partition("=")
    *above, last = name.split(".")
    if not above:
        inside = direct
    elif len(above) == 1 and above[0] not in known:
        inside = _options_of_reader(model, above[0])
    else:
        inside = functools.reduce(_inside, above, known)
    if equals:
        words = ("true", "false") if inside[last].get("type") == "boolean" else inside[last].get("enum", ())
        yield from ((f"{name}={word}", _words(inside[last])) for word in words)
        return
    for key, schema in inside.items():
        yield f"{'.'.join([*above, key])}{'.' if 'properties' in schema else '='}", _words(schema)
    if not above:
        files = (key for key, field in model.input_fields.items() if field.kind == "file")
        yield from ((f"{key}.", "how the data file is read") for key in files)
        titles = (key for key, entries in known.items() if entries and key not in {"inputs", "conditions"})
        yield from ((f"{key}.", "a section of the inputs file") for key in titles)


def _inside(names: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """Return what a name holds: a section its entries, an effect or a study its own."""
    inner: Mapping[str, Any] = names[name]
    inside: Mapping[str, Any] = inner.get("properties", inner)
    return inside


def _words(schema: Mapping[str, Any]) -> str:
    return str(schema.get("description") or (f"now {schema['default']}" if "default" in schema else ""))


def _options_of_reader(model: Model[Any, Any], name: str) -> dict[str, Any]:
    """Return the options of the reader of a data file, without a word of each."""
    spec = model.input_fields[name].spec
    options = list(inspect.signature(spec.reader).parameters)[1:] if isinstance(spec, Loaded) else []
    return {"file": {"description": "the data file"}, **{option: {} for option in options}}


def offers(word: str) -> list[Offer]:
    """Return what the plugin offers to which a word belongs; no other plugin is loaded."""
    if word.endswith(".py"):
        kernel = Kernel()
        kernel.add_file(Path(word))
    else:
        kernel = Kernel.installed(only=word.partition(".")[0])
    return list(kernel.offers.values())


def _typed_model(context: typer.Context) -> Model[Any, Any]:
    """Return the model that is named on the line; behind an option that still waits, no word is sorted out yet."""
    typed = [context.params.get("plugin"), context.params.get("what"), *context.args]
    return _model(next(str(word) for word in typed if word))


def _model(word: str) -> Model[Any, Any]:
    """Return the model of this name, or the one to which a name inside belongs (PLUGIN.RESULT)."""
    known = offers(word)
    named = {name: offer.model for offer in known for name in (offer.name, f"{offer.origin.name}.{offer.model.name}")}
    meant = max((name for name in named if f"{word}.".startswith(f"{name}.")), key=len, default="")
    if meant:
        return named[meant]
    return known[0].model if len(known) == 1 else Kernel.installed().offer(word).model


def _declared(model: Model[Any, Any]) -> Iterator[OfferedWord]:
    """Give results, inputs, effects and tolerances, each name once."""
    notes: dict[str, str] = {}
    for fields in (model.result_fields, model.input_fields):
        for name, field in fields.items():
            notes.setdefault(name, ", ".join(part for part in (field.spec.note, field.unit) if part))
    for effect in model.effects.values():
        notes.setdefault(effect.name, effect.why or effect.looks_like)
    for tolerance in model.tolerances.values():
        notes.setdefault(tolerance.name, tolerance.why)
    yield from notes.items()
