"""What the pair leaves out. A new effect is a function and one more entry in EFFECTS."""

from roller_screw_shift.answers import Meshing
from roller_screw_shift.quantities import Pair
from truing import Effect

EFFECTS: list[Effect[Pair, Meshing]] = []
