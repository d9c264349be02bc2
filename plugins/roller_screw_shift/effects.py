"""What the paper leaves out of the pair, and what is measured of it that is 0 in the calculation."""

from dataclasses import replace

import numpy as np

from gear_geometry.mesh_load import face_factor, shaken_by_error, viscosity_at, wave, wave_unknowns
from roller_screw_shift.quantities import Meshing, Pair
from roller_screw_shift.strength import load_of
from truing import Condition, Effect, Float, Unknown

# What else must be measured before the effects of the roller screw can act: each condition once, for all of them
#
# The axial load is an input of the pair; its column holds row by row. The clock of the bench is the ``time`` of the
# kernel's own effects.

SCREW_SPEED = Condition("screw_speed", "rpm", reference=0, low=10, high=3000,
                        note="of the screw; the sign is its sense of turning")  # fmt: skip
TEMPERATURE = Condition("temperature", "degC", reference=20, low=15, high=80, role="follows",
                        note="of nut, rollers and lubricant, when measured")  # fmt: skip
SCREW_ANGLE = Condition(
    "screw_angle", "deg", reference=0, low=0, high=36000, role="goes_on",
    note="of the screw, counted on over its turns: the carrier is back at its place after 8 turns of the screw only",
)  # fmt: skip
CYCLES = Condition(
    "cycles", "", reference=0, low=0, high=5e6, role="goes_on",
    note="load cycles of a tooth of the roller since new, all under the axial load of the row",
)  # fmt: skip


# What changes the load of a tooth, or how the root bears it: tilt, resonance, sharing, cut teeth, a soft rim

LEAST_FORCE = 1e-3  # N, of an idle mesh: even that touches somewhere


def line_stiffness(pair: Pair) -> Float:
    """Return the force by which a mesh answers to an approach of the flanks, N/m."""
    return pair.mesh_stiffness * pair.face_width


def mean_force(pair: Pair) -> Float:
    """Return the tangential load of a mesh at the mean, N, never quite 0."""
    return np.maximum(load_of(pair).tangential_force, LEAST_FORCE)


def face_misalignment(pair: Pair, *, misalignment: Float, per_load: Float) -> Pair:
    """The teeth do not meet along their whole width: by so much at any load, and by so much per newton of axial load.

    A load that reverses tilts the roller the other way, from where it stands without any.
    """
    gap = np.abs(misalignment + per_load * pair.axial_load)
    uneven = face_factor(gap * line_stiffness(pair) / (2.0 * mean_force(pair)))
    return replace(pair, face_load_factor=pair.face_load_factor * uneven)


def mesh_resonance(
    pair: Pair, *, excitation: Float, resonance_speed: Float, damping: Float, screw_speed: Float
) -> Pair:
    """Roller and mesh swing as one degree of freedom that the teeth shake once per mesh.

    The load in motion is that at rest and ``excitation`` N² / sqrt((1 - N²)² + (2 zeta N)²) of it: nothing at rest, a
    peak of excitation/(2 zeta) at the resonance, and ``excitation`` far above it, where the roller stands still and the
    error of the teeth alone works the mesh.
    """
    swing = excitation * shaken_by_error(screw_speed / resonance_speed, damping)
    return replace(pair, dynamic_factor=pair.dynamic_factor * (1.0 + swing))


def roller_load_sharing(pair: Pair, *, lead: Float) -> Pair:
    """The flank of this roller stands ahead of the mean of the others: it carries more, until its mesh has given way.

    All rollers move with a rigid carrier, so that this one takes ``lead`` (n_r - 1)/n_r times the stiffness of its mesh
    more than the mean. One that stays behind by much carries nothing.
    """
    ahead = lead * (pair.rollers - 1) / pair.rollers
    share = np.maximum(1.0 + ahead * line_stiffness(pair) / mean_force(pair), 0.0)
    return replace(pair, sharing_factor=pair.sharing_factor * share)


def interrupted_tooth(pair: Pair, *, lost: Float, phase: Float, screw_angle: Float) -> Pair:
    """The thread of the roller runs through its teeth: where it meets the ring, less of the face carries.

    The share that does not carry is lost (1 + cos(roller angle - phase))/2: nothing where the groove is on the far
    side, ``lost`` where it is in the middle of the mesh. The angle of the roller is counted against the carrier.
    """
    there = load_of(pair).roller_order * screw_angle - phase
    missing = 0.5 * lost * (1.0 + np.cos(there))
    return replace(pair, carrying_share=pair.carrying_share * (1.0 - missing))


