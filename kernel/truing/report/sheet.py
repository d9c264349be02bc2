"""The calculation sheet: what it says of inputs, limits, printed numbers and provenance, put together in order."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from truing.calculation import Calculation
from truing.cases import CaseResult, CasesTable
from truing.declare.published import rules_of
from truing.numbers import (
    ABSENT,
    format_number,
    format_stated,
    format_value,
    with_unit,
)
from truing.published import ComparedRow, parted
from truing.report.chapters import (
    LONGEST_TABLE,
    Figures,
    Writing,
    front_figure,
    numbered,
    result_chapters,
    study_chapters,
)
from truing.report.document import (
    Banner,
    BlockView,
    Chapter,
    Column,
    Document,
    FigureView,
    Head,
    Items,
    Marked,
    Paragraph,
    TableView,
    Text,
    Value,
    joined,
)
from truing.report.given import correlation_table, effect_blocks, input_blocks, tolerance_table
from truing.report.limits import MOST_CHECKS, check_table, check_value, least_margin
from truing.report.page_one import MOST_WARNINGS, page_one
from truing.report.sheet_units import SheetUnits, as_printed, cases_as_printed, sheet_units
from truing.report.translation import catalogue_of, translated
from truing.report.wording import STUDY
from truing.runs.provenance import Provenance
from truing.setup import Setup
from truing.studies.checks import HEADLINES, SHORT
from truing.studies.sampling import scatter_of
from truing.studies.verdicts import sentence_of
from truing.units import from_si, to_si, unit_text

HEAD_FIELDS = ("project", "document", "drawing", "revision", "customer", "date")
ALWAYS = {"project", "drawing", "revision", "date"}
"""Fields of the title block that are there to be filled in by hand, too."""
SIGNATURES = ("prepared", "checked", "approved")
PICTURES = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
LARGEST_LOGO = 500_000
LARGEST_STYLE = 200_000
NOT_SHOWN = {"title", "company", "address", "logo", "style"}
"""What stands elsewhere than in the fields of the title block."""
NO_LIMITS = "No limits"
SHEET = "Calculation sheet"


def make_sheet(
    calculation: Calculation, *, provenance: Provenance, verified: Sequence[ComparedRow] = (),
    cases: CasesTable | None = None, example: Setup | None = None,
) -> Document:  # fmt: skip
    """Say everything that stands on the sheet of a calculation, at the level of detail of its setup.

    ``example`` is the shipped one, against which the inputs are compared.
    """
    words = catalogue_of(calculation.setup)
    figures = Figures(words, units=sheet_units(calculation.setup))
    cases = cases_as_printed(cases, calculation.setup)
    calculation = as_printed(calculation)
    setup = calculation.setup
    if example is not None and setup.sheet.units:
        example = replace(example, sheet=setup.sheet, units=setup.units)
    detail = setup.sheet.detail if setup.sheet.detail in LONGEST_TABLE else "normal"
    writing = Writing(calculation, detail, figures)
    figure = front_figure(writing)
    results = list(result_chapters(writing))
    warnings = (*_warnings(calculation, cases, figures.failures), *words.faults)
    head, first = head_of(setup, provenance), page_one(calculation, example, figure, warnings)
    sheet = Document(
        kind=SHEET,
        title=head.title,
        head=head,
        detail=detail,
        summary=setup.model.summary,
        banner=banner_of(calculation, cases),
        front=first.chapters,
        figure_height=first.figure_height,
        figure_below=first.figure_below,
        chapters=numbered(
            [*_given(calculation, cases, detail), *results, *_back(calculation, verified, warnings, provenance)]
        ),
        warnings=warnings,
        provenance=provenance,
        paper=setup.sheet.paper,
    )
    return translated(sheet, words)


def study_sheet(calculation: Calculation, *, provenance: Provenance) -> Document:
    """Say what a study that was asked alone has found: its first figure on page one, and the inputs behind it."""
    setup, words = calculation.setup, catalogue_of(calculation.setup, STUDY)
    figures, calculation = Figures(words, units=sheet_units(setup)), as_printed(calculation)
    setup = calculation.setup
    detail = setup.sheet.detail if setup.sheet.detail in LONGEST_TABLE else "normal"
    (chapter,) = list(study_chapters(Writing(calculation, detail, figures))) or [Chapter("Study", ())]
    first = next((block for block in chapter.blocks if isinstance(block, FigureView)), None)
    rest = tuple(block for block in chapter.blocks if block is not first)
    warnings = (*_warnings(calculation, None, figures.failures), *words.faults)
    head = head_of(setup, provenance)
    found = [block.text for block in rest if isinstance(block, Paragraph) and block.kind == "finding"]
    alone = "Asked alone: the limits are judged by a run of the calculation."
    sheet = Document(
        kind=chapter.title,
        title=head.title,
        head=head,
        detail=detail,
        summary=setup.model.summary,
        banner=Banner("none", chapter.title, (*found, alone)),
        front=() if first is None else (Chapter(first.title, (first,), "key-figure"),),
        chapters=numbered([
            replace(chapter, blocks=rest), *_inputs_behind(setup, detail),
            *end_chapters(warnings, provenance, _references(calculation)),
        ]),
        warnings=warnings,
        provenance=provenance,
        paper=setup.sheet.paper,
    )  # fmt: skip
    return translated(sheet, words)


def _back(
    calculation: Calculation, verified: Sequence[ComparedRow], warnings: Sequence[str], provenance: Provenance
) -> Iterator[Chapter]:  # fmt: skip
    """Write what stands behind the results: the paper's numbers, findings, many warnings, literature, provenance."""
    setup = calculation.setup
    is_short = setup.sheet.detail == "short"
    if verified and not is_short:
        yield Chapter("Paper against this calculation", tuple(published_blocks(setup, verified)), "published")
    if setup.model.findings and not is_short:
        texts, titles = zip(*((each.text, each.title) for each in setup.model.findings), strict=True)
        yield Chapter("Findings", (Items("findings", texts, titles),), "findings")
    references = () if is_short else _references(calculation)
    yield from end_chapters(warnings if len(warnings) > MOST_WARNINGS else (), provenance, references)


