"""A harmonic drive that is run up and down on a bench, with something wrong: its vibration by fixed steps.

Nothing of the plugin is imported. Contacts are added up one by one (harmonic_machine), the oscillator is followed in
steps (vibration_in_steps), oil thins as a table has it, and a weight hangs beside the axis.
"""

from dataclasses import dataclass

import numpy as np

from hidden_effects.harmonic_machine import RADIUS, Flanks
from hidden_effects.rows import Array, Hidden, of
from hidden_effects.vibration_in_steps import Machines, run

ORDER, MASS = 202, 5e-5 / RADIUS**2
DAMPING, ERROR, PLAY, TORQUE = 0.06, 0.03, 0.6, 5.0  # ratio, um, um, N m
NOISE = 0.002
"""Standard deviation of what is read, um."""
OIL = ((-40.0, -20.0, 0.0, 20.0, 40.0, 60.0), (4.10, 2.02, 1.0, 0.497, 0.2465, 0.1215))
"""Viscosity over that at 20 degC, by how much warmer it is than that."""
INPUTS = {
    "fractal_dimension": 2.5, "fractal_roughness": 1e-9, "reference_torque": 0.02, "roughness_clearance": "none",
    "form_clearance": PLAY * 1e-6, "damping_ratio": DAMPING, "error_amplitude": ERROR * 1e-6, "torque": TORQUE,
}  # fmt: skip
"""What the inputs file of the bench states, SI."""


@dataclass(frozen=True)
class Bench:
    """What was set, by run (n,): temperature, degC, cycles in service, angle of the output, deg; speeds, rpm (k,)."""

    temperature: Array
    cycles: Array
    output_angle: Array
    speeds: Array


def bench(rng: np.random.Generator, runs: int = 4) -> Bench:
    """Runs in which temperature, cycles and angle have nothing to do with one another."""
    return Bench(
        temperature=rng.permutation(np.linspace(20, 70, runs)),
        cycles=1e6 * rng.permutation(np.linspace(0, 2, runs)),
        output_angle=360.0 * (rng.permutation(runs) + 0.3) / runs,
        speeds=np.linspace(3600, 6000, 9),
    )


def amplitudes(made: Bench, hidden: Hidden) -> tuple[Array, Array]:
    """What an exact gauge would show on the way up and on the way down, um, each (n, k)."""
    angle = np.radians(made.output_angle)
    pull = np.hypot(of(hidden, "eccentric_load", "cosine"), of(hidden, "eccentric_load", "sine"))
    side = np.arctan2(of(hidden, "eccentric_load", "sine"), of(hidden, "eccentric_load", "cosine"))
    torque = TORQUE + pull * np.cos(angle - side)
    stiffness = Flanks(tooth=2e7).stiffness(torque) / RADIUS**2
    thin = np.exp(np.interp(made.temperature - 20, OIL[0], np.log(OIL[1])))
    oil = of(hidden, "oil_between_flanks", "damping") * thin
    gone = made.cycles / 1e6
    gap = (PLAY + of(hidden, "clearance_wear", "rate") * gone) / 2
    wave = ERROR + of(hidden, "profile_wear", "rate") * gone
    scale = gap + 1e6 * torque / RADIUS / stiffness
    machines = Machines(
        clearance=gap / scale, mean=1 - gap / scale, force=0 * gap, error=wave / scale,
        damping=DAMPING + oil / 2 / np.sqrt(stiffness * MASS),
    )  # fmt: skip
    ratios = (2 * np.pi * ORDER * made.speeds / 60)[:, np.newaxis] / np.sqrt(stiffness / MASS)
    whole = scale * run(machines, np.concatenate([ratios, ratios[::-1]]), 24)
    return whole[: len(ratios)].T, whole[: len(ratios) - 1 : -1].T


def columns(made: Bench, hidden: Hidden, rng: np.random.Generator) -> dict[str, Array]:
    """The record as it is read: one row per run and speed, in the units of ``UNITS``."""
    up, down = (each + NOISE * rng.standard_normal(each.shape) for each in amplitudes(made, hidden))
    several = len(made.speeds)
    return {
        "speed": np.tile(made.speeds, len(made.cycles)), "temperature": np.repeat(made.temperature, several),
        "cycles": np.repeat(made.cycles, several), "output_angle": np.repeat(made.output_angle, several),
        "amplitude_up": up.ravel(), "amplitude_down": down.ravel(),
    }  # fmt: skip


UNITS = {"speed": "rpm", "temperature": "degC", "cycles": "1", "output_angle": "deg", "amplitude_up": "um",
         "amplitude_down": "um"}  # fmt: skip
