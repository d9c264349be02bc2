"""The critical section of both teeth: root chord, fillet, and the arm of the force at the tip and at single contact."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_geometry.roots import Arm, Rack, Root, external_arm, external_root
from rv_gearing.drawn_look import BLUE, GREY, INK, MM, ORANGE, PLANET_FILL, SUN_FILL, WIDTH, Run, number, rack_of
from rv_gearing.quantities import Gearing
from rv_gearing.tooth_form import Values, tooth

ARROW = 0.95  # modules
BELOW = -0.9  # modules; where the rim is cut off


@dataclass(frozen=True, kw_only=True)
class Notched:
    """One tooth of the virtual spur gear: outline in modules, root, force at the tip and at outer single contact."""

    name: str
    outline: "Values"
    root: Root
    tip: tuple[float, Arm]
    single: tuple[float, Arm] | None
    module: float


def notched_of(record: "Run", stage: "Gearing") -> tuple[Notched, Notched]:
    """The teeth of sun and planet."""
    sun, planet = (_notched(record, stage, name) for name in ("sun", "planet"))
    return sun, planet


def _notched(record: "Run", stage: "Gearing", name: str) -> Notched:
    rack, shift, teeth = rack_of(stage), float(getattr(stage, name).shift), number(record, f"virtual_teeth_{name}")
    module = float(stage.module)
    higher = (number(record, f"tip_diameter_{name}") - number(record, f"reference_diameter_{name}")) / module
    tip = teeth + higher
    root = external_root(rack, teeth, shift)
    outer = _single(rack, teeth, tip, number(record, "virtual_contact_ratio"))
    return Notched(
        name=name,
        outline=tooth(rack, teeth, shift, 0.5 * tip),
        root=root,
        tip=(tip, external_arm(rack, teeth, shift, root, tip)),
        single=None if outer is None else (outer, external_arm(rack, teeth, shift, root, outer)),
        module=MM * module,
    )


def _single(rack: Rack, teeth: float, tip: float, contact_ratio: float) -> float | None:
    """Diameter at the outer point of single contact, in modules; None where two pairs always carry."""
    if not 1.0 < contact_ratio < 2.0:
        return None
    base, pitch = teeth * np.cos(rack.pressure_angle), np.pi * np.cos(rack.pressure_angle)
    along = 0.5 * np.sqrt(tip**2 - base**2) - pitch * (contact_ratio - 1.0)
    return float(np.hypot(2.0 * along, base))


def root_figure(teeth: tuple[Notched, Notched]) -> "Figure":
    """Draw both teeth to one scale with what the form factors are made from."""
    figure = Figure(figsize=(WIDTH, 2.95), layout="constrained")
    panels = figure.subplots(1, 2)
    colours = ((SUN_FILL, BLUE), (PLANET_FILL, ORANGE))
    top = max(float(_down(one.outline, float(one.root.depth))[1].max()) for one in teeth)
    for panel, one, (fill, edge) in zip(panels, teeth, colours, strict=True):
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
    panel.set_xlabel(f"modules of {one.module:g} mm")
    chord, arm = float(one.root.chord) * one.module, float(one.tip[1].height) * one.module
    panel.set_title(f"{one.name}: chord {chord:.3f} mm, arm {arm:.3f} mm", fontsize=8.5, loc="left", color=edge)
    panel.grid(alpha=0.3)
    panel.set_axisbelow(True)


def _down(points: "Values", depth: float) -> "Values":
    """With the critical section at height 0."""
    lowered: Values = points - np.array([[0.0], [depth]])
    return lowered


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
    reach = _to_circle(on_axis + np.array([0.0, depth]), way, 0.5 * diameter)
    flank = on_axis - reach * way
    panel.plot(*np.array([flank, on_axis]).T, color=colour, linewidth=0.8, linestyle=(0, (4, 2)), zorder=4)
    panel.annotate(
        "", tuple(flank), tuple(flank - ARROW * way), zorder=6,
        arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.5, "shrinkA": 0, "shrinkB": 0,
                    "mutation_scale": 9},
    )  # fmt: skip
    panel.annotate(words, tuple(flank - ARROW * way), (2, 1), textcoords="offset points", fontsize=7.5,
                   color=colour, ha="left", va="bottom")  # fmt: skip


def _to_circle(start: "Values", way: "Values", radius: float) -> float:
    """How far back along ``way`` from ``start`` the circle of this radius is met."""
    along = float(start @ way)
    return along + float(np.sqrt(along**2 - start @ start + radius**2))


def _arm(panel: Any, height: float) -> None:
    """The bending arm as a dimension on the axis."""
    panel.annotate(
        "", (0.0, 0.0), (0.0, height), zorder=6,
        arrowprops={"arrowstyle": "<|-|>", "color": INK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0,
                    "mutation_scale": 7},
    )  # fmt: skip
    panel.annotate(r"$h_{Fa}$", (0.0, 0.55 * height), (-4, 0), textcoords="offset points", fontsize=9, ha="right")
