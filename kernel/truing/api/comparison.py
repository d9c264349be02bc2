"""What differs between two runs, or two diagnoses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from truing.api.notebook import html_table, paragraphs
from truing.api.tables import frame_of
from truing.runs.change_words import words_of
from truing.runs.comparison import Change, compared, in_order

COLUMNS = ("what", "name", "before", "after", "change")


@dataclass(frozen=True)
class Differences:
    """What differs between two runs, or two diagnoses: checks of another state first. False where nothing does."""

    changes: tuple[Change, ...]

    def __repr__(self) -> str:
        return "\n".join("  ".join(words_of(change)) for change in self.changes) or "equal"

    def __bool__(self) -> bool:
        """Whether anything differs."""
        return bool(self.changes)

    def frame(self) -> Any:
        """Return the differences as a dataframe of texts: what, name, before, after, change."""
        rows = [words_of(change) for change in self.changes]
        return frame_of({name: [row[place] for row in rows] for place, name in enumerate(COLUMNS)})

    def _repr_html_(self) -> str:
        rows = [words_of(change) for change in self.changes]
        return html_table(rows, COLUMNS) if rows else paragraphs(["equal"])


def comparison_of(before: Mapping[str, Any], after: Mapping[str, Any]) -> Differences:
    """Compare two documents. Raises UsageError for a run beside a diagnosis."""
    return Differences(tuple(in_order(compared(before, after))))
