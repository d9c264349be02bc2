"""What flanks and tooth roots get and bear: the factors of contact stress (ISO 6336-2) and of bending (ISO 6336-3)."""

import numpy as np

from gear_geometry.roots import Rack, external_arm, external_root, form_factor, notch, stress_correction
from rv_gearing.geometry import GearSize, MeshSize, Which
from rv_gearing.material import Steel
from rv_gearing.quantities import Gearing
from truing import Float, either, feasible, found, results

# What the flanks bear and what they get: the factors of contact stress. Reference: ISO 6336-2:2006, method B

ISO_2 = "ISO 6336-2:2006, clause "
SOFTER = "min(contact_limit_sun, contact_limit_planet)"
MPA = 1e6


@results
class ContactFactors:
    """Factors of the contact stress that sun and planet share, and the single contact factors of both."""

    zone_factor: Float = found("", symbol="Z_H", note="zone factor; as stated where it is", source=ISO_2 + "6",
                               formula="either(stated_zone_factor, sqrt(2 * cos(base_helix_angle) * cos(working_angle)"
                                       " / (cos(transverse_angle)**2 * sin(working_angle))))")  # fmt: skip
    elasticity_factor: Float = found(
        "MPa**0.5", symbol="Z_E", note="elasticity factor; as stated where it is", source=ISO_2 + "7",
        formula="either(stated_elasticity_factor, sqrt(1 / (pi * ((1 - poisson_ratio_sun**2) / young_modulus_sun"
        " + (1 - poisson_ratio_planet**2) / young_modulus_planet))))",
    )  # fmt: skip
    contact_ratio_factor: Float = found(
        "", symbol="Z_epsilon", note="contact ratio factor; as stated where it is", source=ISO_2 + "8",
        formula="either(stated_contact_ratio_factor, sqrt(cases((4 - contact_ratio) / 3 * (1 - overlap_ratio)"
        " + overlap_ratio / contact_ratio, overlap_ratio < 1, 1 / contact_ratio)))",
    )  # fmt: skip
    helix_power: Float = found("", symbol="q_beta", note="power of cos beta in the helix factor", source=ISO_2 + "9",
                               method="-1/2 by ISO 6336:2006, 1/2 by GB/T 3480-1997")  # fmt: skip
    helix_factor: Float = found("", symbol="Z_beta", note="helix factor; as stated where it is", source=ISO_2 + "9",
                                formula="either(stated_helix_factor, cos(helix_angle)**helix_power)")  # fmt: skip
    single_contact_counts: Float = found("", symbol="s_BD", note="1 where the single contact counts, else 0",
                                         method="single_contact as stated", source=ISO_2 + "6")  # fmt: skip
    single_contact_factor_sun: Float = found(
        "", symbol="Z_B", note="single contact factor of the sun; as stated where it is", source=ISO_2 + "6",
        formula="either(stated_single_contact_sun, cases(max(1, overlap_ratio + (1 - overlap_ratio)"
        " * tan(working_angle) / sqrt((tan(tip_angle_sun) - 2 * pi / teeth_sun)"
        " * (tan(tip_angle_planet) - (contact_ratio - 1) * 2 * pi / teeth_planet))),"
        " single_contact_counts > 0 and overlap_ratio < 1, 1))",
    )  # fmt: skip
    single_contact_factor_planet: Float = found(
        "", symbol="Z_D", note="single contact factor of the planet; as stated where it is", source=ISO_2 + "6",
        formula="either(stated_single_contact_planet, cases(max(1, overlap_ratio + (1 - overlap_ratio)"
        " * tan(working_angle) / sqrt((tan(tip_angle_planet) - 2 * pi / teeth_planet)"
        " * (tan(tip_angle_sun) - (contact_ratio - 1) * 2 * pi / teeth_sun))),"
        " single_contact_counts > 0 and overlap_ratio < 1, 1))",
    )  # fmt: skip
    lubricant_constant: Float = found(
        "", symbol="C_ZL", note="share of Z_L without lubricant, by the softer gear", numeric=True, source=ISO_2 + "12",
        formula=f"cases(0.83, {SOFTER} < 850, 0.91, {SOFTER} > 1200, {SOFTER} / 4375 + 0.6357)",
    )  # fmt: skip
    lubricant_factor: Float = found(
        "", symbol="Z_L", note="lubricant factor; as stated where it is", numeric=True, source=ISO_2 + "12",
        formula="either(stated_lubricant_factor,"
        " lubricant_constant + 4 * (1 - lubricant_constant) / (1.2 + 134 / viscosity)**2)",
    )  # fmt: skip
    velocity_factor: Float = found(
        "", symbol="Z_V", note="velocity factor; as stated where it is", numeric=True, source=ISO_2 + "12",
        formula="either(stated_velocity_factor, lubricant_constant + 0.02"
        " + 2 * (0.98 - lubricant_constant) / sqrt(0.8 + 32 / pitch_line_velocity))",
    )  # fmt: skip
    relative_roughness: Float = found(
        "um", symbol="R_z10", note="mean roughness of the flanks at a relative radius of 10 mm", numeric=True,
        source=ISO_2 + "12",
        formula="(flank_roughness_sun + flank_roughness_planet) / 2 * cbrt(10 / curvature)",
    )  # fmt: skip
    roughness_exponent: Float = found(
        "", symbol="C_ZR", note="exponent of the roughness factor, by the softer gear", numeric=True,
        source=ISO_2 + "12", formula=f"cases(0.15, {SOFTER} < 850, 0.08, {SOFTER} > 1200, 0.32 - 0.0002 * {SOFTER})",
    )  # fmt: skip
    roughness_factor: Float = found(
        "", symbol="Z_R", note="roughness factor; as stated where it is", numeric=True, source=ISO_2 + "12",
        formula="either(stated_roughness_factor, (3 / relative_roughness)**roughness_exponent)",
    )  # fmt: skip


