"""A harmonic drive that rubs, creeps, wears, runs out of round and gets warm: its torsion from mechanics of its own.

Nothing of the plugin is imported. Rough flanks are added up contact by contact on a fine grid (lengths m, forces N),
and the torsion of the mesh is the area below its compliance. Friction is a row of sliders behind springs, creep a row
of dampers, play closes tooth by tooth, runout is the reach of a circle about a point. The cup is a row of rings, the
wave generator a row of balls. Torques N m, angles urad, times h, degC, r/min.
"""

from dataclasses import dataclass
from functools import cache
from math import inf, isfinite
from typing import Any

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq
from scipy.special import ndtr

from hidden_effects.rigs import Bench, Places, Rig, Wish, parted
from hidden_effects.rows import Array, Hidden, MeasuredRows, of

DENSITY, HARDNESS, MODULUS, POISSON = 1.5, 3e9, 206e9, 0.3
RADIUS = 25.4e-3 * np.cos(np.radians(20))  # lever of the normal forces
PAIRS, FIRST_TORQUE = 60, 2e-2
AREA = 10e-3 * 0.4e-3  # of a flank
GRID = 1500


@dataclass(frozen=True)
class Table:
    """Normal load, stiffness and real area of one pair at rising largest contacts."""

    load: Array
    stiffness: Array
    area: Array

    def at(self, load: Array) -> tuple[Array, Array]:
        """Stiffness, N/m, and area, m^2, under loads."""
        place = np.log(np.maximum(load, self.load[0]))
        return (
            np.exp(np.interp(place, np.log(self.load), np.log(self.stiffness))),
            np.exp(np.interp(place, np.log(self.load), np.log(self.area))),
        )


def domain_factor(profile: float) -> float:
    """The factor of the area distribution that keeps the area of all contacts, by halving."""

    def left(psi: float) -> float:
        rest = (2 - profile) / profile
        return float((psi ** ((2 - profile) / 2) - (1 + psi ** (-profile / 2)) ** -rest) / rest - 1)

    return float(brentq(left, 1.0, 50.0, xtol=1e-12))


@cache
def table(dimension: float, roughness: float, modulus: float) -> Table:
    """Add up all contacts of a pair, from those too small to be elastic to the largest."""

    def force(area: Array) -> tuple[Array, Array]:
        depth = (
            2 * roughness ** (dimension - 2) * np.sqrt(np.log(DENSITY)) * (2 * np.sqrt(area / np.pi)) ** (3 - dimension)
        )
        tip = area / (2 * np.pi * depth)
        return 4 / 3 * modulus * np.sqrt(tip) * depth**1.5, 2 * modulus * np.sqrt(tip * depth)

    def excess(logarithm: float) -> float:
        area = np.exp(np.array(logarithm))
        return float(np.log(force(area)[0] / (HARDNESS * area)))

    critical = float(np.exp(brentq(excess, np.log(1e-30), np.log(1e-4))))
    areas = np.geomspace(critical * (1 + 1e-9), 1e-5, GRID)
    elastic, spring = force(areas)
    many = 0.5 * (dimension - 1) * domain_factor(dimension - 1) ** ((3 - dimension) / 2)
    number = many * areas ** (-(dimension + 1) / 2)  # times the largest area to a power
    small = np.geomspace(critical * 1e-30, critical, 4 * GRID)
    plastic = np.trapezoid(HARDNESS * many * small ** ((3 - dimension) / 2), np.log(small))
    all_of_it = np.trapezoid(many * small ** ((3 - dimension) / 2), np.log(small))
    logs, scale = np.log(areas), areas ** ((dimension - 1) / 2)

    def added(what: Array) -> Array:
        return np.asarray(cumulative_trapezoid(what * number * areas, logs, initial=0.0))

    load = scale * (plastic + added(elastic))
    stiffness, area = scale * added(spring), scale * (all_of_it + added(areas))
    return Table(load[1:], stiffness[1:], area[1:])


