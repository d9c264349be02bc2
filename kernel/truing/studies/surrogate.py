"""What would the model say, asked thousands of times? A Gaussian process learnt from a designed sample of its runs.

The model is vectorised, so a stand-in has to earn its place: the sheet says how long each takes for the same work, and
what the stand-in loses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import count, pairwise
from time import perf_counter
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from truing.arrays import Matrix
from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.evaluate import Rows, acting_inputs, evaluate_rows
from truing.executors import SerialExecutor, in_order, keepable
from truing.heavy import gaussian_process, stats
from truing.packed import Packed, pack, unpack
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome, StepProgress
from truing.studies.demands import as_number
from truing.studies.drawings import BLUE, GREY, ORANGE, WIDTH, labelled
from truing.studies.reading import printed, printed_step, result_names, scalar_results, spoken
from truing.studies.scatter import generator
from truing.studies.surrogate_fit import (
    Box,
    Course,
    Emulator,
    HeldOutComparison,
    StandIn,
    fitted,
    open_box,
    taken,
    usable,
)
from truing.units import from_si, unit_text

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
        names = self._results(setup)
        box = open_box(setup, self.over, self.logarithmic, self.name)
        along = self._along(box)
        sampling, judging, learning, timing = (bench.part(self.name, *ends) for ends in pairwise(SHARES))
        learnt, judge = (
            ran(setup, designed(setup, box, stage, points, self.name), names, Work(self.batch, bench.executor, done))
            for stage, (points, done) in enumerate(((self.design, sampling), (self.held_out, judging)))
        )
        emulators, seconds = self._learnt(setup, box, learnt, names=names, done=learning)
        stand_in = StandIn(box, emulators)
        judged = self._judged(stand_in, judge)
        course = self._course(setup, stand_in, along)
        speed = self._speed(setup, stand_in, learnt.seconds, seconds, done=timing)
        return Emulated(
            name=self.name,
            of=names,
            stand_in=stand_in,
            judged=judged,
            course=course,
            sample=_counted(learnt, names, self.log_result),
            judges=_counted(judge, names, self.log_result),
            own={name: float(bench.answers[name]) for name in names},
            units={name: setup.print_unit(name) for name in names} | _printed_units(setup, box),
            inputs=acting_inputs(setup),
            speed=speed,
        )

    def _results(self, setup: Setup) -> tuple[str, ...]:
        named = (self.of,) if isinstance(self.of, str) else tuple(dict.fromkeys(self.of))
        scalar = scalar_results(setup)
        for name in result_names(setup, named, self.name):
            if name not in scalar:
                raise UsageError(f"study '{self.name}': '{name}' runs along an axis; name a result that is one number")
        return named

    def _along(self, box: Box) -> str:
        plain = [item.name for item in box.features if item.is_plain]
        if self.along and self.along not in plain:
            raise UsageError(
                f"study '{self.name}': along = '{self.along}' is no input in over.{near_miss(self.along, plain)}"
            )
        return self.along or next(iter(plain), "")

    def _learnt(
        self, setup: Setup, box: Box, learnt: Ran, *, names: tuple[str, ...], done: StepProgress
    ) -> tuple[dict[str, Emulator], float]:
        """Fit every result; the clock does not count the import of scikit-learn."""
        kept = usable(learnt.rows, names, logarithmic=self.log_result)
        if kept.sum() < 2 * (len(box.features) + 1):
            reason = next(iter(learnt.rows.reasons.values()), "no result there is above zero")
            raise UsageError(
                f"study '{self.name}': only {int(kept.sum())} of {self.design} points have an answer to learn from "
                f"({reason}); make the ranges in over narrower"
            )
        assert gaussian_process.GaussianProcessRegressor  # imported before the clock starts
        start = perf_counter()
        places = box.places(taken(learnt.columns, kept))
        fits = count(1)
        emulators = {
            name: fitted(
                places,
                learnt.rows.results[name][kept],
                logarithmic=self.log_result,
                restarts=self.restarts,
                seed=setup.seed,
                done=lambda: done(next(fits), len(names) * (self.restarts + 1)),
            )
            for name in names
        }
        return emulators, perf_counter() - start

    def _judged(self, stand_in: StandIn, judge: Ran) -> dict[str, HeldOutComparison]:
        """Compare the surrogate with the model at points it never saw."""
        kept = usable(judge.rows, tuple(stand_in.emulators), logarithmic=self.log_result)
        bands = stand_in.bands(taken(judge.columns, kept)) if kept.any() else {}
        return {
            name: HeldOutComparison(judge.rows.results[name][kept], *band, is_share=self.log_result)
            for name, band in bands.items()
        }

    def _course(self, setup: Setup, stand_in: StandIn, along: str) -> Course | None:
        """Follow one input through the box, everything else as in the run."""
        feature = next((item for item in stand_in.box.features if item.name == along), None)
        if feature is None:
            return None
        axis = feature.value(np.linspace(0.0, 1.0, FINE))
        if feature.logarithmic:
            axis = np.linspace(feature.low, feature.high, FINE)
        coarse = axis[::COARSE]
        rows = evaluate_rows(setup, {along: coarse}, len(coarse), wanted=tuple(stand_in.emulators))
        return Course(along, axis, coarse, rows.results, stand_in.bands({along: axis}), COARSE)

    def _speed(self, setup: Setup, stand_in: StandIn, sample: float, fit: float, *, done: StepProgress) -> Speed | None:
        if not self.compare:
            return None
        columns = designed(setup, stand_in.box, 2, self.compare, self.name)
        names = tuple(stand_in.emulators)
        predictions, model, measured = clocked(setup, columns, stand_in.predict, names, batch=self.batch, done=done)
        return Speed(self.compare, sample, fit, predictions, model, measured)


def _counted(points: Ran, names: tuple[str, ...], logarithmic: bool) -> Counted:
    """Count the points that were left out, with the first reason."""
    kept = usable(points.rows, names, logarithmic=logarithmic)
    missing = int((~kept).sum())
    reason = next(iter(points.rows.reasons.values()), "a result is not above zero") if missing else ""
    return Counted(len(kept), missing, reason)


def _printed_units(setup: Setup, box: Box) -> dict[str, str]:
    return {item.name: setup.print_unit(item.name) if item.is_plain else item.unit for item in box.features}


@dataclass(frozen=True)
class Counted:
    """Points of a designed sample, how many were left out because they have no answer, and why the first was."""

    points: int
    left_out: int
    reason: str = ""


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
    sample: Counted
    judges: Counted
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
        return self.stand_in.box.outside(columns)

    @property
    def passed(self) -> tuple[str, ...]:
        """The directions in which the run itself lies outside the box."""
        return self.stand_in.box.passed()

    def as_json(self) -> dict[str, Any]:
        """Return box, points, accuracy and course in printed units; no times."""
        return {
            "of": list(self.of),
            "box": _box(self),
            "design": _points(self.sample),
            "held_out": _points(self.judges),
            "results": {name: _result(self, name) for name in self.of},
            "extrapolated": list(self.passed),
            "course": _course(self),
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
            blocks.append(Drawing("Surrogate over model", _agreement(self, names), caption))
        if self.course is not None:
            title = f"Surrogate along the {spoken(self.course.over)}"
            blocks.append(Drawing(title, _along(self, list(self.of)[:MOST_PANELS]), _said_of_course(self)))
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
    found = {}
    for item in emulated.stand_in.box.features:
        unit = emulated.units[item.name]
        ends = {"low": printed(item.low, unit), "high": printed(item.high, unit), "unit": unit}
        found[item.name] = {**ends, "logarithmic": item.logarithmic, "sets": item.sets}
    return found


def _points(counted: Counted) -> dict[str, int]:
    return {"points": counted.points, "left_out": counted.left_out}


def _result(emulated: Emulated, name: str) -> dict[str, Any]:
    unit = emulated.units[name]
    emulator = emulated.stand_in.emulators[name]
    features = [item.name for item in emulated.stand_in.box.features]
    mean, low, high = (float(values[0]) for values in emulated.stand_in.bands({})[name])
    entry: dict[str, Any] = {"unit": unit}
    if name in emulated.judged:
        entry |= _accuracy(emulated.judged[name], unit)
    return entry | {
        "lengths": dict(zip(features, emulator.lengths, strict=True)),
        "noise": emulator.noise,
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


def _course(emulated: Emulated) -> dict[str, Any] | None:
    course = emulated.course
    if course is None:
        return None
    results = {}
    for name in emulated.of:
        unit = emulated.units[name]
        mean, low, high = (printed(values[:: course.every], unit) for values in course.bands[name])
        model = printed(course.simulated[name], unit)
        results[name] = {"unit": unit, "model": model, "predicted": mean, "low": low, "high": high}
    unit = emulated.units[course.over]
    return {"over": course.over, "unit": unit, "at": printed(course.coarse, unit), "results": results}


def _verdict(emulated: Emulated, speed: Speed) -> str:
    """Say which way was faster, and what the faster one loses."""
    model, whole = _seconds(speed.model), _seconds(speed.making + speed.predictions)
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


def _seconds(value: float) -> str:
    return f"{value:.3g} s"


def _accuracy_table(emulated: Emulated) -> Table:
    rows: list[list[Any]] = []
    for name, judged in emulated.judged.items():
        unit = emulated.units[name]
        found = _accuracy(judged, unit)
        shares = [100 * found[key] if found[key] is not None else None for key in ("median_share", "largest_share")]
        errors = [found["median_error"], shares[0], found["largest_error"], shares[1]]
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
    never = "The surrogate never pays: the model answers faster than it does."
    even = (
        never
        if speed.break_even == float("inf")
        else f"It pays from about {float(f'{speed.break_even:.2g}'):.0f} calculations on."
    )
    part = (
        f" {speed.measured} of the model's were run, the rest is in proportion." if speed.measured < speed.rows else ""
    )
    note = f"On this machine, in one process. {even}{part}"
    return Table("Surrogate or model: which is faster?", ("work", "time"), rows, ("", "s"), note)


def _box_table(emulated: Emulated) -> Table:
    rows: list[list[Any]] = []
    emulators = emulated.stand_in.emulators
    for index, item in enumerate(emulated.stand_in.box.features):
        unit = emulated.units[item.name]
        scale = "logarithmic" if item.logarithmic else "even"
        lengths = [emulator.lengths[index] for emulator in emulators.values()]
        rows.append([item.name, printed(item.low, unit), printed(item.high, unit), unit_text(unit), scale, *lengths])
    columns = ("direction", "from", "to", "unit", "scale", *(f"length of {spoken(name)}" for name in emulators))
    note = "Lengths over the side of the box: over a short one the result turns, over a long one it is straight."
    return Table("Box of the surrogate", columns, rows, (), note)


def _agreement(emulated: Emulated, names: Sequence[str]) -> Callable[[], Figure]:
    """Draw predicted over simulated results, and beside it how far each is off with its band."""

    def draw() -> Figure:
        figure = Figure(figsize=(WIDTH, 3.0 * len(names)), layout="constrained")
        panels = figure.subplots(len(names), 2, squeeze=False)
        for (left, right), name in zip(panels, names, strict=True):
            _draw_values(left, emulated.judged[name], name, emulated.units[name])
            _draw_errors(right, emulated.judged[name], name, emulated.units[name])
        return figure

    return draw


def _draw_values(panel: Any, judged: HeldOutComparison, name: str, unit: str) -> None:
    model, mean = from_si(judged.simulated, unit), from_si(judged.predicted, unit)
    panel.plot(model, mean, "o", color=BLUE, markersize=3, label="surrogate")
    ends = [float(model.min()), float(model.max())]
    panel.plot(ends, ends, color=ORANGE, linewidth=0.9, label="model")
    panel.set_ylabel(labelled("by the surrogate", unit_text(unit)))
    if judged.is_share:
        panel.set_yscale("log")
    _finish(panel, judged, labelled(f"{name} by the model", unit_text(unit)))
    panel.legend(frameon=False)


def _draw_errors(panel: Any, judged: HeldOutComparison, name: str, unit: str) -> None:
    """Draw errors in percent of the value, or of the range of all values."""
    ends = (judged.predicted, judged.low, judged.high)
    off, low, high = (100 * (values - judged.simulated) / judged.whole for values in ends)
    bars = np.abs([off - low, high - off])
    panel.errorbar(
        from_si(judged.simulated, unit), off, yerr=bars, fmt="o", color=BLUE, ecolor=GREY, markersize=3, elinewidth=0.8
    )
    panel.axhline(0.0, color=ORANGE, linewidth=0.9)
    panel.set_ylabel("off by, %")
    _finish(panel, judged, labelled(f"{name} by the model", unit_text(unit)))


def _finish(panel: Any, judged: HeldOutComparison, label: str) -> None:
    if judged.is_share:
        panel.set_xscale("log")
    panel.set_xlabel(label)
    panel.grid(alpha=0.3)


def _along(emulated: Emulated, names: Sequence[str]) -> Callable[[], Figure]:
    """Draw the surrogate with its band along one input, and the model's own points."""

    def draw() -> Figure:
        course = emulated.course
        assert course is not None  # drawn only where there is one
        over = emulated.units[course.over]
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

    return draw


