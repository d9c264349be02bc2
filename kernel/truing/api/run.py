"""A run as a user has it: results with units, checks, a table, the sheet, the folder."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from truing.api.quantities import quantity_of
from truing.api.tables import frame_of
from truing.atomic import write_files
from truing.calculation import Calculation
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.kernel import Offer
from truing.numbers import format_value, with_unit
from truing.report.render import html_of, markdown_of
from truing.report.run import sheet_of, write_calculation
from truing.runs.folder import demand_place
from truing.setup import Setup
from truing.studies.bench import Outcome
from truing.studies.checks import HEADLINES, SHORT, Check, State
from truing.studies.verdicts import sentence_of
from truing.units import from_si


@dataclass(frozen=True)
class Run:
    """A finished run; nothing of it is written until ``sheet`` or ``save`` is asked.

    ``run["stress"]`` is a quantity of pint in the unit that the sheet prints, ``run.si["stress"]`` the bare number or
    array in SI. ``checks`` are the limits, ``verdict`` the worst state of them, ``outcomes`` those of the studies.
    """

    offer: Offer
    calculation: Calculation
    started: float

    def __getitem__(self, name: str) -> Any:
        """Return a result as a quantity of pint in its print unit. Raises UsageError where there is none."""
        self._demand(name)
        return quantity_of(self.si[name], self._setup.print_unit(name))

    @property
    def si(self) -> Mapping[str, Any]:
        """Every result by name, SI: numbers, or arrays along an axis."""
        return self.calculation.answers

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every limit with its state and margin."""
        return self.calculation.checks

    @property
    def verdict(self) -> State:
        """The worst state of all checks: "passes", "proposed" (not as stated), "undecided" or "fails"."""
        return self.calculation.verdict

    @property
    def passed(self) -> bool:
        """Whether every limit is kept by the design as stated."""
        return self.verdict == "passes"

    @property
    def outcomes(self) -> Mapping[str, Outcome]:
        """What the studies found, by name of the study."""
        return self.calculation.outcomes

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the run has to say beside its results."""
        return self.calculation.warnings

    def frame(self) -> Any:
        """Return the results that are single numbers as a dataframe: name, symbol, value, unit, note.

        Values are in the unit that is printed. The dataframe is of pandas, polars or pyarrow, whichever is installed.
        """
        rows = list(self._rows())
        return frame_of({name: [row[name] for row in rows] for name in ("name", "symbol", "value", "unit", "note")})

    def sheet(self, path: str | Path) -> Path:
        """Write the calculation sheet: HTML, or Markdown where the name ends in ``.md``."""
        file = Path(path)
        sheet = sheet_of(self.calculation, self.offer, started=self.started)
        write_files({file: markdown_of(sheet) if file.suffix == ".md" else html_of(sheet)})
        return file

    def save(self, folder: str | Path) -> Path:
        """Write the folder that ``calc run`` writes: inputs, results, sheets, arrays; an earlier run there goes."""
        place = Path(folder)
        demand_place(place)
        write_calculation(place, self.calculation, self.offer, started=self.started)
        return place

    def _repr_html_(self) -> str:
        """Show the verdict, the checks and the results; inert and self-contained."""
        head = f"{HEADLINES[self.verdict]}. {sentence_of(self.calculation.decided)}" if self.checks else ""
        checks = [(check.compared or check.name, SHORT[check.state]) for check in self.checks]
        results = [(row["name"], row["symbol"], row["text"]) for row in self._rows()]
        parts = [f"<h4>{escape(self._setup.model.title)}</h4>", f"<p>{escape(head)}</p>" if head else ""]
        return "".join([*parts, html_table(checks) if checks else "", html_table(results)])

    @property
    def _setup(self) -> Setup:
        return self.calculation.setup

    def _rows(self) -> Iterator[dict[str, Any]]:
        fields = self._setup.model.result_fields
        for name, value in self.si.items():
            if getattr(value, "ndim", 0) or name not in fields:
                continue
            unit, item = self._setup.print_unit(name), fields[name]
            number, printed = format_value(value, unit)
            yield {
                "name": name, "symbol": item.symbol, "value": float(from_si(value, unit)), "unit": unit,
                "note": item.spec.note, "text": with_unit(number, printed),
            }  # fmt: skip

    def _demand(self, name: str) -> None:
        if name not in self.si:
            raise UsageError(f"{self.offer.name} has no result '{name}'.{near_miss(name, list(self.si))}")


def html_table(rows: Iterable[Sequence[str]]) -> str:
    """Write rows as a table of HTML, every cell escaped."""
    lines = ("".join(f"<td>{escape(str(cell))}</td>" for cell in row) for row in rows)
    return "<table>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"
