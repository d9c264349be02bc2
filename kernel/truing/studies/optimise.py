"""Which design do I want? Variables, objectives and limits as the model declares them, and the front between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from truing.declare.blocks import Block, Cell, Drawing, Table, Words
from truing.errors import InfeasibleError, UsageError
from truing.evaluate import acting_inputs, evaluate
from truing.fits import GRADES
from truing.prices import price_answers
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome
from truing.studies.demands import Demand, as_number, demands, worst
from truing.studies.drawings import BLUE, GREY, ORANGE, WIDTH, labelled
from truing.studies.optimise_problem import (
    Aim,
    Answers,
    Bound,
    Brief,
    ModelSubstitute,
    Problem,
    Variable,
    answered,
    answers_of,
    constants,
    left_out,
    make_problem,
)
from truing.studies.optimise_search import (
    REFERENCE,
    SETTLED,
    SearchPlan,
    Trail,
    Volume,
    knee_of,
    search,
    small,
    violation,
    volume_of,
)
from truing.studies.reading import printed, spoken
from truing.studies.sampling import Machines, SampleBudget, Tally, sample, scatter_of
from truing.units import unit_text

ALGORITHMS = ("nsga2",)
CHANCES = ("draws", "first_order")
FOUND = "found"


@dataclass(frozen=True, kw_only=True)
class Optimise:
    """Look for the designs that no other beats: every Minimise and Maximise, under every Require.

    Chosen are the inputs of every ``Vary`` and the width of every tolerance with a price, from ``tightest`` to
    ``widest`` times what it is now (a grade from ``finest`` on). A probability is found with the same machines for
    every design, or to first order. The knee of the front is verified by ``verify`` machines on the exact model.
    """

    vary: tuple[str, ...] = ()
    population: int = 100
    generations: int = 100
    algorithm: Literal["nsga2"] = "nsga2"
    tightest: float = 1.0
    widest: float = 2.0
    finest: str = "IT5"
    chance: Literal["draws", "first_order"] = "draws"
    draws: int = 4096
    surrogate: bool = False
    verify: int = 100_000
    batch: int = 2**14
    parts: int = 1
    name: str = "optimise"
    gives: Callable[[Optimum], Any] | None = None

    def __post_init__(self) -> None:
        if self.algorithm not in ALGORITHMS:
            raise UsageError(f"the algorithm '{self.algorithm}' is unknown; there is {', '.join(ALGORITHMS)}")
        if self.chance not in CHANCES:
            raise UsageError(f"chance takes {' or '.join(CHANCES)}, not '{self.chance}'")
        if not 4 <= self.population <= 10_000:
            raise UsageError(f"population = {self.population}, but a population has 4 to 10000 designs")
        if not 1 <= self.generations <= 100_000:
            raise UsageError(f"generations = {self.generations}, but a search has 1 to 100000 generations")
        if not 0 < self.tightest < self.widest:
            raise UsageError(
                f"tightest = {self.tightest:g} and widest = {self.widest:g}, but widths run from a smaller factor "
                "above 0 to a larger one"
            )
        if self.finest not in GRADES:
            raise UsageError(f"'{self.finest}' is no tolerance grade; write IT1 to IT18")
        if min(self.draws, self.verify, self.batch, self.parts) < 1:
            raise UsageError("draws, verify, batch and parts are at least 1")

    def run(self, bench: Bench) -> Optimum:
        """Search, and verify the knee. Raises UsageError without a variable or an objective."""
        setup = bench.setup
        problem = make_problem(setup, self._brief(bench))
        if self.surrogate:
            problem = replace(problem, stand_in=_stand_in(bench, self.name))
        plan = SearchPlan(self.population, self.generations, setup.seed)
        done = bench.part(self.name, 0.0, self.generations / (self.generations + 1))
        trail = search(problem, plan, lambda designs: answered(problem, designs, bench.executor), done)
        optimum = _optimum(self, problem, trail)
        return optimum if optimum.knee_place is None else self._verified(bench, problem, optimum, trail)

    def _brief(self, bench: Bench) -> Brief:
        return Brief(
            study=self.name,
            vary=tuple(self.vary),
            tightest=self.tightest,
            widest=self.widest,
            finest=self.finest,
            chance=self.chance,
            draws=self.draws,
            parts=self.parts,
            known=constants(bench.setup, bench.answers),
        )

    def _verified(self, bench: Bench, problem: Problem, optimum: Optimum, trail: Trail) -> Optimum:
        """Run the knee as an inputs file would state it, and draw machines of it."""
        knee = optimum.knee_place
        assert knee is not None  # run has asked
        setup = problem.space.setup_of(_sorted(problem, trail)[0][knee])
        try:
            answers = {**dict(problem.brief.known), **setup.model.read_results(evaluate(setup)), **price_answers(setup)}
        except InfeasibleError as error:
            remark = f"the model itself has no answer at the knee ({error})"
            return replace(optimum, remarks=(*optimum.remarks, remark))
        exact = {aim.name: float(answers.get(aim.name, _input(setup, aim.name))) for aim in problem.aims}
        wanted = demands(setup, answers, with_goal=True)
        tally = None
        if wanted:
            done = bench.part(self.name, self.generations / (self.generations + 1), 1.0)
            budget = SampleBudget(self.verify, self.batch, bench.executor, done)
            tally = sample(Machines(setup, scatter_of(setup)), wanted, answers, budget)
        return replace(optimum, exact=exact, demands=tuple(wanted), tally=tally)


def _stand_in(bench: Bench, study: str) -> ModelSubstitute:
    """Return the outcome of the surrogate study that ran before."""
    for outcome in bench.outcomes.values():
        if isinstance(outcome, ModelSubstitute):
            return outcome
    raise UsageError(f"study '{study}': surrogate = true, but no Surrogate ran before it; list it first in run = [...]")


def _input(setup: Setup, name: str) -> float:
    return float(setup.nominal(name)) if name in setup.model.input_fields else float("nan")


def _sorted(problem: Problem, trail: Trail) -> tuple[NDArray[np.float64], Answers]:
    """Return designs and answers in the order of the first objective, then of the others."""
    values = trail.answers.objectives * np.array([aim.sign for aim in problem.aims])
    order = np.lexsort(values.T[::-1])
    return trail.designs[order], trail.answers[order]


def _optimum(study: Optimise, problem: Problem, trail: Trail) -> Optimum:
    designs, answers = _sorted(problem, trail)
    feasible = bool(answers.feasible.all())
    start = problem.space.start[None, :]
    knee, distance = knee_of(small(problem, answers)) if feasible else (None, 0.0)
    return Optimum(
        study=study,
        problem=problem,
        front=tuple(_designs(problem, designs, answers)) if feasible else (),
        start=_designs(problem, start, answers_of(problem, start, as_stated=True), as_stated=True)[0],
        knee_place=knee,
        distance=distance,
        status=FOUND if feasible else _nothing(problem, trail),
        volume=volume_of(trail.fronts, exhausted=len(trail.fronts) < study.generations) if feasible else None,
        evaluations=trail.evaluations,
        failed=trail.failed,
        remarks=(*left_out(problem.setup), *_too_few(problem), *_beyond(problem, designs)),
        inputs=acting_inputs(problem.setup),
    )


def _nothing(problem: Problem, trail: Trail) -> str:
    """Say that no design keeps every limit, and which limit the nearest one misses most."""
    counted = f"no design among {trail.evaluations} keeps every limit"
    nearest = int(np.argmin(violation(trail.answers)))
    if trail.answers.failed[nearest]:
        return f"{counted}: none has an answer"
    margins = trail.answers.margins[nearest]
    worst = int(np.argmin(margins))
    return f"{counted}; the nearest misses '{problem.bounds[worst].name}' by a margin of {margins[worst]:.3g}"


def _too_few(problem: Problem) -> tuple[str, ...]:
    """Name the goals that so few machines cannot tell from certainty."""
    if problem.cloud is None:
        return ()
    words = []
    for bound in problem.by_chance:
        goal = bound.require.reliability
        goal = float(problem.setup.nominal(goal)) if isinstance(goal, str) else goal
        if goal is not None and problem.cloud.draws * (1 - goal) < 1:
            words.append(f"{problem.cloud.draws} machines cannot tell {goal:g} of '{bound.name}' from certainty")
    return tuple(words)


def _beyond(problem: Problem, designs: NDArray[np.float64]) -> tuple[str, ...]:
    """Say how many designs of the front lie where the surrogate learnt nothing."""
    outside = getattr(problem.stand_in, "extrapolated", None)
    count = int(np.sum(outside(problem.space.columns(designs)))) if outside is not None else 0
    return (f"{count} of {len(designs)} designs of the front lie outside the surrogate's box",) if count else ()


@dataclass(frozen=True, kw_only=True)
class DesignPoint:
    """One design: ``inputs`` in SI, ``tolerances`` as full widths in SI or grades, and what it is worth.

    ``objectives`` are in SI, ``margins`` of every limit above 0 safe, ``chances`` by check; NaN where it has no answer.
    """

    inputs: Mapping[str, float]
    tolerances: Mapping[str, float | str]
    objectives: Mapping[str, float]
    margins: Mapping[str, float]
    chances: Mapping[str, float]
    feasible: bool


def _designs(
    problem: Problem, designs: NDArray[np.float64], answers: Answers, *, as_stated: bool = False
) -> list[DesignPoint]:
    """Return the designs (m, v) by name."""
    columns = problem.space.columns(designs, as_stated=as_stated)
    choices = problem.space.choices(designs)
    by_chance = problem.by_chance
    return [
        DesignPoint(
            inputs={name: float(values[row]) for name, values in columns.items()},
            tolerances={
                name: GRADES[round(values[row])] if variable.kind == "grade" else float(values[row])
                for name, (variable, values) in choices.items()
            },
            objectives={aim.name: float(answers.objectives[row, i]) for i, aim in enumerate(problem.aims)},
            margins={bound.name: float(answers.margins[row, i]) for i, bound in enumerate(problem.bounds)},
            chances={bound.name: float(answers.chances[row, i]) for i, bound in enumerate(by_chance)},
            feasible=bool(answers.feasible[row]),
        )
        for row in range(len(designs))
    ]


@dataclass(frozen=True, kw_only=True)
class Optimum(Outcome):
    """The designs that no other beats, in the order of the first objective, and the knee among them.

    ``start`` is the design that the inputs file states. Without any feasible design ``front`` is empty, ``knee`` None
    and ``status`` says why. ``exact`` holds the knee's objectives (SI) by the model itself, ``verified`` the share of
    machines of it that meet each goal, ``volume`` the hypervolume of every generation. ``inputs`` are the run's.
    """

    study: Optimise
    problem: Problem = field(repr=False)
    front: tuple[DesignPoint, ...]
    start: DesignPoint
    knee_place: int | None
    distance: float
    status: str
    volume: Volume | None
    evaluations: int
    failed: int = 0
    exact: Mapping[str, float] = field(default_factory=dict)
    demands: tuple[Demand, ...] = ()
    tally: Tally | None = None
    remarks: tuple[str, ...] = ()
    inputs: Any = None

    @property
    def name(self) -> str:
        """The name of the study."""
        return self.study.name

    @property
    def knee(self) -> DesignPoint | None:
        """The design farthest from the chord of the normalised front; with one objective the best."""
        return None if self.knee_place is None else self.front[self.knee_place]

    @property
    def variables(self) -> tuple[Variable, ...]:
        """What was chosen, between which ends."""
        return self.problem.space.variables

    @property
    def aims(self) -> tuple[Aim, ...]:
        """What should be small or large."""
        return self.problem.aims

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """The limits that every design of the front keeps."""
        return self.problem.bounds

    @property
    def verified(self) -> dict[str, float]:
        """The share of drawn machines of the knee that meets each goal."""
        return {} if self.tally is None else {name: worst(share) for name, share in self.tally.shares.items()}

    @property
    def interval(self) -> dict[str, tuple[float, float]]:
        """Wilson's 95 % interval of each of these shares."""
        tally = self.tally
        return (
            {} if tally is None else {name: (worst(low), worst(high)) for name, (low, high) in tally.intervals.items()}
        )

    def as_json(self) -> dict[str, Any]:
        """Return front, knee, start, hypervolume and status in printed units."""
        study = self.study
        entry: dict[str, Any] = {
            "status": self.status,
            "variables": {variable.key: _variable_json(variable) for variable in self.variables},
            "objectives": {aim.name: {"sense": aim.sense, "unit": aim.unit} for aim in self.aims},
            "start": _design_json(self, self.start),
            "front": [_design_json(self, design) for design in self.front],
            "evaluations": self.evaluations,
            "failed": self.failed,
            "algorithm": study.algorithm,
            "population": study.population,
            "generations": study.generations,
            "chance": study.chance,
            "draws": study.draws if self.problem.cloud is not None else None,
            "surrogate": study.surrogate,
        }
        if self.knee is not None:
            entry["knee"] = _knee_json(self, self.knee)
        if self.volume is not None:
            volume = self.volume
            entry["hypervolume"] = {
                "reference": REFERENCE,
                "ideal": _by_aim(self, volume.ideal),
                "nadir": _by_aim(self, volume.nadir),
                "history": [as_number(value) for value in volume.history],
                "settled": volume.settled,
            }
        return entry

    def blocks(self) -> Sequence[Block]:
        """Return start against knee, the front, and both figures."""
        if self.knee is None:
            return [Words(f"{self.status[:1].upper()}{self.status[1:]}.", "finding"), _comparison(self)]
        blocks: list[Block] = [Words(_summary(self)), _comparison(self), *_undecided(self)]
        if len(self.front) > 1:
            blocks += [*fit_for_paper(_front(self)), Drawing("Front, start and knee", _drawn_front(self))]
        blocks.append(Drawing("Hypervolume over the generations", _drawn_history(self), _history_words(self)))
        return blocks

    def warnings(self) -> Sequence[str]:
        """Say what was not found, what the exact model contradicts, and whether the search had settled."""
        return [f"study '{self.name}': {text}" for text in optimum_warnings(self)]


