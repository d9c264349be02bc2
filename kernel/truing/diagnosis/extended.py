"""The extended model, and the one place that calls it: causes with their numbers on, the inputs moved, all rows."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import accumulate
from math import inf, log10
from typing import Any, TypeVar

import numpy as np

from truing.arrays import Indices, Matrix
from truing.declare.following import NotedError, following_together
from truing.declare.remembered import REMEMBERED as REPEATED
from truing.declare.remembered import forget
from truing.declare.sources import Effect
from truing.diagnosis.causes import Candidate, at_rest
from truing.diagnosis.machine import Calibration, Tolerated, predict_each
from truing.diagnosis.side_by_side import asked_beside, side_by_side
from truing.errors import PluginError
from truing.gauge import Trial
from truing.repeated import processor_seconds
from truing.setup import Setup, SwitchedOn, effect_column

T = TypeVar("T")
REMEMBERED = 64
"""So many setups with moved inputs are kept, and what the model showed at so many points."""
MOVING_REMEMBERED = 2048
"""The same of a model that moves, of which many points are asked for at once."""
ROWS_KEPT = 1_000_000
"""So many rows of what the model showed are kept."""
LEAST_PER_EFFECT = 40
"""Calls for every effect on the inputs that are given however long they take: fewer show none of them as it is."""
MORE = 4
"""So many times the budget is proposed where it ended first."""
QUICK_CALL = 0.03
"""Processor seconds of a call below which a search needs no budget: it makes a few thousand calls."""
MINUTES = 300.0
"""Seconds that the calls of a search may take where no budget is stated."""
CURVES = 0.25
"""Share of the calls in which all curves are to be made."""
FEWEST_POINTS = 6
"""At so many points at least an effect is looked at: fewer say nothing about how it bends."""
PROBE = 1.23456789
"""Standard deviations, or tenths of a range, by which something is moved to see what the model is like there.

