"""A study of our own: the shift that the paper's weighed objectives prefer among those that keep every limit."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from roller_screw_shift.best_shifts import (
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
from roller_screw_shift.weighing import Three, weights_of
from truing import Bench, TruingError

if TYPE_CHECKING:
    from truing import Block, Check

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
        from roller_screw_shift.shifts_printed import chosen_json

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
