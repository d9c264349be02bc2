"""Sizes in words: numbers with units and intervals, a wave by its amplitude and phase, how often chance does it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from truing.diagnosis.result import FAMILIES, WAVE_PART, Amount, FittedUnknown, reads_well
from truing.numbers import ABSENT, format_number, format_value, pretty, with_unit
from truing.units import from_si, unit_text

TO = " … "


def amount_text(amount: Amount | None, digits: int = 3) -> str:
    """Write a number with its unit, as many digits as carry meaning."""
    if amount is None:
        return ABSENT
    number, unit = format_value(amount.value, amount.unit, digits)
    return with_unit(pretty(number), unit)


def readable(amount: Amount | None) -> Amount | None:
    """Return a size in a unit in which it reads well: 1.15 µm/h rather than 0.00115 mm/h."""
    if amount is None or not amount.value or reads_well(amount.value, amount.unit):
        return amount
    head, bar, tail = amount.unit.partition("/")
    units = [f"{each}{bar}{tail}" for family in FAMILIES if head in family for each in family]
    return next((Amount(amount.value, unit) for unit in units if reads_well(amount.value, unit)), amount)


def score_text(number: float | None) -> str:
    """Write a score, a λ or a gain in log score: to a hundredth below ten, what is smaller is 0."""
    if number is None or not math.isfinite(number):
        return ABSENT
    return pretty(format_number(round(number, 2), 3))


def percent(share: float | None) -> str:
    """Write a share in percent."""
    return ABSENT if share is None or not math.isfinite(share) else f"{pretty(format_number(100 * share, 3))} %"


def p_text(p_value: float | None) -> str:
    """Write a significance."""
    if p_value is None:
        return "not tested"
    return "p < 0.001" if p_value < 0.001 else f"p {pretty(format_number(p_value, 2))}"


def number_texts(unknown: FittedUnknown, fitted: tuple[float, float | None, float | None]) -> tuple[str, str, str, str]:
    """Write value, lower end, upper end and unit; the width of the interval decides the digits, an open end is open."""
    size = readable(Amount(unknown.value, unknown.unit))
    unit = unknown.unit if size is None else size.unit
    numbers = [None if one is None else float(from_si(one, unit)) for one in fitted]
    value, *ends = numbers
    widths = [abs(end - value) for end in ends if end is not None and value is not None]
    spread = max(filter(math.isfinite, widths), default=0.0)
    printed, low, high = (_as_wide(one, spread) for one in numbers)
    return printed, low, high, unit_text(unit)


def _as_wide(number: float | None, spread: float) -> str:
    """Write a number to two digits of its uncertainty; without one to four of its own."""
    if number is None:
        return "open"
    if not 1e-5 < spread < 1e6 or not math.isfinite(number):
        return pretty(format_number(number, 4))
    decimals = max(0, 1 - math.floor(math.log10(spread)))
    return pretty(f"{number:.{decimals}f}".replace("-0.00000", "0.00000") if number else "0")


def fitted_text(unknown: FittedUnknown, *, with_name: bool = True) -> str:
    """Write an unknown with its interval: expansion 11.8 µm/(m·K) (95 %: 11.4 … 12.2)."""
    value, low, high, unit = number_texts(unknown, (unknown.value, unknown.low, unknown.high))
    name = f"{unknown.name.replace('_', ' ')} " if with_name else ""
    if unknown.per_file:
        return f"{name}of each file alone"
    if unknown.low is None and unknown.high is None:
        return f"{name}{with_unit(value, unit)} (its interval is open)"
    return f"{name}{with_unit(value, unit)} (95 %: {low}{TO}{high})"


# A wave: its two parts mean nothing alone, its amplitude and phase do


def as_waves(unknowns: Sequence[FittedUnknown], covariance: Sequence[Sequence[float]] = ()) -> list[FittedUnknown]:
    """Return unknowns with amplitude and phase in the place of every sine and cosine part of one wave.

    ``A cos(x - phase)`` is ``cosine cos(x) + sine sin(x)``, so the phase is where the wave is highest. ``covariance``
    (SI) follows the order of ``unknowns``; without it the intervals are open. They are those of the parts, carried
    over to first order.
    """
    at = {unknown.name: index for index, unknown in enumerate(unknowns)}
    said: list[FittedUnknown] = []
    for index, unknown in enumerate(unknowns):
        partner = at.get(partner_of(unknown.name))
        if partner is None or unknown.per_file or unknowns[partner].unit != unknown.unit:
            said.append(unknown)
        elif index < partner:
            sine, cosine = (index, partner) if "cosine" not in unknown.name else (partner, index)
            known = covariance[sine][cosine] if len(covariance) == len(unknowns) else math.nan
            spread = math.sqrt(covariance[sine][sine] * covariance[cosine][cosine]) if known == known else 0.0
            said += _wave(unknowns[sine], unknowns[cosine], known / spread if spread > 0 else math.nan)
    return said


def partner_of(name: str) -> str:
    """Return the name of the other part of a wave; nothing where a name is no part of one."""
    if not WAVE_PART.search(name):
        return ""
    return name.replace("cosine", "sine") if "cosine" in name else name.replace("sine", "cosine")


def wave_name(name: str) -> str:
    """Return what of a name says which wave it is a part of: "tooth" of "tooth_cosine", nothing of "sine"."""
    return name.replace("cosine", "").replace("sine", "").strip("_").replace("__", "_")


def _wave(sine: FittedUnknown, cosine: FittedUnknown, correlation: float) -> Iterator[FittedUnknown]:
    """Give amplitude and phase of a wave; ``correlation`` is that of its two parts."""
    amplitude, phase = math.hypot(sine.value, cosine.value), math.atan2(sine.value, cosine.value)
    widths = [_half(part) for part in (sine, cosine)]
    along, across = math.nan, math.nan
    if amplitude > 0 and math.isfinite(correlation):
        s, c = sine.value / amplitude, cosine.value / amplitude
        both = 2 * s * c * correlation * widths[0] * widths[1]
        along = math.sqrt(max(0.0, (s * widths[0]) ** 2 + (c * widths[1]) ** 2 + both))
        across = math.sqrt(max(0.0, (c * widths[0]) ** 2 + (s * widths[1]) ** 2 - both)) / amplitude
    head = f"{wave_name(sine.name)}_".lstrip("_")
    low, high = _ends(amplitude, along, least=0.0)
    yield FittedUnknown(f"{head}amplitude", amplitude, low, high, sine.unit)
    low, high = _ends(phase, across if across < 1.0 else math.nan)
    yield FittedUnknown(f"{head}phase", phase, low, high, "deg")


def _half(part: FittedUnknown) -> float:
    return math.nan if part.low is None or part.high is None else (part.high - part.low) / 2


def _ends(value: float, width: float, least: float = -math.inf) -> tuple[float | None, float | None]:
    return (max(least, value - width), value + width) if math.isfinite(width) else (None, None)
