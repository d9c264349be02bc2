"""What the rating of the first stage leaves out, and what is measured of the stage that it does not give."""

from dataclasses import replace

import numpy as np

from gear_geometry import cycloid
from gear_geometry.mesh_load import shaken_by_error, viscosity_at, wave, wave_unknowns
from rv_gearing.flank import TURN, blok, softness_of
from rv_gearing.geometry import ToothLoad, load_of
from rv_gearing.groups import centre_distance_of, mesh_efficiency
from rv_gearing.quantities import Gearing
from rv_gearing.rating import Strength
from truing import Condition, Effect, Float, Unknown

# What else must be measured before the effects of the gearing can act: each condition once, shared by its effects
#
# Torque, speed and the temperature of the oil are inputs of the stage; their columns hold row by row.

INPUT_ANGLE = Condition(
    "input_angle", "deg", reference=0, low=0, high=39960, role="goes_on",
    note="of the sun, counted on over its turns; at a ratio of 111 one turn of the output is 39960 degrees",
)  # fmt: skip
TIME = Condition("time", "h", reference=0, low=0, high=6000, role="goes_on", note="at work since new")


# What changes the load of a tooth and so every stress: misalignment, resonance, sharing, width and tip that carry

LEAST_FORCE = 1e-3  # N, of an idle mesh: even that touches somewhere


def face_misalignment(stage: Gearing, *, misalignment: Float, per_load: Float) -> Gearing:
    """The teeth do not meet along their whole width: by so much at any load, and by so much per newton of a mesh."""
    out_of_line = misalignment + per_load * load_of(stage).duty.tangential_force
    return replace(stage, extra_misalignment=stage.extra_misalignment + out_of_line)


def structural_resonance(stage: Gearing, *, strength: Float, resonance_speed: Float, damping: Float) -> Gearing:
    """Shaft, carrier or housing answers to the meshing teeth as one degree of freedom that their error shakes.

    ``strength`` is the error, by the stiffness that it works against, over the load: the dynamic factor gains
    ``strength`` N² / sqrt((1 - N²)² + (2 zeta N)²), nothing at rest and strength/(2 zeta) at the resonance. Speeds are
    those of the sun relative to the carrier, which the frequency of the mesh follows.
    """
    answer = strength * shaken_by_error(load_of(stage).duty.mesh_speed / resonance_speed, damping)
    return replace(stage, extra_dynamic_factor=stage.extra_dynamic_factor + answer)


def planet_load_sharing(stage: Gearing, *, lead: Float) -> Gearing:
    """One planet is ahead of the mean of all and is loaded more, until its mesh has given way by as much."""
    return replace(stage, sharing_error=stage.sharing_error + lead)


def crowned_contact(stage: Gearing, *, full_line_load: Float) -> Gearing:
    """Crowned teeth touch over a width that grows with the cube root of the force, until the whole face carries.

    Of a parabola, on a bed of springs and on Hertz's half space alike. The mean over this width is what is raised; how
    uneven the load is across it stays with the face load factor.
    """
    force = np.maximum(load_of(stage).duty.tangential_force, LEAST_FORCE)
    share = np.cbrt(force / np.maximum(force, full_line_load * stage.face_width))
    return replace(stage, carrying_share=stage.carrying_share * share)


def relief_error(stage: Gearing, *, missing: Float) -> Gearing:
    """The tip is relieved by less than was meant, or by more: the tooth takes its load nearer to the tip, or lower."""
    return replace(stage, relief_deviation=stage.relief_deviation + missing)


# What the angle of the sun brings into the transmission error: runouts, teeth, the output, and a miscount
#
# The orders of the gears count the turns of the sun against the carrier, those of the output the turns of the housing's
# frame. Angles in rad, errors in m along the line of action.


def relative_angle(load: ToothLoad, input_angle: Float) -> Float:
    """Return the angle of the sun against the carrier, which turns with the output."""
    return input_angle * (1.0 - 1.0 / load.duty.ratio)


def with_error(strength: Strength, error: Float) -> Strength:
    """Return the results with so much more transmission error."""
    return replace(strength, transmission_error=strength.transmission_error + error)


