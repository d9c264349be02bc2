"""The worked example of copper: NIST's numbers, Debye's function, the causes that are published, growth in the cold."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from measured import calc_here, names, read_document
from numpy.typing import NDArray
from scipy.integrate import quad
from shown_in_docs import EXAMPLES

from truing.kernel.loading import load_file
from truing.testing import failures

EXAMPLE = EXAMPLES / "copper_expansion"
CERTIFIED = (1.0776351733, -1.2269296921e-1, 4.0863750610e-3, -1.4262662514e-6, -5.7609940901e-3, 2.4053735503e-4,
             -1.2314450199e-7)  # fmt: skip
"""NIST StRD, Hahn1: a rational function of third degree over third degree."""
CERTIFIED_SUM_OF_SQUARES = 1.5324382854


@pytest.fixture(scope="module")
def copper() -> Any:
    return load_file(EXAMPLE / "copper_expansion.py")


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("copper") / "desk"
    shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns("__pycache__", "runs"))
    return folder


def diagnosed(desk: Path, output: str, *more: str, inputs: str = "inputs.toml") -> dict[str, Any]:
    command = ["diagnose", "./copper_expansion.py", "--inputs", inputs, "--data", "hahn1.csv", "--output", output]
    answer = calc_here(desk, *command, *more)
    assert answer.code == 0, answer.err
    return read_document(desk / output)


@pytest.fixture(scope="module")
def found(desk: Path) -> dict[str, Any]:
    return diagnosed(desk, "runs/first")


def measured() -> NDArray[np.float64]:
    return np.genfromtxt(EXAMPLE / "hahn1.csv", delimiter=",", skip_header=2, usecols=(0, 1))


def test_the_rows_are_those_that_nist_certifies() -> None:
    temperature, coefficient = measured().T
    b1, b2, b3, b4, b5, b6, b7 = CERTIFIED
    above = b1 + b2 * temperature + b3 * temperature**2 + b4 * temperature**3
    below = 1 + b5 * temperature + b6 * temperature**2 + b7 * temperature**3
    assert len(temperature) == 236
    assert np.sum((coefficient - above / below) ** 2) == pytest.approx(CERTIFIED_SUM_OF_SQUARES, rel=1e-8)


def test_the_data_are_said_to_be_free() -> None:
    assert "Public domain" in (EXAMPLE / "hahn1.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "**public\ndomain**" in (EXAMPLE / "README.md").read_text(encoding="utf-8")


def test_the_plugin_passes_the_kit(copper: Any) -> None:
    assert failures(copper.COPPER_EXPANSION) == {}


# Abramowitz and Stegun, table 27.1, n = 3
@pytest.mark.parametrize(
    ("u", "energy"), [(0.1, 0.963000), (1.0, 0.674416), (2.0, 0.441129), (5.0, 0.117597), (10.0, 0.019296)]
)
def test_debyes_function_is_that_of_the_table(copper: Any, u: float, energy: float) -> None:
    assert copper.debye(u)[0] == pytest.approx(energy, abs=6e-7)


@pytest.mark.parametrize("u", [0.05, 0.7, 3.0, 12.0, 25.0, 60.0, 150.0])
def test_heat_capacity_is_debyes_integral(copper: Any, u: float) -> None:
    def within(x: float) -> float:
        return float(x**4 * np.exp(-x) / np.expm1(-x) ** 2) if x else 0.0

    by_quadrature = 3 / u**3 * quad(within, 0, min(u, 80.0), epsabs=0, epsrel=1e-12, limit=200)[0]
    assert copper.debye(u)[1] == pytest.approx(by_quadrature, rel=1e-8)


def test_heat_capacity_falls_as_the_cube_of_temperature_in_the_cold(copper: Any) -> None:
    assert copper.debye(100.0)[1] == pytest.approx(4 * np.pi**4 / 5 / 100.0**3, rel=1e-9)


@pytest.mark.parametrize("temperature", [20.0, 150.0, 800.0])
def test_growth_is_the_integral_of_the_coefficient(copper: Any, temperature: float) -> None:
    everything = {"frozen_share": 0.7, "one_note_share": 0.2, "softening": 1.4e-4, "electrons": 3e-5}

    def answer(at: float) -> Any:
        return copper.copper_expansion(copper.COPPER_EXPANSION.inputs(temperature=at, **everything))

    integral = quad(lambda at: float(answer(at).expansion_coefficient), 293.15, temperature, epsrel=1e-10)[0]
    assert answer(temperature).growth == pytest.approx(integral, rel=1e-9)


def test_both_published_causes_are_found(found: dict[str, Any]) -> None:
    assert names(found) == ["lattice_freezing", "anharmonic_rise"]
    assert (found["unique"], found["remainder"], found["causes"][1]["same_as"]) == (True, None, [])
    of_lattice = found["causes"][0]["unknowns"]
    low, high = of_lattice["share"]["interval95"]
    assert low < 1 < high
    low, high = of_lattice["debye"]["interval95"]
    assert 315 < low < 325 < high < 343  # Nix and MacNair: 325 K by the same theory


def test_rows_held_out_are_predicted_to_nearly_what_nist_certifies(found: dict[str, Any]) -> None:
    held_out = found["gain"]["expansion_coefficient"]["held_out"]
    assert held_out["rmse_before"]["value"] > 5.5
    assert 0.07 < held_out["rmse_after"]["value"] < 0.1  # the certified residual standard deviation is 0.082


def test_with_both_causes_on_nothing_is_left_to_name(found: dict[str, Any], desk: Path) -> None:
    again = diagnosed(desk, "runs/again", inputs="runs/first/extended.toml")
    assert (found["verdict"], again["verdict"], again["remainder"]) == ("named", "none", None)


def test_up_to_600_k_the_second_cause_has_three_names_and_a_hotter_row_is_asked_for(desk: Path) -> None:
    cut = diagnosed(desk, "runs/cut", "--set", "studies.diagnose.hold_out=hot = judge")
    first, second = cut["causes"]
    assert first["effect"] == "lattice_freezing"
    assert {second["effect"], *second["same_as"]} == {"thermal_drift", "anharmonic_rise", "free_electrons"}
    hottest = max(point["settings"]["temperature"]["value"] for point in cut["next"] if point["settings"])
    assert hottest > 852


# J. W. Ekin, Experimental Techniques for Low-Temperature Measurements, appendix A6.4
@pytest.mark.parametrize(("temperature", "contraction"), [(4, 3.24), (77, 3.02), (150, 2.21), (250, 0.70)])
def test_the_extended_model_knows_how_a_bar_shrinks_in_the_cold(
    found: dict[str, Any], copper: Any, temperature: float, contraction: float
) -> None:
    unknowns = {name: item["value"] for cause in found["causes"] for name, item in cause["unknowns"].items()}
    bar = copper.COPPER_EXPANSION.inputs(
        temperature=float(temperature), coefficient=found["calibrated"]["coefficient"]["value"] * 1e-6,
        frozen_share=unknowns["share"], debye_temperature=unknowns["debye"], softening=unknowns["softening"],
    )  # fmt: skip
    assert -1e3 * copper.copper_expansion(bar).growth == pytest.approx(contraction, rel=0.01)
