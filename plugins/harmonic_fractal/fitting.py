"""Straight lines through ln S over ln lag, with or without the noise of the instrument, many at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
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
        slope=slope,
        intercept=middle - slope * x.mean(),
        noise=np.zeros_like(slope),
        r_squared=_explained(left, y),
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
    clipped: Array = np.clip(found + change, low, high)
    return clipped


def _shape(x: Array, found: Array) -> Array:
    shape: Array = np.log(np.exp(found[:, :1] * x) + found[:, 1:])
    return shape


def _residuals(x: Array, y: Array, found: Array) -> Array:
    left = y - _shape(x, found)
    centred: Array = left - left.mean(axis=-1, keepdims=True)
    return centred


def _explained(left: Array, y: Array) -> Array:
    spread = np.square(y - y.mean(axis=-1, keepdims=True)).sum(axis=-1)
    left_over = np.square(left).sum(axis=-1)
    explained: Array = np.divide(spread - left_over, spread, out=np.full(spread.shape, np.nan), where=spread > 0)
    return explained
