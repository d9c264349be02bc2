"""What the extension is worth on rows it has not seen: the whole search is repeated in every fold.

Folds are interleaved blocks of consecutive rows; every gap starts the noise filter anew. The comparison is with the
base model calibrated in the same fold, never with the nominal one: calibration is not the merit of a cause.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log, pi, sqrt
from typing import TYPE_CHECKING

from truing.diagnosis.columns import times
from truing.diagnosis.contest import Contest, contest
from truing.diagnosis.decide import Thresholds, decide_again, without_needless_inputs
from truing.diagnosis.noise import SETTINGS, Setting
from truing.diagnosis.search import NoiseModel, Solution
from truing.studies.bench import Done, unheard

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

FOLDS = 5
SHORTEST_BLOCK = 6
FEWEST_BLOCKS = 8
"""A short record has shorter blocks rather than fewer: of four that all gain the best significance is 1/16."""
BLOCKS = 20
FLIPS = 999
MOST_EXACT = 12
"""Of so many blocks all signs are tried, of more some that are drawn."""
ROUNDING = 1e-9
COVERED = 0.9
SMALLEST_GAIN = 1e-6
"""Less than this per row is rounding, not gain."""
ROUNDS = 2


@dataclass(frozen=True)
class Judged:
    """Held-out answers of one result, shape (n,) over all rows of the records, NaN where none.

    ``before`` and ``after`` are errors (SI) of base and extended model, ``gain`` the difference of log densities,
    ``inside`` whether the 90 % interval of the extended model covered the value.
    """

    before: Matrix
    after: Matrix
    gain: Matrix
    inside: Matrix


@dataclass(frozen=True)
class Nested:
    """The cross-validation: answers by result, the block each row lay in, and the share of folds with the same name."""

    judged: dict[str, Judged]
    block_of: NDArray[np.intp]
    stability: float


def blocks_of(full: Contest, setting: tuple[int, ...]) -> NDArray[np.intp]:
    """Number blocks of consecutive rows inside each run: a twentieth of the rows, six, or three correlation times.

    A record of fewer than 48 rows has blocks of an eighth of it. Rows held out on request are in no block (-1). Where
    something is fitted file by file, a run has two blocks at least: no fold may leave out all that is known of a file.
    """
    import numpy as np

    records = full.problem.machine.records
    usable = np.flatnonzero(~records.held_out)
    runs = records.run_of[usable]
    first = np.flatnonzero(np.append(True, runs[1:] != runs[:-1]))
    sizes = np.diff(np.append(first, len(runs)))
    reach = max(_correlation_rows(SETTINGS[place]) for place in setting)
    shortest = min(SHORTEST_BLOCK, max(2, len(runs) // FEWEST_BLOCKS))
    length = int(max(shortest, len(runs) // BLOCKS, min(3 * reach, len(runs) // (2 * FOLDS))))
    if full.problem.machine.start.diagnose.per_file:
        length = min(length, max(int(sizes.min()) // 2, 1))
    blocks = -(-sizes // length)
    within = (np.arange(len(runs)) - np.repeat(first, sizes)) // length
    block_of = np.full(len(records), -1, dtype=np.intp)
    block_of[usable] = np.repeat(np.cumsum(blocks) - blocks, sizes) + within
    return block_of


def _correlation_rows(setting: Setting) -> float:
    return 0.0 if setting.rho <= 0 else -1.0 / log(setting.rho)


def nested(full: Contest, winner: int, thresholds: Thresholds, raw: NoiseModel, *, done: Done = unheard) -> Nested:
    """Repeat the search in every fold and judge it on the rows left out; ``raw`` is the first idea of the noise."""
    import numpy as np

    records = full.problem.machine.records
    block_of = blocks_of(full, full.found.setting[winner])
    usable = ~records.held_out
    key = full.found.hypotheses[winner].key
    size = len(records)
    judged = {name: Judged(*(np.full(size, np.nan) for _ in range(4))) for name in records.measured}
    same = 0
    settings = list(dict.fromkeys(full.found.setting))  # under which some explanation does best on all rows
    folds = min(FOLDS, int(block_of.max()) + 1)
    for fold in range(folds):
        done(fold, folds)
        test = (block_of >= 0) & (block_of % folds == fold)
        again = contest(full.problem, raw, usable & ~test, rounds=ROUNDS, settings=settings, sharpen=False)
        again = without_needless_inputs(again)
        place = decide_again(again, thresholds) if winner else 0
        same += again.found.hypotheses[place].key == key
        base = again.base()
        extended = again.solution(place) if place else base
        for channel, name in enumerate(judged):
            _judge(judged[name], again, (base, extended), channel, test)
    return Nested(judged, block_of, same / folds)


def _judge(
    judged: Judged, again: Contest, solutions: tuple[Solution, Solution], channel: int, test: NDArray[np.bool_]
) -> None:
    """Fill in the rows of one fold for one result."""
    import numpy as np

    item = again.evidence.channels[channel]
    weights = again.noise.weights[item.name][test]
    left_over = _residual(again, item.name)
    logs = []
    for solution, errors in zip(solutions, (judged.before, judged.after), strict=True):
        off = left_over - linear_prediction(again, solution, item.name)
        trained, error = off[item.rows] * item.weights, off[test]
        errors[test] = error
        left = solution.innovations[channel]
        setting = SETTINGS[solution.setting[channel]]
        sd = float(np.sqrt(np.mean(left**2) * setting.variance_ratio)) * item.scale
        if setting.rho > 0:  # a misfit may remember longer than any filter
            sd = max(sd, float(np.sqrt(np.mean(trained**2))))
        logs.append(_log_density(error * weights / sd, again.noise.tails[item.name].freedom) + np.log(weights / sd))
    judged.gain[test] = logs[1] - logs[0]
    limit = float(np.quantile(np.abs(trained), COVERED))  # of the extended model, which comes last
    limit *= sqrt(len(trained) / max(len(trained) - len(solutions[1].coefficients) - len(solutions[1].directions), 1))
    outside = np.abs(judged.after[test] * weights) > limit
    judged.inside[test] = np.where(np.isfinite(judged.after[test]), ~outside, np.nan)


def _residual(again: Contest, name: str) -> Matrix:
    """Return measured minus predicted at the mean of the tolerances, SI, never clipped."""
    from truing.diagnosis.search import residuals_of

    return residuals_of(again.problem.machine)[name]


def linear_prediction(again: Contest, solution: Solution, name: str) -> Matrix:
    """Return what a solution adds to the model at the mean of the tolerances, SI, on all rows of the records."""
    import numpy as np

    machine = again.problem.machine
    u = solution.directions
    made = times(machine.slopes[name], again.evidence.directions @ u) if len(u) else np.zeros(len(machine.records))
    for column, value in zip(solution.hypothesis.columns, solution.coefficients, strict=True):
        item = again.problem.columns[column]
        if name in item.parts:
            made = made + item.parts[name] * (item.per * value)
    return np.asarray(made)


def _log_density(z: Matrix, freedom: float) -> Matrix:
    """Return the log density of Student's t with unit variance, the normal law for many degrees of freedom."""
    import numpy as np
    from scipy.special import gammaln

    if freedom == inf or freedom >= 30:
        return np.asarray(-0.5 * z**2 - 0.5 * log(2 * pi))
    shrink = freedom / (freedom - 2)
    norm = gammaln((freedom + 1) / 2) - gammaln(freedom / 2) - 0.5 * np.log((freedom - 2) * pi)
    return np.asarray(norm - (freedom + 1) / 2 * np.log1p(z**2 * shrink / freedom))


def sign_flip_p(gain: Matrix, block_of: NDArray[np.intp], *, seed: int) -> float:
    """Return the significance of a gain: how often random signs of the blocks give as much."""
    import numpy as np

    known = np.isfinite(gain)
    sums = np.bincount(block_of[known], weights=gain[known])
    sums = sums[np.bincount(block_of[known]) > 0]
    total = float(sums.sum())
    if total <= SMALLEST_GAIN * len(gain) or len(sums) < 2:
        return 1.0
    least = total * (1 - ROUNDING)
    if len(sums) <= MOST_EXACT:
        signs = 1.0 - 2.0 * (np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums)) & 1)
        return float((signs @ sums >= least).mean())
    generator = np.random.Generator(np.random.SFC64(seed))
    flipped = generator.choice([-1.0, 1.0], size=(FLIPS, len(sums))) @ sums
    return float((1 + (flipped >= least).sum()) / (1 + FLIPS))
