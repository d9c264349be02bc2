"""What would the model say, asked thousands of times? A Gaussian process learnt from a designed sample of its runs.

The model is vectorised, so a stand-in has to earn its place: the sheet says how long each takes for the same work, and
what the stand-in loses.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import count, pairwise
from time import perf_counter
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from truing.arrays import Matrix, one_thread
from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.near_miss import near_miss
from truing.errors import DeclarationError, UnitError, UsageError
from truing.evaluate import Rows, acting_inputs, evaluate_rows
from truing.executors import in_order, keepable, stays_here
from truing.formulas import Formula, evaluate, evaluate_quantities, parse
from truing.heavy import gaussian_kernels, gaussian_process, learning_exceptions, optimize, stats
from truing.packed import Packed, pack, unpack
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome, StepProgress
from truing.studies.checks import Z95, as_number, wilson
from truing.studies.drawings import BLUE, GREY, ORANGE, WIDTH, labelled
from truing.studies.reading import printed, printed_step, read_range, single_numbers, spoken
from truing.studies.sampling import generator
from truing.units import from_si, pint_quantity, split_quantity, unit_factor, unit_text

PROMISED = 0.95
FINE, COARSE = 61, 5
LARGEST = 3000
SHARES = (0.0, 0.2, 0.3, 0.6, 1.0)
"""Where the sample, the held-out points, the learning and the clock begin and end, for whoever waits."""


@dataclass(frozen=True, kw_only=True)
class Surrogate:
    """Learn results over a box of inputs from a designed sample, and say what it is worth.

    ``over`` gives a range to every direction of the box: an input, a condition, or a formula in them. Of a formula the
    one input without a range of its own follows: "a - b" beside "a" samples the difference and sets b. ``logarithmic``
    names directions that are learnt by their logarithm; ``log_result`` learns that of the results, which must be
    positive. ``design`` points are learnt from, ``held_out`` others judge. ``compare`` is the number of answers whose
    time is taken, of the model and of the surrogate (0: none). ``along`` is the input of the figure (empty: the first).
    """

    of: str | tuple[str, ...]
    over: Mapping[str, str] = field(hash=False)
    logarithmic: tuple[str, ...] = ()
    log_result: bool = False
    design: int = 150
    held_out: int = 60
    restarts: int = 3
    compare: int = 10_000
    along: str = ""
    batch: int = 1024
    name: str = "surrogate"
    gives: Callable[[Emulated], Any] | None = None

    def __post_init__(self) -> None:
        if not self.of or not self.over:
            raise UsageError("a surrogate needs results to learn (of) and ranges to learn them over (over)")
        if self.design < 2 * (len(self.over) + 1):
            raise UsageError(
                f"design = {self.design} is too few for {len(self.over)} directions; take {10 * len(self.over)} or more"
            )
        if self.design > LARGEST:
            raise UsageError(f"design = {self.design}, but learning from more than {LARGEST} points takes too long")
        if self.held_out < 10:
            raise UsageError(f"held_out = {self.held_out}, but at least 10 points are needed to judge a surrogate")
        if self.restarts < 0 or self.compare < 0 or self.batch < 1:
            raise UsageError("restarts and compare are not negative, and batch is at least 1")

    def run(self, bench: Bench) -> Emulated:
        """Run the designed sample, learn from it, judge it on others, and take the times."""
        setup = bench.setup
        names = single_numbers(setup, self.of, self.name)
        box = open_box(setup, self.over, self.logarithmic, self.name)
        along = self._along(box)
        sampling, judging, learning, timing = (bench.part(self.name, *ends) for ends in pairwise(SHARES))
        learnt, judge = (
            self._ran(bench, box, names, stage=stage, done=done) for stage, done in enumerate((sampling, judging))
        )
        processes, seconds = self._learnt(setup, box, learnt, learning)
        stand_in = StandIn(box, processes, self.log_result)
        units = {part.name: setup.print_unit(part.name) if part.is_plain else part.unit for part in box.features}
        return Emulated(
            name=self.name,
            of=names,
            stand_in=stand_in,
            judged=self._judged(stand_in, judge),
            course=_course(setup, stand_in, along),
            sample=learnt,
            judges=judge,
            own={name: float(bench.answers[name]) for name in names},
            units={name: setup.print_unit(name) for name in names} | units,
            inputs=acting_inputs(setup),
            speed=clocked(setup, stand_in, self, (learnt.seconds, seconds), timing) if self.compare else None,
        )

    def _along(self, box: Box) -> str:
        plain = [feature.name for feature in box.features if feature.is_plain]
        if self.along and self.along not in plain:
            raise UsageError(
                f"study '{self.name}': along = '{self.along}' is no input in over.{near_miss(self.along, plain)}"
            )
        return self.along or next(iter(plain), "")

    def _learnt(
        self, setup: Setup, box: Box, learnt: DesignedSample, done: StepProgress
    ) -> tuple[dict[str, Any], float]:
        """Fit every result; the clock does not count the import of scikit-learn."""
        kept = learnt.kept
        if kept.sum() < 2 * (len(box.features) + 1):
            reason = next(iter(learnt.rows.reasons.values()), "no result there is above zero")
            raise UsageError(
                f"study '{self.name}': only {int(kept.sum())} of {self.design} points have an answer to learn from "
                f"({reason}); make the ranges in over narrower"
            )
        assert gaussian_process.GaussianProcessRegressor  # imported before the clock starts
        start = perf_counter()
        places, fits, results = box.places(learnt.usable), count(1), learnt.rows.results

        def heard() -> None:
            done(next(fits), len(results) * (self.restarts + 1))

        processes = {name: fitted(places, values[kept], self, setup.seed, heard) for name, values in results.items()}
        return processes, perf_counter() - start

    def _judged(self, stand_in: StandIn, judge: DesignedSample) -> dict[str, HeldOutComparison]:
        """Compare the surrogate with the model at points it never saw."""
        bands = stand_in.bands(judge.usable) if judge.kept.any() else {}
        return {
            name: HeldOutComparison(judge.rows.results[name][judge.kept], *band, is_share=self.log_result)
            for name, band in bands.items()
        }

    def _ran(self, bench: Bench, box: Box, names: tuple[str, ...], *, stage: int, done: StepProgress) -> DesignedSample:
        """Run the model at designed points; those can be used that have every result, above 0 for a logarithm."""
        setup, batch, executor = bench.setup, self.batch, bench.executor
        points = (self.design, self.held_out)[stage]
        columns = designed(setup, box, stage, points, self.name)
        carried: Setup | Packed = setup if stays_here(executor) else pack(setup)
        answers = []
        for answer in in_order(executor, partial(run_points, carried, names), _parts(columns, points, batch)):
            answers.append(answer)
            done(min(len(answers) * batch, points), points)
        parts = [rows for rows, _ in answers]
        reasons = {i * batch + row: text for i, rows in enumerate(parts) for row, text in rows.reasons.items()}
        results = {name: np.concatenate([rows.results[name] for rows in parts]) for name in names}
        rows = Rows(results, np.concatenate([rows.failed for rows in parts]), reasons)
        kept = ~rows.failed
        for values in rows.results.values():
            kept &= np.isfinite(values) & ((values > 0) if self.log_result else True)
        return DesignedSample(columns, rows, kept, sum(seconds for _, seconds in answers))


def _course(setup: Setup, stand_in: StandIn, along: str) -> Course | None:
    """Follow one input through the box, everything else as in the run."""
    feature = next((feature for feature in stand_in.box.features if feature.name == along), None)
    if feature is None:
        return None
    axis = feature.value(np.linspace(0.0, 1.0, FINE))
    if feature.logarithmic:
        axis = np.linspace(feature.low, feature.high, FINE)
    coarse = axis[::COARSE]
    rows = evaluate_rows(setup, {along: coarse}, len(coarse), wanted=tuple(stand_in.processes))
    return Course(along, axis, coarse, rows.results, stand_in.bands({along: axis}))


@dataclass(frozen=True, eq=False)
class DesignedSample:
    """Designed points (n,) by input, what the model answered, which can be used, and the seconds the model worked."""

    columns: Mapping[str, Any]
    rows: Rows
    kept: NDArray[np.bool_]
    seconds: float

    @property
    def usable(self) -> dict[str, Any]:
        """The points that can be used."""
        return {name: values[self.kept] for name, values in self.columns.items()}

    @property
    def points(self) -> int:
        """How many points were designed."""
        return len(self.kept)

    @property
    def left_out(self) -> int:
        """How many of them were left out because they have no answer."""
        return int((~self.kept).sum())

    @property
    def reason(self) -> str:
        """Why the first of these was."""
        return next(iter(self.rows.reasons.values()), "a result is not above zero")


@dataclass(frozen=True, kw_only=True, eq=False)
class Emulated(Outcome):
    """The surrogate, which answers in place of the model, and what it is worth.

    ``of`` names the results; ``judged[result]`` compares both at points that were held out, ``course`` along one input;
    ``own`` are the model's results at the run's inputs (SI). ``speed`` is measured: it stands on the sheet and in no
    results.json. ``sample`` and ``judges`` count designed points; ``inputs`` are the run's, as effects leave them.
    """

    name: str = "surrogate"
    of: tuple[str, ...]
    stand_in: StandIn
    judged: Mapping[str, HeldOutComparison]
    course: Course | None
    sample: DesignedSample
    judges: DesignedSample
    own: Mapping[str, float]
    units: Mapping[str, str]
    inputs: Any = None
    speed: Speed | None = None

    def predict(self, columns: Mapping[str, Any]) -> dict[str, Matrix]:
        """Return the results (n,) in SI by name; of a logarithm the median.

        ``columns`` are inputs and conditions in SI by name, numbers or arrays (n,); those not named are as in the run.
        Raises UsageError for one that was not varied and differs from the run.
        """
        return self.stand_in.predict(columns)

    def predict_band(self, columns: Mapping[str, Any]) -> dict[str, tuple[Matrix, Matrix]]:
        """Return both ends (n,) of the 95 % band of every result in SI: between them a new run is expected."""
        return {name: (low, high) for name, (_, low, high) in self.stand_in.bands(columns).items()}

    def extrapolated(self, columns: Mapping[str, Any]) -> Any:
        """Say per calculation (n,) whether it lies outside the box: nothing was learnt there."""
        return ~self.stand_in.box.inside(columns).all(axis=1)

    @property
    def passed(self) -> tuple[str, ...]:
        """The directions in which the run itself lies outside the box."""
        box = self.stand_in.box
        return tuple(
            feature.name for feature, inside in zip(box.features, box.inside({})[0], strict=True) if not inside
        )

    def as_json(self) -> dict[str, Any]:
        """Return box, points, accuracy and course in printed units; no times."""
        return {
            "of": list(self.of),
            "box": _box(self),
            "design": {"points": self.sample.points, "left_out": self.sample.left_out},
            "held_out": {"points": self.judges.points, "left_out": self.judges.left_out},
            "results": {name: _result(self, name) for name in self.of},
            "extrapolated": list(self.passed),
            "course": _course_json(self),
        }

    def blocks(self) -> Sequence[Block]:
        """Return accuracy, times and directions, and the figures: over the model's results, and along one input."""
        blocks: list[Block] = []
        if self.speed is not None:
            blocks.append(Words(_verdict(self, self.speed), "finding"))
        if self.judged:
            blocks.append(_accuracy_table(self))
        if self.speed is not None:
            blocks.append(_speed_table(self, self.speed))
        blocks.append(_box_table(self))
        names = list(self.judged)[:MOST_PANELS]
        if names:
            caption = "Points that were held out; beside it how far each is off, with its 95 % band."
            blocks.append(Drawing("Surrogate over model", partial(_agreement, self, names), caption))
        if self.course is not None:
            title = f"Surrogate along the {spoken(self.course.over)}"
            blocks.append(Drawing(title, partial(_along, self, self.course), _said_of_course(self, self.course)))
        return blocks

    def warnings(self) -> Sequence[str]:
        """Say where the surrogate is asked beyond its box, promises too narrow a band, or lacks points."""
        return [f"study '{self.name}': {text}" for text in self._doubts()]

    def _doubts(self) -> Iterator[str]:
        if self.passed:
            named = " and ".join(f"'{name}'" for name in self.passed)
            yield f"the run lies outside the box of the surrogate in {named}: there it is extrapolated"
        for kind, counted in (("designed", self.sample), ("held-out", self.judges)):
            if counted.left_out:
                yield f"{counted.left_out} of {counted.points} {kind} points were left out ({counted.reason})"
        if not self.judged:
            yield "no held-out point has an answer: nothing is known of its accuracy"
        for name, judged in self.judged.items():
            if judged.interval[1] < PROMISED:
                yield (
                    f"the 95 % band of '{name}' holds only {judged.inside} of {judged.points} held-out points: it is "
                    "too narrow; take more designed points or a smaller box"
                )


