"""The front of cost and wear without any search, and what surrogate, optimisation and allocation give."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, isnan, nan
from typing import Any

import numpy as np

from rv_wear.calculation import rv_wear
from rv_wear.quantities import Reducer
from truing import (
    Allocation,
    Allotted,
    Array,
    Bench,
    Emulated,
    Float,
    Optimum,
    Outcome,
    Reliability,
    TruingError,
    axis,
    found,
    results,
)

# A study of our own: the front of cost and wear without any search, the paper's Fig. 6, and its Fig. 7
#
# For every equidistant modification the widths of least cost that reach the goal are found; as the wear depends on the
# modification alone, this is the front itself (the epsilon-constraint method). An evolutionary search is judged by it.


MICRO, HOUR = 1e-6, 3600.0
STEP = 1.0  # um of the equidistant modification from one design to the next
HALVINGS = 10
MOST_CLEARANCE = 20.0  # um
ALL_WIDEST = 1e-6  # of the cost: the next design is no cheaper


@dataclass(frozen=True, kw_only=True)
class LeastCosts:
    """Find the least cost for every wear, with each of ``goals`` for the reliability and with that of the inputs.

    Widths run from those in force to ``widest`` times as much, the equidistant modification over ``span`` (um) in steps
    of ``step``. With ``clearances`` (um) both modifications are free: of the designs of all these radial clearances
    those remain that no other beats. Without them the design clearance is kept. ``points`` are those of the knee's
    reliability over time.
    """

    goals: tuple[float, ...] = (0.95, 0.999)
    widest: float = 2.0
    span: tuple[float, float] = (-45.0, 4.0)
    step: float = STEP
    clearances: tuple[float, ...] = ()
    points: int = 25
    name: str = "least_costs"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not all(0 < goal < 1 for goal in self.goals):
            raise TruingError(f"study '{self.name}': goals lie between 0 and 1")
        if len(self.span) != 2 or not self.span[0] < self.span[1]:
            raise TruingError(f"study '{self.name}': span is the lowest and the highest modification in um")
        if not self.step > 0 or not all(0 <= clearance <= MOST_CLEARANCE for clearance in self.clearances):
            raise TruingError(
                f"study '{self.name}': step lies above 0, and clearances between 0 and {MOST_CLEARANCE:g} um"
            )
        if not 2 <= self.points <= 1000:
            raise TruingError(f"study '{self.name}': points = {self.points}, but a curve has 2 to 1000 points")
        if not self.widest > 1:
            raise TruingError(f"study '{self.name}': widest = {self.widest:g} must lie above 1")

    def run(self, bench: Bench) -> "Fronts":
        """Follow each front from the smallest wear to the least cost, and the reliability of its knee over time."""
        own = float(bench.setup.inputs.required_reliability)
        goals = sorted({*self.goals, own} if own < 1 else {*self.goals})
        fronts = []
        for place, goal in enumerate(goals):
            done = bench.part(self.name, place / len(goals), (place + 1) / len(goals))
            designs = self._free(bench, goal, done) if self.clearances else self._designs(bench, goal, done)
            fronts.append(CostFront(goal, tuple(designs), *self._knee(bench, designs)))
        return Fronts(tuple(fronts), bench.inputs)

    def _free(self, bench: Bench, goal: float, done: Callable[[int, int], None]) -> "list[Design]":
        """The designs of all radial clearances that no other beats, from the smallest wear on."""
        designs: list[Design] = []
        for place, clearance in enumerate(self.clearances):
            done(place, len(self.clearances))
            at = bench.changed({"design_clearance": clearance * MICRO})
            designs += self._designs(at, goal, lambda step, steps: None)
        designs.sort(key=lambda design: (design.wear, design.cost))
        kept: list[Design] = []
        for design in designs:
            if not kept or design.cost < (1 - ALL_WIDEST) * kept[-1].cost:
                kept.append(design)
        return kept

    def _designs(self, bench: Bench, goal: float, done: Callable[[int, int], None]) -> "list[Design]":
        """Designs at one radial clearance, from the smallest wear to the least cost."""
        designs: list[Design] = []
        modification = self._first(bench, goal)
        steps = 1 if modification is None else ceil((modification - self.span[0]) / self.step) + 1
        while modification is not None and modification >= self.span[0]:
            done(len(designs), steps)
            design = self._design(bench, modification, goal)
            if design is None or (designs and design.cost > (1 - ALL_WIDEST) * designs[-1].cost):
                break
            designs.append(design)
            modification = self.step * ceil(modification / self.step - 1.0)
        return designs

    def _first(self, bench: Bench, goal: float) -> float | None:
        """The largest modification at which the widths in force reach the goal, um; None where there is none."""
        low, high = self.span
        if self._chance(bench, low) < goal:
            return None
        if self._chance(bench, high) >= goal:
            return high
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._chance(bench, middle) >= goal else (low, middle)
        return low

    def _chance(self, bench: Bench, modification: float) -> float:
        """Reliability to first order with the widths in force; 0 where the disc cannot be."""
        at = ground(bench, modification)
        return 0.0 if at is None else _odds(at)

    def _design(self, bench: Bench, modification: float, goal: float) -> "Design | None":
        at = ground(bench, modification, required_reliability=goal)
        if at is None:
            return None
        study = Allocation(of="backlash", tightest=1.0, widest=self.widest, starts=1, draws=1, name=self.name)
        plan = study.run(at).least
        if not plan.reached:
            return None
        clearance = float(bench.setup.inputs.design_clearance)
        return Design(modification * MICRO, clearance, float(at.answers["max_wear"]), plan.cost, dict(plan.widths))

    def _knee(self, bench: Bench, designs: Sequence["Design"]) -> tuple[int | None, Any, Any]:
        """The knee's place, and its reliability over the working time to first order."""
        if not designs:
            return None, np.empty(0), np.empty(0)
        place = farthest_from_chord(np.array([[design.cost, design.wear / MICRO] for design in designs]))
        found = designs[place]
        own = bench.changed({"design_clearance": found.clearance}) if self.clearances else bench
        at = ground(own, found.modification / MICRO, widths=found.widths)
        hours = float(bench.setup.inputs.working_time) / HOUR
        if at is None or hours <= 0.0:
            return place, np.empty(0), np.empty(0)
        times, chances = _odds(at, "working_time", f"0..{hours!r} h", self.points)
        return place, times, chances


