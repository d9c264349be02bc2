"""The gearing as truing knows it: function, error sources, goals, studies and sheet."""

from rv_gearing.calculation import rv_gearing
from rv_gearing.effects import EFFECTS
from rv_gearing.tolerances import TOLERANCES
from truing import Model

RV_GEARING = Model(
    name="rv_gearing",
    title="RV reducer: tooth numbers, and strength of the first gear stage",
    function=rv_gearing,
    errors=[*TOLERANCES, *EFFECTS],
    summary="Which tooth numbers give the wanted ratio, and do sun and planet carry the load?",
)
