"""From the lines of a surface to fractal dimension and roughness: settings, and what was found."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.fitting import PowerLaw, noise_fit, straight_fit
from harmonic_fractal.lags import SHARE, Steps, fit_steps, local_steps, stated_steps
from harmonic_fractal.power_law import log_roughness_of
from harmonic_fractal.resampling import block_weights, units_of
from harmonic_fractal.roughness_length import roughness_length_of
from harmonic_fractal.structure import (
    StructureFunction,
    mean_squares,
    structure_function_of,
)
from harmonic_fractal.surface import Direction, Lines
from harmonic_fractal.verdict import DECADE, NONE, local_dimensions, no_range, self_affine_range, span_of

Array = NDArray[np.float64]
FEWEST_POINTS = 64  # of a line
FEWEST_LAGS = 8
FEWEST_PAIRS = 100
SLACK = 1e-9


@dataclass(frozen=True, kw_only=True)
class Estimation:
    """How D and G are read from a structure function; lags in m, NaN where the data decide.

    ``lags`` replaces the even choice of ``count`` lags from ``shortest_lag`` (else one point) to ``longest_lag`` (else
    a tenth of a line). ``fit`` over the self-affine range within these limits, or over all of them whatever their
    local slopes. ``resamples`` bootstrap samples are drawn with ``seed``, of blocks of ``block`` neighbouring lines or,
    if that is 0, of what the lines need.
    """

    method: Literal["pooled", "per_line"] = "pooled"
    noise_aware: bool = False
    shortest_lag: float = float("nan")
    longest_lag: float = float("nan")
    count: int = 16
    lags: tuple[float, ...] = ()
    fit: Literal["self_affine", "all"] = "self_affine"
    resamples: int = 400
    block: int = 0
    seed: int = 1


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """What the lines of one direction say: structure function, local slopes, fit, verdict, and pairs of (D, ln G).

    ``dimension`` is that of the profile, ``roughness`` G in m in the areal convention (many ridge directions).
    ``lags`` (k,) in m and ``values`` (k,) in m^2 are those of the fit; ``local_lags`` and ``local_dimensions`` (j,) the
    slopes between neighbouring lags. ``range`` is the longest self-affine range, m, NaN where there is none; then
    ``reason`` says why and the fit is for comparison only. ``resampled`` (B, 2) holds D of the surface and ln G of
    bootstrap samples of blocks of lines, as pairs because their errors go together. ``all_lags`` and ``all_values``
    are the whole structure function, those between which the local slopes are taken included.
    ``window_dimension`` is the profile dimension by the roughness-length method, for comparison.
    """

    direction: Direction
    lags: Array
    values: Array
    local_lags: Array
    local_dimensions: Array
    dimension: float
    roughness: float
    r_squared: float
    line_scatter: float
    noise: float
    range: tuple[float, float]
    reason: str
    resampled: Array
    spacing: float
    all_lags: Array = field(default_factory=lambda: np.empty(0))
    all_values: Array = field(default_factory=lambda: np.empty(0))
    window_dimension: float = float("nan")

    @property
    def is_accepted(self) -> bool:
        """Whether there is a self-affine range, so that D and G mean something."""
        return not self.reason


@dataclass(frozen=True, eq=False, kw_only=True)
class _Local:
    """The local slopes, and the self-affine range that they leave."""

    lags: Array
    dimensions: Array
    range: tuple[float, float]
    reason: str


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fit:
    dimension: float
    logarithm: float
    r_squared: float
    scatter: float
    noise: float


def estimate_of(lines: Lines, direction: Direction, settings: Estimation) -> Estimate:
    """Read D and G from parallel lines of one direction, each with its own straight line removed."""
    points = lines.heights.shape[1]
    every = _steps(points, lines.spacing, settings)
    coarse = _measured(lines, local_steps(points, _shortest(settings) / lines.spacing))
    local = _local(coarse, _noise(lines, every, settings), settings)
    steps = every if local.reason or settings.fit == "all" else _within(points, lines.spacing, local.range, settings)
    curve = _measured(lines, steps)
    found = _fit(curve, settings)
    reason = _refusal(points, local, curve.lags, found)
    whole = np.unique(np.concatenate([coarse.lags, curve.lags]), return_index=True)[1]
    return Estimate(
        direction=direction,
        lags=curve.lags,
        values=curve.pooled,
        local_lags=local.lags,
        local_dimensions=local.dimensions,
        dimension=found.dimension,
        roughness=_exponential(found.logarithm),
        r_squared=found.r_squared,
        line_scatter=found.scatter,
        noise=found.noise,
        range=NONE if reason else local.range,
        reason=reason,
        resampled=np.empty((0, 2)) if reason else _resampled(lines, curve, found, settings),
        spacing=lines.spacing,
        all_lags=np.concatenate([coarse.lags, curve.lags])[whole],
        all_values=np.concatenate([coarse.pooled, curve.pooled])[whole],
        window_dimension=roughness_length_of(lines.heights, lines.spacing).dimension,
    )


def _shortest(settings: Estimation) -> float:
    """Return the shortest lag that may be looked at, m, NaN where the data decide."""
    return min(settings.lags, default=settings.shortest_lag)


def _steps(points: int, spacing: float, settings: Estimation) -> Steps:
    """Return the lags, in points, within the limits that are set."""
    if settings.lags:
        return stated_steps(points, [lag / spacing for lag in settings.lags])
    return fit_steps(points, settings.shortest_lag / spacing, settings.longest_lag / spacing, settings.count)


def _within(points: int, spacing: float, found: tuple[float, float], settings: Estimation) -> Steps:
    """Return the lags, in points, of the fit over a self-affine range.

    From its shortest lag to a tenth of a line, or as far as it takes to make a decade; not beyond the range. Noise is
    told from the surface by the shortest lags: where it is fitted, they belong to the fit.
    """
    low, high = found
    if settings.noise_aware:
        low = spacing if np.isnan(_shortest(settings)) else _shortest(settings)
    last = min(max(SHARE * points * spacing, DECADE * low), high)
    if settings.lags:
        kept = [lag for lag in settings.lags if low * (1 - SLACK) <= lag <= high * (1 + SLACK)]
        return stated_steps(points, [lag / spacing for lag in kept])
    if settings.longest_lag > 0:
        last = min(settings.longest_lag, high)
    return fit_steps(points, low / spacing, last / spacing, settings.count)


def _measured(lines: Lines, steps: Steps) -> StructureFunction:
    """Return the structure function at those lags that have enough pairs, and where the surface is not flat."""
    curve = structure_function_of(lines.heights, lines.spacing, steps)
    return curve.at((curve.pairs >= FEWEST_PAIRS) & (np.nan_to_num(curve.pooled) > 0.0))


def _noise(lines: Lines, steps: Steps, settings: Estimation) -> float:
    """Return the noise that is taken off before the local slopes: that of a fit over all lags."""
    if not settings.noise_aware:
        return 0.0
    curve = _measured(lines, steps)
    return float(noise_fit(curve.lags, curve.pooled).noise) if curve.lags.size >= FEWEST_LAGS else 0.0


def _local(curve: StructureFunction, noise: float, settings: Estimation) -> _Local:
    lags, values = curve.lags, curve.pooled - 2.0 * noise**2
    if lags.size < 2:
        return _Local(lags=np.empty(0), dimensions=np.empty(0), range=NONE, reason=no_range(lags, np.empty(0)))
    middles, dimensions = local_dimensions(lags, values)
    found = self_affine_range(lags, np.where(lags[:-1] >= settings.longest_lag, np.nan, dimensions))
    longest = lags[-1] if np.isnan(settings.longest_lag) else min(lags[-1], settings.longest_lag)
    reason = "" if np.isfinite(found[0]) else no_range(lags, dimensions)
    if longest < DECADE * lags[0] * (1 - SLACK):
        reason = f"no self-affine range: the lags that may be used, {span_of(lags[0], longest)}, are less than a decade"
    return _Local(lags=middles, dimensions=dimensions, range=found, reason=reason)


def _refusal(points: int, local: _Local, lags: Array, found: _Fit) -> str:
    """Say in words why D and G of the fit mean nothing; empty where they do."""
    if points < FEWEST_POINTS:
        return f"too short: a line has {points} points, fewer than {FEWEST_POINTS}"
    if local.reason:
        return local.reason
    if lags.size < FEWEST_LAGS:
        return f"no self-affine range: the fit has {lags.size} lags, fewer than {FEWEST_LAGS}"
    if lags[-1] < DECADE * lags[0] * (1 - SLACK):
        return f"no self-affine range: the lags of the fit, {span_of(lags[0], lags[-1])}, are less than a decade"
    if not 1.0 < found.dimension < 2.0:
        return f"no self-affine range: the slope of the fit is {4 - 2 * found.dimension:.2f}, not within 0 and 2"
    return ""


def _law(lags: Array, values: Array, settings: Estimation) -> PowerLaw:
    return noise_fit(lags, values) if settings.noise_aware else straight_fit(lags, values)


def _pairs(law: PowerLaw) -> Array:
    """Return D_s and ln G (..., 2), NaN where there is no G."""
    dimension = 2.0 - law.slope / 2.0
    return np.stack([dimension, log_roughness_of(law.intercept, dimension)], axis=-1)


def _fit(curve: StructureFunction, settings: Estimation) -> _Fit:
    if curve.lags.size < 3:
        return _Fit(dimension=np.nan, logarithm=np.nan, r_squared=np.nan, scatter=np.nan, noise=np.nan)
    law = _law(curve.lags, curve.pooled, settings)
    singles = _single_lines(curve, settings)
    pair = np.nanmean(singles, axis=0) if settings.method == "per_line" else _pairs(law)
    slopes = singles[np.isfinite(singles[:, 0]), 0]
    return _Fit(
        dimension=float(pair[0]),
        logarithm=float(pair[1]),
        r_squared=float(law.r_squared),
        scatter=float(slopes.std(ddof=1)) if len(slopes) > 1 else float("nan"),
        noise=float(law.noise),
    )


def _exponential(logarithm: float) -> float:
    """Return G, NaN where it is beyond all numbers: a slope near 2 of a surface that is refused."""
    return float(np.exp(logarithm)) if abs(logarithm) < 700.0 else float("nan")


def _single_lines(curve: StructureFunction, settings: Estimation) -> Array:
    """Return D_s and ln G (lines, 2) of every line, NaN for one that lacks a lag or whose slope has no G."""
    values = mean_squares(curve.sums, curve.counts)
    pairs = np.full((len(values), 2), np.nan)
    whole = (values > 0).all(axis=1)
    pairs[whole] = _pairs(_law(curve.lags, values[whole], settings))
    pairs[~np.isfinite(pairs).all(axis=1)] = np.nan
    return pairs


def _means_of_lines(curve: StructureFunction, weights: Array, settings: Estimation) -> Array:
    pairs = _single_lines(curve, settings)
    known = np.isfinite(pairs[:, 0])
    return mean_squares(weights[:, known] @ pairs[known], weights[:, known].sum(axis=1, keepdims=True) * np.ones(2))


def _resampled(lines: Lines, curve: StructureFunction, found: _Fit, settings: Estimation) -> Array:
    """Return D of the surface and ln G (B, 2) of samples of blocks of lines, or of pieces of them."""
    if settings.resamples < 1:
        return np.empty((0, 2))
    steps = np.rint(curve.lags / lines.spacing).astype(np.int64)
    units, block = units_of(lines.heights, curve, steps, settings.block)
    weights = block_weights(len(units.sums), block, settings.resamples, settings.seed)
    if settings.method == "per_line" and units is curve:
        pairs = _means_of_lines(curve, weights, settings)
    else:
        pairs = _pairs(_law(curve.lags, mean_squares(weights @ units.sums, weights @ units.counts), settings))
        pairs += np.array([found.dimension, found.logarithm]) - _pairs(_law(curve.lags, curve.pooled, settings))
    kept: Array = pairs[np.isfinite(pairs).all(axis=1)] + np.array([1.0, 0.0])
    return kept
