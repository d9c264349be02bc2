"""The figures of the sheet: the mechanism to scale, the slider over one turn, influences, and reliabilities."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.patheffects import withStroke

from gear_geometry.drawing import BLUE, GREEN, INK, ORANGE, panels, quiet
from press_linkage.answers import EVERY, KEY_POSITION, KEY_TILT, sources_of
from press_linkage.errors import PASSIVE, SOURCES, derivatives, salience, side_sensitivities
from press_linkage.kinematics import Half, Position, nominal, solve, top_crank_angle
from press_linkage.quantities import Press, Slider
from truing import Allotted, Record, Sensitivities

# The mechanism to scale: one position in full, a few others of the turn behind it, and the way of the slider

GREY = "#9aa1ab"
FRAME, CRANK, KNEE, SLIDER = "#7d838c", ORANGE, BLUE, GREEN
LINK = "#565c66"
PALE = ("#d9dde2", "#c9ced6", "#b7bec8")
GHOSTS = (1.0, 0.7, 0.45)  # shares of the way back to the top dead centre
SLIDER_HEIGHT = 0.16
PointOnFigure = tuple[float, float]
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


def places(position: Position, half: Half, sign: float) -> dict[str, PointOnFigure]:
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
    press = nominal(record.inputs)
    crank_angle = float(record.inputs.crank_angle)
    figure, panel = panels(1, 6.6)
    panel.set_aspect("equal")
    panel.invert_yaxis()
    earlier = [float(share * top_crank_angle(press)) for share in GHOSTS]
    for angle, colour in zip(earlier, PALE, strict=True):
        ghost = solve(press, angle)
        if np.isfinite(ghost.slider_position):
            _ghost(panel, ghost, colour)
    position = solve(press, crank_angle)
    _ways(panel, press)
    _frame(panel, position)
    _press(panel, position)
    _names(panel, position)
    panel.set_xlim(-1.22 * press.slider_half_width, 1.22 * press.slider_half_width)
    quiet(panel, "y, m", "z, m (downward)", alpha=0.35)
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


def _sides(position: Position) -> tuple[dict[str, PointOnFigure], dict[str, PointOnFigure]]:
    return places(position, position.side_1, 1.0), places(position, position.side_2, -1.0)


def _line(panel: Any, *points: PointOnFigure, **style: Any) -> None:
    panel.plot([y for y, _ in points], [z for _, z in points], solid_capstyle="round", **style)


def _ways(panel: Any, press: Press) -> None:
    """The circles of the crank pins and the way of the knees, dotted."""
    turn = solve(press, np.linspace(-np.pi, np.pi, 181))
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


def _pin(panel: Any, place: PointOnFigure) -> None:
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


def _name(panel: Any, text: str, place: PointOnFigure, colour: str = INK) -> None:
    halo = [withStroke(linewidth=2.5, foreground="white")]
    panel.text(*place, text, ha="center", va="center", fontsize=9, color=colour, zorder=7, path_effects=halo)


# The slider over one turn, the influence of the errors, and the reliabilities along the synthesis

PressRun = Record[Press, Slider]

TURN = np.radians(np.linspace(-180.0, 180.0, 361))
SYMBOLS = {
    "crank_radius": "a", "rod_length": "k_R", "knee_drive_length": "l_g", "upper_knee_length": "l_m",
    "lower_knee_length": "l_h", "slider_half_width": "l", "slider_joint_angle": r"\beta_2", "crank_pivot_radius": "r_A",
    "crank_pivot_angle": r"\alpha_1", "platform_half_width": "e", "platform_joint_angle": r"\beta_1",
    "ground_pivot_radius": "r_M", "ground_pivot_angle": r"\alpha_2", "crank_angle": r"\theta_1", "platform_arm": "k",
}  # fmt: skip
"""The paper's symbol of a kind of error, for matplotlib."""
ROWS = 14  # room for as many bars below one another, so that both panels have bars of one height
NOTHING = 1e-12  # a share below it is rounding
DRAWN = {
    "lower_knee_length": (BLUE, "-"), "upper_knee_length": (ORANGE, "-"), "knee_drive_length": (GREEN, "-"),
    "slider_half_width": (GREY, "-"), "rod_length": (INK, "--"), "platform_arm": (INK, ":"),
}  # fmt: skip


def way(press: Press) -> "Figure":
    """Draw the height of the slider over one turn of the crank, with both dead centres."""
    top = float(top_crank_angle(press))
    height = np.asarray(solve(press, TURN).slider_position)
    figure, panel = panels(1, 2.9)
    panel.plot(np.degrees(TURN), height, color=BLUE)
    panel.invert_yaxis()
    for angle, name, side in ((0.0, "bottom dead centre", "top"), (top, "top dead centre", "bottom")):
        reached = float(solve(press, angle).slider_position)
        if not np.isfinite(reached):
            continue
        panel.plot(np.degrees(angle), reached, "o", color=ORANGE, markersize=5, zorder=5)
        place = (0, 9) if side == "top" else (16, -3)
        panel.annotate(
            f"{name}, {reached:.5f} m", (np.degrees(angle), reached), place, textcoords="offset points",
            ha="center" if side == "top" else "left", color=INK, fontsize=8,
        )  # fmt: skip
    _over_the_turn(panel, "slider $z_2$, m (downward)")
    return figure


def _over_the_turn(panel: Any, label: str) -> None:
    panel.set_xlabel("crank angle from the bottom dead centre, °")
    panel.set_ylabel(label)
    panel.set_xlim(-180, 180)
    panel.set_xticks(range(-180, 181, 45))
    panel.grid(alpha=0.4)


