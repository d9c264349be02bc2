"""What makes a press give way or tilt otherwise than its drawing says, and how its parts scatter."""

from dataclasses import replace

from press_linkage.loaded_quantities import LoadedAnswers, LoadedPress
from press_linkage.model import parts
from truing import Effect, Float, Tolerance, Unknown, lognormal, normal, plus_minus


def off_centre(press: LoadedPress, *, shift: Float) -> LoadedPress:
    """The force acts farther towards side 1 than is stated."""
    return replace(press, load_offset=press.load_offset + shift)


def loose_joints(press: LoadedPress, *, play: Float) -> LoadedPress:
    """Every joint of rods and knee links has so much more radial clearance."""
    return replace(press, joint_play=press.joint_play + play)


def worn_guides(press: LoadedPress, *, wear: Float) -> LoadedPress:
    """The slider has so much more clearance in its guides, to each side."""
    return replace(press, guide_clearance=press.guide_clearance + wear)


def worn_platform_guides(press: LoadedPress, *, wear: Float) -> LoadedPress:
    """The platform has so much more clearance in its guides, to each side."""
    return replace(press, platform_guide_clearance=press.platform_guide_clearance + wear)


def soft_frame(press: LoadedPress, *, loss: Float) -> LoadedPress:
    """The frame at the ground joints has lost a share of its stiffness, in both directions and on both sides."""
    left = 1.0 - loss
    return replace(
        press,
        ground_stiffness_vertical=press.ground_stiffness_vertical * left,
        ground_stiffness_sideways=press.ground_stiffness_sideways * left,
    )


def warm_links(press: LoadedPress, *, rise: Float) -> LoadedPress:
    """Links, platform and slider are warmer than is stated."""
    return replace(press, link_rise=press.link_rise + rise)


def warm_frame(press: LoadedPress, *, rise: Float) -> LoadedPress:
    """The frame with its joints, columns and bolster is warmer than is stated."""
    return replace(press, frame_rise=press.frame_rise + rise)


def inclined_guides(press: LoadedPress, *, inclination: Float) -> LoadedPress:
    """The guides lean more than is stated, their lower end towards side 1."""
    return replace(press, guide_inclination=press.guide_inclination + inclination)


EFFECTS: list[Effect[LoadedPress, LoadedAnswers]] = [
    Effect("off_centre", on_inputs=off_centre,
           unknowns=[Unknown("shift", -1000, 1000, "mm", "of the force, towards side 1")],
           looks_like="a tilt in proportion to the force, with the stiffness of the press against tilting",
           remedy="Move the tool so that its force acts in the middle, or level it with a second stage.",
           why="the tool is mounted beside the middle, or one of its stages works harder than planned",
           source="moment equilibrium of the slider"),
    Effect("loose_joints", on_inputs=loose_joints,
           unknowns=[Unknown("play", 0, 500, "um", "more radial clearance of every joint")],
           looks_like="the slider jumps up when the force takes up the play, however small it is; little tilt",
           remedy="Renew worn pins and bushes, or raise the counterbalance so that the load keeps its sign.",
           why="pins and bushes are worn",
           source="play of a joint as a gap along its link"),
    Effect("worn_guides", on_inputs=worn_guides,
           unknowns=[Unknown("wear", 0, 1000, "um", "more clearance of the slider to each side")],
           looks_like="more tilt under a force beside the middle, up to a constant that does not grow with the force",
           remedy="Set or renew the gibs of the slider.",
           why="the gibs of the slider are worn or set too wide",
           source="guides as springs with a gap"),
    Effect("worn_platform_guides", on_inputs=worn_platform_guides,
           unknowns=[Unknown("wear", 0, 2000, "um", "more clearance of the platform to each side")],
           looks_like="more tilt under a force beside the middle, since the platform tilts with it until its guides "
                      "hold it; platform_tilt, measured too, shows it by far the best",
           remedy="Set or renew the guides of the platform.",
           why="the platform is guided with more clearance than drawn, or not against tilting",
           source="guides as springs with a gap"),
    Effect("soft_frame", on_inputs=soft_frame,
           unknowns=[Unknown("loss", 0, 95, "%", "share of the stiffness at the ground joints that is missing")],
           looks_like="the slider gives way more, in proportion to the force, and tilts more under one beside the "
                      "middle; so it does with soft joints, until gauges at both ground joints, ground_rise_1 and "
                      "ground_rise_2, show the frame, and with a frame built softer, until its stiffness is known",
           remedy="Tighten the tie rods and look for cracks at the bearings of the upper knee links.",
           why="tie rods have lost their preload, or the frame is cracked at a bearing",
           source="frame and link as springs in series"),
    Effect("warm_links", on_inputs=warm_links,
           unknowns=[Unknown("rise", -30, 60, "K", "of links, platform and slider")],
           looks_like="the slider sits lower at any force; no tilt; near the bottom dead centre a frame that cools "
                      "draws the same curve, over the whole stroke it does not",
           remedy="Warm the press up before its height is set, or correct it by the temperature of the links.",
           why="friction heats the joints and links of a press at work",
           source="linear expansion"),
    Effect("warm_frame", on_inputs=warm_frame,
           unknowns=[Unknown("rise", -30, 60, "K", "of the frame with columns and bolster")],
           looks_like="the slider sits higher over the bolster at any force; no tilt; near the bottom dead centre "
                      "links that cool draw the same curve, over the whole stroke they do not",
           remedy="Set the height with the frame at the temperature of the shift.",
           why="drive and hydraulics warm the frame, or the hall is warmer than when the press was set",
           source="linear expansion"),
    Effect("inclined_guides", on_inputs=inclined_guides,
           unknowns=[Unknown("inclination", -2, 2, "mrad", "lower end towards side 1")],
           looks_like="a sideways way and a tilt of the slider over its stroke, without force too",
           remedy="Align the gibs with a square on the bolster.",
           why="gibs were set without a square, or a column leans",
           source="geometry"),
]  # fmt: skip

TOLERANCES = [
    *(replace(part, price=None) for part in parts(chosen=False)),
    Tolerance("joint_play", lognormal(sd="20 %"), why="fit and wear of the pins; assumed"),
    Tolerance("guide_clearance", lognormal(sd="20 %"), why="setting of the gibs; assumed"),
    Tolerance("guide_inclination", plus_minus("0.02 mrad"), why="gibs aligned with a square; assumed"),
    Tolerance("joint_stiffness", lognormal(sd="20 %"), why="contact of pin and bush; assumed"),
    Tolerance(
        "frame_stiffness",
        lognormal(sd="10 %"),
        on=["ground_stiffness_vertical", "ground_stiffness_sideways", "column_stiffness"],
        why="calculated; assumed",
    ),
    Tolerance("load_offset", normal(sd="10 mm"), why="place of the tool; assumed"),
]
