"""Wear of the flank, step by step: forces, wear, new profile, new forces; equations 13 to 16 for all meshes at once.

A history is told over the *exposure* x: number of meshings times everything that multiplies the wear coefficient at
every contact alike (oil, roughness, factors). A step ends where the fastest point has lost the threshold depth, so its
steps are the same whoever asks and however far; between two of them wear grows in proportion to the exposure, which is
exactly the paper's shortened last step. The largest wear is taken from the flank as it is within the step: where
another point overtakes within it, the history has a node at the crossing.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rv_wear import coefficient, sliding
from rv_wear.cycloid import longest_arm_angle, relative_radius
from rv_wear.mesh import Array
from rv_wear.sharing import Loads, shared, start_scale
from rv_wear.teeth import Teeth, part_of

MOST_STEPS = 4000
SLIGHT = 1e-6  # N; a smaller force does not wear
NEVER = 1e200  # exposure of a step in which nothing wears

Rate = Callable[[Array], Array]


@dataclass(frozen=True)
class State:
    """The disc at the beginning of a step: exposure (m,), wear and its growth (pins, phases, m), how long it lasts.

    ``teeth`` holds the pins that bear, and the arrays hold the same; the others have no wear yet. ``lasts`` is an
    exposure (m,), ``grown`` and ``after`` what wears in the step and what is worn at its end.
    """

    teeth: Teeth
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
    by_load = np.asarray(sliding.sliding_ratio(mesh, teeth.angle)) / mesh.width
    if mesh.choices.wear_coefficient == "pitch_point":
        factor = _at_pitch_point(teeth, unworn) * by_load
        return lambda force: factor * force
    by_load = by_load * coefficient.contact_part(modulus, 1.0 / mesh.width, teeth.relative_radius)
    bare = _power_law(by_load, 1.0 + coefficient.LOAD)
    if mesh.film is None:
        return bare
    turning = 2.0 * np.pi * mesh.film.speed
    carried = sliding.rolling_speed(mesh, teeth.angle) - 0.5 * sliding.sliding_speed(mesh, teeth.angle)
    number = coefficient.film_number(mesh, np.abs(carried) * turning, teeth.relative_radius)
    line = number * (mesh.width * modulus * teeth.relative_radius) ** 0.13

    def with_film(force: Array) -> Array:
        return bare(force) * coefficient.unworn_share(line * np.maximum(force, SLIGHT) ** -0.13)

    return with_film


def _power_law(factor: Array, power: float) -> Rate:
    """Factor times force to a power, 0 for a force of 0; its power would take three times as long as any other."""
    slight = np.full_like(factor, SLIGHT)
    least = (slight.reshape(-1)[:8] ** power)[0]

    def rate_of(force: Array) -> Array:
        rate = np.maximum(force, slight)
        np.power(rate, power, out=rate)
        rate -= least
        rate *= factor
        return rate

    return rate_of


def _at_pitch_point(teeth: Teeth, unworn: Loads) -> Array:
    """What force and radius do to the coefficient at the longest arm, where the unworn force is largest; (m,)."""
    mesh = teeth.mesh
    radius = relative_radius(mesh, longest_arm_angle(mesh))
    line_load = unworn.scale.max(axis=0) / mesh.width
    return np.asarray(coefficient.contact_part(mesh.equivalent_modulus, line_load, radius))


def states(teeth: Teeth) -> Iterator[State]:
    """The disc at the beginning of every step, without end."""
    unworn = shared(teeth, teeth.slack, start_scale(teeth))
    part, clear = around(teeth, unworn.force)
    rate_of = growth(part, unworn)
    wear, exposure, last = np.zeros_like(part.slack), np.zeros(teeth.count), unworn.scale
    loads = Loads(unworn.scale, unworn.approach, unworn.taken, unworn.force[part.pins])
    while True:
        rate = rate_of(loads.force)
        lasts = _lasts(teeth, rate)
        grown = rate * lasts
        after = wear + grown
        yield State(part, loads, exposure, wear, rate, lasts, grown, after)
        wear = after
        exposure = exposure + lasts
        guess, last = np.maximum(2.0 * loads.scale - last, 0.5 * loads.scale), loads.scale
        loads = shared(part, _slack(part, wear), guess)
        while np.any(clear - loads.taken <= loads.approach):
            wider, clear = widened(teeth, part)
            wear = _put(wear, part, wider)
            part, rate_of = wider, growth(wider, unworn)
            loads = shared(part, _slack(part, wear), guess)


def _slack(teeth: Teeth, wear: Array) -> Array:
    slack = wear * teeth.per_arm
    slack += teeth.slack
    return slack


def _lasts(teeth: Teeth, rate: Array) -> Array:
    fastest = rate.max(axis=(0, 1))
    return np.where(fastest > 0.0, teeth.mesh.threshold / np.maximum(fastest, 1.0 / NEVER), NEVER)


def around(teeth: Teeth, force: Array) -> tuple[Teeth, Array]:
    """The pins that bear somewhere, and the least slack (phases, m) of the others, which stay as they are."""
    bearing = np.flatnonzero((force > 0.0).any(axis=(1, 2)))
    pins = slice(int(bearing[0]), int(bearing[-1]) + 1)
    return part_of(teeth, pins), _least_outside(teeth, pins)


def widened(teeth: Teeth, part: Teeth) -> tuple[Teeth, Array]:
    """One pin more at either end, as far as there are any."""
    pins = slice(max(part.pins.start - 1, 0), min(part.pins.stop + 1, len(teeth.angle)))
    return part_of(teeth, pins), _least_outside(teeth, pins)


def _least_outside(teeth: Teeth, pins: slice) -> Array:
    outside = np.concatenate([teeth.slack[: pins.start], teeth.slack[pins.stop :]])
    least: Array = outside.min(axis=0, initial=np.inf)
    return least


def _put(values: Array, part: Teeth, whole: Teeth) -> Array:
    """Put what is known of a part of the pins among more of them; 0 elsewhere."""
    wide = np.zeros_like(whole.slack)
    start = part.first - whole.first
    wide[start : start + len(values)] = values
    return wide


def histories(teeth: Teeth, reach: Array) -> Histories:
    """Histories of all meshes to an exposure (m,) each, or to the largest number of steps."""
    nodes: list[tuple[Array, Array, Array]] = []
    deepest = np.zeros(0, dtype=np.intp)
    for count, state in enumerate(states(teeth), 1):
        if not nodes:
            deepest = _flat(state.rate).argmax(axis=0) + state.teeth.first * teeth.angle.shape[1]
            nodes.append((state.exposure, np.zeros(teeth.count), teeth.angle.reshape(-1)[deepest]))
        deepest, added = _step(state, deepest, teeth.angle.reshape(-1))
        nodes.extend(added)
        if np.all(nodes[-1][0] >= reach) or count == MOST_STEPS:
            break
    exposure, depth, angle = (np.array(column) for column in zip(*nodes, strict=True))
    return Histories(exposure, depth, angle)


def _flat(values: Array) -> Array:
    return values.reshape(-1, values.shape[-1])


def _step(
    state: State, leader: NDArray[np.intp], angle: Array
) -> tuple[NDArray[np.intp], list[tuple[Array, Array, Array]]]:
    """The deepest point after a step, and the nodes where it is overtaken (else half way) and at the end of the step.

    Points are counted over all pins and positions.
    """
    before, grown, after = _flat(state.wear), _flat(state.grown), _flat(state.after)
    meshes = np.arange(len(state.lasts))
    offset = state.teeth.first * state.teeth.angle.shape[1]
    old = leader - offset
    start, lead, top = before[old, meshes], grown[old, meshes], after.max(axis=0)
    part, new = np.full(len(meshes), 0.5), old
    passed = np.flatnonzero(after[old, meshes] < top)
    if len(passed):
        new = old.copy()
        new[passed] = after[:, passed].argmax(axis=0)
        behind = start[passed] - before[new[passed], passed]
        part[passed] = np.clip(behind / (grown[new[passed], passed] - lead[passed]), 0.0, 1.0)
    middle = (state.exposure + part * state.lasts, start + part * lead, angle[leader])
    return new + offset, [middle, (state.exposure + state.lasts, top, angle[new + offset])]


def wear_at(teeth: Teeth, exposure: Array) -> Array:
    """Wear of the whole flank (pins, phases, m) at an exposure (m,) each, with the shortened last step of the paper."""
    found = np.zeros_like(teeth.slack)
    for count, state in enumerate(states(teeth), 1):
        left = exposure - state.exposure
        within = (left >= 0.0) & ((left < state.lasts) | (count == MOST_STEPS))
        if within.any():
            here = np.where(within, state.wear + state.rate * left, 0.0)
            found = np.where(within, _put(here, state.teeth, teeth), found)
        if np.all(exposure < state.exposure + state.lasts) or count == MOST_STEPS:
            break
    return found
