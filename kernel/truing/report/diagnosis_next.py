"""What to measure next: settings that separate explanations, and facts that do where no measurement does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from truing.declare.blocks import Words
from truing.diagnosis.result import APART, DiagnosisResult, NextPoint
from truing.numbers import ABSENT
from truing.report.context import BlockView, TableView
from truing.report.diagnosis_words import amount_text, listed, readable, score_text, spoken, together


def table_of(
    title: str, columns: Sequence[str], rows: Sequence[Sequence[str]], numeric: Sequence[int] = (), note: str = ""
) -> TableView:
    """Return a table of texts; ``numeric`` holds the indices of the columns that are set to the right."""
    flags = tuple(index in numeric for index in range(len(columns)))
    return TableView(title, tuple(columns), ("",) * len(columns), tuple(map(tuple, rows)), flags, note)


def next_blocks(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Write the chapter on the next measurement."""
    if not diagnosis.next and diagnosis.verdict == "one_of":
        yield Words("No setting can be proposed that tells the explanations apart.")
    elif not diagnosis.next:
        can_be_more = any(item.sight == "not excited" for item in diagnosis.seen) or diagnosis.not_measured
        yield Words(
            ("More readings would decide." if diagnosis.verdict == "undecided" else "There is nothing to separate.")
            + (" Of what was not excited or not measured (chapter 2) this data says nothing." if can_be_more else "")
        )
    else:
        yield from _points(diagnosis)
    yield from _ties(diagnosis)


def _points(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    names = list(dict.fromkeys(name for point in diagnosis.next for name in (*point.measure, *point.settings)))
    rows = [_point(index, point, names) for index, point in enumerate(diagnosis.next, start=1)]
    heads = ("Point", *(spoken(name).capitalize() for name in names), "Separates", "λ then")
    note = (
        "λ then is the separation to expect once all points up to this one are measured; from "
        f"{APART:.0f} on the two are apart."
    )
    yield table_of("Settings to measure", heads, rows, (*range(1, len(names) + 1), len(names) + 2), note)
    for reason in dict.fromkeys(point.why for point in diagnosis.next if point.why):
        yield Words(f"{reason[:1].upper()}{reason[1:].rstrip('.')}.")


def _ties(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Say which facts decide between explanations that no measurement proposed here tells apart."""
    for tie in diagnosis.ties:
        names = listed([together([name]) for name in tie.explanations])
        yield Words(f"No measurement proposed here tells {names} apart; a fact from elsewhere does.")
        facts = [
            (
                together([fact.explanation]), spoken(fact.quantity.removeprefix("input:")), fact.note or ABSENT,
                amount_text(readable(fact.value)),
            )
            for fact in tie.facts
        ]  # fmt: skip
        if facts:
            heads = ("If it is", "then this quantity", "that is", "has this value")
            yield table_of("Facts that decide", heads, facts, (3,))


def _point(place: int, point: NextPoint, names: Sequence[str]) -> tuple[str, ...]:
    settings = ["measure" if name in point.measure else amount_text(point.settings.get(name), 4) for name in names]
    pair = " / ".join(together([name]) for name in point.separates)
    return str(place), *settings, pair, score_text(point.separation)
