"""The duty of the drive, and the search for tooth numbers that meet it.

What the drive must do; which groups are better; every sun, planet and pin number that meets the five conditions of the
paper; and the study that shows them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from rv_gearing import choice
from rv_gearing.quantities import Gearing
from truing import (
    Array,
    Bench,
    Float,
    Outcome,
    Table,
    TruingError,
    column,
    either,
    feasible,
    found,
    results,
    rows,
)

# What the drive must do: ratio, efficiency, torque, and the sizes of pin circle and centre distance they ask for
#
# Equations 1 to 8 of the paper. Everything takes numbers or arrays that broadcast, SI, and returns the same. Torques of
# the search are those at the output.

POWER_TO_TORQUE = 9550.0 / 60000.0  # N m of a watt at one turn per second, as rounded by the paper; 1/(2 pi) to 7e-5


def torque_of(power: Float, speed: Float) -> Float:
    """Return the torque, N m, of a power (W) at a speed (turns per second), with the paper's 9550."""
    return POWER_TO_TORQUE * power / speed


def ratio_of(sun: Float, planet: Float, pins: Float) -> Float:
    """Return input turns over output turns, equation 1: output by the carrier, one tooth fewer on the disc than pins.

    The product of planet and pins comes first, so that a ratio that is a whole number is one exactly.
    """
    return 1.0 + planet * pins / sun


def mesh_efficiency(stage: Gearing, tooth_ratio: Float, pins: Float) -> Float:
    """Return the efficiency of both meshes, eta_16 of equation 8, for planet teeth over sun teeth and a pin number.

    It is the ratio with a lossy mesh over the ratio without, i~/i; with both mesh efficiencies at 1 it is 1.
    """
    k = pins / (pins - 1.0)
    sharing = tooth_ratio * k
    lossy = k - stage.cycloid_efficiency
    return (k - 1.0) * (lossy + sharing * stage.involute_efficiency) / (lossy * (k - 1.0 + sharing))


def efficiency_of(stage: Gearing, sun: Float, planet: Float, pins: Float) -> Float:
    """Return the efficiency from input to output, equations 6 and 7: both meshes and three bearings."""
    return mesh_efficiency(stage, planet / sun, pins) * stage.bearing_efficiency**3


def output_torque(stage: Gearing, efficiency: Float) -> Float:
    """Return the torque at the output, N m, that the power gives at the output speed."""
    return torque_of(stage.power, stage.output_speed) * efficiency


def pin_circle_factors(stage: Gearing) -> tuple[Float, Float]:
    """Return the least and the largest factor of the pin circle in force: one and the same for one pin circle."""
    high = stage.pin_circle_low if stage.window == "one_pin_circle" else stage.pin_circle_high
    return stage.pin_circle_low, high


def centre_distance_of(stage: Gearing, sun: Float, planet: Float) -> Float:
    """Return the centre distance of the reference circles, m; profile shifts come on top of it."""
    return 0.5 * stage.module * (sun + planet) / np.cos(stage.helix_angle)


def centre_distance_window(stage: Gearing, torque: Float) -> tuple[Float, Float]:
    """Return the least and the largest centre distance, m, that pin circles for this output torque admit."""
    low, high = pin_circle_factors(stage)
    size = np.cbrt(torque)
    return stage.centre_share_low * low * size, stage.centre_share_high * high * size


def pin_circle_window(stage: Gearing, torque: Float, centre_distance: Float) -> tuple[Float, Float]:
    """Return the least and the largest radius of the pin circle, m, for this torque and this centre distance.

    The first exceeds the second where there is none.
    """
    low, high = pin_circle_factors(stage)
    size = np.cbrt(torque)
    return (
        np.maximum(centre_distance / stage.centre_share_high, low * size),
        np.minimum(centre_distance / stage.centre_share_low, high * size),
    )


# Which groups are better: which teeth meet, how many kinds of planet a stage needs, and whether its planets share
#
# The paper calls some of its groups better "for accuracy of transmission and distribution of load", and gives no rule.
# Read here: hunting teeth spread every error over every tooth, and planets that mesh in phase carry alike at any
# moment. Derived on the theory page. A value is an array (groups,), numbers of teeth are whole.


HUNTING_IN_PHASE, HUNTING, IN_PHASE, NEITHER = 1.0, 2.0, 3.0, 4.0


