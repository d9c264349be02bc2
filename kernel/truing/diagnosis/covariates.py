"""What an error may depend on: inputs, conditions, time, and every other column of numbers."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np

from truing.arrays import Mask, Sides
from truing.declare.builtin import may_stand
from truing.declare.near_miss import near_miss
from truing.diagnosis.causes import reading_of
from truing.diagnosis.data_file import ColumnRole, DataRows
from truing.diagnosis.records import Covariate, Role
from truing.diagnosis.tidying import is_angle
from truing.errors import Fault, InputError
from truing.measurements.derived import TIME
from truing.measurements.table import SIGMA
from truing.numbers import counted
from truing.setup import Setup, column_and_word
from truing.units import same_dimension, to_si
from truing.units.grammar import shown
from truing.units.names import PURE

ORDER = "order"
_ROLES: dict[ColumnRole, Role] = {
    "input": "input", "series": "input", "word": "input", "condition": "condition", "axis": "other", "other": "other",
}  # fmt: skip


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
