"""Reading texts: a number and a unit apart, and a unit text into names with exponents; no unit's size is known here.

A unit text is a product of names with exponents, as engineers write it: ``N*m``, ``N·m``, ``N m``, ``N-m``, ``kg m-3``,
``N/mm²``, ``m/s^2``, ``m/s**2``, ``W/(m·K)``, ``cm4``, ``1e-6/K``, ``10^-6 1/K``. ``*`` and ``/`` work from left to
right; a product by blank or dot behind a ``/`` is refused, because nobody knows what ``W/m·K`` means.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from truing.errors import UnitError
from truing.units.names import PURE, SPELLINGS

LONGEST = 200
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
_TEN_TO = re.compile(r"([+-]?)10(?:\^\s*([+-]?\d{1,3})(?![\d.])|([⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3}))")
_UNIT_WITH_NUMBER = re.compile(r"[+-]|1\s*/|1[eE]|10[\^⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹]")
_NOT_FINITE = re.compile(r"[+-]?\s*(?:nan|inf|infinity|∞)(?![A-Za-z])", re.IGNORECASE)
_BAND = re.compile(r"±|\+\s?/?\s?-")
_TOKEN = re.compile(
    r"\s*(?:(?P<power>10\^\(?(?P<ten>[+-]?\d{1,4})\)?(?![\d.^])|10(?P<small>[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)|\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)"
    r"|(?P<name>Δ?°[CF]|[A-Za-zΩÅΔ_]+|[°′″%‰€$£元℃℉])"
    r"(?:\^?(?P<exponent>[+-]?\d+(?:\.\d+)?(?![\d.eE^])|(?<=\^)\(\s*[+-]?\d+(?:\.\d+)?\s*(?:/\s*\d+\s*)?\))"
    r"|(?P<superscript>[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+))?"
    r"|(?P<operator>[*/·-])|(?P<open>\()"
    r"|(?P<close>\))(?:\^?(?P<outer>[+-]?\d+)|(?P<outer_superscript>[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+))?)"
)


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
    """Quote a user's text for a sentence: one line, printable, not longer than 60 characters."""
    flat = "".join(character if character.isprintable() else "?" for character in " ".join(text.split()))
    return f"'{flat if len(flat) <= 60 else flat[:57] + '...'}'"


def normalised(text: str) -> str:
    """Bring characters that look the same to one form; refuse what is too long or can stand in no quantity."""
    if len(text) > LONGEST:
        raise UnitError(f"{shown(text)} is too long for a number with a unit ({len(text)} characters)")
    plain = text.translate(_SAME_CHARACTER).replace("**", "^").strip().replace("′′", "″")
    if not _ALLOWED.match(plain):
        strange = next(character for character in plain if not _ALLOWED.match(character))
        raise UnitError(f"{shown(text)} holds {shown(strange)}, which stands in no number or unit")
    return re.sub(r"\bdeg(?:rees?)?\.?\s*([CF])\b|°\s+([CF])\b", lambda found: "deg" + (found[1] or found[2]), plain)


def split(text: str) -> Quantity:
    """Take a text such as "3136 N*m" apart into its number and its unit text; see ``units.split_quantity``."""
    _refuse_common_slips(text)
    plain = normalised(text)
    value, end = _leading_number(text, plain)
    rest = plain[end:].lstrip()
    if rest.startswith("^") or re.match(r"[*·]\s*\d", rest):
        raise UnitError(f"{shown(text)} is not a number followed by a unit")
    if rest[:1] in ("*", "·"):
        rest = rest[1:].lstrip()
    if rest[:1] == "/":
        rest = "1" + rest
    if _NUMBER.match(rest) and not _UNIT_WITH_NUMBER.match(rest):
        raise UnitError(f"{shown(text)} holds a second number; write one number, without blanks, and then its unit")
    return Quantity(value, rest)


def _refuse_common_slips(text: str) -> None:
    if not text.strip():
        raise UnitError("the text is empty; expected a number and its unit")
    if len(text) > LONGEST:
        return
    if _NOT_FINITE.match(text.strip()):
        raise UnitError(f"{shown(text)} is not a finite number")
    if _BAND.search(text):
        raise UnitError(f"{shown(text)} holds a tolerance; write the nominal value here, the rest under [tolerances]")
    grouped = re.match(r"\s*([+-]?\d{1,3}(?:,\d{3})+\.\d*)(.*)", text, re.DOTALL)
    if grouped:
        raise UnitError(f"{shown(text)} holds commas; write {shown(grouped[1].replace(',', '') + grouped[2])}")
    comma = re.match(r"\s*([+-]?\d*),(\d+)(.*)", text, re.DOTALL)
    if comma:
        raise UnitError(f"{shown(text)} has a decimal comma; write {shown(f'{comma[1] or 0}.{comma[2]}{comma[3]}')}")
    if re.match(r"\s*[+-]?[\d.]+_", text):
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
    reader = _Reader(unit, plain)
    product = reader.product(closing=False)
    if abs(product.power) > LARGEST_POWER_OF_TEN:
        raise UnitError(f"the unit {shown(unit)} carries too large a power of ten")
    return product