def preference_of(stage: Gearing, sun: "Array", planet: "Array", pins: "Array") -> "dict[str, Array]":
    """Return what speaks for each group, by its columns; the preference is NaN where neighbouring planets would touch.

    Common factors of both meshes, kinds of planet, phases in which they mesh, and the preference: 1 is best.
    """
    planets = stage.planets
    first, second = np.gcd(_whole(sun), _whole(planet)), np.gcd(_whole(pins) - 1, _whole(pins))
    kinds = planets // np.gcd(_whole(sun + planet), planets)
    phases = planets // np.gcd(_whole(sun), planets)
    found = np.where(
        (first == 1) & (second == 1),
        np.where(phases == 1, HUNTING_IN_PHASE, HUNTING),
        np.where(phases == 1, IN_PHASE, NEITHER),
    )
    counts = {"common_first": first, "common_second": second, "planet_kinds": kinds, "mesh_phases": phases}
    preference = np.where(_touching(stage, sun, planet), np.nan, found)
    return {name: count.astype(float) for name, count in counts.items()} | {"preference": preference}


def _whole(teeth: "Array") -> "NDArray[np.int64]":
    return np.rint(teeth).astype(np.int64)


def _touching(stage: Gearing, sun: "Array", planet: "Array") -> "NDArray[np.bool_]":
    """Where the tip circles of two neighbouring planets of one plane meet, without regard to backlash."""
    if stage.planets == 1:
        return np.zeros(len(sun), dtype=bool)
    apart = (sun + planet) / np.cos(stage.helix_angle) * np.sin(np.pi / stage.planets)  # in modules
    tip = planet / np.cos(stage.helix_angle) + 2.0 * (stage.addendum + stage.planet.shift)
    return np.asarray(apart <= tip)


def reason_of(common: float, phases: float, kinds: float, preference: float) -> str:
    """Say why a group has its preference."""
    teeth = "hunting teeth" if common == 1 else f"a tooth meets only one in {common:.0f} of the other gear"
    shares = "planets in phase" if phases == 1 else f"planets in {phases:.0f} phases"
    alike = "and alike" if kinds == 1 else f"and of {kinds:.0f} kinds"
    if np.isnan(preference):
        return "neighbouring planets would touch"
    return f"{'better: ' if preference == HUNTING_IN_PHASE else ''}{teeth}; {shares} {alike}"


# The search for tooth numbers: every sun, planet and pin number that meets the five conditions of the paper
#
# The conditions: one tooth fewer on the disc than pins (in the ratio itself), an even number of pins so that two discs
# half a turn apart share one ring of them, ratio within its tolerance, sun of at least ``fewest_sun_teeth`` and planet
# of at least ``least_tooth_ratio`` times as many, centre distance within the window that the output torque admits.

