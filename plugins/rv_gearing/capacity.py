"""Studies of our own: how much torque and time each limit leaves, and how the safeties run along one input."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rv_gearing.quantities import Gearing
from truing import Bench, Block, Check, Float, Sweep, Swept, Table, TruingError, found, results

Values = NDArray[np.float64]

HOUR = 3600.0
SPAN = 1e4  # a limit is sought between the load as it is over SPAN and times SPAN
HALVINGS = 60
SAFETIES = ("root_safety_sun", "root_safety_planet", "contact_safety_sun", "contact_safety_planet")
LIMITS = {
    "root_safety_sun": "breakage of the sun",
    "root_safety_planet": "breakage of the planet",
    "contact_safety_sun": "pitting of the sun",
    "contact_safety_planet": "pitting of the planet",
}
AROUND = {  # unit in SI, and the range as parts of the value
    "load_torque": ("N*m", 0.1, 2.0), "stated_sun_torque": ("N*m", 0.1, 2.0), "power": ("W", 0.1, 2.0),
    "face_width": ("m", 0.5, 2.0), "working_life": ("s", 0.1, 10.0),
}  # fmt: skip
SOUGHT = "bisection on the whole calculation"


@results
class Rating:
    """What the first stage may be loaded with."""

    torque_capacity: Float = found("N*m", symbol="T_2,max", note="output torque at which the first safety is used up",
                                   method=SOUGHT)  # fmt: skip
    power_capacity: Float = found("kW", symbol="P_max", note="input power at this torque and the speed of the run",
                                  method="in proportion to the torque")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Capacity:
    """Find the output torque, and the working time, at which each safety falls to what is asked of it."""

    name: str = "capacity"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Reserve":
        """Bisect on torque and on time for all four limits at once."""
        stage: Gearing = bench.inputs
        stated = not isnan(float(stage.stated_sun_torque))
        torque = float(bench.answers["output_torque"]) or 1.0
        sun = float(bench.answers["sun_torque"]) or 1.0
        column, start = ("stated_sun_torque", sun) if stated else ("load_torque", torque)
        life = float(stage.working_life)
        speed, power = float(bench.answers["sun_speed"]), 2.0 * np.pi * float(bench.answers["sun_torque"])
        return Reserve(
            inputs=stage,
            safeties=np.array([float(bench.answers[name]) for name in SAFETIES]),
            required=_required(stage),
            torque=torque * _used_up(bench, column, start, bench.part(self.name, 0.0, 0.5)),
            life=life * _used_up(bench, "working_life", life, bench.part(self.name, 0.5, 1.0)),
            power_per_torque=power * speed / float(bench.answers["output_torque"] or nan),
        )


def _required(stage: Gearing) -> "Values":
    bending, contact = float(stage.least_bending_safety), float(stage.least_contact_safety)
    return np.array([bending, bending, contact, contact])


def _used_up(bench: "Bench", column: str, start: float, done: Callable[[int, int], None]) -> "Values":
    """By what factor on the column each safety falls to what is asked; infinite where never, 0 where always below."""
    required = _required(bench.inputs)
    low, high = np.full(len(SAFETIES), -np.log(SPAN)), np.full(len(SAFETIES), np.log(SPAN))

    def enough(factors: "Values") -> "NDArray[np.bool_]":
        found = bench.rows({column: start * np.exp(factors)}, len(SAFETIES), *SAFETIES)
        return np.array([found[name][place] for place, name in enumerate(SAFETIES)]) >= required

    never, always = enough(high), np.logical_not(enough(low))
    for halving in range(HALVINGS):
        done(halving, HALVINGS)
        middle = 0.5 * (low + high)
        holds = enough(middle)
        low, high = np.where(holds, middle, low), np.where(holds, high, middle)
    return np.where(never, np.inf, np.where(always, 0.0, np.exp(low)))


@dataclass(frozen=True, kw_only=True)
class Reserve:
    """By limit (4,): safety, what is asked, and torque (N m) and time (s) at which they meet; infinite where never."""

    inputs: Gearing
    safeties: "Values"
    required: "Values"
    torque: "Values"
    life: "Values"
    power_per_torque: float

    @property
    def governing(self) -> str:
        """The limit that is met first as the torque grows."""
        return LIMITS[SAFETIES[int(np.argmin(self.torque))]]

    def as_json(self) -> Mapping[str, Any]:
        """Return safety, limit, torque and time of every limit; null where it is never met."""
        return {
            "governing": self.governing,
            "limits": {
                name: {
                    "safety": float(self.safeties[place]),
                    "required": float(self.required[place]),
                    "output_torque": {"value": _finite(self.torque[place]), "unit": "N*m"},
                    "working_life": {"value": _finite(self.life[place] / HOUR), "unit": "h"},
                }
                for place, name in enumerate(SAFETIES)
            },
        }

    def blocks(self) -> Sequence[Block]:
        """Return the limits as a table."""
        rows = [
            (
                LIMITS[name],
                float(self.safeties[place]),
                float(self.required[place]),
                _finite(self.torque[place]) or _beyond(self.torque[place]),
                _finite(self.life[place] / HOUR) or _beyond(self.life[place]),
            )
            for place, name in enumerate(SAFETIES)
        ]
        return [
            Table(
                "What uses up each safety",
                ("limit", "safety", "asked", "at an output torque of", "or after"),
                rows,
                ("", "", "", "N*m", "h"),
                f"Everything else as stated. {self.governing[0].upper() + self.governing[1:]} comes first.",
            )
        ]

    def checks(self) -> "Sequence[Check]":
        """Return nothing: the stresses of the run are checked, not what would be."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()


def _finite(value: Any) -> float | None:
    return float(value) if 0.0 < value < np.inf else None


def _beyond(value: Any) -> str:
    return "never" if value > 0.0 else "always below"


def rating(reserve: Reserve) -> Rating:
    """The torque that may be, and the power that goes with it."""
    torque = float(np.min(reserve.torque))
    return Rating(
        torque_capacity=torque if np.isfinite(torque) else nan,
        power_capacity=torque * reserve.power_per_torque if np.isfinite(torque) else nan,
    )


@dataclass(frozen=True, kw_only=True)
class Safeties(Sweep):
    """How the four safeties run along one input; without ``at`` from a part of its value in the run to a multiple.

    Where the torque of the sun is stated, a load torque means nothing; then the stated one takes its place.
    """

    at: str = ""
    points: int = 49
    name: str = "safeties"

    def run(self, bench: "Bench") -> Swept:
        """Sweep the input, and keep the safeties of the two gears alone."""
        stated = float(bench.inputs.stated_sun_torque)
        at_sun = self.over == "load_torque" and stated > 0.0
        over = "stated_sun_torque" if at_sun else self.over
        at = self.at if self.at and not at_sun else _around(bench, over, self.name)
        swept = Sweep(over=over, at=at, points=self.points, name=self.name).run(bench)
        kept = {name: swept.results[name] for name in SAFETIES if name in swept.results}
        return replace(swept, results=kept, shown=False)


def _around(bench: "Bench", over: str, study: str) -> str:
    """A range around the value of the run."""
    if over not in AROUND:
        raise TruingError(f"study '{study}': write at = \"low..high unit\", the range of {over}")
    unit, least, most = AROUND[over]
    answer = bench.answers["output_torque"] if over == "load_torque" else getattr(bench.inputs, over)
    value = abs(float(answer)) or 1.0
    return f"{least * value!r}..{most * value!r} {unit}"
