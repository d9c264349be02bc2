"""The figures of the sheet: the mesh to scale, along the flank, what scatter does, better tolerances."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle
from numpy.typing import ArrayLike, NDArray

from gear_geometry.drawing import BLUE, GREEN, GREY, INK, ORANGE, PALE, WIDTH, panels, quiet, signed
from rv_wear import geometry
from rv_wear.calculation import rv_wear
from rv_wear.costs import PRICED, Bill, price
from rv_wear.discs import Ground, clearance_over_angle, flank
from rv_wear.exact_play import Played
from rv_wear.geometry import Mesh, longest_arm_angle, mesh_of, relative_arm
from rv_wear.machines import Newborn
from rv_wear.optimum import CostFront, Fronts
from rv_wear.published import CHOSEN, COST, INDICES, RELIABILITY, WEAR
from rv_wear.quantities import Reducer, Wear
from rv_wear.spectrum import Spectrum
from truing import Array, Odds, Optimum, Record, Swept

ReducerRun = Record[Reducer, Wear]

MICRO, HOUR, ARCMIN = 1e-6, 3600.0, np.pi / 10800.0
SHADES = ("#12314d", "#1f5a8a", "#4f86b3", "#7d9a3c", "#c8941e", "#c8541e")
DASHES = ("-", "--", "-.", (0, (1, 1)), (0, (6, 1, 1, 1)), (0, (3, 1)))


def hours_of(reducer: Reducer) -> str:
    """The working time in words."""
    return f"{float(reducer.working_time) / HOUR:.4g} h"


def over_phase(panel: Any, label: str) -> None:
    """Axes over the phase angle."""
    panel.set_xlim(0, 180)
    panel.set_xticks(range(0, 181, 30))
    quiet(panel, "phase angle of the pin from the crank line, °", label)


def over_hours(panel: Any, hours: ArrayLike, label: str) -> None:
    """Axes over the working time."""
    panel.set_xlim(0, float(np.max(np.asarray(hours), initial=1.0)))
    quiet(panel, "working time, h", label)


def degrees(angle: ArrayLike) -> NDArray[np.float64]:
    """Angles in degrees."""
    return np.asarray(np.degrees(angle), dtype=float)


# The mesh to scale: one disc among its pins, the crank, and the forces of one position

Points = NDArray[np.complex128]
MM = 1e3
PROFILE_POINTS = 4000
LONGEST_ARROW = 0.26  # of the radius of the pin circle
SHOWN_ARM = np.radians(80.0)


@dataclass(frozen=True)
class FigurePosition:
    """One position, crank to the right, lengths in mm as complex numbers about the centre of the pins.

    Pins (z_p,), the disc's outline, its centre and the pitch point; of the loaded side the phase angles (k,), the
    contacts (k,) and the forces on the disc (k,) in N, which point from the pin to the pitch point.
    """

    pins: Points
    outline: Points
    centre: complex
    pitch_point: complex
    angle: NDArray[np.float64]
    contact: Points
    force: NDArray[np.float64]


def position_of(reducer: Reducer) -> FigurePosition:
    """The middle one of the positions that are calculated within one pin pitch."""
    mesh, new = mesh_of(reducer), flank(reducer)
    phases = mesh.choices.phases
    angle, force = (values.reshape(-1, phases)[:, phases // 2] for values in (new.angle, new.force[0]))
    circle, throw, count = float(mesh.pin_circle_radius), float(mesh.eccentricity), mesh.choices.pin_count
    pins = circle * np.exp(1j * (angle[0] + 2.0 * np.pi * np.arange(count) / count))
    turn = count * angle[0] / (count - 1)
    x, y = geometry.profile(mesh, np.linspace(0.0, 2.0 * np.pi, PROFILE_POINTS))
    outline = throw + np.exp(1j * turn) * (np.asarray(x) + 1j * np.asarray(y))
    pitch_point = throw * count
    loaded = circle * np.exp(1j * angle)
    to_pitch = (pitch_point - loaded) / np.abs(pitch_point - loaded)
    contact = np.asarray(loaded + float(mesh.pin_radius) * to_pitch, dtype=np.complex128)
    return FigurePosition(MM * pins, MM * outline, MM * throw, MM * pitch_point, angle, MM * contact, force)


def mesh_figure(reducer: Reducer) -> "Figure":
    """Draw pins, disc and crank to scale, with the forces of the new mesh in one position."""
    mesh, position = mesh_of(reducer), position_of(reducer)
    figure, panel = panels(1, 6.3)
    panel.set_aspect("equal")
    panel.fill(position.outline.real, position.outline.imag, facecolor=PALE, edgecolor=BLUE, linewidth=1.1, zorder=2)
    _pins(panel, position, MM * float(mesh.pin_radius))
    _forces(panel, position, MM * float(mesh.pin_radius))
    _angle_and_arm(panel, position)
    _centres(panel, position, mesh)
    reach = 1.04 * MM * (float(mesh.pin_circle_radius) + float(mesh.pin_radius))
    panel.set_xlim(-reach, reach)
    panel.set_ylim(-reach, reach)
    quiet(panel, "mm, along the crank line", "mm", alpha=0.3)
    return figure


def _pins(panel: Any, position: FigurePosition, radius: float) -> None:
    for place, pin in enumerate(position.pins):
        bears = place < len(position.force) and position.force[place] > 0.0
        panel.add_patch(
            Circle((pin.real, pin.imag), radius, facecolor="#f3d3bb" if bears else "white",
                   edgecolor=ORANGE if bears else GREY, linewidth=1.0, zorder=3)
        )  # fmt: skip


def _forces(panel: Any, position: FigurePosition, radius: float) -> None:
    """Arrows from the contacts along their lines of action, as long as the force is large."""
    largest = float(position.force.max(initial=0.0))
    if largest <= 0.0:
        return
    reach = LONGEST_ARROW * float(np.abs(position.pins).max())
    for contact, force in zip(position.contact, position.force, strict=True):
        if force <= 0.0:
            continue
        panel.plot(*_ends(contact, position.pitch_point), color=ORANGE, linewidth=0.5, alpha=0.7, zorder=4)
        way = (position.pitch_point - contact) / abs(position.pitch_point - contact)
        tip = contact + reach * force / largest * way
        panel.annotate(
            "", (tip.real, tip.imag), (contact.real, contact.imag), zorder=6,
            arrowprops={"arrowstyle": "-|>", "color": ORANGE, "linewidth": 1.5, "shrinkA": 0, "shrinkB": 0,
                        "mutation_scale": 7},
        )  # fmt: skip
    place = int(position.force.argmax())
    beside = position.pins[place] * (1.0 + radius / abs(position.pins[place]))
    panel.annotate(
        f"{largest:.0f} N", (beside.real, beside.imag), (4, 3), textcoords="offset points", color=ORANGE, fontsize=8.5,
    )  # fmt: skip


def _ends(first: complex, second: complex) -> tuple[list[float], list[float]]:
    return [first.real, second.real], [first.imag, second.imag]


def _angle_and_arm(panel: Any, position: FigurePosition) -> None:
    """The phase angle of one pin about the middle of the pins, and the arm of its force about that of the disc."""
    bearing = np.flatnonzero(position.force > 0.0)
    if not len(bearing):
        return
    place = bearing[np.abs(position.angle[bearing] - SHOWN_ARM).argmin()]
    pin, angle, contact = position.pins[place], position.angle[place], position.contact[place]
    panel.plot(*_ends(0j, pin), color=INK, linewidth=0.7, linestyle=(0, (6, 3)), zorder=4)
    size = 0.5 * abs(pin)
    panel.add_patch(Arc((0, 0), size, size, theta1=0, theta2=np.degrees(angle), color=INK, linewidth=0.9, zorder=5))
    middle = 0.29 * abs(pin) * np.exp(0.5j * angle)
    panel.text(middle.real, middle.imag, r"$\psi$", ha="center", va="center", fontsize=11, zorder=7)
    way = (position.pitch_point - contact) / abs(position.pitch_point - contact)
    foot = contact + ((position.centre - contact) * way.conjugate()).real * way
    panel.plot(*_ends(position.centre, foot), color=BLUE, linewidth=1.3, zorder=5)
    step = 0.035 * abs(pin)
    turned = (foot - position.centre) / abs(foot - position.centre)
    corner = np.array([foot - step * turned, foot - step * turned + step * way, foot + step * way])
    panel.plot(corner.real, corner.imag, color=BLUE, linewidth=0.9, zorder=5)
    panel.plot(*_ends(foot, position.pitch_point), color=ORANGE, linewidth=0.5, alpha=0.7, zorder=4)
    half = 0.5 * (position.centre + foot)
    panel.annotate(r"$l$", (half.real, half.imag), (3, -12), textcoords="offset points", color=BLUE, fontsize=11)


def _centres(panel: Any, position: FigurePosition, mesh: Mesh) -> None:
    """Both centres, the crank line, the pitch point, and the circle on which the longest arm ends."""
    reach = abs(position.pins[0])
    panel.plot([-reach, reach], [0, 0], color=INK, linewidth=0.7, linestyle=(0, (8, 3, 1, 3)), zorder=4)
    panel.add_patch(
        Circle((position.centre.real, 0.0), MM * float(mesh.longest_arm), fill=False, edgecolor=GREY, linewidth=0.8,
               linestyle=(0, (1, 2)), zorder=4)
    )  # fmt: skip
    for point, name, where in (
        (0.0, "centre of the pins", (-8, -42)),
        (position.centre.real, f"centre of the disc,\n{position.centre.real:.3g} mm beside it", (14, -58)),
        (position.pitch_point.real, "pitch point", (-4, -26)),
    ):
        panel.plot(point, 0.0, "o", markersize=4.2, markerfacecolor="white", markeredgecolor=INK, zorder=8)
        panel.annotate(
            name, (point, 0.0), where, textcoords="offset points", fontsize=8,
            ha="right" if where[0] < 0 else "left", va="top",
            arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.6, "shrinkB": 3},
            zorder=8, bbox={"facecolor": PALE, "edgecolor": "none", "pad": 1.0},
        )  # fmt: skip


# Along the flank: clearance, forces by both ways of sharing, forces and wear of differently ground discs

FINE = np.radians(np.linspace(0.0, 180.0, 361))


def clearance_figure(reducer: Reducer) -> "Figure":
    """Draw the clearance over the phase angle, new and worn, and the approach under load that closes it."""
    figure, panel = panels(1, 3.3)
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
    figure, panel = panels(1, 3.3)
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
    figure, (upper, lower) = panels(2, 5.6, sharex=True)
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
    figure, panel = panels(1, 3.1)
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
    figure, (upper, lower) = panels(2, 4.4, sharex=True)
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


# What scatter does: backlash of drawn machines, reliability over the hours, sensitivity indices, costs

FACTOR_WORDS = {
    1: "base tangent length", 2: "runout of the involute gears", 3: "centre distance", 4: "equidistant modification",
    5: "shift modification", 6: "radius of the pin circle", 7: "radius of the pins", 8: "fit of the pins",
    9: "runout of the cycloid disc", 10: "position of the pin holes", 11: "pitch of the cycloid disc",
    12: "equidistant modification as ground", 13: "shift modification as ground", 14: "throw of the crank",
    15: "wear", 16: "crank bearings",
}  # fmt: skip


def machines_figure(born: "Newborn") -> "Figure":
    """Draw the backlash of every machine, new, and the histograms of new and used ones with the limit."""
    figure, (left, right) = panels(1, 3.4, 2, sharey=True, width_ratios=(5, 2))
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
    quiet(left, "machine drawn", "backlash, arc minutes", axis="y")
    left.set_xlim(0, len(born.new) + 1)
    left.locator_params(axis="x", nbins=4, prune="upper")
    right.set_xlabel("number of machines")
    right.legend(loc="lower right")
    right.grid(axis="y", alpha=0.4)
    return figure


def play_figure(played: "Played") -> "Figure":
    """Draw the exact backlash over the crank, over a turn of the output, and the shares of the discs."""
    figure = Figure(figsize=(WIDTH, 4.4), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(3, 2))
    left, above, below = (figure.add_subplot(cell) for cell in (grid[:, 0], grid[0, 1], grid[1, 1]))
    crank = degrees(np.append(played.crank, 2.0 * np.pi))
    closed = np.concatenate([played.worn, played.worn[:1]]) / ARCMIN
    left.fill_between(crank, *np.percentile(closed, (5, 95), axis=1), color=BLUE, alpha=0.2, linewidth=0)
    left.plot(crank, np.append(played.alike, played.alike[:1]) / ARCMIN, color=INK, label="exact, all parts alike")
    left.plot(crank, closed[:, 0], color=BLUE, label="exact, one machine")
    left.axhline(played.linear / ARCMIN, color=ORANGE, linestyle="--", label="equation 21")
    left.set_xlim(0, 360)
    left.set_xticks(range(0, 361, 90))
    left.margins(y=0.25)
    left.legend(loc="upper right", fontsize=8)
    quiet(left, "angle of the crank, °", "backlash, arc minutes")
    above.plot(np.linspace(0, 360, len(played.whole), endpoint=False), played.whole / ARCMIN, color=BLUE, linewidth=0.5)
    above.set_xlim(0, 360)
    above.set_xticks(range(0, 361, 90))
    quiet(above, "angle of the output, °", "arc minutes")
    below.hist(100.0 * played.worse.reshape(-1), bins=30, color=BLUE, alpha=0.75)
    below.axvline(100.0 * played.torque_share, color=ORANGE, linestyle="--")
    quiet(below, "torque on the worse disc, %", "positions", axis="y")
    return figure


def life_figure(spectrum: "Spectrum") -> "Figure":
    """Draw the deepest wear of both flanks and the share of machines within the permitted backlash over the hours."""
    figure, (upper, lower) = panels(2, 4.4, sharex=True)
    times = spectrum.hours
    for worn, colour, words in zip(spectrum.flanks, (BLUE, ORANGE), ("forward", "back"), strict=True):
        upper.plot(times / HOUR, worn.after(times) / MICRO, color=colour, label=words)
    lower.plot(times / HOUR, 100.0 * np.asarray(spectrum.surviving(times)), color=BLUE)
    lower.axvline(float(spectrum.reducer.working_time) / HOUR, color=INK, linestyle="--", linewidth=0.9)
    over_hours(upper, times / HOUR, "deepest wear, µm")
    over_hours(lower, times / HOUR, "machines within the limit, %")
    upper.set_xlabel("")
    upper.legend(loc="upper left")
    return figure


def _edges(values: Array) -> Array:
    """Edges of some forty classes over all values; a single value gets one class of its own."""
    if not len(values):
        return np.array([0.0, 1.0])
    low, high = float(values.min()), float(values.max())
    room = max(0.02 * (high - low), 1e-4)
    return np.linspace(low - room, high + room, 45)


def reliability_figure(odds: "Odds", optimised: Mapping[str, tuple[Array, Array]] | None = None) -> "Figure":
    """Draw the reliability over the working time, with its interval, the goal, and the value that the paper prints.

    *optimised* names further curves, each hours and probabilities.
    """
    figure, panel = panels(1, 3.2)
    curve = odds.curve
    assert curve is not None  # drawn only where there is one
    hours = curve.axis / HOUR
    chance = 100 * curve.probability["backlash"]
    panel.plot(hours, chance, color=BLUE, marker="o", markersize=3, label="counted among the machines drawn")
    normal = 100 * np.asarray(curve.analytic["backlash"])
    panel.plot(hours, normal, color=GREY, linestyle="--", linewidth=1.0, label="normal distribution")
    lowest = [float(np.nanmin(chance))]
    looks = ((ORANGE, "-"), (GREEN, "-."), (INK, ":"))
    for (name, (at, shares)), (colour, dashes) in zip((optimised or {}).items(), looks, strict=False):
        panel.plot(at / HOUR, 100 * shares, color=colour, linestyle=dashes, label=name)
        lowest.append(float(100 * np.nanmin(shares)))
    goal = 100 * float(odds.inputs.required_reliability)
    panel.axhline(goal, color=INK, linewidth=0.8, linestyle=(0, (5, 3)))
    panel.text(0.01, goal, f"required {goal:g} %", va="bottom", fontsize=8, transform=panel.get_yaxis_transform())
    printed_at, share = 6000.0, float(RELIABILITY)
    panel.plot(printed_at, share, "D", markersize=8, fillstyle="none", color=ORANGE,
               label=f"the paper, {RELIABILITY} % at 6000 h")  # fmt: skip
    over_hours(panel, hours, "reliability, %")
    panel.set_xlim(0, 1.02 * max(float(hours.max()), printed_at))
    bottom: float = min([*lowest, goal, share])
    panel.set_ylim(max(-2.0, bottom - 0.08 * (100 - bottom) - 0.5), 100 + 0.06 * (100 - bottom) + 0.2)
    panel.legend(loc="lower left")
    return figure


def indices_figure(indices: Mapping[int, float]) -> "Figure":
    """Draw the sensitivity indices by their number as bars, with those of the paper's Table 2 as diamonds."""
    figure, panel = panels(1, 4.6)
    numbers = sorted(indices)
    places = range(len(numbers) - 1, -1, -1)
    values = [indices[number] for number in numbers]
    colours = [BLUE if value >= 0 else ORANGE for value in values]
    panel.barh(list(places), values, color=colours, height=0.62, alpha=0.85)
    told = {number: float(value) for number, value, *_ in INDICES}
    printed = [told[number] for number in numbers]
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
    quiet(panel, "change of backlash per change of the error, over that of factor 6", axis="x")
    panel.legend(loc="lower left")
    return figure


