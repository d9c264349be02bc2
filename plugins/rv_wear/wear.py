"""Wear of the flank, step by step, for many meshes at once, and the largest wear after the working time."""

from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from threading import Lock
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from rv_wear import geometry
from rv_wear.forces import Loads, holding, refuse, shared, start_scale
from rv_wear.geometry import Choices, Mesh, Teeth, columns_of, mesh_of, some_of, some_pins, teeth_of
from rv_wear.quantities import Reducer
from truing import Array, Float, either, feasible

# The wear coefficient of lubricated steel rollers, and what stretches the time of wear; strictly SI
#
# Source: Janakiraman, Li and Kahraman, Journal of Tribology 136(3), 031602, 2014: k E' / 3.981e29 = L^1.219 G^-7.377
# S_q^1.589 with L = W' / (E' R'), G = alpha E', S_q = R_q / R'. As load, oil and roughness stand in it as powers, oil,
# roughness, speed and time only stretch the time of a history: depth = H(exposure).

CONSTANT = 3.981e29
LOAD, VISCOSITY, ROUGHNESS = 1.219, -7.377, 1.589


def lubricant_part(modulus: Float, pressure_viscosity: Float, roughness: Float) -> Float:
    """What oil and surfaces do to the coefficient: 3.981e29 / E' G^-7.377 R_q^1.589, in m^1.589/Pa."""
    return CONSTANT / modulus * (pressure_viscosity * modulus) ** VISCOSITY * roughness**ROUGHNESS


def contact_part(modulus: Float, line_load: Float, relative_radius: Float) -> Float:
    """What force and radius do to the coefficient: L^1.219 R'^-1.589, in m^-1.589."""
    return (line_load / (modulus * relative_radius)) ** LOAD * relative_radius**-ROUGHNESS


def unworn_share(film_ratio: Float) -> Float:
    """Share of the wear that a film leaves: 1 below Lambda 0.5, 0 above 3."""
    return np.minimum(np.maximum((3.0 - film_ratio) / 2.5, 0.0), 1.0)


def film_number(mesh: Mesh, speed: Float, relative_radius: Float) -> Float:
    """Film ratio Lambda but for its load: Lambda = number W^-0.13 with W = F / (B E' R').

    Dowson and Higginson's least film 2.65 R' U^0.7 G^0.54 W^-0.13 over the roughness; *speed* is the mean speed of the
    two surfaces against the contact, m/s.
    """
    modulus = mesh.equivalent_modulus
    drive = (mesh.film_viscosity * speed / (modulus * relative_radius)) ** 0.7
    oil = (mesh.film_pressure_viscosity * modulus) ** 0.54
    return mesh.film_factor * 2.65 * relative_radius * drive * oil / mesh.film_roughness


# Wear of the flank, step by step: forces, wear, new profile, new forces; equations 13 to 16 for all meshes at once
#
# A history is told over the *exposure* x: number of meshings times everything that multiplies the wear coefficient at
# every contact alike (oil, roughness, factors). A step ends where the fastest point has lost the threshold depth, so
# its steps are the same whoever asks and however far; between two of them wear grows in proportion to the exposure,
# which is exactly the paper's shortened last step. The largest wear is taken from the flank as it is within the step:
# where another point overtakes within it, the history has a node at the crossing.

MOST_STEPS = 4000
SLIGHT = 1e-6  # N; a smaller force does not wear
NEVER = 1e200  # exposure of a step in which nothing wears

Rate = Callable[[Array], Array]
WearNode = tuple[Array, Array, Array]


@dataclass(frozen=True)
class WearState:
    """The disc at the beginning of a step: exposure (m,), wear and its growth (pins, phases, m), how long it lasts.

    ``lasts`` is an exposure (m,), ``grown`` and ``after`` what wears in the step and what is worn at its end. Pins that
    bear nothing and have not worn are left out at both ends: the first one told of is number ``pin``.
    """

    pin: int
    loads: Loads
    exposure: Array
    wear: Array
    rate: Array
    lasts: Array
    grown: Array
    after: Array


