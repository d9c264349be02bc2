"""What the mechanism of the paper leaves out, each acting on the deviations of the press."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from press_linkage.errors import KINDS, face_sensitivities
from press_linkage.kinematics import Position, slider_motion, solve
from press_linkage.quantities import Press, PressSide, Slider
from truing import Condition, Effect, Float, Unknown

# What else must be measured before the effects of the press can act: each condition once, shared by its effects

LINK_TEMPERATURE = Condition("link_temperature", "degC", reference=20, note="temperature of the links", low=15,
                             high=60, role="follows")  # fmt: skip
FORMING_FORCE = Condition(
    "forming_force", "kN", reference=0, low=-200, high=2000,
    note="force on the slider, central; positive pushes it up; where weight and counterbalance leave nothing of it, "
    "that counts as up",
)  # fmt: skip
TIME = Condition("time", "h", reference=0, derived="since_start", low=0, high=10,
                 note="time at work since the first row")  # fmt: skip
STROKES = Condition("strokes", "", reference=0, derived="since_start", low=0, high=1e6, rate="speed",
                    note="strokes made since the first row")  # fmt: skip
SPEED = Condition("speed", "rpm", reference=0, note="speed of the cranks", low=5, high=60)
DIRECTION = Condition("direction", "", reference=0, low=-1, high=1,
                      note="way of the slider: +1 towards its bottom dead centre, -1 away from it")  # fmt: skip


# Links that lengthen with heat. Frame, platform width and slider keep their size

HEATED = KINDS[:5]  # crank, rod and knee links


def longer(side: PressSide, by: Mapping[str, Float]) -> PressSide:
    """One side with these lengths off by so much more, m, named without ``_deviation``."""
    names = {kind: f"{kind}_deviation" for kind in by}
    return replace(side, **{name: getattr(side, name) + by[kind] for kind, name in names.items()})


def with_sides(press: Press, *by: Mapping[str, Float]) -> Press:
    """The press with each side off by so much more."""
    side_1, side_2 = (longer(side, more) for side, more in zip((press.side_1, press.side_2), by, strict=True))
    return replace(press, side_1=side_1, side_2=side_2)


def stretched(press: Press, *strains: Float) -> Press:
    """The press with every link of a side longer by the strain of that side, the platform arm by their mean."""
    arm = 0.5 * (strains[0] + strains[1]) * press.platform_arm
    warm = with_sides(press, *({kind: strain * getattr(press, kind) for kind in HEATED} for strain in strains))
    return replace(warm, platform_arm_deviation=press.platform_arm_deviation + arm)


def link_heating(press: Press, *, expansion: Float, link_temperature: Float) -> Press:
    """All links of both sides lengthen with their temperature; frame, platform width and slider do not."""
    strain = expansion * (link_temperature - LINK_TEMPERATURE.zero)
    return stretched(press, strain, strain)


def warm_up(press: Press, *, rise: Float, time_constant: Float, time: Float) -> Press:
    """All links of both sides lengthen with the time at work, towards a last strain: a body that heats up."""
    strain = -rise * np.expm1(-time / time_constant)
    return stretched(press, strain, strain)


def side_heating(press: Press, *, expansion_1: Float, expansion_2: Float, link_temperature: Float) -> Press:
    """The links of each side lengthen at their own rate, the platform arm, common to both, at the mean rate."""
    warmer = link_temperature - LINK_TEMPERATURE.zero
    return stretched(press, expansion_1 * warmer, expansion_2 * warmer)


# Cranks that are not where their encoder says

TURN = 2.0 * np.pi


def ahead(press: Press, by: Float) -> Press:
    """The press with both cranks ahead, rad, in the sense in which the crank angle grows."""
    return with_sides(press, {"crank_angle": by}, {"crank_angle": by})


def crank_phase(press: Press, *, phase: Float) -> Press:
    """Both cranks are ahead of the angle that is shown, by the same amount at every angle."""
    return ahead(press, phase)


def encoder_eccentricity(press: Press, *, sine: Float, cosine: Float) -> Press:
    """Both cranks are ahead by a first harmonic of the crank angle, as behind an encoder disc mounted off centre."""
    return ahead(press, sine * np.sin(press.crank_angle) + cosine * np.cos(press.crank_angle))


def past_dead_centre(crank_angle: Float) -> Float:
    """Which side of the bottom dead centre the crank is on: -1 before, +1 after, 0 at it.

    The angle is wrapped into (-180, 180] degrees first; half a turn counts as after, whichever way it was reached.
    """
    return np.sign(crank_angle - TURN * np.ceil(crank_angle / TURN - 0.5))


def drive_backlash(press: Press, *, play_before: Float, play_after: Float, direction: Float) -> Press:
    """Both cranks stay behind in their sense of turning by half the play, which may differ before and after the centre.

    A slider on its way to the bottom dead centre has cranks that turn forward before it and backward after it. At the
    dead centre itself, and without a direction (0), the crank lies in the middle of its play. Of the direction only the
    sign counts.
    """
    where = past_dead_centre(press.crank_angle)
    play = np.where(where < 0, play_before, play_after)
    sense_of_turning = -where * np.sign(direction)
    return ahead(press, -0.5 * play * sense_of_turning)


# Links that give way under load, joints whose play the load takes up, and the load that the slider itself is
#
# A central force F on the slider presses each link with N = F dS/dL (virtual work), dS/dL being the exact derivative of
# the slider position by the length of that link, in the position that the press is in: F/2 times the paper's xi.

KNEE = KINDS[2:5]
JOINTS = 2  # per link
MILLION = 1e6
GRAVITY = 9.80665  # m/s2
ROUNDING = 1e-9  # of the weight: a load nearer to nothing is nothing

LoadShares = tuple[Mapping[str, Float], Mapping[str, Float]]


def shares_of_load(position: Position) -> LoadShares:
    """Compression of the links of both sides per newton that pushes the slider up, N/N, negative where they are pulled.

    Rods and knee links; 0 where the loops do not close, so that the model itself says why they do not.
    """
    halves = (position.side_1, position.side_2)
    with np.errstate(invalid="ignore", divide="ignore"):
        faces = [face_sensitivities(half) for half in halves]
        arm = 0.5 * (faces[0]["platform_arm"] + faces[1]["platform_arm"])
        found = [
            {"rod_length": 0.5 * arm / half.rod.sine} | {kind: 0.5 * face[kind] for kind in KNEE}
            for half, face in zip(halves, faces, strict=True)
        ]
    one, two = ({kind: _closed(value) for kind, value in shares.items()} for shares in found)
    return one, two


def _closed(value: Float) -> Float:
    """0 where there is no number."""
    return np.nan_to_num(value, nan=0.0, posinf=0.0, neginf=0.0)


def net_force(press: Press, forming_force: Float) -> Float:
    """What pushes the slider up, N: forming force and counterbalance less its weight; below 0 it hangs in its links.

    The weight of the links and the inertia of the slider are left out.
    """
    weight = GRAVITY * press.slider_mass
    force = forming_force + press.counterbalance - weight
    return np.where(np.abs(force) <= ROUNDING * weight, 0.0, force)


def pressed(press: Press, position: Position, force_by_stiffness: Float) -> Press:
    """The press under a central force F, given as F/(EA) with equal sections: each link shortens by N L/(EA)."""
    one, two = (
        {kind: -force_by_stiffness * share * getattr(press, kind) for kind, share in shares.items()}
        for shares in shares_of_load(position)
    )
    return with_sides(press, one, two)


def slackened(press: Press, clearance: Float, forming_force: Float) -> Press:
    """The press with this radial clearance in both joints of each link: shorter where pressed, longer where pulled."""
    force = net_force(press, forming_force)
    upward = np.where(np.isnan(force), np.nan, np.where(force < 0, -1.0, 1.0))
    play = JOINTS * clearance * upward
    by = ({kind: -play * np.sign(share) for kind, share in shares.items()} for shares in shares_of_load(solve(press)))
    return with_sides(press, *by)


def elastic_deflection(press: Press, *, compliance: Float, forming_force: Float) -> Press:
    """Rods and knee links shorten under the force that they carry like bars of one section; compliance is 1/(EA)."""
    return pressed(press, solve(press), compliance * net_force(press, forming_force))


def joint_clearance(press: Press, *, clearance: Float, forming_force: Float) -> Press:
    """The load takes up the clearance of every joint, to the side to which it presses or pulls the link.

    It reverses where the forming force and the counterbalance together are the weight of the slider.
    """
    return slackened(press, clearance, forming_force)


def joint_wear(press: Press, *, wear: Float, strokes: Float, forming_force: Float) -> Press:
    """Every joint gains clearance in proportion to the strokes; the load takes it up, as above."""
    return slackened(press, wear * strokes / MILLION, forming_force)


def slider_inertia(press: Press, *, mass_compliance: Float, speed: Float) -> Press:
    """The elastic line under the inertia of the slider, with both cranks turning at the same, steady speed.

    A slider that accelerates upward (z'' < 0, as at the bottom dead centre) pulls its links down: as a force that is
    positive upward, its inertia is +m z''. ``mass_compliance`` is m/(EA), ``speed`` in turns per second; z'' is exact
    at every crank angle.
    """
    position = solve(press)
    by_angle = _closed(slider_motion(position).acceleration)
    return pressed(press, position, mass_compliance * by_angle * (TURN * speed) ** 2)


# They act in the order declared: heat, then errors of the crank angle, then load, so that the load meets the position
# in which the press really is. A new effect is a function beside the others and one more entry in EFFECTS.

EXPANSION = "linear expansion; steel 11.5 um/(m*K)"


def die_inclination(press: Press, slider: Slider, *, inclination: Float, height: Float) -> Slider:
    """The die, against which the slider is measured, is inclined and packed: constant on tilt and position."""
    return replace(
        slider, slider_tilt=slider.slider_tilt + inclination, slider_position=slider.slider_position + height
    )


EFFECTS: list[Effect[Press, Slider]] = [
    Effect("link_heating", on_inputs=link_heating, needs=[LINK_TEMPERATURE],
           unknowns=[Unknown("expansion", -20, 20, "um/(m*K)",
                             "of the links, less that of the frame and the gauge's support")],
           looks_like="the slider sinks with the temperature of the links, nearly alike at every crank angle; no tilt",
           remedy="Warm the press up before its height is set, or correct it by the temperature of the links; the "
                  "slider then no longer sinks.",
           why="friction heats the joints and links of a press at work; its frame stays colder",
           source=EXPANSION),
    Effect("warm_up", on_inputs=warm_up, needs=[TIME],
           unknowns=[Unknown("rise", -1000, 1000, "um/m", "strain of the links when warm, counted from the first row"),
                     Unknown("time_constant", 0.1, 20, "h", "after it 63 % of the strain is there")],
           looks_like="the slider sinks fast at first, then ever more slowly, with time and not with strokes; no tilt",
           remedy="Let the press run warm before its height is set, or correct it over the time at work; the slider "
                  "then no longer sinks.",
           why="a press that starts cold heats its links until loss and gain of heat are in balance",
           source="linear expansion of a body that heats up at a rate in proportion to what is left (Newton's law of "
                  "cooling)"),
    Effect("side_heating", on_inputs=side_heating, needs=[LINK_TEMPERATURE],
           unknowns=[Unknown("expansion_1", -20, 20, "um/(m*K)",
                             "of the links of side 1, and half of the platform arm"),
                     Unknown("expansion_2", -20, 20, "um/(m*K)",
                             "of the links of side 2, and half of the platform arm")],
           looks_like="the slider sinks and tilts with the temperature of the links, lower on the warmer side",
           remedy="Oil both sides alike, and shield the warmer one from sun or furnace; the slider then no longer "
                  "tilts as the links get warm.",
           why="one side is oiled less, stands in the sun or beside a furnace: its links are warmer than was measured",
           source=EXPANSION),
    Effect("crank_phase", on_inputs=crank_phase,
           unknowns=[Unknown("phase", -20, 20, "mrad", "both cranks ahead of the angle that is shown")],
           looks_like="the slider is too low before the bottom dead centre and too high after it, by its speed per "
                      "angle; next to nothing at the dead centre; no tilt",
           remedy="Set the zero of the encoder at the dead centre, and check the coupling for slip; the height is "
                  "then right before and after it.",
           why="the zero of the encoder was set beside the dead centre, or a coupling has slipped",
           source="kinematics of the linkage"),
    Effect("encoder_eccentricity", on_inputs=encoder_eccentricity,
           unknowns=[Unknown("sine", -10, 10, "mrad", "cranks ahead in proportion to the sine of the crank angle"),
                     Unknown("cosine", -10, 10, "mrad", "cranks ahead in proportion to the cosine of the crank angle")],
           looks_like="like an error of the crank phase that changes once per turn, alike in both directions; no tilt",
           remedy="Centre the disc of the encoder on its shaft, or correct its angle by this wave; the error once per "
                  "turn is gone then.",
           why="the disc of the encoder sits off the centre of its shaft",
           source="first harmonic of the angle error of an encoder mounted off centre"),
    Effect("drive_backlash", on_inputs=drive_backlash, needs=[DIRECTION],
           unknowns=[Unknown("play_before", -10, 10, "mrad", "at the crank, before the bottom dead centre"),
                     Unknown("play_after", -10, 10, "mrad", "at the crank, after the bottom dead centre")],
           looks_like="at the same crank angle the slider stands higher on its way down than on its way up; nothing "
                      "at the dead centre; no tilt",
           remedy="Take the play out of gears and couplings, and look at the lag of the servo drive; heights on the "
                  "way down and up then agree.",
           why="gears and couplings between encoder and crank have play, or the servo drive lags behind its command; "
               "what acts before and after the dead centre may be different flanks",
           source="reversal error of a drive: half the play to either side"),
    Effect("elastic_deflection", on_inputs=elastic_deflection, needs=[FORMING_FORCE],
           unknowns=[Unknown("compliance", 0, 5, "1/GN", "1/(EA) of rods and knee links, equal sections")],
           looks_like="the slider gives way in proportion to the forming force, upward under a positive one; no "
                      "tilt; an unbalanced weight adds a constant force",
           remedy="Correct the height in proportion to the forming force, and keep the effect on in the inputs file; "
                  "the height then fits at any force.",
           why="links are bars: a steel bar of 200 cm² has 0.24 1/GN",
           source="Hooke's law of the bar; link forces by virtual work"),
    Effect("joint_clearance", on_inputs=joint_clearance, needs=[FORMING_FORCE],
           unknowns=[Unknown("clearance", 0, 500, "um", "radial, of every joint of rods and knee links")],
           looks_like="the slider jumps when the load changes its sign, however small it is: where forming force and "
                      "counterbalance pass its weight; while the sign stays, a lift that varies little with the "
                      "crank angle; no tilt",
           remedy="Renew loose pins or bores, or set a counterbalance with which the load keeps its sign; the jump is "
                  "then smaller or gone.",
           why="the pin of a loaded joint lies on one side of its bore, and on the other when the load reverses",
           source="joint as a link of zero mass of the length of its clearance; sign of the link force by virtual "
                  "work"),
    Effect("joint_wear", on_inputs=joint_wear, needs=[STROKES, FORMING_FORCE],
           unknowns=[Unknown("wear", 0, 500, "um", "radial clearance that every joint gains per million strokes")],
           looks_like="the slider rises in proportion to the strokes where it is pushed up and sinks where it is "
                      "pulled down, whatever the time; no tilt",
           remedy="Renew worn pins and bores, and check that oil reaches them; the slider is then back at its height "
                  "and moves less with the strokes.",
           why="joints wear in proportion to load and sliding path, so evenly with the strokes once they have run in",
           source="Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"),
    Effect("slider_inertia", on_inputs=slider_inertia, needs=[SPEED],
           unknowns=[Unknown("mass_compliance", -20000, 20000, "kg/GN",
                             "mass of the slider times 1/(EA) of its links; negative where a counterweight "
                                  "outweighs it")],
           looks_like="an elastic deflection that grows with the square of the speed and follows the acceleration of "
                      "the slider over the crank angle: deeper at the bottom dead centre the faster the press runs; "
                      "no tilt",
           remedy="Set the height at the working speed, or correct it by the square of the speed; the slider is then "
                  "right at the dead centre.",
           why="a heavy slider loads its links by its own acceleration",
           source="d'Alembert: elastic deflection under the inertia of the slider, +m z'' omega^2 upward"),
    Effect("die_inclination", on_results=die_inclination,
           unknowns=[Unknown("inclination", -1000, 1000, "urad", "added to the tilt"),
                     Unknown("height", -1000, 1000, "um", "added to the position")],
           parts=[("inclination",), ("height",)],
           looks_like="the same tilt, or the same height, at every crank angle, load, temperature and time",
           remedy="Level die and bolster, and check for shims that do not belong there; the constant tilt or height "
                  "is gone then.",
           why="the die or the bolster is not level, or stands on a shim",
           source="geometry"),
]  # fmt: skip
