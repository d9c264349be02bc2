"""The sheet of a diagnosis: the answer on page one, then its chapters."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from truing.diagnosis.records import file_labels
from truing.diagnosis.result import Amount, DiagnosisResult, explanations_of, stated_remedy
from truing.diagnosis.sentences import say, sentence
from truing.report import diagnosis_figures as figures
from truing.report import translation
from truing.report.chapters import Figures, numbered
from truing.report.diagnosis_chapters import diagnosis_chapters
from truing.report.diagnosis_remedy import then_table
from truing.report.diagnosis_sizes import amount_text
from truing.report.diagnosis_units import diagnosis_as_printed
from truing.report.diagnosis_words import headline, meaning_of, prose, remedy_of, spoken, verdict_word, what_decides
from truing.report.document import (
    Banner,
    BlockView,
    Chapter,
    Document,
    Items,
    Paragraph,
    TableView,
    Text,
    lines_of,
    plain_text,
)
from truing.report.sheet import end_chapters, head_faults, head_of
from truing.report.sheet_units import sheet_units
from truing.report.translation import catalogue_of, translated
from truing.report.wording import in_words
from truing.runs.diagnosis_files import data_digests
from truing.runs.provenance import Provenance, provenance_of

DIAGNOSIS = "Diagnosis"
ROOM, LOWEST, HIGHEST = 152.0, 56.0, 105.0
"""Height of a page that figure and texts share, and of the figure at the least and at the most, mm."""
LINE, GAP, WIDE = 4.3, 1.7, 105
"""Height of a line and of the gap behind a paragraph, mm, and the characters of a line."""
MOST_OTHERS = 3
"""Of so many other explanations page one says what they would ask for."""
MOST_MEANINGS = 5
"""Of so many causes page one says what they are."""
BELOW, BESIDE = "Below", "On the right"
DOUBT = "Whether this is the cause is open: settle that before anything is changed on the machine."


def diagnosis_sheet_of(diagnosis: DiagnosisResult, started: float) -> Document:
    """Return what a diagnosis says, with where its numbers and its data come from."""
    provenance = provenance_of(diagnosis.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    provenance = replace(provenance, files={**provenance.files, **data_digests(diagnosis)})
    return make_diagnosis_sheet(diagnosis, provenance=provenance)


def make_diagnosis_sheet(diagnosis: DiagnosisResult, *, provenance: Provenance) -> Document:
    """Say everything that stands on the sheet of a diagnosis."""
    units, words = sheet_units(diagnosis.setup), catalogue_of(diagnosis.setup, translation.DIAGNOSIS)
    diagnosis, drawn = diagnosis_as_printed(diagnosis), Figures(words, units=units)
    sentences, to_do = tuple(_answer(diagnosis)), tuple(_what_to_do(diagnosis))
    high = _figure_height([*sentences, *_texts(to_do)])
    front = tuple(_page_one(diagnosis, drawn, to_do, high))
    chapters = list(diagnosis_chapters(diagnosis, drawn))
    warnings = (*head_faults(diagnosis.setup), *drawn.failures, *words.faults)
    head = head_of(diagnosis.setup, provenance)
    named = "found" if diagnosis.remainder is None else "open"
    mood = {"none": "calm", "named": named}.get(diagnosis.verdict, "open")
    document = Document(
        kind=DIAGNOSIS,
        title=f"{DIAGNOSIS}: {head.title}",
        head=replace(head, footer=" · ".join(part for part in (DIAGNOSIS, head.footer) if part)),
        detail=diagnosis.setup.sheet.detail,
        summary=data_words(diagnosis),
        banner=Banner(mood, verdict_word(diagnosis), sentences),
        alarms=tuple(unit_error.text for unit_error in diagnosis.records.unit_errors),
        front=front,
        figure_height=high,
        paper=diagnosis.setup.sheet.paper,
        chapters=numbered([*chapters, *end_chapters(warnings, provenance)]),
        warnings=warnings,
        provenance=provenance,
    )
    return translated(in_words(document, units), words)


def _texts(blocks: Iterable[BlockView]) -> Iterator[str]:
    """Give the texts of what to do."""
    for block in blocks:
        match block:
            case Paragraph(text):
                yield plain_text(text)
            case Items(_, texts, labels):
                yield from map(plain_text, texts)
                yield from filter(None, labels)
            case TableView(title, _, rows, note):
                yield from (title, *(plain_text(row[0]) for row in rows), plain_text(note))


def _figure_height(texts: Iterable[str]) -> float:
    """Return how high the figure may be (mm) so that page one has room for these texts and the signatures."""
    taken = sum(LINE * lines_of(text, WIDE) + GAP for text in texts)
    return min(HIGHEST, max(LOWEST, ROOM - taken))


def _answer(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give the headline but for what decides, which stands under what to do; where causes are named, what each is."""
    decides = {sentence(text) for text in what_decides(diagnosis)}
    names = (cause.effect for cause in diagnosis.causes)
    others = (name for explanation in explanations_of(diagnosis) for name in explanation)
    left = [name for name in dict.fromkeys((*names, *others)) if meaning_of(diagnosis, name)][:MOST_MEANINGS]
    for text in headline(diagnosis):
        if text in decides:
            continue
        yield text
        here = [name for name in left if spoken(name).lower() in text.lower()]
        left = [name for name in left if name not in here]
        said = (sentence(say("means", cause=spoken(name), text=meaning_of(diagnosis, name))) for name in here)
        yield from [" ".join(said)] * bool(here)


