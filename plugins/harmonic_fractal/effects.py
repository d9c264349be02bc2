"""What the rough flanks leave out of the torsion and the stiffness of a drive, or of a measured surface.

They act in the order declared: first what changes flanks, pairs and springs, then what is added to the torsion, then
the surface, then the readings. A new effect is a function beside the others and one more entry in EFFECTS.
"""

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.conditions import (
    CYCLES,
    DIRECTION,
    PEAK_TORQUE,
    REVERSAL_TORQUE,
    SPEED,
    TEMPERATURE,
    TIME,
    WAVE_ANGLE,
)
from harmonic_fractal.effects_of_friction import (
    first_load_set,
    flank_wear,
    hysteresis,
    lost_motion,
    thermal_preload,
    viscous_hysteresis,
)
from harmonic_fractal.effects_of_mesh import (
    asperity_smoothing,
    engaged_pairs,
    modulus_temperature,
    oil_film,
    series_compliance,
)
from harmonic_fractal.effects_of_motion import creep, eccentricity, ellipticity, rig_drift
from harmonic_fractal.effects_of_surface import instrument_noise, lateral_filter, waviness
from harmonic_fractal.quantities import Drive
from truing import Effect, Unknown

ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"
DOWSON = "Dowson, D., Higginson, G. R., Elasto-hydrodynamic lubrication, Pergamon 1966: film of a line contact"
CATALOGUE = "catalogues of harmonic drives: three stiffnesses, hysteresis and lost motion of about 1 arcmin (291 urad)"
MASING = (
    "Masing, G., Eigenspannungen und Verfestigung beim Messing, 2nd Int. Congress of Applied Mechanics, Zurich 1926"
)
PARTS = "in parts of T_2 of the size in the catalogue (25 N*m for size 20)"
FRICTION_SCALE = Unknown("torque_scale", 0.005, 4, "", note=f"torque after which 63 % has turned round, {PARTS}")
PLAY_SCALE = Unknown("torque_scale", 0.002, 1, "", note=f"torque at which 76 % of the play is crossed, {PARTS}")


def wave(limit: float, unit: str, prefix: str = "", of: str = "the torsion") -> list[Unknown]:
    """Declare both parts of one harmonic."""
    return [
        Unknown(f"{prefix}cosine", -limit, limit, unit, note=f"part of the wave of {of}"),
        Unknown(f"{prefix}sine", -limit, limit, unit, note=f"part of the wave of {of}"),
    ]


