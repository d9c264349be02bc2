"""A study of our own: a load spectrum with direction, wear of either flank, life to the permitted backlash."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rv_wear.forces import Loads, shared, start_scale
from rv_wear.geometry import Mesh, many, mesh_of, teeth_of
from rv_wear.quantities import Reducer
from rv_wear.wear import MOST_STEPS, growth, oil_part
from truing import Array, Bench, Block, Float, Outcome, Table, TruingError, axis, found, quantity, results

HOUR = 3600.0
SENSES = ("forward", "back")
WRITE = "write torque, speed, share of the hours and sense, as in '3136 N*m, 15 r/min, 40 %, forward'"
LONGEST = 20.0  # working times: a life beyond is not followed
POINTS = 41
BY_STEPS = "equations 13 to 16, every load on the profile that all of them have left"
MANY = 1_000_000


@results
class Lived:
    """Wear of both flanks under the spectrum, and how long a machine stays within the permitted backlash."""

    wear_forward: Float = found("um", symbol="h_a", note="deepest wear of the flank that forward torque loads",
                                method=BY_STEPS)  # fmt: skip
    wear_back: Float = found("um", symbol="h_b", note="deepest wear of the other flank", method=BY_STEPS)
    spectrum_backlash: Float = found("arcmin", symbol="Delta phi_S", note="backlash under the spectrum",
                                     method="equation 21 with the mean of both flanks", key=True)  # fmt: skip
    spectrum_reliability: Float = found("%", symbol="R_S", key=True, method="counted among the machines drawn",
                                        note="share of machines within it after the working time")  # fmt: skip
    spectrum_life: Float = found("h", symbol="T_50", note="hours after which half of the machines are beyond it",
                                 method="of the machines drawn")  # fmt: skip
    spectrum_life_90: Float = found("h", symbol="T_90", note="hours for which 90 % of the machines stay within it",
                                    method="of the machines drawn", key=True)  # fmt: skip
    spectrum_time: Float = axis("h", symbol="T", note="hours of the clock")
    spectrum_survival: Float = found("%", symbol="R_S", along="spectrum_time", note="share of machines still within it",
                                     method="counted among the machines drawn")  # fmt: skip


@dataclass(frozen=True)
class LoadBlock:
    """A torque (N m), a speed (1/s), its share of the hours of the clock, and its sense: +1 or -1."""

    torque: float
    speed: float
    share: float
    sense: int


def read_block(text: str) -> LoadBlock:
    """Read a block as it is written. Raises TruingError that says how to write it."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 4 or parts[3] not in SENSES:
        raise TruingError(f"'{text}' is no load; {WRITE}; the sense is {' or '.join(SENSES)}")
    try:
        torque, speed, share = (quantity(part, unit) for part, unit in zip(parts, ("N*m", "r/min", "%"), strict=False))
    except TruingError as error:
        raise TruingError(f"'{text}' is no load: {error}; {WRITE}") from None
    if not (torque > 0.0 and speed > 0.0 and 0.0 < share <= 1.0):
        raise TruingError(f"'{text}': torque, speed and share lie above 0, and the share up to 100 %; sense is a word")
    return LoadBlock(torque, speed, share, 1 if parts[3] == SENSES[0] else -1)


@dataclass(frozen=True, kw_only=True)
class LoadSpectrum:
    """Wear both flanks under ``loads`` that change quickly against the life, and find the life of ``draws`` machines.

    A load is written as torque, speed, share of the hours and sense. The shares add up to the hours in which the
    reducer works; what is left of 100 % it stands still. Without any load the reducer turns as the inputs say, with the
    hours of each sense by ``reversing``, or half of them each way without it.

    A machine wears as the nominal one, faster or slower by its wear coefficient. That is exact for the tolerances of
    the model without a film; what effects scatter otherwise than by this coefficient, the life does not see.
    """

    loads: tuple[str, ...] = ()
    draws: int = 20_000
    name: str = "load_spectrum"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        total = sum(block.share for block in map(read_block, self.loads))
        if total > 1.0 + 1e-9:
            raise TruingError(f"study '{self.name}': the loads take {100 * total:.4g} % of the hours; 100 % are there")
        if not 2 <= self.draws <= MANY:
            raise TruingError(f"study '{self.name}': draws = {self.draws}, but 2 to {MANY} machines can be drawn")

    def run(self, bench: Bench) -> "Spectrum":
        """Follow both flanks as far as any machine may wear, and read every machine off them."""
        reducer: Reducer = bench.inputs
        blocks = tuple(map(read_block, self.loads)) or _as_stated(reducer)
        machines = _machines(bench, self.draws)
        working = float(reducer.working_time)
        longest = float(_older(reducer, LONGEST * max(working, HOUR))) * float(machines.faster.max())
        flanks = tuple(flank_history(reducer, blocks, sense, longest) for sense in (1, -1))
        return Spectrum(
            loads=blocks, reducer=reducer, flanks=flanks, machines=machines, life=_lives(reducer, flanks, machines)
        )


