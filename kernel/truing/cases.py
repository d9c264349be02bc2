"""Many cases of one calculation: every row of a file is one, and the worst of them governs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any

from truing.calculation import Calculation, calculate
from truing.declare.goals import Require
from truing.errors import Fault, InputError, UsageError
from truing.evaluate import evaluate_rows
from truing.measurements import Case
from truing.prices import price_answers
from truing.setup import Setup
from truing.studies.bench import Check, Progress, silent
from truing.studies.checks import plain_checks


@dataclass(frozen=True)
class CaseResult:
    """One case, what it answers in SI and its checks, or why it failed."""

    case: Case
    answers: Mapping[str, Any]
    checks: tuple[Check, ...] = ()
    reason: str | None = None

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
        """The smallest margin of its checks; infinite where there are none."""
        return min((check.margin for check in self.checks), default=float("inf"))

    @property
    def fault(self) -> Fault:
        """Why it failed, with file and line."""
        return Fault(self.reason or "", self.case.file, self.case.line)


@dataclass(frozen=True)
class CasesTable:
    """All cases in the order of the file; ``governing`` is the place of the one with the smallest margin."""

    cases: tuple[CaseResult, ...]
    governing: int

    @property
    def varied(self) -> tuple[str, ...]:
        """The inputs and conditions that any case changes."""
        return tuple(self.cases[0].values)

    @property
    def failed(self) -> tuple[tuple[int, str], ...]:
        """Rows that failed, with the reason."""
        return tuple((case.row, case.reason) for case in self.cases if case.reason is not None)

    @property
    def passed(self) -> bool:
        """Whether every case could be calculated and keeps its limits."""
        return not self.failed and all(check.passed for case in self.cases for check in case.checks)


def case_setup(setup: Setup, case: Case) -> Setup:
    """Return the setup of one case."""
    return replace(setup.changed(case.values), stated=setup.stated | set(case.values))


def run_cases(
    setup: Setup, cases: Sequence[Case], *, executor: Executor, progress: Progress = silent
) -> tuple[Calculation, CasesTable]:
    """Calculate every case and, in full with its studies, the governing one.

    Limits that studies decide need the studies of each case; without such limits all cases are one array call. Raises
    InputError with every reason and its line when no case can be calculated.
    """
    cases = _completed(setup, cases)
    one_by_one = _studies_decide(setup)
    done = _one_by_one(setup, cases, executor, progress) if one_by_one else _all_at_once(setup, cases)
    while alive := [place for place, case in enumerate(done) if case.reason is None]:
        governing = min(alive, key=lambda place: done[place].margin)
        try:
            full = calculate(case_setup(setup, cases[governing]), executor=executor, progress=progress)
        except UsageError as error:  # a study asks more than the calculation alone, a full turn for example
            done[governing] = CaseResult(cases[governing], {}, reason=str(error))
            continue
        table = CasesTable(tuple(done), governing)
        return replace(full, failed=table.failed), table
    raise InputError([case.fault for case in done])


def _completed(setup: Setup, cases: Sequence[Case]) -> list[Case]:
    """Give every case a value of everything that any case changes; where its own cell is empty, the setup's."""
    varied = dict.fromkeys(name for case in cases for name in case.values)
    kept = {name: setup.nominal(name) for name in varied}
    return [replace(case, values={**kept, **case.values}) for case in cases]


def _studies_decide(setup: Setup) -> bool:
    """Tell whether a limit is one on a chance, or on a result that a study gives."""
    running = {study.name for study in setup.studies}
    given = {name for study, names in setup.model.study_result_fields.items() if study in running for name in names}
    limits_ = [item for item in setup.model.objectives if isinstance(item, Require)]
    return bool(running) and any(item.reliability is not None or item.result in given for item in limits_)


def _one_by_one(setup: Setup, cases: Sequence[Case], executor: Executor, progress: Progress) -> list[CaseResult]:
    done = []
    for count, case in enumerate(cases):
        progress("cases", count, len(cases))
        try:
            found = calculate(case_setup(setup, case), executor=executor)
        except UsageError as error:  # impossible, or a tolerance that its size outgrows
            done.append(CaseResult(case, {}, reason=str(error)))
            continue
        done.append(CaseResult(case, found.answers, found.checks))
    progress("cases", len(cases), len(cases))
    return done


def _all_at_once(setup: Setup, cases: Sequence[Case]) -> list[CaseResult]:
    columns = {name: [case.values[name] for case in cases] for name in cases[0].values}
    rows = evaluate_rows(setup, columns, len(cases))
    done = []
    for place, case in enumerate(cases):
        reason = rows.reasons.get(place)
        if reason is not None:
            done.append(CaseResult(case, {}, reason=reason))
            continue
        answers = {name: _plain(values[place]) for name, values in rows.results.items()}
        done.append(_checked(case, case_setup(setup, case), answers))
    return done


def _checked(case: Case, setup: Setup, answers: Mapping[str, Any]) -> CaseResult:
    """Add what the tolerances cost in this case, and its checks."""
    try:
        known = {**answers, **price_answers(setup)}
    except UsageError as error:  # a tolerance that its size outgrows
        return CaseResult(case, {}, reason=str(error))
    return CaseResult(case, known, tuple(plain_checks(setup, known)))


def _plain(value: Any) -> Any:
    return float(value) if getattr(value, "ndim", 1) == 0 else value
