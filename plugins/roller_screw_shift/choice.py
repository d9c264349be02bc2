"""What the choice of the shift gives as results."""

from math import nan

import numpy as np

from roller_screw_shift.courses import MEGA, course_of
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.shifts import Chosen
from roller_screw_shift.weighing import Three
from truing import Float, found, results

KEPT = "over all shifts that keep every limit"
RULE = "one over the square of half the range; or as the input weights states"
BOX = "Box's complex method on the weighed sum"
DRAWN = "8192 screws drawn from the tolerances in force"


def weight(symbol: str, of: str, unit: str) -> float:
    """Declare a weight."""
    declared: float = found(unit, symbol=symbol, note=f"weight of the {of}", method=RULE, source="the paper")
    return declared


def reach(symbol: str, what: str, unit: str = "") -> float:
    """Declare an end of the range of an objective."""
    declared: float = found(unit, symbol=symbol, note=what, method=KEPT)
    return declared


def optimal(symbol: str, what: str, unit: str = "") -> float:
    """Declare a number at the optimum."""
    declared: float = found(unit, symbol=symbol, note=f"{what} at the optimum", method=BOX)
    return declared


@results
class Choice:
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
    grid_shift: Float = found("", symbol="x_E,grid", note="optimal shift of the roller on a dense grid",
                              method="a check of Box's method")  # fmt: skip
    grid_distance: Float = found("", symbol="Delta x_grid", note="between both optima",
                                 method="magnitude")  # fmt: skip
    evaluations: Float = found("", symbol="n_eval", note="shifts that Box's method tried", method="drawn ones counted")
    equal_sliding_roller: Float = found("", symbol="x_E,3", note="shift of the roller at which both roots slide alike",
                                        method="whatever the limits")  # fmt: skip
    equal_sliding_ring: Float = found("", symbol="x_I,3", note="shift of the ring there", method="no backlash")


def choice(chosen: Chosen) -> Choice:
    """The numbers of the study; NaN where no shift keeps every limit."""
    difference = float(np.asarray(geometry_of(chosen.inputs).shift_difference))
    equal = {"equal_sliding_roller": chosen.equal, "equal_sliding_ring": chosen.equal + difference}
    field = chosen.field
    if field is None:
        names = (name for name in Choice.__dataclass_fields__ if name not in equal)
        return Choice(**{**dict.fromkeys(names, nan), **equal})
    (sum_low, sum_high), (stress_low, stress_high), (sliding_low, sliding_high) = field.ranges
    part = field.around(chosen.shift)
    return Choice(
        lowest_shift=min(each.low for each in field.intervals),
        highest_shift=max(each.high for each in field.intervals),
        least_sum=sum_low,
        most_sum=sum_high,
        least_stress_difference=MEGA * stress_low,
        most_stress_difference=MEGA * stress_high,
        least_sliding=sliding_low,
        most_sliding=sliding_high,
        **_weights(chosen.weights),
        **_optimum(chosen, difference),
        limit_distance=max(min(chosen.shift - part.low, part.high - chosen.shift), 0.0),
        kept_as_stated=chosen.kept[0],
        kept_at_optimum=chosen.kept[1],
        grid_shift=chosen.grid,
        grid_distance=nan if chosen.box is None else abs(chosen.shift - chosen.grid),
        evaluations=nan if chosen.box is None else float(chosen.box.evaluations),
        **equal,
    )


def _weights(weights: Three) -> dict[str, float]:
    return {"weight_sum": weights[0], "weight_stress": weights[1] / MEGA**2, "weight_sliding": weights[2]}


def _optimum(chosen: Chosen, difference: float) -> dict[str, float]:
    at = course_of(chosen.inputs, np.array([chosen.shift]))
    total, stress, sliding = (float(values[0]) for values in at.objectives)
    return {
        "optimal_shift_roller": chosen.shift,
        "optimal_shift_ring": chosen.shift + difference,
        "optimal_sum": total,
        "optimal_stress_difference": MEGA * stress,
        "optimal_sliding_difference": sliding,
        "optimal_contact_ratio": float(at.margins["margin_contact_ratio"][0])
        + float(chosen.inputs.least_contact_ratio),
        "optimal_margin": min(float(margin[0]) for margin in at.margins.values()),
    }
