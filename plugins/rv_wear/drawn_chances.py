"""What scatter does: backlash of drawn machines, reliability over the hours, sensitivity indices, costs."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rv_wear.bill import Bill
from rv_wear.costs import price
from rv_wear.drawn_look import ARCMIN, BLUE, GREY, HOUR, INK, MICRO, ORANGE, WIDTH, one_panel, over_hours, signed
from rv_wear.new_machines import Newborn
from rv_wear.tolerances import PRICED
from truing import Odds

Values = NDArray[np.float64]
PRINTED_INDICES = {
    1: -0.037, 2: 0.025, 3: 0.025, 4: 1.56, 5: -1.0, 6: 1.0, 7: -1.56, 8: 0.78, 9: 0.39, 10: 1.20, 11: -0.60,
    12: 1.56, 13: -1.0, 14: 0.00016, 15: 1.56, 16: 1.06,
}  # fmt: skip
"""Table 2 of the paper."""
FACTOR_WORDS = {
    1: "base tangent length", 2: "runout of the involute gears", 3: "centre distance", 4: "equidistant modification",
    5: "shift modification", 6: "radius of the pin circle", 7: "radius of the pins", 8: "fit of the pins",
    9: "runout of the cycloid disc", 10: "position of the pin holes", 11: "pitch of the cycloid disc",
    12: "equidistant modification as ground", 13: "shift modification as ground", 14: "throw of the crank",
    15: "wear", 16: "crank bearings",
}  # fmt: skip
PRINTED_RELIABILITY = (6000.0, 0.887)


def machines_figure(born: "Newborn") -> "Figure":
    """Draw the backlash of every machine, new, and the histograms of new and used ones with the limit."""
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(5, 2))
    hours = f"after {float(born.inputs.working_time) / HOUR:.4g} h"
    known = [values[np.isfinite(values)] / ARCMIN for values in (born.new, born.used)]
    left.plot(np.arange(1, len(known[0]) + 1), known[0], ".", markersize=1.8, color=BLUE)
    edges = _edges(np.concatenate(known))
    for values, colour, words in zip(known, (BLUE, ORANGE), ("new", hours), strict=True):
        right.hist(values, bins=edges, orientation="horizontal", color=colour, alpha=0.75, label=words)
    limit = born.limit / ARCMIN
    for panel in (left, right):
        panel.axhline(limit, color=INK, linestyle="--", linewidth=0.9)
    left.text(0.02, limit, f"permitted {limit:g}′", va="bottom", fontsize=8, transform=left.get_yaxis_transform())
    left.set_xlabel("machine drawn")
    left.set_ylabel("backlash, arc minutes")
    left.set_xlim(0, len(born.new) + 1)
    left.locator_params(axis="x", nbins=4, prune="upper")
    right.set_xlabel("number of machines")
    right.legend(loc="lower right")
    left.grid(axis="y", alpha=0.4)
    right.grid(axis="y", alpha=0.4)
    left.set_axisbelow(True)
    return figure


def _edges(values: Values) -> Values:
    """Edges of some forty classes over all values; a single value gets one class of its own."""
    if not len(values):
        return np.array([0.0, 1.0])
    low, high = float(values.min()), float(values.max())
    room = max(0.02 * (high - low), 1e-4)
    return np.linspace(low - room, high + room, 45)


def reliability_figure(odds: "Odds", optimised: Mapping[str, tuple[Values, Values]] | None = None) -> "Figure":
    """Draw the reliability over the working time, with its interval, the goal, and the value that the paper prints.

    *optimised* names further curves, each hours and probabilities.
    """
    figure, panel = one_panel(3.2)
    curve = odds.curve
    assert curve is not None  # drawn only where there is one
    hours = curve.axis / HOUR
    chance = 100 * curve.probability["backlash"]
    panel.plot(hours, chance, color=BLUE, marker="o", markersize=3, label="counted among the machines drawn")
    normal = 100 * np.asarray(curve.analytic["backlash"])
    panel.plot(hours, normal, color=GREY, linestyle="--", linewidth=1.0, label="normal distribution")
    lowest = [float(np.nanmin(chance))]
    looks = ((ORANGE, "-"), ("#2f6b4f", "-."), (INK, ":"))
    for (name, (at, shares)), (colour, dashes) in zip((optimised or {}).items(), looks, strict=False):
        panel.plot(at / HOUR, 100 * shares, color=colour, linestyle=dashes, label=name)
        lowest.append(float(100 * np.nanmin(shares)))
    goal = 100 * float(odds.inputs.required_reliability)
    panel.axhline(goal, color=INK, linewidth=0.8, linestyle=(0, (5, 3)))
    panel.text(0.01, goal, f"required {goal:g} %", va="bottom", fontsize=8, transform=panel.get_yaxis_transform())
    printed_at, share = PRINTED_RELIABILITY
    panel.plot(
        printed_at, 100 * share, "D", markersize=8, fillstyle="none", color=ORANGE, label="the paper, 88.7 % at 6000 h"
    )
    over_hours(panel, hours, "reliability, %")
    panel.set_xlim(0, 1.02 * max(float(hours.max()), printed_at))
    bottom: float = min([*lowest, goal, 100 * share])
    panel.set_ylim(max(-2.0, bottom - 0.08 * (100 - bottom) - 0.5), 100 + 0.06 * (100 - bottom) + 0.2)
    panel.legend(loc="lower left")
    return figure


def indices_figure(indices: Mapping[int, float]) -> "Figure":
    """Draw the sensitivity indices by their number as bars, with those of the paper's Table 2 as diamonds."""
    figure, panel = one_panel(4.6)
    numbers = sorted(indices)
    places = range(len(numbers) - 1, -1, -1)
    values = [indices[number] for number in numbers]
    colours = [BLUE if value >= 0 else ORANGE for value in values]
    panel.barh(list(places), values, color=colours, height=0.62, alpha=0.85)
    printed = [PRINTED_INDICES[number] for number in numbers]
    panel.plot(printed, list(places), "D", markersize=6.5, fillstyle="none", color=INK, label="the paper, Table 2")
    for place, value in zip(places, values, strict=True):
        left = value < 0
        panel.annotate(
            signed(value, ".3f" if abs(value) >= 1e-3 else ".2g"), (value, place), (-9 if left else 9, 0),
            textcoords="offset points", ha="right" if left else "left", va="center", fontsize=7.5,
        )  # fmt: skip
    panel.set_yticks(list(places), [f"{number}  {FACTOR_WORDS[number]}" for number in numbers], fontsize=8)
    panel.axvline(0.0, color=INK, linewidth=0.8)
    panel.tick_params(axis="y", length=0)
    widest = max(1.6, *(abs(value) for value in values))
    panel.set_xlim(-1.42 * widest, 1.42 * widest)
    panel.set_xlabel("change of backlash per change of the error, over that of factor 6")
    panel.legend(loc="lower left")
    panel.grid(axis="x", alpha=0.4)
    panel.set_axisbelow(True)
    return figure


