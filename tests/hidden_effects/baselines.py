"""Three common ways to look for a cause, on the same cases: what the diagnosis is held against.

All get what a diagnosis must find out: the generator's own columns, the tolerances as prior and the true standard
deviation of the noise, which they take as independent and normal.

- ``stepwise``: forward and backward selection by BIC.
- ``lasso``: the LASSO over all columns, its penalty chosen by BIC.
- ``process``: a Gaussian process for the discrepancy, one length scale per covariate, projected on the registry; one
  effect, or two, that draw nine tenths of it are named, else it is unknown and depends on what has short scales.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from time import perf_counter
from typing import Any

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from hidden_effects.candidates import stacked
from hidden_effects.cases import Case
from hidden_effects.outcome import names_of
from hidden_effects.press_machine import Array, shown
from hidden_effects.record import Variant
from hidden_effects.scoring import KINDS, Metric, Outcome, are_both_visible, of, rate
from hidden_effects.shapes import COVARIATES, scaled

DRAWN = 0.9
MORE = 0.03
STRUCTURE = 12.0  # twice the gain of log likelihood that a process must bring
SHORT = 3.0  # length scale, the covariate spanning two


@dataclass(frozen=True)
class Said:
    """What a method said: the effects it named, and what a shape without a name depends on."""

    effects: tuple[str, ...] = ()
    depends_on: tuple[str, ...] = ()


@dataclass(frozen=True)
class View:
    """A case as these methods see it: rows in which readings of this design scatter like independent noise."""

    case: Case
    target: Array
    columns: Array
    variants: tuple[Variant, ...]

    def effects(self, variants: Sequence[Variant]) -> tuple[str, ...]:
        """The effects of some variants, each once."""
        return tuple(dict.fromkeys(self.case.record.candidates[one.owner].effect for one in variants))

    def left(self, variants: Sequence[Variant]) -> float:
        """Sum of squares that is left with these variants fitted."""
        places = [column for one in variants for column in one.columns]
        if not places:
            return float(self.target @ self.target)
        found = np.linalg.lstsq(self.columns[:, places], self.target, rcond=1e-10)[0]
        rest = self.target - self.columns[:, places] @ found
        return float(rest @ rest)


def seen(case: Case, values: Array | None = None) -> View:
    """Take the tolerances out, noise as independent; ``values`` in place of the residual of the nominal machine."""
    record = case.record
    if values is None:
        values = stacked(case.readings, case.results) - stacked(shown(record.rows, {}, {}), case.results)
    sd = np.repeat([record.noise.sd[result] for result in case.results], len(record.rows))
    tolerances = record.tolerances / sd[:, None]
    factor = cholesky(np.eye(len(sd)) + tolerances @ tolerances.T, lower=True)
    white = solve_triangular(factor, record.curves.matrix / sd[:, None], lower=True)
    lengths = np.linalg.norm(white, axis=0)
    made = white / np.where(lengths > 1e-9, lengths, 1.0)
    return View(case, np.asarray(solve_triangular(factor, values / sd, lower=True)), made, record.curves.variants)


def stepwise(case: Case) -> Said:
    """Add what lowers BIC most, drop what no longer pays, until nothing changes."""
    view, chosen = seen(case), list[Variant]()
    count = len(view.target)

    def score(variants: Sequence[Variant]) -> float:
        shapes = sum(len(case.record.candidates[one.owner].shapes or {}) for one in variants)
        size = sum(len(one.columns) for one in variants) + shapes
        return count * float(np.log(view.left(variants) / count)) + size * float(np.log(count))

    best = score(chosen)
    while len(chosen) < 6:
        taken = {one.owner for one in chosen}
        tried = [[*chosen, one] for one in view.variants if one.owner not in taken]
        tried += [[other for other in chosen if other is not one] for one in chosen]
        scores = [score(each) for each in tried]
        if min(scores) >= best - 1e-9:
            break
        best, chosen = min(scores), tried[int(np.argmin(scores))]
    return Said(view.effects(chosen))


def lasso(case: Case) -> Said:
    """The effects whose columns have a coefficient."""
    from sklearn.linear_model import LassoLarsIC

    view = seen(case)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = LassoLarsIC(criterion="bic", fit_intercept=False, noise_variance=1.0, max_iter=60)
        found.fit(view.columns, view.target)
    is_in = np.abs(found.coef_) > 1e-3 * np.abs(found.coef_).max(initial=1e-12)
    return Said(view.effects([one for one in view.variants if is_in[list(one.columns)].any()]))


def process(case: Case) -> Said:
    """Fit a process to every result's discrepancy and see who draws it."""
    smooth, relevant, gain = [], set[str](), 0.0
    residual = _calibrated_residual(case)
    for part in np.split(residual, len(case.results)):
        mean, scales, better = _process_of(case, part)
        smooth.append(mean)
        gain = max(gain, better)
        if better > STRUCTURE:
            relevant |= {name for name, scale in zip(COVARIATES, scales, strict=True) if scale < SHORT}
    if gain <= STRUCTURE:
        return Said()
    sd = np.repeat([case.record.noise.sd[result] for result in case.results], len(case.record.rows))
    return _drawn(seen(case, np.concatenate(smooth) * sd), tuple(sorted(relevant)))