# How an optimum is written: results.json, the sheet, and what must be said of it


SHOWN = 20
FLAT = 1e-6
WIDEST = 7
"""So many columns with long names fit on A4 and letter."""


def _by_aim(optimum: Optimum, values: Sequence[float]) -> dict[str, Any]:
    return {aim.name: printed(aim.sign * value, aim.unit) for aim, value in zip(optimum.aims, values, strict=True)}


def _variable_json(variable: Any) -> dict[str, Any]:
    if variable.kind == "grade":
        return {"kind": "grade", "finest": GRADES[round(variable.low)], "coarsest": GRADES[round(variable.high)]}
    return {
        "kind": {"number": "input", "whole": "whole", "width": "width"}[variable.kind],
        "low": printed(variable.low, variable.unit),
        "high": printed(variable.high, variable.unit),
        "unit": variable.unit,
    }


def _design_json(optimum: Optimum, design: DesignPoint) -> dict[str, Any]:
    return {
        "inputs": {name: printed(value, _input_unit(optimum, name)) for name, value in design.inputs.items()},
        "tolerances": {name: _width(optimum, name, value) for name, value in design.tolerances.items()},
        "objectives": {aim.name: printed(design.objectives[aim.name], aim.unit) for aim in optimum.aims},
        "margins": {name: as_number(value) for name, value in design.margins.items()},
        "chances": {name: as_number(value) for name, value in design.chances.items()},
        "feasible": design.feasible,
    }


