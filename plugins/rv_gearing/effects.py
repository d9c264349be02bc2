"""What the rating of the first stage leaves out, and what is measured of the stage that it does not calculate.

They act in the order declared: first what changes the load of a tooth, then what is added to a result. A new effect is
a function beside the others and one more entry in EFFECTS.
"""

from rv_gearing.answers import Strength
from rv_gearing.conditions import INPUT_ANGLE, TIME
from rv_gearing.effects_of_friction import flash_temperature
from rv_gearing.effects_of_load import (
    crowned_contact,
    face_misalignment,
    planet_load_sharing,
    relief_error,
    structural_resonance,
)
from rv_gearing.effects_of_oil import centre_distance_growth, speed_dependent_loss
from rv_gearing.effects_of_rotation import mesh_ripple, output_eccentricity, planet_runout, ratio_drift, sun_runout
from rv_gearing.effects_of_torque import lost_motion, mesh_stiffening, wear_drift, wind_up
from rv_gearing.quantities import Gearing
from truing import Effect, Unknown

FACE = "face load factor of ISO 6336-1, method C, for a misalignment that grows with the load"
RESONANCE = "one degree of freedom shaken by an error of position: Den Hartog, Mechanical vibrations, ch. 2"
HARMONIC = "first harmonic of an eccentricity; kinematics of the RV reducer with its housing fixed"
STIFFNESS = "ISO 6336-1, clause 9: stiffness of a tooth pair, and its fall below a line load of 100 N/mm"
PALMGREN = (
    "Palmgren, A., Ball and roller bearing engineering, 3rd ed., Burbank 1959: torque of an idle bearing; viscosity of "
    "the oil after ASTM D341"
)
BLOK = (
    "Blok, H., Theoretical study of temperature rise at surfaces of actual contact under oiliness lubricating "
    "conditions, Proc. General Discussion on Lubrication 2, Institution of Mechanical Engineers 1937, 222; ISO/TS "
    "6336-20"
)
ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"


def wave(cosine: str, sine: str, of: str) -> list[Unknown]:
    """Declare both parts of one harmonic."""
    return [
        Unknown(cosine, -1000, 1000, "um", note=f"in proportion to the cosine of {of}"),
        Unknown(sine, -1000, 1000, "um", note=f"in proportion to the sine of {of}"),
    ]


