"""calc diagnose: what the simulation gets wrong, the cause, the extended model, and what it is worth."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

from truing.api.model import Diagnosis
from truing.api.records import MeasuredRecord
from truing.cli.console import Settings, broken, out, out_json, say
from truing.cli.load import find_model, say_example
from truing.diagnosis.result import DiagnosisResult
from truing.errors import UsageError
from truing.report.diagnosis_sheet import data_line, questions
from truing.report.diagnosis_words import headline, verdict_word
from truing.runs.provenance import provenance_of
from truing.texts import one_line
from truing.workbooks.reading import file_of

MISSPELT = "Did you mean"
"""A note that must be seen: a column that may be misspelt changes what is found."""


def diagnose(settings: Settings, asked: SimpleNamespace) -> int:
    """Find what the simulation gets wrong, name the cause, extend the model and measure the gain."""
    measured = (*(asked.data or ()), *(asked.files or ()))
    if not measured:
        raise UsageError("nothing to diagnose: name the measured rows with --data FILE.csv")
    model = find_model(asked.plugin, settings, asked.changed, asked.language)
    say_example(asked.inputs, asked.plugin, settings)
    folder = asked.output or Path("runs") / file_of(measured[0]).stem
    record, progress = MeasuredRecord(measured), not settings.quiet
    how = {name: getattr(asked, name) for name in ("pdf", "docx", "xlsx")}
    done = model.diagnose(record, asked.inputs, output=folder, progress=progress, **how)
    _say_beside(done, settings)
    if asked.docx:
        settings.say(f"for Word: {folder / 'sheet.docx'}")
    if asked.xlsx:
        settings.say(f"for a spreadsheet: {folder / 'diagnosis.xlsx'}")
    if asked.as_json:
        out_json(done.document)
    else:
        out("\n".join(lines_of(done.result, folder)))
    return 0


def _say_beside(done: Diagnosis, settings: Settings) -> None:
    """Say what is no result: what was done to the records, suspected slips, how the printing went."""
    records = done.result.records
    for slip in records.unit_errors:
        settings.say(f"warning: suspected unit slip: {one_line(slip.text)} (nothing was changed)")
    for count in (count for count in records.counts if count.unused):
        settings.say(f"{one_line(count.file)}: {one_line(count.sentence())}")
    for note in records.notes:
        (say if MISSPELT in note else settings.say)(f"note: {one_line(note)}")
    if done.note:
        settings.say(done.note)
    setup = done.result.setup
    settings.detail(f"input hash {provenance_of(setup).input_hash}, seed {setup.seed}")


# A diagnosis on the terminal: the verdict in sentences, then its five questions in a few lines each


INDENT = 18


def lines_of(diagnosis: DiagnosisResult, folder: Path) -> Iterator[str]:
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
