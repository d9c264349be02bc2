"""How much faster is the search for tooth numbers than a plain loop in Python?

Run it: ``python -m pytest tests/benchmarks/bench_rv_search.py -s``. All even pin numbers from 20 to 80 are tried. The
plain triple loop runs over the same bounds: pins, suns, planets. Beside it a loop that skips every planet whose ratio
cannot do, as the search does; both must find what the search finds.
"""

import math
from collections.abc import Iterator

from timed import least

from rv_gearing.groups import candidates, search
from rv_gearing.model import RV_GEARING

STAGE = RV_GEARING.inputs(fewest_pins=20, most_pins=80)
Group = tuple[int, int, int]


def limits() -> tuple[range, range, range]:
    """The bounds that the search works out: pins, suns, planets."""
    tried = candidates(STAGE)
    pins, suns, planets = (
        range(int(each.min()), int(each.max()) + 1) for each in (tried.pins, tried.sun, tried.planet)
    )
    return range(pins.start, pins.stop, 2), suns, planets


def meets(sun: int, planet: int, pins: int) -> bool:
    """The conditions of the paper for one group."""
    ratio = 1 + planet * pins / sun
    if abs(ratio - 111) / 111 > 0.01 or planet < 1.5 * sun:
        return False
    k, u = pins / (pins - 1), planet / sun
    mesh = (k - 1) * (k - 0.998 + u * k * 0.992) / ((k - 0.998) * (k - 1 + u * k))
    size = (9_550_000 * 2.26 / 15 * mesh * 0.99**3) ** (1 / 3)
    return 0.5 * 0.85 * size <= 1.25 * (sun + planet) / 2 <= 0.6 * 1.3 * size


def plain_loop() -> list[Group]:
    """Every pin, sun and planet number within the bounds."""
    pins, suns, planets = limits()
    return [(sun, planet, pin) for pin in pins for sun in suns for planet in planets if meets(sun, planet, pin)]


def skipping_loop() -> list[Group]:
    """The same, past every planet whose ratio cannot do."""

    def near(pin: int, sun: int) -> Iterator[int]:
        low = max(1.5, (111 * 0.99 - 1) / pin)
        first, last = math.ceil(low * sun - 1e-9), math.floor((111 * 1.01 - 1) / pin * sun + 1e-9)
        return iter(range(max(first, planets.start), min(last, planets.stop - 1) + 1))

    pins, suns, planets = limits()
    return [(sun, planet, pin) for pin in pins for sun in suns for planet in near(pin, sun) if meets(sun, planet, pin)]


def found() -> list[Group]:
    """What the search finds."""
    groups = search(STAGE)
    return [(int(s), int(p), int(z)) for s, p, z in zip(groups.sun, groups.planet, groups.pins, strict=True)]


def test_the_loops_find_what_the_search_finds() -> None:
    assert plain_loop() == found() == skipping_loop()
    assert len(found()) == 687


def test_search_is_at_least_ten_times_the_plain_loop() -> None:
    plain, skipping, own = least(plain_loop, skipping_loop, lambda: [search(STAGE) for _ in range(20)])
    print(f"\nplain triple loop over search: {20 * plain / own:.0f} (at least 10); ", end="")
    print(f"loop that skips: {20 * skipping / own:.1f}")
    assert 20 * plain / own >= 10.0
