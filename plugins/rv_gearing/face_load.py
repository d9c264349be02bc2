"""How unevenly the face width carries. Reference: ISO 6336-1:2006, 7.5, method C, without bending of the shaft."""

import numpy as np

from gear_geometry.mesh_load import face_factor
from rv_gearing.pair import GearSize, MeshSize
from rv_gearing.quality import GearQuality
from rv_gearing.quantities import Gear, Gearing
from truing import Float, either, found, results

CLAUSE = "ISO 6336-1:2006, 7.5"
FORM = "by the form of the flank"
WEIGHTS = {
    "none": (1.0, 1.0), "crowned": (1.0, 0.5), "helix_corrected": (0.1, 1.0), "crowned_and_corrected": (0.1, 0.5),
    "end_relief": (0.7, 0.7),
}  # fmt: skip
SHARE, MOST = 0.15, 6e-6  # of the misalignment that case-hardened and nitrided gears run in, m
SLOW, FAST = 5.0, 10.0  # m/s


@results
class FaceLoad:
    """Misalignment of the flanks and the face load factors."""

    mean_line_load: Float = found("N/mm", symbol="w_m", note="mean line load with K_A, K_V and K_Hp",
                                  numeric=True, formula="max(line_load * dynamic_factor * planet_factor, 0.001)",
                                  source=CLAUSE)  # fmt: skip
    bending_weight: Float = found("", symbol="B_1", note="weight of the deflection", method=FORM, source=CLAUSE)
    making_weight: Float = found("", symbol="B_2", note="weight of the deviation as made", method=FORM, source=CLAUSE)
    deflection: Float = found("um", symbol="f_sh", note="misalignment by bending and twist of the sun", numeric=True,
                              formula="0.023 * (face_width / reference_diameter_sun)**2 * mean_line_load",
                              source=CLAUSE)  # fmt: skip
    making_deviation: Float = found("um", symbol="f_ma", note="misalignment as made", source=CLAUSE,
                                    formula="hypot(helix_deviation_sun, helix_deviation_planet)")  # fmt: skip
    least_misalignment: Float = found(
        "um", symbol="F_beta x,min", note="least initial misalignment", numeric=True, source="ISO 6336-1:2006, 7.5.2",
        formula="max(0.005 * mean_line_load, 0.5 * max(helix_deviation_sun, helix_deviation_planet))",
    )  # fmt: skip
    initial_misalignment: Float = found(
        "um", symbol="F_beta x", note="misalignment before running in", source="ISO 6336-1:2006, 7.5.2",
        formula="max(1.33 * bending_weight * deflection + making_weight * making_deviation, least_misalignment)",
    )  # fmt: skip
    face_running_in: Float = found(
        "um", symbol="y_beta", note="what both gears run in, their mean", source=CLAUSE,
        method="case-hardened and nitrided: 0.15 F_betax, at most 6 um; through-hardened: 320 F_betax/sigma_Hlim, "
        "limited above 5 m/s",
    )  # fmt: skip
    settled_misalignment: Float = found("um", symbol="F_beta y,0", note="misalignment after running in", source=CLAUSE,
                                        formula="initial_misalignment - face_running_in")  # fmt: skip
    settled_ratio: Float = found("", symbol="r_0", note="the same over twice the mean deflection",
                                 formula="settled_misalignment * mesh_stiffness_face / (2 * mean_line_load)",
                                 source=CLAUSE)  # fmt: skip
    face_factor_alone: Float = found(
        "", symbol="K_H beta,0", note="face load factor of these deviations; as stated where it is", source=CLAUSE,
        formula="either(stated_face_factor,"
        " cases(1 + settled_ratio, settled_ratio <= 1, 2 * sqrt(settled_ratio)))",
    )  # fmt: skip
    misalignment: Float = found(
        "um", symbol="F_beta y", note="misalignment by this factor and what comes on top, which may act against it",
        formula="abs(cases(face_factor_alone - 1, face_factor_alone <= 2, (face_factor_alone / 2)**2)"
        " * 2 * mean_line_load / mesh_stiffness_face + extra_misalignment)",
        source=CLAUSE,
    )  # fmt: skip
    misalignment_ratio: Float = found("", symbol="r", note="the same over twice the mean deflection",
                                      formula="misalignment * mesh_stiffness_face / (2 * mean_line_load)",
                                      source=CLAUSE)  # fmt: skip
    face_factor: Float = found("", symbol="K_H beta", note="face load factor for contact", source=CLAUSE,
                               formula="cases(1 + misalignment_ratio, misalignment_ratio <= 1,"
                               " 2 * sqrt(misalignment_ratio))")  # fmt: skip
    face_exponent: Float = found(
        "", symbol="N_F", note="exponent of the face load factor for bending", source="ISO 6336-1:2006, clause 7",
        formula="1 / (1 + min(tooth_height / face_width, 1 / 3) + min(tooth_height / face_width, 1 / 3)**2)",
    )  # fmt: skip
    face_factor_bending: Float = found(
        "", symbol="K_F beta", note="face load factor for bending; as stated where it is",
        source="ISO 6336-1:2006, clause 7", formula="either(stated_face_factor_bending, face_factor**face_exponent)",
    )  # fmt: skip


