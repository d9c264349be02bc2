"""A second reader of quantities, written from docs/reference/units.md: one character after the other, own unit table.

It shares no code with Truing. Factors are those of the SI Brochure (9th edition) and of NIST SP 811, appendix B.8.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

PI = math.pi
# name: (factor, exponents of m, kg, s, K and rad)
TABLE: dict[str, tuple[float, tuple[int, int, int, int, int]]] = {
    "m": (1, (1, 0, 0, 0, 0)), "mm": (1e-3, (1, 0, 0, 0, 0)), "um": (1e-6, (1, 0, 0, 0, 0)),
    "km": (1e3, (1, 0, 0, 0, 0)), "in": (0.0254, (1, 0, 0, 0, 0)), "ft": (0.3048, (1, 0, 0, 0, 0)),
    "kg": (1, (0, 1, 0, 0, 0)), "g": (1e-3, (0, 1, 0, 0, 0)), "t": (1e3, (0, 1, 0, 0, 0)),
    "s": (1, (0, 0, 1, 0, 0)), "ms": (1e-3, (0, 0, 1, 0, 0)), "min": (60, (0, 0, 1, 0, 0)),
    "h": (3600, (0, 0, 1, 0, 0)),
    "N": (1, (1, 1, -2, 0, 0)), "kN": (1e3, (1, 1, -2, 0, 0)), "lbf": (4.4482216152605, (1, 1, -2, 0, 0)),
    "Pa": (1, (-1, 1, -2, 0, 0)), "MPa": (1e6, (-1, 1, -2, 0, 0)), "bar": (1e5, (-1, 1, -2, 0, 0)),
    "J": (1, (2, 1, -2, 0, 0)), "W": (1, (2, 1, -3, 0, 0)), "kW": (1e3, (2, 1, -3, 0, 0)),
    "K": (1, (0, 0, 0, 1, 0)), "mK": (1e-3, (0, 0, 0, 1, 0)), "delta_degC": (1, (0, 0, 0, 1, 0)),
    "degC": (1, (0, 0, 0, 1, 0)), "°C": (1, (0, 0, 0, 1, 0)), "°F": (5 / 9, (0, 0, 0, 1, 0)),
    "degF": (5 / 9, (0, 0, 0, 1, 0)),
    "rad": (1, (0, 0, 0, 0, 1)), "deg": (PI / 180, (0, 0, 0, 0, 1)), "°": (PI / 180, (0, 0, 0, 0, 1)),
    "rpm": (1 / 60, (0, 0, -1, 0, 0)), "Hz": (1, (0, 0, -1, 0, 0)),
    "%": (0.01, (0, 0, 0, 0, 0)), "ppm": (1e-6, (0, 0, 0, 0, 0)), "rev": (1, (0, 0, 0, 0, 0)),
}  # fmt: skip
PRODUCTS = {"Nm": ("N", "m"), "kNm": ("kN", "m")}
LEVELS = {"degC": 273.15, "°C": 273.15, "degF": 459.67 * 5 / 9, "°F": 459.67 * 5 / 9}
COUNTS = {"%", "ppm", "rev"}
SIGNS = {"°", "%"}
SMALL = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+", strict=True))
SAME = {"×": "*", "−": "-", "–": "-", "⋅": "·", "µ": "u", "μ": "u", "\u00a0": " ", "\t": " "}
DIGITS = "0123456789"

Dimension = tuple[Fraction, ...]
Factor = tuple[str, Fraction]


class RefusedError(Exception):
    """The text is no quantity of this kind."""


def normalised(text: str) -> str:
    """Return a text in which characters that look the same are one."""
    plain = "".join(SAME.get(character, character) for character in text).replace("**", "^").strip()
    return "".join(scales_joined(plain))


def scales_joined(text: str) -> Iterator[str]:
    """Give the pieces of a text in which "deg C" and "° F" are one word, as they are spoken."""
    place = 0
    while place < len(text):
        for word, blanks_needed in (("degrees", 0), ("degree", 0), ("deg", 0), ("°", 1)):
            is_word = word == "°" or not (place and (text[place - 1].isalnum() or text[place - 1] == "_"))
            rest = text[place + len(word) :]
            rest = rest.removeprefix(".") if word != "°" else rest
            blanks = len(rest) - len(rest.lstrip(" "))
            after = rest[blanks + 1 : blanks + 2]
            ends = not (after.isalnum() or after == "_")
            is_scale = rest[blanks : blanks + 1] in {"C", "F"} and ends and blanks >= blanks_needed
            if text.startswith(word, place) and is_word and is_scale:
                yield "deg" + rest[blanks]
                place = len(text) - len(rest) + blanks + 1
                break
        else:
            yield text[place]
            place += 1


class Reader:
    """A place in a text."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0

    def peek(self, ahead: int = 0) -> str:
        """Return a character, "" behind the end."""
        place = self.at + ahead
        return self.text[place] if 0 <= place < len(self.text) else ""

    def run(self, of: str) -> str:
        """Take the characters that are of a kind."""
        begin = self.at
        while self.peek() and self.peek() in of:
            self.at += 1
        return self.text[begin : self.at]

    def take(self, what: str) -> bool:
        """Take a word if it stands here."""
        if self.text.startswith(what, self.at):
            self.at += len(what)
            return True
        return False

    def blanks(self) -> bool:
        """Take blanks; tell whether there were any."""
        return bool(self.run(" "))


