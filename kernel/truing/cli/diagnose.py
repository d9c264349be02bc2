"""calc diagnose: what the simulation gets wrong, the cause, the extended model, and what it is worth."""

from __future__ import annotations

from pathlib import Path

import typer

from truing.cli.console import Settings, one_line, out, out_json, say, settings_of
from truing.cli.diagnosis_printed import report
from truing.cli.load import find_offer, read_or_example
from truing.cli.progress import progress_bar
from truing.errors import UsageError
from truing.inputs_file.culprit import told_by_line
from truing.report.diagnosis_run import Diagnosed, DiagnosisOrder, perform_diagnosis
from truing.studies.bench import Progress

MISSPELT = "Did you mean"
"""A note that must be seen: a column that may be misspelt changes what is found."""


def diagnose(
    context: typer.Context,
    *,
    plugin: str,
    files: list[Path] | None,
    inputs: Path | None,
    data: list[Path] | None,
    changed: list[str] | None,
    output: Path | None,
    pdf: bool,
    as_json: bool,
) -> int:
    """Find what the simulation gets wrong, name the cause, extend the model and measure the gain."""
    settings = settings_of(context)
    measured = (*(data or ()), *(files or ()))
    if not measured:
        raise UsageError("nothing to diagnose: name the measured rows with --data FILE.csv")
    offer = find_offer(plugin, settings)
    setup = read_or_example(offer, inputs, changed or (), word=plugin, settings=settings)
    folder = output or Path("runs") / measured[0].stem
    with progress_bar(settings) as progress, told_by_line(setup):
        order = DiagnosisOrder(measured, folder, pdf)
        done = perform_diagnosis(setup, offer, order, _as_one(progress))
    _say_beside(done, settings)
    if as_json:
        out_json(done.document)
    else:
        out("\n".join(report(done.diagnosis, folder)))
    return 0


def _as_one(progress: Progress) -> Progress:
    """Return what shows the stages of a diagnosis as one task, and what comes after it as another."""
    return lambda stage, step, steps: progress("diagnosis" if steps else stage, step, steps)


def _say_beside(done: Diagnosed, settings: Settings) -> None:
    """Say what is no result: what was done to the records, suspected slips, how the printing went."""
    records = done.diagnosis.records
    for unit_error in records.unit_errors:
        settings.say(f"warning: suspected unit slip: {one_line(unit_error.text)} (nothing was changed)")
    for count in (count for count in records.counts if count.unused):
        settings.say(f"{one_line(count.file)}: {one_line(count.sentence())}")
    for note in records.notes:
        (say if MISSPELT in note else settings.say)(f"note: {one_line(note)}")
    if done.note:
        settings.say(done.note)
    settings.detail(f"input hash {done.document['input_hash']}, seed {done.document['seed']}")