def over_the_turn(record: "PressRun") -> "Figure":
    """Draw how the influence of the lengths and the salience of the key errors run over one turn."""
    press = nominal(record.inputs)
    turn = solve(press, TURN)
    by_kind = side_sensitivities(turn.side_1)
    figure, (upper, lower) = panels(2, 5.0, sharex=True, height_ratios=(3, 2))
    for kind, (colour, dashes) in DRAWN.items():
        upper.plot(np.degrees(TURN), by_kind[kind], color=colour, linestyle=dashes, label=rf"$\xi_{{{SYMBOLS[kind]}}}$")
    upper.legend(ncols=6, loc="upper center", bbox_to_anchor=(0.5, 1.16), handlelength=1.6, columnspacing=1.4)
    found = derivatives(press, turn)
    for of, key, colour, name in (
        (found.position, KEY_POSITION, BLUE, "position, 12 key errors"),
        (
            {name: found.tilt[name] for kind in PASSIVE for name in sources_of((kind,))},
            KEY_TILT,
            ORANGE,
            "tilt, 10 key errors",
        ),
    ):
        shares = salience(of)
        lower.plot(
            np.degrees(TURN),
            sum(shares[item] for kind in key for item in sources_of((kind,))),
            color=colour,
            label=name,
        )
    lower.legend(loc="lower right")
    lower.set_ylim(0, 1)
    _over_the_turn(upper, "influence on one side, m/m")
    _over_the_turn(lower, "salience")
    upper.set_xlabel("")
    return figure


def salience_bars(found: "Sensitivities") -> "Figure":
    """Draw the salience of every kind of error for position and tilt; the key errors stand out."""
    figure, (left, right) = panels(1, 4.0, 2, width_ratios=(1, 1))
    position, tilt = found.derivatives["slider_position"], found.derivatives["slider_tilt"]
    passive = {name: tilt[name] for name in sources_of(PASSIVE)}
    _bars(left, salience({name: position[name] for name in SOURCES}), KEY_POSITION, "slider position")
    _bars(right, salience(passive), KEY_TILT, "slider tilt")
    return figure


def _bars(panel: Any, shares: Mapping[str, Any], key: tuple[str, ...], title: str) -> None:
    """Bars of one result, the largest on top; each bar is one of the two equal errors of its kind."""
    kinds = [kind for kind in EVERY if sources_of((kind,))[0] in shares]
    size = {kind: float(max(shares[name] for name in sources_of((kind,)))) for kind in kinds}
    ranked = sorted((kind for kind in kinds if size[kind] > NOTHING), key=lambda kind: size[kind])
    colours = [BLUE if kind in key else GREY for kind in ranked]
    panel.barh(range(len(ranked)), [size[kind] for kind in ranked], color=colours, height=0.66)
    panel.set_yticks(range(len(ranked)), [rf"$\delta {SYMBOLS[kind]}$" for kind in ranked], fontsize=9)
    for place, kind in enumerate(ranked):
        panel.text(size[kind], place, f" {size[kind]:.4f}", va="center", fontsize=7.5, color=INK)
    whole = sum(float(shares[name]) for name in sources_of(key))
    panel.set_title(f"{title}: {2 * len(key)} key errors, together {whole:.4f}", fontsize=8.5, color=BLUE, loc="left")
    panel.set_xlim(0, 1.22 * max(size.values()))
    panel.tick_params(axis="y", length=0)
    panel.set_ylim(len(ranked) - max(ROWS, len(ranked)) - 0.5, len(ranked) - 0.4)
    panel.set_xlabel("salience of each of the two sides (k: once)")


def along_the_synthesis(allotted: "Allotted", printed: Mapping[str, Sequence[float]]) -> "Figure":
    """Draw both reliabilities after every adjustment, with their goals and with what the paper prints."""
    figure, panel = panels(1, 3.4)
    steps = range(len(allotted.steps) + 1)
    looks = {"slider_position": (BLUE, "o", "position"), "slider_tilt": (ORANGE, "s", "tilt")}
    for check, (colour, marker, name) in looks.items():
        values = [allotted.start[check], *(step.chances[check] for step in allotted.steps)]
        panel.plot(steps, values, color=colour, marker=marker, markersize=4, label=name)
        goal = next(demand.goal or 0.0 for demand in allotted.problem.demands if demand.name == check)
        panel.axhline(goal, color=colour, linewidth=0.9, linestyle=(0, (5, 3)))
        panel.text(steps[-1] + 1.5, goal + 0.004, f"goal {goal:g}", ha="right", va="bottom", fontsize=8, color=colour)
        if check in printed:
            ends = (0, steps[-1])
            panel.plot(ends, printed[check], "D", markersize=9, fillstyle="none", color=colour, label=f"{name}, paper")
    panel.set_xticks(steps, ["start", *(_step(step) for step in allotted.steps)], fontsize=8)
    panel.set_xlim(-0.4, steps[-1] + 1.6)
    panel.set_ylim(None, 1.02)
    panel.set_ylabel("reliability")
    panel.set_xlabel("link tightened, and its grade from then on")
    panel.legend(loc="lower right", ncols=2)
    panel.grid(axis="y", alpha=0.4)
    return figure


def _step(step: Any) -> str:
    symbol = SYMBOLS[step.tolerance] if step.tolerance in SYMBOLS else r"\mathrm{" + step.tolerance + "}"
    return f"${symbol}$\n{step.after}"
