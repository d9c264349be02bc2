"""How accurately the teeth are made, and how much of it runs in.

Reference: ISO 1328-1:1995 for the deviations, at the actual module, diameter and face width instead of the mean of
their range, and not rounded; ISO 6336-1:2006 for running-in.
"""

import numpy as np

from rv_gearing.pair import GearSize, MeshSize
from rv_gearing.quantities import Gear, Gearing
from truing import Float, found, results

ISO_1328 = "ISO 1328-1:1995"
RUNNING_IN = "ISO 6336-1:2006, 8.3.5"
GRADE = " * 2**((accuracy_grade - 5) / 2)"
SLOW, FAST = 5.0, 10.0  # m/s; between them, and above, through-hardened gears run in less
SHARE, MOST = 0.075, 3e-6  # of a deviation that case-hardened and nitrided gears run in, m


@results
class GearQuality:
    """Deviations of one gear, and what it runs in."""

    pitch_deviation: Float = found("um", symbol="f_pt", note="single pitch deviation", numeric=True, source=ISO_1328,
                                   formula="(0.3 * (module + 0.4 * sqrt(reference_diameter)) + 4)" + GRADE)  # fmt: skip
    profile_deviation: Float = found(
        "um", symbol="f_f alpha ", note="profile form deviation", numeric=True, source=ISO_1328,
        formula="(2.5 * sqrt(module) + 0.17 * sqrt(reference_diameter) + 0.5)" + GRADE,
    )  # fmt: skip
    helix_deviation: Float = found(
        "um", symbol="f_H beta ", note="helix slope deviation", numeric=True, source=ISO_1328,
        formula="(0.07 * sqrt(reference_diameter) + 0.45 * sqrt(face_width) + 3)" + GRADE,
    )  # fmt: skip
    pitch_running_in: Float = found(
        "um", symbol="y_p", note="what the gear takes off the pitch deviation", source=RUNNING_IN,
        method="case-hardened and nitrided: 0.075 f_pb, at most 3 um; through-hardened: 160 f_pb/sigma_Hlim, limited "
        "above 5 m/s",
    )  # fmt: skip
    profile_running_in: Float = found(
        "um", symbol="y_f", note="what the gear takes off the profile deviation", source=RUNNING_IN,
        method="as for the pitch, with the profile form deviation",
    )  # fmt: skip


@results
class MeshQuality:
    """Deviations of the mesh: those of the worse gear, as made and after running in."""

    pitch_error: Float = found(
        "um", symbol="f_pb", note="transverse base pitch deviation", source=ISO_1328,
        formula="max(pitch_deviation_sun, pitch_deviation_planet) * cos(transverse_angle)",
    )  # fmt: skip
    profile_error: Float = found("um", symbol="f_f alpha", note="profile form deviation of the worse gear",
                                 formula="max(profile_deviation_sun, profile_deviation_planet)")  # fmt: skip
    running_in: Float = found("um", symbol="y_alpha", note="running-in allowance of the pitch", source=RUNNING_IN,
                              formula="(pitch_running_in_sun + pitch_running_in_planet) / 2")  # fmt: skip
    pitch_left: Float = found("um", symbol="f_pb,eff", note="effective base pitch deviation", source=RUNNING_IN,
                              formula="pitch_error - running_in")  # fmt: skip
    profile_left: Float = found(
        "um", symbol="f_f alpha,eff", note="effective profile form deviation", source="ISO 6336-1:2006, 6.5.4",
        formula="profile_error - (profile_running_in_sun + profile_running_in_planet) / 2",
    )  # fmt: skip


def quality_of(
    stage: Gearing, sizes: tuple[GearSize, GearSize], mesh: MeshSize, velocity: Float
) -> tuple[tuple[GearQuality, GearQuality], MeshQuality]:
    """Return the quality of sun, planet and mesh; ``velocity`` is that of the pitch line, m/s."""
    made = [deviations(stage, size.reference_diameter) for size in sizes]
    pitch = np.maximum(made[0][0], made[1][0]) * np.cos(mesh.transverse_angle)
    profile = np.maximum(made[0][1], made[1][1])
    gears = [
        GearQuality(
            pitch_deviation=each[0],
            profile_deviation=each[1],
            helix_deviation=each[2],
            pitch_running_in=run_in(stage, gear, pitch, velocity),
            profile_running_in=run_in(stage, gear, profile, velocity),
        )
        for each, gear in zip(made, (stage.sun, stage.planet), strict=True)
    ]
    allowance = 0.5 * (gears[0].pitch_running_in + gears[1].pitch_running_in)
    return (gears[0], gears[1]), MeshQuality(
        pitch_error=pitch,
        profile_error=profile,
        running_in=allowance,
        pitch_left=pitch - allowance,
        profile_left=profile - 0.5 * (gears[0].profile_running_in + gears[1].profile_running_in),
    )


def deviations(stage: Gearing, diameter: Float) -> tuple[Float, Float, Float]:
    """Return single pitch, profile form and helix slope deviation, m, of a gear of this reference diameter, m."""
    grade = 2.0 ** (0.5 * (stage.accuracy_grade - 5.0)) * 1e-6
    module_mm, diameter_mm, width_mm = 1e3 * stage.module, 1e3 * diameter, 1e3 * stage.face_width
    pitch = 0.3 * (module_mm + 0.4 * np.sqrt(diameter_mm)) + 4.0
    profile = 2.5 * np.sqrt(module_mm) + 0.17 * np.sqrt(diameter_mm) + 0.5
    helix = 0.07 * np.sqrt(diameter_mm) + 0.45 * np.sqrt(width_mm) + 3.0
    return grade * pitch, grade * profile, grade * helix


def run_in(stage: Gearing, gear: Gear, deviation: Float, velocity: Float) -> Float:
    """Return what a gear takes off a pitch or profile deviation, m."""
    if stage.material != "through_hardened":
        return np.minimum(SHARE * deviation, MOST)
    limit_mpa = 1e-6 * gear.contact_limit
    most_um = np.where(velocity <= SLOW, np.inf, np.where(velocity <= FAST, 12800.0, 6400.0) / limit_mpa)
    return np.minimum(np.minimum(160.0 / limit_mpa, 1.0) * deviation, 1e-6 * most_um)
