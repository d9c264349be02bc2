"""What a made flank is made of: truth, waves, instrument, and what must hold so that it can be made."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harmonic_fractal.generators import Waves
from harmonic_fractal.generators_brownian import field_side
from harmonic_fractal.made_instrument import Instrument
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.power_law import converted
from truing import feasible

LARGEST = 4_000_000  # points of a flank
LARGEST_FIELD = 30_000_000  # points of the field from which a Brownian patch is cut
MOST_WAVES = 10_000_000  # times lines and points together: what two thin matrices hold


@dataclass(frozen=True, kw_only=True)
class Truth:
    """What the flank is made of: dimension of its profiles, G in the areal convention, m, and band, 1/m."""

    dimension: float
    areal: float
    lowest: float
    highest: float
    shape: tuple[int, int]


def truth_of(made: Made) -> Truth:
    """Return the truth of a flank; ``shape`` is (lines, points)."""
    dimension, spacing = float(made.fractal_dimension) - 1.0, float(made.spacing)
    areal = converted(made.fractal_roughness, dimension, made.density, source=made.convention, target="areal")
    points, lines = (int(np.floor(float(side) / spacing + 1e-6)) + 1 for side in (made.length, made.width))
    longest, shortest = float(made.longest_wave), float(made.shortest_wave)
    side = max(float(made.length), float(made.width))
    return Truth(
        dimension=dimension,
        areal=float(areal),
        lowest=1.0 / (100.0 * side if np.isnan(longest) else longest),
        highest=1.0 / (spacing / 50.0 if np.isnan(shortest) else shortest),
        shape=(lines, points),
    )


def is_patch(made: Made, truth: Truth) -> bool:
    """Whether neighbouring lines know of one another."""
    return truth.shape[0] > 1 and made.kind != "profile"


def instrument_of(made: Made) -> Instrument:
    """Return the instrument that looks at the flank."""
    return Instrument(
        cutoff=float(made.filter_cutoff),
        noise=float(made.noise),
        step=float(made.height_step),
        spikes=float(made.spikes),
        spike_height=float(made.spike_height),
        holes=float(made.holes),
    )


def waves_of(made: Made) -> Waves:
    """Return the waves, with G of their own form: S along the lines is that of the truth however many directions."""
    truth = truth_of(made)
    if made.kind == "profile":
        roughness = float(converted(truth.areal, truth.dimension, made.density, source="areal", target="profile"))
    else:
        exponent = 4.0 - 2.0 * truth.dimension
        single = float(converted(truth.areal, truth.dimension, made.density, source="areal", target="one_direction"))
        angles = np.pi * np.arange(1, made.directions + 1) / made.directions
        share = float(np.mean(np.abs(np.cos(angles)) ** exponent))  # of S across one ridge, along the lines
        roughness = single / share ** (1.0 / (2.0 - exponent))
    return Waves(
        dimension=truth.dimension,
        roughness=roughness,
        lowest=truth.lowest,
        highest=truth.highest,
        density=float(made.density),
        directions=made.directions,
    )


def is_possible(made: Made, truth: Truth) -> bool:
    """State what must hold, and say whether all of it does."""
    found = list(_demands(made, truth))
    for holds, sentence in found:
        feasible(holds, sentence)
    return all(holds for holds, _ in found)


def _demands(made: Made, truth: Truth) -> Iterator[tuple[bool, str]]:
    margin = 2 * instrument_of(made).margin(float(made.spacing))
    lines, points = truth.shape
    shape = (lines + margin * is_patch(made, truth), points + margin)
    dimension = truth.dimension
    yield 1.05 <= dimension <= 1.95, "a fractal dimension below 2.05 or above 2.95: exponents diverge"
    yield points >= 64, "a line has fewer than 64 points: make length larger or spacing smaller"
    yield shape[0] * shape[1] <= LARGEST, f"the flank has more than {LARGEST} points: make it smaller or spacing larger"
    shortest = float(made.shortest_lag)
    told = "shortest_lag is more than a twentieth of a line, and the longest lag of the fit is a tenth"
    yield not shortest > 0.05 * points * float(made.spacing), told
    if made.kind == "brownian":
        is_small = lines == 1 or field_side(dimension, shape) ** 2 <= LARGEST_FIELD
        yield is_small, "the field of the Brownian patch does not fit into memory: make it smaller or spacing larger"
        return
    yield truth.highest > truth.lowest, "the shortest wave is not shorter than the longest one"
    waves = np.log(truth.highest / truth.lowest) / np.log(float(made.density))
    waves *= made.directions if made.kind == "areal" else 1
    told = "the waves of the flank do not fit into memory: fewer directions, a larger density or a smaller flank"
    yield bool(waves * sum(shape) <= MOST_WAVES), told
