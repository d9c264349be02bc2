"""The numbers on the theory page of the roller screw are those that the calculation gives."""

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from gear_geometry.pairs import clear_of_base, internal_sliding, involute, working_angle
from pages import Page, number
from roller_screw_shift.calculation import meshing_of, roller_screw_shift
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from truing.calculation import calculate
from truing.setup import default_setup

PAGE = Page("roller_screw_shift")
PAPER = ROLLER_SCREW_SHIFT.inputs()
FOUND = roller_screw_shift(PAPER)
ALPHA = np.radians(20.0)
SHIFTS = (0.21, -0.16)  # of roller and ring, as printed


def printed_constraints(first: str) -> tuple[float, float, float]:
    """Left sides of the printed (9) to (11), where 1 is the roller or the ring; lengths in mm."""
    module, addendum, dedendum, distance = 0.5, 0.8, 1.1, 19.80778
    working = np.arccos(20.0 * np.cos(ALPHA) / distance)
    teeth, outward = {"roller": 20.0, "ring": 100.0}, {"roller": 1.0, "ring": -1.0}
    shift = dict(zip(teeth, SHIFTS, strict=True))
    tip = {name: module * (0.5 * teeth[name] + outward[name] * addendum + shift[name]) for name in teeth}
    root = {name: module * (0.5 * teeth[name] - outward[name] * dedendum + shift[name]) for name in teeth}
    squares = tip["ring"] ** 2 - tip["roller"] ** 2
    crossing = {
        "roller": np.arccos((squares - distance**2) / (2.0 * distance * tip["roller"])),
        "ring": np.arccos((squares + distance**2) / (2.0 * distance * tip["ring"])),
    }
    at_tip = {name: involute(np.arccos(0.5 * module * teeth[name] * np.cos(ALPHA) / tip[name])) for name in teeth}
    second = "ring" if first == "roller" else "roller"
    arcs = [teeth[name] * (crossing[name] + at_tip[name]) for name in (first, second)]
    interference = arcs[0] - arcs[1] + (teeth[second] - teeth[first]) * involute(working)
    apart = tip[second] - tip[first] + distance - 0.1 * module
    clearance = tip[second] - root[first] - distance - 0.1 * module
    return float(interference), apart, clearance


def test_which_gear_is_1_in_the_printed_constraints() -> None:
    as_roller, as_ring = printed_constraints("roller"), printed_constraints("ring")
    for place, (start, digits) in enumerate((("(9), at", (4, 4)), ("(10), at", (2, 3)), ("(11), at", (4, 2)))):
        shown = PAGE.row(start)
        assert shown[0] == number(as_roller[place], digits[0])
        assert shown[1].removesuffix(", violated") == number(as_ring[place], digits[1])
        assert ("violated" in shown[1]) == (as_ring[place] < (0.05 if place == 0 else 0.0))
        assert as_roller[place] >= (0.05 if place == 0 else 0.0)


@pytest.mark.parametrize("start", ["16/80", "18/90", "20/100", "25/125"])
def test_the_printed_pair_with_teeth_of_full_depth(start: str) -> None:
    teeth = tuple(float(text) for text in start.split("/"))
    for shown, (roller, ring) in zip(PAGE.row(start), (SHIFTS[::-1], SHIFTS), strict=True):
        working = working_angle((ring - roller) / (teeth[1] - teeth[0]), ALPHA)
        tips = tuple(
            np.arccos(0.5 * count * np.cos(ALPHA) / (0.5 * count + outward + shift))
            for count, outward, shift in zip(teeth, (1.0, -1.0), (roller, ring), strict=True)
        )
        if "interference" in shown:
            assert clear_of_base((teeth[0], teeth[1]), tips[1], working) <= 0
            continue
        slid = internal_sliding((teeth[0], teeth[1]), (tips[0], tips[1]), working)
        for text, value in zip(re.findall(r"\$ = ([\d.]+)", shown), slid, strict=False):
            assert text == f"{float(value):.{len(text.split('.')[1])}f}"


def test_the_difference_by_roots_folds_as_the_page_says() -> None:
    shifts = np.linspace(0.3, 1.5, 24_001)
    pair = ROLLER_SCREW_SHIFT.inputs(roller_shift=shifts, sliding_reading="roots")
    by_roots = np.asarray(meshing_of(pair).sliding_difference)
    PAGE.says(f"from $x_E$ = {shifts[np.argmax(by_roots)]:.3f} on")
    there = roller_screw_shift(ROLLER_SCREW_SHIFT.inputs(roller_shift=0.9))
    told = f"it says {there.root_sliding_roller:.3f} for the roller while its tip slides by {there.sliding_roller:.3f}"
    PAGE.says(told)


