"""Drawn machines: their backlash when new, and histories, indices and chances over the years."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rv_wear.calculation import backlash_of
from rv_wear.discs import DiscFlank, flank
from rv_wear.quantities import Reducer
from truing import Bench, Float, Odds, Outcome, Sensitivities, Swept, TruingError, axis, found, results

# What the studies give as results: histories, indices and chances, each known once per run and never per draw

STEP = 1e-6  # m; equation 21 is linear, so any step gives its derivatives
COUNTED = "counted among the machines that were drawn, equation 23"
FACTORS: dict[int, str] = {
    1: "base_tangent_error", 2: "gear_runout", 3: "centre_distance_error", 4: "equidistant_modification",
    5: "shift_modification", 6: "pin_circle_error", 7: "pin_radius_error", 8: "pin_fit_clearance", 9: "disc_runout",
    10: "pin_position_error", 11: "disc_pitch_error", 12: "equidistant_error", 13: "shift_error",
    14: "eccentricity_error", 15: "backlash_wear", 16: "bearing_clearance",
}  # fmt: skip
REFERENCE = 6
AT_SAME_WEAR = (4, 5)


@results
class History:
    """Forces and wear along the flank; wear and backlash over the working time, from new."""

    phase_angle: Float = axis("deg", symbol="psi", note="phase angle of a pin, from the crank line")
    normal_force: Float = found("N", symbol="F", along="phase_angle", note="force on a pin, unworn",
                                method="equation 2 at every position of the disc")  # fmt: skip
    worn_force: Float = found("N", symbol="F_T", along="phase_angle", note="force on a pin after the working time",
                              method="equation 2 with the worn profile")  # fmt: skip
    wear_depth: Float = found("um", symbol="h", along="phase_angle", note="wear after the working time",
                              method="equations 13 to 16")  # fmt: skip

    wear_place: Float = found("%", symbol="x_h", note="place of the deepest wear in the loaded part of the flank",
                              method="0 where the contact of the new mesh begins, 100 % where it ends",
                              key=True)  # fmt: skip
    history_time: Float = axis("h", symbol="T", note="working time")
    wear_history: Float = found("um", symbol="h_max", along="history_time", note="deepest wear",
                                method="equations 13 to 16 up to each time")  # fmt: skip
    backlash_history: Float = found("arcmin", symbol="Delta phi", along="history_time", note="backlash",
                                    method="equation 21 with the wear at each time")  # fmt: skip


def index(number: int, what: str) -> Any:
    """Declare the sensitivity index of one factor."""
    return found(
        "", symbol=f"s_{number}", note=f"{number}: {what}", source="equation 24",
        method="derivative of equation 21, divided by that of factor 6",
    )  # fmt: skip


@results
class SobolIndices:
    """The sixteen sensitivity indices of Table 2: how much backlash each error gives, against the pin circle radius."""

    index_1: Float = index(1, "base tangent length of the involute gears")
    index_2: Float = index(2, "radial runout of the involute gears")
    index_3: Float = index(3, "centre distance")
    index_4: Float = index(4, "equidistant modification, the wear unchanged")
    index_5: Float = index(5, "shift modification, the wear unchanged")
    index_6: Float = index(6, "radius of the pin circle, the reference")
    index_7: Float = index(7, "radius of the pins")
    index_8: Float = index(8, "fit of the pins in their holes")
    index_9: Float = index(9, "radial runout of the cycloid toothing")
    index_10: Float = index(10, "pin holes along the circumference")
    index_11: Float = index(11, "cumulative pitch of the cycloid disc")
    index_12: Float = index(12, "equidistant modification as ground")
    index_13: Float = index(13, "shift modification as ground")
    index_14: Float = index(14, "throw of the crank")
    index_15: Float = index(15, "wear")
    index_16: Float = index(16, "clearance of the crank bearings")


@results
class Chances:
    """How often the backlash stays within its limit, and the normal distribution beside it."""

    accuracy_reliability: Float = found("%", symbol="R_T", note="share of machines within the permitted backlash",
                                        method=COUNTED, key=True)  # fmt: skip
    normal_reliability: Float = found("%", symbol="R_N", note="the same for a normal distribution",
                                      method="first order; equation 21 is linear",
                                      formula="Phi((permitted_backlash - backlash_mean) / backlash_sd)",
                                      key=True)  # fmt: skip
    backlash_mean: Float = found("arcmin", symbol="mu", note="mean of the machines", method="first order", key=True)
    backlash_sd: Float = found("arcmin", symbol="sigma", note="standard deviation of the machines",
                               method="first order", key=True)  # fmt: skip
    sampled_mean: Float = found("arcmin", symbol="mu_d", note="mean of the machines drawn", method="Monte Carlo")
    sampled_sd: Float = found("arcmin", symbol="sigma_d", note="standard deviation of the machines drawn",
                              method="Monte Carlo")  # fmt: skip
    largest_backlash: Float = found("arcmin", symbol="Delta phi_d", note="largest among the machines drawn",
                                    method="Monte Carlo", key=True)  # fmt: skip
    reliability_time: Float = axis("h", symbol="T", note="working time")
    reliability_history: Float = found("%", symbol="R_T", along="reliability_time",
                                       note="share within the permitted backlash", method=COUNTED)  # fmt: skip


def history(swept: Swept) -> History:
    """The flank after its working time; wear and backlash over the time, empty if another input is swept."""
    reducer: Reducer = swept.inputs
    new, worn = flank(reducer), flank(reducer, float(reducer.working_time))
    wear = worn.wear[0]
    along_time = swept.over == "working_time"
    nothing = np.empty(0)
    return History(
        phase_angle=new.angle,
        normal_force=new.force[0],
        worn_force=worn.force[0],
        wear_depth=np.where(wear > 0.0, reducer.depth_factor * wear + reducer.extra_wear, 0.0),
        wear_place=place_of_wear(new, wear),
        history_time=swept.axis if along_time else nothing,
        wear_history=swept.results["max_wear"] if along_time else nothing,
        backlash_history=swept.results["backlash"] if along_time else nothing,
    )


def place_of_wear(new: "DiscFlank", wear: "NDArray[np.float64]") -> float:
    """Where the wear is deepest: 0 where the contact of the new mesh begins, 1 where it ends."""
    loaded = new.angle[new.force[0] > 0.0]
    span = float(loaded[-1] - loaded[0])
    return float(new.angle[wear.argmax()] - loaded[0]) / span if span else nan


def indices(found: Sensitivities) -> SobolIndices:
    """The derivatives of equation 21 over that by the pin circle radius; the modifications at the same wear."""
    slopes = dict(found.derivatives.get("backlash", {}))
    slopes.update(slopes_at_same_wear(found.inputs))
    reference = slopes.get(FACTORS[REFERENCE], nan)
    return SobolIndices(**{f"index_{number}": slopes.get(name, nan) / reference for number, name in FACTORS.items()})


def slopes_at_same_wear(reducer: Reducer) -> dict[str, float]:
    """Derivatives of equation 21 by what also moves the wear, and by the wear itself, rad/m."""
    slopes = {}
    for number in AT_SAME_WEAR:
        name = FACTORS[number]
        value = getattr(reducer, name)
        up, down = (replace(reducer, **{name: value + step}) for step in (STEP, -STEP))
        slopes[name] = _slope(backlash_of(up, 0.0), backlash_of(down, 0.0))
    slopes[FACTORS[15]] = _slope(backlash_of(reducer, STEP), backlash_of(reducer, -STEP))
    return slopes


def _slope(up: Mapping[str, Float], down: Mapping[str, Float]) -> float:
    return (float(up["backlash"]) - float(down["backlash"])) / (2 * STEP)


def chances(odds: Odds) -> Chances:
    """Reliability, mean and spread of the backlash; the reliability over the working time where it was asked for."""
    limit = float(odds.inputs.permitted_backlash)
    moves = {demand.name: bool(demand.moving) for demand in odds.demands}
    mean = odds.first_mean.get("backlash", nan) + (limit if moves.get("backlash") else 0.0)
    drawn = odds.moments.get("backlash")
    curve, nothing = odds.curve, np.empty(0)
    if curve is not None and (curve.over != "working_time" or "backlash" not in curve.probability):
        curve = None
    return Chances(
        accuracy_reliability=odds.probability.get("backlash", nan),
        normal_reliability=odds.analytic.get("backlash", nan),
        backlash_mean=mean,
        backlash_sd=odds.first_sd.get("backlash", nan),
        sampled_mean=drawn.mean if drawn else nan,
        sampled_sd=drawn.sd if drawn else nan,
        largest_backlash=drawn.largest if drawn else nan,
        reliability_time=curve.axis if curve else nothing,
        reliability_history=curve.probability["backlash"] if curve else nothing,
    )


# A study of our own: the backlash of machines when new, the paper's Fig. 4, and after their working time

ARCMIN = 3.141592653589793 / 10800.0
MOST = 100_000


@dataclass(frozen=True, kw_only=True)
class NewMachines:
    """Draw ``draws`` machines, the first ones of the study 'reliability', and keep the backlash of each."""

    draws: int = 2000
    name: str = "new_machines"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not 2 <= self.draws <= MOST:
            raise TruingError(f"study '{self.name}': draws = {self.draws}, but 2 to {MOST} machines can be shown")

    def run(self, bench: "Bench") -> "Newborn":
        """Calculate each machine twice: without any working time, and with that of the run."""
        columns = bench.drawn(self.draws)
        as_new = {name: values for name, values in columns.items() if name != "working_time"}
        return Newborn(
            new=bench.changed({"working_time": 0.0}).rows(as_new, self.draws, "backlash")["backlash"],
            used=bench.rows(columns, self.draws, "backlash")["backlash"],
            limit=float(bench.setup.inputs.permitted_backlash),
            inputs=bench.inputs,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Newborn(Outcome):
    """Backlash of machines (n,) in rad, new and after the working time, NaN where one cannot be; the permitted one."""

    new: "NDArray[np.float64]"
    used: "NDArray[np.float64]"
    limit: float
    inputs: Any = None

    def as_json(self) -> Mapping[str, Any]:
        """Return mean, standard deviation, largest backlash and the share above the limit, new and used."""
        return {
            "draws": len(self.new),
            **{when: self._summary(values) for when, values in (("new", self.new), ("used", self.used))},
        }

    def _summary(self, values: "NDArray[np.float64]") -> dict[str, Any]:
        known = values[np.isfinite(values)]
        if len(known) < 2:
            return {"failed": len(values)}
        return {
            "unit": "arcmin",
            "mean": float(known.mean()) / ARCMIN,
            "sd": float(known.std(ddof=1)) / ARCMIN,
            "largest": float(known.max()) / ARCMIN,
            "within": float(np.mean(values <= self.limit)),
            "failed": len(values) - len(known),
        }
