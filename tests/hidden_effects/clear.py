"""Every effect that can be hidden in the machines of each plugin, at a clear size, in results in which it shows."""

from hidden_effects import gearing_machine, harmonic_machine, rv_machine, screw_machine
from hidden_effects.gearing_machine import CONTACT, ERROR, LOSS, PLAY, SUN_ROOT, WARMTH
from hidden_effects.harmonic_machine import MESH, RIGID, WHOLE, Body
from hidden_effects.harmonic_surface import surface
from hidden_effects.rigs import Wish

STAGE_STRESSES = (SUN_ROOT, CONTACT)


def stage(results: tuple[str, ...], design: str = "rig", **hidden: dict[str, float]) -> Wish:
    return gearing_machine.stage(hidden=hidden, results=results, design=design)


def screw(results: tuple[str, ...], design: str = "bench", **hidden: dict[str, float]) -> Wish:
    return screw_machine.screw(hidden=hidden, results=results, design=design)


def drive(body: Body = RIGID, **hidden: dict[str, float]) -> Wish:
    """A drive of which the torsion is measured."""
    return harmonic_machine.drive(body, hidden=hidden)


def mesh(body: Body = RIGID, **hidden: dict[str, float]) -> Wish:
    """A drive of which the stiffness of the mesh is measured."""
    return harmonic_machine.drive(body, hidden=hidden, results=(MESH,), design="points")