def sun_runout(stage: Gearing, strength: Strength, *, cosine: Float, sine: Float, input_angle: Float) -> Strength:
    """The teeth of the sun are off its axis: one wave per turn against the carrier."""
    return with_error(strength, wave(relative_angle(load_of(stage), input_angle), cosine, sine))


def planet_runout(stage: Gearing, strength: Strength, *, cosine: Float, sine: Float, input_angle: Float) -> Strength:
    """The teeth of a planet are off its axis: one wave per turn of the planet, z1/z2 of the sun's."""
    load = load_of(stage)
    return with_error(strength, wave(relative_angle(load, input_angle) * load.sun / load.planet, cosine, sine))


def mesh_ripple(
    stage: Gearing,
    strength: Strength,
    *,
    cosine: Float,
    sine: Float,
    second_cosine: Float,
    second_sine: Float,
    input_angle: Float,
) -> Strength:
    """Every tooth of the sun passes once per turn and brings the error of its flank, and that of half its pitch."""
    load = load_of(stage)
    teeth = load.sun * relative_angle(load, input_angle)
    return with_error(strength, wave(teeth, cosine, sine) + wave(2.0 * teeth, second_cosine, second_sine))


def output_eccentricity(
    stage: Gearing,
    strength: Strength,
    *,
    cosine: Float,
    sine: Float,
    tooth_cosine: Float,
    tooth_sine: Float,
    input_angle: Float,
) -> Strength:
    """The output, or what it is measured on, is off its axis; and the teeth of the discs pass once per turn of it."""
    load = load_of(stage)
    output = input_angle / load.duty.ratio
    of_teeth = wave((load.duty.pins - 1.0) * output, tooth_cosine, tooth_sine)
    return with_error(strength, wave(output, cosine, sine) + of_teeth)


def ratio_drift(stage: Gearing, strength: Strength, *, miscount: Float, input_angle: Float) -> Strength:
    """The angles of input and output are counted in another ratio than that of the teeth: an error that adds up."""
    return with_error(strength, miscount * input_angle * load_of(stage).base_radii[0])


# How warm the flanks get where they slide on one another


def flash_temperature(stage: Gearing, strength: Strength, *, friction: Float) -> Strength:
    """The flanks are warmer than the oil by the flash of that end of the path of contact where it is the greater.

    Every tooth is taken to carry the whole line load at the ends of its path, so the friction that is found is that of
    a mesh in which the second pair of teeth does not help.
    """
    rise = friction * flash_of(stage, strength)
    return replace(strength, flank_temperature=strength.flank_temperature + rise)


def flash_of(stage: Gearing, strength: Strength) -> Float:
    """Return the flash temperature per coefficient of friction, K: 1.11 w |v_1^1/2 - v_2^1/2| / ((2 b_H)^1/2 B_M).

    Transverse section, both gears of steel; w is the line load along the normal with the application factor alone, v
    the speeds of the flanks along themselves. Reference: Blok 1937, ISO/TS 6336-20.
    """
    speed = TURN * strength.duty.mesh_speed
    force = strength.duty.line_load / np.cos(strength.mesh.transverse_angle)
    rises = [
        blok(force, radii, (speed * radii[0], speed * radii[1] / strength.mesh.tooth_ratio), softness_of(stage))
        for radii in ends_of_path(strength)
    ]
    return np.maximum(rises[0], rises[1])


def ends_of_path(strength: Strength) -> tuple[tuple[Float, Float], tuple[Float, Float]]:
    """Return the radii of curvature of sun and planet, m, where contact begins and where it ends."""
    sun, planet = strength.sun, strength.planet
    tips = [0.5 * gear.size.base_diameter * np.tan(gear.size.tip_angle) for gear in (sun, planet)]
    return (np.maximum(sun.size.start_curvature, 0.0), tips[1]), (tips[0], np.maximum(planet.size.start_curvature, 0.0))


# What follows the oil: how far its heat drives the gears apart, and what it holds back at any torque

ROOM = 293.15  # K: at 20 degC the gears are as far apart as on the drawing
MM2_S = 1e-6
REFERENCE = 100.0 * MM2_S * 1000.0 / 60.0  # m²/s times turns per second: 100 mm²/s at 1000 r/min
LEAST_TORQUE = 1e-9  # N m, of an idle sun


