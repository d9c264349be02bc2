"""What became of every row of a file: rows in the file = rows used + rows left out, each with its reason."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

MOST_LINES = 8
"""How many lines are named for one reason where people read; files of data hold all."""


@dataclass(frozen=True)
class LeftOut:
    """Rows that are not used, all for one reason (a clause: "begins with '#'"), and the lines they stand in."""

    reason: str
    lines: tuple[int, ...]


@dataclass(frozen=True)
class RowCount:
    """The rows of one file: how many it holds, and which are left out. A row is a line behind the header, not blank."""

    file: str
    in_file: int
    left_out: tuple[LeftOut, ...] = ()

    @property
    def used(self) -> int:
        """Rows that are not left out."""
        return self.in_file - sum(len(item.lines) for item in self.left_out)

    def without(self, reason: str, lines: Iterable[int]) -> RowCount:
        """Return the count with further rows left out."""
        taken = tuple(int(line) for line in lines)
        return replace(self, left_out=(*self.left_out, LeftOut(reason, taken))) if taken else self

    def sentences(self) -> list[str]:
        """Say what is left out, one sentence for each reason; nothing where every row is used."""
        if not self.left_out:
            return []
        total = f"{_rows(self.in_file)} in the file, {self.used} used"
        return [
            f"{total}; {_rows(len(item.lines))} left out: {_where(item.lines)}: {item.reason}" for item in self.left_out
        ]


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"


def _where(lines: tuple[int, ...]) -> str:
    more = f" and {len(lines) - MOST_LINES} more" if len(lines) > MOST_LINES else ""
    return f"line{'' if len(lines) == 1 else 's'} {', '.join(map(str, lines[:MOST_LINES]))}{more}"
