"""Putting a sheet together: from a finished calculation to everything that is printed, in order."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from truing.calculation import Calculation
from truing.cases import CaseResult, CasesTable
from truing.declare.published import rules_of
from truing.numbers import STATED_DIGITS, format_value, with_unit
from truing.published import ComparedRow, parted
from truing.report.chapters import LONGEST_TABLE, Figures, Writing, numbered, result_chapters
from truing.report.content import (
    NOT_GIVEN,
    changed_inputs,
    check_rows,
    check_value,
    condition_rows,
    effect_rows,
    input_rows,
    least_margin,
    margins_words,
    tolerance_rows,
)
from truing.report.context import Banner, Chapter, Head, InputRow, Sheet, TableView
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
FEW = 6
"""So many inputs at a default of 0 still have rows of their own."""

NOT_SHOWN = {"title", "logo"}
NO_LIMITS = "No limits"


def make_sheet(
    calculation: Calculation,
    *,
    provenance: Provenance,
    verified: Sequence[ComparedRow] = (),
    cases: CasesTable | None = None,
) -> Sheet:
    """Say everything that stands on the sheet of a calculation, at the level of detail of its setup."""
    setup = calculation.setup
    detail = setup.sheet.detail if setup.sheet.detail in LONGEST_TABLE else "normal"
    figures = Figures()
    results = list(result_chapters(Writing(calculation, detail, figures)))
    own, elsewhere = parted(setup, verified)
    inputs, idle = _inputs(setup, detail)
    sheet = Sheet(
        head=head_of(setup, provenance),
        detail=detail,
        banner=_banner(calculation, cases),
        margins=margins_words(calculation.checks),
        summary=setup.model.summary,
        chapters=(),
        checks=tuple(check_rows(calculation)),
        inputs=inputs,
        idle_inputs=idle,
        tolerances=tuple(tolerance_rows(setup)),
        conditions=tuple(condition_rows(setup)),
        effects=tuple(effect_rows(setup)),
        changed=tuple(changed_inputs(setup)),
        compared=tuple(own),
        compared_elsewhere=tuple(elsewhere),
        rules=tuple(rules_of(row.published for row in verified).values()),
        findings=tuple(setup.model.findings),
        warnings=tuple(_warnings(calculation, cases, figures.failures)),
        references=tuple(references(calculation)),
        provenance=provenance,
    )
    chapters = [*_front(sheet, calculation, cases), *results, *_back(sheet)]
    return replace(sheet, chapters=tuple(numbered(chapters, 1).values()))


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


def _banner(calculation: Calculation, cases: CasesTable | None) -> Banner:
    """Say the verdict, of all cases where there are some."""
    state = calculation.verdict if cases is None else cases.verdict
    text = sentence_of(calculation.decided) if cases is None else sentence_of_cases(cases)
    proposal = _proposal(calculation, cases)
    if not calculation.checks and state == "passes":
        return Banner("none", NO_LIMITS, text, proposal)
    return Banner(state, HEADLINES[state], text, proposal)


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


def references(calculation: Calculation) -> Iterator[str]:
    """Name the literature of the model, then that of the studies that ran."""
    outcomes = calculation.outcomes.values()
    texts = [*calculation.setup.model.cites, *(text for outcome in outcomes for text in getattr(outcome, "cites", ()))]
    yield from dict.fromkeys(texts)


def _inputs(setup: Setup, detail: str) -> tuple[tuple[InputRow, ...], tuple[InputRow, ...]]:
    """Part the inputs into rows and, where there are many, those not given or at a default of 0 without a source."""
    rows = tuple(input_rows(setup))
    idle = tuple(row for row in rows if not row.stated and row.value.text in {"0", NOT_GIVEN} and not row.source)
    if detail == "full" or len(idle) <= FEW:
        return rows, ()
    return tuple(row for row in rows if row not in idle), idle


def _front(sheet: Sheet, calculation: Calculation, cases: CasesTable | None) -> Iterator[Chapter]:
    if sheet.checks:
        yield Chapter("", "checks", "Checks", "checks")
    if cases is not None:
        table = cases_table(calculation, cases, LONGEST_TABLE[sheet.detail])
        yield Chapter("", "cases", "Cases", "results", blocks=(table,))
    if sheet.detail == "short":
        return
    yield Chapter("", "inputs", "Inputs", "inputs")
    if sheet.tolerances:
        yield Chapter("", "tolerances", "Tolerances in force", "tolerances")
    if sheet.conditions or sheet.effects:
        yield Chapter("", "effects", "Conditions and effects", "effects")


def _back(sheet: Sheet) -> Iterator[Chapter]:
    if sheet.detail != "short" and (sheet.compared or sheet.compared_elsewhere):
        yield Chapter("", "published", "Paper against this calculation", "published")
    if sheet.detail != "short" and sheet.findings:
        yield Chapter("", "findings", "Findings", "findings")
    if sheet.warnings:
        yield Chapter("", "warnings", "Warnings", "warnings")
    if sheet.detail != "short" and sheet.references:
        yield Chapter("", "references", "References", "references")
    yield Chapter("", "provenance", "Provenance", "provenance")


def cases_table(calculation: Calculation, cases: CasesTable, most: int) -> TableView:
    """Write all cases: what each changes, its checks, its smallest margin; the governing one is marked."""
    setup = calculation.setup
    checks = list(dict.fromkeys(check.name for case in cases.cases for check in case.checks))
    titles = ["Case", *(name.replace("_", " ") for name in (*cases.varied, *checks)), "Smallest margin", "Verdict"]
    units = ["", *(format_value(0.0, setup.unit_of(name))[1] for name in cases.varied)]
    units += [_check_unit(cases, name) for name in checks] + ["", ""]
    places = list(range(min(len(cases.cases), most)))
    if cases.governing not in places:
        places = [*places[:-1], cases.governing]
    rows = [_case_row(setup, cases.cases[place], cases.varied, checks) for place in places]
    left = len(cases.cases) - len(places)
    note = f"The governing case ({case_name(cases.cases[cases.governing])}) is the one calculated in full below."
    note += f" {left} further cases are not printed." if left else ""
    note += f" In the file: {cases.count.sentence()}."
    numeric = (False, *(True,) * (len(titles) - 2), False)
    marked = places.index(cases.governing)
    return TableView("All cases", tuple(titles), tuple(units), tuple(rows), numeric, note, marked)


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
