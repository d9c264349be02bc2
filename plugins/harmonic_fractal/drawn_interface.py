"""What is said of D and G: where they come from, both flanks as one, and G in every convention that is in use."""

from collections.abc import Sequence

import numpy as np

from harmonic_fractal.drawn_look import Run, signed
from harmonic_fractal.drawn_verdict import said_of
from harmonic_fractal.interface import Rough, flanks_of
from harmonic_fractal.power_law import Convention, constant, converted
from harmonic_fractal.quantities import Drive
from truing import Block, Table, Words

KINDS: dict[Convention, str] = {
    "areal": "areal, ridges in all directions (used here)",
    "one_direction": "areal, ridges across the trace",
    "profile": "profile, Weierstrass-Mandelbrot, with ln γ",
}
STATED = "No flank was measured: D and G are as stated, and how sure they are is not known."


def flanks(record: "Run") -> "Sequence[Block]":
    """Every measured flank with its verdict; else that nothing was measured."""
    drive = record.acting
    blocks: list[Block] = []
    if drive.surface is not None:
        blocks += said_of(
            drive.surface, "flexspline", f"it is that of the D and G stated in the inputs, {_stated(drive)}"
        )
    if drive.mating_surface is not None:
        blocks += said_of(drive.mating_surface, "circular spline", _mating(drive))
    return blocks or [Words(STATED)]


def _stated(drive: "Drive") -> str:
    return f"D = {float(drive.fractal_dimension):.4g} and G = {signed(float(drive.fractal_roughness))} m"


def _mating(drive: "Drive") -> str:
    if np.isnan(drive.mating_dimension):
        return "mating_dimension is not stated, so the circular spline is taken as smooth"
    stated = f"D = {float(drive.mating_dimension):.4g} and G = {signed(float(drive.mating_roughness))} m"
    return f"it is that of the D and G stated in the inputs, {stated}"


def interface(record: "Run") -> "Sequence[Block]":
    """Both flanks and their sum, and G in every convention."""
    return [_both(record), conventions(record)]


def _both(record: "Run") -> Table:
    drive = record.acting
    first, second = flanks_of(drive)
    rows = [
        ("flexspline", *_numbers(first), _origin(drive.surface)),
        ("circular spline", *_numbers(second), "smooth" if second is None else _origin(drive.mating_surface)),
        ("both together", float(record.answers["dimension"]), float(record.answers["roughness"]), _sum(drive, second)),
    ]
    note = "Independent flanks add their structure functions; one power law is fitted to the sum."
    return Table("Both flanks", ("flank", "D", "G, areal", "from"), rows, ("", "", "m", ""), note)


def _numbers(rough: "Rough | None") -> tuple[float | None, float | None]:
    return (None, None) if rough is None else (float(rough.dimension), float(rough.roughness))


def _origin(flank: object) -> str:
    used = getattr(flank, "used", None)
    if used is None:
        return "as stated" if flank is None else "as stated: the surface is refused"
    return {"x": "measured, along x only", "y": "measured, along y only", "both": "measured, x and y"}[used.direction]


def _sum(drive: "Drive", second: "Rough | None") -> str:
    deviates = float(drive.dimension_deviation) or float(drive.roughness_deviation)
    words = "one flank alone" if second is None else "sum of the structure functions"
    return f"{words}, and the stated deviations" if deviates else words


def conventions(record: "Run") -> Table:
    """G of both flanks in every convention, and by the constant that lacks a factor."""
    drive, areal = record.acting, float(record.answers["roughness"])
    profile, density = float(record.answers["profile_dimension"]), float(drive.density)
    rows = [
        (
            words,
            float(constant(profile, density, kind)),
            value := _converted(areal, profile, density, kind),
            value / areal,
        )
        for kind, words in KINDS.items()
    ]
    shorter = (2.0 * np.pi) ** (4.0 - 2.0 * profile)
    lacking = rows[-1][2] * shorter ** (1.0 / (2.0 * (profile - 1.0)))
    usual = "profile, by the constant often printed, without (2π)^(4 − 2 D_s)"
    rows.append((usual, rows[-1][1] / shorter, lacking, lacking / areal))
    note = (
        "One and the same surface: S = C G^(2(D_s − 1)) ξ^(4 − 2 D_s). A G without its convention is no number to "
        "calculate with. The last row belongs to waves counted in radians per metre; as a G of the first it is wrong."
    )
    return Table("G in each convention", ("convention", "C", "G", "over the areal one"), rows, ("", "", "m", ""), note)


def _converted(areal: float, profile: float, density: float, kind: Convention) -> float:
    return float(converted(areal, profile, density, source="areal", target=kind))
