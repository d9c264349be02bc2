"""The play between discs and pins, exactly: which tooth touches first, in both senses, at any angle of the crank.

Equation 21 adds worst errors at the longest arm. Here every pin stands where it stands, every tooth of every disc where
it was ground, and the disc turns until the first of them touches. What the errors of many pins average out to, how two
discs share the load, and how far the output runs ahead or behind are results and no assumptions. Plain numpy, SI.

Range: rigid cranks and bearings that hold all discs at one angle, elastic contacts, every pin round in a fixed place. A
contact with less than ``SHORT_ARM`` of the longest arm is not followed: its gap is some times wider, as an angle, than
that at the longest arm. Where a disc wedges at a pin with a short arm, the angle is found within 0.004 arcmin only.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_geometry.cycloid import pin_distance
from rv_wear.discs import worn_mesh
from rv_wear.forces import Loads, shared, start_scale
from rv_wear.geometry import Mesh, Teeth, mesh_of, relative_arm, teeth_of
from rv_wear.quantities import Reducer
from truing import Array, Float

DISCS = 2
SHORT_ARM = 0.3  # the loaded zone of the paper's reducer ends at 0.7
NEWTON = 2  # of the angle: the error of a micrometre squares, over millimetres of curvature
FEET = 2  # of the foot of the pin's centre on the path; as above


@dataclass(frozen=True)
class Parts:
    """The parts of many machines (n) as they were made: what each pin, tooth and disc is off, in m and rad.

    ``pin_radius`` holds radii; ``pin_radial`` (outward), ``pin_along`` (with the angle) have the shape (pins, n), as
    has ``pin_radius``; ``tooth_along`` at the pin circle (discs, teeth, n); ``throw``, ``phase`` of the crank and
    ``offset`` x + iy of the toothing in its own disc (discs, n). The discs were ground with ``ground_pin`` on
    ``ground_circle`` (n,). ``wear`` (2, points) is the depth on the flank that stops the disc in the sense + and -,
    over the phase angles ``wear_angle`` (points,), the same in all machines.
    """

    mesh: Mesh
    pin_radius: Array
    pin_radial: Array
    pin_along: Array
    tooth_along: Array
    throw: Array
    phase: Array
    offset: NDArray[np.complex128]
    ground_pin: Array
    ground_circle: Array
    wear_angle: Array
    wear: Array


def ideal_parts(reducer: Reducer, time: float = 0.0) -> Parts:
    """One machine whose pins are alike and whose discs are alike: the errors of the inputs that all of them share.

    Taken from the inputs are errors 4 to 8 and 12 to 14; a loose pin gives way by half of its clearance on either
    flank. The wear is that after ``time`` (s) at the torque of the worse disc, with the hours that ``reversing`` gives
    each flank, without ``extra_wear`` and ``depth_factor``. Errors 9 to 11 differ from part to part: ``drawn_parts``.
    """
    mesh = replace(mesh_of(reducer), torque=reducer.output_torque)
    pins, alike = reducer.pin_count, np.ones((reducer.pin_count, 1))
    moved = pin_circle_offset(reducer) * np.exp(-2j * np.pi * np.arange(pins) / pins)[:, None]
    toothing = toothing_offset(reducer) * np.exp(2j * np.pi / DISCS / (pins - 1) * np.arange(DISCS))[:, None]
    throw = reducer.eccentricity + reducer.eccentricity_error
    angle, wear = _wear(reducer, time)
    return Parts(
        mesh=mesh,
        pin_radius=(reducer.pin_radius + reducer.pin_radius_error - 0.5 * reducer.pin_fit_clearance) * alike,
        pin_radial=reducer.pin_circle_error + moved.real,
        pin_along=moved.imag,
        tooth_along=np.zeros((DISCS, pins - 1, 1)),
        throw=np.full((DISCS, 1), throw),
        phase=np.array([[0.0], [reducer.disc_phase_error]]),
        offset=toothing,
        ground_pin=np.array([reducer.pin_radius + reducer.equidistant_modification + reducer.equidistant_error]),
        ground_circle=np.array([reducer.pin_circle_radius + reducer.shift_modification + reducer.shift_error]),
        wear_angle=angle,
        wear=wear,
    )


def _wear(reducer: Reducer, time: float) -> tuple[Array, Array]:
    """Phase angles (points,) and depths (2, points) of both flanks."""
    share = reducer.reversing
    both = (1.0, 1.0) if share is None or np.isnan(share) else (1.0, share / (2.0 - share))
    flanks = []
    for part in both:
        teeth, _, depth = worn_mesh(reducer, float(time * part))
        flanks.append(depth[:, :, 0].reshape(-1))
    return teeth.angle.reshape(-1), np.array(flanks)


def drawn_parts(reducer: Reducer, rng: np.random.Generator, machines: int, time: float = 0.0) -> Parts:
    """Machines with pins and teeth of their own, about what all parts share; normal, with the spreads of the inputs.

    The toothing of every disc is off its centre by half of ``disc_runout``, anywhere around.
    """
    alike, pins = ideal_parts(reducer, time), reducer.pin_count
    around = 2.0 * np.pi * rng.random((DISCS, machines))
    by_pin, by_tooth = (pins, machines), (DISCS, pins - 1, machines)
    return replace(
        alike,
        pin_radius=alike.pin_radius + reducer.pin_radius_spread * rng.standard_normal(by_pin),
        pin_along=alike.pin_along + reducer.pin_position_spread * rng.standard_normal(by_pin),
        pin_radial=alike.pin_radial + reducer.pin_position_spread * rng.standard_normal(by_pin),
        tooth_along=alike.tooth_along + reducer.tooth_pitch_spread * rng.standard_normal(by_tooth),
        offset=alike.offset + 0.5 * reducer.disc_runout * np.exp(1j * around),
    )


# Which tooth touches first: the gap at every pin is the distance of its centre from the path that the disc was ground
# along, beyond it, and the difference of both radii


@dataclass(frozen=True)
class Touches:
    """Angle (contacts, k, n) by which each contact stops the disc, and its phase angle (contacts, k), in one sense.

    Contacts count disc by disc, along the flank; ``discs`` (contacts,) tells which one.
    """

    angle: Array
    phase: Array
    discs: NDArray[np.intp]

    @property
    def first(self) -> Array:
        """Where the first tooth touches, (k, n)."""
        return np.asarray(self.angle.min(axis=0))


def touches(parts: Parts, crank: Array, sense: int) -> Touches:
    """How far the output turns in one sense (+1: with the angle, -1) until each pin touches, at crank angles (k,).

    Exact to less than a nanometre at the flank for errors below 50 um. The crank of disc d stands at the crank angle
    and d / discs of a turn; angles of the output count from where perfect parts without any gap would hold it.
    """
    count = parts.mesh.choices.pin_count
    pitch = 2.0 * np.pi / count
    own = crank[None, :] + 2.0 * np.pi * np.arange(DISCS)[:, None] / DISCS  # (discs, k)
    ahead = sense * own / pitch
    first = np.ceil(ahead)
    phase = pitch * (np.arange(_bearing(parts.mesh))[None, :, None] + (first - ahead)[:, None, :])  # (discs, pins, k)
    pin = sense * (first[:, None, :] + np.arange(phase.shape[1])[None, :, None])
    angle = _solved(parts, own[:, None, :], pin.astype(int), sense)
    gap = np.interp(phase, parts.wear_angle, parts.wear[(1 - sense) // 2])
    arm = parts.mesh.longest_arm * np.asarray(relative_arm(parts.mesh, phase))
    short = np.asarray(arm < SHORT_ARM * parts.mesh.longest_arm)
    angle = sense * angle + (gap / np.where(short, 1.0, arm))[..., None]
    angle = np.where(short[..., None], np.inf, angle)
    flat = (DISCS * phase.shape[1], len(crank))
    return Touches(angle.reshape(*flat, -1), phase.reshape(flat), np.repeat(np.arange(DISCS), phase.shape[1]))


def _bearing(mesh: Mesh) -> int:
    """How many pins of one side may stop the disc; behind them the arm is short."""
    angles = 2.0 * np.pi * np.arange(mesh.choices.pin_count // 2) / mesh.choices.pin_count
    return int(np.flatnonzero(np.asarray(relative_arm(mesh, angles)) >= SHORT_ARM)[-1]) + 1


def _solved(parts: Parts, crank: Array, pin: NDArray[np.intp], sense: int) -> Array:
    """The angle (discs, pins, k, n) of the disc at which each pin touches, by Newton's rule."""
    count = parts.mesh.choices.pin_count
    at = 2.0 * np.pi * pin / count
    turned = -crank / (count - 1)
    discs = np.arange(DISCS)[:, None, None]
    tooth = np.floor((at - turned) * (count - 1) / (2.0 * np.pi)).astype(int) % (count - 1)
    own = pin % count
    swing = (crank[..., None] + parts.phase[:, None, None, :]).astype(float)
    centre = parts.throw[:, None, None, :] * np.exp(1j * swing)
    place = parts.mesh.pin_circle_radius + parts.pin_radial[own] + 1j * parts.pin_along[own]
    seen = place * np.exp(1j * at)[..., None] - centre
    turned = turned[..., None] + parts.tooth_along[discs, tooth] / parts.mesh.pin_circle_radius
    less = parts.ground_pin - parts.pin_radius[own]
    start = at[..., None] - turned
    angle: Array = np.zeros(np.broadcast_shapes(seen.shape, turned.shape, less.shape))
    for _ in range(NEWTON):
        centre_in_disc = seen * np.exp(-1j * (turned + angle)) - parts.offset[:, None, None, :]
        gap, slope = _gap(parts, centre_in_disc, start - angle)
        slope = np.where(sense * slope < 0.0, slope, -sense)  # no arm: not followed
        angle = angle - (gap + less) / slope
    return angle


