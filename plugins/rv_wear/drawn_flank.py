"""Along the flank: clearance, forces by both ways of sharing, forces and wear of differently ground discs."""

from dataclasses import replace
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rv_wear.calculation import rv_wear
from rv_wear.curves import clearance_over_angle, flank
from rv_wear.cycloid import longest_arm_angle, relative_arm
from rv_wear.drawn_look import (
    ARCMIN,
    BLUE,
    DASHES,
    GREY,
    HOUR,
    INK,
    MICRO,
    ORANGE,
    SHADES,
    WIDTH,
    degrees,
    hours_of,
    one_panel,
    over_hours,
    over_phase,
    signed,
)
from rv_wear.mesh import mesh_of
from rv_wear.modifications import Ground
from rv_wear.quantities import Reducer
from truing import Swept

FINE = np.radians(np.linspace(0.0, 180.0, 361))
Values = NDArray[np.float64]


def clearance_figure(reducer: Reducer) -> "Figure":
    """Draw the clearance over the phase angle, new and worn, and the approach under load that closes it."""
    figure, panel = one_panel(3.3)
    mesh = mesh_of(reducer)
    worn = flank(reducer, float(reducer.working_time))
    clear = clearance_over_angle(reducer, FINE)[0] / MICRO
    approach = float(rv_wear(reducer).approach) * np.asarray(relative_arm(mesh, FINE)) / MICRO
    panel.plot(degrees(FINE), clear, color=BLUE, label="clearance, new")
    if reducer.working_time > 0.0:
        words = f"and wear of {hours_of(reducer)}"
        panel.plot(degrees(worn.angle), worn.clearance[0] / MICRO, color=ORANGE, label=words)
    panel.plot(degrees(FINE), approach, color=INK, linestyle="--", linewidth=1.0, label="approach under load, new")
    panel.fill_between(degrees(FINE), clear, approach, where=clear < approach, color=BLUE, alpha=0.14, linewidth=0)
    longest = float(np.degrees(longest_arm_angle(mesh)))
    panel.axvline(longest, color=GREY, linewidth=0.8, linestyle=(0, (1, 2)))
    panel.text(longest + 1.0, 0.985, f"longest arm, {longest:.1f}°", fontsize=8, color=INK, va="top",
               transform=panel.get_xaxis_transform())  # fmt: skip
    over_phase(panel, "µm along the normal")
    highest = max(float(approach.max()), float(clear.max()), float(worn.clearance.max()) / MICRO)
    panel.set_ylim(0, 1.12 * highest)
    panel.legend(loc="upper center", bbox_to_anchor=(0.5, 1.14), ncols=3, handlelength=1.8, columnspacing=1.4)
    return figure


def sharing_figure(reducer: Reducer) -> "Figure":
    """Draw the forces of the new mesh by both ways of sharing, and after the working time by that of the run."""
    figure, panel = one_panel(3.3)
    looks: dict[Literal["linear", "hertz"], tuple[str, str, str]]
    looks = {"linear": (BLUE, "-", "in proportion to the approach"), "hertz": (GREY, "--", "Hertz at every pin")}
    for sharing, (colour, dashes, words) in looks.items():
        found = flank(replace(reducer, load_sharing=sharing))
        panel.plot(degrees(found.angle), found.force[0], color=colour, linestyle=dashes, label=f"new, {words}")
    if reducer.working_time > 0.0:
        worn = flank(reducer, float(reducer.working_time))
        panel.plot(degrees(worn.angle), worn.force[0], color=ORANGE, label=f"after {hours_of(reducer)}")
    over_phase(panel, "force on a pin, N")
    panel.set_ylim(0, None)
    panel.legend(loc="upper right")
    return figure


def difference_of_sharing(reducer: Reducer) -> tuple[float, float]:
    """How far the two ways are apart for the new mesh: their largest forces, and one pin at most.

    Both as shares of the largest force of the linear way; the first with its sign, Hertz against linear.
    """
    linear, hertz = (flank(replace(reducer, load_sharing=way)).force[0] for way in ("linear", "hertz"))
    largest = float(linear.max())
    return float(hertz.max()) / largest - 1.0, float(np.abs(hertz - linear).max()) / largest


def modifications_figure(ground: "Ground", own: Reducer) -> "Figure":
    """Draw the forces of the new discs over the phase angle and below them the wear, as the paper's Figs. 1 and 2."""
    figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    shift = float(own.equidistant_modification - own.shift_modification)
    angle = degrees(ground.new.angle)
    for place, modification in enumerate(ground.modifications):
        look: dict[str, Any] = {"color": SHADES[place % len(SHADES)], "linestyle": DASHES[place % len(DASHES)]}
        pair = f"{signed(modification / MICRO, '.1f')}, {signed((modification - shift) / MICRO, '.1f')}"
        upper.plot(angle, ground.new.force[place], label=pair, **look)
        lower.plot(angle, ground.worn.wear[place] / MICRO, **look)
    over_phase(upper, "force on a pin, N")
    over_phase(lower, f"wear after {ground.hours:g} h, µm")
    upper.set_xlabel("")
    for panel in (upper, lower):
        panel.set_ylim(0, None)
    upper.legend(title="equidistant, shift modification, µm", loc="upper right", title_fontsize=8)
    return figure


def wear_figure(reducer: Reducer) -> "Figure":
    """Draw the wear along the flank at four times up to the working time."""
    figure, panel = one_panel(3.1)
    whole = float(reducer.working_time)
    for share, colour, dashes in zip((0.25, 0.5, 0.75, 1.0), (*SHADES[2::-1], ORANGE), DASHES[3::-1], strict=True):
        found = flank(reducer, share * whole)
        hours = f"{share * whole / HOUR:.4g} h"
        panel.plot(degrees(found.angle), found.wear[0] / MICRO, color=colour, linestyle=dashes, label=hours)
    over_phase(panel, "wear of the flank, µm")
    panel.set_ylim(0, None)
    panel.legend(title="working time", title_fontsize=8, loc="upper right")
    return figure


def history_figure(swept: "Swept") -> "Figure":
    """Draw deepest wear and backlash over the working time."""
    figure = Figure(figsize=(WIDTH, 4.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    hours = swept.axis / HOUR
    upper.plot(hours, swept.results["max_wear"] / MICRO, color=BLUE)
    lower.plot(hours, swept.results["backlash"] / ARCMIN, color=ORANGE)
    limit = float(swept.inputs.permitted_backlash) / ARCMIN
    lower.axhline(limit, color=INK, linestyle="--", linewidth=0.9)
    lower.text(0.01, limit, f"permitted {limit:g}′", va="bottom", fontsize=8, transform=lower.get_yaxis_transform())
    over_hours(upper, hours, "deepest wear, µm")
    over_hours(lower, hours, "backlash, arc minutes")
    upper.set_xlabel("")
    upper.set_ylim(0, None)
    lower.margins(y=0.15)
    return figure