def shares() -> Array:
    """What each pair carries of the whole: the square of a cosine over two arcs, pairs in the middle of equal parts."""
    half = PAIRS // 2
    places = (2 * np.arange(half) + 1) / half - 1
    weights = np.cos(np.pi * places / 2) ** 2
    return np.asarray(np.concatenate([weights, weights]) / (2 * weights.sum()))


@dataclass(frozen=True)
class Flanks:
    """Roughness and elasticity of both flanks, and what stands beside or behind a pair of them."""

    dimension: float = 2.5
    roughness: float = 1e-9
    modulus: float = MODULUS
    pairs: float = 1.0
    """Pairs over those of the design."""
    film: float = 0.0
    """Modulus of the film times flank over its thickness, N/m, of a mean pair under 25 N m."""
    tooth: float = np.inf

    def stiffness(self, torque: Array) -> Array:
        """Of the mesh, N m/rad."""
        equivalent = self.modulus / (2 * (1 - POISSON**2))
        loads = np.abs(np.atleast_1d(torque))[:, None] * shares() / (RADIUS * self.pairs)
        spring, area = table(self.dimension, self.roughness, equivalent).at(loads)
        thinner = (loads / RADIUS + 1e-12) ** 0.07 / np.mean((25 * shares() / RADIUS**2) ** 0.07)
        spring = spring + self.film * thinner * (1 - area / 2 / AREA)
        return np.asarray(RADIUS**2 * self.pairs * (1 / (1 / spring + 1 / self.tooth)).sum(axis=1))


def torsion_of(compliance: Array, torques: Array) -> Array:
    """Integral of the compliance over a rising torque."""
    return np.asarray(cumulative_trapezoid(compliance, torques, initial=0.0))


@cache
def torques() -> Array:
    """Torques at which the mesh is looked at, from the first one on."""
    return np.geomspace(FIRST_TORQUE, 80.0, 600)


# The drive

TORSION, MESH = "torsion", "mesh_stiffness"
COMPLIANCE = 36.0  # urad/(N m), of all that is in series with the mesh, as the inputs have it
RATED, PITCH, ALPHA = 25.0, 25.4e3, np.radians(20)  # N m, um
SLIDERS = 400
CUP, WALL, RINGS = 24.5e-3, 0.35e-3, 50  # m
BALLS = 23
SCATTER = 0.056  # of asperities, over the film at 1000 rpm: their load falls by e over a fifth of a tenth


@dataclass(frozen=True)
class Body:
    """What gives way beside the flanks: bending of a tooth, N/m, length of the cup, m, the wave generator under 25 N m.

    That one in urad.
    """

    tooth: float = inf
    cup: float = 0.0
    wave: float = 0.0


@dataclass(frozen=True)
class Rows(MeasuredRows):
    """What was set and measured beside the results, arrays (n,), in the order of the clock."""

    torque: Array
    reversal_torque: Array
    peak_torque: Array
    direction: Array
    wave_angle: Array
    temperature: Array
    cycles: Array
    speed: Array


def scale_of(hidden: Hidden, effect: str) -> float:
    """The scale of torque of an effect, N m; the registry has it in parts of that of the size."""
    return RATED * of(hidden, effect, "torque_scale", 1.0)


# The mesh


def flanks_at(row: int, rows: Rows, hidden: Hidden, tooth: float) -> Flanks:
    """The flanks as they are at a row: run in, warm, full of oil."""
    run_in = -np.expm1(-rows.cycles[row] / of(hidden, "asperity_smoothing", "cycle_scale", 1.0))
    warmer = rows.temperature[row] - 20
    softer = of(hidden, "modulus_temperature", "softening") * warmer * (1 + warmer / 2000)
    base = Flanks()
    return Flanks(
        dimension=base.dimension + of(hidden, "asperity_smoothing", "dimension") * run_in,
        roughness=base.roughness * float(np.exp(-of(hidden, "asperity_smoothing", "roughness") * run_in)),
        modulus=base.modulus * (1 - softer),
        film=film(rows.speed[row], warmer, hidden),
        tooth=tooth * (1 - softer),
    )


