"""How does the press move, what must its drive give, and what do its joints carry?

The drive gives the motion, and forces follow from it (inverse dynamics): each body, from the slider to the crank, is
in equilibrium with its inertia. Closed form, SI: numbers or arrays, (k,) over the times and (n, k) of n machines. Both
sides are alike, so one is solved, and platform and slider count half. Coordinates and joints as in ``kinematics``.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np
import scipy

from press_linkage.kinematics import (
    Half,
    JointPoint,
    LineMotion,
    Polar,
    Position,
    built,
    crank_at,
    crank_side,
    demands,
    face_motion,
    knee_motion,
    knee_side,
    platform_motion,
)
from press_linkage.motion_quantities import DrivenPress, JointForce, Link, MovingPress, PressMotion
from press_linkage.quantities import PressSide
from truing import Array, Float, column, either, feasible

GRAVITY = 9.80665  # m/s2
TURN = 2.0 * np.pi
CLOSED = 1e-9  # rad: a table that ends so near to a whole turn ends where it begins
CELLS = 16
"""Parts of each stretch of a speed law, with eight Gauss points each: times are then exact to rounding."""
GAUSS = np.polynomial.legendre.leggauss(8)
ROUNDS = 5
"""Of Newton's method for the crank angle at a time; it begins within one part of a stretch."""
REST = 1e-9  # rad/rad and m/rad: a slower body turns back at this crank angle
MOST_ROUNDS, SETTLED = 200, 1e-14
"""Of the friction of pins: so many at most, until no torque changes by more than this share of the largest."""
LINKS = ("crank", "rod", "drive", "upper", "lower")
PINS = (
    ("crank_pivot", "crank", ""), ("crank_pin", "rod", "crank"), ("rod_joint", "rod", ""), ("arm_joint", "drive", ""),
    ("knee_of_drive", "drive", "upper"), ("knee_of_lower", "lower", "upper"), ("ground_joint", "upper", ""),
    ("slider_joint", "lower", ""),
)  # fmt: skip
"""Each joint that rubs, the link that turns on its pin, and the link in which the pin is fixed, if any."""
SERIES = frozenset({"times", "speed_angle", "speed_share", "crank_speed", "force_angle", "force", "forming_force"})

D = TypeVar("D")


# The law of the drive: where the crank is, how fast it turns, and how its speed changes


class CrankCourse(NamedTuple):
    """Crank angle, angular speed and acceleration at the times, (k,) or (n, k)."""

    angle: Float
    speed: Float
    acceleration: Float


def course(press: DrivenPress) -> CrankCourse:
    """The motion of the cranks, by their speed over the times where that is stated, else by the law over the angle.

    Inputs that differ between n machines are columns (n, 1).
    """
    times = np.atleast_1d(press.times)
    feasible(len(times) > 1 and bool(np.all(np.diff(times) > 0)), "times: two or more, each later than the one before")
    speeds = _over_time(press, "crank_speed", times)
    if speeds is None:
        return _over_angle(press, times - times[0])
    if not np.isfinite(speeds).all():
        return _no_course(times)
    law = scipy.interpolate.CubicSpline(times, TURN * speeds)
    turned = law.antiderivative()(times)
    return CrankCourse(press.start_angle + turned - turned[0], law(times), law(times, 1))


def _over_time(press: DrivenPress, name: str, times: Array) -> Array | None:
    """A series that is stated at the times, NaN where it does not fit them; None where it is not stated."""
    values = np.asarray(getattr(press, name), dtype=np.float64)
    if not values.size:
        return None
    fits = values.shape == times.shape
    feasible(fits, f"{name} has {values.size} values at {len(times)} times; it needs one at each")
    feasible(bool(np.isfinite(values).all()), f"{name} is missing at some of the times")
    return values if fits else np.full(times.shape, np.nan)


def _no_course(times: Array) -> CrankCourse:
    nothing = np.full(times.shape, np.nan)
    return CrankCourse(nothing, nothing, nothing)


