"""The inputs file that ``calc init`` writes, text or a workbook: the plugin's own, or one made from the declaration."""

from __future__ import annotations

import textwrap
import tomllib
from collections.abc import Iterator
from dataclasses import MISSING
from pathlib import Path
from typing import Any

from truing.declare.fields import InputField
from truing.declare.model import Model, Study
from truing.declare.sources import Tolerance, Unknown
from truing.errors import PluginError, UnitError
from truing.formulas import symbol_text
from truing.formulas.symbols import printable
from truing.inputs_file.assemble import default_of, spread_text, toml_key, toml_value
from truing.inputs_file.document import SECTIONS
from truing.inputs_file.entries import HEAD as HEAD_WORDS
from truing.inputs_file.entries import described
from truing.inputs_file.study_options import options_of
from truing.inputs_file.values import bounds_in_words, plain
from truing.inputs_file.workbook import COLUMNS, SHEET
from truing.kernel import Offer
from truing.setup import DEFAULT_SEED
from truing.templating import ENGLISH, languages
from truing.units.grammar import split
from truing.units.names import PURE
from truing.units.systems import UNIT_SYSTEMS
from truing.workbooks.writing import SheetTable, workbook_bytes

WIDTH = 100
SCHEMA_MARK = "#:schema "
"""What begins the comment by which editors that use Taplo find the schema of a file."""
HEAD = {"project": "", "drawing": "", "revision": "", "prepared_by": "", "checked_by": "", "approved_by": ""}
SHEET_WORDS = {
    **{name: ({"logo": "logo.svg", "style": "house.css"}.get(name, ""), words) for name, words in HEAD_WORDS.items()},
    "detail": ("normal", "how much the sheet shows: short, normal or full"),
    "paper": ("A4", "A4 or letter"),
    "units": ("SI", f"units of all that people read: {' or '.join(UNIT_SYSTEMS)}; without it those that are declared"),
    "language": (ENGLISH, f"language of the sheet: {' or '.join(languages())}"),
}
"""What may stand in ``[sheet]``: a value to begin with, and what it is."""


def example_text(offer: Offer) -> str:
    """Return a commented inputs file that runs as it is: the one the plugin ships, else its defaults.

    In the latter every input stands with its default, and everything else as a comment to be uncommented. A data file
    that has no default must still be named. Raises PluginError where the shipped example cannot be read.
    """
    if offer.model.example is not None:
        try:
            return offer.model.example.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise PluginError(
                f"{offer.model.example}: the example of '{offer.name}' cannot be read: {error}"
            ) from error
    return "\n".join(_lines(offer)) + "\n"


def text_to_fill_in(offer: Offer) -> str:
    """Return the inputs file that ``calc init`` writes: the example, and what else may stand at the head of its sheet.

    That stands in comments, behind what the example states there.
    """
    lines = example_text(offer).split("\n")
    start = next((index for index, line in enumerate(lines) if line.strip() == "[sheet]"), None)
    if start is None:
        return "\n".join(lines)
    end = next((index for index in range(start + 1, len(lines)) if lines[index].lstrip().startswith("[")), len(lines))
    while not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#"):
        end -= 1  # comments before the next heading belong to that
    named = {line.lstrip("# ").partition("=")[0].strip() for line in lines[start + 1 : end + 1]}
    further = [f"# {name} = {toml_value(value)}" for name, (value, _) in SHEET_WORDS.items() if name not in named]
    widest = max(map(len, further), default=0)
    notes = [words for name, (_, words) in SHEET_WORDS.items() if name not in named]
    said = [f"{line.ljust(widest)}  # {words}" for line, words in zip(further, notes, strict=True)]
    return "\n".join([*lines[:end], *said, *lines[end:]])


def example_of(offer: Offer) -> tuple[str, str, Path]:
    """Return that text, the name of the file it stands for, and the folder in which it looks for data files."""
    shipped = offer.model.example
    file, folder = (str(shipped), shipped.parent) if shipped is not None else ("example.toml", Path.cwd())
    return example_text(offer), file, folder


def schema_name(offer: Offer) -> str:
    """Return the name of the file that holds the JSON Schema of the model's inputs files."""
    return f"{offer.name}.schema.json"


