"""What the paper leaves out of the pair, and what is measured of it that is 0 in the calculation.

They act in the order declared: first what changes the load of a tooth or the place of the parts, then what is added to
a result. A new effect is a function beside the others and one more entry in EFFECTS.
"""

from roller_screw_shift.answers import Meshing
from roller_screw_shift.conditions import CYCLES, SCREW_ANGLE, SCREW_SPEED, TEMPERATURE
from roller_screw_shift.effects_of_flanks import flank_wear, mesh_friction, thermal_centre_distance
from roller_screw_shift.effects_of_load import (
    face_misalignment,
    interrupted_tooth,
    mesh_resonance,
    rim_compliance,
    roller_load_sharing,
)
from roller_screw_shift.effects_of_motion import axial_migration, carrier_runout, roller_runout
from roller_screw_shift.quantities import Pair
from truing import Effect, Unknown

ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"
HARMONIC = "first harmonic of an eccentricity; kinematics of the screw with its nut at rest"
FRICTION = (
    "ISO/TR 14179-2: mean coefficient of friction; Ohlendorf, H., Verlustleistung und Erwärmung von Stirnrädern, "
    "Munich 1958: loss factor"
)


def wave(of: str) -> list[Unknown]:
    """Declare both parts of one harmonic."""
    return [
        Unknown("cosine", -200, 200, "um", note=f"in proportion to the cosine of the angle of the {of}"),
        Unknown("sine", -200, 200, "um", note=f"in proportion to the sine of the angle of the {of}"),
    ]