It is no round number, so that answers are multiples of a step only where the model makes them so.
"""
FINE, COARSE = 1e-9, 1e-6
"""Shares of the largest answer: what lies nearer to a multiple is one, and no step is smaller."""
FEWEST_DISTINCT = 6
"""So many answers that differ must be multiples of one step."""
ROUNDING = 1e-12
"""Share of the largest answer by which two calls may differ: how libraries round depends on where an array lies."""
Key = tuple[tuple[str, ...], bytes]
Point = tuple[Sequence[Matrix], Matrix]
"""The numbers of every cause, SI, and how far each tolerated input is moved, in standard deviations from its mean."""
Request = tuple[Sequence[Candidate], Sequence[Point]]
"""Causes that are on, and points of them at which the model is asked what the gauges show."""
Predictions = list[dict[str, Matrix]]
"""What the gauges show at several points, by result, SI on all rows."""


@dataclass(frozen=True)
class _Asked:
    """What a request asks of the model itself: its causes but for shapes, its points, and what tells these apart."""

    causes: list[Candidate]
    points: list[Point]
    keys: list[Key]


@dataclass
class CallBudget:
    """So many calls of the model on all rows, of which the present stage of the search may spend up to a share.

    ``takes`` is how long a call takes, in seconds, a power of ten; 0 where the number is stated. ``left_out`` counts
    what was not tried, ``unseen`` names effects that were not looked at. ``points`` says at how many points each effect
    may be asked for its curves; None for all there are.
    """

    calls: float = inf
    takes: float = 0.0
    share: float = 1.0
    left_out: dict[str, int] = field(default_factory=dict)
    unseen: list[str] = field(default_factory=list)
    points: int | None = None

    @property
    def is_dear(self) -> bool:
        """Whether calls are counted at all."""
        return self.calls < inf

    def of_rows(self, ratio: float) -> CallBudget:
        """Return what the same time allows on so many times as many rows; what it leaves out is told with the rest."""
        return replace(self, calls=max(self.calls / ratio, LEAST_PER_EFFECT), share=1.0, points=None)

    def told(self) -> tuple[str, ...]:
        """Say what the budget left out, in one sentence; nothing where it did not end."""
        parts = [f"{what} ({count})" for what, count in self.left_out.items()]
        if self.unseen:
            parts.insert(0, f"any look at {', '.join(dict.fromkeys(self.unseen))}")
        if not parts:
            return ()
        calls = int(self.calls)
        time = f", of which one takes about {self.takes:g} s," if self.takes else ""
        return (
            f"the search ended after {calls} calls of the model{time} and left out: {', '.join(parts)}; another "
            f"explanation may lie there; look further with [studies.diagnose] budget = {MORE * calls}",
        )


class Extended:
    """A machine whose model can have causes on.

    ``calls`` counts calls of the model on all rows: points that differ in what acts after the model are one.
    """

    def __init__(self, machine: Calibration) -> None:
        self.machine = machine
        self.calls, self.budget = 0, CallBudget()
        self.grain: dict[str, float] = {}
        """By result: by how much the answers of the model jump or scatter by themselves, SI."""
        self._asked: deque[tuple[tuple[str, ...], bytes, bytes]] = deque(maxlen=REPEATED)
        self._setups: dict[tuple[str, ...], Setup] = {}
        self._shown: dict[Key, Mapping[str, Matrix]] = {}
        self._machines: dict[Key, Setup] = {}
        self._terms: dict[tuple[str, tuple[float, ...]], list[Matrix]] = {}

    def at(self, causes: Sequence[Candidate], points: Sequence[Point]) -> Predictions:
        """Return what the gauges show at several points, by result, SI on all rows; NaN where the model fails.

        Shapes that nobody registered are added to what the model shows: points that differ in them alone are one call.
        """
        (shown,) = self.at_each([(causes, points)])
        return shown

    def at_each(self, requests: Sequence[Request]) -> list[Predictions]:
        """Return the same for several requests; those of the same causes are one call of the model."""
        return asked_beside((self, requests), lambda _: self._at_each(requests))

    def side_by_side(self, several: Sequence[Callable[[], T]]) -> list[T]:
        """Return what several tasks make that ask for predictions; of a model that moves they ask together."""
        if not self.is_moving or len(several) < 2:
            return [task() for task in several]
        return side_by_side(several, _answered)

    def _at_each(self, requests: Sequence[Request]) -> list[Predictions]:
        every = [_asked(*request) for request in requests]
        new, waiting = [], set(self._shown)
        for asked in every:
            rest = {key: p for key, p in zip(asked.keys, asked.points, strict=True) if key not in waiting}
            waiting.update(rest)
            if rest:
                new.append(_Asked(asked.causes, list(rest.values()), list(rest)))
        groups = _grouped(new)
        if self.is_moving:
            self._follow_together(groups)
        for group in groups:
            for asked in group if not self.is_moving else ():
                self._count(asked.causes, asked.points)
            answers = self._called(group[0].causes, [point for asked in group for point in asked.points])
            self._shown.update(zip((key for asked in group for key in asked.keys), answers, strict=True))
        shown = [[self._shown[key] for key in asked.keys] for asked in every]
        for old in list(self._shown)[: -self._most_shown]:  # a fit goes on from the last
            del self._shown[old]
        return [
            [self._with_shapes(base, causes, values) for base, (values, _) in zip(own, points, strict=True)]
            for own, (causes, points) in zip(shown, requests, strict=True)
        ]

    @property
    def is_moving(self) -> bool:
        """Whether the model follows states along its record, so that machines of all kinds are one call of it."""
        return self.machine.start.model.dynamics is not None

    def _follow_together(self, groups: Sequence[Sequence[_Asked]]) -> None:
        """Follow in one call what several groups of requests need."""
        if not groups:
            return
        with following_together() as asked:
            for group in groups:
                with suppress(NotedError):
                    self._called(group[0].causes, [point for each in group for point in each.points])
        self.calls += asked.new > 0

    @property
    def _most_shown(self) -> int:
        """So many answers of the model are kept."""
        most = MOVING_REMEMBERED if self.is_moving else REMEMBERED
        return min(most, max(1, ROWS_KEPT // max(len(self.machine.records), 1)))

    def _with_shapes(
        self, shown: Mapping[str, Matrix], causes: Sequence[Candidate], values: Sequence[Matrix]
    ) -> dict[str, Matrix]:
        """Return what is shown with what unregistered shapes add to it, SI, (n,)."""
        pairs = zip(causes, values, strict=True)
        added = [_added(cause, own, self._terms_of(cause, own)) for cause, own in pairs if cause.shape is not None]
        return {name: base + sum(each[name] for each in added if name in each) for name, base in shown.items()}

    def _terms_of(self, cause: Candidate, values: Matrix) -> list[Matrix]:
        """Return the terms of an unregistered shape; a fit asks for the same ones again and again."""
        key = cause.tag, tuple(float(values[index]) for index in cause.shapes)
        if key not in self._terms:
            if len(self._terms) >= self._most_shown:
                self._terms.clear()
            self._terms[key] = terms_of(self.machine, cause, values)
        return self._terms[key]

    def _called(self, causes: Sequence[Candidate], points: Sequence[Point]) -> list[Mapping[str, Matrix]]:
        """Call the model at several points, as one batch where it can be."""
        if not points:
            return []
        setup, trials = self._with(causes), [_unknowns(self.machine, causes, values) for values, _ in points]
        is_plain = all(cause.tolerated < 0 for cause in causes) and all(
            tolerated.file < 0 for tolerated in self.machine.inputs
        )
        if is_plain and all(np.array_equal(moved, points[0][1]) for _, moved in points):  # the inputs of all rows
            setup = self._moved(setup, tuple(cause.tag for cause in causes), points[0][1])
        else:
            trials = [{**own, **self._inputs(causes, *point)} for own, point in zip(trials, points, strict=True)]
        return self._survived(setup, trials)

    def _survived(self, setup: Setup, trials: Sequence[Trial]) -> list[Mapping[str, Matrix]]:
        """Return what the gauges show in some trials; NaN in those in which the model's own code breaks."""
        records = self.machine.records
        try:
            return list(predict_each(setup, records, trials))
        except PluginError:
            if len(trials) > 1:
                return [self._survived(setup, [trial])[0] for trial in trials]
            return [{name: np.full(len(records), np.nan) for name in records.measured}]

    def _count(self, causes: Sequence[Candidate], points: Sequence[Point]) -> None:
        """Count the calls that some points cost; records along an axis are calculated anew for every one."""
        if self.machine.records.rows.series:
            self.calls += len(points)
            return
        for values, moved in points:
            own = [(cause.tag, value) for cause, value in zip(causes, values, strict=True) if cause.acts_on_inputs]
            sizes = b"".join(np.asarray(value).tobytes() for _, value in own)
            key = tuple(tag for tag, _ in own), sizes, moved.tobytes()
            if key not in self._asked:
                self.calls += 1
                self._asked.append(key)

    def costs(self, cause: Candidate) -> bool:
        """Whether every point of a cause is a call of the model: what acts after it needs it once."""
        return cause.effect is not None and (cause.acts_on_inputs or bool(self.machine.records.rows.series))

    @property
    def lasts(self) -> bool:
        """Whether the budget of calls lasts in this stage of the search."""
        return self.calls < self.budget.share * self.budget.calls

    def allows(self, what: str) -> bool:
        """Whether the budget lasts for one thing more; what it does not last for is counted."""
        if not self.lasts:
            self.budget.left_out[what] = self.budget.left_out.get(what, 0) + 1
        return self.lasts

    def _with(self, causes: Sequence[Candidate]) -> Setup:
        """Return the setup with the effects of these causes on; parts of one effect are on together."""
        tags = tuple(cause.tag for cause in causes if cause.effect is not None)
        if tags not in self._setups:
            resting = ((cause.effect, at_rest(cause, self.machine)) for cause in causes)
            on = [SwitchedOn(effect, rest) for effect, rest in resting if effect is not None]
            self._setups[tags] = self.machine.start.with_effects(on) if on else self.machine.start
        return self._setups[tags]

    def _moved(self, setup: Setup, tags: tuple[str, ...], moved: Matrix) -> Setup:
        """Return a setup with its tolerated inputs moved."""
        key = tags, np.asarray(moved).tobytes()
        if key not in self._machines:
            if len(self._machines) >= REMEMBERED:
                self._machines.clear()
            values = {
                tolerated.name: self._value(tolerated, sds)
                for tolerated, sds in zip(self.machine.inputs, moved, strict=True)
            }
            self._machines[key] = setup.changed(values)
        return self._machines[key]

    def _value(self, given: Tolerated, sds: float) -> float:
        """Return a tolerated input so many standard deviations from its mean, SI."""
        return float(self.machine.start.nominal(given.name)) + given.mean + float(sds) * given.sd

    def _inputs(self, causes: Sequence[Candidate], values: Sequence[Matrix], moved: Matrix) -> dict[str, Any]:
        """Return the columns that set every tolerated input, SI, (n,)."""
        off = np.array(moved, dtype=float)
        for cause, own in zip(causes, values, strict=True):
            if cause.tolerated >= 0:
                off[cause.tolerated] += own[0]
        inputs = zip(self.machine.inputs, off, strict=True)
        settings = ((given.name, given.file, self._value(given, sds)) for given, sds in inputs)
        return _columns(settings, self.machine.records.file_of)


