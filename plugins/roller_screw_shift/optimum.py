"""A study of our own: the shift that the paper's weighed objectives prefer among those that keep every limit."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import isfinite, isnan, nan
from typing import Any, Literal

import numpy as np

from gear_geometry.drawing import signed as written
from roller_screw_shift import objectives, scatter
from roller_screw_shift.calculation import meshing_of
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.quantities import Pair
from truing import Array, Bench, Block, Float, Outcome, Table, TruingError, Words, found, results

# The complex method of Box: the least cost within limits, by a cloud of vertices that walks, shrinks and settles
#
# Sources: M. J. Box, The Computer Journal 8 (1965) 42; J. A. Guin, The Computer Journal 10 (1968) 416, for the way back
# that ends at the best vertex. The limits need no derivative and no penalty: a point that misses one has no cost.

ObjectiveCost = Callable[[Array], Array]
"""Of points (n, d) their costs (n,): small is good, and not finite where a point misses a limit."""

AT_ONCE = 64
HELD = 0.8  # of the way from the best vertex to the middle is left as the goal of the way back, after every try
TOGETHER = 4  # tries on the way back are asked for at once; those behind the one that is taken do not count
ALIKE = 4e-16  # of the largest cost: what differs by less cannot be told apart


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How the cloud is made and when it has settled: ``spread`` is its largest extent along any direction.

    At most ``draws`` points are drawn for the first vertices, and ``most`` costs asked for after them.
    """

    vertices: int = 9
    reflection: float = 1.3
    spread: float = 1e-8
    most: int = 5000
    draws: int = 50_000

    def __post_init__(self) -> None:
        if self.vertices < 3:
            raise TruingError(f"vertices = {self.vertices}, but a complex has at least 3, and one more than directions")
        if not self.reflection > 1:
            raise TruingError(f"reflection = {self.reflection:g} must lie above 1: a complex would shrink where it is")
        if not self.spread > 0:
            raise TruingError(f"spread = {self.spread:g} must lie above 0")
        if min(self.most, self.draws) < 1:
            raise TruingError(f"most = {self.most} and draws = {self.draws} are at least 1")


@dataclass(frozen=True, eq=False)
class BoxOptimum:
    """The best vertex (d,), its cost, how wide the cloud still is, and what it took.

    Of the ``evaluations`` so many were ``drawn`` for the first vertices.
    """

    point: Array
    cost: float
    spread: float
    evaluations: int
    drawn: int
    reflections: int
    settled: bool


