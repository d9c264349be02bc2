"""Tasks side by side: what they ask at one time is answered at one time, in an order that is always the same."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest

from truing.diagnosis.side_by_side import asked_beside, side_by_side

CALLS: list[list[int]] = []


@pytest.fixture(autouse=True)
def _no_calls() -> None:
    CALLS.clear()


def squares(asked: list[int]) -> list[int]:
    """Answer all that is asked at one time; in a task, by way of the one who waits for it."""
    return asked_beside(asked, answered)


def answered(asked: list[int]) -> list[int]:
    CALLS.append(asked)
    return [number**2 for number in asked]


def together(asked: list[list[int]]) -> list[list[int]]:
    made = iter(squares([number for each in asked for number in each]))
    return [[next(made) for _ in each] for each in asked]


def summed(times: int, begin: int) -> int:
    """Ask so many times, each time for what was answered before and one more."""
    number = begin
    for _ in range(times):
        (square,) = squares([number])
        number = square + 1
    return number


def test_what_tasks_ask_at_one_time_is_one_call() -> None:
    assert side_by_side([partial(summed, 2, 1), partial(summed, 1, 2), partial(summed, 3, 0)], together) == [5, 5, 5]
    assert CALLS == [[1, 2, 0], [2, 1], [2]]
    assert [summed(2, 1), summed(1, 2), summed(3, 0)] == [5, 5, 5]


def test_a_task_may_have_tasks_of_its_own() -> None:
    def inner(begins: list[int]) -> int:
        return sum(side_by_side([partial(summed, 1, begin) for begin in begins], together))

    assert side_by_side([partial(inner, [1, 2]), partial(inner, [3, 4])], together) == [7, 27]
    assert CALLS == [[1, 2, 3, 4]]


def test_what_a_task_raises_ends_all_of_them() -> None:
    ended: list[str] = []

    def failing() -> int:
        squares([1])
        raise ValueError("no square")

    def waiting(name: str) -> int:
        try:
            return summed(5, 1)
        finally:
            ended.append(name)

    def late() -> int:
        return ended.append("never begun") or 0

    tasks: list[Callable[[], int]] = [partial(waiting, "before"), failing, partial(waiting, "behind")]
    with pytest.raises(ValueError, match="no square"):
        side_by_side(tasks, together)
    assert ended == ["before", "behind"]
    with pytest.raises(ZeroDivisionError):
        side_by_side([lambda: 1 // 0, late], together)
    assert ended == ["before", "behind"]


def test_no_task_is_nothing() -> None:
    assert side_by_side([], together) == []
    assert CALLS == []
