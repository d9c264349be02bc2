"""Every effect that can be hidden in the machines of each plugin, at a clear size, with the results it shows in."""

from hidden_effects import gearing_cases, screw_cases
from hidden_effects.harmonic_machine import MESH, TORSION

STAGE_STRESSES = (gearing_cases.SUN_ROOT, gearing_cases.CONTACT)
STAGES: list[tuple[str, dict[str, float], tuple[str, ...], gearing_cases.Design]] = [
    ("face_misalignment", {"misalignment": 2.0}, STAGE_STRESSES, "rig"),
    ("face_misalignment", {"misalignment": 9.0}, STAGE_STRESSES, "rig"),
    ("face_misalignment", {"per_load": 8.0}, STAGE_STRESSES, "one_way"),
    ("structural_resonance", {"strength": 0.06, "resonance_speed": 900, "damping": 0.1}, STAGE_STRESSES, "rig"),
    ("structural_resonance", {"strength": 0.06, "resonance_speed": 1500, "damping": 0.1}, STAGE_STRESSES, "rig"),
    ("planet_load_sharing", {"lead": 0.2}, STAGE_STRESSES, "rig"),
    ("crowned_contact", {"full_line_load": 25.0}, STAGE_STRESSES, "rig"),
    ("relief_error", {"missing": 0.4}, STAGE_STRESSES, "rig"),
    ("centre_distance_growth", {"expansion": 12.0}, (gearing_cases.PLAY,), "rig"),
    ("sun_runout", {"cosine": 1.5, "sine": -1.2}, (gearing_cases.ERROR,), "rig"),
    ("planet_runout", {"cosine": -1.2, "sine": 1.5}, (gearing_cases.ERROR,), "rig"),
    ("mesh_ripple", {"cosine": 1.0, "sine": 1.0}, (gearing_cases.ERROR,), "sweep"),
    ("mesh_ripple", {"second_cosine": 1.2, "second_sine": -0.8}, (gearing_cases.ERROR,), "rig"),
    ("output_eccentricity", {"cosine": 2.5, "sine": 1.5}, (gearing_cases.ERROR,), "rig"),
    ("output_eccentricity", {"tooth_cosine": 1.2, "tooth_sine": -0.8}, (gearing_cases.ERROR,), "rig"),
    ("speed_dependent_loss", {"constant": 0.4, "viscous": 0.4}, (gearing_cases.LOSS,), "one_way"),
    ("flash_temperature", {"friction": 0.06}, (gearing_cases.WARMTH,), "rig"),
    ("wind_up", {"compliance": 0.6}, (gearing_cases.ERROR,), "rig"),
    ("lost_motion", {"play": 15.0, "torque_scale": 60}, (gearing_cases.ERROR, gearing_cases.PLAY), "sweep"),
    ("wear_drift", {"rate": 2.0}, (gearing_cases.ERROR, gearing_cases.PLAY), "rig"),
    ("ratio_drift", {"miscount": 1e-6}, (gearing_cases.ERROR,), "rig"),
    ("mesh_stiffening", {"share": 1.4}, (gearing_cases.ERROR,), "rig"),
]
REDUCERS: dict[str, dict[str, float]] = {
    "thermal_clearance": {"expansion": 11.5}, "running_in": {"depth": 0.9, "run_in_time": 300},
    "wear_temperature": {"softening": 0.006}, "film_lubrication": {"film_factor": 140}, "pin_rolling": {"rolling": 0.5},
    "pin_wear": {"ratio": 0.7}, "lost_motion_share": {"loss": 0.6}, "bearing_wear": {"wear": 0.6},
    "wind_up": {"compliance": 1.0}, "stiffening": {"twist": 0.2, "torque_scale": 120},
    "runout": {"offset": 1.2, "direction": 310}, "pin_pass_ripple": {"pin_cosine": 0.03, "pin_sine": -0.02},
    "friction_hysteresis": {"lag": 0.02}, "lubricant_ageing": {"rate": 0.3}, "load_exponent": {"exponent": 0.5},
    "duty_share": {"idle": 0.45},
}  # fmt: skip
SCREWS: list[tuple[str, dict[str, float], tuple[str, ...]]] = [  # effect, unknowns, results in which it shows
    ("face_misalignment", {"misalignment": 2.0}, screw_cases.STRESSES),
    ("face_misalignment", {"per_load": 0.1}, screw_cases.STRESSES),
    ("mesh_resonance", {"excitation": 0.08, "resonance_speed": 1800, "damping": 0.06}, screw_cases.STRESSES),
    ("roller_load_sharing", {"lead": 2.0}, screw_cases.STRESSES),
    ("roller_load_sharing", {"lead": -0.4}, screw_cases.STRESSES),
    ("interrupted_tooth", {"lost": 0.4, "phase": 320}, screw_cases.STRESSES),
    ("rim_compliance", {"softness": 0.4}, (screw_cases.RING,)),
    ("thermal_centre_distance", {"expansion": 11.5}, (screw_cases.BACKLASH,)),
    ("roller_runout", {"cosine": 3.0, "sine": -2.0}, (screw_cases.ERROR,)),
    ("carrier_runout", {"cosine": -1.0, "sine": 2.0}, (screw_cases.ERROR,)),
    ("axial_migration", {"mismatch": 0.05}, (screw_cases.AXIAL,)),
    ("flank_wear", {"rate": 2.0}, (screw_cases.WEAR, screw_cases.BACKLASH)),
    ("mesh_friction", {"factor": 1.3}, (screw_cases.TORQUE,)),
]
DRIVES: list[tuple[str, dict[str, float], str]] = [  # effect, unknowns, result in which it shows
    ("series_compliance", {"compliance": 12}, TORSION),
    ("engaged_pairs", {"gain": 1.8, "torque_scale": 0.8}, MESH),
    ("oil_film", {"stiffness": 0.03}, MESH),
    ("asperity_smoothing", {"dimension": 0.03, "roughness": 0.6, "cycle_scale": 2e5}, MESH),
    ("modulus_temperature", {"softening": 8e-4}, TORSION),
    ("creep", {"share": 0.03, "time_scale": 0.1}, TORSION),
    ("ellipticity", {"cosine": 20, "sine": -25}, TORSION),
    ("ellipticity", {"stiffness_cosine": 0.08, "stiffness_sine": 0.06}, MESH),
    ("eccentricity", {"cosine": -16, "sine": 20}, TORSION),
    ("hysteresis", {"loop": 200, "torque_scale": 0.16}, TORSION),
    ("viscous_hysteresis", {"loop": 100, "torque_scale": 0.2, "thinning": 0.03}, TORSION),
    ("lost_motion", {"play": 60, "torque_scale": 0.12}, TORSION),
    ("first_load_set", {"set": 40, "exponent": 1.2}, TORSION),
    ("first_load_set", {"stiffening": 0.3}, MESH),
    ("flank_wear", {"rate": 1.0, "torque_scale": 0.08}, TORSION),
    ("thermal_preload", {"expansion": 3}, TORSION),
    ("rig_drift", {"rate": 6}, TORSION),
    ("waviness", {"square": 0.01, "wavelength": 25}, ""),
    ("instrument_noise", {"variance": 100}, ""),
    ("lateral_filter", {"width": 0.8}, ""),
]
SHAPES = {
    "resonance_speed", "damping", "phase", "torque_scale", "run_in_time", "direction", "thinning", "exponent",
    "time_scale", "cycle_scale", "wavelength",
}  # fmt: skip
"""Unknowns that are no size: they stay as they are. The exponent of a load is one, that of a set is not."""
