"""Flanks pressed numerically: a wavy one in closed form, theory over all scales, and the fractal model beside."""

import sys
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.optimize import nnls

from harmonic_fractal.contact import Rough, contact_of, equivalent_modulus, pressed
from harmonic_fractal.flank import Flank, options_of, prepared, with_choice
from harmonic_fractal.generators import brownian_surface
from harmonic_fractal.pressed import NO_FLANK, PROFILE, Compared, PressedFlanks, heights_of, press
from harmonic_fractal.quantities import Drive
from harmonic_fractal.surface import Surface
from truing import TruingError
from unit.test_harmonic_levelling import DEFAULTS, SPACING

MODULUS, HARDNESS = float(equivalent_modulus(Drive())), 3e9


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


# Two flanks: each a body of its own, solved densely; waves that add, cross, or lie in one another

POINTS, LENGTH = 16, 64e-6
ALONG = 2.0 * np.pi * np.arange(POINTS) / POINTS
Y, X = np.meshgrid(ALONG, ALONG, indexing="ij")  # rows are y


def integral(x: np.ndarray, y: np.ndarray, half: float) -> np.ndarray:
    """The integral of 1/r over a square of this half side, seen from (x, y) off its corners (Love 1929)."""

    def corner(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))

    return (
        corner(x + half, y + half) - corner(x - half, y + half) - corner(x + half, y - half)
        + corner(x - half, y - half)
    )  # fmt: skip


