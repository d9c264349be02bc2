"""What became of every row of a file: rows in the file = rows used + rows left out, each with its reason.

A row is a line behind the header that is not blank.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from truing.numbers import counted

MOST_LINES = 8
"""How many lines are named for one reason where people read; files of data hold all."""
MOST_REASONS = 12
"""How many reasons are named where people read."""


@dataclass(frozen=True)
class LeftOut:
    """Rows that are not used, all for one reason (a clause: "begins with '#'"), and the lines they stand in."""

    reason: str
    lines: tuple[int, ...]


@dataclass(frozen=True)
class RowCount:
    """The rows of one file: how many it holds, and which are left out."""

    file: str
    in_file: int
    left_out: tuple[LeftOut, ...] = ()

    @property
    def unused(self) -> int:
        """Rows that are left out."""
        return sum(len(item.lines) for item in self.left_out)

    @property
    def used(self) -> int:
        """Rows that are not left out."""
        return self.in_file - self.unused

    def without(self, reason: str, lines: Iterable[int]) -> RowCount:
        """Return the count with further rows left out, joined to those that are left out for the same reason."""
        taken = tuple(int(line) for line in lines)
        if not taken:
            return self
        before = {item.reason: item.lines for item in self.left_out}
        found = {**before, reason: tuple(sorted((*before.get(reason, ()), *taken)))}
        return replace(self, left_out=tuple(LeftOut(*item) for item in found.items()))

    def without_all(self, lines: Mapping[str, Iterable[int]]) -> RowCount:
        """Return the count with rows left out for several reasons."""
        count = self
        for reason, taken in lines.items():
            count = count.without(reason, taken)
        return count

    def sentence(self) -> str:
        """Say how many rows there are, and what became of those that are left out: "5 rows, 4 used; left out: ..."."""
        rows = counted(self.in_file)
        if not self.left_out:
            return f"{rows}, all used"
        named = [f"{_where(item.lines)} ({item.reason})" for item in self.left_out[:MOST_REASONS]]
        more = sum(len(item.lines) for item in self.left_out[MOST_REASONS:])
        named += [f"{more} more for other reasons"] if more else []
        return f"{rows}, {self.used} used; {self.unused} left out: {', '.join(named)}"

    def as_json(self) -> dict[str, Any]:
        """Return the count as data."""
        left = [{"reason": item.reason, "lines": list(item.lines)} for item in self.left_out]
        return {"in_file": self.in_file, "used": self.used, "left_out": left}


def _where(lines: tuple[int, ...]) -> str:
    more = f" and {len(lines) - MOST_LINES} more" if len(lines) > MOST_LINES else ""
    return f"line{'' if len(lines) == 1 else 's'} {', '.join(map(str, lines[:MOST_LINES]))}{more}"


UNCOUNTED = RowCount("", 0)
"""The count of rows that come from no file."""