@cache
def gap(alone: float) -> float:
    """Where film and asperities share the load, over the film at 1000 rpm; alone it would be as thick as given.

    Asperities with a Gaussian height touch as Greenwood and Williamson have it, and hold a tenth without oil; the film
    carries what its wedge does at this gap, in proportion to viscosity times speed.
    """
    above = np.linspace(0, 8, 801)

    def held(wide: float) -> float:
        return float(np.trapezoid(above**1.5 * np.exp(-((above + wide / SCATTER) ** 2) / 2), above))

    def missing(wide: float) -> float:
        return held(wide) / held(0.1) + (alone / wide) ** (1 / 0.67) - 1

    return float(brentq(missing, 0.1, 0.3 + 2 * alone, xtol=1e-14))


def film(speed: float, warmer: float, hidden: Hidden) -> float:
    """Stiffness of the oil in a pair, N/m: of the share of the flank in which it carries."""
    if not speed:
        return 0.0
    viscosity = np.exp(np.interp(warmer, [-20, 0, 20, 40, 60], np.log([2.03, 1.0, 0.495, 0.246, 0.122])))
    alone = float((viscosity * abs(speed) / 1000) ** 0.67)
    wide = gap(alone)
    return of(hidden, "oil_film", "stiffness") * 1e9 * (alone / wide) ** (1 / 0.67) / wide


def engaged(torque: Array, hidden: Hidden) -> Array:
    """Pairs over those at no torque."""
    scale = scale_of(hidden, "engaged_pairs")
    return np.asarray(1 + of(hidden, "engaged_pairs", "gain") * (1 - np.exp(-np.abs(torque) / scale)))


def mesh(rows: Rows, hidden: Hidden, tooth: float) -> tuple[Array, Array]:
    """Stiffness, N m/rad, and torsion, urad, of the mesh at every row."""
    stiffness, torsion = np.zeros(len(rows)), np.zeros(len(rows))
    made: dict[Flanks, tuple[Array, Array]] = {}
    grid = torques()
    number = engaged(grid, hidden)
    for row, torque in enumerate(np.abs(rows.torque)):
        flanks = flanks_at(row, rows, hidden, tooth)
        if flanks not in made:
            curve = number * flanks.stiffness(grid / number)
            made[flanks] = curve, torsion_of(1e6 / curve, grid)
        curve, angle = made[flanks]
        stiffness[row] = np.exp(np.interp(np.log(max(torque, 1e-9)), np.log(grid), np.log(curve)))
        torsion[row] = np.sign(rows.torque[row]) * np.interp(torque, grid, angle, left=0.0)
    return stiffness, torsion


# Cup and wave generator


def cup(length: float, hidden: Hidden) -> float:
    """Twist of the cup, urad/(N m), ring by ring: each a bar with a hole, whose wall is thinner on both sides alike."""
    wall = WALL * (1 - of(hidden, "thin_cup", "lost"))
    shear = MODULUS / (2 * (1 + POISSON))
    twist = 0.0
    for _ in range(RINGS):
        twist += length / RINGS / (shear * np.pi / 2 * ((CUP + wall / 2) ** 4 - (CUP - wall / 2) ** 4))
    return 1e6 * twist


@cache
def balls() -> tuple[Array, Array]:
    """Torque over the way of the race, each in a unit of its own: every ball is closed by its share of it, as Hertz."""
    moved = np.geomspace(1e-4, 20, 20000)
    places = 2 * np.pi * np.arange(BALLS) / BALLS
    closed = np.maximum(np.cos(places), 0.0)
    return np.asarray((moved[:, None] * closed) ** 1.5 @ closed), moved


