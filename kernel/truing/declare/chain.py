"""Calculations that call one another: a chain of them is a model again, made of the declarations of all.

The calculation at the end keeps its names. Every other one, a source, has its own name before each of its flat names:
``power`` of ``rv_gearing`` is ``rv_gearing_power``. Inputs and results of the chain are those of the last calculation
with one part more for each source. An input that is taken from a source is NaN until it is filled; one that is stated
all the same keeps what is stated, as a measured column does. A calculation may stand in a chain more than once, each
time as a source with a name of its own.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeVar

import numpy as np

from truing.declare.batch import FailedRows, either, feasible, reasons_of_part
from truing.declare.correlations import Correlated
from truing.declare.dynamics import Dynamics
from truing.declare.fields import (
    BESIDE,
    KEY,
    Given,
    InputField,
    Part,
    ResultField,
    hints_of,
    make,
    read,
    spec_of,
    with_values,
)
from truing.declare.goals import Objective, PriceByChoice, Require, Vary
from truing.declare.model import Model, Record, Section
from truing.declare.near_miss import near_miss
from truing.declare.remembered import OF_SOURCES, answered_before
from truing.declare.sources import ActsOn, Condition, Effect, ErrorSource, Tolerance
from truing.declare.spreads import Band, ByChoice, Drawn, Grade, Spread
from truing.declare.taken import Taken
from truing.errors import DeclarationError
from truing.units import human_dimension, same_dimension, to_si, unit_text
from truing.units.names import LEVELS

AnyModel = Model[Any, Any]
CARRIED: Final = "_carried"
"""The field of the inputs of a chain that holds what is ``Carried``."""


@dataclass(frozen=True)
class Link:
    """``input`` of the calculation ``owner`` ("" is the last one) is ``result`` of the calculation ``source``.

    ``result`` is a result of that one, or an input that both share. ``model`` is the calculation that ``source`` is,
    where that goes by a name of its own.
    """

    owner: str
    input: str
    source: str
    result: str
    model: str = ""

    @property
    def calculation(self) -> str:
        """The source as the command line knows it."""
        return self.model or self.source


def link_to(name: str, taken: Taken) -> Link:
    """Return the link by which an input of the last calculation is what was taken from another one."""
    own_name = taken.called not in {"", taken.model}
    return Link("", name, taken.called or taken.model, taken.result, taken.model if own_name else "")


def declared_links(model: AnyModel) -> tuple[list[Link], dict[str, dict[str, Any]]]:
    """Return the links that a model declares by ``from_model``, and what it states of its sources, by source."""
    links: list[Link] = []
    settings: dict[str, dict[str, Any]] = {}
    for name, field in model.input_fields.items():
        taken = getattr(field.spec, "taken", None)
        if taken is not None:
            links.append(link := link_to(name, taken))
            settings.setdefault(link.source, {}).update(taken.settings)
    return links, settings


def prefix_of(name: str) -> str:
    """Return what stands before the flat names of a source: "" for the last calculation."""
    return f"{_attribute(name)}_" if name else ""


def _attribute(name: str) -> str:
    return name.replace(".", "_")


@dataclass(frozen=True)
class Chain:
    """What a chain is made of: the last calculation, its sources by name in the order of calculation, and the links.

    ``settings`` holds inputs of sources, by source and flat name, that are stated where they are named.
    """

    last: AnyModel
    sources: Mapping[str, AnyModel]
    links: tuple[Link, ...]
    settings: Mapping[str, Mapping[str, Any]] = dataclasses.field(default_factory=dict)

    def model_of(self, name: str) -> AnyModel:
        """Return a calculation of the chain: that of a source, or the last one for ""."""
        return self.sources[name] if name else self.last

    @functools.cached_property
    def taken(self) -> dict[str, Link]:
        """Every link by the flat name that its input has in the chain."""
        return {prefix_of(link.owner) + link.input: link for link in self.links}

    def field_of(self, link: Link) -> Any:
        """Return the result, or the shared input, that a link takes, as its own calculation declares it."""
        source = self.sources[link.source]
        return source.own_result_fields.get(link.result) or source.input_fields[link.result]

    def inputs_of(self, inputs: Any, name: str) -> Any:
        """Return the inputs of one calculation from those of the chain."""
        return getattr(inputs, _attribute(name)) if name else inputs

    @functools.cached_property
    def calculations(self) -> dict[str, AnyModel]:
        """Every calculation that stands behind a source, once, by the name that the command line knows."""
        return {link.calculation: self.sources[link.source] for link in self.links}

    def name_in_words(self, name: str) -> str:
        """Return how a calculation is called, and which one it is where it goes by a name of its own."""
        own = self.model_of(name).name
        calculation = next((link.model for link in self.links if link.source == name), "")
        return f"{name}, {calculation}" if calculation else name or own

    def filled(self, inputs: Any, upto: str = "") -> Any:
        """Return the inputs of the chain with all that one calculation, and those before it, take from sources.

        Sources are calculated for it, as the inputs have them, and what they answer goes along with the inputs. A row
        in which a source has no answer fails.
        """
        known: dict[str, tuple[Any, Any]] = {}
        for name in [*self.sources, ""]:
            own = self._taken_in(self.inputs_of(inputs, name), name, known)
            inputs = with_values(inputs, {(_attribute(name),): own}) if name else own
            if name == upto:
                break
            known[name] = own, self._answer_of(carried_by(inputs), name, own)
        return _carrying(inputs, replace(carried_by(inputs), known=known))

    def answers(self, inputs: Any) -> tuple[Any, dict[str, Any]]:
        """Return the inputs of the last calculation, filled, and what every source answers by attribute."""
        inputs = self.filled(inputs)
        return inputs, {_attribute(name): results for name, (_, results) in carried_by(inputs).known.items()}

    def _answer_of(self, carried: Carried, name: str, own: Any) -> Any:
        """Calculate a source, once for the same inputs, with the effects on its results that are on."""
        inputs, results = carried.known.get(name, (None, None))
        if inputs is own:
            return results
        acting = carried.acting.get(name, ())
        with reasons_of_part(prefix_of(name)) as failed:
            results = self._calculated(name, own, None if acting else failed)
        for act in acting:
            results = act(own, results)
        return results

    def _calculated(self, name: str, own: Any, failed: FailedRows | None) -> Any:
        """Calculate a source; of many rows, whose failures are noted in ``failed``, what it answered is remembered."""
        source = self.sources[name]
        values = {field.path: read(own, field.path) for field in source.input_fields.values() if failed is not None}
        if failed is None or not any(isinstance(value, np.ndarray) and value.ndim for value in values.values()):
            return source.function(own)
        rows, results = len(failed.codes), len(source.own_result_fields)
        known = answered_before(OF_SOURCES, source.function, own, values, rows=rows, results=results)
        failed.take(known.failed)
        return known.results

    def _taken_in(self, own: Any, name: str, answers: Mapping[str, tuple[Any, Any]]) -> Any:
        """Fill the inputs of one calculation with what those before it answered; what is stated stays."""
        fields, changed = self.model_of(name).input_fields, {}
        for link in self.links:
            if link.owner != name:
                continue
            field, (inputs, results) = fields[link.input], answers[link.source]
            source = self.sources[link.source]
            stated = np.asarray(read(own, field.path), dtype=float)[()]
            if not np.isnan(stated).any():
                continue
            known = source.own_result_fields.get(link.result)
            answer = read(results, known.path) if known else read(inputs, source.input_fields[link.result].path)
            value = either(stated, answer)
            _demand_fitting(field, value, link)
            changed[field.path] = value
        return with_values(own, changed) if changed else own


@dataclass(frozen=True)
class Carried:
    """What goes along with the inputs of a chain, by source: effects that act on its results, and what it answered.

    An effect is a function of inputs and results of the source. An answer holds for the inputs that stand beside it.
    """

    acting: Mapping[str, tuple[Callable[[Any, Any], Any], ...]] = dataclasses.field(default_factory=dict)
    known: Mapping[str, tuple[Any, Any]] = dataclasses.field(default_factory=dict)


NOTHING: Final = Carried()


def carried_by(inputs: Any) -> Carried:
    """Return what goes along with inputs; nothing of those of a calculation alone."""
    carried: Carried = getattr(inputs, CARRIED, NOTHING)
    return carried


def _carrying(inputs: Any, carried: Carried) -> Any:
    return with_values(inputs, {(CARRIED,): carried})


def _demand_fitting(field: InputField, value: Any, link: Link) -> None:
    """State that what was taken is a number within the bounds of the input that it stands for."""
    said = f"'{prefix_of(link.owner)}{link.input}', which is '{link.result}' of {link.source},"
    feasible(np.isfinite(value), f"{said} has no value")
    spec = field.spec
    assert isinstance(spec, Given)
    for words, bound, holds in (
        ("above", spec.above, np.greater), ("below", spec.below, np.less),
        ("at least", spec.at_least, np.greater_equal), ("at most", spec.at_most, np.less_equal),
    ):  # fmt: skip
        if bound is not None:
            limit = to_si(bound, field.unit)
            slack = 1e-12 * abs(limit) * {"at least": -1, "at most": 1}.get(words, 0)
            feasible(holds(value, limit + slack), f"{said} must be {words} {bound:g} {unit_text(field.unit)}".rstrip())
    if spec.whole:
        feasible(
            np.abs(value - np.round(value)) < 1e-9 * np.maximum(1, np.abs(value)), f"{said} must be a whole number"
        )


# What is wrong with links, each with the link that is to blame


def link_faults(last_name: str, last: AnyModel, sources: Mapping[str, AnyModel], links: Sequence[Link]
                ) -> Iterator[tuple[Link, str]]:  # fmt: skip
    """Say which links name nothing, do not fit in dimension or shape, or go round in a circle."""
    for link in links:
        owner = last if link.owner in {"", last_name} else sources.get(link.owner)
        source = last if link.source == last_name else sources.get(link.source)
        if owner is not None and source is not None:
            yield from ((link, sentence) for sentence in _of_link(link, owner, source))
    yield from _circles(last_name, links)


def _of_link(link: Link, owner: AnyModel, source: AnyModel) -> Iterator[str]:
    field = owner.input_fields.get(link.input)
    if field is None:
        yield f"{owner.name} has no input '{link.input}'.{near_miss(link.input, owner.input_fields)}"
    taken: Any = source.own_result_fields.get(link.result) or source.input_fields.get(link.result)
    if taken is None:
        yield _unknown_result(link, source)
    if field is None or taken is None:
        return
    said = f"'{link.input}' cannot be '{link.result}' of {link.source}: "
    if not field.varies:
        yield f"{said}'{link.input}' is {_kind(field)}, and only a number can be taken from another calculation"
    elif (
        taken.spec.along or (isinstance(taken, InputField) and not taken.varies) or link.result in source.axes.values()
    ):
        yield f"{said}that is {_kind(taken)}, and '{link.input}' takes one number"
    elif not same_dimension(taken.unit, field.unit):
        yield f"{said}that is {human_dimension(taken.unit)}, and '{link.input}' is {human_dimension(field.unit)}"
    elif (taken.unit in LEVELS) != (field.unit in LEVELS):
        yield f"{said}one is a temperature level and the other a difference"


def _is_series(field: InputField | ResultField) -> bool:
    return bool(field.along) if isinstance(field, ResultField) else field.kind == "series"


def _unknown_result(link: Link, source: AnyModel) -> str:
    study = next((name for name, given in source.study_result_fields.items() if link.result in given), "")
    if study:
        return (
            f"'{link.result}' of {link.source} is what its study '{study}' finds; "
            "a chain takes what the calculation itself answers"
        )
    known = [*source.own_result_fields, *source.input_fields]
    return f"{link.source} has no result '{link.result}'.{near_miss(link.result[:80], known)}"


def _kind(field: Any) -> str:
    if not isinstance(field, InputField):
        return f"a series along '{field.along}'"
    return {"series": "a series", "file": "a data file", "integer": "a whole number that does not vary",
            "switch": "a switch", "choice": "a choice", "text": "a text"}.get(field.kind, "a number")  # fmt: skip


def _circles(last_name: str, links: Sequence[Link]) -> Iterator[tuple[Link, str]]:
    """Say which links close a circle, each circle once."""
    said: set[frozenset[str]] = set()
    for link in links:
        circle = _way_back(link, link.owner or last_name, last_name, links)
        through = frozenset(each.source for each in circle)
        if circle and through not in said:
            said.add(through)
            words = ", ".join(f"'{each.input}' of {each.owner or last_name} from {each.source}" for each in circle)
            yield link, f"a circle: {words}; leave one of these out"


def _way_back(link: Link, goal: str, last_name: str, links: Sequence[Link]) -> list[Link]:
    """Return the links from this one to the calculation ``goal``, nothing where none leads there."""
    waiting: list[list[Link]] = [[link]]
    seen = set()
    while waiting:
        way = waiting.pop()
        if way[-1].source == goal:
            return way
        if way[-1].source not in seen:
            seen.add(way[-1].source)
            waiting += [[*way, each] for each in links if (each.owner or last_name) == way[-1].source]
    return []


# The chain as a model


def chained(
    last: AnyModel, sources: Mapping[str, AnyModel], links: Sequence[Link],
    settings: Mapping[str, Mapping[str, Any]] | None = None,
) -> AnyModel:  # fmt: skip
    """Return the model of a chain whose links have no faults: see ``link_faults``.

    It has the name, goals, studies and sheet of the last calculation, the error sources of all, and of the sources
    their limits and the sections of their sheets. What is taken is not varied.
    Raises DeclarationError where names meet.
    """
    chain = Chain(last, _in_order(sources, links), tuple(links), settings or {})
    function = _function(chain)
    return ChainModel(
        name=last.name,
        title=last.title,
        function=function,
        errors=[source for name in [*chain.sources, ""] for source in _errors_of(chain, name)],
        objectives=[
            *(each for each in last.objectives if not (isinstance(each, Vary) and each.input in chain.taken)),
            *(limit for name in chain.sources for limit in _limits_of(chain, name)),
        ],
        studies=last.studies,
        sheet=[
            *(section for name in chain.sources for section in _sections_of(chain, name)),
            *last.sheet,
        ],
        cites=list(dict.fromkeys(cite for name in [*chain.sources, ""] for cite in chain.model_of(name).cites)),
        example=last.example,
        summary=last.summary,
        exceptions=last.exceptions,
        chain=chain,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainModel(Model[Any, Any]):
    """A model that is a chain of calculations."""

    chain: Chain


def chain_of(model: AnyModel) -> Chain | None:
    """Return what a model is made of that is a chain, None of any other."""
    return model.chain if isinstance(model, ChainModel) else None


def link_of(model: AnyModel, name: str) -> Link | None:
    """Return what an input of a model is taken from, by its flat name; None of one that is not taken."""
    return model.chain.taken.get(name) if isinstance(model, ChainModel) else None


def calculation_of(model: AnyModel, effect: str) -> str:
    """Return the source of a chain whose effect this is, by its name in the chain; "" of the last one's."""
    sources = model.chain.sources if isinstance(model, ChainModel) else {}
    return next(
        (name for name, source in sources.items() for own in source.effects if prefix_of(name) + own == effect), ""
    )