def costs_figure(bill: "Bill", form: str) -> "Figure":
    """Draw the price of every zone in one form of the cost functions, and what another width would cost."""
    figure, (left, right) = panels(1, 3.2, 2, width_ratios=(1, 1))
    _bars(left, {name: prices[form] for name, prices in bill.prices.items()}, "price of the zone, yuan")
    shares = np.linspace(0.5, 2.0, 61)
    first: dict[str, str] = {}  # zone of each cost function
    for name in bill.widths:
        first.setdefault(PRICED[name], name)
    for place, name in enumerate(first.values()):
        width = bill.widths[name]
        paid = [price(PRICED[name], form).at(float(share * width)) for share in shares]
        colour = (BLUE, ORANGE, GREEN)[place % 3]
        words = f"{name.replace('_', ' ')}, now {width / MICRO:.3g} µm"
        right.plot(shares, paid, color=colour, label=words)
        right.plot(1.0, bill.prices[name][form], "o", color=colour, markersize=5)
    quiet(right, "width of the zone over that now", "price of the zone, yuan")
    right.set_ylim(0, None)
    if right.get_legend_handles_labels()[0]:
        right.legend(fontsize=7)
    return figure


def _bars(panel: Any, values: Mapping[str, float], label: str) -> None:
    """Bars with their values, the longest on top."""
    ranked = sorted(values.items(), key=lambda item: item[1])
    panel.barh([name.replace("_", " ") for name, _ in ranked], [value for _, value in ranked], color=BLUE, height=0.66)
    for place, (_, value) in enumerate(ranked):
        panel.text(value, place, f" {value:.0f}", va="center", fontsize=7.5, color=INK)
    panel.set_xlim(0, 1.2 * max([value for _, value in ranked], default=1.0) or 1.0)
    panel.tick_params(axis="y", length=0, labelsize=8)
    quiet(panel, label, axis="x")


