"""Fields of inputs and results: one number or table each, with unit, symbol, bounds and source."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypeVar, dataclass_transform, get_args, get_origin

from truing.errors import DeclarationError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Float: TypeAlias = float | NDArray[np.float64]
else:
    Float = Annotated[float, "a number or an array: may vary inside a batch"]

T = TypeVar("T")
KEY = "truing"
Kind = Literal["float", "whole", "integer", "switch", "choice", "text", "series", "file"]


@dataclass(frozen=True, kw_only=True)
class Given:
    """One input as declared; ``default`` and the bounds are in ``unit``."""

    default: Any
    unit: str | None
    symbol: str = ""
    note: str = ""
    source: str = ""
    above: float | None = None
    below: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    whole: bool = False
    along: str = ""

    def initial(self) -> Any:
        """Return the default as the function sees it: SI, NaN where nothing is given."""
        return in_si(self.default, self.unit, bool(self.along))


@dataclass(frozen=True, kw_only=True)
class Loaded:
    """An input that is read from a data file by ``reader(path, **options)``."""

    reader: Callable[..., Any]
    note: str = ""
    source: str = ""
    default: Any = MISSING
    symbol: str = ""
    unit: str | None = None
    along: str = ""


@dataclass(frozen=True, kw_only=True)
class Found:
    """One result as declared; ``formula`` is what the sheet prints and a test evaluates."""

    unit: str
    symbol: str = ""
    note: str = ""
    formula: str = ""
    numeric: bool = False
    along: str = ""
    method: str = ""
    source: str = ""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A result that other results run along: shape (k,)."""

    unit: str
    symbol: str = ""
    note: str = ""
    is_table: bool = False


@dataclass(frozen=True, kw_only=True)
class Part:
    """A nested group of fields: one gear, one side."""

    of: type[Any]
    index: str
    suffix: str | None
    defaults: Mapping[str, Any]


Spec: TypeAlias = Given | Loaded | Found | Axis | Part


def in_si(value: Any, unit: str | None, is_series: bool = False) -> Any:
    """Turn a declared value, a text with a unit or None (not given: NaN) into what the function sees."""
    if value is None:
        return float("nan")
    if unit is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        from truing.units import read_quantity

        return read_quantity(value, unit)
    if is_series:
        import numpy as np

        return np.array([in_si(item, unit) for item in value], dtype=float)
    if isinstance(value, int) and unit in {"", "1", "-"}:
        return value
    from truing.units import to_si

    return to_si(value, unit)


def given(
    default: Any,
    unit: str | None = None,
    *,
    symbol: str = "",
    note: str = "",
    source: str = "",
    above: float | None = None,
    below: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    whole: bool = False,
    along: str = "",
) -> Any:
    """Declare an input with its default and unit; ``None`` makes it optional (NaN inside).

    Bounds are in ``unit``. ``whole`` asks for whole numbers. ``along`` names the axis of an input that is a series.
    """
    spec = Given(
        default=default, unit=unit, symbol=symbol, note=note, source=source, above=above, below=below,
        at_least=at_least, at_most=at_most, whole=whole, along=along,
    )  # fmt: skip
    return field(default_factory=spec.initial, metadata={KEY: spec})


def loaded(reader: Callable[..., Any], *, default: Any = MISSING, symbol: str = "", note: str = "", source: str = "") -> Any:
    """Declare an input that ``reader(path, **options)`` makes from a data file, once, as a frozen value."""
    spec = Loaded(reader=reader, default=default, symbol=symbol, note=note, source=source)
    if default is MISSING:
        return field(metadata={KEY: spec})
    return field(default=default, metadata={KEY: spec})


def found(
    unit: str,
    *,
    symbol: str = "",
    note: str = "",
    formula: str = "",
    numeric: bool = False,
    along: str = "",
    method: str = "",
    source: str = "",
) -> Any:
    """Declare a result; with ``numeric`` every name in the formula is its number in its declared unit."""
    spec = Found(
        unit=unit, symbol=symbol, note=note, formula=formula, numeric=numeric, along=along, method=method, source=source
    )
    return field(metadata={KEY: spec})


