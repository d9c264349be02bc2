"""The threads of a roller between screw and nut: how they share the axial load, how stiff they are, how long they last.

Every thread of a roller is one Hertzian contact with the screw and one with the nut; screw, roller and nut are bars
between neighbouring threads. Flanks of screw and nut are straight, that of the roller is an arc. Valid for elastic
contact and rollers that are alike; what the lead angle does to the curvatures (cos² of it, 1 % at 6°), the tilt of the
rollers and the widening of the nut are left out.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import ellipe, ellipkm1

from roller_screw_shift.quantities import Pair
from truing import Array, Float, either

# One contact: an ellipse of Hertz. Reference: Johnson, Contact Mechanics (1985), 4.24 to 4.26

ROUND = 1e-6  # of 1 - (b/a)²: below it the ellipse is a circle
AXIS_STEPS = 30


@dataclass(frozen=True, kw_only=True)
class Ellipse:
    """Approach over Q^(2/3), m/N^(2/3), and largest pressure over Q^(1/3), Pa/N^(1/3), of a normal force Q."""

    approach: Float
    pressure: Float


def ellipse(one: Float, other: Float, modulus: Float) -> Ellipse:
    """Return the contact of two principal relative curvatures, 1/m, above 0; ``modulus`` is E* of both, Pa.

    With A and B half the curvatures, A <= B, and k = b/a: B/A = (E/k² - K)/(K - E), b³ = 3 Q k E/(2 pi E* (A + B)),
    p = 3 Q k/(2 pi b²) and an approach of p b K/E*, K and E of the modulus sqrt(1 - k²).
    """
    ratio, total = np.maximum(one, other) / np.minimum(one, other), 0.5 * (one + other)
    axes = ratio ** (-2.0 / 3.0)
    for _ in range(AXIS_STEPS):
        flat = np.where(1.0 - axes**2 > ROUND, axes, 0.5)
        first, second = ellipkm1(flat**2), ellipe(1.0 - flat**2)
        better = flat * ((second / flat**2 - first) / (first - second) / ratio) ** (2.0 / 3.0)
        axes = np.where(1.0 - axes**2 > ROUND, np.minimum(better, 1.0), axes)
    first, second = ellipkm1(axes**2), ellipe(1.0 - axes**2)
    width = np.cbrt(3.0 * axes * second / (2.0 * np.pi * modulus * total))  # b over Q^(1/3)
    pressure = 3.0 * axes / (2.0 * np.pi * width**2)
    return Ellipse(approach=pressure * width * first / modulus, pressure=pressure)


# How the threads share the load: bars with springs between them, solved for all samples at once

FIELDS = (
    "axial_load", "rollers", "screw_diameter", "roller_diameter", "nut_diameter", "lead", "starts", "contact_angle",
    "profile_radius", "screw_bore", "nut_outside", "elastic_modulus", "poisson", "thread_compliance",
    "roller_pitch_deviation",
)  # fmt: skip
LEAST_LOAD = 1e-3  # N, of an idle screw: even that touches somewhere
NEWTON_STEPS, CONVERGED = 60, 1e-11
LOOSE = 1e-9  # of the stiffness under the mean load: what is left of a contact that is open
ROOT_STEPS = 12
WEAKEST = 10.0 / 3.0  # three times the slope of Weibull's distribution of lives, 10/9


@dataclass(frozen=True, kw_only=True)
class Sharing:
    """What the threads do under the load; SI, numbers or arrays (n,).

    ``screw`` and ``nut`` are the loads of each thread over their mean, (threads,) or (n, threads), from the loaded end.
    """

    screw: Array
    nut: Array
    deflection: Float
    stiffness: Float
    pressure_screw: Float
    pressure_nut: Float
    life_factor_screw: Float
    life_factor_nut: Float


def nut_diameter(pair: Pair) -> Float:
    """Return the pitch diameter of the thread of the nut: as stated, or the one that fits screw and rollers."""
    return either(pair.nut_diameter, pair.screw_diameter + 2.0 * pair.roller_diameter)


def sharing_of(pair: Pair) -> Sharing:
    """Return how the threads share the load; samples that are alike are solved once."""
    values = {name: getattr(pair, name) for name in FIELDS} | {"nut_diameter": nut_diameter(pair)}
    values["profile_radius"] = either(
        pair.profile_radius, 0.5 * np.asarray(pair.roller_diameter) / np.cos(pair.contact_angle)
    )
    columns = np.broadcast_arrays(*(np.asarray(values[name], dtype=float) for name in FIELDS))
    shape = columns[0].shape
    rows, place = np.unique(np.stack([column.ravel() for column in columns], axis=-1), axis=0, return_inverse=True)
    solved = _solved(rows.tobytes(), int(pair.thread_turns), pair.support == "far_side")
    return Sharing(**{
        name: value[place.ravel()].reshape(shape + value.shape[1:]) for name, value in vars(solved).items()
    })  # fmt: skip


@lru_cache(maxsize=64)
def _solved(rows: bytes, count: int, far: bool) -> Sharing:
    """Return the sharing of rows of FIELDS, each an array (m,) or (m, threads); NaN where there are no such bodies."""
    given = np.frombuffer(rows).reshape(-1, len(FIELDS))
    at = dict(zip(FIELDS, given.T, strict=True))
    fine = np.isfinite(given).all(axis=1) & (at["screw_bore"] < at["screw_diameter"])
    fine &= (at["roller_diameter"] < at["nut_diameter"]) & (at["nut_diameter"] < at["nut_outside"])
    found = _shared({name: column[fine] for name, column in at.items()}, count, far)
    whole = {name: np.full((len(given), *value.shape[1:]), np.nan) for name, value in vars(found).items()}
    for name, value in vars(found).items():
        whole[name][fine] = value
    return Sharing(**whole)


def _shared(at: Mapping[str, Array], count: int, far: bool) -> Sharing:
    pitch, load = at["lead"] / at["starts"], np.maximum(np.abs(at["axial_load"]), LEAST_LOAD) / at["rollers"]
    cosine = np.cos(at["contact_angle"])
    along = np.sin(at["contact_angle"]) * np.cos(np.arctan(at["lead"] / (np.pi * at["screw_diameter"])))
    modulus = at["elastic_modulus"] / (2.0 * (1.0 - at["poisson"] ** 2))
    around = {"screw": 1.0 / at["roller_diameter"] + 1.0 / at["screw_diameter"],
              "nut": 1.0 / at["roller_diameter"] - 1.0 / at["nut_diameter"]}  # fmt: skip
    spots = [ellipse(1.0 / at["profile_radius"], 2.0 * cosine * bent, modulus) for bent in around.values()]
    hertz = np.stack([spot.approach for spot in spots], axis=-1) / along[:, None] ** (5.0 / 3.0)  # axial, axial force
    areas = np.stack([(at["screw_diameter"] ** 2 - at["screw_bore"] ** 2) / at["rollers"], at["roller_diameter"] ** 2,
                      (at["nut_outside"] ** 2 - at["nut_diameter"] ** 2) / at["rollers"]], axis=-1)  # fmt: skip
    bars = 0.25 * np.pi * areas * (at["elastic_modulus"] / pitch)[:, None]
    ahead = at["roller_pitch_deviation"][:, None] * (np.arange(count) - 0.5 * (count - 1))
    forces, way = ladder(load, bars, hertz, at["thread_compliance"], ahead, far=far)
    way = way + 2.0 * np.abs(ahead[:, 0])  # counted from where the first threads touch
    peak = (forces.max(axis=1) / along[:, None]) ** (1.0 / 3.0)
    shares = forces * count / load[:, None, None]
    alike = np.mean(shares**WEAKEST, axis=1) ** (1.0 / WEAKEST)
    return Sharing(
        screw=shares[:, :, 0], nut=shares[:, :, 1], life_factor_screw=alike[:, 0], life_factor_nut=alike[:, 1],
        deflection=np.where(at["axial_load"] == 0.0, 0.0, way), stiffness=load * at["rollers"] / way,
        pressure_screw=spots[0].pressure * peak[:, 0], pressure_nut=spots[1].pressure * peak[:, 1],
    )  # fmt: skip


def spring(way: Array, hertz: Array, soft: Array) -> tuple[Array, Array]:
    """Return force and stiffness of a contact pressed by ``way`` = hertz F^(2/3) + soft F; 0 where it is open."""
    pressed = np.maximum(way, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.fmin(np.sqrt(pressed / hertz), np.where(soft > 0.0, np.cbrt(pressed / soft), np.inf))
    for _ in range(ROOT_STEPS):  # cubic in F^(1/3), from above
        slope = root * (2.0 * hertz + 3.0 * soft * root)
        root = root - np.divide(root**2 * (hertz + soft * root) - pressed, slope, out=np.zeros_like(root),
                                where=slope > 0.0)  # fmt: skip
    stiffness = 3.0 * root / (2.0 * hertz + 3.0 * soft * root)
    return root**3, stiffness


def ladder(
    load: Array, bars: Array, hertz: Array, soft: Array, ahead: Array, *, far: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return axial forces of the threads (m, threads, 2), on the side of the screw and of the nut, and the way (m,).

    Of m rollers: ``load`` (m,) on the screw at its first thread, ``bars`` (m, 3) of screw, roller and nut from thread
    to thread, N/m, ``hertz`` (m, 2), ``soft`` (m,), and by how much each thread of the roller stands ``ahead``
    (m, threads). The nut is held at its first thread, or at its last one where it is ``far``. Newton's method on the
    ways of all nodes; the matrix of all rollers is one band. The nut is held by a spring, whose way is taken off.
    """
    rollers, count = ahead.shape
    soft, hertz = soft[:, None, None], hertz[:, None, :]
    mean = (load / count)[:, None, None]
    slack = np.stack([-ahead, ahead], axis=-1)
    stiffness = np.broadcast_to(mean ** (1.0 / 3.0) / (hertz + soft * mean ** (1.0 / 3.0)), (rollers, count, 2))
    least, held = LOOSE * stiffness, (count - 1) if far else 0
    outer = np.zeros((rollers, count, 3))
    outer[:, 0, 0] = load
    # first step: springs as under the mean load, without the deviations of the pitch
    nodes = _solve(stiffness, bars, outer, held)
    for _ in range(NEWTON_STEPS):
        forces, stiffness = spring(-np.diff(nodes, axis=2) + slack, hertz, soft)
        step = _solve(stiffness + least, bars, outer - _inner(nodes, forces, bars, held), held)
        nodes = nodes + step
        if np.all(np.abs(step).max(axis=(1, 2)) <= CONVERGED * np.abs(nodes).max(axis=(1, 2))):
            break
    forces, _ = spring(-np.diff(nodes, axis=2) + slack, hertz, soft)
    settled = np.abs(forces.sum(axis=1) - load[:, None]).max(axis=1) < 1e-6 * load
    return np.where(settled[:, None, None], forces, np.nan), np.where(
        settled, nodes[:, 0, 0] - nodes[:, held, 2], np.nan
    )


