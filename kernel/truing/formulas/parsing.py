"""Reading a formula: Python's own grammar behind a strict list of what may stand in it."""

from __future__ import annotations

import ast
import difflib
import math
import re
import warnings
from functools import lru_cache
from typing import Final, NoReturn

from truing.errors import DeclarationError
from truing.formulas.tree import (
    ANY_NUMBER,
    ARGUMENTS,
    CONSTANTS,
    SIGNS,
    Formula,
    Node,
    expressions_in,
    one_spaced,
    walk,
)

LONGEST: Final = 2000
DEEPEST: Final = 50

WORDS: Final[dict[type[ast.AST], str]] = {
    ast.Attribute: "a dot between names",
    ast.Subscript: "an index in brackets",
    ast.Lambda: "a lambda",
    ast.IfExp: "if ... else (write cases(value, condition, otherwise))",
    ast.List: "a list",
    ast.Tuple: "a comma outside a function",
    ast.Dict: "a dictionary",
    ast.Set: "a set",
    ast.NamedExpr: "an assignment",
    ast.Starred: "a star before an argument",
    ast.Compare: "a comparison outside the conditions of cases (an equation has one == at the top)",
    ast.BoolOp: "and/or outside the conditions of cases",
}
FORBIDDEN: Final = re.compile(r"""["'\\#;`$?]|[^\S ]|[\x00-\x1f]""")
PLAIN_NUMBER: Final = re.compile(r"\d+(\.\d+)?([eE][+-]?\d+)?", re.ASCII)


class _RefusalError(Exception):
    """What is not allowed; the sentence around it is made where the text is known."""


@lru_cache(maxsize=4096)
def parse(text: str) -> Formula:
    """Read a formula such as ``load / area``, or an equation ``inv(x) == y``.

    Raises:
        DeclarationError: the text holds anything but names, finite numbers, ``+ - * / **``, known functions,
            and comparisons inside ``cases``; or it is longer than 2000 characters or deeper than 50 levels.
    """
    if not isinstance(text, str):
        raise DeclarationError(f"a formula is a text, not {type(text).__name__}: {text!r:.80}")
    try:
        return _read(text)
    except _RefusalError as refusal:
        shown = text if len(text) <= 200 else text[:200] + " ..."
        raise DeclarationError(f"formula {shown!r}: {refusal}") from None


def _read(text: str) -> Formula:
    right: Node = _expression(text)
    left: Node | None = None
    if isinstance(right, ast.Compare) and [type(sign) for sign in right.ops] == [ast.Eq]:
        left, right = right.left, right.comparators[0]
    sides = (right,) if left is None else (left, right)
    for side in sides:
        _check(side)
    names = {node.id for side in sides for node in walk(side) if isinstance(node, ast.Name)}
    return Formula(text=text, left=left, right=right, names=frozenset(names - CONSTANTS.keys()))


def _expression(text: str) -> ast.expr:
    if len(text) > LONGEST:
        raise _RefusalError(
            f"it has {len(text)} characters, at most {LONGEST} are allowed; split it into named results"
        )
    stripped = one_spaced(text)
    if not stripped:
        raise _RefusalError("it is empty; leave the formula out where there is none")
    if forbidden := FORBIDDEN.search(stripped):
        raise _RefusalError(f"the character {forbidden.group()!r} is not allowed")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            body = ast.parse(stripped, mode="eval").body
    except SyntaxError as error:
        place = f" (near character {error.offset})" if error.offset else ""
        raise _RefusalError(f"it cannot be read: {error.msg}{place}") from None
    except (ValueError, RecursionError, MemoryError, OverflowError):
        raise _RefusalError("it cannot be read: nested too deeply, or a number too long") from None
    encoded = stripped.encode()
    for node in ast.walk(body):
        if isinstance(node, ast.Constant):  # its text as written stands in ``kind``, which Python uses for strings only
            node.kind = encoded[node.col_offset : node.end_col_offset].decode().replace("_", "")
    if _levels(body) > DEEPEST:
        raise _RefusalError(f"it is nested deeper than {DEEPEST} levels; split it into named results")
    return body


def _levels(body: ast.AST) -> int:
    """Count levels without recursion: the tree may be deeper than Python's stack."""
    level, layer = 0, [body]
    while layer and level <= DEEPEST:
        level += 1
        layer = [child for node in layer for child in expressions_in(node)]
    return level


def _check(node: Node) -> None:
    """Refuse what may not stand in a formula."""
    match node:
        case ast.Constant():
            _check_number(node)
        case ast.Name():
            pass
        case ast.UnaryOp(ast.USub(), operand):
            _check(operand)
        case ast.BinOp(left, sign, right) if type(sign) in SIGNS:
            _check(left)
            _check(right)
        case ast.Call():
            _check_call(node)
        case _:
            _refuse(node)


def _check_number(node: ast.Constant) -> None:
    value = node.value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _RefusalError(f"{value!r} is not a real number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise _RefusalError("a number in it is not finite (larger than about 1.8e308)")
    node.value, node.kind = number, node.kind if node.kind and PLAIN_NUMBER.fullmatch(node.kind) else repr(value)


def _check_call(node: ast.Call) -> None:
    if not isinstance(node.func, ast.Name):
        _refuse(node.func)
    function = node.func.id
    if function not in ARGUMENTS:
        near = difflib.get_close_matches(function, ARGUMENTS, n=1)
        hint = f"did you mean {near[0]}?" if near else f"the functions are {', '.join(sorted(ARGUMENTS))}"
        raise _RefusalError(f"there is no function {function!r}; {hint}")
    if node.keywords:
        raise _RefusalError(f"{function} is called with a keyword; arguments go by their place")
    count = len(node.args)
    fewest, most = ARGUMENTS[function]
    if function == "cases" and (count < fewest or count % 2 == 0):
        raise _RefusalError(
            "cases takes value, condition, value, condition, ..., otherwise (an odd number, at least three)"
        )
    if not fewest <= count <= most:
        wanted = str(fewest) if fewest == most else f"at least {fewest}" if most == ANY_NUMBER else f"{fewest}..{most}"
        raise _RefusalError(f"{function} takes {wanted} argument{'' if wanted == '1' else 's'}, here it has {count}")
    checks = [_check, _check_condition if function == "cases" else _check]
    for index, argument in enumerate(node.args):
        checks[index % 2](argument)


def _check_condition(node: Node) -> None:
    match node:
        case ast.Compare(first, signs, others):
            if not SIGNS.keys() >= {type(sign) for sign in signs}:
                raise _RefusalError("a condition compares with <, <=, >, >=, == or !=, nothing else")
            for operand in (first, *others):
                _check(operand)
        case ast.BoolOp(_, conditions):
            for condition in conditions:
                _check_condition(condition)
        case _:
            raise _RefusalError(f"'{ast.unparse(node)}' stands where cases needs a condition, such as x > 1")


def _refuse(node: ast.expr) -> NoReturn:
    what = WORDS.get(type(node))
    if what is None and isinstance(node, ast.BinOp | ast.UnaryOp):
        what = "an operator other than + - * / ** and the minus sign"
    shown = ast.unparse(node)
    raise _RefusalError(f"{what or 'this'} is not allowed: '{shown if len(shown) <= 60 else shown[:60] + ' ...'}'")
