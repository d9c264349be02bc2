"""One name explained: what a result is made of and what moves it, what an input or an error source does.

All of it is plain data: the terminal and ``--json`` are both written from it.
"""

from __future__ import annotations

import ast
import itertools
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal, TypeAlias

import numpy as np

from truing.calculation import Calculation, calculate
from truing.declare.chain import acts_on, chain_of, prefix_of
from truing.declare.correlations import Correlated
from truing.declare.fields import Axis, Found, ResultField
from truing.declare.goals import Maximise, Minimise, Require, Vary, prices_in
from truing.declare.model import Model, Study, formula_scope
from truing.declare.near_miss import near_miss
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.errors import InfeasibleError, TruingError, UsageError
from truing.evaluate import acting_inputs, evaluate, taken_values
from truing.formulas import parse, symbol_text
from truing.formulas.layout import substituted, symbolic
from truing.formulas.tree import walk
from truing.formulas.write_text import TEXT
from truing.inputs_file import setup_from_settings
from truing.inputs_file.values import bounds_in_words
from truing.kernel import Offer
from truing.numbers import ABSENT, format_difference, format_ends, format_value, pretty, with_unit
from truing.published import compare_one, same_run
from truing.report.document import Value, plain_text
from truing.report.equations import equation_of
from truing.report.given import input_value
from truing.runs.documents import clean
from truing.setup import Setup, SwitchedOn
from truing.studies.bench import Progress, silent
from truing.studies.checks import check_name
from truing.studies.first_order import exact_slopes, nominal_of, slopes
from truing.studies.sampling import Scatter, scatter_of
from truing.units import difference_unit, from_si, to_si, unit_factor, unit_text
from truing.units.names import LEVELS


def told(setup: Setup, offer: Offer, name: str, *, progress: Progress = silent) -> dict[str, Any]:
    """Explain a result, an input, an effect, a tolerance, a condition or a study of a model, under one setup.

    Numbers are in the unit that stands beside them. Raises UsageError for a name that the model does not have, and
    what a run raises where the calculation is impossible.
    """
    model = setup.model
    kind = kind_of(model, name)
    name = name.rpartition(".")[2]
    tell: dict[Topic, Callable[[Setup, str], dict[str, Any]]] = {
        "result": partial(of_result, offer=offer, progress=progress), "input": of_input, "effect": of_effect,
        "tolerance": of_tolerance, "condition": of_condition, "study": of_study,
    }  # fmt: skip
    return {"model": offer.name, "title": model.title, "name": name, "kind": kind, **tell[kind](setup, name)}


# Which thing of a model a name means: a result, an input, an effect, a tolerance, a condition or a study


Topic: TypeAlias = Literal["result", "input", "effect", "tolerance", "condition", "study"]


SECTIONS: Mapping[str, Topic] = {
    "results": "result", "inputs": "input", "effects": "effect", "tolerances": "tolerance", "conditions": "condition",
    "studies": "study",
}  # fmt: skip
"""Words in front of a name that say which thing is meant, where one name has several."""


def known_names(model: Model[Any, Any], section: str = "") -> Mapping[str, Topic]:
    """Return every name that can be explained and what it means; of two meanings the first in this order.

    With a ``section`` only its names.
    """
    of: tuple[Iterable[str], ...] = (
        model.result_fields, model.input_fields, model.known_effects, model.tolerances, model.known_conditions,
        [study.name for study in model.studies],
    )  # fmt: skip
    topics: dict[str, Topic] = {}
    for (word, topic), names in zip(SECTIONS.items(), of, strict=True):
        if section in {"", word}:
            topics |= {name: topic for name in names if name not in topics}
    return topics


def kind_of(model: Model[Any, Any], name: str) -> Topic:
    """Return what a name means, also behind the word of a section (``tolerances.load``).

    Raises UsageError, with what was probably meant, where nothing has it.
    """
    section, _, last = name.rpartition(".")
    if section in SECTIONS and last in known_names(model, section):
        return SECTIONS[section]
    known = known_names(model)
    if name in known:
        return known[name]
    if section in SECTIONS:
        name, known = last, known_names(model, section)
    plain = name.strip().lower().replace(" ", "_").replace("-", "_")
    words = "" if plain in known else near_miss(plain[:80], known)
    meant = plain if plain in known else words.split("'")[1] if words else ""
    hint = f" `calc describe {model.name}` lists what there is."
    if meant:
        field: Any = model.result_fields.get(meant) or model.input_fields.get(meant)
        note = field.spec.note if known[meant] in {"result", "input"} and field is not None else ""
        hint = f" Did you mean '{meant}' ({', '.join(filter(None, (known[meant], note)))})?"
    what = SECTIONS.get(section, "result, input, effect or tolerance")
    raise UsageError(f"{model.name} has no {what} '{name[:80]}'.{hint}")


