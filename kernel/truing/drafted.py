"""A single-file plugin drafted from a column of a sheet, or from what was typed: inputs, results, their formulas.

Every result is computed from the stored values of the cells that it names, and compared with the value that is stored
in its own cell. So a factor that only converts units gives itself away, cell by cell.
"""

from __future__ import annotations

import ast
import copy
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from truing.errors import DeclarationError, Fault, InputError
from truing.formulas.evaluation import evaluate
from truing.formulas.parsing import parse
from truing.formulas.tree import ARGUMENTS, CONSTANTS
from truing.inputs_file.files import opened_book
from truing.measurements.csv_text import LARGEST_TABLE, name_and_unit
from truing.measurements.workbook_rows import unit_in_cell
from truing.new_project import LONGEST_NAME, NewPlugin, python_text, spelled
from truing.templating import rendered
from truing.units import from_si, to_si
from truing.units.grammar import shown
from truing.workbooks.cell_formulas import translated
from truing.workbooks.reading import in_per_cent

MOST_QUANTITIES = 300
"""A column with more numbers and formulas is a table; a sheet of that size is no calculation that one person reads."""
MOST_FACTORS = 12
"""So many factors of a formula are looked at; that makes 298 ways to leave out one, two or three of them."""
SAME = 1e-9
"""A result equals the stored value within this, relatively: spreadsheets store 15 digits."""
NEVER_STORED = "no value was stored"
TAKEN = frozenset({*ARGUMENTS, *CONSTANTS, "np", "given", "found", "inputs", "results", "cells", "known"})
"""Names with a meaning in the drafted file."""
Place = tuple[int, int]
"""Row and column of a cell, counted from 1."""


@dataclass(frozen=True)
class Quantity:
    """A number or a formula, of a sheet or typed; ``stored`` is its value in ``unit``, ``formula`` empty for an input.

    ``typed`` is the formula as it stands in the cell; ``why`` says why it could not be
    translated, and ``unknown_unit`` is what stands in the place of its unit and is none. ``symbol`` and ``bounds``
    (such as "above=0.0") are of quantities that were typed, which have no cell.
    """

    name: str
    cell: str
    note: str
    unit: str
    source: str
    stored: float
    typed: str = ""
    formula: str = ""
    why: str = ""
    unknown_unit: str = ""
    symbol: str = ""
    bounds: tuple[str, ...] = ()

    @property
    def printed(self) -> str:
        """The stored value with the digits to which ours must agree."""
        return f"{self.stored:#.10g}"


@dataclass(frozen=True)
class LeftOut:
    """A formula without a number: it is kept as a comment, and why."""

    cell: str
    note: str
    typed: str
    why: str


@dataclass(frozen=True)
class Draft:
    """What was made of a column; ``said`` holds what a reader must know of it, a sentence each."""

    sheet: str
    inputs: tuple[Quantity, ...]
    results: tuple[Quantity, ...]
    left_out: tuple[LeftOut, ...]
    said: tuple[str, ...]


@dataclass(frozen=True)
class _Grid:
    """The cells of a sheet that hold anything: as stored, as typed, and what Excel calls each."""

    stored: Mapping[Place, Any]
    typed: Mapping[Place, Any]
    address: Callable[[int, int], str]


def draft_of(path: Path) -> Draft:
    """Draft a calculation from the sheet, or the range, that a path names: "book.xlsx#Sheet!A4:E20".

    Raises InputError where the file is no workbook, or its column holds no number and no formula of numbers.
    """
    grid = _read(path)
    places, column = _values(grid, path)
    found, left_out = _quantities(grid, places, column)
    sheet = grid.address(*places[0]).rpartition("!")[0]
    plain = [quantity for quantity in found if not quantity.typed]
    inputs, results = _translated(plain, [quantity for quantity in found if quantity.typed], sheet)
    if not results and any(cell.why == NEVER_STORED for cell in left_out):
        calculate = "open the workbook in Excel or LibreOffice, let it calculate, and save it"
        raise InputError([Fault(f"holds formulas whose values were never stored; {calculate}", str(path))])
    if not inputs or not results:
        what = "formula of numbers: nothing would be a result" if inputs else "number: nothing would be an input"
        raise InputError([Fault(f"holds no {what}; name the range of the calculation", str(path))])
    values = {quantity.name: float(to_si(quantity.stored, quantity.unit)) for quantity in found}
    checked = [_checked(quantity, values) for quantity in results]
    said = [sentence for _, sentence in checked if sentence]
    for quantity in found:
        if quantity.unknown_unit:
            what = f"{shown(quantity.unknown_unit)} is no unit that is known, and none is written"
            said.append(f"{quantity.name} ({quantity.cell}): {what}")
    return Draft(sheet, tuple(inputs), tuple(quantity for quantity, _ in checked), tuple(left_out), tuple(said))