def ten_to(reader: Reader, digits: int) -> int | None:
    """Take "10^3" or "10³"; None, with nothing taken, where there is none."""
    begin = reader.at
    if reader.take("10"):
        if reader.peek() in SMALL and reader.peek():
            small = reader.run("".join(SMALL))
            plain = "".join(SMALL[character] for character in small)
            if plain.lstrip("+-").isdigit() and len(plain) - len(plain.lstrip("+-")) <= 1:
                return int(plain)
        elif reader.take("^"):
            reader.blanks()
            sign = reader.peek() if reader.peek() in {"+", "-"} else ""
            reader.take(sign)
            power = reader.run(DIGITS)
            if 0 < len(power) <= digits and reader.peek() not in {"."}:
                return int(sign + power)
    reader.at = begin
    return None


def decimal(reader: Reader) -> str | None:
    """Take "1.5", ".5", "5." or "1e-3"; None, with nothing taken, where there is none."""
    begin = reader.at
    if reader.peek() in {"+", "-"}:
        reader.at += 1
    whole = reader.run(DIGITS)
    part = reader.run(DIGITS) if reader.take(".") else ""
    if not whole and not part:
        reader.at = begin
        return None
    here = reader.at
    if reader.peek() in {"e", "E"}:
        reader.at += 1
        if reader.peek() in {"+", "-"}:
            reader.at += 1
        if not reader.run(DIGITS):
            reader.at = here
    return reader.text[begin : reader.at]


def leading_number(reader: Reader) -> float:
    """Take the number of a quantity."""
    begin = reader.at
    sign = reader.peek() if reader.peek() in {"+", "-"} else ""
    reader.take(sign)
    ten = ten_to(reader, 3)
    if ten is not None:
        return in_range(float(f"{sign}1e{ten}"), "1")
    reader.at = begin
    number = decimal(reader)
    if number is None:
        raise RefusedError("no number")
    here = reader.at
    reader.blanks()
    if reader.peek() in {"*", "·", "x"} and reader.peek():
        reader.at += 1
        reader.blanks()
        ten = ten_to(reader, 3)
        if ten is not None:
            if "e" in number.lower():
                raise RefusedError("two powers")
            return in_range(float(f"{number}e{ten}"), number)
    reader.at = here
    return in_range(float(number), number.lower().split("e")[0])


def in_range(value: float, digits: str) -> float:
    """Refuse what a number cannot hold."""
    if not math.isfinite(value) or (value == 0 and any(digit in digits for digit in "123456789")):
        raise RefusedError("out of range")
    return value


def split(text: str) -> tuple[float, str]:
    """Take a text apart into number and unit text."""
    plain = normalised(text)
    if not plain or len(text) > 200 or "±" in text or "," in text.split("^")[0] or "_" in text:
        raise RefusedError("no quantity")
    if any(band in text for band in ("+-", "+/-", "+ -", "+/ -", "+ /-", "+ / -")):
        raise RefusedError("a band")
    reader = Reader(plain)
    value = leading_number(reader)
    rest = plain[reader.at :].strip()
    if rest.startswith("^"):
        raise RefusedError("a power")
    if rest[:1] in {"*", "·"}:
        rest = rest[1:].strip()
        if rest[:1] in {"", "/", *DIGITS}:
            raise RefusedError("a product of numbers, or of nothing")
    again = Reader(rest)
    if rest[:1] and rest[0] in DIGITS + ".":
        again.run(DIGITS)
        one_over = rest[0] == "1" and rest[1:].strip().startswith("/")
        power = rest[:2] == "10" and rest[2:3] in {"^", *SMALL} and bool(rest[2:3])
        if not (
            one_over or power or (rest[0] == "1" and rest[1:2] in {"e", "E"} and decimal(Reader(rest[:1] + rest[1:])))
        ):
            raise RefusedError("a second number")
    return value, rest


