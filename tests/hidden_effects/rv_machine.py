"""A reducer that wears, is warm, has its pins off centre and is read under torque: from the equations alone.

Nothing of the plugin is imported. Lengths are mm, forces N, stresses MPa, times h; the wear coefficient alone is worked
out in m, Pa. The mesh is solved by halving intervals, the wear integrated by the midpoint rule in the turns of the
output; what changes the rate of wear evenly is a change of those turns.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from math import acos, pi, sqrt

import numpy as np

from hidden_effects.rigs import Bench, Rig, Wish
from hidden_effects.rows import Array, Hidden, MeasuredRows, halved, of
from hidden_effects.rv_play import Mesh, ends_of_play

PINS, TEETH = 40, 39
CIRCLE, PIN, THROW, WIDTH = 114.5, 5.0, 2.2, 20.0
SUN, CENTRES, RATIO, PRESSURE_ANGLE = 18.0, 63.0, 101.0, 20.0 * pi / 180
EQUIDISTANT, SHIFT = -0.026, -0.030
YOUNG, POISSON = 2.06e5, 0.3
SHARE, RATED, SPEED, LIFE = 0.55, 3136.0, 15.0, 6000.0
PRESSURE_VISCOSITY, ROUGHNESS, VISCOSITY = 2.2e-8, 0.694e-3, 0.2  # 1/Pa, mm, Pa s
SHORT = THROW * PINS / CIRCLE
ROOT = sqrt(1 - SHORT**2)
LONGEST = THROW * TEETH
MINUTE = pi / 10800
UNLIKE = np.array([0.8e-3, -0.5e-3])  # half of what the toothings of the two discs differ by, mm
PHASES = 12
STEP = 0.1e-3

MIDDLE = {  # of the zones of the error factors, mm
    "base_tangent_error": -0.015, "gear_runout": 0.005, "centre_distance_error": 0.0, "pin_circle_error": 0.0,
    "pin_radius_error": -0.002, "pin_fit_clearance": 0.0085, "disc_runout": 0.003275, "pin_position_error": 0.0006,
    "disc_pitch_error": 0.0, "equidistant_error": 0.0, "shift_error": 0.0, "eccentricity_error": 0.0,
    "bearing_clearance": 0.0111,
}  # fmt: skip
ZONES = {  # their widths, mm: six standard deviations
    "base_tangent_error": 0.010, "gear_runout": 0.010, "centre_distance_error": 0.020, "pin_circle_error": 0.0012,
    "pin_radius_error": 0.001, "pin_fit_clearance": 0.0016, "disc_runout": 0.00655, "pin_position_error": 0.0012,
    "disc_pitch_error": 0.002, "equidistant_error": 0.0012, "shift_error": 0.0012, "eccentricity_error": 0.004,
    "bearing_clearance": 0.0012,
}  # fmt: skip
ROUGHNESS_SCATTER = 0.0126


@dataclass(frozen=True)
class Rows(MeasuredRows):
    """What was set and measured beside the backlash, arrays (n,): h, N m, r/min, degC, deg."""

    working_time: Array
    output_torque: Array
    output_speed: Array
    housing_temperature: Array
    disc_temperature: Array
    oil_temperature: Array
    output_angle: Array
    crank_angle: Array
    measuring_torque: Array
    direction: Array


# The mesh: pins over phases, (PHASES, PINS / 2)

PSI = 2 * pi * (np.arange(PINS // 2)[None, :] + (np.arange(PHASES)[:, None] + 0.5) / PHASES) / PINS


def distance(psi: Array) -> Array:
    """Speed of a pin centre against the disc over that of the pin circle."""
    return np.asarray(np.sqrt(1 + SHORT**2 - 2 * SHORT * np.cos(psi)))


def curvature_radius(psi: Array) -> tuple[Array, Array]:
    """Signed radius of the path of the pin centre, and the radius of both bodies together at the flank."""
    path = CIRCLE * distance(psi) ** 3 / (SHORT * (PINS + 1) * np.cos(psi) - (1 + PINS * SHORT**2))
    flank = path + PIN
    return path, np.asarray(np.abs(flank * PIN / (flank - PIN)))


def gaps(psi: Array) -> Array:
    """Clearance of the new disc, turned until the pin with the longest arm touches."""
    s = distance(psi)
    return np.asarray(EQUIDISTANT * (1 - np.sin(psi) / s) - SHIFT * (1 - SHORT * np.cos(psi) - ROOT * np.sin(psi)) / s)


S = distance(PSI)
ARM = LONGEST * np.sin(PSI) / S
RADIUS = curvature_radius(PSI)[1]
NEW = gaps(PSI)
AT_LONGEST = np.array(acos(SHORT))
PITCH_PATH, PITCH_RADIUS = (float(one) for one in curvature_radius(AT_LONGEST))
PIN_WAY = CIRCLE * S - PIN  # sliding, per radian of the disc
FLANK_WAY = np.abs(CIRCLE * S + PIN * (SHORT * (PINS + 1) * np.cos(PSI) - 1 - PINS * SHORT**2) / S**2)
SLIDING = PIN_WAY / FLANK_WAY


def approach(force: Array) -> Array:
    """How far disc and pin come together at the longest arm, mm."""
    soft = (1 - POISSON**2) / YOUNG
    half_width_squared = 8 * force * PITCH_RADIUS * soft / (pi * WIDTH)
    inside = 2 / 3 + np.log(16 * PIN * abs(PITCH_PATH + PIN) / (4 * half_width_squared))
    return np.asarray(2 * soft / pi * force / WIDTH * inside)


def forces(torque: float, worn: Array) -> Array:
    """Force on every pin in every phase under the torque of one disc, N mm: rows of ``worn`` are turned to touch."""
    gap = NEW + worn
    gap = gap - ARM * np.min(gap / ARM, axis=1, keepdims=True)

    def each(logarithm: Array) -> Array:
        force = np.exp(logarithm)
        return np.asarray(force * np.maximum(ARM / LONGEST - gap / approach(force), 0.0))

    ends = np.zeros((PHASES, 1)), np.full((PHASES, 1), np.log(1e6))
    return each(halved(lambda logarithm: np.sum(each(logarithm) * ARM, axis=1, keepdims=True) > torque, *ends))


@dataclass(frozen=True)
class Wearing:
    """What a flank wears by: torque of the output (N m), roughness (mm), and a film of some thickness, if any."""

    torque: float
    roughness: float
    film: float = 0.0
    speed: float = SPEED
    viscosity: float = VISCOSITY

    def per_turn(self, worn: Array) -> Array:
        """Depth that every point of the flank loses in one turn of the output, mm."""
        force = forces(SHARE * self.torque * 1e3, worn)
        modulus = YOUNG * 1e6 / (1 - POISSON**2)
        load = force / (WIDTH * 1e-3)
        radius = RADIUS * 1e-3
        k = 3.981e29 / modulus * (load / (modulus * radius)) ** 1.219 * (PRESSURE_VISCOSITY * modulus) ** -7.377
        k = k * (self.roughness / RADIUS) ** 1.589
        if self.film:
            k = k * self._bare(np.maximum(load, 1e-9), modulus)
        return np.asarray(PINS * k * load * SLIDING * 1e3)

    def _bare(self, load: Array, modulus: float) -> Array:
        """Share of the wear that a film of this thickness leaves."""
        turning = 2 * pi * self.speed / 60
        entrained = turning * np.abs(2 * FLANK_WAY - PIN_WAY) / 2 * 1e-3
        radius = RADIUS * 1e-3
        speed = self.viscosity * entrained / (modulus * radius)
        thick = 2.65 * radius * speed**0.7 * (PRESSURE_VISCOSITY * modulus) ** 0.54
        thick = thick * (load / (modulus * radius)) ** -0.13
        return np.asarray(np.clip((3 - self.film * thick / (self.roughness * 1e-3)) / 2.5, 0, 1))


@lru_cache(maxsize=256)
def history(wearing: Wearing, turns: float) -> tuple[Array, Array]:
    """Turns of the output and the deepest wear (mm) after them, up to more than so many turns."""
    worn = np.zeros_like(PSI)
    done, deepest = [0.0], [0.0]
    while done[-1] < turns:
        rate = wearing.per_turn(worn)
        step = STEP / float(np.max(rate))
        worn = worn + step * wearing.per_turn(worn + rate * (step / 2))
        done.append(done[-1] + step)
        deepest.append(float(np.max(worn)))
    return np.array(done), np.array(deepest)


def wear_after(wearing: Wearing, turns: Array) -> Array:
    """Deepest wear after so many turns, mm."""
    most = 5.4e6 * 2.0 ** np.ceil(np.log2(max(float(np.max(turns)) / 5.4e6, 0.25)))
    at, deepest = history(wearing, float(most))
    return np.asarray(np.interp(np.maximum(turns, 0.0), at, deepest))


# The whole reducer, row by row


def made_turns(rows: Rows, hidden: Hidden) -> Array:
    """Turns of the output that would wear the flank as far without what hastens or slows the wear."""
    turns = rows.output_speed * 60 * rows.working_time
    softer = np.exp(-of(hidden, "wear_temperature", "softening") * (rows.oil_temperature - 40))
    older = 1 + of(hidden, "lubricant_ageing", "rate") / 1000 * rows.working_time / 2  # mean of 1 + rate t
    loaded = 1 - of(hidden, "duty_share", "idle")
    return np.asarray(turns * softer**-7.377 * older * loaded * (1 - of(hidden, "pin_rolling", "rolling")))


def depth_after(rows: Rows, turns: Array, off: Mapping[str, float], hidden: Hidden) -> Array:
    """Deepest wear by the law of wear, mm: one history per torque, and with a film per speed and oil."""
    roughness = ROUGHNESS * (1 + off.get("roughness", 0.0))
    film = of(hidden, "film_lubrication", "film_factor")
    thin = VISCOSITY * np.exp(-0.0411 * (rows.oil_temperature - 40))
    found = np.zeros(len(rows))
    keys = np.column_stack([rows.output_torque, rows.output_speed if film else turns * 0, thin if film else turns * 0])
    for key in np.unique(keys, axis=0):
        mine = np.all(keys == key, axis=1)
        settings = (film, float(key[1]), float(key[2])) if film else ()
        found[mine] = wear_after(Wearing(float(key[0]), roughness, *settings), turns[mine])
    return found * (rows.output_torque / RATED) ** of(hidden, "load_exponent", "exponent")


def worn(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> tuple[Array, Array]:
    """Deepest wear of the disc, and what the backlash feels of both flanks together, mm."""
    turns = made_turns(rows, hidden)
    early = of(hidden, "running_in", "depth") * 1e-3
    tau = of(hidden, "running_in", "run_in_time") or 1.0
    deepest = depth_after(rows, turns, off, hidden) + early * (1 - np.exp(-rows.working_time / tau))
    both = (1 + of(hidden, "pin_wear", "ratio")) * (1 - of(hidden, "lost_motion_share", "loss")) * (deepest + deepest)
    return deepest, both


def off_centre(hidden: Hidden, effect: str) -> Array:
    """The offset (x, y) of an effect, mm."""
    towards = np.radians(of(hidden, effect, "direction"))
    return of(hidden, effect, "offset") * 1e-3 * np.array([np.cos(towards), np.sin(towards)])


def moved_ends(rows: Rows, hidden: Hidden, size: Mapping[str, float]) -> Array:
    """Play at the output, rad, that heat, an offset of the pins or of both toothings give, by exact geometry.

    The toothings of the two discs differ by ``UNLIKE``, which turns them against one another and takes no play.
    """
    if not hidden.keys() & {"thermal_clearance", "runout", "toothing_runout", "disc_phase"}:
        return np.zeros(len(rows))
    strain = of(hidden, "thermal_clearance", "expansion") * 1e-6
    outer = (1 + strain * (rows.housing_temperature - 20))[:, None, None]
    inner = (1 + strain * (rows.disc_temperature - 20))[:, None, None]
    circle, pin = CIRCLE + size["pin_circle_error"], PIN + size["pin_radius_error"] - size["pin_fit_clearance"] / 2
    ground = CIRCLE + SHIFT + size["shift_error"], PIN + EQUIDISTANT + size["equidistant_error"]
    cold = Mesh(circle, pin, *ground, THROW, THROW)
    warm = Mesh(circle * outer, pin * outer, ground[0] * inner, ground[1] * inner, THROW * inner, THROW * inner)
    crank = -TEETH * np.radians(rows.output_angle)
    pins, toothing = off_centre(hidden, "runout"), off_centre(hidden, "toothing_runout")
    unlike = UNLIKE * ("toothing_runout" in hidden)
    ahead = of(hidden, "disc_phase", "phase") * MINUTE
    bores = toothing + np.stack([unlike, -unlike])
    ends = ends_of_play(warm, crank, (pins[0], pins[1]), toothing=bores, ahead=ahead)
    return np.asarray((ends - ends_of_play(cold, crank)).sum(axis=0))


def play(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> Array:
    """Angle that the output can be turned by hand, rad: equation 21, sixteen factors."""
    size = {name: middle + off.get(name, 0.0) for name, middle in MIDDLE.items()}
    felt = worn(rows, off, hidden)[1]
    involute = 2 * np.sin(PRESSURE_ANGLE) * (size["gear_runout"] + size["centre_distance_error"])
    radial = EQUIDISTANT + size["equidistant_error"] - size["pin_radius_error"]
    circle = size["pin_circle_error"] - SHIFT - size["shift_error"]
    circle = circle + 1.6e-4 * size["eccentricity_error"]
    around = SHORT * (2 * size["pin_position_error"] - size["disc_pitch_error"])
    gearing = 2 * radial + 2 * ROOT * circle + size["pin_fit_clearance"] + size["disc_runout"] / 2 + around
    turns = rows.output_speed * 60 * rows.working_time
    gained = of(hidden, "bearing_wear", "wear") * 1e-3 * (rows.output_torque / RATED) * turns / 1e6
    return np.asarray(
        (involute - size["base_tangent_error"]) / (SUN * RATIO)
        + (gearing + felt) / LONGEST
        + (size["bearing_clearance"] + gained) / CENTRES
        + moved_ends(rows, hidden, size)
    )


def of_reading(rows: Rows, hidden: Hidden) -> Array:
    """What is in the reading and not in the play, arcmin: ripple of teeth and pins, twist, friction."""
    ripple, angle = hidden.get("pin_pass_ripple", {}), np.radians(rows.output_angle)
    waves = {"disc_cosine": np.cos(39 * angle), "disc_sine": np.sin(39 * angle)}
    waves |= {"pin_cosine": np.cos(40 * angle), "pin_sine": np.sin(40 * angle)}
    read = sum((ripple.get(name, 0.0) * wave for name, wave in waves.items()), np.zeros(len(rows)))
    torque = np.abs(rows.measuring_torque)
    read = read + of(hidden, "wind_up", "compliance") * 2 * torque / 1000
    closing = of(hidden, "stiffening", "torque_scale") or 1.0
    read = read + of(hidden, "stiffening", "twist") * (1 - np.exp(-torque / closing))
    return np.asarray(read + of(hidden, "friction_hysteresis", "lag") * rows.direction)


def shown(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> dict[str, Array]:
    """What the gauges would show without noise: backlash in arcmin, wear in um; ``off`` in mm, roughness as a share."""
    backlash = play(rows, off, hidden) / MINUTE + of_reading(rows, hidden)
    return {"backlash": backlash, "max_wear": worn(rows, off, hidden)[0] * 1e3}


# How it is measured, and with what noise


BACKLASH, WEAR = "backlash", "max_wear"
UNIT = {BACKLASH: "arcmin", WEAR: "um"}


def machine(rng: np.random.Generator) -> Mapping[str, float]:
    """Draw a reducer within its zones."""
    off = {name: float(width / 6 * rng.standard_normal()) for name, width in ZONES.items()}
    return {**off, "roughness": float(ROUGHNESS_SCATTER * rng.standard_normal())}


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock. Endurance: one set of discs at the rating; fleet: four sets, each at its own.

    One turn: as endurance, and always read within the same turn of the crank.
    """
    sets = {"endurance": 1, "one_turn": 1, "fleet": 4}[design]
    set_of = np.sort(np.arange(count) % sets)
    hours = LIFE * np.concatenate([np.sort(rng.random(int(np.sum(set_of == one))) ** 1.5) for one in range(sets)])
    hours[0] = 0.0

    def by_set(low: float, high: float, rated: float) -> Array:
        values = np.linspace(low, high, sets)[rng.permutation(sets)] if sets > 1 else np.array([rated])
        return np.asarray(values[set_of])

    warm = rng.uniform(20, 45, count)
    crank = np.random.default_rng(count).uniform(0, 360, count)

    def within_turns(crank: Array) -> Array:
        """Output angles at which the crank stands so, in any of its turns that the design allows."""
        turns = np.floor(TEETH * rng.uniform(0, 1, count)) * (design != "one_turn")
        return np.asarray((-(crank + 360 * turns) / TEETH) % 360)

    return Rows(
        time=hours + LIFE * set_of * 1.02,
        working_time=hours,
        output_torque=by_set(2000, 4200, RATED),
        output_speed=by_set(8, 20, SPEED),
        oil_temperature=by_set(35, 60, 47.0),
        housing_temperature=warm,
        disc_temperature=warm + rng.uniform(-2, 8, count),
        output_angle=within_turns(crank),
        crank_angle=crank,
        measuring_torque=rng.uniform(0, 300, count),
        direction=rng.choice([-1.0, 1.0], count),
    )


REDUCER = Rig(
    plugin="rv_wear",
    inputs='plugin = "rv_wear"\n',
    written={
        "time": "h", "working_time": "h", "output_torque": "N*m", "output_speed": "r/min",
        "housing_temperature": "degC", "disc_temperature": "degC", "oil_temperature": "degC", "output_angle": "deg",
        "crank_angle": "deg", "measuring_torque": "N*m", "direction": "1",
    },
    measured=UNIT,
    make=Bench(
        stream=74, held=300, measured=measured, machine=machine, shown=shown,
        spread=lambda rows: 0.4 + 1.6 * rows.working_time / LIFE, noise={BACKLASH: 0.01, WEAR: 0.1},
    ),
)  # fmt: skip
reducer = partial(Wish, rig=REDUCER, design="endurance", results=(BACKLASH,), count=100)
"""What a reducer is to be like."""
