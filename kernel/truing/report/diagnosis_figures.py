"""Figures of a diagnosis: measured against simulated, residuals over what they depend on, ranking, gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import ndtri

from truing.arrays import Matrix
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import UNKNOWN, Alternative, DiagnosisResult, ResultCurves, explanations_of
from truing.report.diagnosis_sizes import amount_text
from truing.report.diagnosis_words import explanation, spoken, wrong_results
from truing.units import from_si, unit_factor, unit_text

BEFORE, AFTER, QUIET, NEUTRAL = "#9d1c1c", "#0b4f8a", "#8b949e", "#3b434c"
MOST_POINTS = 1500
MOST_PLACES = 5
"""A covariate with fewer different values shows no course."""
FARTHEST = 60.0
"""A bar longer than this is cut: how far behind it is does not matter any more."""
NEAR = 6.0
"""So many score units (a Bayes factor of about 20) are no distance; what is nearer and excluded only says more."""
ENLARGED = 4.0
"""Residuals that became smaller by this factor are drawn on a scale of their own."""
MOST_BARS = 8
MOST_STEPS = 7
"""Steps between the ticks of a panel that takes half of the width: more only cost time, with fewer some have two."""


def main_covariates(diagnosis: DiagnosisResult) -> list[Covariate]:
    """Return what residuals are drawn over: the covariate of every cause and of the remainder, else the main one."""
    covariates = diagnosis.records.covariates
    found = [_followed(diagnosis, cause.effect) for cause in diagnosis.causes]
    if diagnosis.remainder is not None:
        found += [covariates[name] for name in diagnosis.remainder.depends_on[:2] if name in covariates]
    found = [item for item in found if item is not None] or [_main(diagnosis)]
    return list({item.name: item for item in found if item is not None}.values())[:3]


def _followed(diagnosis: DiagnosisResult, cause: str) -> Covariate | None:
    """Return the covariate that a cause follows: the condition it needs that takes most values, else the main one."""
    effect = diagnosis.setup.model.known_effects.get(cause)
    covariates = diagnosis.records.covariates
    needs = [covariates[need.name] for need in effect.needs if need.name in covariates] if effect is not None else []
    rich = [item for item in needs if _places(item) >= MOST_PLACES]
    return max(rich, key=_places) if rich else _main(diagnosis)


def _main(diagnosis: DiagnosisResult) -> Covariate | None:
    """Return the covariate to look over first: an angle, else another input, else the time, else the order."""
    rank = {"input": 1, "time": 2, "condition": 3, "other": 4, "order": 5}
    able = [covariate for covariate in diagnosis.records.covariates.values() if _places(covariate) >= MOST_PLACES]
    return min(able, key=lambda item: (not item.is_angle, rank[item.role]), default=None)


def _places(covariate: Covariate) -> int:
    return len(np.unique(covariate.values[np.isfinite(covariate.values)]))


def shown_curves(diagnosis: DiagnosisResult) -> list[ResultCurves]:
    """Return what is drawn: the results that are wrong, or all where nothing is."""
    wrong = wrong_results(diagnosis)
    return [curves for curves in diagnosis.curves if curves.result in wrong]


def has_changed(curves: ResultCurves) -> bool:
    """Tell whether the extension changes a result at all."""
    return not np.array_equal(curves.before, curves.after, equal_nan=True)


def _residuals(diagnosis: DiagnosisResult, curves: ResultCurves) -> tuple[str, Matrix, Matrix, float]:
    """Return the unit for differences of a result, and in it its residuals before and after and its noise floor."""
    unit = diagnosis.units.get(curves.result) or diagnosis.setup.print_unit(curves.result)
    floor = next((wrong.noise_floor.value for wrong in diagnosis.wrong if wrong.result == curves.result), 0.0)
    before, after = curves.measured - curves.before, curves.measured - curves.after
    return unit, before / unit_factor(unit), after / unit_factor(unit), floor / unit_factor(unit)


def thinned(rows: int) -> slice:
    """Return the rows that are drawn: all, or evenly every so many."""
    return slice(None, None, -(-rows // MOST_POINTS) if rows > MOST_POINTS else 1)


def thinning_words(diagnosis: DiagnosisResult, curves: ResultCurves) -> str:
    """Say what is left out of a figure with very many rows, and what its triangles are."""
    step = thinned(len(diagnosis.records)).step
    thinning = f" Every {step}th row is drawn." if step > 1 else ""
    is_cut = curves.result in diagnosis.records.sides
    return thinning + (" A triangle is a censored reading: the true value lies where it points." if is_cut else "")


def _mark_censored(
    diagnosis: DiagnosisResult, result: str, axes: Axes, *, places: Any, values: Any, colour: str
) -> None:
    """Draw a triangle around each censored reading that points to where the true value lies; (n,) as drawn."""
    if result not in diagnosis.records.sides:
        return
    sides = diagnosis.records.sides[result][thinned(len(diagnosis.records))]
    for side, marker in ((1, "^"), (-1, "v")):
        rows = sides == side
        axes.plot(places[rows], values[rows], marker, color=colour, markersize=7, fillstyle="none", markeredgewidth=0.7)


def axis_label(name: str, unit: str) -> str:
    """Write what an axis shows, with its unit."""
    words = spoken(name).replace("$", r"\$")
    return f"{words} [{unit_text(unit)}]" if unit else words


def over_covariate(diagnosis: DiagnosisResult, curves: ResultCurves, covariate: Covariate) -> Figure:
    """Draw the residuals of one result over a covariate, before and after, with the scatter as a band."""
    unit, before, after, floor = _residuals(diagnosis, curves)
    kept = thinned(len(before))
    place = from_si(covariate.values, covariate.unit)[kept]
    panels = [(before, BEFORE, "before"), (after, AFTER, "after")]
    if not has_changed(curves):
        panels = [(before, NEUTRAL, "")]
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    spans = [high - low for low, high in (_extent([values]) for values, *_ in panels)]
    enlarged = spans[0] > ENLARGED * spans[-1]
    if enlarged:
        panels[1] = (after, AFTER, "after, enlarged")
    places = figure.subplots(1, len(panels), sharey=not enlarged, squeeze=False)[0]
    for axes, (values, colour, when) in zip(places, panels, strict=True):
        axes.axhspan(-floor, floor, color="#e4e7ea", linewidth=0)
        axes.axhline(0.0, color=NEUTRAL, linewidth=0.7)
        axes.plot(place, values[kept], ".", color=colour, markersize=3.5)
        _mark_censored(diagnosis, curves.result, axes, places=place, values=values[kept], colour=colour)
        axes.locator_params(nbins=MOST_STEPS)
        axes.set_title(when, loc="left")
        axes.set_xlabel(axis_label(covariate.name, covariate.unit))
    places[0].set_ylabel(axis_label(curves.result, unit) + "\nmeasured − simulated")
    return figure


PIECES = 8
"""A covariate is cut into so many pieces of as many rows where its say in a curve is judged."""
AS_MUCH = 0.1
"""A covariate that says less than another one by no more than this share of the variance is taken where a cause
follows it."""


def telling_covariate(diagnosis: DiagnosisResult, curves: ResultCurves) -> Covariate | None:
    """Return the covariate over which what the model misses has the clearest course; None where there is none.

    It is measured by the share of the variance that lies between pieces of the covariate, corrected for their number.
    """
    missed = curves.after - curves.before if has_changed(curves) else curves.measured - curves.before
    able = [each for each in diagnosis.records.covariates.values() if _places(each) >= MOST_PLACES]
    able = [each for each in able if each.role != "order"] or able
    shares = {each.name: said_by(each.values, missed) for each in able}
    followed = {each.name for each in main_covariates(diagnosis)}
    return max(able, key=lambda each: shares[each.name] + AS_MUCH * (each.name in followed), default=None)


def said_by(places: Matrix, values: Matrix) -> float:
    """Return the share of the variance of values (n,) that lies between pieces of places (n,), adjusted; 0 to 1."""
    known = np.isfinite(places) & np.isfinite(values)
    places, values = places[known], values[known]
    if len(values) <= PIECES or np.ptp(values) == 0:
        return 0.0
    ends = np.unique(np.quantile(places, np.linspace(0, 1, PIECES + 1)[1:-1]))
    piece = np.searchsorted(ends, places, side="right")
    count = len(np.unique(piece))
    means = np.array([values[piece == number].mean() if (piece == number).any() else 0.0 for number in range(PIECES)])
    left = float(np.sum((values - means[piece]) ** 2)) / max(len(values) - count, 1)
    return max(0.0, 1.0 - left / float(np.var(values, ddof=1)))


MOST_COVARIATES = 5
CARRIES = 0.1
"""A covariate that says this share of the variance of what the model misses, or more, carries something."""


def carrying_covariates(diagnosis: DiagnosisResult, curves: ResultCurves) -> list[Covariate]:
    """Return what residuals of a result are drawn over: what the causes follow, and what carries something."""
    covariates = diagnosis.records.covariates
    missed = curves.measured - curves.before
    noticed = [
        name
        for wrong in diagnosis.wrong
        if wrong.result == curves.result
        for finding in wrong.findings
        for name in finding.covariate.split(" and ")
    ]
    able = [each for each in covariates.values() if _places(each) >= MOST_PLACES and each.role != "order"]
    saying = [each for each in able if each.name in noticed or said_by(each.values, missed) > CARRIES]
    return list({each.name: each for each in [*main_covariates(diagnosis), *saying]}.values())[:MOST_COVARIATES]


def what_is_left(diagnosis: DiagnosisResult, curves: ResultCurves) -> Figure:
    """Draw what is left of a result in the order in which it was read, and sorted beside normal scores."""
    unit, _, left, floor = _residuals(diagnosis, curves)
    kept = thinned(len(left))
    time = next((each for each in diagnosis.records.covariates.values() if each.role == "time"), None)
    in_order = np.arange(1.0, len(left) + 1) if time is None else from_si(time.values, time.unit)
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    course, normal = figure.subplots(1, 2, sharey=True)
    for axes in (course, normal):
        axes.axhspan(-floor, floor, color="#e4e7ea", linewidth=0)
        axes.axhline(0.0, color=NEUTRAL, linewidth=0.7)
        axes.locator_params(nbins=MOST_STEPS)
    course.plot(in_order[kept], left[kept], ".", color=AFTER, markersize=3.5)
    course.set_xlabel("row" if time is None else axis_label(time.name, time.unit))
    course.set_ylabel(f"measured − model [{unit_text(unit) or '1'}]")
    ordered = np.sort(left[np.isfinite(left)])
    scores = normal_scores(len(ordered))
    spread = float(np.std(ordered)) if len(ordered) else 0.0
    normal.plot(scores, np.mean(ordered) + spread * scores, color=NEUTRAL, linewidth=0.7)
    normal.plot(scores, ordered, ".", color=AFTER, markersize=3.5)
    normal.set_xlabel("normal score")
    return figure


def normal_scores(count: int) -> Matrix:
    """Return what sorted values (count,) of normal scatter of size one are to be expected at (Blom's scores)."""
    return np.asarray(ndtri((np.arange(1, count + 1) - 0.375) / (count + 0.25)))


MOST_PANELS, MOST_LINES = 8, 40


def course_of_record(diagnosis: DiagnosisResult) -> Figure:
    """Draw row by row what changed, and below it what was measured; a line parts two runs."""
    records = diagnosis.records
    moved = [(each.name, each.values, each.unit, QUIET) for each in records.moved]
    measured = [
        (name, records.measured[name], diagnosis.setup.print_unit(name), AFTER)
        for name in wrong_results(diagnosis)[: MOST_PANELS - 1]
    ]
    panels = [*moved[: MOST_PANELS - len(measured)], *measured]
    figure = Figure(figsize=(6.4, 0.5 + 0.75 * len(panels)), layout="constrained")
    rows, kept = np.arange(1, len(records) + 1), thinned(len(records))
    places = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, values, unit, colour) in zip(places, panels, strict=True):
        axes.plot(rows[kept], from_si(values, unit)[kept], ".", color=colour, markersize=2.5)
        for change in np.flatnonzero(np.diff(records.run_of))[:MOST_LINES]:
            axes.axvline(change + 1.5, color="#d5d8dc", linewidth=0.7, zorder=0)
        axes.set_ylabel(axis_label(name, unit).replace(" [", "\n["), rotation=0, ha="right", va="center", fontsize=7.5)
        axes.locator_params(axis="y", nbins=3)
    places[-1].set_xlabel("row")
    return figure