# How the outcome of a surrogate is written: results.json, which holds no times, and the sheet, which does


MOST_PANELS = 4


def _box(emulated: Emulated) -> dict[str, Any]:
    ranges = {}
    for feature in emulated.stand_in.box.features:
        unit = emulated.units[feature.name]
        ends = {"low": printed(feature.low, unit), "high": printed(feature.high, unit), "unit": unit}
        ranges[feature.name] = {**ends, "logarithmic": feature.logarithmic, "sets": feature.sets}
    return ranges


def _result(emulated: Emulated, name: str) -> dict[str, Any]:
    unit = emulated.units[name]
    stand_in = emulated.stand_in
    features = [feature.name for feature in stand_in.box.features]
    mean, low, high = (float(values[0]) for values in stand_in.bands({})[name])
    entry: dict[str, Any] = {"unit": unit}
    if name in emulated.judged:
        entry |= _accuracy(emulated.judged[name], unit)
    return entry | {
        "lengths": dict(zip(features, stand_in.lengths(name), strict=True)),
        "noise": stand_in.noise(name),
        "at_inputs": {
            "predicted": printed(mean, unit),
            "band95": [printed(low, unit), printed(high, unit)],
            "model": printed(emulated.own[name], unit),
        },
    }


def _accuracy(judged: HeldOutComparison, unit: str) -> dict[str, Any]:
    return {
        "coverage95": judged.coverage,
        "interval95": list(judged.interval),
        "median_error": printed_step(np.median(judged.errors), unit),
        "largest_error": printed_step(judged.errors.max(), unit),
        "median_share": as_number(np.median(judged.shares)),
        "largest_share": as_number(judged.shares.max()),
        "share_of": "value" if judged.is_share else "range",
    }


