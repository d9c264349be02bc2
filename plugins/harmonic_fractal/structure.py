"""The structure function of many parallel lines, its power law, and what an instrument leaves of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import gamma, hyp1f1

from truing import Array, Float

# Which lags are looked at: those of the fit, evenly in their logarithm, and those between which slopes are taken

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


# The structure function of many parallel lines: mean square of the height difference of two points a lag apart

CACHED = 65536  # points of a block of lines; its differences stay in the cache of the processor


@dataclass(frozen=True, eq=False)
class StructureFunction:
    """S of every line: lags (k,) in m, sums of squared differences (lines, k) in m^2, and numbers of pairs (lines, k).

    Lines, or blocks of them, are put together by adding their sums and their pairs, not by averaging their S: so a
    line with holes weighs as much as it was measured.
    """

    lags: Array
    sums: Array
    counts: Array

    @property
    def pooled(self) -> Array:
        """S (k,) of all lines together, m^2; NaN where no pair was measured."""
        return mean_squares(self.sums.sum(axis=0), self.counts.sum(axis=0))

    @property
    def pairs(self) -> Array:
        """Numbers of pairs (k,) of all lines together."""
        value: Array = self.counts.sum(axis=0)
        return value

    def at(self, chosen: NDArray[np.bool_]) -> "StructureFunction":
        """Return the same for a choice (k,) of its lags."""
        return StructureFunction(self.lags[chosen], self.sums[:, chosen], self.counts[:, chosen])


def structure_function_of(heights: Array, spacing: float, steps: Steps) -> StructureFunction:
    """Return the structure function of lines (lines, points), m, at whole multiples ``steps`` (k,) of the spacing."""
    sums, counts = structure_sums(heights, steps)
    return StructureFunction(np.multiply(steps, spacing, dtype=float), sums, counts)


def structure_sums(heights: Array, steps: Steps) -> tuple[Array, Array]:
    """Return the sums of squared height differences (lines, k), m^2, and how many pairs of points each is of.

    ``heights`` (lines, points) in m, NaN where not measured: a pair counts where both of its points were measured.
    ``steps`` (k,) are lags in points, 1 to points - 1. The lines pass in blocks that fit the cache, so that a map of
    any size needs no more memory than itself; of each block all pairs of one lag are taken at once.
    """
    lines, points = heights.shape
    sums, counts = np.empty((lines, steps.size)), np.empty((lines, steps.size))
    rows = max(1, CACHED // points)
    for first in range(0, lines, rows):
        part = slice(first, first + rows)
        sums[part], counts[part] = _of_block(np.ascontiguousarray(heights[part], dtype=float), steps)
    return sums, counts


def _of_block(heights: Array, steps: Steps) -> tuple[Array, Array]:
    """Return the sums of a block of lines, which are taken as one: what crosses from line to line is cut off.

    A hole is a height of 0 whose two differences are set to 0. That costs as much as there are holes, while a mask
    would cost as much as there are points.
    """
    lines, points = heights.shape
    known = np.isfinite(heights)
    one_line, weights = np.where(known, heights, 0.0).ravel(), known.astype(np.float32)  # exact up to 2^24 points
    longest = int(steps.max(initial=0))
    room = np.zeros(longest + one_line.size)  # so that a hole at the very beginning has a place for both differences
    holes = longest + np.flatnonzero(~known)
    differences = room[longest:].reshape(lines, points)
    sums, counts = np.empty((lines, steps.size)), np.empty((lines, steps.size))
    for column, step in enumerate(steps.tolist()):
        np.subtract(one_line[step:], one_line[:-step], out=room[longest : room.size - step])
        room[holes] = 0.0
        room[holes - step] = 0.0
        inside = differences[:, : points - step]
        sums[:, column] = np.einsum("ij,ij->i", inside, inside)
        counts[:, column] = np.einsum("ij,ij->i", weights[:, step:], weights[:, :-step])
    return sums, counts


def piece_sums(heights: Array, steps: Steps, pieces: int) -> tuple[Array, Array]:
    """Return the same of pieces (pieces, k) along the lines, what lies at the same place of all lines together.

    A pair belongs to the piece in which it begins, so the pieces add up to the whole. There are as many pieces as are
    asked for, or as pairs of the longest lag begin on a line.
    """
    points = heights.shape[1]
    pieces = min(pieces, points - int(steps.max()))
    sums, counts = np.zeros((pieces, steps.size)), np.zeros((pieces, steps.size))
    rows = max(1, CACHED // points)
    for first in range(0, heights.shape[0], rows):
        block = np.ascontiguousarray(heights[first : first + rows], dtype=float)
        known = np.isfinite(block)
        filled, weight = np.where(known, block, 0.0), known.astype(float)
        for column, step in enumerate(steps):
            starts = np.linspace(0, points - step, pieces, endpoint=False).astype(int)
            both = weight[:, step:] * weight[:, :-step]
            squares = np.square(filled[:, step:] - filled[:, :-step]) * both
            sums[:, column] += np.add.reduceat(squares.sum(axis=0), starts)
            counts[:, column] += np.add.reduceat(both.sum(axis=0), starts)
    return sums, counts


def mean_squares(sums: Array, counts: Array) -> Array:
    """Return sums over counts, NaN where nothing was counted."""
    value: Array = np.divide(sums, counts, out=np.full(np.shape(sums), np.nan), where=counts > 0)
    return value


# The power law of the structure function of a Weierstrass-Mandelbrot surface, and the conventions of its constant
#
# **Profile** (Majumdar and Tien 1990, Majumdar and Bhushan 1990). With f_n = gamma^n in cycles per metre
#
#     z(x) = G^(D_s-1) sum_n gamma^((D_s-2) n) [cos phi_n - cos(2 pi gamma^n x + phi_n)]
#
# The mean over the random phases of [z(x + lag) - z(x)]^2 is exactly, for any band,
#
#     S(lag) = G^(2(D_s-1)) sum_n gamma^((2 D_s-4) n) [1 - cos(2 pi gamma^n lag)]
#
# Where the band is wide the sum over n is an integral over d ln(f)/ln(gamma), and with the integral of
# (1 - cos u) u^(-1-a) over u from 0 to infinity, Gamma(1-a) cos(pi a/2)/a, a = 4 - 2 D_s,
#
#     S(lag) = C G^(2(D_s-1)) lag^(4-2 D_s),    C = (2 pi)^(4-2 D_s) Lambda(D_s) / ln(gamma),
#
#     Lambda(D_s) = Gamma(2 D_s-3) sin[(2 D_s-3) pi/2] / (4-2 D_s)
#
# Many papers print C without (2 pi)^(4-2 D_s): that belongs to a sum in radians per metre, not to the one above. G from
# it is too large by (2 pi)^((2-D_s)/(D_s-1)): 6.3 times at D_s = 1.5, 15.7 times at 1.4.
#
# **Surface** (Yan and Komvopoulos 1998). Its plane waves carry the factor (ln(gamma)/M)^(1/2) in M directions, so that
# ln(gamma) cancels and G does not depend on gamma. A trace at the angle beta to a wave sees it lengthened by
# 1/|cos beta|; many directions give the mean of |cos beta|^(4-2 D_s), Gamma((5-2 D_s)/2)/[pi^(1/2) Gamma(3-D_s)],
# which is 2/pi at D_s = 1.5. The dimension of the surface is D = D_s + 1.
#
# The sum with a ratio gamma is scale-invariant in steps of gamma only: S has a ripple about the power law, at gamma =
# 1.5 of relative half-amplitude 0.4 % at D_s = 1.2, 3.3 % at 1.5 and 17 % at 1.8.

Convention = Literal["areal", "one_direction", "profile"]


def spectral_constant(dimension: Float) -> Float:
    """Return Lambda of a profile dimension D_s, a pure number; finite for 1 < D_s < 2, pi/2 at 1.5.

    Written by the reflection formula as pi / [2 sin(pi a/2) Gamma(1 + a)] with a = 4 - 2 D_s: the same number, but
    without 0 times infinity at D_s = 1.5.
    """
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    return np.pi / (2.0 * np.sin(np.pi * exponent / 2.0) * gamma(1.0 + exponent))


def constant(dimension: Float, density: Float, convention: Convention) -> Float:
    """Return C of S = C G^(2(D_s-1)) lag^(4-2 D_s), a pure number, of this convention of G.

    ``dimension`` is D_s of the profile, 1 to 2; ``density`` is gamma, which only the convention "profile" contains.
    ``areal``: a surface of waves in many directions, any trace; ``one_direction``: parallel waves, trace across them.
    """
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    one_direction: Float = (2.0 * np.pi) ** exponent * spectral_constant(dimension)
    if convention == "profile":
        return one_direction / np.log(density)
    if convention == "one_direction":
        return one_direction
    mean_of_directions: Float = gamma((1.0 + exponent) / 2.0) / (np.sqrt(np.pi) * gamma(1.0 + exponent / 2.0))
    return one_direction * mean_of_directions


def converted(roughness: Float, dimension: Float, density: Float, *, source: Convention, target: Convention) -> Float:
    """Return G, m, of one convention in another one: the surface, its S, stays the same.

    G_B = G_A (C_A/C_B)^(1/(2(D_s-1))); ``dimension`` is D_s of the profile, 1 to 2.
    """
    ratio = constant(dimension, density, source) / constant(dimension, density, target)
    return roughness * ratio ** (1.0 / (2.0 * (np.asarray(dimension) - 1.0)))


def log_roughness_of(
    intercept: Float, dimension: Float, density: float = 1.5, convention: Convention = "areal"
) -> Float:
    """Return ln G, G in m, from the power law of a fit: its ln S (S in m^2) at a lag of 1 m, and D_s.

    ln G = (intercept - ln C)/(2(D_s-1)); NaN unless 1 < D_s < 2: a power law of another exponent has no G.
    """
    inside = (np.asarray(dimension) > 1.0) & (np.asarray(dimension) < 2.0)
    safe = np.where(inside, dimension, 1.5)
    logarithm = (intercept - np.log(constant(safe, density, convention))) / (2.0 * (safe - 1.0))
    return np.where(inside, logarithm, np.nan)[()]


def log_level_of(logarithm: Float, dimension: Float) -> Float:
    """Return ln S, S in m^2, at a lag of 1 m, from ln G (areal convention) and D_s: what log_roughness_of takes."""
    level: Float = 2.0 * (dimension - 1.0) * logarithm + np.log(constant(dimension, 1.5, "areal"))
    return level


def structure_function(lag: Float, dimension: Float, roughness: Float) -> Float:
    """Return S, m^2, at a lag in m, of a profile dimension D_s (1 to 2) and G in m in the areal convention."""
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    return constant(dimension, 1.5, "areal") * roughness ** (2.0 - exponent) * lag**exponent


# What an instrument that averages over a spot leaves of the structure function of a power law

FAR = 30.0  # from here on the series of the hypergeometric function in 1/x is exact to 1e-12
TERMS = 16  # of that series


def kept_share(lag: Float, width: Float, exponent: Float) -> Float:
    """Return the structure function of a filtered power law over that of the power law, 0 to 1; 1 without a width.

    Heights with S = c lag^a, averaged with a Gaussian weight of standard deviation w, have
    c (E|lag + sqrt(2) w Z|^a - E|sqrt(2) w Z|^a), Z standard normal: both ends are averaged, each on its own. With
    x = lag²/(4 w²): (2 w/lag)^a Gamma((1+a)/2)/sqrt(pi) (1F1(-a/2; 1/2; -x) - 1).
    Reference: absolute moments of the normal distribution, Abramowitz and Stegun 13.6, 22.5.
    """
    spot = np.maximum(width, 1e-6 * np.min(lag))
    x = np.square(lag / (2.0 * spot))
    scale = gamma((1.0 + exponent) / 2.0) / np.sqrt(np.pi)
    near = np.minimum(x, FAR)
    found = scale * near ** (-exponent / 2.0) * hyp1f1(-exponent / 2.0, 0.5, -near)
    whole = np.where(x > FAR, _far(np.maximum(x, FAR), exponent / 2.0), found)
    return np.where(np.asarray(width) > 0.0, whole - scale * x ** (-exponent / 2.0), 1.0)


def _far(x: Float, half: Float) -> Float:
    """Return Gamma(1/2 + p)/Gamma(1/2) x^-p 1F1(-p; 1/2; -x) for a large x: sum of (-p)_k (1/2 - p)_k / (k! x^k)."""
    term = total = np.ones(np.broadcast(x, half).shape)
    for k in range(TERMS):
        term = term * (k - half) * (k + 0.5 - half) / ((k + 1.0) * x)
        total = total + term
    return total
