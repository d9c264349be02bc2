"""A result explained: its formula, what it is made from and what moves it, what rests on it and what follows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from truing.calculation import Calculation, calculate
from truing.declare.fields import Axis, ResultField
from truing.declare.goals import Maximise, Minimise, Require
from truing.declare.model import Model, Study
from truing.explain.amounts import amount, item_of, step_text
from truing.explain.influence import Influence, by_share, by_slope, differentiable, influences
from truing.explain.links import chain, following, made_from
from truing.explain.touched import all_touched, effects_on
from truing.formulas import symbol_text
from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_text import TextWriter
from truing.inputs_file import setup_from_settings
from truing.kernel import Offer
from truing.numbers import ABSENT, pretty, with_unit
from truing.published import compare_one, same_run
from truing.report.equations import equation_of
from truing.runs.documents import clean
from truing.setup import Setup
from truing.studies.bench import Progress
from truing.studies.checks import check_name
from truing.units import unit_text


def of_result(setup: Setup, offer: Offer, name: str, progress: Progress) -> dict[str, Any]:
    """Explain one result under a setup; studies are run as far as the result needs them."""
    model = setup.model
    item, study = model.result_fields[name], study_of(model, name)
    calculation = calculate(replace(setup, studies=_needed(setup, study)), progress=progress)
    answers = calculation.answers
    links = made_from(model)
    direct, further = following(links, name)
    known = {**model.read_inputs(setup.inputs), **answers}
    return {
        **_declared(item),
        **amount(setup, name, answers.get(name)),
        "study": study,
        "formula": formula_of(setup, answers, item),
        "made_from": [item_of(setup, source, known.get(source)) for source in links.get(name, ())],
        "chain": [
            {**item_of(setup, source, known.get(source)), "depth": depth, "again": again}
            for depth, source, again in chain(links, name)
        ],
        "followed_by": list(direct),
        "then": list(further),
        **_moved_by(setup, item, answers.get(name), progress),
        "limits": list(_limits(setup, name, calculation, {*direct, *further})),
        "published": list(_published(setup, offer, name, calculation)),
        "effects": _effects(setup, name, study, links),
        "sections": [section.title for section in model.sheet if name in section.names],
    }


def study_of(model: Model[Any, Any], name: str) -> str:
    """Return the study that gives a result, or nothing where the calculation itself does."""
    return next((study for study, fields in model.study_result_fields.items() if name in fields), "")


def _needed(setup: Setup, study: str) -> tuple[Study, ...]:
    """Return the studies up to the one that gives a result, as the setup asks for them."""
    names = [each.name for each in setup.studies]
    return tuple(setup.studies[: names.index(study) + 1]) if study in names else ()


def _declared(item: ResultField) -> dict[str, Any]:
    return {
        "symbol": symbol_text(item.symbol) if item.symbol else "",
        "note": item.spec.note,
        "along": "" if isinstance(item.spec, Axis) else item.along,
        "method": getattr(item.spec, "method", ""),
        "source": getattr(item.spec, "source", ""),
    }


def formula_of(setup: Setup, answers: Mapping[str, Any], item: ResultField) -> dict[str, Any] | None:
    """Return the formula of a result as text: in symbols, with numbers, and the result; None where it has none."""
    equation = equation_of(setup, answers, item)
    if equation is None:
        return None
    writer, formula = TextWriter(), equation.formula
    symbols = dict(equation.symbols)
    numbers = ""
    if equation.numbers is not None and formula.names and formula.left is None:
        numbers = substituted(writer, formula, equation.numbers)
    shown = [with_unit(pretty(value.text), value.unit) for value in equation.results if value.text != ABSENT]
    return {
        "text": formula.text,
        "left": "" if formula.left is not None else writer.symbol(item.symbol) if item.symbol else item.name,
        "symbols": symbolic(writer, formula, symbols),
        "numbers": numbers,
        "results": shown,
        "departs": equation.departs,
    }


def _moved_by(setup: Setup, item: ResultField, answer: Any, progress: Progress) -> dict[str, Any]:
    """Say what moves the result: its scatter by source, and the change per one per cent of each input."""
    name = item.name
    if name not in setup.model.own_result_fields:
        return {"scatter": None, "slopes": [], "remarks": []}
    found = influences(setup, {name: answer}, differentiable(setup), progress=progress)
    of = found.of[name]
    scatter = None
    if found.sd[name] > 0:
        scatter = {
            "sd": step_text(setup, name, found.sd[name]),
            "shares": [{"name": one.source, "share": one.share, **_because(setup, one.source)} for one in by_share(of)],
        }
    return {
        "scatter": scatter,
        "slopes": [slope_row(setup, name, one) for one in by_slope(of)],
        "remarks": list(found.warnings),
    }


def _because(setup: Setup, source: str) -> dict[str, Any]:
    """Name the tolerance that lets a source scatter, and its spread."""
    names = [name for name, inner in setup.distributions().items() if source in inner]
    return {"tolerances": names, "spread": ", ".join(setup.spread_of(name).text for name in names)}


def slope_row(setup: Setup, result: str, one: Influence) -> dict[str, Any]:
    """Say what one per cent of a source (one kelvin of a temperature) does to a result."""
    return {
        "name": one.source,
        "change": step_text(setup, result, one.step),
        "percent": None if one.relative is None else 100 * one.relative,
    }


def _limits(setup: Setup, name: str, calculation: Calculation, below: set[str]) -> Iterator[dict[str, Any]]:
    """Say the limits and goals on a result and on those ``below`` it, and those that it sets for others."""
    requires = [item for item in setup.model.objectives if isinstance(item, Require)]
    checks = {check.name: check for check in calculation.checks}
    for item in sorted(setup.model.objectives, key=lambda item: getattr(item, "result", "") != name):
        if isinstance(item, (Minimise, Maximise)) and item.result == name:
            yield {
                "says": "should be small" if isinstance(item, Minimise) else "should be large",
                "check": None,
            }
        if isinstance(item, Require) and (name in {item.result, item.limit, item.reliability} or item.result in below):
            check = checks.get(check_name(item, requires))
            yield {"says": require_words(item, name), "check": None if check is None else check_data(check)}


def require_words(item: Require, name: str) -> str:
    """Write a requirement: at most 80 MPa, with reliability 0.99; named by its result where that is another."""
    subject = "" if item.result == name else f"{item.result} "
    goal = f", with reliability {item.reliability}" if item.reliability is not None else ""
    return f"{subject}{item.kind.replace('_', ' ')} {item.limit}{goal}"


def check_data(check: Any) -> dict[str, Any]:
    """Return value, limit, margin and verdict of a check."""
    named = ("value", "limit", "unit", "margin", "compared", "relation", "state", "passed", "undecided")
    return {key: clean(getattr(check, key)) for key in named}


def _published(setup: Setup, offer: Offer, name: str, calculation: Calculation) -> Iterator[dict[str, Any]]:
    """Put what the source prints of a result beside ours, each under the settings that it holds for.

    Ours is None for a result of a study under other settings: to verify these takes whole runs.
    """
    study = study_of(setup.model, name)
    for item in setup.model.published:
        if item.result != name:
            continue
        wanted = setup_from_settings(offer, item.settings)
        compared = None
        if not study:
            compared = compare_one(item, calculate(replace(wanted, studies=())))
        elif same_run(setup, wanted) and _needed(setup, study) == _needed(wanted, study):
            compared = compare_one(item, calculation)
        yield {
            "name": item.name, "where": item.where, "settings": dict(item.settings), "unit": unit_text(item.unit),
            "paper": item.value, "ours": None if compared is None else compared.value, "verdict": item.verdict,
            "why": item.why,
        }  # fmt: skip


def _effects(setup: Setup, name: str, study: str, links: Mapping[str, Sequence[str]]) -> list[dict[str, Any]]:
    """Name the model's own effects that change a result (of a study: a result that it names), the largest first."""
    model = setup.model
    names = (
        [name]
        if name in model.own_result_fields
        else [one for one in links.get(name, ()) if one in model.own_result_fields]
    )
    found = all_touched(setup) if names else {}
    on = {item.effect.name for item in setup.effects}
    return [
        {"name": effect, "acts_on": model.effects[effect].place, "on": effect in on,
         "looks_like": model.effects[effect].looks_like}
        for effect in effects_on(found, names)
    ]  # fmt: skip
