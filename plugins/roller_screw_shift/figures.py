"""The figures: the teeth to scale, objectives and limits over the shift, what weights choose."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from gear_geometry.drawing import BLUE, GREEN, GREY, INK, ORANGE, PALE, panels, quiet
from gear_geometry.pairs import involute
from roller_screw_shift.calculation import meshing_of
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.objectives import SENSES, ShiftCourse, Three, course_of, normalised, weights_of
from roller_screw_shift.optimum import (
    LIMITS,
    MM,
    READING,
    READINGS,
    ChosenShift,
    Field,
    grid_optimum,
    over_ratios,
    signed,
)  # fmt: skip
from roller_screw_shift.quantities import Meshing, Pair
from roller_screw_shift.strength import roller_fillet
from roller_screw_shift.threads import sharing_of
from truing import Array, Optimum, Record

PairRun = Record[Pair, Meshing]

# Objectives, limits and margins over the shift of the roller, with the optimum

COURSE_POINTS = 1201
BESIDE = 0.35  # of a shift, shown on either side of what is allowed
ROLLER = "profile shift of the roller $x_E$"
LABELS = ("sum of the shifts $f_1$", "stress difference\n$f_2$, MPa", "sliding difference\n$f_3$")
SHADES = (BLUE, GREEN, "#7a4f9a", "#b0892c", "#4f86b3", GREY)
HIGHEST = 1.0  # margins above are far from their limits


def shown(chosen: "ChosenShift") -> Array:
    """The shifts that the figures show: what is allowed, what is stated, and some on either side."""
    places = [float(chosen.inputs.roller_shift)]
    if chosen.field is not None:
        places += [end for part in chosen.field.intervals for end in (part.low, part.high)]
    low, high = max(min(places) - BESIDE, chosen.span[0]), min(max(places) + BESIDE, chosen.span[1])
    return np.asarray(np.linspace(low, high, COURSE_POINTS), dtype=float)


def marks(panel: Any, chosen: "ChosenShift") -> None:
    """Shade what is allowed, and mark the optimum and what is stated."""
    if chosen.field is not None:
        for number, part in enumerate(chosen.field.intervals):
            panel.axvspan(part.low, part.high, color=PALE, zorder=0, label="every limit is kept" if not number else "")
        panel.axvline(chosen.shift, color=ORANGE, linewidth=1.4, label=f"optimum, {signed(chosen.shift)}")
    stated = float(chosen.inputs.roller_shift)
    panel.axvline(stated, color=INK, linewidth=1.0, linestyle=(0, (4, 3)), label=f"as stated, {signed(stated, '.4g')}")


def objectives_figure(chosen: "ChosenShift") -> "Figure":
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


def limits_figure(chosen: "ChosenShift") -> "Figure":
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


def _bars(panel: Any, course: ShiftCourse) -> None:
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
    quiet(panel, axis="x")


def _lines(panel: Any, course: ShiftCourse) -> None:
    """The margins that change sign in the picture."""
    shown = {name: margin for name, margin in course.margins.items() if len(np.unique(margin >= 0.0)) > 1}
    for number, (name, margin) in enumerate(shown.items()):
        colour = SHADES[number % len(SHADES)]
        panel.plot(course.shifts, margin, color=colour, linewidth=1.6, label=" ".join(LIMITS[name]))
    panel.axhline(0.0, color=INK, linewidth=0.9)
    panel.set_ylim(-0.3 * HIGHEST, HIGHEST)
    quiet(panel, "", "margin")


RATIO_POINTS = 81


def ratios_figure(chosen: "ChosenShift") -> "Figure":
    """Draw the optimal shift, and the largest sliding there, over the least contact ratio that is asked for."""
    figure, (above, below) = panels(2, 5.2, sharex=True)
    wide = chosen.wide
    if wide is None or chosen.reached is None:
        return figure
    highest = float(np.max(wide.course.margins["margin_contact_ratio"])) + float(wide.pair.least_contact_ratio)
    ratios = np.linspace(float(wide.pair.least_contact_ratio), highest, RATIO_POINTS)
    sliding = np.asarray(meshing_of(replace(wide.pair, roller_shift=wide.course.shifts)).largest_sliding)
    lines = [(over_ratios(chosen, ratios, name, robust=False), MARKS[name][1], "-", READING[name]) for name in READINGS]
    held = over_ratios(chosen, ratios, chosen.inputs.weights, robust=True)
    lines.append((held, BLUE, "--", f"kept by {100 * chosen.probability:g} % of the screws"))
    for shifts, colour, line, words in lines:
        above.plot(ratios, shifts, line, color=colour, linewidth=1.4, label=words)
        below.plot(ratios, np.interp(shifts, wide.course.shifts, sliding), line, color=colour, linewidth=1.4)
    for panel in (above, below):
        panel.axvline(float(chosen.inputs.least_contact_ratio), color=INK, linewidth=1.0, linestyle=(0, (4, 3)))
    quiet(above, "", ROLLER)
    quiet(below, "least contact ratio; dashed upright: as stated", "largest sliding")
    above.legend(fontsize=7.5)
    return figure


# The outlines of the teeth: involutes, the root fillet that a rack leaves on the roller, and a round one on the ring
#
# All lengths are in metres, every outline is one half of a tooth from its tip to its root, beside an axis through its
# middle: complex numbers, the axis of the tooth upward from the centre of the gear, the flank to the right.

Outline = NDArray[np.complex128]
OUTLINE_POINTS = 60
HALVINGS = 60


def roller_half(pair: Pair) -> Outline:
    """Return half a tooth of the roller: tip, involute, and the envelope of the rounded edge of its rack."""
    roller = geometry_of(pair).roller
    fillet = _rack_fillet(pair)
    radius = np.linspace(float(roller.tip_radius), abs(fillet[0]), OUTLINE_POINTS)
    half = (0.5 * np.pi + 2.0 * float(pair.roller_shift) * np.tan(pair.pressure_angle)) / float(pair.roller_teeth)
    angle = half + involute(pair.pressure_angle) - involute(_angle(float(roller.base_radius), radius))
    flank = radius * np.exp(1j * (0.5 * np.pi - angle))
    tip = _arc(float(roller.tip_radius), 0.0, float(angle[0]))
    foot = _arc(float(abs(fillet[-1])), _across(fillet[-1]), np.pi / float(pair.roller_teeth))
    return np.concatenate([tip, flank, fillet, foot])


def _rack_fillet(pair: Pair) -> Outline:
    """Return the fillet of the roller from its flank to its root, m.

    The edge of the rack is a circle; while the rack rolls on the reference circle, its normal through the pitch point
    marks the point that stays. The axis of the tooth is half a pitch beside the gap that the rack cuts.
    """
    teeth, rho, fillet = float(pair.roller_teeth), float(pair.roller_fillet), roller_fillet(pair)
    height = float(np.asarray(fillet.height))  # of the centre of the circle over the rolling line, below 0
    along = np.linspace(-height / np.tan(pair.pressure_angle), 0.0, OUTLINE_POINTS)
    centre = along + 1j * height
    point = centre + rho * centre / np.abs(centre) + 0.5j * teeth
    turned = 2.0 * (along - float(np.asarray(fillet.offset))) / teeth
    gap = point * np.exp(1j * turned)  # beside the axis of the gap, its flank to the right
    return np.asarray(float(pair.module) * _mirrored(gap * np.exp(1j * np.pi / teeth)))


def _mirrored(points: Outline) -> Outline:
    """The same on the other side of the axis."""
    return np.asarray(-points.conjugate())


def ring_half(pair: Pair) -> Outline:
    """Return half a tooth of the ring: tip, involute, and a round fillet that touches flank and root circle."""
    ring, rho = geometry_of(pair).ring, float(pair.ring_fillet) * float(pair.module)
    root, base, tip = float(ring.root_radius), float(ring.base_radius), float(ring.tip_radius)
    low, high = tip, root
    for _ in range(HALVINGS):  # the circle of the fillet touches the flank where its centre is rho below the root
        middle = 0.5 * (low + high)
        low, high = (middle, high) if abs(_fillet_centre(pair, middle, base, rho)) < root - rho else (low, middle)
    radius = np.linspace(tip, low, OUTLINE_POINTS)
    flank = radius * np.exp(1j * (0.5 * np.pi - _ring_angle(pair, radius, base)))
    centre = _fillet_centre(pair, low, base, rho)
    first, last = np.angle((flank[-1] - centre) / 1j), np.angle(centre / 1j)
    fillet = centre + 1j * rho * np.exp(1j * np.linspace(first, last, OUTLINE_POINTS))
    foot = _arc(root, _across(fillet[-1]), np.pi / float(pair.ring_teeth))
    return np.concatenate([_arc(tip, 0.0, _across(flank[0])), flank, fillet, foot])


def _ring_angle(pair: Pair, radius: Any, base: float) -> Any:
    """Half the angle of the tooth of the ring at a radius: half a pitch less half a gap, which is as a tooth."""
    shift = float(np.asarray(geometry_of(pair).ring_shift))
    gap = (0.5 * np.pi + 2.0 * shift * np.tan(pair.pressure_angle)) / pair.ring_teeth
    return np.pi / pair.ring_teeth - (gap + involute(pair.pressure_angle) - involute(_angle(base, radius)))


def _fillet_centre(pair: Pair, radius: float, base: float, rho: float) -> complex:
    """The centre of a circle that touches the flank of the ring at this radius from within the gap."""
    pressure = float(_angle(base, radius))
    place = 0.5 * np.pi - float(_ring_angle(pair, radius, base))
    return complex((radius - 1j * rho * np.exp(-1j * pressure)) * np.exp(1j * place))


def _angle(base: float, radius: Any) -> Any:
    return np.arccos(np.clip(base / radius, -1.0, 1.0))


def _across(point: complex) -> float:
    """The angle of a point to the right of the axis."""
    return float(0.5 * np.pi - np.angle(point))


def _arc(radius: float, first: float, last: float) -> Outline:
    return np.asarray(radius * np.exp(1j * (0.5 * np.pi - np.linspace(first, last, 12))))


def toothing(half: Outline, teeth: float, numbers: range, middle: float = 0.0) -> Outline:
    """Return the outline of these teeth from left to right; ``middle`` is the place of number 0, in pitches."""
    tooth = np.concatenate([_mirrored(half)[::-1], half])
    return np.concatenate([tooth * np.exp(-2j * np.pi * (number + middle) / teeth) for number in numbers])


# Roller and ring to scale, and how their flanks slide along the path of contact

PITCHES = 1.75  # shown on either side of the middle
PATH_POINTS = 121


def ring_shift(pair: Pair) -> float:
    """The shift of the ring that goes with that of the roller."""
    return float(np.asarray(geometry_of(pair).ring_shift))


def teeth_figure(pair: Pair, shifts: "Sequence[tuple[str, float]]") -> "Figure":
    """Draw the pair at each of these shifts (words, shift of the roller), all to one scale."""
    pitch = MM * float(np.pi * pair.module)
    reach = PITCHES * pitch
    figure, rows = panels(len(shifts), 3.15 * len(shifts), sharex=True, squeeze=False)
    for panel, (words, shift) in zip(rows[:, 0], shifts, strict=True):
        shifted = replace(pair, roller_shift=shift)
        _teeth(panel, shifted)
        _path(panel, shifted)
        middle = MM * 0.5 * float(pair.module * pair.ring_teeth)
        panel.set_aspect("equal")
        panel.set_xlim(-reach, reach)
        panel.set_ylim(middle - 0.62 * reach, middle + 0.40 * reach)
        panel.set_title(
            f"{words}: roller {signed(shift)}, ring {signed(ring_shift(shifted))}", fontsize="medium", loc="left"
        )
        quiet(panel, "", "mm from the axis of the nut")
    rows[-1, 0].set_xlabel("mm")
    return figure


def _teeth(panel: Any, pair: Pair) -> None:
    """Both gears, filled: the ring from outside, the roller from below."""
    ring = MM * toothing(ring_half(pair), float(pair.ring_teeth), range(-5, 5), 0.5)
    roller = MM * (toothing(roller_half(pair), float(pair.roller_teeth), range(-4, 5)) + 1j * pair.centre_distance)
    outer, inner = ring.imag.max() + 10.0, MM * pair.centre_distance
    panel.fill([*ring.real, ring.real[-1], ring.real[0]], [*ring.imag, outer, outer], facecolor="#f6e3d3",
               edgecolor=ORANGE, linewidth=1.2, zorder=2)  # fmt: skip
    panel.fill([*roller.real, 0.0], [*roller.imag, inner], facecolor="#dbe7f0", edgecolor=BLUE, linewidth=1.2, zorder=3)
    panel.annotate("ring", (0.015, 0.93), xycoords="axes fraction", color=ORANGE, fontsize=9, va="top", zorder=6)
    panel.annotate("roller", (0.015, 0.06), xycoords="axes fraction", color=BLUE, fontsize=9, zorder=6)


def _path(panel: Any, pair: Pair) -> None:
    """The line of action, the part of it on which teeth touch, and the pitch point."""
    path = path_of(pair)
    geometry = geometry_of(pair)
    angle = float(np.asarray(geometry.working_angle))
    pitch_point = 1j * MM * float(geometry.ring.base_radius) / np.cos(angle)
    outward = np.exp(1j * angle)  # for the flank to the right: away from both axes
    whole = pitch_point + np.array([-3.0, 3.0]) * outward
    part = pitch_point + MM * np.array([path.place[0], path.place[-1]]) * outward
    panel.plot(whole.real, whole.imag, color=GREY, linewidth=0.7, linestyle=(0, (8, 3, 1, 3)), zorder=4)
    panel.plot(part.real, part.imag, color=GREEN, linewidth=2.0, zorder=5)
    panel.plot(pitch_point.real, pitch_point.imag, "o", markersize=4, markerfacecolor="white", markeredgecolor=INK,
               zorder=6)  # fmt: skip


@dataclass(frozen=True, eq=False)
class ContactPath:
    """Places on the path of contact (n,), m from the pitch point outward, and the specific sliding of both there."""

    place: "NDArray[np.float64]"
    roller: "NDArray[np.float64]"
    ring: "NDArray[np.float64]"


def path_of(pair: Pair) -> ContactPath:
    """Return the path from the tip of the ring to that of the roller; sliding is 1 - v_other/v_own, with its sign.

    Speeds along a flank are its radius of curvature times the speed of the gear; both turn against the carrier in the
    same sense.
    """
    geometry = geometry_of(pair)
    tangent = np.tan(float(np.asarray(geometry.mounted_angle)))
    roller, ring = geometry.roller, geometry.ring
    first = float(ring.base_radius) * (np.tan(float(ring.tip_angle)) - tangent)
    last = float(roller.base_radius) * (np.tan(float(roller.tip_angle)) - tangent)
    place = np.linspace(first, last, PATH_POINTS)
    at_roller = float(roller.base_radius) * tangent + place
    at_ring = float(ring.base_radius) * tangent + place
    ratio = float(pair.ring_teeth) / float(pair.roller_teeth)
    return ContactPath(place, 1.0 - at_ring / (ratio * at_roller), 1.0 - ratio * at_roller / at_ring)


def threads_figure(pair: Pair) -> "Figure":
    """Draw the load of every thread over the mean, with the nut held as stated and at the other end."""
    figure, panel = panels(1, 3.2)
    other: Literal["same_side", "far_side"] = "same_side" if pair.support == "far_side" else "far_side"
    number = np.arange(1, pair.thread_turns + 1)
    for support, line in ((pair.support, "o-"), (other, "--")):
        shared = sharing_of(replace(pair, support=support))
        for body, shares, colour in (("screw", shared.screw, BLUE), ("nut", shared.nut, ORANGE)):
            panel.plot(number, shares, line, markersize=3.5, linewidth=1.2, color=colour,
                       label=f"{body}, nut held at the {support.replace('_', ' ')}")  # fmt: skip
    panel.axhline(1.0, color=GREY, linewidth=0.8)
    panel.xaxis.get_major_locator().set_params(integer=True)
    quiet(panel, "thread of the roller, from the loaded end", "load over the mean")
    panel.legend(fontsize=7.5)
    return figure


LOOKS = (("o", "white"), ("X", INK), ("D", ORANGE))


def sliding_figure(pair: Pair, shifts: "Sequence[tuple[str, float]]") -> "Figure":
    """Draw the specific sliding of both gears along the path of contact, and where the path ends by these shifts.

    The shift moves the ends of the path; the curves between them stay.
    """
    figure, panel = panels(1, 3.8)
    paths = [path_of(replace(pair, roller_shift=shift)) for _, shift in shifts]
    for path in paths:
        panel.plot(MM * path.place, path.roller, color=BLUE, label="roller" if path is paths[0] else "")
        panel.plot(MM * path.place, path.ring, color=ORANGE, label="ring" if path is paths[0] else "")
    for (words, shift), path, (marker, face) in zip(shifts, paths, LOOKS, strict=False):
        ends = MM * path.place[[0, -1]], [path.roller[0], path.ring[-1]]
        told = f"{words}, {signed(shift, '.4g')}: {signed(ends[1][0], '.2f')} and {signed(ends[1][1], '.2f')}"
        panel.plot(*ends, marker, markersize=7, markerfacecolor=face, markeredgecolor=INK, linestyle="", label=told)
    panel.axhline(0.0, color=INK, linewidth=0.8)
    panel.axvline(0.0, color=GREY, linewidth=0.8)
    quiet(panel, "place on the path of contact from the pitch point outward, mm", "specific sliding")
    panel.legend(fontsize=7.5, loc="lower right")
    return figure


# What the weights choose: places on the front, and the optimum over all weights there are

MANY = 72  # weights along each side of the triangle
GRID = 401
OBJECTIVE = ("shift_sum", "stress_difference", "sliding_difference")
MARKS = {"own_ranges": ("o", ORANGE), "printed_ranges": ("s", GREEN), "printed": ("^", INK)}
SIDES = (0.0 + 0.0j, 1.0 + 0.0j, 0.5 + 0.5j * np.sqrt(3.0))  # all weight on the sum, on the stresses, on the sliding


def front_figure(chosen: "ChosenShift", field: Field, optimum: "Optimum | None") -> "Figure":
    """Draw the objectives against one another along the shift, and where the weights choose."""
    figure, rows = panels(2, 6.2)
    course = field.course
    found = {reading: grid_optimum(field, weights_of(reading, field.ranges)) for reading in READINGS}
    for panel, other, label in zip(rows, (0, 2), ("sum of the shifts", "difference of sliding"), strict=True):
        panel.plot(course.objectives[1], course.objectives[other], color=BLUE, linewidth=1.4,
                   label="all shifts that keep every limit")  # fmt: skip
        if optimum is not None and optimum.front and {aim.name for aim in optimum.aims} >= {OBJECTIVE[0], OBJECTIVE[1]}:
            panel.plot(*_designs(optimum, other), ".", color=GREY, markersize=5, label="front found by the search")
        at = course_of(chosen.inputs, np.array([float(chosen.inputs.roller_shift)])).objectives[:, 0]
        panel.plot(at[1], at[other], "X", markersize=8, color=INK, linestyle="", label="as stated")
        for size, (reading, shift) in enumerate(found.items()):
            marker, colour = MARKS[reading]
            at = course_of(chosen.inputs, np.array([shift])).objectives[:, 0]
            panel.plot(at[1], at[other], marker, markersize=13 - 3.5 * size, color=colour, fillstyle="none",
                       markeredgewidth=1.6, linestyle="", label=f"{READING[reading]}: {signed(shift)}")  # fmt: skip
        quiet(panel, "difference of the root stresses, MPa", label)
    rows[0].legend(fontsize=7.5, loc="upper left")
    return figure


def _designs(optimum: "Optimum", other: int) -> tuple[list[float], list[float]]:
    return (
        [design.objectives[OBJECTIVE[1]] / 1e6 for design in optimum.front],
        [design.objectives.get(OBJECTIVE[other], float("nan")) for design in optimum.front],
    )


def triangle(field: Field) -> tuple[Array, Array]:
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
        for number, sense in enumerate(SENSES)
    ]
    best = np.argmin(shares @ np.array(parts), axis=1)
    return shares, course.shifts[places][best]


def triangle_figure(chosen: "ChosenShift", field: Field) -> "Figure":
    """Draw the chosen shift over all weights; only their ratios matter, so they fill a triangle."""
    shares, shifts = triangle(field)
    figure, panel = panels(1, 4.6)
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
