"""Every explanation that competes: nothing, one cause, two causes, an unregistered shape, a cause beside a shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import chain, combinations
from math import inf, log
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["none", "one", "two", "shape", "mixed", "input"]
MASSES: Mapping[Kind, float] = {"none": 0.50, "one": 0.30, "two": 0.12, "shape": 0.06, "mixed": 0.02, "input": 0.02}
"""Prior mass of every class, shared equally by its members: a class with many members does not win by numbers."""

ROWS_PER_PARAMETER = 4
"""Fewer rows for every free number are followed by any curve, noise or not."""
REMEMBERED = 8
"""So many lists of each class are made once: the folds of a cross-validation ask for the same."""


@dataclass(frozen=True)
class Piece:
    """What a hypothesis is made of: one variant of a cause, an input off its band, or a shape on some results.

    ``owner`` names the explanation whatever the variant; ``columns`` are places among all columns; ``size`` counts the
    parameters; ``low`` and ``high`` bound the coefficients.
    """

    kind: Literal["term", "input", "shape"]
    place: int
    owner: int
    columns: tuple[int, ...]
    size: int
    low: tuple[float, ...]
    high: tuple[float, ...]

    @cached_property
    def tag(self) -> tuple[str, int]:
        """The explanation itself, whatever the variant."""
        return self.kind, self.owner


@dataclass(frozen=True)
class Hypothesis:
    """One explanation: its pieces, and the logarithm of its prior mass."""

    kind: Kind
    pieces: tuple[Piece, ...]
    log_prior: float

    def __hash__(self) -> int:
        """Return the same as for any equal explanation, calculated once: lists of thousands are remembered."""
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.kind, self.pieces))

    @property
    def columns(self) -> tuple[int, ...]:
        """Places of all columns."""
        return tuple(column for piece in self.pieces for column in piece.columns)

    @property
    def size(self) -> int:
        """Number of free parameters."""
        return sum([piece.size for piece in self.pieces])

    @cached_property
    def key(self) -> tuple[tuple[str, int], ...]:
        """The explanation itself, whatever the variant."""
        return _key(self.pieces)


def _key(pieces: tuple[Piece, ...]) -> tuple[tuple[str, int], ...]:
    if len(pieces) == 1:
        return (pieces[0].tag,)
    return tuple(sorted([piece.tag for piece in pieces]))


NOTHING = Hypothesis("none", (), log(MASSES["none"]))


def _members(kind: Kind, pieces: Sequence[tuple[Piece, ...]]) -> tuple[Hypothesis, ...]:
    """Share the mass of a class among its explanations."""
    keys = {_key(each) for each in pieces}
    share = log(MASSES[kind]) - log(max(len(keys), 1))
    return tuple(Hypothesis(kind, each, share) for each in pieces)


@lru_cache(maxsize=REMEMBERED)
def _alone(kind: Kind, pieces: tuple[Piece, ...]) -> tuple[Hypothesis, ...]:
    return _members(kind, [(piece,) for piece in pieces])


@lru_cache(maxsize=REMEMBERED)
def _paired(terms: tuple[Piece, ...], beside: tuple[tuple[Piece, Piece], ...]) -> tuple[Hypothesis, ...]:
    return _members("two", [*((a, b) for a, b in combinations(terms, 2) if a.owner != b.owner), *beside])


@lru_cache(maxsize=REMEMBERED)
def _beside(
    terms: tuple[Piece, ...], groups: tuple[Piece, ...], like: frozenset[tuple[int, int]]
) -> tuple[Hypothesis, ...]:
    return _members("mixed", [(a, b) for a in terms for b in groups if (a.owner, b.owner) not in like])


def singles(terms: Sequence[Piece]) -> tuple[Hypothesis, ...]:
    """Return one hypothesis per variant of every cause."""
    return _alone("one", tuple(terms))


def pairs(terms: Sequence[Piece], beside: Sequence[tuple[Piece, Piece]] = ()) -> tuple[Hypothesis, ...]:
    """Return every pair of variants of two different causes, and those that only go with one another."""
    return _paired(tuple(terms), tuple(beside))


def shapes(groups: Sequence[Piece]) -> tuple[Hypothesis, ...]:
    """Return one hypothesis per unregistered shape."""
    return _alone("shape", tuple(groups))


def off_inputs(inputs: Sequence[Piece]) -> tuple[Hypothesis, ...]:
    """Return one hypothesis per input that may lie outside its band."""
    return _alone("input", tuple(inputs))


def mixed(terms: Sequence[Piece], groups: Sequence[Piece], like: frozenset[tuple[int, int]]) -> tuple[Hypothesis, ...]:
    """Return every cause beside every shape, but for shapes that reproduce the cause (``like``: owner, shape)."""
    return _beside(tuple(terms), tuple(groups), like)


@dataclass(frozen=True)
class Batch:
    """Hypotheses with the same number of columns, as arrays: solved together.

    ``places`` are their places in the list they came from; ``index`` (n, k), ``low`` and ``high`` (n, k), ``size`` and
    ``log_prior`` (n,).
    """

    places: NDArray[np.intp]
    index: NDArray[np.intp]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    size: NDArray[np.intp]
    log_prior: NDArray[np.float64]
    squares: dict[int, NDArray[np.intp]] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def bounds(self) -> Bounds:
        """The bounds that there are."""
        import numpy as np

        places, columns = np.nonzero(np.isfinite(self.low) | np.isfinite(self.high))
        first = np.flatnonzero(np.append(True, places[1:] != places[:-1])) if len(places) else places
        low, high = self.low[places, columns], self.high[places, columns]
        return Bounds(places, columns, first, self.index[places, columns], low[:, None], high[:, None])

    def penalty(self, rows: int) -> NDArray[np.float64]:
        """Return what the parameters cost, (n,): size times log rows, less twice the log prior.

        What has too many parameters for so few rows is out of the question.
        """
        import numpy as np

        paid = self.size * log(rows) - 2 * self.log_prior
        return np.where(self.size * ROWS_PER_PARAMETER > rows, inf, paid)

    def square(self, size: int) -> NDArray[np.intp]:
        """Return where the normal matrices of the hypotheses stand in one of ``size`` columns, flat, (n, k, k)."""
        if size not in self.squares:
            self.squares[size] = self.index[:, :, None] * size + self.index[:, None, :]
        return self.squares[size]


@dataclass(frozen=True)
class Bounds:
    """Coefficients of a batch that have a bound: hypothesis and place in it, the first of each, column, low and high.

    ``low`` and ``high`` have shape (bounded, 1).
    """

    places: NDArray[np.intp]
    within: NDArray[np.intp]
    first: NDArray[np.intp]
    columns: NDArray[np.intp]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def batches_of(hypotheses: Sequence[Hypothesis], largest: int = 4000) -> Sequence[Batch]:
    """Group hypotheses by their number of columns, in batches of bounded size."""
    return _batched(tuple(hypotheses), largest)


@lru_cache(maxsize=REMEMBERED)
def _batched(hypotheses: tuple[Hypothesis, ...], largest: int) -> tuple[Batch, ...]:
    by_count: dict[int, list[int]] = {}
    for place, hypothesis in enumerate(hypotheses):
        by_count.setdefault(sum([len(piece.columns) for piece in hypothesis.pieces]), []).append(place)
    return tuple(
        _batch(hypotheses, every[begin : begin + largest], count)
        for count, every in sorted(by_count.items())
        for begin in range(0, len(every), largest)
    )


def _batch(hypotheses: Sequence[Hypothesis], places: Sequence[int], count: int) -> Batch:
    import numpy as np

    chosen = [hypotheses[place] for place in places]

    def of_each(values: Callable[[Piece], Sequence[float]], kind: type) -> NDArray[Any]:
        flat = chain.from_iterable(values(piece) for each in chosen for piece in each.pieces)
        return np.fromiter(flat, dtype=kind, count=len(chosen) * count).reshape(len(chosen), count)

    return Batch(
        np.array(places),
        of_each(lambda piece: piece.columns, np.intp),
        of_each(lambda piece: piece.low, np.float64),
        of_each(lambda piece: piece.high, np.float64),
        np.array([each.size for each in chosen]),
        np.array([each.log_prior for each in chosen]),
    )


def unbounded(columns: Sequence[int]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the bounds of coefficients that have none."""
    return (-inf,) * len(columns), (inf,) * len(columns)