def _course_json(emulated: Emulated) -> dict[str, Any] | None:
    course = emulated.course
    if course is None:
        return None
    results = {}
    for name in emulated.of:
        unit = emulated.units[name]
        mean, low, high = (printed(values[::COARSE], unit) for values in course.bands[name])
        model = printed(course.simulated[name], unit)
        results[name] = {"unit": unit, "model": model, "predicted": mean, "low": low, "high": high}
    unit = emulated.units[course.over]
    return {"over": course.over, "unit": unit, "at": printed(course.coarse, unit), "results": results}


def _verdict(emulated: Emulated, speed: Speed) -> str:
    """Say which way was faster, and what the faster one loses."""
    model, whole = f"{speed.model:.3g} s", f"{speed.making + speed.predictions:.3g} s"
    lost = ", ".join(
        f"{spoken(name)} by {100 * float(np.median(judged.shares)):.2g} % (median) and "
        f"{100 * float(judged.shares.max()):.2g} % (largest) of its {'value' if judged.is_share else 'range'}"
        for name, judged in emulated.judged.items()
    )
    work = f"For {speed.rows} calculations the model takes {model}, the surrogate {whole}, its making included"
    if speed.pays:
        return f"{work}: the surrogate was faster. It is off in {lost or 'nothing that was measured'}."
    return (
        f"{work}: running the model was faster, and loses nothing. The surrogate is off in {lost or 'nothing known'}."
    )


