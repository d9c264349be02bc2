"""An oscillator with clearance, and a gear pair made of it, by fixed steps: nothing of the plugin is imported.

Without dimension: x'' + 2 zeta x' + f(x) = mean + (force + r^2 error) cos(r t), all machines side by side.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEPS = 48
"""Of Runge and Kutta's method of order 4, in a period."""


@dataclass(frozen=True)
class Machines:
    """Clearance to either side, mean force, its wave, transmission error and damping ratio, each (n,)."""

    clearance: Array
    mean: Array
    force: Array
    error: Array
    damping: Array


def followed(machines: Machines, state: Array, ratio: Array, periods: int) -> tuple[Array, Array]:
    """Return the states (2, n) after so many periods, and the motion over the last one (STEPS, n)."""
    step, size = 2 * np.pi / ratio / STEPS, machines.force + ratio**2 * machines.error
    waves = np.cos(np.pi * np.arange(2 * STEPS + 1) / STEPS)
    last = np.zeros((STEPS, len(ratio)))

    def rate(now: Array, wave: float) -> Array:
        x, speed = now
        contact = x - np.minimum(np.maximum(x, -machines.clearance), machines.clearance)
        return np.array([speed, machines.mean + size * wave - 2 * machines.damping * speed - contact])

    for _ in range(periods):
        for number in range(STEPS):
            last[number] = state[0]
            begin, middle, end = waves[2 * number : 2 * number + 3]
            first = rate(state, begin)
            second = rate(state + step / 2 * first, middle)
            third = rate(state + step / 2 * second, middle)
            fourth = rate(state + step * third, end)
            state = state + step / 6 * (first + 2 * second + 2 * third + fourth)
    return state, last


def run(machines: Machines, ratios: Array, periods: int = 40) -> Array:
    """Return half the height of y = x + error cos over slow runs through frequency ratios (k, n), as (k, n)."""
    state = np.array([machines.clearance + machines.mean, 0 * machines.mean])
    heights, wave = np.zeros(ratios.shape), np.cos(2 * np.pi * np.arange(STEPS) / STEPS)[:, np.newaxis]
    for number, ratio in enumerate(ratios):
        state, last = followed(machines, state, ratio, periods)
        heights[number] = _height(last + machines.error * wave)
    return heights


def _height(motion: Array) -> Array:
    """Half of highest less lowest, each by a parabola through three samples of a period."""

    def top(values: Array) -> Array:
        at, columns = values.argmax(axis=0), np.arange(values.shape[1])
        before, highest, after = (values[(at + shift) % len(values), columns] for shift in (-1, 0, 1))
        bend = before - 2 * highest + after
        return np.asarray(highest - (after - before) ** 2 / (8 * np.where(bend == 0, -np.inf, bend)))

    return np.asarray((top(motion) + top(-motion)) / 2)
