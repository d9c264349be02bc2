"""Causes that are the same curve as a named one on this data, each as strong as that one, for what comes next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import Candidate, Curve, Term, new_curves
from truing.diagnosis.chords import may_bend
from truing.diagnosis.grids import terms_of
from truing.diagnosis.hypotheses import Hypothesis, Piece
from truing.diagnosis.machine import Machine
from truing.diagnosis.twins import Parting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from truing.diagnosis.contest import Contest

    Matrix = NDArray[np.float64]


def is_physical(hypothesis: Hypothesis) -> bool:
    """Whether an explanation is made of causes and inputs alone, so that it says something at other settings."""
    return hypothesis.kind in {"one", "two", "input"}


@dataclass(frozen=True)
class TwinTerm:
    """A cause that draws the curve of a named one on this data: its name, and one term in place of that piece."""

    name: str
    piece: int
    candidate: Candidate
    term: Term


def twins_of(full: Contest, hypothesis: Hypothesis, coefficients: Sequence[float]) -> list[TwinTerm]:
    """Return the causes that are the same curve as a piece of a hypothesis: other settings may tell them apart.

    ``coefficients`` are those of its columns: what can only add is no twin of what takes away.
    """
    problem = full.problem
    parting = Parting(problem.candidates, problem.machine, full.noise.scales)
    found: list[TwinTerm] = []
    before = 0
    for number, piece in enumerate(hypothesis.pieces if is_physical(hypothesis) else ()):
        own = coefficients[before : before + len(piece.columns)]
        before += len(piece.columns)
        for name in problem.same_curve(piece.owner, own) if piece.kind == "term" else ():
            for place, candidate in enumerate(problem.candidates):
                if candidate.name == name:
                    curve = parting.as_large(problem.terms[piece.place], own[0])
                    strong = None if curve is None else parting.as_strong(place, curve)
                    terms = (
                        [strong]
                        if strong is not None
                        else terms_of(place, candidate, problem.machine, full.noise.scales)
                    )
                    found += [TwinTerm(name, number, candidate, term) for term in terms[:1] if len(terms) == 1]
    return found


def believed(full: Contest, there: Machine, piece: Piece, coefficients: Matrix) -> Curve:
    """Return what a cause of this size does at the settings that are tried, SI: bent as it is there."""
    import numpy as np

    term, candidate = full.problem.terms[piece.place], full.problem.candidates[piece.owner]
    sizes = [float(value) * per for value, per in zip(coefficients, term.per, strict=True)]
    if len(sizes) == 1 and sizes[0] and may_bend(candidate):
        term = replace(term, at=sizes[0])
    curves = new_curves(there, candidate, term)
    return {name: np.asarray(sum(c[name] * size for c, size in zip(curves, sizes, strict=True))) for name in curves[0]}