def rim_compliance(pair: Pair, *, softness: Float) -> Pair:
    """A thin rim bends under its teeth: the root of the ring bears so much more stress than in a solid one."""
    return replace(pair, rim_factor=pair.rim_factor * (1.0 + softness))


def soft_threads(pair: Pair, *, compliance: Float) -> Pair:
    """Threads bend beside their contacts: each gives way in proportion to its load, on either side of the roller."""
    return replace(pair, thread_compliance=pair.thread_compliance + compliance)


def roller_pitch_error(pair: Pair, *, deviation: Float) -> Pair:
    """The threads of the rollers stand farther apart than those of screw and nut: those at the ends touch first."""
    return replace(pair, roller_pitch_deviation=pair.roller_pitch_deviation + deviation)


# What the turning screw brings along: runout of roller and carrier, a roller that creeps along the screw

TURN = 2.0 * np.pi


def with_wave(meshing: Meshing, angle: Float, cosine: Float, sine: Float) -> Meshing:
    """Return the results with one harmonic of an angle on the transmission error."""
    return replace(meshing, transmission_error=meshing.transmission_error + wave(angle, cosine, sine))


def roller_runout(pair: Pair, meshing: Meshing, *, cosine: Float, sine: Float, screw_angle: Float) -> Meshing:
    """The teeth of the roller are off its axis: one wave per turn of the roller against the carrier."""
    return with_wave(meshing, load_of(pair).roller_order * screw_angle, cosine, sine)


def carrier_runout(pair: Pair, meshing: Meshing, *, cosine: Float, sine: Float, screw_angle: Float) -> Meshing:
    """The carrier is off the axis of the ring: one wave per turn of the carrier."""
    return with_wave(meshing, load_of(pair).carrier_order * screw_angle, cosine, sine)


def axial_migration(pair: Pair, meshing: Meshing, *, mismatch: Float, screw_angle: Float) -> Meshing:
    """Teeth and threads do not keep the same ratio: the roller creeps by a share of the lead with every turn."""
    creep = mismatch * pair.lead * screw_angle / TURN
    return replace(meshing, axial_shift=meshing.axial_shift + creep)


# What the flanks do to one another, and heat to their distance: wear, friction, a centre distance that grows

MILLION = 1e6
RATED_FORCE = 51.943  # N, of a mesh under 10 kN of axial load
LEAST_SPEED = 1.0 / 60.0  # turns per second: below it friction is that at one turn per minute
ROUGHNESS = 0.8  # um, Ra of the flanks
DENSITY = 0.88  # g/cm³ of the oil
VISCOSITY_AT_FORTY = 100.0  # mm²/s, ISO VG 100


def thermal_centre_distance(pair: Pair, *, expansion: Float, temperature: Float) -> Pair:
    """The threads that hold the rollers at their distance expand, and the ring does not, or by less."""
    growth = expansion * pair.centre_distance * (temperature - TEMPERATURE.zero)
    return replace(pair, centre_distance_deviation=pair.centre_distance_deviation + growth)


def flank_wear(pair: Pair, meshing: Meshing, *, rate: Float, cycles: Float) -> Meshing:
    """Flanks wear with load, sliding and meshes: the roller by its cycles, the ring by those of all rollers.

    ``rate`` is the depth after a million cycles with 51.943 N on the mesh and a specific sliding of 1. While a flank
    passes the contact of width 2b it slides by 2b times its specific sliding. The depth is the roller's deepest; the
    backlash grows by what both flanks lose where they touch, at the worse end of the path, as an arc.
    """
    worn = rate * load_of(pair).tangential_force / RATED_FORCE * cycles / MILLION
    deepest = np.maximum(meshing.root_sliding_roller, meshing.tip_sliding_roller)
    at_ring_tip = meshing.root_sliding_roller + meshing.ring_meshes * meshing.tip_sliding_ring
    at_roller_tip = meshing.tip_sliding_roller + meshing.ring_meshes * meshing.root_sliding_ring
    gap = worn * np.maximum(at_ring_tip, at_roller_tip) / np.cos(meshing.mounted_angle)
    return replace(meshing, wear_depth=meshing.wear_depth + worn * deepest, backlash=meshing.backlash + gap)