def pressed_balls(torque: Array, at_rated: float) -> Array:
    """How far the wave generator gives way from the first torque on, urad, if it is ``at_rated`` under 25 N m."""
    force, moved = balls()
    rated = float(np.interp(1.0, moved, force))
    first, size = (
        np.interp(np.maximum(each, FIRST_TORQUE) / RATED * rated, force, moved) for each in (0, np.abs(torque))
    )
    return np.asarray(np.sign(torque) * at_rated * (size - first))


# Angles


def rubbing(rows: Rows, width: Array, scale: float) -> Array:
    """What sliders behind springs hold back of the angle, on a path of torque that begins at rest.

    Sliders let go one after another; they are many, and their number falls with the torque at which they do.
    """
    limits = (np.arange(SLIDERS) + 0.5) / SLIDERS * 6 * scale
    weight = np.exp(-2 * limits / scale)
    weight /= np.sum(weight * limits)
    state, held, before = np.zeros(SLIDERS), np.zeros(len(rows)), 0.0
    for row, turned in enumerate(rows.reversal_torque):
        ways = (turned, rows.torque[row]) if row and turned != rows.reversal_torque[row - 1] else (rows.torque[row],)
        for now in ways:
            state = np.clip(state + now - before, -limits, limits)
            before = now
        held[row] = float(weight @ state)
    return np.asarray(-0.5 * width * held)


def friction(rows: Rows, hidden: Hidden) -> Array:
    """Dry and viscous friction."""
    whole = np.full(len(rows), of(hidden, "hysteresis", "loop"))
    held = rubbing(rows, whole, scale_of(hidden, "hysteresis"))
    thinning = of(hidden, "viscous_hysteresis", "thinning")
    viscosity = np.exp(-thinning * (rows.temperature - 20))
    width = of(hidden, "viscous_hysteresis", "loop") * viscosity * np.abs(rows.speed) / 1000
    return held + rubbing(rows, width, scale_of(hidden, "viscous_hysteresis"))


def play(rows: Rows, hidden: Hidden) -> Array:
    """Gaps, of new and of worn teeth, and of splines that move apart; teeth close one after another."""
    found = np.zeros(len(rows))
    for name, size in (("lost_motion", of(hidden, "lost_motion", "play")), ("flank_wear", 1.0)):
        spread = scale_of(hidden, name)
        closed = 2 * ndtr(np.sqrt(np.pi / 2) * 0.94 * rows.torque / spread) - 1
        found += closed * (worn(rows, hidden) if name == "flank_wear" else size)
    apart = of(hidden, "thermal_preload", "expansion") * 1e-6 * PITCH * (rows.temperature - 20)
    return found + np.sign(rows.torque) * 1e6 * np.arctan(apart * np.tan(ALPHA) / PITCH)


def worn(rows: Rows, hidden: Hidden) -> Array:
    """The gap that both flanks of a pair have gained, as an angle, block of cycles by block."""
    depth = np.zeros(len(rows))
    for _ in range(100):
        depth += of(hidden, "flank_wear", "rate") * rows.cycles / 100 / 1e6
    return np.asarray(1e6 * 2 * depth / (PITCH * np.cos(ALPHA)))


def turning(rows: Rows, hidden: Hidden) -> Array:
    """Waves of the wave generator: a circle beside its centre; lobes with a little of the next even order."""
    angle = np.radians(rows.wave_angle)
    x, y = of(hidden, "eccentricity", "cosine"), of(hidden, "eccentricity", "sine")
    reach = 2e4
    found = np.hypot(reach * np.cos(angle) + x, reach * np.sin(angle) + y) - reach
    cosine, sine = of(hidden, "ellipticity", "cosine"), of(hidden, "ellipticity", "sine")
    lobes = cosine * np.cos(2 * angle) + sine * np.sin(2 * angle)
    return np.asarray(found + lobes + 0.02 * np.hypot(cosine, sine) * np.cos(4 * angle))


