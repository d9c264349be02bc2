"""The threads of the roller screw against networks, quadrature and closed forms of their own."""

from dataclasses import replace
from math import acosh, cosh, sinh
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve, root

from roller_screw_shift import threads
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.quantities import Pair

STEEL = 208e9 / (2.0 * (1.0 - 0.3**2))


def pair_of(**changes: Any) -> Pair:
    return replace(ROLLER_SCREW_SHIFT.inputs(), **changes)


def answer_of(pair: Pair) -> Any:
    return ROLLER_SCREW_SHIFT.function(pair)


# One contact


def pressed(at: complex, semi: complex, peak: float) -> float:
    """How far a half space gives way at a point under the pressure of an ellipse: rays from that point.

    p/(pi E* r) over the area is p/(pi E*) along every ray; the square of the pressure is quadratic on it.
    """
    angle = (np.arange(20_000) + 0.5) * np.pi / 20_000
    across, up = np.cos(angle) / semi.real, np.sin(angle) / semi.imag
    a = across**2 + up**2
    b = at.real / semi.real * across + at.imag / semi.imag * up
    c = (at.real / semi.real) ** 2 + (at.imag / semi.imag) ** 2 - 1.0
    along = 0.5 * np.pi * (b**2 - a * c) / a**1.5  # of sqrt(-(a r² + 2 b r + c)) between its ends
    return float(peak * along.mean() / STEEL)


@pytest.mark.parametrize(("one", "other"), [(141.0, 188.6), (141.0, 113.1), (20.0, 700.0)])
def test_an_ellipse_of_hertz_closes_the_gap(one: float, other: float) -> None:
    """The surfaces as pressed touch all over the ellipse: their first gap is what they give way less, by rays."""
    force, contact = 71.0, threads.ellipse(one, other, STEEL)

    def misses(semi: Any) -> list[float]:
        peak = 1.5 * force / (np.pi * semi[0] * semi[1]) * 1e8
        whole = complex(semi[0], semi[1]) * 1e-4
        middle = pressed(0j, whole, peak)
        beside = middle - pressed(0.5 * whole.real + 0j, whole, peak), middle - pressed(0.5j * whole.imag, whole, peak)
        return [beside[0] / (0.125 * one * whole.real**2) - 1.0, beside[1] / (0.125 * other * whole.imag**2) - 1.0]

    semi = np.abs(fsolve(misses, [1.0, 1.0 * one / other], xtol=1e-12))
    peak = 1.5 * force / (np.pi * semi[0] * semi[1]) * 1e8
    assert np.max(np.abs(misses(semi))) < 1e-9
    assert contact.pressure * force ** (1 / 3) == pytest.approx(peak, rel=1e-7)
    assert contact.approach * force ** (2 / 3) == pytest.approx(pressed(0j, complex(*semi) * 1e-4, peak), rel=1e-7)


def test_a_round_contact_is_that_of_a_ball() -> None:
    """Johnson (1985), 4.22 to 4.24: approach (9 Q²/(16 R E*²))^(1/3), pressure (6 Q E*²/(pi³ R²))^(1/3)."""
    contact = threads.ellipse(np.array([100.0, 100.0]), np.array([100.0, 100.0 * (1 + 1e-4)]), STEEL)
    assert contact.approach == pytest.approx((9 * 100 / (16 * STEEL**2)) ** (1 / 3), rel=4e-5)
    assert contact.pressure == pytest.approx((6 * STEEL**2 * 100**2 / np.pi**3) ** (1 / 3), rel=4e-5)


# Their sharing of the load