def exponent(reader: Reader, *, behind_letters: bool) -> tuple[Fraction, bool]:
    """Take an exponent, 1 where there is none; tell whether it is a bare digit."""
    bare = Fraction(0)
    if behind_letters:
        place = 1 if reader.peek() == "-" else 0
        digit, after = reader.peek(place), reader.peek(place + 1)
        if digit and digit in DIGITS:
            if after and (after in DIGITS or after in ".eE^" or after in SMALL):
                raise RefusedError("a number")
            bare = Fraction(int(digit) * (-1 if place else 1))
            reader.at += place + 1
            if bare == 0:
                raise RefusedError("exponent 0")
    if reader.peek() and reader.peek() in SMALL:
        sign = reader.run("⁻⁺")
        digits = reader.run("⁰¹²³⁴⁵⁶⁷⁸⁹")
        if len(sign) > 1 or not digits or bare:
            raise RefusedError("superscript")
        return Fraction(int("".join(SMALL[one] for one in sign + digits))), False
    if reader.peek() != "^":
        return (bare, True) if bare else (Fraction(1), False)
    reader.at += 1
    if bare:
        raise RefusedError("two exponents")
    inside = reader.take("(")
    if inside:
        reader.blanks()
    number = decimal_plain(reader)
    if inside:
        reader.blanks()
        below = ""
        if reader.take("/"):
            reader.blanks()
            below = reader.run(DIGITS)
            reader.blanks()
            if not below or "." in number or int(below) == 0:
                raise RefusedError("fraction")
        if not reader.take(")"):
            raise RefusedError("open")
        return Fraction(number) / int(below or 1), False
    if reader.peek() and reader.peek() in DIGITS + ".eE^":
        raise RefusedError("no exponent")
    return Fraction(number), False


def decimal_plain(reader: Reader) -> str:
    """Take a number without a power of ten."""
    begin = reader.at
    if reader.peek() in {"+", "-"}:
        reader.at += 1
    if not reader.run(DIGITS):
        raise RefusedError("no exponent")
    if reader.peek() == "." and reader.peek(1) and reader.peek(1) in DIGITS:
        reader.at += 1
        reader.run(DIGITS)
    return reader.text[begin : reader.at]


LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"


def factor(reader: Reader, depth: int) -> list[Factor]:
    """Take one factor of a product."""
    if reader.take("("):
        inner = product(reader, depth + 1)
        if not reader.take(")"):
            raise RefusedError("open")
        power, _ = exponent(reader, behind_letters=False)
        return raised(inner, power)
    scale = next((scale for scale in ("°C", "°F") if reader.take(scale)), "")
    name = scale or (reader.peek() if reader.peek() in SIGNS else reader.run(LETTERS))
    if name in SIGNS:
        reader.at += 1
    power, is_bare = exponent(reader, behind_letters=name not in SIGNS)
    if name in COUNTS and is_bare and power != -1:
        raise RefusedError("a count with a digit")
    if name in PRODUCTS:
        if power != 1:
            raise RefusedError("ambiguous")
        return [(one, Fraction(1)) for one in PRODUCTS[name]]
    if name not in TABLE:
        raise RefusedError(f"no unit {name}")
    return raised([(name, Fraction(1))], power)


def raised(factors: list[Factor], power: Fraction) -> list[Factor]:
    """Raise a product to a power within limits."""
    found = [(name, own * power) for name, own in factors]
    if power == 0 or abs(power) > 12 or any(abs(own) > 12 for _, own in found):
        raise RefusedError("exponent")
    return found


