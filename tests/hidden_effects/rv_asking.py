"""A reducer's record as files, and what Truing says to it."""

from hidden_effects.plugin_asking import Rig
from hidden_effects.rv_cases import UNIT

WRITTEN = {
    "time": "h", "working_time": "h", "output_torque": "N*m", "output_speed": "r/min", "housing_temperature": "degC",
    "disc_temperature": "degC", "oil_temperature": "degC", "output_angle": "deg", "crank_angle": "deg",
    "measuring_torque": "N*m", "direction": "1",
}  # fmt: skip
REDUCER = Rig(plugin="rv_wear", inputs='plugin = "rv_wear"\n', written=WRITTEN, measured=UNIT)
diagnosed = REDUCER.diagnosed