def _calibrated_residual(case: Case) -> Array:
    """Residual over the noise with the tolerances fitted, each with its prior."""
    record = case.record
    sd = np.repeat([record.noise.sd[result] for result in case.results], len(record.rows))
    values = (stacked(case.readings, case.results) - stacked(shown(record.rows, {}, {}), case.results)) / sd
    design = record.tolerances / sd[:, None]
    found = np.linalg.solve(design.T @ design + np.eye(design.shape[1]), design.T @ values)
    return np.asarray(values - design @ found)


def _process_of(case: Case, values: Array) -> tuple[Array, Array, float]:
    """Mean of the process, its length scales, and twice its gain of log likelihood over noise alone."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    rows = np.column_stack([scaled(getattr(case.record.rows, name)) for name in COVARIATES])
    kernel = ConstantKernel(1.0, (1e-3, 1e3)) * RBF(np.full(len(COVARIATES), 2.0), (0.1, 1e3)) + WhiteKernel(1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = GaussianProcessRegressor(kernel, normalize_y=False, random_state=0).fit(rows, values)
    alone = -0.5 * len(values) * (np.log(2 * np.pi * np.mean(values**2)) + 1)
    scales = np.asarray(found.kernel_.k1.k2.length_scale)
    gain = 2 * (found.log_marginal_likelihood_value_ - alone)
    return np.asarray(found.predict(rows)), scales, float(gain)


def _drawn(view: View, relevant: tuple[str, ...]) -> Said:
    """The effect, or the two, that draw most of a discrepancy; else what it depends on."""
    total = view.left([])
    shares = np.array([1 - view.left([one]) / total for one in view.variants])
    first = view.variants[int(np.argmax(shares))]
    ranked = [view.variants[at] for at in np.argsort(-shares).tolist()]
    best_of = {one.owner: one for one in reversed(ranked)}
    pairs = list(combinations(best_of.values(), 2))
    pair = max(pairs, key=lambda both: -view.left(both))
    together = 1 - view.left(pair) / total
    if shares.max() > DRAWN and together - shares.max() < MORE:
        return Said(view.effects([first]))
    return Said(view.effects(pair)) if together > DRAWN else Said((), relevant)


METHODS: Mapping[str, Callable[[Case], Said]] = {"stepwise": stepwise, "lasso": lasso, "process": process}


def all_baselines(case: Case) -> dict[str, dict[str, Any]]:
    """What every method said of a case, and whether it is right."""
    found = {}
    for name, method in METHODS.items():
        start = perf_counter()
        said = method(case)
        found[name] = {
            "effects": list(said.effects), "depends_on": list(said.depends_on),
            "exact": is_right(case, said), "seconds": perf_counter() - start,
        }  # fmt: skip
    return found


def is_right(case: Case, said: Said) -> bool:
    """Whether what was said is the truth, any name of a curve being as good as another."""
    wanted = [names_of(case, name) for name in case.truth]
    effects = list(said.effects)
    also = case.shape.also if case.shape else ""
    if also in effects:
        effects.remove(also)
    elif not set(case.shape.depends_on if case.shape else ()) <= set(said.depends_on):
        return False
    if said.depends_on and case.shape is None:
        return False
    return len(effects) == len(wanted) and all(any(one in names for one in effects) for names in wanted)


def _metrics(outcomes: Sequence[Outcome], method: str) -> list[Metric]:
    """The lines of the table that such a method can answer."""

    def right(chosen: Sequence[Outcome]) -> list[bool]:
        return [one["baselines"][method]["exact"] for one in chosen]

    nothing, single, double = of(outcomes, "none"), of(outcomes, "single"), of(outcomes, "double")
    by_kind = {kind: [not hit for hit in right([one for one in nothing if one["noise"] == kind])] for kind in KINDS}
    worst = max(KINDS, key=lambda kind: np.mean(by_kind[kind]) if by_kind[kind] else -1.0)
    unknown = [one for one in of(outcomes, "unknown") if one["separable"]]
    seconds = [one["baselines"][method]["seconds"] for one in outcomes]
    say = partial(rate, required="", wanted="")
    return [
        say("false alarms, all", [not hit for hit in right(nothing)]),
        say(f"false alarms, worst noise ({worst})", by_kind[worst]),
        say("single, separable: exact name", right([one for one in single if one["separable"]])),
        say("single, visible: exact name", right([one for one in single if one["visible"]])),
        say("double, separable: exact", right([one for one in double if one["separable"]])),
        say("double, both halves visible: exact", right([one for one in double if are_both_visible(one)])),
        say("unknown, separable: unknown, right covariates", right(unknown)),
        say("registered beside unregistered, both right", right(of(outcomes, "beside"))),
        Metric("seconds, median", float(np.median(seconds)), float("nan"), float("nan"), len(seconds), unit="s"),
    ]


def baseline_table(outcomes: Sequence[Outcome]) -> str:
    """The tables of all methods as text."""
    chosen = [one for one in outcomes if "baselines" in one]
    texts = []
    for method in METHODS:
        lines = [metric.line() for metric in _metrics(chosen, method)]
        texts.append("\n".join([f"\nbaseline {method}: {len(chosen)} cases", *lines]))
    return "\n".join(texts)
