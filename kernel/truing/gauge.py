"""What the gauge would show: the results of one machine at every row of a file, readings included."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from truing.declare.fields import with_values
from truing.errors import UsageError
from truing.evaluate import evaluate_rows
from truing.setup import Setup

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Shown:
    """Results by name in the unit they are printed in, shape (rows,), NaN in failed rows; why rows failed."""

    values: Mapping[str, NDArray[np.float64]]
    units: Mapping[str, str]
    reasons: Mapping[int, str]


def one_machine(setup: Setup) -> Setup:
    """Return the setup of this one machine: its calibrated inputs in place, nothing drawn."""
    fields = setup.model.input_fields
    calibrated = {fields[name].path: value for name, value in setup.calibrated.items()}
    return replace(setup, inputs=with_values(setup.inputs, calibrated))


def shown_by_gauge(setup: Setup, columns: Mapping[str, Any], rows: int) -> Shown:
    """Evaluate every row; columns (SI) replace inputs and conditions, and place results along an axis.

    A result along an axis is read at the row's value of that axis (linear between points); without such a column
    it is left out.
    """
    from truing.units import from_si

    machine = one_machine(setup)
    fields = machine.model.own_result_fields
    known = {name: values for name, values in columns.items() if name not in fields}
    found = evaluate_rows(machine, known, rows, reading=True)
    values: dict[str, Any] = {}
    for name, answers in found.results.items():
        if name in columns:
            continue
        along = fields[name].along
        if not along:
            values[name] = answers
        elif along in columns and along != name:
            values[name] = _along(answers, found.results[along], columns[along])
    if not values:
        axes = sorted({item.along for item in fields.values() if item.along})
        raise UsageError(f"every result of {machine.model.name} runs along {' or '.join(axes)}: give that column")
    units = {name: machine.print_unit(name) for name in values}
    return Shown({name: from_si(value, units[name]) for name, value in values.items()}, units, found.reasons)


def _along(answers: NDArray[np.float64], axis: NDArray[np.float64], places: Any) -> NDArray[np.float64]:
    """Read each row's result at that row's place on the axis."""
    import numpy as np

    axis = np.broadcast_to(axis, answers.shape)
    return np.array([np.interp(place, x, y) for place, x, y in zip(places, axis, answers, strict=True)])