@dataclass(frozen=True)
class Histories:
    """Nodes (n, m) of exposure and largest wear, and the phase angle of the deepest point up to each node."""

    exposure: Array
    depth: Array
    angle: Array


def growth(teeth: Teeth, unworn: Loads) -> Rate:
    """Return the function that gives the growth of wear per exposure from the pin forces, equation 13."""
    mesh = teeth.mesh
    modulus = np.asarray(mesh.equivalent_modulus)
    by_load = np.asarray(geometry.sliding_ratio(mesh, teeth.angle)) / mesh.width
    if mesh.choices.wear_coefficient == "pitch_point":
        factor = _at_pitch_point(teeth, unworn) * by_load
        return lambda force: factor * force
    by_load = by_load * contact_part(modulus, 1.0 / mesh.width, teeth.relative_radius)
    if not mesh.choices.has_film:
        return _power_law(by_load, 1.0 + LOAD, None)
    turning = 2.0 * np.pi * mesh.film_speed
    carried = geometry.rolling_speed(mesh, teeth.angle) - 0.5 * geometry.sliding_speed(mesh, teeth.angle)
    number = film_number(mesh, np.abs(carried) * turning, teeth.relative_radius)
    return _power_law(by_load, 1.0 + LOAD, number * (mesh.width * modulus * teeth.relative_radius) ** 0.13)


def _power_law(factor: Array, power: float, film: Float | None) -> Rate:
    """Factor times force to a power, 0 for a force of 0, less where a film carries; ``film`` is Lambda at 1 N.

    A logarithm and an exponential are quicker than a power where numpy has them as vectors, and as quick elsewhere;
    of 0 a power takes three times as long.
    """
    slight = np.full_like(factor, SLIGHT)
    least = np.exp(power * np.log(slight.reshape(-1)[:8]))[0]

    def rate_of(force: Array) -> Array:
        reached = np.maximum(force, slight)
        np.log(reached, out=reached)
        rate: Array = power * reached
        np.exp(rate, out=rate)
        rate -= least
        rate *= factor
        if film is not None:
            rate *= unworn_share(film * np.exp(-0.13 * reached))
        return rate

    return rate_of


def _at_pitch_point(teeth: Teeth, unworn: Loads) -> Array:
    """What force and radius do to the coefficient at the longest arm, where the unworn force is largest; (m,)."""
    mesh = teeth.mesh
    radius = geometry.relative_radius(mesh, geometry.longest_arm_angle(mesh))
    line_load = unworn.scale.max(axis=0) / mesh.width
    return np.asarray(contact_part(mesh.equivalent_modulus, line_load, radius))


def states(teeth: Teeth) -> Iterator[WearState]:
    """The disc at the beginning of every step, without end. Only pins that bear are calculated, as they become more."""
    whole = shared(teeth, teeth.slack, start_scale(teeth))
    rows = _bearing(teeth, whole, slice(len(teeth.slack), 0))
    part, rest = some_pins(teeth, rows), _slack_beside(teeth, rows)
    loads = replace(whole, force=whole.force[rows])
    rate_of = growth(part, whole)
    wear, exposure, last = np.zeros_like(part.slack), np.zeros(teeth.count), whole.scale
    while True:
        rate = rate_of(loads.force)
        lasts = _lasts(part, rate)
        grown = rate * lasts
        after = wear + grown
        yield WearState(rows.start, loads, exposure, wear, rate, lasts, grown, after)
        wear = after
        exposure = exposure + lasts
        guess, last = np.maximum(2.0 * loads.scale - last, 0.5 * loads.scale), loads.scale
        loads = shared(part, _slack(part, wear), guess)
        if (loads.approach + loads.taken > rest).any():
            full = _padded(wear, rows, len(teeth.slack))
            loads = shared(teeth, _slack(teeth, full), guess)
            rows = _bearing(teeth, loads, rows)
            part, rest = some_pins(teeth, rows), _slack_beside(teeth, rows)
            rate_of, wear = growth(part, whole), full[rows]
            loads = replace(loads, force=loads.force[rows])