LOAD: list[Effect[Gearing, Strength]] = [
    Effect(
        "face_misalignment",
        on_inputs=face_misalignment,
        unknowns=[
            Unknown("misalignment", -3, 100, "um", note="over the face width, beside that of the tolerances"),
            Unknown("per_load", -3, 100, "um/kN", note="what it gains with the tangential force of a mesh"),
        ],
        parts=[("misalignment",), ("per_load",)],
        looks_like="all stresses too high by a share that falls with the load; with shafts that bend, by one share at "
        "any load, which the tolerances or a gain of the gauge may be as well",
        why="sun and planet axes are not parallel: bores of the carrier, bearing play, and a shaft that bends",
        source=FACE,
    ),
    Effect(
        "structural_resonance",
        on_inputs=structural_resonance,
        unknowns=[
            Unknown("strength", 0, 2, "", note="error of the mesh times stiffness over load: gain far above it"),
            Unknown("resonance_speed", 200, 5000, "rpm", note="of the sun relative to the carrier"),
            Unknown("damping", 0.03, 0.3, "", note="damping ratio"),
        ],
        looks_like="all stresses have a peak at one speed of the input, by the same share at any load; nothing at rest "
        "and below the peak four times as much at twice the speed",
        why="shaft, carrier or housing have a frequency of their own, which the teeth of the sun meet at that speed",
        source=RESONANCE,
    ),
    Effect(
        "planet_load_sharing",
        on_inputs=planet_load_sharing,
        unknowns=[Unknown("lead", 0, 100, "um", note="of one planet before the mean of all, along the line of action")],
        looks_like="all stresses too high at small loads, hardly at large ones; root stresses by nearly the same "
        "amount at any load, like an offset",
        why="planets stand unevenly on their cranks; the first one to touch carries until its mesh has given way",
        source=STIFFNESS,
    ),
    Effect(
        "crowned_contact",
        on_inputs=crowned_contact,
        unknowns=[Unknown("full_line_load", 0, 200, "N/mm", note="force over width from which all of it carries")],
        looks_like="all stresses too high at small loads, and right from some load on",
        why="crowned teeth touch in the middle of their width; the contact grows with the load",
        source="Hertz, point contact of crowned flanks that spreads over the face; width as the cube root of the force",
    ),
    Effect(
        "relief_error",
        on_inputs=relief_error,
        unknowns=[Unknown("missing", -50, 50, "um", note="of the relief of the tip")],
        looks_like="root stresses off by the same amount at any load, like an offset; contact stress as calculated",
        why="the tips were ground back less than was meant, or more: the load meets the tooth higher, or lower",
        source=STIFFNESS,
    ),
    Effect(
        "centre_distance_growth",
        on_inputs=centre_distance_growth,
        unknowns=[
            Unknown(
                "expansion", -40, 40, "um/(m*K)", note="linear, of housing and carrier less that of the gears; "
                "aluminium less steel 12",
            )
        ],
        looks_like="the backlash grows with the temperature of the oil, back and forth, and never with the hours",
        why="the parts that hold the gears apart expand more than the gears, or get warmer",
        source="linear expansion; backlash of an involute pair on its working centre distance, ISO 21771",
    ),
]  # fmt: skip
OIL: list[Effect[Gearing, Strength]] = [
    Effect(
        "speed_dependent_loss",
        on_results=speed_dependent_loss,
        unknowns=[
            Unknown("constant", 0, 50, "N*m", note="holding back the sun at any speed: seals, preload"),
            Unknown("viscous", 0, 50, "N*m", note="holding back the sun at 100 mm²/s and 1000 r/min; as the power 2/3"),
        ],
        looks_like="efficiency falls towards small torques, and the more so the faster and the colder",
        why="seals, preloaded bearings and oil hold back an idle reducer too; catalogues print less than the formula",
        source=PALMGREN,
    ),
    Effect(
        "flash_temperature",
        on_results=flash_temperature,
        unknowns=[Unknown("friction", 0, 0.5, "", note="mean coefficient of the flanks; 0.03 to 0.1 in oil")],
        looks_like="flanks warmer than the oil, with the load to the power 3/4 and the root of the speed",
        why="flanks slide on one another at the ends of the path of contact, and friction heats them",
        source=BLOK,
    ),
]
ROTATION: list[Effect[Gearing, Strength]] = [
    Effect(
        "sun_runout",
        on_results=sun_runout,
        needs=[INPUT_ANGLE],
        acts_at_reference=True,
        unknowns=wave("cosine", "sine", "the angle of the sun against the carrier"),
        looks_like="transmission error with one wave per turn of the sun against the carrier, a little slower than the "
        "input shaft",
        why="the teeth of the sun are off the axis on which it turns",
        source=HARMONIC,
    ),
    Effect(
        "planet_runout",
        on_results=planet_runout,
        needs=[INPUT_ANGLE],
        acts_at_reference=True,
        unknowns=wave("cosine", "sine", "the angle of the planet"),
        looks_like="transmission error with one wave per turn of the planet, z1/z2 of those of the sun",
        why="the teeth of a planet are off the axis of its crank",
        source=HARMONIC,
    ),
    Effect(
        "mesh_ripple",
        on_results=mesh_ripple,
        needs=[INPUT_ANGLE],
        acts_at_reference=True,
        unknowns=[
            *wave("cosine", "sine", "the passing teeth"),
            *wave("second_cosine", "second_sine", "the passing teeth, twice a tooth"),
        ],
        parts=[("cosine", "sine"), ("second_cosine", "second_sine")],
        looks_like="a fast ripple of the transmission error: one wave, or two, for every tooth of the sun that passes",
        why="one pair of teeth and two carry in turn, and flanks have errors of form",
        source="kinematics of the mesh",
    ),
    Effect(
        "output_eccentricity",
        on_results=output_eccentricity,
        needs=[INPUT_ANGLE],
        acts_at_reference=True,
        unknowns=[
            *wave("cosine", "sine", "the angle of the output"),
            *wave("tooth_cosine", "tooth_sine", "the passing teeth of the discs"),
        ],
        parts=[("cosine", "sine"), ("tooth_cosine", "tooth_sine")],
        looks_like="a slow wave of the transmission error over one turn of the output, or one for every tooth of the "
        "discs",
        why="carrier or encoder of the output are off their axis; errors of the second stage come through to the first",
        source=HARMONIC,
    ),
    Effect(
        "ratio_drift",
        on_results=ratio_drift,
        needs=[INPUT_ANGLE],
        unknowns=[Unknown("miscount", -1e-3, 1e-3, "", note="of the ratio, relative")],
        looks_like="transmission error in proportion to the angle that was turned, and it never comes back",
        why="the ratio in the evaluation is rounded, or an encoder loses counts: an error of counting alone",
        source="kinematics: relative error of the ratio times angle and base radius of the sun",
    ),
]
TORQUE: list[Effect[Gearing, Strength]] = [
    Effect(
        "wind_up",
        on_results=wind_up,
        unknowns=[Unknown("compliance", 0, 100, "um/(N*m)", note="at the base circle of the sun, by its torque")],
        looks_like="transmission error in proportion to the torque, with its sign",
        why="the shaft between the encoder and the sun twists",
        source="Hooke's law",
    ),
    Effect(
        "lost_motion",
        on_results=lost_motion,
        unknowns=[
            Unknown("play", 0, 1000, "um", note="along the line of action, from flank to flank"),
            Unknown("torque_scale", 1, 500, "N*m", note="at the output; at it 76 % of the play is taken up"),
        ],
        looks_like="transmission error jumps where the torque changes its sign, and stays; so much more backlash",
        why="teeth, splines and bearings have play, which the torque takes up to one side or the other",
        source="lost motion of catalogues; hyperbolic tangent for the rounded jump",
    ),
    Effect(
        "wear_drift",
        on_results=wear_drift,
        needs=[TIME],
        unknowns=[Unknown("rate", 0, 50, "nm/h", note="that each loaded flank loses")],
        looks_like="transmission error drifts with the hours, to the side of the torque; the backlash grows twice as "
        "fast",
        why="flanks wear, or peel by micropitting",
        source=ARCHARD,
    ),
    Effect(
        "mesh_stiffening",
        on_results=mesh_stiffening,
        unknowns=[Unknown("share", 0, 10, "", note="of the calculated deflection of the teeth")],
        looks_like="transmission error grows with the torque, with its sign, faster about zero than farther out",
        why="teeth give way, and the more so while they hardly touch",
        source=STIFFNESS,
    ),
]
EFFECTS: list[Effect[Gearing, Strength]] = [*LOAD, *OIL, *ROTATION, *TORQUE]

__all__ = ["EFFECTS"]
