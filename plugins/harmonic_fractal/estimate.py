"""From the lines of a surface to fractal dimension and roughness: settings, and what was found."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.fitting import PowerLaw, noise_fit, straight_fit
from harmonic_fractal.lags import SHARE, Steps, fit_steps, local_steps, stated_steps
from harmonic_fractal.power_law import roughness_of
from harmonic_fractal.resampling import block_weights
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
    local slopes. ``block`` neighbouring lines are resampled together; ``seed`` makes that repeatable.
    """

    method: Literal["pooled", "per_line"] = "pooled"
    noise_aware: bool = False
    shortest_lag: float = float("nan")
    longest_lag: float = float("nan")
    count: int = 16
    lags: tuple[float, ...] = ()
    fit: Literal["self_affine", "all"] = "self_affine"
    resamples: int = 400
    block: int = 10
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


def estimate_of(lines: Lines, direction: Direction, settings: Estimation, *, density: float = 1.5) -> Estimate:
    """Read D and G from parallel lines of one direction, each with its own straight line removed."""
    points = lines.heights.shape[1]
    every = _steps(points, lines.spacing, settings)
    coarse = _measured(lines, local_steps(points))
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
        roughness=float(np.exp(found.logarithm)),
        r_squared=found.r_squared,
        line_scatter=found.scatter,
        noise=found.noise,
        range=NONE if reason else local.range,
        reason=reason,
        resampled=np.empty((0, 2)) if reason else _resampled(curve, settings),
        spacing=lines.spacing,
        all_lags=np.concatenate([coarse.lags, curve.lags])[whole],
        all_values=np.concatenate([coarse.pooled, curve.pooled])[whole],
    )


def _steps(points: int, spacing: float, settings: Estimation) -> Steps:
    """Return the lags, in points, within the limits that are set."""
    if settings.lags:
        return stated_steps(points, [lag / spacing for lag in settings.lags])
    return fit_steps(points, settings.shortest_lag / spacing, settings.longest_lag / spacing, settings.count)


def _within(points: int, spacing: float, found: tuple[float, float], settings: Estimation) -> Steps:
    """Return the lags, in points, of the fit over a self-affine range.

    From its shortest lag to a tenth of a line, or as far as it takes to make a decade; not beyond the range.
    """
    low, high = found
    if settings.noise_aware and not settings.shortest_lag > 0:
        low = spacing
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
    outside = (lags[:-1] < settings.shortest_lag * (1 - SLACK)) | (lags[1:] > settings.longest_lag * (1 + SLACK))
    found = self_affine_range(lags, np.where(outside, np.nan, dimensions))
    reason = no_range(lags, dimensions) if np.isnan(found[0]) else ""
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
        return f"no self-affine range: the lags of the fit, {span_of(lags)}, are less than a decade"
    if not 1.0 < found.dimension < 2.0:
        return f"no self-affine range: the slope of the fit is {4 - 2 * found.dimension:.2f}, not within 0 and 2"
    return ""


def _law(lags: Array, values: Array, settings: Estimation) -> PowerLaw:
    return noise_fit(lags, values) if settings.noise_aware else straight_fit(lags, values)


def _pairs(law: PowerLaw) -> Array:
    """Return D_s and ln G (..., 2), NaN where there is no G."""
    dimension = 2.0 - law.slope / 2.0
    return np.stack([dimension, np.log(roughness_of(law.intercept, dimension))], axis=-1)


def _fit(curve: StructureFunction, settings: Estimation) -> _Fit:
    if curve.lags.size < 3:
        return _Fit(dimension=np.nan, logarithm=np.nan, r_squared=np.nan, scatter=np.nan, noise=np.nan)
    law = _law(curve.lags, curve.pooled, settings)
    singles = _single_lines(curve, settings)
    pair = _pairs(law)
    if settings.method == "per_line":
        pair = singles.mean(axis=0) if singles.size else np.full(2, np.nan)
    return _Fit(
        dimension=float(pair[0]),
        logarithm=float(pair[1]),
        r_squared=float(law.r_squared),
        scatter=float(singles[:, 0].std(ddof=1)) if len(singles) > 1 else float("nan"),
        noise=float(law.noise),
    )


def _single_lines(curve: StructureFunction, settings: Estimation) -> Array:
    values = mean_squares(curve.sums, curve.counts)
    whole = (values > 0).all(axis=1)
    pairs = _pairs(_law(curve.lags, values[whole], settings))
    kept: Array = pairs[np.isfinite(pairs).all(axis=1)]
    return kept


def _resampled(curve: StructureFunction, settings: Estimation) -> Array:
    if settings.resamples < 1:
        return np.empty((0, 2))
    weights = block_weights(len(curve.sums), settings.block, settings.resamples, settings.seed)
    values = mean_squares(weights @ curve.sums, weights @ curve.counts)
    pairs = _pairs(_law(curve.lags, values, settings)) + np.array([1.0, 0.0])
    kept: Array = pairs[np.isfinite(pairs).all(axis=1)]
    return kept
