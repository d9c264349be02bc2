"""What every study works with and answers with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, is_dataclass, replace
from typing import Any, Protocol, TypeVar

from truing.declare.blocks import Block
from truing.evaluate import acting_inputs, answered, evaluate_rows
from truing.prices import price_answers
from truing.setup import Setup
from truing.studies.checks import Check, Proposal
from truing.studies.sampling import scatter_of, with_tolerances

Progress = Callable[[str, int, int], None]


StepProgress = Callable[[int, int], None]
FINE = 1000
"""How many steps a task has of which only parts can be counted."""


def silent(task: str, done: int, total: int) -> None:
    """Report no progress."""


def unheard(step: int, steps: int) -> None:
    """Report no steps."""


def part_of(progress: Progress, task: str, begin: float, end: float) -> StepProgress:
    """Return what reports the steps of one part of a task, which runs from one share of the whole to another."""

    def done(step: int, steps: int) -> None:
        share = begin + (end - begin) * (step / steps if steps > 0 else 0.0)
        progress(task, round(FINE * share), FINE)

    return done


def within(progress: Progress, task: str, begin: float, end: float, stages: Sequence[str]) -> Progress:
    """Return what reports a whole calculation as one part of a task; ``stages`` are its studies in order.

    It never goes back: a study that begins anew is heard of again where it passes the place that it had reached.
    """
    reached = begin

    def told(stage: str, step: int, steps: int) -> None:
        nonlocal reached
        if stage not in stages or steps <= 0:
            return
        each = (end - begin) / len(stages)
        reached = max(reached, begin + each * (list(stages).index(stage) + min(step / steps, 1.0)))
        progress(task, round(FINE * reached), FINE)

    return told


@dataclass(frozen=True)
class Bench:
    """The workbench of a study: the checked setup, the calculation's own results, and what was answered before.

    ``answers`` holds results in SI by flat name (the function's, then those earlier studies gave); ``outcomes`` the
    outcomes of earlier studies by name. ``progress(task, done, total)`` may be called as often as one likes. ``absent``
    says why results of the function do not exist; they are NaN among the answers.
    """

    setup: Setup
    results: Any
    executor: Executor
    answers: Mapping[str, Any] = field(default_factory=dict)
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    progress: Progress = silent
    absent: Mapping[str, str] = field(default_factory=dict)

    @property
    def inputs(self) -> Any:
        """The inputs as the effects that are on leave them: what the calculation itself is called with."""
        return acting_inputs(self.setup)

    def part(self, task: str, begin: float, end: float) -> StepProgress:
        """Return what reports the steps of one part of a task, from one share (0 to 1) of the whole to another."""
        return part_of(self.progress, task, begin, end)

    def changed(self, values: Mapping[str, Any], widths: Mapping[str, float] | None = None) -> Bench:
        """Return the workbench of another design: inputs, conditions and full widths of tolerances by name, SI.

        Results and price are those of the new design; nobody hears of its progress. Raises InfeasibleError.
        """
        setup = with_tolerances(self.setup.changed(values), widths or {})
        first = answered(setup)
        answers = {**setup.model.read_results(first.results), **price_answers(setup)}
        return replace(self, setup=setup, results=first.results, answers=answers, absent=first.absent, progress=silent)

    def drawn(self, rows: int) -> Mapping[str, Any]:
        """Return what scatters in so many machines, (rows,) by column in SI: the first that ``Reliability`` draws."""
        return scatter_of(self.setup).draw(self.setup.seed, 0, rows)

    def rows(self, columns: Mapping[str, Any], rows: int, *results: str) -> Mapping[str, Any]:
        """Return these results (rows,) of so many calculations in SI; NaN where one has no answer."""
        return evaluate_rows(self.setup, columns, rows, wanted=results).results


def files_of(outcome: Outcome) -> Mapping[str, str | bytes]:
    """Return the files that an outcome leaves in the run folder, by name; nothing where it has none."""
    files: Mapping[str, str | bytes] = getattr(outcome, "files", {})
    return files


def proposals_of(outcome: Outcome) -> Sequence[Proposal]:
    """Return the designs that an outcome proposes instead of the stated one; none where it has no such method."""
    proposals: Callable[[], Sequence[Proposal]] | None = getattr(outcome, "proposals", None)
    return proposals() if proposals is not None else ()


OutcomeT = TypeVar("OutcomeT", bound="Outcome")


def printed_in(outcome: OutcomeT, unit_of: Callable[[str, str], str]) -> OutcomeT:
    """Return an outcome that is printed in other units: ``unit_of(name, unit)`` tells which. Its numbers stay in SI.

    It has a method ``printed_in(unit_of)``, or is a dataclass with ``units``, those by name in which it is printed. Any
    other outcome stays as it is, and its blocks are brought over one by one.
    """
    own: Callable[[Callable[[str, str], str]], OutcomeT] | None = getattr(outcome, "printed_in", None)
    if own is not None:
        return own(unit_of)
    units = getattr(outcome, "units", None)
    if not is_dataclass(outcome) or isinstance(outcome, type) or not isinstance(units, Mapping):
        return outcome
    return replace(outcome, units={name: unit_of(name, unit) for name, unit in units.items()})


class Outcome(Protocol):
    """What a study found; the sheet and results.json ask it for their part.

    A class that names this one as its base says only what it has to say: it shows, decides and warns of nothing else.

    One that has ``files``, a mapping from file names to text or bytes, leaves these in the run folder. One with a
    method ``proposals()`` proposes designs of which each keeps limits that the stated one may miss. One that holds its
    numbers in SI and has ``units``, those in which it prints them by name, follows the units of the sheet; ``as_json``
    is asked before.
    """

    def as_json(self) -> Mapping[str, Any]:
        """Return what results.json holds under ``studies.NAME``: plain numbers, texts, lists; no NaN."""

    def blocks(self) -> Sequence[Block]:
        """Return what the sheet shows: words, tables, drawings."""
        return ()

    def checks(self) -> Sequence[Check]:
        """Return the limits this study decides, for the design as stated."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return what the user must know: failed rows, a search without end, a method beside its range."""
        return ()