def _page_one(
    diagnosis: DiagnosisResult, drawn: Figures, to_do: tuple[BlockView, ...], high: float
) -> Iterator[Chapter]:  # fmt: skip
    """Give the picture of the result that gains most, over what tells most, and what to do about each cause."""
    shown = figures.shown_curves(diagnosis)
    gained = {gain.result: gain.rmse_before.value - gain.rmse_after.value for gain in diagnosis.gain}
    curves = max(shown, key=lambda each: gained.get(each.result, 0.0), default=None)
    covariate = None if curves is None else figures.telling_covariate(diagnosis, curves)
    if curves is not None and covariate is not None:
        title = f"{spoken(curves.result).capitalize()} over {spoken(covariate.name)}"
        where = BELOW if high >= figures.FLAT else BESIDE
        caption = f"{title}. {where}: what the model misses.{figures.thinning_words(diagnosis, curves)}"
        view = drawn.view(title, partial(figures.convincing, diagnosis, curves, covariate, high), caption)
        yield Chapter(title, (view,), "key-figure")
    if to_do:
        yield Chapter("What to do", to_do, "what-to-do")


def _what_to_do(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Say what settles the cause where it is open, and what each one asks for."""
    decides = [sentence(text) for text in what_decides(diagnosis)]
    if diagnosis.verdict != "named" and diagnosis.causes:
        yield Paragraph(DOUBT)
    if decides:
        labels = ("To settle it", *("" for _ in decides[1:]))
        yield Items("findings", tuple(decides), labels)
    asked = dict(_remedies(diagnosis))
    if asked:
        yield Items("findings", tuple(asked.values()), tuple(asked))
    then = then_table(diagnosis)
    if then is not None:
        yield then


def _remedies(diagnosis: DiagnosisResult) -> Iterator[tuple[str, Text]]:
    """Say of every named cause what to do, and of others that are open what they would ask for."""
    named = [cause.effect for cause in diagnosis.causes]
    yield from ((spoken(name), remedy_of(diagnosis, name)) for name in named)
    others = dict.fromkeys(name for names in explanations_of(diagnosis) for name in names if name not in named)
    stated = [(name, prose(stated_remedy(diagnosis, name))) for name in others]
    yield from [(f"{spoken(name)}, if it is that", remedy) for name, remedy in stated if remedy][:MOST_OTHERS]


def questions(diagnosis: DiagnosisResult) -> dict[str, tuple[str, ...]]:
    """Return what a diagnosis says to each of its questions, line by line, in the units of its sheet."""
    chapters = diagnosis_chapters(diagnosis_as_printed(diagnosis), Figures(skipped=True))
    said = sheet_units(diagnosis.setup).said
    return {
        chapter.title.removesuffix(" measurement"): tuple(map(said, chapter.lines))
        for chapter in chapters if chapter.lines
    }  # fmt: skip


def data_line(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, how long it took, and which model it was held against."""
    time = next((covariate for covariate in diagnosis.records.covariates.values() if covariate.role == "time"), None)
    lasting = ""
    if time is not None:
        hours = Amount(float(np.nanmax(time.values) - np.nanmin(time.values)), time.unit)
        lasting = f", {amount_text(hours)}"
    model = diagnosis.setup.model
    return (
        f"{data_words(diagnosis)}{lasting}; {model.name}: {model.title}, {len(diagnosis.calibrated)} inputs calibrated"
    )


def data_words(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, in a line."""
    records = diagnosis.records
    runs = len(set(records.run_of.tolist()))
    in_files = sum(count.in_file for count in records.counts)
    of_all = f" of {in_files}" if in_files > len(records) else ""
    counted = f"{len(records)}{of_all} rows, {runs} run{'' if runs == 1 else 's'}"
    return f"{', '.join(file_labels(records.files))}: {counted}"
