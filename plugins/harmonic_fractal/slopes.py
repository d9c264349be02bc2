"""What the stiffness of a pair hangs on: its logarithmic derivatives, from the study 'sensitivity'."""

from math import nan

from harmonic_fractal.contact import contact_of, pressed
from harmonic_fractal.interface import interface_of
from harmonic_fractal.quantities import Drive
from truing import Float, Sensitivities, found, results

NOTE = "relative change of the stiffness of the pair"
SOURCES = (
    "dimension_deviation", "roughness_deviation", "hardness", "youngs_modulus_flexspline", "youngs_modulus_circular",
    "pair_load", "torque", "engaged_factor", "drive_compliance",
)  # fmt: skip


@results
class Slopes:
    """By how much the stiffness of one pair changes, in parts of itself."""

    slope_dimension: Float = found("", symbol="k_D", note=f"{NOTE} per unit of D at the same G", method="differences")
    slope_roughness: Float = found("", symbol="k_G", note=f"{NOTE} per ln G", method="differences")
    slope_hardness: Float = found("", symbol="k_H", note=f"{NOTE} per ln H", method="differences")
    slope_load: Float = found("", symbol="k_F", note=f"{NOTE} per ln F; the load exponent m", method="differences")


def slopes(found_by: Sensitivities) -> Slopes:
    """Divide the derivatives by the stiffness; a source that the study was not asked for has none."""
    drive: Drive = found_by.inputs
    stiffness = float(pressed(drive.pair_load, contact_of(drive, interface_of(drive))).stiffness)
    derivative = found_by.derivatives.get("stiffness", {})

    def relative(source: str, by: Float = 1.0) -> float:
        return derivative.get(source, nan) * float(by) / stiffness if stiffness else nan

    return Slopes(
        slope_dimension=relative("dimension_deviation"),
        slope_roughness=relative("roughness_deviation"),
        slope_hardness=relative("hardness", drive.hardness),
        slope_load=relative("pair_load", drive.pair_load),
    )
