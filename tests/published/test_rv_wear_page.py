"""The numbers on the theory page of the reducer are those that the calculation gives."""

from typing import Any

import numpy as np
import pytest

from pages import Page
from rv_wear import discs, geometry
from rv_wear.calculation import rv_wear
from rv_wear.machines import FACTORS, slopes_at_same_wear
from rv_wear.model import RV_WEAR

PAGE = Page("rv_wear")
PAPER = RV_WEAR.inputs()
MESH = geometry.mesh_of(PAPER)
ARCMIN = np.pi / 10800


def wear(**inputs: Any) -> float:
    """Deepest wear, um."""
    return float(rv_wear(RV_WEAR.inputs(**inputs)).max_wear) * 1e6


@pytest.mark.parametrize(
    ("heading", "answers", "of"),
    [
        (r"$\varepsilon$, µm", "wear after 6000 h, µm", lambda value: wear(reconstruction_depth=f"{value} um")),
        ("hours", "deepest wear, µm", lambda value: wear(working_time=f"{value} h")),
    ],
)
def test_a_row_of_wear(heading: str, answers: str, of: Any) -> None:
    assert PAGE.row(answers) == [f"{of(value):.3f}" for value in PAGE.row(heading)]


@pytest.mark.parametrize(
    ("start", "name", "unit"),
    [
        ("$B$ | 16", "disc_width", "mm"), (r"$\alpha$ | 2.1", "pressure_viscosity", "1/Pa"),
        (r"$\kappa_T$ | 0.5", "torque_share", ""),
    ],
)  # fmt: skip
def test_what_would_serve_as_well(start: str, name: str, unit: str) -> None:
    for cell in PAGE.row(start):
        given, depth = cell.split(": ")
        value = given.replace(" mm", "").replace("·10⁻⁸", "e-8")
        assert depth == f"{wear(**{name: f'{value} {unit}'.strip() if unit else float(value)}):.2f} µm"


def test_numbers_in_the_text() -> None:
    printed = [
        wear(equidistant_modification=f"{depth} um", shift_modification=f"{depth - 4} um") for depth in (-27, -29)
    ]
    felt_at_pitch = wear(wear_coefficient="pitch_point", composite_roughness="1.47 um", working_time="4000 h")
    radius = 1e3 * float(geometry.smallest_convex_radius(MESH))
    sliding = [float(geometry.sliding_ratio(MESH, np.radians(degree))) for degree in (20, 58)]
    largest = np.max(geometry.sliding_ratio(MESH, np.radians(np.linspace(1, 179, 2000))))
    PAGE.says(
        "it is {:.3f}, {:.3f}, {:.3f} and {:.3f} µm.".format(*(wear(phases=count) for count in (4, 8, 16, 32))),
        f"after 6000 h is {wear(load_sharing='hertz'):.2f} instead of 3.13",
        "1000, 2000 and 4500 N·m give {:.3f}, {:.3f} and {:.3f} µm".format(
            *(wear(output_torque=f"{torque} N*m") for torque in (1000, 2000, 4500))
        ),
        f"time: {felt_at_pitch:.2f} instead of 2.39 µm",
        "wear is {:.3f} and {:.3f} µm, the two printed values".format(*printed),
        f"convex part ({radius:.2f} mm here)",
        f"{sliding[0]:.2f} at 20°, {sliding[1]:.2f} at 58° and at most {largest:.2f}",
    )


def test_the_coefficients_of_equation_21() -> None:
    slopes = slopes_at_same_wear(PAPER)
    for position, name in FACTORS.items():
        slope = slopes.get(name)
        if slope is None:
            step = 1e-6
            moved = RV_WEAR.inputs(**{name: float(getattr(PAPER, name)) + step})
            slope = float(rv_wear(moved).backlash - rv_wear(PAPER).backlash) / step
        cell = PAGE.row(f"{position} |")[3]
        assert float(cell.replace("−", "-")) == pytest.approx(slope * 1e-6 / ARCMIN, abs=6e-5)


def test_what_is_said_of_forces_play_and_losses() -> None:
    """The play that is felt: the least take-up of every position, of the worn flank, without load."""
    new, worn = discs.flank(PAPER), discs.flank(PAPER, 6000 * 3600.0)
    angle = np.degrees(new.angle)
    loaded = angle[new.force[0] > 0]
    peaks = (angle[new.force[0].argmax()], angle[worn.force[0].argmax()])
    less = 1 - np.interp(60, angle, worn.force[0]) / np.interp(60, angle, new.force[0])
    slack = worn.clearance[0] / np.asarray(geometry.relative_arm(MESH, worn.angle))
    felt = slack.reshape(-1, PAPER.phases).min(axis=0) * 1e6
    power = new.force[0] * np.asarray(geometry.sliding_speed(MESH, new.angle))
    lost = 2 * 0.05 * power.reshape(-1, PAPER.phases).sum(axis=0).mean() / PAPER.output_torque
    PAGE.says(
        f"between {loaded[0]:.0f}° and {loaded[-1]:.0f}°",
        f"has moved from {peaks[0]:.0f}° to {peaks[1]:.0f}° and has grown to {worn.force.max():.0f} N",
        f"about 60° carry {100 * less:.0f} % less",
        f"{felt.min():.2f} to {felt.max():.2f} µm of the 3.13 µm",
        f"{100 * lost:.1f} % of the output power",
    )
