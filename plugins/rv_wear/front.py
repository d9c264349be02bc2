"""What surrogate, optimisation and allocation give as results: how good, how cheap, how little wear."""

from dataclasses import replace
from math import isnan, nan
from typing import Any

import numpy as np

from rv_wear.calculation import rv_wear
from rv_wear.least_costs import Fronts
from rv_wear.quantities import Reducer
from truing import Allotted, Emulated, Float, Optimum, axis, found, results

HOUR = 3600.0
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
                                 method="where no zone may be wider than it is now")  # fmt: skip
    front_cost: Float = axis("yuan", symbol="C", note="cost of the designs of the front")
    front_wear: Float = found("um", symbol="h_max", along="front_cost", note="deepest wear of the designs of the front",
                              method=ORDER)  # fmt: skip
    front_equidistant: Float = found("um", symbol="Delta r_rp", along="front_cost",
                                     note="equidistant modification of the designs", method=ORDER)  # fmt: skip


def end(number: int, what: str, unit: str, symbol: str) -> float:
    """Declare a number of the front under one of the paper's two constraints, found without a search."""
    reliability = CONSTRAINTS[number]
    declared: float = found(
        unit, symbol=f"{symbol},{number}", note=f"{what}, reliability {reliability:g}",
        method=f"least cost at every modification, constraint {number} of the paper",
    )  # fmt: skip
    return declared


@results
class Ends:
    """Where the front begins and where its knee is, under both constraints of the paper, whatever the inputs ask."""

    least_wear_1: Float = end(1, "smallest wear of the front", "um", "h_f")
    corner_cost_1: Float = end(1, "cost at its knee", "yuan", "C_k")
    corner_wear_1: Float = end(1, "deepest wear at its knee", "um", "h_k")
    least_wear_2: Float = end(2, "smallest wear of the front", "um", "h_f")
    corner_cost_2: Float = end(2, "cost at its knee", "yuan", "C_k")
    corner_wear_2: Float = end(2, "deepest wear at its knee", "um", "h_k")


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


def ends(fronts: Fronts) -> Ends:
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
    return Ends(**given)


def bought(allotted: Allotted) -> Bought:
    """The least cost that reaches the goal; none where it cannot be reached."""
    plan = allotted.least_cost
    return Bought(least_cost=plan.cost if plan.reached and not isnan(plan.cost) else nan)
