"""Numbers of contact, mesh and drive as printed: tables of an independent calculation, and the maker's catalogues.

They were calculated by quadrature for steel on steel, E = 113.19 GPa and H = 3 GPa; tolerances are half a unit of the
last printed digit unless a line says otherwise. What the theory page and the findings repeat of them is tested there.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from harmonic_fractal import contact as rough_contact
from harmonic_fractal.calculation import TABLE, UNIT, column_of, harmonic_fractal, polyline_of
from harmonic_fractal.contact import Rough
from harmonic_fractal.figures import FITTED
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.published import whole_drive
from harmonic_fractal.quantities import RACES, ROW, Drive
from truing.inputs_file import setup_from_settings
from truing.kernel import Offer
from truing.setup import default_setup

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


def default_offer() -> Offer:
    """The calculation as a plugin offers it."""
    setup = default_setup(HARMONIC_FRACTAL)
    return Offer(setup.model.name, setup.model, setup.origin, setup.source.added)


def drive_with(settings: Mapping[str, str]) -> Drive:
    """The drive of these settings, as texts of an inputs file."""
    made: Drive = setup_from_settings(default_offer(), settings).inputs
    return made


def pieces(size: str) -> list[float]:
    """K_1, K_2, K_3 of the whole drive over those of the catalogue: differences of torsion over each piece to 2 T_2."""
    first, second, by_column = TABLE[size]
    ends = [0.0, first, second, 2.0 * second]
    drives = [drive_with(whole_drive(size, torque)) for torque in ends[1:]]
    torsions = [0.0, *(float(harmonic_fractal(drive).torsion) for drive in drives)]
    ours = np.diff(ends) / np.diff(torsions)
    return list(ours / (UNIT * np.array(by_column["above 50"])))


@pytest.mark.parametrize(("size", "most"), [("17", 0.09), ("20", 0.025), ("25", 0.025), ("32", 0.062), ("40", 0.03),
                                            ("50", 0.051), ("58", 0.026)])  # fmt: skip
def test_two_numbers_of_size_20_meet_the_catalogue_of_the_other_sizes(size: str, most: float) -> None:
    """By similarity alone: the catalogue is as near to K_2 of size 20 times the cube of the size."""
    assert max(abs(ratio - 1.0) for ratio in pieces(size)) < most


@pytest.mark.parametrize("size", ["25", "32", "40", "50", "58"])
def test_other_sizes_tell_nothing_of_the_split_among_parts(size: str) -> None:
    """The model's K_2 of a size is that of size 20 times the cube of the sizes, whatever the parts; so is the table."""
    cube = (float(size) / 20.0) ** 3
    _, _, by_column = TABLE[size]
    ours = float(harmonic_fractal(drive_with(whole_drive(size, 16.0 * cube))).torsional_stiffness)
    fitted = {**whole_drive(size, 16.0 * cube), "wave_torsion_stated": "0 urad"}
    softer = {**fitted, "drive_compliance": f"{29.0 / cube:.6g} urad/(N*m)"}
    other = float(harmonic_fractal(drive_with(softer)).torsional_stiffness)
    at_20 = {**whole_drive("20", 16.0), "wave_torsion_stated": "0 urad", "drive_compliance": "29 urad/(N*m)"}
    assert other / float(harmonic_fractal(drive_with(at_20)).torsional_stiffness) == pytest.approx(cube, rel=0.02)
    reference = float(harmonic_fractal(drive_with(whole_drive("20", 16.0))).torsional_stiffness)
    assert ours / reference == pytest.approx(cube, rel=0.02)
    assert by_column["above 50"][1] / 25.0 == pytest.approx(cube, rel=0.08)


def test_size_14_is_softer_than_a_small_size_20() -> None:
    """By 12, 35 and 38 %."""
    assert pieces("14") == pytest.approx([1.12, 1.35, 1.38], abs=0.005)


def test_torsion_is_the_sum_of_its_parts_and_the_stiffness_its_slope() -> None:
    """Rough contacts 0.26 %, teeth 4 %, tube 24 %, wave generator 65 %, the rest 8 % of the catalogue at T_2."""
    inputs = drive_with(whole_drive("20", 25.0))
    found = harmonic_fractal(inputs)
    torsions = [float(harmonic_fractal(replace(inputs, torque=25.0 + way)).torsion) for way in (-1e-3, 1e-3)]
    assert 2e-3 / np.diff(torsions)[0] == pytest.approx(float(found.torsional_stiffness), rel=1e-6)
    cup = 25.0 / float(found.cup_stiffness)
    parts = [found.rough_torsion, found.mesh_torsion - found.rough_torsion, cup, found.wave_torsion, 25.0 * 3.568e-6]
    shares = np.array([float(part) for part in parts]) / float(found.catalogue_torsion)
    assert shares == pytest.approx([0.0026, 0.037, 0.236, 0.648, 0.077], abs=0.002)
    assert float(found.catalogue_ratio) == pytest.approx(shares.sum(), abs=1e-4)
    backwards = harmonic_fractal(replace(inputs, torque=-25.0))
    assert backwards.torsion == pytest.approx(-float(found.torsion), rel=1e-12)


# The balls of the wave generator, calculated


