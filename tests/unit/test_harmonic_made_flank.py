"""The calculation harmonic_fractal.made_flank: its truth, its file, and the way back through harmonic_fractal."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from harmonic_fractal.flank import read_flank
from harmonic_fractal.generators import Array
from harmonic_fractal.made_flank import FlankFile, Made, flank_text, made_flank, surface_of, truth_of, waves_of
from harmonic_fractal.made_sheet import MADE_FLANK, SECTIONS
from shared import Calc
from truing import Drawing, Record, Table, TruingError, Words
from truing.errors import InfeasibleError

SMALL = {"length": "60 um", "width": "20 um"}


def made(**values: Any) -> Made:
    return MADE_FLANK.inputs(**{**SMALL, **values})


def squares(heights: Array, step: int) -> float:
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
    waves, heights = waves_of(values), surface_of(values).heights
    assert heights.shape == (201, 151)
    seen = np.abs(waves.frequencies - np.round(waves.frequencies * 0.4e-6) / 0.4e-6)
    passed = (waves.amplitudes * 2.0 ** -((2.4e-6 * seen) ** 2)) ** 2
    for step in (1, 3, 10):
        exact = passed @ (1.0 - np.cos(2.0 * np.pi * seen * step * 0.4e-6))
        lines = ((heights[:, step:] - heights[:, :-step]) ** 2).mean(axis=1)
        assert abs(lines.mean() - exact) < 3.0 * lines.std(ddof=1) / np.sqrt(201)
    plain = surface_of(made(kind="profile", width="80 um")).heights
    assert squares(heights.T, 1) == pytest.approx(squares(plain.T, 1), rel=0.1)  # neighbours are not mixed
    patch = surface_of(made(filter_cutoff="2.4 um")).heights
    assert squares(patch.T, 1) < 0.5 * squares(surface_of(made()).heights.T, 1)


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


@pytest.mark.parametrize("directions", [1, 2, 3, 5, 40])
def test_however_many_directions_s_along_the_lines_is_that_of_the_truth(directions: int) -> None:
    answer = made_flank(made(directions=directions, fractal_roughness=3e-11))
    np.testing.assert_allclose(answer.exact, answer.power_law, rtol=0.04)  # ripple, and the ends of the band
    assert np.mean(answer.exact / answer.power_law) == pytest.approx(1.0, abs=0.01)


def test_ridges_of_one_direction_run_across_the_lines() -> None:
    heights = surface_of(made(directions=1)).heights
    np.testing.assert_allclose(heights, np.broadcast_to(heights[0], heights.shape), atol=1e-15)


def test_the_band_is_that_of_the_rule_or_as_stated() -> None:
    ruled = truth_of(made())
    assert (1.0 / ruled.lowest, 1.0 / ruled.highest) == pytest.approx((6e-3, 8e-9), rel=1e-12)
    stated = waves_of(made(longest_wave="60 um", shortest_wave="0.8 um")).frequencies
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
    assert answer.structure_function[0] == pytest.approx(squares(heights, 1), rel=1e-12)
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


@pytest.mark.parametrize(("options", "word"), [({"height_unit": "inch"}, "height_unit"), ({"file": "a.txt"}, ".csv")])
def test_a_file_that_nobody_reads_is_refused(options: dict[str, str], word: str) -> None:
    with pytest.raises(TruingError, match=word):
        FlankFile(**options)  # type: ignore[arg-type]


@pytest.mark.parametrize("unit", ["m", "mm", "um", "nm"])
def test_a_written_flank_is_read_as_it_was(unit: str, tmp_path: Path) -> None:
    surface = surface_of(made(kind="brownian", holes="2 %", spacing="0.37 um"))
    file = tmp_path / "flank.csv"
    file.write_text(flank_text(surface, "words, and a comma", unit), encoding="utf-8")
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


def test_a_made_flank_is_written_by_one_run_and_found_again_by_the_next(calc: Calc, tmp_path: Path) -> None:
    """Seed 0 and the length of the lines are those of the shipped example; the kind is another, the lines are fewer."""
    assert calc("init", "harmonic_fractal.made_flank", "-o", "made.toml").code == 0
    told = calc("run", "harmonic_fractal.made_flank", "--inputs", "made.toml", "--set", "kind=brownian",
                "--set", "width=50 um", "--output", "runs/made", "--json")  # fmt: skip
    assert told.code == 0, told.err
    results = json.loads(told.out)["results"]
    assert results["accepted"]["value"] == 1
    assert abs(results["dimension_error"]["value"]) < 0.08
    (tmp_path / "drive.toml").write_text(
        'plugin = "harmonic_fractal"\n[inputs]\nsurface = { file = "runs/made/flank.csv", form = "none" }\n',
        encoding="utf-8",
    )
    read = calc("run", "harmonic_fractal", "--inputs", "drive.toml", "--set", "studies.run=[]",
                "--output", "runs/read", "--json")  # fmt: skip
    assert read.code in {0, 1}, read.err
    found = json.loads(read.out)["results"]
    assert found["dimension"]["value"] == pytest.approx(2.4, abs=0.08)
    assert np.log10(found["roughness"]["value"] / 1e-11) == pytest.approx(0.0, abs=0.9)
    flank = read_flank(tmp_path / "runs" / "made" / "flank.csv", form="none")
    low, high = np.percentile(flank.resampled, (2.5, 97.5), axis=0)
    assert low[0] < 2.4 < high[0]
    assert low[1] < np.log(1e-11) < high[1]
