"""The source of a plugin as a hash: whether two processes, or two runs, compute with the same code."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path


def code_hash(place: str) -> str:
    """Return the SHA-256 of the source of a package or file, line ends aside; empty where there is none."""
    files = sorted(_files_of(place))
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + b"\0" + file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return digest.hexdigest()[:16] if files else ""


def _files_of(place: str) -> Iterable[Path]:
    path = Path(place)
    if path.suffix == ".py":
        return [path] if path.is_file() else []
    try:
        spec = find_spec(place)
    except (ImportError, ValueError):
        return []
    if spec is None or not spec.origin:
        return []
    file = Path(spec.origin)
    return file.parent.rglob("*.py") if file.name == "__init__.py" else [file]