def _gap(parts: Parts, seen: NDArray[np.complex128], foot: Array) -> tuple[Array, Array]:
    """Distance of the pins' centres from the ground path, beyond it, and its slope over the angle of the disc."""
    circle, throw, pins = parts.ground_circle, parts.mesh.eccentricity, parts.mesh.choices.pin_count
    for _ in range(FEET):
        ring, wave = circle * np.exp(1j * foot), throw * np.exp(1j * pins * foot)
        off = seen - (ring - wave)
        way, bend = 1j * (ring - pins * wave), pins**2 * wave - ring
        along = off.real * way.real + off.imag * way.imag
        foot = foot + along / (np.abs(way) ** 2 - off.real * bend.real - off.imag * bend.imag)
    ring, wave = circle * np.exp(1j * foot), throw * np.exp(1j * pins * foot)
    way = 1j * (ring - pins * wave)
    normal = -1j * way / np.abs(way)
    off = seen - (ring - wave)
    distance = off.real * normal.real + off.imag * normal.imag
    moved = -1j * seen
    return distance, moved.real * normal.real + moved.imag * normal.imag


# The same to first order, for a batch of reducers with one crank angle each: what effects ask for again and again


def pin_circle_offset(reducer: Reducer) -> NDArray[np.complex128]:
    """Offset x + iy (n,) or () of the circle of the pins from the axis of the output, m."""
    return np.asarray(reducer.pin_circle_x + 1j * np.asarray(reducer.pin_circle_y))


