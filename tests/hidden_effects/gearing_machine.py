"""The first stage of a reducer on its test rig, with something wrong: what all its gauges would show.

Nothing of the plugin is imported. Geometry and factors are those of ``published/rv_gearing_by_hand.py``: plain floats
after ISO 6336:2006, method B (face load method C). Lengths are mm, deviations along the line of action um, forces N,
torques N m, stresses MPa, speeds r/min, angles degrees, temperatures degC.

What an effect does is not the formula of the effect: load is spread over a face strip by strip, a vibration is solved
as a complex amplitude, two planets share a force as springs of which one touches first; another law of viscosity, heat
summed over the contact, counts one by one, waves that are not quite round.
"""

from dataclasses import dataclass
from functools import lru_cache, partial
from math import cos, hypot, pi, radians, sqrt, tan

import numpy as np
from scipy.special import erf

from hidden_effects.rigs import Bench, Rig, Wish
from hidden_effects.rows import Array, Hidden, MeasuredRows, halved, of
from published import rv_gearing_by_hand as standards

SUN, PLANET, PINS = 20, 55, 40
MODULE, ANGLE = 1.25, radians(20)
APPLICATION, SHARING = 1.25, 1.10
YOUNG, POISSON = 206e3, 0.3
STRIPS = 200  # of the face
DRAWING: standards.Case = {
    "m": MODULE, "beta": 0.0, "alpha": 20.0, "z": (SUN, PLANET), "ha": 1.0, "hf": 1.25, "rho_f": 0.38, "q": (0.0, 0.0),
    "np": 2, "KA": APPLICATION, "KHp": SHARING, "Q": 6, "Ca": 0.0, "form": "crowned", "nu40": 100.0, "Rz": (3.0, 3.0),
    "E": (YOUNG, YOUNG), "nu": (POISSON, POISSON), "rho": 7850.0, "sH": (1500.0, 1500.0), "material": "case_hardened",
}  # fmt: skip


@dataclass(frozen=True)
class Stage:
    """One machine: its face width (mm), shifts in modules and bearing efficiency, as they came from the workshop."""

    width: float = 12.0
    shift_sun: float = 0.0
    shift_planet: float = 0.0
    bearing: float = 0.99

    def rated(self, apart: float = 0.0, speed: float = 0.0) -> standards.Case:
        """The pair as the standards take it, its centres so many mm farther apart than without play."""
        shifts = (self.shift_sun, self.shift_planet)
        return {**DRAWING, "b": self.width, "x": shifts, "apart": max(apart, 0.0), "n_rel": speed}


@lru_cache(maxsize=1024)
def pair_of(stage: Stage, apart: float = 0.0) -> standards.Case:
    """Geometry of the pair."""
    return standards.geometry(stage.rated(apart))


def play_between(stage: Stage, apart: Array) -> Array:
    """What the teeth leave of the pitch, along the line of action, um; ``apart`` in mm."""
    return np.array([1e3 * pair_of(stage, gap)["backlash"] for gap in apart.tolist()])


@dataclass(frozen=True)
class Standard:
    """What the standards say of every row, arrays (n,), um, N/(mm um).

    Contact ratio, stiffness of a tooth and of the mesh, K_V, and the pressure in MPa per root of N/mm.
    """

    overlap: Array
    tooth: Array
    mesh: Array
    dynamic: Array
    pressure: Array


def standard(stage: Stage, line_load: Array, speed: Array, apart: Array) -> Standard:
    """Ask the standards row by row: line loads in N/mm with the application factor, speeds in r/min."""
    rows = []
    for load, turning, gap in zip(line_load.tolist(), speed.tolist(), apart.tolist(), strict=True):
        case, pair = stage.rated(gap, turning), pair_of(stage, gap)
        stiff = standards.stiffness(case, pair, load)
        dynamic = standards.dynamic(case, pair, load, stiff, (0.925 * PITCH, 0.925 * PROFILE))
        z_eps = sqrt((4 - pair["eps_a"]) / 3)
        z = standards.contact(case, pair, 1.0, z_eps)
        ratio = (pair["u"] + 1) / pair["u"] / pair["d"][0]
        rows.append((pair["eps_a"], *stiff, dynamic["K_V"], z["Z_B"] * z["Z_H"] * z["Z_E"] * z_eps * sqrt(ratio)))
    return Standard(*np.array(rows).T)


PITCH, PROFILE, _ = standards.deviations(Stage().rated(), MODULE * PLANET)
PITCH *= cos(ANGLE)