def _inner(nodes: Array, forces: Array, bars: Array, held: int) -> Array:
    """Return what bars, threads and the ground take of each node, (m, threads, 3)."""
    pulled = np.zeros_like(nodes)
    between = np.diff(nodes, axis=1) * bars[:, None, :]
    pulled[:, :-1] -= between
    pulled[:, 1:] += between
    pulled[:, :, :2] += forces
    pulled[:, :, 1:] -= forces
    pulled[:, held, 2] += bars[:, 2] * nodes[:, held, 2]
    return pulled


def _solve(stiffness: Array, bars: Array, outer: Array, held: int) -> NDArray[np.float64]:
    """Return the ways of all nodes under the outer forces, both (m, threads, 3): one band for all rollers."""
    band = np.zeros((4, *outer.shape))
    diagonal = band[3]
    diagonal[:, :-1] += bars[:, None, :]
    diagonal[:, 1:] += bars[:, None, :]
    diagonal[:, :, :2] += stiffness
    diagonal[:, :, 1:] += stiffness
    diagonal[:, held, 2] += bars[:, 2]
    band[2][:, :, 1:] = -stiffness
    band[0][:, 1:] = -bars[:, None, :]
    solved = scipy.linalg.solveh_banded(band.reshape(4, -1), outer.ravel(), check_finite=False)
    return np.asarray(solved.reshape(outer.shape))


