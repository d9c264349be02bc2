"""The verdict: nothing, named causes, or unknown; and what this data cannot tell apart from it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest, curve_space
from truing.diagnosis.hypotheses import Hypothesis
from truing.diagnosis.records import FEWEST_READINGS
from truing.diagnosis.significance import Null, first_stage, second_stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ANY_LEVEL = 0.025
SECOND_LEVEL = 0.05
CLOSE = 6.0
"""Explanations less far behind in score are not excluded (a Bayes factor of about 20)."""
CLOSE_LIKELIHOOD = 4.0
NEARLY = 4.0
"""An addition to the winner that is less far behind in score may well be a second cause."""
CERTAIN_SECOND = 45.0
HELD = 0.98


@dataclass(frozen=True)
class Thresholds:
    """How far an explanation must lie above a simpler one; learnt once, used again in every fold."""

    first: float
    second: float


@dataclass(frozen=True)
class Decision:
    """The place of the winning hypothesis (0 is nothing), the significance of both steps, and its thresholds."""

    winner: int
    p_any: float
    p_second: float | None
    null: Null
    thresholds: Thresholds


def _one_term(hypothesis: Hypothesis) -> bool:
    return hypothesis.kind in {"one", "shape", "input"}


def without_needless_inputs(contest: Contest) -> Contest:
    """Strike out inputs off their band unless nothing registered explains the data nearly as well.

    An input is named only when it must lie outside; a gauge or an effect that draws its curve is the smaller claim.
    """
    import numpy as np

    found = contest.found
    named = found.best(lambda hypothesis: hypothesis.kind in {"one", "two"})
    limit = -np.inf if named < 0 else found.score[named] + CLOSE
    needless = [item.kind == "input" and found.score[place] < limit for place, item in enumerate(found.hypotheses)]
    score = np.where(needless, -np.inf, found.score)
    return replace(contest, found=replace(found, score=score))


def _two_terms(hypothesis: Hypothesis) -> bool:
    return hypothesis.kind in {"two", "mixed"}


def decide(contest: Contest, *, seed: int) -> Decision:
    """Decide whether there is anything, and whether there is more than one, the search paid for."""
    import numpy as np

    found = contest.found
    best = found.best(lambda hypothesis: hypothesis.kind != "none")
    null = first_stage(contest, best, seed=seed)
    p_any = null.p_value
    limit = float(np.quantile(null.maxima, 1 - ANY_LEVEL))
    if min(contest.evidence.rows, contest.problem.machine.records.readings) < FEWEST_READINGS:
        return Decision(0, 1.0, None, null, Thresholds(limit, 0.0))
    if p_any > ANY_LEVEL:
        return Decision(0, p_any, None, null, Thresholds(limit, 0.0))
    one, two = _rivals(contest)
    if two < 0 or one < 0:
        return Decision(max(one, two), p_any, None, null, Thresholds(limit, 0.0))
    excess = float(found.score[two] - found.score[one])
    alone = found.best(_one_term)
    if excess <= 0:
        return Decision(alone, p_any, None, null, Thresholds(limit, 0.0))
    second = second_stage(contest, one, two, with_shapes=found.hypotheses[one].kind == "shape", seed=seed + 1)
    threshold = max(0.0, float(np.quantile(second.maxima, 1 - SECOND_LEVEL)))
    winner = two if second.p_value <= SECOND_LEVEL or excess > CERTAIN_SECOND else alone
    return Decision(winner, p_any, second.p_value, null, Thresholds(limit, threshold))


def _rivals(contest: Contest) -> tuple[int, int]:
    """Return the best explanation with one term and with two.

    Where a registered pair scores above the best shape, the shape is not the simpler explanation of the pair: a
    polynomial that contains two causes is no cause. The pair is then set against the best registered single.
    """
    found = contest.found
    one, two = found.best(_one_term), found.best(_two_terms)
    pair = found.best(lambda hypothesis: hypothesis.kind == "two")
    if one >= 0 and found.hypotheses[one].kind == "shape" and pair >= 0 and found.score[pair] > found.score[one]:
        named = found.best(lambda hypothesis: hypothesis.kind in {"one", "input"})
        return (named, two) if named >= 0 else (one, two)
    return one, two


def decide_again(contest: Contest, thresholds: Thresholds) -> int:
    """Decide on other rows of the same record with thresholds that are known; for the folds of a cross-validation."""
    found = contest.found
    best = found.best(lambda hypothesis: hypothesis.kind != "none")
    if best < 0 or found.score[best] - found.score[0] <= thresholds.first:
        return 0
    one, two = _rivals(contest)
    alone = found.best(_one_term)
    if one >= 0 and two >= 0 and found.score[two] - found.score[one] > thresholds.second:
        return two
    return alone if alone >= 0 else two


def alternatives(contest: Contest, winner: int) -> list[int]:
    """Return the explanations that this data does not exclude.

    They are no larger than the winner, and not the winner with something added, unless the addition is nearly worth
    its parameters: then a second cause may well be there.
    """
    found = contest.found
    chosen = found.hypotheses[winner]
    if chosen.kind == "none":
        return []
    kept = []
    for place in found.ranked():
        rival = found.hypotheses[place]
        if rival.kind == "none" or rival.key == chosen.key:
            continue
        if set(chosen.key) < set(rival.key):
            if found.score[winner] - found.score[place] < NEARLY:
                kept.append(place)
            continue
        if len(rival.pieces) > len(chosen.pieces) or not _is_close(contest, winner, place):
            continue
        if not is_vaguer(contest, rival, chosen):
            kept.append(place)
    return kept


def _is_close(contest: Contest, winner: int, rival: int) -> bool:
    found = contest.found
    if found.score[winner] - found.score[rival] < CLOSE:
        return True
    a, b = found.hypotheses[winner], found.hypotheses[rival]
    same_number = len(a.pieces) == len(b.pieces) and b.size <= a.size + 1
    return bool(same_number and found.likelihood[winner] - found.likelihood[rival] < CLOSE_LIKELIHOOD)


def is_vaguer(contest: Contest, larger: Hypothesis, smaller: Hypothesis) -> bool:
    """Tell whether an explanation can draw every curve of the other and is a vaguer word for it.

    It has more columns; or as many, where a shape that nobody registered draws what is registered.
    """
    import numpy as np

    has_shape = any(piece.kind == "shape" for piece in larger.pieces)
    if len(larger.columns) < len(smaller.columns) + (0 if has_shape else 1):
        return False
    covered, total = np.zeros(len(smaller.columns)), np.zeros(len(smaller.columns))
    a, b = curve_space(contest, larger), curve_space(contest, smaller)
    for name, wanted in b.items():
        basis = _basis(a[name])
        covered += np.sum((basis.T @ wanted) ** 2, axis=0)
        total += np.sum(wanted**2, axis=0)
    return bool(np.all(covered >= HELD * total))


def _basis(columns: NDArray[np.float64]) -> NDArray[np.float64]:
    import numpy as np

    used = columns[:, np.any(columns != 0, axis=0)]
    left, size, _ = np.linalg.svd(used, full_matrices=False)
    return np.asarray(left[:, size > 1e-9 * (size[0] if len(size) else 1.0)])
