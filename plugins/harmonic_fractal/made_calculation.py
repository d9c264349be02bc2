"""A flank is made, looked at, and its dimension and roughness are found again."""

import numpy as np

from harmonic_fractal.cleaning import without_form, without_line
from harmonic_fractal.estimate import Estimate, Estimation, estimate_of
from harmonic_fractal.generators import (
    Array,
    brownian_profiles,
    profile_sum,
    surface_sum,
    weierstrass_profile,
    weierstrass_surface,
)
from harmonic_fractal.generators_brownian import brownian_surface
from harmonic_fractal.levelling import levelled_structure
from harmonic_fractal.made_answers import MadeFlank
from harmonic_fractal.made_instrument import as_measured
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.made_truth import instrument_of, is_patch, is_possible, truth_of, waves_of
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.structure import structure_sums
from harmonic_fractal.surface import Direction, Lines, Surface
from truing import feasible

ROWS = 20  # lags of the table


def made_flank(made: Made) -> MadeFlank:
    """Make one flank and find its truth again; numbers only, SI: the kernel calls it once per row of a batch."""
    truth = truth_of(made)
    if not is_possible(made, truth):
        return _nothing()
    surface = surface_of(made)
    level = without_form(surface.heights, "plane")
    lags, values = structure_of(surface)
    found = estimate_along(made, surface, "x", resamples=0)
    feasible(
        1.0 < found.dimension < 2.0 and 0.0 < found.roughness < np.inf,
        "the estimator finds no slope between 0 and 2 along this flank: less noise, or another shortest_lag",
    )
    return MadeFlank(
        profile_dimension=truth.dimension,
        areal_roughness=truth.areal,
        points=float(surface.heights.shape[1]),
        lines=float(surface.heights.shape[0]),
        longest=1.0 / truth.lowest,
        shortest=1.0 / truth.highest,
        rms_height=float(np.sqrt(np.nanmean(level**2))),
        height=float(np.nanmax(level) - np.nanmin(level)),
        lag=lags,
        structure_function=values,
        exact=exact_structure_function(made, lags),
        power_law=np.asarray(structure_function(lags, truth.dimension, truth.areal)),
        fitted_dimension=found.dimension + 1.0,
        fitted_roughness=found.roughness,
        dimension_error=found.dimension - truth.dimension,
        roughness_error=float(np.log10(found.roughness / truth.areal)),
        accepted=float(found.is_accepted),
    )


def surface_of(made: Made) -> Surface:
    """Return the flank as the instrument shows it: everything random comes from its seed."""
    truth, instrument, spacing = truth_of(made), instrument_of(made), float(made.spacing)
    of_flank, of_instrument = np.random.default_rng(made.seed).spawn(2)
    made_heights = _heights(made, instrument.margin(spacing), of_flank)
    heights = as_measured(made_heights, spacing, instrument, of_instrument, across=is_patch(made, truth))
    across = spacing if truth.shape[0] > 1 else float("nan")
    return Surface(heights=heights, spacing_x=spacing, spacing_y=across, name=f"made flank, seed {made.seed}")


def _heights(made: Made, margin: int, rng: np.random.Generator) -> Array:
    """Make the flank with a margin for the filter on each side; across its lines only where these are neighbours."""
    truth, spacing = truth_of(made), float(made.spacing)
    lines, points = truth.shape
    beside = margin if is_patch(made, truth) else 0
    lines, points = lines + 2 * beside, points + 2 * margin
    if made.kind == "brownian":
        step = float(np.asarray(structure_function(spacing, truth.dimension, truth.areal)))
        make = brownian_surface if lines > 1 else brownian_profiles
        return make(truth.dimension, step, (lines, points), rng)
    x, y = (
        spacing * np.arange(-before, count - before, dtype=np.float64)
        for before, count in ((margin, points), (beside, lines))
    )
    if made.kind == "profile":
        return weierstrass_profile(waves_of(made), x, lines, rng)
    return weierstrass_surface(waves_of(made), x, y, rng)


def exact_structure_function(made: Made, lags: Array) -> Array:
    """Return S (k,), m^2, along the lines of all flanks of this truth, before the instrument."""
    truth = truth_of(made)
    if made.kind == "brownian":
        return np.asarray(structure_function(lags, truth.dimension, truth.areal))
    return (profile_sum if made.kind == "profile" else surface_sum)(waves_of(made), lags)


def levelled_structure_function(made: Made, lags: Array) -> Array:
    """Return S (k,), m^2, to be expected at whole spacings of lines that have lost their own straight line."""
    points, spacing = truth_of(made).shape[1], float(made.spacing)
    beyond = exact_structure_function(made, spacing * np.arange(1, points, dtype=np.float64))
    every = levelled_structure(np.concatenate([[0.0], beyond]))
    return np.asarray(every[np.round(lags / spacing).astype(int)])


def structure_of(surface: Surface) -> tuple[Array, Array]:
    """Return lags (k,), m, evenly in their logarithm up to half a line, and S (k,) of all lines together, m^2."""
    points = surface.heights.shape[1]
    steps = np.unique(np.round(np.geomspace(1.0, points // 2, ROWS)).astype(int))
    sums, counts = structure_sums(surface.heights, steps)
    return steps * surface.spacing_x, np.asarray(sums.sum(axis=0) / counts.sum(axis=0))


def estimate_along(made: Made, surface: Surface, direction: Direction, resamples: int = 400) -> Estimate:
    """Find dimension and roughness again, each line without its own straight line.

    Lines nearer to one another than the longest lag, a tenth of a line, are resampled together: they are alike.
    """
    lines = surface.lines(direction)
    level = Lines(without_line(lines.heights), lines.spacing)
    alike = 1 if made.kind == "profile" else max(1, lines.heights.shape[1] // 10)
    settings = Estimation(
        noise_aware=made.noise_aware, shortest_lag=float(made.shortest_lag), block=alike, resamples=resamples
    )
    return estimate_of(level, direction, settings)


def _nothing() -> MadeFlank:
    """Return a flank that cannot be."""
    names = MadeFlank.__dataclass_fields__
    along = {"lag", "structure_function", "exact", "power_law"}
    return MadeFlank(**{name: np.full(1, np.nan) if name in along else float("nan") for name in names})
