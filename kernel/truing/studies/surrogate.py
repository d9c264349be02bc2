"""What would the model say, asked thousands of times? A Gaussian process learnt from a designed sample of its runs.

The model is vectorised, so a stand-in has to earn its place: the sheet says how long each takes for the same work, and
what the stand-in loses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count, pairwise
from time import perf_counter
from typing import TYPE_CHECKING, Any

from truing.declare.blocks import Block
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.evaluate import acting_inputs, evaluate_rows
from truing.setup import Setup
from truing.studies.bench import Bench, Check, Done
from truing.studies.reading import result_names, scalar_results
from truing.studies.surrogate_answers import Course, Judged, StandIn
from truing.studies.surrogate_box import Box, open_box
from truing.studies.surrogate_fit import Emulator, fitted, taken, usable
from truing.studies.surrogate_runs import Ran, Speed, Work, clocked, designed, ran

if TYPE_CHECKING:
    from truing.studies.surrogate_answers import Values

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
        self, setup: Setup, box: Box, learnt: Ran, *, names: tuple[str, ...], done: Done
    ) -> tuple[dict[str, Emulator], float]:
        """Fit every result; the clock does not count the import of scikit-learn."""
        import sklearn.gaussian_process  # noqa: F401

        kept = usable(learnt.rows, names, logarithmic=self.log_result)
        if kept.sum() < 2 * (len(box.features) + 1):
            reason = next(iter(learnt.rows.reasons.values()), "no result there is above zero")
            raise UsageError(
                f"study '{self.name}': only {int(kept.sum())} of {self.design} points have an answer to learn from "
                f"({reason}); make the ranges in over narrower"
            )
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

    def _judged(self, stand_in: StandIn, judge: Ran) -> dict[str, Judged]:
        """Compare the surrogate with the model at points it never saw."""
        kept = usable(judge.rows, tuple(stand_in.emulators), logarithmic=self.log_result)
        bands = stand_in.bands(taken(judge.columns, kept)) if kept.any() else {}
        return {
            name: Judged(judge.rows.results[name][kept], *band, is_share=self.log_result)
            for name, band in bands.items()
        }

    def _course(self, setup: Setup, stand_in: StandIn, along: str) -> Course | None:
        """Follow one input through the box, everything else as in the run."""
        import numpy as np

        feature = next((item for item in stand_in.box.features if item.name == along), None)
        if feature is None:
            return None
        axis = feature.value(np.linspace(0.0, 1.0, FINE))
        if feature.logarithmic:
            axis = np.linspace(feature.low, feature.high, FINE)
        coarse = axis[::COARSE]
        rows = evaluate_rows(setup, {along: coarse}, len(coarse), wanted=tuple(stand_in.emulators))
        return Course(along, axis, coarse, rows.results, stand_in.bands({along: axis}), COARSE)

    def _speed(self, setup: Setup, stand_in: StandIn, sample: float, fit: float, *, done: Done) -> Speed | None:
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
class Emulated:
    """The surrogate, which answers in place of the model, and what it is worth.

    ``of`` names the results; ``judged[result]`` compares both at points that were held out, ``course`` along one input;
    ``own`` are the model's results at the run's inputs (SI). ``speed`` is measured: it stands on the sheet and in no
    results.json. ``sample`` and ``judges`` count designed points; ``inputs`` are the run's, as effects leave them.
    """

    name: str = "surrogate"
    of: tuple[str, ...]
    stand_in: StandIn
    judged: Mapping[str, Judged]
    course: Course | None
    sample: Counted
    judges: Counted
    own: Mapping[str, float]
    units: Mapping[str, str]
    inputs: Any = None
    speed: Speed | None = None

    def predict(self, columns: Mapping[str, Any]) -> dict[str, Values]:
        """Return the results (n,) in SI by name; of a logarithm the median.

        ``columns`` are inputs and conditions in SI by name, numbers or arrays (n,); those not named are as in the run.
        Raises UsageError for one that was not varied and differs from the run.
        """
        return self.stand_in.predict(columns)

    def predict_band(self, columns: Mapping[str, Any]) -> dict[str, tuple[Values, Values]]:
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
        from truing.studies.surrogate_printed import emulated_json

        return emulated_json(self)

    def blocks(self) -> Sequence[Block]:
        """Return accuracy, times and directions, and the figures: over the model's results, and along one input."""
        from truing.studies.surrogate_printed import emulated_blocks

        return emulated_blocks(self)

    def checks(self) -> Sequence[Check]:
        """Return nothing: a surrogate decides no limit."""
        return ()

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
