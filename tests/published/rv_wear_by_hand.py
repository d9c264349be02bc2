"""Wear of a cycloid disc by the iteration of the paper, equations 1b to 16, pin by pin, and the price of its zones."""

from math import acos, cos, exp, log, pi, sin, sqrt

HOURS = 6000.0
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


def wear_by_hand(equidistant: float, shift: float, hours: float = HOURS) -> float:
    """Deepest wear (m) by equations 1b to 16, one position and one pin after the other.

    Every solution starts from equation 1.
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
    left = hours * 3600.0 * 15.0 / 60.0 * PITCH  # meshings
    threshold = 0.05e-6
    while True:
        grown = []
        fastest = 0.0
        for place, pins in enumerate(positions):
            worn_off = depths[place]
            scale = solved(pins, worn_off, first, torque, line)
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


# What a zone costs

PRICE_OF = {  # kind of its function, and number of the factor
    "pin_circle_error": ("size", 6), "pin_radius_error": ("size", 7), "modification_error": ("size", 12),
    "pin_position_error": ("place", 10), "disc_pitch_error": ("place", 11), "disc_runout": ("runout", 9),
}  # fmt: skip
FALLING = {"size": (16.140, 0.324), "place": (4.862, 0.483), "runout": (23.729, 0.682)}
REST = {"size": (0.217, 0.013, 2.845), "place": (0.877, 1.020, 0.0)}


def price_by_hand(kind: str, width: float, form: str = "power") -> float:
    """Yuan for a zone of this full width in mm, in a form of the cost functions: power, exponential or process."""
    most, falls = FALLING[kind]
    paid = most * (width**-falls if form == "power" else exp(-falls * width))
    if kind not in REST:
        return paid
    more, slower, always = REST[kind]
    machined = width / (more * width + slower) if form == "process" else more * exp(-slower * width)
    return paid + machined + always
