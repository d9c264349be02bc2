"""How many calls of the model a search may make: stated, or by how long a call takes; and what was left out for it.

A call is the model on all rows that are searched. The number is stated with ``[studies.diagnose] budget``. Where it is
not, a model that answers at once has none, and a slow one gets what takes some minutes: the time of one call to a
power of ten, so that two machines mostly agree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf, log10
from time import perf_counter

AT_ONCE = 0.03
"""Seconds of a call below which a search needs no budget: it makes a few thousand calls."""
MINUTES = 300.0
"""Seconds that the calls of a search may take where no budget is stated."""
LEAST_PER_EFFECT = 40
"""Calls for every effect on the inputs that are given however long they take: fewer show none of them as it is."""
CURVES = 0.25
"""Share of the calls in which all curves are to be made."""
FEWEST_POINTS = 6
"""At so many points at least an effect is looked at: fewer say nothing about how it bends."""
MORE = 4
"""So many times the budget is proposed where it ended first."""


@dataclass
class Budget:
    """So many calls, of which the present stage of the search may spend up to a share.

    ``takes`` is how long a call takes, in seconds, a power of ten; 0 where the number is stated. ``left_out`` counts
    what was not tried, ``unseen`` names effects that were not looked at.
    """

    calls: float = inf
    takes: float = 0.0
    share: float = 1.0
    left_out: dict[str, int] = field(default_factory=dict)
    unseen: list[str] = field(default_factory=list)

    @property
    def is_dear(self) -> bool:
        """Whether calls are counted at all."""
        return self.calls < inf

    def lasts(self, spent: int) -> bool:
        """Whether the present stage may go on after so many calls."""
        return spent < self.share * self.calls

    def allows(self, spent: int, what: str) -> bool:
        """Whether one thing more may be tried; what may not is counted."""
        if self.lasts(spent):
            return True
        self.left_out[what] = self.left_out.get(what, 0) + 1
        return False

    def points(self, effects: int) -> int | None:
        """Return at how many points each of so many effects may be asked for its curves; None for all there are."""
        if not self.is_dear:
            return None
        return max(FEWEST_POINTS, int(CURVES * self.calls / max(effects, 1)))

    def of_rows(self, ratio: float) -> Budget:
        """Return what the same time allows on so many times as many rows; what it leaves out is told with the rest."""
        return replace(self, calls=max(self.calls / ratio, LEAST_PER_EFFECT), share=1.0)

    def told(self) -> tuple[str, ...]:
        """Say what the budget left out, in one sentence; nothing where it did not end."""
        parts = [f"{what} ({count})" for what, count in self.left_out.items()]
        if self.unseen:
            parts.insert(0, f"any look at {', '.join(dict.fromkeys(self.unseen))}")
        if not parts:
            return ()
        calls = int(self.calls)
        time = f", of which one takes about {self.takes:g} s," if self.takes else ""
        return (
            f"the search ended after {calls} calls of the model{time} and left out: {', '.join(parts)}; another "
            f"explanation may lie there; look further with [studies.diagnose] budget = {MORE * calls}",
        )


def budget_of(stated: int, effects: int, call: Callable[[], object]) -> Budget:
    """Return the stated budget; else, by how long one ``call`` takes, none or one of some minutes."""
    if stated:
        return Budget(stated)
    begin = perf_counter()
    call()
    seconds = perf_counter() - begin
    if seconds < AT_ONCE:
        return Budget()
    takes = 10.0 ** round(log10(seconds))
    return Budget(max(round(MINUTES / takes), LEAST_PER_EFFECT * max(effects, 1)), takes)
