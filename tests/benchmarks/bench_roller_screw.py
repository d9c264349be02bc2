"""How much faster are 100 000 profile shifts in one call than a plain loop, and what does Box's method need?

Run it: ``python -m pytest tests/benchmarks/bench_roller_screw.py -s``. The baseline is a plain loop written well (what
does not change with the shift is computed once, and only floats and functions of ``math`` are used) of objectives and
margins. Both are measured alternately in one process, in time of the processor; the least of each counts.
"""

from dataclasses import replace
from math import acos, cos, pi, sin, sqrt, tan

import numpy as np
from timed import least

from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.objectives import course_of, weights_of
from roller_screw_shift.optimum import READINGS, Plan, box_optimum, field_of, grid_optimum
from roller_screw_shift.quantities import Pair

SHIFTS = 100_000
PLAIN = 5000
SPAN = (-2.0, 3.0)
SEEDS = 20
ALPHA, ROLLER, RING, ADDENDUM, DEPTH, ROUNDING, RING_ROUNDING = pi / 9, 20, 100, 0.8, 1.1, 0.3, 0.15
CENTRES, STRESS = 19.80778 / 0.5, 51.943 / (4.0 * 0.5)


def inv(angle: float) -> float:
    return tan(angle) - angle


def by_hand(shifts: list[float]) -> list[tuple[float, ...]]:
    """Objectives and the margins g1 to g10 of these shifts, one after the other, in modules and MPa."""
    working = acos(0.5 * (RING - ROLLER) * cos(ALPHA) / CENTRES)
    difference = (RING - ROLLER) * (inv(working) - inv(ALPHA)) / (2 * tan(ALPHA))
    at, at_inv, standard, base, ring_base = tan(working), inv(working), inv(ALPHA), 10 * cos(ALPHA), 50 * cos(ALPHA)
    offset = pi / 4 - DEPTH * tan(ALPHA) - (1 - sin(ALPHA)) * ROUNDING / cos(ALPHA)
    constant = 2 / ROLLER * (pi / 2 - offset) - pi / 3
    chord = 2 * (pi / 4 + (DEPTH - RING_ROUNDING) * tan(ALPHA) + RING_ROUNDING * (1 / cos(ALPHA) - cos(pi / 6)))
    height = DEPTH + ADDENDUM
    arm = height - (pi / 4 + (DEPTH - height) * tan(ALPHA)) * tan(ALPHA) - RING_ROUNDING / 2
    ring_stress = 6 * arm / chord**2 * corrected(chord, arm, RING_ROUNDING)
    least = DEPTH - ROUNDING * (1 - sin(ALPHA)) - ROLLER / 2 * sin(ALPHA) ** 2
    found: list[tuple[float, ...]] = []
    for x in shifts:
        tip, ring_tip = 10 + ADDENDUM + x, 50 - ADDENDUM + x + difference
        angle, ring_angle = acos(base / tip), acos(ring_base / ring_tip)
        outer, inner = tan(angle) - at, at - tan(ring_angle)
        room = ROLLER * at - RING * inner
        own, other = 80 * inner / room, 80 * outer / (RING * at + ROLLER * outer)
        half = (pi / 2 + 2 * x * tan(ALPHA)) / ROLLER + standard - inv(angle)
        squares = ring_tip**2 - tip**2
        crossing = acos((squares - CENTRES**2) / (2 * CENTRES * tip))
        ring_crossing = acos((squares + CENTRES**2) / (2 * CENTRES * ring_tip))
        passing = ROLLER * (crossing + inv(angle)) - RING * (ring_crossing + inv(ring_angle)) + 80 * at_inv
        stress = roller_stress(x, tip, angle - half, half, constant)
        sliding = abs(abs(own) - abs(other))
        found.append(
            (
                2 * x + difference, STRESS * abs(stress - ring_stress), sliding, ring_tip / ring_base - 1,
                tip / base - 1, (ROLLER * outer + RING * inner) / (2 * pi) - 1.4, passing - 0.05,
                ring_tip - tip + CENTRES - 0.1, ring_tip - (10 - DEPTH + x) - CENTRES - 0.1,
                50 + DEPTH + x + difference - tip - CENTRES - 0.1, room, x - least, 2 * tip * half - 0.25,
                3.08 - sliding,
            )
        )  # fmt: skip
    return found


