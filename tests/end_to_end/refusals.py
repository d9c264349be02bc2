"""What a refusal on the command line must be: sentences on stderr and nothing else, with every file as it was."""

from __future__ import annotations

from pathlib import Path

from shared import Answer


def listing(folder: Path) -> list[tuple[str, int]]:
    """Return everything below a folder, with its size; but for what Python keeps of a module that it has read."""
    files = (path for path in folder.rglob("*") if "__pycache__" not in path.parts)
    return sorted((str(path.relative_to(folder)), path.lstat().st_size) for path in files)


def sentences(answer: Answer) -> list[str]:
    """Return what was said of a refusal, line by line."""
    assert answer.code == 2, answer
    assert answer.out == ""
    assert "Traceback" not in answer.err
    lines = answer.err.rstrip("\n").split("\n")
    assert all(line.strip() for line in lines)
    return lines
