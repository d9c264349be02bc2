"""A flank is made, looked at, its dimension and roughness are found again; and written as a data file."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy

from harmonic_fractal import generators
from harmonic_fractal.estimate import Estimate, Estimation, estimate_of
from harmonic_fractal.structure import converted, structure_function, structure_sums
from harmonic_fractal.surface import Direction, Lines, Surface, without_form, without_line
from truing import (
    Array,
    Bench,
    Block,
    Float,
    Outcome,
    TruingError,
    Words,
    feasible,
    found,
    given,
    inputs,
    results,
    rows,
)

# What a made flank is told: its truth, its size, the waves it consists of, and the instrument that looks at it

TYPICAL = "typical of ground and shaped flanks"
PATCH = "the patch of 0.2 mm by 0.1 mm of the patent"
RULE = "rule for trying an estimator"


@inputs
class Made:
    """A flank of known dimension and roughness."""

    kind: Literal["areal", "brownian", "profile"] = given(
        "areal", note="waves in all directions (Weierstrass-Mandelbrot, areal), fractional Brownian motion, or lines "
        "of a Weierstrass-Mandelbrot profile that know nothing of one another",
    )  # fmt: skip
    fractal_dimension: Float = given(2.4, "", symbol="D", note="fractal dimension of the surface, one above that of "
                                     "its profiles", source=TYPICAL, above=2, below=3)  # fmt: skip
    fractal_roughness: Float = given(1e-11, "m", symbol="G",
                                     note="fractal roughness, in the convention stated beside it", source=TYPICAL,
                                     above=0, at_most=1e-3, stated_with="convention")  # fmt: skip
    convention: Literal["areal", "one_direction", "profile"] = given(
        "areal", note="of G as stated: areal (ridges in all directions), one_direction (ridges across the trace), or "
        "profile (Weierstrass-Mandelbrot profile, with the logarithm of the density)",
    )  # fmt: skip
    density: Float = given(1.5, "", symbol="gamma", note="ratio of neighbouring frequencies", source="the patent",
                           above=1, at_most=10)  # fmt: skip
    # The patch
    length: Float = given(200.0, "um", symbol="L_x", note="along the lines", source=PATCH, above=0, at_most=1e5)
    width: Float = given(100.0, "um", symbol="L_y", note="across the lines; 0: a single profile", source=PATCH,
                         at_least=0, at_most=1e5)  # fmt: skip
    spacing: Float = given(0.4, "um", symbol="dx", note="of the points, both ways", above=0, at_most=1000)
    # The waves
    directions: int = given(40, symbol="M", note="directions of the ridges of an areal surface, over half a turn; "
                            "with 1 they all run across the lines", at_least=1, at_most=1000)  # fmt: skip
    longest_wave: Float = given(None, "mm", symbol="lambda_max", note="not given: 100 times the longer side of the "
                                "patch", source=RULE, above=0)  # fmt: skip
    shortest_wave: Float = given(None, "um", symbol="lambda_min", note="not given: a fiftieth of the spacing",
                                 source=RULE, above=0)  # fmt: skip
    seed: int = given(0, note="of all that is random; another one gives another flank of the same truth", at_least=0)
    # The instrument
    filter_cutoff: Float = given(0.0, "um", symbol="lambda_s", note="wave length of which half the amplitude passes "
                                 "the lateral filter; 0: no filter", source="ISO 16610-21", at_least=0,
                                 at_most=1e4)  # fmt: skip
    noise: Float = given(0.0, "nm", symbol="sigma_z", note="standard deviation of the height of each point",
                         at_least=0, at_most=1e6)  # fmt: skip
    height_step: Float = given(0.0, "nm", note="smallest difference of height that is told", at_least=0, at_most=1e6)
    spikes: Float = given(0.0, "%", note="share of points that stand out", at_least=0, at_most=50)
    spike_height: Float = given(500.0, "nm", note="by which they stand out, up or down", at_least=0, at_most=1e6)
    holes: Float = given(0.0, "%", note="share of points that were not measured", at_least=0, at_most=50)
    # How dimension and roughness are found again
    noise_aware: bool = given(False, note="fit a constant of white noise beside the power law")
    shortest_lag: Float = given(None, "um", symbol="xi_min", note="of the fit; not given: the spacing", above=0,
                                at_most=1e5)  # fmt: skip


# What is told of a made flank: its truth, its heights, its structure function, and what an estimator makes of it

PLANE = "after its mean plane, or line, is taken away"


@results
class MadeFlank:
    """The truth, the flank that was made, and the truth as it is found again."""

    profile_dimension: Float = found("", symbol="D_s", note="dimension of its profiles",
                                     formula="fractal_dimension - 1")  # fmt: skip
    areal_roughness: Float = found(
        "m", symbol="G_areal", note="roughness in the areal convention, which the estimator gives",
        method="the same structure function along the lines, written in the areal convention",
    )  # fmt: skip
    points: Float = found("", symbol="N_x", note="points of a line", digits=9,
                          method="spacings that fit into the length, and one more")  # fmt: skip
    lines: Float = found("", symbol="N_y", note="lines", digits=9,
                         method="spacings that fit into the width, and one more")  # fmt: skip
    longest: Float = found("mm", symbol="lambda_1", note="longest wave of the sum; Brownian motion has longer ones",
                           method="stated, or by rule")  # fmt: skip
    shortest: Float = found("um", symbol="lambda_n", note="shortest wave of the sum; Brownian motion has shorter ones",
                            method="stated, or by rule")  # fmt: skip
    rms_height: Float = found(
        "nm", symbol="S_q", note=f"root mean square height {PLANE}", method="of the points", key=True
    )
    height: Float = found("nm", symbol="S_z", note=f"from the lowest to the highest point {PLANE}",
                          method="of the points")  # fmt: skip
    lag: Float = rows("lag", unit="um")
    structure_function: Float = found("nm^2", symbol="S", note="S of this flank as measured", along="lag",
                                      method="mean square of the difference of height, of all pairs")  # fmt: skip
    exact: Float = found("nm^2", symbol="S_exact", note="S of all flanks of this truth, before the instrument",
                         along="lag", method="sum over all waves; of Brownian motion its power law")  # fmt: skip
    power_law: Float = found("nm^2", symbol="S_law", note="power law", along="lag", method="closed form")
    fitted_dimension: Float = found("", symbol="D_fit", note="dimension of the surface, found again",
                                    method="straight line through ln S over ln lag, along the lines")  # fmt: skip
    fitted_roughness: Float = found("m", symbol="G_fit", note="roughness found again, areal convention",
                                    method="of the same fit")  # fmt: skip
    dimension_error: Float = found("", symbol="e_D", note="found less true",
                                   formula="fitted_dimension - fractal_dimension")  # fmt: skip
    roughness_error: Float = found("", symbol="e_G", note="decades by which the roughness found is above the true one",
                                   formula="log10(fitted_roughness / areal_roughness)")  # fmt: skip
    accepted: Float = found("", note="1 where the estimator sees a self-affine range, 0 where it refuses",
                            method="local slopes", digits=1)  # fmt: skip


# What a made flank is made of: truth, waves, instrument, and what must hold so that it can be made

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


def waves_of(made: Made) -> generators.Waves:
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
    return generators.Waves(
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


def is_a_flank(made: Made) -> bool:
    """State what each number must be alone, as differences about a nominal value leave its bounds, and say if it is."""
    sizes, shares = (made.length, made.spacing), (made.spikes, made.holes)
    least = (made.width, made.filter_cutoff, made.noise, made.height_step, made.spike_height)
    found = (
        (all(0.0 < float(size) < np.inf for size in sizes), "length and spacing must be above 0"),
        (
            all(0.0 <= float(size) < np.inf for size in least),
            "width, filter_cutoff, noise, height_step and spike_height must be 0 or more",
        ),
        (all(0.0 <= float(share) <= 1.0 for share in shares), "spikes and holes are shares of the points, 0 to 1"),
        (float(made.fractal_roughness) > 0.0 and float(made.density) > 1.0, "G must be above 0 and density above 1"),
        (
            not any(float(wave) <= 0.0 for wave in (made.longest_wave, made.shortest_wave)),
            "a wave has a length above 0",
        ),
    )
    for holds, sentence in found:
        feasible(holds, sentence)
    return all(holds for holds, _ in found)


def _demands(made: Made, truth: Truth) -> Iterator[tuple[bool, str]]:
    margin = 2 * margin_of(made)
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
        is_small = lines == 1 or generators.field_side(dimension, shape) ** 2 <= LARGEST_FIELD
        yield is_small, "the field of the Brownian patch does not fit into memory: make it smaller or spacing larger"
        return
    yield truth.highest > truth.lowest, "the shortest wave is not shorter than the longest one"
    waves = np.log(truth.highest / truth.lowest) / np.log(float(made.density))
    waves *= made.directions if made.kind == "areal" else 1
    told = "the waves of the flank do not fit into memory: fewer directions, a larger density or a smaller flank"
    yield bool(waves * sum(shape) <= MOST_WAVES), told


ROWS = 20  # lags of the table


def made_flank(made: Made) -> MadeFlank:
    """Make one flank and find its truth again; numbers only, SI: the kernel calls it once per row of a batch."""
    if not is_a_flank(made) or not is_possible(made, truth := truth_of(made)):
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
    truth, spacing = truth_of(made), float(made.spacing)
    of_flank, of_instrument = np.random.default_rng(made.seed).spawn(2)
    made_heights = _heights(made, margin_of(made), of_flank)
    heights = as_measured(made_heights, made, of_instrument, across=is_patch(made, truth))
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
        make = generators.brownian_surface if lines > 1 else generators.brownian_profiles
        return make(truth.dimension, step, (lines, points), rng)
    x, y = (
        spacing * np.arange(-before, count - before, dtype=np.float64)
        for before, count in ((margin, points), (beside, lines))
    )
    if made.kind == "profile":
        return generators.weierstrass_profile(waves_of(made), x, lines, rng)
    return generators.weierstrass_surface(waves_of(made), x, y, rng)


# What an instrument makes of a surface: lateral filter, noise, steps of its scale, spikes and holes

# ISO 16610-21
DEVIATION = float(np.sqrt(np.log(2.0) / 2.0) / np.pi)  # of the Gaussian weight over the wave that is halved, 0.1874
REACH = 4.0  # standard deviations to which the weight is taken


def margin_of(made: Made) -> int:
    """Return how many points beyond its edge the lateral filter needs on each side."""
    return int(np.ceil(REACH * DEVIATION * float(made.filter_cutoff) / float(made.spacing)))


def as_measured(heights: Array, made: Made, rng: np.random.Generator, *, across: bool = True) -> Array:
    """Return heights (rows, points), m, as the instrument gives them, NaN in its holes.

    The filter takes the margin away on each side; without ``across`` it acts along the rows only, and takes nothing
    away across them. Order: filter, noise, steps, spikes, holes. Spikes and holes are shares of the points, each alone.
    """
    seen = _filtered(heights, made, across=across)
    seen = seen + float(made.noise) * rng.standard_normal(seen.shape)
    step = float(made.height_step)
    if step > 0.0:
        seen = np.round(seen / step) * step
    flat = seen.ravel()
    order = rng.permutation(flat.size)
    spikes, holes = (round(float(share) * flat.size) for share in (made.spikes, made.holes))
    flat[order[:spikes]] += float(made.spike_height) * rng.choice([-1.0, 1.0], spikes)
    flat[order[flat.size - holes :]] = np.nan
    return np.asarray(flat.reshape(seen.shape), dtype=np.float64)


def _filtered(heights: Array, made: Made, *, across: bool) -> Array:
    """Weigh with a Gaussian along the rows, and across them where asked, and cut the margin off."""
    margin = margin_of(made)
    if not margin:
        return heights.copy()
    deviation = DEVIATION * float(made.filter_cutoff) / float(made.spacing)
    seen = scipy.ndimage.gaussian_filter(heights, (deviation if across else 0.0, deviation), truncate=REACH)
    rows = slice(margin, -margin) if across else slice(None)
    return np.asarray(seen[rows, margin:-margin], dtype=np.float64)


def exact_structure_function(made: Made, lags: Array) -> Array:
    """Return S (k,), m^2, along the lines of all flanks of this truth, before the instrument."""
    truth = truth_of(made)
    if made.kind == "brownian":
        return np.asarray(structure_function(lags, truth.dimension, truth.areal))
    return (generators.profile_sum if made.kind == "profile" else generators.surface_sum)(waves_of(made), lags)


def levelled_structure_function(made: Made, lags: Array) -> Array:
    """Return S (k,), m^2, to be expected at whole spacings of lines that have lost their own straight line."""
    points, spacing = truth_of(made).shape[1], float(made.spacing)
    beyond = exact_structure_function(made, spacing * np.arange(1, points, dtype=np.float64))
    every = generators.levelled_structure(np.concatenate([[0.0], beyond]))
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


# A study of our own: the made flank as a data file, which a run of harmonic_fractal reads like a measured one

PLAIN = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,95}\.csv", re.ASCII)
SCALES = {"m": 1.0, "mm": 1e3, "um": 1e6, "nm": 1e9}


@dataclass(frozen=True, kw_only=True)
class FlankFile:
    """Write the flank into the run folder as ``file``: a matrix of heights, one line a row, in ``height_unit``."""

    file: str = "flank.csv"
    height_unit: str = "um"
    name: str = "flank_file"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if self.height_unit not in SCALES:
            raise TruingError(f"height_unit = '{self.height_unit}', but it is m, mm, um or nm")
        if not PLAIN.fullmatch(self.file):
            raise TruingError(
                f"file = '{self.file}', but it is a plain name that ends in .csv, of letters, digits, _, - and ., at "
                "most 100 of them; it stands in the run folder"
            )

    def run(self, bench: Bench) -> "Written":
        """Make the flank once more, as the effects that are on leave its inputs, and write it down."""
        made: Made = bench.inputs
        surface, truth = surface_of(made), truth_of(made)
        words = (
            f"made flank, {made.kind}, seed {made.seed}: fractal dimension of the surface "
            f"{made.fractal_dimension:.10g}, fractal roughness {truth.areal:.10g} m in the areal convention"
        )
        text = flank_text(surface, words, self.height_unit, cutoff=float(made.filter_cutoff))
        return Written(surface, self.file, text)


def flank_text(surface: Surface, words: str, height_unit: str = "um", *, cutoff: float = 0.0) -> str:
    """Return a surface as text: what it is, spacings, lateral filter and unit behind #, then its heights, a line a row.

    Numbers come back exactly; a point that was not measured is nan.
    """
    lengths = {"spacing_x": surface.spacing_x, "spacing_y": surface.spacing_y, "filter_width": cutoff}
    head = [f"# {words}"]
    head += [f"# {name} = {_exact(length, 1e6)} um" for name, length in lengths.items() if length > 0.0]
    head.append(f"# height_unit = {height_unit}")
    rows = (surface.heights * SCALES[height_unit]).tolist()
    return "\n".join([*head, *(",".join(repr(each) for each in row) for row in rows)]) + "\n"


def _exact(value: float, scale: float) -> str:
    """Return a number in a larger scale by as few digits as bring it back."""
    short = f"{value * scale:.12g}"
    return short if float(short) / scale == value else repr(value * scale)


@dataclass(frozen=True, eq=False)
class Written(Outcome):
    """The flank that was written, and its file."""

    surface: Surface
    file: str
    text: str

    @property
    def files(self) -> Mapping[str, str | bytes]:
        """The file by its name, for the run folder."""
        return {self.file: self.text}

    def as_json(self) -> Mapping[str, Any]:
        """Return the name of the file and the size of its matrix."""
        lines, points = self.surface.heights.shape
        missing = int(np.isnan(self.surface.heights).sum())
        return {"file": self.file, "lines": lines, "points": points, "missing": missing}

    def blocks(self) -> "Sequence[Block]":
        """Say what the file holds and how it is read."""
        lines, points = self.surface.heights.shape
        counted = "one line" if lines == 1 else f"{lines} lines"
        return [
            Words(
                f"The run folder holds {self.file}: {counted} of {points} points, with spacing and unit in its "
                "head. An inputs file of harmonic_fractal in that folder reads it by "
                f'surface = {{ file = "{self.file}", form = "none" }}: a made flank has no form to be taken away, and '
                "taking one raises the dimension that is found."
            )
        ]
