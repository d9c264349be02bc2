"""The verdict of a diagnosis: one rule over all that was found, for headline, terminal, sheet and JSON alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import isnan
from typing import TYPE_CHECKING, Literal

from truing.diagnosis.alarms import alarms_of, moved_inputs, wandering
from truing.diagnosis.records import FEWEST_READINGS

if TYPE_CHECKING:
    from truing.diagnosis.result import Diagnosis

Verdict = Literal["named", "one_of", "unknown", "none", "undecided"]

UNKNOWN = "unknown"
"""What an explanation calls a shape that nobody registered."""
CHANCE = 0.2
"""Below this p-value the best explanation is not called chance: one record of nothing in five lies below it."""
APART = 25.0
"""The lambda from which on two explanations are told apart. Their scores then differ by 25 with a standard deviation of
2 sqrt(25) = 10, so that with a chance of 97 % the difference is above the 6 below which a rival is not excluded."""
_STRUCTURE = ("bias", "trend", "order", "step", "wave")

Explanation = tuple[str, ...]


def explanations_of(diagnosis: Diagnosis) -> tuple[Explanation, ...]:
    """Return every explanation that this record does not exclude, the best first; names of one curve count each."""
    if not diagnosis.causes and diagnosis.remainder is None:
        return ()
    best = [cause.effect for cause in diagnosis.causes]
    same: Mapping[str, Sequence[str]] = {cause.effect: cause.same_as for cause in diagnosis.causes}
    found = [([*best, UNKNOWN] if diagnosis.remainder is not None else best, same)]
    for rival in diagnosis.alternatives:
        over = [f"{UNKNOWN}:{','.join(rival.depends_on)}" if name == UNKNOWN else name for name in rival.causes]
        found.append((over, rival.same_as))
    once: dict[frozenset[str], Explanation] = {}
    for names, same in found:
        for each in product(*((name, *same.get(name, ())) for name in names)):
            once.setdefault(frozenset(each), each)
    return tuple(once.values())


def shared_of(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the names that every one of several explanations holds: so much is sure where the rest is open.

    A shape that nobody registered is the same in two of them where it is one over the same covariates.
    """
    first, *others = explanations_of(diagnosis) or ((),)
    over = ",".join(diagnosis.remainder.depends_on) if diagnosis.remainder is not None else ""
    names = {name: {name, f"{UNKNOWN}:{over}"} if name == UNKNOWN else {name} for name in first}
    return tuple(name for name, words in names.items() if others and all(words & set(each) for each in others))


def further_of(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the names of what may be there beside the best explanation, where every other one holds all of it."""
    first, *others = explanations_of(diagnosis) or ((),)
    if len(shared_of(diagnosis)) < len(first):
        return ()
    return tuple(dict.fromkeys(name for names in others for name in names if name.split(":")[0] not in first))


def verdict_of(diagnosis: Diagnosis) -> Verdict:
    """Return the verdict; "one_of" wherever a cause has another name or a rival is near, "none" without any doubt.

    One explanation that an alarm speaks against is not named, with or without what may be there as well: it is
    undecided.
    """
    explanations = explanations_of(diagnosis)
    if not explanations:
        return "undecided" if any(doubts(diagnosis)) else "none"
    if all(name.startswith(UNKNOWN) for names in explanations for name in names):
        return "unknown"
    if (len(explanations) == 1 or further_of(diagnosis)) and any(alarms_of(diagnosis)):
        return "undecided"
    return "one_of" if len(explanations) > 1 else "named"


def doubts(diagnosis: Diagnosis) -> Iterator[str]:
    """Give the reasons for which a diagnosis may be undecided, one clause each.

    Where a cause would be named: what speaks against it. Where none is: why it cannot be said that nothing is wrong.
    """
    yield from alarms_of(diagnosis) if explanations_of(diagnosis) else _doubts_of_nothing(diagnosis)


def _doubts_of_nothing(diagnosis: Diagnosis) -> Iterator[str]:
    readings = diagnosis.records.readings
    if readings < FEWEST_READINGS:
        yield f"{readings} readings that differ are too few to tell a cause from chance"
    elif diagnosis.p_any is None or not diagnosis.p_any >= CHANCE:
        yield _nearly(diagnosis)
    for wrong in diagnosis.wrong:
        for finding in wrong.findings:
            if finding.kind in _STRUCTURE and not finding.is_allowed:
                yield f"the residuals of {wrong.result} are no mere noise: {finding.text}"
    yield from wandering(diagnosis)
    yield from moved_inputs(diagnosis)
    yield from diagnosis.hindrances


def _nearly(diagnosis: Diagnosis) -> str:
    if diagnosis.p_any is None or isnan(diagnosis.p_any):
        return "whether anything is wrong was not tested"
    best = next((rival.causes for rival in diagnosis.ranking if rival.causes), ())
    named = f", {' + '.join(best)}," if best else ""
    chance = "less than 0.001" if diagnosis.p_any < 0.001 else f"{diagnosis.p_any:.2g}"
    return f"the best explanation{named} would come about by chance with a probability of {chance}"
