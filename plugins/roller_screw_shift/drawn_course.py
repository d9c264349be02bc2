"""Objectives, limits and margins over the shift of the roller, with the optimum."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from roller_screw_shift.courses import Course, Values, course_of
from roller_screw_shift.drawn_look import BLUE, GREEN, GREY, INK, ORANGE, PALE, panels, quiet
from roller_screw_shift.shifts import LIMITS, Chosen, signed

POINTS = 1201
BESIDE = 0.35  # of a shift, shown on either side of what is allowed
ROLLER = "profile shift of the roller $x_E$"
LABELS = ("sum of the shifts $f_1$", "stress difference\n$f_2$, MPa", "sliding difference\n$f_3$")
SHADES = (BLUE, GREEN, "#7a4f9a", "#b0892c", "#4f86b3", GREY)
HIGHEST = 1.0  # margins above are far from their limits


def shown(chosen: "Chosen") -> Values:
    """The shifts that the figures show: what is allowed, what is stated, and some on either side."""
    places = [float(chosen.inputs.roller_shift)]
    if chosen.field is not None:
        places += [end for part in chosen.field.intervals for end in (part.low, part.high)]
    low, high = max(min(places) - BESIDE, chosen.span[0]), min(max(places) + BESIDE, chosen.span[1])
    return np.asarray(np.linspace(low, high, POINTS), dtype=float)


def marks(panel: Any, chosen: "Chosen") -> None:
    """Shade what is allowed, and mark the optimum and what is stated."""
    if chosen.field is not None:
        for number, part in enumerate(chosen.field.intervals):
            panel.axvspan(part.low, part.high, color=PALE, zorder=0, label="every limit is kept" if not number else "")
        panel.axvline(chosen.shift, color=ORANGE, linewidth=1.4, label=f"optimum, {signed(chosen.shift)}")
    stated = float(chosen.inputs.roller_shift)
    panel.axvline(stated, color=INK, linewidth=1.0, linestyle=(0, (4, 3)), label=f"as stated, {signed(stated, '.4g')}")


def objectives_figure(chosen: "Chosen") -> "Figure":
    """Draw the three objectives over the shift, one below the other."""
    course = course_of(chosen.inputs, shown(chosen))
    figure, rows = panels(3, 5.6, sharex=True)
    for panel, values, label in zip(rows, course.objectives, LABELS, strict=True):
        marks(panel, chosen)
        panel.plot(course.shifts, values, color=BLUE, linewidth=1.6)
        quiet(panel, "", label)
        panel.set_xlim(course.shifts[0], course.shifts[-1])
    most = 1.25 * float(chosen.inputs.most_sliding_difference)
    rows[2].set_ylim(0.0, most)
    if np.isfinite(chosen.equal) and course.shifts[0] < chosen.equal < course.shifts[-1]:
        rows[2].annotate(
            f"equal sliding, {signed(chosen.equal)}", (chosen.equal, 0.0), (28, 26), textcoords="offset points",
            fontsize=8, arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.6},
        )  # fmt: skip
    rows[2].set_xlabel(ROLLER)
    rows[0].legend(loc="upper left", fontsize=7.5)
    return figure


def limits_figure(chosen: "Chosen") -> "Figure":
    """Draw where each limit is kept, and how the margins run."""
    course = course_of(chosen.inputs, shown(chosen))
    figure, (bars, lines) = panels(2, 6.6, sharex=True)
    _bars(bars, course)
    _lines(lines, course)
    for panel in (bars, lines):
        marks(panel, chosen)
        panel.set_xlim(course.shifts[0], course.shifts[-1])
    lines.set_xlabel(ROLLER)
    figure.legend(
        *lines.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=7.5, frameon=False,
    )  # fmt: skip
    return figure


def _bars(panel: Any, course: Course) -> None:
    """A bar by limit, where it is kept."""
    step = course.shifts[1] - course.shifts[0]
    for place, margin in enumerate(course.margins.values()):
        kept = np.concatenate([[False], margin >= 0.0, [False]])
        turns = np.flatnonzero(kept[1:] != kept[:-1])
        parts = [
            (course.shifts[first] - 0.5 * step, (beyond - first) * step)
            for first, beyond in zip(turns[::2], turns[1::2], strict=True)
        ]
        panel.broken_barh(parts, (place - 0.32, 0.64), facecolors="#8fb3cf", zorder=2)
    panel.set_yticks(range(len(LIMITS)), [" ".join(words) for words in LIMITS.values()], fontsize=8)
    panel.set_ylim(len(LIMITS) - 0.4, -0.6)
    panel.grid(axis="x", alpha=0.4)
    panel.set_axisbelow(True)


def _lines(panel: Any, course: Course) -> None:
    """The margins that change sign in the picture."""
    shown = [(name, margin) for name, margin in course.margins.items() if _crosses(margin)]
    for number, (name, margin) in enumerate(shown):
        colour = SHADES[number % len(SHADES)]
        panel.plot(course.shifts, margin, color=colour, linewidth=1.6, label=" ".join(LIMITS[name]))
    panel.axhline(0.0, color=INK, linewidth=0.9)
    panel.set_ylim(-0.3 * HIGHEST, HIGHEST)
    quiet(panel, "", "margin")


def _crosses(margin: Values) -> bool:
    """Whether a limit is kept somewhere in the picture and missed elsewhere."""
    return bool((margin >= 0.0).any() and (margin < 0.0).any())