def contact_ratio_factor(stage: Gearing, mesh: MeshSize) -> Float:
    """Return Z_epsilon, as stated where it is."""
    contact, overlap = mesh.contact_ratio, mesh.overlap_ratio
    below = (4.0 - contact) / 3.0 * (1.0 - overlap) + overlap / contact
    return either(stage.stated_contact_ratio_factor, np.sqrt(np.where(overlap < 1.0, below, 1.0 / contact)))


def contact_factors(
    stage: Gearing, sizes: tuple[GearSize, GearSize], mesh: MeshSize, velocity: Float, z_epsilon: Float
) -> ContactFactors:
    """Return the factors of the contact stress and of the contact strength."""
    power = -0.5 if stage.helix_reading == "iso" else 0.5
    working = mesh.working_angle
    zone = (
        2.0 * np.cos(mesh.base_helix_angle) * np.cos(working) / (np.cos(mesh.transverse_angle) ** 2 * np.sin(working))
    )
    sun, planet = stage.sun, stage.planet
    bodies = (1.0 - sun.poisson_ratio**2) / sun.young_modulus + (1.0 - planet.poisson_ratio**2) / planet.young_modulus
    single = single_contact_factors(stage, sizes, mesh)
    softer_mpa = np.minimum(sun.contact_limit, planet.contact_limit) / MPA
    share = by_strength(softer_mpa, (0.83, 0.91), softer_mpa / 4375.0 + 0.6357)
    roughness = 0.5 * (sun.flank_roughness + planet.flank_roughness) * np.cbrt(0.01 / mesh.curvature)
    exponent = by_strength(softer_mpa, (0.15, 0.08), 0.32 - 0.0002 * softer_mpa)
    with np.errstate(divide="ignore"):
        oil = share + 4.0 * (1.0 - share) / (1.2 + 134e-6 / stage.viscosity) ** 2
        moving = share + 0.02 + 2.0 * (0.98 - share) / np.sqrt(0.8 + 32.0 / velocity)
    return ContactFactors(
        zone_factor=either(stage.stated_zone_factor, np.sqrt(zone)),
        elasticity_factor=either(stage.stated_elasticity_factor, np.sqrt(1.0 / (np.pi * bodies))),
        contact_ratio_factor=z_epsilon,
        helix_power=power,
        helix_factor=either(stage.stated_helix_factor, np.cos(stage.helix_angle) ** power),
        single_contact_counts=float(stage.single_contact),
        single_contact_factor_sun=single[0],
        single_contact_factor_planet=single[1],
        lubricant_constant=share,
        lubricant_factor=either(stage.stated_lubricant_factor, oil),
        velocity_factor=either(stage.stated_velocity_factor, moving),
        relative_roughness=roughness,
        roughness_exponent=exponent,
        roughness_factor=either(stage.stated_roughness_factor, (3e-6 / roughness) ** exponent),
    )


