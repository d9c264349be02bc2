"""What a tooth root gets and bears: the factors of bending, with the load at the tip and at the outer single contact.

Y_Fa, Y_Sa and Y_epsilon belong to the load at the tip (the paper, GB/T 3480, method C of older editions); Y_F, Y_S and
Y_DT to the load at the outer point of single contact (ISO 6336-3:2006, method B). They are not mixed.
"""

import numpy as np

from gear_geometry.roots import Arm, Rack, Root, external_arm, external_root, form_factor, notch, stress_correction
from rv_gearing.pair import GearSize, MeshSize, Which
from rv_gearing.quantities import Gearing
from rv_gearing.steel import Steel
from truing import Float, either, feasible, found, results

ISO = "ISO 6336-3:2006, clause "


@results
class GearRoot:
    """Form of the tooth root of one gear; lengths in modules."""

    root_offset: Float = found("", symbol="G", note="centre of the rack's fillet from its reference line, in modules",
                               formula="fillet - dedendum + shift", source=ISO + "6")  # fmt: skip
    root_angle: Float = found(
        "deg", symbol="theta", note="where the tangent at the root is inclined by 30 degrees", source=ISO + "6",
        formula="root_angle == 2 / virtual_teeth * (root_offset * tan(root_angle) - pi / 4"
        " - dedendum * tan(pressure_angle) - (1 - sin(pressure_angle)) * fillet / cos(pressure_angle)) + pi / 3",
    )  # fmt: skip
    root_chord: Float = found(
        "", symbol="s_Fn", note="chord of the critical section, in modules", source=ISO + "6",
        formula="virtual_teeth * sin(pi / 3 - root_angle) + sqrt(3) * (root_offset / cos(root_angle) - fillet)",
    )  # fmt: skip
    root_fillet: Float = found(
        "", symbol="rho_F", note="radius of the fillet there, in modules", source=ISO + "6",
        formula="fillet + 2 * root_offset**2 / (cos(root_angle)"
        " * (virtual_teeth * cos(root_angle)**2 - 2 * root_offset))",
    )  # fmt: skip
    notch_parameter: Float = found("", symbol="q_s", note="notch parameter", formula="root_chord / (2 * root_fillet)",
                                   source=ISO + "7")  # fmt: skip
    virtual_tip_diameter: Float = found("mm", symbol="d_an", note="tip diameter of the virtual spur gear",
                                        source=ISO + "6", formula="module * virtual_teeth + tip_diameter"
                                        " - reference_diameter")  # fmt: skip
    virtual_base_diameter: Float = found("mm", symbol="d_bn", note="base diameter of the virtual spur gear",
                                         source=ISO + "6",
                                         formula="module * virtual_teeth * cos(pressure_angle)")  # fmt: skip
    virtual_tip_angle: Float = found("deg", symbol="alpha_an", note="pressure angle at this tip", source=ISO + "6",
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
        "mm", symbol="d_en", note="virtual diameter of the outer point of single contact", source=ISO + "6",
        formula="2 * hypot(sqrt(virtual_tip_diameter**2 - virtual_base_diameter**2) / 2"
        " - pi * module * cos(pressure_angle) * (virtual_contact_ratio - 1), virtual_base_diameter / 2)",
    )  # fmt: skip
    outer_angle: Float = found("deg", symbol="alpha_en", note="pressure angle there", source=ISO + "6",
                               formula="acos(virtual_base_diameter / outer_diameter)")  # fmt: skip
    outer_load_angle: Float = found(
        "deg", symbol="alpha_Fen", note="angle of the load at the outer single contact", source=ISO + "6",
        formula="outer_angle - (pi / 2 + 2 * shift * tan(pressure_angle)) / virtual_teeth - inv(pressure_angle)"
        " + inv(outer_angle)",
    )  # fmt: skip
    outer_arm: Float = found(
        "", symbol="h_Fe", note="bending arm, load at the outer single contact, in modules", source=ISO + "6",
        formula="(virtual_base_diameter / (module * cos(outer_load_angle)) - virtual_teeth * cos(pi / 3 - root_angle)"
        " - root_offset / cos(root_angle) + fillet) / 2",
    )  # fmt: skip
    form_factor_outer: Float = found(
        "", symbol="Y_F", note="form factor, load at the outer single contact", source=ISO + "6",
        formula="6 * outer_arm * cos(outer_load_angle) / (root_chord**2 * cos(pressure_angle))",
    )  # fmt: skip
    stress_correction_outer: Float = found(
        "", symbol="Y_S", note="stress correction, load at the outer single contact", source=ISO + "7",
        formula="(1.2 + 0.13 * root_chord / outer_arm)"
        " * notch_parameter**(1 / (1.21 + 2.3 * outer_arm / root_chord))",
    )  # fmt: skip
    notch_sensitivity: Float = found(
        "", symbol="Y_delta relT", note="relative notch sensitivity; as stated where it is", numeric=True,
        source=ISO + "13",
        formula="either(stated_notch_sensitivity, (1 + sqrt(0.2 * slip_layer * (1 + 2 * notch_parameter)))"
        " / (1 + sqrt(1.2 * slip_layer)))",
    )  # fmt: skip
    root_surface: Float = found(
        "", symbol="Y_RrelT", note="relative surface factor; as stated where it is", numeric=True, source=ISO + "14",
        formula="either(stated_root_surface, cases(surface_smooth, root_roughness < 1,"
        " surface_constant - surface_slope * (root_roughness + 1)**surface_exponent))",
    )  # fmt: skip
    bending_size: Float = found(
        "", symbol="Y_X", note="size factor for bending; as stated where it is", numeric=True, source=ISO + "15",
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
        "", symbol="Y_beta", note="helix factor; as stated where it is", numeric=True, source=ISO + "8",
        formula="either(stated_helix_factor_bending, 1 - min(overlap_ratio, 1) * min(helix_angle, 30) / 120)",
    )  # fmt: skip
    deep_tooth_factor: Float = found(
        "", symbol="Y_DT", note="deep tooth factor, for a load at the outer single contact alone", source=ISO + "10",
        formula="cases(1, accuracy_grade > 4 or virtual_contact_ratio <= 2.05, 2.366 - 0.666 * virtual_contact_ratio,"
        " virtual_contact_ratio <= 2.5, 0.7)",
    )  # fmt: skip
    tip_load_factor: Float = found(
        "", symbol="f_Ca", note="more load at the tip where its relief is missing",
        formula="max(1 + tooth_stiffness * relief_deviation / line_load, 0)",
    )  # fmt: skip


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
    _formed(root, which)
    virtual_tip = stage.module * teeth + size.tip_diameter - size.reference_diameter
    virtual_base = stage.module * teeth * np.cos(stage.pressure_angle)
    outer = outer_diameter(stage, (virtual_tip, virtual_base), mesh, which)
    tip = external_arm(rack, teeth, gear.shift, root, virtual_tip / stage.module)
    single = external_arm(rack, teeth, gear.shift, root, outer / stage.module)
    _loaded(tip, single, which)
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


def _formed(root: Root, which: Which) -> None:
    """Refuse a rack that leaves no root."""
    sentence = f"the rack leaves no root to the teeth of the {which}: lower dedendum or fillet, or raise shift_{which}"
    feasible((root.chord > 0.0) & (root.fillet > 0.0), sentence)


def _loaded(tip: Arm, single: Arm, which: Which) -> None:
    """Refuse a load that does not bend the tooth."""
    sentence = f"the load does not bend the teeth of the {which}, its arm is 0 or less: raise addendum or dedendum"
    feasible((tip.height > 0.0) & (single.height > 0.0), sentence)
