"""How do the results run along one input? Many points in one batch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.errors import UsageError
from truing.evaluate import acting_inputs, evaluate_rows
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome
from truing.studies.drawings import BLUE, WIDTH, labelled
from truing.studies.reading import printed, read_range, scattering_name, spoken
from truing.units import from_si, unit_text

LARGEST = 1_000_000
ROUNDING = 1e-12
TOGETHER = 2**14
"""How many points one call of the model calculates."""


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """Evaluate every result along one input or condition.

    ``at`` is "low..high unit", divided into ``points`` values, or a list "a, b, c unit".
    """

    over: str
    at: str
    points: int = 181
    name: str = "sweep"
    gives: Callable[[Swept], Any] | None = None

    def __post_init__(self) -> None:
        if not 2 <= self.points <= LARGEST:
            raise UsageError(f"points = {self.points}, but a sweep has 2 to {LARGEST} points")

    def run(self, bench: Bench) -> Swept:
        """Evaluate all points, many at once; an infeasible one keeps its reason. Raises UsageError for a bad range."""
        setup = bench.setup
        over = scattering_name(setup, self.over, self.name)
        axis = _points(setup, over, self.at, self.points)
        done = bench.part(self.name, 0.0, 1.0)
        rows = evaluate_rows(setup, {over: _values(setup, over, axis)}, len(axis), size=TOGETHER, done=done)
        fields = setup.model.own_result_fields
        return Swept(
            name=self.name,
            over=over,
            axis=axis,
            results=rows.results,
            failed=tuple(rows.reasons.items()),
            units={name: setup.print_unit(name) for name in (over, *rows.results)},
            symbols={name: fields[name].symbol or name for name in rows.results},
            shown=self.gives is None,
            inputs=acting_inputs(setup),
        )


def _points(setup: Setup, over: str, at: str, points: int) -> NDArray[np.float64]:
    """Return the points in SI; of an input that takes whole numbers, all between the ends or those listed."""
    axis = read_range(at, setup.unit_of(over), points)
    field = setup.model.input_fields.get(over)
    if field is None or field.kind not in {"integer", "whole"}:
        return axis
    if ".." in at:
        axis = np.arange(np.ceil(axis[0]), np.floor(axis[-1]) + 1)
    if not len(axis) or (axis != np.round(axis)).any():
        raise UsageError(f"'{at}': '{over}' takes whole numbers")
    return axis


def _values(setup: Setup, over: str, axis: NDArray[np.float64]) -> Any:
    field = setup.model.input_fields.get(over)
    return [int(value) for value in axis] if field is not None and field.kind == "integer" else axis


@dataclass(frozen=True, kw_only=True)
class Swept(Outcome):
    """The results along the swept input: ``axis`` (n,) and ``results[name]`` (n,) or (n, k) in SI, NaN where failed.

    ``inputs`` are those of the run, as effects leave them.
    """

    name: str
    over: str
    axis: NDArray[np.float64]
    results: Mapping[str, NDArray[np.float64]]
    failed: tuple[tuple[int, str], ...]
    units: Mapping[str, str]
    symbols: Mapping[str, str]
    shown: bool = True
    inputs: Any = None

    def as_json(self) -> dict[str, Any]:
        """Return the axis and every result in printed units; null where a point failed."""
        return {
            "over": self.over,
            "unit": self.units[self.over],
            "axis": printed(self.axis, self.units[self.over]),
            "results": {
                name: {"unit": self.units[name], "values": printed(values, self.units[name])}
                for name, values in self.results.items()
            },
            "failed": [{"row": row, "reason": reason} for row, reason in self.failed],
        }

    def blocks(self) -> Sequence[Block]:
        """Return smallest and largest value of every result and where they are; curves where no section draws them."""
        blocks: list[Block] = []
        table = self._extremes()
        if table.rows:
            blocks.append(table)
        if self.shown and self.moving():
            blocks.append(Drawing(f"Along the {spoken(self.over)}", curves(self, self.moving()[:4])))
        if self.failed:
            row, reason = self.failed[0]
            count = f"{len(self.failed)} of {len(self.axis)} points have no answer"
            blocks.append(Words(f"{count}; the first is number {row + 1}: {reason}.", "warning"))
        return blocks

    def warnings(self) -> Sequence[str]:
        """Name the points that failed."""
        if not self.failed:
            return ()
        return (
            f"study '{self.name}': {len(self.failed)} of {len(self.axis)} points along '{self.over}' have no answer",
        )

    def _plain(self) -> list[str]:
        """Name the results that are one number per point and finite somewhere."""
        return [name for name, values in self.results.items() if values.ndim == 1 and np.isfinite(values).any()]

    def moving(self) -> list[str]:
        """Name those of them that change by more than rounding."""
        spans = {name: (np.nanmin(self.results[name]), np.nanmax(self.results[name])) for name in self._plain()}
        return [name for name, (low, high) in spans.items() if not high - low <= ROUNDING * max(abs(low), abs(high))]

    def _extremes(self) -> Table:
        unit = self.units[self.over]
        rows: list[list[Any]] = []
        for name in self.moving():
            values = self.results[name]
            row: list[Any] = [name, unit_text(self.units[name])]
            for index in (int(np.nanargmin(values)), int(np.nanargmax(values))):
                row += [float(from_si(values[index], self.units[name])), float(from_si(self.axis[index], unit))]
            rows.append(row)
        columns = ("result", "unit", "smallest", "at", "largest", "at")
        still = len(self._plain()) - len(rows)
        note = f"Of {len(self.axis)} points; nothing is sought between them."
        note += f" {still} other results do not change." if still > 1 else " One other result does not change." * still
        return Table(f"Extremes along the {spoken(self.over)}", columns, rows, ("", "", "", unit, "", unit), note)


def curves(swept: Swept, names: Sequence[str]) -> Callable[[], Figure]:
    """Draw results along the swept input, one below the other."""

    def draw() -> Figure:
        figure = Figure(figsize=(WIDTH, 0.6 + 1.6 * len(names)), layout="constrained")
        panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        x_unit = swept.units[swept.over]
        for panel, name in zip(panels, names, strict=True):
            unit = swept.units[name]
            panel.plot(from_si(swept.axis, x_unit), from_si(swept.results[name], unit), color=BLUE)
            panel.set_ylabel(labelled(name, unit_text(unit)))
            panel.grid(alpha=0.3)
        panels[-1].set_xlabel(labelled(swept.over, unit_text(x_unit)))
        return figure

    return draw
