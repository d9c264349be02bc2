"""Files of the folder that is served, and no others: links are followed, and what lies outside is refused."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from truing.errors import UsageError

DEEPEST = 6
MOST_FILES = 5000
INPUTS, DATA = (".toml",), (".csv", ".tsv", ".txt", ".xlsx", ".tdms", ".mf4", ".mdf", ".mat", ".parquet")
LEFT_OUT = {"__pycache__", "node_modules", "site-packages"}


def inside(root: Path, name: str) -> Path:
    """Return a file or folder by its name below the root. Raises UsageError where it lies outside, or has no name."""
    if not name or "\0" in name or len(name) > 1000:
        raise UsageError("the name of a file is empty or no name")
    path = (root / name).resolve()
    if not path.is_relative_to(root):
        raise UsageError(f"'{name[:80]}' lies outside the folder that is served")
    return path


def below(root: Path, path: Path) -> str:
    """Return the name of a file below the root, with / between folders."""
    return path.relative_to(root).as_posix()


def files_below(root: Path, endings: tuple[str, ...]) -> Iterator[Path]:
    """Yield the files with one of these endings, not in hidden folders and not in folders that links lead to."""
    count = 0
    for folder, folders, files in os.walk(root):
        depth = len(Path(folder).relative_to(root).parts)
        folders[:] = [
            name for name in sorted(folders)
            if depth < DEEPEST and not name.startswith(".") and name not in LEFT_OUT and not name.endswith(".partial")
        ]  # fmt: skip
        for name in sorted(files):
            count += 1
            if count > MOST_FILES:
                return
            if name.lower().endswith(endings) and not name.startswith("."):
                yield Path(folder) / name
