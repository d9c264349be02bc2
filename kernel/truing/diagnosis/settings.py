"""The settings at which a machine could be measured next: the box of what can be set, and points in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.machine import Calibration
from truing.diagnosis.points import evenly
from truing.diagnosis.records import Covariate
from truing.diagnosis.tidying import is_angle
from truing.measurements import RowsFile
from truing.units import to_si

TRIED, FEW = 512, 32
"""So many points inside of the box are tried, and so many corners; few where calls of the model are dear."""
FEW_VALUES = 3
"""A column of so few values has no values between them: it is set to one of these."""


def settings_of(machine: Calibration, tried: int = TRIED) -> dict[str, Matrix]:
    """Return the settings that are tried, by input or condition, SI: so many corners of the box and points in it."""
    covariates = machine.records.covariates
    ranges = ((name, _box(machine, name, covariate)) for name, covariate in covariates.items())
    boxes = {name: box for name, box in ranges if box is not None and box[1] > box[0]}
    if not boxes:
        return {}
    unit = evenly(len(boxes), tried)
    edges = np.random.Generator(np.random.SFC64(0)).integers(0, 3, size=(tried, len(boxes))) / 2
    every = np.concatenate([unit, edges])
    settings = {}
    for column, (name, (low, high)) in enumerate(boxes.items()):
        values = low + (high - low) * every[:, column]
        measured = covariates[name].values
        if len(np.unique(measured[np.isfinite(measured)])) <= FEW_VALUES:
            values = np.where(every[:, column] < 0.5, low, high)
        settings[name] = values
    return settings


def _box(machine: Calibration, name: str, covariate: Covariate) -> tuple[float, float] | None:
    """Return the range in which something can be set: asked for, declared, or half as wide again as measured."""
    start = machine.start
    if name in start.diagnose.box:
        return start.diagnose.box[name]
    condition, field = start.model.known_conditions.get(name), start.model.input_fields.get(name)
    if condition is not None:
        low = np.nanmin(covariate.values) if condition.low is None else to_si(condition.low, condition.unit)
        high = np.nanmax(covariate.values) if condition.high is None else to_si(condition.high, condition.unit)
        return float(low), float(high)
    if field is None or not field.varies:
        return None
    low, high = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
    declared = [getattr(field.spec, key, None) for key in ("at_least", "above", "at_most", "below")]
    lows = [float(to_si(value, field.unit)) for value in declared[:2] if isinstance(value, (int, float))]
    highs = [float(to_si(value, field.unit)) for value in declared[2:] if isinstance(value, (int, float))]
    if is_angle(field.unit) and not lows and not highs:
        return min(low, -pi), max(high, pi)
    reach = (high - low) / 2
    lows += [min(low, 0.0)] if covariate.role == "time" else []
    return max([low - reach, *lows]), min([high + reach, *highs])


def machine_there(machine: Calibration, settings: Mapping[str, Matrix]) -> Calibration:
    """Return the machine at the settings that are tried; what is not set has the middle of what was measured."""
    count = len(next(iter(settings.values())))
    columns = {
        name: np.full(count, np.nanmedian(values))
        for name, values in machine.records.rows.columns.items()
        if isinstance(values, np.ndarray) and values.dtype.kind == "f"
    }
    known = machine.records.covariates
    records = replace(
        machine.records.part(np.zeros(count, dtype=np.intp)),
        rows=RowsFile("", columns | dict(settings), {}, {}, tuple(range(count))),
        covariates={name: replace(known[name], values=values) for name, values in settings.items()},
    )
    return replace(machine, records=records, base={}, slopes={})
