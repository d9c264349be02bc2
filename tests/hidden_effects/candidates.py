"""What may be hidden in a press, as the generator knows it: names, unknowns and bounds, and the columns they make.

A candidate is an effect, or one part of one (the offset of this gauge, of that gauge). Everything is SI.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from hidden_effects.press_machine import POSITION, SCATTER, TILT, Array, Hidden, Rows, shown

HOUR = 3600.0
UNIT = {POSITION: 1e-6, TILT: 1e-6}
WIDE = 1e3  # bounds of what a gauge may do, in SI, out of reach
Choices = Sequence[float]


@dataclass(frozen=True)
class Candidate:
    """One thing that may be wrong: its amplitudes with bounds, and its shapes with the values that are tried.

    ``small`` is an amplitude that is small against its bounds and whose column is well above rounding.
    """

    effect: str
    amplitudes: Mapping[str, tuple[float, float]]
    small: float
    shapes: Mapping[str, Choices] | None = None
    part: str = ""

    @property
    def name(self) -> str:
        """The effect and, where it has parts, which one."""
        return f"{self.effect}:{self.part}" if self.part else self.effect

    def variants(self) -> Iterator[dict[str, float]]:
        """Every combination of shapes."""
        shapes = self.shapes or {}
        for values in product(*shapes.values()):
            yield dict(zip(shapes, values, strict=True))


def physical() -> list[Candidate]:
    """The effects of the press, with the bounds of their unknowns."""
    signed, mrad = (-20e-6, 20e-6), (-10e-3, 10e-3)
    constants = tuple(np.geomspace(0.1, 20.0, 28) * HOUR)
    return [
        Candidate("link_heating", {"expansion": signed}, 1e-7),
        Candidate("warm_up", {"rise": (-1e-3, 1e-3)}, 1e-6, {"time_constant": constants}),
        Candidate("side_heating", {"expansion_1": signed, "expansion_2": signed}, 1e-7),
        Candidate("elastic_deflection", {"compliance": (0.0, 5e-9)}, 1e-12),
        Candidate("joint_clearance", {"clearance": (0.0, 500e-6)}, 1e-6),
        Candidate("joint_wear", {"wear": (0.0, 500e-6)}, 1e-6),
        Candidate("crank_phase", {"phase": (-20e-3, 20e-3)}, 1e-6),
        Candidate("encoder_eccentricity", {"sine": mrad, "cosine": mrad}, 1e-6),
        Candidate("drive_backlash", {"play_before": mrad, "play_after": mrad}, 1e-6),
        Candidate("slider_inertia", {"mass_compliance": (0.0, 20000e-9)}, 1e-9),
        Candidate("die_inclination", {"inclination": (-1e-3, 1e-3)}, 1e-6, part="inclination"),
        Candidate("die_inclination", {"height": (-1e-3, 1e-3)}, 1e-6, part="height"),
    ]


def of_gauge(result: str, duration: float) -> list[Candidate]:
    """What the gauge of one result may do wrong; a step is looked for at sixty places of the record."""
    any_size = (-WIDE, WIDE)
    after = tuple(np.linspace(0.02, 0.98, 60) * duration)
    waves = {f"{result}_sine": any_size, f"{result}_cosine": any_size}
    return [
        Candidate("sensor_offset", {result: any_size}, 1e-6, part=result),
        Candidate("sensor_gain", {result: (-1.0, 1.0)}, 1e-6, part=result),
        Candidate("sensor_drift", {result: any_size}, 1e-6 / HOUR, part=result),
        Candidate("thermal_drift", {result: any_size}, 1e-7, part=result),
        Candidate("periodic_order", waves, 1e-6, {f"{result}_order": (1.0, 2.0, 3.0)}, part=result),
        Candidate("step", {result: any_size}, 1e-6, {f"{result}_after": after}, part=result),
    ]


def registered(results: Sequence[str], duration: float) -> list[Candidate]:
    """Every candidate that a diagnosis of these results knows."""
    absent = {"inclination"} if TILT not in results else set()
    return [
        *(candidate for candidate in physical() if candidate.part not in absent),
        *(candidate for result in results for candidate in of_gauge(result, duration)),
    ]


def stacked(values: Mapping[str, Array], results: Sequence[str]) -> Array:
    """One column over all results, one after another."""
    return np.concatenate([values[result] for result in results])


def changes(rows: Rows, results: Sequence[str], hidden: Hidden, off: Mapping[str, float]) -> Array:
    """What this makes of the readings of a machine, over all results."""
    with_it, without = shown(rows, off, hidden), shown(rows, off, {})
    return stacked(with_it, results) - stacked(without, results)


def columns(rows: Rows, results: Sequence[str], candidate: Candidate, shapes: Mapping[str, float]) -> Array:
    """The change of the readings of the nominal machine per unit of each amplitude, (rows * results, amplitudes)."""
    made = []
    for name, (low, _) in candidate.amplitudes.items():
        up = changes(rows, results, {candidate.effect: {**shapes, name: candidate.small}}, {})
        if low < 0:  # signed: central differences
            up = (up - changes(rows, results, {candidate.effect: {**shapes, name: -candidate.small}}, {})) / 2
        made.append(up / candidate.small)
    return np.column_stack(made)


def tolerance_columns(rows: Rows, results: Sequence[str]) -> Array:
    """The change of the readings per standard deviation of each scattering input, (rows * results, 27)."""
    made = []
    for name, sd in SCATTER.items():
        up, down = (stacked(shown(rows, {name: way * sd}, {}), results) for way in (1.0, -1.0))
        made.append((up - down) / 2)
    return np.column_stack(made)