def acts_on(model: AnyModel, effect: Effect[Any, Any]) -> ActsOn:
    """Return where an effect acts; one on the results of a source acts inside the chain, before they are taken."""
    name = calculation_of(model, effect.name)
    if not name or not isinstance(model, ChainModel):
        return effect.place
    return model.chain.sources[name].effects[effect.name.removeprefix(prefix_of(name))].place


Active = TypeVar("Active")


def in_order_of_calculation(
    model: AnyModel, effects: Iterable[Active], effect_of: Callable[[Active], Effect[Any, Any]]
) -> list[Active]:
    """Return effects so that those of a calculation act before those of the ones that take from it."""
    if not isinstance(model, ChainModel):
        return list(effects)
    order = {name: place for place, name in enumerate([*model.chain.sources, ""])}
    return sorted(effects, key=lambda active: order[calculation_of(model, effect_of(active).name)])


def filled(model: AnyModel, inputs: Any) -> Any:
    """Return inputs with what is taken from other calculations; those of a model that takes nothing as they are."""
    return model.chain.filled(inputs) if isinstance(model, ChainModel) else inputs


def _in_order(sources: Mapping[str, AnyModel], links: Sequence[Link]) -> dict[str, AnyModel]:
    """Return the sources so that each stands behind those it takes from."""
    ordered: dict[str, AnyModel] = {}

    def place(name: str) -> None:
        for link in links:
            if link.owner == name and link.source not in ordered:
                place(link.source)
        ordered[name] = sources[name]

    for name in sources:
        if name not in ordered:
            place(name)
    return ordered


