"""Runs: made from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from truing.api.model import LoadedModel
from truing.kernel import offer_of
from truing.studies.bench import Progress


def run(plugin: str, file: str, output: str, root: str, progress: Progress) -> dict[str, Any]:
    """Run a file with its studies and write its folder; return where it is and its verdict."""
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    model = LoadedModel(offer_of(plugin, lambda text: None))
    made = model.run(Path(file), output=Path(output), progress=progress)
    name = Path(output).relative_to(root).as_posix()
    return {"folder": name, "verdict": made.verdict, "sheet": f"{name}/sheet.html"}
