"""A calculation of one's own from what was typed on a page, or from a workbook: checked as typed, written as files."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from truing.api.model import LoadedModel
from truing.calculation import calculate
from truing.declare.near_miss import near_miss
from truing.declare.quantities import has_dimension
from truing.drafted import CAN_BE_WRITTEN, TAKEN, Draft, Quantity, draft_of, drafted_file
from truing.errors import DeclarationError, Fault, InputError, TruingError, UnitError, UsageError
from truing.formulas import Formula, evaluate, evaluate_quantities, parse, symbol_mathml, symbol_text
from truing.formulas.tree import one_spaced, walk
from truing.kernel import offer_of
from truing.new_project import (
    SPELLING,
    NewPlugin,
    check_name,
    check_title,
    project,
    single_file,
    spelled,
    title_of,
    write_project,
    write_single_file,
)
from truing.numbers import format_value, with_unit
from truing.units import check_unit, from_si, human_dimension, pint_quantity, read_quantity, to_si
from truing.workbooks.reading import file_of

LONGEST_NOTE = 200
MOST_ROWS = 300
"""So many inputs and results a form may have; larger models are written in Python."""
Faults = dict[str, str]
"""What is wrong, a sentence by the path of the field: "name", "inputs.0.unit", "results.2.formula"."""


@dataclass
class _Reading:
    """A form as far as it could be read: quantities in their order, values in SI at the defaults, faults by field."""

    faults: Faults = field(default_factory=dict)
    inputs: dict[str, Quantity] = field(default_factory=dict)
    results: dict[str, tuple[str, Quantity, Formula]] = field(default_factory=dict)
    """Results by name: the path of their row, the quantity, its formula."""
    units: dict[str, str] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)


def checked(form: Mapping[str, Any], root: str) -> dict[str, Any]:
    """Return the faults of a form, by field, and what its results are at the defaults, by row."""
    reading = _read(form)
    head = {**_fault_of_name(str(form.get("name", "")), Path(root)), **_fault_of_title(str(form.get("title", "")))}
    values = {}
    for name, (path, quantity, _) in reading.results.items():
        if name in reading.values:
            values[path] = with_unit(*format_value(reading.values[name], quantity.unit))
    return {"faults": {**head, **reading.faults}, "values": values}


def _fault_of_name(name: str, root: Path) -> Faults:
    taken = next((place for place in (f"{name}.py", name) if SPELLING.fullmatch(name) and (root / place).exists()), "")
    if taken:
        return {"name": f"{taken} is in the folder already; choose another name"}
    file = getattr(sys.modules.get(name), "__file__", None)
    if file is not None and not Path(file).exists():  # loaded from a file that has been deleted since
        del sys.modules[name]
    try:
        check_name(name)
    except UsageError as error:
        return {"name": str(error)}
    return {}


def _fault_of_title(title: str) -> Faults:
    try:
        if title.strip():
            check_title(title.strip())
    except UsageError as error:
        return {"title": str(error).removeprefix("--title: ")}
    return {}


# The rows of a form: inputs, results, formulas


def _read(form: Mapping[str, Any]) -> _Reading:
    reading = _Reading()
    rows = {kind: list(_rows(form.get(kind), kind)) for kind in ("inputs", "results")}
    if sum(map(len, rows.values())) > MOST_ROWS:
        raise UsageError(f"a calculation with more than {MOST_ROWS} inputs and results is written in Python")
    taken: set[str] = set()
    for path, row in rows["inputs"]:
        _read_input(reading, path, row, taken)
    for path, row in rows["results"]:
        _read_result(reading, path, row, taken)
    for kind, what in (("inputs", "input"), ("results", "result")):
        if not rows[kind]:
            reading.faults[kind] = f"a calculation has at least one {what}"
    _calculate(reading, {str(row["name"]) for kind in rows for _, row in rows[kind]})
    if not reading.faults:
        reading.faults |= dict(_faults_at_bounds(reading, [path for path, _ in rows["inputs"]]))
    return reading


def _rows(given: Any, kind: str) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the rows that are not empty, each with its path; what is no text counts as empty."""
    for index, row in enumerate(given if isinstance(given, Sequence) and not isinstance(given, str) else ()):
        texts = {key: value.strip() for key, value in row.items() if isinstance(value, str)} if row else {}
        if any(texts.values()):
            words = ("name", "symbol", "unit", "default", "lower", "upper", "note", "formula")
            yield f"{kind}.{index}", {word: texts.get(word, "") for word in words}


