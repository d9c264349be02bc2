"""From the lines of a surface to fractal dimension and roughness: settings, fits, and what was found."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from harmonic_fractal import levelling, structure, windows
from harmonic_fractal.generators import brownian_profiles
from harmonic_fractal.levelling import Levelling
from harmonic_fractal.structure import SHARE, Steps, StructureFunction, mean_squares
from harmonic_fractal.surface import Direction, Lines
from truing import Array

# Straight lines through ln S over ln lag, with or without the noise of the instrument, many at once

FLATTEST, STEEPEST = 0.02, 1.98  # bounds of the exponent where the noise is fitted too
ROUNDS = 60


@dataclass(frozen=True, eq=False, kw_only=True)
class PowerLaw:
    """S = exp(intercept) lag^slope + 2 noise^2, each of shape (...): lag in m, S in m^2, noise in m."""

    slope: Array
    intercept: Array
    noise: Array
    r_squared: Array


def straight_fit(lags: Array, values: Array) -> PowerLaw:
    """Fit ln S (..., k) by a straight line over ln lag (k,), least squares, all lags alike; NaN in S gives NaN."""
    x, y = np.log(lags), np.log(values)
    centred = x - x.mean()
    middle = y.mean(axis=-1)
    slope = (y @ centred) / np.square(centred).sum()
    left = y - middle[..., None] - slope[..., None] * centred
    return PowerLaw(
        slope=slope, intercept=middle - slope * x.mean(), noise=np.zeros_like(slope), r_squared=_explained(left, y)
    )


def noise_fit(lags: Array, values: Array) -> PowerLaw:
    """Fit S (..., k) by A lag^s + 2 sigma^2, least squares of ln S; 0.02 < s < 1.98 and sigma >= 0.

    White noise of the instrument, of standard deviation sigma in every height, adds 2 sigma^2 to S at every lag.
    Levenberg's and Marquardt's method on the exponent and on the share of noise, all curves at once; A is solved for
    in between. It starts twice, without noise and with the slope of the longer half of the lags and the noise that is
    then missing at the shortest; the better end counts.
    """
    x, y = np.log(lags), np.log(values)
    x = x - x.mean()
    flat = y.reshape(-1, y.shape[-1])
    half = x >= x[x.size // 2]
    starts = [straight_fit(np.exp(x[part]), np.exp(flat[:, part])).slope for part in (x == x, half)]
    ends = []
    for start, share in zip(starts, (0.0, 0.5), strict=True):
        slope = np.clip(start, 0.1, 1.9)
        ends.append(_refined(x, flat, np.stack([slope, share * np.exp(slope * x[0])], axis=-1)))
    costs = [np.square(_residuals(x, flat, end)).sum(axis=-1) for end in ends]
    best = np.where((costs[1] < costs[0])[:, None], ends[1], ends[0])
    amplitude = (flat - _shape(x, best)).mean(axis=-1)
    shape = y.shape[:-1]
    return PowerLaw(
        slope=best[:, 0].reshape(shape),
        intercept=(amplitude - best[:, 0] * np.log(lags).mean()).reshape(shape),
        noise=np.sqrt(np.exp(amplitude) * best[:, 1] / 2.0).reshape(shape),
        r_squared=_explained(_residuals(x, flat, best), flat).reshape(shape),
    )


def _refined(x: Array, y: Array, found: Array) -> Array:
    """Improve (slope, share of noise) (n, 2) until nothing changes; a step that makes it worse is shortened."""
    damping = np.full(len(found), 1e-3)
    cost = np.square(_residuals(x, y, found)).sum(axis=-1)
    for _ in range(ROUNDS):
        trial = _stepped(x, y, found, damping)
        trial_cost = np.square(_residuals(x, y, trial)).sum(axis=-1)
        better = trial_cost < cost
        found = np.where(better[:, None], trial, found)
        settled = bool(np.all(cost - trial_cost <= 1e-14 * cost) and np.all(better | (damping > 1.0)))
        cost = np.where(better, trial_cost, cost)
        damping = np.where(better, damping / 5.0, damping * 5.0)
        if settled:
            break
    return found


def _stepped(x: Array, y: Array, found: Array, damping: Array) -> Array:
    power = np.exp(found[:, :1] * x)
    whole = power + found[:, 1:]
    jacobian = np.stack([x * power / whole, 1.0 / whole], axis=-1)
    jacobian = jacobian - jacobian.mean(axis=1, keepdims=True)
    gradient = np.einsum("nki,nk->ni", jacobian, _residuals(x, y, found))
    held = (found[:, 1] <= 0.0) & (gradient[:, 1] <= 0.0)
    jacobian[held, :, 1] = 0.0
    gradient[held, 1] = 0.0
    normal = np.einsum("nki,nkj->nij", jacobian, jacobian)
    diagonal = np.einsum("nii->ni", normal)
    diagonal += damping[:, None] * diagonal + 1e-30
    change = np.linalg.solve(normal, gradient[..., None])[..., 0]
    low, high = np.array([FLATTEST, 0.0]), np.array([STEEPEST, np.inf])
    return np.clip(found + change, low, high)


def _shape(x: Array, found: Array) -> Array:
    return np.log(np.exp(found[:, :1] * x) + found[:, 1:])


def _residuals(x: Array, y: Array, found: Array) -> Array:
    left = y - _shape(x, found)
    value: Array = left - left.mean(axis=-1, keepdims=True)
    return value


def _explained(left: Array, y: Array) -> Array:
    spread = np.square(y - y.mean(axis=-1, keepdims=True)).sum(axis=-1)
    left_over = np.square(left).sum(axis=-1)
    value: Array = np.divide(spread - left_over, spread, out=np.full(spread.shape, np.nan), where=spread > 0)
    return value


# How far D and G scatter: blocks of neighbouring lines, or of neighbouring pieces of them, drawn anew many times

ENOUGH_LINES = 20
LINES_TOGETHER = 10
PIECES = 50  # of all lines, across them
FEWEST_BLOCKS = 4
MOST_UNITS = 2000  # more lines are taken together by neighbours, so that samples of any map fit into memory


@dataclass(frozen=True, eq=False)
class Units:
    """What is resampled: structure function (units, k), how many neighbours are drawn together, and what they are.

    ``lines`` is how many lines a unit holds, 0 where the units are pieces across all lines.
    """

    curve: StructureFunction
    block: int
    lines: int


def units_of(heights: Array, curve: StructureFunction, steps: Steps, block: int) -> Units:
    """Return what is resampled, its structure function (units, k), and how many neighbours are drawn together.

    Blocks of ``block`` lines where that is asked for (not 0). Else of ten lines, where there are twenty lines or more
    and they are independent. Else of pieces: the lines, few or alike, are cut across into 50 pieces, all lines of a
    piece together, and as many neighbouring pieces are drawn together as the longest lag reaches over. At most a
    quarter of the units, so that there are four blocks to draw.

    Lines of one patch are seldom independent, and blocks of ten of them then see half of the scatter only: a fractal
    patch is correlated over its whole height. Pieces as long as the longest lag see 0.6 to 0.9 of it, so the scatter of
    a Gaussian patch of this size stands beside (``levelling.scatter``), and the larger of both counts.
    """
    if block or know_nothing(curve):
        together = -(-len(curve.sums) // MOST_UNITS)
        groups = _grouped(curve, together)
        return Units(groups, _at_most(-(-(block or LINES_TOGETHER) // together), len(groups.sums)), together)
    pieces = StructureFunction(curve.lags, *structure.piece_sums(heights, steps, PIECES))
    reach = steps[-1] * len(pieces.sums) / (heights.shape[1] - steps[-1])
    return Units(pieces, _at_most(int(np.ceil(reach)), len(pieces.sums)), 0)


def know_nothing(curve: StructureFunction) -> bool:
    """Tell whether lines are many and know nothing of one another."""
    return len(curve.sums) >= ENOUGH_LINES and are_independent(curve)


def are_independent(curve: StructureFunction) -> bool:
    """Tell whether what a line says about the slope has nothing to do with what its neighbour says (5 % level)."""
    x = np.log(curve.lags)
    pull = (x - x.mean()) / (curve.pooled * curve.pairs)
    scores = (curve.sums - curve.pooled * curve.counts) @ pull  # of the slope of ln S over ln lag; their sum is 0
    return bool(scores[1:] @ scores[:-1] <= 1.96 * (scores @ scores) / np.sqrt(len(scores)))


def block_weights(units: int, block: int, samples: int, seed: int) -> Array:
    """Return how often every unit (lines, say) stands in every sample (samples, units): blocks of neighbours.

    The blocks begin anywhere and the last is continued by the first (circular block bootstrap, Politis and Romano
    1992). One block fewer is drawn than the units hold, which makes the variance that of the units and not the
    (blocks - 1)/blocks of it (Rao and Wu 1988).
    """
    generator = np.random.default_rng(seed)
    drawn = max(1, round(units / block) - 1)
    starts = generator.multinomial(drawn, np.full(units, 1.0 / units), size=samples).astype(float)
    weights = np.zeros_like(starts)
    for shift in range(block):
        weights += np.roll(starts, shift, axis=1)
    return weights


def _grouped(curve: StructureFunction, together: int) -> StructureFunction:
    if together == 1:
        return curve
    starts = np.arange(0, len(curve.sums), together)
    return StructureFunction(curve.lags, np.add.reduceat(curve.sums, starts), np.add.reduceat(curve.counts, starts))


def _at_most(block: int, units: int) -> int:
    return max(1, min(block, units // FEWEST_BLOCKS))


# Whether there is a self-affine range: a decade of lags over which the local dimension stays the same

NONE = (float("nan"), float("nan"))
SPAN = 0.2  # of the local dimensions within the range
# smoother is a filtered surface or form, rougher is noise or beyond the correlation length
LOWEST, HIGHEST = 1.05, 1.95
DECADE = 10.0


def local_dimensions(lags: Array, values: Array) -> tuple[Array, Array]:
    """Return the geometric means of neighbouring lags (j,), m, and the profile dimension between them (j,).

    ``values`` (j + 1,) is S, m^2; the dimension is NaN where it is missing or not positive.
    """
    logarithms = np.log(np.where(values > 0, values, np.nan))
    slopes = np.diff(logarithms) / np.diff(np.log(lags))
    return np.sqrt(lags[1:] * lags[:-1]), 2.0 - slopes / 2.0


def self_affine_range(lags: Array, dimensions: Array) -> tuple[float, float]:
    """Return the longest range of lags, m, that is self-affine; NaN and NaN where there is none.

    ``dimensions`` (j,) belong to the steps between the lags (j + 1,). A range holds at least a decade; its local
    dimensions span less than 0.2 and lie within 1.05 and 1.95. Of ranges of the same length the one of shorter lags.
    """
    best = NONE
    for first in range(len(dimensions)):
        for last in range(first, len(dimensions)):
            low, high = float(lags[first]), float(lags[last + 1])
            longer = (
                high / low > best[1] / best[0] * (1 + 1e-9) if best is not NONE else high >= DECADE * low * (1 - 1e-9)
            )
            if longer and is_self_affine(dimensions[first : last + 1]):
                best = (low, high)
    return best


def is_self_affine(dimensions: Array) -> bool:
    """Tell whether local dimensions are those of one power law: within 1.05 and 1.95, and less than 0.2 apart."""
    low, high = float(np.min(dimensions)), float(np.max(dimensions))
    return low >= LOWEST and high <= HIGHEST and high - low < SPAN


def no_range(lags: Array, dimensions: Array) -> str:
    """Say in words why there is no self-affine range."""
    known = np.isfinite(dimensions)
    if not known.any():
        return (
            "no self-affine range: no local slope of the structure function could be taken, because hardly a lag has "
            "100 pairs of points or a difference of height; take longer lines, or more of them"
        )
    low, high = float(dimensions[known].min()), float(dimensions[known].max())
    return (
        f"no self-affine range: over no decade of lags does the local dimension of the profile vary by less than "
        f"{SPAN:g} and stay within {LOWEST:g} to {HIGHEST:g}; it runs from {low:.2f} to {high:.2f} over lags of "
        f"{span_of(lags[0], lags[-1])}"
    )


def span_of(shortest: float, longest: float) -> str:
    """Say from where to where lags, m, run."""
    return f"{shortest * 1e6:.4g} um to {longest * 1e6:.4g} um"


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
    if that is 0, of what the lines need. ``bias`` is that of levelling, and of the logarithm of a mean of few: it is
    taken out where the lines say how they were levelled.
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
    bias: Literal["taken_out", "kept"] = "taken_out"


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """What the lines of one direction say: structure function, local slopes, fit, verdict, and pairs of (D, ln G).

    ``dimension`` is that of the profile, ``roughness`` G in m in the areal convention (many ridge directions).
    ``lags`` (k,) in m and ``values`` (k,) in m^2 are those of the fit; ``local_lags`` and ``local_dimensions`` (j,) the
    slopes between neighbouring lags. ``range`` is the longest self-affine range, m, NaN where there is none; then
    ``reason`` says why and the fit is for comparison only. ``resampled`` (B, 2) holds D of the surface and ln G of
    bootstrap samples of blocks of lines, or of Gaussian patches of this size where these scatter more, as pairs because
    their errors go together. ``all_lags`` and ``all_values`` are the whole structure function, those between which the
    local slopes are taken included. ``levelled_dimension`` and ``levelled_roughness`` are those of the fit before the
    bias of levelling was taken out.
    For comparison: ``window_dimension`` is the profile dimension by the roughness-length method; ``noise_dimension``
    that of a fit with noise at the same lags, and ``noise_share`` what this fit takes for noise of S at the shortest
    of them, 0 to 1: where that is much, D and G of the plain fit are partly those of the instrument.
    ``window_disagreement`` is by how much the roughness-length method, its own bias taken out and its windows within
    the lags of the fit, finds a larger dimension, and ``window_scatter`` the standard deviation that this difference
    has by chance; NaN where there is no range.
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
    levelled_dimension: float = float("nan")
    levelled_roughness: float = float("nan")
    window_disagreement: float = float("nan")
    window_scatter: float = float("nan")

    @property
    def dimension_interval(self) -> tuple[float, float]:
        """The 95 % interval of the profile dimension; NaN without samples."""
        low, high = _interval(self.resampled[:, 0])
        return low - 1.0, high - 1.0

    @property
    def roughness_interval(self) -> tuple[float, float]:
        """The 95 % interval of G, m; NaN without samples."""
        low, high = np.exp(_interval(self.resampled[:, 1]))
        return float(low), float(high)

    @property
    def window_sds(self) -> float:
        """By how many standard deviations the roughness-length method finds a larger dimension."""
        return self.window_disagreement / self.window_scatter

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


