"""The sheet of the press in motion, its figures, and the calculation as truing knows it."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_geometry.drawing import BLUE, GREEN, GREY, INK, ORANGE, panels, quiet
from press_linkage.motion import JOINTS, press_motion
from press_linkage.motion_effects import EFFECTS, TOLERANCES
from press_linkage.motion_quantities import MovingPress, PressMotion
from truing import (
    Array,
    Block,
    Drawing,
    Minimise,
    Model,
    Record,
    Require,
    Section,
    Sensitivity,
    Sweep,
    Swept,
    Table,
    Vary,
    Words,
)

MotionRun = Record[MovingPress, PressMotion]

KILO = 1e-3
SPOKEN = {
    "crank_pivot": ("A", "crank pivot"), "crank_pin": ("B", "crank pin"), "rod_joint": ("E", "rod on the platform"),
    "arm_joint": ("B_5", "knee drive on the arm"), "knee_of_drive": ("G", "knee drive on the knee"),
    "knee_of_upper": ("G", "upper link on the knee"), "knee_of_lower": ("G", "lower link on the knee"),
    "ground_joint": ("M", "ground joint"), "slider_joint": ("H", "slider joint"),
}  # fmt: skip
"""Letter and name of each joint."""


def along(values: Any, answers: PressMotion) -> Array:
    """Return a result along the times, whatever of it is one number."""
    return np.broadcast_to(np.asarray(values, dtype=np.float64), np.shape(answers.time))


def _lines(panel: Any, answers: PressMotion, curves: Sequence[tuple[Any, str, Any]], label: str) -> None:
    """Draw curves over time, each with its name and style, and a line at 0."""
    for values, name, style in curves:
        panel.plot(answers.time, along(values, answers), label=name, **style)
    quiet(panel, "", label)
    panel.axhline(0.0, color=GREY, linewidth=0.7, zorder=1)


def _dead_centres(panels_: Sequence[Any], answers: PressMotion) -> None:
    """Mark the times at which the crank passes the bottom dead centre."""
    angle, time = along(answers.crank_angle, answers), np.asarray(answers.time)
    turns = angle / (2 * np.pi)
    for place in np.flatnonzero(np.diff(np.floor(turns))):
        start, end = turns[place : place + 2]
        share = (np.floor(max(start, end)) - start) / (end - start)
        for panel in panels_:
            at = time[place] + share * (time[place + 1] - time[place])
            panel.axvline(at, color=GREY, linewidth=0.8, linestyle=(0, (4, 3)), zorder=1)
    panels_[-1].set_xlabel("time, s (dashed: crank at the bottom dead centre)")


def slider_figure(answers: PressMotion) -> Figure:
    """Draw speed of the cranks, and height, speed and acceleration of the slider over time."""
    figure, rows = panels(4, 6.4, sharex=True)
    rpm = along(answers.drive_speed, answers) * 30 / np.pi
    blue = {"color": BLUE}
    _lines(rows[0], answers, [(rpm, "", {"color": ORANGE})], "cranks, rpm")
    rows[1].plot(answers.time, along(answers.slider_position, answers), **blue)
    quiet(rows[1], "", "$z_2$, m (down)")
    rows[1].invert_yaxis()
    _lines(rows[2], answers, [(answers.slider_speed, "", blue)], "speed, m/s")
    _lines(rows[3], answers, [(answers.slider_acceleration, "", blue)], "accel., m/s²")
    _dead_centres(rows, answers)
    return figure


def torque_figure(answers: PressMotion) -> Figure:
    """Draw the torque of one crank and its parts, and the power of the drive, over time."""
    parts = [
        (answers.crank_torque, "whole", {"color": INK, "linewidth": 2.0}),
        (inertia_torque(answers), "inertia", {"color": BLUE}),
        (answers.weight_torque, "weights", {"color": GREEN}),
        (0.5 * answers.press_force * answers.slope, "force on the slider", {"color": ORANGE}),
        (answers.friction_torque, "friction", {"color": GREY, "linestyle": "--"}),
    ]
    figure, (upper, lower) = panels(2, 4.6, sharex=True, height_ratios=(3, 2))
    shown = [(KILO * value, name, style) for value, name, style in parts]
    _lines(upper, answers, shown, "torque of one crank, kN·m")
    upper.legend(ncols=5, loc="lower center", bbox_to_anchor=(0.5, 1.0), handlelength=1.4, columnspacing=1.2)
    powers = [
        (KILO * answers.drive_power, "both cranks", {"color": INK}),
        (KILO * answers.press_force * answers.slider_speed, "force on the slider", {"color": ORANGE}),
    ]
    _lines(lower, answers, powers, "power, kW")
    lower.legend(loc="best")
    _dead_centres((upper, lower), answers)
    return figure


def inertia_torque(answers: PressMotion) -> Any:
    """Return the torque of one crank that speeds its side up."""
    changing = 0.5 * answers.inertia_slope * answers.drive_speed**2
    return answers.reduced_inertia * answers.drive_acceleration + changing


def lift_figure(swept: Swept) -> Figure:
    """Draw largest torque and root mean square over the counterbalance, and where the latter is least."""
    figure, panel = panels(1, 2.6)
    lift, mean = KILO * swept.axis, KILO * np.asarray(swept.results["rms_torque"])
    panel.plot(lift, KILO * np.asarray(swept.results["largest_torque"]), color=ORANGE, label="largest")
    panel.plot(lift, mean, color=BLUE, label="root mean square")
    if np.isfinite(mean).any():
        least = int(np.nanargmin(mean))
        panel.plot(lift[least], mean[least], "o", color=BLUE, markersize=5)
        panel.annotate(f"{lift[least]:.4g} kN", (lift[least], mean[least]), (0, -12), textcoords="offset points",
                       ha="center", fontsize=8)  # fmt: skip
    panel.set_ylim(0.0, None)
    quiet(panel, "counterbalance, kN", "torque of one crank, kN·m")
    panel.legend(loc="best")
    return figure


def joints_figure(answers: PressMotion) -> Figure:
    """Draw the size of the force at one joint of each link over time: rod, and the links at the knee."""
    figure, (upper, lower) = panels(2, 4.4, sharex=True)
    styles = {"crank_pin": INK, "arm_joint": GREEN, "ground_joint": BLUE, "slider_joint": ORANGE}
    for panel, names in ((upper, ["crank_pin"]), (lower, ["arm_joint", "ground_joint", "slider_joint"])):
        curves = [
            (KILO * getattr(answers, name).size, f"${SPOKEN[name][0]}$ {SPOKEN[name][1]}", {"color": styles[name]})
            for name in names
        ]
        _lines(panel, answers, curves, "force, kN")
        panel.legend(loc="best")
    _dead_centres((upper, lower), answers)
    return figure


def moving(record: MotionRun) -> Sequence[Block]:
    """The slider over the record."""
    return [Drawing("Cranks and slider over time", partial(slider_figure, record.results))]


def turning(record: MotionRun) -> Sequence[Block]:
    """The torque of one crank by its parts, and how exactly power is balanced."""
    answers = record.results
    spent = 2.0 * inertia_torque(answers) * answers.drive_speed + answers.press_force * answers.slider_speed
    spent = spent + 2.0 * (answers.weight_torque + answers.friction_torque) * answers.drive_speed
    left = float(np.max(np.abs(answers.drive_power - spent)) / np.max(np.abs(answers.drive_power)))
    closed = "1e-12" if left < 1e-12 else f"{left:.0e}"
    words = (
        "The torque comes from the equilibrium of each body. Its power is the change of the kinetic energy and of the "
        "potential energy of the weights, and the work against counterbalance, force and friction: at every time of "
        f"this record within {closed} of the largest power."
    )
    caption = "One crank; the other needs the same."
    drawn: list[Block] = [Drawing("Torque and power over time", partial(torque_figure, answers), caption), Words(words)]
    swept = record.studies.get("sweep")
    if swept is None or swept.over != "counterbalance":
        return drawn
    caption = "The drive heats least where the root mean square is least."
    return [*drawn, Drawing("Torque over the counterbalance", partial(lift_figure, swept), caption)]


def carrying(record: MotionRun) -> Sequence[Block]:
    """The forces of the joints: over time, and where each is largest."""
    answers, times = record.results, np.asarray(record.results.time)
    rows: list[tuple[str | float, ...]] = []
    for name in JOINTS:
        force = getattr(answers, name)
        size = along(force.size, answers)
        at = int(np.argmax(size))
        angle = np.degrees(along(answers.crank_angle, answers)[at])
        sides = [KILO * float(along(part, answers)[at]) for part in (force.outward, force.downward)]
        letter, spoken = SPOKEN[name]
        rows.append((f"{letter.replace('_', '')}, {spoken}", KILO * float(size[at]), *sides, float(times[at]), angle))
    columns = ("joint", "largest force", "outward", "downward", "at the time", "at the crank angle")
    note = "Of one side, at the time when it is largest."
    table = Table("Largest forces of the joints", columns, rows, ("", "kN", "kN", "kN", "s", "°"), note)
    caption = "One joint of each link; at its other end the force differs by weight and inertia of the link."
    return [Drawing("Forces at the joints over time", partial(joints_figure, answers), caption), table]


SECTIONS = [
    Section(
        "Cranks and slider",
        "time", "crank_angle", "drive_speed", "drive_acceleration", "turns", "slider_position", "slope", "curvature",
        "slider_speed", "slider_acceleration", "press_force",
        text="The drive gives the crank angle; everything else follows from the exact loops, differentiated twice. z "
        "counts downward from O, and a positive force pushes the slider up.",
        blocks=moving,
    ),
    Section(
        "Links",
        "rod_speed", "knee_drive_speed", "upper_knee_speed", "lower_knee_speed",
        text="Angular speeds of one side, positive from outward toward downward.",
    ),
    Section(
        "Torque of one crank",
        "reduced_inertia", "inertia_slope", "weight_torque", "friction_torque", "crank_torque", "largest_torque",
        "rms_torque",
        text="Positive drives the crank in the sense in which its angle grows; negative brakes it. The root mean "
        "square is what heats the motor.",
        blocks=turning,
    ),
    Section("Power and work", "drive_power", "kinetic_energy", "drive_work", "press_work"),
    Section(
        "Joints",
        *(f"largest_{name}" for name in JOINTS),
        text="The largest force of the record at each joint of one side, on the link that is named: crank pivot A on "
        "the crank, crank pin B and rod joint E on the rod, arm joint B5 on the knee drive, ground joint M on the "
        "upper link, slider joint H on the lower link, and at the knee G one force for each of the three links.",
        blocks=carrying,
    ),
    Section(
        "Components of the joint forces",
        *(f"{part}_{name}" for name in JOINTS for part in ("outward", "downward", "size")),
        text="Outward and downward on the link, over the record.",
        level="full",
    ),
]  # fmt: skip

LITERATURE = [
    "The mechanism: Qian Huanan, Tao Jing, Yu Suiran (騫華楠, 陶璟, 于隨然), error analysis and accuracy synthesis of "
    "a parallel-driven multi-link servo press, School of Mechanical Engineering, Shanghai Jiao Tong University. It "
    "gives no masses, speeds or forces.",
    "R. Eksergian, Dynamical analysis of machines, Journal of the Franklin Institute 209 (1930): reduced inertia.",
    "F. N. Fritsch, R. E. Carlson, Monotone piecewise cubic interpolation, SIAM Journal on Numerical Analysis 17 "
    "(1980), p. 238: the speed law between its points.",
]

MOTION = Model(
    name="motion",
    title="Servo press in motion: torque of the drive and forces of the joints",
    function=press_motion,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[
        Vary("counterbalance", "0 kN", "400 kN"),
        Minimise("rms_torque"),
        Require("largest_torque", at_most="permitted_torque"),
    ],
    studies=[
        Sweep(over="counterbalance", at="0..400 kN", points=81),
        Sensitivity(of=("largest_torque", "rms_torque")),
    ],
    sheet=SECTIONS,
    cites=LITERATURE,
    example=Path(__file__).with_name("motion.toml"),
    summary="How does the slider of a servo press move under the speed law of its drive, what torque do the cranks "
    "need, and what do the joints carry?",
)
