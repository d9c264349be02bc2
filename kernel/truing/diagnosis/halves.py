"""Whether the two halves of a record say the same: the chosen explanation is fitted to each of them.

Rows that have an order are parted in the middle, others at random. A cause that is there is as large in both.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.chosen import Chosen
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import refitted
from truing.diagnosis.intervals import certainty_of, value_of
from truing.diagnosis.result import Amount, Contradiction
from truing.diagnosis.sample import Sample, has_order

if TYPE_CHECKING:
    from numpy.typing import NDArray

APART = 4.0
"""Standard errors by which an amplitude differs between halves that contradict one another: by chance 1 in 16,000."""
FEWEST = 10
"""Rows for every number that a half must have: of fewer its own standard errors are not known."""


def contradictions_of(chosen: Chosen) -> tuple[Contradiction, ...]:
    """Return the amplitudes of named causes that are not the same in both halves of the record."""
    best = chosen.best
    if not best.causes or best.sample.rows < 2 * FEWEST * (best.size + len(best.inputs) ** 0.5):
        return ()
    extended = chosen.competition.extended
    halves = [refitted(best, extended, mask) for mask in _other_halves(best.sample)]
    fitted = [found for found in halves if found is not None]
    if len(fitted) < 2:
        return ()
    certain = [certainty_of(found, extended) for found in fitted]
    known, made = best.sample.machine.start.model.known_effects, []
    for place, (name, number) in enumerate(_amplitudes(best)):
        if not name:
            continue
        values = [value_of(found, place) for found in fitted]
        error = hypot(*(each.in_si([place])[0][0] ** 0.5 for each in certain))
        if error > 0 and abs(values[0] - values[1]) > APART * error:
            unit = next(each.unit for each in known[name].unknowns if each.name == number)
            made.append(Contradiction(name, number, Amount(values[0], unit), Amount(values[1], unit)))
    return tuple(made)


def _amplitudes(best: Fit) -> Iterator[tuple[str, str]]:
    """Give effect and unknown of every number; no effect where the number is no amplitude of one, or of one file."""
    for cause in best.causes:
        for number in cause.numbers:
            is_one = cause.effect is not None and number.is_amplitude and number.file < 0
            yield cause.name if is_one else "", number.name


def _other_halves(sample: Sample, seed: int = 1) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Mark what is left out: the second half of the rows, and the first."""
    usable = np.flatnonzero(sample.mask)
    if not has_order(sample.machine):
        usable = np.random.Generator(np.random.SFC64(seed)).permutation(usable)
    first = np.zeros(len(sample.mask), dtype=bool)
    first[usable[: len(usable) // 2]] = True
    return sample.mask & ~first, first