STAGES = [
    stage(STAGE_STRESSES, face_misalignment={"misalignment": 2.0}),
    stage(STAGE_STRESSES, face_misalignment={"misalignment": 9.0}),
    stage(STAGE_STRESSES, "one_way", face_misalignment={"per_load": 8.0}),
    stage(STAGE_STRESSES, structural_resonance={"strength": 0.06, "resonance_speed": 900, "damping": 0.1}),
    stage(STAGE_STRESSES, structural_resonance={"strength": 0.06, "resonance_speed": 1500, "damping": 0.1}),
    stage(STAGE_STRESSES, planet_load_sharing={"lead": 0.2}),
    stage(STAGE_STRESSES, crowned_contact={"full_line_load": 25.0}),
    stage(STAGE_STRESSES, relief_error={"missing": 0.4}),
    stage((PLAY,), centre_distance_growth={"expansion": 12.0}),
    stage((ERROR,), sun_runout={"cosine": 1.5, "sine": -1.2}),
    stage((ERROR,), planet_runout={"cosine": -1.2, "sine": 1.5}),
    stage((ERROR,), "sweep", mesh_ripple={"cosine": 1.0, "sine": 1.0}),
    stage((ERROR,), mesh_ripple={"second_cosine": 1.2, "second_sine": -0.8}),
    stage((ERROR,), output_eccentricity={"cosine": 2.5, "sine": 1.5}),
    stage((ERROR,), output_eccentricity={"tooth_cosine": 1.2, "tooth_sine": -0.8}),
    stage((LOSS,), "one_way", pin_drag={"friction": 0.02, "film_speed": 6.0}),
    stage((LOSS,), "one_way", speed_dependent_loss={"constant": 0.4, "viscous": 0.4}),
    stage((WARMTH,), flash_temperature={"friction": 0.06}),
    stage((ERROR,), wind_up={"compliance": 0.6}),
    stage((ERROR, PLAY), "sweep", lost_motion={"play": 15.0, "torque_scale": 60}),
    stage((ERROR, PLAY), wear_drift={"rate": 2.0}),
    stage((ERROR,), ratio_drift={"miscount": 1e-6}),
    stage((ERROR,), mesh_stiffening={"share": 1.4}),
]
REDUCERS: dict[str, dict[str, float]] = {
    "thermal_clearance": {"expansion": 11.5}, "running_in": {"depth": 0.9, "run_in_time": 300},
    "wear_temperature": {"softening": 0.006}, "film_lubrication": {"film_factor": 140}, "pin_rolling": {"rolling": 0.5},
    "pin_wear": {"ratio": 0.7}, "lost_motion_share": {"loss": 0.6}, "bearing_wear": {"wear": 0.6},
    "wind_up": {"compliance": 1.0}, "stiffening": {"twist": 0.2, "torque_scale": 120},
    "runout": {"offset": 1.2, "direction": 310}, "toothing_runout": {"offset": 1.5, "direction": 230},
    "disc_phase": {"phase": 6}, "pin_pass_ripple": {"pin_cosine": 0.03, "pin_sine": -0.02},
    "friction_hysteresis": {"lag": 0.02}, "lubricant_ageing": {"rate": 0.3}, "load_exponent": {"exponent": 0.5},
    "duty_share": {"idle": 0.45},
}  # fmt: skip
REDUCED = [rv_machine.reducer(hidden={name: unknowns}, design="fleet") for name, unknowns in REDUCERS.items()]
SCREWS = [
    screw(screw_machine.STRESSES, face_misalignment={"misalignment": 2.0}),
    screw(screw_machine.STRESSES, face_misalignment={"per_load": 0.1}),
    screw(screw_machine.STRESSES, mesh_resonance={"excitation": 0.08, "resonance_speed": 1800, "damping": 0.06}),
    screw(screw_machine.STRESSES, roller_load_sharing={"lead": 2.0}),
    screw(screw_machine.STRESSES, roller_load_sharing={"lead": -0.4}),
    screw(screw_machine.STRESSES, interrupted_tooth={"lost": 0.4, "phase": 320}),
    screw((screw_machine.RING,), rim_compliance={"softness": 0.4}),
    screw((screw_machine.DEFLECTION,), soft_threads={"compliance": 20.0}),
    screw((screw_machine.DEFLECTION,), roller_pitch_error={"deviation": 0.3}),
    screw((screw_machine.BACKLASH,), thermal_centre_distance={"expansion": 11.5}),
    screw((screw_machine.ERROR,), roller_runout={"cosine": 3.0, "sine": -2.0}),
    screw((screw_machine.ERROR,), carrier_runout={"cosine": -1.0, "sine": 2.0}),
    screw((screw_machine.AXIAL,), axial_migration={"mismatch": 0.05}),
    screw((screw_machine.WEAR, screw_machine.BACKLASH), "endurance", flank_wear={"rate": 2.0}),
    screw((screw_machine.TORQUE,), mesh_friction={"factor": 1.3}),
]
DRIVES = [
    drive(series_compliance={"compliance": 12}),
    drive(WHOLE, thin_cup={"lost": 0.3}),
    drive(soft_wave_generator={"torsion": 200}),
    mesh(Body(tooth=2e7), engaged_pairs={"gain": 1.8, "torque_scale": 0.8}),
    mesh(oil_film={"stiffness": 0.03}),
    mesh(asperity_smoothing={"dimension": 0.03, "roughness": 0.6, "cycle_scale": 2e5}),
    drive(modulus_temperature={"softening": 8e-4}),
    drive(creep={"share": 0.03, "time_scale": 0.1}),
    drive(ellipticity={"cosine": 20, "sine": -25}),
    mesh(ellipticity={"stiffness_cosine": 0.08, "stiffness_sine": 0.06}),
    drive(eccentricity={"cosine": -16, "sine": 20}),
    drive(hysteresis={"loop": 200, "torque_scale": 0.16}),
    drive(viscous_hysteresis={"loop": 100, "torque_scale": 0.2, "thinning": 0.03}),
    drive(lost_motion={"play": 60, "torque_scale": 0.12}),
    drive(first_load_set={"set": 40, "exponent": 1.2}),
    mesh(first_load_set={"stiffening": 0.3}),
    drive(flank_wear={"rate": 1.0, "torque_scale": 0.08}),
    drive(thermal_preload={"expansion": 3}),
    drive(rig_drift={"rate": 6}),
    surface(hidden={"waviness": {"square": 0.01, "wavelength": 25}}),
    surface(hidden={"instrument_noise": {"variance": 100}}),
    surface(hidden={"lateral_filter": {"width": 0.8}}),
]
CLEAR = {
    "rv_gearing": STAGES, "rv_wear": REDUCED, "roller_screw_shift": SCREWS, "harmonic_fractal": DRIVES,
}  # fmt: skip
SHAPES = {
    "resonance_speed", "damping", "phase", "torque_scale", "run_in_time", "direction", "thinning", "exponent",
    "time_scale", "film_speed", "cycle_scale", "wavelength",
}  # fmt: skip
"""Unknowns that are no size: they stay as they are. The exponent of a load is one, that of a set is not."""
