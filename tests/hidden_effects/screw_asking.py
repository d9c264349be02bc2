"""A roller screw's record as files, and what Truing says to it."""

from hidden_effects.plugin_asking import Rig
from hidden_effects.screw_cases import UNIT

INPUTS = """plugin = "roller_screw_shift"

[studies.diagnose]
box = { axial_load = "1..25 kN" }
"""
WRITTEN = {
    "time": "h", "axial_load": "kN", "screw_speed": "r/min", "temperature": "degC", "screw_angle": "deg", "cycles": "1",
}  # fmt: skip
SCREW = Rig(plugin="roller_screw_shift", inputs=INPUTS, written=WRITTEN, measured=UNIT)
diagnosed = SCREW.diagnosed
