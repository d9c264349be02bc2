"""What scatters, how far the finite number of measured lines leaves the answer open, and where laws end."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import nan
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.special import ndtr, ndtri

from gear_geometry.drawing import BLUE, panels, quiet
from harmonic_fractal.contact import Rough, contact_of, flanks_of, interface_of, pressed, together
from harmonic_fractal.figures import or_none
from harmonic_fractal.flank import Flank
from harmonic_fractal.quantities import Drive
from truing import (
    Array,
    Bench,
    Block,
    Drawing,
    Float,
    Outcome,
    Sensitivities,
    Table,
    Tolerance,
    TruingError,
    Words,
    drawn,
    found,
    lognormal,
    normal,
    quantity,
    results,
)

# What scatters: the estimate of D and G from a measured flank, the materials, and the compliance around the mesh

FLANKS = (
    "surface", "mating_surface", "fractal_dimension", "fractal_roughness", "mating_dimension", "mating_roughness",
    "convention", "density", "sampling", "longest_lag",
)  # fmt: skip
"""The inputs that make up the interface of both flanks."""


def flank_samples(rng: np.random.Generator, rows: int, **flanks: Any) -> Mapping[str, Any]:
    """Draw pairs of D and ln G of both flanks together, each from the bootstrap pairs of its measured lines.

    Returns deviations (rows,) from the estimate by name of their input; nothing where no flank was measured. Errors of
    D and ln G hang together closely, so they are never drawn apart.
    """
    measured = flanks["surface"], flanks["mating_surface"]
    if not any(flank is not None and len(flank.resampled) for flank in measured):
        return {}
    drive = replace(Drive(), **flanks)
    first, second = flanks_of(drive)
    sampled = [_redrawn(rough, flank, rng, rows) for rough, flank in zip((first, second), measured, strict=True)]
    middle, both = together(first, second, drive), together(sampled[0] or first, sampled[1], drive)
    return {
        "dimension_deviation": both.dimension - middle.dimension,
        "roughness_deviation": np.log(both.roughness / middle.roughness),
    }


def _redrawn(rough: Rough | None, flank: Flank | None, rng: np.random.Generator, rows: int) -> Rough | None:
    """Return a flank with as many deviations of D and ln G as rows, from its pairs less their mean; or as it is."""
    if rough is None or flank is None or not len(flank.resampled):
        return rough
    used = flank.used
    middle = np.array([rough.dimension, np.log(rough.roughness)]) if used is not None else 0.0
    pairs = (flank.resampled - middle)[rng.integers(len(flank.resampled), size=rows)]
    return Rough(dimension=rough.dimension + pairs[:, 0], roughness=rough.roughness * np.exp(pairs[:, 1]))


def share_of_compliance(rng: np.random.Generator, rows: int, *, drive_compliance: float) -> Mapping[str, Any]:
    """Draw a hundredth of the compliance around the mesh; nothing where that is 0."""
    if not drive_compliance:
        return {}
    return {"drive_compliance": 0.01 * drive_compliance * rng.standard_normal(rows)}


TOLERANCES = [
    Tolerance(
        "estimate", drawn(flank_samples, of=FLANKS), on=["dimension_deviation", "roughness_deviation"],
        why="D and ln G come from a finite number of lines: pairs from resampled blocks of them, where a flank was "
        "measured", source="bootstrap of the measured lines",
    ),
    Tolerance("hardness", lognormal(sd="6 %"), why="batch scatter on the certificate", source="typical"),
    Tolerance(
        "youngs_modulus", normal(sd="1 %"), on=["youngs_modulus_flexspline", "youngs_modulus_circular"],
        why="from melt to melt of one steel", source="typical",
    ),
    Tolerance(
        "drive_compliance", drawn(share_of_compliance, of=["drive_compliance"]),
        why="a standard deviation of 1 % of what is stated", source="typical of a bench",
    ),
]  # fmt: skip


# What the stiffness of a pair hangs on: its logarithmic derivatives, from the study 'sensitivity'

NOTE = "relative change of the stiffness of the pair"
SOURCES = (
    "dimension_deviation", "roughness_deviation", "hardness", "youngs_modulus_flexspline", "youngs_modulus_circular",
    "pair_load", "torque", "engaged_factor", "drive_compliance",
)  # fmt: skip


@results
class LocalSlopes:
    """By how much the stiffness of one pair changes, in parts of itself."""

    slope_dimension: Float = found("", symbol="k_D", note=f"{NOTE} per unit of D at the same G", method="differences")
    slope_roughness: Float = found("", symbol="k_G", note=f"{NOTE} per ln G", method="differences")
    slope_hardness: Float = found("", symbol="k_H", note=f"{NOTE} per ln H", method="differences")
    slope_load: Float = found("", symbol="k_F", note=f"{NOTE} per ln F; the load exponent m", method="differences")


def slopes(found_by: Sensitivities) -> LocalSlopes:
    """Divide the derivatives by the stiffness; a source that the study was not asked for has none."""
    drive: Drive = found_by.inputs
    stiffness = float(pressed(drive.pair_load, contact_of(drive, interface_of(drive))).stiffness)
    derivative = found_by.derivatives.get("stiffness", {})

    def relative(source: str, by: Float = 1.0) -> float:
        return derivative.get(source, nan) * float(by) / stiffness if stiffness else nan

    return LocalSlopes(
        slope_dimension=relative("dimension_deviation"),
        slope_roughness=relative("roughness_deviation"),
        slope_hardness=relative("hardness", drive.hardness),
        slope_load=relative("pair_load", drive.pair_load),
    )


# A study of our own: how far the finite number of measured lines leaves stiffness and torsion open

OF = ("stiffness", "clearance", "closing_clearance", "dimension", "roughness", "mesh_stiffness", "torsion")
PAIR = ("dimension_deviation", "roughness_deviation")
MOST = 100_000
TOGETHER = 1024
NOTHING = (
    "No flank was measured, so how sure D and G are is not known, and nothing is propagated. The tolerances of the "
    "study 'reliability' hold for what was stated."
)


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Propagate ``draws`` pairs of D and ln G, as resampled lines give them, to the results ``of``.

    Beside them the same values of D and ln G drawn apart, which is what independent error bars would claim. All other
    inputs stay as they are.
    """

    of: tuple[str, ...] = OF
    draws: int = 2000
    name: str = "uncertainty"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not 20 <= self.draws <= MOST:
            raise TruingError(f"study '{self.name}': draws = {self.draws}, but 20 to {MOST} can be propagated")

    def run(self, bench: "Bench") -> "Propagated":
        """Calculate every pair, and every pair taken apart."""
        known = bench.setup.model.own_result_fields
        unknown = [name for name in self.of if name not in known or known[name].along]
        if unknown:
            raise TruingError(f"study '{self.name}': '{unknown[0]}' is no result that is one number")
        units = {name: bench.setup.print_unit(name) for name in self.of}
        rng = np.random.default_rng(np.random.SeedSequence(bench.setup.seed, spawn_key=(1,)))
        drawn_pairs = flank_samples(rng, self.draws, **{name: getattr(bench.inputs, name) for name in FLANKS})
        if not drawn_pairs:
            return Propagated(name=self.name, inputs=bench.inputs, units=units)
        pairs = np.stack([drawn_pairs[name] for name in PAIR], axis=1)
        shuffled = np.random.default_rng(bench.setup.seed).permutation(pairs[:, 1])
        nominal = [float(bench.setup.nominal(name)) for name in PAIR]

        def answered(logarithm: Array, begin: float) -> Mapping[str, Any]:
            columns = dict(zip(PAIR, (nominal[0] + pairs[:, 0], nominal[1] + logarithm), strict=True))
            return self._answered(bench, columns, bench.part(self.name, begin, begin + 0.5))

        together, apart = answered(pairs[:, 1], 0.0), answered(shuffled, 0.5)
        summaries = {name: _summary(float(bench.answers[name]), together[name], apart[name]) for name in self.of}
        return Propagated(name=self.name, inputs=bench.inputs, units=units, pairs=pairs, summaries=summaries)

    def _answered(self, bench: Bench, columns: Mapping[str, Any], done: Callable[[int, int], None]) -> dict[str, Any]:
        """Calculate all pairs, so many in one call that nobody waits long for the next word."""
        parts = []
        for start in range(0, self.draws, TOGETHER):
            done(start, self.draws)
            rows = {name: values[start : start + TOGETHER] for name, values in columns.items()}
            parts.append(bench.rows(rows, min(TOGETHER, self.draws - start), *self.of))
        done(self.draws, self.draws)
        return {name: np.concatenate([part[name] for part in parts]) for name in self.of}


