"""What the mechanism of the paper leaves out, each acting on the deviations of the press.

A new effect is a function beside ``link_heating`` and one more entry in EFFECTS.
"""

from dataclasses import replace

from press_linkage.quantities import Press, Side, Slider
from truing import Condition, Effect, Float, Unknown

LINK_TEMPERATURE = Condition("link_temperature", "degC", reference=20, note="temperature of the links")


def stretched(press: Press, side: Side, strain: Float) -> Side:
    """One side with every link longer by this strain."""
    return replace(
        side,
        crank_radius_deviation=side.crank_radius_deviation + strain * press.crank_radius,
        rod_length_deviation=side.rod_length_deviation + strain * press.rod_length,
        knee_drive_length_deviation=side.knee_drive_length_deviation + strain * press.knee_drive_length,
        upper_knee_length_deviation=side.upper_knee_length_deviation + strain * press.upper_knee_length,
        lower_knee_length_deviation=side.lower_knee_length_deviation + strain * press.lower_knee_length,
    )


def link_heating(press: Press, *, expansion: Float, link_temperature: Float) -> Press:
    """All links of both sides lengthen with their temperature; frame, platform width and slider do not."""
    strain = expansion * (link_temperature - LINK_TEMPERATURE.zero)
    return replace(
        press,
        platform_arm_deviation=press.platform_arm_deviation + strain * press.platform_arm,
        side_1=stretched(press, press.side_1, strain),
        side_2=stretched(press, press.side_2, strain),
    )


EFFECTS: list[Effect[Press, Slider]] = [
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
        source="linear expansion; steel 11.5 um/(m*K)",
    ),
]
