"""Where is the slider, exactly; when do the loops close; and how does the slider accelerate?

Closed form, every size off by its own deviation. Plain numpy: every field and argument is an SI float or an array (n,);
nothing loops over samples.

Frame: O midway between the two crank pivots, y horizontal, z vertical and positive downward, angles from +y toward +z.
Side 1 lies at y > 0. Side 2 is its mirror image and is solved in mirrored coordinates (outward is positive), so both
sides run through the same lines of code.

Sign of the deviations: lengths grow. The four angles of fixed joints (slider, crank pivot, platform, ground pivot) are
polar angles of the frame on both sides, so on side 2, where they count from pi, a positive one turns the joint upward.
A crank angle deviation adds to the crank angle of its own side: equal ones on both sides advance the stroke.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from press_linkage.quantities import Mechanism, Press, PressSide
from truing import Float

# Where is the slider, exactly? Closed-form kinematics of the press linkage with every size off by its own deviation

SERIES_LIMIT = 0.025  # rad; below it the first neglected terms are 4e-18 (cosine) and 1e-20 (sine)
FEW_TERMS = 3e-4  # rad; a sine without its x^5 is off by 7e-17 of itself, a cosine without its x^6 by 1e-24


class JointPoint(NamedTuple):
    """A joint: y outward on its own side, z downward."""

    y: Float
    z: Float


class Polar(NamedTuple):
    """A length with its direction as cosine and sine, so that no angle is ever taken back from an arc function."""

    length: Float
    cosine: Float
    sine: Float

    @property
    def y(self) -> Float:
        """Component outward."""
        return self.length * self.cosine

    @property
    def z(self) -> Float:
        """Component downward."""
        return self.length * self.sine

    @property
    def angle(self) -> Float:
        """The direction from outward toward downward, rad, between -pi and pi."""
        return np.arctan2(self.sine, self.cosine)


@dataclass(frozen=True)
class Parts:
    """One side as built: sizes and directions with their deviations."""

    pivot: Polar  # O to the crank pivot A
    crank: Polar  # A to the crank pin B
    platform: Polar  # platform centre O1 to the rod joint E
    ground: Polar  # O to the ground joint M
    slider: Polar  # slider centre O2 to the joint H
    rod: Float
    drive: Float
    upper: Float
    lower: Float


@dataclass(frozen=True)
class Half:
    """One side in one position: its parts, its joints, and how far it is from a singular position."""

    parts: Parts
    pin: JointPoint  # B, end of the crank
    rod_drop: Float  # height of the rod, E below B
    arm_end: Float  # height of B5, common to both sides
    knee: JointPoint  # G
    knee_fold: Float  # square of sin(theta_19 - theta_17) times (l_g l_m / d^2)^2, negative where loop II is open
    knee_span: Float  # square of the distance d from B5 to M
    lower_drop: Float  # height of the lower link, H below G
    face: Float  # height of the slider face over this joint

    @property
    def rod(self) -> Polar:
        """B to E, angle theta_21."""
        parts = self.parts
        return Polar(parts.rod, (parts.platform.y - self.pin.y) / parts.rod, self.rod_drop / parts.rod)

    @property
    def drive(self) -> Polar:
        """B5 to G, angle theta_17."""
        length = self.parts.drive
        return Polar(length, self.knee.y / length, (self.knee.z - self.arm_end) / length)

    @property
    def upper(self) -> Polar:
        """M to G, angle theta_19."""
        length, ground = self.parts.upper, self.parts.ground
        return Polar(length, (self.knee.y - ground.y) / length, (self.knee.z - ground.z) / length)

    @property
    def lower(self) -> Polar:
        """G to H, angle theta_18."""
        length = self.parts.lower
        return Polar(length, (self.parts.slider.y - self.knee.y) / length, self.lower_drop / length)


@dataclass(frozen=True)
class Position:
    """The press in one position: slider height and tilt, platform height, and both sides with their joints."""

    slider_position: Float
    slider_tilt: Float
    platform_height: Float
    side_1: Half
    side_2: Half


def cosine_and_sine(angle: Float) -> tuple[Float, Float]:
    """Cosine and sine to rounding; an array of small angles by a series that is eight times faster than numpy's.

    The series are broken off after x^6 and x^7, below FEW_TERMS after x^4 and x^3. What is neglected is below
    SERIES_LIMIT x^8/40320 and x^9/362880, under 4e-18. Anything larger, and NaN, goes to numpy.
    """
    if np.ndim(angle) == 0:
        return np.cos(angle), np.sin(angle)
    square = np.asarray(angle * angle)
    largest = float(np.max(square))
    if not largest <= SERIES_LIMIT**2:
        return np.cos(angle), np.sin(angle)
    cosine = square * (1 / 24)  # terms are added in place: arrays stay in the cache
    if largest > FEW_TERMS**2:
        cosine -= square * square * (1 / 720)
        sine = square * (1 / 120)
        sine -= square * square * (1 / 5040)
        sine -= 1 / 6
        sine *= square
    else:
        sine = square * (-1 / 6)
    cosine -= 0.5
    cosine *= square
    cosine += 1.0
    sine *= angle
    sine += angle
    return cosine, sine


def turned(cosine: Float, sine: Float, by: Float) -> tuple[Float, Float]:
    """Cosine and sine of a direction turned by a further angle, by the addition theorems (exact)."""
    if np.ndim(by) == 0 and by == 0.0:
        return cosine, sine
    more_cosine, more_sine = cosine_and_sine(by)
    return cosine * more_cosine - sine * more_sine, sine * more_cosine + cosine * more_sine


def crank_at(press: Mechanism, crank_angle: Float) -> tuple[Float, Float]:
    """Cosine and sine of theta_11 of the nominal mechanism; the crank angle counts from the bottom dead centre.

    The dead centre has crank and rod stretched in line. It is found from nominal sizes: deviations never move the zero.
    """
    stretched = press.crank_radius + press.rod_length
    cosine = (press.platform_half_width - press.crank_pivot_radius) / stretched
    with np.errstate(invalid="ignore"):
        sine = np.sqrt(1.0 - cosine * cosine)
    return turned(cosine, sine, crank_angle)


def built(press: Mechanism, crank: tuple[Float, Float], off: PressSide, *, mirror: float = 1.0) -> Parts:
    """One side with its deviations; *mirror* is -1 for side 2, whose polar angles run the other way."""
    ground = np.cos(press.ground_pivot_angle), np.sin(press.ground_pivot_angle)

    def length(kind: str) -> Float:
        value: Float = getattr(press, kind) + getattr(off, f"{kind}_deviation")
        return value

    def outward(angle: Float) -> Float:
        return angle if mirror > 0 else -angle

    return Parts(
        pivot=Polar(length("crank_pivot_radius"), *cosine_and_sine(outward(off.crank_pivot_angle_deviation))),
        crank=Polar(length("crank_radius"), *turned(*crank, off.crank_angle_deviation)),
        platform=Polar(length("platform_half_width"), *cosine_and_sine(outward(off.platform_joint_angle_deviation))),
        ground=Polar(length("ground_pivot_radius"), *turned(*ground, outward(off.ground_pivot_angle_deviation))),
        slider=Polar(length("slider_half_width"), *cosine_and_sine(outward(off.slider_joint_angle_deviation))),
        rod=length("rod_length"),
        drive=length("knee_drive_length"),
        upper=length("upper_knee_length"),
        lower=length("lower_knee_length"),
    )


def crank_side(parts: Parts) -> tuple[JointPoint, Float, Float]:
    """Loop I: crank pin, height of the rod (E below B), and the platform height this side alone would set."""
    pin = JointPoint(parts.pivot.y + parts.crank.y, parts.pivot.z + parts.crank.z)
    reach = parts.platform.y - pin.y
    rod_drop = np.sqrt(parts.rod * parts.rod - reach * reach)
    return pin, rod_drop, pin.z + rod_drop - parts.platform.z


def knee_side(parts: Parts, pin: JointPoint, rod_drop: Float, arm_end: Float) -> Half:
    """Loops II and III: the knee G outside and below the end of the platform arm, then the slider face over H."""
    to_ground_y, to_ground_z = parts.ground.y, parts.ground.z - arm_end
    span = to_ground_y * to_ground_y + to_ground_z * to_ground_z
    inverse = 1.0 / span
    drive_square = parts.drive * parts.drive
    along = 0.5 + (drive_square - parts.upper * parts.upper) * (0.5 * inverse)
    fold = drive_square * inverse - along * along
    across = np.sqrt(fold)
    knee = JointPoint(to_ground_y * along - to_ground_z * across, to_ground_z * along + to_ground_y * across + arm_end)
    reach = parts.slider.y - knee.y
    lower_drop = np.sqrt(parts.lower * parts.lower - reach * reach)
    face = knee.z + lower_drop - parts.slider.z
    return Half(parts, pin, rod_drop, arm_end, knee, fold, span, lower_drop, face)


def nominal(press: Press) -> Press:
    """The press without its deviations."""
    return replace(press, platform_arm_deviation=0.0, side_1=PressSide(), side_2=PressSide())


def solve(press: Press, crank_angle: Float | None = None) -> Position:
    """The exact position with all deviations, at the crank angle of the inputs or at another one (or n of them).

    The guided platform takes the mean of the heights its two sides would set; the slider is held at y = 0 by its guides
    and takes the mean of its two face heights. Its tilt is their difference over the nominal distance of the slider
    joints, positive when side 1 is lower. Where a loop does not close the heights are NaN; ``demands`` says
    why.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        crank = crank_at(press, press.crank_angle if crank_angle is None else crank_angle)
        parts_1 = built(press, crank, press.side_1)
        parts_2 = built(press, crank, press.side_2, mirror=-1.0)
        pin_1, drop_1, height_1 = crank_side(parts_1)
        pin_2, drop_2, height_2 = crank_side(parts_2)
        height = 0.5 * (height_1 + height_2)
        arm_end = height + (press.platform_arm + press.platform_arm_deviation)
        half_1 = knee_side(parts_1, pin_1, drop_1, arm_end)
        half_2 = knee_side(parts_2, pin_2, drop_2, arm_end)
        return Position(
            slider_position=0.5 * (half_1.face + half_2.face),
            slider_tilt=(half_1.face - half_2.face) / (2.0 * press.slider_half_width),
            platform_height=height,
            side_1=half_1,
            side_2=half_2,
        )


