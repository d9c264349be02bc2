"""Harmonic drives with something wrong, or nothing: how they were measured, and with what noise."""

from math import inf, isfinite
from typing import Any

import numpy as np

from hidden_effects.harmonic_machine import MESH, TORSION, Array, Rows, shown
from hidden_effects.rigs import Bench, Places, Rig, Wish, parted

UNIT = {TORSION: "urad", MESH: "N*m/rad"}
INPUTS = """plugin = "harmonic_fractal"

[inputs]
fractal_dimension = "2.5"
fractal_roughness = "1e-9 m"
convention = "areal"
reference_torque = "20 mN*m"
drive_compliance = "36 urad/(N*m)"
{tooth}
[studies.diagnose]
box = {{ torque = "-40..40 N*m" }}
"""
PAST = {"torque": "N*m", "reversal_torque": "N*m", "peak_torque": "N*m", "direction": "1"}
LOGS = {"time": "h", "wave_angle": "deg", "temperature": "degC", "cycles": "1", "speed": "r/min"}
PEAKS = (8.0, 16.0, 24.0, 32.0, 12.0, 40.0)


def drive(tooth: float = inf, logs: tuple[str, ...] = tuple(LOGS), **wish: Any) -> Wish:
    """What a drive is to be like whose fitted readings and others know the whole past.

    ``tooth`` is the stiffness of a tooth in bending, N/m: a mesh that bends is ten times as soft. ``logs`` is what the
    rig writes down beside the torque and its past.
    """
    noise = {TORSION: 5.0, MESH: 6e4 * (0.1 if isfinite(tooth) else 1.0)}
    rig = Rig(
        plugin="harmonic_fractal",
        inputs=INPUTS.format(tooth=f'tooth_stiffness = "{tooth:g} N/m"\n' if isfinite(tooth) else ""),
        written=PAST | {name: LOGS[name] for name in logs},
        measured=UNIT,
        make=Bench(
            stream=61, held=None, measured=measured, machine=lambda _: tooth, shown=shown,
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