def _accuracy_table(emulated: Emulated) -> Table:
    rows: list[list[Any]] = []
    for name, judged in emulated.judged.items():
        unit = emulated.units[name]
        accuracy = _accuracy(judged, unit)
        errors = []
        for size in ("median", "largest"):
            share = accuracy[f"{size}_share"]
            errors += [accuracy[f"{size}_error"], None if share is None else 100 * share]
        rows.append([name, unit_text(unit), judged.points, 100 * judged.coverage, *errors])
    whole = "value" if next(iter(emulated.judged.values())).is_share else "range of all values"
    columns = ("result", "unit", "points", "in the 95 % band", "median error", "share", "largest error", "share")
    note = f"At points the surrogate never saw. Percentages of errors are of the {whole}."
    return Table("What the surrogate loses", columns, rows, ("", "", "", "%", "", "%", "", "%"), note)


def _speed_table(emulated: Emulated, speed: Speed) -> Table:
    rows: list[list[Any]] = [
        [f"{emulated.sample.points} runs of the designed sample", speed.sample],
        ["learning from them", speed.fit],
        [f"{speed.rows} answers of the surrogate", speed.predictions],
        [f"{speed.rows} answers of the model", speed.model],
    ]
    even = "The surrogate never pays: the model answers faster than it does."
    if speed.break_even < float("inf"):
        even = f"It pays from about {float(f'{speed.break_even:.2g}'):.0f} calculations on."
    part = ""
    if speed.measured < speed.rows:
        part = f" {speed.measured} of the model's were run, the rest is in proportion."
    note = f"On this machine, in one process. {even}{part}"
    return Table("Surrogate or model: which is faster?", ("work", "time"), rows, ("", "s"), note)


def _box_table(emulated: Emulated) -> Table:
    rows: list[list[Any]] = []
    stand_in = emulated.stand_in
    for index, feature in enumerate(stand_in.box.features):
        unit = emulated.units[feature.name]
        scale = "logarithmic" if feature.logarithmic else "even"
        lengths = [stand_in.lengths(name)[index] for name in emulated.of]
        rows.append(
            [feature.name, printed(feature.low, unit), printed(feature.high, unit), unit_text(unit), scale, *lengths]
        )
    columns = ("direction", "from", "to", "unit", "scale", *(f"length of {spoken(name)}" for name in emulated.of))
    note = "Lengths over the side of the box: over a short one the result turns, over a long one it is straight."
    return Table("Box of the surrogate", columns, rows, (), note)