PAGE_WIDTH, FLAT = 178.0, 85.0
"""Of what is printed on a page, mm, and below which height two panels stand side by side."""


def _two_panels(high: float) -> tuple[Figure, Axes, Axes]:
    """Return a figure as wide as a page and so high on paper, mm, with two panels: side by side where it is flat."""
    figure = Figure(figsize=(6.4, 6.4 * high / PAGE_WIDTH), layout="constrained")
    if high < FLAT:
        first, second = figure.subplots(1, 2, width_ratios=(2, 3))
    else:
        first, second = figure.subplots(2, sharex=True, height_ratios=(1, 2))
    return figure, first, second


def convincing(diagnosis: DiagnosisResult, curves: ResultCurves, covariate: Covariate, high: float = 117.0) -> Figure:
    """Draw measured, model before and model after over a covariate; below or beside it what each of them misses.

    ``high`` is its height on paper, mm, where it is as wide as the page.
    """
    unit, *missed, floor = _residuals(diagnosis, curves)
    kept = thinned(len(curves.measured))
    place = from_si(covariate.values, covariate.unit)[kept]
    shown_unit = diagnosis.setup.print_unit(curves.result)
    series = [(curves.before, missed[0], BEFORE, "the model as it is", "missed by the model as it is")]
    if has_changed(curves):
        series.append((curves.after, missed[1], AFTER, "with the cause", "missed with the cause"))
    figure, upper, lower = _two_panels(high)
    upper.plot(place, from_si(curves.measured, shown_unit)[kept], "o", color=QUIET, markersize=4.5,
               fillstyle="none", label="measured")  # fmt: skip
    lower.axhspan(-floor, floor, color="#e4e7ea", linewidth=0, label="scatter")
    lower.axhline(0.0, color=NEUTRAL, linewidth=0.7)
    order = np.argsort(place, kind="stable")
    style = "-" if len(np.unique(place[np.isfinite(place)])) == len(place) else "."
    if has_changed(curves):
        added = (missed[0] - missed[1])[kept][order]
        mark = "-" if style == "-" else "x"
        lower.plot(place[order], added, mark, color=NEUTRAL, markersize=4, markeredgewidth=0.6, linewidth=1.0,
                   label="what the cause adds")  # fmt: skip
    for model, left, colour, words, missing in series:
        values = from_si(model, shown_unit)[kept]
        upper.plot(place[order], values[order], style, color=colour, markersize=3.5, linewidth=1.2, label=words)
        lower.plot(place, left[kept], ".", color=colour, markersize=3.5, label=None if high < FLAT else missing)
    lower.legend(loc="best", fontsize=7.5)
    _mark_censored(diagnosis, curves.result, lower, places=place, values=series[-1][1][kept], colour=series[-1][2])
    upper.set_ylabel(axis_label(curves.result, shown_unit))
    lower.set_ylabel(f"measured − model\n[{unit_text(unit)}]" if unit else "measured − model")
    for axes in (upper, lower) if high < FLAT else (lower,):
        axes.set_xlabel(axis_label(covariate.name, covariate.unit))
        axes.locator_params(nbins=MOST_STEPS if axes is lower else 4)
    upper.legend(loc="best", fontsize=7.5)
    return figure


