"""Putting a sheet together: from a finished calculation to everything that is printed, in order."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from truing.calculation import Calculation
from truing.cases import CaseResult, CasesTable
from truing.numbers import STATED_DIGITS, format_value, with_unit
from truing.published import ComparedRow
from truing.report.chapters import LONGEST_TABLE, Figures, Writing, numbered, result_chapters
from truing.report.content import (
    check_table,
    check_value,
    effect_blocks,
    input_blocks,
    least_margin,
    provenance_items,
    published_blocks,
    tolerance_table,
)
from truing.report.document import Banner, Chapter, Column, Document, Head, Items, Strong, TableView, Value, joined
from truing.runs.provenance import Provenance
from truing.setup import Setup
from truing.studies.checks import HEADLINES, SHORT, Proposal
from truing.studies.verdicts import sentence_of
from truing.units import unit_text

HEAD_FIELDS = {
    "project": "Project",
    "drawing": "Drawing",
    "revision": "Revision",
    "company": "Company",
    "customer": "Customer",
    "date": "Date",
}
SIGNATURES = {"prepared": "Prepared", "checked": "Checked", "approved": "Approved"}
PICTURES = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
LARGEST_LOGO = 500_000
NOT_SHOWN = {"title", "logo"}
NO_LIMITS = "No limits"
SHEET = "Calculation sheet"


def make_sheet(
    calculation: Calculation,
    *,
    provenance: Provenance,
    verified: Sequence[ComparedRow] = (),
    cases: CasesTable | None = None,
) -> Document:
    """Say everything that stands on the sheet of a calculation, at the level of detail of its setup."""
    setup = calculation.setup
    detail = setup.sheet.detail if setup.sheet.detail in LONGEST_TABLE else "normal"
    figures = Figures()
    results = list(result_chapters(Writing(calculation, detail, figures)))
    warnings = tuple(_warnings(calculation, cases, figures.failures))
    front = _front(calculation, cases, detail)
    back = () if detail == "short" else _back(setup, verified)
    end = end_chapters(warnings, provenance, references(calculation, detail))
    head = head_of(setup, provenance)
    return Document(
        kind=SHEET,
        title=head.title,
        head=head,
        detail=detail,
        summary=setup.model.summary,
        banner=banner_of(calculation, cases),
        chapters=numbered([*front, *results, *back, *end]),
        warnings=warnings,
        provenance=provenance,
    )


def head_of(setup: Setup, provenance: Provenance) -> Head:
    """Fill the title block; what the inputs file leaves open has room to be written by hand."""
    given = {name: str(text) for name, text in setup.sheet.head.items() if str(text).strip()}
    fields = [
        (label, given.get(name, provenance.date if name == "date" else "")) for name, label in HEAD_FIELDS.items()
    ]
    shown = [(label, text) for label, text in fields if text or label in {"Project", "Drawing", "Revision", "Date"}]
    signing = {key for name in SIGNATURES for key in (name, f"{name}_by")}
    others = [
        (name.replace("_", " ").capitalize(), text)
        for name, text in given.items()
        if name not in {*HEAD_FIELDS, *NOT_SHOWN, *signing}
    ]
    signatures = [(label, given.get(f"{name}_by", given.get(name, ""))) for name, label in SIGNATURES.items()]
    title = given.get("title", setup.model.title)
    logo, _ = logo_of(setup)
    parts = [title, given.get("project", ""), given.get("drawing", ""), given.get("revision", "")]
    return Head(
        title=title,
        model=setup.model.title if title != setup.model.title else "",
        fields=(*shown, *others),
        signatures=tuple(signatures),
        footer=" · ".join(part for part in parts if part),
        logo=logo,
    )


def logo_of(setup: Setup) -> tuple[str, str]:
    """Return the company's sign as a data address, and what is wrong with it; the file lies beside the inputs file."""
    name = str(setup.sheet.head.get("logo", "")).strip()
    if not name:
        return "", ""
    kind = PICTURES.get(Path(name).suffix.lower())
    if kind is None:
        return "", f"the logo '{name}' is left out: it must be a {', '.join(PICTURES)} file"
    path = Path(setup.source.file).parent / name
    try:
        if path.exists() and not path.is_file():  # a pipe would keep the sheet waiting
            return "", f"the logo '{name}' is left out: it is no ordinary file"
        with path.open("rb") as stream:
            content = stream.read(LARGEST_LOGO + 1)
    except (OSError, ValueError) as error:
        return "", f"the logo '{name}' is left out: {getattr(error, 'strerror', None) or error}"
    if len(content) > LARGEST_LOGO:
        return "", f"the logo '{name}' is left out: it is larger than {LARGEST_LOGO // 1000} kB"
    return f"data:{kind};base64,{b64encode(content).decode()}", ""


