"""What a machine can do from where it stands: what is set is set, histories go on, and what follows takes its time.

An experiment gives every quantity a course over its readings. Hours and wear go on from the last row. What they gain by
a rate is the sum of that rate over the time. What is derived from another quantity follows from the course of that one.
A temperature that follows from the work goes on from where the record ended, no faster than it did so far; where it
begins elsewhere it has to be brought there first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, pi

import numpy as np
from scipy.integrate import cumulative_trapezoid

from truing.arrays import Matrix
from truing.declare.fields import Role
from truing.declare.sources import SINCE_START, Condition
from truing.diagnosis.data_rows import is_angle
from truing.diagnosis.machine import Calibration
from truing.diagnosis.records import Covariate, Records
from truing.diagnosis.result import Course
from truing.measurements.derived import TIME, derive
from truing.setup import Setup
from truing.units import to_si

FEW_VALUES = 3
"""A column of so few values has no values between them: it is set to one of these."""
TURN = 2 * pi
TOGETHER = 0.999
"""Correlation with the time from which on a history went on with it."""
QUARTERS = 31
"""So many quarters of a record, one begun a fortieth of it after the other, are asked how fast something went."""
LEVELS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Where in its range something is held, beside where it usually is."""
ADVANCES = (0.5, 1.0)
"""How far a history goes on: shares of what is left of its range, beside its usual pace."""


@dataclass(frozen=True)
class Quantity:
    """One input or condition that an experiment has a course for, SI.

    ``stands`` is where a history is, ``usual`` where anything else is held unless something is gained elsewhere: of
    what follows from others where the record ended.
    ``pace`` is what a history gains from one reading to the next, ``slowness`` how many seconds something that follows
    takes per unit and ``most`` how far it gets in one record. ``levels`` are the few values of a column without others.
    """

    name: str
    role: Role
    low: float
    high: float
    usual: float
    stands: float = 0.0
    pace: float = 0.0
    slowness: float = 0.0
    most: float = inf
    levels: tuple[float, ...] = ()

    def courses(self, readings: int) -> list[Course]:
        """Return what it may do over so many readings, the plainest first."""
        if self.role == "goes_on":
            return list(self._histories(readings))
        places = self.levels or [self.low + share * (self.high - self.low) for share in LEVELS]
        held = [Course(self.name, "held", place, place) for place in dict.fromkeys((self.usual, *places))]
        ends = (places[0], places[-1]), (places[-1], places[0])
        if self.role == "follows":
            begins = dict.fromkeys((self.usual, self.low, self.high))
            ways = [(begin, max(self.low, begin - self.most)) for begin in begins]
            ways += [(begin, min(self.high, begin + self.most)) for begin in begins]
            return [held[0], *held[1::4], *(Course(self.name, "ramp", *ends) for ends in ways if ends[0] != ends[1])]
        ramps = (
            [] if self.levels else [Course(self.name, way, *pair) for way in ("ramp", "to and fro") for pair in ends]
        )
        return [*held, *ramps, Course(self.name, "in turn", *ends[0])]

    def _histories(self, readings: int) -> Iterator[Course]:
        """Give the ways on of a history: at its pace (a clock never stands), then farther."""
        begin, left = self.stands + self.pace, self.high - self.stands
        least = readings * self.pace
        yield Course(self.name, "ramp" if least else "held", begin, self.stands + least)
        for share in ADVANCES:
            if share * left > least:
                yield Course(self.name, "ramp", begin, self.stands + share * left)


