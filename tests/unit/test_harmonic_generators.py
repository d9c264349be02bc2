"""Made surfaces of harmonic_fractal: exact sums, sums over random phases, and Brownian motion by its formula."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from harmonic_fractal import generators
from harmonic_fractal import made_flank as making
from harmonic_fractal.flank import read_flank
from harmonic_fractal.generators import Array, Waves, brownian_profiles, profile_sum, surface_sum
from harmonic_fractal.made_flank import FlankFile, Made, as_measured, made_flank, surface_of
from harmonic_fractal.made_sheet import MADE_FLANK, SECTIONS
from harmonic_fractal.structure import structure_function
from truing import Drawing, Kernel, Record, Table, Words
from truing.calculation import calculate
from truing.declare.batch import watching
from truing.errors import InfeasibleError
from truing.inputs_file import setup_from_text
from truing.setup import default_setup

SPACING = 0.4e-6
LENGTH = 200e-6


def waves(dimension: float, roughness: float = 1e-11, **other: float) -> Waves:
    """A band wide enough to try an estimator on 501 points of 0.4 um."""
    band = {"lowest": 1.0 / (100.0 * LENGTH), "highest": 50.0 / SPACING, **other}
    return Waves(dimension=dimension, roughness=roughness, **band)  # type: ignore[arg-type]


def squares(heights: Array, step: int) -> Array:
    """Mean square of the difference of height over so many points, line by line."""
    return np.asarray(np.mean((heights[:, step:] - heights[:, :-step]) ** 2, axis=1))


@pytest.mark.parametrize("dimension", [1.3, 1.7])
def test_lines_of_random_phases_have_the_exact_structure_function(dimension: float) -> None:
    made = waves(dimension)
    lines = generators.weierstrass_profile(made, SPACING * np.arange(501), 200, np.random.default_rng(4))
    assert lines.shape == (200, 501)
    np.testing.assert_allclose(lines[:, 0], 0.0, atol=1e-15)
    for step in (1, 3, 10, 30, 50):
        each = squares(lines, step)
        exact = profile_sum(made, np.array([step * SPACING]))[0]
        assert abs(each.mean() - exact) < 3.0 * each.std(ddof=1) / np.sqrt(200)


def test_the_sum_over_many_directions_is_the_areal_law_along_any_trace() -> None:
    made = Waves(dimension=1.4, roughness=1e-11, lowest=1e-3, highest=1e11, density=1.1, directions=200)  # no ripple
    lags = np.geomspace(1e-6, 1e-5, 20)
    for angle in (0.0, 0.3, np.pi / 2):
        ratio = surface_sum(made, lags, angle) / structure_function(lags, 1.4, 1e-11)
        np.testing.assert_allclose(ratio, 1.0, atol=0.003)


def test_one_direction_is_the_profile_but_for_the_logarithm_of_the_density() -> None:
    made = waves(1.45, directions=1)
    lags = np.geomspace(1e-7, 1e-4, 30)
    np.testing.assert_allclose(surface_sum(made, lags), np.log(1.5) * profile_sum(made, lags), rtol=1e-13)
    np.testing.assert_allclose(surface_sum(made, lags, np.pi / 2), 0.0, atol=1e-30)  # along the ridges


def test_a_patch_is_the_sum_over_its_waves_one_by_one() -> None:
    made = Waves(dimension=1.4, roughness=1e-10, lowest=2e3, highest=3e5, density=1.7, directions=5)
    x, y = 1.3e-6 * np.arange(7) - 2e-6, 0.7e-6 * np.arange(5)
    patch = generators.weierstrass_surface(made, x, y, np.random.default_rng(7))
    phases = np.random.default_rng(7).uniform(0.0, 2.0 * np.pi, (5, len(made.frequencies)))
    heights = np.zeros((5, 7))
    scale = 1e-10**0.4 * np.sqrt(np.log(1.7) / 5)
    for m in range(1, 6):
        n, frequency = 0, 2e3
        while frequency <= 3e5:
            phase = phases[m - 1, n]
            way = np.add.outer(y * np.sin(np.pi * m / 5), x * np.cos(np.pi * m / 5))
            wave = np.cos(phase) - np.cos(2.0 * np.pi * frequency * way + phase)
            heights += scale * frequency**-0.6 * wave
            n, frequency = n + 1, frequency * 1.7
    assert np.abs(patch - heights).max() < 1e-12 * np.abs(heights).max()


def brownian_covariance(dimension: float, step: float, one: Array, two: Array) -> Array:
    """Of heights of fractional Brownian motion that is 0 at its start (Mandelbrot, van Ness 1968)."""
    exponent = 4.0 - 2.0 * dimension
    return np.asarray(0.5 * step * (one**exponent + two**exponent - np.abs(one - two) ** exponent))


@pytest.mark.parametrize("dimension", [1.2, 1.75])
def test_brownian_lines_have_the_covariance_of_the_formula(dimension: float) -> None:
    count, step = 20_000, 4e-18
    lines = brownian_profiles(dimension, step, (count, 24), np.random.default_rng(11))
    np.testing.assert_array_equal(lines[:, 0], 0.0)
    places = np.array([1, 2, 7, 23])
    values = lines[:, places]
    one, two = np.meshgrid(places.astype(float), places.astype(float))
    exact = brownian_covariance(dimension, step, one, two)
    found = values.T @ values / count
    error = np.sqrt((np.outer(exact.diagonal(), exact.diagonal()) + exact**2) / count)  # of a Gaussian sample
    assert np.abs((found - exact) / error).max() < 3.5  # sixteen figures, ten of them different


def test_lines_made_together_know_nothing_of_one_another() -> None:
    lines = brownian_profiles(1.4, 1.0, (20_000, 3), np.random.default_rng(0))
    halves = np.corrcoef(lines[:10_000, 2], lines[10_000:, 2])[0, 1]  # real and imaginary parts of one transform
    assert abs(halves) < 3.0 / np.sqrt(10_000)
    assert brownian_profiles(1.4, 1.0, (3, 10), np.random.default_rng(0)).shape == (3, 10)


@pytest.mark.parametrize("dimension", [1.15, 1.6])
def test_brownian_patches_have_their_law_in_every_direction(dimension: float) -> None:
    exponent, count, step = 4.0 - 2.0 * dimension, 300, 2.0
    pairs = (((0, 0), (0, 1)), ((0, 0), (1, 0)), ((3, 2), (9, 25)), ((0, 29), (19, 0)), ((19, 0), (0, 0)))
    differences = np.empty((count, len(pairs)))
    for row in range(count):
        patch = generators.brownian_surface(dimension, step, (20, 30), np.random.default_rng([5, row]))
        differences[row] = [patch[one] - patch[two] for one, two in pairs]
    exact = np.array([step * np.hypot(one[0] - two[0], one[1] - two[1]) ** exponent for one, two in pairs])
    deviation = ((differences**2).mean(axis=0) - exact) / (exact * np.sqrt(2.0 / count))
    assert np.abs(deviation).max() < 3.0


@pytest.mark.parametrize("dimension", [1.2, 1.8])
def test_levelled_lines_have_the_structure_function_of_their_covariance(dimension: float) -> None:
    """P C P of the covariance of Brownian motion, with P what is left beside a straight line, entry by entry."""
    places = np.arange(90.0)
    covariance = brownian_covariance(dimension, 1.0, *np.meshgrid(places, places))
    base, _ = np.linalg.qr(np.stack([np.ones(90), places], axis=1))
    left = np.eye(90) - base @ base.T
    levelled = left @ covariance @ left
    spread = levelled.diagonal()
    exact = [np.mean(spread[k:] + spread[: 90 - k] - 2.0 * levelled.diagonal(k)) for k in range(90)]
    every = places ** (4.0 - 2.0 * dimension)
    np.testing.assert_allclose(generators.levelled_structure(every), exact, rtol=0.0, atol=1e-11 * every[-1])


# The calculation harmonic_fractal.made_flank: its truth, its file, and the way back through harmonic_fractal.

SMALL = {"length": "60 um", "width": "20 um"}


def made(**values: Any) -> Made:
    return MADE_FLANK.inputs(**{**SMALL, **values})


def test_an_instrument_adds_what_it_says() -> None:
    flat, rng = np.zeros((200, 300)), np.random.default_rng(2)
    noisy = as_measured(flat, made(noise="3 nm"), rng)
    assert noisy.std() == pytest.approx(3e-9, rel=0.01)
    seen = as_measured(flat, made(spikes="1 %", spike_height="100 nm", holes="3 %"), rng)
    assert np.isnan(seen).sum() == 1800
    assert (np.abs(seen) == 1e-7).sum() == 600
    told = as_measured(noisy, made(height_step="1 nm"), rng) / 1e-9
    np.testing.assert_allclose(told, np.round(told), atol=1e-6)
    assert np.abs(told * 1e-9 - noisy).max() <= 0.5e-9 * (1 + 1e-6)
    np.testing.assert_array_equal(flat, 0.0)


def mean_square(heights: Array, step: int) -> float:
    return float(np.nanmean((heights[:, step:] - heights[:, :-step]) ** 2))


def test_a_flank_is_as_large_as_stated_and_of_its_seed() -> None:
    one, again, other = (surface_of(made(seed=seed)) for seed in (3, 3, 4))
    assert one.heights.shape == (51, 151)
    assert (one.spacing_x, one.spacing_y) == pytest.approx((0.4e-6, 0.4e-6), rel=1e-15)
    np.testing.assert_array_equal(one.heights, again.heights)
    assert np.abs(one.heights - other.heights).max() > 1e-8
    line = surface_of(made(width=0.0))
    assert line.heights.shape == (1, 151)
    assert line.is_profile
    assert np.isnan(line.spacing_y)


@pytest.mark.parametrize("kind", ["areal", "brownian", "profile"])
def test_the_instrument_looks_at_one_and_the_same_flank(kind: str) -> None:
    clean = surface_of(made(kind=kind)).heights
    holed = surface_of(made(kind=kind, holes="5 %")).heights
    known = np.isfinite(holed)
    assert np.isnan(holed).sum() == round(0.05 * clean.size)
    np.testing.assert_array_equal(holed[known], clean[known])
    noisy = surface_of(made(kind=kind, noise="7 nm")).heights - clean
    assert noisy.std() == pytest.approx(7e-9, rel=0.03)
    assert abs(np.corrcoef(noisy[:, 1:].ravel(), noisy[:, :-1].ravel())[0, 1]) < 0.05


def test_a_filter_weakens_each_wave_as_the_instrument_samples_it() -> None:
    """Gaussian of ISO 16610-21: 2^-(cutoff f)^2 passes, f folded into the band that the points can show."""
    values = made(kind="profile", width="80 um", filter_cutoff="2.4 um")
    waves, heights = making.waves_of(values), surface_of(values).heights
    assert heights.shape == (201, 151)
    seen = np.abs(waves.frequencies - np.round(waves.frequencies * 0.4e-6) / 0.4e-6)
    passed = (waves.amplitudes * 2.0 ** -((2.4e-6 * seen) ** 2)) ** 2
    for step in (1, 3, 10):
        exact = passed @ (1.0 - np.cos(2.0 * np.pi * seen * step * 0.4e-6))
        lines = ((heights[:, step:] - heights[:, :-step]) ** 2).mean(axis=1)
        assert abs(lines.mean() - exact) < 3.0 * lines.std(ddof=1) / np.sqrt(201)
    plain = surface_of(made(kind="profile", width="80 um")).heights
    assert mean_square(heights.T, 1) == pytest.approx(mean_square(plain.T, 1), rel=0.1)  # neighbours are not mixed
    patch = surface_of(made(filter_cutoff="2.4 um")).heights
    assert mean_square(patch.T, 1) < 0.5 * mean_square(surface_of(made()).heights.T, 1)


@pytest.mark.parametrize("kind", ["areal", "brownian", "profile"])
@pytest.mark.parametrize("convention", ["areal", "one_direction", "profile"])
def test_one_truth_in_any_convention_is_one_power_law(kind: str, convention: str) -> None:
    """(2 pi)^a Lambda at D_s = 1.5 is 2 pi pi/2; q = 2/pi for many directions, 1/ln density for a profile."""
    constant = {"areal": 2.0 * np.pi, "one_direction": np.pi**2, "profile": np.pi**2 / np.log(1.5)}[convention]
    answer = made_flank(made(kind=kind, convention=convention, fractal_dimension=2.5, fractal_roughness=2e-11))
    np.testing.assert_allclose(answer.power_law, constant * 2e-11 * answer.lag, rtol=1e-12)
    np.testing.assert_allclose(answer.exact, answer.power_law, rtol=0.05)  # ripple, and the ends of the band
    assert answer.areal_roughness == pytest.approx(2e-11 * constant / (2.0 * np.pi), rel=1e-12)
    true_by_error = answer.fitted_roughness / 10**answer.roughness_error  # decades
    assert true_by_error == pytest.approx(answer.areal_roughness, rel=1e-12)


@pytest.mark.parametrize("directions", [1, 2, 5, 40])
def test_however_many_directions_s_along_the_lines_is_that_of_the_truth(directions: int) -> None:
    answer = made_flank(made(directions=directions, fractal_roughness=3e-11))
    np.testing.assert_allclose(answer.exact, answer.power_law, rtol=0.04)  # ripple, and the ends of the band
    assert np.mean(answer.exact / answer.power_law) == pytest.approx(1.0, abs=0.01)


def test_ridges_of_one_direction_run_across_the_lines() -> None:
    heights = surface_of(made(directions=1)).heights
    np.testing.assert_allclose(heights, np.broadcast_to(heights[0], heights.shape), atol=1e-15)


def test_the_band_is_that_of_the_rule_or_as_stated() -> None:
    ruled = making.truth_of(made())
    assert (1.0 / ruled.lowest, 1.0 / ruled.highest) == pytest.approx((6e-3, 8e-9), rel=1e-12)
    stated = making.waves_of(made(longest_wave="60 um", shortest_wave="0.8 um")).frequencies
    assert stated[0] == pytest.approx(1.0 / 60e-6, rel=1e-12)
    assert stated[-1] <= 1.0 / 0.8e-6 < 1.5 * stated[-1]
    short = made_flank(made(longest_wave="60 um", shortest_wave="0.8 um"))
    law = np.log(short.exact / short.power_law)
    assert law[0] < -0.3  # a band that ends at two spacings bends S at short lags
    assert law[-1] < -0.3  # one that ends at the length flattens it at long ones


def test_heights_are_told_without_the_mean_plane() -> None:
    answer, heights = made_flank(made(kind="brownian", width=0.0)), surface_of(made(kind="brownian", width=0.0)).heights
    x = np.arange(151.0)
    level = heights[0] - np.polyval(np.polyfit(x, heights[0], 1), x)
    assert answer.rms_height == pytest.approx(level.std(), rel=1e-9)
    assert answer.height == pytest.approx(np.ptp(level), rel=1e-9)
    assert answer.structure_function[0] == pytest.approx(mean_square(heights, 1), rel=1e-12)
    assert answer.lag[-1] == pytest.approx(75 * 0.4e-6)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"length": "20 um"}, "fewer than 64 points"),
        ({"length": "90 mm", "width": "90 mm"}, "more than 4000000 points"),
        ({"longest_wave": "1 um", "shortest_wave": "2 um"}, "shortest wave is not shorter"),
        ({"density": 1.001}, "waves of the flank do not fit into memory"),
        ({"kind": "brownian", "fractal_dimension": 2.2, "length": "1 mm"}, "field of the Brownian patch"),
        ({"fractal_dimension": 2.02}, "exponents diverge"),
        ({"shortest_lag": "4 um"}, "a twentieth of a line"),
    ],
)
def test_what_cannot_be_made_is_refused_by_name(values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InfeasibleError, match=sentence):
        made_flank(made(**values))


@pytest.mark.parametrize("name", ["filter_cutoff", "spikes", "width", "noise", "length", "shortest_wave"])
def test_steps_of_a_derivative_beyond_a_bound_fail_alone(name: str) -> None:
    """Differences about 0 go below it; such a row has a reason and raises nothing."""
    with watching(1) as failed:
        answer = made_flank(replace(made(), **{name: -1e-7}))
    assert np.isnan(answer.dimension_error)
    assert name.partition("_")[2 if name == "shortest_wave" else 0] in failed.reasons(1)[0]


@pytest.mark.parametrize("unit", ["m", "mm", "um", "nm"])
def test_a_written_flank_is_read_as_it_was(unit: str, tmp_path: Path) -> None:
    surface = surface_of(made(kind="brownian", holes="2 %", spacing="0.37 um"))
    file = tmp_path / "flank.csv"
    file.write_text(making.flank_text(surface, "words, and a comma", unit), encoding="utf-8")
    raw = read_flank(file, form="none").raw
    assert (raw.spacing_x, raw.spacing_y) == (surface.spacing_x, surface.spacing_y)
    np.testing.assert_allclose(raw.heights, surface.heights, rtol=1e-15, atol=0.0, equal_nan=True)


def test_a_filter_is_told_in_the_head_of_the_file() -> None:
    values = made(filter_cutoff="1.2 um")
    outcome = FlankFile().run(SimpleNamespace(inputs=values))  # type: ignore[arg-type]
    head = outcome.text.splitlines()[:5]
    assert "# filter_width = 1.2 um" in head
    assert "# spacing_x = 0.4 um" in head
    assert "fractal dimension of the surface 2.4" in head[0]
    assert outcome.as_json() == {"file": "flank.csv", "lines": 51, "points": 151, "missing": 0}


@pytest.mark.parametrize("values", [{}, {"kind": "profile", "width": 0.0, "noise": "50 nm"}, {"kind": "brownian"}])
def test_the_sheet_draws_and_says_what_was_made(values: dict[str, Any]) -> None:
    inputs = made(**values)
    record = Record(
        inputs=inputs, results=made_flank(inputs), answers={}, studies={}, function=made_flank, acting=inputs
    )
    blocks = [block for section in SECTIONS if section.blocks for block in section.blocks(record)]
    drawings = [block for block in blocks if isinstance(block, Drawing)]
    assert len(drawings) == (2 if values.get("width") == 0.0 else 3)
    assert all(isinstance(drawing.draw(), Figure) for drawing in drawings)
    (table,) = (block for block in blocks if isinstance(block, Table))
    assert table.rows[0][1] == pytest.approx(2.4)
    assert len(table.rows) == (3 if values.get("kind") == "profile" else 4)
    assert 2.4 < float(table.rows[1][1]) < 2.45  # type: ignore[arg-type]  # levelling raises the dimension
    refused = [block for block in blocks if isinstance(block, Words) and "refuses this flank" in block.text]
    assert bool(refused) == (record.results.accepted == 0.0)


def test_a_made_flank_is_written_by_one_run_and_found_again_by_the_next(tmp_path: Path) -> None:
    """Seed 0 and the length of the lines are those of the shipped example; the kind is another, the lines are fewer."""
    offers = Kernel.installed().offers
    made_run = calculate(default_setup(offers["harmonic_fractal.made_flank"].model, kind="brownian", width="30 um"))
    assert made_run.answers["accepted"] == 1
    assert abs(made_run.answers["dimension_error"]) < 0.08
    (tmp_path / "flank.csv").write_text(made_run.outcomes["flank_file"].text, encoding="utf-8")
    text = 'plugin = "harmonic_fractal"\n[inputs]\nsurface = { file = "flank.csv", form = "none" }\n'
    setup = setup_from_text(text, offers["harmonic_fractal"], file="drive.toml", folder=tmp_path)
    found = calculate(replace(setup, studies=())).answers
    assert found["dimension"] == pytest.approx(2.4, abs=0.08)
    assert np.log10(found["roughness"] / 1e-11) == pytest.approx(0.0, abs=0.9)
    low, high = np.percentile(setup.inputs.surface.resampled, (2.5, 97.5), axis=0)
    assert low[0] < 2.4 < high[0]
    assert low[1] < np.log(1e-11) < high[1]
