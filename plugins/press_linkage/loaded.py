"""How far does the loaded press give way, does its slider tilt, and what do its guides carry?

Statics of the whole press, both sides and off-centre loads: 14 displacements (crank pins B, knees G: y and z; platform
and slider: y, z and tilt) and 16 springs (rods, knee links, cranks along and across, guides of platform and slider).
A spring has a free length, by errors of parts and heat, and a play in which it carries next to nothing. Equilibrium is
where the potential energy is least; it is convex, so there is one. Loads are the force on the slider, weights,
counterbalance and the inertia of every body, by the motion of the nominal press.

Range: displacements that are small beside the links (geometry to first order about the nominal position: a thousandth
of the deflection per millimetre of it), play that is taken up along the line of its link, no friction, plane. Numbers
or arrays, (k,) over the times and (n, k) of n machines; y towards side 1, z downward, tilt from y towards z.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from press_linkage.effects import GRAVITY, JOINTS, KNEE
from press_linkage.errors import face_sensitivities
from press_linkage.kinematics import Half
from press_linkage.loaded_quantities import LoadedAnswers, LoadedPress
from press_linkage.motion import (
    Body,
    CrankCourse,
    SideMotion,
    course,
    demand,
    half_at,
    in_columns,
    press_force,
    side_motion,
)
from press_linkage.quantities import PressSide
from truing import Array, Float, feasible

FILM = 1e-4
"""Share of its stiffness that a spring has within its play: an oil film. 8 N cross a play of 40 um of a joint."""
ROUNDING = 1e-13  # m and rad
MOST_ROUNDS = 80
"""Until every spring is on the piece that was assumed; most presses need five."""
SOFTEST, STIFFEST = 1e3, 1e15  # N/m: outside, a spring is none, or the equations lose their digits
LARGEST = 0.1  # m: a greater play or free extension is no small displacement
SIDES = ((1, 1.0), (2, -1.0))
PINS, KNEES, PLATFORM, SLIDER = {1: 0, 2: 2}, {1: 4, 2: 6}, 8, 11
FREEDOMS = 14
RODS, DRIVES, UPPERS, LOWERS, ALONG, ACROSS = ({1: row, 2: row + 1} for row in range(0, 12, 2))
PLATFORM_GUIDES, SLIDER_GUIDES = (14, 12), (15, 13)
"""Upper and lower."""
SPRINGS = 16

Vector = tuple[Float, Float]


class Springs(NamedTuple):
    """The springs of the press: extension per displacement (..., 16, 14), stiffness, play, free extension (..., 16)."""

    gradient: Array
    stiffness: Array
    play: Array
    free: Array


@dataclass(frozen=True)
class Balance:
    """The press in equilibrium: displacements (..., 14) and tension of the springs (..., 16)."""

    moved: Array
    tension: Array

    def within(self, places: slice) -> "Balance":
        """The same at some of the positions."""
        return Balance(self.moved[..., places, :], self.tension[..., places, :])


def _stacked(parts: Mapping[int, Float], count: int) -> Array:
    """Values by their place along a last axis, 0 elsewhere."""
    whole = np.zeros((*np.broadcast_shapes(*(np.shape(value) for value in parts.values())), count))
    for place, value in parts.items():
        whole[..., place] = value
    return whole


# Where each spring lies, how stiff it is, and how much longer its parts have become


def _turned(direction: Vector, sign: float) -> Vector:
    """A direction of the mirrored coordinates of one side in those of the press."""
    return sign * direction[0], direction[1]


def _places(press: LoadedPress, half: Half, sign: float) -> dict[str, Vector]:
    """Unit vectors of the links, outward in the coordinates of the press, and the crank across (growing angle)."""
    lines = {"rod": half.rod, "drive": half.drive, "upper": half.upper, "lower": half.lower, "crank": half.parts.crank}
    directions = {name: _turned((line.cosine, line.sine), sign) for name, line in lines.items()}
    crank = half.parts.crank
    return directions | {"across": _turned((-crank.sine, crank.cosine), sign)}


def _gradients(press: LoadedPress, half: Half) -> Array:
    """Extension of each spring per displacement: of its second end along its line, less that of its first."""
    rows: dict[int, dict[int, Float]] = {}
    for side, sign in SIDES:
        at = _places(press, half, sign)
        pin, knee = PINS[side], KNEES[side]
        y, z = at["rod"]
        rows[RODS[side]] = {
            pin: -y, pin + 1: -z, PLATFORM: y, PLATFORM + 1: z, PLATFORM + 2: z * sign * press.platform_half_width,
        }  # fmt: skip
        y, z = at["drive"]
        rows[DRIVES[side]] = {
            knee: y, knee + 1: z, PLATFORM: -y, PLATFORM + 1: -z, PLATFORM + 2: y * press.platform_arm,
        }  # fmt: skip
        y, z = at["upper"]
        rows[UPPERS[side]] = {knee: y, knee + 1: z}
        y, z = at["lower"]
        rows[LOWERS[side]] = {
            knee: -y, knee + 1: -z, SLIDER: y, SLIDER + 1: z, SLIDER + 2: z * sign * press.slider_half_width,
        }  # fmt: skip
        for row, name in ((ALONG, "crank"), (ACROSS, "across")):
            rows[row[side]] = {pin: at[name][0], pin + 1: at[name][1]}
    for body, guides, heights in _guided(press):
        rows |= {guide: {body: 1.0, body + 2: -height} for guide, height in zip(guides, heights, strict=True)}
    flat = {row * FREEDOMS + column: value for row, parts in rows.items() for column, value in parts.items()}
    whole = _stacked(flat, SPRINGS * FREEDOMS)
    return whole.reshape(*whole.shape[:-1], SPRINGS, FREEDOMS)


def _guided(press: LoadedPress) -> tuple[tuple[int, tuple[int, int], tuple[Float, Float]], ...]:
    """Platform and slider with their guides, and how far below its middle each of these lies."""
    half_span = 0.5 * press.platform_guide_span
    return (
        (PLATFORM, PLATFORM_GUIDES, (-half_span, half_span)),
        (SLIDER, SLIDER_GUIDES, (-press.guide_above, press.guide_below)),
    )


def _stiffness(press: LoadedPress, half: Half) -> Array:
    """Bars in series with their joints; the frame at M along the upper link; pivot and drive behind the crank."""
    modulus, joints = press.modulus, JOINTS / press.joint_stiffness
    frame = half.upper.cosine**2 / press.ground_stiffness_sideways
    frame = frame + half.upper.sine**2 / press.ground_stiffness_vertical
    pivot = 1.0 / press.pivot_stiffness
    soft = {
        RODS[1]: press.rod_length / (modulus * press.section_rod) + joints,
        DRIVES[1]: press.knee_drive_length / (modulus * press.section_knee_drive) + joints,
        UPPERS[1]: press.upper_knee_length / (modulus * press.section_upper_knee) + joints + frame,
        LOWERS[1]: press.lower_knee_length / (modulus * press.section_lower_knee) + joints,
        ALONG[1]: press.crank_radius / (modulus * press.section_crank) + pivot,
        ACROSS[1]: press.crank_radius**2 / press.drive_stiffness + pivot,
    }
    both = {row + other: 1.0 / value for row, value in soft.items() for other in (0, 1)}
    both |= dict.fromkeys(PLATFORM_GUIDES, press.platform_guide_stiffness)
    return _stacked(both | dict.fromkeys(SLIDER_GUIDES, press.guide_stiffness), SPRINGS)


def _play(press: LoadedPress) -> Array:
    """How far a spring extends or shortens until it carries: two joints of a link, the clearance of a guide."""
    links = dict.fromkeys(range(ALONG[1]), JOINTS * press.joint_play)
    links |= dict.fromkeys(PLATFORM_GUIDES, press.platform_guide_clearance)
    return _stacked(links | dict.fromkeys(SLIDER_GUIDES, press.guide_clearance), SPRINGS)


def _free(press: LoadedPress, half: Half) -> Array:
    """How much longer each spring is when it carries nothing: by errors of its parts, by heat, and where it is held."""
    free: dict[int, Float] = {}
    warm, frame = press.expansion * press.link_rise, press.expansion * press.frame_rise
    for side, sign in SIDES:
        off = press.side_1 if side == 1 else press.side_2
        at = _places(press, half, sign)
        moved = _misplaced(press, off, sign, warm, frame)

        def apart(line: str, end: Vector, start: Vector, at: dict[str, Vector] = at) -> Float:
            return at[line][0] * (end[0] - start[0]) + at[line][1] * (end[1] - start[1])

        still = (0.0, 0.0)
        free[RODS[side]] = off.rod_length_deviation + warm * press.rod_length - apart("rod", moved["E"], still)
        free[DRIVES[side]] = off.knee_drive_length_deviation + warm * press.knee_drive_length
        free[DRIVES[side]] = free[DRIVES[side]] - apart("drive", still, moved["B5"])
        free[UPPERS[side]] = off.upper_knee_length_deviation + warm * press.upper_knee_length
        free[UPPERS[side]] = free[UPPERS[side]] - apart("upper", still, moved["M"])
        free[LOWERS[side]] = off.lower_knee_length_deviation + warm * press.lower_knee_length
        free[LOWERS[side]] = free[LOWERS[side]] - apart("lower", moved["H"], still)
        free[ALONG[side]] = off.crank_radius_deviation + warm * press.crank_radius - apart("crank", still, moved["A"])
        free[ACROSS[side]] = press.crank_radius * off.crank_angle_deviation - apart("across", still, moved["A"])
    for guide, height in zip(SLIDER_GUIDES, _guided(press)[1][2], strict=True):
        free[guide] = press.guide_inclination * (half.face + height - press.bolster_depth)
    return _stacked(free, SPRINGS)


def _misplaced(press: LoadedPress, off: PressSide, sign: float, warm: Float, frame: Float) -> dict[str, Vector]:
    """Where the joints on platform, slider and frame lie beside their place: by their errors and by heat."""

    def joint(kinds: tuple[str, str], cosine: Float, sine: Float, growth: Float) -> Vector:
        radius, angle = kinds
        length = getattr(press, radius)
        along = getattr(off, f"{radius}_deviation") + growth * length
        across = length * getattr(off, f"{angle}_deviation")
        return along * sign * cosine - across * sine, along * sine + across * sign * cosine

    ground = np.cos(press.ground_pivot_angle), np.sin(press.ground_pivot_angle)
    return {
        "A": joint(("crank_pivot_radius", "crank_pivot_angle"), 1.0, 0.0, frame),
        "E": joint(("platform_half_width", "platform_joint_angle"), 1.0, 0.0, warm),
        "M": joint(("ground_pivot_radius", "ground_pivot_angle"), *ground, frame),
        "H": joint(("slider_half_width", "slider_joint_angle"), 1.0, 0.0, warm),
        "B5": (0.0, press.platform_arm_deviation + warm * press.platform_arm),
    }


def springs(press: LoadedPress, half: Half) -> Springs:
    """All springs in the positions of ``half``; inputs as columns (n, 1) beside positions (k,) or (n, k)."""
    return Springs(_gradients(press, half), _stiffness(press, half), _play(press), _free(press, half))


# Loads: the force on the slider, weights, counterbalance, and the inertia of every body


def loads(press: LoadedPress, side: SideMotion, crank: CrankCourse, force: Float, offset: Float) -> dict[int, Float]:
    """The load on each displacement, by its place: forces N, moments N m."""
    loads: dict[int, Float] = dict.fromkeys(range(FREEDOMS), 0.0)

    def put(place: int, load: Float) -> None:
        loads[place] = loads[place] + load

    square = crank.speed * crank.speed
    for body, mass, way in ((PLATFORM, press.platform_mass, side.platform), (SLIDER, press.slider_mass, side.slider)):
        put(body + 1, mass * (GRAVITY - way.acceleration * square - way.speed * crank.acceleration))
    put(SLIDER + 1, -press.counterbalance - force)
    put(SLIDER + 2, -force * offset)
    for number, sign in SIDES:
        pin, knee = PINS[number], KNEES[number]
        for link, first, last in (
            ("crank", None, pin), ("rod", pin, "E"), ("drive", "B5", knee), ("upper", None, knee), ("lower", knee, "H"),
        ):  # fmt: skip
            ends = _on_the_ends(getattr(side, link), crank)
            for end, (y, z) in zip((first, last), ends, strict=True):
                if isinstance(end, int):
                    put(end, sign * y)
                    put(end + 1, z)
                elif end is not None:  # on the platform or on the slider
                    body = SLIDER if end == "H" else PLATFORM
                    put(body, sign * y)
                    put(body + 1, z)
                    put(body + 2, sign * _moment(press, end, y, z))
    return loads


def _moment(press: LoadedPress, joint: str, y: Float, z: Float) -> Float:
    """The moment of a force at a joint of side 1 about the middle of its body."""
    if joint == "B5":
        return -press.platform_arm * y
    return (press.platform_half_width if joint == "E" else press.slider_half_width) * z


def _on_the_ends(body: Body, crank: CrankCourse) -> tuple[Vector, Vector]:
    """Weight and inertia of a link as two forces at its ends, outward and downward, with the same sum and moment."""
    needs = demand(body, crank, 0.0)
    y, z = body.line
    square = y * y + z * z
    along = body.centre * (needs.force.y * y + needs.force.z * z) / square
    across = needs.moment / square
    last = (-(along * y - across * z), -(along * z + across * y))
    return (-needs.force.y - last[0], -needs.force.z - last[1]), last


# Equilibrium: 14 springs would hold the press, so two numbers say how it shares its load among 16


def carried(of: "Springs | Chain", apart: Array) -> Array:
    """What springs carry that are so much longer than free: next to nothing within their play, beyond it the rest."""
    beyond = apart - np.clip(apart, -of.play, of.play)
    return np.asarray(of.stiffness * (FILM * apart + (1.0 - FILM) * beyond))


def balanced(of: Springs, load: Array) -> Balance:
    """Where the energy is least under these loads (..., 14). NaN where the geometry is, and where springs are none.

    With the gradient G = Q (R, 0)' and Z the last two columns of Q, tensions in equilibrium are N = Q (R'^-1 load, r),
    and extensions fit together where Z' takes nothing from them: two equations for the two numbers r.
    """
    known = np.asarray(np.isfinite(of.gradient).all(axis=(-2, -1)))
    turned, upper = np.linalg.qr(np.where(known[..., np.newaxis, np.newaxis], of.gradient, np.eye(SPRINGS, FREEDOMS)),
                                 mode="complete")  # fmt: skip
    holds = np.linalg.solve(upper[..., :FREEDOMS, :], np.swapaxes(turned, -1, -2)[..., :FREEDOMS, :])
    statics = (load[..., np.newaxis, :] @ holds)[..., 0, :]
    known = known & np.isfinite(statics).all(axis=-1)
    known = known & ((of.stiffness > SOFTEST) & (of.stiffness < STIFFEST)).all(axis=-1)
    known = known & (of.play < LARGEST).all(axis=-1) & (np.abs(of.free) < LARGEST).all(axis=-1)
    stiffness, play, free, balancing = (
        np.broadcast_to(array, (*known.shape, SPRINGS))[known] for array in (of.stiffness, of.play, of.free, statics)
    )
    spare = np.swapaxes(turned, -1, -2)[..., FREEDOMS:, :]
    apart = np.full((*known.shape, SPRINGS), np.nan)
    spare = np.broadcast_to(spare, (*known.shape, *spare.shape[-2:]))[known]
    apart[known] = _least(Chain(stiffness, play, free, balancing, spare))
    moved = (holds @ (apart + of.free)[..., np.newaxis])[..., 0]
    return Balance(moved, carried(of, apart))


class Chain(NamedTuple):
    """The springs of m presses (m, 16), tensions that balance the loads (m, 16), two that balance none (m, 2, 16)."""

    stiffness: Array
    play: Array
    free: Array
    statics: Array
    spare: Array


def _least(of: Chain) -> Array:
    """How much longer than free each spring is (m, 16) where the energy is least.

    Newton's method on the linear pieces of the springs, each step ending where the energy is least on it. The energy is
    convex and quadratic in pieces: with the pieces known, one step is exact.
    """
    apart = _on_pieces(of, np.ones(of.play.shape), taut=True)
    left = np.arange(len(apart))
    for _ in range(MOST_ROUNDS):
        if not left.size:
            break
        part, here = Chain(*(array[left] for array in of)), apart[left]
        piece = _piece(part, here)
        there = _on_pieces(part, piece)
        exact = (_piece(part, there) == piece).all(axis=-1)
        over = np.flatnonzero(~exact & (_left_over(part, there, there - here) > 0.0))
        if over.size:
            short = _share(Chain(*(array[over] for array in part)), here[over], there[over] - here[over])
            there[over] = here[over] + short[:, np.newaxis] * (there[over] - here[over])
        apart[left] = there
        left = left[~exact]
    apart[left] = np.nan
    return apart


def _piece(of: Chain, apart: Array) -> Array:
    """Whether a spring is within its play, 0, or beyond it, 1 or -1 by its sense; without play it always carries, 1."""
    return np.where(of.play > 0.0, np.sign(apart) * (np.abs(apart) > of.play), 1.0)


def _on_pieces(of: Chain, piece: Array, *, taut: bool = False) -> Array:
    """The extensions if every spring were on this piece: two equations for what balances no load."""
    soft = np.where(piece == 0.0, 1.0 / FILM, 1.0) / of.stiffness
    shift = np.zeros(piece.shape) if taut else piece * (1.0 - FILM) * of.play
    gap = (of.spare @ (soft * of.statics + shift + of.free)[..., np.newaxis])[..., 0]
    yielding = of.spare * soft[:, np.newaxis, :]
    first, mixed, second = (
        (yielding[:, row] * of.spare[:, column]).sum(axis=-1) for row, column in ((0, 0), (0, 1), (1, 1))
    )
    shares = np.stack([mixed * gap[:, 1] - second * gap[:, 0], mixed * gap[:, 0] - first * gap[:, 1]], axis=-1)
    shares = shares / (first * second - mixed * mixed)[:, np.newaxis]
    return np.asarray(soft * (of.statics + (shares[:, np.newaxis, :] @ of.spare)[:, 0]) + shift)


def _left_over(of: Chain, apart: Array, longer: Array) -> Array:
    """The slope of the energy along a step: what springs that are so far apart take up, less what loads give (m,)."""
    return np.asarray((longer * (carried(of, apart) - of.statics)).sum(axis=-1))


def _share(of: Chain, apart: Array, longer: Array) -> Array:
    """The share of a step that goes too far at which the energy is least on it (m,).

    The slope of the energy grows along the step, straight between the shares at which a spring enters or leaves its
    play: within it, it grows by less.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        reached = np.nan_to_num(np.stack([(of.play - apart) / longer, (-of.play - apart) / longer]), nan=1.0)
    reached = np.clip(np.concatenate([reached.min(axis=0), reached.max(axis=0)], axis=-1), 0.0, 1.0)
    growth = of.stiffness * longer * longer
    order = np.argsort(reached, axis=-1)
    ends = np.zeros((len(apart), 1)), np.ones((len(apart), 1))
    shares = np.concatenate([ends[0], np.take_along_axis(reached, order, axis=-1), ends[1]], axis=-1)
    less = np.take_along_axis((1.0 - FILM) * np.concatenate([-growth, growth], axis=-1), order, axis=-1)
    rates = np.cumsum(np.concatenate([growth.sum(axis=-1, keepdims=True), less], axis=-1), axis=-1)
    slopes = _left_over(of, apart, longer)[:, np.newaxis] + np.cumsum(rates * np.diff(shares), axis=-1)
    rows, last = np.arange(len(apart)), np.argmax(slopes >= 0.0, axis=-1)
    least = shares[rows, last + 1] - slopes[rows, last] / rates[rows, last]
    return np.where(slopes[:, -1] > 0.0, np.clip(least, 0.0, 1.0), 1.0)


