"""The servo press of the paper as a straight line: its printed sensitivities at the bottom dead centre, nothing else.

Sensitivities of one joint height (m/m): section 2 of the reconstruction; sizes Table 1, tolerances Table 3.
"""

from truing import Allocation, Float, Model, Require, Tolerance, found, given, grade, inputs, plus_minus, results

LINKS = {  # name: (size in mm, sensitivity of one joint height, acts on the tilt)
    "upper_knee": (1700.0, 0.905827, True),
    "lower_knee": (1600.0, 1.129368, True),
    "rod": (1304.0, 0.149310, False),
    "knee_drive": (868.0, 0.771624, True),
    "crank": (360.0, 0.149310, False),
}
JOINTS = {
    "slider": (0.524855, True),
    "ground": (0.093022, True),
    "pivot": (0.080757, False),
    "platform": (0.080757, False),
}
ARM = 0.125586
SPAN = 3.2


@inputs
class Press:
    """Sizes, and how far each side is off."""

    size_upper_knee: Float = given(1700.0, "mm")
    size_lower_knee: Float = given(1600.0, "mm")
    size_rod: Float = given(1304.0, "mm")
    size_knee_drive: Float = given(868.0, "mm")
    size_crank: Float = given(360.0, "mm")
    size_arm: Float = given(600.0, "mm")
    upper_knee_1: Float = given(0.0, "mm")
    upper_knee_2: Float = given(0.0, "mm")
    lower_knee_1: Float = given(0.0, "mm")
    lower_knee_2: Float = given(0.0, "mm")
    rod_1: Float = given(0.0, "mm")
    rod_2: Float = given(0.0, "mm")
    knee_drive_1: Float = given(0.0, "mm")
    knee_drive_2: Float = given(0.0, "mm")
    crank_1: Float = given(0.0, "mm")
    crank_2: Float = given(0.0, "mm")
    arm: Float = given(0.0, "mm")
    slider_1: Float = given(0.0, "mm")
    slider_2: Float = given(0.0, "mm")
    ground_1: Float = given(0.0, "mm")
    ground_2: Float = given(0.0, "mm")
    pivot_1: Float = given(0.0, "mm")
    pivot_2: Float = given(0.0, "mm")
    platform_1: Float = given(0.0, "mm")
    platform_2: Float = given(0.0, "mm")
    position_goal: Float = given(88, "%")
    tilt_goal: Float = given(0.95, "")


@results
class Slider:
    """Where the slider is beside its nominal place."""

    position: Float = found("mm")
    tilt: Float = found("deg")


def press(sizes: Press) -> Slider:
    """Both sides added with the printed sensitivities."""
    position, tilt = ARM * sizes.arm, 0.0
    for name, (weight, on_tilt) in {**{key: value[1:] for key, value in LINKS.items()}, **JOINTS}.items():
        one, two = getattr(sizes, f"{name}_1"), getattr(sizes, f"{name}_2")
        position = position + weight / 2 * (one + two)
        tilt = tilt + (weight * (one - two) / SPAN if on_tilt else 0.0)
    return Slider(position=position, tilt=tilt)


PRESS = Model(
    name="press_stand_in", title="Servo press, linear", function=press,
    errors=[
        *(Tolerance(name, grade("IT7", size=f"size_{name}"), on=[f"{name}_1", f"{name}_2"]) for name in LINKS),
        Tolerance("arm", grade("IT7", size="size_arm")),
        *(Tolerance(name, plus_minus("0.05 mm"), on=[f"{name}_1", f"{name}_2"]) for name in JOINTS),
    ],
    objectives=[
        Require("position", within="0.02 mm", reliability="position_goal"),
        Require("tilt", within="0.001324 deg", reliability="tilt_goal"),
    ],
    studies=[Allocation()],
)  # fmt: skip
