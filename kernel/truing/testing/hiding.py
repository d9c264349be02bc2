"""Hiding an effect in a record of one's own making, with the truth kept beside it."""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from time import perf_counter
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from truing.declare.fields import Axis
from truing.declare.goals import Vary
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.declare.sources import SINCE_START, Condition, Effect, Tolerance, Unknown
from truing.diagnosis.engine import diagnose
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.diagnosis.result import DiagnosisResult
from truing.errors import Fault, InputError, TruingError, UsageError
from truing.evaluate import evaluate
from truing.experiments.proposal import proposed
from truing.gauge import one_machine, read_by_gauge
from truing.inputs_file import setup_from_settings, setup_from_text
from truing.inputs_file.values import broken_bound
from truing.kernel import Offer
from truing.measurements import TableText, read_rows, table_text
from truing.measurements.table import WORDS, read_word
from truing.runs.diagnosis_document import diagnosis_document
from truing.runs.extension import extended_setup
from truing.runs.inputs_written import complete_inputs
from truing.setup import Setup, SwitchedOn
from truing.studies.reading import read_range
from truing.studies.sampling import generator, scatter_of
from truing.studies.sweep import Sweep
from truing.testing.subject import Subject
from truing.units import difference_unit, from_si, read_quantity, split_quantity, to_si, unit_factor

HELD_OUT_ROWS = 200


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
    faults: list[str] = []
    setup = _set(model, settings or {}, faults)
    made = effect_of(model, effect, faults)
    noises = noise_of(setup, noise, measure, faults)
    truth = truth_of(made, size, list(noises), faults)
    check_by(by, made, model, faults)
    columns = columns_of(setup, made, list(noises), over, faults)
    return _Plan(setup, made, truth, by, noises, columns, rows, runs, seed, correlation, machine).hidden(faults)


def _set(model: Model[Any, Any], settings: Mapping[str, str], faults: list[str]) -> Setup:
    """Return what is known of the machine: the defaults of the model with these settings."""
    subject = Subject(model)
    if settings:
        try:
            return setup_from_settings(subject.offer, settings)
        except TruingError as error:
            faults.append(str(error))
    return subject.setup