# Inputs, tolerances, effects, conditions and studies explained: what they are, and which results they move


def of_input(setup: Setup, name: str) -> dict[str, Any]:
    """Explain an input: value, bounds, scatter, the results it moves, limits and effects that have to do with it."""
    model = setup.model
    field = model.input_fields[name]
    links = made_from(model)
    direct, further = following(links, name)
    known = {**model.read_inputs(setup.inputs), **taken_values(setup)}
    scattering = [tolerance for tolerance in model.tolerances.values() if name in tolerance.on]
    changed = [effect for effect in model.effects.values() if name in touched(setup, effect).inputs]
    moves = _moves(setup, [name]) if field.kind == "float" and _is_given(setup, name) else None
    moved = {*direct, *further, *(row["name"] for row in moves or ())}
    namesake = model.tolerances.get(name)
    return {
        "symbol": symbol_text(field.symbol) if field.symbol else "",
        "note": field.spec.note,
        "source": field.spec.source,
        **amount(setup, name, known[name]),
        "taken_from": [*links.get(name, ())],
        "stated": name in setup.source.stated,
        "choices": list(field.choices),
        "bounds": bounds_in_words(field),
        "followed_by": list(direct),
        "then": list(further),
        "moves": moves,
        "limits": [require_words(require, "") for require in _requires(setup) if require.result in moved],
        "tolerances": [_tolerance(setup, tolerance) for tolerance in scattering],
        "correlated": [
            _correlated(each, name) for each in setup.scattering_together() if name in each.pair and each.coefficient
        ],
        "namesake": [] if namesake is None or name in namesake.on else list(namesake.on),
        "limit_of": [
            require_words(require, "") for require in _requires(setup) if name in {require.limit, require.reliability}
        ],
        "varied": [_varied(each) for each in model.objectives if isinstance(each, Vary) and each.input == name],
        "effects": [_effect_row(setup, effect) for effect in changed],
    }


def _varied(vary: Vary) -> str:
    steps = f" in steps of {vary.step}" if vary.step else ""
    return f"follows {vary.by}" if vary.by else f"may be chosen from {vary.low} to {vary.high}{steps}"


def _is_given(setup: Setup, name: str) -> bool:
    value = setup.nominal(name)
    return bool(value == value)


def _requires(setup: Setup) -> list[Require]:
    return [objective for objective in setup.model.objectives if isinstance(objective, Require)]


def _moves(setup: Setup, sources: Sequence[str]) -> list[dict[str, Any]]:
    """Say of each result of the function what one per cent of the sources, and their scatter, do to it."""
    answers = setup.model.read_results(evaluate(setup))
    results = [
        name for name, field in setup.model.own_result_fields.items() if not getattr(field.spec, "is_table", False)
    ]
    moved_by, _, _ = influences(setup, {name: answers[name] for name in results}, sources)
    rows = []
    for result in results:
        of = [influence for influence in moved_by[result] if influence.source in sources and influence.moves]
        alone = of[0] if of and len(sources) == 1 else None
        row = {
            "name": result,
            "note": setup.model.own_result_fields[result].spec.note,
            "change": "" if alone is None else step_text(setup, result, alone.step),
            "percent": None if alone is None else _percent(alone.relative),
            "share": sum(influence.share for influence in of),
        }
        rows += [row] if of else []
    return sorted(rows, key=lambda row: (-row["share"], -abs(row["percent"] or 0.0)))


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


def _correlated(pair: Correlated, name: str) -> dict[str, Any]:
    """Return what an input scatters together with, and how much."""
    (other,) = pair.pair - {name}
    return {"with": other, "correlation": pair.coefficient, "why": pair.why, "source": pair.source}


