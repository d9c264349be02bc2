"""Largest wear of the disc after its working time, and the forces of the unworn mesh."""

from dataclasses import dataclass

import numpy as np

from rv_wear import coefficient
from rv_wear.courses import all_unworn
from rv_wear.feasibility import holding, refuse
from rv_wear.history import MOST_STEPS
from rv_wear.mesh import distinct, mesh_of, some_of
from rv_wear.quantities import Reducer
from rv_wear.reading import Meshes, depth_at
from truing import Float, either, feasible

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


@dataclass(frozen=True)
class Worn:
    """Forces and pressures of the unworn mesh; of the flank that is loaded longer, the deepest wear (m) and its place.

    ``felt`` is the mean of both flanks as the backlash feels it (m).
    """

    disc_torque: Float
    start_force: Float
    max_force: Float
    approach: Float
    largest_force: Float
    loaded_pins: Float
    max_pressure: Float
    equidistant_low: Float
    mesh_period: Float
    coefficient: Float
    depth: Float
    angle: Float
    felt: Float


def worn(reducer: Reducer) -> Worn:
    """Forces of the new mesh and wear of the disc, every Float a number or an array (n,), in any mixture."""
    meshes = meshes_of(reducer)
    new = all_unworn(meshes.mesh, meshes.count)
    oil = oil_part(reducer)
    exposure = exposure_of(reducer, oil, reducer.working_time)
    depth, angle = depth_at(meshes, new, exposure)
    feasible(~np.isnan(depth) | np.isnan(exposure), TOO_FAR)
    approach, pins = meshes.to_rows(new.approach), meshes.to_rows(new.loaded_pins)
    feasible(np.minimum(reducer.reconstruction_depth, depth) <= DEEPEST_STEP * approach, TOO_DEEP)
    feasible(pins**2 * reducer.phases >= FEWEST_POSITIONS, TOO_FEW)
    duty = other_flank(reducer)
    other = depth if np.ndim(duty) == 0 and duty == 1.0 else depth_at(meshes, new, exposure * duty)[0]
    beside = reducer.extra_wear * np.where(np.asarray(duty) > 0.0, 1.0, 0.5)
    share = reducer.lost_motion_share * (1.0 + reducer.pin_wear_ratio)
    return Worn(
        disc_torque=reducer.torque_share * reducer.output_torque,
        start_force=mesh_of(reducer).start_force,
        max_force=meshes.to_rows(new.scale),
        approach=approach,
        largest_force=meshes.to_rows(new.largest_force),
        loaded_pins=pins,
        max_pressure=meshes.to_rows(new.pressure),
        equidistant_low=meshes.to_rows(new.lowest_equidistant),
        mesh_period=1.0 / (reducer.output_speed * reducer.pin_count),
        coefficient=oil * meshes.to_rows(new.contact_part),
        depth=reducer.depth_factor * depth + reducer.extra_wear,
        angle=angle,
        felt=share * (reducer.depth_factor * (depth + other) / 2.0 + beside),
    )


def meshes_of(reducer: Reducer) -> Meshes:
    """Find the distinct meshes of a call and refuse, by row, those that cannot be."""
    mesh, of_row = distinct(mesh_of(reducer))
    good, broken = holding(mesh)
    if not broken:
        return Meshes(mesh, len(good), of_row)
    refuse(broken, of_row)
    kept = np.flatnonzero(good)
    places = np.where(good, np.cumsum(good) - 1, -1)
    return Meshes(some_of(mesh, kept), len(kept), None if of_row is None else places[of_row])


def oil_part(reducer: Reducer) -> Float:
    """What oil, surfaces and the neutral factor do to the wear coefficient of every contact alike, m^1.589/Pa."""
    modulus = reducer.young_modulus / (1.0 - reducer.poisson_ratio**2)
    part = coefficient.lubricant_part(modulus, reducer.pressure_viscosity, reducer.composite_roughness)
    return part * reducer.wear_rate_factor


def exposure_of(reducer: Reducer, oil: Float, time: Float) -> Float:
    """Number of meshings of the flank that is loaded longer, in a time (s), times all that multiplies wear everywhere.

    Ageing makes the momentary coefficient k (1 + a t), so a time T counts as T (1 + a T / 2). A flank is loaded in its
    share of every hour: 1 - r / 2 with ``reversing`` r.
    """
    meshings = time * (1.0 + 0.5 * reducer.ageing_rate * time) * reducer.output_speed * reducer.pin_count
    share = either(1.0 - 0.5 * reducer.reversing, reducer.loaded_share)
    return oil * (meshings * reducer.sliding_factor * share)


def other_flank(reducer: Reducer) -> Float:
    """Time for which the other flank is loaded, over that of the first: r / (2 - r), or 1 where nothing is stated."""
    return either(reducer.reversing / (2.0 - reducer.reversing), 1.0)
