"""Which lags are looked at: those of the fit, evenly in their logarithm, and those between which slopes are taken."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Steps = NDArray[np.int64]
SHARE = 0.1  # of a line: the longest lag of the fit; longer ones lie too seldom side by side to say much
LOCAL_SHARE = 0.25  # of a line: the longest lag of the local slopes
LOCAL_COUNT = 9
SLACK = 1e-9  # so that a limit that is a multiple of the spacing is itself a lag


def fit_steps(points: int, shortest: float, longest: float, count: int) -> Steps:
    """Return up to ``count`` whole lags, evenly in their logarithm.

    ``shortest`` and ``longest`` in points; NaN for one point and for a tenth of a line.
    """
    last = int(SHARE * points * (1 + SLACK)) if np.isnan(longest) else int(longest * (1 + SLACK))
    return _even(_first(shortest), min(last, points - 1), count)


def stated_steps(points: int, lags: Sequence[float]) -> Steps:
    """Return stated lags, in points, as whole numbers that fit a line, each once."""
    whole = np.unique(np.round(np.asarray(lags, dtype=float))).astype(np.int64)
    return whole[(whole >= 1) & (whole < points)]


def local_steps(points: int, shortest: float) -> Steps:
    """Return the lags between which local slopes are taken: from the shortest (NaN: a point) to a quarter of a line."""
    return _even(_first(shortest), LOCAL_SHARE * points, LOCAL_COUNT)


def _first(shortest: float) -> int:
    return 1 if np.isnan(shortest) else max(1, int(np.ceil(shortest * (1 - SLACK))))


def _even(first: float, last: float, count: int) -> Steps:
    if last < first:
        return np.empty(0, dtype=np.int64)
    return np.unique(np.round(np.geomspace(first, last, count))).astype(np.int64)