def _over_angle(press: DrivenPress, elapsed: Array) -> CrankCourse:
    """The speed is a function of the crank angle: the angle at a time is where the time along it is that time."""
    angles, shares = turn_table(press.speed_angle, press.speed_share, "speed_angle", "speed_share")
    feasible(bool(np.all(shares > 0)), "speed_share: a crank that stands still does not go on; each must be above 0")
    if not np.all(shares > 0):
        return _no_course(elapsed)
    around = np.concatenate([angles - TURN, angles, angles + TURN])
    law = scipy.interpolate.PchipInterpolator(around, np.tile(shares, 3))
    places = np.arange(len(angles) * CELLS + 1) / CELLS
    edges = np.interp(places, np.arange(len(angles) + 1), np.append(angles, angles[0] + TURN))
    clock = np.concatenate([[0.0], np.cumsum(_duration(law, edges[:-1], edges[1:]))])
    full = TURN * press.speed
    turns, begun = np.divmod(press.start_angle - edges[0], TURN)
    cell = np.clip(np.searchsorted(edges, edges[0] + begun, "right") - 1, 0, len(edges) - 2)
    reached = clock[cell] + _duration(law, edges[cell], edges[0] + begun) + full * elapsed
    more, rest = np.divmod(reached, clock[-1])
    cell = np.clip(np.searchsorted(clock, rest, "right") - 1, 0, len(edges) - 2)
    angle = edges[cell] + (rest - clock[cell]) * law(edges[cell])
    for _ in range(ROUNDS):
        angle = angle - (clock[cell] + _duration(law, edges[cell], angle) - rest) * law(angle)
    share = law(angle)
    return CrankCourse(angle + TURN * (turns + more), full * share, full * full * share * law(angle, 1))


def _duration(law: "scipy.interpolate.PchipInterpolator", start: Float, end: Float) -> Array:
    """The time from one angle to another at full speed 1 rad/s: the integral of 1/law, by Gauss and Legendre."""
    nodes, weights = GAUSS
    half = np.asarray(0.5 * (end - start))[..., np.newaxis]
    inside = np.asarray(start)[..., np.newaxis] + half * (1.0 + nodes)
    return np.asarray((half * weights / law(inside)).sum(axis=-1))


def turn_table(angles: Float, values: Float, *names: str) -> tuple[Array, Array]:
    """Return a table over the crank angle that holds for every turn; one that repeats its first point loses the last.

    Where it is none, NaN over one angle, and its row fails.
    """
    angle, value = np.atleast_1d(angles), np.atleast_1d(values)
    fits = angle.shape == value.shape and angle.size > 0
    feasible(fits, f"{names[1]} has {value.size} values at {angle.size} of {names[0]}; it needs one at each")
    if fits and len(angle) > 1 and abs(angle[-1] - angle[0] - TURN) < CLOSED and value[0] == value[-1]:
        angle, value = angle[:-1], value[:-1]
    rises = not fits or (bool(np.all(np.diff(angle) > 0)) and angle[-1] - angle[0] < TURN - CLOSED)
    feasible(rises, f"{names[0]}: angles rise within one turn; a table over a whole turn ends with its first value")
    return (angle, value) if fits and rises else (np.zeros(1), np.full(1, np.nan))


def press_force(press: DrivenPress, angle: Float) -> Float:
    """The force on the slider at the times: as it is stated there, else over the crank angle, straight between."""
    stated = _over_time(press, "forming_force", np.atleast_1d(press.times))
    if stated is not None:
        return stated
    angles, forces = turn_table(press.force_angle, press.force, "force_angle", "force")
    return np.interp(angle, angles, forces, period=TURN)


# How the bodies move, per crank angle: first and second derivatives, so that any speed and acceleration follow


class PointMotion(NamedTuple):
    """First and second derivative of a point by the crank angle."""

    velocity: JointPoint
    acceleration: JointPoint


STILL = PointMotion(JointPoint(0.0, 0.0), JointPoint(0.0, 0.0))


@dataclass(frozen=True)
class Body:
    """A body of one side: what it weighs, the line between its joints, and how it moves per crank angle.

    ``motion`` is that of its centre of gravity, at the share ``centre`` of its line, ``turning`` that of its angle.
    """

    mass: Float
    inertia: Float
    centre: Float
    line: JointPoint
    motion: PointMotion
    turning: LineMotion


@dataclass(frozen=True)
class SideMotion:
    """One side in motion: five links, and the platform and the slider, which move along z."""

    crank: Body
    rod: Body
    drive: Body
    upper: Body
    lower: Body
    platform: LineMotion
    slider: LineMotion

    @property
    def links(self) -> tuple[Body, ...]:
        """The links, from the crank to the slider."""
        return self.crank, self.rod, self.drive, self.upper, self.lower


def _plus(one: JointPoint, other: JointPoint, times: Float = 1.0) -> JointPoint:
    return JointPoint(one.y + times * other.y, one.z + times * other.z)


