"""The reducer as truing knows it: function, error sources, goals, studies and sheet."""

from pathlib import Path

from rv_wear.calculation import rv_wear
from rv_wear.costs import TOLERANCES, Costs, cost
from rv_wear.discs import DiscValidity, Modifications, trend
from rv_wear.effects import EFFECTS
from rv_wear.exact_play import ExactPlay, answered
from rv_wear.machines import NewMachines, chances, history, indices
from rv_wear.optimum import LeastCosts, bought, ends, free_ends, front, learnt
from rv_wear.paper_route import PaperRoute, routed
from rv_wear.published import FINDINGS, PUBLISHED
from rv_wear.sheet import SECTIONS
from rv_wear.spectrum import LoadSpectrum, lived
from truing import Allocation, Minimise, Model, Optimise, Reliability, Require, Sensitivity, Surrogate, Sweep, Vary

LITERATURE = [
    "The paper: Liu Jiang, Xiao Zhengming, Zhang Longlong, Liu Weibiao (劉江, 肖正明, 張龍隆, 劉衛標), Transmission "
    "accuracy reliability analysis and parameter optimization of RV reducer considering cycloid gear wear, Chinese "
    "Journal of Engineering Design 29(6), 2022, p. 739."
]

BOX = {
    "output_torque": "1000..4500 N*m",
    "output_speed": "5..25 r/min",
    "working_time": "200..7000 h",
    "equidistant_modification": "-45..4 um",
    "equidistant_modification - shift_modification": "2..6 um",
}

RV_WEAR = Model(
    name="rv_wear",
    title="RV reducer: wear of the cycloid disc and backlash over its life",
    function=rv_wear,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[
        Vary("equidistant_modification", "-0.045 mm", "0.004 mm", step="0.1 um"),
        Vary("shift_modification", by="equidistant_modification - design_clearance"),
        Minimise("tolerance_price"),
        Minimise("max_wear"),
        Require("backlash", at_most="permitted_backlash", reliability="required_reliability"),
        Require("max_pressure", at_most="permitted_pressure"),
    ],
    studies=[
        DiscValidity(),
        Modifications(gives=trend),
        Sweep(over="working_time", at="0..6000 h", points=25, gives=history),
        Sensitivity(of="backlash", gives=indices),
        Reliability(over="working_time", at="0..6000 h", points=25, gives=chances),
        NewMachines(),
        ExactPlay(gives=answered),
        LoadSpectrum(gives=lived),
        Costs(gives=cost),
        Surrogate(
            of="max_wear",
            over=BOX,
            logarithmic=("output_torque", "output_speed", "working_time"),
            log_result=True,
            along="working_time",
            restarts=1,
            compare=1000,
            gives=learnt,
        ),
        Allocation(of="backlash", tightest=1.0, widest=2.0, gives=bought),
        LeastCosts(gives=ends),
        LeastCosts(name="both_free", goals=(), clearances=(0.0, 2.0, 4.0), gives=free_ends),
        PaperRoute(gives=routed),
        Optimise(chance="first_order", generations=110, gives=front),
    ],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    cites=LITERATURE,
    exceptions={
        "order of effects": "what pins, cranks and toothing off centre take from the play is no sum; toothing_runout "
        "alone knows where the output stands and acts last of the three, with what the others moved"
    },
    example=Path(__file__).with_name("example.toml"),
    summary="How far does the cycloid disc of an RV reducer wear, what becomes of its backlash, and which tolerances "
    "and modifications keep it within its limit at the least cost?",
)
