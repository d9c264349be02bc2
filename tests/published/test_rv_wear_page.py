"""The numbers on the theory page of the reducer are those that the calculation gives."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rv_wear import discs
from rv_wear.calculation import rv_wear
from rv_wear.geometry import mesh_of, relative_arm, sliding_ratio, sliding_speed, smallest_convex_radius
from rv_wear.machines import FACTORS, slopes_at_same_wear
from rv_wear.model import RV_WEAR

PAGE = (Path(__file__).parents[2] / "docs" / "explanation" / "rv_wear.md").read_text(encoding="utf-8")
WORDS = " ".join(PAGE.split())
PAPER = RV_WEAR.inputs()
ARCMIN = np.pi / 10800


def wear(**inputs: Any) -> float:
    """Deepest wear, um."""
    return float(rv_wear(RV_WEAR.inputs(**inputs)).max_wear) * 1e6


def row(start: str) -> list[str]:
    """The cells of the row of a table that starts so, without its first cell."""
    line = next(text for text in PAGE.splitlines() if text.startswith(f"| {start}"))
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


@pytest.mark.parametrize(
    ("heading", "answers", "of"),
    [
        (r"$\varepsilon$, µm", "wear after 6000 h, µm", lambda value: wear(reconstruction_depth=f"{value} um")),
        ("hours", "deepest wear, µm", lambda value: wear(working_time=f"{value} h")),
    ],
)
def test_a_row_of_wear(heading: str, answers: str, of: Any) -> None:
    assert row(answers) == [f"{of(value):.3f}" for value in row(heading)]


@pytest.mark.parametrize(
    ("start", "name", "unit"),
    [
        ("$B$ | 16", "disc_width", "mm"),
        (r"$\alpha$ | 2.1", "pressure_viscosity", "1/Pa"),
        (r"$\kappa_T$ | 0.5", "torque_share", ""),
    ],
)
def test_what_would_serve_as_well(start: str, name: str, unit: str) -> None:
    for cell in row(start):
        given, depth = cell.split(": ")
        value = given.replace(" mm", "").replace("·10⁻⁸", "e-8")
        assert depth == f"{wear(**{name: f'{value} {unit}'.strip() if unit else float(value)}):.2f} µm"


@pytest.mark.parametrize(
    ("said", "value"),
    [
        (
            "it is {} µm.",
            lambda: ", ".join(f"{wear(phases=n):.3f}" for n in (4, 8, 16)) + f" and {wear(phases=32):.3f}",
        ),
        ("after 6000 h is {} instead of 3.13", lambda: f"{wear(load_sharing='hertz'):.2f}"),
        (
            "1000, 2000 and 4500 N·m give {} µm",
            lambda: "{:.3f}, {:.3f} and {:.3f}".format(*(wear(output_torque=f"{t} N*m") for t in (1000, 2000, 4500))),
        ),
        (
            "time: {} instead of 2.39 µm",
            lambda: f"{wear(wear_coefficient='pitch_point', composite_roughness='1.47 um', working_time='4000 h'):.2f}",
        ),
        (
            "wear is {} µm, the two printed values",
            lambda: " and ".join(
                f"{wear(equidistant_modification=f'{m} um', shift_modification=f'{m - 4} um'):.3f}" for m in (-27, -29)
            ),
        ),
        ("convex part ({} mm here)", lambda: f"{float(smallest_convex_radius(mesh_of(PAPER))) * 1e3:.2f}"),
    ],
)
def test_a_number_in_the_text(said: str, value: Any) -> None:
    assert said.format(value()) in WORDS


def test_the_coefficients_of_equation_21() -> None:
    slopes = slopes_at_same_wear(PAPER)
    for number, name in FACTORS.items():
        cells = row(f"{number} |")
        if name in slopes:
            slope = slopes[name]
        else:
            step = 1e-6
            values = {name: float(getattr(PAPER, name)) + step}
            slope = float(rv_wear(RV_WEAR.inputs(**values)).backlash - rv_wear(PAPER).backlash) / step
        assert float(cells[3].replace("−", "-")) == pytest.approx(slope * 1e-6 / ARCMIN, abs=6e-5)


def test_what_is_said_of_sliding() -> None:
    mesh = mesh_of(PAPER)
    at_20, at_58 = (float(sliding_ratio(mesh, np.radians(degree))) for degree in (20, 58))
    largest = np.max(sliding_ratio(mesh, np.radians(np.linspace(1, 179, 2000))))
    assert f"{at_20:.2f} at 20°, {at_58:.2f} at 58° and at most {largest:.2f}" in WORDS


def test_what_is_said_of_the_forces() -> None:
    new, worn = discs.flank(PAPER), discs.flank(PAPER, 6000 * 3600.0)
    angle = np.degrees(new.angle)
    loaded = angle[new.force[0] > 0]
    assert f"between {loaded[0]:.0f}° and {loaded[-1]:.0f}°" in WORDS
    peaks = (angle[new.force[0].argmax()], angle[worn.force[0].argmax()])
    assert f"has moved from {peaks[0]:.0f}° to {peaks[1]:.0f}° and has grown to {worn.force.max():.0f} N" in WORDS
    less = 1 - np.interp(60, angle, worn.force[0]) / np.interp(60, angle, new.force[0])
    assert f"about 60° carry {100 * less:.0f} % less" in WORDS


def test_what_is_said_of_the_play_that_is_felt() -> None:
    """The least take-up of every position, of the worn flank, without load."""
    worn = discs.flank(PAPER, 6000 * 3600.0)
    slack = worn.clearance[0] / np.asarray(relative_arm(mesh_of(PAPER), worn.angle))
    felt = slack.reshape(-1, PAPER.phases).min(axis=0) * 1e6
    assert f"{felt.min():.2f} to {felt.max():.2f} µm of the 3.13 µm" in WORDS


def test_what_is_said_of_the_losses() -> None:
    new = discs.flank(PAPER)
    power = new.force[0] * np.asarray(sliding_speed(mesh_of(PAPER), new.angle))
    lost = 2 * 0.05 * power.reshape(-1, PAPER.phases).sum(axis=0).mean() / PAPER.output_torque
    assert f"{100 * lost:.1f} % of the output power" in WORDS
