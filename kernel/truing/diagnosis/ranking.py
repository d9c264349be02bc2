"""What comes first: by a score, and where nothing but rounding parts the scores by what is fixed.

Two causes may draw one curve, and two sides of a machine may move alike. Their scores are then the same but for how the
processor rounds and where a fit stopped, and neither may say which of the two comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import groupby
from math import inf
from typing import Any, TypeVar

T = TypeVar("T")

SAME = 1e-3
"""Scores that differ by no more are the same: fits go no farther, and a report shows tenths."""


def lowest_first(several: Iterable[T], score: Callable[[T], float], place: Callable[[T], Any] = lambda _: 0) -> list[T]:
    """Return several things, the lowest score first; of one score the first place first, and then as they came."""
    scored = sorted((score(each), index, each) for index, each in enumerate(several))
    least = -inf

    def lowest(entry: tuple[float, int, T]) -> float:
        nonlocal least
        least = least if entry[0] <= least + SAME else entry[0]
        return least

    groups = (sorted(same, key=lambda entry: (place(entry[2]), entry[1])) for _, same in groupby(scored, lowest))
    return [each for group in groups for *_, each in group]
