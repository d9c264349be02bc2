"""What a column of a measured file may be to a model, where its name says it in other words: a guess, to be confirmed.

A guess goes by near names and their parts, by symbols and notes, and by the unit, which must be one of the same
quantity. ``temp_C`` is read as a temperature in degC.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from truing.errors import UnitError
from truing.inputs_file.values import SIGMA
from truing.units import check_unit, same_dimension
from truing.units.names import PURE

LEAST = 0.5
"""A guess that says less is none: of two names of two words, one must be the same."""
BY_UNIT = 0.35
"""What it says that only one quantity of the model has the unit of a column."""
BY_SYMBOL = 0.9
"""What it says that a column is called as the symbol of a quantity."""
BY_NOTE = 0.7
"""What a word says that stands in the note of a quantity, beside one of its name."""
SHORTEST = 3
"""So many letters may stand for a word that begins with them: "pos", "temp", "ang"."""
MEANT = {
    "C": "degC", "c": "degC", "celsius": "degC", "F": "degF", "sec": "s", "secs": "s", "seconds": "s", "mins": "min",
    "hours": "h", "hr": "h", "hrs": "h", "pct": "%", "percent": "%", "degree": "deg", "degrees": "deg", "U/min": "rpm",
    "Nm": "N*m", "kNm": "kN*m", "Nmm": "N*mm", "1/min": "rpm",
}  # fmt: skip
"""How units are called at the end of a name, where Truing does not call them so, or means something else by it."""
_IN_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[(/]\s*(?P<unit>[^()/]+(?:/[^()]+)?)\)?\s*$")
_AT_END = re.compile(r"^(?P<name>.+?)[\s_.\-](?P<unit>[^\s_.\-]+)$")
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^\W\d_]+|\d+")


@dataclass(frozen=True)
class Quantity:
    """A quantity that a column may hold: its name, declared unit, symbol, and what is noted of it."""

    name: str
    unit: str
    symbol: str = ""
    note: str = ""


@dataclass(frozen=True)
class Column:
    """A column that nobody knows: what [columns] would call it, its name as written, and its unit, None for none."""

    key: str
    name: str
    unit: str | None


@dataclass(frozen=True)
class Guess:
    """What a column may be, in which unit ("" where it has one already), and how much speaks for it, from 0 to 1."""

    name: str
    unit: str
    weight: float


def guesses(columns: Sequence[Column], quantities: Sequence[Quantity]) -> dict[str, Guess]:
    """Return by key what columns may be; each quantity at most once, that with the most for it."""
    several = [(guess, column.key) for column in columns for guess in _of_one(column, quantities)]
    made: dict[str, Guess] = {}
    taken: set[str] = set()
    for guess, key in sorted(several, key=lambda each: -each[0].weight):
        if key not in made and guess.name not in taken:
            made[key] = guess
            taken.add(guess.name)
    return made


def of_this_unit(column: Column, quantities: Sequence[Quantity]) -> dict[str, str]:
    """Return the quantities that have the unit of a column, each with that unit; it may stand at the end of its name.

    Empty where the column says no unit.
    """
    units = [column.unit] if column.unit is not None else [unit for _, unit in split_unit(column.name)][:1]
    return {each.name: unit for unit in units if unit not in PURE for each in quantities if _fits(unit, each.unit)}


def _of_one(column: Column, quantities: Sequence[Quantity]) -> Iterator[Guess]:
    """Give what a column may be, by its name with and without a unit at its end."""
    readings = [(column.name, column.unit)]
    if column.unit is None:
        readings += [(name, unit) for name, unit in split_unit(column.name) if _is_of_any(unit, quantities)][:1]
    best: dict[str, Guess] = {}
    for name, unit in readings:
        alike = [quantity for quantity in quantities if _fits(unit, quantity.unit)]
        is_only_one = sum(not quantity.name.startswith(SIGMA) for quantity in alike) == 1
        for quantity in alike:
            weight = _alikeness(name, quantity)
            if unit is not None and unit not in PURE and is_only_one:
                weight = min(1.0, weight + BY_UNIT)
            own = "" if column.unit is not None or quantity.unit in PURE else unit or quantity.unit
            if weight >= LEAST and (quantity.name not in best or weight > best[quantity.name].weight):
                best[quantity.name] = Guess(quantity.name, own, round(weight, 3))
    yield from best.values()


def split_unit(name: str) -> Iterator[tuple[str, str]]:
    """Give ways to take a name apart in a name and a unit that Truing knows: "temp_C", "force (kN)", "Weg/mm"."""
    for pattern in (_IN_BRACKETS, _AT_END):
        match = pattern.match(name)
        if match is None:
            continue
        unit = MEANT.get(match["unit"].strip(), match["unit"].strip())
        try:
            check_unit(unit)
        except UnitError:
            continue
        if unit not in PURE:
            yield match["name"].strip(" _.-"), unit


def _is_of_any(unit: str, quantities: Sequence[Quantity]) -> bool:
    return any(quantity.unit not in PURE and same_dimension(unit, quantity.unit) for quantity in quantities)


def _fits(unit: str | None, declared: str) -> bool:
    """Whether a column in this unit, or without one, may hold a quantity."""
    if unit is None:
        return True
    try:
        return same_dimension("" if unit in PURE else unit, "" if declared in PURE else declared)
    except UnitError:
        return False


def _alikeness(name: str, quantity: Quantity) -> float:
    """Return how much a name says for a quantity, from 0 to 1."""
    if quantity.symbol and name.replace("_", "") == quantity.symbol.replace("_", ""):
        return BY_SYMBOL
    said, own, noted = _words(name), _words(quantity.name), _words(quantity.note)
    if not said or not own:
        return 0.0
    whole = SequenceMatcher(None, "".join(said), "".join(own)).ratio()
    by_name = [max(_alike(word, other) for other in own) for word in said]
    by_note = [BY_NOTE * max((_alike(word, other) for other in noted), default=0.0) for word in said]
    shared = sum(max(pair) for pair in zip(by_name, by_note, strict=True)) if any(by_name) else 0.0
    covered = sum(max(_alike(word, other) for word in said) for other in own)
    words = (shared + covered) / (len(said) + len(own))
    return max(words, whole if whole >= 0.75 else 0.0)


def _alike(word: str, other: str) -> float:
    """Return 1 for one word, nearly as much where one begins the other or is a misprint of it, else 0."""
    if word == other:
        return 1.0
    short, long = sorted((word, other), key=len)
    if len(short) >= SHORTEST and long.startswith(short):
        return 0.9
    close = SequenceMatcher(None, word, other).ratio()
    return close if min(len(word), len(other)) > SHORTEST and close >= 0.8 else 0.0


def _words(text: str) -> list[str]:
    """Return the words of a name or a note, in small letters; numbers are words."""
    return [word.lower() for word in _WORDS.findall(text)]
