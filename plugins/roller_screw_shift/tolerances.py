"""How the parts of the pair scatter; the design itself (both shifts) is computed from the nominals."""

from truing import Tolerance, plus_minus

TOLERANCES = [
    Tolerance("face_width", plus_minus("0.05 mm"), why="usual for turned parts of this size"),
    Tolerance("centre_distance_deviation", plus_minus("10 um"), why="pitch diameters of the threads, as mounted"),
]
