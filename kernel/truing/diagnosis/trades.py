"""Whether a named cause trades against a tolerated input: a little of the one is drawn as well by the other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from truing.diagnosis.arrays import Matrix
from truing.diagnosis.chosen import Chosen
from truing.diagnosis.fitted import Fit
from truing.diagnosis.intervals import Certainty, certainty_of, places_of, value_of
from truing.diagnosis.result import Trade
from truing.diagnosis.verdict import APART

TRADED = 0.95
"""Correlation of an amplitude and an input above which they trade. With the input held at its value the standard error
of the amplitude would be sqrt(1 - 0.95^2) of what it is, a third: so much is lost to the tolerance of the input."""


def trades_of(chosen: Chosen) -> tuple[Trade, ...]:
    """Return the named effects that this record does not separate from one of the tolerated inputs.

    The correlation is that of the exact fit, with the tolerances in force: an input that is known well enough has none.
    A cause that is far from zero even with every input free is separated all the same: only what ``APART`` calls
    separable at most weakly is returned.
    """
    best = chosen.best
    if not len(best.inputs) or not any(cause.effect is not None for cause in best.causes):
        return ()
    certainty = certainty_of(best, chosen.competition.extended)
    return tuple(_trades(best, certainty))


def _trades(best: Fit, certainty: Certainty) -> Iterator[Trade]:
    alike, inputs = _correlations(best, certainty), best.sample.machine.inputs
    shifted = [cause.tolerated for cause in best.causes if cause.tolerated >= 0]
    alike[:, shifted] = 0.0
    for cause in best.causes:
        if cause.effect is None:
            continue
        places = [places_of(best, cause)[place] for place in cause.amplitudes]
        number, item = np.unravel_index(int(np.argmax(np.abs(alike[places]))), (len(places), len(inputs)))
        correlation = float(alike[places[number], item])
        separation = _separation(best, certainty, places)
        if abs(correlation) > TRADED and separation < APART:
            unknown = cause.numbers[cause.amplitudes[number]].name
            yield Trade(cause.name, unknown, inputs[item].name, correlation, separation)


def _correlations(best: Fit, certainty: Certainty) -> Matrix:
    """Return the correlation of every number with every input, (numbers, inputs).

    Of what the rows do not see of an input its tolerance is all that is known.
    """
    size, directions = best.size, best.sample.directions
    covariance = certainty.covariance
    seen = np.einsum("ij,jk,ik->i", directions, covariance[size:, size:], directions)
    variance = seen + np.maximum(1 - np.sum(directions**2, axis=1), 0.0)
    own = np.outer(np.diag(covariance)[:size], variance)
    return np.asarray(covariance[:size, size:] @ directions.T / np.sqrt(np.maximum(own, 1e-300)))


def _separation(best: Fit, certainty: Certainty, places: list[int]) -> float:
    """Return how far the amplitudes of a cause are from zero, all else free: the squares that are lost, lambda."""
    values = np.array([value_of(best, place) for place in places]) / certainty.units[places]
    inverse = np.linalg.pinv(certainty.covariance[np.ix_(places, places)], hermitian=True)
    return float(values @ inverse @ values)
