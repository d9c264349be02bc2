"""The pair of roller and ring as truing knows it: function, error sources, goals, studies and sheet."""

from pathlib import Path

from roller_screw_shift.calculation import MARGINS, roller_screw_shift
from roller_screw_shift.effects import EFFECTS
from roller_screw_shift.optimum import Shifting, choice
from roller_screw_shift.published import FINDINGS, PUBLISHED
from roller_screw_shift.sheet import SECTIONS
from truing import Maximise, Minimise, Model, Optimise, Require, Tolerance, Vary, plus_minus

# How the parts of the pair scatter; the design itself (both shifts) is computed from the nominals

TOLERANCES = [
    Tolerance("face_width", plus_minus("0.05 mm"), why="usual for turned parts of this size"),
    Tolerance("centre_distance_deviation", plus_minus("10 um"), why="pitch diameters of the threads, as mounted"),
]


LITERATURE = [
    "The paper: Gao Yang, Yang Jiajun, Liang Han, Deng Bo, Zhu Jisheng (高揚, 楊家軍, 梁漢, 鄧波, 朱繼生), "
    "Optimization of Planetary Roller Screw Gear Modification Coefficient, Journal of Hubei University of Technology "
    "30(4), 2015, p. 58.",
    "Box, M. J., A new method of constrained optimization and a comparison with other methods, The Computer Journal 8 "
    "(1965), p. 42.",
    "ISO 3408-5:2006, Ball screws, Part 5: Static and dynamic axial load ratings and operational life. ISO 281:2007, "
    "Rolling bearings: Dynamic load ratings and rating life.",
    "Johnson, K. L., Contact Mechanics, Cambridge 1985, chapter 4.",
    "Guin, J. A., Modification of the complex method of constrained optimization, The Computer Journal 10 (1968), p. "
    "416.",
]

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
        Require("margin_pressure", at_least="0"),
    ],
    studies=[Shifting(gives=choice), Optimise(population=60, generations=40)],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    cites=LITERATURE,
    example=Path(__file__).with_name("example.toml"),
    summary="Which profile shift of roller and ring balances strength and sliding, and does the pair mesh at all?",
)