def test_rigid_rollers_in_a_rigid_nut_share_as_a_ladder_of_springs() -> None:
    """Springs k from a bar k_b to the ground: cosh((n - i + 1/2) t), 2 sinh(t/2) = sqrt(k/k_b), i from 1."""
    count, soft, bar = 12, 1e-8, 3e8
    bars, nothing = np.array([[bar, 1e6 * bar, 1e6 * bar]]), np.array([[1e-18, 1e-18]])
    forces, way = threads.ladder(
        np.array([500.0]), bars, nothing, np.array([soft]), np.zeros((1, count)), far=False,
    )  # fmt: skip
    turn = acosh(1.0 + 0.5 / (soft * bar))
    wanted = np.array([cosh((count - place - 0.5) * turn) for place in range(count)])
    assert forces[0, :, 0] == pytest.approx(500.0 * wanted / wanted.sum(), rel=2e-4)
    assert wanted.sum() == pytest.approx(sinh(count * turn) / (2 * sinh(0.5 * turn)), rel=1e-12)
    assert way[0] == pytest.approx(soft * (forces[0, 0, 0] + 500.0 / count), rel=1e-3)


CASES = [
    {}, {"support": "far_side"}, {"screw_diameter": 21e-3, "roller_diameter": 7e-3, "nut_outside": 45e-3},
    {"thread_compliance": 2e-9}, {"roller_pitch_deviation": 0.4e-6}, {"roller_pitch_deviation": -2e-6},
    {"axial_load": -1e5, "screw_bore": 20e-3},
]  # fmt: skip


@pytest.mark.parametrize("changed", CASES)
def test_sharing_against_a_network_of_its_own(changed: dict[str, Any]) -> None:
    """All forces unknown: what bodies stretch between neighbours must fit what contacts give way, one equation each."""
    pair = pair_of(**changed, thread_turns=14, centre_distance=19.80778e-3)
    shared = threads.sharing_of(pair)
    count, load = 14, abs(pair.axial_load) / pair.rollers
    nut = pair.screw_diameter + 2 * pair.roller_diameter
    along = np.sin(np.pi / 4) / np.sqrt(1 + (pair.lead / (np.pi * pair.screw_diameter)) ** 2)
    laws = [
        threads.ellipse(2 * np.cos(np.pi / 4) / pair.roller_diameter,
                        2 * np.cos(np.pi / 4) * (1 / pair.roller_diameter + sign / size), STEEL).approach
        for sign, size in ((1, pair.screw_diameter), (-1, nut))
    ]  # fmt: skip
    area = {
        "screw": (pair.screw_diameter**2 - pair.screw_bore**2) / pair.rollers, "roller": pair.roller_diameter**2,
        "nut": (pair.nut_outside**2 - nut**2) / pair.rollers,
    }  # fmt: skip
    bar = {name: 2e-3 / (208e9 * np.pi / 4 * value) for name, value in area.items()}
    far = pair.support == "far_side"

    def ways(forces: Any) -> Any:
        """Ways of screw, roller and nut at every thread but for one constant each."""
        screw, on_nut = forces
        inner = load - np.cumsum(screw)[:-1]  # compressed
        roller = np.cumsum(on_nut - screw)[:-1]
        held = -np.cumsum(on_nut)[:-1] if far else load - np.cumsum(on_nut)[:-1]
        sums = (bar["screw"] * -inner, bar["roller"] * roller, bar["nut"] * held)
        return [np.concatenate([[0.0], np.cumsum(each)]) for each in sums]

    ahead = pair.roller_pitch_deviation * (np.arange(count) - 0.5 * (count - 1))

    def misses(unknown: Any) -> Any:
        pressed_by = unknown[: 2 * count].reshape(2, count)
        forces = np.maximum(pressed_by, 0.0)
        apart, of_nut = unknown[2 * count :]
        screw, roller, held = ways(forces)
        gap = np.minimum(pressed_by, 0.0) * 1e-8
        deep = [
            law * (each / along) ** (2 / 3) / along + pair.thread_compliance * each
            for law, each in zip(laws, forces, strict=True)
        ]
        fits = (screw + apart * 1e-6 - roller - ahead - deep[0] - gap[0],
                roller + ahead + of_nut * 1e-6 - held - deep[1] - gap[1])  # fmt: skip
        balance = (forces.sum(axis=1) / load - 1.0) * 1e6
        return np.concatenate([*(1e6 * each for each in fits), balance * 1e-6])

    start = np.concatenate([np.full(2 * count, load / count), [5.0, 5.0]])
    near = np.concatenate([(np.stack([shared.screw, shared.nut]) * load / count + 0.02 * load / count).ravel(), [5, 5]])
    best = min((root(misses, first, method=how, tol=1e-13) for first in (start, near) for how in ("hybr", "lm")),
               key=lambda found: np.abs(found.fun).max())  # fmt: skip
    assert np.abs(best.fun).max() < 1e-8
    forces = np.maximum(best.x[: 2 * count].reshape(2, count), 0.0)
    assert shared.screw == pytest.approx(forces[0] * count / load, abs=2e-6)
    assert shared.nut == pytest.approx(forces[1] * count / load, abs=2e-6)
    _, _, held = ways(forces)
    way = (best.x[-2] + best.x[-1]) * 1e-6 - (held[-1] if far else 0.0) + abs(pair.roller_pitch_deviation) * (count - 1)
    assert shared.deflection == pytest.approx(way, rel=1e-5)


