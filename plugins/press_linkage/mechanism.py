"""The calculation itself: from the flat inputs to the exact position of the slider, numbers or arrays alike."""

from collections.abc import Mapping
from math import radians

import numpy as np

from press_linkage.closure import demands
from press_linkage.increments import derivatives
from press_linkage.kinematics import Deviations, Geometry, Position, solve
from press_linkage.quantities import Press, Side, Slider
from truing import Float, either, feasible

ROUNDING = 1e-15
TILT_LIMITS = {"complete": radians(0.0013), "printed": radians(0.001324)}


def geometry_of(press: Press) -> Geometry:
    """The nominal mechanism."""
    return Geometry(
        crank_radius=press.crank_radius,
        rod_length=press.rod_length,
        platform_arm=press.platform_arm,
        knee_drive_length=press.knee_drive_length,
        upper_knee_length=press.upper_knee_length,
        lower_knee_length=press.lower_knee_length,
        slider_half_width=press.slider_half_width,
        crank_pivot_radius=press.crank_pivot_radius,
        platform_half_width=press.platform_half_width,
        ground_pivot_radius=press.ground_pivot_radius,
        ground_pivot_angle=press.ground_pivot_angle,
    )


def deviations_of(side: Side) -> Deviations:
    """What is off on one side."""
    return Deviations(
        crank_radius=side.crank_radius_deviation,
        rod_length=side.rod_length_deviation,
        knee_drive_length=side.knee_drive_length_deviation,
        upper_knee_length=side.upper_knee_length_deviation,
        lower_knee_length=side.lower_knee_length_deviation,
        slider_half_width=side.slider_half_width_deviation,
        slider_joint_angle=side.slider_joint_angle_deviation,
        crank_pivot_radius=side.crank_pivot_radius_deviation,
        crank_pivot_angle=side.crank_pivot_angle_deviation,
        platform_half_width=side.platform_half_width_deviation,
        platform_joint_angle=side.platform_joint_angle_deviation,
        ground_pivot_radius=side.ground_pivot_radius_deviation,
        ground_pivot_angle=side.ground_pivot_angle_deviation,
        crank_angle=side.crank_angle_deviation,
    )


def position_of(press: Press, crank_angle: Float | None = None) -> Position:
    """The exact position with all deviations, at the crank angle of the inputs or at another one."""
    return solve(
        geometry_of(press),
        press.crank_angle if crank_angle is None else crank_angle,
        side_1=deviations_of(press.side_1),
        side_2=deviations_of(press.side_2),
        platform_arm=press.platform_arm_deviation,
    )


def permitted_tilt(press: Press) -> Float:
    """The tilt limit in force: the given one, otherwise that of the reading.

    Where a batch gives it for some rows only, the others take that of the reading.
    """
    return either(press.tilt_limit, TILT_LIMITS[press.reading])


def press_linkage(press: Press) -> Slider:
    """Height and tilt of the slider from the closed vector loops I to VI; every field is a number or an array (n,)."""
    position = position_of(press)
    for demand in demands(geometry_of(press), position):
        feasible(demand.holds, demand.sentence)
    return Slider(
        face_height_1=position.side_1.face,
        face_height_2=position.side_2.face,
        slider_position=position.slider_position,
        slider_tilt=position.slider_tilt,
        permitted_tilt=permitted_tilt(press),
    )


def exact_derivatives(press: Press) -> Mapping[str, Mapping[str, Float]]:
    """Exact derivatives of position and tilt by all 29 sources, from the loop increments in closed form."""
    found = derivatives(geometry_of(press), position_of(press))
    return {
        result: {name: without_rounding(value) for name, value in by_source.items()}
        for result, by_source in (("slider_position", found.position), ("slider_tilt", found.tilt))
    }


def without_rounding(value: Float) -> Float:
    """Sensitivities in m and rad, 0 where nothing but rounding is left (the crank angle at its dead centre)."""
    kept = np.where(np.abs(value) < ROUNDING, 0.0, value)
    return kept if kept.ndim else float(kept)
