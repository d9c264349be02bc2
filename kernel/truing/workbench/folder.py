"""What lies in the folder that is served, in one walk: inputs files, programs, data files, runs and diagnoses."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from truing.entry_points import plugin_names
from truing.workbench.places import DATA, INPUTS, below, files_below

DOCUMENTS = ("results.json", "diagnosis.json")
"""What makes a folder a run or a diagnosis; as in ``truing.runs.folder``, which needs numpy."""
LARGEST_INPUTS = 2_000_000
"""Bytes; a larger file is no inputs file."""
MARK = b"truing_models"
"""What stands in every Python file that offers a calculation."""
BEGINNING = 200_000
"""Bytes of a Python file in which its mark is looked for."""
MOST_DOTS = 1000
_PLUGIN = re.compile(r"^[ \t]*plugin[ \t]*=[ \t]*[\"']?([\w.]*)", re.MULTILINE)
_NUMBER = re.compile(r"[-_ ]\d+$")


@dataclass(frozen=True)
class InputsFile:
    """An inputs file: its name below the root, the calculation that it names, and what is wrong with it as TOML."""

    name: str
    plugin: str
    fault: str = ""


@dataclass(frozen=True)
class Contents:
    """The names of what lies in a folder, below it, with / between folders."""

    inputs: tuple[InputsFile, ...]
    programs: tuple[str, ...]
    data: tuple[str, ...]
    runs: tuple[str, ...]
    """Folders that hold the document of a run or of a diagnosis."""


def contents(root: Path) -> Contents:
    """Look through a folder; what lies in the folder of a run or a diagnosis belongs to that."""
    paths = list(files_below(root, (*INPUTS, ".py", *DATA, *DOCUMENTS)))
    runs = {path.parent for path in paths if path.name in DOCUMENTS and path.parent != root}
    own = [path for path in paths if runs.isdisjoint(path.parents)]
    inputs = [_inputs_file(root, path) for path in own if path.suffix.lower() in INPUTS]
    return Contents(
        inputs=tuple(each for each in inputs if each is not None),
        programs=tuple(below(root, path) for path in own if path.suffix == ".py" and _offers(path)),
        data=tuple(below(root, path) for path in own if path.suffix.lower() in DATA),
        runs=tuple(sorted(below(root, path) for path in runs)),
    )


def _inputs_file(root: Path, path: Path) -> InputsFile | None:
    """Return what an inputs file says of itself; None for TOML that is something else, such as that of a project."""
    name = below(root, path)
    try:
        if path.stat().st_size > LARGEST_INPUTS:
            return None
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
    if max(line.count(".") for line in text.split("\n")) > MOST_DOTS:  # a name of so many parts takes long to read
        return InputsFile(name, named_in(text), f"has a line with more than {MOST_DOTS} dots")
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        named = named_in(text)
        return InputsFile(name, named, f"is no TOML: {error}") if named or "[inputs]" in text else None
    plugin = document.get("plugin")
    if isinstance(plugin, str) and plugin:
        return InputsFile(name, plugin)
    if isinstance(document.get("inputs"), dict):
        return InputsFile(name, "", 'names no calculation; write plugin = "NAME" above its sections')
    return None


def named_in(text: str) -> str:
    """Return the calculation that an inputs file names before its first section, or nothing.

    Only that line is read: a text that is no TOML, or takes long to read as such, names one all the same.
    """
    named = _PLUGIN.search(text.partition("\n[")[0])
    return named[1] if named else ""


def _offers(path: Path) -> bool:
    """Tell whether a Python file may offer a calculation; it is read and not run."""
    try:
        with path.open("rb") as stream:
            return MARK in stream.read(BEGINNING)
    except OSError:
        return False


def program_of(named: str, inputs: str, programs: tuple[str, ...]) -> str:
    """Return the Python file that offers the calculation of an inputs file, or nothing where it is installed.

    It is called like the calculation and lies beside the inputs file, or else anywhere in the folder.
    """
    if named.partition(".")[0] in plugin_names():
        return ""
    called = [name for name in programs if PurePosixPath(name).stem == named]
    beside = [name for name in called if PurePosixPath(name).parent == PurePosixPath(inputs).parent]
    return next(iter([*beside, *called]), "")


def place_of_run(folder: str) -> tuple[str, str]:
    """Return where a run lies, and its name without the number that tells it from others of the same file."""
    path = PurePosixPath(folder)
    return path.parent.as_posix(), _NUMBER.sub("", path.name)