def test_samples_are_those_of_calls_one_by_one() -> None:
    loads = np.array([0.0, 3e3, -3e3, 4e4, 3e3])
    whole = threads.sharing_of(pair_of(axial_load=loads, nut_outside=np.array([0.07, 0.07, 0.07, 0.09, np.nan])))
    for place, load in enumerate(loads[:4]):
        one = threads.sharing_of(pair_of(axial_load=load, nut_outside=0.09 if place == 3 else 0.07))
        assert whole.screw[place] == pytest.approx(one.screw, rel=1e-12)
        assert whole.deflection[place] == pytest.approx(one.deflection, rel=1e-12)
    assert whole.deflection[0] == 0.0
    assert whole.deflection[1] == whole.deflection[2]
    assert np.isnan(whole.deflection[4])


def test_stiff_bodies_share_alike_and_give_way_as_hertz() -> None:
    """Two contacts behind one another, each with the mean load."""
    pair = pair_of(elastic_modulus=208e9, lead=1e-9, nut_outside=10.0)
    answer = answer_of(pair)
    assert answer.thread_share_screw == pytest.approx(1.0, abs=1e-6)
    force = 1e4 / 200 * np.sqrt(2)
    bends = (1 / 10e-3 + 1 / 30e-3, 1 / 10e-3 - 1 / 50e-3)
    way = sum(threads.ellipse(np.sqrt(2) / 10e-3, np.sqrt(2) * bend, STEEL).approach for bend in bends)
    assert answer.thread_deflection == pytest.approx(np.sqrt(2) * way * force ** (2 / 3), rel=1e-6)


# Life


def test_one_thread_more_loaded_shortens_the_life_as_the_weakest_link_does() -> None:
    """Lives (C/Q)³ of all contacts, their survival multiplied with Weibull's slope 10/9, ended where 90 % survive."""
    pair = pair_of(axial_load=6e4, screw_diameter=21e-3, roller_diameter=7e-3, centre_distance=19.80778e-3)
    answer, shared = answer_of(pair), threads.sharing_of(pair)

    def survive(turns: float, shares: Any) -> float:
        lives = [(rating / (share * answer.acting_load)) ** 3
                 for rating, side in zip((answer.screw_rating, answer.nut_rating), shares, strict=True)
                 for share in side]  # fmt: skip
        return float(np.log(0.9) * sum((turns / life) ** (10 / 9) for life in lives) - np.log(0.9))

    alike = brentq(survive, 1e-12, 1e12, args=([np.ones(20), np.ones(20)],), xtol=1e-15, rtol=1e-13)
    uneven = brentq(survive, 1e-12, 1e12, args=([shared.screw, shared.nut],), xtol=1e-15, rtol=1e-13)
    # the exponent of the threads, from the same survival: one thread of each side alone, and 20 alike
    one = brentq(survive, 1e-12, 1e12, args=([np.ones(1), np.ones(1)],), xtol=1e-15, rtol=1e-13)
    assert 20 * (alike / one) ** (1 / 3) == pytest.approx(20**threads.OF_ROWS, rel=1e-9)
    without = 1e6 * (answer.dynamic_rating / answer.acting_load) ** 3
    assert answer.thread_life / without == pytest.approx(uneven / alike, rel=1e-9)
    assert uneven < 0.95 * alike


