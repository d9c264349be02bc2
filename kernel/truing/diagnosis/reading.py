"""Measured files to records that can be explained: read, put in order, joined, held against the model once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.covariates import censored_rows, covariates_of, held_out_rows
from truing.diagnosis.data_file import DataRows, objects, read_data_files
from truing.diagnosis.joining import complete_rows, join, measured_rows, rows_of, settle_conditions
from truing.diagnosis.records import FEWEST_READINGS, Records
from truing.diagnosis.tidying import numbered, tidy
from truing.diagnosis.unit_errors import factor_that_works, suspected_unit_errors
from truing.errors import Fault, InputError
from truing.gauge import one_machine, read_by_gauge
from truing.inputs_file.files import digest_of
from truing.kernel import Offer
from truing.measurements import TableSource, TableText
from truing.measurements.table import SIGMA
from truing.numbers import counted
from truing.setup import Setup

FEWEST = 3
"""Fewer rows are no record."""
FEWEST_BESIDE = 6
"""Of a result beside others: from fewer values its noise cannot be told, and any cause would fit them exactly."""
MOST_FAILED = 0.5
"""A model that fails in a larger share of the rows is not the model of this record."""
_FEW = ("no row", "one row", "two rows")


def read_records(paths: Sequence[TableSource], offer: Offer, setup: Setup, *, with_unit_errors: bool = True) -> Records:
    """Read measured files as the records of one machine; everything odd is counted and said in ``notes``.

    ``with_unit_errors`` looks for units that were written wrong, which asks the model for every column and factor.
    A column is an input, a result (measured), a condition of an effect, ``sigma_NAME``, ``run``, or anything else that
    an error may depend on. Raises InputError with every fault of every file: nothing measured, a unit that is unknown
    or of another dimension, cells that are no numbers, columns without any value, fewer than three rows.
    """
    files = _read(paths, offer)
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
        digests={str(path): path.digest if isinstance(path, TableText) else digest_of(path) for path in paths},
    )


def _read(paths: Sequence[TableSource], offer: Offer) -> list[DataRows]:
    """Read every file and put its rows in order, runs of several told apart; raises InputError with all faults."""
    once = {path.resolve() if isinstance(path, Path) else path: path for path in reversed(paths)}
    named = list(reversed(once.values()))
    files: list[DataRows] = []
    for path, file in zip(named, read_data_files(named, offer), strict=True):
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
    measured = joined.named("measured")
    shown = read_by_gauge(one_machine(setup), rows_of(joined), measured)
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