def _bearing(teeth: Teeth, loads: Loads, rows: slice) -> slice:
    """The pins that bear in some mesh and position, one more at either end, and those of ``rows``."""
    bears = np.flatnonzero(loads.force.any(axis=(1, 2)))
    first, last = (int(bears[0]), int(bears[-1])) if len(bears) else (0, len(teeth.slack) - 1)
    return slice(min(max(first - 1, 0), rows.start), max(min(last + 2, len(teeth.slack)), rows.stop))


def _slack_beside(teeth: Teeth, rows: slice) -> Array:
    """Least slack (phases, m) of the pins beside these, which have not worn."""
    beside = np.concatenate([teeth.slack[: rows.start], teeth.slack[rows.stop :]])
    return np.asarray(beside.min(axis=0, initial=np.inf))


def _padded(wear: Array, rows: slice, pins: int) -> Array:
    """The wear of these pins among all of them."""
    return np.pad(wear, ((rows.start, pins - rows.stop), (0, 0), (0, 0)))


def _slack(teeth: Teeth, wear: Array) -> Array:
    slack = wear * teeth.per_arm
    slack += teeth.slack
    return slack


def _lasts(teeth: Teeth, rate: Array) -> Array:
    fastest = rate.max(axis=(0, 1))
    return np.where(fastest > 0.0, teeth.mesh.threshold / np.maximum(fastest, 1.0 / NEVER), NEVER)


def nodes_of(teeth: Teeth) -> Iterator[WearNode]:
    """Exposure (m,), largest wear and phase angle of its place: of the new disc, then twice in every step."""
    angle, phases = teeth.angle.reshape(-1), teeth.slack.shape[1]
    deepest: NDArray[np.intp] | None = None
    for state in islice(states(teeth), MOST_STEPS):
        if deepest is None:
            deepest = _flat(state.rate).argmax(axis=0) + state.pin * phases
            yield state.exposure, np.zeros(teeth.count), angle[deepest]
        deepest, added = _step(state, deepest, angle)
        yield from added


def _flat(values: Array) -> Array:
    return values.reshape(-1, values.shape[-1])


def _step(state: WearState, leader: NDArray[np.intp], angle: Array) -> tuple[NDArray[np.intp], list[WearNode]]:
    """The deepest point after a step, and the nodes where it is overtaken (else half way) and at the end of the step.

    Points are counted over all pins and positions.
    """
    before, grown, after = _flat(state.wear), _flat(state.grown), _flat(state.after)
    meshes, left_out = np.arange(len(state.lasts)), state.pin * state.wear.shape[1]
    leader = leader - left_out
    start, lead, top = before[leader, meshes], grown[leader, meshes], after.max(axis=0)
    part, new = np.full(len(meshes), 0.5), leader
    passed = np.flatnonzero(after[leader, meshes] < top)
    if len(passed):
        new = leader.copy()
        new[passed] = after[:, passed].argmax(axis=0)
        behind = start[passed] - before[new[passed], passed]
        share = behind / (grown[new[passed], passed] - lead[passed])
        part[passed] = np.minimum(np.maximum(share, 0.0), 1.0)
    middle = (state.exposure + part * state.lasts, start + part * lead, angle[left_out + leader])
    return left_out + new, [middle, (state.exposure + state.lasts, top, angle[left_out + new])]


