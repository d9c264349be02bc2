"""The shift that keeps every limit although the parts scatter, and what scatter leaves of the contact ratio.

The screws are drawn once; every shift is tried on all of them at once. What is asked of a shift is a probability: so
many of the screws must keep every limit together, not one limit after the other.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from roller_screw_shift.calculation import MARGINS
from truing import Array, Bench, Float

SCREWS = 8192  # drawn to tell what scatter leaves of the margins
FEWER, PLACES = 1024, 65  # of them, and shifts, over which the contact ratio is drawn
NEAR = 1e-8  # of a shift
RATIO = MARGINS.index("margin_contact_ratio")


@dataclass(frozen=True, eq=False)
class Screws:
    """Screws as their parts scatter (n,) by column, and the bench that calculates them."""

    bench: Bench
    columns: Mapping[str, Array]
    count: int

    def margins(self, shift: Float) -> NDArray[np.float64]:
        """Return the margins at one shift, or one for each screw, (margins, n); -1 where one does not exist."""
        columns = {**self.columns, "roller_shift": np.broadcast_to(shift, self.count)}
        found = self.bench.rows(columns, self.count, *MARGINS)
        values = np.array([np.broadcast_to(found[name], self.count) for name in MARGINS], dtype=float)
        return np.where(np.isfinite(values), values, -1.0)

    def kept(self, shift: float) -> float:
        """Return the share of screws that keep every limit at this shift."""
        return float(np.mean(np.all(self.margins(shift) >= 0.0, axis=0)))

    def level(self, shift: float, probability: float) -> float:
        """Return the smallest margin that so many screws reach, each margin in its own unit: 0 or more where they keep.

        At most 1 - ``probability`` of the screws have a smaller one.
        """
        return float(_quantile(self.margins(shift).min(axis=0), probability))


def screws_of(bench: Bench, count: int = SCREWS) -> Screws:
    """Draw the first screws that a reliability study draws."""
    return Screws(bench, bench.drawn(count), count)


def _quantile(values: Array, probability: float) -> float:
    most = int(np.floor((1.0 - probability) * len(values) * (1.0 + 1e-12)))  # so many may lie below
    return float(np.partition(values, most)[most])


# Over the shifts: which contact ratio so many screws reach, and where they keep every limit


@dataclass(frozen=True, eq=False)
class RatioCourse:
    """Shifts (n,) and the contact ratio there that so many screws reach, with all other limits kept; -1 for none."""

    shifts: Array
    reached: Array

    def at(self, shifts: Array) -> NDArray[np.float64]:
        """Return the contact ratio that is reached at these shifts; -1 beyond."""
        return np.interp(shifts, self.shifts, self.reached, left=-1.0, right=-1.0)


def ratio_course(screws: Screws, span: tuple[float, float], probability: float, least: float) -> RatioCourse:
    """Return which contact ratio ``probability`` of the screws reach over the shifts; ``least`` is the stated limit."""
    shifts = np.linspace(*span, PLACES)
    columns = {name: np.tile(values[:FEWER], PLACES) for name, values in screws.columns.items()}
    every = Screws(screws.bench, columns, FEWER * PLACES).margins(np.repeat(shifts, FEWER))
    ratio, others = every[RATIO].reshape(PLACES, FEWER) + least, np.delete(every, RATIO, axis=0)
    kept = np.all(others >= 0.0, axis=0).reshape(PLACES, FEWER)
    reached = [_quantile(np.where(*each, -1.0), probability) for each in zip(kept, ratio, strict=True)]
    return RatioCourse(shifts, np.array(reached))


def held(screws: Screws, course: RatioCourse, probability: float, least: float) -> tuple[tuple[float, float], ...]:
    """Return the shifts, from and to, at which at least ``probability`` of the screws keep every limit.

    The course of fewer screws tells where to look; all screws tell where the ends are. What is narrower than a step of
    the course and lies between two of its places is not seen.
    """
    within = np.concatenate([[False], course.reached >= least, [False]])
    turns = np.flatnonzero(within[1:] != within[:-1])
    found = []
    for first, beyond in zip(turns[::2], turns[1::2], strict=True):
        ends = [_end(screws, course.shifts, places, probability)
                for places in (range(first, beyond), range(beyond - 1, first - 1, -1))]  # fmt: skip
        if ends[0] is not None and ends[1] is not None:
            found.append((ends[0], ends[1]))
    return tuple(found)


def _end(screws: Screws, shifts: Array, places: range, probability: float) -> float | None:
    """Return the first shift, from the first place on, at which enough screws keep every limit; None where nowhere."""
    kept = next((place for place in places if screws.level(float(shifts[place]), probability) >= 0.0), None)
    if kept is None:
        return None
    within, before = float(shifts[kept]), kept - places.step
    if not 0 <= before < len(shifts):
        return within
    beyond = float(shifts[before])
    if screws.level(beyond, probability) >= 0.0:
        return beyond
    end = float(scipy.optimize.brentq(screws.level, beyond, within, args=(probability,), xtol=NEAR))
    while screws.level(end, probability) < 0.0:
        end += places.step * NEAR
    return end
