"""Four public measurements: heights, structure function and verdict, against an independent evaluation of them.

The figures were computed by another program, in double precision, by this recipe: second-order form removed, each
line of a patch less its own straight line, up to 16 whole lags from ``points`` spacings to a tenth of a line, pooled
over all lines, straight-line fit of the logarithms; nothing else is taken out. So spikes are kept here and the fit
runs over all lags. The scatter of single lines of the interferogram is left out: its figures, 0.080 and 0.066, are
those of every eighth line along x and of every tenth along y.
"""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank import Flank, read_flank

SURFACES = Path(__file__).parents[1] / "data" / "surfaces"
NEEDED: dict[str, dict[str, Any]] = {
    "matrix-4.txt": {"spacing": "0.369862 um", "height_unit": "2.91818e-8 m"},
}
PRINTED = {"spikes": "keep", "fit": "all", "filter_width": "0 um", "bias": "kept"}


@cache
def flank(file: str, shortest: str = "", **options: str) -> Flank:
    if file.endswith((".al3d", ".dat")):
        pytest.importorskip("SurfaceTopography")
    return read_flank(SURFACES / file, **NEEDED.get(file, {}), **options, shortest_lag=shortest)


def along(direction: str, found: Flank) -> Estimate:
    return next(estimate for estimate in found.estimates if estimate.direction == direction)


@pytest.mark.parametrize(
    ("file", "raw", "plane", "second_order"),
    [
        ("al3d-1.al3d", 7.688, 0.2898, 0.2592), ("matrix-4.txt", 0.1175, 0.07373, 0.07092),
        ("metropro-1.dat", 0.07529, 0.01333, 0.003911), ("hfm-1.hfm", 0.9057, 0.2453, 0.1381),
    ],
)  # fmt: skip
def test_root_mean_square_heights(file: str, raw: float, plane: float, second_order: float) -> None:
    found = flank(file, **PRINTED)
    heights = np.array([found.sq_raw, found.sq_plane, found.sq_second_order]) * 1e6
    assert heights == pytest.approx([raw, plane, second_order], rel=5.1e-4)  # the digits that are printed
    assert found.missing == 0.0


@pytest.mark.parametrize(
    ("file", "direction", "points", "dimension", "roughness", "r_squared", "scatter"),
    [
        ("al3d-1.al3d", "x", 1, 1.181, 5.0e-17, 0.986, 0.035),
        ("al3d-1.al3d", "y", 1, 1.222, 6.5e-15, 0.975, 0.028),
        ("al3d-1.al3d", "x", 4, 1.320, 8.5e-12, 0.980, 0.064),
        ("al3d-1.al3d", "y", 4, 1.371, 6.1e-11, 0.963, 0.048),
        ("matrix-4.txt", "x", 1, 1.195, 1.0e-16, 0.999, 0.039),
        ("matrix-4.txt", "y", 1, 1.702, 1.4e-9, 0.889, 0.038),
        ("matrix-4.txt", "y", 3, 1.803, 3.7e-9, 0.995, 0.052),
        ("metropro-1.dat", "x", 1, 1.874, 3.8e-10, 0.931, None),
        ("metropro-1.dat", "y", 1, 1.919, 5.3e-10, 0.733, None),
        ("hfm-1.hfm", "x", 1, 1.576, 7.6e-11, 0.930, np.nan),
        ("hfm-1.hfm", "x", 8, 1.483, 4.2e-12, 0.933, np.nan),
    ],
)
def test_fit_over_all_lags(
    file: str, direction: str, points: int, dimension: float, roughness: float, r_squared: float, scatter: float | None
) -> None:
    spacing = along(direction, flank(file, **PRINTED)).spacing
    found = along(direction, flank(file, f"{points * spacing!r} m", **PRINTED))
    assert found.lags[0] == pytest.approx(points * spacing, rel=1e-9)
    assert found.dimension == pytest.approx(dimension, abs=0.001)  # half of the last digit, and as much again
    assert found.roughness == pytest.approx(roughness, rel=0.05)  # two digits
    assert found.r_squared == pytest.approx(r_squared, abs=0.001)
    if scatter is not None:
        assert found.line_scatter == pytest.approx(scatter, abs=0.001, nan_ok=True)


