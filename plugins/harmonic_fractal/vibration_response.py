"""Steady vibration of an oscillator with clearance: its periodic motions over the frequency, and what a run meets.

Everything here is without dimension, for a batch of machines at once. Lengths are in parts of a scale L, time is the
phase of the mesh. With r the mesh frequency over the natural one:

    r^2 x'' + 2 zeta r x' + (1 + epsilon cos phase) f(x) = mean + (force + r^2 error) cos phase

f is the backlash function: 0 within plus and minus the clearance, and straight beyond with slope 1.
"""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from truing import Array, Float

HARMONICS = 7
"""Of the motion: its amplitudes fall with the fourth power of the order, since the force has kinks."""
SAMPLES = 96
"""Of a period; between them the motion is taken as straight, and the force is exact, so it has no steps."""
CLOSE = 1e-7
"""Residual force, in parts of that of the scale, from which one more round of Newton's iteration leaves rounding."""
ROUNDS = 12
"""Of Newton's iteration."""
FIRST, LARGEST, SMALLEST = 0.02, 0.15, 1e-6
"""Steps along the curve, as a distance in frequency ratio and harmonics."""
TURN = 0.95
"""Cosine of the angle between two steps from which on they are shorter: at folds, and where contact is lost."""
MOST_STEPS = 3000
FARTHEST = 2 * MOST_STEPS * LARGEST
"""A way so long is not set out on: these steps end at half of it."""

SURELY = 0.9
"""Part of the mean force that a wave may take away for a start in contact."""
PARTS, NARROWED = 8, 5
"""A fold is looked for in so many parts of a step, and so often again between the two beside the best."""

COUNT = 2 * HARMONICS + 1
_STEP = float(2.0 * np.pi / SAMPLES)
_ORDERS = np.arange(1, HARMONICS + 1)
_COS, _SIN = slice(1, HARMONICS + 1), slice(HARMONICS + 1, COUNT)
_DIAGONAL = np.arange(COUNT)


def _waves(phase: Array) -> Array:
    """Return a mean, cosines and sines at phases (N,), as (N, 2H + 1)."""
    turned = phase[:, np.newaxis] * _ORDERS
    return np.concatenate([np.ones((len(phase), 1)), np.cos(turned), np.sin(turned)], axis=1)


_PLACES: Array = np.arange(SAMPLES, dtype=np.float64)
BASIS = _waves(_STEP * _PLACES)
_MIDDLE: Array = _STEP * (_PLACES + 0.5)
_FLATTENED = np.cos(0.5 * _STEP * np.concatenate([[0], _ORDERS, _ORDERS]))
"""What the mean over a straight piece leaves of each harmonic: taken out again, so contact throughout is exact."""
_FORCE = _waves(_MIDDLE) / SAMPLES * np.where(_DIAGONAL == 0, 1.0, 2.0) / _FLATTENED
_TURNED = np.ascontiguousarray(BASIS.T)
_SLOPES = np.concatenate(
    [np.einsum("na,nb->nab", _FORCE, basis).reshape(SAMPLES, -1) for basis in (BASIS, np.roll(BASIS, -1, axis=0))]
)
"""What slopes of the force in begin and end of each piece (2N) are as slopes of harmonics in harmonics."""


@dataclass(frozen=True, kw_only=True)
class Oscillators:
    """Machines, each (n,): clearance to either side, mean force, its wave, error, damping ratio, wave of stiffness."""

    clearance: Array
    mean: Array
    force: Array
    error: Array
    damping: Array
    variation: Array

    def part(self, rows: NDArray[np.intp]) -> "Oscillators":
        """Return some of the machines, or the same ones several times."""
        return Oscillators(**{each.name: getattr(self, each.name)[rows] for each in fields(self)})


def backlash(x: Float, clearance: Float) -> Float:
    """Return the force over the stiffness: straight beyond the clearance to either side, nothing within (figure 2)."""
    return x - np.minimum(np.maximum(x, -clearance), clearance)


def stiffness_wave(machines: Oscillators) -> Array:
    """Return the stiffness over its mean, in the middle of each piece of a period, (n, 1, N)."""
    return np.asarray(1.0 + machines.variation[:, np.newaxis, np.newaxis] * np.cos(_MIDDLE))