@cache
def compliance(images: int = 5) -> np.ndarray:
    """Displacements (n², n²) of a body of 1 Pa, m, per pressure, Pa: squares of pressure and their images, one by one.

    The mean pressure of all images is taken off, as one large square: it moves the body as a whole.
    """
    spacing = LENGTH / POINTS
    ways = ((np.arange(POINTS) + POINTS // 2) % POINTS - POINTS // 2) * spacing + 1e-12
    x, y = np.meshgrid(ways, ways)
    shifts = LENGTH * np.arange(-images, images + 1)
    kernel = sum(integral(x + right, y + down, spacing / 2.0) for right in shifts for down in shifts)
    kernel = (kernel - integral(x, y, (images + 0.5) * LENGTH) / POINTS**2) / np.pi
    apart = (np.arange(POINTS)[:, None] - np.arange(POINTS)) % POINTS
    return (kernel - kernel.mean())[apart[:, None, :, None], apart[None, :, None, :]].reshape(2 * (POINTS**2,))


def pressed_densely(first: np.ndarray, second: np.ndarray, moduli: tuple[float, float], mean: float) -> Any:
    """Load, mean gap and share in contact of two bodies, each with its own heights and its own displacements.

    min p (A_1 + A_2) p/2 - h p with p >= 0, by active sets on a dense matrix; the mean pressure is held by a penalty.
    """
    bodies = [compliance() / modulus for modulus in moduli]
    heights = (first + second).ravel()
    stiff = 100.0 * np.abs(bodies[0] + bodies[1]).max()
    root = np.linalg.cholesky(bodies[0] + bodies[1] + stiff).T
    pressure, _ = nnls(root, np.linalg.solve(root.T, heights + stiff * mean * heights.size))
    upper = second.ravel() - bodies[1] @ pressure  # its surface, down from its mean plane
    lower = first.ravel() - bodies[0] @ pressure
    gap = -(lower + upper)
    assert (gap[pressure > 0.0] - gap.min()).max() < 1e-3 * np.ptp(heights)
    return pressure.sum() * (LENGTH / POINTS) ** 2, float(np.mean(gap - gap.min())), float(np.mean(pressure > 0.0))


WAVES = {
    "another length and direction": (1e-7 * np.cos(X), 0.5e-7 * np.cos(X + 2.0 * Y)),
    "crossed": (1e-7 * np.cos(X), 1e-7 * np.cos(Y)),
}


@pytest.mark.parametrize("waves", WAVES)
@pytest.mark.parametrize("share", [0.05, 0.4])
def test_two_elastic_bodies_are_pressed_as_one_of_both(waves: str, share: float) -> None:
    """Steel on aluminium, densely, with squares of pressure in real space: as one rough body on a rigid flat."""
    pytest.importorskip("ContactMechanics")
    first, second = WAVES[waves]
    moduli = (2.2e11, 0.8e11)
    modulus = 1.0 / (1.0 / moduli[0] + 1.0 / moduli[1])
    mean = share * np.pi * modulus * 2e-7 / LENGTH
    load, gap, touching = pressed_densely(first, second, moduli, mean)
    found = press(first + second, LENGTH / POINTS, modulus, HARDNESS, np.array([load]))
    assert found.gap[0] == pytest.approx(gap, rel=0.03)
    assert found.contact_share[0] == pytest.approx(touching, abs=0.02)


def test_two_waves_touch_wholly_from_the_sum_of_their_pressures_on() -> None:
    """Full contact needs the mean pressure pi E (h_1/l_1 + h_2/l_2), whatever their lengths and directions.

    The pressure of full contact is linear in the heights, with the amplitude pi E h/l of each wave (Johnson, 13.2).
    """
    pytest.importorskip("ContactMechanics")
    fine = 2.0 * np.pi * np.arange(48) / 48
    y, x = np.meshgrid(fine, fine, indexing="ij")
    heights = 1e-7 * np.cos(x) + 0.5e-7 * np.cos(x + 2.0 * y)
    least = np.pi * MODULUS * (1e-7 + 0.5e-7 * np.sqrt(5.0)) / LENGTH * LENGTH**2
    found = press(heights, LENGTH / 48, MODULUS, HARDNESS, least * np.array([0.9, 1.03]))
    assert found.contact_share[0] < 1.0
    assert found.contact_share[1] == 1.0
    assert found.gap[1] == pytest.approx(0.0, abs=1e-12)


def flank_of(heights: np.ndarray, spacing_y: float = 1e-6) -> Flank:
    """A flank of these heights, not estimated; the study asks for no more where a stated D stands beside."""
    surface = Surface(heights, 1e-6, spacing_y, "made")
    return Flank(raw=surface, surface=surface, estimates=(), chosen=None, reason="", warnings=())


def test_the_mate_is_turned_over() -> None:
    """Ridges at the same angle on both flanks cross once one lies on the other; the part that both have is pressed."""
    x, y = np.meshgrid(np.arange(32), np.arange(24))
    oblique = 1e-7 * np.cos(2.0 * np.pi * (x + y) / 8.0)
    found = heights_of(Drive(surface=flank_of(oblique), mating_surface=flank_of(oblique[:, :24])))
    assert found is not None
    spectrum = np.abs(np.fft.fft2(found[0]))
    assert spectrum[3, 3] == pytest.approx(spectrum[-3, 3], rel=1e-9)
    assert found[0].std() == pytest.approx(np.sqrt(2.0) * oblique.std(), rel=1e-9)


def test_holes_are_filled_and_without_a_patch_there_is_nothing() -> None:
    holed = np.ones((4, 8))
    holed[1, 3] = np.nan
    found = heights_of(Drive(surface=flank_of(holed)))
    assert found is not None
    np.testing.assert_array_equal(found[0], np.ones((4, 8)))
    assert heights_of(Drive()) is None
    (words,) = Compared("pressed", reason=NO_FLANK).blocks()
    assert words.text == NO_FLANK  # type: ignore[union-attr]


def asked(drive: Drive) -> Compared:
    """The study of one drive."""
    return PressedFlanks(loads=3).run(SimpleNamespace(inputs=drive))  # type: ignore[arg-type]


def measured(heights: np.ndarray, **options: Any) -> Flank:
    """A flank of these heights, cleaned and estimated as a measured one."""
    settings = options_of({**DEFAULTS, **options})
    return with_choice(prepared(Surface(heights, SPACING, SPACING, "made"), settings), settings)


def test_crests_in_troughs_do_not_add() -> None:
    """A flank on its own print: nothing is left of the roughness that the fractal model adds, and the sheet says so."""
    pytest.importorskip("ContactMechanics")
    flank = measured(brownian_surface(1.5, 1e-16, (80, 100), np.random.default_rng(4)), direction="x", spikes="keep")
    mate = replace(flank, surface=replace(flank.surface, heights=-0.9 * flank.surface.heights[:, ::-1]))
    found = asked(Drive(surface=flank, mating_surface=mate))
    assert found.height == pytest.approx(0.1 * flank.surface.heights.std(), rel=0.01)
    text = found.blocks()[0].text  # type: ignore[union-attr]
    assert f"{0.1 / np.hypot(1.0, 0.9):.2f} times that of flanks that know nothing of one another" in text


def test_what_cannot_be_pressed_ends_no_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two spacings, a profile, or no library: a sentence, and what the rms height alone says."""
    flank = measured(brownian_surface(1.5, 1e-16, (80, 100), np.random.default_rng(4)), direction="x", spikes="keep")
    oblong = replace(flank, surface=replace(flank.surface, spacing_y=1e-6))
    profile = replace(flank, surface=replace(flank.surface, heights=flank.surface.heights[:1], spacing_y=np.nan))
    monkeypatch.setitem(sys.modules, "ContactMechanics", None)
    told = ((oblong, "same spacing", True), (profile, PROFILE, False), (flank, "truing[contact]", True))
    for one, reason, is_missing in told:
        found = asked(Drive(surface=one))
        assert reason in found.blocks()[0].text  # type: ignore[union-attr]
        assert bool(found.warnings()) is is_missing
        rough = Rough(dimension=one.used.dimension + 1.0, roughness=one.used.roughness)  # type: ignore[union-attr]
        expected = pressed(25.0, contact_of(Drive(), rough)).stiffness * 0.48 * one.surface.heights.std() / 25.0
        assert found.by_height == pytest.approx(float(expected), rel=1e-9)
        assert "times that" in found.blocks()[1].text  # type: ignore[union-attr]


def test_a_refused_flank_is_compared_with_its_own_fit_and_not_with_what_was_stated() -> None:
    pytest.importorskip("ContactMechanics")
    heights = gaussian_filter(brownian_surface(1.4, 1e-16, (80, 100), np.random.default_rng(4)), 4.0)
    flank = measured(heights)
    assert flank.used is None
    found = asked(Drive(surface=flank))
    assert "which is refused: for comparison only" in found.words
    assert f"D = {flank.estimates[0].dimension + 1.0:.3f}" in found.words
    if flank.estimates[0].dimension > 1.05:
        rough = Rough(dimension=flank.estimates[0].dimension + 1.0, roughness=flank.estimates[0].roughness)
        expected = pressed(found.numbers.between, contact_of(Drive(), rough)).stiffness  # type: ignore[union-attr]
        assert found.fractal == pytest.approx(np.asarray(expected))


def test_loads_are_few_or_many_enough() -> None:
    with pytest.raises(TruingError, match="3 to 50"):
        PressedFlanks(loads=2)
