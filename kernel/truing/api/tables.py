"""Values and rows as a user has them: read as the command line and files are, given back as pint's and dataframes."""

from __future__ import annotations

import sys
from collections.abc import Collection, Mapping, Sequence
from importlib.util import find_spec
from numbers import Number, Real
from typing import Any

import numpy as np

from truing.declare.chain import link_to
from truing.declare.model import Model
from truing.declare.taken import Taken
from truing.errors import UsageError
from truing.heavy import narwhals, pint
from truing.inputs_file.assemble import toml_value
from truing.measurements import TableText, table_text
from truing.units import from_si, pint_quantity
from truing.units.names import CURRENCIES

LIBRARIES = ("pandas", "polars", "pyarrow")
LABEL = "dataframe"
"""What sentences call a table that is no file; its first row is line 2, as in a file with a header."""


def frame_of(columns: Mapping[str, Sequence[Any]]) -> Any:
    """Return columns as a dataframe of pandas, polars or pyarrow, the first of them that this process has imported.

    Where it has imported none it is the first that is installed. Raises UsageError where none is.
    """
    in_use = [name for name in LIBRARIES if sys.modules.get(name) is not None]
    library = next(iter([*in_use, *(name for name in LIBRARIES if find_spec(name))]), None)
    if library is None:
        raise UsageError(f"a table in Python needs one of {', '.join(LIBRARIES)}: pip install pandas")
    return narwhals.from_dict(dict(columns), backend=library).to_native()  # type: ignore[arg-type]


def beside(frame: Any, columns: Mapping[str, Any], *, without: Collection[str] = ()) -> Any:
    """Return a dataframe with further columns, of the library that it came from, and without its own of some names."""
    table = narwhals.from_native(frame, eager_only=True)
    table = table.select(name for name in table.columns if name_in(str(name)) not in without)
    made = [narwhals.new_series(name, list(values), backend=table.implementation) for name, values in columns.items()]
    return table.with_columns(*made).to_native()


def name_in(header: str) -> str:
    """Return the name in a header: "load" of "load [N]"."""
    return header.partition("[")[0].strip()


def frame_text(frame: Any, units: Mapping[str, str], *, gaps: bool = False, name: str = LABEL) -> TableText:
    """Return a dataframe as the text that the readers of files read.

    A column is named "load [N]", or "load" with its unit in ``units``. With ``gaps`` NaN is an empty cell; without,
    it is a fault to the readers. Raises UsageError where the dataframe is none, or has no rows, or a row of nothing,
    where its index names a row twice or a column holds numbers and texts.
    """
    table = _table(frame)
    names = [str(name) for name in table.columns]
    unknown = [name for name in units if name not in names]
    if unknown:
        raise UsageError(f"units names '{unknown[0]}', which is no column; the columns are {', '.join(names)}")
    _demand_one_kind(table)
    columns = [[_cell(cell, gaps=gaps) for cell in table[name].to_list()] for name in table.columns]
    empty = next((number for number, row in enumerate(zip(*columns, strict=True), start=1) if not any(row)), 0)
    if empty or not len(table):
        raise UsageError(f"row {empty} of the dataframe holds nothing" if empty else "the dataframe holds no rows")
    headers = [f"{name} [{units[name]}]" if name in units else name for name in names]
    return TableText(name, table_text(headers, columns))


def _table(frame: Any) -> Any:
    """Return a dataframe as narwhals has it. Raises UsageError where it is none, or names a row or column twice."""
    try:
        table = narwhals.from_native(frame, eager_only=True)
    except TypeError:
        raise UsageError(f"{type(frame).__name__} is no dataframe of {', '.join(LIBRARIES)}") from None
    except Exception as error:  # narwhals' own, for columns of one name
        raise UsageError(f"the dataframe cannot be read: {error}") from None
    index = narwhals.maybe_get_index(table)
    if index is not None and not index.is_unique:
        twice = index[index.duplicated()].tolist()[0]
        raise UsageError(f"the index of the dataframe names the row {twice!r} twice; reset_index() numbers the rows")
    return table


