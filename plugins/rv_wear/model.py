"""The reducer as truing knows it: function, error sources, goals, studies and sheet."""

from rv_wear.calculation import rv_wear
from truing import Model, Require, Tolerance, zone

RV_WEAR = Model(
    name="rv_wear",
    title="RV reducer: wear of the cycloid disc and backlash over its life",
    function=rv_wear,
    errors=[Tolerance("composite_roughness", zone("-0.1 um", "0.1 um"))],
    objectives=[Require("backlash", at_most="permitted_backlash", reliability="required_reliability")],
    summary="How far does the cycloid disc of an RV reducer wear, what becomes of its backlash, and which tolerances "
    "and modifications keep it within its limit at the least cost?",
)