def _mean_contact(begin: Array, end: Array) -> tuple[Array, Array, Array]:
    """Return the mean of the positive part of what runs straight from begin to end, and its slopes in both."""
    inside = np.maximum(begin, 0.0) + np.maximum(end, 0.0)
    whole = inside + np.maximum(-begin, 0.0) + np.maximum(-end, 0.0)
    share = inside / np.where(whole > 0.0, whole, 1.0)
    of_inner, of_outer = share - 0.5 * share**2, 0.5 * share**2
    return 0.5 * share * inside, np.where(begin > 0.0, of_inner, of_outer), np.where(end > 0.0, of_inner, of_outer)


def _row_by_row(rows: Array, by: Array) -> Array:
    """Return rows (..., m) times a matrix (m, p), each by itself: so it rounds alike whatever else is in the batch."""
    return np.asarray(np.matmul(rows[..., np.newaxis, :], by)[..., 0, :])


def residual(machines: Oscillators, harmonics: Array, ratio: Array) -> tuple[Array, Array, Array]:
    """Return what is left of harmonic balance (n, 2H + 1), its slopes in the harmonics, and in the frequency ratio."""
    begin = motion_of(harmonics)
    end, gap = np.roll(begin, -1, axis=1), machines.clearance[:, np.newaxis]
    wave = stiffness_wave(machines)[:, 0]
    ahead, behind = _mean_contact(begin - gap, end - gap), _mean_contact(-begin - gap, -end - gap)
    left = _row_by_row(wave * (ahead[0] - behind[0]), _FORCE)
    by_begin, by_end = wave * (ahead[1] + behind[1]), wave * (ahead[2] + behind[2])
    slope = _row_by_row(np.concatenate([by_begin, by_end], axis=1), _SLOPES).reshape(-1, COUNT, COUNT)
    r, cosines, sines = ratio[:, np.newaxis], harmonics[:, _COS], harmonics[:, _SIN]
    drag = 2.0 * machines.damping[:, np.newaxis] * _ORDERS
    left[:, _COS] += drag * r * sines - (r * _ORDERS) ** 2 * cosines
    left[:, _SIN] += -drag * r * cosines - (r * _ORDERS) ** 2 * sines
    left[:, 0] -= machines.mean
    left[:, 1] -= machines.force + ratio**2 * machines.error
    slope[:, _DIAGONAL[1:], _DIAGONAL[1:]] -= np.tile((r * _ORDERS) ** 2, 2)
    slope[:, _DIAGONAL[_COS], _DIAGONAL[_SIN]] += drag * r
    slope[:, _DIAGONAL[_SIN], _DIAGONAL[_COS]] -= drag * r
    by_ratio = np.zeros_like(harmonics)
    by_ratio[:, _COS] = drag * sines - 2.0 * r * _ORDERS**2 * cosines
    by_ratio[:, _SIN] = -drag * cosines - 2.0 * r * _ORDERS**2 * sines
    by_ratio[:, 1] -= 2.0 * ratio * machines.error
    return left, slope, by_ratio


def linear(machines: Oscillators, ratio: Array) -> Array:
    """Return the harmonics (n, 2H + 1) of the motion in contact throughout with a stiffness that stays: closed form."""
    harmonics = np.zeros((len(ratio), COUNT))
    drive = (machines.force + ratio**2 * machines.error) / (1.0 - ratio**2 + 2j * machines.damping * ratio)
    harmonics[:, 0] = machines.clearance + machines.mean
    harmonics[:, 1], harmonics[:, HARMONICS + 1] = drive.real, -drive.imag
    return harmonics