def _read_common(reading: _Reading, path: str, row: Mapping[str, str], taken: set[str]) -> bool:
    """Check name, symbol, note and unit; tell whether name and unit can be used."""
    faults = {
        "name": _fault_of_quantity(row["name"], taken), "symbol": _fault_of_symbol(row["symbol"]),
        "note": _fault_of_note(row["note"]), "unit": _fault_of_unit(row["unit"]),
    }  # fmt: skip
    taken.add(row["name"])
    reading.faults |= {f"{path}.{key}": fault for key, fault in faults.items() if fault}
    return not (faults["name"] or faults["unit"])


def _fault_of_quantity(name: str, taken: set[str]) -> str:
    if not name:
        return "needs a name, such as force"
    if not SPELLING.fullmatch(name) or not spelled(name):
        better = spelled(name)
        advice = f"write {better}" if better else "choose another"
        return f"'{name[:40]}' is no name for a quantity: lower-case words of letters and digits joined by _; {advice}"
    if name in TAKEN:
        return f"'{name}' has another meaning in a formula or in the file; choose another name"
    return f"'{name}' is used twice" if name in taken else ""


def _fault_of_symbol(symbol: str) -> str:
    try:
        if symbol:
            symbol_mathml(symbol)
            symbol_text(symbol)
    except TruingError as error:
        return str(error)
    return "" if symbol.isprintable() else "a symbol is one line of printable characters"


def _fault_of_note(note: str) -> str:
    if not note.isprintable():
        return "a note is one line of printable characters"
    return f"a note has at most {LONGEST_NOTE} characters" if len(note) > LONGEST_NOTE else ""


def _fault_of_unit(unit: str) -> str:
    try:
        check_unit(unit)
    except UnitError as error:
        return str(error)
    return ""


def _read_input(reading: _Reading, path: str, row: Mapping[str, str], taken: set[str]) -> None:
    if not _read_common(reading, path, row, taken):
        return
    name, unit = row["name"], row["unit"]
    numbers: dict[str, float] = {}
    for key in ("default", "lower", "upper"):
        text = row[key].removeprefix("<" if key == "upper" else ">").strip() if key != "default" else row[key]
        if not text and key != "default":
            continue
        try:
            numbers[key] = _number(text, unit)
        except UnitError as error:
            reading.faults[f"{path}.{key}"] = str(error) if text else f"needs a value in {unit or 'a pure number'}"
    if "default" not in numbers:
        return
    bounds = list(_bounds(reading, path, row, numbers))
    reading.inputs[name] = Quantity(
        name=name, cell="", note=row["note"] or name.replace("_", " "), unit=unit, source="", stored=numbers["default"],
        symbol=row["symbol"], bounds=tuple(bounds),
    )  # fmt: skip
    reading.units[name] = unit
    reading.values[name] = float(to_si(numbers["default"], unit))


def _number(text: str, unit: str) -> float:
    """Return a number in a unit: as it is written, or from a quantity with a unit of its own. Raises UnitError."""
    try:
        number = float(text)
    except ValueError:
        number = float(from_si(read_quantity(text, unit), unit))
    if not math.isfinite(number):
        raise UnitError(f"'{text[:40]}' is no finite number")
    return number


def _bounds(reading: _Reading, path: str, row: Mapping[str, str], numbers: Mapping[str, float]) -> Iterator[str]:
    """Yield the bounds as they are declared; what the default does not keep is a fault."""
    default = numbers["default"]
    if "lower" in numbers:
        is_open = row["lower"].startswith(">")
        if default < numbers["lower"] or (is_open and default == numbers["lower"]):
            reading.faults[f"{path}.lower"] = "the default is below this bound" if default < numbers["lower"] else (
                "the default is at this bound, which > leaves out")  # fmt: skip
        yield f"{'above' if is_open else 'at_least'}={numbers['lower']!r}"
    if "upper" in numbers:
        is_open = row["upper"].startswith("<")
        if default > numbers["upper"] or (is_open and default == numbers["upper"]):
            reading.faults[f"{path}.upper"] = "the default is above this bound" if default > numbers["upper"] else (
                "the default is at this bound, which < leaves out")  # fmt: skip
        yield f"{'below' if is_open else 'at_most'}={numbers['upper']!r}"