# The calculation itself


def _standing(angle: Array) -> CrankCourse:
    """Cranks that stand at these angles."""
    return CrankCourse(angle, np.zeros(np.shape(angle)), np.zeros(np.shape(angle)))


def at_angles(press: LoadedPress, crank: CrankCourse, force: Float, offset: Float) -> tuple[Half, Balance]:
    """The press in equilibrium under this force at these crank angles; and its nominal position."""
    half = half_at(press, crank.angle)
    of = springs(press, half)
    side = side_motion(press, half)
    load = loads(press, side, crank, force, offset)
    return half, balanced(of, _stacked(load, FREEDOMS))


def lifted(press: LoadedPress, balance: Balance, force: Float) -> Array:
    """How much higher the slider is over the bolster: displaced, and the bolster by columns and by heat."""
    frame = press.expansion * press.frame_rise * press.bolster_depth
    return np.asarray(-balance.moved[..., SLIDER + 1] + force / press.column_stiffness + frame)


def inclined(press: LoadedPress, balance: Balance, moment: Float) -> Array:
    """The tilt of the slider to the bolster: displaced, and the columns stretched unevenly."""
    columns = press.column_stiffness * press.column_half_distance**2
    return np.asarray(balance.moved[..., SLIDER + 2] - moment / columns)