def product(reader: Reader, depth: int = 0) -> list[Factor]:
    """Take a product up to its end or a closing parenthesis."""
    if depth > 12:
        raise RefusedError("too deep")
    reader.blanks()
    sign, divided = 1, False
    begin = reader.at
    if reader.take("1") and (reader.blanks() or True) and reader.take("/"):
        sign, divided = -1, True
        reader.blanks()
    else:
        reader.at = begin
    found = [(name, sign * own) for name, own in factor(reader, depth)]
    while True:
        before = reader.peek(-1)
        was_blank = reader.blanks()
        mark = reader.peek()
        if mark in {"", ")"}:
            return found
        sign = 1
        if mark == "/":
            sign, divided = -1, True
            reader.at += 1
        elif mark == "*":
            reader.at += 1
        elif divided:
            raise RefusedError("ambiguous")
        elif mark == "·":
            reader.at += 1
        elif mark == "-":
            if was_blank or before in {" ", ""} or reader.peek(1) not in LETTERS or not reader.peek(1):
                raise RefusedError("a minus")
            reader.at += 1
        reader.blanks()
        found += [(name, sign * own) for name, own in factor(reader, depth)]


def unit(text: str) -> tuple[int, list[Factor]]:
    """Take a unit text apart: the power of ten before it and its factors."""
    plain = normalised(text)
    if plain[:1] == "[" and plain[-1:] == "]":
        plain = plain[1:-1].strip()
    if plain in {"", "1", "-"}:
        return 0, []
    if plain.startswith("/"):
        plain = "1" + plain
    reader, power = Reader(plain), 0
    if plain[0] in DIGITS and not (plain[0] == "1" and plain[1:].strip().startswith("/")):
        ten = ten_to(reader, 4)
        if ten is None:
            number = decimal(reader) or ""
            ten = power_of(number)
        power = ten
        reader.blanks()
        joined = reader.peek() in {"*", "·"} and bool(reader.peek())
        if joined:
            reader.at += 1
            reader.blanks()
        rest = plain[reader.at :]
        if abs(power) > 30 or (joined and (not rest or rest.startswith("/"))):
            raise RefusedError("power of ten")
        if not rest:
            return power, []
        reader = Reader("1" + rest if rest.startswith("/") else rest)
    found = product(reader)
    if reader.peek():
        raise RefusedError("not closed")
    return power, found


def power_of(number: str) -> int:
    """Return the power of ten that a number is."""
    value = Fraction(number) if number else Fraction(0)
    power = 0
    while value > 1 and power < 40:
        value, power = value / 10, power + 1
    while 0 < value < 1 and power > -40:
        value, power = value * 10, power - 1
    if value != 1:
        raise RefusedError("a number in the unit")
    return power


def size(power: int, factors: list[Factor]) -> tuple[float, Dimension]:
    """Return factor and dimension."""
    scale, dimension = 10.0**power, [Fraction(0)] * 5
    for name, own in factors:
        one, exponents = TABLE[name]
        scale *= one ** float(own)
        dimension = [have + own * each for have, each in zip(dimension, exponents, strict=True)]
    return scale, tuple(dimension)


def read(text: str, declared: str) -> float:
    """Return a quantity in SI. Raises RefusedError where it is none of the kind of the declared unit."""
    value, rest = split(text)
    power, factors = unit(rest)
    declared_power, declared_factors = unit(declared)
    scale, dimension = size(power, factors)
    declared_scale, wanted = size(declared_power, declared_factors)
    if not rest.strip():
        if any(wanted) or declared_scale != 1:
            raise RefusedError("no unit")
        return value
    if dimension != wanted:
        raise RefusedError("another kind")
    if power and not factors:
        raise RefusedError("two numbers")
    is_level = declared in LEVELS
    alone = len(factors) == 1 and factors[0][1] == 1
    given = factors[0][0] if alone and factors[0][0] in LEVELS else ""
    if any(name in LEVELS for name, _ in factors) and dimension == (0, 0, 0, 1, 0) and (not given or power):
        raise RefusedError("a level in a product")
    if bool(given) != is_level and not (is_level and alone and factors[0][0] in {"K", "mK"}):
        raise RefusedError("a level for a difference")
    found = value * scale + (LEVELS[given] if given else 0.0)
    if is_level and found < -1e-9:
        raise RefusedError("below absolute zero")
    if not math.isfinite(found) or (found == 0 and value != 0 and not is_level):
        raise RefusedError("out of range")
    return max(found, 0.0) if is_level else found
