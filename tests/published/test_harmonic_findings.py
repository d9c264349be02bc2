"""The numbers in the findings are those that the calculation gives."""

from typing import Any

import numpy as np
import pytest

from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.published import FINDINGS
from harmonic_fractal.structure import converted

ROUGHER: dict[str, Any] = {"fractal_dimension": 2.5, "fractal_roughness": "1e-9 m", "reference_torque": "50 mN*m"}
TEXT = " ".join(finding.text for finding in FINDINGS)


def of(name: str, **inputs: Any) -> float:
    """A result of a drive with these inputs, SI."""
    return float(getattr(harmonic_fractal(HARMONIC_FRACTAL.inputs(**{"reference_torque": "1 mN*m", **inputs})), name))


def stiffness(**inputs: Any) -> float:
    return of("stiffness", **{"reference_torque": "2 N*m", **inputs})


def short(value: float, digits: int) -> str:
    """A number with the exponent that the findings write."""
    return f"{value:.{digits}e}".replace("e+0", "e").replace("e-0", "e-")


def share(**inputs: Any) -> float:
    """Compliance of the mesh over that of the drive in the catalogue, %."""
    return 100 * of("catalogue_stiffness", **inputs) / of("mesh_stiffness", **inputs)


def numbers() -> list[str]:
    """What stands in the findings, computed."""
    printed, closing = (
        [1e9 * of(name, pair_load=f"{load} N") for load in (1, 25, 100)] for name in ("clearance", "closing_clearance")
    )
    factors = [(2 * np.pi) ** ((2 - ds) / (ds - 1)) for ds in (1.4, 1.5, 1.6)]
    first, yields = stiffness(), stiffness(critical_rule="yield_onset")
    nanometre = {name: ROUGHER[name] for name in ("fractal_dimension", "fractal_roughness")}
    near, far = (1e6 * of("torsion", reference_torque=f"{torque} mN*m") for torque in (0.1, 1))
    return [
        "{:.0f} nm at 1 N, {:.0f} nm at 25 N and {:.0f} nm at 100 N".format(*printed),
        "{:.0f}, {:.0f} and {:.0f} nm.".format(*closing),
        f"{np.degrees(of('free_play')) * 60:.2f} arcmin",
        f"is {near:.2f} instead of {far:.2f} µrad",
        f"({short(of('plastic_limit'), 1)} N here)",
        f"{short(of('mesh_stiffness'), 1)} N m/rad",
        f"{short(of('mesh_stiffness', **ROUGHER), 1)} N m/rad",
        f"{share():.2f} % or {share(**ROUGHER):.1f} %",
        "{:.0f} to {:.0f} %".format(*(share(tooth_stiffness="2e7 N/m", **each) for each in ({}, ROUGHER))),
        f"{stiffness(fractal_roughness='5e-12 m') / first:.2f} times as stiff and",
        f"makes it {stiffness(fractal_dimension=2.45) / first:.1f} times as stiff",
        f"save {100 * of('rough_share'):.2f} %",
        "{:.1f} at D_s = 1.4, {:.1f} at 1.5, {:.1f} at 1.6, 1560 at 1.2".format(*factors),
        f"then {stiffness(fractal_roughness=f'{1e-11 * factors[0]} m') / first:.2f} of what",
        f"an areal G {float(converted(1.0, 1.5, 1.5, source='profile', target='areal')):.2f} times",
        f"factor of {stiffness(**nanometre) / stiffness(**nanometre, convention='profile'):.1f}",
        f"({short(yields, 2)} instead of {short(first, 2)} N/m)",
        f"it is {stiffness(tip_rule='scaled') / first:.2f} times",
    ]


def test_the_numbers_in_the_findings_are_computed() -> None:
    assert [number for number in numbers() if number not in TEXT] == []


def test_rounded_numbers_in_the_findings() -> None:
    """A ninth of the stiffness, 3800 times the area, 1560 at 1.2, 0.3 and 1.9 % of the torsion."""
    yielding: dict[str, Any] = {"critical_rule": "yield_onset", "reference_torque": "2 N*m"}
    assert round(stiffness() / stiffness(**yielding)) == 9
    assert of("critical_area", **yielding) / of("critical_area") == pytest.approx(3800, rel=2e-3)
    assert (2 * np.pi) ** 4 == pytest.approx(1560, rel=2e-3)
    assert [round(100 * of("rough_share", **each), 1) for each in ({}, ROUGHER)] == [0.3, 1.9]