def _interval(values: Array) -> tuple[float, float]:
    if not len(values):
        return NONE
    low, high = np.percentile(values, (2.5, 97.5))
    return float(low), float(high)


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
    law = None if reason or settings.bias == "kept" else _unbiased(lines, curve, found, settings)
    noise_dimension, noise_share = _with_noise(curve)
    samples = _Samples() if reason else _sampled(lines, curve, found, law, settings)
    better = found if law is None else law.fit
    return Estimate(
        **_seen(lines, coarse, local, curve),
        direction=direction,
        dimension=better.dimension,
        roughness=_exponential(better.logarithm),
        r_squared=found.r_squared,
        line_scatter=found.scatter,
        noise=found.noise,
        range=NONE if reason else local.range,
        reason=reason,
        resampled=samples.pairs,
        noise_dimension=noise_dimension,
        noise_share=noise_share,
        levelled_dimension=found.dimension,
        levelled_roughness=_exponential(found.logarithm),
        window_disagreement=samples.window_dimension - better.dimension,
        window_scatter=samples.window_scatter,
    )


def _seen(lines: Lines, coarse: StructureFunction, local: _Local, curve: StructureFunction) -> dict[str, Any]:
    """Return what is shown of the lines whatever the fit, by the names of the estimate."""
    whole = np.unique(np.concatenate([coarse.lags, curve.lags]), return_index=True)[1]
    return {
        "lags": curve.lags,
        "values": curve.pooled,
        "local_lags": local.lags,
        "local_dimensions": local.dimensions,
        "spacing": lines.spacing,
        "all_lags": np.concatenate([coarse.lags, curve.lags])[whole],
        "all_values": np.concatenate([coarse.pooled, curve.pooled])[whole],
        "window_dimension": windows.roughness_length_of(lines.heights, lines.spacing),
    }