@dataclass(frozen=True, kw_only=True)
class Summary:
    """One result in SI: at the estimate, median and 95 % interval of the pairs; relative standard deviations."""

    nominal: float
    low: float
    median: float
    high: float
    relative_sd: float
    independent_sd: float
    failed: int


def interval_about(nominal: float, values: Array) -> tuple[float, float]:
    """Return the 95 % interval of a result from its values (n,) by the pairs, and at the estimate; NaN left out.

    Percentiles; and where the values lie on one side of that at the estimate, as those of K of smooth flanks do, which
    is about its least there, the end on the other side is that of bias-corrected percentiles (Efron 1981). Plain ones
    held K on 8 of 10 patches of D_s 1.2, corrected ones alone on 9 of 10 of D_s 1.3.
    """
    known = values[np.isfinite(values)]
    if not known.size or not np.isfinite(nominal):
        return nan, nan
    below = 0.5 * (np.mean(known < nominal) + np.mean(known <= nominal))
    shift = 2.0 * ndtri(np.clip(below, 0.5 / known.size, 1.0 - 0.5 / known.size))
    low, high = np.quantile(known, ndtr([min(shift, 0.0) - 1.96, max(shift, 0.0) + 1.96]))
    return float(low), float(high)


def _summary(nominal: float, values: Array, independent: Array) -> Summary:
    """Return what the pairs say of one result: taken together (n,), and apart (n,)."""
    known = values[np.isfinite(values)]
    median = np.median(known) if known.size else nan
    low, high = interval_about(nominal, values)
    return Summary(
        nominal=nominal, low=low, median=float(median), high=high, relative_sd=_relative_sd(values),
        independent_sd=_relative_sd(independent), failed=int(len(values) - known.size),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Propagated(Outcome):
    """Pairs (n, 2) as deviations of D and ln G, and by result what they give, together and drawn apart.

    There are none where no flank was measured. ``inputs`` are those of the run, as effects leave them.
    """

    name: str
    inputs: Drive
    units: Mapping[str, str]
    pairs: Array = field(default_factory=lambda: np.empty((0, 2)))
    summaries: Mapping[str, Summary] = field(default_factory=dict)

    @property
    def correlation(self) -> float:
        """Of the deviations of D and of ln G."""
        return float(np.asarray(np.corrcoef(self.pairs.T))[0, 1])

    def as_json(self) -> Mapping[str, Any]:
        """Return spread and correlation of the pairs, and by result median, interval and relative deviations."""
        if not self.summaries:
            return {"draws": 0}
        results = {}
        for result, each in self.summaries.items():
            unit = self.units[result]
            one = quantity(f"1 {unit}", unit)
            numbers = {name: or_none(getattr(each, name) / one) for name in ("nominal", "median")}
            interval = [or_none(end / one) for end in (each.low, each.high)]
            shares = {"relative_sd": or_none(each.relative_sd), "if_independent": or_none(each.independent_sd)}
            results[result] = {**numbers, "interval95": interval, "unit": unit, **shares, "failed": each.failed}
        sd = self.pairs.std(axis=0, ddof=1)
        return {
            "draws": len(self.pairs),
            "dimension_sd": float(sd[0]),
            "log_roughness_sd": float(sd[1]),
            "correlation": or_none(self.correlation),
            "results": results,
        }

    def blocks(self) -> Sequence[Block]:
        """Return what the pairs give, in a table and a figure."""
        if not self.summaries:
            return [Words(NOTHING)]
        rows: list[tuple[str | float, ...]] = []
        for result, each in self.summaries.items():
            unit = self.units[result]
            one = quantity(f"1 {unit}", unit)
            numbers = (value / one for value in (each.nominal, each.median, each.low, each.high))
            shares = (100.0 * each.relative_sd, 100.0 * each.independent_sd)
            spoken = unit.replace("*", "·").replace("urad", "µrad").replace("um", "µm")
            rows.append((result.replace("_", " "), *(float(value) for value in numbers), spoken, *shares))
        return [
            Words(self._said()),
            Table(
                "What the measured lines leave open",
                ("result", "at the estimate", "median", "2.5 %", "97.5 %", "unit", "sd", "sd if independent"), rows,
                ("", "", "", "", "", "", "%", "%"),
                "Of D and G alone, as far as one patch of this size leaves them open; hardness and moduli scatter "
                "beside. Model errors are not in it.",
            ),
            Drawing(
                "Pairs of D and ln G", partial(pairs_figure, self.pairs),
                "Each point is one set of lines, or one patch: where D is found larger, so is G.",
            ),
        ]  # fmt: skip

    def _said(self) -> str:
        sd, (first, summary) = self.pairs.std(axis=0, ddof=1), next(iter(self.summaries.items()))
        ratio = summary.independent_sd / summary.relative_sd if summary.relative_sd else float("nan")
        return (
            f"{len(self.pairs)} pairs of D and ln G, as other patches would have them: standard deviations {sd[0]:.2g} "
            f"and {sd[1]:.2g}, correlation {self.correlation:.4f}".replace("-", "−")
            + f". Their errors go together: the {first.replace('_', ' ')} has a standard deviation of "
            f"{100 * summary.relative_sd:.2g} %. Two independent error bars would claim "
            f"{100 * summary.independent_sd:.2g} %, {ratio:.2g} times as much."
        )

    def warnings(self) -> Sequence[str]:
        """Name pairs without an answer."""
        failed = max((each.failed for each in self.summaries.values()), default=0)
        return [f"study '{self.name}': {failed} of {len(self.pairs)} pairs have no answer"] if failed else []


def _relative_sd(values: "Array") -> float:
    """Return the standard deviation over the size of the mean; NaN without any."""
    known = values[np.isfinite(values)]
    mean = abs(float(known.mean())) if known.size > 1 else 0.0
    return float(known.std(ddof=1)) / mean if mean else float("nan")


def pairs_figure(pairs: "Array") -> "Figure":
    """Draw the cloud of pairs."""
    figure, panel = panels(1, 3.0)
    panel.plot(pairs[:, 0], pairs[:, 1], ".", color=BLUE, markersize=2.5, alpha=0.5, rasterized=True)
    quiet(panel, "deviation of D", "deviation of ln G")
    return figure


# A study of our own: what was measured badly, refused, or carried beyond what the laws were made for

RESOLVED = 0.3  # radius of the critical area over the sampling interval
PLASTIC = 0.5  # share of the load on plastic contacts
BODIES = {"surface": "fractal_dimension and fractal_roughness", "mating_surface": "mating_dimension, if it is stated"}


@dataclass(frozen=True, kw_only=True)
class SurfaceValidity:
    """Collect what its reader must know of every measured flank and of the contact that follows."""

    name: str = "validity"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "SurfaceValid":
        """Look at the flanks and at the answers."""
        drive: Drive = bench.inputs
        beyond = [*_of_flanks(drive), *_of_contact(bench.answers)]
        return SurfaceValid(name=self.name, inputs=drive, beyond=tuple(beyond))


def _of_flanks(drive: Drive) -> Iterator[str]:
    for name, stated in BODIES.items():
        flank: Flank | None = getattr(drive, name)
        if flank is None:
            continue
        if flank.used is None:
            yield f"{name} is refused, the contact is that of {stated}: {flank.reason}"
        elif flank.surface.is_profile:
            yield f"{name} is one profile: that it looks the same in all directions is assumed"
        elif flank.chosen != "both" and not any("direction" in sentence for sentence in flank.warnings):
            yield f"{name} is taken along {flank.chosen} only"
        yield from (f"{name}: {sentence}" for sentence in flank.warnings)


def _of_contact(answers: Any) -> Iterator[str]:
    share, stiffness = float(answers["resolved_share"]), float(answers["stiffness"])
    if share < RESOLVED:
        yield (
            f"extrapolated below resolution: the stiffness hangs on contacts of {share:.2g} sampling intervals radius, "
            f"less than {RESOLVED:g}"
        )
    if stiffness == 0.0:
        yield "all contacts of the pair are plastic at pair_load, and the model gives it no stiffness"
    elif float(answers["plastic_share"]) > PLASTIC:
        yield (
            f"{float(answers['plastic_share']):.0%} of the load is on plastic contacts, to which the model gives no "
            "stiffness"
        )


@dataclass(frozen=True, kw_only=True)
class SurfaceValid(Outcome):
    """What was found; ``inputs`` are those of the run, as effects leave them."""

    name: str
    inputs: Drive
    beyond: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """Return every flank with what each direction says, and what is beyond its range."""
        flanks = {name: _flank_json(flank) for name in BODIES if (flank := getattr(self.inputs, name)) is not None}
        return {"flanks": flanks, "beyond": list(self.beyond)}

    def warnings(self) -> Sequence[str]:
        """Return what is beyond its range."""
        return [f"study '{self.name}': {text}" for text in self.beyond]


def _flank_json(flank: "Flank") -> dict[str, Any]:
    return {
        "file": flank.surface.name,
        "chosen": flank.chosen,
        "reason": flank.reason,
        "missing": flank.missing,
        "spikes": flank.spiked,
        "sq": {"unit": "um", "raw": flank.sq_raw * 1e6, "plane": flank.sq_plane * 1e6,
               "second_order": flank.sq_second_order * 1e6},
        "directions": {found.direction: _estimate_json(found) for found in flank.estimates},
    }  # fmt: skip


def _estimate_json(found: Any) -> dict[str, Any]:
    def list_of(values: Any, factor: float = 1.0) -> Any:
        return [float(value) * factor if value == value else None for value in values]

    dimension, roughness, r_squared = list_of((found.dimension, found.roughness, found.r_squared))
    window, with_noise, share = list_of((found.window_dimension, found.noise_dimension, found.noise_share))
    return {
        "accepted": found.is_accepted,
        "reason": found.reason,
        "profile_dimension": dimension,
        "roughness": {"value": roughness, "unit": "m", "convention": "areal"},
        "r_squared": r_squared,
        "interval95": {
            "profile_dimension": list_of(found.dimension_interval),
            "roughness": list_of(found.roughness_interval),
        },
        "as_levelled": dict(
            zip(
                ("profile_dimension", "roughness"),
                list_of((found.levelled_dimension, found.levelled_roughness)),
                strict=True,
            )
        ),
        "for_comparison": {
            "roughness_length": window,
            "with_noise": with_noise,
            "noise_share": share,
            **dict(zip(("disagreement", "in_sd"), list_of((found.window_disagreement, found.window_sds)), strict=True)),
        },
        "range": {"unit": "um", "values": list_of(found.range, 1e6)},
        "lags": {"unit": "um", "values": list_of(found.lags, 1e6)},
        "structure_function": {"unit": "um^2", "values": list_of(found.values, 1e12)},
        "local_lags": {"unit": "um", "values": list_of(found.local_lags, 1e6)},
        "local_dimensions": list_of(found.local_dimensions),
    }