def _references(calculation: Calculation) -> tuple[str, ...]:
    cites = [text for each in calculation.outcomes.values() for text in getattr(each, "cites", ())]
    return tuple(dict.fromkeys([*calculation.setup.model.cites, *cites]))


def head_of(setup: Setup, provenance: Provenance) -> Head:
    """Fill the title block; what the inputs file leaves open has room to be written by hand."""
    given = {name: str(text) for name, text in setup.sheet.head.items() if str(text).strip()}
    texts = {name: given.get(name, provenance.date if name == "date" else "") for name in HEAD_FIELDS}
    texts = {name: text for name, text in texts.items() if text or name in ALWAYS}
    elsewhere = {*HEAD_FIELDS, *NOT_SHOWN, *SIGNATURES, *(f"{name}_by" for name in SIGNATURES)}
    texts |= {name: text for name, text in given.items() if name not in elsewhere}
    title = given.get("title", setup.model.title)
    return Head(
        title=title,
        model=setup.model.title if title != setup.model.title else "",
        fields=tuple((name.replace("_", " ").capitalize(), text) for name, text in texts.items()),
        signatures=tuple((name.capitalize(), given.get(f"{name}_by", given.get(name, ""))) for name in SIGNATURES),
        footer=" · ".join(filter(None, [title, *(given.get(name) for name in ("project", "drawing", "revision"))])),
        logo=logo_of(setup)[0],
        letter=tuple(given[name] for name in ("company", "address") if name in given),
        style=style_of(setup)[0],
    )


def head_faults(setup: Setup) -> list[str]:
    """Say which files of the title block are left out, and why."""
    return list(filter(None, [logo_of(setup)[1], style_of(setup)[1]]))


def logo_of(setup: Setup) -> tuple[str, str]:
    """Return the company's sign as a data address, and what is wrong with it; the file lies beside the inputs file."""
    content, kind, fault = _beside(setup, "logo", PICTURES, LARGEST_LOGO)
    return (f"data:{kind};base64,{b64encode(content).decode()}" if content else ""), fault


def style_of(setup: Setup) -> tuple[str, str]:
    """Return the engineer's own style sheet, and what is wrong with it; the file lies beside the inputs file."""
    content, _, fault = _beside(setup, "style", {".css": "text/css"}, LARGEST_STYLE)
    try:
        return content.decode("utf-8-sig"), fault
    except UnicodeDecodeError:
        return "", f"the style '{setup.sheet.head['style']}' is left out: it is no UTF-8 text"