def by_strength(strength_mpa: Float, ends: tuple[float, float], between: Float) -> Float:
    """Return a constant by the endurance limit: the first end below 850 MPa, the second above 1200 MPa."""
    return np.where(strength_mpa < 850.0, ends[0], np.where(strength_mpa > 1200.0, ends[1], between))


def single_contact_factors(stage: Gearing, sizes: tuple[GearSize, GearSize], mesh: MeshSize) -> tuple[Float, Float]:
    """Return Z_B of the sun and Z_D of the planet: 1 where they are switched off, or the overlap is a full pitch."""
    stated = stage.sun.stated_single_contact, stage.planet.stated_single_contact
    if not stage.single_contact:
        one = 1.0 + 0.0 * mesh.contact_ratio
        return either(stated[0], one), either(stated[1], one)
    found = []
    for own, (first, second), name in zip(stated, (sizes, sizes[::-1]), ("sun", "planet"), strict=True):
        inner = np.tan(first.tip_angle) - 2.0 * np.pi / first.teeth
        outer = np.tan(second.tip_angle) - (mesh.contact_ratio - 1.0) * 2.0 * np.pi / second.teeth
        used = np.isnan(own) & (mesh.overlap_ratio < 1.0)
        feasible(
            np.logical_not(used) | ((inner > 0.0) & (outer > 0.0)),
            f"the single contact of the {name} would lie below the base circle: raise the teeth or the shifts, or set "
            "single_contact = false",
        )
        overlap = mesh.overlap_ratio
        with np.errstate(invalid="ignore", divide="ignore"):
            raised = overlap + (1.0 - overlap) * np.tan(mesh.working_angle) / np.sqrt(inner * outer)
        found.append(either(own, np.where(overlap < 1.0, np.maximum(1.0, raised), 1.0)))
    return found[0], found[1]


# What a tooth root gets and bears: the factors of bending, with the load at the tip and at the outer single contact
#
# Y_Fa, Y_Sa and Y_epsilon belong to the load at the tip (the paper, GB/T 3480, method C of older editions); Y_F, Y_S
# and Y_DT to the load at the outer point of single contact (ISO 6336-3:2006, method B). They are not mixed.

ISO_3 = "ISO 6336-3:2006, clause "