def centre_distance_growth(stage: Gearing, *, expansion: Float) -> Gearing:
    """Housing and carrier part sun and planet as they get warm; ``expansion`` is theirs less that of the gears."""
    load = load_of(stage)
    growth = expansion * centre_distance_of(stage, load.sun, load.planet) * (stage.oil_temperature - ROOM)
    return replace(stage, centre_distance_deviation=stage.centre_distance_deviation + growth)


def pin_drag(stage: Gearing, strength: Strength, *, friction: Float, film_speed: Float) -> Strength:
    """Pins that do not roll slide on the discs, and the oil carries the less of it the slower and the warmer it is.

    Their friction beyond that of ``cycloid_efficiency`` is friction exp(-nu n/(nu n)_0), nu n by the viscosity and the
    turning of the output, (nu n)_0 by 100 mm²/s and ``film_speed``, the same at all pins. The stresses keep the torque
    of the sun that was calculated without it, so the loss is meant to be small.
    """
    load, second = load_of(stage), strength.second
    product = viscosity_at(stage.oil_temperature, stage.viscosity / MM2_S) * load.duty.sun_speed / load.duty.ratio
    share = cycloid.sliding_share(second.short_width_coefficient, load.duty.pins, (second.pin_circle, second.pin_size))
    lost = friction * np.exp(-product / (100.0 * film_speed)) * share
    dragging = replace(stage, cycloid_efficiency=stage.cycloid_efficiency - lost)
    passed = mesh_efficiency(dragging, load.planet / load.sun, load.duty.pins) / load.duty.mesh_efficiency
    return replace(strength, efficiency=strength.efficiency * passed)


def speed_dependent_loss(stage: Gearing, strength: Strength, *, constant: Float, viscous: Float) -> Strength:
    """Seals, bearings and oil hold the sun back at any torque: efficiency less M_0/T_1, not below 0.

    ``viscous`` is the part of M_0 that grows with viscosity times speed to the power 2/3, at 100 mm²/s and 1000 r/min.
    T_1 is the torque that was calculated without M_0, so the loss is meant to be small beside it.
    """
    load = load_of(stage)
    product = MM2_S * viscosity_at(stage.oil_temperature, stage.viscosity / MM2_S) * load.duty.sun_speed
    held_back = constant + viscous * np.cbrt(product / REFERENCE) ** 2
    loss = held_back / np.maximum(load.duty.sun_torque, LEAST_TORQUE)
    return replace(strength, efficiency=np.maximum(strength.efficiency - loss, 0.0))


# What torque and time bring into the transmission error and the backlash: twist, play, deflection of teeth, wear


def wind_up(stage: Gearing, strength: Strength, *, compliance: Float) -> Strength:
    """The shaft of the sun twists in proportion to its torque, to the side to which it turns."""
    load = load_of(stage)
    return with_error(strength, compliance * load.duty.sun_torque * load.direction)


def lost_motion(stage: Gearing, strength: Strength, *, play: Float, torque_scale: Float) -> Strength:
    """The torque takes up the play to one side or the other; about zero torque it does so gradually.

    At ``torque_scale`` of the output 76 % (tanh 1) of half the play is taken up.
    """
    load = load_of(stage)
    torque = load.direction * load.duty.output_torque
    moved = with_error(strength, 0.5 * play * np.tanh(torque / torque_scale))
    return replace(moved, backlash=strength.backlash + play)


def wear_drift(stage: Gearing, strength: Strength, *, rate: Float, time: Float) -> Strength:
    """Every loaded flank loses a depth in proportion to the time; torque lays the teeth on one flank or the other."""
    depth = rate * time
    moved = with_error(strength, load_of(stage).direction * depth)
    return replace(moved, backlash=strength.backlash + 2.0 * depth)


def mesh_stiffening(stage: Gearing, strength: Strength, *, share: Float) -> Strength:
    """Teeth give way under their line load; below 100 N/mm they are softer, so the first newtons move them most.

    At a share of 1 by the line load with the application factor over the mesh stiffness of the rating.
    """
    load = load_of(stage)
    deflection = strength.duty.line_load / strength.stiffness.mesh_stiffness
    return with_error(strength, share * load.direction * deflection)