def _knee_json(optimum: Optimum, knee: DesignPoint) -> dict[str, Any]:
    exact = {aim.name: printed(optimum.exact[aim.name], aim.unit) for aim in optimum.aims if aim.name in optimum.exact}
    tally = optimum.tally
    verified = {
        name: {"probability": share, "interval95": list(optimum.interval[name]), "draws": tally.draws if tally else 0}
        for name, share in optimum.verified.items()
    }
    return {
        "place": optimum.knee_place,
        "distance": as_number(optimum.distance),
        **_design_json(optimum, knee),
        "exact": exact,
        "verified": verified,
    }


def _input_unit(optimum: Optimum, name: str) -> str:
    return optimum.problem.setup.print_unit(name)


def _width_unit(optimum: Optimum, name: str) -> str:
    return next(variable.unit for variable in optimum.variables if not variable.is_input and variable.name == name)


def _width(optimum: Optimum, name: str, value: float | str) -> Any:
    return value if isinstance(value, str) else printed(value, _width_unit(optimum, name))


def _summary(optimum: Optimum) -> str:
    count, study = len(optimum.front), optimum.study
    what = f"{count} designs that no other beats" if count > 1 else "One design that no other beats"
    words = (
        f"{what}, from {optimum.evaluations} evaluated ({study.algorithm.upper()}, seed {optimum.problem.setup.seed})."
    )
    if optimum.problem.by_chance:
        how = f"with the same {study.draws} machines for every design" if study.chance == "draws" else "to first order"
        words += f" Chances are found {how}."
    if study.surrogate:
        words += " The surrogate answered in place of the model; the knee was run on the model itself."
    return f"{words} {_settled(optimum)}"