@lru_cache(maxsize=64)
def root_factor(stage: Stage, gear: int) -> float:
    """Y_Fa Y_Sa of the sun (0) or the planet (1), the load at the tip."""
    form, notch, _ = standards.root(stage.rated(), pair_of(stage), gear, tip=True)
    return form * notch


def slopes(stage: Stage) -> list[float]:
    """Helix deviations of both gears, um."""
    return [standards.deviations(stage.rated(), MODULE * teeth)[2] for teeth in (SUN, PLANET)]


# Stresses, and what raises them


@dataclass(frozen=True)
class Loaded:
    """What a mesh carries, arrays (n,): force, speed against the carrier, share of the face; how far it is apart."""

    force: Array
    speed: Array
    carrying: Array
    apart: Array

    def line_load(self, stage: Stage) -> Array:
        """With the application factor, N/mm."""
        return np.asarray(self.force * APPLICATION / (stage.width * self.carrying))


def swinging(speed: Array, resonance: float, damping: float) -> Array:
    """What a spring gives way, over the error that works it: spring and damper carry a mass as a road a car."""
    ratio = speed / resonance
    carried = (1 + 2j * damping * ratio) / (1 - ratio**2 + 2j * damping * ratio)
    return np.asarray(np.abs(carried - 1))


def spread(tilted: Array, stiffness: Array, line_load: Array) -> Array:
    """Largest over mean load of a face, one end of which lags by ``tilted`` um: strips of springs that only push."""
    gaps = np.abs(tilted)[:, None] * (np.arange(STRIPS) + 0.5) / STRIPS

    def carries_more(way: Array) -> Array:
        return np.asarray(stiffness * np.mean(np.maximum(way[:, None] - gaps, 0.0), axis=1) > line_load)

    way = halved(carries_more, np.zeros(len(tilted)), np.abs(tilted) + 2 * line_load / stiffness)
    return np.asarray(stiffness * way / line_load)


def touched(share: Array) -> Array:
    """Over which share of its width a crowned face touches, at a share of the load that makes its ends touch.

    Strips of springs that only push, behind a parabola that stands back by 1 at both ends.
    """
    gaps = ((np.arange(STRIPS) + 0.5) / STRIPS) ** 2

    def carries_more(way: Array) -> Array:
        return np.asarray(np.mean(np.maximum(way[:, None] - gaps, 0.0), axis=1) / np.mean(1 - gaps) > share)

    return np.asarray(np.minimum(np.sqrt(halved(carries_more, np.zeros(len(share)), 1 + share)), 1.0))


def of_first_planet(lead: float, stiffness: Array, force: Array) -> Array:
    """Force on the planet that touches first over the mean of two, which lead and lag by ``lead`` um: two springs."""

    def carry_more(way: Array) -> Array:
        return np.asarray(stiffness * (np.maximum(way + lead, 0.0) + np.maximum(way - lead, 0.0)) > 2 * force)

    way = halved(carry_more, np.full(len(force), -abs(lead)), abs(lead) + 2 * force / stiffness)
    return np.asarray(stiffness * (way + lead) / force)


@dataclass(frozen=True)
class Wrong:
    """What raises the load: misalignment (um) and dynamics, arrays (n,), lead of a planet and missing relief, um."""

    misaligned: Array
    shaken: Array
    lead: float
    relief: float


def stresses(stage: Stage, loaded: Loaded, wrong: Wrong) -> dict[str, Array]:
    """Root stress of sun and planet and contact stress of the sun."""
    width, load = stage.width * loaded.carrying, loaded.line_load(stage)
    at = standard(stage, load, loaded.speed, loaded.apart)
    dynamic = at.dynamic + wrong.shaken
    sharing = np.minimum(SHARING - 1 + of_first_planet(wrong.lead, at.mesh * width, loaded.force), 2.0)
    mean = load * dynamic * sharing
    bent = 0.023 * (stage.width / (MODULE * SUN)) ** 2 * mean
    first = 1.33 * bent + 0.5 * hypot(*slopes(stage))
    uneven = spread(0.85 * first + wrong.misaligned, 0.85 * at.mesh, mean)
    across = np.maximum(at.overlap / 2 * (0.9 + 0.4 * at.mesh * 0.925 * PITCH / (mean * uneven)), 1.0)
    slender = 2.25 * MODULE / stage.width
    root = load * dynamic * (1 + 1.5 * (sharing - 1)) / MODULE * uneven ** (1 / (1 + slender + slender**2))
    root = root * np.minimum(across, at.overlap / (0.25 * at.overlap + 0.75)) * (0.25 + 0.75 / at.overlap)
    root = root * (1 + at.tooth * wrong.relief / load)
    return {
        "root_stress_sun": root * root_factor(stage, 0),
        "root_stress_planet": root * root_factor(stage, 1),
        "contact_stress": at.pressure * np.sqrt(mean * uneven * np.minimum(across, 3 / (4 - at.overlap))),
    }


