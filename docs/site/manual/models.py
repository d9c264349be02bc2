"""The pages of models and the table of all effects, from what ``calc describe`` says and nothing else."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from manual.places import DOCS, SITE, place_in_site
from truing.declare.model import formula_scope
from truing.describe import LONGEST_SERIES, description
from truing.formulas import parse, symbol_mathml
from truing.formulas.write_mathml import MATHML
from truing.inputs_file import json_schema
from truing.kernel import Kernel, Offer
from truing.report import equations
from truing.report.document import Equation
from truing.units import unit_text

BOUNDLESS = 1e5
"""A bound of an unknown beyond this, in its unit, only keeps the search finite."""


@lru_cache(maxsize=1)
def offers() -> Mapping[str, Offer]:
    """Return every model that is installed; a broken plugin ends the build."""
    return Kernel.installed(strict=True).offers


def pages() -> dict[str, str]:
    """Return the page of every model and the schema of its inputs files, by their places in the site."""
    template = environment().get_template("model.md.j2")
    found = {}
    for name, offer in offers().items():
        said = description(offer)
        found[f"reference/models/{name}.md"] = template.render(
            said=said, formulas=_formulas(offer), explanation=_explanation(offer), unknown_bounds=_bounds
        )
        found[f"reference/models/{name}.schema.json"] = json.dumps(json_schema(offer), indent=1, ensure_ascii=False)
    return found


def list_of_models() -> str:
    """Return the table that stands on the first page of the models."""
    return environment().get_template("models.md.j2").render(models=[description(one) for one in offers().values()])


def list_of_effects() -> str:
    """Return the table of the effects of all models."""
    models = [description(one) for one in offers().values()]
    return environment().get_template("effects.md.j2").render(models=models, unknown_bounds=_bounds)


@lru_cache(maxsize=1)
def environment() -> Environment:
    """Return the templates of made pages; what is put in is escaped."""
    made = Environment(
        loader=FileSystemLoader(SITE / "pages"), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    made.filters |= {"symbol": _symbol, "unit": _unit, "sentence": _sentence, "number": _number}
    return made


def _symbol(symbol: str) -> Markup:
    return Markup(f"<math>{symbol_mathml(symbol)}</math>") if symbol else Markup("")


def _unit(unit: str) -> str:
    return unit_text(unit)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".") if text else ""


def _number(value: Any) -> str:
    """Write a declared value as it would be typed."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        if len(value) > LONGEST_SERIES:
            return f"{_number(value[0])} … {_number(value[-1])}, {len(value)} values"
        return ", ".join(_number(item) for item in value)
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def _bounds(unknown: Mapping[str, Any]) -> str:
    low, high = unknown["low"], unknown["high"]
    return "any" if min(-low, high) >= BOUNDLESS else f"{low:g} … {high:g}"


def _formulas(offer: Offer) -> dict[str, Markup]:
    """Return the formula of every result that has one, in symbols, in lines that fit."""
    found = {}
    for name, item in offer.model.result_fields.items():
        text = getattr(item.spec, "formula", "")
        if not text:
            continue
        formula = parse(text)
        fields = {key: field for key, field in formula_scope(offer.model, item).items() if key in formula.names}
        symbols = {key: field.symbol for key, field in fields.items() if field.symbol}
        equation = Equation(formula, item.name, item.symbol, symbols, numbers=None, results=())
        lines = equations.lines(MATHML, equation)
        found[name] = Markup("").join(Markup(f'<math displaystyle="true">{line.markup}</math>') for line in lines)
    return found


def _explanation(offer: Offer) -> str:
    """Return the page that explains the theory of a model, seen from its own page; nothing where there is none."""
    page = DOCS / "explanation" / f"{offer.origin.name}.md"
    return f"../../{place_in_site(page)}" if page.is_file() else ""