def press_under_load(given: LoadedPress) -> LoadedAnswers:
    """The press over the times and in its acceptance test. Floats are numbers or (n,); series (k,)."""
    press = replace(in_columns(given), acceptance_angle=given.acceptance_angle)
    crank = course(press)
    force, count = press_force(press, crank.angle), np.shape(crank.angle)[-1]
    test, rated, beside = acceptance(press)
    half, balance = at_angles(
        press,
        CrankCourse(*(_in_a_row(*parts) for parts in zip(crank, _standing(test), strict=True))),
        _in_a_row(np.broadcast_to(force, np.shape(crank.angle)), rated),
        _in_a_row(press.load_offset + np.zeros(count), beside),
    )
    face = np.asarray(half.face)
    return LoadedAnswers(
        time=np.atleast_1d(given.times),
        crank_angle=crank.angle,
        press_force=force,
        slider_position=face[..., :count],
        **of_the_stroke(press, np.asarray(half.upper.sine)[..., :count], balance.within(slice(count)), force),
        **tested(press, face[..., count:], balance.within(slice(count, None)), rated, beside),
        total_clearance=clearance(press, half)[..., count],
    )


def _in_a_row(one: Float, other: Float) -> Array:
    """Values at some positions and then those at others, (k,) or (n, k), for as many machines as either has."""
    machines = np.broadcast_shapes(np.shape(one)[:-1], np.shape(other)[:-1])
    parts = [np.broadcast_to(part, (*machines, np.shape(part)[-1])) for part in (one, other)]
    return np.concatenate(parts, axis=-1)


