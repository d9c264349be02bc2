"""Effects that are not in proportion to their size: chords of their curves beside the slope at no effect.

The search is linear. An effect that begins late (a film that is first felt when it is as thick as the roughness) has no
slope at zero at all, and one that is large has bent: what its slope leaves would then pass for a second cause.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf

from truing.diagnosis.candidates import (
    Candidate,
    Term,
    TermColumn,
    chord_at,
    made_term,
    si_bounds,
    stacked,
    stands_still,
    works,
)
from truing.diagnosis.machine import Machine
from truing.diagnosis.readings import reading_of

SHARES = (1.0, 0.6, 0.35, 0.2, 0.1)
"""Of its bound: the sizes at which an effect is tried that has no slope at zero."""
FAINT = 0.05
"""Root mean square, in units of the noise, that the slope of an effect must reach at its bound to be looked for."""
STRAIGHT = 1e-4
"""Sine squared of the angle between chord and slope up to which both are one curve."""
AROUND = (1.0, 2.0, 4.0, 0.5)
"""Of the size that a fit has led to: one that bends is larger, or smaller, than its slope or another chord says."""
SEEN = 1.0
"""Squared, in units of the noise: what a chord leaves of another curve that is as large, from which both are kept."""
HALVINGS = 10
"""How often the bound of an effect is halved for the smallest size at which it is tried by chords."""
REACH = 3.0
"""A chord stands for sizes up to so many times its own: farther off the curve is another one."""
ALIKE = 0.05
"""Chords of sizes that differ by a smaller share are one chord."""


def are_faint(terms: Sequence[Term], scales: Mapping[str, float]) -> bool:
    """Whether the slopes of an effect show nothing even at its bounds."""
    import numpy as np

    for term in terms:
        for curve, low, high, per in zip(term.curves, term.low, term.high, term.per, strict=True):
            farthest = max(-low, high) * per
            if farthest * float(np.sqrt(np.mean(stacked(curve, scales) ** 2))) > FAINT:
                return False
    return True


def late_terms(place: int, candidate: Candidate, machine: Machine, scales: Mapping[str, float]) -> list[Term]:
    """Return chords of an effect that has no slope at zero; none where it does nothing up to its bounds."""
    if not has_chords(candidate) or candidate.shapes or stands_still(candidate, machine):
        return []
    found: list[Term] = []
    for bound in si_bounds(candidate.amplitudes[0]):
        for share in SHARES if bound else ():
            term = chord(place, candidate, machine, scales, (share * bound, {}))
            if not term:
                break
            found += term
    return found


def far_terms(place: int, candidate: Candidate, machine: Machine, scales: Mapping[str, float]) -> list[Term]:
    """Return chords of an effect on inputs that may bend, at sizes from its bounds down, each half of the last."""
    if not may_bend(candidate) or candidate.shapes or stands_still(candidate, machine):
        return []
    found: list[Term] = []
    for bound in si_bounds(candidate.amplitudes[0]):
        for halving in range(HALVINGS) if bound else ():
            found += chord(place, candidate, machine, scales, (bound / 2**halving, {}), reach=REACH)
    return found


def has_chords(candidate: Candidate) -> bool:
    """Whether an effect has one amplitude and need not be linear in it; those of the kernel are."""
    return len(candidate.amplitudes) == 1 and reading_of(candidate.effect) is None


def may_bend(candidate: Candidate) -> bool:
    """Whether a chord may differ from the slope: a term that is added to a result is in proportion to its size."""
    return candidate.effect.place == "inputs" and has_chords(candidate)


def one_side(candidate: Candidate, size: float) -> tuple[float, float]:
    """Return the bounds of the one amplitude of a candidate on the side of zero that a size is on, SI."""
    low, high = si_bounds(candidate.amplitudes[0])
    return (max(low, 0.0), high) if size > 0 else (low, min(high, 0.0))


def chord(
    place: int,
    candidate: Candidate,
    machine: Machine,
    scales: Mapping[str, float],
    point: tuple[float, Mapping[str, float]],
    *,
    reach: float = inf,
) -> list[Term]:
    """Return the term of an amplitude (SI) and shapes: what the effect of that size does, per unit of its size.

    It stands for amplitudes from that size over ``reach`` to ``reach`` times it.
    """
    size, shape = point
    low, high = one_side(candidate, size)
    near = sorted((size / reach, size * reach))
    side = max(low, near[0]), min(high, near[1])
    curve = chord_at(machine, candidate, size, shape)
    if not works(machine, curve):
        return []
    column = TermColumn(curve, candidate.amplitudes[0].name, -1, *side)
    return [replace(term, at=size) for term in made_term(place, [column], shape, scales)]


def bent_terms(
    fitted: Sequence[tuple[Term, float]],
    known: Sequence[Term],
    candidates: Sequence[Candidate],
    machine: Machine,
    scales: Mapping[str, float],
) -> Iterator[Term]:
    """Give the chords of terms about the sizes they were fitted with, where these are no longer their slopes."""
    taken = list(known)
    for term, coefficient in fitted:
        candidate = candidates[term.candidate]
        if len(term.curves) != 1 or term.files != (-1,) or not may_bend(candidate):
            continue
        for share in AROUND if coefficient else ():
            size = min(max(share * coefficient, term.low[0]), term.high[0]) * term.per[0]
            if size == 0 or any(_is_near(other, term, size) for other in taken):
                continue
            for new in chord(term.candidate, candidate, machine, scales, (size, term.shape), reach=REACH):
                taken.append(new)
                if _is_bent(new, term, scales):
                    yield new


def _is_near(other: Term, term: Term, size: float) -> bool:
    """Whether there is a chord of about this size already."""
    is_same = other.candidate == term.candidate and other.shape == term.shape
    return is_same and other.at != 0 and abs(other.at / size - 1) < ALIKE


def is_seen_to_bend(new: Term, term: Term, scales: Mapping[str, float]) -> bool:
    """Whether a chord is another curve than a term, by more than the noise at its size."""
    apart, size = _apart(new, term, scales)
    return apart * size > SEEN


def _is_bent(new: Term, term: Term, scales: Mapping[str, float]) -> bool:
    """Whether a chord is another curve than a term: in its direction, or by more than the noise at its size."""
    apart, size = _apart(new, term, scales)
    return apart > STRAIGHT or apart * size > SEEN


def _apart(new: Term, term: Term, scales: Mapping[str, float]) -> tuple[float, float]:
    """Return the sine squared of the angle between a chord and a term, and the square of the chord in noise units."""
    import numpy as np

    a, b = stacked(new.curves[0], scales), stacked(term.curves[0], scales)
    sizes = float(a @ a) * float(b @ b)
    if not np.isfinite(sizes) or sizes <= 0:
        return 0.0, 0.0
    return 1 - float(a @ b) ** 2 / sizes, float(a @ a) * new.at**2
