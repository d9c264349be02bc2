"""Contact of one rough pair: closed forms beside quadrature, laws of scale, limits, and the clearance."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from harmonic_by_quadrature import RoughPair
from harmonic_drives import drive_of
from scipy.integrate import quad

from harmonic_fractal import contact as rough_contact
from harmonic_fractal import micro
from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.contact import Contact, Rough, contact_of, interface_of, pressed, range_of, spacing_of
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank import Flank
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.structure import structure_function
from harmonic_fractal.surface import Surface
from truing.errors import InfeasibleError
from truing.evaluate import evaluate_rows
from truing.setup import default_setup

SURFACES = [(2.1, 1e-22), (2.3, 1e-11), (2.4, 1e-11), (2.5 - 1e-7, 1e-9), (2.5, 1e-9), (2.5 + 1e-7, 1e-9),
            (2.6, 1e-9), (2.9, 1e-9)]  # fmt: skip
LOADS = np.geomspace(1e-8, 1e3, 34)


def contact(dimension: float = 2.4, roughness: float = 1e-11, **changed: Any) -> Contact:
    """The contact of a surface on steel."""
    drive = drive_of(fractal_dimension=dimension, fractal_roughness=roughness, **changed)
    return contact_of(drive, interface_of(drive))


# Domain factor


def test_domain_factor_solves_its_equation() -> None:
    dimension = np.linspace(2.01, 2.99, 99)
    expected = [RoughPair(value, 1e-11).domain_factor for value in dimension]
    np.testing.assert_allclose(micro.domain_factor(dimension), expected, rtol=1e-12)


# Closed forms beside quadrature over single contacts


@pytest.mark.parametrize("rule", ["hardness", "yield_onset"])
@pytest.mark.parametrize(("dimension", "roughness"), SURFACES)
def test_load_stiffness_and_areas_are_the_integrals_over_all_contacts(
    dimension: float, roughness: float, rule: str
) -> None:
    ours = contact(dimension, roughness, critical_rule=rule)
    pressure = 3e9 if rule == "hardness" else 3e9 * (0.454 + 0.41 * 0.3) / 3
    pair = RoughPair(dimension, roughness, pressure=pressure)
    assert ours.critical_area == pytest.approx(pair.critical_area, rel=1e-9)
    for load in (1e-3, 25.0, 400.0):
        found = pressed(load, ours)
        assert pair.load(float(found.largest_area)) == pytest.approx(load, rel=1e-6)
        assert found.stiffness == pytest.approx(pair.stiffness(float(found.largest_area)), rel=1e-6)
        truncated, real = pair.areas(float(found.largest_area))
        assert found.contact_area == pytest.approx(truncated, rel=1e-6)
        assert found.real_area == pytest.approx(real, rel=1e-6)


@pytest.mark.parametrize(("dimension", "roughness"), SURFACES)
def test_tip_clearance_and_slope_of_one_surface(dimension: float, roughness: float) -> None:
    """A tip radius that follows the area makes the pair stiffer; the clearance twice is the largest interference.

    From load to largest area and back; the load exponent is the slope of the stiffness.
    """
    pair, ours, step = RoughPair(dimension, roughness), contact(dimension, roughness), 1e-5
    scaled = pressed(400.0, contact(dimension, roughness, tip_rule="scaled"))
    assert scaled.stiffness == pytest.approx(pair.stiffness(float(scaled.largest_area), following=True), rel=1e-6)
    size = micro.size_of(np.log(LOADS / ours.plastic_limit), ours.law)
    back = np.exp(micro.load_logarithm(size, ours.law)) * ours.plastic_limit
    np.testing.assert_allclose(back, LOADS, rtol=1e-12)
    low, here, high = (pressed(25.0 * np.exp(way), ours) for way in (-step, 0.0, step))
    slope = np.log(high.stiffness / low.stiffness) / (2.0 * step)
    assert here.load_exponent == pytest.approx(slope, rel=1e-7)
    largest = float(here.largest_area)
    once = rough_contact.amplitude(np.sqrt(largest / np.pi), ours, 1.5)
    assert 2.0 * once == pytest.approx(pair.interference(largest), rel=1e-12)


@pytest.mark.parametrize("beyond", [1e-12, 1e-9, 1e-6, 1e-3])
def test_just_above_the_plastic_limit_the_stiffness_rises_in_proportion(beyond: float) -> None:
    law = micro.ContactLaw(2.4, 1.0)
    size = micro.size_of(np.log1p(beyond), law)
    slope = micro.load_slope(1e-300, law)
    assert size == pytest.approx(beyond / slope, rel=max(2 * beyond, 1e-11))
    assert micro.stiffness_share(size, law) == pytest.approx(0.2 * size, rel=max(2 * beyond, 1e-11))


def test_below_the_plastic_limit_there_is_no_stiffness_and_no_crash() -> None:
    ours = contact()
    found = pressed(ours.plastic_limit * np.array([1e-20, 0.5, 1.0]), ours)
    assert (found.stiffness == 0.0).all()
    assert (found.load_exponent == 0.0).all()
    np.testing.assert_allclose(found.contact_area, ours.plastic_limit * np.array([1e-20, 0.5, 1.0]) / 3e9, rtol=1e-12)
    np.testing.assert_allclose(found.real_area, found.contact_area, rtol=1e-12)


# Clearance


def test_three_readings_of_the_clearance() -> None:
    ours = {}
    for rule in ("amplitude", "interference", "patch"):
        drive = drive_of(clearance_rule=rule)
        radius, multiple = rough_contact.read_radius(drive, 1e-4)
        ours[rule] = multiple * rough_contact.amplitude(radius, contact(), 1.5)
    assert ours["interference"] == pytest.approx(2.0 * ours["amplitude"], rel=1e-12)
    # the wave as long as the patch: G^(D-2) sqrt(ln 1.5) L^(3-D)
    assert ours["patch"] == pytest.approx(1e-11**0.4 * np.sqrt(np.log(1.5)) * 2e-4**0.6, rel=1e-12)


@pytest.mark.parametrize(("dimension", "roughness", "first"), [
    (2.1, 1e-22, 1e-3), (2.3, 1e-11, 4e-3), (2.4, 1e-11, 1e-3), (2.4, 1e-11, 1.4e-5), (2.5, 1e-9, 1.0),
    (2.6, 1e-9, 1e-3), (2.9, 1e-9, 1e-2),
])  # fmt: skip
def test_the_approach_is_the_integral_of_the_compliance(dimension: float, roughness: float, first: float) -> None:
    ours = contact(dimension, roughness)
    assert first > ours.plastic_limit
    expected = quad(
        lambda x: np.exp(x) / pressed(np.exp(x), ours).stiffness, np.log(first), np.log(25.0),
        points=[np.log(first * (1.0 + 10.0**-k)) for k in range(1, 4)], limit=500, epsabs=0.0, epsrel=1e-11,
    )[0]  # fmt: skip
    assert rough_contact.approach(25.0, first, ours) == pytest.approx(expected, rel=1e-8)


def test_the_approach_from_the_plastic_limit_has_no_end() -> None:
    """Near F_c the stiffness rises in proportion, so each step towards it adds as much as the last one."""
    ours = contact()
    added = [rough_contact.approach(25.0, ours.plastic_limit * (1.0 + 10.0**-k), ours) for k in (4, 5, 6, 7)]
    steps = np.diff(added)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-3)
    assert steps[0] > 1e-9
    assert rough_contact.approach(25.0, ours.plastic_limit, ours) == np.inf
    assert rough_contact.approach(1e-3, 2e-3, ours) == 0.0


def test_height_of_a_patch_from_its_waves() -> None:
    """The rms is that of the sum of all waves; the height is that of patches summed with random phases."""
    rng, ratio, length = np.random.default_rng(11), 1.5, 2e-4
    order, ridges = np.arange(14), 20
    for dimension in (2.3, 2.5, 2.7):
        rough = Rough(dimension=dimension, roughness=1e-11)
        size = length * (1e-11 / length) ** (dimension - 2.0) * np.sqrt(np.log(ratio) / ridges)
        sizes = np.repeat(size * ratio ** ((dimension - 3.0) * order), ridges)
        rms = np.sqrt(0.5 * np.sum(sizes**2))
        assert rough_contact.patch_rms(rough, length, ratio) == pytest.approx(rms, rel=0.02)
        number = 2.0 * np.pi * np.repeat(ratio**order, ridges) / length
        angle = np.tile(np.pi * np.arange(ridges) / ridges, len(order))
        along = np.exp(1j * np.outer(np.linspace(0.0, length, 201), number * np.cos(angle)))
        across = np.exp(1j * np.outer(number * np.sin(angle), np.linspace(0.0, length / 2.0, 101)))
        heights = []
        for _ in range(12):
            phases = np.exp(2j * np.pi * rng.random(len(sizes)))
            heights.append(np.ptp(((along * (sizes * phases)) @ across).real))
        assert rough_contact.patch_height(rough, length, ratio) == pytest.approx(np.mean(heights), rel=0.12)


def test_heights_are_stated_else_of_the_patch_else_none() -> None:
    assert rough_contact.heights(drive_of(peak_height=2e-6)) == (2e-6, 0.0)
    first, second = rough_contact.heights(drive_of(mating_dimension=2.4, mating_roughness=1e-11))
    of_patch = rough_contact.patch_height(Rough(dimension=2.4, roughness=1e-11), 2e-4, 1.5)
    assert (first, second) == pytest.approx((of_patch, of_patch), rel=1e-12)


# Two rough flanks as one, and what must hold before a drive is calculated.

LAGS = np.geomspace(0.4e-6, 20e-6, 16)


@pytest.mark.parametrize("dimension", [2.2, 2.4, 2.5, 2.8])
def test_flanks_of_one_dimension_add_powers_of_their_roughness(dimension: float) -> None:
    both = interface_of(drive_of(fractal_dimension=dimension, fractal_roughness=1e-11, mating_dimension=dimension,
                                 mating_roughness=3e-10))  # fmt: skip
    power = 2.0 * (dimension - 2.0)
    assert both.dimension == pytest.approx(dimension, rel=1e-12)
    assert both.roughness**power == pytest.approx(1e-11**power + 3e-10**power, rel=1e-10)


def test_unlike_flanks_are_one_power_law_near_their_sum() -> None:
    both = interface_of(drive_of(fractal_dimension=2.3, fractal_roughness=1e-11, mating_dimension=2.5,
                                 mating_roughness=1e-9))  # fmt: skip
    one, other = structure_function(LAGS, 1.3, 1e-11), structure_function(LAGS, 1.5, 1e-9)
    expected = np.polyfit(np.log(LAGS), np.log(np.asarray(one) + other), 1)
    assert both.dimension == pytest.approx(3.0 - expected[0] / 2.0, rel=1e-9)
    fitted = structure_function(LAGS, both.dimension - 1.0, both.roughness)
    np.testing.assert_allclose(np.log(fitted), np.polyval(expected, np.log(LAGS)), atol=1e-9)


def test_a_smooth_mate_changes_nothing_and_deviations_come_last() -> None:
    alone = interface_of(drive_of(dimension_deviation=0.03, roughness_deviation=-0.7))
    assert alone.dimension == pytest.approx(2.43, rel=1e-12)
    assert alone.roughness == pytest.approx(1e-11 * np.exp(-0.7), rel=1e-12)
    rows = interface_of(drive_of(mating_dimension=np.array([np.nan, 2.4]), mating_roughness=np.array([np.nan, 1e-11])))
    np.testing.assert_allclose(rows.roughness, 1e-11 * np.array([1.0, 2.0 ** (1 / 0.8)]), rtol=1e-10)


# Measured flanks


def measured(dimension: float, roughness: float, ends: tuple[float, float], spacing: float) -> Flank:
    """A flank of 2 by 2 points, 1 um high, that was found to have this profile dimension and roughness."""
    surface = Surface(np.array([[0.0, 1e-6], [0.0, 0.5e-6]]), spacing, spacing, "made by hand")
    nothing = np.empty(0)
    estimate = Estimate(
        direction="x", lags=nothing, values=nothing, local_lags=nothing, local_dimensions=nothing, dimension=dimension,
        roughness=roughness, r_squared=1.0, line_scatter=0.0, noise=0.0, range=ends, reason="",
        resampled=np.empty((0, 2)), spacing=spacing,
    )  # fmt: skip
    return Flank(raw=surface, surface=surface, estimates=(estimate,), chosen="x", reason="", warnings=())


def test_a_measured_flank_replaces_what_is_stated() -> None:
    drive = drive_of(surface=measured(1.5, 1e-9, (1e-6, 12e-6), 0.7e-6))
    both = interface_of(drive)
    assert (both.dimension, both.roughness) == (2.5, 1e-9)
    found = harmonic_fractal(replace(drive, reference_torque=0.1))
    assert found.spacing == 0.7e-6
    assert found.rough_height == 1e-6
    assert found.surface_accepted == 1.0
    assert found.resolved_share == pytest.approx(np.sqrt(5.43e-13 / np.pi) / 0.7e-6, rel=1e-3)


def test_a_refused_flank_leaves_what_is_stated_and_says_so() -> None:
    refused = replace(measured(1.5, 1e-9, (1e-6, 12e-6), 0.7e-6), chosen=None, reason="no self-affine range")
    found = harmonic_fractal(drive_of(surface=refused))
    assert (found.dimension, found.roughness) == (2.4, 1e-11)
    assert (found.surface_accepted, found.rough_height) == (0.0, 1e-6)
    assert found.spacing == pytest.approx(0.4e-6, rel=1e-14)


def test_two_measured_flanks_are_added_over_the_range_that_both_have() -> None:
    drive = drive_of(surface=measured(1.3, 1e-11, (1e-6, 12e-6), 0.7e-6),
                     mating_surface=measured(1.5, 1e-9, (2e-6, 30e-6), 0.5e-6))  # fmt: skip
    assert range_of(drive) == (2e-6, 12e-6)
    assert spacing_of(drive) == 0.7e-6
    lags = np.geomspace(2e-6, 12e-6, 16)
    heights = np.asarray(structure_function(lags, 1.3, 1e-11)) + structure_function(lags, 1.5, 1e-9)
    slope = np.polyfit(np.log(lags), np.log(heights), 1)[0]
    assert interface_of(drive).dimension == pytest.approx(3.0 - slope / 2.0, rel=1e-9)
    apart = replace(drive, mating_surface=measured(1.5, 1e-9, (20e-6, 30e-6), 0.5e-6))
    with np.errstate(all="ignore"), pytest.raises(InfeasibleError, match="measure both flanks alike"):
        harmonic_fractal(apart)


# What must hold


def test_a_smooth_mate_needs_no_range_of_lags() -> None:
    assert np.isfinite(harmonic_fractal(drive_of(longest_lag=0.4e-6)).stiffness)


def test_in_a_batch_the_other_rows_go_on() -> None:
    dimension = np.array([2.4, 2.03, 2.97, 2.3, 2.45, 1.99, 3.02])
    rows = evaluate_rows(default_setup(HARMONIC_FRACTAL), {"fractal_dimension": dimension}, len(dimension))
    np.testing.assert_array_equal(rows.failed, [False, True, True, False, False, True, True])
    assert np.isfinite(rows.results["torsion"][[0, 4]]).all()
    assert "below 2.05" in rows.reasons[1]
    assert "above 2.95" in rows.reasons[2]
    assert "reference_torque" in rows.absent["torsion"][3]
    assert np.isfinite(rows.results["stiffness"][3])


def test_an_all_plastic_pair_is_told_not_refused() -> None:
    found = harmonic_fractal(drive_of(pair_load=1e-5, torque=5e-6))
    assert (found.stiffness, found.mesh_stiffness, found.torsion, found.load_exponent) == (0.0, 0.0, 0.0, 0.0)
    assert found.plastic_share == 1.0
    assert harmonic_fractal(drive_of()).plastic_share < 0.1


def test_a_smooth_mate_beside_rough_ones_has_no_height() -> None:
    """In a batch, too: rows without a mating flank are those of the drive without one."""
    nothing = float("nan")
    columns = {"mating_dimension": np.array([2.4, nothing]), "mating_roughness": np.array([1e-11, nothing])}
    rows = evaluate_rows(default_setup(HARMONIC_FRACTAL), columns, 2)
    rough, smooth = rows.results["mating_rough_height"]
    assert not rows.failed.any()
    assert rough > 0
    assert smooth == 0