def drafted_file(plan: NewPlugin, draft: Draft, book: str = "") -> str:
    """Return the Python file of a draft; ``book`` is the name of the workbook, empty where there is none."""
    known = {quantity.name for quantity in draft.inputs}
    argument = "cells" if book else "known"
    code = {quantity.name: _code(quantity.formula, known, argument) for quantity in draft.results}
    words: dict[str, Any] = {
        **plan.words, "draft": draft, "book": book, "quoted": python_text, "code": code, "argument": argument,
        "uses_numpy": any("np." in line for line in code.values()),
    }  # fmt: skip
    return rendered("single/drafted.py.j2", words)


# The sheet: which columns hold what


def _read(path: Path) -> _Grid:
    grids: list[dict[Place, Any]] = []
    for stored in (True, False):
        with opened_book(path, largest=LARGEST_TABLE, stored=stored) as sheet:
            first = sheet.area.first_column
            cells = {
                (row, column): cell
                for row, cells in sheet.rows()
                for column, cell in enumerate(cells, start=first)
                if cell.value is not None
            }
            grids.append(cells)
    return _Grid(grids[0], grids[1], sheet.address)


def _values(grid: _Grid, path: Path) -> tuple[list[Place], int]:
    """Return the cells of the column with most numbers and formulas, and the column."""
    valued = [place for place, cell in grid.typed.items() if _is_number(cell.value) or cell.data_type == "f"]
    if not valued:
        raise InputError([Fault("holds no numbers and no formulas; name the sheet and the range", str(path))])
    column, count = Counter(column for _, column in valued).most_common(1)[0]
    if count > MOST_QUANTITIES:
        many = f"holds {count} numbers and formulas in one column, at most {MOST_QUANTITIES} are drafted"
        raise InputError([Fault(f"{many}; name the range of the calculation", str(path))])
    return sorted(place for place in valued if place[1] == column), column


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _columns(grid: _Grid, rows: set[int], value: int) -> tuple[int, int, int]:
    """Return the columns of labels, units and remarks, 0 where there is none."""
    texts = {
        place: cell.value for place, cell in grid.stored.items()
        if place[0] in rows and place[1] != value and isinstance(cell.value, str)
    }  # fmt: skip
    units = Counter(column for (_, column), text in texts.items() if unit_in_cell(text) is not None)
    unit = max(units, key=lambda column: (units[column], column > value), default=0)
    filled = Counter(column for _, column in texts if column != unit)
    label = min((column for column, count in filled.items() if 2 * count >= len(rows)), default=0)
    remark = min((column for column in filled if column > value and column != label), default=0)
    return label, unit, remark


def _quantities(grid: _Grid, places: list[Place], column: int) -> tuple[list[Quantity], list[LeftOut]]:
    """Return what the cells of the column are, with their units, and the formulas whose value is no number."""
    label, unit, remark = _columns(grid, {row for row, _ in places}, column)
    found, left_out, taken = list[Quantity](), list[LeftOut](), set(TAKEN)
    for row, _ in places:
        cell = grid.address(row, column).rpartition("!")[2]
        note, own_unit = _label(_text(grid, row, label))
        typed = grid.typed[row, column]
        formula = _plain(typed.value) if typed.data_type == "f" else ""
        stored = grid.stored.get((row, column))
        if stored is None or not _is_number(stored.value):
            why = NEVER_STORED if stored is None else f"its value is no number: {_plain(str(stored.value))}"
            left_out.append(LeftOut(cell, note, formula, why))
            continue
        text = _text(grid, row, unit) or own_unit
        written = unit_in_cell(text) if text else ""
        number = in_per_cent(stored) if written == "%" else float(stored.value)
        name = _name(note, cell, taken)
        source, unknown = _text(grid, row, remark), text if written is None else ""
        found.append(Quantity(name, cell, note or cell, written or "", source, number, formula, unknown_unit=unknown))
    return found, left_out


def _text(grid: _Grid, row: int, column: int) -> str:
    cell = grid.stored.get((row, column))
    return _plain(cell.value) if cell is not None and isinstance(cell.value, str) else ""


def _plain(value: Any) -> str:
    """Return the text of a cell in one line that can be printed; a formula over several cells is no text."""
    text = value if isinstance(value, str) else f"={type(value).__name__}"
    return " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())