def against_simulated(diagnosis: DiagnosisResult, curves: ResultCurves) -> Figure:
    """Draw measured against simulated, and beside it their difference, where the error can be seen."""
    difference_unit, wrong_before, wrong_after, _ = _residuals(diagnosis, curves)
    unit = diagnosis.setup.print_unit(curves.result)
    kept = thinned(len(curves.measured))
    measured, before, after = (from_si(one, unit)[kept] for one in (curves.measured, curves.before, curves.after))
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    circle: Any = {"marker": "o", "linestyle": "", "markersize": 4.5, "fillstyle": "none", "markeredgewidth": 0.6}
    point: Any = {"marker": ".", "linestyle": "", "markersize": 3.5}
    right.axhline(0.0, color=NEUTRAL, linewidth=0.7)
    for axes, one, other in ((left, measured, measured), (right, wrong_before[kept], wrong_after[kept])):
        if has_changed(curves):
            axes.plot(before, one, color=BEFORE, label="before", **circle)
        axes.plot(after, other, color=AFTER if has_changed(curves) else NEUTRAL, label="after", **point)
        _mark_censored(diagnosis, curves.result, axes, places=after, values=other, colour=AFTER)
    low, high = _extent([measured, before, after])
    left.plot([low, high], [low, high], color=NEUTRAL, linewidth=0.7)
    left.set_ylabel(f"measured {axis_label(curves.result, unit)}")
    right.set_ylabel(f"measured − simulated [{unit_text(difference_unit) or '1'}]")
    if has_changed(curves):
        right.legend(loc="best", frameon=True, framealpha=0.8, edgecolor="none", handletextpad=0.2)
    for axes in (left, right):
        axes.locator_params(nbins=MOST_STEPS)
        axes.set_xlabel(f"simulated {axis_label(curves.result, unit)}")
    return figure