def top_crank_angle(press: Mechanism) -> Float:
    """Crank angle of the upper dead centre, crank and rod folded, rad from the lower one, in (-2 pi, 0).

    Needs a crank that turns fully (``rotation_demand``), otherwise NaN. The other way round it is 2 pi more.
    """
    cosine, sine = crank_at(press, 0.0)
    folded = press.rod_length - press.crank_radius
    rod_cosine = (press.platform_half_width - press.crank_pivot_radius) / folded
    with np.errstate(invalid="ignore"):
        rod_sine = np.sqrt(1.0 - rod_cosine * rod_cosine)
    return np.arctan2(-rod_sine, -rod_cosine) - np.arctan2(sine, cosine)


# What must hold for the press linkage to close: loop by loop, side by side, with the inequality that is violated
#
# Every demand is a condition (one truth value, or one per sample) with the sentence for the engineer. A condition that
# meets NaN does not hold.

SINGULAR = 1e-6  # sine of an angle between two links below which the position is undetermined


Holds = bool | NDArray[np.bool_]


ClosingDemand = tuple[Holds, str]
"""Where something holds that must, and the sentence for the engineer where it does not."""
LOOPS = (  # names on side 1 and 2, what the loop needs, and where it is singular
    (
        ("I", "VI"),
        "the rod cannot reach the platform, it needs |e cos(beta_1) - y_B| < k_R (horizontal distance of its ends "
        "below rod_length)",
        "the rod is horizontal (|sin(theta_2{0})| < 1e-6), the platform height is undetermined",
    ),
    (
        ("II", "V"),
        "the knee drive is open, it needs |l_m - l_g| < |M - B_5| < l_m + l_g (distance from platform arm to ground "
        "pivot between difference and sum of upper_knee_length and knee_drive_length)",
        "platform arm, knee and ground pivot lie in line (|sin(theta_{0}9 - theta_{0}7)| < 1e-6)",
    ),
    (
        ("III", "IV"),
        "the lower link cannot reach the slider, it needs |l - y_G| < l_h (horizontal distance of its ends below "
        "lower_knee_length)",
        "the lower link is horizontal (|sin(theta_{0}8)| < 1e-6)",
    ),
)
"""Rod and platform, knee drive and upper link, lower link and slider."""