def axis(unit: str, *, symbol: str = "", note: str = "") -> Any:
    """Declare the axis that other results run along, shape (k,)."""
    return field(metadata={KEY: Axis(unit=unit, symbol=symbol, note=note)})


def rows(note: str = "", *, unit: str = "") -> Any:
    """Declare the axis of a table, whose length is known only afterwards."""
    return field(metadata={KEY: Axis(unit=unit, note=note, is_table=True)})


def part(of: type[T], index: str = "", *, suffix: str | None = None, **defaults: Any) -> Any:
    """Declare a nested group of fields, flat outside: field ``teeth`` of part ``sun`` is ``teeth_sun``.

    ``index`` is put behind the symbols, ``suffix`` replaces the attribute's name, ``defaults`` replace those of ``of``.
    """
    spec = Part(of=of, index=index, suffix=suffix, defaults=defaults)
    if not all(isinstance(spec_of(item), (Given, Loaded, Part)) for item in dataclasses.fields(of)):
        return field(metadata={KEY: spec})
    return field(default_factory=lambda: initial_part(spec), metadata={KEY: spec})


def initial_part(spec: Part) -> Any:
    """Make the nested inputs with the defaults that the part replaces."""
    specs = {item.name: spec_of(item) for item in dataclasses.fields(spec.of)}
    values = {name: _replaced(specs[name], value).initial() for name, value in spec.defaults.items()}
    return spec.of(**values)


def _replaced(spec: Spec, default: Any) -> Given:
    if not isinstance(spec, Given):
        raise DeclarationError("a part can replace the defaults of plain inputs only")
    return replace(spec, default=default)


def spec_of(item: dataclasses.Field[Any]) -> Spec:
    """Return the declaration behind a dataclass field."""
    spec: Spec | None = item.metadata.get(KEY)
    if spec is None:
        raise DeclarationError(f"field '{item.name}' is not declared: write given(...), loaded(...), found(...) or part(...)")
    return spec


@dataclass_transform(frozen_default=True, kw_only_default=True)
def inputs(cls: type[T]) -> type[T]:
    """Make a frozen, keyword-only dataclass of inputs; every field comes from given, loaded or part."""
    return _declared(cls, (Given, Loaded, Part))


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(found, axis, rows, part))
def results(cls: type[T]) -> type[T]:
    """Make a frozen, keyword-only dataclass of results; every field comes from found, axis, rows or part."""
    return _declared(cls, (Found, Axis, Part))


def _declared(cls: type[T], allowed: tuple[type[Any], ...]) -> type[T]:
    made = dataclass(frozen=True, kw_only=True)(cls)
    for item in dataclasses.fields(made):  # type: ignore[arg-type]  # the line above made it a dataclass
        try:
            spec = spec_of(item)
        except DeclarationError as error:
            raise DeclarationError(f"{cls.__module__}.{cls.__qualname__}: {error}") from None
        if not isinstance(spec, allowed):
            raise DeclarationError(f"{cls.__module__}.{cls.__qualname__}: '{item.name}' is declared with the wrong word")
    return made


@dataclass(frozen=True, kw_only=True)
class InputField:
    """One input by its flat name, as files and the command line know it."""

    name: str
    path: tuple[str, ...]
    spec: Given | Loaded
    kind: Kind
    symbol: str
    choices: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """The declared unit; empty for pure numbers and for what has none."""
        return self.spec.unit or ""

    @property
    def varies(self) -> bool:
        """Whether the input may be an array inside a batch."""
        return self.kind in {"float", "whole"}

    @property
    def is_optional(self) -> bool:
        """Whether the input may be left open (NaN inside)."""
        return isinstance(self.spec, Given) and self.spec.default is None


@dataclass(frozen=True, kw_only=True)
class ResultField:
    """One result by its flat name; ``scope`` is the suffix of its part, tried first when a formula names something."""

    name: str
    path: tuple[str, ...]
    spec: Found | Axis
    symbol: str
    scope: str = ""

    @property
    def unit(self) -> str:
        """The declared unit."""
        return self.spec.unit

    @property
    def along(self) -> str:
        """The axis this result runs along, by its name, or nothing."""
        return self.spec.along if isinstance(self.spec, Found) else self.path[-1]