def toothing_offset(reducer: Reducer) -> NDArray[np.complex128]:
    """Offset x + iy (n,) or () of the toothing in its disc, as the output turns, mean of both discs, m."""
    return np.asarray(reducer.toothing_x + 1j * np.asarray(reducer.toothing_y))


@dataclass(frozen=True)
class Stops:
    """Where pins that are alike stop new discs, to first order, at one crank angle (n,) per reducer: equation R2.

    Lengths in m on the longest ``arm`` (n,): ``way`` (senses, discs or 1, pins, n) until a pin touches, ``lean`` of its
    normal to the crank over that across it, of the same shape; ``own`` (discs, n) are the angles of the cranks.
    """

    way: Array
    lean: Array
    own: Array
    arm: Float

    def play(self, offset: NDArray[np.complex128], behind: Float) -> Array:
        """Play (n,) in rad, with the pins off the toothing by ``offset`` x + iy () or (n,), in the housing.

        ``behind`` (m) is by how much less the second disc turns with its crank. Within 0.004 arcmin of ``play_of``
        while the offset along the crank and the error of the throw are together smaller than the radial clearance;
        beyond, a disc wedges at a pin with a short arm.
        """
        seen = offset * np.exp(-1j * self.own)  # along the crank of each disc, and across it
        stop = (self.way + self.lean * seen.real[:, None]).min(axis=2)
        stop = stop + SENSES * (seen.imag - np.arange(DISCS)[:, None] * behind)
        return np.asarray(stop.min(axis=1).sum(axis=0) / self.arm)