def _odds(bench: Bench, over: str = "", at: str = "", points: int = 2) -> Any:
    """The reliability of the backlash to first order, or times and reliabilities along the working time."""
    odds = Reliability(method=("first_order",), over=over, at=at, points=points).run(bench)
    if odds.curve is None:
        return float(odds.analytic["backlash"])
    return odds.curve.axis, odds.curve.analytic["backlash"]


def ground(
    bench: Bench, modification: float, *, widths: Mapping[str, float] | None = None, **inputs: float
) -> Bench | None:
    """The bench with another equidistant modification (um) at the design clearance; None where that cannot be."""
    shift = modification * MICRO - float(bench.setup.inputs.design_clearance)
    changed = {"equidistant_modification": modification * MICRO, "shift_modification": shift, **inputs}
    try:
        return bench.changed(changed, widths)
    except TruingError:
        return None


def farthest_from_chord(front: "Array") -> int:
    """The place of the design (n, 2) below the chord of the front, both objectives brought to 0 to 1."""
    span = np.ptp(front, axis=0)
    scaled = (front - front.min(axis=0)) / np.where(span > 0, span, 1.0)
    return int(np.argmin(scaled.sum(axis=1)))


@dataclass(frozen=True)
class Design:
    """Equidistant modification, radial clearance and deepest wear (m), cost (yuan), width of every priced zone (m)."""

    modification: float
    clearance: float
    wear: float
    cost: float
    widths: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class CostFront:
    """Designs from the smallest wear to the least cost; the knee's place, and its reliability (n,) over times (n,)."""

    goal: float
    designs: tuple[Design, ...]
    knee: int | None
    times: "Array"
    chances: "Array"


