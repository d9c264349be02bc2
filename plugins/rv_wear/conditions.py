"""What else must be measured before the effects of the reducer can act: each condition once, shared by its effects.

Working hours are an input of the reducer and belong to its set of discs; the clock of the bench is the ``time`` of the
kernel's own effects.
"""

from truing import Condition

HOUSING_TEMPERATURE = Condition(
    "housing_temperature", "degC", reference=20, low=15, high=60, note="of the housing with its pins, when measured"
)  # fmt: skip
DISC_TEMPERATURE = Condition(
    "disc_temperature", "degC", reference=20, low=15, high=60, note="of the cycloid discs, when measured"
)  # fmt: skip
OIL_TEMPERATURE = Condition(
    "oil_temperature", "degC", reference=40, low=20, high=80, note="of the lubricant at work, mean since new"
)  # fmt: skip
OUTPUT_ANGLE = Condition(
    "output_angle", "deg", reference=0, low=0, high=360, note="of the output, at which the backlash is read"
)  # fmt: skip
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
