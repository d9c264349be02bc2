"""What the gearing calculation answers: the duty, every factor, the stresses, and what they may be.

Factors are declared beside the functions that calculate them and stand here as parts. All names are flat outside; what
belongs to one gear ends with ``_sun`` or ``_planet``.
"""

from rv_gearing.bending_factors import BendingFactors, GearRoot
from rv_gearing.contact_factors import ContactFactors
from rv_gearing.dynamic import Dynamics
from rv_gearing.face_load import FaceLoad
from rv_gearing.life import Cycles, GearLife
from rv_gearing.pair import GearSize, MeshSize
from rv_gearing.quality import GearQuality, MeshQuality
from rv_gearing.steel import Steel
from rv_gearing.stiffness import Stiffness
from rv_gearing.transverse import PlanetSharing, Sharing
from truing import Float, found, part, results

BASE = "0 in the calculation; effects act here"
PART_2 = "equation 13 of the paper; ISO 6336-2:2006, clause 5"
PART_3 = "equation 10 of the paper; GB/T 3480-1997"
BEARS_2 = "equation 14 of the paper; ISO 6336-2:2006, clause 5"
BEARS_3 = "equation 11 of the paper; ISO 6336-3:2006, clause 5"
METHOD_B = "ISO 6336-3:2006, clause 5, method B"
MOST_SAFETY = 1000.0  # a stage without load is that safe


@results
class Duty:
    """What the drive does, and what it asks of one mesh."""

    pins: Float = found("", symbol="Z_5", note="pins", method="those stated, else those of the group", digits=4)
    ratio: Float = found("", symbol="i", note="input turns over output turns", source="equation 1 of the paper",
                         formula="1 + teeth_planet * pins / teeth_sun")  # fmt: skip
    pin_ratio: Float = found("", symbol="k", note="pins over teeth of the disc", formula="pins / (pins - 1)")
    mesh_efficiency: Float = found(
        "", symbol="eta_16", note="efficiency of both meshes", source="equation 8 of the paper",
        formula="(pin_ratio - 1) * (pin_ratio - cycloid_efficiency + tooth_ratio * pin_ratio * involute_efficiency)"
        " / ((pin_ratio - cycloid_efficiency) * (pin_ratio - 1 + tooth_ratio * pin_ratio))",
    )  # fmt: skip
    sun_speed: Float = found("rpm", symbol="n_1", note="speed of the sun",
                             formula="either(input_speed, output_speed * ratio)")  # fmt: skip
    mesh_speed: Float = found("rpm", symbol="n_rel", note="speed of the sun relative to the carrier",
                              formula="either(stated_mesh_speed, sun_speed * (1 - 1 / ratio))")  # fmt: skip
    asked_torque: Float = found(
        "N*m", symbol="T_a", note="torque asked for at the output: as given, else that of the power", numeric=True,
        formula="abs(either(load_torque, 9550 * power / sun_speed * ratio * mesh_efficiency * bearing_efficiency**3))",
    )  # fmt: skip
    sun_torque: Float = found(
        "N*m", symbol="T_1", note="torque of the sun; as stated where it is",
        formula="either(stated_sun_torque, asked_torque / (ratio * mesh_efficiency * bearing_efficiency**3))",
    )  # fmt: skip
    output_torque: Float = found("N*m", symbol="T_2", note="torque at the output",
                                 formula="sun_torque * ratio * mesh_efficiency * bearing_efficiency**3")  # fmt: skip
    tangential_force: Float = found("N", symbol="F_t", note="tangential force of one mesh, without load factors",
                                    formula="2 * sun_torque / (planets * reference_diameter_sun)")  # fmt: skip
    pitch_line_velocity: Float = found("m/s", symbol="v", note="pitch line velocity relative to the carrier",
                                       formula="pi * reference_diameter_sun * mesh_speed")  # fmt: skip
    carrying_width: Float = found("mm", symbol="b_w", note="face width that carries",
                                  formula="carrying_share * face_width")  # fmt: skip
    line_load: Float = found("N/mm", symbol="w", note="line load with the application factor", numeric=True,
                             formula="max(tangential_force * application_factor / carrying_width, 0.001)")  # fmt: skip


