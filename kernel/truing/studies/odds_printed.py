"""How the outcome of a reliability study is written: results.json and the sheet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.studies.demands import Demand, as_number, worst
from truing.studies.reading import printed, printed_step, spoken

if TYPE_CHECKING:
    from truing.studies.reliability import Curve, Odds


def odds_json(odds: Odds) -> dict[str, Any]:
    """Return what results.json holds: probability, interval and method by check."""
    entries = {demand.name: _entry(odds, demand) for demand in odds.demands}
    if odds.curve is not None:
        for name, entry in entries.items():
            entry["curve"] = _curve(odds.curve, name)
    return entries


def _entry(odds: Odds, demand: Demand) -> dict[str, Any]:
    name, unit = demand.name, odds.units[demand.result]
    interval = [as_number(end) for end in odds.interval[name]] if odds.sampled else None
    entry: dict[str, Any] = {
        "probability": as_number(odds.probability[name]),
        "interval95": interval,
        "standard_error": as_number(odds.standard_error[name]) if odds.sampled else None,
        "draws": odds.draws,
        "method": "monte_carlo" if odds.sampled else "first_order",
        "goal": demand.goal,
        "first_order": as_number(odds.analytic[name]),
        "first_order_sd": printed_step(odds.first_sd[name], unit),
        "result": demand.result,
        "unit": unit,
    }
    if name in odds.form:
        entry["form"] = odds.form[name].as_json()
    if odds.tally is not None:
        moments = odds.moments[demand.result]
        entry["failed"] = odds.tally.failed
        entry["mean"] = printed(moments.mean, unit)
        entry["sd"] = printed_step(moments.sd, unit)
        entry["smallest"], entry["largest"] = printed(moments.smallest, unit), printed(moments.largest, unit)
    return entry


def _curve(curve: Curve, name: str) -> dict[str, Any]:
    return {
        "over": curve.over,
        "unit": curve.unit,
        "at": printed(curve.axis, curve.unit),
        "probability": as_number(curve.probability[name]) if name in curve.probability else None,
        "at_least": as_number(curve.at_least[name]) if name in curve.at_least else None,
        "first_order": as_number(curve.analytic[name]) if name in curve.analytic else None,
        "failed": [{"row": row, "reason": reason} for row, reason in curve.failed],
    }


def odds_blocks(odds: Odds) -> Sequence[Block]:
    """Return the tables of the sheet, and the curve where there is one."""
    blocks: list[Block] = [_chances(odds)]
    if odds.sampled:
        blocks.append(_spreads(odds))
    for name, found in odds.form.items():
        if found.probability is None:
            blocks.append(Words(f"FORM of the {spoken(name)}: {found.status}."))
    if odds.curve is not None and odds.curve.probability:
        blocks.append(_drawn(odds, odds.curve))
    return blocks


def _chances(odds: Odds) -> Table:
    rows: list[list[Any]] = []
    for demand in odds.demands:
        name = demand.name
        found = odds.form.get(name)
        interval = [100 * worst(end) for end in odds.interval[name]] if odds.sampled else [None, None]
        sampled = 100 * worst(odds.probability[name]) if odds.sampled else None
        tangent = None if found is None or found.probability is None else 100 * found.probability
        goal = None if demand.goal is None else 100 * demand.goal
        rows.append([name, goal, sampled, *interval, 100 * worst(odds.analytic[name]), tangent])
    columns = ("limit kept", "goal", "Monte Carlo", "95 % from", "to", "first order", "FORM")
    return Table("Probability", columns, rows, ("", *("%" for _ in columns[1:])), _note(odds))


def _note(odds: Odds) -> str:
    if not odds.sampled:
        return "First order: the model as a straight line about its nominal point."
    words = f"{odds.draws} machines drawn on the exact model; the checks take the Monte Carlo unless a later "
    words += "study, as an allocation, decides them with other tolerances."
    if odds.failed:
        words += f" {odds.failed} of them have no answer and count as missed."
    if any(getattr(value, "ndim", 0) for value in odds.probability.values()):
        words += " Where a result runs along an axis, the worst place is shown."
    return words


def _spreads(odds: Odds) -> Table:
    """Show mean and spread of every required result that is one number, each in its own unit.

    Mean and extremes are told from the result without scatter, where their digits matter.
    """
    from truing.units import difference_unit, unit_text

    rows: list[list[Any]] = []
    for result, unit in odds.units.items():
        moments = odds.moments[result]
        if getattr(moments.mean, "ndim", 0) or not moments.count:
            continue
        first = next(odds.first_sd[demand.name] for demand in odds.demands if demand.result == result)
        mean, *ends = (
            printed_step(value - odds.nominal[result], unit)
            for value in (moments.mean, moments.smallest, moments.largest)
        )
        spread = [printed_step(moments.sd, unit), printed_step(first, unit)]
        rows.append([result, unit_text(difference_unit(unit)), mean, *spread, *ends])
    columns = ("result", "unit", "mean", "standard deviation", "first order", "smallest", "largest")
    note = "Mean, smallest and largest are differences from the result without scatter."
    return Table("Scatter of the results", columns, rows, note=note)


def _drawn(odds: Odds, curve: Curve) -> Drawing:
    import numpy as np

    from truing.studies.drawings import labelled, lines
    from truing.units import from_si, unit_text

    x = [float(value) for value in from_si(curve.axis, curve.unit)]
    series = {
        name: [float(value) for value in np.reshape(values, (len(x), -1)).min(axis=1)]
        for name, values in curve.probability.items()
    }
    goals = {demand.name: demand.goal for demand in odds.demands if demand.goal is not None}
    labels = (labelled(curve.over, unit_text(curve.unit)), "probability")
    return Drawing(f"Probability along the {spoken(curve.over)}", lines(x, series, labels, goals))
