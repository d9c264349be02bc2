"""Roller and ring to scale, and how their flanks slide along the path of contact."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from roller_screw_shift.drawn_look import BLUE, GREEN, GREY, INK, MM, ORANGE, panels, quiet
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.profiles import ring_half, roller_half, toothing
from roller_screw_shift.quantities import Pair
from roller_screw_shift.shifts import signed

PITCHES = 1.75  # shown on either side of the middle
POINTS = 121


def ring_shift(pair: Pair) -> float:
    """The shift of the ring that goes with that of the roller."""
    return float(np.asarray(geometry_of(pair).ring_shift))


def teeth_figure(pair: Pair, shifts: "Sequence[tuple[str, float]]") -> "Figure":
    """Draw the pair at each of these shifts (words, shift of the roller), all to one scale."""
    pitch = MM * float(np.pi * pair.module)
    reach = PITCHES * pitch
    figure, rows = panels(len(shifts), 3.15 * len(shifts), sharex=True)
    for panel, (words, shift) in zip(rows, shifts, strict=True):
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
    rows[-1].set_xlabel("mm")
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
class Path:
    """Places on the path of contact (n,), m from the pitch point outward, and the specific sliding of both there."""

    place: "NDArray[np.float64]"
    roller: "NDArray[np.float64]"
    ring: "NDArray[np.float64]"


def path_of(pair: Pair) -> Path:
    """Return the path from the tip of the ring to that of the roller; sliding is 1 - v_other/v_own, with its sign.

    Speeds along a flank are its radius of curvature times the speed of the gear; both turn against the carrier in the
    same sense.
    """
    geometry = geometry_of(pair)
    tangent = np.tan(float(np.asarray(geometry.mounted_angle)))
    roller, ring = geometry.roller, geometry.ring
    first = float(ring.base_radius) * (np.tan(float(ring.tip_angle)) - tangent)
    last = float(roller.base_radius) * (np.tan(float(roller.tip_angle)) - tangent)
    place = np.linspace(first, last, POINTS)
    at_roller = float(roller.base_radius) * tangent + place
    at_ring = float(ring.base_radius) * tangent + place
    ratio = float(pair.ring_teeth) / float(pair.roller_teeth)
    return Path(place, 1.0 - at_ring / (ratio * at_roller), 1.0 - ratio * at_roller / at_ring)


LOOKS = (("o", "white"), ("X", INK), ("D", ORANGE))


def sliding_figure(pair: Pair, shifts: "Sequence[tuple[str, float]]") -> "Figure":
    """Draw the specific sliding of both gears along the path of contact, and where the path ends by these shifts.

    The shift moves the ends of the path; the curves between them stay.
    """
    figure, (panel,) = panels(1, 3.8)
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