def _agreement(emulated: Emulated, names: Sequence[str]) -> Figure:
    """Draw predicted over simulated results, and beside it how far each is off with its band."""
    figure = Figure(figsize=(WIDTH, 3.0 * len(names)), layout="constrained")
    panels = figure.subplots(len(names), 2, squeeze=False)
    for pair, name in zip(panels, names, strict=True):
        judged, unit = emulated.judged[name], emulated.units[name]
        model, mean = from_si(judged.simulated, unit), from_si(judged.predicted, unit)
        ends = [float(model.min()), float(model.max())]
        pair[0].plot(model, mean, "o", color=BLUE, markersize=3, label="surrogate")
        pair[0].plot(ends, ends, color=ORANGE, linewidth=0.9, label="model")
        pair[0].set_ylabel(labelled("by the surrogate", unit_text(unit)))
        pair[0].legend(frameon=False)
        # errors in percent of the value, or of the range of all values
        of_band = (judged.predicted, judged.low, judged.high)
        off, low, high = (100 * (values - judged.simulated) / judged.whole for values in of_band)
        bars = np.abs([off - low, high - off])
        pair[1].errorbar(model, off, yerr=bars, fmt="o", color=BLUE, ecolor=GREY, markersize=3, elinewidth=0.8)
        pair[1].axhline(0.0, color=ORANGE, linewidth=0.9)
        pair[1].set_ylabel("off by, %")
        for panel in pair:
            panel.set_xlabel(labelled(f"{name} by the model", unit_text(unit)))
            panel.grid(alpha=0.3)
        if judged.is_share:
            for scale in (pair[0].set_xscale, pair[0].set_yscale, pair[1].set_xscale):
                scale("log")
    return figure


def _along(emulated: Emulated, course: Course) -> Figure:
    """Draw the surrogate with its band along one input, and the model's own points."""
    names, over = emulated.of[:MOST_PANELS], emulated.units[course.over]
    figure = Figure(figsize=(WIDTH, 0.8 + 2.4 * len(names)), layout="constrained")
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for panel, name in zip(panels, names, strict=True):
        unit = emulated.units[name]
        mean, low, high = (from_si(values, unit) for values in course.bands[name])
        axis = from_si(course.axis, over)
        panel.fill_between(axis, low, high, color=BLUE, alpha=0.2, linewidth=0, label="95 % band")
        panel.plot(axis, mean, color=BLUE, label="surrogate")
        simulated = from_si(course.simulated[name], unit)
        panel.plot(from_si(course.coarse, over), simulated, "o", color=ORANGE, markersize=4, label="model")
        panel.set_ylabel(labelled(name, unit_text(unit)))
        panel.legend(frameon=False)
        panel.grid(alpha=0.3)
    panels[-1].set_xlabel(labelled(course.over, unit_text(over)))
    return figure


def _said_of_course(emulated: Emulated, course: Course) -> str:
    counts = {name: course.inside(name) for name in emulated.of}
    held = ", ".join(f"{inside} of {points} of {spoken(name)}" for name, (inside, points) in counts.items())
    others = [f"'{name}'" for name in emulated.passed if name != course.over]
    beyond = f" Outside the box in {' and '.join(others)}: extrapolated." if others else ""
    return f"All else as in the run. Of the model's points the band holds {held}.{beyond}"


# The runs behind a surrogate: designed samples, and how long the model and its stand-in take for the same work


LONGEST = 3.0
"""Seconds after which the model is stopped and its time for the rest is taken from what was run."""


keepable(Rows)


def designed(setup: Setup, box: Box, stage: int, points: int, study: str) -> dict[str, Matrix]:
    """Return a Latin hypercube: every side of the box in as many layers as there are points.

    Stage 0 is learnt from, 1 is held out, 2 is for the clock.
    """
    rng = generator(setup.seed, stage, study)
    return box.sampled(stats.qmc.LatinHypercube(len(box.features), seed=rng).random(points))


def run_points(
    carried: Setup | Packed, wanted: tuple[str, ...], part: tuple[Mapping[str, Any], int]
) -> tuple[Rows, float]:
    """Run the model at some points (their columns, their number), all in one call; return the seconds too."""
    setup = _unpacked(carried) if isinstance(carried, Packed) else carried
    start = perf_counter()
    rows = evaluate_rows(setup, *part, wanted=wanted).complete()
    return rows, perf_counter() - start


@lru_cache(maxsize=4)
def _unpacked(packed: Packed) -> Setup:
    return unpack(packed)


def _parts(columns: Mapping[str, Any], points: int, batch: int) -> Iterator[tuple[dict[str, Any], int]]:
    for start in range(0, points, batch):
        rows = min(batch, points - start)
        yield {name: values[start : start + rows] for name, values in columns.items()}, rows


@dataclass(frozen=True)
class Speed:
    """Seconds on this machine, in one process: for the designed sample, for learning from it, and for ``rows`` answers.

    ``measured`` of the model's ``rows`` were really run; its time for the rest is in proportion.
    """

    rows: int
    sample: float
    fit: float
    predictions: float
    model: float
    measured: int

    @property
    def making(self) -> float:
        """Seconds until the surrogate can answer at all."""
        return self.sample + self.fit

    @property
    def break_even(self) -> float:
        """The number of answers from which on the surrogate is the faster way; infinite where it never is."""
        gain = (self.model - self.predictions) / self.rows
        return self.making / gain if gain > 0 else float("inf")

    @property
    def pays(self) -> bool:
        """Whether making the surrogate and asking it was faster than asking the model."""
        return self.making + self.predictions < self.model