# Better tolerances: the fronts of cost and wear, and what they do to the reliability over the hours

PRINTED_OPTIMA = {float(goal): (float(cost), float(wear)) for _, goal, cost, wear, _ in CHOSEN}
"""Cost (yuan) and wear (um) of the paper's optima by required reliability; its 100 % is read as 0.999."""
LOOKS = ((BLUE, "o"), (GREEN, "s"), (ORANGE, "^"))


def fronts_figure(fronts: "Fronts", optimum: "Optimum | None", start: tuple[float, float]) -> "Figure":
    """Draw the wear over the cost: the least costs by goal, designs that a search found, and what the paper prints.

    *start* is the cost (yuan) and the wear (m) of the run.
    """
    figure, panel = panels(1, 4.2)
    for front, (colour, marker) in zip(fronts.fronts, LOOKS, strict=False):
        if not front.designs:
            continue
        cost, wear = _places(front)
        words = f"least cost for {_percent(front.goal)}"
        panel.plot(cost, wear, color=colour, marker=marker, markersize=3.5, label=words)
        if front.goal in PRINTED_OPTIMA:
            panel.plot(
                *PRINTED_OPTIMA[front.goal], "D", markersize=9, fillstyle="none", color=colour,
                label=f"the paper's optimum for {'100 %' if front.goal > 0.99 else _percent(front.goal)}",
            )  # fmt: skip
        if front.knee is not None:
            panel.plot(cost[front.knee], wear[front.knee], marker, markersize=10, fillstyle="none", color=colour)
        _modifications(panel, front)
    if optimum is not None and optimum.front:
        prices, depths = (
            [design.objectives[name] for design in optimum.front] for name in ("tolerance_price", "max_wear")
        )
        words = f"found by the search for {_percent(float(fronts.inputs.required_reliability))}"
        panel.plot(prices, np.divide(depths, MICRO), ".", color=GREY, markersize=3.0, label=words, zorder=1)
    panel.plot(start[0], start[1] / MICRO, "X", color=INK, markersize=8, linestyle="", label="as stated")
    printed = float(COST), float(WEAR)
    panel.plot(*printed, "D", markersize=9, fillstyle="none", color=INK, label="the paper, before", linestyle="")
    quiet(panel, "price of all zones, yuan", "deepest wear after the working time, µm")
    panel.margins(0.08)
    panel.legend(loc="upper right", fontsize=7.5)
    return figure