def _function(chain: Chain) -> Any:
    """Return the function of a chain, annotated with its classes of inputs and results."""
    inputs, results = _input_type(chain), _result_type(chain)
    dynamics = chain.last.dynamics
    if dynamics is not None:
        named = {each.name: getattr(dynamics, each.name) for each in dataclasses.fields(Dynamics)}
        return _MovingChain(**named, chain=chain, classes=(inputs, results))

    def calculate(given: Any) -> Any:
        own, answers = chain.answers(given)
        return _with_answers(results, chain.last.function(own), answers)

    functools.update_wrapper(calculate, chain.last.function)
    calculate.__annotations__ = {"given": inputs, "return": results}
    return calculate


def _with_answers(results: type[Any], own: Any, answers: Mapping[str, Any]) -> Any:
    values = {each.name: getattr(own, each.name) for each in dataclasses.fields(own)}
    return results(**values, **answers)


@dataclass(frozen=True, kw_only=True)
class _MovingChain(Dynamics[Any, Any, Any]):
    """The function of a chain whose last calculation moves."""

    chain: Chain
    classes: tuple[type[Any], type[Any]]

    @functools.cached_property
    def input_type(self) -> type[Any]:
        """The class of the inputs of the chain."""
        return self.classes[0]

    @functools.cached_property
    def result_type(self) -> type[Any]:
        """The class of the results of the chain."""
        return self.classes[1]

    def __call__(self, inputs: Any) -> Any:
        """Calculate the sources, follow the states, and make results of all."""
        own, answers = self.chain.answers(inputs)
        return _with_answers(self.classes[1], self.gives(own, super().followed(own)), answers)

    def followed(self, inputs: Any) -> Any:
        """Follow the states, with what is taken from the sources."""
        return super().followed(self.chain.filled(inputs))

    def shown_at(self, inputs: Any, states: Any) -> Any:
        """Return the results of machines that stand in these states, with those of the sources."""
        own, answers = self.chain.answers(inputs)
        return _with_answers(self.classes[1], super().shown_at(own, states), answers)