@results
class GearStress:
    """Sizes, quality and factors of one gear, its stresses, what they may be, and how safe it is."""

    nominal_root_stress: Float = found(
        "MPa", symbol="sigma_F0", note="nominal root stress, load at the tip", source=PART_3,
        formula="tangential_force / (carrying_width * module) * form_factor * stress_correction"
        " * contact_ratio_factor_bending * helix_factor_bending",
    )  # fmt: skip
    root_stress: Float = found(
        "MPa", symbol="sigma_F", note="root stress, load at the tip", source=PART_3,
        formula="nominal_root_stress * application_factor * dynamic_factor * face_factor_bending"
        " * transverse_factor_bending * planet_factor_bending * tip_load_factor",
    )  # fmt: skip
    nominal_root_stress_outer: Float = found(
        "MPa", symbol="sigma_F0,B", note="nominal root stress, load at the outer single contact", source=METHOD_B,
        formula="tangential_force / (carrying_width * module) * form_factor_outer * stress_correction_outer"
        " * helix_factor_bending * deep_tooth_factor",
    )  # fmt: skip
    root_stress_outer: Float = found(
        "MPa", symbol="sigma_F,B", note="root stress, load at the outer single contact", source=METHOD_B,
        formula="nominal_root_stress_outer * application_factor * dynamic_factor * face_factor_bending"
        " * transverse_factor_bending * planet_factor_bending",
    )  # fmt: skip
    permitted_root_stress: Float = found(
        "MPa", symbol="sigma_FP", note="permitted root stress", source=BEARS_3,
        formula="bending_limit * stress_correction_of_test * bending_life_factor * notch_sensitivity * root_surface"
        " * bending_size / least_bending_safety",
    )  # fmt: skip
    root_safety: Float = found(
        "", symbol="S_F", note="safety against breakage, load at the tip; 1000 at most", source=BEARS_3,
        formula="min(permitted_root_stress * least_bending_safety / root_stress, 1000)",
    )  # fmt: skip
    root_safety_outer: Float = found(
        "", symbol="S_F,B", note="safety against breakage, load at the outer single contact; 1000 at most",
        source=METHOD_B, formula="min(permitted_root_stress * least_bending_safety / root_stress_outer, 1000)",
    )  # fmt: skip
    contact_stress: Float = found(
        "MPa", symbol="sigma_H", note="contact stress", source=PART_2,
        formula="single_contact_factor * nominal_contact_stress * sqrt(application_factor * dynamic_factor"
        " * face_factor * transverse_factor * planet_factor)",
    )  # fmt: skip
    permitted_contact_stress: Float = found(
        "MPa", symbol="sigma_HP", note="permitted contact stress", source=BEARS_2,
        formula="contact_limit * contact_life_factor * lubricant_factor * velocity_factor * roughness_factor"
        " * work_hardening_factor * contact_size_factor / least_contact_safety",
    )  # fmt: skip
    contact_safety: Float = found(
        "", symbol="S_H", note="safety against pitting; 1000 at most", source=BEARS_2,
        formula="min(permitted_contact_stress * least_contact_safety / contact_stress, 1000)",
    )  # fmt: skip
    size: GearSize = part(GearSize, suffix="")
    quality: GearQuality = part(GearQuality, suffix="")
    root: GearRoot = part(GearRoot, suffix="")
    life: GearLife = part(GearLife, suffix="")


@results
class Strength:
    """The first stage under its load."""

    contact_stress: Float = found("MPa", symbol="sigma_H", note="contact stress of the sun",
                                  method="as of the sun")  # fmt: skip
    transmission_error: Float = found("um", symbol="TE", note="along the line of action", method=BASE)
    efficiency: Float = found("", symbol="eta", note="input to output", source="equations 6 and 7 of the paper",
                              formula="mesh_efficiency * bearing_efficiency**3")  # fmt: skip
    flank_temperature: Float = found("degC", symbol="theta_M", note="of the flanks", method="that of the oil")
    backlash: Float = found(
        "um", symbol="j_n", note="along the line of action; 0 at the centre distance without backlash",
        source="ISO 21771", formula="cases(0, centre_distance_deviation <= 0,"
        " (base_diameter_sun + base_diameter_planet) * (inv(working_angle) - inv(tight_angle))"
        " * cos(base_helix_angle))",
    )  # fmt: skip
    nominal_contact_stress: Float = found(
        "MPa", symbol="sigma_H0", note="nominal contact stress at the pitch point", source=PART_2,
        formula="zone_factor * elasticity_factor * contact_ratio_factor * helix_factor"
        " * sqrt(tangential_force / (reference_diameter_sun * carrying_width) * (tooth_ratio + 1) / tooth_ratio)",
    )  # fmt: skip
    contact_safety: Float = found("", symbol="S_H", note="least safety against pitting of both gears",
                                  formula="min(contact_safety_sun, contact_safety_planet)")  # fmt: skip
    root_safety: Float = found("", symbol="S_F", note="least safety against breakage of both gears, load at the tip",
                               formula="min(root_safety_sun, root_safety_planet)")  # fmt: skip
    root_safety_outer: Float = found(
        "", symbol="S_F,B", note="least safety against breakage of both gears, load at the outer single contact",
        formula="min(root_safety_outer_sun, root_safety_outer_planet)",
    )  # fmt: skip
    duty: Duty = part(Duty, suffix="")
    mesh: MeshSize = part(MeshSize, suffix="")
    quality: MeshQuality = part(MeshQuality, suffix="")
    steel: Steel = part(Steel, suffix="")
    stiffness: Stiffness = part(Stiffness, suffix="")
    dynamics: Dynamics = part(Dynamics, suffix="")
    planets: PlanetSharing = part(PlanetSharing, suffix="")
    face: FaceLoad = part(FaceLoad, suffix="")
    sharing: Sharing = part(Sharing, suffix="")
    contact: ContactFactors = part(ContactFactors, suffix="")
    bending: BendingFactors = part(BendingFactors, suffix="")
    cycles: Cycles = part(Cycles, suffix="")
    sun: GearStress = part(GearStress, index="1")
    planet: GearStress = part(GearStress, index="2")
