"""One pair of teeth over its load: stiffness by every rule, clearance in every reading, and the table of both."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harmonic_fractal import clearance as gap
from harmonic_fractal.contact import contact_of, pressed
from harmonic_fractal.drawn_look import (
    BLUE,
    GREEN,
    GREY,
    INK,
    MICRO,
    NANO,
    ORANGE,
    Run,
    microns,
    panels,
    quiet,
    signed,
)
from harmonic_fractal.interface import interface_of
from harmonic_fractal.mesh import load_of_largest, mesh_of
from harmonic_fractal.quantities import Drive
from truing import Block, Drawing, Table, Words

Array = NDArray[np.float64]
Critical = Literal["hardness", "yield_onset"]
Tip = Literal["fixed", "scaled"]
POINTS = 121
LOADS = (0.1, 1.0, 2.0, 5.0, 10.0, 25.0, 50.0, 100.0)
RULES: tuple[tuple[Critical, Tip], ...] = (
    ("hardness", "fixed"),
    ("hardness", "scaled"),
    ("yield_onset", "fixed"),
    ("yield_onset", "scaled"),
)
NAMES: dict[Critical, str] = {
    "hardness": "elastic from load = hardness × area",
    "yield_onset": "elastic up to first yield",
}
TIPS: dict[Tip, str] = {"fixed": "tip radius its own", "scaled": "tip radius follows the area"}
MEAN_PLANE = 0.48  # of the rms height: how far mean planes part while the load falls by e (Persson 2007)


@dataclass(frozen=True, kw_only=True)
class Loaded:
    """One pair over its load, N: stiffness in N/m, load exponent, clearances in m; NaN where nothing can be counted."""

    load: Array
    stiffness: Array
    exponent: Array
    amplitude: Array
    closing: Array


def loaded(drive: "Drive", load: Array) -> Loaded:
    """Calculate one pair at these loads."""
    contact = contact_of(drive, interface_of(drive))
    pair = pressed(load, contact)
    reference = load_of_largest(drive.reference_torque, mesh_of(drive, contact))
    opened = sum(gap.heights(drive)) / 2.0
    closed = gap.approach(load, reference, contact)
    return Loaded(
        load=load,
        stiffness=np.asarray(pair.stiffness),
        exponent=np.asarray(pair.load_exponent),
        amplitude=np.asarray(gap.amplitude(np.sqrt(pair.largest_area / np.pi), contact, drive.density)),
        closing=np.where(np.isinf(closed), np.nan, np.maximum(opened - closed, 0.0)),
    )


def pair_figure(drive: "Drive") -> "Figure":
    """Draw stiffness and clearance over the load."""
    stated = float(drive.pair_load)
    load = np.geomspace(min(1e-2, stated / 10.0), max(150.0, 3.0 * stated), POINTS)
    figure, (upper, lower) = panels(2, 6.4, sharex=True, height_ratios=(3, 2))
    _stiffnesses(upper, drive, load)
    _clearances(lower, drive, load)
    for panel in (upper, lower):
        panel.axvline(stated, color=INK, linewidth=0.9, linestyle=(0, (4, 3)))
    lower.set_xlabel("normal load F of the pair, N")
    return figure


def _stiffnesses(panel: Any, drive: "Drive", load: Array) -> None:
    own = (drive.critical_rule, drive.tip_rule)
    for rule, colour in zip(RULES, (BLUE, BLUE, ORANGE, ORANGE), strict=True):
        critical, tip = rule
        values = loaded(replace(drive, critical_rule=critical, tip_rule=tip), load).stiffness
        label = f"{NAMES[critical]}, {TIPS[tip]}{' (used)' if rule == own else ''}"
        panel.loglog(load, np.where(values > 0.0, values, np.nan), "-" if tip == "fixed" else ":", color=colour,
                     linewidth=2.2 if rule == own else 1.1, label=label)  # fmt: skip
    height = gap.patch_rms(interface_of(drive), drive.patch_length, drive.density)
    panel.loglog(load, load / (MEAN_PLANE * height), "--", color=GREY, linewidth=1.1,
                 label="F / (0.48 rms height of the patch), Persson 2007")  # fmt: skip
    quiet(panel, "", "stiffness K of the pair, N/m")
    panel.legend(loc="upper left", fontsize=7)


def _clearances(panel: Any, drive: "Drive", load: Array) -> None:
    curves = loaded(drive, load)
    own = {"amplitude": 1.0, "interference": 2.0}
    for rule, multiple in own.items():
        used = drive.clearance_rule == rule
        words = "amplitude of the largest contact" if rule == "amplitude" else "twice it: its interference"
        panel.semilogx(load, NANO * multiple * curves.amplitude, "-" if rule == "amplitude" else ":", color=GREEN,
                       linewidth=2.2 if used else 1.1, label=f"equation 7, {words}")  # fmt: skip
    contact = contact_of(drive, interface_of(drive))
    patch = float(gap.amplitude(drive.patch_length / 2.0, contact, drive.density))
    panel.axhline(
        NANO * patch, color=GREY, linestyle="--", linewidth=1.1, label="equation 7, longest wave of the patch"
    )
    panel.semilogx(load, NANO * curves.closing, color=ORANGE, linewidth=1.6, label="what closes: $b_0 - ∫dF/K$")
    panel.set_ylim(bottom=0.0)
    quiet(panel, "", "clearance, nm")
    panel.legend(loc="best", fontsize=7)


def stiffness(record: "Run") -> "Sequence[Block]":
    """The pair over its load, in a figure and in numbers, with what limits the number."""
    drive = record.acting
    stated = float(drive.pair_load)
    curves = loaded(drive, np.array(sorted({*LOADS, stated})))
    columns = zip(curves.load, curves.stiffness, curves.exponent, NANO * curves.amplitude, NANO * curves.closing,
                  strict=True)  # fmt: skip
    rows = [tuple(float(value) for value in row) for row in columns]
    blocks: list[Block] = [
        Drawing(
            "Stiffness and clearance over the load", partial(pair_figure, drive),
            "Dashed upright: the load of this run. Where a contact turns elastic and whether its tip radius follows "
            "its area are choices of the model; thick is what this run takes. Grey: an independent law for nearly "
            "all loads, from the rms height alone.",
        ),
        Table(
            "One pair over its load", ("load F", "stiffness K", "m = d ln K/d ln F", "b, amplitude", "b_c, closing"),
            rows, ("N", "N/m", "", "nm", "nm"),
        ),
    ]  # fmt: skip
    return [*_limits(record), *blocks, _single(drive, record)]


def _single(drive: "Drive", record: "Run") -> Table:
    """The largest contact, and the one that just turns elastic: a sphere of its own radius under its own load."""
    contact = contact_of(drive, interface_of(drive))
    rows: list[tuple[str | float, ...]] = []
    for words, name in (("the largest", "largest_area"), ("just elastic", "critical_area")):
        area = float(record.answers[name])
        radius = np.sqrt(area / np.pi)
        interference = 2.0 * float(gap.amplitude(radius, contact, drive.density))
        tip = area / (2.0 * np.pi * interference)
        force = 4.0 / 3.0 * float(contact.modulus) * np.sqrt(tip) * interference**1.5
        stiffness = 2.0 * float(contact.modulus) * np.sqrt(area / (2.0 * np.pi)) * float(contact.tip_factor)
        row = (MICRO * radius, NANO * interference, MICRO * tip, force, stiffness)
        rows.append((words, *(float(value) for value in row)))
    columns = ("contact", "radius, truncated", "interference", "tip radius", "elastic load", "stiffness")
    note = (
        "Truncated: where the undeformed flank is cut off; the real area of an elastic contact is half of it. The "
        "interference is twice the clearance of equation 7 for that radius."
    )
    return Table("Single contacts", columns, rows, ("", "µm", "nm", "µm", "N", "N/m"), note)


def _limits(record: "Run") -> "Sequence[Block]":
    """Warn where the number stands on little."""
    found: list[Block] = []
    share = float(record.answers["resolved_share"])
    if share < 0.3:
        radius = share * float(record.answers["spacing"])
        found.append(
            Words(
                f"Extrapolated below resolution: the stiffness hangs on contacts of {signed(radius * NANO)} nm radius, "
                f"{signed(share)} of the sampling interval of {microns(float(record.answers['spacing']))}; less than "
                "0.3 is a power law carried on to lengths that nobody has measured.",
                "warning",
            )
        )
    if float(record.answers["stiffness"]) == 0.0:
        found.append(Words("All contacts of the pair are plastic at this load: the model gives it no stiffness.",
                           "warning"))  # fmt: skip
    return found
