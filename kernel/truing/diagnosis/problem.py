"""The search laid out: which causes, inputs and shapes compete on these rows, and the columns they are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import Candidate, Term, candidates_of, stacked, terms_of
from truing.diagnosis.evidence import Column
from truing.diagnosis.hypotheses import Piece, unbounded
from truing.diagnosis.machine import Machine, directions_of, visible
from truing.diagnosis.readings import followed_by
from truing.diagnosis.shapes import Library, library_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SAME_CURVE = 1e-4
REPRODUCED = 0.98
MANY_IN_PAIRS = 20
FEW_IN_PAIRS = 6


@dataclass(frozen=True)
class Problem:
    """Everything that competes. ``same_as`` holds, by place of a candidate, others that are the same curve here.

    ``shape_results`` holds, by the owner of a shape piece, the place of the shape and the results it acts on;
    ``like`` the (candidate, shape owner) pairs in which the shape reproduces the cause.
    """

    machine: Machine
    candidates: tuple[Candidate, ...]
    terms: tuple[Term, ...]
    library: Library
    columns: tuple[Column, ...]
    term_pieces: tuple[Piece, ...]
    input_pieces: tuple[Piece, ...]
    shape_pieces: tuple[Piece, ...]
    shape_results: tuple[tuple[int, tuple[str, ...]], ...]
    same_as: Mapping[int, tuple[str, ...]]
    like: frozenset[tuple[int, int]]
    unexcited: tuple[str, ...]


def problem_of(machine: Machine, scales: Mapping[str, float]) -> Problem:
    """Lay out the search; ``scales`` holds a first estimate of the noise by result, SI."""
    every = candidates_of(machine)
    variants = [terms_of(place, candidate, machine, scales) for place, candidate in enumerate(every)]
    known = _Sight(machine, scales)
    kept, same_as = _merged(every, variants, known)
    terms = [term for place in kept for term in variants[place]]
    library = library_of(machine.records, _registered_orders(every, variants), has_steps=_has_steps(every, variants))
    made = _Columns()
    term_pieces = [made.term(place, term) for place, term in enumerate(terms)]
    input_pieces = made.inputs(machine, scales)
    shape_pieces, shape_results = made.shapes(library, tuple(scales), scales)
    seen = {every[place].name for place in range(len(every)) if variants[place]}
    problem = Problem(
        machine,
        tuple(every),
        tuple(terms),
        library,
        tuple(made.columns),
        tuple(term_pieces),
        tuple(input_pieces),
        tuple(shape_pieces),
        tuple(shape_results),
        same_as,
        frozenset(),
        tuple(dict.fromkeys(candidate.name for candidate in every if candidate.name not in seen)),
    )
    return replace(problem, like=_alike(problem, known))


class _Sight:
    """What the data can see of a curve once the tolerances have taken their part."""

    def __init__(self, machine: Machine, scales: Mapping[str, float]) -> None:
        self.scales = scales
        slopes = stacked(machine.slopes, scales)
        self.directions = slopes @ directions_of(slopes)

    def of(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the visible part of stacked columns, shape (n + K, m)."""
        return visible(columns, self.directions)

    def term(self, term: Term) -> NDArray[np.float64]:
        """Return the visible part of the columns of a term."""
        import numpy as np

        return self.of(np.column_stack([stacked(curve, self.scales) for curve in term.curves]))


def _merged(
    every: Sequence[Candidate], variants: Sequence[Sequence[Term]], known: _Sight
) -> tuple[list[int], dict[int, tuple[str, ...]]]:
    """Return the candidates that stay, and the names of those that are the same curve on this data.

    Without this the prior mass of a curve with two names would be halved, and no verdict could be unique.
    """
    import numpy as np

    order = sorted(
        (place for place in range(len(every)) if variants[place]), key=lambda place: every[place].weakest_first
    )
    spaces: dict[int, NDArray[np.float64]] = {}
    same: dict[int, list[str]] = {}
    for place in order:
        terms = variants[place]
        if len(terms) > 1:
            same[place] = []
            continue
        space = np.linalg.qr(known.term(terms[0]))[0]
        twin = next((other for other, space_of in spaces.items() if _is_same(space, space_of)), None)
        if twin is None:
            spaces[place], same[place] = space, []
        elif every[place].name != every[twin].name:
            same[twin].append(every[place].name)
    return sorted(same), {place: tuple(dict.fromkeys(names)) for place, names in same.items()}


def _is_same(first: NDArray[np.float64], second: NDArray[np.float64]) -> bool:
    """Tell whether two column spaces coincide (sine squared of the largest angle below 1e-4)."""
    import numpy as np

    if first.shape[1] != second.shape[1]:
        return False
    cosine = np.linalg.svd(first.T @ second, compute_uv=False).min()
    return bool(1 - cosine**2 < SAME_CURVE)


def _registered_orders(every: Sequence[Candidate], variants: Sequence[Sequence[Term]]) -> dict[str, frozenset[int]]:
    """Return, by angle, the orders that effects of the kernel look for already."""
    found: dict[str, frozenset[int]] = {}
    for candidate, terms in zip(every, variants, strict=True):
        if candidate.is_kernel and candidate.name.startswith("periodic_order") and terms:
            angle = followed_by(candidate)
            found[angle] = frozenset(round(next(iter(term.shape.values()))) for term in terms)
    return found