def _input_type(chain: Chain) -> type[Any]:
    parts = {_attribute(name): _part(_redeclared(source.input_type, _open_inputs(chain, name)), prefix_of(name))
             for name, source in chain.sources.items()}  # fmt: skip
    carried = dataclasses.field(default=NOTHING, repr=False, compare=False, metadata=BESIDE)
    return _with_parts(
        _redeclared(chain.last.input_type, _open_inputs(chain, "")), {**parts, CARRIED: (Carried, carried)}
    )


def _result_type(chain: Chain) -> type[Any]:
    parts = {_attribute(name): _part(source.result_type, prefix_of(name), results=True)
             for name, source in chain.sources.items()}  # fmt: skip
    return _with_parts(chain.last.result_type, parts)


def _open_inputs(chain: Chain, name: str) -> dict[tuple[str, ...], Given]:
    """Return by path the inputs of a calculation that are taken from others, or that are stated with a link."""
    model = chain.model_of(name)
    changed: dict[tuple[str, ...], Given] = {}
    for flat, value in chain.settings.get(name, {}).items():
        field = model.input_fields[flat]
        assert isinstance(field.spec, Given)
        changed[field.path] = replace(field.spec, default=value)
    for link in chain.links:
        if link.owner == name:
            field = model.input_fields[link.input]
            assert isinstance(field.spec, Given)
            taken = Taken(link.calculation, link.result, called=link.source if link.model else "")
            changed[field.path] = replace(field.spec, default=None, taken=taken)
    return changed