def _label(text: str) -> tuple[str, str]:
    """Take "Force [N]" and "Force:" apart: the note, and a unit where one stands in brackets."""
    name, unit = name_and_unit(text)
    return (text if name is None else name).rstrip(" :=").strip(), unit or ""


def _name(note: str, cell: str, taken: set[str]) -> str:
    """Return a name that is not taken yet, and take it: the first words of a note, or that of the cell."""
    words = re.findall(r"\w+", note)
    while words and not spelled("_".join(words)) and not spelled("_".join([*words, "value"])):
        words.pop()
    plain = spelled("_".join(words)) or spelled("_".join([*words, "value"])) if words else f"cell_{cell.lower()}"
    plain = name = f"{plain}_value" if plain in TAKEN else plain
    number = 1
    while name in taken:
        number += 1
        name = f"{plain[: LONGEST_NAME - 4].rstrip('_')}_{number}"
    taken.add(name)
    return name


# Formulas: translated in an order in which each knows what it needs, and compared with the workbook


class _WaitsError(ValueError):
    """A formula needs another one, which is not translated yet."""


def _translated(inputs: list[Quantity], formulas: list[Quantity], sheet: str) -> tuple[list[Quantity], list[Quantity]]:
    """Return inputs and results, each result behind those that it needs.

    A formula that cannot be translated, or that needs itself, becomes an input with the value that was stored.
    """
    names = {quantity.cell: quantity.name for quantity in [*inputs, *formulas]}
    known, results, waiting = {quantity.cell for quantity in inputs}, list[Quantity](), list(formulas)
    while waiting:
        later: list[tuple[Quantity, ValueError]] = []
        for quantity in waiting:
            try:
                results.append(replace(quantity, formula=_translation(quantity.typed, sheet, known, names)))
                known.add(quantity.cell)
            except ValueError as error:
                later.append((quantity, error))
        if len(later) == len(waiting):
            taken = next((pair for pair in later if not isinstance(pair[1], _WaitsError)), later[0])
            inputs = [*inputs, replace(taken[0], why=str(taken[1]))]
            known.add(taken[0].cell)
            later.remove(taken)
        waiting = [quantity for quantity, _ in later]
    return inputs, results


def _translation(typed: str, sheet: str, known: set[str], names: Mapping[str, str]) -> str:
    """Return a formula with names; raises ValueError with what cannot be translated."""

    def name_of(place: str) -> str:
        cell = place.removeprefix(f"{sheet}!")
        if cell not in names:
            raise ValueError(f"{place} is no number of this column")
        if cell not in known:
            raise _WaitsError(f"{place} needs this cell itself")
        return names[cell]

    formula = translated(typed, name_of)
    try:
        if not parse(formula).names:
            raise ValueError("it names no cell")
    except DeclarationError as error:
        raise ValueError(str(error)) from None
    return formula


def _checked(quantity: Quantity, values: Mapping[str, float]) -> tuple[Quantity, str]:
    """Compare a result with the value that is stored, and leave out factors that only convert units.

    ``values`` are the stored values of all cells, in SI. Returns the result, with a sentence where it was not equal.
    """
    ratio = _ratio(quantity, quantity.formula, values)
    if abs(ratio - 1) <= SAME:
        return quantity, ""
    where = f"{quantity.name} ({quantity.cell}, {quantity.typed})"
    for formula, factors in _without_factors(quantity.formula):
        if abs(_ratio(quantity, formula, values) - 1) <= SAME:
            why = f"units convert themselves, and with it the result is {ratio:.6g} times that of the workbook"
            return replace(quantity, formula=formula), f"{where}: {' and '.join(factors)} is left out; {why}"
    much = (
        f"{ratio:.6g} times the {quantity.stored:g} {quantity.unit}".rstrip()
        if math.isfinite(ratio)
        else "not the value"
    )
    return quantity, f"{where}: gives {much} of the workbook; look at the units of the cells that it names"


def _ratio(quantity: Quantity, formula: str, values: Mapping[str, float]) -> float:
    """Return the value of a formula over the value that is stored; 1 where both are 0."""
    ours = float(from_si(float(np.real(evaluate(parse(formula), values))), quantity.unit))
    if quantity.stored == 0:
        return 1.0 if abs(ours) < SAME else math.nan
    return ours / quantity.stored


def _without_factors(formula: str) -> Iterator[tuple[str, list[str]]]:
    """Give the formula without up to three of its factors that may convert units, and these factors."""
    tree = ast.parse(formula, mode="eval").body
    products = [
        node for node in ast.walk(tree) if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div)
    ]
    factors = [side for node in products for side in (node.left, node.right) if _may_convert(side)][:MOST_FACTORS]
    for count in (1, 2, 3):
        for chosen in combinations(factors, count):
            text = ast.unparse(_Without(chosen).visit(copy.deepcopy(tree, {id(one): one for one in chosen})))
            yield text.replace(" ** ", "**"), [ast.unparse(one) for one in chosen]


