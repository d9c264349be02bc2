"""Where in a plugin's code an exception came from: the file and line its author has to look at."""

from __future__ import annotations

import ast
import inspect
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

SourceLine = tuple[str, int | None]
_HOUSE = Path(__file__).parents[1]
_MACHINERY = {"pluggy", "importlib", "importlib_metadata", "matplotlib", "numpy", "scipy"}


def place_of(error: BaseException, homes: Iterable[Path] = ()) -> SourceLine:
    """Return file and line of the innermost frame inside ``homes``, else of the innermost that is not machinery.

    A syntax error names its own place. Returns ("", None) where no frame belongs to anybody.
    """
    if isinstance(error, SyntaxError) and error.filename:
        return error.filename, error.lineno
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if not _is_machinery(frame.filename)]
    own = [frame for frame in frames if any(_inside(frame.filename, home) for home in homes)]
    chosen = own or frames
    return (chosen[-1].filename, chosen[-1].lineno) if chosen else ("", None)


def spoken_place(error: BaseException) -> str:
    """Return "file:line: " of the frame that is neither ours nor a library's, or nothing where there is none."""
    file, line = place_of(error)
    return f"{file}:{line}: " if file else ""


def home_of(function: Callable[..., Any]) -> Path | None:
    """Return the folder of the package a function is written in, or its file where it is a single one."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    if code is None:
        return None
    file = Path(code.co_filename)
    return file.parent if (file.parent / "__init__.py").is_file() else file


def line_of(function: Callable[..., Any]) -> SourceLine:
    """Return file and line where a function is written."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    return (code.co_filename, code.co_firstlineno) if code is not None else ("", None)


def line_of_words(homes: Iterable[Path], owner: str, written: Any) -> SourceLine:
    """Return file and line where *owner* is declared with the text or number *written*; ("", None) where nowhere is.

    The innermost call or field that names both decides.
    """
    best: tuple[int, str, int] | None = None
    for file in (file for home in homes for file in (sorted(home.rglob("*.py")) if home.is_dir() else [home])):
        try:
            tree = ast.parse(file.read_text(encoding="utf-8"))
        except (OSError, SyntaxError, ValueError):
            continue
        for node in ast.walk(tree):
            if isinstance(node, (ast.Call, ast.AnnAssign)) and (lines := _lines_of(node, owner, written)):
                size = (node.end_lineno or node.lineno) - node.lineno
                best = min(best, (size, str(file), lines[0])) if best else (size, str(file), lines[0])
    return (best[1], best[2]) if best else ("", None)


def _lines_of(node: ast.AST, owner: str, written: Any) -> list[int]:
    """Return the lines in a call or a field where *written* stands, if it names *owner* too."""
    inner = list(ast.walk(node))
    constants = [part for part in inner if isinstance(part, ast.Constant)]
    names = {constant.value for constant in constants if isinstance(constant.value, str)}
    names |= {part.id for part in inner if isinstance(part, ast.Name)}
    names |= {part.arg for part in inner if isinstance(part, ast.keyword) and part.arg}
    return [constant.lineno for constant in constants if _is_part(constant.value, written)] if owner in names else []


def _is_part(value: Any, written: Any) -> bool:
    """Tell whether a constant is what was written, or the quantity in it: "3 mm" in "sd 3 mm"."""
    if isinstance(value, str) and isinstance(written, str) and any(sign.isdigit() for sign in value):
        return value in written
    return type(value) is type(written) and bool(value == written)


def _inside(filename: str, home: Path) -> bool:
    return Path(filename) == home or home in Path(filename).parents


def _is_machinery(filename: str) -> bool:
    path = Path(filename)
    return filename.startswith("<") or _HOUSE in path.parents or bool(_MACHINERY & set(path.parts))
