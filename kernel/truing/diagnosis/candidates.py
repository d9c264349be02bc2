"""Candidate causes: every effect, the model's own and the kernel's, as columns that the residual is explained with.

An effect is linear in its amplitudes near zero; its shapes are put on a grid, one term per value. Coefficients are
dimensionless: a column has root mean square 1 in units of the noise, and ``per`` is the amplitude it stands for.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from truing.declare.builtin import may_stand
from truing.declare.sources import Effect, Unknown
from truing.diagnosis.columns import Values, stored
from truing.diagnosis.machine import Machine, predict
from truing.diagnosis.readings import gauged, reading_curve, reading_of
from truing.diagnosis.tidying import is_angle
from truing.gauge import read_by_gauge
from truing.setup import SwitchedOn
from truing.units import to_si

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

STEP = 1e-3
LONG = 50_000
KINK = 0.01
FLAT = 1e-12

Curve = Mapping[str, "NDArray[np.float64]"]


@dataclass(frozen=True)
class Candidate:
    """One cause that is looked for: an effect, or the part of it that acts alone. ``order`` is that of declaration."""

    name: str
    effect: Effect[Any, Any]
    amplitudes: tuple[Unknown, ...]
    shapes: tuple[Unknown, ...]
    is_kernel: bool
    order: int

    @property
    def weakest_first(self) -> tuple[int, bool, int]:
        """Which of several names for one curve is taken: fewest unknowns, the kernel's, the first declared."""
        return len(self.amplitudes) + len(self.shapes), not self.is_kernel, self.order


@dataclass(frozen=True)
class Term:
    """One variant of a candidate: its columns, with the amplitude each stands for per unit of coefficient (SI).

    ``unknowns`` and ``files`` say which amplitude of which file (-1: of all) a column belongs to; ``low`` and ``high``
    bound its coefficient. ``size`` counts the parameters, gridded shapes too. ``at`` is the amplitude (SI) whose chord
    the curve is; 0 for the slope at zero.
    """

    candidate: int
    curves: tuple[Mapping[str, Values], ...]
    unknowns: tuple[str, ...]
    files: tuple[int, ...]
    per: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    shape: Mapping[str, float]
    at: float = 0.0

    @property
    def size(self) -> int:
        """Number of free parameters."""
        return len(self.curves) + len(self.shape)


def si_bounds(unknown: Unknown) -> tuple[float, float]:
    """Return the bounds of an unknown in SI."""
    return float(to_si(unknown.low, unknown.unit)), float(to_si(unknown.high, unknown.unit))


def candidates_of(machine: Machine) -> list[Candidate]:
    """Return everything that could be looked for: effects in the order of declaration, the kernel's last.

    Effects, and parts of effects, that are on already are part of the model; an effect whose conditions nobody measured
    is left out.
    """
    model, on = machine.start.model, {item.effect.name: item.values for item in machine.start.effects}
    found: list[Candidate] = []
    for order, effect in enumerate(model.known_effects.values()):
        if any(need.name in machine.records.absent for need in effect.needs):
            continue
        for part in effect.parts or (tuple(unknown.name for unknown in effect.unknowns),):
            if set(part) & set(on.get(effect.name, ())):
                continue
            unknowns = [unknown for unknown in effect.unknowns if unknown.name in part]
            amplitudes = tuple(unknown for unknown in unknowns if unknown.is_amplitude)
            shapes = tuple(unknown for unknown in unknowns if not unknown.is_amplitude)
            own = effect.name in model.effects
            found.append(Candidate(effect.name, effect, amplitudes, shapes, is_kernel=not own, order=order))
    return [item for item in found if not item.is_kernel or _is_offered(item, machine)]


def _is_offered(candidate: Candidate, machine: Machine) -> bool:
    """Whether an effect of the kernel makes sense here: its result is measured, and what is to turn goes round."""
    covariates = machine.records.covariates
    if not gauged(candidate, machine.records.measured):
        return False
    own = [covariates[name] for name in candidate.effect.reads if name in covariates]
    return not may_stand(candidate.effect) or any(not is_angle(item.unit) or item.goes_round for item in own)


def curve_at(
    machine: Machine, candidate: Candidate, amplitudes: Mapping[str, float], shape: Mapping[str, float]
) -> Curve:
    """Return the exact change of every measured result by an effect with these unknowns, SI, shape (n,)."""
    on = _switched_on(machine, candidate, {**shape, **amplitudes})
    changed = predict(machine.start.with_effects([on]), machine.records)
    return {name: changed[name] - machine.base[name] for name in machine.records.measured}


