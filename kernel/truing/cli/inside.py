"""What lies inside a plugin, for a shell that asks: models, results, inputs, effects, tolerances, options."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

from truing.cli.candidates import OfferedWord
from truing.declare.model import Model
from truing.inputs_file.file_model import HEAD
from truing.inputs_file.study_options import diagnose_schema, options_of
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
    yield from _declared(_typed_model(context))


def changes(context: typer.Context, incomplete: str) -> Iterator[OfferedWord]:
    """Offer what ``--set`` takes for the plugin that is typed already: NAME=, section by section, and choices."""
    model = _typed_model(context)
    name, equals, _ = incomplete.partition("=")
    section, point, _ = name.partition(".")
    if equals:
        yield from _choices(model, name)
    elif point:
        yield from _inside(model, section, name)
    else:
        yield from _inputs(model)
        yield from ((f"{section}.", "a section of the inputs file") for section in _sections(model))
        yield "seed=", "where the random numbers begin"


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
    found: dict[str, str] = {}
    for fields in (model.result_fields, model.input_fields):
        for name, item in fields.items():
            found.setdefault(name, _with_unit(item.spec.note, item.unit))
    for effect in model.effects.values():
        found.setdefault(effect.name, effect.why or effect.looks_like)
    for tolerance in model.tolerances.values():
        found.setdefault(tolerance.name, tolerance.why)
    yield from found.items()


def _with_unit(note: str, unit: str) -> str:
    return ", ".join(part for part in (note, unit) if part)


def _inputs(model: Model[Any, Any]) -> Iterator[OfferedWord]:
    """Give inputs and conditions; options of its reader stand behind one that is read from a file."""
    for name, item in model.input_fields.items():
        yield f"{name}=", _with_unit(item.spec.note, " or ".join(item.choices) or item.unit)
        if item.kind == "file":
            yield f"{name}.", "how the data file is read"
    for name, condition in model.known_conditions.items():
        if name not in model.input_fields:
            yield f"{name}=", _with_unit(condition.note or "a condition", condition.unit)


def _sections(model: Model[Any, Any]) -> Iterator[str]:
    has = {"tolerances": model.tolerances, "effects": model.known_effects, "studies": model.studies}
    yield from (name for name, content in has.items() if content)
    yield from ("calibrated", "units", "sheet")


def _inside(model: Model[Any, Any], section: str, name: str) -> Iterator[OfferedWord]:
    """Give the names of one section of the inputs file, or the options of a data file."""
    if section == "tolerances":
        yield from ((f"tolerances.{one.name}=", f"{one.spread.text}; {one.why}") for one in model.tolerances.values())
    elif section == "effects":
        yield from _effects(model, name.split(".")[1], is_inside=name.count(".") > 1)
    elif section == "studies":
        yield from _studies(model, name.split(".")[1], is_inside=name.count(".") > 1)
    elif section == "units":
        yield from ((f"units.{one}=", item.spec.note) for one, item in model.result_fields.items())
    elif section == "sheet":
        yield from ((f"sheet.{one}=", "") for one in (*HEAD, "detail"))
    elif section == "conditions":
        yield from ((f"conditions.{one.name}=", one.note) for one in model.known_conditions.values())
    elif section in {"inputs", "calibrated"}:
        yield from ((f"{section}.{one}=", item.spec.note) for one, item in model.input_fields.items())
    else:
        yield from _reader(model, section)


def _effects(model: Model[Any, Any], wanted: str, *, is_inside: bool) -> Iterator[OfferedWord]:
    if not is_inside:
        for effect in model.known_effects.values():
            yield f"effects.{effect.name}.", effect.why or effect.looks_like
        return
    for unknown in model.known_effects[wanted].unknowns:
        yield f"effects.{wanted}.{unknown.name}=", _with_unit(unknown.note, unknown.unit)


def _studies(model: Model[Any, Any], wanted: str, *, is_inside: bool) -> Iterator[OfferedWord]:
    if not is_inside:
        for study in model.studies:
            yield f"studies.{study.name}.", (type(study).__doc__ or "").strip().partition("\n")[0]
        yield "studies.diagnose.", "what is asked of calc diagnose"
        yield from (("studies.run=", "which studies run, in this order"), ("studies.seed=", ""))
        return
    if wanted == "diagnose":
        options = diagnose_schema(model)["properties"].items()
        yield from ((f"studies.diagnose.{name}=", str(words.get("description", ""))) for name, words in options)
        return
    study = next(one for one in model.studies if one.name == wanted)
    for name in options_of(study):
        yield f"studies.{wanted}.{name}=", f"now {getattr(study, name)}"


def _reader(model: Model[Any, Any], name: str) -> Iterator[OfferedWord]:
    """Give the options of the reader of a data file."""
    reader = getattr(model.input_fields[name].spec, "reader", None)
    if reader is not None:
        yield f"{name}.file=", "the data file"
        yield from ((f"{name}.{option}=", "") for option in list(inspect.signature(reader).parameters)[1:])


def _choices(model: Model[Any, Any], name: str) -> Iterator[OfferedWord]:
    item = model.input_fields[name]
    words = ("true", "false") if item.kind == "switch" else item.choices
    yield from ((f"{name}={word}", item.spec.note) for word in words)
