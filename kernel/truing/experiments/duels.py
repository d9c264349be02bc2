"""Explanations against one another: what one of them gets wrong at settings that were not measured yet.

Every explanation is believed in turn while its rival refits to everything so far; an experiment is worth what the rival
then still gets wrong (T-optimal design: A. C. Atkinson, V. V. Fedorov, Biometrika 62, 1975, 57). The raw distance of
two predictions would be the wrong criterion. The rival refits by its derivatives at its own exact fit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.exact import slopes_at, unit_of
from truing.diagnosis.extended import Extended, parts_of
from truing.diagnosis.fitted import STEP, WIDE, Fit, moved_by
from truing.diagnosis.intervals import numbers_of
from truing.diagnosis.machine import Calibration
from truing.measurements import RowsFile

UNSEEN = 1e-9
"""Share of its own precision, or of one over its range squared, that is added to that of every number."""


@dataclass(frozen=True)
class Explained:
    """An explanation on the record: its inverse normal matrix (p, p), its free numbers first, then the inputs.

    ``root`` is upper triangular: its transpose times itself is the normal matrix. ``design`` (rows, p) and ``left``
    (rows,) are weighted as the noise asks; both have no rows where there is no record. ``free`` marks the numbers that
    are fitted; all is in units as the fit sees them.
    """

    fit: Fit
    free: Matrix
    design: Matrix
    left: Matrix
    root: Matrix
    inverse: Matrix

    @property
    def at(self) -> Matrix:
        """Where its coefficients are: moves of its numbers, so 0, and the inputs themselves."""
        k = len(self.fit.inputs)
        return np.concatenate([np.zeros(self.design.shape[1] - k), self.fit.inputs])


@dataclass(frozen=True)
class There:
    """What an explanation says at settings that are tried: of the results (R, T), SI, and its derivatives (R, T, p)."""

    shown: Matrix
    slopes: Matrix


def explained(fit: Fit, extended: Extended, roots: Matrix, *, has_record: bool) -> Explained:
    """Return an explanation with what the record says of it; of an experiment without a record, nothing."""
    k = len(fit.inputs)
    free = np.array([number.is_free for number in numbers_of(fit)], dtype=bool)
    if has_record:
        own, inputs = slopes_at(fit, extended)
        design, left = np.column_stack([own[:, free], inputs]) * roots[:, None], fit.left * roots
    else:
        design, left = np.zeros((0, int(free.sum()) + k)), np.zeros(0)
    normal = design.T @ design
    normal += np.diag([0.0] * (len(normal) - k) + [1.0] * k) + UNSEEN * np.diag(np.maximum(np.diag(normal), 1.0))
    root, inverse = (
        np.asarray(each, dtype=np.float64) for each in (np.linalg.cholesky(normal).T, np.linalg.inv(normal))
    )
    return Explained(fit, free, design, left, root, inverse)


def there(of: Explained, tried: Extended) -> There:
    """Return what an explanation predicts at the settings that are tried, and how that changes."""
    fit = of.fit
    numbers, sample, k, units = numbers_of(fit), fit.sample, len(fit.inputs), unit_of(fit)
    flat = np.concatenate(fit.values)
    steps = (WIDE if tried.grain else STEP) * np.maximum(np.abs(flat), 1e-2 * np.abs(units))
    steps = np.where(flat + steps > [number.high for number in numbers], -steps, steps)
    moves = np.diag([step if number.is_free else 0.0 for step, number in zip(steps, numbers, strict=True)])
    points = [(parts_of(fit.causes, flat + move), fit.moved) for move in (np.zeros(len(flat)), *moves)]
    for half in 0.5 * np.eye(k):
        points += [(list(fit.values), moved_by(sample, fit.inputs + sign * half)) for sign in (1, -1)]
    names = [channel.name for channel in sample.channels]
    base, *moved = np.array([[shown[name] for name in names] for shown in tried.at(fit.causes, points)])
    rises, ups, downs = moved[: len(flat)], moved[len(flat) :: 2], moved[len(flat) + 1 :: 2]
    slopes = [(each - base) * unit / step for each, unit, step in zip(rises, units, steps, strict=True)]
    slopes += [up - down for up, down in zip(ups, downs, strict=True)]
    return There(base, np.stack(slopes, axis=-1)[..., np.append(of.free, np.ones(k, dtype=bool))])


def machine_there(machine: Calibration, settings: dict[str, Matrix], readings: int) -> Calibration:
    """Return the machine at the settings that are tried, each experiment a run of its own, after the last file.

    What is not set has the middle of what was measured, a word the last one.
    """
    count = len(next(iter(settings.values())))
    columns = {
        name: np.full(count, np.nanmedian(values))
        for name, values in machine.records.rows.columns.items()
        if isinstance(values, np.ndarray) and values.dtype.kind == "f"
    }
    words = {
        name: values[-1:] * count for name, values in machine.records.rows.columns.items() if isinstance(values, list)
    }
    known = machine.records.covariates
    part = machine.records.part(np.zeros(count, dtype=np.intp))
    run_of = np.repeat(np.arange(count // readings), readings)
    records = replace(
        part,
        rows=RowsFile(
            "", columns | words | settings, {}, {}, tuple(range(count)), runs=tuple(map(str, run_of.tolist()))
        ),
        file_of=np.full(count, machine.records.file_of.max(initial=0)),
        run_of=run_of,
        held_out=np.zeros(count, dtype=bool),
        measured={name: np.zeros(count) for name in part.measured},
        sides={},
        covariates={name: replace(known[name], values=values) for name, values in settings.items() if name in known},
    )
    return replace(machine, records=records, base={}, slopes={})


@dataclass(frozen=True)
class Duel:
    """One explanation believed, a rival refitted to it, over experiments of so many readings each.

    ``separation`` is theirs on the record. ``left`` (E, m) is what the rival gets wrong in every experiment before it
    is fitted to it, ``rows`` (E, m, p) its derivatives there, both in units of the noise of one value; NaN where a
    model fails.
    """

    names: tuple[str, str]
    separation: float
    left: Matrix
    rows: Matrix
    root: Matrix

    def after(self, times: float) -> Matrix:
        """Return the separation once every experiment is done, each reading so many times, (E,); 0 where one fails.

        The rival is left with what a fit to the readings leaves that pays for its moves as the record asks.
        """
        is_known = np.asarray(np.isfinite(self.left).all(axis=1) & np.isfinite(self.rows).all(axis=(1, 2)))
        rows, left = np.where(is_known[:, None, None], self.rows, 0.0), np.where(is_known[:, None], self.left, 0.0)
        wanted = left[..., None] * times**0.5
        reached = reached_by(rows * times**0.5, self.root)
        still = np.sum((wanted - reached @ (reached.swapaxes(1, 2) @ wanted)) * wanted, axis=(1, 2))
        return np.asarray(np.where(is_known, self.separation + still, 0.0))

    def up_to(self, values: int) -> float:
        """Return the separation after the first values of the first experiment."""
        return float(replace(self, left=self.left[:1, :values], rows=self.rows[:1, :values]).after(1.0)[0])


def duels(several: Sequence[Explained], tried: Extended, spreads: Matrix, readings: int) -> Iterator[Duel]:
    """Give every explanation, believed, against every other one, unless that is the same with something added.

    ``spreads`` are those of one new value of every result (R,), SI.
    """
    seen = [(each, there(each, tried)) for each in several]
    for (true, shown), (rival, said) in permutations(seen, 2):
        if true.fit.key <= rival.fit.key:
            continue
        separation, moved = _on_record(true, rival)
        rows = said.slopes / spreads[:, None, None]
        left = (shown.shown - said.shown) / spreads[:, None] - rows @ moved
        yield Duel(
            (name_of(true.fit), name_of(rival.fit)), separation, _by_experiment(left[..., None], readings)[..., 0],
            _by_experiment(rows, readings), rival.root,
        )  # fmt: skip


def reached_by(rows: Matrix, root: Matrix) -> Matrix:
    """Return Q (E, m, p), so that 1 - Q Q' is (1 + R N^-1 R')^-1, R rows (E, m, p) and N the normal matrix of a root.

    By orthogonal decomposition of rows above root: where nothing was measured N is next to nothing.
    """
    stacked = np.concatenate([rows, np.broadcast_to(root, (len(rows), *root.shape))], axis=1)
    stacked = stacked / np.maximum(np.linalg.norm(stacked, axis=1, keepdims=True), 1e-300)
    return np.asarray(np.linalg.qr(stacked)[0][:, : rows.shape[1]])


def _by_experiment(values: Matrix, readings: int) -> Matrix:
    """Turn (R, T, p) into (E, readings * R, p): reading by reading, all results of each."""
    results, count, size = values.shape
    return (
        values.reshape(results, count // readings, readings, size)
        .transpose(1, 2, 0, 3)
        .reshape(count // readings, readings * results, size)
    )


def _on_record(true: Explained, rival: Explained) -> tuple[float, Matrix]:
    """Return how far the rival, refitted to what the believed one says of the record, is from it; and its moves.

    The rival pays for its inputs what they are off their means, the believed one has paid for its own already.
    """
    k, at = len(rival.fit.inputs), rival.at
    apart = rival.left - true.left + rival.design @ at
    start = rival.inverse @ (rival.design.T @ apart)
    left = apart - rival.design @ start
    paid = float(start[len(start) - k :] @ start[len(start) - k :]) - float(true.fit.inputs @ true.fit.inputs)
    return max(0.0, float(left @ left) + paid), start - at


def name_of(fit: Fit) -> str:
    """Return what an explanation is called: the names of its causes, each once."""
    return " + ".join(fit.names)
