"""Sun and planets to scale, and the mesh of one pair with the path of contact."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from gear_geometry.roots import Rack
from rv_gearing.drawn_look import BLUE, GREY, INK, MM, ORANGE, PLANET_FILL, SUN_FILL, WIDTH, Run, number, rack_of
from rv_gearing.quantities import Gearing
from rv_gearing.tooth_form import Values, gear, half_space, tooth, turned

COARSE, FINE = 10, 90  # points of a flank
CLOSE = 3.1  # modules around the pitch point that are shown of the mesh
NAMES = {"A": (-9, -11), "B": (-9, 6), "C": (8, -10), "D": (7, -11), "E": (7, 5)}


@dataclass(frozen=True, kw_only=True)
class Wheel:
    """One gear in the transverse section, in mm; a flank stands on the pitch point.

    ``outline`` (2, points) is the whole gear, coarsely; ``teeth`` those around the pitch point, finely.
    """

    outline: "Values"
    teeth: "Values"
    base: float
    tip: float
    pitch: float


@dataclass(frozen=True, kw_only=True)
class Meshing:
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


def meshing_of(record: "Run", stage: "Gearing") -> Meshing:
    """Both gears of the run, the planet above the sun, a flank of each on the pitch point."""
    unit = MM * float(stage.module) / float(np.cos(stage.helix_angle))
    distance, base_sun, base_planet = (
        MM * number(record, name) for name in ("centre_distance", "base_diameter_sun", "base_diameter_planet")
    )
    pitch_sun = distance * base_sun / (base_sun + base_planet)
    pitches = {"sun": pitch_sun, "planet": distance - pitch_sun}
    wheels = {name: _wheel(record, stage, name, pitch, unit) for name, pitch in pitches.items()}
    return Meshing(
        sun=wheels["sun"],
        planet=wheels["planet"],
        distance=distance,
        angle=number(record, "working_angle"),
        base_pitch=MM * number(record, "base_pitch"),
        module=unit,
        planets=stage.planets,
    )


def _wheel(record: "Run", stage: "Gearing", name: str, pitch: float, unit: float) -> Wheel:
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


def _transverse(record: "Run", stage: "Gearing", name: str) -> tuple[Rack, float]:
    """Rack and shift in the transverse section, in transverse modules; of helical teeth the fillet only nearly."""
    normal, cosine = rack_of(stage), float(np.cos(stage.helix_angle))
    rack = Rack(
        dedendum=normal.dedendum * cosine,
        fillet=normal.fillet * cosine,
        pressure_angle=number(record, "transverse_angle"),
    )
    return rack, float(getattr(stage, name).shift) * cosine


def mesh_figure(meshing: Meshing) -> "Figure":
    """Draw the whole stage on the left, and on the right what happens around the pitch point."""
    figure = Figure(figsize=(WIDTH, 3.5), layout="constrained")
    stage, close = figure.subplots(1, 2, width_ratios=(1.0, 1.12))
    _stage(stage, meshing)
    _close(close, meshing)
    for panel in (stage, close):
        panel.set_aspect("equal")
        panel.set_xlabel("mm")
        panel.grid(alpha=0.3)
        panel.set_axisbelow(True)
    return figure


def _fill(panel: Any, outline: "Values", colours: tuple[str, str], width: float) -> None:
    panel.fill(*outline, facecolor=colours[0], edgecolor=colours[1], linewidth=width, zorder=2)


def _stage(panel: Any, meshing: Meshing) -> None:
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


def _close(panel: Any, meshing: Meshing) -> None:
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