def _tolerance(setup: Setup, tolerance: Tolerance) -> dict[str, Any]:
    inner = setup.distributions().get(tolerance.name, {})
    sds = dict.fromkeys(step_text(setup, name, distribution.sd, 4) for name, distribution in inner.items())
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
    tried = Touched({}, {}, {}) if built_in else touched(setup, effect)
    units = {need.name: need.unit for need in effect.needs} | {each.name: each.unit for each in effect.unknowns}
    notes = {key: field.spec.note for key, field in model.own_result_fields.items()}
    return {
        **_effect_row(setup, effect),
        "why": effect.why,
        "source": effect.source,
        "built_in": built_in,
        "unknowns": [] if built_in else list(_unknowns(setup, effect)),
        "needs": [
            {"name": need.name, "note": need.note, "reference": _in(need.zero, need.unit)} for need in effect.needs
        ],
        "tried_at": [{"name": key, "text": _in(value, units[key])} for key, value in tried.at.items()],
        "moves": [
            {"name": key, "note": notes[key], "percent": _percent(size)}
            for key, size in sorted(tried.results.items(), key=lambda pair: -abs(pair[1]))
        ],
        "inputs": [
            {"name": key, "before": text_of(setup, key, before), "after": text_of(setup, key, after)}
            for key, (before, after) in tried.inputs.items()
        ],
    }


def _effect_row(setup: Setup, effect: Effect[Any, Any]) -> dict[str, Any]:
    on = any(active.effect.name == effect.name for active in setup.effects)
    return {"name": effect.name, "acts_on": acts_on(setup.model, effect), "on": on, "looks_like": effect.looks_like}


def _unknowns(setup: Setup, effect: Effect[Any, Any]) -> Iterator[dict[str, Any]]:
    held = next((active.values for active in setup.effects if active.effect.name == effect.name), {})
    for unknown in effect.unknowns:
        value = held.get(unknown.name)
        yield {
            "name": unknown.name, "low": unknown.low, "high": unknown.high, "unit": unit_text(unknown.unit),
            "note": unknown.note, "amplitude": unknown.is_amplitude,
            "text": "" if value is None else _in(value, unknown.unit),
        }  # fmt: skip


def _in(value: float, unit: str) -> str:
    return plain_text(Value(*format_value(value, unit)))


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
        "asked": name in [study.name for study in setup.studies],
        "gives": list(setup.model.study_result_fields.get(name, {})),
    }


# Numbers of an explanation: SI values as they are printed, and as data


def amount(setup: Setup, name: str, value: Any) -> dict[str, Any]:
    """Return the value (SI) of an input, a condition or a result as data, with the text that is printed of it."""
    unit = setup.print_unit(name)
    is_number = isinstance(value, (int, float)) or hasattr(value, "dtype")
    data = value if isinstance(value, (bool, str)) else from_si(value, unit) if is_number else None
    return {"value": clean(data), "unit": unit, "text": text_of(setup, name, value)}


def text_of(setup: Setup, name: str, value: Any) -> str:
    """Write a value with its unit: a number, the range of a series, a choice, a file."""
    field = setup.model.input_fields.get(name)
    if field is not None:
        return plain_text(input_value(setup, field, value))
    unit = setup.print_unit(name)
    if getattr(value, "ndim", 0):
        low, high, word = format_ends(value, unit)
        return f"{with_unit(f'{pretty(low)} .. {pretty(high)}', word)} ({np.size(value)} values)" if low else ABSENT
    result = setup.model.result_fields.get(name)
    return plain_text(Value(*format_value(value, unit, result.digits if result is not None else 10)))


def step_text(setup: Setup, name: str, step: float | None, digits: int = 3) -> str:
    """Write a difference (SI) of a result or an input, with its unit."""
    if step is None:
        return ABSENT
    return plain_text(Value(*format_difference(step, setup.print_unit(name), digits)))


def item_of(setup: Setup, name: str, value: Any) -> dict[str, Any]:
    """Return a row about an input, a condition or a result: what it is called, its symbol, its value, its note."""
    model = setup.model
    field: Any = model.result_fields.get(name) or model.input_fields.get(name)
    kind = "result" if name in model.result_fields else "input" if field is not None else "condition"
    symbol = symbol_text(field.symbol) if field is not None and field.symbol else ""
    note = field.spec.note if field is not None else model.known_conditions[name].note
    return {"name": name, "kind": kind, "symbol": symbol, **amount(setup, name, value), "note": note}