def roller_stress(x: float, tip: float, angle: float, half: float, constant: float) -> float:
    """Y_Fa Y_Sa of the roller."""
    depth = ROUNDING - DEPTH + x
    theta = pi / 6
    for _ in range(5):
        slope = 2 * depth / ROLLER
        theta -= (theta - slope * tan(theta) + constant) / (1 - slope / cos(theta) ** 2)
    chord = ROLLER * sin(pi / 3 - theta) + sqrt(3) * (depth / cos(theta) - ROUNDING)
    fillet = ROUNDING + 2 * depth**2 / (cos(theta) * (ROLLER * cos(theta) ** 2 - 2 * depth))
    reach = (cos(half) - sin(half) * tan(angle)) * 2 * tip - ROLLER * cos(pi / 3 - theta) - depth / cos(theta)
    arm = 0.5 * (reach + ROUNDING)
    return 6 * arm * cos(angle) / (chord**2 * cos(ALPHA)) * corrected(chord, arm, fillet)


def corrected(chord: float, arm: float, fillet: float) -> float:
    """Y_Sa."""
    length = chord / arm
    power: float = (chord / (2 * fillet)) ** (1 / (1.21 + 2.3 / length))
    return (1.2 + 0.13 * length) * power


def allowed(count: int) -> np.ndarray:
    """Shifts at which every number exists."""
    return np.linspace(-0.2, 1.0, count)


def pair() -> Pair:
    found: Pair = ROLLER_SCREW_SHIFT.inputs()
    return found


def test_the_plain_loop_finds_the_same() -> None:
    shifts = allowed(601)
    course = course_of(pair(), shifts)
    ours = np.array([*course.objectives, *course.margins.values()]).T
    away = np.abs(ours - np.array(by_hand(shifts.tolist()))) / np.maximum(np.abs(ours), 1.0)
    print(f"\nlargest difference of the plain loop and one call: {away.max():.1e} (at most 1e-9)")
    assert away.max() < 1e-9


def test_one_call_is_five_times_faster_than_a_plain_loop() -> None:
    told, plain = pair(), allowed(PLAIN).tolist()
    loop, course = least(lambda: by_hand(plain), lambda: course_of(told, allowed(SHIFTS)))
    loop, course = 1e6 * loop / PLAIN, 1e6 * course / SHIFTS
    print(f"\nobjectives and margins per shift: plain loop {loop:.1f} us, one call {course:.2f} us: ", end="")
    print(f"{loop / course:.0f} times")
    assert loop / course >= 5.0


def box_evaluations() -> list[tuple[float, str, float, float]]:
    """Least contact ratio, reading of the weights, mean evaluations of Box's method, largest distance from the grid."""
    found = []
    for ratio in (1.2, 1.4):
        field = field_of(replace(pair(), least_contact_ratio=ratio), SPAN, 20_001)
        assert field is not None
        for reading in READINGS:
            weights = weights_of(reading, field.ranges)
            grid = grid_optimum(field, weights)
            runs = [box_optimum(field, weights, SPAN, np.random.default_rng(seed), Plan()) for seed in range(SEEDS)]
            away = max(abs(float(run.point[0]) - grid) for run in runs)
            found.append((ratio, reading, float(np.mean([run.evaluations for run in runs])), away))
    return found


def test_box_needs_a_twentieth_of_the_dense_grid() -> None:
    for ratio, reading, evaluations, away in box_evaluations():
        print(f"\ncontact ratio {ratio:g}, {reading}: {evaluations:.0f} evaluations, {away:.1e} from the grid", end="")
        assert evaluations < 20_001 / 20
        assert away < 2e-6
