"""calc explain: one result, input, effect or tolerance of a calculation, and what it has to do with the others."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from types import SimpleNamespace
from typing import Any, TypeAlias

from truing.api.model import LoadedModel
from truing.cli.console import NARROWEST, Settings, aligned, out, out_json
from truing.cli.load import LABEL, find_offer, say_example
from truing.errors import UsageError
from truing.explain import SECTIONS, told
from truing.formulas.write_text import HOLD, folded
from truing.inputs_file.sentences import told_by_line
from truing.kernel import Offer
from truing.numbers import format_number, pretty
from truing.progress import progress_bar
from truing.report.document import Chapter, Items, Paragraph, TableView, Text, plain_text, table_of
from truing.texts import one_line
from truing.units import unit_text


def explain(settings: Settings, asked: SimpleNamespace) -> int:
    """Explain a result: formula, what it is made from, what moves it; or an input, an effect, a tolerance."""
    offer, wanted = _meant(asked.what, asked.name, settings)
    say_example(asked.inputs, offer.name, settings)
    setup = LoadedModel(offer, tuple(asked.changed or ()), label=LABEL).setup(asked.inputs)
    with progress_bar(not settings.quiet) as progress, told_by_line(setup):
        document = told(setup, offer, wanted, progress=progress)
    if asked.as_json:
        out_json(document)
    else:
        out("\n".join(lines_of(document, width_of_page())))
    return 0


def _meant(what: str, name: str, settings: Settings) -> tuple[Offer, str]:
    """Return the calculation and the name that the words mean."""
    if name:
        return find_offer(what, settings), name
    if what.endswith(".py"):
        raise UsageError(f"explain what of {what}? Write its name behind it: calc explain {what} RESULT")
    plugin, _, last = what.rpartition(".")
    outer, _, section = plugin.rpartition(".")
    if outer and section in SECTIONS:
        plugin, last = outer, f"{section}.{last}"
    if plugin:
        return find_offer(plugin, settings), last
    offer = find_offer(what, settings)
    first = next(iter(offer.model.result_fields))
    raise UsageError(
        f"explain what of {what}? Name it, as in calc explain {what}.{first}; calc describe {what} lists all"
    )


# An explanation on the terminal: eighty columns, the formula first, then what it rests on and what rests on it


MOST = 6
LONGEST_CHAIN = 24
PLACES = {"inputs": "on the inputs", "results": "on the results", "reading": "on the reading"}
Told = dict[str, Any]
ToldParts: TypeAlias = Iterator[str | Chapter]
"""Paragraphs, and chapters with a title."""


def lines_of(document: Told, width: int) -> Iterator[str]:
    """Say everything that was told of one name."""
    kinds: dict[str, Callable[[Told], ToldParts]] = {
        "result": _result, "input": _input, "effect": _effect, "tolerance": _tolerance, "condition": _condition,
        "study": _study,
    }  # fmt: skip
    symbol = f"  {document['symbol']}" if document.get("symbol") else ""
    value = f" = {document['text']}" if document.get("text") else ""
    yield one_line(document["name"]) + symbol + value
    article = "an" if document["kind"][0] in "aei" else "a"
    yield from wrapped(f"{article} {document['kind']} of {document['model']} ({one_line(document['title'])})", width)
    yield from wrapped(document.get("note") or "", width)
    if document.get("formula"):
        yield from _formula(document, width)
    for part in kinds[document["kind"]](document):
        yield from wrapped(part, width) if isinstance(part, str) else chapter_lines(part, width)


def _result(told: Told) -> ToldParts:
    if told["study"]:
        run = "" if told["text"] != "–" else "; this inputs file does not ask for it"
        yield f"Given by the study {told['study']}{run}"
    yield from _said("Found by", told["method"])
    yield from _said("Source", told["source"])
    yield from _chain(told)
    yield from _scatter(told)
    yield from _slopes(told)
    yield from _listed("Limits that rest on it", map(_limit_words, told["limits"]))
    yield from _listed("What the source prints, and ours", map(_published_words, told["published"]))
    yield from _effects("Effects that change it", told["effects"])
    yield from _followed(told)


def _formula(told: Told, width: int) -> Iterator[str]:
    formula = told["formula"]
    yield ""
    left = f"{formula['left']} = " if formula["left"] else ""
    steps = [formula["symbols"], *filter(None, [formula["numbers"]]), *formula["results"]]
    indent = INDENT + " " * max(len(left) - 2, 0)
    if not left:
        indent, steps = INDENT * 2, [steps[0], *(f"{told['symbol'] or told['name']} = {one}" for one in steps[1:])]
    for index, step in enumerate(steps):
        head = INDENT + left if not index else indent + ("= " if left else "")
        held = "".join(c if c.isprintable() or c == HOLD else " " for c in step)  # what holds number and unit together
        for number, line in enumerate(folded(held, width - len(head))):
            yield ((head if not number else " " * len(head)) + line).replace(HOLD, " ")
    if formula["departs"]:
        yield from wrapped(
            "An effect on the results is on: the calculation answers another value than the formula.", width
        )


def _chain(told: Told) -> ToldParts:
    """Say what the result is made from, down to the inputs, as far down as there is room."""
    chain = told["chain"]
    if not chain:
        return
    deepest = max(link["depth"] for link in chain)
    while deepest > 1 and sum(link["depth"] <= deepest for link in chain) > LONGEST_CHAIN:
        deepest -= 1
    shown = [link for link in chain if link["depth"] <= deepest]
    rows = [
        (INDENT * (link["depth"] - 1) + link["name"], link["symbol"], "(see above)" if link["again"] else link["text"],
         link["note"])
        for link in shown
    ]  # fmt: skip
    said = {link["name"] for link in shown}
    left = list(dict.fromkeys(link["name"] for link in chain if link["name"] not in said))
    note = f"and these further down: {', '.join(left)}" if left else ""
    yield Chapter("Made from", (_table(rows, note=note),))


def _scatter(told: Told) -> ToldParts:
    scatter = told["scatter"]
    if scatter is not None:
        rows = []
        for share in scatter["shares"]:
            names = ", ".join(share["tolerances"])
            named = "" if names in {"", share["name"]} else f", tolerance {names}"
            rows.append((share["name"], _percent(share["share"]), share["spread"] + named))
        title = f"Scatter of the tolerances in force: standard deviation {scatter['sd']}, of which"
        yield Chapter(title, (_table(rows, (1,), MOST),))


def _slopes(told: Told) -> ToldParts:
    remarks = tuple(map(Paragraph, told["remarks"]))
    if told["slopes"]:
        rows = [(slope["name"], _plus(slope["change"]), _per_cent(slope["percent"])) for slope in told["slopes"]]
        title = "One per cent more of an input (1 K of a temperature) changes it by"
        yield Chapter(title, (_table(rows, (1, 2), MOST), *remarks))
    else:
        yield from told["remarks"]


def _listed(title: str, sentences: Iterable[str]) -> ToldParts:
    texts = tuple(sentences)
    if texts:
        yield Chapter(title, (Items("", texts),))


def _limit_words(limit: Told) -> str:
    check = limit["check"]
    if check is None:
        return str(limit["says"])
    if check["state"] == "undecided":
        return f"{limit['says']}: calc run decides it"
    value = f"{format_number(check['value'], 5)} {unit_text(check['unit'])}".strip()
    verdict = "passes" if check["passed"] else "FAILS"
    return f"{limit['says']}: {value} {verdict}, margin {format_number(check['margin'], 3)}"


def _published_words(number: Told) -> str:
    unit = f" {number['unit']}" if number["unit"] else ""
    ours = f"ours {format_number(number['ours'], 5)}" if number["ours"] is not None else "ours by calc verify"
    with_ = ", ".join(f"{name} = {value}" for name, value in number["settings"].items())
    settings = f"; with {with_}" if with_ else ""
    where = number["where"] or number["name"]
    return f"{format_number(number['paper'], 6)}{unit}, {ours}: {number['verdict']} ({where}{settings})"


def _effects(title: str, effects: Sequence[Told]) -> ToldParts:
    if effects:
        rows = [
            (effect["name"], PLACES[effect["acts_on"]] + (", is on" if effect["on"] else ""), effect["looks_like"])
            for effect in effects
        ]
        yield Chapter(title, (_table(rows),))


def _followed(told: Told) -> ToldParts:
    direct, further = told["followed_by"], told["then"]
    if direct:
        more = [Paragraph(f"and through these: {', '.join(further)}")] if further else []
        yield Chapter("Results that follow from it", (Paragraph(", ".join(direct)), *more))


def _input(told: Told) -> ToldParts:
    taken = f"taken from {told['taken_from'][0]}" if told["taken_from"] else "the default"
    stated = "stated by the inputs file" if told["stated"] else taken
    allowed = " | ".join(told["choices"]) or told["bounds"]
    yield f"{stated}; {allowed}" if allowed else stated
    yield from _said("Source", told["source"])
    yield from map(_spread_words, told["tolerances"])
    for pair in told["correlated"]:
        why = f", {pair['why']}" if pair["why"] else ""
        yield f"scatters together with {pair['with']}: correlation {pair['correlation']:g}{why}"
    if told["namesake"]:
        address = f"{told['model']}.tolerances.{told['name']}"
        yield f"the tolerance of this name scatters {', '.join(told['namesake'])}: see {address}"
    yield from (*told["varied"], *(f"is the limit of {result}" for result in told["limit_of"]))
    yield from _moves(told)
    yield from _listed("Limits that rest on it", told["limits"])
    yield from _followed(told)
    yield from _effects("Effects that change it", told["effects"])


def _spread_words(scatter: Told) -> str:
    sd = f" (standard deviation {', '.join(scatter['sd'][:3])})" if scatter["sd"] else ""
    why = f", {scatter['why']}" if scatter["why"] else ""
    return f"scatters by the tolerance {scatter['name']}: {scatter['spread']}{sd}{why}"


def _moves(told: Told) -> ToldParts:
    """Say which results an input or a tolerance moves: the largest share of their scatter first, then the steepest."""
    rows = told["moves"]
    if rows is None:
        return
    if not rows:
        yield Chapter("No result of the calculation moves with it, as things stand", ())
        return
    slopes = any(row["change"] for row in rows)
    by = ": one per cent more of it (1 K), and its share of their scatter" if slopes else ": its share of their scatter"
    cells = [
        (row["name"], *((_plus(row["change"]), _per_cent(row["percent"])) if slopes else ()), _percent(row["share"]),
         row["note"])
        for row in rows
    ]  # fmt: skip
    yield Chapter(f"Results it moves{by}", (_table(cells, (1, 2, 3) if slopes else (1,), 2 * MOST),))


def _tolerance(told: Told) -> ToldParts:
    yield _spread_words(told).removeprefix("scatters by the tolerance ")
    yield from _said("Source", told["source"])
    for price in told["price"]:
        yield from _said("Price", price)
    rows = [(result["name"], result["text"]) for result in told["on"]]
    yield Chapter("Inputs that scatter by it, each on its own", (_table(rows),))
    yield from _moves(told)


def _effect(told: Told) -> ToldParts:
    state = "is on" if told["on"] else "is off"
    yield f"acts {PLACES[told['acts_on']]}; {state}; looks like: {told['looks_like'] or '–'}"
    yield from _said("Why", told["why"])
    yield from _said("Source", told["source"])
    if told["built_in"]:
        yield "One of the kernel's own: it can act on the reading of any result, and never on a machine."
    if told["unknowns"]:
        unknowns = [
            (one["name"], f"{one['low']:g} .. {one['high']:g} {one['unit']}".strip(), one["text"], one["note"])
            for one in told["unknowns"]
        ]
        yield Chapter("Unknowns", (_table(unknowns),))
    if told["needs"]:
        needs = [(need["name"], f"reference {need['reference']}", need["note"]) for need in told["needs"]]
        yield Chapter("Conditions it needs", (_table(needs),))
    if told["tried_at"]:
        yield from _tried(told)


def _tried(told: Told) -> ToldParts:
    """Say what changed when the effect was tried."""
    at = ", ".join(f"{setting['name']} {setting['text']}" for setting in told["tried_at"])
    rows = [(move["name"], _per_cent(move["percent"]) or "from 0", move["note"]) for move in told["moves"]]
    shown = _table(rows, (1,), 2 * MOST) if rows else Paragraph("no result changes there")
    yield Chapter(f"Tried at {at}", (shown,))
    if told["inputs"]:
        pairs = [(change["name"], f"{change['before']} -> {change['after']}") for change in told["inputs"]]
        yield Chapter("through these inputs", (_table(pairs, most=2 * MOST),))


def _condition(told: Told) -> ToldParts:
    yield f"reference {told['reference']}: there its effects vanish"
    yield from _said("Range", told["range"])
    yield from _said("Made", told["derived"])
    yield from _effects("Effects that need it", told["effects"])


def _study(told: Told) -> ToldParts:
    yield "asked for by this inputs file" if told["asked"] else "not asked for by this inputs file"
    if told["gives"]:
        yield Chapter("Results it gives", (Paragraph(", ".join(told["gives"])),))


def _said(label: str, text: str) -> Iterator[str]:
    if text:
        yield f"{label}: {text}"


def _table(
    rows: Sequence[Sequence[str]], right: Sequence[int] = (), most: int | None = None, note: str = ""
) -> TableView:
    """Return rows as a table without headings; where there are more than ``most``, how many is said."""
    left = len(rows) - len(rows[:most])
    more = f"and {left} more (--json has all)" if left else ""
    return table_of("", ("",) * len(rows[0]), rows[:most], right, note or more)


def _percent(share: float) -> str:
    return f"{format_number(100 * share, 3)} %" if share else ""


def _per_cent(percent: float | None) -> str:
    return "" if percent is None else _plus(f"{pretty(format_number(percent, 3))} %")


def _plus(text: str) -> str:
    return text if text.startswith(("−", "-", "–")) else f"+{text}"


# A document on the terminal: text in aligned columns, lines broken to its width


PAGE = 80
WIDEST = 110
INDENT = "  "


def width_of_page() -> int:
    """Return how wide lines may be: that of the terminal, within reason; elsewhere eighty columns."""
    return min(max(shutil.get_terminal_size().columns, NARROWEST), WIDEST) if sys.stdout.isatty() else PAGE


def chapter_lines(chapter: Chapter, width: int) -> Iterator[str]:
    """Give the title of a chapter below an empty line, then its paragraphs, lists and tables, indented."""
    yield ""
    yield from wrapped(chapter.title, width)
    for block in chapter.blocks:
        if isinstance(block, TableView):
            yield from table_lines(block, width)
        elif isinstance(block, Items):
            for text in block.texts:
                yield from wrapped(text, width, INDENT, INDENT * 2)
        else:
            yield from wrapped(getattr(block, "text", ""), width, INDENT)


def wrapped(text: Text, width: int, first: str = "", later: str | None = None) -> Iterator[str]:
    """Break a text into lines; the first begins with ``first``, the others with ``later``."""
    words, later = one_line(plain_text(text)), first if later is None else later
    yield from textwrap.wrap(words, width, initial_indent=first, subsequent_indent=later, break_on_hyphens=False)


def table_lines(table: TableView, width: int) -> Iterator[str]:
    """Give a table without its headings, indented, without columns that hold nothing; then its note."""
    cells = [[INDENT + plain_text(row[0]), *(one_line(plain_text(cell)) for cell in row[1:])] for row in table.rows]
    kept = [index for index, column in enumerate(zip(*cells, strict=True)) if any(column)]
    right = [position for position, index in enumerate(kept) if table.columns[index].kind == "number"]
    rows = [[row[index] for index in kept] for row in cells]
    yield from aligned(rows, right=right, width=width)
    yield from wrapped(table.note, width, INDENT)