def crept(rows: Rows, hidden: Hidden) -> Array:
    """Share by which springs behind dampers have given way: as many of them in every part of the logarithm of time."""
    scale = of(hidden, "creep", "time_scale", 1.0)
    delays = scale * np.exp(np.arange(-3, 14, 0.25) + 0.577)
    # 1 - exp(-t/delay) over all delays, less what those shorter than the scale would add
    weight = 0.25 * of(hidden, "creep", "share") * np.exp(-scale / delays)
    return np.asarray(-np.expm1(-rows.time[:, None] / delays) @ weight)


def set_of(rows: Rows, hidden: Hidden) -> Array:
    """What the largest load so far has left behind."""
    exponent = of(hidden, "first_load_set", "exponent", 1.0)
    return np.asarray(of(hidden, "first_load_set", "set") * (np.maximum(rows.peak_torque, 0) / RATED) ** exponent)


def stiffened(rows: Rows, hidden: Hidden) -> Array:
    """How many times as stiff the mesh is after its first load, and by its lobes."""
    angle = np.radians(rows.wave_angle)
    again = np.where(np.abs(rows.torque) < rows.peak_torque, of(hidden, "first_load_set", "stiffening"), 0.0)
    cosine, sine = of(hidden, "ellipticity", "stiffness_cosine"), of(hidden, "ellipticity", "stiffness_sine")
    size, phase = np.hypot(cosine, sine), np.arctan2(sine, cosine)
    lobes = size * np.cos(2 * angle - phase) + 0.02 * size * np.cos(4 * angle)
    return np.asarray((1 + again) * (1 + lobes))


def shown(rows: Rows, body: Body, hidden: Hidden) -> dict[str, Array]:
    """What the gauges would show without noise: urad and N m/rad."""
    stiffness, torsion = mesh(rows, hidden, body.tooth)
    softness = COMPLIANCE + of(hidden, "series_compliance", "compliance") + cup(body.cup, hidden)
    warmer = rows.temperature - 20
    soft = of(hidden, "modulus_temperature", "softening") * warmer * (1 + warmer / 2000)
    beyond = np.sign(rows.torque) * np.maximum(np.abs(rows.torque) - FIRST_TORQUE, 0)
    wave = pressed_balls(rows.torque, body.wave + of(hidden, "soft_wave_generator", "torsion"))
    elastic = torsion + beyond * softness / (1 - soft) + wave / (1 - soft) ** (2 / 3)
    elastic = elastic * (1 + crept(rows, hidden))
    angle = elastic + friction(rows, hidden) + play(rows, hidden) + turning(rows, hidden) + set_of(rows, hidden)
    drift = of(hidden, "rig_drift", "rate") * rows.time
    return {TORSION: angle + drift, MESH: stiffness * stiffened(rows, hidden)}


# How it is measured, and with what noise


UNIT = {TORSION: "urad", MESH: "N*m/rad"}
INPUTS = """plugin = "harmonic_fractal"

[inputs]
fractal_dimension = "2.5"
fractal_roughness = "1e-9 m"
convention = "areal"
reference_torque = "20 mN*m"
drive_compliance = "36 urad/(N*m)"
{body}
[studies.diagnose]
box = {{ torque = "-40..40 N*m" }}
"""
PAST = {"torque": "N*m", "reversal_torque": "N*m", "peak_torque": "N*m", "direction": "1"}
LOGS = {"time": "h", "wave_angle": "deg", "temperature": "degC", "cycles": "1", "speed": "r/min"}
RIGID, WHOLE = Body(), Body(cup=28e-3, wave=752.0)
PEAKS = (8.0, 16.0, 24.0, 32.0, 12.0, 40.0)


def stated(body: Body) -> str:
    """The lines of an inputs file that say what gives way."""
    lines = [
        f'tooth_stiffness = "{body.tooth:g} N/m"' if isfinite(body.tooth) else "",
        f'cup_length = "{1e3 * body.cup:g} mm"' if body.cup else "",
        f'wave_torsion_stated = "{body.wave:g} urad"' if body.wave else "",
    ]
    return "\n".join(filter(None, lines)) + "\n"


