"""What every study works with and answers with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Any, Protocol

from truing.declare.blocks import Block
from truing.setup import Setup

Progress = Callable[[str, int, int], None]


def silent(task: str, done: int, total: int) -> None:
    """Report no progress."""


@dataclass(frozen=True)
class Check:
    """A limit and how far it is kept: margin > 0 is safe, everywhere. Values are in ``unit``.

    ``note`` says what is compared, where the name of a result does not say it; ``method`` how a probability was found.
    """

    name: str
    value: float
    limit: float
    unit: str
    margin: float
    passed: bool
    note: str = ""
    method: str = ""


@dataclass(frozen=True)
class Bench:
    """The workbench of a study: the checked setup, the calculation's own results, and what was answered before.

    ``answers`` holds results in SI by flat name (the function's, then those earlier studies gave); ``outcomes`` the
    outcomes of earlier studies by name. ``progress(task, done, total)`` may be called as often as one likes.
    """

    setup: Setup
    results: Any
    executor: Executor
    answers: Mapping[str, Any] = field(default_factory=dict)
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    progress: Progress = silent

    @property
    def inputs(self) -> Any:
        """The inputs as the effects that are on leave them: what the calculation itself is called with."""
        from truing.evaluate import acting_inputs

        return acting_inputs(self.setup)


class Outcome(Protocol):
    """What a study found; the sheet and results.json ask it for their part."""

    def as_json(self) -> Mapping[str, Any]:
        """Return what results.json holds under ``studies.NAME``: plain numbers, texts, lists; no NaN."""

    def blocks(self) -> Sequence[Block]:
        """Return what the sheet shows: words, tables, drawings."""

    def checks(self) -> Sequence[Check]:
        """Return the limits this study decides."""

    def warnings(self) -> Sequence[str]:
        """Return what the user must know: failed rows, a search without end, a method beside its range."""