def wear_at(teeth: Teeth, exposure: Array) -> Array:
    """Wear of the whole flank (pins, phases, m) at an exposure (m,) each, with the shortened last step of the paper."""
    found = np.zeros_like(teeth.slack)
    for count, state in enumerate(states(teeth), 1):
        left = exposure - state.exposure
        within = (left >= 0.0) & ((left < state.lasts) | (count == MOST_STEPS))
        if within.any():
            pins = slice(state.pin, state.pin + len(state.wear))
            found[pins] = np.where(within, state.wear + state.rate * left, found[pins])
        if np.all(exposure < state.exposure + state.lasts) or count == MOST_STEPS:
            break
    return found


# Forces and histories of many meshes, which each are calculated once; those of the latest groups are remembered

CHUNK = 256  # meshes at a time: their contacts stay in the cache of a core
FEW_ROWS = 20  # of a mesh: looked up one by one they take longer
MOST_REMEMBERED = 4096  # meshes: a fit and a search come back to the same ones
NEW = -1

Answer = TypeVar("Answer")
MeshKey = tuple[bytes, Choices]
"""A mesh as something to remember an answer by: its numbers as bytes, and its choices."""


@dataclass(frozen=True)
class Unworn:
    """The new mesh: forces (N), approach (m), pressure (Pa), contact part of the wear coefficient; one per mesh (m,).

    ``first_step`` is the exposure until the first reconstruction, ``lowest_equidistant`` the bound of equation 17.
    """

    scale: Array
    approach: Array
    largest_force: Array
    loaded_pins: Array
    pressure: Array
    contact_part: Array
    lowest_equidistant: Array
    first_step: Array


def unworn(mesh: Mesh) -> Unworn:
    """Solve the new meshes (m,) at every position of the disc."""
    teeth = teeth_of(mesh)
    loads = shared(teeth, teeth.slack, start_scale(teeth))
    force = loads.force.reshape(-1, teeth.count)
    at_pitch_point = geometry.relative_radius(teeth.mesh, geometry.longest_arm_angle(teeth.mesh))
    scale = loads.scale.max(axis=0)
    return Unworn(
        scale=scale,
        approach=loads.approach.max(axis=0),
        largest_force=force.max(axis=0),
        loaded_pins=(loads.force > 0.0).sum(axis=0).max(axis=0).astype(float),
        pressure=np.asarray(geometry.mean_pressure(teeth.mesh, loads.force, teeth.relative_radius)).max(axis=(0, 1)),
        contact_part=np.asarray(contact_part(teeth.mesh.equivalent_modulus, scale / teeth.mesh.width, at_pitch_point)),
        lowest_equidistant=np.asarray(geometry.lowest_equidistant(teeth.mesh)),
        first_step=_lasts(teeth, growth(teeth, loads)(loads.force)),
    )


class GrowingHistory:
    """The histories of some meshes, which go on as far as they are asked for; threads may share them."""

    def __init__(self, teeth: Teeth) -> None:
        self._more = nodes_of(teeth)
        self._nodes = [next(self._more)]
        self._told = Histories(*(values[None] for values in self._nodes[0]))
        self._lock = Lock()

    def up_to(self, columns: NDArray[np.intp], exposure: Array) -> Histories:
        """Return the histories, those of ``columns`` to at least an exposure each, or over the most steps."""
        with self._lock:
            if (self._nodes[-1][0][columns] < exposure).any():
                self._nodes.extend(self._until(columns, exposure))
                self._told = Histories(*(np.array(column) for column in zip(*self._nodes, strict=True)))
            return self._told

    def _until(self, columns: NDArray[np.intp], exposure: Array) -> Iterator[WearNode]:
        for node in self._more:
            yield node
            if (node[0][columns] >= exposure).all():
                return