def clocked(
    setup: Setup, stand_in: StandIn, study: Surrogate, making: tuple[float, float], done: StepProgress
) -> Speed:
    """Take the time of all predictions, and of as many runs of the model as there is time for."""
    points, batch = study.compare, study.batch
    columns = designed(setup, stand_in.box, 2, points, study.name)
    start = perf_counter()
    for part, _ in _parts(columns, points, batch):
        stand_in.predict(part)
    predictions = perf_counter() - start
    spent, run, wanted = 0.0, 0, tuple(stand_in.processes)
    for part, rows in _parts(columns, points, batch):
        spent += run_points(setup, wanted, (part, rows))[1]
        run += rows
        done(max(run, round(points * spent / LONGEST)), points)
        if spent > LONGEST:
            break
    return Speed(points, *making, predictions, spent * points / run, run)


# A Gaussian process as a stand-in for the model: what it learnt at some points, it says of all between them


LENGTHS = (1e-2, 1e3)
AMPLITUDES = (1e-3, 1e3)
NOISES = (1e-9, 1.0)  # of the variance learnt: 1e-12 of the largest amplitude, well above rounding
JITTER = 1e-12
ROWS = 2**13


def fitted(places: Matrix, values: Matrix, study: Surrogate, seed: int, done: Callable[[], None]) -> Any:
    """Learn a result (n,) at places (n, d): a process with the lengths, amplitude and noise of greatest likelihood.

    ``done`` hears of every search for them that ends: the first, and each of the restarts.
    """
    shape = gaussian_kernels.RBF(np.ones(places.shape[1]), LENGTHS)
    kernel = gaussian_kernels.ConstantKernel(10.0, AMPLITUDES) * shape + gaussian_kernels.WhiteKernel(1e-6, NOISES)

    def searched(likelihood: Any, start: Any, bounds: Any) -> tuple[Any, float]:
        # as scikit-learn does
        optimum: Any = optimize.minimize(likelihood, start, method="L-BFGS-B", jac=True, bounds=bounds)
        done()
        return optimum.x, optimum.fun

    process = gaussian_process.GaussianProcessRegressor(
        kernel, alpha=JITTER, normalize_y=True, n_restarts_optimizer=study.restarts, random_state=seed % 2**32,
        optimizer=searched,
    )  # fmt: skip
    with one_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore", learning_exceptions.ConvergenceWarning)
        process.fit(places, np.log(values) if study.log_result else values)
    process.set_params(optimizer=None)  # it is fitted, and travels to workers
    return process


# The box of a surrogate: over what it was made, how it is sampled, and what lies outside


STEPS = 3
STRAIGHT_TO = 1e-9


@dataclass(frozen=True)
class Feature:
    """One direction of the box: a formula (often a single name), its range in SI, and the input that is set for it."""

    name: str
    formula: Formula
    sets: str
    low: float
    high: float
    unit: str
    step: float
    logarithmic: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the feature is an input or a condition itself."""
        return self.name == self.sets

    def value(self, shares: Any) -> Any:
        """Return values (SI) from places between 0 and 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** shares
        return self.low + (self.high - self.low) * shares

    def place(self, values: Any) -> Any:
        """Return places, 0 to 1 inside the range; NaN where a logarithm does not exist."""
        if not self.logarithmic:
            return (values - self.low) / (self.high - self.low)
        with np.errstate(all="ignore"):
            return np.where(values > 0, np.log(values / self.low) / np.log(self.high / self.low), np.nan)