ROUNDING = 1e-12  # a limit that is met exactly is met
MOST_TRIED = 4_000_000  # sets of tooth numbers in one search
MOST_AT_ONCE = 1_000_000  # rows times sets in one array
SEARCHED = (
    "power", "output_speed", "target_ratio", "ratio_tolerance", "module", "helix_angle", "least_tooth_ratio",
    "involute_efficiency", "cycloid_efficiency", "bearing_efficiency", "pin_circle_low", "pin_circle_high",
    "centre_share_low", "centre_share_high",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ToothNumbers:
    """Tooth numbers of one drive or of a batch: sun, planet, pins."""

    sun: Float
    planet: Float
    pins: Float


@dataclass(frozen=True, kw_only=True)
class Groups:
    """Everything the search tells of the groups it finds, each (groups,), SI."""

    sun: "Array"
    planet: "Array"
    pins: "Array"
    ratio: "Array"
    deviation: "Array"  # of the ratio, relative, with its sign
    torque: "Array"
    centre_distance: "Array"
    circle_low: "Array"
    circle_high: "Array"
    common_first: "Array"  # largest common factor of sun and planet, and of disc and pins
    common_second: "Array"
    planet_kinds: "Array"
    mesh_phases: "Array"
    preference: "Array"  # 1 is best

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
    return groups_of(stage, ToothNumbers(sun=sun, planet=planet, pins=pins))


def groups_of(stage: Gearing, teeth: ToothNumbers) -> Groups:
    """Return ratio, torque and sizes of these tooth numbers, (groups,), whether or not they meet the conditions."""
    sun, planet, pins = (np.asarray(each, dtype=float) for each in (teeth.sun, teeth.planet, teeth.pins))
    ratio = np.asarray(ratio_of(sun, planet, pins))
    torque = np.asarray(output_torque(stage, efficiency_of(stage, sun, planet, pins)))
    centre = np.asarray(centre_distance_of(stage, sun, planet))
    low, high = pin_circle_window(stage, torque, centre)
    return Groups(
        sun=sun, planet=planet, pins=pins, ratio=ratio, deviation=ratio / stage.target_ratio - 1.0, torque=torque,
        centre_distance=centre, circle_low=np.asarray(low), circle_high=np.asarray(high),
        **preference_of(stage, sun, planet, pins),
    )  # fmt: skip


def chosen_teeth(stage: Gearing) -> ToothNumbers:
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
        return ToothNumbers(sun=stage.sun_teeth, planet=stage.planet_teeth, pins=pins)
    found, counts = _of_group(stage)
    holds = np.logical_not(unstated) | (counts >= stage.group)
    for count in np.unique(np.where(holds, stage.group, counts)):
        feasible(holds | (counts != count), _too_few(stage.group, int(count)))
    return ToothNumbers(
        sun=either(stage.sun_teeth, found.sun),
        planet=either(stage.planet_teeth, found.planet),
        pins=np.where(unstated, found.pins, pins)[()],
    )


def _too_few(group: int, count: int) -> str:
    """Say that there is no such group."""
    many = {0: "no group", 1: "one group"}.get(count, f"{count} groups")
    way = "take one of them, or state sun_teeth and planet_teeth" if count else "state sun_teeth and planet_teeth"
    return f"group = {group}, but the search finds {many}: {way}"


def candidates(stage: Gearing) -> ToothNumbers:
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
    return ToothNumbers(sun=sun[pair], planet=planet, pins=pins[place[pair]])


def _most_teeth(stage: Gearing) -> float:
    """The most teeth that sun and planet together can have in any row."""
    torque = torque_of(stage.power, stage.output_speed) * stage.bearing_efficiency**3
    high = centre_distance_window(stage, torque)[1]
    return float(np.max(np.floor(high / centre_distance_of(stage, 0.5, 0.5) * (1.0 + ROUNDING))))


def _runs(counts: "Array", starts: "Array | float") -> "tuple[NDArray[np.intp], Array]":
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
        stage.fewest_pins <= stage.most_pins, f"fewest_pins = {stage.fewest_pins} exceeds most_pins = {stage.most_pins}"
    )
    feasible(stage.pin_circle_low <= stage.pin_circle_high, "pin_circle_low exceeds pin_circle_high")
    feasible(stage.centre_share_low <= stage.centre_share_high, "centre_share_low exceeds centre_share_high")


def admitted(stage: Gearing, teeth: ToothNumbers) -> "NDArray[np.bool_]":
    """Return which tooth numbers meet the conditions that ``candidates`` does not already grant: (..., sets)."""
    deviation = np.abs(ratio_of(teeth.sun, teeth.planet, teeth.pins) / stage.target_ratio - 1.0)
    torque = output_torque(stage, efficiency_of(stage, teeth.sun, teeth.planet, teeth.pins))
    low, high = centre_distance_window(stage, torque)
    centre = centre_distance_of(stage, teeth.sun, teeth.planet)
    wide_enough = teeth.planet >= stage.least_tooth_ratio * teeth.sun * (1.0 - ROUNDING)
    near = deviation <= stage.ratio_tolerance * (1.0 + ROUNDING)
    inside = (centre >= low * (1.0 - ROUNDING)) & (centre <= high * (1.0 + ROUNDING))
    return np.asarray(near & wide_enough & inside)


def _of_group(stage: Gearing) -> "tuple[ToothNumbers, NDArray[np.intp]]":
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
    return ToothNumbers(sun=sun, planet=planet, pins=pins), counts.reshape(shape)


def _picked(values: Float, place: "NDArray[np.intp]", shape: tuple[int, ...]) -> Float:
    """The value at each place, NaN at -1; a number for a number."""
    picked = np.append(np.asarray(values, dtype=float), np.nan)[place].reshape(shape)
    return picked if shape else float(picked)


# A study of our own: all groups of tooth numbers that meet the five conditions, sorted as wished, with strength