def costs_figure(bill: "Bill", form: str) -> "Figure":
    """Draw the price of every zone in one form of the cost functions, and what another width would cost."""
    figure = Figure(figsize=(WIDTH, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1, 1))
    _bars(left, {name: prices[form] for name, prices in bill.prices.items()}, "{:.0f}")
    left.set_xlabel("price of the zone, yuan")
    shares = np.linspace(0.5, 2.0, 61)
    for place, name in enumerate(_first_of_kind(bill.widths, PRICED)):
        width = bill.widths[name]
        paid = [price(PRICED[name], form).at(float(share * width)) for share in shares]
        colour = (BLUE, ORANGE, "#2f6b4f")[place % 3]
        words = f"{name.replace('_', ' ')}, now {width / MICRO:.3g} µm"
        right.plot(shares, paid, color=colour, label=words)
        right.plot(1.0, bill.prices[name][form], "o", color=colour, markersize=5)
    right.set_xlabel("width of the zone over that now")
    right.set_ylabel("price of the zone, yuan")
    right.set_ylim(0, None)
    right.grid(alpha=0.4)
    if right.get_legend_handles_labels()[0]:
        right.legend(fontsize=7)
    return figure


def _first_of_kind(widths: Mapping[str, float], kinds: Mapping[str, Any]) -> Sequence[str]:
    """The first zone of each cost function."""
    found: dict[Any, str] = {}
    for name in widths:
        found.setdefault(kinds[name], name)
    return list(found.values())


def _bars(panel: Any, values: Mapping[str, float], words: str) -> None:
    """Bars with their values, the longest on top."""
    ranked = sorted(values.items(), key=lambda item: item[1])
    panel.barh([name.replace("_", " ") for name, _ in ranked], [value for _, value in ranked], color=BLUE, height=0.66)
    for place, (_, value) in enumerate(ranked):
        panel.text(value, place, " " + words.format(value), va="center", fontsize=7.5, color=INK)
    panel.set_xlim(0, 1.2 * max([value for _, value in ranked], default=1.0) or 1.0)
    panel.tick_params(axis="y", length=0, labelsize=8)
    panel.grid(axis="x", alpha=0.4)
    panel.set_axisbelow(True)