def banner_of(calculation: Calculation, cases: CasesTable | None) -> Banner:
    """Say the verdict, of all cases where there are some, and what the design that is proposed instead changes."""
    state = calculation.verdict if cases is None else cases.verdict
    text = sentence_of(calculation.decided) if cases is None else sentence_of_cases(cases)
    if not calculation.checks and state == "passes":
        return Banner("none", NO_LIMITS, (text,))
    proposal = _proposal(calculation, cases)
    if state != "proposed" or proposal is None:
        return Banner(state, HEADLINES[state], (text,))
    changes = joined(
        (Value(f"{name.replace('_', ' ')} {stated} → "), Strong(proposed))
        for name, stated, proposed in proposal.changes
    )
    return Banner(state, HEADLINES[state], (text, ("Changed: ", *changes, ".")))


def _proposal(calculation: Calculation, cases: CasesTable | None) -> Proposal | None:
    """Return the design that is proposed instead: of cases that of the first which needs one."""
    needing = (
        case.decided.proposal for case in (cases.cases if cases is not None else ()) if case.verdict == "proposed"
    )
    return next(needing, calculation.decided.proposal)


def sentence_of_cases(cases: CasesTable) -> str:
    """Say in one sentence how many cases keep every limit."""
    governing, count = case_name(cases.cases[cases.governing]), len(cases.cases)
    verdicts = [case.verdict for case in cases.cases]
    words = {"fails": "fail", "undecided": "are undecided", "proposed": "pass with the proposed changes only"}
    said = [f"{verdicts.count(state)} of {count} cases {how}" for state, how in words.items() if state in verdicts]
    if cases.verdict == "fails" and "fails" not in verdicts:
        said.append("but with different changes, so that no one design passes")
    if said:
        return f"{', '.join(said)}; the governing case is {governing}."
    return f"All {count} cases keep every limit; the governing case, {governing}, is shown in full."


def case_name(case: CaseResult) -> str:
    """Name a case: by its label, or by its row in the file."""
    return case.name or f"row {case.row}"


def _warnings(calculation: Calculation, cases: CasesTable | None, failures: Sequence[str]) -> Iterator[str]:
    yield from calculation.warnings
    yield from filter(None, [logo_of(calculation.setup)[1]])
    shown = calculation.failed[:20] if cases is None else ()
    for row, reason in shown:
        yield f"row {row} failed: {reason}"
    if len(calculation.failed) > len(shown) and cases is None:
        yield f"{len(calculation.failed) - len(shown)} further rows failed"
    yield from failures


def references(calculation: Calculation, detail: str) -> tuple[str, ...]:
    """Name the literature of the model, then that of the studies that ran; a short sheet has none."""
    outcomes = calculation.outcomes.values()
    texts = [*calculation.setup.model.cites, *(text for outcome in outcomes for text in getattr(outcome, "cites", ()))]
    return () if detail == "short" else tuple(dict.fromkeys(texts))