def _cross(one: JointPoint, other: JointPoint) -> Float:
    """The moment of a force about the foot of an arm, positive from outward toward downward."""
    return one.y * other.z - one.z * other.y


def _square(vector: JointPoint) -> Float:
    return vector.y * vector.y + vector.z * vector.z


def _along_z(motion: LineMotion) -> PointMotion:
    return PointMotion(JointPoint(0.0, motion.speed), JointPoint(0.0, motion.acceleration))


def _body(link: Link, polar: Polar, first: PointMotion, second: PointMotion) -> Body:
    """A link between two joints that move: its angle gains (p x dp)/p^2, since its length does not change."""
    line, square = JointPoint(polar.y, polar.z), polar.length * polar.length
    apart = PointMotion(*(_plus(end, start, -1.0) for end, start in zip(second, first, strict=True)))
    return Body(
        mass=link.mass,
        inertia=either(link.inertia, link.mass * square / 12.0),
        centre=link.centre,
        line=line,
        motion=PointMotion(*(_plus(start, way, link.centre) for start, way in zip(first, apart, strict=True))),
        turning=LineMotion(*(_cross(line, way) / square for way in apart)),
    )


def side_motion(press: DrivenPress, half: Half) -> SideMotion:
    """One side in the positions of ``half``, both cranks turning alike."""
    crank = half.parts.crank
    pin = PointMotion(JointPoint(-crank.z, crank.y), JointPoint(-crank.y, -crank.z))
    platform = platform_motion(half)
    slider = face_motion(half, platform)
    knee, carried = PointMotion(*knee_motion(half, platform)), _along_z(platform)
    return SideMotion(
        crank=_body(press.crank, crank, STILL, pin),
        rod=_body(press.rod, half.rod, pin, carried),
        drive=_body(press.drive, half.drive, carried, knee),
        upper=_body(press.upper, half.upper, STILL, knee),
        lower=_body(press.lower, half.lower, knee, _along_z(slider)),
        platform=platform,
        slider=slider,
    )


def reduced_inertia(press: MovingPress, side: SideMotion) -> tuple[Float, Float]:
    """Inertia of one side as it is felt at its crank, kg m2, and its derivative by the crank angle."""
    guided = ((0.5 * press.platform_mass, side.platform), (0.5 * press.slider_mass, side.slider))
    inertia = press.rotor_inertia + sum(mass * line.speed * line.speed for mass, line in guided)
    slope: Float = sum(2.0 * mass * line.speed * line.acceleration for mass, line in guided)
    for body in side.links:
        velocity, acceleration = body.motion
        inertia = inertia + body.mass * _square(velocity) + body.inertia * body.turning.speed**2
        work = velocity.y * acceleration.y + velocity.z * acceleration.z
        slope = slope + 2.0 * (body.mass * work + body.inertia * body.turning.speed * body.turning.acceleration)
    return inertia, slope


def weight_torque(press: MovingPress, side: SideMotion) -> Float:
    """Torque of one crank against the weights of its side, less what the counterbalance lifts."""
    sinking: Float = sum(body.mass * body.motion.velocity.z for body in side.links)
    sinking = sinking + 0.5 * (press.platform_mass * side.platform.speed + press.slider_mass * side.slider.speed)
    return 0.5 * press.counterbalance * side.slider.speed - GRAVITY * sinking


# What the joints carry: each body in equilibrium with its weight and its inertia, from the slider to the crank


class Demand(NamedTuple):
    """What the forces at the joints of a link must give: their sum, and their moment about its first joint."""

    force: JointPoint
    moment: Float


def demand(body: Body, crank: CrankCourse, couple: Float) -> Demand:
    """Mass times acceleration less the weight; the moment of that and of the turning, less the couple."""
    square = crank.speed * crank.speed
    velocity, acceleration = body.motion
    moving = JointPoint(
        acceleration.y * square + velocity.y * crank.acceleration,
        acceleration.z * square + velocity.z * crank.acceleration - GRAVITY,
    )
    force = JointPoint(body.mass * moving.y, body.mass * moving.z)
    turning = body.turning.acceleration * square + body.turning.speed * crank.acceleration
    return Demand(force, body.inertia * turning + body.centre * _cross(body.line, force) - couple)


@dataclass(frozen=True)
class JointForces:
    """The forces at the joints of one side, N, each on the link that is named; ``torque`` of the drive on the crank."""

    crank_pivot: JointPoint  # A, on the crank
    crank_pin: JointPoint  # B, on the rod
    rod_joint: JointPoint  # E, on the rod
    arm_joint: JointPoint  # B5, on the knee drive
    knee_of_drive: JointPoint  # G, on the knee drive
    knee_of_upper: JointPoint  # G, on the upper knee link
    knee_of_lower: JointPoint  # G, on the lower knee link
    ground_joint: JointPoint  # M, on the upper knee link
    slider_joint: JointPoint  # H, on the lower knee link
    torque: Float


