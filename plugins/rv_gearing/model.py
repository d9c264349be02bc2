"""The gearing as truing knows it: function, error sources, goals, studies and sheet."""

from pathlib import Path

from rv_gearing.effects import EFFECTS
from rv_gearing.groups import GroupSearch, listed
from rv_gearing.published import FINDINGS, PUBLISHED
from rv_gearing.rating import Capacity, Safeties, rating, rv_gearing
from rv_gearing.shaping import Shifts
from rv_gearing.sheet import SECTIONS
from truing import Model, Reliability, Require, Sensitivity, Tolerance, normal

# How the parts of the first stage scatter

TOLERANCES = [
    Tolerance("face_width", normal(sd="0.033 mm"), why="±0.1 mm"),
    Tolerance("shift", normal(sd="0.01"), on=["shift_sun", "shift_planet"], why="tooth thickness, in modules"),
    Tolerance("bearing_efficiency", normal(sd="0.001"), why="of bearings of one kind"),
]


LITERATURE = [
    "The paper: Han Linshan, Wei Guo, Li Tongtong (韓林山, 魏國, 李彤彤), Automatic gear calculation and strength "
    "calibration of RV reducer, Henan Science and Technology 2024 (13), p. 29, "
    "doi 10.19968/j.cnki.hnkj.1003-5168.2024.13.006.",
    "ISO 6336-1, -2, -3:2006, Calculation of load capacity of spur and helical gears (GB/T 3480).",
    "ISO 1328-1:1995, Cylindrical gears, ISO system of accuracy. ISO 21771:2007, Cylindrical involute gears.",
    "ISO/TS 6336-20, -21, -22 (ISO/TR 13989-1, -2:2000, ISO/TR 15144-1:2014): scuffing by flash and integral "
    "temperature, micropitting by the film of oil.",
    "ISO 281:2007, Rolling bearings, dynamic load ratings and rating life.",
    "Rao Zhengang (饒振綱), Design of planetary gear transmissions, Beijing 2003: sharing among planets.",
]
STRESSES = ("contact_stress_sun", "contact_stress_planet", "root_stress_sun", "root_stress_planet")

RV_GEARING = Model(
    name="rv_gearing",
    title="RV reducer: tooth numbers, and strength of the first gear stage",
    function=rv_gearing,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[
        *(Require(stress, at_most=f"permitted_{stress}") for stress in STRESSES),
        Require("contact_rise", at_most="permitted_contact_rise"),
    ],
    studies=[
        GroupSearch(gives=listed),
        Shifts(),
        Capacity(gives=rating),
        Safeties(over="load_torque", name="load"),
        Safeties(over="face_width", name="face_width"),
        Sensitivity(of=STRESSES),
        Reliability(method=("first_order", "monte_carlo")),
    ],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    cites=LITERATURE,
    example=Path(__file__).with_name("example.toml"),
    summary="Which tooth numbers give the wanted ratio, and do sun and planet carry the load?",
)