def _places(front: "CostFront") -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cost in yuan and wear in um of all designs."""
    return (
        np.array([design.cost for design in front.designs]),
        np.array([design.wear / MICRO for design in front.designs]),
    )


def _modifications(panel: Any, front: "CostFront") -> None:
    """The equidistant modification at both ends of a front and at its knee."""
    for place in sorted({0, front.knee or 0, len(front.designs) - 1}):
        design = front.designs[place]
        panel.annotate(
            f"{signed(design.modification / MICRO, '.1f')} µm", (design.cost, design.wear / MICRO), (8, 5),
            textcoords="offset points", fontsize=7, color=INK,
        )  # fmt: skip


def _percent(share: float) -> str:
    return f"{100 * share:g} %"


def better(fronts: "Fronts | None") -> Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Times (s) and reliabilities of the knee of each front."""
    found = {}
    for front in fronts.fronts if fronts is not None else ():
        if front.knee is None or not len(front.times):
            continue
        design = front.designs[front.knee]
        words = f"{design.cost:.0f} yuan, {signed(design.modification / MICRO, '.1f')} µm, for {_percent(front.goal)}"
        found[words] = (front.times, front.chances)
    return found


def at_printed_wear(front: "CostFront") -> float | None:
    """Our least cost at the wear of the paper's optimum, between the designs beside it; None beyond the front."""
    printed = PRINTED_OPTIMA.get(front.goal)
    if printed is None or len(front.designs) < 2:
        return None
    cost, wear = _places(front)
    return float(np.interp(printed[1], wear, cost)) if wear[0] <= printed[1] <= wear[-1] else None