def _settled(optimum: Optimum) -> str:
    volume = optimum.volume
    assert volume is not None  # there is a front
    if volume.exhausted:
        return "The search ended when no design was left that it had not tried."
    way = "grew" if volume.gain >= 0 else "shrank"
    grown = f"the hypervolume {way} by {100 * abs(volume.gain):.2g} % in the last {volume.last} generations"
    return f"The search has settled: {grown}." if volume.settled else f"The search has not settled: {grown}."


def _comparison(optimum: Optimum) -> Table:
    """Set the stated design and the knee side by side: variables, objectives, limits."""
    start, knee = optimum.start, optimum.knee
    designs = [start] if knee is None else [start, knee]
    rows: list[list[Cell]] = []
    for name in start.inputs:
        unit = _input_unit(optimum, name)
        rows.append([name, "input", _text(unit), *(printed(design.inputs[name], unit) for design in designs)])
    for name, width in start.tolerances.items():
        unit, kind = ("", "grade") if isinstance(width, str) else (_width_unit(optimum, name), "full width")
        rows.append([name, kind, _text(unit), *(_width(optimum, name, design.tolerances[name]) for design in designs)])
    for aim in optimum.aims:
        values = [printed(design.objectives[aim.name], aim.unit) for design in designs]
        rows.append([aim.name, aim.sense, _text(aim.unit), *values])
    rows += [_limit_row(bound, designs) for bound in optimum.bounds]
    rows += _verified_rows(optimum)
    rows.append(["every limit is kept", "", "", *(design.feasible for design in designs)])
    columns = ("name", "", "unit", "start", "knee")[: 3 + len(designs)]
    return Table("Start and knee", columns, rows, note=_comparison_note(optimum))