def mesh_friction(pair: Pair, meshing: Meshing, *, factor: Float, screw_speed: Float, temperature: Float) -> Meshing:
    """The flanks rub: the torque that it takes to turn the screw against it has the sign of the speed.

    ``factor`` is the friction over that of the formula.
    """
    torque = factor * np.sign(screw_speed) * friction_torque(pair, meshing, np.abs(screw_speed), temperature)
    return replace(meshing, friction_torque=meshing.friction_torque + torque)


def friction_torque(pair: Pair, meshing: Meshing, speed: Float, temperature: Float) -> Float:
    """Return the torque at the screw, N m, by which the meshes of all rollers with one ring rub; speed in turns/s.

    Loss of power: tangential force times speed of the pitch circles times mu times the loss factor of the mesh.
    """
    load = load_of(pair)
    pitch_speed = (
        load.carrier_order * meshing.base_radius_ring / np.cos(meshing.mounted_angle)
    )  # per rad/s of the screw
    friction = mean_friction(pair, meshing, pitch_speed * TURN * np.maximum(speed, LEAST_SPEED), temperature)
    return pair.rollers * load.tangential_force * pitch_speed * friction * loss_factor(pair, meshing)


def loss_factor(pair: Pair, meshing: Meshing) -> Float:
    """Return the loss of power of a mesh over its power and mu: sliding, with the load shared evenly by the pairs.

    pi (1/z_E - 1/z_I) (1 - eps + eps_E² + eps_I²) of a spur pair with 1 <= eps <= 2. Reference: Ohlendorf 1958.
    """
    working = np.tan(meshing.mounted_angle)
    at_roller_tip = pair.roller_teeth * (np.tan(meshing.tip_angle_roller) - working) / TURN
    at_ring_tip = pair.ring_teeth * (working - np.tan(meshing.tip_angle_ring)) / TURN
    both = 1.0 - at_roller_tip - at_ring_tip + at_roller_tip**2 + at_ring_tip**2
    return np.pi * (1.0 / pair.roller_teeth - 1.0 / pair.ring_teeth) * both


def mean_friction(pair: Pair, meshing: Meshing, pitch_speed: Float, temperature: Float) -> Float:
    """Return the mean coefficient of friction of the flanks, from the pitch point; speed in m/s, temperature in K.

    0.048 (F_bt/b / (v_S rho))^0.2 eta^-0.05 Ra^0.25 with N/mm, m/s, mm, mPa s and um. Fitted to gear drives with
    larger line loads than a roller has; the factor of the effect takes up what that does.
    Reference: ISO/TR 14179-2.
    """
    sine = np.sin(meshing.mounted_angle)
    roller = meshing.base_radius_roller * np.tan(meshing.mounted_angle)
    ring = meshing.base_radius_ring * np.tan(meshing.mounted_angle)
    radius_mm = 1e3 * roller * ring / (ring - roller)
    line_load = 1e-3 * load_of(pair).tangential_force / (np.cos(pair.pressure_angle) * pair.face_width)  # N/mm
    together = 2.0 * pitch_speed * sine
    oil = (DENSITY * viscosity(temperature)) ** -0.05
    value: Float = 0.048 * (line_load / (together * radius_mm)) ** 0.2 * oil * ROUGHNESS**0.25
    return value


def viscosity(temperature: Float) -> Float:
    """Return the kinematic viscosity of the oil, mm²/s."""
    return viscosity_at(temperature, VISCOSITY_AT_FORTY)


# They act in the order declared: first what changes the load of a tooth or the place of the parts, then what is added
# to a result. A new effect is a function beside the others and one more entry in EFFECTS.

ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"
HARMONIC = "first harmonic of an eccentricity; kinematics of the screw with its nut at rest"
FRICTION = (
    "ISO/TR 14179-2: mean coefficient of friction; Ohlendorf, H., Verlustleistung und Erwärmung von Stirnrädern, "
    "Munich 1958: loss factor"
)


