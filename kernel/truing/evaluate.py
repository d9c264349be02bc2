"""Running the model: one calculation, or a batch of rows in one call, with the effects that are on.

Columns of a batch are named by input, by condition, or by ``effects.NAME.UNKNOWN``; all values are SI.
"""

from __future__ import annotations

import traceback
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from truing.declare.batch import watching
from truing.declare.fields import Axis, with_values
from truing.errors import InfeasibleError, PluginError, TruingError
from truing.setup import Setup, SwitchedOn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Rows:
    """What a batch answered: results by flat name, shape (n,) or (n, k), NaN in failed rows; why rows failed."""

    results: Mapping[str, NDArray[np.float64]]
    failed: NDArray[np.bool_]
    reasons: Mapping[int, str]

    def __len__(self) -> int:
        return len(self.failed)


def effect_column(effect: str, unknown: str) -> str:
    """Return the column name of an effect's unknown."""
    return f"effects.{effect}.{unknown}"


def evaluate(setup: Setup, *, reading: bool = False) -> Any:
    """Run the calculation once and return the model's results.

    Raises InfeasibleError with the sentence of the plugin where something impossible is asked, and where a result is
    not finite; PluginError, with the place, where the plugin's code fails.
    """
    import numpy as np

    with np.errstate(all="ignore"):
        results = _apply(setup, {}, reading=reading)
    for name, value in setup.model.read_results(results).items():
        if not np.all(np.isfinite(np.asarray(value, dtype=float))):
            raise InfeasibleError(f"the result '{name}' of {setup.model.name} is not finite for these inputs")
    return results


def evaluate_rows(
    setup: Setup,
    columns: Mapping[str, Any],
    rows: int,
    *,
    reading: bool = False,
    wanted: Collection[str] | None = None,
) -> Rows:
    """Run ``rows`` calculations, as one array call wherever the declaration allows it.

    A column holds (rows,) values or one value for all. Only ``wanted`` results are returned (all by default). Failed
    rows are NaN in every result and keep their reason.
    """
    import numpy as np

    names = [name for name in setup.model.own_result_fields if wanted is None or name in wanted]
    gathered: dict[str, Any] = {}
    failed = np.zeros(rows, dtype=bool)
    reasons: dict[int, str] = {}
    for index, part in _uniform_parts(setup, columns, rows):
        count = rows if index is None else len(index)
        answers, part_failed, part_reasons = _one_call(setup, part, count, names, reading=reading)
        where = slice(None) if index is None else index
        failed[where] = part_failed
        reasons.update({(row if index is None else int(index[row])): text for row, text in part_reasons.items()})
        for name, values in answers.items():
            if index is None:
                gathered[name] = values
            elif name not in gathered or gathered[name].shape[1:] == values.shape[1:]:
                gathered.setdefault(name, np.full((rows, *values.shape[1:]), np.nan))[where] = values
    return Rows(gathered, failed, dict(sorted(reasons.items())))


def _one_call(
    setup: Setup, columns: Mapping[str, Any], rows: int, names: Collection[str], *, reading: bool
) -> tuple[dict[str, Any], NDArray[np.bool_], dict[int, str]]:
    import numpy as np

    with np.errstate(all="ignore"), watching(rows) as log:
        results = _apply(setup, columns, reading=reading)
        flat = setup.model.read_results(results)
        answers = {name: _as_rows(setup, name, flat[name], rows) for name in names}
        for name, values in answers.items():
            finite = np.isfinite(values)
            if not finite.all():
                whole = finite if finite.ndim == 1 else finite.all(axis=tuple(range(1, finite.ndim)))
                log.add(~whole, f"the result '{name}' is not finite")
    failed = log.codes > 0
    reasons: dict[int, str] = {}
    if failed.any():
        reasons = {int(row): log.sentences[log.codes[row] - 1] for row in np.flatnonzero(failed)}
        for name, values in answers.items():
            answers[name] = values = np.array(values)
            values[failed] = np.nan
    return answers, failed, reasons


def _as_rows(setup: Setup, name: str, value: Any, rows: int) -> NDArray[np.float64]:
    import numpy as np

    array = np.asarray(value, dtype=float)
    if array.ndim and array.shape[0] == rows and not (setup.model.own_result_fields[name].along and array.ndim == 1):
        return array
    return np.broadcast_to(array, (rows, *array.shape))


def _uniform_parts(setup: Setup, columns: Mapping[str, Any], rows: int) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Split a batch so that everything but Float inputs has one value; tables are made row by row."""
    import numpy as np

    fields = setup.model.input_fields
    fixed = {name: values for name, values in columns.items() if name in fields and not fields[name].varies}
    arrays = {name: np.asarray(values, dtype=float) for name, values in columns.items() if name not in fixed}
    makes_table = any(isinstance(item.spec, Axis) and item.spec.is_table for item in setup.model.own_result_fields.values())
    if makes_table:
        groups = [np.array([row]) for row in range(rows)]
    elif fixed:
        groups = _groups(fixed, rows)
    else:
        yield None, arrays
        return
    for index in groups:
        part = {name: _taken(values, index, alone=makes_table) for name, values in arrays.items()}
        for name, values in fixed.items():
            part[name] = values[index[0]] if isinstance(values, (list, tuple, np.ndarray)) else values
        yield index, part


def _taken(values: NDArray[np.float64], index: NDArray[Any], *, alone: bool) -> Any:
    if not values.ndim:
        return values
    return float(values[index[0]]) if alone else values[index]


def _groups(fixed: Mapping[str, Any], rows: int) -> list[NDArray[Any]]:
    import numpy as np

    places: dict[tuple[Any, ...], list[int]] = {}
    for row in range(rows):
        key = tuple(v[row] if isinstance(v, (list, tuple, np.ndarray)) else v for v in fixed.values())
        places.setdefault(key, []).append(row)
    return [np.array(indices) for indices in places.values()]


def _apply(setup: Setup, columns: Mapping[str, Any], *, reading: bool) -> Any:
    """Inputs, effects on inputs, model, effects on results, effects on the reading: in this order."""
    model, fields = setup.model, setup.model.input_fields
    changed = {fields[name].path: value for name, value in columns.items() if name in fields}
    inputs = with_values(setup.inputs, changed) if changed else setup.inputs
    switched = [(item, _keywords(item, setup, columns)) for item in setup.effects]
    try:
        for item, keywords in switched:
            if item.effect.place == "inputs":
                inputs = item.effect.function(inputs, **keywords)
        results = model.function(inputs)
        for place in ("results", "reading") if reading else ("results",):
            for item, keywords in switched:
                if item.effect.place == place:
                    results = item.effect.function(inputs, results, **keywords)
    except TruingError:
        raise
    except Exception as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        raise PluginError(
            f"{frame.filename}:{frame.lineno}: {model.name} failed: {type(error).__name__}: {error}"
        ) from error
    return results


def _keywords(item: SwitchedOn, setup: Setup, columns: Mapping[str, Any]) -> dict[str, Any]:
    unknowns = {
        unknown.name: columns.get(effect_column(item.effect.name, unknown.name), item.values[unknown.name])
        for unknown in item.effect.unknowns
    }
    conditions = {need.name: columns.get(need.name, setup.conditions[need.name]) for need in item.effect.needs}
    return {**unknowns, **conditions}


def effects_in_order(setup: Setup) -> Setup:
    """Return the setup with its effects in the order of the model's declaration."""
    order = list(setup.model.effects)
    return replace(setup, effects=tuple(sorted(setup.effects, key=lambda item: order.index(item.effect.name))))
