"""Many cases of one calculation: every row of a file is one, and the worst of them governs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from typing import Any

from truing.calculation import Calculation, calculate
from truing.declare.model import Study
from truing.errors import Fault, InputError, UsageError
from truing.evaluate import evaluate_rows
from truing.executors import in_order, keepable, open_executor
from truing.measurements import CasesFile, RowCount, StatedCase
from truing.packed import Packed, pack, travels, unpack
from truing.prices import price_answers
from truing.setup import Setup
from truing.studies.allocation import Allocation
from truing.studies.bench import FINE, Progress, silent, within
from truing.studies.checks import Check, State, requirements
from truing.studies.optimise import Optimise
from truing.studies.reliability import Reliability
from truing.studies.sensitivity import Sensitivity
from truing.studies.surrogate import Surrogate
from truing.studies.sweep import Sweep
from truing.studies.uncertainty import Uncertainty
from truing.studies.verdicts import Decided, decide, worst

BLOCK = 2**10
"""How many cases one array call calculates."""
UNDECIDED = Decided(())
"""What is decided of a case that cannot be calculated."""
DECIDE_NOTHING = (Optimise, Sensitivity, Surrogate, Sweep, Uncertainty)
DECIDE_CHANCES = (Allocation, Reliability)
"""Studies that decide no other limits than those on a chance."""


@keepable
@dataclass(frozen=True)
class CaseResult:
    """One case, what it answers in SI and its checks, or why it failed; ``absent``: why a result does not exist."""

    case: StatedCase
    answers: Mapping[str, Any]
    decided: Decided = UNDECIDED
    reason: str | None = None
    absent: Mapping[str, str] = field(default_factory=dict)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Its limits, each with its state."""
        return self.decided.checks

    @property
    def verdict(self) -> State:
        """The worst state of its checks; a case that cannot be calculated fails."""
        return self.decided.verdict if self.reason is None else "fails"

    @property
    def row(self) -> int:
        """Its row in the file; the first is 1."""
        return self.case.row

    @property
    def name(self) -> str:
        """What the file calls it."""
        return self.case.name

    @property
    def values(self) -> Mapping[str, Any]:
        """The inputs and conditions that any case changes, with its own values in SI."""
        return self.case.values

    @property
    def margin(self) -> float:
        """The smallest margin of its checks that are decided; infinite where there are none."""
        return min((check.margin for check in self.checks if not check.undecided), default=float("inf"))

    @property
    def fault(self) -> Fault:
        """Why it failed, with file and line."""
        return Fault(self.reason or "", self.case.file, self.case.line)


keepable(StatedCase)


@dataclass(frozen=True)
class CasesTable:
    """All cases in the order of the file; ``governing`` is the place of the one with the smallest margin.

    ``read`` says how many rows the file holds, with those that are no cases, ``notes`` what was done to its columns.
    """

    cases: tuple[CaseResult, ...]
    governing: int
    read: RowCount
    notes: tuple[str, ...] = ()

    @property
    def count(self) -> RowCount:
        """The rows of the file: those of cases that cannot be calculated are left out, with the reason."""
        lines: dict[str, list[int]] = {}
        for case in self.cases:
            if case.reason is not None:
                lines.setdefault(f"cannot be calculated: {case.reason}", []).append(case.case.line)
        return self.read.without_all(lines)

    @property
    def varied(self) -> tuple[str, ...]:
        """The inputs and conditions that any case changes."""
        return tuple(self.cases[0].values)

    @property
    def failed(self) -> tuple[tuple[int, str], ...]:
        """Rows that failed, with the reason."""
        return tuple((case.row, case.reason) for case in self.cases if case.reason is not None)

    @property
    def verdict(self) -> State:
        """The worst verdict of all cases; where they pass with different changes only, no single design passes."""
        worst_verdict = worst(case.verdict for case in self.cases)
        needed = {case.decided.proposal for case in self.cases if case.verdict == "proposed"}
        changes = {one.changes for one in needed if one is not None}
        return "fails" if worst_verdict == "proposed" and len(changes) > 1 else worst_verdict


def case_setup(setup: Setup, case: StatedCase) -> Setup:
    """Return the setup of one case."""
    source = replace(setup.source, stated=setup.source.stated | set(case.values))
    return replace(setup.changed(case.values), source=source)


