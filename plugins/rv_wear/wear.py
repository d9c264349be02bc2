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
from truing import Float, feasible

TOO_FAR = (
    f"the wear needs more than {MOST_STEPS} reconstructions of the profile: check output_torque, pressure_viscosity, "
    "composite_roughness (um, not mm) and working_time, or enlarge reconstruction_depth"
)


@dataclass(frozen=True)
class Worn:
    """Forces and pressures of the unworn mesh, deepest wear (m), where it lies (rad) and what of it is felt (m); SI."""

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
    full = exposure_of(reducer, oil, reducer.working_time)
    depth, angle = depth_at(meshes, new, full)
    loaded = depth
    if not (np.ndim(reducer.loaded_share) == 0 and reducer.loaded_share == 1.0):
        part = exposure_of(reducer, oil, reducer.working_time * reducer.loaded_share)
        loaded, _ = depth_at(meshes, new, part)
    feasible(~np.isnan(depth) | np.isnan(full), TOO_FAR)
    share = reducer.lost_motion_share * (1.0 + reducer.pin_wear_ratio)
    return Worn(
        disc_torque=reducer.torque_share * reducer.output_torque,
        start_force=mesh_of(reducer).start_force,
        max_force=meshes.to_rows(new.scale),
        approach=meshes.to_rows(new.approach),
        largest_force=meshes.to_rows(new.largest_force),
        loaded_pins=meshes.to_rows(new.loaded_pins),
        max_pressure=meshes.to_rows(new.pressure),
        equidistant_low=meshes.to_rows(new.lowest_equidistant),
        mesh_period=1.0 / (reducer.output_speed * reducer.pin_count),
        coefficient=oil * meshes.to_rows(new.contact_part),
        depth=reducer.depth_factor * depth + reducer.extra_wear,
        angle=angle,
        felt=share * (reducer.depth_factor * loaded + reducer.extra_wear),
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
    """Number of meshings in a time (s), times all that multiplies wear at every contact alike.

    Ageing makes the momentary coefficient k (1 + a t), so a time T counts as T (1 + a T / 2).
    """
    meshings = time * (1.0 + 0.5 * reducer.ageing_rate * time) * reducer.output_speed * reducer.pin_count
    return oil * (meshings * reducer.sliding_factor)
