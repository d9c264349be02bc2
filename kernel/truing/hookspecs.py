"""The four places where a plugin may speak. Lists come back; the kernel sorts them by plugin name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pluggy

from truing.declare.goals import Objective
from truing.declare.model import Model, Section
from truing.declare.sources import ErrorSource

hookspec = pluggy.HookspecMarker("truing")
hookimpl = pluggy.HookimplMarker("truing")
"""The two decorators of pluggy, bound to this project's name."""


@hookspec
def truing_models() -> Sequence[Model[Any, Any]]:
    """Offer calculations. Called once, before any input file is read.

    A name used twice is refused and names both owners; everything else works.
    """
    return []


@hookspec
def truing_error_sources(model: Model[Any, Any]) -> Sequence[ErrorSource[Any, Any]]:
    """Say what could make *model* disagree with a measurement: a tolerance, a correlation or a missing effect.

    An effect gets the model's own inputs and results and returns them changed (``replace``).
    One that names an unknown input is left out with a warning.
    """
    return []


@hookspec
def truing_objectives(model: Model[Any, Any]) -> Sequence[Objective]:
    """Add variables, goals and limits to *model*, each naming one of its inputs or results."""
    return []


@hookspec
def truing_reports(model: Model[Any, Any]) -> Sequence[Section]:
    """Add sections to the sheet of *model*, after its own."""
    return []