def face_load_of(
    stage: Gearing, made: tuple[GearQuality, GearQuality], line_load: Float, stiffness: Float,
    sizes: tuple[GearSize, MeshSize, Float],
) -> FaceLoad:  # fmt: skip
    """Return the face load factors from the mean line load (N/m) and the stiffness for the face (N/m2).

    ``sizes`` are those of sun and mesh and the pitch line velocity.
    """
    sun, mesh, velocity = sizes
    weights = WEIGHTS[stage.flank_form]
    bent = 0.023e-9 * (stage.face_width / sun.reference_diameter) ** 2 * line_load
    making = np.hypot(made[0].helix_deviation, made[1].helix_deviation)
    least = np.maximum(5e-12 * line_load, 0.5 * np.maximum(made[0].helix_deviation, made[1].helix_deviation))
    initial = np.maximum(1.33 * weights[0] * bent + weights[1] * making, least)
    ran_in = 0.5 * sum(_run_in(stage, gear, initial, velocity) for gear in (stage.sun, stage.planet))
    per_length = stiffness / (2.0 * line_load)
    settled = initial - ran_in
    alone = either(stage.stated_face_factor, face_factor(settled * per_length))
    known = np.where(alone <= 2.0, alone - 1.0, (0.5 * alone) ** 2)
    misaligned = np.abs(known / per_length + stage.extra_misalignment)
    ratio = misaligned * per_length
    slenderness = np.minimum(mesh.tooth_height / stage.face_width, 1.0 / 3.0)
    factor, exponent = face_factor(ratio), 1.0 / (1.0 + slenderness + slenderness**2)
    return FaceLoad(
        mean_line_load=line_load, bending_weight=weights[0], making_weight=weights[1], deflection=bent,
        making_deviation=making, least_misalignment=least, initial_misalignment=initial, face_running_in=ran_in,
        settled_misalignment=settled, settled_ratio=settled * per_length, face_factor_alone=alone,
        misalignment=misaligned, misalignment_ratio=ratio, face_factor=factor, face_exponent=exponent,
        face_factor_bending=either(stage.stated_face_factor_bending, factor**exponent),
    )  # fmt: skip


def _run_in(stage: Gearing, gear: Gear, initial: Float, velocity: Float) -> Float:
    """Return what a gear takes off a misalignment, m."""
    if stage.material != "through_hardened":
        return np.minimum(SHARE * initial, MOST)
    limit_mpa = 1e-6 * gear.contact_limit
    most_um = np.where(velocity <= SLOW, np.inf, np.where(velocity <= FAST, 25600.0, 12800.0) / limit_mpa)
    return np.minimum(np.minimum(320.0 / limit_mpa, 1.0) * initial, 1e-6 * most_um)
