"""Shapes that nobody registered, made from the covariates without physics: trends, products, orders, cycles, steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import pi
from typing import TYPE_CHECKING, Literal

from truing.diagnosis.records import Covariate, Records

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["trend", "product", "order", "cycle", "step"]
DEGREE = 4
ORDERS = range(3, 17)
CYCLES = (*(half / 2 for half in range(3, 13)), *range(7, 13))
PLACES = 50
FULL_TURN = 1.5 * pi


@dataclass(frozen=True)
class Basis:
    """One column of a shape: how to compute it from covariates in SI, as a Python expression too."""

    expression: str
    values: NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """A family of columns that goes together; ``size`` counts the numbers it was free to choose."""

    kind: Kind
    depends_on: tuple[str, ...]
    columns: tuple[int, ...]
    detail: float = 0.0
    extra: int = 0

    @property
    def size(self) -> int:
        """Number of free parameters for one result."""
        return len(self.columns) + self.extra


@dataclass(frozen=True)
class Library:
    """Every unregistered shape over the covariates of these rows; shapes share columns, shape (n,) each."""

    bases: tuple[Basis, ...]
    shapes: tuple[Shape, ...]


class _Maker:
    """Collects columns, each once."""

    def __init__(self) -> None:
        self.bases: list[Basis] = []
        self.places: dict[str, int] = {}
        self.shapes: list[Shape] = []

    def column(self, expression: str, values: NDArray[np.float64]) -> int:
        """Return the place of a column, adding it where it is new."""
        if expression not in self.places:
            self.places[expression] = len(self.bases)
            self.bases.append(Basis(expression, values))
        return self.places[expression]

    def add(
        self, kind: Kind, on: Sequence[str], columns: Sequence[int], *, detail: float = 0.0, extra: int = 0
    ) -> None:
        """Add a shape of those columns that are not combinations of the ones before."""
        kept = self._independent(columns)
        shape = Shape(kind, tuple(on), tuple(kept), detail, extra)
        if kept and shape not in self.shapes and (kind not in {"trend", "product"} or len(kept) > 1):
            self.shapes.append(shape)

    def _independent(self, columns: Sequence[int]) -> list[int]:
        import numpy as np

        kept: list[int] = []
        basis: list[NDArray[np.float64]] = []
        for place in columns:
            rest = self.bases[place].values
            size = float(np.sqrt(rest @ rest))
            for _ in range(2):
                for vector in basis:
                    rest = rest - vector * (vector @ rest)
            left = float(np.sqrt(rest @ rest))
            if size > 0 and left > 1e-3 * size:
                kept.append(place)
                basis.append(rest / left)
        return kept


def library_of(records: Records, registered: Mapping[str, frozenset[int]], *, has_steps: bool) -> Library:
    """Return the shapes over every covariate that moved.

    ``registered`` holds the orders of each angle that an effect of the kernel looks for already; ``has_steps`` says
    that steps in time are looked for already.
    """
    import numpy as np

    maker = _Maker()
    one = maker.column("1", np.ones(len(records)))
    moved = [item for item in records.covariates.values() if not item.is_constant]
    mains = {item.name: list(_main_terms(maker, item)) for item in moved}
    for item in moved:
        maker.add("trend", [item.name], [one, *mains[item.name][:2]])
        maker.add("trend", [item.name], [one, *mains[item.name]])
    for first, second in combinations(moved, 2):
        columns = list(_products(maker, one, first, second, mains))
        maker.add("product", [first.name, second.name], [columns[place] for place in _bilinear(first, second)])
        maker.add("product", [first.name, second.name], columns)
    for item in moved:
        if item.is_angle:
            _add_orders(maker, item, registered.get(item.name, frozenset()))
        elif item.role in {"time", "order"}:
            _add_cycles(maker, item)
            if not has_steps:
                _add_steps(maker, item)
    return Library(tuple(maker.bases), tuple(maker.shapes))


def _scaled(item: Covariate) -> tuple[str, NDArray[np.float64]]:
    """Return a covariate brought to -1..1, missing values in the middle."""
    import numpy as np

    low, high = float(np.nanmin(item.values)), float(np.nanmax(item.values))
    middle, half = (low + high) / 2, (high - low) / 2
    values = (np.where(np.isfinite(item.values), item.values, middle) - middle) / half
    return f"(({item.name} - {middle!r}) / {half!r})", values


def _turns(item: Covariate) -> bool:
    """Tell whether an angle covers so much of a turn that waves describe it better than powers."""
    import numpy as np

    return item.is_angle and float(np.nanmax(item.values) - np.nanmin(item.values)) >= FULL_TURN


def _main_terms(maker: _Maker, item: Covariate) -> Iterator[int]:
    """Give the columns of one covariate: powers, or waves for an angle that goes round."""
    import numpy as np

    if _turns(item):
        angle = np.nan_to_num(item.values)
        for order in (1, 2):
            yield maker.column(f"np.sin({order} * {item.name})", np.sin(order * angle))
            yield maker.column(f"np.cos({order} * {item.name})", np.cos(order * angle))
        return
    text, values = _scaled(item)
    for power in range(1, DEGREE + 1):
        yield maker.column(text if power == 1 else f"{text}**{power}", values**power)


def _products(
    maker: _Maker, one: int, first: Covariate, second: Covariate, mains: Mapping[str, list[int]]
) -> Iterator[int]:
    """Give two main terms of each of two covariates and their three lowest products."""
    yield one
    pairs = [mains[item.name][:2] for item in (first, second)]
    yield from pairs[0]
    yield from pairs[1]
    for a, b in ((0, 0), (1, 0), (0, 1)):
        left, right = maker.bases[pairs[0][a]], maker.bases[pairs[1][b]]
        yield maker.column(f"{left.expression} * {right.expression}", left.values * right.values)


def _bilinear(first: Covariate, second: Covariate) -> tuple[int, ...]:
    """Return which of the columns of a product are linear in both covariates; an angle that goes round has two."""
    if _turns(first):
        return (0, 1, 2, 3, 5, 6)
    return (0, 1, 3, 4, 5, 7) if _turns(second) else (0, 1, 3, 5)


def highest_order(angle: NDArray[np.float64]) -> int:
    """Return the highest order that this sampling of an angle shows as itself; above it, it folds back."""
    import numpy as np

    places = np.unique(np.round(np.mod(angle[np.isfinite(angle)], 2 * pi), 9))
    if len(places) < 3:
        return 0
    gaps = np.diff([*places, places[0] + 2 * pi])
    inner = gaps[gaps < gaps.max()] if len(gaps) > 2 else gaps
    is_regular = len(inner) > 0 and float(np.ptp(inner)) < 1e-3 * float(inner.mean())
    if not is_regular:
        return 10**6
    return int(np.ceil(pi / float(inner.mean()) - 1e-6)) - 1  # places are rounded to 1e-9


def _add_orders(maker: _Maker, item: Covariate, registered: frozenset[int]) -> None:
    import numpy as np

    angle = np.nan_to_num(item.values)
    limit = highest_order(item.values)
    lowest = 1 if not registered else ORDERS.start
    for order in range(lowest, ORDERS.stop):
        if order in registered or order > limit:
            continue
        waves = [
            maker.column(f"np.{name}({order} * {item.name})", wave(order * angle))
            for name, wave in (("sin", np.sin), ("cos", np.cos))
        ]
        maker.add("order", [item.name], waves, detail=order, extra=1)


def _add_cycles(maker: _Maker, item: Covariate) -> None:
    """Add waves of one and a half to twelve cycles per record."""
    import numpy as np

    text, values = _scaled(item)
    for cycles in CYCLES:
        waves = [
            maker.column(f"np.{name}({cycles * pi!r} * {text})", wave(cycles * pi * values))
            for name, wave in (("sin", np.sin), ("cos", np.cos))
        ]
        maker.add("cycle", [item.name], waves, detail=cycles, extra=1)


def _add_steps(maker: _Maker, item: Covariate) -> None:
    """Add a constant with a step at every fiftieth of the record."""
    import numpy as np

    values = np.nan_to_num(item.values)
    places = np.unique(np.quantile(values, np.linspace(0.02, 0.98, PLACES), method="lower"))
    for place in places[places > values.min()]:
        step = maker.column(f"({item.name} >= {float(place)!r})", (values >= place).astype(float))
        maker.add("step", [item.name], [step], detail=float(place), extra=1)