# A result explained: its formula, what it is made from and what moves it, what rests on it and what follows


def of_result(setup: Setup, name: str, *, offer: Offer, progress: Progress) -> dict[str, Any]:
    """Explain one result under a setup; studies are run as far as the result needs them."""
    model = setup.model
    field, study = model.result_fields[name], study_of(model, name)
    calculation = calculate(replace(setup, studies=_needed(setup, study)), progress=progress)
    answers = calculation.answers
    links = made_from(model)
    direct, further = following(links, name)
    known = {**model.read_inputs(setup.inputs), **taken_values(setup), **answers}
    return {
        "symbol": symbol_text(field.symbol) if field.symbol else "",
        "note": field.spec.note,
        "along": "" if isinstance(field.spec, Axis) else field.along,
        "method": getattr(field.spec, "method", ""),
        "source": getattr(field.spec, "source", ""),
        **amount(setup, name, answers.get(name)),
        "study": study,
        "formula": formula_of(setup, answers, field),
        "made_from": [item_of(setup, source, known.get(source)) for source in links.get(name, ())],
        "chain": [
            {**item_of(setup, source, known.get(source)), "depth": depth, "again": again}
            for depth, source, again in chain(links, name)
        ],
        "followed_by": list(direct),
        "then": list(further),
        **_moved_by(setup, field, answers.get(name), progress),
        "limits": list(_limits(setup, name, calculation, {*direct, *further})),
        "published": list(_published(setup, offer, name, calculation)),
        "effects": _effects(setup, name, links),
        "sections": [section.title for section in model.sheet if name in section.names],
    }


def study_of(model: Model[Any, Any], name: str) -> str:
    """Return the study that gives a result, or nothing where the calculation itself does."""
    return next((study for study, fields in model.study_result_fields.items() if name in fields), "")


def _needed(setup: Setup, study: str) -> tuple[Study, ...]:
    """Return the studies up to the one that gives a result, as the setup asks for them."""
    names = [study.name for study in setup.studies]
    return tuple(setup.studies[: names.index(study) + 1]) if study in names else ()


def formula_of(setup: Setup, answers: Mapping[str, Any], field: ResultField) -> dict[str, Any] | None:
    """Return the formula of a result as text: in symbols, with numbers, and the result; None where it has none."""
    equation = equation_of(setup, answers, field)
    if equation is None:
        return None
    formula = equation.formula
    numbers = ""
    if equation.numbers is not None and formula.names and formula.left is None:
        numbers = substituted(TEXT, formula, equation.numbers)
    return {
        "text": formula.text,
        "left": "" if formula.left is not None else symbol_text(field.symbol) if field.symbol else field.name,
        "symbols": symbolic(TEXT, formula, equation.symbols),
        "numbers": numbers,
        "results": [plain_text(value) for value in equation.results if value.text != ABSENT],
        "departs": equation.departs,
    }


def _moved_by(setup: Setup, field: ResultField, answer: Any, progress: Progress) -> dict[str, Any]:
    """Say what moves the result: its scatter by source, the largest share first, and by how much one per cent does."""
    name = field.name
    if name not in setup.model.own_result_fields:
        return {"scatter": None, "slopes": [], "remarks": []}
    moved_by, sds, remarks = influences(setup, {name: answer}, differentiable(setup), progress=progress)
    of, sd = moved_by[name], sds[name]
    shares = []
    for one in sorted((one for one in of if one.share), key=lambda one: -abs(one.share)):
        names = [tolerance for tolerance, inner in setup.distributions().items() if one.source in inner]
        spread = ", ".join(setup.spread_of(tolerance).text for tolerance in names)
        shares.append({"name": one.source, "share": one.share, "tolerances": names, "spread": spread})
    steepest = sorted((one for one in of if one.moves and one.step), key=lambda one: -abs(one.step or 0.0))
    return {
        "scatter": {"sd": step_text(setup, name, sd), "shares": shares} if sd > 0 else None,
        "slopes": [
            {"name": one.source, "change": step_text(setup, name, one.step), "percent": _percent(one.relative)}
            for one in steepest
        ],
        "remarks": remarks,
    }


def _percent(share: float | None) -> float | None:
    return None if share is None or not abs(share) < float("inf") else 100 * share


