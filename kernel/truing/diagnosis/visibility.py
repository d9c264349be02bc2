"""How small an effect may be and still be seen here, and what this design of the experiment cannot separate."""

from __future__ import annotations

from itertools import combinations
from math import comb, sqrt
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import si_bounds
from truing.diagnosis.contest import Contest
from truing.diagnosis.hypotheses import Hypothesis
from truing.diagnosis.result import Amount, Seen, Sight
from truing.diagnosis.search import Solution

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

POWER = 0.9
LEVEL = 0.05
SWALLOWED = 0.1
"""Share of a curve, squared and in units of the noise, below which the tolerances have swallowed it."""
INSEPARABLE = 0.01
TIED = 0.995


def needed(explanations: int) -> float:
    """Return the noncentrality that shows one parameter with 90 % power after so many explanations were searched.

    22 for 78 explanations (12 effects and their pairs), 17 for 12.
    """
    from scipy.special import ndtri

    return float((ndtri(1 - LEVEL / (2 * max(explanations, 1))) + ndtri(POWER)) ** 2)


def smallest_visible(contest: Contest, setting: tuple[int, ...]) -> list[Seen]:
    """Return for every candidate how small it may be, whether the tolerances hide it, whether it was excited."""
    import numpy as np

    problem, case = contest.problem, contest.evidence.case(setting)
    owners = {term.candidate for term in problem.terms}
    limit = needed(len(owners) + comb(len(owners), 2))
    raw = _without_tolerances(contest, setting)
    found: dict[str, Seen] = {}
    names = [candidate.name for candidate in problem.candidates]
    for piece in problem.term_pieces:
        candidate, term = problem.candidates[piece.owner], problem.terms[piece.place]
        several = names.count(candidate.name) > 1 or len(candidate.amplitudes) > 1
        for column, name, per in zip(piece.columns, term.unknowns, term.per, strict=True):
            unknown = next(each for each in candidate.amplitudes if each.name == name)
            seen = float(case.total_h[column, column])
            size = sqrt(limit / max(seen, 1e-300)) * per
            key = f"{candidate.name}.{name}" if several else candidate.name
            swallowed = seen < SWALLOWED * float(raw[column])
            bounds = si_bounds(unknown)
            sight: Sight = "hidden in the tolerances" if swallowed else "visible"
            if size > max(abs(bounds[0]), abs(bounds[1])) or not np.isfinite(size):
                sight = "not excited"
            known = found.get(key)
            if known is None or known.smallest is None or size < known.smallest.value:
                found[key] = Seen(key, Amount(size, unknown.unit), sight)
    still = [Seen(name, None, "not excited") for name in problem.unexcited if name not in problem.failing]
    return [
        *found.values(),
        *still,
        *(Seen(name, None, "cannot be fitted", why) for name, why in problem.failing.items()),
    ]


def _without_tolerances(contest: Contest, setting: tuple[int, ...]) -> NDArray[np.float64]:
    """Return the squared size of every column, in units of the noise, if nothing were tolerated."""
    import numpy as np

    k = contest.evidence.directions.shape[1]
    chosen = [products[place].matrix for products, place in zip(contest.evidence.products, setting, strict=True)]
    return np.asarray(np.diag(sum(chosen[1:], chosen[0]))[1 + k :])


def inseparable(contest: Contest, setting: tuple[int, ...]) -> list[str]:
    """Say which candidates this design cannot separate whatever their size, and which covariates are tied."""
    import numpy as np

    problem, case = contest.problem, contest.evidence.case(setting)
    h = case.total_h
    angles: dict[tuple[str, str], float] = {}
    alone = [
        piece for piece in problem.term_pieces if len(piece.columns) == 1 and len(problem.terms[piece.place].shape) == 0
    ]
    for a, b in combinations(alone, 2):
        i, j = a.columns[0], b.columns[0]
        cosine2 = h[i, j] ** 2 / max(h[i, i] * h[j, j], 1e-300)
        pair = problem.candidates[a.owner].name, problem.candidates[b.owner].name
        if pair[0] != pair[1] and 1 - cosine2 < INSEPARABLE:
            angle = float(np.degrees(np.arcsin(sqrt(max(0.0, 1 - cosine2)))))
            angles[pair] = min(angle, angles.get(pair, angle))
    sentences = [
        f"{first} and {second} draw nearly the same curve on this data (angle {angle:.1f} degrees): "
        "only much larger effects than usual could be told apart"
        for (first, second), angle in angles.items()
    ]
    return [*sentences, *_tied(contest), *_one_sided(contest)]


def _tied(contest: Contest) -> list[str]:
    import numpy as np

    moved = [item for item in contest.problem.machine.records.covariates.values() if not item.is_constant]
    sentences = []
    for first, second in combinations(moved, 2):
        both = np.isfinite(first.values) & np.isfinite(second.values)
        if both.sum() > 2 and abs(np.corrcoef(first.values[both], second.values[both])[0, 1]) > TIED:
            sentences.append(
                f"{first.name} and {second.name} move together in this record: what follows one cannot be told from "
                "what follows the other"
            )
    return sentences


def _one_sided(contest: Contest) -> list[str]:
    """Say which conditions that can have either sign were measured with one sign only."""
    import numpy as np

    machine = contest.problem.machine
    sentences = []
    for name, condition in machine.start.model.known_conditions.items():
        item = machine.records.covariates.get(name)
        if item is None or condition.low is None or condition.high is None or not condition.low < 0 < condition.high:
            continue
        low, high = np.nanmin(item.values), np.nanmax(item.values)
        if low >= 0 or high <= 0:
            sentences.append(f"{name} never changed its sign: what jumps with the sign looks like a constant here")
    return sentences


def separation(contest: Contest, true: Solution, rival: Hypothesis) -> float:
    """Return lambda: the deviance that is lost if a solution is true and a rival is fitted in its place."""
    import numpy as np

    h = contest.evidence.case(true.setting).total_h
    a, b, c = list(true.hypothesis.columns), list(rival.columns), true.coefficients
    own = float(c @ h[np.ix_(a, a)] @ c)
    if not b:
        return own
    cross = h[np.ix_(b, a)] @ c
    taken = np.linalg.lstsq(h[np.ix_(b, b)], cross, rcond=1e-10)[0]
    return max(own - float(cross @ taken), 0.0)
