"""What else must be measured before the effects of the drive can act: each condition once, for all of them.

The torque is an input of the drive; its column holds row by row. Turns, direction and peak are taken from that column
as it stands, so a column of commanded torque serves better than one with noise.
"""

from truing import Condition

REVERSAL_TORQUE = Condition(
    "reversal_torque", "N*m", reference=0, derived="last_reversal of torque", low=-500, high=500,
    note="where the torque last turned; at first where it began",
)  # fmt: skip
PEAK_TORQUE = Condition(
    "peak_torque", "N*m", reference=0, derived="running_maximum of torque", low=0, high=1000,
    note="the largest torque so far",
)  # fmt: skip
DIRECTION = Condition(
    "direction", "", reference=0, derived="direction of torque", low=-1, high=1,
    note="way of the torque: +1 while it grows, -1 while it falls, 0 for the mean of both",
)  # fmt: skip
WAVE_ANGLE = Condition(
    "wave_angle", "deg", reference=0, low=0, high=360, note="angle of the wave generator, against the circular spline"
)  # fmt: skip
TEMPERATURE = Condition(
    "temperature", "degC", reference=20, low=-10, high=80,
    note="temperature of the drive and its lubricant, when measured",
)  # fmt: skip
CYCLES = Condition(
    "cycles", "", reference=0, low=0, high=1e8, note="meshes of a pair of teeth in service, since new"
)  # fmt: skip
TIME = Condition(
    "time", "h", reference=0, derived="since_start", low=0, high=100, note="time under torque, since the first row"
)  # fmt: skip
SPEED = Condition(
    "speed", "rpm", reference=0, low=0, high=6000, note="speed of the wave generator; the sign is its sense of turning"
)  # fmt: skip
