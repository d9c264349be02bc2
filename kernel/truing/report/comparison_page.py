"""Two runs, or two diagnoses, as a page: what changed in words, tables of before and after, figures side by side."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from html import unescape
from math import nan
from typing import Any

from truing.declare.fields import InputField, ResultField
from truing.declare.model import Model
from truing.errors import PluginError, UnitError
from truing.numbers import ABSENT, RESULT_DIGITS, STATED_DIGITS, counted, format_number
from truing.report.document import (
    Banner,
    BlockView,
    Chapter,
    Column,
    Document,
    FigurePair,
    FigureView,
    Fold,
    Head,
    Marked,
    Paragraph,
    TableView,
    Text,
    Value,
    joined,
    label_of,
    symbol_cell,
    unit_as_said,
)
from truing.report.limits import check_value, margin_value, relative_margins
from truing.report.translation import COMPARISON, Catalogue, catalogue, translated
from truing.runs.comparison import Change, amounts_of, compared, growth, in_order, number_in, pieces_of, same, words_of
from truing.runs.index import VERDICTS
from truing.runs.provenance import Provenance
from truing.studies.checks import EXIT_CODES, HEADLINES, Check
from truing.templating import ENGLISH
from truing.units import difference_unit, from_si, same_dimension, to_si
from truing.units.names import LEVELS

MOST_REASONS = 3
"""So many limits are named in the sentence that says why the verdict is another one."""
MOST_RESULTS = 10
"""So many results without a limit stand before the figures; the others are folded behind them."""
MOST_DIGITS = 15
"""Two numbers that differ are printed with so many digits at the most, until one sees that they do."""
LONGEST_LIST = 5
"""So many values of a series stand in a cell; a longer one is said by its ends."""
GIVEN_KINDS = {"tolerances": "Tolerances", "conditions": "Conditions", "effects": "Effects"}
STUDY_KINDS = {"studies": "Studies"}
DIAGNOSIS_KINDS = {
    "data": "Data", "verdict": "Verdict", "causes": "Causes", "wrong": "Errors before", "gain": "Errors after",
    "calibrated": "Calibrated inputs",
}  # fmt: skip
"""What is compared besides inputs, limits and results, and the title of its chapter."""


@dataclass(frozen=True)
class Side:
    """One of two that are compared: what it is called, its document as in its folder, its figures, and its model.

    The model is None where no plugin that is installed offers it; names then stand without their notes.
    """

    name: str
    document: Mapping[str, Any]
    figures: tuple[FigureView, ...] = ()
    model: Model[Any, Any] | None = None
    file: str = ""
    """Of the plugin, beside which its words in other languages lie."""

    @property
    def plugin(self) -> Mapping[str, Any]:
        """Name, version and model of the plugin."""
        return self.document.get("plugin") or {}


@dataclass(frozen=True)
class _Declared:
    """What is declared of the inputs and results of both, by name."""

    inputs: Mapping[str, InputField | ResultField]
    results: Mapping[str, InputField | ResultField]

    @classmethod
    def of(cls, *sides: Side) -> _Declared:
        """Gather the declarations of all sides; of one name the last counts."""
        models = [side.model for side in sides if side.model is not None]
        return cls(
            {name: field for model in models for name, field in model.input_fields.items()},
            {name: field for model in models for name, field in model.result_fields.items()},
        )


def comparison_page(before: Side, after: Side, language: str = ENGLISH) -> Document:
    """Say what differs between two runs, or two diagnoses, in a language. Raises UsageError for one of each.

    Numbers in two units of one dimension are compared in the unit of the second. Figures stay as they were drawn.
    """
    words = catalogue(language, (before.file, after.file), COMPARISON)
    before, after = (replace(side, figures=tuple(_titled(side.figures, words))) for side in (before, after))
    changes = [change for change in map(in_one_unit, compared(before.document, after.document))
               if not same(change.before, change.after)]  # fmt: skip
    by_kind: dict[str, list[Change]] = {}
    for change in in_order(changes):
        by_kind.setdefault(change.kind, []).append(change)
    pairs = list(figure_pairs(before.figures, after.figures))
    declared = _Declared.of(before, after)
    chapters = [
        *_inputs(by_kind, declared), *_worded(by_kind, GIVEN_KINDS), *_limits(by_kind, declared),
        *_first_results(by_kind, declared), *_worded(by_kind, DIAGNOSIS_KINDS), *_figures(pairs),
        *_worded(by_kind, STUDY_KINDS), *_further_results(by_kind, declared),
        *_unchanged(after, declared, changes, pairs), _sources(before, after, words.faults),
    ]  # fmt: skip
    title = " and ".join(dict.fromkeys(map(_title, (before, after))))
    page = Document(
        kind="Comparison",
        title=f"{title}: {before.name}, {after.name}",
        head=Head(title, "", (("Before", before.name), ("After", after.name)), (), f"{before.name}, {after.name}"),
        detail="normal",
        summary="",
        banner=_banner(before, after, by_kind, declared),
        chapters=tuple(replace(chapter, number=str(place), ident=chapter.ident or f"chapter-{place}")
                       for place, chapter in enumerate(chapters, 1)),
        warnings=words.faults,
        provenance=Provenance(
            kernel=str(after.document.get("kernel", "")), plugin=str(after.plugin.get("name", "")),
            plugin_version=str(after.plugin.get("version", "")), python="",
        ),
    )  # fmt: skip
    return translated(page, words)


def _titled(figures: Iterable[FigureView], words: Catalogue) -> Iterator[FigureView]:
    """Say the titles of figures in one language, so that those of two sheets meet."""
    for view in figures:
        yield replace(view, title=words.said(view.title), caption=words.said(view.caption))


def _title(side: Side) -> str:
    return side.model.title if side.model is not None else str(side.plugin.get("model", "")).replace("_", " ")


def in_one_unit(change: Change) -> Change:
    """Return a change of a number with both in the unit of the second, where they are in two units of one dimension."""
    before, after = number_in(change.before), number_in(change.after)
    if before is None or after is None:
        return change
    units = [str(piece.get("unit") or "") for piece in (change.before, change.after)]
    try:
        if units[0] == units[1] or not same_dimension(*units):
            return change
        return replace(change, before={**change.before, "value": _converted(before, *units), "unit": units[1]})
    except UnitError:
        return change


def _converted(number: float, unit: str, wanted: str) -> float:
    return float(from_si(to_si(number, unit), wanted))


# In words


def _banner(before: Side, after: Side, by_kind: Mapping[str, Sequence[Change]], declared: _Declared) -> Banner:
    """Say what became of the verdict, why, how much changed, and what besides the inputs is another one."""
    words, other = (_verdict(side.document) for side in (before, after))
    state = str(after.document.get("verdict") or "none")
    mood = state if state in EXIT_CODES and after.document.get("checks") else "none"
    headline = f"The verdict stays: {other}" if words == other else f"The verdict went from {words} to {other}"
    why = list(_reasons(by_kind.get("checks", ()), declared))
    counts = [
        f"{counted(len(by_kind[kind]), one, many)} changed"
        for kind, one, many in (
            ("inputs", "input", "inputs"), ("tolerances", "tolerance", "tolerances"),
            ("effects", "effect", "effects"), ("results", "result", "results"), ("checks", "limit or its margin",
            "limits or their margins"), ("causes", "entry of the causes", "entries of the causes"),
        ) if kind in by_kind
    ]  # fmt: skip
    said: list[Text] = [("Because ", *joined(why, "; "), ".")] if why and words != other else []
    said += [("Limits: ", *joined(why, "; "), ".")] if why and words == other else []
    said.append((*joined(counts), ".") if counts else "Inputs and results are equal." if not by_kind else
                "No input and no result changed.")  # fmt: skip
    return Banner(mood, headline, (*said, *_other_settings(before, after)))


def _verdict(document: Mapping[str, Any]) -> str:
    """Name the verdict of a run or a diagnosis."""
    verdict = str(document.get("verdict") or "")
    if "checks" in document and not document["checks"]:
        return "No limits"
    of_runs = {str(state): words for state, words in HEADLINES.items()}
    words = (of_runs if "checks" in document else VERDICTS).get(verdict, verdict or "none")
    return words[:1].upper() + words[1:]


def _reasons(checks: Sequence[Change], declared: _Declared) -> Iterator[Text]:
    """Say of each limit of another state what it was and is, the worst first."""
    flipped = [change for change in checks if change.flipped]
    for change in flipped[:MOST_REASONS]:
        before, after = (check_of(change.name, piece) for piece in (change.before, change.after))
        name = _spoken(after, declared)
        if after.undecided or before.undecided:
            yield f"{name} was {HEADLINES[before.state].lower()} and is {HEADLINES[after.state].lower()}"
            continue
        moved = "" if same(before.limit, after.limit) else (" (it was ", check_value(before, before.limit), ")")
        yield (
            f"{name} was ", check_value(before, before.value), " and is ", check_value(after, after.value),
            f", where {after.relation} ", check_value(after, after.limit), " is asked", *moved,
        )  # fmt: skip
    if len(flipped) > MOST_REASONS:
        yield f"{counted(len(flipped) - MOST_REASONS, 'further limit', 'further limits')} of another verdict"


def _spoken(check: Check, declared: _Declared) -> str:
    """Name what a limit is on as one says it."""
    field = declared.results.get(check.name)
    if field is not None and field.spec.note and check.compared == check.name:
        return field.spec.note
    return (check.compared or check.name).replace("_", " ")


def _other_settings(before: Side, after: Side) -> Iterator[Text]:
    """Say that plugin, kernel or seed are others: numbers may differ for that alone."""
    models = [str(side.plugin.get("model", "")) for side in (before, after)]
    if models[0] != models[1]:
        yield f"They are two calculations, {models[0]} and {models[1]}: what bears the same name is compared."
    elif before.plugin.get("name") != after.plugin.get("name"):
        names = [str(side.plugin.get("name", "")) for side in (before, after)]
        yield f"The model comes from two plugins, {names[0]} and {names[1]}: numbers may differ for that alone."
    elif before.plugin.get("version") != after.plugin.get("version"):
        versions = [str(side.plugin.get("version", "")) for side in (before, after)]
        yield f"The plugin is version {versions[0]} before and {versions[1]} after: numbers may differ for that alone."
    for name, what in (("kernel", "Truing is version"), ("seed", "Random numbers begin with seed")):
        stated = [side.document.get(name) for side in (before, after)]
        if stated[0] != stated[1]:
            yield f"{what} {stated[0]} before and {stated[1]} after: numbers may differ for that alone."


# Tables of before and after


BESIDE = (Column("Before", kind="number"), Column("After", kind="number"))


def _inputs(by_kind: Mapping[str, Sequence[Change]], declared: _Declared) -> Iterator[Chapter]:
    if "inputs" in by_kind:
        table = _change_table(by_kind["inputs"], declared.inputs, "Input", STATED_DIGITS)
        yield Chapter("Inputs that changed", (table,), "inputs")


def _limits(by_kind: Mapping[str, Sequence[Change]], declared: _Declared) -> Iterator[Chapter]:
    if "checks" in by_kind:
        yield Chapter("Limits that changed", (_limit_table(by_kind["checks"], declared.results),), "limits")


def _first_results(by_kind: Mapping[str, Sequence[Change]], declared: _Declared) -> Iterator[Chapter]:
    """Write the first results that changed; one that has a limit stands with its limit."""
    first, _ = _results(by_kind, declared)
    if first:
        table = _change_table(first, declared.results, "Result", RESULT_DIGITS)
        yield Chapter("Results that changed", (table,), "results")


def _further_results(by_kind: Mapping[str, Sequence[Change]], declared: _Declared) -> Iterator[Chapter]:
    """Write the results that are not among the first, folded."""
    _, further = _results(by_kind, declared)
    if further:
        title = f"{counted(len(further), 'further result', 'further results')} changed"
        table = _change_table(further, declared.results, "Result", RESULT_DIGITS)
        yield Chapter("Further results that changed", (Fold(title, (table,)),), "further-results")


def _results(
    by_kind: Mapping[str, Sequence[Change]], declared: _Declared
) -> tuple[Sequence[Change], Sequence[Change]]:  # fmt: skip
    """Part the results that have no limit: those declared as keys first, then those of one number, as declared."""
    limited = {change.name for change in by_kind.get("checks", ()) if _is_of_value(change)}
    results = [change for change in by_kind.get("results", ()) if change.name not in limited]
    keys = {name for name, field in declared.results.items() if getattr(field.spec, "key", False)}
    ordered = sorted(results, key=lambda change: (change.name not in keys, number_in(change.after) is None))
    return ordered[:MOST_RESULTS], ordered[MOST_RESULTS:]


def _is_of_value(change: Change) -> bool:
    """Tell whether a limit is on the value of the result itself, and not on how probable it is."""
    piece = change.after or change.before
    return (piece.get("compared") or change.name) == change.name


def _change_table(
    changes: Sequence[Change], fields: Mapping[str, InputField | ResultField], what: str, digits: int
) -> TableView:  # fmt: skip
    columns = (Column("Symbol", kind="symbol"), Column(what, kind="name"), *BESIDE,
               Column("Difference", kind="number"), Column("Relative", kind="number"))  # fmt: skip
    rows = [(*_named(change.name, fields), *beside(change, digits), difference(change), _relative(change))
            for change in changes]  # fmt: skip
    return TableView("", columns, tuple(rows), kind="compared")


def _named(name: str, fields: Mapping[str, InputField | ResultField]) -> tuple[Text, Text]:
    """Return the symbol and the label of a quantity; without its declaration its name alone."""
    field = fields.get(name)
    if field is None:
        return "", Marked("code", name)
    return symbol_cell(field.symbol), label_of(field.spec.note, name)


def beside(change: Change, digits: int) -> tuple[Text, Text]:
    """Write both values, with as many digits as it takes to tell them apart."""
    for more in range(digits, max(digits, MOST_DIGITS) + 1):
        texts = _shown(change.before, more), _shown(change.after, more)
        if texts[0] != texts[1]:
            break
    return texts


def _shown(piece: Any, digits: int) -> Text:
    """Write a piece of a document: a number with its unit, a word, yes or no, the ends of a series."""
    if piece is None:
        return ABSENT
    value, unit = piece.get("value"), unit_as_said(str(piece.get("unit") or ""))
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (int, float)):
        return Value(format_number(value, digits), unit)
    if isinstance(value, list) and all(isinstance(each, (int, float, type(None))) for each in value) and value:
        texts = [format_number(each, digits) for each in value]
        ends = ", ".join(texts) if len(texts) <= LONGEST_LIST else f"{texts[0]} … {texts[-1]} ({len(texts)} values)"
        return Value(ends, unit)
    if "array" in piece:
        return f"{' × '.join(map(str, piece.get('shape', ())))} values in arrays.npz"
    return ABSENT if value is None else str(value)


def difference(change: Change) -> Text:
    """Write how far a number moved, with its unit; of what is no number what ``calc compare`` says."""
    before, after = number_in(change.before), number_in(change.after)
    if before is None or after is None or (change.before.get("unit") or "") != (change.after.get("unit") or ""):
        return joined(amounts_of(change))
    unit = unit_as_said(difference_unit(str(change.after.get("unit") or "")))
    text = format_number(after - before, RESULT_DIGITS)
    return Value(text if text.startswith("-") else f"+{text}", unit)


def _relative(change: Change) -> Text:
    share = change.relative
    is_count = all(isinstance((piece or {}).get("value"), int) for piece in (change.before, change.after))
    if share is None or is_count or str(change.after.get("unit") or "") in LEVELS:
        return ABSENT
    text = growth(share)
    return Value(text.removesuffix(" %"), "%") if text.endswith(" %") else text


def check_of(name: str, piece: Mapping[str, Any]) -> Check:
    """Return a check of a document as it was; what was not decided has NaN as its value."""
    numbers = [nan if piece.get(key) is None else float(piece[key]) for key in ("value", "limit", "margin")]
    compared_words = str(piece.get("compared") or "")
    state = str(piece.get("state") or ("passes" if piece.get("passed") else "fails"))
    check = Check(
        name, numbers[0], numbers[1], str(piece.get("unit") or ""), numbers[2], bool(piece.get("passed")),
        relation=piece.get("relation") or "", compared=compared_words, chance=compared_words.startswith("P("),
        undecided=str(piece.get("undecided") or ""),
    )  # fmt: skip
    return replace(check, proposed=replace(check, passed=True)) if state == "proposed" else check


def _limit_table(changes: Sequence[Change], fields: Mapping[str, InputField | ResultField]) -> TableView:
    """Write the limits whose value, limit or verdict changed: those of another verdict first."""
    pieces = [piece for change in changes for piece in (change.before, change.after) if piece is not None]
    is_relative = relative_margins(check_of("", piece) for piece in pieces)
    columns = (
        Column("Check", kind="name"), *BESIDE, Column("Relative", kind="number"), Column("Limit", kind="number"),
        Column("Margin before", kind="number"), Column("Margin after", kind="number"),
        Column("Verdict", kind="verdict-cell"),
    )  # fmt: skip
    rows, states = [], []
    for change in changes:
        checks = [None if piece is None else check_of(change.name, piece) for piece in (change.before, change.after)]
        last = checks[1] or checks[0]
        assert last is not None
        values = [Value(ABSENT) if check is None else check_value(check, check.value) for check in checks]
        margins = [Value(ABSENT) if check is None else margin_value(check, relative=is_relative) for check in checks]
        relative = _relative(change) if None not in checks else joined(amounts_of(change))
        rows.append((_check_label(last, fields), *values, relative, _limit_cell(checks), *margins, _states(checks)))
        states.append(last.state)
    title = (
        f"A margin is {'in per cent of the limit' if is_relative else 'the distance to the limit'}; above zero is safe"
    )
    return TableView(title, columns, tuple(rows), states=tuple(states), kind="compared")


def _check_label(check: Check, fields: Mapping[str, InputField | ResultField]) -> Text:
    field = fields.get(check.name)
    words = check.compared or check.name
    return Marked("code", words) if field is None else (*label_of(field.spec.note, check.name)[:-1],
                                                        Marked("bracketed code", words))  # fmt: skip


def _limit_cell(checks: Sequence[Check | None]) -> Text:
    """Write the limit, or both where it moved: such a one is calculated, and printed as a result."""
    known = [check for check in checks if check is not None]
    has_moved = len({check.limit for check in known}) > 1
    texts = [check_value(check, check.limit, RESULT_DIGITS if has_moved else STATED_DIGITS) for check in known]
    relation = f"{known[-1].relation} "
    return (relation, texts[-1]) if len(texts) == 1 or texts[0] == texts[1] else (relation, *joined(texts, " → "))


def _states(checks: Sequence[Check | None]) -> Text:
    states = [check.state for check in checks if check is not None]
    marks = [Marked("state", state) for state in states]
    return joined(dict.fromkeys(marks), " → ")


def _worded(by_kind: Mapping[str, Sequence[Change]], titles: Mapping[str, str]) -> Iterator[Chapter]:
    """Write what is no single number in the words of ``calc compare``; a column that says nothing is left out."""
    heads = (Column("Name", kind="name"), Column("Before"), Column("After"), Column("Change"))
    for kind, title in titles.items():
        rows = [(*words_of(change)[1:4], joined(amounts_of(change))) for change in by_kind.get(kind, ())]
        shown = [place for place, cells in enumerate(zip(*rows, strict=True)) if any(cells)]
        if rows:
            cells = tuple(tuple(row[place] for place in shown) for row in rows)
            yield Chapter(title, (TableView("", tuple(heads[place] for place in shown), cells, kind="compared"),))


# Figures


_FIGURE = re.compile(
    r'<figure id="figure-\d+">\s*<div class="drawing">(?P<svg><svg\b.*?</svg>)</div>\s*'
    r"<figcaption><strong>[^<]*</strong>(?P<caption>.*?)</figcaption>",
    re.DOTALL,
)
_TITLE = re.compile(r"<title\b[^>]*>(.*?)</title>", re.DOTALL)
_PREFIX = re.compile(r"\bf\d+-")
"""What the identifiers of a figure begin with: its number on the sheet, which is no part of the drawing."""


def _not_drawn_again() -> Any:
    raise PluginError("a figure that was read from a sheet is there as it was drawn, and in no other form")


def figures_of(page: str) -> tuple[FigureView, ...]:
    """Return the figures of a sheet that was written as HTML, in their order."""
    views = []
    for number, match in enumerate(_FIGURE.finditer(page), 1):
        title = _TITLE.search(match["svg"])
        caption = unescape(match["caption"]).strip()
        views.append(
            FigureView(unescape(title[1]) if title else caption, match["svg"], caption, number, _not_drawn_again)
        )
    return tuple(views)


def figures_in(document: Document) -> tuple[FigureView, ...]:
    """Return the figures of a sheet, also those that are folded, in the order of their numbers."""
    blocks = (block for chapter in (*document.front, *document.chapters) for block in _unfolded(chapter.blocks))
    return tuple(sorted((block for block in blocks if isinstance(block, FigureView)), key=lambda view: view.number))


def _unfolded(blocks: Iterable[BlockView]) -> Iterator[BlockView]:
    for block in blocks:
        if isinstance(block, Fold):
            yield from _unfolded(block.blocks)
        else:
            yield block


def figure_pairs(before: Iterable[FigureView], after: Iterable[FigureView]) -> Iterator[FigurePair]:
    """Put figures of one title together; the second of a title with the second. Those of the second come first."""
    first, second = _by_title(before), _by_title(after)
    for number, key in enumerate(dict.fromkeys([*second, *first]), 1):
        yield FigurePair(key[0], number, first.get(key), second.get(key))


def _by_title(views: Iterable[FigureView]) -> dict[tuple[str, int], FigureView]:
    found: dict[tuple[str, int], FigureView] = {}
    counts: dict[str, int] = {}
    for view in views:
        counts[view.title] = counts.get(view.title, 0) + 1
        found[view.title, counts[view.title]] = view
    return found


def is_same_figure(pair: FigurePair) -> bool:
    """Tell whether both drawings are one."""
    if pair.before is None or pair.after is None:
        return False
    drawn, other = (_PREFIX.sub("", view.svg) for view in (pair.before, pair.after))
    return drawn == other


def _figures(pairs: Sequence[FigurePair]) -> Iterator[Chapter]:
    changed = [pair for pair in pairs if not is_same_figure(pair)]
    if changed:
        blocks = (replace(pair, number=number) for number, pair in enumerate(changed, 1))
        yield Chapter("Figures before and after", tuple(blocks), "figures")


# What stayed, and what was compared


def _unchanged(
    after: Side, declared: _Declared, changes: Sequence[Change], pairs: Sequence[FigurePair]
) -> Iterator[Chapter]:  # fmt: skip
    """Write what both have alike, folded, and say what was not compared."""
    kinds = pieces_of(after.document)
    moved = {(change.kind, change.name) for change in changes}
    stayed = {kind: {name: piece for name, piece in pieces.items() if piece is not None and (kind, name) not in moved}
              for kind, pieces in kinds.items()}  # fmt: skip
    blocks: list[BlockView] = []
    alike = 0
    fields = {"inputs": declared.inputs, "results": declared.results}
    for kind, title in (("inputs", "Inputs"), ("results", "Results")):
        pieces = {name: piece for name, piece in stayed.pop(kind, {}).items() if "array" not in piece}
        if pieces:
            columns = (Column("Symbol", kind="symbol"), Column(title[:-1], kind="name"), Column("Value", kind="number"))
            rows = ((*_named(name, fields[kind]), _shown(piece, STATED_DIGITS if kind == "inputs" else
                     RESULT_DIGITS)) for name, piece in pieces.items())  # fmt: skip
            alike += len(pieces)
            blocks.append(TableView(f"{title}: {len(pieces)}", columns, tuple(rows), kind="key"))
    named = {kind: [name.replace("_", " ") for name in pieces] for kind, pieces in stayed.items() if pieces}
    named["figures"] = [pair.title for pair in pairs if is_same_figure(pair)]
    titles = {kind: {**GIVEN_KINDS, **DIAGNOSIS_KINDS}.get(kind, kind.capitalize()) for kind in named}
    blocks += [Paragraph((titles[kind], ": ", *joined(names), ".")) for kind, names in named.items() if names]
    large = [name for name, piece in (kinds.get("results") or {}).items() if "array" in (piece or {})]
    if large:
        words = f"Not compared, because their numbers stand in arrays.npz alone: {', '.join(large)}."
        blocks.append(Paragraph(words, "warning"))
    if blocks:
        count = sum(len(names) for names in named.values()) + alike
        title = f"{counted(count, 'entry is', 'entries are')} as before"
        yield Chapter("What did not change", (Fold(title, tuple(blocks)),), "unchanged")


def _sources(before: Side, after: Side, faults: Iterable[str]) -> Chapter:
    """Say what was compared: folders or files, versions, hashes, seeds."""

    def row(title: str, of: Callable[[Side], Text]) -> tuple[Text, ...]:
        return (title, *(of(side) for side in (before, after)))

    rows = (
        row("Called", lambda side: Marked("code", side.name)),
        row("Calculation", lambda side: f"{side.plugin.get('model', '')} {side.plugin.get('version', '')}".strip()),
        row("Truing", lambda side: str(side.document.get("kernel", ""))),
        row("Inputs", lambda side: Marked("code", str(side.document.get("input_hash", "")))),
        row("Seed", lambda side: str(side.document.get("seed", ""))),
    )
    columns = (Column("", kind="name"), Column("Before"), Column("After"))
    blocks: tuple[BlockView, ...] = (TableView("", columns, rows), *(Paragraph(fault, "warning") for fault in faults))
    return Chapter("What was compared", blocks, "provenance")