def _exponential(logarithm: float) -> float:
    return float(np.exp(logarithm)) if abs(logarithm) < 700.0 else float("nan")  # no such number


def _curves(lines: Lines, settings: Estimation) -> tuple[StructureFunction, _Local, StructureFunction]:
    """Return S between whose lags the local slopes are taken, these slopes, and S at the lags of the fit."""
    points = lines.heights.shape[1]
    every, shortest = _steps(points, lines.spacing, settings), min(settings.lags, default=settings.shortest_lag)
    coarse = _measured(lines, structure.local_steps(points, shortest / lines.spacing))
    noise = _noise(lines, every, settings)
    local = _local(coarse, noise, settings)
    is_whole = local.reason or settings.fit == "all"
    steps = every if is_whole else _within(points, lines.spacing, _reach(coarse, noise, local), settings)
    return coarse, local, _measured(lines, steps)


def _steps(points: int, spacing: float, settings: Estimation) -> Steps:
    """Return the lags, in points, within the limits that are set."""
    if settings.lags:
        return structure.stated_steps(points, [lag / spacing for lag in settings.lags])
    return structure.fit_steps(points, settings.shortest_lag / spacing, settings.longest_lag / spacing, settings.count)


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
        return structure.stated_steps(points, [lag / spacing for lag in kept])
    if settings.longest_lag > 0:
        last = min(settings.longest_lag, high)
    return structure.fit_steps(points, low / spacing, last / spacing, settings.count)