@dataclass(frozen=True)
class _Place:
    path: tuple[str, ...]
    suffixes: tuple[str, ...]
    index: str
    spec: Spec
    annotation: Any


def _walk(cls: type[Any], path: tuple[str, ...] = (), suffixes: tuple[str, ...] = (), index: str = "",
          defaults: Mapping[str, Any] | None = None) -> Iterator[_Place]:  # fmt: skip
    from typing import get_type_hints

    hints = get_type_hints(cls, include_extras=True)
    for item in dataclasses.fields(cls):
        spec = spec_of(item)
        here = (*path, item.name)
        if isinstance(spec, Part):
            suffix = item.name if spec.suffix is None else spec.suffix
            yield from _walk(spec.of, here, (*suffixes, suffix), index + spec.index, spec.defaults)
            continue
        if defaults and item.name in defaults:
            spec = _replaced(spec, defaults[item.name])
        yield _Place(here, suffixes, index, spec, hints[item.name])


def _indexed(symbol: str, index: str) -> str:
    if not symbol or not index:
        return symbol
    return f"{symbol}{index}" if "_" in symbol else f"{symbol}_{index}"


def _kind(place: _Place) -> tuple[Kind, tuple[str, ...]]:
    annotation, spec = place.annotation, place.spec
    if isinstance(spec, Loaded):
        return "file", ()
    if annotation is Float or annotation is float:
        if isinstance(spec, Given) and spec.along:
            return "series", ()
        return ("whole" if isinstance(spec, Given) and spec.whole else "float"), ()
    if get_origin(annotation) is Literal:
        return "choice", tuple(str(choice) for choice in get_args(annotation))
    kinds: dict[Any, Kind] = {bool: "switch", int: "integer", str: "text"}
    if annotation in kinds:
        return kinds[annotation], ()
    return "series", ()


def input_fields(cls: type[Any]) -> dict[str, InputField]:
    """Return every input by its flat name, in the order of declaration."""
    fields: dict[str, InputField] = {}
    for place in _walk(cls):
        name = "_".join((place.path[-1], *place.suffixes))
        _refuse_twice(name, fields)
        assert isinstance(place.spec, (Given, Loaded))
        kind, choices = _kind(place)
        if kind in {"float", "whole"} and place.spec.unit is None:
            raise DeclarationError(f"input '{name}' has no unit: write given(default, \"mm\"), or \"\" for a pure number")
        symbol = _indexed(place.spec.symbol, place.index)
        fields[name] = InputField(name=name, path=place.path, spec=place.spec, kind=kind, symbol=symbol, choices=choices)
    return fields


def result_fields(cls: type[Any]) -> dict[str, ResultField]:
    """Return every result by its flat name, in the order of declaration."""
    fields: dict[str, ResultField] = {}
    for place in _walk(cls):
        name = "_".join((place.path[-1], *place.suffixes))
        _refuse_twice(name, fields)
        assert isinstance(place.spec, (Found, Axis))
        symbol = _indexed(place.spec.symbol, place.index)
        fields[name] = ResultField(
            name=name, path=place.path, spec=place.spec, symbol=symbol, scope="_".join(place.suffixes)
        )
    return fields


def _refuse_twice(name: str, fields: Mapping[str, Any]) -> None:
    if name in fields:
        raise DeclarationError(f"the flat name '{name}' occurs twice; rename the field or give the part another suffix")


def read(instance: Any, path: tuple[str, ...]) -> Any:
    """Return the value at ``path`` of nested inputs or results."""
    for name in path:
        instance = getattr(instance, name)
    return instance


def with_values(instance: T, values: Mapping[tuple[str, ...], Any]) -> T:
    """Return a copy of nested inputs or results with the values at the given paths replaced."""
    own: dict[str, Any] = {path[0]: value for path, value in values.items() if len(path) == 1}
    nested: dict[str, dict[tuple[str, ...], Any]] = {}
    for path, value in values.items():
        if len(path) > 1:
            nested.setdefault(path[0], {})[path[1:]] = value
    for name, inner in nested.items():
        own[name] = with_values(getattr(instance, name), inner)
    return replace(instance, **own)  # type: ignore[type-var]  # inputs and results are dataclasses
