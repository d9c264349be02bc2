"""What each study gives back as results, and a study of our own: both readings of the paper."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import nan, pi
from typing import Any

import numpy as np

from press_linkage import errors
from press_linkage.kinematics import Half, crank_at, cycle_demands, nominal, smallest_sine, solve, top_crank_angle
from press_linkage.quantities import Cycle, ErrorInfluence, Press, PressChances, Synthesis
from truing import Allocation, Allotted, Bench, Odds, Outcome, Sensitivities, Swept, Table, feasible

EVERY = (*errors.KINDS, "platform_arm")
KEY_TILT = (
    "slider_joint_angle", "ground_pivot_angle", "lower_knee_length", "upper_knee_length", "knee_drive_length",
)  # fmt: skip
KEY_POSITION = (*KEY_TILT, "slider_half_width")
LINKS = (
    "lower_knee_length", "upper_knee_length", "knee_drive_length", "rod_length", "crank_radius", "platform_arm",
)  # fmt: skip
ALONG = ("slider_half_width", "crank_pivot_radius", "platform_half_width", "ground_pivot_radius")
VARIANCES = ("variance_links", "variance_joints_along", "variance_joints_across", "variance_other")
SWING = "; if the crank only swings, leave the sweep out of the studies"


def sources_of(kinds: tuple[str, ...]) -> list[str]:
    """The inputs that carry errors of these kinds: one per side, the platform arm once."""
    both = [errors.source(kind, side) for kind in kinds if kind != "platform_arm" for side in (1, 2)]
    return [*both, errors.ARM] if "platform_arm" in kinds else both


def cycle(swept: Swept) -> Cycle:
    """Dead centres, stroke, and how close the press comes to a singular position; the crank must turn fully."""
    press: Press = swept.inputs
    for holds, sentence in cycle_demands(press):
        feasible(holds, sentence + SWING)
    top = top_crank_angle(press)
    bdc, tdc = solve(press, 0.0).slider_position, solve(press, top).slider_position
    turn = smallest_sine(solve(press, np.linspace(-pi, pi, 721)))
    cosine, sine = crank_at(press, 0.0)
    return Cycle(
        bdc_direction=float(np.arctan2(sine, cosine)),
        bdc_platform_height=float(solve(nominal(press), 0.0).platform_height),
        tdc_crank_angle=float(top),
        bdc_position=float(bdc),
        tdc_position=float(tdc),
        stroke=float(bdc - tdc),
        smallest_sine=float(np.min(turn)),
    )


def influence(found: Sensitivities) -> ErrorInfluence:
    """The nominal chain with the influence of each error, and what the sources in force do together."""
    press: Press = found.inputs
    exact = solve(nominal(press))
    by_kind = errors.side_sensitivities(exact.side_1)
    shift = solve(press).slider_position - exact.slider_position
    return ErrorInfluence(
        **_chain(press, exact.side_1, float(press.crank_angle)),
        platform_height=float(exact.platform_height),
        nominal_position=float(exact.slider_position),
        slider_shift=float(shift),
        **{f"influence_{kind}": float(errors.without_rounding(value)) for kind, value in by_kind.items()},
        salience_position_key=_key_salience(found, "slider_position", KEY_POSITION, EVERY),
        salience_tilt_key=_key_salience(found, "slider_tilt", KEY_TILT, errors.PASSIVE),
        **_variances(found),
        position_sd=found.sd.get("slider_position", nan),
        tilt_sd=found.sd.get("slider_tilt", nan),
    )


def _chain(press: Press, half: Half, crank_angle: float) -> dict[str, float]:
    """The directions of one side and the place of its knee."""
    cosine, sine = crank_at(press, 0.0)
    shorter = press.knee_drive_length**2 - press.upper_knee_length**2
    found = {
        "crank_direction": np.arctan2(sine, cosine) + crank_angle,
        "rod_direction": half.rod.angle,
        "ground_distance": np.sqrt(half.knee_span),
        "knee_along": 0.5 + shorter / (2 * half.knee_span),
        "knee_across": np.sqrt(half.knee_fold),
        "knee_y": half.knee.y,
        "knee_z": half.knee.z,
        "drive_direction": half.drive.angle,
        "upper_direction": half.upper.angle,
        "lower_direction": half.lower.angle,
    }
    return {name: float(value) for name, value in found.items()}


def _key_salience(found: Sensitivities, result: str, key: tuple[str, ...], among: tuple[str, ...]) -> float:
    """The share of the key errors in the sum of the sensitivities to errors of the kinds *among*."""
    by_source = found.derivatives.get(result, {})
    named = {name: by_source[name] for name in sources_of(among) if name in by_source}
    if not set(sources_of(key)) <= set(named):
        return nan
    shares = errors.salience(named)
    return float(sum(shares[name] for name in sources_of(key)))


def _variances(found: Sensitivities) -> dict[str, float]:
    """The variance of the slider position by the kind of part it comes from, m^2."""
    shares = found.share.get("slider_position")
    if shares is None:
        return dict.fromkeys(VARIANCES, nan)
    whole = found.sd["slider_position"] ** 2
    parts = [sources_of(kinds) for kinds in (LINKS, ALONG, errors.POLAR_ANGLES)]
    other = [name for name in shares if not any(name in part for part in parts)]
    return {
        name: whole * sum(shares.get(error, 0.0) for error in part)
        for name, part in zip(VARIANCES, [*parts, other], strict=True)
    }


def chances(odds: Odds) -> PressChances:
    """Both reliabilities to first order, and how far the press is out of the middle of its limits."""
    offset = {
        demand.name: float(odds.nominal[demand.result] - 0.5 * (demand.low + demand.high)) for demand in odds.demands
    }
    return PressChances(
        position_offset=offset.get("slider_position", nan),
        tilt_offset=offset.get("slider_tilt", nan),
        position_reliability=odds.analytic.get("slider_position", nan),
        tilt_reliability=odds.analytic.get("slider_tilt", nan),
    )


def synthesis(allotted: Allotted) -> Synthesis:
    """Where tightening grade by grade ends, and the coefficients that set its order."""
    coefficients = {f"coefficient_{link}": float(allotted.coefficients.get(link, nan)) for link in LINKS}
    return Synthesis(
        adjustments=allotted.adjustments,
        position_reliability_final=allotted.final.get("slider_position", nan),
        tilt_reliability_final=allotted.final.get("slider_tilt", nan),
        **coefficients,
    )


# A study of our own: the same press under both readings of the paper's tolerances, side by side

READINGS = ("printed", "complete")
CHECKS = {"slider_position": "position", "slider_tilt": "tilt"}


@dataclass(frozen=True, kw_only=True)
class Readings:
    """Reliability and synthesis under the readings ``printed`` and ``complete``, first order.

    ``finest`` is the finest grade of the synthesis.
    """

    finest: str = "IT5"
    name: str = "readings"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Compared":
        """Allocate under each reading; whatever the inputs file says of tolerances holds for both."""
        study = Allocation(of="slider_position", finest=self.finest, draws=1, name=self.name)
        found = {}
        for place, reading in enumerate(READINGS):
            press = replace(bench.setup.inputs, reading=reading)
            answers = {**bench.answers, "permitted_tilt": errors.permitted_tilt(press)}
            setup = replace(bench.setup, inputs=press)
            told = _part(bench, self.name, place)
            own = replace(bench, setup=setup, answers=answers, progress=told)
            found[reading] = study.run(own)
        return Compared(found, self.finest)


def _part(bench: "Bench", name: str, place: int) -> Callable[[str, int, int], None]:
    """Return what reports the study of one reading as its part of this one."""
    done = bench.part(name, place / len(READINGS), (place + 1) / len(READINGS))
    return lambda task, step, steps: done(step, steps)


@dataclass(frozen=True)
class Compared(Outcome):
    """What each reading comes to."""

    by_reading: Mapping[str, Allotted]
    finest: str = "IT5"

    def as_json(self) -> dict[str, Any]:
        """Return reliabilities before and after, adjustments, and whether the goals are reached."""
        return {
            reading: {
                "start": dict(found.start),
                "final": dict(found.final),
                "adjustments": found.adjustments,
                "reached": found.reached,
            }
            for reading, found in self.by_reading.items()
        }

    def table(self) -> Table:
        """Return both readings as a table of the sheet."""
        rows: list[tuple[str | int | float | bool, ...]] = []
        for reading, found in self.by_reading.items():
            chances = [100 * chance[check] for check in CHECKS for chance in (found.start, found.final)]
            rows.append((reading, *chances, found.adjustments, found.reached))
        columns = [f"{name} {when}" for name in CHECKS.values() for when in ("start", "final")]
        return Table(
            "Reliability under both readings",
            ("reading", *columns, "adjustments", "goals reached"),
            rows,
            ("", "%", "%", "%", "%", "", ""),
            f"First order, links down to {self.finest}. Tolerances that the inputs file states hold for both.",
        )