def knee_sine(half: Half) -> Float:
    """Sine of the angle between knee drive and upper link, theta_19 - theta_17; NaN where loop II is open."""
    return np.sqrt(half.knee_fold) * half.knee_span / (half.parts.drive * half.parts.upper)


def smallest_sine(position: Position) -> Float:
    """How far the press is from a singular position: the least sine that a height is divided by, both sides.

    Zero is singular; below 0.05 an error of a link reaches the slider more than twentyfold.
    """
    least: Float = np.inf
    with np.errstate(invalid="ignore"):
        for half in (position.side_1, position.side_2):
            least = np.minimum(least, half.rod_drop / half.parts.rod)
            least = np.minimum(least, half.lower_drop / half.parts.lower)
            least = np.minimum(least, knee_sine(half))
    return least


def rotation_demand(press: Mechanism) -> ClosingDemand:
    """What a full turn of the crank needs, and with it the upper dead centre and the stroke."""
    offset = np.abs(press.crank_pivot_radius - press.platform_half_width)
    return (
        offset + press.crank_radius < press.rod_length,
        "loop I does not close over a full turn of the crank: it needs "
        "crank_pivot_radius - platform_half_width + crank_radius < rod_length",
    )


def demands(press: Mechanism, position: Position) -> Iterator[ClosingDemand]:
    """What must hold in this position with these deviations: nominal sizes, then loop by loop, side by side.

    They come in the order of the chain, so the first one that fails names the cause and not a consequence.
    """
    yield (
        press.crank_pivot_radius > press.platform_half_width,
        "the crank pivots must lie farther out than the rod joints of the platform: "
        "crank_pivot_radius > platform_half_width",
    )
    yield (
        press.crank_pivot_radius - press.platform_half_width < press.crank_radius + press.rod_length,
        "loop I has no bottom dead centre: crank and rod in line do not reach the platform; it needs "
        "crank_pivot_radius - platform_half_width < crank_radius + rod_length",
    )
    sides = ((1, position.side_1), (2, position.side_2))
    with np.errstate(invalid="ignore"):
        for side, half in sides:
            yield _sizes(half), f"side {side}: every length with its deviation must be greater than zero"
        for side, half in sides:
            yield from _loop(0, half, side)
        yield (
            position.side_1.arm_end > position.platform_height,
            "the platform arm with its deviation must be longer than zero",
        )
        for side, half in sides:
            yield from _loop(1, half, side)
            yield from _loop(2, half, side)


