"""What pages of models are written with, and the tables of all models and all effects: as ``calc describe`` says it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from manual.places import SITE
from truing.describe import LONGEST_SERIES, description
from truing.formulas import symbol_mathml
from truing.kernel import Kernel, Offer
from truing.units import unit_text

BOUNDLESS = 1e5
"""A bound of an unknown beyond this, in its unit, only keeps the search finite."""

_SIGNS = {"above": ">", "below": "<", "at least": "≥", "at most": "≤"}
_BOUND = re.compile(r"(^|, )(above|below|at least|at most) (?=[-\d.])")


@lru_cache(maxsize=1)
def offers() -> Mapping[str, Offer]:
    """Return every model that is installed; a broken plugin ends the build."""
    return Kernel.installed(strict=True).offers


def list_of_models() -> str:
    """Return the table that stands on the first page of the models."""
    return environment().get_template("models.md.j2").render(models=[description(one) for one in offers().values()])


def list_of_effects() -> str:
    """Return the table of the effects of all models."""
    models = [description(one) for one in offers().values()]
    return environment().get_template("effects.md.j2").render(models=models)


@lru_cache(maxsize=1)
def environment() -> Environment:
    """Return the templates of made pages; what is put in is escaped."""
    made = Environment(
        loader=FileSystemLoader(SITE / "pages"), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    made.filters |= {
        "symbol": _symbol, "unit": _unit, "sentence": _sentence, "number": _number, "bounds": _bounds_in_signs,
        "unknown_bounds": _bounds,
    }  # fmt: skip
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


def _bounds_in_signs(text: str) -> str:
    """Write "above 0, at most 1" as "> 0, ≤ 1"."""
    return _BOUND.sub(lambda item: f"{item[1]}{_SIGNS[item[2]]} ", text)


def _bounds(unknown: Mapping[str, Any]) -> str:
    low, high = unknown["low"], unknown["high"]
    return "any" if min(-low, high) >= BOUNDLESS else f"{low:g} … {high:g}"
