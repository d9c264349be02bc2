"""The slider over one turn, the influence of the errors, and the reliabilities along the synthesis."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from press_linkage.answers import KEY_POSITION, KEY_TILT
from press_linkage.increments import (
    ARM,
    KINDS,
    PASSIVE,
    SOURCES,
    SYMBOLS,
    derivatives,
    salience,
    side_sensitivities,
    source,
)
from press_linkage.kinematics import solve, top_crank_angle
from press_linkage.mechanism import geometry_of, position_of
from press_linkage.quantities import Press, Slider
from truing import Allotted, Record, Sensitivities

Run = Record[Press, Slider]

BLUE, ORANGE, GREEN, INK, GREY = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#9aa1ab"
TURN = np.radians(np.linspace(-180.0, 180.0, 361))
LETTERS = {
    "a": "a", "k_R": "k_R", "l_g": "l_g", "l_m": "l_m", "l_h": "l_h", "l": "l", "beta_2": r"\beta_2", "r_A": "r_A",
    "alpha_1": r"\alpha_1", "e": "e", "beta_1": r"\beta_1", "r_M": "r_M", "alpha_2": r"\alpha_2",
    "theta_11": r"\theta_1", "k": "k",
}  # fmt: skip
ROWS = 14  # room for as many bars below one another, so that both panels have bars of one height
NOTHING = 1e-12  # a share below it is rounding
DRAWN = {
    "lower_knee_length": (BLUE, "-"), "upper_knee_length": (ORANGE, "-"), "knee_drive_length": (GREEN, "-"),
    "slider_half_width": (GREY, "-"), "rod_length": (INK, "--"), "platform_arm": (INK, ":"),
}  # fmt: skip


def letter(kind: str) -> str:
    """The paper's symbol of a kind of error, for matplotlib."""
    return LETTERS[SYMBOLS[kind]]


def way(press: Press) -> "Figure":
    """Draw the height of the slider over one turn of the crank, with both dead centres."""
    top = float(top_crank_angle(geometry_of(press)))
    height = np.asarray(position_of(press, TURN).slider_position)
    figure = Figure(figsize=(6.4, 2.9), layout="constrained")
    panel: Any = figure.subplots()
    panel.plot(np.degrees(TURN), height, color=BLUE)
    panel.invert_yaxis()
    for angle, name, side in ((0.0, "bottom dead centre", "top"), (top, "top dead centre", "bottom")):
        reached = float(position_of(press, angle).slider_position)
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


def over_the_turn(record: "Run") -> "Figure":
    """Draw how the influence of the lengths and the salience of the key errors run over one turn."""
    geometry = geometry_of(record.inputs)
    turn = solve(geometry, TURN)
    by_kind = side_sensitivities(turn.side_1)
    figure = Figure(figsize=(6.4, 5.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    for kind, (colour, dashes) in DRAWN.items():
        upper.plot(np.degrees(TURN), by_kind[kind], color=colour, linestyle=dashes, label=rf"$\xi_{{{letter(kind)}}}$")
    upper.legend(ncols=6, loc="upper center", bbox_to_anchor=(0.5, 1.16), handlelength=1.6, columnspacing=1.4)
    found = derivatives(geometry, turn)
    for of, key, colour, name in (
        (found.position, KEY_POSITION, BLUE, "position, 12 key errors"),
        ({name: found.tilt[name] for kind in PASSIVE for name in _both(kind)}, KEY_TILT, ORANGE, "tilt, 10 key errors"),
    ):
        shares = salience(of)
        lower.plot(
            np.degrees(TURN), sum(shares[item] for kind in key for item in _both(kind)), color=colour, label=name
        )
    lower.legend(loc="lower right")
    lower.set_ylim(0, 1)
    _over_the_turn(upper, "influence on one side, m/m")
    _over_the_turn(lower, "salience")
    upper.set_xlabel("")
    return figure


def _both(kind: str) -> list[str]:
    return [ARM] if kind == "platform_arm" else [source(kind, side) for side in (1, 2)]


def salience_bars(found: "Sensitivities") -> "Figure":
    """Draw the salience of every kind of error for position and tilt; the key errors stand out."""
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    panels = figure.subplots(1, 2, width_ratios=(1, 1))
    position, tilt = found.derivatives["slider_position"], found.derivatives["slider_tilt"]
    passive = {name: tilt[name] for kind in PASSIVE for name in _both(kind)}
    _bars(panels[0], salience({name: position[name] for name in SOURCES}), KEY_POSITION, "slider position")
    _bars(panels[1], salience(passive), KEY_TILT, "slider tilt")
    return figure


def _bars(panel: Any, shares: Mapping[str, Any], key: Sequence[str], title: str) -> None:
    """Bars of one result, the largest on top; each bar is one of the two equal errors of its kind."""
    kinds = [kind for kind in (*KINDS, "platform_arm") if _both(kind)[0] in shares]
    size = {kind: float(max(shares[name] for name in _both(kind))) for kind in kinds}
    ranked = sorted((kind for kind in kinds if size[kind] > NOTHING), key=lambda kind: size[kind])
    colours = [BLUE if kind in key else GREY for kind in ranked]
    panel.barh(range(len(ranked)), [size[kind] for kind in ranked], color=colours, height=0.66)
    panel.set_yticks(range(len(ranked)), [rf"$\delta {letter(kind)}$" for kind in ranked], fontsize=9)
    for place, kind in enumerate(ranked):
        panel.text(size[kind], place, f" {size[kind]:.4f}", va="center", fontsize=7.5, color=INK)
    whole = sum(float(shares[name]) for kind in key for name in _both(kind))
    panel.set_title(f"{title}: {2 * len(key)} key errors, together {whole:.4f}", fontsize=8.5, color=BLUE, loc="left")
    panel.set_xlim(0, 1.22 * max(size.values()))
    panel.tick_params(axis="y", length=0)
    panel.set_ylim(len(ranked) - max(ROWS, len(ranked)) - 0.5, len(ranked) - 0.4)
    panel.set_xlabel("salience of each of the two sides (k: once)")


def along_the_synthesis(allotted: "Allotted", printed: Mapping[str, Sequence[float]]) -> "Figure":
    """Draw both reliabilities after every adjustment, with their goals and with what the paper prints."""
    figure = Figure(figsize=(6.4, 3.4), layout="constrained")
    panel: Any = figure.subplots()
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
    symbol = letter(step.tolerance) if step.tolerance in SYMBOLS else r"\mathrm{" + step.tolerance + "}"
    return f"${symbol}$\n{step.after}"