@dataclass(frozen=True)
class Reach:
    """All that an experiment may vary, what is made from it, and what stays as it was (``fixed``, SI).

    ``derived`` are conditions that are made from the course of another one, ``tied`` histories that gain by a rate,
    each with where it stands. ``paired`` are histories that went on with the time throughout the record: where each
    stands and what it gains per second.
    """

    quantities: tuple[Quantity, ...]
    derived: tuple[Condition, ...]
    tied: tuple[tuple[Condition, float], ...]
    fixed: Mapping[str, float]
    paired: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """The columns of an experiment."""
        names = [quantity.name for quantity in self.quantities]
        return [*names, *self.paired, *(each.name for each, _ in self.tied), *(each.name for each in self.derived)]

    def columns(self, experiments: Sequence[Mapping[str, Course]], readings: int) -> dict[str, Matrix]:
        """Return the settings of every reading, one experiment behind another, SI by name."""
        rows = [self._readings(courses, readings) for courses in experiments]
        return {name: np.concatenate([each[name] for each in rows]) for name in self.names}

    def settled(self, courses: Mapping[str, Course]) -> dict[str, Course]:
        """Return the courses with the time that what follows takes to get there."""
        clock, made = courses.get(TIME), dict(courses)
        slow = (abs(courses[each.name].end - courses[each.name].start) * each.slowness for each in self.quantities)
        if clock is not None and (takes := max(slow, default=0.0)) > clock.end - clock.start:
            made[TIME] = Course(TIME, "ramp", clock.start, clock.start + takes)
        return made

    def _readings(self, courses: Mapping[str, Course], readings: int) -> dict[str, Matrix]:
        made = {name: course.values(readings) for name, course in self.settled(courses).items()}
        known = {**{name: np.full(readings, value) for name, value in self.fixed.items()}, **made}
        began = next((each.stands for each in self.quantities if each.name == TIME), 0.0)
        for name, (stands, gain) in self.paired.items():
            made[name] = stands + gain * (made[TIME] - began)
        for condition, stands in self.tied:
            rate, time = known[condition.rate], made[TIME]
            first = abs(rate[0]) * (time[0] - began)
            made[condition.name] = stands + first + cumulative_trapezoid(np.abs(rate), time, initial=0)
        return made | {each.name: derive(each, {**known, **made}, None, None) for each in self.derived}


def reach_of(machine: Calibration) -> Reach:
    """Return what the machine of a record can do from its last row."""
    setup, covariates = machine.start, machine.records.covariates
    there = {name: each for name, each in covariates.items() if each.role not in {"order", "other"}}
    fixed = {
        name: float(np.nanmedian(values))
        for name, values in machine.records.rows.columns.items()
        if isinstance(values, np.ndarray) and values.dtype.kind == "f"
    }
    clock = there.get(TIME)
    conditions = [setup.model.known_conditions[name] for name in there if name in setup.model.known_conditions]
    rates = {name: each.values for name, each in there.items()}
    tied = tied_of(setup, conditions, rates) if clock is not None else []
    paired = _paired(machine, {each.name for each in tied})
    derived = [each for each in conditions if each.derived and each.history != SINCE_START and each.made_from in there]
    made = {*(each.name for each in (*tied, *derived)), *paired}
    left = None if clock is None or clock.is_constant else _clock(machine, paired)
    several = (left if name == TIME and left else _quantity(machine, name, left) for name in there if name not in made)
    quantities = tuple(quantity for quantity in several if quantity is not None)
    stands = tuple((each, _farthest(there[each.name])) for each in tied)
    return Reach(quantities, tuple(derived), stands, fixed, paired)


def _paired(machine: Calibration, tied: set[str]) -> dict[str, tuple[float, float]]:
    """Return the histories that went on in proportion to the time: where each stands, and its gain per second."""
    covariates, setup = machine.records.covariates, machine.start
    clock, paired = covariates.get(TIME), {}
    for name, covariate in covariates.items():
        is_own = name in setup.model.known_conditions or name in setup.model.input_fields
        if clock is None or name in {TIME, *tied} or not is_own or role_of(setup, name) != "goes_on":
            continue
        if not (clock.is_constant or covariate.is_constant) and covariate.moves_with(clock, TOGETHER):
            paired[name] = _farthest(covariate), float(np.ptp(covariate.filled) / np.ptp(clock.filled))
    return paired


def _clock(machine: Calibration, paired: Mapping[str, tuple[float, float]]) -> Quantity | None:
    """Return the time with no more of it left than what goes on with it has; at its end readings follow at once."""
    clock = _quantity(machine, TIME, None)
    if clock is None:
        return None
    high = clock.high
    for name, (stands, gain) in paired.items():
        most = range_of(machine.start, name, (stands, inf))[1]
        high = min(high, clock.stands + max(most - stands, 0.0) / gain)
    return replace(clock, high=high, pace=clock.pace if high > clock.stands else 0.0)


def tied_of(setup: Setup, conditions: Sequence[Condition], known: Mapping[str, object]) -> list[Condition]:
    """Return the histories whose rate is known, in a column or as what the inputs file states."""
    return [each for each in conditions if each.rate and (each.rate in known or float(setup.nominal(each.rate)) != 0.0)]


def role_of(setup: Setup, name: str) -> Role:
    """Return what a machine lets you do with an input or condition."""
    model = setup.model
    return model.known_conditions[name].does if name in model.known_conditions else model.input_fields[name].does


