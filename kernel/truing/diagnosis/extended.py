"""The extended model, and the one place that calls it: causes with their numbers on, the inputs moved, all rows."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from truing.diagnosis.budget import Budget
from truing.diagnosis.causes import Cause, at_rest
from truing.diagnosis.machine import Machine, Tolerated, predict_each
from truing.errors import PluginError
from truing.evaluate import effect_column
from truing.repeated import REMEMBERED as REPEATED
from truing.setup import Setup, SwitchedOn

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

REMEMBERED = 64
"""So many setups with moved inputs are kept, and what the model showed at so many points."""
LARGEST = 1_000_000
"""So many rows of what the model showed are kept."""
Key = tuple[frozenset[str], bytes]
Point = tuple[Sequence["Matrix"], "Matrix"]
"""The numbers of every cause, SI, and how far each tolerated input is moved, in standard deviations from its mean."""


class Extended:
    """A machine whose model can have causes on.

    ``calls`` counts calls of the model on all rows: points that differ in what acts after the model are one.
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.calls, self.budget = 0, Budget()
        self.grain: dict[str, float] = {}
        """By result: by how much the answers of the model jump or scatter by themselves, SI."""
        self.most_points: int | None = None
        """At so many points each effect may be looked at; None for all there are."""
        self._asked: deque[bytes] = deque(maxlen=REPEATED)
        self._setups: dict[frozenset[str], Setup] = {}
        self._shown: dict[Key, Mapping[str, Matrix]] = {}
        self._machines: dict[tuple[frozenset[str], bytes], Setup] = {}

    def at(self, causes: Sequence[Cause], points: Sequence[Point]) -> list[dict[str, Matrix]]:
        """Return what the gauges show at several points, by result, SI on all rows; NaN where the model fails.

        Shapes that nobody registered are added to what the model shows: points that differ in them alone are one call.
        """
        own = [place for place, cause in enumerate(causes) if cause.shape is None]
        kept = [causes[place] for place in own]
        bare = [([values[place] for place in own], moved) for values, moved in points]
        tags = frozenset(cause.tag for cause in kept)
        keys = [(tags, b"".join(np.asarray(each).tobytes() for each in (*values, moved))) for values, moved in bare]
        new = {key: point for key, point in zip(keys, bare, strict=True) if key not in self._shown}
        shown = {**self._shown, **dict(zip(new, self._called(kept, list(new.values())), strict=True))}
        self._remember({key: shown[key] for key in keys})
        return [
            {name: base + _of_shapes(self.machine, causes, values, name) for name, base in shown[key].items()}
            for key, (values, _) in zip(keys, points, strict=True)
        ]

    def _called(self, causes: Sequence[Cause], points: Sequence[Point]) -> list[Mapping[str, Matrix]]:
        """Call the model at several points, as one batch where it can be."""
        if not points:
            return []
        setup, is_one = self._with(causes), self._share_inputs(causes, points)
        if is_one:
            setup = self._moved(setup, frozenset(cause.tag for cause in causes), points[0][1])
        trials = [_unknowns(self.machine, causes, values) for values, _ in points]
        if not is_one:
            trials = [{**own, **self._inputs(causes, *point)} for own, point in zip(trials, points, strict=True)]
        self._count(causes, points)
        try:
            return list(predict_each(setup, self.machine.records, trials))
        except PluginError:  # the model's own code breaks at some of them
            return [self._survived(setup, trial) for trial in trials]

    def _survived(self, setup: Setup, trial: Mapping[str, Any]) -> Mapping[str, Matrix]:
        """Return what the gauges show in one trial; NaN where the model's own code breaks."""
        try:
            (shown,) = predict_each(setup, self.machine.records, [trial])
        except PluginError:
            return {name: np.full(len(self.machine.records), np.nan) for name in self.machine.records.measured}
        return shown

    def _count(self, causes: Sequence[Cause], points: Sequence[Point]) -> None:
        """Count the calls that some points cost; records along an axis are calculated anew for every one."""
        if self.machine.records.rows.series:
            self.calls += len(points)
            return
        for values, moved in points:
            own = zip(causes, values, strict=True)
            before = [f"{each.tag}={value.tolist()}" for each, value in own if each.acts_on_inputs]
            key = repr((before, moved.tolist())).encode()
            if key not in self._asked:
                self.calls += 1
                self._asked.append(key)

    def costs(self, cause: Cause) -> bool:
        """Whether every point of a cause is a call of the model: what acts after it needs it once."""
        return cause.effect is not None and (cause.acts_on_inputs or bool(self.machine.records.rows.series))

    @property
    def lasts(self) -> bool:
        """Whether the budget of calls lasts in this stage of the search."""
        return self.budget.lasts(self.calls)

    def allows(self, what: str) -> bool:
        """Whether the budget lasts for one thing more; what it does not last for is counted."""
        return self.budget.allows(self.calls, what)

    def _remember(self, latest: Mapping[Key, Mapping[str, Matrix]]) -> None:
        """Keep what the model showed last: a fit goes on from there."""
        few = max(1, LARGEST // max(len(self.machine.records), 1))
        self._shown = dict(list({**self._shown, **latest}.items())[-min(few, REMEMBERED) :])

    def _with(self, causes: Sequence[Cause]) -> Setup:
        """Return the setup with the effects of these causes on; parts of one effect are on together."""
        tags = frozenset(cause.tag for cause in causes if cause.effect is not None)
        if tags not in self._setups:
            values: dict[str, dict[str, float]] = {}
            effects = {}
            for cause in causes:
                if cause.effect is not None:
                    values.setdefault(cause.name, {}).update(at_rest(cause, self.machine))
                    effects[cause.name] = cause.effect
            on = tuple(SwitchedOn(effects[name], own) for name, own in values.items())
            self._setups[tags] = self.machine.start.with_effects(on) if on else self.machine.start
        return self._setups[tags]

    def _share_inputs(self, causes: Sequence[Cause], points: Sequence[Point]) -> bool:
        """Whether all points have the same inputs, each one value for all rows: then they are the machine's."""
        is_plain = all(cause.tolerated < 0 for cause in causes) and all(item.file < 0 for item in self.machine.inputs)
        return is_plain and all(np.array_equal(moved, points[0][1]) for _, moved in points)

    def _moved(self, setup: Setup, tags: frozenset[str], moved: Matrix) -> Setup:
        """Return a setup with its tolerated inputs moved."""
        key = tags, np.asarray(moved).tobytes()
        if key not in self._machines:
            if len(self._machines) >= REMEMBERED:
                self._machines.clear()
            values = {item.name: self._value(item, sds) for item, sds in zip(self.machine.inputs, moved, strict=True)}
            self._machines[key] = setup.changed(values)
        return self._machines[key]

    def _value(self, given: Tolerated, sds: float) -> float:
        """Return a tolerated input so many standard deviations from its mean, SI."""
        return float(self.machine.start.nominal(given.name)) + given.mean + float(sds) * given.sd

    def _inputs(self, causes: Sequence[Cause], values: Sequence[Matrix], moved: Matrix) -> dict[str, Any]:
        """Return the columns that set every tolerated input, SI, (n,)."""
        files, off = self.machine.records.file_of, np.array(moved, dtype=float)
        made: dict[str, Any] = {}
        for cause, own in zip(causes, values, strict=True):
            if cause.tolerated >= 0:
                off[cause.tolerated] += own[0]
        for given, sds in zip(self.machine.inputs, off, strict=True):
            made[given.name] = _in_file(made.get(given.name), given.file, files, self._value(given, sds))
        return _columns(made, len(files))


def _unknowns(machine: Machine, causes: Sequence[Cause], values: Sequence[Matrix]) -> dict[str, Any]:
    """Return the columns that set every unknown, SI, (n,)."""
    made: dict[str, Any] = {}
    for cause, own in zip(causes, values, strict=True):
        for number, value in zip(cause.numbers, own, strict=True) if cause.effect is not None else ():
            column = effect_column(cause.name, number.name)
            made[column] = _in_file(made.get(column), number.file, machine.records.file_of, float(value))
    return _columns(made, len(machine.records))


def _columns(made: dict[str, Any], size: int) -> dict[str, Any]:
    return {name: np.broadcast_to(value, (size,)) for name, value in made.items()}


def _in_file(held: Any, file: int, files: Any, value: float) -> Any:
    """Return a value for all rows, or one per row that holds in its file."""
    if file < 0:
        return value
    before = np.zeros(len(files)) if held is None else np.broadcast_to(held, (len(files),))
    return np.where(files == file, value, before)


def _of_shapes(machine: Machine, causes: Sequence[Cause], values: Sequence[Matrix], name: str) -> Any:
    """Return what unregistered shapes add to a result, SI: an array (n,), or 0 where there are none."""
    added: Any = 0.0
    for cause, own in zip(causes, values, strict=True):
        if cause.shape is not None:
            added = added + shape_added(machine, cause, own).get(name, 0.0)
    return added


def shape_added(machine: Machine, cause: Cause, values: Matrix) -> dict[str, Matrix]:
    """Return what a shape that nobody registered adds, by result it acts on, SI on all rows."""
    shape = cause.shape
    if shape is None:
        return {}
    terms = shape.terms([float(values[place]) for place in cause.shapes], machine.records.covariates)
    amplitudes = iter([float(values[place]) for place in cause.amplitudes])
    return {name: np.asarray(sum(next(amplitudes) * term.values for term in terms)) for name in shape.results}


def elsewhere(extended: Extended, machine: Machine) -> Extended:
    """Return the same extension on other rows."""
    other = Extended(machine)
    other._setups, other.grain = dict(extended._setups), extended.grain
    return other


def parts_of(causes: Sequence[Cause], flat: Matrix) -> list[Matrix]:
    """Cut the numbers of all causes, one behind another, into those of each."""
    ends = np.cumsum([cause.size for cause in causes])[:-1]
    return [np.asarray(part) for part in np.split(flat, ends)] if causes else []


def switched_on(causes: Sequence[Cause], values: Sequence[Matrix], machine: Machine) -> Iterator[SwitchedOn]:
    """Give the effects of an explanation as they are on, with their fitted unknowns (SI); of files, their mean."""
    merged: dict[str, tuple[Cause, dict[str, list[float]]]] = {}
    for cause, own in zip(causes, values, strict=True):
        if cause.effect is not None:
            _, known = merged.setdefault(cause.name, (cause, {}))
            for number, value in zip(cause.numbers, own, strict=True):
                known.setdefault(number.name, []).append(float(value))
    for name, (cause, known) in merged.items():
        effect = cause.effect
        if effect is None:
            continue
        before: Mapping[str, float] = next(
            (item.values for item in machine.start.effects if item.effect.name == name), {}
        )
        rest = {} if effect.parts and effect.takes_any else at_rest(replace(cause, numbers=cause.numbers), machine)
        stated = {key: sum(every) / len(every) for key, every in known.items()}
        yield SwitchedOn(effect, {**rest, **before, **stated})
