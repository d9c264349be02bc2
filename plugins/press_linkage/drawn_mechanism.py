"""The mechanism to scale: one position in full, a few others of the turn behind it, and the way of the slider."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.patheffects import withStroke

from press_linkage.kinematics import Geometry, Half, Position, solve, top_crank_angle
from press_linkage.mechanism import geometry_of
from press_linkage.quantities import Press, Slider
from truing import Record

INK, FRAME, CRANK, KNEE, SLIDER = "#22262b", "#7d838c", "#c8641e", "#1f5a8a", "#2f6b4f"
LINK = "#565c66"
PALE = ("#d9dde2", "#c9ced6", "#b7bec8")
GHOSTS = (1.0, 0.7, 0.45)  # shares of the way back to the top dead centre
SLIDER_HEIGHT = 0.16
Place = tuple[float, float]
BESIDE = {
    "A": (0.13, -0.03),
    "B": (0.13, 0.05),
    "E": (0.12, 0.05),
    "G": (0.13, 0.04),
    "M": (0.13, 0.02),
    "H": (0.12, -0.06),
}
LINKS = {
    "a": ("A", "B", -0.08, 0.0), "k_R": ("B", "E", -0.1, 0.0), "k": ("O_1", "B_5", 0.07, 0.0),
    "l_g": ("B_5", "G", 0.0, 0.12), "l_m": ("M", "G", 0.12, 0.0), "l_h": ("G", "H", 0.12, 0.0),
    "e": ("O_1", "E", 0.0, 0.1),
}  # fmt: skip


def places(position: Position, half: Half, sign: float) -> dict[str, Place]:
    """Where the joints of one side are, y to the right and z downward; *sign* is -1 for side 2."""
    parts = half.parts
    found = {
        "A": (parts.pivot.y, parts.pivot.z),
        "B": half.pin,
        "E": (parts.platform.y, position.platform_height + parts.platform.z),
        "G": half.knee,
        "M": (parts.ground.y, parts.ground.z),
        "H": (parts.slider.y, half.face + parts.slider.z),
    }
    return {name: (sign * float(y), float(z)) for name, (y, z) in found.items()}


def mechanism(record: "Record[Press, Slider]") -> "Figure":
    """Draw the press at the crank angle of this run, with earlier positions of its way down in grey."""
    geometry = geometry_of(record.inputs)
    crank_angle = float(record.inputs.crank_angle)
    figure = Figure(figsize=(6.4, 6.6), layout="constrained")
    panel: Any = figure.subplots()
    panel.set_aspect("equal")
    panel.invert_yaxis()
    earlier = [float(share * top_crank_angle(geometry)) for share in GHOSTS]
    for angle, colour in zip(earlier, PALE, strict=True):
        ghost = solve(geometry, angle)
        if np.isfinite(ghost.slider_position):
            _ghost(panel, ghost, colour)
    position = solve(geometry, crank_angle)
    _ways(panel, geometry)
    _frame(panel, position)
    _press(panel, position)
    _names(panel, position)
    panel.set_xlabel("y, m")
    panel.set_ylabel("z, m (downward)")
    panel.set_xlim(-1.22 * geometry.slider_half_width, 1.22 * geometry.slider_half_width)
    panel.grid(alpha=0.35)
    panel.set_axisbelow(True)
    panel.set_title(_title(crank_angle, earlier), fontsize=9)
    return figure


def _title(crank_angle: float, earlier: list[float]) -> str:
    """Say which positions are drawn."""
    where = "at" if crank_angle == 0 else f"{np.degrees(crank_angle):.5g}° from".replace("-", "−")
    said = f"Crank {where} the bottom dead centre"
    if not np.all(np.isfinite(earlier)):
        return said
    grey = [f"{-np.degrees(angle):.0f}°" for angle in earlier]
    return f"{said}; grey: {grey[0]} (top), {', '.join(grey[1:-1])} and {grey[-1]} before it"


def _sides(position: Position) -> tuple[dict[str, Place], dict[str, Place]]:
    return places(position, position.side_1, 1.0), places(position, position.side_2, -1.0)


def _line(panel: Any, *points: Place, **style: Any) -> None:
    panel.plot([y for y, _ in points], [z for _, z in points], solid_capstyle="round", **style)


def _ways(panel: Any, geometry: Geometry) -> None:
    """The circles of the crank pins and the way of the knees, dotted."""
    turn = solve(geometry, np.linspace(-np.pi, np.pi, 181))
    for half, sign in ((turn.side_1, 1.0), (turn.side_2, -1.0)):
        for joint, colour in ((half.pin, CRANK), (half.knee, KNEE)):
            panel.plot(sign * joint.y, joint.z, linestyle=(0, (1, 2)), linewidth=0.9, color=colour, zorder=2)


def _ghost(panel: Any, position: Position, colour: str) -> None:
    """One position in thin grey: links, platform and slider."""
    style = {"color": colour, "linewidth": 1.1, "zorder": 1}
    centre, arm_end = (0.0, float(position.platform_height)), (0.0, float(position.side_1.arm_end))
    for joints in _sides(position):
        _line(panel, joints["A"], joints["B"], joints["E"], centre, arm_end, joints["G"], joints["M"], **style)
        _line(panel, joints["G"], joints["H"], **style)
    first, second = (joints["H"] for joints in _sides(position))
    _line(panel, first, second, **style)


def _press(panel: Any, position: Position) -> None:
    """The position in full."""
    centre, arm_end = (0.0, float(position.platform_height)), (0.0, float(position.side_1.arm_end))
    for joints in _sides(position):
        _line(panel, joints["A"], joints["B"], color=CRANK, linewidth=4.2, zorder=4)
        _line(panel, joints["B"], joints["E"], color=CRANK, linewidth=2.4, zorder=4)
        for start, end in ((joints["M"], joints["G"]), (joints["G"], joints["H"])):
            _line(panel, start, end, color=KNEE, linewidth=3.2, zorder=4)
        _line(panel, arm_end, joints["G"], color=KNEE, linewidth=2.0, zorder=4)
        _line(panel, joints["E"], centre, color=INK, linewidth=4.2, zorder=3)
        for name in "ABEGMH":
            _pin(panel, joints[name])
    _line(panel, centre, arm_end, color=INK, linewidth=4.2, zorder=3)
    _pin(panel, arm_end)
    _slider(panel, position)


def _pin(panel: Any, place: Place) -> None:
    panel.plot(*place, marker="o", markersize=5.2, markerfacecolor="white", markeredgecolor=INK, zorder=6)


def _slider(panel: Any, position: Position) -> None:
    """The slider as a block below its joints."""
    (right, low), (left, _) = (joints["H"] for joints in _sides(position))
    block = Rectangle(
        (1.04 * left, low), 1.04 * (right - left), SLIDER_HEIGHT, facecolor="#dfe9e3", edgecolor=SLIDER, linewidth=1.2,
        zorder=2,
    )  # fmt: skip
    panel.add_patch(block)
    panel.plot(0.0, low, marker="+", markersize=7, color=SLIDER, zorder=6)


def _frame(panel: Any, position: Position) -> None:
    """Hatched supports at the joints that belong to the frame, and the origin midway between the crank pivots."""
    for joints in _sides(position):
        for name in "AM":
            y, z = joints[name]
            corners = [(y, z), (y - 0.07, z - 0.12), (y + 0.07, z - 0.12)]
            panel.add_patch(
                Polygon(corners, facecolor="#eceef1", edgecolor=FRAME, linewidth=0.9, hatch="////", zorder=2)
            )
    panel.plot(0.0, 0.0, marker="+", markersize=7, color=FRAME, zorder=6)


def _names(panel: Any, position: Position) -> None:
    """The paper's names of the joints beside them, and of the links beside those of side 1."""
    for side, (joints, sign) in enumerate(zip(_sides(position), (1.0, -1.0), strict=True), start=1):
        for name, (across, down) in BESIDE.items():
            y, z = joints[name]
            _name(panel, f"${name}_{side}$", (y + sign * across, z + down))
    arm_end = (0.0, float(position.side_1.arm_end))
    joints = {**_sides(position)[0], "O_1": (0.0, float(position.platform_height)), "B_5": arm_end}
    for symbol, (start, end, across, down) in LINKS.items():
        (y_1, z_1), (y_2, z_2) = joints[start], joints[end]
        _name(panel, f"${symbol}$", (0.5 * (y_1 + y_2) + across, 0.5 * (z_1 + z_2) + down), LINK)
    middle, low = float(position.platform_height), float(position.slider_position)
    _name(panel, "$O_1$", (0.0, middle - 0.11))
    _name(panel, "$B_5$", (0.0, float(position.side_1.arm_end) + 0.12))
    _name(panel, "$O_2$", (0.0, low - 0.1))
    _name(panel, "$O$", (0.0, -0.11))


def _name(panel: Any, text: str, place: Place, colour: str = INK) -> None:
    halo = [withStroke(linewidth=2.5, foreground="white")]
    panel.text(*place, text, ha="center", va="center", fontsize=9, color=colour, zorder=7, path_effects=halo)