def _read_result(reading: _Reading, path: str, row: Mapping[str, str], taken: set[str]) -> None:
    usable = _read_common(reading, path, row, taken)
    text = one_spaced(row["formula"])
    try:
        formula = parse(text) if text else None
        fault = _fault_of_formula(formula) if formula is not None else "needs a formula, such as force / area"
    except DeclarationError as error:
        formula, fault = None, _without_formula(str(error), text)
    if fault:
        reading.faults[f"{path}.formula"] = fault
    if usable and formula is not None and not fault:
        name, note = row["name"], row["note"] or row["name"].replace("_", " ")
        quantity = Quantity(
            name=name, cell="", note=note, unit=row["unit"], source="", stored=math.nan, symbol=row["symbol"],
            formula=text,
        )  # fmt: skip
        reading.results[name] = (path, quantity, formula)
        reading.units[name] = row["unit"]


def _without_formula(sentence: str, text: str) -> str:
    """Leave out of a sentence the formula that stands beside it."""
    return sentence.removeprefix(f"formula {text!r}: ")


def _fault_of_formula(formula: Formula) -> str:
    if formula.left is not None:
        return "an equation is no formula of a result; write what the result equals"
    for node in walk(formula.right):
        function = getattr(getattr(node, "func", None), "id", "")
        if function and function not in CAN_BE_WRITTEN:
            return f"{function} is not written here; write the calculation in Python for it"
        if function in {"min", "max", "hypot"} and len(getattr(node, "args", ())) < 2:
            return f"{function} of one number is that number; name two or more"
    return "" if formula.names else "it names no input; a constant is an input"


def _calculate(reading: _Reading, names: set[str]) -> None:
    """Bring the results into an order in which each knows what it needs; calculate them and their dimensions."""
    waiting = dict(reading.results)
    ordered: dict[str, tuple[str, Quantity, Formula]] = {}
    while waiting:
        ready = [name for name, (_, _, formula) in waiting.items() if formula.names.isdisjoint(waiting)]
        for name in ready:
            ordered[name] = waiting.pop(name)
            _calculate_one(reading, name, names)
        if not ready:
            for name, (path, _, formula) in waiting.items():
                needs = " and ".join(sorted(formula.names & waiting.keys()))
                reading.faults[f"{path}.formula"] = f"needs {needs}, and so in the end itself"
                ordered[name] = waiting[name]
            break
    reading.results = ordered


def _calculate_one(reading: _Reading, name: str, names: set[str]) -> None:
    path, quantity, formula = reading.results[name]
    unknown = sorted(formula.names - names)
    if unknown:
        hint = near_miss(unknown[0], sorted(names - {name, ""}))
        reading.faults[f"{path}.formula"] = f"there is no input and no result '{unknown[0]}'.{hint}"
    if not formula.names <= reading.values.keys():
        return
    try:
        given = {known: pint_quantity(reading.values[known], reading.units[known]) for known in formula.names}
        answer = evaluate_quantities(formula, given)
    except (UnitError, DeclarationError) as error:
        reading.faults[f"{path}.formula"] = _without_formula(str(error), formula.text)
        return
    if not has_dimension(answer, formula, quantity.unit):
        gives = human_dimension(_unit_of(answer))
        reading.faults[f"{path}.unit"] = f"the formula gives {gives}, not {human_dimension(quantity.unit)}"
        return
    value = float(np.real(evaluate(formula, {known: reading.values[known] for known in formula.names})))
    if not math.isfinite(value):
        reading.faults[f"{path}.formula"] = "gives no finite number at the defaults; choose others"
        return
    reading.values[name] = value