def _beside(setup: Setup, what: str, endings: Mapping[str, str], largest: int) -> tuple[bytes, str, str]:
    """Read a file that the head of the sheet names: its content, its kind by its ending, and what is wrong with it."""
    name = str(setup.sheet.head.get(what, "")).strip()
    if not name:
        return b"", "", ""
    left_out = f"the {what} '{name}' is left out"
    kind = endings.get(Path(name).suffix.lower())
    if kind is None:
        return b"", "", f"{left_out}: it must be a {', '.join(endings)} file"
    path = Path(setup.source.file).parent / name
    try:
        if path.exists() and not path.is_file():  # a pipe would keep the sheet waiting
            return b"", "", f"{left_out}: it is no ordinary file"
        with path.open("rb") as stream:
            content = stream.read(largest + 1)
    except (OSError, ValueError) as error:
        return b"", "", f"{left_out}: {getattr(error, 'strerror', None) or error}"
    if len(content) > largest:
        return b"", "", f"{left_out}: it is larger than {largest // 1000} kB"
    return content, kind, ""


def banner_of(calculation: Calculation, cases: CasesTable | None) -> Banner:
    """Say the verdict, of all cases where there are some, and what the design that is proposed instead changes.

    Of cases that is the design of the first which needs one.
    """
    state = calculation.verdict if cases is None else cases.verdict
    text = sentence_of(calculation.decided) if cases is None else sentence_of_cases(cases)
    if not calculation.checks and state == "passes":
        return Banner("none", NO_LIMITS, (text,))
    needing = (case.decided.proposal for case in (cases.cases if cases else ()) if case.verdict == "proposed")
    proposal = next(needing, calculation.decided.proposal)
    if state != "proposed" or proposal is None:
        return Banner(state, HEADLINES[state], (text,))
    changes = joined(
        (Value(f"{name.replace('_', ' ')} {stated} → "), Marked("strong", proposed))
        for name, stated, proposed in proposal.changes
    )
    return Banner(state, HEADLINES[state], (text, ("Changed: ", *changes, ".")))


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
    yield from head_faults(calculation.setup)
    shown = calculation.failed[:20] if cases is None else ()
    for row, reason in shown:
        yield f"row {row} failed: {reason}"
    if len(calculation.failed) > len(shown) and cases is None:
        yield f"{len(calculation.failed) - len(shown)} further rows failed"
    yield from failures


def _given(calculation: Calculation, cases: CasesTable | None, detail: str) -> Iterator[Chapter]:
    setup = calculation.setup
    if len(calculation.checks) > MOST_CHECKS:
        yield Chapter("All checks", (check_table(calculation),), "all-checks")
    if cases is not None:
        yield Chapter("Cases", (cases_table(calculation, cases, LONGEST_TABLE[detail]),), "cases")
    yield from _inputs_behind(setup, detail)


def _inputs_behind(setup: Setup, detail: str) -> Iterator[Chapter]:
    if detail == "short":
        return
    yield Chapter("Inputs", tuple(input_blocks(setup, detail)), "inputs")
    if setup.distributions():
        tables = [tolerance_table(setup)] + [correlation_table(setup)] * bool(scatter_of(setup).pairs)
        yield Chapter("Tolerances in force", tuple(tables), "tolerances")
    if setup.conditions or setup.effects:
        yield Chapter("Conditions and effects", tuple(effect_blocks(setup)), "effects")


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
    numbers = [(name.replace("_", " "), format_value(0.0, setup.print_unit(name))[1]) for name in cases.varied]
    firsts = {check.name: check for case in reversed(cases.cases) for check in case.checks}
    numbers += [
        (name.replace("_", " "), "%" if firsts[name].chance else unit_text(firsts[name].unit)) for name in checks
    ]
    columns = (
        Column("Case"), *(Column(title, unit, "number") for title, unit in numbers),
        Column("Smallest margin", kind="number"), Column("Verdict"),
    )  # fmt: skip
    places = list(range(min(len(cases.cases), most)))
    if cases.governing not in places:
        places = [*places[:-1], cases.governing]
    rows = [_case_row(setup, cases.cases[index], cases.varied, checks) for index in places]
    left = len(cases.cases) - len(places)
    note = f"The governing case ({case_name(cases.cases[cases.governing])}) is the one calculated in full below."
    note += f" {left} further cases are not printed." if left else ""
    note += f" In the file: {cases.count.sentence()}."
    states = tuple("marked" if index == cases.governing else "" for index in places)
    return TableView("All cases", columns, tuple(rows), note, states)


