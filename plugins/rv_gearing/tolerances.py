"""How the parts of the first stage scatter."""

from truing import Tolerance, normal

TOLERANCES = [
    Tolerance("face_width", normal(sd="0.033 mm"), why="±0.1 mm"),
    Tolerance("shift", normal(sd="0.01"), on=["shift_sun", "shift_planet"], why="tooth thickness, in modules"),
    Tolerance("bearing_efficiency", normal(sd="0.001"), why="of bearings of one kind"),
]
