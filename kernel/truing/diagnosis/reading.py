"""Measured files to records that can be explained: read, put in order, joined, held against the model once.

An error may depend on inputs, conditions, time, and every other column of numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np

from truing.arrays import Mask, Matrix, Sides
from truing.declare.builtin import may_stand
from truing.declare.near_miss import near_miss
from truing.diagnosis.causes import reading_of
from truing.diagnosis.data_rows import (
    ColumnRole,
    DataRows,
    complete_rows,
    is_angle,
    join,
    measured_rows,
    numbered,
    objects,
    read_data_files,
    rows_of,
    settle_conditions,
    tidy,
)
from truing.diagnosis.records import FEWEST_READINGS, Covariate, Records, Role
from truing.diagnosis.unit_errors import factor_that_works, suspected_unit_errors
from truing.errors import Fault, InputError
from truing.gauge import demand_times, one_machine, read_by_gauge
from truing.inputs_file.files import digest_of
from truing.inputs_file.values import SIGMA
from truing.kernel import Offer
from truing.measurements import TableSource, TableText
from truing.measurements.derived import TIME
from truing.numbers import counted
from truing.setup import Setup, column_and_word
from truing.units import same_dimension, to_si
from truing.units.grammar import shown
from truing.units.names import PURE

ORDER = "order"
_ROLES: dict[ColumnRole, Role] = {
    "input": "input", "series": "input", "word": "input", "condition": "condition", "axis": "other", "other": "other",
}  # fmt: skip
FEWEST = 3
"""Fewer rows are no record."""
FEWEST_BESIDE = 6
"""Of a result beside others: from fewer values its noise cannot be told, and any cause would fit them exactly."""
MOST_FAILED = 0.5
"""A model that fails in a larger share of the rows is not the model of this record."""
_FEW = ("no row", "one row", "two rows")


def covariates_of(joined: DataRows, setup: Setup) -> tuple[dict[str, Covariate], list[str]]:
    """Return every covariate by name, in the order inputs, conditions, others; and what is to be said of them.

    Where no time was measured, the place in the record stands for it.
    """
    covariates: dict[str, Covariate] = {}
    effects = [effect for name, effect in setup.model.known_effects.items() if name.startswith("periodic_order")]
    known = [effect for effect in effects if reading_of(effect) is not None and not may_stand(effect)]
    turning = {name for effect in known for name in (*effect.reads, *(need.name for need in effect.needs))}
    for part, usual in _ROLES.items():
        for name, cells in joined.named(part).items():
            is_flag = part == "other" and name in setup.diagnose.flags  # it says what came out, and is no reason for it
            if is_flag or (part == "word" and setup.model.input_fields[name].kind != "integer"):
                continue
            values = cells.astype(float)
            unit = joined.units[name] if part == "other" else setup.print_unit(name)
            unit = "" if part == "other" and unit in PURE else unit
            if np.isfinite(values).any():
                is_time = name == TIME and unit not in PURE and same_dimension(unit, "s")
                covariate = Covariate(name, values, unit, "time" if is_time else usual, is_angle(unit))
                is_design = part in {"input", "series"} and name not in turning and not covariate.goes_round
                covariates[name] = replace(covariate, is_angle=False) if is_design else covariate
    if not any(known_covariate.role == "time" for known_covariate in covariates.values()):
        name = ORDER if ORDER not in covariates else "row order"
        covariates[name] = Covariate(name, np.arange(len(joined), dtype=float), "", "order")
    notes = _of_others(joined, setup, covariates)
    if still := [shown(known_covariate.name) for known_covariate in covariates.values() if known_covariate.is_constant]:
        columns = counted(len(still), "column never changes", "columns never change")
        notes.append(f"{columns}, so nothing can be seen of what depends on it: {', '.join(still)}")
    return covariates, notes


def _of_others(joined: DataRows, setup: Setup, covariates: dict[str, Covariate]) -> list[str]:
    """Say which columns nobody declared, and what they are taken for."""
    model = setup.model
    known = [*model.measurable, *model.known_conditions, *model.input_fields]
    notes = []
    asked_for = {setup.diagnose.held_out[0], *setup.diagnose.flags}
    for name in joined.named("other", "label"):
        is_label = joined.parts[name] == "label" and any(joined.columns[name].tolist())
        if name in asked_for and (is_label or name not in covariates):
            continue
        words = "it is kept as words, on which nothing can depend" if is_label else "it holds no value and is not used"
        use = "it is kept as something an error may depend on" if name in covariates else words
        near = near_miss(name[:80], known)
        hint = near if near and near.split("'")[1] not in joined.columns else ""
        notes.append(f"column {shown(name)} is neither input, result nor condition; {use}.{hint}".rstrip("."))
    unused = [name for name in joined.named("sigma") if name.removeprefix(SIGMA) not in joined.columns]
    return [*notes, *(f"column {shown(name)} is of a result that is not measured and is not used" for name in unused)]


def held_out_rows(joined: DataRows, setup: Setup) -> DataRows:
    """Mark the rows that only judge, as ``[studies.diagnose] hold_out`` says. Raises InputError where it finds none."""
    column, word = setup.diagnose.held_out
    if not column:
        return joined
    marked = _marked("hold_out", column, word, joined, setup)
    sentence = f"{counted(int(marked.sum()), 'row only judges', 'rows only judge')}: {column} = {word}"
    return replace(joined, held_out=marked).noted(sentence)


def _marked(option: str, column: str, word: str, joined: DataRows, setup: Setup) -> Mask:
    """Mark the rows that hold a word, or the number it is, in a column. Raises InputError where there are none."""
    source_line = setup.source.places.get(f"studies.diagnose.{option}", (setup.source.file, None))
    cells = joined.runs if column == "run" else joined.columns.get(column)
    if cells is None:
        near = near_miss(column[:80], list(joined.columns))
        raise InputError([Fault(f"{option}: no file has a column {shown(column)}.{near}", *source_line)])
    unit, marked = joined.units.get(column, ""), np.zeros(len(cells), dtype=bool)
    if cells.dtype == object:
        marked = np.array([str(cell).strip() == word for cell in cells.tolist()], dtype=bool)
    else:
        with suppress(ValueError):  # no number is a word
            marked = np.isclose(cells, float(word) if unit in PURE else to_si(float(word), unit), rtol=1e-9, atol=0)
    if not marked.any():
        raise InputError([Fault(f"{option}: no row has {shown(word)} in the column {shown(column)}", *source_line)])
    return marked


def censored_rows(joined: DataRows, setup: Setup) -> tuple[DataRows, dict[str, Sides], list[str]]:
    """Find the readings that say only beyond which end the true value lies: marked ones, and a gauge at its end.

    A reading beyond the end of its gauge is one at the end. Raises InputError where a mark marks nothing.
    """
    columns, asked = dict(joined.columns), setup.diagnose
    sides: dict[str, Sides] = {}
    notes = []
    for name in joined.named("measured"):
        low, high = asked.clipped.get(name, (-np.inf, np.inf))
        side = np.where(columns[name] >= high, 1, np.where(columns[name] <= low, -1, 0)).astype(np.int8)
        columns[name] = np.clip(columns[name], low, high)
        for option, sign in (("at_least", 1), ("at_most", -1)):
            column, word = column_and_word(getattr(asked, option).get(name, ""))
            if column:
                side[_marked(option, column, word, joined, setup)] = sign
        if side.any():
            sides[name] = side
            of = f"{int((side != 0).sum())} of {int(np.isfinite(columns[name]).sum())} readings"
            notes.append(f"{of} of '{name}' are censored: the true value lies beyond what was read")
    return replace(joined, columns=columns), sides, notes


def read_records(paths: Sequence[TableSource], offer: Offer, setup: Setup, *, with_unit_errors: bool = True) -> Records:
    """Read measured files as the records of one machine; everything odd is counted and said in ``notes``.

    ``with_unit_errors`` looks for units that were written wrong, which asks the model for every column and factor.
    A column is an input, a result (measured), a condition of an effect, ``sigma_NAME``, ``run``, or anything else that
    an error may depend on. Raises InputError with every fault of every file: nothing measured, a unit that is unknown
    or of another dimension, cells that are no numbers, columns without any value, fewer than three rows.
    """
    files = _read(paths, replace(offer, model=setup.model), setup)
    joined = join(files, setup)
    _demand_rows(joined)
    joined = complete_rows(settle_conditions(joined, files, setup), setup)
    _demand_rows(joined)
    _demand_logarithms(joined, setup)
    joined = held_out_rows(_answered(joined, setup), setup)
    _demand_rows(joined)
    joined = measured_rows(_enough_values(joined, setup))
    unit_errors = suspected_unit_errors(joined, setup) if with_unit_errors else ()
    joined, sides, censored = censored_rows(joined, setup)
    covariates, said = covariates_of(joined, setup)
    sigma, unused = _sigma(joined)
    return Records(
        files=joined.files,
        rows=rows_of(joined),
        file_of=joined.file_of,
        run_of=numbered(joined.runs),
        lines=joined.lines,
        measured=joined.named("measured"),
        sigma=sigma,
        covariates=covariates,
        held_out=joined.held_out,
        notes=(*joined.notes, *said, *unused, *censored),
        unit_errors=unit_errors,
        absent=joined.absent,
        sides=sides,
        counts=joined.counts,
        units=joined.units,
        digests={str(path): path.digest if isinstance(path, TableText) else digest_of(path) for path in paths},
    )


def _read(paths: Sequence[TableSource], offer: Offer, setup: Setup) -> list[DataRows]:
    """Read every file and put its rows in order, runs of several told apart; raises InputError with all faults."""
    once = {path.resolve() if isinstance(path, Path) else path: path for path in reversed(paths)}
    named = list(reversed(once.values()))
    files: list[DataRows] = []
    for path, file in zip(named, read_data_files(named, offer, setup.columns), strict=True):
        file = tidy(file, offer.model)
        if len(once) > 1:
            runs = objects(f"{path}: {run}" if run else str(path) for run in file.runs.tolist())
            file = replace(file, runs=runs, notes=tuple(f"{path}: {sentence}" for sentence in file.notes))
        if not files and len(once) < len(paths):
            twice = f"{counted(len(paths) - len(once), 'file is', 'files are')} given twice and read once"
            file = replace(file, notes=(twice, *file.notes))
        files.append(file)
    return files


def _demand_rows(joined: DataRows, most: int | None = None) -> None:
    """Raise InputError where too few rows are left to explain anything; a short file is shown where it ends.

    ``most`` is the number of rows that can be used; of all that do not only judge where it is not given.
    """
    rows = int((~joined.held_out).sum()) if most is None else most
    if rows >= FEWEST:
        return
    files = joined.files
    why = f" ({'; '.join(joined.notes)})" if joined.notes else ""
    held = f"holds {_FEW[rows]}" if len(files) == 1 else f"the files hold {_FEW[rows]} together"
    left = f"{_FEW[rows]} can be used" if why else held
    sentence = f"{left}; a diagnosis needs {FEWEST} rows at the very least, better fifty{why}"
    end = int(joined.lines[-1]) if rows and not why else None
    raise InputError([Fault(sentence, files[0], end) if len(files) == 1 else Fault(sentence)])


def _sigma(joined: DataRows) -> tuple[dict[str, Matrix], list[str]]:
    """Return the standard deviations that are given, by result; one of 0 is none."""
    deviations, notes = {}, []
    for name, values in joined.named("sigma").items():
        result = name.removeprefix(SIGMA)
        if result in joined.columns:
            deviations[result] = np.where(values > 0, values, np.nan)
            if zero := int((values == 0).sum()):
                notes.append(f"'{name}' is 0 in {counted(zero)}, which no gauge is; it counts as not given there")
    return deviations, notes


def _demand_logarithms(joined: DataRows, setup: Setup) -> None:
    """Raise InputError where a reading that is to be compared as a logarithm has none."""
    sentence = "{} is not above 0, so it has no logarithm; its noise cannot be lognormal"
    faults = [
        Fault(sentence.format(name), joined.files[joined.file_of[row]], int(joined.lines[row]))
        for name, values in joined.named("measured").items()
        if name in setup.diagnose.lognormal
        for row in np.flatnonzero(values <= 0)
    ]
    if faults:
        raise InputError(faults)


def _enough_values(joined: DataRows, setup: Setup) -> DataRows:
    """Leave out measured results with too few values to explain; raises InputError where none is left."""
    measured = joined.named("measured")
    _, sides, censored = censored_rows(joined, setup)
    known = {name: np.isfinite(each) & (sides.get(name, 0) == np.int8(0)) for name, each in measured.items()}
    values = {name: int(each[~joined.held_out].sum()) for name, each in known.items()}
    fewest = FEWEST_BESIDE if max(values.values()) >= FEWEST_BESIDE else FEWEST
    few = {name: count for name, count in values.items() if count < fewest}
    if len(few) == len(measured):
        _demand_rows(joined.noted(*censored), max(few.values()))
    columns = {name: column for name, column in joined.columns.items() if name not in few}
    more = f" to tell its noise; measure it {fewest} times or more" if fewest > FEWEST else ""
    said = [
        f"'{name}' is not used: {counted(count, 'value is', 'values are')} too few{more}" for name, count in few.items()
    ]
    readings = sum(count for name, count in values.items() if name not in few)
    if readings < FEWEST_READINGS:
        said.append(f"{readings} readings tell no cause from chance, so none is named; take twenty or more")
    return replace(joined, columns=columns).noted(*said)


def _answered(joined: DataRows, setup: Setup) -> DataRows:
    """Hold the rows against the model as it stands; leave out those in which it fails."""
    measured, machine = joined.named("measured"), one_machine(setup)
    demand_times(machine, rows_of(joined), lambda row: Fault("", joined.files[joined.file_of[row]], joined.lines[row]))
    shown = read_by_gauge(machine, rows_of(joined), measured)
    notes: list[str] = []
    joined = replace(joined, answers=shown.results)
    if shown.failed.any():
        first, reason = next(iter(shown.reasons.items()))
        why = {row: f"the model fails: {each}" for row, each in shown.reasons.items()}
        failed = counted(int(shown.failed.sum()), "row is", "rows are")
        source_line = f"{joined.files[joined.file_of[first]]}:{joined.lines[first]}"
        notes.append(f"{failed} left out where the model fails; the first is {source_line}: {reason}")
        if shown.failed.mean() > MOST_FAILED:
            notes += factor_that_works(joined, setup)
        joined = joined.without(shown.failed, why)
    columns = dict(joined.columns)
    for name in measured:
        unusable = {"that its axis does not reach": np.isnan(joined.answers[name])}
        if name in setup.diagnose.lognormal:
            unusable["in which the model says 0 or less, which has no logarithm"] = joined.answers[name] <= 0
        for words, rows in unusable.items():
            lost = rows & np.isfinite(columns[name])
            if lost.any():
                columns[name] = np.where(lost, np.nan, columns[name])
                notes.append(f"'{name}' is not used in {counted(int(lost.sum()))} {words}")
    return replace(joined, columns=columns).noted(*notes)