@results
class GearRoot:
    """Form of the tooth root of one gear; lengths in modules."""

    root_offset: Float = found("", symbol="G", note="centre of the rack's fillet from its reference line, in modules",
                               formula="fillet - dedendum + shift", source=ISO_3 + "6")  # fmt: skip
    root_angle: Float = found(
        "deg", symbol="theta", note="where the tangent at the root is inclined by 30 degrees", source=ISO_3 + "6",
        formula="root_angle == 2 / virtual_teeth * (root_offset * tan(root_angle) - pi / 4"
        " - dedendum * tan(pressure_angle) - (1 - sin(pressure_angle)) * fillet / cos(pressure_angle)) + pi / 3",
    )  # fmt: skip
    root_chord: Float = found(
        "", symbol="s_Fn", note="chord of the critical section, in modules", source=ISO_3 + "6",
        formula="virtual_teeth * sin(pi / 3 - root_angle) + sqrt(3) * (root_offset / cos(root_angle) - fillet)",
    )  # fmt: skip
    root_fillet: Float = found("", symbol="rho_F", note="radius of the fillet there, in modules", source=ISO_3 + "6",
                               formula="fillet + 2 * root_offset**2 / (cos(root_angle)"
                                       " * (virtual_teeth * cos(root_angle)**2 - 2 * root_offset))")  # fmt: skip
    notch_parameter: Float = found("", symbol="q_s", note="notch parameter", formula="root_chord / (2 * root_fillet)",
                                   source=ISO_3 + "7")  # fmt: skip
    virtual_tip_diameter: Float = found("mm", symbol="d_an", note="tip diameter of the virtual spur gear",
                                        source=ISO_3 + "6", formula="module * virtual_teeth + tip_diameter"
                                        " - reference_diameter")  # fmt: skip
    virtual_base_diameter: Float = found("mm", symbol="d_bn", note="base diameter of the virtual spur gear",
                                         source=ISO_3 + "6",
                                         formula="module * virtual_teeth * cos(pressure_angle)")  # fmt: skip
    virtual_tip_angle: Float = found("deg", symbol="alpha_an", note="pressure angle at this tip", source=ISO_3 + "6",
                                     formula="acos(virtual_base_diameter / virtual_tip_diameter)")  # fmt: skip
    tip_load_angle: Float = found(
        "deg", symbol="alpha_Fan", note="angle of the load at the tip", source="GB/T 3480-1997",
        formula="virtual_tip_angle - (pi / 2 + 2 * shift * tan(pressure_angle)) / virtual_teeth - inv(pressure_angle)"
        " + inv(virtual_tip_angle)",
    )  # fmt: skip
    tip_arm: Float = found(
        "", symbol="h_Fa", note="bending arm, load at the tip, in modules", source="GB/T 3480-1997",
        formula="(virtual_base_diameter / (module * cos(tip_load_angle)) - virtual_teeth * cos(pi / 3 - root_angle)"
        " - root_offset / cos(root_angle) + fillet) / 2",
    )  # fmt: skip
    form_factor: Float = found(
        "", symbol="Y_Fa", note="form factor, load at the tip; as stated where it is", source="GB/T 3480-1997",
        formula="either(stated_form_factor,"
        " 6 * tip_arm * cos(tip_load_angle) / (root_chord**2 * cos(pressure_angle)))",
    )  # fmt: skip
    stress_correction: Float = found(
        "", symbol="Y_Sa", note="stress correction, load at the tip; as stated where it is", source="GB/T 3480-1997",
        formula="either(stated_stress_correction, (1.2 + 0.13 * root_chord / tip_arm)"
        " * notch_parameter**(1 / (1.21 + 2.3 * tip_arm / root_chord)))",
    )  # fmt: skip
    outer_diameter: Float = found(
        "mm", symbol="d_en", note="virtual diameter of the outer point of single contact", source=ISO_3 + "6",
        formula="2 * hypot(sqrt(virtual_tip_diameter**2 - virtual_base_diameter**2) / 2"
        " - pi * module * cos(pressure_angle) * (virtual_contact_ratio - 1), virtual_base_diameter / 2)",
    )  # fmt: skip
    outer_angle: Float = found("deg", symbol="alpha_en", note="pressure angle there", source=ISO_3 + "6",
                               formula="acos(virtual_base_diameter / outer_diameter)")  # fmt: skip
    outer_load_angle: Float = found(
        "deg", symbol="alpha_Fen", note="angle of the load at the outer single contact", source=ISO_3 + "6",
        formula="outer_angle - (pi / 2 + 2 * shift * tan(pressure_angle)) / virtual_teeth - inv(pressure_angle)"
        " + inv(outer_angle)",
    )  # fmt: skip
    outer_arm: Float = found(
        "", symbol="h_Fe", note="bending arm, load at the outer single contact, in modules", source=ISO_3 + "6",
        formula="(virtual_base_diameter / (module * cos(outer_load_angle)) - virtual_teeth * cos(pi / 3 - root_angle)"
        " - root_offset / cos(root_angle) + fillet) / 2",
    )  # fmt: skip
    form_factor_outer: Float = found(
        "", symbol="Y_F", note="form factor, load at the outer single contact", source=ISO_3 + "6",
        formula="6 * outer_arm * cos(outer_load_angle) / (root_chord**2 * cos(pressure_angle))",
    )  # fmt: skip
    stress_correction_outer: Float = found(
        "", symbol="Y_S", note="stress correction, load at the outer single contact", source=ISO_3 + "7",
        formula="(1.2 + 0.13 * root_chord / outer_arm)"
        " * notch_parameter**(1 / (1.21 + 2.3 * outer_arm / root_chord))",
    )  # fmt: skip
    notch_sensitivity: Float = found(
        "", symbol="Y_delta relT", note="relative notch sensitivity; as stated where it is", numeric=True,
        source=ISO_3 + "13",
        formula="either(stated_notch_sensitivity, (1 + sqrt(0.2 * slip_layer * (1 + 2 * notch_parameter)))"
        " / (1 + sqrt(1.2 * slip_layer)))",
    )  # fmt: skip
    root_surface: Float = found(
        "", symbol="Y_RrelT", note="relative surface factor; as stated where it is", numeric=True, source=ISO_3 + "14",
        formula="either(stated_root_surface, cases(surface_smooth, root_roughness < 1,"
        " surface_constant - surface_slope * (root_roughness + 1)**surface_exponent))",
    )  # fmt: skip
    bending_size: Float = found(
        "", symbol="Y_X", note="size factor for bending; as stated where it is", numeric=True, source=ISO_3 + "15",
        formula="either(stated_bending_size, min(1, max(size_least, size_constant - size_slope * module)))",
    )  # fmt: skip


