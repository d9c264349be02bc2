"""calc run: the calculation, its studies, and the sheet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from types import SimpleNamespace

from truing.api.run import Run
from truing.atomic import writings, written
from truing.calculation import Calculation
from truing.cases import CaseResult, CasesTable
from truing.cli.console import Settings, aligned, out, out_json, say
from truing.cli.load import find_model, say_example
from truing.errors import UsageError
from truing.numbers import ABSENT, counted, format_ends, format_value, with_unit
from truing.report.document import Value
from truing.report.limits import check_rows, least_margin
from truing.report.sheet import sentence_of_cases
from truing.report.sheet_units import as_printed, cases_as_printed
from truing.runs.partial import is_partial, partial_folder
from truing.runs.provenance import provenance_of
from truing.setup import Setup
from truing.studies.bench import files_of
from truing.studies.checks import EXIT_CODES, HEADLINES, SHORT
from truing.studies.verdicts import change_words, sentence_of
from truing.texts import one_line
from truing.workbooks.reading import file_of


def run(settings: Settings, asked: SimpleNamespace) -> int:
    """Run the calculation and its studies and write the calculation sheet."""
    if asked.cluster and asked.workers is not None:
        raise UsageError("--cluster and --workers exclude each other: a cluster has its own workers")
    model = find_model(asked.plugin, settings, asked.changed)
    say_example(asked.inputs, asked.plugin, settings)
    folder = asked.output or Path("runs") / (file_of(asked.inputs).stem if asked.inputs else model.name)
    how = {
        name: getattr(asked, name) for name in ("cases", "workers", "cluster", "resume", "pdf", "docx", "excel", "xlsx")
    }
    with _told_what_is_kept(folder, asked.resume, settings):
        done = model.run(asked.inputs, output=folder, progress=not settings.quiet, **how)
    tables = ["results.csv", *(["cases.csv"] if done.cases is not None else [])] if asked.excel else []
    _say_beside(done, [folder / name for name in (*tables, *(["results.xlsx"] if asked.xlsx else []))], settings)
    if asked.docx:
        settings.say(f"for Word: {folder / 'sheet.docx'}")
    if asked.as_json:
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


def _say_beside(done: Run, tables: Sequence[Path], settings: Settings) -> None:
    """Say what is no result: warnings, cases that failed, what else was written, and where the numbers come from."""
    for warning in done.warnings:
        settings.say(f"warning: {one_line(warning)}")
    for note in done.cases.notes if done.cases is not None else ():
        settings.say(f"note: {one_line(note)}")
    for case in done.cases.cases if done.cases is not None else ():
        if case.reason is not None:
            say(str(case.fault))
    if done.note:
        settings.say(done.note)
    if tables:
        settings.say(f"for a spreadsheet: {' and '.join(map(str, tables))}")
    if resumed := done.computed["resumed"]:
        batches = counted(resumed, "finished batch", "finished batches")
        settings.say(f"{batches} of an interrupted run {'was' if resumed == 1 else 'were'} taken up")
    setup = done.calculation.setup
    stated = len(setup.source.stated & set(setup.model.input_fields))
    settings.detail(f"plugin {setup.origin.name} {setup.origin.version} from {setup.origin.file}")
    settings.detail(f"inputs: {stated} stated, {len(setup.model.input_fields) - stated} at their defaults")
    settings.detail(f"input hash {provenance_of(setup).input_hash}, seed {setup.seed}")


# A finished run on the terminal: cases, results in the order of the sheet, checks, and where the sheet is


MOST_CASES = 40


def lines_of(done: Run, folder: Path, *, with_titles: bool) -> Iterator[str]:
    """Say what a run found, and what fails; ``with_titles`` puts the results under the sections of the sheet."""
    setup, calculation = done.calculation.setup, as_printed(done.calculation)
    done = replace(done, calculation=calculation, cases=cases_as_printed(done.cases, setup))
    model = calculation.setup.model
    yield one_line(f"{model.name}: {model.title}")
    if done.cases is not None:
        yield from _cases_lines(done.cases, calculation.setup)
    yield from _result_lines(calculation, with_titles=with_titles)
    yield from _absent_lines(calculation)
    if calculation.checks:
        yield ""
        yield from _checks(calculation)
    yield ""
    yield from _verdict_lines(done)
    yield f"sheet: {folder / 'sheet.html'}"
    for outcome in calculation.outcomes.values():
        yield from (f"beside it: {folder / name}" for name in files_of(outcome))


def _verdict_lines(done: Run) -> Iterator[str]:
    """Say which limits, or which cases, are not kept as stated, and what would have to change."""
    decided, verdict = done.calculation.decided, done.verdict
    if verdict == "passes":
        return
    said = sentence_of(decided) if done.cases is None else sentence_of_cases(done.cases)
    yield one_line(f"{HEADLINES[verdict]}. {said} (exit code {EXIT_CODES[verdict]})")
    if verdict == "proposed" and decided.proposal is not None:
        yield one_line(f"changed: {change_words(decided.proposal)}")


def _cases_lines(cases: CasesTable, setup: Setup) -> Iterator[str]:
    """Say every case with what it changes and its smallest margin; the results below are the governing one's."""
    heads = [f"{name} [{unit}]" if (unit := setup.print_unit(name)) else name for name in cases.varied]
    shown = [index for index in range(len(cases.cases)) if index < MOST_CASES or index == cases.governing]
    rows = [_case_row(cases.cases[index], setup, governs=index == cases.governing) for index in shown]
    yield ""
    yield from aligned([("row", "case", *heads, "margin", ""), *rows], right=(0, *range(2, len(heads) + 3)))
    if len(shown) < len(cases.cases):
        yield f"{len(cases.cases) - len(shown)} further cases stand in results.json"
    if cases.count.unused:
        yield f"{one_line(cases.read.file)}: {one_line(cases.count.sentence())}"