def of_the_stroke(press: LoadedPress, upright: Array, balance: Balance, force: Float) -> dict[str, Float]:
    """What is read over the times by the names of the results, and the largest of it.

    ``upright`` is the sine of the upper knee link: a link that is pressed pushes the frame at M up by it.
    """
    pushed = -balance.tension
    raised = upright / press.ground_stiffness_vertical
    tilt = inclined(press, balance, force * press.load_offset)
    guides = [-pushed[..., guide] for guide in SLIDER_GUIDES]
    largest = np.maximum(*(np.max(np.abs(guide), axis=-1) for guide in guides))
    return {
        "deflection": lifted(press, balance, force),
        "slider_tilt": tilt,
        "slider_shift": balance.moved[..., SLIDER],
        "platform_tilt": balance.moved[..., PLATFORM + 2],
        "upper_guide_force": guides[0],
        "lower_guide_force": guides[1],
        "platform_guide_upper": balance.tension[..., PLATFORM_GUIDES[0]],
        "platform_guide_lower": balance.tension[..., PLATFORM_GUIDES[1]],
        "ground_rise_1": pushed[..., UPPERS[1]] * raised,
        "ground_rise_2": pushed[..., UPPERS[2]] * raised,
        "lower_link_1": pushed[..., LOWERS[1]],
        "lower_link_2": pushed[..., LOWERS[2]],
        "upper_link_1": pushed[..., UPPERS[1]],
        "upper_link_2": pushed[..., UPPERS[2]],
        "rod_1": pushed[..., RODS[1]],
        "rod_2": pushed[..., RODS[2]],
        "largest_guide_force": largest,
        "largest_tilt": np.max(np.abs(tilt), axis=-1),
    }


