"""Runs of a harmonic drive with something wrong, by fixed steps: each effect draws what was hidden, the others do not.

The bench (vibration_machine) shares nothing with the plugin: contacts one by one, Runge and Kutta, oil by a table.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harmonic_fractal.vibration_effects import clearance_wear, eccentric_load, oil_between_flanks, profile_wear
from harmonic_fractal.vibration_run import RunUp, run_up
from harmonic_fractal.vibration_sheet import RUN_UP
from hidden_effects.harmonic_machine import RADIUS, Flanks
from hidden_effects.rows import Array, Hidden
from hidden_effects.vibration_machine import (
    DAMPING,
    ERROR,
    INPUTS,
    MASS,
    NOISE,
    OIL,
    ORDER,
    PLAY,
    TORQUE,
    Bench,
    amplitudes,
    bench,
)
from truing import load, read

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


STATED = {
    "fractal_dimension": 2.5, "fractal_roughness": "1e-9 m", "reference_torque": "0.02 N*m",
    "roughness_clearance": "none", "form_clearance": f"{PLAY} um", "damping_ratio": DAMPING,
    "error_amplitude": f"{ERROR} um", "torque": f"{TORQUE} N*m",
}  # fmt: skip
"""The bench as an inputs file states it."""


def swung(speed: float, temperature: float, times: Array) -> Array:
    """The transmission error of the bench from rest under its load, um, with 600 N s/m of oil, by scipy's LSODA."""
    stiffness = float(np.asarray(Flanks(tooth=2e7).stiffness(np.array([TORQUE])))[0]) / RADIUS**2
    force, gap, wave = TORQUE / RADIUS, PLAY * 1e-6 / 2, ERROR * 1e-6
    thin = np.exp(np.interp(temperature - 20, OIL[0], np.log(OIL[1])))
    damping, turning = 2 * DAMPING * np.sqrt(stiffness * MASS) + 600 * thin, 2 * np.pi * ORDER * speed / 60

    def rate(time: float, state: Array) -> list[float]:
        deflection = state[0] - wave * np.cos(turning * time)
        elastic = stiffness * (deflection - np.clip(deflection, -gap, gap))
        resisted = damping * (state[1] + turning * wave * np.sin(turning * time))
        return [state[1], (force - resisted - elastic) / MASS]

    start = [gap + force / stiffness + wave, 0.0]
    answer = solve_ivp(rate, (0, times[-1]), start, t_eval=times, rtol=1e-9, atol=1e-13, method="LSODA")
    return np.asarray(1e6 * answer.y[0])


def test_oil_that_is_hidden_in_a_record_in_time_is_named(tmp_path: Path, full_torture: bool) -> None:
    """Two runs at other speeds and temperatures are one diagnosis of a model that moves."""
    if not full_torture:
        pytest.skip("forty seconds; at full size only")
    times, rng = np.arange(0, 400e-6, 8e-6), np.random.default_rng(5)
    rows = ["run,time [us],speed [rpm],temperature [degC],cycles [1],transmission_error [um]"]
    for run, (speed, temperature, cycles) in enumerate([(4300, 25, 0.2e6), (5000, 60, 1.5e6)]):
        shown = swung(speed, temperature, times) + NOISE * rng.standard_normal(len(times))
        rows += [
            f"{run},{1e6 * time:.3f},{speed},{temperature},{cycles:g},{value:.6f}"
            for time, value in zip(times, shown, strict=True)
        ]
    (tmp_path / "runs.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    mesh = load("harmonic_fractal.vibration")
    found = mesh.diagnose(read([tmp_path / "runs.csv"], mesh), progress=False, **STATED).document
    assert [cause["effect"] for cause in found["causes"]] == ["oil_between_flanks"]
    low, high = found["causes"][0]["unknowns"]["damping"]["interval95"]
    assert 0 < low < 600 < high