def _limit_row(bound: Any, designs: Sequence[DesignPoint]) -> list[Cell]:
    if bound.by_chance:
        return [bound.name, "chance", "%", *(_percent(design.chances[bound.name]) for design in designs)]
    return [bound.name, "margin", "", *(as_number(design.margins[bound.name]) for design in designs)]


def _verified_rows(optimum: Optimum) -> Iterator[list[Cell]]:
    if optimum.tally is not None:
        for name, share in optimum.verified.items():
            yield [name, f"chance, {optimum.tally.draws} machines", "%", None, 100 * share]


def _comparison_note(optimum: Optimum) -> str:
    if optimum.knee is None:
        return ""
    if len(optimum.aims) == 1:
        return "With one objective the knee is the best design."
    if len(optimum.front) == 1:
        return "The front is a single design: it is the best in every objective."
    plane = "chord between the ends" if len(optimum.aims) == 2 else "plane through the ends"
    if optimum.distance <= FLAT:
        return f"The front has no knee: none of its designs lies before the {plane}. Shown is the nearest one."
    return f"The knee lies farthest from the {plane} of the front, each objective brought to 0 to 1."


def _percent(value: float) -> Any:
    return as_number(100 * value)


def _text(unit: str) -> str:
    return unit_text(unit)


def _front(optimum: Optimum) -> Table:
    """List the front, thinned evenly; its ends and the knee stay."""
    places = _thinned(len(optimum.front), optimum.knee_place or 0)
    first = optimum.front[0]
    inputs = [name for name in first.inputs if name not in first.objectives]
    chances = [bound.name for bound in optimum.problem.by_chance]
    rows: list[list[Cell]] = []
    for index in places:
        design = optimum.front[index]
        row: list[Cell] = [f"{index + 1} knee" if index == optimum.knee_place else str(index + 1)]
        row += [printed(design.objectives[aim.name], aim.unit) for aim in optimum.aims]
        row += [_percent(design.chances[name]) for name in chances]
        row += [printed(design.inputs[name], _input_unit(optimum, name)) for name in inputs]
        row += [_width(optimum, name, value) for name, value in design.tolerances.items()]
        rows.append(row)
    columns = ["design", *(aim.name for aim in optimum.aims), *chances, *inputs, *first.tolerances]
    units = ["", *(aim.unit for aim in optimum.aims), *("%" for _ in chances)]
    units += [_input_unit(optimum, name) for name in inputs]
    units += ["" if isinstance(width, str) else _width_unit(optimum, name) for name, width in first.tolerances.items()]
    left = len(optimum.front) - len(places)
    note = f"{len(places)} of {len(optimum.front)} designs; results.json holds all of them." if left else ""
    return Table("Front", columns, rows, units, note)


def fit_for_paper(table: Table) -> list[Table]:
    """Cut a table with more columns than a page has room for; the first column stands in every part."""
    count = len(table.columns)
    if count <= WIDEST:
        return [table]
    steps = range(1, count, WIDEST - 1)
    parts = []
    for part, start in enumerate(steps, 1):
        places = [0, *range(start, min(start + WIDEST - 1, count))]
        title = f"{table.title}, part {part} of {len(steps)}"
        columns = [table.columns[index] for index in places]
        rows = [[row[index] for index in places] for row in table.rows]
        parts.append(Table(title, columns, rows, [table.units[index] for index in places], table.note))
    return parts


