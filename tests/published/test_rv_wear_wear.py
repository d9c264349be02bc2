"""Wear of the cycloid disc: the paper's numbers, limits, and the similarity that the calculation relies on.

A plain loop solves the whole history again. Tables of wear over time, load, width and oil stand on the theory page and
are held by its test; those of other modifications are from an independent program, to the digits that it printed.
"""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest
from rv_wear_by_hand import wear_by_hand

from rv_wear import discs, geometry, wear
from rv_wear.geometry import Mesh, mesh_of, teeth_of
from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer
from rv_wear.wear import wear_at, worn
from shared import ROUNDING
from truing.evaluate import evaluate_rows
from truing.setup import default_setup

PAPER: Reducer = RV_WEAR.inputs()
HOUR = 3600.0
CONDITION = 10.0
"""Of the wear: the exponents of its coefficient together, 7.377 of the pressure viscosity the largest."""
MODULUS = 2.06e11 / (1 - 0.3**2)


def coefficient(line_load: Any, radius: Any, oil: float, roughness: float) -> Any:
    """The wear coefficient by both of its parts, 1/Pa."""
    return wear.lubricant_part(MODULUS, oil, roughness) * wear.contact_part(MODULUS, line_load, radius)


def of(**changes: Any) -> Any:
    """Deepest wear in um."""
    return worn(replace(PAPER, **changes))["max_wear"] * 1e6


def ground(modification: Any) -> dict[str, Any]:
    """A disc ground with another equidistant modification at the same radial clearance."""
    return {"equidistant_modification": modification, "shift_modification": modification - 4e-6}


# The printed numbers


@pytest.mark.parametrize(
    ("changes", "wear", "half_digit"),
    [
        ({"working_time": 100 * HOUR, **ground(-53e-6)}, 0.105, 5e-4),
        ({"working_time": 100 * HOUR, **ground(-40e-6)}, 0.098, 5e-4),
        ({"working_time": 100 * HOUR, **ground(-26e-6)}, 0.088, 5e-4),
        ({"working_time": 100 * HOUR, **ground(-10e-6)}, 0.077, 5e-4),
        ({"working_time": 100 * HOUR, **ground(11e-6)}, 0.060, 5e-4),
        (ground(-27e-6), 3.154, 1e-3),  # the paper's first optimum: 3.151
        (ground(-29e-6), 3.204, 1e-3),  # and the second: 3.207
        ({"wear_coefficient": "pitch_point", "composite_roughness": 1.45e-6, "working_time": 4000 * HOUR}, 2.15, 0.02),
    ],
)
def test_wear_of_other_reducers(changes: dict[str, Any], wear: float, half_digit: float) -> None:
    assert of(**changes) == pytest.approx(wear, abs=1.001 * half_digit)


@pytest.mark.parametrize(("modification", "hours"), [(-45e-6, 6000.0), (-26e-6, 2345.0), (8e-6, 500.0)])
def test_wear_is_that_of_the_plain_iteration(modification: float, hours: float) -> None:
    plain = wear_by_hand(modification, modification - 4e-6, hours)
    assert of(working_time=hours * HOUR, **ground(modification)) == pytest.approx(plain * 1e6, rel=1e-9)


# The coefficient


def test_coefficient_written_out_and_its_size() -> None:
    group = 3.981e29 * (1.5e5 / (MODULUS * 4.5e-3)) ** 1.219 * (2.2e-8 * MODULUS) ** -7.377 * (0.7e-6 / 4.5e-3) ** 1.589
    written = coefficient(1.5e5, 4.5e-3, 2.2e-8, 0.7e-6)
    assert written == pytest.approx(group / MODULUS, rel=1e-13)
    short = 2.2 * 40 / 114.5
    path = 114.5e-3 * (1 - short**2) ** 1.5 / (41 * short**2 - 1 - 40 * short**2)  # G2 at the longest arm
    radius = abs((path + 5e-3) * 5e-3 / path)
    here = coefficient(worn(PAPER)["max_force"] / 20e-3, radius, 2.2e-8, 0.694e-6)
    assert worn(PAPER)["coefficient"] == pytest.approx(here, rel=1e-12)


