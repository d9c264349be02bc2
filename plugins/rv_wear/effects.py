"""What the paper leaves out of the wear and the backlash of a reducer, or of their measurement."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_geometry.mesh_load import wave as harmonic
from rv_wear.play import pin_circle_offset, stops_of, toothing_offset
from rv_wear.quantities import Reducer, Wear
from truing import Condition, Effect, Float, Unknown

# What else must be measured before the effects of the reducer can act: each condition once, shared by its effects
#
# Working hours are an input of the reducer and belong to its set of discs; the clock of the bench is the ``time`` of
# the kernel's own effects.

HOUSING_TEMPERATURE = Condition("housing_temperature", "degC", reference=20, low=15, high=60, role="follows",
                                note="of the housing with its pins, when measured")  # fmt: skip
DISC_TEMPERATURE = Condition("disc_temperature", "degC", reference=20, low=15, high=60, role="follows",
                             note="of the cycloid discs, when measured")  # fmt: skip
OIL_TEMPERATURE = Condition("oil_temperature", "degC", reference=40, low=20, high=80, role="follows",
                            note="of the lubricant at work, mean since new")  # fmt: skip
OUTPUT_ANGLE = Condition("output_angle", "deg", reference=0, low=0, high=360,
                         note="of the output, at which the backlash is read")  # fmt: skip
CRANK_ANGLE = Condition(
    "crank_angle", "deg", reference=0, low=0, high=360,
    note="of the throw of the crank against the housing, at which the backlash is read",
)  # fmt: skip
MEASURING_TORQUE = Condition(
    "measuring_torque", "N*m", reference=0, low=0, high=1000,
    note="at the output, to one side and the other while the backlash is read; its amplitude",
)  # fmt: skip
DIRECTION = Condition(
    "direction", "", reference=0, low=-1, high=1,
    note="way in which the output was brought to where the backlash is read: +1 in the sense of the output angle, -1 "
    "against it",
)  # fmt: skip


# What changes the clearance between disc, pins and bearings, and no flank: heat, runout, wear of the bearings

OffsetArray = NDArray[np.complex128]
"""Offsets x + iy (n,) or () in m."""

RATED_TORQUE = 3136.0  # N*m, of the paper
MILLION = 1e6


def thermal_clearance(
    reducer: Reducer, *, expansion: Float, housing_temperature: Float, disc_temperature: Float
) -> Reducer:
    """Pins and their circle grow with the housing, the whole profile with the disc: only their difference is felt.

    A disc that is larger by a share is ground on a circle and with pins that are both larger by that share.
    """
    strain = expansion * (housing_temperature - disc_temperature)
    return replace(
        reducer,
        pin_circle_error=reducer.pin_circle_error + strain * reducer.pin_circle_radius,
        pin_radius_error=reducer.pin_radius_error + strain * reducer.pin_radius,
    )


def runout(reducer: Reducer, *, offset: Float, direction: Float, crank_angle: Float) -> Reducer:
    """The circle of the pins is off the axis of the output: of two opposite discs each stops one end of the play."""
    stands = pin_circle_offset(reducer)
    moved = stands + offset * np.exp(1j * direction)
    off = replace(reducer, pin_circle_x=moved.real, pin_circle_y=moved.imag)
    return _taken(reducer, off, crank_angle, stands, moved)


def disc_phase(reducer: Reducer, *, phase: Float, crank_angle: Float) -> Reducer:
    """The crank of the second disc is not half a turn ahead: one disc stops each end of the play before the other."""
    off = replace(reducer, disc_phase_error=reducer.disc_phase_error + phase)
    pins = pin_circle_offset(reducer)
    return _taken(reducer, off, crank_angle, pins, pins)


def toothing_runout(
    reducer: Reducer, *, offset: Float, direction: Float, crank_angle: Float, output_angle: Float
) -> Reducer:
    """The toothing of the discs is off the bores that hold them, alike in both: as pins off centre that turn along."""
    stands = toothing_offset(reducer)
    moved = stands + offset * np.exp(1j * direction)
    off = replace(reducer, toothing_x=moved.real, toothing_y=moved.imag)
    pins, turned = pin_circle_offset(reducer), np.exp(1j * output_angle)
    return _taken(reducer, off, crank_angle, pins - stands * turned, pins - moved * turned)


def _taken(reducer: Reducer, off: Reducer, crank: Float, before: OffsetArray, after: OffsetArray) -> Reducer:
    """What parts off centre take from the play at this crank angle, as a gap; equation R2 of the theory page."""
    stops = stops_of(reducer, crank)
    fair, left = (
        stops.play(offset, reducer.eccentricity * each.disc_phase_error)
        for each, offset in ((reducer, before), (off, after))
    )
    gap = reducer.eccentricity * (reducer.pin_count - 1) * (fair - left)
    return replace(off, runout_gap=reducer.runout_gap + (gap if np.ndim(crank) or len(gap) > 1 else gap[0]))


def bearing_wear(reducer: Reducer, *, wear: Float) -> Reducer:
    """The crank bearings gain clearance in proportion to their load and to the turns made, as Archard has it."""
    load = reducer.output_torque / RATED_TORQUE
    turns = reducer.output_speed * reducer.working_time
    return replace(reducer, bearing_clearance=reducer.bearing_clearance + wear * load * turns / MILLION)


# What is in the reading of the backlash and not in the play of the parts: torque, friction and where it is read


def pin_pass_ripple(
    reducer: Reducer,
    wear: Wear,
    *,
    disc_cosine: Float,
    disc_sine: Float,
    pin_cosine: Float,
    pin_sine: Float,
    output_angle: Float,
) -> Wear:
    """Every tooth of the disc, or every pin, passes once per turn of the output and leaves its own play."""
    teeth, pins = (reducer.pin_count - 1) * output_angle, reducer.pin_count * output_angle
    of_disc, of_pins = harmonic(teeth, disc_cosine, disc_sine), harmonic(pins, pin_cosine, pin_sine)
    return replace(wear, backlash=wear.backlash + of_disc + of_pins)


def wind_up(reducer: Reducer, wear: Wear, *, compliance: Float, measuring_torque: Float) -> Wear:
    """The torque that turns the output to either side twists it, both ways, in proportion."""
    return replace(wear, backlash=wear.backlash + 2.0 * compliance * np.abs(measuring_torque))


def stiffening(reducer: Reducer, wear: Wear, *, twist: Float, torque_scale: Float, measuring_torque: Float) -> Wear:
    """Contacts that close under the measuring torque twist the output until all of them carry; no linear term."""
    return replace(wear, backlash=wear.backlash - twist * np.expm1(-np.abs(measuring_torque) / torque_scale))


def friction_hysteresis(reducer: Reducer, wear: Wear, *, lag: Float, direction: Float) -> Wear:
    """Friction holds the output back from where it would come to rest, to the side from which it came."""
    return replace(wear, backlash=wear.backlash + lag * direction)


# What changes the wear of the disc, and what of it is felt as backlash

VISCOSITY_EXPONENT = 7.377  # of the pressure-viscosity coefficient in the regression of the wear coefficient
THINNING = 0.0411  # 1/K, oil ISO VG 220 of viscosity index 95: 220 mm²/s at 40 degC, 18.7 mm²/s at 100 degC


def running_in(reducer: Reducer, *, depth: Float, run_in_time: Float) -> Reducer:
    """Fresh asperities go first: a depth beside the law of wear, complete after a few times the run-in time."""
    lost = -depth * np.expm1(-reducer.working_time / run_in_time)
    return replace(reducer, extra_wear=reducer.extra_wear + lost)


def wear_temperature(reducer: Reducer, *, softening: Float, oil_temperature: Float) -> Reducer:
    """Warm oil stiffens less under pressure, by ``softening`` per kelvin: the wear coefficient grows by its power."""
    faster = np.exp(VISCOSITY_EXPONENT * softening * (oil_temperature - OIL_TEMPERATURE.zero))
    return replace(reducer, wear_rate_factor=reducer.wear_rate_factor * faster)


def film_lubrication(reducer: Reducer, *, film_factor: Float, oil_temperature: Float) -> Reducer:
    """A film parts disc and pins wherever it is thick against the roughness; the oil thins out with its temperature."""
    thinner = np.exp(-THINNING * (oil_temperature - OIL_TEMPERATURE.zero))
    return replace(
        reducer, film_factor=reducer.film_factor + film_factor, oil_viscosity=reducer.oil_viscosity * thinner
    )


def pin_rolling(reducer: Reducer, *, rolling: Float) -> Reducer:
    """The pins turn in their grooves and take over this share of the sliding."""
    return replace(reducer, sliding_factor=reducer.sliding_factor * (1.0 - rolling))


def pin_wear(reducer: Reducer, *, ratio: Float) -> Reducer:
    """The pins wear too, ``ratio`` times as deep as the disc, and the backlash feels both."""
    return replace(reducer, pin_wear_ratio=reducer.pin_wear_ratio + ratio)


def lost_motion_share(reducer: Reducer, *, loss: Float) -> Reducer:
    """The backlash does not feel the deepest wear but what is left of it where disc and pins first touch."""
    return replace(reducer, lost_motion_share=reducer.lost_motion_share * (1.0 - loss))


def lubricant_ageing(reducer: Reducer, *, rate: Float) -> Reducer:
    """Additives are used up and debris gathers: the momentary wear coefficient grows evenly with the working time."""
    return replace(reducer, ageing_rate=reducer.ageing_rate + rate)


def load_exponent(reducer: Reducer, *, exponent: Float) -> Reducer:
    """The wear depth follows another power of the load than calculated; at the rated torque nothing changes."""
    return replace(reducer, depth_factor=reducer.depth_factor * (reducer.output_torque / RATED_TORQUE) ** exponent)


def duty_share(reducer: Reducer, *, idle: Float) -> Reducer:
    """Either flank is idle for this share of the working time: 0.5 where both share it evenly."""
    return replace(reducer, loaded_share=reducer.loaded_share * (1.0 - idle))


# They act in the order declared: first what changes the clearance (toothing_runout after runout and disc_phase, as it
# alone knows where the output stands), then what changes the wear and what is felt of it, then what is in the reading
# alone. A new effect is a function beside the others and one more entry in EFFECTS.

REGRESSION = (
    "Janakiraman, V., Li, S., Kahraman, A., An investigation of the impacts of contact parameters on wear coefficient, "
    "Journal of Tribology 136 (2014) 031602"
)
ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"
DOWSON = "Dowson, D., Higginson, G. R., Elasto-hydrodynamic lubrication, Pergamon 1966: film of a line contact"
KINEMATICS = "kinematics of the cycloid drive"

EFFECTS: list[Effect[Reducer, Wear]] = [
    Effect("thermal_clearance", on_inputs=thermal_clearance, needs=[HOUSING_TEMPERATURE, DISC_TEMPERATURE],
           unknowns=[Unknown("expansion", -40, 40, "um/(m*K)", "linear, of housing and disc alike; steel 11.5")],
           looks_like="the backlash follows the difference of both temperatures, back and forth, and never the hours",
           remedy="Read the backlash when housing and discs are equally warm, or take the heat off by both "
                  "temperatures; it then follows the hours alone.",
           why="the discs turn in warm oil and the housing stands in cold air: the clearance between them closes",
           source="linear expansion; steel 11.5 um/(m*K), 0.063 arcmin per kelvin of difference"),
    Effect("runout", on_inputs=runout, needs=[CRANK_ANGLE], acts_at_reference=True,
           unknowns=[Unknown("offset", 0, 10, "um", "of the circle of the pins from the axis of the output"),
                     Unknown("direction", 180, 360, "deg",
                             "of the offset, as a crank angle; half a turn more is the same")],
           looks_like="the backlash dips twice per turn of the crank, by 0.08 arcmin per micrometre, where the throw "
                      "stands across the offset; the mean of both ends of the play stays",
           remedy="Centre the pins, or the bore that holds them, on the axis of the output; the two dips per turn of "
                  "the crank are gone then.",
           why="the circle of the pins, or the bore of the housing that holds it, is off the axis of the output; two "
               "opposite discs then touch at opposite ends of the play",
           source="geometry of two opposite cycloid discs, derived on the theory page of the calculation"),
    Effect("disc_phase", on_inputs=disc_phase, needs=[CRANK_ANGLE], acts_at_reference=True,
           unknowns=[Unknown("phase", -60, 60, "arcmin", "of the second crank, beyond half a turn")],
           looks_like="alone a constant, like an offset of the gauge; beside runout the two dips per turn of the crank "
                      "become unlike",
           remedy="Measure the angle between the throws of the crankshafts, and replace shafts that are off.",
           why="both throws of a crankshaft are ground one after the other",
           source="geometry of two opposite cycloid discs, derived on the theory page of the calculation"),
    Effect("toothing_runout", on_inputs=toothing_runout, needs=[CRANK_ANGLE, OUTPUT_ANGLE], acts_at_reference=True,
           unknowns=[Unknown("offset", -10, 10, "um",
                             "of the toothing from the bores, mean of both discs; alone either sign looks the same"),
                     Unknown("direction", 180, 360, "deg", "of the offset, as an output angle")],
           looks_like="the backlash dips twice per turn of the crank against the disc, so the dips move with the "
                      "output angle; within one turn of the crank it looks like runout",
           remedy="Grind the toothing true to the bores for the crank bearings, or measure both discs and mount them "
                  "with their offsets opposite.",
           why="the toothing of the discs is off the bores that hold them, and both discs come from one setting",
           source="geometry of two opposite cycloid discs, derived on the theory page of the calculation"),
    Effect("bearing_wear", on_inputs=bearing_wear,
           unknowns=[Unknown("wear", 0, 10, "um",
                             "clearance that the crank bearings gain per million output turns at 3136 N*m")],
           looks_like="the backlash grows evenly with torque, speed and hours; the flanks wear no deeper",
           remedy="Open the reducer, measure the crank bearings and replace worn ones; the backlash is then less by "
                  "the clearance they had gained.",
           why="the crank bearings carry the mesh forces; their raceways wear at a steady rate once they have run in",
           source=ARCHARD),
    Effect("running_in", on_inputs=running_in,
           unknowns=[Unknown("depth", 0, 5, "um", "lost beside the law of wear when all is run in"),
                     Unknown("run_in_time", 50, 2000, "h", "after it 63 % of that depth is lost")],
           looks_like="wear and backlash gain early and soon no more; then they run parallel to the calculation",
           remedy="Run new discs in before the record begins, or keep the effect on; from then on wear and backlash "
                  "go as calculated.",
           why="a ground flank loses its asperities first, faster than a smooth one wears",
           source="two phases of wear; lost motion of reducers on endurance tests grows fastest in the first 600 h"),
    Effect("wear_temperature", on_inputs=wear_temperature, needs=[OIL_TEMPERATURE],
           unknowns=[Unknown("softening", 0, 0.02, "1/K",
                             "decrease of the pressure-viscosity coefficient; oils 0.004 to 0.008")],
           looks_like="warm reducers wear faster: the slope over the hours follows the oil, not the reading of the "
                      "day",
           remedy="Keep the oil cooler, or keep the effect on in the inputs file; a reducer with cooler oil then "
                  "wears more slowly.",
           why="the wear coefficient falls with the seventh power of the pressure-viscosity coefficient, which falls "
               "with temperature",
           source=REGRESSION),
    Effect("film_lubrication", on_inputs=film_lubrication, needs=[OIL_TEMPERATURE], acts_at_reference=True,
           unknowns=[Unknown("film_factor", 0, 150, "",
                             "film thickness over that of the formula; below about 3 no film is felt")],
           looks_like="less wear at high speed and in cold oil; the flank wears on where disc and pin move against "
                      "one another, so with pins that stand still the deepest wear never vanishes",
           remedy="Keep the effect on in the inputs file, and measure the wear at low speed or in hot oil too; there "
                  "it is as calculated without a film.",
           why="a film that is thicker than the roughness keeps the surfaces apart",
           source=DOWSON),
    Effect("pin_rolling", on_inputs=pin_rolling,
           unknowns=[Unknown("rolling", 0, 1, "", "share of the sliding that the pins take over")],
           looks_like="all wear is slower by one share, that of the flank and what is felt of it",
           remedy="Rule duty_share out by the log of the load, mark the pins and see whether they turn. If so, "
                  "nothing is broken: the disc wears as the extended model says.",
           why="pins that lie in half-round grooves turn when their friction there is smaller than on the flank",
           source=KINEMATICS),
    Effect("pin_wear", on_inputs=pin_wear,
           unknowns=[Unknown("ratio", 0, 2, "", "wear of the pins over that of the disc")],
           looks_like="the backlash gains more than the wear of the disc explains, by one share of it",
           remedy="Open the reducer, measure the pins and replace worn ones; the backlash then fits the wear of the "
                  "disc.",
           why="pins are as hard as the disc and each meets its teeth at the same places",
           source=ARCHARD),
    Effect("lost_motion_share", on_inputs=lost_motion_share,
           unknowns=[Unknown("loss", 0, 0.95, "", "share of the deepest wear that is not felt")],
           looks_like="the backlash gains less than the wear of the disc explains, by one share of it",
           remedy="Keep the effect on in the inputs file, and measure the wear of a flank as well; its depth is as "
                  "calculated.",
           why="the play ends where the first pin touches, and that is not where the flank is worn most",
           source="take-up of a mesh: the smallest clearance over its lever arm, of all pins"),
    Effect("lubricant_ageing", on_inputs=lubricant_ageing,
           unknowns=[Unknown("rate", 0, 5, "1e-3/h", "growth of the momentary wear coefficient, over that when new")],
           looks_like="wear that does not slow down with the hours, or even hastens",
           remedy="Renew the lubricant and flush the debris out; the wear per hour is then again that of fresh "
                  "lubricant.",
           why="additives are used up, and debris stays in the grease",
           source="linear growth of the wear coefficient with the age of the lubricant"),
    Effect("load_exponent", on_inputs=load_exponent,
           unknowns=[Unknown("exponent", -1, 1, "", "added to the power of the torque that the depth follows")],
           looks_like="right at the rated torque, too much below and too little above it, or the other way round",
           remedy="Keep the effect on in the inputs file, and test at one more torque; the wear there is then as "
                  "calculated.",
           why="the regression of the wear coefficient was fitted to other contacts than these",
           source=REGRESSION),
    Effect("duty_share", on_inputs=duty_share,
           unknowns=[Unknown("idle", 0, 1, "",
                             "share of the working time in which a flank is not loaded: 0.5 where both share it "
                                  "evenly")],
           looks_like="wear and backlash gain less, as if the reducer had worked fewer hours, like less sliding; the "
                      "log of the load tells: state it as the input reversing, and the question is answered",
           remedy="State how both flanks share the hours, by the log of the load, as reversing; wear and backlash "
                  "then fit without the effect.",
           why="robots turn to and fro: what one flank wears the other does not",
           source="wear of both flanks, each after its own time"),
    Effect("pin_pass_ripple", on_results=pin_pass_ripple, needs=[OUTPUT_ANGLE], acts_at_reference=True,
           unknowns=[Unknown("disc_cosine", -1, 1, "arcmin", "part of the wave with the teeth of the disc"),
                     Unknown("disc_sine", -1, 1, "arcmin", "part of the wave with the teeth of the disc"),
                     Unknown("pin_cosine", -1, 1, "arcmin", "part of the wave with the pins"),
                     Unknown("pin_sine", -1, 1, "arcmin", "part of the wave with the pins")],
           parts=[("disc_cosine", "disc_sine"), ("pin_cosine", "pin_sine")],
           looks_like="a fast ripple over the output angle: as many waves per turn as the disc has teeth, or as "
                      "there are pins",
           remedy="Average the backlash over whole waves of the output angle, and replace discs or pins with large "
                  "errors; the ripple is then smaller.",
           why="teeth and pins have their own errors, and each of them passes once",
           source=KINEMATICS),
    Effect("wind_up", on_reading=wind_up, needs=[MEASURING_TORQUE],
           unknowns=[Unknown("compliance", 0, 20, "arcmin/(kN*m)", "of the reducer; catalogues 0.5 to 5")],
           looks_like="the reading grows in proportion to the measuring torque",
           remedy="Read the backlash under less torque, or take off twice the torque over the stiffness; readings "
                  "under any torque then agree.",
           why="a backlash that is read under torque contains the twist to either side",
           source="Hooke's law: twice the torque over the stiffness"),
    Effect("stiffening", on_reading=stiffening, needs=[MEASURING_TORQUE],
           unknowns=[Unknown("twist", 0, 2, "arcmin", "until all contacts carry"),
                     Unknown("torque_scale", 10, 1000, "N*m", "measuring torque after which 63 % of it is there")],
           looks_like="the reading grows with a small measuring torque and hardly any more with a large one",
           remedy="Read the backlash always under the same measuring torque, and keep the effect on in the inputs "
                  "file; the readings then agree.",
           why="pins, teeth and rollers come to bear one after another: a reducer is soft about its middle",
           source="lost motion and stiffness of catalogues: a torsion curve that is steep about zero"),
    Effect("friction_hysteresis", on_reading=friction_hysteresis, needs=[DIRECTION],
           unknowns=[Unknown("lag", -1, 1, "arcmin", "added in the sense of the output angle, taken off against it")],
           looks_like="two readings of one backlash, by the way in which the output was brought there",
           remedy="Bring the output to its place from both sides and take the mean; the way then no longer matters.",
           why="friction in the mesh and the seals keeps the output from coming to rest in the middle",
           source="friction torque over stiffness, with the sign of the motion"),
]  # fmt: skip
