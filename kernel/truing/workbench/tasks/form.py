"""The form of a model's inputs file: what it asks, and what it says to the values that are stated."""

from __future__ import annotations

from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from truing.describe import description
from truing.errors import InputError, TruingError
from truing.evaluate import answered
from truing.inputs_file import setup_from_text
from truing.inputs_file.document import read_document
from truing.kernel import Offer, offer_of
from truing.numbers import format_value, with_unit
from truing.setup import Setup


@lru_cache(maxsize=8)
def _offer(plugin: str) -> Offer:
    return offer_of(plugin, lambda text: None)


def described(plugin: str) -> dict[str, Any]:
    """Return what the model declares, as for ``calc describe --json``."""
    return description(_offer(plugin))


def state(plugin: str, file: str, folder: str, text: str) -> dict[str, Any]:
    """Return the stated values by path, the faults of the text, and the nominal results."""
    document = read_document(text, file)
    stated = {f"inputs.{name}": value for name, value in document.data.get("inputs", {}).items()}
    answer: dict[str, Any] = {"stated": stated, "faults": [], "results": []}
    try:
        answer["results"] = _results(setup_from_text(text, _offer(plugin), file=file, folder=Path(folder)))
    except InputError as error:
        answer["faults"] = [asdict(fault) for fault in error.faults]
    except TruingError as error:
        answer["faults"] = [{"message": str(error), "file": "", "line": None, "cell": ""}]
    return answer


def _results(setup: Setup) -> list[dict[str, str]]:
    answers: dict[str, Any] = setup.model.read_results(answered(setup).results)
    rows = []
    for name, result in setup.model.result_fields.items():
        value = answers.get(name)
        if value is None or np.ndim(value):
            continue
        number, printed = format_value(value, setup.print_unit(name))
        rows.append({"name": name, "note": result.spec.note, "value": with_unit(number, printed)})
    return rows
