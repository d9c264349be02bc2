"""How does the slider accelerate? The loops differentiated twice, exact in any position, numbers or arrays (n,).

Speeds and accelerations are those of cranks that both turn at 1 rad/s: first and second derivatives by the crank angle,
m/rad and m/rad^2.
"""

from typing import NamedTuple

from press_linkage.kinematics import Float, Half, Point, Position


class Motion(NamedTuple):
    """Velocity and acceleration along one line, or of a point."""

    speed: Float
    acceleration: Float


def _dot(one: Point, other: Point) -> Float:
    return one.y * other.y + one.z * other.z


def platform_motion(half: Half) -> Motion:
    """Loop I: the platform as this side alone would move it, downward.

    The rod keeps its length, so rod · rod' = 0 and rod · rod'' + rod' · rod' = 0 with E on a vertical line.
    """
    crank, rod = half.parts.crank, half.rod
    pin = Point(-crank.z, crank.y)  # velocity of B, a quarter turn ahead of the crank
    speed = _dot(pin, Point(rod.y, rod.z)) / rod.z
    swing = Point(-pin.y, speed - pin.z)
    pull = Point(-crank.y, -crank.z)  # acceleration of B, towards A
    return Motion(speed, (_dot(pull, Point(rod.y, rod.z)) - _dot(swing, swing)) / rod.z)


def face_motion(half: Half, platform: Motion) -> Motion:
    """Loops II and III: the slider face over one joint, downward, for a given motion of the platform."""
    drive, upper, lower = (Point(link.y, link.z) for link in (half.drive, half.upper, half.lower))
    quarter = Point(-upper.z, upper.y)
    across = _dot(drive, quarter)
    turning = drive.z * platform.speed / across
    knee = Point(turning * quarter.y, turning * quarter.z)
    swing = Point(knee.y, knee.z - platform.speed)
    inward = turning * turning * _dot(drive, upper)
    gain = (drive.z * platform.acceleration + inward - _dot(swing, swing)) / across
    pull = Point(gain * quarter.y - turning * turning * upper.y, gain * quarter.z - turning * turning * upper.z)
    speed = _dot(lower, knee) / lower.z
    swing = Point(-knee.y, speed - knee.z)
    return Motion(speed, (_dot(lower, pull) - _dot(swing, swing)) / lower.z)


def slider_motion(position: Position) -> Motion:
    """First and second derivative of the slider position by the crank angle, with the deviations that are present."""
    own = [platform_motion(half) for half in (position.side_1, position.side_2)]
    platform = Motion(*(0.5 * (one + other) for one, other in zip(*own, strict=True)))
    faces = [face_motion(half, platform) for half in (position.side_1, position.side_2)]
    return Motion(*(0.5 * (one + other) for one, other in zip(*faces, strict=True)))
