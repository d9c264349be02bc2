"""Which tolerances of all 29 sources does a press need that keeps its limits over a working stroke, not at one angle?

Every kind of error has one band for both sides and a price in inverse proportion to it (the paper's law), joints and
slider included. To first order, with w the full bands, the variances of position and tilt at an angle are sums of
(derivative w/6)^2. The cost sum p/w is least where both limits keep their probability at every angle: convex in ln w.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from scipy.special import ndtri

from press_linkage.errors import ARM, KINDS, POLAR_ANGLES, SOURCES, derivatives, permitted_tilt, source
from press_linkage.kinematics import nominal, solve
from press_linkage.quantities import Press, PressSide
from truing import Array, Bench, Block, Outcome, Table, Words

EVERY = (*KINDS, "platform_arm")
SIGMAS = 6.0  # standard deviations in a band, as in the paper
NO_BAND = 2e-4  # rad: band of a crank angle that has no tolerance, ±0.1 mrad
NARROWINGS, REACHED = 50, 1e-9
"""Rounds until all angles are kept together, to this share of the limit; one where no band meets the tightest."""
MISSED = 0.02  # of machines, by which a goal is called missed: shares of 10 000 draws scatter by a quarter of it
LIMITS = ("position", "tilt")
ARMS = {
    "slider_joint_angle": "slider_half_width", "crank_pivot_angle": "crank_pivot_radius",
    "platform_joint_angle": "platform_half_width", "ground_pivot_angle": "ground_pivot_radius",
    "crank_angle": "crank_radius",
}  # fmt: skip
"""Radius at which an error across is a length; it is priced as that."""


@dataclass(frozen=True, kw_only=True)
class OverTheStroke:
    """Buy the bands of all 29 sources at least cost, at the dead centre alone and over a working stroke.

    Angles in degrees from the bottom dead centre; ``joint_price`` of a joint or the crank angle, that of a link of the
    same band being 1; bands lie between ``tightest`` and ``widest`` times those in force in the reading ``complete``.
    Both designs are verified by ``draws`` machines on the exact position, at all angles together.
    """

    first: float = -30.0
    last: float = 10.0
    points: int = 21
    joint_price: float = 1.0
    tightest: float = 0.05
    widest: float = 4.0
    draws: int = 10_000
    name: str = "over_the_stroke"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "StrokeBands":
        """Design for the dead centre and for the stroke, and draw machines of each."""
        press: Press = replace(nominal(bench.setup.inputs), reading="complete")
        in_force = replace(bench.setup, inputs=replace(bench.setup.inputs, reading="complete")).distributions()
        bands = np.array([next(iter(in_force[kind].values())).width if kind in in_force else NO_BAND for kind in EVERY])
        lengths = np.array([getattr(press, ARMS[kind]) if kind in ARMS else 1.0 for kind in EVERY])
        links = {"crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length",
                 "platform_arm"}  # fmt: skip
        prices = np.array([1.0 if kind in links else self.joint_price for kind in EVERY]) / (1e3 * lengths)
        angles = np.radians(np.linspace(self.first, self.last, self.points))
        goals = {"position": press.position_goal, "tilt": press.tilt_goal}
        limits = {"position": press.position_limit, "tilt": permitted_tilt(press)}
        rng = np.random.default_rng(bench.setup.seed)
        told = bench.part(self.name, 0.0, 1.0)
        designs: dict[str, Array] = {"in force": bands}
        for step, (title, at) in enumerate((("dead centre", np.zeros(1)), ("stroke", angles))):
            slopes = {of: relative(press, at, of) / float(limits[of]) for of in LIMITS}
            wide = cheapest(slopes, goals, prices, (self.tightest * bands, self.widest * bands))
            drawn = rng.standard_normal((self.draws, len(SOURCES)))
            designs[title] = together(slopes, goals, wide, self.tightest * bands, drawn)
            told(step + 1, 4)
        drawn = rng.standard_normal((self.draws, len(SOURCES)))
        chances = {title: kept(press, angles, band, limits, drawn) for title, band in designs.items()}
        told(4, 4)
        return StrokeBands(
            bands=designs,
            lengths=lengths,
            costs={title: float((prices / band).sum()) for title, band in designs.items()},
            chances=chances,
            goals=goals,
            span=(self.first, self.last),
        )


def relative(press: Press, angles: Array, of: str) -> Array:
    """Derivatives (angles, 29) of position or tilt, in the order of ``SOURCES``."""
    found = getattr(derivatives(press, solve(press, angles)), of)
    return np.stack([np.broadcast_to(found[name], angles.shape) for name in SOURCES], axis=-1)


def of_sources(values: Array) -> Array:
    """What holds for each kind (15,), for each of the 29 sources."""
    by_kind = dict(zip(EVERY, values, strict=True))
    sides = [by_kind[kind] for side in (1, 2) for kind in KINDS]
    return np.array([*sides, by_kind["platform_arm"]])


def of_kinds(squares: Array) -> Array:
    """The sum over the sources of each kind, along the last axis: (..., 29) to (..., 15)."""
    at = {name: place for place, name in enumerate(SOURCES)}
    columns = [[at[source(kind, side)] for side in (1, 2)] for kind in KINDS]
    return np.stack([squares[..., own].sum(axis=-1) for own in (*columns, [at[ARM]])], axis=-1)


def cheapest(
    slopes: Mapping[str, Array], goals: Mapping[str, Any], prices: Array, bounds: tuple[Array, Array]
) -> Array:
    """The bands (15,) of least cost with which each limit keeps its probability at every angle, to first order.

    ``slopes`` are derivatives per limit (angles, 29). Where the tightest bands do not do, these come back.
    """
    rows = [of_kinds((slopes[of] / SIGMAS) ** 2) * float(ndtri(0.5 + 0.5 * goals[of])) ** 2 for of in slopes]
    weights = np.concatenate(rows)  # times the squares of the bands: at most 1
    low, high = bounds
    if np.max(weights @ low**2) > 1.0:
        return low
    scale = min(1.0, float(1.0 / np.sqrt(np.max(weights @ high**2))))
    begin = np.clip(np.log(high * scale), np.log(low), np.log(high))
    worth = float((prices / high).sum())
    limit = {
        "type": "ineq", "fun": lambda y: 1.0 - weights @ np.exp(2 * y), "jac": lambda y: -2.0 * weights * np.exp(2 * y),
    }  # fmt: skip
    told: dict[str, Any] = {
        "jac": lambda y: -prices * np.exp(-y) / worth, "bounds": scipy.optimize.Bounds(np.log(low), np.log(high)),
        "method": "SLSQP", "options": {"maxiter": 500, "ftol": 1e-12}, "constraints": limit,
    }  # fmt: skip

    def cost(logarithms: Array) -> float:
        return float((prices * np.exp(-logarithms)).sum()) / worth

    found = scipy.optimize.minimize(cost, begin, **told)
    bands = np.exp(found.x)
    return np.asarray(bands / max(1.0, float(np.sqrt(np.max(weights @ bands**2)))))


def together(
    slopes: Mapping[str, Array], goals: Mapping[str, Any], bands: Array, tightest: Array, normal: Array
) -> Array:
    """These bands, narrowed by one factor until each limit keeps its probability at all angles together.

    Errors grow with the bands, so the factor is the quantile of the largest error over the stroke. A band that meets
    the ``tightest`` stays there, and the others make up for it while they can. ``normal`` (n, 29).
    """
    narrowed = np.maximum(bands, tightest)
    for _ in range(NARROWINGS):
        errors = normal * (of_sources(narrowed) / SIGMAS)
        worst = max(
            float(np.quantile(np.max(np.abs(errors @ slopes[of].T), axis=-1), float(goals[of]))) for of in slopes
        )
        if worst <= 1.0 + REACHED or np.all(narrowed <= tightest):
            break
        narrowed = np.maximum(narrowed / worst, tightest)
    return narrowed


def kept(
    press: Press, angles: Array, bands: Array, limits: Mapping[str, Any], normal: Array
) -> dict[str, tuple[float, float]]:
    """The share of machines within each limit: at the dead centre, and at all angles; exact position."""
    off = normal * (of_sources(bands) / SIGMAS)
    sides = [
        PressSide(**{f"{kind}_deviation": off[:, side * len(KINDS) + place] for place, kind in enumerate(KINDS)})
        for side in (0, 1)
    ]
    machines = replace(press, side_1=sides[0], side_2=sides[1], platform_arm_deviation=off[:, -1])
    within = {of: np.ones(len(normal), dtype=bool) for of in LIMITS}
    shares: dict[str, list[float]] = {of: [] for of in LIMITS}
    for angle in (0.0, *angles):
        there, right = solve(machines, angle), solve(press, angle)
        missed = {"position": there.slider_position - right.slider_position, "tilt": there.slider_tilt}
        for of in LIMITS:
            fits = np.abs(missed[of]) <= limits[of]
            if not shares[of]:
                shares[of].append(float(fits.mean()))
                continue
            within[of] &= fits
    return {of: (shares[of][0], float(within[of].mean())) for of in LIMITS}


@dataclass(frozen=True)
class StrokeBands(Outcome):
    """The bands of each design (15,), m or rad; their cost, 1/mm; and the shares of machines that keep the limits."""

    bands: Mapping[str, Array]
    lengths: Array
    costs: Mapping[str, float]
    chances: Mapping[str, Mapping[str, tuple[float, float]]]
    goals: Mapping[str, Any]
    span: tuple[float, float]

    def as_json(self) -> dict[str, Any]:
        """Return bands in mm (errors across at their radius), costs and shares of each design."""
        return {
            title: {
                "bands": {kind: float(band) for kind, band in zip(EVERY, 1e3 * bands * self.lengths, strict=True)},
                "cost": self.costs[title],
                "kept": {
                    of: {"dead_centre": shares[0], "stroke": shares[1]} for of, shares in self.chances[title].items()
                },
            }
            for title, bands in self.bands.items()
        }

    def shown(self) -> list[Block]:
        """Return the designs side by side, and what each keeps."""
        titles = tuple(self.bands)
        order = np.argsort(self.bands["stroke"] * self.lengths)
        rows: list[tuple[str | int | float | bool, ...]] = [
            (
                EVERY[place].replace("_", " ") + (", across" if EVERY[place] in POLAR_ANGLES else ""),
                *(1e3 * float(self.bands[title][place] * self.lengths[place]) for title in titles),
            )
            for place in order
        ]
        bands = Table(
            "Bands at least cost", ("error, one band for both sides", *titles), rows, ("", *("mm" for _ in titles)),
            "Least cost with each limit kept at each angle, then narrowed by one factor until it is kept at all "
            "together. Errors across a radius and of the crank angle as lengths at that radius; the crank angle is "
            "±0.1 mrad where it has no tolerance.",
        )  # fmt: skip
        told: list[tuple[str | int | float | bool, ...]] = [
            (title, self.costs[title], *(100 * share for of in LIMITS for share in self.chances[title][of]))
            for title in titles
        ]
        columns = ("design", "cost", *(f"{of}, {where}" for of in LIMITS for where in ("dead centre", "stroke")))
        wanted = " and ".join(f"{100 * float(self.goals[of]):.4g} % for {of}" for of in LIMITS)
        shares = Table(
            "What each design keeps", columns, told, ("", "1/mm", "%", "%", "%", "%"),
            f"Machines on the exact position, at the dead centre and at every angle from {self.span[0]:g}° to "
            f"{self.span[1]:g}° together. Goals: {wanted}.",
        )  # fmt: skip
        missed = [of for of in LIMITS if self.chances["stroke"][of][1] < float(self.goals[of]) - MISSED]
        blocks: list[Block] = [bands, shares]
        if missed:
            text = f"The tightest bands do not reach the goal of {' and '.join(missed)} over this stroke."
            blocks.insert(0, Words(text, "finding"))
        return blocks
