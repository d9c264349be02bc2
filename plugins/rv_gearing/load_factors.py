"""What multiplies the load of a mesh: accuracy, stiffness, dynamic factor, face load, transverse load, planets.

Reference: ISO 6336-1:2006; the parts below name their clauses.
"""

import numpy as np

from gear_geometry.mesh_load import face_factor
from rv_gearing.geometry import GearSize, MeshSize, ToothLoad
from rv_gearing.quantities import Gear, Gearing
from truing import Float, either, feasible, found, results

# How accurately the teeth are made, and how much of it runs in
#
# Reference: ISO 1328-1:1995 for the deviations, at the actual module, diameter and face width instead of the mean of
# their range, and not rounded; ISO 6336-1:2006 for running-in.

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


def run_in(stage: Gearing, gear: Gear, deviation: Float, velocity: Float, *, times: float = 1.0) -> Float:
    """Return what a gear takes off a pitch or profile deviation, m; of a misalignment two ``times`` as much."""
    if stage.material != "through_hardened":
        return np.minimum(times * SHARE * deviation, times * MOST)
    limit_mpa = 1e-6 * gear.contact_limit
    most_um = times * np.where(velocity <= SLOW, np.inf, np.where(velocity <= FAST, 12800.0, 6400.0) / limit_mpa)
    return np.minimum(np.minimum(times * 160.0 / limit_mpa, 1.0) * deviation, 1e-6 * most_um)


# How stiff a tooth and a mesh are. Reference: ISO 6336-1:2006, clause 9, method B, solid gears

CLAUSE_9 = "ISO 6336-1:2006, 9.3.1"
FULL_LOAD = 100e3  # N/m; below it a mesh is softer
STEEL_MODULUS = 206e9  # Pa


@results
class MeshStiffness:
    """Stiffness of tooth and mesh, per face width."""

    tooth_compliance: Float = found(
        "mm*um/N", symbol="q'", note="compliance of a pair of teeth, theoretical", numeric=True, source=CLAUSE_9,
        formula="0.04723 + 0.15551 / virtual_teeth_sun + 0.25791 / virtual_teeth_planet - 0.00635 * shift_sun"
        " - 0.11654 * shift_sun / virtual_teeth_sun - 0.00193 * shift_planet"
        " - 0.24188 * shift_planet / virtual_teeth_planet + 0.00529 * shift_sun**2 + 0.00182 * shift_planet**2",
    )  # fmt: skip
    theoretical_stiffness: Float = found("N/(mm*um)", symbol="c'_th", note="stiffness of a pair of teeth, theoretical",
                                         formula="1 / tooth_compliance", source=CLAUSE_9)  # fmt: skip
    rack_factor: Float = found("", symbol="C_B", note="basic rack factor", numeric=True,
                               source="ISO 6336-1:2006, 9.3.1.4",
                               formula="(1 + 0.5 * (1.2 - dedendum)) * (1 - 0.02 * (20 - pressure_angle))")  # fmt: skip
    modulus_factor: Float = found(
        "", symbol="zeta", note="moduli of both gears against steel", numeric=True, source=CLAUSE_9,
        formula="2 * young_modulus_sun * young_modulus_planet / ((young_modulus_sun + young_modulus_planet) * 206)",
    )  # fmt: skip
    low_load_factor: Float = found("", symbol="c_w", note="softer contact below 100 N/mm", numeric=True,
                                   source=CLAUSE_9, formula="min((line_load / 100)**0.25, 1)")  # fmt: skip
    tooth_stiffness: Float = found(
        "N/(mm*um)", symbol="c'", note="stiffness of a pair of teeth", source=CLAUSE_9,
        formula="0.8 * rack_factor * cos(helix_angle) * modulus_factor * low_load_factor * theoretical_stiffness",
    )  # fmt: skip
    mesh_stiffness: Float = found(
        "N/(mm*um)", symbol="c_gamma alpha", note="mean mesh stiffness", source="ISO 6336-1:2006, 9.3.2",
        formula="either(stated_mesh_stiffness, tooth_stiffness * (0.75 * contact_ratio + 0.25))",
    )  # fmt: skip
    mesh_stiffness_face: Float = found("N/(mm*um)", symbol="c_gamma beta", note="mesh stiffness for the face factor",
                                       source="ISO 6336-1:2006, 9.3.2", formula="0.85 * mesh_stiffness")  # fmt: skip


