"""Hiding an effect in a record of one's own making, with the truth kept beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.model import Model
from truing.errors import Fault, InputError, TruingError
from truing.gauge import read_by_gauge
from truing.inputs_file import setup_from_settings
from truing.measurements import read_rows, table_text
from truing.setup import Setup
from truing.studies.scatter import generator, scatter_of
from truing.testing.designs import RecordDesign, columns_of
from truing.testing.hidden import MEASURED, Hidden, offer_of
from truing.testing.noises import RecordNoise, noise_of
from truing.testing.planted import Size, Strange, check_by, effect_of, truth_of, wrong_machine
from truing.testing.subject import Subject
from truing.units import difference_unit, from_si, unit_factor

HELD_OUT = 200


def hide(
    effect: str | None, size: Size | None = None, noise: Size | None = None, *, model: Model[Any, Any],
    over: Mapping[str, str | Sequence[Any]] | None = None, measure: str | Sequence[str] | None = None,
    rows: int = 60, runs: int = 1, seed: int = 0, by: Strange | None = None,
    settings: Mapping[str, str] | None = None, machine: int | None = None, correlation: float = 0.0,
) -> Hidden:  # fmt: skip
    """Make a measured record in which an effect is hidden, and further rows that are never fitted.

    ``effect`` is one of the model's or of the kernel's; None hides nothing. ``size`` says its unknowns: ``"4 um"`` of
    the only one, else ``{"extra": "3 um", "length": "200 m"}``; without it amplitudes are half of what their bounds
    allow, shapes in the middle. ``noise`` is the standard deviation of the gauge, in the unit of the measured result or
    in "%" of the span of its readings, or by result. ``measure`` names the results, by default those that ``noise``
    names or fits. ``over`` says what is set from row to row, ``{"load": "10..90 N", "oil": "20, 40, 60 degC"}``, by
    default what the effect needs and what a study sweeps over, or what may be chosen. ``rows`` are those of one run; a
    result along an axis is measured along it. ``settings`` are as with ``--set``. The machine is that of the drawing,
    or one drawn from the tolerances (``machine=7``). ``correlation`` is that of the noise of neighbouring rows. One
    ``seed`` is one record.

    The effect is made by its own function, the very one that the diagnosis tries. That proves that it can be seen under
    this noise, told apart from all others and from the tolerances, and sized; not that it is true to any machine: a
    wrong sign is planted and found alike. For that hand in ``by``, a function of yours from another source (the exact
    geometry, a table), which makes the wrong readings: ``by(inputs, results, **unknowns, **conditions) -> results``, in
    SI, numbers or arrays (n,). With ``effect=None`` it hides what nobody registered.

    Raises InputError with every fault of the call, a sentence each.
    """
    return _hidden(_Wish(
        effect, size, noise, measure, over, rows, runs, seed, by, settings or {}, machine, correlation,
    ), model)  # fmt: skip


@dataclass(frozen=True)
class _Wish:
    """What was asked for."""

    effect: str | None
    size: Size | None
    noise: Size | None
    measure: str | Sequence[str] | None
    over: Mapping[str, str | Sequence[Any]] | None
    rows: int
    runs: int
    seed: int
    by: Strange | None
    settings: Mapping[str, str]
    machine: int | None
    correlation: float


def _hidden(wish: _Wish, model: Model[Any, Any]) -> Hidden:
    """Check everything that was asked for, then draw the record."""
    faults: list[str] = []
    setup = _setup(model, wish.settings, faults)
    effect = effect_of(model, wish.effect, faults)
    noises = noise_of(setup, wish.noise, wish.measure, faults)
    truth = truth_of(effect, wish.size, list(noises), faults)
    check_by(wish.by, effect, model, faults)
    _check_counts(wish, faults)
    columns, wrong = columns_of(setup, effect, list(noises), wish.over)
    _raise(model, [*faults, *wrong])
    design = RecordDesign(tuple(columns), wish.rows, wish.runs)
    off = {} if wish.machine is None else _drawn(setup, wish.machine)
    known = {column.name: setup.nominal(column.name) for column in columns if column.name in model.known_conditions}
    setup = replace(setup, conditions={**setup.conditions, **known})
    plan = _Plan(setup, wrong_machine(setup.changed(off), effect, truth, wish.by), noises, wish.correlation, wish.seed)
    measured, _ = plan.recorded(design, 0)
    held, left = plan.recorded(design if wish.runs > 1 or design.is_record else replace(design, rows=HELD_OUT), 1)
    return Hidden(
        setup=setup, measured=measured, held_out=held, effect=wish.effect, truth=truth, machine=off, noise=left,
        is_strange=effect is None and wish.by is not None,
    )  # fmt: skip


@dataclass(frozen=True)
class _Plan:
    """What is known, what is true, and how it is read off."""

    setup: Setup
    true: Setup
    noises: Mapping[str, RecordNoise]
    correlation: float
    seed: int

    def recorded(self, design: RecordDesign, part: int) -> tuple[str, dict[str, float]]:
        """Return a record as CSV, and the root mean square of the noise in it by result, SI."""
        columns = design.drawn(generator(self.seed, part, "design"))
        true = self._shown(columns)
        left: dict[str, float] = {}
        for name, noise in self.noises.items():
            rng = generator(self.seed, part, f"noise of {name}")
            size = noise.size(true[name])
            added = size * _correlated(rng, design, self.correlation)
            unit = self.setup.print_unit(name)
            step = size / unit_factor(difference_unit(unit)) / 1000
            read = from_si(true[name] + added, unit)
            columns[f"{name} [{unit or '1'}]"] = np.round(read, -math.floor(math.log10(step))) if step else read
            left[name] = float(np.sqrt(np.mean(added**2)))
        return _csv(columns), left

    def _shown(self, columns: Mapping[str, Any]) -> Mapping[str, NDArray[np.float64]]:
        """Return what the gauges would show without noise, SI. Raises InputError where the model has no answer."""
        with TemporaryDirectory() as folder:
            file = Path(folder) / MEASURED
            file.write_text(_csv(columns), encoding="utf-8")
            rows = read_rows(file, offer_of(self.true), self.true)
        found = read_by_gauge(self.true, rows, list(self.noises))
        if found.failed.any():
            row, reason = next(iter(found.reasons.items()))
            at = ", ".join(f"{name} = {values[row]}" for name, values in columns.items())
            many = f"{int(found.failed.sum())} of {len(found)} rows"
            _raise(self.setup.model, [f"the model has no answer in {many}; at {at}: {reason}; narrow the range (over)"])
        return found.results


def _csv(columns: Mapping[str, Any]) -> str:
    return table_text(list(columns), list(columns.values()))


def _correlated(rng: np.random.Generator, design: RecordDesign, correlation: float) -> NDArray[np.float64]:
    """Draw noise of unit variance for every row; that of neighbours in a run is correlated."""
    drawn = rng.standard_normal((design.runs, design.rows))
    for row in range(1, design.rows if correlation else 0):
        drawn[:, row] = correlation * drawn[:, row - 1] + math.sqrt(1 - correlation**2) * drawn[:, row]
    return np.asarray(drawn.ravel())


def _raise(model: Model[Any, Any], faults: Sequence[str]) -> None:
    if faults:
        raise InputError([Fault(f"{model.name}: {sentence}") for sentence in faults])


def _setup(model: Model[Any, Any], settings: Mapping[str, str], faults: list[str]) -> Setup:
    subject = Subject(model)
    if settings:
        try:
            return setup_from_settings(subject.offer, settings)
        except TruingError as error:
            faults.append(str(error))
    return subject.setup


def _check_counts(wish: _Wish, faults: list[str]) -> None:
    for name, count in {"rows": wish.rows, "runs": wish.runs}.items():
        if count < 1:
            faults.append(f"{name} is {count}; at least one")
    if not -1 < wish.correlation < 1:
        faults.append(f"correlation is {wish.correlation:g}; it lies between -1 and 1")


def _drawn(setup: Setup, seed: int) -> dict[str, float]:
    """Draw a machine from the tolerances: its inputs in SI."""
    return {name: float(values[0]) for name, values in scatter_of(setup).draw(seed, 0, 1).items()}