def joint_forces(
    press: MovingPress, side: SideMotion, crank: CrankCourse, force: Float, couples: Mapping[str, Float]
) -> JointForces:
    """Forces of one side under its half of the force on the slider; ``couples`` act on its links beside the joints.

    Slider and platform give the forces along z of the joints above them; the moment of the link above gives the other
    component. At the knee three links meet: the moments of two about their other ends give both components.
    """
    crank_, rod, drive, upper, lower = (demand(getattr(side, link), crank, couple) for link, couple in couples.items())
    held = force + press.counterbalance + press.guide_friction * _sense(side.slider.speed, crank)
    slider_joint = _lower_end(side.lower, lower, 0.5 * (_inertia(press.slider_mass, side.slider, crank) + held))
    knee_of_lower = _plus(lower.force, slider_joint, -1.0)
    arm, link = side.drive.line, side.upper.line
    across = _cross(link, arm)
    along_drive = -(upper.moment + _cross(link, knee_of_lower)) / across
    knee_of_drive = JointPoint(
        along_drive * arm.y - drive.moment / across * link.y, along_drive * arm.z - drive.moment / across * link.z
    )
    knee_of_upper = _plus(_plus(JointPoint(0.0, 0.0), knee_of_lower, -1.0), knee_of_drive, -1.0)
    arm_joint = _plus(drive.force, knee_of_drive, -1.0)
    pulled = 0.5 * _inertia(press.platform_mass, side.platform, crank) + arm_joint.z
    rod_joint = _lower_end(side.rod, rod, pulled)
    crank_pin = _plus(rod.force, rod_joint, -1.0)
    return JointForces(
        crank_pivot=_plus(crank_.force, crank_pin),
        crank_pin=crank_pin,
        rod_joint=rod_joint,
        arm_joint=arm_joint,
        knee_of_drive=knee_of_drive,
        knee_of_upper=knee_of_upper,
        knee_of_lower=knee_of_lower,
        ground_joint=_plus(upper.force, knee_of_upper, -1.0),
        slider_joint=slider_joint,
        torque=crank_.moment + press.rotor_inertia * crank.acceleration + _cross(side.crank.line, crank_pin),
    )


def _sense(way: Float, crank: CrankCourse) -> Float:
    """Which way something goes, 1 or -1, whose travel per crank angle this is; 0 where it rests or turns back."""
    return np.sign(np.where(np.abs(way) > REST, way, 0.0) * crank.speed)


def _inertia(mass: Float, motion: LineMotion, crank: CrankCourse) -> Float:
    """Mass times acceleration less the weight of a body that is guided along z."""
    return mass * (motion.acceleration * crank.speed**2 + motion.speed * crank.acceleration - GRAVITY)


def _lower_end(body: Body, needs: Demand, downward: Float) -> JointPoint:
    """The force on the lower end of a link that gives the body below it so much, downward."""
    return JointPoint((-body.line.y * downward - needs.moment) / body.line.z, -downward)


def rubbing(
    press: MovingPress, side: SideMotion, crank: CrankCourse, forces: JointForces
) -> tuple[dict[str, Float], Float]:
    """The couple by which pins hold each link under these forces, and the torque of one crank that all of them take."""
    couples: dict[str, Float] = dict.fromkeys(LINKS, 0.0)
    taken: Float = 0.0
    for joint, link, other in PINS:
        way = getattr(side, link).turning.speed - (getattr(side, other).turning.speed if other else 0.0)
        couple = press.bearing_friction * np.sqrt(_square(getattr(forces, joint)))
        sense = _sense(way, crank)
        couples[link] = couples[link] - couple * sense
        taken = taken + couple * np.abs(way)
        if other:
            couples[other] = couples[other] + couple * sense
    return couples, np.sign(crank.speed) * taken