def stiffness_of(
    stage: Gearing, load: ToothLoad, sizes: tuple[GearSize, GearSize], contact_ratio: Float
) -> MeshStiffness:
    """Return the stiffness of tooth and mesh."""
    first, second = sizes[0].virtual_teeth, sizes[1].virtual_teeth
    x_1, x_2 = stage.sun.shift, stage.planet.shift
    compliance_um = (
        0.04723 + 0.15551 / first + 0.25791 / second - 0.00635 * x_1 - 0.11654 * x_1 / first - 0.00193 * x_2
        - 0.24188 * x_2 / second + 0.00529 * x_1**2 + 0.00182 * x_2**2
    )  # fmt: skip
    theoretical = 1e9 / compliance_um
    rack = (1.0 + 0.5 * (1.2 - stage.dedendum)) * (1.0 - 0.02 * (20.0 - np.degrees(stage.pressure_angle)))
    moduli = stage.sun.young_modulus, stage.planet.young_modulus
    modulus = 2.0 * moduli[0] * moduli[1] / ((moduli[0] + moduli[1]) * STEEL_MODULUS)
    low = np.minimum((load.duty.line_load / FULL_LOAD) ** 0.25, 1.0)
    tooth = 0.8 * rack * np.cos(stage.helix_angle) * modulus * low * theoretical
    mesh = either(stage.stated_mesh_stiffness, tooth * (0.75 * contact_ratio + 0.25))
    return MeshStiffness(
        tooth_compliance=1e-9 * compliance_um,
        theoretical_stiffness=theoretical,
        rack_factor=rack,
        modulus_factor=modulus,
        low_load_factor=low,
        tooth_stiffness=tooth,
        mesh_stiffness=mesh,
        mesh_stiffness_face=0.85 * mesh,
    )


# How much the teeth excite one another: the dynamic factor. Reference: ISO 6336-1:2006, 6.5, method B

CLAUSE_6 = "ISO 6336-1:2006, 6.5"
COEFFICIENT = "ISO 6336-1:2006, 6.5, table of C_v"
COARSE = 6  # accuracy grade from which tip relief does not count


