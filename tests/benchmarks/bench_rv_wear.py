"""How much faster are the wear histories of many discs in one call than the paper's own iteration, disc by disc?

Run it: ``python -m pytest tests/benchmarks/bench_rv_wear.py -s``. The baseline is that iteration as a plain loop,
written well: geometry is computed once for each disc, and only plain floats and functions of ``math`` are used. It
starts every solution from the force without clearance, as the paper does; starting from the last force saves it a
tenth, and is printed beside it. Both are measured alternately in one process, in time of the processor, and the least
of each counts.
"""

import numpy as np
from timed import least

from published.rv_wear_by_hand import wear_by_hand
from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer
from rv_wear.wear import history_of_group, unworn_of_group, worn

DESIGNS = 1000
BY_HAND = 10  # of them in the plain loop; its time per design hardly varies


def designs(count: int) -> Reducer:
    """Differently ground discs of the paper's reducer, all at its radial clearance."""
    modification = np.linspace(-45e-6, 10e-6, count)
    return RV_WEAR.inputs(equidistant_modification=modification, shift_modification=modification - 4e-6)


def at_once(count: int) -> np.ndarray:
    """All of them in one call that remembers nothing."""
    for remembered in (unworn_of_group, history_of_group):
        remembered.cache_clear()
    return np.asarray(worn(designs(count))["max_wear"])


def by_hand(count: int, *, go_on: bool = False) -> np.ndarray:
    chosen = np.linspace(-45e-6, 10e-6, DESIGNS).tolist()[:: DESIGNS // count][:count]
    return np.array([wear_by_hand(equidistant, equidistant - 4e-6, go_on=go_on) for equidistant in chosen])


def test_both_find_the_same_wear() -> None:
    difference = np.abs(at_once(DESIGNS)[:: DESIGNS // BY_HAND][:BY_HAND] / by_hand(BY_HAND) - 1.0)
    print(f"\nlargest relative difference of the plain loop and one call: {difference.max():.1e} (at most 1e-9)")
    assert difference.max() < 1e-9


def test_one_call_is_a_hundred_times_faster_than_the_plain_loop() -> None:
    at_once(DESIGNS)
    loop, going_on, call = least(
        lambda: by_hand(BY_HAND), lambda: by_hand(BY_HAND, go_on=True), lambda: at_once(DESIGNS)
    )
    loop, going_on, call = loop / BY_HAND, going_on / BY_HAND, call / DESIGNS
    print(f"\nwear to 6000 h per design: plain loop {loop * 1e3:.2f} ms, one call {call * 1e3:.3f} ms: ", end="")
    print(f"{loop / call:.0f} times (plain loop from the last force: {going_on / call:.0f} times)")
    assert loop / call >= 100.0