def _extent(values: Sequence[Matrix]) -> tuple[float, float]:
    joined = np.concatenate([one[np.isfinite(one)] for one in values])
    return (float(joined.min()), float(joined.max())) if joined.size else (0.0, 1.0)


def shown_ranking(diagnosis: DiagnosisResult) -> list[Alternative]:
    """Return the explanations that are listed: the best ones, one of each that reads alike."""
    unique: dict[str, Alternative] = {}
    for alternative in diagnosis.ranking:
        unique.setdefault(explanation(alternative), alternative)
    return list(unique.values())[:MOST_BARS]


def is_open(alternative: Alternative, diagnosis: DiagnosisResult) -> bool:
    """Tell whether this data does not exclude an explanation: the best one, a rival, or one that draws its curve."""
    over = f"{UNKNOWN}:{','.join(alternative.depends_on)}"
    names = frozenset(over if name == UNKNOWN else name for name in alternative.causes)
    explanations = {frozenset(each) for each in explanations_of(diagnosis)}
    return alternative == diagnosis.ranking[0] or names in explanations


def ranking_bars(diagnosis: DiagnosisResult) -> Figure:
    """Draw how far every explanation is behind the best, in blue those that are not excluded."""
    items = shown_ranking(diagnosis)
    figure = Figure(figsize=(6.4, 0.7 + 0.3 * len(items)), layout="constrained")
    axes = figure.subplots()
    widest = min(max(*(item.behind for item in items), 1.0), FARTHEST)
    for index, item in enumerate(items):
        length, beyond = min(item.behind, widest), "›" if item.behind > widest else ""
        colour = AFTER if is_open(item, diagnosis) else QUIET
        axes.barh(index, max(length, 0.003 * widest), height=0.62, color=colour)
        text = f"{item.behind:.1f} {beyond}"
        axes.text(length + 0.01 * widest, index, text, va="center", fontsize=8, color=NEUTRAL)
    axes.set_yticks(range(len(items)), [shortened(explanation(item)) for item in items])
    axes.invert_yaxis()
    axes.set_xlim(0, 1.13 * widest)
    axes.set_xlabel("score units behind the best explanation")
    axes.tick_params(axis="y", length=0)
    return figure