@results
class MeshDynamics:
    """Inertia, resonance and dynamic factor of the mesh."""

    inertia_sun: Float = found("kg*mm", symbol="J_1", note="moment of inertia of the sun per face width",
                               source=CLAUSE_6, formula="pi / 32 * density * (1 - bore_ratio_sun**4)"
                               " * ((tip_diameter_sun + root_diameter_sun) / 2)**4")  # fmt: skip
    inertia_planet: Float = found("kg*mm", symbol="J_2", note="moment of inertia of a planet per face width",
                                  source=CLAUSE_6, formula="pi / 32 * density * (1 - bore_ratio_planet**4)"
                                  " * ((tip_diameter_planet + root_diameter_planet) / 2)**4")  # fmt: skip
    reduced_mass: Float = found(
        "kg/mm", symbol="m_red", note="reduced mass of sun and planets per face width",
        source="ISO 6336-1:2006, 6.5.8 and 6.5.9",
        formula="4 * inertia_sun * inertia_planet / (planets * inertia_planet * base_diameter_sun**2"
        " + inertia_sun * base_diameter_planet**2)",
    )  # fmt: skip
    resonance_speed: Float = found("rpm", symbol="n_E", note="resonance speed of the mesh",
                                   source="ISO 6336-1:2006, 6.5.3",
                                   formula="sqrt(mesh_stiffness / reduced_mass) / (2 * pi * teeth_sun)")  # fmt: skip
    resonance_ratio: Float = found("", symbol="N", note="mesh speed over resonance speed",
                                   source="ISO 6336-1:2006, 6.5.3", formula="mesh_speed / resonance_speed")  # fmt: skip
    resonance_limit: Float = found(
        "", symbol="N_S", note="end of the range below resonance", numeric=True, source="ISO 6336-1:2006, 6.5.3",
        formula="cases(0.85, line_load >= 100, 0.5 + 0.35 * sqrt(line_load / 100))",
    )  # fmt: skip
    pitch_influence: Float = found("", symbol="B_p", note="influence of the pitch deviation",
                                   source="ISO 6336-1:2006, 6.5.4",
                                   formula="tooth_stiffness * pitch_left / line_load")  # fmt: skip
    profile_influence: Float = found("", symbol="B_f", note="influence of the profile deviation",
                                     source="ISO 6336-1:2006, 6.5.4",
                                     formula="tooth_stiffness * profile_left / line_load")  # fmt: skip
    relief_influence: Float = found(
        "", symbol="B_k", note="influence of the tip relief", source="ISO 6336-1:2006, 6.5.4",
        formula="cases(1, accuracy_grade >= 6, abs(1 - tooth_stiffness * tip_relief / line_load))",
    )  # fmt: skip
    profile_coefficient: Float = found(
        "", symbol="C_v2", note="for the profile deviation", source=COEFFICIENT,
        formula="cases(0.34, total_contact_ratio <= 2, 0.57 / (total_contact_ratio - 0.3))",
    )  # fmt: skip
    stiffness_coefficient: Float = found(
        "", symbol="C_v3", note="for the changing stiffness, below resonance", source=COEFFICIENT,
        formula="cases(0.23, total_contact_ratio <= 2, 0.096 / (total_contact_ratio - 1.56))",
    )  # fmt: skip
    resonance_coefficient: Float = found(
        "", symbol="C_v4", note="for the changing stiffness, at resonance", source=COEFFICIENT,
        formula="cases(0.90, total_contact_ratio <= 2,"
        " (0.57 - 0.05 * total_contact_ratio) / (total_contact_ratio - 1.44))",
    )  # fmt: skip
    fast_coefficient: Float = found(
        "", symbol="C_v6", note="for the profile deviation, above resonance", source=COEFFICIENT,
        formula="cases(0.47, total_contact_ratio <= 2, 0.12 / (total_contact_ratio - 1.74))",
    )  # fmt: skip
    fast_constant: Float = found(
        "", symbol="C_v7", note="for the changing stiffness, above resonance", source=COEFFICIENT,
        formula="cases(0.75, total_contact_ratio <= 1.5, 0.125 * sin(pi * (total_contact_ratio - 2)) + 0.875,"
        " total_contact_ratio <= 2.5, 1)",
    )  # fmt: skip
    dynamic_slow: Float = found("", symbol="K", note="growth of the dynamic factor below resonance",
                                source="ISO 6336-1:2006, 6.5.4",
                                formula="0.32 * pitch_influence + profile_coefficient * profile_influence"
                                        " + stiffness_coefficient * relief_influence")  # fmt: skip
    dynamic_resonant: Float = found("", symbol="K_V,115", note="dynamic factor at resonance",
                                    source="ISO 6336-1:2006, 6.5.5",
                                    formula="1 + 0.32 * pitch_influence + profile_coefficient * profile_influence"
                                            " + resonance_coefficient * relief_influence")  # fmt: skip
    dynamic_fast: Float = found(
        "", symbol="K_V,150", note="dynamic factor above resonance", source="ISO 6336-1:2006, 6.5.6",
        formula="0.47 * pitch_influence + fast_coefficient * profile_influence + fast_constant",
    )  # fmt: skip
    dynamic_factor: Float = found(
        "", symbol="K_V", note="dynamic factor; as stated where it is", source="ISO 6336-1:2006, 6.5.4 to 6.5.7",
        formula="either(stated_dynamic_factor, cases(1 + resonance_ratio * dynamic_slow,"
        " resonance_ratio <= resonance_limit, dynamic_resonant, resonance_ratio <= 1.15,"
        " dynamic_fast + (dynamic_resonant - dynamic_fast) * (1.5 - resonance_ratio) / 0.35, resonance_ratio < 1.5,"
        " dynamic_fast)) + extra_dynamic_factor",
    )  # fmt: skip