def acceptance(press: LoadedPress) -> tuple[Array, Array, Array]:
    """Crank angles (k,), forces and offsets (k,) or (n, k) of the test.

    Three at the bottom dead centre, without force, under the rated one in the middle and at its offset; then those of
    the test without force.
    """
    angles = np.atleast_1d(press.acceptance_angle)
    feasible(angles.size > 1, "acceptance_angle: two crank angles or more, or there is no travel to measure over")
    none = np.zeros(angles.size)
    rated, beside = np.concatenate([[0.0, 1.0, 1.0], none]), np.concatenate([[0.0, 0.0, 1.0], none])
    return np.concatenate([np.zeros(3), angles]), rated * press.rated_force, beside * press.rated_offset


def tested(press: LoadedPress, face: Array, balance: Balance, force: Array, offset: Array) -> dict[str, Float]:
    """What the acceptance test shows by the names of the results; ``face`` is the height of the rigid slider."""
    height, tilt = lifted(press, balance, force), inclined(press, balance, force * offset)
    deflection, slope = height[..., 1] - height[..., 0], np.abs(tilt[..., 2] - tilt[..., 1])
    free = slice(3, None)
    leaning = balance.moved[..., free, SLIDER + 2]
    aside = balance.moved[..., free, SLIDER] - leaning * press.face_depth
    return {
        "rated_deflection": deflection,
        "press_stiffness": _flat(press.rated_force) / deflection,
        "rated_slope": slope,
        "tilt_stiffness": _flat(press.rated_force * press.rated_offset) / slope,
        "parallelism": _more(np.max(np.abs(leaning), axis=-1)) * _flat(press.face_width),
        "squareness": _more(np.ptp(aside, axis=-1)) / np.ptp(face[..., free], axis=-1),
    }


def _more(size: Array) -> Array:
    """A size, 0 where it is nothing but rounding: an even press tilts by 1e-17."""
    return np.where(size < ROUNDING, 0.0, size)


def _flat(value: Float) -> Float:
    """A column (n, 1) as (n,), a number as it is."""
    return np.reshape(value, -1) if np.ndim(value) else value


def clearance(press: LoadedPress, half: Half) -> Array:
    """How far the slider falls when its load reverses: the play of each link times its force per force, both ways."""
    face = face_sensitivities(half)
    links = sum(np.abs(face[kind]) for kind in KNEE) + np.abs(face["platform_arm"] / half.rod.sine)
    return np.asarray(2.0 * JOINTS * press.joint_play * links)