def _sizes(half: Half) -> Holds:
    """Every length of one side is positive, its deviation included."""
    parts = half.parts
    known = (parts.pivot, parts.crank, parts.platform, parts.ground, parts.slider)
    holds = parts.rod > 0.0
    for length in (parts.drive, parts.upper, parts.lower, *(polar.length for polar in known)):
        holds = holds & (length > 0.0)
    return holds


def _loop(number: int, half: Half, side: int) -> Iterator[ClosingDemand]:
    """A loop closes, and not in a singular position."""
    names, open_sentence, singular_sentence = LOOPS[number]
    closed, regular = (_rod_loop, _knee_loop, _lower_loop)[number](half)
    name = f"loop {names[side - 1]}, side {side}"
    yield closed, f"{name} does not close: {open_sentence}"
    yield regular, f"{name} is singular: {singular_sentence.format(side)}"


def _rod_loop(half: Half) -> tuple[Holds, Holds]:
    return half.rod_drop >= 0.0, half.rod_drop >= SINGULAR * half.parts.rod


def _knee_loop(half: Half) -> tuple[Holds, Holds]:
    links = half.parts.drive * half.parts.upper * SINGULAR
    return half.knee_fold >= 0.0, half.knee_fold * (half.knee_span * half.knee_span) >= links * links