# How long they last: the rating of thrust ball bearings, on which ISO 3408-5 builds for ball screws, by analogy. A
# thread of a roller is a ball about its axis, on straight flanks, so that no groove raises the rating

LARGE_BALL = 25.4  # mm; beyond it the rating grows with D^1.4
OF_ROWS, OF_TURNS = 0.7, 0.86  # exponents of rows: of ISO 281 and the weakest link; of turns of a ball screw, as quoted


def life_of(pair: Pair, shared: Sharing) -> dict[str, Float]:
    """Return ratings of one thread of all rollers and of all threads, N, and the life in turns of the screw.

    C_s = 88.2 (1 - sin(beta)/3) gamma^0.3 (1 - gamma)^1.39 (1 + gamma)^(-1/3) cos(beta)^0.7 n_r^(2/3) D^1.8 tan(beta)
    cos(lambda) with N and mm, and n_t^0.7 for the threads as for rows: n_t times the load at n_t^(-3/10) of the life's
    cube root, by the weakest link with slope 10/9. Source: Lundberg and Palmgren as in ISO 281; with grooves of 0.535 D
    it gives the factors printed for thrust ball bearings. No standard rates roller screws; ball screws are said to be
    rated with the power 0.86 of their turns.
    """
    beta, gamma = pair.contact_angle, pair.roller_diameter / (pair.screw_diameter + pair.roller_diameter)
    ball = 1e3 * pair.roller_diameter / np.cos(beta)  # mm
    size = np.where(ball > LARGE_BALL, 3.647 * ball**1.4, ball**1.8)
    lead = np.cos(np.arctan(pair.lead / (np.pi * pair.screw_diameter)))
    factor = 88.2 * (1.0 - np.sin(beta) / 3.0) * gamma**0.3 * (1.0 - gamma) ** 1.39 / np.cbrt(1.0 + gamma)
    screw = factor * np.cos(beta) ** 0.7 * pair.rollers ** (2.0 / 3.0) * size * np.tan(beta) * lead
    nut = screw * ((1.0 + gamma) / (1.0 - gamma)) ** 1.72
    turns, load = pair.thread_turns**OF_ROWS, np.maximum(np.abs(pair.axial_load), LEAST_LOAD)

    def both(of_screw: Float, of_nut: Float) -> Float:
        """Return the rating of all contacts, those of either side loaded so many times as much as alike."""
        weak = (of_screw / screw) ** WEAKEST + (of_nut / nut) ** WEAKEST
        rating: Float = turns * weak ** (-1.0 / WEAKEST)
        return rating

    rating = both(1.0, 1.0)
    return {
        "curvature_ratio": gamma, "ball_diameter": 1e-3 * ball, "screw_rating": screw, "nut_rating": nut,
        "dynamic_rating": rating, "ball_screw_rating": rating * pair.thread_turns ** (OF_TURNS - OF_ROWS),
        "acting_load": load,
        "thread_life": 1e6 * (both(shared.life_factor_screw, shared.life_factor_nut) / load) ** 3,
    }  # fmt: skip