def _measured(lines: Lines, steps: Steps) -> StructureFunction:
    """Return the structure function at those lags that have enough pairs, and where the surface is not flat."""
    curve = structure.structure_function_of(lines.heights, lines.spacing, steps)
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
    return np.stack([dimension, structure.log_roughness_of(law.intercept, dimension)], axis=-1)


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


# The bias of levelling taken out, and how far D and G scatter. Deviations are of D_s and of ln S in the middle of the
# lags of the fit, (B, 2): there the two are nearly independent, and ln G follows from both without approximation.


@dataclass(frozen=True, eq=False)
class _Unbiased:
    """D and G without the bias of levelling, deviations (B, 2) of such fits, and what they are once it is taken out.

    D follows the fit by ``gain``, and the level that D by ``shift``: the smoother a surface, the more levelling took.
    ``growth`` (2, 2) is by what the deviations change per unit of the surface's D, in parts of themselves.
    """

    fit: _Fit
    deviations: Array
    gain: float
    shift: float
    growth: Array = field(default_factory=lambda: np.zeros((2, 2)))

    def of_surfaces(self, deviations: Array) -> Array:
        """Return the deviations (B, 2) of the surfaces of which fits that deviate so would be as this one.

        A smoother surface scatters more. So each surface is the one whose own scatter, and not that about the estimate,
        leads to this fit: s = -gain (e + s growth e), solved for its D.
        """
        more = deviations @ self.growth.T
        least = np.maximum(1.0 + self.gain * more[:, 0], LEAST_SHARE)
        dimension = -self.gain * deviations[:, 0] / least
        level = -deviations[:, 1] - dimension * more[:, 1] + self.shift * dimension
        return np.stack([dimension, level], axis=1)