class Remembered(Generic[Answer]):
    """What is known of meshes: each is calculated once, with the others that were asked for at the same time.

    The groups asked for longest ago are forgotten first. Threads may share it.
    """

    def __init__(self, calculate: Callable[[Mesh], Answer]) -> None:
        self._calculate = calculate
        self._groups: OrderedDict[int, tuple[list[MeshKey], Answer]] = OrderedDict()
        self._group_of: dict[MeshKey, tuple[int, int]] = {}
        self._calculated, self._lock = 0, Lock()

    def of(self, mesh: Mesh, order: NDArray[np.intp]) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], Answer]]:
        """Give the meshes (m,) in groups: their places, their columns in the answer of the group, and that answer.

        New meshes are calculated in this order, ``CHUNK`` at a time.
        """
        table = np.stack([np.asarray(column) for column in columns_of(mesh)], axis=1)
        keys = [(row.tobytes(), mesh.choices) for row in table]
        with self._lock:
            known = [self._group_of.get(key, (NEW, 0)) for key in keys]
            answers = {group: self._groups[group][1] for group in {group for group, _ in known} - {NEW}}
            for group in answers:
                self._groups.move_to_end(group)
        groups, columns = np.array(known, dtype=np.intp).reshape(-1, 2).T
        for group, answer in answers.items():
            places = np.flatnonzero(groups == group)
            yield places, columns[places], answer
        rest = order[groups[order] == NEW]
        for start in range(0, len(rest), CHUNK):
            places = rest[start : start + CHUNK]
            answer = self._calculate(some_of(mesh, places))
            self._keep([keys[place] for place in places], answer)
            yield places, np.arange(len(places)), answer

    def _keep(self, keys: list[MeshKey], answer: Answer) -> None:
        with self._lock:
            group, self._calculated = self._calculated, self._calculated + 1
            self._groups[group] = keys, answer
            self._group_of.update((key, (group, column)) for column, key in enumerate(keys))
            while sum(len(own) for own, _ in self._groups.values()) > MOST_REMEMBERED:
                oldest, (own, _) = self._groups.popitem(last=False)
                for key in own:
                    if self._group_of.get(key, (NEW, 0))[0] == oldest:
                        del self._group_of[key]

    def forget(self) -> None:
        """Forget all that was calculated."""
        with self._lock:
            self._groups.clear()
            self._group_of.clear()


UNWORN = Remembered(unworn)
HISTORIES = Remembered(lambda mesh: GrowingHistory(teeth_of(mesh)))


def forget() -> None:
    """Forget all that was calculated."""
    UNWORN.forget()
    HISTORIES.forget()


def all_unworn(mesh: Mesh, count: int) -> Unworn:
    """The new meshes, all of them."""
    solved = {name: np.empty(count) for name in Unworn.__dataclass_fields__}
    for places, columns, new in UNWORN.of(mesh, np.arange(count)):
        for name, values in solved.items():
            values[places] = getattr(new, name)[columns]
    return Unworn(**solved)


def all_histories(
    mesh: Mesh, reach: Array, first_step: Array
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], Histories]]:
    """Histories to an exposure (m,) each, in groups of about the same length: places of meshes, their columns, they."""
    order = np.argsort(reach / first_step, kind="stable")
    for places, columns, history in HISTORIES.of(mesh, order):
        yield places, columns, history.up_to(columns, reach[places])


# Reading wear off the histories: which exposure of which mesh a row of a batch has, and how deep it has worn


@dataclass(frozen=True)
class Meshes:
    """The distinct meshes that can be calculated, and for every row its place among them (-1: none, None: all one)."""

    mesh: Mesh
    count: int
    place: NDArray[np.intp] | None

    def to_rows(self, values: Array) -> Float:
        """Give every row the value of its mesh; NaN where it has none."""
        if self.place is None:
            return np.float64(values[0]) if self.count else np.float64(np.nan)
        return np.append(values, np.nan)[self.place]


