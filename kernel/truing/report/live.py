"""What a calculation says while its inputs are edited: verdict, limits, key results, and every result by its section.

It is the sheet without formulas, figures and inputs: what can be read in one look and made in a few milliseconds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from truing.calculation import Calculation
from truing.numbers import RESULT_DIGITS, format_number
from truing.report.chapters import RANK, Figures, Writing, front_figure, result_table
from truing.report.document import Banner, Chapter, Document, FigureView, Items, Marked, TableView, Text, Value
from truing.report.html_printer import page
from truing.report.limits import check_table
from truing.report.page_one import key_results
from truing.report.sheet import SHEET, banner_of, head_of
from truing.report.sheet_units import as_printed, sheet_units
from truing.report.translation import catalogue_of, translated
from truing.runs.comparison import Change, amount_of, compared, words_of
from truing.runs.documents import decided_by, results_document
from truing.runs.provenance import provenance_of
from truing.units import unit_text

FURTHER = "Further results"
RUN_DECIDES = "Run calculates the studies of this file."
HAS_DECIDED = "The last run, of these inputs, has decided it."
COMPARED = {"inputs", "tolerances", "correlations", "conditions", "effects", "results", "checks"}
"""What is compared with a saved run: what a calculation without its studies has."""


@dataclass(frozen=True)
class LiveSheet:
    """The numbers as HTML, and the verdict in words; ``changed`` counts the results that differ from a saved run."""

    html: str
    mood: str
    headline: str
    changed: int | None = None


def live_sheet(
    calculation: Calculation, saved: Mapping[str, Any] | None = None, name: str = "",
    run: Mapping[str, Any] | None = None,
) -> LiveSheet:  # fmt: skip
    """Write the numbers of a calculation whose studies did not run.

    ``saved`` is results.json of a run ``name``: what differs from it is marked, with its value before. ``run`` is that
    of a run of the same inputs, with its studies: what these decided holds. Raises UsageError where ``saved`` is no
    run.
    """
    if run is not None:
        calculation = replace(calculation, decided=decided_by(run, calculation.checks))
    words = catalogue_of(calculation.setup)
    changes = [] if saved is None else list(_changes(calculation, saved))
    calculation = as_printed(calculation)
    marks = {change.name: change for change in changes if change.kind == "results"}
    front = [*_given(changes, name), *_front(calculation, changes, marks)]
    sections = [
        replace(chapter, blocks=tuple(_marked(calculation, block, marks) for block in chapter.blocks))
        for chapter in _sections(calculation)
    ]
    provenance = provenance_of(calculation.setup)
    document = Document(
        kind=SHEET, title="", head=head_of(calculation.setup, provenance), detail="normal",
        summary="", banner=_banner(calculation, is_run=run is not None), front=tuple(front), chapters=tuple(sections),
        warnings=calculation.warnings, provenance=provenance,
    )  # fmt: skip
    document = translated(document, words)
    html = page("workbench/live.html.j2", "", styles=(), sheet=document, language=document.language)
    banner = document.banner
    return LiveSheet(html, banner.mood, banner.headline, None if saved is None else len(marks))


def _banner(calculation: Calculation, *, is_run: bool) -> Banner:
    """Say the verdict; of limits that only studies decide, that a run does so, or has done."""
    banner = banner_of(calculation, None)
    if is_run:
        return replace(banner, sentences=(*banner.sentences, HAS_DECIDED))
    if calculation.verdict != "undecided":
        return banner
    return replace(banner, sentences=(*banner.sentences, RUN_DECIDES))


def live_figure(calculation: Calculation) -> FigureView | None:
    """Draw the figure of page one; None where the sheet has none. Raises nothing for one that cannot be drawn."""
    setup = calculation.setup
    figures = Figures(catalogue_of(setup), units=sheet_units(setup))
    chapter = front_figure(Writing(as_printed(calculation), "normal", figures))
    views = () if chapter is None else chapter.blocks
    return next((view for view in views if isinstance(view, FigureView)), None)


def _front(calculation: Calculation, changes: Sequence[Change], marks: Mapping[str, Change]) -> Iterator[Chapter]:
    if calculation.checks:
        yield Chapter("Checks", (_marked_checks(calculation, changes),), "checks")
    if keys := key_results(calculation):
        yield Chapter("Key results", (_marked(calculation, result_table(calculation, keys), marks),), "key-results")


def _sections(calculation: Calculation) -> Iterator[Chapter]:
    """Write every result by the section of the sheet that names it, then those that none names."""
    model, known = calculation.setup.model, {*calculation.answers, *calculation.absent}
    named: set[str] = set()
    for level in sorted(RANK, key=lambda level: RANK[level]):
        for section in model.sheet:
            names = [name for name in section.names if name in known and name in model.result_fields]
            if section.level == level and names:
                named.update(names)
                yield Chapter(section.whole_title, (result_table(calculation, names),))
    rest = [name for name in model.result_fields if name in known and name not in named]
    if rest:
        yield Chapter(FURTHER if named else "Results", (result_table(calculation, rest),))


# Beside a saved run


def _changes(calculation: Calculation, saved: Mapping[str, Any]) -> Iterator[Change]:
    """Return what differs from a saved run in what a calculation without studies has."""
    document = results_document(calculation, provenance_of(calculation.setup))
    undecided = {check.name for check in calculation.checks if check.undecided}
    for change in compared(saved, document):
        is_lacking = change.kind in {"results", "checks"} and change.after is None
        if change.kind in COMPARED and not is_lacking and not (change.kind == "checks" and change.name in undecided):
            yield change


def _given(changes: Sequence[Change], name: str) -> Iterator[Chapter]:
    """Say which inputs are others than in the saved run, which is what the other differences come from."""
    if not name:
        return
    given = [words_of(change) for change in changes if change.kind not in {"results", "checks"}]
    said = tuple(
        f"{label.replace('_', ' ')}: {before} → {after}{f' ({by})' if by else ''}"
        for _, label, before, after, by in given
    )
    yield Chapter(f"Beside {name}", (Items("changed", said or ("All inputs are the same.",)),), "beside")


def _marked(calculation: Calculation, table: Any, marks: Mapping[str, Change]) -> Any:
    """Write into a table of results what those were that differ."""
    if not marks or not isinstance(table, TableView):
        return table
    rows, states = [], []
    for row in table.rows:
        label = row[1] if isinstance(row[1], tuple) else (row[1],)
        change = marks.get(next((str(piece.text) for piece in label if isinstance(piece, Marked)
                                 and piece.kind == "bracketed code"), ""))  # fmt: skip
        rows.append(row if change is None else (*row[:2], _before(row[2], change, row[3]), *row[3:]))
        states.append("" if change is None else "changed")
    return replace(table, rows=tuple(rows), states=tuple(states))


def _marked_checks(calculation: Calculation, changes: Sequence[Change]) -> TableView:
    table = check_table(calculation)
    marks = {change.name: change for change in changes if change.kind == "checks"}
    rows = [
        row if check.name not in marks else (row[0], _before(row[1], marks[check.name]), *row[2:])
        for row, check in zip(table.rows, calculation.checks, strict=True)
    ]
    states = [f"{check.state} changed" if check.name in marks else check.state for check in calculation.checks]
    return replace(table, rows=tuple(rows), states=tuple(states))


def _before(value: Text, change: Change, unit: Text = "") -> Text:
    """Write a value with what it was in the saved run, and by how much it moved; its unit may stand beside already."""
    piece = change.before if isinstance(change.before, Mapping) else {}
    number, by = piece.get("value"), amount_of(change)
    if isinstance(number, (int, float)) and not isinstance(number, bool):
        own = unit_text(piece.get("unit") or "")
        was = Value(format_number(number, RESULT_DIGITS), "" if own == unit else own)
    else:
        was = Value(words_of(change)[2] if change.before is not None else "not there")
    pieces = value if isinstance(value, tuple) else (value,)
    return (*pieces, Marked("break", ", "), "was ", was, f" ({by})" if by else "")