def _limits(setup: Setup, name: str, calculation: Calculation, below: set[str]) -> Iterator[dict[str, Any]]:
    """Say the limits and goals on a result and on those ``below`` it, and those that it sets for others."""
    requires = _requires(setup)
    checks = {check.name: check for check in calculation.checks}
    for objective in sorted(setup.model.objectives, key=lambda objective: getattr(objective, "result", "") != name):
        if isinstance(objective, (Minimise, Maximise)) and objective.result == name:
            yield {"says": f"should be {'small' if isinstance(objective, Minimise) else 'large'}", "check": None}
        if isinstance(objective, Require) and (
            name in {objective.result, objective.limit, objective.reliability} or objective.result in below
        ):
            check = checks.get(check_name(objective, requires))
            data = None if check is None else {key: clean(getattr(check, key)) for key in CHECK}
            yield {"says": require_words(objective, name), "check": data}


def require_words(require: Require, name: str) -> str:
    """Write a requirement: at most 80 MPa, with reliability 0.99; named by its result where that is another."""
    subject = "" if require.result == name else f"{require.result} "
    goal = f", with reliability {require.reliability}" if require.reliability is not None else ""
    return f"{subject}{require.kind.replace('_', ' ')} {require.limit}{goal}"


CHECK = ("value", "limit", "unit", "margin", "compared", "relation", "state", "passed", "undecided")
"""What is said of a check."""


def _published(setup: Setup, offer: Offer, name: str, calculation: Calculation) -> Iterator[dict[str, Any]]:
    """Put what the source prints of a result beside ours, each under the settings that it holds for.

    Ours is None for a result of a study under other settings: to verify these takes whole runs.
    """
    study = study_of(setup.model, name)
    for printed in setup.model.published:
        if printed.result != name:
            continue
        wanted = setup_from_settings(offer, printed.settings)
        compared = None
        if not study:
            compared = compare_one(printed, calculate(replace(wanted, studies=())))
        elif same_run(setup, wanted) and _needed(setup, study) == _needed(wanted, study):
            compared = compare_one(printed, calculation)
        yield {
            "name": printed.name, "where": printed.where, "settings": dict(printed.settings),
            "unit": unit_text(printed.unit), "paper": printed.value,
            "ours": None if compared is None else compared.value, "verdict": printed.verdict, "why": printed.why,
        }  # fmt: skip


def _effects(setup: Setup, name: str, links: Mapping[str, Sequence[str]]) -> list[dict[str, Any]]:
    """Name the model's own effects that change a result (of a study: a result that it names), the largest first."""
    model = setup.model
    own = model.own_result_fields
    names = [name] if name in own else [one for one in links.get(name, ()) if one in own]
    sizes: dict[str, float] = {}
    for effect in model.effects.values() if names else ():
        changed = touched(setup, effect).results
        sizes[effect.name] = max(abs(changed.get(one, 0.0)) for one in names)
    largest = sorted(filter(sizes.__getitem__, sizes), key=lambda effect: -sizes[effect])
    return [_effect_row(setup, model.effects[effect]) for effect in largest]


# How a source moves a result: derivatives, and shares of its scatter


PATIENCE = 20.0
"""So many seconds derivatives may take; what is not reached then is said."""
NOTHING = 1e-10
"""A source that moves a result by less than this share of it, when it changes by its own size, does not move it."""


@dataclass(frozen=True)
class Influence:
    """What one source does to one result; along an axis every number is a root mean square.

    ``step`` is the change of the result (SI) as the source grows by one per cent (a level of temperature by one kelvin;
    None for a source that is 0), ``relative`` the same as a share of the result (None where that is 0), ``share`` the
    part of the first-order variance of the result that is due to the scatter of the source.
    """

    source: str
    step: float | None
    relative: float | None
    share: float
    moves: bool


def differentiable(setup: Setup) -> list[str]:
    """Return the inputs and conditions that a result can be differentiated by: numbers that are given."""
    numbers = [name for name, field in setup.model.input_fields.items() if field.kind == "float"]
    return [name for name in (*numbers, *setup.conditions) if (value := nominal_of(setup, name)) == value]


