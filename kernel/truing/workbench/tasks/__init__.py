"""What worker processes of the workbench do: plain functions from texts and names to data that JSON can hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from truing.heavy import Later

MODULES = ("diagnoses", "drafts", "figures", "form", "kept", "models", "records", "runs")
"""The modules whose public functions the server may call by the name ``module.function``, and no others."""


HOME = "truing.workbench.tasks"


def task(name: str, home: str = HOME) -> Callable[..., Any]:
    """Return the function of a task; ``home`` is the package of its module. Raises KeyError for a name that is none."""
    module, _, function = name.partition(".")
    if module not in Later(home).MODULES or function.startswith("_"):
        raise KeyError(name)
    known: Callable[..., Any] = getattr(Later(f"{home}.{module}"), function)
    return known