def test_millimetres_and_megapascals_give_the_same_wear() -> None:
    metres = mesh_of(PAPER)
    millimetres = Mesh(114.5, 5.0, 2.2, 20.0, -0.026, -0.030, 0.55 * 3136e3, 2.06e5, 0.3, 0.05e-3)
    meshings = 6000 * 15 * 60 * 40
    in_metres = meshings * wear.lubricant_part(MODULUS, 2.2e-8, 0.694e-6)
    in_millimetres = meshings * wear.lubricant_part(MODULUS * 1e-6, 2.2e-2, 0.694e-3)
    depth = wear_at(teeth_of(metres), np.array([in_metres]))
    same = wear_at(teeth_of(millimetres), np.array([in_millimetres]))
    assert same.max() * 1e-3 == pytest.approx(depth.max(), rel=1e-12)
    assert depth.max() == pytest.approx(worn(PAPER)["max_wear"], rel=1e-12)


# The law


def test_the_first_step_is_equation_13() -> None:
    """Short time: dh = k F / B lambda for every meshing, k from the force and radius of that point."""
    new = discs.flank(PAPER)
    force, mesh = new.force[0], mesh_of(PAPER)
    radius = np.asarray(geometry.relative_radius(mesh, new.angle))
    k = coefficient(force / 0.02, radius, 2.2e-8, 0.694e-6)
    rate = k * force / 0.02 * np.asarray(geometry.sliding_ratio(mesh, new.angle)) / 0.1  # per second
    assert of(working_time=10 * HOUR) == pytest.approx(rate.max() * 10 * HOUR * 1e6, rel=1e-12)
    assert discs.flank(PAPER, 10 * HOUR).wear[0] == pytest.approx(rate * 10 * HOUR, rel=1e-11, abs=1e-22)


def test_wear_grows_with_time_ever_slower_and_begins_at_zero() -> None:
    hours = np.linspace(0, 12000, 61)
    wear = of(working_time=hours * HOUR)
    assert wear[0] == 0
    assert np.all(np.diff(wear) > 0)
    assert np.all(np.diff(wear, 2) < 1e-4 * wear[-1])  # steps of the reconstruction, nothing else
    assert np.all(np.diff(wear[::5], 2) < 0)
    assert worn(replace(PAPER, working_time=0.0))["max_wear"] == 0


def test_speed_and_time_enter_by_their_product() -> None:
    assert of(output_speed=7.5 / 60, working_time=12000 * HOUR) == pytest.approx(of(), rel=1e-14)
    assert of(output_speed=60 / 60, working_time=1500 * HOUR) == pytest.approx(of(), rel=1e-14)


@pytest.mark.parametrize("changes", [{}, ground(-45e-6), ground(9e-6), {"output_torque": 700.0}, {"phases": 16}])
def test_between_the_steps_the_largest_wear_is_that_of_the_whole_flank(changes: dict[str, Any]) -> None:
    reducer = replace(PAPER, **changes)
    for hours in np.linspace(37, 6011, 23):
        now = replace(reducer, working_time=hours * HOUR)
        whole = discs.flank(now, hours * HOUR)
        assert worn(now)["max_wear"] == pytest.approx(whole.wear.max(), rel=1e-12)


@pytest.mark.parametrize("designs", [1, 5, 40])
def test_order_of_questions_does_not_matter(designs: int) -> None:
    hours = [6000.0, 100.0, 20000.0, 3000.0]
    discs = ground(np.linspace(-40e-6, 5e-6, designs))

    def asked(times: list[float]) -> list[Any]:
        wear.forget()
        return [of(working_time=time * HOUR, **discs).tolist() for time in times]

    assert asked(hours) == asked(hours[::-1])[::-1]


