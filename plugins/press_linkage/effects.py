"""What the mechanism of the paper leaves out, each acting on the deviations of the press.

They act in the order declared: heat, then errors of the crank angle, then load, so that the load meets the position in
which the press really is. A new effect is a function beside the others and one more entry in EFFECTS.
"""

from dataclasses import replace

from press_linkage.conditions import DIRECTION, FORMING_FORCE, LINK_TEMPERATURE, SPEED, STROKES, TIME
from press_linkage.effects_of_crank import crank_phase, drive_backlash, encoder_eccentricity
from press_linkage.effects_of_heat import link_heating, side_heating, warm_up
from press_linkage.effects_of_load import elastic_deflection, joint_clearance, joint_wear, slider_inertia
from press_linkage.quantities import Press, Slider
from truing import Effect, Float, Unknown

EXPANSION = "linear expansion; steel 11.5 um/(m*K)"


def die_inclination(press: Press, slider: Slider, *, inclination: Float, height: Float) -> Slider:
    """The die, against which the slider is measured, is inclined and packed: constant on tilt and position."""
    return replace(
        slider, slider_tilt=slider.slider_tilt + inclination, slider_position=slider.slider_position + height
    )


HEAT: list[Effect[Press, Slider]] = [
    Effect(
        "link_heating",
        on_inputs=link_heating,
        needs=[LINK_TEMPERATURE],
        unknowns=[
            Unknown(
                "expansion", -20, 20, "um/(m*K)", note="of the links, less that of the frame and the gauge's support"
            )
        ],
        looks_like="the slider sinks with the temperature of the links, nearly alike at every crank angle; no tilt",
        why="friction heats the joints and links of a press at work; its frame stays colder",
        source=EXPANSION,
    ),
    Effect(
        "warm_up",
        on_inputs=warm_up,
        needs=[TIME],
        unknowns=[
            Unknown("rise", -1000, 1000, "um/m", note="strain of the links when warm, counted from the first row"),
            Unknown("time_constant", 0.1, 20, "h", note="after it 63 % of the strain is there"),
        ],
        looks_like="the slider sinks fast at first, then ever more slowly, with time and not with strokes; no tilt",
        why="a press that starts cold heats its links until loss and gain of heat are in balance",
        source="linear expansion of a body that heats up at a rate in proportion to what is left (Newton's law of "
        "cooling)",
    ),
    Effect(
        "side_heating",
        on_inputs=side_heating,
        needs=[LINK_TEMPERATURE],
        unknowns=[
            Unknown("expansion_1", -20, 20, "um/(m*K)", note="of the links of side 1, and half of the platform arm"),
            Unknown("expansion_2", -20, 20, "um/(m*K)", note="of the links of side 2, and half of the platform arm"),
        ],
        looks_like="the slider sinks and tilts with the temperature of the links, lower on the warmer side",
        why="one side is oiled less, stands in the sun or beside a furnace: its links are warmer than was measured",
        source=EXPANSION,
    ),
]
CRANK: list[Effect[Press, Slider]] = [
    Effect(
        "crank_phase",
        on_inputs=crank_phase,
        unknowns=[Unknown("phase", -20, 20, "mrad", note="both cranks ahead of the angle that is shown")],
        looks_like="the slider is too low before the bottom dead centre and too high after it, by its speed per angle; "
        "next to nothing at the dead centre; no tilt",
        why="the zero of the encoder was set beside the dead centre, or a coupling has slipped",
        source="kinematics of the linkage",
    ),
    Effect(
        "encoder_eccentricity",
        on_inputs=encoder_eccentricity,
        unknowns=[
            Unknown("sine", -10, 10, "mrad", note="cranks ahead in proportion to the sine of the crank angle"),
            Unknown("cosine", -10, 10, "mrad", note="cranks ahead in proportion to the cosine of the crank angle"),
        ],
        looks_like="like an error of the crank phase that changes once per turn, alike in both directions; no tilt",
        why="the disc of the encoder sits off the centre of its shaft",
        source="first harmonic of the angle error of an encoder mounted off centre",
    ),
    Effect(
        "drive_backlash",
        on_inputs=drive_backlash,
        needs=[DIRECTION],
        unknowns=[
            Unknown("play_before", -10, 10, "mrad", note="at the crank, before the bottom dead centre"),
            Unknown("play_after", -10, 10, "mrad", note="at the crank, after the bottom dead centre"),
        ],
        looks_like="at the same crank angle the slider stands higher on its way down than on its way up; nothing at "
        "the dead centre; no tilt",
        why="gears and couplings between encoder and crank have play, or the servo drive lags behind its command; what "
        "acts before and after the dead centre may be different flanks",
        source="reversal error of a drive: half the play to either side",
    ),
]
LOAD: list[Effect[Press, Slider]] = [
    Effect(
        "elastic_deflection",
        on_inputs=elastic_deflection,
        needs=[FORMING_FORCE],
        unknowns=[Unknown("compliance", 0, 5, "1/GN", note="1/(EA) of rods and knee links, equal sections")],
        looks_like="the slider gives way in proportion to the forming force, upward under a positive one; no tilt; an "
        "unbalanced weight adds a constant force",
        why="links are bars: a steel bar of 200 cm² has 0.24 1/GN",
        source="Hooke's law of the bar; link forces by virtual work",
    ),
    Effect(
        "joint_clearance",
        on_inputs=joint_clearance,
        needs=[FORMING_FORCE],
        unknowns=[Unknown("clearance", 0, 500, "um", note="radial, of every joint of rods and knee links")],
        looks_like="the slider jumps when the load changes its sign, however small it is: where forming force and "
        "counterbalance pass its weight; while the sign stays, a lift that varies little with the crank angle; no tilt",
        why="the pin of a loaded joint lies on one side of its bore, and on the other when the load reverses",
        source="joint as a link of zero mass of the length of its clearance; sign of the link force by virtual work",
    ),
    Effect(
        "joint_wear",
        on_inputs=joint_wear,
        needs=[STROKES, FORMING_FORCE],
        unknowns=[Unknown("wear", 0, 500, "um", note="radial clearance that every joint gains per million strokes")],
        looks_like="the slider rises in proportion to the strokes where it is pushed up and sinks where it is pulled "
        "down, whatever the time; no tilt",
        why="joints wear in proportion to load and sliding path, so evenly with the strokes once they have run in",
        source="Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981",
    ),
    Effect(
        "slider_inertia",
        on_inputs=slider_inertia,
        needs=[SPEED],
        unknowns=[
            Unknown(
                "mass_compliance",
                -20000,
                20000,
                "kg/GN",
                note="mass of the slider times 1/(EA) of its links; negative where a counterweight outweighs it",
            )
        ],
        looks_like="an elastic deflection that grows with the square of the speed and follows the acceleration of the "
        "slider over the crank angle: deeper at the bottom dead centre the faster the press runs; no tilt",
        why="a heavy slider loads its links by its own acceleration",
        source="d'Alembert: elastic deflection under the inertia of the slider, +m z'' omega^2 upward",
    ),
]
DIE: list[Effect[Press, Slider]] = [
    Effect(
        "die_inclination",
        on_results=die_inclination,
        unknowns=[
            Unknown("inclination", -1000, 1000, "urad", note="added to the tilt"),
            Unknown("height", -1000, 1000, "um", note="added to the position"),
        ],
        parts=[("inclination",), ("height",)],
        looks_like="the same tilt, or the same height, at every crank angle, load, temperature and time",
        why="the die or the bolster is not level, or stands on a shim",
        source="geometry",
    )
]
EFFECTS: list[Effect[Press, Slider]] = [*HEAT, *CRANK, *LOAD, *DIE]

__all__ = ["EFFECTS", "LINK_TEMPERATURE", "link_heating"]
