"""Inputs, tolerances, effects, conditions and studies explained: what they are, and which results they move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from truing.declare.goals import Require, Vary, prices_in
from truing.declare.sources import Effect, Tolerance
from truing.evaluate import evaluate
from truing.explain.amounts import amount, step_text, text_of
from truing.explain.influence import Influences, influences
from truing.explain.links import following, made_from
from truing.explain.told_result import require_words
from truing.explain.touched import Touched, all_touched, touched
from truing.formulas import symbol_text
from truing.inputs_file.values import bounds_in_words
from truing.numbers import format_value, pretty, with_unit
from truing.setup import Setup
from truing.units import unit_text


def of_input(setup: Setup, name: str) -> dict[str, Any]:
    """Explain an input: value, bounds, scatter, the results it moves, limits and effects that have to do with it."""
    model = setup.model
    item = model.input_fields[name]
    direct, further = following(made_from(model), name)
    scattering = [tolerance for tolerance in model.tolerances.values() if name in tolerance.on]
    changed = [effect for effect, one in all_touched(setup).items() if name in one.inputs]
    moves = _moves(setup, [name]) if item.kind == "float" and _is_given(setup, name) else None
    moved = {*direct, *further, *(row["name"] for row in moves or ())}
    return {
        "symbol": symbol_text(item.symbol) if item.symbol else "",
        "note": item.spec.note,
        "source": item.spec.source,
        **amount(setup, name, model.read_inputs(setup.inputs)[name]),
        "stated": name in setup.source.stated,
        "choices": list(item.choices),
        "bounds": bounds_in_words(item),
        "followed_by": list(direct),
        "then": list(further),
        "moves": moves,
        "limits": [require_words(one, "") for one in _requires(setup) if one.result in moved],
        "tolerances": [_tolerance(setup, tolerance) for tolerance in scattering],
        "namesake": list(model.tolerances[name].on) if name in model.tolerances and not _is_on(setup, name) else [],
        "limit_of": [require_words(one, "") for one in _requires(setup) if name in {one.limit, one.reliability}],
        "varied": [_vary_words(one) for one in model.objectives if isinstance(one, Vary) and one.input == name],
        "effects": [_effect_row(setup, model.effects[effect]) for effect in changed],
    }


def _is_on(setup: Setup, name: str) -> bool:
    return name in setup.model.tolerances[name].on


def _is_given(setup: Setup, name: str) -> bool:
    value = setup.nominal(name)
    return bool(value == value)


def _requires(setup: Setup) -> list[Require]:
    return [item for item in setup.model.objectives if isinstance(item, Require)]


def _vary_words(item: Vary) -> str:
    return f"follows {item.by}" if item.by else f"may be chosen from {item.low} to {item.high}"


def _moves(setup: Setup, sources: Sequence[str]) -> list[dict[str, Any]]:
    """Say of each result of the function what one per cent of the sources, and their scatter, do to it."""
    answers = setup.model.read_results(evaluate(setup))
    results = [name for name, item in setup.model.own_result_fields.items() if not _is_table(item)]
    found = influences(setup, {name: answers[name] for name in results}, sources)
    rows = [row for result in results if (row := _row(setup, found, result, sources)) is not None]
    return sorted(rows, key=lambda row: (-row["share"], -abs(row["percent"] or 0.0)))


def _is_table(item: Any) -> bool:
    return bool(getattr(item.spec, "is_table", False))


def _row(setup: Setup, found: Influences, result: str, sources: Sequence[str]) -> dict[str, Any] | None:
    of = [one for one in found.of[result] if one.source in sources and one.moves]
    if not of:
        return None
    alone = of[0] if len(sources) == 1 else None
    return {
        "name": result,
        "note": setup.model.own_result_fields[result].spec.note,
        "change": step_text(setup, result, alone.step) if alone is not None else "",
        "percent": 100 * alone.relative if alone is not None and alone.relative is not None else None,
        "share": sum(one.share for one in of),
    }


def of_tolerance(setup: Setup, name: str) -> dict[str, Any]:
    """Explain a tolerance: its spread, what it is on, its price, and whose scatter it makes."""
    tolerance = setup.model.tolerances[name]
    given = [target for target in tolerance.on if _is_given(setup, target)]
    rows = _moves(setup, given) if given else []
    return {
        **_tolerance(setup, tolerance),
        "on": [{"name": target, "text": text_of(setup, target, setup.nominal(target))} for target in tolerance.on],
        "moves": [row for row in rows if row["share"]],
    }


def _tolerance(setup: Setup, tolerance: Tolerance) -> dict[str, Any]:
    inner = setup.distributions().get(tolerance.name, {})
    sds = dict.fromkeys(step_text(setup, name, item.sd, 4) for name, item in inner.items())
    return {
        "name": tolerance.name,
        "spread": setup.spread_of(tolerance.name).text,
        "sd": list(sds),
        "why": tolerance.why,
        "source": tolerance.source,
        "price": [f"{price.formula} {price.unit}, width in {price.width}" for price in prices_in(tolerance.price)],
    }


def of_effect(setup: Setup, name: str) -> dict[str, Any]:
    """Explain an effect: where it acts, its unknowns, what it needs, and what changes when it is on."""
    model = setup.model
    effect = model.known_effects[name]
    built_in = name not in model.effects
    found = Touched({}, {}, {}) if built_in else touched(setup, effect)
    ranked = sorted(found.results.items(), key=lambda pair: -abs(pair[1]))
    return {
        **_effect_row(setup, effect),
        "why": effect.why,
        "source": effect.source,
        "built_in": built_in,
        "unknowns": [] if built_in else list(_unknowns(setup, effect)),
        "needs": [_need(setup, need.name) for need in effect.needs],
        "tried_at": [{"name": key, "text": _tried(setup, effect, key, value)} for key, value in found.at.items()],
        "moves": [_touched_row(setup, key, size) for key, size in ranked],
        "inputs": [
            {"name": key, "before": text_of(setup, key, before), "after": text_of(setup, key, after)}
            for key, (before, after) in found.inputs.items()
        ],
    }


def _touched_row(setup: Setup, name: str, size: float) -> dict[str, Any]:
    note = setup.model.own_result_fields[name].spec.note
    return {"name": name, "note": note, "percent": 100 * size if abs(size) < float("inf") else None}


def _effect_row(setup: Setup, effect: Effect[Any, Any]) -> dict[str, Any]:
    on = any(item.effect.name == effect.name for item in setup.effects)
    return {"name": effect.name, "acts_on": effect.place, "on": on, "looks_like": effect.looks_like}


def _unknowns(setup: Setup, effect: Effect[Any, Any]) -> Iterator[dict[str, Any]]:
    held = next((item.values for item in setup.effects if item.effect.name == effect.name), {})
    for unknown in effect.unknowns:
        value = held.get(unknown.name)
        yield {
            "name": unknown.name, "low": unknown.low, "high": unknown.high, "unit": unit_text(unknown.unit),
            "note": unknown.note, "amplitude": unknown.is_amplitude,
            "text": "" if value is None else _in(value, unknown.unit),
        }  # fmt: skip


def _in(value: float, unit: str) -> str:
    number, word = format_value(value, unit)
    return with_unit(pretty(number), word)


def _tried(setup: Setup, effect: Effect[Any, Any], name: str, value: float) -> str:
    unknown = next((one for one in effect.unknowns if one.name == name), None)
    return _in(value, unknown.unit if unknown is not None else setup.model.known_conditions[name].unit)


def _need(setup: Setup, name: str) -> dict[str, Any]:
    condition = setup.model.known_conditions[name]
    return {"name": name, "note": condition.note, "reference": _in(condition.zero, condition.unit)}


def of_condition(setup: Setup, name: str) -> dict[str, Any]:
    """Explain a condition: its value, the reference where its effects vanish, and these effects."""
    condition = setup.model.known_conditions[name]
    effects = [effect for effect in setup.model.known_effects.values() if condition in effect.needs]
    ends = [condition.low, condition.high]
    said = f"{condition.low:g} to {condition.high:g} {unit_text(condition.unit)}" if None not in ends else ""
    return {
        "note": condition.note,
        **amount(setup, name, setup.nominal(name)),
        "reference": _in(condition.zero, condition.unit),
        "range": said.strip(),
        "derived": condition.derived,
        "effects": [_effect_row(setup, effect) for effect in effects],
    }


def of_study(setup: Setup, name: str) -> dict[str, Any]:
    """Explain a study: what it asks, whether this setup runs it, and the results it gives."""
    study = next(study for study in setup.model.studies if study.name == name)
    said = (type(study).__doc__ or "").strip().partition("\n")[0]
    return {
        "note": said,
        "asked": name in [each.name for each in setup.studies],
        "gives": list(setup.model.study_result_fields.get(name, {})),
    }
