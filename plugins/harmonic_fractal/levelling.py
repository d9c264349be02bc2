"""What levelling and the size of a patch do to a structure function: its bias, and its scatter from patch to patch.

Both are those of a Gaussian surface with S = A lag^a that looks alike in all directions (fractional Brownian motion).
They are exact sums over its covariance, and no surface is made for them. A surface that is not Gaussian, or has a lay,
scatters otherwise; blocks of its own lines tell, and the larger of both counts (``estimate.py``).
"""

from dataclasses import dataclass, replace

import numpy as np

from harmonic_fractal.structure import Steps
from truing import Array

COARSE = 160  # points of a line, and lines, for the scatter: a finer patch is looked at by fewer, with the same lags
SOME = 40  # beginnings of lags of a line that are looked at
APART = 12  # distances of two lines that are looked at


@dataclass(frozen=True)
class Levelling:
    """What was taken from the heights before S: of one direction, or of two that are pooled.

    ``shapes`` are (lines, points) of each direction. Each line lost its own straight line (``line``), and before it
    all of them together a second-order surface (``curved``). ``are_neighbours``: the lines are parts of one patch;
    else they know nothing of one another.
    """

    shapes: tuple[tuple[int, int], ...]
    line: bool
    curved: bool
    are_neighbours: bool = True

    def apart(self) -> "Levelling":
        """Return the same of lines that know nothing of one another."""
        return replace(self, are_neighbours=False)

    def taken_from(self, heights: Array) -> Array:
        """Return single lines (n, points), NaN in their holes, each less what this takes from one line."""
        known = np.isfinite(heights[0])
        x = np.linspace(-1.0, 1.0, heights.shape[1])[known]
        degree = 2 if self.curved else 1 if self.line else 0
        basis, _ = np.linalg.qr(np.vander(x, degree + 1))
        level = np.full_like(heights, np.nan)
        level[:, known] = heights[:, known] - (heights[:, known] @ basis) @ basis.T
        return level


def expected(exponent: float, steps: Steps, levelling: Levelling) -> Array:
    """Return S (k,) to be expected at lags of whole spacings where the surface itself has lag^exponent; exact.

    Two directions are weighted by their pairs.
    """
    each = [_expected(exponent, steps, shape, levelling) for shape in levelling.shapes]
    return np.asarray(np.average(each, axis=0, weights=_pairs(steps, levelling)))


def scatter(exponent: float, steps: Steps, levelling: Levelling) -> Array:
    """Return the covariance (k, k) of ln S from patch to patch, of such a surface.

    Gaussian increments d have cov(d², d'²) = 2 cov(d, d')². Sums run over some of the lines and points. Two directions
    of one patch have in common what two increments across one another have.
    """
    weights = _pairs(steps, levelling) / _pairs(steps, levelling).sum(axis=0)
    parts = []
    for weight, shape in zip(weights, levelling.shapes, strict=True):
        coarse = max(1.0, shape[1] / COARSE)
        reduced = (max(1, round(shape[0] / coarse)), round(shape[1] / coarse)) if levelling.are_neighbours else (
            shape[0], round(shape[1] / coarse)
        )  # fmt: skip
        fewer = np.maximum(1, np.rint(steps / coarse)).astype(np.int64)
        parts.append(weight[:, None] * _scatter(exponent, fewer, reduced, levelling) * weight)
    if len(parts) == 1:
        return np.asarray(parts[0])
    shared = _across(exponent, steps, levelling.shapes[0])
    sds = [np.sqrt(np.diagonal(part)) for part in parts]
    common = sds[0][:, None] * shared * sds[1]
    return np.asarray(parts[0] + parts[1] + common + common.T)


def _pairs(steps: Steps, levelling: Levelling) -> Array:
    return np.array([[lines * max(points - int(step), 0) for step in steps] for lines, points in levelling.shapes],
                    dtype=float)  # fmt: skip


def _curve(points: int) -> tuple[Array, Array]:
    """Return a level and an inclined line (2, n), orthonormal, and the rest of a parabola (n,), of length 1."""
    x = np.linspace(-1.0, 1.0, points)
    straight = np.stack([np.full(points, points**-0.5), x / np.sqrt(x @ x)])
    curve = x * x - (straight @ (x * x)) @ straight
    return straight, curve / np.sqrt(curve @ curve)


def _kernel(exponent: float, points: int, across: Array) -> Array:
    """Return -S/2 (d, 2 n - 1) of two points -(n - 1) to n - 1 apart along their lines, and so far across them (d,)."""
    return np.asarray(-0.5 * np.hypot(across[:, None], np.arange(1 - points, points)[None, :]) ** exponent)


def _mean_kernel(exponent: float, shape: tuple[int, int], levelling: Levelling) -> Array:
    """Return the mean of -S/2 over all pairs of lines, (2 n - 1,); other lines count where they are neighbours."""
    lines, points = shape
    if not levelling.are_neighbours:
        return np.asarray(_kernel(exponent, points, np.zeros(1))[0] / lines)
    apart = np.arange(lines, dtype=float)
    share = np.where(apart > 0, 2.0, 1.0) * (lines - apart) / lines**2
    return np.asarray(share @ _kernel(exponent, points, apart))


def _matrix(kernel: Array) -> Array:
    """Return the matrix (n, n) of a kernel (2 n - 1,) of differences."""
    points = (kernel.size + 1) // 2
    return np.asarray(np.lib.stride_tricks.sliding_window_view(kernel, points)[:, ::-1])