@results
class BendingFactors:
    """Factors of bending that both gears share."""

    contact_ratio_factor_bending: Float = found(
        "", symbol="Y_epsilon", note="contact ratio factor, for a load at the tip alone; as stated where it is",
        source="GB/T 3480-1997", formula="either(stated_contact_ratio_bending, 0.25 + 0.75 / virtual_contact_ratio)",
    )  # fmt: skip
    helix_factor_bending: Float = found(
        "", symbol="Y_beta", note="helix factor; as stated where it is", numeric=True, source=ISO_3 + "8",
        formula="either(stated_helix_factor_bending, 1 - min(overlap_ratio, 1) * min(helix_angle, 30) / 120)",
    )  # fmt: skip
    deep_tooth_factor: Float = found(
        "", symbol="Y_DT", note="deep tooth factor, for a load at the outer single contact alone", source=ISO_3 + "10",
        formula="cases(1, accuracy_grade > 4 or virtual_contact_ratio <= 2.05, 2.366 - 0.666 * virtual_contact_ratio,"
        " virtual_contact_ratio <= 2.5, 0.7)",
    )  # fmt: skip
    tip_load_factor: Float = found("", symbol="f_Ca", note="more load at the tip where its relief is missing",
                                   formula="max(1 + tooth_stiffness * relief_deviation / line_load, 0)")  # fmt: skip


def bending_factors(stage: Gearing, mesh: MeshSize, stiffness: Float, line_load: Float) -> BendingFactors:
    """Return the factors of bending that both gears share; tooth stiffness in N/m2, line load in N/m."""
    virtual = mesh.virtual_contact_ratio
    angle = np.minimum(stage.helix_angle, np.radians(30.0))
    deep = np.where(virtual <= 2.05, 1.0, np.where(virtual <= 2.5, 2.366 - 0.666 * virtual, 0.7))
    return BendingFactors(
        contact_ratio_factor_bending=either(stage.stated_contact_ratio_bending, 0.25 + 0.75 / virtual),
        helix_factor_bending=either(
            stage.stated_helix_factor_bending, 1.0 - np.minimum(mesh.overlap_ratio, 1.0) * angle / np.radians(120.0)
        ),
        deep_tooth_factor=1.0 if stage.accuracy_grade > 4 else deep,
        tip_load_factor=np.maximum(1.0 + stiffness * stage.relief_deviation / line_load, 0.0),
    )


