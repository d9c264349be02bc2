"""What the model leaves out."""

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.quantities import Drive
from truing import Effect

EFFECTS: list[Effect[Drive, Stiffness]] = []
