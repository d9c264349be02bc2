"""How an input scatters about its nominal: the words of a drawing, resolved to a distribution in SI.

A spread is what is declared (``plus_minus("0.05 mm")``); with the nominal value it becomes a ``Distribution``.
A band of six standard deviations and a half-band of three are the 3-sigma rule of mass production.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, Literal, Protocol, overload

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from truing.declare.goals import Price, PriceByChoice
from truing.errors import DeclarationError, UnitError, UsageError
from truing.fits import tolerance
from truing.units import difference_unit, from_si, read_quantity, same_dimension, split_quantity
from truing.units.grammar import shown, split

DistributionShape = Literal["normal", "uniform", "lognormal"]
SIGMAS_IN_BAND = 6.0
FIXED_DRAWS = 2**16
"""How often a spread that is drawn by a function is drawn to know its mean and standard deviation."""


@dataclass(frozen=True, slots=True)
class Stream:
    """The random numbers of one cause for some machines in a row: a generator for each block of them."""

    rows: int
    blocks: Sequence[tuple[np.random.Generator, slice]]

    def standard_normal(self, columns: int = 0) -> NDArray[np.float64]:
        """Draw standard normal values (rows,), or (columns, rows)."""
        if columns:
            return np.concatenate(
                [rng.standard_normal((columns, part.stop - part.start)) for rng, part in self.blocks], axis=1
            )
        values = np.empty(self.rows)
        for rng, part in self.blocks:
            rng.standard_normal(out=values[part])
        return values

    def uniform(self, low: float, high: float) -> NDArray[np.float64]:
        """Draw values (rows,) that are uniform between two bounds."""
        return np.concatenate([rng.uniform(low, high, part.stop - part.start) for rng, part in self.blocks])

    def of_function(self, function: Callable[..., Mapping[str, Any]]) -> dict[str, NDArray[np.float64]]:
        """Draw by ``function(rng, rows)``: arrays (rows,) by column."""
        drawn = [
            {name: np.broadcast_to(values, rows) for name, values in function(rng, rows).items()}
            for rng, rows in ((rng, part.stop - part.start) for rng, part in self.blocks)
        ]
        return {name: np.concatenate([part[name] for part in drawn]) for name in drawn[0]}


@dataclass(frozen=True, slots=True)
class Distribution:
    """One input's scatter in SI: mean, standard deviation and shape; numbers, or arrays of several designs."""

    mean: Any
    sd: Any
    shape: DistributionShape = "normal"

    @property
    def width(self) -> Any:
        """The full band that a drawing would state: six standard deviations, or the whole of a uniform one."""
        return self.sd * (12**0.5 if self.shape == "uniform" else SIGMAS_IN_BAND)

    def draw(self, stream: Stream) -> NDArray[np.float64]:
        """Draw a value for every machine of the stream."""
        if self.shape == "uniform":
            half = self.width / 2
            return stream.uniform(self.mean - half, self.mean + half)
        return self._scaled(stream.standard_normal())

    def from_standard(self, standard: Any) -> Any:
        """Map standard normal values to this distribution (for FORM, Sobol sequences and fixed draws)."""
        if self.shape != "uniform":
            return self._scaled(np.array(standard, dtype=float))
        return self.mean + self.width * (ndtr(standard) - 0.5)

    def _scaled(self, standard: NDArray[np.float64]) -> NDArray[np.float64]:
        """Scale standard normal values in place."""
        if self.shape == "lognormal":
            log_variance = np.log1p((self.sd / self.mean) ** 2)
            return np.asarray(np.exp(np.log(self.mean) - log_variance / 2 + np.sqrt(log_variance) * standard))
        standard *= self.sd
        if np.any(self.mean):
            standard += self.mean
        return standard


@dataclass(frozen=True, slots=True)
class Target:
    """The input a spread acts on: its nominal value in SI, its unit, and how to read another input by name."""

    name: str
    nominal: float
    unit: str
    value_of: Callable[[str], Any]


class Spread(Protocol):
    """What every word for a spread can do."""

    @property
    def text(self) -> str:
        """The spread as an inputs file writes it."""

    def resolve(self, target: Target) -> Distribution | None:
        """Return the distribution about the target's nominal, or None when the spread is off."""


