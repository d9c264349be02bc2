"""Harmonic drives with something wrong, or nothing: how they were measured, and with what noise."""

from dataclasses import dataclass
from math import isfinite
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hidden_effects.harmonic_machine import MESH, TORSION, Array, Rows, shown
from hidden_effects.harmonic_surface import FLANK, SurfaceWish, make_surface
from hidden_effects.plugin_asking import Rig
from hidden_effects.rig_cases import RigCase, RigCases, RigWish
from truing.testing.hiding import Answered

Design: TypeAlias = Literal["loops", "climb", "points"]
UNIT = {TORSION: "urad", MESH: "N*m/rad"}
NOISE = {TORSION: 5.0, MESH: 6e4}
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


@dataclass(frozen=True, kw_only=True)
class Wish(RigWish):
    """What a case is to be like: a drive whose fitted readings and others know the whole past."""

    design: Design = "loops"
    results: tuple[str, ...] = (TORSION,)
    count: int = 60
    tooth: float = np.inf
    """Stiffness of a tooth in bending, N/m."""
    logs: tuple[str, ...] = ("time", "wave_angle", "temperature", "cycles", "speed")
    """What the rig writes down beside the torque and its past."""

    def quieter(self, result: str) -> float:
        """A mesh that bends is ten times as soft."""
        return 0.1 if result == MESH and np.isfinite(self.tooth) else 1.0


def make_case(wish: Wish | SurfaceWish) -> RigCase:
    """Make a drive on the rig or a flank under an instrument, as was wished for."""
    return make_surface(wish) if isinstance(wish, SurfaceWish) else CASES.made(wish)


def of_both(count: int, held: int, rng: np.random.Generator) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The places of the rows that are fitted and of those that are not; both begin with the clock.

    It counts from the first reading of a file.
    """
    is_held = np.zeros(count, dtype=bool)
    is_held[[1, *rng.permutation(np.arange(2, count))[: held - 1]]] = True
    return np.flatnonzero(~is_held), np.flatnonzero(is_held)


def measured(design: Design, count: int, rng: np.random.Generator) -> Rows:
    """Rows in the order of the clock.

    Loops: from rest up and down between growing and smaller peaks, each leg at its own speed and temperature. Climb:
    from rest up to 50 N m once. Points: any torque to either side, every reading at its own state of the drive.
    """
    path = {"loops": _loops, "climb": _climb, "points": _points}[design](count, rng)
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


def _loops(count: int, rng: np.random.Generator) -> tuple[Array, Array, NDArray[np.intp]]:
    """Torques, where they last turned, and the number of the leg."""
    ends = [0.0, *(sign * peak for peak in PEAKS for sign in (1.0, -1.0))]
    ways = np.abs(np.diff(ends))
    along = np.sort(rng.uniform(0, ways.sum(), count))
    along[0] = 0.0
    leg = np.searchsorted(np.cumsum(ways), along, side="right").astype(np.intp)
    begun = np.array(ends)[leg]
    torque = begun + np.sign(np.array(ends)[leg + 1] - begun) * (along - np.concatenate([[0], np.cumsum(ways)])[leg])
    return np.round(torque, 3), begun, leg


def _climb(count: int, rng: np.random.Generator) -> tuple[Array, Array, NDArray[np.intp]]:
    torque = np.round(np.linspace(0.5, 50, count), 3)
    return torque, np.full(count, torque[0]), np.zeros(count, dtype=np.intp)


def _points(count: int, rng: np.random.Generator) -> tuple[Array, Array, NDArray[np.intp]]:
    torque = np.round(rng.uniform(3, 45, count) * rng.choice([-1.0, 1.0], count), 3)
    return torque, np.zeros(count), np.arange(count, dtype=np.intp)


CASES = RigCases(
    stream=61, held=None, measured=measured, machine=lambda wish, _: wish.tooth, shown=shown,
    spread=lambda rows: 0.4 + np.abs(rows.torque) / 25, noise=NOISE, parted=of_both, is_path=True,
)  # fmt: skip


def diagnosed(case: RigCase) -> Answered:
    """Ask for a diagnosis of the record and predict the rows that were held out."""
    return (FLANK if isinstance(case.wish, SurfaceWish) else drive(case.wish)).diagnosed(case)


def drive(wish: Wish) -> Rig:
    """The rig of a drive that writes down what was wished for beside the torque and its past."""
    written = PAST | {name: LOGS[name] for name in wish.logs}
    tooth = f'tooth_stiffness = "{wish.tooth:g} N/m"\n' if isfinite(wish.tooth) else ""
    return Rig(plugin="harmonic_fractal", inputs=INPUTS.format(tooth=tooth), written=written, measured=UNIT)