GroupColumn = Literal[
    "group", "sun", "planet", "pins", "ratio", "deviation", "torque", "centre_distance", "circle_low", "circle_high",
    "common_first", "common_second", "planet_kinds", "mesh_phases", "preference", "root_stress_sun",
    "root_stress_planet", "contact_stress_sun", "contact_stress_planet", "root_safety_sun", "root_safety_planet",
    "contact_safety_sun", "contact_safety_planet", "efficiency", "reserve", "from_best",
]  # fmt: skip
COLUMNS: tuple[GroupColumn, ...] = get_args(GroupColumn)
SIZES, MEETING, STRENGTH, CHOICE = COLUMNS[1:10], COLUMNS[10:15], COLUMNS[15:23], COLUMNS[23:]
CRITERIA: tuple[GroupColumn, ...] = ("deviation", "reserve", "centre_distance", "efficiency", "common_first")
PERMITTED = tuple(f"permitted_{name}" for name in STRENGTH if "stress" in name)
PRINTED = {"deviation": ("%", 100.0), "torque": ("N*m", 1.0), "efficiency": ("%", 100.0)} | dict.fromkeys(
    ("centre_distance", "circle_low", "circle_high"), ("mm", 1e3)
)
EXACT = 1e-12
SCATTER = 0.004  # of the efficiency of a bearing: four standard deviations of its tolerance
CONDITIONS = "meets all five conditions of section 2 of the paper"


def listing(symbol: str, note: str, unit: str = "", source: str = "") -> Any:
    """Declare a column of the list."""
    return found(unit, symbol=symbol, along="group_number", note=note, source=source)


@results
class Listed:
    """The groups as a table, in the order asked for."""

    group_count: Float = found("", symbol="N", note="groups of tooth numbers", method=CONDITIONS)
    exact_count: Float = found("", symbol="N_0", note="of them with just the wanted ratio", method="counted")
    group_number: Float = rows("number of the group")
    group_sun_teeth: Float = listing("Z_1", "teeth of the sun")
    group_planet_teeth: Float = listing("Z_2", "teeth of the planet")
    group_pins: Float = listing("Z_5", "pins")
    group_ratio: Float = listing("i", "ratio", source="equation 1")
    group_deviation: Float = listing("Delta i", "deviation of the ratio", "%", "equation 2")
    group_torque: Float = listing("T", "output torque", "N*m", "equation 5")
    group_centre_distance: Float = listing("a_0", "centre distance", "mm")
    group_circle_low: Float = listing("R_p,min", "least radius of the pin circle", "mm", "equations 3 and 4")
    group_circle_high: Float = listing("R_p,max", "largest radius of the pin circle", "mm", "equations 3 and 4")
    group_common_first: Float = listing("g_1", "largest common factor of the teeth of sun and planet; 1: hunting teeth")
    group_common_second: Float = listing("g_2", "largest common factor of the teeth of a disc and the pins")
    group_planet_kinds: Float = listing(
        "n_k", "kinds of planet, by the angle between crank and teeth, for equal spacing; 1: all alike"
    )
    group_mesh_phases: Float = listing("n_f", "phases in which the planets mesh; 1: all carry alike at any moment")
    group_preference: Float = listing(
        "r", "1: hunting teeth and planets in phase, better; 2: hunting teeth; 3: planets in phase; 4: neither; none: "
        "planets touch"
    )  # fmt: skip
    group_root_stress_sun: Float = listing("sigma_F1", "root stress of the sun", "MPa")
    group_root_stress_planet: Float = listing("sigma_F2", "root stress of the planet", "MPa")
    group_contact_stress_sun: Float = listing("sigma_H1", "contact stress of the sun", "MPa")
    group_contact_stress_planet: Float = listing("sigma_H2", "contact stress of the planet", "MPa")
    group_root_safety_sun: Float = listing("S_F1", "safety of the sun, breakage")
    group_root_safety_planet: Float = listing("S_F2", "safety of the planet, breakage")
    group_contact_safety_sun: Float = listing("S_H1", "safety of the sun, pitting")
    group_contact_safety_planet: Float = listing("S_H2", "safety of the planet, pitting")
    group_efficiency: Float = listing("eta", "efficiency, input to output", "%", "equations 6 and 7")
    group_reserve: Float = listing("S_r", "least of all four safeties over what is asked of it")
    group_from_best: Float = listing(
        "d_0", "distance from the best of all criteria at once; none where another group beats this one"
    )


