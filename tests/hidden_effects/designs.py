"""How a press is measured: the rows of a record, and the noise of its gauges."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import radians
from typing import Literal, TypeAlias

import numpy as np
from scipy.linalg import block_diag

from hidden_effects.press_machine import POSITION, TILT, Array, Rows
from hidden_effects.rigs import Kind, noise_of

Design: TypeAlias = Literal["wide", "narrow", "warm-up"]
DESIGNS: tuple[Design, ...] = ("wide", "narrow", "warm-up")
HOUR = 3600.0


@dataclass(frozen=True)
class Noise:
    """What a gauge adds: its standard deviation by result, autocorrelation and, where it grows, its spread by row."""

    kind: Kind
    sd: Mapping[str, float]
    autocorrelation: float = 0.0

    def spread(self, rows: Rows, result: str) -> Array:
        """Standard deviation of every row; where it grows, from 0.4 up to 1.6 parts over the loads of the record."""
        if self.kind != "growing":
            return np.full(len(rows), self.sd[result])
        load = np.abs(rows.forming_force)
        part = 0.4 + 1.2 * (load - load.min()) / np.ptp(load)
        return np.asarray(self.sd[result] * part / np.sqrt(np.mean(part**2)))

    def covariance(self, rows: Rows, result: str) -> Array:
        """Covariance of the rows of one result."""
        sd = self.spread(rows, result)
        apart = np.abs(np.subtract.outer(np.arange(len(rows)), np.arange(len(rows))))
        return np.asarray(np.outer(sd, sd) * self.autocorrelation**apart)

    def drawn(self, rows: Rows, result: str, rng: np.random.Generator) -> Array:
        """One record of this noise."""
        pure = noise_of(self.kind, len(rows), rng, freedom=3, memory=self.autocorrelation)
        return np.asarray(self.spread(rows, result) * pure)


def drawn_noise(kind: Kind, rng: np.random.Generator) -> Noise:
    """A gauge of one to two micrometres, and a few microradians of tilt."""
    sd = {POSITION: rng.uniform(1e-6, 2e-6), TILT: rng.uniform(2e-6, 4e-6)}
    return Noise(kind, sd, rng.uniform(0.3, 0.8) if kind == "autocorrelated" else 0.0)


def _times(count: int, hours: float, rng: np.random.Generator) -> Array:
    """Times since the first row, which is at 0."""
    return np.concatenate([[0.0], np.sort(rng.uniform(0.0, hours, count - 1))]) * HOUR


def _strokes(times: Array, most: float, rng: np.random.Generator) -> Array:
    """Strokes since the first row: shifts of their own pace, with pauses between them."""
    edges = np.linspace(0.0, times[-1], 7)
    pace = rng.gamma(1.5, 1.0, 6) + 0.05
    made = np.interp(times, edges, np.concatenate([[0.0], np.cumsum(pace)]))
    return np.asarray(np.round(most * made / made[-1]))


def _within(low: float, high: float, count: int, rng: np.random.Generator) -> Array:
    return rng.uniform(low, high, count)


def wide(count: int, rng: np.random.Generator) -> Rows:
    """Everything varied over its whole range and by itself, with reversals of the load."""
    reach = 180.0 if rng.random() < 0.4 else 60.0
    force = _within(0.0, 1000e3, count, rng)
    force = np.where(rng.random(count) < 0.25, -0.2 * force, force)
    times = _times(count, rng.uniform(6.0, 10.0), rng)
    return Rows(
        crank_angle=np.radians(_within(-reach, reach, count, rng)),
        forming_force=force,
        link_temperature=_within(20.0, 45.0, count, rng),
        time=times,
        strokes=_strokes(times, rng.uniform(0.4e6, 1e6), rng),
        speed=_within(10.0, 50.0, count, rng) / 60,
        direction=rng.choice([-1.0, 1.0], count),
    )


def narrow(count: int, rng: np.random.Generator) -> Rows:
    """One way of working: a small part of every range, load of one sign."""
    angle, force = radians(rng.uniform(-30, 30)), rng.uniform(300e3, 800e3)
    warm, speed = rng.uniform(22, 38), rng.uniform(15, 40) / 60
    times = _times(count, rng.uniform(1.0, 4.0), rng)
    return Rows(
        crank_angle=angle + _within(-1, 1, count, rng) * radians(rng.uniform(8, 20)),
        forming_force=force + _within(-1, 1, count, rng) * rng.uniform(50e3, 200e3),
        link_temperature=warm + _within(-1, 1, count, rng) * rng.uniform(2, 5),
        time=times,
        strokes=_strokes(times, rng.uniform(0.05e6, 0.3e6), rng),
        speed=speed * (1 + _within(-1, 1, count, rng) * rng.uniform(0.1, 0.3)),
        direction=rng.choice([-1.0, 1.0], count),
    )


def warming(count: int, rng: np.random.Generator) -> Rows:
    """A shift from cold: the temperature follows the time, all else varies by itself."""
    rows = wide(count, rng)
    rise, constant = rng.uniform(12, 25), rng.uniform(1.0, 4.0) * HOUR
    sensed = rng.normal(0.0, 0.2, count)
    temperature = 20 + rise * -np.expm1(-rows.time / constant) + sensed
    return Rows(**{**vars(rows), "link_temperature": temperature})


def measured(design: Design, count: int, rng: np.random.Generator) -> Rows:
    """The rows of one record in order of time; the first is at time 0 and stroke 0."""
    return {"wide": wide, "narrow": narrow, "warm-up": warming}[design](count, rng)


def parted(rows: Rows, count: int, rng: np.random.Generator) -> tuple[Rows, Rows]:
    """Part a record into ``count`` rows to learn from and, from among them, rows to judge; both begin with its first.

    So time and strokes count from the same row in both.
    """
    kept = np.sort(rng.choice(np.arange(1, len(rows)), count - 1, replace=False))
    other = np.setdiff1d(np.arange(1, len(rows)), kept)
    first = np.zeros(1, dtype=np.intp)
    return rows.taken(np.concatenate([first, kept])), rows.taken(np.concatenate([first, other]))


def covariance(noise: Noise, rows: Rows, results: Sequence[str]) -> Array:
    """Covariance of all rows of all results, one result after another."""
    return np.asarray(block_diag(*(noise.covariance(rows, result) for result in results)))