LOAD: list[Effect[Pair, Meshing]] = [
    Effect(
        "face_misalignment",
        on_inputs=face_misalignment,
        unknowns=[
            Unknown("misalignment", 0, 20, "um", note="gap at one end of the face without load; 0.2 to 2 mrad of tilt"),
            Unknown("per_load", 0, 2, "um/kN", note="what the gap gains with the axial load"),
        ],
        parts=[("misalignment",), ("per_load",)],
        looks_like="both root stresses too high by one amount at any load, like an offset or a roller ahead of the "
        "others, and by less than that at small loads, where a part of the face lifts off; a tilt by the load is like "
        "a gain of both",
        why="the roller is tilted in its carrier, and bends and tilts further under its load",
        source="ISO 6336-1, method C: face load factor of a misaligned pair",
    ),
    Effect(
        "mesh_resonance",
        on_inputs=mesh_resonance,
        needs=[SCREW_SPEED],
        unknowns=[
            Unknown("excitation", 0, 0.5, "", note="error of the teeth times stiffness over the load; 0.02 to 0.1"),
            Unknown("resonance_speed", 200, 6000, "rpm", note="of the screw"),
            Unknown("damping", 0.03, 0.3, "", note="damping ratio; 0.04 to 0.1"),
        ],
        looks_like="both root stresses have a peak at one speed of the screw, by the same share at any load",
        why="the teeth shake the rollers on the stiffness of their mesh, once per tooth",
        source="one degree of freedom shaken by its base: displacement of the mesh",
    ),
    Effect(
        "roller_load_sharing",
        on_inputs=roller_load_sharing,
        unknowns=[
            Unknown("lead", -20, 20, "um", note="of the flank of this roller before the mean of the others; 1 to 5"),
        ],
        looks_like="both root stresses off by one amount at any load, like an offset; a roller that stays behind "
        "carries nothing at small loads",
        why="the teeth of the rollers do not stand alike to their threads, so that some carry more than others",
        source="rollers on a rigid carrier: equilibrium of loads by the stiffness of their meshes",
    ),
    Effect(
        "interrupted_tooth",
        on_inputs=interrupted_tooth,
        needs=[SCREW_ANGLE],
        acts_at_reference=True,
        unknowns=[
            Unknown("lost", 0, 0.9, "", note="share of the face that does not carry where it is least; 0.2 to 0.5"),
            Unknown("phase", 180, 540, "deg", note="angle of the roller at which that is, and one turn away"),
        ],
        looks_like="both root stresses swing once per turn of the roller, in proportion to the load, with crests "
        "narrower than their troughs",
        why="the thread of a roller runs through the teeth at its ends",
        source="geometry: share of the face that a groove takes from it",
    ),
    Effect(
        "rim_compliance",
        on_inputs=rim_compliance,
        unknowns=[Unknown("softness", 0, 1.5, "", note="rim factor less 1; 0.17 with a rim of 3 modules, 0.64 of 2")],
        looks_like="the root stress of the ring is too high by one share, and nothing else: as with a gain of its "
        "gauge, which another gauge or a weight on the tooth tells apart",
        why="the ring is thin behind its teeth and bends as a whole",
        source="ISO 6336-3: rim factor Y_B = 1.15 ln(8.324 m/s_R) of an internal gear, 1.75 < s_R/m < 3.5",
    ),
]
HEAT: list[Effect[Pair, Meshing]] = [
    Effect(
        "thermal_centre_distance",
        on_inputs=thermal_centre_distance,
        needs=[TEMPERATURE],
        unknowns=[
            Unknown(
                "expansion", -40, 40, "um/(m*K)", note="linear, of screw and nut less that of the ring; steel 11.5"
            ),
        ],
        looks_like="the backlash shrinks as the screw gets warm and comes back when it cools: 0.2 um per kelvin with "
        "steel beside a cold ring; a thermal drift of its gauge looks the same",
        why="the threads hold the rollers at their distance, and are warmer than the ring, or of another metal",
        source="linear expansion; backlash of an internal involute pair, ISO 21771",
    ),
]
ROTATION: list[Effect[Pair, Meshing]] = [
    Effect(
        "roller_runout",
        on_results=roller_runout,
        needs=[SCREW_ANGLE],
        acts_at_reference=True,
        unknowns=wave("roller"),
        looks_like="transmission error with one wave per turn of the roller against the carrier, 1.875 per turn of the "
        "screw",
        why="the teeth of a roller are off the axis of its thread",
        source=HARMONIC,
    ),
    Effect(
        "carrier_runout",
        on_results=carrier_runout,
        needs=[SCREW_ANGLE],
        acts_at_reference=True,
        unknowns=wave("carrier"),
        looks_like="transmission error with one wave per turn of the carrier, 0.375 per turn of the screw",
        why="the ring is off the axis of the nut, or the carrier off that of the screw",
        source=HARMONIC,
    ),
    Effect(
        "axial_migration",
        on_results=axial_migration,
        needs=[SCREW_ANGLE],
        unknowns=[
            Unknown("mismatch", -5, 5, "um/mm", note="creep of the roller per turn of the screw over the lead; to 2")
        ],
        looks_like="the roller moves along the screw in proportion to the angle turned, and back when that goes back",
        why="the teeth keep one ratio, the pitch diameters of the threads as made another",
        source="kinematics of the planetary roller screw",
    ),
]
FLANKS: list[Effect[Pair, Meshing]] = [
    Effect(
        "flank_wear",
        on_results=flank_wear,
        needs=[CYCLES],
        unknowns=[
            Unknown("rate", 0, 50, "um", note="depth per million cycles at 51.943 N and a specific sliding of 1"),
        ],
        looks_like="the depth of wear grows with load and cycles, whatever the time, and the backlash about twice as "
        "fast with ten rollers of a fifth of the ring's teeth",
        why="flanks slide on one another away from the pitch point",
        source=ARCHARD,
    ),
    Effect(
        "mesh_friction",
        on_results=mesh_friction,
        needs=[SCREW_SPEED, TEMPERATURE],
        acts_at_reference=True,
        unknowns=[Unknown("factor", 0, 20, "", note="friction over that of the formula")],
        looks_like="torque against the turning that grows a little more than in proportion to the load, falls slowly "
        "with the speed and hardly rises with the temperature",
        why="flanks slide on one another away from the pitch point",
        source=FRICTION,
    ),
]
EFFECTS: list[Effect[Pair, Meshing]] = [*LOAD, *HEAT, *ROTATION, *FLANKS]

__all__ = ["EFFECTS"]