def _part(of: type[Any], prefix: str, *, results: bool = False) -> tuple[type[Any], Any]:
    spec = Part(of=of, index="", suffix="", defaults={}, prefix=prefix)
    if results:
        return of, dataclasses.field(metadata={KEY: spec})
    return of, dataclasses.field(default_factory=lambda: make(of, {}), metadata={KEY: spec})


def _with_parts(cls: type[Any], parts: Mapping[str, tuple[type[Any], Any]]) -> type[Any]:
    taken = {each.name for each in dataclasses.fields(cls)} & set(parts)
    if taken:
        raise DeclarationError(
            f"'{min(taken)}' is a calculation of the chain and the name of a field of {cls.__name__}"
        )
    return _subclass(cls, parts)


def _redeclared(cls: type[Any], specs: Mapping[tuple[str, ...], Given]) -> type[Any]:
    """Return a class of inputs in which some, by path, are declared otherwise."""
    if not specs:
        return cls
    hints = hints_of(cls)
    changed: dict[str, tuple[type[Any], Any]] = {}
    for name in dict.fromkeys(path[0] for path in specs):
        inner = {path[1:]: spec for path, spec in specs.items() if path[0] == name}
        if () in inner:
            spec = inner[()]
            changed[name] = hints[name], dataclasses.field(default_factory=spec.initial, metadata={KEY: spec})
            continue
        (declared,) = (each for each in dataclasses.fields(cls) if each.name == name)
        part = spec_of(declared)
        assert isinstance(part, Part)
        of = _redeclared(part.of, inner)
        left = {key: value for key, value in part.defaults.items() if (key,) not in inner}
        made = functools.partial(make, of, {}, left)
        changed[name] = (
            of,
            dataclasses.field(
                default_factory=made, metadata={KEY: replace(part, of=of, defaults=left, suffix=part.suffix)}
            ),
        )
    return _subclass(cls, changed)


