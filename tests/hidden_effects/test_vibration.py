"""Runs of a harmonic drive with something wrong, by fixed steps: each effect draws what was hidden, the others do not.

The bench (vibration_machine) shares nothing with the plugin: contacts one by one, Runge and Kutta, oil by a table.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harmonic_fractal.vibration_effects import clearance_wear, eccentric_load, oil_between_flanks, profile_wear
from harmonic_fractal.vibration_run import RunUp, run_up
from harmonic_fractal.vibration_sheet import RUN_UP
from hidden_effects.rows import Array, Hidden
from hidden_effects.vibration_machine import INPUTS, NOISE, Bench, amplitudes, bench

HIDDEN: dict[str, Hidden] = {
    "nothing": {},
    "oil_between_flanks": {"oil_between_flanks": {"damping": 600.0}},
    "eccentric_load": {"eccentric_load": {"cosine": 0.6, "sine": -0.5}},
    "profile_wear": {"profile_wear": {"rate": 0.004}},
    "clearance_wear": {"clearance_wear": {"rate": 0.3}},
}
THINNING = np.log(1 / 0.497) / 20
"""Of the oil of the table, over the 20 K from its reference on."""


@pytest.fixture(scope="module")
def made() -> Bench:
    return bench(np.random.default_rng(4))


def modelled(made: Bench, effect: str) -> Array:
    """What the model says of each run with one effect on, um, up and down behind each other."""
    pair = replace(RUN_UP.inputs(**INPUTS), speeds=made.speeds / 60)
    cycles, angle = made.cycles, np.radians(made.output_angle)
    acting: dict[str, Any] = {
        "nothing": lambda: replace(pair, torque=pair.torque + 0 * cycles),
        "oil_between_flanks": lambda: oil_between_flanks(
            pair, damping=600.0, thinning=THINNING, temperature=made.temperature + 273.15
        ),
        "eccentric_load": lambda: eccentric_load(pair, cosine=0.6, sine=-0.5, output_angle=angle),
        "profile_wear": lambda: profile_wear(pair, rate=0.004e-6, cycles=cycles),
        "clearance_wear": lambda: clearance_wear(pair, rate=0.3e-6, cycles=cycles),
    }
    runs: RunUp = acting[effect]()
    answer = run_up(runs)
    return 1e6 * np.concatenate([np.asarray(answer.amplitude_up), np.asarray(answer.amplitude_down)])


@pytest.mark.parametrize("effect", HIDDEN)
def test_an_effect_is_what_the_bench_hides(made: Bench, effect: str) -> None:
    shown = np.concatenate(amplitudes(made, HIDDEN[effect]))
    left = {name: float(np.sqrt(np.mean((modelled(made, name) - shown) ** 2))) for name in HIDDEN}
    assert left[effect] < NOISE / 2
    if effect == "clearance_wear":  # with one flank hit, how far the other one is makes no difference
        assert left["nothing"] < NOISE / 2
    elif effect != "nothing":
        others = [each for name, each in left.items() if name != effect]
        assert min(others) > 2 * NOISE
