"""A study of our own: the shift that the paper's weighed objectives prefer among those that keep every limit."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10
from typing import Any

import numpy as np

from roller_screw_shift.best_shifts import (
    OTHER,
    READINGS,
    Field,
    Variant,
    box_optimum,
    field_of,
    grid_optimum,
    limits_at,
    other_optimum,
    stress_factor,
    variants,
)
from roller_screw_shift.box import Found, Plan
from roller_screw_shift.constraints import Margins
from roller_screw_shift.courses import course_of, equal_sliding
from roller_screw_shift.quantities import Pair
from roller_screw_shift.weighing import PRINTED_RANGES, PRINTED_WEIGHTS, Three, lower_limit, rule_weights, weights_of
from truing import Bench, Block, Check, Table, TruingError, Words

FOUND = "found"
BEFORE = 2  # steps before the variants: the field, and Box's search with the grid beside it
SCREWS = 8192  # drawn to tell what scatter leaves of the margins
COMPARED = (
    "roller_shift", "ring_shift", "tip_radius_roller", "tip_radius_ring", "contact_ratio", "tip_land",
    "sliding_roller", "sliding_ring", "sliding_difference", "nominal_stress_roller", "nominal_stress_ring",
    "stress_difference", "shift_sum",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Shifting:
    """Choose the shift of the roller between the ends of ``span``; ``points`` are those of the dense grid.

    Box's method with ``vertices``, ``reflection`` and ``spread`` as in the paper; ``ratios`` are further least contact
    ratios under which the optimum is found, by every reading of the weights.
    """

    span: tuple[float, float] = (-2.0, 3.0)
    points: int = 20_001
    vertices: int = 9
    reflection: float = 1.3
    spread: float = 1e-8
    ratios: tuple[float, ...] = (1.2, 1.4, 1.42)
    name: str = "shift"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if len(self.span) != 2 or not self.span[0] < self.span[1]:
            raise TruingError(f"study '{self.name}': span is the lowest and the highest shift of the roller")
        if not 11 <= self.points <= 1_000_000:
            raise TruingError(f"study '{self.name}': points = {self.points}, but a grid has 11 to 1000000")
        if not all(ratio >= 1 for ratio in self.ratios):
            raise TruingError(f"study '{self.name}': ratios are least contact ratios, 1 or more")
        Plan(vertices=self.vertices, reflection=self.reflection, spread=self.spread)

    def run(self, bench: Bench) -> "Chosen":
        """Find where every limit is kept, the ranges of the objectives there, the weights, and the optimum."""
        pair: Pair = bench.inputs
        span = (float(self.span[0]), float(self.span[1]))
        ratios = sorted({*self.ratios, float(pair.least_contact_ratio)})
        bench.progress(self.name, 0, _steps(ratios))
        field = field_of(pair, span, self.points)
        equal = equal_sliding(pair, span, self.points)
        if field is None:
            return Chosen(pair, span, equal, status=self._nothing(pair, span))
        bench.progress(self.name, 1, _steps(ratios))
        weights = weights_of(pair.weights, field.ranges)
        grid = grid_optimum(field, weights)
        box, remarks = self._box(bench, field, weights, span)
        best = grid if box is None else float(box.point[0])
        return Chosen(
            pair, span, equal,
            status=FOUND,
            field=field,
            weights=weights,
            box=box,
            grid=grid,
            other=other_optimum(pair, span, self.points),
            variants=tuple(self._variants(bench, ratios, span)),
            factor=stress_factor(field, weights, grid),
            compared=_compared(bench, field, best),
            kept=(_kept(bench, float(pair.roller_shift)), _kept(bench, best)),
            remarks=remarks,
        )  # fmt: skip

    def _box(
        self, bench: Bench, field: Field, weights: Three, span: tuple[float, float]
    ) -> tuple[Found | None, tuple[str, ...]]:
        plan = Plan(vertices=self.vertices, reflection=self.reflection, spread=self.spread)
        try:
            found = box_optimum(field, weights, span, np.random.default_rng(bench.setup.seed), plan)
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
        course = course_of(pair, np.linspace(*span, self.points))
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


def _compared(bench: Bench, field: Field, best: float) -> Mapping[str, Any]:
    """Geometry, sliding and stresses before, as stated and at the optimum, SI (3,) by name."""
    at = np.array([before(field), float(bench.inputs.roller_shift), best])
    found = bench.rows({"roller_shift": at}, len(at), *COMPARED[1:])
    return {"roller_shift": at, **found}


def _kept(bench: Bench, shift: float) -> float:
    """The share of screws of this shift that keep every limit, with the tolerances in force."""
    names = tuple(Margins.__dataclass_fields__)
    columns = {**bench.drawn(SCREWS), "roller_shift": np.full(SCREWS, shift)}
    found = bench.rows(columns, SCREWS, *names)
    return float(np.mean(np.all([found[name] >= 0.0 for name in names], axis=0)))


def before(field: Field) -> float:
    """The shift to compare with: none at all where that keeps every limit, else the allowed one nearest to none."""
    part = field.around(0.0)
    return min(max(0.0, part.low), part.high)


@dataclass(frozen=True, eq=False)
class Chosen:
    """The optimum by Box's method and on the grid, and where the objectives were weighed.

    Without any shift that keeps every limit ``field`` is None and ``status`` says why. ``equal`` is the shift at which
    both roots slide alike, whatever the limits; ``other`` the optimum by the other reading of the sliding; ``kept`` the
    shares of screws, as stated and at the optimum, that keep every limit although their parts scatter.
    """

    inputs: Pair
    span: tuple[float, float]
    equal: float
    status: str
    field: Field | None = None
    weights: Three = (0.0, 0.0, 0.0)
    box: Found | None = None
    grid: float = float("nan")
    other: float = float("nan")
    variants: tuple[Variant, ...] = ()
    factor: float | None = None
    compared: Mapping[str, Any] | None = None
    kept: tuple[float, float] = (float("nan"), float("nan"))
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
        return chosen_json(self)

    def blocks(self) -> "Sequence[Block]":
        """Return nothing: the sections on the choice of the shift show it."""
        return ()

    def checks(self) -> "Sequence[Check]":
        """Return nothing: the checks judge the shift that is stated."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Say what was not found."""
        status = () if self.status == FOUND else (self.status,)
        return [f"study 'shift': {text}" for text in (*status, *self.remarks, *_silent(self))]