def _faults_at_bounds(reading: _Reading, paths: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield what has no finite answer at a bound that its input may take; the conformance kit asks the same."""
    for path, quantity in zip(paths, reading.inputs.values(), strict=True):
        for bound in quantity.bounds:
            word, _, number = bound.partition("=")
            if word not in {"at_least", "at_most"}:
                continue
            values = {**reading.values, quantity.name: float(to_si(float(number), quantity.unit))}
            for name, (_, _, formula) in reading.results.items():
                values[name] = float(np.real(evaluate(formula, {known: values[known] for known in formula.names})))
                if not math.isfinite(values[name]):
                    column, sign = ("lower", ">") if word == "at_least" else ("upper", "<")
                    yield f"{path}.{column}", f"{name} is not finite at this bound; write {sign} to leave it out"
                    break


def _unit_of(quantity: Any) -> str:
    return f"{quantity.to_base_units().units:~C}".replace("**", "^") or "1"


# What is written


def made(form: Mapping[str, Any], root: str) -> dict[str, Any]:
    """Write the calculation of a form into the folder; return the file, or what is wrong, by field."""
    faults = checked(form, root)["faults"]
    if faults:
        return {"faults": faults}
    reading = _read(form)
    draft = Draft("", tuple(reading.inputs.values()), tuple(one for _, one, _ in reading.results.values()), (), ())
    return {"file": _written(Path(root), _plan(form), drafted_file(_plan(form), draft))}


def _plan(form: Mapping[str, Any]) -> NewPlugin:
    name, title = str(form.get("name", "")), str(form.get("title", "")).strip()
    return NewPlugin(name, title or title_of(name))


def _written(root: Path, plan: NewPlugin, text: str) -> str:
    """Write a file, calculate it once without studies, and return its name; where that fails no file is left."""
    path = root / f"{plan.name}.py"
    write_single_file(path, text)
    try:
        calculate(replace(LoadedModel(offer_of(str(path), lambda _: None)).setup(), studies=()))
    except BaseException:
        path.unlink(missing_ok=True)
        sys.modules.pop(plan.name, None)
        raise
    return path.name


def placeholder(form: Mapping[str, Any], root: str, kind: str) -> dict[str, Any]:
    """Write what ``calc new`` writes, physics to be replaced: a single file, or a project with tests and packaging."""
    faults = {**_fault_of_name(str(form.get("name", "")), Path(root)), **_fault_of_title(str(form.get("title", "")))}
    if faults:
        return {"faults": faults}
    plan = _plan(form)
    if kind == "project":
        files = project(plan)
        write_project(Path(root) / plan.name, files)
        return {"folder": plan.name, "files": sorted(files)}
    return {"file": _written(Path(root), plan, single_file(plan))}


def from_workbook(form: Mapping[str, Any], root: str, book: str, write: bool) -> dict[str, Any]:
    """Draft a calculation from a sheet or a range of a workbook: what became of its cells, and the text of the file.

    ``book`` is its path below the root, with the place behind a # as for ``calc new --from``.
    """
    faults = {**_fault_of_name(str(form.get("name", "")), Path(root)), **_fault_of_title(str(form.get("title", "")))}
    if faults and write:
        return {"faults": faults}
    path = Path(root, book)
    try:
        draft = draft_of(path)
    except InputError as error:
        raise InputError([Fault(one.message, book, one.line, one.cell) for one in error.faults]) from None
    plan = NewPlugin("drafted", "Drafted") if "name" in faults or "title" in faults else _plan(form)
    text = drafted_file(plan, draft, file_of(path).name)
    answer: dict[str, Any] = {
        "faults": faults, "inputs": len(draft.inputs), "results": len(draft.results), "text": text,
        "said": [*draft.said, *_left_out(draft)],
    }  # fmt: skip
    if write:
        answer["file"] = _written(Path(root), plan, text)
    return answer


def _left_out(draft: Draft) -> Iterator[str]:
    for one in draft.inputs:
        if one.why:
            yield f"{one.cell}: {one.typed} is not translated, {one.why}; its value is an input"
    for cell in draft.left_out:
        yield f"{cell.cell}: {cell.typed} is left out, {cell.why}"
