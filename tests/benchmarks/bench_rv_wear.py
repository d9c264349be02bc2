"""How much faster are the wear histories of many discs in one call than the paper's own iteration, disc by disc?

Run it: ``python -m pytest tests/benchmarks/bench_rv_wear.py --benchmark-enable -s``, or as a script, which prints the
figures. The baseline is that iteration as a plain loop, written well: geometry is computed once for each disc, and only
plain floats and functions of ``math`` are used. It starts every solution from the force without clearance, as the paper
does; starting from the last force saves it a tenth, and is printed beside it. Both are measured alternately in one
process, in time of the processor, and the least of each counts. The second
question is what the reliability of the backlash costs beside drawing its random numbers.
"""

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from math import acos, cos, log, pi, sin, sqrt

import numpy as np
import pytest

from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer
from rv_wear.wear import history_of_group, history_of_one, unworn_of_group, unworn_of_one, worn
from truing import Reliability
from truing.calculation import calculate
from truing.kernel import Kernel
from truing.setup import Setup, default_setup
from truing.studies.sampling import scatter_of

DESIGNS = 1000
BY_HAND = 10  # of them in the plain loop; its time per design hardly varies
HOURS = 6000.0
BATCH = 2**14
ROUNDS = 3
PITCH, TEETH, PHASES = 40, 39, 8
CLOSE = 1e-10

Pin = tuple[float, float, float, float]