def shortened(text: str, most: int = 46) -> str:
    """Cut words for a label inside of a figure."""
    words = text.replace("something unregistered", "unregistered").replace("$", r"\$")
    return words if len(words) <= most else words[: most - 1] + "…"


def gain_bars(diagnosis: DiagnosisResult) -> Figure:
    """Draw the error on rows that were not fitted, before and after, each as a share of what it was before."""
    gains = diagnosis.gain
    figure = Figure(figsize=(6.4, 0.7 + 0.75 * len(gains)), layout="constrained")
    axes = figure.subplots()
    for index, item in enumerate(gains):
        bars = {"before": item.rmse_before, "after": item.rmse_after, "scatter of the readings": item.noise_floor}
        for offset, ((name, value), colour) in enumerate(zip(bars.items(), (BEFORE, AFTER, QUIET), strict=True)):
            share = 100 * value.value / item.rmse_before.value if item.rmse_before.value else 0.0
            height = index + 0.26 * (offset - 1)
            axes.barh(height, share, height=0.24, color=colour, label=name if not index else None)
            axes.text(share + 1, height, amount_text(value), va="center", fontsize=8, color=NEUTRAL)
    axes.set_yticks(range(len(gains)), [shortened(spoken(item.result), 30) for item in gains])
    axes.invert_yaxis()
    axes.set_xlim(0, 1.16 * max(axes.get_xlim()[1], 100.0))
    axes.set_xlabel("root mean square error on rows that were not fitted, % of that before")
    axes.tick_params(axis="y", length=0)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, borderaxespad=0.2, handlelength=1.2)
    return figure