def _lower_loop(half: Half) -> tuple[Holds, Holds]:
    return half.lower_drop >= 0.0, half.lower_drop >= SINGULAR * half.parts.lower


def cycle_demands(press: Press, samples: int = 721) -> Iterator[ClosingDemand]:
    """What a full turn of the crank demands of one nominal mechanism (plain numbers): every loop, at every angle.

    The loops are tried at *samples* equally spaced crank angles; none of the roots may vanish on the way, so the
    mechanism stays on its branch.
    """
    yield rotation_demand(press)
    for holds, sentence in demands(press, solve(nominal(press), np.linspace(-np.pi, np.pi, samples))):
        yield bool(np.all(holds)), f"over the full turn: {sentence}"


# How does the slider accelerate? The loops differentiated twice, exact in any position, numbers or arrays (n,)
#
# Speeds and accelerations are those of cranks that both turn at 1 rad/s: first and second derivatives by the crank
# angle, m/rad and m/rad^2.


class LineMotion(NamedTuple):
    """Velocity and acceleration along one line, or of a point."""

    speed: Float
    acceleration: Float


def _dot(one: JointPoint, other: JointPoint) -> Float:
    return one.y * other.y + one.z * other.z


def platform_motion(half: Half) -> LineMotion:
    """Loop I: the platform as this side alone would move it, downward.

    The rod keeps its length, so rod · rod' = 0 and rod · rod'' + rod' · rod' = 0 with E on a vertical line.
    """
    crank, rod = half.parts.crank, half.rod
    pin = JointPoint(-crank.z, crank.y)  # velocity of B, a quarter turn ahead of the crank
    speed = _dot(pin, JointPoint(rod.y, rod.z)) / rod.z
    swing = JointPoint(-pin.y, speed - pin.z)
    pull = JointPoint(-crank.y, -crank.z)  # acceleration of B, towards A
    return LineMotion(speed, (_dot(pull, JointPoint(rod.y, rod.z)) - _dot(swing, swing)) / rod.z)


def knee_motion(half: Half, platform: LineMotion) -> tuple[JointPoint, JointPoint]:
    """Loop II: velocity and acceleration of the knee G for a given motion of the platform."""
    drive, upper = (JointPoint(link.y, link.z) for link in (half.drive, half.upper))
    quarter = JointPoint(-upper.z, upper.y)
    across = _dot(drive, quarter)
    turning = drive.z * platform.speed / across
    knee = JointPoint(turning * quarter.y, turning * quarter.z)
    swing = JointPoint(knee.y, knee.z - platform.speed)
    inward = turning * turning * _dot(drive, upper)
    gain = (drive.z * platform.acceleration + inward - _dot(swing, swing)) / across
    pull = JointPoint(gain * quarter.y - turning * turning * upper.y, gain * quarter.z - turning * turning * upper.z)
    return knee, pull


def face_motion(half: Half, platform: LineMotion) -> LineMotion:
    """Loops II and III: the slider face over one joint, downward, for a given motion of the platform."""
    knee, pull = knee_motion(half, platform)
    lower = JointPoint(half.lower.y, half.lower.z)
    speed = _dot(lower, knee) / lower.z
    swing = JointPoint(-knee.y, speed - knee.z)
    return LineMotion(speed, (_dot(lower, pull) - _dot(swing, swing)) / lower.z)


def slider_motion(position: Position) -> LineMotion:
    """First and second derivative of the slider position by the crank angle, with the deviations that are present."""
    own = [platform_motion(half) for half in (position.side_1, position.side_2)]
    platform = LineMotion(*(0.5 * (one + other) for one, other in zip(*own, strict=True)))
    faces = [face_motion(half, platform) for half in (position.side_1, position.side_2)]
    return LineMotion(*(0.5 * (one + other) for one, other in zip(*faces, strict=True)))