def dynamics_of(
    stage: Gearing, load: ToothLoad, sizes: tuple[GearSize, GearSize], total_contact_ratio: Float,
    held: tuple[MeshQuality, MeshStiffness],
) -> MeshDynamics:  # fmt: skip
    """Return the dynamic factor with all that it follows from; ``held`` is quality and stiffness of the mesh."""
    quality, stiffness = held
    inertia = [
        np.pi / 32.0 * stage.density * (1.0 - gear.bore_ratio**4)
        * (0.5 * (size.tip_diameter + size.root_diameter)) ** 4
        for gear, size in zip((stage.sun, stage.planet), sizes, strict=True)
    ]  # fmt: skip
    bases = load.base_radii
    mass = inertia[0] * inertia[1] / (stage.planets * inertia[1] * bases[0] ** 2 + inertia[0] * bases[1] ** 2)
    resonance = np.sqrt(stiffness.mesh_stiffness / mass) / (2.0 * np.pi * load.sun)
    ratio, limit = load.duty.mesh_speed / resonance, resonance_limit(load.duty.line_load)
    specific = stiffness.tooth_stiffness / load.duty.line_load
    pitch, profile = specific * quality.pitch_left, specific * quality.profile_left
    relief = 1.0 if stage.accuracy_grade >= COARSE else np.abs(1.0 - specific * stage.tip_relief)
    c_2, c_3, c_4, c_6, c_7 = coefficients(total_contact_ratio)
    slow = 0.32 * pitch + c_2 * profile + c_3 * relief
    resonant = 1.0 + 0.32 * pitch + c_2 * profile + c_4 * relief
    fast = 0.47 * pitch + c_6 * profile + c_7
    factor = either(stage.stated_dynamic_factor, by_range(ratio, limit, (slow, resonant, fast)))
    factor = factor + stage.extra_dynamic_factor
    feasible(factor > 0.0, "the dynamic factor must exceed 0: raise extra_dynamic_factor")
    return MeshDynamics(
        inertia_sun=inertia[0], inertia_planet=inertia[1], reduced_mass=mass, resonance_speed=resonance,
        resonance_ratio=ratio, resonance_limit=limit, pitch_influence=pitch, profile_influence=profile,
        relief_influence=relief, profile_coefficient=c_2, stiffness_coefficient=c_3, resonance_coefficient=c_4,
        fast_coefficient=c_6, fast_constant=c_7, dynamic_slow=slow, dynamic_resonant=resonant, dynamic_fast=fast,
        dynamic_factor=factor,
    )  # fmt: skip


def resonance_limit(line_load: Float) -> Float:
    """Return N_S, the speed ratio at which the resonance range begins, for a line load in N/m."""
    return np.where(line_load >= FULL_LOAD, 0.85, 0.5 + 0.35 * np.sqrt(line_load / FULL_LOAD))


def coefficients(ratio: Float) -> tuple[Float, Float, Float, Float, Float]:
    """Return C_v2, C_v3, C_v4, C_v6 and C_v7 for a total contact ratio; C_v1 is 0.32 and C_v5 0.47 for all."""
    low = np.less_equal(ratio, 2.0)
    bent = np.where(np.less_equal(ratio, 2.5), 0.125 * np.sin(np.pi * (ratio - 2.0)) + 0.875, 1.0)
    with np.errstate(divide="ignore"):
        return (
            np.where(low, 0.34, 0.57 / (ratio - 0.3)),
            np.where(low, 0.23, 0.096 / (ratio - 1.56)),
            np.where(low, 0.90, (0.57 - 0.05 * ratio) / (ratio - 1.44)),
            np.where(low, 0.47, 0.12 / (ratio - 1.74)),
            np.where(np.less_equal(ratio, 1.5), 0.75, bent),
        )


