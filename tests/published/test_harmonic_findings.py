"""The numbers in the findings are those that the calculation gives."""

from typing import Any

import numpy as np
import pytest

from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.published import FINDINGS
from harmonic_fractal.quantities import Stiffness
from harmonic_fractal.structure import constant, converted

ROUGHER: dict[str, Any] = {"fractal_dimension": 2.5, "fractal_roughness": "1e-9 m", "reference_torque": "50 mN*m"}


def said(title: str) -> str:
    """The text of the finding whose title begins so."""
    return next(finding.text for finding in FINDINGS if finding.title.startswith(title))


def of(**inputs: Any) -> Stiffness:
    return harmonic_fractal(HARMONIC_FRACTAL.inputs(**inputs))


def stiffness(**inputs: Any) -> float:
    return float(of(reference_torque="2 N*m", **inputs).stiffness)


def test_clearance_under_load() -> None:
    answers = [of(pair_load=f"{load} N") for load in (1, 25, 100)]
    printed = [float(found.clearance) * 1e9 for found in answers]
    closing = [float(found.closing_clearance) * 1e9 for found in answers]
    text = said("The clearance of equation 7 grows")
    assert "{:.0f} nm at 1 N, {:.0f} nm at 25 N and {:.0f} nm at 100 N".format(*printed) in text
    assert "{:.0f}, {:.0f} and {:.0f} nm.".format(*closing) in text
    assert f"{np.degrees(float(answers[1].free_play)) * 60:.2f} arcmin" in text


def test_torsion_from_another_reference() -> None:
    text = said("Stiffness without load")
    near, far = (float(of(reference_torque=f"{torque} mN*m").torsion) * 1e6 for torque in (0.1, 1))
    assert f"is {near:.2f} instead of {far:.2f} µrad" in text
    assert f"({float(of().plastic_limit):.1e} N here)".replace("e-05", "e-5") in text


def test_share_of_the_drive() -> None:
    text = said("The contact of the flanks is not the weakest")
    smooth, rough = of(), of(**ROUGHER)
    numbers = [f"{float(found.mesh_stiffness):.1e}".replace("e+0", "e") for found in (smooth, rough)]
    assert f"{numbers[0]} N m/rad" in text
    assert f"{numbers[1]} N m/rad" in text
    shares = [100 * float(found.catalogue_stiffness / found.mesh_stiffness) for found in (smooth, rough)]
    assert f"{shares[0]:.2f} % or {shares[1]:.1f} %" in text
    assert max(float(found.rough_share) for found in (smooth, rough)) < 0.02
    teeth = [of(tooth_stiffness="2e7 N/m", **settings) for settings in ({}, ROUGHER)]
    bending = [100 * float(found.catalogue_stiffness / found.mesh_stiffness) for found in teeth]
    assert "4 to 5 %" in text
    assert [round(share) for share in bending] == [4, 5]


def test_tuning() -> None:
    text = said("Tuning the topography")
    start = stiffness()
    assert f"{stiffness(fractal_roughness='5e-12 m') / start:.2f} times as stiff and" in text
    assert f"makes it {stiffness(fractal_dimension=2.45) / start:.1f} times as stiff" in text
    assert f"save {100 * float(of().rough_share):.2f} %" in text


def test_factors_of_the_constant() -> None:
    text = said("A factor is missing")
    factors = [(2 * np.pi) ** ((2 - ds) / (ds - 1)) for ds in (1.4, 1.5, 1.6, 1.2)]
    assert f"{factors[0]:.1f} at D_s = 1.4, {factors[1]:.1f} at 1.5, {factors[2]:.1f} at 1.6, 1560 at 1.2" in text
    assert factors[3] == pytest.approx(1560, rel=2e-3)
    assert f"then {stiffness(fractal_roughness=f'{1e-11 * factors[0]} m') / stiffness():.2f} of what" in text


def test_two_conventions() -> None:
    text = said("There are two G")
    ratio = float(converted(1.0, 1.5, 1.5, source="profile", target="areal"))
    assert f"an areal G {ratio:.2f} times" in text
    assert ratio == pytest.approx(float(constant(1.5, 1.5, "profile") / constant(1.5, 1.5, "areal")))
    rougher: dict[str, Any] = {"fractal_dimension": 2.5, "fractal_roughness": "1e-9 m"}
    factor = stiffness(**rougher) / stiffness(**rougher, convention="profile")
    assert f"factor of {factor:.1f}" in text


def test_choices_of_the_model() -> None:
    text = said("Which contacts are plastic")
    first, yields = stiffness(), stiffness(critical_rule="yield_onset")
    numbers = [f"{value:.2e}".replace("e+0", "e") for value in (yields, first)]
    assert f"({numbers[0]} instead of {numbers[1]} N/m)" in text
    assert round(first / yields) == 9
    assert f"it is {stiffness(tip_rule='scaled') / first:.2f} times" in text
    areas = [
        float(of(reference_torque="2 N*m", critical_rule=rule).critical_area) for rule in ("yield_onset", "hardness")
    ]
    assert areas[0] / areas[1] == pytest.approx(3800, rel=2e-3)