def with_schema_line(text: str, schema: str) -> str:
    """Return an inputs file that names its schema, a file beside it, in the first line; an earlier such line goes."""
    first, _, rest = text.partition("\n")
    return f"{SCHEMA_MARK}./{schema}\n{rest if first.startswith(SCHEMA_MARK) else text}"


def _lines(offer: Offer) -> Iterator[str]:
    model = offer.model
    yield from _comment(f"{model.title}. Inputs of `calc run {offer.name}`.")
    yield from _comment('Every value carries its unit: "120 N", "0.12 kN". A line that begins with # is not read.')
    yield f"plugin = {toml_value(offer.name)}"
    yield from ("", "[sheet]")
    yield from (f"{name} = {toml_value(value)}" for name, value in HEAD.items())
    yield from ("", "[inputs]")
    for field in model.input_fields.values():
        yield from _input(field)
    yield from _tolerances(model)
    yield from _correlations(model)
    yield from _conditions(model)
    yield from _effects(model)
    yield from _studies(model)
    yield from _units(model)


def _comment(text: str, mark: str = "# ") -> list[str]:
    return [f"{mark}{line}" for line in textwrap.wrap(text, WIDTH - len(mark))]


def _input(field: InputField) -> Iterator[str]:
    words = described(field)
    if field.choices:
        words = "; ".join(part for part in (words, " or ".join(toml_value(choice) for choice in field.choices)) if part)
    yield from _comment(words)
    yield _assignment(field)


def _assignment(field: InputField) -> str:
    default = default_of(field)
    if default is not None:
        return f"{field.name} = {toml_value(default)}"
    if field.kind == "file":
        is_open = field.spec.default is not MISSING
        return f'{"# " if is_open else ""}{field.name} = {{ file = "{field.name}.txt" }}'
    like = "..." if field.kind in {"choice", "text"} else f"1 {field.unit}".strip()
    return f"# {field.name} = {toml_value(like)}"


def _heading(title: str, words: str) -> list[str]:
    return ["", *_comment(words), f"# [{title}]"]


def _tolerances(model: Model[Any, Any]) -> Iterator[str]:
    if not model.tolerances:
        return
    words = 'How inputs scatter: "±0.05 mm", "sd 3 %", "band 0.125 mm", "IT6", "off". As declared:'
    yield from _heading("tolerances", words)
    defaults = {name: default_of(field) for name, field in model.input_fields.items()}
    for tolerance in model.tolerances.values():
        yield from _comment(_why(tolerance), "#   ")
        stated = spread_text(tolerance.spread, defaults)
        if stated:
            yield f"# {toml_key(tolerance.name)} = {toml_value(stated)}"
        else:
            yield f"#   {tolerance.name} is {tolerance.spread.text}"


def _correlations(model: Model[Any, Any]) -> Iterator[str]:
    if not model.correlations:
        return
    yield from _heading("correlations", "Which inputs scatter together, and how much; 0 is not at all. As declared:")
    for pair in model.correlations:
        yield from _comment("; ".join(filter(None, (pair.why, pair.source))), "#   ")
        yield f"# {toml_key(pair.name)} = {toml_value(pair.coefficient)}"


def _why(tolerance: Tolerance) -> str:
    on = "" if tolerance.on == (tolerance.name,) else f"on {', '.join(tolerance.on)}"
    return "; ".join(part for part in (on, tolerance.why, tolerance.source) if part)


def _conditions(model: Model[Any, Any]) -> Iterator[str]:
    if not model.conditions:
        return
    yield from _heading("conditions", "What is measured but no input of the model; effects vanish at these values.")
    for condition in model.conditions.values():
        yield from _comment(condition.note, "#   ")
        yield f"# {condition.name} = {toml_value(f'{plain(condition.reference)} {condition.unit}'.strip())}"


def _effects(model: Model[Any, Any]) -> Iterator[str]:
    for effect in model.effects.values():
        words = effect.why or effect.looks_like
        yield from _heading(f"effects.{toml_key(effect.name)}", f"An effect to switch on: {words or effect.name}.")
        for unknown in effect.unknowns:
            bounds = f"from {plain(unknown.low)} to {plain(unknown.high)} {unknown.unit}".strip()
            yield from _comment("; ".join(part for part in (unknown.note, bounds) if part), "#   ")
            yield f"# {unknown.name} = {toml_value(middle_of(unknown))}"


