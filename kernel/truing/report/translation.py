"""The words of a sheet in another language: a document is made in English, and translated before it is printed.

No writer of texts knows of it. A catalogue maps English to the other language, ``templates/words/LANGUAGE.toml`` for
the kernel and ``words/LANGUAGE.toml`` beside a plugin's files for its own. Its keys are whole texts, or texts with gaps
such as "{result} is off by {error}"; what stands in a gap is translated in the same way. What matches nothing stays
as it was written.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeAlias

from truing.errors import OutputError
from truing.report.document import Document, Head
from truing.report.wording import in_words
from truing.setup import Setup
from truing.templating import ENGLISH, template_folder

FOLDER: Final = "words"
"""Beside the files of a plugin: the folder of its words, a TOML file for each language."""
PLACES: Final = "in"
"""The table of words that hold in one place alone: in the gap of that name, or in ``DIAGNOSIS``, ``COMPARISON`` or
``STUDY``."""
DIAGNOSIS: Final = "diagnosis"
"""The sheet of a diagnosis: short texts such as "{result} over {covariate}" are the kernel's there, as they are in
the chapter of a study, and may be anybody's elsewhere."""
COMPARISON: Final = "comparison"
"""The page of two runs, or of two diagnoses."""
LISTS: Final = frozenset({
    "causes", "conditions", "course", "covariates", "explanation", "explanations", "facts", "inputs", "met", "names",
    "others", "reasons", "results", "settings", "shares", "waves",
})  # fmt: skip
"""Gaps that hold several things in a row: "a, b and c". In every other gap the word "and" is left alone."""
BETWEEN: Final = re.compile(r"(; and |, (?!(?:with|amplitude|range|by) )| and | or |; | \+ )")
"""What stands between the things of a row, outside of brackets; before some words a comma does not end a thing."""
IN_GAP: Final[Mapping[str, str]] = {
    **dict.fromkeys(("count", "draws", "number", "part", "parts", "row", "some", "step", "total"), r"[-+−\d.,e]+"),
    **dict.fromkeys(("axis", "grade", "next_grade"), r"\S+"),
    **dict.fromkeys(("note", "reason", "remedy", "text", "title", "why"), r".+"),
    "quantity": r"(?!the |an? ).+?", "amount": r"[-+−±]?\d.*?", "rows": r"[^,]+, (?:from the \w+|taken at random)|.+?",
    "are": "is|are", "explain": "explains|together explain", "rises": "rises|falls",
}  # fmt: skip
"""What may stand in a gap of some name: a number, one word, a name, whatever an author wrote, one of a few words."""
ONE_SENTENCE: Final = r"(?:(?!\. |\n).)+?"
"""What may stand in every other gap."""
GAP: Final = re.compile(r"{(\w+)}")
WORD: Final = re.compile(r"[^\W\d_]{2}")
"""What has no two letters in a row is a number or a symbol, and is not looked up."""
PARTS: Final = (("\n", re.compile("\n")), (" ", re.compile(r"(?<=[.?!]) ")))
"""Where a text may be parted whose whole is not known, and what then stands between: lines and sentences."""
FORMULA_WORDS: Final = re.compile(r"(?<=[>{\u00a0~])(if given|if|otherwise|and|or)(?=[<}\u00a0~])")
"""Words that the kernel sets into formulas, in MathML and LaTeX."""


@dataclass(frozen=True)
class _Pattern:
    """A text with gaps: the longest of its fixed words, by which it is found fast, and how many letters are fixed."""

    expression: re.Pattern[str]
    longest: str
    fixed: int
    translation: str


_Scope: TypeAlias = tuple[Mapping[str, str], tuple[_Pattern, ...]]