def test_numbers_in_the_text() -> None:
    """The load: the upper end of f2, at the lowest shift that keeps all limits, is the printed 33.2 MPa with 51.943 N.

    The rounded weight of f2 leaves its lower end open: 0.01 stands for 0.005 to 0.015.
    """
    meshes, carrier = float(FOUND.ring_meshes), 3.0 / (2.0 * 4.0)
    gap = (FOUND.root_sliding_roller + meshes * FOUND.tip_sliding_ring) / np.cos(float(FOUND.mounted_angle))
    ends = [33.2 - 2 / np.sqrt(weight) for weight in (0.005, 0.015)]
    PAGE.says(
        f"$n_r z_E/z_I = {meshes:g}$ meshes",
        f"grows by {float(gap / FOUND.sliding_roller):.2f} times the depth",
        rf"$\alpha_w = {np.degrees(FOUND.working_angle):.4f}°$",
        f"$D = {number(float(FOUND.shift_difference), 2).replace('−', '-')}$",
        rf"$|\eta_E| = {FOUND.sliding_roller:.4f}$, $|\eta_I| = {FOUND.sliding_ring:.4f}$",
        f"{float(FOUND.tangential_force):.3f} N for 10 kN",
        f"anything from {ends[0]:.1f} to {ends[1]:.1f} serves",
        f"The contact ratio of its pair is {float(FOUND.contact_ratio):.3f}.",
        f"$k/(2(k + 1)) = {carrier}$ times per turn",
        f"$z_I/z_E$ times as often, {carrier * 5}",
    )


@pytest.mark.parametrize(
    ("start", "low", "high", "weight"), [("f1", 2.68, 5.38, 0.35), ("f2", 0, 33.2, 0.01), ("f3", 0, 3.08, 0.81)]
)
def test_the_printed_weights_do_not_follow_from_the_printed_ranges(
    start: str, low: float, high: float, weight: float
) -> None:
    shown = PAGE.row(f"{start} | {low}")
    assert shown[1] == f"{4 / (high - low) ** 2:.4f}"
    assert shown[2] == f"{weight:g}"
    assert float(shown[3]) == pytest.approx(high - 2 / np.sqrt(weight), abs=6e-3)


@cache
def chosen(reading: str = "path", **inputs: float) -> tuple[Any, Mapping[str, Any]]:
    """The study of the shift with these inputs, and the results of its run."""
    ratios = () if inputs else (1.2,) if reading == "roots" else (1.2, 1.42, 1.423)
    shifting = replace(ROLLER_SCREW_SHIFT.studies[0], points=4001, ratios=ratios)  # type: ignore[type-var]
    setup = default_setup(ROLLER_SCREW_SHIFT, sliding_reading=reading, **inputs)
    done = calculate(replace(setup, studies=(shifting,)))
    return done.outcomes["shift"], done.answers


def test_the_ranges_of_the_objectives() -> None:
    answers = chosen()[1]
    for start, name, scale, digits in (
        ("range of f1", "sum", 1.0, 3), ("range of f2", "stress_difference", 1e-6, 2),
        ("range of f3", "sliding", 1.0, 3),
    ):  # fmt: skip
        ends = PAGE.row(start)[1].replace("−", "-").split(" to ")
        assert ends == [f"{scale * float(answers[f'{end}_{name}']):.{digits}f}" for end in ("least", "most")]
    PAGE.says(f"The lower end of f2 found here, {PAGE.row('range of f2')[1].split()[0]} MPa")


@pytest.mark.parametrize(
    ("start", "limit", "digits"),
    [(r"$x_E$ / $x_I$", 1.4, 4), (r"the same, $\varepsilon_{\min} = 1.42$", 1.42, 4),
     (r"the same, $\varepsilon_{\min} = 1.423$", 1.423, 3), (r"the same, $\varepsilon_{\min} = 1.2$", 1.2, 3)],
)  # fmt: skip
def test_the_lost_limit_decides(start: str, limit: float, digits: int) -> None:
    variants = chosen()[0].variants
    best = next(each.shift for each in variants if (each.least_contact_ratio, each.weights) == (limit, "own_ranges"))
    assert PAGE.row(start)[1] == f"{number(best, digits)} / {number(best + float(FOUND.shift_difference), digits)}"


