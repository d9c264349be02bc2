"""Noise of a test rig: a slow wander beside white noise, heavy tails, a spread that depends on something.

Inside a run the noise is eta_i = rho * eta_{i-1} + u_i - theta * u_{i-1}, divided by a weight per row; theta = 0 is
AR(1), theta > 0 a slow wander plus white noise. The filter starts anew at every run.

A censored reading (a run-out, a gauge at its end) leaves ``sqrt(-2 ln Phi(z))``, z by how many standard deviations of
the noise the prediction lies beyond the end: its square is what the likelihood asks for (J. Tobin, Econometrica 26,
1958, 24). A prediction far beyond leaves nothing, one that falls far short leaves what any reading would.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from scipy.linalg.lapack import dtbtrs
from scipy.optimize import minimize_scalar
from scipy.special import erfcx, gammaln, log_ndtr, ndtri, stdtr

from truing.arrays import Indices, Mask, Matrix, Sides
from truing.diagnosis.ranking import lowest_first

TAILS = {3.0: 1.9, 4.0: 2.1, 6.0: 2.5, 10.0: 3.0, inf: 4.5}
"""Degrees of freedom of Student's t, and where innovations are clipped, in standard deviations."""
HEAVIER = 1.92
"""In log-likelihood: tails that are no heavier than normal seem so by chance in one record of twenty."""
READINGS_AT_ONCE = 16_384
"""Readings whose likelihood under every tail is taken in one pass."""
SMALLEST_SHARE, ROUNDED, SMALLEST = 1e-6, 1e-14, 1e-150
"""Of the errors and of the readings: noise is no smaller, or it is rounding; the least whose square is not zero."""
LARGEST_EXPONENT = 2.5
"""The noise differs between rows by at most exp(2.5), twelve times, to each side."""
SPREAD_LEVEL = 0.01
"""Significance of a spread. At 0.002 one that grows threefold was found in 12 % of records of 50 rows and four drivers,
at this one in 28 %; of the best test there can be 56 % are expected, rows without end."""
MOST_SHARE_ROUNDS, SHARES_SETTLED = 500, 1e-12
"""The mean square of censored rows is taken anew until it changes by a smaller share, and so often at most."""


@dataclass(frozen=True)
class Autocorrelation:
    """One noise filter: ``rho`` carries over from row to row, ``theta`` is the white share on top of the wander."""

    rho: float = 0.0
    theta: float = 0.0

    @property
    def variance_ratio(self) -> float:
        """Variance of the noise over that of its innovations."""
        return (1 + self.theta**2 - 2 * self.rho * self.theta) / (1 - self.rho**2)

    @property
    def size(self) -> int:
        """Number of its parameters: they are paid for like any other, else a slow effect is a wander at no cost."""
        return int(self.rho > 0) + int(self.theta > 0)

    @property
    def neighbours(self) -> float:
        """Autocorrelation of neighbouring rows."""
        covariance = (1 - self.rho * self.theta) * (self.rho - self.theta) / (1 - self.rho**2)
        return covariance / self.variance_ratio


SETTINGS = (
    *(Autocorrelation(rho) for rho in (0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.87, 0.92)),
    Autocorrelation(0.8, 0.4), Autocorrelation(0.9, 0.5), Autocorrelation(0.9, 0.7),
    Autocorrelation(0.92, 0.6), Autocorrelation(0.92, 0.8),
)  # fmt: skip


def carried_over(driven: Matrix, starts: Mask, share: float) -> Matrix:
    """Return x_i = driven_i + share * x_{i-1} inside every run, shape (n,) or (n, c).

    ``starts`` marks the first row of each run.
    """
    if not driven.size:  # scipy's dtbtrs writes past the end of an array without columns
        return np.array(driven)
    band = np.ones((2, len(starts)))
    band[1, :-1] = -share * ~starts[1:]
    solved, _ = dtbtrs(band, driven.reshape(len(starts), -1), uplo="L", diag="U")
    return np.asarray(solved.reshape(driven.shape))


def whiten(values: Matrix, starts: Mask, setting: Autocorrelation) -> Matrix:
    """Turn noise of this filter into independent innovations, shape (n,) or (n, c), run by run."""
    ratio = setting.variance_ratio
    white = np.array(values, dtype=float)
    if setting.rho == 0 and setting.theta == 0:
        return white
    white[1:] -= setting.rho * values[:-1]
    if setting.theta:
        white[starts] = values[starts] / ratio
        white = carried_over(white, starts, setting.theta)
    white[starts] = values[starts] / np.sqrt(ratio)
    return white


def colour(white: Matrix, starts: Mask, setting: Autocorrelation) -> Matrix:
    """Undo ``whiten``: make noise of this filter from independent innovations."""
    ratio = setting.variance_ratio
    driven = np.array(white, dtype=float)
    driven[1:] -= setting.theta * white[:-1]
    begin = white * np.sqrt(ratio)
    second = np.flatnonzero(starts[:-1] & ~starts[1:]) + 1
    driven[second] += setting.theta * (white[second - 1] - begin[second - 1] / ratio)
    driven[starts] = begin[starts]
    return carried_over(driven, starts, setting.rho)


