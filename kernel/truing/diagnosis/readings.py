"""Columns of the kernel's own effects, from what the gauge shows already: the model is not called for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from truing.declare.sources import Unknown
from truing.diagnosis.machine import Machine

if TYPE_CHECKING:
    from truing.diagnosis.candidates import Candidate, Curve


def reading_curve(machine: Machine, candidate: Candidate, unknown: Unknown, shape: Mapping[str, float]) -> Curve | None:
    """Return the derivative of every measured result by an amplitude of a built-in effect, or None for other effects.

    Built-in effects act last and are linear in their amplitudes, so this is what evaluating them would give.
    """
    import numpy as np

    from truing.diagnosis.candidates import gauged

    if not candidate.is_kernel:
        return None
    result = gauged(candidate, machine.records.measured)
    curve = {name: np.zeros(len(machine.records)) for name in machine.records.measured}
    curve[result] = _read(machine, candidate, unknown, shape, result=result)
    return curve


def _read(machine: Machine, candidate: Candidate, unknown: Unknown, shape: Mapping[str, float], *, result: str) -> Any:
    import numpy as np

    kind = candidate.name.partition("_of_")[0]
    if kind == "sensor_offset":
        return np.ones(len(machine.records))
    if kind == "sensor_gain":
        return machine.base[result]
    covariate, zero = covariate_of(machine, candidate)
    if kind in {"sensor_drift", "thermal_drift"}:
        return covariate - zero
    if kind == "step":
        return (covariate >= next(iter(shape.values()))).astype(float)
    order = next(iter(shape.values()))
    return np.cos(order * covariate) if unknown.name.endswith("_cosine") else np.sin(order * covariate)


def covariate_of(machine: Machine, candidate: Candidate) -> tuple[Any, float]:
    """Return what a built-in effect follows, one value per row in SI, and the reference at which it vanishes."""
    import numpy as np

    from truing.declare.builtin import followed

    name, zero = followed(machine.start.model, candidate.name)
    values = machine.records.rows.columns.get(name)
    if values is None:
        values = machine.records.rows.axes.get(name, machine.records.rows.series.get(name))
    held = machine.start.nominal(name) if values is None else values
    return np.broadcast_to(np.asarray(held, dtype=float), (len(machine.records),)), zero