def influences(
    setup: Setup, answers: Mapping[str, Any], sources: Sequence[str], *, progress: Progress = silent
) -> tuple[dict[str, list[Influence]], dict[str, float], list[str]]:
    """Differentiate results of the function (by name, with their values) by sources and by all that scatters.

    Returns what moves each result, the standard deviation (SI) of all that scatters by result, and what to know.
    """
    scatter = scatter_of(setup)
    columns = tuple(dict.fromkeys([*scatter.columns, *sources]))
    slopes_of, remarks = _slopes(setup, tuple(answers), columns, scatter=scatter, progress=progress)
    exact = exact_slopes(setup)
    of: dict[str, list[Influence]] = {}
    sd: dict[str, float] = {}
    for result, answer in answers.items():
        by_source = {**slopes_of[result], **{key: v for key, v in exact.get(result, {}).items() if key in columns}}
        variance = {name: _mean(value) for name, value in scatter.variances(by_source).items()}
        whole = sum(variance.values())
        size = _size(answer)
        sd[result] = max(whole, 0.0) ** 0.5
        share = {name: part / whole if whole > 0 else 0.0 for name, part in variance.items()}
        of[result] = [
            _influence(setup, scatter, name, by_source[name], size=size, share=share.get(name, 0.0)) for name in columns
        ]
    return of, sd, remarks


