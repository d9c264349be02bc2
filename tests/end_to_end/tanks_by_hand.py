"""Two tanks by another hand than the example's: Runge-Kutta, a hard rim, and what the measured record says of them.

Run as a script it fits the benchmark's estimation record and prints what the tests cite.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]
STEP = 4.0
PARTS = 4
NOISE = 0.0376
"""Innovations of a wander that carries over by 0.95 from row to row, V."""
EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "cascaded_tanks"


@dataclass(frozen=True)
class Rig:
    """Constants of the literature, levels in V: numbers or arrays (n,). No rim where ``rim`` is infinite.

    The lower outlet lets out k3 sqrt(10 V) (x2 / 10 V)^power.
    """

    k1: Any = 0.05
    k3: Any = 0.05
    k4: Any = 0.04
    upper: Any = 5.2
    lower: Any = 5.2
    rim: Any = np.inf
    caught: Any = 0.5
    power: Any = 0.5


def levels(rig: Rig, voltage: Array) -> Array:
    """Levels of the lower tank (k, n) by Runge-Kutta of fourth order; water above the rim is gone after each step."""
    x1, x2 = np.asarray(rig.upper, dtype=float), np.asarray(rig.lower, dtype=float)
    found, h = [x2], STEP / PARTS
    for u in voltage[:-1]:
        for _ in range(PARTS):
            x1, x2 = _stepped(rig, (x1, x2), rig.k4 * u, h)
            over = np.maximum(x1 - rig.rim, 0.0)
            x1, x2 = x1 - over, x2 + rig.caught * over
        found.append(x2)
    return np.array(found)


def _stepped(rig: Rig, at: tuple[Array, Array], inflow: Any, h: float) -> tuple[Array, Array]:
    def rate(x1: Array, x2: Array) -> tuple[Array, Array]:
        out = rig.k1 * np.sqrt(np.maximum(x1, 0.0))
        return inflow - out, out - rig.k3 * np.sqrt(10.0) * (np.maximum(x2, 1e-9) / 10.0) ** rig.power

    a = rate(*at)
    b = rate(at[0] + h / 2 * a[0], at[1] + h / 2 * a[1])
    c = rate(at[0] + h / 2 * b[0], at[1] + h / 2 * b[1])
    d = rate(at[0] + h * c[0], at[1] + h * c[1])
    up, low = (at[i] + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) for i in (0, 1))
    return np.maximum(up, 0.0), np.maximum(low, 0.0)


def record(name: str) -> tuple[Array, Array]:
    """Pump voltage and measured level of a record of the example."""
    rows = np.genfromtxt(EXAMPLE / f"{name}.csv", delimiter=",", skip_header=1, usecols=(2, 3))
    return rows[:, 0], rows[:, 1]


def fitted(start: Mapping[str, float], high: Mapping[str, float], known: Mapping[str, float], rho: float) -> Rig:
    """Fit some constants to the estimation record, to white noise (``rho`` 0) or to one that carries over.

    ``known`` holds the relative standard deviation of constants about where the fit starts, whose innovations are
    NOISE; without it nothing is known beforehand.
    """
    voltage, measured = record("estimation")
    names, begin = list(start), np.array(list(start.values()))
    sd = np.array([known.get(name, np.inf) * start[name] for name in names])

    def residual(values: Array) -> Array:
        off = levels(Rig(**dict(zip(names, values, strict=True))), voltage)
        off = off - measured.reshape(-1, *[1] * (off.ndim - 1))
        white = np.concatenate([off[:1] * np.sqrt(1 - rho**2), off[1:] - rho * off[:-1]]) / NOISE
        return np.concatenate([white, ((values.T - begin) / sd).T])

    def slopes(values: Array) -> Array:
        step = 1e-5 * np.maximum(np.abs(values), 1e-2)
        made = residual(values[:, None] + np.column_stack([np.diag(step), -np.diag(step)]))
        return np.asarray((made[:, : len(values)] - made[:, len(values) :]) / (2 * step))

    most = [high.get(name, 1.0) for name in names]
    found = least_squares(residual, begin, jac=slopes, bounds=(1e-3, most), x_scale=begin)
    return Rig(**dict(zip(names, found.x.tolist(), strict=True)))


def errors(rig: Rig) -> dict[str, float]:
    """Root mean square errors on both records, V."""
    found = {}
    for name in ("estimation", "validation"):
        voltage, measured = record(name)
        found[name] = float(np.sqrt(np.mean((levels(rig, voltage) - measured) ** 2)))
    return found


if __name__ == "__main__":
    base = {"k1": 0.16 / 10**0.5, "k3": 0.16 / 10**0.5, "k4": 0.04, "upper": 5.2, "lower": 5.2}
    rim = {"rim": 11.0, "caught": 0.5}
    most = {"upper": 30.0, "lower": 12.0, "rim": 30.0}
    sure = {"k1": 0.1, "k3": 0.1, "k4": 0.1, "upper": 1 / 5.2, "lower": 0.1 / 5.2}
    for begin, given, rho in (
        (base, {}, 0.0), (base | rim, {}, 0.0), (base | rim, sure, 0.95), (base | rim | {"power": 0.4}, sure, 0.95),
    ):  # fmt: skip
        best = fitted(begin, most, given, rho)
        print(best, errors(best))
