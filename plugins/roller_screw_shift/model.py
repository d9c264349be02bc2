"""The pair of roller and ring as truing knows it: function, error sources, goals, studies and sheet."""

from roller_screw_shift.calculation import roller_screw_shift
from roller_screw_shift.effects import EFFECTS
from roller_screw_shift.tolerances import TOLERANCES
from truing import Model

ROLLER_SCREW_SHIFT = Model(
    name="roller_screw_shift",
    title="Planetary roller screw: profile shift of roller and ring",
    function=roller_screw_shift,
    errors=[*TOLERANCES, *EFFECTS],
    summary="Which profile shift of roller and ring balances strength and sliding, and does the pair mesh at all?",
)