def test_the_weights_lead_elsewhere_where_no_limit_holds_the_optimum() -> None:
    for reading in ("path", "roots"):
        found = [each.shift for each in chosen(reading)[0].variants if each.least_contact_ratio == 1.2]
        PAGE.says("{:.3f} (own ranges), {:.3f} (printed ranges) and {:.3f} (printed weights)".format(*found))


def test_a_cutter_makes_the_range_of_f2_begin_at_0() -> None:
    """Which the substitute rack cannot give."""
    rack, cut = (chosen(**cutter)[0].field.course for cutter in ({}, {"cutter_teeth": 25.0}))
    assert rack.objectives[1].min() > 27
    assert cut.objectives[1].min() < 0.02
    equal = cut.shifts[np.argmin(cut.objectives[1])]
    PAGE.says("keeps it above 27 MPa", f"are equal at $x_E = {equal:.3f}$")


def test_equal_sliding_alone() -> None:
    shifts = [number(float(chosen()[1][f"equal_sliding_{gear}"]), 4) for gear in ("roller", "ring")]
    assert PAGE.row("equal sliding alone")[1] == " / ".join(shifts)


def test_what_scatter_leaves() -> None:
    """The quantile of the normal law: the shift whose contact ratio is 1.4 with the centres at 2.33 deviations."""
    study, answers = chosen()
    far = ROLLER_SCREW_SHIFT.inputs(centre_distance_deviation=-NormalDist().inv_cdf(0.99) * 10e-6 / 3)
    near = replace(far, centre_distance_deviation=-far.centre_distance_deviation)

    def ratio(shift: float) -> float:
        pairs = (replace(pair, roller_shift=shift) for pair in (far, near))
        return min(float(meshing_of(pair).contact_ratio) for pair in pairs) - 1.4

    robust, best = answers["robust_shift_roller"], answers["optimal_shift_roller"]
    PAGE.says(
        f"{100 * answers['kept_at_optimum']:.1f} % of the screws keep the optimum at {best:.4f}",
        f"that 99 % keep is {robust:.4f}, {best - robust:.3f} lower",
        f"contact ratio of {answers['robust_contact_ratio']:.4f} of the nominal pair",
        f"costs {answers['robust_contact_ratio'] - 1.4:.4f} of",
        f"normal law alone it would be {brentq(ratio, 0.1, 0.3):.4f}",
        f"The printed 0.21 is kept by {100 * answers['kept_as_stated']:.2f} %",
        f"at {best:.4f} it is {study.compared['largest_sliding'][2]:.3f}",
    )
    free = chosen(least_contact_ratio=1.2)[1]
    PAGE.says(f"It is least, {free['gentlest_sliding']:.3f}, where both roots slide alike, at 0.2833")
    assert free["gentlest_shift"] == pytest.approx(answers["equal_sliding_roller"], abs=5e-4)


def test_threads_of_the_page() -> None:
    far = roller_screw_shift(replace(PAPER, support="far_side"))
    large = roller_screw_shift(replace(PAPER, nut_diameter=50.02e-3))
    PAGE.says(
        f"the first thread of the screw carries {FOUND.thread_share_screw:.3f} of the mean",
        f"the nut {FOUND.thread_share_nut:.3f}; held at the far side {far.thread_share_screw:.3f} and "
        f"{far.thread_share_nut:.3f}",
        f"The pressure is {1e-6 * FOUND.thread_pressure_screw:.0f} MPa",
        f"gives way by {1e6 * FOUND.thread_deflection:.2f} µm under 10 kN: {1e-6 * FOUND.axial_stiffness:.0f} N/µm",
        f"Here $K_S$ = {FOUND.life_factor_screw:.3f} and the rating is {1e-3 * FOUND.dynamic_rating:.1f} kN; with 0.86 "
        f"it would be {1e-3 * FOUND.ball_screw_rating:.1f} kN, {20**0.16:.2f} times as much, and the life "
        f"{20**0.48:.1f} times as long",
        f"permits {100 * (1.05**3 - 1):.0f} % more and 4600 MPa {100 * (1.15**3 - 1):.0f} % more",
        f"A nut 20 µm too large makes {1e6 * large.slip_per_turn:.1f} µm of slip",
    )