# The rig

RATIO, MESHES = 111.0, 0.920941
OF_SUN, OF_DISC = 0.992, 0.998  # efficiencies of the meshes of sun and planet, and of disc and pins
WIDTH, GAP = 0.75, 1.6  # of the cycloid: throw times pins over pin circle, pitch over diameter of the pins
VOGEL = 95  # degC, of mineral oils
CONDUCTING = sqrt(50 * 3.8e6)  # of steel, N/(m s^0.5 K)
BASE = MODULE * SUN / 2 * cos(ANGLE)  # radius of the base circle of the sun, mm


@dataclass(frozen=True)
class Rows(MeasuredRows):
    """What was set and measured beside the results, arrays (n,): h, N m, r/min, degC, deg."""

    load_torque: Array
    input_speed: Array
    oil_temperature: Array
    input_angle: Array

    @property
    def side(self) -> Array:
        """To which the torque lays the teeth."""
        return np.where(self.load_torque < 0, -1.0, 1.0)


def efficiency(stage: Stage) -> float:
    """Of both meshes and three bearings."""
    return MESHES * stage.bearing**3


def sun_torque(rows: Rows, stage: Stage) -> Array:
    """What the sun needs for the torque of the output."""
    return np.asarray(np.abs(rows.load_torque) / (RATIO * efficiency(stage)))


def apart(rows: Rows, hidden: Hidden) -> Array:
    """How much farther the centres are apart than without play, mm; gears do not come closer than that."""
    grown = of(hidden, "centre_distance_growth", "expansion") * 1e-6 * MODULE * (SUN + PLANET) / 2
    return np.asarray(grown * (rows.oil_temperature - 20))


def loaded(rows: Rows, stage: Stage, hidden: Hidden) -> Loaded:
    """Force and speed of a mesh, and over which share of their width crowned teeth touch."""
    force = 1000 * sun_torque(rows, stage) / (2 * MODULE * SUN / 2)
    full = of(hidden, "crowned_contact", "full_line_load") * stage.width
    touching = touched(force / full) if full else np.ones(len(rows))
    return Loaded(force, rows.input_speed * (1 - 1 / RATIO), touching, apart(rows, hidden))


def strength(rows: Rows, stage: Stage, hidden: Hidden) -> dict[str, Array]:
    """The stresses."""
    load = loaded(rows, stage, hidden)
    misaligned = of(hidden, "face_misalignment", "misalignment") + np.zeros(len(rows))
    misaligned = misaligned + of(hidden, "face_misalignment", "per_load") * load.force / 1000
    resonance = hidden.get("structural_resonance")
    shaken = np.zeros(len(rows))
    if resonance:
        shaken = resonance["strength"] * swinging(load.speed, resonance["resonance_speed"], resonance["damping"])
    lead, relief = of(hidden, "planet_load_sharing", "lead"), of(hidden, "relief_error", "missing")
    return stresses(stage, load, Wrong(misaligned, shaken, lead, relief))


# Oil and heat


def viscosity(temperature: Array) -> Array:
    """Of an ISO VG 100 oil by Vogel's law through 100 mm²/s at 40 degC and 11.1 mm²/s at 100 degC."""
    slope = np.log(100 / 11.1) / (1 / (40 + VOGEL) - 1 / (100 + VOGEL))
    return np.asarray(100 * np.exp(slope * (1 / (temperature + VOGEL) - 1 / (40 + VOGEL))))


def held_back(rows: Rows, hidden: Hidden) -> Array:
    """Torque by which seals and oil hold the sun back."""
    viscous = (viscosity(rows.oil_temperature) / 100 * rows.input_speed / 1000) ** (2 / 3)
    return np.asarray(
        of(hidden, "speed_dependent_loss", "constant") + of(hidden, "speed_dependent_loss", "viscous") * viscous
    )


