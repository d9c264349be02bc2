"""Causes that draw one curve while they are small: who they are, and which of them part when they are as large as here.

Curves are first compared by their slopes at no effect. A cause that bends parts from one that does not, once it is
large enough for the data to see it; from then on it competes as one of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import Candidate, Curve, Term, si_bounds, stacked, variants_of
from truing.diagnosis.chords import REACH, chord, has_chords, may_bend
from truing.diagnosis.machine import Machine, gram_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

VISIBLE = 9.0
"""Squared, in units of the noise: what one curve must leave of another for both to be told apart (three sigma)."""
STEPS = 20
EQUAL = 1e-3
"""Share of its size up to which a cause is as strong as a curve, and how often its chord is made anew for that."""


@dataclass(frozen=True)
class Twin:
    """A cause that is the curve of another one here, where the coefficient of that one has one of these signs.

    ``place`` is that of its candidate.
    """

    name: str
    sides: tuple[int, ...]
    place: int


Twins = Mapping[int, tuple[Twin, ...]]


class Parting:
    """Compares fitted causes with their twins at the size that they have in the data."""

    def __init__(self, candidates: Sequence[Candidate], machine: Machine, scales: Mapping[str, float]) -> None:
        self.candidates, self.machine, self.scales = candidates, machine, scales

    def parted(self, fitted: Sequence[tuple[Term, float]], twins: Twins) -> tuple[list[Term], Twins]:
        """Return chords of the twins that part from what was fitted, and the twins that are left.

        Twins that part from the same cause and draw one curve are twins of one another from then on.
        """
        new: list[Term] = []
        left = dict(twins)
        for term, coefficient in fitted:
            owner = term.candidate
            own = self.as_large(term, coefficient) if left.get(owner) else None
            gone: list[Term] = []
            if own is None:
                continue
            for twin in left[owner]:
                other = self.as_strong(twin.place, own)
                if other is None or not self._differs(own, other):
                    continue
                left[owner] = tuple(each for each in left[owner] if each.place != twin.place)
                like = next((each for each in gone if not self._differs(_sized(each), other)), None)
                if like is None:
                    gone.append(other)
                    left[twin.place] = ()
                else:
                    way = Twin(twin.name, (1 if like.at > 0 else -1,), twin.place)
                    left[like.candidate] = (*left[like.candidate], way)
            new += gone
        return new, left

    def as_large(self, term: Term, coefficient: float) -> Curve | None:
        """Return the curve of a cause of one amplitude as it was fitted, SI; None where it has none."""
        import numpy as np

        if len(term.curves) != 1 or term.files != (-1,):
            return None
        size = min(max(coefficient, term.low[0]), term.high[0]) * term.per[0]
        candidate = self.candidates[term.candidate]
        if size and may_bend(candidate):
            made = chord(term.candidate, candidate, self.machine, self.scales, (size, term.shape))
            return _sized(made[0]) if made else None
        return {name: np.asarray(values) * size for name, values in term.curves[0].items()} if size else None

    def as_strong(self, place: int, curve: Curve) -> Term | None:
        """Return the chord of a cause that is as strong as a curve; None of one that does not bend, or cannot be so."""
        candidate = self.candidates[place]
        if candidate.shapes or not has_chords(candidate):
            return None
        wanted = stacked(curve, self.scales)
        low, high = si_bounds(candidate.amplitudes[0])
        for term in variants_of(place, candidate, self.machine, {}, self.scales):
            size = _strength(term, wanted, self.scales)
            if not size or not low <= size <= high or not term.low[0] <= size / term.per[0] <= term.high[0]:
                continue
            for _ in range(STEPS):
                made = chord(place, candidate, self.machine, self.scales, (size, {}), reach=REACH)
                before, size = size, min(max(_strength(made[0], wanted, self.scales), low), high) if made else 0.0
                if not made or not size or abs(size - before) <= EQUAL * abs(before):
                    return next(iter(made), None)
        return None

    def _differs(self, curve: Curve, other: Term) -> bool:
        """Whether the data could see what a term leaves of a curve, beside what the tolerances may be."""
        gram = self._visible(curve, _sized(other))
        return bool(gram[0, 0] - gram[0, 1] ** 2 / max(gram[1, 1], 1e-300) > VISIBLE)

    def _visible(self, *curves: Curve) -> Matrix:
        """Return the inner products of what is left of curves when the tolerated inputs have taken their part."""
        import numpy as np

        from truing.diagnosis.sight import visible

        slopes = self.machine.slopes
        gram = np.asarray(sum(gram_of(slopes[name]) / scale**2 for name, scale in self.scales.items()))
        moves = self.machine.directions(gram, len(self.machine.records) * len(self.scales))
        inputs = np.concatenate([np.nan_to_num(slopes[name] @ moves) / scale for name, scale in self.scales.items()])
        made = np.column_stack([inputs, *(stacked(curve, self.scales) for curve in curves)])
        return visible(made.T @ made, moves.shape[1])


def _strength(term: Term, wanted: Matrix, scales: Mapping[str, float]) -> float:
    """Return the amplitude (SI) with which a term comes nearest to a curve."""
    own = stacked(term.curves[0], scales)
    return float(own @ wanted) / float(own @ own)


def _sized(term: Term) -> Curve:
    """Return the whole curve of a chord."""
    import numpy as np

    return {name: np.asarray(values) * term.at for name, values in term.curves[0].items()}