@dataclass(frozen=True, slots=True)
class Band:
    """A standard deviation, a full band or a half-band, as a quantity or as a share of the nominal."""

    amount: str
    says: Literal["sd", "band", "±"]
    shape: DistributionShape = "normal"
    at_radius: str = ""

    @property
    def text(self) -> str:
        """The spread as an inputs file writes it."""
        words = f"±{self.amount}" if self.says == "±" else f"{self.says} {self.amount}"
        return words if self.shape == "normal" else f"{self.shape} {words}"

    def resolve(self, target: Target) -> Distribution:
        """Return the distribution; a percentage is of the nominal unless the input itself is declared in percent."""
        amount = self._amount(target)
        half_to_sd = 3**0.5 if self.shape == "uniform" else SIGMAS_IN_BAND / 2
        sd = {"sd": amount, "band": amount / 2 / half_to_sd, "±": amount / half_to_sd}[self.says]
        if self.shape == "lognormal" and not target.nominal > 0:
            raise UnitError(f"a lognormal spread needs a nominal above zero; '{target.name}' is {target.nominal:g}")
        return Distribution(target.nominal, sd, self.shape)

    def _amount(self, target: Target) -> float:
        quantity = split_quantity(self.amount)
        if quantity.unit == "%" and target.unit != "%":
            if not target.nominal:
                raise UnitError(
                    f"{self.amount} of '{target.name}' is nothing, because its nominal is 0; write a quantity, or off"
                )
            return _positive(quantity.value, self.amount) / 100 * abs(target.nominal)
        if not self.at_radius:
            return _positive(difference(self.amount, target.unit), self.amount)
        radius = float(target.value_of(self.at_radius))
        return _positive(read_quantity(self.amount, "m"), self.amount) / radius


@dataclass(frozen=True, slots=True)
class Grade:
    """An ISO 286 tolerance grade from the nominal size, read as a full band."""

    grade: str
    size: str = ""

    @property
    def text(self) -> str:
        """The spread as an inputs file writes it."""
        return self.grade

    def width(self, target: Target) -> float:
        """Return the full width in metres; raises UnitError where the input is no length."""
        if not same_dimension(target.unit, "m"):
            raise UnitError(
                f"{self.grade} is a grade for lengths; '{target.name}' is in {target.unit or 'pure numbers'}"
            )
        return tolerance(self.grade, self.size_of(target))

    def size_of(self, target: Target) -> float:
        """Return the nominal size in metres that the grade is read for."""
        return float(target.value_of(self.size)) if self.size else target.nominal

    def resolve(self, target: Target) -> Distribution:
        """Return a normal distribution whose six standard deviations fill the grade."""
        return Distribution(target.nominal, self.width(target) / SIGMAS_IN_BAND)


@dataclass(frozen=True, slots=True)
class Zone:
    """A tolerance zone from ``low`` to ``high``, measured from the nominal; its mean is its middle."""

    low: str
    high: str
    grows: Literal["up", "down", "both"] = "both"

    @property
    def text(self) -> str:
        """The spread as an inputs file writes it."""
        return f"zone {self.low} .. {self.high}"

    def resolve(self, target: Target) -> Distribution:
        """Return a normal distribution about the middle, six standard deviations wide."""
        low, high = (difference(end, target.unit) for end in (self.low, self.high))
        if not high > low:
            raise UnitError(f"zone of '{target.name}': its end {self.high} must lie above its start {self.low}")
        return Distribution(target.nominal + (low + high) / 2, (high - low) / SIGMAS_IN_BAND)


@dataclass(frozen=True, slots=True)
class Off:
    """No scatter."""

    @property
    def text(self) -> str:
        """The spread as an inputs file writes it."""
        return "off"

    def resolve(self, target: Target) -> None:
        """Return nothing: the input keeps its nominal value."""


@dataclass(frozen=True, slots=True)
class ByChoice:
    """Another spread for each value of an input that offers choices."""

    chooser: str
    spreads: Mapping[str, Spread]

    @property
    def text(self) -> str:
        """All branches in words; an inputs file writes one of them."""
        return ", ".join(f"{spread.text} if {self.chooser} is {value}" for value, spread in self.spreads.items())

    def chosen(self, value: str) -> Spread:
        """Return the spread for this value of the choosing input."""
        if value not in self.spreads:
            raise DeclarationError(f"no spread is declared for {self.chooser} = '{value}'")
        return self.spreads[value]

    def resolve(self, target: Target) -> Distribution | None:
        """Return what the chosen spread says."""
        return settled(self, target.value_of).resolve(target)


def settled(spread: Spread, value_of: Callable[[str], Any]) -> Spread:
    """Return a spread itself; of one that follows a choice the branch that is chosen; a function with its inputs."""
    while isinstance(spread, ByChoice):
        spread = spread.chosen(str(value_of(spread.chooser)))
    return spread.bound(value_of) if isinstance(spread, Drawn) else spread


