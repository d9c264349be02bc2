"""The reducer as truing knows it: function, error sources, goals, studies and sheet."""

from pathlib import Path

from rv_wear.bill import Costs, cost
from rv_wear.calculation import rv_wear
from rv_wear.chances import chances, history, indices
from rv_wear.effects import EFFECTS
from rv_wear.findings import FINDINGS
from rv_wear.modifications import Modifications, trend
from rv_wear.published import PUBLISHED
from rv_wear.sections import SECTIONS
from rv_wear.tolerances import TOLERANCES
from rv_wear.validity import Validity
from truing import Minimise, Model, Reliability, Require, Sensitivity, Sweep, Vary

LITERATURE = [
    "The paper: Liu Jiang, Xiao Zhengming, Zhang Longlong, Liu Weibiao (劉江, 肖正明, 張龍隆, 劉衛標), Transmission "
    "accuracy reliability analysis and parameter optimization of RV reducer considering cycloid gear wear, Chinese "
    "Journal of Engineering Design 29(6), 2022, p. 739.",
]

RV_WEAR = Model(
    name="rv_wear",
    title="RV reducer: wear of the cycloid disc and backlash over its life",
    function=rv_wear,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[
        Vary("equidistant_modification", "-0.045 mm", "0.004 mm"),
        Vary("shift_modification", by="equidistant_modification - design_clearance"),
        Minimise("tolerance_price"),
        Minimise("max_wear"),
        Require("backlash", at_most="permitted_backlash", reliability="required_reliability"),
        Require("max_pressure", at_most="permitted_pressure"),
    ],
    studies=[
        Validity(),
        Modifications(gives=trend),
        Sweep(over="working_time", at="0..6000 h", points=25, gives=history),
        Sensitivity(of="backlash", gives=indices),
        Reliability(over="working_time", at="0..6000 h", points=25, gives=chances),
        Costs(gives=cost),
    ],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    cites=LITERATURE,
    example=Path(__file__).with_name("example.toml"),
    summary="How far does the cycloid disc of an RV reducer wear, what becomes of its backlash, and which tolerances "
    "and modifications keep it within its limit at the least cost?",
)