def _switched_on(machine: Machine, candidate: Candidate, stated: Mapping[str, float]) -> SwitchedOn:
    """Return an effect with some of its unknowns; the others are at rest, or as they are in the model already."""
    before = next((item.values for item in machine.start.effects if item.effect.name == candidate.name), {})
    values = {unknown.name: _rest(unknown) for unknown in candidate.effect.unknowns if unknown.name not in before}
    return SwitchedOn(candidate.effect, {**values, **stated})


def works(machine: Machine, curve: Curve) -> bool:
    """Whether the model does not fail with an effect in any row that was measured."""
    import numpy as np

    measured = machine.records.measured
    known = {name: np.isfinite(machine.base[name]) & np.isfinite(values) for name, values in measured.items()}
    return all(bool(np.isfinite(np.asarray(values)[known[name]]).all()) for name, values in curve.items())


def failure_of(machine: Machine, candidate: Candidate) -> str:
    """Return why the model fails with an effect that is hardly there, in some row that was measured; else nothing."""
    import numpy as np

    if reading_of(candidate.effect) is not None or stands_still(candidate, machine):
        return ""
    shape = {unknown.name: si_bounds(unknown)[0] for unknown in candidate.shapes}
    measured = np.logical_or.reduce([np.isfinite(values) for values in machine.records.measured.values()])
    for unknown in candidate.amplitudes:
        for end in si_bounds(unknown):
            setup = machine.start.with_effects([_switched_on(machine, candidate, {**shape, unknown.name: STEP * end})])
            reasons = read_by_gauge(setup, machine.records.rows, tuple(machine.records.measured)).reasons if end else {}
            row = next((row for row in sorted(reasons) if measured[row]), None)
            if row is not None:
                records = machine.records
                place = f"{PurePath(records.files[records.file_of[row]]).name}:{records.lines[row]}"
                return f"the model fails with it, in {place} as the first row: {reasons[row]}"
    return ""


def chord_at(machine: Machine, candidate: Candidate, size: float, shape: Mapping[str, float]) -> Curve:
    """Return the change by an effect whose one amplitude has this size, per unit of it, SI."""
    change = curve_at(machine, candidate, {candidate.amplitudes[0].name: size}, shape)
    return {name: values / size for name, values in change.items()}


def _rest(unknown: Unknown) -> float:
    """Return the value of an unknown that is not looked at: no amplitude, any shape."""
    return 0.0 if unknown.is_amplitude else si_bounds(unknown)[0]


def stands_still(candidate: Candidate, machine: Machine) -> bool:
    """Whether nothing that the effect follows has moved; one that acts at the references follows nothing."""
    if candidate.effect.acts_at_reference:
        return False
    covariates = machine.records.covariates
    names = [*(need.name for need in candidate.effect.needs), *candidate.effect.reads]
    return bool(names) and all(name not in covariates or covariates[name].is_constant for name in names)


def stacked(curve: Mapping[str, Values], scales: Mapping[str, float]) -> NDArray[np.float64]:
    """Return a curve of all results one below the other, in units of the noise."""
    import numpy as np

    return np.concatenate([np.nan_to_num(np.asarray(curve[name])) / scales[name] for name in scales])


def variants_of(
    place: int, candidate: Candidate, machine: Machine, shape: Mapping[str, float], scales: Mapping[str, float]
) -> list[Term]:
    """Return the terms of one shape: one, or two where an amplitude acts otherwise upward than downward."""
    every = [_sides(machine, candidate, unknown, shape) for unknown in candidate.amplitudes]
    sided = [[curve for curve in curves if works(machine, curve)] for curves in every]
    if not all(sided):
        return []
    bounds = [si_bounds(unknown) for unknown in candidate.amplitudes]
    names = [unknown.name for unknown in candidate.amplitudes]
    if len(sided) == 1 and len(sided[0]) == 2:
        up, down = sided[0]
        halves = [([up], [(0.0, bounds[0][1])]), ([down], [(bounds[0][0], 0.0)])]
    else:
        halves = [([curves[0] for curves in sided], bounds)]
    splits = [_files(machine, candidate, name) for name in names]
    found: list[Term] = []
    for curves, limits in halves:
        columns = [
            TermColumn(_of_file(curve, file, machine), name, file, low, high)
            for curve, name, (low, high), files in zip(curves, names, limits, splits, strict=True)
            for file in files
        ]
        found += made_term(place, columns, shape, scales)
    return found


def _files(machine: Machine, candidate: Candidate, unknown: str) -> Sequence[int]:
    """Return the numbers of the files that an unknown is fitted for one by one; -1 stands for all of them."""
    per_file = set(machine.start.diagnose.per_file)
    is_split = bool(per_file & {candidate.name, f"{candidate.name}.{unknown}"})
    return range(len(machine.records.files)) if is_split and len(machine.records.files) > 1 else (-1,)