def _as_stated(reducer: Reducer) -> tuple[LoadBlock, ...]:
    torque, speed, share = float(reducer.output_torque), float(reducer.output_speed), reducer.reversing
    back = 0.5 if share is None or np.isnan(share) else 0.5 * float(share)
    return tuple(LoadBlock(torque, speed, part, sense) for part, sense in ((1.0 - back, 1), (back, -1)) if part > 0.0)


# Wear of one flank: all loads that press on it wear the one profile, each with the forces that it has there


@dataclass(frozen=True, eq=False)
class FlankHistory:
    """Deepest wear (n,) over the time (n,), s, of one flank of the nominal machine; ageing not counted."""

    time: Array
    depth: Array

    def after(self, time: Float) -> Array:
        """The depth after some time, and that of the last step beyond it."""
        return np.asarray(np.interp(time, self.time, self.depth))


def flank_history(reducer: Reducer, blocks: Sequence[LoadBlock], sense: int, until: float) -> FlankHistory:
    """Wear one flank step by step; loads alternate quickly, so within a step each wears for its share of the time."""
    mine = [block for block in blocks if block.sense == sense]
    if not mine:
        return FlankHistory(np.array([0.0, until]), np.zeros(2))
    teeth, weight = teeth_of(_mesh(reducer, mine)), _weights(reducer, mine)
    loads: Loads = shared(teeth, teeth.slack, start_scale(teeth))
    rate_of, threshold = growth(teeth, loads), float(reducer.reconstruction_depth)
    time, wear = [0.0], np.zeros(teeth.slack.shape[:2])
    depth = [0.0]
    while time[-1] < until and len(time) < MOST_STEPS:
        rate = (rate_of(loads.force) * weight).sum(axis=-1)
        if not rate.any():  # a film carries everywhere
            return FlankHistory(np.array([*time, until]), np.array([*depth, depth[-1]]))
        step = threshold / float(rate.max())
        wear = wear + rate * step
        time.append(time[-1] + step)
        depth.append(float(wear.max()))
        loads = shared(teeth, teeth.slack + (wear[..., None] * teeth.per_arm), loads.scale)
    return FlankHistory(np.array(time), np.array(depth))


def _mesh(reducer: Reducer, blocks: Sequence[LoadBlock]) -> Mesh:
    """One mesh per load."""
    torque, speed = (np.array([getattr(block, name) for block in blocks]) for name in ("torque", "speed"))
    return many(mesh_of(replace(reducer, output_torque=torque, output_speed=speed)))


def _weights(reducer: Reducer, blocks: Sequence[LoadBlock]) -> Array:
    """Exposure per second of the clock of every load, (m,)."""
    turns = np.array([block.share * block.speed for block in blocks])
    return np.asarray(oil_part(reducer) * reducer.sliding_factor * reducer.pin_count * turns)


# Life: the backlash without wear, and how much faster a machine wears than the nominal one, are all that it needs


@dataclass(frozen=True, eq=False)
class DrawnMachines:
    """Backlash without wear in rad, (n,) and of the nominal machine; wear coefficient over the nominal one (n,)."""

    without_wear: Array
    faster: Array
    nominal: float


def _machines(bench: Bench, draws: int) -> DrawnMachines:
    wanted = ("backlash", "backlash_of_wear", "coefficient")
    rows = bench.rows(bench.drawn(draws), draws, *wanted)
    backlash, of_wear, coefficient = (np.asarray(rows[name]) for name in wanted)
    known = np.isfinite(backlash) & np.isfinite(coefficient)
    nominal = float(bench.answers["backlash"]) - float(bench.answers["backlash_of_wear"])
    faster = coefficient[known] / float(bench.answers["coefficient"])
    return DrawnMachines((backlash - of_wear)[known], faster, nominal)


def _older(reducer: Reducer, time: Float) -> Float:
    """Hours that wear as much with new oil: the oil ages by the clock."""
    return time * (1.0 + 0.5 * float(reducer.ageing_rate) * time)


def _younger(reducer: Reducer, time: Array) -> Array:
    """Hours of the clock, the inverse of ``_older``."""
    rate = float(reducer.ageing_rate)
    return time if rate == 0.0 else np.asarray((np.sqrt(1.0 + 2.0 * rate * time) - 1.0) / rate)


def felt(reducer: Reducer, flanks: Sequence[FlankHistory], time: Array) -> Array:
    """The angle of wear (n,) at the output after times (n,) of the nominal oil, new."""
    depth = sum(flank.after(time) for flank in flanks)
    loaded = sum(bool(flank.depth[-1] > 0.0) for flank in flanks)
    share = reducer.lost_motion_share * (1.0 + reducer.pin_wear_ratio)
    both = share * (reducer.depth_factor * depth + loaded * reducer.extra_wear)
    return np.asarray(both / (reducer.eccentricity * (reducer.pin_count - 1)))


