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
from rv_wear.mesh import Array
from rv_wear.sharing import Loads, shared, start_scale
from rv_wear.teeth import Teeth

MOST_STEPS = 4000
NEVER = 1e200  # exposure of a step in which nothing wears

Rate = Callable[[Array], Array]


@dataclass(frozen=True)
class State:
    """The disc at one moment: exposure (m,), wear and its growth per exposure (pins, phases, m), forces."""

    exposure: Array
    wear: Array
    rate: Array
    loads: Loads


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
        return _times(_at_pitch_point(teeth, unworn) * by_load, 1.0)
    by_load = by_load * coefficient.contact_part(modulus, 1.0 / mesh.width, teeth.relative_radius)
    power = 1.0 + coefficient.LOAD
    if mesh.film is None:
        return _times(by_load, power)
    turning = 2.0 * np.pi * mesh.film.speed
    carried = sliding.rolling_speed(mesh, teeth.angle) - 0.5 * sliding.sliding_speed(mesh, teeth.angle)
    number = coefficient.film_number(mesh, np.abs(carried) * turning, teeth.relative_radius)
    line = number * (mesh.width * modulus * teeth.relative_radius) ** 0.13

    def with_film(force: Array) -> Array:
        ratio = line * np.maximum(force, 1e-9) ** -0.13
        rate: Array = by_load * force**power * coefficient.unworn_share(ratio)
        return rate

    return with_film


def _times(factor: Array, power: float) -> Rate:
    def plain(force: Array) -> Array:
        return factor * (force if power == 1.0 else force**power)

    return plain


def _at_pitch_point(teeth: Teeth, unworn: Loads) -> Array:
    """What force and radius do to the coefficient at the longest arm, where the unworn force is largest; (m,)."""
    from rv_wear.cycloid import longest_arm_angle, relative_radius

    mesh = teeth.mesh
    radius = relative_radius(mesh, longest_arm_angle(mesh))
    line_load = unworn.scale.max(axis=0) / mesh.width
    return np.asarray(coefficient.contact_part(mesh.equivalent_modulus, line_load, radius))


def states(teeth: Teeth) -> Iterator[tuple[State, Array]]:
    """The disc at the beginning of every step, and the exposure (m,) that the step lasts; without end."""
    guess = start_scale(teeth)
    loads = shared(teeth, teeth.slack, guess)
    rate_of = growth(teeth, loads)
    wear = np.zeros_like(teeth.slack)
    exposure = np.zeros(teeth.count)
    threshold = np.asarray(teeth.mesh.threshold)
    while True:
        rate = rate_of(loads.force)
        fastest = rate.max(axis=(0, 1))
        lasts = np.where(fastest > 0.0, threshold / np.where(fastest > 0.0, fastest, 1.0), NEVER)
        yield State(exposure, wear, rate, loads), lasts
        wear = wear + rate * lasts
        exposure = exposure + lasts
        loads = shared(teeth, teeth.slack + wear / teeth.relative_arm, loads.scale)


def histories(teeth: Teeth, reach: Array) -> Histories:
    """Histories of all meshes to an exposure (m,) each, or to the largest number of steps."""
    nodes: list[tuple[Array, Array, Array]] = []
    for count, (state, lasts) in enumerate(states(teeth)):
        if count == 0:
            first = state.rate.reshape(-1, teeth.count).argmax(axis=0)
            nodes.append((state.exposure, np.zeros(teeth.count), _angle(teeth, first)))
        nodes.extend(_step(teeth, state, lasts, first))
        first = (state.wear + state.rate * lasts).reshape(-1, teeth.count).argmax(axis=0)
        if np.all(nodes[-1][0] >= reach) or count + 1 == MOST_STEPS:
            break
    exposure, depth, angle = (np.array(column) for column in zip(*nodes, strict=True))
    return Histories(exposure, depth, angle)


def _step(teeth: Teeth, state: State, lasts: Array, leader: NDArray[np.intp]) -> list[tuple[Array, Array, Array]]:
    """The two nodes of a step: where the deepest point is overtaken (else half way), and its end."""
    before = state.wear.reshape(-1, teeth.count)
    grown = (state.rate * lasts).reshape(-1, teeth.count)
    after = before + grown
    winner = after.argmax(axis=0)
    start, lead = _at(before, leader), _at(grown, leader)
    behind, gained = start - _at(before, winner), _at(grown, winner) - lead
    overtaken = (winner != leader) & (gained > 0.0)
    part = np.where(overtaken, behind / np.where(overtaken, gained, 1.0), 0.5)
    part = np.clip(part, 0.0, 1.0)
    middle = (state.exposure + part * lasts, start + part * lead, _angle(teeth, leader))
    return [middle, (state.exposure + lasts, _at(after, winner), _angle(teeth, winner))]


def _at(values: Array, place: NDArray[np.intp]) -> Array:
    found: Array = np.take_along_axis(values, place[None], axis=0)[0]
    return found


def _angle(teeth: Teeth, place: NDArray[np.intp]) -> Array:
    return teeth.angle.reshape(-1)[place]


def wear_at(teeth: Teeth, exposure: Array) -> Array:
    """Wear of the whole flank (pins, phases, m) at an exposure (m,) each, with the shortened last step of the paper."""
    found = np.zeros_like(teeth.slack)
    for count, (state, lasts) in enumerate(states(teeth)):
        left = exposure - state.exposure
        within = (left >= 0.0) & ((left < lasts) | (count + 1 == MOST_STEPS))
        found = np.where(within, state.wear + state.rate * left, found)
        if np.all(exposure < state.exposure + lasts) or count + 1 == MOST_STEPS:
            break
    return found