def _subclass(cls: type[Any], fields: Mapping[str, tuple[type[Any], Any]]) -> type[Any]:
    listed = [(name, kind, declared) for name, (kind, declared) in fields.items()]
    made = dataclasses.make_dataclass(cls.__name__, listed, bases=(cls,), frozen=True, kw_only=True)
    made.__module__, made.__qualname__, made.__doc__ = cls.__module__, cls.__qualname__, cls.__doc__
    return made


# Error sources, limits and sections of a source, under the names that they have in the chain


def renamed_in(chain: Chain, name: str) -> Callable[[str], str]:
    """Return what gives an input, a result or a condition of a source the name that it has in the chain.

    A condition that the last calculation, or a source before, declares in the same way is the same condition.
    """
    model, prefix, shared = chain.model_of(name), prefix_of(name), shared_conditions(chain, name)
    own = {*model.input_fields, *model.result_fields, *model.conditions} - shared
    return lambda word: prefix + word if word in own else word


def shared_conditions(chain: Chain, name: str) -> frozenset[str]:
    """Return the conditions of a source that are those of the last calculation, too: declared there in the same way."""
    last = chain.last.conditions
    return frozenset(each for each, condition in chain.model_of(name).conditions.items() if last.get(each) == condition)


def _errors_of(chain: Chain, name: str) -> Iterator[ErrorSource[Any, Any]]:
    rename, prefix = renamed_in(chain, name), prefix_of(name)
    for source in chain.model_of(name).errors:
        if isinstance(source, Effect):
            yield _effect_of(chain, name, source)
        elif not name:
            yield source
        elif isinstance(source, Correlated):
            yield replace(source, first=rename(source.first), second=rename(source.second))
        else:
            price = source.price
            if isinstance(price, PriceByChoice):
                price = replace(price, chooser=rename(price.chooser))
            yield Tolerance(
                prefix + source.name, _spread_of(source.spread, rename), [rename(each) for each in source.on],
                why=source.why, price=price, source=source.source,
            )  # fmt: skip


def _spread_of(spread: Spread, rename: Callable[[str], str]) -> Spread:
    if isinstance(spread, Band) and spread.at_radius:
        return replace(spread, at_radius=rename(spread.at_radius))
    if isinstance(spread, Grade) and spread.size:
        return replace(spread, size=rename(spread.size))
    if isinstance(spread, ByChoice):
        return ByChoice(
            rename(spread.chooser), {value: _spread_of(each, rename) for value, each in spread.spreads.items()}
        )
    return _drawn_of(spread, rename) if isinstance(spread, Drawn) else spread


def _drawn_of(spread: Drawn, rename: Callable[[str], str]) -> Drawn:
    own = {rename(each): each for each in spread.of}

    def draw(*arguments: Any, **named: Any) -> dict[str, Any]:
        drawn = spread.function(*arguments, **{own[each]: value for each, value in named.items()})
        return {rename(each): deviations for each, deviations in drawn.items()}

    return Drawn(functools.wraps(spread.function)(draw), tuple(own))