def closing_of_hertz(first: float, second: float) -> float:
    """Approach of an elliptical contact of curvatures 1/m, by (load over modulus)^(2/3); Johnson 1985, 4.26."""
    low, high = sorted((first / 2.0, second / 2.0))

    def integrals(axes: float) -> tuple[float, float, float]:
        return 1.0 - axes**2, float(ellipk(1.0 - axes**2)), float(ellipe(1.0 - axes**2))

    def off(axes: float) -> float:
        _, one, two = integrals(axes)
        return (one - two) / (two / axes**2 - one) - low / high

    axes = brentq(off, 1e-4, 1.0 - 1e-9)
    squared, one, two = integrals(axes)
    longer = (3.0 * (one - two) / (2.0 * np.pi * squared * low)) ** (1.0 / 3.0)
    return float(3.0 / (2.0 * np.pi * longer) * one)


@pytest.mark.parametrize(("conformity", "share"), [(0.515, 0.97), (0.52, 1.04), (0.53, 1.14)])
def test_a_ball_closes_as_hertz_has_it(conformity: float, share: float) -> None:
    """A ball of 4 mm in grooves of 0.515 to 0.53 diameters on a circle of 40 mm: both contacts, no constant of ours."""
    ball, circle = 4e-3, 40e-3
    groove = 2.0 / ball - 1.0 / (conformity * ball)
    both = closing_of_hertz(groove, 2.0 / ball + 2.0 / (circle - ball))
    both += closing_of_hertz(groove, 2.0 / ball - 2.0 / (circle + ball))
    assert both * ball ** (1.0 / 3.0) / RACES == pytest.approx(share, abs=0.01)


@pytest.mark.parametrize("pairs", [60, 120])
def test_the_drive_turns_by_the_work_of_its_balls(pairs: int) -> None:
    """Ball by ball, at many places of the wave generator: dT theta is the sum of Q d(closing), by differences."""
    inputs = drive_with({"balls": "23", "ball_diameter": "4 mm", "engaged_pairs": str(pairs)})
    half = np.pi * 0.5 * pairs / 200.0  # of an engaged arc
    offsets = np.linspace(0.0, 2.0 * np.pi / 23.0, 40, endpoint=False)
    places = offsets[:, None] + 2.0 * np.pi * np.arange(23) / 23.0
    way = np.abs((places + 0.5 * np.pi) % np.pi - 0.5 * np.pi)
    weights = np.where(way < half, np.cos(0.5 * np.pi * way / half) ** 2, 0.0)
    shares = weights / weights.sum(axis=1, keepdims=True)
    steel = 206e9 / 0.91 / 2.0

    def stored(torque: float) -> float:
        loads = shares * torque * np.tan(np.radians(20.0)) / 25.4e-3
        closing = RACES * (loads / steel) ** (2.0 / 3.0) / 4e-3 ** (1.0 / 3.0)
        return float(np.mean(np.sum(0.6 * loads * closing, axis=1)))  # what is not work of the springs but of the load

    turned = (stored(25.0 + 1e-3) - stored(25.0 - 1e-3)) / 2e-3
    assert float(harmonic_fractal(inputs).ball_torsion) == pytest.approx(turned, rel=0.05)


def test_the_numbers_of_ball_and_row_are_those_of_palmgren_and_of_the_sum() -> None:
    """Steel of 206 GPa in N and mm; 10 000 balls under half a turn share by the square of the cosine."""
    modulus = 206e3 / (2.0 * (1.0 - 0.3**2))
    assert pytest.approx(4.36e-4 * modulus ** (2.0 / 3.0), rel=1e-3) == RACES
    angle = (np.arange(10_000) + 0.5) / 10_000 * np.pi - 0.5 * np.pi
    share = np.cos(angle) ** 2 / np.sum(np.cos(angle) ** 2)
    assert pytest.approx(len(share) ** (2.0 / 3.0) * np.sum(share ** (5.0 / 3.0)), rel=1e-4) == ROW


def test_balls_turn_the_drive_beside_what_is_stated() -> None:
    """As power 2/3 of the torque; the sheet says how far calculated balls miss the fit."""
    balls = {"balls": "23", "ball_diameter": "4 mm"}
    alone = harmonic_fractal(drive_with({**balls, "torque": "25 N*m"}))
    both = harmonic_fractal(drive_with({**balls, "torque": "25 N*m", "wave_torsion_stated": "100 urad"}))
    torsion = float(alone.ball_torsion)
    reached = 1.0 - (1e-3 / 25.0) ** (2.0 / 3.0)
    assert float(alone.wave_torsion) == pytest.approx(torsion * reached, rel=1e-12)
    assert float(both.wave_torsion) == pytest.approx((torsion + 100e-6) * reached, rel=1e-12)
    assert float(harmonic_fractal(drive_with({"torque": "25 N*m"})).ball_torsion) == 0.0
    assert f"miss that by a factor of {751.6e-6 / torsion:.0f} ({1e6 * torsion:.0f} urad, 23 balls of 4 mm)" in FITTED


@pytest.mark.parametrize(("teeth", "column"), [(60, "30"), (79, "30"), (80, "50"), (100, "50"), (101, "above 50"),
                                               (160, "above 50"), (320, "above 50")])  # fmt: skip
def test_column_of_a_ratio(teeth: int, column: str) -> None:
    assert column_of(teeth / 2) == column
    assert (polyline_of("58", teeth / 2) is None) is (column == "30")