def balanced(machines: Oscillators, harmonics: Array, ratio: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the harmonics at which forces balance at these frequency ratios, from a guess, and where they do."""
    harmonics, rows = harmonics.copy(), np.arange(len(ratio))
    is_close = np.zeros(len(ratio), dtype=bool)
    for _ in range(ROUNDS):
        left, slope, _ = residual(machines.part(rows), harmonics[rows], ratio[rows])
        harmonics[rows] -= _solved(slope, left)
        is_close[rows] = np.abs(left).max(axis=1) < CLOSE  # and by the step just taken to rounding
        rows = rows[~is_close[rows]]
        if not len(rows):
            break
    return harmonics, is_close


def still_in_contact(machines: Oscillators) -> Array:
    """Return a frequency ratio below the resonance up to which the flanks surely stay in contact, (n,); 0 for none."""
    mean = SURELY * machines.mean
    return np.sqrt(np.maximum(mean - machines.force, 0.0) / (machines.error + mean))


# The curve of all motions that are connected: followed by its length, since it folds back over the frequency


@dataclass(frozen=True)
class Curve:
    """Points of the curves of n machines: frequency ratio (n, m) and harmonics (n, m, 2H + 1).

    Where a curve has fewer points its last one is repeated. ``is_whole`` says where the end was reached.
    """

    ratio: Array
    harmonics: Array
    is_whole: NDArray[np.bool_]


@dataclass
class _Walk:
    """Where machines are on their curves: points (n, 2H + 2) of harmonics and ratio, directions, steps."""

    rows: NDArray[np.intp]
    point: Array
    direction: Array
    step: Array

    def keep(self, on: NDArray[np.bool_]) -> None:
        """Go on with some of them."""
        self.rows, self.step = self.rows[on], self.step[on]
        self.point, self.direction = self.point[on], self.direction[on]


def traced(machines: Oscillators, first: Array, last: Array) -> Curve:
    """Return the curve of each machine from the motion in contact at the first frequency ratio (n,) to the last."""
    start, is_close = balanced(machines, linear(machines, first), first)
    walk = _Walk(
        np.arange(len(first)), np.column_stack([start, first]), np.zeros((len(first), COUNT + 1)),
        np.full(len(first), FIRST),
    )  # fmt: skip
    walk.direction[:, -1] = 1.0
    points: list[list[Array]] = [[point] for point in walk.point]
    is_whole = np.zeros(len(first), dtype=bool)
    walk.keep(is_close & (least_way(machines, first, last) < FARTHEST))
    walk.direction = _direction(_bordered(machines.part(walk.rows), walk.point, walk.direction)[1])
    for _ in range(MOST_STEPS):
        if not len(walk.rows):
            break
        for row, point in zip(*_stepped(machines, walk), strict=True):
            points[row].append(point)
        ended = walk.point[:, -1] >= last[walk.rows]
        is_whole[walk.rows[ended]] = True
        walk.keep(~ended & (walk.step >= SMALLEST))
    return _stacked(points, is_whole)


def least_way(machines: Oscillators, first: Array, last: Array) -> Array:
    """Return how long a curve is at least: its frequencies, and up to the resonance where that lies on the way.

    Clearance changes the force by 1 at most, which hardly matters to the motion there where that is long.
    """
    resonant = (machines.force + machines.error) / (2.0 * machines.damping)
    return np.maximum(last - first, np.where(first < 1.0, resonant, 0.0))


def _stacked(points: list[list[Array]], is_whole: NDArray[np.bool_]) -> Curve:
    longest = max(len(own) for own in points)
    whole = np.array([own + [own[-1]] * (longest - len(own)) for own in points])
    return Curve(whole[:, :, -1], whole[:, :, :-1], is_whole)


def _stepped(machines: Oscillators, walk: _Walk) -> tuple[NDArray[np.intp], Array]:
    """Take one step with each machine, or shorten it; return who went on, and the new points."""
    own = machines.part(walk.rows)
    guess = walk.point + walk.step[:, np.newaxis] * walk.direction
    point, rounds, whole = _corrected(own, guess, walk.direction)
    direction = _direction(whole)
    turn = (direction * walk.direction).sum(axis=1)
    is_good = (rounds < ROUNDS) & ((turn > TURN) | (walk.step <= 2 * SMALLEST))
    walk.point = np.where(is_good[:, np.newaxis], point, walk.point)
    walk.direction = np.where(is_good[:, np.newaxis], direction, walk.direction)
    longer = np.where((rounds <= 4) & (turn > 0.5 + 0.5 * TURN), 1.6, 1.0)
    shorter = np.where((rounds < ROUNDS) & (walk.step > SMALLEST), np.maximum(0.4, SMALLEST / walk.step), 0.4)
    walk.step = np.minimum(walk.step * np.where(is_good, longer, shorter), LARGEST)
    return walk.rows[is_good], point[is_good]


def _corrected(machines: Oscillators, guess: Array, direction: Array) -> tuple[Array, NDArray[np.intp], Array]:
    """Return the points of the curves across the guesses, the rounds it took, and the slopes there.

    The rounds are ROUNDS where it came to nothing.
    """
    point, rows, rounds = guess.copy(), np.arange(len(guess)), np.full(len(guess), ROUNDS)
    slopes = np.tile(np.eye(COUNT + 1), (len(guess), 1, 1))
    for number in range(ROUNDS):
        left, whole = _bordered(machines.part(rows), point[rows], direction[rows])
        right = np.concatenate([left, np.zeros((len(left), 1))], axis=1)
        point[rows] -= _solved(whole, right)
        arrived = np.abs(left).max(axis=1) < CLOSE
        slopes[rows[arrived]], rounds[rows[arrived]] = whole[arrived], number
        rows = rows[~arrived]
        if not len(rows):
            break
    return point, rounds, slopes


def _direction(whole: Array) -> Array:
    """Return the direction of the curves, of length 1, onwards from that before, the last row of the slopes."""
    onwards = np.zeros(whole.shape[:2])
    onwards[:, -1] = 1.0
    direction = _solved(whole, onwards)
    return np.asarray(direction / np.linalg.norm(direction, axis=1, keepdims=True))


def _bordered(machines: Oscillators, point: Array, direction: Array) -> tuple[Array, Array]:
    left, slope, by_ratio = residual(machines, point[:, :-1], point[:, -1])
    whole = np.empty((len(point), COUNT + 1, COUNT + 1))
    whole[:, :-1, :-1], whole[:, :-1, -1], whole[:, -1] = slope, by_ratio, direction
    return left, whole


def _solved(whole: Array, right: Array) -> Array:
    """Solve each of n systems; one without a solution is left NaN, which no round accepts."""
    try:
        return np.asarray(np.linalg.solve(whole, right[:, :, np.newaxis])[:, :, 0])
    except np.linalg.LinAlgError:
        if len(whole) == 1:
            return np.full_like(right, np.nan)
        return np.concatenate([_solved(whole[row : row + 1], right[row : row + 1]) for row in range(len(whole))])


# What a slow run up or down over the curve meets


@dataclass(frozen=True)
class Run:
    """A slow run: harmonics (n, k, 2H + 1) at the frequency ratios that were asked for.

    ``jump`` is the ratio at which the largest jump happens (n,), NaN where there is none.
    """

    harmonics: Array
    jump: Array


def run(machines: Oscillators, curve: Curve, ratio: Array, *, down: bool = False) -> Run:
    """Return the motions of a slow run up, or down, at frequency ratios (n, k).

    A run goes along the curve to where it folds back, and jumps from there to the next point of the curve that lies at
    the same frequency.
    """
    sign = -1.0 if down else 1.0
    points = sign * (curve.ratio[:, ::-1] if down else curve.ratio)
    harmonics = curve.harmonics[:, ::-1] if down else curve.harmonics
    reached = np.maximum.accumulate(points, axis=1)
    after = np.array([np.searchsorted(*each) for each in zip(reached, sign * ratio, strict=True)])
    after = np.clip(after, 1, points.shape[1] - 1)
    guess = _between(points, harmonics, after, sign * ratio)
    rows = np.repeat(np.arange(len(ratio)), ratio.shape[1])
    found, is_close = balanced(machines.part(rows), guess.reshape(-1, COUNT), ratio.ravel())
    near = np.abs(found - guess.reshape(-1, COUNT)).max(axis=1) < 0.1 * (0.1 + np.abs(guess).max())
    kept = np.where((is_close & near)[:, np.newaxis], found, guess.reshape(-1, COUNT))
    return Run(kept.reshape(guess.shape), _largest_jump(machines, points, harmonics, sign))


def _between(points: Array, harmonics: Array, after: NDArray[np.intp], wanted: Array) -> Array:
    """Return the harmonics between the point of a curve before and the one after, by the frequency."""
    rows = np.arange(len(points))[:, np.newaxis]
    low, high = points[rows, after - 1], points[rows, after]
    share = np.clip((wanted - low) / np.where(high > low, high - low, 1.0), 0.0, 1.0)[:, :, np.newaxis]
    return np.asarray(harmonics[rows, after - 1] * (1.0 - share) + harmonics[rows, after] * share)


def _largest_jump(machines: Oscillators, points: Array, harmonics: Array, sign: float) -> Array:
    """Return the frequency ratio of the fold from which the motion changes most; NaN for a curve without folds.

    ``points`` are ``sign`` times the frequency ratios along the curve.
    """
    jumps = np.full(len(points), np.nan)
    folds = [_fold(*each) for each in zip(points, harmonics, strict=True)]
    rows = np.array([row for row, fold in enumerate(folds) if fold], dtype=np.intp)
    if not len(rows):
        return jumps
    at = np.array([folds[row] for row in rows])
    whole = np.concatenate([harmonics, sign * points[:, :, np.newaxis]], axis=2)
    low, high = whole[rows, at - 1], whole[rows, np.minimum(at + 1, points.shape[1] - 1)]
    jumps[rows] = _turning_point(machines.part(rows), low, high, sign)
    return jumps


def _fold(points: Array, harmonics: Array) -> int:
    """Return the point of a curve from which the motion jumps furthest, since the frequency turns back; 0 for none."""
    backwards = points < np.maximum.accumulate(points)
    begins = np.flatnonzero(~backwards[:-1] & backwards[1:])
    ends = [begin + 1 + int(np.argmin(backwards[begin + 1 :])) for begin in begins]
    sizes = [np.abs(harmonics[end] - harmonics[begin]).max() for begin, end in zip(begins, ends, strict=True)]
    return max(int(begins[int(np.argmax(sizes))]), 1) if sizes else 0


def _turning_point(machines: Oscillators, low: Array, high: Array, sign: float) -> Array:
    """Return the frequency ratio at which curves turn back between two of their points (n, 2H + 2)."""
    count, shares = len(low), np.linspace(0.0, 1.0, PARTS + 1)[1:-1]
    several, rows = machines.part(np.repeat(np.arange(count), PARTS - 1)), np.arange(count)
    for _ in range(NARROWED):
        way = high - low
        guess = low[:, np.newaxis] + shares[:, np.newaxis] * way[:, np.newaxis]
        across = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-300)
        across = np.repeat(across, PARTS - 1, axis=0)
        point, rounds, _ = _corrected(several, guess.reshape(len(across), -1), across)
        point[rounds == ROUNDS, -1] = -sign * np.inf
        whole = np.concatenate([low[:, np.newaxis], point.reshape(guess.shape), high[:, np.newaxis]], axis=1)
        best = np.argmax(sign * whole[:, :, -1], axis=1)
        low, high = whole[rows, np.maximum(best - 1, 0)], whole[rows, np.minimum(best + 1, PARTS)]
    return np.asarray(whole[rows, best, -1])


# What is seen of a motion


def motion_of(harmonics: Array) -> Array:
    """Return the motion (..., N) over a period."""
    return _row_by_row(harmonics, _TURNED)


def largest_multiplier(machines: Oscillators, harmonics: Array, ratio: Array) -> Array:
    """Return the size of the larger Floquet multiplier of motions (n, k, 2H + 1): above 1 they do not last.

    The product of the exact transitions between the samples, over each of which the stiffness stays.
    """
    x = motion_of(harmonics)
    touching = np.abs(x) > machines.clearance[:, np.newaxis, np.newaxis]
    r, step = ratio[:, :, np.newaxis], _STEP
    decay, stiffness = machines.damping[:, np.newaxis, np.newaxis] / r, stiffness_wave(machines) / r**2
    frequency = np.sqrt(np.maximum(stiffness - decay**2, 1e-12))
    left = np.exp(-decay * step)
    cosine, sine = left * np.cos(frequency * step), left * np.sin(frequency * step) / frequency
    product = np.empty((*x.shape, 2, 2))
    product[..., 0, 0] = np.where(touching, cosine + decay * sine, 1.0)
    product[..., 0, 1] = np.where(touching, sine, (1.0 - left**2) / (2.0 * decay))
    product[..., 1, 0] = np.where(touching, -stiffness * sine, 0.0)
    product[..., 1, 1] = np.where(touching, cosine - decay * sine, left**2)
    while product.shape[-3] > 1:
        odd = product[..., -1:, :, :] if product.shape[-3] % 2 else product[..., :0, :, :]
        even = product[..., : product.shape[-3] // 2 * 2, :, :]
        product = np.concatenate([even[..., 1::2, :, :] @ even[..., ::2, :, :], odd], axis=-3)
    return np.asarray(np.abs(np.linalg.eigvals(product[..., 0, :, :])).max(axis=-1))