def _silent(chosen: Chosen) -> Sequence[str]:
    """Name objectives that are the same for every shift."""
    names = ("sum of the shifts", "difference of the root stresses", "difference of sliding")
    if chosen.field is None:
        return ()
    return [
        f"the {name} is the same for every shift, so it is left out of the weighing"
        for name, (low, high) in zip(names, chosen.field.ranges, strict=True)
        if not high > low
    ]


# How the choice of the shift is written: results.json, tables and words of the sheet


MM, MEGA = 1e3, 1e6
ALIKE = 5e-5  # of a shift, on the sheet
SLIDING = {
    "path": "the largest sliding of each gear on the path of contact",
    "roots": "the sliding at the roots alone, which need not be the largest,",
}
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
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
    ("root stress of the roller, nominal", "nominal_stress_roller", "MPa", 1 / MEGA),
    ("root stress of the ring, nominal", "nominal_stress_ring", "MPa", 1 / MEGA),
    ("specific sliding of the roller, largest", "sliding_roller", "", 1.0),
    ("specific sliding of the ring, largest", "sliding_ring", "", 1.0),
    ("sum of the shifts", "shift_sum", "", 1.0),
    ("difference of the root stresses", "stress_difference", "MPa", 1 / MEGA),
    ("difference of specific sliding", "sliding_difference", "", 1.0),
)


def spoken(limits: Sequence[str]) -> str:
    """Return limits by number and name."""
    return " and ".join(" ".join(LIMITS.get(name, ("a root that", "does not exist"))) for name in limits)


def number(value: float) -> float | None:
    """Return a number as results.json may hold it."""
    return float(value) if isfinite(value) else None


def chosen_json(chosen: "Chosen") -> Mapping[str, Any]:
    """Return what results.json holds."""
    entry: dict[str, Any] = {"status": chosen.status, "equal_sliding": number(chosen.equal)}
    field = chosen.field
    if field is None:
        return entry
    ranges = zip(("shift_sum", "stress_difference", "sliding_difference"), OBJECTIVES, field.ranges, strict=True)
    entry["intervals"] = [
        {"low": part.low, "high": part.high, "low_limits": list(part.low_limits), "high_limits": list(part.high_limits)}
        for part in field.intervals
    ]
    entry["ranges"] = {name: {"low": low, "high": high, "unit": unit} for name, (_, _, unit), (low, high) in ranges}
    entry["weights"] = {"reading": chosen.inputs.weights, "values": list(chosen.weights)}
    entry["grid"] = {"shift": chosen.grid, "points": len(field.course.shifts)}
    if chosen.box is not None:
        box = chosen.box
        entry["box"] = {
            "shift": float(box.point[0]), "cost": box.cost, "spread": box.spread, "evaluations": box.evaluations,
            "drawn": box.drawn, "reflections": box.reflections, "settled": box.settled,
        }  # fmt: skip
    entry["other_sliding_reading"] = {"reading": OTHER[chosen.inputs.sliding_reading], "shift": number(chosen.other)}
    entry["limits"] = list(chosen.limits)
    entry["kept"] = {"stated": number(chosen.kept[0]), "optimum": number(chosen.kept[1])}
    entry["stress_factor"] = chosen.factor
    entry["variants"] = [
        {"least_contact_ratio": each.least_contact_ratio, "weights": each.reading, "values": list(each.weights),
         "shift": each.shift, "contact_ratio": each.contact_ratio, "limits": list(each.limits)}
        for each in chosen.variants
    ]  # fmt: skip
    return entry


