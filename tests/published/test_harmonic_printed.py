"""Numbers of contact, mesh and drive as printed: tables of an independent calculation, and the maker's catalogues.

They were calculated by quadrature for steel on steel, E = 113.19 GPa and H = 3 GPa; tolerances are half a unit of the
last printed digit unless a line says otherwise. What the theory page and the findings repeat of them is tested there.
"""

from dataclasses import replace
from typing import Any

import pytest

from harmonic_fractal import contact as rough_contact
from harmonic_fractal.calculation import column_of, harmonic_fractal, polyline_of
from harmonic_fractal.contact import Rough
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive

# D, G in m; then under 25 N: a_c and a_L in m^2, K in N/m, b in nm, rms of a patch of 0.2 mm in nm; None: not printed
PAIRS = [
    (2.3, 1e-11, "4.25e-13", "9.27e-9", "1.721e8", "536", 815.0),
    (2.4, 1e-11, "1.57e-15", "3.15e-8", "1.95e9", "153", 172.0),
    (2.4, 1e-10, "1.57e-13", "1.15e-8", "3.542e8", "284", None),
    (2.5, 1e-11, "5.43e-17", "7.11e-8", "1.626e10", "35", 33.0),
    (2.5, 1e-9, "5.43e-13", "7.48e-9", "2.740e8", "199", 349.0),
    (2.6, 1e-9, None, None, "8.49e8", None, 100.0),
]


def half_a_digit(printed: str) -> Any:
    """Match what rounds to the printed number."""
    mantissa, _, exponent = printed.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return pytest.approx(float(printed), abs=0.501 * 10.0 ** (int(exponent or 0) - decimals), rel=0)


def drive_of(**changed: Any) -> Drive:
    """A drive with the defaults but for these inputs, SI."""
    made: Drive = replace(HARMONIC_FRACTAL.inputs(), **changed)
    return made


# One pair


@pytest.mark.parametrize(("dimension", "roughness", "critical", "largest", "stiffness", "amplitude", "rms"), PAIRS)
def test_one_pair_under_25_newtons(
    dimension: float, roughness: float, critical: str | None, largest: str | None, stiffness: str,
    amplitude: str | None, rms: float | None,
) -> None:  # fmt: skip
    found = harmonic_fractal(drive_of(fractal_dimension=dimension, fractal_roughness=roughness, reference_torque=0.1))
    assert found.stiffness == half_a_digit(stiffness)
    for value, printed in ((found.critical_area, critical), (found.largest_area, largest)):
        assert printed is None or value == half_a_digit(printed)
    assert amplitude is None or 1e9 * found.clearance == half_a_digit(amplitude)
    # the printed rms is that of one patch with random phases; over patches it scatters by 12 to 20 %
    ours = rough_contact.patch_rms(Rough(dimension=dimension, roughness=roughness), 2e-4, 1.5)
    assert rms is None or 1e9 * ours == pytest.approx(rms, rel=0.2)


# Catalogue


@pytest.mark.parametrize(("torque", "expected", "stiffness"), [
    (3.5, 3.5 / 16e3, 16e3), (7.0, 7.0 / 16e3, 16e3), (16.0, 7.0 / 16e3 + 9.0 / 25e3, 25e3),
    (25.0, 7.0 / 16e3 + 18.0 / 25e3, 25e3), (54.0, 7.0 / 16e3 + 18.0 / 25e3 + 1e-3, 29e3),
])  # fmt: skip
def test_pieces_of_size_20_above_50(torque: float, expected: float, stiffness: float) -> None:
    for sense in (1.0, -1.0):
        found = harmonic_fractal(drive_of(torque=sense * torque))
        assert found.catalogue_torsion == pytest.approx(sense * expected, rel=1e-12)
        assert found.catalogue_stiffness == stiffness


@pytest.mark.parametrize(("teeth", "column"), [(60, "30"), (79, "30"), (80, "50"), (100, "50"), (101, "above 50"),
                                               (160, "above 50"), (320, "above 50")])  # fmt: skip
def test_column_of_a_ratio(teeth: int, column: str) -> None:
    assert column_of(teeth / 2) == column
    assert (polyline_of("58", teeth / 2) is None) is (column == "30")