@dataclass(frozen=True, slots=True)
class Drawn:
    """Inputs that scatter together: ``function(rng, rows)`` returns their deviations from nominal by name.

    ``of`` names inputs that the function is given as keywords. One that returns nothing does not scatter.
    """

    function: Callable[..., Mapping[str, Any]]
    of: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The spread as the sheet names it."""
        function = self.function.func if isinstance(self.function, partial) else self.function
        return f"drawn by {getattr(function, '__name__', 'a function')}"

    def bound(self, value_of: Callable[[str], Any]) -> Drawn:
        """Return the same draw with its inputs taken from ``value_of``."""
        return Drawn(partial(self.function, **{name: value_of(name) for name in self.of})) if self.of else self

    def resolve(self, target: Target) -> Distribution | None:
        """Return a normal stand-in with the standard deviation of fixed draws, and their mean where it is not chance.

        A mean within four standard errors of the nominal is the nominal. None where nothing scatters.
        """
        drawn = self.bound(target.value_of).function(np.random.default_rng(0), FIXED_DRAWS)
        if not drawn:
            return None
        if target.name not in drawn:
            raise DeclarationError(f"{self.function.__name__} draws {', '.join(drawn)}, but not '{target.name}'")
        deviations = np.asarray(drawn[target.name], dtype=float)
        shift, sd = float(deviations.mean()), float(deviations.std(ddof=1))
        is_chance = abs(shift) <= 4 * sd / FIXED_DRAWS**0.5
        return Distribution(target.nominal + (0.0 if is_chance else shift), sd)


def normal(*, sd: str = "", band: str = "", at_radius: str = "") -> Band:
    """Scatter normally with a standard deviation, or with a band of six of them."""
    if bool(sd) == bool(band):
        raise DeclarationError('normal() takes either sd="3 %" or band="0.125 mm"')
    return Band(sd or band, "sd" if sd else "band", at_radius=at_radius)


def plus_minus(half: str, *, at_radius: str = "") -> Band:
    """Scatter normally within ± ``half``, read as three standard deviations.

    ``at_radius`` names the input that holds a radius: then ``half`` is a length across it and the input an angle.
    """
    return Band(half, "±", at_radius=at_radius)


def uniform(half: str) -> Band:
    """Scatter evenly within ± ``half``."""
    return Band(half, "±", "uniform")


def lognormal(*, sd: str) -> Band:
    """Scatter lognormally with the nominal as mean; ``sd`` is a share of it or a quantity."""
    return Band(sd, "sd", "lognormal")


def grade(name: str, *, size: str = "") -> Grade:
    """Scatter within an ISO 286 grade of the input's nominal size, or of the input named by ``size``."""
    return Grade(name, size)


def zone(low: str, high: str, *, grows: Literal["up", "down", "both"] = "both") -> Zone:
    """Scatter normally in a zone measured from the nominal; ``grows`` says which end moves when it is widened."""
    return Zone(low, high, grows)


def off() -> Off:
    """Do not scatter."""
    return Off()


@overload
def by_choice(chooser: str, /, **branches: Spread) -> ByChoice: ...
@overload
def by_choice(chooser: str, /, **branches: Price) -> PriceByChoice: ...
def by_choice(chooser: str, /, **branches: Any) -> ByChoice | PriceByChoice:
    """Scatter, or cost, as the value of the input ``chooser`` says: a spread for each choice, or a price for each.

    Raises DeclarationError where spreads and prices are mixed, and where there is no branch at all.
    """
    priced = [isinstance(branch, Price) for branch in branches.values()]
    if not priced or any(priced) != all(priced):
        raise DeclarationError(f"by_choice('{chooser}') takes a spread for each choice, or a price for each")
    return PriceByChoice(chooser, branches) if all(priced) else ByChoice(chooser, branches)


def drawn(function: Callable[..., Mapping[str, Any]], *, of: Sequence[str] = ()) -> Drawn:
    """Scatter together: ``function(rng, rows)`` returns deviations in SI, shape (rows,), by input name.

    It is given the inputs named in ``of`` as keywords, such as a measured record that knows its own uncertainty, and
    returns an empty mapping where nothing scatters.
    """
    return Drawn(function, tuple(of))


@lru_cache(maxsize=1024)
def difference(text: str, unit: str) -> float:
    """Read a difference: like any quantity, except that levels of temperature differ by kelvins."""
    return read_quantity(text, difference_unit(unit))


def _positive(value: float, text: str) -> float:
    if value < 0:
        raise UnitError(f"{shown(text)} is negative; a spread is written as its size")
    return value


def read_spread(text: str | Mapping[str, Any], declared: Spread) -> Spread:
    """Read what an inputs file says of a tolerance; where the spread is measured stays as declared.

    Takes "±0.05 mm", "sd 3 %", "band 0.125 mm", "IT6", "uniform ±0.1 mm", "lognormal sd 6 %", "off",
    "zone 0 um .. 6 um" and {zone = ["0 um", "6 um"]}. Raises UnitError with one sentence for anything else.
    """
    if not isinstance(text, str):
        return _zone_table(text, declared)
    words = text.replace("+/-", "±").replace("+-", "±").strip()
    if words == "off":
        return Off()
    if words.upper().startswith("IT") and words.isascii() and words[2:].strip().isdigit():
        tolerance(name := "IT" + words[2:].strip(), 0.1)  # refuses IT19 at once; every grade exists at 100 mm
        return Grade(name, _settled(declared, "size"))
    if words.startswith("zone"):
        ends = [end.strip() for end in words[4:].split("..")]
        return _zone_table({"zone": ends}, declared)
    return _band(words, text, declared)


