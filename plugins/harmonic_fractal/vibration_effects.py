"""What else changes the vibration of the mesh: oil, a load off its axis, wear of clearance and of profile."""

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from harmonic_fractal.effects import CYCLES, TEMPERATURE
from harmonic_fractal.vibration import GearPair
from truing import Condition, Effect, Float, Tolerance, Unknown, normal

Pair = TypeVar("Pair", bound=GearPair)

OUTPUT_ANGLE = Condition("output_angle", "deg", reference=0, low=0, high=360,
                         note="angle of the output shaft, from a mark on it")  # fmt: skip
MILLION = 1e6


def oil_between_flanks(pair: Pair, *, damping: Float, thinning: Float, temperature: Float) -> Pair:
    """Oil is squeezed out and sucked in between the flanks; the warmer, the thinner."""
    warmer = temperature - TEMPERATURE.zero
    return replace(pair, oil_damping=pair.oil_damping + damping * np.exp(-thinning * warmer))


def eccentric_load(pair: Pair, *, cosine: Float, sine: Float, output_angle: Float) -> Pair:
    """A weight beside the axis pulls with the angle of the output, slowly beside the mesh."""
    return replace(pair, torque=pair.torque + cosine * np.cos(output_angle) + sine * np.sin(output_angle))


def clearance_wear(pair: Pair, *, rate: Float, cycles: Float) -> Pair:
    """Both flanks wear evenly: the teeth gain play."""
    return replace(pair, form_clearance=pair.form_clearance + rate * cycles / MILLION)


def profile_wear(pair: Pair, *, rate: Float, cycles: Float) -> Pair:
    """Flanks wear unevenly over their height: the transmission error grows."""
    return replace(pair, error_amplitude=pair.error_amplitude + rate * cycles / MILLION)


ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"

EFFECTS: list[Effect[Any, Any]] = [
    Effect("oil_between_flanks", on_inputs=oil_between_flanks, needs=[TEMPERATURE], acts_at_reference=True,
           unknowns=[Unknown("damping", 0, 5000, "N*s/m", "at 20 degC; 200 is 0.01 of the critical one here"),
                     Unknown("thinning", 0.01, 0.08, "1/K", "of the viscosity; 0.02 to 0.05")],
           looks_like="the peak is lower and the jump smaller than without oil, most when cold",
           remedy="Keep the effect on in the inputs file, and run up at one temperature; peak and jump are then the "
                  "same in every run.",
           why="oil between the flanks resists their approach and their parting",
           source="squeeze film: Reynolds 1886; viscosity falls by e over 1/thinning"),
    Effect("eccentric_load", on_inputs=eccentric_load, needs=[OUTPUT_ANGLE], acts_at_reference=True,
           unknowns=[Unknown("cosine", -50, 50, "N*m", "of the torque, with the cosine of the output's angle"),
                     Unknown("sine", -50, 50, "N*m", "the same with its sine")],
           looks_like="jumps and resonance move to and fro with the angle of the output",
           remedy="Balance the load at the output, or bring its centre onto the axis; jumps and resonance then stay "
                  "at one speed.",
           why="the centre of the load is beside the axis, and the mesh is stiffer and later to part under more torque",
           source="weight times lever"),
    Effect("clearance_wear", on_inputs=clearance_wear, needs=[CYCLES],
           unknowns=[Unknown("rate", 0, 50, "um", "of play, both flanks together, per million cycles in service")],
           looks_like="only where both flanks are hit: that part of the curve moves to lower speeds with the cycles",
           remedy="Check the lubricant and replace the worn splines; where both flanks are hit the curve is then that "
                  "of a new drive.",
           why="the flanks slide on one another with every wave", source=ARCHARD),
    Effect("profile_wear", on_inputs=profile_wear, needs=[CYCLES],
           unknowns=[Unknown("rate", 0, 5, "um", "of the transmission error, per million cycles in service")],
           looks_like="the whole curve grows with the cycles, and it jumps at a lower speed",
           remedy="Check the lubricant and replace the worn splines; amplitudes and the speed of the jump are then "
                  "those of a new drive.",
           why="sliding is uneven over the height of a flank, and so is wear", source=ARCHARD),
]  # fmt: skip

TOLERANCES = [
    Tolerance("damping_ratio", normal(sd="10 %"), why="damping of a mesh is known from tests only"),
    Tolerance("error_amplitude", normal(sd="5 %"), why="measured on another pair of the lot"),
    Tolerance("ring_inertia", normal(sd="2 %"), why="from the drawing; what of the cup swings with the ring is judged"),
    Tolerance("torque", normal(sd="1 %"), why="brake and its calibration"),
]
