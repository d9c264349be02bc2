"""Shapes that nobody registered, made from the covariates without physics: trends, products, orders, cycles, steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from math import pi
from typing import TYPE_CHECKING, Literal, TypeAlias

from truing.diagnosis.columns import Values, when_asked
from truing.diagnosis.records import Covariate, Records

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from truing.diagnosis.columns import Rows

    Matrix = NDArray[np.float64]
    Of: TypeAlias = Callable[[Rows], Matrix]

Kind = Literal["trend", "product", "order", "cycle", "step"]
DEGREE = 4
ORDERS = range(3, 17)
CYCLES = (*(half / 2 for half in range(3, 13)), *range(7, 13))
PLACES = 50


@dataclass(frozen=True)
class Basis:
    """One column of a shape: how to compute it from covariates in SI, as a Python expression too."""

    expression: str
    values: Values


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
    """Collects columns over ``rows`` rows, each once."""

    def __init__(self, rows: int) -> None:
        self.rows = rows
        self.bases: list[Basis] = []
        self.places: dict[str, int] = {}
        self.shapes: list[Shape] = []

    def column(self, expression: str, of: Of) -> int:
        """Return the place of a column, adding it where it is new; ``of`` makes its values at some rows."""
        if expression not in self.places:
            self.places[expression] = len(self.bases)
            self.bases.append(Basis(expression, when_asked(of, self.rows)))
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
            rest = self.bases[place].values[:]
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
    rows = len(records)
    maker = _Maker(rows)
    one = maker.column("1", partial(_ones, rows))
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


def _ones(count: int, rows: Rows) -> Matrix:
    import numpy as np

    return np.asarray(np.broadcast_to(1.0, (count,))[rows])


def _from_middle(values: Matrix, middle: float, half: float, rows: Rows) -> Matrix:
    import numpy as np

    here = values[rows]
    return np.asarray((np.where(np.isfinite(here), here, middle) - middle) / half)


def _known(values: Matrix, rows: Rows) -> Matrix:
    import numpy as np

    return np.nan_to_num(values[rows])


def _power(of: Of, power: int, rows: Rows) -> Matrix:
    return of(rows) ** power


def _wave(name: Literal["sin", "cos"], factor: float, of: Of, rows: Rows) -> Matrix:
    import numpy as np

    return np.asarray((np.sin if name == "sin" else np.cos)(factor * of(rows)))


def _product(left: Values, right: Values, rows: Rows) -> Matrix:
    return left[rows] * right[rows]


def _since(values: Matrix, place: float, rows: Rows) -> Matrix:
    import numpy as np

    return (np.nan_to_num(values[rows]) >= place).astype(float)


def _scaled(item: Covariate) -> tuple[str, Of]:
    """Return a covariate brought to -1..1, missing values in the middle."""
    import numpy as np

    low, high = float(np.nanmin(item.values)), float(np.nanmax(item.values))
    middle, half = (low + high) / 2, (high - low) / 2
    return f"(({item.name} - {middle!r}) / {half!r})", partial(_from_middle, item.values, middle, half)


def _turns(item: Covariate) -> bool:
    """Tell whether an angle covers so much of a turn that waves describe it better than powers."""
    return item.is_angle and item.goes_round


def _main_terms(maker: _Maker, item: Covariate) -> Iterator[int]:
    """Give the columns of one covariate: powers, or waves for an angle that goes round."""
    if _turns(item):
        for order in (1, 2):
            yield from _waves(maker, order, item.name, partial(_known, item.values))
        return
    text, values = _scaled(item)
    for power in range(1, DEGREE + 1):
        yield maker.column(text if power == 1 else f"{text}**{power}", partial(_power, values, power))


def _waves(maker: _Maker, factor: float, text: str, of: Of) -> list[int]:
    """Return the columns of a sine and a cosine."""
    names: tuple[Literal["sin", "cos"], ...] = ("sin", "cos")
    return [maker.column(f"np.{name}({factor!r} * {text})", partial(_wave, name, factor, of)) for name in names]


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
        yield maker.column(f"{left.expression} * {right.expression}", partial(_product, left.values, right.values))


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
    limit = highest_order(item.values)
    lowest = 1 if not registered else ORDERS.start
    for order in range(lowest, ORDERS.stop):
        if order in registered or order > limit:
            continue
        waves = _waves(maker, order, item.name, partial(_known, item.values))
        maker.add("order", [item.name], waves, detail=order, extra=1)


def _add_cycles(maker: _Maker, item: Covariate) -> None:
    """Add waves of one and a half to twelve cycles per record."""
    text, values = _scaled(item)
    for cycles in CYCLES:
        waves = _waves(maker, cycles * pi, text, values)
        maker.add("cycle", [item.name], waves, detail=cycles, extra=1)


def _add_steps(maker: _Maker, item: Covariate) -> None:
    """Add a constant with a step at every fiftieth of the record."""
    import numpy as np

    values = np.nan_to_num(item.values)
    places = np.unique(np.quantile(values, np.linspace(0.02, 0.98, PLACES), method="lower"))
    for place in places[places > values.min()]:
        step = maker.column(f"({item.name} >= {float(place)!r})", partial(_since, item.values, float(place)))
        maker.add("step", [item.name], [step], detail=float(place), extra=1)