TURNS = 3  # of the search for the dimension that would be found as this one was
NEAR = 1.02, 1.98  # bounds of it
APART = 0.01  # of two dimensions of which it is looked at by how much what is found differs
BESIDE = 0.05  # about a standard deviation of D of a small patch: from here on to either side scatter is compared
LEAST_SHARE = 0.3  # of the slope by which an estimate is carried to a surface: a draw beyond three deviations at most


def _unbiased(lines: Lines, curve: StructureFunction, found: _Fit, settings: Estimation) -> _Unbiased | None:
    """Return D and G of the Gaussian surface of which, on the average, this fit is to be expected; None if not known.

    Levelling takes long lags from S, and a mean of few squares has a logarithm too low by half its variance. The range
    of the fit is that which was chosen: of one line, whose slopes scatter, the choice has a bias of its own, so such
    lines are made and judged like it.
    """
    if lines.levelling is None:
        return None
    taken = lines.levelling.apart() if know_nothing(curve) else lines.levelling
    steps = np.rint(curve.lags / lines.spacing).astype(np.int64)

    def law(dimension: float, covariance: Array) -> PowerLaw:
        exponent = 4.0 - 2.0 * dimension
        seen = levelling.expected(exponent, steps, taken) * np.exp(-0.5 * np.diagonal(covariance))
        return _law(curve.lags, lines.spacing**exponent * seen, settings)

    scatter = partial(_scatter_of, steps=steps, taken=taken)
    dimension = found.dimension
    for _ in range(2):
        covariance = scatter(dimension)
        spread = covariance if settings.method == "pooled" else _of_one_line(dimension, steps, taken)
        for _ in range(TURNS):
            off = found.dimension - (2.0 - float(law(dimension, spread).slope) / 2.0)
            dimension = float(np.clip(dimension + off, *NEAR))
    middle = float(np.log(curve.lags).mean())

    def seen_and_lost(of: float) -> Array:
        seen = _levels(_pairs(law(of, spread)), curve.lags)
        return np.array([seen[0], (4.0 - 2.0 * of) * middle - seen[1]])

    change = (seen_and_lost(dimension + APART) - seen_and_lost(dimension - APART)) / (2.0 * APART)
    gain, shift = float(np.clip(1.0 / change[0], 1.0, 2.0)), float(change[1])
    level = _levels(_pair(found), curve.lags)[1] + seen_and_lost(dimension)[1]
    if len(lines.heights) > 1:
        fit = _at(found, dimension, level, curve.lags)
        growth = _growth(curve, found, settings, about=dimension, covariance=scatter)
        return _Unbiased(fit, _of_patches(curve, found, covariance, settings), gain, shift, growth)
    start = _Unbiased(_at(found, dimension, level, curve.lags), np.empty((0, 2)), gain, shift)
    return _by_making(lines, curve, found, start, settings)