def depth_at(meshes: Meshes, new: Unworn, exposure: Float) -> tuple[Float, Float]:
    """Largest wear (m) and its phase angle at an exposure of every row; NaN where a row has no mesh or goes too far."""
    rows = np.atleast_1d(np.asarray(exposure, dtype=float))
    if meshes.place is not None:
        return _of_many(meshes, meshes.place, new, np.broadcast_to(rows, meshes.place.shape))
    depth = angle = np.full(rows.shape, np.nan)
    for _, columns, history in all_histories(meshes.mesh, _reach(rows, None, meshes.count), new.first_step):
        depth, angle = _read(history, int(columns[0]), rows)
    return (depth, angle) if np.ndim(exposure) else (np.float64(depth[0]), np.float64(angle[0]))


def _of_many(meshes: Meshes, place: NDArray[np.intp], new: Unworn, rows: Array) -> tuple[Array, Array]:
    """Read every row from the history of its own mesh."""
    depth, angle = np.full(rows.shape, np.nan), np.full(rows.shape, np.nan)
    order = np.argsort(place, kind="stable")
    ends = np.searchsorted(place[order], np.arange(meshes.count + 1))
    for places, columns, history in all_histories(meshes.mesh, _reach(rows, place, meshes.count), new.first_step):
        counts = np.diff(ends)[places]
        if counts.sum() <= FEW_ROWS * len(places):  # all meshes at once
            own = np.repeat(columns, counts)
            mine = np.concatenate([order[ends[mesh] : ends[mesh + 1]] for mesh in places])
            after = np.sum(~(history.exposure[:, own] >= rows[mine]), axis=0)
            depth[mine], angle[mine] = _between(history, own, rows[mine], after)
            continue
        for column, mesh in zip(columns, places, strict=True):
            mine = order[ends[mesh] : ends[mesh + 1]]
            depth[mine], angle[mine] = _read(history, column, rows[mine])
    return depth, angle


def _reach(rows: Array, place: NDArray[np.intp] | None, count: int) -> Array:
    """How far (m,) the histories are asked for; a row without a number asks for nothing."""
    reach = np.zeros(count)
    if place is None:
        most = rows.max(initial=0.0)
        reach[:] = most if np.isfinite(most) else rows.max(initial=0.0, where=np.isfinite(rows))
    else:
        asked = (place >= 0) & np.isfinite(rows)
        np.maximum.at(reach, place[asked], rows[asked])
    return reach


def _read(history: Histories, column: int, exposure: Array) -> tuple[Array, Array]:
    """Depth and angle at exposures (n,) of one mesh."""
    return _between(history, column, exposure, np.searchsorted(history.exposure[:, column], exposure))