def complex_method(
    cost: ObjectiveCost, span: tuple[Array, Array], rng: np.random.Generator, plan: Plan | None = None
) -> BoxOptimum:
    """Return the point of least cost between the ends of ``span``, each (d,).

    Raises TruingError with a sentence where too few points keep the limits to make the first vertices.
    """
    plan = plan or Plan()
    low, high = (np.atleast_1d(np.asarray(end, dtype=float)) for end in span)
    if not (np.isfinite(low).all() and np.isfinite(high).all() and (low < high).all()):
        raise TruingError("the complex method searches between a lower and a higher end, both finite")
    cloud, drawn = _first(cost, (low, high), rng, plan)
    asked = reflections = 0
    while not cloud.settled(plan.spread) and asked < plan.most:
        cloud, tries = _stepped(cost, cloud, (low, high), plan)
        asked, reflections = asked + tries, reflections + 1
    best = cloud.best
    return BoxOptimum(
        cloud.points[best].copy(), float(cloud.costs[best]), cloud.spread, drawn + asked, drawn, reflections,
        settled=cloud.settled(plan.spread),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Cloud:
    points: Array  # (k, d), all within the limits
    costs: Array  # (k,)

    @property
    def best(self) -> int:
        return int(np.argmin(self.costs))

    @property
    def worst(self) -> int:
        return int(np.argmax(self.costs))

    @property
    def spread(self) -> float:
        return float(np.ptp(self.points, axis=0).max())

    def settled(self, spread: float) -> bool:
        """Whether the cloud is as small as asked, or its costs differ by rounding alone."""
        return self.spread < spread or bool(np.ptp(self.costs) <= ALIKE * np.abs(self.costs).max())


def _first(cost: ObjectiveCost, span: tuple[Array, Array], rng: np.random.Generator, plan: Plan) -> tuple[_Cloud, int]:
    """Draw evenly, and again where a limit is missed, until every vertex keeps them all."""
    low, high = span
    points, costs = np.empty((0, len(low))), np.empty(0)
    drawn = 0
    while len(points) < plan.vertices and drawn < plan.draws:
        tried = low + (high - low) * rng.random((AT_ONCE, len(low)))
        found = cost(tried)
        kept = np.isfinite(found)
        points, costs = np.concatenate([points, tried[kept]]), np.concatenate([costs, found[kept]])
        drawn += AT_ONCE
    if len(points) < plan.vertices:
        told = "no point keeps" if not len(points) else f"only {len(points)} points keep"
        raise TruingError(f"{told} every limit among {drawn} drawn evenly; {plan.vertices} vertices are needed")
    return _Cloud(points[: plan.vertices], costs[: plan.vertices]), drawn


def _stepped(cost: ObjectiveCost, cloud: _Cloud, span: tuple[Array, Array], plan: Plan) -> tuple[_Cloud, int]:
    """Reflect the worst vertex through the middle of the others; halve the way back until it is better than it was.

    The place to which it comes back begins at that middle and ends at the best vertex, which the worst then joins.
    """
    worst = cloud.worst
    others, costs = np.delete(cloud.points, worst, axis=0), np.delete(cloud.costs, worst)
    best = int(np.argmin(costs))
    middle, goal = others.mean(axis=0), others[best]
    way = [np.clip(middle + plan.reflection * (middle - cloud.points[worst]), *span)]
    while np.abs(way[-1] - goal).max() >= 0.5 * plan.spread:
        held = HELD ** len(way)
        way.append(0.5 * (way[-1] + held * middle + (1.0 - held) * goal))
    for first in range(0, len(way), TOGETHER):
        values = cost(np.array(way[first : first + TOGETHER]))
        better = np.flatnonzero(values < cloud.costs[worst])
        if len(better):
            place = int(better[0])
            taken = way[first + place], float(values[place])
            return _Cloud(np.vstack([others, taken[0]]), np.append(costs, taken[1])), first + place + 1
    return _Cloud(np.vstack([others, goal]), np.append(costs, costs[best])), len(way)


# The shift that the weighed sum of the objectives prefers: by Box's complex method, and on a dense grid as a check

OTHER: dict[str, Literal["path", "roots"]] = {"path": "roots", "roots": "path"}
READINGS = ("own_ranges", "printed_ranges", "printed")
NEAR = 1e-5  # of a shift: nearer to its end the optimum stands at the limit; the weighed sum is level there


@dataclass(frozen=True, eq=False)
class Field:
    """Where every limit is kept: intervals, a dense course over them, and the range of each objective there."""

    pair: Pair
    intervals: tuple[objectives.Interval, ...]
    course: objectives.ShiftCourse
    ranges: objectives.Ranges

    def around(self, shift: float) -> objectives.Interval:
        """The interval that holds this shift, or the nearest one."""
        return min(self.intervals, key=lambda part: max(part.low - shift, shift - part.high, 0.0))


def field_of(pair: Pair, span: tuple[float, float], points: int) -> Field | None:
    """Return where between the ends of ``span`` every limit is kept; None where no shift of the grid does."""
    return _field(unweighed(pair), span, points)


def unweighed(pair: Pair) -> Pair:
    """Return the pair without what a field does not follow, so that all readings of the weights share one.

    What is not stated is one and the same NaN then, and alike pairs are equal.
    """
    unknown: dict[str, Any] = {
        name: nan for name, value in vars(pair).items() if isinstance(value, float) and isnan(value)
    }
    return replace(pair, weights="own_ranges", roller_shift=0.0, **unknown)


@lru_cache(maxsize=16)
def _field(pair: Pair, span: tuple[float, float], points: int) -> Field | None:
    intervals = objectives.intervals_of(pair, span, points)
    if not intervals:
        return None
    course = objectives.dense(pair, intervals, points)
    return Field(pair, intervals, course, course.ranges)


def box_optimum(
    field: Field, weights: objectives.Three, span: tuple[float, float], rng: np.random.Generator, plan: Plan
) -> BoxOptimum:
    """Return what Box's method finds; it knows the limits by rejection only."""

    def cost(points: Array) -> Array:
        course = objectives.course_of(field.pair, points[:, 0])
        with np.errstate(invalid="ignore"):
            return np.where(course.kept, objectives.total(course.objectives, field.ranges, weights), np.inf)

    return complex_method(cost, (np.array([span[0]]), np.array([span[1]])), rng, plan)


def grid_optimum(field: Field, weights: objectives.Three) -> float:
    """Return the best shift of the dense course, then of as many points between its neighbours."""
    course = field.course
    place = int(np.argmin(objectives.total(course.objectives, field.ranges, weights)))
    part = field.around(float(course.shifts[place]))
    ends = course.shifts[max(place - 1, 0)], course.shifts[min(place + 1, len(course.shifts) - 1)]
    low, high = max(float(ends[0]), part.low), min(float(ends[1]), part.high)
    finer = objectives.course_of(field.pair, np.linspace(low, high, len(course.shifts)))
    costs = np.where(finer.kept, objectives.total(finer.objectives, field.ranges, weights), np.inf)
    return float(finer.shifts[int(np.argmin(costs))])


def limits_at(field: Field, shift: float) -> tuple[str, ...]:
    """Return the limits at which this shift stands; none where it lies within its interval."""
    part = field.around(shift)
    if shift >= part.high - NEAR:
        return part.high_limits
    return part.low_limits if shift <= part.low + NEAR else ()


@dataclass(frozen=True)
class Variant:
    """The optimum under another least contact ratio or with other weights: their reading and their values."""

    least_contact_ratio: float
    weights: str
    values: objectives.Three
    shift: float
    contact_ratio: float
    limits: tuple[str, ...]


def variants(pair: Pair, ratios: Sequence[float], span: tuple[float, float], points: int) -> Iterator[Variant | None]:
    """Give the optimum on the grid for every least contact ratio and every reading of the weights; None without one."""
    for ratio in ratios:
        for reading in READINGS:
            yield _variant(unweighed(replace(pair, least_contact_ratio=ratio)), reading, span, points)


@lru_cache(maxsize=256)
def _variant(pair: Pair, reading: str, span: tuple[float, float], points: int) -> Variant | None:
    field = field_of(pair, span, points)
    if field is None:
        return None
    ratio, weights = float(pair.least_contact_ratio), objectives.weights_of(reading, field.ranges)
    shift = grid_optimum(field, weights)
    margin = objectives.course_of(field.pair, np.array([shift])).margins["margin_contact_ratio"][0]
    return Variant(ratio, reading, weights, shift, ratio + float(margin), limits_at(field, shift))


def other_optimum(pair: Pair, span: tuple[float, float], points: int) -> float:
    """Return the optimum on the grid by the other reading of the sliding; NaN where no shift keeps every limit then."""
    field = field_of(replace(pair, sliding_reading=OTHER[pair.sliding_reading]), span, points)
    return float("nan") if field is None else grid_optimum(field, objectives.weights_of(pair.weights, field.ranges))


def stress_factor(field: Field, weights: objectives.Three, shift: float) -> float | None:
    """Return how many times as heavy the stresses must be before the optimum leaves the end at which it stands.

    None where it stands at no end, or a weight is missing, or a million times is not enough.
    """
    if not limits_at(field, shift) or not weights[1]:
        return None
    low, high = 0.0, 6.0  # decimal logarithms

    def leaves(exponent: float) -> bool:
        heavier = (weights[0], weights[1] * 10.0**exponent, weights[2])
        place = int(np.argmin(objectives.total(field.course.objectives, field.ranges, heavier)))
        return bool(abs(field.course.shifts[place] - shift) > NEAR + np.diff(field.course.shifts).max())

    if leaves(low) or not leaves(high):
        return None
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if leaves(middle) else (middle, high)
    return float(10.0**high)


FOUND = "found"
BEFORE = 2  # steps before the variants: the field, and Box's search with the grid beside it
LOWEST_RATIO = 1.0  # of contact: below it the teeth part


@dataclass(frozen=True, kw_only=True)
class Shifting:
    """Choose the shift of the roller between the ends of ``span``; ``points`` are those of the dense grid.

    Box's method with ``vertices``, ``reflection`` and ``spread`` as in the paper; ``ratios`` are further least contact
    ratios under which the optimum is found, by every reading of the weights. ``probability`` is the share of screws
    that are to keep every limit, with the tolerances in force, at the shift proposed for them.
    """

    span: tuple[float, float] = (-2.0, 3.0)
    points: int = 20_001
    vertices: int = 9
    reflection: float = 1.3
    spread: float = 1e-8
    ratios: tuple[float, ...] = (1.2, 1.4, 1.42)
    probability: float = 0.99
    name: str = "shift"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if len(self.span) != 2 or not self.span[0] < self.span[1]:
            raise TruingError(f"study '{self.name}': span is the lowest and the highest shift of the roller")
        if not 11 <= self.points <= 1_000_000:
            raise TruingError(f"study '{self.name}': points = {self.points}, but a grid has 11 to 1000000")
        if not all(ratio >= 1 for ratio in self.ratios):
            raise TruingError(f"study '{self.name}': ratios are least contact ratios, 1 or more")
        if not 0.5 <= self.probability <= 0.9999:
            raise TruingError(f"study '{self.name}': probability = {self.probability:g}, but 0.5 to 0.9999 can be told")
        _ = self.plan  # which refuses what makes no complex

    def run(self, bench: Bench) -> "ChosenShift":
        """Find where every limit is kept, the ranges of the objectives there, the weights, and the optimum."""
        pair: Pair = bench.inputs
        span = self.ends
        ratios = sorted({*self.ratios, float(pair.least_contact_ratio)})
        bench.progress(self.name, 0, _steps(ratios))
        field = field_of(pair, span, self.points)
        equal = objectives.equal_sliding(pair, span, self.points)
        if field is None:
            return ChosenShift(pair, span, equal, status=self._nothing(pair, span))
        bench.progress(self.name, 1, _steps(ratios))
        weights = objectives.weights_of(pair.weights, field.ranges)
        grid = grid_optimum(field, weights)
        box, remarks = self._box(bench, field, weights)
        best = grid if box is None else float(box.point[0])
        return ChosenShift(
            pair, span, equal,
            status=FOUND,
            field=field,
            weights=weights,
            box=box,
            grid=grid,
            other=other_optimum(pair, span, self.points),
            variants=tuple(self._variants(bench, ratios, span)),
            factor=stress_factor(field, weights, grid),
            **self._scattered(bench, field, weights, best),
            remarks=remarks,
        )  # fmt: skip

    def _scattered(self, bench: Bench, field: Field, weights: objectives.Three, best: float) -> dict[str, Any]:
        """Return what scatter leaves of the shifts, the best of them that enough screws keep, and the comparison."""
        pair: Pair = bench.inputs
        screws, least = scatter.screws_of(bench), float(pair.least_contact_ratio)
        wide = field_of(replace(pair, least_contact_ratio=LOWEST_RATIO), self.ends, self.points) or field
        span = wide.intervals[0].low, wide.intervals[-1].high
        reached = scatter.ratio_course(screws, span, self.probability, least)
        robust = robust_optimum(field, weights, scatter.held(screws, reached, self.probability, least))
        return {
            "compared": _compared(bench, field, best, robust),
            "kept": (screws.kept(float(pair.roller_shift)), screws.kept(best)),
            "robust": robust,
            "kept_robust": screws.kept(robust) if isfinite(robust) else nan,
            "probability": self.probability,
            "wide": wide,
            "reached": reached,
        }

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest shift, as numbers."""
        return float(self.span[0]), float(self.span[1])

    @property
    def plan(self) -> Plan:
        """How Box's method searches."""
        return Plan(vertices=self.vertices, reflection=self.reflection, spread=self.spread)

    def _box(self, bench: Bench, field: Field, weights: objectives.Three) -> tuple[BoxOptimum | None, tuple[str, ...]]:
        try:
            found = box_optimum(field, weights, self.span, np.random.default_rng(bench.setup.seed), self.plan)
        except TruingError as error:
            return None, (f"Box's method found nothing: {error}; the grid's optimum stands",)
        return found, () if found.settled else ("Box's method ended before its vertices met",)

    def _variants(self, bench: Bench, ratios: Sequence[float], span: tuple[float, float]) -> Iterator[Variant]:
        """Give the optimum under one least contact ratio after the other, by every reading of the weights."""
        steps = _steps(ratios)
        for place, variant in enumerate(variants(bench.inputs, ratios, span, self.points), start=BEFORE):
            bench.progress(self.name, place + 1, steps)
            if variant is not None:
                yield variant

    def _nothing(self, pair: Pair, span: tuple[float, float]) -> str:
        """Say that no shift keeps every limit, and what the nearest one misses."""
        course = objectives.course_of(pair, np.linspace(*span, self.points))
        worst = np.array([np.where(np.isfinite(each), each, -np.inf) for each in course.margins.values()])
        place = int(np.argmax(worst.min(axis=0)))
        missed = (name for name in course.missed(place) if name in course.margins)
        misses = " and ".join(f"{name} ({course.margins[name][place]:.3g})" for name in missed) or "a root"
        return (
            f"no shift of the roller from {span[0]:g} to {span[1]:g} keeps every limit; the nearest, "
            f"{course.shifts[place]:.4g}, misses {misses}"
        )


def _steps(ratios: Sequence[float]) -> int:
    return BEFORE + len(ratios) * len(READINGS)


def _compared(bench: Bench, field: Field, best: float, robust: float) -> Mapping[str, Any]:
    """Geometry, sliding and stresses before, as stated, at the optimum and at the robust one, SI (n,) by name."""
    at = np.array([before(field), float(bench.inputs.roller_shift), best, *([robust] if isfinite(robust) else [])])
    found = bench.rows({"roller_shift": at}, len(at), *(name for _, name, *_ in ROWS[1:]))
    return {"roller_shift": at, **found}


def robust_optimum(field: Field, weights: objectives.Three, held: Sequence[tuple[float, float]]) -> float:
    """Return the best shift of those that are held, by the same weighed sum; NaN where none is."""
    if not held:
        return nan
    shifts = np.unique(np.concatenate([
        np.ravel(held), *(field.course.shifts[(field.course.shifts > low) & (field.course.shifts < high)]
                          for low, high in held)]))  # fmt: skip
    course = objectives.course_of(field.pair, shifts)
    return float(shifts[int(np.argmin(objectives.total(course.objectives, field.ranges, weights)))])


CHARTED = 2001  # shifts of the dense course at which a chart looks


def over_ratios(chosen: "ChosenShift", ratios: Array, reading: str, *, robust: bool) -> Array:
    """Return the optimal shift by the least contact ratio (n,), on a grid; NaN where no shift keeps every limit.

    ``robust``: where so many screws as asked reach that ratio, instead of the nominal pair.
    """
    wide = chosen.wide
    if wide is None or chosen.reached is None:
        return np.full(len(ratios), nan)
    course = wide.course
    places = np.unique(np.linspace(0, len(course.shifts) - 1, CHARTED).astype(int))
    shifts, values = course.shifts[places], course.objectives[:, places]
    nominal = course.margins["margin_contact_ratio"][places] + float(wide.pair.least_contact_ratio)
    reached = chosen.reached.at(shifts) if robust else nominal
    return np.array([_at_ratio(shifts, values, (nominal >= ratio, reached >= ratio), reading) for ratio in ratios])


def _at_ratio(shifts: Array, values: Array, kept: tuple[Array, Array], reading: str) -> float:
    """Return the best of the shifts that are allowed, the second kept, weighed over the ranges of the first."""
    nominal, allowed = kept
    if not np.any(allowed) or np.count_nonzero(nominal) < 2:
        return nan
    low, high = values[:, nominal].min(axis=1), values[:, nominal].max(axis=1)
    first, second, third = zip(low.tolist(), high.tolist(), strict=True)
    ranges = (first, second, third)
    costs = objectives.total(values[:, allowed], ranges, objectives.weights_of(reading, ranges))
    return float(shifts[allowed][int(np.argmin(costs))])


def gentlest(field: Field) -> tuple[float, float]:
    """Return the allowed shift at which the largest sliding on the path is least, on the grid, and that sliding."""
    found = meshing_of(replace(field.pair, roller_shift=field.course.shifts))
    place = int(np.argmin(found.largest_sliding))
    return float(field.course.shifts[place]), float(np.asarray(found.largest_sliding)[place])


def before(field: Field) -> float:
    """The shift to compare with: none at all where that keeps every limit, else the allowed one nearest to none."""
    part = field.around(0.0)
    return min(max(0.0, part.low), part.high)


@dataclass(frozen=True, eq=False)
class ChosenShift(Outcome):
    """The optimum by Box's method and on the grid, and where the objectives were weighed.

    Without any shift that keeps every limit ``field`` is None and ``status`` says why. ``equal`` is the shift at which
    both roots slide alike, whatever the limits; ``other`` the optimum by the other reading of the sliding; ``kept`` the
    shares of screws, as stated and at the optimum, that keep every limit although their parts scatter. ``robust`` is
    the best shift at which ``probability`` of them do; NaN where there is none. ``wide`` is the field without a
    limit of the contact ratio, ``reached`` what the screws reach of it.
    """

    inputs: Pair
    span: tuple[float, float]
    equal: float
    status: str
    field: Field | None = None
    weights: objectives.Three = (0.0, 0.0, 0.0)
    box: BoxOptimum | None = None
    grid: float = float("nan")
    other: float = float("nan")
    variants: tuple[Variant, ...] = ()
    factor: float | None = None
    compared: Mapping[str, Any] | None = None
    kept: tuple[float, float] = (nan, nan)
    robust: float = nan
    kept_robust: float = nan
    probability: float = nan
    wide: Field | None = None
    reached: scatter.RatioCourse | None = None
    remarks: tuple[str, ...] = ()

    @property
    def shift(self) -> float:
        """The optimum by Box's method, or the grid's where that found nothing."""
        return self.grid if self.box is None else float(self.box.point[0])

    @property
    def limits(self) -> tuple[str, ...]:
        """The limits at which the optimum stands."""
        return () if self.field is None else limits_at(self.field, self.shift)

    def as_json(self) -> Mapping[str, Any]:
        """Return intervals, ranges, weights, both optima and the variants."""
        entry: dict[str, Any] = {"status": self.status, "equal_sliding": number(self.equal)}
        field = self.field
        if field is None:
            return entry
        names = ("shift_sum", "stress_difference", "sliding_difference")
        ranges = zip(names, OBJECTIVES, field.ranges, strict=True)
        entry["intervals"] = [vars(part) for part in field.intervals]
        entry["ranges"] = {name: {"low": low, "high": high, "unit": unit} for name, (_, _, unit), (low, high) in ranges}
        entry["weights"] = {"reading": self.inputs.weights, "values": list(self.weights)}
        entry["grid"] = {"shift": self.grid, "points": len(field.course.shifts)}
        if self.box is not None:
            rest = {name: value for name, value in vars(self.box).items() if name != "point"}
            entry["box"] = {"shift": float(self.box.point[0]), **rest}
        entry["other_sliding_reading"] = {"reading": OTHER[self.inputs.sliding_reading], "shift": number(self.other)}
        entry["limits"] = list(self.limits)
        entry["kept"] = {"stated": number(self.kept[0]), "optimum": number(self.kept[1])}
        entry["robust"] = {
            "probability": self.probability, "shift": number(self.robust), "kept": number(self.kept_robust)
        }  # fmt: skip
        entry["stress_factor"] = self.factor
        entry["variants"] = [vars(each) for each in self.variants]
        return entry

    def warnings(self) -> Sequence[str]:
        """Say what was not found, and name objectives that are the same for every shift."""
        said = list(self.remarks) if self.status == FOUND else [self.status]
        if self.field is not None:
            said += [
                f"the {name} is the same for every shift, so it is left out of the weighing"
                for (name, _, _), (low, high) in zip(OBJECTIVES, self.field.ranges, strict=True)
                if not high > low
            ]
        return [f"study 'shift': {text}" for text in said]


# How the choice of the shift is written: results.json, tables and words of the sheet

MM = 1e3
SAME_SHIFT = 5e-5  # of a shift, on the sheet
SLIDING = {
    "path": "the largest sliding of each gear on the path of contact",
    "roots": "the sliding at the roots alone, which need not be the largest,",
}
LIMITS = {
    "margin_ring_base": ("g1", "base circle of the ring"),
    "margin_roller_base": ("g2", "base circle of the roller"),
    "margin_contact_ratio": ("g3", "contact ratio"),
    "margin_interference": ("g4", "tips in passing"),
    "margin_opposite_tips": ("g5", "tips on the far side"),
    "margin_roller_root": ("g6", "root of the roller"),
    "margin_ring_root": ("g6b", "root of the ring"),
    "margin_involute": ("g7", "involute interference"),
    "margin_undercut": ("g8", "undercut"),
    "margin_tip_land": ("g9", "tip land"),
    "margin_sliding": ("g10", "difference of sliding"),
}
READING = {"own_ranges": "rule, ranges found here", "printed_ranges": "rule, printed ranges", "printed": "as printed"}
OBJECTIVES = (
    ("sum of the shifts", "large", ""),
    ("difference of the root stresses", "small", "MPa"),
    ("difference of specific sliding", "small", ""),
)
ROWS: tuple[tuple[str, str, str, float], ...] = (
    ("shift of the roller", "roller_shift", "", 1.0),
    ("shift of the ring", "ring_shift", "", 1.0),
    ("tip circle of the roller, radius", "tip_radius_roller", "mm", MM),
    ("tip circle of the ring, radius", "tip_radius_ring", "mm", MM),
    ("contact ratio", "contact_ratio", "", 1.0),
    ("tip land of the roller", "tip_land", "mm", MM),
    ("root stress of the roller, nominal", "nominal_stress_roller", "MPa", 1 / objectives.MEGA),
    ("root stress of the ring, nominal", "nominal_stress_ring", "MPa", 1 / objectives.MEGA),
    ("specific sliding of the roller, largest", "sliding_roller", "", 1.0),
    ("specific sliding of the ring, largest", "sliding_ring", "", 1.0),
    ("specific sliding, largest on the path", "largest_sliding", "", 1.0),
    ("sum of the shifts", "shift_sum", "", 1.0),
    ("difference of the root stresses", "stress_difference", "MPa", 1 / objectives.MEGA),
    ("difference of specific sliding", "sliding_difference", "", 1.0),
)


def spoken(limits: Sequence[str]) -> str:
    """Return limits by number and name."""
    return " and ".join(" ".join(LIMITS.get(name, ("a root that", "does not exist"))) for name in limits)


def number(value: float) -> float | None:
    """Return a number as results.json may hold it."""
    return float(value) if isfinite(value) else None


def intervals_words(field: "Field") -> Words:
    """Say which shifts keep every limit, and what ends them."""
    parts = []
    for part in field.intervals:
        low = f"where {spoken(part.low_limits)} is missed" if part.low_limits else "where the search begins"
        high = f"where {spoken(part.high_limits)} is missed" if part.high_limits else "where the search ends"
        parts.append(f"from {signed(part.low)} ({low}) to {signed(part.high)} ({high})")
    return Words(f"Every limit is kept by shifts of the roller {', and '.join(parts)}.")


def weights_table(chosen: "ChosenShift", field: "Field") -> Table:
    """List the ranges found here and the weights taken."""
    rows = [
        (name, sense, unit, signed(low), signed(high), weight)
        for (name, sense, unit), (low, high), weight in zip(OBJECTIVES, field.ranges, chosen.weights, strict=True)
    ]
    columns = ("objective", "to be", "unit", "from", "to", "weight taken")
    return Table("Ranges and weights", columns, rows, note=f"Weights: {READING[chosen.inputs.weights]}.")


def printed_table() -> Table:
    """List what the paper prints of ranges and weights, and what its rule makes of it."""
    by_rule = objectives.rule_weights(objectives.PRINTED_RANGES)
    rows = [
        (name, unit, low, high, stated, weight, objectives.lower_limit(stated, high))
        for (name, _, unit), (low, high), stated, weight in zip(
            OBJECTIVES, objectives.PRINTED_RANGES, objectives.PRINTED_WEIGHTS, by_rule, strict=True
        )
    ]
    columns = ("printed", "unit", "from", "to", "weight", "weight by its rule", "or from")
    note = "The printed weight would follow by the rule if the range began where the last column says."
    return Table("Ranges and weights in the paper", columns, rows, note=note)


def compared_table(chosen: "ChosenShift", field: "Field") -> Table:
    """Set the pair before, as stated and at the optimum side by side."""
    compared = chosen.compared or {}
    rows = [
        (name, unit, *(number(scale * float(value)) for value in compared[key]))
        for name, key, unit, scale in ROWS
        if key in compared
    ]
    first = "no shift" if before(field) == 0.0 else "nearest to no shift"
    columns = ["", "unit", f"{first} of the roller", "as stated", "optimum"]
    if isfinite(chosen.robust):
        columns.append(f"kept by {100 * chosen.probability:g} %")
    return Table("Before and after", tuple(columns), rows)


def optimum_words(chosen: "ChosenShift", field: "Field") -> "list[Block]":
    """Say where the optimum lies, how it was found, and what holds it there."""
    blocks: list[Block] = []
    ring = chosen.shift + field_difference(field)
    where = f"The optimum is {signed(chosen.shift)} for the roller and {signed(ring)} for the ring. "
    if chosen.box is not None:
        box, beside = chosen.box, abs(chosen.shift - chosen.grid)
        where += (
            f"Box's method found it with {box.evaluations} evaluations, {box.drawn} to draw the first vertices; "
            f"the grid of {len(field.course.shifts)} shifts says {signed(chosen.grid, '.6f')}, "
            f"{signed(beside, '.1e') if beside else 'nothing'} beside it."
        )
    blocks.append(Words(where))
    held = (
        f"It stands at a limit: {spoken(chosen.limits)}. There the limit decides, not the weights; its value is lost "
        "in the paper's equation 8."
        if chosen.limits == ("margin_contact_ratio",)
        else f"It stands at a limit: {spoken(chosen.limits)}."
        if chosen.limits
        else "It lies within its interval; there the weights decide."
    )
    if chosen.factor is not None:
        held += f" The stresses would have to weigh {chosen.factor:.0f} times as much before the optimum left it."
    return [*blocks, Words(held), Words(_other_words(chosen)), Words(_scatter_words(chosen))]


def _other_words(chosen: "ChosenShift") -> str:
    """Say where the other reading of the sliding leads."""
    if not isfinite(chosen.other):
        return f"By {SLIDING[OTHER[chosen.inputs.sliding_reading]]} no shift keeps every limit."
    same = abs(chosen.other - chosen.grid) < SAME_SHIFT
    led = "there is the same optimum" if same else f"the optimum would be {signed(chosen.other)} for the roller"
    taken, other = SLIDING[chosen.inputs.sliding_reading], SLIDING[OTHER[chosen.inputs.sliding_reading]]
    return f"The third objective compares {taken}. By {other} {led}."


def _scatter_words(chosen: "ChosenShift") -> str:
    """Say what the scatter of the parts leaves of the margins."""
    stated, best = (f"{100 * share:.4g} %" for share in chosen.kept)
    words = (
        f"With the tolerances in force {stated} of the screws keep every limit as stated, and {best} at the optimum."
    )
    asked = f"{100 * chosen.probability:g} %"
    if not isfinite(chosen.robust):
        return words + f" There is no shift at which {asked} of them do."
    if chosen.limits and chosen.kept[1] < chosen.probability:
        words += " An optimum that stands at a limit leaves nothing for scatter."
    words += (
        f" The best shift at which {asked} do is {signed(chosen.robust)} for the roller, "
        f"{signed(chosen.robust - chosen.shift)} beside the optimum."
    )
    return words


def field_difference(field: "Field") -> float:
    """The shift of the ring less that of the roller."""
    return float(field.course.objectives[0, 0] - 2.0 * field.course.shifts[0])


def variants_table(chosen: "ChosenShift", field: "Field") -> Table:
    """List the optimum by least contact ratio and weights."""
    difference = field_difference(field)
    rows = [
        (f"{each.least_contact_ratio:g}", READING[each.weights], each.shift, each.shift + difference,
         each.contact_ratio, spoken(each.limits) or "none")
        for each in chosen.variants
    ]  # fmt: skip
    return Table(
        "The optimum by least contact ratio and weights",
        ("least contact ratio", "weights", "roller", "ring", "contact ratio", "limit that holds it"),
        rows,
        note="On the grid. The paper prints 0.21 and −0.16.",
    )


def signed(value: float, digits: str = ".4f") -> str:
    """A number with a true minus, by default with four decimals."""
    return written(value, digits)


# What the choice of the shift gives as results

KEPT = "over all shifts that keep every limit"
RULE = "one over the square of half the range; or as the input weights states"
BOX = "Box's complex method on the weighed sum"
HELD_BY = "the weighed sum among shifts that enough of the screws drawn keep"
DRAWN = "8192 screws drawn from the tolerances in force"


def weight(symbol: str, of: str, unit: str) -> Any:
    """Declare a weight."""
    return found(unit, symbol=symbol, note=f"weight of the {of}", method=RULE, source="the paper")


def reach(symbol: str, what: str, unit: str = "") -> Any:
    """Declare an end of the range of an objective."""
    return found(unit, symbol=symbol, note=what, method=KEPT)


def optimal(symbol: str, what: str, unit: str = "") -> Any:
    """Declare a number at the optimum."""
    return found(unit, symbol=symbol, note=f"{what} at the optimum", method=BOX, key="shift" in what)


@results
class ShiftChoice:
    """Where every limit is kept, how the objectives are weighed, and the optimum."""

    lowest_shift: Float = reach("x_E,min", "lowest shift of the roller that keeps every limit")
    highest_shift: Float = reach("x_E,max", "highest shift of the roller that keeps every limit")
    least_sum: Float = reach("p_1", "smallest sum of the shifts")
    most_sum: Float = reach("q_1", "largest sum of the shifts")
    least_stress_difference: Float = reach("p_2", "smallest difference of the root stresses", "MPa")
    most_stress_difference: Float = reach("q_2", "largest difference of the root stresses", "MPa")
    least_sliding: Float = reach("p_3", "smallest difference of specific sliding")
    most_sliding: Float = reach("q_3", "largest difference of specific sliding")
    weight_sum: Float = weight("w_1", "sum of the shifts", "")
    weight_stress: Float = weight("w_2", "difference of the root stresses", "1/MPa^2")
    weight_sliding: Float = weight("w_3", "difference of specific sliding", "")
    optimal_shift_roller: Float = optimal("x_E,opt", "shift of the roller")
    optimal_shift_ring: Float = optimal("x_I,opt", "shift of the ring")
    optimal_sum: Float = optimal("f_1,opt", "sum of the shifts")
    optimal_stress_difference: Float = optimal("f_2,opt", "difference of the root stresses", "MPa")
    optimal_sliding_difference: Float = optimal("f_3,opt", "difference of specific sliding")
    optimal_contact_ratio: Float = optimal("epsilon_opt", "contact ratio")
    optimal_margin: Float = found("", symbol="g_opt", note="smallest of the margins at the optimum",
                                  method="each in its own unit; 0: a limit holds the optimum")  # fmt: skip
    limit_distance: Float = found("", symbol="Delta x_E", note="from the optimum to the nearest shift that misses a "
                                  "limit", method="ends of the interval, halved down to the last digits")  # fmt: skip
    kept_as_stated: Float = found("%", symbol="n_0", note="screws of the stated shift that keep every limit",
                                  method=DRAWN)  # fmt: skip
    kept_at_optimum: Float = found("%", symbol="n_opt", note="screws of the optimal shift that keep every limit",
                                   method=DRAWN)  # fmt: skip
    robust_shift_roller: Float = found("", symbol="x_E,P", note="best shift of the roller at which as many screws keep "
                                       "every limit as asked", method=HELD_BY, key=True)  # fmt: skip
    robust_shift_ring: Float = found("", symbol="x_I,P", note="shift of the ring there", method="no backlash")
    robust_contact_ratio: Float = found("", symbol="epsilon_P", note="contact ratio there, of the nominal pair",
                                        method=HELD_BY)  # fmt: skip
    kept_at_robust: Float = found("%", symbol="n_P", note="screws of that shift that keep every limit",
                                  method=f"{DRAWN}, the same by which the shift was chosen")  # fmt: skip
    gentlest_shift: Float = found("", symbol="x_E,s", note="shift of the roller at which the largest sliding on the "
                                  "path is least", method="dense grid")  # fmt: skip
    gentlest_sliding: Float = found("", symbol="eta_s", note="that sliding", method="dense grid")
    grid_shift: Float = found("", symbol="x_E,grid", note="optimal shift of the roller on a dense grid",
                              method="a check of Box's method")  # fmt: skip
    grid_distance: Float = found("", symbol="Delta x_grid", note="between both optima", method="magnitude")
    evaluations: Float = found("", symbol="n_eval", note="shifts that Box's method tried", method="drawn ones counted")
    equal_sliding_roller: Float = found("", symbol="x_E,3", note="shift of the roller at which both roots slide alike",
                                        method="whatever the limits")  # fmt: skip
    equal_sliding_ring: Float = found("", symbol="x_I,3", note="shift of the ring there", method="no backlash")


def choice(chosen: ChosenShift) -> ShiftChoice:
    """The numbers of the study; NaN where no shift keeps every limit."""
    difference = float(np.asarray(geometry_of(chosen.inputs).shift_difference))
    equal = {"equal_sliding_roller": chosen.equal, "equal_sliding_ring": chosen.equal + difference}
    field = chosen.field
    if field is None:
        names = (name for name in ShiftChoice.__dataclass_fields__ if name not in equal)
        return ShiftChoice(**{**dict.fromkeys(names, nan), **equal})
    (sum_low, sum_high), (stress_low, stress_high), (sliding_low, sliding_high) = field.ranges
    part = field.around(chosen.shift)
    return ShiftChoice(
        lowest_shift=min(each.low for each in field.intervals),
        highest_shift=max(each.high for each in field.intervals),
        least_sum=sum_low,
        most_sum=sum_high,
        least_stress_difference=objectives.MEGA * stress_low,
        most_stress_difference=objectives.MEGA * stress_high,
        least_sliding=sliding_low,
        most_sliding=sliding_high,
        weight_sum=chosen.weights[0],
        weight_stress=chosen.weights[1] / objectives.MEGA**2,
        weight_sliding=chosen.weights[2],
        **_optimum(chosen, difference),
        limit_distance=max(min(chosen.shift - part.low, part.high - chosen.shift), 0.0),
        kept_as_stated=chosen.kept[0],
        kept_at_optimum=chosen.kept[1],
        **_robust(chosen, field, difference),
        grid_shift=chosen.grid,
        grid_distance=nan if chosen.box is None else abs(chosen.shift - chosen.grid),
        evaluations=nan if chosen.box is None else float(chosen.box.evaluations),
        **equal,
    )


def _optimum(chosen: ChosenShift, difference: float) -> dict[str, float]:
    at = objectives.course_of(chosen.inputs, np.array([chosen.shift]))
    shift_sum, stress, sliding = (float(values[0]) for values in at.objectives)
    return {
        "optimal_shift_roller": chosen.shift,
        "optimal_shift_ring": chosen.shift + difference,
        "optimal_sum": shift_sum,
        "optimal_stress_difference": objectives.MEGA * stress,
        "optimal_sliding_difference": sliding,
        "optimal_contact_ratio": float(at.margins["margin_contact_ratio"][0])
        + float(chosen.inputs.least_contact_ratio),
        "optimal_margin": min(float(margin[0]) for margin in at.margins.values()),
    }


def _robust(chosen: ChosenShift, field: Field, difference: float) -> dict[str, float]:
    """The numbers of the shift that scatter leaves, and of the one that slides least."""
    margin = nan
    if isfinite(chosen.robust):
        margin = float(objectives.course_of(field.pair, np.array([chosen.robust])).margins["margin_contact_ratio"][0])
    shift, sliding = gentlest(field)
    return {
        "robust_shift_roller": chosen.robust,
        "robust_shift_ring": chosen.robust + difference,
        "robust_contact_ratio": margin + float(chosen.inputs.least_contact_ratio),
        "kept_at_robust": chosen.kept_robust,
        "gentlest_shift": shift,
        "gentlest_sliding": sliding,
    }