@dataclass(frozen=True, eq=False)
class Fronts(Outcome):
    """One front by goal."""

    fronts: tuple[CostFront, ...]
    inputs: Reducer

    def as_json(self) -> Mapping[str, Any]:
        """Return every front with its knee."""
        return {"fronts": [_front_json(front) for front in self.fronts]}

    def warnings(self) -> Sequence[str]:
        """Say which goal cannot be reached."""
        return [
            f"study 'least_costs': no equidistant modification reaches a reliability of {front.goal:g} with these zones"
            for front in self.fronts
            if not front.designs
        ]


def _front_json(front: CostFront) -> dict[str, Any]:
    return {
        "goal": front.goal,
        "knee": front.knee,
        "equidistant_modification": {"unit": "um", "values": [item.modification / MICRO for item in front.designs]},
        "radial_clearance": {"unit": "um", "values": [item.clearance / MICRO for item in front.designs]},
        "max_wear": {"unit": "um", "values": [item.wear / MICRO for item in front.designs]},
        "cost": {"unit": "yuan", "values": [item.cost for item in front.designs]},
        "widths": [
            {name: {"value": width / MICRO, "unit": "um"} for name, width in item.widths.items()}
            for item in front.designs
        ],
    }


# What surrogate, optimisation and allocation give as results: how good, how cheap, how little wear

TIMES = tuple(HOUR * hours for hours in range(300, 3001, 300))  # s; the paper's figure 3 ends at 3000 h
KNEE = "the design of the front farthest from its chord"
CONSTRAINTS = {1: 0.95, 2: 0.999}
ORDER = "designs in the order of their cost"


@results
class Learnt:
    """What the surrogate of the wear is worth."""

    band_share: Float = found("%", symbol="n_95", note="points up to 3000 h within the 95 % band of the surrogate",
                              method="ten times, everything else as in the inputs")  # fmt: skip
    surrogate_coverage: Float = found("%", symbol="c_95", note="held-out points within the 95 % band",
                                      method="designs that were not learnt from")  # fmt: skip
    surrogate_error: Float = found("%", symbol="e_50", note="median error of the surrogate", method="of these points")
    surrogate_worst: Float = found("%", symbol="e_max", note="largest error of the surrogate", method="of these points")


@results
class Front:
    """The designs that no other beats in cost and wear, and the knee among them."""

    knee_cost: Float = found("yuan", symbol="C_k", note="cost at the knee of the front", method=KNEE)
    knee_wear: Float = found("um", symbol="h_k", note="deepest wear at the knee of the front", method=KNEE)
    knee_equidistant: Float = found("um", symbol="Delta r_rp,k", note="equidistant modification at the knee",
                                    method=KNEE)  # fmt: skip
    smallest_wear: Float = found("um", symbol="h_f", note="smallest wear on the front",
                                 method="where no zone may be wider than it is now", key=True)  # fmt: skip
    front_cost: Float = axis("yuan", symbol="C", note="cost of the designs of the front")
    front_wear: Float = found("um", symbol="h_max", along="front_cost", note="deepest wear of the designs of the front",
                              method=ORDER)  # fmt: skip
    front_equidistant: Float = found("um", symbol="Delta r_rp", along="front_cost",
                                     note="equidistant modification of the designs", method=ORDER)  # fmt: skip


def end(number: int, what: str, unit: str, symbol: str) -> Any:
    """Declare a number of the front under one of the paper's two constraints, found without a search."""
    reliability = CONSTRAINTS[number]
    return found(
        unit, symbol=f"{symbol},{number}", note=f"{what}, reliability {reliability:g}",
        method=f"least cost at every modification, constraint {number} of the paper",
    )  # fmt: skip


@results
class FrontEnds:
    """Where the front begins and where its knee is, under both constraints of the paper, whatever the inputs ask."""

    least_wear_1: Float = end(1, "smallest wear of the front", "um", "h_f")
    corner_cost_1: Float = end(1, "cost at its knee", "yuan", "C_k")
    corner_wear_1: Float = end(1, "deepest wear at its knee", "um", "h_k")
    least_wear_2: Float = end(2, "smallest wear of the front", "um", "h_f")
    corner_cost_2: Float = end(2, "cost at its knee", "yuan", "C_k")
    corner_wear_2: Float = end(2, "deepest wear at its knee", "um", "h_k")


