"""Files of the folder that is served, and no others: links are followed, and what lies outside is refused."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from truing.atomic import recover
from truing.errors import UsageError
from truing.texts import one_line

DEEPEST = 6
MOST_FILES = 5000
LONGEST_NAME, LONGEST_PATH = 240, 1000
"""Bytes of a name and of all names of a path: file systems take 255 and more, and writing adds to a name."""
INPUTS, DATA = (".toml",), (".csv", ".tsv", ".txt", ".xlsx", ".tdms", ".mf4", ".mdf", ".mat", ".parquet")
LEFT_OUT = {"__pycache__", "node_modules", "site-packages"}
_PART = re.compile(r"\.(.+)\.[a-z0-9_]{8}\.(?:part|old)")
"""What is written beside its place; see ``atomic``."""
_NO_NAME = re.compile(r'[\x00-\x1f\x7f<>:"|?*\\]|[ .]$')
_DEVICE = re.compile(r"(?:con|prn|aux|nul|clock\$|conin\$|conout\$|com[0-9¹²³]|lpt[0-9¹²³]) *(?:\..*)?", re.IGNORECASE)


def inside(root: Path, name: str) -> Path:
    """Return a file or folder by its name below the root, which has none itself.

    A name is refused that means anything else on some system (a drive, a device, a stream), on every system: a folder
    is moved from one to another. Hidden files are not shown and not written. Raises UsageError, also where the file
    lies outside, as behind a link.
    """
    if reason := _refusal(name):
        raise UsageError(f"'{one_line(name[:80])}' {reason}")
    try:
        path = (root / name).resolve()
    except (OSError, RuntimeError, ValueError) as error:  # a circle of links, up to Python 3.12 a RuntimeError
        raise UsageError(f"'{one_line(name[:80])}' cannot be opened: {one_line(error)}") from None
    if not path.is_relative_to(root):
        raise UsageError(f"'{one_line(name[:80])}' lies outside the folder that is served")
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise UsageError(
            f"'{one_line(name[:80])}' is no file but a device, or a pipe that would keep its reader waiting"
        )
    if reason := _refusal(below(root, path)):
        raise UsageError(f"'{one_line(name[:80])}' leads to a file that {reason}")
    return path


def _refusal(name: str) -> str:
    """Return why a path below the root is none, or nothing."""
    try:
        size = len(os.fsencode(name))
    except UnicodeEncodeError:
        return "is no text"
    parts = name.split("/")
    if not name or size > LONGEST_PATH or any(len(os.fsencode(part)) > LONGEST_NAME for part in parts):
        return "is too long for a file's name" if name else "is empty; name a file of the folder"
    if name.startswith("/") or ".." in parts:
        return "lies outside the folder that is served"
    if any(not part or _NO_NAME.search(part) or _DEVICE.fullmatch(part) for part in parts):
        return "is no name of a file on every system; use letters, digits, - and _"
    return "is hidden" if any(part.startswith(".") for part in parts) else ""


def below(root: Path, path: Path) -> str:
    """Return the name of a file below the root, with / between folders."""
    return path.relative_to(root).as_posix()


def files_below(root: Path, endings: tuple[str, ...]) -> Iterator[Path]:
    """Yield the files with one of these endings that ``inside`` gives, not in folders that links lead to.

    What is no file, such as a pipe that would keep its reader waiting, is left out.
    """
    count = 0
    for folder, folders, files in os.walk(root):
        depth = len(Path(folder).relative_to(root).parts)
        folders[:] = [
            name for name in sorted(folders)
            if depth < DEEPEST and name not in LEFT_OUT and not _refusal(name) and not name.endswith(".partial")
        ]  # fmt: skip
        for name in sorted(files):
            count += 1
            if count > MOST_FILES:
                return
            path = Path(folder) / name
            if name.lower().endswith(endings) and not _refusal(name) and _is_own_file(root, path):
                yield path


def _is_own_file(root: Path, path: Path) -> bool:
    try:
        return stat.S_ISREG(path.stat().st_mode) and inside(root, below(root, path)) is not None
    except (OSError, UsageError):
        return False


def tidy(root: Path) -> None:
    """Take away what processes that were killed have left half-written, or bring back what they had put aside."""
    for count, (folder, folders, files) in enumerate(os.walk(root)):
        for name in (*folders, *files):
            if match := _PART.fullmatch(name):
                with suppress(OSError):
                    recover(Path(folder) / match[1])
        is_far = count > MOST_FILES or len(Path(folder).relative_to(root).parts) >= DEEPEST
        folders[:] = [] if is_far else [name for name in folders if not name.startswith(".")]