def dragging(rows: Rows, hidden: Hidden) -> Array:
    """Efficiency over that without pins that drag: what friction takes of the work of the cranks, pin by pin.

    The disc turns about its pitch point as a body that is rolled along, so every pin is slid over by its own speed,
    and in its own film. Lengths in radii of the pin circle, a torque of the pins of 1, and a turning of the output of
    1. The cranks give what the pins hold and all that is lost, of which some was lost before.
    """
    friction = of(hidden, "pin_drag", "friction")
    if not friction:
        return np.ones(len(rows))
    angles = 2 * pi * (np.arange(PINS) + 0.5) / PINS
    distance = np.hypot(np.cos(angles) - WIDTH, np.sin(angles))
    arms = np.maximum(WIDTH * np.sin(angles) / distance, 0.0)  # about the centre of the pin circle; pushed, not pulled
    force = arms / (arms @ arms)
    slid = distance - np.sin(pi / PINS) / GAP
    film = (viscosity(rows.oil_temperature) / 100 * rows.input_speed / RATIO / hidden["pin_drag"]["film_speed"])[
        :, None
    ]
    lost = friction * np.exp(-film * slid) @ (force * slid)
    before = (PINS - 1) * (1 - OF_DISC)
    held = PLANET / SUN * OF_SUN * PINS / (1 + before + np.array([lost, np.zeros(len(rows))]))
    return np.asarray((1 + held[0]) / (1 + held[1]))


def contact_heat(force: float, sun: float, planet: float, turning: float) -> float:
    """Flash of a Hertzian contact per coefficient of friction, K: its heat summed from its front to every place.

    ``force`` in N/mm, radii in mm, ``turning`` of the sun in rad/s. Each flank takes the share of heat that gives both
    the same peak. The heat behind a place has gone in for the time since it passed there.
    """
    half = sqrt(4 * force * sun * planet / (sun + planet) * 2 * (1 - POISSON**2) / (pi * YOUNG))
    one, two = turning * sun, turning * SUN / PLANET * planet  # mm/s
    edges = np.linspace(-1, 1, 401)
    middles = (edges[1:] + edges[:-1]) / 2
    heat = 2 / pi * np.sqrt(1 - middles**2)  # share of the force per half width
    since = np.sqrt(np.maximum(edges[:, None] - edges[None, :], 0))
    peak = float(np.max((2 * (since[:, :-1] - since[:, 1:]) * (since[:, :-1] > 0)) @ heat))
    power = force * abs(one - two)  # N/mm * mm/s = N/s -> W/m
    each = peak * power / (CONDUCTING * sqrt(pi * half / 1000))
    return each / (sqrt(one / 1000) + sqrt(two / 1000))


def flash(rows: Rows, stage: Stage, hidden: Hidden) -> Array:
    """Rise of the flanks over the oil, K."""
    friction = of(hidden, "flash_temperature", "friction")
    if not friction:
        return np.zeros(len(rows))
    load = loaded(rows, stage, hidden)
    pair = pair_of(stage)
    path = sum(pair["db"]) / 2 * tan(pair["alpha_wt"])
    sun, planet = (sqrt(tip**2 - base**2) / 2 for tip, base in zip(pair["da"], pair["db"], strict=True))
    ends = [(path - planet, planet), (sun, path - sun)]
    force, turning = load.line_load(stage) / cos(ANGLE), load.speed * 2 * pi / 60
    rise = [max(contact_heat(w, *end, t) for end in ends) for w, t in zip(force, turning, strict=True)]
    return friction * np.array(rise)


# Transmission error and backlash


def turning(rows: Rows, hidden: Hidden) -> Array:
    """Waves over the angle, um: phase and amplitude; a mesh whose wave is not quite round."""
    sun = np.radians(rows.input_angle) * (1 - 1 / RATIO)
    output = np.radians(rows.input_angle) / RATIO
    angles = {
        ("sun_runout", ""): sun, ("planet_runout", ""): sun * SUN / PLANET, ("mesh_ripple", ""): SUN * sun,
        ("mesh_ripple", "second_"): 2 * SUN * sun, ("output_eccentricity", ""): output,
        ("output_eccentricity", "tooth_"): (PINS - 1) * output,
    }  # fmt: skip
    found = np.zeros(len(rows))
    for (effect, part), angle in angles.items():
        cosine, sine = of(hidden, effect, f"{part}cosine"), of(hidden, effect, f"{part}sine")
        size, phase = hypot(cosine, sine), np.arctan2(sine, cosine)
        found = found + size * (np.cos(angle - phase) + 0.04 * np.cos(3 * (angle - phase)))
    return found


