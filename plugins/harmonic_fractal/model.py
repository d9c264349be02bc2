"""The calculation as truing knows it: function, error sources, goals, studies and sheet."""

from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.effects import EFFECTS
from harmonic_fractal.tolerances import TOLERANCES
from truing import Model

HARMONIC_FRACTAL = Model(
    name="harmonic_fractal",
    title="Harmonic drive: contact stiffness and clearance of rough flanks",
    function=harmonic_fractal,
    errors=[*TOLERANCES, *EFFECTS],
    summary="How stiff are the rough flanks of a pair of teeth, and how much of the drive's torsion is theirs?",
)
