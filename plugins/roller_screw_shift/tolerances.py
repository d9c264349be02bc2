"""How the parts of the pair scatter."""

from truing import Tolerance, plus_minus

TOLERANCES = [
    Tolerance("face_width", plus_minus("0.05 mm"), why="usual for turned parts of this size"),
    Tolerance("centre_distance", plus_minus("0.01 mm"), why="pitch diameters of the threads"),
]