class _Reader:
    """One pass over one unit text, from left to right."""

    def __init__(self, unit: str, plain: str) -> None:
        self.unit, self.plain, self.position, self.depth = unit, plain, 0, 0

    def wrong(self) -> UnitError:
        return UnitError(f"{shown(self.unit)} is not a unit; write it like 'N*m', 'mm^2' or 'W/(m*K)'")

    def next(self) -> re.Match[str] | None:
        """Give the next token, or None at the end."""
        if not self.plain[self.position :].strip():
            return None
        token = _TOKEN.match(self.plain, self.position)
        if not token or token.end() == self.position:
            raise self.wrong()
        self.position = token.end()
        return token

    def product(self, *, closing: bool) -> Product:
        """Read factors up to the end or the closing parenthesis."""
        power, factors = 0, list[tuple[str, Fraction]]()
        sign, divided, wanted = 1, False, True
        while True:
            token = self.next()
            if token is None or token["close"]:
                if wanted or closing is (token is None):
                    raise self.wrong()
                return _raised(self.unit, Product(power, tuple(factors)), _outer(token))
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
            part = self.factor(token)
            power += sign * part.power
            factors += [(name, sign * exponent) for name, exponent in part.factors]
            wanted = False

    def ambiguous(self) -> UnitError:
        return UnitError(f"{shown(self.unit)} is ambiguous; put what is below the '/' in parentheses, as in 'W/(m*K)'")

    def factor(self, token: re.Match[str]) -> Product:
        """Read one name with its exponent, a power of ten or a product in parentheses."""
        if token["open"]:
            self.depth += 1
            if self.depth > LARGEST_EXPONENT:
                raise self.wrong()
            inner = self.product(closing=True)
            self.depth -= 1
            return inner
        if token["power"]:
            return Product(_power_of_ten(self.unit, token))
        name = token["name"]
        exponent = Fraction(1)
        if token["superscript"]:
            exponent = Fraction(token["superscript"].translate(_SUPERSCRIPTS))
        elif token["exponent"]:
            exponent = _fraction(self.unit, token["exponent"].strip("() ").replace(" ", ""))
        spelling = SPELLINGS.get(name, name)
        if "*" not in spelling and "/" not in spelling:
            return _raised(self.unit, Product(0, ((spelling, Fraction(1)),)), exponent)
        if exponent != 1:
            raise UnitError(f"{shown(self.unit)} is ambiguous; write {shown(name)} as '{spelling}' with its exponents")
        return parse(spelling)


def _outer(closing: re.Match[str] | None) -> Fraction:
    if closing is None:
        return Fraction(1)
    return Fraction((closing["outer"] or closing["outer_superscript"] or "1").translate(_SUPERSCRIPTS))


def _fraction(unit: str, text: str) -> Fraction:
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise UnitError(f"{shown(unit)} is not a unit: an exponent divides by zero") from None


def _power_of_ten(unit: str, token: re.Match[str]) -> int:
    if token["ten"]:
        return int(token["ten"])
    if token["small"]:
        return int(token["small"].translate(_SUPERSCRIPTS))
    digits, _, exponent = token["power"].lower().partition("e")
    found = re.fullmatch(r"(1)(0*)(?:\.0*)?|0\.(0*)1", digits)
    if not found:
        raise UnitError(f"the unit {shown(unit)} may carry a power of ten, but not the number {shown(token['power'])}")
    return (len(found[2]) if found[1] else -len(found[3]) - 1) + int(exponent or 0)


def _raised(unit: str, product: Product, exponent: Fraction) -> Product:
    """Raise a product to a power, within limits that no unit of engineering exceeds."""
    factors = tuple((name, own * exponent) for name, own in product.factors)
    power = product.power * exponent
    largest = max((abs(own) for _, own in factors), default=Fraction(0))
    if largest > LARGEST_EXPONENT or abs(exponent) > LARGEST_EXPONENT or power.denominator != 1:
        raise UnitError(f"the unit {shown(unit)} has an exponent beyond {LARGEST_EXPONENT}")
    return Product(int(power), factors)
