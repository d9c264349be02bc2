"""The first stage of a reducer on its test rig, with something wrong: what all its gauges would show.

Nothing of the plugin is imported. Torques are N m, speeds r/min, angles degrees, temperatures degC, deviations along
the line of action um. What an effect does is not the formula of the effect: another law of viscosity, heat summed over
the contact, counts one by one, waves that are not quite round.
"""

from dataclasses import dataclass
from math import cos, hypot, pi, sqrt, tan

import numpy as np
from scipy.special import erf

from hidden_effects.gearing_stage import (
    ANGLE,
    MODULE,
    PINS,
    PLANET,
    POISSON,
    SUN,
    YOUNG,
    Loaded,
    Stage,
    Wrong,
    pair_of,
    play_between,
    stresses,
    swinging,
    touched,
)  # fmt: skip
from hidden_effects.rows import Array, Hidden, MeasuredRows, halved, of
from published.rv_gearing_by_hand import stiffness

RATIO, MESHES = 111.0, 0.920941
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
    full = stiffness(stage.rated(), pair_of(stage), 100.0)[1]

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
    read["efficiency"] = efficiency(stage) - held_back(rows, hidden) / torque
    read["flank_temperature"] = rows.oil_temperature + flash(rows, stage, hidden)
    return read
