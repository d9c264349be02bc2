"""What a study found, as a user has it: tables, figures, the numbers behind them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from matplotlib.figure import Figure

from truing.api.notebook import MOST_ROWS, fold, heading, joined, paragraphs, picture, plotted, table_html
from truing.api.tables import frame_of
from truing.declare.blocks import Drawing, Table, Words
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.measurements import table_text
from truing.report.chapters import table_view
from truing.studies.bench import Outcome
from truing.studies.sweep import Swept, curves

MOST_CURVES = 6


@dataclass(frozen=True)
class StudyResult:
    """What one study of a run found. ``outcome`` holds its numbers in SI, ``warnings`` what speaks against them.

    ``document`` is what results.json holds, where the study was asked alone.
    """

    title: str
    outcome: Outcome
    warnings: tuple[str, ...] = ()
    document: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        return f"<StudyResult: {self.title}>"

    def frame(self, title: str = "") -> Any:
        """Return a table of the study as a dataframe: the one of this title, or its first.

        Of a sweep without a title: every point with every result that is one number there, units in the names.
        Raises UsageError where there is no such table.
        """
        if isinstance(self.outcome, Swept) and not title:
            return frame_of({name: values.tolist() for name, values in self.outcome.printed_columns().items()})
        tables = {block.title: block for block in self.outcome.blocks() if isinstance(block, Table)}
        table = _chosen(title, tables, "table")
        return frame_of({name: [row[index] for row in table.rows] for index, name in enumerate(_headers(table))})

    def points_text(self) -> str:
        """Return every point of a sweep as the text of a CSV file, its numbers exact; nothing for another study."""
        columns = self.outcome.printed_columns() if isinstance(self.outcome, Swept) else {}
        return table_text([*columns], [*columns.values()]) if columns else ""

    def plot(self, *names: str) -> Figure:
        """Draw the study: of a sweep the results that are named, or those that change; else the figure of that title.

        Without a name it is the first figure. Raises UsageError where there is no such result or figure.
        """
        return plotted(self._drawing(names))

    def _drawing(self, names: tuple[str, ...]) -> Callable[[], Figure]:
        if isinstance(self.outcome, Swept):
            return curves(self.outcome, _moving_results(self.outcome, names))
        drawings = {block.title: block for block in self.outcome.blocks() if isinstance(block, Drawing)}
        drawing: Drawing = _chosen(names[0] if names else "", drawings, "figure")
        return drawing.draw

    def _repr_html_(self) -> str:
        """Show tables, the first figure, and what speaks against them."""
        blocks = [block for block in self.outcome.blocks() if not isinstance(block, Drawing)]
        said = [*self.warnings, *(block.text for block in blocks if isinstance(block, Words))]
        tables = [block for block in blocks if isinstance(block, Table)]
        first, *others = [table_html(table_view(table, MOST_ROWS)) for table in tables] or [""]
        try:
            drawn = picture(self._drawing(()), self.title)
        except UsageError:  # a study need not draw
            drawn = ""
        return joined(heading(self.title), drawn, first, paragraphs(said), fold("more", "".join(others)))


def _chosen(title: str, blocks: dict[str, Any], kind: str) -> Any:
    if not blocks:
        raise UsageError(f"this study has no {kind}")
    if title and title not in blocks:
        raise UsageError(f"this study has no {kind} '{title}'; it has {', '.join(map(repr, blocks))}")
    return blocks[title] if title else next(iter(blocks.values()))


def _headers(table: Table) -> list[str]:
    """Return the names of columns with their units; columns of one name are told apart by a number."""
    units = [*table.units, *[""] * len(table.columns)]
    names = [f"{name} [{unit}]" if unit else name for name, unit in zip(table.columns, units, strict=False)]
    return [name if names.index(name) == index else f"{name} {index + 1}" for index, name in enumerate(names)]


def _moving_results(swept: Swept, names: tuple[str, ...]) -> list[str]:
    """Return the results that are drawn. Raises UsageError for a name that was not swept, and where nothing changes."""
    able = [name for name, values in swept.results.items() if values.ndim == 1]
    for name in names:
        if name not in able:
            raise UsageError(f"'{name}' is no result along '{swept.over}'.{near_miss(name, able)}")
    moving = list(names) or swept.moving()[:MOST_CURVES]
    if not moving:
        raise UsageError(f"no result changes along '{swept.over}'; name those to draw")
    return moving
