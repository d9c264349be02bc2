"""A roller screw that is tilted, shaken, worn, warm and out of round: its mesh from the equations alone.

Nothing of the plugin is imported. Lengths are mm, errors um, forces N, stresses MPa, times h. Loads are shared between
slices of a face, and between rollers, by halving intervals until they balance; wear is added up place by place of the
path; friction is integrated along it; backlash is what is left between tooth and space. Threads press as the integrals
of Hertz say, and find their loads in turns with what the bodies stretch.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from math import acos, cos, pi, radians, tan

import numpy as np

from hidden_effects.rigs import Bench, Rig, Wish
from hidden_effects.rows import Array, Hidden, MeasuredRows, halved, of

TEETH, RING_TEETH, MODULE, ALPHA = 20, 100, 0.5, radians(20)
CENTRES, ADDENDUM, SHIFT, RING_SHIFT = 19.80778, 0.8, 0.21, -0.16
FACE, ROLLERS, LEAD = 4.0, 10, 10.0
SHARE, STIFFNESS = 5.1943e-3, 14.0  # of the axial load; N/(mm um)
ROLLER_FACTOR, RING_FACTOR = 2.12002 * 1.86315, 1.83107 * 2.84399  # form times stress correction of this design
CARRIER_TURNS, ROLLER_TURNS = 3 / 8, 15 / 8  # turns per turn of the screw, d_s/d_r = 3
WIDTHS = {"face_width": 0.1, "centre_distance_deviation": 0.02}  # of the tolerances, mm: six standard deviations
SLICES = 200
SECOND = 0.02  # second harmonic of the error of the teeth over the first


@dataclass(frozen=True)
class Rows(MeasuredRows):
    """What was set and measured beside the results, arrays (n,): h, kN, r/min, degC, deg, cycles."""

    axial_load: Array
    screw_speed: Array
    temperature: Array
    screw_angle: Array
    cycles: Array


def inv(angle: Array | float) -> Array:
    """Involute function."""
    return np.asarray(np.tan(angle) - angle)


# Load


def force(rows: Rows) -> Array:
    """Tangential load of a mesh at the mean, N."""
    return np.asarray(SHARE * 1e3 * np.abs(rows.axial_load))


def balanced(load: Array, gaps: Array, stiffness: Array | float) -> Array:
    """Forces of springs behind gaps (n, k), um, that share a load (n, 1), N."""

    def forces(way: Array) -> Array:
        return np.asarray(np.maximum(way - gaps, 0) * stiffness)

    ends = np.full_like(load, -1e3), np.full_like(load, 1e3)
    return forces(halved(lambda way: forces(way).sum(axis=1, keepdims=True) > load, *ends, 50))


def crowding(rows: Rows, width: float, hidden: Hidden) -> Array:
    """Largest line load over the mean, of a face that is out of line."""
    gap = (
        of(hidden, "face_misalignment", "misalignment") + of(hidden, "face_misalignment", "per_load") * rows.axial_load
    )
    across = (np.arange(SLICES) + 0.5) / SLICES
    gaps = np.abs(gap)[:, None] * across
    each = balanced(force(rows)[:, None], gaps, STIFFNESS * width / SLICES)
    edge = 1.5 * each[:, 0] - 0.5 * each[:, 1]  # half a slice farther out
    return np.asarray(edge * SLICES / force(rows))


def sharing(rows: Rows, width: float, hidden: Hidden) -> Array:
    """Load of this roller over the mean, with its flank ahead of those of all others."""
    gaps = np.zeros((len(rows), ROLLERS))
    gaps[:, 0] = -of(hidden, "roller_load_sharing", "lead")
    each = balanced(ROLLERS * force(rows)[:, None], gaps, STIFFNESS * width)
    return np.asarray(each[:, 0] / force(rows))


def shaking(rows: Rows, hidden: Hidden) -> Array:
    """Largest load over one mesh, over that at rest: a mass on the mesh, shaken by an error with two harmonics."""
    own = of(hidden, "mesh_resonance", "resonance_speed") or 1e9
    damping = of(hidden, "mesh_resonance", "damping")
    phase = np.linspace(0, 2 * pi, 400, endpoint=False)
    swing = np.zeros((len(rows), len(phase)))
    for harmonic, part in ((1, 1.0), (2, SECOND)):
        ratio = harmonic * rows.screw_speed[:, None] / own
        answer = part * ratio**2 / (1 - ratio**2 + 2j * damping * ratio)
        swing += np.real(answer * np.exp(1j * harmonic * phase))
    return np.asarray(1 + of(hidden, "mesh_resonance", "excitation") * np.max(swing, axis=1))


def bearing_share(rows: Rows, hidden: Hidden) -> Array:
    """Share of the face that carries; the groove leaves the mesh a little faster than a cosine would."""
    angle = np.radians(ROLLER_TURNS * rows.screw_angle - of(hidden, "interrupted_tooth", "phase"))
    return np.asarray(1 - of(hidden, "interrupted_tooth", "lost") * ((1 + np.cos(angle)) / 2) ** 1.05)


# Threads

THREADS, PITCH, NUT, WALL = 20, 2.0, 50.0, 72.0
YOUNG, SLANT = 208e3, cos(pi / 4)  # N/mm²
FORCES = np.concatenate([[0.0], np.geomspace(1e-7, 2e5, 60_000)])  # N, on one thread


def pressing(one: float, other: float) -> Array:
    """Approach of two bodies by normal forces, mm: the axes at which the integrals of Hertz fit both curvatures, 1/mm.

    The half space gives way by the integral of 1/D over a quarter turn, D = hypot(cos, k sin), and bends by those of
    (k sin)²/D and cos²/D.
    """
    angle = (np.arange(4000) + 0.5) * pi / 8000

    def bent(share: Array | float) -> tuple[Array, Array, Array]:
        root = np.hypot(np.cos(angle), share * np.sin(angle))
        shapes = np.ones_like(angle), (share * np.sin(angle)) ** 2, np.cos(angle) ** 2
        whole, flat, steep = (np.asarray((shape / root).mean() * pi / 2) for shape in shapes)
        return whole, flat, steep

    def ratio(share: Array) -> Array:
        _, flat, steep = bent(share)
        return np.asarray(flat / steep)

    low, high = min(one, other), max(one, other)
    share = halved(lambda k: ratio(k) > low / high, np.array(1e-3), np.array(1.0))
    whole, _, steep = bent(share)
    half_width = np.cbrt(3 * FORCES * share * steep / (pi * YOUNG / (2 * (1 - 0.09)) * high))
    return np.asarray(
        1.5 * FORCES * share * whole / (pi * YOUNG / (2 * (1 - 0.09)) * np.where(half_width, half_width, 1))
    )


def shared(ways: Array, laws: Array, load: Array) -> tuple[Array, Array]:
    """Loads of threads, N, that stand by ``ways`` (n, k) apart, mm, and how far the bodies come together for that."""

    def each(near: Array) -> Array:
        return np.asarray(np.interp(near + ways, laws, FORCES))

    ends = np.full_like(load, -0.2), np.full_like(load, 2.0)
    near = halved(lambda to: each(to).sum(axis=1, keepdims=True) > load, *ends, 44)
    return each(near), near


def giving_way(rows: Rows, hidden: Hidden) -> Array:
    """Way of the screw against the nut, um, under the axial load, from where the first threads touch."""
    load = np.maximum(1e3 * np.abs(rows.axial_load), 1e-3)[:, None] / ROLLERS
    along = SLANT / np.hypot(1.0, LEAD / (pi * 30.0))
    soft = 1e-6 * of(hidden, "soft_threads", "compliance") * FORCES
    on_screw, on_nut = (
        np.interp(FORCES / along, FORCES, pressing(2 * SLANT / 10, 2 * SLANT * (1 / 10 + sign / size))) / along + soft
        for sign, size in ((1, 30.0), (-1, NUT))
    )
    areas = (30.0**2 / ROLLERS, 10.0**2, (WALL**2 - NUT**2) / ROLLERS)
    soft_bars = [PITCH / (YOUNG * pi / 4 * area) for area in areas]
    ahead = 1e-3 * of(hidden, "roller_pitch_error", "deviation") * (np.arange(THREADS) - (THREADS - 1) / 2)
    screw = nut = np.broadcast_to(load / THREADS, (len(rows), THREADS))
    together = np.zeros(len(rows))
    for _ in range(14):
        behind = (load - np.cumsum(screw, axis=1), np.cumsum(nut - screw, axis=1), load - np.cumsum(nut, axis=1))
        bodies = [soft_bar * np.cumsum(np.pad(force[:, :-1], ((0, 0), (1, 0))), axis=1)
                  for soft_bar, force in zip(soft_bars, behind, strict=True)]  # fmt: skip
        screw, near = shared(-bodies[0] - bodies[1] - ahead, on_screw, load)
        nut, far = shared(bodies[1] - bodies[2] + ahead, on_nut, load)
        together = (near + far)[:, 0]
    return np.where(rows.axial_load == 0.0, 0.0, 1e3 * (together + 2 * np.abs(ahead[0])))


# Geometry


def mounted(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> tuple[Array, Array]:
    """Centre distance, mm, and working pressure angle as mounted and as warm as it is."""
    strain = of(hidden, "thermal_centre_distance", "expansion") * 1e-6 * (rows.temperature - 20)
    centres = CENTRES * (1 + strain) + off.get("centre_distance_deviation", 0.0)
    return centres, np.arccos(MODULE * (RING_TEETH - TEETH) / 2 * cos(ALPHA) / centres)


def width_at(radius: Array, teeth: int, shift: float | Array) -> Array:
    """Tooth of a gear, or space of a ring, as an arc on a circle (the tooth of an external gear fills the space)."""
    reference = MODULE * teeth / 2
    half = (pi / 2 + 2 * shift * tan(ALPHA)) / teeth
    there = np.arccos(reference * cos(ALPHA) / radius)
    return np.asarray(2 * radius * (half + inv(ALPHA) - inv(there)))


def tight_ring_shift() -> float:
    """Shift of the ring at which nothing is left between tooth and space on the drawing, by halving."""
    working = acos(MODULE * (RING_TEETH - TEETH) / 2 * cos(ALPHA) / CENTRES)
    ring = np.array(MODULE * RING_TEETH / 2 * cos(ALPHA) / cos(working))
    roller = np.array(MODULE * TEETH / 2 * cos(ALPHA) / cos(working))
    return float(
        halved(
            lambda shift: width_at(ring, RING_TEETH, shift) > width_at(roller, TEETH, SHIFT),
            np.array(RING_SHIFT - 0.1),
            np.array(RING_SHIFT + 0.1),
        )
    )


def play(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> Array:
    """Backlash on the pitch circle as mounted, um."""
    _, working = mounted(rows, off, hidden)
    ring = MODULE * RING_TEETH / 2 * cos(ALPHA) / np.cos(working)
    space = width_at(ring, RING_TEETH, tight_ring_shift())
    return np.asarray(1e3 * (space - width_at(ring * TEETH / RING_TEETH, TEETH, SHIFT)))


def ring_tip(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> tuple[Array, Array]:
    """Radii of curvature of roller and ring where the tip of the ring meets the roller, mm."""
    centres, working = mounted(rows, off, hidden)
    base = MODULE * RING_TEETH / 2 * cos(ALPHA)
    ring = np.sqrt((MODULE * (RING_TEETH / 2 - ADDENDUM + tight_ring_shift())) ** 2 - base**2)
    return ring - centres * np.sin(working), np.full(len(rows), ring)


def roller_tip(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> tuple[Array, Array]:
    """Radii of curvature of roller and ring where the tip of the roller meets the ring, mm."""
    centres, working = mounted(rows, off, hidden)
    roller = np.sqrt((MODULE * (TEETH / 2 + ADDENDUM + SHIFT)) ** 2 - (MODULE * TEETH / 2 * cos(ALPHA)) ** 2)
    return np.full(len(rows), roller), roller + centres * np.sin(working)


# Wear, friction, motion


def wear(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> tuple[Array, Array]:
    """Depth that the roller has lost where it has lost most, and the widest gap that both flanks leave, um.

    At every place of the path, turn of the carrier by turn: a tooth of the roller meets the ring as often as the ring
    has more teeth, a tooth of the ring every roller once; each flank is rubbed by what the other one overtakes it.
    """
    start, end = ring_tip(rows, off, hidden)[0], roller_tip(rows, off, hidden)[0]
    centres, working = mounted(rows, off, hidden)
    roller = start[:, None] + (end - start)[:, None] * np.linspace(0, 1, 51)
    speeds = roller * RING_TEETH, (roller + (centres * np.sin(working))[:, None]) * TEETH
    turns = rows.cycles * TEETH / RING_TEETH / 1e6
    once = (of(hidden, "flank_wear", "rate") * force(rows) / 51.943 * turns)[:, None]
    apart = np.abs(speeds[0] - speeds[1])
    of_roller, of_ring = (
        once * count * apart / speed for count, speed in zip((RING_TEETH / TEETH, ROLLERS), speeds, strict=True)
    )
    return of_roller.max(axis=1), (of_roller + of_ring).max(axis=1)


def friction(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> Array:
    """Torque at the screw by which the flanks of all rollers rub on one ring, N m."""
    _, working = mounted(rows, off, hidden)
    start, end = ring_tip(rows, off, hidden)[0], roller_tip(rows, off, hidden)[0]
    pitch = MODULE * TEETH / 2 * cos(ALPHA) * np.tan(working)
    base_pitch = pi * MODULE * cos(ALPHA)
    screw = np.maximum(np.abs(rows.screw_speed), 1e-3) * 2 * pi / 60
    carrier = CARRIER_TURNS * screw
    turn = carrier * RING_TEETH / TEETH  # of a roller against the carrier
    at = start[:, None] + (end - start)[:, None] * (np.arange(4000) + 0.5) / 4000
    others = (at - base_pitch > start[:, None]).astype(float) + (at + base_pitch < end[:, None])
    slip = np.abs(at - pitch[:, None]) * (turn - carrier)[:, None] * 1e-3  # m/s
    mean = (slip / (1 + others)).mean(axis=1) * (end - start) / base_pitch
    normal = force(rows) / np.cos(working)
    roller, ring = pitch, pitch * RING_TEETH / TEETH
    around = 1e-3 * carrier * MODULE * RING_TEETH / 2 * cos(ALPHA) / np.cos(working)
    lined = force(rows) / cos(ALPHA) / FACE / (2 * around * np.sin(working) * roller * ring / (ring - roller))
    oil = 0.88 * np.exp(np.interp(rows.temperature, [20, 30, 40, 50, 60, 80], np.log([335, 175, 100, 61.5, 40, 19.5])))
    coefficient = 0.048 * lined**0.2 * oil**-0.05 * 0.8**0.25
    lost = ROLLERS * coefficient * normal * mean
    return np.asarray(of(hidden, "mesh_friction", "factor") * np.sign(rows.screw_speed) * lost / screw)


def error(rows: Rows, hidden: Hidden) -> Array:
    """Transmission error, um: the reach of a circle from a point beside its centre."""
    found = np.zeros(len(rows))
    for name, order, radius in (("roller_runout", ROLLER_TURNS, 5e3), ("carrier_runout", CARRIER_TURNS, 20e3)):
        angle = np.radians(order * rows.screw_angle)
        x, y = of(hidden, name, "cosine"), of(hidden, name, "sine")
        found += np.hypot(radius * np.cos(angle) + x, radius * np.sin(angle) + y) - radius
    return found


def creep(rows: Rows, hidden: Hidden) -> Array:
    """How far a roller has gone along the screw, um, tooth by tooth of the ring."""
    teeth = np.round(rows.screw_angle / 360 * CARRIER_TURNS * RING_TEETH)
    return np.asarray(of(hidden, "axial_migration", "mismatch") * LEAD * teeth / (CARRIER_TURNS * RING_TEETH))


def shown(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> dict[str, Array]:
    """What the gauges would show without noise: MPa, um, N m; ``off`` in mm."""
    width = FACE + off.get("face_width", 0.0)
    load = force(rows) / (width * MODULE) * crowding(rows, width, hidden) * sharing(rows, width, hidden)
    load = load * shaking(rows, hidden) / bearing_share(rows, hidden)
    depth, gap = wear(rows, off, hidden)
    return {
        "root_stress_roller": load * ROLLER_FACTOR,
        "root_stress_ring": load * RING_FACTOR * (1 + of(hidden, "rim_compliance", "softness")),
        "transmission_error": error(rows, hidden),
        "wear_depth": depth,
        "axial_shift": creep(rows, hidden),
        "thread_deflection": giving_way(rows, hidden),
        "friction_torque": friction(rows, off, hidden),
        "backlash": play(rows, off, hidden) + gap / np.cos(mounted(rows, off, hidden)[1]),
    }


# How it is measured, and with what noise


ROLLER, RING, ERROR = "root_stress_roller", "root_stress_ring", "transmission_error"
WEAR, AXIAL, TORQUE, BACKLASH = "wear_depth", "axial_shift", "friction_torque", "backlash"
DEFLECTION = "thread_deflection"
STRESSES = (ROLLER, RING)
UNIT = {
    DEFLECTION: "um",
    ROLLER: "MPa",
    RING: "MPa",
    ERROR: "um",
    WEAR: "um",
    AXIAL: "um",
    TORQUE: "N*m",
    BACKLASH: "um",
}
NOISE = {DEFLECTION: 0.1, ROLLER: 1.5, RING: 2.0, ERROR: 0.5, WEAR: 0.1, AXIAL: 2.0, TORQUE: 5e-4, BACKLASH: 0.4}
LOADS: Mapping[str, tuple[float, float]] = {
    "bench": (2.0, 20.0),
    "loaded": (12.0, 20.0),
    "endurance": (5.0, 20.0),
    "light": (0.02, 20.0),
}


def machine(rng: np.random.Generator) -> Mapping[str, float]:
    """Draw a screw within its tolerances."""
    return {name: float(width / 6 * rng.standard_normal()) for name, width in WIDTHS.items()}


def measured(design: str, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock.

    Bench: any load from 2 to 20 kN, few cycles. Loaded: the same from 12 kN on. Endurance: four sets of rollers, each
    at its own load, to three million cycles.
    """
    low, high = LOADS[design]
    time = np.sort(rng.uniform(0, 40, count))
    load, cycles = rng.uniform(low, high, count), 400 * time
    if design == "endurance":
        set_of = np.arange(count) * 4 // count
        load = np.linspace(low, high, 4)[rng.permutation(4)][set_of]
        cycles = np.concatenate([np.sort(rng.uniform(0, 3e6, int(np.sum(set_of == one)))) for one in range(4)])
        time = cycles / 6000 + 520 * set_of
    return Rows(
        time=time,
        axial_load=load,
        screw_speed=rng.uniform(60, 3000, count) * rng.choice([-1.0, 1.0], count),
        temperature=rng.uniform(20, 60, count),
        screw_angle=rng.uniform(0, 40 * 360, count),
        cycles=cycles,
    )


SCREW = Rig(
    plugin="roller_screw_shift",
    inputs='plugin = "roller_screw_shift"\n\n[studies.diagnose]\nbox = { axial_load = "1..25 kN" }\n',
    written={
        "time": "h", "axial_load": "kN", "screw_speed": "r/min", "temperature": "degC", "screw_angle": "deg",
        "cycles": "1",
    },
    measured=UNIT,
    make=Bench(
        stream=58, held=200, measured=measured, machine=machine, shown=shown,
        spread=lambda rows: 0.4 + rows.axial_load / 12, noise=NOISE,
    ),
)  # fmt: skip
screw = partial(Wish, rig=SCREW, design="bench", results=STRESSES, count=80)
"""What a roller screw is to be like."""
