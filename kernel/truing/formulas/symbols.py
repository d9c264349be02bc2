"""Symbols, numbers and units as they are written in declarations, taken apart for printing."""

from __future__ import annotations

import re
from dataclasses import dataclass
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


@dataclass(frozen=True, slots=True)
class Symbol:
    """A declared symbol in runs of letters: ``Delta z_2'`` has the base Δ z, the subscript 2 and one prime.

    A single letter is set in italics, but for the Δ or δ before another letter (``is_difference``).
    """

    base: tuple[str, ...]
    subscript: tuple[str, ...]
    primes: int

    @property
    def is_difference(self) -> bool:
        """Whether the first run of the base is the sign of a difference."""
        return len(self.base) > 1 and self.base[0] in {"Δ", "δ"}

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
    pieces: list[str] = []
    for word in (word for word in re.split(r"[_,]", subscript) if word.strip()):
        pieces += [*([","] if pieces else []), *(GREEK.get(part, part) for part in word.split())]
    return Symbol(tuple(GREEK.get(word, word) for word in base.split()), tuple(pieces), base_primes + subscript_primes)


def _without_primes(text: str) -> tuple[str, int]:
    bare = text.rstrip(PRIMES + " ")
    return bare, sum(character in PRIMES for character in text[len(bare) :])


def symbol_text(symbol: str) -> str:
    """Write a declared symbol in plain characters, for a terminal: ``theta_11`` as ``θ_11``."""
    parts = read_symbol(symbol)
    subscript = f"_{''.join(parts.subscript)}" if parts.subscript else ""
    return "".join(parts.base) + subscript + "′" * parts.primes


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