def _answered(asked: list[tuple[Extended, Sequence[Request]]]) -> list[list[Predictions]]:
    """Answer what several tasks ask, those of one extended model together."""
    answers: dict[int, list[Predictions]] = {}
    for extended in {id(extended): extended for extended, _ in asked}.values():
        own = [(index, requests) for index, (each, requests) in enumerate(asked) if each is extended]
        made = iter(extended.at_each([request for _, requests in own for request in requests]))
        answers |= {index: [next(made) for _ in requests] for index, requests in own}
    return [answers[index] for index in range(len(asked))]


def _asked(causes: Sequence[Candidate], points: Sequence[Point]) -> _Asked:
    """Return what a request asks of the model itself; effects act in the order in which they are declared."""
    own = sorted((i for i, cause in enumerate(causes) if cause.shape is None), key=lambda i: causes[i].tag)
    tags = tuple(causes[index].tag for index in own)
    bare: list[Point] = [([values[index] for index in own], moved) for values, moved in points]
    keys = [(tags, b"".join(np.asarray(each).tobytes() for each in (*values, moved))) for values, moved in bare]
    return _Asked([causes[index] for index in own], bare, keys)


def _grouped(several: Sequence[_Asked]) -> list[list[_Asked]]:
    """Put requests of the same causes together, which may be one call.

    Where nothing acts on the inputs the model is called for one point alone, so that all of these must have the same.
    """
    groups: dict[tuple[tuple[str, ...], bytes], list[_Asked]] = {}
    for asked in several:
        is_called = any(cause.acts_on_inputs for cause in asked.causes)
        tags, _ = asked.keys[0]
        groups.setdefault((tags, b"" if is_called else asked.points[0][1].tobytes()), []).append(asked)
    return list(groups.values())


