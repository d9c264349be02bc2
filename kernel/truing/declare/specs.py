"""The declarations behind the words of a field, and how a declared value becomes SI."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from truing.units import read_quantity, to_si
from truing.units.names import PURE

Array: TypeAlias = NDArray[np.float64]
if TYPE_CHECKING:
    Float: TypeAlias = float | NDArray[np.float64]
else:
    Float = Annotated[float, "a number or an array: may vary inside a batch"]

KEY = "truing"
InputKind = Literal["float", "whole", "integer", "switch", "choice", "text", "series", "file"]


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
    stated_with: str = ""
    halving: float | None = None
    halving_but: Mapping[str, str] = field(default_factory=dict)

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
    stated_with: str = ""


@dataclass(frozen=True, kw_only=True)
class Found:
    """One result as declared; ``formula`` is what the sheet prints and a test evaluates, with so many ``digits``."""

    unit: str
    symbol: str = ""
    note: str = ""
    formula: str = ""
    numeric: bool = False
    along: str = ""
    method: str = ""
    source: str = ""
    digits: int = 5


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A result that other results run along: shape (k,); ``follows`` names the input series that it repeats."""

    unit: str
    symbol: str = ""
    note: str = ""
    is_table: bool = False
    follows: str = ""


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
    if is_series and not isinstance(value, str):
        return np.array([in_si(member, unit) for member in value], dtype=float)
    if isinstance(value, (tuple, list)):
        return tuple(in_si(member, unit) for member in value)
    if isinstance(value, str):
        return read_quantity(value, unit)
    if isinstance(value, int) and unit in PURE:
        return value
    return to_si(value, unit)