def _sides(machine: Machine, candidate: Candidate, unknown: Unknown, shape: Mapping[str, float]) -> list[Curve]:
    """Return the derivative by an amplitude at zero; upward and downward where there is a kink."""
    known = reading_curve(machine, candidate, unknown, shape)
    if known is not None:
        return [known]
    low, high = si_bounds(unknown)
    step = STEP * max(-low, high)
    up = _slope(machine, candidate, unknown, shape, step) if high > 0 else None
    down = _slope(machine, candidate, unknown, shape, -step) if low < 0 else None
    if up is not None and down is not None and works(machine, up) is not works(machine, down):
        return [up if works(machine, up) else down]
    if up is None or down is None:
        return [up or down or {}]
    if not _differ(up, down):
        return [{name: (up[name] + down[name]) / 2 for name in up}]
    nearer = [_slope(machine, candidate, unknown, shape, sign * step / 10) for sign in (1, -1)]
    if not _differ(nearer[0], nearer[1]):
        return [{name: (nearer[0][name] + nearer[1][name]) / 2 for name in up}]
    return [up, down]


def _slope(
    machine: Machine, candidate: Candidate, unknown: Unknown, shape: Mapping[str, float], step: float
) -> dict[str, NDArray[np.float64]]:
    change = curve_at(machine, candidate, {unknown.name: step}, shape)
    return {name: values / step for name, values in change.items()}


def _differ(up: Curve, down: Curve) -> bool:
    """Tell whether the two one-sided derivatives are not the same."""
    import numpy as np

    for name in up:
        size = max(np.nanmax(np.abs(up[name]), initial=0.0), np.nanmax(np.abs(down[name]), initial=0.0))
        if size > 0 and np.nanmax(np.abs(up[name] - down[name])) > KINK * size:
            return True
    return False


def new_curves(machine: Machine, candidate: Candidate, term: Term) -> list[Curve]:
    """Return the curves of a term on other rows than it was made for, at the same shape, SI per amplitude."""
    found: list[Curve] = []
    if term.at:
        return [chord_at(machine, candidate, term.at, term.shape)]
    for name, low in zip(term.unknowns, term.low, strict=True):
        unknown = next(each for each in candidate.amplitudes if each.name == name)
        sides = _sides(machine, candidate, unknown, term.shape)
        downward = len(sides) > 1 and low < 0
        found.append(sides[1] if downward else sides[0])
    return found


@dataclass(frozen=True)
class TermColumn:
    """One column of a term: its curve per unit of the amplitude, whose it is, and the bounds of that, SI."""

    curve: Curve
    unknown: str
    file: int
    low: float
    high: float


def _of_file(curve: Curve, file: int, machine: Machine) -> Curve:
    import numpy as np

    if file < 0:
        return curve
    return {name: np.where(machine.records.file_of == file, values, 0.0) for name, values in curve.items()}


def made_term(
    place: int, columns: Sequence[TermColumn], shape: Mapping[str, float], scales: Mapping[str, float]
) -> list[Term]:
    """Make a term of the columns that are excited and not one another's multiple; none where there are none."""
    import numpy as np

    kept: list[tuple[TermColumn, float]] = []
    seen: list[NDArray[np.float64]] = []
    for column in columns:
        values = stacked(column.curve, scales)
        size = float(np.sqrt(np.mean(values**2)))
        if np.isfinite(size) and size * max(-column.low, column.high) > FLAT and not _depends(values, seen):
            kept.append((column, size))
            seen.append(values / size)
    if not kept:
        return []
    return [
        Term(
            candidate=place,
            curves=tuple({name: stored(values) for name, values in column.curve.items()} for column, _ in kept),
            unknowns=tuple(column.unknown for column, _ in kept),
            files=tuple(column.file for column, _ in kept),
            per=tuple(1 / size for _, size in kept),
            low=tuple(column.low * size for column, size in kept),
            high=tuple(column.high * size for column, size in kept),
            shape=dict(shape),
        )
    ]


def _depends(values: NDArray[np.float64], kept: Iterable[NDArray[np.float64]]) -> bool:
    """Tell whether a column is, on this data, a combination of the others (less than 1 % of it is its own)."""
    import numpy as np

    others = list(kept)
    if not others:
        return False
    basis = np.linalg.qr(np.column_stack(others))[0]
    rest = values - basis @ (basis.T @ values)
    return float(rest @ rest) < 1e-4 * float(values @ values)
