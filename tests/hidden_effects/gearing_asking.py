"""A record of a first stage as files, and what Truing says to it."""

from hidden_effects.gearing_cases import UNIT
from hidden_effects.plugin_asking import Rig

INPUTS = 'plugin = "rv_gearing"\n[inputs]\nsun_teeth = 20\nplanet_teeth = 55\n'
WRITTEN = {
    "time": "h", "load_torque": "N*m", "input_speed": "rpm", "oil_temperature": "degC", "input_angle": "deg",
}  # fmt: skip
STAGE = Rig(plugin="rv_gearing", inputs=INPUTS, written=WRITTEN, measured=UNIT)
diagnosed = STAGE.diagnosed