def _band(words: str, text: str, declared: Spread) -> Band:
    shape: DistributionShape = "normal"
    shapes: tuple[DistributionShape, ...] = ("uniform", "lognormal", "normal")
    for other in shapes:
        if words.startswith(other + " "):
            shape, words = other, words[len(other) :].strip()
            break
    says: tuple[Literal["±", "sd", "band"], ...] = ("±", "sd", "band")
    for word in says:
        if words.startswith(word):
            amount = words[len(word) :].strip()
            split(amount)
            return Band(amount, word, shape, _settled(declared, "at_radius"))
    raise UnitError(
        f"{shown(text)} is no tolerance; write '±0.05 mm', 'sd 3 %', 'band 0.125 mm', 'IT6', "
        '{zone = ["0 um", "6 um"]} or \'off\''
    )


def _zone_table(table: Mapping[str, Any], declared: Spread) -> Zone:
    ends = table.get("zone") if isinstance(table, Mapping) else None
    if (
        not isinstance(ends, list)
        or len(ends) != 2
        or set(table) != {"zone"}
        or not all(isinstance(e, str) for e in ends)
    ):
        raise UnitError('a zone is written {zone = ["0 um", "6 um"]}')
    return replace(declared, low=ends[0], high=ends[1]) if isinstance(declared, Zone) else Zone(ends[0], ends[1])


def _settled(declared: Spread, name: str) -> str:
    """Return a setting of the declared spread (its size, its radius) that a file does not repeat."""
    spreads = declared.spreads.values() if isinstance(declared, ByChoice) else (declared,)
    return next((value for spread in spreads if (value := getattr(spread, name, ""))), "")


# Spreads of another width: what a band becomes when it is tightened or widened, as a drawing would state it


GROWTH = {"up": 0.5, "down": -0.5, "both": 0.0}


def with_width(spread: Spread, target: Target, width: float) -> Spread:
    """Return the spread with another full band (SI): the same words, units and shape; a grade becomes a band.

    A zone that grows up keeps its lower end, one that grows down its upper end, any other its middle. The new spread
    stands in its text in full: read again it is the same. Raises UsageError for a width that is not above zero, and
    for a spread that is off or drawn by a function.
    """
    if not (width > 0 and math.isfinite(width)):
        raise UsageError(f"the width of the tolerance of '{target.name}' must lie above zero; it is {width:g}")
    spread = settled(spread, target.value_of)
    spread.resolve(target)  # refuses what the present words cannot say of this input, such as a share of 0
    if isinstance(spread, Band):
        return replace(spread, amount=_amount(spread, target, width))
    if isinstance(spread, Zone):
        return _zone(spread, target, width)
    if isinstance(spread, Grade):
        return Band(_quantity(width, difference_unit(target.unit)), "band")
    raise UsageError(f"the spread of '{target.name}' is {spread.text}: it has no width that could be chosen")


def shift_per_width(spread: Spread) -> float:
    """Return by how much the middle moves with the width: half of what is added where one end of a zone stays."""
    return GROWTH[spread.grows] if isinstance(spread, Zone) else 0.0


def _amount(band: Band, target: Target, width: float) -> str:
    """Return what a band of this width states, in the unit that it states now."""
    whole = 12**0.5 if band.shape == "uniform" else SIGMAS_IN_BAND
    size = width / {"sd": whole, "band": 1.0, "±": 2.0}[band.says]
    unit = split_quantity(band.amount).unit
    if unit == "%" and target.unit != "%":
        return f"{float(size / abs(target.nominal) * 100)!r} %"
    if band.at_radius:
        size *= float(target.value_of(band.at_radius))
    return _quantity(size, unit)


def _zone(zone: Zone, target: Target, width: float) -> Zone:
    """Move the end or the ends that give way."""
    low, high = difference(zone.low, target.unit), difference(zone.high, target.unit)
    below, above = (split_quantity(end).unit for end in (zone.low, zone.high))
    if zone.grows == "up":
        return replace(zone, high=_quantity(low + width, above))
    if zone.grows == "down":
        return replace(zone, low=_quantity(high - width, below))
    middle = (low + high) / 2
    return replace(zone, low=_quantity(middle - width / 2, below), high=_quantity(middle + width / 2, above))


def _quantity(value: float, unit: str) -> str:
    """Write a difference in SI as a text in a unit; the number has all its digits."""
    return f"{float(from_si(value, difference_unit(unit)))!r} {unit}".strip()