def by_range(ratio: Float, limit: Float, factors: tuple[Float, Float, Float]) -> Float:
    """Return the dynamic factor at a speed ratio; ``factors`` are growth below, factor at and factor above resonance.

    The standard lets it jump at ``limit``; from there on it is continuous.
    """
    slow, resonant, fast = factors
    between = fast + (resonant - fast) * (1.5 - ratio) / 0.35
    above = np.where(ratio <= 1.15, resonant, np.where(ratio < 1.5, between, fast))
    return np.where(ratio <= limit, 1.0 + ratio * slow, above)


# How unevenly the face width carries. Reference: ISO 6336-1:2006, 7.5, method C, without bending of the shaft

CLAUSE_7 = "ISO 6336-1:2006, 7.5"
FORM = "by the form of the flank"
WEIGHTS = {
    "none": (1.0, 1.0), "crowned": (1.0, 0.5), "helix_corrected": (0.1, 1.0), "crowned_and_corrected": (0.1, 0.5),
    "end_relief": (0.7, 0.7),
}  # fmt: skip


@results
class FaceLoad:
    """Misalignment of the flanks and the face load factors."""

    mean_line_load: Float = found("N/mm", symbol="w_m", note="mean line load with K_A, K_V and K_Hp",
                                  numeric=True, formula="max(line_load * dynamic_factor * planet_factor, 0.001)",
                                  source=CLAUSE_7)  # fmt: skip
    bending_weight: Float = found("", symbol="B_1", note="weight of the deflection", method=FORM, source=CLAUSE_7)
    making_weight: Float = found("", symbol="B_2", note="weight of the deviation as made", method=FORM, source=CLAUSE_7)
    deflection: Float = found("um", symbol="f_sh", note="misalignment by bending and twist of the sun", numeric=True,
                              formula="0.023 * (face_width / reference_diameter_sun)**2 * mean_line_load",
                              source=CLAUSE_7)  # fmt: skip
    making_deviation: Float = found("um", symbol="f_ma", note="misalignment as made", source=CLAUSE_7,
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
        "um", symbol="y_beta", note="what both gears run in, their mean", source=CLAUSE_7,
        method="case-hardened and nitrided: 0.15 F_betax, at most 6 um; through-hardened: 320 F_betax/sigma_Hlim, "
        "limited above 5 m/s",
    )  # fmt: skip
    settled_misalignment: Float = found("um", symbol="F_beta y,0", note="misalignment after running in",
                                        source=CLAUSE_7, formula="initial_misalignment - face_running_in")  # fmt: skip
    settled_ratio: Float = found("", symbol="r_0", note="the same over twice the mean deflection",
                                 formula="settled_misalignment * mesh_stiffness_face / (2 * mean_line_load)",
                                 source=CLAUSE_7)  # fmt: skip
    face_factor_alone: Float = found(
        "", symbol="K_H beta,0", note="face load factor of these deviations; as stated where it is", source=CLAUSE_7,
        formula="either(stated_face_factor,"
        " cases(1 + settled_ratio, settled_ratio <= 1, 2 * sqrt(settled_ratio)))",
    )  # fmt: skip
    misalignment: Float = found(
        "um", symbol="F_beta y", note="misalignment by this factor and what comes on top, which may act against it",
        formula="abs(cases(face_factor_alone - 1, face_factor_alone <= 2, (face_factor_alone / 2)**2)"
        " * 2 * mean_line_load / mesh_stiffness_face + extra_misalignment)",
        source=CLAUSE_7,
    )  # fmt: skip
    misalignment_ratio: Float = found("", symbol="r", note="the same over twice the mean deflection",
                                      formula="misalignment * mesh_stiffness_face / (2 * mean_line_load)",
                                      source=CLAUSE_7)  # fmt: skip
    face_factor: Float = found("", symbol="K_H beta", note="face load factor for contact", source=CLAUSE_7,
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
    ran_in = 0.5 * sum(run_in(stage, gear, initial, velocity, times=2.0) for gear in (stage.sun, stage.planet))
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


# How unevenly the teeth in mesh, and the planets, share the load
#
# Reference: ISO 6336-1:2006, 8.3, method B, for the teeth; Rao Zhenggang, Design of planetary transmissions, for K_Fp.

CLAUSE_8 = "ISO 6336-1:2006, 8.3"


@results
class PlanetSharing:
    """How unevenly the planets share."""

    planet_factor: Float = found(
        "", symbol="K_Hp", note="uneven sharing among the planets, with the error of sharing; none carries more",
        formula="min(max(planet_load_factor + sharing_error * mesh_stiffness * application_factor / line_load, 0),"
        " max(planets, planet_load_factor))",
        source="equation 13 of the paper",
    )  # fmt: skip
    planet_factor_bending: Float = found(
        "", symbol="K_Fp", note="uneven sharing among the planets, for bending; as stated where it is",
        formula="either(stated_planet_load_bending, max(1 + 1.5 * (planet_factor - 1), 0))",
        source="Rao Zhenggang, Design of planetary transmissions",
    )  # fmt: skip


@results
class Sharing:
    """How unevenly the teeth share."""

    transverse_line_load: Float = found("N/mm", symbol="w_tH", note="line load that parts the teeth", source=CLAUSE_8,
                                        formula="mean_line_load * face_factor")  # fmt: skip
    transverse_base: Float = found(
        "", symbol="K_alpha", note="transverse load factor before its bounds", source=CLAUSE_8,
        formula="cases(total_contact_ratio / 2 * (0.9 + 0.4 * mesh_stiffness * pitch_left / transverse_line_load),"
        " total_contact_ratio <= 2, 0.9 + 0.4 * sqrt(2 * (total_contact_ratio - 1) / total_contact_ratio)"
        " * mesh_stiffness * pitch_left / transverse_line_load)",
    )  # fmt: skip
    transverse_factor: Float = found(
        "", symbol="K_H alpha", note="transverse load factor for contact, within its bounds; as stated where it is",
        source=CLAUSE_8, formula="either(stated_transverse_factor, max(min(transverse_base,"
        " total_contact_ratio / (contact_ratio * contact_ratio_factor**2)), 1))",
    )  # fmt: skip
    transverse_factor_bending: Float = found(
        "", symbol="K_F alpha", note="transverse load factor for bending, within its bounds; as stated where it is",
        source=CLAUSE_8, formula="either(stated_transverse_factor_bending, max(min(transverse_base,"
        " total_contact_ratio / (0.25 * contact_ratio + 0.75)), 1))",
    )  # fmt: skip


def sharing_of(
    stage: Gearing, mesh: MeshSize, line_load: Float, pitch_left: Float, held: tuple[Float, Float]
) -> Sharing:
    """Return how the teeth share; ``line_load`` (N/m) holds all factors up to K_Hbeta.

    ``held`` are the mesh stiffness and the contact ratio factor Z_epsilon.
    """
    stiffness, z_epsilon = held
    total, contact = mesh.total_contact_ratio, mesh.contact_ratio
    error = stiffness * pitch_left / line_load
    base = np.where(
        total <= 2.0, 0.5 * total * (0.9 + 0.4 * error), 0.9 + 0.4 * np.sqrt(2.0 * (total - 1.0) / total) * error
    )
    most_h, most_f = total / (contact * z_epsilon**2), total / (0.25 * contact + 0.75)
    return Sharing(
        transverse_line_load=line_load,
        transverse_base=base,
        transverse_factor=either(stage.stated_transverse_factor, np.maximum(np.minimum(base, most_h), 1.0)),
        transverse_factor_bending=either(
            stage.stated_transverse_factor_bending, np.maximum(np.minimum(base, most_f), 1.0)
        ),
    )


def planets_of(stage: Gearing, line_load: Float, stiffness: Float) -> PlanetSharing:
    """Return how the planets share: as stated, and more by one that runs ahead, at most all; N/m and N/m2."""
    ahead = stage.sharing_error * stiffness * stage.application_factor / line_load
    most = np.maximum(float(stage.planets), stage.planet_load_factor)
    factor = np.minimum(np.maximum(stage.planet_load_factor + ahead, 0.0), most)
    bending = np.maximum(1.0 + 1.5 * (factor - 1.0), 0.0)
    return PlanetSharing(planet_factor=factor, planet_factor_bending=either(stage.stated_planet_load_bending, bending))