@dataclass(frozen=True)
class _Plan:
    """What is known of a machine, what is wrong with it, and how it is read off, as ``hide`` was asked for it."""

    setup: Setup
    effect: Effect[Any, Any] | None
    truth: Mapping[str, float]
    by: Strange | None
    noises: Mapping[str, RecordNoise]
    columns: Sequence[DesignColumn]
    rows: int
    runs: int
    seed: int
    correlation: float
    machine: int | None

    def hidden(self, faults: list[str]) -> Hidden:
        """Draw the record, and rows to judge with. Raises InputError where there are faults, with them all."""
        counts = {"rows": self.rows, "runs": self.runs}
        faults += [f"{what} is {count}; at least one" for what, count in counts.items() if count < 1]
        if not -1 < self.correlation < 1:
            faults.append(f"correlation is {self.correlation:g}; it lies between -1 and 1")
        _raise(self.setup.model, faults)
        drawn = {} if self.machine is None else scatter_of(self.setup).draw(self.machine, 0, 1)
        off = {drawn_input: float(values[0]) for drawn_input, values in drawn.items()}
        known = {column.name for column in self.columns} & set(self.setup.model.known_conditions)
        conditions = {**self.setup.conditions, **{name: self.setup.nominal(name) for name in known}}
        setup = replace(self.setup, conditions=conditions)
        true = wrong_machine(setup.changed(off), self.effect, self.truth, self.by)
        measured, _ = self._recorded(true, self.rows, 0)
        held, left = self._recorded(true, self.rows if self.runs > 1 or self._is_record else HELD_OUT_ROWS, 1)
        return Hidden(
            setup=setup, measured=measured, held_out=held, truth=self.truth, machine=off, noise=left,
            effect=self.effect.name if self.effect is not None else None,
            is_strange=self.effect is None and self.by is not None,
        )  # fmt: skip

    @property
    def _is_record(self) -> bool:
        """Whether the rows of a run are places on an axis."""
        return any(column.places for column in self.columns)

    def _recorded(self, true: Setup, rows: int, part: int) -> tuple[str, dict[str, float]]:
        """Return a record as CSV, and the root mean square of the noise in it by result, SI."""
        columns = self._drawn(rows, generator(self.seed, part, "design"))
        readings = self._shown(true, columns)
        left: dict[str, float] = {}
        for name, noise in self.noises.items():
            rng = generator(self.seed, part, f"noise of {name}")
            size = noise.size(readings[name])
            added = size * with_memory(rng.standard_normal((self.runs, rows)), self.correlation).ravel()
            unit = self.setup.print_unit(name)
            step = size / unit_factor(difference_unit(unit)) / 1000
            read = from_si(readings[name] + added, unit)
            columns[f"{name} [{unit or '1'}]"] = np.round(read, -math.floor(math.log10(step))) if step else read
            left[name] = float(np.sqrt(np.mean(added**2)))
        return csv_of(columns), left

    def _drawn(self, rows: int, rng: np.random.Generator) -> dict[str, Any]:
        """Return the columns by header, as they are written: space-filling, and in the order of the clock.

        Where a result runs along an axis every run is a record.
        """
        count = rows * self.runs
        spread = [column for column in self.columns if not (column.rises or column.places)]
        shares = qmc.Halton(max(len(spread), 1), seed=rng).random(self.runs if self._is_record else count)
        shares = np.repeat(shares, rows, axis=0) if self._is_record else shares
        columns: dict[str, Any] = {RUN: np.repeat(np.arange(1, self.runs + 1), rows)} if self.runs > 1 else {}
        clock = (np.arange(count) + rng.random(count)) / count
        for column in self.columns:
            if column.places:
                own = np.tile(np.linspace(0.0, 1.0, rows), self.runs)
            else:
                own = clock if column.rises else shares[:, spread.index(column)]
            columns[column.header] = column.at(own)
        return columns

    def _shown(self, true: Setup, columns: Mapping[str, Any]) -> Mapping[str, NDArray[np.float64]]:
        """Return what the gauges would show without noise, SI. Raises InputError where the model has no answer."""
        rows = read_rows(TableText(MEASURED, csv_of(columns)), Offer(true.model.name, true.model, true.origin), true)
        reading = read_by_gauge(true, rows, list(self.noises))
        if reading.failed.any():
            row, reason = next(iter(reading.reasons.items()))
            at = ", ".join(f"{name} = {values[row]}" for name, values in columns.items())
            many = f"{int(reading.failed.sum())} of {len(reading)} rows"
            _raise(self.setup.model, [f"the model has no answer in {many}; at {at}: {reason}; narrow the range (over)"])
        return reading.results


def csv_of(columns: Mapping[str, Any]) -> str:
    """Return columns by header as CSV, every digit kept."""
    return table_text(list(columns), list(columns.values()))


def with_memory(drawn: NDArray[np.float64], correlation: float) -> NDArray[np.float64]:
    """Return noise of unit variance (runs, rows) in which that of neighbours in a run is correlated."""
    noise = drawn.copy()
    for row in range(1, noise.shape[1] if correlation else 0):
        noise[:, row] = correlation * noise[:, row - 1] + math.sqrt(1 - correlation**2) * noise[:, row]
    return noise


def _raise(model: Model[Any, Any], faults: Sequence[str]) -> None:
    if faults:
        raise InputError([Fault(f"{model.name}: {sentence}") for sentence in faults])


# A record with what was hidden in it, and what a diagnosis answers to it


MEASURED, HELD_OUT, INPUTS = "measured.csv", "held_out.csv", "inputs.toml"