@dataclass(frozen=True)
class Catalogue:
    """The words of one language by their English ones, for each place where they hold; "" is everywhere.

    That of English holds none and changes nothing. ``own`` are those of the plugins of a sheet, which alone are asked
    for what a quantity is called. ``faults`` say what is wrong with words of plugins; those are left out.
    """

    language: str = ENGLISH
    places: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    own: Mapping[str, str] = field(default_factory=dict)
    faults: tuple[str, ...] = ()
    here: str = ""
    """The place of texts that stand in no gap."""
    _known: dict[tuple[str, str], str] = field(default_factory=dict, compare=False, repr=False)
    _scopes: dict[str, _Scope] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_english(self) -> bool:
        """Whether every text stays as it is."""
        return self.language == ENGLISH

    def at(self, place: str) -> Catalogue:
        """Return the same words where those of a place hold."""
        return replace(self, here=place) if place else self

    def said(self, text: str, place: str = "") -> str:
        """Return a text in this language: a whole one, one with gaps, sentence by sentence, or as it was written."""
        key = place or self.here, text
        if self.is_english or not WORD.search(text):
            return text
        if key not in self._known:
            inner = text.strip()
            before, _, behind = text.partition(inner)
            self._known[key] = f"{before}{self._whole(inner, key[0]) or self._by_parts(inner, key[0])}{behind}"
        return self._known[key]

    def name(self, note: str) -> str:
        """Return what a quantity is called: as its author says in this language, else as it is declared."""
        return self.own.get(note, note)

    def formula(self, markup: str) -> str:
        """Return a formula with its few words in this language."""
        return markup if self.is_english else FORMULA_WORDS.sub(lambda found: self.said(found[0]), markup)

    def row(self, text: str, place: str) -> str:
        """Return several things in a row, each in this language, and the words between them."""
        parts = _outside_of_brackets(text)
        things, between, written, start = parts[::2], parts[1::2], "", 0
        while start < len(things):
            ends = range(start + 1, len(things) + 1)  # a thing may hold such a word itself: the shortest that is known
            runs = ((end, self._whole("".join(parts[2 * start : 2 * end - 1]), place)) for end in ends)
            end, said = next((run for run in runs if run[1]), (start + 1, self.said(things[start], place)))
            written += said + (self._link(between[end - 1]) if end < len(things) else "")
            start = end
        return written

    def _link(self, between: str) -> str:
        words = between.strip(" ,;")
        return between.replace(words, self._whole(words, "")) if WORD.search(words) else between

    def _whole(self, text: str, place: str) -> str:
        """Return the translation of a whole text, with a capital and a full stop where it has them; else nothing."""
        plains = dict.fromkeys((text.removesuffix("."), text))
        starts = {start: plain for plain in plains for start in (plain, plain[:1].lower() + plain[1:])}
        words, patterns = self._scope(place)
        start, said = next(((start, words[start]) for start in starts if start in words), ("", ""))
        start, said = (start, said) if said else self._filled(patterns, starts)
        if not said:
            return ""
        plain = starts[start]
        return (said if plain.startswith(start) else said[:1].upper() + said[1:]) + text[len(plain) :]

    def _filled(self, patterns: Sequence[_Pattern], texts: Iterable[str]) -> tuple[str, str]:
        """Return one of some texts, and it by the pattern that leaves least open, its gaps filled; else nothing."""
        fitting = (
            (pattern.fixed, text, pattern.translation, match.groupdict())
            for pattern in patterns
            for text in texts
            if pattern.longest in text and (match := pattern.expression.fullmatch(text))
        )
        _, text, translation, held = max(fitting, key=lambda fit: fit[0], default=(0, "", "", {}))
        gaps = {gap: self.row(words, gap) if gap in LISTS else self.said(words, gap) for gap, words in held.items()}
        return text, GAP.sub(lambda gap: gaps[gap[1]], translation)

    def _scope(self, place: str) -> _Scope:
        """Return the words that hold in a place, those of the place before those that hold everywhere."""
        if place not in self._scopes:
            words = {**self.places.get("", {}), **self.places.get(place, {})}
            self._scopes[place] = words, tuple(_pattern(*each) for each in words.items() if GAP.search(each[0]))
        return self._scopes[place]

    def _by_parts(self, text: str, place: str) -> str:
        """Return a text line by line or sentence by sentence, by clauses that are all known, or without its unit."""
        for between, split in PARTS:
            parts = split.split(text)
            if len(parts) > 1:
                return between.join(self.said(part, place) for part in parts)
        clauses = text.split("; ")
        known = [self._whole(clause, place) for clause in clauses]
        if len(clauses) > 1 and all(known):
            return "; ".join(known)
        head, bracket, unit = text.rpartition(" [")
        return f"{self.said(head, place)}{bracket}{unit}" if head and unit.endswith("]") else text


def _outside_of_brackets(text: str) -> list[str]:
    """Part a row of things: things and what stands between them in turn; what is in brackets stays together."""
    parts, start = [], 0
    for between in BETWEEN.finditer(text):
        before = text[: between.start()]
        if before.count("(") == before.count(")"):
            parts += [text[start : between.start()], between[0]]
            start = between.end()
    return [*parts, text[start:]]