def _farthest(covariate: Covariate) -> float:
    return float(np.nanmax(covariate.values))


def _quantity(machine: Calibration, name: str, clock: Quantity | None) -> Quantity | None:
    """Return what a record says of a quantity and of where it stands; None of what has no range."""
    setup, covariate = machine.start, machine.records.covariates[name]
    field, condition = setup.model.input_fields.get(name), setup.model.known_conditions.get(name)
    finite = covariate.values[np.isfinite(covariate.values)]
    if (field is not None and not field.varies) or (field is None and condition is None) or not len(finite):
        return None
    role: Role = "goes_on" if covariate.role == "time" else role_of(setup, name)
    low, high = range_of(setup, name, _ends(covariate))
    usual = ended_at(machine.records, name) if role == "follows" else float(np.median(finite))
    if role == "goes_on":
        stands, counts = _farthest(covariate), condition is not None and condition.history == SINCE_START
        high = stands + high - low if counts else max(high, stands)
        steps = np.diff(covariate.filled)
        pace = float(np.median(steps[steps > 0])) if covariate.role == "time" and (steps > 0).any() else 0.0
        return Quantity(name, role, stands, max(high, stands), stands, stands, pace)
    if high <= low:
        return None
    distinct = np.unique(finite)
    levels = tuple(distinct.tolist()) if 1 < len(distinct) <= FEW_VALUES else ()
    usual = min(levels, key=lambda level: abs(level - usual)) if levels else usual
    made = Quantity(name, role, low, high, min(max(usual, low), high), levels=levels)
    if role != "follows" or clock is None:
        return made
    slowness = _slowness(machine.records.covariates[TIME].filled, covariate.filled)
    return replace(made, slowness=slowness, most=(clock.high - clock.stands) / slowness)


def ended_at(records: Records, name: str) -> float:
    """Return where a quantity was when the last run ended, SI: at its latest time, else in its last row."""
    values, clock = records.covariates[name].values, records.covariates.get(TIME)
    rows = np.flatnonzero((records.run_of == records.run_of[-1]) & np.isfinite(values))
    if not len(rows):
        rows = np.flatnonzero(np.isfinite(values))
    at = rows[-1] if clock is None else rows[int(np.argmax(clock.filled[rows]))]
    return float(values[at])


def _ends(covariate: Covariate) -> tuple[float, float]:
    return float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))


def _slowness(time: Matrix, values: Matrix) -> float:
    """Return how many seconds a quantity took per unit in that quarter of a record in which it went farthest."""
    order = np.argsort(time, kind="stable")
    quarter = float(np.ptp(time)) / 4
    begins = np.linspace(time.min(), time.max() - quarter, QUARTERS)
    before, after = (np.interp(begins + late, time[order], values[order]) for late in (0.0, quarter))
    return quarter / max(float(np.abs(after - before).max()), 1e-300)


def range_of(setup: Setup, name: str, seen: tuple[float, float] | None) -> tuple[float, float]:
    """Return where a quantity can be measured, SI: as asked for, as declared, else half as wide again as it was seen.

    An angle that is set stays within one turn. Ends that nothing tells are NaN.
    """
    if name in setup.diagnose.box:
        return setup.diagnose.box[name]
    unit, condition = setup.unit_of(name), setup.model.known_conditions.get(name)
    if condition is not None:
        ends = [None if end is None else float(to_si(end, unit)) for end in (condition.low, condition.high)]
        low, high = ((seen or (np.nan, np.nan))[side] if end is None else end for side, end in enumerate(ends))
    else:
        low, high = _range_of_input(setup, name, seen)
    is_round = is_angle(unit) and role_of(setup, name) == "set"
    return (low, low + TURN) if is_round and high - low > TURN else (low, high)


def _range_of_input(setup: Setup, name: str, seen: tuple[float, float] | None) -> tuple[float, float]:
    field = setup.model.input_fields[name]
    bounds = [
        [getattr(field.spec, key, None) for key in keys] for keys in (("at_least", "above"), ("at_most", "below"))
    ]
    lows, highs = ([float(to_si(value, field.unit)) for value in side if value is not None] for side in bounds)
    if seen is None:
        return max(lows, default=np.nan), min(highs, default=np.nan)
    low, high = seen
    if is_angle(field.unit) and not lows and not highs:
        return min(low, -pi), max(high, pi)
    more = (high - low) / 2
    lows += [min(low, 0.0)] if field.does == "goes_on" else []
    return max([low - more, *lows]), min([high + more, *highs])
