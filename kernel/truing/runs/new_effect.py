"""new_effect.py: a remainder that nothing registered explains, as the source of an Effect, ready to be made physical.

Names and shapes come from files of data. What is written as code is therefore taken apart first: an expression may hold
numbers, the covariates, arithmetic and a few functions of numpy, nothing else; every other text is a quoted string or a
comment on one line.
"""

from __future__ import annotations

import ast
import json
import keyword
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from math import isfinite
from typing import Any

from truing.declare.sources import Condition
from truing.diagnosis.records import file_labels
from truing.diagnosis.result import DiagnosisResult, Remainder, ShapeTerm
from truing.formulas.symbols import printable
from truing.runs.inputs_written import comment_lines
from truing.templating import rendered

NAME = "remainder"
OF_NUMPY = frozenset({
    "abs", "arctan", "clip", "cos", "cosh", "e", "exp", "expm1", "floor", "heaviside", "log", "log1p", "maximum",
    "minimum", "pi", "power", "sign", "sin", "sinh", "sqrt", "square", "tan", "tanh", "where",
})  # fmt: skip
TAKEN = frozenset({"np", "inputs", "results", "factor", "truing", "model", "replace", "Any", "Float", NAME})
ARITHMETIC = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.operator, ast.unaryop, ast.cmpop, ast.Load,
)  # fmt: skip


@dataclass(frozen=True)
class _Source:
    """A covariate of the shape: its name in the data, its name in the code, and where its values come from there."""

    name: str
    code: str
    path: str = ""
    condition: Condition | None = None


def new_effect_source(diagnosis: DiagnosisResult) -> str:
    """Write the file; nothing where there is no remainder.

    Applied with ``factor`` 1 the effect adds the fitted shape to the results it was fitted on.
    """
    remainder = diagnosis.remainder
    if remainder is None:
        return ""
    sources = tuple(_sources(diagnosis))
    made = [source.code for source in sources if source.condition is not None]
    return rendered("single/new_effect.py.j2", {
        "about": _about(diagnosis, remainder),
        "imports": ", ".join(_imports(diagnosis)),
        "conditions": _conditions(sources),
        "covariates": ", ".join(f"{source.code}: Float" for source in sources),
        "shapes": [_shape(diagnosis, result, terms, sources) for result, terms in _terms(diagnosis).items()],
        "measured": "".join(f", {code}: Float" for code in made),
        "needs": ", ".join(code.upper() for code in made),
        "looks_like": _quoted(remainder.shape),
        "model": _quoted(diagnosis.setup.model.name),
    })  # fmt: skip


def _terms(diagnosis: DiagnosisResult) -> Mapping[str, Sequence[ShapeTerm]]:
    """Return the terms of every result of the remainder that the model has."""
    assert diagnosis.remainder is not None
    return {
        name: terms
        for name, terms in diagnosis.remainder.terms.items()
        if name in diagnosis.setup.model.own_result_fields
    }


def _sources(diagnosis: DiagnosisResult) -> Iterator[_Source]:
    """Find where each covariate of the shape comes from: an input, an axis of the results, or a condition."""
    assert diagnosis.remainder is not None
    model = diagnosis.setup.model
    taken = set(TAKEN)
    texts = [term.expression for terms in _terms(diagnosis).values() for term in terms]
    rest = sorted({*diagnosis.records.covariates, *model.input_fields, *model.conditions})
    named = [name for name in rest if any(_named(name).search(text) for text in texts)]
    for name in dict.fromkeys([*diagnosis.remainder.depends_on, *named]):
        code = code_name(name, taken)
        taken.add(code)
        if name in model.input_fields:
            yield _Source(name, code, path="inputs." + ".".join(model.input_fields[name].path))
        elif name in model.own_result_fields:
            yield _Source(name, code, path="results." + ".".join(model.own_result_fields[name].path))
        else:
            covariate = diagnosis.records.covariates.get(name)
            unit = covariate.unit if covariate is not None else ""
            yield _Source(name, code, condition=model.conditions.get(name) or Condition(code, unit))


def _named(name: str) -> re.Pattern[str]:
    """Return the pattern of a covariate in an expression."""
    return re.compile(rf"(?<![\w.]){re.escape(name)}(?!\w)")


def code_name(name: str, taken: set[str] | frozenset[str] = TAKEN) -> str:
    """Return a name that can stand in code: the name itself if it can, otherwise the like of it, not taken yet."""
    is_plain = name.isidentifier() and name.isascii() and not keyword.iskeyword(name)
    plain = name if is_plain else re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_").lower()
    plain = plain if plain and not plain[0].isdigit() else f"column_{plain}".rstrip("_")
    if keyword.iskeyword(plain) or plain in taken or plain.startswith("__"):
        plain = f"column_{plain.strip('_')}"
    number, wanted = 2, plain
    while plain in taken:
        plain, number = f"{wanted}_{number}", number + 1
    return plain


