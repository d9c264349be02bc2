"""What the weights choose: places on the front, and the optimum over all weights there are."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from roller_screw_shift.best_shifts import READINGS, Field, grid_optimum
from roller_screw_shift.courses import Values, course_of
from roller_screw_shift.drawn_look import BLUE, GREEN, GREY, INK, ORANGE, panels, quiet
from roller_screw_shift.shifts import READING, Chosen, signed
from roller_screw_shift.weighing import Three, normalised, weights_of
from truing import Optimum

MANY = 72  # weights along each side of the triangle
GRID = 401
MARKS = {"own_ranges": ("o", ORANGE), "printed_ranges": ("s", GREEN), "printed": ("^", INK)}
SIDES = (0.0 + 0.0j, 1.0 + 0.0j, 0.5 + 0.5j * np.sqrt(3.0))  # all weight on the sum, on the stresses, on the sliding


def chosen_shifts(chosen: "Chosen", field: Field) -> dict[str, float]:
    """The optimum on the grid by every reading of the weights."""
    return {reading: grid_optimum(field, weights_of(reading, field.ranges)) for reading in READINGS}


def front_figure(chosen: "Chosen", field: Field, optimum: "Optimum | None") -> "Figure":
    """Draw the objectives against one another along the shift, and where the weights choose."""
    figure, rows = panels(2, 6.2)
    course = field.course
    found = chosen_shifts(chosen, field)
    for panel, other, label in zip(rows, (0, 2), ("sum of the shifts", "difference of sliding"), strict=True):
        panel.plot(course.objectives[1], course.objectives[other], color=BLUE, linewidth=1.4,
                   label="all shifts that keep every limit")  # fmt: skip
        if optimum is not None and optimum.front and _names(optimum) >= {"shift_sum", "stress_difference"}:
            panel.plot(*_designs(optimum, other), ".", color=GREY, markersize=5, label="front found by the search")
        _stated(panel, chosen, other)
        for size, (reading, shift) in enumerate(found.items()):
            marker, colour = MARKS[reading]
            at = course_of(chosen.inputs, np.array([shift])).objectives[:, 0]
            panel.plot(at[1], at[other], marker, markersize=13 - 3.5 * size, color=colour, fillstyle="none",
                       markeredgewidth=1.6, linestyle="", label=f"{READING[reading]}: {signed(shift)}")  # fmt: skip
        quiet(panel, "difference of the root stresses, MPa", label)
    rows[0].legend(fontsize=7.5, loc="upper left")
    return figure


def _names(optimum: "Optimum") -> set[str]:
    return {aim.name for aim in optimum.aims}


def _designs(optimum: "Optimum", other: int) -> tuple[list[float], list[float]]:
    name = ("shift_sum", "stress_difference", "sliding_difference")[other]
    return (
        [design.objectives["stress_difference"] / 1e6 for design in optimum.front],
        [design.objectives.get(name, float("nan")) for design in optimum.front],
    )


def _stated(panel: Any, chosen: "Chosen", other: int) -> None:
    at = course_of(chosen.inputs, np.array([float(chosen.inputs.roller_shift)])).objectives[:, 0]
    panel.plot(at[1], at[other], "X", markersize=8, color=INK, linestyle="", label="as stated")


def triangle(field: Field) -> tuple[Values, Values]:
    """Return shares of the weights (n, 3), which add up to 1, and the shift that each of them chooses (n,)."""
    first, second = np.meshgrid(np.arange(MANY + 1), np.arange(MANY + 1), indexing="ij")
    inside = first + second <= MANY
    shares = np.column_stack([first[inside], second[inside], MANY - first[inside] - second[inside]]) / MANY
    course = field.course
    places = np.unique(np.linspace(0, len(course.shifts) - 1, GRID).astype(int))
    parts = [
        sense * np.asarray(normalised(course.objectives[number, places], field.ranges[number]))
        if field.ranges[number][1] > field.ranges[number][0]
        else np.zeros(len(places))
        for number, sense in enumerate((-1.0, 1.0, 1.0))
    ]
    best = np.argmin(shares @ np.array(parts), axis=1)
    return shares, course.shifts[places][best]


def triangle_figure(chosen: "Chosen", field: Field) -> "Figure":
    """Draw the chosen shift over all weights; only their ratios matter, so they fill a triangle."""
    shares, shifts = triangle(field)
    figure, (panel,) = panels(1, 4.6)
    at = shares @ np.array(SIDES)
    map_of = panel.scatter(at.real, at.imag, c=shifts, s=17, marker="h", cmap="viridis", linewidths=0)
    for reading in READINGS:
        marker, colour = MARKS[reading]
        place = _place(weights_of(reading, field.ranges))
        panel.plot(place.real, place.imag, marker, markersize=10, markerfacecolor="white", markeredgecolor=colour,
                   markeredgewidth=1.8, linestyle="", label=READING[reading], clip_on=False)  # fmt: skip
    names = ("sum of the shifts\nalone", "root stresses\nalone", "sliding alone")
    for corner, words in zip(SIDES, names, strict=True):
        below = corner.imag == 0.0
        panel.annotate(words, (corner.real, corner.imag), (0, -6 if below else 6), textcoords="offset points",
                       ha="center", va="top" if below else "bottom", fontsize=8.5)  # fmt: skip
    panel.set_aspect("equal")
    panel.set_xlim(-0.16, 1.16)
    panel.set_ylim(-0.14, 0.97)
    panel.axis("off")
    figure.colorbar(map_of, ax=panel, label="shift of the roller chosen", shrink=0.8)
    panel.legend(loc="upper left", fontsize=7.5, title="weights", title_fontsize=7.5)
    return figure


def _place(weights: Three) -> complex:
    """Where these weights lie in the triangle."""
    return complex(np.dot(weights, SIDES) / sum(weights)) if sum(weights) else complex(np.mean(SIDES))
