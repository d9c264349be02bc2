"""calc run: the calculation, its studies, and the sheet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from truing.cli.console import Settings, columns, one_line, out, out_json, progress_bar, say, settings_of, verb
from truing.cli.load import find_offer
from truing.errors import UsageError

if TYPE_CHECKING:
    from truing.calculation import Calculation
    from truing.cases import CasesTable
    from truing.kernel import Offer
    from truing.setup import Setup


@verb
def run(
    context: typer.Context,
    plugin: str = typer.Argument(..., help="An installed plugin's name, or a Python file."),
    inputs: Path | None = typer.Option(None, "--inputs", "-i", help="The inputs file; without it the shipped example."),
    changed: list[str] = typer.Option([], "--set", metavar="NAME=VALUE", help="Replace one value of the inputs file."),
    cases: Path | None = typer.Option(None, "--cases", help="A CSV file: every row is a case."),
    output: Path | None = typer.Option(None, "--output", "-o", help="The run folder (default runs/STEM)."),
    workers: int = typer.Option(1, "--workers", min=1, help="Processes that share the work."),
    pdf: bool = typer.Option(False, "--pdf", help="Print the sheet to PDF with an installed browser."),
    as_json: bool = typer.Option(False, "--json", help="results.json on stdout as well."),
) -> int:
    """Run the calculation and its studies and write the calculation sheet."""
    from truing.report.run import RunOrder, perform

    settings = settings_of(context)
    offer = find_offer(plugin, settings)
    setup = _setup(offer, inputs, changed, settings)
    folder = output or Path("runs") / (inputs.stem if inputs else offer.name)
    with progress_bar(settings) as progress:
        order = RunOrder(folder=folder, cases=cases, workers=workers, pdf=pdf)
        done = perform(setup, offer, order, progress)
    if not settings.quiet:
        for warning in done.calculation.warnings:
            say(f"warning: {one_line(warning)}")
    if as_json:
        out_json(done.document)
    else:
        out("\n".join(_lines(done.calculation, done.cases, folder)))
    if done.note and not settings.quiet:
        say(done.note)
    return 0 if done.passed else 1


def _setup(offer: Offer, inputs: Path | None, changed: list[str], settings: Settings) -> Setup:
    from truing.example_file import example_text
    from truing.inputs_file import read_setup, setup_from_text

    if inputs is not None:
        return read_setup(inputs, offer, overrides=changed)
    if not settings.quiet:
        say(f"no --inputs: running the shipped example (calc init {offer.name} writes it to a file)")
    return setup_from_text(example_text(offer), offer, file="the example", folder=Path.cwd(), overrides=changed)


def _lines(calculation: Calculation, cases: CasesTable | None, folder: Path) -> Iterator[str]:
    model = calculation.setup.model
    yield one_line(f"{model.name}: {model.title}")
    if cases is not None:
        case = cases.cases[cases.governing]
        failed = f", {len(cases.failed)} of them failed" if cases.failed else ""
        yield f"{len(cases.cases)} cases{failed}; governing: row {case.row} {one_line(case.name)}".rstrip()
    yield ""
    yield columns([_result_row(calculation, name) for name in calculation.answers if _is_number(calculation.answers[name])], right=(1,))
    if calculation.checks:
        yield ""
        yield columns([("check", "value", "limit", "unit", "margin", ""), *map(_check_row, calculation.checks)], right=(1, 2, 4))
    yield ""
    yield f"sheet: {folder / 'sheet.html'}"


def _is_number(value: Any) -> bool:
    return getattr(value, "ndim", 0) == 0


def _result_row(calculation: Calculation, name: str) -> tuple[str, ...]:
    from truing.numbers import format_value

    item = calculation.setup.model.result_fields[name]
    number, unit = format_value(calculation.answers[name], calculation.setup.print_unit(name))
    return (name, number, unit, one_line(item.spec.note))


def _check_row(check: Any) -> tuple[str, ...]:
    from truing.numbers import format_number
    from truing.units import unit_text

    verdict = "pass" if check.passed else "FAILS"
    values = (format_number(check.value), format_number(check.limit), unit_text(check.unit), format_number(check.margin, 3))
    return (one_line(check.name), *values, verdict)


def workers_of(count: int) -> str:
    """Return the address of an executor for so many workers."""
    if count < 1:
        raise UsageError("--workers needs at least 1")
    return "serial" if count == 1 else f"processes:{count}"