@pytest.mark.parametrize(
    ("file", "direction", "printed"),
    [
        ("al3d-1.al3d", "x", "0.62:1.04 1.07:1.05 1.52:1.07 2.32:1.13 4.01:1.29 6.61:1.57 10.63:1.90 17.25:1.95"),
        ("al3d-1.al3d", "y", "0.62:1.03 1.07:1.04 1.70:1.07 2.94:1.16 5.09:1.36 8.48:1.65 14.36:1.98 24.71:1.89"),
        ("matrix-4.txt", "x", "0.52:1.15 0.91:1.17 1.28:1.21 1.81:1.25 2.72:1.37 4.00:1.72 5.81:2.64"),
        ("matrix-4.txt", "y", "0.52:1.29 0.91:1.46 1.43:1.75 2.48:1.79 4.30:1.81 7.30:1.83 12.51:1.87 21.39:1.74"),
        ("metropro-1.dat", "x",
         "1.55:1.80 3.11:1.94 5.81:1.94 10.48:1.92 19.40:1.85 36.09:1.77 67.92:1.84 128.08:1.66"),
        ("metropro-1.dat", "y", "1.55:2.21 2.69:1.56 4.66:2.06 8.92:1.93 16.29:1.89 29.47:1.82 53.53:1.81 97.74:2.06"),
        ("hfm-1.hfm", "x", "0.87:1.47 2.29:1.62 5.77:1.94 15.26:1.78 39.91:1.40 105.58:1.16 278.88:1.46 737.70:1.93"),
    ],
)  # fmt: skip
def test_local_slopes(file: str, direction: str, printed: str) -> None:
    pairs = np.array([[float(number) for number in pair.split(":")] for pair in printed.split()])
    found = along(direction, flank(file, **PRINTED))
    assert found.local_lags * 1e6 == pytest.approx(pairs[:, 0], abs=0.0051)
    assert found.local_dimensions == pytest.approx(pairs[:, 1], abs=0.0101)


@pytest.mark.parametrize("spikes", ["keep", "remove"])
@pytest.mark.parametrize("file", ["al3d-1.al3d", "hfm-1.hfm"])
def test_no_self_affine_range_whatever_the_correlation(file: str, spikes: str) -> None:
    found = flank(file, spikes=spikes)
    assert found.chosen is None
    assert found.used is None
    assert "no self-affine range" in found.reason
    assert len(found.resampled) == 0
    for estimate in found.estimates:
        assert estimate.r_squared > 0.92
        assert np.isfinite([estimate.dimension, estimate.roughness]).all()  # for comparison
        assert len(estimate.local_dimensions) == 8


@pytest.mark.parametrize("spikes", ["keep", "remove"])
def test_one_direction_alone_is_self_affine(spikes: str) -> None:
    found = flank("matrix-4.txt", spikes=spikes)
    assert found.chosen == "y"
    assert "no self-affine range" in along("x", found).reason
    assert any("direction y alone is used" in words and "along x" in words for words in found.warnings)
    low, high = along("y", found).range
    assert low < 1.4e-6  # of the decade that the local slopes show, 1.75 to 1.87
    assert high > 12e-6
    assert 1.75 < along("y", found).dimension < 1.87
    asked = flank("matrix-4.txt", spikes=spikes, direction="x")
    assert asked.chosen is None
    assert "no self-affine range" in asked.reason


def test_a_few_spikes_make_a_smooth_interferogram_rough() -> None:
    """One point stands out by 725 nm where the surface has 3.9 nm; without such points D falls by a quarter."""
    kept, removed = flank("metropro-1.dat", spikes="keep"), flank("metropro-1.dat", spikes="remove")
    assert np.abs(kept.surface.heights).max() > 150 * kept.sq_second_order
    assert 0.005 < removed.spiked < 0.01
    assert along("x", kept).dimension - along("x", removed).dimension > 0.2
    assert removed.resampled[:, 0].std() < 0.2 * kept.resampled[:, 0].std()


@pytest.mark.parametrize(("file", "direction"), [("al3d-1.al3d", "x"), ("matrix-4.txt", "x"), ("matrix-4.txt", "y")])
def test_spike_filter_leaves_surfaces_without_spikes_alone(file: str, direction: str) -> None:
    kept, removed = (along(direction, flank(file, spikes=word, fit="all")) for word in ("keep", "remove"))
    assert removed.dimension == pytest.approx(kept.dimension, abs=0.005)


def test_lateral_filter_of_the_file_leaves_short_lags_out() -> None:
    found = flank("al3d-1.al3d")
    assert along("x", found).lags[0] == pytest.approx(5 * 0.438027e-6)  # the first lag above 3 times 0.606 um
    assert any("lateral filter of 0.606 um" in words for words in found.warnings)
    assert not any("lateral filter" in words for words in flank("al3d-1.al3d", filter_width="0 um").warnings)
