"""Inputs that scatter together: how much, whether that is possible, and what it makes of their covariance.

A correlation is that of the normal scores: every input is a function of a standard normal value, and these values are
correlated (a Gaussian copula). Of two normal inputs it is Pearson's correlation. Source: R. B. Nelsen, An Introduction
to Copulas, 2nd ed., Springer 2006.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass
from itertools import combinations
from math import ceil, floor, isfinite
from typing import Any

import numpy as np
from scipy.special import ndtr

from truing.arrays import Matrix
from truing.declare.spreads import Distribution
from truing.errors import DeclarationError

POSITIVE = 1e-9
"""Smallest eigenvalue of a matrix of correlations; below it some combination of the inputs would hardly scatter."""
DIGITS = 1000
"""Ends of a range are said to this part of 1, rounded inwards."""
MOST_SEARCHED = 40
"""Among so many inputs three that contradict each other are looked for."""


@dataclass(frozen=True)
class Correlated:
    """Two inputs that scatter together: the correlation of their normal scores, between -1 and 1.

    Raises DeclarationError for a number outside of that, and for an input with itself.
    """

    first: str
    second: str
    coefficient: float
    _: KW_ONLY
    why: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        fault = pair_fault(self.first, self.second, self.coefficient)
        if fault:
            raise DeclarationError(fault)

    @property
    def name(self) -> str:
        """The pair as an inputs file names it."""
        return f"{self.first}, {self.second}"

    @property
    def pair(self) -> frozenset[str]:
        """The two inputs, in either order."""
        return frozenset({self.first, self.second})


def correlated(first: str, second: str, coefficient: float, *, why: str = "", source: str = "") -> Correlated:
    """Let two inputs scatter together, with this correlation of their normal scores (Pearson's of normal inputs).

    Stands among the ``errors`` of a model, beside the tolerances of the two. Raises DeclarationError for a coefficient
    that is not between -1 and 1.
    """
    return Correlated(first, second, coefficient, why=why, source=source)


def pair_fault(first: str, second: str, coefficient: float) -> str:
    """Return why two inputs cannot be correlated so, or nothing."""
    if first == second:
        return f"'{first}' is correlated with itself; name two inputs"
    if not (isfinite(coefficient) and abs(coefficient) < 1):
        more = "; inputs that always go together are one input" if abs(coefficient) == 1 else ""
        return f"the correlation of '{first}' and '{second}' is {coefficient:g}; it lies between -1 and 1{more}"
    return ""


def pearson(first: Distribution, second: Distribution, coefficient: float) -> Any:
    """Return the correlation of the values of two inputs from that of their normal scores.

    Exact, closed forms; numbers, or arrays where the distributions hold those of several designs. 0 where one of them
    has no width. Source: P.-L. Liu, A. Der Kiureghian, Probabilistic Eng. Mech. 1 (1986) 105.
    """
    shapes = {first.shape, second.shape}
    if shapes == {"normal"}:
        return coefficient
    if shapes == {"uniform"}:
        return 6 / np.pi * np.arcsin(coefficient / 2)
    if shapes == {"normal", "uniform"}:
        return coefficient * (3 / np.pi) ** 0.5
    if first.shape != "lognormal":
        first, second = second, first
    ratio = first.sd / first.mean
    log_sd = np.sqrt(np.log1p(ratio**2))
    with np.errstate(invalid="ignore", divide="ignore"):
        if second.shape == "normal":
            of_values = coefficient * log_sd / ratio
        elif second.shape == "uniform":
            of_values = 12**0.5 * (ndtr(coefficient * log_sd / 2**0.5) - 0.5) / ratio
        else:
            other = second.sd / second.mean
            of_values = np.expm1(coefficient * log_sd * np.sqrt(np.log1p(other**2))) / (ratio * other)
    return np.where(np.isfinite(of_values), of_values, 0.0)


def matrix_of(names: Sequence[str], pairs: Iterable[Correlated]) -> Matrix:
    """Return the correlations of these inputs (k, k), of normal scores; 0 of pairs that are not stated."""
    matrix = np.eye(len(names))
    for stated in pairs:
        if stated.pair <= set(names):
            one, other = names.index(stated.first), names.index(stated.second)
            matrix[one, other] = matrix[other, one] = stated.coefficient
    return matrix


def is_possible(matrix: Matrix) -> bool:
    """Say whether inputs can be correlated so: no combination of them has a variance of 0 or less."""
    return bool(np.linalg.eigvalsh(matrix)[0] > POSITIVE)


# Which correlations contradict each other, and what would be possible


@dataclass(frozen=True)
class Contradiction:
    """Correlations that cannot all be true: the pair that is to blame, stated last, and what is wrong in words."""

    blamed: Correlated
    text: str


def contradictions(pairs: Sequence[Correlated]) -> Iterator[Contradiction]:
    """Give one contradiction for every group of inputs whose correlations cannot all be true."""
    for names in groups(pairs):
        if not is_possible(matrix_of(names, pairs)):
            yield _contradiction(_smallest(names, pairs), pairs)


def groups(pairs: Iterable[Correlated]) -> list[tuple[str, ...]]:
    """Return the inputs that scatter together, directly or by way of others, in the order they are named."""
    together: list[dict[str, None]] = []
    for stated in pairs:
        if not stated.coefficient:
            continue
        met = [group for group in together if stated.pair & group.keys()]
        joined = {name: None for group in met for name in group} | dict.fromkeys((stated.first, stated.second))
        together = [group for group in together if group not in met] + [joined]
    return [tuple(group) for group in together]


def _smallest(names: tuple[str, ...], pairs: Sequence[Correlated]) -> tuple[str, ...]:
    """Return three of the inputs whose correlations contradict each other, or all where no three do."""
    if len(names) <= MOST_SEARCHED:
        for three in combinations(names, 3):
            if not is_possible(matrix_of(three, pairs)):
                return three
    return names


def _contradiction(names: tuple[str, ...], pairs: Sequence[Correlated]) -> Contradiction:
    """Say what is wrong, and between what the last pair would have to lie for the others to hold."""
    inside = [stated for stated in pairs if stated.pair <= set(names) and stated.coefficient]
    *first, last = (f"'{name}'" for name in names)
    text = f"the correlations of {', '.join(first)} and {last} contradict each other"
    for stated in reversed(inside):
        ends = _permitted(matrix_of(names, pairs), names.index(stated.first), names.index(stated.second))
        if ends is not None:
            low, high = ceil(ends[0] * DIGITS) / DIGITS, floor(ends[1] * DIGITS) / DIGITS
            others = " (a pair that is not stated counts as 0)" if _misses_a_pair(names, pairs) else ""
            hint = f"with the others as they are{others}, that of '{stated.first}' and '{stated.second}'"
            return Contradiction(stated, f"{text}; {hint} lies between {low:g} and {high:g}")
    return Contradiction(inside[-1], f"{text}; some combination of them would have a negative variance")


def _misses_a_pair(names: Sequence[str], pairs: Iterable[Correlated]) -> bool:
    stated = {each.pair for each in pairs}
    return any(frozenset(pair) not in stated for pair in combinations(names, 2))


def _permitted(matrix: Matrix, one: int, other: int) -> tuple[float, float] | None:
    """Return between what one correlation lies for the matrix to be possible, the others as they are; None for none."""
    rest = [place for place in range(len(matrix)) if place not in (one, other)]
    inner = matrix[np.ix_(rest, rest)]
    if not is_possible(inner):
        return None
    first, second = matrix[rest, one], matrix[rest, other]
    solved = np.linalg.solve(inner, np.column_stack([first, second]))
    left, right = 1 - first @ solved[:, 0], 1 - second @ solved[:, 1]
    if min(left, right) <= POSITIVE:
        return None
    centre, half = float(first @ solved[:, 1]), float((left * right) ** 0.5)
    return max(centre - half, -1.0), min(centre + half, 1.0)


def in_force(declared: Iterable[Correlated], stated: Iterable[Correlated]) -> tuple[Correlated, ...]:
    """Return the correlations that hold: those stated in place of those declared of the same two inputs."""
    holding = {each.pair: each for each in declared}
    for each in stated:
        known = holding.get(each.pair)
        if known is None or known.coefficient != each.coefficient:
            holding[each.pair] = each
    return tuple(holding.values())


def scatter_fault(name: str, tolerances: Sequence[str], is_drawn: Callable[[str], bool]) -> str:
    """Return why an input cannot scatter together with another, or nothing; ``tolerances`` in force are on it."""
    if not tolerances:
        return f"'{name}' does not scatter, its tolerance is off; state a tolerance, or leave the correlation out"
    if len(tolerances) > 1:
        return f"'{name}' scatters by two tolerances, {' and '.join(tolerances)}; turn one of them off"
    if is_drawn(tolerances[0]):
        return f"'{name}' is drawn by a function (tolerance {tolerances[0]}), which says itself how inputs go together"
    return ""