@dataclass(frozen=True, kw_only=True)
class GroupSearch:
    """List all groups, sorted by one column; ``exact_only`` keeps those with just the wanted ratio.

    ``criteria`` are columns; which groups no other beats in all of them is marked, see ``choice``.
    """

    sort_by: GroupColumn = "group"
    descending: bool = False
    exact_only: bool = False
    criteria: Sequence[GroupColumn] = CRITERIA
    name: str = "search"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if self.sort_by not in COLUMNS:
            raise TruingError(f"study '{self.name}': the groups have no column '{self.sort_by}'")
        wrong = [name for name in self.criteria if name not in COLUMNS or name in ("group", "from_best")]
        if wrong or not self.criteria:
            told = ", ".join(f"'{name}'" for name in wrong) or "nothing"
            raise TruingError(f"study '{self.name}': criteria are columns of the groups, but {told} was asked for")

    def run(self, bench: "Bench") -> "FoundGroups":
        """Search with the duty of the inputs, and rate every group in one call."""
        stage: Gearing = bench.inputs
        groups = search(stage)
        numbers = np.arange(1.0, len(groups) + 1.0)
        exact = np.abs(groups.deviation) <= EXACT
        kept = np.flatnonzero(exact) if self.exact_only else np.arange(len(groups))
        shown = FoundGroups(
            name=self.name,
            inputs=stage,
            count=len(groups),
            exact=int(np.sum(exact)),
            groups=groups.at(kept),
            numbers=numbers[kept],
            strength=_strength(bench, groups.at(kept)),
            rated=_rated(stage, groups),
            stable=_stable(stage, groups),
            sort_by=self.sort_by,
            descending=self.descending,
            criteria=tuple(self.criteria),
        )
        return shown.sorted()


def _strength(bench: "Bench", groups: Groups) -> dict[str, "Array"]:
    """Stresses and safeties of every group under the load of the inputs; NaN where a group cannot be rated."""
    asked = (*STRENGTH, *PERMITTED)
    known = [name for name in asked if name in bench.setup.model.own_result_fields]
    columns = {"sun_teeth": groups.sun, "planet_teeth": groups.planet, "pin_teeth": groups.pins}
    answers = bench.rows(columns, len(groups), *known) if len(groups) else {}
    return {name: np.asarray(answers.get(name, np.full(len(groups), np.nan))) for name in asked}


def _rated(stage: Gearing, groups: Groups) -> int | None:
    """The number of the group that is rated, None where its teeth are stated and in none."""
    teeth = chosen_teeth(stage)
    same = (groups.sun == teeth.sun) & (groups.planet == teeth.planet) & (groups.pins == teeth.pins)
    return int(np.argmax(same)) + 1 if np.any(same) else None


def _stable(stage: Gearing, groups: Groups) -> bool:
    """Whether the number of the rated group stays with that group while the efficiency scatters a little."""
    if not np.isnan(stage.sun_teeth):
        return True
    own = [each[: stage.group] for each in (groups.sun, groups.planet, groups.pins)]
    for factor in (1.0 - SCATTER, 1.0 + SCATTER):
        other = search(replace(stage, bearing_efficiency=np.minimum(stage.bearing_efficiency * factor, 1.0)))
        others = (other.sun, other.planet, other.pins)
        if not all(np.array_equal(one, two[: stage.group]) for one, two in zip(own, others, strict=True)):
            return False
    return True


