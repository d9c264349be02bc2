"""What the paper leaves out of the wear and the backlash of a reducer, or of their measurement.

They act in the order declared: first what changes the clearance, then what changes the wear and what is felt of it,
then what is in the reading alone. A new effect is a function beside the others and one more entry in EFFECTS.
"""

from rv_wear.answers import Wear
from rv_wear.conditions import (
    CRANK_ANGLE,
    DIRECTION,
    DISC_TEMPERATURE,
    HOUSING_TEMPERATURE,
    MEASURING_TORQUE,
    OIL_TEMPERATURE,
    OUTPUT_ANGLE,
)
from rv_wear.effects_of_clearance import bearing_wear, runout, thermal_clearance
from rv_wear.effects_of_gauge import friction_hysteresis, pin_pass_ripple, stiffening, wind_up
from rv_wear.effects_of_wear import (
    duty_share,
    film_lubrication,
    load_exponent,
    lost_motion_share,
    lubricant_ageing,
    pin_rolling,
    pin_wear,
    running_in,
    wear_temperature,
)
from rv_wear.quantities import Reducer
from truing import Effect, Unknown

REGRESSION = (
    "Janakiraman, V., Li, S., Kahraman, A., An investigation of the impacts of contact parameters on wear coefficient, "
    "Journal of Tribology 136 (2014) 031602"
)
ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"
DOWSON = "Dowson, D., Higginson, G. R., Elasto-hydrodynamic lubrication, Pergamon 1966: film of a line contact"
KINEMATICS = "kinematics of the cycloid drive"