@dataclass(frozen=True)
class Box:
    """The features, and the value (SI) that every number has in the run by name of input or condition."""

    features: tuple[Feature, ...]
    held: Mapping[str, float]

    def sampled(self, shares: Matrix) -> dict[str, Matrix]:
        """Return the columns (n,) of a batch from places (n, d), 0 to 1. Raises UsageError for a bent formula."""
        columns: dict[str, Any] = {}
        for index, feature in sorted(enumerate(self.features), key=lambda numbered: not numbered[1].is_plain):
            columns[feature.sets] = self._solved(feature, feature.value(shares[:, index]), columns)
        return columns

    def places(self, columns: Mapping[str, Any]) -> Matrix:
        """Return the places (n, d) of calculations; what no column holds is as in the run.

        Columns are numbers or arrays (n,) in SI. Raises UsageError for one that the surrogate does not follow.
        """
        rows = max((np.size(values) for values in columns.values()), default=1)
        self._demand_known(columns)
        values = {**self.held, **columns}
        places = [feature.place(evaluate(feature.formula, values)) for feature in self.features]
        return np.column_stack([np.broadcast_to(position, (rows,)) for position in places])

    def inside(self, columns: Mapping[str, Any]) -> NDArray[np.bool_]:
        """Say per calculation and direction (n, d) whether it lies in the box; outside nothing was learnt."""
        places = self.places(columns)
        return np.asarray((places >= -STRAIGHT_TO) & (places <= 1 + STRAIGHT_TO))

    def _demand_known(self, columns: Mapping[str, Any]) -> None:
        followed = {name for feature in self.features for name in feature.formula.names}
        for name, values in columns.items():
            if name in followed:
                continue
            if name not in self.held:
                raise UsageError(f"the surrogate knows no '{name}'.{near_miss(name, self.held)}")
            if not np.allclose(values, self.held[name], rtol=1e-12, atol=0.0, equal_nan=True):
                raise UsageError(f"the surrogate was made for one value of '{name}'; name it in over to vary it")

    def _solved(self, feature: Feature, wanted: Any, columns: Mapping[str, Any]) -> Any:
        """Return the values of the input with which a formula takes the values that are wanted."""
        if feature.is_plain:
            return wanted
        values: dict[str, Any] = {**self.held, **columns}
        solution = np.full(np.shape(wanted), self.held[feature.sets])

        def missing(tried: Any) -> Any:
            return wanted - evaluate(feature.formula, {**values, feature.sets: tried})

        for _ in range(STEPS):
            short = missing(solution)
            slope = (short - missing(solution + feature.step)) / feature.step
            with np.errstate(all="ignore"):
                solution = solution + short / slope
        if not np.all(np.abs(missing(solution)) <= STRAIGHT_TO * (feature.high - feature.low)):
            raise UsageError(f"the formula '{feature.name}' is not straight in '{feature.sets}', which follows from it")
        return solution


def open_box(setup: Setup, over: Mapping[str, str], logarithmic: Sequence[str], study: str) -> Box:
    """Read the ranges of the features. Raises UsageError with one sentence for a name or range that cannot be."""
    for name in logarithmic:
        if name not in over:
            raise UsageError(f"study '{study}': '{name}' is logarithmic but not in over.{near_miss(name, over)}")
    held = _held(setup)
    read = {text: _parsed(text, held, setup, study) for text in over}
    plain = {text for text, formula in read.items() if formula.names == {text}}
    features = []
    taken = set(plain)
    for text, formula in read.items():
        sets = text if text in plain else _free(formula, taken, study)
        taken.add(sets)
        low, high, unit = _range(setup, formula, over[text], study)
        if text in logarithmic and low <= 0:
            raise UsageError(f"study '{study}': '{text}' is logarithmic, so its range {over[text]} must lie above 0")
        step = abs(held[sets]) or unit_factor(setup.unit_of(sets))  # one unit where 0 says nothing of its size
        features.append(Feature(text, formula, sets, low, high, unit, step, text in logarithmic))
    return Box(tuple(features), held)


def _held(setup: Setup) -> dict[str, float]:
    """Return the value of every number that may vary in a batch; one left open is NaN."""
    names = [name for name, field in setup.model.input_fields.items() if field.varies]
    values = {name: setup.nominal(name) for name in (*names, *setup.conditions)}
    return {name: float("nan") if value is None else float(value) for name, value in values.items()}


def _parsed(text: str, held: Mapping[str, float], setup: Setup, study: str) -> Formula:
    try:
        formula = parse(text)
    except DeclarationError as error:
        raise UsageError(f"study '{study}': {error}") from error
    if not formula.names or formula.left is not None:
        raise UsageError(f"study '{study}': '{text}' is neither an input, a condition nor a formula in them")
    for name in sorted(formula.names):
        if name not in held:
            raise UsageError(
                f"study '{study}': '{name}' is no number among the inputs of {setup.model.name}.{near_miss(name, held)}"
            )
        input_field = setup.model.input_fields.get(name)
        if input_field is not None and input_field.kind == "whole":
            raise UsageError(f"study '{study}': '{name}' takes whole numbers; a surrogate needs what lies between them")
    return formula


def _free(formula: Formula, taken: set[str], study: str) -> str:
    """Return the one input of a formula that is sampled in no other way."""
    free = sorted(formula.names - taken)
    if len(free) != 1:
        named = " and ".join(free) or "none"
        raise UsageError(
            f"study '{study}': of the formula '{formula.text}' one input must be left to follow, but here it is "
            f"{named}; give the others a range of their own"
        )
    return free[0]


def _range(setup: Setup, formula: Formula, text: str, study: str) -> tuple[float, float, str]:
    """Read "low..high unit"; a formula is printed in the unit of its range."""
    if text.count("..") != 1:
        raise UsageError(f"study '{study}': '{text}' is no range; write \"1000..4500 N*m\"")
    unit = setup.unit_of(formula.text) if formula.names == {formula.text} else _unit_of(setup, formula, text, study)
    low, high = read_range(text, unit, 2)
    if not low < high:
        raise UsageError(f"study '{study}': the range {text} of '{formula.text}' must rise")
    return float(low), float(high), unit