def root_of(stage: Gearing, size: GearSize, mesh: MeshSize, steel: Steel, which: Which) -> GearRoot:
    """Return the form of the root of one gear and the factors that follow from it."""
    gear = stage.sun if which == "sun" else stage.planet
    rack = Rack(dedendum=stage.dedendum, fillet=stage.fillet, pressure_angle=stage.pressure_angle)
    teeth = size.virtual_teeth
    root = external_root(rack, teeth, gear.shift)
    sentence = f"the rack leaves no root to the teeth of the {which}: lower dedendum or fillet, or raise shift_{which}"
    feasible((root.chord > 0.0) & (root.fillet > 0.0), sentence)
    virtual_tip = stage.module * teeth + size.tip_diameter - size.reference_diameter
    virtual_base = stage.module * teeth * np.cos(stage.pressure_angle)
    outer = outer_diameter(stage, (virtual_tip, virtual_base), mesh, which)
    tip = external_arm(rack, teeth, gear.shift, root, virtual_tip / stage.module)
    single = external_arm(rack, teeth, gear.shift, root, outer / stage.module)
    sentence = f"the load does not bend the teeth of the {which}, its arm is 0 or less: raise addendum or dedendum"
    feasible((tip.height > 0.0) & (single.height > 0.0), sentence)
    sensitivity, surface, size_factor = strength_factors(steel, notch(root), gear.root_roughness, stage.module)
    return GearRoot(
        root_offset=stage.fillet - stage.dedendum + gear.shift,
        root_angle=np.arcsin((np.sqrt(12.0) * root.depth - root.chord) / (2.0 * teeth)),
        root_chord=root.chord,
        root_fillet=root.fillet,
        notch_parameter=notch(root),
        virtual_tip_angle=np.arccos(virtual_base / virtual_tip),
        tip_arm=tip.height,
        tip_load_angle=tip.angle,
        form_factor=either(gear.stated_form_factor, form_factor(root, tip, stage.pressure_angle)),
        stress_correction=either(gear.stated_stress_correction, stress_correction(root, tip)),
        virtual_tip_diameter=virtual_tip,
        virtual_base_diameter=virtual_base,
        outer_diameter=outer,
        outer_angle=np.arccos(virtual_base / outer),
        outer_arm=single.height,
        outer_load_angle=single.angle,
        form_factor_outer=form_factor(root, single, stage.pressure_angle),
        stress_correction_outer=stress_correction(root, single),
        notch_sensitivity=either(gear.stated_notch_sensitivity, sensitivity),
        root_surface=either(gear.stated_root_surface, surface),
        bending_size=either(gear.stated_bending_size, size_factor),
    )


def strength_factors(steel: Steel, parameter: Float, roughness: Float, module: Float) -> tuple[Float, Float, Float]:
    """Return Y_deltarelT, Y_RrelT and Y_X for a notch parameter, a roughness of the root and a module, m."""
    slip_mm, roughness_um = 1e3 * steel.slip_layer, 1e6 * roughness
    sensitivity = (1.0 + np.sqrt(0.2 * slip_mm * (1.0 + 2.0 * parameter))) / (1.0 + np.sqrt(1.2 * slip_mm))
    rough = steel.surface_constant - steel.surface_slope * (roughness_um + 1.0) ** steel.surface_exponent
    size = np.maximum(steel.size_least, steel.size_constant - steel.size_slope * 1e3 * module)
    return sensitivity, np.where(roughness_um < 1.0, steel.surface_smooth, rough), np.minimum(1.0, size)


def outer_diameter(stage: Gearing, virtual: tuple[Float, Float], mesh: MeshSize, which: Which) -> Float:
    """Return d_en, m: where the load leaves the tooth to itself, on the virtual spur gear of these tip and base
    diameters.
    """
    tip, base = 0.5 * virtual[0], 0.5 * virtual[1]
    pitch = np.pi * stage.module * np.cos(stage.pressure_angle)
    reach = np.sqrt(tip**2 - base**2) - pitch * (mesh.virtual_contact_ratio - 1.0)
    feasible(
        reach > 0.0,
        f"the outer single contact of the {which} would lie below its base circle: raise its teeth or shift_{which}",
    )
    return 2.0 * np.hypot(reach, base)