CLEARANCE: list[Effect[Reducer, Wear]] = [
    Effect(
        "thermal_clearance",
        on_inputs=thermal_clearance,
        needs=[HOUSING_TEMPERATURE, DISC_TEMPERATURE],
        unknowns=[Unknown("expansion", -40, 40, "um/(m*K)", note="linear, of housing and disc alike; steel 11.5")],
        looks_like="the backlash follows the difference of both temperatures, back and forth, and never the hours",
        why="the discs turn in warm oil and the housing stands in cold air: the clearance between them closes",
        source="linear expansion; steel 11.5 um/(m*K), 0.063 arcmin per kelvin of difference",
    ),
    Effect(
        "runout",
        on_inputs=runout,
        needs=[CRANK_ANGLE],
        acts_at_reference=True,
        unknowns=[
            Unknown("offset", 0, 10, "um", note="of the circle of the pins from the axis of the output"),
            Unknown("direction", 180, 360, "deg", note="of the offset, as a crank angle; half a turn more is the same"),
        ],
        looks_like="the backlash dips twice per turn of the crank, by 0.08 arcmin per micrometre, where the throw "
        "stands across the offset; the mean of both ends of the play stays",
        why="the circle of the pins, or the bore of the housing that holds it, is off the axis of the output; two "
        "opposite discs then touch at opposite ends of the play",
        source="geometry of two opposite cycloid discs, derived on the theory page of the calculation",
    ),
    Effect(
        "bearing_wear",
        on_inputs=bearing_wear,
        unknowns=[
            Unknown(
                "wear",
                0,
                10,
                "um",
                note="clearance that the crank bearings gain per million output turns at 3136 N*m",
            )
        ],
        looks_like="the backlash grows evenly with torque, speed and hours; the flanks wear no deeper",
        why="the crank bearings carry the mesh forces; their raceways wear at a steady rate once they have run in",
        source=ARCHARD,
    ),
]
WEAR: list[Effect[Reducer, Wear]] = [
    Effect(
        "running_in",
        on_inputs=running_in,
        unknowns=[
            Unknown("depth", 0, 5, "um", note="lost beside the law of wear when all is run in"),
            Unknown("run_in_time", 50, 2000, "h", note="after it 63 % of that depth is lost"),
        ],
        looks_like="wear and backlash gain early and soon no more; then they run parallel to the calculation",
        why="a ground flank loses its asperities first, faster than a smooth one wears",
        source="two phases of wear; lost motion of reducers on endurance tests grows fastest in the first 600 h",
    ),
    Effect(
        "wear_temperature",
        on_inputs=wear_temperature,
        needs=[OIL_TEMPERATURE],
        unknowns=[
            Unknown(
                "softening", 0, 0.02, "1/K", note="decrease of the pressure-viscosity coefficient; oils 0.004 to 0.008"
            )
        ],
        looks_like="warm reducers wear faster: the slope over the hours follows the oil, not the reading of the day",
        why="the wear coefficient falls with the seventh power of the pressure-viscosity coefficient, which falls "
        "with temperature",
        source=REGRESSION,
    ),
    Effect(
        "film_lubrication",
        on_inputs=film_lubrication,
        needs=[OIL_TEMPERATURE],
        acts_at_reference=True,
        unknowns=[
            Unknown(
                "film_factor", 0, 150, "", note="film thickness over that of the formula; below about 3 no film is felt"
            )
        ],
        looks_like="less wear at high speed and in cold oil; the flank wears on where disc and pin move against one "
        "another, so with pins that stand still the deepest wear never vanishes",
        why="a film that is thicker than the roughness keeps the surfaces apart",
        source=DOWSON,
    ),
    Effect(
        "pin_rolling",
        on_inputs=pin_rolling,
        unknowns=[Unknown("rolling", 0, 1, "", note="share of the sliding that the pins take over")],
        looks_like="all wear is slower by one share, that of the flank and what is felt of it",
        why="pins that lie in half-round grooves turn when their friction there is smaller than on the flank",
        source=KINEMATICS,
    ),
    Effect(
        "pin_wear",
        on_inputs=pin_wear,
        unknowns=[Unknown("ratio", 0, 2, "", note="wear of the pins over that of the disc")],
        looks_like="the backlash gains more than the wear of the disc explains, by one share of it",
        why="pins are as hard as the disc and each meets its teeth at the same places",
        source=ARCHARD,
    ),
    Effect(
        "lost_motion_share",
        on_inputs=lost_motion_share,
        unknowns=[Unknown("loss", 0, 0.95, "", note="share of the deepest wear that is not felt")],
        looks_like="the backlash gains less than the wear of the disc explains, by one share of it",
        why="the play ends where the first pin touches, and that is not where the flank is worn most",
        source="take-up of a mesh: the smallest clearance over its lever arm, of all pins",
    ),
    Effect(
        "lubricant_ageing",
        on_inputs=lubricant_ageing,
        unknowns=[Unknown("rate", 0, 5, "1e-3/h", note="growth of the momentary wear coefficient, over that when new")],
        looks_like="wear that does not slow down with the hours, or even hastens",
        why="additives are used up, and debris stays in the grease",
        source="linear growth of the wear coefficient with the age of the lubricant",
    ),
    Effect(
        "load_exponent",
        on_inputs=load_exponent,
        unknowns=[Unknown("exponent", -1, 1, "", note="added to the power of the torque that the depth follows")],
        looks_like="right at the rated torque, too much below and too little above it, or the other way round",
        why="the regression of the wear coefficient was fitted to other contacts than these",
        source=REGRESSION,
    ),
    Effect(
        "duty_share",
        on_inputs=duty_share,
        unknowns=[
            Unknown(
                "idle",
                0,
                1,
                "",
                note="share of the working time in which a flank is not loaded: 0.5 where both share it evenly",
            )
        ],
        looks_like="wear and backlash gain less, as if the reducer had worked fewer hours, like less sliding; the log "
        "of the load tells: state it as the input reversing, and the question is answered",
        why="robots turn to and fro: what one flank wears the other does not",
        source="wear of both flanks, each after its own time",
    ),
]
READING: list[Effect[Reducer, Wear]] = [
    Effect(
        "pin_pass_ripple",
        on_results=pin_pass_ripple,
        needs=[OUTPUT_ANGLE],
        acts_at_reference=True,
        unknowns=[
            Unknown("disc_cosine", -1, 1, "arcmin", note="part of the wave with the teeth of the disc"),
            Unknown("disc_sine", -1, 1, "arcmin", note="part of the wave with the teeth of the disc"),
            Unknown("pin_cosine", -1, 1, "arcmin", note="part of the wave with the pins"),
            Unknown("pin_sine", -1, 1, "arcmin", note="part of the wave with the pins"),
        ],
        parts=[("disc_cosine", "disc_sine"), ("pin_cosine", "pin_sine")],
        looks_like="a fast ripple over the output angle: as many waves per turn as the disc has teeth, or as there are "
        "pins",
        why="teeth and pins have their own errors, and each of them passes once",
        source=KINEMATICS,
    ),
    Effect(
        "wind_up",
        on_reading=wind_up,
        needs=[MEASURING_TORQUE],
        unknowns=[Unknown("compliance", 0, 20, "arcmin/(kN*m)", note="of the reducer; catalogues 0.5 to 5")],
        looks_like="the reading grows in proportion to the measuring torque",
        why="a backlash that is read under torque contains the twist to either side",
        source="Hooke's law: twice the torque over the stiffness",
    ),
    Effect(
        "stiffening",
        on_reading=stiffening,
        needs=[MEASURING_TORQUE],
        unknowns=[
            Unknown("twist", 0, 2, "arcmin", note="until all contacts carry"),
            Unknown("torque_scale", 10, 1000, "N*m", note="measuring torque after which 63 % of it is there"),
        ],
        looks_like="the reading grows with a small measuring torque and hardly any more with a large one",
        why="pins, teeth and rollers come to bear one after another: a reducer is soft about its middle",
        source="lost motion and stiffness of catalogues: a torsion curve that is steep about zero",
    ),
    Effect(
        "friction_hysteresis",
        on_reading=friction_hysteresis,
        needs=[DIRECTION],
        unknowns=[Unknown("lag", -1, 1, "arcmin", note="added in the sense of the output angle, taken off against it")],
        looks_like="two readings of one backlash, by the way in which the output was brought there",
        why="friction in the mesh and the seals keeps the output from coming to rest in the middle",
        source="friction torque over stiffness, with the sign of the motion",
    ),
]
EFFECTS: list[Effect[Reducer, Wear]] = [*CLEARANCE, *WEAR, *READING]

__all__ = ["EFFECTS"]
