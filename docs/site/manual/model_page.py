"""The page of a model: what it is for and shows, then inputs, results, effects and sources, the long parts folded."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from markupsafe import Markup
from pymdownx.slugs import slugify

from manual import gallery
from manual.families import Family, families
from manual.models import environment, offers
from manual.places import DOCS, place_in_site
from truing.declare.model import Model, formula_scope
from truing.describe import description
from truing.example_groups import Group, groups
from truing.formulas import parse
from truing.formulas.write_mathml import MATHML
from truing.inputs_file import json_schema
from truing.kernel import Offer
from truing.numbers import format_number
from truing.report import equations
from truing.report.document import Equation
from truing.units import unit_text

CHAPTERS = ("inputs", "results", "tolerances", "effects", "conditions", "goals", "studies", "sources")
"""Anchors of the chapters, which a section of the sheet may not take."""
RELATIONS = {"at_most": "≤", "at_least": "≥"}
"""Kinds of limits, by their sign; any other is called by its name."""
MOST_RESULTS = 100
"""The sections of a model with more results are folded, so that its page stays within a dozen screens."""
_DRAWING = re.compile(r'<div class="drawing">(<svg .*?</svg>)', re.DOTALL)


def pages() -> dict[str, str]:
    """Return the page of every model, the schema of its inputs files and its figure, by their places in the site."""
    result = {}
    shown = {sheet.plugin: sheet.name for sheet in reversed(gallery.sheets()) if not sheet.data}
    for name, offer in offers().items():
        folder = gallery.folders()[shown[name]] if name in shown else None
        figure = _DRAWING.search((folder / "sheet.html").read_text(encoding="utf-8")) if folder else None
        result[f"reference/models/{name}.md"] = _page(offer, shown.get(name, ""), folder, has_figure=bool(figure))
        result[f"reference/models/{name}.schema.json"] = json.dumps(json_schema(offer), indent=1, ensure_ascii=False)
        if figure:
            result[f"reference/models/{name}.svg"] = figure[1]
    return result


def _page(offer: Offer, sheet: str, folder: Path | None, *, has_figure: bool) -> str:
    said = description(offer)
    shown = json.loads((folder / "results.json").read_text(encoding="utf-8")) if folder else {}
    sections = _sections(offer.model, said)
    return environment().get_template("model.md.j2").render(
        said=said, groups=_groups(offer, said), sections=sections, formulas=_formulas(offer), sheet=sheet,
        has_figure=has_figure, limits=_limits(said, shown), keys=_keys(offer.model, said, shown),
        explanation=_explanation(offer), verdicts=Counter(item["verdict"] for item in said["published"]),
        states=said.get("states", ()), rates=_rates(offer.model), events=said.get("events", ()),
        is_long=len(said["results"]) > MOST_RESULTS,
    )  # fmt: skip


def _groups(offer: Offer, said: Mapping[str, Any]) -> list[tuple[Group, str, list[Family]]]:
    """Return the inputs in the groups of the example, each with its anchor."""
    inputs = {item["name"]: item for item in said["inputs"]}
    example = offer.model.example
    parted = groups(example.read_text(encoding="utf-8") if example else "", inputs)
    return [
        (group, f"inputs-{_slug(group.title)}", families(offer.model, [inputs[name] for name in group.names]))
        for group in parted
    ]


def _sections(model: Model[Any, Any], said: Mapping[str, Any]) -> list[tuple[str, str, bool, list[Family]]]:
    """Return the results by the sections of the sheet: title, anchor, whether only a full sheet has it, results.

    A result stands in the first section that names it; what none names comes last.
    """
    left = {item["name"]: item for item in said["results"]}
    taken = {*CHAPTERS, *(effect["name"] for effect in said["effects"])}
    sections = []
    for section in model.sheet:
        results = [left.pop(name) for name in section.names if name in left]
        slug = _slug(section.title)
        anchor = f"results-{slug}" if slug in taken else slug
        if results:
            sections.append((section.title, anchor, section.level == "full", families(model, results)))
    if left:
        sections.append(("Others", "results-others", False, families(model, left.values())))
    return sections


def _slug(title: str) -> str:
    return str(slugify(case="lower")(title, "-"))


def _limits(said: Mapping[str, Any], shown: Mapping[str, Any]) -> list[dict[str, str]]:
    """Return what the model requires, with what became of it in the sheet of the gallery where there is one.

    The name of a check is that of its result, with the kind of limit behind it where there are several.
    """
    notes = {item["name"]: item["note"] for item in said["results"]}
    if not shown:
        return [
            {"name": goal["result"], "compared": goal["result"], "value": "", "state": "", "proposed": "",
             "limit": f"{RELATIONS.get(goal['limit_kind'], goal['limit_kind'])} {goal['limit']}",
             "note": notes.get(goal["result"], "")}
            for goal in said["objectives"] if goal["kind"] == "require"
        ]  # fmt: skip
    return [
        {"name": check["name"].partition(" ")[0], "compared": check["compared"], "state": check["state"],
         "value": _with_unit(check["value"], check["unit"]), "proposed": _with_unit(check["proposed"], check["unit"]),
         "limit": f"{check['relation']} {_with_unit(check['limit'], check['unit'])}",
         "note": notes.get(check["name"].partition(" ")[0], "")}
        for check in shown["checks"]
    ]  # fmt: skip


def _keys(model: Model[Any, Any], said: Mapping[str, Any], shown: Mapping[str, Any]) -> list[tuple[Any, str]]:
    """Return the results that stand on page one of a sheet, each with its value there where it is one number."""
    found = []
    for item in said["results"]:
        if getattr(model.result_fields[item["name"]].spec, "key", False):
            value = shown.get("results", {}).get(item["name"], {}).get("value")
            text = _with_unit(value, item["unit"]) if isinstance(value, (int, float)) else ""
            found.append((item, text))
    return found


def _with_unit(value: float | None, unit: str) -> str:
    return "" if value is None else f"{format_number(value)} {unit_text(unit)}".strip()


def _formulas(offer: Offer) -> dict[str, Markup]:
    """Return the formula of every result that has one, in symbols, in lines that fit."""
    result = {}
    for name, item in offer.model.result_fields.items():
        text = getattr(item.spec, "formula", "")
        if text:
            formula = parse(text)
            fields = {key: field for key, field in formula_scope(offer.model, item).items() if key in formula.names}
            symbols = {key: field.symbol for key, field in fields.items() if field.symbol}
            result[name] = _set(Equation(formula, item.name, item.symbol, symbols, numbers=None, results=()))
    return result


def _rates(model: Model[Any, Any]) -> dict[str, Markup]:
    """Return the equation of every state that declares one."""
    names = model.dynamics.state_fields if model.dynamics else ()
    made = {name: equations.state_equation(model, name) for name in names}
    return {name: _set(equation) for name, equation in made.items() if equation is not None}


def _set(equation: Equation) -> Markup:
    lines = equations.lines(MATHML, equation)
    return Markup("").join(Markup(f'<math displaystyle="true">{line.markup}</math>') for line in lines)


def _explanation(offer: Offer) -> str:
    """Return the page that explains the theory of a model, seen from its own page; nothing where there is none."""
    page = DOCS / "explanation" / f"{offer.origin.name}.md"
    return f"../../{place_in_site(page)}" if page.is_file() else ""