EFFECTS: list[Effect[Pair, Meshing]] = [
    Effect("face_misalignment", on_inputs=face_misalignment,
           unknowns=[Unknown("misalignment", 0, 20, "um",
                             "gap at one end of the face without load; 0.2 to 2 mrad of tilt"),
                     Unknown("per_load", 0, 2, "um/kN", "what the gap gains with the axial load")],
           parts=[("misalignment",), ("per_load",)],
           looks_like="both root stresses too high by one amount at any load, like an offset or a roller ahead of "
                      "the others, and by less than that at small loads, where a part of the face lifts off; a tilt "
                      "by the load is like a gain of both",
           remedy="Align the roller in its carrier; a tilt that grows with the load needs a stiffer one. Both root "
                  "stresses are then lower.",
           why="the roller is tilted in its carrier, and bends and tilts further under its load",
           source="ISO 6336-1, method C: face load factor of a misaligned pair"),
    Effect("mesh_resonance", on_inputs=mesh_resonance, needs=[SCREW_SPEED],
           unknowns=[Unknown("excitation", 0, 0.5, "", "error of the teeth times stiffness over the load; 0.02 to 0.1"),
                     Unknown("resonance_speed", 200, 6000, "rpm", "of the screw"),
                     Unknown("damping", 0.03, 0.3, "", "damping ratio; 0.04 to 0.1")],
           looks_like="both root stresses have a peak at one speed of the screw, by the same share at any load",
           remedy="Run the screw away from this speed, or fit gears with smaller errors of their teeth; the peak of "
                  "the stresses is then lower or not met.",
           why="the teeth shake the rollers on the stiffness of their mesh, once per tooth",
           source="one degree of freedom shaken by its base: displacement of the mesh"),
    Effect("roller_load_sharing", on_inputs=roller_load_sharing,
           unknowns=[Unknown("lead", -20, 20, "um",
                             "of the flank of this roller before the mean of the others; 1 to 5")],
           looks_like="both root stresses off by one amount at any load, like an offset; a roller that stays behind "
                      "carries nothing at small loads",
           remedy="Fit rollers whose teeth stand alike to their threads; the root stresses of all rollers then agree.",
           why="the teeth of the rollers do not stand alike to their threads, so that some carry more than others",
           source="rollers on a rigid carrier: equilibrium of loads by the stiffness of their meshes"),
    Effect("interrupted_tooth", on_inputs=interrupted_tooth, needs=[SCREW_ANGLE], acts_at_reference=True,
           unknowns=[Unknown("lost", 0, 0.9, "", "share of the face that does not carry where it is least; 0.2 to 0.5"),
                     Unknown("phase", 180, 540, "deg", "angle of the roller at which that is, and one turn away")],
           looks_like="both root stresses swing once per turn of the roller, in proportion to the load, with crests "
                      "narrower than their troughs",
           remedy="Rate the teeth with the effect on; rollers whose thread ends before the teeth show no swing of the "
                  "stress with their turns.",
           why="the thread of a roller runs through the teeth at its ends",
           source="geometry: share of the face that a groove takes from it"),
    Effect("rim_compliance", on_inputs=rim_compliance,
           unknowns=[Unknown("softness", 0, 1.5, "", "rim factor less 1; 0.17 with a rim of 3 modules, 0.64 of 2")],
           looks_like="the root stress of the ring is too high by one share, and nothing else: as with a gain of its "
                      "gauge, which another gauge or a weight on the tooth tells apart",
           remedy="Confirm it with a second gauge on the ring, then state rim_factor or make the rim thicker; the "
                  "stress of the ring then fits.",
           why="the ring is thin behind its teeth and bends as a whole",
           source="ISO 6336-3: rim factor Y_B = 1.15 ln(8.324 m/s_R) of an internal gear, 1.75 < s_R/m < 3.5"),
    Effect("soft_threads", on_inputs=soft_threads,
           unknowns=[Unknown("compliance", 0, 100, "um/kN", "of one thread on one side of a roller; 2 to 20")],
           looks_like="the screw gives way more, in proportion to the load, where contacts alone stiffen with it; "
                      "where that is little, like a gain of the gauge",
           remedy="Keep the effect on, and rate stiffness and sharing with it; the deflection measured is then met.",
           why="threads bend and shear under their load, which contacts and bars leave out",
           source="a spring behind every Hertzian contact; Yamamoto has its parts for a thread that touches all round"),
    Effect("roller_pitch_error", on_inputs=roller_pitch_error,
           unknowns=[Unknown("deviation", 0, 5, "um", "pitch of the rollers over that of screw and nut; to 1")],
           looks_like="the screw gives way much more under small loads, until all threads touch, and from there on "
                      "by one length more, like an offset of the gauge; rollers of too small a pitch look nearly alike",
           remedy="Fit rollers of the pitch of screw and nut, or rate the life with the effect on; the screw is then "
                  "stiff from small loads on.",
           why="the pitch of the rollers is not that of screw and nut, so that only threads at their ends touch",
           source="network of bars and Hertzian contacts with gaps"),
    Effect("thermal_centre_distance", on_inputs=thermal_centre_distance, needs=[TEMPERATURE],
           unknowns=[Unknown("expansion", -40, 40, "um/(m*K)",
                             "linear, of screw and nut less that of the ring; steel 11.5")],
           looks_like="the backlash shrinks as the screw gets warm and comes back when it cools: 0.2 um per kelvin "
                      "with steel beside a cold ring; a thermal drift of its gauge looks the same",
           remedy="Leave backlash for the warm screw, and read it at one temperature; readings then agree, and the "
                  "warm teeth do not jam.",
           why="the threads hold the rollers at their distance, and are warmer than the ring, or of another metal",
           source="linear expansion; backlash of an internal involute pair, ISO 21771"),
    Effect("roller_runout", on_results=roller_runout, needs=[SCREW_ANGLE], acts_at_reference=True,
           unknowns=wave_unknowns(200, "um", "the angle of the roller"),
           looks_like="transmission error with one wave per turn of the roller against the carrier, 1.875 per turn "
                      "of the screw",
           remedy="Replace the roller whose teeth are off the axis of its thread; the wave once per turn of the "
                  "roller is gone then.",
           why="the teeth of a roller are off the axis of its thread",
           source=HARMONIC),
    Effect("carrier_runout", on_results=carrier_runout, needs=[SCREW_ANGLE], acts_at_reference=True,
           unknowns=wave_unknowns(200, "um", "the angle of the carrier"),
           looks_like="transmission error with one wave per turn of the carrier, 0.375 per turn of the screw",
           remedy="Centre the ring in the nut and the carrier on the screw; the wave once per turn of the carrier is "
                  "gone then.",
           why="the ring is off the axis of the nut, or the carrier off that of the screw",
           source=HARMONIC),
    Effect("axial_migration", on_results=axial_migration, needs=[SCREW_ANGLE],
           unknowns=[Unknown("mismatch", -5, 5, "um/mm",
                             "creep of the roller per turn of the screw over the lead; to 2")],
           looks_like="the roller moves along the screw in proportion to the angle turned, and back when that goes "
                      "back",
           remedy="Fit rollers whose threads have the pitch diameter that the ratio of the teeth asks for; the roller "
                  "then no longer creeps.",
           why="the teeth keep one ratio, the pitch diameters of the threads as made another",
           source="kinematics of the planetary roller screw"),
    Effect("flank_wear", on_results=flank_wear, needs=[CYCLES],
           unknowns=[Unknown("rate", 0, 50, "um", "depth per million cycles at 51.943 N and a specific sliding of 1")],
           looks_like="the depth of wear grows with load and cycles, whatever the time, and the backlash about twice "
                      "as fast with ten rollers of a fifth of the ring's teeth",
           remedy="Check lubricant and load, and replace rollers and ring that are worn too deep; the backlash is "
                  "then that of a new screw.",
           why="flanks slide on one another away from the pitch point",
           source=ARCHARD),
    Effect("mesh_friction", on_results=mesh_friction, needs=[SCREW_SPEED, TEMPERATURE], acts_at_reference=True,
           unknowns=[Unknown("factor", 0, 20, "", "friction over that of the formula")],
           looks_like="torque against the turning that grows a little more than in proportion to the load, falls "
                      "slowly with the speed and hardly rises with the temperature",
           remedy="Keep the effect on; if the factor exceeds that of a sound screw, renew the lubricant and look at "
                  "the flanks until the torque falls.",
           why="flanks slide on one another away from the pitch point",
           source=FRICTION),
]  # fmt: skip