MESH: list[Effect[Drive, Stiffness]] = [
    Effect(
        "series_compliance",
        on_inputs=series_compliance,
        unknowns=[
            Unknown("compliance", 0, 1000, "urad/(N*m)", note="1 over a stiffness; 1.4 to 530 in the catalogue"),
        ],
        looks_like="the torsion grows in proportion to the torque, alike in both senses; nothing of the mesh itself",
        why="cup, wave generator, its bearing and the test rig are springs in series with the mesh, and much softer",
        source=CATALOGUE,
    ),
    Effect(
        "engaged_pairs",
        on_inputs=engaged_pairs,
        unknowns=[
            Unknown("gain", 0, 2, "", note="of pairs at a large torque, over those stated; 1.7 from 15 to 40 %"),
            Unknown("torque_scale", 0.04, 8, "", note=f"torque after which 63 % of them have come to bear, {PARTS}"),
        ],
        looks_like="the mesh stiffens with the torque more than its flanks do, most where its teeth bend",
        why="the flexspline gives way under its load and lays more teeth against those of the circular spline",
        source="parallel pairs of teeth: at one torque the stiffness grows with their number to the power 1 - m",
    ),
    Effect(
        "oil_film",
        on_inputs=oil_film,
        needs=[SPEED, TEMPERATURE],
        acts_at_reference=True,
        unknowns=[
            Unknown("stiffness", 0, 200, "kN/um", note="of a pair full of oil at 1000 rpm, 20 degC, T_2; 5 to 60"),
        ],
        looks_like="the mesh is stiffer while it turns, most at a low speed and with warm oil, by one amount at any "
        "torque; it is lost again where it creeps, and nothing is left at rest",
        why="oil between the flanks cannot leave in time and carries beside the asperities",
        source=f"{DOWSON}; share of a film at a fixed gap: Reynolds 1886; load shared with asperities: Johnson, K. L., "
        "Greenwood, J. A., Poon, S. Y., A simple theory of asperity contact in elastohydrodynamic lubrication, Wear 19 "
        "(1972) 91",
    ),
    Effect(
        "asperity_smoothing",
        on_inputs=asperity_smoothing,
        needs=[CYCLES],
        unknowns=[
            Unknown("dimension", 0, 0.2, "", note="by which D rises; 0.02 to 0.1"),
            Unknown("roughness", 0, 5, "", note="by which ln G falls; 0.7 to 2.3"),
            Unknown("cycle_scale", 1e3, 1e7, "", note="cycles after which 63 % is done"),
        ],
        looks_like="the mesh stiffens with the cycles, soon and then no more; the structure function falls with them",
        why="the first load cycles flatten the highest asperities of new flanks",
        source="running-in of machined surfaces: D rises and G falls",
    ),
    Effect(
        "modulus_temperature",
        on_inputs=modulus_temperature,
        needs=[TEMPERATURE],
        unknowns=[Unknown("softening", 0, 2e-3, "1/K", note="of steel 2.5e-4 to 4e-4")],
        looks_like="torsion too large by one share when warm, of flanks, teeth and cup alike",
        why="Young's modulus falls with the temperature",
        source="handbook: elasticity of steel over temperature",
    ),
]
MOTION: list[Effect[Drive, Stiffness]] = [
    Effect(
        "creep",
        on_results=creep,
        needs=[TIME],
        unknowns=[
            Unknown("share", 0, 0.2, "", note="of the elastic torsion, per e-fold of time; 0.002 to 0.02"),
            Unknown("time_scale", 1e-3, 10, "h", note="time from which it counts"),
        ],
        looks_like="the torsion grows with time in proportion to itself, fast at first and ever more slowly",
        why="joints, bearing and bonded cup settle under a torque that stays",
        source="logarithmic creep",
    ),
    Effect(
        "ellipticity",
        on_results=ellipticity,
        needs=[WAVE_ANGLE],
        acts_at_reference=True,
        unknowns=[
            *wave(1000, "urad"),
            *wave(0.5, "", "stiffness_", "the mesh stiffness, as a share of it"),
        ],
        parts=[("cosine", "sine"), ("stiffness_cosine", "stiffness_sine")],
        looks_like="two waves per turn of the wave generator, of the torsion at any torque, or of the mesh stiffness",
        why="the two lobes of the wave generator, or the bores it sits in, are not alike",
        source="second harmonic of the shape of the wave generator",
    ),
    Effect(
        "eccentricity",
        on_results=eccentricity,
        needs=[WAVE_ANGLE],
        acts_at_reference=True,
        unknowns=wave(1000, "urad"),
        looks_like="one wave of the torsion per turn of the wave generator, at any torque",
        why="the wave generator, or its coupling, is off the axis of the drive",
        source="first harmonic of an eccentricity",
    ),
]
FRICTION: list[Effect[Drive, Stiffness]] = [
    Effect(
        "hysteresis",
        on_results=hysteresis,
        needs=[DIRECTION, REVERSAL_TORQUE, PEAK_TORQUE],
        unknowns=[Unknown("loop", 0, 2000, "urad", note="whole width; 290 to 870 (1 to 3 arcmin)"), FRICTION_SCALE],
        looks_like="the torsion is smaller on the way up than on the way down at the same torque, and turns round "
        "within a short way of it",
        why="teeth, bearing and cup rub before they slip",
        source=f"{MASING}; {CATALOGUE}",
    ),
    Effect(
        "viscous_hysteresis",
        on_results=viscous_hysteresis,
        needs=[SPEED, TEMPERATURE, DIRECTION, REVERSAL_TORQUE, PEAK_TORQUE],
        acts_at_reference=True,
        unknowns=[
            Unknown("loop", 0, 2000, "urad", note="whole width at 1000 rpm and 20 degC, beside that at rest"),
            FRICTION_SCALE,
            Unknown("thinning", 0.01, 0.08, "1/K", note="of the lubricant's viscosity; 0.02 to 0.05"),
        ],
        looks_like="a loop of the torsion that is wider the faster and the colder the drive runs; none at rest",
        why="the lubricant drags in proportion to its viscosity and to the speed",
        source=f"viscous drag; {MASING}",
    ),
    Effect(
        "lost_motion",
        on_results=lost_motion,
        unknowns=[Unknown("play", 0, 1000, "urad", note="half of it; to 290 (1 arcmin) in catalogues"), PLAY_SCALE],
        looks_like="the torsion jumps about no torque, and is shifted in its sense by one amount at larger ones",
        why="the teeth have play, which they cross one after another",
        source=CATALOGUE,
    ),
    Effect(
        "first_load_set",
        on_results=first_load_set,
        needs=[PEAK_TORQUE],
        unknowns=[
            Unknown("set", 0, 300, "urad", note="after a load of T_2 in the catalogue; 6 to 60"),
            Unknown("exponent", 1, 1.5, "", note="power of the peak torque"),
            Unknown("stiffening", 0, 2, "", note="of the mesh below the peak; 0.1 to 0.6"),
        ],
        parts=[("set", "exponent"), ("stiffening",)],
        looks_like="a torsion that stays when the torque goes, and grows only with a new peak; a mesh that is stiffer "
        "below the peak than it was when it was reached",
        why="the highest asperities flow under the first load, and lie flat from then on",
        source="plastic contact of rough surfaces",
    ),
    Effect(
        "flank_wear",
        on_results=flank_wear,
        needs=[CYCLES],
        unknowns=[
            Unknown("rate", 0, 20, "um", note="depth on either flank per million cycles in service"),
            PLAY_SCALE,
        ],
        looks_like="a lost motion that grows in proportion to the cycles",
        why="the flanks slide on one another with every wave",
        source=ARCHARD,
    ),
    Effect(
        "thermal_preload",
        on_results=thermal_preload,
        needs=[TEMPERATURE],
        unknowns=[
            Unknown(
                "expansion", -20, 20, "um/(m*K)", note="linear, of the circular spline less that of the flexspline"
            ),
        ],
        looks_like="a lost motion that grows, or shrinks, in proportion to the temperature",
        why="the two splines are of different metal and move apart, or together, as they get warm",
        source="linear expansion; play of teeth that move apart, 2 tan(alpha) times the distance",
    ),
]
SURFACE: list[Effect[Drive, Stiffness]] = [
    Effect(
        "lateral_filter",
        on_inputs=lateral_filter,
        unknowns=[
            Unknown("width", 0, 20, "um", note="standard deviation of its weight; 0.187 of the cutoff of ISO 16610-21"),
        ],
        looks_like="the structure function is too low, by a share at lags below a few widths and by one amount above",
        why="a stylus, a spot of light or a filter averages over the finest roughness",
        source="Gaussian weight on a power law; ISO 16610-21",
    ),
    Effect(
        "waviness",
        on_results=waviness,
        unknowns=[
            Unknown("square", 0, 4, "um^2", note="of its amplitude A, since it enters so; A is 0.05 to 1 um"),
            Unknown("wavelength", 3, 3000, "um", note="30 to 500"),
        ],
        looks_like="the structure function has a hump at half a wavelength, and a dip at a whole one",
        why="chatter and feed of the tool leave waves on a flank",
        source="structure function of a sine",
    ),
]
READING: list[Effect[Drive, Stiffness]] = [
    Effect(
        "rig_drift",
        on_reading=rig_drift,
        needs=[TIME],
        unknowns=[Unknown("rate", -500, 500, "urad/h", note="1 to 30")],
        looks_like="the torsion moves with time, whatever the torque, as with a sensor that drifts",
        why="the rig gets warm and bends",
        source="linear growth with time",
    ),
    Effect(
        "instrument_noise",
        on_reading=instrument_noise,
        unknowns=[
            Unknown(
                "variance", 0, 1e4, "nm^2", note="square of the noise of one height, since it enters so; 1 to 2500"
            ),
        ],
        looks_like="the structure function is too high by one amount at any lag, which is an offset",
        why="every height has the noise of its instrument",
        source="structure function of white noise: twice its variance",
    ),
]
EFFECTS: list[Effect[Drive, Stiffness]] = [*MESH, *MOTION, *FRICTION, *SURFACE, *READING]

__all__ = ["EFFECTS"]