def _unknowns(machine: Calibration, causes: Sequence[Candidate], values: Sequence[Matrix]) -> dict[str, Any]:
    """Return the columns that set every unknown, SI, (n,)."""
    settings = (
        (effect_column(cause.name, number.name), number.file, float(value))
        for cause, own in zip(causes, values, strict=True)
        if cause.effect is not None
        for number, value in zip(cause.numbers, own, strict=True)
    )
    return _columns(settings, machine.records.file_of)


def _columns(settings: Iterable[tuple[str, int, float]], files: Indices) -> dict[str, Any]:
    """Return columns (n,) that have each value in the rows of its file, or in all where the file is -1."""
    made: dict[str, Any] = {}
    for name, file, value in settings:
        everywhere = file < 0
        made[name] = _alike(value, len(files)) if everywhere else np.where(files == file, value, made.get(name, 0.0))
    return made


def _alike(value: float, rows: int) -> Matrix:
    """Return a column that has one value, as ``numpy.broadcast_to`` does in ten times its time."""
    return np.ndarray((rows,), float, np.float64(value), strides=(0,))


def shape_added(machine: Calibration, cause: Candidate, values: Matrix) -> dict[str, Matrix]:
    """Return what a shape that nobody registered adds, by result it acts on, SI on all rows."""
    return {} if cause.shape is None else _added(cause, values, terms_of(machine, cause, values))


def terms_of(machine: Calibration, cause: Candidate, values: Matrix) -> list[Matrix]:
    """Return the terms of a shape that nobody registered, all rows, for these numbers of its shape."""
    numbers = [float(values[index]) for index in cause.shapes]
    return [term.values for term in cause.shape.terms(numbers, machine.records.covariates)] if cause.shape else []


def _added(cause: Candidate, values: Matrix, terms: Sequence[Matrix]) -> dict[str, Matrix]:
    amplitudes = iter([float(values[index]) for index in cause.amplitudes])
    results = cause.shape.results if cause.shape else ()
    return {name: np.asarray(sum(next(amplitudes) * term for term in terms)) for name in results}


def elsewhere(extended: Extended, machine: Calibration) -> Extended:
    """Return the same extension on other rows."""
    other = Extended(machine)
    other._setups, other.grain = dict(extended._setups), extended.grain
    return other


