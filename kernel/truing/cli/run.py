"""calc run: the calculation, its studies, and the sheet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from truing.cli.console import Settings, aligned, columns, one_line, out, out_json, progress_bar, say, settings_of, verb
from truing.cli.load import find_offer, read_or_example
from truing.cli.words import AsJson, Changed, Plugin

if TYPE_CHECKING:
    from truing.calculation import Calculation
    from truing.cases import CasesTable
    from truing.report.run import Done


@verb
def run(
    context: typer.Context,
    plugin: Plugin,
    inputs: Annotated[
        Path | None, typer.Option("--inputs", "-i", help="The inputs file; without it the shipped example.")
    ] = None,
    changed: Changed = None,
    cases: Annotated[Path | None, typer.Option("--cases", help="A CSV file: every row is a case.")] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="The run folder (default runs/STEM).")] = None,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes that share the work.")] = 1,
    pdf: Annotated[bool, typer.Option("--pdf", help="Print the sheet to PDF with an installed browser.")] = False,
    as_json: AsJson = False,
) -> int:
    """Run the calculation and its studies and write the calculation sheet."""
    from truing.culprit import told_by_line
    from truing.report.run import RunOrder, perform

    settings = settings_of(context)
    offer = find_offer(plugin, settings)
    setup = read_or_example(offer, inputs, changed or (), settings)
    folder = output or Path("runs") / (inputs.stem if inputs else offer.name)
    order = RunOrder(folder=folder, cases=cases, workers=workers, pdf=pdf)
    with progress_bar(settings) as progress, told_by_line(setup):
        done = perform(setup, offer, order, progress)
    _say_beside(done, settings)
    if as_json:
        out_json(done.document)
    else:
        out("\n".join(_lines(done, folder, settings)))
    return 0 if done.passed else 1


def _say_beside(done: Done, settings: Settings) -> None:
    """Say what is no result: warnings, cases that failed, how the printing went."""
    for warning in done.calculation.warnings:
        settings.say(f"warning: {one_line(warning)}")
    if done.cases is not None:
        for case in done.cases.cases:
            if case.reason is not None:
                say(str(case.fault))
    if done.note:
        settings.say(done.note)
    setup = done.calculation.setup
    stated = len(setup.stated & set(setup.model.input_fields))
    settings.detail(f"plugin {setup.origin.name} {setup.origin.version} from {setup.origin.file}")
    settings.detail(f"inputs: {stated} stated, {len(setup.model.input_fields) - stated} at their defaults")
    settings.detail(f"input hash {done.document['input_hash']}, seed {setup.seed}")


def _lines(done: Done, folder: Path, settings: Settings) -> Iterator[str]:
    calculation = done.calculation
    model = calculation.setup.model
    yield one_line(f"{model.name}: {model.title}")
    if done.cases is not None:
        yield from _cases_lines(done.cases, calculation)
    yield from _result_lines(calculation, with_titles=not settings.quiet)
    if calculation.checks:
        yield ""
        yield columns(
            [("check", "value", "limit", "unit", "margin", "", ""), *_check_rows(calculation)], right=(1, 2, 4)
        )
    broken = [one_line(check.name) for check in calculation.checks if not check.passed]
    yield ""
    if broken:
        count = f"{len(broken)} of {len(calculation.checks)} checks"
        yield f"{count} FAIL: {', '.join(broken)} (exit code 1; the sheet shows why)"
    yield f"sheet: {folder / 'sheet.html'}"


def _cases_lines(cases: CasesTable, calculation: Calculation) -> Iterator[str]:
    """Say every case with what it changes and its smallest margin; the results below are the governing one's."""
    from truing.numbers import format_number, format_value

    setup = calculation.setup
    heads = [f"{name} [{unit}]" if (unit := setup.print_unit(name)) else name for name in cases.varied]
    rows = [("row", "case", *heads, "margin", "")]
    for place, case in enumerate(cases.cases):
        said = [case.values[name] for name in cases.varied]
        values = [
            one_line(value) if isinstance(value, (str, bool)) else format_value(value, setup.print_unit(name))[0]
            for name, value in zip(cases.varied, said, strict=True)
        ]
        margin = format_number(case.margin, 3) if case.checks else "–"
        verdict = "failed" if case.reason else "pass" if all(check.passed for check in case.checks) else "FAILS"
        rows.append(
            (str(case.row), one_line(case.name), *values, margin, verdict + ", governing" * (place == cases.governing))
        )
    yield ""
    yield columns(rows, right=(0, *range(2, len(heads) + 3)))


def _result_lines(calculation: Calculation, *, with_titles: bool) -> Iterator[str]:
    """Give the results in the order of the sheet, under the titles of its sections where there are several."""
    groups = list(_groups(calculation))
    rows = iter(aligned([_result_row(calculation, name) for _, names in groups for name in names], right=(1,)))
    for place, (title, names) in enumerate(groups):
        if with_titles and len(groups) > 1:
            yield from ("", one_line(title))
        elif place == 0:
            yield ""
        yield from islice(rows, len(names))


def _groups(calculation: Calculation) -> Iterator[tuple[str, Sequence[str]]]:
    """Part the results into the sections of the sheet, each result once, and the rest."""
    left = dict.fromkeys(calculation.answers)
    for section in calculation.setup.model.sheet:
        names = [name for name in section.names if name in left]
        for name in names:
            del left[name]
        if names:
            yield section.title, names
    if left:
        yield "Further results", list(left)


def _result_row(calculation: Calculation, name: str) -> tuple[str, ...]:
    from truing.numbers import format_value

    item = calculation.setup.model.result_fields[name]
    value, print_unit = calculation.answers[name], calculation.setup.print_unit(name)
    if getattr(value, "ndim", 0):
        return (name, *_range_words(value, print_unit), one_line(item.spec.note))
    return (name, *format_value(value, print_unit, item.digits), one_line(item.spec.note))


def _range_words(values: Any, print_unit: str) -> tuple[str, str]:
    """Say an array by its count and range."""
    import numpy as np

    from truing.numbers import format_value

    finite = values[np.isfinite(values)]
    if not finite.size:
        return "–", format_value(None, print_unit)[1]
    (low, unit), (high, _) = (format_value(edge, print_unit) for edge in (finite.min(), finite.max()))
    return f"{low} .. {high}", unit


def _check_rows(calculation: Calculation) -> Iterator[tuple[str, ...]]:
    from truing.numbers import format_number
    from truing.report.content import check_rows

    for check, row in zip(calculation.checks, check_rows(calculation), strict=True):
        numbers = (
            format_number(check.value),
            format_number(check.limit),
            row.limit.unit,
            format_number(check.margin, 3),
        )
        yield (one_line(check.name), *numbers, "pass" if check.passed else "FAILS", one_line(row.chance))
