"""A record of a generator of ours, and what the kit says to it, whatever the plugin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from hidden_effects.rig_cases import RigCase
from hidden_effects.rows import Array
from truing import Kernel, Model
from truing.measurements import table_text
from truing.testing import Hidden, recorded
from truing.testing.hiding import Answered
from truing.units import from_si


@cache
def model_of(plugin: str) -> Model[Any, Any]:
    """The model of a plugin as installed."""
    return Kernel.installed().offer(plugin).model


@dataclass(frozen=True, kw_only=True)
class Rig:
    """A plugin with the text of its inputs file, and the columns of a record and of its readings with their units."""

    plugin: str
    inputs: str
    written: Mapping[str, str]
    measured: Mapping[str, str]

    def record(self, case: RigCase) -> Hidden:
        """The record as the kit takes it."""
        measured, held = self._table(case.rows, case.readings), self._table(case.held, case.held_readings)
        return recorded(model_of(self.plugin), inputs=self.inputs, measured=measured, held_out=held)

    def diagnosed(self, case: RigCase) -> Answered:
        """Ask for a diagnosis of the record; rows that were held out are predicted in the units of the file."""
        said = self.record(case).answered
        predicted = {name: np.asarray(from_si(values, self.measured[name])) for name, values in said.predicted.items()}
        return replace(said, predicted=predicted)

    def _table(self, rows: Any, readings: Mapping[str, Array]) -> str:
        """The rows as CSV with units in the header, every digit kept."""
        columns = {f"{name} [{unit}]": getattr(rows, name) for name, unit in self.written.items()}
        columns |= {f"{name} [{self.measured[name]}]": values for name, values in readings.items()}
        return table_text(list(columns), list(columns.values()))


def demand_named(
    document: Mapping[str, Any],
    curves: Sequence[set[str]],
    *,
    may_hold_more: bool = False,
    may_be_unknown: bool = False,
) -> None:
    """Ask that no explanation is left but these causes, each by any name of its curve; else these and something more.

    What autocorrelated or uneven noise leaves may draw something small beside a cause: then more than the one is left,
    but nothing in its place. Few rows along one axis may also be drawn by a shape that nobody registered.
    """
    explanations = [set(names) for names in document["explanations"]]
    assert document["verdict"] == ("named" if len(explanations) == 1 else "one_of")
    for names in explanations:
        if may_be_unknown and all(name.startswith("unknown") for name in names):
            continue
        assert all(names & curve for curve in curves), names
        assert may_hold_more or len(names) == len(curves), names
