"""Programs that make the records of examples: loaded, and what they write held against what is shipped."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path
from types import ModuleType


def module_of(program: Path) -> ModuleType:
    """Load the program of an example under a name of its own."""
    name = f"{program.parent.name}_{program.stem}"
    spec = importlib.util.spec_from_file_location(name, program)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def differing(shipped: Path, write: Callable[[str], None], folder: Path) -> list[str]:
    """Return the lines, of those that a program writes into a folder now, that the shipped record has not there."""
    with chdir(folder):
        write(shipped.name)
    written = (folder / shipped.name).read_text(encoding="utf-8").splitlines()
    assert len(written) > 1
    return [
        line
        for line, other in zip(written, shipped.read_text(encoding="utf-8").splitlines(), strict=False)
        if line != other
    ]
