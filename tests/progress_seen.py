"""What a study says of its progress while it runs, and whether that is enough for somebody who waits."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import pytest

from truing.studies.bench import Bench

LONG = 2.0
"""Seconds after which a study owes word of its progress."""
LEAST_STEPS = 10
LONGEST_SILENCE = 0.4
"""The share of its time that a study may pass without a word, unless it is short."""


@dataclass(frozen=True)
class Seen:
    """One run of a study: the seconds it took, and when it spoke, with the share it said was done."""

    name: str
    seconds: float
    words: tuple[tuple[float, float], ...]

    @property
    def faults(self) -> list[str]:
        """What is wrong with it, in words."""
        if self.seconds <= LONG:
            return []
        found = []
        steps = len({share for _, share in self.words})
        if steps < LEAST_STEPS:
            found.append(f"{self.name} took {self.seconds:.1f} s and spoke of {steps} steps, not {LEAST_STEPS}")
        ends = [0.0, *(when for when, _ in self.words), self.seconds]
        silence = max(after - before for before, after in pairwise(ends))
        if silence > max(LONGEST_SILENCE * self.seconds, LONG):
            found.append(f"{self.name} was silent for {silence:.1f} of {self.seconds:.1f} s")
        if any(share < 0 or share > 1 for _, share in self.words):
            found.append(f"{self.name} speaks of less than nothing, or of more than all")
        return found


@contextmanager
def watched(
    patch: pytest.MonkeyPatch, kinds: set[type[Any]], clock: Callable[[], float] = time.perf_counter
) -> Iterator[list[Seen]]:
    """Note what every run of these studies says; a study inside of another one is heard as part of it alone."""
    seen: list[Seen] = []
    depth = 0

    def listening(run: Callable[[Any, Bench], Any]) -> Callable[[Any, Bench], Any]:
        def heard(study: Any, bench: Bench) -> Any:
            nonlocal depth
            words: list[tuple[float, float]] = []
            begin = clock()

            def progress(task: str, done: int, total: int) -> None:
                words.append((clock() - begin, done / total if total else 0.0))
                bench.progress(task, done, total)

            depth += 1
            try:
                return run(study, replace(bench, progress=progress))
            finally:
                depth -= 1
                if depth == 0:
                    seen.append(Seen(study.name, clock() - begin, tuple(words)))

        return heard

    with patch.context() as patched:
        for owner in {owner for kind in kinds for owner in kind.__mro__ if "run" in vars(owner)}:
            patched.setattr(owner, "run", listening(vars(owner)["run"]))
        yield seen
