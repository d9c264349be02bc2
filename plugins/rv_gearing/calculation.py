"""From duty and teeth to stresses and safeties; one call answers for thousands of stages."""

import numpy as np

from gear_geometry.involute import involute
from rv_gearing.answers import Duty, GearStress, Strength
from rv_gearing.bending_factors import bending_factors, root_of
from rv_gearing.contact_factors import contact_factors, contact_ratio_factor
from rv_gearing.duty import mesh_efficiency
from rv_gearing.dynamic import dynamics_of
from rv_gearing.face_load import face_load_of
from rv_gearing.life import cycles_of, life_of
from rv_gearing.loads import LEAST_LINE_LOAD, Load, load_of
from rv_gearing.pair import GearSize, MeshSize, Which, gear_size, mesh_size
from rv_gearing.quality import GearQuality, quality_of
from rv_gearing.quantities import Gearing
from rv_gearing.steel import Steel, steel_of
from rv_gearing.stiffness import stiffness_of
from rv_gearing.stresses import Acting, acting, stresses_of
from rv_gearing.transverse import planets_of, sharing_of
from truing import Float


def rv_gearing(stage: Gearing) -> Strength:
    """Strength of one stage or of a batch; every Float is a number or an array (n,), SI."""
    load = load_of(stage)
    mesh = mesh_size(stage, load)
    sun_size = gear_size(stage, load, mesh, "sun")
    sizes = sun_size, gear_size(stage, load, mesh, "planet")
    duty = duty_of(stage, load, sun_size, mesh)
    made, quality = quality_of(stage, sizes, mesh, duty.pitch_line_velocity)
    stiffness = stiffness_of(stage, load, sizes, mesh.contact_ratio)
    dynamics = dynamics_of(stage, load, sizes, mesh.total_contact_ratio, (quality, stiffness))
    planets = planets_of(stage, load.line_load, stiffness.mesh_stiffness)
    mean = np.maximum(load.line_load * dynamics.dynamic_factor * planets.planet_factor, LEAST_LINE_LOAD)
    seen = (sun_size, mesh, duty.pitch_line_velocity)
    face = face_load_of(stage, made, mean, stiffness.mesh_stiffness_face, seen)
    z_epsilon = contact_ratio_factor(stage, mesh)
    held = stiffness.mesh_stiffness, z_epsilon
    sharing = sharing_of(stage, mesh, mean * face.face_factor, quality.pitch_left, held)
    contact = contact_factors(stage, sizes, mesh, duty.pitch_line_velocity, z_epsilon)
    bending = bending_factors(stage, mesh, stiffness.tooth_stiffness, load.line_load)
    for_contact = face.face_factor * sharing.transverse_factor * planets.planet_factor
    for_bending = face.face_factor_bending * sharing.transverse_factor_bending * planets.planet_factor_bending
    shares = dynamics.dynamic_factor * for_contact, dynamics.dynamic_factor * for_bending
    act = acting(stage, load, (sun_size, mesh), (contact, bending), shares)
    steel, cycles = steel_of(stage), cycles_of(stage, load)
    sun = gear_of(
        stage, mesh, act, steel, (sun_size, made[0], contact.single_contact_factor_sun, cycles.load_cycles_sun)
    )
    planet = gear_of(
        stage, mesh, act, steel, (sizes[1], made[1], contact.single_contact_factor_planet, cycles.load_cycles_planet),
        which="planet",
    )  # fmt: skip
    return Strength(
        contact_stress=sun.contact_stress, transmission_error=0.0 * load.tangential_force, efficiency=load.efficiency,
        flank_temperature=stage.oil_temperature, backlash=backlash_of(stage, load, mesh),
        nominal_contact_stress=act.contact, contact_safety=np.minimum(sun.contact_safety, planet.contact_safety),
        root_safety=np.minimum(sun.root_safety, planet.root_safety),
        root_safety_outer=np.minimum(sun.root_safety_outer, planet.root_safety_outer), duty=duty, mesh=mesh,
        quality=quality, steel=steel, stiffness=stiffness, dynamics=dynamics, planets=planets, face=face,
        sharing=sharing, contact=contact, bending=bending, cycles=cycles, sun=sun, planet=planet,
    )  # fmt: skip


def gear_of(
    stage: Gearing, mesh: MeshSize, act: Acting, steel: Steel, known: tuple[GearSize, GearQuality, Float, Float],
    *, which: Which = "sun",
) -> GearStress:  # fmt: skip
    """Return root, life, stresses and safeties of one gear; known are size, quality, Z_B or Z_D, and load cycles."""
    size, made, single_contact, cycles = known
    gear = stage.sun if which == "sun" else stage.planet
    root, life = root_of(stage, size, mesh, steel, which), life_of(gear, steel, cycles)
    return stresses_of(stage, gear, act, single_contact, (size, made, root, life))


def duty_of(stage: Gearing, load: Load, sun: GearSize, mesh: MeshSize) -> Duty:
    """Return the load as it is printed."""
    return Duty(
        pins=load.pins,
        ratio=load.ratio,
        pin_ratio=load.pins / (load.pins - 1.0),
        mesh_efficiency=mesh_efficiency(stage, mesh.tooth_ratio, load.pins),
        sun_speed=load.input_speed,
        mesh_speed=load.mesh_speed,
        asked_torque=load.asked_torque,
        sun_torque=load.sun_torque,
        output_torque=load.sun_torque * load.ratio * load.efficiency,
        tangential_force=load.tangential_force,
        pitch_line_velocity=np.pi * sun.reference_diameter * load.mesh_speed,
        carrying_width=stage.carrying_share * stage.face_width,
        line_load=load.line_load,
    )


def backlash_of(stage: Gearing, load: Load, mesh: MeshSize) -> Float:
    """Return the backlash along the line of action, m: 0 unless the gears are farther apart than without it."""
    opened = (
        2.0 * (load.base_radii[0] + load.base_radii[1]) * (involute(mesh.working_angle) - involute(mesh.tight_angle))
    )
    return np.where(stage.centre_distance_deviation <= 0.0, 0.0, opened * np.cos(mesh.base_helix_angle))