@dataclass(frozen=True)
class Answered:
    """What a diagnosis said, as result and as diagnosis.json, and what it is worth on rows it has never seen.

    ``held`` and ``predicted`` are those rows as measured and as the extended model predicts them, by result, in SI;
    nothing where no rows were held out. ``seconds`` is what the diagnosis took.
    """

    diagnosis: DiagnosisResult
    document: Mapping[str, Any]
    held: Mapping[str, NDArray[np.float64]]
    predicted: Mapping[str, NDArray[np.float64]]
    seconds: float

    def error_of(self, result: str) -> float:
        """Return the root mean square error on the rows held out, SI."""
        return float(np.sqrt(np.nanmean((self.held[result] - self.predicted[result]) ** 2)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Hidden:
    """A measured record whose truth is known: what ``hide`` makes, and what ``assert_finds`` judges.

    ``measured`` and ``held_out`` are CSV as a diagnosis reads it; rows held out are never fitted. ``setup`` is what the
    engineer knows of the machine. ``truth`` holds the unknowns of the effect, ``machine`` what its inputs truly are
    where they are off their nominals, ``noise`` the root mean square of what the gauge added to the rows held out, by
    result; all in SI. Without an ``effect`` nothing registered is hidden: nothing at all, unless ``is_strange``.
    """

    setup: Setup
    measured: str
    held_out: str = ""
    effect: str | None = None
    truth: Mapping[str, float] = field(default_factory=dict)
    machine: Mapping[str, float] = field(default_factory=dict)
    noise: Mapping[str, float] = field(default_factory=dict)
    is_strange: bool = False

    @cached_property
    def answered(self) -> Answered:
        """Diagnose the record, once, and predict the rows held out."""
        records = records_of(self.setup, self.measured, MEASURED)
        start = perf_counter()
        diagnosis = diagnose(self.setup, records, propose=proposed)
        seconds = perf_counter() - start
        document = json.loads(json.dumps(diagnosis_document(diagnosis)))
        if not self.held_out:
            return Answered(diagnosis, document, {}, {}, seconds)
        judged = records_of(self.setup, self.held_out, HELD_OUT, with_unit_errors=False)
        return Answered(diagnosis, document, judged.measured, predicted(diagnosis, self.setup, judged), seconds)

    def write(self, folder: Path) -> None:
        """Write inputs.toml, measured.csv and held_out.csv, to look at and to diagnose on the command line."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / INPUTS).write_text(complete_inputs(self.setup, folder), encoding="utf-8")
        (folder / MEASURED).write_text(self.measured, encoding="utf-8")
        if self.held_out:
            (folder / HELD_OUT).write_text(self.held_out, encoding="utf-8")


def recorded(
    model: Model[Any, Any],
    *,
    inputs: str,
    measured: str,
    held_out: str = "",
    effect: str | None = None,
    truth: Mapping[str, float] | None = None,
) -> Hidden:
    """Return a record that was made elsewhere: by a generator of your own, or on a machine whose error is known.

    ``inputs`` is the text of the inputs file, ``measured`` and ``held_out`` that of CSV files with units in the header,
    ``truth`` holds the unknowns of the effect in SI. Raises InputError with every fault of the inputs.
    """
    setup = setup_from_text(inputs, Subject(model).offer, file=INPUTS, folder=Path())
    return Hidden(setup=setup, measured=measured, held_out=held_out, effect=effect, truth=truth or {})


def records_of(setup: Setup, text: str, name: str, *, with_unit_errors: bool = True) -> Records:
    """Read a record as the command line does; without a search for wrong units where nobody is told of them."""
    offer = Offer(setup.model.name, setup.model, setup.origin)
    return read_records([TableText(name, text)], offer, setup, with_unit_errors=with_unit_errors)


def predicted(diagnosis: DiagnosisResult, setup: Setup, records: Records) -> dict[str, NDArray[np.float64]]:
    """Predict rows that were not fitted, by every cause and shape that was found on the calibrated machine; SI."""
    machine = extended_setup(diagnosis) or setup
    shown = read_by_gauge(one_machine(machine), records.rows, diagnosis.measured).results
    known: dict[str, Any] = {name: covariate.values for name, covariate in records.covariates.items()}
    readings = {}
    for result in diagnosis.measured:
        values = shown[result]
        for term in diagnosis.remainder.terms.get(result, ()) if diagnosis.remainder else ():
            values = values + term.coefficient * np.asarray(eval(term.expression, {"np": np}, known))
        readings[result] = values
    return readings


# What is hidden: an effect with its unknowns, made by its own function or by one of the author's own


Size: TypeAlias = str | float | Mapping[str, str | float]
Strange: TypeAlias = Callable[..., Any]
STRANGE = "hidden_by_the_test"
ENDLESS = 1e6
"""Bounds as wide as these say nothing of how large an effect is."""


def effect_of(model: Model[Any, Any], name: str | None, faults: list[str]) -> Effect[Any, Any] | None:
    """Return the effect of this name, of the model or of the kernel."""
    known = model.known_effects
    if name is not None and name not in known:
        faults.append(f"no effect '{name}'.{near_miss(name, known) or ' It has ' + ', '.join(known)}")
    return known.get(name or "")


def truth_of(
    effect: Effect[Any, Any] | None, size: Size | None, measured: Sequence[str], faults: list[str]
) -> dict[str, float]:
    """Return the unknowns of the effect in SI."""
    if effect is None:
        if size is not None and not faults:
            faults.append(f"size is {size!r}, but no effect is hidden; leave it out")
        return {}
    stated = _stated(effect, size, measured, faults)
    known = {unknown.name: unknown for unknown in effect.unknowns}
    sizes: dict[str, float] = {}
    for name, said in stated.items():
        if name not in known:
            faults.append(f"effect '{effect.name}' has no unknown '{name}'.{near_miss(name, list(known))}")
            continue
        try:
            sizes[name] = _value(known[name], said)
        except TruingError as error:
            faults.append(f"size of '{name}': {error}")
    touched = [part for part in effect.groups() if any(unknown.name in stated for unknown in part)]
    missing = [unknown.name for part in touched for unknown in part if unknown.name not in stated]
    if missing:
        faults.append(f"effect '{effect.name}': say {' and '.join(missing)} as well, size={{...}}")
    acts = any(known[name].is_amplitude and value for name, value in sizes.items())
    if sizes and not acts and not missing:
        faults.append(f"effect '{effect.name}' of size 0 hides nothing; hide(None, ...) does that")
    return sizes


def _stated(
    effect: Effect[Any, Any], size: Size | None, measured: Sequence[str], faults: list[str]
) -> Mapping[str, str | float]:
    """Return what is said of each unknown; a plain size is that of the only amplitude."""
    if isinstance(size, Mapping):
        return size
    parts = effect.groups()
    if effect.parts:  # one gauge each: that of what is measured
        parts = tuple(part for part in parts if any(unknown.name in measured for unknown in part)) or parts
    if size is None:
        return _half(effect, parts, faults)
    if len(parts) == 1 and len(parts[0]) == 1:
        return {parts[0][0].name: size}
    names = [unknown.name for part in parts for unknown in part]
    faults.append(
        f"effect '{effect.name}' has the unknowns {', '.join(names)}: say which is {size}, "
        f'size={{"{names[0]}": "{size}", ...}}'
    )
    return {}


def _half(effect: Effect[Any, Any], parts: Sequence[Sequence[Unknown]], faults: list[str]) -> dict[str, str]:
    """Take half of what the bounds of an amplitude allow, and the middle of those of a shape."""
    if len(parts) != 1 or any(abs(unknown.high) >= ENDLESS for unknown in parts[0]):
        faults.append(f"say how large '{effect.name}' is: size={{...}}; its bounds are no measure of it")
        return {}
    sizes = {}
    for unknown in parts[0]:
        if unknown.is_amplitude:
            value = max((unknown.low, unknown.high), key=abs) / 2
        else:
            value = math.sqrt(unknown.low * unknown.high) if unknown.low > 0 else (unknown.low + unknown.high) / 2
        sizes[unknown.name] = f"{round(value) if unknown.whole else value!r} {unknown.unit}".strip()
    return sizes


def _value(unknown: Unknown, said: str | float) -> float:
    """Read one unknown, SI. Raises UsageError where it is no quantity of its kind, or out of its bounds."""
    value = float(read_quantity(said if isinstance(said, str) else repr(said), unknown.unit))
    number = float(from_si(value, unknown.unit))
    slack = 1e-9 * max(abs(unknown.low), abs(unknown.high))
    if not unknown.low - slack <= number <= unknown.high + slack:
        raise UsageError(
            f"{said} lies outside of its bounds, {unknown.low:g} to {unknown.high:g} {unknown.unit}".rstrip()
            + ", where no diagnosis looks"
        )
    if unknown.whole and not number.is_integer():
        raise UsageError(f"{said} is no whole number")
    return value


def check_by(by: Strange | None, effect: Effect[Any, Any] | None, model: Model[Any, Any], faults: list[str]) -> None:
    """Say where a function of the author's own does not take what the effect has, or what is no condition."""
    if by is None:
        return
    signature = inspect.signature(by)
    wanted = _conditions_of(by, model)
    if effect is not None:
        wanted = sorted({unknown.name for unknown in effect.unknowns} | {need.name for need in effect.needs})
    try:
        signature.bind("inputs", "results", **dict.fromkeys(wanted))
    except TypeError:
        faults.append(
            f"by takes {', '.join(signature.parameters) or 'nothing'}; it is called with inputs, results and the "
            f"keywords {', '.join(wanted) or 'of conditions of the model'}"
        )


def _conditions_of(by: Strange, model: Model[Any, Any]) -> list[str]:
    """Return the conditions of the model that a function names."""
    return [name for name in [*inspect.signature(by).parameters][2:] if name in model.known_conditions]


def wrong_machine(
    setup: Setup, effect: Effect[Any, Any] | None, truth: Mapping[str, float], by: Strange | None
) -> Setup:
    """Return the machine as it truly is: the effect on, made by its own function or by the author's."""
    if by is None:
        return replace(setup, effects=(SwitchedOn(effect, truth),)) if effect is not None else setup
    model = setup.model
    made = _by_hand(by, effect, model)
    errors = [source for source in model.errors if source.name != made.name]
    changed = replace(model, errors=[*errors, made])
    on = SwitchedOn(made, truth if effect is not None else {made.unknowns[0].name: 1.0})
    return replace(setup, model=changed, effects=(on,))


def _by_hand(by: Strange, effect: Effect[Any, Any] | None, model: Model[Any, Any]) -> Effect[Any, Any]:
    """Make an effect on the reading of the author's own function."""
    if effect is not None:
        return Effect(effect.name, on_reading=by, unknowns=effect.unknowns, needs=effect.needs, parts=effect.parts)
    named = _conditions_of(by, model)
    needs = [model.known_conditions[name] for name in named]

    def function(inputs: Any, results: Any, **known: Any) -> Any:
        return by(inputs, results, **{name: known[name] for name in named})

    return Effect(STRANGE, on_reading=function, unknowns=[Unknown("size", 0, 1)], needs=needs)


# What the gauge scatters: which results are measured, and how well


@dataclass(frozen=True)
class RecordNoise:
    """A standard deviation in SI, or a share of the span of what is shown."""

    sd: float = 0.0
    share: float = 0.0

    def size(self, shown: NDArray[np.float64]) -> float:
        """Return the standard deviation for these readings, SI."""
        return self.sd or self.share * float(np.ptp(shown))


def noise_of(setup: Setup, said: Any, measure: str | Sequence[str] | None, faults: list[str]) -> dict[str, RecordNoise]:
    """Return the noise by measured result; what is wrong is added to ``faults``, a sentence each."""
    fields = setup.model.own_result_fields  # numbers and curves can be measured, axes not
    gauged = {name: field.unit for name, field in fields.items() if not isinstance(field.spec, Axis)}
    named = [measure] if isinstance(measure, str) else list(measure or ())
    if said is None:
        like = f"{{'{named[0]}': ...}}" if named else "'0.1 kN'"
        faults.append(f"noise is missing: say how far the gauge scatters, noise={like}, or '1 %' of the span")
        return {}
    if isinstance(said, Mapping):
        texts = dict(said)
    else:
        names = named or _fitting(gauged, said, faults)
        texts = dict.fromkeys(names, said)
    noises = {}
    for name, text in texts.items():
        if name not in gauged:
            is_result = name in setup.model.result_fields
            why = "is no result that a gauge can show" if is_result else f"is no result.{near_miss(name, gauged)}"
            faults.append(f"'{name}' {why}")
            continue
        try:
            noises[name] = _read(text, gauged[name])
        except TruingError as error:
            faults.append(f"noise of '{name}': {error}")
            continue
        if not (noises[name].sd > 0 or noises[name].share > 0):
            faults.append(f"noise of '{name}': {text} is no scatter; every gauge has some, by which it is judged")
    missing = [name for name in named if name not in texts]
    if missing:
        faults.append(f"noise says nothing of {', '.join(missing)}, which is to be measured")
    return noises


def _fitting(gauged: Mapping[str, str], said: Any, faults: list[str]) -> list[str]:
    """Return the one result that a noise can be of; of several the only one that is in the very unit of the noise."""
    fits = []
    for name, unit in gauged.items():
        with suppress(TruingError):
            _read(said, unit)
            fits.append(name)
    if isinstance(said, str) and len(fits) > 1 and not _is_share(said):
        same = [name for name in fits if gauged[name] == split_quantity(said).unit]
        fits = same if len(same) == 1 else fits
    if len(fits) == 1:
        return fits
    if fits:
        faults.append(f"noise {said!r} may be of {', '.join(fits)}: say which is measured, measure='{fits[0]}'")
    else:
        units = ", ".join(f"{name} in {unit or 'pure numbers'}" for name, unit in gauged.items())
        faults.append(f"noise {said!r} is of the kind of no result: {units}")
    return []


def _is_share(said: Any) -> bool:
    return isinstance(said, str) and said.strip().endswith("%")


def _read(said: Any, unit: str) -> RecordNoise:
    """Read a standard deviation, a difference in the unit of the result, or a share of its span."""
    if _is_share(said):
        return RecordNoise(share=read_quantity(said, ""))
    return RecordNoise(sd=read_quantity(said if isinstance(said, str) else repr(said), difference_unit(unit)))


# How a hidden record is taken: which columns vary, between which ends, and where each row lies


USUAL = {"time": "0..24 h", "temperature": "15..35 degC", "angle": "0..360 deg"}
"""The ranges of the kernel's own conditions, which no model declares."""
STEPS = 100_000
"""A range is written in so many steps: as fine as any gauge, and short to read."""
RUN = "run"


@dataclass(frozen=True)
class DesignColumn:
    """A column that varies: its header, its ends in the unit that stands there, or the ``levels`` or words it takes.

    One that ``rises`` goes from end to end with the rows, as a clock does; one that ``places`` the rows on an axis does
    so in every run.
    """

    name: str
    header: str
    low: float = 0.0
    high: float = 0.0
    levels: tuple[Any, ...] = ()
    rises: bool = False
    places: bool = False
    whole: bool = False

    def at(self, shares: NDArray[np.float64]) -> Any:
        """Return the values (n,) at these shares of the range, 0 to 1."""
        if self.levels:
            chosen = np.array(self.levels, dtype=float if isinstance(self.levels[0], float) else object)
            return chosen[np.minimum((shares * len(chosen)).astype(int), len(chosen) - 1)]
        values = self.low + (self.high - self.low) * shares
        decimals = 0 if self.whole else -math.floor(math.log10((self.high - self.low) / STEPS))
        return np.clip(np.round(values, decimals), self.low, self.high)


def columns_of(
    setup: Setup, effect: Effect[Any, Any] | None, measured: Sequence[str], over: Mapping[str, Any] | None,
    faults: list[str],
) -> list[DesignColumn]:  # fmt: skip
    """Return the columns that vary; what is wrong with what was asked for is added to ``faults``, a sentence each.

    ``over`` names them all; without it they are what the effect needs and what is declared to vary. The axis of a
    measured result is a column in any case.
    """
    asked: dict[str, Any] = dict(over) if over is not None else dict(_by_default(setup, effect))
    for axis in _axes(setup, measured):
        unit = setup.model.own_result_fields[axis].unit  # its range is that at the defaults
        places = from_si(np.asarray(setup.model.read_results(evaluate(setup))[axis], dtype=float), unit)
        asked.setdefault(axis, f"{float(np.min(places))!r}..{float(np.max(places))!r} {unit}".strip())
    columns, wrong = [], []
    for name, said in asked.items():
        try:
            columns.append(_column(setup, name, said, measured))
        except TruingError as error:
            wrong.append(f"over, '{name}': {error}")
    wrong += _not_varied(setup, effect, set(asked), is_stated=over is not None)
    if not columns and not wrong:
        wrong.append('nothing varies: say what is set from row to row, over={"load": "10..90 N"}')
    faults += wrong
    return columns


def _by_default(setup: Setup, effect: Effect[Any, Any] | None) -> Iterator[tuple[str, str]]:
    """Give what is declared to vary, and what the effect needs.

    What a study sweeps over varies in use; only where none does it is what may be chosen (``Vary``), unless that is
    made once, which its tolerance says.
    """
    yield from dict(_swept(setup) or _chosen(setup)).items()
    for condition in effect.needs if effect is not None else ():
        said = usual_range(condition)
        if said and condition.made_from in {"", condition.name}:
            yield condition.name, said


def _swept(setup: Setup) -> list[tuple[str, str]]:
    """Return the ranges over which the model's studies sweep."""
    known = {*setup.model.input_fields, *setup.model.known_conditions}
    sweeps = [study for study in setup.model.studies if isinstance(study, Sweep)]
    return [(study.over, study.at) for study in sweeps if study.over in known and study.at]


def _chosen(setup: Setup) -> list[tuple[str, str]]:
    """Return the ranges of what may be chosen and has no tolerance."""
    model = setup.model
    made = {name for source in model.errors if isinstance(source, Tolerance) for name in source.on}
    goals = [goal for goal in model.objectives if isinstance(goal, Vary) and not goal.by and goal.input not in made]
    fields = model.input_fields
    return [(goal.input, f"{goal.low}..{goal.high}") for goal in goals if fields[goal.input].kind == "float"]


def usual_range(condition: Condition) -> str:
    """Return the range of a condition that is declared, or usual for one of the kernel's, or nothing."""
    if condition.low is not None and condition.high is not None:
        return f"{condition.low}..{condition.high} {condition.unit}".strip()
    return USUAL.get(condition.name, "")


def _axes(setup: Setup, measured: Sequence[str]) -> Iterator[str]:
    """Give the axes that the measured results run along."""
    fields = setup.model.own_result_fields
    for name in measured:
        result = fields[name]
        if result.along:
            own = f"{result.along}_{result.scope}"
            yield own if own in fields else result.along


def _column(setup: Setup, name: str, said: Any, measured: Sequence[str]) -> DesignColumn:
    """Read one range, or the values that a column takes. Raises UsageError with a sentence."""
    model = setup.model
    input_field = model.input_fields.get(name)
    if input_field is not None and input_field.kind in WORDS:
        return _words(input_field, said)
    known = _units(setup)
    axes = set(_axes(setup, measured))
    if name not in {*known, *axes}:
        raise UsageError(f"{model.name} has no input or condition of that name.{near_miss(name, list(known))}")
    if input_field is not None and input_field.kind not in {"float", "whole"}:
        raise UsageError("a file or a series cannot change from row to row")
    low, high, levels, shown = _ends(said, known[name] if name in known else model.own_result_fields[name].unit)
    for end in (low, high, *levels):
        broken = broken_bound(input_field, float(to_si(end, shown))) if input_field is not None else ""
        if broken:
            raise UsageError(broken)
    condition = model.known_conditions.get(name)
    return DesignColumn(
        name, f"{name} [{shown or '1'}]", low, high, levels,
        rises=name == "time" or (condition is not None and condition.history == SINCE_START),
        places=name in axes,
        whole=input_field is not None and input_field.kind == "whole",
    )  # fmt: skip


def _ends(said: Any, unit: str) -> tuple[float, float, tuple[float, ...], str]:
    """Read "low..high unit" or "a, b, c unit" in the unit in which it is written, checked against the declared one."""
    text = said if isinstance(said, str) else ", ".join(str(one) for one in said)
    values = read_range(text, unit, 2)
    shown = split_quantity(text.replace("..", ",").split(",")[-1].strip()).unit or unit
    written = [float(f"{float(from_si(float(value), shown)):.12g}") for value in values]
    if ".." not in text:
        return min(written), max(written), tuple(written), shown
    low, high = written
    if not low < high:
        raise UsageError(f"it goes from {low:g} to {high:g} {shown}: lower end first".rstrip())
    return low, high, (), shown


def _words(input_field: Any, said: Any) -> DesignColumn:
    """Read the values of a choice, a switch or a whole number. Raises UsageError with a sentence."""
    words = [word.strip() for word in said.split(",")] if isinstance(said, str) else [str(word) for word in said]
    for word in words:
        try:
            read_word(input_field, word, decimal_comma=False)
        except ValueError as error:
            raise UsageError(str(error)) from error
    return DesignColumn(input_field.name, input_field.name, levels=tuple(words))


def _units(setup: Setup) -> dict[str, str]:
    """Return the declared units of what can be a column: inputs, conditions, and what conditions are made from."""
    model = setup.model
    units = {name: field.unit for name, field in model.input_fields.items()}
    units |= {name: condition.unit for name, condition in model.known_conditions.items()}
    axes = {name for name, field in model.own_result_fields.items() if isinstance(field.spec, Axis)}
    made = [condition for condition in list(model.known_conditions.values())[::-1] if condition.made_from]
    for condition in sorted(made, key=lambda condition: condition.history == "direction"):  # which has no unit
        if condition.made_from not in axes:
            units.setdefault(condition.made_from, "" if condition.history == "direction" else condition.unit)
    return units


def _not_varied(setup: Setup, effect: Effect[Any, Any] | None, asked: set[str], *, is_stated: bool) -> Iterator[str]:
    """Say which columns an effect needs and nobody varies, one sentence each: without them it cannot be found."""
    missing: dict[str, list[Condition]] = {}
    for condition in effect.needs if effect is not None else ():
        if condition.name not in asked and condition.made_from not in asked:
            missing.setdefault(condition.made_from or condition.name, []).append(condition)
    for source, conditions in missing.items():
        names = " and ".join(f"'{condition.name}'" for condition in conditions)
        made = f" (made from '{source}')" if source != conditions[0].name else ""
        unit = _units(setup).get(source, "")
        usual = usual_range(conditions[0]) if not made else ""
        why = "over does not vary it" if is_stated else "no range is declared for it"
        yield (
            f"effect '{effect.name if effect else ''}' needs {names}{made}, and {why}: "
            f'add "{source}": "{usual or f"LOW..HIGH {unit}".strip()}" to over'
        )