@dataclass(frozen=True)
class Tails:
    """How innovations scatter beyond the normal law: degrees of freedom, and where they are clipped for the scale."""

    freedom: float
    limit: float

    @property
    def words(self) -> str:
        """What an engineer reads."""
        return "normal" if self.freedom == inf else f"heavy (t with {self.freedom:g} degrees of freedom)"


def robust_sd(innovations: Matrix) -> float:
    """Return the standard deviation from the median absolute deviation."""
    return 1.4826 * float(np.median(np.abs(innovations - np.median(innovations))))


def rounding(errors: Matrix, readings: Matrix) -> float:
    """Return the standard deviation below which noise that leaves such errors of such readings is rounding."""
    sizes = (float(np.sqrt(np.mean(each**2))) if len(each) else 0.0 for each in (errors, readings))
    return max(SMALLEST, *(share * size for share, size in zip((SMALLEST_SHARE, ROUNDED), sizes, strict=True)))


def tails_of(innovations: Matrix) -> Tails:
    """Return the normal law, or Student's t where its profile over the scale is likelier by ``HEAVIER``."""
    totals = _by_freedom(innovations)
    freedom = max(totals, key=totals.__getitem__)
    freedom = freedom if totals[freedom] > totals[inf] + HEAVIER else inf
    return Tails(freedom, TAILS[freedom])


def likelihood_of(innovations: Matrix) -> float:
    """Return the log-likelihood of innovations under the tails that fit them best."""
    return max(_by_freedom(innovations).values()) - len(innovations) * float(np.log(_scale(innovations)))


def _scale(innovations: Matrix) -> float:
    return robust_sd(innovations) or float(np.std(innovations)) or 1.0


def _by_freedom(innovations: Matrix) -> dict[float, float]:
    """Return the largest log-likelihood of scaled innovations by degrees of freedom."""
    u = innovations / _scale(innovations)
    factors = np.exp(np.linspace(-0.6, 0.6, 25))
    totals = np.zeros((len(TAILS), len(factors)))
    for begin in range(0, len(u), READINGS_AT_ONCE):
        z2 = (u[begin : begin + READINGS_AT_ONCE] / factors[:, None]) ** 2
        for index, freedom in enumerate(TAILS):
            if freedom == inf:
                logs = -0.5 * z2 - 0.5 * np.log(2 * np.pi)
            else:
                norm = gammaln((freedom + 1) / 2) - gammaln(freedom / 2) - 0.5 * np.log(freedom * np.pi)
                logs = norm - (freedom + 1) / 2 * np.log1p(z2 / freedom)
            totals[index] += logs.sum(axis=1)
    largest = np.max(totals - len(u) * np.log(factors), axis=1)
    return dict(zip(TAILS, largest.tolist(), strict=True))


def clipped(innovations: Matrix, tails: Tails) -> Matrix:
    """Clip innovations at the limit of their tails: least squares on the rest is a one-step robust estimate."""
    scale = _scale(innovations)
    return np.clip(innovations, -tails.limit * scale, tails.limit * scale)


@dataclass(frozen=True)
class SpreadTrend:
    """How the standard deviation of the noise depends on one driver: exp(slope * z), z standardised."""

    driver: str = ""
    slope: float = 0.0
    p_value: float = 1.0

    @property
    def words(self) -> str:
        """What an engineer reads."""
        return f"{'grows' if self.slope > 0 else 'falls'} with {self.driver}" if self.driver else "constant"


def standardised(values: Matrix) -> Matrix:
    """Return a driver with mean 0 and standard deviation 1, missing values at the mean."""
    filled = np.where(np.isfinite(values), values, np.nanmean(values))
    sd = float(np.std(filled))
    return (filled - filled.mean()) / sd if sd > 0 else np.zeros_like(filled)