def run_cases(
    setup: Setup, read: CasesFile, *, executor: Executor, progress: Progress = silent
) -> tuple[Calculation, CasesTable]:
    """Calculate every case and, in full with its studies, the governing one.

    Limits that studies decide, and results that they give, need the studies of each case, up to the last that decides
    or gives; where there are none cases are calculated in array calls of fixed length. Either is shared out by
    ``executor``. Raises InputError with every reason and its line when no case
    can be calculated.
    """
    cases = _completed(setup, read.cases)
    done = _calculated(replace(setup, studies=_studies_of_each(setup)), cases, executor, progress)
    while alive := [index for index, case in enumerate(done) if case.reason is None]:
        governing = min(alive, key=lambda index: done[index].margin)
        try:
            full = calculate(case_setup(setup, cases[governing]), executor=executor, progress=progress)
        except UsageError as error:  # a study asks more than the calculation alone, a full turn for example
            done[governing] = CaseResult(cases[governing], {}, reason=str(error))
            continue
        table = CasesTable(tuple(done), governing, read.count, read.notes)
        return replace(full, failed=table.failed), table
    raise InputError([case.fault for case in done])


def _completed(setup: Setup, cases: Sequence[StatedCase]) -> list[StatedCase]:
    """Give every case a value of everything that any case changes; where its own cell is empty, the setup's."""
    varied = dict.fromkeys(name for case in cases for name in case.values)
    kept = {name: setup.nominal(name) for name in varied}
    return [replace(case, values={**kept, **case.values}) for case in cases]


def _studies_of_each(setup: Setup) -> tuple[Study, ...]:
    """Return the studies that every case runs: up to the last that gives results, or that may decide a limit."""
    by_chance = any(require.reliability is not None for require in requirements(setup))
    silent_ones = DECIDE_NOTHING if by_chance else (*DECIDE_NOTHING, *DECIDE_CHANCES)
    needed = [study.gives is not None or not isinstance(study, silent_ones) for study in setup.studies]
    last = max((number for number, is_needed in enumerate(needed, start=1) if is_needed), default=0)
    return tuple(setup.studies[:last])


def _calculated(setup: Setup, cases: Sequence[StatedCase], executor: Executor, progress: Progress) -> list[CaseResult]:
    """Calculate blocks of cases, one by one where they have studies: a block is the same wherever it is calculated.

    Where blocks are many, each is a job of its own; where they are few, the batches of the studies are shared out.
    """
    size = 1 if setup.studies else BLOCK
    blocks = [cases[start : start + size] for start in range(0, len(cases), size)]
    results: Iterable[list[CaseResult]]
    if len(blocks) >= 2 * getattr(executor, "slots", 1) > 2 and travels(setup):
        packed = pack(setup, studies=True)
        results = in_order(executor, _packed_block, ((packed, block) for block in blocks))
    else:
        names, count = [study.name for study in setup.studies], len(blocks)
        parts = (within(progress, "cases", place / count, (place + 1) / count, names) for place in range(count))
        results = (_block(setup, block, executor, part) for block, part in zip(blocks, parts, strict=True))
    done: list[CaseResult] = []
    progress("cases", 0, FINE)
    for result in results:
        done += result
        progress("cases", round(FINE * len(done) / len(cases)), FINE)
    return done


def _packed_block(job: tuple[Packed, Sequence[StatedCase]]) -> list[CaseResult]:
    with open_executor("serial") as alone:
        return _block(unpack(job[0]), job[1], alone, silent)


def _in_full(setup: Setup, case: StatedCase, executor: Executor, progress: Progress) -> CaseResult:
    try:
        calculation = calculate(setup, executor=executor, progress=progress)
    except UsageError as error:  # impossible, or a tolerance that its size outgrows
        return CaseResult(case, {}, reason=str(error))
    return CaseResult(case, calculation.answers, calculation.decided, absent=calculation.absent)


def _block(setup: Setup, cases: Sequence[StatedCase], executor: Executor, progress: Progress) -> list[CaseResult]:
    """Calculate some cases, without studies in one array call, each with the cost of its tolerances and its checks."""
    if setup.studies:
        return [_in_full(case_setup(setup, case), case, executor, progress) for case in cases]
    columns = {name: [case.values[name] for case in cases] for name in cases[0].values}
    rows = evaluate_rows(setup, columns, len(cases))
    done = []
    for index, case in enumerate(cases):
        own, reason = case_setup(setup, case), rows.reasons.get(index)
        answers: dict[str, Any] = {name: _plain(values[index]) for name, values in rows.results.items()}
        absent = {name: lacking[index] for name, lacking in rows.absent.items() if index in lacking}
        try:
            answers |= price_answers(own) if reason is None else {}
        except UsageError as error:  # a tolerance that its size outgrows
            reason = str(error)
        if reason is None:
            done.append(CaseResult(case, answers, decide(own, answers, {}), absent=absent))
        else:
            done.append(CaseResult(case, {}, reason=reason))
    return done


def _plain(value: Any) -> Any:
    return float(value) if getattr(value, "ndim", 1) == 0 else value
