"""The loop increments of the press linkage as the equations stand: twelve linear equations, solved numerically."""

import numpy as np
from numpy.typing import NDArray

from press_linkage.errors import ARM, SOURCES, Derivatives, frame_sign, source
from press_linkage.kinematics import Half, Polar, Position
from press_linkage.quantities import Press
from truing import Float


def loop_increments(press: Press, position: Position) -> Derivatives:
    """The derivatives from the differentiated loops I to VI as they stand, twelve equations solved numerically.

    The unknowns of a side are the increments of its platform height, theta_21, theta_17, theta_19, theta_18 and its
    face height; the mean of both platform heights enters loops II and V.
    """
    matrix = np.zeros((*np.shape(position.slider_position), 12, 12))
    causes = np.zeros((*np.shape(position.slider_position), 12, len(SOURCES)))
    for index, half in enumerate((position.side_1, position.side_2)):
        _fill_unknowns(matrix, half, index)
        _fill_causes(causes, half, index)
    increments = np.linalg.solve(matrix, causes)
    face_1, face_2 = increments[..., 5, :], increments[..., 11, :]
    mean, difference = 0.5 * (face_1 + face_2), face_1 - face_2
    distance = np.asarray(2.0 * press.slider_half_width)[..., np.newaxis]
    tilt = difference / distance
    return Derivatives(
        position={name: mean[..., place] for place, name in enumerate(SOURCES)},
        tilt={name: tilt[..., place] for place, name in enumerate(SOURCES)},
    )


def _put(target: NDArray[np.float64], loop: int, column: int, vector: tuple[Float, Float]) -> None:
    """Write the y and z component of one increment into the two rows of its loop."""
    target[..., 2 * loop, column] = vector[0]
    target[..., 2 * loop + 1, column] = vector[1]


def _along(part: Polar, factor: float = 1.0) -> tuple[Float, Float]:
    """What a longer part does to the end of its chain, per metre."""
    return factor * part.cosine, factor * part.sine


def _across(part: Polar, factor: float = 1.0) -> tuple[Float, Float]:
    """What turning a part does to the end of its chain, per radian: a quarter turn ahead of it."""
    return -factor * part.length * part.sine, factor * part.length * part.cosine


def _fill_unknowns(matrix: NDArray[np.float64], half: Half, index: int) -> None:
    """Left side of loops I, II, III of one side (VI, V, IV of the other)."""
    loop, column = 3 * index, 6 * index
    platform, rod, drive, upper, lower, face = range(column, column + 6)
    _put(matrix, loop, platform, (0.0, 1.0))
    _put(matrix, loop, rod, _across(half.rod, -1.0))
    _put(matrix, loop + 1, 0, (0.0, 0.5))
    _put(matrix, loop + 1, 6, (0.0, 0.5))
    _put(matrix, loop + 1, drive, _across(half.drive))
    _put(matrix, loop + 1, upper, _across(half.upper, -1.0))
    _put(matrix, loop + 2, face, (0.0, 1.0))
    _put(matrix, loop + 2, upper, _across(half.upper, -1.0))
    _put(matrix, loop + 2, lower, _across(half.lower, -1.0))


def _fill_causes(causes: NDArray[np.float64], half: Half, index: int) -> None:
    """Right side of the loops of one side: the increments of its fourteen errors and of the platform arm."""
    loop, side, parts = 3 * index, index + 1, half.parts

    def put(kind: str, of_loop: int, vector: tuple[Float, Float]) -> None:
        sign = frame_sign(kind, side)
        _put(causes, loop + of_loop, SOURCES.index(source(kind, side)), (sign * vector[0], sign * vector[1]))

    put("crank_pivot_radius", 0, _along(parts.pivot))
    put("crank_pivot_angle", 0, _across(parts.pivot))
    put("crank_radius", 0, _along(parts.crank))
    put("crank_angle", 0, _across(parts.crank))
    put("rod_length", 0, _along(half.rod))
    put("platform_half_width", 0, _along(parts.platform, -1.0))
    put("platform_joint_angle", 0, _across(parts.platform, -1.0))
    for of_loop in (1, 2):
        put("ground_pivot_radius", of_loop, _along(parts.ground))
        put("ground_pivot_angle", of_loop, _across(parts.ground))
        put("upper_knee_length", of_loop, _along(half.upper))
    put("knee_drive_length", 1, _along(half.drive, -1.0))
    put("lower_knee_length", 2, _along(half.lower))
    put("slider_half_width", 2, _along(parts.slider, -1.0))
    put("slider_joint_angle", 2, _across(parts.slider, -1.0))
    _put(causes, loop + 1, SOURCES.index(ARM), (0.0, -1.0))