def in_equilibrium(press: MovingPress, side: SideMotion, crank: CrankCourse, force: Float) -> tuple[JointForces, Float]:
    """The forces of the joints with the friction that they make in the pins; the torque of one crank that pins take.

    Round by round, from pins without friction; where they grow without end the press locks.
    """
    forces = joint_forces(press, side, crank, force, dict.fromkeys(LINKS, 0.0))
    if not np.any(press.bearing_friction):
        return forces, 0.0 * forces.torque
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(MOST_ROUNDS):
            before, (couples, _) = forces, rubbing(press, side, crank, forces)
            forces = joint_forces(press, side, crank, force, couples)
            is_number = np.isfinite(forces.torque)
            largest = np.max(np.abs(forces.torque), where=is_number, initial=0.0)
            settled = is_number & (np.abs(forces.torque - before.torque) <= SETTLED * largest)
            if np.all(settled | ~is_number):
                break
    feasible(settled, "the press locks: its pins rub more than the drive can overcome; bearing_friction is too large")
    return forces, rubbing(press, side, crank, forces)[1]


# The calculation itself


def in_columns(value: D) -> D:
    """Inputs as they meet the times: one row per machine, series as they are."""
    changed = {}
    for each in fields(value):  # type: ignore[arg-type]
        held = getattr(value, each.name)
        if each.name not in SERIES:
            changed[each.name] = in_columns(held) if is_dataclass(held) else column(held)
    return replace(value, **changed)  # type: ignore[type-var]


def half_at(press: DrivenPress, angle: Float) -> Half:
    """One side at these crank angles, every loop closed and no position singular."""
    with np.errstate(invalid="ignore", divide="ignore"):
        parts = built(press, crank_at(press, angle), PressSide())
        pin, drop, height = crank_side(parts)
        half = knee_side(parts, pin, drop, height + press.platform_arm)
    for holds, sentence in demands(press, Position(half.face, 0.0 * half.face, height, half, half)):
        feasible(holds, sentence)
    return half


def press_motion(given: MovingPress) -> PressMotion:
    """The press over the times: motion, torque of the drive and joint forces. Floats are numbers or (n,)."""
    press, times = in_columns(given), np.atleast_1d(given.times)
    crank = course(press)
    half = half_at(press, crank.angle)
    side, force = side_motion(press, half), press_force(press, crank.angle)
    inertia, slope = reduced_inertia(press, side)
    forces, friction = drive_torque(press, side, crank, force)
    torque = forces.torque
    speed = side.slider.speed * crank.speed
    over = partial(np.trapezoid, x=times, axis=-1)
    return PressMotion(
        time=times,
        crank_angle=crank.angle,
        drive_speed=crank.speed,
        drive_acceleration=crank.acceleration,
        slider_position=half.face,
        slope=side.slider.speed,
        curvature=side.slider.acceleration,
        slider_speed=speed,
        slider_acceleration=side.slider.acceleration * crank.speed**2 + side.slider.speed * crank.acceleration,
        press_force=force,
        rod_speed=side.rod.turning.speed * crank.speed,
        knee_drive_speed=side.drive.turning.speed * crank.speed,
        upper_knee_speed=side.upper.turning.speed * crank.speed,
        lower_knee_speed=side.lower.turning.speed * crank.speed,
        reduced_inertia=inertia,
        inertia_slope=slope,
        weight_torque=weight_torque(press, side),
        friction_torque=friction,
        crank_torque=torque,
        drive_power=2.0 * torque * crank.speed,
        kinetic_energy=inertia * crank.speed**2,
        **_answered(forces),
        largest_torque=np.max(np.abs(torque), axis=-1),
        rms_torque=np.sqrt(over(torque**2) / (times[-1] - times[0])),
        drive_work=over(2.0 * torque * crank.speed),
        press_work=over(force * speed),
        turns=np.ptp(np.asarray(crank.angle)[..., [0, -1]], axis=-1) / TURN,
    )


def drive_torque(press: MovingPress, side: SideMotion, crank: CrankCourse, force: Float) -> tuple[JointForces, Float]:
    """The forces of the joints, with the torque of the drive on one crank in them; and the part that friction takes."""
    forces, pins = in_equilibrium(press, side, crank, force)
    oil = press.drive_drag * crank.speed
    guide = 0.5 * press.guide_friction * np.abs(side.slider.speed) * np.sign(crank.speed)
    return replace(forces, torque=forces.torque + oil), pins + guide + oil


def _answered(forces: JointForces) -> Mapping[str, JointForce]:
    """The forces as results."""
    answered = {}
    for name in JOINTS:
        force = getattr(forces, name)
        size = np.sqrt(_square(force))
        answered[name] = JointForce(outward=force.y, downward=force.z, size=size, largest=np.max(size, axis=-1))
    return answered


JOINTS = tuple(each.name for each in fields(JointForces) if each.name != "torque")
