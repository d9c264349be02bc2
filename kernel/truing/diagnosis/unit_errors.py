"""Units that were probably written wrong in a header: named with the factor that would set them right, never changed.

A slip is suspected of a column only where the model is ten times farther off than its tolerances can make it, and where
one of a few factors on that column brings the error down to a tenth or less, and to a third of what the model itself
says. Errors are judged as they are and about their middle (a gauge may have been set to zero anywhere), without the
largest tenth of them (a few wild readings decide nothing).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from truing.arrays import Indices, Matrix
from truing.diagnosis.data_rows import DataRows, declared_units, is_angle, keeps_bounds, rows_of
from truing.diagnosis.records import SuspectedUnit
from truing.gauge import one_machine, read_by_gauge, read_trials
from truing.setup import Setup
from truing.studies.sampling import root_of, scatter_of
from truing.units import difference_unit, from_si, same_dimension, to_si
from truing.units.grammar import shown
from truing.units.names import LEVELS, PURE

FACTORS = {1e-3: "0.001", 1e3: "1000", 1e-6: "1e-6", 1e6: "1e6"}
INCHES = {25.4: "25.4 (inches, not millimetres)", 1 / 25.4: "1/25.4 (millimetres, not inches)"}
ANGLES = {math.pi / 180: "pi/180 (degrees, not radians)", 180 / math.pi: "180/pi (radians, not degrees)"}
TIMES_NEARER, LIKE = 10.0, 0.3
"""Another unit is suspected where it leaves so many times less, and no more than such a share of what is measured."""
FAR_OFF, INLIERS = 0.1, 0.9
"""Units are tried where the model is off by such a share of what is measured; such a share of the errors counts."""
MOST_ROWS = 60
"""Rows on which factors are tried."""
FEWEST_ABOUT = 6
"""Rows that a judgement about the middle needs."""


@dataclass(frozen=True)
class _Gauge:
    """One measured result on some rows: what was measured, what the model says, how far tolerances reach (by mode)."""

    name: str
    measured: Matrix
    answer: Matrix
    reach: tuple[float, float]

    def off(self, mode: int) -> float:
        """Return how far the model is off, SI."""
        return _size(self.measured - self.answer, mode)

    def gain(self, measured: Matrix, answer: Matrix) -> float:
        """Return how many times smaller the error becomes; 0 where that says nothing about a slip."""
        best = 0.0
        for mode in (0, 1) if len(measured) >= FEWEST_ABOUT else (0,):
            before, after, signal = self.off(mode), _size(measured - answer, mode), _size(answer, mode)
            if before > TIMES_NEARER * max(self.reach[mode], after) and after <= LIKE * signal:
                best = max(best, before / max(after, 1e-12 * before))
        return best


def suspected_unit_errors(joined: DataRows, setup: Setup) -> tuple[SuspectedUnit, ...]:
    """Return the columns whose unit is probably wrong, by what each factor does to the error of the model."""
    out_of_range = tuple(_out_of_range(joined, setup))
    if not any(_is_far(values, joined.answers[name]) for name, values in joined.named("measured").items()):
        return out_of_range
    few = joined.taken(_some_rows(joined))
    gauges = _gauges(few, setup)
    far = [gauge for gauge in gauges if _is_far(gauge.measured, gauge.answer)]
    beyond = [gauge for gauge in far if any(gauge.off(mode) > TIMES_NEARER * gauge.reach[mode] for mode in (0, 1))]
    own = {gauge.name: slip for gauge in beyond if (slip := _own_slip(gauge, few, setup))}
    if len(beyond) > len(own) or len(own) > 1:
        shared = _input_slip(few, gauges, beyond, setup)
        if shared is not None:
            return (*out_of_range, shared)
    return (*out_of_range, *own.values())


def _size(errors: Matrix, mode: int) -> float:
    """Return the root mean square without the largest tenth; of mode 1 about the middle; infinite where most fail."""
    known = errors[np.isfinite(errors)]
    if len(known) < INLIERS * len(errors) or not len(known):
        return math.inf
    known = np.abs(known - np.median(known) if mode else known)
    kept = np.sort(known)[: max(1, math.ceil(INLIERS * len(known)))]
    return float(np.sqrt(np.mean(kept**2)))


def _is_far(measured: Matrix, answer: Matrix) -> bool:
    """Whether the error is a tenth of what is measured at least, as it is or about its middle."""
    here = np.isfinite(measured) & np.isfinite(answer)
    values, errors = measured[here], (measured - answer)[here]
    return len(values) > 0 and any(_size(errors, mode) > FAR_OFF * _size(values, mode) for mode in (0, 1))


def _some_rows(joined: DataRows) -> Indices:
    """Return rows spread over the whole record; where series make records, the first whole ones."""
    if not joined.named("series"):
        return np.unique(np.linspace(0, len(joined) - 1, MOST_ROWS).astype(np.intp))
    return np.flatnonzero(joined.runs == joined.runs[0])


def _gauges(few: DataRows, setup: Setup) -> list[_Gauge]:
    """Return every measured result on these rows, with how far one standard deviation of each tolerance reaches."""
    machine = one_machine(setup)
    scatter = [
        (name, distribution.sd)
        for by_input in setup.distributions().values()
        for name, distribution in by_input.items()
    ]
    moved = [{name: few.columns.get(name, machine.nominal(name)) + sd} for name, sd in scatter]
    alike = scatter_of(setup).alike([name for name, _ in scatter])
    answers, *others = read_trials(machine, rows_of(few), [{}, *moved], few.named("measured"))
    gauges = []
    for name, values in answers.items():
        measured = few.columns[name]
        moves = _as_drawn([other[name] - values for other in others], alike)
        sizes = np.array([_size(move, mode) for move in moves for mode in (0, 1)]).reshape(-1, 2)
        raw, about = np.sqrt(np.sum(np.where(np.isfinite(sizes), sizes, 0.0) ** 2, axis=0)).tolist()
        gauges.append(_Gauge(name, measured, np.where(np.isfinite(measured), values, np.nan), (raw, about)))
    return gauges


def _as_drawn(moves: Sequence[Matrix], alike: Matrix) -> Sequence[Matrix]:
    """Return what independent directions do to a result, from what each input does; those that fail do nothing."""
    if not np.any(alike != np.eye(len(alike))):
        return moves
    return list(root_of(alike).T @ np.nan_to_num(np.array(moves), posinf=0.0, neginf=0.0))


def _factors(unit: str) -> Mapping[float, str]:
    """Return the factors by which a unit may have slipped, with their words; none for a temperature level."""
    if unit in LEVELS:
        return {}
    is_length = unit not in PURE and same_dimension(unit, "m")
    return {**FACTORS, **(INCHES if is_length else {}), **(ANGLES if is_angle(unit) else {})}


def _own_slip(one: _Gauge, few: DataRows, setup: Setup) -> SuspectedUnit | None:
    """Return the slip in the unit of a measured result, if one factor on it explains the error."""
    factors = _factors(setup.model.own_result_fields[one.name].unit)
    gains = {factor: one.gain(one.measured * factor, one.answer) for factor in factors}
    best = max(gains, key=gains.__getitem__, default=1.0)
    if not gains.get(best):
        return None
    return _slip(one.name, best, few, _off(one, one.measured * best - one.answer, setup), factors[best])


def _input_slip(few: DataRows, gauges: list[_Gauge], beyond: list[_Gauge], setup: Setup) -> SuspectedUnit | None:
    """Return the slip of an input or condition that explains every error that is too large, and worsens none."""
    best: tuple[float, SuspectedUnit] | None = None
    trials = list(_trials(few, setup))
    scaled = [{name: few.columns[name] * factor} for name, factor, _ in trials]
    answers_by_trial = read_trials(one_machine(setup), rows_of(few), scaled, few.named("measured"))
    for (name, factor, words), answers in zip(trials, answers_by_trial, strict=True):
        gains = [gauge.gain(gauge.measured, answers[gauge.name]) for gauge in beyond]
        off = ((_size(gauge.measured - answers[gauge.name], 0), max(gauge.off(0), gauge.reach[0])) for gauge in gauges)
        if not all(gains) or any(after > LIKE * TIMES_NEARER * before for after, before in off):
            continue
        if best is None or min(gains) > best[0]:
            after = beyond[0].measured - answers[beyond[0].name]
            best = min(gains), _slip(name, factor, few, _off(beyond[0], after, setup), words)
    return None if best is None else best[1]


def _trials(few: DataRows, setup: Setup) -> Iterator[tuple[str, float, str]]:
    """Give every column that the model sees with every factor that its bounds allow."""
    seen, units = {need.name for active in setup.effects for need in active.effect.needs}, declared_units(setup.model)
    for name, values in few.named("input", "series", "condition").items():
        if name in setup.model.input_fields or name in seen:
            for factor, words in _factors(units[name]).items():
                if keeps_bounds(name, values * factor, setup.model):
                    yield name, factor, words


def _off(one: _Gauge, after: Matrix, setup: Setup) -> str:
    """Say how far the model is off a result before and after, in the unit the result is printed in."""
    unit = difference_unit(setup.print_unit(one.name))
    mode = 1 if one.off(0) < TIMES_NEARER * _size(after, 0) else 0
    before, then = from_si(one.off(mode), unit), from_si(_size(after, mode), unit)
    scale = "" if unit in PURE else f" {unit}"
    about = " about its middle" if mode else ""
    return f"the model is then {then:.3g}{scale} off '{one.name}'{about} instead of {before:.3g}{scale}"


def _slip(name: str, factor: float, joined: DataRows, why: str, words: str) -> SuspectedUnit:
    sentence = f"the unit of column {_header(name, joined)} is probably wrong: multiply it by {words}; {why}"
    return SuspectedUnit(name, factor, sentence)


def _header(name: str, joined: DataRows) -> str:
    return shown(f"{name} [{joined.units.get(name) or '1'}]")


def _out_of_range(joined: DataRows, setup: Setup) -> Iterator[SuspectedUnit]:
    """Give conditions that lie far beyond the range in which they can be set, where one factor brings them into it."""
    for name, values in joined.named("condition").items():
        condition = setup.model.known_conditions[name]
        if condition.low is None or condition.high is None or condition.derived:
            continue
        low, high = to_si(condition.low, condition.unit), to_si(condition.high, condition.unit)
        span = high - low
        if np.mean((values < low - TIMES_NEARER * span) | (values > high + TIMES_NEARER * span)) < 0.5:
            continue
        for factor, words in _factors(condition.unit).items():
            right = values * factor
            if np.mean((right >= low) & (right <= high)) >= INLIERS:
                why = f"it can be set from {condition.low:g} to {condition.high:g} {condition.unit}".rstrip()
                yield _slip(name, factor, joined, why, words)
                break


def factor_that_works(joined: DataRows, setup: Setup) -> Iterator[str]:
    """Say with which factor on a column the model would not fail, where there is one; nothing otherwise."""
    few = joined.taken(_some_rows(joined))
    machine, wanted = one_machine(setup), joined.named("measured")
    for name, factor, words in _trials(few, setup):
        scaled = replace(few, columns={**few.columns, name: few.columns[name] * factor})
        if read_by_gauge(machine, rows_of(scaled), wanted).failed.mean() <= 1 - INLIERS:
            yield f"the model works where column {_header(name, joined)} is multiplied by {words}: is its unit right?"
            return
