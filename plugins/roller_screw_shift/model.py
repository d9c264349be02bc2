"""The pair of roller and ring as truing knows it: function, error sources, goals, studies and sheet."""

from roller_screw_shift.calculation import roller_screw_shift
from roller_screw_shift.choice import choice
from roller_screw_shift.effects import EFFECTS
from roller_screw_shift.findings import FINDINGS
from roller_screw_shift.published import PUBLISHED
from roller_screw_shift.sections import SECTIONS
from roller_screw_shift.shifts import Shifting
from roller_screw_shift.tolerances import TOLERANCES
from truing import Maximise, Minimise, Model, Optimise, Require, Vary

MARGINS = (
    "margin_ring_base", "margin_roller_base", "margin_contact_ratio", "margin_interference", "margin_opposite_tips",
    "margin_roller_root", "margin_ring_root", "margin_involute", "margin_undercut", "margin_tip_land",
    "margin_sliding",
)  # fmt: skip

ROLLER_SCREW_SHIFT = Model(
    name="roller_screw_shift",
    title="Planetary roller screw: profile shift of roller and ring",
    function=roller_screw_shift,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[
        Vary("roller_shift", "-0.5", "1"),
        Maximise("shift_sum"),
        Minimise("stress_difference"),
        Minimise("sliding_difference"),
        *(Require(name, at_least="0 rad" if name == "margin_interference" else "0") for name in MARGINS),
    ],
    studies=[Shifting(gives=choice), Optimise(population=60, generations=40)],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    summary="Which profile shift of roller and ring balances strength and sliding, and does the pair mesh at all?",
)