@dataclass(frozen=True, kw_only=True)
class FoundGroups(Outcome):
    """Groups with their numbers and strength, (groups,) in SI; how many there are in all; which is rated.

    ``stable`` says that the rated number keeps its teeth while the efficiency of the bearings scatters.
    """

    name: str
    inputs: Gearing
    count: int
    exact: int
    groups: Groups
    numbers: "Array"
    strength: Mapping[str, "Array"]
    rated: int | None
    stable: bool
    sort_by: GroupColumn
    descending: bool
    criteria: tuple[GroupColumn, ...] = CRITERIA

    def column(self, name: GroupColumn) -> "Array":
        """Return one column, SI."""
        if name == "group":
            return self.numbers
        if name in CHOICE:
            return self._chosen(name)
        return self.strength[name] if name in self.strength else np.asarray(getattr(self.groups, name))

    def _chosen(self, name: GroupColumn) -> "Array":
        """Return a column that tells of choosing a group."""
        groups = self.groups
        if name == "efficiency":
            return np.asarray(efficiency_of(self.inputs, groups.sun, groups.planet, groups.pins))
        if name == "reserve":
            asked = {"root": self.inputs.least_bending_safety, "contact": self.inputs.least_contact_safety}
            safeties = [self.strength[each] / asked[each.split("_")[0]] for each in STRENGTH if "safety" in each]
            return np.asarray(np.min(np.stack(safeties), axis=0))
        wanted = [choice.costs(each, self.column(each)) for each in self.criteria]
        return choice.distance_to_best(wanted, choice.unbeaten(wanted))

    def sorted(self) -> "FoundGroups":
        """Return the same in the order that was asked for; a deviation counts by its size, NaN comes last."""
        key = self.column(self.sort_by)
        key = np.abs(key) if self.sort_by == "deviation" else key
        order = np.argsort(-key if self.descending else key, kind="stable")
        return replace(
            self,
            groups=self.groups.at(order),
            numbers=self.numbers[order],
            strength={name: values[order] for name, values in self.strength.items()},
        )

    def as_json(self) -> Mapping[str, Any]:
        """Return counts, the rated group and every column in its printed unit; null where there is no answer."""
        columns = {}
        for name in COLUMNS:
            unit, factor = printed_in(name)
            values = [float(value) * factor if np.isfinite(value) else None for value in self.column(name)]
            columns[name] = {"unit": unit, "values": values}
        return {
            "count": self.count,
            "exact": self.exact,
            "rated": self.rated,
            "sort_by": self.sort_by,
            "descending": self.descending,
            "criteria": list(self.criteria),
            "groups": columns,
            "reasons": self.reasons(),
        }

    def reasons(self) -> list[str]:
        """Say of every group why it has its preference."""
        told = ("common_first", "mesh_phases", "planet_kinds", "preference")
        asked = zip(*(getattr(self.groups, name) for name in told), strict=True)
        return [reason_of(*map(float, values)) for values in asked]

    def warnings(self) -> Sequence[str]:
        """Say that there is no group, or that none is the one that is rated."""
        if not self.count:
            return [f"study '{self.name}': no group of tooth numbers meets all conditions"]
        if self.rated is None:
            return [
                f"study '{self.name}': the stated teeth are none of the {self.count} groups that meet all conditions"
            ]
        if not self.stable:
            return [
                f"study '{self.name}': a group lies so near the edge of the window that number {self.rated} is another "
                "one with a slightly different efficiency; state sun_teeth, planet_teeth and pin_teeth instead"
            ]
        return ()


def printed_in(name: str) -> tuple[str, float]:
    """The unit a column is printed in, and the factor from SI to it."""
    return ("MPa", 1e-6) if "stress" in name else PRINTED.get(name, ("", 1.0))


def listed(found: FoundGroups) -> Listed:
    """The table as results of the run."""
    names: dict[str, GroupColumn] = {"group_sun_teeth": "sun", "group_planet_teeth": "planet"}
    columns = {f"group_{name}": found.column(name) for name in (*SIZES[2:], *MEETING, *STRENGTH, *CHOICE)}
    return Listed(
        group_count=float(found.count),
        exact_count=float(found.exact),
        group_number=found.numbers,
        **{name: found.column(column) for name, column in names.items()},
        **columns,
    )


# Ratios of a reducer of this size in its maker's catalogue, and teeth that give all of them at one centre distance
#
# The catalogue prints ratios and no teeth. With 40 pins and sun and planet of 75 teeth together all five come out.

PINS = 40
RATIOS = ((81.0, 25, 50), (111.0, 20, 55), (127.7, 18, 57), (161.0, 15, 60), (175.2, 14, 61))  # printed, sun, planet
MODULE = 1.25e-3  # m, of the paper
TORQUE = 1078.0  # N m, of the catalogue at 15 turns per minute


def catalogue_table(stage: Gearing) -> Table:
    """Return the ratios of the catalogue beside those of the teeth, and their centre distance with this module."""
    rows = []
    for printed, sun, planet in RATIOS:
        ratio = float(ratio_of(sun, planet, PINS))
        centre = 1e3 * float(centre_distance_of(stage, sun, planet))
        rows.append((printed, sun, planet, PINS, ratio, round(100.0 * (ratio / printed - 1.0), 3), centre))
    return Table(
        "Ratios of the RV-110E in the catalogue of its maker",
        ("catalogue", "sun", "planet", "pins", "ratio", "deviation", "centre distance"),
        rows,
        ("", "", "", "", "", "%", "mm"),
        "Shaft rotation. The catalogue prints no teeth; these are inferred: of all sums of sun and planet up to 100, "
        "75 alone gives all five ratios with 40 pins. Suns of 14 and 15 teeth need profile shift, which the rule of at "
        "least 17 teeth does not know.",
    )
