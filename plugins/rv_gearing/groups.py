"""The search for tooth numbers: every sun, planet and pin number that meets the five conditions of the paper.

The conditions: one tooth fewer on the disc than pins (in the ratio itself), an even number of pins so that two discs
half a turn apart share one ring of them, ratio within its tolerance, sun of at least ``fewest_sun_teeth`` and planet of
at least ``least_tooth_ratio`` times as many, centre distance within the window that the output torque admits.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rv_gearing.duty import (
    centre_distance_of,
    centre_distance_window,
    efficiency_of,
    output_torque,
    pin_circle_window,
    ratio_of,
    torque_of,
)
from rv_gearing.preference import preference_of
from rv_gearing.quantities import Gearing
from truing import Float, column, either, feasible

Values = NDArray[np.float64]

ROUNDING = 1e-12  # a limit that is met exactly is met
MOST_TRIED = 4_000_000  # sets of tooth numbers in one search
MOST_AT_ONCE = 1_000_000  # rows times sets in one array
SEARCHED = (
    "power", "output_speed", "target_ratio", "ratio_tolerance", "module", "helix_angle", "least_tooth_ratio",
    "involute_efficiency", "cycloid_efficiency", "bearing_efficiency", "pin_circle_low", "pin_circle_high",
    "centre_share_low", "centre_share_high",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Teeth:
    """Tooth numbers of one drive or of a batch: sun, planet, pins."""

    sun: Float
    planet: Float
    pins: Float


@dataclass(frozen=True, kw_only=True)
class Groups:
    """Everything the search tells of the groups it finds, each (groups,), SI."""

    sun: "Values"
    planet: "Values"
    pins: "Values"
    ratio: "Values"
    deviation: "Values"  # of the ratio, relative, with its sign
    torque: "Values"
    centre_distance: "Values"
    circle_low: "Values"
    circle_high: "Values"
    common_first: "Values"  # largest common factor of sun and planet, and of disc and pins
    common_second: "Values"
    planet_kinds: "Values"
    mesh_phases: "Values"
    preference: "Values"  # 1 is best

    def __len__(self) -> int:
        """Return how many groups there are."""
        return len(self.sun)

    def at(self, places: "NDArray[np.intp]") -> "Groups":
        """Return these groups in this order."""
        return Groups(**{item.name: getattr(self, item.name)[places] for item in fields(self)})


def search(stage: Gearing) -> Groups:
    """Return all groups of one duty, ordered by pins, then sun, then planet; there may be none."""
    teeth = candidates(stage)
    kept = admitted(stage, teeth)
    sun, planet, pins = (np.asarray(each)[kept] for each in (teeth.sun, teeth.planet, teeth.pins))
    return groups_of(stage, Teeth(sun=sun, planet=planet, pins=pins))


def groups_of(stage: Gearing, teeth: Teeth) -> Groups:
    """Return ratio, torque and sizes of these tooth numbers, (groups,), whether or not they meet the conditions."""
    sun, planet, pins = (np.asarray(each, dtype=float) for each in (teeth.sun, teeth.planet, teeth.pins))
    ratio = np.asarray(ratio_of(sun, planet, pins))
    torque = np.asarray(output_torque(stage, efficiency_of(stage, sun, planet, pins)))
    centre = np.asarray(centre_distance_of(stage, sun, planet))
    low, high = pin_circle_window(stage, torque, centre)
    return Groups(
        sun=sun, planet=planet, pins=pins, ratio=ratio, deviation=ratio / stage.target_ratio - 1.0, torque=torque,
        centre_distance=centre, circle_low=np.asarray(low), circle_high=np.asarray(high),
        **vars(preference_of(stage, sun, planet, pins)),
    )  # fmt: skip


def chosen_teeth(stage: Gearing) -> Teeth:
    """Return the teeth that are rated: those stated, else those of ``stage.group`` in the search with its own duty."""
    check_ranges(stage)
    unstated = np.isnan(stage.sun_teeth)
    both = unstated == np.isnan(stage.planet_teeth)
    feasible(both, "sun_teeth and planet_teeth are stated together, or neither of them")
    alone = unstated & np.logical_not(np.isnan(stage.pin_teeth))
    feasible(np.logical_not(alone), "pin_teeth is stated without sun_teeth and planet_teeth: state all three, or bound "
             "the search by fewest_pins and most_pins")  # fmt: skip
    pins = either(stage.pin_teeth, float(stage.fewest_pins))
    feasible(np.equal(np.mod(pins, 2.0), 0.0), "pin_teeth is odd: two discs half a turn apart need an even number")
    if not np.any(unstated):
        return Teeth(sun=stage.sun_teeth, planet=stage.planet_teeth, pins=pins)
    found, counts = _of_group(stage)
    holds = np.logical_not(unstated) | (counts >= stage.group)
    for count in np.unique(np.where(holds, stage.group, counts)):
        feasible(holds | (counts != count), _too_few(stage.group, int(count)))
    return Teeth(
        sun=either(stage.sun_teeth, found.sun),
        planet=either(stage.planet_teeth, found.planet),
        pins=np.where(unstated, found.pins, pins)[()],
    )


def _too_few(group: int, count: int) -> str:
    """Say that there is no such group."""
    many = {0: "no group", 1: "one group"}.get(count, f"{count} groups")
    way = "take one of them, or state sun_teeth and planet_teeth" if count else "state sun_teeth and planet_teeth"
    return f"group = {group}, but the search finds {many}: {way}"


def candidates(stage: Gearing) -> Teeth:
    """Return every set of tooth numbers that any row of the duty could admit, in the order of the search.

    The bounds follow from the conditions: the ratio bounds planet over sun for each pin number, and the centre distance
    that a drive without mesh losses would admit bounds their sum.
    """
    check_ranges(stage)
    pins = np.arange(stage.fewest_pins, stage.most_pins + 1, 2, dtype=float)
    slack, most = stage.ratio_tolerance * (1.0 + ROUNDING), _most_teeth(stage)
    lowest = np.maximum(np.min(stage.target_ratio * (1.0 - slack)) - 1.0, 0.0) / pins
    least = np.maximum(lowest, np.min(stage.least_tooth_ratio)) * (1.0 - ROUNDING)
    largest = (np.max(stage.target_ratio * (1.0 + slack)) - 1.0) / pins * (1.0 + ROUNDING)
    suns = np.where(largest >= least, np.floor(most / (1.0 + least)) - stage.fewest_sun_teeth + 1.0, 0.0)
    place, sun = _runs(suns, float(stage.fewest_sun_teeth))
    first = np.ceil(least[place] * sun)
    last = np.minimum(np.floor(largest[place] * sun), most - sun)
    pair, planet = _runs(last - first + 1.0, first)
    return Teeth(sun=sun[pair], planet=planet, pins=pins[place[pair]])


def _most_teeth(stage: Gearing) -> float:
    """The most teeth that sun and planet together can have in any row."""
    torque = torque_of(stage.power, stage.output_speed) * stage.bearing_efficiency**3
    high = centre_distance_window(stage, torque)[1]
    return float(np.max(np.floor(high / centre_distance_of(stage, 0.5, 0.5) * (1.0 + ROUNDING))))


def _runs(counts: "Values", starts: "Values | float") -> "tuple[NDArray[np.intp], Values]":
    """Return runs of consecutive numbers one after another: which run each belongs to, and the number."""
    lengths = np.maximum(counts, 0.0)
    total = float(np.sum(lengths))
    feasible(
        total <= MOST_TRIED,
        f"the search would try {total:.3g} sets of tooth numbers: narrow ratio_tolerance, the range of pins or the "
        "window, or check power and module",
    )
    whole = lengths.astype(np.intp) if total <= MOST_TRIED else np.zeros(len(lengths), dtype=np.intp)
    run = np.repeat(np.arange(len(whole)), whole)
    before = np.cumsum(whole) - whole
    return run, np.arange(len(run)) - before[run] + np.broadcast_to(starts, whole.shape)[run]


def check_ranges(stage: Gearing) -> None:
    """State what must hold before a search makes sense."""
    for name in ("fewest_pins", "most_pins"):
        value = getattr(stage, name)
        feasible(value % 2 == 0, f"{name} = {value} is odd: two discs half a turn apart need an even number of pins")
    feasible(
        stage.fewest_pins <= stage.most_pins,
        f"fewest_pins = {stage.fewest_pins} exceeds most_pins = {stage.most_pins}",
    )
    feasible(stage.pin_circle_low <= stage.pin_circle_high, "pin_circle_low exceeds pin_circle_high")
    feasible(stage.centre_share_low <= stage.centre_share_high, "centre_share_low exceeds centre_share_high")


def admitted(stage: Gearing, teeth: Teeth) -> "NDArray[np.bool_]":
    """Return which tooth numbers meet the conditions that ``candidates`` does not already grant: (..., sets)."""
    deviation = np.abs(ratio_of(teeth.sun, teeth.planet, teeth.pins) / stage.target_ratio - 1.0)
    torque = output_torque(stage, efficiency_of(stage, teeth.sun, teeth.planet, teeth.pins))
    low, high = centre_distance_window(stage, torque)
    centre = centre_distance_of(stage, teeth.sun, teeth.planet)
    wide_enough = teeth.planet >= stage.least_tooth_ratio * teeth.sun * (1.0 - ROUNDING)
    near = deviation <= stage.ratio_tolerance * (1.0 + ROUNDING)
    inside = (centre >= low * (1.0 - ROUNDING)) & (centre <= high * (1.0 + ROUNDING))
    return np.asarray(near & wide_enough & inside)


def _of_group(stage: Gearing) -> "tuple[Teeth, NDArray[np.intp]]":
    """Return the teeth of ``stage.group`` and how many groups there are, for a number () or for each row (n,)."""
    teeth = candidates(stage)
    values = {name: np.asarray(getattr(stage, name), dtype=float) for name in SEARCHED}
    shape = np.broadcast_shapes(*(value.shape for value in values.values()))
    rows = shape[0] if shape else 1
    place, counts = np.full(rows, -1, dtype=np.intp), np.zeros(rows, dtype=np.intp)
    sets = len(np.atleast_1d(teeth.sun))
    step = max(1, MOST_AT_ONCE // max(sets, 1))
    for start in range(0, rows if sets else 0, step):
        part = slice(start, start + step)
        own: dict[str, Any] = {name: column(np.broadcast_to(value, (rows,))[part]) for name, value in values.items()}
        nth = np.cumsum(admitted(replace(stage, **own), teeth), axis=-1)
        counts[part] = nth[:, -1]
        place[part] = np.where(counts[part] >= stage.group, np.argmax(nth == stage.group, axis=-1), -1)
    sun, planet, pins = (_picked(each, place, shape) for each in (teeth.sun, teeth.planet, teeth.pins))
    return Teeth(sun=sun, planet=planet, pins=pins), counts.reshape(shape)


def _picked(values: Float, place: "NDArray[np.intp]", shape: tuple[int, ...]) -> Float:
    """The value at each place, NaN at -1; a number for a number."""
    picked = np.append(np.asarray(values, dtype=float), np.nan)[place].reshape(shape)
    return picked if shape else float(picked)
