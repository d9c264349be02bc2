"""The groups that the search finds: where they lie in the window, and how hard each is loaded."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rv_gearing.drawn_look import BLUE, INK, MM, MPA, ORANGE, WIDTH, one_panel
from rv_gearing.duty import centre_distance_window, pin_circle_factors
from rv_gearing.search import Found

Values = NDArray[np.float64]

MOST_NUMBERED = 40
MOST_TICKS = 30


def groups_figure(found: "Found") -> "Figure":
    """Draw the centre distance of every group over the deviation of its ratio, with the limits of both."""
    figure, panel = one_panel(3.7)
    groups = found.groups
    deviation, centre = 100.0 * groups.deviation, MM * groups.centre_distance
    limit = 100.0 * float(found.inputs.ratio_tolerance)
    low, high = (MM * float(np.mean(end)) for end in centre_distance_window(found.inputs, groups.torque))
    panel.axvspan(-limit, limit, color=BLUE, alpha=0.05, linewidth=0)
    for edge in (low, high):
        panel.axhline(edge, color=INK, linewidth=0.9, linestyle=(0, (6, 3)))
    for edge in (-limit, limit):
        panel.axvline(edge, color=INK, linewidth=0.9, linestyle=(0, (6, 3)))
    panel.set_title(f"window of the centre distance: {low:.2f} to {high:.2f} mm", fontsize=8.5, loc="left")
    if len(np.unique(groups.pins)) > 1:
        marks = panel.scatter(deviation, centre, s=16, c=groups.pins, cmap="viridis", zorder=4, linewidths=0)
        figure.colorbar(marks, ax=panel, label="pins", pad=0.01)
    else:
        panel.scatter(deviation, centre, s=16, color=BLUE, zorder=4, linewidths=0)
    _numbers(panel, found, deviation, centre)
    _rated(panel, found, deviation, centre)
    panel.set_xlabel("deviation of the ratio, %")
    panel.set_ylabel("centre distance, mm")
    panel.set_xlim(-1.12 * limit, 1.12 * limit)
    panel.set_ylim(low - 0.08 * (high - low), high + 0.08 * (high - low))
    panel.grid(alpha=0.35)
    panel.set_axisbelow(True)
    return figure


def _numbers(panel: Any, found: "Found", deviation: "Values", centre: "Values") -> None:
    """The number of each group beside it, where there is room for them."""
    if len(deviation) > MOST_NUMBERED:
        return
    for number, across, up in zip(found.numbers, deviation, centre, strict=True):
        panel.annotate(f"{number:.0f}", (across, up), (5, -3), textcoords="offset points", fontsize=7.5, color=INK)


def _rated(panel: Any, found: "Found", deviation: "Values", centre: "Values") -> None:
    """A ring around the group that is rated."""
    chosen = found.numbers == (found.rated or 0)
    if np.any(chosen):
        panel.plot(deviation[chosen], centre[chosen], "o", markersize=11, fillstyle="none", color=ORANGE,
                   markeredgewidth=1.6, zorder=5)  # fmt: skip
        panel.annotate("rated", (float(deviation[chosen][0]), float(centre[chosen][0])), (-9, 3), ha="right",
                       textcoords="offset points", fontsize=8, color=ORANGE)  # fmt: skip


def window_words(found: "Found") -> str:
    """The range of pin circles that the torque admits, in words."""
    torque = float(np.mean(found.groups.torque))
    low, high = (MM * float(factor) * torque ** (1 / 3) for factor in pin_circle_factors(found.inputs))
    circles = f"{low:.2f} mm" if low == high else f"{low:.2f} to {high:.2f} mm"
    return f"Output torque {torque:.2f} N m; pin circle radius by equation 4: {circles}."


def stresses_figure(found: "Found") -> "Figure":
    """Draw the root and contact stresses of all groups below what each of them may be."""
    figure = Figure(figsize=(WIDTH, 4.8), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    order = np.argsort(found.numbers)
    places = np.arange(len(order))
    for panel, kind in zip(panels, ("root", "contact"), strict=True):
        for gear, colour, marker in (("sun", BLUE, "o"), ("planet", ORANGE, "s")):
            stress, permitted = (
                MPA * found.strength[f"{word}{kind}_stress_{gear}"][order] for word in ("", "permitted_")
            )
            panel.plot(places, stress, marker, markersize=4, color=colour, label=gear)
            panel.step(places, permitted, where="mid", color=colour, linewidth=1.0, linestyle=(0, (5, 2)),
                       label=f"{gear}, permissible")  # fmt: skip
        panel.set_ylabel(f"{kind} stress, MPa")
        panel.set_ylim(0, None)
        panel.grid(alpha=0.35)
        panel.set_axisbelow(True)
    panels[0].legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.22), handlelength=1.8, columnspacing=1.3)
    _ticks(panels[1], found, order)
    return figure


def _ticks(panel: Any, found: "Found", order: "NDArray[np.intp]") -> None:
    """Numbers of the groups below, with their teeth where there is room; the rated one stands out."""
    step = max(1, -(-len(order) // MOST_TICKS))
    shown = order[::step]
    roomy = step == 1
    labels = [
        f"{found.numbers[place]:.0f}\n{found.groups.sun[place]:.0f}\n{found.groups.planet[place]:.0f}"
        if roomy
        else f"{found.numbers[place]:.0f}"
        for place in shown
    ]
    panel.set_xticks(np.arange(len(order))[::step], labels, fontsize=7)
    panel.set_xlabel("group: its number, teeth of the sun, teeth of the planet" if roomy else "group")
    for label, place in zip(panel.get_xticklabels(), shown, strict=True):
        if found.numbers[place] == found.rated:
            label.set_color(ORANGE)
            label.set_fontweight("bold")