def _between(
    history: Histories, column: int | NDArray[np.intp], exposure: Array, after: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Depth and angle at exposures (n,), each before the node ``after`` (n,); the depth is NaN beyond the last node."""
    end = len(history.exposure) - 1
    after = np.minimum(after, end)
    before = np.maximum(after - 1, 0)
    start, depth = history.exposure[before, column], history.depth[before, column]
    length = history.exposure[after, column] - start
    slope = (history.depth[after, column] - depth) / np.where(length > 0.0, length, 1.0)
    reached = slope * (exposure - start) + depth
    return np.where(exposure <= history.exposure[end, column], reached, np.nan), history.angle[after, column]


# Largest wear of the disc after its working time, and the forces of the unworn mesh

TOO_FAR = (
    f"the wear needs more than {MOST_STEPS} reconstructions of the profile: check output_torque, pressure_viscosity, "
    "composite_roughness (um, not mm) and working_time, or enlarge reconstruction_depth"
)

DEEPEST_STEP = 0.03  # of the approach: half of such a step moves the wear by up to 2 %, over 3000 random reducers
TOO_DEEP = (
    "reconstruction_depth is too coarse for this wear: the forces move within it; reduce it to 3 % of the approach of "
    "disc and pin (result approach), or less"
)
FEWEST_POSITIONS = 200  # twice as many moved the wear of a random reducer by 3.7 %, the most that was seen
TOO_FEW = (
    "phases is too small for so few loaded pins: the wear depends on where the disc is looked at; enlarge phases to "
    "200 over the square of the result loaded_pins, or more"
)


def worn(reducer: Reducer) -> dict[str, Float]:
    """Forces of the new mesh and wear of the disc by their results, each a number or an array (n,), in any mixture.

    The deepest wear is that of the flank that is loaded longer; what the backlash feels is the mean of both.
    """
    meshes = meshes_of(reducer)
    new = all_unworn(meshes.mesh, meshes.count)
    oil = oil_part(reducer)
    exposure = exposure_of(reducer, oil, reducer.working_time)
    depth, angle = depth_at(meshes, new, exposure)
    feasible(~np.isnan(depth) | np.isnan(exposure), TOO_FAR)
    approach, pins = meshes.to_rows(new.approach), meshes.to_rows(new.loaded_pins)
    feasible(np.minimum(reducer.reconstruction_depth, depth) <= DEEPEST_STEP * approach, TOO_DEEP)
    feasible(pins**2 * reducer.phases >= FEWEST_POSITIONS, TOO_FEW)
    duty = either(reducer.reversing / (2.0 - reducer.reversing), 1.0)  # time of the other flank over that of the first
    other = depth if np.ndim(duty) == 0 and duty == 1.0 else depth_at(meshes, new, exposure * duty)[0]
    beside = reducer.extra_wear * np.where(np.asarray(duty) > 0.0, 1.0, 0.5)
    share = reducer.lost_motion_share * (1.0 + reducer.pin_wear_ratio)
    return {
        "equidistant_low": meshes.to_rows(new.lowest_equidistant),
        "disc_torque": reducer.torque_share * reducer.output_torque,
        "start_force": mesh_of(reducer).start_force,
        "max_force": meshes.to_rows(new.scale),
        "approach": approach,
        "largest_force": meshes.to_rows(new.largest_force),
        "loaded_pins": pins,
        "max_pressure": meshes.to_rows(new.pressure),
        "mesh_period": 1.0 / (reducer.output_speed * reducer.pin_count),
        "coefficient": oil * meshes.to_rows(new.contact_part),
        "max_wear": reducer.depth_factor * depth + reducer.extra_wear,
        "wear_angle": angle,
        "backlash_wear": share * (reducer.depth_factor * (depth + other) / 2.0 + beside),
    }


def meshes_of(reducer: Reducer) -> Meshes:
    """Find the distinct meshes of a call and refuse, by row, those that cannot be."""
    mesh, of_row = geometry.distinct(mesh_of(reducer))
    good, broken = holding(mesh)
    if not broken:
        return Meshes(mesh, len(good), of_row)
    refuse(broken, of_row)
    kept = np.flatnonzero(good)
    places = np.where(good, np.cumsum(good) - 1, -1)
    return Meshes(geometry.some_of(mesh, kept), len(kept), None if of_row is None else places[of_row])


def oil_part(reducer: Reducer) -> Float:
    """What oil, surfaces and the neutral factor do to the wear coefficient of every contact alike, m^1.589/Pa."""
    modulus = reducer.young_modulus / (1.0 - reducer.poisson_ratio**2)
    part = lubricant_part(modulus, reducer.pressure_viscosity, reducer.composite_roughness)
    return part * reducer.wear_rate_factor


def exposure_of(reducer: Reducer, oil: Float, time: Float) -> Float:
    """Number of meshings of the flank that is loaded longer, in a time (s), times all that multiplies wear everywhere.

    Ageing makes the momentary coefficient k (1 + a t), so a time T counts as T (1 + a T / 2). A flank is loaded in its
    share of every hour: 1 - r / 2 with ``reversing`` r.
    """
    meshings = time * (1.0 + 0.5 * reducer.ageing_rate * time) * reducer.output_speed * reducer.pin_count
    share = either(1.0 - 0.5 * reducer.reversing, reducer.loaded_share)
    return oil * (meshings * reducer.sliding_factor * share)