def contacts(equidistant: float, shift: float, place: float) -> list[Pin]:
    """Relative arm, arm, clearance and wear per force^2.219 of the pins in one position; new disc, SI."""
    throw, circle, pin, width, modulus = 0.0022, 0.1145, 0.005, 0.02, 2.06e11 / (1.0 - 0.3**2)
    k_1 = throw * PITCH / circle
    q = sqrt(1.0 - k_1 * k_1)
    k_oil = 3.981e29 / modulus * (2.2e-8 * modulus) ** -7.377
    found = []
    for number in range(PITCH // 2):
        psi = 2.0 * pi * (number + place) / PITCH
        s = sqrt(1.0 + k_1 * k_1 - 2.0 * k_1 * cos(psi))
        arm = sin(psi) / s
        gap = equidistant * (1.0 - arm) - shift * (1.0 - k_1 * cos(psi) - q * sin(psi)) / s
        bend = (k_1 * (PITCH + 1) * cos(psi) - 1.0 - PITCH * k_1 * k_1) / s**2
        radius = pin * abs(1.0 + pin * bend / (circle * s))
        sliding = (circle * s - pin) / abs(circle * s + pin * bend)
        k = k_oil * (1.0 / (width * modulus * radius)) ** 1.219 * (0.694e-6 / radius) ** 1.589
        found.append((arm, arm * throw * TEETH, gap, k * sliding / width))
    return found


def solved(pins: list[Pin], worn_off: list[float], start: float, torque: float, line: tuple[float, float]) -> float:
    """Force at the longest arm by the paper's iteration, equations 1b to 4 in turn from a start value."""
    compliance, number = line
    gaps = [gap + depth for (_, _, gap, _), depth in zip(pins, worn_off, strict=True)]
    taken = min(gap / arm for gap, (arm, _, _, _) in zip(gaps, pins, strict=True))
    near = [(arm, lever, gap - arm * taken) for (arm, lever, _, _), gap in zip(pins, gaps, strict=True)]
    force = start
    while True:
        approach = compliance * force * (number - log(force))
        total = 0.0
        for arm, lever, gap in near:
            share = arm - gap / approach
            if share > 0.0:
                total += share * lever
        new = torque / total
        if abs(new - force) <= CLOSE * force:
            return new
        force = 0.5 * (force + new)


def wear_by_hand(equidistant: float, shift: float, hours: float = HOURS, *, go_on: bool = False) -> float:
    """Deepest wear (m) by equations 1b to 16, one position and one pin after the other.

    Every solution starts from equation 1 or, with ``go_on``, from the last force.
    """
    torque = 0.55 * 3136.0
    k_1, compliance = 0.0022 * PITCH / 0.1145, 2.0 * (1.0 - 0.3**2) / (pi * 2.06e11 * 0.02)
    s = sin(acos(k_1))
    bend = (k_1 * k_1 - 1.0) / (0.1145 * s**3)
    rho, radius = abs(1.0 / bend + 0.005), 0.005 * abs(1.0 + 0.005 * bend)
    line = compliance, 2.0 / 3.0 + log(0.005 * rho / (compliance * radius))
    positions = [contacts(equidistant, shift, (place + 0.5) / PHASES) for place in range(PHASES)]
    depths = [[0.0] * len(pins) for pins in positions]
    first = 4.0 * torque / (k_1 * TEETH * 0.1145)
    scales = [first] * PHASES
    left = hours * 3600.0 * 15.0 / 60.0 * PITCH  # meshings
    threshold = 0.05e-6
    while True:
        grown = []
        fastest = 0.0
        for place, pins in enumerate(positions):
            worn_off = depths[place]
            scale = scales[place] = solved(pins, worn_off, scales[place] if go_on else first, torque, line)
            approach = compliance * scale * (line[1] - log(scale))
            taken = min((gap + depth) / arm for (arm, _, gap, _), depth in zip(pins, worn_off, strict=True))
            here = []
            for (arm, _, gap, rate), depth in zip(pins, worn_off, strict=True):
                share = arm - (gap + depth - arm * taken) / approach
                here.append(rate * (scale * share) ** 2.219 if share > 0.0 else 0.0)
            grown.append(here)
            fastest = max(fastest, max(here))
        lasts = min(threshold / fastest, left)
        for worn_off, here in zip(depths, grown, strict=True):
            for pin, rate in enumerate(here):
                worn_off[pin] += rate * lasts
        left -= lasts
        if left <= 0.0:
            return max(max(worn_off) for worn_off in depths)


def designs(count: int) -> Reducer:
    """Differently ground discs of the paper's reducer, all at its radial clearance."""
    modification = np.linspace(-45e-6, 10e-6, count)
    return RV_WEAR.inputs(equidistant_modification=modification, shift_modification=modification - 4e-6)


def at_once(count: int) -> np.ndarray:
    """All of them in one call that remembers nothing."""
    for remembered in (unworn_of_group, unworn_of_one, history_of_group, history_of_one):
        remembered.cache_clear()
    return np.asarray(worn(designs(count))["max_wear"])


def by_hand(count: int, *, go_on: bool = False) -> np.ndarray:
    chosen = np.linspace(-45e-6, 10e-6, DESIGNS).tolist()[:: DESIGNS // count][:count]
    return np.array([wear_by_hand(equidistant, equidistant - 4e-6, go_on=go_on) for equidistant in chosen])


def seconds(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def seconds_per_design() -> tuple[float, float, float]:
    """Least seconds per design of the plain loop, of the plain loop that goes on from the last force, of one call."""
    at_once(DESIGNS)
    works: list[Callable[[], object]] = [
        lambda: by_hand(BY_HAND),
        lambda: by_hand(BY_HAND, go_on=True),
        lambda: at_once(DESIGNS),
    ]
    loop, going_on, call = (min(each) for each in zip(*(map(seconds, works) for _ in range(ROUNDS)), strict=True))
    return loop / BY_HAND, going_on / BY_HAND, call / DESIGNS


def told(loop: float, going_on: float, call: float) -> str:
    return (
        f"wear to 6000 h per design: plain loop {loop * 1e3:.2f} ms, one call {call * 1e3:.3f} ms: "
        f"{loop / call:.0f} times (plain loop from the last force {going_on * 1e3:.2f} ms: {going_on / call:.0f} times)"
    )


def test_both_find_the_same_wear() -> None:
    difference = np.abs(at_once(DESIGNS)[:: DESIGNS // BY_HAND][:BY_HAND] / by_hand(BY_HAND) - 1.0)
    print(f"\nlargest relative difference of the plain loop and one call: {difference.max():.1e} (at most 1e-9)")
    assert difference.max() < 1e-9


def test_one_call_is_a_hundred_times_faster_than_the_plain_loop() -> None:
    loop, going_on, call = seconds_per_design()
    print(f"\n{told(loop, going_on, call)}")
    assert loop / call >= 100.0


def drawing_only(draws: int, sources: int) -> None:
    """The baseline: the random numbers alone, always into the same memory."""
    rng, store = np.random.Generator(np.random.SFC64(0)), np.empty(BATCH)
    for _ in range(-(-draws // BATCH) * sources):
        rng.standard_normal(out=store)


def reducers() -> Setup:
    offer = Kernel.installed(strict=True).offer("rv_wear")
    return default_setup(offer.model, offer.origin)


def reliability(setup: Setup, draws: int) -> object:
    """The chance of the backlash at the working time, as ``calc run`` finds it."""
    study = Reliability(draws=draws, batch=BATCH, method=("first_order", "monte_carlo"))
    return calculate(replace(setup, studies=(study,))).outcomes["reliability"]


def reliability_ratio(draws: int) -> tuple[float, float]:
    """Least seconds of drawing alone and of the whole study."""
    setup = reducers()
    sources = len(scatter_of(setup).columns)
    reliability(setup, 100_000)
    pairs = [
        (seconds(lambda: drawing_only(draws, sources)), seconds(lambda: reliability(setup, draws)))
        for _ in range(ROUNDS)
    ]
    return min(first for first, _ in pairs), min(second for _, second in pairs)


@pytest.mark.parametrize("draws", [10_000_000])
def test_reliability_costs_at_most_twice_its_random_numbers(draws: int) -> None:
    drawing, whole = reliability_ratio(draws)
    print(f"\n{draws} machines: the whole reliability over drawing alone: {whole / drawing:.2f} (at most 2.0)")
    assert whole / drawing <= 2.0


if __name__ == "__main__":
    print(told(*seconds_per_design()))
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    baseline, study = reliability_ratio(number)
    print(f"{number} machines: drawing {baseline:.3f} s, reliability {study:.3f} s: {study / baseline:.2f} times")