def _may_convert(node: ast.expr) -> bool:
    """Whether a factor may be there to convert a unit: a power of ten, minutes and hours, inches, half a turn."""
    if isinstance(node, ast.Name):
        return node.id == "pi"
    number = node.value if isinstance(node, ast.Constant) else None
    if not isinstance(number, (int, float)) or number <= 0:
        return False
    return number in {60, 3600, 25.4, 180} or (number != 1 and math.log10(number).is_integer())


class _Without(ast.NodeTransformer):
    """Leaves factors out of products and quotients."""

    def __init__(self, chosen: Sequence[ast.expr]) -> None:
        self.chosen = chosen

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """Return the other operand of a number that is left out."""
        self.generic_visit(node)
        if any(node.right is one for one in self.chosen):
            return node.left
        if any(node.left is one for one in self.chosen):
            return node.right if isinstance(node.op, ast.Mult) else ast.BinOp(ast.Constant(1), ast.Div(), node.right)
        return node


# The function: the same formulas in numpy


NUMPY = {
    "asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2",
    **dict.fromkeys(("sqrt", "cbrt", "exp", "log", "log10", "abs", "sign")),
    **dict.fromkeys(("sin", "cos", "tan", "sinh", "cosh", "tanh")),
}  # fmt: skip
"""Functions that numpy has, by what it calls them where that is something else."""
PAIRWISE = {"min": "minimum", "max": "maximum", "hypot": "hypot"}
"""Functions of several numbers, which numpy takes two by two."""
WRITTEN_OUT = {
    "cot": "1 / np.tan({0})", "inv": "np.tan({0}) - ({0})", "either": "np.where(np.isnan({0}), {1}, {0})",
}  # fmt: skip
"""Functions that numpy has not, in words of it."""
CAN_BE_WRITTEN = frozenset({*NUMPY, *PAIRWISE, *WRITTEN_OUT, "cases"})
"""Functions of a formula that are written as code here: those of numbers. ``sum`` and ``mean`` are of series."""


def _code(formula: str, inputs: set[str], argument: str) -> str:
    """Return a formula as the function of the plugin computes it: inputs are fields of its argument."""
    tree = _AsCode(inputs, argument).visit(ast.parse(formula, mode="eval").body)
    return ast.unparse(tree).replace(" ** ", "**")


class _AsCode(ast.NodeTransformer):
    """Writes inputs as fields and functions as those of numpy."""

    def __init__(self, inputs: set[str], argument: str) -> None:
        self.inputs, self.argument = inputs, argument

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """Return a field of the argument, a constant of numpy, or the name of a result."""
        if node.id == "pi":
            return ast.Attribute(ast.Name("np"), "pi")
        return ast.Attribute(ast.Name(self.argument), node.id) if node.id in self.inputs else node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """Return a call of numpy; functions of several numbers are taken two by two."""
        assert isinstance(node.func, ast.Name)
        function = node.func.id
        arguments: list[ast.expr] = [self.visit(argument) for argument in node.args]
        if function in PAIRWISE:
            return reduce(lambda one, other: _numpy(PAIRWISE[function], one, other), arguments)
        if function in WRITTEN_OUT:
            text = WRITTEN_OUT[function].format(*map(ast.unparse, arguments))
            return ast.parse(text, mode="eval").body
        if function == "cases":
            pairs = list(zip(arguments[:-1:2], arguments[1::2], strict=True))
            return reduce(lambda rest, pair: _numpy("where", pair[1], pair[0], rest), reversed(pairs), arguments[-1])
        return _numpy(NUMPY.get(function) or function, *arguments)

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        """Return a comparison of arrays; one of three or more sides is two or more comparisons."""
        sides: list[ast.expr] = [self.visit(side) for side in (node.left, *node.comparators)]
        links = [ast.Compare(sides[i], [sign], [sides[i + 1]]) for i, sign in enumerate(node.ops)]
        return reduce(lambda one, other: _numpy("logical_and", one, other), list[ast.expr](links))

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        """Return what joins conditions, for arrays."""
        joint = "logical_and" if isinstance(node.op, ast.And) else "logical_or"
        conditions: list[ast.expr] = [self.visit(condition) for condition in node.values]
        return reduce(lambda one, other: _numpy(joint, one, other), conditions)


def _numpy(function: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(ast.Attribute(ast.Name("np"), function), list(arguments), [])