def _lives(reducer: Reducer, flanks: Sequence[FlankHistory], machines: DrawnMachines) -> Array:
    """Seconds of the clock (n,) until each machine reaches the permitted backlash; infinite where it does not."""
    times = np.unique(np.concatenate([flank.time for flank in flanks]))
    angle = felt(reducer, flanks, times)
    left = float(reducer.permitted_backlash) - machines.without_wear
    reached = np.interp(left, angle, times) / machines.faster
    life = _younger(reducer, np.where(left < angle[0], 0.0, reached))
    return np.where(left > angle[-1], np.inf, life)


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrum(Outcome):
    """The loads, the histories of both flanks (forward, back), the machines, and the life (n,) of each in s."""

    loads: tuple[LoadBlock, ...]
    reducer: Reducer
    flanks: tuple[FlankHistory, ...]
    machines: DrawnMachines
    life: Array

    def surviving(self, time: Float) -> Array:
        """The share of machines within the permitted backlash after times (s)."""
        return np.asarray(np.mean(self.life[:, None] >= np.atleast_1d(time), axis=0))

    @property
    def hours(self) -> Array:
        """Times of the curves (n,), s: a little beyond the life of most machines."""
        most = float(np.quantile(np.minimum(self.life, LONGEST * max(float(self.reducer.working_time), HOUR)), 0.99))
        return np.linspace(0.0, max(most, float(self.reducer.working_time)), POINTS)

    def as_json(self) -> Mapping[str, Any]:
        """Return the loads and the life."""
        given = lived(self)
        return {
            "loads": [
                {"torque": block.torque, "speed": 60.0 * block.speed, "share": block.share, "sense": block.sense,
                 "units": {"torque": "N*m", "speed": "r/min"}}
                for block in self.loads
            ],
            "machines": len(self.life),
            "wear": {"unit": "um", "forward": float(given.wear_forward) * 1e6, "back": float(given.wear_back) * 1e6},
            "life": {"unit": "h", **{str(share): hours for share, hours in self._quantiles()}},
            "reliability": float(given.spectrum_reliability),
        }  # fmt: skip

    def _quantiles(self) -> list[tuple[int, float | None]]:
        """Share of machines in percent and the hours for which so many stay within the limit; None: not reached."""
        found = [(share, life_of(self.life, share / 100.0) / HOUR) for share in (99, 95, 90, 50)]
        return [(share, hours if np.isfinite(hours) else None) for share, hours in found]

    def blocks(self) -> Sequence[Block]:
        """Return the loads, and the hours for which so many machines stay within the limit."""
        rows: list[tuple[str | float, ...]] = [
            (load.torque, 60.0 * load.speed, 100.0 * load.share, SENSES[0] if load.sense > 0 else SENSES[1])
            for load in self.loads
        ]
        heads, units = ("torque", "speed", "share of the hours", "sense"), ("N·m", "r/min", "%", "")
        lives = [(share, "not reached" if hours is None else round(hours)) for share, hours in self._quantiles()]
        return [
            Table("Load spectrum", heads, rows, units, "The loads alternate quickly against the life."),
            Table("Life to the permitted backlash", ("machines within it", "hours"), lives, ("%", "h"),
                  f"Of {len(self.life)} machines drawn."),
        ]  # fmt: skip

    def warnings(self) -> Sequence[str]:
        """Say where no life is told."""
        beyond = float(np.mean(~np.isfinite(self.life)))
        longest = LONGEST * float(self.reducer.working_time) / HOUR
        text = f"study 'load_spectrum': {100 * beyond:.3g} % of the machines last longer than {longest:.4g} h"
        return [text] if beyond else []


def life_of(life: Array, share: float) -> float:
    """The longest time for which this share of machines stays within the limit, s; infinite where they always do."""
    within = int(np.ceil(share * len(life) - 1e-9))
    return float(np.sort(life)[len(life) - within])


def lived(spectrum: Spectrum) -> Lived:
    """The numbers of the study."""
    reducer, time = spectrum.reducer, np.asarray(float(spectrum.reducer.working_time))
    nominal = _older(reducer, time)
    depths = [
        reducer.depth_factor * float(flank.after(nominal)) + float(flank.depth[-1] > 0.0) * reducer.extra_wear
        for flank in spectrum.flanks
    ]
    return Lived(
        wear_forward=depths[0],
        wear_back=depths[1],
        spectrum_backlash=spectrum.machines.nominal + float(felt(reducer, spectrum.flanks, np.asarray(nominal))),
        spectrum_reliability=float(spectrum.surviving(time)[0]),
        spectrum_life=life_of(spectrum.life, 0.5),
        spectrum_life_90=life_of(spectrum.life, 0.9),
        spectrum_time=spectrum.hours,
        spectrum_survival=np.asarray(spectrum.surviving(spectrum.hours)),
    )