def intervals_words(field: "Field") -> Words:
    """Say which shifts keep every limit, and what ends them."""
    parts = []
    for part in field.intervals:
        low = f"where {spoken(part.low_limits)} is missed" if part.low_limits else "where the search begins"
        high = f"where {spoken(part.high_limits)} is missed" if part.high_limits else "where the search ends"
        parts.append(f"from {signed(part.low)} ({low}) to {signed(part.high)} ({high})")
    return Words(f"Every limit is kept by shifts of the roller {', and '.join(parts)}.")


def weights_table(chosen: "Chosen", field: "Field") -> Table:
    """List the ranges found here and the weights taken."""
    rows = [
        (name, sense, unit, signed(low), signed(high), weight)
        for (name, sense, unit), (low, high), weight in zip(OBJECTIVES, field.ranges, chosen.weights, strict=True)
    ]
    columns = ("objective", "to be", "unit", "from", "to", "weight taken")
    return Table("Ranges and weights", columns, rows, note=f"Weights: {READING[chosen.inputs.weights]}.")


def printed_table() -> Table:
    """List what the paper prints of ranges and weights, and what its rule makes of it."""
    rows = [
        (name, unit, low, high, stated, by_rule, lower_limit(stated, high))
        for (name, _, unit), (low, high), stated, by_rule in zip(
            OBJECTIVES, PRINTED_RANGES, PRINTED_WEIGHTS, rule_weights(PRINTED_RANGES), strict=True
        )
    ]
    columns = ("printed", "unit", "from", "to", "weight", "weight by its rule", "or from")
    note = "The printed weight would follow by the rule if the range began where the last column says."
    return Table("Ranges and weights in the paper", columns, rows, note=note)


def compared_table(chosen: "Chosen", field: "Field") -> Table:
    """Set the pair before, as stated and at the optimum side by side."""
    compared = chosen.compared or {}
    rows = [
        (name, unit, *(number(scale * float(value)) for value in compared[key]))
        for name, key, unit, scale in ROWS
        if key in compared
    ]
    first = "no shift" if before(field) == 0.0 else "nearest to no shift"
    return Table("Before and after", ("", "unit", f"{first} of the roller", "as stated", "optimum"), rows)


def optimum_words(chosen: "Chosen", field: "Field") -> "list[Block]":
    """Say where the optimum lies, how it was found, and what holds it there."""
    blocks: list[Block] = []
    ring = chosen.shift + field_difference(field)
    where = f"The optimum is {signed(chosen.shift)} for the roller and {signed(ring)} for the ring. "
    if chosen.box is not None:
        box = chosen.box
        where += (
            f"Box's method found it with {box.evaluations} evaluations, {box.drawn} to draw the first vertices; "
            f"the grid of {len(field.course.shifts)} shifts says {signed(chosen.grid, '.6f')}, "
            f"{small(abs(chosen.shift - chosen.grid))} beside it."
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


def _other_words(chosen: "Chosen") -> str:
    """Say where the other reading of the sliding leads."""
    if not isfinite(chosen.other):
        return f"By {SLIDING[OTHER[chosen.inputs.sliding_reading]]} no shift keeps every limit."
    same = abs(chosen.other - chosen.grid) < ALIKE
    led = "there is the same optimum" if same else f"the optimum would be {signed(chosen.other)} for the roller"
    taken, other = SLIDING[chosen.inputs.sliding_reading], SLIDING[OTHER[chosen.inputs.sliding_reading]]
    return f"The third objective compares {taken}. By {other} {led}."


def _scatter_words(chosen: "Chosen") -> str:
    """Say what the scatter of the parts leaves of the margins."""
    stated, best = (f"{100 * share:.4g} %" for share in chosen.kept)
    words = (
        f"With the tolerances in force {stated} of the screws keep every limit as stated, and {best} at the optimum."
    )
    if chosen.limits and chosen.kept[1] < 0.999:
        words += (
            " An optimum that stands at a limit leaves nothing for scatter: stay away from it by what the parts need."
        )
    return words


def field_difference(field: "Field") -> float:
    """The shift of the ring less that of the roller."""
    return float(field.course.objectives[0, 0] - 2.0 * field.course.shifts[0])


def variants_table(chosen: "Chosen", field: "Field") -> Table:
    """List the optimum by least contact ratio and weights."""
    difference = field_difference(field)
    rows = [
        (f"{each.least_contact_ratio:g}", READING[each.reading], each.shift, each.shift + difference,
         each.contact_ratio, spoken(each.limits) or "none")
        for each in chosen.variants
    ]  # fmt: skip
    return Table(
        "The optimum by least contact ratio and weights",
        ("least contact ratio", "weights", "roller", "ring", "contact ratio", "limit that holds it"),
        rows,
        note="On the grid. The paper prints 0.21 and −0.16.",
    )


def small(value: float) -> str:
    """A small number in words of the sheet."""
    if not value:
        return "nothing"
    power = floor(log10(value))
    return f"{value / 10.0**power:.1f}·10{str(power).translate(RAISED)}"


def signed(value: float, digits: str = ".4f") -> str:
    """A number with a true minus."""
    return f"{value:{digits}}".replace("-", "−")
