"""Flanks pressed numerically: a wavy one in closed form, theory over all scales, and the fractal model beside."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harmonic_fractal.contact import Rough, contact_of, equivalent_modulus, pressed
from harmonic_fractal.flank import read_flank
from harmonic_fractal.generators import brownian_surface
from harmonic_fractal.pressed import NO_FLANK, Compared, PressedFlanks, heights_of, press, slope_of
from harmonic_fractal.quantities import Drive
from harmonic_fractal.structure import log_roughness_of
from truing import TruingError

MODULUS, HARDNESS = float(equivalent_modulus(Drive())), 3e9
MATRIX = Path(__file__).parents[1] / "data" / "surfaces" / "matrix-4.txt"


def test_a_wavy_flank_is_pressed_as_its_closed_form_says() -> None:
    """Of p = p* sin²(pi a/lambda), p* = pi E h/lambda, a is in contact; the mean gap is h (1 - s + s ln s), s = p/p*.

    Westergaard 1939; Johnson, Contact Mechanics, section 13.2; the gap is the integral of its compliance.
    """
    pytest.importorskip("ContactMechanics")
    points, wave, height = 128, 64e-6, 1e-7
    spacing = wave / points
    line = height * np.cos(2.0 * np.pi * np.arange(points) / points)
    shares = np.array([0.05, 0.1, 0.3, 0.6])
    loads = shares * np.pi * MODULUS * height / wave * 4 * points * spacing**2
    found = press(np.tile(line, (4, 1)), spacing, MODULUS, HARDNESS, loads)
    assert found.contact_share == pytest.approx(2.0 / np.pi * np.arcsin(np.sqrt(shares)), abs=2.0 / points)
    assert found.gap == pytest.approx(height * (1.0 - shares + shares * np.log(shares)), rel=0.01, abs=1e-10)


@pytest.mark.parametrize(("dimension", "stiffer"), [(1.6, (1.3, 2.2)), (1.4, (5.0, 12.0))])
def test_a_gaussian_patch_has_the_stiffness_of_all_scales_and_not_that_of_the_model(
    dimension: float, stiffer: tuple[float, float]
) -> None:
    """F/K is near 0.48 rms heights (Persson; 0.35 to 0.55 on finite patches); the model is stiffer by the second."""
    pytest.importorskip("ContactMechanics")
    spacing, step = 0.4e-6, 1e-16
    heights = brownian_surface(dimension, step, (128, 128), np.random.default_rng(1))
    heights = heights - heights.mean()
    loads = np.geomspace(0.003, 0.03, 3) * MODULUS * slope_of(heights, spacing) * heights.size * spacing**2
    found = press(heights, spacing, MODULUS, HARDNESS, loads)
    assert (np.abs(found.between / found.stiffness / heights.std() - 0.45) < 0.12).all()
    level = np.log(step) - (4.0 - 2.0 * dimension) * np.log(spacing)
    rough = Rough(dimension=dimension + 1.0, roughness=float(np.exp(log_roughness_of(level, dimension))))
    fractal = pressed(found.between, contact_of(Drive(), rough)).stiffness
    ratio = np.asarray(fractal) / found.stiffness
    assert stiffer[0] < ratio.min()
    assert ratio.max() < stiffer[1]


def test_two_flanks_are_pressed_as_the_sum_of_their_heights() -> None:
    """The part that both have, holes filled; without a patch, or with other spacings, nothing."""
    flank = read_flank(MATRIX, spacing="0.369862 um", height_unit="2.91818e-8 m")
    one, both = heights_of(Drive(surface=flank)), heights_of(Drive(surface=flank, mating_surface=flank))
    assert one is not None
    assert both is not None
    np.testing.assert_allclose(both[0], 2.0 * one[0])
    assert np.isfinite(one[0]).all()
    assert heights_of(Drive()) is None
    other = replace(flank, surface=replace(flank.surface, spacing_x=1e-6))
    with pytest.raises(TruingError, match="same spacing"):
        heights_of(Drive(surface=flank, mating_surface=other))
    (words,) = Compared("pressed").blocks()
    assert words.text == NO_FLANK  # type: ignore[union-attr]


def test_without_the_library_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ContactMechanics", None)
    with pytest.raises(TruingError, match=r"truing\[contact\]"):
        press(np.zeros((4, 4)), 1e-6, MODULUS, HARDNESS, np.ones(1))
    with pytest.raises(TruingError, match="3 to 50"):
        PressedFlanks(loads=2)