def _unit_of(setup: Setup, formula: Formula, text: str, study: str) -> str:
    """Return the unit in which the range of a formula is written, proven to be one of its own."""
    try:
        unit = split_quantity(text.rpartition("..")[2]).unit
        quantities = {name: pint_quantity(1.0, setup.unit_of(name)) for name in formula.names}
        own = evaluate_quantities(formula, quantities)
        if own.dimensionality != pint_quantity(1.0, unit).dimensionality:
            raise UnitError(f"the range {text} has another dimension than '{formula.text}'")
    except UnitError as error:
        raise UsageError(f"study '{study}': {error}") from error
    return unit


# A surrogate that answers, and what was found of it: at points it never saw, and along one input


@dataclass(frozen=True, eq=False)
class StandIn:
    """The box and what was learnt in it: by result a fitted process over places (n, d) between 0 and 1.

    If ``logarithmic`` it knows logarithms of results. Columns are numbers or arrays (n,) in SI, by input.
    """

    box: Box
    processes: Mapping[str, Any]
    logarithmic: bool

    def predict(self, columns: Mapping[str, Any]) -> dict[str, Matrix]:
        """Return the expected results (n,), SI, of a logarithm the median; NaN where a place is NaN."""
        return {name: self._result(mean) for name, (mean,) in self._asked(columns, with_sd=False).items()}

    def bands(self, columns: Mapping[str, Any]) -> dict[str, tuple[Matrix, Matrix, Matrix]]:
        """Return the expected results (n,) and both ends of their 95 % bands, noise included, SI."""
        return {
            name: (self._result(mean), self._result(mean - Z95 * sd), self._result(mean + Z95 * sd))
            for name, (mean, sd) in self._asked(columns, with_sd=True).items()
        }

    def _asked(self, columns: Mapping[str, Any], *, with_sd: bool) -> dict[str, Matrix]:
        """Ask a part at a time, so that memory stays flat, for means (1, n), or means and deviations (2, n)."""
        places = self.box.places(columns)
        answers = {name: np.full((1 + with_sd, len(places)), np.nan) for name in self.processes}
        usable = np.flatnonzero(np.isfinite(places).all(axis=1))
        with one_thread():
            for start in range(0, len(usable), ROWS):
                rows = usable[start : start + ROWS]
                for name, process in self.processes.items():
                    answers[name][:, rows] = process.predict(places[rows], return_std=with_sd)
        return answers

    def _result(self, values: Matrix) -> Matrix:
        return np.exp(values) if self.logarithmic else values

    def lengths(self, name: str) -> tuple[float, ...]:
        """Return the length of every direction over the side of the box, of a result."""
        return tuple(float(length) for length in np.atleast_1d(self.processes[name].kernel_.k1.k2.length_scale))

    def noise(self, name: str) -> float:
        """Return the standard deviation of the noise over that of the results learnt."""
        return math.sqrt(self.processes[name].kernel_.k2.noise_level)


@dataclass(frozen=True, eq=False)
class HeldOutComparison:
    """A result at points that were held out: the model's value and the surrogate's with its band, (n,) in SI.

    ``is_share`` says that errors are shares of the value; otherwise they are shares of the range of the values.
    """

    simulated: Matrix
    predicted: Matrix
    low: Matrix
    high: Matrix
    is_share: bool

    @property
    def points(self) -> int:
        """How many points were held out and have an answer."""
        return len(self.simulated)

    @property
    def inside(self) -> int:
        """How many of them lie in their band."""
        return int(((self.low <= self.simulated) & (self.simulated <= self.high)).sum())

    @property
    def coverage(self) -> float:
        """The share of points in their band."""
        return self.inside / self.points

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of that share."""
        return wilson(self.inside, self.points)

    @property
    def errors(self) -> Matrix:
        """How far the surrogate is off, without sign, SI."""
        return abs(self.predicted - self.simulated)

    @property
    def whole(self) -> Any:
        """What errors are shares of: the values (n,), or their range."""
        size = abs(self.simulated)
        return size if self.is_share else np.ptp(self.simulated) or size.max() or 1.0

    @property
    def shares(self) -> Matrix:
        """The same as shares of the value, or of the range of all values."""
        return np.asarray(self.errors / self.whole)


@dataclass(frozen=True, eq=False)
class Course:
    """Results along one input, all else as in the run, SI: the surrogate on a fine axis, the model on a coarse one."""

    over: str
    axis: Matrix
    coarse: Matrix
    simulated: Mapping[str, Matrix]
    bands: Mapping[str, tuple[Matrix, Matrix, Matrix]]

    def inside(self, name: str) -> tuple[int, int]:
        """Return how many of the model's points lie in the band, and how many there are."""
        simulated = self.simulated[name]
        low, high = (end[::COARSE] for end in self.bands[name][1:])
        return int(((low <= simulated) & (simulated <= high)).sum()), int(np.isfinite(simulated).sum())
