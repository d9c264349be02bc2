"""A mass behind a gear, by its equation of motion in steps of half a millisecond: teeth that touch on either flank.

The motor follows its programme; the mass is pushed by the flank that touches, through a spring and a damper, and is
free between the flanks. Teeth are unevenly spaced: one order of the angle, with a little of twice that order.
"""

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable

HIDDEN = hideable(backlash="backlash", wave="gear_wave")
NOISE = 0.01
"""Standard deviation of the difference of both encoders, mrad."""
STEP, SECONDS = 5e-4, 60.0
"""Step of the calculation and length of the record, s."""
DAMPING = 8.0
"""Of the gear, N m s: a third or so of the critical one."""


def programme(generator: np.random.Generator) -> tuple[Array, Array, Array, Array]:
    """Angle in rad, speed and acceleration of the motor, and the torque of the process in N m, at every step."""
    time = np.arange(0.0, SECONDS, STEP)
    angle, speed, acceleration = (np.zeros(len(time)) for _ in range(3))
    for reach, pace in ((7.0, generator.uniform(0.1, 0.2)), (0.5, generator.uniform(3.5, 4.5))):
        phase = generator.uniform(0, 2 * np.pi)
        angle += reach * np.sin(pace * time + phase)
        speed += reach * pace * np.cos(pace * time + phase)
        acceleration -= reach * pace**2 * np.sin(pace * time + phase)
    torque = 6 * np.sin(generator.uniform(0.3, 0.5) * time + generator.uniform(0, 6))
    torque += 4 * np.sin(generator.uniform(0.7, 1.0) * time + generator.uniform(0, 6))
    return angle, speed, acceleration, torque


def twists(run: tuple[Array, Array, Array, Array], axis: dict[str, float]) -> Array:
    """Angle of the motor minus that of the mass at every step, rad: semi-implicit Euler."""
    angle, _, acceleration, torque = run
    waves = axis["order"] * angle + axis["phase"]
    error = axis["wave"] * (np.sin(waves) + 0.02 * np.sin(2 * waves))
    rate = np.gradient(error, STEP)
    first = (axis["inertia"] * acceleration[0] + torque[0]) / axis["stiffness"]
    lag, lagging = first + error[0] + np.copysign(axis["play"] / 2, first), 0.0
    shown = np.empty(len(angle))
    steps = zip(error.tolist(), rate.tolist(), acceleration.tolist(), torque.tolist(), strict=True)
    for place, (uneven, growing, ahead, load) in enumerate(steps):
        pressed = lag - uneven
        pressed -= max(min(pressed, axis["play"] / 2), -axis["play"] / 2)
        pushing = axis["stiffness"] * pressed + (DAMPING * (lagging - growing) if pressed else 0.0)
        lagging += STEP * (ahead - (pushing - load) / axis["inertia"])
        lag += STEP * lagging
        shown[place] = lag
    return shown


def axis_with(hidden: str | None, generator: np.random.Generator) -> dict[str, float]:
    """An axis: SI; sizes are those of half the play and of the height of the wave."""
    axis = {
        "inertia": 0.02 * (1 + 0.03 * generator.standard_normal()),
        "stiffness": 8e3 * (1 + 0.06 * generator.standard_normal()),
        "play": 0.0,
        "wave": 0.0,
        "order": float(generator.integers(5, 13)),
        "phase": generator.uniform(0, 2 * np.pi),
    }
    if hidden in ("backlash", "backlash_and_wave"):
        axis["play"] = 2e-3 * drawn_size(generator) * NOISE
    if hidden in ("wave", "backlash_and_wave"):
        axis["wave"] = 1e-3 * drawn_size(generator) * NOISE
    return axis


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """A minute of slow reversals under a changing torque, after one second of settling."""
    axis, run = axis_with(hidden, generator), programme(generator)
    shown = twists(run, axis)
    places = np.linspace(1.0 / STEP, len(shown) - 1, rows).astype(int)
    return {
        "time [s]": STEP * places,
        "motor_angle [rad]": run[0][places],
        "speed [rad/s]": run[1][places],
        "acceleration [rad/s^2]": run[2][places],
        "load_torque [N*m]": run[3][places],
        "twist [mrad]": 1e3 * shown[places],
    }
