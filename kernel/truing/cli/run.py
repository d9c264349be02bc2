"""calc run: the calculation, its studies, and the sheet."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from truing.atomic import writings, written
from truing.cli.console import Settings, one_line, out, out_json, say, settings_of
from truing.cli.load import find_offer, read_or_example
from truing.cli.progress import progress_bar
from truing.cli.run_printed import lines_of
from truing.errors import UsageError
from truing.inputs_file.culprit import told_by_line
from truing.report.run import Done, RunOrder, perform
from truing.runs.partial import is_partial, partial_folder
from truing.studies.checks import EXIT_CODES


def run(
    context: typer.Context,
    *,
    plugin: str,
    inputs: Path | None,
    changed: list[str] | None,
    cases: Path | None,
    output: Path | None,
    workers: int | None,
    cluster: str,
    resume: bool,
    pdf: bool,
    excel: bool,
    as_json: bool,
) -> int:
    """Run the calculation and its studies and write the calculation sheet."""
    settings = settings_of(context)
    if cluster and workers is not None:
        raise UsageError("--cluster and --workers exclude each other: a cluster has its own workers")
    offer = find_offer(plugin, settings)
    setup = read_or_example(offer, inputs, changed or (), word=plugin, settings=settings)
    folder = output or Path("runs") / (inputs.stem if inputs else offer.name)
    order = RunOrder(folder, cases, workers=workers or 1, cluster=cluster, resume=resume, pdf=pdf, excel=excel)
    with progress_bar(settings) as progress, told_by_line(setup), _told_what_is_kept(order, settings):
        done = perform(setup, offer, order, progress)
    _say_beside(done, order, settings)
    if as_json:
        out_json(done.document)
    else:
        out("\n".join(lines_of(done, folder, with_titles=not settings.quiet)))
    return EXIT_CODES[done.verdict]


@contextmanager
def _told_what_is_kept(order: RunOrder, settings: Settings) -> Iterator[None]:
    """Say of batches that lie there whether they are taken up, and of an interrupt whether they are kept."""
    kept, before = partial_folder(order.folder), writings()
    if not order.resume and is_partial(kept):
        settings.say(f"note: {kept} holds finished batches of an interrupted run; --resume would take them up")
    try:
        yield
    except KeyboardInterrupt as end:
        if order.resume and kept.is_dir() and not written(before):
            end.args = (f"calc: interrupted; finished batches are kept in {kept}, the same command goes on from there",)
        raise


def _say_beside(done: Done, order: RunOrder, settings: Settings) -> None:
    """Say what is no result: warnings, cases that failed, how the printing went, which tables were added."""
    for warning in (*done.calculation.warnings, *done.remarks):
        settings.say(f"warning: {one_line(warning)}")
    if done.cases is not None:
        for case in done.cases.cases:
            if case.reason is not None:
                say(str(case.fault))
    if done.note:
        settings.say(done.note)
    if order.excel:
        tables = ["results.csv", *(["cases.csv"] if done.cases is not None else [])]
        settings.say(f"for a spreadsheet: {' and '.join(str(order.folder / name) for name in tables)}")
    if done.resumed:
        settings.say(f"{done.resumed} finished batches of an interrupted run were taken up")
    setup = done.calculation.setup
    stated = len(setup.stated & set(setup.model.input_fields))
    settings.detail(f"plugin {setup.origin.name} {setup.origin.version} from {setup.origin.file}")
    settings.detail(f"inputs: {stated} stated, {len(setup.model.input_fields) - stated} at their defaults")
    settings.detail(f"input hash {done.document['input_hash']}, seed {setup.seed}")