# They act in the order declared: first what changes the load of a tooth, then what is added to a result. A new effect
# is a function beside the others and one more entry in EFFECTS.

FACE = "face load factor of ISO 6336-1, method C, for a misalignment that grows with the load"
RESONANCE = "one degree of freedom shaken by an error of position: Den Hartog, Mechanical vibrations, ch. 2"
HARMONIC = "first harmonic of an eccentricity; kinematics of the RV reducer with its housing fixed"
STIFFNESS = "ISO 6336-1, clause 9: stiffness of a tooth pair, and its fall below a line load of 100 N/mm"
PALMGREN = (
    "Palmgren, A., Ball and roller bearing engineering, 3rd ed., Burbank 1959: torque of an idle bearing; viscosity of "
    "the oil after ASTM D341"
)
STRIBECK = (
    "pins at rest: gear geometry, cycloid disc; mixed friction that falls exponentially with the speed: Andersson, S., "
    "Söderberg, A., Björklund, S., Friction models for sliding dry, boundary and mixed lubricated contacts, Tribology "
    "International 40 (2007) 580"
)
BLOK = (
    "Blok, H., Theoretical study of temperature rise at surfaces of actual contact under oiliness lubricating "
    "conditions, Proc. General Discussion on Lubrication 2, Institution of Mechanical Engineers 1937, 222; ISO/TS "
    "6336-20"
)
ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"


