"""Verdicts: which limits hold for the design as stated, which for one that a study proposes, which nobody decided."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan
from typing import Any

import numpy as np

from truing.declare.goals import Require
from truing.executors import keepable
from truing.setup import Setup
from truing.studies.bench import Outcome, proposals_of
from truing.studies.checks import (
    EXIT_CODES,
    Check,
    Proposal,
    State,
    check_name,
    compared_words,
    exists,
    goal_of,
    is_known,
    limit_amount,
    plain_checks,
    requirements,
)
from truing.studies.reliability import Reliability
from truing.units import from_si

NO_STUDY = "no study of the model"
"""What would decide a limit that none of the model's studies decides."""
NO_RESULT = "no study: the result does not exist"
"""Likewise, of a limit on a result that does not exist, or one that is such a result."""


@keepable
@dataclass(frozen=True)
class Decided:
    """Every limit with its state, and the design that a study proposes where the stated one misses a limit."""

    checks: tuple[Check, ...]
    proposal: Proposal | None = None

    @property
    def verdict(self) -> State:
        """The worst state of all."""
        return worst(check.state for check in self.checks)


def worst(states: Iterable[State]) -> State:
    """Return the worst of some states; where there is none, nothing is missed."""
    order = list(EXIT_CODES)
    return max(states, key=order.index, default="passes")


def decide(setup: Setup, answers: Mapping[str, Any], outcomes: Mapping[str, Outcome]) -> Decided:
    """Return the state of every limit after these studies: plain ones first, then those of studies, then undecided.

    Of a chance that two studies decide, the word of the first counts: it is asked as stated. One proposal is taken: the
    first among those that miss fewest limits and miss none that the stated design keeps.
    """
    plain = plain_checks(setup, dict(answers))
    checks = {check.name: check for check in plain if not isnan(check.margin)}
    for outcome in outcomes.values():
        for check in outcome.checks():
            checks.setdefault(check.name, check)
    requires = requirements(setup)
    for require in requires:
        name = check_name(require, requires)
        if name not in checks:
            checks[name] = _undecided(require, name, setup, answers)
        elif not checks[name].compared:
            checks[name] = replace(checks[name], compared=compared_words(require, setup, answers))
    chosen = _chosen([one for outcome in outcomes.values() for one in proposals_of(outcome)], checks)
    if chosen is not None:
        checks |= {
            check.name: replace(checks[check.name], proposed=check) for check in chosen.checks if check.name in checks
        }
    return Decided(tuple(checks.values()), chosen)


def _undecided(require: Require, name: str, setup: Setup, answers: Mapping[str, Any]) -> Check:
    """Return the check of a limit that no study of this run decides, with the study that would."""
    goal = goal_of(require, setup)
    known = is_known(require, setup, answers)
    limit, unit, compared = nan, setup.print_unit(require.result), require.result
    if known:
        compared = compared_words(require, setup, answers)
    if goal is not None:
        limit, unit = goal, ""
    elif known or require.limit not in setup.model.result_fields:
        limit = _single(limit_amount(require, setup, answers), unit)
    return Check(
        name, nan, limit, unit, nan, passed=False, undecided=_decider(require, setup, answers) or NO_STUDY,
        relation="≥" if goal is not None or require.kind == "at_least" else "≤", compared=compared,
        chance=goal is not None, flag=require.is_flag,
    )  # fmt: skip


def _single(amount: Any, unit: str) -> float:
    """Return a limit in its unit; of one that runs along an axis there is no single number."""
    return float(from_si(float(amount), unit)) if np.ndim(amount) == 0 else nan


def _decider(require: Require, setup: Setup, answers: Mapping[str, Any]) -> str:
    """Name the study of the model that would decide a limit; empty where there is none."""
    model = setup.model
    if not all(exists(answers[name]) for name in (require.result, require.limit) if name in answers):
        return NO_RESULT
    for study, given in model.study_result_fields.items():
        if {require.result, require.limit} & (given.keys() - answers.keys()):
            return study
    return next((study.name for study in model.studies if isinstance(study, Reliability)), "")


def _chosen(proposals: Sequence[Proposal], stated: Mapping[str, Check]) -> Proposal | None:
    """Return the first of the proposals that miss fewest limits, among those that miss none which is kept as stated."""
    missed = {id(proposal): [check for check in proposal.checks if not check.passed] for proposal in proposals}
    sound = [
        proposal
        for proposal in proposals
        if not any(stated[each.name].passed for each in missed[id(proposal)] if each.name in stated)
    ]
    return min(sound, key=lambda one: len(missed[id(one)]), default=None)


def sentence_of(decided: Decided) -> str:
    """Say in a sentence or two how many limits are kept, and which are not."""
    checks = decided.checks
    if not checks:
        return "This calculation states no limits: there is nothing to pass or fail."
    of = {state: [check for check in checks if check.state == state] for state in EXIT_CODES}
    if len(of["passes"]) == len(checks):
        return {1: "The one check passes.", 2: "Both checks pass."}.get(len(checks), f"All {len(checks)} checks pass.")
    said = [
        _counted(of["fails"], checks, "fails", "fail") if of["fails"] else "",
        *_undecided_words(of["undecided"], checks),
        _proposed_words(of["proposed"], decided) if of["proposed"] else "",
    ]
    return " ".join(filter(None, said))


def _counted(some: Sequence[Check], checks: Sequence[Check], verb: str, verbs: str) -> str:
    names = ", ".join(check.name.replace("_", " ") for check in some)
    return f"{len(some)} of {len(checks)} checks {verb if len(some) == 1 else verbs}: {names}."


def _undecided_words(some: Sequence[Check], checks: Sequence[Check]) -> Iterator[str]:
    lacking = [check for check in some if check.undecided == NO_RESULT]
    left = [check for check in some if check.undecided != NO_RESULT]
    deciders = " and ".join(dict.fromkeys(check.undecided for check in left))
    if deciders == NO_STUDY:
        way = f"No study of the model decides {'it' if len(left) == 1 else 'them'}."
    else:
        way = f"No study of this run decides {'it' if len(left) == 1 else 'them'}; {deciders} would."
    if left:
        yield f"{_counted(left, checks, 'is undecided', 'are undecided')} {way}"
    if lacking:
        counted = _counted(lacking, checks, "is undecided", "are undecided")
        result, where = ("Its result does", "it") if len(lacking) == 1 else ("Their results do", "them")
        yield f"{counted} {result} not exist; the reason stands beside {where}."


def _proposed_words(some: Sequence[Check], decided: Decided) -> str:
    assert decided.proposal is not None  # else no check is proposed
    counted = _counted(some, decided.checks, "fails as stated", "fail as stated")
    what, study = decided.proposal.what, decided.proposal.study
    return f"{counted} {'It passes' if len(some) == 1 else 'They pass'} with {what} that study '{study}' proposes."


def change_words(proposal: Proposal) -> str:
    """Say what a proposal changes: crank_radius IT7 → IT6, rod_length IT7 → IT5."""
    return ", ".join(f"{name} {stated} → {proposed}" for name, stated, proposed in proposal.changes)
