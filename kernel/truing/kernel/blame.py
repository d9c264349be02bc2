"""Where in a plugin's code an exception came from: the file and line its author has to look at."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

Place = tuple[str, int | None]
_HOUSE = Path(__file__).parents[1]
_MACHINERY = {"pluggy", "importlib", "importlib_metadata", "matplotlib", "numpy", "scipy"}


def place_of(error: BaseException, homes: Iterable[Path] = ()) -> Place:
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


def line_of(function: Callable[..., Any]) -> Place:
    """Return file and line where a function is written."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    return (code.co_filename, code.co_firstlineno) if code is not None else ("", None)


def _inside(filename: str, home: Path) -> bool:
    return Path(filename) == home or home in Path(filename).parents


def _is_machinery(filename: str) -> bool:
    path = Path(filename)
    return filename.startswith("<") or _HOUSE in path.parents or bool(_MACHINERY & set(path.parts))
