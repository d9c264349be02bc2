"""Where the explanations that a record leaves open part: on the record, and at the readings that are proposed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from truing.arrays import Matrix
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import DiagnosisResult, ResultCurves
from truing.report.diagnosis_figures import (
    AFTER,
    BEFORE,
    NEUTRAL,
    axis_label,
    shortened,
    shown_curves,
    telling_covariate,
    thinned,
)
from truing.report.diagnosis_words import together
from truing.units import from_si, unit_factor

PAIR_COLOURS = (AFTER, BEFORE, "#5b7f3b", "#8a6d1d")
DIAMONDS = (4.0, 7.0, 10.0, 13.0)
"""Their sizes differ, so that one behind another is seen."""
MOST_PAIRS = len(PAIR_COLOURS)


@dataclass(frozen=True)
class Parting:
    """Where explanations part: in which result, over which covariate, and each pair's distances, SI.

    ``on_record`` has them on the rows of the record, (n,), ``ahead`` at the proposed readings, (m,), None where none
    are proposed.
    """

    result: str
    covariate: Covariate
    pairs: tuple[tuple[str, str], ...]
    on_record: tuple[Matrix | None, ...]
    ahead: tuple[Matrix | None, ...]
    proposed: Matrix | None


def parting_of(diagnosis: DiagnosisResult) -> Parting | None:
    """Return where the explanations that are left part; None where there is one, or nothing to draw them over."""
    experiment = diagnosis.experiment
    pairs = _pairs_of(diagnosis)
    if not pairs:
        return None
    covariate, proposed = _parting_covariate(diagnosis)
    if covariate is None:
        return None
    curves = {each.result: each for each in diagnosis.curves}
    names = experiment.results if experiment is not None and experiment.gaps else tuple(curves)
    ahead = dict(zip(experiment.parted, experiment.gaps, strict=True)) if experiment else {}
    floors = {wrong.result: wrong.noise_floor.value or 1.0 for wrong in diagnosis.wrong}
    on_record = {name: tuple(_apart(diagnosis, curves[name], pair) for pair in pairs) for name in names}
    at = {name: tuple(ahead[pair][:, index] if pair in ahead else None for pair in pairs)
          for index, name in enumerate(names)}  # fmt: skip

    def size(name: str) -> float:
        known = [each for each in (*on_record[name], *at[name]) if each is not None]
        return max((float(np.nanmax(np.abs(each))) for each in known), default=0.0) / floors.get(name, 1.0)

    result = max(names, key=size)
    if all(each is None for each in (*on_record[result], *at[result])):
        return None
    return Parting(result, covariate, pairs, on_record[result], at[result], proposed)


def _pairs_of(diagnosis: DiagnosisResult) -> tuple[tuple[str, str], ...]:
    """Return the pairs of explanations that are drawn: those an experiment parts, else the best beside each rival."""
    experiment = diagnosis.experiment
    if experiment is not None and experiment.gaps:
        once: dict[frozenset[str], tuple[str, str]] = {}
        for pair in experiment.parted:
            once.setdefault(frozenset(pair), pair)
        return tuple(once.values())[:MOST_PAIRS]
    best = " + ".join(cause.effect for cause in diagnosis.causes)
    rivals = [" + ".join(alternative.causes) for alternative in diagnosis.alternatives]
    return tuple((best, rival) for rival in rivals if best)[:MOST_PAIRS]


def _parting_covariate(diagnosis: DiagnosisResult) -> tuple[Covariate | None, Matrix | None]:
    """Return what the distances are drawn over, and its values at the proposed readings: what those vary most."""
    covariates, experiment = diagnosis.records.covariates, diagnosis.experiment
    if experiment is None:
        shown = next(iter(shown_curves(diagnosis)), None)
        return (None if shown is None else telling_covariate(diagnosis, shown)), None
    varied = [course.name for course in experiment.courses if course.way != "held" and course.name in covariates]
    held = [course.name for course in experiment.courses if course.way == "held" and course.name in covariates]
    outside = sorted(held, key=lambda name: -_beyond(covariates[name], experiment.settings[name]))
    for name in (*[each for each in varied if each != "time"], *outside, *varied):
        return covariates[name], experiment.settings[name]
    return None, None


def _beyond(covariate: Covariate, proposed: Matrix) -> float:
    """Return how far proposed values lie outside of what was measured, as a share of its range."""
    low, high = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
    return float(np.max(np.maximum(low - proposed, proposed - high))) / max(high - low, 1e-300)


def _apart(diagnosis: DiagnosisResult, curves: ResultCurves, pair: tuple[str, str]) -> Matrix | None:
    """Return by how much the first of two explanations shows more than the second on the record; None if unknown."""
    known = {" + ".join(cause.effect for cause in diagnosis.causes): curves.after}
    for alternative, rival in zip(diagnosis.alternatives, curves.rivals, strict=False):
        known.setdefault(" + ".join(alternative.causes), rival)
    for cause in diagnosis.causes:  # another name of the same curve
        for other in cause.same_as:
            renamed = [other if each.effect == cause.effect else each.effect for each in diagnosis.causes]
            known.setdefault(" + ".join(renamed), curves.after)
    first, second = (known.get(name) for name in pair)
    return None if first is None or second is None else first - second


def rivals_apart(diagnosis: DiagnosisResult, parting: Parting) -> Figure:
    """Draw how far explanations are apart, on the record and at the proposed readings."""
    unit = diagnosis.units.get(parting.result) or diagnosis.setup.print_unit(parting.result)
    factor, covariate = unit_factor(unit), parting.covariate
    floor = next((wrong.noise_floor.value for wrong in diagnosis.wrong if wrong.result == parting.result), 0.0) / factor
    kept = thinned(len(diagnosis.records))
    place = from_si(covariate.values, covariate.unit)[kept]
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.subplots()
    axes.axhspan(-floor, floor, color="#e4e7ea", linewidth=0)
    axes.axhline(0.0, color=NEUTRAL, linewidth=0.7)
    rows = zip(parting.pairs, parting.on_record, parting.ahead, PAIR_COLOURS, DIAMONDS, strict=False)
    for (one, other), record, ahead, colour, size in rows:
        label = f"{shortened(together([one]), 30)} above {shortened(together([other]), 30)}"
        if record is not None:
            axes.plot(place, record[kept] / factor, ".", color=colour, markersize=3.5, label=label)
        if ahead is not None and parting.proposed is not None:
            at = from_si(parting.proposed, covariate.unit)
            axes.plot(at, ahead / factor, "D", color=colour, markersize=size, fillstyle="none",
                      label=label if record is None else None)  # fmt: skip
    axes.update_datalim(np.column_stack([place, np.zeros(len(place))])[np.isfinite(place)])
    axes.autoscale_view()
    axes.set_xlabel(axis_label(covariate.name, covariate.unit))
    axes.set_ylabel(f"difference of {axis_label(parting.result, unit)}")
    axes.legend(loc="best", fontsize=7.5)
    return figure