def middle_of(unknown: Unknown) -> str:
    """Return nothing for an amplitude, the middle (on a logarithmic scale where positive) for a shape."""
    value = 0.0
    if not unknown.is_amplitude:
        positive = unknown.low > 0
        value = (unknown.low * unknown.high) ** 0.5 if positive else (unknown.low + unknown.high) / 2
    short = plain(float(f"{value:.3g}"))
    return short if unknown.unit in PURE else f"{short} {unknown.unit}"


def _studies(model: Model[Any, Any]) -> Iterator[str]:
    if not model.studies:
        return
    yield from _heading("studies", "Which studies run, in this order, and where their random numbers begin.")
    yield f"# run = {toml_value([study.name for study in model.studies])}"
    yield f"# seed = {DEFAULT_SEED}"
    for study in model.studies:
        options = [f"# {name} = {toml_value(value)}" for name, value in _options(study).items()]
        if options:
            yield from ("", f"# [studies.{toml_key(study.name)}]", *options)


def _options(study: Study) -> dict[str, Any]:
    """Return the options of a study that a file can state as they are."""
    values = {name: getattr(study, name) for name in options_of(study)}
    return {name: value for name, value in values.items() if _is_plain(value)}


def _is_plain(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return all(_is_plain(one) for one in value)
    return isinstance(value, (bool, int, float, str))


def _units(model: Model[Any, Any]) -> Iterator[str]:
    printed = {name: field.unit for name, field in model.result_fields.items() if field.unit not in PURE}
    if printed:
        yield from _heading("units", "The unit in which a result is printed.")
        yield from (f"# {name} = {toml_value(unit)}" for name, unit in printed.items())


# The same as a workbook, to be filled in by somebody who has no Truing


def example_book(offer: Offer) -> bytes:
    """Return a workbook that states what the example does, with a row for every input; read back it is the same.

    An input that the example does not state has no value there; its note says what then holds. Choices and switches
    offer what they may be. Data files are looked for beside the workbook. Raises PluginError and UsageError.
    """
    model, stated = offer.model, tomllib.loads(example_text(offer))
    rows: list[tuple[Any, ...]] = [("plugin", stated.pop("plugin", offer.name), "", "", "the calculation", "")]
    given = stated.pop("inputs", {})
    choices: dict[tuple[int, int], tuple[Any, ...]] = {}
    for field in model.input_fields.values():
        if field.choices or field.kind == "switch":
            choices[len(rows), COLUMNS.index("value")] = tuple(field.choices) or (True, False)
        value, unit = _parted(given.pop(field.name, None), field)
        symbol = symbol_text(field.symbol) if field.symbol else ""
        rows.append((field.name, value, unit, symbol, _noted(field, value), printable(field.spec.source)))
    rows += [(name, _in_a_cell(value), "", "", "", "") for name, value in given.items()]  # under an old name
    for section, entries in stated.items():
        for name, value in _dotted(section, entries, 2 if section in {"effects", "studies"} else 1):
            rows.append((name, _in_a_cell(value), "", "", SECTIONS.get(section, ""), ""))
    return workbook_bytes([SheetTable(SHEET, COLUMNS, rows, choices)])


def _parted(value: Any, field: InputField) -> tuple[Any, str]:
    """Return number and unit of a quantity; anything else as a cell holds it, without a unit but with the declared."""
    unit = "" if field.unit in PURE else field.unit
    if value is None or field.kind not in {"float", "whole"}:
        return _in_a_cell(value), unit if field.kind in {"float", "whole"} else ""
    if not isinstance(value, str):
        return value, ""
    try:
        quantity = split(value)
    except UnitError:
        return value, ""
    return quantity.value, quantity.unit


def _noted(field: InputField, value: Any) -> str:
    default = default_of(field)
    empty = f"empty: {default if isinstance(default, str) else toml_value(default)}" if default is not None else ""
    parts = [printable(field.spec.note), bounds_in_words(field), empty if value is None else ""]
    return "; ".join(part for part in parts if part)


def _dotted(name: str, value: Any, depth: int) -> Iterator[tuple[str, Any]]:
    """Give the entries of a section by the names that ``--set`` calls them by."""
    if not isinstance(value, dict) or not depth:
        yield name, value
        return
    for key, inner in value.items():
        yield from _dotted(f"{name}.{key}", inner, depth - 1)


def _in_a_cell(value: Any) -> Any:
    return toml_value(value) if isinstance(value, (dict, list)) else value
