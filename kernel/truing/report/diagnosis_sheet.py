"""The sheet of a diagnosis: neutral content first, then HTML and Markdown from the same content."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from truing.diagnosis.result import DiagnosisResult
from truing.report.chapters import Figures, numbered
from truing.report.context import Chapter, Head
from truing.report.diagnosis_chapters import diagnosis_chapters
from truing.report.diagnosis_words import headline, verdict_word
from truing.report.render import markdown_page, page
from truing.report.sheet import head_of, logo_of
from truing.runs.diagnosis_document import file_labels
from truing.runs.provenance import Provenance


@dataclass(frozen=True, kw_only=True)
class DiagnosisSheet:
    """Everything on the sheet of a diagnosis, in order; ``mood`` is how the verdict looks: calm, found or open."""

    head: Head
    detail: str
    mood: str
    verdict: str
    sentences: tuple[str, ...]
    unit_errors: tuple[str, ...]
    data: str
    chapters: tuple[Chapter, ...]
    warnings: tuple[str, ...]
    provenance: Provenance


def make_diagnosis_sheet(diagnosis: DiagnosisResult, *, provenance: Provenance) -> DiagnosisSheet:
    """Say everything that stands on the sheet of a diagnosis."""
    drawn = Figures()
    chapters = list(diagnosis_chapters(diagnosis, drawn))
    warnings = tuple(_warnings(diagnosis, drawn))
    if warnings:
        chapters.append(Chapter("", "warnings", "Warnings", "warnings"))
    chapters.append(Chapter("", "provenance", "Provenance", "provenance"))
    head = head_of(diagnosis.setup, provenance)
    return DiagnosisSheet(
        head=replace(head, footer=" · ".join(part for part in ("Diagnosis", head.footer) if part)),
        detail=diagnosis.setup.sheet.detail,
        mood=_mood(diagnosis),
        verdict=verdict_word(diagnosis),
        sentences=tuple(headline(diagnosis)),
        unit_errors=tuple(unit_error.text for unit_error in diagnosis.records.unit_errors),
        data=data_words(diagnosis),
        chapters=tuple(numbered(chapters, 1).values()),
        warnings=warnings,
        provenance=provenance,
    )


def _mood(diagnosis: DiagnosisResult) -> str:
    if diagnosis.verdict == "none":
        return "calm"
    return "found" if diagnosis.verdict == "named" and diagnosis.remainder is None else "open"


def data_words(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, in a line."""
    records = diagnosis.records
    runs = len(set(records.run_of.tolist()))
    in_files = sum(count.in_file for count in records.counts)
    of_all = f" of {in_files}" if in_files > len(records) else ""
    counted = f"{len(records)}{of_all} rows, {runs} run{'' if runs == 1 else 's'}"
    return f"{', '.join(file_labels(records.files))}: {counted}"


def _warnings(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[str]:
    yield from filter(None, [logo_of(diagnosis.setup)[1]])
    yield from drawn.failures


def diagnosis_html(sheet: DiagnosisSheet) -> str:
    """Write the sheet of a diagnosis as HTML."""
    return page("diagnosis.html.j2", sheet, styles=("sheet.css", "diagnosis.css"))


def diagnosis_markdown(sheet: DiagnosisSheet) -> str:
    """Write the sheet of a diagnosis as Markdown."""
    return markdown_page("diagnosis.md.j2", sheet)
