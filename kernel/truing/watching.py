"""Files that are watched while somebody edits them, and the code of a plugin that is to be read afresh."""

from __future__ import annotations

import ast
import importlib
import os
import sys
import sysconfig
import time
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from watchfiles import watch

from truing.errors import InputError
from truing.inputs_file.files import digest_of
from truing.inputs_file.workbook import read_book
from truing.kernel import Offer
from truing.workbooks.reading import is_workbook

PATIENCE = 1.0
"""How long a file may be away or empty, in seconds: editors put a new one in its place, or empty it before writing."""
LONGEST_GROUP = 1600
"""So many milliseconds of changes without a pause are told at once."""


@dataclass
class WatchedFiles:
    """A set of files and what was in them; a file counts as changed when its content is another.

    ``still`` is for how long, in seconds, all must have been still before a change counts.
    """

    still: float
    _contents: dict[Path, str] = field(default_factory=dict, init=False)
    _folders: dict[Path, int] = field(default_factory=dict, init=False)
    _events: Iterator[Any] = field(default_factory=lambda: iter(()), init=False)

    def add(self, files: Iterable[Path]) -> None:
        """Watch these files besides, from what is in them now."""
        for path in (Path(file).absolute() for file in files):
            if path not in self._contents:
                self._contents[path] = content_of(path)

    def changed(self) -> list[Path]:
        """Wait until a file has another content and all have been still; return which, in order.

        What changed before this is called counts too. Raises KeyboardInterrupt.
        """
        self._listen()
        is_settled, whole_at = False, time.monotonic()
        while True:
            if not next(self._events) and is_settled:
                continue
            now = {path: content_of(path) for path in self._contents}
            changed = [path for path, content in now.items() if content != self._contents[path]]
            is_whole = all(now[path] for path in changed)
            whole_at = time.monotonic() if is_whole else whole_at
            if changed and (is_whole or time.monotonic() - whole_at >= PATIENCE):
                self._contents = now
                return changed
            is_settled = is_whole and not self._listen()

    def _listen(self) -> bool:
        """Listen to the folders of all files, or the nearest above; tell whether they are others than before."""
        places = {watched for path in self._contents for watched in (path, path.resolve())}  # what a link leads to, too
        near = {next(folder for folder in watched.parents if folder.is_dir()) for watched in places}
        folders = {folder: folder.stat().st_ino for folder in near}
        if folders == self._folders:
            return False
        step = max(1, round(self.still * 1000))
        how: dict[str, Any] = {"debounce": max(step, LONGEST_GROUP), "step": step, "rust_timeout": step}
        self._folders = folders
        self._events = watch(*folders, watch_filter=None, recursive=False, yield_on_timeout=True, **how)
        return True


def content_of(path: Path) -> str:
    """Return the SHA-256 of a file; nothing where it is empty, or cannot be read."""
    try:
        return digest_of(path) if path.is_file() and path.stat().st_size else ""
    except OSError:
        return ""


def files_named_in(inputs: Path, offer: Offer) -> Iterator[Path]:
    """Yield the data files, the files of sources and the logo that an inputs file names, as far as it can be read."""
    try:
        is_book = is_workbook(inputs)
        document = read_book(inputs, offer).data if is_book else tomllib.loads(inputs.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, InputError):
        return
    stated = document.get("inputs")
    head = document.get("sheet")
    names = [head.get("logo")] if isinstance(head, Mapping) else []
    sources = document.get("from")
    told = sources.values() if isinstance(sources, Mapping) else ()
    names += [said.get("inputs_file") for said in told if isinstance(said, Mapping)]
    for name, input_field in offer.model.input_fields.items():
        if input_field.kind == "file" and isinstance(stated, Mapping):
            value: Any = stated.get(name)
            names.append(value.get("file") if isinstance(value, Mapping) else value)
    yield from (inputs.parent / name for name in names if isinstance(name, str) and name and "\0" not in name)


def code_files(offer: Offer) -> set[Path]:
    """Return the files whose code decides a calculation and may be edited: the plugin's own, and what these import.

    Also those of guests that add effects to it. Left out is what nobody edits: the kernel, Python, what is installed.
    """
    model = offer.model
    functions = [model.function, *(effect.function for effect in model.effects.values())]
    files = set(_own_files(Path(offer.origin.file)))
    files |= {path for function in functions if (path := _file_of(sys.modules.get(function.__module__))) is not None}
    new = list(files)
    while new:
        for path in _imported_by(new.pop()):
            if path not in files and not str(path).startswith(_homes()):
                files.add(path)
                new.append(path)
    return files


def _imported_by(file: Path) -> Iterator[Path]:
    """Yield the files of loaded modules that a file of code imports, and those of the packages around them."""
    names = [name for name, module in list(sys.modules.items()) if _file_of(module) == file]
    try:
        tree = ast.parse(file.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return
    package = getattr(sys.modules[names[0]], "__package__", "") if names else ""
    for name in {name for node in ast.walk(tree) for name in _names_in(node, package or "")}:
        parts = name.split(".")
        for length in range(1, len(parts) + 1):
            path = _file_of(sys.modules.get(".".join(parts[:length])))
            if path is not None and path.suffix == ".py":
                yield path


def _names_in(node: ast.AST, package: str) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        outer = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
        base = ".".join([*outer, *([node.module] if node.module else [])])
        yield from (base, *(f"{base}.{alias.name}" for alias in node.names))


def _own_files(file: Path) -> Iterable[Path]:
    path = file.resolve()
    return path.parent.rglob("*.py") if path.name == "__init__.py" else [path]


def _file_of(module: Any) -> Path | None:
    name = getattr(module, "__file__", None)
    return _resolved(name) if isinstance(name, str) else None


@cache
def _resolved(name: str) -> Path:
    return Path(name).resolve()


@lru_cache(maxsize=1)
def _homes() -> tuple[str, ...]:
    paths = sysconfig.get_paths()
    homes = {Path(paths[name]).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib", "scripts")}
    return tuple(f"{home}{os.sep}" for home in (Path(__file__).resolve().parent, *homes))


def forget(files: set[Path]) -> None:
    """Take modules of these files out of memory, so that the next import reads them afresh."""
    for name, module in list(sys.modules.items()):
        if name != "__main__" and _file_of(module) in files:
            del sys.modules[name]
    importlib.invalidate_caches()