def _thinned(count: int, knee: int) -> list[int]:
    if count <= SHOWN:
        return list(range(count))
    steps = SHOWN - 1
    return sorted({*(round(step * (count - 1) / (steps - 1)) for step in range(steps)), knee})


def _drawn_front(optimum: Optimum) -> Callable[[], Figure]:
    """Draw the first objective against each of the others."""

    def draw() -> Figure:
        first, others = optimum.aims[0], optimum.aims[1:]
        figure = Figure(figsize=(WIDTH, 0.4 + 3.2 * len(others)), layout="constrained")
        panels = figure.subplots(len(others), 1, squeeze=False)[:, 0]
        for panel, other in zip(panels, others, strict=True):
            _panel(panel, optimum, (first, other))
            panel.set_xlabel(labelled(first.name, _text(first.unit)))
            panel.set_ylabel(labelled(other.name, _text(other.unit)))
        panels[0].legend(frameon=False)
        return figure

    return draw


def _panel(panel: Any, optimum: Optimum, aims: tuple[Any, Any]) -> None:
    def places(designs: Sequence[DesignPoint]) -> list[list[Any]]:
        return [[printed(design.objectives[aim.name], aim.unit) for design in designs] for aim in aims]

    line = "-" if len(optimum.aims) == 2 else ""
    panel.plot(
        *places(optimum.front), color=BLUE, marker="o", markersize=3.5, linewidth=0.8, linestyle=line, label="front"
    )
    start = optimum.start
    if all(start.objectives[aim.name] == start.objectives[aim.name] for aim in aims):
        label = "start" if start.feasible else "start, which misses a limit"
        face = GREY if start.feasible else "none"
        panel.plot(*places([start]), color=GREY, marker="s", markerfacecolor=face, linestyle="", label=label)
    if optimum.knee is not None:
        panel.plot(*places([optimum.knee]), color=ORANGE, marker="D", linestyle="", label="knee")
    panel.grid(alpha=0.3)


def _drawn_history(optimum: Optimum) -> Callable[[], Figure]:
    def draw() -> Figure:
        assert optimum.volume is not None  # there is a front
        history = optimum.volume.history
        figure = Figure(figsize=(WIDTH, 2.4), layout="constrained")
        panel: Any = figure.subplots()
        panel.plot(range(1, len(history) + 1), history, color=BLUE)
        panel.set_xlabel("generation")
        panel.set_ylabel("hypervolume")
        panel.grid(alpha=0.3)
        return figure

    return draw


def _history_words(optimum: Optimum) -> str:
    return (
        f"Of every generation's front, in the box of the last one (each objective 0 to 1), against the reference point "
        f"{REFERENCE:g} in each objective."
    )


def optimum_warnings(optimum: Optimum) -> Iterator[str]:
    """Say what was not found, what the exact model contradicts, and whether the search had settled."""
    yield from optimum.remarks
    if optimum.knee is None:
        yield optimum.status
        return
    if optimum.volume is not None and not optimum.volume.settled:
        yield (
            f"the hypervolume still grew by more than {100 * SETTLED:g} % in the last {optimum.volume.last} "
            "generations; ask for more generations"
        )
    yield from _contradicted(optimum)


def _contradicted(optimum: Optimum) -> Iterator[str]:
    """Name the goals that the knee misses when it is verified."""
    for name, goal, (low, high) in _goals(optimum):
        if high < goal:
            yield (
                f"the knee misses '{name}': machines that the search has not seen give {low:.5f} to {high:.5f} "
                f"of {goal:g}"
            )


def _undecided(optimum: Optimum) -> Iterator[Words]:
    """Say where the sampling error of the verification does not decide: an optimum stands at its limits."""
    for name, goal, (low, high) in _goals(optimum):
        if low < goal <= high:
            yield Words(
                f"Whether the knee reaches {goal:g} of {spoken(name)} lies within the sampling error of the "
                f"verification ({low:.5f} to {high:.5f}): it stands at this limit."
            )


def _goals(optimum: Optimum) -> Iterator[tuple[str, float, tuple[float, float]]]:
    for demand in optimum.demands:
        if demand.goal is not None:
            yield demand.name, demand.goal, optimum.interval[demand.name]
