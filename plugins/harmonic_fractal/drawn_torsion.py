"""Torsion over the torque: of roughness alone, of the whole model, and of the drive in the catalogue."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harmonic_fractal.calculation import around_of
from harmonic_fractal.catalogue import Polyline, polyline_of, ratio_of
from harmonic_fractal.contact import contact_of
from harmonic_fractal.drawn_look import BLUE, GREY, INK, MICRO, ORANGE, Run, panels, quiet, signed
from harmonic_fractal.interface import interface_of
from harmonic_fractal.mesh import mesh_of
from harmonic_fractal.quantities import Drive
from harmonic_fractal.torsion import mesh_torsion
from truing import Block, Drawing, Table, Words

Array = NDArray[np.float64]
POINTS = 101


@dataclass(frozen=True, kw_only=True)
class Torsions:
    """Over torques, N m: torsions in rad."""

    torque: Array
    rough: Array
    model: Array
    catalogue: Array


def torsions(drive: "Drive", printed: Polyline, torque: Array) -> Torsions:
    """Calculate the torsion at positive torques."""
    mesh = mesh_of(drive, contact_of(drive, interface_of(drive)))
    whole, rough = mesh_torsion(torque, drive.reference_torque, mesh)
    beyond = np.maximum(torque - drive.reference_torque, 0.0)
    return Torsions(
        torque=torque,
        rough=np.asarray(rough),
        model=np.asarray(whole + around_of(drive).compliance * beyond),
        catalogue=np.asarray(printed.torsion(torque)),
    )


def torsion(record: "Run") -> "Sequence[Block]":
    """The figure, the table at the torques of the catalogue, and what follows; nothing without one of the two."""
    drive = record.acting
    printed = polyline_of(drive.catalogue_size, ratio_of(drive))
    if printed is None or np.isnan(record.answers["rough_torsion"]):
        return []
    stated = abs(float(drive.torque))
    first, second = printed.first_torque, printed.second_torque
    curves = torsions(drive, printed, np.array(sorted({first, second, 2.0 * second, *([stated] if stated else [])})))
    rows = [
        (float(torque), MICRO * float(rough), MICRO * float(model), MICRO * float(known), 100.0 * float(rough / known))
        for torque, rough, model, known in zip(curves.torque, curves.rough, curves.model, curves.catalogue, strict=True)
    ]
    name = f"size {drive.catalogue_size}, ratio {ratio_of(drive):g}"
    return [
        Drawing(
            "Torsion over the torque", partial(torsion_figure, drive, printed),
            f"Catalogue: {name}. It includes cup, wave generator and bearing; knees at T_1 = {first:g} N m and T_2 = "
            f"{second:g} N m.",
        ),
        Table(
            "Torsion at the torques of the catalogue",
            ("torque", "roughness alone", "this model", f"catalogue, {name}", "share of roughness"), rows,
            ("N*m", "urad", "urad", "urad", "%"),
        ),
        Words(_conclusion(record, curves, float(around_of(drive).compliance))),
    ]  # fmt: skip


def _conclusion(record: "Run", curves: Torsions, compliance: float) -> str:
    most = 100.0 * float(np.max(curves.rough / curves.catalogue))
    text = (
        f"Rough contacts alone explain at most {signed(most, '.2g')} % of the torsion in the catalogue. They are not "
        "the weakest link of the drive; bending of the teeth, cup, wave generator and bearing are."
        if most < 10.0
        else f"Rough contacts alone would explain {signed(most, '.3g')} % of the catalogue's torsion; look at D, G and "
        "the engaged pairs again, for other parts of the drive are known to carry most of it."
    )
    if compliance == 0.0:
        text += (
            " In this run everything around the mesh is rigid: state drive_compliance, or cup_length, to compare whole "
            "drives."
        )
    return text


def torsion_figure(drive: "Drive", printed: Polyline) -> "Figure":
    """Draw the torsions, and below what share of the catalogue's each explains."""
    last = max(2.0 * printed.second_torque, 1.1 * abs(float(drive.torque)))
    curves = torsions(drive, printed, np.linspace(last / POINTS, last, POINTS))
    figure, (upper, lower) = panels(2, 5.6, sharex=True, height_ratios=(3, 2))
    drawn = (
        ("catalogue", curves.catalogue, INK, "-"),
        ("this model", curves.model, BLUE, "-"),
        ("roughness alone", curves.rough, ORANGE, "--"),
    )
    for words, values, colour, style in drawn:
        upper.plot(curves.torque, MICRO * values, style, color=colour, linewidth=1.6, label=words)
        if words != "catalogue":
            lower.semilogy(curves.torque, 100.0 * values / curves.catalogue, style, color=colour, linewidth=1.6)
    for knee in (printed.first_torque, printed.second_torque):
        upper.axvline(knee, color=GREY, linewidth=0.8, linestyle=":")
    lower.axhline(100.0, color=INK, linewidth=1.0)
    upper.set_xlim(0.0, last)
    upper.set_ylim(bottom=0.0)
    quiet(upper, "", "torsion θ, µrad")
    quiet(lower, "torque T, N m", "share of the\ncatalogue's torsion, %")
    upper.legend(loc="upper left", fontsize=8)
    return figure