def spread_of(innovations: Matrix, drivers: dict[str, Matrix]) -> SpreadTrend:
    """Find what the spread of the innovations depends on, if on anything (Bonferroni over the drivers).

    Tested is the correlation of a driver with normal scores of the ranks of their sizes, which heavy tails do not reach
    (J. Capon, Ann. Math. Statist. 32, 1961, 88).
    """
    u = innovations / (robust_sd(innovations) or 1.0)
    tried = {name: z for name, values in drivers.items() if np.ptp(z := standardised(values)) > 0}
    ordered = np.sort(np.abs(u))
    ranks = sum(np.searchsorted(ordered, np.abs(u), side) for side in ("left", "right")) + 1
    sizes = ndtri(0.5 + 0.25 * ranks / (len(u) + 1))
    if not tried or len(u) < 20 or not np.ptp(sizes) > 0:
        return SpreadTrend()
    alike = {name: abs(float(np.corrcoef(z, sizes)[0, 1])) for name, z in tried.items()}
    name = lowest_first(alike, lambda driver: -alike[driver])[0]  # of drivers that are one the first
    off = alike[name] * sqrt((len(u) - 2) / max(1 - alike[name] ** 2, 1e-300))
    p_value = min(1.0, 2 * float(stdtr(len(u) - 2, -off)) * len(tried))
    if p_value >= SPREAD_LEVEL:
        return SpreadTrend()
    z = tried[name]

    def cost(slope: float) -> float:
        exponent = np.clip(slope * z, -LARGEST_EXPONENT, LARGEST_EXPONENT)
        return 0.5 * len(u) * float(np.log(np.mean(u**2 * np.exp(-2 * exponent)))) + float(exponent.sum())

    slope = float(minimize_scalar(cost, bounds=(-2.0, 2.0), method="bounded").x)
    return SpreadTrend(name, slope, p_value)


def weights_of(spread: SpreadTrend, driver: Matrix | None, learnt: Indices, rows: int) -> Matrix:
    """Return the weight of each of ``rows`` rows: one over the relative standard deviation of its noise.

    ``learnt`` are the rows that the spread was learnt from: the driver is standardised over them.
    """
    if driver is None or not spread.driver:
        return np.ones(rows)
    middle = np.nanmean(driver[learnt])
    filled = np.where(np.isfinite(driver), driver, middle)  # as in ``standardised``
    z = (filled - middle) / np.std(filled[learnt])
    exponent = np.clip(spread.slope * z, -LARGEST_EXPONENT, LARGEST_EXPONENT)
    return np.asarray(np.exp(-exponent))


def difference(values: Matrix, predicted: Matrix, typical: float) -> Matrix:
    """Return readings less predictions, SI; with a typical reading their logarithms, times that reading.

    What is small is then the difference of a reading of that size. A prediction that has no logarithm leaves NaN.
    """
    if not typical:
        return np.asarray(values - predicted)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(typical * (np.log(values) - np.log(predicted)))


def beyond(left: Matrix, sides: Sides) -> Matrix:
    """Return what is left (..., n), in units of the noise, with what censored rows leave."""
    cut, made = np.flatnonzero(sides), np.array(left)
    made[..., cut] = sides[cut] * np.sqrt(-2 * log_ndtr(-sides[cut] * left[..., cut]))
    return made


def shares(left: Matrix, sides: Sides) -> Matrix:
    """Return by row how fast what ``beyond`` makes of it follows the prediction: 1 where it was read, (n,)."""
    cut, made = np.flatnonzero(sides), np.ones(len(sides))
    z = -sides[cut] * left[cut]
    made[cut] = _hazard(z) / np.maximum(np.sqrt(-2 * log_ndtr(z)), 1e-150)
    return made


def worth(left: Matrix, sides: Sides) -> float:
    """Return how many rows (n,) are worth about a prediction: those that were read, and censored ones as they differ.

    Where the noise has its likeliest size, all that is left has this sum of squares: one that is far beyond its end
    is worth nothing.
    """
    cut = np.flatnonzero(sides)
    short = sides[cut] * left[cut]
    return float(len(left) - len(cut) + np.sum(-2 * log_ndtr(-short) - short * _hazard(-short)))


def expected(left: Matrix, sides: Sides) -> Matrix:
    """Return errors (n,), in units of the noise, those of censored rows as the root mean square beyond their ends."""
    cut, made = np.flatnonzero(sides), np.array(left)
    made[cut] = sides[cut] * np.sqrt(_square_beyond(sides[cut] * left[cut]))
    return made


def scale_of(left: Matrix, short: Matrix, free: float) -> float:
    """Return the likeliest standard deviation of noise that leaves so much, ``free`` numbers having been fitted.

    ``short`` is by how much predictions fall short of the ends of censored rows, negative where they are beyond. Every
    round gives these the mean square that they have beyond their ends (A. P. Dempster, N. M. Laird, D. B. Rubin, J. R.
    Stat. Soc. B 39, 1977, 1).
    """
    known = float(np.sum(left**2))
    square = known / max(len(left) - free, 1.0)
    for _ in range(MOST_SHARE_ROUNDS if len(short) and square > 0 else 0):
        hidden = square * float(np.sum(_square_beyond(short / square**0.5)))
        before, square = square, (known + hidden) / max(len(left) + len(short) - free, 1.0)
        if abs(square - before) <= SHARES_SETTLED * square:
            break
    return float(square**0.5)


def _square_beyond(z: Matrix) -> Matrix:
    """Return the mean square of what is normal and above z."""
    return np.asarray(1 + z * _hazard(-z))


def _hazard(z: Matrix) -> Matrix:
    """Return the normal density over its integral up to z."""
    return np.asarray(np.sqrt(2 / np.pi) / erfcx(-z / np.sqrt(2)))
