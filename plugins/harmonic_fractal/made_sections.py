"""The sheet of a made flank."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from harmonic_fractal import made_drawn
from harmonic_fractal.cleaning import quantisation, spikes_of
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.fitting import straight_fit
from harmonic_fractal.made_answers import MadeFlank
from harmonic_fractal.made_calculation import estimate_along, levelled_structure_function, surface_of
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.made_truth import is_patch, truth_of
from harmonic_fractal.power_law import log_roughness_of
from harmonic_fractal.surface import Surface
from truing import Block, Drawing, Record, Section, Table, Words

Run = Record[Made, MadeFlank]

FOUND_AGAIN = (
    "The estimator sees the flank as it would see a measured one: each line without its own straight line, and one "
    "power law through S from the spacing to a tenth of a line, as far as the local slopes agree. What it misses of "
    "the truth here it misses on a measured flank too: levelling and noise raise the dimension, a lateral filter "
    "lowers it."
)
TRUTH = {
    "areal": "A sum of plane waves in many directions, each with a random phase. Their amplitudes are fixed, so flanks "
    "of one truth scatter less than ground ones do; S has a faint ripple, because the frequencies are a row of powers "
    "of the density.",
    "brownian": "Fractional Brownian motion: Gaussian, alike in all directions, S a power law without end or ripple.",
    "profile": "Each line is a sum of waves with phases of its own. Neighbouring lines know nothing of one another, so "
    "only the direction along the lines means anything.",
}


def truth(record: "Run") -> "Sequence[Block]":
    """What kind of surface this is."""
    return [Words(TRUTH[record.inputs.kind])]


def look(record: "Run") -> "Sequence[Block]":
    """The patch and some of its lines."""
    surface = surface_of(record.inputs)
    lines = Drawing("Lines of the flank", partial(made_drawn.lines_figure, surface))
    if surface.is_profile:
        return [lines]
    holes = " Orange: not measured." if np.isnan(surface.heights).any() else ""
    caption = f"Less its mean plane.{holes}"
    return [Drawing("The flank from above", partial(made_drawn.map_figure, surface), caption), lines]


def structure(record: "Run") -> "Sequence[Block]":
    """The structure function beside the truth."""
    made, surface = record.inputs, surface_of(record.inputs)
    found = estimate_along(made, surface, "x")
    caption = (
        "Middle: the same S over the power law of the truth. At long lags one flank strays from the mean of all, and "
        "levelled lines fall below it as the dotted line says. Below: the dimension between neighbouring lags; dashed: "
        "the true one."
    )
    draw = partial(made_drawn.structure_figure, made, truth_of(made), record.results, found)
    return [Drawing("Structure function and local slopes", draw, caption)]


def found_again(record: "Run") -> "Sequence[Block]":
    """Both directions beside the truth, and the verdict."""
    made, surface, true = record.inputs, surface_of(record.inputs), truth_of(record.inputs)
    along = estimate_along(made, surface, "x")
    found = [("along the lines, x", along)]
    if made.spikes > 0.0:
        found.append(("the same, spikes taken out", estimate_along(made, _cleaned(surface), "x")))
    if is_patch(made, true) and made.directions > 1:
        found.append(("across the lines, y", estimate_along(made, surface, "y")))
    rows = [_row(name, each) for name, each in found]
    table = Table(
        "Truth and what was found",
        ("", "D", "half width", "G", "half width", "R²", "self-affine range", "verdict"),
        [("truth", true.dimension + 1.0, None, true.areal, None, None, "", ""), _expected(made, along), *rows],
        ("", "", "", "m", "decades", "", "µm", ""),
        note="Half width: of the 95 % interval by resampling lines, neighbours together. It cannot see what all lines "
        "of one flank share: flanks of other seeds stray by up to twice as much about what levelling lets expect.",
    )
    return [Words(FOUND_AGAIN), table, *_said(along)]


def _expected(made: Made, found: Estimate) -> tuple[str | float | None, ...]:
    """What levelling alone makes of the truth, over the lags of the fit."""
    law = straight_fit(found.lags, levelled_structure_function(made, found.lags))
    dimension = 2.0 - float(law.slope) / 2.0
    roughness = float(np.exp(log_roughness_of(law.intercept, dimension)))
    return ("expected along levelled lines", dimension + 1.0, None, roughness, None, float(law.r_squared), "", "")


def _cleaned(surface: Surface) -> Surface:
    """Take out spikes as it is done with a measured flank."""
    spikes = spikes_of(surface.heights, quantisation(surface.heights))
    return replace(surface, heights=np.where(spikes, np.nan, surface.heights))


def _row(name: str, found: Estimate) -> tuple[str | float | None, ...]:
    low, high = found.range
    reach = f"{1e6 * low:.3g} to {1e6 * high:.3g}" if found.is_accepted else "none"
    widths = _half_widths(found)
    verdict = "accepted" if found.is_accepted else "refused"
    return (name, found.dimension + 1.0, widths[0], found.roughness, widths[1], found.r_squared, reach, verdict)


def _half_widths(found: Estimate) -> tuple[float | None, float | None]:
    """Half of the central 95 % of D, and of log10 G; None without resamples."""
    if len(found.resampled) < 2:
        return None, None
    low, high = np.percentile(found.resampled, (2.5, 97.5), axis=0)
    half = 0.5 * (high - low)
    return float(half[0]), float(half[1] / np.log(10.0))


def _said(found: Estimate) -> list[Words]:
    """Say why the estimator refuses the flank, or what it doubts."""
    if found.reason:
        text = f"The estimator refuses this flank: {found.reason}. What was fitted stands for comparison only."
        return [Words(text, "finding")]
    return [Words(f"The estimator says: {text}.", "warning") for text in found.warnings]


SECTIONS = [
    Section(
        "Truth",
        "profile_dimension", "areal_roughness", "points", "lines", "longest", "shortest",
        blocks=truth,
    ),
    Section("The flank", "rms_height", "height", blocks=look),
    Section("Structure function", "lag", "structure_function", "exact", "power_law", blocks=structure),
    Section(
        "Found again",
        "fitted_dimension", "dimension_error", "fitted_roughness", "roughness_error", "accepted",
        blocks=found_again,
    ),
]  # fmt: skip