def _front(calculation: Calculation, cases: CasesTable | None, detail: str) -> Iterator[Chapter]:
    setup = calculation.setup
    if calculation.checks:
        yield Chapter("Checks", (check_table(calculation),), "checks")
    if cases is not None:
        yield Chapter("Cases", (cases_table(calculation, cases, LONGEST_TABLE[detail]),), "cases")
    if detail == "short":
        return
    yield Chapter("Inputs", tuple(input_blocks(setup, detail)), "inputs")
    if setup.distributions():
        yield Chapter("Tolerances in force", (tolerance_table(setup),), "tolerances")
    if setup.conditions or setup.effects:
        yield Chapter("Conditions and effects", tuple(effect_blocks(setup)), "effects")


def _back(setup: Setup, verified: Sequence[ComparedRow]) -> Iterator[Chapter]:
    findings = setup.model.findings
    if verified:
        yield Chapter("Paper against this calculation", tuple(published_blocks(setup, verified)), "published")
    if findings:
        texts, labels = tuple(each.text for each in findings), tuple(each.title for each in findings)
        yield Chapter("Findings", (Items("findings", texts, labels),), "findings")


def end_chapters(warnings: Sequence[str], provenance: Provenance, references: Sequence[str] = ()) -> Iterator[Chapter]:
    """Write what stands last on every sheet."""
    if warnings:
        yield Chapter("Warnings", (Items("warnings", tuple(warnings)),), "warnings")
    if references:
        yield Chapter("References", (Items("references", tuple(references)),), "references")
    yield Chapter("Provenance", (provenance_items(provenance),), "provenance")


def cases_table(calculation: Calculation, cases: CasesTable, most: int) -> TableView:
    """Write all cases: what each changes, its checks, its smallest margin; the governing one is marked."""
    setup = calculation.setup
    checks = list(dict.fromkeys(check.name for case in cases.cases for check in case.checks))
    numbers = [(name.replace("_", " "), format_value(0.0, setup.unit_of(name))[1]) for name in cases.varied]
    numbers += [(name.replace("_", " "), _check_unit(cases, name)) for name in checks]
    columns = (
        Column("Case"), *(Column(title, unit, "number") for title, unit in numbers),
        Column("Smallest margin", kind="number"), Column("Verdict"),
    )  # fmt: skip
    places = list(range(min(len(cases.cases), most)))
    if cases.governing not in places:
        places = [*places[:-1], cases.governing]
    rows = [_case_row(setup, cases.cases[place], cases.varied, checks) for place in places]
    left = len(cases.cases) - len(places)
    note = f"The governing case ({case_name(cases.cases[cases.governing])}) is the one calculated in full below."
    note += f" {left} further cases are not printed." if left else ""
    note += f" In the file: {cases.count.sentence()}."
    states = tuple("marked" if place == cases.governing else "" for place in places)
    return TableView("All cases", columns, tuple(rows), note, states)


def _check_unit(cases: CasesTable, name: str) -> str:
    check = next(check for case in cases.cases for check in case.checks if check.name == name)
    return "%" if check.chance else unit_text(check.unit)


def _case_row(setup: Setup, case: CaseResult, varied: Sequence[str], checks: Sequence[str]) -> tuple[str, ...]:
    values = [_case_value(setup, case.values, name) for name in varied]
    if case.reason is not None:
        return (case_name(case), *values, *("–" for _ in checks), "–", f"cannot be calculated: {case.reason}")
    found = {check.name: check_value(check, check.value).text for check in case.checks}
    broken = [check.name.replace("_", " ") for check in case.checks if check.state == case.verdict]
    verdict_text = case.verdict if case.verdict == "passes" else f"{SHORT[case.verdict]}: {', '.join(broken)}"
    margin = least_margin(case.checks)
    return (
        case_name(case),
        *values,
        *(found.get(name, "–") for name in checks),
        with_unit(margin.text, margin.unit),
        verdict_text,
    )


def _case_value(setup: Setup, values: Mapping[str, Any], name: str) -> str:
    value = values.get(name, setup.nominal(name))
    if isinstance(value, (str, bool)):
        return str(value)
    return format_value(value, setup.unit_of(name), STATED_DIGITS)[0]