def _pattern(text: str, translation: str) -> _Pattern:
    parts, seen, written = GAP.split(text), set(), ""
    for index, part in enumerate(parts):
        if index % 2 == 0:
            written += re.escape(part)
        else:
            written += f"(?P={part})" if part in seen else f"(?P<{part}>{IN_GAP.get(part, ONE_SENTENCE)})"
            seen.add(part)
    fixed = parts[::2]
    return _Pattern(re.compile(written, re.DOTALL), max(fixed, key=len), sum(map(len, fixed)), translation)


ENGLISH_WORDS: Final = Catalogue()

# Catalogues, read from files


def catalogue_of(setup: Setup, place: str = "") -> Catalogue:
    """Return the words of the sheet of a calculation: the kernel's, those of guests that added to it, its plugin's.

    ``place`` is ``DIAGNOSIS`` for the sheet of a diagnosis.
    """
    sources = (*(added.file for added in setup.source.added), setup.origin.file)
    return catalogue(setup.sheet.language, sources, place)


def catalogue(language: str, sources: Iterable[str], place: str = "") -> Catalogue:
    """Return the kernel's words in a language, and those of plugins whose files these are; the last one's count."""
    if language == ENGLISH:
        return ENGLISH_WORDS
    places = {name: dict(words) for name, words in kernel_words(language).items()}
    own: dict[str, str] = {}
    faults: list[str] = []
    for source in dict.fromkeys(sources):
        file = Path(source).parent / FOLDER / f"{language}.toml"
        if source.endswith(".py") and file.is_file():
            try:
                for name, words in words_in(file).items():
                    places.setdefault(name, {}).update(words)
                    own |= words if not name else {}
            except OutputError as error:
                faults.append(str(error))
    return Catalogue(language, places, own, tuple(faults), place)


@cache
def kernel_words(language: str) -> Mapping[str, Mapping[str, str]]:
    """Return the kernel's words in a language by the English ones, for each place; none for English."""
    return {} if language == ENGLISH else words_in(template_folder() / FOLDER / f"{language}.toml")


@cache
def kernel_catalogue(language: str) -> Catalogue:
    """Return the kernel's words alone, for what a printer adds to a document."""
    return Catalogue(language, kernel_words(language))


def words_in(file: Path) -> dict[str, dict[str, str]]:
    """Read a file of words: by place, "" those that hold everywhere. Raises OutputError with all its faults."""
    try:
        data = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise OutputError(f"{file}: these words of a sheet are left out: {error}") from error
    tables = {**data.pop(PLACES, {}), "": data} if isinstance(data.get(PLACES, {}), dict) else {"": data}
    places = {name: dict(_entries(table if isinstance(table, dict) else {name: table})) for name, table in
              tables.items()}  # fmt: skip
    faults = [fault for words in places.values() for text, said in words.items() if (fault := _fault(text, said))]
    if faults:
        raise OutputError(f"{file}: these words of a sheet are left out: {'; '.join(faults)}")
    return places


def _entries(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Give the words of a table and of those inside of it, which are headings for their author."""
    for text, said in table.items():
        yield from _entries(said) if isinstance(said, dict) else [(text, said)]


def _fault(text: str, said: object) -> str:
    """Return what is wrong with a translation, or nothing."""
    if not isinstance(said, str) or not said.strip():
        return f"'{text}' needs a text in quotation marks"
    if {*GAP.findall(text)} != {*GAP.findall(said)}:
        return f"'{text}' and '{said}' differ in their gaps"
    return ""


# A document in another language


def translated(document: Document, words: Catalogue) -> Document:
    """Return a document in the language of a catalogue. Its ``lines`` for the terminal stay English."""
    if words.is_english:
        return document
    return replace(in_words(document, words), language=words.language, head=_head(document.head, words))


def _head(head: Head, words: Catalogue) -> Head:
    """Translate the labels of the title block; what the user wrote behind them stays."""
    return replace(
        head,
        title=words.said(head.title),
        model=words.said(head.model),
        fields=tuple((words.said(label), text) for label, text in head.fields),
        signatures=tuple((words.said(label), text) for label, text in head.signatures),
        footer=" · ".join(map(words.said, head.footer.split(" · "))),
    )
