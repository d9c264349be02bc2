"""Symbols, numbers and units as they are written in declarations, taken apart for printing."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum
from typing import Final

# fmt: off
_NAMES: Final = (
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
    "nu", "xi", "omicron", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
)
# fmt: on
GREEK: Final = {
    **dict(zip(_NAMES, "αβγδεζηθικλμνξοπρστυφχψω", strict=True)),
    **dict(zip((name.capitalize() for name in _NAMES), "ΑΒΓΔΕΖΗΘΙΚΛΜΝΞΟΠΡΣΤΥΦΧΨΩ", strict=True)),
    "vartheta": "ϑ",
    "ell": "ℓ",
}
"""Names that become letters."""

PRIMES: Final = "'’′"


class Style(Enum):
    """How a piece of a symbol is set."""

    ITALIC = "italic"
    UPRIGHT = "upright"
    DIGITS = "digits"


@dataclass(frozen=True, slots=True)
class LetterRun:
    """One run of letters in one style."""

    text: str
    style: Style


@dataclass(frozen=True, slots=True)
class Symbol:
    """A declared symbol: ``Delta z_2'`` has the base Δ z, the subscript 2 and one prime."""

    base: tuple[LetterRun, ...]
    subscript: tuple[LetterRun, ...]
    primes: int

    @property
    def is_plain(self) -> bool:
        """Whether an exponent can stand on the symbol without parentheses around it."""
        return len(self.base) == 1 and not self.primes


def printable(text: str) -> str:
    """Return text without control and direction characters, each run of white space as one space."""
    spaced = re.sub(r"\s+", " ", text)
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in spaced
    ).strip()


def read_symbol(symbol: str) -> Symbol:
    """Take a declared symbol apart; every text is accepted, what is no letter is kept as it stands."""
    base, _, subscript = printable(symbol).partition("_")
    base, base_primes = _without_primes(base)
    subscript, subscript_primes = _without_primes(subscript)
    if not base:
        base, subscript, subscript_primes, base_primes = printable(symbol) or "?", "", 0, 0
    bases = [_piece(word) for word in base.split()]
    if len(bases) > 1 and bases[0].text in ("Δ", "δ"):
        bases[0] = LetterRun(bases[0].text, Style.UPRIGHT)
    pieces: list[LetterRun] = []
    for word in (word for word in re.split(r"[_,]", subscript) if word.strip()):
        pieces += [LetterRun(",", Style.UPRIGHT)] if pieces else []
        pieces += [_piece(part) for part in word.split()]
    return Symbol(tuple(bases), tuple(pieces), base_primes + subscript_primes)


def _without_primes(text: str) -> tuple[str, int]:
    bare = text.rstrip(PRIMES + " ")
    return bare, sum(character in PRIMES for character in text[len(bare) :])


def _piece(word: str) -> LetterRun:
    if word in GREEK:
        return LetterRun(GREEK[word], Style.ITALIC)
    if word.isascii() and word.isdigit():
        return LetterRun(word, Style.DIGITS)
    if len(word) == 1 and word.isalpha():
        return LetterRun(word, Style.ITALIC)
    return LetterRun(word, Style.UPRIGHT)


def symbol_text(symbol: str) -> str:
    """Write a declared symbol in plain characters, for a terminal: ``theta_11`` as ``θ_11``."""
    parts = read_symbol(symbol)
    base = "".join(piece.text for piece in parts.base)
    subscript = "".join(piece.text for piece in parts.subscript)
    return base + (f"_{subscript}" if subscript else "") + "′" * parts.primes


def word_text(name: str) -> str:
    """Write the name of a quantity without a symbol: underscores become spaces."""
    return printable(name.replace("_", " "))


NUMBER: Final = re.compile(
    r"(?P<sign>[-+−]?)(?P<digits>(?:\d+(?:[\u2009\u202f\u00a0 ]\d{3})*(?:[.,]\d+)?|[.,]\d+))"
    r"(?:[eE](?P<exponent_sign>[-+−]?)(?P<exponent>\d+))?",
    re.ASCII,
)


@dataclass(frozen=True, slots=True)
class Decimal:
    """A printed number: sign, digits as given, and the power of ten if there is one."""

    negative: bool
    digits: str
    exponent: str


def read_number(text: str) -> Decimal | None:
    """Take a printed number apart; None for a text that is no number ("–", "not given")."""
    match = NUMBER.fullmatch(text.strip())
    if match is None:
        return None
    exponent = match["exponent"]
    if exponent is not None:
        exponent = exponent.lstrip("0") or "0"
        exponent = f"−{exponent}" if match["exponent_sign"] in ("-", "−") and exponent != "0" else exponent
    return Decimal(match["sign"] in ("-", "−") and match["sign"] != "", match["digits"], exponent or "")
