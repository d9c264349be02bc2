"""What the rating of the first stage leaves out. A new effect is a function and one more entry in EFFECTS."""

from rv_gearing.answers import Strength
from rv_gearing.quantities import Gearing
from truing import Effect

EFFECTS: list[Effect[Gearing, Strength]] = []
