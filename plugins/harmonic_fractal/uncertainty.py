"""A study of our own: how far the finite number of measured lines leaves stiffness and torsion open."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harmonic_fractal.drawn_look import BLUE, panels, quiet
from harmonic_fractal.quantities import Drive
from harmonic_fractal.tolerances import FLANKS, flank_samples
from truing import Bench, Block, Check, Drawing, Table, TruingError, Words, quantity

Array = NDArray[np.float64]

OF = ("stiffness", "clearance", "mesh_stiffness", "torsion")
PAIR = ("dimension_deviation", "roughness_deviation")
CAUSE = "estimate"  # the tolerance that draws the pairs
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
        pairs = self._pairs(bench)
        units = {name: bench.setup.print_unit(name) for name in self.of}
        if pairs is None:
            return Propagated(name=self.name, inputs=bench.inputs, units=units)
        apart = np.random.default_rng(bench.setup.seed).permutation(pairs[:, 1])
        nominal = [float(bench.setup.nominal(name)) for name in PAIR]

        def answered(logarithm: "Array", begin: float) -> Mapping[str, Any]:
            columns = dict(zip(PAIR, (nominal[0] + pairs[:, 0], nominal[1] + logarithm), strict=True))
            return self._answered(bench, columns, bench.part(self.name, begin, begin + 0.5))

        return Propagated(
            name=self.name, inputs=bench.inputs, units=units, pairs=pairs, together=answered(pairs[:, 1], 0.0),
            apart=answered(apart, 0.5), nominal={name: float(bench.answers[name]) for name in self.of},
        )  # fmt: skip

    def _answered(self, bench: "Bench", columns: Mapping[str, Any], done: Callable[[int, int], None]) -> dict[str, Any]:
        """Calculate all pairs, so many in one call that nobody waits long for the next word."""
        parts = []
        for start in range(0, self.draws, TOGETHER):
            done(start, self.draws)
            rows = {name: values[start : start + TOGETHER] for name, values in columns.items()}
            parts.append(bench.rows(rows, min(TOGETHER, self.draws - start), *self.of))
        done(self.draws, self.draws)
        return {name: np.concatenate([part[name] for part in parts]) for name in self.of}

    def _pairs(self, bench: "Bench") -> "Array | None":
        """Draw the pairs as deviations (draws, 2), or nothing where no flank was measured."""
        rng = np.random.default_rng(np.random.SeedSequence(bench.setup.seed, spawn_key=(1,)))
        found = flank_samples(rng, self.draws, **{name: getattr(bench.inputs, name) for name in FLANKS})
        return np.stack([found[name] for name in PAIR], axis=1) if found else None


@dataclass(frozen=True, kw_only=True, eq=False)
class Propagated:
    """Pairs (n, 2) as deviations of D and ln G, and by result what they give (n,) in SI: together, and drawn apart.

    ``pairs`` is None where no flank was measured. ``inputs`` are those of the run, as effects leave them.
    """

    name: str
    inputs: Drive
    units: Mapping[str, str]
    pairs: "Array | None" = None
    together: Mapping[str, Any] | None = None
    apart: Mapping[str, Any] | None = None
    nominal: Mapping[str, float] | None = None

    @property
    def correlation(self) -> float:
        """Of the deviations of D and of ln G."""
        return float("nan") if self.pairs is None else float(np.asarray(np.corrcoef(self.pairs.T))[0, 1])

    def summary(self, result: str) -> "Summary":
        """Return what the pairs say of one result."""
        assert self.together is not None
        assert self.apart is not None
        assert self.nominal is not None
        values, independent = (np.asarray(each[result]) for each in (self.together, self.apart))
        known = values[np.isfinite(values)]
        low, median, high = np.percentile(known, (2.5, 50.0, 97.5)) if known.size else (np.nan,) * 3
        return Summary(
            nominal=self.nominal[result], low=float(low), median=float(median), high=float(high),
            relative_sd=_relative_sd(values), independent_sd=_relative_sd(independent),
            failed=int(len(values) - known.size),
        )  # fmt: skip

    def as_json(self) -> Mapping[str, Any]:
        """Return spread and correlation of the pairs, and by result median, interval and relative deviations."""
        if self.pairs is None or self.together is None:
            return {"draws": 0}
        results = {}
        for result in self.together:
            found, unit = self.summary(result), self.units[result]
            one = quantity(f"1 {unit}", unit)
            numbers = {name: _known(getattr(found, name) / one) for name in ("nominal", "median")}
            interval = [_known(end / one) for end in (found.low, found.high)]
            shares = {"relative_sd": _known(found.relative_sd), "if_independent": _known(found.independent_sd)}
            results[result] = {**numbers, "interval95": interval, "unit": unit, **shares, "failed": found.failed}
        sd = self.pairs.std(axis=0, ddof=1)
        return {
            "draws": len(self.pairs),
            "dimension_sd": float(sd[0]),
            "log_roughness_sd": float(sd[1]),
            "correlation": _known(self.correlation),
            "results": results,
        }

    def blocks(self) -> Sequence[Block]:
        """Return what the pairs give, in a table and a figure."""
        if self.pairs is None or self.together is None:
            return [Words(NOTHING)]
        rows: list[tuple[str | float, ...]] = []
        for result in self.together:
            found, unit = self.summary(result), self.units[result]
            one = quantity(f"1 {unit}", unit)
            numbers = (value / one for value in (found.nominal, found.median, found.low, found.high))
            shares = (100.0 * found.relative_sd, 100.0 * found.independent_sd)
            rows.append((result.replace("_", " "), *(float(value) for value in numbers), _spoken(unit), *shares))
        return [
            Words(self._said()),
            Table(
                "What the measured lines leave open",
                ("result", "at the estimate", "median", "2.5 %", "97.5 %", "unit", "sd", "sd if independent"), rows,
                ("", "", "", "", "", "", "%", "%"),
                "Of D and G alone; hardness and moduli scatter beside. Model errors are not in it.",
            ),
            Drawing(
                "Pairs of D and ln G", partial(pairs_figure, self.pairs),
                "Each point is one set of resampled lines: where D is found larger, so is G.",
            ),
        ]  # fmt: skip

    def _said(self) -> str:
        assert self.pairs is not None
        assert self.together is not None
        sd, first = self.pairs.std(axis=0, ddof=1), next(iter(self.together))
        found = self.summary(first)
        ratio = found.independent_sd / found.relative_sd if found.relative_sd else float("nan")
        return (
            f"{len(self.pairs)} pairs of D and ln G from resampled blocks of lines: standard deviations {sd[0]:.2g} "
            f"and {sd[1]:.2g}, correlation {self.correlation:.4f}".replace("-", "−")
            + f". Their errors go together: the {first.replace('_', ' ')} has a standard deviation of "
            f"{100 * found.relative_sd:.2g} %. Two independent error bars would claim {100 * found.independent_sd:.2g} "
            f"%, {ratio:.2g} times as much."
        )

    def checks(self) -> "Sequence[Check]":
        """Return nothing: an uncertainty decides no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Name pairs without an answer."""
        if self.together is None:
            return ()
        failed = max(self.summary(result).failed for result in self.together)
        lost = (
            f"study '{self.name}': {failed} of {len(next(iter(self.together.values())))} pairs have no answer"
            if failed
            else ""
        )
        return (lost,) if lost else ()


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


def _relative_sd(values: "Array") -> float:
    """Return the standard deviation over the size of the mean; NaN without any."""
    known = values[np.isfinite(values)]
    mean = abs(float(known.mean())) if known.size > 1 else 0.0
    return float(known.std(ddof=1)) / mean if mean else float("nan")


def _known(value: Any) -> float | None:
    return float(value) if value == value else None


def _spoken(unit: str) -> str:
    """Write a unit as it is printed."""
    return unit.replace("*", "·").replace("urad", "µrad").replace("um", "µm")


def pairs_figure(pairs: "Array") -> "Figure":
    """Draw the cloud of pairs."""
    figure, (panel,) = panels(1, 3.0)
    panel.plot(pairs[:, 0], pairs[:, 1], ".", color=BLUE, markersize=2.5, alpha=0.5, rasterized=True)
    quiet(panel, "deviation of D", "deviation of ln G")
    return figure
