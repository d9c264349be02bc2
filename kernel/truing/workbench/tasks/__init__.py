"""What worker processes of the workbench do: plain functions from texts and names to data that JSON can hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from truing.heavy import Later

MODULES = ("diagnoses", "drafts", "figures", "form", "models", "records", "results", "runs")
"""The modules whose public functions the server may call by the name ``module.function``, and no others."""


def task(name: str) -> Callable[..., Any]:
    """Return the function of a task. Raises KeyError for a name that is none."""
    module, _, function = name.partition(".")
    if module not in MODULES or function.startswith("_"):
        raise KeyError(name)
    known: Callable[..., Any] = getattr(Later(f"truing.workbench.tasks.{module}"), function)
    return known
