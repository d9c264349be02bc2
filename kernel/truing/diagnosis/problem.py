"""The search laid out: which causes, inputs and shapes compete on these rows, and the columns they are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

from truing.diagnosis.candidates import Candidate, Term, candidates_of, failure_of, variants_of
from truing.diagnosis.chords import are_faint, bent_terms, far_terms, is_seen_to_bend, late_terms
from truing.diagnosis.columns import Column, Design, Values, acting
from truing.diagnosis.grids import terms_of
from truing.diagnosis.hypotheses import Piece, unbounded
from truing.diagnosis.machine import Machine
from truing.diagnosis.readings import followed_by
from truing.diagnosis.shapes import Library, library_of
from truing.diagnosis.sight import Sight
from truing.diagnosis.twins import Parting, Twin

MANY_IN_PAIRS = 20
SHARES = (0.1, 0.25, 0.5, 0.75)
FINEST = 1e-4
FEW_IN_PAIRS = 6


@dataclass(frozen=True)
class Problem:
    """Everything that competes. ``twins`` holds, by place of a candidate, others that are the same curve here.

    ``shape_results`` holds, by the owner of a shape piece, the place of the shape and the results it acts on;
    ``like`` the (candidate, shape owner) pairs in which the shape reproduces the cause. ``beside`` are pairs of which
    the second has the curve that it has beside the first. ``failing`` says by effect why the model fails with it.
    """

    machine: Machine
    scales: Mapping[str, float]
    candidates: tuple[Candidate, ...]
    terms: tuple[Term, ...]
    library: Library
    columns: tuple[Column, ...]
    term_pieces: tuple[Piece, ...]
    input_pieces: tuple[Piece, ...]
    shape_pieces: tuple[Piece, ...]
    shape_results: tuple[tuple[int, tuple[str, ...]], ...]
    twins: Mapping[int, tuple[Twin, ...]]
    like: frozenset[tuple[int, int]]
    unexcited: tuple[str, ...]
    failing: Mapping[str, str]
    beside: tuple[tuple[Piece, Piece], ...] = ()

    def same_curve(self, owner: int, coefficients: Sequence[float]) -> tuple[str, ...]:
        """Return the names of what may be the curve of a candidate with these coefficients as well."""
        way = (-1 if coefficients[0] < 0 else 1) if len(coefficients) == 1 else 0
        twins = self.twins.get(owner, ())
        return tuple(dict.fromkeys(twin.name for twin in twins if way == 0 or way in twin.sides))

    @property
    def same_as(self) -> dict[int, tuple[str, ...]]:
        """By place of a candidate, the names of all that are the same curve here, whatever its sign."""
        return {place: tuple(dict.fromkeys(twin.name for twin in twins)) for place, twins in self.twins.items()}

    @cached_property
    def designs(self) -> Mapping[str, Design]:
        """The columns by measured result."""
        rows = len(self.machine.records)
        return {name: Design(name, self.columns, rows) for name in self.machine.records.measured}


def problem_of(machine: Machine, scales: Mapping[str, float]) -> Problem:
    """Lay out the search; ``scales`` holds a first estimate of the noise by result, SI."""
    every = candidates_of(machine)
    variants: list[Sequence[Term]] = [terms_of(at, candidate, machine, scales) for at, candidate in enumerate(every)]
    for at, candidate in enumerate(every):
        if are_faint(variants[at], scales):
            variants[at] = late_terms(at, candidate, machine, scales) or variants[at]
    library = library_of(machine.records, _registered_orders(every, variants), has_steps=_has_steps(every, variants))
    known = Sight(machine, scales, variants, library)
    kept, same_as = _merged(every, variants, known)
    terms = [term for place in kept for term in variants[place]]
    made = _Columns()
    term_pieces = [made.term(place, term) for place, term in enumerate(terms)]
    input_pieces = made.inputs(machine, scales)
    shape_pieces, shape_results = made.shapes(library, tuple(scales), scales)
    seen = {every[place].name for place in range(len(every)) if variants[place]}
    problem = Problem(
        machine,
        scales,
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
        tuple(dict.fromkeys(item.name for item in every if item.name not in seen and _could_move(item, machine))),
        {item.name: reason for item in every if item.name not in seen and (reason := failure_of(machine, item))},
    )
    return replace(problem, like=known.reproduced(kept, shape_results))


def _could_move(candidate: Candidate, machine: Machine) -> bool:
    """Tell whether it is worth saying that a candidate was not excited: not of a fixed input that is no column."""
    name = followed_by(candidate) if candidate.is_kernel else ""
    return not name or name in machine.records.covariates


def _merged(
    every: Sequence[Candidate], variants: list[Sequence[Term]], known: Sight
) -> tuple[list[int], dict[int, tuple[Twin, ...]]]:
    """Return the candidates that stay, and those that are the same curve on this data.

    Without this the prior mass of a curve with two names would be halved, and no verdict could be unique. Of a
    candidate with several whole numbers only the variant that is another's curve goes.
    """
    order = sorted(
        (place for place in range(len(every)) if variants[place]), key=lambda place: every[place].weakest_first
    )
    alone: list[int] = []
    same: dict[int, list[Twin]] = {}
    for place in order:
        is_grid = len(variants[place]) > 1
        if is_grid and not any(shape.whole for shape in every[place].shapes):
            same[place] = []
            continue
        twins = [
            next((other for other in alone if _sides(known, (place, number), variants, other)), None)
            for number in range(len(variants[place]))
        ]
        if is_grid:
            same[place] = []
            for number, twin in enumerate(twins):
                if twin is not None:
                    same[twin].append(Twin(every[place].name, _sides(known, (place, number), variants, twin), place))
            left = [number for number, twin in enumerate(twins) if twin is None]
            variants[place] = [variants[place][number] for number in left]
            known.terms[place] = [known.terms[place][number] for number in left]
        elif twins[0] is None:
            alone.append(place)
            same[place] = []
        elif every[place].name != every[twins[0]].name:
            same[twins[0]].append(Twin(every[place].name, _sides(known, (place, 0), variants, twins[0]), place))
            rest = _other_side(known, place, variants, twins[0])
            if rest:
                variants[place], same[place] = rest, []
    return sorted(same), {place: tuple(dict.fromkeys(twins)) for place, twins in same.items()}


def _sides(known: Sight, variant: tuple[int, int], variants: Sequence[Sequence[Term]], other: int) -> tuple[int, ...]:
    """Return the signs of another candidate's coefficient for which a variant (candidate, number) may be its curve.

    None where the curves differ, or where one can only add to what the other can only take away from.
    """
    place, number = variant
    own = known.terms[place][number]
    if not known.is_same(own, other):
        return ()
    if len(own) > 1:
        return (-1, 1)
    a, b = variants[place][number], variants[other][0]
    way = known.products[own[0], known.terms[other][0][0]]
    low, high = (a.low[0], a.high[0]) if way > 0 else (-a.high[0], -a.low[0])
    return (*((-1,) if max(low, b.low[0]) < 0 else ()), *((1,) if min(high, b.high[0]) > 0 else ()))


def _other_side(known: Sight, place: int, variants: Sequence[Sequence[Term]], other: int) -> list[Term]:
    """Return what a candidate can do to the side that a candidate of the same curve cannot reach; nothing if it can."""
    own, term = known.terms[place][0], variants[place][0]
    if len(own) > 1:
        return []
    way = 1 if known.products[own[0], known.terms[other][0][0]] > 0 else -1
    reached = {side * way for side in _sides(known, (place, 0), variants, other)}
    if 1 not in reached and term.high[0] > 0:
        return [replace(term, low=(max(term.low[0], 0.0),))]
    if -1 not in reached and term.low[0] < 0:
        return [replace(term, high=(min(term.high[0], 0.0),))]
    return []


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

    def __init__(self, columns: Sequence[Column] = ()) -> None:
        self.columns: list[Column] = list(columns)

    def add(self, parts: Mapping[str, Values], per: float) -> int:
        """Return the place of a new column."""
        self.columns.append(Column(parts, per))
        return len(self.columns) - 1

    def term(self, place: int, term: Term) -> Piece:
        """Add the columns of one variant of a cause."""
        columns = []
        for curve, per in zip(term.curves, term.per, strict=True):
            columns.append(self.add(acting(curve), per))
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
    pieces = _by_owner(problem).get(piece.owner, [])
    every = stride(len(pieces))
    if piece not in pieces:  # it goes with one other cause only
        return []
    at = pieces.index(piece)
    return [each for place, each in enumerate(pieces) if 0 < abs(place - at) <= every] if every > 1 else []


def _by_owner(problem: Problem) -> dict[int, list[Piece]]:
    found: dict[int, list[Piece]] = {}
    for piece in problem.term_pieces:
        found.setdefault(piece.owner, []).append(piece)
    for pieces in found.values():
        pieces.sort(key=lambda piece: tuple(problem.terms[piece.place].shape.values()))
    return found


def sharpened(problem: Problem, pieces: Sequence[Piece]) -> Problem:
    """Return the problem with further values of a shape on both sides of those that fit best.

    A grid is as fine as a moderate effect asks for; of a large one it leaves a residual that a second cause or a
    wander of the noise would then explain.
    """
    new: list[Term] = []
    for piece in {(item.owner, item.place): item for item in pieces if item.kind == "term"}.values():
        candidate = problem.candidates[piece.owner]
        for unknown in candidate.shapes:
            if not unknown.whole and not unknown.along:
                for shape in _between(problem, piece, unknown.name):
                    new += variants_of(piece.owner, candidate, problem.machine, shape, problem.scales)
    return _with_terms(problem, new)


def bent(problem: Problem, fitted: Sequence[tuple[Piece, float]]) -> Problem:
    """Return the problem with the chords of causes at the coefficients that they were fitted with.

    Twins of these causes that are other curves at this size are causes of their own from then on.
    """
    terms = [(problem.terms[piece.place], coefficient) for piece, coefficient in fitted if piece.kind == "term"]
    gone, twins = Parting(problem.candidates, problem.machine, problem.scales).parted(terms, problem.twins)
    new = [*bent_terms(terms, problem.terms, problem.candidates, problem.machine, problem.scales)]
    return _with_terms(_with_short_slopes(replace(problem, twins=twins), new), [*gone, *new])


def _with_short_slopes(problem: Problem, chords: Sequence[Term]) -> Problem:
    """Return the problem with slopes that stand only for sizes at which no chord is seen to be another curve.

    Else the slope of a cause that has long bent would compete for it, and tie with another cause that is straight.
    """
    pieces = list(problem.term_pieces)
    for chord in chords:
        for number, piece in enumerate(pieces):
            term = problem.terms[piece.place]
            is_slope = term.candidate == chord.candidate and term.shape == chord.shape and not term.at
            if is_slope and term.files == (-1,) and is_seen_to_bend(chord, term, problem.scales):
                end = chord.at / term.per[0]
                low, high = (
                    (piece.low, (min(piece.high[0], end),)) if end > 0 else ((max(piece.low[0], end),), piece.high)
                )
                pieces[number] = replace(piece, low=low, high=high)
    return replace(problem, term_pieces=tuple(pieces))


def at_shapes(problem: Problem, pieces: Sequence[Piece], shapes: Mapping[int, Mapping[str, float]]) -> Problem:
    """Return the problem with further variants of pieces, at the shapes (SI) given by their place."""
    new: list[Term] = []
    for place, values in shapes.items():
        piece = pieces[place]
        shape = {**problem.terms[piece.place].shape, **values}
        new += variants_of(piece.owner, problem.candidates[piece.owner], problem.machine, shape, problem.scales)
    return _with_terms(problem, new)


def with_chords(problem: Problem) -> Problem:
    """Return the problem with chords of every cause that may bend, from the smallest sizes to its bounds."""
    new: list[Term] = []
    for place, candidate in enumerate(problem.candidates):
        new += far_terms(place, candidate, problem.machine, problem.scales)
    return _with_terms(problem, new)


def of_their_own(problem: Problem, pieces: Sequence[Piece]) -> Problem:
    """Return the problem with the causes of some pieces as twins of no other: their curves have parted."""
    owners = {piece.owner for piece in pieces if piece.kind == "term"}
    left = {place: tuple(twin for twin in twins if twin.place not in owners) for place, twins in problem.twins.items()}
    return replace(problem, twins={**dict.fromkeys(owners, ()), **left})


def with_pairs(problem: Problem, terms: Sequence[tuple[Term, Term]]) -> Problem:
    """Return the problem with further pairs: a first term, and a second as it is beside that one.

    Their bounds are left to the exact fit: what a linear size oversteps the true one may keep.
    """
    made, count = _Columns(problem.columns), len(problem.terms)
    every = list({id(term): term for pair in terms for term in pair}.values())
    pieces = {id(term): _unbounded(made.term(count + place, term)) for place, term in enumerate(every)}
    added = tuple((pieces[id(first)], pieces[id(second)]) for first, second in terms)
    return replace(
        problem, terms=(*problem.terms, *every), columns=tuple(made.columns), beside=(*problem.beside, *added)
    )


def _unbounded(piece: Piece) -> Piece:
    low, high = unbounded(piece.columns)
    return replace(piece, low=low, high=high)


def without_pieces(problem: Problem) -> Problem:
    """Return the problem with nothing that competes."""
    return replace(problem, terms=(), columns=(), term_pieces=(), input_pieces=(), shape_pieces=(), beside=())


def _with_terms(problem: Problem, new: Sequence[Term]) -> Problem:
    made = _Columns(problem.columns)
    terms = [*problem.terms, *new]
    pieces = [made.term(len(problem.terms) + place, term) for place, term in enumerate(new)]
    added = (*problem.term_pieces, *pieces)
    return replace(problem, terms=tuple(terms), term_pieces=added, columns=tuple(made.columns))


def _between(problem: Problem, piece: Piece, name: str) -> list[dict[str, float]]:
    """Return shapes between one and its two neighbours on the grid of one of its unknowns, the others as they are."""
    own = problem.terms[piece.place].shape
    others = {key: value for key, value in own.items() if key != name}
    every = [problem.terms[each.place].shape for each in _by_owner(problem)[piece.owner]]
    grid = sorted({shape[name] for shape in every if others.items() <= shape.items()})
    at = grid.index(own[name])
    values = []
    for near_by in (grid[at - 1] if at else None, grid[at + 1] if at + 1 < len(grid) else None):
        if near_by is not None and abs(near_by - grid[at]) > FINEST * abs(grid[at]):
            values += [grid[at] + (near_by - grid[at]) * share for share in SHARES]
    return [{**others, name: value} for value in values]
