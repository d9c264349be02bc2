"""Figures of studies, made when the sheet is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from truing.studies.reading import spoken

BLUE, ORANGE, GREY = "#1f5a8a", "#c8641e", "#8a8f98"
WIDTH = 6.4
MOST_BARS = 16


def labelled(name: str, unit: str) -> str:
    """Return the label of an axis."""
    return f"{spoken(name)}, {unit}" if unit else spoken(name)


def bars(title: str, values: Mapping[str, float], label: str, *, most: int = MOST_BARS) -> Callable[[], Figure]:
    """Draw ranked bars, the longest on top."""

    def draw() -> Figure:
        ranked = sorted(values.items(), key=lambda bar: -abs(bar[1]))[:most][::-1]
        figure = Figure(figsize=(WIDTH, 0.9 + 0.26 * len(ranked)), layout="constrained")
        panel = figure.subplots()
        names = [spoken(name) for name, _ in ranked]
        colours = [BLUE if value >= 0 else ORANGE for _, value in ranked]
        panel.barh(names, [value for _, value in ranked], color=colours)
        panel.axvline(0.0, color=GREY, linewidth=0.8)
        panel.set_xlabel(label)
        panel.set_title(title, fontsize="medium")
        panel.locator_params(axis="x", nbins=6)
        panel.grid(axis="x", alpha=0.3)
        return figure

    return draw


def lines(
    x: Sequence[float], series: Mapping[str, Sequence[float]], labels: tuple[str, str], goals: Mapping[str, float]
) -> Callable[[], Figure]:
    """Draw probabilities against steps or an input, with their goals as dashed lines."""

    def draw() -> Figure:
        figure = Figure(figsize=(WIDTH, 3.2), layout="constrained")
        panel: Any = figure.subplots()
        for index, (name, values) in enumerate(series.items()):
            colour = (BLUE, ORANGE, "#3f7f4f", "#7a4f9a")[index % 4]
            panel.plot(x, values, color=colour, marker="o", markersize=3.5, label=spoken(name))
            if name in goals:
                panel.axhline(goals[name], color=colour, linestyle="--", linewidth=0.9)
        panel.set_xlabel(labels[0])
        panel.set_ylabel(labels[1])
        shown = [value for values in series.values() for value in values if value == value]
        highest, lowest = max([*shown, *goals.values()]), min([*shown, *goals.values()])
        room = 0.06 * max(highest - lowest, 0.01)
        panel.set_ylim(max(lowest - room, -0.02), min(highest + room, 1.02))
        panel.legend(frameon=False)
        panel.grid(alpha=0.3)
        return figure

    return draw
