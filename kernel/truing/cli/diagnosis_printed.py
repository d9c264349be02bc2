"""A diagnosis on the terminal: the verdict in sentences, then its five questions in a few lines each."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from truing.cli.console import broken
from truing.diagnosis.result import DiagnosisResult
from truing.report.diagnosis_sheet import data_line, questions
from truing.report.diagnosis_words import headline, verdict_word
from truing.texts import one_line

INDENT = 18


def report(diagnosis: DiagnosisResult, folder: Path) -> Iterator[str]:
    """Say what a diagnosis found: one block for each question, broken to the width of a terminal."""
    yield from broken(f"DIAGNOSIS  {one_line(data_line(diagnosis))}", 11)
    yield ""
    word = f"{verdict_word(diagnosis)}."
    for index, sentence in enumerate(headline(diagnosis)):
        yield from broken(one_line(f"{word} {sentence}" if not index else sentence), 0)
    yield ""
    for number, (question, lines) in enumerate(questions(diagnosis).items(), start=1):
        title = f"{number} {question}"
        for index, line in enumerate(lines):
            inner = " " * (len(line) - len(line.lstrip()))
            yield from broken((title if not index else "").ljust(INDENT) + inner + one_line(line), INDENT + len(inner))
    yield ""
    yield f"sheet: {folder / 'sheet.html'}"
    if diagnosis.causes:
        yield f"extended model: {folder / 'extended.toml'}"
    if diagnosis.remainder is not None:
        yield f"remainder as an effect: {folder / 'new_effect.py'}"