def safe_expression(text: str, names: Mapping[str, str]) -> str | None:
    """Return an expression over covariates as code, or None where it is anything but arithmetic on them.

    ``names`` holds the name in code of each covariate; one that cannot stand in code is replaced by it first.
    """
    for name in sorted(names, key=len, reverse=True):
        if name != names[name]:
            text = _named(name).sub(names[name], text)
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    return ast.unparse(tree) if all(_is_harmless(node, set(names.values())) for node in ast.walk(tree)) else None


def _is_harmless(node: ast.AST, names: set[str]) -> bool:
    match node:
        case ast.Constant(value=number):
            return type(number) in {int, float}
        case ast.Name(id=name):
            return name in names or name == "np"
        case ast.Attribute(value=ast.Name(id="np"), attr=name):
            return name in OF_NUMPY
        case ast.Call(func=ast.Attribute(), keywords=[]):
            return True
    return isinstance(node, ARITHMETIC)


def _about(diagnosis: DiagnosisResult, remainder: Remainder) -> list[str]:
    """Say where the shape comes from, as comments."""
    files = ", ".join(file_labels(diagnosis.records.files))
    over, seen_in = ", ".join(remainder.depends_on), ", ".join(remainder.results)
    return [
        *comment_lines(f"From {files}, {len(diagnosis.records)} rows, model {diagnosis.setup.model.name}."),
        *comment_lines(f"Shape: {remainder.shape}; over {over}; seen in {seen_in}."),
    ]


def _imports(diagnosis: DiagnosisResult) -> list[str]:
    needed = {"Effect", "Float", "Model", "Unknown", "hookimpl"}
    if any(source.condition is not None for source in _sources(diagnosis)):
        needed.add("Condition")
    if any(diagnosis.setup.model.own_result_fields[result].along for result in _terms(diagnosis)):
        needed.add("column")
    return sorted(needed, key=lambda name: (name.islower(), name))


def _conditions(sources: Sequence[_Source]) -> list[str]:
    """Declare the conditions that the shape needs."""
    lines = []
    for source in sources:
        if source.condition is None:
            continue
        if source.condition.name != source.name:
            lines += comment_lines(
                f"The column {source.name!r} of the data must be called {source.code} to be read here."
            )
        lines.append(f"{source.code.upper()} = {_condition(source.condition)}")
    return lines


def _condition(condition: Condition) -> str:
    stated = {field.name: getattr(condition, field.name) for field in fields(condition)}
    other = {field.name: stated[field.name] for field in fields(condition) if stated[field.name] != field.default}
    said = [f"{name}={_quoted(value) if isinstance(value, str) else repr(value)}" for name, value in other.items()]
    return f"Condition({', '.join(said)})"


def _quoted(text: str) -> str:
    """Write a text as a string of code, in ASCII: JSON's strings are Python's."""
    return json.dumps(printable(text))


def _shape(
    diagnosis: DiagnosisResult, result: str, terms: Sequence[ShapeTerm], sources: Sequence[_Source]
) -> dict[str, Any]:
    """Say the fitted shape of one result as code: a function of its covariates, all SI, and how it is added."""
    names = {source.name: source.code for source in sources}
    field = diagnosis.setup.model.own_result_fields[result]
    arguments = [source.path or source.code for source in sources]
    if field.along:  # beside a result along an axis a value per row is a column
        arguments = [each if each.startswith("results.") else f"column({each})" for each in arguments]
    written, left_out = [], []
    for term in terms:
        expression = safe_expression(term.expression, names)
        coefficient = float(term.coefficient)
        if expression is None or not isfinite(coefficient):
            left_out += comment_lines(f"A term is left out, it is no arithmetic on covariates: {term.expression!r}")
        else:
            written.append(f"({coefficient!r}) * ({expression})")
    return {
        "code": code_name(result),
        "terms": written,
        "left_out": left_out,
        "arguments": ", ".join(arguments),
        "replaced": _replaced(field.path),
    }


def _replaced(path: Sequence[str]) -> str:
    """Write the results with ``missing`` added at one place, however deep it lies."""
    inner = f"{'.'.join(('results', *path))} + missing"
    for depth in range(len(path) - 1, -1, -1):
        inner = f"replace({'.'.join(('results', *path[:depth]))}, {path[depth]}={inner})"
    return inner