def _said_of_course(emulated: Emulated) -> str:
    course = emulated.course
    assert course is not None  # drawn only where there is one
    counts: Mapping[str, tuple[int, int]] = {name: course.inside(name) for name in emulated.of}
    held = ", ".join(f"{inside} of {points} of {spoken(name)}" for name, (inside, points) in counts.items())
    others = [f"'{name}'" for name in emulated.passed if name != course.over]
    beyond = f" Outside the box in {' and '.join(others)}: extrapolated." if others else ""
    return f"All else as in the run. Of the model's points the band holds {held}.{beyond}"


# The runs behind a surrogate: designed samples, and how long the model and its stand-in take for the same work


LONGEST = 3.0
"""Seconds after which the model is stopped and its time for the rest is taken from what was run."""


keepable(Rows)


@dataclass(frozen=True)
class SurrogateBatch:
    """Some points, as they go to a worker: plain data, except in this process."""

    setup: Setup | Packed
    columns: Mapping[str, Any]
    rows: int
    wanted: tuple[str, ...]


@dataclass(frozen=True)
class Ran:
    """Designed points (n,) by input, what the model answered, and the seconds it worked."""

    columns: Mapping[str, Any]
    rows: Rows
    seconds: float


def latin(box: Box, points: int, rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a Latin hypercube: every side of the box in as many layers as there are points."""
    return box.sampled(stats.qmc.LatinHypercube(len(box.features), seed=rng).random(points))


def designed(setup: Setup, box: Box, stage: int, points: int, study: str) -> dict[str, NDArray[np.float64]]:
    """Return the columns of one stage of a study: 0 is learnt from, 1 is held out, 2 is for the clock."""
    return latin(box, points, generator(setup.seed, stage, study))


def run_points(job: SurrogateBatch) -> tuple[Rows, float]:
    """Run the model at some points, all in one call; return the seconds too."""
    setup = _unpacked(job.setup) if isinstance(job.setup, Packed) else job.setup
    start = perf_counter()
    rows = evaluate_rows(setup, job.columns, job.rows, wanted=job.wanted).complete()
    return rows, perf_counter() - start


@lru_cache(maxsize=4)
def _unpacked(packed: Packed) -> Setup:
    return unpack(packed)


@dataclass(frozen=True)
class Work:
    """How points are run: so many in one call, where, and who hears how far it has come."""

    batch: int
    executor: Executor
    done: StepProgress


def ran(setup: Setup, columns: Mapping[str, Any], wanted: tuple[str, ...], work: Work) -> Ran:
    """Run the model at all points."""
    carried: Setup | Packed = setup if isinstance(work.executor, SerialExecutor) else pack(setup)
    points = len(next(iter(columns.values())))
    jobs = (SurrogateBatch(carried, part, rows, wanted) for part, rows in _parts(columns, points, work.batch))
    answers = []
    for answer in in_order(work.executor, run_points, jobs):
        answers.append(answer)
        work.done(min(len(answers) * work.batch, points), points)
    parts = [rows for rows, _ in answers]
    reasons = {index * work.batch + row: text for index, rows in enumerate(parts) for row, text in rows.reasons.items()}
    results = {name: np.concatenate([rows.results[name] for rows in parts]) for name in wanted}
    joined = Rows(results, np.concatenate([rows.failed for rows in parts]), reasons)
    return Ran(columns, joined, sum(seconds for _, seconds in answers))


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
    setup: Setup,
    columns: Mapping[str, Any],
    predict: Callable[[Mapping[str, Any]], Any],
    wanted: tuple[str, ...],
    *,
    batch: int,
    done: StepProgress = lambda step, steps: None,
) -> tuple[float, float, int]:
    """Return the seconds for all predictions, those for all runs of the model, and how many were really run."""
    points = len(next(iter(columns.values())))
    start = perf_counter()
    for part, _ in _parts(columns, points, batch):
        predict(part)
    predictions = perf_counter() - start
    spent, run = 0.0, 0
    for part, rows in _parts(columns, points, batch):
        spent += run_points(SurrogateBatch(setup, part, rows, wanted))[1]
        run += rows
        done(max(run, round(points * spent / LONGEST)), points)
        if spent > LONGEST:
            break
    return predictions, spent * points / run, run
