"""new_effect.py: a remainder that nothing registered explains, as the source of an Effect, ready to be made physical.

Names and shapes come from files of data. What is written as code is therefore taken apart first: an expression may hold
numbers, the covariates, arithmetic and a few functions of numpy, nothing else; every other text is a quoted string or a
comment on one line.
"""

from __future__ import annotations

import ast
import keyword
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from truing.declare.sources import Condition
from truing.diagnosis.result import DiagnosisResult, ShapeTerm
from truing.formulas.symbols import printable
from truing.runs.diagnosis_document import file_labels

NAME = "remainder"
FACTOR = 5.0
"""How many times the fitted shape may be, up and down."""
FUNCTIONS = frozenset({
    "abs", "arctan", "clip", "cos", "cosh", "exp", "expm1", "floor", "heaviside", "log", "log1p", "maximum", "minimum",
    "power", "sign", "sin", "sinh", "sqrt", "square", "tan", "tanh", "where",
})  # fmt: skip
CONSTANTS = frozenset({"pi", "e"})
TAKEN = frozenset({"np", "inputs", "results", "factor", "truing", "model", "replace", "Any", "Float", NAME})
ADVICE = (
    "#",
    "# DO NOT EXTRAPOLATE: this is a curve through the measured rows, no physics. Beyond their range it is wrong.",
    "#",
    "# To make it physical: ask what in the machine follows these covariates, write that as the function, give the",
    "# unknowns units and bounds (0 inside makes one an amplitude), and diagnose again. If the gauge errs and not the",
    "# machine, say on_reading instead of on_results; if an input is what moves, write on_inputs(inputs, ...).",
    "# To install it beside the model, put this file into a project of its own with these lines in pyproject.toml:",
    '#     [project.entry-points."truing.plugins"]',
    '#     my_new_effect = "new_effect"',
)
_NODES = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Call, ast.Attribute, ast.Name, ast.Constant, ast.Load,
    ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.Mod, ast.FloorDiv, ast.USub, ast.UAdd, ast.BitAnd, ast.BitOr,
    ast.Invert, ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq,
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
    if diagnosis.remainder is None:
        return ""
    sources = tuple(_sources(diagnosis))
    parts = ["\n\n".join(filter(None, [_head(diagnosis), _conditions(sources)]))]
    parts += [_shape(result, terms, sources) for result, terms in _terms(diagnosis).items()]
    parts += [_effect_function(diagnosis, sources), _declaration(diagnosis, sources), _hook(diagnosis)]
    return "\n\n\n".join(parts) + "\n"


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
    named = [name for name in rest if any(_names(name, text) for text in texts)]
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


def _names(name: str, text: str) -> bool:
    """Tell whether an expression names a covariate."""
    return re.search(rf"(?<![\w.]){re.escape(name)}(?!\w)", text) is not None