def parts_of(causes: Sequence[Candidate], flat: Matrix) -> list[Matrix]:
    """Cut the numbers of all causes, one behind another, into those of each."""
    ends = list(accumulate(cause.size for cause in causes))
    return [flat[end - cause.size : end] for cause, end in zip(causes, ends, strict=True)]


def switched_on(causes: Sequence[Candidate], values: Sequence[Matrix], machine: Calibration) -> Iterator[SwitchedOn]:
    """Give the effects of an explanation as they are on, with their fitted unknowns (SI); of files, their mean."""
    merged: dict[str, tuple[Effect[Any, Any], dict[str, float], dict[str, list[float]]]] = {}
    for cause, own in zip(causes, values, strict=True):
        if cause.effect is not None:
            *_, known = merged.setdefault(cause.name, (cause.effect, at_rest(cause, machine), {}))
            for number, value in zip(cause.numbers, own, strict=True):
                known.setdefault(number.name, []).append(float(value))
    for name, (effect, rest, known) in merged.items():
        others = {} if effect.parts and effect.takes_any else rest
        stated = {key: sum(every) / len(every) for key, every in known.items()}
        yield SwitchedOn(effect, {**others, **machine.on.get(name, {}), **stated})


# What the model is like to call, before the search: how long a call takes, and how rough its answers are


def probe(extended: Extended, competing: Sequence[Candidate]) -> None:
    """Give a search its budget of calls, and say how rough the model is.

    The number of calls is stated with ``[studies.diagnose] budget``. Where it is not, a model that answers at once has
    none, and a slow one gets what takes some minutes: the time of one call to a power of ten, so that two machines
    mostly agree. A model whose answers come in steps, or scatter by themselves, has no derivatives by small
    differences. Where nothing that competes moves the model itself it is called for nothing more: it needs neither.
    """
    machine = extended.machine
    costly = [cause for cause in competing if extended.costs(cause)]
    tried: list[Candidate] = [] if machine.inputs else costly[:1]
    if not machine.inputs and not costly:
        return
    values = [
        np.array([number.low + 0.1 * PROBE * (number.high - number.low) for number in cause.numbers]) for cause in tried
    ]
    point = values, np.full(len(machine.inputs), PROBE)
    extended.budget = budget_of(machine.start.diagnose.budget, len(costly), lambda: extended.at(tried, [point]))
    if extended.budget.is_dear:
        extended.budget.points = max(FEWEST_POINTS, int(CURVES * extended.budget.calls / max(len(costly), 1)))
    extended.grain = _grain_of(extended, tried, point)


def budget_of(stated: int, effects: int, call: Callable[[], object]) -> CallBudget:
    """Return the stated budget; else, by how long one ``call`` takes a processor, none or one of some minutes."""
    if stated:
        return CallBudget(stated)
    begin = processor_seconds()
    call()
    seconds = processor_seconds() - begin
    if seconds < QUICK_CALL:
        return CallBudget()
    takes = 10.0 ** round(log10(seconds))
    return CallBudget(max(round(MINUTES / takes), LEAST_PER_EFFECT * max(effects, 1)), takes)


def _grain_of(extended: Extended, causes: list[Candidate], point: Point) -> dict[str, float]:
    """Return by result how much its answers jump or scatter, SI; results that do neither are left out."""
    (first,) = extended.at(causes, [point])
    forget()
    (again,) = Extended(extended.machine).at(causes, [point])
    made = {}
    for name, shown in first.items():
        known = np.isfinite(shown) & np.isfinite(again[name])
        scatter = float(np.abs(shown - again[name])[known].max(initial=0.0))
        scatter = scatter if scatter > ROUNDING * float(np.abs(shown)[known].max(initial=0.0)) else 0.0
        base = extended.machine.base[name]
        step = 0.0 if np.array_equal(shown, base, equal_nan=True) else step_of(shown[known])
        if scatter > 0 or (step > 0 and abs(step_of(base[np.isfinite(base)]) / step - 1) < COARSE):
            made[name] = max(scatter, step)
    return made


def step_of(values: Matrix) -> float:
    """Return the step of which all values are multiples, by Euclid's algorithm; 0 where there is none."""
    distinct = np.unique(np.abs(values[values != 0]))
    if len(distinct) < FEWEST_DISTINCT:
        return 0.0
    step, least = float(distinct[0]), FINE * float(distinct[-1])
    for value in distinct.tolist():
        while (rest := abs(value - step * round(value / step))) > least:
            value, step = step, rest
    return step if step > COARSE * float(distinct[-1]) else 0.0
