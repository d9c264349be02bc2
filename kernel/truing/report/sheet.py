"""The calculation sheet: what it says of inputs, limits, printed numbers and provenance, put together in order."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from truing.calculation import Calculation
from truing.cases import CaseResult, CasesTable
from truing.declare.fields import Given, InputField
from truing.declare.goals import Require
from truing.declare.published import rules_of
from truing.evaluate import acting_inputs
from truing.inputs_file.values import halving_in_words
from truing.numbers import (
    ABSENT,
    RESULT_DIGITS,
    STATED_DIGITS,
    format_chance,
    format_difference,
    format_number,
    format_value,
    with_unit,
)
from truing.published import ComparedRow, parted
from truing.report.chapters import LONGEST_TABLE, Figures, Writing, numbered, result_chapters
from truing.report.document import (
    Banner,
    BlockView,
    Chapter,
    Column,
    Document,
    Head,
    Items,
    Marked,
    Paragraph,
    Piece,
    TableView,
    Text,
    Value,
    joined,
    label_of,
    with_source,
)
from truing.runs.provenance import Provenance
from truing.setup import Setup, SwitchedOn
from truing.studies.checks import HEADLINES, SHORT, Check, check_name, requirements
from truing.studies.verdicts import NO_RESULT, NO_STUDY, sentence_of
from truing.units import unit_text

HEAD_FIELDS = ("project", "drawing", "revision", "company", "customer", "date")
ALWAYS = {"project", "drawing", "revision", "date"}
"""Fields of the title block that are there to be filled in by hand, too."""
SIGNATURES = ("prepared", "checked", "approved")
PICTURES = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
LARGEST_LOGO = 500_000
NOT_SHOWN = {"title", "logo"}
NO_LIMITS = "No limits"
SHEET = "Calculation sheet"


def make_sheet(
    calculation: Calculation, *, provenance: Provenance, verified: Sequence[ComparedRow] = (),
    cases: CasesTable | None = None,
) -> Document:  # fmt: skip
    """Say everything that stands on the sheet of a calculation, at the level of detail of its setup."""
    setup = calculation.setup
    detail = setup.sheet.detail if setup.sheet.detail in LONGEST_TABLE else "normal"
    figures = Figures()
    results = list(result_chapters(Writing(calculation, detail, figures)))
    warnings = tuple(_warnings(calculation, cases, figures.failures))
    front = _front(calculation, cases, detail)
    findings = setup.model.findings
    back = []
    if verified and detail != "short":
        back.append(Chapter("Paper against this calculation", tuple(published_blocks(setup, verified)), "published"))
    if findings and detail != "short":
        items = Items("findings", tuple(each.text for each in findings), tuple(each.title for each in findings))
        back.append(Chapter("Findings", (items,), "findings"))
    cites = [
        *setup.model.cites,
        *(text for each in calculation.outcomes.values() for text in getattr(each, "cites", ())),
    ]
    end = end_chapters(warnings, provenance, () if detail == "short" else tuple(dict.fromkeys(cites)))
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
    yield from filter(None, [logo_of(calculation.setup)[1]])
    shown = calculation.failed[:20] if cases is None else ()
    for row, reason in shown:
        yield f"row {row} failed: {reason}"
    if len(calculation.failed) > len(shown) and cases is None:
        yield f"{len(calculation.failed) - len(shown)} further rows failed"
    yield from failures


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
        values.append(str(value) if is_word else format_value(value, setup.unit_of(name), STATED_DIGITS)[0])
    if case.reason is not None:
        return (case_name(case), *values, *("–" for _ in checks), "–", f"cannot be calculated: {case.reason}")
    texts = {check.name: check_value(check, check.value).text for check in case.checks}
    broken = [check.name.replace("_", " ") for check in case.checks if check.state == case.verdict]
    verdict_text = case.verdict if case.verdict == "passes" else f"{SHORT[case.verdict]}: {', '.join(broken)}"
    margin = least_margin(case.checks)
    shown = [texts.get(name, "–") for name in checks]
    return (case_name(case), *values, *shown, with_unit(margin.text, margin.unit), verdict_text)


# What the sheet says of what was asked, of limits, of published numbers, and of where the numbers come from


PLACES = {"inputs": "on the inputs", "results": "on the results", "reading": "on the reading"}
LONGEST_SERIES = 8
NOT_GIVEN = "not given"
FEW = 6
"""So many inputs at a default of 0 still have rows of their own."""


@dataclass(frozen=True)
class CheckRow:
    """A limit and how far it is kept: the check, symbol and note of what it is on, and its numbers as printed.

    ``proposed`` is the value of the design that a study proposes, ``remark`` says which study would decide the limit,
    or what its bound is called.
    """

    check: Check
    symbol: str
    note: str
    value: Value
    limit: Value
    margin: Value
    proposed: Value | None
    remark: str


def input_blocks(setup: Setup, detail: str) -> Iterator[BlockView]:
    """Say every input; of many that are not given or at a default of 0 only the names, but on a full sheet."""
    fields = setup.model.input_fields
    values = {
        name: input_value(setup, fields[name], value) for name, value in setup.model.read_inputs(setup.inputs).items()
    }
    idle = [
        name
        for name, value in values.items()
        if name not in setup.source.stated and value.text in {"0", NOT_GIVEN} and not fields[name].spec.source
    ]
    if detail == "full" or len(idle) <= FEW:
        idle = []
    shown = {name: value for name, value in values.items() if name not in idle}
    calibrated = any(name in setup.calibrated for name in shown)
    columns = (
        Column("Symbol", kind="symbol"), Column("Input", kind="name"), Column("Value", kind="number"),
        Column("Unit", kind="units"), *((Column("Calibrated", kind="number"),) if calibrated else ()),
        Column("Given", kind="given"), Column("Source"),
    )  # fmt: skip
    rows = tuple(_input_row(setup, name, value, calibrated=calibrated) for name, value in shown.items())
    title = "What the calculation starts from; 'stated' stands in the inputs file, 'default' is the model's own value"
    yield TableView(title, columns, rows, kind="inputs")
    if idle:
        called = joined(
            Marked("symbol", fields[name].symbol) if fields[name].symbol else Marked("code", name) for name in idle
        )
        words = "Not given, or left at their default of 0 (inputs.toml names them): "
        yield Paragraph((words, *called, "."), "aside")


def _input_row(setup: Setup, name: str, value: Value, *, calibrated: bool) -> tuple[Text, ...]:
    field = setup.model.input_fields[name]
    note = "; ".join(part for part in (field.spec.note, halving_in_words(field)) if part)
    fitted = setup.calibrated.get(name)
    own = "" if fitted is None else format_value(fitted, setup.print_unit(name), STATED_DIGITS)[0]
    return (
        Marked("symbol", field.symbol) if field.symbol else "", label_of(note, name), value.text, value.unit,
        *((own,) if calibrated else ()), "stated" if name in setup.source.stated else "default", field.spec.source,
    )  # fmt: skip


def input_value(setup: Setup, field: InputField, value: Any) -> Value:
    """Write one input: a number in its printed unit, a choice, a switch, a file, a series (a long one by its ends)."""
    if field.kind == "file":
        if field.name in setup.source.tables:
            return Value(PurePath(setup.source.tables[field.name]["file"]).name)
        return Value(NOT_GIVEN if value is None else "default")
    if isinstance(value, bool):
        return Value("yes" if value else "no")
    if isinstance(value, str) or (isinstance(field.spec, Given) and field.spec.unit is None):
        return Value(str(value))
    unit = setup.print_unit(field.name)
    if field.kind == "series":
        texts = [format_value(float(number), unit) for number in value] or [(ABSENT, "")]
        (first, shown_unit), (last, _) = texts[0], texts[-1]
        if len(texts) <= LONGEST_SERIES:
            return Value(", ".join(text for text, _ in texts), shown_unit)
        return Value(f"{first} … {last} ({len(texts)} values)", shown_unit)
    if value != value:
        return Value(NOT_GIVEN)
    return Value(*format_value(value, unit, STATED_DIGITS))


def tolerance_table(setup: Setup) -> TableView:
    """Say every tolerance that scatters: the standard deviation of what it is on, and how far the mean lies off."""
    columns = (
        Column("Tolerance", kind="name"), Column("On"), Column("Spread"), Column("Standard deviation", kind="number"),
        Column("Why"),
    )  # fmt: skip
    rows = []
    for name, distributions in setup.distributions().items():
        tolerance = setup.model.tolerances[name]
        sds, shifts = [], []
        for on, distribution in distributions.items():
            unit, shift = setup.print_unit(on), distribution.mean - float(setup.nominal(on))
            sds.append(Value(*format_difference(distribution.sd, unit, 4)))
            if abs(shift) > 1e-12 * max(abs(float(setup.nominal(on))), distribution.sd):
                number, printed = format_difference(shift, unit, 4)
                shifts.append(Value(number if number.startswith("-") else f"+{number}", printed))
        scatter: list[Piece] = [*joined(dict.fromkeys(sds))]
        for mean in dict.fromkeys(shifts):
            scatter += [Marked("break", ", "), "mean ", mean]
        targets = ", ".join(on.replace("_", " ") for on in distributions)
        why = with_source(tolerance.why, tolerance.source)
        rows.append((name.replace("_", " "), targets, setup.spread_of(name).text, tuple(scatter), why))
    return TableView("How the inputs scatter about their nominal values", columns, tuple(rows), kind="tolerances")


def effect_blocks(setup: Setup) -> Iterator[BlockView]:
    """Say every condition with its reference, and every effect that is on with its unknowns and what it changes."""
    if setup.conditions:
        title = "Conditions, and the references at which their effects vanish"
        columns = (Column("Condition", kind="name"), Column("Value", kind="number"), Column("Reference", kind="number"))
        rows: list[tuple[Text, ...]] = []
        for name, value in setup.conditions.items():
            condition, unit = setup.model.known_conditions[name], setup.print_unit(name)
            values = (Value(*format_value(number, unit, STATED_DIGITS)) for number in (value, condition.zero))
            rows.append((label_of(condition.note, name), *values))
        yield TableView(title, columns, tuple(rows))
    if not setup.effects:
        yield Paragraph("No effect is on.")
        return
    heads = (Column("Effect", kind="name"), Column("Acts"), Column("Unknowns"), Column("Why"))
    yield TableView("Effects that are on", heads, tuple(map(_effect_row, setup.effects)), kind="effects")
    changed = list(_changed_inputs(setup))
    if changed:
        yield Paragraph(("With them the calculation runs with ", *joined(changed, "; "), "."), "aside")


def _effect_row(active: SwitchedOn) -> tuple[Text, ...]:
    effect = active.effect
    unknowns: list[Text] = []
    for unknown in active.unknowns:
        value = Value(*format_value(active.values[unknown.name], unknown.unit, RESULT_DIGITS))
        sd = active.sds.get(unknown.name)
        scatter = (" ± ", Value(*format_difference(sd, unknown.unit, 3)), " ", Marked("aside", "(sd)")) if sd else ()
        unknowns.append((unknown.name.replace("_", " ") + " = ", value, *scatter))
    why = with_source(effect.why or effect.looks_like, effect.source)
    return (effect.name.replace("_", " "), PLACES[effect.place], joined(unknowns, Marked("break", ", ")), why)


def _changed_inputs(setup: Setup) -> Iterator[Text]:
    """Say which inputs the effects that are on change, and to what."""
    if not any(active.effect.place == "inputs" for active in setup.effects):
        return
    stated, acting = (setup.model.read_inputs(inputs) for inputs in (setup.inputs, acting_inputs(setup)))
    for name, field in setup.model.input_fields.items():
        before, after = stated[name], acting[name]
        if field.varies and before != after and not (before != before and after != after):
            unit = setup.print_unit(name)
            old, new = (Value(*format_value(value, unit, digits)) for value, digits in ((before, 10), (after, 7)))
            what = Marked("symbol", field.symbol) if field.symbol else name.replace("_", " ")
            yield what, " = ", new, " instead of ", old


def check_table(calculation: Calculation) -> TableView:
    """Say every limit, and what is left of it."""
    has_proposal = calculation.decided.proposal is not None
    columns = (
        Column("Check", kind="name"), Column("As stated" if has_proposal else "Value", kind="number"),
        *((Column("As proposed", kind="number"),) if has_proposal else ()), Column("must be", kind="relation"),
        Column("Limit", kind="number"), Column("Margin", kind="number"), Column("Verdict", kind="verdict-cell"),
    )  # fmt: skip
    rows: list[tuple[Text, ...]] = []
    for row in check_rows(calculation):
        check = row.check
        remark = "; ".join(filter(None, (row.remark, check.method)))
        label = label_of(row.note, check.name, row.symbol)[:-1]
        about = (*label, Marked("bracketed code", check.compared or check.name))
        about += (Marked("break", ", "), Marked("aside", remark)) if remark else ()
        proposed = (row.proposed or "",) if has_proposal else ()
        rows.append((about, row.value, *proposed, check.relation, row.limit, row.margin, Marked("state", check.state)))
    margin = "in per cent of the limit" if relative_margins(calculation.checks) else "the distance to the limit"
    title = f"Limits, and what is left of them. A margin is {margin}; above zero is safe"
    states = tuple(check.state for check in calculation.checks)
    return TableView(title, columns, tuple(rows), states=states, kind="checks")


def check_rows(calculation: Calculation) -> Iterator[CheckRow]:
    """Say every limit with what is left of it."""
    setup = calculation.setup
    fields = setup.model.result_fields
    requires = requirements(setup)
    named = {check_name(require, requires): require for require in requires}
    relative = relative_margins(calculation.checks)
    for check in calculation.checks:
        require = named.get(check.name)
        field = fields.get(check.name if require is None else require.result)
        calculated = require is not None and not check.chance and require.limit in fields
        yield CheckRow(
            check=check,
            symbol=field.symbol if field is not None and field.name == check.compared else "",
            note=field.spec.note if field is not None else check.note,
            value=check_value(check, check.value),
            limit=check_value(check, check.limit, RESULT_DIGITS if calculated else STATED_DIGITS),
            margin=margin_value(check, relative=relative),
            proposed=None if check.proposed is None else check_value(check, check.proposed.value),
            remark=_remark(check, require, setup),
        )


def check_value(check: Check, number: float, digits: int = RESULT_DIGITS) -> Value:
    """Write a value or a limit of a check: a probability in per cent, a flag as yes or no."""
    if number != number:
        return Value(ABSENT)
    if check.flag:
        return Value("yes" if number >= 1 else "no")
    if check.chance:
        return Value(format_chance(number), "%")
    return Value(format_number(number, digits), unit_text(check.unit))


def relative_margins(checks: Iterable[Check]) -> bool:
    """Tell whether the margins of a sheet are shares of their limits: where no limit is 0, else all are distances."""
    return all(check.limit for check in checks if not check.flag)


def margin_value(check: Check, *, relative: bool) -> Value:
    """Write a margin, with per cent or its unit; a flag has none, and a value on its limit says so."""
    if check.flag or check.margin != check.margin:
        return Value(ABSENT)
    if check.margin == 0:
        return Value("on the limit")
    if relative:
        return Value(format_number(100 * check.margin, 3), "%")
    distance = abs(check.value - check.limit) * (1 if check.margin > 0 else -1)
    return (
        Value(format_number(100 * distance, 3), "%")
        if check.chance
        else Value(format_number(distance, 3), unit_text(check.unit))
    )


def least_margin(checks: Sequence[Check]) -> Value:
    """Write the smallest margin of the checks that are decided, as ``margin_value`` does."""
    decided = [check for check in checks if not check.undecided]
    if not decided:
        return Value(ABSENT)
    return margin_value(min(decided, key=lambda check: check.margin), relative=relative_margins(checks))


def _remark(check: Check, require: Require | None, setup: Setup) -> str:
    """Say which study would decide a limit; else what the bound of a probability is called."""
    if check.undecided == NO_RESULT:
        return "not decided: the result does not exist"
    if check.undecided == NO_STUDY:
        return f"{NO_STUDY} decides it"
    if check.undecided:
        return f"not decided: {check.undecided} would"
    if require is None or not check.chance:
        return check.note if check.note and check.compared else ""
    known = require.limit in {*setup.model.input_fields, *setup.model.result_fields}
    return f"bound: {require.limit.replace('_', ' ')}" if known else ""


def published_blocks(setup: Setup, verified: Sequence[ComparedRow]) -> Iterator[BlockView]:
    """Say what the paper prints beside what the calculation gives, first for the settings of this run."""
    own, elsewhere = parted(setup, verified)
    rules = "; ".join(rules_of(row.published for row in verified).values())
    yield Paragraph(f"Judged by kind of figure: {rules}.", "aside")
    if own:
        yield _compared("Printed for the settings of this run", own, with_settings=False)
    if elsewhere:
        title = "Printed for other settings, calculated with those"
        alone = "Calculated with the settings that each number is printed for; this run has others"
        yield _compared(title if own else alone, elsewhere, with_settings=True)


def _compared(title: str, compared: Sequence[ComparedRow], *, with_settings: bool) -> TableView:
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
        said = "as above" if printed.settings == before else settings or "defaults"
        unit = unit_text(printed.unit) if printed.unit else ""
        paper = format_number(printed.value, 10)
        digits = len(paper.partition("e")[0].replace(".", "").replace("-", "").lstrip("0"))
        ours = format_number(row.value, max(digits + 1, 4))  # with one digit more than the paper prints
        cells = (name, printed.where, paper, ours, unit, ratio, verdict)
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
