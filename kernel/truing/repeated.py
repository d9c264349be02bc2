"""The model itself, called once for rows that come again and again: a fit asks for the same inputs many times.

Effects on results and on readings act after the model, so that rows which differ in their unknowns alone need it once.
"""

from __future__ import annotations

import os
from time import process_time
from typing import Any

import numpy as np

from truing.declare.batch import FailedRows
from truing.declare.chain import carried_by
from truing.declare.fields import read, with_values
from truing.declare.model import Model
from truing.declare.remembered import OF_MODELS, answered_before


def results_of(model: Model[Any, Any], inputs: Any, repeats: int, failed: FailedRows) -> Any:
    """Return the results of a model for rows that come ``repeats`` times, one copy of all behind another.

    It is called for one copy, and not at all where it was called with these inputs before. Where the copies differ, or
    effects act inside a chain, it is called for all. What fails is noted in ``failed``.
    """
    if carried_by(inputs).acting:
        return model.function(inputs)
    rows = len(failed.codes)
    values = {field.path: read(inputs, field.path) for field in model.input_fields.values()}
    arrays = {path: value for path, value in values.items() if isinstance(value, np.ndarray)}
    series = {field.path for field in model.input_fields.values() if field.spec.along}
    columns = {path: value for path, value in arrays.items() if path not in series and value.shape[:1] == (rows,)}
    count = rows // repeats
    if any(path in series and value.ndim > 1 for path, value in arrays.items()) or not all(
        _is_repeated(value, count) for value in columns.values()
    ):
        return model.function(inputs)
    one = {path: value[:count] for path, value in columns.items()}
    of_one = with_values(inputs, one)
    results = len(model.own_result_fields)
    known = answered_before(OF_MODELS, model.function, of_one, {**values, **one}, rows=count, results=results)
    _note(failed, known.failed, repeats)
    flat, fields = model.read_results(known.results), model.own_result_fields
    answers = {name: value for name, value in flat.items() if isinstance(value, np.ndarray) and value.ndim}
    of_rows = {
        name for name, value in answers.items() if len(value) == count and not (fields[name].along and value.ndim < 2)
    }
    copies = {  # never what is remembered itself: an effect may change an array in place
        fields[name].path: np.concatenate([value] * (repeats if name in of_rows else 1))
        for name, value in answers.items()
    }
    return with_values(known.results, copies)


def processor_seconds() -> float:
    """Return how long this process, and those that it has waited for, have kept a processor busy.

    What else the machine does is no part of it, so that a search is the same on a machine that is busy.
    """
    return process_time() + sum(os.times()[2:4])


def _is_repeated(value: np.ndarray[Any, Any], count: int) -> bool:
    """Whether a column is one copy of its first rows behind another, values that are not given included."""
    if len(value) == count:
        return True
    copies = value.reshape(-1, count, *value.shape[1:])
    is_same = (copies == copies[0]) | ((copies != copies) & (copies[0] != copies[0]))
    return bool(is_same.all())


def _note(failed: FailedRows, own: FailedRows, repeats: int) -> None:
    """Note what failed in one copy for all of them."""
    for number, sentence in enumerate(own.sentences, start=1):
        failed.add(np.tile(own.codes == number, repeats), sentence)
    for name, lacking in own.of.items():
        _note(failed.of.setdefault(name, FailedRows(len(failed.codes))), lacking, repeats)
