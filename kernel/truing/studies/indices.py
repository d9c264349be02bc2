"""Sobol indices of the exact model under the real distributions: how much of the variance each source explains.

Estimator of A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, as scipy has it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from truing.heavy import stats
from truing.studies.bench import Done
from truing.studies.sampling import Machines, standard_rows

ROWS = 2**14


class _Standard:
    """The standard normal distribution, as far as scipy asks for it."""

    def ppf(self, share: Any) -> Any:
        """Return the quantile; the outermost points of a Sobol sequence stay finite."""
        tiny = 2.0**-54
        return ndtri(np.clip(share, tiny, 1 - 2.0**-53))


@dataclass
class _Sampled:
    """Runs the model in batches; remembers whether a machine failed."""

    machines: Machines
    results: Sequence[str]
    done: Callable[[int], None]
    failed: int = 0
    reason: str = ""
    run: int = 0

    def __call__(self, standard: NDArray[np.float64]) -> NDArray[np.float64]:
        count = standard.shape[1]
        standard = standard[: self.machines.scatter.dimension]
        answers = np.empty((len(self.results), count))
        for start in range(0, count, ROWS):
            part = np.ascontiguousarray(standard[:, start : start + ROWS])
            rows, _ = standard_rows(self.machines, part, self.results)
            for place, result in enumerate(self.results):
                answers[place, start : start + ROWS] = rows.results[result]
            self.failed += int(rows.failed.sum())
            self.reason = self.reason or next(iter(rows.reasons.values()), "")
            self.run += part.shape[1]
            self.done(self.run)
        return answers


def sobol_indices(
    machines: Machines, results: Sequence[str], samples: int, progress: Done = lambda step, steps: None
) -> tuple[dict[str, dict[str, float]], dict[str, dict[str, float]], list[str]]:
    """Return first-order and total indices by result and source, and what is to be said of them.

    There are none, and a sentence says so, where sources scatter together or machines fail.
    """
    causes = machines.scatter.causes
    joint = [cause.name for cause in causes if cause.mixing is not None]
    if joint:
        return {}, {}, [f"no Sobol indices: they need independent sources, and those of {' and '.join(joint)} are not"]
    sources = [column for cause in causes for column in cause.columns]
    dimensions = max(len(sources), 2)  # scipy wants two; one that nothing depends on does no harm
    model = _Sampled(machines, results, lambda run: progress(run, samples * (dimensions + 2)))
    rng = np.random.default_rng(np.random.SeedSequence(machines.setup.seed, spawn_key=(0x50B01,)))
    dists = [_Standard()] * dimensions
    found = stats.sobol_indices(func=model, n=samples, dists=dists, rng=rng)
    if model.failed:
        return {}, {}, [f"no Sobol indices: {model.failed} machines failed, the first because {model.reason}"]
    first = np.reshape(found.first_order, (len(results), len(dists)))
    total = np.reshape(found.total_order, (len(results), len(dists)))
    return _by_name(results, sources, first), _by_name(results, sources, total), []


def _by_name(
    results: Sequence[str], sources: Sequence[str], values: NDArray[np.float64]
) -> dict[str, dict[str, float]]:
    """Return indices by result and source; an input with two tolerances has the sum of both."""
    found: dict[str, dict[str, float]] = {}
    for place, result in enumerate(results):
        found[result] = {}
        for column, source in enumerate(sources):
            found[result][source] = found[result].get(source, 0.0) + float(values[place, column])
    return found
