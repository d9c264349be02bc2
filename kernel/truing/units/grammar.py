"""Reading texts: a number and a unit apart, and a unit text into names with exponents; no unit's size is known here.

A unit text is a product of names with exponents, as engineers write it: ``N*m``, ``N·m``, ``N m``, ``N-m``, ``kg m-3``,
``N/mm²``, ``m/s^2``, ``m/s**2``, ``W/(m·K)``, ``cm4``, ``1e-6/K``, ``10^-6 1/K``. The grammar::

    quantity := number [[* ·] unit]          number := 1.5  1.5e3  1.5*10^3  10^3
    unit     := [power of ten [* · /]] product
    product  := [1 /] factor {[* · /] factor}    a hyphen without blanks joins two names: N-m
    factor   := (name | "(" product ")") [exponent]
    exponent := ^2  ^-2  ^0.5  ^(1/2)  ²  and, behind letters, one digit: m2  s-1

So no number stands in a unit but the power of ten before it and exponents. ``*`` and ``/`` work from left to right; a
product by blank, dot or hyphen behind a ``/`` is refused, because nobody knows what ``W/m·K`` means.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from truing.errors import UnitError
from truing.units.names import COUNTS, PURE, SPELLINGS

LONGEST = 200
LONGEST_SHOWN = 1000
LARGEST_EXPONENT = 12
LARGEST_POWER_OF_TEN = 30

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
_SAME_CHARACTER = str.maketrans({
    "\u03bc": "u", "\u00b5": "u", "\u2126": "Ω", "\u212a": "K", "\u212b": "Å", "\u2206": "Δ",
    "−": "-", "–": "-", "‐": "-", "‑": "-", "⋅": "·", "∙": "·", "•": "·", "×": "*", "∗": "*", "∕": "/", "⁄": "/",
    "’": "′", "'": "′", '"': "″", "”": "″", "º": "°",
    "\u00a0": " ", "\u2009": " ", "\u202f": " ", "\u2007": " ", "\u200a": " ", "\t": " ", "\n": " ", "\r": " ",
})  # fmt: skip
_ALLOWED = re.compile(r"[A-Za-z0-9_ .+\-*/^()\[\]·°′″%‰€$£元ΩÅΔ℃℉⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺]*\Z")
_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_TIMES_TEN = re.compile(r"\s*[*·x]\s*10(?:\^\s*([+-]?\d{1,3})(?![\d.])|([⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3}))")
_BEGINS_NUMBER = re.compile(r"[+-]?\.?[0-9]")
_TEN_TO = re.compile(r"([+-]?)10(?:\^\s*\(?([+-]?\d{1,3})(?![\d.])\)?|([⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3}))")
_UNIT_WITH_NUMBER = re.compile(r"[+-]|1\s*/|1[eE]|10[\^⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹]")
_NOT_FINITE = re.compile(r"[+-]?\s*(?:nan|inf|infinity|∞)(?![A-Za-z])", re.IGNORECASE)
_BAND = re.compile(r"±|\+\s?/?\s?-")
_ONE_OVER = re.compile(r"\s*1\s*/")
_RAISED = r"\^(?:[+-]?\d+(?:\.\d+)?(?![\d.eE^])|\(\s*[+-]?\d+(?:\.\d+)?\s*(?:/\s*\d+\s*)?\))|[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+"
_TOKEN = re.compile(
    rf"\s*(?:(?P<name>(?:Δ?°[CF]|[A-Za-zΩÅΔ_]+)(?P<bare>-?\d(?![\d.eE^⁰¹²³⁴⁵⁶⁷⁸⁹]))?|[°′″%‰€$£元℃℉])(?P<exponent>{_RAISED})?"
    r"|(?P<operator>[*/·]|(?<=[^\s*/·(])-(?=[A-Za-zΩÅ]))|(?P<open>\()"
    rf"|(?P<close>\))(?P<outer>{_RAISED})?)"
)
_LONE_NUMBER = re.compile(r"\s*[+-]?\s*(\d[\d.eE^⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹]*)")


@dataclass(frozen=True)
class Quantity:
    """A number and the unit text as it was written, its characters normalised ("" where no unit stands)."""

    value: float
    unit: str


@dataclass(frozen=True)
class Product:
    """A unit text taken apart: 10**power times the product of names raised to exponents, in the order written."""

    power: int = 0
    factors: tuple[tuple[str, Fraction], ...] = ()


def shown(text: str) -> str:
    """Quote a user's text for a sentence: one line, not longer than 60 characters, control characters as escapes.

    What a user wrote, and what stands in a user's file, comes into a sentence through this function only.
    """
    flat = " ".join(text[:LONGEST_SHOWN].split()) if len(text) > LONGEST_SHOWN else " ".join(text.split())
    if not flat.isprintable():
        flat = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in flat)
    return f"'{flat if len(flat) <= 60 else flat[:57] + '...'}'"


def normalised(text: str) -> str:
    """Bring characters that look the same to one form; refuse what is too long or can stand in no quantity."""
    if len(text) > LONGEST:
        raise UnitError(f"{shown(text)} is too long for a number with a unit ({len(text)} characters)")
    plain = text.translate(_SAME_CHARACTER).replace("**", "^").strip().replace("′′", "″")
    if not _ALLOWED.match(plain):
        strange = next(character for character in plain if not _ALLOWED.match(character))
        raise UnitError(f"{shown(text)} holds {shown(strange)}, which stands in no number or unit")
    return re.sub(r"\bdeg(?:rees?)?\.?\s*([CF])\b|°\s+([CF])\b", lambda match: "deg" + (match[1] or match[2]), plain)


@lru_cache(maxsize=2048)
def split(text: str) -> Quantity:
    """Take a text apart: "3136 N*m" is Quantity(3136.0, "N*m"), "5" is Quantity(5.0, "").

    The unit is not looked up. Raises UnitError for a number that is none, not finite, or written with a comma, a band
    or underscores. "1.5×10^-3 m" and "10^-3 m" are numbers too; ``2**3`` is not.
    """
    _refuse_common_slips(text)
    plain = normalised(text)
    value, end = _leading_number(text, plain)
    rest = plain[end:].lstrip()
    if rest.startswith("^") or re.match(r"[*·]\s*\d", rest):
        raise UnitError(f"{shown(text)} is not a number followed by a unit")
    if rest[:1] in ("*", "·"):
        rest = rest[1:].lstrip()
        if not rest or rest[:1] == "/":
            raise UnitError(f"{shown(text)} is not a number followed by a unit")
    if rest[:1] == "/":
        rest = "1" + rest
    if _NUMBER.match(rest) and not _UNIT_WITH_NUMBER.match(rest):
        raise UnitError(f"{shown(text)} holds a second number; write one number, without blanks, and then its unit")
    return Quantity(value, rest)


def number(text: str) -> float | None:
    """Return the number that a whole text is, None where it is anything else; UnitError where it is out of range."""
    if not text.isascii():
        text = text.translate(_SAME_CHARACTER)
    plain = text.replace("**", "^").strip()
    if not _BEGINS_NUMBER.match(plain):
        return None
    value, end = _leading_number(text, plain)
    return value if end == len(plain) else None


def _refuse_common_slips(text: str) -> None:
    if not text.strip():
        raise UnitError("the text is empty; expected a number and its unit")
    if len(text) > LONGEST:
        return
    if _NOT_FINITE.match(text.strip()):
        raise UnitError(f"{shown(text)} is not a finite number")
    if _BAND.search(text):
        raise UnitError(f"{shown(text)} holds a tolerance; write the nominal value here, the rest under [tolerances]")
    grouped = re.match(r"\s*([+-]?[0-9]{1,3}(?:,[0-9]{3})+\.[0-9]*)(.*)", text, re.DOTALL)
    if grouped:
        raise UnitError(f"{shown(text)} holds commas; write {shown(grouped[1].replace(',', '') + grouped[2])}")
    comma = re.match(r"\s*([+-]?[0-9]*),([0-9]+)(.*)", text, re.DOTALL)
    if comma and re.fullmatch(r"[+-]?[1-9][0-9]{0,2}", comma[1]) and len(comma[2]) == 3:
        either = f"{shown(f'{comma[1]}.{comma[2]}{comma[3]}')} or {shown(f'{comma[1]}{comma[2]}{comma[3]}')}"
        raise UnitError(f"{shown(text)} holds a comma; write {either}")
    if comma:
        raise UnitError(f"{shown(text)} has a decimal comma; write {shown(f'{comma[1] or 0}.{comma[2]}{comma[3]}')}")
    if re.match(r"\s*[+-]?[0-9.]+_", text):
        raise UnitError(f"{shown(text)} holds an underscore; write the number with digits alone")


def _leading_number(text: str, plain: str) -> tuple[float, int]:
    ten = _TEN_TO.match(plain)
    if ten:
        return _finite(text, f"{ten[1]}1e{_exponent(ten[2], ten[3])}"), ten.end()
    number = _NUMBER.match(plain)
    if not number:
        raise UnitError(f"{shown(text)} does not begin with a number; write it like '5 mm'")
    times = _TIMES_TEN.match(plain, number.end())
    if times:
        if "e" in number[0].lower():
            raise UnitError(f"{shown(text)} is not a number followed by a unit")
        return _finite(text, f"{number[0]}e{_exponent(times[1], times[2])}"), times.end()
    return _finite(text, number[0]), number.end()


def _finite(text: str, number: str) -> float:
    value = float(number)
    if not math.isfinite(value):
        raise UnitError(f"{shown(text)} is too large for a number")
    if value == 0 and re.search(r"[1-9]", re.split("[eE]", number)[0]):
        raise UnitError(f"{shown(text)} is too small for a number")
    return value


def _exponent(plain: str | None, superscript: str | None) -> int:
    return int((plain or superscript or "1").translate(_SUPERSCRIPTS))


@lru_cache(maxsize=2048)
def parse(unit: str) -> Product:
    """Take a unit text apart: "N/mm²" is N to the 1 and mm to the -2. Raises UnitError with one sentence."""
    plain = normalised(unit)
    if plain[:1] == "[" and plain[-1:] == "]":
        plain = plain[1:-1].strip()
    if plain in PURE:
        return Product()
    if plain[:1] == "/":
        plain = "1" + plain
    power, plain = _leading_power(unit, plain)
    if abs(power) > LARGEST_POWER_OF_TEN:
        raise UnitError(f"the unit {shown(unit)} carries too large a power of ten")
    return Product(power, _Reader(unit, plain).product(closing=False) if plain.strip() else ())


def _leading_power(unit: str, plain: str) -> tuple[int, str]:
    """Take the power of ten off a unit text; "1/" is the beginning of a quotient."""
    if _ONE_OVER.match(plain) or not plain[:1].isdigit():
        return 0, plain
    value, end = _leading_number(unit, plain)
    power = round(math.log10(value)) if value else 0
    if value != float(f"1e{power}"):
        raise UnitError(f"the unit {shown(unit)} may carry a power of ten, but not the number {shown(plain[:end])}")
    rest = plain[end:].lstrip()
    if rest[:1] in ("*", "·"):
        rest = rest[1:].lstrip()
        if not rest or rest[:1] == "/":
            raise _no_unit(unit)
    return power, "1" + rest if rest[:1] == "/" else rest


def _no_unit(unit: str) -> UnitError:
    return UnitError(f"{shown(unit)} is not a unit; write it like 'N*m', 'mm^2' or 'W/(m*K)'")


class _Reader:
    """One pass over one unit text, from left to right."""

    def __init__(self, unit: str, plain: str) -> None:
        self.unit, self.plain, self.position, self.depth = unit, plain, 0, 0

    def wrong(self) -> UnitError:
        number = _LONE_NUMBER.match(self.plain, self.position)
        if number is None:
            return _no_unit(self.unit)
        where = "only a power of ten may stand in a unit, at its beginning"
        return UnitError(f"the unit {shown(self.unit)} holds the number {shown(number[1])}; {where}")

    def next(self) -> re.Match[str] | None:
        """Give the next token, or None at the end."""
        if not self.plain[self.position :].strip():
            return None
        token = _TOKEN.match(self.plain, self.position)
        if not token:
            raise self.wrong()
        self.position = token.end()
        return token

    def product(self, *, closing: bool) -> tuple[tuple[str, Fraction], ...]:
        """Read factors up to the end or the closing parenthesis."""
        factors = list[tuple[str, Fraction]]()
        sign, divided, wanted = 1, False, True
        one_over = _ONE_OVER.match(self.plain, self.position)
        if one_over:
            self.position, sign, divided = one_over.end(), -1, True
        while True:
            token = self.next()
            if token is None or token["close"]:
                if wanted or closing is (token is None):
                    raise self.wrong()
                outer = _exponent_of(self.unit, token["outer"]) if token else Fraction(1)
                return _raised(self.unit, tuple(factors), outer)
            operator = token["operator"]
            if operator:
                if wanted:
                    raise self.wrong()
                sign, wanted = (-1 if operator == "/" else 1), True
                if divided and operator in "·-":
                    raise self.ambiguous()
                divided = divided or operator == "/"
                continue
            if not wanted and divided:
                raise self.ambiguous()
            sign = sign if wanted else 1
            factors += [(name, sign * exponent) for name, exponent in self.factor(token)]
            wanted = False

    def ambiguous(self) -> UnitError:
        return UnitError(f"{shown(self.unit)} is ambiguous; put what is below the '/' in parentheses, as in 'W/(m*K)'")

    def factor(self, token: re.Match[str]) -> tuple[tuple[str, Fraction], ...]:
        """Read one name with its exponent or a product in parentheses."""
        if token["open"]:
            self.depth += 1
            if self.depth > LARGEST_EXPONENT:
                raise self.wrong()
            inner = self.product(closing=True)
            self.depth -= 1
            return inner
        bare = token["bare"]
        name = token["name"].removesuffix(bare or "")
        spelling = SPELLINGS.get(name, name)
        exponent = Fraction(bare) if bare else _exponent_of(self.unit, token["exponent"])
        if (bare and token["exponent"]) or (bare and spelling in COUNTS and exponent != -1):
            raise _no_unit(self.unit)
        if "*" not in spelling and "/" not in spelling:
            return _raised(self.unit, ((spelling, Fraction(1)),), exponent)
        if exponent != 1:
            raise UnitError(f"{shown(self.unit)} is ambiguous; write {shown(name)} as '{spelling}' with its exponents")
        return parse(spelling).factors


def _exponent_of(unit: str, text: str | None) -> Fraction:
    """Return the exponent behind a name: "^2", "^(1/2)", "²"; 1 where none is written."""
    if text is None:
        return Fraction(1)
    plain = text.translate(_SUPERSCRIPTS).strip("^() ").replace(" ", "")
    try:
        return Fraction(plain)
    except ZeroDivisionError:
        raise UnitError(f"{shown(unit)} is not a unit: an exponent divides by zero") from None
    except ValueError:
        raise _no_unit(unit) from None


def _raised(
    unit: str, factors: tuple[tuple[str, Fraction], ...], exponent: Fraction
) -> tuple[tuple[str, Fraction], ...]:
    """Raise a product to a power, within limits that no unit of engineering exceeds."""
    if exponent == 0:
        raise UnitError(f"the unit {shown(unit)} has the exponent 0")
    raised = tuple((name, own * exponent) for name, own in factors)
    if max((abs(own) for _, own in raised), default=0) > LARGEST_EXPONENT or abs(exponent) > LARGEST_EXPONENT:
        raise UnitError(f"the unit {shown(unit)} has an exponent beyond {LARGEST_EXPONENT}")
    return raised
