"""The fields of a model's inputs file, group by group: what each is, its units, bounds and default."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import MISSING, asdict, dataclass, field
from functools import lru_cache
from inspect import signature
from typing import Any, Literal, get_args, get_origin

from truing.declare.fields import Given, InputField, Loaded
from truing.declare.model import Model, Study
from truing.declare.sources import Effect, Unknown
from truing.errors import UnitError
from truing.example_file import example_text
from truing.example_groups import groups
from truing.formulas import symbol_text
from truing.formulas.symbols import printable
from truing.formulas.write_mathml import symbol_mathml
from truing.inputs_file.assemble import default_of, spread_text, toml_value
from truing.inputs_file.entries import DETAILS, HEAD, PAPERS
from truing.inputs_file.study_options import options_of
from truing.inputs_file.values import plain
from truing.kernel import Offer
from truing.setup import DEFAULT_SEED
from truing.templating import ENGLISH, languages
from truing.units import demand_dimension, unit_text
from truing.units.names import PURE
from truing.units.systems import UNIT_SYSTEMS

Kind = Literal["quantity", "number", "text", "choice", "switch", "toml", "file", "tolerance", "list"]
"""``toml``: what a text may be or hold as TOML, such as a list; ``list``: names of a few that are ticked, in order."""
SIGNS = (("above", "> "), ("at_least", "≥ "), ("below", "< "), ("at_most", "≤ "))
MENU = (
    "nm um mm cm m km in ft", "urad mrad rad arcsec arcmin deg", "us ms s min h d", "mg g kg t lb", "mN N kN MN lbf",
    "Pa kPa MPa GPa bar psi ksi", "N*mm N*m kN*m lbf*in lbf*ft", "J kJ kW*h", "W kW hp", "degC degF K mK delta_degF",
    "mm/s m/s m/min km/h", "rpm Hz kHz 1/min 1/h 1/s", "rad/s deg/s", "m/s^2 mm/s^2", "mm^2 cm^2 m^2 in^2",
    "mm^3 cm^3 l m^3", "um/(m*K) 1/K", "N/m N/mm N/um kN/mm lbf/in", "m/N um/N 1/GN 1/N", "g*cm^2 kg*cm^2 kg*m^2",
    "mPa*s Pa*s", "mm^2/s cSt", "kg/m^3 g/cm^3 lb/in^3", "um/m mm/m %", "mA A", "mV V", "1/Pa 1/GPa", "W/(m*K)",
    "N*s/m", "rpm/s rad/s^2",
)  # fmt: skip
"""Units that a menu offers beside the declared one, those that measure the same: what workshops and catalogues use."""
TOLERANCE_WORDS = ("±0.05 mm", "sd 3 %", "IT6", "IT7", "off")
DIAGNOSE_OPTIONS = {"per_file": "toml", "hold_out": "text", "lognormal": "toml", "budget": "toml"}
"""Of what may be asked of a diagnosis, what fits a field; the rest is stated in the text."""


@dataclass(frozen=True)
class Field:
    """One value of an inputs file as the form asks for it.

    ``symbol`` is MathML; ``default`` what holds where nothing is stated, as it would be typed; ``units`` the menu,
    empty where there is nothing to choose; ``is_required``: it must be stated, so there is nothing to reset to.
    """

    path: tuple[str, ...]
    label: str
    kind: Kind
    symbol: str = ""
    search: str = ""
    unit: str = ""
    units: tuple[tuple[str, str], ...] = ()
    default: str = ""
    bounds: str = ""
    hint: str = ""
    choices: tuple[str, ...] = ()
    is_required: bool = False

    @property
    def key(self) -> str:
        """The path as one text."""
        return "/".join(self.path)

    @property
    def as_json(self) -> dict[str, Any]:
        """Every property by name."""
        search = " ".join((self.path[-1], self.path[-1].replace("_", " "), self.label, self.search)).lower()
        shown = unit_text(self.unit) if self.unit not in PURE else ""
        return {**asdict(self), "key": self.key, "name": self.path[-1], "search": search, "unit_shown": shown}


@dataclass(frozen=True)
class Part:
    """Fields that belong together, below a heading of their own where they have a title; an effect has a switch."""

    fields: Sequence[Field]
    title: str = ""
    text: str = ""
    path: tuple[str, ...] = ()
    has_switch: bool = False

    @property
    def as_json(self) -> dict[str, Any]:
        """Every property by name."""
        shown = {"title": self.title, "text": self.text, "has_switch": self.has_switch, "name": (*self.path, "")[-1]}
        return {
            **shown,
            "path": self.path,
            "key": "/".join(self.path),
            "fields": [each.as_json for each in self.fields],
        }


@dataclass(frozen=True)
class FieldGroup:
    """What is folded together."""

    title: str
    parts: Sequence[Part] = field(default_factory=tuple)
    text: str = ""


def groups_of(offer: Offer) -> list[FieldGroup]:
    """Return the fields of a calculation in groups, those of the inputs as the example has them."""
    model = offer.model
    made = [*_inputs(offer), _tolerances(model), _effects(model), _conditions(model), _studies(model), _sheet()]
    return [group for group in made if any(part.fields or part.has_switch for part in group.parts)]


def _inputs(offer: Offer) -> Iterator[FieldGroup]:
    fields = offer.model.input_fields
    for group in groups(example_text(offer), list(fields)):
        made = [each for name in group.names for each in _input(fields[name], group.remarks.get(name, ""))]
        yield FieldGroup(group.title or "Inputs", (Part(made),), group.text)


def _input(declared: InputField, remark: str) -> Iterator[Field]:
    kinds: dict[str, Kind] = {
        "float": "number" if declared.unit in PURE else "quantity", "whole": "number" if declared.unit in PURE else
        "quantity", "integer": "number", "switch": "switch", "choice": "choice", "text": "text", "series": "toml",
        "file": "file",
    }  # fmt: skip
    default, spec = default_of(declared), declared.spec
    source = f"source: {spec.source}" if spec.source else ""
    yield Field(
        ("inputs", declared.name), printable(spec.note) or declared.name, kinds[declared.kind],
        **_symbol(declared.symbol), unit=declared.unit, units=menu(declared.unit) if kinds[declared.kind] == "quantity"
        else (), default=_typed(default), bounds=_bounds(spec), choices=tuple(declared.choices),
        hint="; ".join(filter(None, (remark, printable(source), _like(declared)))),
        is_required=declared.kind == "file" and spec.default is MISSING,
    )  # fmt: skip
    if isinstance(spec, Loaded):
        for option in list(signature(spec.reader).parameters)[1:]:
            yield Field(
                ("inputs", declared.name, option), f"{declared.name}: {option}", "toml", hint="option of the file"
            )


def _like(declared: InputField) -> str:
    if declared.kind == "series":
        return f'a list: ["1 {declared.unit}", "2 {declared.unit}"]' if declared.unit not in PURE else "a list: [1, 2]"
    return ""


def _symbol(symbol: str) -> dict[str, Any]:
    return {"symbol": symbol_mathml(symbol), "search": symbol_text(symbol)} if symbol else {}


def _typed(value: Any) -> str:
    """Return a value as it is typed in a field."""
    if value is None or value == []:
        return ""
    return value if isinstance(value, str) else toml_value(value)


def _bounds(spec: Any) -> str:
    """Return declared bounds in signs: "> 0, < 30 m"."""
    if not isinstance(spec, Given):
        return ""
    unit = "" if (spec.unit or "") in PURE else f" {unit_text(spec.unit or '')}"
    said = ", ".join(f"{sign}{plain(getattr(spec, name))}" for name, sign in SIGNS if getattr(spec, name) is not None)
    return "; ".join(filter(None, (f"{said}{unit}" if said else "", "a whole number" if spec.whole else "")))


@lru_cache(maxsize=512)
def menu(unit: str) -> tuple[tuple[str, str], ...]:
    """Return the units that measure the same as a declared one, that first: as typed, and as shown."""
    if unit in PURE:
        return ()
    names = [unit, *(name for row in MENU for name in row.split() if name != unit and _is_alike(name, unit))]
    shown = {unit_text(name): name for name in reversed(names)}
    return tuple((name, unit_text(name)) for name in names if shown[unit_text(name)] == name) if len(shown) > 1 else ()


def _is_alike(name: str, unit: str) -> bool:
    try:
        demand_dimension(name, unit)
    except UnitError:
        return False
    return True


def _tolerances(model: Model[Any, Any]) -> FieldGroup:
    defaults = {name: default_of(field) for name, field in model.input_fields.items()}
    fields = [
        Field(
            ("tolerances", name), name if tolerance.on == (name,) else f"{name}, on {', '.join(tolerance.on)}",
            "tolerance", **_symbol_of(model, tolerance.on), default=spread_text(tolerance.spread, defaults),
            hint=printable("; ".join(filter(None, (tolerance.why, tolerance.source)))),
        )
        for name, tolerance in model.tolerances.items()
    ]  # fmt: skip
    text = "How inputs scatter: ±0.05 mm, sd 3 %, band 0.125 mm, a grade such as IT6, or off."
    return FieldGroup("Tolerances", (Part(fields),), text)


def _symbol_of(model: Model[Any, Any], on: Sequence[str]) -> dict[str, Any]:
    declared = model.input_fields.get(on[0]) if len(on) == 1 else None
    return _symbol(declared.symbol) if declared is not None else {}


def _effects(model: Model[Any, Any]) -> FieldGroup:
    parts = [_effect(effect) for effect in model.effects.values()]
    return FieldGroup("Effects", parts, "What the calculation leaves out unless it is switched on.")


def _effect(effect: Effect[Any, Any]) -> Part:
    path = ("effects", effect.name)
    needs = f"needs {', '.join(need.name for need in effect.needs)}" if effect.needs else ""
    words = "; ".join(filter(None, (effect.why, effect.looks_like, needs)))
    fields = [
        Field(
            (*path, unknown.name), printable(unknown.note) or unknown.name, _kind(unknown.unit), unit=unknown.unit,
            units=menu(unknown.unit), bounds=_unknown_bounds(unknown), is_required=not effect.parts, search=effect.name,
        )
        for unknown in effect.unknowns
    ]  # fmt: skip
    return Part(fields, effect.name.replace("_", " "), printable(words), path, has_switch=True)


def _kind(unit: str) -> Kind:
    return "number" if unit in PURE else "quantity"


def _unknown_bounds(unknown: Unknown) -> str:
    bounds = f"≥ {plain(unknown.low)}, ≤ {plain(unknown.high)} {unit_text(unknown.unit)}".strip()
    return f"{bounds}; a whole number" if unknown.whole else bounds


def _conditions(model: Model[Any, Any]) -> FieldGroup:
    fields = [
        Field(
            ("conditions", name), printable(condition.note) or name, _kind(condition.unit), unit=condition.unit,
            units=menu(condition.unit),
            default=f"{plain(condition.reference)} {condition.unit if condition.unit not in PURE else ''}".strip(),
        )
        for name, condition in model.known_conditions.items()
    ]  # fmt: skip
    return FieldGroup("Conditions", (Part(fields),), "What is measured but no input; at these values effects vanish.")


def _studies(model: Model[Any, Any]) -> FieldGroup:
    names = [study.name for study in model.studies]
    run = Field(("studies", "run"), "Studies that run", "list", default=", ".join(names), choices=tuple(names))
    seed = Field(("studies", "seed"), "Random numbers begin with", "number", default=str(DEFAULT_SEED), bounds="≥ 0")
    parts = [Part([run, seed] if names else [seed]), *(_study(study) for study in model.studies)]
    if "diagnose" not in names:
        words = {"per_file": "a list: effects and inputs that every file has for itself",
                 "hold_out": "rows that only judge: record = validation", "lognormal": "a list: results whose errors "
                 "are in proportion", "budget": "calls of the model, at most; 0: as many as there is time"}  # fmt: skip
        kinds: Any = DIAGNOSE_OPTIONS
        options = [Field(("studies", "diagnose", name), words[name], kinds[name], search="diagnose") for name in words]
        parts.append(Part(options, "diagnose", "What is asked of a diagnosis.", ("studies", "diagnose")))
    return FieldGroup("Studies", parts)


def _study(study: Study) -> Part:
    summary = (type(study).__doc__ or "").strip().splitlines()
    fields = [_option(study, name, hint) for name, hint in options_of(study).items()]
    title = study.name.replace("_", " ")
    return Part(fields, title, printable(summary[0]) if summary and fields else "", ("studies", study.name))


def _option(study: Study, name: str, hint: Any) -> Field:
    """Return an option of a study; what is more than a text, a number or a choice is typed as TOML."""
    path, value = ("studies", study.name, name), getattr(study, name)
    label = name.replace("_", " ")
    if hint is bool:
        return Field(path, label, "switch", default=_typed(bool(value)), search=study.name)
    if get_origin(hint) is Literal:
        return Field(
            path, label, "choice", default=str(value), choices=tuple(map(str, get_args(hint))), search=study.name
        )
    known = isinstance(value, (str, int, float)) or (
        isinstance(value, (list, tuple)) and all(isinstance(each, (str, int, float)) for each in value)
    )
    shown = _typed(list(value) if isinstance(value, tuple) else value) if known else ""
    return Field(path, label, "text" if hint is str else "toml", default=shown, search=study.name)


def _sheet() -> FieldGroup:
    choices = {"detail": DETAILS, "paper": PAPERS, "units": UNIT_SYSTEMS, "language": tuple(languages())}
    said = {"detail": "how much the sheet shows", "paper": "what it is printed on",
            "units": "of all that people read; as declared without it", "language": "of the sheet"}  # fmt: skip
    default = {"detail": "normal", "paper": "A4", "units": "", "language": ENGLISH}
    fields = [
        Field(("sheet", name), name.replace("_", " ").capitalize(), "text", hint=words) for name, words in HEAD.items()
    ]
    fields += [
        Field(
            ("sheet", name), name.capitalize(), "choice", default=default[name], choices=tuple(names), hint=said[name]
        )
        for name, names in choices.items()
    ]
    return FieldGroup("Head of the sheet", (Part(fields),))
