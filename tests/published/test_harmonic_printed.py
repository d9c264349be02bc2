"""Numbers of contact, mesh and drive as printed: tables of an independent calculation, and the maker's catalogues.

They were calculated by quadrature for steel on steel, E = 113.19 GPa and H = 3 GPa; tolerances are half a unit of the
last printed digit unless a line says otherwise.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harmonic_fractal import clearance
from harmonic_fractal.calculation import column_of, harmonic_fractal, polyline_of
from harmonic_fractal.contact import Rough, contact_of, interface_of, pressed
from harmonic_fractal.mesh import line_stiffness, load_of_largest, mesh_of, normal_stiffness
from harmonic_fractal.micro import domain_factor
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive

# D: psi
DOMAIN_FACTORS = [(2.05, 2.5261), (2.1, 2.4435), (2.2, 2.3014), (2.3, 2.1837), (2.4, 2.0849), (2.5, 2.0007),
                  (2.6, 1.9283), (2.7, 1.8654), (2.8, 1.8103), (2.9, 1.7616)]  # fmt: skip

# D, G in m; then under 25 N: a_c and a_L in m^2, K in N/m, b in nm, rms of a patch of 0.2 mm in nm; None: not printed
PAIRS = [
    (2.3, 1e-11, "4.25e-13", "9.27e-9", "1.721e8", "536", 815.0),
    (2.4, 1e-11, "1.57e-15", "3.15e-8", "1.95e9", "153", 172.0),
    (2.4, 1e-10, "1.57e-13", "1.15e-8", "3.542e8", "284", None),
    (2.5, 1e-11, "5.43e-17", "7.11e-8", "1.626e10", "35", 33.0),
    (2.5, 1e-9, "5.43e-13", "7.48e-9", "2.740e8", "199", 349.0),
    (2.6, 1e-9, None, None, "8.49e8", None, 100.0),
]

# F in N: K in N/m, for D = 2.4, G = 1e-11 m
OVER_LOAD = [(1e-3, "2.49e5"), (0.1, "1.59e7"), (1.0, "1.19e8"), (5.0, "4.82e8"), (10.0, "8.80e8"), (25.0, "1.95e9"),
             (50.0, "3.56e9"), (100.0, "6.50e9")]  # fmt: skip

# Size, its T_2 in N m, D, G; largest force in N, mesh in N m/rad: roughness only, and with k_t = 2e7 N/m; catalogue;
# both shares of the compliance in %
AGAINST_CATALOGUE = [
    ("14", 6.9, 2.4, 1e-11, "14", "1.03e7", "2.99e5", "6.1e3", "0.06", "2.0"),
    ("20", 25.0, 2.4, 1e-11, "35", "4.70e7", "6.38e5", "2.5e4", "0.05", "3.9"),
    ("20", 25.0, 2.5, 1e-9, "35", "6.56e6", "5.36e5", "2.5e4", "0.4", "4.7"),
    ("32", 108.0, 2.5, 1e-9, "94", "4.27e7", "1.52e6", "1.1e5", "0.3", "7.3"),
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


def logarithm_of_stiffness(**changed: Any) -> float:
    drive = drive_of(**{"fractal_dimension": 2.5, "fractal_roughness": 1e-9, **changed})
    return float(np.log(pressed(drive.pair_load, contact_of(drive, interface_of(drive))).stiffness))


# One pair


@pytest.mark.parametrize(("dimension", "printed"), DOMAIN_FACTORS)
def test_domain_factor(dimension: float, printed: float) -> None:
    assert domain_factor(dimension) == pytest.approx(printed, abs=5e-5)


def test_steel_on_steel() -> None:
    assert harmonic_fractal(drive_of()).equivalent_modulus == pytest.approx(113.19e9, abs=0.005e9)


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
    ours = clearance.patch_rms(Rough(dimension=dimension, roughness=roughness), 2e-4, 1.5)
    assert rms is None or 1e9 * ours == pytest.approx(rms, rel=0.2)


@pytest.mark.parametrize(("load", "printed"), OVER_LOAD)
def test_stiffness_over_load(load: float, printed: str) -> None:
    assert harmonic_fractal(drive_of(pair_load=load)).stiffness == half_a_digit(printed)


@pytest.mark.parametrize(("changed", "printed"), [({"tip_rule": "scaled"}, "3.47e9"),
                                                  ({"critical_rule": "yield_onset"}, "2.16e8")])  # fmt: skip
def test_other_rules(changed: dict[str, Any], printed: str) -> None:
    assert harmonic_fractal(drive_of(reference_torque=0.1, **changed)).stiffness == half_a_digit(printed)


def test_yield_onset_enlarges_the_critical_area() -> None:
    """5.2^(2/(D-2)) at D = 2.4: 3800 times; K falls by about 9."""
    usual = harmonic_fractal(drive_of())
    yielding = harmonic_fractal(drive_of(critical_rule="yield_onset", reference_torque=0.1))
    assert yielding.critical_area / usual.critical_area == pytest.approx(3800, abs=50)
    assert usual.stiffness / yielding.stiffness == pytest.approx(9.0, abs=0.5)
    assert usual.critical_pressure / yielding.critical_pressure == pytest.approx(5.2, abs=0.05)


def test_scaled_tips() -> None:
    assert harmonic_fractal(drive_of(tip_rule="scaled")).tip_factor == pytest.approx(1.78, abs=5e-3)


def test_load_exponents() -> None:
    """0.95 at 1 mN, 0.869 at 25 N; the limit is 0.875."""
    at_1_mn, at_25_n = (harmonic_fractal(drive_of(pair_load=load)).load_exponent for load in (1e-3, 25.0))
    assert at_1_mn == pytest.approx(0.95, abs=5e-3)
    assert at_25_n == pytest.approx(0.869, abs=5e-4)
    assert at_25_n == pytest.approx(0.875, abs=0.01)


@pytest.mark.parametrize(("name", "value", "relative", "printed", "digit"), [
    ("fractal_roughness", 1e-9, True, -0.88, 5e-3), ("fractal_dimension", 2.5, False, 13.2, 0.05),
    ("hardness", 3e9, True, 0.82, 5e-3), ("pair_load", 25.0, True, 0.94, 5e-3),
])  # fmt: skip
def test_partial_derivatives(name: str, value: float, relative: bool, printed: float, digit: float) -> None:
    step = 1e-4
    low, high = ((value * (1 + way) if relative else value + way) for way in (-step, step))
    slope = (logarithm_of_stiffness(**{name: high}) - logarithm_of_stiffness(**{name: low})) / (2 * step)
    assert slope == pytest.approx(printed, abs=digit)


def test_first_elastic_load() -> None:
    assert harmonic_fractal(drive_of()).plastic_limit == pytest.approx(1.4e-5, abs=0.05e-5)


def test_stiffness_beside_one_in_proportion_to_the_load() -> None:
    """F/(0.48 h_rms), Persson 2007: the fractal pair is stiffer by 1.6 to 2.7 or by 6 to 10, with h_rms of one patch.

    With the mean rms of patches the same two groups stand at 1.8 to 3.0 and at 6.5 to 10.9.
    """
    for dimension, roughness, least, most in ((2.3, 1e-11, 1.6, 3.0), (2.5, 1e-9, 1.6, 3.0), (2.6, 1e-9, 1.6, 3.0),
                                              (2.4, 1e-11, 6.0, 11.0), (2.5, 1e-11, 6.0, 11.0)):  # fmt: skip
        drive = drive_of(fractal_dimension=dimension, fractal_roughness=roughness)
        rough = interface_of(drive)
        other = 25.0 / (0.48 * clearance.patch_rms(rough, 2e-4, 1.5))
        assert least < pressed(25.0, contact_of(drive, rough)).stiffness / other < most


# Mesh and drive


@pytest.mark.parametrize(
    ("size", "torque", "dimension", "roughness", "force", "rough", "with_teeth", "printed", "share", "teeth_share"),
    AGAINST_CATALOGUE,
)
def test_mesh_against_the_catalogue(
    size: str, torque: float, dimension: float, roughness: float, force: str, rough: str, with_teeth: str,
    printed: str, share: str, teeth_share: str,
) -> None:  # fmt: skip
    found = []
    for tooth in (np.nan, 2e7):
        drive = drive_of(fractal_dimension=dimension, fractal_roughness=roughness, catalogue_size=size, torque=torque,
                         pitch_radius=float(size) * 1.27e-3, tooth_stiffness=tooth,
                         reference_torque=0.1)  # fmt: skip
        found.append(harmonic_fractal(drive))
    assert found[0].largest_pair_force == half_a_digit(force)
    assert found[0].mesh_stiffness == half_a_digit(rough)
    assert found[1].mesh_stiffness == half_a_digit(with_teeth)
    assert found[0].catalogue_stiffness == half_a_digit(printed)
    assert 100.0 * found[0].catalogue_stiffness / found[0].mesh_stiffness == half_a_digit(share)
    assert 100.0 * found[1].catalogue_stiffness / found[1].mesh_stiffness == half_a_digit(teeth_share)


@pytest.mark.parametrize(("dimension", "roughness", "printed"), [(2.5, 1e-9, 4e5), (2.4, 1e-11, 2.8e6)])
def test_what_roughness_alone_would_make_of_kappa(dimension: float, roughness: float, printed: float) -> None:
    """K_mesh = kappa T^0.875 at T_2 of size 20."""
    drive = drive_of(fractal_dimension=dimension, fractal_roughness=roughness)
    mesh = mesh_of(drive, contact_of(drive, interface_of(drive)))
    kappa = normal_stiffness(25.0, mesh) * mesh.radius**2 / 25.0**0.875
    assert kappa == pytest.approx(printed, rel=0.03)
    assert load_of_largest(25.0, mesh) == pytest.approx(35.0, abs=0.5)


def test_springs_in_series() -> None:
    """A cup of 24.5 x 0.35 x 28 mm: 9e4 N m/rad; line contact over 10 mm: 1.8e9 N/m."""
    drive = drive_of(cup_length=28e-3)
    assert harmonic_fractal(drive).cup_stiffness == pytest.approx(9e4, rel=0.02)
    assert line_stiffness(drive, contact_of(drive, interface_of(drive))) == pytest.approx(1.8e9, abs=0.05e9)


def test_free_play() -> None:
    """0.2 um of clearance at both flanks of size 20: 1.7e-5 rad, 0.06 arcmin."""
    found = harmonic_fractal(drive_of(peak_height=0.4e-6, pair_load=1e-4))
    assert found.closing_clearance == pytest.approx(0.2e-6, rel=1e-12)
    assert found.free_play == pytest.approx(1.7e-5, abs=0.05e-5)


# Catalogue


def test_first_piece_of_size_20() -> None:
    """Ratio 50: 7.0 N m over 1.3e4 N m/rad; the catalogue prints 5.2e-4 rad, rounded."""
    printed = polyline_of("20", 50.0)
    assert printed is not None
    assert printed.torsion(7.0) == pytest.approx(5.4e-4, abs=0.05e-4)
    assert printed.torsion(7.0) == pytest.approx(5.2e-4, rel=0.05)


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


# Size, exponent m: K_s in N m/rad, kappa in N m/rad per (N m)^m, residual in urad; None: not printed
FITS = [
    ("20", 0.875, "2.71e4", "6.0e4", 34.0), ("20", 0.5, "3.50e4", "2.4e4", 15.0), ("14", 0.875, None, None, 30.0),
    ("14", 0.5, None, None, 16.0), ("32", 0.875, None, None, 29.0), ("32", 0.5, None, None, 13.0),
]  # fmt: skip


@pytest.mark.parametrize(("size", "exponent", "series", "kappa", "residual"), FITS)
def test_spring_and_contact_fitted_to_the_catalogue(
    size: Any, exponent: float, series: str | None, kappa: str | None, residual: float
) -> None:
    """theta = T/K_s + T^(1-m)/(kappa (1-m)) up to 2 T_2, least squares; the sampling of T is not printed."""
    printed = polyline_of(size, 100.0)
    assert printed is not None
    torque = printed.second_torque * np.arange(1, 401) / 200.0
    terms = np.stack([torque, torque ** (1.0 - exponent) / (1.0 - exponent)], axis=1)
    turned = np.asarray(printed.torsion(torque))
    found = np.linalg.lstsq(terms, turned, rcond=None)[0]
    rms = 1e6 * np.sqrt(np.mean((turned - terms @ found) ** 2))
    assert rms == pytest.approx(residual, abs=1.0)
    assert series is None or 1.0 / found[0] == half_a_digit(series)
    assert kappa is None or 1.0 / found[1] == half_a_digit(kappa)
    if size == "20":
        assert 1e6 * turned[-1] == pytest.approx(2020.0, abs=0.5)
