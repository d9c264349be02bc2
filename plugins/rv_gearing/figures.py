"""The figures of the sheet: groups, sun and planets to scale, the mesh, safeties, and the critical tooth sections."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from gear_geometry.drawing import BLUE, GREY, INK, ORANGE, PALE, panels, quiet
from gear_geometry.roots import Arm, Rack, Root, external_arm, external_root
from rv_gearing.flank import blok, path_of, softness_of
from rv_gearing.geometry import gear, half_space, tooth, turned
from rv_gearing.groups import FoundGroups, centre_distance_window, pin_circle_factors
from rv_gearing.quantities import Gearing
from rv_gearing.rating import SAFETIES, Strength, rv_gearing
from truing import Array, Record, Swept

GearingRun = Record[Gearing, Strength]

SUN_FILL, PLANET_FILL = PALE, "#fbeee3"
MM, MPA = 1e3, 1e-6


def number(record: "GearingRun", name: str) -> float:
    """One result, SI."""
    return float(record.answers[name])


def rack_of(stage: Gearing) -> Rack:
    """The rack of both gears in the normal section, in modules."""
    return Rack(dedendum=float(stage.dedendum), fillet=float(stage.fillet), pressure_angle=float(stage.pressure_angle))


# The groups that the search finds: where they lie in the window, and how hard each is loaded

MOST_NUMBERED = 40
MOST_TICKS = 30


def groups_figure(found: "FoundGroups") -> "Figure":
    """Draw the centre distance of every group over the deviation of its ratio, with the limits of both."""
    figure, panel = panels(1, 3.7)
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
    panel.set_xlim(-1.12 * limit, 1.12 * limit)
    panel.set_ylim(low - 0.08 * (high - low), high + 0.08 * (high - low))
    quiet(panel, "deviation of the ratio, %", "centre distance, mm", alpha=0.35)
    return figure


def _numbers(panel: Any, found: "FoundGroups", deviation: "Array", centre: "Array") -> None:
    """The number of each group beside it, where there is room for them."""
    if len(deviation) > MOST_NUMBERED:
        return
    for number, across, up in zip(found.numbers, deviation, centre, strict=True):
        panel.annotate(f"{number:.0f}", (across, up), (5, -3), textcoords="offset points", fontsize=7.5, color=INK)


def _rated(panel: Any, found: "FoundGroups", deviation: "Array", centre: "Array") -> None:
    """A ring around the group that is rated."""
    chosen = found.numbers == (found.rated or 0)
    if np.any(chosen):
        panel.plot(deviation[chosen], centre[chosen], "o", markersize=11, fillstyle="none", color=ORANGE,
                   markeredgewidth=1.6, zorder=5)  # fmt: skip
        panel.annotate("rated", (float(deviation[chosen][0]), float(centre[chosen][0])), (-9, 3), ha="right",
                       textcoords="offset points", fontsize=8, color=ORANGE)  # fmt: skip


def window_words(found: "FoundGroups") -> str:
    """The range of pin circles that the torque admits, in words."""
    torque = float(np.mean(found.groups.torque))
    low, high = (MM * float(factor) * torque ** (1 / 3) for factor in pin_circle_factors(found.inputs))
    circles = f"{low:.2f} mm" if low == high else f"{low:.2f} to {high:.2f} mm"
    return f"Output torque {torque:.2f} N m; pin circle radius by equation 4: {circles}."


def front_figure(found: "FoundGroups") -> "Figure":
    """Draw strength over size: groups that no other beats filled, by deviation of the ratio; the others hollow."""
    figure, panel = panels(1, 3.4)
    centre, reserve = MM * found.groups.centre_distance, found.column("reserve")
    distance = found.column("from_best")
    front, hunting = np.isfinite(distance), found.groups.common_first == 1.0
    panel.plot(centre[~front], reserve[~front], "o", markersize=4, fillstyle="none", color=GREY, markeredgewidth=0.8)
    for kind, marker, words in ((hunting, "o", "hunting teeth"), (~hunting, "s", "common factor")):
        shown = front & kind
        marks = panel.scatter(centre[shown], reserve[shown], s=26, marker=marker, cmap="viridis_r", zorder=4,
                              label=words, c=100.0 * np.abs(found.groups.deviation[shown]), vmin=0.0,
                              vmax=100.0 * float(found.inputs.ratio_tolerance), linewidths=0)  # fmt: skip
    figure.colorbar(marks, ax=panel, label="deviation of the ratio, %", pad=0.01)
    _numbers(panel, found, centre, reserve)
    if front.any():
        best = int(np.nanargmin(distance))
        panel.plot(centre[best], reserve[best], "o", markersize=12, fillstyle="none", color=ORANGE, markeredgewidth=1.6)
        panel.annotate("nearest to the best", (centre[best], reserve[best]), (-9, 6), ha="right", fontsize=8,
                       textcoords="offset points", color=ORANGE)  # fmt: skip
    panel.axhline(1.0, color=INK, linewidth=0.9, linestyle=(0, (6, 3)))
    panel.legend(frameon=False, loc="lower right")
    quiet(panel, "centre distance, mm", "least safety over what is asked", alpha=0.35)
    return figure


def heat_figure(stage: "Gearing") -> "Figure":
    """Draw the flash temperature along the path of contact, and the share of the load that one pair carries there."""
    found = rv_gearing(stage)
    path = path_of(stage, found.duty, found.mesh, (found.sun.size, found.planet.size))
    along = MM * (path.radii[0] - 0.5 * found.sun.size.base_diameter * np.tan(found.mesh.working_angle))
    normal = found.flank.flank_load / np.cos(found.mesh.transverse_angle)
    rises = found.flank.flank_friction * blok(normal * path.share, path.radii, path.speeds, softness_of(stage))
    figure, panel = panels(1, 2.8)
    panel.fill_between(along, rises, color=PALE, linewidth=0)
    panel.plot(along, rises, color=BLUE, marker="o", markersize=3)
    panel.axhline(float(found.flank.mean_flash_temperature), color=BLUE, linewidth=0.9, linestyle=(0, (2, 2)))
    panel.axvline(0.0, color=INK, linewidth=0.9, linestyle=(0, (6, 3)))
    quiet(panel, "from the pitch point towards the tip of the sun, mm", "flash temperature, K", alpha=0.35)
    panel.set_ylim(0, None)
    other = panel.twinx()
    other.plot(along, path.share, color=ORANGE, linewidth=1.0)
    other.set_ylim(0, 1.6)
    other.set_ylabel("share of the load", color=ORANGE)
    return figure


def stresses_figure(found: "FoundGroups") -> "Figure":
    """Draw the root and contact stresses of all groups below what each of them may be."""
    figure, (upper, lower) = panels(2, 4.8, sharex=True)
    order = np.argsort(found.numbers)
    places = np.arange(len(order))
    for panel, kind in ((upper, "root"), (lower, "contact")):
        for wheel, colour, marker in (("sun", BLUE, "o"), ("planet", ORANGE, "s")):
            stress, permitted = (
                MPA * found.strength[f"{word}{kind}_stress_{wheel}"][order] for word in ("", "permitted_")
            )
            panel.plot(places, stress, marker, markersize=4, color=colour, label=wheel)
            panel.step(places, permitted, where="mid", color=colour, linewidth=1.0, linestyle=(0, (5, 2)),
                       label=f"{wheel}, permissible")  # fmt: skip
        quiet(panel, "", f"{kind} stress, MPa", alpha=0.35)
        panel.set_ylim(0, None)
    upper.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.22), handlelength=1.8, columnspacing=1.3)
    _ticks(lower, found, order)
    return figure


def _ticks(panel: Any, found: "FoundGroups", order: "NDArray[np.intp]") -> None:
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


# Sun and planets to scale, and the mesh of one pair with the path of contact

COARSE, FINE = 10, 90  # points of a flank
CLOSE = 3.1  # modules around the pitch point that are shown of the mesh
NAMES = {"A": (-9, -11), "B": (-9, 6), "C": (8, -10), "D": (7, -11), "E": (7, 5)}


@dataclass(frozen=True, kw_only=True)
class Wheel:
    """One gear in the transverse section, in mm; a flank stands on the pitch point.

    ``outline`` (2, points) is the whole gear, coarsely; ``teeth`` those around the pitch point, finely.
    """

    outline: "Array"
    teeth: "Array"
    base: float
    tip: float
    pitch: float


@dataclass(frozen=True, kw_only=True)
class MeshFigure:
    """Both gears about their own centres, centre distance in mm, working pressure angle, and planets around the sun."""

    sun: Wheel
    planet: Wheel
    distance: float
    angle: float
    base_pitch: float
    module: float
    planets: int

    def path(self) -> dict[str, float]:
        """Points of the path of contact by their distance from the pitch point, mm, outward from the sun."""
        ends = {}
        for name, wheel, sign in (("E", self.sun, 1.0), ("A", self.planet, -1.0)):
            inner = wheel.base * np.tan(self.angle)
            ends[name] = sign * float(np.sqrt(wheel.tip**2 - wheel.base**2) - inner)
        single = {"B": ends["E"] - self.base_pitch, "D": ends["A"] + self.base_pitch}
        between = single if ends["E"] - ends["A"] < 2.0 * self.base_pitch else {}
        return {**ends, **between, "C": 0.0}

    def place(self, along: float) -> tuple[float, float]:
        """Where a point of the line of action lies, mm from the centre of the sun."""
        return along * float(np.cos(self.angle)), self.sun.pitch + along * float(np.sin(self.angle))


def meshing_of(record: "GearingRun", stage: "Gearing") -> MeshFigure:
    """Both gears of the run, the planet above the sun, a flank of each on the pitch point."""
    unit = MM * float(stage.module) / float(np.cos(stage.helix_angle))
    distance, base_sun, base_planet = (
        MM * number(record, name) for name in ("centre_distance", "base_diameter_sun", "base_diameter_planet")
    )
    pitch_sun = distance * base_sun / (base_sun + base_planet)
    pitches = {"sun": pitch_sun, "planet": distance - pitch_sun}
    wheels = {name: _wheel(record, stage, name, pitch, unit) for name, pitch in pitches.items()}
    return MeshFigure(
        sun=wheels["sun"],
        planet=wheels["planet"],
        distance=distance,
        angle=number(record, "working_angle"),
        base_pitch=MM * number(record, "base_pitch"),
        module=unit,
        planets=stage.planets,
    )


def _wheel(record: "GearingRun", stage: "Gearing", name: str, pitch: float, unit: float) -> Wheel:
    """One gear whose flank stands on the pitch point: the sun's above its centre, the planet's below."""
    teeth, tip = number(record, f"teeth_{name}"), MM * number(record, f"tip_diameter_{name}") / 2.0
    rack, shift = _transverse(record, stage, name)
    half = float(np.pi / teeth - half_space(rack, teeth, shift, np.array([pitch / unit]))[0])
    turn = half + (np.pi if name == "planet" else 0.0)
    coarse, fine = (tooth(rack, teeth, shift, tip / unit, points) for points in (COARSE, FINE))
    return Wheel(
        outline=unit * turned(gear(coarse, teeth), turn),
        teeth=unit * turned(gear(fine, teeth, _around(teeth, pitch / unit)), turn),
        base=MM * number(record, f"base_diameter_{name}") / 2.0,
        tip=tip,
        pitch=pitch,
    )


def _around(teeth: float, pitch: float) -> int | None:
    """How many teeth to either side of the pitch point fill the view; None for all of a small gear."""
    inner = pitch - CLOSE
    if inner < 0.5 * CLOSE:
        return None
    return int(np.ceil(np.arctan2(1.1 * CLOSE, inner) * teeth / (2.0 * np.pi))) + 1


def _transverse(record: "GearingRun", stage: "Gearing", name: str) -> tuple[Rack, float]:
    """Rack and shift in the transverse section, in transverse modules; of helical teeth the fillet only nearly."""
    normal, cosine = rack_of(stage), float(np.cos(stage.helix_angle))
    rack = Rack(
        dedendum=normal.dedendum * cosine,
        fillet=normal.fillet * cosine,
        pressure_angle=number(record, "transverse_angle"),
    )
    return rack, float(getattr(stage, name).shift) * cosine


def mesh_figure(meshing: MeshFigure) -> "Figure":
    """Draw the whole stage on the left, and on the right what happens around the pitch point."""
    figure, (stage, close) = panels(1, 3.5, 2, width_ratios=(1.0, 1.12))
    _stage(stage, meshing)
    _close(close, meshing)
    for panel in (stage, close):
        panel.set_aspect("equal")
        quiet(panel, "mm", alpha=0.3)
    return figure


def _fill(panel: Any, outline: "Array", colours: tuple[str, str], width: float) -> None:
    panel.fill(*outline, facecolor=colours[0], edgecolor=colours[1], linewidth=width, zorder=2)


def _stage(panel: Any, meshing: MeshFigure) -> None:
    """Sun, planets and the circle of their centres, which turns with the output."""
    _fill(panel, meshing.sun.outline, (SUN_FILL, BLUE), 0.8)
    above = meshing.planet.outline + np.array([[0.0], [meshing.distance]])
    for place in range(meshing.planets):
        angle = 2.0 * np.pi * place / meshing.planets
        _fill(panel, turned(above, angle), (PLANET_FILL, ORANGE), 0.8)
        centre = turned(np.array([[0.0], [meshing.distance]]), angle)
        panel.plot(*centre, "+", color=INK, markersize=6, zorder=4)
    panel.plot(0.0, 0.0, "+", color=INK, markersize=6, zorder=4)
    panel.add_patch(Circle((0, 0), meshing.distance, fill=False, edgecolor=GREY, linewidth=0.8, linestyle=(0, (6, 3))))
    panel.set_title(f"to scale; centre distance {meshing.distance:.3f} mm", fontsize=8.5, loc="left")
    reach = 1.03 * (meshing.distance + meshing.planet.tip)
    panel.set_ylim(-reach, reach)
    side = reach if meshing.planets > 2 else 1.03 * max(meshing.planet.tip, meshing.distance)
    panel.set_xlim(-side, side)


def _close(panel: Any, meshing: MeshFigure) -> None:
    """Flanks around the pitch point, the line of action between the base circles and the path of contact on it."""
    _fill(panel, meshing.sun.teeth, (SUN_FILL, BLUE), 1.2)
    _fill(panel, meshing.planet.teeth + np.array([[0.0], [meshing.distance]]), (PLANET_FILL, ORANGE), 1.2)
    for height, wheel, colour in ((0.0, meshing.sun, BLUE), (meshing.distance, meshing.planet, ORANGE)):
        for radius, dashes in ((wheel.base, (0, (1, 2))), (wheel.pitch, (0, (7, 2, 1, 2)))):
            panel.add_patch(
                Circle((0, height), radius, fill=False, edgecolor=colour, linewidth=0.8, linestyle=dashes, zorder=3)
            )
    ends = (-meshing.sun.base * np.tan(meshing.angle), meshing.planet.base * np.tan(meshing.angle))
    path = meshing.path()
    for between, width in ((ends, 0.7), ((path["A"], path["E"]), 2.0)):
        points = np.array([meshing.place(float(end)) for end in between]).T
        panel.plot(*points, color=INK, linewidth=width, zorder=5)
    for name, along in path.items():
        point = meshing.place(along)
        panel.plot(*point, "o", markersize=3.6, markerfacecolor="white", markeredgecolor=INK, zorder=6)
        panel.annotate(
            name, point, NAMES[name], textcoords="offset points", fontsize=8.5, ha="center", va="center", zorder=7,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6},
        )  # fmt: skip
    reach = CLOSE * meshing.module
    panel.set_xlim(-reach, reach)
    panel.set_ylim(meshing.sun.pitch - reach, meshing.sun.pitch + reach)
    panel.set_title(f"mesh at {np.degrees(meshing.angle):.3f}° working pressure angle", fontsize=8.5, loc="left")


# How the safeties run over load and face width

LOOKS = {
    "root_safety_sun": (BLUE, "-", "sun, breakage"),
    "root_safety_planet": (ORANGE, "-", "planet, breakage"),
    "contact_safety_sun": (BLUE, "--", "sun, pitting"),
    "contact_safety_planet": (ORANGE, "--", "planet, pitting"),
}
RANGE = (0.7, 12.0)
TICKS = (0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
AXES = {
    "load_torque": ("output torque, N m", 1.0),
    "stated_sun_torque": ("torque of the sun, N m", 1.0),
    "face_width": ("face width, mm", MM),
    "power": ("input power, kW", 1e-3),
    "working_life": ("working time, h", 1.0 / 3600.0),
}


def safeties_figure(swept: "Swept", here: float) -> "Figure":
    """Draw the four safeties along the swept input, with what is asked of them and the value of the run."""
    figure, panel = panels(1, 3.2)
    label, factor = AXES.get(swept.over, (swept.over.replace("_", " "), 1.0))
    axis = factor * swept.axis
    for name in SAFETIES:
        if name in swept.results:
            colour, dashes, words = LOOKS[name]
            panel.plot(axis, swept.results[name], color=colour, linestyle=dashes, label=words)
    stage: Any = swept.inputs
    asked = ((stage.least_bending_safety, "S_{Fmin}"), (stage.least_contact_safety, "S_{Hmin}"))
    for level, symbol in asked:
        panel.axhline(float(level), color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        above = float(level) == max(float(one) for one, _ in asked)
        panel.annotate(f"${symbol}$", (1.0, float(level)), (3, 4 if above else -4), textcoords="offset points",
                       xycoords=("axes fraction", "data"), fontsize=8, va="center")  # fmt: skip
    if swept.axis.min() <= here <= swept.axis.max():
        panel.axvline(factor * here, color=INK, linewidth=0.8, linestyle=(0, (6, 3)))
        panel.annotate("this run", (factor * here, 1.0), (3, -9), textcoords="offset points", fontsize=8,
                       xycoords=("data", "axes fraction"))  # fmt: skip
    panel.set_xlim(float(axis.min()), float(axis.max()))
    panel.set_yscale("log")
    panel.set_ylim(*RANGE)
    panel.set_yticks(TICKS, [f"{tick:g}" for tick in TICKS])
    panel.set_yticks([], minor=True)
    quiet(panel, label, "safety", alpha=0.35)
    panel.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.15), handlelength=1.8, columnspacing=1.2)
    return figure


# The critical section of both teeth: root chord, fillet, and the arm of the force at the tip and at single contact

ARROW = 0.95  # modules
BELOW = -0.9  # modules; where the rim is cut off


@dataclass(frozen=True, kw_only=True)
class Notched:
    """One tooth of the virtual spur gear: outline in modules, root, force at the tip and at outer single contact."""

    name: str
    outline: "Array"
    root: Root
    tip: tuple[float, Arm]
    single: tuple[float, Arm] | None
    module: float


def notched_of(record: "GearingRun", stage: "Gearing") -> tuple[Notched, Notched]:
    """The teeth of sun and planet."""
    sun, planet = (_notched(record, stage, name) for name in ("sun", "planet"))
    return sun, planet


def _notched(record: "GearingRun", stage: "Gearing", name: str) -> Notched:
    rack, shift, teeth = rack_of(stage), float(getattr(stage, name).shift), number(record, f"virtual_teeth_{name}")
    module = float(stage.module)
    higher = (number(record, f"tip_diameter_{name}") - number(record, f"reference_diameter_{name}")) / module
    tip = teeth + higher
    root = external_root(rack, teeth, shift)
    outer = number(record, f"outer_diameter_{name}") / module
    has_single = 1.0 < number(record, "virtual_contact_ratio") < 2.0  # else two pairs always carry
    return Notched(
        name=name,
        outline=tooth(rack, teeth, shift, 0.5 * tip),
        root=root,
        tip=(tip, external_arm(rack, teeth, shift, root, tip)),
        single=(outer, external_arm(rack, teeth, shift, root, outer)) if has_single else None,
        module=MM * module,
    )


def root_figure(teeth: tuple[Notched, Notched]) -> "Figure":
    """Draw both teeth to one scale with what the form factors are made from."""
    figure, both = panels(1, 2.95, 2)
    colours = ((SUN_FILL, BLUE), (PLANET_FILL, ORANGE))
    top = max(float(_down(one.outline, float(one.root.depth))[1].max()) for one in teeth)
    for panel, one, (fill, edge) in zip(both, teeth, colours, strict=True):
        _tooth(panel, one, fill, edge)
        panel.set_ylim(0.8 * BELOW, top + 0.95)
    return figure


def _tooth(panel: Any, one: Notched, fill: str, edge: str) -> None:
    depth = float(one.root.depth)
    outline = _down(one.outline, depth)
    below = np.array([outline[0, [-1, 0]], [BELOW, BELOW]])
    panel.fill(*np.concatenate([outline, below], axis=1), facecolor=fill, edgecolor=edge, linewidth=1.3, zorder=2)
    _chord(panel, one)
    if one.single is not None:
        _force(panel, one.single, depth, GREY, "single contact")
    _force(panel, one.tip, depth, INK, "tip")
    _arm(panel, float(one.tip[1].height))
    panel.axvline(0.0, color=INK, linewidth=0.6, linestyle=(0, (8, 3, 1, 3)), zorder=3)
    panel.set_aspect("equal")
    panel.set_xlim(-2.5, 2.7)
    quiet(panel, f"modules of {one.module:g} mm", alpha=0.3)
    chord, arm = float(one.root.chord) * one.module, float(one.tip[1].height) * one.module
    panel.set_title(f"{one.name}: chord {chord:.3f} mm, arm {arm:.3f} mm", fontsize=8.5, loc="left", color=edge)


def _down(points: "Array", depth: float) -> "Array":
    """With the critical section at height 0."""
    value: Array = points - np.array([[0.0], [depth]])
    return value


def _chord(panel: Any, one: Notched) -> None:
    """The chord between the points where tangents of 30 degrees touch the fillets, and these tangents."""
    half = 0.5 * float(one.root.chord)
    panel.plot([-half, half], [0.0, 0.0], color=INK, linewidth=1.4, zorder=5)
    panel.annotate(r"$s_{Fn}$", (-0.42 * half, 0.0), (0, 4), textcoords="offset points", fontsize=9, ha="center")
    for side in (-1.0, 1.0):
        slope = np.tan(np.pi / 6.0)
        heights = np.array([-0.5, 1.6])
        panel.plot(side * (half - slope * heights), heights, color=GREY, linewidth=0.8, zorder=4)


def _force(panel: Any, at: tuple[float, Arm], depth: float, colour: str, words: str) -> None:
    """The force, along its line through the flank on the right to the axis of the tooth."""
    diameter, arm = at
    height, angle = float(arm.height), float(arm.angle)
    on_axis = np.array([0.0, height])
    way = np.array([-np.cos(angle), -np.sin(angle)])
    start = on_axis + np.array([0.0, depth])
    along = float(start @ way)
    reach = along + float(np.sqrt(along**2 - start @ start + (0.5 * diameter) ** 2))  # back to the circle of the force
    flank = on_axis - reach * way
    panel.plot(*np.array([flank, on_axis]).T, color=colour, linewidth=0.8, linestyle=(0, (4, 2)), zorder=4)
    panel.annotate(
        "", tuple(flank), tuple(flank - ARROW * way), zorder=6,
        arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.5, "shrinkA": 0, "shrinkB": 0,
                    "mutation_scale": 9},
    )  # fmt: skip
    panel.annotate(words, tuple(flank - ARROW * way), (2, 1), textcoords="offset points", fontsize=7.5,
                   color=colour, ha="left", va="bottom")  # fmt: skip


def _arm(panel: Any, height: float) -> None:
    """The bending arm as a dimension on the axis."""
    panel.annotate(
        "", (0.0, 0.0), (0.0, height), zorder=6,
        arrowprops={"arrowstyle": "<|-|>", "color": INK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0,
                    "mutation_scale": 7},
    )  # fmt: skip
    panel.annotate(r"$h_{Fa}$", (0.0, 0.55 * height), (-4, 0), textcoords="offset points", fontsize=9, ha="right")