def _times(kernel: Array, vector: Array) -> Array:
    """Return the matrix of a kernel times a vector, as a convolution."""
    points, size = vector.size, 3 * vector.size
    product = np.fft.irfft(np.fft.rfft(kernel, size) * np.fft.rfft(vector, size), size)
    return np.asarray(product[points - 1 : 2 * points - 1])


def _expected(exponent: float, steps: Steps, shape: tuple[int, int], levelling: Levelling) -> Array:
    """Return S to be expected of one direction; from q, of length 1, S loses 2 mean(dq d(K q)) - mean(dq²) q K q."""
    points = shape[1]
    straight, curve = _curve(points)
    values = steps.astype(float) ** exponent
    if levelling.line:
        values = values - _lost(_kernel(exponent, points, np.zeros(1))[0], straight[1], straight[:1], steps)
    if levelling.curved:
        values = values - _lost(_mean_kernel(exponent, shape, levelling), curve, straight, steps)
    return np.asarray(values)


def _lost(kernel: Array, direction: Array, before: Array, steps: Steps) -> Array:
    """Return what S loses with a direction (n,) where those of ``before`` (m, n) are gone already."""
    product = _times(kernel, direction)
    product = product - (before @ product) @ before
    weight = float(direction @ product)
    rises = [(direction[step:] - direction[:-step], product[step:] - product[:-step]) for step in steps]
    return np.array([2.0 * np.mean(own * other) - weight * np.mean(own * own) for own, other in rises])


def _scatter(exponent: float, steps: Steps, shape: tuple[int, int], levelling: Levelling) -> Array:
    """Return the covariance (k, k) of S over its expectation, of one direction."""
    lines, points = shape
    apart, share = _distances(lines) if levelling.are_neighbours else (np.zeros(1), np.full(1, 1.0 / lines))
    straight, curve = _curve(points)
    common = _matrix(_mean_kernel(exponent, shape, levelling)) if levelling.curved else np.zeros((1, 1))
    total = np.zeros((len(steps), len(steps)))
    for part, kernel in zip(share, _kernel(exponent, points, apart), strict=True):
        total += part * _squared(_levelled(_matrix(kernel), common, straight, curve, levelling), steps)
    mean = _expected(exponent, steps, shape, levelling)
    return np.asarray(2.0 * total / np.outer(mean, mean))


def _levelled(matrix: Array, common: Array, straight: Array, curve: Array, levelling: Levelling) -> Array:
    """Return the covariance of the points of two lines (n, n) once both are level."""
    if not levelling.line:
        return matrix
    level = matrix - straight.T @ (straight @ matrix)
    level = level - (level @ straight.T) @ straight
    if levelling.curved:
        product = common @ curve
        product = product - straight.T @ (straight @ product)
        crossed = np.outer(product, curve)
        level = level - crossed - crossed.T + (curve @ product) * np.outer(curve, curve)
    return level


def _squared(level: Array, steps: Steps) -> Array:
    """Return the mean squares (k, k) of the covariances of increments of two lines; some beginnings on the first."""
    points = len(level)
    rows = []
    for step in steps:
        begins = np.unique(np.linspace(0, points - step - 1, SOME).astype(int))
        rows.append(level[begins + step] - level[begins])
    return np.array([[np.mean((row[:, step:] - row[:, :-step]) ** 2) for step in steps] for row in rows])


def _distances(lines: int) -> tuple[Array, Array]:
    """Return some distances of two lines, and how often they stand for those about them; together 1."""
    apart = np.unique(np.round(np.geomspace(1.0, lines, APART)) - 1.0)
    every = np.arange(lines, dtype=float)
    often = np.where(every > 0, 2.0, 1.0) * (lines - every) / lines**2
    after = np.minimum(np.searchsorted(apart, every, side="right"), len(apart) - 1)
    before = np.maximum(after - 1, 0)
    way = np.where(after > before, (every - apart[before]) / np.maximum(apart[after] - apart[before], 1.0), 0.0)
    share = np.bincount(before, often * (1.0 - way), len(apart)) + np.bincount(after, often * way, len(apart))
    return np.asarray(apart, dtype=np.float64), np.asarray(share, dtype=np.float64)


def _across(exponent: float, steps: Steps, shape: tuple[int, int]) -> Array:
    """Return the correlations (k, k) of S along a line with S across it, heights as they are."""
    coarse = max(1.0, max(shape) / COARSE)
    rows, points = (max(2, round(count / coarse)) for count in shape)
    fewer = np.maximum(1, np.rint(steps / coarse)).astype(np.int64)
    longest = int(fewer.max())
    y, x = (np.arange(-count - longest, count + longest + 1) for count in (rows, points))
    heights = np.hypot(y[:, None], x[None, :]) ** exponent
    weight = np.maximum(rows - np.abs(np.arange(-rows, rows + 1)), 0)[:, None] * np.maximum(
        points - np.abs(np.arange(-points, points + 1)), 0
    )
    weight = weight / weight.sum()

    def seen(down: int, right: int) -> Array:
        return heights[
            longest + down : longest + down + 2 * rows + 1, longest + right : longest + right + 2 * points + 1
        ]

    def shared(one: tuple[int, int], two: tuple[int, int]) -> float:
        apart = seen(two[0], two[1]) + seen(-one[0], -one[1]) - seen(0, 0) - seen(two[0] - one[0], two[1] - one[1])
        return float(np.sum(weight * np.square(0.5 * apart)))

    along, across = [(0, int(step)) for step in fewer], [(int(step), 0) for step in fewer]
    own = [[shared(each, each) for each in way] for way in (along, across)]
    both = np.array([[shared(one, two) for two in across] for one in along])
    return np.asarray(both / np.sqrt(np.outer(own[0], own[1])))