def _effect_of(chain: Chain, name: str, effect: Effect[Any, Any]) -> Effect[Any, Any]:
    """Return an effect of one calculation as one of the chain: it sees what that one takes from others."""
    if not name and effect.on_inputs is None:
        return effect
    rename = renamed_in(chain, name) if name else str
    needs = tuple(_condition_of(need, rename) for need in effect.needs)
    own_names = {need.name: before.name for need, before in zip(needs, effect.needs, strict=True)}
    act = _acting(chain, name, effect)

    def acting(*arguments: Any, **keywords: Any) -> Any:
        return act(*arguments, **{own_names.get(word, word): value for word, value in keywords.items()})

    functools.update_wrapper(acting, effect.function)
    acting.__annotations__ = {}
    inside = bool(name) and effect.place == "results"
    parameters = [*inspect.signature(effect.function).parameters.values()][1 if inside else 0 :]
    new_names = {before: after for after, before in own_names.items()}
    named = [each.replace(name=new_names.get(each.name, each.name), annotation=each.empty) for each in parameters]
    acting.__signature__ = inspect.Signature(named)  # type: ignore[attr-defined]
    unknowns = tuple(replace(each, along=rename(each.along)) if each.along else each for each in effect.unknowns)
    where: dict[str, Any] = {f"on_{effect.place}": None} | {"on_inputs" if inside else f"on_{effect.place}": acting}
    return replace(
        effect, name=prefix_of(name) + effect.name, needs=needs, unknowns=unknowns,
        reads=[rename(each) for each in effect.reads], **where,
    )  # fmt: skip


def _acting(chain: Chain, name: str, effect: Effect[Any, Any]) -> Callable[..., Any]:
    """Return an effect of one calculation as a function of the inputs, or inputs and results, of the chain.

    One on the results of a source acts inside, before they are taken: it is kept beside the inputs until then.
    """
    attribute, function = _attribute(name), effect.function

    def on_inputs(inputs: Any, **keywords: Any) -> Any:
        ready = chain.filled(inputs, name)
        changed = function(chain.inputs_of(ready, name), **keywords)
        return with_values(ready, {(attribute,): changed}) if name else changed

    def inside(inputs: Any, **keywords: Any) -> Any:
        carried = carried_by(inputs)
        acting = (*carried.acting.get(name, ()), lambda own, results: function(own, results, **keywords))
        known = {each: answer for each, answer in carried.known.items() if each != name}
        return _carrying(inputs, Carried({**carried.acting, name: acting}, known))

    def on_reading(inputs: Any, results: Any, **keywords: Any) -> Any:
        ready, before = chain.filled(inputs, name), getattr(results, attribute)
        return replace(results, **{attribute: function(chain.inputs_of(ready, name), before, **keywords)})

    functions: dict[ActsOn, Callable[..., Any]] = {"inputs": on_inputs, "results": inside, "reading": on_reading}
    return functions[effect.place]


def _condition_of(condition: Condition, rename: Callable[[str], str]) -> Condition:
    word, of, column = condition.derived.partition(" of ")
    derived = f"{word}{of}{rename(column)}" if of else condition.derived
    return replace(
        condition, name=rename(condition.name), derived=derived, rate=rename(condition.rate) if condition.rate else ""
    )


def _limits_of(chain: Chain, name: str) -> Iterator[Objective]:
    """Yield the limits of a source; what it varies, and its goals, are its own concern."""
    rename, model = renamed_in(chain, name), chain.sources[name]
    for objective in model.objectives:
        if isinstance(objective, Require) and objective.result in model.own_result_fields:
            sides: dict[str, Any] = {
                side: rename(getattr(objective, side)) for side in ("at_most", "at_least", "within")
            }
            reliability = objective.reliability
            chance = rename(reliability) if isinstance(reliability, str) else reliability
            yield replace(objective, result=rename(objective.result), reliability=chance, **sides)


def _sections_of(chain: Chain, name: str) -> Iterator[Section]:
    """Yield the sections of a source, which see it as it is alone."""
    model, prefix = chain.sources[name], prefix_of(name)

    def own_record(record: Record[Any, Any]) -> Record[Any, Any]:
        answers = {each: record.answers[prefix + each] for each in model.own_result_fields}
        acting = chain.inputs_of(record.acting, name)
        return Record(acting, chain.inputs_of(record.results, name), answers, {}, model.function, acting)

    for section in model.sheet:
        names = [prefix + each for each in section.names if each in model.own_result_fields]
        if section.names and not names:
            continue
        figure, blocks = section.figure, section.blocks
        yield Section(
            section.title, *names, text=section.text, level=section.level, caption=section.caption, of=name,
            figure=None if figure is None else _of_own(figure, own_record),
            blocks=None if blocks is None else _of_own(blocks, own_record),
        )  # fmt: skip


def _of_own(made: Callable[..., Any], own_record: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda record: made(own_record(record))