def _case_row(case: CaseResult, setup: Setup, *, governs: bool) -> tuple[str, ...]:
    values = [
        one_line(value) if isinstance(value, (str, bool)) else format_value(value, setup.print_unit(name))[0]
        for name, value in case.values.items()
    ]
    margin = _written(least_margin(case.checks))
    verdict = "failed" if case.reason else SHORT[case.verdict]
    return (str(case.row), one_line(case.name), *values, margin, verdict + ", governing" * governs)


def _result_lines(calculation: Calculation, *, with_titles: bool) -> Iterator[str]:
    """Give the results in the order of the sheet, under the titles of its sections where there are several."""
    groups = list(_groups(calculation))
    rows = iter(aligned([_result_row(calculation, name) for _, names in groups for name in names], right=(1,)))
    for index, (title, names) in enumerate(groups):
        if with_titles and len(groups) > 1:
            yield from ("", one_line(title))
        elif index == 0:
            yield ""
        yield from islice(rows, len(names))


def _absent_lines(calculation: Calculation) -> Iterator[str]:
    """Say which results do not exist, and why, a line per reason."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in calculation.absent.items():
        by_reason.setdefault(reason, []).append(name)
    for reason, names in by_reason.items():
        yield ""
        yield one_line(f"no {', '.join(names)}: {reason}")


def _groups(calculation: Calculation) -> Iterator[tuple[str, Sequence[str]]]:
    """Part the results into the sections of the sheet, each result once, and the rest."""
    left = dict.fromkeys(calculation.answers)
    for section in calculation.setup.model.sheet:
        names = [name for name in section.names if name in left]
        for name in names:
            del left[name]
        if names:
            yield section.whole_title, names
    if left:
        yield "Further results", list(left)


def _result_row(calculation: Calculation, name: str) -> tuple[str, ...]:
    result = calculation.setup.model.result_fields[name]
    value, print_unit = calculation.answers[name], calculation.setup.print_unit(name)
    if getattr(value, "ndim", 0):
        low, high, unit = format_ends(value, print_unit)
        return (name, f"{low} .. {high}" if low else ABSENT, unit, one_line(result.spec.note))
    return (name, *format_value(value, print_unit, result.digits), one_line(result.spec.note))


def _checks(calculation: Calculation) -> list[str]:
    """Say every limit: what is compared, with what, and what is left."""
    proposed = calculation.decided.proposal is not None
    head = ("check", "as stated" if proposed else "value", "", "limit", "margin", "", "as proposed" if proposed else "")
    lines = []
    for row in check_rows(calculation):
        check, last = row.check, one_line(row.remark) if row.proposed is None else _written(row.proposed)
        limit = _written(row.limit) + ("" if row.in_model is None else f" = {_written(row.in_model)}")
        numbers = _written(row.value), check.relation, limit, _written(row.margin)
        lines.append((one_line(check.compared or check.name), *numbers, SHORT[check.state], last))
    return aligned([head, *lines], right=(1, 3, 4))


def _written(value: Value) -> str:
    return with_unit(value.text, value.unit)
