"""What else must be measured before the effects of the gearing can act: each condition once, shared by its effects.

Torque, speed and the temperature of the oil are inputs of the stage; their columns hold row by row.
"""

from truing import Condition

INPUT_ANGLE = Condition(
    "input_angle", "deg", reference=0, low=0, high=39960,
    note="of the sun, counted on over its turns; at a ratio of 111 one turn of the output is 39960 degrees",
)  # fmt: skip
TIME = Condition("time", "h", reference=0, low=0, high=6000, note="at work since new")