def counted(rows: Rows, hidden: Hidden) -> Array:
    """What an encoder of 5000 marks loses that misses some marks, um."""
    lost = of(hidden, "ratio_drift", "miscount")
    marks = np.floor(rows.input_angle / 360 * 5000)
    return np.asarray(lost * marks / 5000 * 2 * pi * BASE * 1e3)


def given_way(rows: Rows, stage: Stage, hidden: Hidden) -> Array:
    """What teeth give way, um: pressed together until spring and load are in balance."""
    load = loaded(rows, stage, hidden).line_load(stage)
    full = standards.stiffness(stage.rated(), pair_of(stage), 100.0)[1]

    def carries_more(way: Array) -> Array:
        return np.where(full * way < 100, (full * way) ** (4 / 3) / 100 ** (1 / 3), full * way) > load

    return halved(carries_more, np.zeros(len(rows)), np.full(len(rows), 1000.0))


def shown(rows: Rows, stage: Stage, hidden: Hidden) -> dict[str, Array]:
    """What the gauges would show without noise."""
    play, scale = of(hidden, "lost_motion", "play"), of(hidden, "lost_motion", "torque_scale") or 1.0
    depth, torque = of(hidden, "wear_drift", "rate") / 1000 * rows.time, sun_torque(rows, stage)
    error = turning(rows, hidden) + counted(rows, hidden) + rows.side * depth
    error = error + play / 2 * erf(0.83 * rows.load_torque / scale)  # nowhere 0.02 from tanh
    error = error + rows.side * of(hidden, "wind_up", "compliance") * torque
    error = error + rows.side * of(hidden, "mesh_stiffening", "share") * given_way(rows, stage, hidden)
    read = strength(rows, stage, hidden)
    read["transmission_error"] = error
    read["backlash"] = play_between(stage, apart(rows, hidden)) + play + 2 * depth
    read["efficiency"] = efficiency(stage) * dragging(rows, hidden) - held_back(rows, hidden) / torque
    read["flank_temperature"] = rows.oil_temperature + flash(rows, stage, hidden)
    return read


# How it is measured, and with what noise


SUN_ROOT, PLANET_ROOT, CONTACT = "root_stress_sun", "root_stress_planet", "contact_stress"
ERROR, PLAY, LOSS, WARMTH = "transmission_error", "backlash", "efficiency", "flank_temperature"
UNIT = {SUN_ROOT: "MPa", PLANET_ROOT: "MPa", CONTACT: "MPa", ERROR: "um", PLAY: "um", LOSS: "1", WARMTH: "degC"}
NOISE = {SUN_ROOT: 2.0, PLANET_ROOT: 2.0, CONTACT: 8.0, ERROR: 0.5, PLAY: 1.0, LOSS: 0.004, WARMTH: 1.5}
TURN_OF_OUTPUT = 39960.0  # deg of the sun


def built(rng: np.random.Generator) -> Stage:
    """Draw a machine within its tolerances."""
    width, sun, planet, bearing = rng.standard_normal(4) * (0.033, 0.01, 0.01, 0.001)
    return Stage(12.0 + width, sun, planet, 0.99 + bearing)


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock. Rig: loads of either sign; sweep: small, through zero; one way: large."""
    load = {
        "rig": rng.choice([-1.0, 1.0], count) * rng.uniform(120, 1300, count),
        "sweep": rng.uniform(-400, 400, count),
        "one_way": rng.uniform(600, 1300, count),
    }[design]
    return Rows(
        time=2000 * np.sort(rng.random(count)),
        load_torque=load,
        input_speed=rng.uniform(300, 2500, count),
        oil_temperature=rng.uniform(25, 80, count),
        input_angle=rng.uniform(0, 1.3 * TURN_OF_OUTPUT, count),
    )


STAGE = Rig(
    plugin="rv_gearing",
    inputs='plugin = "rv_gearing"\n[inputs]\nsun_teeth = 20\nplanet_teeth = 55\n',
    written={
        "time": "h", "load_torque": "N*m", "input_speed": "rpm", "oil_temperature": "degC", "input_angle": "deg",
    },
    measured=UNIT,
    make=Bench(
        stream=75, held=300, measured=measured, machine=built, shown=shown,
        spread=lambda rows: 0.4 + 1.6 * np.abs(rows.load_torque) / 1300, noise=NOISE,
    ),
)  # fmt: skip
stage = partial(Wish, rig=STAGE, design="rig", count=100)
"""What a first stage is to be like."""
