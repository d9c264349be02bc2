"""An explanation on the terminal: eighty columns, the formula first, then what it rests on and what rests on it."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from truing.cli.console import GAP, NARROWEST
from truing.formulas.write_text import HOLD, folded
from truing.numbers import format_number, pretty
from truing.texts import one_line
from truing.units import unit_text

PAGE = 80
WIDEST = 110
MOST = 6
LONGEST_CHAIN = 24
INDENT = "  "
PLACES = {"inputs": "on the inputs", "results": "on the results", "reading": "on the reading"}
Told = dict[str, Any]


def width_of_page() -> int:
    """Return how wide lines may be: that of the terminal, within reason; elsewhere eighty columns."""
    return min(max(shutil.get_terminal_size().columns, NARROWEST), WIDEST) if sys.stdout.isatty() else PAGE


def lines_of(document: Told, width: int) -> Iterator[str]:
    """Say everything that was told of one name."""
    kinds: dict[str, Callable[[Told, int], Iterator[str]]] = {
        "result": _result, "input": _input, "effect": _effect, "tolerance": _tolerance, "condition": _condition,
        "study": _study,
    }  # fmt: skip
    yield from _head(document, width)
    yield from kinds[document["kind"]](document, width)


def _head(document: Told, width: int) -> Iterator[str]:
    symbol = f"  {document['symbol']}" if document.get("symbol") else ""
    value = f" = {document['text']}" if document.get("text") else ""
    yield one_line(document["name"]) + symbol + value
    article = "an" if document["kind"][0] in "aei" else "a"
    yield from _wrapped(f"{article} {document['kind']} of {document['model']} ({one_line(document['title'])})", width)
    if document.get("note"):
        yield from _wrapped(document["note"], width)


def _result(told: Told, width: int) -> Iterator[str]:
    yield from _formula(told, width)
    if told["study"]:
        run = "" if told["text"] != "–" else "; this inputs file does not ask for it"
        yield from _wrapped(f"Given by the study {told['study']}{run}", width)
    yield from _said("Found by", told["method"], width)
    yield from _said("Source", told["source"], width)
    yield from _chain(told, width)
    yield from _scatter(told, width)
    yield from _slopes(told, width)
    yield from _limits(told, width)
    yield from _published(told, width)
    yield from _effects("Effects that change it", told["effects"], width)
    yield from _followed(told, width)


def _formula(told: Told, width: int) -> Iterator[str]:
    formula = told["formula"]
    if formula is None:
        return
    yield ""
    left = f"{formula['left']} = " if formula["left"] else ""
    steps = [formula["symbols"], *filter(None, [formula["numbers"]]), *formula["results"]]
    indent = INDENT + " " * max(len(left) - 2, 0)
    if not left:
        indent, steps = INDENT * 2, [steps[0], *(f"{told['symbol'] or told['name']} = {one}" for one in steps[1:])]
    for index, step in enumerate(steps):
        head = INDENT + left if not index else indent + ("= " if left else "")
        for number, line in enumerate(folded(one_line_held(step), width - len(head))):
            yield ((head if not number else " " * len(head)) + line).replace(HOLD, " ")
    if formula["departs"]:
        yield from _wrapped(
            "An effect on the results is on: the calculation answers another value than the formula.", width
        )


def one_line_held(text: str) -> str:
    """Return a formula without control characters; what holds number and unit together stays."""
    return "".join(c if c.isprintable() or c == HOLD else " " for c in text)


def _chain(told: Told, width: int) -> Iterator[str]:
    """Say what the result is made from, down to the inputs, as far down as there is room."""
    chain = told["chain"]
    if not chain:
        return
    deepest = max(item["depth"] for item in chain)
    while deepest > 1 and sum(item["depth"] <= deepest for item in chain) > LONGEST_CHAIN:
        deepest -= 1
    shown = [item for item in chain if item["depth"] <= deepest]
    yield from _title("Made from")
    rows = [
        (INDENT * (item["depth"] - 1) + item["name"], item["symbol"], "(see above)" if item["again"] else item["text"],
         item["note"])
        for item in shown
    ]  # fmt: skip
    yield from table(rows, width)
    said = {item["name"] for item in shown}
    left = list(dict.fromkeys(item["name"] for item in chain if item["name"] not in said))
    if left:
        yield from _wrapped(f"and these further down: {', '.join(left)}", width, INDENT)


def _scatter(told: Told, width: int) -> Iterator[str]:
    scatter = told["scatter"]
    if scatter is None:
        return
    yield from _title(f"Scatter of the tolerances in force: standard deviation {scatter['sd']}, of which")
    rows = [(item["name"], _percent(item["share"]), _tolerance_words(item)) for item in scatter["shares"][:MOST]]
    yield from table(rows, width, right=(1,))
    yield from _more(scatter["shares"])


def _tolerance_words(item: Told) -> str:
    names = ", ".join(item["tolerances"])
    return item["spread"] if names in {"", item["name"]} else f"{item['spread']}, tolerance {names}"


def _slopes(told: Told, width: int) -> Iterator[str]:
    if told["slopes"]:
        yield from _title("One per cent more of an input (1 K of a temperature) changes it by")
        rows = [(item["name"], _plus(item["change"]), _per_cent(item["percent"])) for item in told["slopes"][:MOST]]
        yield from table(rows, width, right=(1, 2))
        yield from _more(told["slopes"])
    for text in told["remarks"]:
        yield from _wrapped(text, width, INDENT)


def _limits(told: Told, width: int) -> Iterator[str]:
    if told["limits"]:
        yield from _title("Limits that rest on it")
        for item in told["limits"]:
            words = _check_words(item)
            yield from _wrapped(f"{item['says']}: {words}" if words else item["says"], width, INDENT, INDENT * 2)


def _check_words(limit: Told) -> str:
    check = limit["check"]
    if check is None:
        return ""
    if check["state"] == "undecided":
        return "calc run decides it"
    value = f"{format_number(check['value'], 5)} {unit_text(check['unit'])}".strip()
    verdict = "passes" if check["passed"] else "FAILS"
    return f"{value} {verdict}, margin {format_number(check['margin'], 3)}"


def _published(told: Told, width: int) -> Iterator[str]:
    if not told["published"]:
        return
    yield from _title("What the source prints, and ours")
    for item in told["published"]:
        unit = f" {item['unit']}" if item["unit"] else ""
        ours = f"ours {format_number(item['ours'], 5)}" if item["ours"] is not None else "ours by calc verify"
        with_ = ", ".join(f"{name} = {value}" for name, value in item["settings"].items())
        settings = f"; with {with_}" if with_ else ""
        where = item["where"] or item["name"]
        said = f"{format_number(item['paper'], 6)}{unit}, {ours}: {item['verdict']} ({where}{settings})"
        yield from _wrapped(said, width, INDENT, INDENT * 2)


def _effects(title: str, effects: Sequence[Told], width: int) -> Iterator[str]:
    if effects:
        yield from _title(title)
        rows = [
            (item["name"], PLACES[item["acts_on"]] + (", is on" if item["on"] else ""), item["looks_like"])
            for item in effects
        ]
        yield from table(rows, width)


def _followed(told: Told, width: int) -> Iterator[str]:
    direct, further = told["followed_by"], told["then"]
    if direct:
        yield from _title("Results that follow from it")
        yield from _wrapped(", ".join(direct), width, INDENT)
        if further:
            yield from _wrapped(f"and through these: {', '.join(further)}", width, INDENT)


def _input(told: Told, width: int) -> Iterator[str]:
    stated = "stated by the inputs file" if told["stated"] else "the default"
    allowed = " | ".join(told["choices"]) or told["bounds"]
    yield from _wrapped(f"{stated}; {allowed}" if allowed else stated, width)
    yield from _said("Source", told["source"], width)
    for item in told["tolerances"]:
        yield from _wrapped(_spread_words(item), width)
    if told["namesake"]:
        place = f"{told['model']}.tolerances.{told['name']}"
        yield from _wrapped(f"the tolerance of this name scatters {', '.join(told['namesake'])}: see {place}", width)
    for words in (*told["varied"], *(f"is the limit of {one}" for one in told["limit_of"])):
        yield from _wrapped(words, width)
    yield from _moves(told, width)
    if told["limits"]:
        yield from _title("Limits that rest on it")
        for words in told["limits"]:
            yield from _wrapped(words, width, INDENT, INDENT * 2)
    yield from _followed(told, width)
    yield from _effects("Effects that change it", told["effects"], width)


def _spread_words(item: Told) -> str:
    sd = f" (standard deviation {', '.join(item['sd'][:3])})" if item["sd"] else ""
    why = f", {item['why']}" if item["why"] else ""
    return f"scatters by the tolerance {item['name']}: {item['spread']}{sd}{why}"


def _moves(told: Told, width: int) -> Iterator[str]:
    """Say which results an input or a tolerance moves: the largest share of their scatter first, then the steepest."""
    rows = told["moves"]
    if rows is None:
        return
    if not rows:
        yield from _title("No result of the calculation moves with it, as things stand")
        return
    slopes = any(row["change"] for row in rows)
    yield from _title("Results it moves" + (": one per cent more of it (1 K), and its share of their scatter" if slopes
                                            else ": its share of their scatter"))  # fmt: skip
    cells = [
        (row["name"], *((_plus(row["change"]), _per_cent(row["percent"])) if slopes else ()), _percent(row["share"]),
         row["note"])
        for row in rows[: 2 * MOST]
    ]  # fmt: skip
    yield from table(cells, width, right=(1, 2, 3) if slopes else (1,))
    yield from _more(rows, 2 * MOST)


def _tolerance(told: Told, width: int) -> Iterator[str]:
    yield from _wrapped(_spread_words(told).removeprefix("scatters by the tolerance "), width)
    yield from _said("Source", told["source"], width)
    for price in told["price"]:
        yield from _said("Price", price, width)
    yield from _title("Inputs that scatter by it, each on its own")
    yield from table([(item["name"], item["text"]) for item in told["on"]], width)
    yield from _moves(told, width)


def _effect(told: Told, width: int) -> Iterator[str]:
    state = "is on" if told["on"] else "is off"
    yield from _wrapped(f"acts {PLACES[told['acts_on']]}; {state}; looks like: {told['looks_like'] or '–'}", width)
    yield from _said("Why", told["why"], width)
    yield from _said("Source", told["source"], width)
    if told["built_in"]:
        yield from _wrapped(
            "One of the kernel's own: it can act on the reading of any result, and never on a machine.", width
        )
    if told["unknowns"]:
        yield from _title("Unknowns")
        rows = [
            (item["name"], f"{item['low']:g} .. {item['high']:g} {item['unit']}".strip(), item["text"], item["note"])
            for item in told["unknowns"]
        ]
        yield from table(rows, width)
    if told["needs"]:
        yield from _title("Conditions it needs")
        yield from table([(one["name"], f"reference {one['reference']}", one["note"]) for one in told["needs"]], width)
    yield from _tried(told, width)


def _tried(told: Told, width: int) -> Iterator[str]:
    """Say what changed when the effect was tried."""
    if not told["tried_at"]:
        return
    at = ", ".join(f"{item['name']} {item['text']}" for item in told["tried_at"])
    yield from _title(f"Tried at {at}", width)
    if not told["moves"]:
        yield INDENT + "no result changes there"
    rows = [(item["name"], _per_cent(item["percent"]) or "from 0", item["note"]) for item in told["moves"][: 2 * MOST]]
    yield from table(rows, width, right=(1,))
    yield from _more(told["moves"], 2 * MOST)
    if told["inputs"]:
        yield from _title("through these inputs")
        pairs = [(item["name"], f"{item['before']} -> {item['after']}") for item in told["inputs"][: 2 * MOST]]
        yield from table(pairs, width)
        yield from _more(told["inputs"], 2 * MOST)


def _condition(told: Told, width: int) -> Iterator[str]:
    yield f"reference {told['reference']}: there its effects vanish"
    yield from _said("Range", told["range"], width)
    yield from _said("Made", told["derived"], width)
    yield from _effects("Effects that need it", told["effects"], width)


def _study(told: Told, width: int) -> Iterator[str]:
    yield "asked for by this inputs file" if told["asked"] else "not asked for by this inputs file"
    if told["gives"]:
        yield from _title("Results it gives")
        yield from _wrapped(", ".join(told["gives"]), width, INDENT)


def _title(text: str, width: int = PAGE) -> Iterator[str]:
    yield ""
    yield from _wrapped(text, width)


def _said(label: str, text: str, width: int) -> Iterator[str]:
    if text:
        yield from _wrapped(f"{label}: {text}", width)


def _wrapped(text: str, width: int, first: str = "", later: str | None = None) -> Iterator[str]:
    later = first if later is None else later
    yield from textwrap.wrap(
        one_line(text), width, initial_indent=first, subsequent_indent=later, break_on_hyphens=False
    )


def _more(items: Sequence[Any], most: int = MOST) -> Iterator[str]:
    if len(items) > most:
        yield f"{INDENT}and {len(items) - most} more (--json has all)"


def _percent(share: float) -> str:
    return f"{format_number(100 * share, 3)} %" if share else ""


def _per_cent(percent: float | None) -> str:
    return "" if percent is None else _plus(f"{pretty(format_number(percent, 3))} %")


def _plus(text: str) -> str:
    return text if text.startswith(("−", "-", "–")) else f"+{text}"


def table(rows: Sequence[Sequence[str]], width: int, *, right: Sequence[int] = ()) -> Iterator[str]:
    """Give rows in aligned columns, indented; the last column is broken where the line would be too wide."""
    cells = [[cell if not index else one_line(cell) for index, cell in enumerate(row)] for row in rows]
    kept = [index for index in range(len(cells[0]) if cells else 0) if any(row[index] for row in cells)]
    cells = [[row[index] for index in kept] for row in cells]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    flush = [index in right for index in kept]
    indent = len(INDENT) + sum(widths[:-1]) + len(GAP) * (len(widths) - 1)
    room = width - indent
    for row in cells:
        sized = zip(row[:-1], widths, flush, strict=False)
        front = [cell.rjust(size) if is_flush else cell.ljust(size) for cell, size, is_flush in sized]
        last = row[-1].rjust(widths[-1]) if flush[-1] else row[-1]
        head = GAP.join([INDENT + front[0], *front[1:], ""]) if front else INDENT
        if len(head) + len(last) <= width or room < NARROWEST // 3:
            yield (head + last).rstrip()
            continue
        first, *others = textwrap.wrap(last, room, break_on_hyphens=False)
        yield head + first
        yield from (" " * len(head) + part for part in others)
