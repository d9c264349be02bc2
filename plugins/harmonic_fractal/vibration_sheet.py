"""The sheets of the vibration, their figures, and both calculations as truing knows them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from gear_geometry.drawing import BLUE, GREY, INK, ORANGE, PALE, panels, quiet
from harmonic_fractal import vibration_response as response
from harmonic_fractal.contact import interface_of
from harmonic_fractal.vibration import RECORD, Running, Vibration, drive_of, mesh_quantities, mesh_speed
from harmonic_fractal.vibration_effects import EFFECTS, TOLERANCES
from harmonic_fractal.vibration_run import (
    Response,
    RunUp,
    each_of,
    oscillators_of,
    run_up,
    runs_of,
    transmission_error,
)
from truing import Array, Block, Drawing, Frequency, Model, Record, Section, Table, TruingError

MICRO, KILO = 1e6, 1e3
TURN = 60.0  # rpm per turn in a second

# The record in time


def history_figure(record: Record[Running, Vibration]) -> Figure:
    """Deflection and force of the mesh over time."""
    answer = record.results
    figure, (upper, lower) = panels(2, 4.6, sharex=True)
    time, gap = KILO * np.asarray(answer.time), MICRO * float(answer.clearance)
    upper.axhspan(-gap, gap, color=PALE, zorder=0, label="clearance: nothing touches")
    upper.plot(time, MICRO * np.asarray(answer.mesh_deflection), color=BLUE, linewidth=1.1)
    upper.axhline(gap + MICRO * float(answer.deflection), color=GREY, linestyle="--", linewidth=0.9,
                  label="under the mean force at rest")  # fmt: skip
    upper.legend(loc="best", fontsize=7.5)
    quiet(upper, "", "deflection x, µm")
    lower.plot(time, np.asarray(answer.mesh_force), color=ORANGE, linewidth=1.1)
    lower.axhline(float(answer.mean_force), color=GREY, linestyle="--", linewidth=0.9)
    quiet(lower, "time, ms", "mesh force, N")
    return figure


def phase_figure(record: Record[Running, Vibration]) -> Figure:
    """Rate of the deflection over the deflection; the last third of the record is dark."""
    answer, running = record.results, record.acting
    own = mesh_speed(running, answer.time) * running.error_amplitude * np.sin(answer.mesh_phase)
    rate = KILO * (np.asarray(answer.transmission_error_rate) + own)
    x, gap = MICRO * np.asarray(answer.mesh_deflection), MICRO * float(answer.clearance)
    settled = len(x) * 2 // 3
    figure, panel = panels(1, 3.6)
    panel.axvspan(-gap, gap, color=PALE, zorder=0)
    panel.plot(x[: settled + 1], rate[: settled + 1], color=GREY, linewidth=0.7, label="at first")
    panel.plot(x[settled:], rate[settled:], color=BLUE, linewidth=1.2, label="the last third")
    panel.legend(loc="best", fontsize=7.5)
    quiet(panel, "deflection x, µm", "its rate, mm/s")
    return figure


def history(record: Record[Running, Vibration]) -> Sequence[Block]:
    """The record and its phase plot."""
    return [
        Drawing("Deflection and force over time", partial(history_figure, record)),
        Drawing("Phase plot", partial(phase_figure, record),
                "Within the shaded clearance nothing touches. A vibration that repeats closes its loop."),
    ]  # fmt: skip


# The runs up and down


def response_figure(record: Record[RunUp, Response]) -> Figure:
    """Amplitude over speed: the curve of all motions, the way up, the way down; and how many flanks are hit."""
    answer, speed = record.results, TURN * np.asarray(record.results.speed)
    figure, (upper, lower) = panels(2, 5.4, sharex=True, height_ratios=(3, 1))
    for label, part, style in _curve(record):
        upper.plot(*part, style, color=GREY, linewidth=1.0, label=label)
    for way, marker, color in (("up", ">", BLUE), ("down", "<", ORANGE)):
        upper.plot(speed, MICRO * getattr(answer, f"amplitude_{way}"), marker, color=color, markersize=4.5,
                   markerfacecolor="none", label=f"on the way {way}")  # fmt: skip
        lower.plot(
            speed, getattr(answer, f"impacts_{way}"), marker, color=color, markersize=4.5, markerfacecolor="none"
        )
    upper.set_xlim(speed[0], speed[-1])
    upper.set_ylim(bottom=0.0)
    upper.legend(loc="best", fontsize=7.5)
    quiet(upper, "", "amplitude, µm")
    lower.set_yticks([0, 1, 2], ["in contact", "one flank is hit", "both are hit"])
    lower.set_ylim(-0.4, 2.4)
    quiet(lower, "speed of the wave generator, rpm", "")
    return figure


def _curve(record: Record[RunUp, Response]) -> Iterator[tuple[str, tuple[Array, Array], str]]:
    """Give the pieces of the curve of all motions, each with its style; those that do not last are dotted."""
    pair, mesh = record.acting, mesh_quantities(record.acting)
    machines, scale = oscillators_of(pair, mesh, 1)
    resonance = each_of(mesh["resonance_speed"], 1)
    runs = runs_of(machines, np.asarray(pair.speeds) / resonance[:, np.newaxis])
    curve = runs.curve
    error = response.motion_of(transmission_error(machines, curve.harmonics))[0]
    lasts = response.largest_multiplier(machines, curve.harmonics, curve.ratio)[0] <= 1.0
    speed, amplitude = TURN * resonance * curve.ratio[0], MICRO * scale * np.ptp(error, axis=-1) / 2.0
    labels = {True: "motions that last", False: "motions that do not"}
    ends = [0, *(np.flatnonzero(np.diff(lasts)) + 1).tolist(), len(lasts)]
    for begin, end in pairwise(ends):
        part = slice(max(begin - 1, 0), end)
        label = labels.pop(bool(lasts[begin]), "")
        yield label or "_", (speed[part], amplitude[part]), "-" if lasts[begin] else ":"


def force_figure(record: Record[RunUp, Response]) -> Figure:
    """The largest force of the mesh over speed, both ways."""
    answer, speed = record.results, TURN * np.asarray(record.results.speed)
    figure, panel = panels(1, 2.8)
    panel.plot(speed, answer.force_up, "-", color=BLUE, linewidth=1.4, label="on the way up")
    panel.plot(speed, answer.force_down, "--", color=ORANGE, linewidth=1.4, label="on the way down")
    panel.axhline(float(answer.mean_force), color=INK, linewidth=0.9, label="mean force")
    panel.set_ylim(bottom=0.0)
    panel.legend(loc="best", fontsize=7.5)
    quiet(panel, "speed of the wave generator, rpm", "largest mesh force, N")
    return figure


def resonance(record: Record[RunUp, Response]) -> Sequence[Block]:
    """The response over speed and the force."""
    return [
        Drawing("Amplitude over speed, up and down", partial(response_figure, record),
                "A run follows the curve to where it turns back, and jumps to its next piece at that speed. Dotted: "
                "motions from which the least disturbance leads away."),
        Drawing("Largest force over speed", partial(force_figure, record)),
    ]  # fmt: skip


FLANKS: list[tuple[str, float, float, bool]] = [
    ("as stated", 0.0, 1.0, False),
    ("G ten times as large", 0.0, 10.0, False),
    ("G a tenth", 0.0, 0.1, False),
    ("D larger by 0.05", 0.05, 1.0, False),
    ("D smaller by 0.05", -0.05, 1.0, False),
    ("teeth rigid", 0.0, 1.0, True),
    ("teeth rigid, G ten times as large", 0.0, 10.0, True),
    ("teeth rigid, D smaller by 0.05", -0.05, 1.0, True),
]
"""Flanks whose vibration is compared: what is added to D, the factor on G, and whether only flanks give way."""


def with_flanks(pair: RunUp, more: float, factor: float, *, is_rigid: bool) -> RunUp:
    """Return a pair with other flanks, looked at over the same speeds beside its own resonance."""
    rough = interface_of(drive_of(pair))
    other = replace(
        pair, surface=None, convention="areal", fractal_dimension=rough.dimension + more,
        fractal_roughness=rough.roughness * factor, tooth_stiffness=np.nan if is_rigid else pair.tooth_stiffness,
    )  # fmt: skip
    shift = mesh_quantities(other)["resonance_speed"] / mesh_quantities(pair)["resonance_speed"]
    return replace(other, speeds=np.asarray(pair.speeds) * shift)


def flanks_compared(record: Record[RunUp, Response]) -> Sequence[Block]:
    """How D and G change stiffness and clearance, and with them resonance, jumps and amplitude."""
    pair = record.acting
    if not np.isnan(pair.stated_stiffness):
        return []
    rows: list[tuple[str | float | None, ...]] = []
    for words, more, factor, is_rigid in FLANKS:
        try:
            rows.append((words, *_compared(with_flanks(pair, more, factor, is_rigid=is_rigid))))
        except TruingError:
            continue
    table = Table(
        "Other flanks, the same drive",
        ("flanks", "K", "of it rough", "b", "resonance", "jump up", "jump down", "largest amplitude", "flanks hit"),
        rows, ("", "N/µm", "%", "µm", "rpm", "rpm", "rpm", "µm", ""),
        note="Rough: share of the compliance of the mesh that is of rough contacts. Jumps without a number: there are "
        "none. Flanks that cannot be calculated are left out.",
    )  # fmt: skip
    return [table]


def _compared(pair: RunUp) -> tuple[float | None, ...]:
    answer = run_up(pair)
    jumps = (TURN * float(answer.jump_up), TURN * float(answer.jump_down))
    return (
        1e-6 * float(answer.mesh_stiffness), 100.0 * float(answer.rough_share), MICRO * float(answer.clearance),
        TURN * float(answer.resonance_speed), *(each if np.isfinite(each) else None for each in jumps),
        MICRO * float(answer.largest_amplitude), float(answer.most_impacts),
    )  # fmt: skip


LITERATURE = [
    "The patent: modelling method for the single-tooth contact stiffness and mesh clearance of a harmonic gear "
    "(一种谐波齿轮单齿接触刚度和啮合间隙建模方法), China, published 2022: figures 1 and 2.",
    "Kahraman, A., Singh, R., Non-linear dynamics of a spur gear pair, Journal of Sound and Vibration 142 (1990), "
    "p. 49.",
    "Comparin, R. J., Singh, R., Non-linear frequency response characteristics of an impact pair, Journal of Sound and "
    "Vibration 134 (1989), p. 259: describing functions of a clearance.",
    "Cameron, T. M., Griffin, J. H., An alternating frequency/time domain method for calculating the steady-state "
    "response of nonlinear dynamic systems, Journal of Applied Mechanics 56 (1989), p. 149.",
]
OSCILLATOR = Section(
    "From flanks to an oscillator",
    "effective_radius", "mean_force", "pair_force", "pair_stiffness", "rough_stiffness", "mesh_stiffness",
    "rough_share", "rough_clearance", "clearance", "deflection", "effective_mass", "damping", "wave_force",
    "natural_frequency", "order", "resonance_speed",
    text="The rough contacts of all engaged pairs, each in series with its tooth, are the stiffness at the mean "
    "torque. What is left open between the flanks is the clearance. Stiffness and clearance stay while the mesh "
    "vibrates.",
)  # fmt: skip

VIBRATION = Model(
    name="vibration",
    title="Harmonic drive: torsional vibration of the mesh in time",
    function=RECORD,
    errors=[*TOLERANCES, *EFFECTS],
    sheet=[
        OSCILLATOR,
        Section(
            "The record",
            "transmission_error", "transmission_error_rate", "mesh_phase", "mesh_deflection", "mesh_force",
            "damping_force", "losses_of_contact", "back_impacts",
            blocks=history,
        ),
    ],
    studies=[
        Frequency(input="torque", output="mesh_force", point="start", over="torque", at="1..50 N*m"),
    ],
    cites=LITERATURE,
    example=Path(__file__).with_name("vibration.toml"),
    summary="How does the mesh vibrate over time, and when do its flanks part or hit on the other side?",
)  # fmt: skip

RUN_UP = Model(
    name="run_up",
    title="Harmonic drive: vibration of the mesh over the speed, up and down",
    function=run_up,
    errors=[*TOLERANCES, *EFFECTS],
    sheet=[
        OSCILLATOR,
        Section(
            "Run up and down",
            "mesh_frequency", "amplitude_up", "amplitude_down", "force_up", "force_down", "impacts_up", "impacts_down",
            "multiplier_up", "multiplier_down", "largest_amplitude", "largest_force", "most_impacts", "jump_up",
            "jump_down", "hysteresis",
            text="Where the flanks part the mesh is softer for its own motion, and the resonance leans to lower "
            "speeds; where the other flanks are hit it leans back.",
            blocks=resonance,
        ),
        Section(
            "What the flanks have to do with it",
            text="The patent holds that other flanks make another dynamic behaviour. Here is what its own equations "
            "make of them.",
            blocks=flanks_compared,
        ),
    ],
    cites=LITERATURE,
    example=Path(__file__).with_name("run_up.toml"),
    summary="At which speeds does the mesh resound, jump and hammer, on the way up and on the way down?",
)  # fmt: skip