def _slopes(
    setup: Setup, results: Sequence[str], columns: Sequence[str], *, scatter: Scatter, progress: Progress
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Differentiate by one column after the other, as long as there is patience; NaN stands for what was not found."""
    of: dict[str, dict[str, Any]] = {result: dict.fromkeys(columns, math.nan) for result in results}
    remarks: list[str] = []
    ends = time.monotonic() + PATIENCE
    for index, column in enumerate(columns):
        progress("differentiating", index, len(columns))
        if time.monotonic() > ends:
            left = ", ".join(columns[index:])
            remarks.append(f"one calculation takes so long that these were not differentiated by: {left}")
            break
        try:
            derivatives = slopes(setup, results, [column], scatter)
        except TruingError as error:
            remarks.append(f"no derivative by '{column}': {error}")
            continue
        remarks += derivatives.warnings
        for result in results:
            of[result][column] = derivatives.of[result][column]
    return of, remarks


def _influence(setup: Setup, scatter: Scatter, name: str, slope: Any, *, size: float, share: float) -> Influence:
    value = nominal_of(setup, name)
    is_known = name in setup.model.input_fields or name in setup.model.known_conditions
    unit = setup.unit_of(name) if is_known else ""
    steepness = _size(slope) * (-1.0 if getattr(slope, "ndim", 0) == 0 and slope < 0 else 1.0)
    own = 1.0 if unit in LEVELS else 0.01 * abs(value)
    step = steepness * own if own and steepness == steepness else None
    relative = step / size if step is not None and size else None
    widest = max(abs(value), scatter.sd_of(name), 0.0 if value else unit_factor(difference_unit(unit)))
    moves = steepness == steepness and abs(steepness) * widest > NOTHING * size
    return Influence(name, step, relative, share, moves)


def _size(value: Any) -> float:
    """Return the size of a number, or the root mean square of an array, NaN where any part is none."""
    return math.sqrt(_mean(value * value))


def _mean(value: Any) -> float:
    if not getattr(value, "ndim", 0):
        return float(value)
    return float(value.mean()) if value.size else math.nan


# What an effect changes: the model is run with it, at a size it may have, beside the model without


SIZES = (0.5, 0.05, 0.005)
"""Shares of an amplitude's bound that are tried, until the calculation is possible."""
STEP = 10.0
"""How far from its reference a condition without a range is tried, in its unit."""
ROUNDING = 1e-12


@dataclass(frozen=True)
class Touched:
    """What changes when an effect is on: results by name with the relative change, and inputs before and after (SI).

    The change of a result that is 0 without the effect is infinite; along an axis it is the largest change over the
    largest value. ``at`` holds the unknowns and conditions of the trial, SI. None could be tried where it is empty.
    """

    at: Mapping[str, float]
    results: Mapping[str, float]
    inputs: Mapping[str, tuple[float, float]]


def touched(setup: Setup, effect: Effect[Any, Any]) -> Touched:
    """Try one effect alone, as it is where it is on, else at sizes within its bounds, its conditions off reference."""
    conditions = {need.name: _off_reference(setup, need) for need in effect.needs}
    bare = replace(setup, effects=(), conditions={**setup.conditions, **conditions})
    held = (dict(active.values) for active in setup.effects if active.effect.name == effect.name)
    tried = ({unknown.name: _tried(setup, unknown, size) for unknown in effect.unknowns} for size in SIZES)
    for values in itertools.chain(held, tried):
        acting = replace(bare, effects=(SwitchedOn(effect, values),))
        try:
            without, with_it = evaluate(bare, reading=True), evaluate(acting, reading=True)
        except InfeasibleError:
            continue
        read = setup.model.read_results
        changed = dict(_changed(read(without), read(with_it)))
        inputs = dict(_moved(bare, acting)) if effect.place == "inputs" else {}
        return Touched({**values, **conditions}, changed, inputs)
    return Touched({}, {}, {})


def _tried(setup: Setup, unknown: Unknown, size: float) -> float:
    """Return a value of an unknown: an amplitude at a share of its bound, a shape amid its bounds."""
    if unknown.is_amplitude:
        return float(to_si(size * (unknown.high or unknown.low), unknown.unit))
    if unknown.whole:
        return float(to_si(unknown.low, unknown.unit))
    if unknown.low > 0:
        return float(to_si((unknown.low * unknown.high) ** 0.5, unknown.unit))
    return float(to_si((unknown.low + unknown.high) / 2, unknown.unit))


def _off_reference(setup: Setup, need: Condition) -> float:
    """Return a value of a condition that is not its reference."""
    value = setup.conditions.get(need.name, need.zero)
    if value != need.zero:
        return float(value)
    for tried in (need.high, need.low):
        if tried is not None and tried != need.reference:
            return float(to_si(tried, need.unit))
    return float(to_si(need.reference + STEP, need.unit))


def _changed(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    for name, value in before.items():
        one, other = np.atleast_1d(np.asarray(value, dtype=float)), np.atleast_1d(np.asarray(after[name], dtype=float))
        if one.shape != other.shape:
            yield name, float("inf")
            continue
        difference = other - one
        step = float(difference[np.argmax(np.abs(difference))]) if one.size else 0.0
        size = float(np.abs(one).max()) if one.size else 0.0
        if abs(step) > ROUNDING * size:
            yield name, step / size if size else float("inf")


def _moved(bare: Setup, acting: Setup) -> Iterator[tuple[str, tuple[float, float]]]:
    model = bare.model
    before, after = model.read_inputs(acting_inputs(bare)), model.read_inputs(acting_inputs(acting))
    for name, field in model.input_fields.items():
        if field.varies and before[name] == before[name] and before[name] != after[name]:
            yield name, (float(before[name]), float(after[name]))


# Which result is made from what, as the declared formulas say, and which results follow from a name


def made_from(model: Model[Any, Any]) -> Mapping[str, tuple[str, ...]]:
    """Return, for every result with a formula, the inputs and results that it names, in the order of its text.

    Of an input that is taken from another calculation it is what is taken.
    """
    made = chain_of(model)
    taken = {} if made is None else made.taken
    links: dict[str, tuple[str, ...]] = {name: (prefix_of(link.source) + link.result,) for name, link in taken.items()}
    for name, field in model.result_fields.items():
        if not isinstance(field.spec, Found) or not field.spec.formula:
            continue
        formula = parse(field.spec.formula)
        scope = formula_scope(model, field)
        sides = [side for side in (formula.left, formula.right) if side is not None]
        written = [node.id for side in sides for node in walk(side) if isinstance(node, ast.Name)]
        names = dict.fromkeys(scope[word].name for word in written if word in scope)
        links[name] = tuple(other for other in names if other != name)
    return links


def following(links: Mapping[str, tuple[str, ...]], name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the results whose formulas name this one, inputs that take it, and those that follow further down."""
    direct = [result for result, sources in links.items() if name in sources]
    found = list(direct)
    for last in found:  # which grows
        found += [result for result, sources in links.items() if last in sources and result not in {name, *found}]
    return tuple(direct), tuple(found[len(direct) :])


def chain(links: Mapping[str, tuple[str, ...]], name: str) -> Iterator[tuple[int, str, bool]]:
    """Yield what a result is made from, depth first down to the inputs: depth, name, whether it stood above already."""
    seen: set[str] = set()

    def below(result: str, depth: int) -> Iterator[tuple[int, str, bool]]:
        for source in links.get(result, ()):
            again = source in seen and source in links
            seen.add(source)
            yield depth, source, again
            if not again:
                yield from below(source, depth + 1)

    yield from below(name, 1)
