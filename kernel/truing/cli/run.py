"""calc run: the calculation, its studies, and the sheet."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from truing.api.run import Run
from truing.atomic import writings, written
from truing.cli.console import Settings, out, out_json, say, settings_of
from truing.cli.load import find_model, say_example
from truing.cli.run_printed import lines_of
from truing.errors import UsageError
from truing.runs.partial import is_partial, partial_folder
from truing.runs.provenance import provenance_of
from truing.studies.checks import EXIT_CODES
from truing.texts import one_line


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
    model = find_model(plugin, settings, changed)
    say_example(inputs, plugin, settings)
    folder = output or Path("runs") / (inputs.stem if inputs else model.name)
    with _told_what_is_kept(folder, resume, settings):
        done = model.run(
            inputs, cases=cases, workers=workers, cluster=cluster, output=folder, resume=resume, pdf=pdf, excel=excel,
            progress=not settings.quiet,
        )  # fmt: skip
    _say_beside(done, settings)
    if excel:
        tables = ["results.csv", *(["cases.csv"] if done.cases is not None else [])]
        settings.say(f"for a spreadsheet: {' and '.join(str(folder / name) for name in tables)}")
    _say_where_from(done, settings)
    if as_json:
        out_json(done.document)
    else:
        out("\n".join(lines_of(done, folder, with_titles=not settings.quiet)))
    return EXIT_CODES[done.verdict]


@contextmanager
def _told_what_is_kept(folder: Path, resume: bool, settings: Settings) -> Iterator[None]:
    """Say of batches that lie there whether they are taken up, and of an interrupt whether they are kept."""
    kept, before = partial_folder(folder), writings()
    if not resume and is_partial(kept):
        settings.say(f"note: {kept} holds finished batches of an interrupted run; --resume would take them up")
    try:
        yield
    except KeyboardInterrupt as end:
        if resume and kept.is_dir() and not written(before):
            end.args = (f"calc: interrupted; finished batches are kept in {kept}, the same command goes on from there",)
        raise


def _say_beside(done: Run, settings: Settings) -> None:
    """Say what is no result: warnings, cases that failed, how the printing went."""
    for warning in done.warnings:
        settings.say(f"warning: {one_line(warning)}")
    if done.cases is not None:
        for case in done.cases.cases:
            if case.reason is not None:
                say(str(case.fault))
    if done.note:
        settings.say(done.note)


def _say_where_from(done: Run, settings: Settings) -> None:
    """Say what was taken up of an interrupted run, and for those who ask for more where the numbers come from."""
    if done.computed["resumed"]:
        settings.say(f"{done.computed['resumed']} finished batches of an interrupted run were taken up")
    setup = done.calculation.setup
    stated = len(setup.source.stated & set(setup.model.input_fields))
    settings.detail(f"plugin {setup.origin.name} {setup.origin.version} from {setup.origin.file}")
    settings.detail(f"inputs: {stated} stated, {len(setup.model.input_fields) - stated} at their defaults")
    settings.detail(f"input hash {provenance_of(setup).input_hash}, seed {setup.seed}")