def _demand_one_kind(table: Any) -> None:
    """Raise UsageError where a column holds numbers in one row and texts in another."""
    for name in table.columns:
        if table[name].dtype not in (narwhals.Object, narwhals.String):
            continue
        kinds = {_kind(value) for value in table[name].to_list() if not _is_missing(value)}
        if len(kinds) > 1:
            raise UsageError(f"column '{name}' of the dataframe holds {' and '.join(sorted(kinds))}; make it one kind")


def _kind(value: Any) -> str:
    if isinstance(value, bool):
        return "truth values"
    return "numbers" if isinstance(value, Number) else "texts" if isinstance(value, str) else type(value).__name__


def _is_missing(value: Any) -> bool:
    """Whether a cell holds nothing: None, or the NA of pandas, which equals neither itself nor anything else."""
    return value is None or type(value).__name__ in {"NAType", "NaTType"}


def _cell(value: Any, *, gaps: bool) -> str:
    if _is_missing(value) or (gaps and value != value):
        return ""
    plain = value.item() if hasattr(value, "item") else value
    return repr(plain) if isinstance(plain, float) else str(plain)


# Values as a user gives them in Python, written as --set reads them


def settings_of(model: Model[Any, Any], values: Mapping[str, Any]) -> list[str]:
    """Return "name=value" for every value: texts carry units, numbers are in the declared unit, quantities are pint's.

    ``draws`` is that of every study that draws, ``units`` the word "SI" or "inch" of the sheet. Other names are those
    of ``--set``: inputs, conditions, ``seed``, ``language``, and dotted names such as "tolerances.load".
    """
    said = dict(values)
    if "units" in values and "units" not in {*model.input_fields, *model.known_conditions}:
        said["sheet.units"] = said.pop("units")
    if "draws" in values and "draws" not in {*model.input_fields, *model.known_conditions}:
        drawing = [study.name for study in model.studies if hasattr(study, "draws")]
        if not drawing:
            raise UsageError(f"{model.name} has no study that draws; leave out draws")
        said |= dict.fromkeys([f"studies.{study}.draws" for study in drawing], str(said.pop("draws")))
    return [f"{name}={text_of(model, name, value)}" for name, value in said.items()]


def text_of(model: Model[Any, Any], name: str, value: Any) -> str:
    """Return the value of an input or condition as a file has it. Raises UsageError for what is no value."""
    declared = model.input_fields.get(name) or model.known_conditions.get(name)
    unit = declared.unit if declared is not None else ""
    if isinstance(value, str):
        return value
    if isinstance(value, Taken):
        said = {
            each: one if isinstance(one, (str, bool, int, float)) else str(one) for each, one in value.settings.items()
        }
        link = link_to(name, value)
        own_name = {"plugin": link.model} if link.model else {}
        return toml_value({"from": link.source, **own_name, "result": value.result, **said})
    if hasattr(value, "dimensionality"):
        if value.dimensionality != pint_quantity(1.0, unit).dimensionality:
            raise UsageError(f"{name}: {value} cannot be written in {unit or 'a number without a unit'}")
        return _number(float(from_si(float(value.to_base_units().magnitude), unit)), unit)
    if isinstance(value, (bool, np.bool_)):
        return toml_value(bool(value))
    if isinstance(value, (Real, np.number)):
        return _number(value, unit)
    if isinstance(value, (Sequence, np.ndarray)):
        return "[" + ", ".join(toml_value(text_of(model, name, each)) for each in value) + "]"
    raise UsageError(f"{name}: {value!r:.60} is no text, number or quantity")


def _number(value: Any, unit: str) -> str:
    plain = value.item() if hasattr(value, "item") else value
    return f"{plain!r} {unit}".rstrip()


# Quantities of pint, as a user of pint has them: of the application's registry, in the unit that is printed


def quantity_of(si: Any, unit: str) -> Any:
    """Return a number or array in SI as a quantity in a unit; in base units where pint does not know its name."""
    registry: Any = pint.get_application_registry()  # type: ignore[no-untyped-call]
    for currency in CURRENCIES:
        if currency not in registry:
            registry.define(f"{currency} = [currency_{currency}]")
    try:
        return registry.Quantity(from_si(si, unit), registry.parse_units(unit))
    except (pint.UndefinedUnitError, pint.DefinitionSyntaxError, ValueError):
        return registry.Quantity(si, str(pint_quantity(1.0, unit).units))