@results
class FreeEnds:
    """The front where both modifications are free, for the reliability that the inputs ask for."""

    free_wear: Float = found("um", symbol="h_f,0", note="smallest wear of the front, both modifications free",
                             method="least cost at every modification and radial clearance")  # fmt: skip
    free_knee_wear: Float = found("um", symbol="h_k,0", note="deepest wear at its knee", method=KNEE)
    free_knee_cost: Float = found("yuan", symbol="C_k,0", note="cost at its knee", method=KNEE)
    free_clearance: Float = found("um", symbol="Delta r_k,0", note="radial clearance at its knee", method=KNEE)


def free_ends(fronts: Fronts) -> FreeEnds:
    """The ends of the first front; none where its goal cannot be reached."""
    front = fronts.fronts[0]
    knee = front.designs[front.knee] if front.knee is not None else None
    return FreeEnds(
        free_wear=front.designs[0].wear if front.designs else nan,
        free_knee_wear=knee.wear if knee else nan,
        free_knee_cost=knee.cost if knee else nan,
        free_clearance=knee.clearance if knee else nan,
    )


@results
class Bought:
    """The least cost at the modifications as they are."""

    least_cost: Float = found("yuan", symbol="C_min", note="least cost with these modifications",
                              method="widths with equal gain of variance per yuan, none tighter than now")  # fmt: skip


def learnt(emulated: Emulated) -> Learnt:
    """Coverage and errors of the surrogate, and how many of ten times lie in its band."""
    judged = emulated.judged.get("max_wear")
    times = np.array(TIMES)
    try:
        low, high = emulated.predict_band({"working_time": times})["max_wear"]
    except KeyError:
        return Learnt(band_share=nan, surrogate_coverage=nan, surrogate_error=nan, surrogate_worst=nan)
    reducer: Reducer = replace(emulated.inputs, working_time=times)
    wear = np.asarray(rv_wear(reducer).max_wear)
    return Learnt(
        band_share=float(np.mean((low <= wear) & (wear <= high))),
        surrogate_coverage=judged.coverage if judged else nan,
        surrogate_error=float(np.median(judged.shares)) if judged else nan,
        surrogate_worst=float(np.max(judged.shares)) if judged else nan,
    )


def front(optimum: Optimum) -> Front:
    """The front in the order of cost; empty, and without a knee, where no design keeps the limits."""
    designs = sorted(optimum.front, key=lambda design: _of(design, "tolerance_price"))
    knee = optimum.knee
    wear = np.array([_of(design, "max_wear") for design in designs])
    return Front(
        knee_cost=_of(knee, "tolerance_price"),
        knee_wear=_of(knee, "max_wear"),
        knee_equidistant=knee.inputs.get("equidistant_modification", nan) if knee else nan,
        smallest_wear=float(np.nanmin(wear)) if len(wear) and not np.isnan(wear).all() else nan,
        front_cost=np.array([_of(design, "tolerance_price") for design in designs]),
        front_wear=wear,
        front_equidistant=np.array([design.inputs.get("equidistant_modification", nan) for design in designs]),
    )


def _of(design: Any, objective: str) -> float:
    """An objective of a design of the front; NaN where there is none."""
    return nan if design is None else float(design.objectives.get(objective, nan))


def ends(fronts: Fronts) -> FrontEnds:
    """The fronts of both constraints; none where a goal was not asked for or cannot be reached."""
    given: dict[str, float] = {}
    for number, goal in CONSTRAINTS.items():
        designs = next((each.designs for each in fronts.fronts if each.goal == goal), ())
        knee = next(
            (each.designs[each.knee] for each in fronts.fronts if each.goal == goal and each.knee is not None), None
        )
        given[f"least_wear_{number}"] = designs[0].wear if designs else nan
        given[f"corner_cost_{number}"] = knee.cost if knee else nan
        given[f"corner_wear_{number}"] = knee.wear if knee else nan
    return FrontEnds(**given)


def bought(allotted: Allotted) -> Bought:
    """The least cost that reaches the goal; none where it cannot be reached."""
    plan = allotted.least_cost
    return Bought(least_cost=plan.cost if plan.reached and not isnan(plan.cost) else nan)
