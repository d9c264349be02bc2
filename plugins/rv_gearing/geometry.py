"""Sizes of sun and planet and of their mesh, what the first stage carries, and the outline of a tooth."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gear_geometry import pairs
from gear_geometry.pairs import involute, transverse_angle
from gear_geometry.roots import Rack
from rv_gearing.groups import chosen_teeth, efficiency_of, mesh_efficiency, ratio_of, torque_of
from rv_gearing.quantities import Gear, Gearing
from truing import Array, Float, either, feasible, found, results

# What the first stage carries: torque of the sun, speed relative to the carrier, and the force of one mesh
#
# The housing is fixed and the output turns with the carrier, so a mesh sees the sun turn by 1 - 1/i of its speed.
# Speeds are in turns per second, everything else in SI; a value is a number or an array (n,).

LEAST_LINE_LOAD = 1.0  # N/m; what an idle mesh counts as loaded with where something is divided by the load


@results
class Duty:
    """What the drive does, and what it asks of one mesh."""

    pins: Float = found("", symbol="Z_5", note="pins", method="those stated, else those of the group", digits=4)
    ratio: Float = found("", symbol="i", note="input turns over output turns", source="equation 1 of the paper",
                         formula="1 + teeth_planet * pins / teeth_sun", key=True)  # fmt: skip
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
                                 formula="sun_torque * ratio * mesh_efficiency * bearing_efficiency**3",
                                 key=True)  # fmt: skip
    tangential_force: Float = found("N", symbol="F_t", note="tangential force of one mesh, without load factors",
                                    formula="2 * sun_torque / (planets * reference_diameter_sun)")  # fmt: skip
    pitch_line_velocity: Float = found("m/s", symbol="v", note="pitch line velocity relative to the carrier",
                                       formula="pi * reference_diameter_sun * mesh_speed")  # fmt: skip
    carrying_width: Float = found("mm", symbol="b_w", note="face width that carries",
                                  formula="carrying_share * face_width")  # fmt: skip
    line_load: Float = found("N/mm", symbol="w", note="line load with the application factor", numeric=True,
                             formula="max(tangential_force * application_factor / carrying_width, 0.001)")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ToothLoad:
    """What one mesh of sun and planet carries: the duty as it is printed, and what else the calculation needs of it.

    The force is nominal; the line load is that of the width that carries, with the application factor, and never 0. The
    direction is the sign of the load torque, +1 where there is none.
    """

    duty: Duty
    sun: Float
    planet: Float
    efficiency: Float
    direction: Float
    base_radii: tuple[Float, Float]


def load_of(stage: Gearing) -> ToothLoad:
    """Return the load of a stage: by torque and speed where they are given, else by power and output speed."""
    teeth = chosen_teeth(stage)
    ratio = ratio_of(teeth.sun, teeth.planet, teeth.pins)
    efficiency = efficiency_of(stage, teeth.sun, teeth.planet, teeth.pins)
    speed = either(stage.input_speed, stage.output_speed * ratio)
    mesh_speed = either(stage.stated_mesh_speed, speed * (1.0 - 1.0 / ratio))
    asked = np.abs(either(stage.load_torque, torque_of(stage.power, speed) * (ratio * efficiency)))
    torque = either(stage.stated_sun_torque, asked / (ratio * efficiency))
    cosine = np.cos(stage.helix_angle)
    half = 0.5 * stage.module / cosine
    radii = half * teeth.sun, half * teeth.planet
    force, width = torque / (stage.planets * radii[0]), stage.carrying_share * stage.face_width
    inward = np.cos(transverse_angle(stage.pressure_angle, stage.helix_angle))
    duty = Duty(
        pins=teeth.pins,
        ratio=ratio,
        pin_ratio=teeth.pins / (teeth.pins - 1.0),
        mesh_efficiency=mesh_efficiency(stage, teeth.planet / teeth.sun, teeth.pins),
        sun_speed=speed,
        mesh_speed=mesh_speed,
        asked_torque=asked,
        sun_torque=torque,
        output_torque=torque * ratio * efficiency,
        tangential_force=force,
        pitch_line_velocity=np.pi * (teeth.sun * stage.module / cosine) * mesh_speed,
        carrying_width=width,
        line_load=np.maximum(force * stage.application_factor / width, LEAST_LINE_LOAD),
    )
    return ToothLoad(
        duty=duty,
        sun=teeth.sun,
        planet=teeth.planet,
        efficiency=efficiency,
        direction=np.where(stage.load_torque < 0.0, -1.0, 1.0),
        base_radii=(radii[0] * inward, radii[1] * inward),
    )


# Sizes of sun and planet and of their mesh, spur or helical, and what a pair needs to mesh at all
#
# Reference: ISO 21771. Lengths are in metres, angles in radians; everything is a number or an array (n,).

ISO_21771 = "ISO 21771"
Which = Literal["sun", "planet"]


@results
class GearSize:
    """Sizes of one gear."""

    teeth: Float = found("", symbol="z", note="teeth", method="those stated, else those of the group")
    reference_diameter: Float = found("mm", symbol="d", note="reference diameter", source=ISO_21771,
                                      formula="teeth * module / cos(helix_angle)")  # fmt: skip
    base_diameter: Float = found("mm", symbol="d_b", note="base diameter", source=ISO_21771,
                                 formula="reference_diameter * cos(transverse_angle)")  # fmt: skip
    tip_diameter: Float = found("mm", symbol="d_a", note="tip diameter, without shortening", source=ISO_21771,
                                formula="reference_diameter + 2 * module * (addendum + shift)")  # fmt: skip
    root_diameter: Float = found("mm", symbol="d_f", note="root diameter", source=ISO_21771,
                                 formula="reference_diameter - 2 * module * (dedendum - shift)")  # fmt: skip
    form_diameter: Float = found(
        "mm", symbol="d_Ff", note="where the involute that the rack makes begins; the base diameter where it undercuts",
        source=ISO_21771,
        formula="hypot(base_diameter, max(reference_diameter * sin(transverse_angle)"
        " - 2 * module * (dedendum - shift - fillet * (1 - sin(pressure_angle))) / sin(transverse_angle), 0))",
    )  # fmt: skip
    tip_angle: Float = found("deg", symbol="alpha_at", note="transverse pressure angle at the tip", source=ISO_21771,
                             formula="acos(base_diameter / tip_diameter)")  # fmt: skip
    tip_thickness: Float = found(
        "mm", symbol="s_at", note="transverse tooth thickness at the tip; at 0 the tooth is pointed", source=ISO_21771,
        formula="tip_diameter * ((pi / 2 + 2 * shift * tan(pressure_angle)) / teeth + inv(transverse_angle)"
        " - inv(tip_angle))",
    )  # fmt: skip
    start_curvature: Float = found(
        "mm", symbol="rho_A", note="radius of curvature where contact begins at the root; below 0 the teeth interfere",
        formula="base_diameter * tan(tip_angle) / 2 - contact_ratio * base_pitch",
        source=ISO_21771,
    )  # fmt: skip
    virtual_teeth: Float = found("", symbol="z_n", note="teeth of the virtual spur gear",
                                 source="ISO 6336-3:2006, clause 6",
                                 formula="teeth / (cos(base_helix_angle)**2 * cos(helix_angle))")  # fmt: skip


@results
class MeshSize:
    """Sizes of the mesh."""

    tooth_ratio: Float = found("", symbol="u", note="planet teeth over sun teeth", formula="teeth_planet / teeth_sun")
    transverse_angle: Float = found("deg", symbol="alpha_t", note="transverse pressure angle", source=ISO_21771,
                                    formula="atan(tan(pressure_angle) / cos(helix_angle))")  # fmt: skip
    base_helix_angle: Float = found("deg", symbol="beta_b", note="helix angle at the base cylinder", source=ISO_21771,
                                    formula="asin(sin(helix_angle) * cos(pressure_angle))")  # fmt: skip
    tight_angle: Float = found(
        "deg", symbol="alpha_wt,0", note="transverse working pressure angle without backlash", source=ISO_21771,
        formula="inv(tight_angle) == inv(transverse_angle) + 2 * tan(pressure_angle) * (shift_sun + shift_planet)"
        " / (teeth_sun + teeth_planet)",
    )  # fmt: skip
    tight_centre_distance: Float = found(
        "mm", symbol="a_w,0", note="centre distance without backlash", source=ISO_21771,
        formula="(base_diameter_sun + base_diameter_planet) / (2 * cos(tight_angle))",
    )  # fmt: skip
    centre_distance: Float = found("mm", symbol="a_w", note="working centre distance",
                                   formula="tight_centre_distance + centre_distance_deviation")  # fmt: skip
    working_angle: Float = found(
        "deg", symbol="alpha_wt", note="transverse working pressure angle", source=ISO_21771,
        formula="acos((base_diameter_sun + base_diameter_planet) / (2 * centre_distance))",
    )  # fmt: skip
    base_pitch: Float = found("mm", symbol="p_bt", note="transverse base pitch", source=ISO_21771,
                              formula="pi * module * cos(transverse_angle) / cos(helix_angle)")  # fmt: skip
    contact_ratio: Float = found(
        "", symbol="epsilon_alpha", note="transverse contact ratio", source=ISO_21771,
        formula="(base_diameter_sun * (tan(tip_angle_sun) - tan(working_angle))"
        " + base_diameter_planet * (tan(tip_angle_planet) - tan(working_angle))) / (2 * base_pitch)",
    )  # fmt: skip
    overlap_ratio: Float = found("", symbol="epsilon_beta", note="overlap ratio; 0 of spur gears", source=ISO_21771,
                                 formula="face_width * sin(helix_angle) / (pi * module)")  # fmt: skip
    total_contact_ratio: Float = found("", symbol="epsilon_gamma", note="total contact ratio", source=ISO_21771,
                                       formula="contact_ratio + overlap_ratio")  # fmt: skip
    virtual_contact_ratio: Float = found("", symbol="epsilon_alpha n", note="contact ratio of the virtual spur gears",
                                         source="ISO 6336-3:2006, clause 6",
                                         formula="contact_ratio / cos(base_helix_angle)**2")  # fmt: skip
    tooth_height: Float = found("mm", symbol="h", note="tooth height", source=ISO_21771,
                                formula="(addendum + dedendum) * module")  # fmt: skip
    curvature: Float = found("mm", symbol="rho_red", note="radius of relative curvature at the pitch point",
                             source="ISO 6336-2:2006, clause 12",
                             formula="base_diameter_sun * base_diameter_planet * tan(working_angle)"
                                     " / (2 * (base_diameter_sun + base_diameter_planet))")  # fmt: skip


def mesh_size(stage: Gearing, load: ToothLoad) -> MeshSize:
    """Return the sizes of the mesh; refuses a pair that cannot mesh."""
    transverse = pairs.transverse_angle(stage.pressure_angle, stage.helix_angle)
    base_helix = pairs.base_helix_angle(stage.pressure_angle, stage.helix_angle)
    shift = (stage.sun.shift + stage.planet.shift) / (load.sun + load.planet)
    tight = pairs.working_angle(shift, stage.pressure_angle, transverse)
    feasible(np.isfinite(tight), "no pair of gears has such shifts: shift_sun + shift_planet is too low for the teeth")
    base = load.base_radii
    tight_distance = (base[0] + base[1]) / np.cos(tight)
    distance = tight_distance + stage.centre_distance_deviation
    working = pairs.working_angle_at(distance, base[0] + base[1])
    feasible(np.isfinite(working), "the base circles are farther apart than the centres: centre_distance_deviation is "
             "too low")  # fmt: skip
    pitch = np.pi * stage.module * np.cos(transverse) / np.cos(stage.helix_angle)
    tips = tip_radii(stage, load)
    for name, tip, inner in zip(("sun", "planet"), tips, base, strict=True):
        feasible(tip > inner, f"the tip of the {name} lies below its base circle: raise addendum or shift_{name}")
    contact = pairs.external_contact_ratio(tips, base, working, pitch)
    overlap = stage.face_width * np.sin(stage.helix_angle) / (np.pi * stage.module)
    _meshes(stage, tips, contact, distance)
    return MeshSize(
        tooth_ratio=load.planet / load.sun,
        transverse_angle=transverse,
        base_helix_angle=base_helix,
        tight_angle=tight,
        tight_centre_distance=tight_distance,
        centre_distance=distance,
        working_angle=working,
        base_pitch=pitch,
        contact_ratio=contact,
        overlap_ratio=overlap,
        total_contact_ratio=contact + overlap,
        virtual_contact_ratio=contact / np.cos(base_helix) ** 2,
        tooth_height=(stage.addendum + stage.dedendum) * stage.module,
        curvature=base[0] * base[1] * np.tan(working) / (base[0] + base[1]),
    )


def tip_radii(stage: Gearing, load: ToothLoad) -> tuple[Float, Float]:
    """Return the tip radii of sun and planet, m, without shortening."""
    half = 0.5 * stage.module / np.cos(stage.helix_angle)
    return (
        half * load.sun + stage.module * (stage.addendum + stage.sun.shift),
        half * load.planet + stage.module * (stage.addendum + stage.planet.shift),
    )


def _meshes(stage: Gearing, tips: tuple[Float, Float], contact: Float, distance: Float) -> None:
    """Refuse a pair that loses contact between two teeth, or whose tips touch the roots of the other gear."""
    feasible(contact >= 1.0, "the contact ratio is below 1: raise the teeth or addendum, or lower the shifts or "
             "centre_distance_deviation")  # fmt: skip
    height = (stage.addendum + stage.dedendum) * stage.module
    feasible(
        distance - tips[0] - tips[1] + height > 0.0,
        "the tips touch the roots of the other gear: raise dedendum, or lower addendum, shift_sun or shift_planet",
    )


def gear_size(stage: Gearing, load: ToothLoad, mesh: MeshSize, which: Which) -> GearSize:
    """Return the sizes of one gear."""
    at_sun = which == "sun"
    gear, base = (stage.sun, load.base_radii[0]) if at_sun else (stage.planet, load.base_radii[1])
    teeth = load.sun if at_sun else load.planet
    reference = teeth * stage.module / np.cos(stage.helix_angle)
    tip = reference + 2.0 * stage.module * (stage.addendum + gear.shift)
    tip_angle = np.arccos(2.0 * base / tip)
    half = (0.5 * np.pi + 2.0 * gear.shift * np.tan(stage.pressure_angle)) / teeth
    thickness = tip * (half + involute(mesh.transverse_angle) - involute(tip_angle))
    root = reference - 2.0 * stage.module * (stage.dedendum - gear.shift)
    feasible(root > 0.0, f"nothing is left below the teeth of the {which}: raise its teeth or shift_{which}")
    feasible(thickness > 0.0, f"the teeth of the {which} are pointed: lower shift_{which} or addendum")
    return GearSize(
        teeth=teeth,
        reference_diameter=reference,
        base_diameter=2.0 * base,
        tip_diameter=tip,
        root_diameter=root,
        form_diameter=form_diameter(stage, gear, reference, mesh.transverse_angle),
        tip_angle=tip_angle,
        tip_thickness=thickness,
        start_curvature=base * np.tan(tip_angle) - mesh.contact_ratio * mesh.base_pitch,
        virtual_teeth=teeth / (np.cos(mesh.base_helix_angle) ** 2 * np.cos(stage.helix_angle)),
    )


def form_diameter(stage: Gearing, gear: Gear, reference: Float, transverse: Float) -> Float:
    """Return the diameter at which the involute begins, m, for a reference diameter, m, and the transverse angle."""
    straight = stage.dedendum - gear.shift - stage.fillet * (1.0 - np.sin(stage.pressure_angle))
    reach = reference * np.sin(transverse) - 2.0 * stage.module * straight / np.sin(transverse)
    return np.hypot(reference * np.cos(transverse), np.maximum(reach, 0.0))


# The outline of a tooth as its rack generates it: root circle, trochoid of the rounded tip, involute, tip circle
#
# Lengths are in modules, the centre of the gear is the origin and the axis of the tooth points along +y. For drawings.


FINE = 60


def half_space(rack: Rack, teeth: float, shift: float, radii: "Array") -> "Array":
    """Return half the angle of the tooth space, rad, at these radii between root and tip: what the rack leaves open."""
    reference, alpha = 0.5 * teeth, rack.pressure_angle
    at_reference = (0.25 * np.pi - shift * np.tan(alpha)) / reference
    base = float(reference * np.cos(alpha))
    cut_radius, cut_angle = trochoid(rack, teeth, shift)
    flank = at_reference - involute(alpha) + involute(np.arccos(np.minimum(base / radii, 1.0)))
    fillet = np.interp(radii, cut_radius, cut_angle)
    if undercut(rack, teeth, shift):
        return np.where(radii < base, fillet, np.maximum(flank, np.where(radii > cut_radius[-1], -np.inf, fillet)))
    return np.where(radii < cut_radius[-1], fillet, flank)


def undercut(rack: Rack, teeth: float, shift: float) -> bool:
    """Tell whether the tip of the rack cuts into the involute: its straight flank ends below the line of action."""
    alpha = rack.pressure_angle
    depth = rack.dedendum - shift - rack.fillet * (1.0 - np.sin(alpha))
    return bool(depth > 0.5 * teeth * np.sin(alpha) ** 2)


def trochoid(rack: Rack, teeth: float, shift: float, points: int = FINE) -> "tuple[Array, Array]":
    """Return radius and half angle of the space along the fillet, from the root circle outward."""
    alpha, rho, reference = rack.pressure_angle, rack.fillet, 0.5 * teeth
    across = 0.25 * np.pi - rack.dedendum * np.tan(alpha) - (1.0 - np.sin(alpha)) * rho / np.cos(alpha)
    inward = rho - rack.dedendum + shift  # centre of the rounded tip from the rolling line, outward above 0
    roll = np.linspace(across / reference, (across + inward / np.tan(alpha)) / reference, points)
    to_tip = np.array([across - reference * roll, np.full_like(roll, inward)])
    length = np.hypot(*to_tip)
    unit = np.where(length > 0.0, to_tip / np.maximum(length, 1e-300), np.array([[0.0], [-1.0]]))
    along, outward = to_tip + rho * unit
    radius = np.hypot(reference + outward, along)
    angle = roll + np.arctan2(along, reference + outward)
    outermost = int(np.argmax(radius)) + 1  # an undercut fillet comes back inward: only its way out is a flank
    return np.maximum.accumulate(radius[:outermost]), angle[:outermost]


def tooth(rack: Rack, teeth: float, shift: float, tip_radius: float, points: int = 2 * FINE) -> "Array":
    """Return the outline of one tooth (2, k) from the middle of one space over the tip to that of the next.

    ``points`` stand on each flank with its fillet; further ones, a tenth of them, on half the root and half the tip.
    """
    root = 0.5 * teeth - rack.dedendum + shift
    spread = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, points))
    radii = root + (tip_radius - root) * spread
    half_tooth = np.maximum(np.pi / teeth - half_space(rack, teeth, shift, radii), 0.0)
    few = max(points // 10, 2)
    floor = np.linspace(np.pi / teeth, half_tooth[0], few, endpoint=False)
    top = np.linspace(half_tooth[-1], 0.0, few)[1:]
    angle = np.concatenate([floor, half_tooth, top])
    radius = np.concatenate([np.full(few, root), radii, np.full(few - 1, tip_radius)])
    right = np.array([radius * np.sin(angle), radius * np.cos(angle)])
    left = right[:, ::-1] * np.array([[-1.0], [1.0]])
    return np.concatenate([right, left[:, 1:]], axis=1)[:, ::-1]


def turned(points: "Array", angle: float) -> "Array":
    """Return points turned about the origin, against the clock for a positive angle."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]]) @ points


def gear(one: "Array", teeth: float, around: int | None = None) -> "Array":
    """Return the outline of a gear (2, points) from that of one of its teeth; a tooth points along +y.

    Closed, or with ``around`` so many teeth to either side of that tooth, and the centre of the gear.
    """
    pitch = 2.0 * np.pi / teeth
    if around is None or 2 * around + 1 >= round(teeth):
        return np.concatenate([turned(one, -place * pitch) for place in range(round(teeth))], axis=1)
    some = [turned(one, -place * pitch) for place in range(-around, around + 1)]
    return np.concatenate([*some, np.zeros((2, 1))], axis=1)
