"""The complete inputs file of a run: what was read, with every default filled in, so that it can be run again."""

from __future__ import annotations

import hashlib
import json
import math
import os
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from truing.declare.chain import link_of
from truing.declare.fields import InputField
from truing.declare.model import Study
from truing.declare.spreads import ByChoice, Drawn
from truing.formulas.symbols import printable
from truing.inputs_file.assemble import toml_key, toml_value
from truing.inputs_file.study_options import options_of
from truing.setup import NamedColumn, Setup, SwitchedOn
from truing.templating import ENGLISH
from truing.units import difference_unit, from_si, read_quantity, to_si, unit_factor
from truing.units.names import PURE

WIDTH = 116


def input_hash(setup: Setup) -> str:
    """Return the SHA-256 of everything in the inputs that decides the results; names on the sheet do not."""
    said = {name: content for name, content in _sections(setup, None) if name != "sheet"}
    text = json.dumps([setup.model.name, said, dict(setup.source.files)], sort_keys=True, ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def stated_differences(before: Setup, after: Setup) -> list[tuple[str, str, str]]:
    """Return what decides the results and differs between two setups of a model: its name, before and after as TOML.

    Empty where both have the same ``input_hash``, but for the content of data files.
    """
    said = [dict(_entries(setup)) for setup in (before, after)]
    names = [name for name in dict.fromkeys([*said[0], *said[1]]) if said[0].get(name) != said[1].get(name)]
    return [(name, said[0].get(name, ""), said[1].get(name, "")) for name in names]


def _entries(setup: Setup) -> Iterator[tuple[str, str]]:
    """Yield what stands in the sections that decide the results; an input by its name alone."""
    for section, content in _sections(setup, None):
        if section != "sheet":
            for name, value in content.items():
                label = name if section == "inputs" else f"{section}.{name}"
                yield label, value if isinstance(value, str) else toml_value(value)


def complete_inputs(setup: Setup, folder: Path | None = None) -> str:
    """Write an inputs file that gives this run again: what was read, with every default filled in.

    Data files are named relative to ``folder``, where the text will stand. A tolerance that follows a choice is left to
    follow it, as a comment; so is an input that is not given.
    """
    lines = [f"plugin = {toml_value(setup.model.name)}"]
    remarks = dict(_remarks(setup))
    for name, content in _sections(setup, folder):
        if content:
            lines += ["", f"[{'.'.join(toml_key(part) for part in name.split('.', 1))}]"]
        for key, value in content.items():
            remark = remarks.get((name, key), "")
            lines.append(f"{toml_key(key)} = {toml_value(value)}{'  # ' + remark if remark else ''}")
        lines += [f"# {text}" for text in _left_open(setup, name)]
    return "\n".join(lines) + "\n"


def comment_lines(sentence: str) -> list[str]:
    """Write a sentence as comments, in an inputs file or in code."""
    return [f"# {line}" for line in textwrap.wrap(printable(sentence), WIDTH)]


def _sheet(setup: Setup, folder: Path | None) -> dict[str, str]:
    """Return the section of the sheet: its title block, and of its options those that are not the usual ones."""
    sheet = setup.sheet
    options = {"detail": "normal", "units": "", "language": ENGLISH, "paper": "A4"}
    head = {name: str(text) for name, text in sheet.head.items()}
    for name in ("logo", "style"):
        if folder is not None and head.get(name):
            head[name] = _seen_from(folder, Path(setup.source.file).parent / head[name])
    chosen = {name: str(getattr(sheet, name)) for name in options}
    return {**head, **{name: word for name, word in chosen.items() if word != options[name]}}


def _sections(setup: Setup, folder: Path | None) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield every section of the inputs file with its entries as plain TOML values."""
    yield "sheet", _sheet(setup, folder)
    inputs = setup.model.read_inputs(setup.inputs)
    fields = setup.model.input_fields
    stated = {name: _input(setup, fields[name], value, folder) for name, value in inputs.items()}
    yield "inputs", {name: value for name, value in stated.items() if value is not None}
    yield (
        "tolerances",
        {
            name: spread.text
            for name, spread in setup.spreads.items()
            if name in setup.model.tolerances
            and spread.text
            and not isinstance(spread, (ByChoice, Drawn))
            and not all(
                _taken(setup, each) and math.isnan(setup.nominal(each)) for each in setup.model.tolerances[name].on
            )
        },
    )
    yield "correlations", {pair.name: pair.coefficient for pair in setup.scattering_together()}
    yield (
        "conditions",
        {name: _as_stated(value, _units(setup, name, folder)) for name, value in setup.conditions.items()},
    )
    yield "calibrated", {name: exact(value, setup.unit_of(name)) for name, value in setup.calibrated.items()}
    for active in setup.effects:
        yield f"effects.{active.effect.name}", _effect(active)
    declared = {study.name: study for study in setup.model.studies}
    known = [study for study in setup.studies if folder is None or _is_declared(study, setup)]
    yield "studies", {"run": [study.name for study in known], "seed": setup.seed}
    for study in known:
        yield f"studies.{study.name}", _options(study, declared.get(study.name))
    if diagnose := _of_diagnosis(setup):
        yield "studies.diagnose", diagnose
    yield "units", dict(setup.units)
    if setup.columns:
        yield "columns", {key: _column(column) for key, column in setup.columns.items()}


def _column(column: NamedColumn) -> str | dict[str, str]:
    return column.name if column.unit is None else {"name": column.name, "unit": column.unit}


def _is_declared(study: Study, setup: Setup) -> bool:
    """Tell whether an inputs file may name a study: the model has one of its name and kind."""
    return any(each.name == study.name and type(each) is type(study) for each in setup.model.studies)


def _of_diagnosis(setup: Setup) -> dict[str, Any]:
    """Return what is asked of a diagnosis, without what is as by default."""
    options, fields = setup.diagnose, setup.model.own_result_fields
    box = {name: "..".join(str(exact(end, setup.unit_of(name))) for end in ends) for name, ends in options.box.items()}
    clipped = {
        name: "..".join(
            "" if math.isinf(end) else str(exact(end, setup.model.own_result_fields[name].unit)) for end in ends
        )
        for name, ends in options.clipped.items()
    }
    said = {
        "causes": list(options.causes), "per_file": list(options.per_file), "hold_out": options.hold_out, "box": box,
        "at_least": dict(options.at_least), "at_most": dict(options.at_most), "clipped": clipped,
        "lognormal": list(options.lognormal), "budget": options.budget,
        "noise": {name: str(exact(sd, difference_unit(fields[name].unit))) for name, sd in options.noise.items()},
    }  # fmt: skip
    return {name: value for name, value in said.items() if value}


def exact(value: Any, unit: str) -> Any:
    """Write an SI number in its declared unit so that reading it gives the same number again."""
    if unit in PURE:
        return _plain(value)
    number = float(from_si(float(value), unit))
    for digits in (12, 15, 17):
        text = f"{number:.{digits}g}"
        if to_si(float(text), unit) == value:
            return f"{text} {unit}"
    for step in range(1, 9):
        for towards in (-math.inf, math.inf):
            near = number
            for _ in range(step):
                near = math.nextafter(near, towards)
            if read_quantity(f"{near!r} {unit}", unit) == value:
                return f"{near!r} {unit}"
    return f"{number!r} {unit}"


def _plain(value: Any) -> Any:
    """Return a plain Python value; whole floats are written as such."""
    plain = value.item() if hasattr(value, "item") else value
    return int(plain) if isinstance(plain, float) and plain.is_integer() and abs(plain) < 1e15 else plain


def _input(setup: Setup, field: InputField, value: Any, folder: Path | None) -> Any:
    """Return one input as TOML has it, or None where it is not given."""
    if field.kind == "file":
        return _file(setup, field.name, folder)
    if field.kind in {"switch", "text", "integer"}:
        return value
    if field.kind == "choice":
        return str(value)
    if field.kind == "series":
        if getattr(field.spec, "unit", None) is None:
            return [_plain(one) for one in value]
        return [_as_stated(float(one), _units(setup, field.name, folder)) for one in value] or None
    return _taken(setup, field.name) if value != value else _as_stated(value, _units(setup, field.name, folder))


def _taken(setup: Setup, name: str) -> dict[str, str] | None:
    """Return what an input that is not given is taken from, or None."""
    link = link_of(setup.model, name)
    if link is None:
        return None
    own_name = {"plugin": link.model} if link.model else {}
    return {"from": link.source, **own_name, "result": link.result}


def _units(setup: Setup, name: str, folder: Path | None) -> list[str]:
    """Return the declared unit and the one in which a value is stated; for the hash the declared one alone."""
    return [setup.unit_of(name), *([setup.stated_unit(name)] if folder is not None else [])]


def _as_stated(value: float, units: Sequence[str]) -> Any:
    """Write a number in the last of these units in which it reads back as the same number, else in the first."""
    texts = [exact(value, unit) for unit in reversed(units)]
    exactly = (text for text in texts if not isinstance(text, str) or read_quantity(text, units[0]) == value)
    return next(exactly, texts[-1])


def _file(setup: Setup, name: str, folder: Path | None) -> Any:
    """Return what the inputs file says of a data file, with its path as seen from ``folder``; without one, its hash."""
    table = dict(setup.source.tables.get(name, {}))
    if not table:
        return None
    return {
        **table,
        "file": setup.source.files.get(name, "") if folder is None else _seen_from(folder, Path(table["file"])),
    }


def _seen_from(folder: Path, path: Path) -> str:
    """Return the path of a file as seen from a folder, with slashes; from another drive, the whole of it."""
    try:
        relative = os.path.relpath(path, folder)
    except ValueError:
        relative = str(path.resolve())
    return relative.replace("\\", "/") if os.name == "nt" else relative


def _effect(active: SwitchedOn) -> dict[str, Any]:
    said: dict[str, Any] = {}
    for unknown in active.unknowns:
        value = exact(active.values[unknown.name], unknown.unit)
        sd = active.sds.get(unknown.name)
        scale = difference_unit(unknown.unit)
        said[unknown.name] = value if sd is None else {"value": value, "sd": exact(sd, scale)}
    if active.covariance:
        factors = [unit_factor(unknown.unit) for unknown in active.unknowns]
        said["covariance"] = [
            [one / factors[i] / factors[j] for j, one in enumerate(row)] for i, row in enumerate(active.covariance)
        ]
    return said


def _options(study: Study, declared: Study | None) -> dict[str, Any]:
    """Return the options of a study that are not as its plugin declares them."""
    said = {}
    for name in options_of(study):
        value = getattr(study, name)
        if declared is None or value != getattr(declared, name, None):
            said[name] = list(value) if isinstance(value, tuple) else value
    return {name: value for name, value in said.items() if isinstance(value, (bool, int, float, str, list, dict))}


def _remarks(setup: Setup) -> Iterator[tuple[tuple[str, str], str]]:
    for name, field in setup.model.input_fields.items():
        words = [printable(field.spec.note), "" if name in setup.source.stated else "default"]
        yield ("inputs", name), ", ".join(word for word in words if word)
    for name, tolerance in setup.model.tolerances.items():
        yield ("tolerances", name), printable(tolerance.why)
    for pair in setup.correlations:
        yield ("correlations", pair.name), printable(pair.why)


def _left_open(setup: Setup, section: str) -> Iterator[str]:
    """Say what stands in no entry, and why."""
    if section == "inputs":
        for name, value in setup.model.read_inputs(setup.inputs).items():
            if isinstance(value, float) and value != value and _taken(setup, name) is None:
                yield f"{name} is not given"
    if section == "tolerances":
        for name, spread in setup.spreads.items():
            if isinstance(spread, ByChoice):
                yield f"{name} follows {spread.chooser}: {setup.settled(spread).text}"
            elif isinstance(spread, Drawn):
                yield f"{name} is {spread.text}"
    for study in setup.studies:
        if section == "studies" and not _is_declared(study, setup):
            said = ", ".join(f"{name} = {toml_value(value)}" for name, value in _options(study, None).items() if value)
            yield f"asked besides, and not declared by the model: {study.name}, {said}"