def _has_steps(every: Sequence[Candidate], variants: Sequence[Sequence[Term]]) -> bool:
    return any(item.name == "step" and terms for item, terms in zip(every, variants, strict=True))


class _Columns:
    """Collects the columns of the search and the pieces that are made of them."""

    def __init__(self) -> None:
        self.columns: list[Column] = []

    def add(self, parts: Mapping[str, NDArray[np.float64]], per: float) -> int:
        """Return the place of a new column."""
        self.columns.append(Column(parts, per))
        return len(self.columns) - 1

    def term(self, place: int, term: Term) -> Piece:
        """Add the columns of one variant of a cause."""
        import numpy as np

        columns = []
        for curve, per in zip(term.curves, term.per, strict=True):
            parts = {name: np.nan_to_num(values) for name, values in curve.items() if np.any(values)}
            columns.append(self.add(parts, per))
        return Piece("term", place, term.candidate, tuple(columns), term.size, term.low, term.high)

    def inputs(self, machine: Machine, scales: Mapping[str, float]) -> list[Piece]:
        """Add one column per tolerated input, per standard deviation, free of its prior."""
        import numpy as np

        found = []
        for place, _ in enumerate(machine.inputs):
            parts = {name: machine.slopes[name][:, place] for name in scales}
            if any(np.any(values) for values in parts.values()):
                column = self.add(parts, 1.0)
                found.append(Piece("input", place, place, (column,), 1, (-inf,), (inf,)))
        return found

    def shapes(
        self, library: Library, results: Sequence[str], scales: Mapping[str, float]
    ) -> tuple[list[Piece], list[tuple[int, tuple[str, ...]]]]:
        """Add the columns of the library for every result; a shape may act on one result or on all."""
        places = {name: [self.add({name: basis.values}, scales[name]) for basis in library.bases] for name in results}
        groups = [(name,) for name in results] + ([tuple(results)] if len(results) > 1 else [])
        pieces: list[Piece] = []
        owners: list[tuple[int, tuple[str, ...]]] = []
        for place, shape in enumerate(library.shapes):
            for group in groups:
                columns = tuple(places[name][column] for name in group for column in shape.columns)
                size = len(columns) + shape.extra
                pieces.append(Piece("shape", len(owners), len(owners), columns, size, *unbounded(columns)))
                owners.append((place, group))
        return pieces, owners


def _alike(problem: Problem, known: _Sight) -> frozenset[tuple[int, int]]:
    """Return the pairs of a cause and a shape that reproduces it: the split between the two would be arbitrary."""
    import numpy as np

    found: set[tuple[int, int]] = set()
    terms = [known.term(term) for term in problem.terms]
    for owner, piece in enumerate(problem.shape_pieces):
        columns = [problem.columns[place].parts for place in piece.columns]
        names = list(known.scales)
        rows = len(problem.machine.records)
        filled = [{name: parts.get(name, np.zeros(rows)) for name in names} for parts in columns]
        space = np.linalg.qr(
            known.of(np.column_stack([stacked(parts, dict.fromkeys(names, 1.0)) for parts in filled]))
        )[0]
        for term, seen in zip(problem.terms, terms, strict=True):
            covered = np.sum((space.T @ seen) ** 2, axis=0) / np.maximum(np.sum(seen**2, axis=0), 1e-300)
            if covered.min() > REPRODUCED:
                found.add((term.candidate, owner))
    return frozenset(found)


def terms_for_pairs(problem: Problem, favourites: frozenset[int] = frozenset(), *, sparse: bool = False) -> list[Piece]:
    """Return the variants that enter pairs: of a fine grid about twenty and the ``favourites``, else all.

    ``sparse`` takes about six of any grid: enough for the largest of many simulated scores.
    """
    found = []
    for owner, pieces in _by_owner(problem).items():
        is_grid = len(pieces) > FEW_IN_PAIRS and not any(shape.whole for shape in problem.candidates[owner].shapes)
        every = stride(len(pieces), sparse=sparse) if is_grid else 1
        found += [
            piece for place, piece in enumerate(pieces) if place % every == every // 2 or piece.place in favourites
        ]
    return found


def stride(count: int, *, sparse: bool = False) -> int:
    """Return how many values of a grid lie between two that enter pairs."""
    return max(1, count // (FEW_IN_PAIRS if sparse else MANY_IN_PAIRS))


def near(problem: Problem, piece: Piece) -> list[Piece]:
    """Return the variants of the same cause that were passed over beside one: those up to the next that was tried."""
    pieces = _by_owner(problem)[piece.owner]
    every = stride(len(pieces))
    at = pieces.index(piece)
    return [each for place, each in enumerate(pieces) if 0 < abs(place - at) <= every] if every > 1 else []


def _by_owner(problem: Problem) -> dict[int, list[Piece]]:
    found: dict[int, list[Piece]] = {}
    for piece in problem.term_pieces:
        found.setdefault(piece.owner, []).append(piece)
    return found