PRINTED = {
    45: {0.01: 42.1, 0.03: 58.2, 0.06: 70.7, 0.10: 79.7, 0.14: 84.1, 0.18: 85.5, 0.22: 84.9, 0.26: 82.8, 0.30: 79.6},
    60: {0.01: 39.2, 0.05: 62.6, 0.10: 74.2, 0.20: 79.5},
    75: {0.01: 37.3, 0.10: 70.7},
}
"""Machinery's Handbook, 31st edition, Ball and Roller Bearings, table 29: f_c of thrust ball bearings, N and mm."""


@pytest.mark.parametrize("degrees", PRINTED)
def test_in_grooves_the_rating_is_that_of_thrust_ball_bearings(degrees: int) -> None:
    """C = f_c cos(a)^0.7 tan(a) Z^(2/3) D^1.8; grooves of 0.535 D raise it by (2 f/(2 f - 1))^0.41."""
    angle, grooves = np.radians(degrees), (2 * 0.535 / (2 * 0.535 - 1.0)) ** 0.41
    for ratio, printed in PRINTED[degrees].items():
        roller = 8e-3 * np.cos(angle)
        pair = pair_of(contact_angle=angle, roller_diameter=roller, screw_diameter=roller * (1 / ratio - 1), lead=1e-12,
                       nut_outside=2.0)  # fmt: skip
        rating = threads.life_of(pair, threads.sharing_of(pair))["dynamic_rating"] / 20**0.7
        factor = grooves * rating / (np.cos(angle) ** 0.7 * np.tan(angle) * 10 ** (2 / 3) * 8**1.8)
        assert factor == pytest.approx(printed, rel=2e-3)


def test_the_rating_of_large_balls_meets_that_of_small_ones() -> None:
    """25.4 mm: 3.647 D^1.4 is D^1.8 there, to the digits of the standard."""
    ratings = [
        threads.life_of(pair, threads.sharing_of(pair))["screw_rating"]
        for pair in (pair_of(roller_diameter=size * np.sqrt(0.5), nut_outside=0.2) for size in (0.025399, 0.025401))
    ]
    assert ratings[1] == pytest.approx(ratings[0], rel=5e-4)


# Threads against teeth


def test_slip_is_the_way_of_two_surfaces_that_do_not_roll() -> None:
    """Turn by turn in small steps: arcs that the roller and the nut lay behind them at their contact."""
    pair = pair_of(nut_diameter=50.2e-3)
    answer = answer_of(pair)
    carrier = 30.0 / (30.0 + 10.0 * 5.0)  # turns per turn of the screw at which its thread rolls on the roller
    screw = (1.0 - carrier) * np.pi * 30e-3
    roller = carrier * 5.0 * np.pi * 10e-3
    assert screw == pytest.approx(roller, rel=1e-12)
    assert answer.slip_per_turn == pytest.approx(carrier * np.pi * 50.2e-3 - roller, rel=1e-9)
    assert answer.ratio_mismatch == pytest.approx(0.004, rel=1e-9)
    assert answer.migration_per_turn == 0.0
    crept = answer_of(pair_of(starts=4))
    assert crept.migration_per_turn == pytest.approx(carrier * (10e-3 - 2.5e-3 * 5.0), rel=1e-12)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"nut_outside": 0.049}, "the nut has no wall"), ({"screw_bore": 0.031}, "the screw has no wall"),
        ({"nut_diameter": 0.009}, "no wider than a roller"),
    ],
)  # fmt: skip
def test_bodies_that_are_not_there_are_refused(changed: dict[str, float], words: str) -> None:
    with pytest.raises(Exception, match=words):
        answer_of(pair_of(**changed))
