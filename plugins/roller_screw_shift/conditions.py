"""What else must be measured before the effects of the roller screw can act: each condition once, for all of them.

The axial load is an input of the pair; its column holds row by row. The clock of the bench is the ``time`` of the
kernel's own effects.
"""

from truing import Condition

SCREW_SPEED = Condition(
    "screw_speed", "rpm", reference=0, low=10, high=3000, note="of the screw; the sign is its sense of turning"
)  # fmt: skip
TEMPERATURE = Condition(
    "temperature", "degC", reference=20, low=15, high=80, note="of nut, rollers and lubricant, when measured"
)  # fmt: skip
SCREW_ANGLE = Condition(
    "screw_angle", "deg", reference=0, low=0, high=36000,
    note="of the screw, counted on over its turns: the carrier is back at its place after 8 turns of the screw only",
)  # fmt: skip
CYCLES = Condition(
    "cycles", "", reference=0, low=0, high=5e6,
    note="load cycles of a tooth of the roller since new, all under the axial load of the row",
)  # fmt: skip
