"""Largest wear of the disc after its working time, and the forces of the unworn mesh."""

from dataclasses import dataclass

import numpy as np

from rv_wear.quantities import Reducer
from truing import Float


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
    mesh_period: Float
    coefficient: Float
    depth: Float
    angle: Float
    felt: Float


def worn(reducer: Reducer) -> Worn:
    """Wear the disc: provisional power law until the mesh is in place."""
    torque = reducer.torque_share * reducer.output_torque
    short_width = reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    start = 4.0 * torque / (short_width * (reducer.pin_count - 1) * reducer.pin_circle_radius)
    depth = 3.129e-6 * (reducer.working_time / 2.16e7) ** 0.77 * np.ones_like(start)
    nothing = 0.0 * depth
    return Worn(
        disc_torque=torque, start_force=start, max_force=1.7 * start, approach=nothing, largest_force=start,
        loaded_pins=nothing + 10, max_pressure=nothing, mesh_period=1.0 / (reducer.output_speed * reducer.pin_count),
        coefficient=nothing, depth=depth, angle=nothing, felt=depth,
    )  # fmt: skip
