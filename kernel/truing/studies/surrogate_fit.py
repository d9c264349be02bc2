"""A Gaussian process as a stand-in for the model: what it learnt at some points, it says of all between them.

Squared exponential with a length of its own in every direction, and white noise (C. E. Rasmussen, C. K. I. Williams,
Gaussian Processes for Machine Learning, MIT Press 2006, chapters 2 and 5); scikit-learn does the work.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from truing.evaluate import Rows
from truing.heavy import gaussian_kernels, gaussian_process, learning_exceptions
from truing.studies.demands import Z95
from truing.studies.threads import one_thread

LENGTHS = (1e-2, 1e3)
AMPLITUDES = (1e-3, 1e3)
NOISES = (1e-9, 1.0)  # of the variance learnt: 1e-12 of the largest amplitude, well above rounding
JITTER = 1e-12
ROWS = 2**13


@dataclass(frozen=True, eq=False)
class Emulator:
    """What was learnt of one result: a fitted process over places (n, d) between 0 and 1, of the result's logarithm."""

    process: Any
    logarithmic: bool

    def mean(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the expected result (SI), of a logarithm its median; NaN where a place is NaN."""
        return self._result(_in_parts(lambda part: self.process.predict(part)[None], places)[0])

    def band(self, places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the expected result and the two ends of its 95 % band, noise included."""
        mean, sd = _in_parts(lambda part: np.array(self.process.predict(part, return_std=True)), places, 2)
        return self._result(mean), self._result(mean - Z95 * sd), self._result(mean + Z95 * sd)

    def _result(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.exp(values) if self.logarithmic else values

    @property
    def lengths(self) -> tuple[float, ...]:
        """The length of every direction over the side of the box."""
        return tuple(float(one) for one in np.atleast_1d(self.process.kernel_.k1.k2.length_scale))

    @property
    def noise(self) -> float:
        """The standard deviation of the noise over that of the results learnt."""
        return math.sqrt(self.process.kernel_.k2.noise_level)


def _in_parts(predict: Any, places: NDArray[np.float64], answers: int = 1) -> NDArray[np.float64]:
    """Predict a part at a time, so that memory stays flat; rows that are not finite stay NaN."""
    found = np.full((answers, len(places)), np.nan)
    usable = np.flatnonzero(np.isfinite(places).all(axis=1))
    with one_thread():
        for start in range(0, len(usable), ROWS):
            rows = usable[start : start + ROWS]
            found[:, rows] = predict(places[rows])
    return found


def fitted(
    places: NDArray[np.float64],
    values: NDArray[np.float64],
    *,
    logarithmic: bool,
    restarts: int,
    seed: int,
    done: Callable[[], None] = lambda: None,
) -> Emulator:
    """Learn a result (n,) at places (n, d): the lengths, amplitude and noise that make the sample most likely.

    ``done`` hears of every search for them that ends: the first, and each of the restarts.
    """
    shape = gaussian_kernels.RBF(np.ones(places.shape[1]), LENGTHS)
    kernel = gaussian_kernels.ConstantKernel(10.0, AMPLITUDES) * shape + gaussian_kernels.WhiteKernel(1e-6, NOISES)

    def searched(likelihood: Any, start: Any, bounds: Any) -> tuple[Any, float]:
        found: Any = minimize(likelihood, start, method="L-BFGS-B", jac=True, bounds=bounds)  # as scikit-learn does
        done()
        return found.x, found.fun

    process = gaussian_process.GaussianProcessRegressor(
        kernel, alpha=JITTER, normalize_y=True, n_restarts_optimizer=restarts, random_state=seed % 2**32,
        optimizer=searched,
    )  # fmt: skip
    with one_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore", learning_exceptions.ConvergenceWarning)
        process.fit(places, np.log(values) if logarithmic else values)
    process.set_params(optimizer=None)  # it is fitted, and travels to workers
    return Emulator(process, logarithmic)


def usable(rows: Rows, names: tuple[str, ...], *, logarithmic: bool) -> NDArray[np.bool_]:
    """Say which rows have every result, and above zero where the logarithm is learnt."""
    kept = ~rows.failed
    for name in names:
        values = rows.results[name]
        kept &= np.isfinite(values) & ((values > 0) if logarithmic else True)
    return kept


def taken(columns: Mapping[str, Any], kept: NDArray[np.bool_]) -> dict[str, Any]:
    """Return the rows of a batch that are kept."""
    return {name: values[kept] for name, values in columns.items()}