def _growth(
    curve: StructureFunction, found: _Fit, settings: Estimation, *, about: float, covariance: Callable[[float], Array]
) -> Array:
    """Return the matrix (2, 2) by which deviations of fits change per unit of the D of the surface."""
    ends = np.clip([about - BESIDE, about + BESIDE], *NEAR)
    settings, roots = replace(settings, resamples=Estimation.resamples), []
    for end in ends.tolist():
        scattered = _of_patches(curve, found, covariance(end), settings)
        roots.append(np.linalg.cholesky(np.cov(scattered.T)))
    change: Array = (roots[1] - roots[0]) / (ends[1] - ends[0]) @ np.linalg.inv(0.5 * (roots[0] + roots[1]))
    return change


def _scatter_of(dimension: float, *, steps: Steps, taken: Levelling) -> Array:
    return levelling.scatter(4.0 - 2.0 * dimension, steps, taken)


def _of_one_line(dimension: float, steps: Steps, taken: Levelling) -> Array:
    """Return the covariance (k, k) of ln S of a single line."""
    single = replace(taken, shapes=tuple((1, points) for _, points in taken.shapes[:1]))
    return levelling.scatter(4.0 - 2.0 * dimension, steps, single)


MADE = 200  # lines that are made like one


def _by_making(
    lines: Lines, curve: StructureFunction, found: _Fit, start: _Unbiased, settings: Estimation
) -> _Unbiased | None:
    """Return D and G of one line by Gaussian lines that are levelled, judged and fitted as it was.

    Lines that are refused do not count.
    """
    if lines.levelling is None:
        return None
    rng = np.random.default_rng(settings.seed)
    dimension, level = (float(each) for each in _levels(_pair(start.fit), curve.lags))
    middle = float(np.log(curve.lags).mean())
    plain = replace(settings, bias="kept", resamples=0)
    wanted = _levels(_pair(found), curve.lags)
    for _ in range(2):
        step = float(np.exp(level + (4.0 - 2.0 * dimension) * (np.log(lines.spacing) - middle)))
        made = brownian_profiles(dimension, step, (MADE, lines.heights.shape[1]), rng)
        made = lines.levelling.taken_from(np.where(np.isfinite(lines.heights), made, np.nan))
        seen = []
        for line in made:
            _, local, own = _curves(Lines(line[None], lines.spacing), plain)
            fit = _fit(own, plain)
            if not _refusal(len(line), local, own.lags, fit):
                seen.append(_levels(_pair(fit), curve.lags))
        if len(seen) < MADE // 4:
            return None
        off = np.mean(seen, axis=0) - wanted
        deviations = np.array(seen) - np.mean(seen, axis=0)
        dimension = float(np.clip(dimension - start.gain * off[0], *NEAR))
        level = level - float(off[1])
    return replace(start, fit=_at(found, dimension, level, curve.lags), deviations=deviations)


def _pair(fit: _Fit) -> Array:
    return np.array([fit.dimension, fit.logarithm])