def drive(body: Body = RIGID, logs: tuple[str, ...] = tuple(LOGS), **wish: Any) -> Wish:
    """What a drive is to be like whose fitted readings and others know the whole past.

    A mesh whose teeth bend is ten times as soft. ``logs`` is what the rig writes down beside the torque and its past.
    """
    noise = {TORSION: 5.0, MESH: 6e4 * (0.1 if isfinite(body.tooth) else 1.0)}
    rig = Rig(
        plugin="harmonic_fractal",
        inputs=INPUTS.format(body=stated(body)),
        written=PAST | {name: LOGS[name] for name in logs},
        measured=UNIT,
        make=Bench(
            stream=61, held=None, measured=measured, machine=lambda _: body, shown=shown,
            spread=lambda rows: 0.4 + np.abs(rows.torque) / 25, noise=noise, parted=of_both, is_path=True,
        ),
    )  # fmt: skip
    return Wish(**{"rig": rig, "design": "loops", "results": (TORSION,), "count": 60} | wish)


def of_both(count: int, held: int, rng: np.random.Generator) -> tuple[Places, Places]:
    """The places of the rows that are fitted and of those that are not; both begin with the clock.

    It counts from the first reading of a file.
    """
    return parted(count, np.array([1, *rng.permutation(np.arange(2, count))[: held - 1]]))


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock.

    Loops: from rest up and down between growing and smaller peaks, each leg at its own speed and temperature. Points:
    any torque to either side, every reading at its own state of the drive.
    """
    path = {"loops": _loops, "points": _points}[design](count, rng)
    torque, turned, leg = path
    legs = int(leg.max()) + 1
    of_leg = {"temperature": rng.uniform(0, 60, legs)[leg], "speed": rng.choice([0, 250, 500, 1000, 2000], legs)[leg]}
    if design == "points":
        of_leg = {"temperature": rng.uniform(0, 60, count), "speed": rng.choice([0, 300, 600, 1200, 2400], count)}
    time = np.sort(rng.uniform(0, 12, count))
    time[:2] = 0.0
    return Rows(
        time=time,
        torque=torque,
        reversal_torque=turned,
        peak_torque=np.maximum.accumulate(np.maximum(torque, turned)),
        direction=np.zeros(count) if design == "points" else np.sign(torque - turned + 1e-12 * (leg % 2 * -2 + 1)),
        wave_angle=rng.uniform(0, 360, count),
        temperature=np.asarray(of_leg["temperature"]),
        cycles=np.sort(rng.uniform(0, 2e6, count)) if design == "points" else 1.2e6 * (time / 12) ** 0.6,
        speed=np.asarray(of_leg["speed"], dtype=float),
    )


def _loops(count: int, rng: np.random.Generator) -> tuple[Array, Array, Places]:
    """Torques, where they last turned, and the number of the leg."""
    ends = [0.0, *(sign * peak for peak in PEAKS for sign in (1.0, -1.0))]
    ways = np.abs(np.diff(ends))
    along = np.sort(rng.uniform(0, ways.sum(), count))
    along[0] = 0.0
    leg = np.searchsorted(np.cumsum(ways), along, side="right").astype(np.intp)
    begun = np.array(ends)[leg]
    torque = begun + np.sign(np.array(ends)[leg + 1] - begun) * (along - np.concatenate([[0], np.cumsum(ways)])[leg])
    return np.round(torque, 3), begun, leg


def _points(count: int, rng: np.random.Generator) -> tuple[Array, Array, Places]:
    torque = np.round(rng.uniform(3, 45, count) * rng.choice([-1.0, 1.0], count), 3)
    return torque, np.zeros(count), np.arange(count, dtype=np.intp)
