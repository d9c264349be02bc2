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
MUCH_NOISE = 0.3  # share of noise in S at the shortest lag from which a plain fit is doubtful
MATTERS = 0.05  # difference in D_s
NOISY = 0.1  # share of noise in S at the shortest lag from which a fit with noise needs the lags that tell it
SLACK = 1e-9


@dataclass(frozen=True, kw_only=True)
class Estimation:
    """How D and G are read from a structure function; lags in m, NaN where the data decide.

    ``lags`` replaces the even choice of ``count`` lags from ``shortest_lag`` (else one point) to ``longest_lag`` (else
    a tenth of a line). The ``fit`` is over the part of them that is self-affine, or over all of them whatever their
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
    For comparison: ``window_dimension`` is the profile dimension by the roughness-length method; ``noise_dimension``
    that of a fit with noise at the same lags, and ``noise_share`` what this fit takes for noise of S at the shortest
    of them, 0 to 1: where that is much, D and G of the plain fit are partly those of the instrument.
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
    noise_dimension: float = float("nan")
    noise_share: float = float("nan")

    @property
    def is_accepted(self) -> bool:
        """Whether there is a self-affine range, so that D and G mean something."""
        return not self.reason

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences for the sheet: an accepted fit that leaves noise aside where there seems to be much."""
        is_plain = self.is_accepted and self.noise == 0.0
        if not (is_plain and self.noise_share > MUCH_NOISE and self.dimension - self.noise_dimension > MATTERS):
            return ()
        return (
            f"{self.noise_share:.0%} of the structure function at the shortest lag may be noise of the instrument: "
            f"a fit with noise (noise_aware = true) at the same lags has the profile dimension "
            f"{self.noise_dimension:.3f}, not {self.dimension:.3f}",
        )


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
    """Read D and G from parallel lines of one direction, each with its own straight line removed.

    The lines of NaN-marked heights (lines, points) in m need not be independent. Local slopes from the shortest lag to
    a quarter of a line decide whether there is a self-affine range: a decade over which the local dimension varies by
    less than 0.2 within 1.05 and 1.95. The fit goes over that range, to a tenth of a line or as far as a decade needs.
    With ``noise_aware`` the local slopes are those of S less the noise of a fit over all lags, and where noise is a
    tenth of S or more at the shortest lag, the fit begins there, since short lags tell noise from roughness.
    Never raises: a surface that has no range, or too few points or lags, has a reason, and its fit is over all lags.

    On fractional Brownian lines of 500 points, D_s 1.5: one line, error 0.05 of D_s and a factor of 2 in G; a hundred
    lines, 0.005 and 7 %; a straight line removed from each raises D_s by 0.01, and by 0.03 where it is 1.3.
    """
    coarse, local, curve = _curves(lines, settings)
    found = _fit(curve, settings)
    reason = _refusal(lines.heights.shape[1], local, curve.lags, found)
    noise_dimension, noise_share = _with_noise(curve)
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
        noise_dimension=noise_dimension,
        noise_share=noise_share,
    )


def _curves(lines: Lines, settings: Estimation) -> tuple[StructureFunction, _Local, StructureFunction]:
    """Return S between whose lags the local slopes are taken, these slopes, and S at the lags of the fit."""
    points = lines.heights.shape[1]
    every = _steps(points, lines.spacing, settings)
    coarse = _measured(lines, local_steps(points, _shortest(settings) / lines.spacing))
    noise = _noise(lines, every, settings)
    local = _local(coarse, noise, settings)
    is_whole = local.reason or settings.fit == "all"
    steps = every if is_whole else _within(points, lines.spacing, _reach(coarse, noise, local), settings)
    return coarse, local, _measured(lines, steps)


def _shortest(settings: Estimation) -> float:
    """Return the shortest lag that may be looked at, m, NaN where the data decide."""
    return min(settings.lags, default=settings.shortest_lag)


def _steps(points: int, spacing: float, settings: Estimation) -> Steps:
    """Return the lags, in points, within the limits that are set."""
    if settings.lags:
        return stated_steps(points, [lag / spacing for lag in settings.lags])
    return fit_steps(points, settings.shortest_lag / spacing, settings.longest_lag / spacing, settings.count)


def _reach(curve: StructureFunction, noise: float, local: _Local) -> tuple[float, float]:
    """Return from where to where the fit goes, m: the self-affine range, and the shortest lags if they tell noise."""
    is_noisy = 2.0 * noise**2 > NOISY * curve.pooled[0]
    return float(curve.lags[0]) if is_noisy else local.range[0], local.range[1]


def _within(points: int, spacing: float, found: tuple[float, float], settings: Estimation) -> Steps:
    """Return the lags, in points, of the fit over a self-affine range.

    From its shortest lag to a tenth of a line, or as far as it takes to make a decade; not beyond the range.
    """
    low, high = found
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


def _with_noise(curve: StructureFunction) -> tuple[float, float]:
    """Return the profile dimension of a fit with noise, and the share of noise in S at the shortest lag."""
    if curve.lags.size < FEWEST_LAGS:
        return float("nan"), float("nan")
    law = noise_fit(curve.lags, curve.pooled)
    power = float(np.exp(law.intercept) * curve.lags[0] ** law.slope)
    noise = 2.0 * float(law.noise) ** 2
    return 2.0 - float(law.slope) / 2.0, noise / (noise + power)


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
