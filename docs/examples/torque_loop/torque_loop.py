"""How far does a drive twist while its torque goes up and down? Play and dry friction make a loop of it."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from truing import (
    Dynamics,
    Effect,
    Float,
    Model,
    Motion,
    Record,
    Section,
    Tolerance,
    Unknown,
    axis,
    column,
    found,
    given,
    hookimpl,
    inputs,
    normal,
    results,
    state,
    states,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UP, DOWN = tuple(20.0 * step for step in range(-10, 10)), tuple(-20.0 * step for step in range(-10, 10))
LOOP = (*UP[10:], *DOWN, *UP, 200.0)
"""A torque that goes up, down to the other side, and up again, N m."""


@inputs
class Drive:
    """A geared drive whose motor is held fast, and the torque that turns its output."""

    times: Float = given(tuple(float(n) for n in range(len(LOOP))), "s", along="time", note="when the twist is read")
    torque: Float = given(LOOP, "N*m", symbol="T", along="time", note="torque at the output")
    stiffness: Float = given(20.0, "N*m/arcmin", symbol="k", note="stiffness of the gearing, flank on flank", above=0)
    play: Float = given(0.5, "arcmin", symbol="b", note="play of the gearing, flank to flank", at_least=0)
    friction: Float = given(6.0, "N*m", symbol="M_R", note="dry friction of gearing and seals", at_least=0)
    housing_stiffness: Float = given(60.0, "N*m/arcmin", symbol="k_h", note="stiffness of the housing", above=0)
    softness: Float = given(1.0, "", symbol="s", note="by how much softer the housing is", above=0)
    slipping: Float = given(0.0, "arcmin/(N*m)", symbol="c_s", note="compliance of a flange that slips", at_least=0)
    grip: Float = given(40.0, "N*m", symbol="M_s", note="torque from which on it slips", at_least=0)
    rest: Float = given(0.0, "arcmin", symbol="phi_r", note="where the gearing stands at first")
    zero: Float = given(0.0, "arcmin", symbol="phi_0", note="twist that the gauge shows in the middle of the play")


@states
class Place:
    """Where the parts have been left: what is rubbed stays there until the torque moves it on."""

    left: Float = state(
        "arcmin",
        start="rest",
        symbol="x",
        note="twist of the gearing before a reading",
        rate="min(max(left, least), most)",
    )
    held: Float = state(
        "N*m", start=0, symbol="y", note="torque on the spring of the flange before a reading",
        rate="min(max(held, torque - grip), torque + grip)",
    )  # fmt: skip


@results
class Twist:
    """The record, and what makes it."""

    time: Float = axis("s", symbol="t", follows="times")
    least: Float = found(
        "arcmin",
        symbol="x_min",
        along="time",
        note="twist at which friction just holds the gearing up",
        formula="(torque - friction) / stiffness + cases(play / 2, torque > friction, -play / 2)",
    )
    most: Float = found(
        "arcmin",
        symbol="x_max",
        along="time",
        note="twist at which friction just holds it down",
        formula="(torque + friction) / stiffness + cases(-play / 2, torque < -friction, play / 2)",
    )
    gearing: Float = found(
        "arcmin", symbol="x", along="time", note="twist of the gearing", method="stays where it is between the two"
    )
    flange: Float = found(
        "arcmin",
        symbol="phi_s",
        along="time",
        note="twist of the flange",
        method="compliance times the torque on its spring, which follows that at the output by the grip",
    )
    housing: Float = found(
        "arcmin",
        symbol="phi_h",
        along="time",
        note="twist of the housing, by a gauge of its own",
        formula="softness * torque / housing_stiffness",
    )
    twist: Float = found(
        "arcmin",
        symbol="phi",
        along="time",
        note="twist that the gauge shows",
        formula="zero + gearing + housing + flange",
    )
    widest: Float = found(
        "arcmin", symbol="phi_w", note="from the least to the largest twist", formula="max(twist) - min(twist)"
    )  # fmt: skip


def least(drive: Drive) -> Float:
    """Twist below which friction does not hold the gearing, rad."""
    spring = drive.torque - drive.friction
    return spring / drive.stiffness + np.where(spring > 0, 0.5, -0.5) * drive.play


def most(drive: Drive) -> Float:
    """Twist above which friction does not hold the gearing, rad."""
    spring = drive.torque + drive.friction
    return spring / drive.stiffness + np.where(spring < 0, -0.5, 0.5) * drive.play


def moved(place: Place, drive: Drive) -> Place:
    """Where a torque takes the parts to, or leaves them."""
    return Place(
        left=np.clip(place.left, least(drive), most(drive)),
        held=np.clip(place.held, drive.torque - drive.grip, drive.torque + drive.grip),
    )


def next_place(place: Place, drive: Drive, time: Float) -> Place:
    """Where the parts stand at the next reading before they move: where this one has left them."""
    return moved(place, drive)


def twisted(drive: Drive, motion: Motion[Place]) -> Twist:
    """The record as the gauge shows it."""
    along = in_columns(drive)
    place = moved(motion.states, along)
    housing = along.softness * along.torque / along.housing_stiffness
    flange = along.slipping * place.held
    shown = along.zero + place.left + housing + flange
    return Twist(
        time=motion.time,
        least=least(along),
        most=most(along),
        gearing=place.left,
        flange=flange,
        housing=housing,
        twist=shown,
        widest=np.max(shown, axis=-1) - np.min(shown, axis=-1),
    )


NUMBERS = ("stiffness", "play", "friction", "housing_stiffness", "softness", "slipping", "grip", "zero")


def in_columns(drive: Drive) -> Drive:
    """The inputs as they meet the record: one row per drive."""
    return replace(drive, **{name: column(getattr(drive, name)) for name in NUMBERS})


def worn_flanks(drive: Drive, *, depth: Float) -> Drive:
    """Wear opens the play."""
    return replace(drive, play=drive.play + depth)


def dry_friction(drive: Drive, *, torque: Float) -> Drive:
    """Gearing or seals rub more."""
    return replace(drive, friction=drive.friction + torque)


def soft_housing(drive: Drive, *, share: Float) -> Drive:
    """The housing gives way more: a crack, or a thinner casting."""
    return replace(drive, softness=drive.softness + share)


def loose_flange(drive: Drive, *, compliance: Float, grip: Float) -> Drive:
    """Loose bolts: above a torque the flange slips on its seat, and springs back as late."""
    return replace(drive, slipping=drive.slipping + compliance, grip=grip)


EFFECTS = [
    Effect(
        "worn_flanks", on_inputs=worn_flanks, looks_like="the branches part, and jump near a torque of zero",
        remedy="Replace the worn gears or reset their play; the jump of the branches near a torque of zero is then "
               "smaller.",
        unknowns=[Unknown("depth", 0, 5, "arcmin", note="play that is added")],
    ),
    Effect(
        "dry_friction", on_inputs=dry_friction, looks_like="the loop is wider everywhere; it stands still after a turn",
        remedy="Check lubricant, seals and preload of the gearing; the loop is then narrower everywhere.",
        unknowns=[Unknown("torque", 0, 40, "N*m", note="friction that is added")],
    ),
    Effect(
        "soft_housing", on_inputs=soft_housing, looks_like="a steeper loop, no wider",
        remedy="Look for a crack in the housing, and repair or replace it; the loop is then less steep.",
        unknowns=[Unknown("share", 0, 2, note="by which it gives way more")],
    ),
    Effect(
        "loose_flange", on_inputs=loose_flange, looks_like="a bend in each branch at the same torque after a turn",
        remedy="Tighten the bolts of the flange to their torque; the bend in each branch is gone then.",
        unknowns=[
            Unknown("compliance", 0, 0.1, "arcmin/(N*m)", note="of the flange as it slips"),
            Unknown("grip", 15, 150, "N*m", note="torque from which on it slips"),
        ],
    ),
]  # fmt: skip

TOLERANCES = [
    Tolerance("stiffness", normal(sd="3 %"), why="of the catalogue"),
    Tolerance("housing_stiffness", normal(sd="3 %"), why="calculated"),
    Tolerance("rest", normal(sd="0.5 arcmin"), why="nobody knows where it stood at first"),
    Tolerance("zero", normal(sd="0.5 arcmin"), why="the gauge was put anywhere"),
]


def draw_loop(record: Record[Drive, Twist]) -> "Figure":
    """Twist over torque."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.0, 3.6), layout="constrained")
    axes = figure.subplots()
    axes.plot(np.asarray(record.acting.torque), np.degrees(record.results.twist) * 60)
    axes.axhline(0, color="0.7", linewidth=0.8)
    axes.axvline(0, color="0.7", linewidth=0.8)
    axes.set_xlabel("torque, N·m")
    axes.set_ylabel("twist, arcmin")
    return figure


TORQUE_LOOP = Model(
    name="torque_loop",
    title="Torque loop of a geared drive",
    summary="Twist of a drive whose motor is held fast while the torque at its output goes slowly up and down.",
    function=Dynamics(step=next_place, gives=twisted),
    errors=[*TOLERANCES, *EFFECTS],
    cites=["W. D. Iwan, A distributed-element model for hysteresis, J. Appl. Mech. 33 (1966) 893-900"],
    sheet=[
        Section("Loop", "twist", "widest", figure=draw_loop),
        Section("What moves", "gearing", "least", "most", "housing", "flange"),
    ],
)


@hookimpl
def truing_models() -> list[Model[Drive, Twist]]:
    """Offer one calculation: torque_loop."""
    return [TORQUE_LOOP]