def _case_row(setup: Setup, case: CaseResult, varied: Sequence[str], checks: Sequence[str]) -> tuple[str, ...]:
    values = []
    for name in varied:
        value = case.values.get(name, setup.nominal(name))
        is_word = isinstance(value, (str, bool))
        units = setup.print_unit(name), setup.unit_of(name)
        values.append(str(value) if is_word else format_stated(value, *units)[0])
    if case.reason is not None:
        return (case_name(case), *values, *("–" for _ in checks), "–", f"cannot be calculated: {case.reason}")
    texts = {check.name: check_value(check, check.value).text for check in case.checks}
    broken = [check.name.replace("_", " ") for check in case.checks if check.state == case.verdict]
    verdict_text = case.verdict if case.verdict == "passes" else f"{SHORT[case.verdict]}: {', '.join(broken)}"
    margin = least_margin(case.checks)
    shown = [texts.get(name, "–") for name in checks]
    return (case_name(case), *values, *shown, with_unit(margin.text, margin.unit), verdict_text)


def published_blocks(setup: Setup, verified: Sequence[ComparedRow]) -> Iterator[BlockView]:
    """Say what the paper prints beside what the calculation gives, first for the settings of this run."""
    own, elsewhere = parted(setup, verified)
    units = SheetUnits(setup.sheet.units)
    rules = "; ".join(rules_of(row.published for row in verified).values())
    yield Paragraph(f"Judged by kind of figure: {rules}.", "aside")
    if own:
        yield _compared("Printed for the settings of this run", own, units, with_settings=False)
    if elsewhere:
        title = "Printed for other settings, calculated with those"
        alone = "Calculated with the settings that each number is printed for; this run has others"
        yield _compared(title if own else alone, elsewhere, units, with_settings=True)


def _side_by_side(row: ComparedRow, unit: str) -> tuple[str, str, str]:
    """Write the number of the paper, ours with one digit more, and the unit: that of the paper, or of the sheet."""
    printed = row.published
    paper = format_number(printed.value, 10)
    digits = len(paper.partition("e")[0].replace(".", "").replace("-", "").lstrip("0"))
    value = row.value
    if unit != printed.unit:
        value, own = (float(from_si(to_si(each, printed.unit), unit)) for each in (value, printed.value))
        paper = format_number(own, max(digits, 4))
    return paper, format_number(value, max(digits + 1, 4)), unit_text(unit) if unit else ""


def _compared(
    title: str, compared: Sequence[ComparedRow], units: SheetUnits, *, with_settings: bool
) -> TableView:  # fmt: skip
    columns = (
        Column("Quantity", kind="name"), Column("Where"), Column("Paper", kind="number"), Column("Ours", kind="number"),
        Column("Unit", kind="units"), Column("Ratio", kind="number"), Column("Verdict", kind="verdict-cell"),
        *((Column("Settings"),) if with_settings else ()),
    )  # fmt: skip
    rows = []
    before: Mapping[str, str] | None = None
    for row in compared:
        printed = row.published
        calibrated = (" ", Marked("aside", "(calibrated)")) if printed.obtained == "calibrated" else ()
        name = (
            printed.name,
            *calibrated,
            *((Marked("break", ": "), Marked("aside", printed.why)) if printed.why else ()),
        )
        ratio = f"{row.ratio:.4f}" if row.ratio is not None else ABSENT
        verdict = ("matches" if row.matches else "differs") + ("" if row.as_stated else ", not as stated")
        settings = ", ".join(f"{name.replace('_', ' ')} = {text}" for name, text in printed.settings.items())
        said = "as above" if printed.settings == before else units.said(settings) or "defaults"
        cells = (name, printed.where, *_side_by_side(row, units.unit(printed.unit)), ratio, verdict)
        rows.append((*cells, said) if with_settings else cells)
        before = printed.settings
    states = tuple("agrees" if row.matches else "differs" for row in compared)
    return TableView(title, columns, tuple(rows), states=states, kind="published")


def provenance_items(origin: Provenance) -> Items:
    """Say where the numbers come from."""
    packages = ", ".join(f"{name} {version}" for name, version in origin.packages.items())
    said: list[tuple[str, Text]] = [
        ("Calculation", f"{origin.plugin} {origin.plugin_version}"),
        ("Kernel", f"truing {origin.kernel}, Python {origin.python}"),
        ("Packages", packages),
        ("Inputs", Marked("code", origin.input_hash)),
        *(("File", (f"{name} ", Marked("code", digest))) for name, digest in origin.files.items()),
        *(("Added", f"{what} by {plugin} {version}") for what, plugin, version in origin.added),
        *(("Known exception", f"{promise}: {reason}") for promise, reason in origin.exceptions.items()),
        ("Seed", str(origin.seed)),
        *([("Calculated", origin.date)] if origin.date else []),
    ]
    labels, texts = zip(*said, strict=True)
    return Items("provenance", texts, labels)