SENSES = np.array([1.0, -1.0])[:, None, None]


def stops_of(reducer: Reducer, crank: Float) -> Stops:
    """Every pin of both discs with its gap over its arm, at crank angles () or (n,)."""
    count, short_width = reducer.pin_count, reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    pitch = 2.0 * np.pi / count
    thinner = reducer.equidistant_modification + reducer.equidistant_error + 0.5 * reducer.pin_fit_clearance
    thinner = thinner - reducer.pin_radius_error
    outward = reducer.shift_modification + reducer.shift_error - reducer.pin_circle_error
    own = np.atleast_1d(crank) + 2.0 * np.pi * np.arange(DISCS)[:, None] / DISCS
    unlike = DISCS if count % DISCS else 1  # discs among an even number of pins see them at the same phase angles
    ahead = SENSES * own[:unlike] / pitch
    first = pitch * (np.ceil(ahead) - ahead)
    phase = first[:, :, None] + pitch * np.arange(_following(short_width, count))[:, None]
    cosine = np.cos(phase)
    sine, distance = np.sqrt(1.0 - cosine**2), pin_distance(short_width, phase)
    sine = np.where(sine >= SHORT_ARM * distance, sine, np.nan)
    lean = (cosine - short_width) / sine
    way = (thinner * distance - outward * (1.0 - short_width * cosine)) / sine - reducer.eccentricity_error * lean
    followed = np.isfinite(way)
    return Stops(
        way=np.where(followed, way, np.inf),
        lean=np.where(followed, lean, 0.0),
        own=own,
        arm=reducer.eccentricity * (count - 1),
    )


def _following(short_width: Float, count: int) -> int:
    """How many pins of one side may stop a disc; behind them the arm is short for every reducer."""
    angle = 2.0 * np.pi * np.arange(count // 2)[:, None] / count
    distance = pin_distance(np.atleast_1d(short_width), angle)
    return int(np.flatnonzero((np.sin(angle) >= SHORT_ARM * distance).any(axis=1))[-1]) + 1


# What follows: play, load of the discs and the error of transmission


@dataclass(frozen=True)
class Carried:
    """Under the torque of the output in one sense: forces (contacts, k, n) in N, angle (k, n) to where it is held.

    ``shares`` (discs, k, n) of the torque.
    """

    force: Array
    angle: Array
    shares: Array


def play_of(parts: Parts, crank: Array) -> Array:
    """How far the output can be turned by hand, rad (k, n), without the play of bearings and involute gears."""
    return touches(parts, crank, 1).first + touches(parts, crank, -1).first


def carried(parts: Parts, crank: Array, sense: int) -> Carried:
    """Let all discs carry the torque of the output together, by the sharing that the inputs ask for."""
    touched = touches(parts, crank, sense)
    teeth = teeth_of(parts.mesh, touched.phase)
    slack = np.where(np.isfinite(touched.angle), touched.angle * parts.mesh.longest_arm, 1.0)
    shape = slack.shape[1:]
    full = _to_machines(teeth, shape)
    loads: Loads = shared(full, slack, np.broadcast_to(start_scale(teeth), shape).copy())
    moment = loads.force * teeth.relative_arm * parts.mesh.longest_arm
    whole = moment.sum(axis=0)
    shares = np.stack([moment[touched.discs == disc].sum(axis=0) / whole for disc in range(DISCS)])
    return Carried(loads.force, (loads.taken + loads.approach) / parts.mesh.longest_arm, shares)


def _to_machines(teeth: Teeth, shape: tuple[int, ...]) -> Teeth:
    """The same geometry for every machine."""
    whole = (len(teeth.angle), *shape)

    def to_all(values: Array, size: tuple[int, ...]) -> Array:
        return np.broadcast_to(values, size).copy()

    return replace(
        teeth,
        relative_arm=to_all(teeth.relative_arm, whole),
        per_arm=to_all(teeth.per_arm, whole),
        weight=to_all(teeth.weight, whole),
        relative_radius=to_all(teeth.relative_radius, whole),
        depth_number=to_all(teeth.depth_number, shape),
        compliance=to_all(teeth.compliance, shape),
        torque=to_all(teeth.torque, shape),
        nothing=np.zeros(whole),
    )
