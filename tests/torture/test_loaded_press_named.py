"""What is wrong with a press under load is named from a record of its deflection and tilt: a minute of diagnosis each.

The press of ``hidden_effects/loaded_press.py`` hides it; nothing of it is shared with the calculation.
"""

import numpy as np
import pytest

from hidden_effects.loaded_press import LoadedMachine, shown
from hidden_effects.rigs import demand_named, model_of
from hidden_effects.test_loaded_press import HIDDEN, LOADED, START, TURNS_PER_SECOND, stroke, with_hidden
from truing.testing import recorded
from truing.testing.hiding import Answered, csv_of

NOISE = {"deflection": 3e-6, "slider_tilt": 2e-6}
MEASURED = LoadedMachine(offset=0.105, play=16e-6, ground=(2.1e9, 5.25e9))
"""A press whose load, play and frame are a little off, within the tolerances."""
PARTS = ("crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length", "platform_arm",
         "slider_half_width", "slider_joint_angle", "crank_pivot_radius", "crank_pivot_angle", "platform_half_width",
         "platform_joint_angle", "ground_pivot_radius", "ground_pivot_angle")  # fmt: skip
INPUTS = f'plugin = "{LOADED}"\n\n[tolerances]\n' + "".join(f'{part} = "off"\n' for part in PARTS)
"""Parts that were measured: nothing of them is left to calibrate."""


def record(effect: str, *, seed: int, count: int = 16) -> str:
    """A measured stroke as CSV, with noise."""
    times, angle, force = stroke(count)
    truth, noise = shown(with_hidden(MEASURED, effect), angle, force), np.random.default_rng(seed)
    read = {name: truth[name] + sd * noise.standard_normal(count) for name, sd in NOISE.items()}
    columns = {
        "time [s]": times,
        "start_angle [rad]": np.full(count, START),
        "speed [rpm]": np.full(count, 60 * TURNS_PER_SECOND),
        "forming_force [kN]": force / 1e3,
        "deflection [um]": read["deflection"] * 1e6,
        "slider_tilt [urad]": read["slider_tilt"] * 1e6,
    }
    return csv_of(columns)


def answered(effect: str) -> Answered:
    """What a diagnosis says to such a record; another stroke is held out."""
    rows = [record(effect, seed=seed) for seed in (3, 4)]
    return recorded(model_of(LOADED), inputs=INPUTS, measured=rows[0], held_out=rows[1]).answered


@pytest.mark.parametrize("effect", ["off_centre", "loose_joints"])
def test_what_is_wrong_is_named_with_its_size(effect: str, full_torture: bool) -> None:
    if not full_torture:
        pytest.skip("takes a minute")
    answer = answered(effect)
    demand_named(answer.document, [{effect}])
    ((name, true),) = HIDDEN[effect][1].items()
    (cause,) = answer.document["causes"]
    low, high = cause["unknowns"][name]["interval95"]
    assert low <= {"shift": 1e3, "play": 1e6}[name] * true <= high