def code_name(name: str, taken: set[str] | frozenset[str] = TAKEN) -> str:
    """Return a name that can stand in code: the name itself if it can, otherwise the like of it, not taken yet."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_").lower() if not _is_plain(name) else name
    plain = plain if plain and not plain[0].isdigit() else f"column_{plain}".rstrip("_")
    if keyword.iskeyword(plain) or plain in taken or plain.startswith("__"):
        plain = f"column_{plain.strip('_')}"
    place, wanted = 2, plain
    while plain in taken:
        plain, place = f"{wanted}_{place}", place + 1
    return plain


def _is_plain(name: str) -> bool:
    return name.isidentifier() and name.isascii() and not keyword.iskeyword(name)


def safe_expression(text: str, names: Mapping[str, str]) -> str | None:
    """Return an expression over covariates as code, or None where it is anything but arithmetic on them.

    ``names`` holds the name in code of each covariate; one that cannot stand in code is replaced by it first.
    """
    for name in sorted(names, key=len, reverse=True):
        if name != names[name]:
            text = re.sub(rf"(?<![\w.]){re.escape(name)}(?!\w)", names[name], text)
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    called = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    allowed = set(names.values())
    return ast.unparse(tree) if all(_is_harmless(node, allowed, called) for node in ast.walk(tree)) else None


def _is_harmless(node: ast.AST, names: set[str], called: Sequence[ast.expr]) -> bool:
    if not isinstance(node, _NODES):
        return False
    if isinstance(node, ast.Constant):
        return isinstance(node.value, (int, float)) and not isinstance(node.value, bool)
    if isinstance(node, ast.Name):
        return node.id in names or node.id == "np"
    if isinstance(node, ast.Attribute):
        is_numpy = isinstance(node.value, ast.Name) and node.value.id == "np"
        return is_numpy and node.attr in (FUNCTIONS if node in called else CONSTANTS)
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Attribute) and not node.keywords
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        exponent = node.right.operand if isinstance(node.right, ast.UnaryOp) else node.right
        power = exponent.value if isinstance(exponent, ast.Constant) else None
        return isinstance(power, (int, float)) and abs(power) <= 64
    return True


def _quoted(text: str) -> str:
    """Write a text as a string of code, in ASCII."""
    inner = ascii(printable(text))[1:-1].replace("\\'", "'").replace('"', '\\"')
    return f'"{inner}"'


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(printable(text), 116)]


def _head(diagnosis: DiagnosisResult) -> str:
    remainder = diagnosis.remainder
    assert remainder is not None
    model = diagnosis.setup.model
    files = ", ".join(file_labels(diagnosis.records.files))
    lines = ['"""A remainder that no registered effect explains, as a diagnosis fitted it. Make it physical."""', ""]
    lines += _comment(f"From {files}, {len(diagnosis.records)} rows, model {model.name}.")
    lines += _comment(
        f"Shape: {remainder.shape}; over {', '.join(remainder.depends_on)}; seen in {', '.join(remainder.results)}."
    )
    lines += [
        *ADVICE,
        "",
        "from dataclasses import replace",
        "from typing import Any",
        "",
        "import numpy as np",
        "",
        f"from truing import {', '.join(_imports(diagnosis))}",
    ]
    return "\n".join(lines)


def _imports(diagnosis: DiagnosisResult) -> list[str]:
    needed = {"Effect", "Float", "Model", "Unknown", "hookimpl"}
    if any(source.condition is not None for source in _sources(diagnosis)):
        needed.add("Condition")
    if any(_is_curve(diagnosis, result) for result in _terms(diagnosis)):
        needed.add("column")
    return sorted(needed, key=lambda name: (name.islower(), name))


def _is_curve(diagnosis: DiagnosisResult, result: str) -> bool:
    """Tell whether a result runs along an axis, so that one row holds many values."""
    return bool(diagnosis.setup.model.own_result_fields[result].along)


def _conditions(sources: Sequence[_Source]) -> str:
    lines = []
    for source in sources:
        if source.condition is None:
            continue
        if source.condition.name != source.name:
            lines += _comment(f"The column {source.name!r} of the data must be called {source.code} to be read here.")
        lines.append(f"{source.code.upper()} = {_condition(source.condition)}")
    return "\n".join(lines)


def _condition(condition: Condition) -> str:
    more = [f"reference={condition.reference!r}"] if condition.reference else []
    for key in ("note", "derived"):
        more += [f"{key}={_quoted(getattr(condition, key))}"] if getattr(condition, key) else []
    for key in ("low", "high"):
        more += [f"{key}={getattr(condition, key)!r}"] if getattr(condition, key) is not None else []
    return f"Condition({', '.join([_quoted(condition.name), _quoted(condition.unit), *more])})"


def _shape(result: str, terms: Sequence[ShapeTerm], sources: Sequence[_Source]) -> str:
    """Write the fitted shape of one result as a function of its covariates, all SI."""
    names = {source.name: source.code for source in sources}
    arguments = ", ".join(f"{source.code}: Float" for source in sources)
    lines = [f"def shape_of_{code_name(result)}({arguments}) -> Float:"]
    lines.append('    """Return what the model misses, as it was fitted; SI in and out."""')
    lines.append("    shape: Float = (")
    left_out = []
    written = 0
    for term in terms:
        expression = safe_expression(term.expression, names)
        coefficient = float(term.coefficient)
        if expression is None or coefficient != coefficient or abs(coefficient) == float("inf"):
            left_out.append(term.expression)
            continue
        lines.append(f"        {'+ ' if written else ''}({coefficient!r}) * ({expression})")
        written += 1
    if not written:
        lines.append("        0.0")
    lines += ["    )", "    return shape"]
    for text in left_out:
        lines += [
            "    " + line for line in _comment(f"A term is left out, it is no arithmetic on covariates: {text!r}")
        ]
    return "\n".join(lines)


def _effect_function(diagnosis: DiagnosisResult, sources: Sequence[_Source]) -> str:
    """Write the function of the effect: it adds every shape to its result."""
    conditions = "".join(f", {source.code}: Float" for source in sources if source.condition is not None)
    lines = [f"def {NAME}(inputs: Any, results: Any, *, factor: Float{conditions}) -> Any:"]
    lines.append('    """Add the fitted shape, so many times, to what the model says."""')
    for result in _terms(diagnosis):
        item = diagnosis.setup.model.own_result_fields[result]
        arguments = ", ".join(_argument(diagnosis, result, source) for source in sources)
        lines.append(f"    missing = factor * shape_of_{code_name(result)}({arguments})")
        lines.append(f"    results = {_replaced(item.path)}")
    return "\n".join([*lines, "    return results"])


def _argument(diagnosis: DiagnosisResult, result: str, source: _Source) -> str:
    """Write one value handed to a shape; beside a result along an axis a value per row is a column."""
    value = source.path or source.code
    if _is_curve(diagnosis, result) and not value.startswith("results."):
        return f"column({value})"
    return value


def _replaced(path: Sequence[str]) -> str:
    """Write the results with ``missing`` added at one place, however deep it lies."""
    inner = f"{'.'.join(('results', *path))} + missing"
    for depth in range(len(path) - 1, -1, -1):
        inner = f"replace({'.'.join(('results', *path[:depth]))}, {path[depth]}={inner})"
    return inner


def _declaration(diagnosis: DiagnosisResult, sources: Sequence[_Source]) -> str:
    remainder = diagnosis.remainder
    assert remainder is not None
    needs = ", ".join(source.code.upper() for source in sources if source.condition is not None)
    lines = [
        f"{NAME.upper()}: Effect[Any, Any] = Effect(",
        f"    {_quoted(NAME)},",
        f"    on_results={NAME},",
        f'    unknowns=[Unknown("factor", {-FACTOR}, {FACTOR}, "", note="1 is the shape as it was fitted")],',
        *([f"    needs=[{needs}],"] if needs else []),
        f"    looks_like={_quoted(remainder.shape)},",
        ")",
    ]
    return "\n".join(lines)


def _hook(diagnosis: DiagnosisResult) -> str:
    name = _quoted(diagnosis.setup.model.name)
    return "\n".join([
        "@hookimpl",
        "def truing_error_sources(model: Model[Any, Any]) -> list[Effect[Any, Any]]:",
        '    """Offer the remainder to the model it was found in."""',
        f"    return [{NAME.upper()}] if model.name == {name} else []",
    ])  # fmt: skip