# What stretches time, and what is felt


def test_oil_roughness_and_factors_only_stretch_time() -> None:
    assert of(wear_rate_factor=1.7) == pytest.approx(of(working_time=1.7 * 6000 * HOUR), rel=1e-13)
    assert of(sliding_factor=0.4) == pytest.approx(of(working_time=0.4 * 6000 * HOUR), rel=1e-13)
    assert of(sliding_factor=0.0) == 0
    assert of(composite_roughness=0.8e-6) == pytest.approx(of(wear_rate_factor=(0.8 / 0.694) ** 1.589), rel=1e-13)
    assert of(pressure_viscosity=2.4e-8) == pytest.approx(of(wear_rate_factor=(2.4 / 2.2) ** -7.377), rel=1e-13)


# The film


def film_ratio(angle: float, force: float, factor: float) -> float:
    """Lambda, written out for the paper's reducer at 15 r/min and 0.2 Pa s."""
    k_1 = 2.2 * 40 / 114.5
    s = np.sqrt(1 + k_1**2 - 2 * k_1 * np.cos(angle))
    bend = (k_1 * 41 * np.cos(angle) - 1 - 40 * k_1**2) / s**2
    radius = 0.005 * abs(1 + 0.005 * bend / (0.1145 * s))
    turning = 2 * pi * 15 / 60
    flank, sliding_speed = turning * abs(0.1145 * s + 0.005 * bend), turning * (0.1145 * s - 0.005)
    mean = abs(flank + flank - sliding_speed) / 2
    u, g, w = 0.2 * mean / (MODULUS * radius), 2.2e-8 * MODULUS, force / 0.02 / (MODULUS * radius)
    return float(factor * 2.65 * radius * u**0.7 * g**0.54 * w**-0.13 / 0.694e-6)


def test_film_leaves_the_share_that_its_ratio_says() -> None:
    new = discs.flank(PAPER)
    dry = discs.flank(PAPER, 10 * HOUR).wear[0]
    for factor in (20.0, 80.0, 150.0):
        wet = discs.flank(replace(PAPER, film_factor=factor), 10 * HOUR).wear[0]
        for place in np.flatnonzero(new.force[0] > 0):
            ratio = film_ratio(new.angle[place], new.force[0, place], factor)
            assert wet[place] == pytest.approx(dry[place] * np.clip((3 - ratio) / 2.5, 0, 1), rel=1e-9)


def test_only_with_a_film_its_oil_counts() -> None:
    assert of(oil_viscosity=0.05) == of()
    assert of(oil_viscosity=0.05, film_factor=100.0) > of(film_factor=100.0) * 1.01
    assert of(output_speed=0.5, working_time=3000 * HOUR, film_factor=100.0) < of(film_factor=100.0) * 0.99


# Batches


def test_a_row_that_cannot_be_leaves_the_others_alone() -> None:
    setup = default_setup(RV_WEAR)
    modification = np.array([-26e-6, 30e-6, -26e-6, 2e-6])
    columns = {
        **ground(modification),
        "pin_radius": np.array([5e-3, 5e-3, 9.2e-3, 5e-3]),
        "composite_roughness": np.full(4, 0.694e-6),
    }
    found = evaluate_rows(setup, columns, 4)
    assert found.failed.tolist() == [False, True, True, False]
    assert "interfere" in found.reasons[1]
    assert "undercut" in found.reasons[2]
    assert found.results["max_wear"][0] == pytest.approx(worn(PAPER)["max_wear"], rel=CONDITION * ROUNDING)
    for radius in (np.full(3, 9.2e-3), 9.2e-3):
        nobody = evaluate_rows(setup, {"pin_radius": radius}, 3)
        assert nobody.failed.all()
        assert "undercut" in nobody.reasons[2]