def _levels(pairs: Array, lags: Array) -> Array:
    """Return D_s and ln S in the middle of these lags (..., 2) in place of D_s and ln G."""
    dimension = pairs[..., 0]
    level = structure.log_level_of(pairs[..., 1], dimension) + (4.0 - 2.0 * dimension) * np.log(lags).mean()
    return np.stack([dimension, level], axis=-1)


def _roughnesses(levels: Array, lags: Array) -> Array:
    """Return D_s and ln G (..., 2) in place of D_s and ln S in the middle of these lags; NaN where there is no G."""
    dimension = levels[..., 0]
    intercept = levels[..., 1] - (4.0 - 2.0 * dimension) * np.log(lags).mean()
    return np.stack([dimension, structure.log_roughness_of(intercept, dimension)], axis=-1)


def _at(found: _Fit, dimension: float, level: float, lags: Array) -> _Fit:
    pair = _roughnesses(np.array([dimension, level]), lags)
    return replace(found, dimension=dimension, logarithm=float(pair[1]))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Samples:
    """Pairs (B, 2) of D of the surface and ln G; dimension by the roughness-length method, sd of its difference."""

    pairs: Array = field(default_factory=lambda: np.empty((0, 2)))
    window_dimension: float = float("nan")
    window_scatter: float = float("nan")


def _sampled(
    lines: Lines, curve: StructureFunction, found: _Fit, law: _Unbiased | None, settings: Estimation
) -> _Samples:
    """Return samples of blocks of lines or of pieces of them, or of Gaussian surfaces where these scatter more."""
    steps = np.rint(curve.lags / lines.spacing).astype(np.int64)
    sizes = windows.sizes_within(lines.heights.shape[1], int(steps[0]), int(steps[-1]))
    units = units_of(lines.heights, curve, steps, settings.block)
    sums, counts = windows.sums_of(lines.heights, sizes, len(units.curve.sums), units.lines)
    dimension = windows.calibrated(sizes, mean_squares(sums.sum(axis=0), counts.sum(axis=0)))
    if settings.resamples < 2:
        return _Samples(window_dimension=dimension)
    weights = block_weights(len(units.curve.sums), units.block, settings.resamples, settings.seed)
    pairs = _of_blocks(curve, units, weights, settings)
    apart = 2.0 - windows.slopes(sizes, mean_squares(weights @ sums, weights @ counts)) - pairs[:, 0]
    deviations = _levels(pairs[np.isfinite(pairs).all(axis=1)], curve.lags)
    deviations = deviations - deviations.mean(axis=0)
    widening, middle = 1.0, found
    if law is not None:
        middle = law.fit
        widening = max(1.0, float(law.deviations[:, 0].std() / deviations[:, 0].std()))
        deviations = law.of_surfaces(law.deviations if widening > 1.0 else deviations)
    levels = _levels(_pair(middle), curve.lags) + deviations
    found_pairs = _roughnesses(levels, curve.lags)
    return _Samples(
        pairs=found_pairs[np.isfinite(found_pairs).all(axis=1)] + np.array([1.0, 0.0]),
        window_dimension=dimension,
        window_scatter=widening * float(np.nanstd(apart, ddof=1)),
    )


def _of_blocks(curve: StructureFunction, units: Units, weights: Array, settings: Estimation) -> Array:
    """Return D_s and ln G (B, 2) of units drawn so often (B, units)."""
    if settings.method == "per_line" and units.curve is curve:
        return _means_of_lines(curve, weights, settings)
    drawn = mean_squares(weights @ units.curve.sums, weights @ units.curve.counts)
    return _pairs(_law(curve.lags, drawn, settings))


def _of_patches(curve: StructureFunction, found: _Fit, covariance: Array, settings: Estimation) -> Array:
    """Return deviations (B, 2) of patches whose ln S has this covariance (k, k)."""
    values, vectors = np.linalg.eigh(covariance)
    normal = np.random.default_rng(settings.seed).standard_normal((max(settings.resamples, 2), len(values)))
    scattered = normal @ (np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T)
    level = structure.log_level_of(found.logarithm, found.dimension)
    line = level + (4.0 - 2.0 * found.dimension) * np.log(curve.lags)
    pairs = _pairs(_law(curve.lags, np.exp(line + scattered) + 2.0 * found.noise**2, settings))
    levels = _levels(pairs[np.isfinite(pairs).all(axis=1)], curve.lags)
    value: Array = levels - levels.mean(axis=0)
    return value
