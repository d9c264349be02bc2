"""The form of a model's inputs file: what it asks, and what it says to the values that are stated."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from truing.describe import description
from truing.errors import InputError, TruingError
from truing.inputs_file import setup_from_text
from truing.inputs_file.document import read_document
from truing.workbench.tasks.loaded import loaded


def described(plugin: str) -> dict[str, Any]:
    """Return what the model declares, as for ``calc describe --json``."""
    return description(loaded(plugin))


def state(plugin: str, file: str, folder: str, text: str) -> dict[str, Any]:
    """Return the stated values by path, and the faults of the text."""
    document = read_document(text, file)
    stated = {f"inputs.{name}": value for name, value in document.data.get("inputs", {}).items()}
    answer: dict[str, Any] = {"stated": stated, "faults": []}
    try:
        setup_from_text(text, loaded(plugin), file=file, folder=Path(folder))
    except InputError as error:
        answer["faults"] = [asdict(fault) for fault in error.faults]
    except TruingError as error:
        answer["faults"] = [{"message": str(error), "file": "", "line": None, "cell": ""}]
    return answer