EFFECTS: list[Effect[Gearing, Strength]] = [
    Effect("face_misalignment", on_inputs=face_misalignment,
           unknowns=[Unknown("misalignment", -3, 100, "um", "over the face width, beside that of the tolerances"),
                     Unknown("per_load", -3, 100, "um/kN", "what it gains with the tangential force of a mesh")],
           parts=[("misalignment",), ("per_load",)],
           looks_like="all stresses too high by a share that falls with the load; with shafts that bend, by one "
                      "share at any load, which the tolerances or a gain of the gauge may be as well",
           remedy="Align the bores of the carrier and check bearing play; shafts that bend need more stiffness. All "
                  "stresses are then lower.",
           why="sun and planet axes are not parallel: bores of the carrier, bearing play, and a shaft that bends",
           source=FACE),
    Effect("structural_resonance", on_inputs=structural_resonance,
           unknowns=[Unknown("strength", 0, 2, "", "error of the mesh times stiffness over load: gain far above it"),
                     Unknown("resonance_speed", 200, 5000, "rpm", "of the sun relative to the carrier"),
                     Unknown("damping", 0.03, 0.3, "", "damping ratio")],
           looks_like="all stresses have a peak at one speed of the input, by the same share at any load; nothing at "
                      "rest and below the peak four times as much at twice the speed",
           remedy="Keep the input away from this speed, or stiffen shaft, carrier or housing; the peak is then not "
                  "met or lies higher.",
           why="shaft, carrier or housing have a frequency of their own, which the teeth of the sun meet at that "
               "speed",
           source=RESONANCE),
    Effect("planet_load_sharing", on_inputs=planet_load_sharing,
           unknowns=[Unknown("lead", 0, 100, "um", "of one planet before the mean of all, along the line of action")],
           looks_like="all stresses too high at small loads, hardly at large ones; root stresses by nearly the same "
                      "amount at any load, like an offset",
           remedy="Assemble the planets so that all of them touch at once; the stresses at small loads are then as "
                  "calculated.",
           why="planets stand unevenly on their cranks; the first one to touch carries until its mesh has given way",
           source=STIFFNESS),
    Effect("crowned_contact", on_inputs=crowned_contact,
           unknowns=[Unknown("full_line_load", 0, 200, "N/mm", "force over width from which all of it carries")],
           looks_like="all stresses too high at small loads, and right from some load on",
           remedy="Keep the effect on in the inputs file, or grind less crown where small loads matter; the stresses "
                  "at small loads are then lower.",
           why="crowned teeth touch in the middle of their width; the contact grows with the load",
           source="Hertz, point contact of crowned flanks that spreads over the face; width as the cube root of the "
                  "force"),
    Effect("relief_error", on_inputs=relief_error,
           unknowns=[Unknown("missing", -50, 50, "um", "of the relief of the tip")],
           looks_like="root stresses off by the same amount at any load, like an offset; contact stress as calculated",
           remedy="Measure the tip relief of both gears and grind it as drawn; the root stresses are then as "
                  "calculated at every load.",
           why="the tips were ground back less than was meant, or more: the load meets the tooth higher, or lower",
           source=STIFFNESS),
    Effect("centre_distance_growth", on_inputs=centre_distance_growth,
           unknowns=[Unknown("expansion", -40, 40, "um/(m*K)",
                             "linear, of housing and carrier less that of the gears; aluminium less steel 12")],
           looks_like="the backlash grows with the temperature of the oil, back and forth, and never with the hours",
           remedy="Read the backlash at one temperature of the oil, or keep the effect on in the inputs file; "
                  "readings of warm and cold days then agree.",
           why="the parts that hold the gears apart expand more than the gears, or get warmer",
           source="linear expansion; backlash of an involute pair on its working centre distance, ISO 21771"),
    Effect("pin_drag", on_results=pin_drag,
           unknowns=[Unknown("friction", 0, 0.5, "", "of pins at rest, beyond that of cycloid_efficiency; 0.01 to 0.1"),
                     Unknown("film_speed", 0.5, 200, "rpm", "of the output at 100 mm²/s; there 1/e of it is left")],
           looks_like="efficiency too low by nearly the same amount at any torque, the more so the slower and the "
                      "warmer; if at any speed, like an offset of the gauge",
           remedy="Check that the pins turn in their grooves, and take a thicker oil for slow work; the efficiency at "
                  "low speed is then higher.",
           why="pins stick in their grooves, and the discs slide over them in mixed friction",
           source=STRIBECK),
    Effect("speed_dependent_loss", on_results=speed_dependent_loss,
           unknowns=[Unknown("constant", 0, 50, "N*m", "holding back the sun at any speed: seals, preload"),
                     Unknown("viscous", 0, 50, "N*m",
                             "holding back the sun at 100 mm²/s and 1000 r/min; as the power 2/3")],
           looks_like="efficiency falls towards small torques, and the more so the faster and the colder",
           remedy="Measure warm, and check seals, bearing preload and oil; if one was at fault, the efficiency at "
                  "small torques then rises.",
           why="seals, preloaded bearings and oil hold back an idle reducer too; catalogues print less than the "
               "formula",
           source=PALMGREN),
    Effect("flash_temperature", on_results=flash_temperature,
           unknowns=[Unknown("friction", 0, 0.5, "", "mean coefficient of the flanks; 0.03 to 0.1 in oil")],
           looks_like="flanks warmer than the oil, with the load to the power 3/4 and the root of the speed",
           remedy="If the friction exceeds that of oiled flanks, renew the oil and check the flanks; they then run "
                  "cooler. If not, keep the effect on.",
           why="flanks slide on one another at the ends of the path of contact, and friction heats them",
           source=BLOK),
    Effect("sun_runout", on_results=sun_runout, needs=[INPUT_ANGLE], acts_at_reference=True,
           unknowns=wave_unknowns(1000, "um", "the angle of the sun against the carrier"),
           looks_like="transmission error with one wave per turn of the sun against the carrier, a little slower "
                      "than the input shaft",
           remedy="Centre the sun on its axis or replace it; the wave once per turn of the sun against the carrier is "
                  "gone then.",
           why="the teeth of the sun are off the axis on which it turns",
           source=HARMONIC),
    Effect("planet_runout", on_results=planet_runout, needs=[INPUT_ANGLE], acts_at_reference=True,
           unknowns=wave_unknowns(1000, "um", "the angle of the planet"),
           looks_like="transmission error with one wave per turn of the planet, z1/z2 of those of the sun",
           remedy="Replace the planet whose teeth are off the axis of its crank; the wave once per turn of the planet "
                  "is gone then.",
           why="the teeth of a planet are off the axis of its crank",
           source=HARMONIC),
    Effect("mesh_ripple", on_results=mesh_ripple, needs=[INPUT_ANGLE], acts_at_reference=True,
           unknowns=[*wave_unknowns(1000, "um", "the passing teeth"),
                     *wave_unknowns(1000, "um", "the passing teeth, twice a tooth", "second_cosine", "second_sine")],
           parts=[("cosine", "sine"), ("second_cosine", "second_sine")],
           looks_like="a fast ripple of the transmission error: one wave, or two, for every tooth of the sun that "
                      "passes",
           remedy="Measure profile and pitch of the sun's teeth, and regrind or replace the sun; the ripple with the "
                  "passing teeth is then smaller.",
           why="one pair of teeth and two carry in turn, and flanks have errors of form",
           source="kinematics of the mesh"),
    Effect("output_eccentricity", on_results=output_eccentricity, needs=[INPUT_ANGLE], acts_at_reference=True,
           unknowns=[*wave_unknowns(1000, "um", "the angle of the output"),
                     *wave_unknowns(1000, "um", "the passing teeth of the discs", "tooth_cosine", "tooth_sine")],
           parts=[("cosine", "sine"), ("tooth_cosine", "tooth_sine")],
           looks_like="a slow wave of the transmission error over one turn of the output, or one for every tooth of "
                      "the discs",
           remedy="Centre carrier and encoder of the output; a wave with the teeth of the discs asks for better "
                  "discs. The wave is then gone or smaller.",
           why="carrier or encoder of the output are off their axis; errors of the second stage come through to the "
               "first",
           source=HARMONIC),
    Effect("ratio_drift", on_results=ratio_drift, needs=[INPUT_ANGLE],
           unknowns=[Unknown("miscount", -1e-3, 1e-3, "", "of the ratio, relative")],
           looks_like="transmission error in proportion to the angle that was turned, and it never comes back",
           remedy="Evaluate with the exact ratio of the teeth, and check the encoders for lost counts; the error then "
                  "no longer adds up.",
           why="the ratio in the evaluation is rounded, or an encoder loses counts: an error of counting alone",
           source="kinematics: relative error of the ratio times angle and base radius of the sun"),
    Effect("wind_up", on_results=wind_up,
           unknowns=[Unknown("compliance", 0, 100, "um/(N*m)", "at the base circle of the sun, by its torque")],
           looks_like="transmission error in proportion to the torque, with its sign",
           remedy="Put the encoder at the sun, or take the twist off in proportion to the torque; the error then no "
                  "longer follows the torque.",
           why="the shaft between the encoder and the sun twists",
           source="Hooke's law"),
    Effect("lost_motion", on_results=lost_motion,
           unknowns=[Unknown("play", 0, 1000, "um", "along the line of action, from flank to flank"),
                     Unknown("torque_scale", 1, 500, "N*m", "at the output; at it 76 % of the play is taken up")],
           looks_like="transmission error jumps where the torque changes its sign, and stays; so much more backlash",
           remedy="Find the play in teeth, splines and bearings, and replace or preload what is loose; the jump about "
                  "no torque is then smaller.",
           why="teeth, splines and bearings have play, which the torque takes up to one side or the other",
           source="lost motion of catalogues; hyperbolic tangent for the rounded jump"),
    Effect("wear_drift", on_results=wear_drift, needs=[TIME],
           unknowns=[Unknown("rate", 0, 50, "nm/h", "that each loaded flank loses")],
           looks_like="transmission error drifts with the hours, to the side of the torque; the backlash grows twice "
                      "as fast",
           remedy="Look for micropitting, renew the oil, and replace worn gears; error and backlash are then those of "
                  "a new reducer.",
           why="flanks wear, or peel by micropitting",
           source=ARCHARD),
    Effect("mesh_stiffening", on_results=mesh_stiffening,
           unknowns=[Unknown("share", 0, 10, "", "of the calculated deflection of the teeth")],
           looks_like="transmission error grows with the torque, with its sign, faster about zero than farther out",
           remedy="Keep the effect on in the inputs file; the transmission error then fits at any torque, near zero "
                  "too.",
           why="teeth give way, and the more so while they hardly touch",
           source=STIFFNESS),
]  # fmt: skip
